"""Where the page's numbers come from: studies' tables, second routes and how far they agree, tests."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from studies.compare import rows_of
from studies.page.markup import bound, escaped

__all__ = ["EVIDENCE", "Evidence", "Parts", "agree", "note", "read", "source_list", "worst_of"]


@dataclass(frozen=True, slots=True)
class Evidence:
    """The sources of some numbers of the page: two routes and the tests.

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


#: Pieces of HTML by the name that the text calls them by, and agreements of routes by source.
Parts = tuple[dict[str, str], dict[str, str]]


def read(folder: Path, name: str, **wanted: str) -> list[dict[str, str]]:
    """Return the rows of a study's CSV, those whose columns have the wanted values."""
    rows = rows_of(folder / f"{name}.csv")
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def worst_of(pairs: Iterable[tuple[float, float]]) -> float:
    """Return the largest relative difference of pairs of numbers.

    >>> worst_of([(1.0, 1.0), (2.0, 2.5)])
    0.2
    """
    return max(abs(a - b) / max(abs(a), abs(b), 1e-300) for a, b in pairs)


def agree(difference: float, most: float) -> str:
    """Say that two routes agree; raise ArithmeticError where they do not, so that no such page is written.

    >>> agree(3e-12, 1e-9)
    'they agree to 10⁻¹¹'
    """
    if not difference <= most:
        raise ArithmeticError(f"two routes to numbers of the page differ by {difference}, not below {most}")
    return "they agree exactly" if difference == 0.0 else f"they agree to {bound(difference)}"
