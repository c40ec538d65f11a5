"""Chains between rigid bodies as pictures: their mode shapes as data, and the parts to draw them with."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike

import beammodes as bm
from beammodes.views.plots import COLOURS, GREY

__all__ = [
    "CHAIN",
    "SPRING",
    "bold_title",
    "draw_box",
    "draw_chain",
    "draw_coil",
    "draw_spiral",
    "mode_shapes",
    "picture",
]

CHAIN, SPRING, BODY = COLOURS[0], COLOURS[1], "#C9D8E6"


def mode_shapes(chain: bm.Chain, modes: int) -> xarray.Dataset:
    """Return a chain's modes beside its exact beam's, both over the beam's largest deflection.

    Dimensions mode, node (left tip, hinges, right tip), piece (the outer two carry the ends' bodies), x.
    """
    assert chain.beam is not None
    found = bm.solve_modes(bm.linearize(chain), modes)
    exact = bm.euler_bernoulli(chain.beam, chain.boundary, modes)
    x = np.linspace(0.0, chain.beam.length, 201)
    curve, at_nodes = exact.shape(x), exact.shape(found.position)
    scale = 1 / np.abs(curve).max(axis=1, keepdims=True)
    # Either sign is a mode: take the beam's.
    sign = np.sign((found.deflection * at_nodes).sum(axis=1, keepdims=True))
    return xarray.Dataset(
        {
            "frequency": ("mode", found.frequency),
            "exact_frequency": ("mode", exact.frequency),
            "deflection": (("mode", "node"), found.deflection * sign * scale),
            "exact_deflection": (("mode", "node"), at_nodes * scale),
            "rotation": (("mode", "piece"), found.rotation * sign * scale),
            "curve": (("mode", "x"), curve * scale),
        },
        coords={
            "mode": range(1, modes + 1),
            "position": ("node", found.position),
            "x": x,
        },
    )


def picture(ax: Axes, width: tuple[float, float], height: tuple[float, float]) -> None:
    """Make axes a picture: true proportions, no frame, no ticks."""
    ax.set(xlim=width, ylim=height, aspect="equal")
    ax.axis("off")


def draw_chain(ax: Axes, x: ArrayLike, y: ArrayLike, hinges: slice, *, width: float = 2.6) -> None:
    """Draw rods as straight lines and, at the nodes of a slice, hinges as circles."""
    across, up = np.asarray(x), np.asarray(y)
    ax.plot(across, up, color=CHAIN, linewidth=width, solid_capstyle="round", zorder=3)
    ax.plot(across[hinges], up[hinges], "o", color=CHAIN, markerfacecolor="white", markersize=5.5, zorder=5)


def draw_box(
    ax: Axes,
    end: tuple[float, float],
    angle: float,
    box: tuple[float, float, float, float],
    *,
    colour: str = BODY,
    edge: str = "#44515C",
    zorder: float = 2,
) -> None:
    """Draw a rectangle (left, bottom, width, height; from the beam's end) that turns about that end."""
    turned = Affine2D().rotate(angle).translate(*end) + ax.transData
    left, bottom, width, height = box
    ax.add_patch(
        Rectangle(
            (left, bottom), width, height, transform=turned, facecolor=colour, edgecolor=edge, zorder=zorder
        )
    )


def draw_spiral(ax: Axes, x: float, y: float, radius: float) -> None:
    """Draw a rotational spring about a hinge."""
    turn = np.linspace(0.0, 5 * np.pi, 200)
    away = radius * (0.35 + 0.65 * turn / turn[-1])
    ax.plot(x + away * np.cos(turn), y + away * np.sin(turn), color=SPRING, linewidth=1.1, zorder=4)


def draw_coil(ax: Axes, x: float, bottom: float, top: float, *, width: float = 0.12) -> None:
    """Draw a spring that pushes upwards, and a wheel on the ground about its lower end."""
    turns = np.concatenate([[0.0, 0.0], np.resize([-width, width], 8), [0.0, 0.0]])
    ax.plot(x + turns, np.linspace(bottom, top, len(turns)), color=SPRING, linewidth=1.5, zorder=2.5)
    ax.add_patch(Circle((x, bottom), bottom, facecolor="#EEEEEE", edgecolor=GREY, linewidth=3, zorder=1))


def bold_title(figure: Figure, text: str) -> None:
    """Write a figure's title as all studies do."""
    figure.suptitle(text, fontsize=13, fontweight="bold", x=0.01, ha="left")
