"""What an MJCF model says once for all its elements: the compiler's settings and default classes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from beammodes.auditing.body_tree import FileStep
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.spatial import Pose, about, from_euler, from_quaternion, from_z_to
from beammodes.checks import shown
from beammodes.vibration.integrators import find_integrator

__all__ = ["Placed", "Settings", "settings_of"]

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
