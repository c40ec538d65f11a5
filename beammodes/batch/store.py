"""A study stored in a folder: its definition, and a file for each finished chunk.

A chunk's file is written beside its place and moved there in one step, so it is whole or not there, whenever
the machine or the process stops. Its name carries the digest of its bytes: a file damaged later is found out
and its chunk computed again. In it stand the study's digest and the chunk's number: a file of another study,
or one renamed to another number, is found out as well and set aside. Two runs that write the same chunk would
write the same bytes under the same name, so they cannot harm each other; they would only work twice, which a
lock, given back by the operating system however a run ends, prevents where the file system has locks.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from beammodes.batch.quantities import REASON
from beammodes.checks import shown
from beammodes.files import write_atomically
from beammodes.numerics.arrays import Floats
from beammodes.progress import held, pause

__all__ = [
    "BadChunk",
    "Evaluated",
    "Store",
    "definition_digest",
    "difference",
    "locked",
    "made_ready",
]

_DEFINITION, _LOCK = "study.json", "study.lock"
_CHUNK = re.compile(r"chunk-(\d{9,})-([0-9a-f]{16})\.nc")
_TEMPORARY = re.compile(r"\.(chunk-.*\.nc|study\.json)\..*")


@dataclass(frozen=True, eq=False)
class Evaluated:
    """The quantities of one chunk.

    Attributes
    ----------
    values : dict from names to arrays, shape (cases, modes) or (cases,)
    reasons : dict from int to str
        Why numbers of a case are NaN, by its place in the chunk.
    """

    values: dict[str, Floats]
    reasons: Mapping[int, str] = field(default_factory=dict)

    def to_bytes(self, study: str, number: int) -> bytes:
        """Return a netCDF file with the study's digest and the chunk's number: the same bytes always."""
        import h5netcdf

        # Text as attributes, and whole numbers for it at the cases: arrays of strings would be of objects.
        texts: dict[str, int] = {}
        which = np.zeros(len(next(iter(self.values.values()))), dtype=np.int64)
        for place, text in self.reasons.items():
            which[place] = texts.setdefault(text, len(texts) + 1)
        whole = io.BytesIO()
        with h5netcdf.File(whole, "w") as file:
            for name, array in {**self.values, REASON: which}.items():
                dimensions = ("case", "mode")[: array.ndim]
                for dimension, size in zip(dimensions, array.shape, strict=True):
                    if dimension not in file.dimensions:
                        file.dimensions[dimension] = size
                file.create_variable(name, dimensions, data=array)
            file.attrs["study"], file.attrs["chunk"] = study, np.int64(number)
            file.attrs["reasons"] = "\n".join(texts)
        return whole.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> tuple[Evaluated, str, int]:
        """Return the chunk that `to_bytes` wrote, its study's digest and its number.

        Examples
        --------
        >>> chunk = Evaluated({"a": np.array([1.0, np.nan])}, {1: "why"})
        >>> found, study, number = Evaluated.from_bytes(chunk.to_bytes("2f1c", 5))
        >>> found.reasons, study, number
        ({1: 'why'}, '2f1c', 5)
        """
        import h5netcdf

        with h5netcdf.File(io.BytesIO(data), "r") as file:
            study, number = str(file.attrs["study"]), int(file.attrs["chunk"])
            texts = str(file.attrs["reasons"]).split("\n")
            values = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        which = values.pop(REASON)
        reasons = {int(place): texts[which[place] - 1] for place in np.flatnonzero(which)}
        return cls(values, reasons), study, number


class BadChunk(Exception):
    """Error: a file under a chunk's name is not this chunk; the message says what it is."""


class ForeignChunk(BadChunk):
    """Error: a sound file is of another study, or of another chunk."""


@dataclass(frozen=True)
class Store:
    """A study's folder.

    Attributes
    ----------
    folder : Path
    definition : dict
        What `Study.definition` said when the folder was made.
    digest : str
        Of the definition; every chunk carries it.
    """

    folder: Path
    definition: dict[str, Any]
    digest: str

    @classmethod
    def read(cls, folder: Path) -> Store:
        """Return the store in a folder; raises FileNotFoundError or ValueError if none is there."""
        path = folder / _DEFINITION
        if not path.is_file():
            raise FileNotFoundError(errno.ENOENT, f"no study is stored here, no {_DEFINITION}", str(folder))
        try:
            kept = json.loads(path.read_text("utf-8"))
            definition, digest = dict(kept["definition"]), str(kept["digest"])
            for part in ("axes", "compute"):
                dict(definition[part])
            int(definition["chunk"])
            if definition_digest(definition) != digest:
                raise ValueError("its digest is not that of its definition, so it was changed or damaged")
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(
                f"store must have a readable {_DEFINITION}, got {shown(str(path))}: {error}"
            ) from None
        return cls(folder, definition, digest)

    @classmethod
    def of(cls, folder: Path, definition: Mapping[str, Any]) -> Store:
        """Return the store of this definition, made if the folder is new or empty; else raise ValueError."""
        made_ready(folder)
        if not (folder / _DEFINITION).exists():
            whole = {"digest": definition_digest(definition), "definition": definition}
            text = json.dumps(whole, indent=1, allow_nan=False)
            write_atomically(folder / _DEFINITION, lambda file: file.write(text.encode()))
        store = cls.read(folder)
        found = difference(store.definition, json.loads(json.dumps(definition)))
        if found:
            raise ValueError(f"store must be of this study, got {shown(str(folder))}, whose {found}")
        return store

    def finished(self) -> list[tuple[int, Path]]:
        """Return the numbers and files of finished chunks in order; the files' bytes are not looked at."""
        found = []
        for path in self.folder.iterdir():
            match = _CHUNK.fullmatch(path.name)
            if match:
                found.append((int(match[1]), path))
        return sorted(found)

    def save(self, number: int, chunk: Evaluated) -> None:
        """Keep a finished chunk; an interrupt waits until it is kept."""
        with held():
            data = chunk.to_bytes(self.digest, number)
            path = self.folder / f"chunk-{number:09d}-{_digest(data)}.nc"
            write_atomically(path, lambda file: file.write(data))
            pause()

    def load(self, number: int, path: Path) -> Evaluated:
        """Return a finished chunk; raise BadChunk for a damaged file, or one of another study or chunk."""
        data = path.read_bytes()
        if not path.name.endswith(f"-{_digest(data)}.nc"):
            raise BadChunk("is damaged")
        try:
            chunk, study, place = Evaluated.from_bytes(data)
        except (OSError, KeyError, ValueError):
            raise ForeignChunk("is not a file of this version") from None
        if study != self.digest:
            raise ForeignChunk("is a chunk of another study")
        if place != number:
            raise ForeignChunk(f"is chunk {place} under another's name")
        return chunk

    def chunks(self, *, mend: bool = False) -> Iterator[tuple[int, Evaluated]]:
        """Yield the finished chunks, each once, with a warning of files that are something else.

        With `mend` damaged files are removed, and those of other studies or chunks renamed.
        """
        seen = set()
        for number, path in self.finished():
            try:
                chunk = self.load(number, path)
            except FileNotFoundError:
                continue  # set aside by a run that is at work
            except BadChunk as fault:
                aside = path.with_name(f"{path.name}.aside") if isinstance(fault, ForeignChunk) else None
                again = ", and computed again" if mend else ""
                moved = f"; the file is now {aside.name}" if mend and aside else ""
                warnings.warn(f"{path.name} {fault}{again}{moved}", stacklevel=4)
                if mend and aside:
                    path.replace(aside)
                elif mend:
                    path.unlink()
                continue
            if number not in seen:
                seen.add(number)
                yield number, chunk

    def clean(self) -> None:
        """Remove what interrupted writing has left behind; only while no other run writes here."""
        for path in self.folder.iterdir():
            if _TEMPORARY.fullmatch(path.name):
                path.unlink(missing_ok=True)


def made_ready(folder: Path) -> None:
    """Make a study's folder; raise NotADirectoryError or ValueError if something else is there."""
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
    """Return the first difference between two definitions in words, "" if there is none.

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


def definition_digest(definition: Mapping[str, Any]) -> str:
    """Return a fingerprint of a study's definition, in hexadecimal."""
    text = json.dumps(definition, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


@contextmanager
def locked(folder: Path) -> Iterator[bool]:
    """Keep other runs from the folder, or raise BlockingIOError; False where the file system has no locks."""
    from filelock import FileLock, Timeout

    lock = FileLock(folder / _LOCK, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise BlockingIOError(errno.EAGAIN, "another run is computing this study", str(folder)) from None
    except (OSError, NotImplementedError):
        # File systems shared over a network need not have locks.
        yield False
        return
    try:
        yield True
    finally:
        lock.release()


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
