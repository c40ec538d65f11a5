"""Datasets on axes. Nothing here computes physics, opens a window or changes matplotlib's settings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

__all__ = ["COLOURS", "STYLE", "label_line", "plot_errors", "plot_step_constants"]

#: Okabe and Ito's colours, which the colour-blind can tell apart; source: Color Universal Design (2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")

#: Settings for `matplotlib.rc_context` under which the project's figures are drawn.
STYLE: dict[str, object] = {
    "font.size": 11,
    "font.family": "DejaVu Sans",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.6,
    "lines.markersize": 4.5,
    "svg.hashsalt": "beammodes",
    "svg.fonttype": "path",
}


def plot_errors(table: xarray.Dataset, ax: Axes, *, magnitude: bool = False) -> None:
    """Draw percent error against N, one line a mode, in ascending order.

    Parameters
    ----------
    table : xarray.Dataset
        From `error_dataset` or `derived_error_dataset`, one rule and one boundary.
    ax : matplotlib.axes.Axes
    magnitude : bool
        Draw |error| on logarithmic axes instead of the signed error on linear ones.
    """
    error = 100 * table.relative_error.squeeze(["rule", "boundary"])
    for colour, marker, mode in zip(COLOURS, _MARKERS, error.mode.values, strict=False):
        line = error.sel(mode=mode).dropna("segments")
        values = abs(line) if magnitude else line
        ax.plot(line.segments, values, color=colour, marker=marker)
    ax.set_xlabel("number of segments N")
    if magnitude:
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_ylabel("|frequency error|  [%]")
    else:
        ax.axhline(0.0, color="#555555", linewidth=0.8)
        ax.set_ylabel("frequency error  [%]")


def label_line(
    ax: Axes,
    line: Line2D,
    text: str,
    *,
    point: int = -1,
    offset: tuple[float, float] = (8.0, 0.0),
    ha: Literal["left", "center", "right"] = "left",
    va: Literal["bottom", "center", "top"] = "center",
) -> None:
    """Write `text` in a line's colour beside one of its points, `offset` in typographic points."""
    x, y = (float(np.asarray(values)[point]) for values in line.get_data())
    ax.annotate(text, (x, y), xytext=offset, textcoords="offset points", color=line.get_color(), ha=ha, va=va)


def plot_step_constants(constants: xarray.Dataset, chains: xarray.Dataset, ax: Axes) -> None:
    """Draw the report's C against the modes that it names, and the chain's own C against N.

    Parameters
    ----------
    constants : xarray.Dataset
        Variables C_published and C_single_mode over the dimension modes.
    chains : xarray.Dataset
        Variable C_chain over boundary and segments.
    ax : matplotlib.axes.Axes
        Its horizontal axis counts modes for the former and segments for the latter: a chain of N segments
        has about N modes, so these are the steps for following all the modes that it has.
    """
    ax.plot(constants.modes, constants.C_published, color=COLOURS[1], marker="s")
    ax.plot(constants.modes, constants.C_single_mode, color=COLOURS[4], marker="D")
    for colour, boundary in zip((COLOURS[0], COLOURS[2]), chains.boundary.values, strict=False):
        line = chains.C_chain.sel(boundary=boundary).dropna("segments")
        ax.plot(line.segments, line, color=colour, marker="o")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("number of modes (report), number of segments N (chain)")
    ax.set_ylabel("C in  h = C L² √(ρA/EI)")
