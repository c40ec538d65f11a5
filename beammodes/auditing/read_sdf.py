"""SDFormat, as Gazebo and Drake read it: links and joints of one model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.read_urdf import inertial_of, shape_ends, tree_order
from beammodes.auditing.spatial import Inertial, Pose, from_rpy
from beammodes.checks import shown

__all__ = ["read_sdf"]

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}


def read_sdf(root: XmlElement) -> Model:
    """Return the links and joints of the first model of an SDFormat file.

    Raises
    ------
    BadModel
        If it has no model, frames of its own, or links and joints that are no tree.
    """
    world = root.first("world")
    model = (root if world is None else world).first("model")
    if model is None:
        root.refuse("must have a <model>")
    for odd in model.all("include", "model", "frame"):
        odd.refuse("must be left out: only links and joints of one model are read")
    links = {link.attributes.get("name", ""): link for link in model.all("link")}
    ends = [(_text(joint, "parent"), _text(joint, "child"), joint) for joint in model.all("joint")]
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
    return Model(tuple(bodies), notes=() if flat else (note,))


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
    yield ModelJoint(
        name, _KINDS[kind], place.rotation @ (direction / size), place.position, stiffness, refusal
    )


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
    # SDFormat's own default is a unit of mass and inertia.
    unit = XmlElement("inertial", {}, link.line) if given is None else given
    (mass,) = _numbers(unit, "mass", 1, "1")
    matrix = unit.first("inertia") or unit
    defaults = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}
    values_of = {key: _numbers(matrix, key, 1, default)[0] for key, default in defaults.items()}
    return inertial_of(link, _pose(unit), values_of | {"mass": mass}), extent
