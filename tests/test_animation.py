"""Films: readable files with the right frames, the same bytes again, and errors that name what is wrong."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.animation import FFMpegWriter, FuncAnimation
from matplotlib.figure import Figure
from PIL import Image

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion, spin_up
from beammodes.dynamics.simulation import mode_start, simulate
from beammodes.problem.beam import Beam
from beammodes.views.animation import animate, plot_motion, seen_from

BASE = BaseMotion(angle=spin_up(2.0, 1.0), hub_radius=0.3)


@pytest.fixture(scope="module")
def motion() -> xarray.Dataset:
    chain = Chain(Beam.unit(), "clamped-free", segments=3)
    return simulate(chain, duration=2.0, output_step=0.02, initial=mode_start(chain, 1, 0.5))


@pytest.fixture(scope="module")
def turning() -> xarray.Dataset:
    chain = Chain(Beam.unit(), "clamped-free", segments=3)
    return simulate(chain, duration=2.0, output_step=0.02, base=BASE)


def test_a_film_has_its_frames_and_is_the_same_again(motion: xarray.Dataset, tmp_path: Path) -> None:
    path = animate(motion, tmp_path / "film.gif", fps=10, duration=1.2, width=2.0)
    assert path == tmp_path / "film.gif"
    with Image.open(tmp_path / "film.gif") as image:
        assert (image.n_frames, image.size[0], image.info["duration"]) == (12, 200, 100)
        first = np.asarray(image.convert("RGB"))
        image.seek(5)
        assert (np.asarray(image.convert("RGB")) != first).any()
    animate(motion, str(tmp_path / "again.GIF"), fps=10, duration=1.2, width=2.0)
    assert (tmp_path / "again.GIF").read_bytes() == (tmp_path / "film.gif").read_bytes()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["again.GIF", "film.gif"]


def test_by_default_a_film_lasts_as_long_as_the_motion(motion: xarray.Dataset) -> None:
    film = animate(motion, fps=3)
    assert isinstance(film, FuncAnimation)
    assert film.to_jshtml(fps=3).count("frames[") >= 6


def test_the_picture_moves_with_the_time(motion: xarray.Dataset) -> None:
    ax = Figure().subplots()
    update = plot_motion(motion, ax)
    rods = ax.get_lines()[0]
    for k in (0, 40, len(motion.time) - 1):
        update(float(motion.time[k]) + 0.001)  # the nearest moment there is
        np.testing.assert_array_equal(rods.get_xdata(), motion.x[k])
        np.testing.assert_array_equal(rods.get_ydata(), motion.y[k])
    low, high = ax.get_ylim()
    assert low < float(motion.y.min()) and float(motion.y.max()) < high


def test_seen_from_the_base_the_wall_stands_still(turning: xarray.Dataset) -> None:
    _, x, y = seen_from(BASE, turning)
    assert np.abs(x[:, 0]).max() < 1e-14 and np.abs(y[:, 0]).max() < 1e-14
    np.testing.assert_allclose(y[:, -1], turning.tip_deflection, atol=1e-12)
    still = seen_from(None, turning)
    np.testing.assert_array_equal(still[1], turning.x)


needs_ffmpeg = pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="needs ffmpeg")


@needs_ffmpeg
@pytest.mark.parametrize("fps", [pytest.param(5, marks=pytest.mark.slow), 2.5])
def test_mp4(motion: xarray.Dataset, tmp_path: Path, fps: float) -> None:
    # 237 dots wide, where H.264 in its common form takes even numbers only.
    path = animate(motion, tmp_path / "film.mp4", fps=fps, width=2.37)
    assert path == tmp_path / "film.mp4"
    frames = decoded(path)
    assert len(frames) == round(2.0 * fps)
    height, width, _ = frames[0].shape
    assert (height % 2, width) == (0, 236)
    # The last frame shows the last moment, as the picture drawn by itself does.
    picture = animate(motion, tmp_path / "film.gif", fps=fps, width=2.37)
    with Image.open(picture) as image:
        image.seek(image.n_frames - 1)
        last = np.asarray(image.convert("RGB"), dtype=float)
    # The GIF may have a row or a column more.
    away = [np.abs(frame - last[:height, :width]).mean() for frame in frames]
    assert int(np.argmin(away)) == len(frames) - 1
    again = animate(motion, str(tmp_path / "again.MP4"), fps=fps, width=2.37)
    assert again.read_bytes() == path.read_bytes()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["again.MP4", "film.gif", "film.mp4"]


def decoded(path: Path) -> list[np.ndarray]:
    """Return the frames of a film as ffmpeg reads them."""
    read = subprocess.run(
        ["ffmpeg", "-v", "error", "-i", str(path), "-f", "image2pipe", "-vcodec", "ppm", "-"],
        capture_output=True,
        check=True,
        timeout=600,
    ).stdout
    frames = []
    while read:
        # P6, width and height, 255, and the dots.
        kind, size, most, rest = read.split(b"\n", 3)
        width, height = map(int, size.split())
        assert (kind, most) == (b"P6", b"255")
        frames.append(
            np.frombuffer(rest[: 3 * width * height], np.uint8).reshape(height, width, 3).astype(float)
        )
        read = rest[3 * width * height :]
    return frames


def test_mp4_is_refused_where_ffmpeg_is_missing(
    motion: xarray.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with pytest.raises(RuntimeError, match=r"^path must end in \.gif where the program ffmpeg is missing"):
        animate(motion, tmp_path / "film.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"path": "film.avi"}, ValueError, r"^path must end in \.gif or \.mp4, got 'film\.avi'"),
        ({"path": "film"}, ValueError, "^path must end in"),
        ({"path": 3}, TypeError, "^path must be a str"),
        ({"path": "no/such/folder/film.gif"}, FileNotFoundError, "^path must be in a folder that exists"),
        ({"fps": 0}, ValueError, "^fps must be greater than 0, got 0"),
        ({"fps": "25"}, TypeError, "^fps must be a real number"),
        ({"duration": -1.0}, ValueError, "^duration must be greater than 0"),
        ({"duration": 1e6}, ValueError, "^duration must be shorter"),
        ({"base": "base"}, TypeError, "^base must be a BaseMotion or None"),
        ({"trace": -1.0}, ValueError, "^trace must not be negative"),
        ({"width": 0.0}, ValueError, "^width must be greater than 0"),
        ({"dpi": np.inf}, ValueError, "^dpi must be finite"),
    ],
)
def test_refusals(
    motion: xarray.Dataset, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        animate(motion, **arguments)


def test_a_folder_is_no_file_and_other_data_no_motion(motion: xarray.Dataset, tmp_path: Path) -> None:
    (tmp_path / "film.gif").mkdir()
    with pytest.raises(ValueError, match=r"^path must be an ordinary file, got the folder"):
        animate(motion, tmp_path / "film.gif")
    for result, error in ((None, TypeError), (motion.drop_vars("x"), ValueError)):
        with pytest.raises(error, match=r"^result must "):
            animate(result)
    with pytest.raises(ValueError, match=r"^result must hold two times or more, got 1"):
        animate(motion.isel(time=[0]))
