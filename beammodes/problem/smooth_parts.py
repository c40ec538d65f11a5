"""Functions along a beam: their values, and where one must be cut so that each part of it is smooth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import real

__all__ = ["SAMPLES", "BrokenFunction", "function_values", "smooth_parts"]

Floats = NDArray[np.float64]
Function = Callable[[Any], Any]

#: A function is seen at this many places along a beam: a feature as wide as L/4096 meets one at least.
SAMPLES = 4096

# Gauss points by which a function is known on each part, and places between them at least.
_POINTS, _BETWEEN = 32, 33
# Largest error on a part, relative to the function there, times the part's share of the length.
_TOLERANCE = 1e-12
_MOST_PARTS = 4000


@dataclass(frozen=True, slots=True)
class BrokenFunction:
    """A function along a beam that is smooth but for steps and kinks at `breaks`, ascending positions [m]."""

    function: Function
    breaks: tuple[float, ...]

    def __call__(self, x: Any) -> Any:
        """Return the function at `x`."""
        return self.function(x)


def function_values(function: Function, position: Floats) -> Floats:
    """Return the values of a function of an array, or of one number at a time, at a row of positions.

    Raises
    ------
    TypeError, ValueError
        If it returns what is no finite real number.

    Examples
    --------
    >>> function_values(lambda x: max(x, 0.5), np.array([0.2, 0.8])).tolist()
    [0.5, 0.8]
    """
    if position.size > 1:
        try:
            values = np.asarray(function(position))
        except (TypeError, ValueError):
            values = np.empty(0)
        if values.dtype.kind in "iuf" and values.shape in (position.shape, ()):
            return np.broadcast_to(values, position.shape).astype(np.float64)
    # The function takes one number at a time, or fails here with its own words.
    return np.array([real("value of the function", _plain(function(at))) for at in position.tolist()])


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value


def smooth_parts(function: Function, length: float) -> tuple[tuple[float, ...], float]:
    """Return the edges of parts on which a function is smooth, and the largest error left on one.

    Each part, at first the beam or what lies between two breaks, is halved until the polynomial through its
    32 Gauss points is the function itself, and its reciprocal, at `SAMPLES` places along the beam and at 33
    places in every part:

        |p(x)/f(x) - 1| · width/L  <  1e-12.

    A feature as wide as L/4096 meets one of these places and is followed down to its own scale. A narrower
    one may fall between all of them: no sampling can find it, but `breaks` on both sides of it do. Steps and
    kinks that are no breaks are closed in on too, each at the cost of some 40 or 20 parts.

    Parameters
    ----------
    function : function
        Of positions [m]; parts do not cross the breaks of a `BrokenFunction`.
    length : float [m]

    Returns
    -------
    tuple of float, float
        The second is below 1e-12 unless 4,000 parts did not suffice.

    Examples
    --------
    >>> smooth_parts(lambda x: 9.0 + x, 2.0)[0]
    (0.0, 2.0)
    >>> notch = lambda x: 1.0 - 0.9 * np.exp(-(((x - 0.3) / 0.001) ** 2))
    >>> len(smooth_parts(notch, 1.0)[0]) > 10
    True
    """
    try:
        return _cut(function, length)
    except TypeError:
        # It cannot be a key; or fails with the same words once more.
        return _cut.__wrapped__(function, length)


@lru_cache(maxsize=64)
def _cut(function: Function, length: float) -> tuple[tuple[float, ...], float]:
    breaks = function.breaks if isinstance(function, BrokenFunction) else ()
    edges = np.array([0.0, *breaks, length])
    low, high = edges[:-1], edges[1:]
    done = {*edges.tolist()}
    # Halved 45 times, a part is narrower than two positions that count as one.
    for halving in range(46):
        error = _errors(function, low, high, length) * (high - low) / length
        rough = error > _TOLERANCE
        if not rough.any() or halving == 45 or len(done) + rough.sum() > _MOST_PARTS:
            break
        middle = 0.5 * (low[rough] + high[rough])
        low, high = np.concatenate((low[rough], middle)), np.concatenate((middle, high[rough]))
        done.update(middle.tolist())
    return tuple(sorted(done)), float(error.max())


def _errors(function: Function, low: Floats, high: Floats, length: float) -> Floats:
    """Return the largest relative error of each part's polynomials between its Gauss points."""
    node, weight = np.polynomial.legendre.leggauss(_POINTS)
    degree = np.arange(_POINTS)
    series = (degree + 0.5)[:, None] * np.polynomial.legendre.legvander(node, _POINTS - 1).T * weight
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    known = function_values(function, (middle[:, None] + half[:, None] * node).ravel()).reshape(-1, _POINTS)
    errors = np.zeros(len(low))
    counts = np.maximum(_BETWEEN, np.ceil(SAMPLES * (high - low) / length)).astype(int)
    for count in np.unique(counts).tolist():
        here = np.flatnonzero(counts == count)
        # Away from the middles of the lattice, where symmetric functions and later halves have their edges.
        place = (np.arange(count) + 0.382) / count * 2.0 - 1.0
        x = middle[here, None] + half[here, None] * place
        found = function_values(function, x.ravel()).reshape(x.shape)
        through = np.polynomial.legendre.legvander(place, _POINTS - 1) @ series
        with np.errstate(all="ignore"):
            wrong = np.abs(known[here] @ through.T - found) / np.abs(found)
            if (known[here] > 0.0).all() and (found > 0.0).all():
                wrong = np.maximum(wrong, np.abs((1.0 / known[here]) @ through.T * found - 1.0))
        # A zero of the function says nothing about its smoothness.
        errors[here] = np.where(np.isfinite(wrong), wrong, 0.0).max(axis=1)
    return errors
