"""Chains drawn by code: every rule at a clamped end, pairs of ends, bodies, springs, bent shapes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.schematic import Shape, pose_of
from beammodes.views.symbols import EDGE, GREY, GROUND_SPRING, ROD, SPRING
from studies.common import moved
from studies.study import Kind, Progress, Sheet, Study, repeatable

UNIT, DRAWN = bm.Beam.unit(), 4
BLOCK = bm.End(mass=1.0, rotary_inertia=0.2**2 / 6, offset=0.1)
SPRINGS = (bm.End(math.inf, 8.0), bm.End(30.0, 0.0))


class Panel(NamedTuple):
    """A chain, what is said of it, and how it is bent."""

    chain: bm.Chain
    title: str
    text: str
    shape: Callable[[bm.Chain], Shape] | None = None
    mode: int = 1


def sections() -> dict[str, list[Panel]]:
    """Return the panels by heading."""
    chains = [
        bm.Chain(UNIT, "clamped-free", next(n for n in itertools.count(DRAWN) if rule.fits(n)), rule)
        for rule in bm.RULES.values()
    ]
    rules = [
        Panel(chain, name, f"order {rule.declared_order(chain.boundary)}")
        for chain, (name, rule) in zip(chains, bm.RULES.items(), strict=True)
    ]
    pairs = [
        _moving(name, name, mode)
        for name, mode in (
            ("clamped-clamped", 1),
            ("clamped-pinned", 2),
            ("clamped-guided", 2),
            ("pinned-pinned", 3),
            ("pinned-guided", 2),
            ("guided-free", 2),
        )
    ]
    bodies = [
        Panel(bm.Chain(UNIT, (BLOCK, "free"), DRAWN), "on a body (Figure 3)", "at rest"),
        _moving((BLOCK, "free"), "the same", 2),
        _moving(("clamped", bm.End(mass=0.5, offset=0.08)), "mass on the tip", 2),
        Panel(bm.Chain(UNIT, SPRINGS, DRAWN, "double_wall"), "on springs", "at rest"),
        _moving(SPRINGS, "the same", 1),
        _moving(
            (bm.End(math.inf, 5.0, rotary_inertia=0.02), bm.End(40.0, math.inf)), "wheel, slide, springs", 2
        ),
    ]
    bent = [
        Panel(bm.Chain(UNIT, "clamped-free", 20), "rolled up", "tip moment", _rolled),
        Panel(bm.Chain(UNIT, "clamped-free", 10), "buckled", "1.3 × buckling load", _buckled),
        Panel(bm.Chain(UNIT, ("pinned", BLOCK), 8), "falling", "pinned, with a body", _falling),
    ]
    return {
        f"The rules at a clamped end, {DRAWN} segments: springs in EI/ℓ": rules,
        "Pairs of ends, in a mode": pairs,
        "Bodies and springs at the ends": bodies,
        "Large deflections": bent,
    }


def _moving(boundary: str | tuple[str | bm.End, str | bm.End], title: str, mode: int) -> Panel:
    chain = bm.Chain(UNIT, boundary, DRAWN)
    return Panel(chain, title, f"mode {mode}", lambda chain: bm.solve_modes(bm.linearize(chain)), mode)


def _rolled(chain: bm.Chain) -> bm.Equilibrium:
    return bm.find_equilibrium(chain, bm.Load(tip_moment=1.6 * math.pi))


def _buckled(chain: bm.Chain) -> bm.Equilibrium:
    return bm.find_equilibrium(chain, bm.Load(axial_force=-1.3 * bm.buckling_load(UNIT, chain.boundary)))


def _falling(chain: bm.Chain) -> xarray.Dataset:
    return moved(chain, 0.6, 0.3, load=bm.Load(gravity=3.0)).isel(time=-1)


def data(progress: Progress) -> xarray.Dataset:
    """Return each chain's nodes, the angles of its pieces, and its springs in its own units."""
    panels = [panel for section in sections().values() for panel in section]
    parts = []
    for i, panel in enumerate(panels):
        chain = panel.chain
        pose = pose_of(chain, panel.shape and panel.shape(chain), mode=panel.mode)
        springs = np.array([np.nan, *map(float, chain.scaled.joint_stiffness), np.nan])
        columns = {"x": pose.x, "y": pose.y, "angle": repeatable(np.append(pose.angle, np.nan), 8)}
        one = {name: ("node", values) for name, values in columns.items()}
        node = {"node": np.arange(len(pose.x))}
        parts.append(xarray.Dataset(one | {"stiffness": ("node", springs)}, coords=node))
        progress(i + 1, len(panels))
    table = xarray.concat(parts, "panel", join="outer")
    return table.assign_coords(panel=[f"{panel.title}: {panel.text}" for panel in panels])


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw each group's chains in three columns, of one scale except where they bend far."""
    groups, i = sections(), 0
    parts = figure.subfigures(len(groups), 1, height_ratios=[3.9, 2.7, 2.7, 2.3])
    for part, (heading, panels) in zip(parts, groups.items(), strict=True):
        part.suptitle(heading, fontsize=11, fontweight="bold", color=EDGE, x=0.01, ha="left")
        axes = part.subplots(-(-len(panels) // 3), 3).ravel()
        for ax, panel in zip(axes, panels, strict=False):
            _draw_panel(ax, panel, table.isel(panel=i))
            i += 1
        _draw_key(list(axes[len(panels) :]))
        if len(panels) > 3:
            _share_limits(list(axes), len(panels))
        else:
            _fill_columns(list(axes))


def _draw_panel(ax: Axes, panel: Panel, one: xarray.Dataset) -> None:
    chain, moved = panel.chain, panel.shape is not None
    if moved:
        ax.plot([0, 1], [0, 0], color=GREY, linewidth=0.6, zorder=0)
    place = one.isel(node=slice(chain.pieces + 1))
    place = xarray.Dataset(
        {"x": place.x, "y": place.y, "angle": ("piece", place.angle.values[: chain.pieces])}
    )
    bm.draw_chain(chain, ax, shape=place if moved else None, labels=None if moved else "EI/ell", size=9)
    ax.set_title(panel.title, fontsize=9, fontweight="bold", loc="left", pad=2)
    ax.set_title(panel.text, fontsize=9, color=GREY, loc="right", pad=2)


def _draw_key(empty: list[Axes]) -> None:
    """Say in the places left over what the symbols are."""
    words = [
        (ROD, "○  hinge between rigid rods"),
        (SPRING, "spiral: its spring"),
        (GROUND_SPRING, "green: springs to the ground"),
        (EDGE, "dark: welded, or a point mass"),
    ]
    for ax, lines in zip(empty, (words[:2], words[2:]), strict=False):
        for row, (colour, text) in enumerate(lines):
            ax.text(0.0, 0.06 - 0.09 * row, text, color=colour, fontsize=9, va="center")
        ax.set_aspect("equal")
        ax.axis("off")


def _share_limits(axes: list[Axes], drawn: int) -> None:
    across = np.array([ax.get_xlim() for ax in axes[:drawn]])
    up = np.array([ax.get_ylim() for ax in axes[:drawn]])
    for ax in axes:
        ax.set(xlim=(across.min(), across.max()), ylim=(up.min(), up.max()))


def _fill_columns(axes: list[Axes]) -> None:
    """Let titles stand over their columns, where the pictures are narrow."""
    for ax in axes:
        ax.margins(0.08)
        ax.set_adjustable("datalim")


STUDY = Study(
    name="schematics",
    title="Chains drawn by code: draw_chain(chain, ax)",
    caption="Chains drawn by code: every rule at a clamped end, pairs of ends, bodies, springs, bent shapes.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("panel", "node", "x", "y", "stiffness"), {"x": Kind(decimals=8), "y": Kind(decimals=8)}
        )
    },
    size=(9.0, 11.9),
)
