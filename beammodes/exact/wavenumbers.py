"""Wavenumbers of the exact beam, all ten pairs of ends by one equation.

With β the wavenumber times L, every characteristic equation of the ten pairs is one equation,

    β = (n + p) π + s (2/k) arctan e^(-kβ),

whose last term is the whole departure from the asymptote: solving for that term alone cancels nothing and
overflows nowhere.  It is cos β = ± sech β in half angles when both ends are "square" (clamped or free:
k = 1), tan β = ± tanh β when one is (k = 2), and absent, s = 0, when none is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Integral
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import plain_array, shown, whole_number
from beammodes.problem.ends import BOUNDARIES, Boundary, BoundaryLike, End, boundary_codes

__all__ = [
    "Family",
    "family_of",
    "is_square",
    "joined",
    "split_wavenumber",
    "wavenumber",
    "wavenumber_of_code",
    "whole_numbers",
]

Floats = NDArray[np.float64]
Integers = NDArray[np.integer[Any]]
Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


class Family(NamedTuple):
    """p, k, and s of the odd and the even modes, of the equation at the head of this module."""

    shift: float
    rate: int
    odd: int
    even: int


def is_square(end: End) -> bool:
    """Say whether the exponentials of the shape have unit weight there (clamped or free)."""
    return end.holds_deflection == end.holds_rotation


def family_of(pair: Boundary) -> Family:
    """Return the numbers of the equation at the head of this module for a pair of ends."""
    squares = is_square(pair.left) + is_square(pair.right)
    if squares == 2:
        return Family(0.5 if pair.left == pair.right else -0.5, 1, 1, -1)
    if squares == 1:
        other = pair.right if is_square(pair.left) else pair.left
        return Family(0.25, 2, -1, -1) if other.holds_deflection else Family(-0.25, 2, 1, 1)
    return Family(0.0 if pair.left == pair.right else -0.5, 1, 0, 0)


# The correction of mode 24 is below 1e-31: from there on it cannot be told from zero beside β > 70.
_CORRECTED = 24

# Below this mode number n * _PI_HEAD is exact in double precision.
_LAST_MODE = 10**12

# π in two parts: 201/64 has 8 bits, and sin(fl(π)) is what the double nearest π leaves out.
_PI_HEAD = 201.0 / 64.0
_PI_TAIL = (math.pi - _PI_HEAD) + math.sin(math.pi)
_SHIFT: Floats = np.array([family_of(pair).shift for pair in BOUNDARIES])


def _solve_corrections() -> Floats:
    """Return β - (n + p) π, shape (codes, _CORRECTED + 1), for n = 0 (unused) to _CORRECTED."""
    mode = np.arange(_CORRECTED + 1)
    families = [family_of(pair) for pair in BOUNDARIES]
    rate = np.array([[float(f.rate)] for f in families])
    sign = np.array([np.where(mode % 2, f.odd, f.even) for f in families])
    sign[:, 0] = 0
    asymptote = (mode + _SHIFT[:, None]) * math.pi
    correction = np.zeros_like(asymptote)
    for _ in range(6):  # The slowest, clamped-free mode 1, starts 0.3 off and settles in 5.
        decay = np.exp(-rate * (asymptote + correction))
        excess = correction - sign * 2.0 / rate * np.arctan(decay)
        correction -= excess / (1.0 + sign * 2.0 * decay / (1.0 + decay**2))
    return correction


_CORRECTION = _solve_corrections()


def split_wavenumber(codes: Integers, mode: Integers) -> tuple[Floats, Floats]:
    """Return q and δ of β = q π + δ; q is exact, so that phases can be reduced without loss."""
    try:
        return _SHIFT[codes] + mode, _CORRECTION[codes, np.minimum(mode, _CORRECTED)]
    except ValueError:
        raise ValueError(
            f"boundary and mode must broadcast together, got shapes {codes.shape} and {mode.shape}"
        ) from None


def joined(half_waves: Floats, correction: Floats) -> Floats:
    """Return q π + δ; π enters in two parts, of which q times the first is exact."""
    return half_waves * _PI_HEAD + (half_waves * _PI_TAIL + correction)


def whole_numbers(name: str, value: ArrayLike, *, least: int = 1, most: int) -> NDArray[np.int64]:
    """Return `value` as int64, refusing what is not whole numbers in `least..most`.

    Raises
    ------
    TypeError, ValueError
        If `value` is not whole numbers in one regular array, or one of them lies outside the range.

    Examples
    --------
    >>> whole_numbers("mode", [[1], [2]], most=10).shape
    (2, 1)
    """
    if isinstance(value, int | np.integer):
        return np.asarray(whole_number(name, value, least=least, most=most))
    array = plain_array(name, value)
    if array.ndim == 0:
        return np.asarray(whole_number(name, array.item(), least=least, most=most))
    if array.dtype.kind not in "iu":
        items = array.ravel().tolist()
        if not all(isinstance(item, Integral) and not isinstance(item, bool) for item in items):
            allowed = f"whole numbers of at least {least} and at most {most}"
            raise TypeError(f"{name} must be {allowed}, got {shown(value)}")
        whole = [whole_number(name, item, least=least, most=most) for item in items]
        return np.array(whole, dtype=np.int64).reshape(array.shape)
    outside = (array < least) | (array > most)
    if outside.any():
        whole_number(name, int(array[outside][0]), least=least, most=most)
    return array.astype(np.int64, copy=False)


@overload
def wavenumber(boundary: str | Boundary, mode: int) -> float: ...
@overload
def wavenumber(boundary: Boundaries, mode: ArrayLike) -> float | Floats: ...
def wavenumber(boundary: Boundaries, mode: ArrayLike) -> float | Floats:
    """Return β = (wavenumber) L, the dimensionless root of an elastic mode.

    cos β cosh β = 1 (clamped-clamped, free-free), cos β cosh β = -1 (clamped-free), tan β = tanh β
    (clamped-pinned, pinned-free), tan β = -tanh β (clamped-guided, guided-free), sin β = 0
    (pinned-pinned, guided-guided), cos β = 0 (pinned-guided); the angular frequency is β² √(EI/(ρA L⁴)).
    Every root is within one unit in the last place, for modes 1 to 10¹².

    Parameters
    ----------
    boundary : boundary, or array or list of boundaries
        As `ends.boundary_codes` reads them; either order of the two ends.
    mode : int or array of int
        Elastic modes, from 1: rigid-body modes are not counted.  Broadcasts with `boundary`.

    Returns
    -------
    float, or array of the broadcast shape [-]

    Raises
    ------
    TypeError, ValueError
        If `boundary` cannot be read, `mode` is not whole numbers in 1..10¹², or shapes do not match.

    Source
    ------
    Equations: Rayleigh, The Theory of Sound, vol. 1, chapter VIII; Blevins, Formulas for Natural
    Frequency and Mode Shape (1979), table 8-1.  Roots are solved, never copied.

    Examples
    --------
    >>> round(wavenumber("clamped-free", 1), 9)
    1.875104069
    >>> wavenumber([["pinned-pinned"], ["free-free"]], [1, 2]).round(4)
    array([[3.1416, 6.2832],
           [4.73  , 7.8532]])
    """
    return wavenumber_of_code(boundary_codes(boundary), mode)


def wavenumber_of_code(codes: ArrayLike, mode: ArrayLike) -> float | Floats:
    """Return `wavenumber` for indices into `ends.BOUNDARIES`: the fast path, which reads no names.

    β = (n + p) π + s (2/k) arctan e^(-kβ), p, k and s being those of the pair of ends.

    Parameters
    ----------
    codes : int or array of int
        Indices into `ends.BOUNDARIES`, 0 to 9.
    mode : int or array of int
        Elastic modes, 1 to 10¹².  Broadcasts with `codes`.

    Raises
    ------
    TypeError, ValueError
        If either is not whole numbers in its range, or their shapes do not match.

    Examples
    --------
    >>> wavenumber_of_code(3, 1) == wavenumber("free-clamped", 1)
    True
    """
    pairs = whole_numbers("codes", codes, least=0, most=len(BOUNDARIES) - 1)
    roots = joined(*split_wavenumber(pairs, whole_numbers("mode", mode, most=_LAST_MODE)))
    return float(roots) if roots.ndim == 0 else roots
