"""Commands that write and read model files: a chain for a simulator, and a verdict on the chain in a file."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from beammodes.checks import positive_real
from beammodes.command_line.commands import (
    Answer,
    beam_of,
    chain_of,
    damping_of,
    load_of,
    system_of,
    units_of,
)
from beammodes.command_line.text_tables import frequency_table, number, percents, text_table, typed_in

if TYPE_CHECKING:
    from beammodes.auditing.audit import Audit, Suggestion

__all__ = ["answer_audit", "answer_export"]

#: A longer list of springs shows those that change, and the first others.
_SHOWN_HINGES = 12


def answer_export(options: argparse.Namespace) -> Answer:
    """Write a chain to a file for a simulator, and answer which files were written."""
    from beammodes.exporters.export import export_chain
    from beammodes.problem.loading import Load

    beam_of(options)
    if options.length is options.ei is options.rho_a is None:
        raise ValueError("--length, --ei and --rho-a must be given: a model file has units")
    chain, load = chain_of(options), load_of(options)
    across = None
    if options.ei_across is not None:
        stiffness = positive_real("--ei-across", options.ei_across)
        across = chain_of(argparse.Namespace(**vars(options) | {"ei": stiffness}))
    written = export_chain(
        chain,
        options.output,
        format=options.format,
        name=options.name,
        fragment=options.fragment,
        second=across,
        damping=damping_of(options, chain),
        timestep=options.timestep,
        integrator=options.integrator,
        load=None if load == Load() and options.gravity is None else load,
        units=system_of(options),
        force=options.force,
    )
    names = [str(path) for path in written]
    return {"files": names}, "\n".join(names)


def answer_audit(options: argparse.Namespace) -> Answer:
    """Judge the chain in a model file; the answer says whether it meets the tolerance."""
    from beammodes.auditing.audit_model import audit_file

    found = audit_file(
        options.file,
        beam_of(options),
        options.boundary,
        modes=options.modes,
        tolerance=options.tolerance,
        chain=options.chain,
        plane=options.plane,
        springs=options.springs,
    )
    rows = _modes(found)
    said = {name: list(getattr(found, name)) for name in ("given", "assumed", "found")}
    answer = {"file": str(options.file), **said, **_facts(found), "modes": rows, **_lists(found)}
    return answer, "\n".join([*_verdict(found), frequency_table(rows), *_changes(found, units_of(options))])


def _facts(found: Audit) -> dict[str, Any]:
    names = (
        "meets",
        "tolerance",
        "layout",
        "segments",
        "order",
        "remark",
        "length_mismatch",
        "mass_mismatch",
        "rotary_inertia_mismatch",
        "centre_mismatch",
    )
    return {"boundary": found.boundary.name} | {name: getattr(found, name) for name in names}


def _lists(found: Audit) -> dict[str, Any]:
    return {
        "hinges": _hinges(found.hinge_names, found.joint_stiffness.tolist()),
        "suggestions": [_suggestion(found, item) for item in found.suggestions],
        "step": _step(found),
    }


def _step(found: Audit) -> dict[str, Any] | None:
    if found.step is None:
        return None
    return {
        "timestep_s": found.step.timestep,
        "longest_stable_s": found.step.limit,
        "integrator": found.step.integrator,
        "with_weight": found.step.with_weight,
        "stable": found.step.is_stable,
    }


def _modes(found: Audit) -> list[dict[str, Any]]:
    hertz = (found.angular_frequency / (2 * math.pi)).tolist()
    rows = []
    costs = (found.errors.tolist(), found.errors_without_armature.tolist(), found.damping_ratio.tolist())
    for n, (frequency, error, bare, ratio) in enumerate(zip(hertz, *costs, strict=True), start=1):
        exists = math.isfinite(error)
        rows.append(
            {
                "mode": n,
                "frequency_hz": frequency if exists else None,
                "exact_frequency_hz": frequency / (1 + error) if exists and error > -1 else None,
                "relative_error": error if exists else None,
                "relative_error_without_armature": bare if exists else None,
                "damping_ratio": ratio if exists else None,
                "swings": ratio < 1 if exists else None,
            }
        )
    return rows


def _hinges(names: tuple[str, ...], stiffness: list[float]) -> list[dict[str, Any]]:
    return [
        {"hinge": name, "stiffness_n_m_per_rad": value} for name, value in zip(names, stiffness, strict=True)
    ]


def _suggestion(found: Audit, item: Suggestion) -> dict[str, Any]:
    names = tuple(f"hinge {i + 1}" for i in range(len(item.joint_stiffness)))
    rows = _hinges(names if item.moves_hinges else found.hinge_names, item.joint_stiffness.tolist())
    return {
        "name": item.name,
        "moves_hinges": item.moves_hinges,
        "relative_errors": [error if math.isfinite(error) else None for error in item.errors.tolist()],
        "hinges": [
            row | {"position_m": x} for row, x in zip(rows, item.hinge_position.tolist(), strict=True)
        ],
    }


def _verdict(found: Audit) -> list[str]:
    verdict = "meets" if found.meets else "does not meet"
    modes = f"{len(found.errors)} mode{'s' * (len(found.errors) > 1)}"
    first = f"{verdict} {100 * found.tolerance:.4g} % in {modes}"
    lines = []
    for head in ("given", "assumed"):
        listed = getattr(found, head)
        lines += [head, *(f"  {line}" for line in listed)] if listed else []
    return [*lines, "found", f"  {first}", *(f"  {line}" for line in found.found[1:]), ""]


def _changes(found: Audit, units: Mapping[str, Any]) -> list[str]:
    """Return what may be changed, what each change buys, and the numbers for it."""
    if not found.suggestions:
        return []
    rows = [["as it is", "", *map(_error, found.errors.tolist())]]
    for item in found.suggestions:
        what = "hinges moved" if item.moves_hinges else "same hinges"
        rows.append([item.name, what, *map(_error, item.errors.tolist())])
    heads = ["springs", "hinges", *(f"error {n + 1} [%]" for n in range(len(found.errors)))]
    tables = ["", "what to change, and what it buys", text_table(heads, rows, names=2)]
    kept = [item for item in found.suggestions if not item.moves_hinges]
    if kept:
        tables += [
            "",
            f"stiffness for the same hinges [{units['joint_stiffness']}]",
            *_springs_table(found, kept, units),
        ]
    for item in found.suggestions:
        if item.moves_hinges:
            tables += ["", f"{item.name}, hinges moved", *_moved_table(item, units)]
    return tables


def _error(value: float) -> str:
    return percents(value) if math.isfinite(value) else "no such mode"


def _springs_table(found: Audit, kept: list[Suggestion], units: Mapping[str, Any]) -> list[str]:
    columns = [found.joint_stiffness.tolist(), *(item.joint_stiffness.tolist() for item in kept)]
    whole = [*zip(found.hinge_names, kept[0].hinge_position.tolist(), *columns, strict=True)]
    changed = [row for row in whole if any(abs(value - row[2]) > 1e-9 * row[2] for value in row[3:])]
    shown = whole if len(whole) <= _SHOWN_HINGES else changed[:_SHOWN_HINGES]
    rows = [[name, number(place), *map(typed_in, values)] for name, place, *values in shown]
    heads = ["hinge", f"position [{units['length']}]", "now", *(item.name for item in kept)]
    rest = len(whole) - len(shown)
    return [text_table(heads, rows, names=1)] + ([f"{rest} more hinges: see --json"] if rest else [])


def _moved_table(item: Suggestion, units: Mapping[str, Any]) -> list[str]:
    numbers = [*zip(item.hinge_position.tolist(), item.joint_stiffness.tolist(), strict=True)]
    rows = [
        [str(i), number(place), typed_in(stiffness)]
        for i, (place, stiffness) in enumerate(numbers[:_SHOWN_HINGES], start=1)
    ]
    rest = len(numbers) - len(rows)
    heads = ["hinge", f"position [{units['length']}]", f"stiffness [{units['joint_stiffness']}]"]
    table = text_table(heads, rows)
    return [table] + ([f"{rest} more hinges: see --json"] if rest else [])
