"""A figure as a film: its frames in time, as a file, and as a picture that moves in a notebook."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from beammodes.checks import choice, positive_real, shown
from beammodes.numerics.arrays import Floats

__all__ = ["KINDS", "Film", "film_bytes", "film_of", "need_ffmpeg"]

#: Films are written in these kinds, by the ending of the file's name.
KINDS = (".gif", ".mp4")
#: Longer films than this are mistakes: a GIF holds all of its frames in memory.
_MAX_FRAMES = 5000
#: In a notebook a film has at most so many frames, and so many bytes: it stays in the notebook's file.
_MOST_SHOWN, _MOST_BYTES = 250, 8 * 2**20


class Film(FuncAnimation):
    """A Matplotlib animation that plays in a notebook that is handed it, as a GIF in the page.

    A longer one than 250 frames is shown with fewer of them in the same time, one of more than 8 MB not at
    all: write it to a file.
    """

    def __init__(self, figure: Figure, update: Callable[[float], None], moments: list[float], rate: float):
        self._drawn, self._update, self._moments, self._rate = figure, update, moments, rate

        def draw(moment: float) -> list[Any]:
            update(moment)
            return []

        super().__init__(figure, draw, frames=moments, interval=1000 / rate, cache_frame_data=False)

    def _repr_html_(self) -> str:
        step = -(-len(self._moments) // _MOST_SHOWN)
        figure = self._drawn
        with tempfile.TemporaryDirectory() as folder:
            name = Path(folder) / "film.gif"
            writer = _writer(".gif", self._rate / step)
            with writer.saving(figure, str(name), dpi=figure.dpi):
                for moment in self._moments[::step]:
                    self._update(moment)
                    writer.grab_frame()
            content = name.read_bytes()
        if len(content) > _MOST_BYTES:
            size = f"{len(content) / 2**20:.0f} MB"
            return f"<p>A film of {size}: write it to a file, animate(..., path=...)</p>"
        data = base64.b64encode(content).decode()
        return f'<img alt="the motion as a film" src="data:image/gif;base64,{data}" style="max-width: 100%">'

    def __del__(self) -> None:
        """Say nothing: Matplotlib would warn of a film that was let go unseen, or was seen here."""


def film_of(
    figure: Figure,
    update: Callable[[float], None],
    time: Floats,
    *,
    fps: float = 25,
    duration: float | None = None,
) -> Film:
    """Return a figure as a film, evenly from the first to the last of the times [s].

    `update` moves the figure to a time; `plot_motion` returns one for each picture. `fps` and `duration` are
    those of `animate`.
    """
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
    if not 1000 / rate < 2**31:
        raise ValueError(f"fps must be larger: one frame would stand {1000 / rate:.3g} ms, got {shown(fps)}")
    return Film(figure, update, np.linspace(time[0], time[-1], frames).tolist(), rate)


def film_bytes(film: FuncAnimation, kind: str, *, fps: float = 25) -> bytes:
    """Return a film as the content of a file, ".gif" or ".mp4"; the same picture gives the same bytes."""
    choice("kind", kind, KINDS)
    # Writers of films want a name, not a file.
    with tempfile.TemporaryDirectory() as folder:
        name = Path(folder) / f"film{kind}"
        film.save(name, writer=_writer(kind, positive_real("fps", fps)))
        return name.read_bytes()


def _writer(kind: str, fps: float) -> AbstractMovieWriter:
    # Both take a whole number by their types, and any number by what they do.
    rate: Any = fps
    if kind == ".gif":
        return PillowWriter(fps=rate)
    need_ffmpeg(f"film{kind}")
    exact = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"]
    return FFMpegWriter(fps=rate, extra_args=[*exact, "-pix_fmt", "yuv420p"])


def need_ffmpeg(path: object) -> None:
    """Raise RuntimeError where the program that writes .mp4 is missing."""
    if not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"path must end in .gif where the program ffmpeg is missing, got {shown(str(path))}"
        )
