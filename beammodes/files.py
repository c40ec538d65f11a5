"""Writing files so that a reader never meets half of one."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

__all__ = ["ordinary_bytes", "write_atomically"]


def write_atomically(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Let `write` fill a temporary file beside `path`, then move it there in one step.

    Interrupted or failed writing leaves what was at `path` untouched, and no temporary file.

    Examples
    --------
    >>> folder = Path(tempfile.mkdtemp())
    >>> write_atomically(folder / "a.txt", lambda file: file.write(b"whole"))
    >>> (folder / "a.txt").read_bytes(), len(list(folder.iterdir()))
    (b'whole', 1)
    """
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            write(file)
        # mkstemp makes files private; these are meant to be shared like any other.
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def ordinary_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """Return the content of an ordinary file of at most so many bytes.

    Raises
    ------
    ValueError
        If it is a device or a pipe, which might never end, or larger.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> with tempfile.NamedTemporaryFile() as file:
    ...     ordinary_bytes(file.name, 10)
    b''
    """
    place = Path(path)
    mode = place.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(f"{place} is a folder, not a file")
    if not stat.S_ISREG(mode):
        raise ValueError("must be an ordinary file")
    with place.open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise ValueError(f"must have at most {most // 2**20} MiB")
    return data
