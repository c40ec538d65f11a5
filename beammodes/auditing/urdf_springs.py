"""The springs of a URDF file, which stand in a YAML file beside it."""

from __future__ import annotations

import re
from pathlib import Path

from beammodes.auditing.bounded_xml import BadModel, bounded_bytes, finite_number
from beammodes.checks import shown

__all__ = ["read_springs"]

_ROW = re.compile(r"\s*-\s*\{([^{}]*)\}\s*(?:#.*)?")


def read_springs(path: Path) -> dict[str, float]:
    """Return the springs of a file as `export_chain` writes it beside a URDF file, by joint.

    Read is a small part of YAML: rows `- {joint: NAME, type: hinge, stiffness: NUMBER, rest: 0.0}` below
    `springs:`; the type may be left out, and a rest position must be 0.

    Raises
    ------
    BadModel
        If a row is none of these; the message names the line.
    """
    try:
        lines = bounded_bytes(path).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise BadModel(f"{path.name} must be a text file in UTF-8") from None
    except BadModel as error:
        raise BadModel(f"{path.name} {error}") from None
    found: dict[str, float] = {}
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#") or re.match(r"(model|springs):", line):
            continue
        where = f"{path.name}, line {number}"
        match = _ROW.fullmatch(line[:1000])
        pairs = dict(part.split(":", 1) for part in match[1].split(",") if ":" in part) if match else {}
        row = {key.strip(): value.strip() for key, value in pairs.items()}
        if "joint" not in row or "stiffness" not in row:
            raise BadModel(f"{where}: must be - {{joint: NAME, stiffness: NUMBER}}, got {shown(line)}")
        if row["joint"] in found:
            raise BadModel(f"{where}: must not give joint {shown(row['joint'])} a second spring")
        if finite_number(f"{where}: rest", row.get("rest", "0")):
            raise BadModel(f"{where}: must have rest 0: the chain must be straight at rest")
        found[row["joint"]] = finite_number(f"{where}: stiffness", row["stiffness"])
    return found
