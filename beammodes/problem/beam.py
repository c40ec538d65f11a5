"""The beam: its length, and the stiffness and mass along it, which set every scale of the problem."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import (
    Shown,
    bounded,
    flag,
    is_text,
    part_shown,
    positive_real,
    real,
    real_numbers,
    shown,
    unwrapped,
)
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.profiles import (
    SAME_PLACE,
    SAMPLES,
    BrokenFunction,
    Profile,
    Table,
    check_kinds,
    mean_over,
    profile_breaks,
    table_with_breaks,
    value_at,
)
from beammodes.problem.sections import poisson_ratio_of

if TYPE_CHECKING:
    from beammodes.problem import sections
else:
    sections = Deferred("beammodes.problem.sections")

__all__ = ["Beam", "PropertyLike", "each_place_once", "kept_breaks", "kept_property", "positions_on"]


# What a user gives for a property along a beam, checked, and as the beam keeps it.

#: What a user may give for a property along the beam.
PropertyLike: TypeAlias = Profile | Sequence[float] | NDArray[Any]


# What each beam has along it, and what it may have.
_NEEDED = ("bending_stiffness", "mass_per_length", "rotary_inertia_per_length")
_OPTIONAL = ("shear_stiffness", "torsional_stiffness", "polar_inertia_per_length", "axial_stiffness")

_GRID, _MAY_VANISH, _MOST_PARTS = 65, "rotary_inertia_per_length", 100_000


def kept_property(name: str, given: Any, length: float, breaks: tuple[float, ...] = ()) -> Profile:
    """Return a property of a beam of this length as it is kept: a number, a table or a function.

    A table and a function take the `breaks` with them.

    Raises
    ------
    TypeError, ValueError
        If it is none of what `Beam` takes; the message names the property, and position and value.

    Examples
    --------
    >>> kept_property("bending_stiffness", [2, 1], 1.0)
    Table(x=(0.0, 0.5, 0.5, 1.0), value=(2.0, 2.0, 1.0, 1.0))
    """
    given = unwrapped(name, given)
    if isinstance(given, Table) or _is_row(given):
        kept = _spanning(name, given, length) if isinstance(given, Table) else _steps(name, given, length)
        return table_with_breaks(kept, breaks) if isinstance(kept, Table) else kept
    if callable(given):
        given = _in_plain_numbers(name, given, length)
        _try(name, given, length)
        own = given.breaks if isinstance(given, BrokenFunction) else ()
        places = each_place_once(sorted((*own, *breaks)), length)
        function = given.function if isinstance(given, BrokenFunction) else given
        return BrokenFunction(function, places) if places else function
    if name != _MAY_VANISH:
        return positive_real(name, given)
    number = real(name, given)
    if number < 0.0:
        raise ValueError(f"{name} must not be negative, got {shown(given)}")
    return number + 0.0


def _in_plain_numbers(name: str, function: Any, length: float) -> Any:
    """Return a function that may give quantities with units as one that gives plain numbers."""
    if "pint" not in sys.modules:
        return function
    try:
        value = function(0.5 * length)
    except Exception:
        # What is wrong with it is told where it is tried along the beam.
        return function
    if unwrapped(name, value) is value:
        return function
    if isinstance(function, BrokenFunction):
        return BrokenFunction(_InPlainNumbers(name, function.function), function.breaks)
    return _InPlainNumbers(name, function)


@dataclass(frozen=True)
class _InPlainNumbers:
    name: str
    function: Callable[[Any], Any]

    def __call__(self, x: Any) -> Any:
        return unwrapped(self.name, self.function(x))


def kept_breaks(given: object, length: float) -> tuple[float, ...]:
    """Return positions that a user marks inside a beam of this length, ascending, each once [m].

    Raises
    ------
    TypeError, ValueError
        If it is no sequence of real numbers, or one lies outside the beam or at its end.

    Examples
    --------
    >>> kept_breaks([0.7, 0.2], 1.0)
    (0.2, 0.7)
    """
    given = unwrapped("breaks", given)
    if not isinstance(given, Sequence | np.ndarray) or (isinstance(given, np.ndarray) and given.ndim != 1):
        raise TypeError(f"breaks must be a sequence of positions, got {shown(given)}")
    places = sorted(real("breaks", place) for place in bounded("breaks", given))
    for place in places:
        if not SAME_PLACE * length < place < (1.0 - SAME_PLACE) * length:
            raise ValueError(
                f"breaks must be positions inside the beam, between 0 and its length {length}, got {place}"
            )
    return each_place_once(places, length)


def each_place_once(places: Sequence[float], length: float) -> tuple[float, ...]:
    """Return ascending positions without those that are the one before but for rounding [m]."""
    kept: list[float] = []
    for x in places:
        # Thirds and sixths of a length meet but for rounding.
        if not kept or x - kept[-1] > SAME_PLACE * length:
            kept.append(x)
    return tuple(kept)


def _is_row(given: object) -> bool:
    if isinstance(given, np.ndarray):
        return given.ndim == 1 and given.size > 1
    return isinstance(given, Sequence) and not is_text(given) and len(given) > 1


def _steps(name: str, given: Any, length: float) -> Profile:
    if len(given) > _MOST_PARTS:
        raise ValueError(f"{name} must have at most {_MOST_PARTS} parts, got {len(given)}")
    for part, item in enumerate(given, start=1):
        try:
            _allowed(name, real(name, item), f" on part {part} of {len(given)}")
        except (TypeError, ValueError) as error:
            raise type(error)(f"{error}; the whole is {shown(given)}") from None
    values = [float(item) + 0.0 for item in given]
    if min(values) == max(values):
        return values[0]
    inner = [length * part / len(values) for part in range(1, len(values)) for _ in range(2)]
    return Table((0.0, *inner, length), tuple(value for value in values for _ in range(2)))


def _spanning(name: str, table: Table, length: float) -> Profile:
    if abs(table.x[-1] - length) > SAME_PLACE * length:
        raise ValueError(
            f"{name} must be tabulated from 0 to the beam's length {length}, got a table up to {table.x[-1]}"
        )
    check_kinds(name, table)
    for x, value in zip(table.x, table.value, strict=True):
        _allowed(name, value, f" at x = {x}")
    if min(table.value) == max(table.value):
        return table.value[0]
    return table if table.x[-1] == length else Table((*table.x[:-1], length), table.value)


def _try(name: str, function: Callable[[Any], Any], length: float) -> None:
    """Evaluate a function along the beam, for an array and for single numbers."""
    grid = 0.5 * length * (1.0 - np.cos(np.pi * np.arange(_GRID) / (_GRID - 1)))
    grid[-1] = length
    one_by_one = []
    for x in grid.tolist():
        try:
            value = function(x)
        except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
            told = f"{type(error).__name__}: {error}"
            raise TypeError(
                f"{name} must be a function of one position, got {shown(function)}, "
                f"which fails at x = {x}: {told}"
            ) from error
        number = value.item() if isinstance(value, np.ndarray | np.generic) and value.size == 1 else value
        one_by_one.append(_allowed(name, real(f"{name} at x = {x}", number), f" at x = {x}"))
    together = value_at(function, grid)
    differing = ~(np.abs(together - one_by_one) <= 1e-9 * np.abs(one_by_one))
    if differing.any():
        at = int(np.argmax(differing))
        raise ValueError(
            f"{name} must be a function with one value at each position, got {together[at]} for an array "
            f"and {one_by_one[at]} for the number at x = {grid[at]}"
        )
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES * length
    values = value_at(function, places)
    wrong = ~(np.isfinite(values) & ((values > 0.0) | ((values == 0.0) & (name == _MAY_VANISH))))
    if wrong.any():
        at = int(np.argmax(wrong))
        _allowed(name, real(f"{name} at x = {places[at]}", values[at].item()), f" at x = {places[at]}")


def _allowed(name: str, value: float, where: str) -> float:
    """Return a value that the property may have, or raise an error that says where it is not."""
    if name == _MAY_VANISH:
        if value < 0.0:
            raise ValueError(f"{name} must not be negative, got {value}{where}")
    elif value < 0.0:
        raise ValueError(f"{name} must be greater than 0, got {value}{where}")
    elif value == 0.0:
        raise ValueError(
            f"{name} must be greater than 0, got {value}{where}: a beam may not taper to nothing, "
            "let it end where the section is still finite"
        )
    return value


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Beam(Shown):
    """A straight elastic beam, uniform or not, in any consistent set of units.

    Its bending obeys  ρA ∂²y/∂t² - ∂/∂x(ρI ∂³y/∂x∂t²) + ∂²/∂x²(EI ∂²y/∂x²) = 0  for 0 < x < L: Euler and
    Bernoulli's beam, or Rayleigh's where the section's rotary inertia ρI is given.

    Each property along the beam is a number; a sequence of two numbers or more, constant on that many equal
    lengths; a `Table`; or a function of x [m], for arrays or for one number at a time. Sequences are kept as
    tables, and what is constant as a number.

    Between its breaks a beam is smooth. Breaks are the steps of sequences, the positions that a `Table` has
    twice, and those of `breaks`: a function's steps and kinks, and the kinks of a table that are meant as
    such. A table's other kinks are no breaks: a fine table of a taper is a taper. See `breaks` below.

    Bending needs EI, ρA and, if it counts, ρI. κGA and r are for `timoshenko` and `theory_errors`, which tell
    what shear does: no chain has it. GJ and ρIp are for twist, EA and ρA for stretch.

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
    torsional_stiffness : float, sequence, Table or function [N m²], optional
        GJ, shear modulus times torsion constant of the cross-section.
    polar_inertia_per_length : float, sequence, Table or function [kg m], optional
        ρIp, density times polar second moment of area.
    axial_stiffness : float, sequence, Table or function [N], optional
        EA, elastic modulus times area.
    assumed : tuple of str
        What of κGA, r and GJ was assumed and not given, in words; no part of what makes beams equal.
    breaks : sequence of float, optional [m]
        Positions inside the beam where a property has a step or a kink that it does not tell itself, in any
        order. Two of them also show where a function has a feature narrower than L/4096, the distance of the
        places at which functions are looked at.

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
    torsional_stiffness: Profile | None
    polar_inertia_per_length: Profile | None
    axial_stiffness: Profile | None
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
        torsional_stiffness: PropertyLike | None = None,
        polar_inertia_per_length: PropertyLike | None = None,
        axial_stiffness: PropertyLike | None = None,
        assumed: tuple[str, ...] = (),
        breaks: Sequence[float] | NDArray[Any] = (),
    ) -> None:
        whole = positive_real("length", length)
        object.__setattr__(self, "length", whole)
        places = kept_breaks(breaks, whole)
        needed = (bending_stiffness, mass_per_length, rotary_inertia_per_length)
        for name, value in zip(_NEEDED, needed, strict=True):
            object.__setattr__(self, name, kept_property(name, value, whole, places))
        optional = (shear_stiffness, torsional_stiffness, polar_inertia_per_length, axial_stiffness)
        for name, given in zip(_OPTIONAL, optional, strict=True):
            kept = None if given is None else kept_property(name, given, whole, places)
            object.__setattr__(self, name, kept)
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
        section: sections.Section,
        *,
        density: float,
        elastic_modulus: float,
        length: float,
        rotary_inertia: bool = False,
        poisson_ratio: float | None = None,
        shear_coefficient: float | None = None,
    ) -> Beam:
        """Return the uniform beam of a cross-section and a material: EI, ρA, κGA, r, EA and, if wanted, ρI.

            G = E / (2 (1 + ν))

        GJ and ρIp where the section has its torsion constant J and its weak second moment, Ip = I + I_weak.

        Parameters
        ----------
        section : Section
            One of `sections`, or anything with an `area` [m²] and a `second_moment` [m⁴]; for twist also
            with a `torsion_constant` [m⁴] and a `weak_second_moment` [m⁴].
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
        twisting, weak = (_known(section, name) for name in ("torsion_constant", "weak_second_moment"))
        torsional = None if twisting is None else modulus / (2.0 * (1.0 + ratio)) * twisting
        polar = None if weak is None else rho * (moment + weak)
        for name, value in (
            ("density", rho * area),
            ("density", rho * moment),
            ("density", 1.0 if polar is None else polar),
            ("elastic_modulus", modulus * moment),
            ("elastic_modulus", modulus * area),
            ("elastic_modulus", 1.0 if torsional is None else torsional),
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
            torsional_stiffness=torsional,
            polar_inertia_per_length=polar,
            axial_stiffness=modulus * area,
            assumed=assumed,
        )

    @classmethod
    def from_sections(
        cls,
        x: ArrayLike,
        sections: Sequence[sections.Section],
        *,
        density: float,
        elastic_modulus: float,
        rotary_inertia: bool = False,
        poisson_ratio: float | None = None,
        shear_coefficient: float | None = None,
        breaks: Sequence[float] | NDArray[Any] = (),
    ) -> Beam:
        """Return the beam of sections that were measured at places along it.

        What is interpolated, linearly, is the dimensions of the sections, and not EI, which is curved between
        them. The properties are fine tables, of 1,000 intervals or more: one beam that tapers, without a
        break at a measured place unless it is given twice, a step, or among `breaks`. Between the tables'
        positions EI is within 2 (a/n)² of its own where the dimensions change by the part a from one measured
        place to the next and n intervals are there.

        Parameters
        ----------
        x : sequence of float [m]
            Where they were measured, from 0 to the beam's length, ascending; twice at a step.
        sections : sequence of sections
            One for each x, all of one kind, such as `Circle`.
        density, elastic_modulus, rotary_inertia, poisson_ratio, shear_coefficient
            As of `from_section`.
        breaks : sequence of float [m]
            As of `Beam`.

        Raises
        ------
        TypeError, ValueError
            If an argument is not of its kind, `x` is not as above, or the sections are of different kinds.

        Examples
        --------
        >>> from beammodes.problem.sections import Circle
        >>> measured = [Circle(0.012), Circle(0.010), Circle(0.004)]
        >>> rod = Beam.from_sections([0.0, 0.5, 2.0], measured, density=1800.0, elastic_modulus=40e9)
        >>> round(float(value_at(rod.bending_stiffness, 1.25)), 6), rod.breaks         # 7 mm there
        (4.714352, ())
        """
        places, listed = real_numbers("x", x), bounded("sections", sections, most=_MOST_PARTS)
        if places.ndim != 1 or len(places) < 2 or len(places) != len(listed):
            raise ValueError(
                f"x must be two places or more, one for each of {len(listed)} sections, got {shown(x)}"
            )
        step = np.diff(places)
        if (
            places[0] != 0.0
            or (step < 0.0).any()
            or not (step[0] and step[-1])
            or (step[1:] + step[:-1] == 0.0).any()
        ):
            raise ValueError(
                f"x must begin at 0 and ascend, each place once, or twice inside for a step, got {shown(x)}"
            )
        if len({type(section) for section in listed}) > 1 or not is_dataclass(listed[0]):
            raise TypeError(f"sections must be of one kind, such as Circle, got {shown(listed)}")
        length, given = float(places[-1]), {"density": density, "elastic_modulus": elastic_modulus}
        options: dict[str, Any] = {
            "length": length,
            "rotary_inertia": rotary_inertia,
            "poisson_ratio": poisson_ratio,
            "shear_coefficient": shear_coefficient,
            **given,
        }
        at, beams = list[float](), list[Beam]()
        for i in np.flatnonzero(step).tolist():
            count = max(2, math.ceil(_FINE * step[i] / length))
            # A place that is no step stands once.
            for k in range(1 if at and at[-1] == places[i] and step[i - 1] else 0, count + 1):
                share = k / count
                at.append(float(places[i + 1]) if k == count else float(places[i] + share * step[i]))
                beams.append(cls.from_section(_between(listed[i], listed[i + 1], share), **options))

        def table(name: str) -> Table | None:
            values = [getattr(beam, name) for beam in beams]
            return None if any(value is None for value in values) else Table(at, values)

        along: dict[str, Any] = {name: table(name) for name in (*_NEEDED, *_OPTIONAL)}
        if not rotary_inertia:
            del along["rotary_inertia_per_length"]
        return cls(length, **along, assumed=beams[0].assumed, breaks=breaks)

    @property
    def is_uniform(self) -> bool:
        """True if all three properties are numbers; rotary inertia may still be one of them."""
        return all(isinstance(getattr(self, name), float) for name in _NEEDED)

    @property
    def has_rotary_inertia(self) -> bool:
        """True if the section's rotary inertia is not zero."""
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
        properties = (getattr(self, name) for name in (*_NEEDED, *_OPTIONAL))
        places = sorted(x for profile in properties if profile is not None for x in profile_breaks(profile))
        return each_place_once(places, self.length)

    @property
    def frequency_unit(self) -> float:
        """√(EI / (ρA L⁴)) of mean EI and mean ρA [rad/s], which a dimensionless frequency multiplies."""
        speed = math.sqrt(self.mean_bending_stiffness) / math.sqrt(self.mean_mass_per_length)
        return speed / self.length / self.length

    def _line(self) -> str:
        given = {
            "length": self.length,
            "bending_stiffness": self.bending_stiffness,
            "mass_per_length": self.mass_per_length,
            "rotary_inertia_per_length": self.rotary_inertia_per_length or None,
            "shear_stiffness": self.shear_stiffness,
            "radius_of_gyration": self.radius_of_gyration,
            **{name: getattr(self, name) for name in _OPTIONAL[1:]},
        }
        told = (f"{name}={part_shown(value)}" for name, value in given.items() if value is not None)
        return f"Beam({', '.join(told)})"


#: Intervals of the tables of measured sections.
_FINE = 1000


def _between(first: Any, second: Any, share: float) -> Any:
    """Return a section with the dimensions of two, so much of the second."""
    if not share or first == second:
        return first
    mixed = {}
    for name in (part.name for part in fields(first) if part.init):
        a, b = getattr(first, name), getattr(second, name)
        if (a is None) != (b is None):
            raise ValueError(f"sections must all have {name} or none, got {shown(first)} and {shown(second)}")
        mixed[name] = a if a is None else (1.0 - share) * a + share * b
    return type(first)(**mixed)


#: Of most metals; a shear modulus between 0.8 and 1.3 times its own belongs to any ν from 0 to 0.5.
_POISSON_RATIO = 0.3


_COEFFICIENT = 5 / 6


def _in_shear(
    section: sections.Section, poisson_ratio: float | None, shear_coefficient: float | None
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


def _known(section: sections.Section, name: str) -> float | None:
    """Return a number that a section may have, None if it has none."""
    value = getattr(section, name, None)
    return None if value is None else positive_real(f"{name} of section", value)


# Positions along a beam, as users give them to mode shapes.


def positions_on(beam: Beam, x: ArrayLike) -> Floats:
    """Return `x` as floats.

    Raises
    ------
    TypeError, ValueError
        If it is not real numbers in one regular array, finite and inside [0, L].

    Examples
    --------
    >>> positions_on(Beam.unit(), [0, 1])
    array([0., 1.])
    """
    position = real_numbers("x", x, finite=False)
    outside = ~((position >= 0.0) & (position <= beam.length))
    if outside.any():
        raise ValueError(f"x must be finite and inside [0, {beam.length}], got {position[outside][0]}")
    return position
