"""States of four numbers along a line, linear from place to place, with two conditions at each end."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Complex", "marched_states"]

Complex = NDArray[np.complexfloating[Any, Any]]

# Diagonals below and above the main one: two conditions come first, four rows a step, and two conditions.
_BELOW, _ABOVE = 5, 3


def marched_states(
    steps: NDArray[Any], added: NDArray[Any], left: NDArray[Any], right: NDArray[Any], given: NDArray[Any]
) -> Complex:
    """Return the states of  y_(i+1) = A_i y_i + b_i,  L y_0 = l,  R y_n = r,  shape (n + 1, 4, columns).

    All places are solved for at once, with pivots, so that what grows along the line does not drown what
    fades. What is exactly singular gives infinity.

    Parameters
    ----------
    steps : ndarray, shape (n, 4, 4)
        A.
    added : ndarray, shape (n, 4, columns)
        b.
    left, right : ndarray, shape (2, 4)
        L and R.
    given : ndarray, shape (2, 2, columns)
        l and r.

    Examples
    --------
    A line whose second number is the slope of the first, fourth that of the third; held at 0, moved at 1:

    >>> step = np.eye(4) + np.diag([1.0, 0.0, 1.0], k=1)
    >>> ends = np.eye(4)[[0, 2]]
    >>> given = np.array([[[0], [0]], [[1], [2]]])
    >>> states = marched_states(step[None], np.zeros((1, 4, 1)), ends, ends, given)
    >>> states[0, :, 0].real.tolist()
    [0.0, 1.0, 0.0, 2.0]
    """
    from scipy.linalg.lapack import zgbsv

    count, columns = len(steps), added.shape[2]
    size, centre = 4 * (count + 1), _BELOW + _ABOVE
    band = np.zeros((2 * _BELOW + _ABOVE + 1, size), dtype=np.complex128)
    wanted = np.zeros((size, columns), dtype=np.complex128)
    for i in range(2):
        for ends, start, row in ((left, 0, i), (right, size - 4, size - 2 + i)):
            scale = np.abs(ends[i]).max()
            wanted[row] = given[int(start > 0), i] / scale
            for j in range(4):
                band[centre + row - start - j, start + j] = ends[i, j] / scale
    for r in range(4):
        wanted[2 + r : size - 2 : 4] = -added[:, r]
        for c in range(4):
            band[centre + 2 + r - c, c : size - 4 : 4] = steps[:, r, c]
    band[centre - 2, 4:] = -1.0
    found, info = zgbsv(_BELOW, _ABOVE, band, wanted, overwrite_ab=True, overwrite_b=True)[2:]
    if info:
        found = np.full_like(wanted, np.inf)
    return np.asarray(found).reshape(count + 1, 4, columns)
