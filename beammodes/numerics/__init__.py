"""Numerics that know no physics, shared by judge and judged: root finders, long decimals, BLAS threads."""
