"""Serial chains of hinges with springs in a tree of bodies: their line, and what carries them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.auditing.body_tree import Group, Inertial, Model, ModelJoint, rigid_groups
from beammodes.auditing.bounded_xml import BadModel
from beammodes.checks import choice, shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "NO_SPRING",
    "OFF_LINE",
    "HingeLine",
    "HingePath",
    "RootSupport",
    "about_one_axis",
    "are_parallel",
    "are_square",
    "axes_across",
    "check_carrier",
    "chosen_path",
    "hinge_line",
    "hinge_paths",
    "letters_of",
    "lone_segment",
    "root_support",
    "rows_of",
    "with_motors_held",
    "without_stretch",
]

#: What is said of a ball that nothing resists.
NO_SPRING = "must be a hinge or a ball with a stiffness, got type 'ball'"
#: Sine of the angle up to which two axes are parallel.
_PARALLEL = 1e-6
#: Largest distance of hinges and centres of mass from the line, in mean distances between hinges; the error
#: in a frequency is of the order of its square.
OFF_LINE = 1e-4
#: Shares of mass and length that segments of one chain have in common, as files round them.
_SEGMENT = 1e-2
#: Up to which share a centre of mass is at the end of its body.
_ROUNDED = 2e-3
_NO_LENGTH = 1e-12
_LISTED = 8
_MOST_AXES = 6


def are_parallel(one: Floats, other: Floats) -> bool:
    """Return True for two directions of one line, either way along it.

    Examples
    --------
    >>> are_parallel(np.array([0.0, 1.0, 0.0]), np.array([0.0, -1.0, 0.0]))
    True
    """
    return bool(np.linalg.norm(np.cross(one, other)) < _PARALLEL)


def are_square(one: Floats, other: Floats) -> bool:
    """Return True for two directions at a right angle.

    Examples
    --------
    >>> are_square(np.array([0.0, 1.0, 0.0]), np.array([1.0, 1.0, 0.0]))
    False
    """
    return bool(abs(one @ other) <= _PARALLEL)


def axes_across(along: Floats, springs: Floats | None, matter: Sequence[Inertial]) -> tuple[Floats, Floats]:
    """Return two axes across a line about which balls bend each by itself.

    They are the principal ones of the balls' springs, if these are not alike about all axes, else of the
    matter; and the world's nearest, where any are as good.

    Examples
    --------
    >>> one, two = axes_across(np.array([1.0, 0, 0]), None, [])
    >>> one.tolist(), two.tolist()
    ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    """
    least = np.eye(3)[int(np.argmin(np.abs(along).round(9)))]
    one = least - (least @ along) * along
    one = one / np.linalg.norm(one)
    across = np.column_stack([one, np.cross(along, one)])
    told = [] if springs is None else [springs]
    for square in [*told, *(part.inertia for part in matter)]:
        plane = across.T @ square @ across
        unlike = max(abs(plane[0, 1]), abs(plane[0, 0] - plane[1, 1])) > _PARALLEL * abs(np.trace(plane))
        if unlike and abs(plane[0, 1]) > _PARALLEL * abs(np.trace(plane)):
            one = across @ np.linalg.eigh(plane)[1][:, 0]
            return one, np.cross(along, one)
        if unlike:
            break
    return across[:, 0], across[:, 1]


def letters_of(directions: Sequence[Floats]) -> list[str]:
    """Return the world's axis that is nearest to each direction; of two alike, each has a letter of its own.

    Examples
    --------
    >>> letters_of([np.array([0.0, 0.6, 0.8]), np.array([0.0, -0.6, 0.8])])
    ['z', 'y']
    """
    found: list[str] = []
    for direction in directions:
        order = np.argsort(-np.abs(direction).round(6), kind="stable")
        found.append(next(letter for letter in ("xyz"[i] for i in order) if letter not in found))
    return found


@dataclass(frozen=True, eq=False)
class HingePath:
    """Groups in a row, each joined to the one before by a hinge with a spring, two about two axes, or a ball.

    The first is on `root`. `in_space` says that hinges about other axes were put at rest, which needs matter
    that lies along the axes.
    """

    root: Group
    groups: tuple[Group, ...]
    in_space: bool = False

    @property
    def name(self) -> str:
        """The name of the first body that moves."""
        return self.groups[0].name

    def axes(self) -> list[Floats]:
        """Return the axes about which every joint of the chain bends, most often one.

        Hinges of one joint that are oblique to each other are refused: bending about one is bending about
        both.
        """
        for group in self.groups:
            for one, other in itertools.combinations(group.joints, 2):
                if _PARALLEL < abs(one.axis @ other.axis) < 1 - _PARALLEL:
                    raise BadModel(f"{other.name} must be at right angles to {one.name}, got oblique hinges")
        # Balls bend about any axis: about those of the hinges among them, else about two across the line.
        hinged = next((group for group in self.groups if not _is_ball(group)), None)
        axes = self._across() if hinged is None else _spring_axes(hinged)
        return [axis for axis in axes if all(_hinge(group, axis) for group in self.groups)]

    def _across(self) -> list[Floats]:
        first, last = self.groups[0].joints[0].position, self.groups[-1].joints[0].position
        along = (last if len(self.groups) > 1 else self.groups[0].inertial.centre) - first
        size = float(np.linalg.norm(along))
        if not size:
            return []
        along = along / size
        springs = self.groups[0].joints[0].springs
        return list(axes_across(along, springs, [group.inertial for group in self.groups]))

    def hinges(self, axis: Floats) -> list[ModelJoint]:
        """Return the hinges about an axis that `axes` gives."""
        return [hinge for group in self.groups if (hinge := _hinge(group, axis)) is not None]

    def has_body(self, name: str) -> bool:
        """Return True if a body of that name moves with the chain."""
        return any(body.name == name for group in self.groups for body in group.bodies)


def hinge_paths(model: Model) -> list[HingePath]:
    """Return all serial chains of a model, the longest first; refuse a model without any."""
    found = [HingePath(*row, model.in_space) for row in rows_of(model, _is_sprung, _next)]
    return sorted(found, key=lambda path: -len(path.groups))


def rows_of(
    model: Model, is_sprung: Callable[[Group], bool], after: Callable[[Group], Group | None]
) -> list[tuple[Group, tuple[Group, ...]]]:
    """Return the rows of groups with springs, each with what it is on; refuse a model without any.

    `after` says which group goes on with a row, None at its end.
    """
    found = []
    for group in rigid_groups(model.bodies):
        before = group.parent
        if before is None or not is_sprung(group) or (is_sprung(before) and after(before) is group):
            continue
        row = [group]
        while (another := after(row[-1])) is not None:
            row.append(another)
        found.append((before, tuple(row)))
    if not found:
        raise BadModel(_why_no_chain(model))
    return found


def _why_no_chain(model: Model) -> str:
    sprung = [body for body in model.bodies if any(joint.is_sprung for joint in body.joints)]
    odd = [note for note in model.notes if "line " in note.split(":")[0]]
    odd += [body.refusal for body in model.bodies if body.refusal]
    odd += [joint.refusal for body in model.bodies for joint in body.joints if joint.refusal]
    odd += [
        f"{joint.name} on body {body.name} {NO_SPRING}"
        for body in model.bodies
        for joint in body.joints
        if joint.kind == "ball" and not joint.is_sprung
    ]
    odd += [
        f"{joint.name} on body {body.name} is a {joint.kind} joint"
        + (": motion stretch judges slides along a chain, space all joints" if joint.kind == "slide" else "")
        for body in sprung
        for joint in body.joints
        if joint.kind != "hinge"
    ]
    found = f"{len(model.bodies)} bodies without"
    if sprung:
        found = f"{len(model.bodies)} bodies, {len(sprung)} of them with springs, but none on hinges alone"
    reasons = [*odd[:1], *([model.hint] if model.hint else [])]
    return "; ".join([f"must have a hinge with a spring, got {found}", *reasons])


def chosen_path(paths: Sequence[HingePath], name: str | None) -> HingePath:
    """Return the longest chain, or the one that has a body of that name; raise ValueError if none has."""
    if name is None:
        return paths[0]
    for path in paths:
        if path.has_body(name):
            return path
    names = [path.name for path in paths]
    if len(names) > _LISTED:
        raise ValueError(
            f"chain must name a body of one of {len(names)} chains, such as {names[0]}, got {shown(name)}"
        )
    return paths[names.index(choice("chain", name, names))]


def about_one_axis(model: Model) -> Iterator[tuple[str, Model]]:
    """Yield the model with hinges about one axis only, those at right angles at rest, and names of these.

    Only where about as many are at rest as are not: a single hinge about another axis, such as one that a
    whole chain turns on, is no part of the chain, and what it lets swing is not judged.
    """
    sprung = [j for body in model.bodies for j in body.joints if j.stiffness]
    axes: list[Floats] = []
    for joint in sprung:
        new = not any(are_parallel(joint.axis, axis) for axis in axes)
        if joint.kind == "hinge" and new and len(axes) < _MOST_AXES:
            axes.append(joint.axis)
    for axis in axes if len(axes) > 1 else ():
        rest = [j for j in sprung if j.kind == "hinge" and are_square(j.axis, axis)]
        counts = (len(rest), len(sprung) - len(rest))
        if 2 * min(counts) >= max(counts) - 1:
            resting = {id(joint) for joint in rest}
            bodies = tuple(
                replace(body, joints=tuple(j for j in body.joints if id(j) not in resting))
                for body in model.bodies
            )
            names = [joint.name for joint in rest]
            listed = [*names[:_LISTED], *(["..."] if len(names) > _LISTED else [])]
            yield ", ".join(listed), replace(model, bodies=bodies, in_space=True)


def without_stretch(model: Model) -> tuple[Model, list[str]]:
    """Return a model without slides along a straight chain beside its hinges, and their names.

    Stretch does not move what bends, nor is it moved by it. A slide across the chain stays, as one that is
    not on the line of the hinges.
    """
    kinds = [{joint.kind for joint in body.joints if joint.stiffness} for body in model.bodies]
    hinged = [body for body, own in zip(model.bodies, kinds, strict=True) if "hinge" in own]
    above, below = _around(model, ["hinge" in own for own in kinds])
    both = [
        body
        for i, (body, own) in enumerate(zip(model.bodies, kinds, strict=True))
        if "slide" in own and ("hinge" in own or (above[i] and below[i]))
    ]
    if not both:
        return model, []
    first, last = (next(j for j in body.joints if j.kind == "hinge") for body in (hinged[0], hinged[-1]))
    along = last.position - first.position if len(hinged) > 1 else both[0].inertial.centre - first.position
    size = float(np.linalg.norm(along))
    if size < _NO_LENGTH:
        return model, []
    at_rest = {
        id(joint): joint.name
        for body in both
        for joint in body.joints
        if joint.kind == "slide" and joint.stiffness and are_parallel(joint.axis, along / size)
    }
    bodies = tuple(
        replace(body, joints=tuple(j for j in body.joints if id(j) not in at_rest)) for body in model.bodies
    )
    return replace(model, bodies=bodies), list(at_rest.values())


def _around(model: Model, marked: Sequence[bool]) -> tuple[list[bool], list[bool]]:
    """Return which bodies are marked or carried by such ones, and which carry such ones."""
    above, below = list(marked), [False] * len(marked)
    for i, body in enumerate(model.bodies):
        above[i] |= body.parent >= 0 and above[body.parent]
    for i, body in reversed(list(enumerate(model.bodies))):
        if body.parent >= 0:
            below[body.parent] |= below[i] or marked[i]
    return above, below


def with_motors_held(model: Model) -> tuple[Model, list[str]]:
    """Return a model whose joints without springs in a chain or at its tip are held, and their names.

    No beam has a hinge inside: who says what a beam's ends are says that a motor holds such an elbow, or what
    carries a hand at the tip and its fingers; so is a slide without a spring that shifts a link on springs,
    as of a catheter that is pushed in.
    """
    sprung = [any(joint.is_sprung for joint in body.joints) for body in model.bodies]
    above, below = _around(model, sprung)
    bodies, names = list(model.bodies), []
    for i, body in enumerate(model.bodies):
        loose = bool(body.joints) and not sprung[i] and above[i]
        elbow = below[i] and all(joint.kind == "hinge" for joint in body.joints)
        hand = not below[i] and body.parent >= 0 and not below[body.parent]
        if loose and (elbow or hand):
            bodies[i] = replace(body, joints=())
            names += [joint.name for joint in body.joints]
        pushed = [joint for joint in body.joints if joint.kind == "slide" and not joint.is_sprung]
        if sprung[i] and pushed:
            bodies[i] = replace(body, joints=tuple(j for j in body.joints if j not in pushed))
            names += [joint.name for joint in pushed]
    return replace(model, bodies=tuple(bodies)), names


def _is_sprung(group: Group) -> bool:
    """Return True if a group is on hinges only, at least one with a spring, or on a ball with one."""
    hinges = bool(group.joints) and all(joint.kind == "hinge" for joint in group.joints)
    return _is_ball(group) or (hinges and any(joint.stiffness for joint in group.joints))


def _is_ball(group: Group) -> bool:
    """Return True if a group is on a ball alone with a spring, which resists bending about all axes."""
    return len(group.joints) == 1 and group.joints[0].kind == "ball" and group.joints[0].is_sprung


def _spring_axes(group: Group) -> list[Floats]:
    return [joint.axis for joint in group.joints if joint.stiffness]


def _hinge(group: Group, axis: Floats) -> ModelJoint | None:
    """Return the only hinge with a spring about an axis, or what a ball is about it."""
    if _is_ball(group):
        stiffness = group.joints[0].stiffness_about(axis)
        return replace(group.joints[0], kind="hinge", axis=axis, stiffness=stiffness) if stiffness else None
    found = [joint for joint in group.joints if joint.kind == "hinge" and are_parallel(joint.axis, axis)]
    return found[0] if len(found) == 1 and found[0].stiffness else None


def _next(group: Group) -> Group | None:
    """Return the only group after it whose hinge is about the same axis."""

    def goes_on(child: Group) -> bool:
        alike = _is_ball(group) or _is_ball(child)
        return _is_sprung(child) and (alike or any(_hinge(child, axis) for axis in _spring_axes(group)))

    found = [child for child in group.children if goes_on(child)]
    return found[0] if len(found) == 1 else None


@dataclass(frozen=True, eq=False)
class HingeLine:
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
        """The mean distance between hinges, 0 for one hinge."""
        count = len(self.places) - 1
        return (self.places[-1] - self.places[0]) / count if count else 0.0

    def place(self, point: Floats) -> float:
        """Return how far along the chain a point is."""
        return float((point - self.origin) @ self.along)

    def off_line(self, point: Floats) -> float:
        """Return a point's distance from the line, in the plane of bending."""
        return abs(float((point - self.origin) @ self.across))

    def moment(self, inertial: Inertial) -> float:
        """Return the moment of inertia about the axis of bending."""
        return float(self.axis @ inertial.inertia @ self.axis)


def hinge_line(path: HingePath, axis: Floats) -> HingeLine:
    """Return the line on which a chain's hinges lie; refuse hinges on none, or that fold back."""
    hinges = tuple(path.hinges(axis))
    first, last, tip = hinges[0], hinges[-1], path.groups[-1]
    origin = first.position
    if len(hinges) > 1:
        ways = [last.position - origin]
    else:
        reach = [tip.inertial.centre] if tip.inertial.mass else tip.extent[:1]
        # Else the hinge on which the piece before turns says where the line runs.
        before = [joint.position for joint in path.root.joints if joint.kind == "hinge"]
        ways = [*(point - origin for point in reach), *(origin - point for point in before[::-1])]
    ways = [way - (way @ axis) * axis for way in ways]
    along = next((way for way in ways if np.linalg.norm(way) >= _NO_LENGTH), None)
    if along is None:
        if np.linalg.norm(last.position - origin) > _NO_LENGTH:
            raise BadModel(
                f"hinge {last.name} must not turn about the chain's own line: motion twist judges it"
            )
        if len(hinges) > 1:
            raise BadModel(f"hinges {first.name} and {last.name} must be apart: both are at one place")
        raise BadModel(
            f"body {tip.name} on hinge {first.name} must have its centre of mass beside that hinge: as it "
            "is, it only spins there, and no line says where a beam would run"
        )
    size = float(np.linalg.norm(along))
    along = along / size
    places = tuple(float((hinge.position - origin) @ along) for hinge in hinges)
    line = HingeLine(axis, along, origin, hinges, places)
    for i, hinge in enumerate(hinges):
        if line.off_line(hinge.position) > OFF_LINE * (line.spacing or size):
            raise BadModel(
                f"hinge {hinge.name} must be on one straight line with the others at rest: a curved chain "
                'is judged by motion="space" beside the rod of its shape (--motion space --shape '
                '"arc(angle=1.5)")'
            )
        # The first two may be at one place: a support's spring, a body of no length, the beam's own.
        if i and (places[i] < places[i - 1] or (i > 1 and places[i] == places[i - 1])):
            raise BadModel(f"hinge {hinge.name} must be further along the chain than {hinges[i - 1].name}")
    return line


def lone_segment(group: Group, line: HingeLine) -> tuple[float, Inertial] | None:
    """Return length and matter of the segment on a chain's last hinge, or None if its body shows none.

    Of several solids it is the one that begins at the hinge: others are what the segment carries. A body
    that is one solid or one number is as long as its geometry, or as twice the way to its centre of mass.
    """
    hinge, body = line.places[-1], group.bodies[0]
    for solid in body.solids if len(body.solids) > 1 else ():
        reach = sorted(line.place(end) - hinge for end in solid.ends)
        centre = line.place(solid.inertial.centre) - hinge
        if solid.inertial.mass and len(reach) > 1 and reach[-1] > 0:
            slack = _SEGMENT * reach[-1]
            if abs(reach[0]) <= slack and abs(centre - reach[-1] / 2) <= slack:
                return reach[-1], solid.inertial
    own = body.inertial
    centre = line.place(own.centre) - hinge
    length = max((line.place(point) - hinge for point in body.extent), default=0.0) or 2 * centre
    if not own.mass or length <= _ROUNDED * abs(centre) or not 0 <= centre <= length * (1 + _ROUNDED):
        return None
    return length, own


def moves_alone(root: Group) -> bool:
    """Return True if what carries the chain moves on the ground, and nothing else moves on it.

    What is part of a larger mechanism is judged as if it were held, and the audit says so.
    """
    return root.parent is not None and root.parent.parent is None and len(root.children) == 1


def check_carrier(path: HingePath, line: HingeLine) -> None:
    """Refuse a chain on a body whose motion matters to it, and which only the user can say is held.

    Such a body is free in space with other bodies, or a hinge without a spring joins it to one that bends in
    the same plane, or it moves in that plane with other springs.
    """
    root = path.root
    carrier = f"which carries the chain at body {path.name},"
    ask = "say by boundary what the chain's ends are"
    elbow: ModelJoint | None = None
    group: Group | None = root
    row: list[Group] = []
    while group is not None:
        row.append(group)
        group = group.parent
    if any(j.kind == "free" for each in row for j in each.joints) and not moves_alone(root):
        raise BadModel(
            f"body {root.name}, {carrier} is free in space and moves with all that it carries: {ask}, such "
            "as clamped-free if the body is held"
        )
    for each in row[:-1]:
        for joint in each.joints:
            if joint.stiffness and elbow and not are_square(joint.axis, line.axis):
                raise BadModel(
                    f"{elbow.name}, {carrier} has no spring and is carried by hinge {joint.name} with a "
                    f"spring: {ask}; a motor between hinges with springs is then held, and all bend as one "
                    "chain"
                )
        elbow = elbow or next((joint for joint in each.joints if not joint.stiffness), None)
    others = [child for child in root.children if child is not path.groups[0]]
    # Such a hub rings with all that it carries; held, each of its chains rings alone.
    for joint in root.joints if any(j.stiffness for child in others for j in child.joints) else ():
        turns = joint.kind == "hinge" and not are_square(joint.axis, line.axis)
        shifts = joint.kind == "slide" and not are_square(joint.axis, line.across)
        if turns or shifts or joint.kind == "ball":
            raise BadModel(
                f"body {root.name}, {carrier} moves on joint {joint.name} with other springs that it "
                f"carries: {ask}, such as clamped-free if the body is held"
            )


@dataclass(frozen=True)
class RootSupport:
    """Stiffnesses across and in turning under a root that moves, and the joints of both kinds.

    `in_space` says that another joint moves the chain out of its plane; `why` what is assumed, if this is not
    all that the file lets move.
    """

    across: float = math.inf
    turning: float = math.inf
    slide: ModelJoint | None = None
    hinge: ModelJoint | None = None
    in_space: bool = False
    why: str = ""


def root_support(path: HingePath, line: HingeLine) -> RootSupport | None:
    """Return what supports a root that moves, None if the ground carries it or a body taken as held.

    A hinge without a spring on a larger mechanism is the chain's own pinned end, if the piece that it turns
    is a segment like the next. Joints oblique to the chain, or that move it across by a lever, are refused.
    """
    if not moves_alone(path.root):
        return _own_pinned_end(path, line)
    found = RootSupport()
    for joint in path.root.joints:
        if joint.refusal:
            raise BadModel(joint.refusal)
        if joint.kind == "free":
            found = replace(found, across=0.0, turning=0.0)
        elif joint.kind == "slide" and not are_square(joint.axis, line.across):
            _check_joint(joint, line.across, found.slide)
            if joint.armature:
                raise BadModel(f"joint {joint.name} must have no armature: only that of hinges is read")
            found = replace(found, across=joint.stiffness, slide=joint)
        elif joint.kind == "hinge" and not are_square(joint.axis, line.axis):
            _check_joint(joint, line.axis, found.hinge)
            found = replace(found, turning=joint.stiffness, hinge=joint)
        elif joint.kind == "ball":
            _check_joint(joint, joint.axis, found.hinge)
            hinge = replace(joint, kind="hinge", axis=line.axis)
            found = replace(found, turning=0.0, hinge=hinge, in_space=True)
        elif joint.kind == "hinge":
            _check_out_of_plane(joint, line)
            why = f"joint {joint.name}, which turns the chain out of its plane, is taken as at rest"
            found = replace(found, in_space=True, why=why)
    return found


def _own_pinned_end(path: HingePath, line: HingeLine) -> RootSupport | None:
    root = path.root
    if len(root.joints) != 1 or len(root.children) != 1 or root.parent is None:
        return None
    (joint,) = root.joints
    length = -line.place(joint.position)
    first = path.groups[0]
    size, other = lone_segment(first, line) or (0.0, first.inertial)
    if len(line.places) > 1:
        size, other = line.places[1] - line.places[0], first.inertial
    on_line = are_parallel(joint.axis, line.axis) and line.off_line(joint.position) <= OFF_LINE * size
    if joint.kind != "hinge" or joint.stiffness or not on_line or length <= 0:
        return None
    # A segment has its share of mass, at the same share of its length, as the next one.
    own = root.inertial
    if not size or not other.mass or abs(own.mass / other.mass * size / length - 1) > _SEGMENT:
        return None
    if abs(1 + line.place(own.centre) / length - line.place(other.centre) / size) > _SEGMENT:
        return None
    if joint.refusal:
        raise BadModel(joint.refusal)
    why = (
        f"hinge {joint.name} has no spring and is the chain's pinned end; body {root.parent.name}, which "
        "carries it and moves, is taken as held"
    )
    return RootSupport(turning=0.0, hinge=joint, why=why)


def _check_joint(joint: ModelJoint, direction: Floats, before: ModelJoint | None) -> None:
    if not are_parallel(joint.axis, direction):
        raise BadModel(f"joint {joint.name} must be along or across the chain, got an oblique axis")
    if before is not None:
        raise BadModel(f"joint {joint.name} must not move the chain as {before.name} does: one too many")


def _check_out_of_plane(joint: ModelJoint, line: HingeLine) -> None:
    """Refuse a hinge at right angles to those of the chain that moves it in their plane too."""
    lever = float(np.cross(joint.axis, line.origin - joint.position) @ line.across)
    if abs(lever) > OFF_LINE * (line.spacing or 1.0):
        raise BadModel(
            f"joint {joint.name} must be on the line of the chain's hinges: at {abs(lever):.3g} m beside "
            "it, it moves the whole chain across"
        )
    if joint.stiffness:
        raise BadModel(
            f"joint {joint.name} must be parallel to {line.hinges[0].name}: what its spring lets swing out "
            "of the plane of bending is not judged"
        )
