"""A planar chain's generalized coordinates: which there are, and what the ends hold of them.

q = (x₀, y₀, θ₁, θ₂, ...): the position of the left tip, where the left end leaves it free, and the absolute
angle of every piece that no end holds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from beammodes.chains.chain import Chain, Number

__all__ = ["axially_free_left", "coordinate_names", "moving_pieces", "null_space", "tip_names", "unpack"]


def coordinate_names(chain: Chain) -> list[str]:
    """Return the names of the generalized coordinates, in order: x_0, y_0 (if free), theta_1, theta_2, ...

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> coordinate_names(Chain(Beam.unit(), "guided-free", segments=2))
    ['y_0', 'theta_1', 'theta_2']
    """
    moving = len(moving_pieces(chain))
    return [*tip_names(chain), *(f"theta_{i + 1}" for i in range(moving))]


def null_space(rows: Sequence[Sequence[Any]], size: int, number: Callable[[Number], Any]) -> list[list[Any]]:
    """Return a basis of the vectors that at most one non-trivial row annihilates, as a list of columns.

    The first coordinate that the row contains is expressed by the others, so exact entries stay exact.
    """
    pivots = [(row, p) for row in rows for p in [next((i for i, c in enumerate(row) if c != 0), None)]]
    basis = [[number(int(i == j)) for i in range(size)] for j in range(size)]
    for row, pivot in pivots:
        if pivot is None:
            continue
        for j, column in enumerate(basis):
            column[pivot] = -row[j] / row[pivot]
        del basis[pivot]
    return basis


def axially_free_left(chain: Chain) -> bool:
    """Say whether nothing ties the left end to the ground, so that its axial position is a coordinate."""
    return not chain.boundary.left.is_grounded


def tip_names(chain: Chain) -> list[str]:
    """Return the names of the left tip's coordinates, those that its end leaves free."""
    tip_free = not chain.boundary.left.holds_deflection
    return [*(["x_0"] if axially_free_left(chain) else []), *(["y_0"] if tip_free else [])]


def moving_pieces(chain: Chain) -> list[int]:
    """Return the indices of the pieces whose angles are coordinates."""
    return [i for i, held in enumerate(chain.held_angles) if not held]


def _with_held(chain: Chain, angle: Sequence[Any]) -> list[Any]:
    values = iter(angle)
    return [0 if held else next(values) for held in chain.held_angles]


def unpack(chain: Chain, q: Sequence[Any]) -> tuple[tuple[Any, Any], list[Any]]:
    """Return the left tip (x, y) and every piece's angle, held ones included."""
    names = tip_names(chain)
    tip = dict(zip(names, q, strict=False))
    return (tip.get("x_0", 0), tip.get("y_0", 0)), _with_held(chain, q[len(names) :])
