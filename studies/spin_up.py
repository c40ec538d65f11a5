"""A beam spun up from rest to 6 rad/s, as a film, and its tip's deflection for 4, 10 and 20 rods."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.animation import plot_motion, seen_from
from beammodes.views.film import film_bytes, film_of
from beammodes.views.symbols import COLOURS, STYLE
from studies.common import moved
from studies.figure_1 import AT, BEAM, BOUNDARY, LARGEST, MOTIONS, metres
from studies.study import Kind, Progress, Sheet, Study

BASE = MOTIONS["rotational"][0]
DURATION, EVERY = 20.0, 0.02
RULE, SEGMENTS, FILMED = "gregory", (4, 10, 20), 10
#: The film: frames a second and seconds.
RATE, LASTING = 12.5, 8.0
#: Times at which the still shows the beam [s], and how far its label is moved up [points].
STILLS = {0.0: 3.0, 3.0: 0.0, 5.0: 0.0, AT: -3.0, 10.0: 0.0, 12.0: 0.0, 15.0: -9.0}
LOOK = {4: (COLOURS[4], "-"), 10: (COLOURS[0], "-"), 20: (COLOURS[1], (0, (3, 2)))}


def data(progress: Progress) -> xarray.Dataset:
    """Return tip deflections over time, by N, and the nodes of the chain that is filmed."""
    lines, filmed = [], xarray.Dataset()
    for i, n in enumerate(SEGMENTS):
        motion = moved(bm.Chain(BEAM, BOUNDARY, n, RULE), DURATION, EVERY, base=BASE)
        lines.append(motion.tip_deflection)
        if n == FILMED:
            filmed = motion[["x", "y"]]
        progress(i + 1, len(SEGMENTS))
    return filmed.assign(tip_deflection=xarray.concat(lines, "segments")).assign_coords(
        segments=list(SEGMENTS)
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the bent beam at some moments as the hub sees it, and its tip over time."""
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.35])
    _stills(table, left)
    _tips(table, right)


def _stills(table: xarray.Dataset, ax: Axes) -> None:
    time, x, y = seen_from(BASE, table)
    for moment, side in STILLS.items():
        k = int(np.abs(time - moment).argmin())
        late = moment > AT
        ax.plot(x[k], y[k], "o-", color=COLOURS[1] if late else COLOURS[0], markersize=3)
        ax.annotate(
            f"{moment:g} s",
            (x[k, -1], y[k, -1]),
            (6, side),
            textcoords="offset points",
            va="center",
            color=COLOURS[1] if late else COLOURS[0],
            fontsize=10,
            annotation_clip=False,
        )
    ax.set(xlim=(0, 10), ylim=(-0.62, 0.06))
    ax.set_xlabel("x in the turning frame  [m]")
    ax.set_ylabel("deflection  [m]")
    ax.set_title(f"{FILMED} rods, seen from the hub")


def _tips(table: xarray.Dataset, ax: Axes) -> None:
    for row, n in enumerate(SEGMENTS):
        line = table.tip_deflection.sel(segments=n)
        colour, dashes = LOOK[n]
        ax.plot(table.time, line, color=colour, linestyle=dashes)
        ax.text(
            0.98, 0.38 - 0.08 * row, f"{n} rods  {metres(float(line.min()))}", color=colour, **_corner(ax)
        )
    ax.plot(AT, LARGEST, "o", color="black", markersize=5, zorder=6)
    place = 0.38 - 0.08 * len(SEGMENTS)
    ax.text(0.98, place, f"● the beam  {metres(LARGEST)}", **_corner(ax))
    ax.set(xlim=(0, DURATION), ylim=(-0.62, 0.06), xticks=range(0, 21, 5))
    ax.set_xlabel("time t  [s]")
    ax.set_ylabel("tip deflection  [m]")
    ax.set_title(f"its tip: {RULE} chains, and their lowest points")


def _corner(ax: Axes) -> dict[str, Any]:
    return {"transform": ax.transAxes, "ha": "right", "va": "top", "fontsize": 10}


def film(table: xarray.Dataset) -> bytes:
    """Return the motion as a GIF: seen from the ground, from the hub, and the tip's deflection."""
    with matplotlib.rc_context(STYLE | {"font.size": 8, "axes.grid": False}):
        figure = Figure(figsize=(4.8, 2.5), dpi=100, layout="constrained")
        panels = figure.subplot_mosaic([["still", "hub"], ["still", "tip"]], width_ratios=[1, 1.1])
        updates = [
            plot_motion(table, panels["still"], trace=0.8),
            plot_motion(table, panels["hub"], base=BASE, trace=DURATION, stretch=8.0, clock=False),
        ]
        for ax, title in (
            (panels["still"], "seen from the ground"),
            (panels["hub"], "from the hub, y eightfold"),
        ):
            ax.set(title="", xlabel="", ylabel="")
            ax.set_title(title, fontsize=8, loc="left")
        tip = panels["tip"]
        deflection = table.tip_deflection.sel(segments=FILMED)
        tip.plot(table.time, deflection, color="#BBBBBB")
        (dot,) = tip.plot([], [], "o", color=COLOURS[1])
        tip.set(xlim=(0, DURATION), ylim=(-0.65, 0.08))
        tip.set_title("tip deflection [m] over time [s]", fontsize=8, loc="left")

        def update(moment: float) -> None:
            for part in updates:
                part(moment)
            dot.set_data([moment], [float(deflection.sel(time=moment, method="nearest"))])

        made = film_of(figure, update, table.time.values, fps=RATE, duration=LASTING)
        return film_bytes(made, ".gif", fps=RATE)


STUDY = Study(
    name="spin_up",
    title="Spin-up to 6 rad/s in 15 s: the beam lags behind, then straightens",
    caption="A beam spun up from rest to 6 rad/s, and its tip's deflection for 4, 10 and 20 rods.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("segments", "time", "tip_deflection"),
            {"tip_deflection": Kind(decimals=8)},
            part=lambda table: table.isel(time=slice(None, None, 5)),
        )
    },
    size=(9.0, 4.4),
    more=lambda table: {".gif": film(table)},
    seconds=20.0,
)
