"""A long chain put together from its two ends' blocks and the row of rods between them, modes counted.

The modes below a squared frequency w are as many as those of the three parts with their cuts held and the
negative eigenvalues of the parts' common stiffness at the cuts, together: elimination of K - w M in the parts
first and at the cuts last has these pivots (Sylvester's law of inertia).
"""

from __future__ import annotations

from decimal import Decimal

from beammodes.closed_form.carried_planes import Plane
from beammodes.closed_form.rod_row import Row

__all__ = ["joined"]


def joined(planes: list[Plane], row: Row) -> tuple[int, Decimal]:
    """Return the count and the determinant of two blocks with a row of rods between them.

    Coordinates are y and θ where the left block ends, y and -θ where the right one does: equal in symmetric
    motion, opposite in antisymmetric.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from beammodes.closed_form.carried_planes import block_of, carried
    >>> from beammodes.chains.pieces import Pieces
    >>> from beammodes.closed_form.rod_row import row_of_rods
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((0.0, 0.0), (0.0, 0.0)))
    >>> w, none = Decimal("0.01"), Decimal(0)
    >>> end = carried(block_of(rod, 1, Fraction(1, 2)), w, none)
    >>> joined([end, end], row_of_rods(8, 1 / Decimal(12), none, w))[0]  # free, √w N² = 10 < 22.4
    2
    """
    pairs = list(zip(row.symmetric, row.antisymmetric, strict=True))
    own, other = ([(a + sign * b) / 2 for a, b in pairs] for sign in (1, -1))
    (a, b, c), (d, e, f) = ([x + y for x, y in zip(plane.stiffness(), own, strict=True)] for plane in planes)
    (p, q, r) = other
    matrix = [[a, b, p, q], [b, c, q, r], [p, q, d, e], [q, r, e, f]]
    count, value = _eliminated(matrix)
    for plane in planes:
        count += plane.below
        value *= plane.minor(0, 1)
    return count + row.clamped, value * row.determinant


def _eliminated(matrix: list[list[Decimal]]) -> tuple[int, Decimal]:
    """Return how many eigenvalues of a symmetric matrix are negative, and its determinant."""
    count, determinant = 0, Decimal(1)
    while matrix:
        (pivot, *row), *rest = matrix
        count += pivot < 0
        determinant *= pivot
        factors = [value / pivot for value in row]
        matrix = [
            [value - factor * above for value, above in zip(below[1:], row, strict=True)]
            for factor, below in zip(factors, rest, strict=True)
        ]
    return count, determinant
