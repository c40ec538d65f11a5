"""Datasets on axes, and labels beside their lines. Nothing here changes matplotlib's settings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from beammodes.views.symbols import COLOURS, GREY

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

__all__ = [
    "NUMBER_MAP",
    "label_along",
    "label_line",
    "mark_exact",
    "mark_point",
    "method_style",
    "places_along",
    "plain_ticks",
    "plot_errors",
    "plot_number_map",
    "plot_step_constants",
]

#: Colours of `plot_number_map`: they darken steadily, so no two are confused whatever one's eyes.
NUMBER_MAP = "YlGnBu"
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")

# Those that tell the story have a colour; the rest stay grey, apart by their dashes. A new one is black.
_LOOKS: dict[str, tuple[str, str | tuple[int, tuple[int, ...]]]] = {
    "mitiguy": (COLOURS[0], "-"),
    "gregory": (COLOURS[1], "-"),
    "half_stub_corrected": (COLOURS[2], (0, (5, 1))),
    "rigid_stub": (COLOURS[3], (0, (5, 1))),
    "naive": (COLOURS[4], "-"),
    "hencky": (COLOURS[5], "-"),
    "matched": (COLOURS[6], "-"),
    "double_wall": (GREY, (0, (4, 2))),
    "half_stub": (GREY, (0, (1, 1))),
    "gregory2": (GREY, "-"),
    "rigid_stub_corrected": (GREY, (0, (6, 2, 1, 2))),
    "simpson": ("#7B3FA0", "-"),
    "cubic finite elements": (COLOURS[6], (0, (2, 1))),
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


def method_style(name: str) -> dict[str, Any]:
    """Return colour, dashes and width in which every figure draws a rule, or a method that is none.

    Examples
    --------
    >>> method_style("matched(3)")["color"]
    '#000000'
    """
    colour, dashes = _LOOKS.get(name.split("(")[0], (COLOURS[6], (0, (4, 1, 1, 1))))
    return {"color": colour, "linestyle": dashes, "linewidth": 1.1 if colour == GREY else 2.0}


def places_along(
    ax: Axes, lines: Mapping[str, Line2D], places: Mapping[str, tuple[float, Literal["above", "below"]]]
) -> list[tuple[Line2D, str, float, Literal["above", "below"]]]:
    """Return what `label_along` takes; a line without a place of its own is named halfway along what shows.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> (line,) = ax.loglog([1, 10, 100], [1.0, 0.1, 0.01])
    >>> [place[1:] for place in places_along(ax, {"own": line}, {})]
    [('own', 10.0, 'above')]
    """
    low, high = ax.get_xlim()
    found: list[tuple[Line2D, str, float, Literal["above", "below"]]] = [
        (lines[name], name, at, side) for name, (at, side) in places.items()
    ]
    for name, line in lines.items():
        x = np.asarray(line.get_xdata(), dtype=float)
        shown = np.sort(x[(x >= low) & (x <= high)])
        if name not in places and len(shown):
            found.append((line, name, float(shown[len(shown) // 2]), "above"))
    return found


def label_along(
    ax: Axes, labels: Iterable[tuple[Line2D, str, float, Literal["above", "below"]]], *, size: float = 9.0
) -> None:
    """Write each text along its line, in its colour and at its slope, centred on a horizontal value.

    Call it last: a later change of limits or layout would turn the lines under their texts.
    """
    from matplotlib.patheffects import withStroke

    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()  # settles the layout, which slopes on the page depend on
    for line, text, at, side in labels:
        values = np.column_stack([np.asarray(part, dtype=float) for part in line.get_data()])
        centre = ax.transData.transform((at, values[0, 1]))[0]
        x = centre + np.array([-25.0, 0.0, 25.0])
        y = np.interp(x, *ax.transData.transform(values).T)
        angle = float(np.degrees(np.arctan2(y[2] - y[0], x[2] - x[0])))
        away = np.radians(angle + (90 if side == "above" else -90))
        ax.annotate(
            text,
            tuple(ax.transData.inverted().transform((x[1], y[1]))),
            xytext=(0.75 * size * np.cos(away), 0.75 * size * np.sin(away)),
            textcoords="offset points",
            rotation=angle,
            rotation_mode="anchor",
            ha="center",
            va="center_baseline",
            fontsize=size,
            color=line.get_color(),
            path_effects=[withStroke(linewidth=1.5, foreground="white")],
        ).set_in_layout(False)


def plain_ticks(
    ax: Axes, x: Sequence[float] | None = None, y: Sequence[float] | None = None, *, unit: str = ""
) -> None:
    """Put ticks at these values only, written as plain numbers, those of y with a unit.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> plain_ticks(ax, [1, 10], [-1e-5, 0.1], unit=" %")
    >>> [text.get_text() for text in (*ax.get_xticklabels(), *ax.get_yticklabels())]
    ['1', '10', '−0.00001 %', '0.1 %']
    """
    for axis, values, after in ((ax.xaxis, x, ""), (ax.yaxis, y, unit)):
        if values is not None:
            numbers = [np.format_float_positional(value, 9, trim="-").replace("-", "−") for value in values]
            axis.set_ticks(values, [f"{number}{after}" for number in numbers])
    ax.minorticks_off()


def mark_point(
    ax: Axes, line: Line2D, at: float, text: str, *, offset: tuple[float, float] = (6.0, 5.0)
) -> None:
    """Put a dot on a line at the horizontal value `at`, and bold text beside it, on the offset's side."""
    from matplotlib.patheffects import withStroke

    colour, (x, y) = line.get_color(), line.get_data()
    point = (at, float(np.interp(at, np.asarray(x), np.asarray(y))))
    ax.plot(*point, "o", color=colour, markersize=6, zorder=5)
    ax.annotate(
        text,
        point,
        offset,
        textcoords="offset points",
        ha="left" if offset[0] > 0 else "right",
        color=colour,
        fontweight="bold",
        path_effects=[withStroke(linewidth=2, foreground="white")],
    )


def mark_exact(ax: Axes, at: float, top: float, text: str) -> None:
    """Draw an arrow from `top` to the foot of a logarithmic axis, which has no place for an error of zero."""
    foot, style = ax.get_ylim()[0], method_style("matched")
    ax.plot([at, at], [top, foot], **style)
    ax.plot(at, foot * 1.15, "v", color=style["color"], markersize=9, clip_on=False)
    ax.annotate(text, (at, foot), (8, 5), textcoords="offset points", fontsize=10, va="bottom")


def plot_number_map(
    numbers: xarray.DataArray, groups: xarray.DataArray, ax: Axes, *, limits: tuple[float, float]
) -> None:
    """Draw positive numbers as a map: colour on a logarithmic scale, and the number in each cell.

    Parameters
    ----------
    numbers : xarray.DataArray
        Of two dimensions: rows, columns.
    groups : xarray.DataArray
        Neighbours in a row that have the same value here share one cell.
    ax : matplotlib.axes.Axes
    limits : tuple of float
        Numbers at the two ends of the colour scale.
    """
    import matplotlib
    from matplotlib.colors import LogNorm
    from matplotlib.patches import Rectangle

    shade, place = matplotlib.colormaps[NUMBER_MAP], LogNorm(*limits, clip=True)
    rows, columns = numbers.shape
    for i in range(rows):
        start = 0
        for j in range(1, columns + 1):
            if j < columns and groups.values[i, j] == groups.values[i, start]:
                continue
            value = numbers.values[i, start]
            colour = shade(float(place(value)))
            ax.add_patch(
                Rectangle((start, i), j - start, 1, facecolor=colour, edgecolor="white", linewidth=1.5)
            )
            dark = float(np.dot(colour[:3], (0.299, 0.587, 0.114))) < 0.5
            place_of = ((start + j) / 2, i + 0.5)
            ax.text(*place_of, f"{value:g}", ha="center", va="center", color="white" if dark else "black")
            start = j
    ax.set(xlim=(0, columns), ylim=(rows, 0))
    ax.set_xticks(np.arange(columns) + 0.5, [str(name) for name in numbers[numbers.dims[1]].values])
    ax.set_yticks(np.arange(rows) + 0.5, [str(name) for name in numbers[numbers.dims[0]].values])
    ax.tick_params(length=0)
    ax.grid(visible=False)
    for spine in ax.spines.values():
        spine.set_visible(False)


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
