"""Each simulator's layout at a clamped end, its error, and the springs that correct it."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from beammodes.views.symbols import COLOURS, GREY
from studies.study import Kind, Progress, Sheet, Study
from studies.tool_layouts import Tool, springs_at_the_wall, tools

SEGMENTS = np.unique(np.geomspace(3, 60, 24).astype(int).clip(3))
MARKED, DRAWN = 10, 4
VERSIONS = ("as is", "mended")
AS_IS, MENDED, HELD = COLOURS[0], COLOURS[1], "#CCCCCC"
END = DRAWN + 0.6
POWERS = {1: "", 2: "²", 3: "³", 4: "⁴"}


def data(progress: Progress) -> xarray.Dataset:
    """Return errors of a cantilever's first frequency by tool, and the springs near the wall at N = 10."""
    segments = np.union1d(SEGMENTS, MARKED)
    error = np.empty((len(tools()), len(VERSIONS), len(segments)))
    spring = np.full((len(tools()), len(VERSIONS), DRAWN), "", dtype=object)
    for i, tool in enumerate(tools()):
        error[i] = tool.as_is(segments), tool.mended(segments)
        for j, rule in enumerate(tool.springs or ()):
            spring[i, j] = [str(value) for value in springs_at_the_wall(rule, MARKED, DRAWN)]
        progress(i + 1, len(tools()))
    return xarray.Dataset(
        {
            "relative_error": (("tool", "version", "segments"), error),
            "spring": (("tool", "version", "hinge"), spring.astype(str)),
        },
        coords={
            "tool": [tool.name for tool in tools()],
            "version": list(VERSIONS),
            "segments": segments,
            "hinge": range(1, DRAWN + 1),
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw a picture of each layout near the wall, and its error against N before and after."""
    panels = figure.subplots(len(tools()), 2, width_ratios=(1.45, 1), squeeze=False)
    for tool, (left, right) in zip(tools(), panels, strict=True):
        one = table.sel(tool=tool.name)
        _layout(tool, one, left)
        _errors(tool, one, right)
    panels[0, 0].set_title(
        "circles: hinges; numbers: their springs at N = 10, in EI/ℓ", fontsize=10, loc="left"
    )
    panels[0, 1].set_title("|error| of the first frequency, and at N = 10", fontsize=10, loc="left")
    for ax in panels[:-1, 1]:
        ax.tick_params(labelbottom=False)
    panels[-1, 1].set_xlabel("number of segments N")


def _layout(tool: Tool, one: xarray.Dataset, ax: Axes) -> None:
    ax.set(xlim=(-1.35, DRAWN + 0.75), ylim=(-1.75, 1.25))
    ax.axis("off")
    ax.text(-1.35, 0.95, tool.name, fontweight="bold", va="center")
    ax.text(DRAWN + 0.7, 0.95, tool.wall, ha="right", va="center", fontsize=10)
    ax.add_patch(Rectangle((-0.25, -0.5), 0.25, 1.0, facecolor=HELD, hatch="///", edgecolor=GREY))
    hinges = np.arange(DRAWN) + tool.stub
    (_beams if tool.masses == "beams" else _rods)(tool, hinges, ax)
    rows = zip(VERSIONS, tool.ways, (AS_IS, MENDED), (-0.9, -1.45), strict=True)
    for version, way, colour, y in rows:
        ax.text(-1.35, y, version, color=colour, va="center", fontsize=10)
        ax.text(0.0, y, way, color=colour, va="center", fontsize=10)
        for x, spring in zip(hinges, one.spring.sel(version=version).values, strict=True):
            ax.text(x, y, str(spring), color=colour, ha="center", va="center", fontsize=10)


def _rods(tool: Tool, hinges: NDArray[np.float64], ax: Axes) -> None:
    """Draw rods or point masses on bars, the part that the wall holds in grey, and hinges."""
    thick = 1.5 if tool.masses == "points" else 5
    ax.plot([tool.stub, END], [0, 0], color=AS_IS, linewidth=thick, solid_capstyle="butt")
    ax.plot([0, tool.stub], [0, 0], color=GREY, linewidth=max(thick, 3), solid_capstyle="butt")
    if tool.masses == "points":
        nodes = np.arange(int(tool.stub), DRAWN + 1)
        ax.plot(nodes, 0 * nodes, "o", color=AS_IS, markersize=11, zorder=3)
    shown = hinges[hinges < END]
    ax.plot(shown, 0 * shown, "o", color="black", markerfacecolor="white", markersize=6, zorder=4)


def _beams(tool: Tool, hinges: NDArray[np.float64], ax: Axes) -> None:
    """Draw rods, the one that the wall holds in grey, and the massless beams that join their middles."""
    for left in (0.0, *hinges):
        colour = AS_IS if left >= tool.stub else GREY
        width = min(left + 1.0, END) - left - 0.12
        ax.add_patch(Rectangle((left + 0.06, -0.16), width, 0.32, facecolor=colour, alpha=0.35))
    middles = np.append(0.5, hinges + 0.5)
    ax.plot([0.5, END], [0, 0], color="black", linewidth=1.2)
    ax.plot(middles, 0 * middles, "o", color="black", markersize=4)
    ax.plot([0, 0.5], [0, 0], color=MENDED, linewidth=1.6)


def _errors(tool: Tool, one: xarray.Dataset, ax: Axes) -> None:
    for version, colour, order in zip(VERSIONS, (AS_IS, MENDED), tool.orders, strict=True):
        line = 100 * one.relative_error.sel(version=version)
        value = float(line.sel(segments=MARKED))
        ax.plot(line.segments, abs(line), color=colour)
        ax.plot(MARKED, abs(value), "o", color=colour, markersize=6)
        falls = f"falls as 1/N{POWERS[order]}"
        note = partial(ax.annotate, xy=(MARKED, abs(value)), textcoords="offset points", color=colour)
        if version == VERSIONS[0]:
            note(f"{value:+.3g} %", xytext=(6, 2), va="bottom", fontweight="bold", fontsize=10)
            note(falls, xytext=(66, 2), va="bottom", fontsize=9)
        else:
            note(f"{value:+.3g} %", xytext=(-6, -3), va="top", ha="right", fontweight="bold", fontsize=10)
            note(falls, xytext=(-6, -16), va="top", ha="right", fontsize=9)
    ax.set(xscale="log", yscale="log", xlim=(3, 60), ylim=(3e-7, 400))
    ax.set_xticks([3, 5, 10, 20, 50], ["3", "5", "10", "20", "50"])
    ax.set_yticks([1e-4, 1e-2, 1, 100], ["0.0001 %", "0.01 %", "1 %", "100 %"], fontsize=9)
    ax.minorticks_off()


STUDY = Study(
    name="simulators",
    title="A cantilever in your simulator: its layout at the wall, its error, what mends it",
    caption="Each simulator's layout at a clamped end, its error against N, and what corrects it.",
    data=data,
    draw=draw,
    sheets={
        # Errors of the tools that are no rule come rounded, from dense solvers.
        ".csv": Sheet(
            ("tool", "version", "segments", "relative_error"), {"relative_error": Kind(decimals=9, some=True)}
        ),
        "_springs.csv": Sheet(("tool", "version", "hinge", "spring")),
    },
    size=(9.0, 9.6),
)
