"""The law in space: errors of straight, pretwisted, curved and helical rods fall with their rule's order.

Each rod is clamped at s = 0, one metre long, thin (no polar inertia, so that twist stores energy but makes no
modes of its own). The errors are the largest of the first three modes, against the exact rod.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

_WIRE = MappingProxyType({"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 1.0})

#: Of unit length; in the title of each panel.
RODS: Mapping[str, bm.Rod] = MappingProxyType(
    {
        "straight, round": bm.Rod(1.0, **_WIRE),
        "pretwisted by 90°, EI ratio 16": bm.Rod.pretwisted(
            math.pi / 2, length=1.0, second_bending_stiffness=16 * 1.3, **_WIRE
        ),
        "arc of 90°, round": bm.Rod.arc(math.pi / 2, length=1.0, **_WIRE),
        "helix of one turn, round": bm.Rod(1.0, curvature=(1.0, 0.0, 2 * math.pi), **_WIRE),
    }
)
RULES, MODES = ("naive", "half_stub", "gregory"), 3
SEGMENTS = (5, 6, 7, 8, 10, 12, 14, 17, 20, 24, 28, 34, 40)
#: The measured order is the slope between these.
BETWEEN = (20, 40)
#: Errors of solved frequencies are good to 1e-11 (`rod_errors`).
DECIMALS = 11

_PLACES: tuple[tuple[str, float, Literal["above", "below"]], ...] = (
    ("naive", 22, "above"),
    ("half_stub", 22, "above"),
    ("gregory", 25, "above"),
)


def data(progress: Progress) -> xarray.Dataset:
    """Return the largest error of the first modes by rod, rule and N, and the order measured from them."""
    tables = []
    for done, rod in enumerate(RODS.values(), start=1):
        table = bm.rod_error_dataset(rod, "clamped-free", segments=SEGMENTS, modes=MODES, rule=RULES)
        tables.append(abs(table.relative_error).max("mode"))
        progress(done, len(RODS))
    largest = xarray.concat(tables, xarray.IndexVariable("rod", list(RODS)))
    few, many = (largest.sel(segments=count) for count in BETWEEN)
    order = np.log(few / many) / math.log(BETWEEN[1] / BETWEEN[0])
    return xarray.Dataset({"largest_error": largest, "order": order.drop_vars("segments", errors="ignore")})


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw sizes on logarithmic axes, a panel a rod, with the measured order along each line."""
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for ax, name in zip(panels.flat, table.rod.values, strict=True):
        ax.set(xscale="log", yscale="log", ylim=(5e-6, 60), xlim=(4.7, 43))
        ax.set_title(name)
        for rule in table.rule.values:
            line = 100 * table.largest_error.sel(rod=name, rule=rule)
            ax.plot(line.segments, line, marker="o", **_style(rule))
        plain_ticks(ax, [5, 10, 20, 40], [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1, 10], unit=" %")
    for ax in panels[1]:
        ax.set_xlabel("number of segments N")
    for ax in panels[:, 0]:
        ax.set_ylabel(f"largest |error| of modes 1 to {MODES}")
    for ax, name in zip(panels.flat, table.rod.values, strict=True):
        _label(table.order.sel(rod=name), ax)
    panels[0, 0].annotate(
        "the error changes\nits sign here",
        (14, 100 * float(table.largest_error.sel(rod=table.rod[0], rule="gregory", segments=14))),
        (-12, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        color=GREY,
        fontsize=10,
    )


def _style(rule: str) -> dict[str, object]:
    # In grey, as elsewhere, the middle one would be the palest of three.
    return {**method_style(rule), "linestyle": "-", "linewidth": 2.0} | (
        {"color": COLOURS[2]} if method_style(rule)["color"] == GREY else {}
    )


def _label(order: xarray.DataArray, ax: Axes) -> None:
    lines = dict(zip(order.rule.values.tolist(), ax.get_lines(), strict=True))
    label_along(
        ax,
        [
            (lines[rule], f"{rule}, order {float(order.sel(rule=rule)):.2f}", at, side)
            for rule, at, side in _PLACES
        ],
        size=10.0,
    )


STUDY = Study(
    name="rods_in_space",
    title="One law in space: each rule keeps its order on twisted and curved rods",
    caption="Largest error of the first three frequencies of straight, pretwisted, curved and helical rods "
    "against N by three rules, with orders measured from N = 20 to 40.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("rod", "rule", "segments", "largest_error"), {"largest_error": Kind(decimals=DECIMALS)}
        ),
        "_orders.csv": Sheet(("rod", "rule", "order"), {"order": Kind(decimals=2)}),
    },
    size=(9.0, 7.4),
)
