"""Columns in which neighbours repeat: the same results as entry by entry, with fewer calls."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beammodes.chains.pieces import each_once, floats

RUNS = st.lists(st.tuples(st.fractions(-9, 9), st.integers(1, 50)), min_size=1, max_size=12)


def column(runs: list[tuple[Fraction, int]]) -> list[Fraction]:
    return [value for value, length in runs for _ in range(length)]


@given(RUNS)
def test_results_are_those_of_every_entry(runs: list[tuple[Fraction, int]]) -> None:
    values, calls = column(runs), []
    squares = each_once(lambda a, b: calls.append(a) or a * b, values, values)
    assert squares == [value**2 for value in values]
    assert len(calls) <= len(runs)
    assert floats(values).tolist() == [float(value) for value in values]


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 1000])
def test_entries_that_do_not_repeat(count: int) -> None:
    values = [Fraction(i, 7) for i in range(count)]
    assert each_once(lambda value: value + 1, values) == [Fraction(i + 7, 7) for i in range(count)]
    assert np.array_equal(floats(values), np.arange(count) / 7)


def test_equal_numbers_of_different_kinds_stay_apart() -> None:
    # 1.0 == Fraction(1) and both hash alike, but only one of them is exact.
    kinds = each_once(type, [Fraction(1)] * 70 + [1.0] * 70)
    assert kinds == [Fraction] * 70 + [float] * 70


@pytest.mark.parametrize("count", [3, 100])
@pytest.mark.parametrize("more", [-1, 1])
def test_columns_must_be_as_long_as_each_other(count: int, more: int) -> None:
    with pytest.raises(ValueError, match=r"shorter|longer|broadcast"):
        each_once(lambda a, b: a + b, [1] * count, [1] * (count + more))
