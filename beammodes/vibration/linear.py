"""The linear chain in its factors: small transverse vibration about the straight chain at rest.

Coordinates are the deflections of the nodes: the left tip, the hinges, the right tip. Nodes at either side
of a piece that is held or has no length share one. A piece of length zero that turns (a body with rotary
inertia at an end) has its angle as a coordinate of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.equations.axial_pull import axial_pull, straight_load
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.nodal import free_angles, independent_nodes, nodal_matrices

if TYPE_CHECKING:
    from beammodes.equilibrium.bent_model import BentModel
    from beammodes.equilibrium.equilibria import Equilibrium

__all__ = ["MAX_ASSEMBLED", "LinearModel", "linearize"]

Array = NDArray[np.float64]

#: Matrices of more rows are not assembled: an assembled stiffness matrix of a long chain has already lost the
#: digits of its lowest modes (its condition number grows as N⁴), so it would only mislead.
MAX_ASSEMBLED = 2000


@dataclass(frozen=True, repr=False)
class LinearModel:
    """The linear chain  M u'' + K u = 0,  kept in its factors.

    K = Bᵀ D B + supports + Σ P_i θ_iᵀ θ_i - Ω² M, with B the joints' relative rotations, D the joint
    stiffnesses on the diagonal, P_i what loads along the chain do to a piece (`axial_pull`), the last term in
    the plane of rotation of a turning hub only; M is the pieces' inertia. `solve_modes` works on these
    factors and never on the assembled matrices, which are for reading and for checking.

    Attributes
    ----------
    chain : Chain
        The pieces and springs that the factors are made of.
    load : Load
        What it vibrates under.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> model = linearize(Chain(Beam.unit(), "pinned-pinned", segments=4))
    >>> model.coordinates
    ('y_1', 'y_2', 'y_3')
    >>> (24 * model.mass_matrix).round(12)
    array([[4., 1., 0.],
           [1., 4., 1.],
           [0., 1., 4.]])
    """

    chain: Chain
    load: Load = field(default_factory=Load)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the independent coordinates: deflections, left to right, then angles of end bodies."""
        return (*(f"y_{node}" for node in independent_nodes(self.chain)), *free_angles(self.chain))

    @property
    def rigid_body_modes(self) -> int:
        """How many motions store nothing. An axial force lets a rigid rotation store energy."""
        if not any(axial_pull(self.chain, self.load)):
            return self.chain.boundary.rigid_body_modes
        return int(not any(translation for translation, _ in self.chain.supports))

    @property
    def elastic_modes(self) -> int:
        """How many modes store energy."""
        chain = self.chain
        return chain.elastic_modes + chain.boundary.rigid_body_modes - self.rigid_body_modes

    @property
    def joint_rotations(self) -> Array:
        """B, shape (hinges, coordinates) [1/m]: relative rotation of each joint for unit deflections."""
        return self._assembled()[0]

    @property
    def joint_stiffness(self) -> Array:
        """The diagonal of D, shape (hinges,) [N m/rad]."""
        return self.chain.joint_stiffness

    @property
    def mass_matrix(self) -> Array:
        """M, tridiagonal but for end bodies' angles, shape (coordinates, coordinates) [kg]."""
        return self._assembled()[1]

    @property
    def stiffness_matrix(self) -> Array:
        """K, pentadiagonal but for end bodies' angles, shape (coordinates, coordinates) [N/m]."""
        return self._assembled()[2]

    def _assembled(self) -> tuple[Array, Array, Array]:
        rows = self.chain.pieces
        if rows > MAX_ASSEMBLED:
            raise ValueError(
                f"matrices of a chain of {rows} pieces are not assembled (at most {MAX_ASSEMBLED}); "
                "solve_modes needs none of them"
            )
        units = self.chain.units
        # Deflections are in metres, angles of bodies in radians.
        scale = np.array([units.length if name.startswith("y") else 1.0 for name in self.coordinates])
        rotations, mass, stiffness = (
            # Reshaped, since a chain that cannot move has matrices without columns.
            np.array(matrix, dtype=np.float64).reshape(len(matrix), len(scale))
            for matrix in nodal_matrices(self.chain, float, self.load)
        )
        pair = np.outer(scale, scale)
        return (
            rotations / scale,
            mass * (units.mass * units.length**2) / pair,
            stiffness * units.stiffness / pair,
        )

    def __repr__(self) -> str:
        under = "" if self.load == Load() else f" under {self.load}"
        return f"LinearModel({self.chain!r}{under})"


@overload
def linearize(chain: Chain, *, load: Load | None = None, at: None = None) -> LinearModel: ...
@overload
def linearize(chain: Chain, *, load: Load | None = None, at: Equilibrium) -> BentModel: ...
def linearize(
    chain: Chain, *, load: Load | None = None, at: Equilibrium | None = None
) -> LinearModel | BentModel:
    """Return the linear model of a chain's small transverse vibration about its straight or another shape.

        M u'' + K u = 0

    Parameters
    ----------
    chain : Chain
        Any chain; without `at` nothing is assembled here, so its length does not matter.
    load : Load, optional
        Loads that leave the chain straight: along it, or of a turning hub.
    at : Equilibrium, optional
        From `find_equilibrium`: vibrate about this shape of the chain, under the load that holds it there.

    Returns
    -------
    LinearModel or BentModel
        The latter about `at`, with full matrices.

    Raises
    ------
    TypeError, ValueError
        If `chain` is no Chain, `load` no Load or `at` no Equilibrium; if the load bends the chain, or pulls
        on it where nothing holds its left end; if `at` is of another chain or load, or bent in the plane of
        rotation of a turning hub.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=2)
    >>> linearize(chain).stiffness_matrix
    array([[ 51.2, -16. ],
           [-16. ,   8. ]])

    About the shape that it takes under its own weight, in angles:

    >>> from beammodes.equilibrium.equilibria import find_equilibrium
    >>> linearize(chain, at=find_equilibrium(chain, Load(gravity=20.0))).stiffness_matrix.round(6)
    array([[13.071977, -2.      ],
           [-2.      ,  4.416262]])
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if at is not None:
        return _about(chain, load, at)
    return LinearModel(chain, straight_load(chain, checked_load(load)))


def _about(chain: Chain, load: Load | None, at: Equilibrium) -> BentModel:
    from beammodes.equilibrium.bent_model import bent_model
    from beammodes.equilibrium.equilibria import Equilibrium

    if not isinstance(at, Equilibrium):
        raise TypeError(f"at must be an Equilibrium from find_equilibrium() or None, got {shown(at)}")
    if at.chain is not chain and at.chain != chain:
        raise ValueError(f"at must be of the same chain, {shown(chain)}, got one of {shown(at.chain)}")
    if load is not None and checked_load(load) != at.load:
        raise ValueError(f"load must be left out or be that of at, {at.load}, got {load}")
    return bent_model(at)
