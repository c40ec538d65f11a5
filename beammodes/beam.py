"""The beam: three numbers that set every scale of the problem."""

from __future__ import annotations

import math
from dataclasses import dataclass

from beammodes.checks import positive_real

__all__ = ["Beam"]


@dataclass(frozen=True, slots=True)
class Beam:
    """A uniform Euler-Bernoulli beam, in any consistent set of units.

    Its bending obeys  ρA ∂²y/∂t² + EI ∂⁴y/∂x⁴ = 0  for 0 < x < L.

    Parameters
    ----------
    length : float [m]
        L, the whole length.
    bending_stiffness : float [N m²]
        EI, elastic modulus times area moment of inertia of the cross-section.
    mass_per_length : float [kg/m]
        ρA, density times cross-sectional area.

    Raises
    ------
    TypeError, ValueError
        If a value is not a finite real number greater than 0.

    Examples
    --------
    >>> beam = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> round(beam.frequency_unit, 4)
    8.1311
    """

    length: float
    bending_stiffness: float
    mass_per_length: float

    def __post_init__(self) -> None:
        for name in ("length", "bending_stiffness", "mass_per_length"):
            object.__setattr__(self, name, positive_real(name, getattr(self, name)))
        if not 0.0 < self.frequency_unit < math.inf:
            raise ValueError(
                f"length must suit the other two numbers: with length {self.length}, bending_stiffness "
                f"{self.bending_stiffness} and mass_per_length {self.mass_per_length} frequencies leave "
                "the range of floating-point numbers"
            )

    @classmethod
    def unit(cls) -> Beam:
        """Return the beam with L = EI = ρA = 1, on which dimensionless results are stated.

        Examples
        --------
        >>> Beam.unit().frequency_unit
        1.0
        """
        return cls(1.0, 1.0, 1.0)

    @property
    def frequency_unit(self) -> float:
        """√(EI / (ρA L⁴)) [rad/s], which a dimensionless angular frequency multiplies."""
        speed = math.sqrt(self.bending_stiffness) / math.sqrt(self.mass_per_length)
        return speed / self.length / self.length
