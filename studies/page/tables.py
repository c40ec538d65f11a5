"""What the page's parts share: tables that studies have written, and agreements in words."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from studies.compare import rows_of
from studies.page.markup import bound

__all__ = ["Parts", "agree", "read", "worst_of"]

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
