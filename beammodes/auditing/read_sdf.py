"""SDFormat, as Gazebo and Drake read it: links and joints of models, and of models in models."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from beammodes.auditing.body_tree import (
    Frame,
    Inertial,
    Model,
    ModelBody,
    ModelJoint,
    SpringPlace,
    from_quaternion,
)
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.read_urdf import (
    MOMENTS,
    by_name,
    check_added,
    limit_number,
    links_of,
    reach_of,
    shapes_of,
    why_driven,
    why_not_free,
)
from beammodes.checks import shown
from beammodes.numerics.arrays import Floats

__all__ = ["read_sdf"]

#: Joints of two axes at one place, the second turned by the first.
_TWO_AXES = ("universal", "revolute2")
_KINDS = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    **dict.fromkeys(_TWO_AXES, "hinge"),
}


#: Models may stand in models so deep.
_DEEPEST = 20


def read_sdf(root: XmlElement) -> Model:
    """Return the links and joints of an SDFormat file's models: all with springs, and what is joined to them.

    Without any spring, the first model with joints. Models may stand within models; poses may be relative to
    any link, joint, frame or model, axes expressed in any; before SDFormat 1.5 axes are those of the model.
    Links and joints keep their names where these are unique; else their models' names stand before them.
    """
    world = root.first("world")
    top = _Scope(root if world is None else world, None, _is_old(root))
    if not top.models:
        root.refuse("must have a <model>")
    read, notes = _chosen_models(top)
    scopes = [inner for name in read for inner in top.models[name].all()]
    names = _told_apart([(scope, name) for scope in scopes for name in scope.links])
    owners = {own: scope for (scope, _), own in names.items()}
    links = {own: scope.links[name] for (scope, name), own in names.items()}
    joints = _told_apart([(scope, name) for scope in (top, *scopes) for name in scope.joints])
    homes = {id(scope.joints[name]): (scope, own) for (scope, name), own in joints.items()}
    ends: list[tuple[str, str, XmlElement]] = []
    for scope, name in joints:
        joint = scope.joints[name]
        parent, child = (scope.link(joint.child_text(tag), names) for tag in ("parent", "child"))
        ends.append((parent, child, joint))
    bodies: list[ModelBody] = []
    for name, _, above, own_joint in links_of(root, links, ends):
        scope, element = owners[name], links[name]
        frame = scope.at @ scope.named(element.attributes["name"], element)
        own = () if own_joint is None else tuple(_joint(own_joint, *homes[id(own_joint)]))
        if own_joint is None and not scope.is_static:
            own = (ModelJoint(f"free motion of {name}", "free", np.zeros(3), frame.position),)
        inertial, extent = _matter(element)
        bodies.append(ModelBody(name, above, inertial, extent, own).placed(frame))
    sprung = any(joint.stiffness for body in bodies for joint in body.joints)
    still = [shown(name) for name in read if top.models[name].is_static]
    if sprung and still:
        notes.append(f"<static> keeps model {', '.join(still)} from moving: it is judged as without it")
    hint = "SDFormat has a spring as <spring_stiffness> in the <dynamics> of a joint's <axis>"
    gravity = np.zeros(3) if world is None else np.array(_gravity(world))
    return Model(tuple(bodies), notes=tuple(notes), gravity=gravity, hint="" if sprung else hint)


def _gravity(world: XmlElement) -> list[float]:
    """Return a world's gravity, which stood in <physics> before SDFormat 1.6."""
    physics = world.first("physics")
    place = world if physics is None or world.first("gravity") is not None else physics
    return place.child_numbers("gravity", 3, "0 0 -9.81")


def _is_old(root: XmlElement) -> bool:
    """Return True if axes are in the model's frame: before SDFormat 1.5."""
    version = root.attributes.get("version", "").split(".")
    return version[0] == "1" and version[1:2] != [] and version[1] in ("0", "1", "2", "3", "4")


def _chosen_models(top: _Scope) -> tuple[list[str], list[str]]:
    """Return the names of the models to read, and notes on what stands beside them."""
    ends = [joint.child_text(tag) for joint in top.joints.values() for tag in ("parent", "child")]
    joined = {end.split("::")[0] for end in ends}
    sprung = [name for name, scope in top.models.items() if name in joined or scope.has_spring]
    jointed = [name for name, scope in top.models.items() if any(inner.joints for inner in scope.all())]
    read = sprung or (jointed or list(top.models))[:1]
    others = [shown(name) for name in top.models if name not in read]
    notes = [f"other models are left out here: {', '.join(others[:5])}"] if others else []
    included = [shown(each.child_text("uri")) for each in top.element.all("include")]
    return read, [
        *notes,
        *([f"included models are left out here: {', '.join(included[:5])}"] if included else []),
    ]


def _told_apart(found: list[tuple[_Scope, str]]) -> dict[tuple[_Scope, str], str]:
    """Return what links or joints are called: with their models' names where others have the same name."""
    count = Counter(name for _, name in found)
    return {(scope, name): name if count[name] == 1 else scope.prefix + name for scope, name in found}


class _Scope:
    """A model, or the world around models: its links, joints, frames and inner models by name."""

    def __init__(
        self, element: XmlElement, outer: _Scope | None, old: bool, depth: int = 0, name: str = ""
    ) -> None:
        if depth > _DEEPEST:
            element.refuse(f"must be nested in at most {_DEEPEST} models")
        self.element, self.outer, self.old = element, outer, old
        self.name = name
        self.prefix: str = "" if outer is None else f"{outer.prefix}{name}::"
        self.links = {} if outer is None else by_name(element.all("link"))
        self.joints = by_name(element.all("joint"))
        inner: dict[str, XmlElement] = {}
        for i, each in enumerate(element.all("model"), start=1):
            name = each.attributes.get("name", "")
            inner[name if name and name not in inner else f"model {i}"] = each
        self.models = {name: _Scope(each, self, old, depth + 1, name) for name, each in inner.items()}
        # Of a link and a joint of one name, which old files may have, others mean the link.
        self.elements = self.joints | by_name(element.all("frame")) | inner | self.links
        ground = ("", "__model__") if outer is not None else ("", "world", "__root__")
        self.known = dict.fromkeys(ground, Frame())

    def all(self) -> list[_Scope]:
        """Return this model and all that stand in it; refuse what is not read."""
        check_added(self.element)
        for odd in self.element.all("include"):
            odd.refuse("must be left out: only links and joints of the file itself are read")
        return [self, *(deeper for inner in self.models.values() for deeper in inner.all())]

    @cached_property
    def has_spring(self) -> bool:
        """True if a joint of this model or of one in it has a spring."""
        axes = (axis for joint in self.joints.values() for axis in joint.all("axis", "axis2"))
        springs = ((axis.first("dynamics") or axis).child_text("spring_stiffness") for axis in axes)
        own = any(text.strip("0.+- ") for text in springs)
        return own or any(inner.has_spring for inner in self.models.values())

    @cached_property
    def is_static(self) -> bool:
        """True if this model or one around it is held by the ground."""
        around = self.outer is not None and self.outer.is_static
        return around or self.element.child_text("static") in ("true", "1")

    @cached_property
    def at(self) -> Frame:
        """Where this model's frame is in the world."""
        return Frame() if self.outer is None else self.outer.at @ self.outer.named(self.name, self.element)

    def named(self, name: str, asker: XmlElement) -> Frame:
        """Return a named frame in this one, without recursion: frames may be a long row."""
        row: list[str] = []
        inside = set[str]()
        at = name
        while at not in self.known:
            if at in inside:
                asker.refuse(f"must not have a pose in a circle: {shown(name)} is relative to itself")
            row.append(at)
            inside.add(at)
            at = self._base(at, asker)
        for each in reversed(row):
            self.known[each] = self.known[self._base(each, asker)] @ self._step(each, asker)
        return self.known[name]

    def of_joint(self, joint: XmlElement) -> Frame:
        """Return a joint's own frame, which stands in its child link unless it says otherwise."""
        return self.named(_relative_to(joint), joint) @ _pose(joint)

    def link(self, name: str, names: Mapping[tuple[_Scope, str], str]) -> str:
        """Return what the link of a name is called, or the one that a frame, joint or model is fixed to."""
        scope, at, seen = self, name, set[tuple[_Scope, str]]()
        while (scope, at) not in names and (scope, at) not in seen:
            seen.add((scope, at))
            head, _, rest = at.partition("::")
            element = scope.elements.get(head)
            if head in scope.models:
                scope, at = scope.models[head], rest or _canonical(scope.elements[head])
            elif element is None:
                break
            else:
                at = element.attributes.get("attached_to", "") if element.tag == "frame" else at
                at = element.child_text("child") if element.tag == "joint" else at
                at = at or _canonical(scope.element)
        return names.get((scope, at), name)

    def _base(self, name: str, asker: XmlElement) -> str:
        """Return the name of the frame that a named one is given in."""
        head, _, rest = name.partition("::")
        if rest and head in self.models:
            return head
        if name not in self.elements:
            asker.refuse(f"must be relative to a link, joint or frame of the model, got {shown(name)}")
        return _relative_to(self.elements[name])

    def _step(self, name: str, asker: XmlElement) -> Frame:
        """Return a named frame in the one that it is given in."""
        head, _, rest = name.partition("::")
        if rest and head in self.models:
            return self.models[head].named(rest, asker)
        element = self.elements[name]
        placed = element.attributes.get("placement_frame", "") if element.tag == "model" else ""
        own = _pose(element)
        return own @ self.models[name].named(placed, element).inverse if placed else own


def _canonical(model: XmlElement) -> str:
    first = model.first("link")
    own = "" if first is None else first.attributes.get("name", "")
    return model.attributes.get("canonical_link", "") or own


def _relative_to(element: XmlElement) -> str:
    pose = element.first("pose")
    said = "" if pose is None else pose.attributes.get("relative_to", "")
    if not said and element.tag == "frame":
        return element.attributes.get("attached_to", "")
    return said or (element.child_text("child") if element.tag == "joint" else "")


def _pose(element: XmlElement) -> Frame:
    pose = element.first("pose")
    if pose is None or not pose.text.strip():
        return Frame()
    if pose.attributes.get("rotation_format") == "quat_xyzw":
        x, y, z, *turn = pose.read("pose", pose.text, 7)
        qx, qy, qz, qw = pose.direction(turn, "quaternion").tolist()
        return Frame(from_quaternion(qw, qx, qy, qz), np.array([x, y, z]))
    values = pose.read("pose", pose.text, 6)
    unit = np.pi / 180 if pose.attributes.get("degrees") == "true" else 1.0
    return Frame.by_angles(values[:3], unit * np.array(values[3:]))


def _pose_in_link(element: XmlElement) -> Frame:
    pose = element.first("pose")
    if pose is not None and pose.attributes.get("relative_to"):
        pose.refuse("must have no relative_to: what is in a link is placed in that link here")
    return _pose(element)


def _joint(joint: XmlElement, scope: _Scope, name: str) -> Iterator[ModelJoint]:
    kind = joint.attributes.get("type", "")
    if kind == "fixed":
        return
    frame = scope.at @ scope.of_joint(joint)
    for i, tag in enumerate(("axis", "axis2") if kind in _TWO_AXES else ("axis",)):
        axis = joint.first(tag)
        if kind not in _KINDS or axis is None:
            why = f"{joint.where} must be revolute or universal with its axes, got type {shown(kind)}"
            yield ModelJoint(name, kind, np.zeros(3), frame.position, refusal=why)
            return
        yield _coordinate(joint, axis, f"{name} axis2" if i else name, frame, scope)


def _coordinate(joint: XmlElement, axis: XmlElement, name: str, frame: Frame, scope: _Scope) -> ModelJoint:
    along = axis.first("xyz")
    turned = frame.rotation
    if scope.old or axis.child_text("use_parent_model_frame") in ("true", "1"):
        turned = scope.at.rotation
    if along is not None and along.attributes.get("expressed_in"):
        turned = (scope.at @ scope.named(along.attributes["expressed_in"], along)).rotation
    direction = joint.direction(axis.child_numbers("xyz", 3, "0 0 1"))
    dynamics = axis.first("dynamics") or axis
    stiffness, rest, friction, damping = (
        dynamics.child_numbers(tag, 1, "0")[0]
        for tag in ("spring_stiffness", "spring_reference", "friction", "damping")
    )
    joint.at_least_0("stiffness", stiffness)
    joint.at_least_0("damping", damping)
    relaxed = rest if stiffness else 0.0
    limit = axis.first("limit")
    limits = None
    if limit is not None:
        limits = (
            limit_number(limit, "lower", limit.child_text("lower"), -math.inf),
            limit_number(limit, "upper", limit.child_text("upper"), math.inf),
        )
    refusals = [
        why_driven(joint, joint),
        f"{joint.where} must not mimic another joint" if axis.first("mimic") is not None else "",
        why_not_free(joint, limits, friction, relaxed),
    ]
    refusal = next(filter(None, refusals), "")
    kind = _KINDS[joint.attributes["type"]]
    spring = dynamics.first("spring_stiffness")
    place = None if spring is None else SpringPlace("text", spring.start, spring.file)
    at = frame.position
    along_axis = turned @ direction
    return ModelJoint(name, kind, along_axis, at, stiffness, refusal, damping, place=place, rest=relaxed)


def _matter(link: XmlElement) -> tuple[Inertial, list[Floats]]:
    extent: list[Floats] = []
    for part, shape in shapes_of(link):
        if shape.tag == "box":
            values = shape.child_numbers("size", 3, "1 1 1")
        else:
            values = [shape.child_numbers(key, 1, "0")[0] for key in ("radius", "length")]
        extent += reach_of(shape.tag, values, _pose_in_link(part))
    # SDFormat's own default is a unit of mass and inertia.
    given = link.first("inertial") or XmlElement("inertial", {}, link.line)
    if given.attributes.get("auto") in ("true", "1"):
        given.refuse("must say mass and inertia: auto is not worked out here")
    for added in given.all("fluid_added_mass"):
        added.refuse("must be left out: the audit's beam is in no fluid")
    (mass,) = given.child_numbers("mass", 1, "1")
    matrix = given.first("inertia") or given
    moments = [matrix.child_numbers(key, 1, "1" if key[1] == key[2] else "0")[0] for key in MOMENTS]
    own = Inertial.of(link.at_least_0("mass", mass), moments)
    return own.seen_from(_pose_in_link(given)), extent
