"""MJCF, MuJoCo's format, read without MuJoCo: bodies, joints, solids, fixed tendons."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.mjcf_forces import (
    acted_sites,
    held_ends,
    linear_damping,
    linear_stiffness,
    servo_dampers,
    servos,
    ties,
)
from beammodes.auditing.mjcf_matter import matter_of
from beammodes.auditing.mjcf_settings import Settings, settings_of
from beammodes.auditing.spatial import Pose

__all__ = ["read_mjcf"]

#: What only MuJoCo can expand or would change a body's motion by.
_UNREAD = ("composite", "flexcomp", "replicate", "attach", "frame", "plugin", "include")


@dataclass
class _Reader:
    """Bodies found so far with the homes of their sites; why joints and sites are acted on."""

    settings: Settings
    bodies: list[ModelBody] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    servos: dict[str, str] = field(default_factory=dict)
    dampers: dict[str, float] = field(default_factory=dict)
    acted: dict[str, str] = field(default_factory=dict)
    homes: dict[str, str] = field(default_factory=dict)


def read_mjcf(root: XmlElement) -> Model:
    """Return the bodies, joints and ties of an MJCF model.

    Honoured are the compiler's angle, eulerseq, autolimits, inertiafromgeom and inertiagrouprange, default
    classes, explicit inertials, solids with mass or density, poses, hinges, slides and free joints, fixed
    tendons with stiffness, and equality constraints on these. What cannot be honoured is refused where a
    chain needs it: composites, plugins, meshes, ball joints, dry friction, stops at rest, servos that act
    like
    springs, spatial tendons with springs. Armature is inertia of a hinge's own rotation; servos of velocity
    without other terms are dampers.

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
    reader.servos = dict(servos(root, reader.settings))
    for name, damping in servo_dampers(root, reader.settings):
        reader.dampers[name] = reader.dampers.get(name, 0.0) + damping
    reader.acted = dict(acted_sites(root, reader.settings))
    for world in worlds:
        _read_children(reader, world, -1, Pose.identity(), "main")
    reader.notes += reader.settings.left_out
    held = tuple(held_ends(root, reader.homes))
    # A file without its root, to be included, takes its step and its gravity from the one that includes it.
    alone = root.tag == "mujoco"
    return Model(
        tuple(reader.bodies),
        tuple(ties(root, reader.settings)),
        held,
        tuple(reader.notes),
        reader.settings.step if alone else None,
        np.array(reader.settings.gravity) if alone else np.zeros(3),
    )


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
    sites = [site.attributes.get("name", "") for site in element.all("site")]
    reader.homes |= dict.fromkeys(sites, name)
    refusal = refusal or next((reader.acted[site] for site in sites if site in reader.acted), "")
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
        own, kind = child, "free"
        if child.tag == "joint":
            own = reader.settings.with_defaults(child, "joint", class_name)
            kind = own.attributes.get("type", "hinge")
        name = own.attributes.get("name", f"joint {i + 1} of {body}")
        axis = np.array(own.numbers("axis", 3, "0 0 1"))
        size = float(np.linalg.norm(axis))
        if not size:
            child.refuse("must have an axis that is not zero")
        position = pose.point(np.array(own.numbers("pos", 3, "0 0 0")))
        stiffness = linear_stiffness(own)
        refusal = _why_not(reader.settings, own, kind, stiffness) or reader.servos.get(name, "")
        damping, armature = linear_damping(own), own.numbers("armature", 1, "0")[0]
        if armature < 0:
            child.refuse(f"must have an armature of at least 0, got {armature:g}")
        yield ModelJoint(
            name,
            kind,
            pose.rotation @ (axis / size),
            position,
            stiffness,
            refusal,
            damping + reader.dampers.get(name, 0.0),
            armature,
        )


def _why_not(settings: Settings, joint: XmlElement, kind: str, stiffness: float) -> str:
    if kind not in ("hinge", "slide", "free"):
        return f"{joint.where} must be a hinge, got type {kind!r}: {_BALL}"
    if kind == "free" and stiffness:
        return f"{joint.where} must have no spring, or be a <freejoint>, which takes no defaults"
    if joint.numbers("frictionloss", 1, "0")[0]:
        return f"{joint.where} must have no frictionloss: dry friction holds a hinge still"
    if min(joint.numbers("springdamper", 2, "0 0")) > 0:
        return f"{joint.where} must have its stiffness said, not left to springdamper"
    (reference,) = joint.numbers("ref", 1, "0")
    if kind != "free" and settings.limited(joint):
        low, high = joint.numbers("range", 2, "0 0")
        if not low < reference < high:
            return f"{joint.where} must be at rest within its range, not at a stop or beyond"
    if stiffness and joint.numbers("springref", 1, "0") != [reference]:
        return f"{joint.where} must have springref equal to ref: the chain must be straight at rest"
    return ""


_BALL = "two hinges bend about both axes, without twist"
