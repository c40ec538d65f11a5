"""A row's twist or stretch as a file has it: pieces by their inertia, springs, ends, and its audit.

Where the beam begins and ends is told as in bending, by the matter of outer pieces, with hinges across the
line in the same places.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from beammodes.auditing.axial_audit import AxialAudit, audit_axial
from beammodes.auditing.body_tree import Group, Model
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.planar_chain import Spring, far_end, planar_chain
from beammodes.auditing.serial_chains import HingePath, chosen_path, hinge_line, hinge_paths, root_support
from beammodes.auditing.space_row import STRETCH, SpaceLine, SpaceRow
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd
from beammodes.problem.beam import Beam

__all__ = ["axial_audit_of"]

#: A share of a piece's inertia that is a body's; less is the rounding of numbers in files.
_NOTABLE, _SAME = 1e-3, 1e-6


@dataclass(frozen=True)
class _Pieces:
    """Pieces and springs from root to tip, and what holds the ends."""

    length: tuple[float, ...]
    inertia: tuple[float, ...]
    springs: tuple[Spring, ...]
    ends: tuple[AxialEnd, AxialEnd]
    assumed: tuple[str, ...]


def axial_audit_of(
    model: Model,
    row: SpaceRow,
    motion: int,
    beam: Beam,
    given: AxialBoundary | None,
    modes: int,
    tolerance: float,
) -> AxialAudit:
    """Judge a row's twist or stretch, all its other coordinates at rest; errors as of `audit_file`."""
    kind = "stretch" if motion == STRETCH else "twist"
    read = _read(model, row, motion, beam.length, held=False)
    if given is None:
        read, boundary = _without_bodies(read, kind)
    else:
        read, boundary = _fitted(model, row, motion, beam.length, read, given)
    found = audit_axial(
        beam,
        boundary,
        length=read.length,
        inertia=read.inertia,
        joint_stiffness=[spring.stiffness for spring in read.springs],
        armature=[spring.armature for spring in read.springs],
        damping=[spring.damping for spring in read.springs],
        hinge_names=[spring.name for spring in read.springs],
        modes=modes,
        tolerance=tolerance,
    )
    ends = f"ends in {kind} {boundary.name}"
    word = "hinge" if kind == "twist" else "slide"
    count = len(read.springs)
    line = (
        f"chain at body {row.name}: {count} {word}{'s' * (count > 1)} with springs along its line, in {kind}"
    )
    said = given is not None
    assumed = [*([] if said else [f"{ends}, as far as the file tells"]), *read.assumed]
    return replace(found, given=(line, *([ends] if said else [])), assumed=tuple(assumed))


def _read(model: Model, row: SpaceRow, motion: int, length: float, *, held: bool) -> _Pieces:
    """Return pieces and ends of one motion; `held` if the carrier is, though the file lets it move."""
    line = row.line
    if line is None:
        raise BadModel(f"nodes of the chain at {row.name} must be on one straight line")
    own = [each.joint for each in row.coordinates if each.motion == motion and each.group >= 0]
    if not own:
        raise BadModel(f"chain at body {row.name} must have joints along its line for this motion, got none")
    path = _as_in_bending(model, row, motion, line)
    if len(path.hinges(line.axes[0])) != len(path.groups):
        raise BadModel(f"chain at body {row.name} must have one joint a body along its line, got two at one")
    hinges = hinge_line(path, line.axes[0])
    root = None if held else root_support(path, hinges)
    word = ""
    if root is None:
        moves = path.root.parent is not None
        word = f"body {path.root.name}, which carries the chain and moves, is taken as held" if moves else ""
        if held and row.is_carried:
            names = " and ".join(joint.name for joint in path.root.joints)
            word = f"{names} held, because you say so"
    far = far_end(model.ties, hinges, root)
    planar = planar_chain(path, hinges, far, length, word)
    # Behind the last may be one more, the spring of a tie at the tip.
    more = len(planar.springs) - len(path.groups)
    if more not in (0, 1):
        raise BadModel(f"hinges {hinges.hinges[0].name} and {hinges.hinges[1].name} must be apart")
    first = 0.0 if root is None else _inertia(path.root, line, motion)
    inertia = [first, *(_inertia(group, line, motion) for group in path.groups), *[0.0] * more]
    return _Pieces(
        tuple(piece.length for piece in planar.pieces),
        tuple(inertia),
        planar.springs,
        (AxialEnd(planar.near[1]), AxialEnd(planar.far[1])),
        tuple(why for why in planar.assumed if why == word or why.startswith("the beam")),
    )


def _as_in_bending(model: Model, row: SpaceRow, motion: int, line: SpaceLine) -> HingePath:
    """Return the row with a hinge across its line in place of each coordinate of the motion."""
    paths = hinge_paths(row.alone(model, motion, line.axes[0]))
    return chosen_path(paths, row.groups[-1].bodies[-1].name)


def _inertia(group: Group, line: SpaceLine, motion: int) -> float:
    """Return a piece's inertia about the line, or its mass in stretch."""
    own = group.inertial
    if motion == STRETCH:
        return own.mass
    about = float(line.along @ own.inertia @ line.along)
    found = about + own.mass * line.off_line(own.centre) ** 2
    if found < 0:
        raise BadModel(f"body {group.name} must have an inertia of at least 0, got {found:.3g}")
    return found


def _without_bodies(read: _Pieces, kind: str) -> tuple[_Pieces, AxialBoundary]:
    """Return pieces without what outer ones have beyond neighbours' inertia for a length, and the ends."""
    inertia, ends = list(read.inertia), []
    inner = list(zip(read.length, read.inertia, strict=True))[1:-1]
    density = (
        float(np.median([value / size for size, value in inner if size]))
        if any(s for s, _ in inner)
        else None
    )
    for at, end in ((0, read.ends[0]), (-1, read.ends[1])):
        size, own = read.length[at], inertia[at]
        body = 0.0
        if not end.is_fixed and not size:
            body = own
        elif not end.is_fixed and density is not None and own - density * size > _NOTABLE * own:
            body = own - density * size
        # Ten digits: what is beyond is left from taking the piece off.
        body = float(f"{body:.10g}")
        ends.append(AxialEnd(end.stiffness, body))
        inertia[at] = max(own - body, 0.0)
    return replace(read, inertia=tuple(inertia)), AxialBoundary(ends[0], ends[1], kind)


def _fitted(
    model: Model, row: SpaceRow, motion: int, length: float, read: _Pieces, given: AxialBoundary
) -> tuple[_Pieces, AxialBoundary]:
    """Return pieces without the bodies of the ends that the user gives, in the order that fits the file."""
    turned = AxialBoundary(given.right, given.left, given.motion)
    for pair in (given, turned):
        here = read
        if pair.left.is_fixed and not read.ends[0].is_fixed:
            here = _read(model, row, motion, length, held=True)
        near, far = here.ends
        fits = pair.left.stiffness == near.stiffness
        if fits and pair.right.is_fixed and far.is_free:
            # What the file cannot say, as URDF of the far end, counts as the user says it.
            said = "the far end is fixed because you say so"
            far, here = pair.right, replace(here, assumed=(*here.assumed, said))
        if fits and _alike(pair.right.stiffness, far.stiffness):
            return _less(here, pair), pair
    found = AxialBoundary(*read.ends, given.motion)
    raise ValueError(f"boundary must fit the file, whose ends in {given.motion} are {found}, got {given}")


def _alike(one: float, other: float) -> bool:
    return one == other or abs(one - other) <= _SAME * other < math.inf


def _less(read: _Pieces, pair: AxialBoundary) -> _Pieces:
    inertia = list(read.inertia)
    for at, end in ((0, pair.left), (-1, pair.right)):
        rest = inertia[at] - end.inertia
        if rest < -_SAME * inertia[at]:
            raise ValueError(
                "boundary must have bodies of less inertia than their pieces, got "
                f"{end.inertia:.6g} > {inertia[at]:.6g}"
            )
        inertia[at] = max(rest, 0.0)
    return replace(read, inertia=tuple(inertia))
