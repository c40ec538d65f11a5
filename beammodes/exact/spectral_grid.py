"""Gauss points along the smooth sections of a beam, and deflection and slope there from curvature."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam, each_place_once
from beammodes.problem.profiles import Profile, Table, profile_breaks, profile_parts, smooth_parts, value_at

__all__ = ["Grid", "legendre_integral", "legendre_of_values", "section_grid"]


_PROPERTIES = ("bending_stiffness", "mass_per_length", "rotary_inertia_per_length", "shear_stiffness")
# Finer tables are integrated block by block.
_MOST_KINKS, _BLOCKS, _BLOCK_DEGREE = 1500, 400, 5
# A block whose polynomial is not positive is cut into so many parts, none of which is narrower, over length.
_PARTS, _NARROWEST = 25, 1e-9
# Cells narrower than this, over length, are small parts of a block.
_SMALL_PART = 5e-4
# Points in a cell, at least.
_FEWEST = 2
# Larger errors of what functions are cut into would show in the results.
_PARTS_LEFT = 1e-11
# Up to this many cells curvature is a polynomial of its own on each.
_OWN_CURVATURE = 40
# Beyond, the bending moment is one on each of spans, which end on all breaks unless these are more.
_MOST_SPANS = 100


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Gauss points of a beam with L = mean EI = mean ρA = 1, and the curvatures that it may have there.

    The beam is smooth on each cell. With c the coordinates of its curvature,

        κ(x_i) = Σ curvature_ij c_j,      z'(x_i) = Σ slope_ij c_j,      z(x_i) = Σ deflection_ij c_j,

    where z'' = κ, z(0) = z'(0) = 0 and integrals are those of the polynomial through a cell's points.

    Where cells are few, c is the curvature itself at the points. Where they are many, as the 1,000 of a fine
    table, c describes the bending moment, EI κ, by a polynomial on each of some tens of spans: the moment is
    smooth where EI is not. Cells then only serve to integrate.

    Parameters
    ----------
    edges : ndarray, shape (cells + 1,)
        0, what the beam is smooth between, and 1.
    sizes : ndarray of int, shape (cells,)
        Points in each cell.
    x, weight : ndarray, shape (points,)
        Gauss-Legendre positions and weights.
    stiffness, mass, rotary : ndarray, shape (points,)
        EI, ρA and ρI there.
    shear : ndarray, shape (points,), or None
        κGA there, of a beam that has it.
    curvature, slope, deflection : ndarray, shape (points, coordinates)
        As above.
    """

    edges: Floats
    sizes: NDArray[np.int64]
    x: Floats
    weight: Floats
    stiffness: Floats
    mass: Floats
    rotary: Floats
    shear: Floats | None
    curvature: Floats
    slope: Floats
    deflection: Floats

    @property
    def has_own_curvature(self) -> bool:
        """True where the coordinates are the curvatures at the points."""
        return len(self.edges) - 1 <= _OWN_CURVATURE

    def integral(self, values: Floats) -> Floats:
        """Return the integrals from 0 to each point of values at all points."""
        return self.integrals(values[:, None])[:, 0]

    def integrals(self, columns: Floats) -> Floats:
        """Return the integrals from 0 to each point of columns of values at all points."""
        return _integrals(self.edges, self.sizes, self.weight, columns)[0]


@dataclass(frozen=True, slots=True, eq=False)
class _Smoothed:
    """Polynomials on some 400 blocks in place of a table of very many kinks, whose moments they have.

    A block's polynomial, of degree 5, is the projection of 1/EI, or of ρA or ρI: all integrals of it times a
    polynomial of that degree are the table's. The bending moment and deflection differ from such polynomials
    by (block times their wavenumber)⁶ of themselves.

    Of a rough table the polynomial may not be positive. Such a block is cut into 25 parts, each with its own
    polynomial of degree 5, or 1, or two constants that meet at the part's centre of gravity c in a..b, with
    (b - c)/(b - a) of its integral before c. These are positive and keep the integral and c. They leave out
    (part times wavenumber)²/12 at most, of a part. Parts err as they are drawn: of four frequencies of a
    table of 2,000 random EI, up to 30 times each other, 5e-12 is left out.
    """

    edges: Floats
    series: Floats
    reciprocal: bool

    @classmethod
    def of(cls, table: Table, breaks: tuple[float, ...], reciprocal: bool) -> _Smoothed:
        length = table.x[-1]
        # Half of them even, half as the table's positions crowd.
        every = np.array(table.x)[np.linspace(0, len(table.x) - 1, _BLOCKS // 2 + 1).round().astype(int)]
        even = np.linspace(0.0, length, _BLOCKS // 2 + 1)
        edges = np.unique(np.concatenate((even, every, breaks)))
        # Where two of these nearly meet, one of them is enough unless both are breaks.
        kept = np.isin(edges, (0.0, *breaks, length))
        kept |= np.append(True, np.diff(edges) > _NARROWEST * length)
        edges = np.array(each_place_once(edges[kept].tolist(), length))
        series = _projection(table, edges, reciprocal)
        rough = ~_stays_positive(series)
        if not rough.any():
            return cls(edges, series, reciprocal)
        share = np.linspace(0.0, 1.0, _PARTS + 1)[1:-1]
        cut = edges[:-1][rough][:, None] + np.diff(edges)[rough][:, None] * share
        cut = cut[np.diff(edges)[rough] > _PARTS * _NARROWEST * length]
        known, edges = edges, np.unique(np.concatenate((edges, cut.ravel())))
        parts = _projection(table, edges, reciprocal)
        block = np.clip(np.searchsorted(known, edges[:-1], side="right") - 1, 0, len(known) - 2)
        whole = ~rough[block]
        parts[:, whole] = series[:, block[whole]]
        parts[2:, ~_stays_positive(parts)] = 0.0
        paired = ~_stays_positive(parts)
        mean = parts[0, paired]
        centre = np.clip(parts[1, paired] / (3.0 * mean), -0.9, 0.9)
        before = np.diff(edges)[paired] * 0.5 * (1.0 + centre)
        # Half of a part's integral times 1 - c is on the share (1 + c)/2 of its width.
        parts[1, paired] = 0.0
        parts[0, paired] = mean * (1.0 - centre) / (1.0 + centre)
        at = np.flatnonzero(paired)
        second = np.zeros((len(parts), len(at)))
        second[0] = mean * (1.0 + centre) / (1.0 - centre)
        return cls(
            np.insert(edges, at + 1, edges[at] + before), np.insert(parts, at + 1, second, axis=1), reciprocal
        )

    def points(self, edges: Floats) -> NDArray[np.int64]:
        """Return how many points each cell needs: 18 on a block, 5 on a small part of one."""
        return np.where(np.diff(edges) > _SMALL_PART * self.edges[-1], 18, 5)

    def __call__(self, x: Floats) -> Floats:
        block = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        place = 2.0 * (x - self.edges[block]) / np.diff(self.edges)[block] - 1.0
        values = np.asarray(np.polynomial.legendre.legval(place, self.series[:, block], tensor=False))
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / values if self.reciprocal else values, dtype=np.float64)


def _stays_positive(series: Floats) -> NDArray[np.bool_]:
    """Return whether each column, a Legendre series, stays above a twentieth of its mean on -1..1."""
    values = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, 65), len(series) - 1) @ series
    positive: NDArray[np.bool_] = values.min(axis=0) >= 0.05 * series[0]
    return positive


def _projection(table: Table, edges: Floats, reciprocal: bool) -> Floats:
    """Return Legendre series, a column for each block, of the polynomials that have a table's moments."""
    points = np.unique(np.concatenate((edges, table.x)))
    low, high = value_at(table, points[:-1], 1), value_at(table, points[1:], -1)
    # As many as the quotient needs, and those that a polynomial beside it does.
    sizes = (_for_quotients(low, high) if reciprocal else _FEWEST) + (_BLOCK_DEGREE + 1) // 2
    sizes = np.broadcast_to(sizes, low.shape)
    middle, half, width = 0.5 * (points[1:] + points[:-1]), 0.5 * np.diff(points), np.diff(edges)
    owner = np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(edges) - 2)
    place, share = 2.0 * (middle - edges[owner]) / width[owner] - 1.0, 2.0 * half / width[owner]
    series = np.zeros((_BLOCK_DEGREE + 1, len(width)))
    for size in np.unique(sizes).tolist():
        cells = np.flatnonzero(sizes == size)
        for node, weight in zip(*np.polynomial.legendre.leggauss(size), strict=True):
            values = 0.5 * (high[cells] + low[cells] + (high[cells] - low[cells]) * node)
            mass = half[cells] * weight * (1.0 / values if reciprocal else values)
            basis = np.polynomial.legendre.legvander(place[cells] + share[cells] * node, _BLOCK_DEGREE)
            for k in range(_BLOCK_DEGREE + 1):
                series[k] += np.bincount(owner[cells], mass * basis[:, k], len(width))
    return series * (2.0 * np.arange(_BLOCK_DEGREE + 1)[:, None] + 1.0) / width


class _Sections(NamedTuple):
    """The properties as they are integrated, and the positions between which all are smooth, of length 1."""

    profiles: tuple[Profile, Profile, Profile, Profile | None]
    edges: Floats


def _sections(beam: Beam) -> _Sections:
    places, profiles = {0.0, beam.length}, list[Profile | None]()
    for name in _PROPERTIES:
        profile = getattr(beam, name)
        if profile is None:
            profiles.append(None)
            continue
        inside = profile_parts(profile, beam.length)
        if isinstance(profile, Table) and len(inside) > _MOST_KINKS:
            smoothed = _Smoothed.of(profile, profile_breaks(profile), name.endswith("stiffness"))
            profile, inside = smoothed, tuple(smoothed.edges.tolist())
        elif callable(profile) and (left := smooth_parts(profile, beam.length)[1]) > _PARTS_LEFT:
            raise ArithmeticError(
                f"{name} must be smooth between the beam's breaks but for a few steps, kinks or narrow "
                f"features, or its integral is not known to 1e-11 but to {left:.1g}: give their positions as "
                "breaks, or the property as a Table"
            )
        places.update(inside)
        profiles.append(profile)
    edges = np.array(each_place_once(sorted(places), beam.length)) / beam.length
    bending, mass, rotary, shear = profiles
    assert bending is not None and mass is not None and rotary is not None
    return _Sections((bending, mass, rotary, shear), edges)


def section_grid(beam: Beam, points: int, least: int) -> Grid:
    """Return the grid of a beam: so many points shared out by length, and at least so many in each cell.

    Examples
    --------
    >>> grid = section_grid(Beam(2.0, [3.0, 1.0], 1.0), points=8, least=6)
    >>> grid.sizes.tolist(), round(float(grid.weight.sum()), 12), grid.stiffness[0].item()
    ([10, 10], 1.0, 1.5)
    """
    profiles, edges = _sections(beam)
    width = np.diff(edges)
    quotients = [_cell_points(profile, edges * beam.length) for profile in (profiles[0], profiles[3] or 1.0)]
    sizes = np.ceil(points * width).astype(int) + np.maximum(*quotients)
    own, step = len(width) <= _OWN_CURVATURE, least // 2
    # Cells that only serve to integrate know their function already, and may be thousands.
    sizes += least - _FEWEST if own else np.where(width > 1e-3, step, 0)
    x, weight = np.empty(sizes.sum()), np.empty(sizes.sum())
    for size, cells, part in _alike(sizes):
        node, plain = np.polynomial.legendre.leggauss(size)
        half = 0.5 * width[cells, None]
        x[part], weight[part] = edges[cells, None] + half * (1.0 + node), half * plain
    length, stiffness, mass = beam.length, beam.mean_bending_stiffness, beam.mean_mass_per_length
    at = x * length
    bending, heavy, turning, shear = (
        None if profile is None else _positive(name, profile, at)
        for name, profile in zip(_PROPERTIES, profiles, strict=True)
    )
    assert bending is not None and heavy is not None and turning is not None
    bending = bending / stiffness
    if own:
        curvature = np.eye(len(x))
    else:
        spans = _spans(edges, np.array(beam.breaks) / beam.length, 6 * step)
        curvature = _moments_on_spans(spans, x, points, step + 1) / bending[:, None]
    slope, deflection = _integrals(edges, sizes, weight, curvature)
    return Grid(
        edges=edges,
        sizes=sizes,
        x=x,
        weight=weight,
        stiffness=bending,
        mass=heavy / mass,
        rotary=turning / mass / length**2,
        shear=None if shear is None else shear / stiffness * length**2,
        curvature=curvature,
        slope=slope,
        deflection=deflection,
    )


def _cell_points(stiffness: Profile, edges: Floats) -> NDArray[np.int64]:
    """Return how many points each cell needs for 1/EI, whatever it is multiplied with."""
    if isinstance(stiffness, _Smoothed):
        return stiffness.points(edges)
    if isinstance(stiffness, Table):
        return _for_quotients(value_at(stiffness, edges[:-1], 1), value_at(stiffness, edges[1:], -1))
    return np.full(len(edges) - 1, 18 if callable(stiffness) and len(edges) > 2 else _FEWEST)


def _for_quotients(left: Floats, right: Floats) -> NDArray[np.int64]:
    """Return how many points integrate 1/EI to the last digit, EI being linear from one value to another.

    The error of n points falls as ((√b - √a)/(√b + √a))^(2n).
    """
    ratio = np.abs(np.sqrt(right) - np.sqrt(left)) / (np.sqrt(right) + np.sqrt(left))
    points = np.clip(np.ceil(-7.5 / np.log10(np.clip(ratio, 1e-15, 0.99))), _FEWEST, 60)
    return np.asarray(points, dtype=np.int64)


def _spans(edges: Floats, breaks: Floats, number: int) -> Floats:
    """Return the edges of spans: every so many cells, and all breaks unless these are many themselves."""
    even = edges[np.linspace(0, len(edges) - 1, number + 1).round().astype(int)]
    kept = breaks if len(breaks) < _MOST_SPANS else breaks[:0]
    # A span ends on the cell's edge that the break is.
    nearest = edges[np.abs(edges[:, None] - kept).argmin(axis=0)] if len(kept) else kept
    return np.unique(np.concatenate((even, nearest)))


def _moments_on_spans(spans: Floats, x: Floats, points: int, least: int) -> Floats:
    """Return Legendre polynomials on each span at the points, a column each."""
    sizes = least + np.ceil(points * np.diff(spans)).astype(int)
    starts = np.concatenate(([0], np.cumsum(sizes)))
    owner = np.clip(np.searchsorted(spans, x, side="right") - 1, 0, len(sizes) - 1)
    values = np.zeros((len(x), starts[-1]))
    for span, size in enumerate(sizes.tolist()):
        here = np.flatnonzero(owner == span)
        place = 2.0 * (x[here] - spans[span]) / (spans[span + 1] - spans[span]) - 1.0
        columns = slice(starts[span], starts[span + 1])
        values[here, columns] = np.polynomial.legendre.legvander(place, size - 1)
    return values


def _alike(sizes: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.int64]]]:
    """Yield every number of points, the cells that have it, and their points, shape (cells, number)."""
    starts = np.cumsum(sizes) - sizes
    for size in np.unique(sizes).tolist():
        cells = np.flatnonzero(sizes == size)
        yield size, cells, starts[cells, None] + np.arange(size)


def _integrals(
    edges: Floats, sizes: NDArray[np.int64], weight: Floats, curvature: Floats
) -> tuple[Floats, Floats]:
    """Return the first and second integral from 0 to each point of columns of values at all points."""
    width, columns = np.diff(edges), curvature.shape[1]
    slope, deflection = np.empty_like(curvature), np.empty_like(curvature)
    turn, rise = np.empty((len(sizes), columns)), np.empty((len(sizes), columns))
    for size, cells, part in _alike(sizes):
        once, twice = _within(size)
        node = np.polynomial.legendre.leggauss(size)[0]
        here, half = curvature[part], 0.5 * width[cells, None, None]
        slope[part], deflection[part] = half * (once @ here), half**2 * (twice @ here)
        weighted = weight[part][:, :, None] * here
        turn[cells] = weighted.sum(axis=1)
        rise[cells] = ((0.5 * width[cells, None, None]) * (1.0 - node)[:, None] * weighted).sum(axis=1)
    # What the cells before have turned and risen is carried on along a straight line.
    turned = np.cumsum(turn, axis=0) - turn
    risen = rise + turned * width[:, None]
    risen = np.cumsum(risen, axis=0) - risen
    for size, cells, part in _alike(sizes):
        node = np.polynomial.legendre.leggauss(size)[0]
        arm = 0.5 * width[cells, None, None] * (1.0 + node)[:, None]
        slope[part] += turned[cells][:, None, :]
        deflection[part] += risen[cells][:, None, :] + arm * turned[cells][:, None, :]
    return slope, deflection


@lru_cache(maxsize=128)
def _within(size: int) -> tuple[Floats, Floats]:
    """Return the matrices from values at Gauss points in -1..1 to both integrals there."""
    node = np.polynomial.legendre.leggauss(size)[0]
    once = legendre_integral(legendre_of_values(size))
    twice = legendre_integral(once)
    at = (np.polynomial.legendre.legval(node, series).T for series in (once, twice))
    first, second = (np.ascontiguousarray(matrix, dtype=np.float64) for matrix in at)
    return first, second


@lru_cache(maxsize=128)
def legendre_of_values(size: int) -> Floats:
    """Return the matrix that takes values at Gauss points to Legendre coefficients, shape (size, size)."""
    node, weight = np.polynomial.legendre.leggauss(size)
    values = np.polynomial.legendre.legvander(node, size - 1)
    matrix: Floats = (np.arange(size) + 0.5)[:, None] * values.T * weight
    return matrix


def legendre_integral(series: Floats) -> Floats:
    """Return the Legendre coefficients, along the first axis, of the integral that is zero at -1."""
    return np.asarray(np.polynomial.legendre.legint(series, lbnd=-1, axis=0), dtype=np.float64)


def _positive(name: str, profile: Profile, x: Floats) -> Floats:
    values: Floats = value_at(profile, x)
    if isinstance(profile, float):
        # One that the beam has checked; infinite against shear that is left out.
        return values
    may_vanish = name == "rotary_inertia_per_length"
    wrong = ~((values > 0.0) | ((values == 0.0) & may_vanish)) | ~np.isfinite(values)
    if wrong.any():
        at, bound = int(np.argmax(wrong)), "not negative" if may_vanish else "greater than 0"
        raise ValueError(f"{name} must be finite and {bound}, got {values[at]} at x = {x[at]}")
    return values
