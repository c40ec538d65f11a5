"""The truck of Figure 2 with its axles inside the bed: springs, a cab, a step of mass along a beam."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import beammodes as bm
from beammodes.views.symbols import (
    COLOURS,
    GREY,
    ROD,
    draw_block,
    draw_coil,
    draw_hinge,
    draw_rods,
    draw_spiral,
)
from studies.common import picture
from studies.study import Kind, Progress, Sheet, Study
from studies.truck import BED, CAB_MASS, CAB_SIZE, FRONT, GAP, HEIGHT, STIFFER, TURN, WHEEL

# As the truck of studies/truck.py, whose axles are at the ends of its bed; the bed is longer, and the load
# lies on it loose, as sand does. SI units.
LENGTH, CAB, AXLES, LOADED = 6.0, 0.75, (1.1, 4.7), 2.2  # m from the front
SAND, SAND_HEIGHT = 700.0, 0.75  # kg/m, m
SPRINGS = (210e3, 380e3)  # N/m, both of an axle together
MODES = ("heave", "pitch", "bending 1", "bending 2")
SEGMENTS, RULES = 14, ("gregory", "mitiguy")
AMPLITUDE = 0.25


def truck(stiffness: float) -> bm.Structure:
    """Return the truck as a beam with stations, its bed of some EI."""
    bare = BED.mean_mass_per_length
    mass = bm.Table([0.0, LOADED, LOADED, LENGTH], [bare, bare, bare + SAND, bare + SAND])
    cab = bm.Station(CAB, mass=CAB_MASS, rotary_inertia=float(FRONT.rotary_inertia))
    axles = [bm.Station(x, translational_stiffness=k) for x, k in zip(AXLES, SPRINGS, strict=True)]
    return bm.Structure.of_beam(bm.Beam(LENGTH, stiffness, mass), "free-free", [cab, *axles])


def data(progress: Progress) -> xarray.Dataset:
    """Return frequencies and shapes of four modes, of a rigid bed's too, and errors of chains."""
    count, flexible = len(MODES), truck(BED.mean_bending_stiffness)
    exact = bm.structure_modes(flexible, count)
    rigid = bm.structure_modes(truck(STIFFER * BED.mean_bending_stiffness), count)
    error = np.full((len(RULES), 2, count), np.nan)
    for i, rule in enumerate(RULES):
        for j, corrected in enumerate((True, False)):
            chain = bm.StructureChain(flexible, SEGMENTS, rule, corrected=corrected)
            found = bm.structure_chain_modes(chain, count).angular_frequency
            error[i, j] = found / exact.angular_frequency - 1
        progress(i + 1, len(RULES))
    chain = bm.StructureChain(flexible, SEGMENTS, RULES[0])
    modes = bm.structure_chain_modes(chain, count)
    position = np.unique(np.concatenate(modes.hinges).round(12))
    x = np.linspace(0.0, LENGTH, 241)
    curve, deflection = exact.shape(x), modes.shape(position)
    scale = 1 / np.abs(curve).max(axis=1, keepdims=True)
    # Either sign is a mode: take the beam's.
    sign = np.sign((deflection * exact.shape(position)).sum(axis=1, keepdims=True))
    return xarray.Dataset(
        {
            "frequency": ("mode", modes.frequency),
            "exact_frequency": ("mode", exact.frequency),
            "rigid_bed_frequency": ("mode", rigid.frequency),
            "relative_error": (("rule", "applied_at", "mode"), error),
            "deflection": (("mode", "node"), deflection * sign * scale),
            "curve": (("mode", "x"), curve * scale),
        },
        coords={
            "rule": list(RULES),
            "applied_at": ["every node", "ends only"],
            "mode": range(1, count + 1),
            "motion": ("mode", list(MODES)),
            "position": ("node", position),
            "x": x,
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the truck at rest and in four modes."""
    figure.get_layout_engine().set(wspace=0.05, hspace=0.03)
    panels = figure.subplots(3, 2)
    _draw_numbers(*panels[0], table)
    for ax, mode in zip(panels[1:].flat, range(len(MODES)), strict=True):
        one = table.isel(mode=mode)
        slope = np.abs(np.gradient(one.curve.values, one.x.values)).max()
        amplitude = min(AMPLITUDE, TURN / float(slope))
        _draw_truck(ax, one, 0.0, faint=True)
        _draw_truck(ax, one, amplitude)
        rigid = f" (rigid bed {float(one.rigid_bed_frequency):#.4g})" if mode < 2 else ""
        title = f"{one.motion.item()}: {float(one.exact_frequency):#.4g} Hz{rigid}"
        ax.set_title(title, fontweight="bold")
        error = 100 * float(one.relative_error.sel(rule=RULES[0], applied_at="every node"))
        ax.set_title(f"chain {error:+.1g} %".replace("-", "−"), loc="right", color=ROD)


def _draw_truck(ax: Axes, one: xarray.Dataset, amplitude: float, *, faint: bool = False) -> None:
    """Draw the chain over the beam, with what stands on it; or, faintly, only where they are at rest."""
    position, up = one.position.values, HEIGHT + amplitude * one.deflection.values
    look = {"colour": "none", "edge": "#BBBBBB", "zorder": 0.5} if faint else {}
    at = (CAB, float(np.interp(CAB, position, up)))
    slope = np.gradient(one.curve.values, one.x.values)
    angle = float(np.arctan(amplitude * np.interp(CAB, one.x, slope)))
    length, height = CAB_SIZE
    draw_block(ax, at, angle, (-length / 2, GAP, length, height), **look)
    loaded = np.linspace(LOADED, LENGTH, 41)
    floor = np.interp(loaded, one.x, HEIGHT + amplitude * one.curve.values)
    heap = SAND_HEIGHT * np.minimum(1.0, 2.5 * np.minimum(loaded - LOADED, LENGTH - loaded))
    if faint:
        ax.plot(loaded, floor + heap, color="#BBBBBB", linewidth=1, zorder=0.5)
        ax.plot(position, up, color="#BBBBBB", linewidth=1, zorder=0.5)
        return
    ax.fill_between(loaded, floor, floor + heap, color="#EAD9B0", linewidth=0)
    draw_block(ax, at, angle, (-0.12, 0.0, 0.24, GAP))
    for x in AXLES:
        coil = (x, float(np.interp(x, position, up)))
        draw_coil(ax, (x, WHEEL), coil, width=0.24)
        ax.add_patch(Circle((x, WHEEL), WHEEL, facecolor="#EEEEEE", edgecolor=GREY, linewidth=3, zorder=1))
    ax.axhline(0, color=GREY, linewidth=1)
    ax.plot(one.x, HEIGHT + amplitude * one.curve, color="black", linewidth=0.9, zorder=3.5)
    draw_rods(ax, position, up)
    for x, y in zip(position[1:-1], up[1:-1], strict=True):
        draw_spiral(ax, (x, y), 0.085, inner=0.04)
        draw_hinge(ax, (x, y), 0.03)
    picture(ax, (-0.8, 6.25), (-0.03, 2.95))


def _draw_numbers(ax: Axes, beside: Axes, table: xarray.Dataset) -> None:
    _draw_truck(ax, table.isel(mode=0), 0.0)
    ax.set_title("at rest", fontweight="bold")
    top, kilonewton = HEIGHT + GAP, 1e3
    ax.text(CAB, top + CAB_SIZE[1] / 2, f"cab\n{CAB_MASS:.0f} kg", ha="center", va="center")
    sand = SAND * (LENGTH - LOADED)
    ax.text((LOADED + LENGTH) / 2, HEIGHT + 0.4, f"load {sand:.0f} kg", ha="center", va="center")
    for x, k in zip(AXLES, SPRINGS, strict=True):
        where: dict[str, Any] = {"ha": "left", "va": "center", "color": COLOURS[1], "fontsize": 10}
        ax.text(x + 0.42, 0.35, f"{k / kilonewton:.0f} kN/m", **where)
    ax.text(3.4, HEIGHT - 0.2, f"bed {LENGTH:g} m", ha="center", va="top", color=ROD)
    beside.axis("off")
    error = 100 * table.relative_error.sel(mode=3)
    ends = error.sel(rule=RULES[0], applied_at="ends only").item()
    report = error.sel(rule="mitiguy", applied_at="every node").item()
    text = (
        "Illustrative numbers; the report gives none. Bed of\n"
        "Figure 2's truck, longer; axles, cab and the load's\n"
        "edge are stations inside it.\n"
        f"Black, and Hz: exact beam. Blue: chain of {SEGMENTS}\n"
        f"segments, {RULES[0]} at every node. Bending 1 errs by\n"
        f"{ends:+.2g} % with it at the ends only, by {report:+.2g} % with\n"
        "the report's springs at every node.\n"
        "Grey: at rest. Deflections are exaggerated."
    ).replace("-", "−")
    beside.text(0.018, 1.0, text, va="top", fontsize=10, linespacing=1.5, transform=beside.transAxes)


STUDY = Study(
    name="truck_frame",
    title="Figure 2 again, with the axles where they are: inside the bed",
    caption="The truck of Figure 2 with its axles, its cab and the edge of its load inside the bed: exact "
    "modes, and a chain with the rule at every node.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("mode", "motion", "frequency", "exact_frequency", "rigid_bed_frequency"),
        ),
        "_errors.csv": Sheet(
            ("rule", "applied_at", "mode", "relative_error"), {"relative_error": Kind(decimals=11)}
        ),
    },
    size=(9.0, 6.8),
)
