"""The line of a chain's hinges in one plane of bending, and what supports the body that carries the first."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Group, ModelJoint
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.serial_chains import PARALLEL, HingePath

__all__ = ["OFF_LINE", "Frame", "RootSupport", "frame_of", "moves_alone", "root_support"]

Array = NDArray[np.float64]

#: How far off the line hinges and centres of mass may be, in mean distances between hinges; the error in a
#: frequency is of the order of its square.
OFF_LINE = 1e-4


@dataclass(frozen=True, eq=False)
class Frame:
    """The line of a chain's hinges: axis of bending, direction along, and the place of every hinge."""

    axis: Array
    along: Array
    origin: Array
    hinges: tuple[ModelJoint, ...]
    places: tuple[float, ...]

    @property
    def across(self) -> Array:
        """The direction in which a positive angle lifts the tip."""
        return np.cross(self.axis, self.along)

    @property
    def spacing(self) -> float:
        """A typical length of a piece."""
        count = len(self.places) - 1
        return (self.places[-1] - self.places[0]) / count if count else 0.0

    def place(self, point: Array) -> float:
        """Return how far along the chain a point is."""
        return float((point - self.origin) @ self.along)

    def off_line(self, point: Array) -> float:
        """Return a point's distance from the line, in the plane of bending."""
        return abs(float((point - self.origin) @ self.across))


def frame_of(path: HingePath, axis: Array) -> Frame:
    """Return the line on which a chain's hinges lie.

    Raises
    ------
    BadModel
        If they lie on none, or fold back; the message names the hinge.
    """
    hinges = tuple(path.hinges(axis))
    origin = hinges[0].position
    tip = path.groups[-1]
    reach = (tip.inertial.centre if tip.inertial.mass else tip.extent[0]) if len(hinges) < 2 else None
    along = (hinges[-1].position if reach is None else reach) - origin
    along = along - (along @ axis) * axis
    size = float(np.linalg.norm(along))
    if size < 1e-12:
        if np.linalg.norm(hinges[-1].position - origin) > 1e-12:
            raise BadModel(
                f"hinge {hinges[-1].name} must not turn about the chain's own line: twist is not judged"
            )
        raise BadModel(f"hinges {hinges[0].name} and {hinges[-1].name} must be apart, along a straight line")
    along = along / size
    places = tuple(float((hinge.position - origin) @ along) for hinge in hinges)
    frame = Frame(axis, along, origin, hinges, places)
    spacing = frame.spacing or size
    for i, hinge in enumerate(hinges):
        if frame.off_line(hinge.position) > OFF_LINE * spacing:
            raise BadModel(f"hinge {hinge.name} must be on one straight line with the others at rest")
        # The first two may be at one place: a support's spring, a body of no length, the beam's own.
        if i and (places[i] < places[i - 1] or (i > 1 and places[i] == places[i - 1])):
            raise BadModel(f"hinge {hinge.name} must be further along the chain than {hinges[i - 1].name}")
    return frame


def moves_alone(root: Group) -> bool:
    """Whether what carries the chain moves on the ground, and nothing else moves on it.

    What is part of a larger mechanism is judged as if it were held.
    """
    return root.parent is not None and root.parent.parent is None and len(root.children) == 1


@dataclass(frozen=True)
class RootSupport:
    """Stiffnesses across and in turning under a root that moves, and the joints of both kinds."""

    across: float = math.inf
    turning: float = math.inf
    slide: ModelJoint | None = None
    hinge: ModelJoint | None = None


def root_support(root: Group, frame: Frame) -> RootSupport | None:
    """Return what supports a root that moves on the ground, None if it does not.

    Raises
    ------
    BadModel
        If one of its joints is oblique to the chain, or cannot be honoured.
    """
    if not moves_alone(root):
        return None
    found = RootSupport()
    for joint in root.joints:
        if joint.refusal:
            raise BadModel(joint.refusal)
        if joint.kind == "free":
            found = replace(found, across=0.0, turning=0.0)
        elif joint.kind == "slide" and abs(joint.axis @ frame.across) > PARALLEL:
            _check_parallel(joint, frame.across)
            _check_only(found.slide, joint)
            found = replace(found, across=joint.stiffness, slide=joint)
        elif joint.kind == "hinge" and abs(joint.axis @ frame.axis) > PARALLEL:
            _check_parallel(joint, frame.axis)
            _check_only(found.hinge, joint)
            found = replace(found, turning=joint.stiffness, hinge=joint)
    return found


def _check_parallel(joint: ModelJoint, direction: Array) -> None:
    if np.linalg.norm(np.cross(joint.axis, direction)) > PARALLEL:
        raise BadModel(f"joint {joint.name} must be along or across the chain, got an oblique axis")


def _check_only(before: ModelJoint | None, joint: ModelJoint) -> None:
    if before is not None:
        raise BadModel(f"joint {joint.name} must not move the chain as {before.name} does: one too many")
