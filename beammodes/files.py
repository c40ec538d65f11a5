"""Ordinary files: read up to a size; written whole or not at all, at places checked before the work."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from beammodes.checks import shown

__all__ = ["file_target", "named_path", "ordinary_bytes", "ordinary_text", "write_atomically"]

_KINDS = {
    stat.S_IFDIR: "folder",
    stat.S_IFIFO: "FIFO",
    stat.S_IFSOCK: "socket",
    stat.S_IFCHR: "device",
    stat.S_IFBLK: "device",
}
#: What systems say whose file systems have no hard links.
_NO_LINKS = {errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, errno.EXDEV}


def file_target(path: object, *, new: bool = False) -> Path:
    """Return the place where a file is to be written, checked before the work and not after it.

    A symbolic link to an ordinary file stands for that file: the link stays, and the file is replaced. A link
    that leads nowhere is refused.

    Parameters
    ----------
    path : str or Path
    new : bool
        Whether nothing, not even a link, may be there already.

    Raises
    ------
    TypeError, ValueError
        If it is no path, or there is something else than an ordinary file: a folder, a device, a FIFO.
    FileNotFoundError
        If its folder does not exist, or it is a link that leads nowhere.
    FileExistsError
        If something is there and it must be `new`.
    PermissionError
        If the folder, or the file that is there, may not be written.

    Examples
    --------
    >>> file_target("/dev/null")
    Traceback (most recent call last):
        ...
    ValueError: path must be an ordinary file, got the device '/dev/null'
    """
    given = named_path(path)
    # Of a long path the end says most.
    text = str(given)
    name = shown(text if len(text) <= 50 else f"...{text[-47:]}")
    if not given.name:
        raise ValueError(f"path must name a file, got {name}")
    if new and os.path.lexists(given):
        raise FileExistsError(f"path must be new unless force=True, got {name}, which exists already")
    place = Path(os.path.realpath(given)) if given.is_symlink() else given
    if place.is_symlink() or (place != given and not os.path.lexists(place)):
        raise FileNotFoundError(f"path must be an ordinary file, got {name}, a link that leads nowhere")
    if not place.parent.is_dir():
        raise FileNotFoundError(f"path must be in a folder that exists, got {name}")
    there = _mode(place)
    if there is not None and not stat.S_ISREG(there):
        kind = _KINDS.get(stat.S_IFMT(there), "special file")
        raise ValueError(f"path must be an ordinary file, got the {kind} {name}")
    if there is not None and not os.access(place, os.W_OK):
        raise PermissionError(f"path must be a file that may be written, got {name}")
    if not os.access(place.parent, os.W_OK | os.X_OK):
        raise PermissionError(f"path must be in a folder that may be written to, got {name}")
    return place


def write_atomically(
    path: str | Path,
    write: Callable[[BinaryIO], object],
    *,
    new: bool = False,
    check: Callable[[Path], object] | None = None,
) -> None:
    """Let `write` fill a temporary file beside `path`, then move it there in one step.

    Interrupted or failed writing leaves what was at `path` untouched, and no temporary file. A file that is
    replaced keeps its permissions; a new one has those that the process gives its files. With `new`, one of
    two that write at the same time succeeds and the other raises FileExistsError. Two that replace a file do
    not disturb each other: the last one's content stays.

    Parameters
    ----------
    path, new
        As `file_target` takes them; it is called again here.
    write : function of an open binary file
    check : function of a path, optional
        It is given the temporary file, beside `path`, when that is whole; if it raises, nothing is written.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> write_atomically(folder / "a.txt", lambda file: file.write(b"whole"))
    >>> (folder / "a.txt").read_bytes(), len(list(folder.iterdir()))
    (b'whole', 1)
    """
    place = file_target(path, new=new)
    descriptor, temporary = _beside(place)
    try:
        with os.fdopen(descriptor, "wb") as file:
            write(file)
        if check is not None:
            check(temporary)
        # Asked again: what is there now must not be a special file that came meanwhile.
        there = _mode(file_target(path, new=new))
        if new:
            _move_new(temporary, place)
        else:
            if there is not None:
                os.chmod(temporary, stat.S_IMODE(there) & 0o777)
            os.replace(temporary, place)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def named_path(path: object) -> Path:
    """Return a path that can name a file, or raise TypeError or ValueError.

    Examples
    --------
    >>> named_path("a.txt").name
    'a.txt'
    """
    if not isinstance(path, str | os.PathLike) or isinstance(os.fspath(path), bytes):
        raise TypeError(f"path must be a str or a Path, got {shown(path)}")
    if "\0" in os.fspath(path):
        raise ValueError(f"path must be without a null character, got {shown(path)}")
    return Path(path)


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
    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile() as file:
    ...     ordinary_bytes(file.name, 10)
    b''
    """
    place = named_path(path)
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


def ordinary_text(path: str | os.PathLike[str], most: int) -> str:
    """Return the text of an ordinary file in UTF-8 of at most so many bytes.

    Raises
    ------
    ValueError
        If it is a device or a pipe, larger, or no text in UTF-8; the message names the file.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile() as file:
    ...     ordinary_text(file.name, 10)
    ''
    """
    try:
        return ordinary_bytes(path, most).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{os.fspath(path)} must be a text file in UTF-8") from None
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)} {error}") from None


def _mode(place: Path) -> int | None:
    """Return type and permissions of a file, links not followed, or None if there is none."""
    try:
        return place.lstat().st_mode
    except FileNotFoundError:
        return None


def _beside(place: Path) -> tuple[int, Path]:
    """Open a file of a name that nobody else has, in the folder of another."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    while True:
        # Names have at most 255 bytes.
        start = os.fsdecode(os.fsencode(place.name)[:200])
        temporary = place.with_name(f".{start}.{secrets.token_hex(8)}")
        with suppress(FileExistsError):
            return os.open(temporary, flags | getattr(os, "O_CLOEXEC", 0), 0o666), temporary


def _move_new(temporary: Path, place: Path) -> None:
    """Move a file to a place where there is none, or raise FileExistsError."""
    try:
        os.link(temporary, place)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        # Reserve the name, which only one can do, and fill it.
        os.close(os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            os.replace(temporary, place)
        except BaseException:
            place.unlink(missing_ok=True)
            raise
    else:
        temporary.unlink()
