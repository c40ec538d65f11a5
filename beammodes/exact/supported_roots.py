"""Frequencies of uniform beams with springs and bodies at their ends and an axial force, over arrays."""

from __future__ import annotations

import math
from decimal import localcontext

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.uniform_beam import UnitBeam, UnitEnd
from beammodes.numerics.arrays import Floats
from beammodes.numerics.long_decimals import LONG, as_decimal
from beammodes.problem.end_columns import BoundaryColumns, EndColumns

__all__ = ["supported_frequencies"]


def supported_frequencies(
    ends: BoundaryColumns, tension: Floats, mode: NDArray[np.int64], gyration: float = 0.0
) -> Floats:
    """Return ω √(ρA L⁴/EI) of elastic modes of uniform beams, NaN where the straight beam buckles.

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
    rigid = _rigid_modes(ends, tension)
    found = np.full(len(mode), np.nan)
    for i in range(len(mode)):
        found[i] = _in_decimals(ends, float(tension[i]), int(mode[i]), gyration, int(rigid[i]), i)
    return found


def _rigid_modes(ends: BoundaryColumns, tension: Floats) -> NDArray[np.int64]:
    """Return how many motions leave the beam straight and feel neither supports nor force."""
    sides = (ends.left, ends.right)
    across = sum((side.translational_stiffness > 0).astype(np.int64) for side in sides)
    turning = (sides[0].rotational_stiffness > 0) | (sides[1].rotational_stiffness > 0)
    return np.asarray(np.where(tension == 0.0, 2 - np.minimum(2, across + turning), across == 0))


def _in_decimals(
    ends: BoundaryColumns, tension: float, mode: int, gyration: float, rigid: int, i: int
) -> float:
    with localcontext(LONG):
        beam = UnitBeam(
            as_decimal(tension), as_decimal(gyration), _unit_end(ends.left, i), _unit_end(ends.right, i)
        )
        squares = beam.lowest(rigid, mode)
        return math.nan if squares is None else float(squares[-1].sqrt())


def _unit_end(side: EndColumns, i: int) -> UnitEnd:
    springs = (float(side.translational_stiffness[i]), float(side.rotational_stiffness[i]))
    numbers = (
        *(0.0 if k == math.inf else k for k in springs),
        *(float(c[i]) for c in (side.mass, side.rotary_inertia, side.offset)),
    )
    return UnitEnd((springs[0] == math.inf, springs[1] == math.inf), *map(as_decimal, numbers))
