"""SDFormat, as Gazebo and Drake read it: links and joints of one model."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from beammodes.auditing.body_tree import Inertial, Model, ModelBody, ModelJoint, Pose, from_rpy
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.read_urdf import (
    by_name,
    check_added,
    inertial_of,
    shape_ends,
    tree_order,
    why_driven,
    why_not_free,
)
from beammodes.checks import shown

__all__ = ["read_sdf"]

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "universal": "hinge"}


def read_sdf(root: XmlElement) -> Model:
    """Return the links and joints of an SDFormat file's model: the first with a spring, or with joints.

    Poses may be relative to any link, joint or frame of the model, axes expressed in any; before SDFormat 1.5
    axes are those of the model.

    Raises
    ------
    BadModel
        If it has no model, models in models, or links and joints that are no tree.
    """
    world = root.first("world")
    model, notes = _chosen_model(root, world)
    check_added(model)
    links, joints = by_name(model.all("link")), by_name(model.all("joint"))
    ends = [(_text(joint, "parent"), _text(joint, "child"), joint) for joint in joints.values()]
    frames = _Frames(model, links, joints, _is_old(root))
    static = _text(model, "static") in ("true", "1")
    bodies: list[ModelBody] = []
    index: dict[str, int] = {}
    for name, above, joint in tree_order(model, links, ends):
        place = frames.pose(name, links[name])
        own = tuple(_joint(joint, frames)) if joint is not None else ()
        if joint is None and not static:
            own = (ModelJoint(f"free motion of {name}", "free", np.zeros(3), place.position),)
        inertial, extent = _matter(links[name])
        index[name] = len(bodies)
        reach = tuple(place.point(point) for point in extent)
        parent = index.get(above, -1)
        bodies.append(ModelBody(name, parent, place.position, inertial.seen_from(place), reach, own))
    note = "gravity is left out here: with it the chain sags and rings at other frequencies"
    flat = world is None or not any(_numbers(world, "gravity", 3, "0 0 -9.81"))
    return Model(tuple(bodies), notes=tuple(notes if flat else [*notes, note]))


def _is_old(root: XmlElement) -> bool:
    """Whether axes are in the model's frame: before SDFormat 1.5."""
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
    springs = (_text(axis.first("dynamics") or axis, "spring_stiffness") for axis in axes)
    return any(text.strip("0.+- ") for text in springs)


class _Frames:
    """The poses in the model of its links, joints and frames, each found once."""

    def __init__(
        self, model: XmlElement, links: dict[str, XmlElement], joints: dict[str, XmlElement], old: bool
    ) -> None:
        self.old = old
        self.elements: dict[str, XmlElement] = {}
        # Of a link and a joint of one name, which old files may have, others mean the link.
        self.elements |= joints | by_name(model.all("frame")) | links
        self.found: dict[str, Pose] = {"": Pose.identity(), "__model__": Pose.identity()}

    def pose(self, name: str, asker: XmlElement) -> Pose:
        """Return the pose of a named frame in the model, without recursion: frames may be a long row."""
        row: list[str] = []
        at = name
        while at not in self.found:
            if at not in self.elements:
                asker.refuse(f"must be relative to a link, joint or frame of the model, got {shown(at)}")
            if len(row) > len(self.elements):
                asker.refuse(f"must not have a pose in a circle: {shown(name)} is relative to itself")
            row.append(at)
            at = self._base(self.elements[at])
        for each in reversed(row):
            element = self.elements[each]
            self.found[each] = self.found[self._base(element)] @ _pose(element)
        return self.found[name]

    def of_joint(self, joint: XmlElement) -> Pose:
        """Return a joint's own pose, which stands in its child link unless it says otherwise."""
        return self.pose(self._base(joint), joint) @ _pose(joint)

    def _base(self, element: XmlElement) -> str:
        pose = element.first("pose")
        said = "" if pose is None else pose.attributes.get("relative_to", "")
        if said:
            return said
        if element.tag == "frame":
            return element.attributes.get("attached_to", "")
        return _text(element, "child") if element.tag == "joint" else ""


def _text(element: XmlElement, tag: str) -> str:
    child = element.first(tag)
    return "" if child is None else child.text.strip()


def _numbers(element: XmlElement, tag: str, count: int, default: str) -> list[float]:
    child = element.first(tag)
    if child is None:
        return element.read(tag, default, count)
    return child.read(tag, child.text, count)


def _pose(element: XmlElement) -> Pose:
    pose = element.first("pose")
    if pose is None or not pose.text.strip():
        return Pose.identity()
    turn, values = 1.0, pose.read("pose", pose.text, 6)
    if pose.attributes.get("degrees") == "true":
        turn = np.pi / 180
    return Pose(from_rpy(*(turn * angle for angle in values[3:])), np.array(values[:3]))


def _pose_in_link(element: XmlElement) -> Pose:
    pose = element.first("pose")
    if pose is not None and pose.attributes.get("relative_to"):
        pose.refuse("must have no relative_to: what is in a link is placed in that link here")
    return _pose(element)


def _joint(joint: XmlElement, frames: _Frames) -> Iterator[ModelJoint]:
    kind = joint.attributes.get("type", "")
    if kind == "fixed":
        return
    name = joint.attributes.get("name", f"joint on line {joint.line}")
    place = frames.of_joint(joint)
    tags = ("axis", "axis2") if kind == "universal" else ("axis",)
    axes = [joint.first(tag) for tag in tags]
    for i, axis in enumerate(axes):
        if kind not in _KINDS or axis is None:
            why = f"{joint.where} must be revolute or universal with its axes, got type {shown(kind)}"
            yield ModelJoint(name, kind, np.zeros(3), place.position, refusal=why)
            return
        yield _about(joint, axis, f"{name} axis2" if i else name, kind, place, frames)


def _about(
    joint: XmlElement, axis: XmlElement, name: str, kind: str, place: Pose, frames: _Frames
) -> ModelJoint:
    along = axis.first("xyz")
    turned = place.rotation
    if frames.old or _text(axis, "use_parent_model_frame") in ("true", "1"):
        turned = np.eye(3)
    if along is not None and along.attributes.get("expressed_in"):
        turned = frames.pose(along.attributes["expressed_in"], along).rotation
    direction = np.array(_numbers(axis, "xyz", 3, "0 0 1"))
    size = float(np.linalg.norm(direction))
    if not size:
        joint.refuse("must have an axis that is not zero")
    dynamics = axis.first("dynamics") or axis
    (stiffness,) = _numbers(dynamics, "spring_stiffness", 1, "0")
    if stiffness < 0:
        joint.refuse(f"must have a stiffness of at least 0, got {stiffness:g}")
    bent = stiffness and any(_numbers(dynamics, "spring_reference", 1, "0"))
    refusal = f"{joint.where} must have spring_reference 0: straight at rest" if bent else ""
    refusal = refusal or why_driven(joint, joint) or _why_not_at_rest(joint, axis, dynamics)
    (damping,) = _numbers(dynamics, "damping", 1, "0")
    if damping < 0:
        joint.refuse(f"must have a damping of at least 0, got {damping:g}")
    return ModelJoint(
        name, _KINDS[kind], turned @ (direction / size), place.position, stiffness, refusal, damping
    )


def _why_not_at_rest(joint: XmlElement, axis: XmlElement, dynamics: XmlElement) -> str:
    if axis.first("mimic") is not None:
        return f"{joint.where} must not mimic another joint"
    limit = axis.first("limit")
    limits = None
    if limit is not None:
        limits = (_limit(limit, "lower", -math.inf), _limit(limit, "upper", math.inf))
    return why_not_free(joint, limits, _numbers(dynamics, "friction", 1, "0")[0])


def _limit(limit: XmlElement, tag: str, unlimited: float) -> float:
    # The one place where SDFormat writes infinite numbers.
    text = _text(limit, tag).lower().lstrip("+-")
    if text in ("", "inf", "infinity") or _is_huge(text):
        return unlimited
    return _numbers(limit, tag, 1, "0")[0]


def _is_huge(text: str) -> bool:
    """Whether a number means no limit, as SDFormat has it from 1e16 on; Gazebo writes the largest double."""
    try:
        return abs(float(text[:100])) >= 1e16
    except ValueError:
        return False


def _matter(link: XmlElement) -> tuple[Inertial, list[np.ndarray]]:
    extent = []
    for shape in link.all("visual", "collision"):
        place, geometry = _pose_in_link(shape), shape.first("geometry")
        for solid in () if geometry is None else geometry.all("box", "cylinder", "capsule", "sphere"):
            if solid.tag == "box":
                values = _numbers(solid, "size", 3, "1 1 1")
            else:
                values = [_numbers(solid, key, 1, "0")[0] for key in ("radius", "length")]
            extent += [place.point(point) for point in shape_ends(solid.tag, values)]
    given = link.first("inertial")
    if given is not None and given.attributes.get("auto") in ("true", "1"):
        given.refuse("must say mass and inertia: auto is not worked out here")
    for added in () if given is None else given.all("fluid_added_mass"):
        added.refuse("must be left out: the audit's beam is in no fluid")
    # SDFormat's own default is a unit of mass and inertia.
    unit = XmlElement("inertial", {}, link.line) if given is None else given
    (mass,) = _numbers(unit, "mass", 1, "1")
    matrix = unit.first("inertia") or unit
    defaults = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}
    values_of = {key: _numbers(matrix, key, 1, default)[0] for key, default in defaults.items()}
    return inertial_of(link, _pose_in_link(unit), values_of | {"mass": mass}), extent
