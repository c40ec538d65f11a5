"""Exact natural frequencies of uniform chains, at a cost that does not depend on the number of segments.

With the waves of `waves`, κ = qN and E = e^(-χN), both ends together give one real equation,

    sin(κ + Φ) = X,    X = E² ρ sin(κ + Φ₊) + E h,

where Φ(q) is the sum of the phases at which the two ends reflect a wave, and X, small except for the lowest
modes, is what the two ends' exponentials do to each other (`waves.exchange`). The exact beam satisfies
the same equation with constants Φ⁰, so its mode n, at β + Φ⁰ ≈ kπ, says which k belongs to n.

Why no mode is taken for its neighbour: κ + Φ grows with q (that sets the shortest chain treated so), so the
points where it is an odd multiple of π/2 cut the band into intervals, and at the two ends of each the
equation's sides differ in opposite directions, because |X| < 1. So each interval holds a root. The last few
modes before the band's edge q = π, and those above it (q = π + iσ), are found as sign changes of the
determinant. Both together are as many as the chain has modes, which is counted: one in each interval.
Chains too short for that have their characteristic polynomial formed and solved in rational numbers.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.closed_form.exact_states import characteristic_polynomial
from beammodes.closed_form.uniform_chains import Boundaries, Rules, UniformChains, looked_up
from beammodes.closed_form.waves import exchange
from beammodes.numerics.arrays import Floats, keeps_labels
from beammodes.numerics.roots import NotFollowed, increasing_root, polynomial_roots, sign_changes

__all__ = ["chain_frequency", "edge_frequencies", "frequencies"]


def edge_frequencies(chains: UniformChains, segments: int, below: float, count: int) -> Floats:
    """Return the last `count` frequencies of a chain, those with q beyond π - below, in segment units.

    Along the band up to its edge, q = π - |w| for w < 0, and above it, q = π + iw for w > 0, the determinant
    over cos(q/2) is real and has no root of its own at q = π. Equal ends have it in two factors, for even
    and odd modes, whose roots do not crowd together where a mode above the band sits at either end.
    """
    top = max(_highest(chains, segments), below)
    parts = (1, -1) if chains.left is chains.right else (0,)
    found = np.empty(0)
    for points in (100, 1000, 10000):
        inside = np.linspace(-below * (1.0 - 1e-4), -below * 1e-7, points)
        grid = np.concatenate([inside, np.geomspace(below * 1e-7, top, 2 * points)])
        curves = [partial(_edge, chains, segments, part) for part in parts]
        found = np.concatenate([sign_changes(curve, grid) for curve in curves])
        if len(found) == count:
            return np.sort(chains.omega(np.where(found < 0.0, np.cos(0.5 * found), np.cosh(0.5 * found))))
    raise NotFollowed(
        f"{chains.pair.name}, rule {chains.rule.name}, N = {segments}: {len(found)} modes found at the edge "
        f"of the band, {count} expected"
    )


def _highest(chains: UniformChains, segments: int) -> float:
    """Return the w that no mode of the chain exceeds.

    Each spring stores at most (θ² + θ'²)/w, each rod turns with at least r θ²/2, half rods with r θ²/16.
    """
    stiffest = min([1.0, *(float(w.constant) + float(w.per_segment) / segments for w in chains.corrections)])
    bound = (16.0 if chains.left.half else 4.0) / (stiffest * float(chains.rule.rotary_inertia))
    # 16 x² / (1 - p x) = bound, x = cosh²(w/2).
    x = bound / (math.sqrt((0.5 * chains.p * bound) ** 2 + 16.0 * bound) + 0.5 * chains.p * bound)
    return 2.0 * math.acosh(math.sqrt(max(x, 1.0))) * (1.0 + 1e-9)


def _edge(chains: UniformChains, segments: int, part: int, w: Floats) -> Floats:
    """Return the determinant (part 0), or its factor for even (1) or odd (-1) modes, damped by e^(-N w)."""
    before = np.where(w < 0.0, -w, -1j * w)  # π - q
    s, t = np.cos(0.5 * before), np.sin(0.5 * before)
    left, right = chains.minors(s, t, 1.0 / segments)
    span = round(segments - chains.reach)
    decay = span * chains.evanescence(s.real)
    a, b = left.cos_decaying, left.sin_decaying
    if not part:
        cos, sin = _near_edge(2 * span, span * w)
        c, d = right.cos_decaying, right.sin_decaying
        near = left.cos_sin * right.decaying_growing + left.decaying_growing * right.cos_sin
        near = near * np.exp(-decay - span * np.maximum(w, 0.0))
        # Ends that reach over most of the chain leave few segments between them: E² counts as well.
        e, f, g, h = left.cos_growing, left.sin_growing, right.cos_growing, right.sin_growing
        far = np.exp(-2.0 * decay) * (sin * (f * h - e * g) + cos * (e * h + f * g))
        return np.asarray(np.real((sin * (b * d - a * c) + cos * (a * d + b * c) - near - far) / t))
    cos, sin = _near_edge(span, 0.5 * span * w)
    fade = part * np.exp(-decay)
    a, b = a + fade * left.cos_growing, b + fade * left.sin_growing
    factor = cos * a + sin * b if part > 0 else sin * a - cos * b
    # Of the two factors one vanishes at q = π for want of a second wave, not because a mode is there.
    vanishes = (span % 2 == 1) == (part > 0)
    return np.asarray(np.real(factor / t if vanishes else factor))


def _near_edge(quarters: int, w: Floats) -> tuple[Any, Any]:
    """Return cos and sin of `quarters` right angles less |w|, or, for w > 0, plus iw and damped by e^(-w)."""
    fade = np.exp(-2.0 * np.maximum(w, 0.0))
    cos = np.where(w < 0.0, np.cos(w), 0.5 * (1.0 + fade))
    sin = np.where(w < 0.0, -np.sin(w), -0.5j * (1.0 - fade))
    return ((cos, -sin), (sin, cos), (-cos, sin), (-sin, -cos))[quarters % 4]


# From the next mode on E < 1e-18, as χ > 0.56 q at any q: the exponentials of one end do not reach the other.
_LAST_EXCHANGING = 24
# Modes of rules that waves do not serve: each is some milliseconds' work.
_MOST_COUNTED = 1000


@keeps_labels
def chain_frequency(
    boundary: Boundaries, segments: ArrayLike, mode: ArrayLike, rule: Rules = "mitiguy"
) -> float | Floats:
    """Return the natural frequency of an elastic mode of a uniform chain.

    Inside the chain  ω² = 16 N⁴ s⁴ / (1 - p s²),  s = sin(q/2), for rods 12 N⁴ (1 - cos q)² / (2 + cos q);
    the two ends choose q. Relative accuracy is 1e-13 or better for every mode and N = 1 to 10⁹.

    Parameters
    ----------
    boundary : str, pair of ends, Boundary, or array of them
        The two ends, in either order.
    segments : int or array of int
        N, 1 to 10⁹.
    mode : int or array of int
        Elastic modes, from 1.
    rule : str, Rule, or array of them

    Returns
    -------
    float, or array of the broadcast shape [√(EI / (ρA L⁴))]
        ω for L = EI = ρA = 1; NaN where the chain has no such mode or a spring would not be positive.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or shapes do not match.

    References
    ----------
    Derived here from the rods' momentum balances: see the heads of this module and of `waves`.

    Examples
    --------
    >>> import beammodes as bm
    >>> round(bm.chain_frequency("clamped-free", 4, 1), 9)
    3.487885848
    >>> bm.chain_frequency("pinned-pinned", [2, 1000], [[1], [2]]).round(6)
    array([[ 9.797959,  9.869604],
           [      nan, 39.478418]])
    """
    return looked_up(frequencies, boundary, segments, mode, rule)


def frequencies(chains: UniformChains, segments: Any, mode: Any) -> Floats:
    """Return ω for L = EI = ρA = 1; every mode asked for must exist.

    What the waves' roots do not prove complete, chain by chain, is counted.
    """
    segments, mode = np.atleast_1d(segments), np.atleast_1d(mode)
    try:
        return _by_waves(chains, segments, mode)
    except NotFollowed:
        frequency: Floats = np.empty_like(segments)
    for size in np.unique(segments):
        chosen = segments == size
        try:
            frequency[chosen] = _by_waves(chains, segments[chosen], mode[chosen])
        except NotFollowed:
            frequency[chosen] = _counted(chains, int(size), mode[chosen].astype(np.int64))
    return frequency


def _by_waves(chains: UniformChains, segments: Floats, mode: Floats) -> Floats:
    frequency = np.empty_like(segments)
    inside = chains.in_band(segments, mode)
    n, m = segments[inside], mode[inside]
    beta = chains.wavenumbers(m)
    frequency[inside] = chains.omega(np.sin(0.5 * (beta + shift(chains, beta, n, m)) / n)) * n * n
    outside = np.flatnonzero(~inside)
    for size in np.unique(segments[outside]):
        chosen = outside[segments[outside] == size]
        if chains.shortest == math.inf:
            raise NotFollowed(f"{chains.pair.name}, rule {chains.rule.name}: an end turns waves too far")
        first, listed = _listed(chains, int(size))
        frequency[chosen] = listed[mode[chosen].astype(np.int64) - first] * size**2
    return np.asarray(frequency)


def shift(chains: UniformChains, beta: Floats, segments: Floats, mode: Floats) -> Floats:
    """Return δ = κ - β, to about 1e-15, of modes that are `in_band`."""
    if chains.is_plain:
        return np.zeros_like(beta)
    exchanging, sign = mode <= _LAST_EXCHANGING, 1.0 - 2.0 * ((mode + chains.lead) % 2.0)

    def arcsin(across: Any) -> Any:
        return np.arcsin(np.where(exchanging, np.clip(across, -1.0, 1.0), 0.0))

    of_beam = arcsin(exchange(beta, beta, chains.left.beam, chains.right.beam))

    def excess(delta: Floats) -> Floats:
        """Return δ + Φ - Φ⁰ ∓ (arcsin X - arcsin X⁰), which grows with δ."""
        q = (beta + delta) / segments
        s = np.sin(0.5 * q)
        ends = chains.minors(s, np.cos(0.5 * q), 1.0 / segments)
        total = delta + chains.turn(q, *ends)
        if exchanging.any():
            span = segments - chains.reach
            total -= sign * (arcsin(exchange(q * span, chains.evanescence(s) * span, *ends)) - of_beam)
        return np.asarray(total)

    # X moves a root by less than π/2, and either end by less than π from the middle of its range.
    most = 8.0 + abs(chains.swings[0].middle) + abs(chains.swings[1].middle)
    low, high = np.maximum(-most, 1e-3 - beta), np.minimum(most, math.pi * segments - beta)
    delta = increasing_root(excess, np.zeros_like(beta), low, high, 5e-16 * beta)
    if np.any(np.abs(excess(delta)) > 1e-3):
        raise NotFollowed(f"{chains.pair.name}, rule {chains.rule.name}: a reflected phase jumps")
    return delta


def _counted(chains: UniformChains, segments: int, mode: NDArray[np.int64]) -> Floats:
    """Return ω of modes that waves do not give, each a counted root."""
    from beammodes.closed_form.supported_chain import supported_chain_frequencies

    most = int(mode.max())
    if most > _MOST_COUNTED:
        raise ValueError(
            f"mode must be at most {_MOST_COUNTED} with rule {chains.rule.name}, whose end weights turn "
            f"waves too far for a closed form, got {most}"
        )
    found: Floats = supported_chain_frequencies(chains.pair, segments, most, chains.rule)
    return found[mode - 1]


@lru_cache(maxsize=4096)
def _listed(chains: UniformChains, segments: int) -> tuple[int, Floats]:
    """Return the number of the first mode that is not `in_band`, and the ω (segment units) from it on."""
    last = segments + chains.surplus
    if segments < chains.shortest:
        if min(chains.rule.hinge_weights(chains.pair, segments)) <= 0:
            return 1, np.full(last, np.nan)
        coefficients = characteristic_polynomial(chains.rule, chains.pair, segments)
        return 1, np.asarray(np.sqrt(polynomial_roots(coefficients, last)))
    size = np.array([float(segments)])
    regular = chains.last_in_band(size)
    beta = chains.wavenumbers(regular)
    below = math.pi - float((beta + shift(chains, beta, size, regular))[0]) / segments
    first = int(regular[0]) + 1
    return first, edge_frequencies(chains, segments, below, last - first + 1)
