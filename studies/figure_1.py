"""Figure 1 of the report: a beam on a body that moves straight on, and on one that turns."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch

import beammodes as bm
from beammodes.dynamics.base_motion import BaseMotion, harmonic, spin_up
from beammodes.dynamics.superposition import modal_response
from beammodes.views.symbols import BLOCK, COLOURS, EDGE, draw_block
from studies.common import moved, picture
from studies.plots import label_line
from studies.study import Kind, Progress, Sheet, Study

#: J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855: EI, ρA, L, run-up to 6 rad/s in 15 s.
BEAM = bm.Beam(length=10.0, bending_stiffness=14000.0, mass_per_length=1.2)
BOUNDARY, SEGMENTS, MODES = "clamped-free", 10, 5
#: Rods in the sketches, and the coefficient of x² by which these are bent [1/m].
DRAWN, BENT = 5, 0.009
#: 0.1 m to and fro at 2 rad/s, about half of the beam's first frequency; and the run-up.
MOTIONS = {
    "linear": (BaseMotion(y=harmonic(0.1, 2.0)), 12.0, 0.04),
    "rotational": (BaseMotion(angle=spin_up(6.0, 15.0)), 20.0, 0.05),
}
#: Largest deflection of the beam itself in the run-up, and when [m, s]: chains of growing N, extrapolated.
LARGEST, AT = -0.57375, 6.76
OUTSIDE = 1.5
RULES = ("mitiguy", "gregory")
METHODS = (*RULES, "modes", "modes_stiffened")
LOOKS = {
    "mitiguy": {"color": COLOURS[0], "linewidth": 1.4},
    "gregory": {"color": COLOURS[1], "linewidth": 1.4, "linestyle": (0, (4, 3))},
    "modes": {"color": COLOURS[2], "linewidth": 1.8},
    "modes_stiffened": {"color": "#BBBBBB", "linewidth": 5.0},
}


def data(progress: Progress) -> xarray.Dataset:
    """Return tip deflections of chains and of sums of modes, on either body."""
    tables = []
    for i, (base, duration, every) in enumerate(MOTIONS.values()):
        time = np.arange(round(duration / every) + 1) * every
        lines = np.empty((len(METHODS), len(time)))
        for j, method in enumerate(METHODS):
            if method in RULES:
                found = moved(bm.Chain(BEAM, BOUNDARY, SEGMENTS, method), duration, every, base=base)
            else:
                stiffening = method == "modes_stiffened"
                found = modal_response(
                    BEAM, BOUNDARY, MODES, time=time, base=base, stiffening=stiffening, tolerance=1e-9
                )
            line = found.tip_deflection.values
            # A line that moves away for good ends where it leaves the picture.
            lines[j] = np.where(np.maximum.accumulate(np.abs(line)) < OUTSIDE, line, np.nan)
            progress(i * len(METHODS) + j + 1, len(MOTIONS) * len(METHODS))
        tables.append(xarray.DataArray(lines, {"model": list(METHODS), "time": time}, ("model", "time")))
    deflection = xarray.concat(tables, "motion", join="outer")
    return xarray.Dataset({"tip_deflection": deflection.assign_coords(motion=list(MOTIONS))})


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the two systems above, the motion of their beams' tips below."""
    panels = figure.subplots(2, 2, height_ratios=[1, 2.9])
    _slider(panels[0, 0])
    _rotor(panels[0, 1])
    for ax, motion in zip(panels[1], MOTIONS, strict=True):
        lines = table.tip_deflection.sel(motion=motion).dropna("time", how="all")
        _motion(lines, ax)
    _label_linear(panels[1, 0], table.tip_deflection.sel(motion="linear").dropna("time", how="all"))
    _label_rotational(panels[1, 1], table.tip_deflection.sel(motion="rotational").dropna("time", how="all"))


def _motion(lines: xarray.DataArray, ax: Axes) -> None:
    for method in reversed(METHODS):
        ax.plot(lines.time, lines.sel(model=method), **LOOKS[method])
    ax.set_xlabel("time t  [s]")
    ax.set_ylabel("tip's deflection from the body's axis  [m]")
    ax.set_xlim(0, float(lines.time[-1]))


def _label_linear(ax: Axes, lines: xarray.DataArray) -> None:
    exact = lines.sel(model="modes")
    apart = 100 * np.abs(lines - exact).max("time") / np.abs(exact).max()
    ax.set_ylim(-0.11, 0.19)
    ax.text(0.04, 0.97, f"grey: five modes of the beam,\nchains of {SEGMENTS} rods on top:", **_at(ax))
    for row, rule in enumerate(RULES):
        text = f"{rule}  {float(apart.sel(model=rule)):.2g} % apart at most"
        ax.text(0.04, 0.83 - 0.07 * row, text, color=LOOKS[rule]["color"], **_at(ax))


def _label_rotational(ax: Axes, lines: xarray.DataArray) -> None:
    ax.set_ylim(-1.25, 0.28)
    linear = ax.get_lines()[1]
    point = int(np.abs(lines.time.values - 6.5).argmin())
    label_line(ax, linear, "modes alone\nmove away\nfor good", point=point, offset=(-8, 0), ha="right")
    ax.text(0.42, 0.4, "grey: modes with centri-\nfugal tension, chains on top:", **_at(ax))
    for row, rule in enumerate(RULES):
        text = f"{rule}  lowest {metres(float(lines.sel(model=rule).min()))}"
        ax.text(0.42, 0.26 - 0.07 * row, text, color=LOOKS[rule]["color"], **_at(ax))
    ax.plot(AT, LARGEST, "o", color="black", markersize=5, zorder=6)
    ax.text(0.42, 0.12, f"●  the beam {metres(LARGEST)}", **_at(ax))
    ax.annotate("6 rad/s", (15.0, 0.03), (15.0, 0.14), ha="center", arrowprops={"arrowstyle": "-"})


def metres(value: float) -> str:
    """Return a length as text."""
    return f"{value:.5f} m".replace("-", "−")


def _at(ax: Axes) -> dict[str, Any]:
    return {"transform": ax.transAxes, "va": "top", "fontsize": 10}


def _slider(ax: Axes) -> None:
    draw_block(ax, (0.0, 0.0), 0.0, (-1.5, -1.1, 1.5, 2.2))
    _draw_beam(ax, BENT)
    ax.add_patch(_arrow((-2.1, -1.5), (-2.1, 1.5), "<|-|>"))
    ax.set_title("1a  linear motion: 0.1 m to and fro at 2 rad/s")


def _rotor(ax: Axes) -> None:
    ax.add_patch(Circle((-1.0, 0.0), 1.1, facecolor=BLOCK, edgecolor=EDGE, zorder=2))
    ax.plot(-1.0, 0.0, "o", color=EDGE, markersize=3, zorder=3)
    _draw_beam(ax, -BENT)
    ax.add_patch(_arrow((0.5, -1.6), (0.5, 1.9), "-|>", "arc3,rad=0.5"))
    ax.set_title("1b  rotational motion: from 0 to 6 rad/s in 15 s")


def _draw_beam(ax: Axes, bend: float) -> None:
    chain = bm.Chain(BEAM, BOUNDARY, DRAWN)
    up = bend * chain.node_position**2
    bm.draw_chain(chain, ax, shape=(up, np.diff(up) * DRAWN / BEAM.length), labels=None, ends=False)
    picture(ax, (-2.5, 12.5), (-2.0, 2.25))


def _arrow(
    start: tuple[float, float], end: tuple[float, float], style: str, bent: str = "arc3"
) -> FancyArrowPatch:
    return FancyArrowPatch(
        start, end, arrowstyle=style, connectionstyle=bent, mutation_scale=11, color=COLOURS[1], linewidth=1.6
    )


STUDY = Study(
    name="figure_1",
    title="Figure 1 · a flexible beam on a body that moves straight on, or turns",
    caption="Figure 1 of the report: a beam on a body that moves straight on, and on one that turns.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("motion", "model", "time", "tip_deflection"), {"tip_deflection": Kind(decimals=8)})
    },
    size=(9.0, 6.0),
    seconds=18.0,
)
