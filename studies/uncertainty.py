"""Figures 6 and 7 of the report over what the beam's own material and dimensions leave open."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

import beammodes as bm
from beammodes.views.symbols import GREY
from studies.plots import method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

FIGURES = {"clamped-free": "Figure 6", "clamped-clamped": "Figure 7"}
RULES, MODES, SAMPLES, FRACTION = ("mitiguy", "gregory"), 3, 10_000, 1 / 3
SPREAD = ("frequency", "standard_deviation", "standard_deviation_error", "first_order", "half_width")


class Bar(NamedTuple):
    """A beam of rectangular section, what is known of it, and how well."""

    section: bm.Rectangle
    numbers: dict[str, float]
    tolerances: dict[str, float | bm.Tolerance]
    text: str


def _report_modulus(material: str) -> tuple[float, float]:
    """Return middle and half width of a modulus in the report's table, the latter as a fraction.

    A range is what it says; a single number is rounded to whole millions of lbf/in².
    """
    line = bm.MODULI[material]
    low, high = (line.low, line.high) if line.is_range else (line.low - 0.5, line.high + 0.5)
    middle = bm.elastic_modulus(material, at=0.5 if line.is_range else None)
    return middle, (high - low) / (high + low)


def _bar(material: str, section: bm.Rectangle, rest: dict[str, float], text: str, **known: float) -> Bar:
    modulus, width = _report_modulus(material)
    return Bar(section, {"elastic_modulus": modulus, **rest}, {"elastic_modulus": width, **known}, text)


#: Moduli as the report's table has them; the other tolerances are illustrative, those of the steel bar's
#: thickness and width of the size that hot-rolled flat bars have: ±0.5 mm and ±1 mm. All uniform.
BARS = {
    "wooden board": _bar(
        "wood",
        bm.Rectangle(width=0.1, height=0.025),
        {"density": 500.0, "length": 2.0},
        "E 1 to 2 million lbf/in² (report's range), thickness 25 ± 0.5 mm, density ± 10 %",
        density=0.1,
        height=0.5 / 25,
        length=1 / 2000,
    ),
    "rolled steel bar": _bar(
        "steel",
        bm.Rectangle(width=0.06, height=0.02),
        {"density": 7850.0, "length": 1.0},
        "E 30 ± 0.5 million lbf/in² (report, rounded), thickness 20 ± 0.5 mm, density ± 1 %",
        density=0.01,
        width=1 / 60,
        height=0.5 / 20,
        length=1 / 1000,
    ),
}


def data(progress: Progress) -> xarray.Dataset:
    """Return errors for N = 1..40, the spread of two beams' frequencies, and how many segments are enough."""
    errors = bm.error_dataset(boundary=list(FIGURES), segments=range(1, 41), modes=MODES, rule=RULES)
    by_beam = []
    for i, bar in enumerate(BARS.values()):
        by_ends = []
        for j, boundary in enumerate(FIGURES):
            spread = bm.frequency_spread(
                bar.section, boundary, bar.tolerances, MODES, samples=SAMPLES, **bar.numbers
            )
            by_ends.append(spread[list(SPREAD)].assign(_enough(spread)))
            progress(i * len(FIGURES) + j + 1, len(BARS) * len(FIGURES))
        by_beam.append(xarray.concat(by_ends, "boundary"))
    spreads = xarray.concat(by_beam, "beam").assign_coords(
        beam=list(BARS), boundary=list(FIGURES), rule=list(RULES)
    )
    return errors[["relative_error"]].merge(spreads)


def _enough(spread: xarray.Dataset) -> dict[str, Any]:
    found = [bm.segments_within_spread(spread, rule, fraction=FRACTION) for rule in RULES]
    return {
        "segments_enough": ("rule", [one.segments for one in found]),
        "largest_error": ("rule", [one.largest_error for one in found]),
        "narrowest": ("rule", [one.half_width for one in found]),
        "said": ("rule", [str(one) for one in found]),
    }


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw |error| of three modes over the beam's own band: a row for each beam, a column for each figure."""
    rows = figure.subfigures(len(BARS), 1)
    for row, (beam, bar) in zip(rows, BARS.items(), strict=True):
        row.suptitle(f"{beam}: {bar.text}", fontsize=10, x=0.01, ha="left", color="#444444")
        panels = row.subplots(1, len(FIGURES))
        for ax, boundary in zip(panels, FIGURES, strict=True):
            _draw_panel(ax, table.sel(beam=beam, boundary=boundary))
            ax.set_title(f"{FIGURES[boundary]}, {boundary}", fontweight="bold")
        panels[0].set_ylabel("|frequency error|  [%]")
    note = (
        "shaded: the beam's own 95 % band and, darker, a third of it; bold: fewest segments that stay\n"
        "in that, for modes 1, 2 and 3 · tolerances of density and dimensions are illustrative"
    )
    figure.supxlabel(note, fontsize=10, color=GREY, x=0.99, ha="right")


def _draw_panel(ax: Axes, one: xarray.Dataset) -> None:
    for rule in RULES:
        for mode in one.mode.values:
            line = 100 * np.abs(one.relative_error.sel(rule=rule, mode=mode)).dropna("segments")
            width = {"linewidth": 0.7 + 0.45 * int(mode)}
            ax.plot(line.segments, line, marker="o", markersize=2.2, **(method_style(rule) | width))
            if rule == RULES[0]:
                highest = 100 * float(np.abs(one.relative_error.sel(mode=mode)).max())
                ax.text(float(line.segments[0]), 1.3 * highest, str(mode), ha="center", fontsize=10)
        _mark_enough(ax, rule, one.sel(rule=rule))
    ax.set(xscale="log", yscale="log", xlim=(0.8, 48), ylim=(0.009, 130), xlabel="number of segments N")
    plain_ticks(ax, [1, 2, 5, 10, 20, 40], [0.01, 0.1, 1, 10, 100])
    _draw_bands(ax, 100 * float(one.narrowest[0]))


def _draw_bands(ax: Axes, band: float) -> None:
    """Shade what the beam leaves open, and the part of it below which an error is hidden."""
    low, _ = ax.get_ylim()
    for top, shade, text in ((band, "#EAEAEA", f"±{band:.2g} %"), (FRACTION * band, "#D3D3D3", "a third")):
        ax.axhspan(low, top, color=shade, zorder=0)
        ax.annotate(text, (1.0, top), (4, 0), ("axes fraction", "data"), "offset points", va="center")


def _mark_enough(ax: Axes, rule: str, one: xarray.Dataset) -> None:
    colour, count = method_style(rule)["color"], int(one.segments_enough)
    at = (count, 100 * float(one.largest_error))
    ax.plot(*at, "o", color=colour, markersize=8, zorder=6)
    above, far = rule == RULES[0], count > 20
    ax.annotate(
        f"{rule}: {count}",
        at,
        ((0, 32) if far else (-6, 11)) if above else (-7, -6),
        textcoords="offset points",
        ha="center" if above and far else "left" if above else "right",
        va="bottom" if above else "top",
        color=colour,
        fontweight="bold",
        path_effects=[withStroke(linewidth=2.5, foreground="white")],
        zorder=7,
    )


STUDY = Study(
    name="uncertainty",
    title="Figures 6 and 7 over what the beam itself leaves open",
    caption="Figures 6 and 7 of the report over the spread of frequencies from a beam's own tolerances.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("boundary", "rule", "segments", "mode", "relative_error")),
        # Differences leave rounding in the last digits.
        "_spread.csv": Sheet(("beam", "boundary", "mode", *SPREAD), {"first_order": Kind(decimals=9)}),
        "_enough.csv": Sheet(("beam", "boundary", "rule", "segments_enough", "largest_error", "narrowest")),
    },
    size=(9.0, 8.6),
)
