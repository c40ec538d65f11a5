"""Chains of structures drawn by code: stations, frames, branches, in a mode; diagrams of their statics."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.schematic_of_structures import pose_of_structure
from beammodes.views.symbols import GREY
from studies.study import Kind, Progress, Sheet, Study, repeatable

BAR, HELD = bm.Beam.unit(), math.inf


class Panel(NamedTuple):
    """A chain, what is said of it, and the mode that it is in, 0 at rest."""

    chain: bm.StructureChain
    title: str
    text: str
    mode: int = 0


def _bars(places: dict[str, bm.Joint], *pairs: str) -> bm.Structure:
    named = [(pair[0], pair[1]) for pair in pairs]
    return bm.Structure.of_bars(places, named, bending_stiffness=1.0, mass_per_length=1.0)


@cache
def portal() -> bm.Structure:
    """Return a portal frame, one of whose feet is pinned."""
    joints = {
        "a": bm.Joint(0, 0, "clamped"),
        "b": bm.Joint(0, 1),
        "c": bm.Joint(1, 1, mass=0.2, rotary_inertia=0.002),
        "d": bm.Joint(1, 0, "pinned"),
    }
    return _bars(joints, "ab", "bc", "cd")


@cache
def panels() -> list[Panel]:
    """Return what is drawn of chains."""
    motor = bm.Station(0.45, mass=0.3, rotary_inertia=0.002)
    stations = [motor, bm.Station(0.75, hinge=4.0)]
    arm = bm.Structure.of_beam(BAR, "clamped-free", stations)
    edge = bm.Structure.of_beam(BAR, "pinned-free", [bm.Station(0.35, 60.0), bm.Station(0.75, HELD)])
    joints = {
        "r": bm.Joint(0, 0, "clamped"),
        "f": bm.Joint(0, 0.7),
        "l": bm.Joint(-0.35, 1.2),
        "t": bm.Joint(0.2, 1.5),
        "s": bm.Joint(0.6, 1.2, mass=0.05),
    }
    plant = bm.StructureChain(_bars(joints, "rf", "fl", "ft", "ts"), [4, 4, 4, 3], "half_stub_corrected")
    links = [
        bm.Member(BAR, "shoulder", "elbow"),
        bm.Member(bm.Beam(0.8, 0.5, 0.5), "elbow", "hand", start_hinge=2.0),
    ]
    places = {
        "shoulder": bm.Joint(0, 0, (HELD, HELD, 6.0)),
        "elbow": bm.Joint(1, 0),
        "hand": bm.Joint(1, -0.8, mass=0.2),
    }
    robot = bm.StructureChain(bm.Structure(places, links), [4, 3])
    return [
        Panel(bm.StructureChain(arm, [3, 2, 2]), "a motor and a crack", "at rest"),
        Panel(bm.StructureChain(arm, [3, 2, 2]), "the same", "mode 2", 2),
        Panel(bm.StructureChain(edge, [2, 3, 2]), "a spring, a knife edge", "at rest"),
        Panel(bm.StructureChain(portal(), [4, 4, 4]), "a portal frame", "at rest"),
        Panel(bm.StructureChain(portal(), [4, 4, 4]), "the same", "mode 2", 2),
        Panel(robot, "two links, sprung joints", "at rest"),
        Panel(plant, "a branched plant", "at rest"),
        Panel(plant, "the same", "mode 2", 2),
    ]


@cache
def diagrams() -> list[tuple[str, str, bm.StructureStatics]]:
    """Return what is drawn of statics: a title, a quantity, and the statics."""
    beam = bm.Beam(4.0, 3.0, 1.0)
    loads = [bm.LineLoad(-2.0, stop=2.0), bm.PointLoad(3.0, force=-5.0)]
    loaded = bm.beam_statics(beam, "clamped-pinned", loads)
    pushed = bm.structure_statics(
        portal(), [bm.PointLoad(joint="b", force=(1.0, 0.0)), bm.LineLoad(-2.0, member="b-c")]
    )
    return [
        ("a load and a force", "moment", loaded),
        ("the same", "shear", loaded),
        ("a load and a push", "moment", pushed),
        ("the same", "deflection", pushed),
    ]


@cache
def _modes(panel: int) -> bm.StructureChainModes:
    return bm.structure_chain_modes(panels()[panel].chain)


def data(progress: Progress) -> xarray.Dataset:
    """Return the places of nodes of each chain, and the values of each diagram at its edges."""
    parts = []
    for i, panel in enumerate(panels()):
        shape = _modes(i) if panel.mode else None
        nodes = pose_of_structure(panel.chain, shape, mode=panel.mode or 1).nodes
        node = {"node": np.arange(len(nodes))}
        columns = {name: ("node", repeatable(nodes[:, k], 8)) for k, name in enumerate("xy")}
        parts.append(xarray.Dataset(columns, coords=node))
        progress(i + 1, len(panels()))
    table = xarray.concat(parts, "panel", join="outer")
    table = table.assign_coords(
        panel=[f"{panel.title}: {panel.text}, {i}" for i, panel in enumerate(panels())]
    )
    values = []
    for title, quantity, found in diagrams():
        for member in found.structure.members:
            for x in found.edges(member.name).tolist():
                value = getattr(found, quantity)(x, member.name)
                values.append((title, quantity, member.name, x, value))
    rows = list(zip(*values, strict=True))
    names = ("diagram", "quantity", "member", "at")
    coords = {name: ("edge", list(row)) for name, row in zip(names, rows[:4], strict=True)}
    return table.assign(value=("edge", repeatable(rows[4], 9))).assign_coords(coords)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw each chain and each diagram."""
    del table  # Its numbers are those of the pictures.
    axes = figure.subplots(4, 3, height_ratios=(1.0, 2.2, 2.2, 2.2)).ravel()
    for i, (ax, panel) in enumerate(zip(axes, panels(), strict=False)):
        shape = _modes(i) if panel.mode else None
        bm.draw_chain(
            panel.chain,
            ax,
            shape=shape,
            mode=panel.mode or 1,
            labels=None if panel.mode else "EI/ell",
            size=8,
        )
        # Titles stand over their columns, where the pictures are narrow.
        ax.margins(0.1)
        ax.set_adjustable("datalim")
        _say(ax, panel.title, panel.text)
    for ax, (title, quantity, found) in zip(axes[len(panels()) :], diagrams(), strict=True):
        bm.draw_statics(found, ax, quantity=quantity, size=8)
        ax.set_adjustable("datalim")
        ax.tick_params(labelsize=8)
        ax.xaxis.label.set_size(8)
        ax.yaxis.label.set_size(8)
        _say(ax, title, quantity)


def _say(ax: Axes, title: str, text: str) -> None:
    ax.set_title(title, fontsize=9, fontweight="bold", loc="left", pad=2)
    ax.set_title("", loc="center")
    ax.set_title(text, fontsize=9, color=GREY, loc="right", pad=2)


STUDY = Study(
    name="frames",
    title="Structures drawn by code: draw_chain(chain, ax) and draw_statics(statics, ax)",
    caption="Structures drawn by code: stations, a portal frame, links, a plant, their modes, and diagrams "
    "of moment, shear and deflection.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("panel", "node", "x", "y"), {"x": Kind(decimals=8), "y": Kind(decimals=8)}),
        "_diagrams.csv": Sheet(
            ("diagram", "quantity", "member", "at", "value"),
            {"value": Kind(decimals=9)},
            part=lambda table: table[["value"]].swap_dims(edge="edge"),
        ),
    },
    size=(9.0, 9.0),
)
