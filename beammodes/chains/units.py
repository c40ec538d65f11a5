"""The units in which a chain's numbers are exact, and what they stand for."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from fractions import Fraction

from beammodes.problem.beam import Beam

__all__ = ["ExactUnits", "Units"]

_LEAST = sys.float_info.min


@dataclass(frozen=True, slots=True)
class ExactUnits:
    """A chain's units without rounding, to express given numbers in them.

    Examples
    --------
    >>> ExactUnits.of(Beam.unit(), 3).force(1)                           # in EI/ell²
    Fraction(1, 9)
    """

    length: Fraction = Fraction(1)
    mass: Fraction = Fraction(1)
    stiffness: Fraction = Fraction(1)

    @classmethod
    def of(cls, beam: Beam, segments: int) -> ExactUnits:
        """Return a segment's length, its mass and EI over its length."""
        ell = Fraction(beam.length) / segments
        return cls(
            ell, Fraction(beam.mean_mass_per_length) * ell, Fraction(beam.mean_bending_stiffness) / ell
        )

    def force(self, value: Fraction | float) -> Fraction:
        """Return a force [N] in the chain's own units."""
        return Fraction(value) * self.length / self.stiffness

    def acceleration(self, value: Fraction | float) -> Fraction:
        """Return an acceleration [m/s²] in the chain's own units."""
        return Fraction(value) * self.mass * self.length / self.stiffness

    def square_rate(self, value: Fraction | float) -> Fraction:
        """Return the square of an angular frequency [rad/s] in the chain's own units."""
        return Fraction(value) ** 2 * self.mass * self.length**2 / self.stiffness

    def moment(self, value: Fraction | float) -> Fraction:
        """Return a moment [N m] in the chain's own units."""
        return Fraction(value) / self.stiffness

    def support(self, value: Fraction | float, lengths: int) -> Fraction | float:
        """Return a translational (`lengths` = 2) or rotational (0) stiffness in own units, inf as it is."""
        if value == math.inf:
            return math.inf
        return Fraction(value) * self.length**lengths / self.stiffness

    def body(
        self, mass: Fraction | float, rotary_inertia: Fraction | float, offset: Fraction | float
    ) -> tuple[Fraction, Fraction, Fraction]:
        """Return a body's mass, rotary inertia and offset in own units."""
        turning = Fraction(rotary_inertia) / (self.mass * self.length**2)
        return Fraction(mass) / self.mass, turning, Fraction(offset) / self.length


@dataclass(frozen=True, slots=True)
class Units:
    """Value of one in a chain's own numbers: a length [m], a mass [kg] and a joint stiffness [N m]."""

    length: float = 1.0
    mass: float = 1.0
    stiffness: float = 1.0

    @classmethod
    def of(cls, beam: Beam, segments: int) -> Units:
        """Return the units of a chain of equal segments: a segment's length, its mass and EI over its length.

        Raises
        ------
        ValueError
            If the chain's numbers would leave the range of floating-point numbers.

        Examples
        --------
        >>> Units.of(Beam.unit(), 4)
        Units(length=0.25, mass=0.25, stiffness=4.0)
        """
        ell = beam.length / segments
        units = cls(ell, beam.mean_mass_per_length * ell, beam.mean_bending_stiffness / ell)
        floats = (units.mass * ell**2, units.stiffness, units.mass)
        # Numbers smaller than the least normal one have lost digits, and their inverses overflow.
        sound = all(_LEAST <= value <= 1 / _LEAST for value in floats)
        if not sound or not 0.0 < units.angular_frequency < math.inf:
            raise ValueError(
                f"beam must suit {segments} segments: with {beam} their masses, inertias or springs leave "
                "the range of floating-point numbers"
            )
        return units

    @property
    def angular_frequency(self) -> float:
        """√(stiffness / (mass length²)) [rad/s]."""
        return math.sqrt(self.stiffness / self.mass) / self.length
