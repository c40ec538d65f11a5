"""Answers of the command audit in twist, stretch and space."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from beammodes.command_line.options import Answer
from beammodes.command_line.text_tables import frequency_table

if TYPE_CHECKING:
    import argparse

    from beammodes.auditing.audit import Audit, StepVerdict, Suggestion
    from beammodes.auditing.axial_audit import AxialAudit
    from beammodes.auditing.space_audit import SpatialAudit
    from beammodes.command_line.axial_answers import AxialCase
    from beammodes.command_line.rod_options import RodCase
    from beammodes.numerics.arrays import Floats

__all__ = ["audited_along", "audited_in_space"]

_OF_ALL = ("given", "assumed", "found")
_OF_ONE = ("meets", "layout", "segments", "order", "remark", "length_mismatch")
_BENDING, _ALONG = ("mass_mismatch", "rotary_inertia_mismatch", "centre_mismatch"), ("inertia_mismatch",)


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


def _asked(options: argparse.Namespace) -> dict[str, Any]:
    for flag in ("write", "suggestion", "force"):
        if getattr(options, flag):
            raise ValueError(f"--{flag} must be left out for motion {options.motion}: bending is written")
    return {name: getattr(options, name) for name in ("modes", "tolerance", "chain", "springs")}


def _of_file(options: argparse.Namespace, found: AxialAudit | SpatialAudit) -> dict[str, Any]:
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
