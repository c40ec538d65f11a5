"""A bar on a hub that turns freely, started by a torque: at once, and rising over a period of mode 1."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import COLOURS, GREY
from studies.study import Kind, Progress, Sheet, Study

#: A bar of 5 m, 20 x 20 mm of aluminium, radially on a hub of radius 1 m and 5 kg m².
BEAM = bm.Beam(5.0, 919.36, 1.10668)
HUB = bm.End.hub(hub_radius=1.0, rotary_inertia=5.0)
TORQUE, DURATION, EVERY, STEP = 50.0, 3.0, 0.01, 5e-4
SEGMENTS, RULE = 12, "gregory"
#: Times at which the bar is drawn [s].
STILLS = (0.0, 0.7, 1.0, 1.4, 1.7, 2.0)
LOOK = {"at once": (COLOURS[1], "-"), "over a period": (COLOURS[0], "-")}


def courses() -> dict[str, bm.Step]:
    """Return both courses of the torque; the rise lasts a period of the first coupled mode."""
    period = 1.0 / float(bm.euler_bernoulli(BEAM, (HUB, "free"), 1).frequency[0])
    return {"at once": bm.Step(), "over a period": bm.Step(rise=period)}


def data(progress: Progress) -> xarray.Dataset:
    """Return both motions over time, the hub's rate with them, and that of a rigid bar."""
    chain, found = bm.Chain(BEAM, (HUB, "free"), SEGMENTS, RULE), []
    for i, (name, course) in enumerate(courses().items()):
        torque = bm.TimedLoad(bm.PointLoad(0.0, moment=TORQUE), course)
        motion = bm.simulate(chain, duration=DURATION, load=torque, step=STEP, output_step=EVERY)
        rate = motion.angular_velocity.isel(segment=0, drop=True).rename("hub_rate")
        kept = xarray.merge([motion[["x", "y", "tip_deflection", "load_work"]], rate])
        found.append(kept.expand_dims(torque=[name]))
        progress(i + 1, len(LOOK))
    return xarray.concat(found, "torque")


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the bar as it starts, seen from the ground, and its tip and the hub's rate over time."""
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.15])
    _stills(table, left)
    _tips(table, right)


def _stills(table: xarray.Dataset, ax: Axes) -> None:
    motion = table.sel(torque="at once")
    turn = np.linspace(0.0, 2 * np.pi, 200)
    ax.fill(np.cos(turn), np.sin(turn), color="#DDDDDD", zorder=0)
    ax.plot(0.0, 0.0, "o", color=GREY, markersize=4)
    for moment in STILLS:
        at = motion.sel(time=moment, method="nearest")
        x, y = at.x.values[1:], at.y.values[1:]
        ax.plot(x, y, "o-", color=LOOK["at once"][0], markersize=2.5)
        size = float(np.hypot(x[-1], y[-1]))
        place = (x[-1] * (1 + 0.6 / size), y[-1] * (1 + 0.6 / size))
        ax.text(*place, f"{moment:g} s", ha="center", va="center", fontsize=10)
    ax.set(xlim=(-1.4, 7.0), ylim=(-1.4, 7.0), xticks=range(0, 7, 2), yticks=range(0, 7, 2))
    ax.set_box_aspect(1.0)
    ax.set(xlabel="x  [m]", ylabel="y  [m]")
    ax.set_title(f"{TORQUE:g} N m at once, from the ground")


def _tips(table: xarray.Dataset, ax: Axes) -> None:
    texts = {"at once": "torque at once", "over a period": "rising over one\nperiod of mode 1"}
    for name, (colour, dashes) in LOOK.items():
        line = table.tip_deflection.sel(torque=name)
        ax.plot(table.time, line, color=colour, linestyle=dashes)
        ax.annotate(
            texts[name],
            (float(table.time[-1]), float(line[-1])),
            (6, 0),
            textcoords="offset points",
            va="center",
            color=colour,
            fontsize=10,
            annotation_clip=False,
        )
    ax.axhline(0.0, color="#555555", linewidth=0.8)
    ax.set(xlim=(0.0, DURATION), xlabel="time t  [s]", ylabel="tip deflection from the hub's line  [m]")
    ax.set_title(f"its tip: {RULE} chain of {SEGMENTS} rods")


STUDY = Study(
    name="hub_start",
    title="A torque that rises over one period of the first coupled mode leaves little vibration",
    caption="A bar on a freely turning hub started by a torque: seen from the ground, and its tip over time.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("torque", "time", "hub_rate", "tip_deflection", "load_work"),
            {name: Kind(decimals=8) for name in ("hub_rate", "tip_deflection", "load_work")},
            part=lambda table: table[["hub_rate", "tip_deflection", "load_work"]].isel(
                time=slice(None, None, 5)
            ),
        )
    },
    size=(9.0, 4.4),
    seconds=10.0,
)
