"""The discretization error of uniform chains, kept to full relative accuracy however small it is.

e = ω_chain/ω_beam - 1 reaches 1e-38 at N = 10⁹, where two rounded frequencies agree in every digit. So no
difference of frequencies is formed. With κ = qN = β + δ, and ω = q² (1 + g) N² inside the chain,

    e = (1 + g(q)) (1 + δ/β)² - 1,

where δ solves the difference of two equations, the chain's at κ less the beam's at β (see `dispersion`):

    δ + Φ(q) - Φ⁰ = ± [arcsin X - arcsin X⁰],

X being the ends' exchange of exponentials. Everything small in it is computed as such: g, Φ - Φ⁰ and what
makes X differ from X⁰ are power series in s = sin(q/2) whose coefficients are exact rational numbers (for
weights that depend on N, polynomials in 1/N of such series). What cancels between a rule's corrections has
cancelled there before any rounding: e of `gregory` starts with q⁴ because its lower coefficients are zero.

The series serve q ≤ 1/2. Beyond (modes above about N/6) and in chains of fewer than 8 segments, e is so
large that a difference of frequencies, which are right to a few units in the last place, is within 1e-14.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.dispersion import (
    MAX_MODE,
    MAX_SEGMENTS,
    Boundaries,
    Floats,
    Rules,
    UniformChains,
    amplitude,
    looked_up,
    wavenumbers,
)
from beammodes.exact_beam import wavenumber_of_code
from beammodes.waves import SERIES_TERMS, EndWaves, binomial, powers_of

__all__ = ["MAX_MODE", "MAX_SEGMENTS", "relative_error"]

# Largest β/N for which the series are used; δ takes q at most to 0.8.
_LARGEST_Q = 0.5
# From the next mode on E < 1e-15, as χ > 0.97 q here: what reaches the other end is not felt.
_LAST_EXCHANGING = 11
# Longest chain whose modes are listed at the first single lookup beyond the series.
_LISTED = 100


def relative_error(
    boundary: Boundaries, segments: ArrayLike, mode: ArrayLike, rule: Rules = "mitiguy"
) -> float | Floats:
    """Return the relative frequency error of an elastic mode of a uniform chain.

    e = ω_chain / ω_beam - 1, to a relative accuracy of 1e-12 for modes up to N/10 and N = 1 to 10⁹, measured
    against the largest of its parts: next to an N where e changes sign, and for higher modes, it is within
    1e-14.

    Parameters
    ----------
    boundary : str, Boundary, or array of them
        The two ends, in either order.
    segments : int or array of int
        N, 1 to 10⁹.
    mode : int or array of int
        Elastic modes, from 1.
    rule : str, Rule, or array of them

    Returns
    -------
    float, or array of the broadcast shape [-]
        NaN where the chain has no such mode or a spring would not be positive.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or shapes do not match.

    Source
    ------
    Derived here: the head of this module, `dispersion` and `waves`.

    Examples
    --------
    >>> round(relative_error("clamped-free", 10, 1), 9)
    -0.001259107
    >>> relative_error("clamped-free", 10**9, 1)                        # doctest: +ELLIPSIS
    -1.25501...e-19
    """
    return looked_up(_errors, boundary, segments, mode, rule)


def _errors(chains: UniformChains, segments: Any, mode: Any) -> Any:
    """Return e of modes that exist."""
    if isinstance(segments, float):
        root = np.float64(wavenumber_of_code(chains.code, int(mode)))
        if root <= _LARGEST_Q * segments and segments >= chains.shortest:
            return _by_series(chains, root, segments, mode, mode <= _LAST_EXCHANGING)
        if segments <= _LISTED:
            return _listed(chains, int(segments))[int(mode) - 1]
        return chains.frequency(segments, mode) / root / root - 1.0
    error = np.empty_like(segments)
    beta = wavenumbers(chains.code, mode)
    series = (beta <= _LARGEST_Q * segments) & (segments >= chains.shortest)
    low = mode <= _LAST_EXCHANGING
    for chosen, exchanging in ((series & low, True), (series & ~low, False)):
        if chosen.any():
            error[chosen] = _by_series(chains, beta[chosen], segments[chosen], mode[chosen], exchanging)
    rest = ~series
    if rest.any():
        n, b = segments[rest], beta[rest]
        error[rest] = chains.frequency(n, mode[rest]) / b / b - 1.0
    return error


@lru_cache(maxsize=4096)
def _listed(chains: UniformChains, segments: int) -> Floats:
    """Return e of every mode of a short chain, so that repeated single lookups need not solve again."""
    mode = np.arange(1.0, segments + chains.surplus + 1.0)
    return np.asarray(_errors(chains, np.full_like(mode, segments), mode))


def _by_series(chains: UniformChains, beta: Any, segments: Any, mode: Any, exchanging: bool) -> Any:
    delta = _Difference(chains, beta, segments, mode, exchanging).root()
    powers = _powers(np.sin(0.5 * (beta + delta) / segments))
    excess = _inside(chains.left).at(powers)[0]
    part = delta / beta
    return excess + (1.0 + excess) * part * (2.0 + part)


class _Table(NamedTuple):
    """Power series in s: coefficients (rows, terms) from each row's leading power on, and those powers."""

    coefficients: Floats
    leading: NDArray[np.intp]
    most: int

    @classmethod
    def of(cls, rows: NDArray[Any]) -> _Table:
        """Round exact series, shape (rows, terms), to floats."""
        leading = np.array([next((k for k, c in enumerate(row) if c), 0) for row in rows], dtype=np.intp)
        shifted = [[*row[k:], *[Fraction(0)] * k] for row, k in zip(rows, leading, strict=True)]
        return cls(np.array(shifted, dtype=np.float64), leading, int(leading.max()))

    def at(self, powers: Floats) -> Any:
        """Return the sums of all rows, given 1, s, s², ..."""
        terms = len(powers) - self.most
        return (self.coefficients[:, :terms] @ powers[:terms]) * powers[self.leading]


def _powers(s: Any) -> Floats:
    """Return as many powers of s as series of radius 1 need, with a wide margin for large coefficients."""
    largest = float(s if np.ndim(s) == 0 else s.max())
    needed = SERIES_TERMS if largest > 0.3 else 12 + int(44.0 / -math.log(largest))
    return powers_of(s, min(needed, SERIES_TERMS))


class _Parts(NamedTuple):
    """An end's determinants over the length of its own (cos, sin) pair, less the beam's."""

    turn: Any  # Φ - Φ⁰
    growing: Any  # of the pair for the growing exponential, complex, over the beam's
    cos_sin: Any  # of the determinant of cos and sin, exponentials scaled as `_end_table` says


@lru_cache(maxsize=1024)
def _end_table(end: EndWaves) -> _Table:
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
    scale = _product(binomial(1 - p, quarter), binomial(-1, -quarter))
    if not end.half:
        scale = _product(scale, binomial(-p, -2 * quarter))
    scaled = np.array([_product(row, scale[: len(row)]) for row in cos_sin])
    rows = np.array([num, den, den2 - den, num2, scaled - cos_sin0 * den])
    return _Table.of(np.concatenate([rows[:, u] for u in range(c.shape[0])]))


@lru_cache(maxsize=1024)
def _inside(end: EndWaves) -> _Table:
    """Return `_inside_table`; an end is looked up faster than a fraction."""
    return _inside_table(end.p)


@lru_cache(maxsize=64)
def _inside_table(p: Fraction) -> _Table:
    """Return the rows ω/q² - 1 and χ/q - 1.

    q = 2 ∫ ds/√(1 - s²), χ = 2 ∫ ds/((1 - p s²) √(1 + (1 - p) s²)), ω = 4 s²/√(1 - p s²).
    """
    minus_half, minus_one = Fraction(-1, 2), Fraction(-1)
    q_over_2s = _integral(binomial(-1, minus_half))
    chi_over_2s = _integral(_product(binomial(-p, minus_one), binomial(1 - p, minus_half)))
    one = binomial(0, minus_one)
    omega = _quotient(_quotient(binomial(-p, minus_half), q_over_2s), q_over_2s) - one
    return _Table.of(np.array([omega, _quotient(chi_over_2s, q_over_2s) - one])[:, :SERIES_TERMS])


def _integral(series: NDArray[Any]) -> NDArray[Any]:
    """Return (1/s) ∫ series ds."""
    return np.array([c / (k + 1) for k, c in enumerate(series)], dtype=object)


def _product(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    product = np.full(len(a), Fraction(0), dtype=object)
    for k in np.flatnonzero(a):
        product[k:] += a[k] * b[: len(b) - k]
    return product


def _quotient(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Return a/b for b that starts with 1."""
    quotient = a.copy()
    for k in range(1, len(a)):
        quotient[k] -= (b[1 : k + 1] * quotient[:k][::-1]).sum()
    return quotient


def _parts(end: EndWaves, powers: Floats, u: Any) -> _Parts:
    """Return what an end does to waves beyond what the beam's does, to full relative accuracy."""
    rows = _end_table(end).at(powers)
    total = rows[-5:]
    for first in range(len(rows) - 10, -1, -5):
        total = total * u + rows[first : first + 5]
    num, den, den2, num2, cos_sin = total
    length = np.hypot(num, den)
    shorter = -num * num / (length * (length + den))  # den/length - 1
    return _Parts(
        np.arctan2(num, den),
        (den2 + 1j * num2) / length + shorter,
        cos_sin / length + end.beam.cos_sin * shorter,
    )


@dataclass(frozen=True, eq=False)
class _Difference:
    """The equation for δ, of a block of modes or of a single one: the chain's less the beam's."""

    chains: UniformChains
    beta: Any
    segments: Any
    mode: Any
    exchanging: bool

    def root(self) -> Any:
        """Return δ by secants, the first of slope 1: 3 steps for small q, at most 7 for q = 1/2."""
        old = 0.0 * self.beta
        if self.chains.is_plain:
            return old
        value = self.excess(old)
        new, before = -value, value
        for _ in range(15):
            value = self.excess(new)
            rise, run = value - before, new - old
            step = -value * run / (rise + (rise == 0.0))
            old, before, new = new, value, new + step
            # Secants multiply errors: this step's error is about its square over the step before.
            if np.all(step * step <= 1e-15 * np.abs(run * new)):
                break
        return new

    def excess(self, delta: Any) -> Any:
        """Return δ + Φ - Φ⁰ ∓ (arcsin X - arcsin X⁰)."""
        powers = _powers(np.sin(0.5 * (self.beta + delta) / self.segments))
        chains, u = self.chains, 1.0 / self.segments
        left = _parts(chains.left, powers, u)
        right = left if chains.right is chains.left else _parts(chains.right, powers, u)
        total = delta + left.turn + right.turn
        if not self.exchanging:
            return total
        beam, change = self._exchange(delta, powers, left, right)
        sign = 1.0 - 2.0 * ((self.mode + chains.lead) % 2.0)
        return total - sign * _arcsin_change(beam, change)

    def _exchange(self, delta: Any, powers: Floats, left: _Parts, right: _Parts) -> tuple[Any, Any]:
        """Return X⁰ and X - X⁰, X = E² Im(e^(iκ) z₊ z₊') + E (cs dg' + dg cs'), as `dispersion.exchange`."""
        a, b = self.chains.left.beam, self.chains.right.beam
        # dg = 2 cs for the beam's ends, and for the chain's as scaled: cs dg' + dg cs' = 4 cs cs'.
        scale = 4.0 / (amplitude(a) * amplitude(b))
        near = scale * a.cos_sin * b.cos_sin
        near_change = scale * (a.cos_sin * right.cos_sin + left.cos_sin * (b.cos_sin + right.cos_sin))
        angle = self.beta + sum(math.atan2(beam.cos_growing, beam.sin_growing) for beam in (a, b))
        sin, cos = np.sin(angle), np.cos(angle)
        turned = -2.0 * np.sin(0.5 * delta) ** 2 + 1j * np.sin(delta)  # e^(iδ) - 1
        grown = left.growing + right.growing + left.growing * right.growing
        turned = turned + grown + turned * grown
        far_change = sin * turned.real + cos * turned.imag
        beam_fade = np.exp(-self.beta)
        slower = _inside(self.chains.left).at(powers)[1]
        fade_change = beam_fade * np.expm1(-(delta + (self.beta + delta) * slower))
        fade = beam_fade + fade_change
        change = fade * fade * far_change + fade * near_change
        change = change + fade_change * ((fade + beam_fade) * sin + near)
        return beam_fade * (beam_fade * sin + near), change


def _arcsin_change(x: Any, change: Any) -> Any:
    """Return arcsin(x + change) - arcsin x, by the addition theorem."""
    end = x + change
    here, there = np.sqrt(1.0 - x * x), np.sqrt(1.0 - end * end)
    return np.arcsin(change * (here + x * (end + x) / (here + there)))
