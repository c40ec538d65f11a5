"""The linear chain: small transverse vibration about the straight chain at rest, in factors, or a bent one.

Coordinates are the deflections of the nodes: the left tip, the hinges, the right tip. Nodes at either side
of a piece that is held or has no length share one. A piece of length zero that turns (a body with rotary
inertia at an end) has its angle as a coordinate of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, overload

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number
from beammodes.checks import Shown, shown
from beammodes.equations.equilibria import Equilibrium
from beammodes.equations.mechanics import (
    axial_pull,
    coordinate_names,
    moving_pieces,
    straight_chain_load,
    tip_names,
)
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load

__all__ = ["BentModel", "LinearModel", "linearize", "nodal_deflections", "nodal_matrices"]

#: Matrices of more rows are not assembled: an assembled stiffness matrix of a long chain has already lost the
#: digits of its lowest modes (its condition number grows as N⁴).
MAX_ASSEMBLED = 2000

Row = dict[int, Any]


def nodal_deflections(chain: Chain) -> list[int | None]:
    """Return, for each node of the chain, the index of its independent deflection, None where it is held."""
    groups: list[list[int]] = [[0]]
    for piece, held in enumerate(chain.held_angles):
        alike = held or not chain.scaled.length[piece]
        groups[-1].append(piece + 1) if alike else groups.append([piece + 1])
    index: list[int | None] = [None] * (chain.pieces + 1)
    left, right = chain.boundary.left.holds_deflection, chain.boundary.right.holds_deflection
    moving = groups[int(left) : len(groups) - int(right)]
    for i, group in enumerate(moving):
        for node in group:
            index[node] = i
    if (left and chain.pieces in groups[0]) or (right and 0 in groups[-1]):
        return [None] * (chain.pieces + 1)
    return index


def nodal_matrices(
    chain: Chain, number: Callable[[Number], Any], load: Load | None = None
) -> tuple[list[list[Any]], list[list[Any]], list[list[Any]]]:
    """Return B, M and K in nodal coordinates, in the chain's own units and the algebra of `number`.

        piece i:   θ_i = (y_{i+1} - y_i)/l_i,   its centre of mass at  y_i + c_i θ_i
        joint j:   θ_{j+1} - θ_j

    M = Σ m (centre)ᵀ(centre) + J θᵀθ,   K = Σ k (joint)ᵀ(joint) + Σ_ends (K_t yᵀy + K_r θᵀθ) + Σ P θᵀθ,
    less Ω² M in the plane of rotation of a turning hub.
    """
    index = nodal_deflections(chain)
    slopes = _slopes(chain, index, number)
    size = len(_independent_nodes(chain)) + len(_free_angles(chain))
    mass, stiffness = ([[number(0)] * size for _ in range(size)] for _ in range(2))
    pulls = axial_pull(chain, checked_load(load))
    for i, slope in enumerate(slopes):
        centre = _sum(_unit(index[i], number), slope, number(chain.scaled.centre[i]))
        _add_square(mass, centre, number(chain.scaled.mass[i]))
        _add_square(mass, slope, number(chain.scaled.rotary_inertia[i]))
        _add_square(stiffness, slope, number(pulls[i]))
    joints = [_sum(slopes[j + 1], slopes[j], number(-1)) for j in range(chain.pieces - 1)]
    for joint, spring in zip(joints, chain.scaled.joint_stiffness, strict=True):
        _add_square(stiffness, joint, number(spring))
    for node, piece, supports in ((0, 0, chain.scaled.supports[0]), (-1, -1, chain.scaled.supports[1])):
        for row, spring in zip((_unit(index[node], number), slopes[piece]), supports, strict=True):
            _add_square(stiffness, row, number(0) if spring == math.inf else number(spring))
    if load is not None and load.spin_rate and load.plane == "lag":
        square = number(chain.exact_units.square_rate(load.spin_rate))
        stiffness = [
            [k - square * m for k, m in zip(*rows, strict=True)] for rows in zip(stiffness, mass, strict=True)
        ]
    rotations = [[joint.get(i, number(0)) for i in range(size)] for joint in joints]
    return rotations, mass, stiffness


def _slopes(chain: Chain, index: list[int | None], number: Callable[[Number], Any]) -> list[Row]:
    """Return every piece's angle in the nodal coordinates."""
    angles = iter(range(len(_independent_nodes(chain)), 2 * chain.pieces))
    slopes: list[Row] = []
    for i, held in enumerate(chain.held_angles):
        length = number(chain.scaled.length[i])
        if held:
            slopes.append({})
        elif not length:
            slopes.append({next(angles): number(1)})
        else:
            right, left = _unit(index[i + 1], number), _unit(index[i], number)
            slopes.append({k: value / length for k, value in _sum(right, left, number(-1)).items()})
    return slopes


def _unit(index: int | None, number: Callable[[Number], Any]) -> Row:
    return {} if index is None else {index: number(1)}


def _sum(first: Row, second: Row, factor: Any) -> Row:
    """Return  first + factor second  of two rows."""
    total = dict(first)
    for i, value in second.items():
        total[i] = total[i] + factor * value if i in total else factor * value
    return total


def _add_square(matrix: list[list[Any]], row: Row, factor: Any) -> None:
    """Add  factor rowᵀ row."""
    for i, left in row.items():
        for j, right in row.items():
            matrix[i][j] += factor * left * right


def _independent_nodes(chain: Chain) -> list[int]:
    """Return the node that names each independent deflection, the first of those that move alike."""
    index = nodal_deflections(chain)
    seen: dict[int, int] = {}
    for node, i in enumerate(index):
        if i is not None:
            seen.setdefault(i, node)
    return list(seen.values())


def _free_angles(chain: Chain) -> list[str]:
    """Return the names of the angles of pieces of length zero that turn."""
    turning = zip(chain.scaled.length, chain.held_angles, strict=True)
    return [f"theta_{i}" for i, (length, held) in enumerate(turning) if not length and not held]


@dataclass(frozen=True, repr=False)
class LinearModel(Shown):
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
        Under which it vibrates.

    Examples
    --------
    >>> import beammodes as bm
    >>> model = bm.linearize(bm.Chain(bm.Beam.unit(), "pinned-pinned", segments=4))
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
        return (*(f"y_{node}" for node in _independent_nodes(self.chain)), *_free_angles(self.chain))

    @property
    def rigid_body_modes(self) -> int:
        """Number of motions that store nothing. An axial force lets a rigid rotation store energy."""
        if not any(axial_pull(self.chain, self.load)):
            return self.chain.boundary.rigid_body_modes
        return int(not any(translation for translation, _ in self.chain.scaled.supports))

    @property
    def elastic_modes(self) -> int:
        """Number of modes that store energy."""
        chain = self.chain
        return chain.elastic_modes + chain.boundary.rigid_body_modes - self.rigid_body_modes

    @property
    def joint_rotations(self) -> Floats:
        """B, shape (hinges, coordinates) [1/m]: relative rotation of each joint for unit deflections."""
        return self._assembled()[0]

    @property
    def joint_stiffness(self) -> Floats:
        """The diagonal of D, shape (hinges,) [N m/rad]."""
        return self.chain.joint_stiffness

    @property
    def mass_matrix(self) -> Floats:
        """M, tridiagonal but for end bodies' angles, shape (coordinates, coordinates) [kg]."""
        return self._assembled()[1]

    @property
    def stiffness_matrix(self) -> Floats:
        """K, pentadiagonal but for end bodies' angles, shape (coordinates, coordinates) [N/m]."""
        return self._assembled()[2]

    def _assembled(self) -> tuple[Floats, Floats, Floats]:
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

    def _line(self) -> str:
        under = "" if self.load == Load() else f" under {self.load}"
        return f"LinearModel({self.chain!r}{under})"


@dataclass(frozen=True, eq=False, repr=False)
class BentModel(Shown):
    """The chain  M z'' + K z = 0  about an equilibrium, q = q_0 + basis z,  M and K full.

    Relative to a turning hub the energies are those of motion seen from it. What they leave out, Coriolis
    forces, is of second order about a straight shape. About a bent one it is of first order in the plane of
    rotation, which is therefore refused; across that plane a Coriolis force points out of it.

    Attributes
    ----------
    equilibrium : Equilibrium
        About which it vibrates. `equilibrium.basis` spans the motions that the closures allow; without
        closures z are the coordinates themselves.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=2)
    >>> bm.linearize(chain, at=bm.find_equilibrium(chain, None)).mass_matrix
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
        """Number of modes that store energy: all of them."""
        return int(self.equilibrium.basis.shape[1])

    @property
    def rigid_body_modes(self) -> int:
        """Number of motions that store nothing: none, or the equilibrium would not be stable."""
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

    def _line(self) -> str:
        return f"BentModel(about {self.equilibrium!r})"


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
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=2)
    >>> bm.linearize(chain).stiffness_matrix
    array([[ 51.2, -16. ],
           [-16. ,   8. ]])

    About the shape that it takes under its own weight, in angles:

    >>> bm.linearize(chain, at=bm.find_equilibrium(chain, bm.Load(gravity=20.0))).stiffness_matrix.round(6)
    array([[13.071977, -2.      ],
           [-2.      ,  4.416262]])
    """
    if not isinstance(chain, Chain):
        raise TypeError(
            f"chain must be a Chain, got {shown(chain)}; solve_modes takes an AxialChain itself, "
            "structure_chain_modes a StructureChain, spatial_modes a SpatialChain"
        )
    if at is not None:
        return _about(chain, load, at)
    return LinearModel(chain, straight_chain_load(chain, checked_load(load)))


def _about(chain: Chain, load: Load | None, at: Equilibrium) -> BentModel:
    if not isinstance(at, Equilibrium):
        raise TypeError(f"at must be an Equilibrium from find_equilibrium() or None, got {shown(at)}")
    if at.chain is not chain and at.chain != chain:
        raise ValueError(f"at must be of the same chain, {shown(chain)}, got one of {shown(at.chain)}")
    if load is not None and checked_load(load) != at.load:
        raise ValueError(f"load must be left out or be that of at, {at.load}, got {load}")
    if at.load.spin_rate and at.load.plane == "lag" and np.abs(np.sin(at.angle)).max() > 1e-9:
        raise ValueError(
            "at must be straight in the plane of rotation of a turning hub, where Coriolis forces about a "
            f'bent shape are of first order and left out here, got {at.load}: plane="flap" has none'
        )
    return BentModel(at)
