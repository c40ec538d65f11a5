"""Positions along a beam, as users give them to mode shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import real_numbers
from beammodes.problem.beam import Beam

__all__ = ["positions_on"]


def positions_on(beam: Beam, x: ArrayLike) -> NDArray[np.float64]:
    """Return `x` as floats.

    Raises
    ------
    TypeError, ValueError
        If it is not real numbers in one regular array, finite and inside [0, L].

    Examples
    --------
    >>> positions_on(Beam.unit(), [0, 1])
    array([0., 1.])
    """
    position = real_numbers("x", x, finite=False)
    outside = ~((position >= 0.0) & (position <= beam.length))
    if outside.any():
        raise ValueError(f"x must be finite and inside [0, {beam.length}], got {position[outside][0]}")
    return position
