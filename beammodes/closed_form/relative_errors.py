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
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.closed_form.chain_frequencies import frequencies
from beammodes.closed_form.power_series import enough_powers
from beammodes.closed_form.uniform_chains import Boundaries, Rules, UniformChains, looked_up
from beammodes.closed_form.waves import Parts, amplitude, inside, parts
from beammodes.exact.exact_beam import wavenumber_of_code
from beammodes.numerics.arrays import Floats

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
        root = np.float64(wavenumber_of_code(chains.code, int(mode)))
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
    delta = _Difference(chains, beta, segments, mode, exchanging).root()
    powers = enough_powers(np.sin(0.5 * (beta + delta) / segments))
    excess = inside(chains.left).at(powers)[0]
    part = delta / beta
    return excess + (1.0 + excess) * part * (2.0 + part)


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
        powers = enough_powers(np.sin(0.5 * (self.beta + delta) / self.segments))
        chains, u = self.chains, 1.0 / self.segments
        left = parts(chains.left, powers, u)
        right = left if chains.right is chains.left else parts(chains.right, powers, u)
        total = delta + left.turn + right.turn
        if not self.exchanging:
            return total
        beam, change = self._exchange(delta, powers, left, right)
        sign = 1.0 - 2.0 * ((self.mode + chains.lead) % 2.0)
        return total - sign * _arcsin_change(beam, change)

    def _exchange(self, delta: Any, powers: Floats, left: Parts, right: Parts) -> tuple[Any, Any]:
        """Return X⁰ and X - X⁰, X = E² Im(e^(iκ) z₊ z₊') + E (cs dg' + dg cs'), as `waves.exchange`."""
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
        slower = inside(self.chains.left).at(powers)[1]
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
