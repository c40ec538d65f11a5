"""Roots of an equation that comes with a count of its roots; counts of negative eigenvalues."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from typing import NamedTuple

__all__ = ["ROOT_DIGITS", "Sample", "inertia_and_determinant", "ordered_roots"]

#: Roots closer than this, relatively, are one double root: far below what a double can tell.
ROOT_DIGITS = 24
_CLOSE = Decimal(10) ** -ROOT_DIGITS


class Sample(NamedTuple):
    """A place above zero, how many roots lie below it, and a smooth function, zero at the roots only."""

    place: Decimal
    below: int
    value: Decimal


def ordered_roots(
    evaluate: Callable[[Decimal], Sample], low: Sample, high: Sample, most: int
) -> list[Decimal]:
    """Return at most so many roots between two places, ascending, a double root twice.

    Geometric bisection by the counts isolates each root within a factor of two, so that roots many
    decades apart cost no more than neighbours; the function's sign change then refines it. Where the
    equation is singular, `evaluate` may sample right beside the place.

    Examples
    --------
    >>> def evaluate(x):
    ...     return Sample(x, sum(x > root for root in (2, 9)), (x - 2) * (x - 9))
    >>> roots = ordered_roots(evaluate, evaluate(Decimal("0.001")), evaluate(Decimal(100)), 2)
    >>> [float(root) for root in roots]
    [2.0, 9.0]
    """
    found: list[Decimal] = []
    with localcontext() as context:
        context.prec = 3 * ROOT_DIGITS
        pending = [(low, high)]
        while pending and len(found) < most:
            left, right = pending.pop()
            inside = right.below - left.below
            if inside and right.place - left.place < _CLOSE * left.place:
                found += [right.place] * inside
            elif inside == 1 and right.place < 2 * left.place:
                found.append(_refined(evaluate, left, right))
            elif inside:
                middle = evaluate((left.place * right.place).sqrt())
                pending += [(middle, right), (left, middle)]
    return found[:most]


def _refined(evaluate: Callable[[Decimal], Sample], left: Sample, right: Sample) -> Decimal:
    """Return the one root between two samples (Chandrupatla, Advances in Engineering Software 28, 1997)."""
    if not left.value:
        # A root at the place itself is not below it.
        return left.place
    while not right.value:
        # So this is the next one's, and the sign there says nothing.
        middle = evaluate((left.place * right.place).sqrt())
        left, right = (middle, right) if middle.below == left.below else (left, middle)
        if not left.value:
            return left.place
    half = Decimal("0.5")
    new, opposite, fraction = left, right, half
    while True:
        trial = evaluate(new.place + fraction * (opposite.place - new.place))
        if (trial.value > 0) == (new.value > 0):
            new, old = trial, new
        else:
            new, opposite, old = trial, new, opposite
        best = min(new, opposite, key=lambda sample: abs(sample.value))
        width = abs(opposite.place - new.place)
        if not best.value or width < 2 * _CLOSE * best.place:
            return best.place
        least = _CLOSE * best.place / width
        fraction = min(max(_interpolated(new, opposite, old), least), 1 - least)


def _interpolated(new: Sample, opposite: Sample, old: Sample) -> Decimal:
    """Return the step towards `opposite` by inverse quadratic interpolation where safe, else one half."""
    (a, _, fa), (b, _, fb), (c, _, fc) = new, opposite, old
    along, rise = (a - b) / (c - b), (fa - fb) / (fc - fb)
    if rise**2 < along and (1 - rise) ** 2 < 1 - along:
        return fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    return Decimal("0.5")


def inertia_and_determinant(matrix: Sequence[Sequence[Decimal]]) -> tuple[int, Decimal]:
    """Return how many eigenvalues of a symmetric matrix are negative, and its determinant.

    By elimination (Sylvester's law of inertia), rows and columns exchanged together where a pivot is zero.
    Where the whole diagonal is, a tiny positive pivot makes its successor count right.

    Examples
    --------
    >>> none, two, three = Decimal(0), Decimal(2), Decimal(3)
    >>> inertia_and_determinant([[none, two, none], [two, three, two], [none, two, none]])[0]
    1
    """
    negative, determinant = 0, Decimal(1)
    rows: Sequence[Sequence[Decimal]] = matrix
    while rows:
        if not rows[0][0]:
            order = sorted(range(len(rows)), key=lambda i: not rows[i][i])
            rows = [[rows[i][j] for j in order] for i in order]
        (first, *right), *below = rows
        pivot = first or Decimal("1e-1000")
        negative += pivot < 0
        determinant *= pivot
        factors = [value / pivot for value in right]
        rows = [
            [value - factor * top for value, top in zip(row[1:], right, strict=True)]
            for factor, row in zip(factors, below, strict=True)
        ]
    return negative, determinant
