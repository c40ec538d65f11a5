"""One error at a time of a uniform chain that twists or stretches between fixed and free ends, in floats.

At a fixed end nothing is left of what `axial_chains` solves for but one angle, of M's second column,

    tan(φ - φ⁰) = -2 sin(q/2) M₁₂ / (cos(q/2) M₂₂)    hinge at the wall,    -sin q M₁₂ / M₂₂    half a stub,

and at a free end nothing at all. So δ = κ - β is that angle, as often as there are fixed ends, and the error

    e = (1 + δ/β) sinc((β + δ)/2N) - 1.

Of a fixed end with one weight the angle is that of (2w₀ - 1) tan(q/2), smooth at every q.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from beammodes.chains.rules import Rule
from beammodes.closed_form.axial_chains import SHORT, Poly, axial_frequencies, end_waves, existing, followed
from beammodes.numerics.roots import secants
from beammodes.problem.axial_ends import AxialBoundary

__all__ = ["PlainAxialChains", "plain_axial_chains"]


@dataclass(frozen=True, eq=False)
class PlainAxialChains:
    """Chains of one rule between one pair of plain ends.

    Attributes
    ----------
    rule : Rule
    pair : AxialBoundary
    fixed : int
        How many ends are fixed.
    first, second : tuple of tuples of float
        M₁₂ and M₂₂ - 1 of a fixed end: coefficients of λ = 4 sin²(q/2) in ascending powers, of each those of
        1/N. Both are empty where it is an exact mirror.
    half_stub : bool
    limits : (float, float, int)
        As of `followed`.
    shortest : float
        N above which all weights are positive.
    """

    rule: Rule
    pair: AxialBoundary
    fixed: int
    first: tuple[tuple[float, ...], ...]
    second: tuple[tuple[float, ...], ...]
    half_stub: bool
    limits: tuple[float, float, int]
    shortest: float

    def error(self, segments: int, mode: int) -> float:
        """Return ω_chain/ω_beam - 1 of one mode, NaN where the chain has none.

        Examples
        --------
        >>> from beammodes.chains.rules import RULES
        >>> chains = plain_axial_chains(RULES["naive"], AxialBoundary.of("fixed-free"))
        >>> round(100 * chains.error(10, 1), 8), round(1e10 * chains.error(10**9, 1), 6)
        (-4.85068966, -5.0)
        """
        # In longer chains such a mode is there, and every spring is positive.
        if not (mode < segments - 2 and segments > self.shortest) and not existing(
            self.rule, self.pair, segments, mode
        ):
            return math.nan
        beta = (mode - 1 + self.pair.rigid_body_modes) * math.pi + self.fixed * (math.pi / 2)
        delta = 0.0
        if self.fixed and (self.first or self.second):
            short_q, long_q, changed = self.limits
            if segments <= changed or beta > segments * (long_q if segments > SHORT else short_q):
                found = axial_frequencies(self.rule, self.pair, segments, np.array([mode]))
                return float(found[0]) / beta - 1.0
            excess = self._excess(beta, segments)
            value = excess(0.0)
            delta = secants(excess, 0.0, value, -value, most=30)
        part, shape = delta / beta, _sinc_less_one(0.5 * (beta + delta) / segments)
        return part + shape + part * shape

    def _excess(self, beta: float, segments: int) -> Callable[[float], float]:
        u, fixed, half_stub = 1.0 / segments, self.fixed, self.half_stub
        first, second = ([_value(row, u) for row in rows] for rows in (self.first, self.second))

        def excess(delta: float) -> float:
            half = 0.5 * (beta + delta) * u
            sine, cosine = math.sin(half), math.cos(half)
            square = 4.0 * sine * sine
            y, x = -2.0 * sine * _value(first, square), 1.0 + _value(second, square)
            angle = math.atan2(y * cosine, x) if half_stub else math.atan2(y, x * cosine)
            return delta - fixed * angle

        return excess


def _value(coefficients: tuple[float, ...] | list[float], x: float) -> float:
    """Return a polynomial's value, coefficients ascending."""
    total = 0.0
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


def _sinc_less_one(x: float) -> float:
    """Return  sin x/x - 1  by its series, x below 2."""
    square, series = x * x, 0.0
    for k in range(7 if x < 0.6 else 14, 0, -1):
        series = (1.0 + series) * square / (-2 * k * (2 * k + 1))
    return series


@lru_cache(maxsize=1024)
def plain_axial_chains(rule: Rule, pair: AxialBoundary) -> PlainAxialChains:
    """Return the chains of a rule with equal springs inside between fixed and free ends."""
    waves = end_waves(rule, "guided")

    def rows(poly: Poly) -> tuple[tuple[float, ...], ...]:
        if not poly:
            return ()
        lambdas, units = (max(power[k] for power in poly) + 1 for k in (0, 1))
        return tuple(tuple(float(poly.get((i, j), 0)) for j in range(units)) for i in range(lambdas))

    ends = [end_waves(rule, end.statics) for end in (pair.left, pair.right)]
    weights = [weight for end in ends for weight in end.weights]
    shortest = max(
        (float(-w.per_segment / w.constant) if w.constant > 0 else math.inf for w in weights), default=0.0
    )
    return PlainAxialChains(
        rule,
        pair,
        pair.left.is_fixed + pair.right.is_fixed,
        rows(waves.table[1]),
        rows(waves.table[3]),
        waves.half_stub,
        followed(*ends, single=all(end.is_single for end in ends)),
        shortest,
    )
