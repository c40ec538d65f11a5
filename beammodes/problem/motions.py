"""What a straight beam can do on its own: bend, twist, stretch. One record each of the numbers it goes by.

Twist and stretch obey one equation, that of waves along the axis, with a stiffness k and an inertia m per
length:

    m ∂²u/∂t² - ∂/∂x(k ∂u/∂x) = 0

    =======  ===================  ===========================  ======  =========
    motion   u                    k                            m       unit of k
    =======  ===================  ===========================  ======  =========
    twist    the section's angle  GJ, torsional_stiffness      ρIp     N m²
    stretch  shift along the axis EA, axial_stiffness          ρA      N
    =======  ===================  ===========================  ======  =========

In a straight beam none of the three moves another, in small vibration.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from beammodes.checks import choice, shown
from beammodes.problem.beam import Beam
from beammodes.problem.profiles import Profile, mean_over

__all__ = ["MOTIONS", "Motion", "motion_named", "unit_beam"]


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion of a straight beam: which of its numbers it goes by, and their names and units.

    Attributes
    ----------
    name : str
    stiffness, inertia : str
        Names of the two properties of a `Beam`.
    stiffness_symbol, inertia_symbol : str
    stiffness_unit, inertia_unit : str
        Per length for inertia.
    spring_unit, body, body_unit : str
        Unit of a spring at a hinge or an end, name and unit of the inertia of a body at an end.
    displacement, displacement_unit : str
        What moves.
    along : bool
        Whether it is a wave along the axis, of second order: twist and stretch, and not bending.

    Examples
    --------
    >>> MOTIONS["twist"].stiffness, MOTIONS["twist"].body
    ('torsional_stiffness', 'inertia')
    """

    name: str
    stiffness: str
    inertia: str
    stiffness_symbol: str
    inertia_symbol: str
    stiffness_unit: str
    inertia_unit: str
    spring_unit: str
    body: str
    body_unit: str
    displacement: str
    displacement_unit: str
    along: bool = True

    @property
    def load_unit(self) -> str:
        """Unit of a load, a stiffness times a displacement.

        Examples
        --------
        >>> MOTIONS["twist"].load_unit, MOTIONS["stretch"].load_unit
        ('N m', 'N')
        """
        return self.spring_unit.removesuffix(f"/{self.displacement_unit}")

    def numbers(self, beam: Beam) -> tuple[Profile, Profile]:
        """Return the beam's stiffness and inertia per length in this motion.

        Raises
        ------
        TypeError, ValueError
            If `beam` is none, or lacks one of them; the message says which to give, and how.

        Examples
        --------
        >>> MOTIONS["stretch"].numbers(Beam(1.0, 2.0, 3.0, axial_stiffness=4.0))
        (4.0, 3.0)
        """
        inertia = self.inertia, self.inertia_symbol, self.inertia_unit
        return self.stiffness_of(beam), self._number(beam, *inertia)

    def stiffness_of(self, beam: Beam) -> Profile:
        """Return the beam's stiffness in this motion, all that its rest needs; errors as of `numbers`."""
        return self._number(beam, self.stiffness, self.stiffness_symbol, self.stiffness_unit)

    def _number(self, beam: Beam, name: str, symbol: str, unit: str) -> Profile:
        if not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(beam)}")
        value: Profile | None = getattr(beam, name)
        if value is None:
            raise ValueError(
                f"beam must have its {name} for motion {self.name}, got None: give "
                f"Beam(..., {name}={symbol}) [{unit}], or take Beam.from_section"
                + (" of a section with torsion_constant and weak_second_moment" * (self.name == "twist"))
            )
        return value

    def mean_numbers(self, beam: Beam) -> tuple[float, float]:
        """Return the means of both along the beam: the numbers themselves where it is uniform."""
        stiffness, inertia = self.numbers(beam)
        return mean_over(stiffness, beam.length), mean_over(inertia, beam.length)

    def is_uniform(self, beam: Beam) -> bool:
        """Return True if both are the same all along."""
        return all(isinstance(profile, float) for profile in self.numbers(beam))

    def frequency_unit(self, beam: Beam) -> float:
        """Return √(k/m)/L of the means, and of bending √(EI/(ρA L⁴)) [rad/s].

        Examples
        --------
        >>> rod = Beam(2.0, 1.0, 1.0, torsional_stiffness=9.0, polar_inertia_per_length=1.0)
        >>> MOTIONS["twist"].frequency_unit(rod)
        1.5
        """
        stiffness, inertia = self.mean_numbers(beam)
        unit = math.sqrt(stiffness) / math.sqrt(inertia) / beam.length
        return unit if self.along else unit / beam.length


#: The three motions by name, read-only.
MOTIONS: Mapping[str, Motion] = MappingProxyType(
    {
        motion.name: motion
        for motion in (
            Motion(
                name="bending",
                stiffness="bending_stiffness",
                inertia="mass_per_length",
                stiffness_symbol="EI",
                inertia_symbol="rho A",
                stiffness_unit="N m^2",
                inertia_unit="kg/m",
                spring_unit="N m/rad",
                body="mass",
                body_unit="kg",
                displacement="deflection",
                displacement_unit="m",
                along=False,
            ),
            Motion(
                name="twist",
                stiffness="torsional_stiffness",
                inertia="polar_inertia_per_length",
                stiffness_symbol="GJ",
                inertia_symbol="rho Ip",
                stiffness_unit="N m^2",
                inertia_unit="kg m",
                spring_unit="N m/rad",
                body="inertia",
                body_unit="kg m^2",
                displacement="angle",
                displacement_unit="rad",
            ),
            Motion(
                name="stretch",
                stiffness="axial_stiffness",
                inertia="mass_per_length",
                stiffness_symbol="EA",
                inertia_symbol="rho A",
                stiffness_unit="N",
                inertia_unit="kg/m",
                spring_unit="N/m",
                body="mass",
                body_unit="kg",
                displacement="shift",
                displacement_unit="m",
            ),
        )
    }
)


def motion_named(motion: str | Motion) -> Motion:
    """Return the motion of that name; a `Motion` is returned as it is.

    Raises
    ------
    TypeError, ValueError
        If it is neither; the message offers the nearest name.

    Examples
    --------
    >>> motion_named("twist").stiffness_symbol
    'GJ'
    """
    return motion if isinstance(motion, Motion) else MOTIONS[choice("motion", motion, MOTIONS)]


@cache
def unit_beam() -> Beam:
    """Return the beam of unit numbers in every motion, on which results in multiples are stated.

    Examples
    --------
    >>> [motion.numbers(unit_beam()) for motion in MOTIONS.values()]
    [(1.0, 1.0), (1.0, 1.0), (1.0, 1.0)]
    """
    return Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0, axial_stiffness=1.0)
