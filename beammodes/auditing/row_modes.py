"""Small motion of a row of bodies in space about its rest, in all its joints' coordinates at once.

A coordinate moves all beyond it by a twist s: a turn about an axis a through p by (p × a, a), a shift along a
by (a, 0). With I_g the inertia of everything from group g on, about one point,

    M_cd = s_c · I_g(d) s_d,   g(d) the group that the farther coordinate d moves first,

and armature is added to a coordinate's own. This shares nothing with planar chains: it is what an engine
linearizes, for any shape at rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import Inertial, ModelTie
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.space_row import Coordinate, SpaceRow
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix
from beammodes.vibration.damping import ModalDamping

__all__ = ["RowModes", "elastic_modes", "row_modes"]

#: Coordinates of longer rows take minutes.
_MOST = 1500
#: Of 1/(ω² + σ) over 1/σ: what is left to 1 of a motion that stores nothing.
_RIGID = 1e-9
#: Of 1/ω², beside the lowest mode's: motions without inertia.
_MASSLESS = 1e-13


@dataclass(frozen=True, eq=False)
class RowModes:
    """M, K and D in the coordinates of a row, and the motion that each coordinate belongs to."""

    inertia: Floats
    stiffness: Floats
    damping: Floats
    motion: NDArray[np.intp]
    held: Floats

    @cached_property
    def _solved(self) -> tuple[Floats, Floats]:
        return elastic_modes(self.inertia, self.stiffness, self.held)

    @property
    def angular_frequency(self) -> Floats:
        """Of all elastic modes, ascending [rad/s]."""
        return self._solved[0]

    @cached_property
    def stored(self) -> Floats:
        """The part of a mode's energy that each coordinate's spring stores, shape (modes, coordinates)."""
        omega, x = self._solved
        return np.asarray((x * (self.stiffness @ x) / omega**2).T)

    def of(self, motion: int) -> RowModes:
        """Return the modes of one motion, all others at rest."""
        return self._only(self.motion == motion)

    def but(self, motion: int) -> RowModes:
        """Return the modes of all other coordinates, those of one motion at rest."""
        return self._only(self.motion != motion)

    def _only(self, chosen: NDArray[np.bool_]) -> RowModes:
        own = np.flatnonzero(chosen)
        both = np.ix_(own, own)
        held = self.held[:, own]
        return RowModes(
            self.inertia[both],
            self.stiffness[both],
            self.damping[own],
            self.motion[own],
            held[np.abs(held).max(axis=1, initial=0.0) > 0.0],
        )

    @cached_property
    def damped(self) -> ModalDamping:
        """All modes with the damping of joints."""
        omega, x = self._solved
        size = len(omega)
        return ModalDamping(omega, (x.T * self.damping) @ x, np.zeros((size, size)), 0.0)


def row_modes(row: SpaceRow, ties: Sequence[ModelTie]) -> RowModes:
    """Return the matrices of a row whose carrier is held, or moves alone on the ground.

    Raises
    ------
    ValueError
        If it has too many coordinates, or ties do what is not read.
    """
    coordinates = row.coordinates
    count = len(coordinates)
    if count > _MOST:
        raise BadModel(f"must have at most {_MOST} joint coordinates to be judged in space, got {count}")
    origin = row.nodes[0]
    parts = [*([row.root.inertial] if row.is_carried else []), *(group.inertial for group in row.groups)]
    beyond = np.cumsum(np.array([_six(part, origin) for part in parts])[::-1], axis=0)[::-1]
    axes = np.array([each.axis for each in coordinates])
    arms = np.array([each.joint.position - origin for each in coordinates])
    turns = np.array([each.kind == "hinge" for each in coordinates])[:, None]
    twists = np.hstack([np.where(turns, np.cross(arms, axes), axes), np.where(turns, axes, 0.0)])
    at = np.array([each.group for each in coordinates]) + int(row.is_carried)
    # Coordinates come from the root on, so that of two the later is the farther one.
    pushed = np.einsum("nij,nj->ni", beyond[at], twists)
    upper = np.triu(twists @ pushed.T)
    inertia = upper + np.triu(upper, 1).T
    inertia[np.diag_indices(count)] += [each.joint.armature for each in coordinates]
    stiffness = np.diag([each.stiffness for each in coordinates])
    for i, j in _of_one_ball(coordinates):
        stiffness[i, j] = stiffness[j, i] = axes[i] @ coordinates[i].joint.springs @ axes[j]
    names = [each.joint.name for each in coordinates]
    held: list[Floats] = []
    for tie in ties:
        terms = dict(tie.terms)
        if not (tie.stiffness or tie.refusal) or not terms.keys() & set(names):
            continue
        if tie.refusal:
            raise BadModel(tie.refusal)
        if any(value for name, value in terms.items() if name not in names):
            raise BadModel(f"tendon {tie.name} must join joints of the chain only")
        line = np.array([terms.get(name, 0.0) for name in names])
        if tie.stiffness == math.inf:
            held.append(line)
        else:
            stiffness = stiffness + tie.stiffness * np.outer(line, line)
    motion = np.array([-1 if each.motion is None else each.motion for each in coordinates], dtype=np.intp)
    damping = np.array([each.joint.damping for each in coordinates])
    return RowModes(inertia, stiffness, damping, motion, np.reshape(held, (-1, count)))


def _of_one_ball(coordinates: Sequence[Coordinate]) -> Iterator[tuple[int, int]]:
    """Yield pairs of coordinates of one ball with springs that are not alike about all axes."""
    for i, each in enumerate(coordinates):
        for j in range(i + 1, min(i + 3, len(coordinates))):
            if each.joint.springs is not None and coordinates[j].joint is each.joint:
                yield i, j


def _six(part: Inertial, origin: Floats) -> Floats:
    """Return a body's inertia for (displacement, rotation) about a point, shape (6, 6)."""
    arm = cross_matrix(part.centre - origin)
    found = np.zeros((6, 6))
    found[:3, :3] = part.mass * np.eye(3)
    found[3:, :3], found[:3, 3:] = part.mass * arm, -part.mass * arm
    found[3:, 3:] = part.inertia - part.mass * arm @ arm
    return found


def elastic_modes(inertia: Floats, stiffness: Floats, held: Floats) -> tuple[Floats, Floats]:
    """Return ω and shapes, as columns of unit modal mass, of the elastic modes, ascending.

    `held` has rows of coordinates whose sum is zero. By the largest eigenvalues of

        M x = μ (K + σ M) x,   μ = 1/(ω² + σ)

    so that the lowest frequencies keep their digits, and motions that store nothing have μ = 1/σ. σ is below
    the least ω², so that none are lost.

    Examples
    --------
    >>> omega, _ = elastic_modes(np.eye(2), np.array([[1.0, -1.0], [-1.0, 1.0]]), np.zeros((0, 2)))
    >>> omega.round(12).tolist()                            # √2; the other moves both alike
    [1.414213562373]
    """
    from scipy.linalg import eigh

    allowed = np.eye(len(inertia))
    if len(held):
        allowed = np.linalg.svd(held)[2][len(held) :].T
    mass, springs = allowed.T @ inertia @ allowed, allowed.T @ stiffness @ allowed
    weight = mass.diagonal()
    sprung = (springs.diagonal() > 0.0) & (weight > 0.0)
    if not sprung.any():
        return np.zeros(0), np.zeros((len(inertia), 0))
    # A single coordinate's quotient is no less than the lowest ω²; many in series are softer.
    shift = float((springs.diagonal()[sprung] / weight[sprung]).min()) / len(mass)
    root = 1.0 / np.sqrt((springs + shift * mass).diagonal())
    scaled = root[:, None] * (springs + shift * mass) * root
    mu, x = eigh(root[:, None] * mass * root, scaled)
    mu, x = mu[::-1], root[:, None] * x[:, ::-1]
    moves = (mu * shift < 1.0 - _RIGID) & (mu > _MASSLESS * mu[0])
    omega = np.sqrt(1.0 / mu[moves] - shift)
    # Of unit K + σ M: the modal mass is μ.
    return omega, allowed @ (x[:, moves] / np.sqrt(mu[moves]))
