"""The four waves of a uniform chain and their reflection by each kind of end, in exact algebra.

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
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Rule
from beammodes.closed_form.exact_states import ExactState, Poly, admitted, expanded, is_hinged, term
from beammodes.closed_form.power_series import (
    SERIES_TERMS,
    SeriesTable,
    binomial,
    in_powers_of_s,
    integral,
    powers_of,
    product,
    quotient,
)
from beammodes.numerics.arrays import Floats, elementary
from beammodes.problem.ends import End

__all__ = [
    "PAIRS",
    "SHORT",
    "EndWaves",
    "Minors",
    "Parts",
    "Swing",
    "amplitude",
    "end_table",
    "end_waves",
    "exchange",
    "inside",
    "parts",
    "phase",
    "swing",
]


_HALF, _ONE = Fraction(1, 2), Fraction(1)
#: Shorter chains are cheap in exact arithmetic.
SHORT = 8

# States of the four waves, each over a factor of its own:
#   in the hinge at x = 0:  cos 1,  sin 2 s t,  cosh 1,       sinh 2 s R;
#   in that at x = 1/2:     cos t,  sin s,      cosh R / √d,  sinh s / √d  (the common 1/√d is dropped),
# with t = cos(q/2) = √(1 - x) and R = √(1 + (1 - p) x), that is cosh(χ/2) = R / √d, R² = d + x.
_R2 = term(1, d=1) + term(1, x=1)


_T2 = term(1) + term(-1, x=1)


_AT_HINGE: dict[str, ExactState] = {
    "c": (term(1), term(0), term(-4, x=1), term(0)),
    "s": (term(0), term(1), term(0), term(-4, x=1, d=-1)),
    "C": (term(1), term(0), term(4, x=1, d=-1), term(0)),
    "S": (term(0), term(1, d=-1), term(0), term(4, x=1, d=-1)),
}


_AT_HALF: dict[str, ExactState] = {
    "c": (term(1), term(-2, x=1), term(-4, x=1), term(8, x=2, d=-1)),
    "s": (term(1), term(2) * _T2, term(-4, x=1), term(-8, x=1, d=-1) * _T2),
    "C": (term(1), term(2, x=1, d=-1), term(4, x=1, d=-1), term(8, x=2, d=-1)),
    "S": (term(1), term(2, d=-1) * _R2, term(4, x=1, d=-1), term(8, x=1, d=-1) * _R2),
}


#: Pairs of waves, in the order of `_minors` and of what is made from it.
PAIRS = tuple(combinations("csCS", 2))


def _minors(rule: Rule, end: End, *, back: bool) -> list[Poly]:
    """Return |v₁ v₂ Wᵢ Wⱼ| for `PAIRS`, by Laplace's expansion along the first two columns."""
    waves = _AT_HALF if back and rule.stub == _HALF else _AT_HINGE
    first, second = admitted(rule, end, back=back)
    minors = [Poly() for _ in PAIRS]
    for a, b in combinations(range(4), 2):
        c, d = (row for row in range(4) if row not in (a, b))
        sign = term(1 if (a + b) % 2 else -1)
        plane = sign * (first[a] * second[b] + term(-1) * first[b] * second[a])
        for column, (i, j) in enumerate(PAIRS):
            across = waves[i][c] * waves[j][d] + term(-1) * waves[i][d] * waves[j][c]
            minors[column] += plane * across
    return minors


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
        """True if `power_series` counts from the middle of a segment."""
        return self.rule.stub == _HALF

    @cached_property
    def reach(self) -> float:
        """Segments from the end to where `minors` is taken, the middle of the last corrected hinge."""
        corrected = max(len(self.rule.end_weights(self.end)), 1)
        return float(self.rule.stub) + corrected - 1.0 if is_hinged(self.rule, self.end) else 0.0

    @cached_property
    def _at_end(self) -> NDArray[Any]:
        """Exact polynomials for `PAIRS` at the end, shape (pairs, powers of u, powers of x)."""
        return expanded(_minors(self.rule, self.end, back=True), self.p)

    @cached_property
    def _coefficients(self) -> list[Floats]:
        """Polynomials at `reach`, in floats: for each power of u a matrix, shape (pairs, powers of x).

        Not at the end itself: carried back there, a decaying wave has grown and drowns what is left of it.
        """
        tables = expanded(_minors(self.rule, self.end, back=False), self.p)
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
        products = [product(in_powers_of_s(table), f) for table, f in zip(self._at_end, factors, strict=True)]
        cs, cC, cS, sC, sS, CS = products
        six = np.array([cC - cS, sC - sS, cC + cS, sC + sS, cs, CS])
        first = int(np.flatnonzero(six[:2, 0].any(axis=0))[0])
        if six[:, :, :first].any() or six[:, 1:, first].any():
            raise ValueError("rule must approach the beam's end as N grows: its corrections outweigh the end")
        return six[:, :, first : first + SERIES_TERMS]

    @cached_property
    def beam(self) -> Minors:
        """The exact beam's determinants, scaled as `power_series` (and, up to a power of s, `minors`) is."""
        return Minors(*(float(value) for value in self.series[:, 0, 0]))


@lru_cache(maxsize=64)
def _factors(half: bool, p: Fraction) -> list[NDArray[Any]]:
    """Return the waves' own factors at the end, multiplied for `PAIRS`, as series in s."""
    t, root = binomial(-1, _HALF), binomial(1 - p, _HALF)
    s, one = np.roll(binomial(0, _ONE), 1), binomial(0, _ONE)
    cos, sin, cosh, sinh = (t, s, root, s) if half else (one, 2 * product(s, t), one, 2 * product(s, root))
    pairs = ((cos, sin), (cos, cosh), (cos, sinh), (sin, cosh), (sin, sinh), (2 * cosh, sinh))
    return [product(a, b) for a, b in pairs]


@lru_cache(maxsize=1024)
def end_waves(rule: Rule, end: End) -> EndWaves:
    """Return the waves of `end` under `rule`, kept for the next call.

    Examples
    --------
    >>> from beammodes.problem.ends import ENDS
    >>> from beammodes.chains.rules import rule_named
    >>> end_waves(rule_named("double_wall"), ENDS["guided"]).is_plain      # a mirror
    True
    """
    return EndWaves(rule, end)


def amplitude(end: Minors) -> Any:
    """Return the length of an end's two decaying determinants."""
    return np.hypot(end.cos_decaying, end.sin_decaying)


def phase(end: EndWaves, minors: Minors, q: Any, middle: float = 0.0) -> Any:
    """Return the phase at which an end reflects a wave, less the beam's, within π of `middle`."""
    c, s = minors.cos_decaying, minors.sin_decaying
    c0, s0 = end.beam.cos_decaying, end.beam.sin_decaying
    num, den = c * s0 - s * c0, s * s0 + c * c0
    # The determinants were taken at `reach`, where the wave is q reach ahead.
    ahead = middle + q * end.reach
    cos, sin = np.cos(ahead), np.sin(ahead)
    return middle + np.arctan2(num * cos - den * sin, den * cos + num * sin)


def exchange(kappa: Any, decay: Any, left: Minors, right: Minors) -> Any:
    """Return X of the equation at the head of `chain_frequencies`; E = e^(-decay).

    It is Laplace's expansion, by the left end's two rows, of the determinant

        amplitudes of     cos qj        sin qj      e^(-χj)     e^(-χ(N-j))
        left end       [  cos           sin         decaying    E growing   ]   2 rows
        right end      [  cos and sin turned by κ   E growing   decaying    ]   2 rows

    whose terms without E make up sin(κ + Φ) times the two ends' amplitudes, here divided out. Places other
    than the ends serve as well: then κ, E and the determinants are those of the chain between them.
    """
    c, s, c2, s2 = left.cos_growing, left.sin_growing, right.cos_growing, right.sin_growing
    far = np.sin(kappa) * (s * s2 - c * c2) + np.cos(kappa) * (c * s2 + s * c2)
    near = left.cos_sin * right.decaying_growing + left.decaying_growing * right.cos_sin
    fade = np.exp(-decay)
    return fade * (fade * far + near) / (amplitude(left) * amplitude(right))


class Swing(NamedTuple):
    """Middle of the range of an end's phase, less the beam's, and its steepest fall -dΦ/dq.

    The fall is infinite where an end turns waves by nearly a whole turn or more.
    """

    middle: float
    descent: float


@lru_cache(maxsize=1024)
def swing(end: EndWaves) -> Swing:
    """Return the swing of an end's phase, measured on a grid over the band in long and short chains."""
    q = np.linspace(1e-3, 3.1, 800)
    low = high = descent = 0.0
    for u in np.linspace(0.0, 1.0 - 1e-6, 5) * _largest_u(end):
        minors = end.minors(np.sin(0.5 * q), np.cos(0.5 * q), float(u))
        curve = np.unwrap(phase(end, minors, q))
        low, high = min(low, float(curve.min())), max(high, float(curve.max()))
        descent = max(descent, -float(np.diff(curve).min()) / (q[1] - q[0]))
    if high - low > 6.0:
        # Which phase belongs to which mode is then not known.
        return Swing(0.0, math.inf)
    # A mode about to leave the band may still turn the phase by -π between q = 3.1 and π.
    within = max(high, -low) < 0.85 * math.pi
    return Swing(0.0 if within else 0.5 * (low + high), descent)


def _largest_u(end: EndWaves) -> float:
    """Return the largest 1/N of interest: of chains not too short, and with positive springs."""
    falling = [w for w in end.rule.end_weights(end.end) if w.per_segment < 0 < w.constant]
    return min([1.0 / SHORT, *(float(-w.constant / w.per_segment) for w in falling)])


class Parts(NamedTuple):
    """An end's determinants over the length of its own (cos, sin) pair, less the beam's."""

    turn: Any  # Φ - Φ⁰
    growing: Any  # of the pair for the growing exponential, complex, over the beam's
    cos_sin: Any  # of the determinant of cos and sin, exponentials scaled as `end_table` says


def parts(end: EndWaves, rows: Any, u: Any) -> Parts:
    """Return how an end reflects waves less how the beam's does, to full relative accuracy.

    `rows` are the sums of `end_table`.
    """
    num, den, den2, num2, cos_sin = rows[-5:]
    for first in range(len(rows) - 10, -1, -5):
        row = rows[first : first + 5]
        num, den, den2 = num * u + row[0], den * u + row[1], den2 * u + row[2]
        num2, cos_sin = num2 * u + row[3], cos_sin * u + row[4]
    functions = elementary(num)
    length = functions.hypot(num, den)
    shorter = -num * num / (length * (length + den))  # den/length - 1
    return Parts(
        functions.arctan2(num, den),
        (den2 + 1j * num2) / length + shorter,
        cos_sin / length + end.beam.cos_sin * shorter,
    )


@lru_cache(maxsize=1024)
def end_table(end: EndWaves) -> SeriesTable:
    """Return the rows num, den, den₊ - den, num₊, f cs - cs⁰ den, for each power of u in turn.

    den + i num is the pair (sin, cos) of the decaying exponential over the beam's, den₊ + i num₊ that of
    the growing one. An end that does no work has cs and the determinant of the two exponentials in one
    ratio f², whatever the end: f² = R/(d t) over the beam's, with R, d and t as in `waves`, and R/t where
    its half-stub waves have dropped √d. So one of the two is enough, and with the exponentials scaled by f
    none of these rows is larger than the end's own error.
    """
    c, s, c2, s2, cos_sin, _ = end.series
    c0, s0, c20, s20, cos_sin0, _ = end.series[:, 0, 0]
    size = c0 * c0 + s0 * s0
    num, den = (c * s0 - s * c0) / size, (c * c0 + s * s0) / size
    num2, den2 = (c2 * s20 - s2 * c20) / size, (c2 * c20 + s2 * s20) / size
    quarter, p = Fraction(1, 4), end.p
    scale = product(binomial(1 - p, quarter), binomial(-1, -quarter))
    if not end.half:
        scale = product(scale, binomial(-p, -2 * quarter))
    scaled = product(cos_sin, scale)
    rows = np.array([num, den, den2 - den, num2, scaled - cos_sin0 * den])
    return SeriesTable.of(np.concatenate([rows[:, u] for u in range(c.shape[0])]))


@lru_cache(maxsize=1024)
def inside(end: EndWaves) -> SeriesTable:
    """Return `_inside_table`; an end is looked up faster than a fraction."""
    return _inside_table(end.p)


@lru_cache(maxsize=64)
def _inside_table(p: Fraction) -> SeriesTable:
    """Return the rows ω/q² - 1 and χ/q - 1.

    q = 2 ∫ ds/√(1 - s²), χ = 2 ∫ ds/((1 - p s²) √(1 + (1 - p) s²)), ω = 4 s²/√(1 - p s²).
    """
    minus_half, minus_one = Fraction(-1, 2), Fraction(-1)
    q_over_2s = integral(binomial(-1, minus_half))
    chi_over_2s = integral(product(binomial(-p, minus_one), binomial(1 - p, minus_half)))
    one = binomial(0, minus_one)
    omega = quotient(quotient(binomial(-p, minus_half), q_over_2s), q_over_2s) - one
    return SeriesTable.of(np.array([omega, quotient(chi_over_2s, q_over_2s) - one])[:, :SERIES_TERMS])
