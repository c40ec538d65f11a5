"""What studies that draw chains share: mode shapes beside the beam's as data, empty pictures, titles."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import beammodes as bm

__all__ = ["bold_title", "mode_shapes", "picture"]


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


def bold_title(figure: Figure, text: str) -> None:
    """Write a figure's title as all studies do."""
    figure.suptitle(text, fontsize=13, fontweight="bold", x=0.01, ha="left")
