"""Pairs of doubles as numbers of 32 digits, against mpmath in 100."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from beammodes.numerics.double_double import DoubleDouble, cosine_and_sine, decay

RANDOM = np.random.default_rng(20)
SIZES = 10.0 ** RANDOM.uniform(-6.0, 5.0, 200)


def pair(high: Any) -> DoubleDouble:
    return DoubleDouble.of(high) + high * RANDOM.uniform(-1e-17, 1e-17, len(high))


def long(number: DoubleDouble) -> list[Any]:
    return [mp.mpf(h) + mp.mpf(low) for h, low in zip(number.high.tolist(), number.low.tolist(), strict=True)]


A, B = pair(SIZES), pair(RANDOM.permutation(SIZES))

OPERATIONS: dict[str, tuple[Callable[[], DoubleDouble], Callable[[Any, Any], Any]]] = {
    "sum": (lambda: A + B, lambda a, b: a + b),
    "product": (lambda: A * B, lambda a, b: a * b),
    "product with a double": (lambda: A.high * B, lambda a, b: mp.mpf(float(a)) * b),
    "quotient": (lambda: A / B, lambda a, b: a / b),
    "reciprocal": (lambda: 1.0 / A, lambda a, _: 1 / a),
    "root": (lambda: A.sqrt(), lambda a, _: mp.sqrt(a)),
    "exponential": (lambda: decay(A.scaled(2.0**-8)), lambda a, _: mp.exp(-a / 256)),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_keep_31_digits(name: str) -> None:
    ours, theirs = OPERATIONS[name]
    with mp.workdps(100):
        for found, a, b in zip(long(ours()), long(A), long(B), strict=True):
            expected = theirs(a, b)
            assert abs(found - expected) <= 2e-31 * abs(expected)


def test_differences_are_right_to_31_digits_of_what_is_subtracted() -> None:
    with mp.workdps(100):
        for found, a in zip(long(A - A.high), long(A), strict=True):
            assert abs(found - (a - mp.mpf(float(a)))) <= 2e-31 * a
        for found, a, b in zip(long(A - B), long(A), long(B), strict=True):
            assert abs(found - (a - b)) <= 2e-31 * max(a, b)


def test_circular_functions_keep_31_digits_of_one() -> None:
    cosine, sine = cosine_and_sine(A)
    with mp.workdps(100):
        for c, s, a in zip(long(cosine), long(sine), long(A), strict=True):
            assert abs(c - mp.cos(a)) <= 1e-31 + 1e-32 * a
            assert abs(s - mp.sin(a)) <= 1e-31 + 1e-32 * a
