"""Atomic writing: all of a file or nothing."""

from __future__ import annotations

import stat
import sys
from pathlib import Path
from typing import BinaryIO

import pytest

from beammodes.files import write_atomically


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
    with pytest.raises(OSError, match=r"table\.csv"):
        write_atomically(tmp_path / "table.csv", lambda file: file.write(b"new"))
    assert names(tmp_path) == ["table.csv"]


def test_missing_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "absent" / "table.csv", lambda file: file.write(b"new"))
    assert names(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX permissions")
def test_others_may_read_the_file(tmp_path: Path) -> None:
    write_atomically(tmp_path / "table.csv", lambda file: file.write(b"new"))
    assert stat.S_IMODE((tmp_path / "table.csv").stat().st_mode) == 0o644
