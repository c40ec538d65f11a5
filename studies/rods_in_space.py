"""Rods in space: the rules' orders hold for any shape at rest; what the order of three hinges costs."""

from __future__ import annotations

import math

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.numerics.rotations import rotation
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, method_style, places_along, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BOUNDARY, RULES = "clamped-free", ("naive", "half_stub", "gregory")
# A solid round bar's EI/GJ, 1 + ν.
_ROUND = {"bending_stiffness": 1.0, "torsional_stiffness": 1 / 1.3, "mass_per_length": 1.0}
#: Rods of unit length, none of them with an inertia of its section.
RODS = {
    "straight": bm.Rod(1.0, **_ROUND),
    "pretwisted by 90°": bm.Rod.pretwisted(math.pi / 2, length=1.0, second_bending_stiffness=16.0, **_ROUND),
    "quarter circle": bm.Rod.arc(math.pi / 2, length=1.0, **_ROUND),
    "helix of one turn": bm.Rod(1.0, **_ROUND, curvature=(1.0, 0.0, 2 * math.pi)),
}
#: A narrow cantilever, which a dead force at its tip makes turn over: 4.0126 √(EI GJ)/L² (Timoshenko, Gere).
NARROW = bm.Rod(1.0, 1e8, 1.0, 1.0, second_bending_stiffness=1.0)
LATERAL, LOAD = 4.012599344, bm.SpatialLoad(force=(0.0, -1.0, 0.0))
JOINTS = {
    "ball": "ball joints",
    "yzx": "hinges y, z, x",
    "xyz": "hinges x, y, z",
    "yzx_alternating": "hinges y, z, x and x, z, y in turn",
}
SEGMENTS = (4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40)
#: Where each kind of joints is named: those near zero in the free space below them.
_NAMED = {"ball": (19, -11.0), "yzx": (9.5, 13.0), "xyz": (6.6, -19.0), "yzx_alternating": (19, -15.0)}
#: Of the drawn helix, and the size of its motion over its length.
_DRAWN, _MOVED = 10, 0.1
#: `rod_errors` are good to 1e-11.
LEAST = 1e-10


def data(progress: Progress) -> xarray.Dataset:
    """Return errors of the first frequency of four rods, and of lateral buckling by kind of joints."""
    parts = []
    for done, rod in enumerate(RODS.values()):
        table = bm.rod_error_dataset(rod, BOUNDARY, segments=SEGMENTS, modes=1, rule=RULES)
        parts.append(table.relative_error.isel(mode=0, drop=True))
        progress(done + 1, len(RODS) + 1)
    errors = xarray.concat(parts, xarray.DataArray(list(RODS), dims="rod", name="rod"))
    buckling = [
        [
            bm.critical_factor(
                bm.SpatialChain(NARROW, BOUNDARY, n, "gregory"), LOAD, joints=joints, start=4.0
            )
            / LATERAL
            - 1
            for n in SEGMENTS
        ]
        for joints in JOINTS
    ]
    progress(len(RODS) + 1, len(RODS) + 1)
    table = xarray.Dataset(
        {"relative_error": errors, "buckling_error": (("joints", "segments"), np.array(buckling))},
        coords={"joints": list(JOINTS)},
    )
    return table.assign(relative_error=table.relative_error.where(abs(table.relative_error) > LEAST))


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw |error| against N of each rod, below the errors of joints and a mode of a helix."""
    above, below = figure.subfigures(2, 1, height_ratios=(1, 1.1))
    panels = above.subplots(1, len(RODS), sharex=True, sharey=True)
    for ax, name in zip(panels, table.rod.values, strict=True):
        lines = {}
        for rule in RULES:
            error = 100 * abs(table.relative_error.sel(rod=name, rule=rule).dropna("segments"))
            (lines[rule],) = ax.plot(error.segments, error, **method_style(rule))
        ax.set(xscale="log", yscale="log", xlim=(3.6, 45), ylim=(3e-6, 40), xlabel="segments N")
        ax.set_title(str(name))
        plain_ticks(ax, [4, 10, 20, 40], 10.0 ** np.arange(-5, 2), unit=" %")
        if ax is panels[0]:
            named = places_along(
                ax, lines, {"naive": (12, "above"), "half_stub": (12, "above"), "gregory": (9, "below")}
            )
    panels[0].set_ylabel("|error|, first frequency")
    joints, helix = below.subplots(1, 2, width_ratios=(1.25, 1))
    _joints(joints, table)
    _helix(helix)
    label_along(panels[0], named)


def _joints(ax: Axes, table: xarray.Dataset) -> None:
    looks = {"ball": COLOURS[1], "yzx": COLOURS[0], "xyz": COLOURS[4], "yzx_alternating": "black"}
    for name, words in JOINTS.items():
        error = 100 * table.buckling_error.sel(joints=name)
        ax.plot(error.segments, error, color=looks[name], marker="o", markersize=3.5)
        x, y = _NAMED[name]
        ax.text(x, y, words, color=looks[name], fontsize=10)
    ax.axhline(0.0, color=GREY, linewidth=0.8)
    ax.set(xlim=(3, 41), ylim=(-26, 32), xlabel="segments N", ylabel="error of the buckling load")
    ax.set_title("a narrow beam turns over, by kind of joint")
    plain_ticks(ax, [5, 10, 20, 30, 40], [-20, -10, 0, 10, 20, 30], unit=" %")


def _helix(ax: Axes) -> None:
    """Draw a chain of ten pieces at rest and in its first mode, seen from above and aside."""
    chain = bm.SpatialChain(RODS["helix of one turn"], BOUNDARY, _DRAWN, "gregory")
    modes = bm.spatial_modes(chain, 1)
    shape = modes.displacement[0] * _MOVED / np.abs(modes.displacement[0]).max()
    seen = (rotation(np.array([-1.1, 0.0, 0.0])) @ rotation(np.array([0.0, 0.0, 0.5])))[:2]
    line = chain.rod.frames(np.linspace(0.0, 1.0, 201))[1] @ seen.T
    rest, moved = modes.position @ seen.T, (modes.position + shape) @ seen.T
    ax.plot(*line.T, color=GREY, linewidth=1.0)
    ax.plot(*rest.T, "o", color="white", markeredgecolor=GREY, markersize=4.5)
    ax.plot(*moved.T, color=COLOURS[1], linewidth=2.4, solid_capstyle="round")
    ax.plot(*moved.T, "o", color="white", markeredgecolor=COLOURS[1], markersize=5)
    ax.plot(*rest[0], "s", color="black", markersize=8)
    ax.set_title("ten pieces of a helix, first mode")
    ax.set_aspect("equal")
    ax.margins(0.12)
    ax.axis("off")


STUDY = Study(
    name="rods_in_space",
    title="Rods in space: order 4 for any shape at rest; what the order of hinges costs",
    caption="Chains of straight, pretwisted, curved and helical rods, and of a narrow beam that turns over.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("rod", "rule", "segments", "relative_error"), {"relative_error": Kind(decimals=11)}),
        "_joints.csv": Sheet(("joints", "segments", "buckling_error"), {"buckling_error": Kind(decimals=6)}),
    },
    size=(9.0, 6.6),
    seconds=6.0,
)
