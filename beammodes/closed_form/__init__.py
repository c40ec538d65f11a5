"""Uniform chains in closed form: frequencies and errors at a cost that does not depend on N."""
