"""A model as a tree of bodies and joints, whatever its file format, and its rigid groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.spatial import Inertial, joined

__all__ = [
    "FileStep",
    "Group",
    "Model",
    "ModelBody",
    "ModelJoint",
    "ModelTie",
    "Solid",
    "rigid_groups",
]

Array = NDArray[np.float64]

#: A link that only passes a joint on has some mass in formats that want it; this share of what it carries, or
#: less, moves no frequency.
_NOTHING = 1e-8


@dataclass(frozen=True, eq=False)
class ModelJoint:
    """One coordinate of a body relative to its parent, in the world's frame at rest.

    Attributes
    ----------
    name : str
    kind : str
        "hinge", "slide", "free", or another word, which only messages use.
    axis, position : ndarray, shape (3,)
    stiffness : float [N m/rad or N/m]
    refusal : str
        Why a chain must not have this joint, empty if it may.
    damping : float [N m s/rad or N s/m]
    armature : float [kg m² or kg]
        Inertia of the relative motion, such as a motor's rotor behind its gear has.
    """

    name: str
    kind: str
    axis: Array
    position: Array
    stiffness: float = 0.0
    refusal: str = ""
    damping: float = 0.0
    armature: float = 0.0


@dataclass(frozen=True, eq=False)
class Solid:
    """One of the solids that make up a body: its own mass, and the ends of its geometry."""

    inertial: Inertial
    ends: tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class ModelBody:
    """A rigid body, in the world's frame at rest.

    Attributes
    ----------
    name : str
    parent : int
        Index of the body that it is fixed or jointed to; -1 is the ground.
    origin : ndarray, shape (3,)
        Of its frame.
    inertial : Inertial
    extent : tuple of ndarray
        Points that show how far it reaches: the ends of its geometry.
    joints : tuple of ModelJoint
        To its parent; none welds it there.
    refusal : str
        Why it must not be in a chain, empty if it may.
    solids : tuple of Solid
        What it is made of; empty where the file gives its mass as one number.
    """

    name: str
    parent: int
    origin: Array
    inertial: Inertial
    extent: tuple[Array, ...] = ()
    joints: tuple[ModelJoint, ...] = ()
    refusal: str = ""
    solids: tuple[Solid, ...] = ()


@dataclass(frozen=True)
class ModelTie:
    """A sum of joint coordinates that a spring resists, or that is held where `stiffness` is infinite."""

    name: str
    terms: tuple[tuple[str, float], ...]
    stiffness: float
    refusal: str = ""
    damping: float = 0.0


@dataclass(frozen=True)
class FileStep:
    """The time step of a model file [s], its integrator as the file names it, and its record's name."""

    timestep: float
    integrator: str
    record: str


@dataclass(frozen=True, eq=False)
class Model:
    """Bodies, parents first, and ties.

    Attributes
    ----------
    bodies : tuple of ModelBody
    ties : tuple of ModelTie
    held : tuple of (str, str)
        Bodies and joints that other constraints act on, each with the constraint's name.
    notes : tuple of str
        What the reader left out.
    step : FileStep or None
        None where the format or the file has none.
    gravity : ndarray, shape (3,) [m/s²]
    hint : str
        Where springs may be missing, for a model without any.
    in_space : bool
        Whether some of its hinges have been put at rest.
    """

    bodies: tuple[ModelBody, ...]
    ties: tuple[ModelTie, ...] = ()
    held: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    step: FileStep | None = None
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    hint: str = ""
    in_space: bool = False


@dataclass(eq=False)
class Group:
    """Bodies that are rigid with each other, the joints to the group before, and the groups after it."""

    bodies: list[ModelBody]
    joints: tuple[ModelJoint, ...]
    parent: Group | None
    children: list[Group]

    @property
    def name(self) -> str:
        """The name of its first body."""
        return self.bodies[0].name if self.bodies else "world"

    @cached_property
    def inertial(self) -> Inertial:
        """Mass and inertia of all its bodies."""
        return joined(body.inertial for body in self.bodies)

    @property
    def extent(self) -> list[Array]:
        """The ends of the geometry of all its bodies."""
        return [point for body in self.bodies for point in body.extent]


def rigid_groups(bodies: Sequence[ModelBody]) -> list[Group]:
    """Return the groups of a tree, parents first, the ground's own at the head.

    Links that only pass joints on, almost without mass, are no groups: their joints are those of the next.

    Raises
    ------
    BadModel
        If a parent stands after its child, as in a loop.
    """
    ground = Group([], (), None, [])
    groups, home = [ground], {-1: ground}
    for i, body in enumerate(bodies):
        if body.parent not in home:
            raise BadModel(f"body {body.name} must come after its parent")
        parent = home[body.parent]
        if not body.joints:
            home[i] = parent
            parent.bodies.append(body)
            continue
        home[i] = Group([body], body.joints, parent, [])
        parent.children.append(home[i])
        groups.append(home[i])
    return [group for group in groups if group is ground or not _passed_on(group)]


def _passed_on(group: Group) -> bool:
    """Whether a group only passes joints on; if so it is taken out of the tree."""
    if len(group.children) != 1 or group.parent is None:
        return False
    (child,) = group.children
    places = [joint.position for joint in (*group.joints, *child.joints)]
    if any(body.refusal for body in group.bodies) or not np.allclose(places, places[0], rtol=0, atol=1e-12):
        return False
    # The child may be such a link itself.
    carried = [child.inertial, *(after.inertial for after in child.children)]
    for size in (_mass, _turning):
        if size(group.inertial) > _NOTHING * max(map(size, carried)):
            return False
    child.joints = (*group.joints, *child.joints)
    child.parent = group.parent
    group.parent.children[group.parent.children.index(group)] = child
    return True


def _mass(inertial: Inertial) -> float:
    return inertial.mass


def _turning(inertial: Inertial) -> float:
    return float(np.trace(inertial.inertia))
