"""Error of every rule against N, beside cubic finite elements: the largest of the first three modes."""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import beammodes as bm
from beammodes.views.symbols import GREY
from studies.common import LARGEST_ERROR, MATCHED, MODES, element_errors, largest_error
from studies.plots import label_along, mark_exact, mark_point, method_style, places_along, plain_ticks
from studies.study import Progress, Sheet, Study

BOUNDARIES = ("clamped-free", "clamped-clamped")
ELEMENTS = "cubic finite elements"
SEGMENTS = np.array([*range(MODES, 65), *np.unique(np.geomspace(66, 1000, 24).astype(int))])
MOST_ELEMENTS = 64
TOLERANCES = (1e-2, 1e-5)
MARKED = ("mitiguy", "gregory", ELEMENTS)
# Where a number would cover a neighbouring line.
OFFSETS = {("gregory", 1e-2): (-6, 5), ("gregory", 1e-5): (-6, 5), (ELEMENTS, 1e-2): (-3, -14)}
# Where each line is named, and on which side.
LABELS: dict[str, tuple[float, Literal["above", "below"]]] = {
    "naive": (150, "below"),
    "rigid_stub": (150, "above"),
    "hencky": (130, "above"),
    "mitiguy": (75, "above"),
    "double_wall": (300, "above"),
    "half_stub": (450, "below"),
    "gregory2": (100, "below"),
    "rigid_stub_corrected": (200, "below"),
    "half_stub_corrected": (15, "above"),
    "gregory": (11, "below"),
    "simpson": (36, "above"),
    ELEMENTS: (9, "below"),
}
CLAMPED_LABELS = LABELS | {
    "half_stub_corrected": (20, "above"),
    "gregory": (17, "below"),
    "simpson": (9.3, "above"),
    ELEMENTS: (12, "below"),
}
CLAMPED_LABELS["rigid_stub_corrected"] = (330, "below")


def data(progress: Progress) -> xarray.Dataset:
    """Return largest errors by boundary, method and N, and the segments that the marked methods need."""
    methods = (*bm.RULES, ELEMENTS, MATCHED.name)
    error = np.full((len(BOUNDARIES), len(methods), len(SEGMENTS)), np.nan)
    needed = np.zeros((len(BOUNDARIES), len(MARKED), len(TOLERANCES)), dtype=int)
    for i, boundary in enumerate(BOUNDARIES):
        for j, rule in enumerate(bm.RULES):
            error[i, j] = largest_error(boundary, rule, SEGMENTS)
        few = SEGMENTS <= MOST_ELEMENTS
        error[i, -2, few] = [np.abs(element_errors(boundary, int(n))).max() for n in SEGMENTS[few]]
        # Exact from the shortest chain that has the modes: two lengths show it.
        error[i, -1, :2] = largest_error(boundary, MATCHED, SEGMENTS[:2])
        for k, tolerance in enumerate(TOLERANCES):
            fails = few & ~(error[i, -2] <= tolerance)
            by_elements = SEGMENTS[np.flatnonzero(fails)[-1] + 1]
            by_rods = [bm.segments_needed(boundary, tolerance, MODES, rule) for rule in MARKED[:-1]]
            needed[i, :, k] = [*by_rods, by_elements]
        progress(i + 1, len(BOUNDARIES))
    return xarray.Dataset(
        {
            "largest_error": (("boundary", "method", "segments"), error),
            "segments_needed": (("boundary", "marked", "tolerance"), needed),
        },
        coords={
            "boundary": list(BOUNDARIES),
            "method": list(methods),
            "segments": SEGMENTS,
            "marked": list(MARKED),
            "tolerance": list(TOLERANCES),
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw error against N on logarithmic axes, one panel a boundary."""
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, boundary in zip(panels, BOUNDARIES, strict=True):
        ax.set(xscale="log", yscale="log", xlim=(2.5, 1600), ylim=(1e-4, 100))
        plain_ticks(ax, [3, 10, 30, 100, 300, 1000], [10.0**k for k in range(-4, 3)], unit=" %")
        ax.set_title(f"{boundary}  (dots: N for 1 % and 0.001 %)")
        ax.set_xlabel("N, number of segments or finite elements")
    panels[0].set_ylabel("largest |frequency error| of modes 1 to 3")
    for ax, boundary, places in zip(panels, BOUNDARIES, (LABELS, CLAMPED_LABELS), strict=True):
        lines = _lines(ax, table.sel(boundary=boundary))
        label_along(ax, places_along(ax, lines, places))


def _lines(ax: Axes, table: xarray.Dataset) -> dict[str, Line2D]:
    lines = {}
    for method in table.method.values[:-1]:
        line = 100 * table.largest_error.sel({"method": method}).dropna("segments")
        (lines[method],) = ax.plot(line.segments, line, **method_style(method))
    for tolerance in table.tolerance.values:
        ax.axhline(100 * tolerance, color=GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
        for method in MARKED:
            count = int(table.segments_needed.sel({"marked": method, "tolerance": tolerance}))
            mark_point(ax, lines[method], count, f"{count}", offset=OFFSETS.get((method, tolerance), (6, 5)))
    shortest = int(table.largest_error.sel({"method": MATCHED.name}).dropna("segments").segments[0])
    note = f"{MATCHED.name}:\n{shortest} rods give all\nthree exactly,\nand so do more"
    mark_exact(ax, shortest, 30, note)
    return lines


STUDY = Study(
    name="error_by_rule",
    title="How wrong are the first three frequencies of a beam made of N rigid rods?",
    caption="Largest error of the first three modes against N, for every rule and for cubic finite elements.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("boundary", "method", "segments", "largest_error"),
            {"largest_error": LARGEST_ERROR},
        ),
        "_needed.csv": Sheet(("boundary", "marked", "tolerance", "segments_needed")),
    },
    size=(9.0, 6.0),
)
