"""Frequencies of uniform beams with springs and bodies at their ends and an axial force, over arrays.

The three steps of `supported_root`, its digits being pairs of doubles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.end_waves import ARRAYS, PAIRS, EndNumbers, read, residual
from beammodes.exact.supported_root import (
    FLOOR,
    LAST,
    NOISE,
    Rise,
    apart,
    in_decimals,
    rigid_modes,
    supported_frequency,
)
from beammodes.exact.uniform_beam import ABOVE_CRITICAL
from beammodes.numerics.arrays import Floats
from beammodes.numerics.counted_secants import Reading, counted_roots
from beammodes.numerics.double_double import DoubleDouble, two_product
from beammodes.problem.end_columns import BoundaryColumns, EndColumns

__all__ = ["supported_frequencies"]

# So many cases at once stay in the processor's cache.
_BLOCK = 4096
# So many are searched for at once, so that the few slow ones do not keep a block waiting.
_SEARCHED = 16 * _BLOCK
# Fewer are quicker one by one.
_FEW = 24


def supported_frequencies(
    ends: BoundaryColumns, tension: Floats, mode: NDArray[np.int64], gyration: float = 0.0
) -> Floats:
    """Return ω √(ρA L⁴/EI) of elastic modes of uniform beams, NaN where the straight beam buckles.

    Right to the last digit.

    Parameters
    ----------
    ends : BoundaryColumns
        In multiples of EI/L³, EI/L, ρA L, ρA L³ and L, of one dimension.
    tension : ndarray
        T L²/EI of each.
    mode : ndarray of int
        The elastic mode of each, from 1: rigid-body modes do not count.
    gyration : float
        ρI/(ρA L²), of the section.

    Examples
    --------
    >>> from beammodes.problem.ends import Boundary
    >>> ends = BoundaryColumns.of([Boundary.of("clamped-free(mass=1)")] * 2)
    >>> supported_frequencies(ends, np.zeros(2), np.array([1, 2])).round(4)
    array([ 1.5573, 16.2501])
    """
    if len(mode) <= _FEW:
        return np.array(
            [
                supported_frequency(*_ends(ends, i), int(mode[i]), float(tension[i]), gyration)
                for i in range(len(mode))
            ],
            dtype=np.float64,
        )
    with np.errstate(all="ignore"):
        # What overflows is not sure.
        return _found(ends, tension, mode, gyration)


def _found(ends: BoundaryColumns, tension: Floats, mode: NDArray[np.int64], gyration: float) -> Floats:
    rigid: NDArray[np.int64] = rigid_modes(_columns(ends.left), _columns(ends.right), tension)
    found, total = np.full(len(mode), np.nan), rigid + mode
    possible = np.flatnonzero(tension > -float(ABOVE_CRITICAL))
    for i in range(0, len(possible), _SEARCHED):
        many = possible[i : i + _SEARCHED]
        case = _Cases.of(ends.take(many), tension[many], total[many], gyration)
        near = _closed_in(case)
        for j in range(0, len(many), _BLOCK):
            part = slice(j, j + _BLOCK)
            at = many[part]
            omega, sure = _corrected(case.taken(part), near[part], ends.take(at))
            for n in np.flatnonzero(~sure):
                numbers = (*_ends(ends, at[n]), int(total[at[n]]), float(tension[at[n]]), gyration)
                omega[n] = in_decimals(*numbers, float(omega[n]))
            found[at] = omega
    return found


class _Cases(NamedTuple):
    """Ends, tension, number of the mode, rigid-body modes included, and r² of the section."""

    left: EndNumbers
    right: EndNumbers
    tension: Floats
    number: Floats
    gyration: float

    @classmethod
    def of(cls, ends: BoundaryColumns, tension: Floats, number: NDArray[np.int64], gyration: float) -> _Cases:
        left, right = _numbers(ends.left), _numbers(ends.right)
        return cls(left, right, tension, number.astype(np.float64), gyration)

    def taken(self, index: NDArray[np.bool_] | slice) -> _Cases:
        left, right = (EndNumbers(*(column[index] for column in side)) for side in self[:2])
        return _Cases(left, right, self.tension[index], self.number[index], self.gyration)

    def with_more(self, others: list[_Cases]) -> _Cases:
        cases = (self, *others)
        left, right = (
            EndNumbers(
                *(np.concatenate(column) for column in zip(*(case[side] for case in cases), strict=True))
            )
            for side in (0, 1)
        )
        tension, number = (np.concatenate([case[column] for case in cases]) for column in (2, 3))
        return _Cases(left, right, tension, number, self.gyration)

    def at(self, place: Floats) -> Reading:
        return read(ARRAYS, self.left, self.right, place, self.tension, self.gyration)

    def frequency(self, wave: Floats) -> Floats:
        """Return ω of the wavenumber q, zero where there is none."""
        q2 = wave * wave
        return np.asarray(wave * np.sqrt(np.maximum(q2 + self.tension, 0.0) / (1.0 + self.gyration * q2)))


def _numbers(side: EndColumns) -> EndNumbers:
    return EndNumbers.of(*_columns(side))


def _closed_in(case: _Cases) -> Floats:
    """Return the roots nearly."""
    # The pinned beam has k - 1 roots below k π. Others have at most two less and four more below a place.
    start, low, high = (
        case.frequency(np.maximum(case.number + more, 0.0) * math.pi) for more in (-0.5, -4.1, 2.1)
    )
    return counted_roots(case, start, low, high, FLOOR)


def _corrected(case: _Cases, omega: Floats, ends: BoundaryColumns) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the roots to the last digit, and which of them are sure."""
    part = apart(case.number)
    below, here, above = (case.at(omega * factor) for factor in (1.0 - part, 1.0, 1.0 + part))
    sure = (below.below == case.number - 1.0) & (above.below == case.number) & (omega > 2.0 * FLOOR)
    pushed = case.tension < 0.0
    if pushed.any():
        # Nothing but a translation below the floor: the beam does not buckle.
        loose = ((case.left.spring == 0.0) & (case.right.spring == 0.0))[pushed]
        sure[pushed] &= case.taken(pushed).at(np.full(pushed.sum(), FLOOR)).below == loose
    rise = Rise.across(below, here, above, part)
    exact = _exact_residual(case, ends, omega)
    noise, step = rise.noise(exact), exact / rise.rate
    omega = omega - step * omega
    sure &= noise < NOISE
    again = sure & (rise.left(step, noise) > LAST)
    if again.any():
        rise = Rise(*(column[again] for column in rise))
        step = _exact_residual(case.taken(again), ends.take(again), omega[again]) / rise.rate
        omega[again] -= step * omega[again]
        sure[again] = rise.left(step, noise[again]) < LAST
    return omega, sure


def _exact_residual(case: _Cases, ends: BoundaryColumns, omega: Floats) -> Floats:
    left, right = (
        numbers.in_pairs(side.mass, side.offset)
        for numbers, side in ((case.left, ends.left), (case.right, ends.right))
    )
    square, tension = DoubleDouble(*two_product(omega, omega)), DoubleDouble.of(case.tension)
    exact: DoubleDouble = residual(PAIRS, left, right, square, tension, case.gyration)
    return exact.high


def _ends(ends: BoundaryColumns, i: int) -> tuple[list[float], list[float]]:
    """Return the numbers of one pair of ends."""
    left, right = ([float(column[i]) for column in _columns(side)] for side in (ends.left, ends.right))
    return left, right


def _columns(side: EndColumns) -> tuple[Floats, ...]:
    springs = (side.translational_stiffness, side.rotational_stiffness)
    return (*springs, side.mass, side.rotary_inertia, side.offset)
