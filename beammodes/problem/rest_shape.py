"""Rest shapes of rods: the curvature of the centre line and the twist of the section along it.

A rod's section has axes x along the centre line, y and z across it. They turn along the rod,

    R' = R [κ ×],   r' = R e_x,        κ = (κ_x, κ_y, κ_z)  [1/m], in the section's own axes:

κ_x is the section's turning about the centre line (pretwist, and the torsion of the line), κ_y and κ_z bend
the line about y and z. All that is known of a rest shape is κ of s, the distance along the line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import bounded, real, real_numbers, shown, unwrapped
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import accumulated, carried
from beammodes.problem.profiles import SAME_PLACE, function_values

__all__ = [
    "BendsAlong",
    "Curvature",
    "CurvatureLike",
    "CurvatureSteps",
    "LineThroughPoints",
    "check_turns",
    "curvature_at",
    "even_parts",
    "kept_curvature",
    "shape_breaks",
    "shape_frames",
]

_MOST_PARTS, _GRID = 10_000, 65
#: Radians over the length of a rod.
_MOST_TURNING = 1e9
_WANTED = "three numbers (κx, κy, κz), or such a triple for each of several equal parts"

#: Cells of a measured line from point to point on which its frames are kept.
_CELLS = 64

#: Stretches of such a line that are even enough for a judge's equal steps.
_EVEN = 64


@dataclass(frozen=True, slots=True)
class CurvatureSteps:
    """A curvature that is constant on parts of a rod, which end at `edges`, ascending, the last at L."""

    edges: tuple[float, ...]
    values: tuple[tuple[float, float, float], ...]

    def __call__(self, s: Floats) -> Floats:
        """Return κ at positions, shape (n, 3)."""
        part = np.searchsorted(self.edges[:-1], s, side="right")
        return np.array(self.values)[part]


@dataclass(frozen=True, slots=True)
class BendsAlong:
    """A curvature by a user's function of s, smooth but at `breaks`."""

    function: Callable[[Any], Any]
    breaks: tuple[float, ...] = ()

    def __call__(self, s: Floats) -> Floats:
        """Return κ at positions, shape (n, 3)."""
        return np.stack([function_values(_Component(self.function, k), s) for k in range(3)], axis=-1)


@dataclass(frozen=True, slots=True)
class _Component:
    function: Callable[[Any], Any]
    component: int

    def __call__(self, s: Any) -> Any:
        return self.function(s)[self.component]


@dataclass(frozen=True)
class LineThroughPoints:
    """The curvature of a smooth line through points in space; its section does not turn about it.

    The line is a spline of fifth degree, so that its curvature and that one's rate are smooth; through four
    or five points it is one of third degree, whose curvature has a kink at the middle one of five. The
    section is carried along without turning about the line (Bishop's frame), from `up` on, and is then turned
    further at the constant rate `twist`.

    Attributes
    ----------
    points : tuple of (x, y, z) [m]
    up : (x, y, z)
        Where the section's y axis points at the first point, as far as it is across the line.
    twist : float [rad/m]
    """

    points: tuple[tuple[float, float, float], ...]
    up: tuple[float, float, float]
    twist: float = 0.0

    @cached_property
    def _spline(self) -> tuple[Any, Floats, Floats, Floats, Floats]:
        """Return the spline, and at places of its parameter their distance along it and their axes."""
        from scipy.interpolate import make_interp_spline

        points = np.array(self.points)
        chord = np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1))
        knots = np.concatenate([[0.0], np.cumsum(chord)])
        spline = make_interp_spline(knots, points, k=5 if len(points) > 5 else 3)
        place = np.interp(np.arange(_CELLS * (len(points) - 1) + 1) / _CELLS, np.arange(len(points)), knots)
        along = np.concatenate([[0.0], np.cumsum(_distances(spline, place[:-1], place[1:]))])
        tangent = _unit(spline(place, 1))
        normals = [_unit(np.array(self.up) - tangent[0] * (tangent[0] @ self.up))]
        at = spline(place)
        for k in range(len(place) - 1):
            normals.append(_reflected(normals[-1], at[k], tangent[k], at[k + 1], tangent[k + 1]))
        return spline, place, along, np.array(normals), tangent

    @property
    def length(self) -> float:
        """Of the line [m]."""
        return float(self._spline[2][-1])

    @property
    def sharpest(self) -> tuple[float, int]:
        """How far the line turns at most within a 64th of the way between two points [rad], and which."""
        tangent = self._spline[4]
        turns = np.arctan2(
            np.sqrt((np.cross(tangent[:-1], tangent[1:]) ** 2).sum(axis=1)),
            (tangent[:-1] * tangent[1:]).sum(axis=1),
        )
        worst = int(np.argmax(turns))
        return float(turns[worst]), worst // _CELLS

    @property
    def even_parts(self) -> tuple[float, ...]:
        """Distances along the line between which it is smooth, denser where it bends more [m]."""
        # At points, and between them where they are few; at some of many.
        intervals = len(self.points) - 1
        cells = (
            _CELLS // max(1, _EVEN // intervals) if intervals <= _EVEN else _CELLS * -(-intervals // _EVEN)
        )
        return tuple(self._spline[2][cells:-1:cells].tolist())

    def __call__(self, s: Floats) -> Floats:
        """Return κ at positions, shape (n, 3)."""
        spline, place, along, normals, tangents = self._spline
        at = np.interp(s, along, place)
        # Newton's steps on the distance, whose rate is the spline's speed; it is smooth within a cell.
        cell = np.clip(np.searchsorted(along, s) - 1, 0, len(place) - 2)
        for _ in range(3):
            missed = along[cell] + _distances(spline, place[cell], at) - s
            at = at - missed / _speed(spline, at)
        first, second = spline(at, 1), spline(at, 2)
        tangent = _unit(first)
        bend = np.cross(first, second) / np.sqrt((first**2).sum(axis=1, keepdims=True)) ** 3
        y = _reflected(normals[cell], spline(place[cell]), tangents[cell], spline(at), tangent)
        z = np.cross(tangent, y)
        turn = self.twist * s
        cos, sin = np.cos(turn), np.sin(turn)
        about_y, about_z = (bend * y).sum(axis=1), (bend * z).sum(axis=1)
        return np.stack(
            [np.full_like(s, self.twist), cos * about_y + sin * about_z, cos * about_z - sin * about_y], -1
        )


def _speed(spline: Any, place: Floats) -> Floats:
    """Return how far a spline goes per unit of its parameter."""
    speed: Floats = np.sqrt((spline(place, 1) ** 2).sum(axis=1))
    return speed


def _distances(spline: Any, start: Floats, stop: Floats) -> Floats:
    """Return how far it goes between places of its parameter, by Gauss's rule, shape (n,)."""
    node, weight = _gauss()
    half = 0.5 * (stop - start)
    inner = start[:, None] + half[:, None] * (1.0 + node)
    along: Floats = half * (_speed(spline, inner.ravel()).reshape(inner.shape) @ weight)
    return along


@cache
def _gauss() -> tuple[Floats, Floats]:
    return np.polynomial.legendre.leggauss(8)


def _unit(vector: Floats) -> Floats:
    unit: Floats = vector / np.sqrt((vector**2).sum(axis=-1, keepdims=True))
    return unit


def _reflected(normal: Floats, here: Floats, tangent: Floats, there: Floats, onward: Floats) -> Floats:
    """Return a normal carried on without turning about the line (double reflection, Wang et al. 2008)."""

    def mirrored(vector: Floats, across: Floats) -> Floats:
        square = (across**2).sum(axis=-1, keepdims=True)
        share = np.divide(
            (across * vector).sum(axis=-1, keepdims=True), square, out=np.zeros_like(square), where=square > 0
        )
        image: Floats = vector - 2.0 * share * across
        return image

    step = there - here
    return mirrored(mirrored(normal, step), onward - mirrored(tangent, step))


#: κ as a rod keeps it.
Curvature: TypeAlias = tuple[float, float, float] | CurvatureSteps | BendsAlong | LineThroughPoints

#: What a user may give for it.
CurvatureLike: TypeAlias = Curvature | Sequence[Any] | NDArray[Any] | Callable[[Any], Any]


def kept_curvature(given: CurvatureLike, length: float, breaks: tuple[float, ...]) -> Curvature:
    """Return the curvature of a rod of this length as it is kept.

    Raises
    ------
    TypeError, ValueError
        If it is none of what `Rod` takes.

    Examples
    --------
    >>> kept_curvature([(0, 0, 0), (0, 0, 2)], 1.0, ())
    CurvatureSteps(edges=(0.5, 1.0), values=((0.0, 0.0, 0.0), (0.0, 0.0, 2.0)))
    """
    if isinstance(given, LineThroughPoints):
        return given
    if isinstance(given, CurvatureSteps):
        if abs(given.edges[-1] - length) > SAME_PLACE * length:
            raise ValueError(f"curvature must end at the rod's length {length}, got {given.edges[-1]}")
        _check_turning(np.array(given.values), length)
        return given
    if isinstance(given, BendsAlong):
        return _tried(BendsAlong(given.function, given.breaks or breaks), length)
    if callable(given):
        return _tried(BendsAlong(given, breaks), length)
    given = unwrapped("curvature", given)
    if not isinstance(given, Iterable) or isinstance(given, (str, bytes)):
        raise TypeError(
            f"curvature must be {_WANTED}, or a function of s that returns three, got {shown(given)}"
        )
    rows = real_numbers("curvature", bounded("curvature", given, most=_MOST_PARTS))
    if rows.shape == (3,):
        _check_turning(rows, length)
        return _three(rows)
    if rows.ndim != 2 or rows.shape[1] != 3 or not len(rows):
        raise ValueError(f"curvature must be {_WANTED}, got {shown(given)}")
    _check_turning(rows, length)
    edges = tuple(length * (part + 1) / len(rows) for part in range(len(rows)))
    return CurvatureSteps(edges, tuple(_three(row) for row in rows))


def _three(row: Floats) -> tuple[float, float, float]:
    x, y, z = (row + 0.0).tolist()
    return x, y, z


def _tried(bends: BendsAlong, length: float) -> BendsAlong:
    grid = 0.5 * length * (1.0 - np.cos(np.pi * (np.arange(_GRID) + 0.5) / _GRID))
    for s in grid.tolist():
        try:
            values = [real("curvature", np.asarray(value).item()) for value in bends.function(s)]
        except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
            raise TypeError(
                "curvature must be a function of s that returns three numbers, got "
                f"{shown(bends.function)}, which fails at s = {s}: {type(error).__name__}: {error}"
            ) from error
        if len(values) != 3:
            raise ValueError(f"curvature must have three components, got {len(values)} at s = {s}")
        _check_turning(np.array(values), length)
    return bends


def check_turns(name: str, given: float, angle: float) -> None:
    """Raise ValueError if a number makes a rod turn by an angle beyond that of any rod.

    Examples
    --------
    >>> check_turns("turns", 3.0, 6 * np.pi)
    """
    if not abs(angle) <= _MOST_TURNING:
        raise ValueError(
            f"{name} must turn a rod by at most {_MOST_TURNING:g} radians, got {given:g}, {angle:g} radians"
        )


def _check_turning(values: Floats, length: float) -> None:
    """Raise ValueError if a curvature is beyond that of any rod, and of what floats can follow."""
    largest = float(np.abs(values).max(initial=0.0))
    if not largest <= _MOST_TURNING / length:
        raise ValueError(
            f"curvature must turn a rod by at most {_MOST_TURNING:g} radians over its length of {length:g}, "
            f"got {largest:g}"
        )


def shape_breaks(curvature: Curvature) -> tuple[float, ...]:
    """Return the positions inside a rod at which its curvature is not smooth."""
    if isinstance(curvature, CurvatureSteps):
        return curvature.edges[:-1]
    if isinstance(curvature, LineThroughPoints):
        # The spline's fifth derivative steps at its points, the curvature's third: no rule feels it.
        return ()
    return curvature.breaks if isinstance(curvature, BendsAlong) else ()


def even_parts(curvature: Curvature) -> tuple[float, ...]:
    """Return positions inside a rod between which equal steps follow its shape, ascending.

    Examples
    --------
    >>> even_parts(CurvatureSteps((0.5, 1.0), ((0.0, 0.0, 0.0), (0.0, 0.0, 2.0))))
    (0.5,)
    """
    return curvature.even_parts if isinstance(curvature, LineThroughPoints) else shape_breaks(curvature)


def curvature_at(curvature: Curvature, s: Floats) -> Floats:
    """Return κ at positions, shape (n, 3).

    Examples
    --------
    >>> curvature_at((0.0, 0.0, 2.0), np.zeros(1)).tolist()
    [[0.0, 0.0, 2.0]]
    """
    if isinstance(curvature, tuple):
        return np.broadcast_to(np.array(curvature), (len(s), 3))
    return curvature(s)


def shape_frames(curvature: Curvature, s: Floats) -> tuple[Floats, Floats]:
    """Return section axes and positions of a rod's centre line at ascending positions from 0 on.

    The section at s = 0 has the axes of space and lies at its origin. Between two of the positions the
    curvature must be smooth: breaks are to be among them.

    Returns
    -------
    ndarray, ndarray
        R, whose columns are the section's axes, shape (n, 3, 3), and r [m], shape (n, 3).

    Examples
    --------
    >>> import math
    >>> shape_frames((0.0, 0.0, math.pi), np.array([0.0, 1.0]))[1].round(12)[1, :2]          # half a circle
    array([0.        , 0.63661977])
    """
    from_zero = np.concatenate([[0.0], s])

    def rate(at: Floats) -> Floats:
        return curvature_at(curvature, at)

    frames, places = accumulated(*carried(rate, from_zero[:-1], from_zero[1:]))
    return frames[1:], places[1:]
