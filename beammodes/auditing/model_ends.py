"""The ends of a chain from a file: what supports them, and which part of the outer pieces is a body there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from beammodes.auditing.planar_chain import Piece, PlanarChain, Spring, held_piece
from beammodes.problem.ends import Boundary, End

__all__ = ["EndedChain", "ended_chains"]

#: Differences of measured or rounded numbers below these shares are none.
_SAME, _NOTABLE = 1e-6, 1e-3


@dataclass(frozen=True)
class EndedChain:
    """A chain's pieces without the bodies at its ends, which `boundary` has; `said` if the user said so."""

    boundary: Boundary
    pieces: tuple[Piece, ...]
    springs: tuple[Spring, ...]
    assumed: tuple[str, ...] = ()
    said: bool = False

    @property
    def unevenness(self) -> float:
        """The mass and inertia of the pieces beyond rods like the middle one, in units of its own."""
        longest = max(self.pieces, key=lambda piece: piece.length)
        rods = [piece for piece in self.pieces[1:-1] if piece.length] or [longest]
        middle = rods[len(rods) // 2]
        size = middle.mass * middle.length**2
        off = 0.0
        for piece in self.pieces:
            due = _rod_like(middle, piece.length) if piece.length else held_piece(0.0)
            off += abs(piece.mass - due.mass) / middle.mass + abs(piece.inertia - due.inertia) / size
        return off


def ended_chains(chain: PlanarChain, given: Boundary | None, *, far_by_word: bool = True) -> list[EndedChain]:
    """Return a chain with its ends; more than one reading if `given` fits in both orders.

    Without `given`, a spring between ground and beam is the rule's wall spring at an end that the ground
    holds, and what an outer piece has beyond a rod like its neighbour's is a body at that end. With it, the
    bodies and springs of `given` are taken out of the outer pieces; ends that hold what the file lets move,
    and bodies heavier than the pieces, are refused by ValueError. `far_by_word` says whether the user's word
    may hold a far end that is free in the file.
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
    for pair in orders if far_by_word else ():
        if _fits(chain.near, pair.left) and chain.far == (0.0, 0.0):
            said = f"the far end is {pair.right} because you say so"
            assumed = (*chain.assumed, said)
            return [_stated(replace(chain, far=_supports(pair.right), assumed=assumed), pair)]
    found = _inferred(chain).boundary
    raise ValueError(f"boundary must fit the file, whose ends are {found}, got {given}")


def _supports(end: End) -> tuple[float, float]:
    return float(end.translational_stiffness), float(end.rotational_stiffness)


def _fits(supports: tuple[float, float], end: End) -> bool:
    """Return True if an end's word and springs can be what supports a chain there."""
    (across, turning), (own_across, own_turning) = supports, _supports(end)
    alike = across == own_across or abs(across - own_across) <= _SAME * across < math.inf
    if turning in (0.0, math.inf):
        # Behind a wall hinge an end may give way in turning.
        return alike and (own_turning > 0) == (turning > 0)
    return alike and own_turning > 0


def _inferred(chain: PlanarChain) -> EndedChain:
    pieces = list(chain.pieces)
    if chain.far[0] < chain.far[1] == math.inf and chain.bodies is None:
        _pass_point_on(pieces)
    assumed = chain.assumed
    if chain.hub and chain.near_hinge:
        hub, pieces[0] = _hub_and_rest(pieces, chain.hub, chain.near[1])
        said = (
            f"what turns on hinge {chain.near_hinge.name} is a hub, and the beam begins {chain.hub:.6g} m "
            'beside that hinge; say boundary "pinned-free" if it begins at the hinge'
        )
        assumed = (*assumed, said)
    ends = []
    for at, supports in ((0, chain.near), (-1, chain.far)):
        if at == 0 and chain.hub:
            ends.append(hub)
            continue
        between = [piece for piece in pieces[1:-1] if piece.length]
        own = _outward(pieces[at], at)
        neighbour = between[at] if between else chain.segment
        if chain.bodies is not None:
            body = (0.0 if supports[0] == math.inf else chain.bodies[at], 0.0, 0.0)
        else:
            body = _body(own, _outward(neighbour, at) if neighbour else None, supports)
        # Ten digits: what is beyond is left from taking the rod off.
        mass, inertia, offset = (float(f"{value:.10g}") for value in body)
        # A body that is rigid with a segment has no hinge of its own to the beam.
        carried = bool(own.length and (inertia or offset)) and supports[1] < math.inf
        ends.append(End(*supports, mass, inertia, offset, on_segment=carried))
        pieces[at] = _outward(_without_body(own, ends[-1]), at)
    return EndedChain(Boundary(*ends), tuple(pieces), chain.springs, assumed)


def _stated(chain: PlanarChain, given: Boundary) -> EndedChain:
    pieces, springs = list(chain.pieces), list(chain.springs)
    if given.right.hub_radius:
        raise ValueError(f"boundary must have its hub at the end that the file's root is, got {given}")
    if given.left.hub_radius:
        return _with_hub(chain, given)
    sides = ((0, given.left, chain.near), (-1, given.right, chain.far))
    for at, end, (_, turning) in sides:
        if springs and 0 < end.rotational_stiffness < turning == math.inf:
            _take_support_out(pieces, springs, at, float(end.rotational_stiffness))
    if chain.far[0] < chain.far[1] == math.inf and pieces[-1] == chain.pieces[-1]:
        _pass_point_on(pieces)
    for at, end, _ in sides:
        mass, inertia, offset = end.moving_body
        if pieces[at] == held_piece(0.0) and mass and not inertia and not offset and len(pieces) > 1:
            # A point on a hinge moves with the piece beyond it.
            at = 1 if at == 0 else -2
        pieces[at] = _outward(_without_body(_outward(pieces[at], at), end), at)
    return EndedChain(given, tuple(pieces), tuple(springs), chain.assumed, said=True)


def _hub_and_rest(pieces: Sequence[Piece], radius: float, stiffness: float) -> tuple[End, Piece]:
    """Return the hub that a first piece turns with, and what of that piece is beam: a rod like the next."""
    own, stub = pieces[0], pieces[0].length - radius
    rods = [piece for piece in pieces[1:] if piece.length]
    rest = held_piece(0.0)
    if stub > _SAME * own.length:
        rest = _rod_like(rods[0].mirrored, stub).mirrored
    about = own.inertia + own.mass * own.centre**2
    about -= rest.inertia + rest.mass * (radius + rest.centre) ** 2
    return End.hub(float(f"{radius:.10g}"), float(f"{about:.10g}"), stiffness), rest


def _with_hub(chain: PlanarChain, given: Boundary) -> EndedChain:
    """Return a chain whose first piece has a hub of the user's radius; the file says its inertia."""
    radius, wanted = float(given.left.hub_radius), chain.hub or chain.pieces[0].length
    if abs(radius / wanted - 1) > _NOTABLE if chain.hub or radius > wanted else False:
        raise ValueError(f"boundary must have the file's hub_radius of {wanted:.6g}, got {radius:.6g}")
    hub, rest = _hub_and_rest(chain.pieces, radius, chain.near[1])
    off = float(given.left.rotary_inertia) / float(hub.rotary_inertia) - 1
    if abs(off) > _NOTABLE:
        raise ValueError(
            f"boundary must have the file's rotary_inertia of the hub, {hub.rotary_inertia:.6g}, got "
            f"{given.left.rotary_inertia:.6g}"
        )
    without = replace(chain, pieces=(rest, *chain.pieces[1:]), hub=0.0)
    found = _stated(without, Boundary(End(*chain.near), given.right))
    return replace(found, boundary=Boundary(hub, given.right))


def _outward(piece: Piece, at: int) -> Piece:
    """Return a piece as seen towards its end of the chain, or back: the near pieces mirrored."""
    return piece.mirrored if at >= 0 else piece


def _take_support_out(pieces: list[Piece], springs: list[Spring], at: int, support: float) -> None:
    """Leave of an outer spring what is not the end's own: the rule's wall spring, in series with it."""
    hinge = springs[at]
    spring = hinge.stiffness
    if abs(spring / support - 1) <= _SAME:
        # Nothing but the support: the rule puts no hinge there.
        del pieces[at], springs[at]
    elif spring < support:
        place = replace(hinge.place, in_series=support) if hinge.place else None
        springs[at] = replace(hinge, stiffness=1 / (1 / spring - 1 / support), place=place)
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
        pieces[-1] = held_piece(0.0)
        return
    before, rod = pieces[-2], _rod_like(rods[-1], pieces[-2].length)
    point = before.mass - rod.mass
    if point > _NOTABLE * rod.mass:
        pieces[-2] = _without_body(before, End(mass=point))
        pieces[-1] = replace(pieces[-1], mass=point)


def _without_body(piece: Piece, end: End) -> Piece:
    """Return a piece without the body at its far tip, the end there; refuse a body of more than the piece."""
    mass, inertia, offset = map(float, end.moving_body)
    if not mass and not inertia:
        return piece
    rest = piece.mass - mass
    if rest < -_SAME * piece.mass:
        raise ValueError(
            f"boundary must have bodies lighter than their pieces, got {mass:.6g} > {piece.mass:.6g}"
        )
    if rest <= _SAME * piece.mass and not piece.length:
        return held_piece(0.0)
    rest = max(rest, 0.0)
    if end.holds_rotation:
        # Only the mass of what does not turn counts.
        return Piece(piece.length, rest, piece.length / 2, rest * piece.length**2 / 12)
    arm = piece.length + offset
    centre = (piece.mass * piece.centre - mass * arm) / rest if rest else piece.centre
    about = piece.inertia - inertia
    about -= rest * mass / piece.mass * (arm - centre) ** 2 if piece.mass else 0.0
    if about < -_NOTABLE * max(rest * piece.length**2, _SAME * piece.inertia):
        raise ValueError(f"boundary must have bodies of less inertia than their pieces, got {inertia:.6g}")
    return Piece(piece.length, rest, centre, max(about, 0.0))


def _rod_like(rod: Piece, length: float) -> Piece:
    """Return a rod of another length and the same kind: slender, of some section, or mass at its ends."""
    share = length / rod.length
    mass = rod.mass * share
    ratio = rod.inertia / (rod.mass * rod.length**2)
    kind = 1 / 4 if abs(ratio - 1 / 4) < _NOTABLE else min(ratio, 1 / 12)
    section = (ratio - kind) * rod.mass * rod.length
    return Piece(length, mass, share * rod.centre, kind * mass * length**2 + section * length)


def _body(piece: Piece, neighbour: Piece | None, supports: tuple[float, float]) -> tuple[float, float, float]:
    """Return mass, inertia and offset of what a piece has at its far tip beyond a rod like its neighbour."""
    none = (0.0, 0.0, 0.0)
    if supports == (math.inf, math.inf):
        return none
    if not piece.length:
        return (piece.mass, piece.inertia, piece.centre) if piece.mass else (0.0, piece.inertia, 0.0)
    if neighbour is None or not neighbour.length:
        return none
    rod = _rod_like(neighbour, piece.length)
    mass, scale = piece.mass - rod.mass, rod.mass * piece.length**2
    if supports[1] == math.inf:
        return (mass, 0.0, 0.0) if mass > _NOTABLE * piece.mass else none
    if mass <= _NOTABLE * rod.mass:
        # As heavy as a segment: another rotary inertia is the segment's own, and is reported as such.
        return none
    arm = (piece.mass * piece.centre - rod.mass * rod.centre) / mass
    extra = piece.inertia - rod.inertia - rod.mass * mass / piece.mass * (arm - rod.centre) ** 2
    offset = arm - piece.length
    if extra < -_NOTABLE * scale:
        return none
    return (
        mass,
        extra if extra > _SAME * scale else 0.0,
        offset if abs(offset) > _SAME * piece.length else 0.0,
    )
