"""The beam: its length, and the stiffness and mass along it, which set every scale of the problem."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from beammodes.checks import flag, positive_real, shown
from beammodes.problem.beam_properties import PropertyLike, each_place_once, kept_breaks, kept_property
from beammodes.problem.profiles import Profile, mean_over, profile_breaks
from beammodes.problem.section_shape import poisson_ratio_of

if TYPE_CHECKING:
    from beammodes.problem.section_shape import Section

__all__ = ["Beam"]


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Beam:
    """A straight elastic beam, uniform or not, in any consistent set of units.

    Its bending obeys  ρA ∂²y/∂t² - ∂/∂x(ρI ∂³y/∂x∂t²) + ∂²/∂x²(EI ∂²y/∂x²) = 0  for 0 < x < L: Euler and
    Bernoulli's beam, or Rayleigh's where the section's rotary inertia ρI is given.

    Each property along the beam is a number; a sequence of two numbers or more, constant on that many equal
    lengths; a `Table`; or a function of x [m], for arrays or for one number at a time. Sequences are kept as
    tables, and what is constant as a number.

    Between its breaks a beam is smooth. Breaks are the steps of sequences, the positions that a `Table` has
    twice, and those of `breaks`: a function's steps and kinks, and the kinks of a table that are meant as
    such. A table's other kinks are no breaks: a fine table of a taper is a taper. See `breaks` below.

    Parameters
    ----------
    length : float [m]
        L, the whole length.
    bending_stiffness : float, sequence, Table or function [N m²]
        EI, elastic modulus times area moment of inertia of the cross-section.
    mass_per_length : float, sequence, Table or function [kg/m]
        ρA, density times cross-sectional area.
    rotary_inertia_per_length : float, sequence, Table or function [kg m]
        ρI, density times area moment of inertia.
    shear_stiffness : float, sequence, Table or function [N], optional
        κGA, the shear coefficient times shear modulus times area.
    radius_of_gyration : float [m], optional
        r = √(I/A) of the section, the same all along, of a beam whose ρI is left out.
    assumed : tuple of str
        What of these two was assumed and not given, in words; no part of what makes beams equal.
    breaks : sequence of float, optional [m]
        Positions inside the beam where a property has a step or a kink that it does not tell itself, in any
        order. Two of them also show where a function has a feature narrower than L/4096, the distance of the
        places at which functions are looked at (see `problem.smooth_parts`).

    κGA and r are left out of the equation above, and of every chain: `timoshenko`, which keeps them in,
    and `theory_errors`, which says what leaving them out does, read them.

    Raises
    ------
    TypeError, ValueError
        If a value is not a finite real number greater than 0 (`rotary_inertia_per_length` may be 0), a table
        does not span the beam, or a break lies outside it. Functions are tried at 65 places, both ends among
        them, and at 4,096 evenly spaced ones.

    Examples
    --------
    >>> beam = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> round(beam.frequency_unit, 4)
    8.1311
    >>> Beam(1.5, bending_stiffness=[3.0, 2.0, 1.0], mass_per_length=lambda x: 2.0 - x).breaks
    (0.5, 1.0)
    >>> import numpy as np
    >>> Beam(1.0, lambda x: np.where(x < 0.4, 2.0, 1.0 + x), 1.0, breaks=[0.4]).breaks       # a step at 0.4
    (0.4,)
    """

    length: float
    bending_stiffness: Profile
    mass_per_length: Profile
    rotary_inertia_per_length: Profile
    shear_stiffness: Profile | None
    radius_of_gyration: float | None
    assumed: tuple[str, ...] = field(default=(), compare=False, repr=False)

    def __init__(
        self,
        length: float,
        bending_stiffness: PropertyLike,
        mass_per_length: PropertyLike,
        rotary_inertia_per_length: PropertyLike = 0.0,
        *,
        shear_stiffness: PropertyLike | None = None,
        radius_of_gyration: float | None = None,
        assumed: tuple[str, ...] = (),
        breaks: Sequence[float] | NDArray[Any] = (),
    ) -> None:
        whole = positive_real("length", length)
        object.__setattr__(self, "length", whole)
        places = kept_breaks(breaks, whole)
        for name, given in (("bending_stiffness", bending_stiffness), ("mass_per_length", mass_per_length)):
            object.__setattr__(self, name, kept_property(name, given, whole, places))
        rotary = kept_property("rotary_inertia_per_length", rotary_inertia_per_length, whole, places)
        object.__setattr__(self, "rotary_inertia_per_length", rotary)
        shear = None
        if shear_stiffness is not None:
            shear = kept_property("shear_stiffness", shear_stiffness, whole, places)
        object.__setattr__(self, "shear_stiffness", shear)
        radius = (
            None if radius_of_gyration is None else positive_real("radius_of_gyration", radius_of_gyration)
        )
        object.__setattr__(self, "radius_of_gyration", radius)
        if not isinstance(assumed, tuple) or not all(isinstance(word, str) for word in assumed):
            raise TypeError(f"assumed must be a tuple of words, got {shown(assumed)}")
        object.__setattr__(self, "assumed", assumed)
        if not 0.0 < self.frequency_unit < math.inf:
            raise ValueError(
                f"length must suit the other two numbers: with length {self.length}, bending_stiffness "
                f"{self.mean_bending_stiffness} and mass_per_length {self.mean_mass_per_length} frequencies "
                "leave the range of floating-point numbers"
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

    @classmethod
    def from_section(
        cls,
        section: Section,
        *,
        density: float,
        elastic_modulus: float,
        length: float,
        rotary_inertia: bool = False,
        poisson_ratio: float | None = None,
        shear_coefficient: float | None = None,
    ) -> Beam:
        """Return the uniform beam of a cross-section and a material: EI, ρA, κGA, r and, if wanted, ρI.

            G = E / (2 (1 + ν))

        Parameters
        ----------
        section : Section
            One of `sections`, or anything with an `area` [m²] and a `second_moment` [m⁴].
        density : float [kg/m³]
            ρ.
        elastic_modulus : float [Pa]
            E, such as `materials.elastic_modulus` gives.
        length : float [m]
            L.
        rotary_inertia : bool
            Whether the section's rotary inertia ρI counts: Rayleigh's beam instead of Euler and Bernoulli's.
        poisson_ratio : float, optional
            ν, above -1 and at most 0.5; without it `assumed` says that 0.3 is taken.
        shear_coefficient : float, optional
            κ; the section's own by default, and 5/6 as an assumption where it has none.

        Raises
        ------
        TypeError, ValueError
            If a number is not a finite real number greater than 0, or `section` lacks one of the two.

        Examples
        --------
        >>> from beammodes.problem.sections import Rectangle
        >>> flat = Rectangle(width=0.02, height=0.002)
        >>> beam = Beam.from_section(flat, density=7800.0, elastic_modulus=200e9, length=1.0)
        >>> round(beam.bending_stiffness, 6), round(beam.mass_per_length, 6)
        (2.666667, 0.312)
        """
        for name in ("area", "second_moment"):
            if not hasattr(section, name):
                raise TypeError(f"section must have its {name}, got {shown(section)}")
        flag("rotary_inertia", rotary_inertia)
        rho, modulus = positive_real("density", density), positive_real("elastic_modulus", elastic_modulus)
        area = positive_real("area of section", section.area)
        moment = positive_real("second_moment of section", section.second_moment)
        ratio, coefficient, assumed = _in_shear(section, poisson_ratio, shear_coefficient)
        shear = coefficient * modulus / (2.0 * (1.0 + ratio)) * area
        for name, value in (
            ("density", rho * area),
            ("density", rho * moment),
            ("elastic_modulus", modulus * moment),
            ("shear_coefficient", shear),
        ):
            if not 0.0 < value < math.inf:
                raise ValueError(
                    f"{name} must be of another order: with elastic_modulus {modulus}, density {rho} and "
                    f"{shown(section)} the beam's numbers leave the range of floats"
                )
        return cls(
            length,
            modulus * moment,
            rho * area,
            rho * moment if rotary_inertia else 0.0,
            shear_stiffness=shear,
            radius_of_gyration=math.sqrt(moment / area),
            assumed=assumed,
        )

    @property
    def is_uniform(self) -> bool:
        """Whether all three properties are numbers; rotary inertia may still be one of them."""
        properties = (self.bending_stiffness, self.mass_per_length, self.rotary_inertia_per_length)
        return all(isinstance(profile, float) for profile in properties)

    @property
    def has_rotary_inertia(self) -> bool:
        """Whether the section's rotary inertia is anything but zero."""
        return not isinstance(self.rotary_inertia_per_length, float) or self.rotary_inertia_per_length > 0.0

    @property
    def mean_bending_stiffness(self) -> float:
        """∫ EI dx / L [N m²]: the number itself where it is one."""
        return mean_over(self.bending_stiffness, self.length)

    @property
    def mean_mass_per_length(self) -> float:
        """∫ ρA dx / L [kg/m]: the number itself where it is one."""
        return mean_over(self.mass_per_length, self.length)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Positions inside the beam between which it is smooth, ascending [m].

        Those of sequences, those that a table has twice, and those given as `breaks` with what varies.
        """
        properties = [self.bending_stiffness, self.mass_per_length, self.rotary_inertia_per_length]
        if self.shear_stiffness is not None:
            properties.append(self.shear_stiffness)
        places = sorted(x for profile in properties for x in profile_breaks(profile))
        return each_place_once(places, self.length)

    @property
    def frequency_unit(self) -> float:
        """√(EI / (ρA L⁴)) of mean EI and mean ρA [rad/s], which a dimensionless frequency multiplies."""
        speed = math.sqrt(self.mean_bending_stiffness) / math.sqrt(self.mean_mass_per_length)
        return speed / self.length / self.length

    def __repr__(self) -> str:
        given = {
            "length": self.length,
            "bending_stiffness": self.bending_stiffness,
            "mass_per_length": self.mass_per_length,
            "rotary_inertia_per_length": self.rotary_inertia_per_length or None,
            "shear_stiffness": self.shear_stiffness,
            "radius_of_gyration": self.radius_of_gyration,
        }
        return f"Beam({', '.join(f'{name}={value!r}' for name, value in given.items() if value is not None)})"


#: Of most metals; a shear modulus between 0.8 and 1.3 times its own belongs to any ν from 0 to 0.5.
_POISSON_RATIO = 0.3
_COEFFICIENT = 5 / 6


def _in_shear(
    section: Section, poisson_ratio: float | None, shear_coefficient: float | None
) -> tuple[float, float, tuple[str, ...]]:
    """Return ν, κ and what of them is assumed."""
    assumed = []
    ratio = poisson_ratio_of(_POISSON_RATIO if poisson_ratio is None else poisson_ratio)
    if poisson_ratio is None:
        assumed.append(f"Poisson's ratio {_POISSON_RATIO}")
    own = getattr(section, "shear_coefficient", None)
    if shear_coefficient is not None:
        return ratio, positive_real("shear_coefficient", shear_coefficient), tuple(assumed)
    if callable(own):
        return ratio, positive_real("shear_coefficient of section", own(ratio)), tuple(assumed)
    assumed.append("shear coefficient 5/6")
    return ratio, _COEFFICIENT, tuple(assumed)
