"""Axes of new figures, for plots that were given none: off pyplot's list, and shown by a notebook."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.transforms import Bbox, BboxBase
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]

__all__ = ["Panels", "drawn_box", "own_axes", "own_panels"]

#: Dots per inch in which it is seen what is drawn where, and the empty edge around that [in].
_FINE, _EDGE = 72, 0.08


def drawn_box(figure: Any) -> BboxBase:
    """Return the part of a figure that has something in it [in].

    Examples
    --------
    >>> ax = Figure(figsize=(4, 4)).add_axes((0, 0, 1, 1), xlim=(0, 1), ylim=(0, 1))
    >>> _ = ax.axis("off"), ax.plot([0.25, 0.5], [0.25, 0.5], linewidth=1, solid_capstyle="butt")
    >>> drawn_box(ax.figure).extents.round(1).tolist()
    [1.0, 1.0, 2.0, 2.0]
    """
    file = io.BytesIO()
    figure.savefig(file, format="png", bbox_inches="tight", pad_inches=0, dpi=_FINE)
    file.seek(0)
    picture, whole = imread(file), figure.get_tightbbox()
    rows, columns = np.nonzero((picture != picture[0, 0]).any(axis=2))
    if not len(rows):
        return Bbox(whole.extents.reshape(2, 2))
    left, top = whole.x0, whole.y0 + len(picture) / _FINE
    return Bbox.from_extents(
        left + columns.min() / _FINE,
        top - (rows.max() + 1) / _FINE,
        left + (columns.max() + 1) / _FINE,
        top - rows.min() / _FINE,
    )


def _png(figure: Any) -> bytes:
    """Return a figure as a picture, without what is empty around it."""
    file = io.BytesIO()
    figure.savefig(file, format="png", bbox_inches=drawn_box(figure).padded(_EDGE))
    return file.getvalue()


class _Shown:
    """A notebook that is handed such axes shows their figure, once the cell has ended."""

    def _repr_png_(self: Any) -> bytes:
        return _png(self.figure)


class _OwnAxes(_Shown, Axes):
    """In the plane."""


# mpl_toolkits ships no types, so that its base is Any.
class _OwnAxes3D(_Shown, Axes3D):  # type: ignore[misc]
    """In space."""


class Panels(tuple[Axes, ...]):
    """Axes of one figure; a notebook shows it."""

    __slots__ = ()

    def _repr_png_(self) -> bytes:
        return _png(self[0].figure)


def own_axes(*, in_space: bool = False) -> Axes:
    """Return the axes of a new figure, which belongs to nobody else.

    Examples
    --------
    >>> ax = own_axes()
    >>> ax.name, own_axes(in_space=True).name, ax._repr_png_()[1:4]
    ('rectilinear', '3d', b'PNG')
    """
    kind: Any = _OwnAxes3D if in_space else _OwnAxes
    axes: Axes = Figure(layout="constrained").add_subplot(axes_class=kind)
    return axes


def own_panels(heights: Iterable[float]) -> Panels:
    """Return axes over one another, of these relative heights, over one horizontal axis.

    Examples
    --------
    >>> len(own_panels([2, 1]))
    2
    """
    ratios = list(heights)
    figure = Figure(layout="constrained")
    grid = figure.add_gridspec(len(ratios), height_ratios=ratios)
    axes: list[Any] = []
    for row in range(len(ratios)):
        axes.append(figure.add_subplot(grid[row], axes_class=_OwnAxes, sharex=axes[0] if axes else None))
    for upper in axes[:-1]:
        upper.tick_params(labelbottom=False)
    return Panels(axes)
