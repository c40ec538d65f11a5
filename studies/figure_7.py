"""Figure 7 of the report: cantilever/cantilever beam, error in the first three natural frequencies."""

from __future__ import annotations

import xarray
from matplotlib.figure import Figure

from studies import Progress, figure_6
from studies.figure_6 import tables

__all__ = ["data", "draw", "tables"]

BOUNDARY = "clamped-clamped"
TITLE = "Figure 7 · cantilever/cantilever beam, the report's springs"


def data(progress: Progress | None = None) -> xarray.Dataset:
    """Errors for N = 1..20 through the symbolic derivation; N = 1 has no elastic mode."""
    return figure_6.data(progress, BOUNDARY)


def draw(table: xarray.Dataset) -> Figure:
    """The same drawing as Figure 6."""
    return figure_6.draw(table, TITLE)
