"""URDF, the robot description of ROS, and the springs that stand in a YAML file beside it."""

from __future__ import annotations

import difflib
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn

from beammodes.auditing.body_tree import (
    Frame,
    Inertial,
    Model,
    ModelBody,
    ModelJoint,
    SpringPlace,
    ends_of,
    joined,
)
from beammodes.auditing.bounded_xml import BadModel, XmlElement, bounded_bytes, finite_number
from beammodes.checks import choice, shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "MOMENTS",
    "PlacedSpring",
    "by_name",
    "check_added",
    "limit_number",
    "links_of",
    "reach_of",
    "read_springs",
    "read_urdf",
    "shapes_of",
    "why_driven",
    "why_not_free",
]

#: Drake's own elements that hold bodies together outside the tree of joints.
_ADDED = ("drake:linear_bushing_rpy", "drake:ball_constraint", "drake:joint")
_DRIVEN = {"drake:rotor_inertia": "inertia", "drake:controller_gains": "a servo"}
_KINDS = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "floating": "free",
    "fixed": "fixed",
}
#: As many names, of as many letters, are looked through for the one that is meant.
_SHORT = 200
#: Engines take a limit of this size for none; Gazebo writes the largest double, others infinity.
_NO_LIMIT = 1e16
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


# Links and joints, as URDF and SDFormat have them.


def by_name(elements: Iterable[XmlElement]) -> dict[str, XmlElement]:
    """Return elements by name; refuse one without a name, or with that of another."""
    found: dict[str, XmlElement] = {}
    for element in elements:
        name = element.attributes.get("name") or element.refuse("must have a name")
        if name in found:
            element.refuse(f"must have a name of its own, got {shown(name)} for a second time")
        found[name] = element
    return found


def check_added(model: XmlElement) -> None:
    """Refuse a model with something left for xacro to do, or with bushings between its bodies."""
    for element in model.children:
        if element.tag.startswith("xacro:"):
            element.refuse("must have been expanded by xacro")
        if element.tag in _ADDED:
            element.refuse("must be left out: only joints of a tree are read")


def links_of(
    root: XmlElement, links: Mapping[str, XmlElement], ends: list[tuple[str, str, XmlElement]]
) -> Iterator[tuple[str, str, int, XmlElement | None]]:
    """Yield each link, parents first: its name, its parent's name and index, and the joint between.

    The index counts the links that were yielded before, -1 is the ground; roots have no joint. Links that
    form no tree are refused.
    """
    below: defaultdict[str, list[tuple[str, XmlElement]]] = defaultdict(list)
    parent: dict[str, str] = {}
    for above, name, joint in ends:
        for link in (above, name):
            if link not in links and not (link == "world" and link == above):
                joint.refuse(f"must join links that exist, got {shown(link)}")
        if name in parent or name == above:
            joint.refuse(f"must not give link {shown(name)} a second parent or itself: chains are trees")
        parent[name] = above
        below[above].append((name, joint))
    roots = [name for name in links if name not in parent]
    waiting: list[tuple[str, str, XmlElement | None]] = [(name, "", None) for name in roots[::-1]]
    if "world" not in links:
        waiting += [(name, "world", joint) for name, joint in below["world"][::-1]]
    index: dict[str, int] = {}
    while waiting:
        name, above, own = waiting.pop()
        yield name, above, index.get(above, -1), own
        index[name] = len(index)
        waiting += [(child, name, joint) for child, joint in below[name][::-1]]
    if len(index) < len(links) or not index:
        root.refuse("must have links in a tree, got none or a loop")


def shapes_of(link: XmlElement) -> Iterator[tuple[XmlElement, XmlElement]]:
    """Yield each shape that shows how far a link reaches, after the visual or collision that it is in."""
    for part in link.all("visual", "collision"):
        geometry = part.first("geometry")
        for shape in () if geometry is None else geometry.all("box", "cylinder", "capsule", "sphere"):
            yield part, shape


def reach_of(kind: str, values: Sequence[float], frame: Frame) -> tuple[Floats, ...]:
    """Return how far a shape reaches, by full lengths of a box, or radius and length of others."""
    sizes = [value / 2 for value in values] if kind == "box" else [values[0], values[-1] / 2]
    return frame.points(ends_of(kind, sizes))


def why_not_free(joint: XmlElement, limits: tuple[float, float] | None, friction: float, rest: float) -> str:
    """Return why a joint does not swing freely about where it rests, empty if it does."""
    if friction:
        return f"{joint.where} must have no friction: dry friction holds a hinge still"
    if limits is not None and not limits[0] < rest < limits[1]:
        return f"{joint.where} must be at rest within its limits, not at a stop or beyond"
    return ""


def limit_number(limit: XmlElement, name: str, text: str, unlimited: float) -> float:
    """Return a limit; `unlimited` where the text is empty, or a number that stands for none."""
    try:
        none = not text or abs(float(text[:100])) >= _NO_LIMIT
    except ValueError:
        none = False
    return unlimited if none else limit.read(name, text, 1)[0]


def why_driven(parent: XmlElement, joint: XmlElement) -> str:
    """Return why a joint is no plain hinge by Drake's elements below `parent`, empty if it is."""
    for element in (inner for child in parent.children for inner in (child, *child.children)):
        given = [element.text, element.attributes.get("value", ""), element.attributes.get("p", "")]
        if element.tag in _DRIVEN and any(text.strip().strip("0.") for text in given):
            what = _DRIVEN[element.tag]
            return f"{joint.where} must have no <{element.tag}>, which is {what} that no beam has"
    return ""


# URDF.


def read_urdf(root: XmlElement, springs: Mapping[str, PlacedSpring]) -> Model:
    """Return the links and joints of a URDF robot, its root link fixed to the ground.

    Springs, for which URDF has no place, are those given, and the `springStiffness` of Gazebo's extension.
    """
    check_added(root)
    links, joints = by_name(root.all("link")), by_name(root.all("joint"))
    springs = _both_springs(_gazebo_springs(root), springs)
    unknown = springs.keys() - joints.keys()
    if unknown:
        name = sorted(unknown)[0]
        short = [own for own in joints if len(own) <= _SHORT][:_SHORT]
        near = difflib.get_close_matches(name[:_SHORT].lower(), short, n=1)
        hint = f" (did you mean {shown(near[0])}?)" if near else ""
        raise BadModel(f"springs must name joints of the URDF file, got {shown(name)}{hint}")
    driven = _driven(root, joints)
    ends = [(_end(joint, "parent"), _end(joint, "child"), joint) for joint in joints.values()]
    frames = {"world": Frame()}
    bodies: list[ModelBody] = []
    for name, above, parent, joint in links_of(root, links, ends):
        frames[name] = frame = Frame() if joint is None else frames[above] @ _pose(joint)
        own = () if joint is None else _joint(joint, frame, springs, driven)
        inertial, extent = _matter(links[name])
        bodies.append(ModelBody(name, parent, inertial, extent, own).placed(frame))
    first = shown(bodies[0].name)
    notes = () if "world" in links else (f"root link {first} is taken as fixed to the ground",)
    hinge = next((name for name, joint in joints.items() if _KINDS.get(_type(joint)) == "hinge"), "NAME")
    hint = (
        "URDF has no springs: give a file with them by springs= (--springs), or beside the model as "
        f"NAME.springs.yaml, with a row such as {{joint: {hinge}, stiffness: 10.0}} a hinge"
    )
    return Model(tuple(bodies), notes=notes, hint="" if springs else hint)


def _type(joint: XmlElement) -> str:
    return joint.attributes.get("type", "")


def _end(joint: XmlElement, which: str) -> str:
    end = joint.first(which)
    return "" if end is None else end.attributes.get("link", "")


def _pose(element: XmlElement) -> Frame:
    origin = element.first("origin")
    if origin is None:
        return Frame()
    turn = origin.numbers("rpy", 3, "0 0 0")
    return Frame.by_angles(origin.numbers("xyz", 3, "0 0 0"), turn)


def _joint(
    joint: XmlElement, frame: Frame, springs: Mapping[str, PlacedSpring], driven: Mapping[str, str]
) -> tuple[ModelJoint, ...]:
    kind, name = _type(joint), joint.attributes["name"]
    if kind == "fixed":
        return ()
    axis, limit = joint.first("axis"), joint.first("limit")
    dynamics = joint.first("dynamics") or XmlElement("dynamics", {}, joint.line)
    direction = joint.direction([1.0, 0, 0] if axis is None else axis.numbers("xyz", 3))
    limits = None
    if limit is not None and kind in ("revolute", "prismatic"):
        lower, upper = (limit.attributes.get(key, "0") for key in ("lower", "upper"))
        limits = (
            limit_number(limit, "lower", lower, -math.inf),
            limit_number(limit, "upper", upper, math.inf),
        )
    spring = springs.get(name)
    rest = spring.rest if spring and spring.stiffness else 0.0
    refusals = [
        f"{joint.where} must not mimic another joint" if joint.first("mimic") is not None else "",
        "" if kind in _KINDS else f"{joint.where} must be revolute, got type {shown(kind)}",
        driven.get(name, ""),
        why_not_free(joint, limits, dynamics.number("friction", "0"), rest),
    ]
    stiffness = joint.at_least_0("stiffness", spring.stiffness if spring else 0.0)
    return (
        ModelJoint(
            name,
            _KINDS.get(kind, kind),
            frame.rotation @ direction,
            frame.position,
            stiffness,
            next(filter(None, refusals), ""),
            joint.at_least_0("damping", dynamics.number("damping", "0")),
            place=spring.place if spring else None,
            rest=rest,
        ),
    )


def _matter(link: XmlElement) -> tuple[Inertial, list[Floats]]:
    extent: list[Floats] = []
    for part, shape in shapes_of(link):
        if shape.tag == "box":
            values = shape.numbers("size", 3)
        else:
            values = [shape.number(key) for key in ("radius", "length") if key in shape.attributes]
            values += [0.0] * (2 - len(values))
        extent += reach_of(shape.tag, values, _pose(part))
    given = link.first("inertial")
    if given is None:
        return joined([]), extent
    mass, inertia = given.first("mass"), given.first("inertia")
    if mass is None or inertia is None:
        given.refuse("must have <mass> and <inertia>")
    moments = [inertia.number(key, "0") for key in MOMENTS]
    own = Inertial.of(link.at_least_0("mass", mass.number("value")), moments)
    return own.seen_from(_pose(given)), extent


def _driven(root: XmlElement, joints: Mapping[str, XmlElement]) -> dict[str, str]:
    """Return the joints that a transmission of Drake's drives, and what to say of it."""
    found = {}
    for transmission in root.all("transmission"):
        for part in transmission.all("joint"):
            name = part.attributes.get("name", "")
            if name in joints:
                found[name] = why_driven(transmission, joints[name])
    return found


def _gazebo_springs(root: XmlElement) -> dict[str, PlacedSpring]:
    found = {}
    for element in root.all("gazebo"):
        spring = element.first("springStiffness")
        if spring is not None and "reference" in element.attributes:
            (stiffness,) = spring.read("springStiffness", spring.text, 1)
            place = SpringPlace("text", spring.start, spring.file)
            rest = element.first("springReference")
            relaxed = 0.0 if rest is None else rest.read("springReference", rest.text, 1)[0]
            found[element.attributes["reference"]] = PlacedSpring(stiffness, place, relaxed)
    return found


def _both_springs(
    gazebo: Mapping[str, PlacedSpring], beside: Mapping[str, PlacedSpring]
) -> dict[str, PlacedSpring]:
    found = {**gazebo, **beside}
    for name in sorted(gazebo.keys() & beside.keys()):
        one, other = gazebo[name].stiffness, beside[name].stiffness
        if one != other:
            raise BadModel(
                f"springs must be the same in both places, got {one:g} in <gazebo> and "
                f"{other:g} in the file beside for joint {shown(name)}"
            )
        if gazebo[name].rest != beside[name].rest:
            raise BadModel(f"springs must be relaxed at the same place in both files, of joint {shown(name)}")
        why = f"joint {shown(name)} has its spring both in <gazebo> and in the file beside"
        found[name] = replace(beside[name], place=replace(beside[name].place, refusal=why))
    return found


# The springs in a YAML file: only parsed into nodes, never turned into objects.

#: Larger files and more pieces of YAML (words, keys and brackets) are refused; a spring has 10.
_MAX_BYTES = 4 * 2**20
_MAX_EVENTS = 120_000
_MAX_DEPTH = 6


@dataclass(frozen=True)
class PlacedSpring:
    """The stiffness of a spring, where a file has it, and where it is relaxed [rad or m]."""

    stiffness: float
    place: SpringPlace
    rest: float = 0.0


def read_springs(path: Path) -> dict[str, PlacedSpring]:
    """Return the springs of a file as `export_chain` writes it beside a URDF file, by joint.

    The file may have been rewritten by any YAML tool: in blocks, in braces, quoted, in another order. Below
    `springs` stands a list of springs: `joint` and `stiffness`, and if they are given the `type`, hinge or
    slide, and the position at `rest` [rad or m]; `model` beside `springs` is a name. Anything else is
    refused by its line: a key twice, tags, anchors, aliases, a second document.
    """
    try:
        data = bounded_bytes(path)
        if len(data) > _MAX_BYTES:
            raise BadModel(f"must have at most {_MAX_BYTES // 2**20} MiB")
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadModel(f"{path.name} must be a text file in UTF-8") from None
    except BadModel as error:
        raise BadModel(f"{path.name} {error}") from None
    top = _YamlNode(path.name, _yaml_document(path.name, text))
    keys = top.keys("must have the key springs, with a list of springs", ("model", "springs"), {"springs"})
    if "model" in keys:
        keys["model"].text("model must be a name")
    found: dict[str, PlacedSpring] = {}
    for row in keys["springs"].items("springs must be a list of springs, [] if there are none"):
        name, stiffness, rest = _spring(row)
        if name in found:
            row.refuse(f"must not give joint {shown(name)} a second spring")
        place = SpringPlace("scalar", stiffness.node.start_mark.index, str(path.absolute()))
        found[name] = PlacedSpring(stiffness.number("stiffness"), place, rest)
    return found


def _spring(row: _YamlNode) -> tuple[str, _YamlNode, float]:
    wanted = "must be a spring with the keys joint and stiffness, and no other but type and rest"
    keys = row.keys(wanted, ("joint", "type", "stiffness", "rest"), {"joint", "stiffness"})
    if "type" in keys:
        keys["type"].one_of("type", keys["type"].text("type must be a word"), ("hinge", "slide"))
    rest = keys["rest"].number("rest") if "rest" in keys else 0.0
    return keys["joint"].text("joint must be a name"), keys["stiffness"], rest


class _YamlNode:
    """A piece of a file, which refuses what it is not."""

    def __init__(self, file: str, node: Any) -> None:
        self.file, self.node = file, node

    def refuse(self, why: str) -> NoReturn:
        raise BadModel(f"{self.file}, line {self.node.start_mark.line + 1}: {why}")

    def keys(self, wanted: str, allowed: tuple[str, ...], needed: set[str]) -> dict[str, _YamlNode]:
        """Return the values of a mapping by their keys."""
        if self.node.id != "mapping":
            self.refuse(wanted)
        found: dict[str, _YamlNode] = {}
        for key_node, value in self.node.value:
            key = _YamlNode(self.file, key_node)
            name = key.text("a key must be a word")
            if name in found:
                key.refuse(f"must not have the key {shown(name)} twice")
            found[name] = _YamlNode(self.file, value)
            found[name].one_of("key", name, allowed)
        if not needed <= found.keys():
            self.refuse(wanted)
        return found

    def one_of(self, name: str, value: str, allowed: tuple[str, ...]) -> None:
        try:
            choice(name, value, allowed)
        except ValueError as error:
            self.refuse(str(error))

    def items(self, wanted: str) -> Iterator[_YamlNode]:
        if self.node.id != "sequence":
            self.refuse(wanted)
        return (_YamlNode(self.file, item) for item in self.node.value)

    def text(self, wanted: str) -> str:
        if self.node.id != "scalar" or not self.node.value:
            self.refuse(wanted)
        return str(self.node.value)

    def number(self, name: str) -> float:
        if self.node.id != "scalar" or self.node.style:
            self.refuse(f"{name} must be a number, got {'text' if self.node.id == 'scalar' else 'none'}")
        return finite_number(f"{self.file}, line {self.node.start_mark.line + 1}: {name}", self.node.value)


def _yaml_document(file: str, text: str) -> Any:
    """Return the top node of the one document that there must be, within bounds."""
    import yaml

    # The parser written in C is there in most builds.
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    depth = documents = 0
    try:
        for count, event in enumerate(yaml.parse(text, Loader=loader), start=1):
            where = f"{file}, line {event.start_mark.line + 1}"
            kind = type(event).__name__
            depth += kind in ("SequenceStartEvent", "MappingStartEvent")
            depth -= kind in ("SequenceEndEvent", "MappingEndEvent")
            documents += kind == "DocumentStartEvent"
            odd = kind == "AliasEvent" or getattr(event, "anchor", None) is not None
            if odd or getattr(event, "tag", None) not in (None, "!"):
                raise BadModel(f"{where}: must have no anchors, aliases or tags")
            if depth > _MAX_DEPTH:
                raise BadModel(f"{where}: must not be nested more than {_MAX_DEPTH} deep")
            if count > _MAX_EVENTS:
                raise BadModel(f"{file} must have at most {_MAX_EVENTS} pieces")
            if documents > 1 or (kind == "StreamEndEvent" and not documents):
                raise BadModel(f"{where}: must be one document that is not empty")
        return yaml.compose(text, Loader=loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = "" if mark is None else f", line {mark.line + 1}"
        why = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
        raise BadModel(f"{file}{line}: must be YAML: {shown(why)}") from None
