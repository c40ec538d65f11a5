"""The springs of a URDF file, which stand in a YAML file beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from beammodes.auditing.bounded_xml import BadModel, bounded_bytes, finite_number
from beammodes.checks import choice, shown

__all__ = ["read_springs"]

#: Larger files and more pieces of YAML (words, keys and brackets) are refused; a spring has 10.
_MAX_BYTES = 4 * 2**20
_MAX_EVENTS = 120_000
_MAX_DEPTH = 6

_TOP = ("model", "springs")
_ROW = ("joint", "type", "stiffness", "rest")
_KINDS = ("hinge", "slide")


def read_springs(path: Path) -> dict[str, float]:
    """Return the springs of a file as `export_chain` writes it beside a URDF file, by joint.

    The file may have been rewritten by any YAML tool: in blocks, in braces, quoted, in another order. Below
    `springs` stands a list of springs: `joint` and `stiffness`, and if they are given the `type`, hinge or
    slide, and the position at `rest`, which must be 0; `model` beside `springs` is a name.

    Raises
    ------
    BadModel
        If it is anything else, a key stands twice, or there are tags, anchors, aliases or a second document;
        the message names the line.
    """
    try:
        data = bounded_bytes(path)
        if len(data) > _MAX_BYTES:
            raise BadModel(f"must have at most {_MAX_BYTES // 2**20} MiB")
        pieces = _Pieces(path.name, _events(data.decode("utf-8-sig")))
    except UnicodeDecodeError:
        raise BadModel(f"{path.name} must be a text file in UTF-8") from None
    except BadModel as error:
        raise BadModel(f"{path.name} {error}") from None
    found: dict[str, float] = {}
    top = pieces.document()
    if not isinstance(top.value, dict):
        top.refuse("must have the key springs, with a list of springs")
    for key, part in top.keys(_TOP).items():
        if key == "model":
            part.text("model must be a name")
        elif not isinstance(part.value, list):
            part.refuse("springs must be a list of springs, [] if there are none")
    if "springs" not in top.value:
        top.refuse("must have the key springs, with a list of springs")
    for row in top.value["springs"].value:
        name, stiffness = _spring(row)
        if name in found:
            row.refuse(f"must not give joint {shown(name)} a second spring")
        found[name] = stiffness
    return found


def _spring(row: _Part) -> tuple[str, float]:
    if not isinstance(row.value, dict) or not {"joint", "stiffness"} <= row.keys(_ROW).keys():
        row.refuse("must be a spring with the keys joint and stiffness, and no other but type and rest")
    keys = row.keys(_ROW)
    if "type" in keys:
        try:
            choice("type", keys["type"].text("type must be a word"), _KINDS)
        except ValueError as error:
            row.refuse(str(error))
    if "rest" in keys and keys["rest"].number("rest"):
        keys["rest"].refuse("must have rest 0: the chain must be straight at rest")
    return keys["joint"].text("joint must be a name"), keys["stiffness"].number("stiffness")


@dataclass(frozen=True)
class _Part:
    """A piece of the file and where it stands; `value` is text, a list or a dict of parts."""

    where: str
    value: Any
    quoted: bool = False

    def refuse(self, why: str) -> NoReturn:
        raise BadModel(f"{self.where}: {why}")

    def keys(self, allowed: tuple[str, ...]) -> dict[str, _Part]:
        found: dict[str, _Part] = self.value
        for key, part in found.items():
            try:
                choice("key", key, allowed)
            except ValueError as error:
                part.refuse(str(error))
        return found

    def text(self, what: str) -> str:
        if not isinstance(self.value, str) or not self.value:
            self.refuse(what)
        return self.value

    def number(self, name: str) -> float:
        if not isinstance(self.value, str) or self.quoted:
            self.refuse(f"{name} must be a number, got {'text' if self.quoted else 'none'}")
        return finite_number(f"{self.where}: {name}", self.value)


def _events(text: str) -> Iterator[Any]:
    import yaml

    # Only parsed, never turned into objects; the parser written in C is there in most builds.
    return iter(yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)))


@dataclass
class _Pieces:
    """Reads the parser's events, and bounds their number and depth."""

    name: str
    events: Iterator[Any]
    count: int = 0

    def document(self) -> _Part:
        """Return the one document that there must be."""
        self._next("StreamStartEvent")
        self._next("DocumentStartEvent")
        found = self._part(self._next(), 1)
        self._next("DocumentEndEvent")
        self._next("StreamEndEvent")
        return found

    def _next(self, kind: str = "") -> Any:
        import yaml

        try:
            event = next(self.events)
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            line = "" if mark is None else f", line {mark.line + 1}"
            why = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
            raise BadModel(f"{self.name}{line}: must be YAML: {shown(why)}") from None
        self.count += 1
        if self.count > _MAX_EVENTS:
            raise BadModel(f"{self.name} must have at most {_MAX_EVENTS} pieces")
        if kind and type(event).__name__ != kind:
            raise BadModel(f"{self._where(event)}: must be one document that is not empty")
        return event

    def _where(self, event: Any) -> str:
        return f"{self.name}, line {event.start_mark.line + 1}"

    def _part(self, event: Any, depth: int) -> _Part:
        kind, where = type(event).__name__, self._where(event)
        tag = getattr(event, "tag", None)
        if kind == "AliasEvent" or event.anchor is not None or tag not in (None, "!"):
            raise BadModel(f"{where}: must have no anchors, aliases or tags")
        if depth > _MAX_DEPTH:
            raise BadModel(f"{where}: must not be nested more than {_MAX_DEPTH} deep")
        if kind == "ScalarEvent":
            return _Part(where, event.value, quoted=bool(event.style))
        if kind == "SequenceStartEvent":
            items = []
            while type(inner := self._next()).__name__ != "SequenceEndEvent":
                items.append(self._part(inner, depth + 1))
            return _Part(where, items)
        pairs: dict[str, _Part] = {}
        while type(inner := self._next()).__name__ != "MappingEndEvent":
            key = self._part(inner, depth + 1).text("a key must be a word")
            if key in pairs:
                raise BadModel(f"{self._where(inner)}: must not have the key {shown(key)} twice")
            pairs[key] = self._part(self._next(), depth + 1)
        return _Part(where, pairs)
