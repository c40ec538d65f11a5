"""The last modes of a uniform chain: those next to the band's edge q = π and those above it."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.closed_form.roots import NotFollowed, sign_changes
from beammodes.closed_form.uniform import UniformChains

__all__ = ["edge_frequencies"]

Floats = NDArray[np.float64]


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
