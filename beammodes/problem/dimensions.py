"""The unit of every argument, said once, and quantities of a library of units (pint) as plain numbers in it.

No such library is imported here: a quantity is known by what it can do; where none is loaded there is none.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

__all__ = [
    "ANY",
    "UNITS",
    "Kind",
    "is_quantity",
    "kind_of",
    "kind_of_numbers",
    "kind_of_quantity",
    "plain_number",
    "unit_attributes",
    "unit_of",
]

#: Powers of mass, length and time.
Kind = tuple[float, float, float]

#: The unit of an argument that takes a quantity of any kind, such as the values of a table.
ANY = "any"

# Arguments by their unit; an argument that is not here is a number without one. Where one word means several
# things, the place that reads it says which.
_BY_UNIT = {
    "m": (
        "length x y s offset hub_radius radius pitch straight points diameter width height wall flange web "
        "outer inner centre breaks start stop deflection radius_of_gyration length_unit force_at moment_at "
        "deflection_at rotation_at span end_place"
    ),
    "m2": "area",
    "m4": "second_moment weak_second_moment torsion_constant",
    "N m2": "bending_stiffness second_bending_stiffness torsional_stiffness",
    "N": (
        "axial_stiffness shear_stiffness second_shear_stiffness axial_force tip_force mid_force force "
        "compression"
    ),
    "N/m": "translational_stiffness uniform_load per_length",
    "N m": "rotational_stiffness joint_stiffness hinge start_hinge end_hinge tip_moment moment torque",
    "kg": "mass",
    "kg/m": "mass_per_length",
    "kg m": ("rotary_inertia_per_length second_rotary_inertia_per_length polar_inertia_per_length"),
    "kg m2": "rotary_inertia armature",
    "kg/m3": "density",
    "Pa": "elastic_modulus",
    "m/s2": "gravity",
    "s": "duration step output_step timestep time rise trace",
    "Hz": "frequency first last band fps",
    "rad/s": "spin_rate rate angular_frequency highest_frequency",
    "rad": "angle phase",
    "rad/m": "curvature twist",
    "N m s": "joint damping",
}
UNITS: Mapping[str, str] = MappingProxyType(
    {name: unit for unit, names in _BY_UNIT.items() for name in names.split()}
)

_BASE: Mapping[str, Kind] = {
    "kg": (1, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
    "Pa": (1, -1, -2),
    "Hz": (0, 0, -1),
    "rad": (0, 0, 0),
    "1": (0, 0, 0),
}
_BASES = ("[mass]", "[length]", "[time]")


def unit_of(name: str) -> str:
    """Return the unit of an argument by its name in a message, "1" if it is a number without one.

    Examples
    --------
    >>> unit_of("length"), unit_of("gravity[1]"), unit_of("mass at x = 0.3"), unit_of("tolerance")
    ('m', 'm/s2', 'kg', '1')
    """
    word = re.match(r"(?:--)?(\w*)", name)
    return UNITS.get(word.group(1) if word else "", "1")


def kind_of(unit: str) -> Kind:
    """Return the kind of a unit, as powers of mass, length and time.

    Examples
    --------
    >>> kind_of("N m2"), kind_of("kg/m3"), kind_of("rad/s")
    ((1, 3, -2), (1, -3, 0), (0, 0, -1))
    """
    above, _, below = unit.partition("/")
    total: list[float] = [0, 0, 0]
    for part, sign in ((above, 1), (below, -1)):
        for word in part.split():
            parts = re.fullmatch(r"([A-Za-z]+|1)(\d*)", word)
            assert parts, word
            base, power = parts.groups()
            for i, exponent in enumerate(_BASE[base]):
                total[i] += sign * exponent * int(power or 1)
    return total[0], total[1], total[2]


def is_quantity(value: object) -> bool:
    """Return True for a number with a unit, or an array of such.

    Examples
    --------
    >>> is_quantity(1.2)
    False
    """
    return "pint" in sys.modules and hasattr(value, "dimensionality") and hasattr(value, "to_root_units")


def kind_of_quantity(value: Any) -> Kind:
    """Return the kind of a quantity, nan for one that no argument here has, such as a current."""
    powers = dict(value.dimensionality)
    mass, length, time = (float(powers.pop(base, 0)) for base in _BASES)
    return (math.nan, math.nan, math.nan) if powers else (mass, length, time)


def kind_of_numbers(value: Any) -> Kind | None:
    """Return the kind of a quantity or of the first of a row of them, None if there is no quantity.

    Examples
    --------
    >>> kind_of_numbers([1.0, 2.0]) is None
    True
    """
    first = value[0] if isinstance(value, list | tuple) and value else value
    first = first.data if type(first).__name__ == "DataArray" else first
    return kind_of_quantity(first) if is_quantity(first) else None


def unit_attributes(units: str) -> dict[str, str]:
    """Return the attributes of a dataset's variable that say its unit, `units` where libraries can read it.

    Multiples of a beam's own numbers are numbers without a unit.

    Examples
    --------
    >>> unit_attributes("rad / s"), unit_attributes("EI / L^2")
    ({'units': 'rad / s'}, {'units': '1', 'multiple_of': 'EI / L^2'})
    >>> unit_attributes("m, rad")
    {'units_in_words': 'm, rad'}
    """
    if re.search(r" of |, |^as ", units):
        return {"units_in_words": units}
    own = re.search(r"EI|EA|GJ|rho|^L$", units)
    return {"units": "1", "multiple_of": units} if own else {"units": units}


def plain_number(value: Any, unit: str) -> Any:
    """Return a quantity as a plain number, or array, in a unit; None if it is of another kind.

    The unit may be one of several, as "m or rad". Cycles and radians are told apart, as such libraries do
    not: rad/s becomes Hz by 2π, and Hz rad/s.
    """
    kind = kind_of_quantity(value)
    if math.isnan(kind[0]) or (unit != ANY and kind not in map(kind_of, unit.split(" or "))):
        return None
    in_radians = "radian" in _words(value.to_root_units())
    if unit == "1" and in_radians:
        # One turn would become 6.28 of what has no unit.
        return None
    if unit == "1" and not _words(value):
        # Whole numbers stay such.
        return value.magnitude
    found = value.to(
        "*".join(f"{base}**{power:g}" for base, power in zip(("kg", "m", "s"), kind, strict=True))
    )
    # 2π rad times a frequency in Hz is in rad/s already.
    if unit == "Hz" and in_radians:
        return found.magnitude / (2.0 * math.pi)
    cycles = unit == "rad/s" and "hertz" in _words(value) and not in_radians
    return found.magnitude * (2.0 * math.pi if cycles else 1.0)


def _words(value: Any) -> str:
    """Return the names of a quantity's units, which its registry may print shortened or as LaTeX."""
    return " ".join(name for name, _ in value.unit_items())
