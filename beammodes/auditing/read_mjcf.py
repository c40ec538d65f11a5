"""MJCF, MuJoCo's format, read without MuJoCo: bodies, joints, solids, fixed tendons.

In order: included files; settings and default classes; frames and replicates; masses; what acts on joints.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from beammodes.auditing.body_tree import (
    FileStep,
    Frame,
    Inertial,
    Model,
    ModelBody,
    ModelJoint,
    ModelRod,
    ModelTie,
    Shape,
    Solid,
    SpringPlace,
    about,
    ends_of,
    from_euler,
    from_quaternion,
    from_z_to,
    joined,
    solid,
)
from beammodes.auditing.bounded_xml import BadModel, UnexpandedModel, XmlElement, read_xml
from beammodes.auditing.mujoco_cable import (
    BARE,
    CABLE,
    CablePiece,
    cable_settings,
    expand_cables,
    settings_of,
    with_cable_springs,
)
from beammodes.auditing.mujoco_flex import MOST_POINTS, flexcomp_points, listed, ordered, rod_of_points
from beammodes.checks import shown
from beammodes.numerics.arrays import Floats
from beammodes.vibration.integrators import find_integrator

__all__ = ["include_files", "read_mjcf"]

_MOST_INCLUDED = 20
_MOST_BODIES = 5_000
_MOST_FLEXES = 50
#: More copies by replicates than these are no chain that anybody looks at.
_MAX_COPIES = 10_000

#: Elements that only MuJoCo can expand, or whose effect on a body's motion is not read, and why.
_UNREAD = {
    "composite": "only MuJoCo can expand it, but for cables",
    "flexcomp": 'a flex is judged as a rod only, with dim="1"',
    "attach": "only MuJoCo can expand it",
    "plugin": "what a plugin does is not read, but for mujoco.elasticity.cable",
}

_CONSTRAINTS = ("connect", "weld", "joint", "tendon")
#: Attributes of ties and constraints that name what they act on.
_NAMES = {"joint", "joint1", "joint2", "site", "site1", "site2", "body1", "body2"}

_TURNS = {"euler": 3, "quat": 4, "axisangle": 4, "zaxis": 3, "xyaxes": 6}
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
_MASSLESS = ("plane", "hfield")

#: What a servo of velocity damps.
_DAMPED = ("joint", "tendon")
_PLAIN_ACTUATORS = ("motor", "damper", "plugin", "adhesion")
#: Shortcuts that make a servo of every <general> of their class.
_SERVO_DEFAULTS = {"position", "velocity", "intvelocity", "muscle", "cylinder", "dcmotor"}

#: An element, the frame that its pose is given in, its class, and what replication adds to its name.
_Placed = tuple[XmlElement, Frame, str, str]


def read_mjcf(root: XmlElement, folder: Path) -> Model:
    """Return the bodies, joints and ties of an MJCF model, with the files of its folder that it includes.

    Honoured are frames, replicates, the compiler's angle, eulerseq, autolimits, inertiafromgeom,
    inertiagrouprange and settotalmass, default classes, explicit inertials, solids with mass or density,
    poses, hinges, slides and free joints, fixed tendons with stiffness, and equality constraints on these.
    Armature is inertia of a hinge's own rotation; servos of velocity without other terms are dampers. What
    cannot be honoured is refused where a chain needs it: composites and plugins other than cables, flexes
    other than rods, meshes, balls without a spring, dry friction, stops at rest, servos that act like
    springs, spatial tendons with springs.
    """
    include_files(root, folder)
    expand_cables(root)
    if root.tag not in ("mujoco", "mujocoinclude"):
        root.refuse("must be <mujoco>")
    for element in root.all("attach"):
        element.refuse(f"must be left out: {_UNREAD['attach']}")
    return _Reader(root).model()


def include_files(root: XmlElement, folder: Path) -> list[str]:
    """Put what <include> elements name in their place, as MuJoCo does; return the names."""
    inside, seen, names = folder.resolve(), set(), []
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
            if place in seen:
                child.refuse(f"must not include a file twice, got {shown(name)}")
            seen.add(place)
            names.append(name)
            if len(seen) > _MOST_INCLUDED:
                child.refuse(f"must be one of at most {_MOST_INCLUDED} files")
            try:
                found += read_xml(place, name).children[::-1]
            except OSError as error:
                child.refuse(f"must name a file that can be read: {shown(name)}: {error.strerror or error}")
            except BadModel as error:
                child.refuse(f"must name a file that can be read: {shown(name)}: {error}")
        element.children = children
        waiting += children
    return names


def _merged(elements: list[XmlElement], tag: str) -> XmlElement:
    """Return elements that say things once for the whole model as one."""
    found = XmlElement(tag, {}, 0)
    for each in elements:
        found = XmlElement(tag, found.attributes | each.attributes, each.line)
    return found


def _classes(root: XmlElement) -> dict[str, dict[str, dict[str, str]]]:
    """Return each class's default attributes by tag, with what it takes from the class around it."""
    found: dict[str, dict[str, dict[str, str]]] = {"main": {}}
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


class _Reader:
    """The settings of one file, and what has been read of it."""

    def __init__(self, root: XmlElement) -> None:
        self.root = root
        options = list(root.all("option"))
        self.option = _merged(options, "option")
        self.flags = _merged([flag for option in options for flag in option.all("flag")], "flag")
        self.compiler = _merged(list(root.all("compiler")), "compiler")
        said = self.compiler.attributes
        if said.get("coordinate", "local") != "local":
            self.compiler.refuse("must have local coordinates, as MuJoCo 3 wants")
        self.sequence = said.get("eulerseq", "xyz")
        if len(self.sequence) != 3 or set(self.sequence.lower()) - set("xyz"):
            self.compiler.refuse(f"must have an eulerseq of three axes, got {self.sequence[:10]!r}")
        #: Radians in one of the file's units of angle.
        self.angle = 1.0 if said.get("angle") == "radian" else math.pi / 180
        #: First and last group of geometry whose mass counts.
        self.groups = self.compiler.numbers("inertiagrouprange", 2, "0 1000000")
        self.inertia_from_geometry = said.get("inertiafromgeom", "auto")
        self.automatic_limits = said.get("autolimits", "true") == "true"
        self.classes = _classes(root) | {BARE: {}}
        self.cables = cable_settings(root)
        self.cable_pieces: dict[int, CablePiece] = {}
        self.copies = 0
        # A file that others include takes its step and its gravity from these.
        self.alone = root.tag == "mujoco"
        self.surroundings = list(self._surroundings())
        self.step = self._step()
        self.bodies: list[ModelBody] = []
        self.frames: list[Frame] = []
        self.notes: list[str] = []
        self.held_tendons = self._held_tendons()
        #: Damping by servos, of joints and tendons by name.
        self.dampers: dict[tuple[str, str], float] = {}
        self.servos: list[XmlElement] = []
        self._sort_actuators()
        self.acted_joints = dict(self._acted_joints())
        #: Joints that an equality constraint holds where they are, and that constraint.
        self.locked = dict(self._locked_joints())
        self.acted_sites = dict(self._acted_sites())
        #: Flexcomps of rods: the element, the index of its body, its own and the body's frame, its name.
        self.flexes: list[tuple[XmlElement, int, Frame, Frame, str]] = []
        self.ground: list[Shape] = []
        #: Names in the file of which replicates make copies.
        self.copied: set[str] = set()
        #: The body of each site.
        self.homes: dict[str, str] = {}

    def model(self) -> Model:
        """Return what the file holds."""
        bare = self.root.tag == "mujocoinclude" and self.root.first("worldbody") is None
        for world in [self.root] if bare else self.root.all("worldbody"):
            self._read_bodies(world)
        self._check_copies()
        self.bodies, cables = with_cable_springs(self.bodies, self.frames, self.cable_pieces)
        return Model(
            tuple(self._compiled()),
            tuple(self._ties()),
            tuple(self._held_ends()),
            (*self.notes, *self.surroundings),
            self.step if self.alone else None,
            self._gravity() if self.alone else np.zeros(3),
            hint=self._hint(),
            given=tuple(cables),
            rods=tuple(self._rods()),
            ground=self.ground,
            apart=frozenset(self._apart()),
            neighbours_touch=self.flags.attributes.get("filterparent") == "disable",
        )

    def _apart(self) -> Iterator[frozenset[str]]:
        """Yield pairs of bodies that make no contact."""
        for element in self._within("contact", "exclude"):
            yield frozenset(element.attributes.get(key, "") for key in ("body1", "body2"))

    def _hint(self) -> str:
        joints = [joint for body in self.bodies for joint in body.joints]
        name = next((joint.name for joint in joints if joint.kind == "hinge"), "")
        if not name or any(joint.stiffness for joint in joints):
            return ""
        return f"no joint has a stiffness: MJCF has a spring as that attribute of a joint, such as {name}"

    def _check_copies(self) -> None:
        """Refuse ties and constraints on what is copied: to which copies they belong only MuJoCo tells."""
        for outer, tags in (("tendon", ("fixed", "spatial")), ("equality", _CONSTRAINTS)):
            for element in self._within(outer, *tags):
                parts = [element, *element.children]
                named = [value for part in parts for key, value in part.attributes.items() if key in _NAMES]
                odd = next((name for name in named if name in self.copied), None)
                if odd is not None:
                    raise UnexpandedModel(
                        f"{element.where} must name nothing that is copied by <replicate>, got {shown(odd)}"
                    )

    # Options.

    def _step(self) -> FileStep:
        """Return the step and the integrator, MuJoCo's own where the file says none."""
        integrator = self.option.attributes.get("integrator", "Euler")
        try:
            record = find_integrator(f"MuJoCo {integrator}")
        except ValueError:
            self.option.refuse(f"must have one of MuJoCo's integrators, got {shown(integrator)}")
        timestep = self.option.number("timestep", "0.002")
        if timestep <= 0:
            self.option.refuse(f"must have a timestep greater than 0, got {timestep:g}")
        if integrator == "Euler" and self.flags.attributes.get("eulerdamp") == "disable":
            record = find_integrator("semi_implicit_euler")
        return FileStep(timestep, integrator, record.name)

    def _gravity(self) -> Floats:
        off = self.flags.attributes.get("gravity") == "disable"
        return np.zeros(3) if off else np.array(self.option.numbers("gravity", 3, "0 0 -9.81"))

    def _surroundings(self) -> Iterator[str]:
        """Yield what is left out of the surroundings; refuse springs that are switched off."""
        for name in ("spring", "passive"):
            if self.flags.attributes.get(name) == "disable":
                self.flags.refuse(f'must not have {name}="disable", which switches springs off')
        if self.option.number("density", "0") or self.option.number("viscosity", "0"):
            yield "the fluid around is left out here: its drag and added mass lower frequencies"

    # Elements: their defaults and where they stand.

    def _with_defaults(self, element: XmlElement, tag: str, class_name: str = "main") -> XmlElement:
        """Return an element with the attributes that it takes from its class."""
        name = element.attributes.get("class", class_name)
        if name not in self.classes:
            element.refuse(f"must have a class that <default> defines, got {name[:40]!r}")
        return replace(element, attributes=self.classes[name].get(tag, {}) | element.attributes)

    def _inside(self, element: XmlElement, class_name: str, *tags: str) -> Iterator[_Placed]:
        """Yield an element's children of these tags, with those in frames and copies of replicates."""
        waiting: list[_Placed] = [(element, Frame(), class_name, "")]
        while waiting:
            top, outer, inherited, suffix = waiting.pop()
            if top is not element and top.tag in tags:
                yield top, outer, inherited, suffix
                continue
            places = [("", outer)]
            if top is not element:
                inherited = top.attributes.get("childclass", inherited)
                places = list(self._places(top, outer))
            self.copies += len(places) - 1
            if self.copies > _MAX_COPIES:
                top.refuse(f"must make at most {_MAX_COPIES} copies, with all others of the file")
            children = list(top.all(*tags, "frame", "replicate"))
            waiting += [
                (child, place, inherited, suffix + more) for more, place in places for child in children
            ][::-1]

    def _places(self, element: XmlElement, outer: Frame) -> Iterator[tuple[str, Frame]]:
        """Yield where what is in a frame or a replicate stands, and what is added to names there."""
        if element.tag == "frame":
            yield "", outer @ self._pose(element)
            return
        count = element.number("count")
        if not 0 < count <= _MAX_COPIES or count != int(count):
            element.refuse(f"must have a count from 1 to {_MAX_COPIES}, got {count:g}")
        turn = self.angle * np.array(element.numbers("euler", 3, "0 0 0"))
        step = Frame(from_euler(turn, self.sequence), np.array(element.numbers("offset", 3, "0 0 0")))
        digits = len(str(int(count) - 1))
        for i in range(int(count)):
            yield f"{element.attributes.get('sep', '')}{i:0{digits}d}", outer
            outer = outer @ step

    def _pose(self, element: XmlElement) -> Frame:
        """Return an element's frame in its parent's."""
        position = np.array(element.numbers("pos", 3, "0 0 0"))
        given = sorted(element.attributes.keys() & _TURNS.keys())
        if len(given) > 1:
            element.refuse(f"must have one of {', '.join(given)}")
        return Frame(self._rotation(element, given[0]), position) if given else Frame(position=position)

    def _rotation(self, element: XmlElement, name: str) -> Floats:
        values = np.array(element.numbers(name, _TURNS[name]))
        if name == "euler":
            return from_euler(self.angle * values, self.sequence)
        if name == "quat":
            return from_quaternion(*element.direction(values, "direction"))
        first = element.direction(values[:3], "direction")
        if name == "axisangle":
            return about(first, self.angle * values[3])
        if name == "zaxis":
            return from_z_to(first)
        second = element.direction(values[3:] - (values[3:] @ first) * first, "direction")
        return np.column_stack([first, second, np.cross(first, second)])

    # Bodies and their matter.

    def _read_bodies(self, world: XmlElement) -> None:
        """Read the bodies below an element, without recursion: a chain nests as deep as it is long."""
        waiting = [(*found, -1, Frame()) for found in self._inside(world, "main", "body")][::-1]
        self._note_flexes(world, "main", -1, Frame(), "")
        for child, place, inherited, _ in self._inside(world, "main", "geom"):
            self.ground += self._of_ground(self._with_defaults(child, "geom", inherited), place)
        for odd, *_ in self._inside(world, "main", *_UNREAD):
            if _is_rod(odd):
                continue
            self.notes.append(_left_out(odd, "is left out here"))
        while waiting:
            element, place, class_name, suffix, parent, outer = waiting.pop()
            class_name = element.attributes.get("childclass", class_name)
            frame = outer @ place @ self._pose(element)
            index = len(self.bodies)
            self._note_flexes(element, class_name, index, frame, suffix)
            self.bodies.append(self._body(element, parent, frame, class_name, suffix))
            self.frames.append(frame)
            if index > _MOST_BODIES:
                element.refuse(f"must be one of at most {_MOST_BODIES} bodies")
            waiting += [
                (child, at, inner, suffix + more, index, frame)
                for child, at, inner, more in self._inside(element, class_name, "body")
            ][::-1]

    def _of_ground(self, geom: XmlElement, place: Frame) -> list[Shape]:
        kind = geom.attributes.get("type", "sphere")
        if kind == "plane" and "mesh" not in geom.attributes:
            frame, size = self._pose(geom), [0.0]
        elif kind in _SIZES and "mesh" not in geom.attributes:
            _, frame, size = self._geometry(geom, kind)
        else:
            return []
        return [shape.seen_from(frame).seen_from(place) for shape in self._shapes(geom, kind, size)]

    def _body(
        self, element: XmlElement, parent: int, frame: Frame, class_name: str, suffix: str
    ) -> ModelBody:
        own_name = element.attributes.get("name", f"body on line {element.line}")
        name = own_name + suffix
        if suffix:
            self.copied.add(own_name)
        cable = self._cable_piece(element, class_name, suffix)
        if cable is not None:
            self.cable_pieces[len(self.bodies)] = cable
        odd = next(
            (
                found
                for found, *_ in self._inside(element, class_name, *_UNREAD)
                if cable is None or found.tag != "plugin"
            ),
            None,
        )
        sites = [site.attributes.get("name", "") for site, *_ in self._inside(element, class_name, "site")]
        self.homes |= dict.fromkeys(sites, name)
        self.copied |= set(sites) if suffix else set()
        matter = self._matter(element, class_name)
        refusals = [_left_out(odd, "must be left out") if odd else ""]
        refusals += [self.acted_sites.get(site, "") for site in sites] + [matter.refusal]
        found = replace(matter, name=name, parent=parent, refusal=next(filter(None, refusals), ""))
        above = self.bodies[parent].moves_with if parent >= 0 else -1
        joints = tuple(
            self._joint(joint, frame @ at, inner, f"joint {i} of {own_name}", suffix, more)
            for i, (joint, at, inner, more) in enumerate(
                self._inside(element, class_name, "joint", "freejoint"), start=1
            )
        )
        self.notes += [
            f"joint {j.name} is held by {self.locked[j.name]}" for j in joints if j.name in self.locked
        ]
        moves_with, moves_on = (len(self.bodies), above) if joints else (above, -1)
        if not joints and above >= 0:
            moves_on = self.bodies[above].moves_on
        return replace(
            found.placed(frame),
            joints=tuple(j for j in joints if j.name not in self.locked),
            moves_with=moves_with,
            moves_on=moves_on,
        )

    def _note_flexes(
        self, element: XmlElement, class_name: str, index: int, frame: Frame, suffix: str
    ) -> None:
        for flex, place, _, more in self._inside(element, class_name, "flexcomp"):
            if _is_rod(flex):
                name = flex.attributes.get("name", f"flexcomp on line {flex.line}") + suffix + more
                self.flexes.append((flex, index, frame @ place @ self._pose(flex), frame, name))
                if len(self.flexes) > _MOST_FLEXES:
                    flex.refuse(f"must be one of at most {_MOST_FLEXES} rods")

    def _rods(self) -> Iterator[ModelRod]:
        """Yield the rods that flexes of dim 1 are, made by a flexcomp or of bodies."""
        for flex, parent, frame, outer, name in self.flexes:
            try:
                yield self._rod_of_points(flex, parent, frame, outer, name)
            except BadModel as error:
                yield _no_rod(name, error)
        for flex in self._within("deformable", "flex"):
            if not _is_rod(flex):
                continue
            try:
                yield self._rod_of_bodies(flex)
            except BadModel as error:
                yield _no_rod(flex.attributes.get("name", ""), error)

    def _rod_of_points(
        self, flex: XmlElement, parent: int, frame: Frame, outer: Frame, name: str
    ) -> ModelRod:
        points, elements, pinned = flexcomp_points(flex)
        order = ordered(flex, elements, len(points))
        share = flex.at_least_0("mass", flex.number("mass", "1")) / len(points)
        rod = ModelRod(
            name,
            np.array([frame.point(points[i]) for i in order]),
            np.full(len(points), share),
            tuple(pinned[i] for i in order),
            tuple(f"{name}_{i}" for i in order),
            refusal=self._why_no_rod(flex, parent),
        )
        return rod_of_points(flex, rod, outer.rotation)

    def _why_no_rod(self, flex: XmlElement, parent: int) -> str:
        dof = flex.attributes.get("dof", "full")
        if dof != "full":
            return f"{flex.where} must have a dof of full, got {shown(dof)}"
        if flex.attributes.get("rigid") == "true":
            return f"{flex.where} must not be rigid"
        if flex.first("plugin") is not None:
            return f"{flex.where} must have no plugin"
        return (
            "" if self._is_still(parent) else f"{flex.where} must be on the ground, or on what does not move"
        )

    def _is_still(self, index: int) -> bool:
        while index >= 0:
            if self.bodies[index].joints:
                return False
            index = self.bodies[index].parent
        return True

    def _rod_of_bodies(self, flex: XmlElement) -> ModelRod:
        """Return the rod of a flex whose points are bodies on three slides, or on what does not move."""
        names = flex.attributes.get("body", "").split(maxsplit=2 * MOST_POINTS)
        count = len(names)
        vertices = np.array(flex.read("vertex", flex.attributes.get("vertex", "0 " * 3 * count), 3 * count))
        elements = [int(i) for i in listed(flex, "element", 2).ravel()]
        order = ordered(flex, elements, count)
        index = {body.name: i for i, body in enumerate(self.bodies)} | {"world": -1}
        unknown = next((name for name in names if name not in index), None)
        if unknown is not None:
            flex.refuse(f"must be of bodies of the model, got {shown(unknown)}")
        homes = [index[names[i]] for i in order]
        frames = [self.frames[home] if home >= 0 else Frame() for home in homes]
        points = [at.point(vertices.reshape(-1, 3)[i]) for at, i in zip(frames, order, strict=True)]
        held = tuple(map(self._is_still, homes))
        masses = self._masses_of_points(homes, held)
        odd = next((names[i] for i, mass in zip(order, masses, strict=True) if math.isnan(mass)), None)
        refusal = self._why_no_rod(flex, -1)
        if odd is not None and not refusal:
            refusal = f"{flex.where} must be of bodies on three slides, or on what does not move, not {odd}"
        rod = ModelRod(
            flex.attributes.get("name", f"flex on line {flex.line}"),
            np.array(points),
            masses,
            held,
            tuple(names[i] for i in order),
            refusal=refusal,
        )
        return rod_of_points(flex, rod, frames[0].rotation)

    def _masses_of_points(self, homes: Sequence[int], held: Sequence[bool]) -> Floats:
        """Return the masses that points move, NaN if not as points; held ones are as heavy as most."""
        carried = [body.inertial.mass for body in self.bodies]
        free = [body.joints == () for body in self.bodies]
        for i in range(len(self.bodies) - 1, -1, -1):
            parent = self.bodies[i].parent
            if parent >= 0:
                carried[parent] += carried[i] if free[i] else math.nan
        masses = np.array(
            [
                0.0 if still else carried[i] * self._moves_as_a_point(i)
                for i, still in zip(homes, held, strict=True)
            ]
        )
        moving = masses[~np.array(held)]
        masses[np.array(held)] = np.nanmedian(moving) if np.isfinite(moving).any() else 0.0
        return masses

    def _moves_as_a_point(self, index: int) -> float:
        """Return 1 for a body on three slides at right angles and nothing else, else NaN."""
        body = self.bodies[index]
        axes = np.array([joint.axis for joint in body.joints])
        slides = [
            joint.kind == "slide" and not joint.is_sprung and not joint.armature for joint in body.joints
        ]
        square = len(axes) == 3 and np.abs(axes @ axes.T - np.eye(3)).max() < 1e-6
        odd = body.refusal or any(joint.refusal for joint in body.joints)
        return 1.0 if all(slides) and square and not odd and self._is_still(body.parent) else math.nan

    def _cable_piece(self, element: XmlElement, class_name: str, suffix: str) -> CablePiece | None:
        """Return what a body is in a cable, None if the plugin of cables does not move it."""
        plugin = element.first("plugin")
        if plugin is None:
            return None
        name = plugin.attributes.get("instance")
        if name is None and plugin.attributes.get("plugin") == CABLE:
            # Bodies with a plugin each are cables of one body each.
            instance, settings = f"byte {plugin.start} of {plugin.file}{suffix}", settings_of(plugin)
        elif name in self.cables:
            instance, settings = f"instance {name}{suffix}", self.cables[name]
        else:
            return None
        first = next(self._inside(element, class_name, "geom"), None)
        kind, size = "", tuple[float, ...]()
        if first is not None:
            geom = self._with_defaults(first[0], "geom", first[2])
            kind = "mesh" if "mesh" in geom.attributes else geom.attributes.get("type", "sphere")
            if kind in ("capsule", "cylinder", "box"):
                sizes = tuple(geom.numbers("size", (1, 2, 3)))
                size = sizes[1:3] if kind == "box" else sizes[:1]
        return CablePiece(instance, settings, plugin.where, kind, size)

    def _matter(self, element: XmlElement, class_name: str) -> ModelBody:
        """Return a body by its <inertial> or its solids, in its own frame."""
        extent: list[Floats] = []
        solids: list[Solid] = []
        shapes: list[Shape] = []
        caps, refusal = 0.0, ""
        for child, place, inherited, _ in self._inside(element, class_name, "geom"):
            geom = self._with_defaults(child, "geom", inherited)
            kind = "mesh" if "mesh" in geom.attributes else geom.attributes.get("type", "sphere")
            if kind in _MASSLESS:
                continue
            counts = self.groups[0] <= geom.number("group", "0") <= self.groups[1]
            if kind not in _SIZES:
                said = "mass" if "mass" in geom.attributes else "density"
                if not counts or geom.number(said, "1000") <= 0:
                    continue
            if kind not in _SIZES or geom.attributes.get("shellinertia") == "true":
                needed = f"must be a {', '.join(_SIZES)}, filled, or have its body's mass in <inertial>"
                refusal = f"{geom.where} {needed}"
                continue
            found, frame, size = self._geometry(geom, kind)
            ends = place.points(frame.points(found.ends))
            extent += ends
            shapes += [shape.seen_from(frame).seen_from(place) for shape in self._shapes(geom, kind, size)]
            if counts:
                solids.append(Solid(found.inertial.seen_from(frame).seen_from(place), ends))
                if kind == "capsule":
                    # Two half balls beside a tube of length 2 h: 4r/3 to 2h + 4r/3.
                    caps += found.inertial.mass * size[0] / (1.5 * size[1] + size[0])
        given = element.first("inertial")
        if given is not None and self.inertia_from_geometry != "true":
            return ModelBody("", -1, self._inertial(given), extent, shapes=shapes)
        if self.inertia_from_geometry == "false":
            return ModelBody("", -1, joined([]), extent, shapes=shapes)
        inertial = joined(s.inertial for s in solids)
        return ModelBody("", -1, inertial, extent, refusal=refusal, solids=solids, shapes=shapes, caps=caps)

    def _shapes(self, geom: XmlElement, kind: str, size: list[float]) -> list[Shape]:
        """Return what a geometry takes part in contacts with about its middle, if in any."""
        bits = (int(geom.number("contype", "1")), int(geom.number("conaffinity", "1")))
        off = self.flags.attributes.get("contact") == "disable" or not any(bits)
        return [] if off else [Shape.of(kind, size, bits)]

    def _inertial(self, element: XmlElement) -> Inertial:
        frame = self._pose(element)
        mass = element.at_least_0("mass", element.number("mass"))
        if "fullinertia" in element.attributes:
            moments = element.numbers("fullinertia", 6)
        else:
            moments = [*element.numbers("diaginertia", 3), 0.0, 0.0, 0.0]
        return Inertial.of(mass, moments).seen_from(frame)

    def _geometry(self, geom: XmlElement, kind: str) -> tuple[Solid, Frame, list[float]]:
        """Return a solid about its middle, the frame of its middle in its body's, and its sizes."""
        count = _SIZES[kind]
        frame = self._pose(geom)
        by_ends = "fromto" in geom.attributes
        if by_ends and kind == "sphere":
            geom.refuse("must have no fromto")
        text = geom.attributes.get("size", "")
        size = geom.read("size", text, (1, 2, 3))
        if by_ends:
            points = np.array(geom.numbers("fromto", 6)).reshape(2, 3)
            length = float(np.linalg.norm(points[1] - points[0]))
            if not length:
                geom.refuse("must have two different points in fromto")
            frame = Frame(from_z_to((points[1] - points[0]) / length), points.mean(axis=0))
            size = [size[0]] * (count - 1) + [length / 2]
        if len(size) < count or min(size[:count]) <= 0:
            geom.refuse(f"must have {count} sizes above 0 as a {kind}, got {text[:40]!r}")
        mass = geom.number("mass") if "mass" in geom.attributes else None
        density = geom.number("density", "1000")
        if density < 0 or (mass or 0.0) < 0:
            geom.refuse("must have a mass and a density of at least 0")
        found = Solid(solid(kind, size[:count], mass, density), tuple(ends_of(kind, size)))
        return found, frame, size[:count]

    def _compiled(self) -> list[ModelBody]:
        """Return the bodies with masses scaled to a total; refuse settings that change a single body."""
        said, bodies = self.compiler, self.bodies
        inertias = np.array([body.inertial.inertia for body in bodies]).reshape(-1, 3, 3)
        moments = np.linalg.eigvalsh(inertias).tolist()
        sizes = {
            "boundmass": [body.inertial.mass for body in bodies],
            "boundinertia": [m[0] for m in moments],
        }
        for name, values in sizes.items():
            least = said.number(name, "0")
            light = next((b.name for b, value in zip(bodies, values, strict=True) if value < least), None)
            if least > 0 and light is not None:
                said.refuse(f"must have a {name} that no body is below, got {least:g}: body {light} has less")
        if said.attributes.get("balanceinertia") == "true":
            for body, (low, middle, high) in zip(bodies, moments, strict=True):
                if low + middle < high * (1 - 1e-9):
                    said.refuse(f"must have no balanceinertia, which changes the inertia of body {body.name}")
        total, mass = said.number("settotalmass", "-1"), sum(sizes["boundmass"])
        if total <= 0 or not mass:
            return bodies
        odd = next((body.refusal for body in bodies if body.refusal), "")
        if odd:
            said.refuse(f"must have no settotalmass, for which every mass must be known: {odd}")
        share = total / mass
        return [
            replace(
                body,
                inertial=body.inertial.scaled(share),
                solids=[Solid(each.inertial.scaled(share), each.ends) for each in body.solids],
            )
            for body in bodies
        ]

    # Joints, and what acts on them beside their own springs.

    def _joint(
        self, child: XmlElement, frame: Frame, class_name: str, fallback: str, suffix: str, more: str
    ) -> ModelJoint:
        own, kind = child, "free"
        if child.tag == "joint":
            own = self._with_defaults(child, "joint", class_name)
            kind = own.attributes.get("type", "hinge")
        name = own.attributes.get("name", fallback)
        if suffix or more:
            self.copied.add(name)
        axis = child.direction(own.numbers("axis", 3, "0 0 1"))
        position = frame.point(np.array(own.numbers("pos", 3, "0 0 0")))
        stiffness = _linear(own, "stiffness", "spring")
        rest = self._rest(own, kind) if stiffness else 0.0
        return ModelJoint(
            f"{name}{suffix}{more}",
            kind,
            frame.rotation @ axis,
            position,
            stiffness,
            self._why_not(own, kind, stiffness, rest) or self.acted_joints.get(name, ""),
            _linear(own, "damping", "damper") + self.dampers.get(("joint", name), 0.0),
            child.at_least_0("armature", own.number("armature", "0")),
            _place(child, kind, copied=bool(suffix + more)),
            rest=rest * (self.angle if kind == "hinge" else 1.0),
        )

    def _rest(self, joint: XmlElement, kind: str) -> float:
        """Return where a spring is relaxed, from the file's pose, in the file's units; a ball's is there."""
        return (
            joint.number("springref", "0") - joint.number("ref", "0") if kind in ("hinge", "slide") else 0.0
        )

    def _why_not(self, joint: XmlElement, kind: str, stiffness: float, rest: float) -> str:
        if kind not in ("hinge", "slide", "free", "ball"):
            return f"{joint.where} must be a hinge, a slide, a ball or free, got type {shown(kind)}"
        if kind == "free" and stiffness:
            return f"{joint.where} must have no spring, or be a <freejoint>, which takes no defaults"
        if joint.number("frictionloss", "0"):
            return f"{joint.where} must have no frictionloss: dry friction holds a hinge still"
        if min(joint.numbers("springdamper", 2, "0 0")) > 0:
            return f"{joint.where} must have its stiffness said, not left to springdamper"
        reference = joint.number("ref", "0") + rest
        if kind != "free" and self._is_limited(joint):
            low, high = joint.numbers("range", 2, "0 0")
            # The range of a ball is its largest angle; what is said as the least is not used.
            if not (-1.0 if kind == "ball" else low) < reference < high:
                return f"{joint.where} must be at rest within its range, not at a stop or beyond"
        return ""

    def _within(self, outer: str, *tags: str) -> Iterator[XmlElement]:
        return (child for section in self.root.all(outer) for child in section.all(*tags))

    def _sort_actuators(self) -> None:
        """Sort actuators: dampers of one joint, servos that act like springs, and others, which do not."""
        for element in (each for section in self.root.all("actuator") for each in section.children):
            if element.tag in ("velocity", "general"):
                own = self._with_defaults(element, element.tag)
                damping = self._damping(own)
                if damping is not None:
                    which, name = next((key, own.attributes[key]) for key in _DAMPED if key in own.attributes)
                    self.dampers[which, name] = self.dampers.get((which, name), 0.0) + damping
                    continue
                tags = self.classes[element.attributes.get("class", "main")].keys()
                inherited = "affine" if tags & _SERVO_DEFAULTS else "none"
                if element.tag == "general" and own.attributes.get("biastype", inherited) == "none":
                    continue
            if element.tag not in _PLAIN_ACTUATORS:
                self.servos.append(element)

    def _damping(self, own: XmlElement) -> float | None:
        """Return kv gear² of a servo whose force is one of velocity only, at a joint or tendon; else None."""
        if not any(key in own.attributes for key in _DAMPED):
            return None
        if own.tag == "velocity":
            gain = own.number("kv", "1")
        else:
            terms = [*own.numbers("biasprm", tuple(range(1, 11)), "0"), 0.0, 0.0]
            if own.attributes.get("biastype") != "affine" or any(terms[:2]) or any(terms[3:]):
                return None
            gain = -terms[2]
        return gain * own.numbers("gear", (1, 2, 3, 4, 5, 6), "1")[0] ** 2 if gain >= 0 else None

    def _acted_joints(self) -> Iterator[tuple[str, str]]:
        """Yield the joints on which servos act, alone or through fixed tendons, and what to say of it."""
        joints = {
            tendon.attributes.get("name", ""): [
                part.attributes.get("joint", "") for part in tendon.all("joint")
            ]
            for tendon in self._within("tendon", "fixed")
        }
        for element in self.servos:
            names = [element.attributes.get(key, "") for key in ("joint", "jointinparent")]
            for name in filter(None, [*names, *joints.get(element.attributes.get("tendon", ""), [])]):
                yield (
                    name,
                    f"{element.where} must not act on a hinge of the chain, like a spring: if it holds that "
                    "joint, say by boundary what the ends are; else give the hinge its gain as stiffness",
                )
        for element in self._within("equality", "joint"):
            # Two hinges that turn as one are no longer two; one that is held elsewhere is no hinge at rest.
            given, offset = element.attributes, element.numbers("polycoef", (1, 2, 3, 4, 5), "0")[0]
            if given.get("active") == "false" or ("joint2" not in given and not offset):
                continue
            why = "must not tie hinges of the chain, but for one that a motor holds as you say by boundary"
            for key in given.keys() & {"joint1", "joint2"}:
                yield given[key], f"{element.where} {why}"

    def _acted_sites(self) -> Iterator[tuple[str, str]]:
        """Yield the sites that servos or spatial tendons with springs pull at, and what to say of it."""
        for element in self.servos:
            for key in ("site", "refsite", "cranksite", "slidersite"):
                if key in element.attributes:
                    yield element.attributes[key], f"{element.where} must not act on a body of the chain"
        pulling = {element.attributes.get("tendon", "") for element in self.servos}
        for tendon in self._within("tendon", "spatial"):
            own = self._with_defaults(tendon, "tendon")
            name = own.attributes.get("name", "")
            why = ["stiffness"] if _linear(own, "stiffness", "spring") else []
            why += [key for key in ("armature", "frictionloss") if own.number(key, "0")]
            why += ["an actuator"] if name and name in pulling else []
            why += ["a limit of its length"] if self._is_limited(own) else []
            why += ["an equality constraint"] if name and name in self.held_tendons else []
            for site in tendon.all("site") if why else ():
                refusal = f"{tendon.where} must not act on the chain, as it does by {' and '.join(why)}"
                yield site.attributes.get("site", ""), refusal

    def _held_tendons(self) -> dict[str, str]:
        """Return the tendons that equality constraints act on, each with why it cannot be honoured, if so."""
        found: dict[str, str] = {}
        for element in self._within("equality", "tendon"):
            if element.attributes.get("active") == "false":
                continue
            names = [element.attributes[key] for key in ("tendon1", "tendon2") if key in element.attributes]
            offset = element.numbers("polycoef", (1, 2, 3, 4, 5), "0")[0]
            why = f"{element.where} must hold one tendon, at its length at rest"
            found |= dict.fromkeys(names, why if offset or len(names) > 1 else "")
        return found

    def _ties(self) -> Iterator[ModelTie]:
        """Yield the fixed tendons, of infinite stiffness where an equality constraint holds them."""
        for section in self.root.all("tendon"):
            for i, element in enumerate(section.all("fixed"), start=1):
                tendon = self._with_defaults(element, "tendon")
                name = tendon.attributes.get("name", f"tendon {i}")
                terms = tuple(
                    (part.attributes.get("joint", ""), part.number("coef")) for part in tendon.all("joint")
                )
                held = name in self.held_tendons
                stiffness = math.inf if held else _linear(tendon, "stiffness", "spring")
                refusal = self.held_tendons.get(name, "")
                rest = tendon.numbers("springlength", (1, 2), "-1")
                if not refusal and any(tendon.number(key, "0") for key in ("armature", "frictionloss")):
                    refusal = f"{tendon.where} must have no armature and no frictionloss, which no beam has"
                elif not refusal and 0 < stiffness < math.inf and any(rest) and rest != [-1.0]:
                    refusal = f"{tendon.where} must be slack at rest: springlength 0"
                elif not refusal and not self._is_slack(tendon):
                    refusal = f"{tendon.where} must be at rest within its range, not at a stop or beyond"
                damping = _linear(tendon, "damping", "damper") + self.dampers.get(("tendon", name), 0.0)
                yield ModelTie(name, terms, stiffness, refusal, damping, _place(element))

    def _is_slack(self, tendon: XmlElement) -> bool:
        """Return True if no limit of a fixed tendon acts at rest, where its length is 0."""
        low, high = tendon.numbers("range", 2, "0 0")
        return not self._is_limited(tendon) or low < 0 < high

    def _is_limited(self, element: XmlElement) -> bool:
        limited = element.attributes.get("limited", "auto")
        by_range = limited == "auto" and self.automatic_limits and "range" in element.attributes
        return limited == "true" or by_range

    def _locked_joints(self) -> Iterator[tuple[str, str]]:
        """Yield the joints that an equality constraint holds where they are, and what to say of it."""
        for element in self._within("equality", "joint"):
            given = element.attributes
            offset = element.numbers("polycoef", (1, 2, 3, 4, 5), "0")[0]
            if given.get("active") != "false" and "joint2" not in given and not offset:
                yield given.get("joint1", ""), element.where

    def _held_ends(self) -> Iterator[tuple[str, str]]:
        """Yield the bodies and joints that other constraints and flexes act on, and what to say of these."""
        sprung = {body.name for body in self.bodies if any(joint.is_sprung for joint in body.joints)}
        for flex in self._within("deformable", "flex"):
            named = flex.attributes.get("body", "").split(maxsplit=_MOST_BODIES)
            for name in sprung & set(named):
                yield name, flex.where
        for element in self._within("equality", "connect", "weld"):
            given = element.attributes
            if given.get("active") == "false":
                continue
            for end in ("body1", "body2"):
                if end in given:
                    yield given[end], element.where
            for end in ("site1", "site2"):
                if given.get(end) in self.homes:
                    yield self.homes[given[end]], element.where


def _no_rod(name: str, error: BadModel) -> ModelRod:
    return ModelRod(name, np.zeros((0, 3)), np.zeros(0), (), refusal=str(error))


def _left_out(element: XmlElement, verb: str) -> str:
    """Say that an element is left out, and why; of a cable that cannot be judged its text says why."""
    if element.tag == "composite" and element.attributes.get("type") == "cable":
        return element.text
    rod = "what a rod does to the body that carries it is not read"
    return f"{element.where} {verb}: {rod if _is_rod(element) else _UNREAD[element.tag]}"


def _is_rod(element: XmlElement) -> bool:
    """Return True for a flex or flexcomp of points in a row."""
    return element.tag in ("flex", "flexcomp") and element.attributes.get("dim", "2") == "1"


def _place(element: XmlElement, kind: str = "hinge", *, copied: bool = False) -> SpringPlace:
    """Return where a joint or a tendon has its stiffness, or may have one of its own beside its class's."""
    notes = [
        "a ball's spring resists bending in every plane" if kind == "ball" else "",
        f"all copies of {element.where} have that spring" if copied else "",
    ]
    return SpringPlace("attribute", element.start, element.file, note="; ".join(filter(None, notes)))


def _linear(element: XmlElement, name: str, part: str) -> float:
    """Return the stiffness or damping of a joint or tendon, in MuJoCo 4 a polynomial, here of one term."""
    value, *more = element.numbers(name, (1, 2, 3), "0")
    if any(more):
        element.refuse(f"must have a linear {part}, got a {name} with more than one number")
    return element.at_least_0(name, value)
