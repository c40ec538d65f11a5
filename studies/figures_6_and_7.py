"""Figures 6 and 7 of the report: errors of the first three natural frequencies with one wall, and two."""

from __future__ import annotations

from functools import partial

import xarray
from matplotlib.figure import Figure

from beammodes.accuracy.error_table import derived_error_dataset
from studies.plots import label_line, plain_ticks, plot_errors
from studies.study import Progress, Sheet, Study

COLUMNS = (
    "boundary",
    "rule",
    "segments",
    "mode",
    "angular_frequency",
    "exact_angular_frequency",
    "relative_error",
)


def data(progress: Progress, boundary: str = "clamped-free") -> xarray.Dataset:
    """Return errors for N = 1..20 by the symbolic derivation; N = 1 between walls has no elastic mode."""
    return derived_error_dataset(boundary, segments=range(1, 21), modes=3, progress=progress)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw signed errors on linear axes, as the report has them, and their size on logarithmic ones."""
    linear, logarithmic = figure.subplots(1, 2)
    plot_errors(table, linear)
    linear.set_xlim(0, 20.5)
    linear.set_xticks(range(0, 21, 5))
    plot_errors(table, logarithmic, magnitude=True)
    logarithmic.set_xlim(0.9, 40)
    plain_ticks(logarithmic, [1, 2, 5, 10, 20], [0.01, 0.1, 1, 10])
    logarithmic.axhline(1.0, color="#555555", linewidth=0.9, linestyle=(0, (4, 3)))
    logarithmic.text(0.95, 1.06, "1 %", color="#555555", va="bottom")
    linear.set_title("signed, as in the report")
    logarithmic.set_title("size, on logarithmic axes")
    linear.margins(y=0.1)
    first, *others = linear.get_lines()[:3]
    label_line(linear, first, "1st", point=0, offset=(0, -7), ha="center", va="top")
    for order, line in zip(("2nd", "3rd"), others, strict=True):
        label_line(linear, line, order, point=0, offset=(7, -2))
    for mode, line in enumerate(logarithmic.get_lines()[:3], start=1):
        label_line(logarithmic, line, f"mode {mode}")


def _study(name: str, boundary: str, who: str) -> Study:
    words = name.replace("_", " ").capitalize()
    return Study(
        name=name,
        title=f"{words} · {who} beam, the report's springs",
        caption=f"{words} of the report: {who} beam, errors of the first three natural frequencies.",
        data=partial(data, boundary=boundary),
        draw=draw,
        sheets={".csv": Sheet(COLUMNS)},
        size=(9.0, 4.2),
    )


FIGURE_6 = _study("figure_6", "clamped-free", "cantilever/free")
FIGURE_7 = _study("figure_7", "clamped-clamped", "cantilever/cantilever")
