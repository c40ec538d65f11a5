"""Chains under an axial force: every rule falls to order 2; corrected springs restore most of it."""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import beammodes as bm
from beammodes.accuracy.buckling import buckling_dataset, buckling_load
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.chains.rules import AnyRule, axially_corrected
from beammodes.problem.loading import Load
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, mark_point, method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BOUNDARIES = ("pinned-pinned", "clamped-free")
CASES = ("mitiguy", "gregory", "gregory corrected", "gregory, no force")
SEGMENTS = np.unique([20, *np.geomspace(3, 200, 26).round().astype(int)])
HALF = 0.5
STRUCTURES, SHORT = ("beam", "mitiguy", "mitiguy corrected"), 2
# Compression is short of what buckles two rods.
FORCE_RATIOS = np.arange(-8, 11, 2) / 10
BUCKLING_RULES, BUCKLING_PAIR = ("double_wall", "gregory", "mitiguy"), "clamped-free"
BUCKLING_SEGMENTS = range(2, 31)
#: `chain_errors` are good to 1e-12 on a uniform beam; less than three digits are not shown.
LEAST = 1e-9
# Where each line is named, and on which side.
LABELS: dict[str, dict[str, tuple[str, float, Literal["above", "below"]]]] = {
    "pinned-pinned": {
        "mitiguy": ("mitiguy, gregory: 1/N²", 30, "above"),
        "gregory corrected": ("corrected: 1/N⁴", 17, "above"),
        "gregory, no force": ("no force: 1/N⁴", 13, "below"),
    },
    "clamped-free": {
        "mitiguy": ("mitiguy: 1/N²", 80, "below"),
        "gregory": ("gregory: 1/N²", 50, "above"),
        "gregory corrected": ("corrected: 1/N³", 85, "below"),
        "gregory, no force": ("gregory, no force", 28, "below"),
    },
}


def data(progress: Progress) -> xarray.Dataset:
    """Return errors at half the buckling load, ω² against the force, and errors of the buckling load."""
    error = np.full((len(BOUNDARIES), len(CASES), len(SEGMENTS)), np.nan)
    for i, pair in enumerate(BOUNDARIES):
        for j, case in enumerate(CASES):
            error[i, j] = [_error(pair, case, int(n)) for n in SEGMENTS]
            progress(i * len(CASES) + j + 1, len(BOUNDARIES) * len(CASES))
    error = np.where(abs(error) < LEAST, np.nan, error)
    force, square = (np.array(rows) for rows in zip(*map(_squares, STRUCTURES), strict=True))
    buckling = buckling_dataset(boundary=BUCKLING_PAIR, segments=BUCKLING_SEGMENTS, rule=BUCKLING_RULES)
    return xarray.Dataset(
        {
            "relative_error": (("boundary", "case", "segments"), error),
            "axial_force": (("structure", "point"), force),
            "squared_frequency": (("structure", "point"), square),
            "buckling_error": (("rule", "buckling_segments"), buckling.relative_error[:, 0].values),
        },
        coords={
            "boundary": list(BOUNDARIES),
            "case": list(CASES),
            "segments": SEGMENTS,
            "structure": list(STRUCTURES),
            "rule": list(BUCKLING_RULES),
            "buckling_segments": list(BUCKLING_SEGMENTS),
            "point": range(force.shape[1]),
        },
    )


def _error(pair: str, case: str, segments: int) -> float:
    if case == "gregory, no force":
        return float(bm.frequency_error(pair, segments=segments, mode=1, rule="gregory"))
    load = Load(axial_force=-HALF * buckling_load(bm.Beam.unit(), pair))
    rule: AnyRule = axially_corrected("gregory", load, bm.Beam.unit()) if case.endswith("corrected") else case
    return float(chain_errors(bm.Chain(bm.Beam.unit(), pair, segments, rule), 1, load=load)[0])


def _squares(structure: str) -> tuple[list[float], list[float]]:
    """Return forces in buckling loads, and ω² over that without force: of the beam, or of short chains."""
    beam, pair = bm.Beam.unit(), BOUNDARIES[0]
    unit, still = buckling_load(beam, pair), bm.euler_bernoulli(beam, pair, 1).angular_frequency[0]
    # Corrected springs belong to one force each: there is no one chain that buckles.
    forces, squares = [np.nan], [np.nan]
    if structure == "beam":
        forces, squares = [-1.0], [0.0]
    elif structure == "mitiguy":
        forces, squares = [-buckling_load(bm.Chain(beam, pair, SHORT, structure)) / unit], [0.0]
    for ratio in FORCE_RATIOS:
        load = Load(axial_force=ratio * unit)
        if structure == "beam":
            frequency = bm.euler_bernoulli(beam, pair, 1, load=load).angular_frequency[0]
        else:
            rule = "mitiguy" if structure == "mitiguy" else axially_corrected("mitiguy", load, beam)
            model = bm.linearize(bm.Chain(beam, pair, SHORT, rule), load=load)
            frequency = bm.solve_modes(model, 1).angular_frequency[0]
        forces.append(ratio)
        squares.append((frequency / still) ** 2)
    return forces, squares


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw ω² against force, the buckling load's error, and errors at half the load for two pairs."""
    figure.get_layout_engine().set(hspace=0.06, wspace=0.04)
    panels = figure.subplots(2, 2)
    _draw_forces(panels[0, 0], table)
    _draw_buckling(panels[0, 1], table)
    named = [
        _draw_errors(ax, table.sel(boundary=pair), pair)
        for ax, pair in zip(panels[1], BOUNDARIES, strict=True)
    ]
    for ax, labels in zip(panels[1], named, strict=True):
        label_along(ax, labels)


def _draw_forces(ax: Axes, table: xarray.Dataset) -> None:
    looks = ({"color": "black", "linewidth": 1.6}, method_style("mitiguy"), _corrected_style())
    for structure, look in zip(STRUCTURES, looks, strict=True):
        one = table.sel(structure=structure)
        ax.plot(one.axial_force, one.squared_frequency, **look)
    buckled = float(table.axial_force.sel(structure="mitiguy").dropna("point")[0])
    for place, colour in ((-1.0, "black"), (buckled, COLOURS[0])):
        ax.plot(place, 0, "o", color=colour, markersize=6, clip_on=False, zorder=5)
    ax.set(xlim=(-1.05, 1.05), ylim=(0, 2.3))
    ax.set_xticks([-1, -0.5, 0, 0.5, 1], ["−1", "−½", "0", "½", "1"])
    ax.set_yticks([0, 0.5, 1, 1.5, 2])
    ax.set_title("pinned-pinned, two rods")
    ax.set_xlabel("axial force T / buckling load of the beam")
    ax.set_ylabel("ω₁² / ω₁² of the beam without force")
    note = f"two rods buckle at\n{-100 * buckled:.0f} % of the beam's load"
    arrow = {"arrowstyle": "-", "color": COLOURS[0], "linewidth": 0.8, "shrinkB": 4}
    ax.annotate(note, (buckled, 0), (-0.36, 0.12), color=COLOURS[0], va="bottom", arrowprops=arrow)
    ax.text(-0.98, 2.1, "two rods, springs EI/ell", color=COLOURS[0], va="center")
    ax.text(-0.98, 1.9, "springs (EI − T ell²/12)/ell", color=COLOURS[1], va="center")
    ax.text(-0.98, 1.7, "exact beam", color="black", va="center")


def _draw_buckling(ax: Axes, table: xarray.Dataset) -> None:
    for rule in BUCKLING_RULES:
        one = 100 * table.buckling_error.sel(rule=rule)
        (line,) = ax.plot(one.buckling_segments, one, **method_style(rule))
        if rule != "double_wall":
            at_ten = float(one.sel(buckling_segments=10))
            text, up = f"{at_ten:+.2f} %".replace("-", "−"), 6 if at_ten > 0 else -16
            mark_point(ax, line, 10, text, offset=(5, up))
    ax.axhline(0, color="black", linewidth=0.8)
    ax.set(xscale="log", xlim=(1.9, 33), ylim=(-5.5, 3.5), xlabel="number of segments N")
    ax.set_xticks([2, 3, 5, 10, 20, 30], ["2", "3", "5", "10", "20", "30"])
    ax.set_yticks([-4, -2, 0, 2], ["−4 %", "−2 %", "0", "+2 %"])
    ax.minorticks_off()
    ax.set_title(f"{BUCKLING_PAIR}, buckling load")
    ax.set_ylabel("error of the buckling load")
    ax.text(3.3, 1.75, "mitiguy buckles late", color=method_style("mitiguy")["color"])
    ax.text(3.6, -3.0, "gregory early", color=method_style("gregory")["color"])
    ax.text(2.65, -4.6, "double_wall, Hencky's own, early", color=GREY)


def _draw_errors(
    ax: Axes, table: xarray.Dataset, pair: str
) -> list[tuple[Line2D, str, float, Literal["above", "below"]]]:
    looks = (method_style("mitiguy"), method_style("gregory"), _corrected_style(), method_style("gregory2"))
    lines = {}
    for case, look in zip(CASES, looks, strict=True):
        if case in LABELS[pair]:
            line = 100 * abs(table.relative_error.sel(case=case)).dropna("segments")
            (lines[case],) = ax.plot(line.segments, line, **look)
    ax.set_title(f"{pair}, half the buckling load")
    ax.set_ylabel("|error of the first frequency|")
    ax.set(xscale="log", yscale="log", xlim=(2.7, 230), ylim=(1e-7, 100), xlabel="number of segments N")
    plain_ticks(ax, [3, 10, 30, 100, 200], 10.0 ** np.arange(-6, 3, 2), unit=" %")
    return [(lines[case], *place) for case, place in LABELS[pair].items()]


def _corrected_style() -> dict[str, object]:
    return {"color": COLOURS[1], "linestyle": (0, (4, 1.5)), "linewidth": 2.0}


STUDY = Study(
    name="axial_force",
    title="An axial force takes every rule down to order 2; corrected springs win most of it back",
    caption="An axial force reduces every rule to order 2; corrected springs restore most of the order.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("boundary", "case", "segments", "relative_error"), {"relative_error": Kind(decimals=12)}
        ),
        "_forces.csv": Sheet(("structure", "point", "axial_force", "squared_frequency")),
        "_buckling.csv": Sheet(("rule", "buckling_segments", "buckling_error")),
    },
    size=(9.0, 7.4),
    seconds=8.0,
)
