"""The ends of a chain from a file: what supports them, and which part of the outer pieces is a body there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.problem.ends import Boundary, End

__all__ = [
    "NOTABLE",
    "SAME",
    "JudgedChain",
    "Piece",
    "PlanarChain",
    "Spring",
    "held_piece",
    "judged_chains",
    "rod_like",
    "with_wall_hinges",
    "without_body",
]


# Rigid pieces as numbers: rods, bodies taken off them, pieces that the ground holds behind a spring.

#: Differences of measured or rounded numbers below these shares are none.
SAME, NOTABLE = 1e-6, 1e-3


#: What engines that want some mass of every body get is less of the chain's.
_TRACE = 1e-9


@dataclass(frozen=True)
class Piece:
    """Length [m], mass [kg], centre of mass from the near tip [m] and inertia about that [kg m²]."""

    length: float
    mass: float
    centre: float
    inertia: float


@dataclass(frozen=True)
class Spring:
    """One hinge: its name, stiffness [N m/rad], damping [N m s/rad] and armature [kg m²]."""

    name: str
    stiffness: float
    damping: float = 0.0
    armature: float = 0.0


@dataclass(frozen=True)
class PlanarChain:
    """Pieces from root to tip, the springs between them, and stiffnesses of the supports.

    Attributes
    ----------
    pieces : tuple of Piece
    springs : tuple of Spring
    near, far : (float, float)
        Across and in turning, of the outer pieces; infinite where held.
    near_hinge : Spring or None
        The hinge behind `near`, for its damping and armature.
    assumed : tuple of str
        What was taken for granted in reading it so.
    segment : Piece or None
        What segments are made of, where no piece between two hinges shows it.
    """

    pieces: tuple[Piece, ...]
    springs: tuple[Spring, ...]
    near: tuple[float, float]
    far: tuple[float, float]
    near_hinge: Spring | None = None
    assumed: tuple[str, ...] = ()
    segment: Piece | None = None


def held_piece(length: float, others: Sequence[Piece]) -> Piece:
    """Return a piece that does not turn, as heavy for its length as others: of no file's own numbers."""
    rods = [piece.mass / piece.length for piece in others[:-1] or others if piece.length]
    share = length * float(np.median(rods)) if rods else 0.0
    return Piece(length, share, length / 2, share * length**2 / 12)


def with_wall_hinges(chain: PlanarChain, far: str, length: float) -> PlanarChain:
    """Return a chain whose springs to the ground are hinges to pieces of their own, as wall springs are.

    A body of no length at an end keeps the spring as its support: the rule's own spring follows it.

    Parameters
    ----------
    chain : PlanarChain
    far : str
        Name for the far one.
    length : float [m]
        Of the beam: what it has beyond the far hinge is a piece that the ground holds.
    """
    pieces = [_without_traces(piece, chain.pieces) for piece in chain.pieces]
    springs, ends = list(chain.springs), [chain.near, chain.far]
    turning = chain.near_hinge
    if ends[0][1] == math.inf and len(pieces) > 2 and pieces[0].length == pieces[1].length == 0:
        turning = springs[0]
        ends[0] = (ends[0][0], turning.stiffness)
        del pieces[0], springs[0]
    if 0 < ends[0][1] < math.inf and pieces[0].length:
        pieces.insert(0, held_piece(0.0, ()))
        springs.insert(0, replace(turning or Spring("near end", 0.0), stiffness=ends[0][1]))
        ends[0] = (chain.near[0], math.inf)
        turning = None
    assumed = chain.assumed
    if turning and ends[0][1] < math.inf:
        # The armature of a hinge on which all turns is inertia of the first piece's own rotation.
        pieces[0] = replace(pieces[0], inertia=pieces[0].inertia + turning.armature)
        if turning.damping:
            why = f"the damping of {turning.name}, on which the chain turns as a whole, is left out"
            assumed = (*assumed, why)
    if 0 < chain.far[1] < math.inf and pieces[-1].length:
        missing = length - sum(piece.length for piece in pieces)
        typical = max(piece.length for piece in pieces)
        stub = held_piece(missing if 1e-9 * length < missing < 1.05 * typical else 0.0, pieces)
        pieces.append(stub)
        springs.append(Spring(far, chain.far[1]))
        ends[1] = (chain.far[0], math.inf)
    return replace(
        chain,
        pieces=tuple(pieces),
        springs=tuple(springs),
        near=ends[0],
        far=ends[1],
        assumed=assumed,
    )


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
    """Return a rod of another length and the same kind: slender, of some section, or mass at its ends."""
    share = length / rod.length
    mass = rod.mass * share
    ratio = rod.inertia / (rod.mass * rod.length**2)
    kind = 1 / 4 if abs(ratio - 1 / 4) < NOTABLE else min(ratio, 1 / 12)
    section = (ratio - kind) * rod.mass * rod.length
    return Piece(length, mass, share * rod.centre, kind * mass * length**2 + section * length)


@dataclass(frozen=True)
class JudgedChain:
    """A chain's pieces without the bodies at its ends, which `boundary` has; `said` if the user said so."""

    boundary: Boundary
    pieces: tuple[Piece, ...]
    springs: tuple[Spring, ...]
    assumed: tuple[str, ...] = ()
    said: bool = False

    @property
    def unevenness(self) -> float:
        """How much of mass and inertia the pieces have that rods like the middle one have not, in its own."""
        rods = [piece for piece in self.pieces[1:-1] if piece.length] or [max(self.pieces, key=_length)]
        middle = rods[len(rods) // 2]
        size = middle.mass * middle.length**2
        off = 0.0
        for piece in self.pieces:
            due = rod_like(middle, piece.length) if piece.length else held_piece(0.0, ())
            off += abs(piece.mass - due.mass) / middle.mass + abs(piece.inertia - due.inertia) / size
        return off


def judged_chains(chain: PlanarChain, given: Boundary | None) -> list[JudgedChain]:
    """Return a chain with its ends; more than one reading if `given` fits in both orders.

    Without `given`, a spring between ground and beam is the rule's wall spring at an end that the ground
    holds, and what an outer piece has beyond a rod like its neighbour's is a body at that end. With it, the
    bodies and springs of `given` are taken out of the outer pieces.

    Raises
    ------
    ValueError
        If `given` holds what the file lets move, or its bodies are heavier than the pieces.
    """
    if given is None:
        return [_inferred(chain)]
    orders = (given, given.turned) if given != given.turned else (given,)
    read, refusals = [], []
    for pair in orders:
        if _fits(chain.near, pair.left) and _fits(chain.far, pair.right):
            try:
                read.append(_stated(chain, pair))
            except ValueError as error:
                # Ends that are alike but for a number may fit in the other order only.
                refusals.append(error)
    if read:
        return read
    if refusals:
        raise refusals[-1]
    # URDF cannot support the far end, and other constraints are not read: there the user's word counts.
    for pair in orders:
        if _fits(chain.near, pair.left) and chain.far == (0.0, 0.0):
            held = replace(chain, far=_supports(pair.right))
            stated = _stated(held, pair)
            said = f"the far end is {pair.right} because you say so"
            return [replace(stated, assumed=(*stated.assumed, said))]
    found = _inferred(chain).boundary
    raise ValueError(f"boundary must fit the file, whose ends are {found}, got {given}")


def _length(piece: Piece) -> float:
    return piece.length


def _supports(end: End) -> tuple[float, float]:
    return float(end.translational_stiffness), float(end.rotational_stiffness)


def _fits(supports: tuple[float, float], end: End) -> bool:
    """Whether an end's word and springs can be what supports a chain there."""
    (across, turning), (own_across, own_turning) = supports, _supports(end)
    alike = across == own_across or abs(across - own_across) <= SAME * across < math.inf
    if turning in (0.0, math.inf):
        # Behind a wall hinge an end may give way in turning.
        return alike and (own_turning > 0) == (turning > 0)
    return alike and own_turning > 0


def _inferred(chain: PlanarChain) -> JudgedChain:
    pieces = list(chain.pieces)
    if chain.far[0] < chain.far[1] == math.inf:
        _pass_point_on(pieces)
    ends = []
    for at, supports in ((0, chain.near), (-1, chain.far)):
        between = [piece for piece in pieces[1:-1] if piece.length]
        own = _mirrored(pieces[0]) if at == 0 else pieces[-1]
        neighbour = between[at] if between else chain.segment
        if neighbour and at == 0:
            neighbour = _mirrored(neighbour)
        # Ten digits: what is beyond is left from taking the rod off.
        mass, inertia, offset = (float(f"{value:.10g}") for value in _body(own, neighbour, supports))
        # A body that is rigid with a segment has no hinge of its own to the beam.
        carried = bool(own.length and (inertia or offset)) and supports[1] < math.inf
        ends.append(End(*supports, mass, inertia, offset, on_segment=carried))
        rest = without_body(own, ends[-1])
        pieces[at] = _mirrored(rest) if at == 0 else rest
    return JudgedChain(Boundary(*ends), tuple(pieces), chain.springs, chain.assumed)


def _stated(chain: PlanarChain, given: Boundary) -> JudgedChain:
    pieces, springs = list(chain.pieces), list(chain.springs)
    sides = ((0, given.left, chain.near), (-1, given.right, chain.far))
    for at, end, (_, turning) in sides:
        if springs and 0 < end.rotational_stiffness < turning == math.inf:
            _take_support_out(pieces, springs, at, float(end.rotational_stiffness))
    if chain.far[0] < chain.far[1] == math.inf and pieces[-1] == chain.pieces[-1]:
        _pass_point_on(pieces)
    for at, end, _ in sides:
        mass, inertia, offset = end.moving_body
        if pieces[at] == held_piece(0.0, ()) and mass and not inertia and not offset and len(pieces) > 1:
            # A point on a hinge moves with the piece beyond it.
            at = 1 if at == 0 else -2
        own = _mirrored(pieces[at]) if at >= 0 else pieces[at]
        rest = without_body(own, end)
        pieces[at] = _mirrored(rest) if at >= 0 else rest
    return JudgedChain(given, tuple(pieces), tuple(springs), chain.assumed, said=True)


def _take_support_out(pieces: list[Piece], springs: list[Spring], at: int, support: float) -> None:
    """Leave of an outer spring what is not the end's own: the rule's wall spring, in series with it."""
    hinge = springs[at]
    spring = hinge.stiffness
    if abs(spring / support - 1) <= SAME:
        # Nothing but the support: the rule puts no hinge there.
        del pieces[at], springs[at]
    elif spring < support:
        springs[at] = replace(hinge, stiffness=1 / (1 / spring - 1 / support))
    else:
        raise ValueError(
            f"boundary must have a rotational_stiffness above {spring:.6g}, the spring of {hinge.name}, "
            f"got {support:.6g}"
        )


def _pass_point_on(pieces: list[Piece]) -> None:
    """Give a last piece that does not turn the mass that the one before carries as a point at their hinge.

    What slides with a beam's tip without turning moves as such a point, and files have it so.
    """
    rods = [piece for piece in pieces[:-2] if piece.length]
    if not rods:
        # Nothing tells how heavy the piece is; the point stays where it is, so the piece has no mass.
        pieces[-1] = held_piece(0.0, ())
        return
    before, rod = pieces[-2], rod_like(rods[-1], pieces[-2].length)
    point = before.mass - rod.mass
    if point > NOTABLE * rod.mass:
        pieces[-2] = without_body(before, End(mass=point))
        pieces[-1] = replace(pieces[-1], mass=point)


def _mirrored(piece: Piece) -> Piece:
    return replace(piece, centre=piece.length - piece.centre)


def _body(piece: Piece, neighbour: Piece | None, supports: tuple[float, float]) -> tuple[float, float, float]:
    """Return mass, inertia and offset of what a piece has at its far tip beyond a rod like its neighbour."""
    none = (0.0, 0.0, 0.0)
    if supports == (math.inf, math.inf):
        return none
    if not piece.length:
        return (piece.mass, piece.inertia, piece.centre) if piece.mass else (0.0, piece.inertia, 0.0)
    if neighbour is None or not neighbour.length:
        return none
    if supports[1] == math.inf:
        extra = piece.mass - rod_like(neighbour, piece.length).mass
        return (extra, 0.0, 0.0) if extra > NOTABLE * piece.mass else none
    rod = rod_like(neighbour, piece.length)
    mass, scale = piece.mass - rod.mass, rod.mass * piece.length**2
    if mass < -SAME * rod.mass:
        return none
    if mass <= NOTABLE * rod.mass:
        # As heavy as a segment: another rotary inertia is the segment's own, and is reported as such.
        return none
    arm = (piece.mass * piece.centre - rod.mass * rod.centre) / mass
    extra = piece.inertia - rod.inertia - rod.mass * mass / piece.mass * (arm - rod.centre) ** 2
    offset = arm - piece.length
    if extra < -NOTABLE * scale:
        return none
    return mass, extra if extra > SAME * scale else 0.0, offset if abs(offset) > SAME * piece.length else 0.0
