"""The numbers of ends and loads in multiples of a beam's own units, and their names.

Closed forms take multiples of ρA L, ρA L³, L, EI/L³, EI/L and EI/L², as if L = EI = ρA = 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import Any

import numpy as np

from beammodes.chains.units import ExactUnits
from beammodes.checks import distinct, instead, shown
from beammodes.problem.beam import Beam
from beammodes.problem.ends import NUMBERS_OF_END, Boundary, check_multiples, has_many, with_pairs_read
from beammodes.problem.loading import Load, load_of

__all__ = [
    "BEAM_NUMBERS",
    "NUMBERS",
    "in_beam_units",
    "load_in_beam_units",
    "looked_up",
    "with_numbers",
]

_END_UNITS = {
    "translational_stiffness": ("EI / L^3", "N / m"),
    "rotational_stiffness": ("EI / L", "N m / rad"),
    "mass": ("rhoA L", "kg"),
    "rotary_inertia": ("rhoA L^3", "kg m^2"),
    "offset": ("L", "m"),
}
_UNITS = {
    **{f"{side}_{name}": _END_UNITS[name] for side in ("left", "right") for name in NUMBERS_OF_END},
    "axial_force": ("EI / L^2", "N"),
    "spin_rate": ("sqrt(EI / (rhoA L^4))", "rad / s"),
    "hub_radius": ("L", "m"),
}

#: Names of numbers of ends and loads, with their unit for L = EI = ρA = 1.
NUMBERS: Mapping[str, str] = MappingProxyType({name: own for name, (own, _) in _UNITS.items()})

#: The same for a beam in any consistent units, here named as SI.
BEAM_NUMBERS: Mapping[str, str] = MappingProxyType({name: units for name, (_, units) in _UNITS.items()})


def with_numbers(boundary: Boundary, load: Load, numbers: Mapping[str, Any]) -> tuple[Boundary, Load]:
    """Return a boundary and a load with numbers, named as in `NUMBERS`, in the place of their own.

    Examples
    --------
    >>> print(*with_numbers(Boundary.of("clamped-free"), Load(), {"right_mass": 0.5})[:1])
    clamped-free(mass=0.5)
    """
    ends = {"left": boundary.left, "right": boundary.right}
    for name, value in numbers.items():
        side, _, field = name.partition("_")
        if side in ends:
            # Rigid is one object, which `End` looks for.
            number: dict[str, Any] = {field: math.inf if value == math.inf else value}
            ends[side] = replace(ends[side], **number)
        else:
            load = replace(load, **{name: value})
    return Boundary(**ends), load


def in_beam_units(boundary: Boundary, beam: Beam) -> Boundary:
    """Return ends whose numbers count for L = EI = ρA = 1 as these do for a uniform `beam`.

    Examples
    --------
    >>> print(in_beam_units(Boundary.of("clamped-free(mass=3)"), Beam(2.0, 1.0, 3.0)))
    clamped-free(mass=0.5)
    """
    units = ExactUnits.of(_plain_beam(beam), 1)
    ends = []
    for end in (boundary.left, boundary.right):
        mass, inertia, offset = units.body(end.mass, end.rotary_inertia, end.offset)
        numbers = {
            "translational_stiffness": units.support(end.translational_stiffness, 2),
            "rotational_stiffness": units.support(end.rotational_stiffness, 0),
            "mass": mass,
            "rotary_inertia": inertia,
            "offset": offset,
            "hub_radius": units.body(0, 0, end.hub_radius)[2],
        }
        scaled: dict[str, Any] = {name: _float(name, value) for name, value in numbers.items()}
        ends.append(replace(end, **scaled))
    return Boundary(*ends)


def _many_in_beam_units(boundary: Any, beam: Beam) -> tuple[Any, Any]:
    """Return a pair of which one or both ends are many."""
    from beammodes.problem.end_columns import Ends, pairs_of_columns

    columns, shape = pairs_of_columns(boundary)
    length, stiffness = beam.length, beam.mean_bending_stiffness
    mass = beam.mean_mass_per_length * length
    left, right = (
        Ends(
            (side.translational_stiffness * (length**3 / stiffness)).reshape(shape),
            (side.rotational_stiffness * (length / stiffness)).reshape(shape),
            (side.mass / mass).reshape(shape),
            (side.rotary_inertia / (mass * length**2)).reshape(shape),
            (side.offset / length).reshape(shape),
            on_segment=side.on_segment.reshape(shape),
        )
        for side in (columns.left, columns.right)
    )
    return left, right


def load_in_beam_units(load: Load, beam: Beam) -> Load:
    """Return a load whose numbers count for L = EI = ρA = 1 as these do for a uniform `beam`.

    Examples
    --------
    >>> load_in_beam_units(Load(axial_force=3.0), Beam(2.0, 1.0, 1.0)).axial_force
    12.0
    """
    units = ExactUnits.of(_plain_beam(beam), 1)
    return Load(
        axial_force=_float("axial_force", units.force(load.axial_force)),
        spin_rate=float(load.spin_rate) / beam.frequency_unit,
        hub_radius=float(load.hub_radius) / beam.length,
        plane=load.plane,
        gravity=_floats("gravity", map(units.acceleration, load.weight)),
        tip_force=_floats("tip_force", map(units.force, load.tip)),
        tip_moment=_float("tip_moment", units.moment(load.tip_moment)),
    )


def looked_up(boundary: Any, load: Load | None, beam: Beam | None) -> tuple[Any, Load]:
    """Return ends and load in multiples, as closed forms take them.

    The one place that says what the numbers of a question without a chain mean: with a `beam` they are in its
    units; without one those of ends are multiples already, and a load is refused. `boundary` may be an array.

    Examples
    --------
    >>> print(*looked_up("clamped-free(mass=3)", Load(axial_force=3.0), Beam(2.0, 1.0, 3.0)))
    clamped-free(mass=0.5) Load(axial_force=12.0)
    """
    pull = load_of(load, beam)
    if beam is None:
        check_multiples(boundary)
        return boundary, pull
    plain = _plain_beam(beam)
    if has_many(boundary):
        return _many_in_beam_units(boundary, plain), load_in_beam_units(pull, beam)
    pairs, which = distinct("boundary", with_pairs_read(boundary), (str, Boundary), Boundary.of)
    scaled = np.empty(len(pairs), dtype=object)
    scaled[:] = [in_beam_units(pair, plain) for pair in pairs]
    return scaled[which], load_in_beam_units(pull, beam)


def _plain_beam(beam: Beam) -> Beam:
    if not isinstance(beam, Beam):
        hint = instead(beam, Rod="rod_errors takes SpatialChain(rod, ...), rod_error_dataset many of them")
        raise TypeError(f"beam must be a Beam, got {shown(beam)}{hint}")
    if beam.is_uniform and not beam.has_rotary_inertia:
        return beam
    kind = "without rotary inertia of its sections" if beam.is_uniform else "uniform"
    raise ValueError(
        f"beam must be {kind} here, got {shown(beam)}: for any beam call chain_errors(Chain(beam, ...))"
    )


def _float(name: str, value: Fraction | float) -> float:
    """Return a number as a float, unless it leaves the range of floats."""
    try:
        number = float(value)
    except OverflowError:
        number = math.nan
    if math.isnan(number) or (value and not number):
        raise ValueError(f"{name} must suit the beam: in its own units it leaves the range of floats")
    return number


def _floats(name: str, values: Iterable[Fraction]) -> tuple[float, float]:
    x, y = (_float(name, value) for value in values)
    return x, y
