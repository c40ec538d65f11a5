"""Roots of a function that comes with a count of its roots: bracketed by the count, closed in by the sign."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import NamedTuple

__all__ = ["CLOSEST", "Counted", "roots_between"]


#: Relative width to which roots are closed in; roots closer than this are returned as one, as often.
CLOSEST = Decimal("1e-20")


# A bracket whose ends differ by more than this factor is halved in its logarithm before it is closed in.
_NARROW = 3


class Counted(NamedTuple):
    """A place above zero, how many roots lie below it, and a smooth function with a sign change at each."""

    place: Decimal
    below: int
    value: Decimal


Evaluate = Callable[[Decimal], Counted]


def roots_between(evaluate: Evaluate, low: Counted, high: Counted, most: int) -> list[Decimal]:
    """Return the roots between two places, ascending, as many as the counts say but at most so many.

    Examples
    --------
    >>> def evaluate(x):
    ...     return Counted(x, sum(x > root for root in (2, 9)), (x - 2) * (x - 9))
    >>> roots = roots_between(evaluate, evaluate(Decimal("0.001")), evaluate(Decimal(100)), 5)
    >>> [round(float(root), 15) for root in roots]
    [2.0, 9.0]
    """
    inside = min(high.below - low.below, most)
    if inside <= 0:
        return []
    if high.place - low.place <= CLOSEST * high.place:
        return [high.place] * inside
    if high.below - low.below == 1 and high.place < _NARROW * low.place:
        return [_closed_in(evaluate, low, high)]
    middle = evaluate((low.place * high.place).sqrt())
    lower = roots_between(evaluate, low, middle, most)
    return lower + roots_between(evaluate, middle, high, most - len(lower))


def _closed_in(evaluate: Evaluate, low: Counted, high: Counted) -> Decimal:
    """Return the one root, by inverse quadratic interpolation through the last three places.

    Steps keep half the final width off the bracket's ends, so that both come close; where values do not fall
    tenfold in three steps, or a step leaves the bracket, it is halved.
    """
    last = [low, high]
    while (span := high.place - low.place) > CLOSEST * high.place:
        least = CLOSEST * high.place / 2
        slow = len(last) % 3 == 0 and abs(last[-1].value) * 10 > abs(last[-3].value)
        step = span / 2 if slow else _interpolated(last[-3:]) - low.place
        inside = -least < step < span + least
        new = evaluate(low.place + (min(max(step, least), span - least) if inside else span / 2))
        if not new.value:
            return new.place
        last.append(new)
        low, high = (new, high) if new.below == low.below else (low, new)
    return (low.place + high.place) / 2


def _interpolated(samples: list[Counted]) -> Decimal:
    """Return where the inverse polynomial through two or three samples is zero; zero where there is none."""
    if len({sample.value for sample in samples}) < len(samples):
        return Decimal(0)
    *_, (b, _, fb), (c, _, fc) = samples
    slope = (b - c) / (fb - fc)
    if len(samples) == 2:
        return c - fc * slope
    a, _, fa = samples[0]
    return c - fc * slope + fc * fb * ((a - b) / (fa - fb) - slope) / (fa - fc)
