"""What a chain's ends and its inside do to waves beyond what the beam's do, as series exact at any size."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.closed_form.series import SERIES_TERMS, Table, binomial, integral, product, quotient
from beammodes.closed_form.waves import EndWaves

__all__ = ["Parts", "inside", "parts"]

Floats = NDArray[np.float64]


class Parts(NamedTuple):
    """An end's determinants over the length of its own (cos, sin) pair, less the beam's."""

    turn: Any  # Φ - Φ⁰
    growing: Any  # of the pair for the growing exponential, complex, over the beam's
    cos_sin: Any  # of the determinant of cos and sin, exponentials scaled as `_end_table` says


def parts(end: EndWaves, powers: Floats, u: Any) -> Parts:
    """Return what an end does to waves beyond what the beam's does, to full relative accuracy."""
    rows = _end_table(end).at(powers)
    total = rows[-5:]
    for first in range(len(rows) - 10, -1, -5):
        total = total * u + rows[first : first + 5]
    num, den, den2, num2, cos_sin = total
    length = np.hypot(num, den)
    shorter = -num * num / (length * (length + den))  # den/length - 1
    return Parts(
        np.arctan2(num, den),
        (den2 + 1j * num2) / length + shorter,
        cos_sin / length + end.beam.cos_sin * shorter,
    )


@lru_cache(maxsize=1024)
def _end_table(end: EndWaves) -> Table:
    """Return the rows num, den, den₊ - den, num₊, f cs - cs⁰ den, for each power of u in turn.

    den + i num is the pair (sin, cos) of the decaying exponential over the beam's, den₊ + i num₊ that of
    the growing one. An end that does no work has cs and the determinant of the two exponentials in one
    ratio f², whatever the end: f² = R/(d t) over the beam's, with R, d and t as in `waves`, and R/t where
    its half-stub waves have dropped √d. So one of the two is enough, and with the exponentials scaled by f
    none of these rows is larger than the end's own error.
    """
    c, s, c2, s2, cos_sin, _ = end.series
    c0, s0, c20, s20, cos_sin0, _ = end.series[:, 0, 0]
    size = c0 * c0 + s0 * s0
    num, den = (c * s0 - s * c0) / size, (c * c0 + s * s0) / size
    num2, den2 = (c2 * s20 - s2 * c20) / size, (c2 * c20 + s2 * s20) / size
    quarter, p = Fraction(1, 4), end.p
    scale = product(binomial(1 - p, quarter), binomial(-1, -quarter))
    if not end.half:
        scale = product(scale, binomial(-p, -2 * quarter))
    scaled = product(cos_sin, scale)
    rows = np.array([num, den, den2 - den, num2, scaled - cos_sin0 * den])
    return Table.of(np.concatenate([rows[:, u] for u in range(c.shape[0])]))


@lru_cache(maxsize=1024)
def inside(end: EndWaves) -> Table:
    """Return `_inside_table`; an end is looked up faster than a fraction."""
    return _inside_table(end.p)


@lru_cache(maxsize=64)
def _inside_table(p: Fraction) -> Table:
    """Return the rows ω/q² - 1 and χ/q - 1.

    q = 2 ∫ ds/√(1 - s²), χ = 2 ∫ ds/((1 - p s²) √(1 + (1 - p) s²)), ω = 4 s²/√(1 - p s²).
    """
    minus_half, minus_one = Fraction(-1, 2), Fraction(-1)
    q_over_2s = integral(binomial(-1, minus_half))
    chi_over_2s = integral(product(binomial(-p, minus_one), binomial(1 - p, minus_half)))
    one = binomial(0, minus_one)
    omega = quotient(quotient(binomial(-p, minus_half), q_over_2s), q_over_2s) - one
    return Table.of(np.array([omega, quotient(chi_over_2s, q_over_2s) - one])[:, :SERIES_TERMS])
