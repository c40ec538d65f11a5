"""The inside of a uniform chain, a row of equal rods between equal hinges, in closed form at any length.

In units of a rod (length, mass, hinge stiffness 1; r its central rotary inertia, t the axial force) a wave
y_j = cos qj has, with x = sin²(q/2), the squared frequency

    w = (16 x² + 4 t x) / (1 - (1 - 4r) x).

For w > 0 that is a quadratic equation with one root x > 0 and one -X < 0, and w = 16 x X whatever t. They are
an oscillating wave (beyond the band's edge x = 1 one that alternates and decays, q = π + iσ) and an
evanescent one, X = sinh²(χ/2). A row of n rods, cut at both ends in the middle of a hinge, moves
symmetrically about its own middle with cos qj and cosh χj, antisymmetrically with sin qj and sinh χj. Either
way its left end has the stiffness

    4/(T + τ) [ -(x + X) τ T,  x T - X τ;  x T - X τ,  x + X ]       of (y, θ), with

    symmetric:      τ = sin q tan(qn/2),    T = sinh χ tanh(χn/2),
    antisymmetric:  τ = -sin q cot(qn/2),   T = sinh χ coth(χn/2).

Its modes with both ends pinned are q = kπ/n, k < n; holding the two ends' rotations as well takes away as
many below w as there are negative stiffnesses θθ, that is negative T + τ: Wittrick and Williams, Quarterly
Journal of Mechanics and Applied Mathematics 24 (1971). Powers of cos q + i sin q and of e^χ give all of it
without angles.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import NamedTuple

__all__ = ["Row", "row_of_rods"]

Stiffness = tuple[Decimal, Decimal, Decimal]


class Row(NamedTuple):
    """Stiffness (yy, yθ, θθ) of symmetric and antisymmetric motion, clamped modes below w, their determinant.

    The determinant lacks positive factors; with them it is a polynomial in w without the stiffnesses' poles.
    """

    symmetric: Stiffness
    antisymmetric: Stiffness
    clamped: int
    determinant: Decimal


def row_of_rods(rods: int, inertia: Decimal, tension: Decimal, square: Decimal) -> Row:
    """Return the dynamic stiffness of a row of an even number of rods at w = `square` > 0.

    Examples
    --------
    >>> row = row_of_rods(1000, 1 / Decimal(12), Decimal(0), Decimal("2e-8"))
    >>> row.clamped                       # q n = 4.73, 7.85, 11.0, 14.1, ... of a clamped beam; here 11.9
    3
    """
    x, evanescent = _waves(inertia, tension, square)
    turns, inside, below = _oscillating(rods, x)
    growths = _evanescent(rods, evanescent)
    sums = [turn + growth for turn, growth in zip(turns, growths, strict=True)]
    symmetric, antisymmetric = (
        _stiffness(x, evanescent, turn, growth) for turn, growth in zip(turns, growths, strict=True)
    )
    clamped = below - sum(value < 0 for value in sums)
    return Row(symmetric, antisymmetric, clamped, inside * sums[0] * sums[1])


def _waves(inertia: Decimal, tension: Decimal, square: Decimal) -> tuple[Decimal, Decimal]:
    """Return x and X."""
    middle = 4 * tension + (1 - 4 * inertia) * square
    root = (middle * middle + 64 * square).sqrt()
    x = 2 * square / (root + middle) if middle > 0 else (root - middle) / 32
    return x, square / (16 * x)


def _stiffness(x: Decimal, evanescent: Decimal, turn: Decimal, growth: Decimal) -> Stiffness:
    common = 4 / (growth + turn)
    total = (x + evanescent) * common
    return -total * turn * growth, (x * growth - evanescent * turn) * common, total


def _evanescent(rods: int, evanescent: Decimal) -> tuple[Decimal, Decimal]:
    """Return T of symmetric and antisymmetric motion."""
    sinh, tanh = _hyperbolic(rods, evanescent)
    return sinh * tanh, sinh / tanh


def _hyperbolic(rods: int, x: Decimal) -> tuple[Decimal, Decimal]:
    """Return sinh χ and tanh(χn/2) where x = sinh²(χ/2)."""
    sinh = 2 * (x * (1 + x)).sqrt()
    decay = (1 / (1 + 2 * x + sinh)) ** rods
    return sinh, (1 - decay) / (1 + decay)


def _oscillating(rods: int, x: Decimal) -> tuple[tuple[Decimal, Decimal], Decimal, int]:
    """Return τ of both motions, sin(qn/2) cos(qn/2) / sin q, and how many pinned modes lie below."""
    if x > 1:
        sinh, tanh = _hyperbolic(rods, x - 1)
        return (sinh * tanh, sinh / tanh), -tanh / sinh, rods - 1
    sin = 2 * (x * (1 - x)).sqrt()
    cosine, sine = _power(1 - 2 * x, sin, rods // 2)
    product = sine * cosine
    turns = sin * sine / cosine, -sin * cosine / sine
    # The sign of sin qn says whether k is even: so a rounded angle is enough to know k = ⌊qn/π⌋.
    odd = int(product < 0)
    angle = 2 * rods * math.atan2(math.sqrt(x), math.sqrt(1 - x))
    return turns, product / sin, 2 * round((angle / math.pi - 0.5 - odd) / 2) + odd


def _power(cosine: Decimal, sine: Decimal, exponent: int) -> tuple[Decimal, Decimal]:
    """Return cos and sin of `exponent` times an angle."""
    real, imaginary = Decimal(1), Decimal(0)
    for bit in f"{exponent:b}":
        real, imaginary = 1 - 2 * imaginary * imaginary, 2 * real * imaginary
        if bit == "1":
            real, imaginary = real * cosine - imaginary * sine, real * sine + imaginary * cosine
    return real, imaginary
