"""Exact Euler-Bernoulli frequencies and mode shapes of the ten pairs of ends, the judge of all else.

With β the wavenumber times L, every characteristic equation of the ten pairs is one equation,

    β = (n + p) π + s (2/k) arctan e^(-kβ),

whose last term is the whole departure from the asymptote: solving for that term alone cancels nothing and
overflows nowhere.  It is cos β = ± sech β in half angles when both ends are "square" (clamped or free:
k = 1), tan β = ± tanh β when one is (k = 2), and absent, s = 0, when none is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.beam import Beam
from beammodes.checks import shown, whole_number
from beammodes.ends import BOUNDARIES, Boundary, BoundaryLike, End, boundary_codes

__all__ = ["BeamModes", "euler_bernoulli", "wavenumber", "wavenumber_of_code"]

_Floats = NDArray[np.float64]
_Integers = NDArray[np.integer[Any]]
_Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


class _Family(NamedTuple):
    """p, k, and s of the odd and the even modes, of the equation at the head of this module."""

    shift: float
    rate: int
    odd: int
    even: int


def _is_square(end: End) -> bool:
    """Say whether the exponentials of the shape have unit weight there (clamped or free)."""
    return end.holds_deflection == end.holds_rotation


def _family(pair: Boundary) -> _Family:
    squares = _is_square(pair.left) + _is_square(pair.right)
    if squares == 2:
        return _Family(0.5 if pair.left == pair.right else -0.5, 1, 1, -1)
    if squares == 1:
        other = pair.right if _is_square(pair.left) else pair.left
        return _Family(0.25, 2, -1, -1) if other.holds_deflection else _Family(-0.25, 2, 1, 1)
    return _Family(0.0 if pair.left == pair.right else -0.5, 1, 0, 0)


# The correction of mode 24 is below 1e-31: from there on it cannot be told from zero beside β > 70.
_CORRECTED = 24
# Below this mode number n * _PI_HEAD is exact in double precision.
_LAST_MODE = 10**12
# π in two parts: 201/64 has 8 bits, and sin(fl(π)) is what the double nearest π leaves out.
_PI_HEAD = 201.0 / 64.0
_PI_TAIL = (math.pi - _PI_HEAD) + math.sin(math.pi)
_SHIFT: _Floats = np.array([_family(pair).shift for pair in BOUNDARIES])


def _solve_corrections() -> _Floats:
    """Return β - (n + p) π, shape (codes, _CORRECTED + 1), for n = 0 (unused) to _CORRECTED."""
    mode = np.arange(_CORRECTED + 1)
    families = [_family(pair) for pair in BOUNDARIES]
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


def _half_waves(codes: _Integers, mode: _Integers) -> tuple[_Floats, _Floats]:
    """Return q and δ of β = q π + δ; q is exact, so that phases can be reduced without loss."""
    try:
        return _SHIFT[codes] + mode, _CORRECTION[codes, np.minimum(mode, _CORRECTED)]
    except ValueError:
        raise ValueError(
            f"boundary and mode must broadcast together, got shapes {codes.shape} and {mode.shape}"
        ) from None


def _joined(half_waves: _Floats, correction: _Floats) -> _Floats:
    return half_waves * _PI_HEAD + (half_waves * _PI_TAIL + correction)


def _integers(name: str, value: ArrayLike, least: int, most: int) -> _Integers:
    """Return `value` as int64, refusing what is not whole numbers in `least..most`."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise TypeError(f"{name} must be whole numbers in one regular array, got {shown(value)}") from None
    if array.ndim == 0:
        return np.asarray(whole_number(name, array.item(), least=least, most=most))
    if array.dtype.kind not in "iu":
        # NumPy turns a list with an integer above 2⁶³ into floats; as objects, items keep their types.
        objects = np.asarray(value, dtype=object).ravel()
        items = [whole_number(name, item, least=least, most=most) for item in objects]
        return np.array(items, dtype=np.int64).reshape(array.shape)
    outside = (array < least) | (array > most)
    if outside.any():
        whole_number(name, int(array[outside][0]), least=least, most=most)
    return array.astype(np.int64, copy=False)


@overload
def wavenumber(boundary: str | Boundary, mode: int) -> float: ...
@overload
def wavenumber(boundary: _Boundaries, mode: ArrayLike) -> float | _Floats: ...
def wavenumber(boundary: _Boundaries, mode: ArrayLike) -> float | _Floats:
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


def wavenumber_of_code(codes: ArrayLike, mode: ArrayLike) -> float | _Floats:
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
    pairs = _integers("codes", codes, 0, len(BOUNDARIES) - 1)
    roots = _joined(*_half_waves(pairs, _integers("mode", mode, 1, _LAST_MODE)))
    return float(roots) if roots.ndim == 0 else roots


@dataclass(frozen=True, slots=True, eq=False)
class BeamModes:
    """The first elastic modes of a uniform Euler-Bernoulli beam; `euler_bernoulli` makes it.

    Mode shapes have unit modal mass, ∫ ρA φₘ φₙ dx = 1 if m = n, else 0, and the sign that makes the first
    nonzero of φ, φ', φ'' positive at x = 0.  Ends' conditions hold to 1e-14 of each derivative's scale for
    modes 1 to 10⁶; inside, mode n keeps about 1e-15 n, which is what rounding x to a double costs.

    Parameters
    ----------
    beam : Beam
        The beam whose length, stiffness and mass give the results their units.
    boundary : Boundary
        The ends, at x = 0 and at x = L.
    wavenumber : ndarray, shape (modes,) [-]
        β, the dimensionless roots of elastic modes 1, 2, ..., read-only.

    Examples
    --------
    >>> modes = euler_bernoulli(Beam.unit(), "pinned-pinned", 2)
    >>> modes.shape([0.25, 0.5]).round(6) + 0.0
    array([[1.      , 1.414214],
           [1.414214, 0.      ]])
    """

    beam: Beam
    boundary: Boundary
    wavenumber: _Floats

    @property
    def angular_frequency(self) -> _Floats:
        """ω = β² √(EI / (ρA L⁴)), shape (modes,) [rad/s]."""
        return self.wavenumber**2 * self.beam.frequency_unit

    @property
    def frequency(self) -> _Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    @property
    def rigid_body_modes(self) -> int:
        """How many modes of zero frequency come before the elastic ones: 0, 1 or 2."""
        return self.boundary.rigid_body_modes

    def shape(self, x: ArrayLike, derivative: int = 0) -> _Floats:
        """Return the mode shapes φ, or a derivative dᵏφ/dxᵏ of them.

        φ = (a cos βξ + b sin βξ + c e^(-βξ) + d e^(-β(1-ξ))) / √(ρA L),  ξ = x/L

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L.
        derivative : int
            k, 0 to 3: deflection, slope, curvature, or the curvature's rate (shear force over EI).

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-k)]

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not a whole number in 0..3.

        Examples
        --------
        >>> tip = euler_bernoulli(Beam.unit(), "clamped-free", 3).shape([1.0])
        >>> tip.round(12).tolist()
        [[2.0], [-2.0], [2.0]]
        """
        order = whole_number("derivative", derivative, least=0, most=3)
        position = _positions(x, self.beam.length)
        from_left = position.ravel() / self.beam.length
        from_right = (self.beam.length - position.ravel()) / self.beam.length
        shapes = _unit_shapes(self.boundary, self.wavenumber, from_left, from_right, order)
        first = int(self.boundary.left.holds_deflection) * (1 + int(self.boundary.left.holds_rotation))
        start = _unit_shapes(self.boundary, self.wavenumber, np.zeros(1), np.ones(1), first)
        scale = np.sign(start) * (self.wavenumber[:, None] / self.beam.length) ** order
        # Two square roots: the product of mass per length and length may leave the range of doubles.
        scale /= math.sqrt(self.beam.mass_per_length) * math.sqrt(self.beam.length)
        return (scale * shapes).reshape(len(self.wavenumber), *position.shape)

    def slope(self, x: ArrayLike) -> _Floats:
        """Return dφ/dx, shape (modes, *x.shape) [kg^(-1/2) m^(-1)]: `shape(x, derivative=1)`.

        Examples
        --------
        >>> bool(euler_bernoulli(Beam.unit(), "pinned-free", 1).slope(0.0)[0] > 0)
        True
        """
        return self.shape(x, derivative=1)


def euler_bernoulli(beam: Beam, boundary: BoundaryLike, modes: int) -> BeamModes:
    """Return the first elastic modes of a beam under Euler-Bernoulli theory.

    EI φ'''' = ρA ω² φ  with two homogeneous conditions at each end.

    Parameters
    ----------
    beam : Beam
        The uniform beam.
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 10⁶.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a Beam, `boundary` cannot be read or `modes` is not a whole number in range.

    Examples
    --------
    >>> beam = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> euler_bernoulli(beam, "clamped-free", 3).frequency.round(3)
    array([ 4.55 , 28.515, 79.843])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    pair = Boundary.of(boundary)
    count = whole_number("modes", modes, most=10**6)
    roots = _joined(*_half_waves(boundary_codes(pair), np.arange(1, count + 1)))
    roots.flags.writeable = False
    return BeamModes(beam, pair, roots)


def _positions(x: ArrayLike, length: float) -> _Floats:
    try:
        array = np.asarray(x)
    except ValueError:
        raise TypeError(f"x must be real numbers in one regular array, got {shown(x)}") from None
    if array.dtype.kind not in "iuf":
        raise TypeError(f"x must be real numbers, got {shown(x)}")
    position = array.astype(np.float64)
    outside = ~((position >= 0.0) & (position <= length))
    if outside.any():
        raise ValueError(f"x must be finite and inside [0, {length}], got {position[outside][0]}")
    return position


def _coefficients(pair: Boundary, mode: _Integers, beta: _Floats) -> tuple[_Floats, ...]:
    """Return a, b, c, d of ∫ φ² dξ = 1, with a clamped or free end, if there is one, at ξ = 0.

    The conditions at ξ = 0 give a and b from c and d.  The ratio d/c is a symmetry: a pair of square ends
    is carried onto itself by φ(1-ξ) or φ''(1-ξ), and a pinned or guided end is the middle of a beam twice
    as long.  For all ten pairs 4 ∫ φ² dξ = φ² + φ''²/β⁴ - 2 φ' φ'''/β⁴ at either end (Rayleigh, The
    Theory of Sound, vol. 1, chapter VIII), here (2a)²: so the unit integral is just |a| = 1.
    """
    family, none = _family(pair), np.zeros_like(beta)
    if family.odd == 0:
        wave = np.full_like(beta, math.sqrt(2.0))
        return (none, wave, none, none) if pair.left.holds_deflection else (wave, none, none, none)
    sign = np.where(mode % 2, family.odd, family.even)
    across = sign * np.exp(-family.rate * beta)
    ratio = sign * np.exp(-(family.rate - 1) * beta)
    first = pair.left if _is_square(pair.left) else pair.right
    side = -1.0 if first.holds_deflection else 1.0
    return side + none, -side * (1.0 - across) / (1.0 + across), 1.0 / (1.0 + across), ratio / (1.0 + across)


def _unit_shapes(
    pair: Boundary, beta: _Floats, from_left: _Floats, from_right: _Floats, order: int
) -> _Floats:
    """Return β^(-order) dφ/dξ... of ∫ φ² dξ = 1, shape (modes, positions), its sign not yet chosen."""
    mode = np.arange(1, len(beta) + 1)
    half_waves, correction = _half_waves(boundary_codes(pair), mode)
    mirrored = _is_square(pair.right) and not _is_square(pair.left)
    near, far = (from_right, from_left) if mirrored else (from_left, from_right)
    a, b, c, d = (column[:, None] for column in _coefficients(pair, mode, beta))
    for _ in range(order):
        a, b, c = b, -a, -c
    # Whole waves go first: cos β itself would cost the far end's conditions β times the rounding.
    phase = math.pi * np.remainder(half_waves[:, None] * near, 2.0) + correction[:, None] * near
    waves = a * np.cos(phase) + b * np.sin(phase)
    shapes = waves + c * np.exp(-beta[:, None] * near) + d * np.exp(-beta[:, None] * far)
    return -shapes if mirrored and order % 2 else shapes
