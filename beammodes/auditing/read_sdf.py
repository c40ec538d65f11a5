"""SDFormat, as Gazebo and Drake read it: links and joints of one model."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from beammodes.auditing.body_tree import Frame, Inertial, Model, ModelBody, ModelJoint, SpringPlace
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

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "universal": "hinge"}


def read_sdf(root: XmlElement) -> Model:
    """Return the links and joints of an SDFormat file's model: the first with a spring, or with joints.

    Poses may be relative to any link, joint or frame of the model, axes expressed in any; before SDFormat 1.5
    axes are those of the model.
    """
    world = root.first("world")
    model, notes = _chosen_model(root, world)
    check_added(model)
    links, joints = by_name(model.all("link")), by_name(model.all("joint"))
    ends = [(each.child_text("parent"), each.child_text("child"), each) for each in joints.values()]
    frames = _Frames(model, links, joints, _is_old(root))
    static = model.child_text("static") in ("true", "1")
    bodies: list[ModelBody] = []
    for name, _, parent, joint in links_of(model, links, ends):
        frame = frames.named(name, links[name])
        own = () if joint is None else tuple(_joint(joint, frames))
        if joint is None and not static:
            own = (ModelJoint(f"free motion of {name}", "free", np.zeros(3), frame.position),)
        inertial, extent = _matter(links[name])
        bodies.append(ModelBody(name, parent, inertial, extent, own).placed(frame))
    if world is not None and any(world.child_numbers("gravity", 3, "0 0 -9.81")):
        notes.append("gravity is left out here: with it the chain sags and rings at other frequencies")
    return Model(tuple(bodies), notes=tuple(notes))


def _is_old(root: XmlElement) -> bool:
    """Return True if axes are in the model's frame: before SDFormat 1.5."""
    version = root.attributes.get("version", "").split(".")
    return version[0] == "1" and version[1:2] != [] and version[1] in ("0", "1", "2", "3", "4")


def _chosen_model(root: XmlElement, world: XmlElement | None) -> tuple[XmlElement, list[str]]:
    """Return the model to read, and a note on what stands beside it."""
    models = list((root if world is None else world).all("model"))
    if not models:
        root.refuse("must have a <model>")
    jointed = [each for each in models if each.first("joint")]
    model = next((each for each in jointed if _has_spring(each)), (jointed or models)[0])
    for odd in model.all("include", "model"):
        odd.refuse("must be left out: only links and joints of one model are read")
    for odd in () if world is None else world.all("joint"):
        odd.refuse("must be left out: only joints inside one model are read")
    others = [shown(each.attributes.get("name", "")) for each in models if each is not model]
    return model, [f"other models are left out here: {', '.join(others[:5])}"] if others else []


def _has_spring(model: XmlElement) -> bool:
    axes = (axis for joint in model.all("joint") for axis in joint.all("axis", "axis2"))
    springs = ((axis.first("dynamics") or axis).child_text("spring_stiffness") for axis in axes)
    return any(text.strip("0.+- ") for text in springs)


class _Frames:
    """The frames in the model of its links, joints and frames, each worked out once."""

    def __init__(
        self, model: XmlElement, links: dict[str, XmlElement], joints: dict[str, XmlElement], old: bool
    ) -> None:
        self.old = old
        # Of a link and a joint of one name, which old files may have, others mean the link.
        self.elements = joints | by_name(model.all("frame")) | links
        self.known = {"": Frame(), "__model__": Frame()}

    def named(self, name: str, asker: XmlElement) -> Frame:
        """Return a named frame in the model, without recursion: frames may be a long row."""
        row: list[str] = []
        at = name
        while at not in self.known:
            if at not in self.elements:
                asker.refuse(f"must be relative to a link, joint or frame of the model, got {shown(at)}")
            if len(row) > len(self.elements):
                asker.refuse(f"must not have a pose in a circle: {shown(name)} is relative to itself")
            row.append(at)
            at = self._base(self.elements[at])
        for each in reversed(row):
            element = self.elements[each]
            self.known[each] = self.known[self._base(element)] @ _pose(element)
        return self.known[name]

    def of_joint(self, joint: XmlElement) -> Frame:
        """Return a joint's own frame, which stands in its child link unless it says otherwise."""
        return self.named(self._base(joint), joint) @ _pose(joint)

    def _base(self, element: XmlElement) -> str:
        pose = element.first("pose")
        said = "" if pose is None else pose.attributes.get("relative_to", "")
        if not said and element.tag == "frame":
            return element.attributes.get("attached_to", "")
        return said or (element.child_text("child") if element.tag == "joint" else "")


def _pose(element: XmlElement) -> Frame:
    pose = element.first("pose")
    if pose is None or not pose.text.strip():
        return Frame()
    values = pose.read("pose", pose.text, 6)
    unit = np.pi / 180 if pose.attributes.get("degrees") == "true" else 1.0
    return Frame.by_angles(values[:3], unit * np.array(values[3:]))


def _pose_in_link(element: XmlElement) -> Frame:
    pose = element.first("pose")
    if pose is not None and pose.attributes.get("relative_to"):
        pose.refuse("must have no relative_to: what is in a link is placed in that link here")
    return _pose(element)


def _joint(joint: XmlElement, frames: _Frames) -> Iterator[ModelJoint]:
    kind = joint.attributes.get("type", "")
    if kind == "fixed":
        return
    name = joint.attributes["name"]
    frame = frames.of_joint(joint)
    for i, tag in enumerate(("axis", "axis2") if kind == "universal" else ("axis",)):
        axis = joint.first(tag)
        if kind not in _KINDS or axis is None:
            why = f"{joint.where} must be revolute or universal with its axes, got type {shown(kind)}"
            yield ModelJoint(name, kind, np.zeros(3), frame.position, refusal=why)
            return
        yield _coordinate(joint, axis, f"{name} axis2" if i else name, frame, frames)


def _coordinate(joint: XmlElement, axis: XmlElement, name: str, frame: Frame, frames: _Frames) -> ModelJoint:
    along = axis.first("xyz")
    turned = frame.rotation
    if frames.old or axis.child_text("use_parent_model_frame") in ("true", "1"):
        turned = np.eye(3)
    if along is not None and along.attributes.get("expressed_in"):
        turned = frames.named(along.attributes["expressed_in"], along).rotation
    direction = joint.direction(axis.child_numbers("xyz", 3, "0 0 1"))
    dynamics = axis.first("dynamics") or axis
    stiffness, rest, friction, damping = (
        dynamics.child_numbers(tag, 1, "0")[0]
        for tag in ("spring_stiffness", "spring_reference", "friction", "damping")
    )
    joint.at_least_0("stiffness", stiffness)
    joint.at_least_0("damping", damping)
    limit = axis.first("limit")
    limits = None
    if limit is not None:
        limits = (
            limit_number(limit, "lower", limit.child_text("lower"), -math.inf),
            limit_number(limit, "upper", limit.child_text("upper"), math.inf),
        )
    refusals = [
        f"{joint.where} must have spring_reference 0: straight at rest" if stiffness and rest else "",
        why_driven(joint, joint),
        f"{joint.where} must not mimic another joint" if axis.first("mimic") is not None else "",
        why_not_free(joint, limits, friction),
    ]
    refusal = next(filter(None, refusals), "")
    kind = _KINDS[joint.attributes["type"]]
    spring = dynamics.first("spring_stiffness")
    place = None if spring is None else SpringPlace("text", spring.start, spring.file)
    at = frame.position
    return ModelJoint(name, kind, turned @ direction, at, stiffness, refusal, damping, place=place)


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
