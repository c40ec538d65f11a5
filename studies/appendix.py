"""The report's appendix: modes A1 to A3 of a pinned-pinned beam, and how many of them are enough."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import beammodes as bm
from beammodes.exact.exact_beam import BeamModes, plain_modes
from beammodes.numerics.arrays import Floats
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, label_line, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

BEAM, BOUNDARY = bm.Beam.unit(), "pinned-pinned"
#: The beam is held aside by a force here, then let go.
AT, DRAWN = 0.3, 3
MODES = 50
#: Deflection and bending moment over EI: names, and derivatives of the shape.
QUANTITIES = {"deflection": 0, "moment": 2}
#: Where sums of one, two and three modes are named.
PLACES = ((8.0, 6.0), (4.0, 8.0), (-3.0, 17.0))


def plucked(shapes: BeamModes, force: float, at: float) -> Floats:
    """Return modal coordinates  q_n = F φ_n(a) / ω_n²  of a beam that a force F at a holds aside."""
    return np.asarray(force * shapes.shape(at) / shapes.angular_frequency**2)


def pinned_shape(beam: bm.Beam, force: float, at: float, x: ArrayLike, derivative: int = 0) -> Floats:
    """Return deflection, slope or curvature of a pinned-pinned beam that a force at `at` holds aside.

        y = F b x (L² - b² - x²) / (6 EI L)  for x ≤ a = L - b,  and its mirror image beyond

    Source: S. P. Timoshenko, Strength of Materials, part I (1930), chapter V.
    """
    length, position = beam.length, np.asarray(x, dtype=np.float64)
    beyond = position > at
    # Seen from the nearer support of the two: a mirror changes the sign of the slope.
    arm, near = np.where(beyond, at, length - at), np.where(beyond, length - position, position)
    rest = length**2 - arm**2
    values = (near * (rest - near**2), np.where(beyond, -1.0, 1.0) * (rest - 3 * near**2), -6 * near)
    return np.asarray(force * arm * values[derivative] / (6 * beam.mean_bending_stiffness * length))


def data(progress: Progress) -> xarray.Dataset:
    """Return mode shapes, sums of them, and the sums' largest errors over the shape's largest value."""
    x = np.linspace(0.0, 1.0, 201)
    beam = plain_modes(BEAM, BOUNDARY, MODES)
    q = plucked(beam, 1.0, AT)
    exact, sums = [], []
    for i, derivative in enumerate(QUANTITIES.values()):
        exact.append(pinned_shape(BEAM, 1.0, AT, x, derivative))
        sums.append(np.cumsum(q[:, None] * beam.shape(x, derivative), axis=0))
        progress(i + 1, len(QUANTITIES))
    exact, sums = np.array(exact), np.array(sums)
    largest = np.abs(exact).max(axis=1)
    # Curvature is negative where the beam is pushed up: shown upright, as the deflection is.
    scale = np.array([1.0, -1.0]) / largest
    error = np.abs(sums - exact[:, None]).max(axis=2) / largest[:, None]
    shape = beam.shape(x)[:DRAWN]
    return xarray.Dataset(
        {
            "exact": (("quantity", "x"), exact * scale[:, None]),
            "sum": (("quantity", "modes", "x"), sums * scale[:, None, None]),
            "relative_error": (("quantity", "modes"), error),
            "shape": (("mode", "x"), shape / np.abs(shape).max(axis=1, keepdims=True)),
            "angular_frequency": ("mode", beam.angular_frequency[:DRAWN]),
        },
        coords={
            "quantity": list(QUANTITIES),
            "modes": range(1, MODES + 1),
            "mode": range(1, DRAWN + 1),
            "x": x,
        },
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the report's three sketches, sums of one to three modes, and the error of longer sums."""
    grid = figure.add_gridspec(6, 3, width_ratios=[0.75, 1, 1.15])
    for row in range(DRAWN):
        _mode(table, row + 1, figure.add_subplot(grid[2 * row : 2 * row + 2, 0]))
    for row, quantity in enumerate(QUANTITIES):
        _sums(table.sel(quantity=quantity), figure.add_subplot(grid[3 * row : 3 * row + 3, 1]))
    _errors(table, figure.add_subplot(grid[:, 2]))


def _mode(table: xarray.Dataset, mode: int, ax: Axes) -> None:
    ax.axhline(0.0, color=GREY, linewidth=0.8)
    ax.plot(table.x, table["shape"].sel(mode=mode), color=COLOURS[mode - 1], linewidth=2.2)
    ax.plot([0, 1], [0, 0], "o", color="black", markerfacecolor="white", markersize=6, zorder=4)
    wave = "" if mode == 1 else str(mode)
    ax.set_title(f"A{mode}   sin({wave}πx/L)")
    ax.set(ylim=(-1.15, 1.15), xlim=(-0.04, 1.04))
    ax.axis("off")


def _sums(table: xarray.Dataset, ax: Axes) -> None:
    ax.plot(table.x, table.exact, color="#C4C4C4", linewidth=6, solid_capstyle="round")
    for modes in range(1, DRAWN + 1):
        ax.plot(table.x, table["sum"].sel(modes=modes), color=COLOURS[modes - 1], linewidth=1.5)
    quantity = str(table.quantity.values)
    ax.set_title(f"{quantity}, held aside at {AT:g} L")
    ax.set(xlim=(0, 1), ylim=(0, 1.12))
    ax.set_ylabel(f"{quantity} / largest")
    if quantity == "moment":
        ax.set_xlabel("x / L")
        _, *lines = ax.get_lines()
        for line, text, point, offset in zip(
            lines, ("1 mode", "2 modes", "3"), (132, 78, 52), PLACES, strict=True
        ):
            label_line(ax, line, text, point=point, offset=offset, ha="left" if offset[0] > 0 else "right")
    else:
        ax.set_xticklabels([])


def _errors(table: xarray.Dataset, ax: Axes) -> None:
    ax.set(xscale="log", yscale="log", xlim=(0.9, 60), ylim=(1e-4, 60))
    plain_ticks(ax, [1, 2, 5, 10, 20, 50], [10.0**k for k in range(-4, 2)], unit=" %")
    lines = []
    for quantity, colour in (("moment", "black"), ("deflection", COLOURS[3])):
        error = 100 * table.relative_error.sel(quantity=quantity)
        lines += ax.plot(table.modes, error, color=colour, marker="o", markersize=3)
    ax.set_xlabel("number of modes n")
    ax.set_title("largest error of the sum")
    moment, deflection = lines
    label_along(
        ax,
        [(moment, "moment, as 1/n", 14, "above"), (deflection, "deflection, as 1/n³", 14, "above")],
        size=11,
    )


STUDY = Study(
    name="appendix",
    title="Appendix · a pinned beam as a sum of its modes, and how many are enough",
    caption="The report's appendix: modes A1 to A3 of a pinned-pinned beam, and how many of them are enough.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(("quantity", "modes", "relative_error")),
        "_shapes.csv": Sheet(("mode", "x", "shape"), {"shape": Kind(decimals=12)}),
    },
    size=(9.0, 5.4),
)
