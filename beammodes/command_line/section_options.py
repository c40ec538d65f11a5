"""A beam of a section and a material on the command line, in the place of its stiffnesses and masses."""

from __future__ import annotations

import argparse
from fractions import Fraction
from typing import Any

from beammodes.checks import choice, positive_real
from beammodes.command_line.text_tables import declared, number
from beammodes.command_line.typed_calls import typed_call
from beammodes.exporters.unit_systems import UNIT_SYSTEMS
from beammodes.problem.materials import MATERIALS, PASCALS, Material, plain_name
from beammodes.problem.rod import Rod
from beammodes.problem.sections import SECTIONS, Shape

__all__ = ["beam_of_section"]

#: What a motion takes: the flags by what `Rod.of_section` calls them.
_TAKES = {
    "bending": ("ei", "rho_a"),
    "twist": ("gj", "rho_ip"),
    "stretch": ("ea", "rho_a"),
    "space": ("ei", "ei_across", "gj", "rho_a", "rho_ip"),
}
_NUMBERS = {
    "ei": ("bending_stiffness", "EI"),
    "ei_across": ("second_bending_stiffness", "EI across"),
    "gj": ("torsional_stiffness", "GJ"),
    "ea": ("axial_stiffness", "EA"),
    "rho_a": ("mass_per_length", "ρA"),
    "rho_ip": ("polar_inertia_per_length", "ρIp"),
}


def beam_of_section(options: argparse.Namespace) -> tuple[dict[str, Any], str]:
    """Return the options that a section and a material stand for, and a line that says them.

    Without --units and with a material, numbers are in SI.

    Raises
    ------
    TypeError, ValueError
        If one of them is missing or unknown, or an option is given that they set.

    Examples
    --------
    >>> from argparse import Namespace
    >>> typed = dict(material="steel", units=None, length=1.0, motion="bending")
    >>> typed |= dict(density=None, elastic_modulus=None, poisson_ratio=None)
    >>> beam_of_section(Namespace(section="circle(diameter=0.01)", **typed))[1]
    'circle(diameter=0.01) of steel (E 2.06843e+11, ρ 7850): EI 101.534, ρA 0.616538, in SI'
    """
    if options.section is None:
        others = ("material", "elastic_modulus", "density", "poisson_ratio")
        given = next(name for name in others if getattr(options, name) is not None)
        raise ValueError(f"--section must be given with --{given.replace('_', '-')}")
    motion = getattr(options, "motion", "bending")
    for name in _NUMBERS:
        if getattr(options, name, None) is not None:
            flag = name.replace("_", "-")
            raise ValueError(f"--{flag} must be left out with --section, which sets it")
    if options.length is None and motion != "space":
        raise ValueError("--length must be given with --section")
    word, dimensions = typed_call("--section", options.section, SECTIONS)
    section: Shape = SECTIONS[word](**dimensions)
    system = "SI" if options.units is None else declared(options.units)
    stuff = _material(options, system)
    found = _properties(section, stuff, with_twist=motion in ("twist", "space"))
    set_here = {name: found[_NUMBERS[name][0]] for name in _TAKES.get(motion, ())}
    told = ", ".join(f"{_NUMBERS[name][1]} {number(value)}" for name, value in set_here.items())
    units = system if options.units is not None or options.material is not None else None
    made = f"{options.section} of {stuff.name} (E {number(stuff.elastic_modulus)}, ρ {number(stuff.density)})"
    return set_here | {"units": units}, f"{made}: {told}" + (f", in {units}" if units else "")


def _material(options: argparse.Namespace, system: str) -> Material:
    """Return the numbers of the material in the user's units."""
    own = {name: getattr(options, name) for name in ("elastic_modulus", "density", "poisson_ratio")}
    known: dict[str, Any] = {"poisson_ratio": None}
    name = "given numbers"
    if options.material is not None:
        record = MATERIALS[choice("--material", plain_name(options.material, MATERIALS), MATERIALS)]
        metre = 1.0 / UNIT_SYSTEMS[system].metres
        newton = 1.0 if UNIT_SYSTEMS[system].force == "N" else 1.0 / float(PASCALS * Fraction("0.0254") ** 2)
        name, known = (
            record.name,
            {
                "elastic_modulus": record.elastic_modulus * newton / metre**2,
                "density": record.density * newton / metre**4,
                "poisson_ratio": record.poisson_ratio,
            },
        )
    for each in ("elastic_modulus", "density"):
        flag = f"--{each.replace('_', '-')}"
        if own[each] is not None:
            known[each] = positive_real(flag, own[each])
        elif each not in known:
            raise ValueError(f"{flag} must be given with --section, or a --material: {', '.join(MATERIALS)}")
    if own["poisson_ratio"] is not None:
        known["poisson_ratio"] = own["poisson_ratio"]
    return Material(name, **known)


def _properties(section: Shape, stuff: Material, *, with_twist: bool) -> dict[str, float]:
    """Return the numbers of a beam of this section, by the names that `Rod` and `Beam` have for them."""
    if with_twist:
        if stuff.poisson_ratio is None:
            raise ValueError("--poisson-ratio must be given with --section where it twists")
        return Rod.of_section(
            section,
            density=stuff.density,
            elastic_modulus=stuff.elastic_modulus,
            poisson_ratio=stuff.poisson_ratio,
        )
    return {
        "bending_stiffness": stuff.elastic_modulus * section.second_moment,
        "axial_stiffness": stuff.elastic_modulus * section.area,
        "mass_per_length": stuff.density * section.area,
    }
