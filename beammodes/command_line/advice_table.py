"""Recommendations as the command line shows them, of beams in each motion and of rods in space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from beammodes.command_line.options import DEFAULT_RULE
from beammodes.command_line.text_tables import number, percents, text_table

if TYPE_CHECKING:
    import argparse

    from beammodes.accuracy.advice import Recommendation

__all__ = ["advised"]

_NUMBERS = (
    "rule",
    "segments",
    "largest_error",
    "mode",
    "static_error",
    "highest_angular_frequency",
    "stable_time_step",
    "cost",
    "segments_set_by",
    "step_set_by",
)


def advised(
    options: argparse.Namespace, units: Mapping[str, Any], boundary: Any, beam: Any, **how: Any
) -> tuple[Sequence[Recommendation], dict[str, Any], list[str], dict[str, Any]]:
    """Return what `recommend` answers to options: for scripts, as lines, and the units of its numbers.

    `how` goes to `recommend`.
    """
    from beammodes.accuracy.advice import recommend

    ways = recommend(
        boundary,
        options.tolerance,
        options.modes,
        beam=beam,
        rules=options.rule.split(",") if options.rule else None,
        integrator=options.integrator,
        **how,
    )
    said = {
        "joint_stiffness": units["joint_stiffness"],
        "highest_angular_frequency": units["angular_frequency"],
        "stable_time_step": units["time"],
    }
    lines = _advice_lines(ways, options.integrator, units["time"])
    return ways, {"recommendations": _advice_rows(ways)}, lines, said


def _advice_rows(ways: Sequence[Recommendation]) -> list[dict[str, Any]]:
    """Return recommendations for scripts."""
    rows = []
    for way in ways:
        row: dict[str, Any] = {name: getattr(way, name) for name in _NUMBERS}
        rows.append(row | {"joint_stiffness": way.joint_stiffness.tolist(), "remarks": list(way.remarks)})
    return rows


def _advice_lines(ways: Sequence[Recommendation], integrator: str, time: str) -> list[str]:
    """Return the table of recommendations and what its columns are; `time` is the unit of steps."""
    rods = ways[0].joint_stiffness.ndim > 1
    static = any(way.static_error for way in ways)
    heads = ["rule", "N", "error [%]", f"step [{time}]", "cost [-]"]
    cells = [_cells(way) for way in ways]
    notes = ["error: largest of the modes asked for, without its sign"]
    if static:
        heads.insert(3, "static error [%]")
        for row, way in zip(cells, ways, strict=True):
            row.insert(3, percents(max(way.static_error.values(), key=abs, default=math.nan)))
        notes.append(
            "static: worst of tip force, tip moment and uniform load; nan where the beam can move rigidly"
        )
    usual = [way.segments for way in ways if way.rule == DEFAULT_RULE]
    if usual and ways[0].rule != DEFAULT_RULE:
        notes.append(
            f"{DEFAULT_RULE}, the default of other commands, is that of Mitiguy's report: N = {usual[0]} here"
        )
    notes.append(f"cost: segments times {integrator} steps in one period of the first mode")
    if rods:
        heads += ["N set by", "step set by"]
        for row, way in zip(cells, ways, strict=True):
            row += [way.segments_set_by, way.step_set_by]
        notes.append("bending: in the plane of the section's x and y; second_bending: of x and z")
    return [text_table(heads, cells, names=1), *notes]


def _cells(way: Recommendation) -> list[str]:
    return [
        way.rule,
        str(way.segments),
        percents(way.largest_error).lstrip("+"),
        number(way.stable_time_step),
        f"{way.cost:.3g}",
    ]
