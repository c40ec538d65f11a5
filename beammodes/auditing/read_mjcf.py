"""MJCF, MuJoCo's format, read without MuJoCo: bodies, joints, solids, fixed tendons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from beammodes.auditing.body_tree import (
    FileStep,
    Inertial,
    Model,
    ModelBody,
    ModelJoint,
    ModelTie,
    Pose,
    Solid,
    about,
    ends_of,
    from_euler,
    from_quaternion,
    from_z_to,
    joined,
    solid,
)
from beammodes.auditing.bounded_xml import BadModel, XmlElement, read_xml
from beammodes.checks import shown
from beammodes.numerics.arrays import Floats
from beammodes.vibration.integrators import find_integrator

__all__ = [
    "Placed",
    "Settings",
    "acted_sites",
    "compiled_masses",
    "held_ends",
    "linear_damping",
    "linear_stiffness",
    "matter_of",
    "read_mjcf",
    "servo_dampers",
    "servos",
    "settings_of",
    "ties",
    "with_includes",
]


# What an MJCF model says once for all its elements: the compiler's settings and default classes.

Attributes = dict[str, str]


@dataclass(frozen=True)
class Settings:
    """How to read the elements of one model.

    Attributes
    ----------
    angle : float
        Radians in one of the file's units of angle.
    sequence : str
        Axes of its Euler angles.
    inertia_from_geometry : str
        "true", "false" or "auto".
    groups : tuple of int
        First and last group of geometry whose mass counts.
    classes : dict
        For every class, the default attributes of each tag.
    automatic_limits : bool
        Whether a range alone makes a joint limited.
    left_out : tuple of str
        What is said of the surroundings that the audit leaves out.
    step : FileStep or None
    gravity : tuple of float
    compiler : XmlElement
        The file's own, for what it does to masses.
    copies : list of int
        How many copies replicates have made so far.
    """

    angle: float
    sequence: str
    inertia_from_geometry: str
    groups: tuple[float, float]
    classes: dict[str, dict[str, Attributes]]
    automatic_limits: bool = True
    left_out: tuple[str, ...] = ()
    step: FileStep | None = None
    gravity: tuple[float, ...] = (0.0, 0.0, 0.0)
    compiler: XmlElement = field(default_factory=lambda: XmlElement("compiler", {}, 0))
    copies: list[int] = field(default_factory=list)

    def with_defaults(self, element: XmlElement, tag: str, class_name: str) -> XmlElement:
        """Return an element with the attributes that it takes from its class."""
        name = element.attributes.get("class", class_name)
        if name not in self.classes:
            element.refuse(f"must have a class that <default> defines, got {name[:40]!r}")
        attributes = self.classes[name].get(tag, {}) | element.attributes
        return replace(element, attributes=attributes)

    def limited(self, joint: XmlElement) -> bool:
        """Whether a joint has stops."""
        given = joint.attributes.get("limited", "auto")
        return given == "true" or (given == "auto" and self.automatic_limits and "range" in joint.attributes)

    def counts(self, geom: XmlElement) -> bool:
        """Whether a geom's mass is part of its body's."""
        return self.groups[0] <= geom.numbers("group", 1, "0")[0] <= self.groups[1]

    def inside(self, element: XmlElement, class_name: str, *tags: str) -> Iterator[Placed]:
        """Yield an element's children of these tags, with those in frames and copies of replicates."""
        waiting: list[Placed] = [(element, Pose.identity(), class_name, "")]
        while waiting:
            top, outer, inherited, suffix = waiting.pop()
            if top is not element and top.tag in tags:
                yield top, outer, inherited, suffix
                continue
            inherited = top.attributes.get("childclass", inherited) if top is not element else inherited
            places = [("", outer)] if top is element else list(self._copies(top, outer))
            self.copies[:] = [sum(self.copies) + len(places) - 1]
            if self.copies[0] > MAX_COPIES:
                top.refuse(f"must make at most {MAX_COPIES} copies, with all others of the file")
            children = [child for child in top.children if child.tag in (*tags, "frame", "replicate")]
            waiting += [
                (child, place, inherited, suffix + more) for more, place in places for child in children
            ][::-1]

    def _copies(self, element: XmlElement, outer: Pose) -> Iterator[tuple[str, Pose]]:
        """Yield the poses of what is in a frame or a replicate, and what is added to names there."""
        if element.tag == "frame":
            yield "", outer @ self.pose(element)
            return
        (count,) = element.numbers("count", 1)
        if not 0 < count <= MAX_COPIES or count != int(count):
            element.refuse(f"must have a count from 1 to {MAX_COPIES}, got {count:g}")
        turn = self.angle * np.array(element.numbers("euler", 3, "0 0 0"))
        step = Pose(from_euler(turn, self.sequence), np.array(element.numbers("offset", 3, "0 0 0")))
        digits = len(str(int(count) - 1))
        place = outer
        for i in range(int(count)):
            yield f"{element.attributes.get('sep', '')}{i:0{digits}d}", place
            place = place @ step

    def pose(self, element: XmlElement) -> Pose:
        """Return an element's pose in its parent."""
        position = np.array(element.numbers("pos", 3, "0 0 0"))
        given = element.attributes.keys() & _TURNS.keys()
        if len(given) > 1:
            element.refuse(f"must have one of {', '.join(sorted(given))}")
        if not given:
            return Pose(np.eye(3), position)
        (name,) = given
        values = np.array(element.numbers(name, _TURNS[name]))
        if name == "euler":
            return Pose(from_euler(self.angle * values, self.sequence), position)
        if name == "quat":
            return Pose(from_quaternion(*_unit(element, values)), position)
        if name == "axisangle":
            return Pose(about(_unit(element, values[:3]), self.angle * values[3]), position)
        if name == "zaxis":
            return Pose(from_z_to(_unit(element, values)), position)
        return Pose(_from_axes(element, values), position)


#: An element's child, its pose in that element, its class, and what replication adds to its name.
Placed = tuple[XmlElement, Pose, str, str]


#: More copies than these are no chain that anybody looks at.
MAX_COPIES = 10_000


_TURNS = {"euler": 3, "quat": 4, "axisangle": 4, "zaxis": 3, "xyaxes": 6}


def _unit(element: XmlElement, vector: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(vector)
    if not size:
        element.refuse("must have a direction that is not zero")
    return np.asarray(vector / size)


def _from_axes(element: XmlElement, values: np.ndarray) -> np.ndarray:
    x = _unit(element, values[:3])
    y = _unit(element, values[3:] - (values[3:] @ x) * x)
    return np.column_stack([x, y, np.cross(x, y)])


def settings_of(root: XmlElement) -> Settings:
    """Return the settings of an MJCF model.

    Raises
    ------
    BadModel
        If a setting cannot be followed.
    """
    found: Attributes = {}
    for compiler in root.all("compiler"):
        found |= compiler.attributes
    said = XmlElement("compiler", found, next((c.line for c in root.all("compiler")), 0))
    if found.get("coordinate", "local") != "local":
        said.refuse("must have local coordinates, as MuJoCo 3 wants")
    sequence = found.get("eulerseq", "xyz")
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
        said.refuse(f"must have an eulerseq of three axes, got {sequence[:10]!r}")
    low, high = said.numbers("inertiagrouprange", 2, "0 1000000")
    return Settings(
        1.0 if found.get("angle") == "radian" else math.pi / 180,
        sequence,
        found.get("inertiafromgeom", "auto"),
        (low, high),
        _classes(root),
        found.get("autolimits", "true") == "true",
        tuple(_left_out(root, *options_of(root))),
        _step(*options_of(root)),
        _gravity(*options_of(root)),
        said,
    )


def options_of(root: XmlElement) -> tuple[XmlElement, XmlElement]:
    """Return a model's <option> and its <flag>, each with the attributes of all of its kind."""
    said, flags = XmlElement("option", {}, 0), XmlElement("flag", {}, 0)
    for option in root.all("option"):
        said = XmlElement("option", said.attributes | option.attributes, option.line)
        for flag in option.all("flag"):
            flags = XmlElement("flag", flags.attributes | flag.attributes, flag.line)
    return said, flags


def _step(said: XmlElement, flags: XmlElement) -> FileStep | None:
    """Return the step and the integrator, MuJoCo's own where the file says none."""
    integrator = said.attributes.get("integrator", "Euler")
    try:
        record = find_integrator(f"MuJoCo {integrator}")
    except ValueError:
        said.refuse(f"must have one of MuJoCo's integrators, got {shown(integrator)}")
    (timestep,) = said.numbers("timestep", 1, "0.002")
    if timestep <= 0:
        said.refuse(f"must have a timestep greater than 0, got {timestep:g}")
    if integrator == "Euler" and flags.attributes.get("eulerdamp") == "disable":
        record = find_integrator("semi_implicit_euler")
    return FileStep(timestep, integrator, record.name)


def _gravity(said: XmlElement, flags: XmlElement) -> tuple[float, ...]:
    if flags.attributes.get("gravity") == "disable":
        return (0.0, 0.0, 0.0)
    return tuple(said.numbers("gravity", 3, "0 0 -9.81"))


def _left_out(root: XmlElement, said: XmlElement, flags: XmlElement) -> Iterator[str]:
    """Yield what is left out of the surroundings; raises BadModel where springs are switched off."""
    for name in ("spring", "passive"):
        if flags.attributes.get(name) == "disable":
            flags.refuse(f'must not have {name}="disable", which switches springs off')
    if root.tag == "mujoco" and any(_gravity(said, flags)):
        yield "gravity is left out here: with it the chain sags and rings at other frequencies"
    if said.numbers("density", 1, "0")[0] or said.numbers("viscosity", 1, "0")[0]:
        yield "the fluid around is left out here: its drag and added mass lower frequencies"


def _classes(root: XmlElement) -> dict[str, dict[str, Attributes]]:
    """Return the defaults of every class, each with what it takes from the one around it."""
    found: dict[str, dict[str, Attributes]] = {"main": {}}
    for top in root.all("default"):
        waiting = [(top, found["main"], top.attributes.get("class", "main"))]
        while waiting:
            element, outer, name = waiting.pop()
            own = {tag: dict(values) for tag, values in outer.items()}
            for child in element.children:
                if child.tag != "default":
                    own[child.tag] = own.get(child.tag, {}) | child.attributes
            found[name] = own
            for child in element.all("default"):
                if "class" not in child.attributes:
                    child.refuse("must have a class")
                waiting.append((child, own, child.attributes["class"]))
    return found


# Mass, inertia and reach of an MJCF body: from its inertial, or from the solids that it is made of.


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


_MASSLESS = ("plane", "hfield")


def matter_of(
    settings: Settings, element: XmlElement, class_name: str
) -> tuple[Inertial, list[Floats], list[Solid], str]:
    """Return a body's mass and inertia, the ends of its geometry, its solids, and why they cannot be told."""
    extent: list[Floats] = []
    solids: list[Solid] = []
    why = ""
    for child, place, inherited, _ in settings.inside(element, class_name, "geom"):
        own = settings.with_defaults(child, "geom", inherited)
        kind = "mesh" if "mesh" in own.attributes else own.attributes.get("type", "sphere")
        if kind in _MASSLESS or (kind not in _SIZES and not _has_mass(settings, own)):
            continue
        if kind not in _SIZES or own.attributes.get("shellinertia") == "true":
            why = f"{own.where} must be a {', '.join(_SIZES)}, filled, or have its body's mass in <inertial>"
            continue
        part, ends = _geometry(settings, own, kind)
        ends = [place.point(end) for end in ends]
        extent += ends
        if settings.counts(own):
            solids.append(Solid(part.seen_from(place), tuple(ends)))
    given = element.first("inertial")
    if given is not None and settings.inertia_from_geometry != "true":
        return _given(settings, given), extent, [], ""
    if settings.inertia_from_geometry == "false":
        return joined([]), extent, [], ""
    return joined(each.inertial for each in solids), extent, solids, why


def compiled_masses(settings: Settings, bodies: Sequence[ModelBody]) -> list[ModelBody]:
    """Return bodies as the compiler's settings change them: all masses scaled to a total.

    Raises
    ------
    BadModel
        If a least mass or inertia, or the balance of inertias, would change a single body.
    """
    said = settings.compiler
    for name, sizes in (("boundmass", _own_mass), ("boundinertia", _own_inertia)):
        (least,) = said.numbers(name, 1, "0")
        light = next((body for body in bodies if least > 0 and sizes(body) < least), None)
        if light is not None:
            said.refuse(
                f"must have a {name} that no body is below, got {least:g}: body {light.name} has less"
            )
    if said.attributes.get("balanceinertia") == "true":
        odd = next((body for body in bodies if not _is_balanced(body)), None)
        if odd is not None:
            said.refuse(f"must have no balanceinertia, which changes the inertia of body {odd.name}")
    (total,) = said.numbers("settotalmass", 1, "-1")
    mass = sum(body.inertial.mass for body in bodies)
    if total <= 0 or not mass:
        return list(bodies)
    odd = next((body for body in bodies if body.refusal), None)
    if odd is not None:
        said.refuse(f"must have no settotalmass, for which every mass must be known: {odd.refusal}")
    share = total / mass
    return [
        replace(
            body,
            inertial=_scaled(body.inertial, share),
            solids=tuple(replace(each, inertial=_scaled(each.inertial, share)) for each in body.solids),
        )
        for body in bodies
    ]


def _scaled(own: Inertial, share: float) -> Inertial:
    return Inertial(own.mass * share, own.centre, own.inertia * share)


def _own_mass(body: ModelBody) -> float:
    return body.inertial.mass


def _own_inertia(body: ModelBody) -> float:
    return float(np.linalg.eigvalsh(body.inertial.inertia)[0])


def _is_balanced(body: ModelBody) -> bool:
    least, middle, most = np.linalg.eigvalsh(body.inertial.inertia)
    return bool(least + middle >= most * (1 - 1e-9))


def _has_mass(settings: Settings, geom: XmlElement) -> bool:
    said = "mass" if "mass" in geom.attributes else "density"
    return settings.counts(geom) and geom.numbers(said, 1, "1000")[0] > 0


def _given(settings: Settings, element: XmlElement) -> Inertial:
    pose = settings.pose(element)
    (mass,) = element.numbers("mass", 1)
    if mass < 0:
        element.refuse(f"must have a mass of at least 0, got {mass:g}")
    if "fullinertia" in element.attributes:
        xx, yy, zz, xy, xz, yz = element.numbers("fullinertia", 6)
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        matrix = np.diag(element.numbers("diaginertia", 3))
    return Inertial(mass, np.zeros(3), matrix).seen_from(pose)


def _geometry(settings: Settings, geom: XmlElement, kind: str) -> tuple[Inertial, list[Floats]]:
    """Return a solid in its body's frame, and the two ends of its long axis without round caps."""
    count = _SIZES[kind]
    pose = settings.pose(geom)
    ends = "fromto" in geom.attributes
    if ends and kind == "sphere":
        geom.refuse("must have no fromto")
    text = geom.attributes.get("size", "")
    size = geom.read("size", text, (1, 2, 3))
    if ends:
        points = np.array(geom.numbers("fromto", 6)).reshape(2, 3)
        length = float(np.linalg.norm(points[1] - points[0]))
        if not length:
            geom.refuse("must have two different points in fromto")
        pose = Pose(from_z_to((points[1] - points[0]) / length), points.mean(axis=0))
        size = [size[0]] * (count - 1) + [length / 2]
    if len(size) < count or min(size[:count]) <= 0:
        geom.refuse(f"must have {count} sizes above 0 as a {kind}, got {text[:40]!r}")
    mass = geom.numbers("mass", 1)[0] if "mass" in geom.attributes else None
    (density,) = geom.numbers("density", 1, "1000")
    if density < 0 or (mass or 0.0) < 0:
        geom.refuse("must have a mass and a density of at least 0")
    reach = [pose.point(point) for point in ends_of(kind, size)]
    return solid(kind, size[:count], mass, density).seen_from(pose), reach


# What acts on the joints of an MJCF model beside their own springs: servos, tendons, constraints.

_PLAIN_ACTUATORS = ("motor", "damper", "plugin", "adhesion")


#: Shortcuts that make a servo of every <general> of their class.
_SERVO_DEFAULTS = ("position", "velocity", "intvelocity", "muscle", "cylinder", "dcmotor")


def linear_stiffness(element: XmlElement) -> float:
    """Return the stiffness of a joint or tendon; in MuJoCo 4 it may be a polynomial of one term."""
    value, *more = element.numbers("stiffness", (1, 2, 3), "0")
    if any(more):
        element.refuse("must have a linear spring, got a stiffness with more than one number")
    if value < 0:
        element.refuse(f"must have a stiffness of at least 0, got {value:g}")
    return value


def linear_damping(element: XmlElement) -> float:
    """Return the damping of a joint or tendon; in MuJoCo 4 it may be a polynomial of one term."""
    value, *more = element.numbers("damping", (1, 2, 3), "0")
    if any(more):
        element.refuse("must have a linear damper, got a damping with more than one number")
    if value < 0:
        element.refuse(f"must have a damping of at least 0, got {value:g}")
    return value


def servo_dampers(root: XmlElement, settings: Settings) -> Iterator[tuple[str, float]]:
    """Yield the joints on which servos of velocity act, and their damping: kv gear²."""
    for actuators in root.all("actuator"):
        for element in actuators.children:
            if _is_damper(element, settings):
                own = settings.with_defaults(element, element.tag, "main")
                gain = _velocity_gain(own)
                (gear, *_) = own.numbers("gear", (1, 2, 3, 4, 5, 6), "1")
                yield own.attributes["joint"], gain * gear**2


def _velocity_gain(own: XmlElement) -> float:
    if own.tag == "velocity":
        return own.numbers("kv", 1, "1")[0]
    terms = own.numbers("biasprm", tuple(range(1, 11)), "0")
    return -terms[2] if len(terms) > 2 else 0.0


def _is_damper(element: XmlElement, settings: Settings) -> bool:
    """Whether a servo of one joint has a force of its velocity only, so that it is 0 at rest."""
    if element.tag not in ("velocity", "general"):
        return False
    own = settings.with_defaults(element, element.tag, "main")
    if "joint" not in own.attributes or _velocity_gain(own) < 0:
        return False
    if element.tag == "velocity":
        return True
    terms = own.numbers("biasprm", tuple(range(1, 11)), "0")
    return own.attributes.get("biastype") == "affine" and not any(terms[:2]) and not any(terms[3:])


def servos(root: XmlElement, settings: Settings) -> Iterator[tuple[str, str]]:
    """Yield the joints on which servos act, by themselves or through fixed tendons, and what to say of it."""
    joints = {
        tendon.attributes.get("name", ""): [part.attributes.get("joint", "") for part in tendon.all("joint")]
        for tendons in root.all("tendon")
        for tendon in tendons.all("fixed")
    }
    for element in _servo_elements(root, settings):
        names = [element.attributes.get(key, "") for key in ("joint", "jointinparent")]
        for name in filter(None, [*names, *joints.get(element.attributes.get("tendon", ""), [])]):
            yield name, f"{element.where} must not act on a hinge of the chain, like a spring"


def _servo_elements(root: XmlElement, settings: Settings) -> Iterator[XmlElement]:
    for actuators in root.all("actuator"):
        for element in actuators.children:
            if element.tag == "general":
                own = settings.with_defaults(element, "general", "main")
                tags = settings.classes[element.attributes.get("class", "main")].keys()
                inherited = "affine" if tags & set(_SERVO_DEFAULTS) else "none"
                if own.attributes.get("biastype", inherited) == "none":
                    continue
            if element.tag not in _PLAIN_ACTUATORS and not _is_damper(element, settings):
                yield element


def acted_sites(root: XmlElement, settings: Settings) -> Iterator[tuple[str, str]]:
    """Yield the sites that servos or spatial tendons with springs pull at, and what to say of it."""
    pulling = {element.attributes.get("tendon", ""): element for element in _servo_elements(root, settings)}
    for element in _servo_elements(root, settings):
        for key in ("site", "refsite", "cranksite", "slidersite"):
            if key in element.attributes:
                yield element.attributes[key], f"{element.where} must not act on a body of the chain"
    tied = _equality_tendons(root)
    for tendons in root.all("tendon"):
        for tendon in tendons.all("spatial"):
            own = settings.with_defaults(tendon, "tendon", "main")
            name = own.attributes.get("name", "")
            why = [key for key in ("stiffness", "armature", "frictionloss") if any(_terms(own, key))]
            why += ["an actuator"] if name and name in pulling else []
            why += ["an equality constraint"] if name and name in tied else []
            if why:
                for site in tendon.all("site"):
                    yield (
                        site.attributes.get("site", ""),
                        f"{tendon.where} must not act on the chain, as it does by {' and '.join(why)}",
                    )


def ties(root: XmlElement, settings: Settings) -> Iterator[ModelTie]:
    """Yield the fixed tendons of a model, of infinite stiffness where an equality constraint holds them."""
    holding = _equality_tendons(root)
    for tendons in root.all("tendon"):
        for i, element in enumerate(tendons.all("fixed")):
            tendon = settings.with_defaults(element, "tendon", "main")
            name = tendon.attributes.get("name", f"tendon {i + 1}")
            terms = tuple(
                (part.attributes.get("joint", ""), part.numbers("coef", 1)[0]) for part in tendon.all("joint")
            )
            stiffness = math.inf if name in holding else linear_stiffness(tendon)
            why = holding.get(name, "") or _why_not(tendon, stiffness)
            yield ModelTie(name, terms, stiffness, why, linear_damping(tendon))


def _why_not(tendon: XmlElement, stiffness: float) -> str:
    if _inertia_or_friction(tendon):
        return f"{tendon.where} must have no armature and no frictionloss, which no beam has"
    rest = tendon.numbers("springlength", (1, 2), "-1")
    if 0 < stiffness < math.inf and any(rest) and rest != [-1.0]:
        return f"{tendon.where} must be slack at rest: springlength 0"
    return ""


def _terms(tendon: XmlElement, name: str) -> list[float]:
    return [linear_stiffness(tendon)] if name == "stiffness" else tendon.numbers(name, 1, "0")


def _inertia_or_friction(tendon: XmlElement) -> bool:
    return any(tendon.numbers(name, 1, "0")[0] for name in ("armature", "frictionloss"))


def _equality_tendons(root: XmlElement) -> dict[str, str]:
    """Return the tendons that equality constraints act on, each with why it cannot be honoured, if so."""
    found: dict[str, str] = {}
    for constraints in root.all("equality"):
        for element in constraints.all("tendon"):
            if element.attributes.get("active") == "false":
                continue
            names = [element.attributes[key] for key in ("tendon1", "tendon2") if key in element.attributes]
            offset = element.numbers("polycoef", (1, 2, 3, 4, 5), "0")[0]
            why = f"{element.where} must hold one tendon, at its length at rest"
            found |= dict.fromkeys(names, why if offset or len(names) > 1 else "")
    return found


def held_ends(root: XmlElement, homes: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the bodies and joints that other constraints act on, and what to say of these.

    Parameters
    ----------
    root : XmlElement
    homes : mapping
        The body of each site.
    """
    for constraints in root.all("equality"):
        for element in constraints.all("connect", "weld", "joint"):
            if element.attributes.get("active") == "false":
                continue
            for end in ("body1", "body2", "joint1", "joint2"):
                if end in element.attributes:
                    yield element.attributes[end], element.where
            for end in ("site1", "site2"):
                if element.attributes.get(end) in homes:
                    yield homes[element.attributes[end]], element.where


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
        refusal = _why_not_read_mjcf(reader.settings, own, kind, stiffness) or reader.servos.get(name, "")
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


def _why_not_read_mjcf(settings: Settings, joint: XmlElement, kind: str, stiffness: float) -> str:
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
