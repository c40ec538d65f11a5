"""Datasets as text: tidy CSV for programs, Markdown for people. Nothing is computed here."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

__all__ = ["csv_table", "markdown_table", "tidy_rows"]

#: Digits of a number in a CSV file: enough to show any change that matters, few enough to be the same on
#: every machine.
SIGNIFICANT_DIGITS = 12


def tidy_rows(dataset: xarray.Dataset, columns: Sequence[str]) -> list[list[Any]]:
    """Return one row per point of a dataset, in dimension order, without points that are missing throughout.

    Parameters
    ----------
    dataset : xarray.Dataset
        Its variables may each span some of the dimensions.
    columns : sequence of str
        Coordinates and variables, in the order wanted.

    Examples
    --------
    >>> import xarray
    >>> data = xarray.Dataset({"y": ("x", [0.5, float("nan")])}, coords={"x": [1, 2]})
    >>> tidy_rows(data, ["x", "y"])
    [[1, 0.5]]
    """
    full = dict(zip(dataset.data_vars, dataset.broadcast_like(dataset).data_vars.values(), strict=True))
    dims = list(dataset.sizes)
    arrays = [
        (full[name] if name in full else dataset[name].broadcast_like(dataset))
        .transpose(*dims)
        .values.ravel()
        for name in columns
    ]
    measured = [i for i, name in enumerate(columns) if name in full]
    rows = [list(row) for row in zip(*(array.tolist() for array in arrays), strict=True)]
    return [row for row in rows if not measured or not all(_missing(row[i]) for i in measured)]


def csv_table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Return rows as CSV with a heading, numbers to twelve significant digits, missing ones empty.

    Examples
    --------
    >>> csv_table(["n", "e"], [[1, 1 / 3]])
    'n,e\\n1,0.333333333333\\n'
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if _missing(value) else _digits(value, SIGNIFICANT_DIGITS) for value in row])
    return text.getvalue()


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[Any]], *, digits: int = 4) -> str:
    """Return rows as a Markdown table, numbers right-aligned to some significant digits.

    Examples
    --------
    >>> print(markdown_table(["n", "e"], [[1, 1 / 3], [2, float("nan")]]), end="")
    | n | e |
    |--:|--:|
    | 1 | 0.3333 |
    | 2 | – |
    """
    numeric = [all(not isinstance(row[i], str) for row in rows) for i in range(len(columns))]
    lines = [
        _line(columns),
        "|" + "|".join("--:" if right else "--" for right in numeric) + "|",
        *(_line(["–" if _missing(value) else _digits(value, digits) for value in row]) for row in rows),
    ]
    return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _digits(value: Any, digits: int) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def _missing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)
