"""The record of a study: what it computes, how it is drawn, and which tables it writes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from beammodes.numerics.arrays import Floats
from beammodes.progress import Progress
from beammodes.views.symbols import STYLE
from studies.tables import csv_table, tidy_rows

__all__ = ["Kind", "Progress", "Sheet", "Study", "repeatable", "silent"]


class Kind(NamedTuple):
    """The way in which a column is written and compared, where processors agree on fewer digits.

    decimals: written with so many; one unit of the last may differ.
    some: only some of the numbers are rounded so, by the study itself; the others are written in full.
    factor: rounding noise, or grown from it: sizes agree within this factor, signs are not compared.
    noise: sizes up to this one agree with each other.
    lost: from this size on, the row may be missing, because some processors leave no number at all.
    """

    decimals: int | None = None
    some: bool = False
    factor: float | None = None
    noise: float = 0.0
    lost: float = math.inf


@dataclass(frozen=True)
class Sheet:
    """A tidy table of a study, written as CSV.

    Parameters
    ----------
    columns : tuple of str
        Coordinates and variables of the study's dataset.
    kinds : mapping of str to Kind
        By column; other columns have twelve significant digits.
    part : callable
        From the study's dataset to what is written of it; all of it by default.
    needs : str
        A column without which a row is left out. By default a row is left out where all its variables are
        missing.
    """

    columns: tuple[str, ...]
    kinds: Mapping[str, Kind] = field(default_factory=dict)
    part: Callable[[xarray.Dataset], xarray.Dataset] = lambda table: table
    needs: str = ""

    def rows(self, table: xarray.Dataset) -> list[list[Any]]:
        """Return the table's rows from a study's dataset."""
        part = self.part(table)
        if set(part.data_vars) - set(self.columns):
            part = part[[name for name in self.columns if name in part.data_vars]]
        rows = tidy_rows(part, self.columns)
        if self.needs:
            needed = self.columns.index(self.needs)
            rows = [row for row in rows if not math.isnan(row[needed])]
        return rows

    def text(self, table: xarray.Dataset) -> str:
        """Return the CSV file's text."""
        return csv_table(self.columns, self.rows(table))


def silent(done: int, total: int) -> None:
    """Report no progress."""


@dataclass(frozen=True)
class Study:
    """A figure with its tables. A module-level record in a file of `studies/` is all that is needed.

    Parameters
    ----------
    name : str
        Of its files in `figures/`.
    title : str
        Written over the picture.
    caption : str
        One sentence under the picture on the page of the report, and in lists.
    data : callable
        Computes the dataset, and tells its argument how many points of how many are done.
    draw : callable
        Draws a dataset into an empty figure that has its title and style already.
    sheets : mapping of str to Sheet
        Tables by the ending of their file names; the first is ".csv".
    size : tuple of float
        Width and height [inches].
    more : callable
        Other files by their endings, from the dataset: Markdown as text, films as bytes.
    seconds : float
        About how long it takes; where several run at once, the slowest starts first.
    reproducible : bool
        False where the numbers are rounding errors: the picture is then left out of the page of the report,
        which must be the same on every machine.
    """

    name: str
    title: str
    caption: str
    data: Callable[[Progress], xarray.Dataset]
    draw: Callable[[xarray.Dataset, Figure], object]
    sheets: Mapping[str, Sheet]
    size: tuple[float, float] = (9.0, 5.4)
    more: Callable[[xarray.Dataset], Mapping[str, str | bytes]] | None = None
    seconds: float = 4.0
    reproducible: bool = True

    def compute(self, progress: Progress = silent) -> xarray.Dataset:
        """Return the dataset, its columns rounded as the tables have them: drawings repeat as they do."""
        table = self.data(progress)
        for sheet in self.sheets.values():
            for name, kind in sheet.kinds.items():
                if kind.decimals is not None and not kind.some:
                    table[name].values = repeatable(table[name], kind.decimals)
        return table

    def picture(self, table: xarray.Dataset) -> Figure:
        """Return the figure of a computed dataset."""
        with matplotlib.rc_context({**STYLE, "axes.titlelocation": "left", "axes.titlesize": 11}):
            figure = Figure(figsize=self.size, layout="constrained")
            figure.suptitle(self.title, fontsize=13, fontweight="bold", x=0.01, ha="left")
            self.draw(table, figure)
        return figure

    def tables(self, table: xarray.Dataset) -> dict[str, str | bytes]:
        """Return the contents of all files but the picture's, by ending."""
        more = self.more(table) if self.more else {}
        return {ending: sheet.text(table) for ending, sheet in self.sheets.items()} | dict(more)


def repeatable(values: ArrayLike, decimals: int) -> Floats:
    """Return rounded numbers, none of them -0, so that files are the same on every processor."""
    return np.asarray(values, dtype=np.float64).round(decimals) + 0.0
