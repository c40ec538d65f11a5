"""The linear chain in its factors: small transverse vibration about the straight chain at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chain import Chain, Number
from beammodes.checks import shown

__all__ = ["MAX_ASSEMBLED", "LinearModel", "linearize", "nodal_deflections", "nodal_matrices"]

Array = NDArray[np.float64]

#: Matrices of more rows are not assembled: an assembled stiffness matrix of a long chain has already lost the
#: digits of its lowest modes (its condition number grows as N⁴), so it would only mislead.
MAX_ASSEMBLED = 2000


@dataclass(frozen=True)
class LinearModel:
    """The linear chain  M y'' + K y = 0,  kept in its factors.

    K = Bᵀ D B, with B the joints' relative rotations and D the joint stiffnesses on the diagonal; M is the
    pieces' inertia. `solve_modes` works on these factors and never on the assembled matrices, which are
    for reading and for checking.

    Attributes
    ----------
    chain : Chain
        The pieces and springs that the factors are made of.

    Examples
    --------
    >>> from beammodes.beam import Beam
    >>> model = linearize(Chain(Beam.unit(), "pinned-pinned", segments=4))
    >>> model.coordinates
    ('y_1', 'y_2', 'y_3')
    >>> (24 * model.mass_matrix).round(12)
    array([[4., 1., 0.],
           [1., 4., 1.],
           [0., 1., 4.]])
    """

    chain: Chain

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the independent deflections: of every tip and hinge, left to right, that can move."""
        return tuple(f"y_{node}" for node in _independent_nodes(self.chain))

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
        """M, tridiagonal, shape (coordinates, coordinates) [kg]."""
        return self._assembled()[1]

    @property
    def stiffness_matrix(self) -> Array:
        """K = Bᵀ D B, pentadiagonal, shape (coordinates, coordinates) [N/m]."""
        return self._assembled()[2]

    def _assembled(self) -> tuple[Array, Array, Array]:
        rows = self.chain.pieces
        if rows > MAX_ASSEMBLED:
            raise ValueError(
                f"matrices of a chain of {rows} pieces are not assembled (at most {MAX_ASSEMBLED}); "
                "solve_modes needs none of them"
            )
        units = self.chain.units
        rotations, mass, stiffness = (
            # Reshaped, since a chain that cannot move has matrices without columns.
            np.array(matrix, dtype=np.float64).reshape(len(matrix), len(self.coordinates))
            for matrix in nodal_matrices(self.chain, float)
        )
        return rotations / units.length, mass * units.mass, stiffness * units.stiffness / units.length**2


def linearize(chain: Chain) -> LinearModel:
    """Return the linear model of a chain's small transverse vibration about its straight shape.

        M y'' + Bᵀ D B y = 0

    Parameters
    ----------
    chain : Chain
        Any chain; nothing is assembled here, so its length does not matter.

    Raises
    ------
    TypeError
        If `chain` is no Chain.

    Examples
    --------
    >>> from beammodes.beam import Beam
    >>> linearize(Chain(Beam.unit(), "clamped-free", segments=2)).stiffness_matrix
    array([[ 51.2, -16. ],
           [-16. ,   8. ]])
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    return LinearModel(chain)


def nodal_deflections(chain: Chain) -> list[int | None]:
    """Return, for each node of the chain, the index of its independent deflection, None where it is held.

    Nodes are the left tip, the hinges and the right tip, 0 to p for p pieces. The two nodes of a piece
    whose angle an end holds deflect alike: both are zero (clamped) or one coordinate (guided).
    """
    groups: list[list[int]] = [[0]]
    for piece, held in enumerate(chain.held_angles):
        groups[-1].append(piece + 1) if held else groups.append([piece + 1])
    index: list[int | None] = [None] * (chain.pieces + 1)
    left, right = chain.boundary.left.holds_deflection, chain.boundary.right.holds_deflection
    moving = groups[int(left) : len(groups) - int(right)]
    for i, group in enumerate(moving):
        for node in group:
            index[node] = i
    if (left and 0 in groups[-1]) or (right and chain.pieces in groups[0]):
        return [None] * (chain.pieces + 1)
    return index


def nodal_matrices(
    chain: Chain, number: Callable[[Number], Any]
) -> tuple[list[list[Any]], list[list[Any]], list[list[Any]]]:
    """Return B, M and K = Bᵀ D B in nodal deflections, in the chain's own units and the algebra of `number`.

    ::

        piece i:   θ_i = (y_{i+1} - y_i)/l_i        joint j:   θ_{j+1} - θ_j

                          m/4 + J/l²   m/4 - J/l²
        inertia of i:
                          m/4 - J/l²   m/4 + J/l²
    """
    index = nodal_deflections(chain)
    size = len(_independent_nodes(chain))
    slopes, mass = [], [[number(0)] * size for _ in range(size)]
    for i, held in enumerate(chain.held_angles):
        ends, length, weight = (index[i], index[i + 1]), number(chain.piece_length[i]), chain.piece_mass[i]
        slopes.append({} if held else {ends[0]: -1 / length, ends[1]: 1 / length})
        quarter = number(weight) / 4
        turning = number(0) if held else number(chain.piece_rotary_inertia[i]) / length**2
        for a in (0, 1):
            for b in (0, 1):
                row, column = ends[a], ends[b]
                if row is not None and column is not None:
                    mass[row][column] += quarter + (turning if a == b else -turning)
    rotations = [_difference(slopes[j], slopes[j + 1], size, number) for j in range(chain.pieces - 1)]
    stiffness = [[number(0)] * size for _ in range(size)]
    for row_of_b, spring in zip(rotations, chain.hinge_stiffness, strict=True):
        touched = [i for i, value in enumerate(row_of_b) if value != 0]
        for i in touched:
            for j in touched:
                stiffness[i][j] += number(spring) * row_of_b[i] * row_of_b[j]
    return rotations, mass, stiffness


def _difference(
    before: dict[int | None, Any], after: dict[int | None, Any], size: int, number: Callable[[Number], Any]
) -> list[Any]:
    row = [number(0)] * size
    for slope, sign in ((before, -1), (after, 1)):
        for i, value in slope.items():
            if i is not None:
                row[i] += sign * value
    return row


def _independent_nodes(chain: Chain) -> list[int]:
    """Return the node that names each independent deflection, the first of those that move alike."""
    index = nodal_deflections(chain)
    seen: dict[int, int] = {}
    for node, i in enumerate(index):
        if i is not None:
            seen.setdefault(i, node)
    return list(seen.values())
