"""Compare freshly computed tables with committed ones:  python -m studies.compare FRESH [COMMITTED].

No two processors give the same last digits. Numbers agree within a relative 1e-8. A study may say that a
column is of another `Kind`: rounded, so that one unit of its last place may differ, or rounding noise, of
which only the size is shared. Everything else, that is files, rows, columns and text, must be the same.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import zip_longest
from pathlib import Path

from studies import every_study
from studies.study import Kind

__all__ = ["COMMITTED", "folders_differ", "kinds", "rows_of", "study_differs", "tables_differ"]

COMMITTED = Path(__file__).resolve().parent.parent / "figures"
#: Measured between processors: at most 5e-12, but for the columns in `KINDS`.
RELATIVE = 1e-8
#: A change of this size is never taken for a unit that turned in rounding.
SEEN = 1e-6
_SHOWN = 30


@cache
def kinds() -> Mapping[str, Mapping[str, Kind]]:
    """Return the kinds of the columns that are not compared within a relative 1e-8, by table and column."""
    return {
        f"{name}{ending}": sheet.kinds
        for name, study in every_study().items()
        for ending, sheet in study.sheets.items()
        if sheet.kinds
    }


def folders_differ(fresh: Path, committed: Path = COMMITTED) -> list[str]:
    """Return a sentence for everything in which two folders' tables (.csv and .md) differ."""
    sides = [
        {p.name for p in folder.iterdir() if p.suffix in (".csv", ".md")} for folder in (fresh, committed)
    ]
    found = [f"{name}: committed, but no study writes it" for name in sorted(sides[1] - sides[0])]
    found += [f"{name}: written by a study, but not committed" for name in sorted(sides[0] - sides[1])]
    for name in sorted(sides[0] & sides[1]):
        texts = ((folder / name).read_text(encoding="utf-8") for folder in (fresh, committed))
        found += tables_differ(name, *texts)
    return found


def study_differs(name: str, tables: Mapping[str, str | bytes]) -> list[str]:
    """Return a sentence for everything in which a study's tables, by ending, differ from those committed."""
    texts = {f"{name}{ending}": text for ending, text in tables.items() if isinstance(text, str)}
    committed = {file: COMMITTED.joinpath(file).read_text(encoding="utf-8") for file in texts}
    return [sentence for file in texts for sentence in tables_differ(file, texts[file], committed[file])]


def tables_differ(name: str, fresh: str, committed: str) -> list[str]:
    """Return a sentence for every cell in which two tables differ: file, row, column and both values."""
    texts = fresh, committed
    if not name.endswith(".csv"):
        lines = enumerate(zip_longest(*(text.splitlines() for text in texts)), start=1)
        return [
            f"{name}, line {k}: committed {is_!r}, fresh {now!r}" for k, (now, is_) in lines if now != is_
        ]
    special = kinds().get(name, {})
    new, old = (list(csv.reader(text.splitlines())) for text in texts)
    if not new or not old or new[0] != old[0]:
        return [f"{name}, columns: committed {old[:1]}, fresh {new[:1]}"]
    found = []
    for number, was, now in _pairs(old, new, special):
        if was is None or now is None:
            side = "committed, but not fresh" if now is None else "fresh, but not committed"
            found.append(f"{name}, line {number}: row {','.join(was or now or [])} is {side}")
        elif not len(was) == len(now) == len(old[0]):
            found.append(f"{name}, line {number}: committed {len(was)} cells, fresh {len(now)}")
        else:
            for column, a, b in zip(old[0], was, now, strict=True):
                if not _agree(a, b, special.get(column, Kind())):
                    place = f"line {number} ({','.join(was[:4])}), column {column}"
                    found.append(f"{name}, {place}: committed {a}, fresh {b}")
    return found


def _pairs(
    old: list[list[str]], new: list[list[str]], special: Mapping[str, Kind]
) -> Iterator[tuple[int, list[str] | None, list[str] | None]]:
    """Yield the rows that stand in one place, with the committed one's line; lost rows are passed over."""
    lost = {old[0].index(column): kind.lost for column, kind in special.items() if kind.lost < math.inf}

    def at(rows: list[list[str]], k: int) -> list[str] | None:
        return rows[k] if k < len(rows) else None

    def alike(was: list[str] | None, now: list[str] | None) -> bool:
        if was is None or now is None or len(was) != len(now):
            return was is now
        return all(k in lost or _agree(a, b, Kind()) for k, (a, b) in enumerate(zip(was, now, strict=True)))

    def passed(rows: list[list[str]], k: int, other: list[str] | None) -> int:
        """Return how many rows that may lack stand before the one that belongs to `other`."""
        for n in range(len(rows) - k + 1):
            row = at(rows, k + n)
            if alike(row, other):
                return n
            if row is None or not all(_size(row, c) >= least for c, least in lost.items()):
                break
        return 0

    i = j = 1
    while i < len(old) or j < len(new):
        if lost:
            i += passed(old, i, at(new, j))
            j += passed(new, j, at(old, i))
        if i < len(old) or j < len(new):
            yield i + 1, at(old, i), at(new, j)
        i, j = i + 1, j + 1


def _size(row: list[str], column: int) -> float:
    return abs(_number(row[column])) if column < len(row) else math.nan


def _agree(committed: str, fresh: str, kind: Kind) -> bool:
    if committed == fresh:
        return True
    a, b = _number(committed), _number(fresh)
    if not (math.isfinite(a) and math.isfinite(b)):
        return False
    if kind.factor is not None:
        low, high = sorted((abs(a), abs(b)))
        return high <= kind.noise or high <= kind.factor * low
    apart = abs(a - b)
    if apart <= RELATIVE * abs(b):
        return True
    if kind.decimals is None or float(round(b, kind.decimals)) != b:
        return False
    # What was committed must be a rounded number too, and one unit beside: then only rounding turned. Where a
    # unit happens to be a millionth of the number, the two cannot be told apart, and none may turn.
    units = round(a, kind.decimals)
    turned = abs(a - units) <= RELATIVE * abs(a) and apart < 1.5 * 10.0**-kind.decimals
    return turned and abs(apart / max(abs(a), abs(b)) / SEEN - 1) > 0.02


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return a table's rows; numbers of few digits, which are inputs, without the turn of a last digit."""
    with path.open(encoding="utf-8", newline="") as file:
        return [{column: _as_meant(cell) for column, cell in row.items()} for row in csv.DictReader(file)]


def _as_meant(cell: str) -> str:
    value = _number(cell)
    short = f"{value:.8g}"
    return short if math.isfinite(value) and f"{value:.6g}" == short else cell


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what differs between two folders of tables, and return 1 if anything does."""
    parser = argparse.ArgumentParser(prog="python -m studies.compare", description=__doc__)
    parser.add_argument("fresh", type=Path, help="folder that `python -m studies --into` wrote")
    parser.add_argument("committed", type=Path, nargs="?", default=COMMITTED, help="default: figures/")
    options = parser.parse_args(arguments)
    found = folders_differ(options.fresh, options.committed)
    for sentence in found[:_SHOWN]:
        print(sentence)
    if found[_SHOWN:]:
        print(f"and {len(found) - _SHOWN} more")
    print(f"figures: {len(found)} numbers or texts differ" if found else "figures: unchanged")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
