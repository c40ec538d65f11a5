"""Why rules differ: hinge flexibilities are the weights of a quadrature of M²/EI."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import COLOURS
from studies.study import Progress, Sheet, Study

BOUNDARY, SEGMENTS = "clamped-free", 6
#: Where a cell of width w ell is drawn about its hinge: a wall's hinge has one side only.
SHOWN = ("naive", "double_wall", "gregory", "rigid_stub", "half_stub", "half_stub_corrected")


def data(progress: Progress) -> xarray.Dataset:
    """Return hinges, weights and f = φ''² at the hinges, for six segments in mode 1; and f along the beam."""
    beam = bm.euler_bernoulli(bm.Beam.unit(), BOUNDARY, 1)
    position = np.full((len(SHOWN), SEGMENTS + 1), np.nan)
    weight = position.copy()
    for i, name in enumerate(SHOWN):
        chain = bm.Chain(bm.Beam.unit(), BOUNDARY, SEGMENTS, name)
        count = len(chain.hinge_position)
        position[i, :count] = chain.hinge_position
        weight[i, :count] = SEGMENTS / chain.joint_stiffness
        progress(i + 1, len(SHOWN))
    x = np.linspace(0, 1, 201)
    density = np.full_like(position, np.nan)
    there = ~np.isnan(position)
    density[there] = beam.shape(position[there], derivative=2)[0] ** 2
    errors = bm.frequency_error(BOUNDARY, segments=SEGMENTS, mode=1, rule=list(SHOWN))
    return xarray.Dataset(
        {
            "position": (("rule", "hinge"), position),
            "weight": (("rule", "hinge"), weight),
            "density": (("rule", "hinge"), density),
            "curve": ("x", beam.shape(x, derivative=2)[0] ** 2),
            "relative_error": ("rule", errors),
        },
        coords={"rule": list(SHOWN), "hinge": range(1, SEGMENTS + 2), "x": x},
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw, for six rules, the curve that the beam integrates and the bars that the chain adds up."""
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for ax, name in zip(panels.flat, SHOWN, strict=True):
        _panel(table, name, ax)
    for ax in panels[1]:
        ax.set_xlabel("x / L")
    for ax in panels[:, 0]:
        ax.set_ylabel("M² / EI")


def _panel(table: xarray.Dataset, name: str, ax: Axes) -> None:
    one = table.sel(rule=name).dropna("hinge", subset=["position"])
    width, position = one.weight.values / SEGMENTS, one.position.values
    # A hinge at the wall has its whole cell on one side.
    left = np.where(position == 0, 0.0, position - width / 2)
    changed = np.abs(one.weight.values - 1) > 1e-9
    colours = np.where(changed, COLOURS[1], COLOURS[0])
    ax.grid(visible=False)
    ax.bar(left, one.density.values, width, align="edge", color=colours, alpha=0.45, edgecolor="white")
    ax.plot(table.x, table.curve, color="black")
    ax.plot(position, one.density, "o", color="black", markersize=3)
    ax.set_yticks([])
    ax.set_title(name, fontweight="bold")
    weights = [str(Fraction(float(w)).limit_denominator(100)) for w in one.weight.values[:3]]
    start = "w = " + ", ".join([*weights, "1 ..."] if changed.any() else ["1, 1, 1 ..."])
    ax.text(0.97, 0.93, start, transform=ax.transAxes, ha="right", va="top")
    error = f"error of mode 1: {100 * float(one.relative_error):+.2g} %"
    ax.text(0.97, 0.79, error, transform=ax.transAxes, ha="right", va="top")


STUDY = Study(
    name="quadrature",
    title="A chain adds up bars of width w·ell; the beam integrates the curve M²/EI",
    caption="Springs as quadrature: what the beam integrates, and the bars that six rules add up.",
    data=data,
    draw=draw,
    sheets={".csv": Sheet(("rule", "hinge", "position", "weight", "density"))},
    size=(9.0, 5.2),
)
