"""The exact stiffness of a uniform beam at its two ends, vibrating or not, and the inertia of matrices."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

from beammodes.exact.long_decimals import cosine_and_sine, pi

__all__ = ["EndStiffness", "end_stiffness", "inertia_and_determinant", "pinned_count"]

Matrix = list[list[Decimal]]
EndStiffness = tuple[Matrix, Decimal]


def end_stiffness(p: Decimal, q: Decimal) -> EndStiffness:
    """Return the forces for unit end motions y(0), y'(0), y(1), y'(1), and Δ, whose zeros are their poles.

    From y = A cosh px + B sinh px + C cos qx + D sin qx; the squares of cosh and sinh, which would cancel to
    e^(-2p) of themselves, are taken out by hand.

    Parameters
    ----------
    p, q : Decimal
        p² - q² = t and p q = √w of y'''' - t y'' = w y; p may be zero.

    Returns
    -------
    matrix, Decimal
        Symmetric, 4 by 4, and Δ, bounded, positive below the clamped beam's first root.

    Examples
    --------
    >>> stiffness, _ = end_stiffness(Decimal(0), Decimal(10) ** -4)
    >>> [round(float(entry), 6) for entry in stiffness[0]]
    [12.0, 6.0, -12.0, 6.0]
    """
    cosine, sine = cosine_and_sine(q)
    grown = p.exp()
    even, odd = (grown + 1 / grown) / 2, (grown - 1 / grown) / (2 * p) if p else Decimal(1)  # cosh, sinh/p
    tension, total, mixed = p * p - q * q, p * p + q * q, even * cosine
    pole = 2 - 2 * mixed + tension * odd * sine / q
    a = total * (p * p * odd * cosine + q * sine * even) / pole
    b = (tension * (mixed - 1) + 2 * p * p * q * odd * sine) / pole
    c, d = total * (even * sine / q - cosine * odd) / pole, -total * (p * p * odd + q * sine) / pole
    e, f = total * (even - cosine) / pole, total * (odd - sine / q) / pole
    return [[a, b, d, e], [b, c, -e, f], [d, -e, a, -b], [e, f, -b, c]], pole / even


def pinned_count(q: Decimal) -> int:
    """Return how many roots n π of the pinned beam lie below `q`.

    Examples
    --------
    >>> pinned_count(Decimal("6.3"))
    2
    """
    return max(0, int((q / pi()).to_integral_value("ROUND_CEILING")) - 1)


def inertia_and_determinant(matrix: Matrix, kept: Sequence[int]) -> tuple[int, Decimal]:
    """Return how many eigenvalues of a symmetric matrix's kept rows and columns are negative, and its det.

    By Gaussian elimination without exchanges (Sylvester's law of inertia): a pivot of zero is taken for a
    tiny positive one, whose successor then counts right.

    Examples
    --------
    >>> inertia_and_determinant([[Decimal(0), Decimal(2)], [Decimal(2), Decimal(3)]], [0, 1])[0]
    1
    """
    rows = [[matrix[i][j] for j in kept] for i in kept]
    negative, determinant = 0, Decimal(1)
    for step, pivot_row in enumerate(rows):
        pivot = pivot_row[step] or Decimal("1e-1000")
        negative += pivot < 0
        determinant *= pivot
        for i in range(step + 1, len(rows)):
            factor = rows[i][step] / pivot
            for j in range(i, len(rows)):
                rows[i][j] -= factor * pivot_row[j]
                rows[j][i] = rows[i][j]
    return negative, determinant
