"""The four waves of a uniform chain and what each kind of end makes of them, in exact algebra.

Lengths are counted in segments, and the segment's mass and EI/ell are 1. Inside, every motion of one
frequency is a sum of cos qj, sin qj, cosh χj and sinh χj. With s = sin(q/2), S = sinh(χ/2) and
p = 1 - 4r, r being the rods' central rotary inertia over mass·length², everything is a function of s:

    S² = s² / (1 - p s²),        ω = 4 s S = 4 s² / √(1 - p s²).

The state (y, θ, M, V) in the middle of a hinge (half of its spring on either side) is then

    cos qx → (cos qx, -sin q sin qx, -4s² cos qx, 4S² sin q sin qx),
    cosh χx → (cosh χx, sinh χ sinh χx, 4S² cosh χx, 4s² sinh χ sinh χx),

and the other two are their quarter-period partners: the beam's own waves, with sin q for q, and 4s² or 4S²
for q² in the moment. An end lets a plane of states through, spanned by v₁ and v₂. It enters the chain's
characteristic equation only through the six determinants m_ij = |v₁ v₂ Wᵢ Wⱼ| for pairs of waves: each
is a polynomial in x = s² and in u = 1/N, with rational coefficients, times square roots that depend on
the pair alone. Cancellation between an end's corrections is therefore exact, to any order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.ends import Boundary, End
from beammodes.rules import Rule

__all__ = [
    "PAIRS",
    "SERIES_TERMS",
    "EndWaves",
    "Minors",
    "binomial",
    "characteristic_polynomial",
    "end_waves",
    "powers_of",
]

_HALF, _ONE = Fraction(1, 2), Fraction(1)


class _Poly(dict[tuple[int, int, int], Fraction]):
    """A polynomial: (i, j, k) → coefficient of xⁱ dʲ uᵏ, where d = 1 - p x may have j < 0."""

    def __add__(self, other: _Poly) -> _Poly:
        total = _Poly(self)
        for key, value in other.items():
            total[key] = total.get(key, Fraction(0)) + value
        return total

    def __mul__(self, other: _Poly) -> _Poly:
        product = _Poly()
        for (a, b, c), left in self.items():
            for (i, j, k), right in other.items():
                key = (a + i, b + j, c + k)
                product[key] = product.get(key, Fraction(0)) + left * right
        return product


def _term(value: Fraction | int, x: int = 0, d: int = 0, u: int = 0) -> _Poly:
    return _Poly({(x, d, u): Fraction(value)}) if value else _Poly()


_OMEGA_SQUARED = _term(16, 2, -1)
_State = tuple[_Poly, _Poly, _Poly, _Poly]


def _across_rod(state: _State, length: Fraction, inertia: Fraction) -> _State:
    """Carry a state over a rigid rod of mass |length|; a negative length carries it back.

    Momentum: V₁ - V₀ = ω² l (y₀ + y₁)/2 and M₁ - M₀ = l (V₀ + V₁)/2 - ω² r l³ θ.
    """
    y, slope, moment, shear = state
    far = y + slope * _term(length)
    shear_far = shear + _OMEGA_SQUARED * (y + far) * _term(length / 2)
    turned = _OMEGA_SQUARED * slope * _term(-inertia * length**3)
    return far, slope, moment + (shear + shear_far) * _term(length / 2) + turned, shear_far


def _across_hinge(state: _State, weight: _Poly) -> _State:
    y, slope, moment, shear = state
    return y, slope + weight * moment, moment, shear


def _admitted(rule: Rule, end: End, *, back: bool) -> list[_State]:
    """Return v₁, v₂ in the middle of the last corrected hinge, or carried back from there.

    The two quantities that the end leaves free are carried over its stub and its corrected hinges; and, if
    asked, back through unmodified segments to the first hinge that an unmodified chain would have, at x = 1/2
    for half stubs and x = 0 else.
    """
    states = [_unit_state(index) for index in _free(end)]
    if not _hinged(rule, end):
        return states
    weights = [_term(w.constant) + _term(w.per_segment, u=1) for w in rule.end_weights(end)] or [_term(1)]
    return [_carried(state, weights, rule, back=back) for state in states]


def _hinged(rule: Rule, end: End) -> bool:
    """Say whether the end's rods begin with a hinge; at pinned and free ends most layouts have none."""
    return rule.stub == _HALF or end.holds_rotation


def _free(end: End) -> tuple[int, int]:
    """Return the indices of the state's two quantities that the end does not fix."""
    return 3 if end.holds_deflection else 0, 2 if end.holds_rotation else 1


def _held(end: End) -> tuple[int, int]:
    return 0 if end.holds_deflection else 3, 1 if end.holds_rotation else 2


def _unit_state(index: int) -> _State:
    y, slope, moment, shear = (_term(int(index == i)) for i in range(4))
    return y, slope, moment, shear


def _carried(state: _State, weights: Sequence[_Poly], rule: Rule, *, back: bool) -> _State:
    inertia = rule.rotary_inertia
    state = _across_rod(state, rule.stub, inertia)
    for weight in weights[:-1]:
        state = _across_rod(_across_hinge(state, weight), _ONE, inertia)
    state = _across_hinge(state, weights[-1] + _term(-_HALF))
    for _ in range(len(weights) - 1 + int(rule.stub) if back else 0):
        state = _across_hinge(state, _term(-_HALF))
        state = _across_hinge(_across_rod(state, -_ONE, inertia), _term(-_HALF))
    return state


# States of the four waves, each over a factor of its own:
#   in the hinge at x = 0:  cos 1,  sin 2 s t,  cosh 1,       sinh 2 s R;
#   in that at x = 1/2:     cos t,  sin s,      cosh R / √d,  sinh s / √d  (the common 1/√d is dropped),
# with t = cos(q/2) = √(1 - x) and R = √(1 + (1 - p) x), that is cosh(χ/2) = R / √d, R² = d + x.
_R2 = _term(1, d=1) + _term(1, x=1)
_T2 = _term(1) + _term(-1, x=1)
_AT_HINGE: dict[str, _State] = {
    "c": (_term(1), _term(0), _term(-4, x=1), _term(0)),
    "s": (_term(0), _term(1), _term(0), _term(-4, x=1, d=-1)),
    "C": (_term(1), _term(0), _term(4, x=1, d=-1), _term(0)),
    "S": (_term(0), _term(1, d=-1), _term(0), _term(4, x=1, d=-1)),
}
_AT_HALF: dict[str, _State] = {
    "c": (_term(1), _term(-2, x=1), _term(-4, x=1), _term(8, x=2, d=-1)),
    "s": (_term(1), _term(2) * _T2, _term(-4, x=1), _term(-8, x=1, d=-1) * _T2),
    "C": (_term(1), _term(2, x=1, d=-1), _term(4, x=1, d=-1), _term(8, x=2, d=-1)),
    "S": (_term(1), _term(2, d=-1) * _R2, _term(4, x=1, d=-1), _term(8, x=1, d=-1) * _R2),
}
#: Pairs of waves, in the order of `_minors` and of what is made from it.
PAIRS = tuple(combinations("csCS", 2))


def _minors(rule: Rule, end: End, *, back: bool) -> list[_Poly]:
    """Return |v₁ v₂ Wᵢ Wⱼ| for `PAIRS`, by Laplace's expansion along the first two columns."""
    waves = _AT_HALF if back and rule.stub == _HALF else _AT_HINGE
    first, second = _admitted(rule, end, back=back)
    minors = [_Poly() for _ in PAIRS]
    for a, b in combinations(range(4), 2):
        c, d = (row for row in range(4) if row not in (a, b))
        sign = _term(1 if (a + b) % 2 else -1)
        plane = sign * (first[a] * second[b] + _term(-1) * first[b] * second[a])
        for column, (i, j) in enumerate(PAIRS):
            across = waves[i][c] * waves[j][d] + _term(-1) * waves[i][d] * waves[j][c]
            minors[column] += plane * across
    return minors


def _expanded(minors: list[_Poly], p: Fraction) -> NDArray[Any]:
    """Multiply by the power of d that clears all denominators and write out d = 1 - p x."""
    keys = [key for minor in minors for key, value in minor.items() if value]
    lowest = min(d for _, d, _ in keys)
    degree = max(x + d - lowest for x, d, _ in keys)
    tables = np.full((len(minors), 1 + max(u for _, _, u in keys), degree + 1), Fraction(0), dtype=object)
    for column, minor in enumerate(minors):
        for (x, d, u), value in minor.items():
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


class Minors(NamedTuple):
    """The six determinants of an end, for waves cos, sin and decaying or growing exponentials."""

    cos_decaying: Any
    sin_decaying: Any
    cos_growing: Any
    sin_growing: Any
    cos_sin: Any
    decaying_growing: Any


@dataclass(frozen=True, eq=False)
class EndWaves:
    """One kind of end under one rule; `end_waves` makes and keeps them.

    Parameters
    ----------
    rule : Rule
    end : End
    """

    rule: Rule
    end: End

    @cached_property
    def p(self) -> Fraction:
        """1 - 4 × rotary inertia."""
        return 1 - 4 * self.rule.rotary_inertia

    @cached_property
    def half(self) -> bool:
        """True if `series` counts from the middle of a segment."""
        return self.rule.stub == _HALF

    @cached_property
    def reach(self) -> float:
        """Segments from the end to where `minors` is taken, the middle of the last corrected hinge."""
        corrected = max(len(self.rule.end_weights(self.end)), 1)
        return float(self.rule.stub) + corrected - 1.0 if _hinged(self.rule, self.end) else 0.0

    @cached_property
    def _at_end(self) -> NDArray[Any]:
        """Exact polynomials for `PAIRS` at the end, shape (pairs, powers of u, powers of x)."""
        return _expanded(_minors(self.rule, self.end, back=True), self.p)

    @cached_property
    def _coefficients(self) -> list[NDArray[np.float64]]:
        """Polynomials at `reach`, in floats: for each power of u a matrix, shape (pairs, powers of x).

        Not at the end itself: carried back there, a decaying wave has grown and drowns what is left of it.
        """
        tables = _expanded(_minors(self.rule, self.end, back=False), self.p)
        return list(np.moveaxis(tables.astype(np.float64), 1, 0))

    @cached_property
    def is_plain(self) -> bool:
        """True where the end reflects cos qj or sin qj exactly as it stands, at every q."""
        _, cos_cosh, cos_sinh, sin_cosh, sin_sinh, _ = (table.any() for table in self._at_end)
        return not (cos_cosh or cos_sinh) or not (sin_cosh or sin_sinh)

    def minors(self, s: Any, t: Any, u: Any) -> Minors:
        """Return the determinants at s = sin(q/2), t = cos(q/2), u = 1/N: floats, arrays or complex.

        Waves count from `reach`. A positive factor common to all six is left out.
        """
        x = s * s
        powers = powers_of(x, self._coefficients[0].shape[1])
        *lower, total = (matrix @ powers for matrix in self._coefficients)
        for row in lower[::-1]:
            total = total * u + row
        cs, cC, cS, sC, sS, CS = total
        sin, sinh = 2.0 * s * t, 2.0 * s * np.sqrt(1.0 + (1.0 - float(self.p)) * x)
        return Minors(
            cC - sinh * cS,
            sin * (sC - sinh * sS),
            cC + sinh * cS,
            sin * (sC + sinh * sS),
            sin * cs,
            2.0 * sinh * CS,
        )

    @cached_property
    def series(self) -> NDArray[Any]:
        """The six `Minors` at the end itself as series in s, exact, shape (6, powers of u, `SERIES_TERMS`).

        The lowest power of s is divided out: entry [:, 0, 0] holds the exact beam's six determinants.
        """
        factors = _factors(self.half, self.p)
        products = [_times(_in_s(table), f) for table, f in zip(self._at_end, factors, strict=True)]
        cs, cC, cS, sC, sS, CS = products
        six = np.array([cC - cS, sC - sS, cC + cS, sC + sS, cs, CS])
        first = int(np.flatnonzero(six[:2, 0].any(axis=0))[0])
        if six[:, :, :first].any() or six[:, 1:, first].any():
            raise ValueError("rule must approach the beam's end as N grows: its corrections outweigh the end")
        return six[:, :, first : first + SERIES_TERMS]

    @cached_property
    def beam(self) -> Minors:
        """The exact beam's determinants, scaled as `series` (and, up to a power of s, `minors`) is."""
        return Minors(*(float(value) for value in self.series[:, 0, 0]))


def powers_of(s: Any, terms: int) -> NDArray[np.float64]:
    """Return 1, s, s², ..., shape (terms, *s.shape)."""
    if np.ndim(s) == 0:
        return np.asarray(s ** np.arange(terms))
    powers = np.empty((terms, *s.shape), dtype=np.result_type(s))
    powers[0] = 1.0
    for k in range(1, terms):
        np.multiply(powers[k - 1], s, out=powers[k])
    return powers


#: Terms of a series in s. All of them converge for s < 1; at q = 0.8, s = 0.39, the last is below 1e-20.
SERIES_TERMS = 52
_LENGTH = SERIES_TERMS + 8


def binomial(slope: Fraction | int, exponent: Fraction) -> NDArray[Any]:
    """Return (1 + slope s²) ** exponent as a series in s, exact."""
    series = np.full(_LENGTH, Fraction(0), dtype=object)
    term = Fraction(1)
    for k in range(_LENGTH // 2):
        series[2 * k] = term
        term *= (exponent - k) / (k + 1) * slope
    return series


def _times(table: NDArray[Any], series: NDArray[Any]) -> NDArray[Any]:
    """Multiply series in s along the last axis; `table` is the short one."""
    product = np.full(np.broadcast_shapes(table.shape, series.shape), Fraction(0), dtype=object)
    for i in np.flatnonzero(table.reshape(-1, _LENGTH).any(axis=0)):
        product[..., i:] += table[..., i : i + 1] * series[: _LENGTH - i]
    return product


def _in_s(table: NDArray[Any]) -> NDArray[Any]:
    """Spread polynomials in x over even powers of s."""
    spread = np.full((*table.shape[:-1], _LENGTH), Fraction(0), dtype=object)
    spread[..., : 2 * table.shape[-1] : 2] = table
    return spread


@lru_cache(maxsize=64)
def _factors(half: bool, p: Fraction) -> list[NDArray[Any]]:
    """Return the waves' own factors at the end, multiplied for `PAIRS`, as series in s."""
    t, root = binomial(-1, _HALF), binomial(1 - p, _HALF)
    s, one = np.roll(binomial(0, _ONE), 1), binomial(0, _ONE)
    cos, sin, cosh, sinh = (t, s, root, s) if half else (one, 2 * _times(s, t), one, 2 * _times(s, root))
    pairs = ((cos, sin), (cos, cosh), (cos, sinh), (sin, cosh), (sin, sinh), (2 * cosh, sinh))
    return [_times(a, b) for a, b in pairs]


@lru_cache(maxsize=1024)
def end_waves(rule: Rule, end: End) -> EndWaves:
    """Return the waves of `end` under `rule`, derived once.

    Examples
    --------
    >>> from beammodes.ends import ENDS
    >>> from beammodes.rules import rule_named
    >>> end_waves(rule_named("double_wall"), ENDS["guided"]).is_plain      # a mirror
    True
    """
    return EndWaves(rule, end)


def characteristic_polynomial(rule: Rule, pair: Boundary, segments: int) -> list[Fraction]:
    """Return the coefficients, constant first, of a polynomial in ω² (units of EI/(ρA ell⁴)).

    Its roots are the elastic modes of the chain; the zero roots of rigid motions are divided out.

    Examples
    --------
    >>> from beammodes.rules import rule_named
    >>> characteristic_polynomial(rule_named("double_wall"), Boundary.of("clamped-free"), 1)   # 1 - ω²/6
    [Fraction(1, 1), Fraction(-1, 6)]
    """
    lengths, weights = rule.piece_lengths(pair, segments), rule.hinge_weights(pair, segments)
    first, second = (_unit_state(index) for index in _free(pair.left))
    for length, weight in zip(lengths, [*weights, Fraction(0)], strict=True):
        first, second = (
            _across_hinge(_across_rod(state, length, rule.rotary_inertia), _term(weight))
            for state in (first, second)
        )
    a, b = _held(pair.right)
    determinant = first[a] * second[b] + _term(-1) * first[b] * second[a]
    # ω² = 16 x²/d is the only way in which x and d enter.
    degree = max(x // 2 for x, _, _ in determinant)
    by_power = [determinant.get((2 * k, -k, 0), Fraction(0)) / 16**k for k in range(degree + 1)]
    while by_power and not by_power[-1]:
        by_power.pop()
    return by_power[next(k for k, value in enumerate(by_power) if value) :]
