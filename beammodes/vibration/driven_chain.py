"""The response of a linear chain that is driven at one frequency, piece by piece, at a cost of O(N).

With e^(iωt) the chain's small motion is

    (-s M + g K + iω C + P) y = f,     g = 1 + iη + iωβ,     s = ω² - iωα,

K the springs of hinges and supports, C dampers of single hinges, P what loads along the chain do. It is told
by states (y, θ, M, V) at the left of each piece,

    V' = V - s m u,     M' = M - l V' + P θ - s (J θ + c m u),     u = y + c θ,     θ' = θ + M'/k,

which are solved for all at once as a banded system (`marched_states`). No stiffness matrix is assembled, in
which a long chain's lowest modes would lose their digits.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number, floats
from beammodes.equations.mechanics import axial_pull, straight_chain_load
from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex, marched_states
from beammodes.problem.driving import Drive, Reading
from beammodes.problem.loading import NO_LOAD, Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, Modes, solve_modes

__all__ = ["DrivenChain"]

# Positions nearer to a hinge, over the chain's length, are on it.
_SAME_PLACE = 1e-12
# Over the chain's unit of ω, of which its highest frequency is less than ten.
_HIGHEST = 1e6


class _Share(NamedTuple):
    """A piece's part in a deflection or rotation: `deflection` of its left tip's, `angle` of its own.

    Forces and moments share themselves out alike.
    """

    piece: int
    deflection: float
    angle: float


@dataclass(frozen=True, eq=False)
class DrivenChain:
    """A chain, what drives it and what is read of it.

    The rotation at a position is that of the piece there; at a hinge the mean of both pieces', and a moment
    acts on each with its half.

    Attributes
    ----------
    chain : Chain
    load : Load
        Along the chain.
    drive : Drive
    reading : Reading
    joint : ndarray, shape (hinges,) [N m s/rad]
        Dampers of single hinges.
    """

    chain: Chain
    load: Load
    drive: Drive
    reading: Reading
    joint: Floats

    def __post_init__(self) -> None:
        straight_chain_load(self.chain, self.load)
        if self.load.spin_rate:
            raise ValueError(f"load must be without spin_rate here, got {self.load}")
        if self.load != NO_LOAD:
            # Refuses a load that buckles the chain.
            solve_modes(linearize(self.chain, load=self.load), 1)

    def receptance(self, square: Complex, stiffness: Complex, omega: Floats) -> Complex:
        """Return responses to unit drives, shape (frequencies, readings, drives).

        Of a base: the motion relative to it, as  Σ φ_n (φ_n M y_b) / (ω_n² - λ)  without damping.

        Parameters
        ----------
        square, stiffness : ndarray of complex, shape (frequencies,)
            s and g.
        omega : ndarray, shape (frequencies,) [rad/s]
            ω, for dampers of single hinges.
        """
        units = self.chain.units
        highest = _HIGHEST * units.angular_frequency
        if np.sqrt(np.max(np.abs(square), initial=0.0)) > highest:
            raise ValueError(
                f"frequency or band must be at most {highest / 2 / np.pi:.3g} Hz, far beyond this chain's "
                f"motions, got {np.sqrt(np.max(np.abs(square))) / 2 / np.pi:.3g} Hz"
            )
        springs, dampers = self.chain.scaled.in_floats.joint_stiffness, self.joint / units.stiffness
        found = np.empty((len(square), len(self.reading.x), self.drive.columns), dtype=np.complex128)
        for f, one in enumerate(square / units.angular_frequency**2):
            states = self._states(one, stiffness[f], stiffness[f] * springs + 1j * omega[f] * dampers)
            for r, shares in enumerate(self._reads):
                found[f, r] = sum(
                    share.deflection * states[share.piece, 0] + share.angle * states[share.piece, 1]
                    for share in shares
                )
        return found * self._unit

    @property
    def _unit(self) -> float:
        """What one is of what is read per what drives, in the chain's units."""
        units = self.chain.units
        given = {
            "force": units.length**2 / units.stiffness,
            "moment": units.length / units.stiffness,
            "shift": units.angular_frequency**-2,
            "turn": units.length * units.angular_frequency**-2,
        }[self.drive.kind]
        return given / units.length if self.reading.kind == "rotation" else given

    @cached_property
    def _reads(self) -> list[list[_Share]]:
        return [self._shares(x, turns=self.reading.kind == "rotation") for x in self.reading.x.tolist()]

    @cached_property
    def _acts(self) -> list[list[_Share]]:
        return [self._shares(x, turns=self.drive.kind == "moment") for x in self.drive.x.tolist()]

    def _shares(self, x: float, *, turns: bool) -> list[_Share]:
        chain, node = self.chain, self.chain.node_position
        here = np.flatnonzero(np.abs(node[1:-1] - x) <= _SAME_PLACE * node[-1])
        piece = int(np.clip(np.searchsorted(node, x, side="right") - 1, 0, chain.pieces - 1))
        if not turns:
            return [_Share(piece, 1.0, (x - node[piece]) / chain.units.length)]
        both = [int(here[0]), int(here[-1]) + 1] if len(here) else [piece]
        # A piece of no length is the end itself, and so is a hub at x = 0.
        pieces = [p for p in both if not chain.length[p]] or both
        if chain.boundary.left.hub_radius and x <= _SAME_PLACE * node[-1]:
            pieces = [0]
        return [_Share(p, 0.0, 1.0 / len(pieces)) for p in pieces]

    @cached_property
    def _pull(self) -> Floats:
        return floats(axial_pull(self.chain, self.load))

    @cached_property
    def _base(self) -> tuple[Floats, Floats]:
        """Forces and moments about the centre that the inertia of a base's unit motion puts on each piece."""
        pieces = self.chain.scaled.in_floats
        if self.drive.kind == "shift":
            return pieces.mass, np.zeros_like(pieces.mass)
        left = np.concatenate([[0.0], np.cumsum(pieces.length)[:-1]])
        return pieces.mass * (left + pieces.centre), pieces.rotary_inertia

    def _states(self, square: complex, firm: complex, hinges: Complex) -> Complex:
        """Return the states at the left of each piece, and at the right tip, in the chain's own units."""
        length, mass, centre, inertia, _ = self.chain.scaled.in_floats
        soft = np.concatenate([1.0 / hinges, [0.0]])
        # What a deflection and a rotation of the piece put into V' and M'.
        lift, turn = -square * mass, -square * mass * centre
        steps = np.zeros((len(mass), 4, 4), dtype=np.complex128)
        steps[:, 3, 0], steps[:, 3, 1], steps[:, 3, 3] = lift, turn, 1.0
        steps[:, 2, 0] = turn - length * lift
        steps[:, 2, 1] = self._pull - square * (inertia + mass * centre**2) - length * turn
        steps[:, 2, 2], steps[:, 2, 3] = 1.0, -length
        steps[:, 1] = soft[:, None] * steps[:, 2]
        steps[:, 1, 1] += 1.0
        steps[:, 0, 0], steps[:, 0, 1] = 1.0, length
        added = np.zeros((len(mass), 4, self.drive.columns), dtype=np.complex128)
        if self.drive.is_base:
            pushed, turned = self._base
            added[:, 3, 0], added[:, 2, 0] = -pushed, (length - centre) * pushed - turned
        for column, shares in enumerate(self._acts):
            for piece, force, moment in shares:
                added[piece, 2:, column] += [length[piece] * force - moment, -force]
        added[:, 1] = soft[:, None] * added[:, 2]
        left, right = self.chain.scaled.supports
        given = np.zeros((2, 2, self.drive.columns))
        return marched_states(steps, added, _conditions(left, firm, 1), _conditions(right, firm, -1), given)

    @cached_property
    def drifts(self) -> bool:
        """Whether some motion stores nothing, so that a force at rest would carry the chain away."""
        return linearize(self.chain, load=self.load).rigid_body_modes > 0

    @cached_property
    def most_modes(self) -> int:
        """How many modes `products` tells at most: one more than there are, or a tenth of a long chain's."""
        hinges = len(self.chain.scaled.joint_stiffness)
        many = linearize(self.chain, load=self.load).elastic_modes
        return many + 1 if hinges <= MAX_DENSE else max(1, many // 10)

    def products(self, modes: int) -> tuple[Floats, Floats]:
        """Return ω_n and what each mode reads times how it is driven, shape (modes, readings, drives)."""
        found = solve_modes(linearize(self.chain, load=self.load), modes)
        ell, unit = self.chain.units.length, self.chain.units.mass
        read = _of_modes(found, self._reads, 1.0 if self.reading.kind == "rotation" else ell)
        if self.drive.is_base:
            pushed, turned = self._base
            centres = found.deflection[:, :-1] + self.chain.centre * found.rotation
            arm = ell if self.drive.kind == "turn" else 1.0
            of_modes: Floats = centres @ pushed + ell * (found.rotation @ turned)
            driven = unit * arm * of_modes[:, None]
        else:
            driven = _of_modes(found, self._acts, 1.0 if self.drive.kind == "moment" else ell)
        return found.angular_frequency, read[:, :, None] * driven[:, None, :]


def _of_modes(modes: Modes, places: list[list[_Share]], arm: float) -> Floats:
    """Return deflections or rotations in modes, shape (modes, places); arms of deflections are over `arm`."""
    found = np.zeros((len(modes.angular_frequency), len(places)))
    for k, shares in enumerate(places):
        for piece, deflection, angle in shares:
            found[:, k] += deflection * modes.deflection[:, piece] + arm * angle * modes.rotation[:, piece]
    return found


def _conditions(supports: tuple[Number, Number], firm: complex, side: int) -> Complex:
    """Return both conditions of an end's supports on (y, θ, M, V)."""
    rows = np.eye(2, 4, dtype=np.complex128)
    for i, stiffness in enumerate(supports):
        if stiffness != np.inf:
            rows[i] = 0.0
            rows[i, i], rows[i, 3 - i] = -side * firm * float(stiffness), 1.0
    return rows
