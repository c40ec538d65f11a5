"""A row of bodies on sprung joints in space: hinges about several axes, balls, slides, in whatever order.

A joint's coordinates each belong to a motion, by their axis on the line of the nodes:

    ======  =====================================================
    motion  coordinates
    ======  =====================================================
    0       hinges about the line: twist
    1, 2    hinges about the first and the second axis across it: bending; slides of the carrier that shift
            the chain in these planes
    3       slides along the line: stretch
    ======  =====================================================

A ball is a hinge about each of the three. Where nodes are on no straight line, or an axis is oblique to it,
coordinates belong to no motion: all is then judged as one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Group, Model, ModelJoint
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.serial_chains import (
    OFF_LINE,
    are_parallel,
    are_square,
    axes_across,
    moves_alone,
    rows_of,
)
from beammodes.checks import choice
from beammodes.numerics.arrays import Floats

__all__ = [
    "FIRST_BENDING",
    "SECOND_BENDING",
    "STRETCH",
    "TWIST",
    "Coordinate",
    "SpaceLine",
    "SpaceRow",
    "chosen_row",
]

TWIST, FIRST_BENDING, SECOND_BENDING, STRETCH = range(4)

_NO_LENGTH = 1e-12
_LISTED = 8


@dataclass(frozen=True, eq=False)
class SpaceLine:
    """The straight line of a row's nodes, its two axes across, and a length between neighbours."""

    origin: Floats
    along: Floats
    axes: tuple[Floats, Floats]
    spacing: float

    def place(self, point: Floats) -> float:
        """Return how far along the row a point is."""
        return float((point - self.origin) @ self.along)

    def off_line(self, point: Floats) -> float:
        """Return a point's distance from the line."""
        arm = point - self.origin
        return float(np.linalg.norm(arm - (arm @ self.along) * self.along))

    def across(self, motion: int) -> Floats:
        """Return the direction in which a motion of bending deflects the tip."""
        return np.cross(self.axes[motion - 1], self.along)

    def motion(self, kind: str, axis: Floats) -> int | None:
        """Return the motion of a coordinate, None if its axis is oblique."""
        if kind == "hinge":
            directions = (self.along, *self.axes)
            return next((k for k, each in enumerate(directions) if are_parallel(axis, each)), None)
        if are_parallel(axis, self.along):
            return STRETCH
        return next((k for k in (1, 2) if are_parallel(axis, self.across(k))), None)


@dataclass(frozen=True, eq=False)
class Coordinate:
    """One way in which a joint moves all beyond it: a turn about an axis through a point, or a shift."""

    joint: ModelJoint
    group: int
    kind: str
    axis: Floats
    motion: int | None

    @property
    def stiffness(self) -> float:
        """Of its own spring, others at rest."""
        own = self.joint.stiffness
        return own if self.joint.springs is None else own + float(self.axis @ self.joint.springs @ self.axis)


@dataclass(frozen=True, eq=False)
class SpaceRow:
    """Groups in a row, each on sprung joints to the one before; the first on `root`.

    `held` says that the user's word holds the root, whatever its joints let it do.
    """

    root: Group
    groups: tuple[Group, ...]
    others: tuple[str, ...] = ()
    held: bool = False

    @property
    def name(self) -> str:
        """The name of the first body that moves."""
        return self.groups[0].name

    @property
    def joints(self) -> list[ModelJoint]:
        """The joints of the row, from the root on."""
        return [joint for group in self.groups for joint in group.joints]

    def has_body(self, name: str) -> bool:
        """Return True if a body of that name moves with the row."""
        return any(body.name == name for group in self.groups for body in group.bodies)

    @property
    def is_carried(self) -> bool:
        """True if the carrier moves on joints of its own, with nothing but the row on it."""
        return moves_alone(self.root) and not self.held

    @cached_property
    def nodes(self) -> list[Floats]:
        """The places of joints, each once, in order."""
        found: list[Floats] = []
        for joint in self.joints:
            if not found or np.linalg.norm(joint.position - found[-1]) > _NO_LENGTH:
                found.append(joint.position)
        return found

    @cached_property
    def line(self) -> SpaceLine | None:
        """The line of the nodes, None if they are on none, or if an axis is oblique to it."""
        first, last, tip = self.nodes[0], self.nodes[-1], self.groups[-1]
        way = last - first
        if np.linalg.norm(way) <= _NO_LENGTH:
            way = (
                tip.inertial.centre if tip.inertial.mass else tip.extent[0] if tip.extent else first
            ) - first
        size = float(np.linalg.norm(way))
        if size <= _NO_LENGTH:
            raise BadModel(f"nodes of the chain at {self.name} must be apart: no line says where a beam runs")
        along = way / size
        spacing = size / max(1, len(self.nodes) - 1)
        line = SpaceLine(first, along, self._across(along), spacing)
        places = [line.place(node) for node in self.nodes]
        straight = all(line.off_line(node) <= OFF_LINE * spacing for node in self.nodes)
        if not straight or any(b <= a for a, b in itertools.pairwise(places)):
            return None
        return None if any(line.motion(*each) is None for each in self._moves()) else line

    def _moves(self) -> list[tuple[str, Floats]]:
        return [(joint.kind, joint.axis) for joint in self.joints if joint.kind != "ball"]

    def _across(self, along: Floats) -> tuple[Floats, Floats]:
        """Return the axes of bending: those of hinges across the line, else those of balls."""
        hinges = [axis for kind, axis in self._moves() if kind == "hinge" and are_square(axis, along)]
        if not hinges:
            springs = next((joint.springs for joint in self.joints if joint.springs is not None), None)
            return axes_across(along, springs, [group.inertial for group in self.groups])
        one = hinges[0] - (hinges[0] @ along) * along
        one = one / np.linalg.norm(one)
        return one, np.cross(along, one)

    @cached_property
    def coordinates(self) -> list[Coordinate]:
        """All coordinates: of the carrier where it moves alone, then of the row, from the root on."""
        groups = (
            ((-1, self.root), *enumerate(self.groups)) if self.is_carried else tuple(enumerate(self.groups))
        )
        return [
            Coordinate(joint, at, kind, axis, None if self.line is None else self.line.motion(kind, axis))
            for at, group in groups
            for joint in group.joints
            for kind, axis in self._directions(joint)
        ]

    def _directions(self, joint: ModelJoint) -> list[tuple[str, Floats]]:
        if joint.kind in ("hinge", "slide"):
            return [(joint.kind, joint.axis)]
        frame = np.eye(3) if self.line is None else np.array([self.line.along, *self.line.axes])
        turns = [("hinge", axis) for axis in frame]
        return turns if joint.kind == "ball" else [*(("slide", axis) for axis in frame), *turns]

    @cached_property
    def twisting(self) -> NDArray[np.bool_]:
        """True for coordinates that turn about the row, whatever its shape: nearer to it than across."""
        nodes = np.array(self.nodes)
        if len(nodes) == 1:
            nodes = np.vstack([nodes, self.groups[-1].inertial.centre])
        # Of one node the line to what follows.
        tangent = np.gradient(nodes, axis=0)
        nearest = [
            int(np.argmin(np.linalg.norm(nodes - each.joint.position, axis=1))) for each in self.coordinates
        ]
        along = [
            each.kind == "hinge"
            and abs(each.axis @ tangent[k]) > math.sqrt(0.5) * float(np.linalg.norm(tangent[k]))
            for each, k in zip(self.coordinates, nearest, strict=True)
        ]
        return np.array(along, dtype=np.bool_)

    def alone(self, model: Model, motion: int, across: Floats | None = None) -> Model:
        """Return the model with the coordinates of one motion of this row only, all others of it at rest.

        With `across`, they are hinges about that axis instead, at the same places.
        """
        kept: dict[int, tuple[ModelJoint, ...]] = {id(joint): () for joint in self.joints}
        free = {id(joint) for joint in self.root.joints if joint.kind == "free"}
        for each in self.coordinates:
            if each.motion == motion and id(each.joint) not in free:
                kind, axis = (each.kind, each.axis) if across is None else ("hinge", across)
                one = replace(each.joint, kind=kind, axis=axis, stiffness=each.stiffness, springs=None)
                kept[id(each.joint)] = (one,)
            elif each.group < 0 and id(each.joint) not in free:
                kept.setdefault(id(each.joint), ())
        bodies = tuple(
            replace(body, joints=tuple(new for joint in body.joints for new in kept.get(id(joint), (joint,))))
            for body in model.bodies
        )
        return replace(model, bodies=bodies, in_space=True)


def chosen_row(model: Model, name: str | None) -> SpaceRow:
    """Return the row of most joints, or the one that has a body of that name.

    Raises
    ------
    ValueError
        If there is none, or what a row has cannot be honoured; the message says why.
    """
    rows = [SpaceRow(*row) for row in rows_of(model, _is_sprung, _next)]
    rows.sort(key=lambda row: -len(row.joints))
    names = [row.name for row in rows]
    chosen = rows[0]
    if name is not None:
        found = next((row for row in rows if row.has_body(name)), None)
        chosen = found or rows[names.index(choice("chain", name, names))]
    others = tuple(row.name for row in rows if row is not chosen)
    _check(chosen)
    return replace(chosen, others=others)


def _is_sprung(group: Group) -> bool:
    """Return True if a group is on hinges, balls and slides only, at least one with a spring."""
    plain = bool(group.joints) and all(joint.kind in ("hinge", "ball", "slide") for joint in group.joints)
    return plain and any(joint.is_sprung for joint in group.joints)


def _next(group: Group) -> Group | None:
    found = [child for child in group.children if _is_sprung(child)]
    return found[0] if len(found) == 1 else None


def _check(row: SpaceRow) -> None:
    carrier: Sequence[Group] = (row.root,) if row.is_carried else ()
    for group in (*carrier, *row.groups):
        refusals = [body.refusal for body in group.bodies] + [joint.refusal for joint in group.joints]
        for why in filter(None, refusals):
            raise BadModel(why)
    for group, after in zip(row.groups, (*row.groups[1:], None), strict=True):
        for other in group.children:
            if other is not after:
                raise BadModel(
                    f"{other.joints[0].name} on body {group.name} must be in the row of the chain's joints: "
                    "nothing else may move on the chain"
                )
    for joint in row.joints:
        if not joint.is_sprung:
            raise BadModel(
                f"{joint.name} must have a spring, as all joints of a chain in space: it moves freely"
            )
