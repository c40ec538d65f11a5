"""The committed tables against fresh ones: last digits may turn, and nothing else may change."""

from __future__ import annotations

import csv
import io
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from studies.compare import RELATIVE, folders_differ, kinds, main, rows_of, tables_differ

FIGURES = Path(__file__).parent.parent / "figures"
TABLES = sorted(FIGURES.glob("*.csv"))
NAMES = [path.stem for path in TABLES]


def number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if abs(value) < float("inf") else None


def changed(path: Path, change: Callable[[int, str, str], str]) -> str:
    """Return a table with its cells changed: `change` gets the row's number, the column and the cell."""
    heading, *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    for k, row in enumerate(rows):
        writer.writerow([change(k, c, cell) for c, cell in zip(heading, row, strict=True)])
    return text.getvalue()


def in_the_tenth_digit(text: str, units: int) -> str:
    """Return a number with its tenth significant digit moved, and all that follow kept."""
    value = number(text)
    if value is None or value == 0.0:
        return text
    exponent = int(f"{value:e}".split("e")[1])
    return f"{value + units * 10.0 ** (exponent - 9):.17g}"


@pytest.mark.parametrize("path", TABLES, ids=NAMES)
@pytest.mark.parametrize("units", [1, -1])
def test_the_tenth_digit_of_every_number_may_differ(path: Path, units: int) -> None:
    is_ = path.read_text(encoding="utf-8")
    other = changed(path, lambda _, __, cell: in_the_tenth_digit(cell, units))
    assert other != is_
    assert tables_differ(path.name, is_, other) == []


@pytest.mark.parametrize("path", TABLES, ids=NAMES)
@pytest.mark.parametrize("factor", [1 + 1e-6, 1 - 1e-6])
def test_no_number_may_be_off_by_a_millionth(path: Path, factor: float) -> None:
    """Every number is changed, and every change must be named: none hides behind another."""
    noise = {column for column, kind in kinds().get(path.name, {}).items() if kind.factor is not None}
    expected = []

    def off(row: int, column: str, cell: str) -> str:
        value = number(cell)
        if value is None or value == 0.0 or column in noise:
            return cell
        expected.append((row, column))
        return f"{value * factor:.17g}"

    other = changed(path, off)
    found = tables_differ(path.name, path.read_text(encoding="utf-8"), other)
    assert len(found) == len(expected) > 5
    for sentence, (row, column) in zip(found, expected, strict=True):
        assert sentence.startswith(f"{path.name}, line {row + 2} (") and f"column {column}: " in sentence


@pytest.mark.parametrize(
    "file", [file for file, columns in kinds().items() if any(k.factor for k in columns.values())]
)
def test_noise_keeps_its_size(file: str) -> None:
    """Noise may differ by its factor, not by ten times that."""
    path, special = FIGURES / file, kinds()[file]

    def scaled(by: float) -> str:
        def change(_: int, column: str, cell: str) -> str:
            value, kind = number(cell), special.get(column)
            if value is None or kind is None or kind.factor is None:
                return cell
            return repr(value * kind.factor * by)

        return changed(path, change)

    is_ = path.read_text(encoding="utf-8")
    assert tables_differ(path.name, is_, scaled(0.99)) == []
    assert len(tables_differ(path.name, is_, scaled(10.0))) > 100


def test_kinds_are_of_columns_that_there_are() -> None:
    for file, special in kinds().items():
        rows = rows_of(FIGURES / file)
        for column, kind in special.items():
            values = [float(row[column]) for row in rows if row[column]]
            assert values, (file, column)
            if kind.decimals is not None:
                rounded = [abs(round(v, kind.decimals) - v) <= RELATIVE * abs(v) for v in values]
                assert any(rounded), (file, column)


@pytest.mark.parametrize(
    ("fresh", "said"),
    [
        ("n,e\n4,0.25\n", ["t.csv, line 3: row 5,x is committed, but not fresh"]),
        ("n,e\n4,0.25\n5,x\n6,1\n", ["t.csv, line 4: row 6,1 is fresh, but not committed"]),
        ("n,e\n4,0.25\n5,y\n", ["t.csv, line 3 (5,x), column e: committed x, fresh y"]),
        ("n,e\n4,\n5,x\n", ["t.csv, line 2 (4,0.25), column e: committed 0.25, fresh "]),
        ("n,e\n4,nan\n5,x\n", ["t.csv, line 2 (4,0.25), column e: committed 0.25, fresh nan"]),
        ("n,e\n4,inf\n5,x\n", ["t.csv, line 2 (4,0.25), column e: committed 0.25, fresh inf"]),
        ("n,e\n4,-0.25\n5,x\n", ["t.csv, line 2 (4,0.25), column e: committed 0.25, fresh -0.25"]),
        ("n,e\n4,0.25,1\n5,x\n", ["t.csv, line 2: committed 2 cells, fresh 3"]),
        ("n,f\n4,0.25\n5,x\n", ["t.csv, columns: committed [['n', 'e']], fresh [['n', 'f']]"]),
        ("", ["t.csv, columns: committed [['n', 'e']], fresh []"]),
        ("n,e\n4.0,2.5e-1\n5,x\n", []),
        (f"n,e\n4,{0.25 * (1 + 0.9 * RELATIVE)!r}\n5,x\n", []),
        (f"n,e\n4,{0.25 * (1 + 1.1 * RELATIVE)!r}\n5,x\n", ["column e"]),
    ],
)
def test_what_changed_is_named(fresh: str, said: list[str]) -> None:
    found = tables_differ("t.csv", fresh, "n,e\n4,0.25\n5,x\n")
    assert len(found) == len(said)
    assert all(part in sentence for part, sentence in zip(said, found, strict=True))


def test_a_row_without_a_digit_may_lack() -> None:
    """Some processors find no frequency at all where rounding has taken every digit; others must be there."""
    heading, rows = (
        "method,segments,relative_error\n",
        ["a,1,1e-16\n", "a,2,0.5\n", "a,3,1.5\n", "b,1,1e-15\n"],
    )

    def found(committed: str, fresh: str) -> list[str]:
        return tables_differ("accuracy.csv", heading + fresh, heading + committed)

    full = "".join(rows)
    for lacking in ({1}, {2}, {1, 2}):
        less = "".join(row for k, row in enumerate(rows) if k not in lacking)
        assert not found(full, less) and not found(less, full)
    assert not found("".join(rows[:3]), rows[0]) and not found(rows[0], "".join(rows[:3]))
    for k in (0, 3):
        less = "".join(row for n, row in enumerate(rows) if n != k)
        assert found(full, less) and found(less, full)


def test_one_unit_of_a_rounded_column_may_turn() -> None:
    """Rounded to eight decimals: one unit beside is a turn, two are not, nor is what is not so rounded."""
    heading = "motion,model,time,tip_deflection\n"

    def found(committed: str, fresh: str) -> list[str]:
        one, other = (f"{heading}linear,modes,1,{value}\n" for value in (fresh, committed))
        return tables_differ("figure_1.csv", one, other)

    assert not found("-0.00359079", "-0.0035908")
    assert not found("1e-08", "0") and not found("0", "-1e-08")
    assert found("-0.00359079", "-0.00359081")
    assert found("-0.003590795", "-0.0035908")
    assert found("2e-08", "0") and found("1e-09", "0")
    # A unit of it is a millionth of the number here: a change, and no turn.
    assert found("0.01000001", "0.01")


def test_files_that_come_and_go_and_changed_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(
        FIGURES, tmp_path / "new", ignore=shutil.ignore_patterns("*.svg", "*.png", "*.gif", "*.html")
    )
    assert folders_differ(tmp_path / "new") == [] and main([str(tmp_path / "new")]) == 0
    (tmp_path / "new" / "truck.csv").rename(tmp_path / "new" / "lorry.csv")
    page = tmp_path / "new" / "c_table.md"
    page.write_text(page.read_text(encoding="utf-8").replace("0.357", "0.358"), encoding="utf-8")
    found = folders_differ(tmp_path / "new")
    assert found[0] == "truck.csv: committed, but no study writes it"
    assert found[1] == "lorry.csv: written by a study, but not committed"
    assert len(found) > 2 and all(sentence.startswith("c_table.md, line ") for sentence in found[2:])
    capsys.readouterr()
    assert main([str(tmp_path / "new")]) == 1
    assert f"figures: {len(found)} numbers or texts differ" in capsys.readouterr().out
