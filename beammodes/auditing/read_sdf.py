"""SDFormat, as Gazebo and Drake read it: links and joints of one model."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.read_urdf import inertial_of, shape_ends, tree_order
from beammodes.auditing.robot_extras import by_name, check_added, why_driven, why_not_free
from beammodes.auditing.spatial import Inertial, Pose, from_rpy
from beammodes.checks import shown

__all__ = ["read_sdf"]

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}


def read_sdf(root: XmlElement) -> Model:
    """Return the links and joints of an SDFormat file's first model that has joints.

    Raises
    ------
    BadModel
        If it has no model, frames of its own, or links and joints that are no tree.
    """
    world = root.first("world")
    model, notes = _chosen_model(root, world)
    check_added(model)
    links, joints = by_name(model.all("link")), by_name(model.all("joint"))
    ends = [(_text(joint, "parent"), _text(joint, "child"), joint) for joint in joints.values()]
    poses = {name: _pose(link) for name, link in links.items()}
    static = _text(model, "static") in ("true", "1")
    bodies: list[ModelBody] = []
    index: dict[str, int] = {}
    for name, above, joint in tree_order(model, links, ends):
        place = poses[name]
        own = tuple(_joint(joint, place)) if joint is not None else ()
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


def _chosen_model(root: XmlElement, world: XmlElement | None) -> tuple[XmlElement, list[str]]:
    """Return the model to read, and a note on what stands beside it."""
    version = root.attributes.get("version", "").split(".")
    if version[0] == "1" and version[1:] and version[1] in "01234":
        root.refuse("must be of version 1.5 or newer, where axes are those of their joint's frame")
    models = list((root if world is None else world).all("model"))
    if not models:
        root.refuse("must have a <model>")
    model = next((each for each in models if each.first("joint")), models[0])
    for odd in model.all("include", "model", "frame"):
        odd.refuse("must be left out: only links and joints of one model are read")
    for odd in () if world is None else world.all("joint"):
        odd.refuse("must be left out: only joints inside one model are read")
    others = [shown(each.attributes.get("name", "")) for each in models if each is not model]
    return model, [f"other models are left out here: {', '.join(others[:5])}"] if others else []


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
    if pose.attributes.get("relative_to"):
        pose.refuse("must have no relative_to: poses of links are relative to their model here")
    turn, values = 1.0, pose.read("pose", pose.text, 6)
    if pose.attributes.get("degrees") == "true":
        turn = np.pi / 180
    return Pose(from_rpy(*(turn * angle for angle in values[3:])), np.array(values[:3]))


def _joint(joint: XmlElement, link: Pose) -> Iterator[ModelJoint]:
    kind = joint.attributes.get("type", "")
    if kind == "fixed":
        return
    name = joint.attributes.get("name", f"joint on line {joint.line}")
    place = link @ _pose(joint)
    axis = joint.first("axis")
    if kind not in _KINDS or axis is None:
        why = f"{joint.where} must be revolute with an axis, got type {shown(kind)}"
        yield ModelJoint(name, kind, np.zeros(3), place.position, refusal=why)
        return
    along = axis.first("xyz")
    if _text(axis, "use_parent_model_frame") in ("true", "1"):
        axis.refuse("must not use_parent_model_frame: the axis is one of the joint's frame here")
    if along is not None and along.attributes.get("expressed_in"):
        along.refuse("must have no expressed_in: the axis is one of the joint's frame here")
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
    own = place.rotation @ (direction / size)
    yield ModelJoint(name, _KINDS[kind], own, place.position, stiffness, refusal, damping)


def _why_not_at_rest(joint: XmlElement, axis: XmlElement, dynamics: XmlElement) -> str:
    if axis.first("mimic") is not None:
        return f"{joint.where} must not mimic another joint"
    limit = axis.first("limit")
    limits = None
    if limit is not None:
        limits = (_limit(limit, "lower", -math.inf), _limit(limit, "upper", math.inf))
    return why_not_free(joint, limits, _numbers(dynamics, "friction", 1, "0")[0])


def _limit(limit: XmlElement, tag: str, unlimited: float) -> float:
    # The one place where SDFormat writes an infinite number.
    if _text(limit, tag).lower().lstrip("+-") in ("", "inf", "infinity"):
        return unlimited
    return _numbers(limit, tag, 1, "0")[0]


def _matter(link: XmlElement) -> tuple[Inertial, list[np.ndarray]]:
    extent = []
    for shape in link.all("visual", "collision"):
        place, geometry = _pose(shape), shape.first("geometry")
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
    return inertial_of(link, _pose(unit), values_of | {"mass": mass}), extent
