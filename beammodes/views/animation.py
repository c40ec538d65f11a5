"""Motions as films: a chain's rods, hinges and the trace of its tip, frame by frame."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.checks import positive_real, real, shown
from beammodes.deferred import Deferred
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.files import file_target, write_atomically
from beammodes.numerics.arrays import Floats
from beammodes.views.symbols import COLOURS, GREY, STYLE

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from beammodes.views import film as films
else:
    xarray, films = Deferred("xarray"), Deferred("beammodes.views.film")

__all__ = ["animate", "plot_motion", "seen_from"]


def animate(
    result: xarray.Dataset,
    path: str | Path | None = None,
    *,
    fps: float = 25,
    duration: float | None = None,
    base: BaseMotion | None = None,
    trace: float | None = None,
    width: float = 4.8,
    dpi: float = 100,
) -> Path | films.Film:
    """Film a computed motion: rods as lines, hinges as dots, and the trace of the tip.

    Parameters
    ----------
    result : xarray.Dataset
        From `simulate`: x and y over time and node.
    path : str or Path, optional
        A file to write, ending in .gif or, where the program ffmpeg is installed, .mp4. Without it the
        film is returned, and a notebook plays it where it is the last line of a cell.
    fps : float [1/s]
        Frames a second. A GIF keeps times in hundredths of a second: 25, 20, 12.5 and 10 are what they say.
    duration : float [s], optional
        Of the film; by default that of the motion, so that it runs as it would.
    base : BaseMotion, optional
        The one that carries the chain. The picture then shifts and turns with it; by default it stands still.
    trace : float [s], optional
        Time of the motion over which the tip's path is drawn back; a tenth of the motion by default.
    width, dpi : float [in, dots/in]
        Of the picture; its height follows from the motion.

    Returns
    -------
    Path or Film
        What was written, or the film if `path` is None: a matplotlib.animation.FuncAnimation that plays in a
        notebook, with at most 250 frames in its time.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, `path` ends otherwise or is no ordinary file, or the film would
        exceed 5000 frames.
    FileNotFoundError, PermissionError
        If the folder of `path` does not exist, or may not be written to.
    RuntimeError
        If `path` ends in .mp4 and there is no ffmpeg.

    Examples
    --------
    >>> import tempfile
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=4)
    >>> motion = bm.simulate(chain, duration=1.0, initial=bm.mode_start(chain, 1, 0.5))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     bm.animate(motion, f"{folder}/beam.gif", fps=5).stat().st_size > 1000
    True
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from beammodes.views.film import film_bytes, film_of

    target = None if path is None else _target(path)
    data, length = _checked_motion(result), positive_real("width", width)
    dots = positive_real("dpi", dpi)
    style: dict[Any, Any] = {**STYLE, "axes.grid": False}
    with rc_context(style):
        figure = Figure(figsize=(length, length), dpi=dots, layout="constrained")
        ax = figure.subplots()
        update = plot_motion(data, ax, base=base, trace=trace)
        # Ticks that come later, when a notebook plays the film, are of this size too.
        ax.tick_params(labelsize=STYLE["font.size"])
        across, up = (np.diff(limits)[0] for limits in (ax.get_xlim(), ax.get_ylim()))
        figure.set_size_inches(length, length * min(2.0, max(0.3, up / across + 0.12)))
        film = film_of(figure, update, data.time.values, fps=fps, duration=duration)
        if target is None:
            return film
        content = film_bytes(film, target.suffix.lower(), fps=fps)
    write_atomically(target, lambda file: file.write(content))
    return target


def _target(path: str | Path) -> Path:
    from beammodes.views.film import KINDS, need_ffmpeg

    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"path must be a str, a Path or None, got {shown(path)}")
    target = Path(path)
    if target.suffix.lower() not in KINDS:
        raise ValueError(f"path must end in {' or '.join(KINDS)}, got {shown(str(path))}")
    file_target(target)
    if target.suffix.lower() == ".mp4":
        need_ffmpeg(path)
    return target


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

    The axes become wide enough for the whole motion; y is drawn `stretch` times larger than x, for a beam
    that bends little. `clock` writes the time in the corner. `base` and `trace` are those of `animate`.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgb

    data = _checked_motion(result)
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


def seen_from(base: BaseMotion | None, data: xarray.Dataset) -> tuple[Floats, Floats, Floats]:
    """Return times [s], and x and y of the nodes [m], shape (times, nodes), in the frame of a base.

    The frame stands still where `base` is None.
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


def _checked_motion(result: xarray.Dataset) -> xarray.Dataset:
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


def _frame(ax: Axes, x: Floats, y: Floats, stretch: float) -> None:
    """Fix both scales so that every moment fits in."""
    left, right, low, high = float(x.min()), float(x.max()), float(y.min()), float(y.max())
    edge = 0.06 * max(right - left, stretch * (high - low))
    ax.set_aspect(stretch)
    ax.set(xlim=(left - edge, right + edge), ylim=(low - edge / stretch, high + 2 * edge / stretch))
    ax.set_xlabel("x  [m]")
    ax.set_ylabel("y  [m]")
