"""Argument checks: what passes, what is refused, and that messages name argument, value and limits."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beammodes.checks import (
    bounded,
    choice,
    positive_real,
    real,
    real_numbers,
    shown,
    whole_number,
    whole_numbers,
)

WORDS = ["clamped", "pinned", "guided", "free"]

anything = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.complex_numbers(), st.text(), st.binary(),
    st.lists(st.integers()), st.fractions(), st.decimals(), st.just(object()), st.just(10**5000),
)  # fmt: skip


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2.5, "2.5"),
        ("six", "'six'"),
        (None, "None"),
        (-3, "-3"),
        (10**400, "an integer of about 10**400"),
        (10**5000, "an integer of about 10**5000"),
        (np.float64(0.5), repr(np.float64(0.5))),
    ],
    ids=["float", "word", "none", "negative", "400 digits", "5000 digits", "numpy"],
)
def test_shown(value: object, text: str) -> None:
    assert shown(value) == text


@given(anything)
def test_shown_is_one_short_line(value: object) -> None:
    text = shown(value)
    assert text
    assert "\n" not in text
    assert len(text) <= 60


def test_shown_flattens_and_shortens_arrays() -> None:
    text = shown(np.arange(1000.0).reshape(10, 100))
    assert text.startswith("array([[")
    assert text.endswith("...")
    assert len(text) == 60


@pytest.mark.parametrize("value", [3, 3.0, Fraction(3), np.int64(3), np.float32(3), np.float64(3)])
def test_real_numbers_become_floats(value: object) -> None:
    for check in (real, positive_real):
        number = check("length", value)
        assert type(number) is float
        assert number == 3.0


@pytest.mark.parametrize("value", [True, "3", None, 3j, [3.0], np.array([3.0]), np.bool_(True), b"3"])
def test_what_is_no_real_number(value: object) -> None:
    for check in (real, positive_real):
        with pytest.raises(TypeError, match=r"^length must be a real number, got ") as info:
            check("length", value)
        assert shown(value) in str(info.value)


@pytest.mark.parametrize("unit", ["ns", "s", "D"])
def test_spans_of_time_are_no_numbers(unit: str) -> None:
    # NumPy registers them as Integral, and those in nanoseconds turn into ints.
    span = np.timedelta64(5, unit)
    for value in (span, np.array(span), [span], np.array([span, span])):
        for check in (real, whole_number, real_numbers, lambda *pair: whole_numbers(*pair, most=9)):
            with pytest.raises(TypeError, match=r"^length must be "):
                check("length", value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400, -(10**400), Fraction(10**400)])
def test_what_is_not_finite(value: object) -> None:
    for check in (real, positive_real):
        with pytest.raises(ValueError, match=r"^length must be finite, got ") as info:
            check("length", value)
        assert shown(value) in str(info.value)


@pytest.mark.parametrize("value", [0, -0.0, -1.0, Fraction(-1, 3), np.float64(-2.0)])
def test_zero_and_below_are_real_but_not_positive(value: object) -> None:
    assert real("length", value) <= 0.0
    with pytest.raises(ValueError, match=r"^length must be greater than 0, got ") as info:
        positive_real("length", value)
    assert shown(value) in str(info.value)


@pytest.mark.parametrize("value", [6, np.int64(6), np.uint8(6)])
def test_whole_numbers_become_ints(value: object) -> None:
    number = whole_number("segments", value)
    assert type(number) is int
    assert number == 6


@pytest.mark.parametrize("value", [2.5, 6.0, "six", "6", None, True, math.nan, math.inf, Fraction(6), [6]])
def test_what_is_no_whole_number(value: object) -> None:
    with pytest.raises(TypeError, match=r"^segments must be a whole number of at least 1, got ") as info:
        whole_number("segments", value)
    assert shown(value) in str(info.value)


@pytest.mark.parametrize(
    ("value", "least", "most", "ok"),
    [
        (0, 1, None, False),
        (-3, 1, None, False),
        (1, 1, None, True),
        (10**400, 1, None, True),
        (4, 5, 7, False),
        (5, 5, 7, True),
        (7, 5, 7, True),
        (8, 5, 7, False),
        (10**400, 1, 7, False),
    ],
)
def test_range_of_whole_numbers(value: int, least: int, most: int | None, ok: bool) -> None:
    if ok:
        assert whole_number("mode", value, least=least, most=most) == value
        return
    with pytest.raises(ValueError, match=f"^mode must be a whole number of at least {least}") as info:
        whole_number("mode", value, least=least, most=most)
    assert f"got {shown(value)}" in str(info.value)
    assert most is None or f"at most {most}" in str(info.value)


@given(anything)
def test_checks_raise_nothing_else(value: object) -> None:
    for check in (real, positive_real, whole_number):
        try:
            accepted = check("name", value)
        except (TypeError, ValueError) as error:
            assert str(error).startswith("name must be ")  # noqa: PT017 - any other exception must surface
        else:
            assert accepted == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("word", WORDS)
def test_choice_returns_the_word(word: str) -> None:
    assert choice("end", word, WORDS) == word
    assert choice("end", word, dict.fromkeys(WORDS)) == word


@pytest.mark.parametrize(
    ("typed", "meant"), [("clampd", "clamped"), (" Pinned", "pinned"), ("freee", "free")]
)
def test_choice_offers_the_nearest_word(typed: str, meant: str) -> None:
    with pytest.raises(ValueError, match=r"^end must be one of clamped, pinned, guided, free, got ") as info:
        choice("end", typed, WORDS)
    assert repr(typed) in str(info.value)
    assert f'did you mean "{meant}"?' in str(info.value)


def test_choice_offers_nothing_for_nonsense() -> None:
    with pytest.raises(ValueError, match=r"got 'qqqq'$"):
        choice("end", "qqqq", WORDS)


@pytest.mark.parametrize("value", [None, 3, ["free"], b"free"])
def test_choice_refuses_other_types(value: object) -> None:
    with pytest.raises(TypeError, match=r"^end must be one of clamped, pinned, guided, free, got "):
        choice("end", value, WORDS)


def test_lists_are_read_up_to_ten_million_values() -> None:
    with pytest.raises(ValueError, match="loads must have at most 10000000 values, got more"):
        bounded("loads", itertools.count())
