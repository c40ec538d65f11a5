"""A chain's motion as a picture that can be moved in time: rods, hinges and the trace of the tip."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import positive_real, real, shown
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.views.plots import COLOURS, GREY

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["checked_motion", "plot_motion", "seen_from"]

Array = NDArray[np.float64]


def plot_motion(
    result: xarray.Dataset,
    ax: Axes,
    *,
    base: BaseMotion | None = None,
    trace: float | None = None,
    stretch: float = 1.0,
    clock: bool = True,
) -> Callable[[float], None]:
    """Draw the first moment of a motion and return the function that moves the picture to a time [s].

    Parameters
    ----------
    result : xarray.Dataset
        From `simulate`.
    ax : matplotlib.axes.Axes
        Its two scales are made equal (but for `stretch`), and wide enough for the whole motion.
    base, trace
        As for `animate`.
    stretch : float
        How many times larger y is drawn than x, for a beam that bends little.
    clock : bool
        Whether the time is written in the corner.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgb

    data = checked_motion(result)
    time, x, y = seen_from(base, data)
    span = float(time[-1] - time[0])
    back = span / 10 if trace is None else real("trace", trace)
    if back < 0.0:
        raise ValueError(f"trace must not be negative, got {shown(trace)}")
    _frame(ax, x, y, positive_real("stretch", stretch))
    tail = LineCollection([], linewidth=1.5, capstyle="round", zorder=2)
    ax.add_collection(tail)
    (rods,) = ax.plot([], [], color=COLOURS[0], linewidth=2.2, solid_capstyle="round", zorder=3)
    (dots,) = ax.plot([], [], "o", color=COLOURS[0], markersize=3.5, zorder=4)
    (hub,) = ax.plot([], [], "o", color=GREY, markersize=8, zorder=5)
    label = ax.text(0.02, 0.97, "", transform=ax.transAxes, va="top", visible=clock)
    decimals = max(0, 2 - int(np.floor(np.log10(span)))) if span > 0.0 else 2

    def update(moment: float) -> None:
        k = int(np.abs(time - moment).argmin())
        rods.set_data(x[k], y[k])
        dots.set_data(x[k, 1:-1], y[k, 1:-1])
        hub.set_data(x[k, :1], y[k, :1])
        first = int(np.searchsorted(time, time[k] - back))
        path = np.column_stack([x[first : k + 1, -1], y[first : k + 1, -1]])
        tail.set_segments(list(np.stack([path[:-1], path[1:]], axis=1)))
        # Oldest first: what the tip left long ago has nearly faded.
        fade = np.linspace(0.0, 0.9, len(path))[1:]
        tail.set_color([(*to_rgb(COLOURS[1]), float(alpha)) for alpha in fade])
        label.set_text(f"t = {time[k]:.{decimals}f} s")

    update(float(time[0]))
    return update


def seen_from(base: BaseMotion | None, data: xarray.Dataset) -> tuple[Array, Array, Array]:
    """Return times, and x and y of the nodes, as one sees them who shifts and turns with a base.

    Parameters
    ----------
    base : BaseMotion or None
        None for one who stands still.
    data : xarray.Dataset
        From `simulate`.

    Returns
    -------
    ndarray, shapes (times,), (times, nodes), (times, nodes) [s, m, m]

    Raises
    ------
    TypeError
        If `base` is neither.
    """
    time = np.asarray(data.time.values, dtype=np.float64)
    x, y = (np.asarray(data[name].transpose("time", "node").values) for name in ("x", "y"))
    if base is None:
        return time, x, y
    if not isinstance(base, BaseMotion):
        raise TypeError(f"base must be a BaseMotion or None, got {shown(base)}")
    (x0, _, _), (y0, _, _), (angle, _, _) = (part[..., None] for part in base.at(time))
    cosine, sine, along, across = np.cos(angle), np.sin(angle), x - x0, y - y0
    return time, along * cosine + across * sine, across * cosine - along * sine


def checked_motion(result: xarray.Dataset) -> xarray.Dataset:
    """Return `result`, or raise TypeError or ValueError if it is no motion of two times or more."""
    import xarray

    if not isinstance(result, xarray.Dataset):
        raise TypeError(f"result must be a Dataset from simulate(), got {shown(result)}")
    missing = [name for name in ("x", "y", "time") if name not in result.variables]
    if missing or set(result.x.dims) != {"time", "node"} or set(result.y.dims) != {"time", "node"}:
        raise ValueError(
            f"result must hold x and y over time and node, as simulate() makes it, "
            f"got {list(result.variables)}"
        )
    if result.sizes["time"] < 2:
        raise ValueError(f"result must hold two times or more, got {result.sizes['time']}")
    return result


def _frame(ax: Axes, x: Array, y: Array, stretch: float) -> None:
    """Fix both scales so that every moment fits in."""
    left, right, low, high = float(x.min()), float(x.max()), float(y.min()), float(y.max())
    edge = 0.06 * max(right - left, stretch * (high - low))
    ax.set_aspect(stretch)
    ax.set(xlim=(left - edge, right + edge), ylim=(low - edge / stretch, high + 2 * edge / stretch))
    ax.set_xlabel("x  [m]")
    ax.set_ylabel("y  [m]")
