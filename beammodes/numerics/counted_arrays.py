"""Roots of many equations at once, or of one in plain floats, by counts of their roots below a place."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats

__all__ = ["CountedRoot", "CountedRoots", "counted_root", "counted_roots"]

#: From equations, by their indices, and a place above zero in each: the function there, and how many of its
#: roots lie below. The function may have any smooth factor without roots, and changes sign at each root.
Evaluate = Callable[[NDArray[np.intp], Floats], tuple[Floats, Floats]]

# Samples after which an equation is given up; steps as small as this, relatively, are the last.
_MOST, _LAST = 80, 3e-8


class CountedRoots(NamedTuple):
    """Roots to some nine digits, two places beside each with the function's values, and what is proved."""

    root: Floats
    place: Floats
    value: Floats
    farther: Floats
    value_farther: Floats
    proved: NDArray[np.bool_]


class CountedRoot(NamedTuple):
    """`CountedRoots` of one equation."""

    root: float
    place: float
    value: float
    farther: float
    value_farther: float
    proved: bool


def counted_roots(evaluate: Evaluate, number: Floats, start: Floats, reach: Floats) -> CountedRoots:
    """Return from each equation the root of that number, from 1, looked for from `start` in steps of `reach`.

    For equations of which nothing but counts and values is known: `counted_secants` need a bracket and a
    phase besides, and leave the proof to their callers.

    Counts on either side prove a root to be alone and to have its number, whatever lies between the places
    sampled. Where counts and signs contradict each other, or roots lie too close together, it is not proved.

    Examples
    --------
    >>> def evaluate(which, x):
    ...     return np.sin(np.pi * x), np.floor(x)
    >>> counted_roots(evaluate, np.array([1.0, 7.0]), np.array([5.0, 5.2]), np.ones(2)).root.round(6)
    array([1., 7.])
    """
    size = len(number)
    none = np.full((5, size), np.nan)
    found = CountedRoots(none[0], none[1], none[2], none[3], none[4], np.zeros(size, dtype=bool))
    which, x, zero = np.arange(size), start.copy(), np.zeros(size)
    # Bracket, the function and the count at its ends; the end given up last; whether it has been refined.
    low, high, f_low, f_high = zero, np.full(size, np.inf), zero, zero
    n_low, n_high, refined = zero, np.full(size, np.inf), np.zeros(size, dtype=bool)
    for _ in range(_MOST):
        f, below = evaluate(which, x)
        under = below < number
        old, f_old = np.where(under, low, high), np.where(under, f_low, f_high)
        low, f_low, n_low = np.where(under, x, low), np.where(under, f, f_low), np.where(under, below, n_low)
        high, f_high = np.where(under, high, x), np.where(under, f_high, f)
        n_high = np.where(under, n_high, below)
        alone = (n_low == number - 1.0) & (n_high == number) & (low > 0.0)
        other, f_other = np.where(under, high, low), np.where(under, f_high, f_low)
        if alone.all():
            new = _refined(x, f, other, f_other, old, f_old, refined=refined)
        else:
            new = _isolating(number, low, n_low, high, n_high, reach)
            reach = 4.0 * reach
            at = np.flatnonzero(alone)
            if len(at):
                points = (each[at] for each in (x, f, other, f_other, old, f_old))
                new[at] = _refined(*points, refined=refined[at])
        done = alone & (np.abs(new - x) <= _LAST * x)
        if done.any():
            at = which[done]
            near = np.abs(old - x) < np.abs(other - x)
            far, f_far = np.where(near, old, other), np.where(near, f_old, f_other)
            for column, values in zip(found, (new, x, f, far, f_far), strict=False):
                column[at] = values[done]
            found.proved[at] = ((f_low < 0.0) != (f_high < 0.0))[done]
        refined, x = alone, new
        left = ~done & np.isfinite(new)
        if not left.all():
            state = (which, number, x, low, high, f_low, f_high, n_low, n_high, refined, reach)
            which, number, x, low, high, f_low, f_high, n_low, n_high, refined, reach = (
                each[left] for each in state
            )
        if not len(which):
            break
    return found


def _isolating(
    number: Floats, low: Floats, n_low: Floats, high: Floats, n_high: Floats, reach: Floats
) -> Floats:
    """Return where to sample next to tell a root from its neighbours."""
    with np.errstate(all="ignore"):
        far = np.maximum(1.0, number - 0.5 - n_low)
        upward = low + np.minimum(reach * far, low * (0.25 + far))
        downward = np.maximum(high - reach * np.maximum(1.0, n_high - number + 0.5), 0.4 * high)
        between = low + (high - low) * (number - 0.5 - n_low) / (n_high - n_low)
        between = np.where(high > 3.0 * low, np.sqrt(low * high), between)
    return np.where(np.isinf(high), upward, np.where(low > 0.0, between, downward))


def _refined(
    x: Floats,
    f: Floats,
    b: Floats,
    f_b: Floats,
    c: Floats,
    f_c: Floats,
    *,
    refined: NDArray[np.bool_],
) -> Floats:
    """Return the next place between x and b: by inverse interpolation through c, too, else halfway.

    By a secant where the bracket has only just been found.
    """
    with np.errstate(all="ignore"):
        # Chandrupatla's criterion (Advances in Engineering Software 28, 1997).
        along, rise = (x - b) / (c - b), (f - f_b) / (f_c - f_b)
        safe = (rise**2 < along) & ((1.0 - rise) ** 2 < 1.0 - along)
        side = f_b - f
        inverse = f / side * f_c / (f_b - f_c) + (c - x) / (b - x) * f / (f_c - f) * f_b / (f_c - f_b)
        fraction = np.where(safe, inverse, np.where(refined, 0.5, -f / side))
        least = 0.1 * _LAST * x / np.abs(b - x)
        fraction = np.where(np.isfinite(fraction), fraction, 0.5)
        fraction = np.minimum(np.maximum(fraction, least), 1.0 - least)
    return x + fraction * (b - x)


def counted_root(
    evaluate: Callable[[float], tuple[float, float]], number: int, start: float, reach: float
) -> CountedRoot:
    """Return what `counted_roots` does from one equation, in plain floats.

    Examples
    --------
    >>> root = counted_root(lambda x: (math.sin(math.pi * x), math.floor(x)), 7, 5.2, 1.0)
    >>> round(root.root, 6), root.proved
    (7.0, True)
    """
    low, f_low, n_low, high, f_high, n_high = 0.0, 0.0, 0.0, math.inf, 0.0, math.inf
    x, refined = start, False
    for _ in range(_MOST):
        f, below = evaluate(x)
        if below < number:
            c, f_c, low, f_low, n_low, b, f_b = low, f_low, x, f, below, high, f_high
        else:
            c, f_c, high, f_high, n_high, b, f_b = high, f_high, x, f, below, low, f_low
        if n_low != number - 1 or n_high != number or not low:
            x, reach = _isolating_one(number, low, n_low, high, n_high, reach), 4.0 * reach
            continue
        new = _refined_one(x, f, b, f_b, c, f_c, refined)
        if abs(new - x) <= _LAST * x:
            near, f_near = (c, f_c) if abs(c - x) < abs(b - x) else (b, f_b)
            return CountedRoot(new, x, f, near, f_near, (f_low < 0.0) != (f_high < 0.0))
        x, refined = new, True
    return CountedRoot(math.nan, math.nan, math.nan, math.nan, math.nan, False)


def _isolating_one(number: int, low: float, n_low: float, high: float, n_high: float, reach: float) -> float:
    if high == math.inf:
        far = max(1.0, number - 0.5 - n_low)
        return low + min(reach * far, low * (0.25 + far))
    if not low:
        return max(high - reach * max(1.0, n_high - number + 0.5), 0.4 * high)
    if high > 3.0 * low:
        return math.sqrt(low * high)
    return low + (high - low) * (number - 0.5 - n_low) / (n_high - n_low)


def _refined_one(x: float, f: float, b: float, f_b: float, c: float, f_c: float, refined: bool) -> float:
    fraction = 0.5 if refined or f == f_b else f / (f - f_b)
    if math.isfinite(c) and f not in (f_b, f_c) and f_b != f_c:
        along, rise = (x - b) / (c - b), (f - f_b) / (f_c - f_b)
        if rise**2 < along and (1.0 - rise) ** 2 < 1.0 - along:
            fraction = f / (f_b - f) * f_c / (f_b - f_c)
            fraction += (c - x) / (b - x) * f / (f_c - f) * f_b / (f_c - f_b)
    least = 0.1 * _LAST * x / abs(b - x)
    return x + min(max(fraction, least), 1.0 - least) * (b - x)
