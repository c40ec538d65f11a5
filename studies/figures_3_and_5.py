"""Figures 3 and 5 of the report: a beam clamped to one rigid body that is free to move, and to two."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import GREY, ROD, SPRING
from studies.common import mode_shapes, picture
from studies.plots import label_along, method_style
from studies.study import Kind, Progress, Sheet, Study

#: The report gives its body no numbers; these are chosen: a square block as heavy as the beam, the beam
#: clamped to the middle of one side. In units of the beam's mass and length.
SIDE = 0.2
BODY = bm.End(mass=1.0, rotary_inertia=SIDE**2 / 6, offset=SIDE / 2)
ONE_BODY, TWO_BODIES = bm.Boundary(BODY, bm.ENDS["free"]), bm.Boundary(BODY, BODY)
DRAWN, MODES = 4, 3
RULES = ("mitiguy", "gregory")
COLUMNS = (
    "held_by",
    "rule",
    "segments",
    "mode",
    "angular_frequency",
    "exact_angular_frequency",
    "relative_error",
)
# Largest deflection drawn, in lengths of the beam.
AMPLITUDE = 0.2
# Where the lines of each mode are named: mitiguy, gregory, and mitiguy on walls.
Places = tuple[tuple[float, Literal["above", "below"]], ...]
ONE_PLACES: tuple[Places, ...] = (
    ((13.5, "above"), (14.5, "above"), (14, "below")),
    ((14, "above"), (15, "below"), (13, "below")),
    ((13, "above"), (12, "above"), (14, "below")),
)
TWO_PLACES: tuple[Places, ...] = (
    ((13.5, "above"), (14.5, "below"), (13, "below")),
    ((13.5, "above"), (13, "below"), (13, "below")),
    ((4.6, "below"), (9.5, "above"), (13, "below")),
)


def data(progress: Progress, boundary: bm.Boundary, wall: str) -> xarray.Dataset:
    """Return errors for N = 1..20 on free bodies and on fixed walls; mode shapes for N = 4 on free bodies."""
    tables = []
    for i, pair in enumerate((boundary, wall)):
        table = bm.error_dataset(boundary=[pair], segments=range(1, 21), modes=MODES, rule=RULES)
        tables.append(table.squeeze("boundary", drop=True))
        progress(i + 1, 2)
    errors = xarray.concat(tables, "held_by").assign_coords(held_by=["free body", "fixed wall"])
    chain = bm.Chain(bm.Beam.unit(), boundary, DRAWN)
    return errors.merge(mode_shapes(chain, MODES))


def draw(
    table: xarray.Dataset,
    figure: Figure,
    boundary: bm.Boundary,
    bodies: str,
    places: tuple[Places, ...],
) -> None:
    """Draw the chain, its first modes over the beam's, and their errors against N."""
    figure.get_layout_engine().set(wspace=0.06)
    chain = bm.Chain(bm.Beam.unit(), boundary, DRAWN)
    grid = figure.add_gridspec(3, MODES, height_ratios=[0.75, 1.25, 2.5])
    _draw_system(figure.add_subplot(grid[0, :]), chain, bodies)
    panels: list[Axes] = []
    for column, mode in enumerate(table.mode.values):
        one = table.sel(mode=mode)
        _draw_mode(figure.add_subplot(grid[1, column]), chain, one)
        first = panels[0] if panels else None
        panels.append(figure.add_subplot(grid[2, column], sharex=first, sharey=first))
        panels[-1].tick_params(labelleft=first is None)
        _draw_errors(panels[-1], one)
    panels[0].set_ylabel("frequency error  [%]")
    panels[0].text(20.5, 130, "chain too stiff", color=GREY, ha="right", va="top", fontsize=10)
    panels[0].text(20.5, -50, "chain too soft", color=GREY, ha="right", va="bottom", fontsize=10)
    note = "vertical axis: signed errors, linear within ±0.1 %, logarithmic beyond"
    figure.supxlabel(note, fontsize=10, color=GREY, x=0.99, ha="right")
    names = ("mitiguy (report)", "gregory", "mitiguy, fixed wall" + "s" * (boundary.right == BODY))
    for ax, where in zip(panels, places, strict=True):
        _, still, *rules = ax.get_lines()
        lines = zip((*rules, still), names, where, strict=True)
        label_along(ax, [(line, name, *place) for line, name, place in lines], size=10)


def _draw_system(ax: Axes, chain: bm.Chain, bodies: str) -> None:
    bm.draw_chain(chain, ax, size=11)
    ax.text(1.4, 0.12, "report's springs (rule mitiguy) in EI/ℓ, ℓ = L/4", va="bottom", color=SPRING)
    text = f"Numbers chosen here: {bodies}.\nFrequencies ω are in √(EI/ρAL⁴)."
    ax.text(1.4, 0.09, text, va="top", fontsize=10, linespacing=1.35)
    picture(ax, (-0.24, 3.15), (-0.13, 0.22))


def _draw_mode(ax: Axes, chain: bm.Chain, one: xarray.Dataset) -> None:
    ax.plot([0, 1], [0, 0], color=GREY, linewidth=0.7, zorder=0)
    ax.plot(one.x, AMPLITUDE * one.curve, color="black", linewidth=1.3, zorder=3.5)
    shape = (AMPLITUDE * one.deflection.values, AMPLITUDE * one.rotation.values)
    bm.draw_chain(chain, ax, shape=shape, labels=None)
    picture(ax, (-0.24, 1.24), (-0.39, 0.27))
    unit = bm.Beam.unit().frequency_unit / (2 * np.pi)
    error = 100 * float(one.frequency / one.exact_frequency - 1)
    ax.set_title(f"mode {int(one.mode)}", fontweight="bold")
    ax.set_title(f"chain of {DRAWN}: {error:+.1f} %".replace("-", "−"), loc="right", color=ROD)
    text = f"exact beam (black): ω = {float(one.exact_frequency) / unit:.4g}"
    ax.text(0.5, -0.375, text, ha="center", fontsize=10).set_in_layout(False)


def _draw_errors(ax: Axes, one: xarray.Dataset) -> None:
    percent = 100 * one.relative_error
    ax.axhline(0.0, color="#555555", linewidth=0.8)
    wall = percent.sel(held_by="fixed wall", rule="mitiguy").dropna("segments")
    ax.plot(wall.segments, wall, color=GREY, linestyle=(0, (4, 2)), linewidth=1.3)
    for rule in RULES:
        line = percent.sel(held_by="free body", rule=rule).dropna("segments")
        ax.plot(line.segments, line, marker="o", markersize=3.5, **method_style(rule))
    ax.set_yscale("symlog", linthresh=0.1, linscale=0.6)
    ax.set_yticks([-10, -1, -0.1, 0, 0.1, 1, 10], ["−10", "−1", "−0.1", "0", "0.1", "1", "10"])
    ax.set(xlim=(0, 20.8), ylim=(-60, 160), xticks=range(0, 21, 5), xlabel="number of segments N")
    ax.minorticks_off()


def _study(
    name: str, title: str, boundary: bm.Boundary, wall: str, bodies: str, places: tuple[Places, ...]
) -> Study:
    words = name.replace("_", " ").capitalize()
    # At a node of symmetry a shape is zero, or rounding.
    rounded = {"deflection": Kind(decimals=12), "exact_deflection": Kind(decimals=12)}
    return Study(
        name=name,
        title=f"{words} · {title} free to move",
        caption=f"{words} of the report: a {title} free to move.",
        data=partial(data, boundary=boundary, wall=wall),
        draw=partial(draw, boundary=boundary, bodies=bodies, places=places),
        sheets={
            ".csv": Sheet(COLUMNS),
            "_shapes.csv": Sheet(("mode", "node", "position", "deflection", "exact_deflection"), rounded),
        },
        size=(9.0, 6.6),
    )


FIGURE_3 = _study(
    "figure_3",
    "beam clamped to a rigid body that is",
    ONE_BODY,
    "clamped-free",
    "the body is a square block\nof side 0.2 L, as heavy as the beam",
    ONE_PLACES,
)
FIGURE_5 = _study(
    "figure_5",
    "beam clamped to two rigid bodies that are",
    TWO_BODIES,
    "clamped-clamped",
    "each body is a square\nblock of side 0.2 L, as heavy as the beam",
    TWO_PLACES,
)
