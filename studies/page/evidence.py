"""Where the page's numbers come from: functions, second routes and tests, by name, under small numerals."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from studies.page.markup import escaped

__all__ = ["EVIDENCE", "Evidence", "note", "source_list"]


@dataclass(frozen=True, slots=True)
class Evidence:
    """What computed some numbers of the page, and what else has found them.

    Parameters
    ----------
    key : str
        What the page's text calls it.
    what : str
        The numbers, in a few words.
    function, second : str
        Dotted names: of what computed them, and of the other way to them.
    tests : tuple of str
        Each "file::function" in `tests/`.
    """

    key: str
    what: str
    function: str
    second: str
    tests: tuple[str, ...]


def _read() -> tuple[Evidence, ...]:
    with (Path(__file__).parent / "sources.toml").open("rb") as file:
        entries = tomllib.load(file)
    return tuple(
        Evidence(key, entry["what"], entry["function"], entry["second"], tuple(entry["tests"]))
        for key, entry in entries.items()
    )


#: In the order of their numerals.
EVIDENCE = _read()
_NUMBERS = {evidence.key: number for number, evidence in enumerate(EVIDENCE, start=1)}


def note(key: str) -> str:
    """Return the numeral that leads to a source."""
    number = _NUMBERS[key]
    what = escaped(EVIDENCE[number - 1].what)
    return f'<sup><a href="#source-{key}" title="{what}" aria-label="Source {number}">{number}</a></sup>'


def source_list(agreements: dict[str, str]) -> str:
    """Return the list of sources; `agreements` says in words how far the two routes of each agree."""
    return "\n".join(_source(evidence, agreements[evidence.key]) for evidence in EVIDENCE)


def _source(evidence: Evidence, agreement: str) -> str:
    tests = ", ".join(f"<code>{escaped(test)}</code>" for test in evidence.tests)
    return (
        f'<li id="source-{evidence.key}"><b>{escaped(evidence.what)}.</b> '
        f"<code>{escaped(evidence.function)}</code>; second: <code>{escaped(evidence.second)}</code>: "
        f"{escaped(agreement)}. Tests: {tests}.</li>"
    )
