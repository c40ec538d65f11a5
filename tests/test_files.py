"""Atomic writing: all of a file or nothing."""

from __future__ import annotations

import errno
import os
import socket
import stat
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest
import xarray

import beammodes as bm
from beammodes import files
from beammodes.files import file_target, write_atomically
from studies.runner import run_all

# What is written matters here, not what moves.
pytestmark = pytest.mark.filterwarnings("ignore::beammodes.NothingMovesWarning")

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="POSIX files")
CHAIN = bm.Chain(bm.Beam.unit(), "clamped-free", 3)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("old", [None, b"", b"old"])
def test_whole_file_replaces_what_was_there(tmp_path: Path, old: bytes | None) -> None:
    path = tmp_path / "table.csv"
    if old is not None:
        path.write_bytes(old)
    write_atomically(path, lambda file: file.write(b"new\n"))
    assert path.read_bytes() == b"new\n"
    assert names(tmp_path) == ["table.csv"]


@pytest.mark.parametrize("kind", [RuntimeError, OSError, KeyboardInterrupt, SystemExit, MemoryError])
@pytest.mark.parametrize("old", [None, b"old"])
def test_interrupted_writing_leaves_the_old_file_alone(
    tmp_path: Path, kind: type[BaseException], old: bytes | None
) -> None:
    path = tmp_path / "table.csv"
    if old is not None:
        path.write_bytes(old)
    seen: list[str] = []

    def write(file: BinaryIO) -> None:
        file.write(b"half" * 100_000)  # more than a buffer, so that some of it is on disk
        file.flush()
        seen.extend(name for name in names(tmp_path) if name != "table.csv")
        raise kind("interrupted")

    with pytest.raises(kind, match="interrupted"):
        write_atomically(path, write)
    assert len(seen) == 1  # there was a temporary file beside it
    assert names(tmp_path) == ([] if old is None else ["table.csv"])
    assert old is None or path.read_bytes() == old


def test_reader_never_meets_half_a_file(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(b"old")

    def write(file: BinaryIO) -> None:
        file.write(b"new")
        file.flush()
        assert path.read_bytes() == b"old"

    write_atomically(path, write)
    assert path.read_bytes() == b"new"


def test_failed_move_leaves_no_temporary_file(tmp_path: Path) -> None:
    (tmp_path / "table.csv").mkdir()
    with pytest.raises(ValueError, match=r"^path must be an ordinary file, got the folder .*table\.csv"):
        write_atomically(tmp_path / "table.csv", lambda file: file.write(b"new"))
    assert names(tmp_path) == ["table.csv"]


def test_missing_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "absent" / "table.csv", lambda file: file.write(b"new"))
    assert names(tmp_path) == []


@contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


@POSIX
@pytest.mark.parametrize("mask", [0o022, 0o002, 0o077, 0])
def test_a_new_file_has_the_permissions_that_the_process_gives(tmp_path: Path, mask: int) -> None:
    path = tmp_path / "table.csv"
    with umask(mask):
        write_atomically(path, lambda file: file.write(b"new"))
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask


@POSIX
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o755])
def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(b"old")
    path.chmod(mode)
    with umask(0o022):
        write_atomically(path, lambda file: file.write(b"new"))
    assert stat.S_IMODE(path.stat().st_mode) == mode and path.read_bytes() == b"new"


# --- Targets that are no ordinary files ------------------------------------------------------------------


def folder_there(path: Path) -> str:
    path.mkdir()
    return "an ordinary file, got the folder"


def fifo_there(path: Path) -> str:
    os.mkfifo(path)
    return "an ordinary file, got the FIFO"


def socket_there(path: Path) -> str:
    # A socket's path has at most some hundred characters; a link's need not have.
    here = os.getcwd()
    os.chdir(path.parent)
    try:
        with socket.socket(socket.AF_UNIX) as opened:
            opened.bind(path.name)
    finally:
        os.chdir(here)
    return "an ordinary file, got the socket"


def link_to_device(path: Path) -> str:
    path.symlink_to(os.devnull)
    return "an ordinary file, got the device"


def link_to_fifo(path: Path) -> str:
    os.mkfifo(path.parent / "pipe")
    path.symlink_to("pipe")
    return "an ordinary file, got the FIFO"


def link_to_nothing(path: Path) -> str:
    path.symlink_to(path.parent / "absent")
    return "an ordinary file, got .* a link that leads nowhere"


def link_to_itself(path: Path) -> str:
    path.symlink_to(path.name)
    return "an ordinary file, got .* a link that leads nowhere"


def in_a_missing_folder(path: Path) -> str:
    path.parent.rmdir()
    return "in a folder that exists"


def in_a_file(path: Path) -> str:
    path.parent.rmdir()
    path.parent.write_text("a file")
    return "in a folder that exists"


SPECIAL = [
    folder_there,
    fifo_there,
    socket_there,
    link_to_device,
    link_to_fifo,
    link_to_nothing,
    link_to_itself,
    in_a_missing_folder,
    in_a_file,
]


def plain(path: Path) -> object:
    return write_atomically(path, pytest.fail)


def new(path: Path) -> object:
    return write_atomically(path, pytest.fail, new=True)


def motion_into(path: Path) -> object:
    told: Callable[..., Any] = lambda *_: pytest.fail("the motion began")  # noqa: E731
    return bm.simulate(CHAIN, duration=1.0, path=path, progress=told)


def film_into(path: Path) -> object:
    # The path is looked at before the motion is.
    return bm.animate(xarray.Dataset(), path)


def export_into(path: Path) -> object:
    return bm.export_chain(CHAIN, path, format="mjcf", force=True)


WRITERS = {"a": plain, "b": new, "motion.nc": motion_into, "film.gif": film_into, "beam.xml": export_into}


@POSIX
@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("there", SPECIAL)
def test_what_is_no_ordinary_file_is_refused_before_the_work(
    tmp_path: Path, name: str, there: Callable[[Path], str]
) -> None:
    path = tmp_path / "folder" / name
    path.parent.mkdir()
    said = there(path)
    before = [(p, p.lstat().st_mode) for p in sorted(tmp_path.rglob("*"))]
    if name == "b" and os.path.lexists(path):
        said = "new unless force=True"
    with pytest.raises((ValueError, OSError), match=f"^path must be {said}"):
        WRITERS[name](path)
    assert [(p, p.lstat().st_mode) for p in sorted(tmp_path.rglob("*"))] == before


@POSIX
def test_a_springs_file_in_the_way_is_found_before_the_model_is_written(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "beam.springs.yaml")
    with pytest.raises(ValueError, match=r"got the FIFO .*beam\.springs\.yaml"):
        bm.export_chain(CHAIN, tmp_path / "beam.urdf", force=True)
    assert names(tmp_path) == ["beam.springs.yaml"]


@POSIX
def test_a_study_of_figures_writes_over_ordinary_files_only(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "c_table.csv")
    with pytest.raises(ValueError, match=r"got the FIFO .*c_table\.csv"):
        run_all(["c_table"], tmp_path, 1, lambda _: None)
    assert stat.S_ISFIFO((tmp_path / "c_table.csv").lstat().st_mode)


@POSIX
@pytest.mark.parametrize("name", ["motion.nc", "film.gif", "beam.xml", "a"])
@pytest.mark.parametrize("readable", [False, True], ids=["file", "folder"])
def test_what_may_not_be_written_is_found_before_the_work(
    tmp_path: Path, name: str, readable: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Root may write everywhere, so the system's answer stands in for it."""
    path = tmp_path / name
    path.write_bytes(b"old")
    closed = tmp_path if readable else path
    answer = os.access
    monkeypatch.setattr(files.os, "access", lambda p, mode: Path(p) != closed and answer(p, mode))
    with pytest.raises(PermissionError, match=r"^path must be .* may be written"):
        WRITERS[name](path)
    assert path.read_bytes() == b"old" and names(tmp_path) == [name]


@POSIX
@pytest.mark.parametrize("name", ["table.csv", "motion.nc", "beam.xml"])
def test_a_link_stands_for_its_file(tmp_path: Path, name: str) -> None:
    """Written is the file that it leads to, over two links and in another folder; the links stay."""
    (tmp_path / "there").mkdir()
    target, middle, link = tmp_path / "there" / "file", tmp_path / "there" / "link", tmp_path / name
    target.write_bytes(b"old")
    target.chmod(0o640)
    middle.symlink_to("file")
    link.symlink_to(middle)
    if name == "motion.nc":
        bm.simulate(CHAIN, duration=0.01, step=0.01, path=link)
    elif name == "beam.xml":
        bm.export_chain(CHAIN, link, force=True)
    else:
        write_atomically(link, lambda file: file.write(b"new"))
    assert link.is_symlink() and middle.is_symlink() and not target.is_symlink()
    assert target.read_bytes() != b"old" and stat.S_IMODE(target.stat().st_mode) == 0o640
    assert names(tmp_path) == sorted([name, "there"]) and names(target.parent) == ["file", "link"]


def test_the_temporary_file_is_nobody_elses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names are drawn; one that is taken, even by a link, is neither followed nor truncated."""
    mine, path = tmp_path / "mine", tmp_path / "table.csv"
    mine.write_bytes(b"mine")
    drawn = iter(["aa", "bb", "cc"])
    monkeypatch.setattr(files.secrets, "token_hex", lambda _: next(drawn))
    (tmp_path / ".table.csv.aa").write_bytes(b"theirs")
    if sys.platform != "win32":
        (tmp_path / ".table.csv.bb").symlink_to(mine)
    write_atomically(path, lambda file: file.write(b"new"))
    assert (path.read_bytes(), mine.read_bytes()) == (b"new", b"mine")
    assert (tmp_path / ".table.csv.aa").read_bytes() == b"theirs"


@pytest.mark.parametrize("new", [False, True])
def test_a_file_of_the_longest_name(tmp_path: Path, new: bool) -> None:
    path = tmp_path / ("ö" * 120 + ".csv")
    write_atomically(path, lambda file: file.write(b"whole"), new=new)
    assert path.read_bytes() == b"whole" and len(names(tmp_path)) == 1


# --- Two that write at the same time ---------------------------------------------------------------------


@pytest.mark.parametrize("links", [True, False])
def test_of_two_new_files_one_wins(tmp_path: Path, links: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both see no file before either has written; also where the file system knows no hard links."""
    if not links:

        def no_link(*_: object) -> None:
            raise OSError(errno.EPERM, "Operation not permitted")

        monkeypatch.setattr(files.os, "link", no_link)
    path, together, outcomes = tmp_path / "beam.xml", threading.Barrier(2), []

    def writer(content: bytes) -> None:
        def fill(file: BinaryIO) -> None:
            file.write(content)
            together.wait(600)

        try:
            write_atomically(path, fill, new=True)
            outcomes.append(content)
        except FileExistsError:
            outcomes.append(b"")

    threads = [threading.Thread(target=writer, args=(content,)) for content in (b"one", b"two")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    (winner,) = filter(None, outcomes)
    assert len(outcomes) == 2 and path.read_bytes() == winner and names(tmp_path) == ["beam.xml"]


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf", ".csv"])
def test_of_two_exports_one_wins(tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    together, outcomes = threading.Barrier(2), []
    beside = files._beside

    def at_once(place: Path) -> tuple[int, Path]:
        # Both have found that there is no file yet. The loser of a first file writes no second.
        found = beside(place)
        if not together.broken:
            with suppress(threading.BrokenBarrierError):
                together.wait(5)
        return found

    monkeypatch.setattr(files, "_beside", at_once)

    def export() -> None:
        try:
            outcomes.append(len(bm.export_chain(CHAIN, tmp_path / f"beam{suffix}")))
        except FileExistsError:
            outcomes.append(0)

    threads = [threading.Thread(target=export) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == [0, 2 if suffix == ".urdf" else 1]
    assert len(names(tmp_path)) == max(outcomes)


def test_two_that_replace_a_file_do_not_disturb_each_other(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"

    def outer(file: BinaryIO) -> None:
        file.write(b"outer" * 1000)
        write_atomically(path, lambda inner: inner.write(b"inner" * 1000))
        assert path.read_bytes() == b"inner" * 1000

    write_atomically(path, outer)
    assert path.read_bytes() == b"outer" * 1000 and names(tmp_path) == ["table.csv"]


@POSIX
def test_a_special_file_that_comes_meanwhile_is_no_target(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    with pytest.raises(ValueError, match="got the FIFO"):
        write_atomically(path, lambda _: os.mkfifo(path))
    assert names(tmp_path) == ["table.csv"] and stat.S_ISFIFO(path.lstat().st_mode)


# --- A full disk -----------------------------------------------------------------------------------------


@POSIX
@pytest.mark.parametrize("integrator", ["rk4", "dop853"])
def test_a_motion_outlives_a_full_disk(tmp_path: Path, integrator: str) -> None:
    """The limit of a file's size is met as the end of a disk is, in the middle of a write."""
    import resource
    import signal

    path = tmp_path / "motion.nc"
    path.write_bytes(b"old")
    start = bm.mode_start(CHAIN, 1, 0.1)
    arguments: dict[str, Any] = {"duration": 1.0, "integrator": integrator, "initial": start}
    whole = bm.simulate(CHAIN, **arguments)
    limit, told = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limit[1]))
        with pytest.raises(bm.UnsavedMotion, match=r"^path could not be written, .*File too large") as caught:
            bm.simulate(CHAIN, **arguments, path=path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, told)
    assert caught.value.motion.identical(whole) and isinstance(caught.value, OSError)
    assert path.read_bytes() == b"old" and names(tmp_path) == ["motion.nc"]


@pytest.mark.parametrize("bad", [3, None, b"beam.xml", ["beam.xml"], np.float64(1.0), "", ".", "a\0b"])
def test_what_is_no_path(bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^path must "):
        file_target(bad)
    if bad is not None:
        with pytest.raises((TypeError, ValueError), match=r"^path must "):
            bm.simulate(CHAIN, duration=1.0, path=bad)
