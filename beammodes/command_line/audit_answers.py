"""Answers of the command audit: in bending, with the written file, and in twist, stretch and space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from beammodes.command_line.options import Answer
from beammodes.command_line.text_tables import (
    SHOWN_HINGES,
    frequency_table,
    hinge_table,
    more_hinges,
    number,
    percents,
    text_table,
    typed_in,
)

if TYPE_CHECKING:
    import argparse

    from beammodes.auditing.audit import Audit, StepVerdict, Suggestion
    from beammodes.auditing.axial_audit import AxialAudit
    from beammodes.auditing.mended_files import MendedFile
    from beammodes.auditing.space_audit import SpatialAudit
    from beammodes.command_line.axial_answers import AxialCase
    from beammodes.command_line.rod_options import RodCase
    from beammodes.numerics.arrays import Floats
    from beammodes.problem.beam import Beam

__all__ = ["audited_along", "audited_in_bending", "audited_in_space"]

_OF_ALL = ("given", "assumed", "found")
_OF_ONE = ("meets", "layout", "segments", "order", "remark", "length_mismatch")
_BENDING, _ALONG = ("mass_mismatch", "rotary_inertia_mismatch", "centre_mismatch"), ("inertia_mismatch",)


def audited_in_bending(
    options: argparse.Namespace, beam: Beam, system: str, units: Mapping[str, Any]
) -> Answer:
    """Return the audit of a file in one plane; write the file with better springs if that is asked for."""
    from beammodes.auditing.audit_model import audit_file
    from beammodes.auditing.mended_files import mend_file

    asked = {name: getattr(options, name) for name in ("modes", "tolerance", "chain", "plane", "springs")}
    mended = None
    if options.write is not None:
        how = {"suggestion": options.suggestion, "force": options.force}
        mended = mend_file(options.file, options.write, beam, options.boundary, **how, **asked)
    elif options.suggestion is not None or options.force:
        flag = "--force" if options.suggestion is None else "--suggestion"
        raise ValueError(f"{flag} must be left out without --write")
    found = mended.before if mended else audit_file(options.file, beam, options.boundary, **asked)
    rows = _audited_modes(found)
    answer = _of_file(options, found)
    answer |= {"boundary": found.boundary.name, "tolerance": found.tolerance}
    answer |= {name: getattr(found, name) for name in _OF_ONE + _BENDING}
    answer |= {
        "modes": rows,
        "hinges": _stiffness_rows(found.hinge_names, found.joint_stiffness.tolist()),
        "suggestions": [_suggestion_in_bending(found, item) for item in found.suggestions],
        "step": _step(found.step),
        # The names of springs and places say SI's; with --units they are in that system.
        "units": {
            "system": system,
            "stiffness_n_m_per_rad": units["joint_stiffness"],
            "position_m": units["length"],
        },
    }
    if found.step is not None:
        answer["step"] |= {"with_weight": found.step.with_weight}
    lines = [*_verdict(found), frequency_table(rows), *_changes(found, units)]
    if mended is not None:
        answer["written"] = _written(mended)
        lines += ["", "written", *(f"  {line}" for line in mended.text.splitlines())]
    return answer, "\n".join(lines)


def audited_along(case: AxialCase) -> Answer:
    """Return the audit of a file in twist or stretch."""
    from beammodes.auditing.audit_model import audit_file

    options = case.options
    asked = _asked(options)
    if case.beam is None:
        raise ValueError(
            f"{' and '.join(case.flags)} must be given for an audit in {case.motion.name}: a file has units"
        )
    if options.plane is not None:
        raise ValueError(f"--plane must be left out for motion {options.motion}")
    ends = None if options.boundary is None else case.boundary
    if case.motion.name == "twist":
        found = audit_file(options.file, case.beam, ends, motion="twist", **asked)
    else:
        found = audit_file(options.file, case.beam, ends, motion="stretch", **asked)
    rows = _modes(found.angular_frequency, found.errors, found.damping_ratio)
    answer = _of_file(options, found) | {"motion": case.motion.name, "tolerance": found.tolerance}
    answer |= _one(found) | {"modes": rows, "step": _step(found.step)}
    return answer, "\n".join([found.text, "", frequency_table(rows)])


def audited_in_space(case: RodCase) -> Answer:
    """Return the audit of a file in all its motions."""
    from beammodes.auditing.audit_model import audit_file

    options = case.options
    ends = None if options.boundary is None else case.ends
    found = audit_file(options.file, case.rod, ends, motion="space", plane=options.plane, **_asked(options))
    rows = [
        row | {"motion": motion}
        for row, motion in zip(
            _modes(found.angular_frequency, found.errors, None), found.mode_motion, strict=True
        )
    ]
    answer = _of_file(options, found) | {
        "motion": "space",
        "tolerance": found.tolerance,
        "meets": found.meets,
    }
    answer |= {"layout": found.layout, "joints": found.joints, "planes": dict(found.planes), "modes": rows}
    answer |= {"motions": {name: _one(one) for name, one in found.motions.items()}}
    answer |= {"step": _step(found.step), "step_set_by": found.step_set_by}
    table = frequency_table(rows).splitlines()
    named = [f"{line}  {word}" for line, word in zip(table, ["motion", *found.mode_motion], strict=True)]
    return answer, "\n".join([found.text, "", *named, *case.assumed()])


def _written(mended: MendedFile) -> dict[str, Any]:
    return {
        "file": str(mended.path),
        "suggestion": mended.suggestion.name,
        "meets": mended.audit.meets,
        "promise": mended.promise,
        "not_mended": mended.not_mended,
        "notes": list(mended.notes),
        "modes": _audited_modes(mended.audit),
        "numbers": [
            {"hinge": name, "old": old, "new": new}
            for name, old, new in zip(
                mended.hinge_names, mended.old_number.tolist(), mended.new_number.tolist(), strict=True
            )
        ],
    }


def _audited_modes(found: Audit) -> list[dict[str, Any]]:
    hertz = (found.angular_frequency / (2 * math.pi)).tolist()
    costs = (found.errors.tolist(), found.errors_without_armature.tolist(), found.damping_ratio.tolist())
    rows = []
    for n, (frequency, error, bare, ratio) in enumerate(zip(hertz, *costs, strict=True), start=1):
        row = {
            "frequency_hz": frequency,
            "exact_frequency_hz": frequency / (1 + error) if error > -1 else None,
            "relative_error": error,
            "relative_error_without_armature": bare,
            "damping_ratio": ratio,
            "swings": ratio < 1,
        }
        exists = math.isfinite(error)
        rows.append({"mode": n} | {name: value if exists else None for name, value in row.items()})
    return rows


def _stiffness_rows(names: tuple[str, ...], stiffness: list[float]) -> list[dict[str, Any]]:
    return [
        {"hinge": name, "stiffness_n_m_per_rad": value} for name, value in zip(names, stiffness, strict=True)
    ]


def _suggestion_in_bending(found: Audit, item: Suggestion) -> dict[str, Any]:
    names = tuple(f"hinge {i + 1}" for i in range(len(item.joint_stiffness)))
    rows = _stiffness_rows(names if item.moves_hinges else found.hinge_names, item.joint_stiffness.tolist())
    return {
        "name": item.name,
        "moves_hinges": item.moves_hinges,
        "relative_errors": item.errors.tolist(),
        "hinges": [
            row | {"position_m": x} for row, x in zip(rows, item.hinge_position.tolist(), strict=True)
        ],
    }


def _verdict(found: Audit) -> list[str]:
    verdict = "meets" if found.meets else "does not meet"
    count = f"{len(found.errors)} mode{'s' * (len(found.errors) > 1)}"
    lines = []
    for head in ("given", "assumed"):
        listed = getattr(found, head)
        lines += [head, *(f"  {line}" for line in listed)] if listed else []
    lines += ["found", f"  {verdict} {100 * found.tolerance:.4g} % in {count}"]
    return [*lines, *(f"  {line}" for line in found.found[1:]), ""]


def _changes(found: Audit, units: Mapping[str, Any]) -> list[str]:
    """Return the changes that are suggested, the errors they leave, and their numbers."""
    if not found.suggestions:
        return []

    def errors(of: Audit | Suggestion) -> list[str]:
        return [percents(each) if math.isfinite(each) else "no such mode" for each in of.errors.tolist()]

    rows = [["as it is", "", *errors(found)]]
    for item in found.suggestions:
        rows.append([item.name, "hinges moved" if item.moves_hinges else "same hinges", *errors(item)])
    heads = ["springs", "hinges", *(f"error {n + 1} [%]" for n in range(len(found.errors)))]
    lines = ["", "what to change, and what it buys", text_table(heads, rows, names=2)]
    kept = [item for item in found.suggestions if not item.moves_hinges]
    if kept:
        lines += ["", f"stiffness for the same hinges [{units['joint_stiffness']}]"]
        lines += _kept_hinges(found, kept, units)
    for item in found.suggestions:
        if item.moves_hinges:
            pairs = [*zip(item.hinge_position.tolist(), item.joint_stiffness.tolist(), strict=True)]
            lines += ["", f"{item.name}, hinges moved", hinge_table(pairs[:SHOWN_HINGES], units)]
            lines += more_hinges(len(pairs) - SHOWN_HINGES)
    return lines


def _kept_hinges(found: Audit, kept: list[Suggestion], units: Mapping[str, Any]) -> list[str]:
    columns = [found.joint_stiffness.tolist(), *(item.joint_stiffness.tolist() for item in kept)]
    whole = [*zip(found.hinge_names, kept[0].hinge_position.tolist(), *columns, strict=True)]
    changed = [row for row in whole if any(abs(value - row[2]) > 1e-9 * row[2] for value in row[3:])]
    listed = whole if len(whole) <= SHOWN_HINGES else changed[:SHOWN_HINGES]
    rows = [[name, number(place), *map(typed_in, values)] for name, place, *values in listed]
    heads = ["hinge", f"position [{units['length']}]", "now", *(item.name for item in kept)]
    return [text_table(heads, rows, names=1), *more_hinges(len(whole) - len(listed))]


def _asked(options: argparse.Namespace) -> dict[str, Any]:
    for flag in ("write", "suggestion", "force"):
        if getattr(options, flag):
            raise ValueError(f"--{flag} must be left out for motion {options.motion}: bending is written")
    return {name: getattr(options, name) for name in ("modes", "tolerance", "chain", "springs")}


def _of_file(options: argparse.Namespace, found: Audit | AxialAudit | SpatialAudit) -> dict[str, Any]:
    return {"file": str(options.file)} | {name: list(getattr(found, name)) for name in _OF_ALL}


def _modes(omega: Floats, errors: Floats, ratio: Floats | None) -> list[dict[str, Any]]:
    """Return rows of modes, None where there is no such mode."""
    rows = []
    for n, (turns, error) in enumerate(zip(omega.tolist(), errors.tolist(), strict=True), start=1):
        hertz = turns / (2 * math.pi)
        row = {"frequency_hz": hertz, "exact_frequency_hz": hertz / (1 + error), "relative_error": error}
        if ratio is not None:
            row["damping_ratio"] = float(ratio[n - 1])
        exists = math.isfinite(error)
        rows.append({"mode": n} | {name: value if exists else None for name, value in row.items()})
    return rows


def _one(found: Audit | AxialAudit) -> dict[str, Any]:
    """Return what is found of one motion."""
    names = _OF_ONE + (_ALONG if hasattr(found, "inertia_mismatch") else _BENDING)
    hinges = zip(found.hinge_names, found.joint_stiffness.tolist(), strict=True)
    return (
        {"boundary": found.boundary.name}
        | {name: getattr(found, name) for name in names}
        | {
            "hinges": [{"hinge": name, "stiffness": value} for name, value in hinges],
            "suggestions": [_suggestion(item, found.hinge_names) for item in found.suggestions],
        }
    )


def _suggestion(item: Suggestion, names: tuple[str, ...]) -> dict[str, Any]:
    if item.moves_hinges:
        names = tuple(f"hinge {j + 1}" for j in range(len(item.joint_stiffness)))
    numbers = zip(names, item.hinge_position.tolist(), item.joint_stiffness.tolist(), strict=True)
    return {
        "name": item.name,
        "moves_hinges": item.moves_hinges,
        "relative_errors": [error if math.isfinite(error) else None for error in item.errors.tolist()],
        "hinges": [{"hinge": name, "position_m": x, "stiffness": k} for name, x, k in numbers],
    }


def _step(step: StepVerdict | None) -> dict[str, Any] | None:
    if step is None:
        return None
    limit = step.limit if math.isfinite(step.limit) else None
    return {
        "timestep_s": step.timestep,
        "longest_stable_s": limit,
        "integrator": step.integrator,
        "stable": step.is_stable,
    }
