"""A row of equal rods between two ends, in closed form and to all digits of floats, however long or slow.

A row of n rods (length, mass and hinge stiffness 1; r the central rotary inertia of a rod, t the tension) is
cut at both ends in the middle of a hinge. `supported_chain` derives its stiffness: with x = sin²(q/2) of the
oscillating and X = sinh²(χ/2) of the evanescent wave, w = ω²,

    x X = w/16,    X - x = t/4 + (1 - 4r) x X,

in symmetric and in antisymmetric motion, 4/σ [α β; β γ], its determinant being 16 δ/σ. Here the five carry
factors of their own that leave nothing to divide by and nothing to overflow: with a = nq/2 and h = nχ/2,

         symmetric,                           antisymmetric,
         times cos a cosh h                   times sin a sinh h / (sin q sinh χ)

    σ    A + B                                C - D                  A = sinh χ sinh h cos a
    γ    (x + X) cos a cosh h                 (x + X) (sin a / sin q) (sinh h / sinh χ)
    α    -(x + X) sin q sin a sinh χ sinh h   (x + X) cos a cosh h   B = sin q sin a cosh h
    β    x A - X B                            x C + X D              C = cosh h sin a / sin q
    δ    -x² A - X² B                         -x² C + X² D           D = sinh h cos a / sinh χ

all times e^-h. Slow motion (a and h small) cancels in three of them, σ and δ of antisymmetric and β of
symmetric motion; there they are sums of what their factors have beyond one.

Both planes of an end and the row together make the chain's determinant, bilinear in the two planes. Its
minors with the right cut held, wholly or in part, come along; their signs tell how many modes lie below w.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from beammodes.closed_form.end_planes import Plane
from beammodes.numerics.arrays import OF_ARRAYS, OF_FLOATS, Elementary

__all__ = ["Row", "joined", "row"]


class Row(NamedTuple):
    """σ, α, β, γ, δ of symmetric and of antisymmetric motion, and the modes below w with both cuts held."""

    symmetric: tuple[Any, Any, Any, Any, Any]
    antisymmetric: tuple[Any, Any, Any, Any, Any]
    clamped: Any


class _Oscillation(NamedTuple):
    """The oscillating wave; the same cos a twice, but for a wave that alternates, beyond the band."""

    cos: Any
    sin_times: Any  # sin q sin a
    sin_over: Any  # sin a / sin q
    cos_too: Any
    q: Any
    angle: Any  # a
    pinned: Any  # modes of the pinned row below


def waves(square: Any, p: Any, tension: Any, of: Elementary) -> tuple[Any, Any]:
    """Return x and X at w = `square` > 0; p = 1 - 4r.

    Examples
    --------
    >>> x, evanescent = waves(1.0, 1.0, 0.0, OF_FLOATS)
    >>> round(16 * x * evanescent, 15), round(16 * x * x + x, 15)            # w, and 16 x² = w (1 - x)
    (1.0, 1.0)
    """
    middle = 4.0 * tension + p * square
    size = of.sqrt(middle * middle + 64.0 * square) + abs(middle)
    small, large = 2.0 * square / size, size / 32.0
    if of is OF_FLOATS:
        return (small, large) if middle > 0.0 else (large, small)
    slow = middle > 0.0
    return np.where(slow, small, large), np.where(slow, large, small)


def row(
    square: Any, p: Any, tension: Any, rods: Any, of: Elementary = OF_ARRAYS, *, sizes: bool = False
) -> Row:
    """Return a row of `rods` > 1 at w = `square` > 0.

    With `sizes` the sums of the absolute values of their terms instead.

    Examples
    --------
    >>> row(2e-8, 2 / 3, 0.0, 1000.0, OF_FLOATS).clamped    # qn = 4.73, 7.85, 11.0, 14.1 of a beam; here 11.9
    3
    """
    x, decaying = waves(square, p, tension, of)
    wave, root = _oscillation(x, rods, of), of.sqrt(decaying)
    cos, sin_times, sin_over, cos_too = wave[:4]
    chi, sinh = 2.0 * of.arcsinh(root), 2.0 * root * of.sqrt(1.0 + decaying)
    growth = 0.5 * rods * chi
    fade = of.exp(-2.0 * growth)
    cosh_end, sinh_end = 0.5 + 0.5 * fade, -0.5 * of.expm1(-2.0 * growth)
    minus = -1.0
    if sizes:
        minus = 1.0
        cos, sin_times, sin_over, cos_too = (abs(each) for each in wave[:4])
    grown, over = sinh_end * sinh, sinh_end / sinh
    gamma = x + decaying
    first, second = grown * cos, sin_times * cosh_end
    third, fourth = cosh_end * sin_over, over * cos_too
    sigma, beta = first + second, x * first + minus * decaying * second
    sigma_too, square_x, square_decaying = third + minus * fourth, x * x, decaying * decaying
    delta_too = minus * square_x * third + square_decaying * fourth
    slow = (wave.angle < 1.0) & (growth < 1.0) & (x < 1.0)
    if of is OF_FLOATS:
        if slow:
            sigma_too, beta = _slow(wave, chi, growth, x, decaying, rods, of)
    elif slow.any():
        at = np.flatnonzero(slow)
        picked = _Oscillation(*(each[at] for each in wave))
        sigma_too[at], beta[at] = _slow(picked, chi[at], growth[at], x[at], decaying[at], rods[at], of)
    excess = 0.25 * tension + p * x * decaying  # X - x
    if sizes:
        sigma_too, beta, excess = abs(sigma_too), abs(beta), abs(excess)
    slow_delta = minus * square_x * sigma_too + excess * gamma * fourth
    if of is OF_FLOATS:
        delta_too = slow_delta if slow else delta_too
        clamped = wave.pinned - (sigma * cos < 0.0) - (sigma_too * sin_over < 0.0)
    else:
        delta_too = np.where(slow, slow_delta, delta_too)
        clamped = wave.pinned - ((sigma * cos < 0.0) + 1.0 * (sigma_too * sin_over < 0.0))
    return Row(
        (
            sigma,
            minus * gamma * sin_times * grown,
            beta,
            gamma * cos * cosh_end,
            minus * (square_x * first + square_decaying * second),
        ),
        (
            sigma_too,
            gamma * cos_too * cosh_end,
            x * third + decaying * fourth,
            gamma * sin_over * over,
            delta_too,
        ),
        clamped,
    )


def _oscillation(x: Any, rods: Any, of: Elementary) -> _Oscillation:
    if of is OF_FLOATS:
        return _within(x, rods, of) if x < 1.0 else _beyond(x, rods, of)
    beyond = np.flatnonzero(x >= 1.0)
    wave = _within(np.minimum(x, 0.5) if len(beyond) == len(x) else np.where(x < 1.0, x, 0.5), rods, of)
    if len(beyond):
        for column, values in zip(wave, _beyond(x[beyond], rods[beyond], of), strict=True):
            column[beyond] = values
    return wave


def _within(x: Any, rods: Any, of: Elementary) -> _Oscillation:
    root = of.sqrt(x)
    q, sin_q = 2.0 * of.arcsin(root), 2.0 * root * of.sqrt(1.0 - x)
    angle = 0.5 * rods * q
    cos, sin = of.cos(angle), of.sin(angle)
    # The sign of sin nq says whether k is even: so a rounded angle is enough to know k = ⌊nq/π⌋.
    odd = sin * cos < 0.0
    if of is OF_FLOATS:
        pinned = 2 * round(angle / math.pi - 0.25 - 0.5 * odd) + odd
        return _Oscillation(cos, sin_q * sin, sin / sin_q, cos, q, angle, pinned)
    pinned = 2.0 * np.rint(angle / math.pi - 0.25 - 0.5 * odd) + odd
    return _Oscillation(cos, sin_q * sin, sin / sin_q, cos.copy(), q, angle, pinned)


def _beyond(x: Any, rods: Any, of: Elementary) -> _Oscillation:
    """Return the wave of q = π + iσ, over e^(nσ/2) and the sign that it shares with its neighbours."""
    sinh_q = 2.0 * of.sqrt(x * (x - 1.0))
    growth = rods * of.arcsinh(of.sqrt(x - 1.0))
    fade = of.exp(-2.0 * growth)
    cosh, sinh = 0.5 + 0.5 * fade, -0.5 * of.expm1(-2.0 * growth)
    none = 0.0 * x
    if of is OF_FLOATS:
        if rods % 2:
            return _Oscillation(sinh, sinh_q * cosh, cosh / sinh_q, -sinh, none, none, rods - 1.0)
        return _Oscillation(cosh, sinh_q * sinh, -sinh / sinh_q, cosh, none, none, rods - 1.0)
    odd = rods % 2 == 1
    one, other = np.where(odd, sinh, cosh), np.where(odd, cosh, sinh)
    sign = np.where(odd, 1.0, -1.0)
    return _Oscillation(one, sinh_q * other, sign * other / sinh_q, -sign * one, none, none, rods - 1.0)


def _slow(
    wave: _Oscillation, chi: Any, growth: Any, x: Any, decaying: Any, rods: Any, of: Elementary
) -> tuple[Any, Any]:
    """Return σ of antisymmetric and β of symmetric motion where their terms nearly cancel, for a, h < 1."""
    q, angle = wave.q, wave.angle
    cos, cosh = -2.0 * of.sin(0.5 * angle) ** 2, 2.0 * _sinh(0.5 * growth, of) ** 2
    sin, sinh = _excess(-angle * angle), _excess(growth * growth)
    # q/sin q and χ/sinh χ, then (q/2)/tan(q/2) and (χ/2)/tanh(χ/2), all less one.
    sin_q, sinh_chi = _excess(-q * q), _excess(chi * chi)
    sin_q, sinh_chi = -sin_q / (1.0 + sin_q), -sinh_chi / (1.0 + sinh_chi)
    tan_q, tanh_chi = sin_q - x - x * sin_q, sinh_chi + decaying + decaying * sinh_chi
    fade = rods * of.exp(-growth)
    sigma = 0.5 * fade * (_together(cosh, sin, sin_q) - _together(sinh, cos, sinh_chi))
    beta = 2.0 * fade * x * decaying * (_together(sinh, cos, tanh_chi) - _together(sin, cosh, tan_q))
    return sigma, beta


def _sinh(y: Any, of: Elementary) -> Any:
    grown = of.expm1(y)
    return 0.5 * (grown + grown / (grown + 1.0))


def _excess(z: Any) -> Any:
    """Return sinh √z / √z - 1, of -z sin √z / √z - 1, for |z| ≤ 1."""
    total = 0.0 * z
    for k in range(11, 0, -1):
        total = (total + 1.0) * (z / (2 * k * (2 * k + 1)))
    return total


def _together(a: Any, b: Any, c: Any) -> Any:
    """Return (1 + a)(1 + b)(1 + c) - 1."""
    both = a + b + a * b
    return both + c + both * c


def joined(left: Plane, right: Plane, between: Row, minus: float = -1.0) -> tuple[Any, Any, Any, Any]:
    """Return the determinant of two planes with a row between them, and its first three minors.

    They are those with, at the right cut, both quantities held, then the rotation; and with the rotation held
    at the left cut, and both at the right. With `minus` = 1 all terms are added: for absolute values.
    """
    (s, a, b, g, e), (s2, a2, b2, g2, e2) = between.symmetric, between.antisymmetric
    d, yy, yt, tt, det = left
    d_r, yy_r, yt_r, tt_r, det_r = right
    d, d_r, det, det_r = 4.0 * d, 4.0 * d_r, 0.25 * det, 0.25 * det_r
    turned, both, crossed = s2 * e + s * e2, g * a2 + g2 * a, 2.0 * b * b2
    held = s * s2
    y_held, t_held, x_held = 0.5 * (g * s2 + g2 * s), 0.5 * (a * s2 + a2 * s), minus * (b * s2 + b2 * s)
    free, y_free, t_free, x_free = (
        e * e2,
        0.5 * (e2 * g + e * g2),
        0.5 * (e2 * a + e * a2),
        minus * (e2 * b + e * b2),
    )
    yx, tx, yt_of = minus * (g * b2 + g2 * b), minus * (a * b2 + a2 * b), 0.25 * (turned + both + crossed)
    free_held = 0.25 * (turned + both + minus * crossed)
    xx = crossed + 0.5 * (both + crossed + minus * turned)
    of_det = det * held + yy * y_held + tt * t_held + yt * x_held + d * free_held
    of_tt = det * t_held + yy * yt_of + tt * (a * a2) + yt * tx + d * t_free
    of_yy = det * y_held + yy * (g * g2) + tt * yt_of + yt * yx + d * y_free
    of_yt = det * x_held + yy * yx + tt * tx + yt * xx + d * x_free
    of_d = det * free_held + yy * y_free + tt * t_free + yt * x_free + d * free
    value = of_det * det_r + of_yy * yy_r + of_tt * tt_r + of_yt * yt_r + of_d * d_r
    return value, of_det, of_tt * d_r + of_det * yy_r, d * t_held + yy * held
