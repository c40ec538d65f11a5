"""Frequency response of a cantilever and of chains of it: what an error of the frequency does to a peak."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.accuracy.response_law import frequency_error_allowed
from beammodes.numerics.arrays import Floats
from studies.plots import method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BEAM, ENDS, SEGMENTS = bm.Beam(1.2, bending_stiffness=85.0, mass_per_length=0.62), "clamped-free", 10
RULES = ("mitiguy", "gregory")
SYSTEMS = ("beam", *RULES)
RATIOS = (0.01, 0.001)
#: A unit force on the tip, and what it moves by.
AT_TIP = {"force_at": BEAM.length, "deflection_at": BEAM.length}
#: What the band leaves of the peak.
KEPT = 0.98
#: Rules and modes whose peaks are measured, over these damping ratios.
PEAKS = (("mitiguy", 1), ("mitiguy", 2), ("gregory", 3))
DAMPED = np.array([0.001, 0.002, 0.005, 0.01, 0.02, 0.05])
NOTE = "grey: errors of\nthe frequency up\nto a fifth of the\ndamping ratio"
#: Half the width of a picture of a peak, in damping ratios.
NEAR = 4.0


def data(progress: Progress) -> xarray.Dataset:
    """Return responses to 100 Hz, about the first peak with the band of small errors, and peaks kept."""
    beam = {"system": BEAM, "boundary": ENDS}
    given = {"beam": beam} | {rule: {"system": bm.Chain(BEAM, ENDS, SEGMENTS, rule)} for rule in RULES}
    natural = bm.euler_bernoulli(BEAM, ENDS, 3).frequency
    # Next to each resonance as fine as the least damping asks for.
    offset = np.array([-20, -10, -5, -2, -1, -0.5, 0, 0.5, 1, 2, 5, 10, 20]) * min(RATIOS)
    owned = [bm.solve_modes(bm.linearize(given[rule]["system"]), 3).frequency for rule in RULES]
    frequency = np.unique(
        np.concatenate([np.geomspace(1, 100, 160), np.outer(1 + offset, [natural, *owned]).ravel()]).round(6)
    )
    near = np.linspace(-NEAR, NEAR, 161)
    size = (len(RATIOS), len(SYSTEMS))
    whole, peak = np.zeros((*size, len(frequency)), complex), np.zeros((*size, len(near)), complex)
    band = np.zeros((2, len(RATIOS), len(near)))
    for i, ratio in enumerate(RATIOS):
        about = natural[0] * (1 + near * ratio)
        for j, name in enumerate(SYSTEMS):
            whole[i, j] = _receptance(given[name], frequency, ratio)
            peak[i, j] = _receptance(given[name], about, ratio)
        allowed = frequency_error_allowed(1 - KEPT, ratio)
        off = [_receptance(_off_by(e), about, ratio) for e in np.linspace(-allowed, allowed, 9)]
        band[:, i] = np.min(np.abs(off), axis=0), np.max(np.abs(off), axis=0)
        progress(i + 1, len(RATIOS) + 1)
    ratios = np.unique(np.concatenate([np.geomspace(DAMPED[0], DAMPED[-1], 41), DAMPED]).round(9))
    law, measured = np.zeros((len(PEAKS), len(ratios))), np.full((len(PEAKS), len(ratios)), np.nan)
    for i, (rule, mode) in enumerate(PEAKS):
        case = {"segments": SEGMENTS, "mode": mode, "rule": rule, "damping_ratio": ratios}
        law[i] = np.abs(1 + np.asarray(bm.response_error(ENDS, **case)))
        for k in np.flatnonzero(np.isin(ratios, DAMPED)).tolist():
            both = [_receptance(given[name], natural[mode - 1 : mode], ratios[k]) for name in (rule, "beam")]
            measured[i, k] = abs(both[0] / both[1])[0]
    progress(len(RATIOS) + 1, len(RATIOS) + 1)
    at_peak = np.abs(peak[:, :1]).max(axis=2, keepdims=True)
    return xarray.Dataset(
        {
            "receptance": (("damping_ratio", "system", "frequency"), np.abs(whole)),
            "phase": (("damping_ratio", "system", "frequency"), np.degrees(np.angle(whole))),
            "over_peak": (("damping_ratio", "system", "widths"), np.abs(peak) / at_peak),
            "least": (("damping_ratio", "widths"), band[0] / at_peak[:, 0]),
            "largest": (("damping_ratio", "widths"), band[1] / at_peak[:, 0]),
            "kept_by_law": (("peak", "ratio"), law),
            "kept": (("peak", "ratio"), measured),
        },
        coords={
            "damping_ratio": list(RATIOS),
            "system": list(SYSTEMS),
            "frequency": frequency,
            "widths": near,
            "peak": [f"{rule} mode {mode}" for rule, mode in PEAKS],
            "ratio": ratios,
            "natural": ("mode", natural),
        },
    )


def _receptance(given: dict[str, Any], frequency: Floats, ratio: float) -> Floats:
    """Return the tip's receptance [m/N], complex."""
    found = bm.frequency_response(**given, frequency=frequency, damping_ratio=ratio, **AT_TIP)
    return np.asarray(found.receptance.values)


def _off_by(error: float) -> dict[str, object]:
    """Return the beam with all frequencies off by an error."""
    return {"system": bm.Beam(1.2, 85.0 * (1 + error) ** 2, 0.62), "boundary": ENDS}


def _look(system: str) -> dict[str, object]:
    if system == "beam":
        return {"color": "black", "linewidth": 1.2, "linestyle": (0, (3, 2)), "zorder": 4}
    return method_style(system)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw responses above, the first peaks and what is kept of peaks below."""
    panels = figure.subplot_mosaic(
        [["a"] * 3 + ["b"] * 3, ["c"] * 2 + ["d"] * 2 + ["e"] * 2], height_ratios=(1, 1)
    )
    for name, ratio in zip("ab", RATIOS, strict=True):
        _draw_whole(panels[name], table.sel(damping_ratio=ratio), ratio)
    for name, ratio in zip("cd", RATIOS, strict=True):
        _draw_peak(panels[name], table.sel(damping_ratio=ratio), ratio)
    _draw_law(panels["e"], table)


def _draw_whole(ax: Axes, table: xarray.Dataset, ratio: float) -> None:
    for system in SYSTEMS:
        ax.plot(table.frequency, table.receptance.sel(system=system), **_look(system))
    ax.set(xscale="log", yscale="log", xlim=(1, 100), ylim=(3e-7, 10), xlabel="frequency  [Hz]")
    plain_ticks(ax, [1, 2, 5, 10, 20, 50, 100])
    ax.set_ylabel("tip's receptance  [m/N]")
    ax.set_title(f"{100 * ratio:g} % damping in every mode")
    words = (
        ("exact beam, dashed", "black"),
        *((f"10 segments, {rule}", method_style(rule)["color"]) for rule in RULES),
    )
    for k, (text, colour) in enumerate(words):
        ax.text(0.98, 0.95 - 0.085 * k, text, color=colour, transform=ax.transAxes, ha="right", va="top")


def _draw_peak(ax: Axes, table: xarray.Dataset, ratio: float) -> None:
    x = 100 * ratio * table.widths
    ax.fill_between(x, table.least, table.largest, color="#C9C9C9", linewidth=0)
    for system in SYSTEMS:
        ax.plot(x, table.over_peak.sel(system=system), **_look(system))
    ax.axvline(0.0, color="black", linewidth=0.6, linestyle=(0, (1, 2)))
    ax.set(xlim=(x[0], x[-1]), ylim=(0, 1.12), xlabel="frequency less the beam's first  [%]")
    ax.set_ylabel("receptance / peak of the beam")
    ax.set_title(f"first peak, {100 * ratio:g} %")
    lost, colour = float(table.over_peak.sel(system="mitiguy", widths=0.0)), method_style("mitiguy")["color"]
    ax.plot(0.0, lost, "o", color=colour, zorder=5)
    line = {"arrowstyle": "-", "color": colour, "linewidth": 0.8, "shrinkB": 4}
    at = (1.3 * 100 * ratio, 0.92 if ratio == RATIOS[0] else 0.72)
    words = f"{100 * lost:.0f} % of the\npeak left"
    ax.annotate(words, (0.0, lost), at, color=colour, va="center", arrowprops=line)
    if ratio == RATIOS[0]:
        ax.text(0.03, 0.97, NOTE, transform=ax.transAxes, va="top", fontsize=9)


def _draw_law(ax: Axes, table: xarray.Dataset) -> None:
    for (rule, mode), name in zip(PEAKS, table.peak.values, strict=True):
        look = method_style(rule) | {"linestyle": "-" if mode == 1 else (0, (5, 1.5)), "linewidth": 1.6}
        one = table.sel(peak=name)
        ax.plot(100 * table.ratio, 100 * one.kept_by_law, **look)
        ax.plot(100 * table.ratio, 100 * one.kept, "o", color=look["color"], markersize=5, zorder=5)
    ax.axhline(100 * KEPT, color="black", linewidth=0.6, linestyle=(0, (1, 2)))
    ax.set(xscale="log", xlim=(0.085, 6), ylim=(0, 107), xlabel="damping ratio  [%]")
    plain_ticks(ax, [0.1, 0.2, 0.5, 1, 2, 5], [0, 25, 50, 75, 100], unit=" %")
    ax.set_title("what is left of a peak; dots: measured")
    for text, at, rule in (
        ("mitiguy,\nmode 1", (0.09, 87), "mitiguy"),
        ("mitiguy, mode 2", (0.55, 22), "mitiguy"),
        ("gregory,\nmode 3", (0.21, 51), "gregory"),
    ):
        ax.text(*at, text, color=method_style(rule)["color"], fontsize=9)


STUDY = Study(
    name="frequency_response",
    title="A frequency that is off by a fifth of the damping ratio keeps 98 % of the peak",
    caption="Frequency response of a cantilever and of chains of ten segments at 1 % and 0.1 % damping, the "
    "band of small frequency errors about the first peak, and what is left of peaks.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("damping_ratio", "system", "frequency", "receptance", "phase"),
            {"receptance": Kind(decimals=9), "phase": Kind(decimals=5)},
        ),
        "_peak.csv": Sheet(
            ("damping_ratio", "system", "widths", "over_peak"), {"over_peak": Kind(decimals=8)}
        ),
        "_band.csv": Sheet(
            ("damping_ratio", "widths", "least", "largest"),
            {"least": Kind(decimals=8), "largest": Kind(decimals=8)},
        ),
        "_law.csv": Sheet(
            ("peak", "ratio", "kept_by_law", "kept"),
            {"kept_by_law": Kind(decimals=9), "kept": Kind(decimals=8)},
        ),
    },
    size=(11.5, 7.4),
    seconds=6.0,
)
