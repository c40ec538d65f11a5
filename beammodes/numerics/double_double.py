"""Arrays of numbers of 32 digits, each the sum of two doubles.

A sum of two doubles that do not overlap, never carried out, keeps 106 bits. Every operation on such pairs is
a few operations on doubles, so that arrays of them cost twenty times arrays of doubles, not thousands.

References
----------
Dekker, Numerische Mathematik 18 (1971); Hida, Li, Bailey, 15th IEEE Symposium on Computer Arithmetic (2001).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from mpmath.libmp import from_int, mpf_cos_sin, mpf_div, mpf_exp, mpf_ln2, mpf_mul, mpf_pi, to_rational

from beammodes.numerics.arrays import Floats

__all__ = ["DoubleDouble", "cosine_and_sine", "decay", "two_product", "two_sum"]

# 2^27 + 1 splits a double into halves whose products are exact (Veltkamp).
_SPLITTER = 134217729.0
# Bits of tables: double-doubles have 106.
_BITS = 200
# Steps of the tables to a half turn, and to a factor of two.
_STEPS = 64
# Bits of each of the first two parts of a step, so that whole multiples up to 2^24 are exact.
_PART = 29
# Terms of a series below this part of the whole need no more digits than a double has; ones far below, none.
_SHORT, _NEGLIGIBLE = 1e-17, 1e-34


@dataclass(frozen=True, slots=True, eq=False)
class DoubleDouble:
    """An array of numbers `high + low`, |low| being at most half a unit in the last place of `high`.

    Sums and differences err by 1e-31 of the larger operand, products, quotients and roots by that of
    themselves. The other operand may be an array of doubles or a number, taken as exact.

    Examples
    --------
    >>> third = DoubleDouble.of(np.array([1.0])) / 3.0
    >>> float((third * 3.0 - 1.0).high[0]), float((np.array([1.0]) / 3.0 - third).high[0]) > 1e-17
    (0.0, False)
    """

    high: Floats
    low: Floats

    # Arrays leave operators to this class.
    __array_ufunc__ = None

    @classmethod
    def of(cls, value: Floats) -> DoubleDouble:
        """Return doubles as they are."""
        return cls(value, np.zeros_like(value))

    def __neg__(self) -> DoubleDouble:
        return DoubleDouble(-self.high, -self.low)

    def __add__(self, other: DoubleDouble | Floats | float) -> DoubleDouble:
        if isinstance(other, DoubleDouble):
            total, rest = two_sum(self.high, other.high)
            return _ordered(total, rest + (self.low + other.low))
        total, rest = two_sum(self.high, other)
        return _ordered(total, rest + self.low)

    __radd__ = __add__

    def __sub__(self, other: DoubleDouble | Floats | float) -> DoubleDouble:
        return self + -other

    def __rsub__(self, other: Floats | float) -> DoubleDouble:
        return -self + other

    def __mul__(self, other: DoubleDouble | Floats | float) -> DoubleDouble:
        if isinstance(other, DoubleDouble):
            product, rest = two_product(self.high, other.high)
            return _ordered(product, rest + (self.high * other.low + self.low * other.high))
        product, rest = two_product(self.high, other)
        return _ordered(product, rest + self.low * other)

    __rmul__ = __mul__

    def __truediv__(self, other: DoubleDouble | Floats | float) -> DoubleDouble:
        below = other.high if isinstance(other, DoubleDouble) else other
        quotient = self.high / below
        rest = self - other * DoubleDouble.of(quotient)
        return _ordered(quotient, rest.high / below)

    def __rtruediv__(self, other: Floats | float) -> DoubleDouble:
        return DoubleDouble.of(other + np.zeros_like(self.high)) / self

    def scaled(self, power_of_two: Floats | float) -> DoubleDouble:
        """Return the product with powers of two, which are exact."""
        return DoubleDouble(self.high * power_of_two, self.low * power_of_two)

    def sqrt(self) -> DoubleDouble:
        """Return the square root; of numbers of at least 0."""
        root = np.sqrt(self.high)
        rest = self - DoubleDouble(*two_product(root, root))
        return _ordered(root, rest.high / (2.0 * np.where(root > 0.0, root, 1.0)))

    @staticmethod
    def where(mask: Any, one: DoubleDouble, other: DoubleDouble) -> DoubleDouble:
        """Return `one` where the mask holds, else `other`."""
        return DoubleDouble(np.where(mask, one.high, other.high), np.where(mask, one.low, other.low))

    def __gt__(self, other: float) -> Any:
        return self.high > other

    def taken(self, index: Any) -> DoubleDouble:
        """Return the elements at an index."""
        return DoubleDouble(self.high[index], self.low[index])


def two_sum(a: Floats, b: Floats | float) -> tuple[Floats, Floats]:
    """Return the rounded sum and exactly what rounding left out (Knuth).

    Examples
    --------
    >>> [float(part) for part in two_sum(1.0, 1e-20)]
    [1.0, 1e-20]
    """
    total = a + b
    other = total - a
    return total, (a - (total - other)) + (b - other)


def two_product(a: Floats, b: Floats | float) -> tuple[Floats, Floats]:
    """Return the rounded product and exactly what rounding left out (Dekker); factors below 1e300.

    Examples
    --------
    >>> [part.hex() for part in two_product(1.0 + 2.0**-52, 1.0 + 2.0**-52)]
    ['0x1.0000000000002p+0', '0x1.0000000000000p-104']
    """
    product = a * b
    a_high, a_low = _halves(a)
    b_high, b_low = _halves(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


def _halves(a: Any) -> tuple[Any, Any]:
    scaled = _SPLITTER * a
    high = scaled - (scaled - a)
    return high, a - high


def _ordered(large: Floats, small: Floats) -> DoubleDouble:
    """Return the sum of a number and one that is smaller, without overlap."""
    total = large + small
    return DoubleDouble(total, small - (total - large))


def cosine_and_sine(angle: DoubleDouble) -> tuple[DoubleDouble, DoubleDouble]:
    """Return cos and sin of angles up to 10⁵ in radians, their errors 1e-31 of one (1e-26 beyond).

    Examples
    --------
    >>> cosine, sine = cosine_and_sine(DoubleDouble.of(np.array([2.0])))
    >>> abs(float((cosine * cosine + sine * sine - 1.0).high[0])) < 1e-30
    True
    """
    parts, (cosines, sines) = _turns()
    count = np.rint(angle.high / parts[0])
    rest = angle
    for part in parts:
        rest = rest - DoubleDouble(*two_product(count, part))
    entry = count.astype(np.int64) % (2 * _STEPS)
    square = rest * rest
    c, s = _series(square, 0), _series(square, 1) * rest
    cosine, sine = cosines.taken(entry), sines.taken(entry)
    return cosine * c - sine * s, sine * c + cosine * s


def decay(exponent: DoubleDouble) -> DoubleDouble:
    """Return e^(-exponent) of numbers of at least 0, right to 1e-30 of itself; zero beyond 700.

    Examples
    --------
    >>> fallen = decay(DoubleDouble.of(np.array([0.5, 1.0])))
    >>> abs(float((fallen.taken(0) * fallen.taken(0) - fallen.taken(1)).high)) < 1e-31
    True
    """
    parts, powers = _fractions_of_two()
    far = exponent.high > 700.0
    count = np.where(far, 0.0, np.rint(exponent.high / parts[0]))
    rest = DoubleDouble(np.where(far, 0.0, exponent.high), np.where(far, 0.0, exponent.low))
    for part in parts:
        rest = rest - DoubleDouble(*two_product(count, part))
    whole, entry = np.divmod(count.astype(np.int64), _STEPS)
    found = powers.taken(entry) * _series(rest, None)
    return found.scaled(np.where(far, 0.0, np.ldexp(1.0, -whole)))


def _series(x: DoubleDouble, parity: int | None) -> DoubleDouble:
    """Return cos √x (parity 0), sin √x / √x (1) or e^(-x) (None) within half a step of the tables."""
    long, short = _coefficients(parity)
    tail = 0.0 * x.high
    for high, _ in reversed(short):
        tail = tail * x.high + high
    total = DoubleDouble.of(tail)
    for high, low in reversed(long):
        total = total * x + DoubleDouble(np.asarray(high), np.asarray(low))
    return total


@lru_cache(maxsize=3)
def _coefficients(parity: int | None) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Return a series' coefficients, each as two doubles: those of terms that need them, and the others."""
    largest = 0.5 * (math.log(2.0) if parity is None else math.pi) / _STEPS
    first, apart = (0, 1) if parity is None else (parity, 2)
    terms: tuple[list[tuple[float, float]], ...] = ([], [])
    power, size = first, 1.0
    while size > _NEGLIGIBLE:
        sign = (-1) ** ((power - first) // apart)
        terms[size < _SHORT].append(_two(Fraction(sign, math.factorial(power))))
        power += apart
        size = largest ** (power - first) / math.factorial(power)
    return terms[0], terms[1]


@lru_cache(maxsize=1)
def _turns() -> tuple[tuple[float, ...], tuple[DoubleDouble, DoubleDouble]]:
    """Return π/64 in parts, and the cosines and sines of its multiples through a turn."""
    step = mpf_div(mpf_pi(_BITS), from_int(_STEPS), _BITS)
    pairs = [mpf_cos_sin(mpf_mul(step, from_int(n), _BITS), _BITS) for n in range(2 * _STEPS)]
    return _parts(step), (_table([c for c, _ in pairs]), _table([s for _, s in pairs]))


@lru_cache(maxsize=1)
def _fractions_of_two() -> tuple[tuple[float, ...], DoubleDouble]:
    """Return (log 2)/64 in parts, and e^(-n) of its multiples up to log 2."""
    step = mpf_div(mpf_ln2(_BITS), from_int(_STEPS), _BITS)
    return _parts(step), _table([mpf_exp(mpf_mul(step, from_int(-n), _BITS), _BITS) for n in range(_STEPS)])


def _parts(step: Any) -> tuple[float, ...]:
    """Return a step in three parts of few bits and a rest, whose whole multiples are exact sums."""
    rest, parts = Fraction(*to_rational(step)), []
    unit = Fraction(1, 2 ** (_PART + 4))
    for _ in range(3):
        parts.append(float(rest // unit * unit))
        rest -= Fraction(parts[-1])
        unit /= 2**_PART
    return (*parts, float(rest))


def _table(values: Sequence[Any]) -> DoubleDouble:
    pairs = np.array([_two(Fraction(*to_rational(value))) for value in values])
    return DoubleDouble(pairs[:, 0].copy(), pairs[:, 1].copy())


def _two(value: Fraction) -> tuple[float, float]:
    high = float(value)
    return high, float(value - Fraction(high))
