"""Magnitude and phase of frequency responses against frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.checks import choice, shown
from beammodes.deferred import Deferred
from beammodes.views.symbols import COLOURS

if TYPE_CHECKING:
    import matplotlib.axes
    import xarray
    from matplotlib.axes import Axes
else:
    matplotlib, xarray = Deferred("matplotlib"), Deferred("xarray")

__all__ = ["plot_response"]

_PARTS = ("magnitude", "phase")


def plot_response(
    response: xarray.Dataset,
    ax: matplotlib.axes.Axes | Sequence[matplotlib.axes.Axes] | None = None,
    *,
    quantity: str | None = None,
    label: str | None = None,
    **style: Any,
) -> tuple[matplotlib.axes.Axes, ...]:
    """Draw the magnitude of a frequency response on a logarithmic scale, and its phase below.

    Call it again with the axes that it returned to lay another response, of a chain, over the first.

    Parameters
    ----------
    response : xarray.Dataset
        From `frequency_response`, over frequency.
    ax : matplotlib.axes.Axes, or a pair of them, optional
        One for the magnitude alone, or two for magnitude and phase; by default two of a new figure,
        which a notebook shows where the answer is the last line of a cell.
    quantity : str, optional
        The variable of the dataset; its first by default.
    label : str, optional
        For the legend. Without one, positions that are dimensions of the dataset name its lines.
    **style
        Of `Axes.plot`, such as color and linestyle.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        What was drawn into.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Examples
    --------
    >>> import beammodes as bm
    >>> drive = dict(frequency=[1.0, 2.0, 4.0], force_at=1.0, deflection_at=[0.5, 1.0], damping_ratio=0.01)
    >>> both = bm.plot_response(bm.frequency_response(bm.Beam.unit(), "clamped-free", **drive))
    >>> [axes.get_ylabel() for axes in both], len(both[0].lines)
    (['deflection over force  [m / N]', 'phase  [°]'], 2)
    """
    import xarray

    if not isinstance(response, xarray.Dataset) or "frequency" not in response.dims:
        raise TypeError(
            f"response must be a Dataset over frequency from frequency_response(), got {shown(response)}"
        )
    names = list(map(str, response.data_vars))
    name = names[0] if quantity is None else choice("quantity", quantity, names)
    if label is not None and not isinstance(label, str):
        raise TypeError(f"label must be text or None, got {shown(label)}")
    axes = _axes(ax)
    values = response[name].transpose("frequency", ...)
    others = [str(dim) for dim in values.dims[1:]]
    lines = (
        values.stack(line=others).transpose("frequency", "line")
        if others
        else values.expand_dims(line=1, axis=1)
    )
    for k in range(lines.sizes["line"]):
        one = lines.isel(line=k)
        named = ", ".join(f"{dim.replace('_', ' ')} {float(one[dim]):.4g} m" for dim in others)
        look = {"color": COLOURS[k % len(COLOURS)], "label": label or named or None} | style
        axes[0].plot(response.frequency, np.abs(one), **look)
        for phase in axes[1:]:
            phase.plot(response.frequency, np.degrees(np.unwrap(np.angle(one))), **look)
    attributes = response[name].attrs
    axes[0].set(yscale="log", ylabel=f"{attributes.get('long_name', name)}  [{attributes.get('units', '1')}]")
    for phase in axes[1:]:
        phase.set_ylabel("phase  [°]")
    axes[-1].set_xlabel("frequency  [Hz]")
    return axes


def _axes(ax: Any) -> tuple[Axes, ...]:
    from matplotlib.axes import Axes

    if ax is None:
        from beammodes.views.own_axes import own_panels

        return own_panels((2, 1))
    if isinstance(ax, Axes):
        return (ax,)
    row = ax.ndim == 1 if isinstance(ax, np.ndarray) else isinstance(ax, tuple | list)
    given = tuple(ax) if row else ()
    if not 1 <= len(given) <= len(_PARTS) or not all(isinstance(each, Axes) for each in given):
        raise TypeError(f"ax must be Axes, a pair of them for magnitude and phase, or None, got {shown(ax)}")
    return given
