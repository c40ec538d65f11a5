"""Prescribed motion of the base that carries a beam's left end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import Shown, not_negative, positive_real, real, real_numbers, shown, told_fields
from beammodes.numerics.arrays import Floats

__all__ = [
    "BaseMotion",
    "Course",
    "at_rest",
    "bang_bang",
    "base_vector",
    "harmonic",
    "point_to_point",
    "spin_up",
]


#: Position, rate and acceleration at times t, each of the shape of t.
Course = Callable[[Floats], tuple[Floats, Floats, Floats]]


def at_rest(time: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the course of what does not move."""
    still = np.zeros_like(time)
    return still, still, still


@dataclass(frozen=True, repr=False)
class BaseMotion(Shown):
    """A base that shifts along x and y and turns, in given courses of time.

    The beam's left end sits at `hub_radius` from the base's origin, along the base's own direction, so that
    it moves on  (x, y) + R (cos φ, sin φ), and what it holds it holds relative to the base.

    Parameters
    ----------
    x, y, angle : function of an array of times [s]
        Gives position, rate and acceleration, [m] or [rad], [m/s], [m/s²]. An attribute `breaks` of it, times
        at which its acceleration jumps, makes steps end there.
    hub_radius : float [m]
        R, from 0.

    Raises
    ------
    TypeError, ValueError
        If a course is no function, or the radius is negative or not finite.

    Examples
    --------
    >>> import beammodes as bm
    >>> base = bm.BaseMotion(y=bm.harmonic(0.01, 3.0))
    >>> base.at(np.array([0.0, 0.5]))[1].round(5)               # y: position, rate, acceleration
    array([[ 0.     ,  0.00997],
           [ 0.03   ,  0.00212],
           [ 0.     , -0.08977]])
    """

    x: Course = at_rest
    y: Course = at_rest
    angle: Course = at_rest
    hub_radius: float = 0.0

    def __post_init__(self) -> None:
        for name in ("x", "y", "angle"):
            if not callable(getattr(self, name)):
                raise TypeError(f"{name} must be a function of time, got {shown(getattr(self, name))}")
        object.__setattr__(self, "hub_radius", not_negative("hub_radius", self.hub_radius))

    @property
    def turns(self) -> bool:
        """True if the base may turn."""
        return self.angle is not at_rest

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which a course says, by an attribute `breaks`, that its acceleration jumps [s]."""
        courses = (self.x, self.y, self.angle)
        return tuple(sorted({float(time) for each in courses for time in getattr(each, "breaks", ())}))

    def at(self, time: ArrayLike) -> Floats:
        """Return x, y and angle of the end, with rates and accelerations, shape (3, 3, *time.shape).

        The first axis is (x, y, angle), the second (position, rate, acceleration).

        Raises
        ------
        ValueError
            If a course does not give three finite arrays of the shape of `time`.
        """
        t = real_numbers("time", time)
        course = np.zeros((3, 3, *t.shape))
        for axis, name in enumerate(("x", "y", "angle")):
            if getattr(self, name) is not at_rest:
                course[axis] += self._course(name, t)
        if self.hub_radius:
            phi, rate, acceleration = course[2]
            out, side = self.hub_radius * np.array([[np.cos(phi), np.sin(phi)], [-np.sin(phi), np.cos(phi)]])
            course[:2, 0] += out
            course[:2, 1] += rate * side
            course[:2, 2] += acceleration * side - rate**2 * out
        return course

    def _course(self, name: str, time: Floats) -> Floats:
        course: Course = getattr(self, name)
        expected = (
            f"{name} must give position, rate and acceleration, finite and one for each time, as harmonic, "
            "spin_up, bang_bang and point_to_point do"
        )
        try:
            parts = [np.asarray(part) for part in course(time)]
        except TypeError as error:
            raise ValueError(f"{expected}: {error}") from error
        if len(parts) != 3 or any(part.shape != time.shape or part.dtype.kind not in "fiu" for part in parts):
            raise ValueError(expected)
        given = np.array(parts, dtype=np.float64)
        if not np.isfinite(given).all():
            raise ValueError(expected)
        return given


def base_vector(base: BaseMotion, time: ArrayLike) -> Floats:
    """Return (x, x', x'', y, y', y'', φ, φ', φ'') of the chain's end at a time or times, shape (9, ...).

    Examples
    --------
    >>> base_vector(BaseMotion(hub_radius=0.5), 0.0)
    array([0.5, 0. , 0. , 0. , 0. , 0. , 0. , 0. , 0. ])
    """
    course = base.at(time)
    return np.asarray(course.reshape(9, *course.shape[2:]))


def harmonic(amplitude: float, angular_frequency: float) -> Course:
    """Return the course  A sin ωt.

    Parameters
    ----------
    amplitude : float [m or rad]
    angular_frequency : float [rad/s]

    Returns
    -------
    Course
        To be given to `BaseMotion`, as a shift [m] or an angle [rad].

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, or the frequency not positive.

    Examples
    --------
    >>> import beammodes as bm
    >>> [float(part[0]) for part in bm.harmonic(2.0, 3.0)(np.zeros(1))]
    [0.0, 6.0, -0.0]
    """
    return _Harmonic(
        real("amplitude", amplitude, "m or rad"), positive_real("angular_frequency", angular_frequency)
    )


class _Course(Shown):
    """Shown as the call that makes it."""

    _called = ""

    def _line(self) -> str:
        return f"{self._called}({', '.join(f'{name}={value!r}' for name, value in told_fields(self))})"


# Courses are values, not functions within functions, which could be neither compared nor sent to a process.
@dataclass(frozen=True, repr=False)
class _Harmonic(_Course):
    _called = "harmonic"

    amplitude: float
    angular_frequency: float

    def __call__(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        size, omega = self.amplitude, self.angular_frequency
        sine, cosine = np.sin(omega * time), np.cos(omega * time)
        return size * sine, size * omega * cosine, -size * omega**2 * sine


def spin_up(rate: float, duration: float) -> Course:
    """Return the course of a smooth run-up to a constant rate.

        φ = (Ω/T) (t²/2 + (T/2π)² (cos 2πt/T - 1))  to T,   Ω (t - T/2)  after it

    Parameters
    ----------
    rate : float [rad/s]
        Ω.
    duration : float [s]
        T.

    Returns
    -------
    Course
        To be given to `BaseMotion` as its angle [rad].

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, or the duration not positive.

    References
    ----------
    J. C. Simo and L. Vu-Quoc, On the dynamics of flexible beams under large overall motions, Journal of
    Applied Mechanics 53 (1986), 855-863.

    Examples
    --------
    >>> import beammodes as bm
    >>> [float(part[0]) for part in bm.spin_up(6.0, 15.0)(np.array([15.0]))]
    [45.0, 6.0, 0.0]
    """
    return _SpinUp(real("rate", rate), positive_real("duration", duration))


@dataclass(frozen=True, repr=False)
class _SpinUp(_Course):
    _called = "spin_up"

    rate: float
    duration: float

    def __call__(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        omega, end = self.rate, self.duration
        turn = 2 * math.pi / end
        early = np.minimum(time, end)
        sine, cosine = np.sin(turn * early), np.cos(turn * early)
        angle = omega / end * (early**2 / 2 + (cosine - 1) / turn**2)
        speed = omega / end * (early - sine / turn)
        gain = omega / end * (1 - cosine)
        return angle + omega * (time - early), speed, np.where(time < end, gain, 0.0)


def bang_bang(distance: float, duration: float, start: float = 0.0) -> Course:
    """Return the course from rest to rest, first of one acceleration, then of its opposite.

    No other of no larger acceleration is as quick.

        x'' = 4 d/T²  in the first half of the duration, and  -4 d/T²  in the second

    Parameters
    ----------
    distance : float [m or rad]
        d, of either sign.
    duration : float [s]
        T.
    start : float [s]
        When it begins, from 0.

    Returns
    -------
    Course
        To be given to `BaseMotion`, as a shift [m] or an angle [rad].

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, the duration not positive, or the start negative.

    Examples
    --------
    >>> import beammodes as bm
    >>> [part.tolist() for part in bm.bang_bang(2.0, 4.0)(np.array([1.0, 2.0, 9.0]))]
    [[0.25, 1.0, 2.0], [0.5, 1.0, 0.0], [0.5, -0.5, 0.0]]
    """
    return _BangBang(*_travel(distance, duration, start))


def point_to_point(distance: float, duration: float, start: float = 0.0) -> Course:
    """Return the smooth course from rest to rest whose acceleration begins and ends at zero.

        x = d (10 s³ - 15 s⁴ + 6 s⁵),   s = (t - start)/T

    It has the least mean square of jerk of all such courses; its largest acceleration is 5.77 d/T².

    Parameters
    ----------
    distance : float [m or rad]
        d, of either sign.
    duration : float [s]
        T.
    start : float [s]
        When it begins, from 0.

    Returns
    -------
    Course
        To be given to `BaseMotion`, as a shift [m] or an angle [rad].

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, the duration not positive, or the start negative.

    References
    ----------
    T. Flash and N. Hogan, The coordination of arm movements, Journal of Neuroscience 5 (1985), 1688-1703.

    Examples
    --------
    >>> import beammodes as bm
    >>> [part.tolist() for part in bm.point_to_point(2.0, 4.0)(np.array([0.0, 2.0, 9.0]))]
    [[0.0, 1.0, 2.0], [0.0, 0.9375, 0.0], [0.0, 0.0, -0.0]]
    """
    return _PointToPoint(*_travel(distance, duration, start))


def _travel(distance: float, duration: float, start: float) -> tuple[float, float, float]:
    length = real("distance", distance, "m or rad")
    return length, positive_real("duration", duration), not_negative("start", start, "s")


@dataclass(frozen=True, repr=False)
class _BangBang(_Course):
    _called = "bang_bang"

    distance: float
    duration: float
    start: float

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.start, self.start + self.duration / 2, self.start + self.duration

    def __call__(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        share = np.clip((time - self.start) / self.duration, 0.0, 1.0)
        early, gain = share < 0.5, 4.0 * self.distance / self.duration**2
        left = 1.0 - share
        moving = (time >= self.start) & (time < self.start + self.duration)
        return (
            self.distance * np.where(early, 2.0 * share**2, 1.0 - 2.0 * left**2),
            gain * self.duration * np.where(early, share, left),
            np.where(moving, np.where(early, gain, -gain), 0.0),
        )


@dataclass(frozen=True, repr=False)
class _PointToPoint(_Course):
    _called = "point_to_point"

    distance: float
    duration: float
    start: float

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.start, self.start + self.duration

    def __call__(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        s = np.clip((time - self.start) / self.duration, 0.0, 1.0)
        left, d, span = 1.0 - s, self.distance, self.duration
        return (
            d * s**3 * (10.0 - 15.0 * s + 6.0 * s**2),
            30.0 * d / span * (s * left) ** 2,
            60.0 * d / span**2 * s * left * (left - s),
        )
