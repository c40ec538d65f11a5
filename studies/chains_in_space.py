"""Chains in space drawn by code: a helix at rest and in two modes, a blade, a hook, a bend of 45 degrees."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.schematic_in_space import pose_in_space
from studies.study import Kind, Progress, Sheet, Study

#: A helical spring of steel wire, 3 mm thick: E 206 GPa, ν 0.29, 7850 kg/m³; three turns of radius 30 mm.
_WIRE = bm.Circle(0.003)
_E, _NU, _DENSITY = 206e9, 0.29, 7850.0
HELIX = bm.Rod.helix(
    radius=0.03,
    pitch=0.025,
    turns=3,
    bending_stiffness=_E * _WIRE.second_moment,
    torsional_stiffness=_E / (2 * (1 + _NU)) * 2 * _WIRE.second_moment,
    mass_per_length=_DENSITY * _WIRE.area,
)
BLADE = bm.Rod.pretwisted(
    math.pi / 2,
    length=1.0,
    bending_stiffness=16.0,
    second_bending_stiffness=1.0,
    torsional_stiffness=1.0,
    mass_per_length=1.0,
)
HOOK = bm.Rod.hook(
    straight=0.6,
    radius=0.15,
    angle=math.pi,
    bending_stiffness=1.0,
    torsional_stiffness=1 / 1.3,
    mass_per_length=1.0,
)
#: Bathe and Bolourchi 1979: 45 degrees of a circle of radius 100, section 1 x 1, E = 1e7, G = E/2.
BEND = bm.Rod.arc(
    math.pi / 4,
    length=25 * math.pi,
    bending_stiffness=1e7 / 12,
    torsional_stiffness=1e7 / 12,
    mass_per_length=1.0,
)
#: Of the modes, in lengths of the wire.
AMPLITUDE = 0.05


class Panel(NamedTuple):
    """A chain, what is said of it, and where it is."""

    chain: bm.SpatialChain
    title: str
    shape: bm.SpatialModes | bm.SpatialEquilibrium | None = None
    mode: int = 1


@cache
def panels() -> tuple[Panel, ...]:
    """Return the panels in reading order, their modes and shapes solved for once."""
    helix = bm.SpatialChain(HELIX, "clamped-free", 36, "gregory")
    modes = bm.spatial_modes(helix, 3)
    found = [Panel(helix, "helix of 3 turns, N = 36, at rest")]
    found += [Panel(helix, f"its mode {n}, {modes.frequency[n - 1]:.1f} Hz", modes, n) for n in (1, 3)]
    blade = bm.SpatialChain(BLADE, "clamped-free", 12, "gregory")
    hook = bm.SpatialChain(HOOK, ("clamped", bm.RodEnd(mass=0.2)), 14, "gregory")
    bend = bm.SpatialChain(BEND, "clamped-free", 10, "gregory")
    load = bm.SpatialLoad(force=(0.0, 0.0, 600.0))
    return (
        *found,
        Panel(blade, "blade, twisted by 90°, N = 12"),
        Panel(hook, "hook with a mass at its tip, N = 14"),
        Panel(bend, "bend of 45° under F = 600, N = 10", bm.spatial_equilibrium(bend, load)),
    )


def data(progress: Progress) -> xarray.Dataset:
    """Return the nodes of every panel at rest and as drawn."""
    shown = panels()
    size = max(len(panel.chain.nodes) for panel in shown)
    rest, drawn = np.full((2, len(shown), size, 3), np.nan)
    for i, panel in enumerate(shown):
        count = len(panel.chain.nodes)
        rest[i, :count] = panel.chain.nodes
        drawn[i, :count] = pose_in_space(panel.chain, panel.shape, mode=panel.mode, amplitude=AMPLITUDE).nodes
        progress(i + 1, len(shown))
    columns = {
        f"{name}{axis}": (("panel", "node"), values[:, :, k])
        for name, values in (("rest_", rest), ("", drawn))
        for k, axis in enumerate("xyz")
    }
    return xarray.Dataset(
        columns, coords={"panel": [panel.title for panel in shown], "node": range(1, size + 1)}
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the chains of the table."""
    for i, panel in enumerate(panels()):
        ax = figure.add_subplot(2, 3, i + 1, projection="3d")
        bm.draw_chain(panel.chain, ax, shape=panel.shape, mode=panel.mode, amplitude=AMPLITUDE, size=9)
        ax.set_title(str(table.panel.values[i]))


_COLUMNS = ("rest_x", "rest_y", "rest_z", "x", "y", "z")

STUDY = Study(
    name="chains_in_space",
    title="Chains in space drawn by code: draw_chain(chain)",
    caption="Chains in space: a helix at rest and in two modes, a twisted blade, a hook, and a bend under a "
    "force across its plane.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("panel", "node", *_COLUMNS), {name: Kind(decimals=7) for name in _COLUMNS}),
    },
    size=(11.0, 7.6),
)
