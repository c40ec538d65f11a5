"""The numbers of no sign but plus that obey a few linear equations and lie nearest to given ones."""

from __future__ import annotations

import numpy as np

from beammodes.numerics.arrays import Floats

__all__ = ["nearest_nonnegative"]

#: Of the wanted sums, where Newton's steps end; how many steps, and halvings of one, there are at most; and
#: the share that unknowns at zero have in a step.
_CLOSE, _STEPS, _HALVINGS, _TRACE = 1e-14, 100, 60, 1e-12


def nearest_nonnegative(rows: Floats, wanted: Floats, start: Floats) -> Floats | None:
    """Return the x ≥ 0 nearest to `start` with `rows` x = `wanted`, or None where there is none.

        x = max(0, start + rowsᵀ λ),

    whose few λ minimize  ½ |x|² - wantedᵀ λ,  a convex function of pieces that are quadratic: Newton's steps
    find its minimum, or it has none.

    Parameters
    ----------
    rows : ndarray, shape (equations, unknowns)
        None of zeros only, with entries and sums of order 1.
    wanted : ndarray, shape (equations,)
    start : ndarray, shape (unknowns,)

    Examples
    --------
    >>> nearest_nonnegative(np.array([[1.0, 1.0, 1.0]]), np.array([1.0]), np.array([1.0, 1.0, -4.0])).tolist()
    [0.5, 0.5, 0.0]
    >>> nearest_nonnegative(np.array([[1.0, 2.0], [1.0, 1.0]]), np.array([3.0, 1.0]), np.zeros(2)) is None
    True
    """

    def at(multipliers: Floats) -> tuple[Floats, float, Floats]:
        x = np.maximum(0.0, start + multipliers @ rows)
        return x, float(x @ x / 2 - wanted @ multipliers), wanted - rows @ x

    # Where all that is wanted is zero, of the sums that it starts from.
    size = float(np.abs(wanted).max() or np.abs(rows @ np.maximum(0.0, start)).max())
    multipliers = np.zeros(len(wanted))
    x, value, missing = at(multipliers)
    for _ in range(_STEPS):
        if np.abs(missing).max() <= _CLOSE * size:
            break
        used = rows[:, x > 0]
        # A trace of all unknowns, where those in use do not reach.
        step = np.linalg.lstsq(used @ used.T + _TRACE * (rows @ rows.T), missing, rcond=1e-16)[0]
        for _ in range(_HALVINGS):
            further = at(multipliers + step)
            # The value has fewer digits than what is missing, its slope.
            if further[1] < value or np.abs(further[2]).max() < np.abs(missing).max():
                break
            step /= 2
        else:
            break
        multipliers = multipliers + step
        x, value, missing = further
    return x if np.abs(missing).max() <= 1e3 * _CLOSE * size else None
