"""The figure of the step size: C against N, how the chain diverges, what the variable step does."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from beammodes.views.symbols import COLOURS, GREY, STYLE
from studies.step_size_data import RECIPE_MODES, SHOWN, SMALL, STARTS, STEPS, TOLERANCES


def draw(table: xarray.Dataset) -> Figure:
    """C against N; how the chain diverges; what the variable step does about it."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 8.0), layout="constrained")
        panels = figure.subplot_mosaic(
            [["constants", "growth"], ["constants", "recipe"]], width_ratios=(1.08, 1)
        )
        figure.suptitle(
            "The published step is too long; the variable-step integrator hid it",
            fontsize=13,
            fontweight="bold",
            x=0.01,
            ha="left",
        )
        _draw_constants(table, panels["constants"])
        _draw_growth(table, panels["growth"])
        _draw_recipe(table, panels["recipe"])
    return figure


def _write(ax: Axes, x: float, y: float, text: str, colour: str, **how: object) -> None:
    halo = [withStroke(linewidth=2.5, foreground="white")]
    ax.text(x, y, text, color=colour, path_effects=halo, **{"fontsize": 9.5, "va": "center", **how})


def _draw_constants(table: xarray.Dataset, ax: Axes) -> None:
    free = table.sel(boundary=SHOWN[0])
    undamped, damped = free.isel(damping_ratio=0), free.isel(damping_ratio=1)
    for modes in (1, 3, 5):
        line = free.C_published.sel(modes=modes)
        ax.plot([modes, 12], [line, line], color=COLOURS[1])
        _write(ax, 12.6, float(line), f"published,\n{modes} mode{'s' if modes > 1 else ''}", COLOURS[1])
    stable = undamped.C_stable.sel(integrator="rk4")
    ax.plot(table.segments, stable, color=COLOURS[0], marker="o")
    ax.plot(table.segments, free.C_safe, color=GREY, linestyle=(0, (4, 2)))
    late = slice(5, None)
    ax.plot(
        table.segments[late],
        damped.C_stable.sel(integrator="rk4")[late],
        color=COLOURS[4],
        marker="v",
    )
    accurate = undamped.C.sel(integrator="rk4", modes=3)
    ax.plot(table.segments, accurate, color=COLOURS[2], marker="s", markersize=3.5)
    for modes in (1, 3):
        line = undamped.C.sel(integrator="midpoint", modes=modes)
        ax.plot(table.segments, line, color=COLOURS[3], linestyle=(0, (1, 1)), linewidth=2)
    _write(ax, 1.15, 0.95, "Runge-Kutta, stable: 2√2/ω_max", COLOURS[0])
    _write(ax, 0.95, 0.068, "safe bound\n0.408/N²", GREY)
    _write(ax, 0.95, 0.0245, "midpoint,\n1 mode accurate", COLOURS[3])
    _write(ax, 2.85, 2.3e-3, "midpoint,\n3 modes accurate", COLOURS[3], ha="right")
    _write(ax, 0.95, 6.6e-3, "Runge-Kutta,\n3 modes accurate\n(and stable)", COLOURS[2])
    _write(ax, 7.4, 8e-4, "Runge-Kutta, stable\nwith joint damping:\n1 % in mode 1", COLOURS[4], ha="right")
    ax.set(xscale="log", yscale="log", xlim=(0.9, 26), ylim=(3e-4, 1.3))
    ax.set_xticks([1, 2, 3, 4, 6, 8, 12], ["1", "2", "3", "4", "6", "8", "12"])
    ax.minorticks_off()
    ax.set_xlabel("number of segments N")
    ax.set_ylabel("C in  h = C L² √(ρA/EI)")
    ax.set_title("Clamped-free: the constant C", fontsize=11, loc="left")


def _draw_growth(table: xarray.Dataset, ax: Axes) -> None:
    looks = {"0.99": COLOURS[2], "1.01": COLOURS[4], "1.5": COLOURS[1], "published 1": COLOURS[6]}
    top = 2e5
    for start, dashes in ((SMALL, "-"), (STARTS[1], (0, (3, 1.5)))):
        for name, colour in looks.items():
            course = table.angle.sel(start=start, fixed_step=name).dropna("number")
            numbers = np.concatenate([[0.7], course.number])
            angle = np.concatenate([[start], course])
            angle = np.where(np.isinf(angle), np.nan, angle)
            ax.plot(numbers, angle, color=colour, linestyle=dashes, linewidth=1.4)
    _write(ax, 9, 2e4, "← published (1 mode): 11.7 × limit", COLOURS[6])
    _write(ax, 9, 1e3, "← 1.5 × limit", COLOURS[1])
    _write(ax, 120, 3e-5, "1.01 × limit:\ngrows 7.3 % a\nstep, saturates", COLOURS[4])
    _write(ax, 20, 2.5e-8, "0.99 × limit: bounded", COLOURS[2])
    _write(ax, 9, 8, "dashed: from 0.5 rad", GREY)
    ax.set(xscale="log", yscale="log", xlim=(0.7, STEPS), ylim=(8e-9, top))
    ax.set_xticks([1, 10, 100, 1000], ["1", "10", "100", "1000"])
    ax.set_yticks([1e-8, 1e-6, 1e-4, 1e-2, 1, 100, 1e4])
    ax.minorticks_off()
    ax.set_xlabel("steps of fixed-step Runge-Kutta")
    ax.set_ylabel("largest angle  [rad]")
    ax.set_title(f"What a fixed step does ({SHOWN[0]}, N = {SHOWN[1]})", fontsize=11, loc="left")


def _draw_recipe(table: xarray.Dataset, ax: Axes) -> None:
    free = table.sel(boundary=SHOWN[0], rtol=TOLERANCES[0])
    for colour, modes in zip((COLOURS[1], COLOURS[0]), RECIPE_MODES, strict=True):
        line = free.sel(recipe_modes=modes)
        ax.plot(table.segments, line.evaluations, color=colour, marker="o")
        fixed = 4 * line.step_over_limit_asked
        ax.plot(table.segments, fixed.where(fixed >= 4), color=colour, linestyle=(0, (4, 2)))
    ax.axhline(4, color=COLOURS[6], linewidth=1.2)
    _write(ax, 1.0, 2.3, "as published, at fixed step: 4; diverges from N = 2", COLOURS[6])
    last = free.isel(segments=-1)
    for colour, modes in zip((COLOURS[1], COLOURS[0]), RECIPE_MODES, strict=True):
        end = last.sel(recipe_modes=modes)
        name = f"h for {modes} mode{'s' if modes > 1 else ''}:"
        _write(ax, 13, float(end.evaluations), f"{name}\nvariable step", colour)
        _write(ax, 13, 4 * float(end.step_over_limit_asked), "fixed, at limit", colour)
    ax.set(xscale="log", yscale="log", xlim=(0.9, 34), ylim=(1, 5000))
    ax.set_xticks([1, 2, 3, 4, 6, 8, 12], ["1", "2", "3", "4", "6", "8", "12"])
    ax.set_yticks([1, 4, 10, 100, 1000], ["1", "4", "10", "100", "1000"])
    ax.minorticks_off()
    ax.set_xlabel("number of segments N")
    ax.set_ylabel("evaluations per published step")
    ax.set_title("What the variable step (tolerance 0.001) does", fontsize=11, loc="left")
