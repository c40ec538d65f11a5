"""Errors of chains: frequencies, deflections, mode shapes, buckling loads; and advice on what to choose."""
