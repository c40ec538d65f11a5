"""Loads that vary in time, dead or turning with the segment that they act on, shared out to a chain's pieces.

Each load is a fixed pattern times one course. Of a pattern every piece has seven numbers: a force that keeps
its direction, (f_x, f_y), and its first moment (s_x, s_y) along the piece about the centre of mass; a force
(f_t, f_n) along and across the piece, which turns with it; and a moment m. At the angle θ they make

    F = (f_x, f_y) + R(θ) (f_t, f_n),        M = m - s_x sin θ + s_y cos θ

at the centre of mass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import Shown, bounded, flag, is_text, not_negative, shown, unwrapped
from beammodes.dynamics.waveforms import Waveform
from beammodes.numerics.arrays import Floats
from beammodes.problem.applied_loads import LineLoad, PointLoad
from beammodes.problem.loading import NO_LOAD, Load
from beammodes.problem.profiles import SAME_PLACE, Table, check_kinds

__all__ = ["COLUMNS", "AnyLoad", "TimedLoad", "pattern", "read_loads"]

#: How many numbers of a pattern each piece has.
COLUMNS = 7
_FX, _FY, _SX, _SY, _FT, _FN, _M = range(COLUMNS)
_MOST_BREAKS, _MOST_LOADS = 100_000, 1000
# Nodes of Gauss's rule: exact for the polynomials of highest degree that a LineLoad takes, and one more.
_GAUSS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True, repr=False)
class TimedLoad(Shown):
    """A load times a course of time.

    Parameters
    ----------
    load : Load, PointLoad or LineLoad
        What is multiplied: gravity, axial force, tip force and moment of a `Load`; a force and a moment at a
        place x; a load spread along the beam. The torque on a driven hub is the moment of a PointLoad at x=0.
    course : function of an array of times [s], or Table, optional
        A number for each time: a `Sine`, `Step`, `Pulse` or `Chirp`, any function, or a `Table` over times
        from 0, linear between them, with jumps where a time is given twice; beyond its last time it keeps
        its last value. Constant by default.
    follower : bool
        False: forces keep their directions. True: they turn with the segment on which they act, a force
        (F_x, F_y) being along and across it.
    breaks : sequence of float [s]
        Where a function of your own jumps or kinks, so that steps end there; other courses know it.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, a load turns a hub (`spin_rate`) or is on a structure's member or
        joint, or gravity or an axial force is to follow.

    Examples
    --------
    >>> import beammodes as bm
    >>> tip = bm.TimedLoad(bm.Load(tip_force=0.5), bm.Sine(frequency=3.0))
    >>> tip.at(np.array([0.0, 1 / 12])).round(6)
    array([0., 1.])
    """

    load: Load | PointLoad | LineLoad
    course: Waveform | Table | None = None
    follower: bool = False
    breaks: Sequence[float] = ()

    def __post_init__(self) -> None:
        load, course = self.load, self.course
        if not isinstance(load, Load | PointLoad | LineLoad):
            raise TypeError(f"load must be a Load, a PointLoad or a LineLoad, got {shown(load)}")
        # A class such as Sine itself is no course.
        if course is not None and (
            isinstance(course, type) or not (isinstance(course, Table) or callable(course))
        ):
            raise TypeError(f"course must be a function of time, a Table or None, got {shown(course)}")
        flag("follower", self.follower)
        if is_text(self.breaks):
            raise TypeError(f"breaks must be times, got {shown(self.breaks)}")
        if isinstance(course, Table):
            check_kinds("course", course, x="s")
        given = bounded("breaks", unwrapped("breaks", self.breaks, "s"), most=_MOST_BREAKS)
        object.__setattr__(self, "breaks", tuple(sorted(not_negative("breaks", time, "s") for time in given)))
        if isinstance(load, Load):
            if load.spin_rate or load.hub_radius:
                raise ValueError(
                    f"load must have no spin_rate and no hub_radius here, got {shown(str(load))}"
                )
            if self.follower and (any(load.weight) or load.axial_force):
                raise ValueError(
                    f"follower must be False for gravity and an axial force, got True with {shown(str(load))}"
                )
        elif load.member is not None or (isinstance(load, PointLoad) and load.joint is not None):
            raise ValueError(f"load must be on a beam, without member and joint, got {shown(load)}")

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which it jumps or kinks, ascending [s]."""
        own = self.course.x if isinstance(self.course, Table) else getattr(self.course, "breaks", ())
        return tuple(sorted({*self.breaks, *map(float, own)}))

    @property
    def fastest(self) -> float | None:
        """How fast it varies between its jumps [rad/s], None if its course does not tell."""
        if self.course is None or isinstance(self.course, Table):
            return 0.0
        return getattr(self.course, "fastest", None)

    def at(self, time: Floats) -> Floats:
        """Return what the load is multiplied by at an array of times; at a jump, after it.

        Raises
        ------
        ValueError
            If the course does not give one finite real number for each time.
        """
        course = self.course
        if course is None:
            return np.ones(np.shape(time))
        if isinstance(course, Table):
            return _interpolated(course, time)
        expected = "course must give one finite number for each of an array of times"
        try:
            values = np.asarray(course(time))
        except (TypeError, ValueError) as error:
            hint = "np.sin, not math.sin; np.where, not if; or np.vectorize(course)"
            raise ValueError(f"{expected} ({hint}): {error}") from error
        if values.shape != np.shape(time) or values.dtype.kind not in "fiu" or not np.isfinite(values).all():
            raise ValueError(f"{expected}, got {shown(values)}")
        return np.asarray(values, dtype=np.float64)


#: What `simulate` takes as a load.
AnyLoad = Load | PointLoad | LineLoad | TimedLoad


def _interpolated(table: Table, time: Floats) -> Floats:
    x, value = np.array(table.x), np.array(table.value)
    cell = np.clip(np.searchsorted(x, time, side="right") - 1, 0, len(x) - 2)
    share = np.clip((time - x[cell]) / (x[cell + 1] - x[cell]), 0.0, 1.0)
    return np.asarray((1.0 - share) * value[cell] + share * value[cell + 1])


def read_loads(load: AnyLoad | Sequence[AnyLoad] | None) -> tuple[Load, tuple[TimedLoad, ...]]:
    """Return the constant `Load` among loads, at most one, and all others as `TimedLoad`s.

    Examples
    --------
    >>> constant, timed = read_loads([Load(gravity=9.81), PointLoad(0.5, force=-2.0)])
    >>> constant.gravity, timed[0].course
    ((0.0, -9.81), None)
    """
    if load is None or isinstance(load, Load):
        return NO_LOAD if load is None else load, ()
    expected = "load must be a Load, a PointLoad, a LineLoad, a TimedLoad or a list of them"
    if isinstance(load, PointLoad | LineLoad | TimedLoad):
        load = [load]
    if not isinstance(load, list | tuple):
        raise TypeError(f"{expected}, got {shown(load)}")
    given: list[Any] = bounded("load", load, most=_MOST_LOADS)
    for one in given:
        if not isinstance(one, Load | PointLoad | LineLoad | TimedLoad):
            raise TypeError(f"{expected}, got {shown(one)} among them")
    constant = [one for one in given if isinstance(one, Load)]
    if len(constant) > 1:
        raise ValueError(f"load must hold at most one Load that is constant, got {len(constant)}")
    timed = [one if isinstance(one, TimedLoad) else TimedLoad(one) for one in given if one not in constant]
    return constant[0] if constant else NO_LOAD, tuple(timed)


def pattern(chain: Chain, timed: TimedLoad) -> Floats:
    """Return what a load does to every piece of a chain, before its course, shape (pieces, 7).

    Raises
    ------
    ValueError
        If a place is beyond the beam's end.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "pinned-free", segments=2)
    >>> pattern(chain, TimedLoad(PointLoad(0.75, force=-4.0, moment=1.0)))[1]
    array([ 0., -4.,  0.,  0.,  0.,  0.,  1.])
    """
    table, load = np.zeros((chain.pieces, COLUMNS)), timed.load
    share = _Share(chain, table, timed.follower)
    if isinstance(load, PointLoad):
        share.add_point(load)
    elif isinstance(load, LineLoad):
        share.add_line(load)
    else:
        share.add_load(load)
    return table


class _Share:
    """What is added to the rows of a pattern."""

    def __init__(self, chain: Chain, table: Floats, follower: bool) -> None:
        self.chain, self.table, self.follower = chain, table, follower
        self.node = chain.node_position
        self.end = float(self.node[-1])
        self.small = SAME_PLACE * self.end

    def _push(self, piece: int, arm: float, along: float, across: float) -> None:
        """Add a force at a distance from a piece's centre of mass."""
        row = self.table[piece]
        if self.follower:
            row[[_FT, _FN, _M]] += along, across, arm * across
        else:
            row[[_FX, _FY, _SX, _SY]] += along, across, arm * along, arm * across

    def _at(self, x: float) -> int:
        """Return the piece at a place, at a hinge that to its right; none starts at the end."""
        return max(0, min(int(np.searchsorted(self.node, x + self.small)) - 1, self.chain.pieces - 1))

    def _check_inside(self, name: str, x: float) -> None:
        if x > self.end + self.small:
            raise ValueError(f"{name} must be on the beam, at most its length {self.end}, got {x}")

    def add_point(self, load: PointLoad) -> None:
        assert load.x is not None
        x = float(load.x)
        self._check_inside("x", x)
        force = load.force if isinstance(load.force, tuple) else (0.0, load.force)
        piece = self._at(x) if x > self.small else 0
        self._push(piece, x - float(self.node[piece] + self.chain.centre[piece]), *map(float, force))
        # A moment at a hinge inside is on the pieces on both sides; on an end's own piece where there is one.
        on = {piece}
        if x >= self.end - self.small:
            on = {self.chain.pieces - 1}
        elif x > self.small and piece and abs(x - self.node[piece]) <= self.small:
            on = {piece - 1, piece}
        for one in on:
            self.table[one, _M] += float(load.moment) / len(on)

    def add_line(self, load: LineLoad) -> None:
        start, stop = float(load.start), self.end if load.stop is None else float(load.stop)
        self._check_inside("stop", stop)
        self._check_inside("start", start)
        function, inner = _spread(load, self.end)
        edges = np.unique(np.clip([*self.node, *inner, start, stop], start, stop))
        half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
        x = middle[:, None] + half[:, None] * _GAUSS[0]
        force = half[:, None] * _GAUSS[1] * function(x)
        for k, place in enumerate(middle.tolist()):
            piece = self._at(place)
            centre = float(self.node[piece] + self.chain.centre[piece])
            total = float(force[k].sum())
            arm = float((force[k] * (x[k] - centre)).sum())
            if self.follower:
                self.table[piece, [_FN, _M]] += total, arm
            else:
                self.table[piece, [_FY, _SY]] += total, arm

    def add_load(self, load: Load) -> None:
        chain, last = self.chain, self.chain.pieces - 1
        reach = float(chain.length[last] - chain.centre[last])
        self.table[:, _FX] += chain.mass * float(load.weight[0])
        self.table[:, _FY] += chain.mass * float(load.weight[1])
        self._push(last, reach, float(load.tip[0]), float(load.tip[1]))
        if load.axial_force:
            self._push(last, reach, float(load.axial_force), 0.0)
            self._push(0, -float(chain.centre[0]), -float(load.axial_force), 0.0)
        self.table[last, _M] += float(load.tip_moment)


def _spread(load: LineLoad, length: float) -> tuple[Callable[[Floats], Floats], tuple[float, ...]]:
    """Return the load per length as a function of x, and where it kinks or jumps."""
    given = load.per_length
    if isinstance(given, Table):
        if abs(given.x[-1] - length) > SAME_PLACE * length:
            raise ValueError(
                f"per_length must be a table from 0 to the beam's length {length}, got one to {given.x[-1]}"
            )
        return lambda x: _interpolated(given, x), given.x
    assert isinstance(given, tuple)
    coefficients = np.array([float(c) for c in given])
    return lambda x: np.polynomial.polynomial.polyval(x, coefficients), ()
