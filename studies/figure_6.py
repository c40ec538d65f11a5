"""Figure 6 of the report: cantilever/free beam, error in the first three natural frequencies."""

from __future__ import annotations

import matplotlib
import xarray
from matplotlib.figure import Figure

from beammodes.accuracy.error_table import derived_error_dataset
from beammodes.views.symbols import STYLE
from studies import Progress
from studies.plots import label_line, plot_errors
from studies.tables import csv_table, tidy_rows

BOUNDARY = "clamped-free"
TITLE = "Figure 6 · cantilever/free beam, the report's springs"
COLUMNS = (
    "boundary",
    "rule",
    "segments",
    "mode",
    "angular_frequency",
    "exact_angular_frequency",
    "relative_error",
)


def data(progress: Progress | None = None, boundary: str = BOUNDARY) -> xarray.Dataset:
    """Errors for N = 1..20 through the symbolic derivation."""
    return derived_error_dataset(boundary, segments=range(1, 21), modes=3, progress=progress)


def draw(table: xarray.Dataset, title: str = TITLE) -> Figure:
    """Signed errors on linear axes, as the report has them, and their size on logarithmic ones."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 4.2), layout="constrained")
        figure.suptitle(title, fontsize=13, fontweight="bold", x=0.01, ha="left")
        linear, logarithmic = figure.subplots(1, 2)
        plot_errors(table, linear)
        linear.set_xlim(0, 20.5)
        linear.set_xticks(range(0, 21, 5))
        plot_errors(table, logarithmic, magnitude=True)
        logarithmic.set_xlim(0.9, 40)
        logarithmic.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        logarithmic.set_yticks([0.01, 0.1, 1, 10], ["0.01", "0.1", "1", "10"])
        logarithmic.minorticks_off()
        logarithmic.axhline(1.0, color="#555555", linewidth=0.9, linestyle=(0, (4, 3)))
        logarithmic.text(0.95, 1.06, "1 %", color="#555555", va="bottom")
        linear.set_title("signed, as in the report", fontsize=11, loc="left")
        logarithmic.set_title("size, on logarithmic axes", fontsize=11, loc="left")
        linear.margins(y=0.1)
        first, *others = linear.get_lines()[:3]
        label_line(linear, first, "1st", point=0, offset=(0, -7), ha="center", va="top")
        for order, line in zip(("2nd", "3rd"), others, strict=True):
            label_line(linear, line, order, point=0, offset=(7, -2))
        for mode, line in enumerate(logarithmic.get_lines()[:3], start=1):
            label_line(logarithmic, line, f"mode {mode}")
    return figure


def tables(table: xarray.Dataset) -> dict[str, str]:
    """The tidy CSV beside the picture, by ending of its file name."""
    return {".csv": csv_table(COLUMNS, tidy_rows(table, COLUMNS))}
