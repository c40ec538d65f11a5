"""Properties that vary along a beam: numbers, tables and functions of x, and what chains take from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.problem.smooth_parts import BrokenFunction, function_values, smooth_parts
from beammodes.problem.tabulated import (
    SAME_PLACE,
    Table,
    about_middles,
    near_a_place,
    table_breaks,
    table_bulge,
    table_kinks,
    table_limit,
    table_moments,
)

__all__ = [
    "Profile",
    "Table",
    "integral_of_reciprocal",
    "mean_over",
    "mean_reciprocal",
    "moments",
    "profile_breaks",
    "profile_parts",
    "ripple_at_hinges",
    "scaled",
    "value_at",
]

Floats = NDArray[np.float64]

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
