"""Points inside a beam, corners and frames: errors with a rule at every node, and at ends only."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import COLOURS, GREY
from studies.common import picture
from studies.plots import method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BAR = bm.Beam.unit()


def _frame(*places: tuple[float, float]) -> bm.Structure:
    """Return bars of length one along a row of joints, of which those on the ground are held."""
    names = "abcd"[: len(places)]
    joints = {
        name: bm.Joint(*place, "clamped" if place[1] == 0.0 else "free")
        for name, place in zip(names, places, strict=True)
    }
    return bm.Structure(joints, [bm.Member(BAR, *pair) for pair in pairwise(names)])


#: What is shown, and the mode whose error is.
CASES: dict[str, tuple[bm.Structure, int]] = {
    "support inside": (bm.Structure.of_beam(BAR, "clamped-free", [bm.Station(0.7, math.inf)]), 1),
    "mass inside": (bm.Structure.of_beam(BAR, "clamped-pinned", [bm.Station(0.4, mass=1.0)]), 1),
    "soft hinge": (bm.Structure.of_beam(BAR, "clamped-clamped", [bm.Station(0.4, hinge=2.0)]), 1),
    "L-frame": (_frame((0, 0), (0, 1), (1, 1)), 2),
    "portal": (_frame((0, 0), (0, 1), (1, 1), (1, 0)), 1),
}
RULES = ("mitiguy", "gregory")
#: Both know the ends.
WAYS = {"every node": True, "ends only": False}
#: Tenths of a beam, so that segments are equally long on both sides of its station.
SEGMENTS = tuple(10 * n for n in (1, 2, 3, 4, 6, 8, 12, 16))
#: Two digits at least.
LEAST = 1e-11


def data(progress: Progress) -> xarray.Dataset:
    """Return the error of a mode by structure, rule, where it is applied, and N."""
    error = np.full((len(CASES), len(RULES), len(WAYS), len(SEGMENTS)), np.nan)
    for i, (structure, mode) in enumerate(CASES.values()):
        exact = bm.structure_modes(structure, mode).angular_frequency[-1]
        for at in np.ndindex(error.shape[1:]):
            rule, corrected, count = RULES[at[0]], [*WAYS.values()][at[1]], SEGMENTS[at[2]]
            chain = bm.StructureChain(structure, count, rule, corrected=corrected)
            found = bm.structure_chain_modes(chain, mode).angular_frequency[-1] / exact - 1
            error[i, *at] = found if abs(found) >= LEAST else np.nan
        progress(i + 1, len(CASES))
    return xarray.Dataset(
        {"relative_error": (("structure", "rule", "applied_at", "segments"), error)},
        coords={
            "structure": list(CASES),
            "rule": list(RULES),
            "applied_at": list(WAYS),
            "segments": list(SEGMENTS),
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw |error| against N in a panel for each structure, below a sketch of it."""
    panels = figure.subplots(2, len(CASES), sharex="row", sharey="row", height_ratios=(1, 3.2))
    for (sketch, ax), (name, (structure, mode)) in zip(panels.T, CASES.items(), strict=True):
        sketch.set_title(name, fontweight="bold")
        _sketch(sketch, structure)
        for rule in RULES:
            for way, corrected in WAYS.items():
                line = 100 * abs(table.relative_error.sel(structure=name, rule=rule, applied_at=way))
                look = method_style(rule) | {"linestyle": "-" if corrected else (0, (2, 2))}
                ax.plot(line.segments, line, label=f"{rule}, {way}", **look)
        ax.set(xscale="log", yscale="log", xlabel="segments in all, N")
        ax.set_title(f"mode {mode}", fontsize=9, loc="right")
        plain_ticks(ax, [10, 20, 40, 80, 160], [1e-6, 1e-4, 1e-2, 1], unit=" %")
        if name == "soft hinge":
            words = "what carries nothing\nneeds no correction\nbetween equal segments"
            ax.text(0.03, 0.03, words, transform=ax.transAxes, fontsize=8, va="bottom")
    panels[1, 0].set_ylabel("|error of the frequency|")
    panels[1, -1].legend(fontsize=8, loc="lower left")


def _sketch(ax: Axes, structure: bm.Structure) -> None:
    """Draw members, supports, bodies and hinges."""
    parts = structure.parts
    for stretch in parts.stretches:
        ends = np.array([parts.nodes[i].place for i in stretch.nodes])
        ax.plot(*ends.T, color=GREY, linewidth=2.5, solid_capstyle="round")
        (x, y), hinge = parts.nodes[stretch.nodes[0]].place, stretch.hinges[0]
        if hinge < math.inf:
            ax.plot(x, y, "o", color="white", markeredgecolor=COLOURS[0], markersize=8, markeredgewidth=2)
    for node in parts.nodes:
        held = [unit for unit, _ in node.supports]
        if node.rotational_stiffness:
            ax.plot(*node.place, "s", color=COLOURS[0], markersize=8)
        elif held:
            ax.plot(node.place[0], node.place[1] - 0.11, "^", color=COLOURS[0], markersize=9)
        if node.mass:
            ax.plot(*node.place, "o", color=COLOURS[1], markersize=11)
    picture(ax, (-0.2, 1.2), (-0.3, 1.2))


STUDY = Study(
    name="structures",
    title="Supports, masses, hinges and corners: with the rule at every node order 4 goes through",
    caption="Points inside a beam and frames: with the rule's springs at every node the order stays 4, with "
    "them at the ends only it is 2.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("structure", "rule", "applied_at", "segments", "relative_error"),
            {"relative_error": Kind(decimals=12)},
        )
    },
    size=(12.0, 4.8),
    seconds=4.0,
)
