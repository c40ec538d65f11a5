"""Answers of commands of rods in space: the same questions, with `--motion space`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from beammodes.checks import percent
from beammodes.command_line.audit_answers import audited_in_space
from beammodes.command_line.options import Answer, damping_of, exported
from beammodes.command_line.rod_options import RodCase
from beammodes.command_line.text_tables import (
    frequency_rows,
    frequency_table,
    number,
    text_table,
    typed_in,
)

if TYPE_CHECKING:
    from beammodes.problem.load_in_space import SpatialLoad

__all__ = ["ANSWERS_IN_SPACE"]

_TURNS = ("twist", "about_y", "about_z")
_PLANES = "bending: in the plane of the section's x and y; second_bending: of x and z"
#: Of a share: rounding.
_NOTHING = 1e-9


def _recommend(case: RodCase) -> Answer:
    from beammodes.command_line.advice_table import advised

    _, answer, lines, units = advised(case.options, case.units, case.ends, case.rod)
    said = {"motion": "space"} | answer | case.said(**units)
    return said, "\n".join([*lines, case.holds_for, *case.notes()])


def _segments(case: RodCase) -> Answer:
    from beammodes.accuracy.segments import segments_needed

    options = case.options
    count = segments_needed(case.ends, options.tolerance, options.modes, options.rule, beam=case.rod)
    asked = options.modes
    which = "the first mode" if asked == 1 else f"the first {asked} modes"
    if isinstance(asked, dict):
        which = "modes " + ", ".join(f"{name} {number}" for name, number in asked.items())
    text = f"{count}\nrule {options.rule}, {which}, {case.holds_for}"
    answer = {"segments": count, "motion": "space", "holds_for": case.holds_for}
    return answer, "\n".join([text, *case.assumed()])


def _error(case: RodCase) -> Answer:
    from beammodes.accuracy.chain_against_rod import rod_errors

    options = case.options
    error = float(rod_errors(case.chain, options.mode)[-1])
    if math.isnan(error):
        raise ValueError(
            f"mode {options.mode} does not exist: {options.boundary} with {options.segments} segments "
            f"and rule {options.rule} has fewer elastic modes"
        )
    asked = {name: getattr(options, name) for name in ("segments", "mode", "rule")}
    answer = {"boundary": options.boundary, **asked, "motion": "space", "relative_error": error}
    said = {"units": {"relative_error": "1"}, "holds_for": case.holds_for}
    lines = [f"{percent(error, 6)}", f"rule {options.rule}, {case.holds_for}", *case.assumed()]
    return answer | said, "\n".join(lines)


def _springs(case: RodCase) -> Answer:
    chain, units = case.chain, case.units
    rows = []
    places = case.rod.frames(chain.hinge_position)[1]
    for j, (s, stiffness, place) in enumerate(
        zip(chain.hinge_position.tolist(), chain.joint_stiffness.tolist(), places.tolist(), strict=True), 1
    ):
        rows.append(
            {"hinge": j, "position": s, "place": place, **dict(zip(_TURNS, stiffness, strict=True))},
        )
    unit = units["joint_stiffness"]
    heads = ["hinge", f"position [{units['length']}]", f"twist [{unit}]"]
    heads += [f"about y [{unit}]", f"about z [{unit}]"]
    cells = [
        [str(row["hinge"]), number(row["position"])]
        + ["rigid" if row[turn] == math.inf else typed_in(row[turn]) for turn in _TURNS]
        for row in rows
    ]
    said = case.said(position=units["length"], place=units["length"], stiffness=unit)
    axes = "position along the centre line; x along it, y and z across, the section's axes at the hinge"
    lines = [text_table(heads, cells), axes, f"rule {case.options.rule}", *case.notes()]
    return {"motion": "space", "hinges": rows} | said, "\n".join(lines)


def _frequencies(case: RodCase) -> Answer:
    from beammodes.accuracy.judged_motions import ROD_MOTIONS
    from beammodes.exact.exact_rod import rod_modes
    from beammodes.vibration.modes_in_space import spatial_modes

    chain, options = case.chain, case.options
    found = spatial_modes(chain, options.modes)
    count = len(found.frequency)
    exact = rod_modes(case.rod, case.ends, max(count, 1)).frequency[:count]
    rows = frequency_rows(found.frequency, exact, found.frequency / exact - 1)
    stored = [dict(zip(ROD_MOTIONS, row, strict=True)) for row in found.stored.tolist()]
    rows = [row | {"stored_in": shares} for row, shares in zip(rows, stored, strict=True)]
    title = (
        f"{options.boundary} in space, {chain.segments} segments, {options.rule}: "
        f"{found.rigid_body_modes} rigid-body modes"
    )
    table = frequency_table(rows, "frequency", case.units["frequency"]).splitlines()
    # What a mode mostly is: n-th of all in an order in which bending and twist are mixed.
    mostly = ["mostly", *(max(shares, key=lambda name: shares[name]) for shares in stored)]
    table = [f"{line}  {word}" for line, word in zip(table, mostly, strict=True)]
    answer = {"motion": "space", "rigid_body_modes": found.rigid_body_modes, "modes": rows}
    said = case.said("frequency", "angular_frequency", relative_error="1", stored_in="1")
    return answer | said, "\n".join([title, *table, _PLANES, case.holds_for, *case.notes()])


def _time_step(case: RodCase) -> Answer:
    from beammodes.accuracy.judged_motions import ROD_MOTIONS
    from beammodes.vibration.highest_in_space import highest_in_space
    from beammodes.vibration.stability import GRAVITY, stable_time_step

    options, chain, units = case.options, case.chain, case.units
    load, damping = _load(case), damping_of(options, chain)
    step = stable_time_step(chain, options.integrator, load=load, damping=damping)
    if math.isinf(step):
        raise ValueError(
            f"integrator and segments must have a stability limit, got {options.integrator} and "
            f"{chain.segments}"
        )
    highest = highest_in_space(chain, load)
    shares = dict(zip(ROD_MOTIONS, highest.shares.tolist(), strict=True))
    answer = {
        "motion": "space",
        "time_step": step,
        "highest_angular_frequency": highest.angular_frequency,
        "step_set_by": max(shares, key=lambda name: shares[name]),
        "stored_in": shares,
    }
    time, omega = units["time"], units["angular_frequency"]
    said = case.said(
        time_step=time, highest_angular_frequency=omega, stored_in="1", time_step_under_gravity=time
    )
    fastest = f"highest angular frequency {number(highest.angular_frequency)} {omega}"
    held = "without load" if load is None else f"under {_told(load)}, as if the chain hung by it"
    if damping is not None:
        free = stable_time_step(chain, options.integrator, load=load)
        held += f", with dampers; without them {number(free)} {time}"
    lines = [f"{number(step)} {time}  ({options.integrator}, {fastest}, {held})", _stored(shares)]
    if load is None:
        from beammodes.problem.load_in_space import SpatialLoad

        gravity = GRAVITY / units["metres"]
        hangs = SpatialLoad(gravity=(gravity, 0.0, 0.0))
        hung = stable_time_step(chain, options.integrator, load=hangs, damping=damping)
        answer["time_step_under_gravity"] = hung
        if hung < 0.99 * step:
            weight = f"gravity {gravity:.4g} {units['acceleration']}"
            lines.append(f"{number(hung)} {time}  with {weight} in any direction, hanging too: --gravity")
    return answer | said, "\n".join([*lines, *case.notes()])


def _stored(shares: Mapping[str, float]) -> str:
    """Return in words which motion the highest mode is, and so which sets the step."""
    told = [f"{name} {100 * share:.3g} %" for name, share in shares.items() if share > _NOTHING]
    first = max(shares, key=lambda name: shares[name])
    return f"set by {first}: the springs of the highest mode store {', '.join(told)} ({_PLANES})"


def _told(load: SpatialLoad) -> str:
    """Return in words the loads that there are."""
    given = {"a tip force": load.force, "gravity": load.gravity}
    return " and ".join(
        f"{name} ({', '.join(map(number, three))})" for name, three in given.items() if any(three)
    )


def _load(case: RodCase) -> Any:
    """Return the load, or None."""
    from beammodes.problem.load_in_space import SpatialLoad

    given = {"force": case.options.tip_force, "gravity": case.options.gravity}
    told = {name: value for name, value in given.items() if value is not None}
    return SpatialLoad(**told) if told else None


def _buckling(case: RodCase) -> Answer:
    from beammodes.equations.equilibria_in_space import critical_factor
    from beammodes.problem.load_in_space import SpatialLoad

    options, rod, force = case.options, case.rod, case.units["force"]
    if options.tip_force is None:
        raise ValueError("--tip-force must be given for motion space: x,y,z in the axes at s = 0")
    load = SpatialLoad(force=options.tip_force)
    size = math.hypot(*load.force)
    if not size:
        raise ValueError(f"--tip-force must not vanish, got {options.tip_force}")
    # Where the search begins: what a narrow beam under a force across its tip buckles at is 4 of these.
    weakest = min(rod.planar(axis).mean_bending_stiffness for axis in (1, 2))
    unit = math.sqrt(weakest * rod.planar(0).mean_bending_stiffness) / rod.length**2
    joints = options.joints or "ball"
    factor = unit / size * critical_factor(case.chain, load.times(unit / size), joints=joints)
    critical = [factor * part for part in load.force]
    answer = {"motion": "space", "critical_factor": factor, "critical_force": critical}
    answer |= {"joints": joints}
    holds = "for a dead force at s = L; the chain's own load, no exact one beside it"
    told = ", ".join(map(number, critical))
    text = f"{number(factor)} times the force, ({told}) {force}  (joints {joints})"
    said = case.said(critical_force=force) | {"holds_for": holds}
    return answer | said, "\n".join([text, holds, *case.notes()])


def _export(case: RodCase) -> Answer:
    joints = case.options.joints or "yzx_alternating"
    names = exported(case.options, case.chain, _load(case), case.system, joints=joints)
    answer = {"files": names, "motion": "space", "joints": joints}
    return answer, "\n".join([*names, *case.notes()])


#: By the name of the command.
ANSWERS_IN_SPACE: Mapping[str, Callable[[RodCase], Answer]] = MappingProxyType(
    {
        "audit": audited_in_space,
        "recommend": _recommend,
        "segments": _segments,
        "error": _error,
        "springs": _springs,
        "frequencies": _frequencies,
        "time-step": _time_step,
        "buckling": _buckling,
        "export": _export,
    }
)
