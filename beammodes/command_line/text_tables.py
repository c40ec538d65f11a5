"""Numbers as the command line shows them: tables with units in their heads, errors with their signs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from beammodes.checks import choice, percent
from beammodes.exporters.unit_systems import UNIT_SYSTEMS
from beammodes.numerics.arrays import Floats

__all__ = [
    "DECLARED",
    "GIVEN",
    "OWN",
    "SHOWN_HINGES",
    "UNITS",
    "declared",
    "frequency_rows",
    "frequency_table",
    "hinge_table",
    "more_hinges",
    "number",
    "percents",
    "ratio_said",
    "text_table",
    "typed_in",
]

#: A longer list of springs shows those that change, and the first others.
SHOWN_HINGES = 12

#: Units in each system that the user may declare, for heads of tables and JSON; numbers stay as they are.
DECLARED: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        name: {
            "frequency": "Hz",
            "angular_frequency": "rad/s",
            "time": "s",
            "length": system.length,
            "force": system.force,
            "joint_stiffness": system.joint_stiffness,
            "translational_stiffness": f"{system.force}/{system.length}",
            "acceleration": f"{system.length}/s²",
            "metres": system.metres,
        }
        for name, system in UNIT_SYSTEMS.items()
    }
)

#: Any consistent units, as long as the user has not said which.
GIVEN: Mapping[str, Any] = MappingProxyType(
    {
        "frequency": "1/time",
        "angular_frequency": "rad/time",
        "time": "time",
        "length": "length",
        "force": "force",
        "joint_stiffness": "force length/rad",
        "translational_stiffness": "force/length",
        "acceleration": "m/s², if your units are SI,",
        "metres": 1.0,
    }
)

#: Multiples of the beam's own, where it has no length, stiffness and mass: here gravity means nothing.
OWN: Mapping[str, Any] = MappingProxyType(
    {
        "frequency": "√(EI/(ρA L⁴))/(2π)",
        "angular_frequency": "√(EI/(ρA L⁴))",
        "time": "√(ρA L⁴/EI)",
        "length": "L",
        "force": "EI/L²",
        "joint_stiffness": "EI/L",
        "translational_stiffness": "EI/L³",
    }
)
UNITS = MappingProxyType({**DECLARED, "as given": GIVEN, "multiples of the beam's own": OWN})


def declared(word: str) -> str:
    """Return the name of the system of units that the user declares, in any case of letters.

    Examples
    --------
    >>> declared("si")
    'SI'
    """
    words = {name.lower(): name for name in DECLARED}
    return words.get(word.lower()) or choice("--units", word, DECLARED)


def text_table(heads: Sequence[str], rows: Sequence[Sequence[str]], *, names: int = 0) -> str:
    """Return rows under their heads, numbers to the right, the first `names` columns to the left.

    Examples
    --------
    >>> print(text_table(["rule", "error [%]"], [["naive", "-9.11"], ["mitiguy", "-0.126"]], names=1))
    rule     error [%]
    naive        -9.11
    mitiguy     -0.126
    """
    table = [heads, *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = (
        "  ".join(
            cell.ljust(width) if i < names else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in table
    )
    return "\n".join(line.rstrip() for line in lines)


def number(value: float) -> str:
    """Return a number to six digits, as results are shown."""
    return f"{value:.6g}"


def typed_in(value: float) -> str:
    """Return a number to ten digits, to be typed into another program."""
    return f"{value:.10g}"


def percents(fraction: float) -> str:
    """Return an error in percent with its sign; an error below 1e-14 is rounding, and shown as zero.

    Examples
    --------
    >>> percents(-0.00351753), percents(2e-16), percents(float("nan"))
    ('-0.3518', '0', 'nan')
    """
    return percent(fraction, 4, "", rounding=1e-14)


def hinge_table(pairs: Sequence[tuple[float, float]], units: Mapping[str, Any]) -> str:
    """Return the hinges' positions and stiffnesses, numbered from 1."""
    return text_table(
        ["hinge", f"position [{units['length']}]", f"stiffness [{units['joint_stiffness']}]"],
        [[str(j), number(x), typed_in(k)] for j, (x, k) in enumerate(pairs, start=1)],
    )


def frequency_rows(found: Floats, exact: Floats, errors: Floats) -> list[dict[str, Any]]:
    """Return modes as scripts get them, and `frequency_table` takes them: a chain's, the beam's, errors."""
    return [
        {
            "mode": n,
            "frequency": f,
            "exact_frequency": g,
            "angular_frequency": 2 * math.pi * f,
            "exact_angular_frequency": 2 * math.pi * g,
            "relative_error": e,
        }
        for n, (f, g, e) in enumerate(
            zip(found.tolist(), exact.tolist(), errors.tolist(), strict=True), start=1
        )
    ]


def frequency_table(rows: Sequence[dict[str, Any]], key: str = "frequency_hz", unit: str = "Hz") -> str:
    """Return modes with their frequencies, those of the exact beam and errors, None where missing.

    A mode that has a `damping_ratio` shows it; one that is overdamped says so.
    """

    def cell(row: dict[str, Any], name: str, show: Callable[[float], str]) -> str:
        return "no such mode" if row[key] is None else show(row[name])

    heads = ["mode", f"chain [{unit}]", f"exact [{unit}]", "error [%]"]
    shows = {key: number, f"exact_{key}": number, "relative_error": percents}
    if any(row.get("damping_ratio") for row in rows):
        heads.append("damping ratio")
    cells = [[str(row["mode"]), *(cell(row, name, show) for name, show in shows.items())] for row in rows]
    if len(heads) == 5:
        cells = [[*own, ratio_said(row["damping_ratio"])] for own, row in zip(cells, rows, strict=True)]
    return text_table(heads, cells)


def ratio_said(value: float | None) -> str:
    """Return a damping ratio, with a word on what it does from 1 on; nothing for None."""
    if value is None:
        return ""
    return f"{value:.4g}" if value < 1 else f"{value:.4g}: does not swing"


def more_hinges(count: int) -> list[str]:
    """Return the line below a table that leaves so many hinges out, none where it has all.

    Examples
    --------
    >>> more_hinges(3), more_hinges(0)
    (['3 more hinges: see --json'], [])
    """
    return [f"{count} more hinges: see --json"] if count > 0 else []
