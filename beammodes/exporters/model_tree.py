"""A chain as multibody tools take it: a row of bodies and joints from the ground, and ties at the far end.

::

      ground --joints-- body --joints-- body --joints-- body -- ties (only where the far end is supported)

Every body has its frame at the joints that carry it, so that a joint's axis is one of the frame's own, and
all joints are at rest at zero: what is curved or twisted at rest is in the frames. The row starts at the
firmer end, so a chain with one supported end is a tree. What holds or springs the other end acts on sums of
joint coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from beammodes.numerics.arrays import Floats

__all__ = [
    "IDENTITY",
    "NEARLY_NOTHING",
    "Body",
    "Joint",
    "Link",
    "Rows",
    "Tie",
    "Tree",
    "Vector",
    "drawn_thickness",
    "links",
    "placed",
    "principal_moments",
]

Vector = tuple[float, float, float]
#: Of a matrix.
Rows = tuple[Vector, Vector, Vector]

IDENTITY: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
#: What a body that cannot do without mass or inertia gets, over what it moves with. Heavy bodies at both ends
#: of a short chain make ten times that of it in a frequency: still below 1e-8.
NEARLY_NOTHING = 1e-10


@dataclass(frozen=True)
class Joint:
    """What a body may do relative to the one before: "slide" or "hinge", about its axis; "ball", or "free".

    Its spring and its damper are at rest at zero; those of a ball resist the rotation's vector.
    """

    name: str
    kind: str
    axis: tuple[int, int, int]
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class Body:
    """A rigid piece from its joints to its tip.

    Attributes
    ----------
    name : str
    position, rotation : triple, rows of three
        Of its frame on the body before: x_before = rotation x + position.
    tip, centre : triple [m]
        Where it ends, for drawings, and its centre of mass.
    mass : float [kg]
    inertia : rows of three [kg m²]
        About the centre of mass.
    joints : tuple of Joint
        From the body before on, all at the frame's origin.
    """

    name: str
    position: Vector
    rotation: Rows
    tip: Vector
    mass: float
    centre: Vector
    inertia: Rows
    joints: tuple[Joint, ...]

    @property
    def length(self) -> float:
        """From the joints to the tip [m]."""
        return math.hypot(*self.tip)


@dataclass(frozen=True)
class Tie:
    """A sum of joint coordinates that a spring resists, or that is held at zero where `stiffness` is inf."""

    name: str
    terms: tuple[tuple[str, float], ...]
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Tree:
    """Bodies in a row from the ground; `turned` if that is at the right end; `notes` for the file's head.

    `start` has the joints' coordinates of a shape to start from, `anchor` where the last body's tip is held.
    """

    bodies: tuple[Body, ...] = ()
    ties: tuple[Tie, ...] = ()
    turned: bool = False
    notes: tuple[str, ...] = ()
    start: tuple[float, ...] = ()
    anchor: Vector | None = None


@dataclass(frozen=True)
class Link:
    """A body with its one joint to its parent, None for a weld; a nearly massless one between two joints."""

    parent: str
    position: Vector
    rotation: Rows
    body: Body
    joint: Joint | None


def links(tree: Tree) -> Iterator[Link]:
    """Yield every joint with a link of its own, as URDF and SDFormat want it; the first parent is "world"."""
    parent = "world"
    for body in tree.bodies:
        position, rotation = body.position, body.rotation
        least = NEARLY_NOTHING * min(body.inertia[k][k] for k in range(3))
        trace = ((least, 0.0, 0.0), (0.0, least, 0.0), (0.0, 0.0, least))
        still = (0.0, 0.0, 0.0)
        for joint in body.joints[:-1]:
            name = f"{joint.name}_carrier"
            mass = NEARLY_NOTHING * body.mass
            carrier = Body(name, position, rotation, still, mass, still, trace, (joint,))
            yield Link(parent, position, rotation, carrier, joint)
            parent, position, rotation = name, still, IDENTITY
        yield Link(parent, position, rotation, body, body.joints[-1] if body.joints else None)
        parent = body.name


_Part = TypeVar("_Part", Link, Body)


def placed(row: Iterable[_Part]) -> Iterator[tuple[_Part, Floats, Floats]]:
    """Yield the parts of a row, each with where its frame is at rest in the world and how it is turned."""
    place, frame = np.zeros(3), np.eye(3)
    for part in row:
        place, frame = place + frame @ part.position, frame @ np.array(part.rotation)
        yield part, place, frame


def drawn_thickness(tree: Tree) -> float:
    """Return the thickness in which bodies are drawn, a hundredth of the length of all."""
    return math.fsum(body.length for body in tree.bodies) / 100


def principal_moments(body: Body) -> tuple[Vector, Rows]:
    """Return a body's principal moments of inertia and their axes, as columns."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    if not (xy or xz or yz):
        return (xx, yy, zz), IDENTITY
    moments, axes = np.linalg.eigh(np.array(body.inertia))
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    x, y, z = moments.tolist()
    one, two, three = map(tuple, axes.tolist())
    return (x, y, z), (one, two, three)
