"""Films: a figure and what moves it in time, as the frames and the bytes of a file."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import positive_real, shown

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter, FuncAnimation
    from matplotlib.figure import Figure

__all__ = ["KINDS", "film_bytes", "film_of", "need_ffmpeg"]

Array = NDArray[np.float64]

#: Films are written in these kinds, by the ending of the file's name.
KINDS = (".gif", ".mp4")

#: Longer films than this are mistakes: a GIF holds all of its frames in memory.
MAX_FRAMES = 5000


def film_of(
    figure: Figure,
    update: Callable[[float], None],
    time: Array,
    *,
    fps: float = 25,
    duration: float | None = None,
) -> FuncAnimation:
    """Return a figure as a film, evenly from the first to the last of the times.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        One made by hand, for several pictures beside each other.
    update : function of a time [s]
        Moves the figure there; `plot_motion` returns one for each picture.
    time : ndarray [s]
    fps, duration
        As for `animate`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the film would exceed 5000 frames.
    """
    from matplotlib.animation import FuncAnimation
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    rate, span = positive_real("fps", fps), float(time[-1] - time[0])
    frames = max(2, round(rate * (span if duration is None else positive_real("duration", duration))))
    if frames > MAX_FRAMES:
        raise ValueError(f"duration must be shorter: {frames} frames are more than {MAX_FRAMES}")

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
    """Return a film as the content of a file, the same bytes whenever the picture is the same.

    Parameters
    ----------
    film : matplotlib.animation.FuncAnimation
    kind : str
        ".gif" or ".mp4".
    fps : float [1/s]

    Raises
    ------
    ValueError
        If `kind` is another.
    RuntimeError
        If it is ".mp4" and there is no ffmpeg.
    """
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {shown(kind)}")
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
    need_ffmpeg(f"film{kind}")
    exact = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"]
    return FFMpegWriter(fps=rate, extra_args=[*exact, "-pix_fmt", "yuv420p"])


def need_ffmpeg(path: object) -> None:
    """Raise RuntimeError where the program that writes .mp4 is missing."""
    from matplotlib.animation import FFMpegWriter

    if not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"path must end in .gif where the program ffmpeg is missing, got {shown(str(path))}"
        )
