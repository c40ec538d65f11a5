"""Numbers of ends and loads as dimensions of a table: "right_mass", "axial_force" and others."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from beammodes.accuracy.grids import listed
from beammodes.chains.units import ExactUnits
from beammodes.checks import choice, shown
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.problem.supports import NUMBERS_OF_END, End

__all__ = ["NUMBERS", "EndNumbers", "in_beam_units", "load_in_beam_units", "with_numbers"]

_UNITS = {
    "translational_stiffness": "EI / L^3",
    "rotational_stiffness": "EI / L",
    "mass": "rhoA L",
    "rotary_inertia": "rhoA L^3",
    "offset": "L",
}

#: What may be a dimension, and its unit in a table for L = EI = ρA = 1.
NUMBERS: dict[str, str] = {
    **{f"{side}_{name}": _UNITS[name] for side in ("left", "right") for name in NUMBERS_OF_END},
    "axial_force": "EI / L^2",
    "spin_rate": "sqrt(EI / (rhoA L^4))",
    "hub_radius": "L",
}


class EndNumbers:
    """Names and values that a table runs over, beside rules, boundaries, segments and modes.

    Examples
    --------
    >>> over = EndNumbers({"right_mass": [0.0, 0.5]})
    >>> [str(pair) for _, pair, _ in over.cases(Boundary.of("clamped-free"), Load())]
    ['clamped-free', 'clamped-free(mass=0.5)']
    """

    def __init__(self, over: Mapping[str, Iterable[float]] | None) -> None:
        if over is not None and not isinstance(over, Mapping):
            raise TypeError(f"over must map names to numbers, got {shown(over)}")
        self.values: dict[str, list[float]] = {
            choice("over", name, NUMBERS): listed(name, values, (str,))
            for name, values in (over or {}).items()
        }

    @property
    def shape(self) -> tuple[int, ...]:
        """How many of each."""
        return tuple(len(values) for values in self.values.values())

    def coordinates(self) -> dict[str, tuple[str, list[float], dict[str, str]]]:
        """Return the coordinates as xarray takes them."""
        return {
            name: (name, values, {"long_name": name.replace("_", " "), "units": NUMBERS[name]})
            for name, values in self.values.items()
        }

    def cases(self, boundary: Boundary, load: Load) -> Iterator[tuple[tuple[int, ...], Boundary, Load]]:
        """Yield indices, and the boundary and the load with these numbers in the place of their own."""
        for index in np.ndindex(self.shape):
            chosen = {name: values[i] for (name, values), i in zip(self.values.items(), index, strict=True)}
            yield index, *with_numbers(boundary, load, chosen)


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
            held = math.inf if value == math.inf else value
            number: dict[str, Any] = {field: held}
            ends[side] = replace(ends[side], **number)
        else:
            load = replace(load, **{name: value})
    return Boundary(**ends), load


def in_beam_units(boundary: Boundary, beam: Beam) -> Boundary:
    """Return ends whose numbers count for L = EI = ρA = 1 as these do for a uniform `beam`.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam.

    Examples
    --------
    >>> print(in_beam_units(Boundary.of("clamped-free(mass=3)"), Beam(2.0, 1.0, 3.0)))
    clamped-free(mass=0.5)
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    units = ExactUnits.of(beam, 1)
    ends = []
    for end in (boundary.left, boundary.right):
        mass, inertia, offset = units.body(end.mass, end.rotary_inertia, end.offset)
        supports = (units.support(end.translational_stiffness, 2), units.support(end.rotational_stiffness, 0))
        ends.append(End(*map(float, (*supports, mass, inertia, offset)), on_segment=end.on_segment))
    return Boundary(*ends)


def load_in_beam_units(load: Load, beam: Beam) -> Load:
    """Return axial force, spin rate and hub radius that count for L = EI = ρA = 1 as these do for `beam`.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam, or there is more to the load than those three.

    Examples
    --------
    >>> load_in_beam_units(Load(axial_force=3.0), Beam(2.0, 1.0, 1.0)).axial_force
    12.0
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    if any(load.weight) or any(load.tip) or load.tip_moment:
        raise ValueError(f"load must be an axial force or a spin here, got {shown(load)}")
    return Load(
        axial_force=float(ExactUnits.of(beam, 1).force(load.axial_force)),
        spin_rate=float(load.spin_rate) / beam.frequency_unit,
        hub_radius=float(load.hub_radius) / beam.length,
        plane=load.plane,
    )
