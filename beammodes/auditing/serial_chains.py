"""Serial chains of hinges with springs in a tree of bodies, and the planes in which they bend."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.auditing.body_tree import Group, Inertial, Model, ModelJoint, rigid_groups
from beammodes.auditing.bounded_xml import BadModel
from beammodes.checks import choice, shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "OFF_LINE",
    "PARALLEL",
    "Frame",
    "HingePath",
    "RootSupport",
    "bending_carrier",
    "chosen_path",
    "floats",
    "frame_of",
    "hinge_paths",
    "lone_segment",
    "moves_alone",
    "root_support",
    "shared_hub",
]


#: Sine of the angle up to which two axes are parallel.
PARALLEL = 1e-6


_LISTED = 8


_MOST_AXES = 6


@dataclass(frozen=True, eq=False)
class HingePath:
    """Groups in a row, each joined to the one before by hinges with springs.

    Attributes
    ----------
    root : Group
        What the first hinge is on.
    groups : tuple of Group
        After it, one for each hinge (or pair of hinges about two axes, or ball).
    in_space : bool
        Whether hinges about other axes were put at rest, which needs matter that lies along the axes.
    """

    root: Group
    groups: tuple[Group, ...]
    in_space: bool = False

    @property
    def name(self) -> str:
        """The name of the first body that moves."""
        return self.groups[0].name

    def planes(self) -> list[Floats]:
        """Return the axes about which every joint of the chain bends, most often one.

        Raises
        ------
        BadModel
            If hinges of one joint are oblique to each other, so that bending about one is bending about both.
        """
        for group in self.groups:
            _check_square(group)
        # Balls bend about any axis: about those of the hinges among them, else about two across the line.
        hinged = next((group for group in self.groups if not _is_ball(group)), None)
        axes = self._across() if hinged is None else _spring_axes(hinged)
        return [axis for axis in axes if all(_hinge(g, axis) for g in self.groups)]

    def _across(self) -> list[Floats]:
        first, last = self.groups[0].joints[0].position, self.groups[-1].joints[0].position
        far = last if len(self.groups) > 1 else self.groups[0].inertial.centre
        size = float(np.linalg.norm(far - first))
        if not size:
            return []
        along = (far - first) / size
        least = np.eye(3)[int(np.argmin(np.abs(along).round(9)))]
        one = least - (least @ along) * along
        one = one / np.linalg.norm(one)
        return [one, np.cross(along, one)]

    def hinges(self, axis: Floats) -> list[ModelJoint]:
        """Return the hinges about an axis that `planes` gives."""
        found = [_hinge(group, axis) for group in self.groups]
        return [hinge for hinge in found if hinge is not None]

    def has_body(self, name: str) -> bool:
        """Whether a body of that name moves with the chain."""
        return any(body.name == name for group in self.groups for body in group.bodies)


def hinge_paths(model: Model) -> list[HingePath]:
    """Return all serial chains of a model, the longest first.

    Raises
    ------
    BadModel
        If there is none; the message names what stands in the way.
    """
    found = []
    for group in rigid_groups(model.bodies):
        if _is_sprung(group) and not _continues(group):
            found.append(replace(_path_from(group), in_space=model.in_space))
    if not found:
        raise BadModel(_without_chain(model))
    return sorted(found, key=lambda path: -len(path.groups))


def _without_chain(model: Model) -> str:
    """Return why a model has no chain: what its bodies are on, and what stands in the way."""
    sprung = [body for body in model.bodies if any(joint.stiffness for joint in body.joints)]
    odd = [body.refusal for body in model.bodies if body.refusal]
    odd += [joint.refusal for body in model.bodies for joint in body.joints if joint.refusal]
    odd += [
        f"{joint.name} on body {body.name} is a {joint.kind} joint"
        for body in sprung
        for joint in body.joints
        if joint.kind != "hinge"
    ]
    odd += [note for note in model.notes if "line " in note.split(":")[0]]
    why = [*odd[:1], *([model.hint] if model.hint else [])]
    count = len(model.bodies)
    found = f"{count} bodies without"
    if sprung:
        found = f"{count} bodies, {len(sprung)} of them with springs, but none on hinges alone"
    return "; ".join([f"must have a hinge with a spring, got {found}", *why])


def about_one_axis(model: Model) -> Iterator[tuple[Floats, Model]]:
    """Yield each axis of hinges with springs, and the model with those at right angles to it at rest.

    Only where about as many are at rest as are not: a single hinge about another axis, such as one that a
    whole chain turns on, is no part of the chain, and what it lets swing is not judged.
    """
    axes: list[Floats] = []
    for joint in (joint for body in model.bodies for joint in body.joints):
        new = all(np.linalg.norm(np.cross(joint.axis, axis)) >= PARALLEL for axis in axes)
        if joint.kind == "hinge" and joint.stiffness and new and len(axes) < _MOST_AXES:
            axes.append(joint.axis)
    for axis in axes if len(axes) > 1 else ():
        bodies = tuple(
            replace(body, joints=tuple(j for j in body.joints if not _rests(j, axis)))
            for body in model.bodies
        )
        counts = [
            sum(bool(j.stiffness) for body in each for j in body.joints) for each in (bodies, model.bodies)
        ]
        stay, rest = counts[0], counts[1] - counts[0]
        if 2 * min(stay, rest) >= max(stay, rest) - 1:
            yield axis, replace(model, bodies=bodies, in_space=True)


def with_inner_motors_held(model: Model) -> tuple[Model, list[str]]:
    """Return a model whose hinges without a spring between hinges with springs are held, and their names.

    No beam has a hinge inside: who says what a beam's ends are says that a motor holds such an elbow.
    """
    above: list[bool] = []
    for body in model.bodies:
        own = any(joint.stiffness for joint in body.joints)
        above.append(own or (body.parent >= 0 and above[body.parent]))
    below = [False] * len(model.bodies)
    for i, body in reversed(list(enumerate(model.bodies))):
        if body.parent >= 0 and (below[i] or any(joint.stiffness for joint in body.joints)):
            below[body.parent] = True
    bodies, names = list(model.bodies), []
    for i, body in enumerate(model.bodies):
        loose = body.joints and all(joint.kind == "hinge" and not joint.stiffness for joint in body.joints)
        if loose and above[i] and below[i]:
            bodies[i] = replace(body, joints=())
            names += [joint.name for joint in body.joints]
    return replace(model, bodies=tuple(bodies)), names


def shown_axes(model: Model, axis: Floats) -> list[str]:
    """Return the names of some hinges that `about_one_axis` puts at rest."""
    names = [joint.name for body in model.bodies for joint in body.joints if _rests(joint, axis)]
    return [*names[:_LISTED], *(["..."] if len(names) > _LISTED else [])]


def _rests(joint: ModelJoint, axis: Floats) -> bool:
    return bool(joint.kind == "hinge" and joint.stiffness and abs(joint.axis @ axis) < PARALLEL)


def chosen_path(paths: Sequence[HingePath], name: str | None) -> HingePath:
    """Return the longest chain, or the one that has a body of that name; raises ValueError if none has."""
    if name is None:
        return paths[0]
    found = [path for path in paths if path.has_body(name)]
    return found[0] if found else paths[_index(paths, name)]


def _index(paths: Sequence[HingePath], name: str) -> int:
    names = [path.name for path in paths]
    if len(names) > _LISTED:
        raise ValueError(
            f"chain must name a body of one of {len(names)} chains, such as {names[0]}, got {shown(name)}"
        )
    return names.index(choice("chain", name, names))


def _is_sprung(group: Group) -> bool:
    """Whether a group is on hinges only, at least one of them with a spring, or on a ball with one."""
    if _is_ball(group):
        return True
    hinges = [joint.kind == "hinge" for joint in group.joints]
    return bool(hinges) and all(hinges) and any(joint.stiffness for joint in group.joints)


def _is_ball(group: Group) -> bool:
    """Whether a group is on a ball joint alone, whose spring resists bending about all axes alike."""
    return len(group.joints) == 1 and group.joints[0].kind == "ball" and group.joints[0].stiffness > 0


def _spring_axes(group: Group) -> list[Floats]:
    return [joint.axis for joint in group.joints if joint.stiffness]


def _hinge(group: Group, axis: Floats) -> ModelJoint | None:
    """Return the only hinge with a spring about an axis, or what a ball is about it."""
    if _is_ball(group):
        return replace(group.joints[0], kind="hinge", axis=axis)
    found = [
        joint
        for joint in group.joints
        if joint.kind == "hinge" and np.linalg.norm(np.cross(joint.axis, axis)) < PARALLEL
    ]
    return found[0] if len(found) == 1 and found[0].stiffness else None


def _check_square(group: Group) -> None:
    for one, other in itertools.combinations(group.joints, 2):
        cosine = abs(float(one.axis @ other.axis))
        if PARALLEL < cosine < 1 - PARALLEL:
            raise BadModel(f"{other.name} must be at right angles to {one.name}, got oblique hinges")


def _shares_axis(group: Group, other: Group) -> bool:
    if _is_ball(group) or _is_ball(other):
        return True
    return any(_hinge(other, axis) is not None for axis in _spring_axes(group))


def _continues(group: Group) -> bool:
    """Whether a group goes on with the chain that the group before it is in."""
    before = group.parent
    return before is not None and _is_sprung(before) and _next(before) is group


def _next(group: Group) -> Group | None:
    """Return the only group after it whose hinge is about the same axis."""
    found = [child for child in group.children if _is_sprung(child) and _shares_axis(group, child)]
    return found[0] if len(found) == 1 else None


def _path_from(group: Group) -> HingePath:
    groups = [group]
    while (after := _next(groups[-1])) is not None:
        groups.append(after)
    assert group.parent is not None
    return HingePath(group.parent, tuple(groups))


# The line of a chain's hinges in one plane of bending, and what supports the body that carries the first.

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

    axis: Floats
    along: Floats
    origin: Floats
    hinges: tuple[ModelJoint, ...]
    places: tuple[float, ...]

    @property
    def across(self) -> Floats:
        """The direction in which a positive angle lifts the tip."""
        return np.cross(self.axis, self.along)

    @property
    def spacing(self) -> float:
        """A typical length of a piece."""
        count = len(self.places) - 1
        return (self.places[-1] - self.places[0]) / count if count else 0.0

    def place(self, point: Floats) -> float:
        """Return how far along the chain a point is."""
        return float((point - self.origin) @ self.along)

    def off_line(self, point: Floats) -> float:
        """Return a point's distance from the line, in the plane of bending."""
        return abs(float((point - self.origin) @ self.across))


def frame_of(path: HingePath, axis: Floats) -> Frame:
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


def _check_parallel(joint: ModelJoint, direction: Floats) -> None:
    if np.linalg.norm(np.cross(joint.axis, direction)) > PARALLEL:
        raise BadModel(f"joint {joint.name} must be along or across the chain, got an oblique axis")


def _check_only(before: ModelJoint | None, joint: ModelJoint) -> None:
    if before is not None:
        raise BadModel(f"joint {joint.name} must not move the chain as {before.name} does: one too many")
