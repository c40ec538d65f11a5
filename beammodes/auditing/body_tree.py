"""A model as a tree of bodies and joints, whatever its file format, and its groups of rigid bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from beammodes.auditing.bounded_xml import BadModel
from beammodes.numerics.arrays import Floats

__all__ = [
    "FileStep",
    "Frame",
    "Group",
    "Inertial",
    "Model",
    "ModelBody",
    "ModelJoint",
    "ModelRod",
    "ModelTie",
    "Shape",
    "Solid",
    "SpringPlace",
    "about",
    "ends_of",
    "from_euler",
    "from_quaternion",
    "from_z_to",
    "joined",
    "rigid_groups",
    "solid",
]

#: A link that only passes a joint on has some mass in formats that want it; this share of what it carries, or
#: less, moves no frequency.
_NOTHING = 1e-8


def about(axis: Floats, angle: float) -> Floats:
    """Return the rotation about a unit axis, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def from_quaternion(w: float, x: float, y: float, z: float) -> Floats:
    """Return the rotation of a quaternion other than zero, of any size."""
    size = math.sqrt(x * x + y * y + z * z)
    return np.eye(3) if not size else about(np.array([x, y, z]) / size, 2 * math.atan2(size, w))


def from_euler(angles: Sequence[float] | Floats, sequence: str) -> Floats:
    """Return the rotation by three angles about the axes of `sequence`, lower case about turned axes.

    Letters of both cases may be mixed, as in MuJoCo and other than in scipy.
    """
    turned = np.eye(3)
    for angle, letter in zip(angles, sequence, strict=True):
        step = about(np.eye(3)["xyz".index(letter.lower())], angle)
        turned = turned @ step if letter.islower() else step @ turned
    return turned


def from_z_to(direction: Floats) -> Floats:
    """Return the smallest rotation that takes z to a unit direction."""
    axis, cosine = np.cross([0.0, 0.0, 1.0], direction), float(direction[2])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-15:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return about(axis / sine, math.atan2(sine, cosine))


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame in another: x_outer = rotation x_inner + position."""

    rotation: Floats = field(default_factory=lambda: np.eye(3))
    position: Floats = field(default_factory=lambda: np.zeros(3))

    @classmethod
    def by_angles(cls, position: Sequence[float], roll_pitch_yaw: Sequence[float] | Floats) -> Frame:
        """Return the frame turned about fixed x, y and z, as URDF and SDFormat write it."""
        return cls(from_euler(roll_pitch_yaw, "XYZ"), np.array(position))

    def __matmul__(self, inner: Frame) -> Frame:
        return Frame(self.rotation @ inner.rotation, self.rotation @ inner.position + self.position)

    @property
    def inverse(self) -> Frame:
        """The outer frame in this one."""
        return Frame(self.rotation.T, -self.rotation.T @ self.position)

    def point(self, inner: Floats) -> Floats:
        """Return where a point of the inner frame is in the outer one."""
        return self.rotation @ inner + self.position

    def points(self, inner: Iterable[Floats]) -> tuple[Floats, ...]:
        """Return where points of the inner frame are in the outer one."""
        return tuple(map(self.point, inner))


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg], centre of mass [m], and inertia about that centre, shape (3, 3) [kg m²]."""

    mass: float
    centre: Floats
    inertia: Floats

    @classmethod
    def of(cls, mass: float, moments: Sequence[float]) -> Inertial:
        """Return a body about its centre of mass; moments are xx, yy, zz, xy, xz, yz."""
        xx, yy, zz, xy, xz, yz = moments
        return cls(mass, np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))

    def seen_from(self, frame: Frame) -> Inertial:
        """Return the same in the outer frame."""
        turned = frame.rotation @ self.inertia @ frame.rotation.T
        return Inertial(self.mass, frame.point(self.centre), turned)

    def scaled(self, share: float) -> Inertial:
        """Return the same body of another density."""
        return Inertial(self.mass * share, self.centre, self.inertia * share)


def joined(parts: Iterable[Inertial]) -> Inertial:
    """Return bodies of one frame that are rigid with each other as one (parallel axes).

    Examples
    --------
    >>> point = np.zeros((3, 3))
    >>> both = joined([Inertial(1.0, np.zeros(3), point), Inertial(1.0, np.array([2.0, 0, 0]), point)])
    >>> both.mass, both.centre[0].item(), both.inertia[1, 1].item()
    (2.0, 1.0, 2.0)
    """
    kept = [part for part in parts if part.mass]
    mass = math.fsum(part.mass for part in kept)
    if not mass:
        return Inertial.of(0.0, [0.0] * 6)
    centre = sum((part.mass * part.centre for part in kept), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in kept:
        arm = part.centre - centre
        inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertial(mass, centre, inertia)


def solid(kind: str, size: Sequence[float], mass: float | None, density: float) -> Inertial:
    """Return a homogeneous body about its middle, axis along z; of a mass [kg] where given, else a density.

    Sizes [m] are the radius of a sphere; radius and half the straight length of a capsule or cylinder; three
    half lengths or half axes of a box or ellipsoid.

    Examples
    --------
    >>> solid("box", [0.5, 0.5, 0.5], None, 2.0).inertia[0, 0].round(6).item()       # m (1² + 1²)/12
    0.333333
    """
    volume, moments = _SOLIDS[kind](*size)
    own = density * volume if mass is None else mass
    return Inertial(own, np.zeros(3), own * np.diag(moments))


def ends_of(kind: str, size: Sequence[float]) -> list[Floats]:
    """Return how far a solid reaches from its middle: the ends of its axis, without round caps, or its faces.

    Of a sphere, which is all cap, it is the middle itself: as a lumped mass it has no length.

    Examples
    --------
    >>> [point.tolist() for point in ends_of("capsule", [0.1, 2.0])]
    [[0.0, 0.0, 2.0], [0.0, 0.0, -2.0]]
    """
    if kind == "sphere":
        return [np.zeros(3)]
    half = [0.0, 0.0, size[1]] if kind in ("capsule", "cylinder") else list(size[:3])
    return [sign * half[i] * np.eye(3)[i] + 0.0 for i in range(3) if half[i] for sign in (1.0, -1.0)]


# Volume and moments of inertia per mass of each kind of solid.


def _sphere(r: float) -> tuple[float, list[float]]:
    return 4 / 3 * math.pi * r**3, [0.4 * r**2] * 3


def _ellipsoid(a: float, b: float, c: float) -> tuple[float, list[float]]:
    return 4 / 3 * math.pi * a * b * c, [(b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5]


def _box(a: float, b: float, c: float) -> tuple[float, list[float]]:
    return 8 * a * b * c, [(b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3]


def _cylinder(r: float, half: float) -> tuple[float, list[float]]:
    across = r * r / 4 + half * half / 3
    return 2 * math.pi * r * r * half, [across, across, r * r / 2]


def _capsule(r: float, half: float) -> tuple[float, list[float]]:
    (tube, moments), (ball, (own, *_)) = _cylinder(r, half), _sphere(r)
    volume = tube + ball
    # Two half balls, whose centres of mass lie 3r/8 beyond the ends of the tube.
    across = own + half * half + 0.75 * r * half
    shares = (tube / volume, ball / volume) if volume else (0.0, 0.0)
    both = zip(moments, (across, across, own), strict=True)
    return volume, [shares[0] * a + shares[1] * b for a, b in both]


_SOLIDS: dict[str, Callable[..., tuple[float, list[float]]]] = {
    "sphere": _sphere,
    "ellipsoid": _ellipsoid,
    "box": _box,
    "cylinder": _cylinder,
    "capsule": _capsule,
}


@dataclass(frozen=True)
class SpringPlace:
    """Where a file has the number of a spring, and what the number comes to in the chain.

    `kind` is "attribute" for the attribute stiffness of the XML element whose tag begins at byte `start`,
    "text" for the text of that element, "scalar" for a number of YAML at character `start`. `file` is the
    file's name if it is not the model's own. The chain's spring is `scale` times the number, less what is in
    series with it. `note` is what else a change of the number does; `refusal` why it cannot be changed;
    `size` names the size that sets the spring by its fourth power, empty if a stiffness does.
    """

    kind: str
    start: int
    file: str = ""
    scale: float = 1.0
    in_series: float = math.inf
    note: str = ""
    refusal: str = ""
    size: str = ""

    def number(self, stiffness: float) -> float:
        """Return what the file must have there for the chain's hinge to have this stiffness.

        Examples
        --------
        >>> SpringPlace("text", 0, scale=4.0, in_series=3.0).number(6.0)       # 1/(1/6 + 1/3) = 2, by 4
        0.5
        """
        whole = stiffness if self.in_series == math.inf else 1 / (1 / stiffness + 1 / self.in_series)
        return whole / self.scale


@dataclass(frozen=True, eq=False)
class ModelJoint:
    """One coordinate of a body relative to its parent, in the world's frame at rest.

    `kind` is "hinge", "slide", "free", "ball", or another word, which only messages use. `stiffness` is in
    N m/rad or N/m, `damping` in N m s/rad or N s/m; `armature` [kg m² or kg] is inertia of the relative
    motion, as a motor's rotor behind its gear has. `refusal` says why a chain must not have this joint, empty
    if it may; `place` where the file has the stiffness. `springs` [N m/rad], shape (3, 3), resist turning of
    a ball beside its stiffness, which is alike about all axes. `rest` [rad or m] is where its spring is
    relaxed, from the pose in which the joint is given.
    """

    name: str
    kind: str
    axis: Floats
    position: Floats
    stiffness: float = 0.0
    refusal: str = ""
    damping: float = 0.0
    armature: float = 0.0
    place: SpringPlace | None = None
    springs: Floats | None = None
    rest: float = 0.0

    @property
    def is_sprung(self) -> bool:
        """True if a spring resists its motion."""
        return bool(self.stiffness) or self.springs is not None

    def stiffness_about(self, axis: Floats) -> float:
        """Return a ball's stiffness about an axis; 0 if turning about it is turned about others too."""
        if self.springs is None:
            return self.stiffness
        moment = self.springs @ axis
        own = float(axis @ moment)
        aslant = float(np.linalg.norm(moment - own * axis)) > 1e-6 * float(np.linalg.norm(self.springs))
        return 0.0 if aslant else self.stiffness + own


@dataclass(frozen=True, eq=False)
class Solid:
    """One of the solids that make up a body: its own mass, and the ends of its geometry."""

    inertial: Inertial
    ends: tuple[Floats, ...]


@dataclass(frozen=True, eq=False)
class Shape:
    """What a solid, or a plane by its normal, takes part in contacts with: the box around it.

    The columns of `half`, shape (3, 3), are half the box's edges [m]. Two shapes touch if a bit of one's
    `kinds` is a bit of the other's `partners`.
    """

    middle: Floats
    half: Floats
    kinds: int
    partners: int
    normal: Floats | None = None

    @classmethod
    def of(cls, kind: str, size: Sequence[float], bits: tuple[int, int]) -> Shape:
        """Return the shape of a solid about its middle, with sizes as `solid` takes them."""
        if kind == "plane":
            return cls(np.zeros(3), np.zeros((3, 3)), *bits, np.array([0.0, 0.0, 1.0]))
        radius, last = size[0], size[-1]
        edges = list(size[:3]) if kind in ("box", "ellipsoid") else [radius, radius, last]
        if kind == "capsule":
            edges[2] += radius
        return cls(np.zeros(3), np.diag(edges), *bits)

    def seen_from(self, frame: Frame) -> Shape:
        """Return the same in the outer frame."""
        normal = None if self.normal is None else frame.rotation @ self.normal
        half = frame.rotation @ self.half
        return Shape(frame.point(self.middle), half, self.kinds, self.partners, normal)


@dataclass(frozen=True, eq=False)
class ModelBody:
    """A rigid body, in the world's frame at rest.

    `parent` is the index of the body that it is fixed or jointed to, -1 the ground; without joints it is
    welded there. `extent` has the ends of its geometry, `solids` the solids that it is made of, none where
    the file gives its mass as one number; `refusal` says why it must not be in a chain, empty if it may.
    `shapes` take part in contacts; `moves_with` and `moves_on` are the indices of the body with joints that
    it is rigid with and of the one that carries that, -1 the ground; `caps` is the mass in round caps [kg].
    """

    name: str
    parent: int
    inertial: Inertial
    extent: Sequence[Floats] = ()
    joints: tuple[ModelJoint, ...] = ()
    refusal: str = ""
    solids: Sequence[Solid] = ()
    shapes: Sequence[Shape] = ()
    moves_with: int = -1
    moves_on: int = -1
    caps: float = 0.0

    def placed(self, frame: Frame) -> ModelBody:
        """Return a body whose inertial, extent and solids are in its own frame in the world's."""
        solids = [Solid(s.inertial.seen_from(frame), frame.points(s.ends)) for s in self.solids]
        inertial = self.inertial.seen_from(frame)
        shapes = [shape.seen_from(frame) for shape in self.shapes]
        extent = frame.points(self.extent)
        return replace(self, inertial=inertial, extent=extent, solids=solids, shapes=shapes)


@dataclass(frozen=True)
class ModelTie:
    """A sum of joint coordinates that a spring resists, or that is held where `stiffness` is infinite."""

    name: str
    terms: tuple[tuple[str, float], ...]
    stiffness: float
    refusal: str = ""
    damping: float = 0.0
    place: SpringPlace | None = None


@dataclass(frozen=True, eq=False)
class ModelRod:
    """Points in their order along a rod whose edges bend against each other, in the world at rest.

    `masses` [kg], `held` and `names` are those of the points and their bodies; `rigidity` [N m²] is EI for
    deflections along the two directions `across`; `damping` [s] is how much of each spring resists its speed;
    `place` says why a file cannot set single springs; `given` what the rod's numbers come from, `notes` what
    is left out, `refusal` why it is not judged, empty if it is.
    """

    name: str
    points: Floats
    masses: Floats
    held: tuple[bool, ...]
    names: tuple[str, ...] = ()
    rigidity: tuple[float, float] = (0.0, 0.0)
    across: tuple[Floats, Floats] = (np.zeros(3), np.zeros(3))
    damping: float = 0.0
    place: SpringPlace | None = None
    given: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    refusal: str = ""

    def has(self, name: str) -> bool:
        """Return True if the rod or the body of one of its points has that name."""
        return name == self.name or name in self.names


@dataclass(frozen=True)
class FileStep:
    """The time step of a model file [s], its integrator as the file names it, and its record's name."""

    timestep: float
    integrator: str
    record: str


@dataclass(frozen=True, eq=False)
class Model:
    """Bodies, parents first, and ties.

    `held` are bodies and joints that other constraints act on, each with the constraint's name; `notes` say
    what the reader left out; `step` is None where the format or the file has none; `gravity` is in m/s²;
    `ground` are shapes of the ground, `apart` pairs of bodies that make no contact; `neighbours_touch` says
    that a body may touch the one that it is jointed to. `hint` says where springs may be missing, for a model
    without any; `in_space` that some hinges have been put at rest; `given` what its springs come from, if
    they are no numbers of the file; `rods` what is made of points in place of bodies on hinges.
    """

    bodies: tuple[ModelBody, ...]
    ties: tuple[ModelTie, ...] = ()
    held: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    step: FileStep | None = None
    gravity: Floats = field(default_factory=lambda: np.zeros(3))
    hint: str = ""
    in_space: bool = False
    given: tuple[str, ...] = ()
    rods: tuple[ModelRod, ...] = ()
    ground: Sequence[Shape] = ()
    apart: frozenset[frozenset[str]] = frozenset()
    neighbours_touch: bool = False

    @property
    def left_out(self) -> tuple[str, ...]:
        """Sentences on what no frequency counts: what the reader left out, and weight."""
        weightless = "gravity is left out here: frequencies and errors are those without weight"
        return (*self.notes, *([weightless] if any(self.gravity) else []))


@dataclass(eq=False)
class Group:
    """Bodies that are rigid with each other, the joints to the group before, and the groups after it."""

    bodies: list[ModelBody]
    joints: tuple[ModelJoint, ...]
    parent: Group | None
    children: list[Group] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The name of its first body."""
        return self.bodies[0].name if self.bodies else "world"

    @cached_property
    def inertial(self) -> Inertial:
        """Mass and inertia of all its bodies."""
        return joined(body.inertial for body in self.bodies)

    @property
    def extent(self) -> list[Floats]:
        """The ends of the geometry of all its bodies."""
        return [point for body in self.bodies for point in body.extent]


def rigid_groups(bodies: Sequence[ModelBody]) -> list[Group]:
    """Return the groups of a tree, parents first, the ground's own at the head.

    Links that only pass joints on, almost without mass, are no groups: their joints are those of the next.
    """
    ground = Group([], (), None)
    groups, home = [ground], {-1: ground}
    for i, body in enumerate(bodies):
        if body.parent not in home:
            raise BadModel(f"body {body.name} must come after its parent")
        parent = home[body.parent]
        if not body.joints:
            home[i] = parent
            parent.bodies.append(body)
            continue
        home[i] = Group([body], body.joints, parent)
        parent.children.append(home[i])
        groups.append(home[i])
    return [group for group in groups if group is ground or not _passed_on(group)]


def _passed_on(group: Group) -> bool:
    """Take a group that only passes joints on out of the tree; return whether it does so."""
    if len(group.children) != 1 or group.parent is None:
        return False
    (child,) = group.children
    places = [joint.position for joint in (*group.joints, *child.joints)]
    if any(body.refusal for body in group.bodies) or not np.allclose(places, places[0], rtol=0, atol=1e-12):
        return False
    # The child may be such a link itself.
    carried = [child.inertial, *(after.inertial for after in child.children)]
    own = group.inertial
    heavy = own.mass > _NOTHING * max(each.mass for each in carried)
    if heavy or np.trace(own.inertia) > _NOTHING * max(np.trace(each.inertia) for each in carried):
        return False
    child.joints = (*group.joints, *child.joints)
    child.parent = group.parent
    group.parent.children[group.parent.children.index(group)] = child
    return True
