"""Twist and stretch of uniform chains in closed form, and their errors kept to full relative accuracy.

Inside a chain pieces move as u = cos(q x/ell - φ) at their middles, and

    ω = (2c/ell) sin(q/2),        c = √(GJ/ρIp)  or  √(EA/ρA),

so with κ = qN the mode is the root of  κ - φ_left(q) - φ_right(q) = kπ,  the beam's of
β - φ⁰_left(β) - φ⁰_right(β) = kπ, tan φ⁰ = K/β - Jβ (springs K in k/L, discs J in m L).

An end's hinges take (u, T), the end's own displacement and the force N T that acts on it, through the chain;
the same hinges of weight 1/2, 1, 1, ... take it back. M, the two ways together, is 1 where the rule has those
weights, and

    tan φ = cos(q/2) T'/(2N sin(q/2) u')      hinge at the wall,    T'/(N sin q u')    half a stub,
    (u', T') = M (1, K - J (2N sin(q/2))²)                          fixed: M (0, 1)

which for plain weights w₀, 1, 1, ... is

    fixed     φ - π/2:  tan = (2w₀ - 1) tan(q/2)                    exact mirror
    spring    cot φ = 2 tan(q/2)/k - (1 - 2w₀) tan(q/2)              tan φ = k/sin q
    disc      tan φ = -μ sin q/(1 + 2μ (1 - 2w₀) sin²(q/2))          tan φ = -2μ tan(q/2)

with k = K/N and μ = J N. Errors are the root δ = κ - β of the difference of the two equations, in which
nothing is subtracted that is nearly equal: M - 1 has exact rational coefficients in sin²(q/2) and 1/N, and
what trigonometric functions leave is summed as series.

So e = (1 + δ/β) sinc(β + δ)/2N - 1 holds at any N. Where an end's weights overlap the other's, and for the
highest modes, the chain's own frequencies are solved for instead, and e is within 1e-13.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import Rule, Weight
from beammodes.exact.axial_beam import axial_wavenumber
from beammodes.numerics.arrays import Floats
from beammodes.numerics.roots import secants
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.motions import unit_beam
from beammodes.vibration.axial_spectrum import solve_axial_modes

__all__ = [
    "SHORT",
    "EndWaves",
    "Poly",
    "axial_errors",
    "axial_frequencies",
    "end_waves",
    "existing",
    "followed",
]

# Largest β/N for which δ is solved for at ends whose weights are corrected, in short chains and in long ones,
# and what those corrections may be in all: of more the wave's phase may turn further than δ follows.
_LARGEST_Q, _LARGEST_LONG_Q = 0.5, 2.5
_LARGEST_CORRECTION, _LARGEST_LONG_CORRECTION = 2.5, 2.0

# Cases that are computed at a time; chains of which all modes are kept, and solved for; modes kept of a
# longer one, and the longest whose high modes are solved for.
_BLOCK, SHORT, _WHOLE, _KEPT, _LONGEST = 100_000, 200, 1000, 8, 100_000

Poly = dict[tuple[int, int], Fraction]


def _plus(a: Poly, b: Poly, factor: Fraction | int = 1) -> Poly:
    total = dict(a)
    for power, value in b.items():
        total[power] = total.get(power, Fraction(0)) + factor * value
    return {power: value for power, value in total.items() if value}


def _times(a: Poly, b: Poly) -> Poly:
    total: Poly = {}
    for (i, j), x in a.items():
        for (k, m), y in b.items():
            total[i + k, j + m] = total.get((i + k, j + m), Fraction(0)) + x * y
    return {power: value for power, value in total.items() if value}


@dataclass(frozen=True, eq=False)
class EndWaves:
    """What a rule makes of waves at one kind of end: M - 1, polynomials in λ = 4 sin²(q/2) and u = 1/N.

    Attributes
    ----------
    half_stub : bool
        Whether the outermost hinge is half a segment from the end.
    weights : tuple of Weight
        That differ from those of the exact mirror or may do so.
    table : tuple of four Poly
        M - 1 by rows.
    correction : float
        Σ |w_j - w⁰_j| in long chains.
    is_single : bool
        Whether there is at most one weight, a constant: at a fixed end the phase then turns as tan(q/2) does.
    """

    half_stub: bool
    weights: tuple[Weight, ...]
    table: tuple[Poly, Poly, Poly, Poly]
    correction: float
    is_single: bool = True

    @property
    def is_mirror(self) -> bool:
        """True if M = 1: then only spring and disc are left to err."""
        return not any(self.table)

    def at(self, powers: Floats, u: Any) -> list[Any]:
        """Return the four polynomials' values; `powers` are those of λ."""
        return [
            sum((float(c) * powers[i] * u**j for (i, j), c in poly.items()), np.zeros_like(powers[0]))
            for poly in self.table
        ]

    @property
    def terms(self) -> int:
        """How many powers of λ `at` needs."""
        return 1 + max((i for poly in self.table for i, _ in poly), default=0)


@lru_cache(maxsize=512)
def end_waves(rule: Rule, kind: str) -> EndWaves:
    """Return the waves at an end: "guided" (fixed), "free", or "clamped" (with a spring, a disc or a mass).

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> end_waves(RULES["gregory"], "guided").is_mirror, end_waves(RULES["naive"], "guided").is_mirror
    (True, False)
    """
    half = rule.stub == Fraction(1, 2)
    weights = {"guided": rule.guided, "clamped": rule.clamped}.get(kind, ())
    if kind == "free":
        return EndWaves(half, (), ({}, {}, {}, {}), 0.0)
    # A first segment that is welded to the end is a hinge at the wall that does not turn.
    given = [Weight(0), *weights] if rule.stub == 1 else list(weights)
    if not half and not given:
        given = [Weight(1)]
    mirror = [Fraction(1)] * len(given) if half else [Fraction(1, 2), *[Fraction(1)] * (len(given) - 1)]
    one: Poly = {(0, 0): Fraction(1)}
    wave: Poly = {(1, 0): Fraction(1)}
    # Rows (u, T) of the matrix that the actual hinges make, then those of the mirror backwards.
    rows: list[list[Poly]] = [[one, {}], [{}, one]]

    def turn(weight: Poly, sign: int) -> None:
        rows[0] = [_plus(rows[0][k], _times(weight, rows[1][k]), sign) for k in (0, 1)]

    def pull(part: Fraction, sign: int) -> None:
        rows[1] = [_plus(rows[1][k], _times(wave, rows[0][k]), -sign * part) for k in (0, 1)]

    last = len(given) - 1
    if half:
        pull(Fraction(1, 2), 1)
    for j, weight in enumerate(given):
        turn({(0, 0): weight.constant, (0, 1): weight.per_segment}, 1)
        if j < last:
            pull(Fraction(1), 1)
    for j in range(last, -1, -1):
        if j < last:
            pull(Fraction(1), -1)
        turn({(0, 0): mirror[j]}, -1)
    if half:
        pull(Fraction(1, 2), -1)
    table = (_plus(rows[0][0], one, -1), rows[0][1], rows[1][0], _plus(rows[1][1], one, -1))
    correction = sum(float(abs(w.constant - m)) for w, m in zip(given, mirror, strict=True))
    single = len(given) <= 1 and not any(weight.per_segment for weight in given)
    return EndWaves(half, tuple(weights), table, correction, single)


@dataclass(frozen=True, eq=False)
class _Ends:
    """Numbers of one end in many cases, scaled to stay in range: (a, K, J) with a = 0 at a fixed one."""

    waves: EndWaves
    free: Floats
    spring: Floats
    body: Floats

    @classmethod
    def of(cls, waves: EndWaves, spring: Floats, body: Floats) -> _Ends:
        held = np.isinf(spring)
        loose = np.where(held, 0.0, spring)
        size = 1.0 + loose + body
        return cls(
            waves,
            np.where(held, 0.0, 1.0 / size),
            np.where(held, 1.0, loose / size),
            np.where(held, 0.0, body / size),
        )

    @property
    def mirrors(self) -> bool:
        """True if the end reflects as the beam's at every frequency."""
        return self.waves.is_mirror and not (self.free * (self.spring + self.body)).any()

    def turned(self, beta: Floats, delta: Floats, count: Floats, wave: _Wave) -> Floats:
        """Return φ - φ⁰, the chain's less the beam's."""
        a, spring, body = self.free, self.spring, self.body
        force, beam_force = spring - body * wave.p * wave.p, spring - body * beta * beta
        near, far = wave.kappa * wave.cos_less_sinc - delta * wave.cos, wave.kappa * wave.sinc_q + delta
        m11, m12, m21, m22 = self.waves.at(wave.powers, wave.u)
        more_moved = m11 * a + m12 * wave.u * force
        more_force = count * m21 * a + m22 * force
        moved, pulled = a + more_moved, force + more_force
        if self.waves.half_stub:
            sine = -a * (spring * far - body * beta * wave.p * near)
            sine = sine + beta * a * more_force - wave.p * wave.cos * more_moved * beam_force
            cosine = wave.p * wave.cos * moved * beta * a + pulled * beam_force
        else:
            sine = a * (spring * near - body * beta * wave.p * far)
            sine = sine + beta * a * wave.cos * more_force - wave.p * more_moved * beam_force
            cosine = wave.p * moved * beta * a + wave.cos * pulled * beam_force
        return np.asarray(np.arctan2(sine, cosine))


@dataclass(frozen=True, eq=False)
class _Wave:
    """Functions of q = κ/N that ends need, each small part as such."""

    kappa: Floats
    u: Floats
    p: Floats
    cos: Floats
    cos_less_sinc: Floats
    sinc_q: Floats
    sinc_half: Floats
    powers: Floats

    @classmethod
    def of(cls, kappa: Floats, count: Floats, terms: int) -> _Wave:
        half = 0.5 * kappa / count
        sine = np.sin(half)
        powers = np.ones((terms, *kappa.shape))
        for k in range(1, terms):
            powers[k] = powers[k - 1] * (4.0 * sine * sine)
        return cls(
            kappa=kappa,
            u=1.0 / count,
            p=2.0 * count * sine,
            cos=np.cos(half),
            cos_less_sinc=_cos_less_sinc(half),
            sinc_q=_sinc_less_one(2.0 * half),
            sinc_half=_sinc_less_one(half),
            powers=powers,
        )


def _sinc_less_one(x: Floats) -> Floats:
    """Return  sin x/x - 1 = Σ (-1)^k x^2k/(2k + 1)!."""
    series, square, largest = np.zeros_like(x), x * x, float(x.max())
    for k in range(_terms(largest), 0, -1):
        series = (1.0 + series) * square / (-2 * k * (2 * k + 1))
    return series if largest < 2.0 else np.where(x < 2.0, series, np.sin(x) / np.maximum(x, 1.0) - 1.0)


def _cos_less_sinc(x: Floats) -> Floats:
    """Return  cos x - sin x/x = Σ (-1)^k 2k x^2k/(2k + 1)!."""
    series, square = np.zeros_like(x), x * x
    for k in range(_terms(float(x.max())), 0, -1):
        series = (2 * k + series) * square / (-2 * k * (2 * k + 1))
    return series


def _terms(largest: float) -> int:
    """Return how many terms the series above need: at 0.6 the eighth, at 2 the fifteenth is below 1e-18."""
    return 7 if largest < 0.6 else 14


@dataclass(frozen=True, eq=False)
class _Cases:
    """Chains of one rule between ends of one kind each: N, β and the ends' numbers."""

    count: Floats
    beta: Floats
    left: _Ends
    right: _Ends

    def errors(self) -> Floats:
        """Return ω_chain/ω_beam - 1."""
        delta = np.zeros_like(self.beta)
        if self._turning:
            value = self._excess(delta)
            delta = secants(self._excess, delta, value, -value, most=30)
        kappa = self.beta + delta
        part, shape = delta / self.beta, _sinc_less_one(0.5 * kappa / self.count)
        return part + shape + part * shape

    @cached_property
    def _turning(self) -> list[_Ends]:
        """The ends that do not reflect as the beam's."""
        return [end for end in (self.left, self.right) if not end.mirrors]

    @cached_property
    def _terms(self) -> int:
        return max(self.left.waves.terms, self.right.waves.terms)

    def _excess(self, delta: Floats) -> Floats:
        wave = _Wave.of(self.beta + delta, self.count, self._terms)
        return delta - sum(end.turned(self.beta, delta, self.count, wave) for end in self._turning)


def existing(rule: Rule, pair: AxialBoundary, count: Any, mode: Any) -> NDArray[np.bool_]:
    """Return which chains of N segments have that elastic mode, by counting pieces that move.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> pair = AxialBoundary.of("fixed-free")
    >>> [bool(existing(RULES[name], pair, 4, 4)) for name in ("naive", "rigid_stub")]
    [True, False]
    """
    pieces = np.asarray(count) + (rule.stub == Fraction(1, 2))
    for end in (pair.left, pair.right):
        if end.statics == "clamped" and not rule.stub:
            # A disc adds a piece of its own, a spring alone does not.
            pieces = pieces + (end.inertia > 0.0)
        elif end.is_fixed and rule.stub:
            pieces = pieces - 1
    found = np.asarray(np.asarray(mode) <= pieces - pair.rigid_body_modes)
    for end in (pair.left, pair.right):
        for weight in end_waves(rule, end.statics).weights:
            found = found & (float(weight.constant) + float(weight.per_segment) / np.asarray(count) > 0)
    return found


def axial_errors(
    rule: Rule,
    pairs: list[AxialBoundary],
    which: NDArray[np.intp],
    count: NDArray[np.int64],
    mode: NDArray[np.int64],
) -> Floats:
    """Return ω_chain/ω_beam - 1 of many cases of a rule with equal springs inside, NaN without a mode.

    Parameters
    ----------
    rule : Rule
    pairs : list of AxialBoundary
        Their numbers are multiples of k/L and m L.
    which, count, mode : ndarray, of one shape of one dimension
        Index into `pairs`, N and the elastic mode.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> pair = [AxialBoundary.of("fixed-free")]
    >>> at = np.zeros(2, dtype=np.intp)
    >>> 100 * axial_errors(RULES["naive"], pair, at, np.array([10, 10**9]), np.array([1, 1]))
    array([-4.85068966e+00, -5.00000000e-08])
    """
    error = np.full(which.shape, np.nan)
    if not which.size:
        return error
    known, place = np.unique(which * np.int64(2**40) + mode, return_inverse=True)
    beta = axial_wavenumber(pairs, known >> 40, known & (2**40 - 1))[place]
    # What exists depends on which numbers there are, and not on how large they are.
    alike: dict[tuple[bool, ...], list[int]] = {}
    for k, pair in enumerate(pairs):
        key = [(end.is_fixed, end.stiffness > 0.0, end.inertia > 0.0) for end in (pair.left, pair.right)]
        alike.setdefault((*key[0], *key[1]), []).append(k)
    numbers = np.array(
        [[p.left.stiffness, p.left.inertia, p.right.stiffness, p.right.inertia] for p in pairs]
    )
    for members in alike.values():
        here, pair = np.flatnonzero(np.isin(which, members)), pairs[members[0]]
        here = here[existing(rule, pair, count[here], mode[here])]
        kinds = pair.left.statics, pair.right.statics
        waves = end_waves(rule, kinds[0]), end_waves(rule, kinds[1])
        smooth = _smooth(waves, kinds, count[here], beta[here])
        for at in np.array_split(here[smooth], -(-int(smooth.sum()) // _BLOCK) or 1):
            if not len(at):
                continue
            values = numbers[which[at]]
            ends = [
                _Ends.of(wave, values[:, 2 * side], values[:, 2 * side + 1])
                for side, wave in enumerate(waves)
            ]
            error[at] = _Cases(count[at].astype(np.float64), beta[at], *ends).errors()
        rest = here[~smooth]
        for k, n in sorted({*zip(which[rest].tolist(), count[rest].tolist(), strict=True)}):
            at = rest[(which[rest] == k) & (count[rest] == n)]
            error[at] = axial_frequencies(rule, pairs[k], n, mode[at]) / beta[at] - 1.0
    return error


def _smooth(
    waves: tuple[EndWaves, EndWaves], kinds: tuple[str, str], count: NDArray[np.int64], beta: Floats
) -> NDArray[np.bool_]:
    """Return where δ is solved for: at plain mirrors everywhere, else where it can be followed."""
    if all(wave.is_mirror and kind != "clamped" for wave, kind in zip(waves, kinds, strict=True)):
        return np.ones(count.shape, dtype=bool)
    single = "clamped" not in kinds and all(wave.is_single for wave in waves)
    short_q, long_q, changed = followed(*waves, single=single)
    return np.asarray((beta <= np.where(count > SHORT, long_q, short_q) * count) & (count > changed))


def followed(left: EndWaves, right: EndWaves, *, single: bool) -> tuple[float, float, int]:
    """Return up to which β/N δ can be followed, and the longest chain in which the ends' weights may overlap.

    The first is for chains of up to `SHORT` segments, the second for longer ones; `single` says that both
    ends are plain, of one weight at most.
    """
    correction = max(left.correction, right.correction)
    changed = len(left.weights) + len(right.weights) + 2
    if single:
        return math.inf, math.inf, changed
    if correction > _LARGEST_CORRECTION:
        return 0.0, 0.0, changed
    return _LARGEST_Q, _LARGEST_LONG_Q if correction <= _LARGEST_LONG_CORRECTION else _LARGEST_Q, changed


@lru_cache(maxsize=4096)
def _all_frequencies(record: Any, pair: AxialBoundary, segments: int) -> Floats:
    """Return every frequency of a short chain of unit numbers."""
    return solve_axial_modes(_chain(record, pair, segments)).angular_frequency


@lru_cache(maxsize=4096)
def _low_frequencies(record: Any, pair: AxialBoundary, segments: int, modes: int) -> Floats:
    return solve_axial_modes(_chain(record, pair, segments), modes).angular_frequency


def _chain(record: Any, pair: AxialBoundary, segments: int) -> AxialChain:
    return AxialChain(unit_beam(), pair, segments, record, motion=pair.motion)


def axial_frequencies(record: Any, pair: AxialBoundary, segments: int, mode: NDArray[np.int64]) -> Floats:
    """Return a chain's ω of these modes for L = k = m = 1, solved for; NaN where it has none.

    Of any layout, patterns inside included. Relative accuracy is 1e-13.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> axial_frequencies(RULES["simpson"], AxialBoundary.of("fixed-free"), 10, np.array([1])).round(6)
    array([1.568639])
    """
    most = max(_KEPT, int(mode.max()))
    low = 10 * most <= segments
    if segments > (MAX_PIECES if low else _LONGEST):
        raise ValueError(
            f"segments must be at most {MAX_PIECES if low else _LONGEST} for mode {most} of rule "
            f"{record.name} with {pair.name}, whose chain has to be solved, got {segments}"
        )
    try:
        if segments <= SHORT:
            found = _all_frequencies(record, pair, segments)
        elif low:
            found = _low_frequencies(record, pair, segments, most)
        elif segments <= _WHOLE:
            found = solve_axial_modes(_chain(record, pair, segments)).angular_frequency
        else:
            return _selected(_chain(record, pair, segments), mode)
    except ValueError:
        # No positive springs for this boundary and N, or a pattern that does not fit N.
        return np.full(mode.shape, np.nan)
    inside = mode <= len(found)
    return np.where(inside, found[np.minimum(mode, max(1, len(found))) - 1] if len(found) else np.nan, np.nan)


def _selected(chain: AxialChain, mode: NDArray[np.int64]) -> Floats:
    """Return ω of some modes of a long chain from the squares: right to 1e-16 N²/mode²."""
    from scipy.linalg import eigvalsh_tridiagonal

    _, inertia, springs = chain.moving
    diagonal = (springs[:-1] + springs[1:]) / inertia
    beside = -springs[1:-1] / np.sqrt(inertia[:-1]) / np.sqrt(inertia[1:])
    omega = np.full(mode.shape, np.nan)
    index = mode - 1 + chain.boundary.rigid_body_modes
    there = mode <= chain.elastic_modes
    if there.any():
        low, high = int(index[there].min()), int(index[there].max())
        squares = eigvalsh_tridiagonal(diagonal, beside, select="i", select_range=(low, high))
        omega[there] = np.sqrt(squares[index[there] - low])
    return omega
