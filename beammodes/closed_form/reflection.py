"""How an end reflects the wave of a uniform chain, and what both ends' exponentials do to each other."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from beammodes.closed_form.waves import EndWaves, Minors

__all__ = ["SHORT", "Swing", "amplitude", "exchange", "phase", "swing"]

#: Shorter chains are cheap in exact arithmetic.
SHORT = 8


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


def exchange(kappa: Any, decay: Any, left: Minors, right: Minors) -> Any:
    """Return X of the equation at the head of `dispersion`; E = e^(-decay).

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
    """Measure an end's phase on a grid over the band, for long chains and for short ones."""
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
