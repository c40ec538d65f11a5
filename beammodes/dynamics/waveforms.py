"""Courses of loads in time: what a load is multiplied by.

A course is any function of an array of times. Those here also tell where they jump or kink, so that steps end
there, and how fast they vary between.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from beammodes.checks import Catalogue, Shown, choice, not_negative, positive_real, real
from beammodes.numerics.arrays import Floats

__all__ = ["WAVEFORMS", "Chirp", "Pulse", "Sine", "Step", "Waveform"]

#: The value at each of some times.
Waveform = Callable[[Floats], Floats]


@dataclass(frozen=True, repr=False)
class Step(Shown):
    """0 before a time and 1 from then on, at once or by a straight rise.

    Parameters
    ----------
    start : float [s]
        When it begins, from 0; the value at that time is that after the jump.
    rise : float [s]
        How long it takes from 0 to 1; 0 jumps.

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, or negative.

    Examples
    --------
    >>> Step(start=1.0, rise=2.0)(np.array([0.5, 2.0, 4.0]))
    array([0. , 0.5, 1. ])
    """

    start: float = 0.0
    rise: float = 0.0

    def __post_init__(self) -> None:
        for name in ("start", "rise"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name), "s"))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where it jumps or kinks [s]."""
        return (self.start, self.start + self.rise) if self.rise else (self.start,)

    @property
    def fastest(self) -> float:
        """How fast it varies between its breaks, as an angular frequency [rad/s]."""
        return 0.0

    def __call__(self, time: Floats) -> Floats:
        """Return its values."""
        if not self.rise:
            return np.where(time < self.start, 0.0, 1.0)
        return np.clip((time - self.start) / self.rise, 0.0, 1.0)


@dataclass(frozen=True, repr=False)
class Sine(Shown):
    """sin(2π f (t - start) + phase) from a time on, and 0 before it.

    Parameters
    ----------
    frequency : float [Hz]
        f.
    phase : float [rad]
    start : float [s]
        From 0.

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, the frequency not positive, or the start negative.

    Examples
    --------
    >>> Sine(frequency=2.0)(np.array([0.0, 0.125])).round(9)
    array([0., 1.])
    """

    frequency: float
    phase: float = 0.0
    start: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", positive_real("frequency", self.frequency))
        object.__setattr__(self, "phase", real("phase", self.phase))
        object.__setattr__(self, "start", not_negative("start", self.start, "s"))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where it jumps or kinks [s]."""
        return (self.start,)

    @property
    def fastest(self) -> float:
        """2π f [rad/s]."""
        return 2.0 * math.pi * self.frequency

    def __call__(self, time: Floats) -> Floats:
        """Return its values."""
        wave = np.sin(2.0 * math.pi * self.frequency * (time - self.start) + self.phase)
        return np.where(time < self.start, 0.0, wave)


_SHAPES = ("rectangle", "triangle", "half_sine")


@dataclass(frozen=True, repr=False)
class Pulse(Shown):
    """A single pulse of height 1, and 0 before and after it.

    Parameters
    ----------
    duration : float [s]
    start : float [s]
        From 0.
    shape : str
        "rectangle", "triangle" (up to the middle and down again) or "half_sine". Their impulses are 1, 1/2
        and 2/π times the duration.

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, the duration not positive, the start negative, or the shape
        unknown.

    Examples
    --------
    >>> Pulse(duration=2.0, shape="triangle")(np.array([0.5, 1.0, 2.5]))
    array([0.5, 1. , 0. ])
    """

    duration: float
    start: float = 0.0
    shape: str = "rectangle"

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", positive_real("duration", self.duration))
        object.__setattr__(self, "start", not_negative("start", self.start, "s"))
        choice("shape", self.shape, _SHAPES)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where it jumps or kinks [s]."""
        middle = (self.start + self.duration / 2,) if self.shape == "triangle" else ()
        return (self.start, *middle, self.start + self.duration)

    @property
    def fastest(self) -> float:
        """π over the duration of a half sine; the others are straight between their breaks [rad/s]."""
        return math.pi / self.duration if self.shape == "half_sine" else 0.0

    def __call__(self, time: Floats) -> Floats:
        """Return its values."""
        share = (time - self.start) / self.duration
        within = (share >= 0.0) & (time < self.start + self.duration)
        if self.shape == "rectangle":
            return np.where(within, 1.0, 0.0)
        value = np.sin(math.pi * share) if self.shape == "half_sine" else 1.0 - abs(2.0 * share - 1.0)
        return np.where(within, value, 0.0)


@dataclass(frozen=True, repr=False)
class Chirp(Shown):
    """A sine whose frequency grows or falls evenly from one to another, and 0 before and after it.

        sin 2π (f₀ τ + (f₁ - f₀) τ²/(2 T)),   τ = t - start, 0 to T

    Parameters
    ----------
    first, last : float [Hz]
        f₀ and f₁.
    duration : float [s]
        T.
    start : float [s]
        From 0.

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite, the duration not positive, another negative, or both
        frequencies are zero.

    Examples
    --------
    >>> Chirp(first=0.0, last=4.0, duration=1.0)(np.array([0.5, 2.0])).round(9)     # sin 2π/2, and over
    array([0., 0.])
    """

    first: float
    last: float
    duration: float
    start: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("first", "Hz"), ("last", "Hz"), ("start", "s")):
            object.__setattr__(self, name, not_negative(name, getattr(self, name), unit))
        object.__setattr__(self, "duration", positive_real("duration", self.duration))
        if not (self.first or self.last):
            raise ValueError("last must be greater than 0 where first is 0, got 0")

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where it jumps or kinks [s]."""
        return (self.start, self.start + self.duration)

    @property
    def fastest(self) -> float:
        """2π times the higher frequency [rad/s]."""
        return 2.0 * math.pi * max(self.first, self.last)

    def __call__(self, time: Floats) -> Floats:
        """Return its values."""
        t = time - self.start
        within = (t >= 0.0) & (time < self.start + self.duration)
        turns = self.first * t + (self.last - self.first) * t * t / (2.0 * self.duration)
        return np.where(within, np.sin(2.0 * math.pi * turns), 0.0)


#: All ready courses by name.
WAVEFORMS: Catalogue[type[Step] | type[Sine] | type[Pulse] | type[Chirp]] = Catalogue(
    "waveforms", {"step": Step, "sine": Sine, "pulse": Pulse, "chirp": Chirp}
)
