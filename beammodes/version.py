"""The version of this package: the one place that has it."""

__all__ = ["SOURCE", "__version__"]

__version__ = "0.2.0"

#: What datasets and files name as their source.
SOURCE = f"beammodes {__version__}"
