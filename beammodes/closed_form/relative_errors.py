"""The discretization error of uniform chains, kept to full relative accuracy however small it is.

e = ω_chain/ω_beam - 1 reaches 1e-38 at N = 10⁹, where two rounded frequencies agree in every digit. So no
difference of frequencies is formed. With κ = qN = β + δ, and ω = q² (1 + g) N² inside the chain,

    e = (1 + g(q)) (1 + δ/β)² - 1,

where δ solves the difference of two equations, the chain's at κ less the beam's at β:

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
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beammodes.closed_form.chain_frequencies import frequencies
from beammodes.closed_form.power_series import SeriesTable, enough_powers
from beammodes.closed_form.uniform_chains import Boundaries, Rules, UniformChains, looked_up
from beammodes.closed_form.waves import Parts, amplitude, end_table, inside, parts
from beammodes.exact.exact_beam import wavenumber_of_code
from beammodes.numerics.arrays import Floats, elementary
from beammodes.numerics.roots import secants

__all__ = ["relative_error"]

# Largest β/N for which the series are used; δ takes q at most to 0.8.
_LARGEST_Q = 0.5

# From the next mode on E < 1e-15, as χ > 0.97 q here: what reaches the other end is not felt.
_LAST_EXCHANGING = 11

# Longest chain whose modes are listed at the first single lookup beyond the series.
_LISTED = 100


def relative_error(
    boundary: Boundaries, segments: ArrayLike, mode: ArrayLike, rule: Rules = "mitiguy"
) -> float | Floats:
    """Return the relative frequency error e = ω_chain / ω_beam - 1 of an elastic mode of a uniform chain.

    Arguments are those of `chain_frequency`, arrays too. Right to 1e-12 for modes up to N/10 and N = 1 to
    10⁹, measured against the largest of its parts: next to an N where e changes sign, and for higher
    modes, it is within 1e-14. NaN where the chain has no such mode or a spring would not be positive.

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
        root = wavenumber_of_code(chains.code, int(mode))
        if root <= _LARGEST_Q * segments and segments >= chains.shortest:
            return _by_series(chains, root, segments, mode, mode <= _LAST_EXCHANGING)
        if segments <= _LISTED:
            return _listed(chains, int(segments))[int(mode) - 1]
        return frequencies(chains, segments, mode) / root / root - 1.0
    error = np.empty_like(segments)
    beta = chains.wavenumbers(mode)
    series = (beta <= _LARGEST_Q * segments) & (segments >= chains.shortest)
    low = mode <= _LAST_EXCHANGING
    for chosen, exchanging in ((series & low, True), (series & ~low, False)):
        if chosen.any():
            error[chosen] = _by_series(chains, beta[chosen], segments[chosen], mode[chosen], exchanging)
    rest = ~series
    if rest.any():
        n, b = segments[rest], beta[rest]
        error[rest] = frequencies(chains, n, mode[rest]) / b / b - 1.0
    return error


@lru_cache(maxsize=4096)
def _listed(chains: UniformChains, segments: int) -> Floats:
    """Return e of every mode of a short chain, so that repeated single lookups need not solve again."""
    mode = np.arange(1.0, segments + chains.surplus + 1.0)
    return np.asarray(_errors(chains, np.full_like(mode, segments), mode))


def _by_series(chains: UniformChains, beta: Any, segments: Any, mode: Any, exchanging: bool) -> Any:
    """Return e of modes whose equation's series converge: arrays, or single floats."""
    delta = 0.0 * beta
    if not chains.is_plain:
        delta = _shift(chains, beta, segments, _Exchange(chains, beta, mode) if exchanging else None)
    powers = enough_powers(elementary(beta).sin(0.5 * (beta + delta) / segments))
    excess = inside(chains.left).at(powers)[0]
    part = delta / beta
    return excess + (1.0 + excess) * part * (2.0 + part)


def _shift(chains: UniformChains, beta: Any, segments: Any, exchange: _Exchange | None) -> Any:
    """Return δ, the root of the chain's equation less the beam's:  δ + Φ - Φ⁰ ∓ (arcsin X - arcsin X⁰).

    By secants, the first with the slope that the beam's equation has at β: 2 steps where δ is small, at most
    6 for q = 1/2.
    """
    table, u, sin = _chain_table(chains), 1.0 / segments, elementary(beta).sin
    left_rows = slice(2, 2 + len(end_table(chains.left).coefficients))
    mirrored = chains.right is chains.left

    def excess(delta: Any) -> Any:
        rows = table.at(enough_powers(sin(0.5 * (beta + delta) * u)))
        left = parts(chains.left, rows[left_rows], u)
        right = left if mirrored else parts(chains.right, rows[left_rows.stop :], u)
        total = delta + left.turn + right.turn
        return total if exchange is None else total - exchange.change(delta, rows[1], left, right)

    none = 0.0 * beta
    value = excess(none)
    return secants(excess, none, value, -value if exchange is None else -value / exchange.slope, most=15)


@lru_cache(maxsize=1024)
def _chain_table(chains: UniformChains) -> SeriesTable:
    """Return the rows of `inside`, of the left end and, unless it is the same, of the right end."""
    ends = [chains.left] if chains.left is chains.right else [chains.left, chains.right]
    return inside(chains.left).above(*map(end_table, ends))


class _BeamEnds(NamedTuple):
    """What two ends of the beam make of each other's exponentials: X⁰ = E (E sin(β + angle) + near)."""

    angle: float
    near: float
    scale: float
    left: float
    right: float


@lru_cache(maxsize=1024)
def _beam_ends(chains: UniformChains) -> _BeamEnds:
    a, b = chains.left.beam, chains.right.beam
    angle = sum(math.atan2(beam.cos_growing, beam.sin_growing) for beam in (a, b))
    # dg = 2 cs for the beam's ends, and for the chain's as scaled: cs dg' + dg cs' = 4 cs cs'.
    scale = 4.0 / float(amplitude(a) * amplitude(b))
    return _BeamEnds(angle, scale * a.cos_sin * b.cos_sin, scale, a.cos_sin, b.cos_sin)


class _Exchange:
    """The ends' exchange of exponentials, ± arcsin X, of modes: X as in `waves.exchange`."""

    def __init__(self, chains: UniformChains, beta: Any, mode: Any) -> None:
        self._beta, self._functions, self._ends = beta, elementary(beta), _beam_ends(chains)
        angle = beta + self._ends.angle
        self._sin, self._cos = self._functions.sin(angle), self._functions.cos(angle)
        self._fade = self._functions.exp(-beta)
        self._across = self._fade * (self._fade * self._sin + self._ends.near)
        self._cosine = self._functions.sqrt(1.0 - self._across * self._across)
        self._sign = 1.0 - 2.0 * ((mode + chains.lead) % 2.0)

    @property
    def slope(self) -> Any:
        """The derivative of  β + Φ⁰ ∓ arcsin X⁰  by β."""
        far = self._fade * (self._cos - 2.0 * self._sin)
        return 1.0 - self._sign * self._fade * (far - self._ends.near) / self._cosine

    def change(self, delta: Any, slower: Any, left: Parts, right: Parts) -> Any:
        """Return ± (arcsin X - arcsin X⁰), X = E² Im(e^(iκ) z₊ z₊') + E (cs dg' + dg cs')."""
        f, beam, beta = self._functions, self._ends, self._beta
        near_change = beam.scale * (beam.left * right.cos_sin + left.cos_sin * (beam.right + right.cos_sin))
        half = f.sin(0.5 * delta)
        turned = -2.0 * half * half + 1j * f.sin(delta)  # e^(iδ) - 1
        grown = left.growing + right.growing + left.growing * right.growing
        turned = turned + grown + turned * grown
        far_change = self._sin * turned.real + self._cos * turned.imag
        fade_change = self._fade * f.expm1(-(delta + (beta + delta) * slower))
        fade = self._fade + fade_change
        change = fade * fade * far_change + fade * near_change
        change = change + fade_change * ((fade + self._fade) * self._sin + beam.near)
        # arcsin of X less that of X⁰, by the addition theorem.
        across, end = self._across, self._across + change
        there = f.sqrt(1.0 - end * end)
        turn = change * (self._cosine + across * (end + across) / (self._cosine + there))
        return self._sign * f.arcsin(turn)
