"""URDF, the robot description of ROS, and the springs that stand beside it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint
from beammodes.auditing.bounded_xml import BadModel, XmlElement
from beammodes.auditing.robot_extras import by_name, check_added, why_driven, why_not_free
from beammodes.auditing.spatial import Inertial, Pose, ends_of, from_rpy
from beammodes.checks import shown

__all__ = ["inertial_of", "read_urdf", "shape_ends", "tree_order"]

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
