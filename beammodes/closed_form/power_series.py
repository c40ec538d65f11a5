"""Power series in s = sin(q/2): exact rational coefficients, and their sums in floats."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats

__all__ = [
    "SERIES_TERMS",
    "SeriesTable",
    "binomial",
    "enough_powers",
    "in_powers_of_s",
    "integral",
    "powers_of",
    "product",
    "quotient",
]


#: Terms of a series in s. All of them converge for s < 1; at q = 0.8, s = 0.39, the last is below 1e-20.
SERIES_TERMS = 52
# Exact series carry a few more, of which leading zeros are divided out.
_LENGTH = SERIES_TERMS + 8
_EXPONENTS = np.arange(float(_LENGTH))


def binomial(slope: Fraction | int, exponent: Fraction) -> NDArray[Any]:
    """Return (1 + slope s²) ** exponent as a series in s, exact.

    Examples
    --------
    >>> [str(value) for value in binomial(-1, Fraction(1, 2))[:5]]               # √(1 - s²)
    ['1', '0', '-1/2', '0', '-1/8']
    """
    series = np.full(_LENGTH, Fraction(0), dtype=object)
    term = Fraction(1)
    for k in range(_LENGTH // 2):
        series[2 * k] = term
        term *= (exponent - k) / (k + 1) * slope
    return series


def product(table: NDArray[Any], series: NDArray[Any]) -> NDArray[Any]:
    """Multiply series in s along the last axis; `table` is the one that is no longer than the other.

    Examples
    --------
    >>> product(np.array([[1, 1, 0], [0, 2, 0]]), np.array([1, -1, 5, 7])).astype(int)
    array([[ 1,  0,  4],
           [ 0,  2, -2]])
    """
    terms = table.shape[-1]
    result = np.full(table.shape, Fraction(0), dtype=object)
    for k in np.flatnonzero(table.reshape(-1, terms).any(axis=0)):
        result[..., k:] += table[..., k : k + 1] * series[: terms - k]
    return result


def quotient(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Return a/b for b that starts with 1.

    Examples
    --------
    >>> quotient(np.array([1, 0, 0, 0]), np.array([1, -1, 0, 0]))                # 1/(1 - s)
    array([1, 1, 1, 1])
    """
    result = a.copy()
    for k in range(1, len(a)):
        result[k] -= (b[1 : k + 1] * result[:k][::-1]).sum()
    return result


def integral(series: NDArray[Any]) -> NDArray[Any]:
    """Return (1/s) ∫ series ds."""
    return np.array([c / (k + 1) for k, c in enumerate(series)], dtype=object)


def in_powers_of_s(table: NDArray[Any]) -> NDArray[Any]:
    """Spread polynomials in x over even powers of s, up to the length that all series are kept to."""
    spread = np.full((*table.shape[:-1], _LENGTH), Fraction(0), dtype=object)
    kept = table[..., : _LENGTH // 2]
    spread[..., : 2 * kept.shape[-1] : 2] = kept
    return spread


def powers_of(s: Any, terms: int) -> Floats:
    """Return 1, s, s², ..., shape (terms, *s.shape)."""
    if np.ndim(s) == 0:
        return np.asarray(s ** _EXPONENTS[:terms])
    powers = np.empty((terms, *s.shape), dtype=np.result_type(s))
    powers[0] = 1.0
    for k in range(1, terms):
        np.multiply(powers[k - 1], s, out=powers[k])
    return powers


def enough_powers(s: Any) -> Floats:
    """Return as many powers of s as series of radius 1 need, with a wide margin for large coefficients."""
    largest = s if isinstance(s, float) else float(s.max())
    needed = SERIES_TERMS if largest > 0.3 else 12 + int(44.0 / -math.log(largest))
    return powers_of(s, min(needed, SERIES_TERMS))


class SeriesTable(NamedTuple):
    """Power series in s: their coefficients, shape (rows, terms)."""

    coefficients: Floats

    @classmethod
    def of(cls, rows: NDArray[Any]) -> SeriesTable:
        """Round exact series, shape (rows, terms), to floats."""
        return cls(np.array(rows, dtype=np.float64))

    def above(self, *others: SeriesTable) -> SeriesTable:
        """Return these rows and, below them, those of others."""
        return SeriesTable(np.vstack([self.coefficients, *(other.coefficients for other in others)]))

    def at(self, powers: Floats) -> Any:
        """Return the sums of all rows, given 1, s, s², ...: an array, or a list of floats for a single s."""
        sums = self.coefficients[:, : len(powers)] @ powers
        return sums if powers.ndim > 1 else sums.tolist()
