"""A model file's bytes with other numbers for some of its springs, and nothing else changed."""

from __future__ import annotations

import codecs
import re
from collections.abc import Mapping
from dataclasses import dataclass

from beammodes.auditing.body_tree import SpringPlace
from beammodes.auditing.bounded_xml import BadModel
from beammodes.checks import shown
from beammodes.exporters.formats import yaml_number

__all__ = ["NewNumber", "with_numbers"]

#: Numbers that differ by less are the same.
_SAME = 1e-9
_UTF_16 = {
    codecs.BOM_UTF16_LE: "utf-16-le",
    b"<\0": "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
    b"\0<": "utf-16-be",
}
_NAME = re.compile(r"<[^\s/>]+")
_ATTRIBUTE = re.compile(r"\s+([^\s=/>]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
#: What an element has between its tags: what is no text, or the text of a CDATA section, or plain text.
_CONTENT = re.compile(r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[(.*?)\]\]>|([^<]+)", re.DOTALL)
_SCALAR = re.compile(r"[^\s,\]}#]+")


@dataclass(frozen=True)
class NewNumber:
    """What a file has at a spring's place, and what it is to have there."""

    hinge: str
    old: float
    new: float

    @property
    def differs(self) -> bool:
        """True if the file is to be changed there."""
        return abs(self.new - self.old) > _SAME * abs(self.old)


def with_numbers(data: bytes, numbers: Mapping[SpringPlace, NewNumber]) -> bytes:
    """Return a file's content with new numbers at these places; refuse places that do not have the old ones.

    All other bytes stay: comments, blanks, line ends, byte order marks. An element whose stiffness is that of
    its class gets an attribute of its own, so that nothing else of the class changes.

    Examples
    --------
    >>> old = b'<joint axis="0 1 0" stiffness= "10" />'
    >>> with_numbers(old, {SpringPlace("attribute", 0): NewNumber("hinge", 10.0, 12.5)})
    b'<joint axis="0 1 0" stiffness= "12.5" />'
    """
    scalars = {place.kind == "scalar" for place in numbers}
    text = _Text.of(data, yaml=scalars == {True})
    parts, at = [], 0
    for start, end, replacement in sorted(_edit(text, *each) for each in numbers.items()):
        parts += [text.content[at:start], replacement]
        at = end
    return "".join([*parts, text.content[at:]]).encode(text.codec, "surrogatepass")


@dataclass(frozen=True)
class _Text:
    """A file as text that gives its bytes back."""

    codec: str
    content: str
    bytes_each: int

    @classmethod
    def of(cls, data: bytes, *, yaml: bool) -> _Text:
        """Return YAML, in UTF-8, as text; XML in UTF-16 too, and in all that holds ASCII byte by byte."""
        codec = "utf-8" if yaml else _UTF_16.get(data[:2], "latin-1")
        content = data.decode(codec, "strict" if yaml else "surrogatepass")
        size = 2 if codec.startswith("utf-16") else 1
        # Characters beyond the first plane of UTF-16 have four bytes.
        return cls(codec, content, size if size * len(content) == len(data) else 0)

    def character(self, byte: int) -> int:
        """Return which character begins at a byte of the file."""
        if self.bytes_each:
            return byte // self.bytes_each
        data = self.content.encode(self.codec, "surrogatepass")
        return len(data[:byte].decode(self.codec, "surrogatepass"))


def _edit(text: _Text, place: SpringPlace, number: NewNumber) -> tuple[int, int, str]:
    """Return from where to where a text is replaced, and by what."""
    new = repr(number.new)
    if place.kind == "scalar":
        start = place.start + text.content.startswith(chr(0xFEFF))
        return (*_number(_SCALAR.match(text.content, start), 0, number), yaml_number(number.new))
    at = text.character(place.start)
    name = _NAME.match(text.content, at)
    if name is None:
        raise _gone(number)
    end = name.end()
    while found := _ATTRIBUTE.match(text.content, end):
        end = found.end()
        if place.kind == "attribute" and found[1] == "stiffness":
            return (*_number(found, 2 if found[2] is not None else 3, number), new)
    if place.kind == "attribute":
        return end, end, f' stiffness="{new}"'
    runs = []
    end = text.content.index(">", end) + 1
    while found := _CONTENT.match(text.content, end):
        end = found.end()
        group = 1 if found[1] is not None else 2
        runs += [(found, group)] if (found[group] or "").strip() else []
    if len(runs) != 1:
        raise _gone(number)
    return (*_number(*runs[0], number), new)


def _number(found: re.Match[str] | None, group: int, number: NewNumber) -> tuple[int, int]:
    """Return where the first word of a match is, which must be the number that was read there."""
    words = found[group].split() if found else []
    try:
        same = bool(words) and abs(float(words[0]) - number.old) <= _SAME * abs(number.old)
    except ValueError:
        same = False
    if not found or not same:
        raise _gone(number, *words[:1])
    start = found.start(group) + found[group].index(words[0])
    return start, start + len(words[0])


def _gone(number: NewNumber, *got: str) -> BadModel:
    what = f", got {shown(got[0])}" if got else ""
    return BadModel(
        f"the spring of {number.hinge} must stand in the file as one number, {number.old:.6g}{what}"
    )
