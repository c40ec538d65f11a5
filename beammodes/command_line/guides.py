"""What the command line shows of the project itself: its rules, its pages, and completion for shells."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from beammodes.chains.rules import RULES
from beammodes.checks import choice
from beammodes.command_line.options import DEFAULT_RULE, Answer, Command
from beammodes.command_line.text_tables import text_table

__all__ = ["completion", "guide", "listed_rules"]

PAGES = Path(__file__).parent.parent / "pages"
_SHELLS = ("bash", "zsh")


def listed_rules() -> Answer:
    """Return the registered rules, and a table of them."""
    rows = [
        {
            "rule": name,
            "default": name == DEFAULT_RULE,
            "order_at_a_clamped_end": rule.order["clamped"],
            "summary": rule.summary,
            "used_by": rule.used_by,
        }
        for name, rule in RULES.items()
    ]
    lines = [
        *(f"{row['rule']} (order {row['order_at_a_clamped_end']})\n    {row['summary']}" for row in rows),
        "order: the power of 1/N with which errors fall at a clamped end; between other ends it may be more",
        f"{DEFAULT_RULE} is the default, here and in the library: that of Mitiguy's report",
        "the fewest segments between your ends: beammodes recommend; more on rules: beammodes guide rules",
    ]
    return {"rules": rows}, "\n".join(lines)


def guide(page: str | None) -> Answer:
    """Return a page of the project, or what its pages are."""
    found = {path.stem: path for path in sorted(PAGES.glob("*.md"))}
    if page is None:
        titles = {name: _title(path) for name, path in found.items()}
        lines = [text_table(["page", "what it is about"], [[*pair] for pair in titles.items()], names=2)]
        return {"pages": titles}, "\n".join([*lines, "next: beammodes guide PAGE"])
    name = choice("page", page.lower().removesuffix(".md").replace("-", "_"), _spelled(found))
    path = found[_spelled(found)[name]]
    text = path.read_text(encoding="utf-8").rstrip()
    return {"page": path.stem, "text": text}, text


def _spelled(found: dict[str, Path]) -> dict[str, str]:
    return {name.lower(): name for name in found}


def _title(path: Path) -> str:
    """Return the heading of a page."""
    with path.open(encoding="utf-8") as file:
        return next((line.lstrip("# ").strip() for line in file if line.startswith("# ")), "")


def completion(shell: str, commands: Sequence[Command]) -> Answer:
    """Return the script by which a shell completes commands and options.

    Raises
    ------
    ValueError
        If the shell is unknown, or the package that writes such scripts is not installed.
    """
    chosen = choice("shell", shell, _SHELLS)
    try:
        import shtab
    except ImportError:
        raise ValueError("completion must have the package shtab: pip install shtab") from None
    whole = argparse.ArgumentParser(prog="beammodes")
    parts = whole.add_subparsers()
    for command in commands:
        command.fill(parts.add_parser(command.name, help=command.question.replace("%", "%%")))
    script: Any = shtab.complete(whole, shell=chosen)
    return {"shell": chosen, "script": script}, str(script).rstrip()
