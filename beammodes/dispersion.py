"""Exact natural frequencies of uniform chains, at a cost that does not depend on the number of segments.

With the waves of `waves`, κ = qN and E = e^(-χN), both ends together give one real equation,

    sin(κ + Φ) = X,    X = E² ρ sin(κ + Φ₊) + E h,

where Φ(q) is the sum of the phases at which the two ends reflect a wave, and X, small except for the lowest
modes, is what the two ends' exponentials do to each other (`exchange`). The exact beam satisfies the same
equation with constants Φ⁰, so its mode n, at β + Φ⁰ ≈ kπ, says which k belongs to n.

Why no mode is taken for its neighbour: κ + Φ grows with q (that sets the shortest chain treated so), so the
points where it is an odd multiple of π/2 cut the band into intervals, and at the two ends of each the
equation's sides differ in opposite directions, because |X| < 1. So each interval holds a root. The last few
modes before the band's edge q = π, and those above it (q = π + iσ), are found as sign changes of the
determinant. Both together are as many as the chain has modes, which is counted: one in each interval.
Chains too short for that have their characteristic polynomial formed and solved in rational numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import shown, whole_number
from beammodes.ends import BOUNDARIES, Boundary, BoundaryLike, boundary_codes
from beammodes.exact_beam import wavenumber_of_code
from beammodes.rules import Rule, RuleLike, Weight, rule_named
from beammodes.waves import EndWaves, Minors, characteristic_polynomial, end_waves

__all__ = [
    "MAX_MODE",
    "MAX_SEGMENTS",
    "UniformChains",
    "amplitude",
    "chain_frequency",
    "looked_up",
    "wavenumbers",
    "whole_numbers",
]

#: Largest number of segments: what the accuracy of frequencies and errors has been measured up to.
MAX_SEGMENTS = 10**9
#: Largest mode number, that of `exact_beam.wavenumber`.
MAX_MODE = 10**12
# From the next mode on E < 1e-18, as χ > 0.56 q at any q: the exponentials of one end do not reach the other.
_LAST_EXCHANGING = 24
# Shorter chains are cheap in exact arithmetic.
_SHORT = 8
# Elements that one pass of a kernel takes: its temporary arrays then fit a cache.
_BLOCK = 1 << 14

Floats = NDArray[np.float64]
Rules = RuleLike | Iterable[RuleLike] | NDArray[Any]
Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


def chain_frequency(
    boundary: Boundaries, segments: ArrayLike, mode: ArrayLike, rule: Rules = "mitiguy"
) -> float | Floats:
    """Return the natural frequency of an elastic mode of a uniform chain.

    Inside the chain  ω² = 16 N⁴ s⁴ / (1 - p s²),  s = sin(q/2), for rods 12 N⁴ (1 - cos q)² / (2 + cos q);
    the two ends choose q. Relative accuracy is 1e-13 or better for every mode and N = 1 to 10⁹.

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
    float, or array of the broadcast shape [√(EI / (ρA L⁴))]
        ω for L = EI = ρA = 1; NaN where the chain has no such mode or a spring would not be positive.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or shapes do not match.

    Source
    ------
    Derived here from the rods' momentum balances: see the heads of this module and of `waves`.

    Examples
    --------
    >>> round(chain_frequency("clamped-free", 4, 1), 9)
    3.487885848
    >>> chain_frequency("pinned-pinned", [2, 1000], [[1], [2]]).round(6)
    array([[ 9.797959,  9.869604],
           [      nan, 39.478418]])
    """
    return looked_up(UniformChains.frequency, boundary, segments, mode, rule)


@dataclass(frozen=True, eq=False)
class UniformChains:
    """All chains of one pair of ends under one rule.

    Its methods take the number of segments and the mode as float arrays of one dimension.

    Parameters
    ----------
    code : int
        Index into `ends.BOUNDARIES`.
    rule : Rule
    """

    code: int
    rule: Rule

    @cached_property
    def pair(self) -> Boundary:
        """The two ends."""
        return BOUNDARIES[self.code]

    @cached_property
    def left(self) -> EndWaves:
        """The end at x = 0."""
        return end_waves(self.rule, self.pair.left)

    @cached_property
    def right(self) -> EndWaves:
        """The end at x = L; equal ends are one object."""
        return end_waves(self.rule, self.pair.right)

    @cached_property
    def p(self) -> float:
        """1 - 4 × rotary inertia."""
        return float(self.left.p)

    @cached_property
    def corrections(self) -> list[Weight]:
        """The weights that the rule prescribes at either end."""
        return [*self.rule.end_weights(self.pair.left), *self.rule.end_weights(self.pair.right)]

    @cached_property
    def swings(self) -> tuple[Swing, Swing]:
        """How far and how fast either end's phase moves across the band."""
        return swing(self.left), swing(self.right)

    @cached_property
    def shortest(self) -> int:
        """The smallest N for which waves are used.

        Springs corrected from both ends must not overlap, and κ + Φ must grow with q.
        """
        descent = self.swings[0].descent + self.swings[1].descent
        return max(_SHORT, len(self.corrections) + 3, math.ceil(1.25 * descent))

    @cached_property
    def surplus(self) -> int:
        """Elastic modes minus segments, for every chain that has an elastic mode.

        A chain of h hinges has h relative rotations, less the c - ρ conditions that are left when the c held
        quantities have used up the ρ rigid motions that they can prevent.
        """
        hinges = len(self.rule.piece_lengths(self.pair, 1)) - 1
        held = sum(end.holds_deflection + end.holds_rotation for end in (self.pair.left, self.pair.right))
        return hinges - 1 - (held - (2 - self.pair.rigid_body_modes))

    @cached_property
    def is_plain(self) -> bool:
        """True where both ends are mirrors at every q: then q = β/N exactly."""
        return self.left.is_plain and self.right.is_plain

    @cached_property
    def beam_phase(self) -> float:
        """Φ⁰, the sum of the phases at which the beam's own ends reflect."""
        beams = (self.left.beam, self.right.beam)
        return sum(math.atan2(beam.cos_decaying, beam.sin_decaying) for beam in beams)

    @cached_property
    def lead(self) -> int:
        """The integer k - n of the beam's modes: β + Φ⁰ = kπ, but for the exchange of exponentials."""
        return round((float(wavenumber_of_code(self.code, 20)) + self.beam_phase) / math.pi) - 20

    @cached_property
    def reach(self) -> float:
        """Segments outside the two places where the ends' determinants are taken."""
        return self.left.reach + self.right.reach

    def exists(self, segments: Any, mode: Any) -> Any:
        """Say which chains have that mode, and springs that are all positive."""
        found = mode <= segments + self.surplus
        for weight in self.corrections:
            if weight.per_segment or weight.constant <= 0:
                found = found & (float(weight.constant) + float(weight.per_segment) / segments > 0)
        return found

    def in_band(self, segments: Floats, mode: Floats) -> NDArray[np.bool_]:
        """Say which modes `shift` can give: those of chains that are long enough, but for the last few."""
        found = segments >= self.shortest
        doubtful = np.flatnonzero(found & (mode > segments - _SHORT))
        if len(doubtful) and not self.is_plain:
            found[doubtful] = mode[doubtful] <= self.last_in_band(segments[doubtful])
        return found

    def last_in_band(self, segments: Floats) -> Floats:
        """Return the last mode whose kπ lies, by π/4 to be safe, below κ + Φ at q = π."""
        # At q = π itself one of the two waves is missing: stop 2e-9 short of it.
        ends = self.minors(np.ones_like(segments), np.full_like(segments, 1e-9), 1.0 / segments)
        turns = (self.beam_phase + self.turn(math.pi, *ends)) / math.pi
        return np.asarray(segments - self.lead + np.floor(turns - 0.25))

    def minors(self, s: Any, t: Any, u: Any) -> tuple[Minors, Minors]:
        """Return the determinants of the left and the right end."""
        left = self.left.minors(s, t, u)
        return left, left if self.left is self.right else self.right.minors(s, t, u)

    def turn(self, q: Any, left: Minors, right: Minors) -> Any:
        """Φ - Φ⁰, continuous in q."""
        first, second = self.swings
        return phase(self.left, left, q, first.middle) + phase(self.right, right, q, second.middle)

    def evanescence(self, s: Any) -> Any:
        """χ of sinh²(χ/2) = s²/(1 - p s²)."""
        return 2.0 * np.arcsinh(s / np.sqrt(1.0 - self.p * s * s))

    def omega(self, s: Any) -> Any:
        """ω = 4 s²/√(1 - p s²), in units of √(EI / (ρA ell⁴))."""
        return 4.0 * s * s / np.sqrt(1.0 - self.p * s * s)

    def shift(self, beta: Floats, segments: Floats, mode: Floats) -> Floats:
        """Return δ = κ - β, to about 1e-15, of modes that are `in_band`."""
        if self.is_plain:
            return np.zeros_like(beta)
        excess = _Equation(self, beta, segments, mode).excess
        # X moves a root by less than π/2, and either end by less than π from the middle of its range.
        most = 8.0 + abs(self.swings[0].middle) + abs(self.swings[1].middle)
        low, high = np.maximum(-most, 1e-3 - beta), np.minimum(most, math.pi * segments - beta)
        delta = increasing_root(excess, np.zeros_like(beta), low, high, 5e-16 * beta)
        if np.any(np.abs(excess(delta)) > 1e-3):
            raise ArithmeticError(f"{self.pair.name}, rule {self.rule.name}: a reflected phase jumps")
        return delta

    def frequency(self, segments: Any, mode: Any) -> Floats:
        """Return ω for L = EI = ρA = 1; every mode asked for must exist."""
        segments, mode = np.atleast_1d(segments), np.atleast_1d(mode)
        frequency = np.empty_like(segments)
        inside = self.in_band(segments, mode)
        n, m = segments[inside], mode[inside]
        beta = wavenumbers(self.code, m)
        frequency[inside] = self.omega(np.sin(0.5 * (beta + self.shift(beta, n, m)) / n)) * n * n
        outside = np.flatnonzero(~inside)
        for size in np.unique(segments[outside]):
            chosen = outside[segments[outside] == size]
            first, listed = _listed(self, int(size))
            frequency[chosen] = listed[mode[chosen].astype(np.int64) - first] * size**2
        return np.asarray(frequency)


@lru_cache(maxsize=1024)
def uniform_chains(rule: Rule, code: int) -> UniformChains:
    """Return the chains of a pair of ends, an index into `ends.BOUNDARIES`, under `rule`."""
    return UniformChains(code, rule)


def wavenumbers(code: int, mode: Floats) -> Floats:
    """Return the exact beam's β as an array."""
    return np.asarray(wavenumber_of_code(code, mode.astype(np.int64)))


@dataclass(frozen=True, eq=False)
class _Equation:
    """κ + Φ - kπ = ± arcsin X, for a block of modes, as an equation for δ = κ - β."""

    chains: UniformChains
    beta: Floats
    segments: Floats
    mode: Floats

    @cached_property
    def exchanging(self) -> NDArray[np.bool_]:
        return np.asarray(self.mode <= _LAST_EXCHANGING)

    @cached_property
    def sign(self) -> Floats:
        return np.asarray(1.0 - 2.0 * ((self.mode + self.chains.lead) % 2.0))

    @cached_property
    def of_beam(self) -> Floats:
        """Arcsin X of the beam."""
        return self._arcsin(exchange(self.beta, self.beta, self.chains.left.beam, self.chains.right.beam))

    def _arcsin(self, across: Floats) -> Floats:
        return np.asarray(np.arcsin(np.where(self.exchanging, np.clip(across, -1.0, 1.0), 0.0)))

    def excess(self, delta: Floats) -> Floats:
        """Return δ + Φ - Φ⁰ ∓ (arcsin X - arcsin X⁰), which grows with δ."""
        chains = self.chains
        q = (self.beta + delta) / self.segments
        s = np.sin(0.5 * q)
        ends = chains.minors(s, np.cos(0.5 * q), 1.0 / self.segments)
        total = delta + chains.turn(q, *ends)
        if self.exchanging.any():
            span = self.segments - chains.reach
            across = exchange(q * span, chains.evanescence(s) * span, *ends)
            total -= self.sign * (self._arcsin(across) - self.of_beam)
        return np.asarray(total)


def exchange(kappa: Any, decay: Any, left: Minors, right: Minors) -> Any:
    """Return X of the equation at the head of this module; E = e^(-decay).

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


def amplitude(end: Minors) -> Any:
    """Return what an end's two decaying determinants have in common."""
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


class Swing(NamedTuple):
    """Middle of the range of an end's phase, less the beam's, and its steepest fall -dΦ/dq."""

    middle: float
    descent: float


@lru_cache(maxsize=1024)
def swing(end: EndWaves) -> Swing:
    """Measure an end's phase on a grid over the band, for long chains and for short ones."""
    q = np.linspace(1e-3, 3.1, 800)
    low = high = descent = 0.0
    for u in np.linspace(0.0, 1.0 - 1e-6, 5) * _largest_u(end):
        minors = end.minors(np.sin(0.5 * q), np.cos(0.5 * q), float(u))
        curve = np.unwrap(phase(end, minors, q))
        low, high = min(low, float(curve.min())), max(high, float(curve.max()))
        descent = max(descent, -float(np.diff(curve).min()) / (q[1] - q[0]))
    if high - low > 6.0:
        raise ValueError(f"rule {end.rule.name} turns waves by more than a whole turn at one end")
    # A mode about to leave the band may still turn the phase by -π between q = 3.1 and π.
    within = max(high, -low) < 0.85 * math.pi
    return Swing(0.0 if within else 0.5 * (low + high), descent)


def _largest_u(end: EndWaves) -> float:
    """Return the largest 1/N of interest: of chains not too short, and with positive springs."""
    falling = [w for w in end.rule.end_weights(end.end) if w.per_segment < 0 < w.constant]
    return min([1.0 / _SHORT, *(float(-w.constant / w.per_segment) for w in falling)])


@lru_cache(maxsize=4096)
def _listed(chains: UniformChains, segments: int) -> tuple[int, Floats]:
    """Return the number of the first mode that is not `in_band`, and the ω (segment units) from it on."""
    last = segments + chains.surplus
    if segments < chains.shortest:
        if min(chains.rule.hinge_weights(chains.pair, segments)) <= 0:
            return 1, np.full(last, np.nan)
        coefficients = characteristic_polynomial(chains.rule, chains.pair, segments)
        return 1, np.asarray(np.sqrt(_rational_roots(coefficients, last)))
    size = np.array([float(segments)])
    regular = chains.last_in_band(size)
    beta = wavenumbers(chains.code, regular)
    below = math.pi - float((beta + chains.shift(beta, size, regular))[0]) / segments
    first = int(regular[0]) + 1
    return first, _edge_frequencies(chains, segments, below, last - first + 1)


def increasing_root(
    function: Callable[[Floats], Floats], start: Floats, low: Floats, high: Floats, tolerance: Floats
) -> Floats:
    """Return roots of increasing functions, elementwise, by secants in brackets, then by bisection."""
    x = np.clip(start, low, high)
    y = function(x)
    step = -y
    for count in range(100):
        low, high = np.where(y < 0.0, x, low), np.where(y > 0.0, x, high)
        new = x + step
        # Rounding can keep secants from settling: halving cannot fail.
        secant = (new >= low) & (new <= high) & (count < 20)
        new = np.where(secant, new, 0.5 * (low + high))
        if np.all(np.minimum(np.abs(new - x), high - low) <= tolerance):
            break
        value = function(new)
        rise, run = value - y, new - x
        step = -value * np.where(rise * run > 0.0, run, 1.0) / np.where(rise * run > 0.0, rise, 1.0)
        x, y = new, value
    return new


def _rational_roots(coefficients: list[Fraction], count: int) -> Floats:
    """Return the `count` positive roots of a polynomial to the last digit, and prove that they are all.

    Floats give a start, exact Newton steps bring it home, exact signs on either side confirm it.
    """
    scaled = np.array([float(c / coefficients[0]) for c in coefficients])
    starts = np.sort(1.0 / np.roots(scaled).real)
    roots = np.array([_polished(coefficients, float(start)) for start in starts])
    proved = len(roots) == count and bool(np.all(roots[1:] > roots[:-1] * (1.0 + 1e-9)))
    below, above = 1 - Fraction(1, 2**36), 1 + Fraction(1, 2**36)
    for root in map(Fraction, roots.tolist()):
        proved &= (_value(coefficients, root * below) > 0) != (_value(coefficients, root * above) > 0)
    if not proved:
        raise ArithmeticError(f"roots of a characteristic polynomial of degree {count} were not separated")
    return roots


def _value(coefficients: list[Fraction], x: Fraction) -> Fraction:
    total = Fraction(0)
    for c in reversed(coefficients):
        total = total * x + c
    return total


def _polished(coefficients: list[Fraction], root: float) -> float:
    derivative = [k * c for k, c in enumerate(coefficients)][1:]
    for _ in range(3):
        x = Fraction(root)
        root = float(x - _value(coefficients, x) / _value(derivative, x))
    return root


def _edge_frequencies(chains: UniformChains, segments: int, below: float, count: int) -> Floats:
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
        found = np.concatenate([_sign_changes(curve, grid) for curve in curves])
        if len(found) == count:
            return np.sort(chains.omega(np.where(found < 0.0, np.cos(0.5 * found), np.cosh(0.5 * found))))
    raise ArithmeticError(
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


def _sign_changes(function: Callable[[Floats], Floats], grid: Floats) -> Floats:
    """Return a root from every interval of the grid at whose ends the function differs in sign."""
    value = function(grid)
    at = np.flatnonzero(np.sign(value[1:]) * np.sign(value[:-1]) < 0.0)
    sign = np.sign(value[at + 1])
    low, high = grid[at], grid[at + 1]
    tolerance = 4e-16 * (1.0 + np.abs(low))
    return increasing_root(lambda w: sign * function(w), 0.5 * (low + high), low, high, tolerance)


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
        # E² is below 1e-12 of E here: it moves no sign change by a rounding.
        near = near * np.exp(-decay - span * np.maximum(w, 0.0))
        return np.asarray(np.real((sin * (b * d - a * c) + cos * (a * d + b * c) - near) / t))
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


def looked_up(
    kernel: Callable[[UniformChains, Any, Any], Any],
    boundary: Boundaries,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: Rules,
) -> float | Floats:
    """Return `kernel(chains, segments, mode)` of modes that exist, group by group, and NaN for others.

    The kernel takes float arrays of one dimension or, when all arguments are single, two floats.
    """
    codes, (records, chosen) = _boundary_codes(boundary), _rule_codes(rule)
    n, m = whole_numbers("segments", segments, MAX_SEGMENTS), whole_numbers("mode", mode, MAX_MODE)
    if not (codes.ndim or chosen.ndim or n.ndim or m.ndim):
        chains, one = uniform_chains(records[0], int(codes)), (float(n), float(m))
        return float(np.squeeze(kernel(chains, *one))) if chains.exists(*one) else math.nan
    try:
        codes, n, m, chosen = np.broadcast_arrays(codes, n, m, chosen)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in (codes, n, m, chosen))
        message = f"boundary, segments, mode and rule must broadcast together, got shapes {shapes}"
        raise ValueError(message) from None
    result = np.full(codes.size, np.nan)
    for which, code, at in _groups(chosen.ravel(), codes.ravel()):
        chains = uniform_chains(records[which], code)
        size, number = n.ravel()[at].astype(np.float64), m.ravel()[at].astype(np.float64)
        found = np.flatnonzero(chains.exists(size, number))
        if len(found):
            result[at[found]] = kernel(chains, size[found], number[found])
    return result.reshape(codes.shape)


def _groups(chosen: NDArray[np.intp], codes: NDArray[np.intp]) -> Iterable[tuple[int, int, NDArray[np.intp]]]:
    """Yield rule, boundary and the indices of at most `_BLOCK` elements that share them."""
    key = chosen * len(BOUNDARIES) + codes
    order = np.argsort(key, kind="stable")
    for start, stop in pairwise([*np.flatnonzero(np.diff(key[order], prepend=-1)), key.size]):
        which, code = divmod(int(key[order[start]]), len(BOUNDARIES))
        for first in range(start, stop, _BLOCK):
            yield which, code, order[first : min(first + _BLOCK, stop)]


def whole_numbers(name: str, value: ArrayLike, most: int) -> NDArray[np.int64]:
    """Return `value` as integers, refusing what is not whole numbers in 1..most."""
    if isinstance(value, int | np.integer):
        return np.asarray(whole_number(name, value, most=most))
    try:
        array = np.asarray(value)
    except ValueError:  # A ragged list.
        array = np.empty(1, dtype=object)
    if array.ndim == 0:
        return np.asarray(whole_number(name, array.item(), most=most))
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers of at least 1 and at most {most}, got {shown(value)}")
    outside = (array < 1) | (array > most)
    if outside.any():
        whole_number(name, int(array[outside][0]), most=most)
    return array.astype(np.int64, copy=False)


def _rule_codes(rule: Rules) -> tuple[list[Rule], NDArray[np.intp]]:
    """Return rules, and indices into them of the shape of `rule`."""
    if isinstance(rule, str | Rule):
        return [rule_named(rule)], np.asarray(0)
    items, which = _distinct(rule)
    return [rule_named(item) for item in items], which


def _boundary_codes(boundary: Boundaries) -> NDArray[np.intp]:
    """Return `boundary_codes`, reading each object of an array once."""
    if isinstance(boundary, str | Boundary):
        return boundary_codes(boundary)
    items, which = _distinct(boundary)
    return np.array([int(boundary_codes(item)) for item in items], dtype=np.intp)[which]


def _distinct(value: Any) -> tuple[list[Any], NDArray[np.intp]]:
    """Return the distinct objects of an array, told apart by identity, and indices into them."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "U":
        names, which = np.unique(value, return_inverse=True)
        return [str(name) for name in names], which.reshape(value.shape)
    items = np.asarray(value, dtype=object)
    flat = items.ravel().tolist()
    identity = np.fromiter(map(id, flat), dtype=np.int64, count=len(flat))
    _, first, which = np.unique(identity, return_index=True, return_inverse=True)
    return [flat[k] for k in first], which.reshape(items.shape)
