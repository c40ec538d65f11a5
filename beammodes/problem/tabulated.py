"""A property tabulated along a beam, with steps: its limits, moments and breaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import real, shown

__all__ = ["SAME_PLACE", "Table", "table_breaks", "table_limit", "table_moments"]

Floats = NDArray[np.float64]

#: Two positions nearer than this fraction of the length are one: j L/N and i L/n round differently.
SAME_PLACE = 1e-12
# A hinge of a long chain may stand at a sum of 10^6 rounded lengths.
_AT_A_STEP = 1e-10


@dataclass(frozen=True, slots=True)
class Table:
    """A property tabulated along a beam: linear between the positions, a step where one is given twice.

    value(x) = value_i + (value_(i+1) - value_i) (x - x_i) / (x_(i+1) - x_i)  for x_i < x < x_(i+1)

    Parameters
    ----------
    x : sequence of float [m]
        Positions from 0 to the beam's length, ascending; each once, or twice inside for a step.
    value : sequence of float
        The property there, before and after a step, in the property's own unit.

    Raises
    ------
    TypeError, ValueError
        If the two are not equally many finite real numbers, at least two, or `x` is not as above.

    Examples
    --------
    >>> step = Table((0.0, 0.4, 0.4, 1.0), (5.0, 5.0, 2.0, 2.0))
    >>> table_limit(step, np.array([0.2, 0.4, 0.6]), side=1).tolist()
    [5.0, 2.0, 2.0]
    """

    x: tuple[float, ...]
    value: tuple[float, ...]

    def __init__(self, x: Sequence[float] | NDArray[Any], value: Sequence[float] | NDArray[Any]) -> None:
        object.__setattr__(self, "x", _row("x", x))
        _check_positions(self.x)
        object.__setattr__(self, "value", _row("value", value))
        if len(self.value) != len(self.x):
            raise ValueError(f"value must be as many numbers as x, {len(self.x)}, got {len(self.value)}")


def table_limit(table: Table, position: Floats, side: int) -> Floats:
    """Return the limits of a table at positions, from the left (side -1) or from the right (+1)."""
    x, value = np.array(table.x), np.array(table.value)
    nearest = np.clip(np.searchsorted(0.5 * (x[1:] + x[:-1]), position), 0, len(x) - 1)
    near = np.abs(x[nearest] - position) <= _AT_A_STEP * x[-1]
    position = np.where(near, x[nearest], position)
    cell = np.searchsorted(x, position, side="right" if side > 0 else "left") - 1
    cell = np.clip(cell, 0, len(x) - 2)
    share = np.clip((position - x[cell]) / (x[cell + 1] - x[cell]), 0.0, 1.0)
    # Weights of both values, so that a value at a position is that value to the last digit.
    limit: Floats = (1.0 - share) * value[cell] + share * value[cell + 1]
    return limit


def table_moments(table: Table, edges: Floats) -> tuple[Floats, Floats, Floats]:
    """Return ∫ρ, ∫ρ (x-c) and ∫ρ (x-c)² over each interval between edges, c its middle.

    Sums the closed forms of the linear parts into which the table's positions cut each interval.
    """
    inner = np.array(table.x)
    inner = inner[(inner > edges[0]) & (inner < edges[-1])]
    points = np.sort(np.concatenate((edges, inner)))
    width, middle = np.diff(points), 0.5 * (points[1:] + points[:-1])
    owner = np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(edges) - 2)
    density, slope = _line_at(table, middle)
    shift = middle - 0.5 * (edges[1:] + edges[:-1])[owner]
    mass, tilt, inertia = density * width, slope * width**3 / 12.0, density * width**3 / 12.0
    parts = (mass, tilt + shift * mass, inertia + 2.0 * shift * tilt + shift**2 * mass)
    sums = np.zeros((3, len(edges) - 1))
    for total, part in zip(sums, parts, strict=True):
        np.add.at(total, owner, part)
    return sums[0], sums[1], sums[2]


def table_breaks(table: Table) -> tuple[float, ...]:
    """Return the positions inside the beam where a table has a step or a kink, ascending."""
    x, value = np.array(table.x), np.array(table.value)
    rise, run = np.diff(value), np.diff(x)
    slope = np.divide(rise, run, out=np.zeros_like(rise), where=run > 0.0)
    stepped = (run == 0.0) & (rise != 0.0)
    # Across a position given twice with one value the slopes on both sides count.
    cells = np.flatnonzero(run > 0.0)
    kinked = np.diff(slope[cells]) != 0.0
    return tuple(sorted({*x[:-1][stepped].tolist(), *x[cells[1:]][kinked].tolist()}))


def _line_at(table: Table, position: Floats) -> tuple[Floats, Floats]:
    x, value = np.array(table.x), np.array(table.value)
    cell = np.clip(np.searchsorted(x, position, side="right") - 1, 0, len(x) - 2)
    slope = (value[cell + 1] - value[cell]) / (x[cell + 1] - x[cell])
    return value[cell] + slope * (position - x[cell]), slope


def _row(name: str, value: object) -> tuple[float, ...]:
    if isinstance(value, str | bytes) or not isinstance(value, Sequence | np.ndarray) or np.ndim(value) == 0:
        raise TypeError(f"{name} must be a sequence of real numbers, got {shown(value)}")
    row = tuple(real(name, item) + 0.0 for item in value)
    if len(row) < 2:
        raise ValueError(f"{name} must be at least two numbers, got {shown(value)}")
    return row


def _check_positions(x: tuple[float, ...]) -> None:
    if x[0] != 0.0:
        raise ValueError(f"x must start at 0, the left end of the beam, got {x[0]}")
    for i, (before, after) in enumerate(pairwise(x)):
        if after < before:
            raise ValueError(f"x must be ascending, got {after} after {before}")
        if after == before and (i == 0 or i == len(x) - 2 or x[i - 1] == before):
            raise ValueError(f"x must have each position once, or twice inside for a step, got {after} again")
