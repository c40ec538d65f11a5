"""Uniform chains as a family: their ends, which modes they have, and what frequency belongs to a wave."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.rules import Rule, RuleLike, Weight, closed_rule
from beammodes.checks import distinct, together, whole_number, whole_numbers
from beammodes.closed_form.waves import SHORT, EndWaves, Minors, Swing, end_waves, phase, swing
from beammodes.exact.exact_beam import wavenumber_of_code
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import BOUNDARIES, Boundary, BoundaryLike, boundary_code, boundary_codes

__all__ = [
    "MAX_MODE",
    "MAX_SEGMENTS",
    "Boundaries",
    "Rules",
    "UniformChains",
    "chains_of",
    "looked_up",
]


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
        """The ranges and steepest falls of the two ends' phases across the band."""
        return swing(self.left), swing(self.right)

    @cached_property
    def shortest(self) -> float:
        """The smallest N for which waves are used; infinite where none is.

        Springs corrected from both ends must not overlap, and κ + Φ must grow with q.
        """
        descent = self.swings[0].descent + self.swings[1].descent
        if descent == math.inf:
            return math.inf
        return max(SHORT, len(self.corrections) + 3, math.ceil(1.25 * descent))

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
        """Return which chains have that mode, and springs that are all positive."""
        found = mode <= segments + self.surplus
        for constant, per_segment in self._doubtful_weights:
            found = found & (constant + per_segment / segments > 0)
        return found

    @cached_property
    def _doubtful_weights(self) -> list[tuple[float, float]]:
        """Corrected weights that some chain may have negative."""
        return [
            (float(weight.constant), float(weight.per_segment))
            for weight in self.corrections
            if weight.per_segment or weight.constant <= 0
        ]

    def in_band(self, segments: Floats, mode: Floats) -> NDArray[np.bool_]:
        """Return which modes waves give: those of long enough chains, but for the last few."""
        found = segments >= self.shortest
        doubtful = np.flatnonzero(found & (mode > segments - SHORT))
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
        """Return Φ - Φ⁰, continuous in q."""
        first, second = self.swings
        return phase(self.left, left, q, first.middle) + phase(self.right, right, q, second.middle)

    def evanescence(self, s: Any) -> Any:
        """Return χ of sinh²(χ/2) = s²/(1 - p s²)."""
        return 2.0 * np.arcsinh(s / np.sqrt(1.0 - self.p * s * s))

    def omega(self, s: Any) -> Any:
        """Return ω = 4 s²/√(1 - p s²), in units of √(EI / (ρA ell⁴))."""
        return 4.0 * s * s / np.sqrt(1.0 - self.p * s * s)

    def wavenumbers(self, mode: Floats) -> Floats:
        """Return the exact beam's β."""
        return np.asarray(wavenumber_of_code(self.code, mode.astype(np.int64)))


@lru_cache(maxsize=1024)
def chains_of(rule: Rule, code: int) -> UniformChains:
    """Return the chains of a pair of ends, an index into `ends.BOUNDARIES`, under `rule`.

    Examples
    --------
    >>> from beammodes.chains.rules import rule_named
    >>> chains_of(rule_named("rigid_stub"), 3).surplus             # clamped-free: N - 1 hinges
    -1
    """
    return UniformChains(code, rule)


#: Largest number of segments: what the accuracy of frequencies and errors has been measured up to.
MAX_SEGMENTS = 10**9
#: Largest mode number, that of `exact_beam.wavenumber`.
MAX_MODE = 10**12
# Elements that one pass of a kernel takes: its temporary arrays then fit a cache.
_BLOCK = 1 << 14


Rules = RuleLike | Iterable[RuleLike] | NDArray[Any]


Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


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
    if isinstance(boundary, (str, Boundary)) and isinstance(rule, (str, Rule)):
        chains = _chains_between(boundary, rule)
        if isinstance(segments, (int, np.integer)) and isinstance(mode, (int, np.integer)):
            count = whole_number("segments", segments, most=MAX_SEGMENTS)
            one = whole_number("mode", mode, most=MAX_MODE)
            return _single(kernel, chains, float(count), float(one))
    codes = boundary_codes(boundary)
    records, chosen = distinct("rule", rule, (str, Rule), closed_rule)
    n, m = whole_numbers("segments", segments, most=MAX_SEGMENTS), whole_numbers("mode", mode, most=MAX_MODE)
    if not (codes.ndim or chosen.ndim or n.ndim or m.ndim):
        return _single(kernel, chains_of(records[0], int(codes)), float(n), float(m))
    codes, n, m, chosen = together(boundary=codes, segments=n, mode=m, rule=chosen)
    result = np.full(codes.size, np.nan)
    for which, code, at in _groups(chosen.ravel(), codes.ravel()):
        chains = chains_of(records[which], code)
        size, number = n.ravel()[at].astype(np.float64), m.ravel()[at].astype(np.float64)
        found = np.flatnonzero(chains.exists(size, number))
        if len(found):
            result[at[found]] = kernel(chains, size[found], number[found])
    return result.reshape(codes.shape)


@lru_cache(maxsize=4096)
def _chains_between(boundary: str | Boundary, rule: RuleLike) -> UniformChains:
    """Return the chains of one boundary under one rule, both read once."""
    return chains_of(closed_rule(rule), boundary_code(boundary))


def _single(
    kernel: Callable[[UniformChains, Any, Any], Any], chains: UniformChains, segments: float, mode: float
) -> float:
    if not chains.exists(segments, mode):
        return math.nan
    found = kernel(chains, segments, mode)
    return found if type(found) is float else float(np.squeeze(found))


def _groups(chosen: NDArray[np.intp], codes: NDArray[np.intp]) -> Iterable[tuple[int, int, NDArray[np.intp]]]:
    """Yield rule, boundary and the indices of at most `_BLOCK` elements that share them."""
    key = chosen * len(BOUNDARIES) + codes
    # Small integers are sorted by their digits, in a tenth of the time.
    order = np.argsort(key.astype(np.min_scalar_type(key.max(initial=0))), kind="stable")
    for start, stop in pairwise([*np.flatnonzero(np.diff(key[order], prepend=-1)), key.size]):
        which, code = divmod(int(key[order[start]]), len(BOUNDARIES))
        for first in range(start, stop, _BLOCK):
            yield which, code, order[first : min(first + _BLOCK, stop)]
