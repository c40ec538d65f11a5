"""Roots, with proof that none is missed: of increasing functions, between sign changes, of polynomials."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from beammodes.numerics.arrays import Floats

__all__ = ["NotFollowed", "increasing_root", "polynomial_roots", "secants", "sign_changes"]


class NotFollowed(ArithmeticError):
    """Roots that this way does not tell apart or prove complete; counting them does."""


def increasing_root(
    function: Callable[[Floats], Floats], start: Floats, low: Floats, high: Floats, tolerance: Floats
) -> Floats:
    """Return roots of increasing functions, elementwise, by secants in brackets, then by bisection.

    Examples
    --------
    >>> low, high, digits = np.zeros(2), np.full(2, 3.0), np.full(2, 1e-15)
    >>> increasing_root(lambda x: x**2 - [1.0, 4.0], np.ones(2), low, high, digits).round(12)
    array([1., 2.])
    """
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


def secants(function: Callable[[Any], Any], old: Any, value: Any, new: Any, most: int) -> Any:
    """Return a root by at most so many secants: of single floats, or of arrays until all have settled.

    `value` is that at `old`, a first estimate; `new` is the next.

    Examples
    --------
    >>> round(secants(lambda x: x * x - 2.0, 1.0, -1.0, 2.0, 15), 12)
    1.414213562373
    """
    before = value
    for _ in range(most):
        value = function(new)
        rise, run = value - before, new - old
        step = -value * run / (rise + (rise == 0.0))
        old, before, new = new, value, new + step
        # Secants multiply errors: this step's error is about its square over the step before.
        close = step * step <= 1e-15 * abs(run * new)
        if close if isinstance(close, bool) else close.all():
            break
    return new


def sign_changes(function: Callable[[Floats], Floats], grid: Floats) -> Floats:
    """Return a root from every interval of the grid at whose ends the function differs in sign.

    Examples
    --------
    >>> (sign_changes(np.cos, np.arange(9.0)) / np.pi).round(12)
    array([0.5, 1.5, 2.5])
    """
    value = function(grid)
    at = np.flatnonzero(np.sign(value[1:]) * np.sign(value[:-1]) < 0.0)
    sign = np.sign(value[at + 1])
    low, high = grid[at], grid[at + 1]
    tolerance = 4e-16 * (1.0 + np.abs(low))
    return increasing_root(lambda w: sign * function(w), 0.5 * (low + high), low, high, tolerance)


def polynomial_roots(coefficients: list[Fraction], count: int) -> Floats:
    """Return the `count` positive roots of a polynomial to the last digit, and prove that they are all.

    Floats give a start, exact Newton steps bring it home, exact signs on either side confirm it.

    Examples
    --------
    >>> polynomial_roots([Fraction(6), Fraction(-5), Fraction(1)], 2)             # (x - 2) (x - 3)
    array([2., 3.])
    """
    scaled = np.array([float(c / coefficients[0]) for c in coefficients])
    starts = np.sort(1.0 / np.roots(scaled).real)
    roots = np.array([_polished(coefficients, float(start)) for start in starts])
    proved = len(roots) == count and bool(np.all(roots[1:] > roots[:-1] * (1.0 + 1e-9)))
    below, above = 1 - Fraction(1, 2**36), 1 + Fraction(1, 2**36)
    for root in map(Fraction, roots.tolist()):
        proved &= (_value(coefficients, root * below) > 0) != (_value(coefficients, root * above) > 0)
    if not proved:
        raise NotFollowed(f"roots of a characteristic polynomial of degree {count} were not separated")
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
