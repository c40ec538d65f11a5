"""Properties that vary along a beam: numbers, tables and functions of x, and what chains take from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import Shown, bounded, kind_given, real, real_numbers, shown, unwrapped
from beammodes.numerics.arrays import Floats

__all__ = [
    "SAME_PLACE",
    "SAMPLES",
    "BrokenFunction",
    "Profile",
    "Table",
    "about_middles",
    "function_values",
    "integral_of_reciprocal",
    "mean_over",
    "mean_reciprocal",
    "moments",
    "near_a_place",
    "profile_breaks",
    "profile_parts",
    "ripple_at_hinges",
    "scaled",
    "smooth_parts",
    "table_breaks",
    "table_bulge",
    "table_kinks",
    "table_limit",
    "table_moments",
    "table_with_breaks",
    "value_at",
]


# Functions along a beam: their values, and where one must be cut so that each part of it is smooth.


Function = Callable[[Any], Any]


#: A function is seen at this many places along a beam: a feature as wide as L/4096 meets one at least.
SAMPLES = 4096


# Gauss points by which a function is known on each part, and places between them at least.
_POINTS, _BETWEEN = 32, 33


# Largest error on a part, relative to the function there, times the part's share of the length.
_TOLERANCE = 1e-12


_MOST_PARTS = 4000


@dataclass(frozen=True, slots=True)
class BrokenFunction:
    """A function along a beam that is smooth but for steps and kinks at `breaks`, ascending positions [m]."""

    function: Function
    breaks: tuple[float, ...]

    def __call__(self, x: Any) -> Any:
        """Return the function at `x`."""
        return self.function(x)


def function_values(function: Function, position: Floats) -> Floats:
    """Return the values of a function of an array, or of one number at a time, at a row of positions.

    Raises
    ------
    TypeError, ValueError
        If it returns what is no finite real number.

    Examples
    --------
    >>> function_values(lambda x: max(x, 0.5), np.array([0.2, 0.8])).tolist()
    [0.5, 0.8]
    """
    if position.size > 1:
        try:
            values = np.asarray(function(position))
        except (TypeError, ValueError):
            values = np.empty(0)
        if values.dtype.kind in "iuf" and values.shape in (position.shape, ()):
            return np.broadcast_to(values, position.shape).astype(np.float64)
    # The function takes one number at a time, or fails here with its own words.
    return np.array([real("value of the function", _plain(function(at))) for at in position.tolist()])


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value


def smooth_parts(function: Function, length: float) -> tuple[tuple[float, ...], float]:
    """Return the edges of parts on which a function is smooth, and the largest error left on one.

    Each part, at first the beam or what lies between two breaks, is halved until the polynomial through its
    32 Gauss points is the function itself, and its reciprocal, at `SAMPLES` places along the beam and at 33
    places in every part:

        |p(x)/f(x) - 1| · width/L  <  1e-12.

    A feature as wide as L/4096 meets one of these places and is followed down to its own scale. A narrower
    one may fall between all of them: no sampling can find it, but `breaks` on both sides of it do. Steps and
    kinks that are no breaks are closed in on too, each at the cost of some 40 or 20 parts.

    Parameters
    ----------
    function : function
        Of positions [m]; parts do not cross the breaks of a `BrokenFunction`.
    length : float [m]

    Returns
    -------
    tuple of float, float
        The second is below 1e-12 unless 4,000 parts did not suffice.

    Examples
    --------
    >>> smooth_parts(lambda x: 9.0 + x, 2.0)[0]
    (0.0, 2.0)
    >>> notch = lambda x: 1.0 - 0.9 * np.exp(-(((x - 0.3) / 0.001) ** 2))
    >>> len(smooth_parts(notch, 1.0)[0]) > 10
    True
    """
    try:
        return _cut(function, length)
    except TypeError:
        # It cannot be a key; or fails with the same words once more.
        return _cut.__wrapped__(function, length)


@lru_cache(maxsize=64)
def _cut(function: Function, length: float) -> tuple[tuple[float, ...], float]:
    breaks = function.breaks if isinstance(function, BrokenFunction) else ()
    edges = np.array([0.0, *breaks, length])
    low, high = edges[:-1], edges[1:]
    done = {*edges.tolist()}
    # Halved 45 times, a part is narrower than two positions that count as one.
    for halving in range(46):
        error = _errors(function, low, high, length) * (high - low) / length
        rough = error > _TOLERANCE
        if not rough.any() or halving == 45 or len(done) + rough.sum() > _MOST_PARTS:
            break
        middle = 0.5 * (low[rough] + high[rough])
        low, high = np.concatenate((low[rough], middle)), np.concatenate((middle, high[rough]))
        done.update(middle.tolist())
    return tuple(sorted(done)), float(error.max())


def _errors(function: Function, low: Floats, high: Floats, length: float) -> Floats:
    """Return the largest relative error of each part's polynomials between its Gauss points."""
    node, weight = np.polynomial.legendre.leggauss(_POINTS)
    degree = np.arange(_POINTS)
    series = (degree + 0.5)[:, None] * np.polynomial.legendre.legvander(node, _POINTS - 1).T * weight
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    known = function_values(function, (middle[:, None] + half[:, None] * node).ravel()).reshape(-1, _POINTS)
    errors = np.zeros(len(low))
    counts = np.maximum(_BETWEEN, np.ceil(SAMPLES * (high - low) / length)).astype(int)
    for count in np.unique(counts).tolist():
        here = np.flatnonzero(counts == count)
        # Away from the middles of the lattice, where symmetric functions and later halves have their edges.
        place = (np.arange(count) + 0.382) / count * 2.0 - 1.0
        x = middle[here, None] + half[here, None] * place
        found = function_values(function, x.ravel()).reshape(x.shape)
        through = np.polynomial.legendre.legvander(place, _POINTS - 1) @ series
        with np.errstate(all="ignore"):
            wrong = np.abs(known[here] @ through.T - found) / np.abs(found)
            if (known[here] > 0.0).all() and (found > 0.0).all():
                wrong = np.maximum(wrong, np.abs((1.0 / known[here]) @ through.T * found - 1.0))
        # A zero of the function says nothing about its smoothness.
        errors[here] = np.where(np.isfinite(wrong), wrong, 0.0).max(axis=1)
    return errors


# A property tabulated along a beam, with steps: its limits, moments, kinks and breaks.

_MOST_NUMBERS = 1_000_000


#: Two positions nearer than this fraction of the length are one: j L/N and i L/n round differently.
SAME_PLACE = 1e-12


# A hinge of a long chain may stand at a sum of 10^6 rounded lengths.
_AT_A_STEP = 1e-10


@dataclass(frozen=True, slots=True, repr=False)
class Table(Shown):
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
    d(x) = numpy.interp(x, at, d), with `breaks=at[1:-1]`. `Beam.from_sections` does it.

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
    #: The kinds of both where they were given with units, for whoever takes the table.
    kinds: tuple[tuple[float, float, float] | None, ...] = field(
        default=(None, None), repr=False, compare=False
    )

    def __init__(self, x: Sequence[float] | NDArray[Any], value: Sequence[float] | NDArray[Any]) -> None:
        object.__setattr__(self, "kinds", (kind_given(x), kind_given(value)))
        object.__setattr__(self, "x", _row("x", x, "m or s"))
        _check_positions(self.x)
        object.__setattr__(self, "value", _row("value", value, "any"))
        if len(self.value) != len(self.x):
            raise ValueError(f"value must be as many numbers as x, {len(self.x)}, got {len(self.value)}")


def check_kinds(name: str, table: Table, *, x: str = "m", value: str | None = None) -> None:
    """Raise TypeError if a table was given in units of other kinds than these; `value` is that of the name.

    Examples
    --------
    >>> check_kinds("bending_stiffness", Table((0.0, 1.0), (2.0, 1.0)))
    """
    if table.kinds == (None, None):
        return
    from beammodes.problem.dimensions import kind_of, unit_of

    units = x, unit_of(name) if value is None else value
    for what, kind, unit in zip(("x", "value"), table.kinds, units, strict=True):
        if kind is not None and kind != kind_of(unit):
            raise TypeError(f"{name} must be a table whose {what} is in {unit} or a unit of that kind")


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


def _row(name: str, value: object, unit: str) -> tuple[float, ...]:
    value = unwrapped(name, value, unit)
    if not isinstance(value, Sequence | np.ndarray) or (isinstance(value, np.ndarray) and value.ndim != 1):
        raise TypeError(f"{name} must be a sequence of real numbers, got {shown(value)}")
    row = tuple((real_numbers(name, bounded(name, value)) + 0.0).tolist())
    if len(row) < 2:
        raise ValueError(f"{name} must be at least two numbers, got {shown(value)}")
    return row


def _check_positions(x: tuple[float, ...]) -> None:
    if x[0] != 0.0:
        raise ValueError(f"x must start at 0, the left end of the beam (or the first time), got {x[0]}")
    for i, (before, after) in enumerate(pairwise(x)):
        if after < before:
            raise ValueError(f"x must be ascending, got {after} after {before}")
        if after == before and (i == 0 or i == len(x) - 2 or x[i - 1] == before):
            raise ValueError(f"x must have each place once, or twice inside for a step, got {after} again")


#: How a property is kept: a number where it is constant, else a table or a function of x [m].
Profile: TypeAlias = float | Table | Callable[[Any], Any]


def value_at(profile: Profile, x: ArrayLike, side: int = 0) -> Floats:
    """Return the values of a profile at positions `x`.

    Parameters
    ----------
    profile : float, Table or function
        The property.
    x : float or array [m]
        Positions on the beam; one within 1e-10 of the length of a table's position is taken for it.
    side : int
        At a break, -1 takes the limit from the left, +1 from the right and 0 the mean of both.

    Returns
    -------
    ndarray, shape x.shape

    Raises
    ------
    TypeError
        If a function returns what is no real number.

    Examples
    --------
    >>> value_at(lambda x: 1.0 - 0.5 * x, [0.0, 1.0]).tolist()
    [1.0, 0.5]
    """
    position = np.asarray(x, dtype=np.float64)
    if isinstance(profile, Table):
        if side == 0:
            return 0.5 * (table_limit(profile, position, -1) + table_limit(profile, position, 1))
        return table_limit(profile, position, side)
    if callable(profile):
        flat = position.ravel()
        if isinstance(profile, BrokenFunction):
            place, near = near_a_place(np.array(profile.breaks), flat)
            if near.any():
                if side == 0:
                    return 0.5 * (value_at(profile, x, -1) + value_at(profile, x, 1))
                # The function's own step may be a rounding beside the break.
                flat = np.where(near, place * (1.0 + side * 2.0 * SAME_PLACE), flat)
        return function_values(profile, flat).reshape(position.shape)
    return np.full(position.shape, profile)


def scaled(profile: Profile, factor: float) -> Profile:
    """Return a profile times a number.

    Examples
    --------
    >>> scaled(Table((0.0, 1.0), (1.0, 2.0)), 3.0).value
    (3.0, 6.0)
    """
    if isinstance(profile, Table):
        return Table(profile.x, tuple(factor * value for value in profile.value))
    if isinstance(profile, BrokenFunction):
        return BrokenFunction(lambda x: factor * profile(x), profile.breaks)
    if callable(profile):
        return lambda x: factor * value_at(profile, x)
    return factor * profile


def mean_reciprocal(profile: Profile, x: ArrayLike, *, smooth: bool = False) -> Floats:
    """Return at each `x` the mean of 1 / left limit and 1 / right limit of a profile.

    ½ (1/value(x-) + 1/value(x+)): the flexibility of a hinge, whose half cells have each their own stiffness.

    Parameters
    ----------
    profile : float, Table or function
        The property, nowhere zero.
    x : float or array [m]
        Positions on the beam.
    smooth : bool
        Of a table, take the smooth curve through its points (`table_bulge`) instead of the lines.

    Raises
    ------
    TypeError
        As `value_at`.

    Examples
    --------
    >>> mean_reciprocal(Table((0.0, 1.0, 1.0, 2.0), (1.0, 1.0, 4.0, 4.0)), [0.5, 1.0]).tolist()
    [1.0, 0.625]
    """
    if isinstance(profile, Table | BrokenFunction):
        more: Floats | float = 0.0
        if smooth and isinstance(profile, Table):
            more = table_bulge(profile, np.asarray(x, dtype=np.float64))
        return 0.5 * (1.0 / (value_at(profile, x, -1) + more) + 1.0 / (value_at(profile, x, 1) + more))
    return 1.0 / value_at(profile, x)


def ripple_at_hinges(
    profile: Profile, hinges: Floats, length: float, moments_at: tuple[bool, bool], *, degree: int = 3
) -> Floats:
    """Return each hinge's share of what a table's lines add to the 1/EI of a curve through its points.

        ∫ h_j(x) (1/EI_lines - 1/EI_curve) dx

    h_j interpolates M² by the cubics through its values at the four nearest hinges (Lagrange), or by lines
    through the two nearest: 1 on hinge j, 0 on others. At an end without moment, zero is known as well. So
    what is small, on average h²/12 |EI''| of EI for points a distance h apart, is integrated to order 4, or
    2.

    Parameters
    ----------
    profile : float, Table or function
        EI; all but tables have no ripple.
    hinges : array, shape (hinges,) [m]
        Ascending positions.
    length : float [m]
    moments_at : (bool, bool)
        Whether the beam's left and right end bear a moment.
    degree : int
        3 for cubics, 1 for lines.

    Examples
    --------
    >>> parabola = Table((0.0, 0.5, 1.0), (1.0, 0.875, 0.5))
    >>> ripple_at_hinges(parabola, np.array([0.0, 0.5]), 1.0, (True, False)).round(4)
    array([0.0023, 0.0225])
    """
    ripple = np.zeros_like(hinges)
    if not isinstance(profile, Table) or not len(hinges):
        return ripple
    free = [np.array([at]) for at, bears in zip((0.0, length), moments_at, strict=True) if not bears]
    known = np.unique(np.concatenate((hinges, *free)))
    points = np.unique(np.concatenate((np.array(profile.x), known)))
    node, weight = np.polynomial.legendre.leggauss(32 if len(points) <= 4096 else 12)
    half = 0.5 * np.diff(points)[:, None]
    x = (points[:-1, None] + half * (1.0 + node)).ravel()
    bulge, line = table_bulge(profile, x), value_at(profile, x, 1)
    part = (half * weight).ravel() * bulge / line / (line + bulge)
    degree = min(degree, len(known) - 1)
    first = np.clip(np.searchsorted(known, x) - 1 - degree // 2, 0, len(known) - 1 - degree)
    shares = np.zeros_like(known)
    for one in range(degree + 1):
        share = part.copy()
        for other in range(degree + 1):
            if other != one:
                share *= (x - known[first + other]) / (known[first + one] - known[first + other])
        shares += np.bincount(first + one, share, len(known))
    # Of hinges in one place the first takes it.
    first = np.searchsorted(hinges, known)
    there = (first < len(hinges)) & (hinges[np.minimum(first, len(hinges) - 1)] == known)
    ripple[first[there]] = shares[there]
    return ripple


def moments(profile: Profile, edges: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Return the moments of a profile over each interval between successive edges, about its middle c.

    m0 = ∫ρ dx,  m1 = ∫ρ (x-c) dx,  m2 = ∫ρ (x-c)² dx

    Exact but for rounding for numbers and tables. Functions take Gauss's rule with 12 points, 32 where
    intervals are few, on each interval or what `smooth_parts` cuts it into: about 1e-14.

    Parameters
    ----------
    profile : float, Table or function
        ρ; mass per length makes a piece's mass, mass moment and rotary inertia.
    edges : array, shape (intervals + 1,) [m]
        Ascending positions on the beam, from 0 to its length.

    Returns
    -------
    m0, m1, m2 : ndarray, shape (intervals,)
        In the profile's unit times [m], [m²] and [m³].

    Raises
    ------
    TypeError
        As `value_at`.

    Examples
    --------
    >>> mass, shift, inertia = moments(Table((0.0, 1.0), (3.0, 1.0)), [0.0, 1.0])
    >>> mass.round(6), shift.round(6), inertia.round(6)
    (array([2.]), array([-0.166667]), array([0.166667]))
    """
    position = np.asarray(edges, dtype=np.float64)
    width = np.diff(position)
    if isinstance(profile, Table):
        return table_moments(profile, position)
    if callable(profile):
        return _function_moments(profile, position)
    return profile * width, np.zeros_like(width), profile * width**3 / 12.0


def integral_of_reciprocal(profile: Profile, edges: ArrayLike) -> Floats:
    """Return ∫ dx/profile over each interval between successive edges.

    Of EI it is the flexibility of the interval. Tables are linear between their positions, from a to b on a
    width w, and there it is  w ln(b/a) / (b - a).

    Parameters
    ----------
    profile, edges
        As of `moments`; the profile nowhere zero.

    Examples
    --------
    >>> integral_of_reciprocal(Table((0.0, 1.0), (1.0, 2.0)), [0.0, 1.0]).round(6)      # ln 2
    array([0.693147])
    """
    position = np.asarray(edges, dtype=np.float64)
    if isinstance(profile, Table):
        inner = np.array(profile.x)
        points = np.unique(np.concatenate((position, inner[(inner > position[0]) & (inner < position[-1])])))
        left, right = value_at(profile, points[:-1], 1), value_at(profile, points[1:], -1)
        rise, width = right / left - 1.0, np.diff(points)
        level = np.abs(rise) < 1e-8
        growth = np.where(level, 1.0 - 0.5 * rise, np.log1p(rise) / np.where(level, 1.0, rise))
        parts = width / left * growth
        middle = 0.5 * (points[1:] + points[:-1])
        return about_middles((parts, np.zeros_like(parts), np.zeros_like(parts)), middle, position)[0]
    if callable(profile):
        return _function_moments(profile, position, reciprocal=True)[0]
    return np.diff(position) / profile


def profile_breaks(profile: Profile) -> tuple[float, ...]:
    """Return the breaks of a profile inside the beam, ascending [m].

    They are the positions that a table has twice, for a step or a kink, and those given with a function. A
    kink of a table that is not given twice is no break.

    Examples
    --------
    >>> profile_breaks(Table((0.0, 0.5, 0.5, 0.8, 1.0), (2.0, 2.0, 1.0, 1.0, 1.5)))
    (0.5,)
    """
    if isinstance(profile, BrokenFunction):
        return profile.breaks
    return table_breaks(profile) if isinstance(profile, Table) else ()


def profile_parts(profile: Profile, length: float) -> tuple[float, ...]:
    """Return the positions inside the beam between which a profile is smooth, ascending [m].

    The kinks of a table, and where `smooth_parts` cuts a function.

    Examples
    --------
    >>> profile_parts(Table((0.0, 0.5, 0.8, 1.0), (2.0, 2.0, 1.0, 1.5)), 1.0)
    (0.5, 0.8)
    """
    if isinstance(profile, Table):
        return table_kinks(profile)
    return smooth_parts(profile, length)[0][1:-1] if callable(profile) else ()


def mean_over(profile: Profile, length: float) -> float:
    """Return the mean of a profile over a beam of this length [m]; a number is its own mean.

    Examples
    --------
    >>> mean_over(Table((0.0, 2.0), (3.0, 1.0)), 2.0)
    2.0
    """
    if isinstance(profile, Table) or callable(profile):
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.sum(moments(profile, np.linspace(0.0, length, 9))[0]) / length)
    return profile


def _function_moments(
    function: Callable[[Any], Any], edges: Floats, *, reciprocal: bool = False
) -> tuple[Floats, Floats, Floats]:
    inner = np.array(smooth_parts(function, float(edges[-1]))[0])
    points = np.unique(np.concatenate((edges, inner[(inner > edges[0]) & (inner < edges[-1])])))
    node, weight = np.polynomial.legendre.leggauss(32 if len(edges) <= 4096 else 12)
    half, middle = 0.5 * np.diff(points), 0.5 * (points[1:] + points[:-1])
    values = function_values(function, (middle[:, None] + half[:, None] * node).ravel())
    weighted = (1.0 / values if reciprocal else values).reshape(len(half), len(node)) * weight
    parts = half * weighted.sum(axis=1), half**2 * (weighted @ node), half**3 * (weighted @ node**2)
    return about_middles(parts, middle, edges)
