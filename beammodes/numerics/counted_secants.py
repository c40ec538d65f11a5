"""Roots, in doubles, of equations that come with a count of their roots: over arrays of them, or one.

The count of roots below a place brackets the one that is wanted, so that none is missed or taken for
another. A phase that rises by about π from root to root takes secants there in a few steps. Where it is no
guide, brackets are halved, by ratios, until they hold one root, and chords of the residual close in.

Its callers know such a phase and a bracket, and prove the root by a correction of their own; `counted_arrays`
is for those who know neither, and proves it by the counts on either side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats

__all__ = ["Equations", "Reading", "counted_root", "counted_roots"]

# So many equations at once stay in the processor's cache.
_BLOCK = 4096
# A step of this part of the place, or a residual of this part of its amplitude, is the last.
_CLOSE, _SMALL = 1e-8, 1e-11
# After so many steps secants of the phase give way to chords in brackets.
_PHASE_STEPS = 5
_MOST_STEPS = 60
# Halving goes no further down than by this ratio at once.
_DOWN = 64.0


class Reading(NamedTuple):
    """What an equation says at one place.

    Parameters
    ----------
    below : number
        How many roots lie below.
    residual : number
        A smooth function that is zero at the roots only.
    size : number
        Its amplitude, which is not zero.
    phase : number
        A function that is (k - 1) π to k π while k - 1 roots are below, best a straight line.
    slope : number
        Its slope, roughly.
    """

    below: Any
    residual: Any
    size: Any
    phase: Any
    slope: Any


class Equations(Protocol):
    """Equations, and of each the number, from 1, of the root that is wanted."""

    @property
    def number(self) -> Floats:
        """The root's number."""

    def at(self, place: Floats) -> Reading:
        """Return what each says at a place of its own."""

    def taken(self, index: NDArray[np.bool_] | slice) -> Self:
        """Return some of the equations."""

    def with_more(self, others: list[Self]) -> Self:
        """Return these equations and others behind them."""


E = TypeVar("E", bound=Equations)


class _Search(NamedTuple):
    """Brackets with residual and count at either end, the next place, the last one, and which end that is."""

    which: NDArray[np.int64]
    place: Floats
    low: Floats
    high: Floats
    low_size: Floats
    high_size: Floats
    low_count: Floats
    high_count: Floats
    side: Floats
    before: Floats
    error_before: Floats


def counted_roots(equations: E, start: Floats, low: Floats, high: Floats, floor: float) -> Floats:
    """Return roots to about 1e-10 of themselves; halving stops at `floor`.

    Parameters
    ----------
    equations : Equations
    start, low, high : ndarray
        Where to begin, and brackets; `low` may be zero.
    floor : float
        Roots below are not told from it.
    """
    found, none = start.copy(), np.zeros_like(start)
    start = np.where((start > low) & (start < high), start, 0.5 * (low + high))
    unknown = none - 1.0
    where = np.arange(len(start))
    whole = _Search(where, start, low, high, none, none, unknown, unknown, none, none, none)
    parts = [slice(i, i + _BLOCK) for i in range(0, len(start), _BLOCK)]
    pieces: list[tuple[E, _Search]] = [(equations.taken(part), _taken(whole, part)) for part in parts]
    for count in range(_MOST_STEPS):
        open_pieces = []
        for equation, search in pieces:
            search, done = _stepped(search, equation.at(search.place), equation.number, count, floor)
            found[search.which] = search.place
            if not done.any():
                open_pieces.append((equation, search))
            elif not done.all():
                still = ~done
                open_pieces.append((equation.taken(still), _taken(search, still)))
        pieces = _merged(open_pieces)
    return found


def _taken(search: _Search, index: NDArray[np.bool_] | slice) -> _Search:
    return _Search._make(column[index] for column in search)


def _merged(pieces: list[tuple[E, _Search]]) -> list[tuple[E, _Search]]:
    """Join neighbours while they are few."""
    merged: list[tuple[E, _Search]] = []
    waiting: list[tuple[E, _Search]] = []
    total = 0
    for piece in pieces:
        if waiting and total + len(piece[1].place) > _BLOCK:
            merged.append(_joined(waiting))
            waiting, total = [], 0
        waiting.append(piece)
        total += len(piece[1].place)
    return [*merged, _joined(waiting)] if waiting else merged


def _joined(pieces: list[tuple[E, _Search]]) -> tuple[E, _Search]:
    if len(pieces) == 1:
        return pieces[0]
    columns = zip(*(search for _, search in pieces), strict=True)
    first, *others = (equation for equation, _ in pieces)
    return first.with_more(others), _Search._make(np.concatenate(column) for column in columns)


def _stepped(
    s: _Search, now: Reading, number: Floats, count: int, floor: float
) -> tuple[_Search, NDArray[np.bool_]]:
    """Return the search with the next place, and where that is close enough.

    Chords in brackets of one root are those of Anderson and Björck (BIT 13, 1973).
    """
    size, error = np.abs(now.residual) / now.size, now.phase - math.pi * number
    above = now.below >= number
    side = np.where(above, 1.0, -1.0)
    low, high = np.where(above, s.low, s.place), np.where(above, s.place, s.high)
    low_count, high_count = np.where(above, s.low_count, now.below), np.where(above, now.below, s.high_count)
    with np.errstate(divide="ignore", invalid="ignore"):
        kept = 1.0 - size / np.where(above, s.high_size, s.low_size)
    kept = np.where(side == s.side, np.where(kept > 0.0, kept, 0.5), 1.0)
    low_size, high_size = np.where(above, s.low_size * kept, size), np.where(above, size, s.high_size * kept)
    if count < _PHASE_STEPS:
        rise, run = error - s.error_before, s.place - s.before
        rising = (rise * run > 0.0) & (count > 0)
        new = s.place - error * np.where(rising, run, 1.0) / np.where(rising, rise, now.slope)
        inside = (new > low) & (new < high)
    else:
        single = (low_count == number - 1.0) & (high_count == number) & (high < 2.0 * low)
        total = low_size + high_size
        new = (low * high_size + high * low_size) / np.where(total > 0.0, total, 1.0)
        inside = single & (total > 0.0)
    least = np.maximum(low, np.maximum(np.minimum(floor, 0.5 * high), high / _DOWN))
    middle = np.where(high > 2.0 * least, np.sqrt(least * high), 0.5 * (least + high))
    here = (size < _SMALL) & (np.abs(error) < 1.0)
    new = np.where(here, s.place, np.where(inside, new, middle))
    done = here | (inside & (np.abs(new - s.place) < _CLOSE * s.place)) | (high - low < _CLOSE * high)
    after = _Search(s.which, new, low, high, low_size, high_size, low_count, high_count, side, s.place, error)
    return after, done


def counted_root(
    read: Callable[[float], Reading], number: int, start: float, low: float, high: float, floor: float
) -> float:
    """Return one root to about 1e-10 of itself, as `counted_roots` does, without the cost of arrays.

    Examples
    --------
    >>> from math import ceil, pi, sin
    >>> def read(x):                                                # the second root of sin x, from x = 0
    ...     return Reading(max(0, ceil(x / pi) - 1), sin(x), 1.0, x, 1.0)
    >>> round(counted_root(read, 2, 5.0, 0.0, 9.0, 1e-5) / pi, 9)
    2.0
    """
    place = start if low < start < high else 0.5 * (low + high)
    low_size = high_size = before = error_before = 0.0
    low_count = high_count = -1
    last = None
    for count in range(_MOST_STEPS):
        below, residual, amplitude, phase, slope = read(place)
        size, error, above = abs(residual) / amplitude, phase - math.pi * number, below >= number
        if size < _SMALL and abs(error) < 1.0:
            break
        kept = 1.0
        if above is last:
            kept = 1.0 - size / (high_size if above else low_size)
            kept = kept if kept > 0.0 else 0.5
        last = above
        if above:
            high, high_size, high_count, low_size = place, size, below, low_size * kept
        else:
            low, low_size, low_count, high_size = place, size, below, high_size * kept
        if count < _PHASE_STEPS:
            rise, run = error - error_before, place - before
            new = place - (error * run / rise if count and rise * run > 0.0 else error / slope)
            inside = low < new < high
        else:
            inside = low_count == number - 1 and high_count == number and high < 2.0 * low
            new = (low * high_size + high * low_size) / (low_size + high_size) if inside else low
        if inside and abs(new - place) < _CLOSE * place:
            place = new
            break
        if high - low < _CLOSE * high:
            break
        if not inside:
            least = max(low, min(floor, 0.5 * high), high / _DOWN)
            new = math.sqrt(least * high) if high > 2.0 * least else 0.5 * (least + high)
        before, error_before, place = place, error, new
    return place
