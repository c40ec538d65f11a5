"""A chain's numbers in one plane of bending, seen from its firmer end, as a tree of joints needs them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from beammodes.chains.chain import Chain
from beammodes.vibration.damping import Damping

__all__ = ["Plane", "Spring", "bending_plane"]

#: Stiffness and damping.
Spring = tuple[float, float]


@dataclass(frozen=True)
class Plane:
    """Pieces from the end near the root to the far one; an end has springs across and in turning.

    Attributes
    ----------
    length, mass, centre, inertia : tuple, one entry a piece
        `centre` from the piece's near tip, the inertia about it.
    springs : tuple, one entry fewer
    near, far : (across, turning)
        Springs of the supports, of infinite stiffness where they hold.
    """

    length: tuple[float, ...]
    mass: tuple[float, ...]
    centre: tuple[float, ...]
    inertia: tuple[float, ...]
    springs: tuple[Spring, ...]
    near: tuple[Spring, Spring]
    far: tuple[Spring, Spring]

    @property
    def held(self) -> tuple[bool, ...]:
        """Whether supports hold the near deflection and angle, and the far ones."""
        return tuple(stiffness == math.inf for end in (self.near, self.far) for stiffness, _ in end)

    @property
    def reach(self) -> tuple[float, ...]:
        """From the near tip of every piece to the far tip of the last."""
        return tuple(math.fsum(self.length[i:]) for i in range(len(self.length)))

    def without_held_far_piece(self) -> Plane:
        """Return the same motion without a last piece whose angle is held: its hinge's spring turns support.

        Mass that such a piece carries across, without turning, is a point at that hinge.
        """
        across, turning = self.far
        if turning[0] != math.inf:
            return self
        if len(self.length) == 1:
            return replace(self, near=(self.near[0], turning), far=(across, (0.0, 0.0)))
        fewer = Plane(
            self.length[:-1],
            self.mass[:-1],
            self.centre[:-1],
            self.inertia[:-1],
            self.springs[:-1],
            self.near,
            (across, self.springs[-1]),
        )
        return fewer if across[0] == math.inf else fewer._with_point(self.mass[-1])

    def _with_point(self, point: float) -> Plane:
        total = self.mass[-1] + point
        if not point:
            return self
        arm = self.length[-1] - self.centre[-1]
        return replace(
            self,
            mass=(*self.mass[:-1], total),
            centre=(*self.centre[:-1], self.centre[-1] + arm * (point / total)),
            inertia=(*self.inertia[:-1], self.inertia[-1] + self.mass[-1] * (point / total) * arm**2),
        )


def bending_plane(chain: Chain, damping: Damping, turned: bool) -> Plane:
    """Return a chain's numbers from its left end, or from its right one if `turned`.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "guided-free", 2, "naive")
    >>> bending_plane(chain, Damping(), turned=True).without_held_far_piece().far
    ((0.0, 0.0), (2.0, 0.0))
    """
    rate = damping.stiffness
    hinges = zip(chain.joint_stiffness.tolist(), damping.joint_damping(chain).tolist(), strict=True)
    springs: list[Spring] = list(hinges)
    length, mass, inertia = chain.length.tolist(), chain.mass.tolist(), chain.rotary_inertia.tolist()
    centre = (chain.length - chain.centre if turned else chain.centre).tolist()
    ends = [
        tuple((k, 0.0 if k == math.inf else rate * k) for k in end)
        for end in chain.support_stiffness.tolist()
    ]
    way = slice(None, None, -1 if turned else 1)
    near, far = ends[way]
    pieces, masses, centres, inertias = (tuple(column[way]) for column in (length, mass, centre, inertia))
    return Plane(pieces, masses, centres, inertias, tuple(springs[way]), (near[0], near[1]), (far[0], far[1]))
