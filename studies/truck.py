"""Figure 2 of the report: a truck whose bed is flexible, between a cab and a load on springs."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import beammodes as bm
from beammodes.views.symbols import COLOURS, GREY, ROD, draw_block, draw_coil
from studies.common import mode_shapes, picture
from studies.study import Kind, Progress, Sheet, Study

# A light truck; the report's picture has no numbers, so these are chosen. SI units.
BED = bm.Beam(
    length=4.0,  # m, from axle to axle
    bending_stiffness=2 * 210e9 * 1.12e-5,  # two steel channels 200 x 70 x 6 mm
    mass_per_length=60.0,  # kg/m, rails and deck
)
CAB_SIZE, LOAD_SIZE = (1.7, 1.3), (1.8, 0.9)  # m, length and height
CAB_MASS, LOAD_MASS = 1800.0, 2600.0  # kg
# Solid blocks, their middles a little inboard of the axles; both springs of an axle together.
FRONT = bm.End(
    translational_stiffness=210e3,
    mass=CAB_MASS,
    rotary_inertia=CAB_MASS * (CAB_SIZE[0] ** 2 + CAB_SIZE[1] ** 2) / 12,
    offset=-0.2,
)
REAR = bm.End(
    translational_stiffness=230e3,
    mass=LOAD_MASS,
    rotary_inertia=LOAD_MASS * (LOAD_SIZE[0] ** 2 + LOAD_SIZE[1] ** 2) / 12,
    offset=-0.6,
)
SEGMENTS, STIFFER = 4, 1e4
CHAIN = bm.Chain(BED, (FRONT, REAR), SEGMENTS)
MODES = ("heave", "pitch", "bending 1", "bending 2")
# Drawing, in m: the bed's height, the wheels' radius, the gap under cab and load; the largest deflection,
# and the largest turn [rad].
HEIGHT, WHEEL, GAP, AMPLITUDE, TURN = 0.85, 0.33, 0.3, 0.25, 0.32


def data(progress: Progress) -> xarray.Dataset:
    """Return frequencies [Hz] and shapes of four modes, with this bed and with a rigid one."""
    parts = []
    for i, factor in enumerate((1.0, STIFFER)):
        bed = bm.Beam(BED.length, factor * BED.mean_bending_stiffness, BED.mean_mass_per_length)
        parts.append(mode_shapes(bm.Chain(bed, (FRONT, REAR), SEGMENTS), len(MODES)))
        progress(i + 1, 2)
    table = xarray.concat(parts, "bed").assign_coords(bed=["flexible", "rigid"], motion=("mode", list(MODES)))
    return table.assign(relative_error=table.frequency / table.exact_frequency - 1)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the truck; heave and pitch with a rigid bed and a flexible one; and the flexible bed's bending."""
    figure.get_layout_engine().set(wspace=0.05, hspace=0.03)
    panels = figure.subplots(4, 2)
    _draw_numbers(*panels[0], table)
    shown = [
        ("rigid", 0),
        ("flexible", 0),
        ("rigid", 1),
        ("flexible", 1),
        ("flexible", 2),
        ("flexible", 3),
    ]
    for ax, (bed, mode) in zip(panels[1:].flat, shown, strict=True):
        one = table.sel(bed=bed).isel(mode=mode)
        # No block may turn so far that it would strike the bed.
        amplitude = min(AMPLITUDE, TURN / float(np.abs(one.rotation).max()))
        _draw_truck(ax, one, 0.0, faint=True)
        _draw_truck(ax, one, amplitude)
        title = f"{bed} bed, {one.motion.item()}: {float(one.exact_frequency):#.4g} Hz"
        ax.set_title(title, fontweight="bold")
        if bed == "flexible":
            error = f"chain {100 * float(one.relative_error):+.2g} %".replace("-", "−")
            ax.set_title(error, loc="right", color=ROD)


def _draw_truck(ax: Axes, one: xarray.Dataset, amplitude: float, *, faint: bool = False) -> None:
    """Draw the chain between its two blocks, over the beam; or, faintly, only where they are at rest."""
    position, up = one.position.values, HEIGHT + amplitude * one.deflection.values
    angle = np.arctan(amplitude * one.rotation.values)
    look = {"colour": "none", "edge": "#BBBBBB", "zorder": 0.5} if faint else {}
    for piece, end, (length, height), side in ((0, FRONT, CAB_SIZE, -1), (-1, REAR, LOAD_SIZE, 1)):
        place = (float(position[piece]), float(up[piece]))
        box = (side * float(end.offset) - length / 2, GAP, length, height)
        draw_block(ax, place, float(angle[piece]), box, **look)
        if not faint:
            draw_block(ax, place, float(angle[piece]), (-0.12, 0.0, 0.24, GAP))
            axle = (place[0], WHEEL)
            draw_coil(ax, axle, place, width=0.24)
            ax.add_patch(Circle(axle, WHEEL, facecolor="#EEEEEE", edgecolor=GREY, linewidth=3, zorder=1))
    if faint:
        ax.plot(position, up, color="#BBBBBB", linewidth=1, zorder=0.5)
        return
    ax.axhline(0, color=GREY, linewidth=1)
    ax.plot(one.x, HEIGHT + amplitude * one.curve, color="black", linewidth=0.9, zorder=3.5)
    bm.draw_chain(CHAIN, ax, shape=(up, amplitude * one.rotation), labels=None, ends=False)
    picture(ax, (-1.2, 5.0), (-0.03, 2.78))


def _draw_numbers(ax: Axes, beside: Axes, table: xarray.Dataset) -> None:
    _draw_truck(ax, table.isel(bed=0, mode=0), 0.0)
    ax.set_title("at rest", fontweight="bold")
    top, kilonewton = HEIGHT + GAP, 1e3
    for end, x, height, name in ((FRONT, 0.2, CAB_SIZE[1], "cab"), (REAR, 3.4, LOAD_SIZE[1], "load")):
        ax.text(x, top + height / 2, f"{name}\n{end.mass:.0f} kg", ha="center", va="center")
    for end, x in ((FRONT, 0.45), (REAR, BED.length - 0.45)):
        text = f"{end.translational_stiffness / kilonewton:.0f} kN/m"
        ax.text(x, 0.28, text, color=COLOURS[1], ha="left" if x < 1 else "right", va="center", fontsize=10)
    ax.text(2.0, HEIGHT - 0.2, f"bed {BED.length:g} m", ha="center", va="top", color=ROD)
    beside.axis("off")
    stiff = float(table.exact_frequency.sel(bed="rigid").isel(mode=2))
    stiffness, mass = BED.mean_bending_stiffness / 1e6, BED.mean_mass_per_length
    text = (
        "Illustrative numbers; the report gives none.\n"
        "Bed: two steel channels 200 × 70 × 6 mm and a deck,\n"
        f"EI = {stiffness:.2g} MN m², {mass:.0f} kg/m. Cab and load: solid blocks,\n"
        "drawn to scale, fixed to its ends. Springs: both of an axle.\n"
        f"Rigid bed: EI {STIFFER:,.0f} times as large, so that its\n"
        f"bending, from {stiff:.0f} Hz on, does not matter.\n"
        "Black, and Hz: exact beam. Blue: chain, report's springs.\n"
        "Grey: at rest. Deflections are exaggerated."
    )
    beside.text(0.018, 1.0, text, va="top", fontsize=10, linespacing=1.5, transform=beside.transAxes)


STUDY = Study(
    name="truck",
    title="Figure 2 · a truck whose bed is flexible, as a chain of four rods",
    caption="Figure 2 of the report: a truck whose bed is flexible, between a cab and a load on springs.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("bed", "mode", "motion", "frequency", "exact_frequency", "relative_error"),
            {"relative_error": Kind(decimals=11)},
        ),
        "_shapes.csv": Sheet(("bed", "mode", "node", "position", "deflection", "exact_deflection")),
    },
    size=(9.0, 9.0),
)
