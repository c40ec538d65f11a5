"""Serial chains of hinges with springs in a tree of bodies, and the planes in which they bend."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Group, Model, ModelJoint, rigid_groups
from beammodes.auditing.bounded_xml import BadModel
from beammodes.checks import choice, shown

__all__ = ["PARALLEL", "HingePath", "chosen_path", "hinge_paths"]

Array = NDArray[np.float64]

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

    def planes(self) -> list[Array]:
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

    def _across(self) -> list[Array]:
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

    def hinges(self, axis: Array) -> list[ModelJoint]:
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


def about_one_axis(model: Model) -> Iterator[tuple[Array, Model]]:
    """Yield each axis of hinges with springs, and the model with those at right angles to it at rest.

    Only where about as many are at rest as are not: a single hinge about another axis, such as one that a
    whole chain turns on, is no part of the chain, and what it lets swing is not judged.
    """
    axes: list[Array] = []
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


def shown_axes(model: Model, axis: Array) -> list[str]:
    """Return the names of some hinges that `about_one_axis` puts at rest."""
    names = [joint.name for body in model.bodies for joint in body.joints if _rests(joint, axis)]
    return [*names[:_LISTED], *(["..."] if len(names) > _LISTED else [])]


def _rests(joint: ModelJoint, axis: Array) -> bool:
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


def _spring_axes(group: Group) -> list[Array]:
    return [joint.axis for joint in group.joints if joint.stiffness]


def _hinge(group: Group, axis: Array) -> ModelJoint | None:
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
