"""Figure 5 of the report: a beam between two rigid bodies, clamped to both."""

from __future__ import annotations

import xarray
from matplotlib.figure import Figure

import beammodes as bm
from studies import Progress, figure_3
from studies.figure_3 import BODY, tables

__all__ = ["data", "draw", "tables"]

BOUNDARY = bm.Boundary(BODY, BODY)
WALL = "clamped-clamped"
TITLE = "Figure 5 · beam clamped to two rigid bodies that are free to move"
BODIES = "each body is a square\nblock of side 0.2 L, as heavy as the beam"
PLACES: tuple[figure_3.Places, ...] = (
    ((13.5, "above"), (14.5, "below"), (13, "below")),
    ((13.5, "above"), (13, "below"), (13, "below")),
    ((4.6, "below"), (9.5, "above"), (13, "below")),
)


def data(progress: Progress | None = None) -> xarray.Dataset:
    """Errors for N = 1..20 between free bodies and between walls; mode shapes for N = 4 between bodies."""
    return figure_3.data(progress, BOUNDARY, WALL)


def draw(table: xarray.Dataset) -> Figure:
    """The chain, its first modes over the beam's, and their errors against N."""
    return figure_3.draw(table, BOUNDARY, TITLE, BODIES, PLACES)
