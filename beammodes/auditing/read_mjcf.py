"""MJCF, MuJoCo's format, read without MuJoCo: bodies, joints, solids, fixed tendons."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, ModelJoint, Solid
from beammodes.auditing.bounded_xml import BadModel, XmlElement, read_xml
from beammodes.auditing.mjcf_forces import (
    acted_sites,
    held_ends,
    linear_damping,
    linear_stiffness,
    servo_dampers,
    servos,
    ties,
)
from beammodes.auditing.mjcf_matter import compiled_masses, matter_of
from beammodes.auditing.mjcf_settings import Settings, settings_of
from beammodes.auditing.spatial import Pose
from beammodes.checks import shown

__all__ = ["read_mjcf", "with_includes"]

_MOST_INCLUDED = 20

_MOST_BODIES = 20_000
#: What only MuJoCo can expand or would change a body's motion by.
_UNREAD = ("composite", "flexcomp", "attach", "plugin")
_WHY = {
    "composite": "only MuJoCo can expand it; of a cable (mujoco.elasticity.cable) the page on MuJoCo "
    "(beammodes/pages/mujoco.md) has the error",
    "flexcomp": "a flex has no hinges and is not judged here; the page on MuJoCo "
    "(beammodes/pages/mujoco.md) has its error",
    "attach": "only MuJoCo can expand it; save what it makes of the file by mj_saveLastXML",
    "plugin": "what a plugin such as mujoco.elasticity.cable does is not read; the page on MuJoCo "
    "(beammodes/pages/mujoco.md) has the error of its cable",
}


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

    Other files are included by `with_includes` before. Honoured are frames, replicates, the compiler's angle,
    eulerseq, autolimits, inertiafromgeom, inertiagrouprange and settotalmass, default classes, explicit
    inertials, solids with mass or density, poses, hinges, slides and free joints, fixed tendons with
    stiffness, and equality constraints on these. Armature is inertia of a hinge's own rotation; servos of
    velocity without other terms are dampers. What cannot be honoured is refused where a chain needs it:
    composites, plugins, flexes, meshes, balls without a spring, dry friction, stops at rest, servos
    that act like springs, spatial tendons with springs.

    Raises
    ------
    BadModel
        If an element is not as MuJoCo wants it.
    """
    if root.tag not in ("mujoco", "mujocoinclude"):
        root.refuse("must be <mujoco>")
    for element in root.all("attach"):
        element.refuse(f"must be left out: {_WHY['attach']}")
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
        tuple(compiled_masses(reader.settings, reader.bodies)),
        tuple(ties(root, reader.settings)),
        held,
        tuple(reader.notes),
        reader.settings.step if alone else None,
        np.array(reader.settings.gravity) if alone else np.zeros(3),
    )


def _read_children(reader: _Reader, top: XmlElement, above: int, pose: Pose, inherited: str) -> None:
    """Read the bodies below an element, without recursion: a chain nests as deep as it is long."""
    inside = reader.settings.inside
    waiting = [(*found, above, pose) for found in inside(top, inherited, "body")][::-1]
    if above < 0:
        for odd, *_ in inside(top, inherited, *_UNREAD):
            reader.notes.append(f"{odd.where} is left out here: {_WHY[odd.tag]}")
    while waiting:
        element, place, class_name, suffix, parent, outer = waiting.pop()
        class_name = element.attributes.get("childclass", class_name)
        own = outer @ place @ reader.settings.pose(element)
        reader.bodies.append(_body(reader, element, parent, own, class_name, suffix))
        index = len(reader.bodies) - 1
        if index > _MOST_BODIES:
            element.refuse(f"must be one of at most {_MOST_BODIES} bodies")
        waiting += [
            (child, at, inner, suffix + more, index, own)
            for child, at, inner, more in inside(element, class_name, "body")
        ][::-1]


def _body(
    reader: _Reader, element: XmlElement, parent: int, pose: Pose, class_name: str, suffix: str
) -> ModelBody:
    name = element.attributes.get("name", f"body on line {element.line}") + suffix
    inside = reader.settings.inside
    odd = next((found for found, *_ in inside(element, class_name, *_UNREAD)), None)
    refusal = f"{odd.where} must be left out: {_WHY[odd.tag]}" if odd else ""
    sites = [site.attributes.get("name", "") for site, *_ in inside(element, class_name, "site")]
    reader.homes |= dict.fromkeys(sites, name)
    refusal = refusal or next((reader.acted[site] for site in sites if site in reader.acted), "")
    inertial, extent, solids, why = matter_of(reader.settings, element, class_name)
    return ModelBody(
        name,
        parent,
        pose.position,
        inertial.seen_from(pose),
        tuple(pose.point(point) for point in extent),
        tuple(_joints(reader, element, pose, class_name, name, suffix)),
        refusal or why,
        tuple(
            Solid(each.inertial.seen_from(pose), tuple(pose.point(end) for end in each.ends))
            for each in solids
        ),
    )


def _joints(
    reader: _Reader, element: XmlElement, pose: Pose, class_name: str, body: str, suffix: str
) -> Iterator[ModelJoint]:
    joints = reader.settings.inside(element, class_name, "joint", "freejoint")
    for i, (child, place, inherited, more) in enumerate(joints):
        own, kind, at = child, "free", pose @ place
        if child.tag == "joint":
            own = reader.settings.with_defaults(child, "joint", inherited)
            kind = own.attributes.get("type", "hinge")
        name = own.attributes.get("name", f"joint {i + 1} of {body.removesuffix(suffix)}")
        axis = np.array(own.numbers("axis", 3, "0 0 1"))
        size = float(np.linalg.norm(axis))
        if not size:
            child.refuse("must have an axis that is not zero")
        position = at.point(np.array(own.numbers("pos", 3, "0 0 0")))
        stiffness = linear_stiffness(own)
        refusal = _why_not(reader.settings, own, kind, stiffness) or reader.servos.get(name, "")
        damping, armature = linear_damping(own), own.numbers("armature", 1, "0")[0]
        if armature < 0:
            child.refuse(f"must have an armature of at least 0, got {armature:g}")
        yield ModelJoint(
            f"{name}{suffix}{more}",
            kind,
            at.rotation @ (axis / size),
            position,
            stiffness,
            refusal,
            damping + reader.dampers.get(name, 0.0),
            armature,
        )


def _why_not(settings: Settings, joint: XmlElement, kind: str, stiffness: float) -> str:
    if kind not in ("hinge", "slide", "free") and not (kind == "ball" and stiffness):
        return f"{joint.where} must be a hinge or a ball with a stiffness, got type {kind!r}"
    if kind == "free" and stiffness:
        return f"{joint.where} must have no spring, or be a <freejoint>, which takes no defaults"
    if joint.numbers("frictionloss", 1, "0")[0]:
        return f"{joint.where} must have no frictionloss: dry friction holds a hinge still"
    if min(joint.numbers("springdamper", 2, "0 0")) > 0:
        return f"{joint.where} must have its stiffness said, not left to springdamper"
    (reference,) = joint.numbers("ref", 1, "0")
    if kind != "free" and settings.limited(joint):
        low, high = joint.numbers("range", 2, "0 0")
        if kind == "ball":
            # The largest angle; what is said as the least is not used.
            low = -1.0
        if not low < reference < high:
            return f"{joint.where} must be at rest within its range, not at a stop or beyond"
    if stiffness and kind != "ball" and joint.numbers("springref", 1, "0") != [reference]:
        return f"{joint.where} must have springref equal to ref: the chain must be straight at rest"
    return ""


def with_includes(root: XmlElement, folder: Path) -> XmlElement:
    """Return a model with what its <include> elements name in their place, as MuJoCo reads it.

    Raises
    ------
    BadModel
        If a file is outside the model's folder, included twice, or cannot be read; the message names it.
    """
    inside, seen, count = folder.resolve(), {""}, 0
    waiting = [root]
    while waiting:
        element = waiting.pop()
        children: list[XmlElement] = []
        found = element.children[::-1]
        while found:
            child = found.pop()
            if child.tag != "include":
                children.append(child)
                continue
            name = child.attributes.get("file", "")
            place = (folder / name).resolve()
            if not name or inside not in place.parents:
                child.refuse(f"must name a file in the model's own folder, got {shown(name)}")
            if str(place) in seen:
                child.refuse(f"must not include a file twice, got {shown(name)}")
            seen.add(str(place))
            count += 1
            if count > _MOST_INCLUDED:
                child.refuse(f"must be one of at most {_MOST_INCLUDED} files")
            try:
                top = read_xml(place)
            except OSError as error:
                child.refuse(f"must name a file that can be read: {error.strerror or error}")
            except BadModel as error:
                child.refuse(f"must name a file that can be read: {shown(name)}: {error}")
            _named(top, name)
            found += top.children[::-1]
        element.children = children
        waiting += children
    return root


def _named(top: XmlElement, file: str) -> None:
    waiting = [top]
    while waiting:
        element = waiting.pop()
        element.file = file
        waiting += element.children
