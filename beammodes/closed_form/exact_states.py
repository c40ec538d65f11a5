"""States carried along a chain, in exact algebra: over rods, over hinges, and out of an end.

Lengths are counted in segments, and the segment's mass and EI/ell are 1. A state is (y, θ, M, V). Its entries
are polynomials in x = s² = sin²(q/2), which stands for the frequency,

    ω² = 16 x² / d,   d = 1 - p x,   p = 1 - 4 × rotary inertia,

and in u = 1/N, by which weights may depend on the number of segments; the coefficients are rational.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Rule
from beammodes.problem.ends import Boundary, End

__all__ = ["ExactState", "Poly", "admitted", "characteristic_polynomial", "expanded", "is_hinged", "term"]

_HALF, _ONE = Fraction(1, 2), Fraction(1)


class Poly(dict[tuple[int, int, int], Fraction]):
    """A polynomial: (i, j, k) → coefficient of xⁱ dʲ uᵏ, where d = 1 - p x may have j < 0."""

    def __add__(self, other: Poly) -> Poly:
        total = Poly(self)
        for key, value in other.items():
            total[key] = total.get(key, Fraction(0)) + value
        return total

    def __mul__(self, other: Poly) -> Poly:
        product = Poly()
        for (a, b, c), left in self.items():
            for (i, j, k), right in other.items():
                key = (a + i, b + j, c + k)
                product[key] = product.get(key, Fraction(0)) + left * right
        return product


ExactState = tuple[Poly, Poly, Poly, Poly]


def term(value: Fraction | int, x: int = 0, d: int = 0, u: int = 0) -> Poly:
    """Return `value` times powers of x, d and u; without terms if `value` is 0.

    Examples
    --------
    >>> term(3, x=2)
    {(2, 0, 0): Fraction(3, 1)}
    """
    return Poly({(x, d, u): Fraction(value)}) if value else Poly()


_OMEGA_SQUARED = term(16, 2, -1)


def _across_rod(state: ExactState, length: Fraction, inertia: Fraction) -> ExactState:
    """Carry a state over a rigid rod of mass |length|; a negative length carries it back.

    Momentum: V₁ - V₀ = ω² l (y₀ + y₁)/2 and M₁ - M₀ = l (V₀ + V₁)/2 - ω² r l³ θ.
    """
    y, slope, moment, shear = state
    far = y + slope * term(length)
    shear_far = shear + _OMEGA_SQUARED * (y + far) * term(length / 2)
    turned = _OMEGA_SQUARED * slope * term(-inertia * length**3)
    return far, slope, moment + (shear + shear_far) * term(length / 2) + turned, shear_far


def _across_hinge(state: ExactState, weight: Poly) -> ExactState:
    y, slope, moment, shear = state
    return y, slope + weight * moment, moment, shear


def _free(end: End) -> tuple[int, int]:
    """Return the indices of the state's two quantities that the end does not fix."""
    return 3 if end.holds_deflection else 0, 2 if end.holds_rotation else 1


def _held(end: End) -> tuple[int, int]:
    return 0 if end.holds_deflection else 3, 1 if end.holds_rotation else 2


def _unit_state(index: int) -> ExactState:
    y, slope, moment, shear = (term(int(index == i)) for i in range(4))
    return y, slope, moment, shear


def is_hinged(rule: Rule, end: End) -> bool:
    """Return whether the end's rods begin with a hinge; at pinned and free ends most layouts have none."""
    return rule.stub == _HALF or end.holds_rotation


def admitted(rule: Rule, end: End, *, back: bool) -> list[ExactState]:
    """Return v₁, v₂ in the middle of the last corrected hinge, or carried back from there.

    The two quantities that the end leaves free are carried over its stub and its corrected hinges; and, if
    asked, back through unmodified segments to the first hinge that an unmodified chain would have, at x = 1/2
    for half stubs and x = 0 else.
    """
    states = [_unit_state(index) for index in _free(end)]
    if not is_hinged(rule, end):
        return states
    weights = [term(w.constant) + term(w.per_segment, u=1) for w in rule.end_weights(end)] or [term(1)]
    return [_carried(state, weights, rule, back=back) for state in states]


def _carried(state: ExactState, weights: Sequence[Poly], rule: Rule, *, back: bool) -> ExactState:
    inertia = rule.rotary_inertia
    state = _across_rod(state, rule.stub, inertia)
    for weight in weights[:-1]:
        state = _across_rod(_across_hinge(state, weight), _ONE, inertia)
    state = _across_hinge(state, weights[-1] + term(-_HALF))
    for _ in range(len(weights) - 1 + int(rule.stub) if back else 0):
        state = _across_hinge(state, term(-_HALF))
        state = _across_hinge(_across_rod(state, -_ONE, inertia), term(-_HALF))
    return state


def expanded(polynomials: list[Poly], p: Fraction) -> NDArray[Any]:
    """Multiply by the power of d that clears all denominators and write out d = 1 - p x.

    Parameters
    ----------
    polynomials : list of Poly
    p : Fraction

    Returns
    -------
    ndarray of Fraction, shape (polynomials, powers of u, powers of x)
        Without factors d that all have in common.
    """
    keys = [key for polynomial in polynomials for key, value in polynomial.items() if value]
    lowest = min(d for _, d, _ in keys)
    degree = max(x + d - lowest for x, d, _ in keys)
    shape = len(polynomials), 1 + max(u for _, _, u in keys), degree + 1
    tables = np.full(shape, Fraction(0), dtype=object)
    for column, polynomial in enumerate(polynomials):
        for (x, d, u), value in polynomial.items():
            for k in range(d - lowest + 1 if value else 0):
                tables[column, u, x + k] += value * math.comb(d - lowest, k) * (-p) ** k
    return _without_d(tables, p)


def _without_d(tables: NDArray[Any], p: Fraction) -> NDArray[Any]:
    """Divide by 1 - p x as often as that leaves no remainder."""
    while p and tables.shape[2] > 1:
        quotient = tables.copy()
        for k in range(1, tables.shape[2]):
            quotient[:, :, k] += p * quotient[:, :, k - 1]
        if quotient[:, :, -1].any():
            break
        tables = quotient[:, :, :-1]
    return tables


def characteristic_polynomial(rule: Rule, pair: Boundary, segments: int) -> list[Fraction]:
    """Return the coefficients, constant first, of a polynomial in ω² (units of EI/(ρA ell⁴)).

    Its roots are the elastic modes of the chain; the zero roots of rigid motions are divided out.

    Examples
    --------
    >>> from beammodes.chains.rules import rule_named
    >>> characteristic_polynomial(rule_named("double_wall"), Boundary.of("clamped-free"), 1)   # 1 - ω²/6
    [Fraction(1, 1), Fraction(-1, 6)]
    """
    lengths, weights = rule.piece_lengths(pair, segments), rule.hinge_weights(pair, segments)
    first, second = (_unit_state(index) for index in _free(pair.left))
    for length, weight in zip(lengths, [*weights, Fraction(0)], strict=True):
        first, second = (
            _across_hinge(_across_rod(state, length, rule.rotary_inertia), term(weight))
            for state in (first, second)
        )
    a, b = _held(pair.right)
    determinant = first[a] * second[b] + term(-1) * first[b] * second[a]
    # ω² = 16 x²/d is the only way in which x and d enter.
    degree = max(x // 2 for x, _, _ in determinant)
    by_power = [determinant.get((2 * k, -k, 0), Fraction(0)) / 16**k for k in range(degree + 1)]
    while by_power and not by_power[-1]:
        by_power.pop()
    return by_power[next(k for k, value in enumerate(by_power) if value) :]
