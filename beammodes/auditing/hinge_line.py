"""The line of a chain's hinges in one plane of bending, and what supports the body that carries the first."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Group, ModelJoint
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.serial_chains import PARALLEL, HingePath
from beammodes.auditing.spatial import Inertial

__all__ = [
    "OFF_LINE",
    "Frame",
    "RootSupport",
    "bending_carrier",
    "floats",
    "frame_of",
    "lone_segment",
    "moves_alone",
    "root_support",
    "shared_hub",
]

Array = NDArray[np.float64]

#: How far off the line hinges and centres of mass may be, in mean distances between hinges; the error in a
#: frequency is of the order of its square.
OFF_LINE = 1e-4
#: Shares of mass and length that segments of one chain have in common, as files round them.
_SEGMENT = 1e-2
#: Up to which share a centre of mass is at the end of its body.
_ROUNDED = 2e-3


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
    origin, origin_name = hinges[0].position, hinges[0].name
    tip = path.groups[-1]
    reach = (tip.inertial.centre if tip.inertial.mass else tip.extent[0]) if len(hinges) < 2 else None
    along = (hinges[-1].position if reach is None else reach) - origin
    along = along - (along @ axis) * axis
    size = float(np.linalg.norm(along))
    for joint in path.root.joints if size < 1e-12 and len(hinges) < 2 else ():
        # The hinge on which the piece before turns says where the line runs.
        along = origin - joint.position if joint.kind == "hinge" else along
        along = along - (along @ axis) * axis
        size = float(np.linalg.norm(along))
    if size < 1e-12:
        if np.linalg.norm(hinges[-1].position - origin) > 1e-12:
            raise BadModel(
                f"hinge {hinges[-1].name} must not turn about the chain's own line: twist is not judged"
            )
        if len(hinges) > 1:
            raise BadModel(
                f"hinges {hinges[0].name} and {hinges[-1].name} must be apart: both are at one place"
            )
        raise BadModel(
            f"body {tip.name} on hinge {origin_name} must have its centre of mass beside that hinge: as "
            "it is, it "
            "only spins there, and no line says where a beam would run"
        )
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


def lone_segment(group: Group, frame: Frame) -> tuple[float, Inertial] | None:
    """Return length and matter of the segment on a chain's last hinge, or None if its body shows none.

    Of several solids it is the one that begins at the hinge: others are what the segment carries. A body
    that is one solid or one number is as long as its geometry, or as twice the way to its centre of mass.
    """
    hinge, body = frame.places[-1], group.bodies[0]
    for solid in body.solids if len(body.solids) > 1 else ():
        reach = sorted(frame.place(end) - hinge for end in solid.ends)
        centre = frame.place(solid.inertial.centre) - hinge
        if solid.inertial.mass and len(reach) > 1 and reach[-1] > 0 and _is_rod(reach[0], reach[-1], centre):
            return reach[-1], solid.inertial
    own = body.inertial
    centre = frame.place(own.centre) - hinge
    length = max((frame.place(point) - hinge for point in body.extent), default=0.0) or 2 * centre
    slack = 1 + _ROUNDED
    if not own.mass or length <= _ROUNDED * abs(centre) or not 0 <= centre <= length * slack:
        return None
    return length, own


def _is_rod(start: float, end: float, centre: float) -> bool:
    """Whether a solid reaches from its hinge on, its centre of mass at its middle."""
    return abs(start) <= _SEGMENT * end and abs(centre - end / 2) <= _SEGMENT * end


def moves_alone(root: Group) -> bool:
    """Whether what carries the chain moves on the ground, and nothing else moves on it.

    What is part of a larger mechanism is judged as if it were held, and the audit says so.
    """
    return root.parent is not None and root.parent.parent is None and len(root.children) == 1


def floats(root: Group) -> bool:
    """Whether what carries the chain is free in space, with or below something else that moves."""
    group: Group | None = root
    while group is not None:
        if any(joint.kind == "free" for joint in group.joints):
            return not moves_alone(root)
        group = group.parent
    return False


def shared_hub(path: HingePath, frame: Frame) -> ModelJoint | None:
    """Return the joint on which a body moves in the plane of bending that carries other springs too, if any.

    Such a hub rings with all that it carries; held, each of its chains rings alone.
    """
    carries = any(
        joint.stiffness
        for child in path.root.children
        if child is not path.groups[0]
        for joint in child.joints
    )
    for joint in path.root.joints if carries else ():
        turns = joint.kind == "hinge" and abs(joint.axis @ frame.axis) > PARALLEL
        shifts = joint.kind == "slide" and abs(joint.axis @ frame.across) > PARALLEL
        if turns or shifts or joint.kind == "ball":
            return joint
    return None


def bending_carrier(path: HingePath, frame: Frame) -> tuple[ModelJoint, ModelJoint] | None:
    """Return a hinge without a spring between the chain and one that carries it, and a hinge of that one."""
    elbow, group = None, path.root
    while group.parent is not None:
        for joint in group.joints:
            if joint.stiffness and elbow and abs(joint.axis @ frame.axis) > PARALLEL:
                return elbow, joint
        elbow = elbow or next((joint for joint in group.joints if not joint.stiffness), None)
        group = group.parent
    return None


@dataclass(frozen=True)
class RootSupport:
    """Stiffnesses across and in turning under a root that moves, and the joints of both kinds.

    Attributes
    ----------
    across, turning : float
    slide, hinge : ModelJoint or None
    in_space : bool
        Whether another joint moves the chain out of its plane.
    why : str
        What is assumed, if this is not all that the file lets move.
    """

    across: float = math.inf
    turning: float = math.inf
    slide: ModelJoint | None = None
    hinge: ModelJoint | None = None
    in_space: bool = False
    why: str = ""


def root_support(path: HingePath, frame: Frame) -> RootSupport | None:
    """Return what supports a root that moves, None if the ground carries it or a body taken as held.

    A hinge without a spring on a larger mechanism is the chain's own pinned end, if the piece that it turns
    is a segment like the next.

    Raises
    ------
    BadModel
        If one of its joints is oblique to the chain, moves it across by a lever, or cannot be honoured.
    """
    root = path.root
    if not moves_alone(root):
        return _own_pinned_end(path, frame)
    found = RootSupport()
    for joint in root.joints:
        if joint.refusal:
            raise BadModel(joint.refusal)
        if joint.kind == "free":
            found = replace(found, across=0.0, turning=0.0)
        elif joint.kind == "slide" and abs(joint.axis @ frame.across) > PARALLEL:
            _check_parallel(joint, frame.across)
            _check_only(found.slide, joint)
            if joint.armature:
                raise BadModel(f"joint {joint.name} must have no armature: only that of hinges is read")
            found = replace(found, across=joint.stiffness, slide=joint)
        elif joint.kind == "hinge" and abs(joint.axis @ frame.axis) > PARALLEL:
            _check_parallel(joint, frame.axis)
            _check_only(found.hinge, joint)
            found = replace(found, turning=joint.stiffness, hinge=joint)
        elif joint.kind == "hinge":
            _check_out_of_plane(joint, frame)
            why = f"joint {joint.name}, which turns the chain out of its plane, is taken as at rest"
            found = replace(found, in_space=True, why=why)
    return found


def _own_pinned_end(path: HingePath, frame: Frame) -> RootSupport | None:
    root = path.root
    if len(root.joints) != 1 or len(root.children) != 1 or root.parent is None:
        return None
    (joint,) = root.joints
    length = -frame.place(joint.position)
    size, other = _next_segment(path, frame)
    parallel = float(np.linalg.norm(np.cross(joint.axis, frame.axis))) < PARALLEL
    on_line = frame.off_line(joint.position) <= OFF_LINE * size
    if joint.kind != "hinge" or joint.stiffness or not parallel or not on_line or length <= 0:
        return None
    # A segment has its share of mass, at the same share of its length, as the next one.
    own = root.inertial
    if not size or not other.mass or abs(own.mass / other.mass * size / length - 1) > _SEGMENT:
        return None
    shares = (1 + frame.place(own.centre) / length, frame.place(other.centre) / size)
    if abs(shares[0] - shares[1]) > _SEGMENT:
        return None
    if joint.refusal:
        raise BadModel(joint.refusal)
    why = (
        f"hinge {joint.name} has no spring and is the chain's pinned end; body {root.parent.name}, which "
        "carries "
        "it and moves, is taken as held"
    )
    return RootSupport(turning=0.0, hinge=joint, why=why)


def _next_segment(path: HingePath, frame: Frame) -> tuple[float, Inertial]:
    """Return length and matter of the segment after the first hinge, 0 if its body shows none."""
    first = path.groups[0]
    if len(frame.places) > 1:
        return frame.places[1] - frame.places[0], first.inertial
    return lone_segment(first, frame) or (0.0, first.inertial)


def _check_out_of_plane(joint: ModelJoint, frame: Frame) -> None:
    """Raise BadModel if a hinge at right angles to those of the chain moves it in their plane too."""
    lever = float(np.cross(joint.axis, frame.origin - joint.position) @ frame.across)
    if abs(lever) > OFF_LINE * (frame.spacing or 1.0):
        raise BadModel(
            f"joint {joint.name} must be on the line of the chain's hinges: at {abs(lever):.3g} m beside "
            "it, it "
            "moves the whole chain across"
        )
    if joint.stiffness:
        raise BadModel(
            f"joint {joint.name} must be parallel to {frame.hinges[0].name}: what its spring lets swing "
            "out of "
            "the plane of bending is not judged"
        )


def _check_parallel(joint: ModelJoint, direction: Array) -> None:
    if np.linalg.norm(np.cross(joint.axis, direction)) > PARALLEL:
        raise BadModel(f"joint {joint.name} must be along or across the chain, got an oblique axis")


def _check_only(before: ModelJoint | None, joint: ModelJoint) -> None:
    if before is not None:
        raise BadModel(f"joint {joint.name} must not move the chain as {before.name} does: one too many")
