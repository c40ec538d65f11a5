"""An XML file as a plain tree, read within bounds of size, depth and time; entities are refused."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn
from xml.parsers import expat

import numpy as np

from beammodes.checks import shown
from beammodes.files import named_path, ordinary_bytes
from beammodes.numerics.arrays import Floats

__all__ = [
    "MAX_BYTES",
    "MAX_DEPTH",
    "MAX_ELEMENTS",
    "BadModel",
    "UnexpandedModel",
    "XmlElement",
    "bounded_bytes",
    "finite_number",
    "read_xml",
]

#: Larger files, more elements and deeper nesting are refused. An SDFormat file of 5000 links has 145,000
#: elements in 4 MB; MuJoCo itself refuses elements nested 500 deep.
MAX_BYTES = 16 * 2**20
MAX_ELEMENTS = 200_000
MAX_DEPTH = 600
_CHUNK = 2**16
#: No length, mass or stiffness is larger, in any unit; products of two stay finite.
_LARGEST = 1e30
#: The square of a smaller number, other than 0, would underflow.
_SMALLEST = 1e-100
_LONGEST_NUMBER, _LONGEST_NAME = 100, 200


class BadModel(ValueError):
    """A model file that cannot be read, or that holds what the audit cannot honour."""


class UnexpandedModel(BadModel):
    """A model file in which only its engine can tell what belongs together."""


@dataclass(slots=True)
class XmlElement:
    """One element: attributes, own text, children, the line and the byte of its tag, the file if included."""

    tag: str
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list[XmlElement] = field(default_factory=list)
    file: str = ""
    start: int = 0

    def all(self, *tags: str) -> Iterator[XmlElement]:
        """Yield the children of these tags, in their order."""
        return (child for child in self.children if child.tag in tags)

    def first(self, tag: str) -> XmlElement | None:
        """Return the first child of that tag."""
        return next(self.all(tag), None)

    def refuse(self, why: str) -> NoReturn:
        """Raise `BadModel` that names this element and its line."""
        raise BadModel(f"{self.where} {why}")

    @property
    def where(self) -> str:
        """The element as messages name it."""
        name = self.attributes.get("name")
        file = f"{self.file}, " if self.file else ""
        return f"{file}line {self.line}: <{self.tag[:40]}{f' name={shown(name)}' if name else ''}>"

    def numbers(self, name: str, count: int | tuple[int, ...], default: str | None = None) -> list[float]:
        """Return the numbers of an attribute; `count` is how many, or which counts are allowed."""
        text = self.attributes.get(name, default)
        if text is None:
            self.refuse(f"must have the attribute {name}")
        return self.read(name, text, count)

    def number(self, name: str, default: str | None = None) -> float:
        """Return the one number of an attribute."""
        return self.numbers(name, 1, default)[0]

    def child_text(self, tag: str) -> str:
        """Return the text of the first child of that tag, empty if there is none."""
        child = self.first(tag)
        return "" if child is None else child.text.strip()

    def child_numbers(self, tag: str, count: int, default: str) -> list[float]:
        """Return the numbers that the first child of that tag has as its text."""
        child = self.first(tag)
        return self.read(tag, default, count) if child is None else child.read(tag, child.text, count)

    def read(self, name: str, text: str, count: int | tuple[int, ...]) -> list[float]:
        """Return the numbers of a text, which stands in this element under that name."""
        allowed = count if isinstance(count, tuple) else (count,)
        words = text[: _LONGEST_NUMBER * (max(allowed) + 1)].split()
        if len(words) not in allowed:
            self.refuse(f"must have {' or '.join(map(str, allowed))} numbers in {name}, got {shown(text)}")
        own = f"{self.where} {name}"
        return [finite_number(own, word) for word in words]

    def at_least_0(self, name: str, value: float) -> float:
        """Return the value of what `name` says; refuse one below 0."""
        if value < 0:
            self.refuse(f"must have {'an' if name[0] == 'a' else 'a'} {name} of at least 0, got {value:g}")
        return value

    def direction(self, vector: Sequence[float] | Floats, name: str = "axis") -> Floats:
        """Return a unit vector; refuse zero."""
        size = float(np.linalg.norm(vector))
        if not size:
            self.refuse(f"must have {'an' if name[0] == 'a' else 'a'} {name} that is not zero")
        return np.asarray(vector, dtype=np.float64) / size


def finite_number(name: str, text: str) -> float:
    """Return a finite number of a file; refuse one larger than 1e30, or smaller than 1e-100 and not 0.

    Examples
    --------
    >>> finite_number("mass", "0.5")
    0.5
    """
    try:
        value = float(text[:_LONGEST_NUMBER])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadModel(f"{name} must be a finite number, got {shown(text)}")
    if abs(value) > _LARGEST:
        raise BadModel(f"{name} must be at most {_LARGEST:g} in size, got {shown(text)}")
    if 0 < abs(value) < _SMALLEST:
        raise BadModel(f"{name} must be 0 or at least {_SMALLEST:g} in size, got {shown(text)}")
    return value


def bounded_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file of at most 16 MiB; refuse a device or a pipe, which might never end."""
    place = named_path(path)
    try:
        return ordinary_bytes(place, MAX_BYTES)
    except UnicodeError:
        raise
    except ValueError as error:
        raise BadModel(str(error)) from None


def read_xml(path: str | os.PathLike[str], file: str = "") -> XmlElement:
    """Return the root element of a file, which messages name by `file`.

    A document type declaration, the only place for entities, is refused before it is read. On files made to
    be costly (a million bodies, endless nesting, half a million attributes, names and numbers of 8 MB,
    entities that expand to 10⁹ letters) a refusal took at most 1.6 s and 120 MB.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
    ...     _ = file.write("<mujoco><worldbody/></mujoco>")
    ...     file.flush()
    ...     read_xml(file.name).children[0].tag
    'worldbody'
    """
    whole = bounded_bytes(path)
    data = _tolerated(whole)
    # Nothing but a mark at the head is shorter than in the file.
    builder = _Builder(file, len(whole) - len(data))
    try:
        for start in range(0, max(len(data), 1), _CHUNK):
            builder.parser.Parse(data[start : start + _CHUNK], False)
        builder.parser.Parse(b"", True)
    except expat.ExpatError as error:
        raise BadModel(f"line {error.lineno}: no well-formed XML: {expat.ErrorString(error.code)}") from None
    except BadModel:
        raise
    except (LookupError, ValueError) as error:
        raise BadModel(f"must be XML in UTF-8, UTF-16 or Latin-1: {str(error)[:80]}") from None
    return builder.root.children[0]


def _tolerated(data: bytes) -> bytes:
    """Return a text without what engines read though XML forbids it: "--" in comments, blanks at its head.

    A mark of UTF-8 at its head goes too. Lines keep their numbers.
    """
    data = data.removeprefix(b"\xef\xbb\xbf")
    declaration = data.lstrip(b" \t\r\n")
    if declaration.startswith(b"<?xml") and len(declaration) < len(data) and b"?>" in declaration:
        end = declaration.index(b"?>") + 2
        data = declaration[:end] + data[: len(data) - len(declaration)] + declaration[end:]
    parts, place = [], 0
    while (start := data.find(b"<!--", place)) >= 0 and (end := data.find(b"-->", start + 4)) >= 0:
        inside = data[start + 4 : end].replace(b"--", b"==")
        inside = inside[:-1] + b"=" if inside.endswith(b"-") else inside
        parts += [data[place : start + 4], inside]
        place = end
    return b"".join([*parts, data[place:]]) if parts else data


class _Builder:
    """Collects elements while expat reports them."""

    def __init__(self, file: str, mark: int) -> None:
        self.root = XmlElement("", {}, 0)
        self.open = [self.root]
        self.parser: Any = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = lambda _: self.open.pop()
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype
        self.count = 0
        self.file, self.mark = file, mark

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        line = self.parser.CurrentLineNumber
        if self.count > MAX_ELEMENTS:
            raise BadModel(f"line {line}: must have at most {MAX_ELEMENTS} elements")
        if len(self.open) > MAX_DEPTH:
            raise BadModel(f"line {line}: must have elements nested at most {MAX_DEPTH} deep")
        element = XmlElement(
            tag, attributes, line, file=self.file, start=self.mark + self.parser.CurrentByteIndex
        )
        name = attributes.get("name", "")
        if len(name) > _LONGEST_NAME or not name.isprintable():
            element.refuse(f"must have a printable name of at most {_LONGEST_NAME} characters")
        self.open[-1].children.append(element)
        self.open.append(element)

    def _text(self, text: str) -> None:
        # Only short texts are numbers or names; of a long one a piece too many is kept, to be refused.
        element = self.open[-1]
        if len(element.text) <= 10 * _LONGEST_NUMBER:
            element.text += text[: 11 * _LONGEST_NUMBER]

    def _doctype(self, *_: object) -> None:
        raise BadModel(f"line {self.parser.CurrentLineNumber}: must have no document type declaration")
