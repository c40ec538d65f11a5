"""Small vibration of a chain about a shape that need not be straight.

Relative to a turning hub the energies are those of motion seen from it. What they leave out, Coriolis forces,
is of second order about a straight shape. About a bent one it is of first order in the plane of rotation,
which this model therefore refuses; across that plane a Coriolis force points out of the plane of vibration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.equations.mechanics import coordinate_names, moving_pieces, tip_names
from beammodes.equilibrium.equilibria import Equilibrium
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load

__all__ = ["BentModel", "bent_model", "bent_shapes"]


@dataclass(frozen=True, eq=False, repr=False)
class BentModel:
    """The chain  M z'' + K z = 0  about an equilibrium, q = q_0 + basis z,  M and K full.

    Attributes
    ----------
    equilibrium : Equilibrium
        What it vibrates about. `equilibrium.basis` spans the motions that the closures allow; without
        closures z are the coordinates themselves.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.equilibrium.equilibria import find_equilibrium
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=2)
    >>> bent_model(find_equilibrium(chain, None)).mass_matrix
    array([[0.16666667, 0.0625    ],
           [0.0625    , 0.04166667]])
    """

    equilibrium: Equilibrium

    @property
    def chain(self) -> Chain:
        """The chain that vibrates."""
        return self.equilibrium.chain

    @property
    def load(self) -> Load:
        """The load under which it rests."""
        return self.equilibrium.load

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of q, one for each row of `equilibrium.basis`."""
        return tuple(coordinate_names(self.chain))

    @property
    def elastic_modes(self) -> int:
        """How many modes store energy: all of them."""
        return int(self.equilibrium.basis.shape[1])

    @property
    def rigid_body_modes(self) -> int:
        """How many motions store nothing: none, or the equilibrium would not be stable."""
        return 0

    @property
    def rotations(self) -> Floats:
        """Angle of every piece per unit z, shape (pieces, independent) [rad]."""
        turns = np.zeros((self.chain.pieces, self.elastic_modes))
        turns[moving_pieces(self.chain)] = self.equilibrium.basis[len(tip_names(self.chain)) :]
        return turns

    @property
    def displacements(self) -> Floats:
        """Displacement (x, y) of every node per unit z, shape (2, nodes, independent) [m]."""
        angle, names = self.equilibrium.angle, tip_names(self.chain)
        normal = np.stack([-np.sin(angle), np.cos(angle)]) * self.chain.length
        moved = np.zeros((2, self.chain.pieces + 1, self.elastic_modes))
        for row, name in enumerate(names):
            moved["xy".index(name[0]), 0] = self.equilibrium.basis[row]
        moved[:, 1:] = normal[:, :, None] * self.rotations
        return np.cumsum(moved, axis=1)

    @property
    def root_mass(self) -> Floats:
        """Pieces' speeds times √mass and √inertia per unit z', shape (3 pieces, independent): M's root."""
        angle, chain, turns = self.equilibrium.angle, self.chain, self.rotations
        normal = np.stack([-np.sin(angle), np.cos(angle)]) * chain.centre
        centres = self.displacements[:, :-1] + normal[:, :, None] * turns
        spins = np.sqrt(chain.rotary_inertia)[:, None] * turns
        return np.vstack([*(np.sqrt(chain.mass)[:, None] * centres), spins])

    @property
    def mass_matrix(self) -> Floats:
        """M, shape (independent, independent) [kg m²]."""
        root = self.root_mass
        return root.T @ root

    @property
    def stiffness_matrix(self) -> Floats:
        """K, shape (independent, independent) [N m]."""
        basis = self.equilibrium.basis
        return np.asarray(basis.T @ self.equilibrium.tangent @ basis)

    def __repr__(self) -> str:
        return f"BentModel(about {self.equilibrium!r})"


def bent_model(equilibrium: Equilibrium) -> BentModel:
    """Return the model of small vibration about an equilibrium.

    Raises
    ------
    ValueError
        If the chain turns with a hub and is bent in the plane of rotation.
    """
    load, angle = equilibrium.load, equilibrium.angle
    if load.spin_rate and load.plane == "lag" and np.abs(np.sin(angle)).max() > 1e-9:
        raise ValueError(
            "at must be straight in the plane of rotation of a turning hub, where Coriolis forces about a "
            f'bent shape are of first order and left out here, got {load}: plane="flap" has none'
        )
    return BentModel(equilibrium)


def bent_shapes(model: BentModel, count: int) -> tuple[Floats, Floats, Floats]:
    """Return ω, nodes' y and pieces' angles of the lowest modes, of unit modal mass, a row each.

    With K = L Lᵀ and M = Aᵀ A the singular values of  A L^{-T}  are 1/ω: the lowest keep their digits, which
    an eigen-solve of (K, M) would lose to the highest.

    Raises
    ------
    ValueError
        If the equilibrium is not stable.
    """
    from scipy.linalg import solve_triangular

    if not model.equilibrium.is_stable:
        raise ValueError(
            f"model must be about a stable equilibrium, got an unstable one of {shown(model.chain)} under "
            f"{model.load}"
        )
    if not model.elastic_modes:
        none = np.zeros((0, model.chain.pieces + 1))
        return np.zeros(0), none, none[:, 1:]
    lower = np.linalg.cholesky(model.stiffness_matrix)
    root = solve_triangular(lower, model.root_mass.T, lower=True).T
    _, inverse, turn = np.linalg.svd(root, full_matrices=False)
    shapes = solve_triangular(lower, turn[:count].T, lower=True, trans="T") / inverse[:count]
    lift, turned = model.displacements[1] @ shapes, model.rotations @ shapes
    sign = np.sign(lift[np.abs(lift).argmax(axis=0), np.arange(shapes.shape[1])])
    sign[sign == 0] = 1.0
    return 1 / inverse[:count], (lift * sign).T, (turned * sign).T
