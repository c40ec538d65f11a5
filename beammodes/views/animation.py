"""Motions as films: a chain's rods, hinges and the trace of its tip, frame by frame."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.checks import choice, positive_real, real, shown
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.files import file_target, write_atomically
from beammodes.numerics.arrays import Floats
from beammodes.views.symbols import COLOURS, GREY, STYLE

if TYPE_CHECKING:
    import xarray
    from matplotlib.animation import AbstractMovieWriter, FuncAnimation
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["animate", "film_bytes", "film_of", "plot_motion", "seen_from"]


#: Films are written in these kinds, by the ending of the file's name.
_KINDS = (".gif", ".mp4")
#: Longer films than this are mistakes: a GIF holds all of its frames in memory.
_MAX_FRAMES = 5000


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
) -> Path | FuncAnimation:
    """Film a computed motion: rods as lines, hinges as dots, and the trace of the tip.

    Parameters
    ----------
    result : xarray.Dataset
        From `simulate`: x and y over time and node.
    path : str or Path, optional
        A file to write, ending in .gif or, where the program ffmpeg is installed, .mp4. Without it the
        film is returned, as for a notebook: `HTML(animate(result).to_jshtml())`.
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
    Path or matplotlib.animation.FuncAnimation
        What was written, or the film if `path` is None.

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

    target = None if path is None else _target(path)
    data, length = _checked_motion(result), positive_real("width", width)
    dots = positive_real("dpi", dpi)
    style: dict[Any, Any] = {**STYLE, "axes.grid": False}
    with rc_context(style):
        figure = Figure(figsize=(length, length), dpi=dots, layout="constrained")
        ax = figure.subplots()
        update = plot_motion(data, ax, base=base, trace=trace)
        across, up = (np.diff(limits)[0] for limits in (ax.get_xlim(), ax.get_ylim()))
        figure.set_size_inches(length, length * min(2.0, max(0.3, up / across + 0.12)))
        film = film_of(figure, update, data.time.values, fps=fps, duration=duration)
        if target is None:
            return film
        content = film_bytes(film, target.suffix.lower(), fps=fps)
    write_atomically(target, lambda file: file.write(content))
    return target


def _target(path: str | Path) -> Path:
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"path must be a str, a Path or None, got {shown(path)}")
    target = Path(path)
    if target.suffix.lower() not in _KINDS:
        raise ValueError(f"path must end in {' or '.join(_KINDS)}, got {shown(str(path))}")
    file_target(target)
    if target.suffix.lower() == ".mp4":
        _need_ffmpeg(path)
    return target


def film_of(
    figure: Figure,
    update: Callable[[float], None],
    time: Floats,
    *,
    fps: float = 25,
    duration: float | None = None,
) -> FuncAnimation:
    """Return a figure as a film, evenly from the first to the last of the times [s].

    `update` moves the figure to a time; `plot_motion` returns one for each picture. `fps` and `duration` are
    those of `animate`.
    """
    from matplotlib.animation import FuncAnimation
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    rate, span = positive_real("fps", fps), float(time[-1] - time[0])
    frames = max(2, round(rate * (span if duration is None else positive_real("duration", duration))))
    if frames > _MAX_FRAMES:
        raise ValueError(f"duration must be shorter: {frames} frames are more than {_MAX_FRAMES}")

    class Unwatched(FigureCanvasAgg):
        """Draws a frame when it is written, not also when it changes."""

        def draw_idle(self, *args: Any, **kwargs: Any) -> None:
            """Do nothing: nobody looks on."""

    Unwatched(figure)
    # One layout for all frames: a picture must not jump, nor a film take ten times as long.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")

    def draw(moment: float) -> list[Any]:
        update(moment)
        return []

    if not 1000 / rate < 2**31:
        raise ValueError(f"fps must be larger: one frame would stand {1000 / rate:.3g} ms, got {shown(fps)}")
    moments = np.linspace(time[0], time[-1], frames).tolist()
    return FuncAnimation(figure, draw, frames=moments, interval=1000 / rate, cache_frame_data=False)


def film_bytes(film: FuncAnimation, kind: str, *, fps: float = 25) -> bytes:
    """Return a film as the content of a file, ".gif" or ".mp4"; the same picture gives the same bytes."""
    choice("kind", kind, _KINDS)
    # Writers of films want a name, not a file.
    with tempfile.TemporaryDirectory() as folder:
        name = Path(folder) / f"film{kind}"
        film.save(name, writer=_writer(kind, positive_real("fps", fps)))
        return name.read_bytes()


def _writer(kind: str, fps: float) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    # Both take a whole number by their types, and any number by what they do.
    rate: Any = fps
    if kind == ".gif":
        return PillowWriter(fps=rate)
    _need_ffmpeg(f"film{kind}")
    exact = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"]
    return FFMpegWriter(fps=rate, extra_args=[*exact, "-pix_fmt", "yuv420p"])


def _need_ffmpeg(path: object) -> None:
    """Raise RuntimeError where the program that writes .mp4 is missing."""
    from matplotlib.animation import FFMpegWriter

    if not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"path must end in .gif where the program ffmpeg is missing, got {shown(str(path))}"
        )


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
