"""Computed chunks: the numbers, and the same numbers as the bytes of a netCDF file."""

from __future__ import annotations

import io
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from beammodes.batch.cases import Cases
from beammodes.batch.quantities import REASON, Quantity
from beammodes.blas import one_thread

__all__ = ["THIS_PROCESS", "Evaluated", "evaluate", "evaluate_elsewhere"]

Floats = NDArray[np.float64]

#: Tells this process, and forks of it, from others, also on other machines.
THIS_PROCESS = secrets.token_hex(16)


@dataclass(frozen=True, eq=False)
class Evaluated:
    """The quantities of one chunk.

    Attributes
    ----------
    values : dict from names to arrays, shape (cases, modes) or (cases,)
    reasons : dict from int to str
        Why numbers of a case are NaN, by its place in the chunk.
    """

    values: dict[str, Floats]
    reasons: Mapping[int, str] = field(default_factory=dict)

    def to_bytes(self, study: str, number: int) -> bytes:
        """Return a netCDF file, the same bytes whenever the numbers are the same.

        Parameters
        ----------
        study : str
            The digest of the study's definition.
        number : int
            Of the chunk.
        """
        import h5netcdf

        # Text as attributes, and whole numbers for it at the cases: arrays of strings would be of objects.
        texts: dict[str, int] = {}
        which = np.zeros(len(next(iter(self.values.values()))), dtype=np.int64)
        for place, text in self.reasons.items():
            which[place] = texts.setdefault(text, len(texts) + 1)
        whole = io.BytesIO()
        with h5netcdf.File(whole, "w") as file:
            for name, array in {**self.values, REASON: which}.items():
                dimensions = ("case", "mode")[: array.ndim]
                for dimension, size in zip(dimensions, array.shape, strict=True):
                    if dimension not in file.dimensions:
                        file.dimensions[dimension] = size
                file.create_variable(name, dimensions, data=array)
            file.attrs["study"], file.attrs["chunk"] = study, np.int64(number)
            file.attrs["reasons"] = "\n".join(texts)
        return whole.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> tuple[Evaluated, str, int]:
        """Return what `to_bytes` wrote, the study's digest and the chunk's number.

        Raises
        ------
        OSError, KeyError
            If it is anything else.

        Examples
        --------
        >>> chunk = Evaluated({"a": np.array([1.0, np.nan])}, {1: "why"})
        >>> found, study, number = Evaluated.from_bytes(chunk.to_bytes("2f1c", 5))
        >>> found.reasons, study, number
        ({1: 'why'}, '2f1c', 5)
        """
        import h5netcdf

        with h5netcdf.File(io.BytesIO(data), "r") as file:
            study, number = str(file.attrs["study"]), int(file.attrs["chunk"])
            texts = str(file.attrs["reasons"]).split("\n")
            values = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        which = values.pop(REASON)
        reasons = {int(place): texts[which[place] - 1] for place in np.flatnonzero(which)}
        return cls(values, reasons), study, number


def evaluate(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    """Return the quantities of a chunk, on one BLAS thread: several would share sums out differently."""
    with one_thread():
        return _evaluated(cases, quantities)


def evaluate_elsewhere(
    cases: Cases, quantities: Iterable[Quantity], version: str, process: str = ""
) -> Evaluated:
    """Return the quantities of a chunk in a worker's process, whose BLAS keeps to one thread from now on.

    Parameters
    ----------
    cases, quantities
    version : str
        Of this package, where the study was made.
    process : str
        `THIS_PROCESS` of the one that sends.

    Raises
    ------
    ValueError
        If the worker has another version of this package, or would run other code than the study's own
        functions had where it was made, such as a file that was edited since.
    """
    from beammodes import __version__

    if version != __version__:
        raise ValueError(f"workers must have beammodes {version}, got {__version__}")
    if process != THIS_PROCESS:
        for quantity in quantities:
            quantity.check_code()
    # Kept: a worker may run several chunks in threads, and one must not release the others.
    one_thread()
    return _evaluated(cases, quantities)


def _evaluated(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    values = {
        quantity.name: np.ascontiguousarray(quantity.compute(cases), dtype=np.float64)
        for quantity in quantities
    }
    return Evaluated(values, dict(sorted(cases.reasons.items())))
