"""Docstrings as Sphinx reads them: equations keep their lines, and their stars and bars."""

from __future__ import annotations

import re

__all__ = ["as_markup", "with_plain_equations"]


def as_markup(app: object, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Change a docstring's lines in place; for Sphinx's event autodoc-process-docstring."""
    del app, what, name, obj, options
    lines[:] = with_plain_equations(lines)


def with_plain_equations(lines: list[str]) -> list[str]:
    r"""Return a docstring as reStructuredText in which equations are no markup.

    Equations are written for a terminal, in Unicode, indented below the text that they belong to: that
    becomes a literal block, where it would be a quotation whose lines are filled. In the text stars and
    bars stand for themselves. Examples and what stands between back quotes stay as they are.

    >>> with_plain_equations(["|e| is", "", "    |e| = a*b", "", "where a*b, or `a*b`,", "", ">>> 2*3"])
    ['\\|e\\| is', '', '::', '', '    |e| = a*b', '', 'where a\\*b, or `a*b`,', '', '>>> 2*3']
    """
    found: list[str] = []
    section = example = literal = False
    for index, line in enumerate(lines):
        blank, before = not line.strip(), lines[index - 1] if index else ""
        section = section or _heads_section(lines, index)
        example = not blank and (example or line.lstrip().startswith(">>>"))
        indented = line.startswith("    ")
        if not section and indented and not before.strip() and not example and not literal:
            literal = not _is_item(next((text for text in reversed(found) if text.strip()), ""))
            found += ["::", ""] if literal else []
        literal = literal and (blank or indented)
        found.append(line if literal or example else _escaped(line))
    return found


def _heads_section(lines: list[str], index: int) -> bool:
    """Say whether a section such as Parameters begins at a line."""
    rule = lines[index + 1] if index + 1 < len(lines) else ""
    return bool(lines[index].strip()) and re.fullmatch(r"-{3,}", rule.strip()) is not None


def _is_item(line: str) -> bool:
    """Say whether a line is of a list's item, which an indented paragraph goes on with."""
    return re.match(r"(\d+\.|[-*]) ", line) is not None


def _escaped(line: str) -> str:
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(part if part.startswith("`") else re.sub(r"([*|])", r"\\\1", part) for part in parts)
