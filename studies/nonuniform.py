"""Beams whose stiffness varies: a taper costs no order, a step does unless a hinge stands on it."""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import beammodes as bm
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.problem.profiles import Table, value_at
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BOUNDARY, RULES = "clamped-free", ("mitiguy", "gregory")
TAPER = bm.Beam(1.0, Table((0.0, 1.0), (1.0, 0.5)), 1.0)
STEP = bm.Beam(1.0, [1.0, 1.0, 1.0, 0.1], 1.0)
_QUARTERS = np.unique(np.geomspace(1, 50, 17).round().astype(int))
#: Beam, and the N: a hinge on the step, the step a quarter into a segment, and in a segment's middle.
CASES: dict[str, tuple[bm.Beam, np.ndarray]] = {
    "taper": (TAPER, 4 * _QUARTERS),
    "hinge on the step": (STEP, 4 * _QUARTERS),
    "step a quarter into a segment": (STEP, 4 * _QUARTERS + 1),
    "step in the middle of a segment": (STEP, 4 * _QUARTERS + 2),
}
#: EI from the hub to the tip of a catheter in twelve equal parts [N m²], 1.1 m long, of 4.5 g/m.
CATHETER_STIFFNESS = tuple(1e-4 * x for x in (8.0, 8.0, 7.5, 7.0, 6.0, 5.0, 4.0, 3.0, 2.2, 1.5, 1.0, 0.6))
CATHETER = bm.Beam(1.1, bending_stiffness=list(CATHETER_STIFFNESS), mass_per_length=0.0045)
CATHETER_SEGMENTS = (12, 24, 36)
#: `chain_errors` are good to 1e-10 on beams that vary; less than two digits are not shown.
LEAST = 1e-8
# Title, N of the sketched chain, a note, and where each line is named.
Place = tuple[str, str, str, float, Literal["above", "below"]]
PANELS: tuple[tuple[str, int, str, tuple[Place, ...]], ...] = (
    (
        "smooth taper",
        4,
        "EI falls to a half",
        (
            ("taper", "mitiguy", "mitiguy: 1/N²", 40, "above"),
            ("taper", "gregory", "gregory: 1/N⁴", 17, "below"),
        ),
    ),
    (
        "step, a hinge on it",
        4,
        "N = 4, 8, 12 …",
        (
            ("hinge on the step", "mitiguy", "mitiguy: 1/N²", 40, "above"),
            ("hinge on the step", "gregory", "gregory: 1/N⁴", 22, "below"),
        ),
    ),
    (
        "step inside a rigid segment",
        5,
        "solid: N = 5, 9, 13 …\na quarter into a segment\n\ndashed: N = 6, 10, 14 …\nin a segment's middle",
        (
            ("step a quarter into a segment", "mitiguy", "mitiguy: 1/N", 45, "above"),
            ("step a quarter into a segment", "gregory", "gregory: 1/N", 14, "below"),
            ("step in the middle of a segment", "gregory", "gregory: 1/N²", 40, "below"),
        ),
    ),
)


def data(progress: Progress) -> xarray.Dataset:
    """Return errors of the first frequency by case, rule and N; and those of three modes of the catheter."""
    segments = np.unique(np.concatenate([counts for _, counts in CASES.values()]))
    error = np.full((len(CASES), len(RULES), len(segments)), np.nan)
    for i, (beam, counts) in enumerate(CASES.values()):
        for j, rule in enumerate(RULES):
            for count in counts:
                chain = bm.Chain(beam, BOUNDARY, int(count), rule)
                error[i, j, np.searchsorted(segments, count)] = chain_errors(chain, 1)[0]
            progress(len(RULES) * i + j + 1, len(RULES) * len(CASES))
    catheter = [
        [chain_errors(bm.Chain(CATHETER, BOUNDARY, n, rule), 3) for n in CATHETER_SEGMENTS] for rule in RULES
    ]
    return xarray.Dataset(
        {
            "relative_error": (
                ("case", "rule", "segments"),
                np.where(abs(error) < LEAST, np.nan, error),
            ),
            "catheter_error": (("rule", "parts", "mode"), np.array(catheter)),
        },
        coords={
            "case": list(CASES),
            "rule": list(RULES),
            "segments": segments,
            "parts": list(CATHETER_SEGMENTS),
            "mode": [1, 2, 3],
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw |error| against N in three panels, over sketches of the stiffness and of the rods."""
    panels = figure.subplots(2, 3, sharex="row", sharey="row", height_ratios=(1, 3.6))
    named = []
    for (sketch, ax), (name, count, note, places) in zip(panels.T, PANELS, strict=True):
        sketch.set_title(name, fontweight="bold")
        _sketch(sketch, CASES[places[0][0]][0], count)
        named.append(_curves(ax, table, places, note))
    panels[1, 0].set_ylabel("|error of the first frequency|")
    for ax, labels in zip(panels[1], named, strict=True):
        label_along(ax, labels)


def _curves(
    ax: Axes, table: xarray.Dataset, places: tuple[Place, ...], note: str
) -> list[tuple[Line2D, str, float, Literal["above", "below"]]]:
    labels = []
    for case, rule, text, at, side in places:
        line = 100 * abs(table.relative_error.sel(case=case, rule=rule).dropna("segments"))
        look = method_style(rule) | ({"linestyle": (0, (4, 1.5))} if "middle" in case else {})
        labels.append((*ax.plot(line.segments, line, **look), text, at, side))
    ax.set(xscale="log", yscale="log", xlim=(3.5, 230), ylim=(1e-6, 20), xlabel="number of segments N")
    plain_ticks(ax, [4, 10, 30, 100, 200], 10.0 ** np.arange(-6, 2), unit=" %")
    ax.text(0.05, 0.04, note, transform=ax.transAxes, va="bottom", fontsize=10)
    return labels


def _sketch(ax: Axes, beam: bm.Beam, count: int) -> None:
    """Draw EI(x) above a chain of rods with its hinges."""
    x = np.linspace(0, 1, 401)
    ax.fill_between(x, value_at(beam.bending_stiffness, x, -1), color=GREY, alpha=0.35, linewidth=0)
    hinges = np.arange(count) / count
    ax.plot([0, 1], [-0.4, -0.4], color="black", linewidth=3, solid_capstyle="butt")
    ax.plot(hinges, np.full(count, -0.4), "o", color="white", markeredgecolor="black", markersize=6)
    ax.plot([-0.035, -0.035], [-0.68, -0.12], color="black", linewidth=4, solid_capstyle="butt")
    ax.text(0.03, 0.12, "EI(x)", fontsize=10)
    for step in beam.breaks:
        ax.axvline(step, color=COLOURS[1], linewidth=1.0, linestyle=(0, (3, 2)))
    ax.set(xlim=(-0.05, 1.04), ylim=(-0.75, 1.08), xticks=[], yticks=[])
    ax.grid(visible=False)
    for spine in ax.spines.values():
        spine.set_visible(False)


STUDY = Study(
    name="nonuniform",
    title="Varying stiffness: a taper costs no order, a step does; put a hinge on every step",
    caption="Beams whose stiffness varies: a taper costs no order, a step does unless a hinge stands on it.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("case", "rule", "segments", "relative_error"), {"relative_error": Kind(decimals=11)}),
        "_catheter.csv": Sheet(
            ("rule", "parts", "mode", "catheter_error"), {"catheter_error": Kind(decimals=11)}
        ),
    },
    size=(9.0, 5.4),
    seconds=6.0,
)
