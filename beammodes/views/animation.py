"""Motions as films: a chain's rods, hinges and the trace of its tip, frame by frame."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.checks import positive_real, shown
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.files import file_target, write_atomically
from beammodes.views.plots import STYLE

if TYPE_CHECKING:
    import xarray
    from matplotlib.animation import FuncAnimation
from beammodes.views.film import KINDS, film_bytes, film_of, need_ffmpeg
from beammodes.views.motion_picture import checked_motion, plot_motion

__all__ = ["animate"]


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
    """Film a computed motion: rods as lines, hinges as dots, and what the tip has left behind it.

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
        How far back, in time of the motion, the tip's path is drawn; a tenth of the motion by default.
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
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.dynamics.initial_state import mode_start
    >>> from beammodes.dynamics.simulation import simulate
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> motion = simulate(chain, duration=1.0, initial=mode_start(chain, 1, 0.5))
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> animate(motion, folder / "beam.gif", fps=5).stat().st_size > 1000
    True
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    target = None if path is None else _target(path)
    data, length = checked_motion(result), positive_real("width", width)
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
    if target.suffix.lower() not in KINDS:
        raise ValueError(f"path must end in {' or '.join(KINDS)}, got {shown(str(path))}")
    file_target(target)
    if target.suffix.lower() == ".mp4":
        need_ffmpeg(path)
    return target
