"""The linear chain's matrices in nodal coordinates, in the chain's own units and any algebra.

Coordinates are the deflections of the nodes: the left tip, the hinges, the right tip. Nodes at either side
of a piece that is held or has no length share one. A piece of length zero that turns (a body with rotary
inertia at an end) has its angle as a coordinate of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from beammodes.chains.chain import Chain, Number
from beammodes.equations.axial_pull import axial_pull
from beammodes.problem.loading import Load, checked_load

__all__ = ["free_angles", "independent_nodes", "nodal_deflections", "nodal_matrices"]

Row = dict[int, Any]


def nodal_deflections(chain: Chain) -> list[int | None]:
    """Return, for each node of the chain, the index of its independent deflection, None where it is held.

    Nodes are the left tip, the hinges and the right tip, 0 to p for p pieces. The two nodes of a piece
    whose angle an end holds, or that has no length, deflect alike.
    """
    groups: list[list[int]] = [[0]]
    for piece, held in enumerate(chain.held_angles):
        alike = held or not chain.piece_length[piece]
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
    size = len(independent_nodes(chain)) + len(free_angles(chain))
    mass, stiffness = ([[number(0)] * size for _ in range(size)] for _ in range(2))
    pulls = axial_pull(chain, checked_load(load))
    for i, slope in enumerate(slopes):
        centre = _sum(_unit(index[i], number), slope, number(chain.piece_centre[i]))
        _add_square(mass, centre, number(chain.piece_mass[i]))
        _add_square(mass, slope, number(chain.piece_rotary_inertia[i]))
        _add_square(stiffness, slope, number(pulls[i]))
    joints = [_sum(slopes[j + 1], slopes[j], number(-1)) for j in range(chain.pieces - 1)]
    for joint, spring in zip(joints, chain.hinge_stiffness, strict=True):
        _add_square(stiffness, joint, number(spring))
    for node, piece, supports in ((0, 0, chain.supports[0]), (-1, -1, chain.supports[1])):
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
    angles = iter(range(len(independent_nodes(chain)), 2 * chain.pieces))
    slopes: list[Row] = []
    for i, held in enumerate(chain.held_angles):
        length = number(chain.piece_length[i])
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


def independent_nodes(chain: Chain) -> list[int]:
    """Return the node that names each independent deflection, the first of those that move alike."""
    index = nodal_deflections(chain)
    seen: dict[int, int] = {}
    for node, i in enumerate(index):
        if i is not None:
            seen.setdefault(i, node)
    return list(seen.values())


def free_angles(chain: Chain) -> list[str]:
    """Return the names of the angles of pieces of length zero that turn."""
    turning = zip(chain.piece_length, chain.held_angles, strict=True)
    return [f"theta_{i}" for i, (length, held) in enumerate(turning) if not length and not held]
