"""The quadrature at a chain's end: what its weights integrate wrongly, and the order that they leave.

A chain's flexibility is the sum of w_j ell f(x_j) over its hinges, a beam's the integral of f = M²/EI.
Euler and Maclaurin say what is wrong with the sum: nothing inside, and at each end, with h = 1/N, the first
hinge at x₀ h and the corrections c_j = w_j - 1 of the weights,

    Σ w_j h f(x_j) - ∫ f = Σ_k h^(k+1) d_k f⁽ᵏ⁾(0),
    d_k = Σ_j c_j x_j^k / k! - B_{k+1}(x₀) / (k+1)!        (B the Bernoulli polynomials).

The first d_k that is not zero, and meets a derivative of f that is not zero at that end, decides the order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache

__all__ = ["CANCELLED", "HIGHEST_ORDER", "end_defects", "end_order"]

#: Rods and hinges err alike up to this order inside a chain; no end can do better.
HIGHEST_ORDER = 4

#: Terms this small beside their natural size are rounding, or have cancelled.
CANCELLED = 1e-9

#: Derivatives of M² that need not vanish: M is zero at pinned and free ends, M' at guided ones.
_FELT: Mapping[str, tuple[int, ...]] = {
    "clamped": (0, 1, 2, 3),
    "carried": (0, 1, 2, 3),
    "guided": (0, 2),
    "pinned": (2, 3),
    "free": (2, 3),
}


def end_defects(
    first: Fraction, weights: Sequence[tuple[Fraction, Fraction]]
) -> list[tuple[Fraction, Fraction]]:
    """Return  d_k = constant + per_segment/N,  k = 0..3, of a quadrature.

    Parameters
    ----------
    first : Fraction
        x₀, where the first hinge is, in segments from the end.
    weights : sequence of (constant, per_segment)
        Of the hinges nearest the end; 1 beyond.

    Examples
    --------
    >>> gregory = [(Fraction(w), Fraction(0)) for w in ("3/8", "7/6", "23/24")]
    >>> [str(constant) for constant, _ in end_defects(Fraction(0), gregory)]
    ['0', '0', '0', '-19/720']
    """
    defects = []
    for k in range(HIGHEST_ORDER):
        moments = [Fraction((first + j) ** k, math.factorial(k)) for j in range(len(weights))]
        bare = -_bernoulli(k + 1, first) / math.factorial(k + 1)
        constant = sum((m * (w - 1) for m, (w, _) in zip(moments, weights, strict=True)), bare)
        slipped = sum((m * s for m, (_, s) in zip(moments, weights, strict=True)), Fraction(0))
        defects.append((constant, slipped))
    return defects


def end_order(kind: str, first: Fraction, weights: Sequence[tuple[Fraction, Fraction]]) -> int:
    """Return the order of the error that an end of that kind leaves: 1 to 4.

    Examples
    --------
    >>> end_order("clamped", Fraction(0), [(Fraction(1, 2), Fraction(0))])          # trapezoids: f' remains
    2
    """
    defects = end_defects(first, weights)
    powers = [HIGHEST_ORDER]
    for k in _FELT[kind]:
        constant, slipped = defects[k]
        powers += [k + 1] if abs(constant) > CANCELLED else []
        powers += [k + 2] if abs(slipped) > CANCELLED else []
    return min(powers)


def _bernoulli(k: int, x: Fraction) -> Fraction:
    coefficients = _bernoulli_polynomials()[k]
    return sum((c * x**power for power, c in enumerate(coefficients)), Fraction(0))


@lru_cache(maxsize=1)
def _bernoulli_polynomials() -> list[list[Fraction]]:
    """Return the coefficients of B_0 .. B_4, from B_k' = k B_{k-1} and ∫₀¹ B_k = 0."""
    found = [[Fraction(1)]]
    for k in range(1, HIGHEST_ORDER + 1):
        rising = [k * c / (power + 1) for power, c in enumerate(found[-1])]
        mean = sum((c / (power + 2) for power, c in enumerate(rising)), Fraction(0))
        found.append([-mean, *rising])
    return found
