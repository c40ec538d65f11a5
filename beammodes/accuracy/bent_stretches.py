"""A stretch under static loads: its bending moment, and how it turns and deflects by it.

What bends is a beam that is uniform, in polynomials; one that varies, at Gauss points; or a chain, at hinges.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate
from typing import Any, NamedTuple, Protocol

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.beam import Beam
from beammodes.problem.profiles import profile_parts, value_at
from beammodes.problem.structure import Stretch

__all__ = ["BentStretch", "Flexibility", "HingedBending", "UniformBending", "VaryingBending"]


class Flexibility(Protocol):
    """The interface that `BentStretch` needs."""

    def integral(
        self, weight: Piecewise, moment: Piecewise, start: Any, stop: Any, *, last: bool = True
    ) -> Any:
        """Return ∫ weight M/EI dx between two places; hinges at the second count where it is the last."""


class UniformBending(NamedTuple):
    """A uniform beam of bending stiffness EI [N m²]."""

    stiffness: Any

    def integral(
        self, weight: Piecewise, moment: Piecewise, start: Any, stop: Any, *, last: bool = True
    ) -> Any:
        """Return ∫ weight M/EI dx between two places."""
        del last  # Nothing is gathered at a place.
        return weight.times(moment).integral(start, stop) / self.stiffness


class VaryingBending(NamedTuple):
    """A beam that varies."""

    beam: Beam

    def integral(
        self, weight: Piecewise, moment: Piecewise, start: Any, stop: Any, *, last: bool = True
    ) -> Any:
        """Return ∫ weight M/EI dx between two places."""
        del last  # Nothing is gathered at a place.
        inner = [*profile_parts(self.beam.bending_stiffness, self.beam.length), *map(float, moment.edges)]
        edges = np.array(sorted({start, stop, *(x for x in inner if start < x < stop)}))
        if len(edges) < 2:
            return 0.0
        node, plain = np.polynomial.legendre.leggauss(max(4, min(24, 4000 // len(edges))))
        half = 0.5 * np.diff(edges)[:, None]
        x = (edges[:-1, None] + half * (1.0 + node)).ravel()
        values = np.array([float(weight(at) * moment(at)) for at in x.tolist()])
        return float((half * plain).ravel() @ (values / value_at(self.beam.bending_stiffness, x)))


class HingedBending(NamedTuple):
    """A chain: positions of its hinges [m] and their flexibilities [rad/(N m)]."""

    place: tuple[Any, ...]
    flexibility: tuple[Any, ...]

    @classmethod
    def of(cls, chain: Chain, number: Any) -> HingedBending:
        """Return the hinges of a chain as fractions or as floats."""
        scaled, units = chain.scaled, chain.exact_units
        hinges = list(accumulate(scaled.length))[:-1]
        place = tuple(number(Fraction(x) * units.length) for x in hinges)
        return cls(place, tuple(number(1 / (Fraction(k) * units.stiffness)) for k in scaled.joint_stiffness))

    def integral(
        self, weight: Piecewise, moment: Piecewise, start: Any, stop: Any, *, last: bool = True
    ) -> Any:
        """Return ∫ weight M/EI dx between two places."""
        total = 0 * start
        for x, give in zip(self.place, self.flexibility, strict=True):
            if start <= x < stop or (last and x == stop):
                total = total + give * weight(x) * moment(x)
        return total


class BentStretch(NamedTuple):
    """A stretch with what is on it; distances are from its start.

    Ends are m₀, m₁ and the deflections v₀, v₁ there, and the axial force at the second, None where
    equilibrium does not tell it.
    """

    stretch: Stretch
    start: Any
    length: Any
    bends: Flexibility
    shear_of_load: Piecewise
    moment_of_load: Piecewise
    pull_of_load: Piecewise

    def weights(self) -> tuple[Piecewise, Piecewise]:
        """Return 1 - x/l and x/l."""
        none, one = 0 * self.length, 1 + 0 * self.length
        over = one / self.length
        return Piecewise.one(none, self.length, one, -over), Piecewise.one(none, self.length, none, over)

    def bent(self, ends: tuple[Any, ...]) -> Piecewise:
        """Return M."""
        slope = (ends[1] - ends[0]) / self.length
        return self.moment_of_load.plus(Piecewise.one(0 * self.length, self.length, ends[0], slope))

    def moment(self, x: Any, ends: tuple[Any, ...], side: int) -> Any:
        """Return M at a place."""
        return self.bent(ends)(x, side)

    def shear(self, x: Any, ends: tuple[Any, ...], side: int) -> Any:
        """Return V at a place."""
        return (ends[1] - ends[0]) / self.length + self.shear_of_load(x, side)

    def axial_force(self, x: Any, ends: tuple[Any, ...], side: int) -> Any:
        """Return N at a place."""
        if ends[4] is None:
            raise ValueError(
                f"structure must let equilibrium tell its axial forces, got one with that of "
                f"{self.stretch.member} untold: members do not stretch, and supports or other members could "
                "pull on it at both ends without any load. Let one of them slide"
            )
        return ends[4] + self.pull_of_load(x, side)

    def _shares(self, x: Any, ends: tuple[Any, ...], side: int) -> tuple[Any, Any]:
        """Return ∫ s κ ds before x and ∫ (l - s) κ ds behind it."""
        moment, (first, second) = self.bent(ends), self.weights()
        at_end = side > 0
        before = self.bends.integral(second, moment, 0 * x, x, last=at_end) * self.length
        whole = self.bends.integral(first, moment, 0 * x, self.length) * self.length
        return before, whole - self.bends.integral(first, moment, 0 * x, x, last=at_end) * self.length

    def deflection(self, x: Any, ends: tuple[Any, ...], side: int) -> Any:
        """Return the deflection at a place."""
        share, (before, behind) = x / self.length, self._shares(x, ends, side)
        return (1 - share) * (ends[2] - before) + share * (ends[3] - behind)

    def rotation(self, x: Any, ends: tuple[Any, ...], side: int) -> Any:
        """Return the rotation at a place."""
        before, behind = self._shares(x, ends, side)
        return (ends[3] - ends[2] + before - behind) / self.length
