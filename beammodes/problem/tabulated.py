"""A property tabulated along a beam, with steps: its limits, moments, kinks and breaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import bounded, real_numbers, shown

__all__ = [
    "SAME_PLACE",
    "Table",
    "about_middles",
    "near_a_place",
    "table_breaks",
    "table_bulge",
    "table_kinks",
    "table_limit",
    "table_moments",
    "table_with_breaks",
]

_MOST_NUMBERS = 1_000_000
Floats = NDArray[np.float64]

#: Two positions nearer than this fraction of the length are one: j L/N and i L/n round differently.
SAME_PLACE = 1e-12
# A hinge of a long chain may stand at a sum of 10^6 rounded lengths.
_AT_A_STEP = 1e-10


@dataclass(frozen=True, slots=True)
class Table:
    """A property tabulated along a beam: linear between the positions, a break where one is given twice.

    value(x) = value_i + (value_(i+1) - value_i) (x - x_i) / (x_(i+1) - x_i)  for x_i < x < x_(i+1)

    Between two breaks the table stands for a smooth property, and the finer it is the better. Breaks are
    steps, and kinks that are meant: give their position twice, or to `Beam` as `breaks`. Chain rules act on
    breaks only (see `chains.rods.profile_weights`), and integrate what kinks add to the flexibility
    (`chains.rods.hinge_flexibilities`), but for coarse steep tables, of which hinges take the values there
    and `Chain` warns. The exact beam bends as the table says, kink by kink.

    Of few measured sections, interpolate what was measured, such as a diameter d, and not EI ~ d⁴, which is
    curved between the positions: six diameters of a fishing rod, 12 to 2.2 mm, made a table of EI and one of
    ρA, have +0.8, +2.7 and +4.0 % in the first three frequencies against functions of
    d(x) = numpy.interp(x, at, d), with `breaks=at[1:-1]`.

    Parameters
    ----------
    x : sequence of float [m]
        Positions from 0 to the beam's length, ascending; each once, or twice inside for a break.
    value : sequence of float
        The property there, before and after a break, in the property's own unit.

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


def table_with_breaks(table: Table, breaks: Sequence[float]) -> Table:
    """Return the table with these positions inside it given twice, as breaks.

    Examples
    --------
    >>> table_with_breaks(Table((0.0, 0.5, 1.0), (1.0, 1.0, 0.4)), [0.5])
    Table(x=(0.0, 0.5, 0.5, 1.0), value=(1.0, 1.0, 1.0, 0.4))
    """
    known, length = np.array(table.x), table.x[-1]
    points = list(zip(table.x, table.value, strict=True))
    for place in breaks:
        same = np.flatnonzero(np.abs(known - place) <= SAME_PLACE * length)
        at = float(known[same[0]]) if len(same) else place
        value = float(table_limit(table, np.array([at]), 1)[0])
        points += [(at, value)] * (2 - len(same))
    # In stable order the limits at a step stay as they are.
    points.sort(key=lambda point: point[0])
    x, values = zip(*points, strict=True)
    return Table(x, values)


def table_limit(table: Table, position: Floats, side: int) -> Floats:
    """Return the limits of a table at positions, from the left (side -1) or from the right (+1)."""
    x, value = np.array(table.x), np.array(table.value)
    nearest, near = near_a_place(x, position)
    position = np.where(near, nearest, position)
    cell = np.searchsorted(x, position, side="right" if side > 0 else "left") - 1
    cell = np.clip(cell, 0, len(x) - 2)
    share = np.clip((position - x[cell]) / (x[cell + 1] - x[cell]), 0.0, 1.0)
    # Weights of both values, so that a value at a position is that value to the last digit.
    limit: Floats = (1.0 - share) * value[cell] + share * value[cell + 1]
    return limit


def near_a_place(places: Floats, position: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return for each position the nearest of ascending places, and whether it is taken for that."""
    nearest = places[np.clip(np.searchsorted(0.5 * (places[1:] + places[:-1]), position), 0, len(places) - 1)]
    return nearest, np.abs(nearest - position) <= _AT_A_STEP * places[-1]


def table_moments(table: Table, edges: Floats) -> tuple[Floats, Floats, Floats]:
    """Return ∫ρ, ∫ρ (x-c) and ∫ρ (x-c)² over each interval between edges, c its middle.

    Sums the closed forms of the linear parts into which the table's positions cut each interval.
    """
    inner = np.array(table.x)
    inner = inner[(inner > edges[0]) & (inner < edges[-1])]
    points = np.sort(np.concatenate((edges, inner)))
    width, middle = np.diff(points), 0.5 * (points[1:] + points[:-1])
    density, slope = _line_at(table, middle)
    parts = density * width, slope * width**3 / 12.0, density * width**3 / 12.0
    return about_middles(parts, middle, edges)


def about_middles(
    parts: tuple[Floats, Floats, Floats], middle: Floats, edges: Floats
) -> tuple[Floats, Floats, Floats]:
    """Sum moments of parts, each about its own middle, into those of the intervals that they make up."""
    mass, tilt, inertia = parts
    owner = np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(edges) - 2)
    shift = middle - 0.5 * (edges[1:] + edges[:-1])[owner]
    sums = np.zeros((3, len(edges) - 1))
    moved = (mass, tilt + shift * mass, inertia + 2.0 * shift * tilt + shift**2 * mass)
    for total, part in zip(sums, moved, strict=True):
        np.add.at(total, owner, part)
    return sums[0], sums[1], sums[2]


def table_breaks(table: Table) -> tuple[float, ...]:
    """Return the positions inside the beam that a table has twice, for a step or a kink, ascending.

    One where neither value nor slope changes is none.
    """
    x = np.array(table.x)
    twice = x[1:][np.diff(x) == 0.0]
    return tuple(twice[np.isin(twice, table_kinks(table))].tolist())


def table_kinks(table: Table) -> tuple[float, ...]:
    """Return the positions inside the beam where a table has a step or a kink, marked or not, ascending."""
    x, value = np.array(table.x), np.array(table.value)
    rise, run = np.diff(value), np.diff(x)
    slope = np.divide(rise, run, out=np.zeros_like(rise), where=run > 0.0)
    stepped = (run == 0.0) & (rise != 0.0)
    # Across a position given twice with one value the slopes on both sides count.
    cells = np.flatnonzero(run > 0.0)
    kinked = np.diff(slope[cells]) != 0.0
    return tuple(sorted({*x[:-1][stepped].tolist(), *x[cells[1:]][kinked].tolist()}))


def table_bulge(table: Table, position: Floats) -> Floats:
    """Return how far a smooth curve through the points of a table lies above its lines, at positions.

    On a cell of width h with the line's slope δ it is a cubic of the share t of the cell, by the curve's
    slopes d at both ends, and zero where the points between two breaks lie on one line:

        h t (1-t) ((d_0 - δ) (1-t) - (d_1 - δ) t).

    The slopes are those of the cubics through four points, two for each point, of which the less steep
    counts, and zero if they differ in sign. Of a smooth property they are right to third order. No cubic may
    be more than twice as curved there as the less curved of the two parabolas through three of its points,
    so that the curve does not ring at kinks (as Harten and Osher, 1987, SIAM J. Numer. Anal. 24(2),
    279-309). And they are bounded such that it stays above a third of the lesser value on either side.

    Examples
    --------
    >>> table_bulge(Table((0.0, 1.0, 2.0), (9.0, 8.0, 5.0)), np.array([0.5, 1.0]))     # 9 - x² = 8.75, 8
    array([0.25, 0.  ])
    """
    x, value = np.array(table.x), np.array(table.value)
    cell = np.flatnonzero(np.diff(x) > 0.0)
    width, low, high = np.diff(x)[cell], value[cell], value[cell + 1]
    slope = (high - low) / width
    joined = ~np.isin(x[cell[1:]], table_breaks(table))
    bend = np.where(joined, np.diff(slope) / (width[1:] + width[:-1]), np.nan)
    before, after = np.append(np.nan, bend), np.append(bend, np.nan)
    # A part's outer cells have one neighbour, and curvatures go on as they change; its only cell has none.
    inward, outward = np.append(after[1:], np.nan), np.append(np.nan, before[:-1])
    before, after = (
        np.where(np.isnan(before), after + np.nan_to_num(after - inward), before),
        np.where(np.isnan(after), before + np.nan_to_num(before - outward), after),
    )
    flat = np.nan_to_num(_nearer_zero(before, after))
    # Shares of the two parabolas in the slope of the cubic through the cell's and its neighbours' points.
    lower = np.where(np.append(False, joined), np.roll(width, 1), width)
    upper = np.where(np.append(joined, False), np.roll(width, -1), width)
    whole = lower + width + upper
    start = slope - width * _bounded((before * (width + upper) + after * lower) / whole, flat)
    stop = slope + width * _bounded((after * (lower + width) + before * upper) / whole, flat)
    meeting = _nearer_zero(stop[:-1], start[1:])
    start[1:], stop[:-1] = np.where(joined, meeting, start[1:]), np.where(joined, meeting, stop[:-1])
    start, stop = np.maximum(start, -2.0 * low / width), np.minimum(stop, 2.0 * high / width)
    at = np.searchsorted(x[cell[1:]], position, side="right")
    share = np.clip((position - x[cell[at]]) / width[at], 0.0, 1.0)
    rest = 1.0 - share
    tilt = (start - slope)[at] * rest - (stop - slope)[at] * share
    bulge: Floats = width[at] * share * rest * tilt
    return bulge


def _bounded(curvature: Floats, least: Floats) -> Floats:
    """Return curvatures of no more than twice the least, and of its sign; none where that is zero."""
    within: Floats = np.sign(least) * np.minimum(np.abs(np.nan_to_num(curvature)), 2.0 * np.abs(least))
    return within


def _nearer_zero(one: Floats, other: Floats) -> Floats:
    """Return of two numbers the one that is nearer to zero, and zero if their signs differ."""
    nearer: Floats = 0.5 * (np.sign(one) + np.sign(other)) * np.minimum(np.abs(one), np.abs(other))
    return nearer


def _line_at(table: Table, position: Floats) -> tuple[Floats, Floats]:
    x, value = np.array(table.x), np.array(table.value)
    cell = np.clip(np.searchsorted(x, position, side="right") - 1, 0, len(x) - 2)
    slope = (value[cell + 1] - value[cell]) / (x[cell + 1] - x[cell])
    return value[cell] + slope * (position - x[cell]), slope


def _row(name: str, value: object) -> tuple[float, ...]:
    if not isinstance(value, Sequence | np.ndarray) or (isinstance(value, np.ndarray) and value.ndim != 1):
        raise TypeError(f"{name} must be a sequence of real numbers, got {shown(value)}")
    row = tuple((real_numbers(name, bounded(name, value)) + 0.0).tolist())
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
