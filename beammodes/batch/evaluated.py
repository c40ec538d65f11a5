"""Computed chunks: the numbers, and the same numbers as the bytes of a netCDF file."""

from __future__ import annotations

import io
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.batch.cases import Cases
from beammodes.batch.quantities import Quantity
from beammodes.blas import one_thread

__all__ = ["Evaluated", "evaluate", "evaluate_elsewhere"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Evaluated:
    """The quantities of one chunk.

    Attributes
    ----------
    values : dict from names to arrays, shape (cases, modes) or (cases,)
    refused : tuple of str
        Why some are NaN.
    """

    values: dict[str, Floats]
    refused: tuple[str, ...] = ()

    def to_bytes(self) -> bytes:
        """Return a netCDF file, the same bytes whenever the numbers are the same."""
        import h5netcdf

        whole = io.BytesIO()
        with h5netcdf.File(whole, "w") as file:
            for name, array in self.values.items():
                dimensions = ("case", "mode")[: array.ndim]
                for dimension, size in zip(dimensions, array.shape, strict=True):
                    if dimension not in file.dimensions:
                        file.dimensions[dimension] = size
                file.create_variable(name, dimensions, data=array)
            # Text of its own: an attribute of several strings would be an array of objects.
            file.attrs["refused"] = "\n".join(reason.replace("\n", " ") for reason in self.refused)
        return whole.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Evaluated:
        """Return what `to_bytes` wrote; raises OSError or KeyError for anything else.

        Examples
        --------
        >>> chunk = Evaluated({"a": np.array([1.0, np.nan])}, ("why",))
        >>> Evaluated.from_bytes(chunk.to_bytes()).refused
        ('why',)
        """
        import h5netcdf

        with h5netcdf.File(io.BytesIO(data), "r") as file:
            reasons = str(file.attrs["refused"])
            values = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        return cls(values, tuple(reasons.split("\n")) if reasons else ())


def evaluate(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    """Return the quantities of a chunk, on one BLAS thread: several would share sums out differently."""
    with one_thread():
        return _evaluated(cases, quantities)


def evaluate_elsewhere(cases: Cases, quantities: Iterable[Quantity], version: str) -> Evaluated:
    """Return the quantities of a chunk in a worker's process, whose BLAS keeps to one thread from now on.

    Raises
    ------
    ValueError
        If the worker has another version of this package.
    """
    from beammodes import __version__

    if version != __version__:
        raise ValueError(f"workers must have beammodes {version}, got {__version__}")
    # Kept: a worker may run several chunks in threads, and one must not release the others.
    one_thread()
    return _evaluated(cases, quantities)


def _evaluated(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    values = {
        quantity.name: np.ascontiguousarray(quantity.compute(cases), dtype=np.float64)
        for quantity in quantities
    }
    return Evaluated(values, tuple(cases.refused))
