"""The folder of a study: its definition, and a file for each finished chunk.

A chunk's file is written beside its place and moved there in one step, so it is whole or not there, whenever
the machine or the process stops. Its name carries the digest of its bytes: a file damaged later is found out
and its chunk computed again. Two runs that write the same chunk would write the same bytes under the same
name, so they cannot harm each other; they would only work twice, which a lock, given back by the operating
system however a run ends, prevents where the file system has locks.
"""

from __future__ import annotations

import errno
import hashlib
import json
import re
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from beammodes.batch.evaluated import Evaluated
from beammodes.checks import shown
from beammodes.files import write_atomically

__all__ = ["Store", "difference", "locked", "made_ready"]

_DEFINITION, _LOCK = "study.json", "study.lock"
_CHUNK = re.compile(r"chunk-(\d{9,})-([0-9a-f]{16})\.nc")
_TEMPORARY = re.compile(r"\.(chunk-.*\.nc|study\.json)\..*")


@dataclass(frozen=True)
class Store:
    """A study's folder.

    Attributes
    ----------
    folder : Path
    definition : dict
        What `Study.definition` said when the folder was made.
    """

    folder: Path
    definition: dict[str, Any]

    @classmethod
    def read(cls, folder: Path) -> Store:
        """Return the store in a folder; raises FileNotFoundError or ValueError if none is there."""
        path = folder / _DEFINITION
        if not path.is_file():
            raise FileNotFoundError(errno.ENOENT, f"no study is stored here, no {_DEFINITION}", str(folder))
        try:
            kept = json.loads(path.read_text("utf-8"))
            definition = dict(kept["definition"])
            for part in ("axes", "compute"):
                dict(definition[part])
            int(definition["chunk"])
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(
                f"store must have a readable {_DEFINITION}, got {shown(str(path))}: {error}"
            ) from None
        return cls(folder, definition)

    @classmethod
    def of(cls, folder: Path, definition: Mapping[str, Any], digest: str) -> Store:
        """Return the store of this definition, made if the folder is new or empty.

        Raises
        ------
        ValueError
            If the folder has something else in it.
        """
        made_ready(folder)
        if not (folder / _DEFINITION).exists():
            text = json.dumps({"digest": digest, "definition": definition}, indent=1, allow_nan=False)
            write_atomically(folder / _DEFINITION, lambda file: file.write(text.encode()))
        store = cls.read(folder)
        found = difference(store.definition, json.loads(json.dumps(definition)))
        if found:
            raise ValueError(f"store must be of this study, got {shown(str(folder))}, whose {found}")
        return store

    def finished(self) -> dict[int, Path]:
        """Return the files of finished chunks by number; the files' bytes are not looked at."""
        found = {}
        for path in sorted(self.folder.iterdir()):
            match = _CHUNK.fullmatch(path.name)
            if match:
                found[int(match[1])] = path
        return dict(sorted(found.items()))

    def save(self, number: int, chunk: Evaluated) -> None:
        """Keep a finished chunk."""
        data = chunk.to_bytes()
        path = self.folder / f"chunk-{number:09d}-{_digest(data)}.nc"
        write_atomically(path, lambda file: file.write(data))

    def load(self, path: Path) -> Evaluated | None:
        """Return a finished chunk, or None if its file is damaged."""
        data = path.read_bytes()
        return Evaluated.from_bytes(data) if path.name.endswith(f"-{_digest(data)}.nc") else None

    def sound(self) -> set[int]:
        """Return the numbers of the finished chunks; damaged files are removed, with a warning."""
        found = set()
        for number, path in self.finished().items():
            if path.name.endswith(f"-{_digest(path.read_bytes())}.nc"):
                found.add(number)
            else:
                warnings.warn(f"{path.name} is damaged, and computed again", stacklevel=4)
                path.unlink()
        return found

    def clean(self) -> None:
        """Remove what interrupted writing has left behind; only while no other run writes here."""
        for path in self.folder.iterdir():
            if _TEMPORARY.fullmatch(path.name):
                path.unlink(missing_ok=True)


def made_ready(folder: Path) -> None:
    """Make a study's folder, and write nothing into one of other things.

    Raises
    ------
    NotADirectoryError, ValueError
        If it is a file, or has something else in it.
    """
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "store must be a folder, this is a file", str(folder))
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / _DEFINITION).exists():
        return
    others = [p.name for p in folder.iterdir() if p.name != _LOCK and not _TEMPORARY.fullmatch(p.name)]
    if others:
        raise ValueError(
            f"store must be a new folder, or one of a study, got {shown(str(folder))}, in which "
            f"there is {shown(min(others))} but no {_DEFINITION}"
        )


def difference(kept: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    """Return what differs first between two definitions, in words, or nothing.

    Examples
    --------
    >>> difference({"axes": {"mode": {"values": [1]}}}, {"axes": {"mode": {"values": [1, 2]}}})
    'axes, mode, values is [1] (1 of them) there, [1, 2] (2 of them) here'
    >>> difference({"segments": [1, 2, 3]}, {"segments": [1, 2, 4]})
    'segments number 3 is 3 there, 4 here'
    """
    for name in {**kept, **wanted}:
        if name not in wanted or name not in kept:
            return f"{name} is {'there, not here' if name in kept else 'here, not there'}"
        old, new = kept[name], wanted[name]
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            inner = difference(old, new)
            if inner:
                return f"{name}, {inner}"
        elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new) > 1 and old != new:
            at = next(i for i, pair in enumerate(zip(old, new, strict=True)) if pair[0] != pair[1])
            return f"{name} number {at + 1} is {shown(old[at])} there, {shown(new[at])} here"
        elif old != new:
            sizes = [f" ({len(part)} of them)" if isinstance(part, list) else "" for part in (old, new)]
            return f"{name} is {shown(old)}{sizes[0]} there, {shown(new)}{sizes[1]} here"
    # The order of axes is that of dimensions.
    orders = ", ".join(kept), ", ".join(wanted)
    return "" if orders[0] == orders[1] else f"order is {orders[0]} there, {orders[1]} here"


@contextmanager
def locked(folder: Path) -> Iterator[bool]:
    """Keep other runs from the folder meanwhile; False where the system has no locks to do it.

    Raises
    ------
    BlockingIOError
        If another run is at work on it.
    """
    with (folder / _LOCK).open("a+") as file:
        yield _locked(file, folder)


def _locked(file: IO[str], folder: Path) -> bool:
    if sys.platform == "win32":
        return False
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BlockingIOError(errno.EAGAIN, "another run is computing this study", str(folder)) from None
    except OSError:
        # File systems shared over a network need not have locks.
        return False
    return True


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
