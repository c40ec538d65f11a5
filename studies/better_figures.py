"""Figures 6 and 7 of the report again, with springs that remove most of the error, or all."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import GREY
from studies.common import MATCHED, MODES, ROUNDING
from studies.plots import label_line, method_style
from studies.study import Progress, Sheet, Study

FIGURES = {"clamped-free": "Figure 6", "clamped-clamped": "Figure 7"}
RULES = ("mitiguy", "gregory", MATCHED)


def data(progress: Progress) -> xarray.Dataset:
    """Return errors for N = 1..20, three modes; matched springs need a chain that has three."""
    parts = []
    for i, rule in enumerate(RULES):
        parts.append(bm.error_dataset(boundary=list(FIGURES), segments=range(1, 21), modes=MODES, rule=rule))
        progress(i + 1, len(RULES))
    table = xarray.concat(parts, "rule")[["relative_error"]]
    return table.where(~(np.abs(table) < ROUNDING), 0.0)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw percent error against N, one row a figure of the report, one column a mode."""
    panels = figure.subplots(len(FIGURES), MODES, sharex=True, sharey=True)
    for row, (boundary, name) in zip(panels, FIGURES.items(), strict=True):
        for ax, mode in zip(row, table.mode.values, strict=True):
            for rule in table.rule.values:
                line = 100 * table.relative_error.sel(boundary=boundary, mode=mode, rule=rule)
                line = line.dropna("segments")
                ax.plot(line.segments, line, marker="o", markersize=3.5, **method_style(str(rule)))
            _label(ax)
            ax.set_title(f"{name}, mode {mode}")
        row[0].set_ylabel(f"{boundary}\nfrequency error  [%]")
    # Linear within 0.1 %, logarithmic beyond: signs stay, and so does the distance of small errors.
    panels[0, 0].set_yscale("symlog", linthresh=0.1, linscale=0.6)
    panels[0, 0].set_yticks([-10, -1, -0.1, 0], ["−10", "−1", "−0.1", "0"])
    panels[0, 0].set(xlim=(0, 20.8), ylim=(-60, 0.15), xticks=range(0, 21, 5))
    for ax in panels.flat:
        ax.minorticks_off()
    for ax in panels[-1]:
        ax.set_xlabel("number of segments N")
    note = "vertical axis: signed errors, linear within ±0.1 %, logarithmic beyond"
    figure.supxlabel(note, fontsize=10, color=GREY, x=0.99, ha="right")


def _label(ax: Axes) -> None:
    report, gregory, matched = ax.get_lines()
    label_line(ax, report, "mitiguy (report)", offset=(2, -20), ha="right", va="top")
    small = int(np.argmax(np.asarray(gregory.get_ydata()) > -0.3))
    label_line(ax, gregory, "gregory", point=small, offset=(9, -4))
    label_line(ax, matched, "matched(3): exact", offset=(2, 4), ha="right", va="bottom")


STUDY = Study(
    name="better_figures",
    title="Figures 6 and 7 again, with better springs in the same rods",
    caption="Figures 6 and 7 of the report again, with springs that remove most of the error, or all.",
    data=data,
    draw=draw,
    sheets={".csv": Sheet(("boundary", "rule", "segments", "mode", "relative_error"))},
    size=(9.0, 5.4),
)
