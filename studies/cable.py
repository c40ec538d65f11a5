"""A cable between two points: how it hangs, its modes in the plane, and what slack does to them."""

from __future__ import annotations

import math

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

import beammodes as bm
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_line, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

#: 1000 m of 1962 N/m, too heavy for its stiffness to matter, and where its right end is [m].
CABLE, LOAD, SPAN = bm.Beam(1000.0, 1e5, 200.0), bm.Load(gravity=9.81), (800.0, 100.0)
SEGMENTS, MODES = 100, 3
#: How far nodes move in the picture, at most [m].
SWING = 60.0
#: Level cables without stiffness, by the share of their length that the chord is shorter.
SLACK, STRING_SEGMENTS, STRING_MODES = np.geomspace(1e-3, 0.4, 14), 60, 4


def data(progress: Progress) -> xarray.Dataset:
    """Return a cable's nodes at rest and in its modes, and frequencies over π √(H/m)/L against slack."""
    chain = bm.Chain(CABLE, "pinned-pinned", SEGMENTS)
    hung = bm.find_equilibrium(chain, LOAD, span=SPAN)
    modes = bm.solve_modes(bm.linearize(chain, at=hung), MODES)
    steps = chain.length * modes.rotation
    moved = [np.cumsum(steps * turn, axis=1) for turn in (-np.sin(hung.angle), np.cos(hung.angle))]
    shapes = np.stack([np.pad(each, ((0, 0), (1, 0))) for each in moved], axis=-1)
    shapes *= SWING / np.hypot(*np.moveaxis(shapes, -1, 0)).max(axis=1)[:, None, None]
    ratio = np.empty((STRING_MODES, len(SLACK)))
    for k, slack in enumerate(SLACK.tolist()):
        ratio[:, k] = _of_string(slack)
        progress(k + 1, len(SLACK))
    return xarray.Dataset(
        {
            "rest": (("node", "axis"), hung.nodes),
            "swing": (("mode", "node", "axis"), shapes),
            "frequency": ("mode", modes.frequency),
            "pull": float(hung.multipliers[0]),
            "ratio": (("string_mode", "slack"), ratio),
            "irvine": ("string_mode", _irvine()),
        },
        coords={
            "node": range(SEGMENTS + 1),
            "axis": ["x", "y"],
            "mode": range(1, MODES + 1),
            "slack": SLACK,
            "string_mode": range(1, STRING_MODES + 1),
        },
    )


def _of_string(slack: float) -> NDArray[np.float64]:
    """Return ω L √(m/H)/π of a level cable's first modes, L its length."""
    string = bm.Chain(bm.Beam(1.0, 1e-9, 1.0), "pinned-pinned", STRING_SEGMENTS)
    hung = bm.find_equilibrium(string, bm.Load(gravity=1.0), span=1.0 - slack)
    omega = bm.solve_modes(bm.linearize(string, at=hung), STRING_MODES).angular_frequency
    return np.asarray(omega / math.sqrt(hung.multipliers[0]) / math.pi)


def _irvine() -> NDArray[np.float64]:
    """Return the limits without slack: 2, 4, ... and twice the roots of tan x = x, over π."""
    roots = [
        brentq(lambda x: math.sin(x) - x * math.cos(x), k * math.pi, (k + 0.5) * math.pi)
        for k in range(1, STRING_MODES)
    ]
    both = sorted([*(2.0 * k for k in range(1, STRING_MODES)), *(2 * root / math.pi for root in roots)])
    return np.array(both[:STRING_MODES])


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the cable in each of its modes, and frequencies against slack."""
    grid = figure.add_gridspec(MODES, 2, width_ratios=[1.1, 1])
    left = [figure.add_subplot(grid[0, 0])]
    left += [figure.add_subplot(grid[k, 0], sharex=left[0], sharey=left[0]) for k in range(1, MODES)]
    for ax, mode in zip(left, table.mode.values, strict=True):
        _cable(ax, table.sel(mode=mode), COLOURS[mode - 1])
    left[0].set_title(
        f"at rest (grey, H = {float(table['pull']) / 1000:.1f} kN) and {SWING:g} m away from it"
    )
    left[-1].set_xlabel("x  [m]")
    for ax in left[:-1]:
        ax.tick_params(labelbottom=False)
    _slack(figure.add_subplot(grid[:, 1]), table)


def _cable(ax: Axes, table: xarray.Dataset, colour: str) -> None:
    rest, swing = table.rest.values, table.swing.values
    for sign, style in ((1, "-"), (-1, (0, (4, 2)))):
        ax.plot(*(rest + sign * swing).T, color=colour, linewidth=1.6, linestyle=style)
    ax.plot(*rest.T, color=GREY, linewidth=1.2)
    ax.plot(*rest[[0, -1]].T, "o", color="black", ms=5, clip_on=False, zorder=5)
    ax.set(xlim=(-20, 820), ylim=(-330, 140), aspect="equal")
    ax.set_ylabel("y  [m]")
    frequency = float(table.frequency)
    ax.text(400, 60, f"mode {int(table.mode)}:  {frequency:.4f} Hz", color=colour, ha="center", fontsize=11)


def _slack(ax: Axes, table: xarray.Dataset) -> None:
    ax.set(xscale="log", xlim=(7e-4, 1.1), ylim=(1.5, 6.4))
    for mode, colour in zip(table.string_mode.values, COLOURS, strict=False):
        one = table.sel(string_mode=mode)
        (line,) = ax.plot(one.slack, one.ratio, color=colour, marker="o", ms=3.5)
        ax.plot([7e-4, 9e-4], [one.irvine] * 2, color=colour, linewidth=4, solid_capstyle="butt")
        label_line(ax, line, f"mode {mode}", offset=(7, 0))
    plain_ticks(ax, [0.001, 0.01, 0.1, 0.4], [2, 3, 4, 5, 6])
    ax.set_xlabel("slack  1 - chord/length")
    ax.set_ylabel("ω L √(m/H)/π")
    ax.set_title(f"level, {STRING_SEGMENTS} rods; bars: Irvine's, without slack")


STUDY = Study(
    name="cable",
    title="A cable between two points: how it hangs, and how it swings in its plane",
    caption="A hanging cable with its first modes, and what slack does to a level cable's frequencies.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("mode", "node", "axis", "rest", "swing", "frequency"),
            {"rest": Kind(decimals=6), "swing": Kind(decimals=4), "frequency": Kind(decimals=9)},
        ),
        "_slack.csv": Sheet(
            ("string_mode", "slack", "ratio", "irvine"),
            {"ratio": Kind(decimals=7)},
        ),
    },
    size=(9.4, 6.4),
)
