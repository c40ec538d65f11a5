"""URDF, the robot description of ROS, and the springs that stand beside it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from beammodes.auditing.body_tree import Inertial, Model, ModelBody, ModelJoint, Pose, ends_of, from_rpy
from beammodes.auditing.bounded_xml import BadModel, XmlElement, bounded_bytes, finite_number
from beammodes.checks import choice, shown

__all__ = [
    "by_name",
    "check_added",
    "inertial_of",
    "read_springs",
    "read_urdf",
    "shape_ends",
    "tree_order",
    "why_driven",
    "why_not_free",
]


# What URDF and SDFormat files hold that a chain must not have: stops at rest, friction, rotors.

#: Drake's own elements that hold bodies together outside the tree of joints.
_ADDED = ("drake:linear_bushing_rpy", "drake:ball_constraint", "drake:joint")


_DRIVEN = {"drake:rotor_inertia": "inertia", "drake:controller_gains": "a servo"}


def by_name(elements: Iterable[XmlElement]) -> dict[str, XmlElement]:
    """Return elements by name.

    Raises
    ------
    BadModel
        If one has no name, or that of another.
    """
    found: dict[str, XmlElement] = {}
    for element in elements:
        name = element.attributes.get("name") or element.refuse("must have a name")
        if name in found:
            element.refuse(f"must have a name of its own, got {shown(name)} for a second time")
        found[name] = element
    return found


def check_added(model: XmlElement) -> None:
    """Raise BadModel if xacro has left something to do, or bushings hold a model's bodies."""
    for element in model.children:
        if element.tag.startswith("xacro:"):
            element.refuse("must have been expanded by xacro")
        if element.tag in _ADDED:
            element.refuse("must be left out: only joints of a tree are read")


def why_not_free(joint: XmlElement, limits: tuple[float, float] | None, friction: float) -> str:
    """Return why a joint does not swing freely about 0, empty if it does."""
    if friction:
        return f"{joint.where} must have no friction: dry friction holds a hinge still"
    if limits is not None and not limits[0] < 0 < limits[1]:
        return f"{joint.where} must be at rest within its limits, not at a stop or beyond"
    return ""


def why_driven(parent: XmlElement, joint: XmlElement) -> str:
    """Return why a joint is no plain hinge by Drake's elements below `parent`, empty if it is."""
    for element in _below(parent):
        given = [element.text, element.attributes.get("value", ""), element.attributes.get("p", "")]
        if element.tag in _DRIVEN and any(text.strip().strip("0.") for text in given):
            what = _DRIVEN[element.tag]
            return f"{joint.where} must have no <{element.tag}>, which is {what} that no beam has"
    return ""


def _below(element: XmlElement) -> Iterator[XmlElement]:
    for child in element.children:
        yield child
        yield from child.children


_KINDS = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "floating": "free",
    "fixed": "fixed",
}


_HINGES = ("revolute", "continuous")


_NONE = np.zeros(3)


def read_urdf(root: XmlElement, springs: Mapping[str, float]) -> Model:
    """Return the links and joints of a URDF robot, its root link fixed to the ground.

    Springs, for which URDF has no place, are those given, and the `springStiffness` of Gazebo's extension.

    Raises
    ------
    BadModel
        If links and joints are no tree, or an element is not as URDF wants it.
    """
    check_added(root)
    links, joints = by_name(root.all("link")), by_name(root.all("joint"))
    springs = _both_springs(_gazebo_springs(root), springs)
    unknown = springs.keys() - joints.keys()
    if unknown:
        raise BadModel(f"springs must name joints of the URDF file, got {shown(sorted(unknown)[0])}")
    driven = _driven(root, joints)
    ends = [(_end(joint, "parent"), _end(joint, "child"), joint) for joint in joints.values()]
    poses, index = {"world": Pose.identity()}, {}
    bodies: list[ModelBody] = []
    for name, above, joint in tree_order(root, links, ends):
        place = Pose.identity()
        own: tuple[ModelJoint, ...] = ()
        if joint is not None:
            place = poses[above] @ _pose(joint)
            own = tuple(_joint(joint, place, springs, driven))
        poses[name] = place
        inertial, extent = _matter(links[name])
        index[name] = len(bodies)
        reach = tuple(place.point(point) for point in extent)
        parent = index.get(above, -1)
        bodies.append(ModelBody(name, parent, place.position, inertial.seen_from(place), reach, own))
    notes = (
        () if "world" in links else (f"root link {shown(bodies[0].name)} is taken as fixed to the ground",)
    )
    hint = ""
    if not springs:
        first = next((name for name, joint in joints.items() if joint.attributes.get("type") in _HINGES), "")
        hint = (
            "URDF has no springs: give a file with them by springs= (--springs), or beside the model as "
            f"NAME.springs.yaml, with a row such as {{joint: {first or 'NAME'}, stiffness: 10.0}} a hinge"
        )
    return Model(tuple(bodies), notes=notes, hint=hint)


def tree_order(
    root: XmlElement, links: Mapping[str, XmlElement], ends: list[tuple[str, str, XmlElement]]
) -> Iterator[tuple[str, str, XmlElement | None]]:
    """Yield each link, parents first, with its parent and the joint between; roots have none.

    Raises
    ------
    BadModel
        If a joint names no link, a link has two parents, or links form a loop.
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
    count = 0
    while waiting:
        name, above, own = waiting.pop()
        count += 1
        yield name, above, own
        waiting += [(child, name, joint) for child, joint in below[name][::-1]]
    if count < len(links) or not count:
        root.refuse("must have links in a tree, got none or a loop")


def inertial_of(link: XmlElement, place: Pose, values: Mapping[str, float]) -> Inertial:
    """Return the inertial that a link gives, its frame at `place` in the link's."""
    if values["mass"] < 0:
        link.refuse(f"must have a mass of at least 0, got {values['mass']:g}")
    xx, yy, zz, xy, xz, yz = (values[key] for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(values["mass"], _NONE, matrix).seen_from(place)


def shape_ends(kind: str, values: list[float]) -> list[np.ndarray]:
    """Return how far a shape reaches: full lengths of a box; radius and length of others."""
    if kind in ("cylinder", "capsule"):
        return ends_of(kind, [values[0], values[1] / 2])
    return ends_of(kind, [value / 2 for value in values] if kind == "box" else values)


def _end(joint: XmlElement, which: str) -> str:
    end = joint.first(which)
    return "" if end is None else end.attributes.get("link", "")


def _pose(element: XmlElement) -> Pose:
    origin = element.first("origin")
    if origin is None:
        return Pose.identity()
    turned = from_rpy(*origin.numbers("rpy", 3, "0 0 0"))
    return Pose(turned, np.array(origin.numbers("xyz", 3, "0 0 0")))


def _joint(
    joint: XmlElement, place: Pose, springs: Mapping[str, float], driven: Mapping[str, str]
) -> Iterator[ModelJoint]:
    kind = joint.attributes.get("type", "")
    if kind == "fixed":
        return
    axis = joint.first("axis")
    along = np.array([1.0, 0, 0] if axis is None else axis.numbers("xyz", 3))
    size = float(np.linalg.norm(along))
    if not size:
        joint.refuse("must have an axis that is not zero")
    refusal = "" if kind in _KINDS else f"{joint.where} must be revolute, got type {shown(kind)}"
    if joint.first("mimic") is not None:
        refusal = f"{joint.where} must not mimic another joint"
    name = joint.attributes["name"]
    refusal = refusal or driven.get(name, "") or _why_not_at_rest(joint, kind)
    stiffness = springs.get(name, 0.0)
    if stiffness < 0:
        joint.refuse(f"must have a stiffness of at least 0, got {stiffness:g}")
    own = place.rotation @ (along / size)
    dynamics = joint.first("dynamics")
    (damping,) = [0.0] if dynamics is None else dynamics.numbers("damping", 1, "0")
    if damping < 0:
        joint.refuse(f"must have a damping of at least 0, got {damping:g}")
    yield ModelJoint(name, _KINDS.get(kind, kind), own, place.position, stiffness, refusal, damping)


def _matter(link: XmlElement) -> tuple[Inertial, list[np.ndarray]]:
    extent = []
    for shape in link.all("visual", "collision"):
        place, geometry = _pose(shape), shape.first("geometry")
        for solid in () if geometry is None else geometry.all("box", "cylinder", "capsule", "sphere"):
            if solid.tag == "box":
                values = solid.numbers("size", 3)
            else:
                values = [solid.numbers(key, 1)[0] for key in ("radius", "length") if key in solid.attributes]
                values += [0.0] * (2 - len(values))
            extent += [place.point(point) for point in shape_ends(solid.tag, values)]
    given = link.first("inertial")
    if given is None:
        return Inertial(0.0, _NONE, np.zeros((3, 3))), extent
    mass, inertia = given.first("mass"), given.first("inertia")
    if mass is None or inertia is None:
        given.refuse("must have <mass> and <inertia>")
    values_of = {key: inertia.numbers(key, 1, "0")[0] for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
    return inertial_of(link, _pose(given), values_of | {"mass": mass.numbers("value", 1)[0]}), extent


def _why_not_at_rest(joint: XmlElement, kind: str) -> str:
    limit, dynamics = joint.first("limit"), joint.first("dynamics")
    (friction,) = [0.0] if dynamics is None else dynamics.numbers("friction", 1, "0")
    limits = None
    if limit is not None and kind in ("revolute", "prismatic"):
        limits = (limit.numbers("lower", 1, "0")[0], limit.numbers("upper", 1, "0")[0])
    return why_not_free(joint, limits, friction)


def _driven(root: XmlElement, joints: Mapping[str, XmlElement]) -> dict[str, str]:
    """Return the joints that a transmission of Drake's drives, and what to say of it."""
    found = {}
    for transmission in root.all("transmission"):
        for part in transmission.all("joint"):
            name = part.attributes.get("name", "")
            if name in joints:
                found[name] = why_driven(transmission, joints[name])
    return found


def _gazebo_springs(root: XmlElement) -> dict[str, float]:
    found = {}
    for element in root.all("gazebo"):
        spring, rest = element.first("springStiffness"), element.first("springReference")
        if spring is not None and "reference" in element.attributes:
            found[element.attributes["reference"]] = spring.read("springStiffness", spring.text, 1)[0]
            if rest is not None and rest.read("springReference", rest.text, 1)[0]:
                rest.refuse("must be 0: the chain must be straight at rest")
    return found


def _both_springs(gazebo: Mapping[str, float], beside: Mapping[str, float]) -> dict[str, float]:
    for name in sorted(gazebo.keys() & beside.keys()):
        if gazebo[name] != beside[name]:
            raise BadModel(
                f"springs must be the same in both places, got {gazebo[name]:g} in <gazebo> and "
                f"{beside[name]:g} in the file beside for joint {shown(name)}"
            )
    return {**gazebo, **beside}


# The springs of a URDF file, which stand in a YAML file beside it.

#: Larger files and more pieces of YAML (words, keys and brackets) are refused; a spring has 10.
_MAX_BYTES = 4 * 2**20


_MAX_EVENTS = 120_000


_MAX_DEPTH = 6


_TOP = ("model", "springs")


_ROW = ("joint", "type", "stiffness", "rest")


_KINDS_urdf_springs = ("hinge", "slide")


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
            choice("type", keys["type"].text("type must be a word"), _KINDS_urdf_springs)
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
