"""Rigid pieces as numbers: rods, bodies taken off them, pieces that the ground holds behind a spring."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.problem.supports import End

__all__ = [
    "NOTABLE",
    "SAME",
    "Piece",
    "PlanarChain",
    "Spring",
    "held_piece",
    "rod_like",
    "with_wall_hinges",
    "without_body",
]

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
