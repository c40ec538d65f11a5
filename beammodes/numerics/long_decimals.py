"""Decimals of any length: exact conversion from floats and fractions, π, cosine and sine."""

from __future__ import annotations

from decimal import MAX_EMAX, MIN_EMIN, ROUND_HALF_EVEN, Context, Decimal, getcontext, localcontext
from fractions import Fraction
from functools import lru_cache

__all__ = ["LONG", "as_decimal", "cosine_and_sine", "pi"]


#: Digits that lose nothing of a double, whatever context the caller has set, and exponents for e^p of any p.
LONG = Context(prec=80, rounding=ROUND_HALF_EVEN, Emin=MIN_EMIN, Emax=MAX_EMAX, capitals=1, clamp=0)


def as_decimal(value: float | Fraction) -> Decimal:
    """Return a float exactly, and a fraction to the context's precision.

    Examples
    --------
    >>> as_decimal(0.5) == as_decimal(Fraction(1, 2))
    True
    """
    if isinstance(value, Fraction):
        return Decimal(value.numerator) / Decimal(value.denominator)
    return Decimal(value)


def pi() -> Decimal:
    """Return π to the context's precision.

    Examples
    --------
    >>> float(pi())
    3.141592653589793
    """
    # Steps of 64 digits: lengths vary with the place, and few of them should be worked out.
    return +_pi(64 * (getcontext().prec // 64 + 1))


@lru_cache(maxsize=64)
def _pi(digits: int) -> Decimal:
    """Machin's formula, π = 16 arctan 1/5 - 4 arctan 1/239."""
    with localcontext() as context:
        context.prec = digits + 10
        return 16 * _inverse_arctangent(5) - 4 * _inverse_arctangent(239)


def _inverse_arctangent(number: int) -> Decimal:
    """Return arctan(1/number)."""
    power = total = Decimal(1) / number
    divisor, sign, square = 1, 1, number * number
    while total + power / divisor != total:
        power /= square
        divisor, sign = divisor + 2, -sign
        total += sign * power / divisor
    return total


def cosine_and_sine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Return cos and sin of an angle in radians, their errors some units of the context's last digit.

    Examples
    --------
    >>> [float(value) for value in cosine_and_sine(Decimal(2))]
    [-0.4161468365471424, 0.9092974268256817]
    """
    quarters = int((2 * angle / pi()).to_integral_value(ROUND_HALF_EVEN))
    rest = angle - quarters * pi() / 2
    cosine, sine = Decimal(1), rest
    smallest = Decimal(10) ** -(getcontext().prec + 2)
    term, order = rest, 1
    while abs(term) > smallest:
        term *= -rest / (order + 1)
        cosine += term
        term *= rest / (order + 2)
        sine += term
        order += 2
    return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[quarters % 4]
