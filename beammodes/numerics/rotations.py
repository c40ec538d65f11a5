"""Rotations and screws in space: exponentials, logarithms, and motions along a path whose rate is given."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from beammodes.numerics.arrays import Floats

__all__ = ["accumulated", "carried", "cross_matrix", "quaternion", "rotation", "rotation_vector", "screw"]

#: Below this angle series are exact to the last digit with five terms.
_SMALL = 0.25

_GAUSS = 0.5 + np.array([-0.5, 0.0, 0.5]) * np.sqrt(0.6)

#: Steps into which one interval is cut at most, and the largest change of a halving that ends it.
_MOST_STEPS, _SETTLED = 256, 1e-12


def cross_matrix(vector: Floats) -> Floats:
    """Return the matrices of  v ×,  shape (..., 3, 3), of vectors of shape (..., 3).

    Examples
    --------
    >>> (cross_matrix(np.array([0.0, 0.0, 2.0])) @ [1.0, 0.0, 0.0]).tolist()
    [0.0, 2.0, 0.0]
    """
    matrix = np.zeros((*np.shape(vector), 3))
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    matrix[..., 0, 1], matrix[..., 0, 2], matrix[..., 1, 2] = -z, y, -x
    matrix[..., 1, 0], matrix[..., 2, 0], matrix[..., 2, 1] = z, -y, x
    return matrix


def _coefficients(angle: Floats) -> tuple[Floats, Floats, Floats]:
    """Return  sin θ/θ,  (1 - cos θ)/θ²  and  (θ - sin θ)/θ³."""
    first, second = np.sinc(angle / np.pi), 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    square = np.where(angle < _SMALL, angle, 0.0) ** 2
    series = (1 - square / 20 * (1 - square / 42 * (1 - square / 72 * (1 - square / 110)))) / 6
    large = np.where(angle < _SMALL, 1.0, angle)
    third = np.where(angle < _SMALL, series, (1.0 - first) / large**2)
    return first[..., None, None], second[..., None, None], third[..., None, None]


def rotation(vector: Floats) -> Floats:
    """Return the rotations about and by vectors, shape (..., 3, 3).

    Examples
    --------
    >>> rotation(np.array([0.0, 0.0, np.pi / 2])).round(12)[0].tolist()
    [0.0, -1.0, 0.0]
    """
    cross = cross_matrix(vector)
    first, second, _ = _coefficients(np.sqrt((vector**2).sum(axis=-1)))
    turned: Floats = np.eye(3) + first * cross + second * (cross @ cross)
    return turned


def quaternion(matrix: Floats) -> Floats:
    """Return unit quaternions (w, x, y, z) of rotations, w ≥ 0, shape (..., 4).

    Examples
    --------
    >>> quaternion(rotation(np.array([0.0, 0.0, np.pi / 2]))).round(6).tolist()
    [0.707107, 0.0, 0.0, 0.707107]
    """
    # By its largest component (Shepperd 1978): right to the last digits at every angle.
    m = matrix
    trace = np.trace(m, axis1=-2, axis2=-1)
    diagonal = np.diagonal(m, axis1=-2, axis2=-1)
    squares = np.concatenate([(1 + trace)[..., None], 1 + 2 * diagonal - trace[..., None]], axis=-1)
    skew = np.stack(
        [m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], axis=-1
    )
    outer = np.zeros((*trace.shape, 4, 4))
    outer[..., 0, 1:] = outer[..., 1:, 0] = skew
    outer[..., 1:, 1:] = m + np.swapaxes(m, -1, -2)
    for k in range(4):
        outer[..., k, k] = squares[..., k]
    largest = squares.argmax(axis=-1)
    row = np.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    row = row / np.sqrt((row**2).sum(axis=-1, keepdims=True))
    unit: Floats = np.where(row[..., :1] < 0, -row, row)
    return unit


def rotation_vector(matrix: Floats) -> Floats:
    """Return the vectors about and by which matrices turn, of length up to π; the inverse of `rotation`.

    Examples
    --------
    >>> rotation_vector(rotation(np.array([0.1, -3.0, 0.2]))).round(12).tolist()
    [0.1, -3.0, 0.2]
    """
    row = quaternion(matrix)
    half = np.sqrt((row[..., 1:] ** 2).sum(axis=-1))
    angle = 2 * np.arctan2(half, row[..., 0])
    share = np.where(half > 0, angle / np.where(half > 0, half, 1.0), 2.0)
    vector: Floats = share[..., None] * row[..., 1:]
    return vector


def screw(turn: Floats, shift: Floats) -> tuple[Floats, Floats]:
    """Return rotation and displacement of moving for unit time at constant rates in one's own axes.

    Examples
    --------
    >>> screw(np.array([0.0, 0.0, np.pi]), np.array([np.pi, 0.0, 0.0]))[1].round(12).tolist()
    [0.0, 2.0, 0.0]
    """
    cross = cross_matrix(turn)
    first, second, third = _coefficients(np.sqrt((turn**2).sum(axis=-1)))
    square, plain = cross @ cross, np.eye(3)
    along = (plain + second * cross + third * square) @ shift[..., None]
    return plain + first * cross + second * square, along[..., 0]


def carried(rate: Callable[[Floats], Floats], start: Floats, stop: Floats) -> tuple[Floats, Floats]:
    """Return how a frame that moves along its own x axis at unit speed has turned and moved over intervals.

        R' = R [κ(s) ×],   r' = R e_x

    By Magnus's series of sixth order in rigid motions, in as many steps as leave it exact.

    Parameters
    ----------
    rate : function
        κ of positions of shape (n,), shape (n, 3), in the frame's own axes; smooth in each interval.
    start, stop : ndarray, shape (n,)

    Returns
    -------
    ndarray, ndarray
        Rotation and displacement in the axes at the start, shape (n, 3, 3) and (n, 3).

    References
    ----------
    S. Blanes, F. Casas, J. A. Oteo, J. Ros, Physics Reports 470 (2009), 151-238, equation 254.

    Examples
    --------
    >>> turned, moved = carried(lambda s: np.outer(2 * s, [0, 0, 1]), np.zeros(1), np.ones(1))
    >>> moved.round(9).tolist()                                   # Fresnel's integrals, of cos s² and sin s²
    [[0.904524238, 0.310268302, 0.0]]
    """
    before = _in_steps(rate, start, stop, 1)
    steps = 1
    while steps < _MOST_STEPS:
        steps *= 2
        after = _in_steps(rate, start, stop, steps)
        size = np.abs(stop - start)[:, None] + 1e-300
        change = np.abs(after[0] - before[0]).max(initial=0.0)
        change = max(change, (np.abs(after[1] - before[1]) / size).max(initial=0.0))
        before = after
        # The sixth order leaves a 64th of the change, or the rounding of so many steps.
        if change < _SETTLED:
            break
    return before


def _in_steps(
    rate: Callable[[Floats], Floats], start: Floats, stop: Floats, steps: int
) -> tuple[Floats, Floats]:
    width = (stop - start) / steps
    turned = np.broadcast_to(np.eye(3), (len(start), 3, 3)).copy()
    moved = np.zeros((len(start), 3))
    for step in range(steps):
        low = start + step * width
        one, two, three = (rate(low + place * width) * width[:, None] for place in _GAUSS)
        # Twists (turn, shift), whose constant part of shift is the unit speed.
        first = (two, np.stack([width, 0 * width, 0 * width], axis=-1))
        second = (np.sqrt(15) / 3 * (three - one), np.zeros_like(two))
        third = (10 / 3 * (three - 2 * two + one), np.zeros_like(two))
        c1 = _bracket(first, second)
        c2 = _bracket(first, (2 * third[0] + c1[0], 2 * third[1] + c1[1]))
        left = (-20 * first[0] - third[0] + c1[0], -20 * first[1] - third[1] + c1[1])
        last = _bracket(left, (second[0] - c2[0] / 60, second[1] - c2[1] / 60))
        turn, shift = (first[k] + third[k] / 12 + last[k] / 240 for k in range(2))
        rotated, along = screw(turn, shift)
        moved += (turned @ along[..., None])[..., 0]
        turned = turned @ rotated
    return turned, moved


def _bracket(one: tuple[Floats, Floats], two: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Return the commutator of two twists, of its sign where rates are in the moving axes."""
    return np.cross(two[0], one[0]), np.cross(two[0], one[1]) - np.cross(one[0], two[1])


def accumulated(turned: Floats, moved: Floats) -> tuple[Floats, Floats]:
    """Return the frames that motions in a row lead to, each in the axes at its own start.

    Returns
    -------
    ndarray, ndarray
        Rotations and positions before the first motion and after each, shape (n + 1, 3, 3) and (n + 1, 3).

    Examples
    --------
    >>> quarter = rotation(np.array([[0.0, 0.0, np.pi / 2]] * 2))
    >>> accumulated(quarter, np.array([[1.0, 0.0, 0.0]] * 2))[1].round(12).tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    """
    frames, places = turned.copy(), moved.copy()
    reach = 1
    while reach < len(frames):
        # All sums of twice the reach at once, as in every parallel prefix sum.
        places[reach:] = places[:-reach] + (frames[:-reach] @ places[reach:, :, None])[..., 0]
        frames[reach:] = frames[:-reach] @ frames[reach:]
        reach *= 2
    whole, origin = np.eye(3)[None], np.zeros((1, 3))
    return np.concatenate([whole, frames]), np.concatenate([origin, places])
