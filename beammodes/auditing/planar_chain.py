"""A serial chain of a model in one plane: pieces on a straight line, springs between them, what holds the ends.

::

      near  |  piece 0 --spring-- piece 1 --spring-- ... --spring-- last piece  |  far
             s runs along the beam, from the chain's root to its tip

Where the ground itself carries the first hinge, piece 0 is what is rigid with the ground: of no length, or a
welded segment. A file does not say where a beam begins and ends, only where its hinges are; geometry, centres of
mass and neighbours suggest lengths of the outer pieces, and of these the ones are taken that come nearest to the
beam's length in sum. They do not touch the frequencies of a chain with a free or clamped end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Group, ModelJoint
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.far_ties import FarEnd
from beammodes.auditing.serial_chains import PARALLEL, HingePath
from beammodes.problem.supports import End

__all__ = [
    "NOTABLE",
    "SAME",
    "Frame",
    "Piece",
    "PlanarChain",
    "RootSupport",
    "frame_of",
    "held_piece",
    "moves_alone",
    "planar_chain",
    "rod_like",
    "root_support",
    "with_wall_hinges",
    "without_body",
]

Array = NDArray[np.float64]

#: How far off the line hinges and centres of mass may be, in mean distances between hinges; the error in a
#: frequency is of the order of its square.
_OFF_LINE = 1e-4
#: Differences of measured or rounded numbers below these shares are none.
SAME, NOTABLE = 1e-6, 1e-3
#: What engines that want some mass of every body get is less of the chain's.
_TRACE = 1e-9


@dataclass(frozen=True)
class Piece:
    """A rigid piece: length [m], mass [kg], centre of mass from its near tip [m], inertia about that [kg m²]."""

    length: float
    mass: float
    centre: float
    inertia: float


@dataclass(frozen=True)
class PlanarChain:
    """Pieces from root to tip, the springs between them with names, and stiffnesses of the supports.

    Attributes
    ----------
    pieces : tuple of Piece
    springs : tuple of (str, float)
    near, far : (float, float)
        Across and in turning, of the outer pieces; infinite where held.
    """

    pieces: tuple[Piece, ...]
    springs: tuple[tuple[str, float], ...]
    near: tuple[float, float]
    far: tuple[float, float]


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
        raise BadModel(f"hinges {hinges[0].name} and {hinges[-1].name} must be apart, along a straight line")
    along = along / size
    places = tuple(float((hinge.position - origin) @ along) for hinge in hinges)
    frame = Frame(axis, along, origin, hinges, places)
    spacing = frame.spacing or size
    for i, hinge in enumerate(hinges):
        if frame.off_line(hinge.position) > _OFF_LINE * spacing:
            raise BadModel(f"hinge {hinge.name} must be on one straight line with the others at rest")
        if i and places[i] <= places[i - 1]:
            raise BadModel(f"hinge {hinge.name} must be further along the chain than {hinges[i - 1].name}")
    return frame


def planar_chain(path: HingePath, frame: Frame, far: FarEnd, length: float) -> PlanarChain:
    """Return a chain's numbers in one plane.

    Parameters
    ----------
    path : HingePath
    frame : Frame
        From `frame_of`.
    far : FarEnd
        What ties hold of its tip.
    length : float [m]
        Of the beam.

    Raises
    ------
    BadModel
        If something moves on the chain that is no part of it, or cannot be honoured.
    """
    _check(path, frame)
    root = root_support(path.root, frame)
    moves = root is not None
    span = frame.places[-1] - frame.places[0]
    starts = _starts(path.root, frame) if moves else _stubs(path.root, frame)
    if far.place is not None:
        ends = [far.place - frame.places[-1]]
    else:
        ends = _lengths(path.groups[-1], frame, frame.places[-1], 1.0)
        # Before a hinge to something held the body ends there, wherever the beam does.
        if far.turning:
            ends, starts = [next(filter(None, ends), 0.0)], starts[:1] if moves else starts
    start, end = _nearest(starts, ends, length - span)
    cuts = [frame.places[0] - start, *frame.places, frame.places[-1] + end]
    groups = [path.root if moves else None, *path.groups]
    pieces = [_piece(group, frame, *cut) for group, cut in zip(groups, itertools.pairwise(cuts), strict=True)]
    if not moves:
        pieces[0] = held_piece(start, pieces[1:])
    springs = tuple((hinge.name, hinge.stiffness) for hinge in frame.hinges)
    support = root or RootSupport()
    return PlanarChain(tuple(pieces), springs, (support.across, support.turning), (far.across, far.turning))


def _nearest(starts: Sequence[float], ends: Sequence[float], rest: float) -> tuple[float, float]:
    """Return the pair whose sum is nearest; of several, the one whose numbers stand first, the end's above all."""
    pairs = itertools.product(enumerate(ends), enumerate(starts))
    off = [(round(abs(start + end - rest) / (abs(rest) or 1.0), 5), j, i) for (j, end), (i, start) in pairs]
    _, j, i = min(off)
    return starts[i], ends[j]


def held_piece(length: float, others: Sequence[Piece]) -> Piece:
    """Return a piece that does not turn, as heavy for its length as others: of no file's own numbers."""
    rods = [piece.mass / piece.length for piece in others[:-1] or others if piece.length]
    share = length * float(np.median(rods)) if rods else 0.0
    return Piece(length, share, length / 2, share * length**2 / 12)


def _check(path: HingePath, frame: Frame) -> None:
    for group, after in itertools.zip_longest(path.groups, path.groups[1:]):
        for other in group.children:
            if other is not after:
                raise BadModel(
                    f"joint {other.joints[0].name} on body {group.name} must be a hinge with a spring, parallel "
                    f"to {frame.hinges[0].name}: nothing else may move on the chain"
                )
        refusals = [body.refusal for body in group.bodies] + [joint.refusal for joint in group.joints]
        for why in filter(None, refusals):
            raise BadModel(why)
    root = [path.root] if moves_alone(path.root) else []
    for group in (*root, *path.groups):
        _check_matter(group, path, frame)


def _check_matter(group: Group, path: HingePath, frame: Frame) -> None:
    inertial, spacing = group.inertial, frame.spacing or abs(frame.place(group.inertial.centre))
    if not inertial.mass:
        raise BadModel(f"body {group.name} must have a mass greater than 0")
    two = len(path.planes()) > 1
    off = inertial.centre - frame.origin - frame.place(inertial.centre) * frame.along
    distance = float(np.linalg.norm(off)) if two else frame.off_line(inertial.centre)
    if distance > max(_OFF_LINE * spacing, 1e-12):
        raise BadModel(f"body {group.name} must have its centre of mass on the line of the hinges")
    product = abs(float(frame.axis @ inertial.inertia @ frame.across))
    if two and product > _OFF_LINE * float(np.trace(inertial.inertia)):
        raise BadModel(f"body {group.name} must have its principal axes along the hinges'")


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
            found = replace(found, across=joint.stiffness, slide=joint)
        elif joint.kind == "hinge" and abs(joint.axis @ frame.axis) > PARALLEL:
            _check_parallel(joint, frame.axis)
            found = replace(found, turning=joint.stiffness, hinge=joint)
    return found


def _check_parallel(joint: ModelJoint, direction: Array) -> None:
    if np.linalg.norm(np.cross(joint.axis, direction)) > PARALLEL:
        raise BadModel(f"joint {joint.name} must be along or across the chain, got an oblique axis")


def _piece(group: Group | None, frame: Frame, start: float, end: float) -> Piece:
    if group is None:
        return Piece(end - start, 0.0, 0.0, 0.0)
    inertial = group.inertial
    about = float(frame.axis @ inertial.inertia @ frame.axis)
    if about < 0:
        raise BadModel(f"body {group.name} must have an inertia of at least 0, got {about:.3g}")
    return Piece(end - start, inertial.mass, frame.place(inertial.centre) - start, about)


def _starts(root: Group, frame: Frame) -> list[float]:
    """Return what the length of a first piece that moves may be: from its joints on, or as `_lengths`."""
    joints = [-frame.place(joint.position) for joint in root.joints if joint.kind in ("hinge", "slide")]
    return [*(value for value in joints if value >= 0), *_lengths(root, frame, 0.0, -1.0)]


def _lengths(group: Group, frame: Frame, hinge: float, way: float) -> list[float]:
    """Return what the length of an outer piece that moves may be, `way` from its hinge."""
    reach = [way * (frame.place(point) - hinge) for point in group.extent]
    double = 2 * way * (frame.place(group.inertial.centre) - hinge)
    spaces = np.diff(frame.places).tolist()
    near = spaces[:1] if way < 0 else spaces[-1:]
    found = [max(reach, default=0.0), double, *near, 0.0]
    return [value for value in found if value >= 0]


def _stubs(root: Group, frame: Frame) -> list[float]:
    """Return what the length of the piece that is rigid with the ground may be."""
    places = [body.origin for body in root.bodies if frame.off_line(body.origin) < PARALLEL + frame.spacing]
    places += [np.zeros(3), *(point for body in root.bodies for point in body.extent)]
    found = {round(-frame.place(point), 15) for point in places if frame.off_line(point) <= frame.spacing}
    longest = 1.5 * frame.spacing if frame.spacing else math.inf
    return [0.0, *sorted(value for value in found if 0 < value <= longest)]


def with_wall_hinges(chain: PlanarChain, near: str, far: str, length: float) -> PlanarChain:
    """Return a chain whose springs to the ground are hinges to pieces of their own, as a rule's wall spring is.

    A body of no length at an end keeps the spring as its support: the rule's own spring follows it.

    Parameters
    ----------
    chain : PlanarChain
    near, far : str
        Names for these hinges.
    length : float [m]
        Of the beam: what it has beyond the far hinge is a piece that the ground holds.
    """
    pieces = [_without_traces(piece, chain.pieces) for piece in chain.pieces]
    springs, ends = list(chain.springs), [chain.near, chain.far]
    if 0 < chain.near[1] < math.inf and pieces[0].length:
        pieces.insert(0, held_piece(0.0, ()))
        springs.insert(0, (near, chain.near[1]))
        ends[0] = (chain.near[0], math.inf)
    if 0 < chain.far[1] < math.inf and pieces[-1].length:
        missing = length - sum(piece.length for piece in pieces)
        typical = max(piece.length for piece in pieces)
        stub = held_piece(missing if 1e-9 * length < missing < 1.05 * typical else 0.0, pieces)
        pieces.append(stub)
        springs.append((far, chain.far[1]))
        ends[1] = (chain.far[0], math.inf)
    return PlanarChain(tuple(pieces), tuple(springs), ends[0], ends[1])


def _without_traces(piece: Piece, others: Sequence[Piece]) -> Piece:
    """Return a piece of no length without the mass and inertia that it has for an engine's sake only."""
    if piece.length:
        return piece
    total = sum(other.mass for other in others)
    size = sum(other.length for other in others)
    mass = piece.mass if piece.mass > _TRACE * total else 0.0
    inertia = piece.inertia if piece.inertia > _TRACE * total * size**2 else 0.0
    return Piece(0.0, mass, piece.centre if mass else 0.0, inertia)


def without_body(piece: Piece, end: End) -> Piece:
    """Return a piece without the body at its far tip, the end there.

    Raises
    ------
    ValueError
        If the body has more than the piece.
    """
    mass, inertia, offset = map(float, end.moving_body)
    if not mass and not inertia:
        return piece
    rest = piece.mass - mass
    if rest < -SAME * piece.mass:
        raise ValueError(
            f"boundary must have bodies lighter than their pieces, got {mass:.6g} > {piece.mass:.6g}"
        )
    if rest <= SAME * piece.mass and not piece.length:
        return held_piece(0.0, ())
    rest = max(rest, 0.0)
    if end.holds_rotation:
        # Only the mass of what does not turn counts.
        return Piece(piece.length, rest, piece.length / 2, rest * piece.length**2 / 12)
    arm = piece.length + offset
    centre = (piece.mass * piece.centre - mass * arm) / rest if rest else piece.centre
    about = piece.inertia - inertia
    about -= rest * mass / piece.mass * (arm - centre) ** 2 if piece.mass else 0.0
    if about < -NOTABLE * max(rest * piece.length**2, SAME * piece.inertia):
        raise ValueError(f"boundary must have bodies of less inertia than their pieces, got {inertia:.6g}")
    return Piece(piece.length, rest, centre, max(about, 0.0))


def rod_like(rod: Piece, length: float) -> Piece:
    """Return a rod of another length, of the same kind: slender, of some section, or with its mass at its ends."""
    mass = rod.mass * length / rod.length
    ratio = rod.inertia / (rod.mass * rod.length**2)
    kind = 1 / 4 if abs(ratio - 1 / 4) < NOTABLE else min(ratio, 1 / 12)
    section = (ratio - kind) * rod.mass * rod.length
    return Piece(length, mass, length / 2, kind * mass * length**2 + section * length)
