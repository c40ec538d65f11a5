"""A tree of rigid pieces in space, each joined to its parent by three springs; a chain is its simplest case.

What each piece moves like is a twist (d, θ): the displacement of the piece's points, continued to the origin
of space, and its rotation, so that its point p moves by  d + θ × p.  A joint at p with section axes R turns
by R φ relative to the parent: it adds  (p × R φ, R φ)  to all pieces beyond. So motions are sums along the
tree from its root, and what they do to the joints are sums back to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix

__all__ = ["RigidTree", "Support"]


@dataclass(frozen=True, eq=False)
class Support:
    """Springs between a point of a piece and the ground.

    Attributes
    ----------
    piece : int
    place : ndarray, shape (3,) [m]
    frame : ndarray, shape (3, 3)
        Its columns are the axes of the springs.
    stiffness : ndarray, shape (6,) [N/m, N m/rad]
        Of deflections, then of rotations; inf where held.
    """

    piece: int
    place: Floats
    frame: Floats
    stiffness: Floats

    @property
    def reading(self) -> Floats:
        """What a piece's twist is at this support in its axes, shape (6, 6)."""
        matrix = np.zeros((6, 6))
        matrix[:3, :3] = matrix[3:, 3:] = self.frame.T
        matrix[:3, 3:] = -self.frame.T @ cross_matrix(self.place)
        return matrix


@dataclass(frozen=True, eq=False)
class RigidTree:
    """Rigid pieces, and the joints by which each but the first hangs on an earlier one, at rest.

    Attributes
    ----------
    parent : ndarray of int, shape (pieces,)
        Each piece's, which comes before it; -1 of the root.
    joint_place : ndarray, shape (pieces, 3) [m]
        Of the joint to the parent, in the axes of space.
    joint_frame : ndarray, shape (pieces, 3, 3)
        Its axes, as columns.
    joint_flexibility : ndarray, shape (pieces, 3) [rad/(N m)]
        About each axis; 0 where the joint is rigid. The root's are not read.
    mass : ndarray, shape (pieces,) [kg]
    centre : ndarray, shape (pieces, 3) [m]
        Of mass, in the axes of space.
    inertia : ndarray, shape (pieces, 3, 3) [kg m²]
        About the centre of mass, in the axes of space.
    supports : tuple of Support
    """

    parent: NDArray[np.intp]
    joint_place: Floats
    joint_frame: Floats
    joint_flexibility: Floats
    mass: Floats
    centre: Floats
    inertia: Floats
    supports: tuple[Support, ...]

    @property
    def pieces(self) -> int:
        """Number of pieces, massless ones included."""
        return len(self.parent)

    @cached_property
    def runs(self) -> tuple[tuple[int, int], ...]:
        """Ranges of pieces in each of which every piece hangs on the one before."""
        starts = np.flatnonzero(self.parent != np.arange(self.pieces) - 1)
        starts = np.unique(np.concatenate([[0], starts]))
        stops = np.append(starts[1:], self.pieces)
        return tuple(zip(starts.tolist(), stops.tolist(), strict=True))

    @cached_property
    def joint_twists(self) -> Floats:
        """What a unit turn about each joint axis adds beyond it, shape (pieces, 6, 3)."""
        twists = np.concatenate([cross_matrix(self.joint_place) @ self.joint_frame, self.joint_frame], axis=1)
        twists[0] = 0.0
        return twists

    @cached_property
    def mass_root(self) -> Floats:
        """What makes of a piece's twist six numbers of squared sum twice its energy, (pieces, 6, 6)."""
        root = np.zeros((self.pieces, 6, 6))
        size, axes = np.linalg.eigh(self.inertia)
        # Negative ones are rounding of a rod's inertia about itself.
        turning = np.sqrt(np.maximum(size, 0.0))[:, :, None] * np.swapaxes(axes, 1, 2)
        speed = np.sqrt(self.mass)[:, None, None]
        root[:, :3, :3] = speed * np.eye(3)
        root[:, :3, 3:] = -speed * cross_matrix(self.centre)
        root[:, 3:, 3:] = turning
        return root

    def from_root(self, steps: Floats) -> Floats:
        """Return for each piece the sum of the steps of it and of all that it hangs on; in place.

        Examples
        --------
        >>> forked = RigidTree(np.array([-1, 0, 0]), *[np.zeros(0)] * 6, ())
        >>> forked.from_root(np.array([1.0, 2.0, 3.0])).tolist()
        [1.0, 3.0, 4.0]
        """
        for start, stop in self.runs:
            if start:
                steps[start] += steps[self.parent[start]]
            np.cumsum(steps[start:stop], axis=0, out=steps[start:stop])
        return steps

    def to_root(self, loads: Floats) -> Floats:
        """Return for each piece the sum of the loads on it and on all that hangs on it; in place.

        Examples
        --------
        >>> forked = RigidTree(np.array([-1, 0, 0]), *[np.zeros(0)] * 6, ())
        >>> forked.to_root(np.array([1.0, 2.0, 3.0])).tolist()
        [6.0, 2.0, 3.0]
        """
        for start, stop in reversed(self.runs):
            backward = loads[start:stop][::-1]
            np.cumsum(backward, axis=0, out=backward)
            if start:
                loads[self.parent[start]] += loads[start]
        return loads
