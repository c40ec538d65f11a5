"""The units in which a chain's numbers are exact, and what they stand for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from beammodes.beam import Beam

__all__ = ["Units"]


@dataclass(frozen=True, slots=True)
class Units:
    """What one stands for in a chain's own numbers: a length [m], a mass [kg] and a joint stiffness [N m]."""

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
        units = cls(ell, beam.mass_per_length * ell, beam.bending_stiffness / ell)
        floats = (units.mass * ell**2, units.stiffness, 1 / units.mass)
        sound = all(0.0 < value < math.inf for value in floats)
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
