"""Chunks put together again: one labelled table, with NaN for what is not there."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.batch.evaluated import Evaluated
from beammodes.batch.quantities import QUANTITIES, REASON
from beammodes.batch.study_axes import AXES, Axis

if TYPE_CHECKING:
    import xarray

__all__ = ["study_dataset"]

#: Different messages that the attribute has; the variable has that of every case.
MAX_REASONS = 3


def study_dataset(definition: Mapping[str, Any], chunks: Iterable[tuple[int, Evaluated]]) -> xarray.Dataset:
    """Return the finished chunks of a study as one table.

    Parameters
    ----------
    definition : mapping
        As `Study.definition`.
    chunks : iterable of (int, Evaluated)
        In the order of their numbers.

    Returns
    -------
    xarray.Dataset
        The study's dimensions, modes last; a variable for each quantity; if some cases have no answer,
        variable `reason` with what was said of each. Attributes: `cases`, `finished_cases` and
        `failed_cases`, not counting modes; `complete`, 1 or 0; `reasons`, the first few.
    """
    import xarray

    axes = [Axis.from_definition(name, written) for name, written in definition["axes"].items()]
    sizes = {axis.dimension: axis.size for axis in axes if axis.dimension}
    modes = sizes.pop("mode", 0)
    arrays, done, reasons = _filled(definition, math.prod(sizes.values()), modes or 1, chunks)
    own = not any(axis.name == "length" for axis in axes)
    variables = {}
    for name, array in arrays.items():
        spread = sizes | ({"mode": modes} if modes and array.ndim == 2 else {})
        variables[name] = (tuple(spread), array.reshape(tuple(spread.values())), _attributes(name, own))
    if reasons:
        said = np.full(math.prod(sizes.values()), "", dtype=object)
        said[list(reasons)] = list(reasons.values())
        long_name = {"long_name": "why numbers are NaN"}
        variables[REASON] = (tuple(sizes), said.reshape(tuple(sizes.values())), long_name)
    total = math.prod(sizes.values())
    return xarray.Dataset(
        variables,
        coords={axis.name: _coordinate(axis, own) for axis in axes},
        attrs={
            "source": f"beammodes {definition['beammodes']}",
            "route": "study in chunks",
            "cases": total,
            "finished_cases": done,
            "complete": int(done == total),
            "failed_cases": len(reasons),
            "reasons": "; ".join(list(dict.fromkeys(reasons.values()))[:MAX_REASONS]),
        },
    )


def _filled(
    definition: Mapping[str, Any], total: int, modes: int, chunks: Iterable[tuple[int, Evaluated]]
) -> tuple[dict[str, NDArray[np.float64]], int, dict[int, str]]:
    """Return an array of every quantity, shape (cases, modes) or (cases,), how many cases are there, and by
    the places of cases why they are NaN.
    """
    step, compute = definition["chunk"], definition["compute"]
    arrays = {
        name: np.full((total, modes) if kind["per_mode"] else (total,), np.nan)
        for name, kind in compute.items()
    }
    done, reasons = 0, {}
    for number, chunk in chunks:
        for name, array in arrays.items():
            array[number * step : (number + 1) * step] = chunk.values[name]
        done += min(step, total - number * step)
        reasons.update({number * step + place: reason for place, reason in chunk.reasons.items()})
    return arrays, done, reasons


def _attributes(name: str, own: bool) -> dict[str, str]:
    if name not in QUANTITIES:
        return {"long_name": name.replace("_", " ")}
    quantity = QUANTITIES[name]
    return {"long_name": quantity.long_name, "units": quantity.own_units if own else quantity.units}


def _coordinate(axis: Axis, own: bool) -> tuple[Any, ...]:
    kind, labels = AXES[axis.name], axis.labels()
    attributes = {"long_name": kind.long_name}
    if kind.is_number:
        attributes["units"] = kind.own_units if own else kind.units
    elif not isinstance(labels[0], str):
        attributes["units"] = "1"
    return (axis.dimension, labels, attributes) if axis.dimension else ((), labels[0], attributes)
