"""MJCF, MuJoCo's format, read without MuJoCo: bodies, joints, solids, fixed tendons."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint, ModelTie
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.mjcf_matter import matter_of
from beammodes.auditing.mjcf_settings import Settings, settings_of
from beammodes.auditing.spatial import Pose

__all__ = ["read_mjcf"]

#: What only MuJoCo can expand or would change a body's motion by.
_UNREAD = ("composite", "flexcomp", "replicate", "attach", "frame", "plugin", "include")
_PLAIN_ACTUATORS = ("motor", "damper", "plugin", "adhesion")


@dataclass
class _Reader:
    """Bodies found so far, and what the whole model says."""

    settings: Settings
    bodies: list[ModelBody] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    servos: dict[str, str] = field(default_factory=dict)


def read_mjcf(root: XmlElement) -> Model:
    """Return the bodies, joints and ties of an MJCF model.

    Honoured are the compiler's angle, eulerseq, autolimits, inertiafromgeom and inertiagrouprange, default
    classes, explicit inertials, solids with mass or density, poses, hinges, slides and free joints, fixed
    tendons with stiffness, and equality constraints on these. What cannot be honoured is refused where a
    chain needs it: composites, plugins, meshes, ball joints, armatures, servos.

    Raises
    ------
    BadModel
        If the model includes other files, or an element is not as MuJoCo wants it.
    """
    if root.tag not in ("mujoco", "mujocoinclude"):
        root.refuse("must be <mujoco>")
    for element in root.all("include", "replicate", "attach"):
        element.refuse("must be left out: save the model that MuJoCo makes of it, by mj_saveLastXML")
    reader = _Reader(settings_of(root))
    if root.tag == "mujocoinclude" and root.first("worldbody") is None:
        worlds = [root]
    else:
        worlds = list(root.all("worldbody"))
    reader.servos = dict(_servos(root))
    for world in worlds:
        _read_children(reader, world, -1, Pose.identity(), "main")
    if _has_gravity(root):
        reader.notes.append("gravity is left out here: with it the chain sags and rings at other frequencies")
    ties = tuple(_ties(root))
    return Model(tuple(reader.bodies), ties, tuple(_held(root)), tuple(reader.notes))


def _read_children(reader: _Reader, top: XmlElement, above: int, pose: Pose, inherited: str) -> None:
    """Read the bodies below an element, without recursion: a chain nests as deep as it is long."""
    waiting = [(child, above, pose, inherited) for child in top.all("body")][::-1]
    if any(top.all(*_UNREAD)) and above < 0:
        odd = next(top.all(*_UNREAD))
        reader.notes.append(f"{odd.where} is left out here")
    while waiting:
        element, parent, outer, class_name = waiting.pop()
        class_name = element.attributes.get("childclass", class_name)
        own = outer @ reader.settings.pose(element)
        reader.bodies.append(_body(reader, element, parent, own, class_name))
        index = len(reader.bodies) - 1
        waiting += [(child, index, own, class_name) for child in element.all("body")][::-1]


def _body(reader: _Reader, element: XmlElement, parent: int, pose: Pose, class_name: str) -> ModelBody:
    name = element.attributes.get("name", f"body on line {element.line}")
    odd = next(element.all(*_UNREAD), None)
    refusal = f"{odd.where} must be left out: only MuJoCo can expand it" if odd else ""
    inertial, extent, why = matter_of(reader.settings, element, class_name)
    return ModelBody(
        name,
        parent,
        pose.position,
        inertial.seen_from(pose),
        tuple(pose.point(point) for point in extent),
        tuple(_joints(reader, element, pose, class_name, name)),
        refusal or why,
    )


def _joints(
    reader: _Reader, element: XmlElement, pose: Pose, class_name: str, body: str
) -> Iterator[ModelJoint]:
    for i, child in enumerate(element.all("joint", "freejoint")):
        own = reader.settings.with_defaults(child, "joint", class_name)
        kind = "free" if child.tag == "freejoint" else own.attributes.get("type", "hinge")
        name = own.attributes.get("name", f"joint {i + 1} of {body}")
        axis = np.array(own.numbers("axis", 3, "0 0 1"))
        size = float(np.linalg.norm(axis))
        if not size:
            child.refuse("must have an axis that is not zero")
        position = pose.point(np.array(own.numbers("pos", 3, "0 0 0")))
        stiffness = _stiffness(own) if kind in ("hinge", "slide") else 0.0
        refusal = _why_not(own, kind, stiffness) or reader.servos.get(name, "")
        yield ModelJoint(name, kind, pose.rotation @ (axis / size), position, stiffness, refusal)


def _stiffness(joint: XmlElement) -> float:
    # MuJoCo 4 takes coefficients of a polynomial.
    value, *more = joint.numbers("stiffness", (1, 2, 3), "0")
    if any(more):
        joint.refuse("must have a linear spring, got a stiffness with more than one number")
    if value < 0:
        joint.refuse(f"must have a stiffness of at least 0, got {value:g}")
    return value


def _why_not(joint: XmlElement, kind: str, stiffness: float) -> str:
    if kind not in ("hinge", "slide", "free"):
        return f"{joint.where} must be a hinge, got type {kind!r}: {_BALL}"
    if joint.numbers("armature", 1, "0")[0]:
        return f"{joint.where} must have no armature, which is inertia that no beam has"
    reference = joint.numbers("ref", 1, "0")
    if stiffness and joint.numbers("springref", 1, "0") != reference:
        return f"{joint.where} must have springref equal to ref: the chain must be straight at rest"
    return ""


_BALL = "two hinges bend about both axes, without twist"


def _servos(root: XmlElement) -> Iterator[tuple[str, str]]:
    for actuators in root.all("actuator"):
        for element in actuators.children:
            joint = element.attributes.get("joint")
            general = element.tag == "general" and element.attributes.get("biastype", "none") == "none"
            if joint and not general and element.tag not in _PLAIN_ACTUATORS:
                yield joint, f"{element.where} must not act on a hinge of the chain, like a spring"


def _ties(root: XmlElement) -> Iterator[ModelTie]:
    holding = {
        constraint.attributes.get("tendon1", "")
        for constraints in root.all("equality")
        for constraint in constraints.all("tendon")
        if "tendon2" not in constraint.attributes and constraint.attributes.get("active") != "false"
    }
    for tendons in root.all("tendon"):
        for i, tendon in enumerate(tendons.all("fixed")):
            name = tendon.attributes.get("name", f"tendon {i + 1}")
            terms = tuple(
                (part.attributes.get("joint", ""), part.numbers("coef", 1)[0]) for part in tendon.all("joint")
            )
            stiffness = math.inf if name in holding else _stiffness(tendon)
            rest = tendon.numbers("springlength", (1, 2), "-1")
            refusal = ""
            if 0 < stiffness < math.inf and any(rest) and rest != [-1.0]:
                refusal = f"{tendon.where} must be slack at rest: springlength 0"
            yield ModelTie(name, terms, stiffness, refusal)


def _held(root: XmlElement) -> Iterator[tuple[str, str]]:
    """Yield the bodies and joints that other constraints act on, and what to say of these."""
    for constraints in root.all("equality"):
        for element in constraints.all("connect", "weld", "joint"):
            if element.attributes.get("active") != "false":
                for end in ("body1", "body2", "joint1", "joint2"):
                    if end in element.attributes:
                        yield element.attributes[end], element.where


def _has_gravity(root: XmlElement) -> bool:
    values = [option.numbers("gravity", 3, "0 0 -9.81") for option in root.all("option")]
    return any(values[-1]) if values else root.tag == "mujoco"
