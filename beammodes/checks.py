"""Argument checks whose messages name the argument, the value received and what is allowed."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Iterable

__all__ = ["choice", "positive_real", "real", "row_shown", "shown", "small_fraction", "whole_number"]

_SHOWN_CHARACTERS = 60
_SHOWN_NUMBERS = 6


def shown(value: object) -> str:
    """Return `value` as an error message may carry it: one line, never longer than a screen line."""
    if isinstance(value, int) and value.bit_length() > 200:
        sign = "-" if value < 0 else ""
        return f"an integer of about {sign}10**{int(value.bit_length() * math.log10(2))}"
    try:
        text = repr(value).replace("\n", " ")
    except ValueError:
        # Python refuses to print integers of more than 4300 digits, also inside other values.
        text = f"a {type(value).__name__} of very many digits"
    return text if len(text) <= _SHOWN_CHARACTERS else text[: _SHOWN_CHARACTERS - 3] + "..."


def row_shown(values: Iterable[float], form: str, unit: str) -> str:
    """Return the first six of some numbers in a row with their unit, as results are printed.

    Examples
    --------
    >>> row_shown([4.5504, 28.515, 79.843], "{:.4g}", "Hz")
    '4.55, 28.52, 79.84 Hz'
    """
    listed = [float(value) for value in values]
    more = f", ... ({len(listed)} in all)" if len(listed) > _SHOWN_NUMBERS else ""
    return f"{', '.join(map(form.format, listed[:_SHOWN_NUMBERS])) or 'none'} {unit}{more}"


def real(name: str, value: object) -> float:
    """Return `value` as a finite float.

    Raises
    ------
    TypeError
        If `value` is not a real number (a bool or a string is not).
    ValueError
        If it is not finite, or too large for a float.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a real number, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return number


def positive_real(name: str, value: object) -> float:
    """Return `value` as a finite float above zero; raises as `real` does."""
    number = real(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} must be greater than 0, got {shown(value)}")
    return number


def small_fraction(name: str, value: object) -> float:
    """Return a tolerance as a float above zero and below one half.

    A frequency that is wrong by half says nothing, so that 1 or 5 is a percentage, typed as a fraction.

    Raises
    ------
    TypeError, ValueError
        As `positive_real`, or if it is one half or more.
    """
    number = positive_real(name, value)
    if number >= 0.5:
        meant = f"; for {number:g} % give {number / 100:g}" if number <= 50 else ""
        raise ValueError(
            f"{name} must be a fraction less than 0.5, got {shown(value)}, {100 * number:g} %{meant}"
        )
    return number


def whole_number(name: str, value: object, *, least: int = 1, most: int | None = None) -> int:
    """Return `value` as an int in `least..most`.

    Raises
    ------
    TypeError
        If `value` is not an integer (2.5, "six" and True are not; NumPy integers are).
    ValueError
        If it lies outside the range.
    """
    allowed = f"a whole number of at least {least}" + (f" and at most {most}" if most is not None else "")
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{name} must be {allowed}, got {shown(value)}")
    number = int(value)
    if number < least or (most is not None and number > most):
        raise ValueError(f"{name} must be {allowed}, got {shown(number)}")
    return number


def choice(name: str, value: object, allowed: Iterable[str]) -> str:
    """Return `value` if it is one of the words in `allowed`.

    Raises
    ------
    TypeError
        If `value` is not a string.
    ValueError
        If it is another word; the message offers the nearest allowed one.
    """
    words = list(allowed)
    if not isinstance(value, str):
        raise TypeError(f"{name} must be one of {', '.join(words)}, got {shown(value)}")
    if value in words:
        return value
    near = difflib.get_close_matches(value.strip().lower(), words, n=1)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    raise ValueError(f"{name} must be one of {', '.join(words)}, got {shown(value)}{hint}")
