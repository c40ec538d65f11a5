"""Answers of commands in twist and stretch: the same questions, with `--motion twist` or `stretch`."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from beammodes.checks import percent
from beammodes.command_line.audit_answers import audited_along
from beammodes.command_line.options import Answer, damping_of
from beammodes.command_line.text_tables import (
    DECLARED,
    frequency_rows,
    frequency_table,
    hinge_table,
    number,
)
from beammodes.problem.axial_ends import AxialBoundary, axial_motion
from beammodes.problem.beam import Beam
from beammodes.problem.motions import Motion, unit_beam

__all__ = ["ANSWERS", "AxialCase"]

#: The options that give a beam's numbers in each motion, by the arguments of `Beam`.
_FLAGS: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "twist": {"torsional_stiffness": "--gj", "polar_inertia_per_length": "--rho-ip"},
        "stretch": {"axial_stiffness": "--ea", "mass_per_length": "--rho-a"},
    }
)
_OPTIONS = ("--ei", "--rho-a", "--gj", "--rho-ip", "--ea", "--ei-across", "--shape", "--points")


@dataclass(frozen=True)
class AxialCase:
    """What the options describe: motion, ends, and the beam with its units, None in multiples of its own."""

    options: argparse.Namespace
    motion: Motion
    boundary: AxialBoundary
    beam: Beam | None
    system: str
    units: Mapping[str, Any]

    @classmethod
    def of(cls, options: argparse.Namespace, system: str, units: Mapping[str, Any]) -> AxialCase:
        """Return the case; `units` are those of bending, of which the names of springs are replaced."""
        motion = axial_motion(options.motion)
        flags = {"--length": options.length}
        flags |= {flag: _value(options, flag) for flag in _FLAGS[motion.name].values()}
        for flag in _OPTIONS:
            if flag not in flags and _value(options, flag) is not None:
                raise ValueError(f"{flag} must be left out for motion {motion.name}")
        if getattr(options, "axial_force", None):
            raise ValueError(f"--axial-force must be left out for motion {motion.name}")
        missing = [flag for flag, value in flags.items() if value is None]
        if missing and len(missing) < len(flags):
            given = [flag for flag in flags if flag not in missing]
            raise ValueError(
                f"{' and '.join(missing)} must be given with {' and '.join(given)}, or none of them for an "
                "answer in multiples of the beam's own units"
            )
        beam = None
        if not missing:
            numbers: dict[str, Any] = {"bending_stiffness": 1.0, "mass_per_length": 1.0}
            numbers |= {name: _value(options, flag) for name, flag in _FLAGS[motion.name].items()}
            beam = Beam(options.length, **numbers)
        # An audit takes the file's ends where none are given.
        pair = AxialBoundary.of("fixed-free" if options.boundary is None else options.boundary, motion)
        return cls(options, motion, pair, beam, system, _renamed(motion, beam is None, units))

    @property
    def flags(self) -> tuple[str, ...]:
        """The options that give the beam's numbers."""
        return ("--length", *_FLAGS[self.motion.name].values())

    @property
    def whole_beam(self) -> Beam:
        """The beam, or the one of unit numbers."""
        return self.beam if self.beam is not None else unit_beam()

    @property
    def holds_for(self) -> str:
        """What is assumed."""
        left_out = "warping left free" if self.motion.name == "twist" else "lateral inertia left out"
        return f"for small {self.motion.name} of the straight beam, {left_out}"

    def notes(self) -> list[str]:
        """Return what is said of units."""
        if self.beam is None:
            flags = " and ".join(_FLAGS[self.motion.name].values())
            return [f"in multiples of the beam's own, since --length, {flags} are not given"]
        if self.options.units is None:
            return [f"in the units of your input; --units {', '.join(DECLARED)} names them"]
        return []

    def said(self, *names: str, **others: str) -> dict[str, Any]:
        """Return the units for scripts."""
        told = {name: self.units[name] for name in names} | others
        return {"units": {"system": self.system} | told, "holds_for": self.holds_for}


def _value(options: argparse.Namespace, flag: str) -> Any:
    return getattr(options, flag[2:].replace("-", "_"), None)


def _renamed(motion: Motion, own: bool, units: Mapping[str, Any]) -> Mapping[str, Any]:
    stiffness, inertia = motion.stiffness_symbol, motion.inertia_symbol.replace("rho ", "ρ")
    if own:
        unit = f"√({stiffness}/({inertia} L²))"
        return {
            "frequency": f"{unit}/(2π)",
            "angular_frequency": unit,
            "time": f"√({inertia} L²/{stiffness})",
            "length": "L",
            "joint_stiffness": f"{stiffness}/L",
        }
    spring = "joint_stiffness" if motion.name == "twist" else "translational_stiffness"
    return {**units, "joint_stiffness": units[spring]}


def _chain(case: AxialCase) -> Any:
    from beammodes.chains.axial_chain import AxialChain

    return AxialChain(
        case.whole_beam,
        case.boundary,
        case.options.segments,
        case.options.rule,
        motion=case.motion,
    )


def _recommend(case: AxialCase) -> Answer:
    from beammodes.command_line.advice_table import advised

    _, answer, lines, units = advised(case.options, case.units, case.boundary, case.beam, motion=case.motion)
    said = {"motion": case.motion.name} | answer | case.said(**units)
    return said, "\n".join([*lines, case.holds_for, *case.notes()])


def _segments(case: AxialCase) -> Answer:
    from beammodes.accuracy.segments import segments_needed

    options = case.options
    count = segments_needed(
        case.boundary, options.tolerance, options.modes, options.rule, beam=case.beam, motion=case.motion
    )
    which = "the first mode" if options.modes == 1 else f"the first {options.modes} modes"
    text = f"{count}\nrule {options.rule}, {which}, {case.holds_for}"
    return {"segments": count, "motion": case.motion.name, "holds_for": case.holds_for}, text


def _error(case: AxialCase) -> Answer:
    from beammodes.accuracy.errors import frequency_error

    options = case.options
    asked = {name: getattr(options, name) for name in ("segments", "mode", "rule")}
    error = frequency_error(case.boundary, **asked, beam=case.beam, motion=case.motion.name)
    if math.isnan(error):
        raise ValueError(
            f"mode {options.mode} does not exist: {options.boundary} with {options.segments} segments "
            f"and rule {options.rule} has fewer elastic modes"
        )
    answer = {"boundary": case.boundary.name, **asked, "motion": case.motion.name, "relative_error": error}
    said = {"units": {"relative_error": "1"}, "holds_for": case.holds_for}
    return answer | said, f"{percent(error, 6)}\nrule {options.rule}, {case.holds_for}"


def _springs(case: AxialCase) -> Answer:
    chain, units = _chain(case), case.units
    pairs = [*zip(chain.hinge_position.tolist(), chain.joint_stiffness.tolist(), strict=True)]
    answer: dict[str, Any] = {
        "motion": case.motion.name,
        "hinges": [{"hinge": j, "position": x, "stiffness": k} for j, (x, k) in enumerate(pairs, start=1)],
    }
    said = case.said(position=units["length"], stiffness=units["joint_stiffness"])
    lines = [hinge_table(pairs, units), *case.notes(), f"rule {case.options.rule}, {case.holds_for}"]
    return answer | said, "\n".join(lines)


def _frequencies(case: AxialCase) -> Answer:
    from beammodes.exact.axial_theory import axial_modes
    from beammodes.vibration.modes import solve_modes

    chain = _chain(case)
    found = solve_modes(chain, case.options.modes)
    count = len(found.frequency)
    exact = axial_modes(case.whole_beam, case.boundary, max(count, 1), motion=case.motion).frequency[:count]
    rows = frequency_rows(found.frequency, exact, found.frequency / exact - 1)
    kinds = f"{found.rigid_body_modes} rigid-body and {chain.elastic_modes} elastic modes"
    title = (
        f"{case.boundary.name} in {case.motion.name}, {chain.segments} segments, {case.options.rule}: {kinds}"
    )
    key = "angular_frequency" if case.beam is None else "frequency"
    answer = {"motion": case.motion.name, "rigid_body_modes": found.rigid_body_modes, "modes": rows}
    said = case.said("frequency", "angular_frequency", relative_error="1")
    return answer | said, "\n".join([title, frequency_table(rows, key, case.units[key]), *case.notes()])


def _time_step(case: AxialCase) -> Answer:
    from beammodes.vibration.axial_spectrum import highest_axial_frequency
    from beammodes.vibration.stability import stable_time_step

    chain, units, options = _chain(case), case.units, case.options
    for flag in ("gravity", "tip_force"):
        if getattr(options, flag):
            raise ValueError(f"--{flag.replace('_', '-')} must be left out for motion {case.motion.name}")
    damping, integrator = damping_of(options, chain), options.integrator
    step, highest = stable_time_step(chain, integrator, damping=damping), highest_axial_frequency(chain)
    if math.isinf(step):
        raise ValueError(
            f"integrator and segments must have a stability limit, got {integrator} and {chain.segments}"
        )
    answer = {"motion": case.motion.name, "time_step": step, "highest_angular_frequency": highest}
    said = case.said(time_step=units["time"], highest_angular_frequency=units["angular_frequency"])
    fastest = f"highest angular frequency {number(highest)} {units['angular_frequency']}"
    if damping is not None:
        free = stable_time_step(chain, integrator)
        fastest += f", with dampers; without them {number(free)} {units['time']}"
    text = f"{number(step)} {units['time']}  ({integrator}, {fastest}, {case.holds_for})"
    return answer | said, "\n".join([text, *case.notes()])


#: By the name of the command.
ANSWERS: Mapping[str, Callable[[AxialCase], Answer]] = MappingProxyType(
    {
        "audit": audited_along,
        "recommend": _recommend,
        "segments": _segments,
        "error": _error,
        "springs": _springs,
        "frequencies": _frequencies,
        "time-step": _time_step,
    }
)
