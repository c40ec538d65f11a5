"""Cables of MuJoCo 3: its composite is expanded here, and its plugin's torques are read as springs of balls.

A cable's plugin (mujoco.elasticity.cable) resists, between a body and the one before it at the distance ℓ,

    M_x = G J θ_x / ℓ,   M_y = E I_y θ_y / ℓ,   M_z = E I_z θ_z / ℓ,

where E is the setting `bend`, G is `twist`, and J and I are those of the body's first geom. The first body of
a cable has none before it: whatever carries it holds it, if it has no joint, for its whole length.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.auditing.body_tree import Frame, ModelBody, from_quaternion
from beammodes.auditing.bounded_xml import BadModel, XmlElement
from beammodes.checks import shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "BARE",
    "CABLE",
    "CablePiece",
    "CableSettings",
    "cable_settings",
    "expand_cables",
    "settings_of",
    "with_cable_springs",
]

#: The name of the plugin.
CABLE = "mujoco.elasticity.cable"
#: The class of elements that take no defaults, as those that MuJoCo makes of a composite.
BARE = " "
#: Elements nest no deeper in files either.
_MOST_POINTS = 600
#: More in all cables of a file are no chain that anybody looks at.
_MOST_HINGES = 5000
_LONGEST_PREFIX = 100
#: Sines of angles up to which points are on a line and bodies are aligned; MuJoCo saves six digits.
_STRAIGHT = 1e-5
_TYPES = ("capsule", "cylinder", "box")
_SIZE = "the sizes of its bodies' first geoms in the saved cable, their masses said"
_SET_BY = (
    "the spring comes from the cable's bend and the size of its body's first geom, to the fourth power: set "
    "that size, and the geom's mass, or leave the plugin out and give the ball this stiffness"
)


# The composite.


def expand_cables(root: XmlElement) -> None:
    """Put the bodies that MuJoCo 3 makes of <composite type="cable"> in its place.

    A cable that cannot be judged stays, with the reason as its text: others of the file may be.
    """
    made: list[XmlElement] = []
    apart: list[XmlElement] = []
    waiting = [root]
    while waiting:
        element = waiting.pop()
        children: list[XmlElement] = []
        for child in element.children:
            if child.tag == "composite" and child.attributes.get("type") == "cable":
                try:
                    body, settings = _expanded(child)
                except BadModel as error:
                    children.append(replace(child, text=str(error)))
                    continue
                children.append(body)
                made += settings
                apart += _excludes(child, body)
                if len(apart) > _MOST_HINGES:
                    child.refuse(f"must be of cables with at most {_MOST_HINGES} hinges in all")
            else:
                children.append(child)
                waiting.append(child)
        element.children = children
    root.children.append(XmlElement("extension", {}, 0, children=made))
    root.children.append(XmlElement("contact", {}, 0, children=apart))


def _excludes(cable: XmlElement, body: XmlElement) -> list[XmlElement]:
    """Return the pairs of neighbours that MuJoCo lets not touch each other."""
    found: list[XmlElement] = []
    after = body.first("body")
    while after is not None:
        pair = {"body1": body.attributes["name"], "body2": after.attributes["name"]}
        found.append(_made(cable, "exclude", pair))
        body, after = after, after.first("body")
    return found


def _expanded(cable: XmlElement) -> tuple[XmlElement, list[XmlElement]]:
    """Return the outermost body of a cable, and the settings of its plugin."""
    points = _points(cable)
    edges = np.diff(points, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    if not lengths.all():
        cable.refuse("must have points that are apart, as curve and size give them")
    along = edges / lengths[:, None]
    if np.linalg.norm(along - along[0], axis=1).max() > _STRAIGHT:
        cable.refuse("must be straight to be judged: curve and size bend it")
    initial = cable.attributes.get("initial", "ball")
    if initial not in ("none", "ball", "free"):
        cable.refuse(f"must have an initial of none, ball or free, got {shown(initial)}")
    prefix, last = cable.attributes.get("prefix", ""), len(lengths) - 1
    if len(prefix) > _LONGEST_PREFIX or not prefix.isprintable():
        cable.refuse(f"must have a printable prefix of at most {_LONGEST_PREFIX} characters")
    plugins, settings = _plugins(cable)
    inner: list[XmlElement] = []
    for i in range(last, -1, -1):
        name = "first" if i == 0 else "last" if i == last else str(i)
        kind = "ball" if i else initial
        children = [_geom(cable, f"{prefix}G{i}", float(lengths[i])), *plugins, *inner]
        if kind != "none":
            children.insert(0, _joint(cable, f"{prefix}J_{name}", kind))
        place = {"pos": _written(points[0])} if i == 0 else {"pos": f"{float(lengths[i - 1])!r} 0 0"}
        if i == 0:
            place["quat"] = _written(_first_frame(along[0]))
        inner = [_made(cable, "body", {"name": f"{prefix}B_{name}", **place}, children)]
    return inner[0], settings


def _made(
    cable: XmlElement, tag: str, attributes: dict[str, str], children: Sequence[XmlElement] = ()
) -> XmlElement:
    return XmlElement(tag, attributes, cable.line, children=list(children), file=cable.file)


def _written(values: Floats) -> str:
    return " ".join(map(repr, np.asarray(values).tolist()))


def _points(cable: XmlElement) -> Floats:
    offset = np.array(cable.numbers("offset", 3, "0 0 0"))
    if "vertex" in cable.attributes:
        text = cable.attributes["vertex"]
        count = min(len(text.split(maxsplit=3 * _MOST_POINTS + 1)), 3 * _MOST_POINTS + 1)
        if count % 3 or not 6 <= count <= 3 * _MOST_POINTS:
            cable.refuse(f"must have from 2 to {_MOST_POINTS} points of three numbers in vertex")
        return np.asarray(np.array(cable.read("vertex", text, count)).reshape(-1, 3) + offset)
    counts = cable.numbers("count", (1, 2, 3))
    if not (2 <= counts[0] <= _MOST_POINTS and counts[0] == int(counts[0]) and set(counts[1:]) <= {1.0}):
        cable.refuse(
            f"must have a count from 2 to {_MOST_POINTS} along a line, got {shown(cable.attributes['count'])}"
        )
    count = int(counts[0])
    size = [*cable.numbers("size", (1, 2, 3), "1"), 0.0, 0.0]
    share = np.arange(count) / (count - 1)
    shapes = {
        "0": np.zeros(count),
        "s": share * size[0],
        "cos(s)": size[1] * np.cos(math.pi * share * size[2]),
        "sin(s)": size[1] * np.sin(math.pi * share * size[2]),
    }
    names = cable.attributes.get("curve", "")[:40].split()
    if len(names) > 3 or not set(names) <= shapes.keys():
        cable.refuse(f"must have a curve of up to three of {', '.join(shapes)}, got {shown(' '.join(names))}")
    columns = [shapes[name] for name in (*names, "0", "0", "0")[:3]]
    turn = np.array(cable.numbers("quat", 4, "1 0 0 0"))
    if abs(float(np.linalg.norm(turn)) - 1) > _STRAIGHT:
        cable.refuse("must have a quat of length 1: MuJoCo scales the curve by any other")
    return np.asarray(np.column_stack(columns) @ from_quaternion(*turn).T + offset)


def _first_frame(along: Floats) -> Floats:
    """Return the quaternion that MuJoCo gives the first body of a straight cable, x along it.

    Not always the smallest rotation from x, which matters to boxes: across x they stand on their heads.
    """
    x, y, z = along
    turn = np.array([1 + x, 0.0, -z, y]) if x > 0 else np.array([y, z, 0.0, 1 - x])
    return np.asarray(turn / np.linalg.norm(turn))


def _geom(cable: XmlElement, name: str, length: float) -> XmlElement:
    given = cable.first("geom")
    kind = "sphere" if given is None else given.attributes.get("type", "sphere")
    if given is None or kind not in _TYPES:
        cable.refuse(f"must have a geom of type {', '.join(_TYPES)}, got {shown(kind)}")
    own = {**given.attributes, "name": name, "class": BARE}
    sizes = given.numbers("size", (1, 2, 3))
    if kind == "box":
        sizes = [length / 2, *sizes[1:]]
        own |= {"size": _written(np.array(sizes)), "pos": f"{length / 2!r} 0 0"}
    else:
        own |= {"size": repr(sizes[0]), "fromto": f"0 0 0 {length!r} 0 0"}
    return replace(given, attributes=own, line=given.line)


def _joint(cable: XmlElement, name: str, kind: str) -> XmlElement:
    given = cable.first("joint")
    own = {} if given is None else given.attributes
    if kind == "free":
        # A free body takes neither dampers nor armature.
        own = {key: value for key, value in own.items() if key == "stiffness"}
    own = {key: value for key, value in own.items() if key not in ("kind", "axis")}
    return _made(cable, "joint", {**own, "name": name, "type": kind, "class": BARE})


def _plugins(cable: XmlElement) -> tuple[list[XmlElement], list[XmlElement]]:
    """Return what names the plugin of each body, and the settings of an instance that only this cable has."""
    given = cable.first("plugin")
    if given is None:
        return [], []
    if "instance" in given.attributes:
        return [given], []
    name = f"composite at byte {cable.start} of {cable.file}"
    instance = _made(given, "instance", {"name": name}, given.children)
    settings = _made(given, "plugin", dict(given.attributes), [instance])
    return [_made(given, "plugin", {"instance": name})], [settings]


# The plugin.


@dataclass(frozen=True)
class CableSettings:
    """The settings of one instance of the plugin: twist and bend [Pa]."""

    twist: float
    bend: float


@dataclass(frozen=True, eq=False)
class CablePiece:
    """A body of a cable: which instance moves it, and its first geom with the sizes that count.

    `size` has the radius of a cylinder or capsule, or the second and third half length of a box.
    """

    instance: str
    settings: CableSettings
    where: str
    kind: str
    size: tuple[float, ...]

    @property
    def rigidity(self) -> Floats:
        """GJ, EI about y and EI about z, as the plugin computes them [N m²]."""
        if self.kind == "box":
            (h, w), (short, long) = self.size, sorted(self.size)
            torsion = long * short**3 * (16 / 3 - 3.36 * short / long * (1 - short**4 / long**4 / 12))
            about = (4 / 3 * w**3 * h, 4 / 3 * h**3 * w)
        else:
            (radius,) = self.size
            torsion, about = math.pi * radius**4 / 2, (math.pi * radius**4 / 4,) * 2
        return np.array([self.settings.twist * torsion, *(self.settings.bend * each for each in about)])


def cable_settings(root: XmlElement) -> dict[str, CableSettings]:
    """Return the settings of the cables that a file's <extension> names."""
    found = {}
    for plugin in (each for section in root.all("extension") for each in section.all("plugin")):
        for instance in plugin.all("instance") if plugin.attributes.get("plugin") == CABLE else ():
            found[instance.attributes.get("name", "")] = settings_of(instance)
    return found


def settings_of(element: XmlElement) -> CableSettings:
    """Return the settings that an instance, or a plugin without a named one, has in its <config> elements."""
    said = {config.attributes.get("key", ""): config for config in element.all("config")}

    def value(key: str) -> float:
        config = said.get(key)
        return 0.0 if config is None else config.at_least_0("value", config.number("value", "0"))

    return CableSettings(value("twist"), value("bend"))


def with_cable_springs(
    bodies: Sequence[ModelBody], frames: Sequence[Frame], pieces: Mapping[int, CablePiece]
) -> tuple[list[ModelBody], list[str]]:
    """Return bodies whose balls have the springs of cables, and what to say of each cable.

    `frames` are the bodies' own in the world at rest; `pieces` says which bodies are in a cable.
    """
    found = list(bodies)
    rows: dict[str, list[int]] = {}
    for i, piece in pieces.items():
        rows.setdefault(piece.instance, []).append(i)
    for row in rows.values():
        for before, own in itertools.pairwise(row):
            found[own] = _with_springs(found, frames, before, own, pieces[own])
    return found, [_told(found, frames, row, pieces) for row in rows.values()]


def _with_springs(
    bodies: Sequence[ModelBody], frames: Sequence[Frame], before: int, own: int, piece: CablePiece
) -> ModelBody:
    body, turned = bodies[own], frames[own].rotation
    length = float(np.linalg.norm(frames[own].position - frames[before].position))
    why = ""
    if body.parent != before or own != before + 1:
        why = "must be on the body before it in its cable, without branches between them"
    elif [joint.kind for joint in body.joints] != ["ball"]:
        why = "must be on one ball joint, on which the plugin of its cable acts"
    elif np.abs(frames[before].rotation.T @ turned - np.eye(3)).max() > _STRAIGHT:
        why = "must be aligned with the body before it: a cable that is bent or twisted at rest is not judged"
    elif not piece.settings.bend:
        why = "must be of a cable with a bend above 0: nothing resists its bending"
    elif not piece.size:
        why = f"must have a first geom of type {', '.join(_TYPES)}, from which its cable takes its stiffness"
    elif not length:
        why = "must be apart from the body before it"
    if why:
        return replace(body, refusal=f"{piece.where} {why}")
    springs = turned @ np.diag(piece.rigidity / length) @ turned.T
    (joint,) = body.joints
    place = (
        None
        if joint.place is None
        else replace(joint.place, refusal=_SET_BY, size="" if joint.stiffness else _SIZE)
    )
    return replace(body, joints=(replace(joint, springs=springs, place=place),))


def _told(
    bodies: Sequence[ModelBody], frames: Sequence[Frame], row: Sequence[int], pieces: Mapping[int, CablePiece]
) -> str:
    """Return in one sentence the beam that a cable stands for."""
    first, last = bodies[row[0]], bodies[row[-1]]
    name = f"cable of {len(row)} bodies from {first.name} to {last.name}"
    if len(row) == 1:
        return f"{name}: nothing joins the plugin's one body to another, so it has no spring"
    along = frames[row[-1]].position - frames[row[0]].position
    along = along / (float(np.linalg.norm(along)) or 1.0)
    reach = [float((point - frames[row[0]].position) @ along) for i in row for point in bodies[i].extent]
    length = max(reach, default=0.0)
    mass = sum(bodies[i].inertial.mass for i in row)
    values = np.array([pieces[i].rigidity if pieces[i].size else np.zeros(3) for i in row[1:]])
    twist, *bend = [_between(column) for column in values.T]
    about = bend[0] if bend[0] == bend[1] else f"{bend[0]} about y and {bend[1]} about z of its bodies"
    settings = pieces[row[0]].settings
    own = f", {mass / length:.6g} kg/m over {length:.6g} m" if length else ""
    return (
        f"{name}: bend {settings.bend:.6g} Pa and twist {settings.twist:.6g} Pa by the geoms' sizes are "
        f"EI = {about} N m², GJ = {twist} N m²{own}; each spring is these by the distance of two bodies"
    )


def _between(values: Floats) -> str:
    least, most = f"{values.min():.6g}", f"{values.max():.6g}"
    return least if least == most else f"{least} to {most}"
