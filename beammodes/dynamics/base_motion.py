"""Prescribed motion of the base that carries a beam's left end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import not_negative, positive_real, real, real_numbers, shown
from beammodes.numerics.arrays import Floats

__all__ = ["BaseMotion", "Course", "at_rest", "harmonic", "spin_up"]


#: Position, rate and acceleration at times t, each of the shape of t.
Course = Callable[[Floats], tuple[Floats, Floats, Floats]]


def at_rest(time: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the course of what does not move."""
    still = np.zeros_like(time)
    return still, still, still


@dataclass(frozen=True)
class BaseMotion:
    """A base that shifts along x and y and turns, in given courses of time.

    The beam's left end sits at `hub_radius` from the base's origin, along the base's own direction, so that
    it moves on  (x, y) + R (cos φ, sin φ), and what it holds it holds relative to the base.

    Parameters
    ----------
    x, y, angle : function of an array of times [s]
        Gives position, rate and acceleration, [m] or [rad], [m/s], [m/s²].
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
        expected = f"{name} must give position, rate and acceleration, finite and one for each time"
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


def harmonic(amplitude: float, angular_frequency: float) -> Course:
    """Return the course  A sin ωt.

    Parameters
    ----------
    amplitude : float [m or rad]
    angular_frequency : float [rad/s]

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
    return _Harmonic(real("amplitude", amplitude), positive_real("angular_frequency", angular_frequency))


# Courses are values, not functions within functions, which could be neither compared nor sent to a process.
@dataclass(frozen=True)
class _Harmonic:
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

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, or the duration not positive.

    Source
    ------
    J. C. Simo and L. Vu-Quoc, On the dynamics of flexible beams under large overall motions, Journal of
    Applied Mechanics 53 (1986), 855-863.

    Examples
    --------
    >>> import beammodes as bm
    >>> [float(part[0]) for part in bm.spin_up(6.0, 15.0)(np.array([15.0]))]
    [45.0, 6.0, 0.0]
    """
    return _SpinUp(real("rate", rate), positive_real("duration", duration))


@dataclass(frozen=True)
class _SpinUp:
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
