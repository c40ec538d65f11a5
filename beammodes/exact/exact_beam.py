"""Exact modes of the uniform Euler-Bernoulli beam between plain ends, and what all exact modes share.

With β the wavenumber times L, every characteristic equation of the ten pairs of ends is one equation,

    β = (n + p) π + s (2/k) arctan e^(-kβ),

whose last term is the whole departure from the asymptote: solving for that term alone cancels nothing and
overflows nowhere.  It is cos β = ± sech β in half angles when both ends are "square" (clamped or free:
k = 1), tan β = ± tanh β when one is (k = 2), and absent, s = 0, when none is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import Shown, brief, row_shown, shown, whole_number, whole_numbers
from beammodes.numerics.arrays import Floats, keeps_labels
from beammodes.problem.beam import Beam, positions_on
from beammodes.problem.ends import BOUNDARIES, Boundary, BoundaryLike, End, boundary_codes

__all__ = [
    "BeamModes",
    "EulerBernoulliModes",
    "ExactModes",
    "Theory",
    "first_free",
    "plain_modes",
    "wavenumber",
    "wavenumber_of_code",
]

Integers = NDArray[np.integer[Any]]
Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


# The correction of mode 24 is below 1e-31: from there on it cannot be told from zero beside β > 70.
_CORRECTED = 24
# Below this mode number n * _PI_HEAD is exact in double precision.
_LAST_MODE = 10**12
# π in two parts: 201/64 has 8 bits, and sin(fl(π)) is what the double nearest π leaves out.
_PI_HEAD = 201.0 / 64.0
_PI_TAIL = (math.pi - _PI_HEAD) + math.sin(math.pi)


class _Family(NamedTuple):
    """p, k, and s of the odd and the even modes, of the equation at the head of this module."""

    shift: float
    rate: int
    odd: int
    even: int

    @classmethod
    def of(cls, pair: Boundary) -> _Family:
        squares = _is_square(pair.left) + _is_square(pair.right)
        if squares == 2:
            return cls(0.5 if pair.left == pair.right else -0.5, 1, 1, -1)
        if squares == 1:
            other = pair.right if _is_square(pair.left) else pair.left
            return cls(0.25, 2, -1, -1) if other.holds_deflection else cls(-0.25, 2, 1, 1)
        return cls(0.0 if pair.left == pair.right else -0.5, 1, 0, 0)


def _is_square(end: End) -> bool:
    """Return whether the exponentials of the shape have unit weight there: at clamped and free ends."""
    return end.holds_deflection == end.holds_rotation


_SHIFT: Floats = np.array([_Family.of(pair).shift for pair in BOUNDARIES])


def _solve_corrections() -> Floats:
    """Return β - (n + p) π, shape (codes, _CORRECTED + 1), for n = 0 (unused) to _CORRECTED."""
    mode = np.arange(_CORRECTED + 1)
    families = [_Family.of(pair) for pair in BOUNDARIES]
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


def _split(codes: Integers, mode: Integers) -> tuple[Floats, Floats]:
    """Return q and δ of β = q π + δ; q is exact, so that phases can be reduced without loss."""
    try:
        return _SHIFT[codes] + mode, _CORRECTION[codes, np.minimum(mode, _CORRECTED)]
    except ValueError:
        raise ValueError(
            f"boundary and mode must broadcast together, got shapes {codes.shape} and {mode.shape}"
        ) from None


@overload
def _joined(half_waves: float, correction: float) -> float: ...


@overload
def _joined(half_waves: Floats, correction: Floats) -> Floats: ...


def _joined(half_waves: float | Floats, correction: float | Floats) -> float | Floats:
    """Return q π + δ; π enters in two parts, of which q times the first is exact."""
    return half_waves * _PI_HEAD + (half_waves * _PI_TAIL + correction)


@overload
def wavenumber(boundary: str | Boundary, mode: int) -> float: ...


@overload
def wavenumber(boundary: Boundaries, mode: ArrayLike) -> float | Floats: ...


@keeps_labels
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

    References
    ----------
    Equations: Rayleigh, The Theory of Sound, vol. 1, chapter VIII; Blevins, Formulas for Natural
    Frequency and Mode Shape (1979), table 8-1.

    Examples
    --------
    >>> import beammodes as bm
    >>> round(bm.wavenumber("clamped-free", 1), 9)
    1.875104069
    >>> bm.wavenumber([["pinned-pinned"], ["free-free"]], [1, 2]).round(4)
    array([[3.1416, 6.2832],
           [4.73  , 7.8532]])
    """
    return wavenumber_of_code(boundary_codes(boundary), mode)


def wavenumber_of_code(codes: ArrayLike, mode: ArrayLike) -> float | Floats:
    """Return `wavenumber` for indices into `ends.BOUNDARIES`, 0 to 9, without reading names.

    Examples
    --------
    >>> wavenumber_of_code(3, 1) == wavenumber("free-clamped", 1)
    True
    """
    if type(codes) is int and type(mode) is int:
        pair = whole_number("codes", codes, least=0, most=len(BOUNDARIES) - 1)
        number = whole_number("mode", mode, most=_LAST_MODE)
        return _joined(_SHIFT.item(pair) + number, _CORRECTION.item(pair, min(number, _CORRECTED)))
    pairs = whole_numbers("codes", codes, least=0, most=len(BOUNDARIES) - 1)
    roots = _joined(*_split(pairs, whole_numbers("mode", mode, most=_LAST_MODE)))
    return float(roots) if roots.ndim == 0 else roots


#: A function of ω_Timoshenko/ω - 1, None if the section is unknown, and its assumptions in words.
Theory: TypeAlias = tuple[Callable[[], Floats | None], tuple[str, ...]]


class _Answer(Protocol):
    """The interface that `ExactModes` needs of its subclasses."""

    @property
    def beam(self) -> Beam: ...
    @property
    def angular_frequency(self) -> Floats: ...
    @property
    def frequency(self) -> Floats: ...
    @property
    def _smoothest(self) -> int: ...
    def _values(self, from_left: Floats, from_right: Floats, order: int, /) -> Floats: ...
    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats: ...


class _Judged(_Answer, Protocol):
    """The interface that `EulerBernoulliModes` needs of its subclasses."""

    @property
    def boundary(self) -> Boundary: ...

    @property
    def theory(self) -> Theory | None: ...


class ExactModes(Shown):
    """Frequencies and shapes of exact modes, whichever way their beam was solved.

    Shapes have the sign that makes the first of deflection, rotation and curvature that the left end does not
    hold positive there.
    """

    __slots__ = ()

    @property
    def frequency(self: _Answer) -> Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def shape(self: _Answer, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes φ, or a derivative dᵏφ/dxᵏ of them.

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L; at a step of EI curvature is that on its right.
        derivative : int
            k, from 0: deflection, slope, curvature, and the curvature's rate. Up to 3 of a uniform beam, to
            2 of one that varies, and to 1 of Timoshenko's, whose slope is its rotation and shear strain.

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-k)]

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not a whole number in its range.

        Examples
        --------
        >>> import beammodes as bm
        >>> bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", 3).shape([1.0]).round(12).tolist()
        [[2.0], [-2.0], [2.0]]
        """
        order = whole_number("derivative", derivative, least=0, most=self._smoothest)
        position, length = positions_on(self.beam, x), self.beam.length
        flat = position.ravel()
        values = self._values(flat / length, (length - flat) / length, order)
        # Two square roots: the product of mass per length and length may leave the range of doubles.
        unit = math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(length) * length**order
        return (values / unit).reshape(len(values), *position.shape)

    def slope(self: _Answer, x: ArrayLike) -> Floats:
        """Return dφ/dx, shape (modes, *x.shape) [kg^(-1/2) m^(-1)]: `shape(x, derivative=1)`."""
        return self.shape(x, derivative=1)


def first_free(end: End) -> int:
    """Return the order of the first derivative of the deflection, 0 to 2, that an end does not hold."""
    return int(end.holds_deflection) * (1 + int(end.holds_rotation))


class EulerBernoulliModes(ExactModes):
    """Exact modes that tell how far their theory itself is off."""

    __slots__ = ()

    @property
    def theory_error(self: _Judged) -> Floats:
        """ω_Timoshenko/ω - 1, shape (modes,) [-]: the error of this theory itself, computed when asked for.

        NaN where the beam's section is not known (`Beam.from_section` knows it, or give `radius_of_gyration`
        or ρI), from Timoshenko's cut-off frequency on, beyond mode 100, and on a turning hub.
        `theory_assumed` says what is assumed.
        """
        found = self.theory[0]() if self.theory else None
        return np.full(len(self.angular_frequency), np.nan) if found is None else found

    @property
    def theory_assumed(self: _Judged) -> tuple[str, ...]:
        """The assumptions of `theory_error`, in words; empty if there are none."""
        return self.theory[1] if self.theory else ()

    @property
    def theory_words(self: _Judged) -> str:
        """What is to be said of the theory's own error, in one sentence."""
        return "".join(_theory_words(self))

    def _line(self: _Judged) -> str:
        short, more = _theory_words(self)
        line = f"{type(self).__name__}({self.boundary}: {row_shown(self.frequency, '{:.4g}', 'Hz')}; {short}"
        whole = f"{line}{more})"
        return whole if brief(whole) == whole else f"{line})"


def _theory_words(modes: _Judged) -> tuple[str, str]:
    """Return what an answer says of the theory's own error, and what that supposes."""
    try:
        errors = modes.theory[0]() if modes.theory else None
    except (ValueError, ArithmeticError):
        return "theory error not found", ""
    if errors is None:
        relative = modes.angular_frequency / modes.beam.frequency_unit
        slenderness = 6.0 * np.sqrt(float(relative[-1])) if len(relative) else 0.0
        solid = (
            f": 1 % or less if it is a solid one, assumed, no higher than L/{float(f'{slenderness:.2g}'):g}"
        )
        if modes.beam.shear_stiffness is not None and not modes.beam.has_rotary_inertia:
            return "theory error not known without rotary inertia", solid
        return "theory error not known without a section", solid
    told = f"theory error {row_shown(100.0 * errors, '{:+.3g}', '%')}"
    assumed = f", assumed: {', '.join(modes.theory[1])}" if modes.theory and modes.theory[1] else ""
    return told, f" (Timoshenko's beam{assumed})"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BeamModes(EulerBernoulliModes):
    """The first elastic modes of a uniform Euler-Bernoulli beam; `plain_modes` makes it.

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
    theory : Theory, optional
        The theory's own error; `euler_bernoulli` gives it.

    Examples
    --------
    >>> modes = plain_modes(Beam.unit(), "pinned-pinned", 2)
    >>> modes.shape([0.25, 0.5]).round(6) + 0.0
    array([[1.      , 1.414214],
           [1.414214, 0.      ]])
    """

    beam: Beam
    boundary: Boundary
    wavenumber: Floats
    theory: Theory | None = None

    @property
    def angular_frequency(self) -> Floats:
        """ω = β² √(EI / (ρA L⁴)), shape (modes,) [rad/s]."""
        return self.wavenumber**2 * self.beam.frequency_unit

    @property
    def rigid_body_modes(self) -> int:
        """The number of modes of zero frequency before the elastic ones: 0, 1 or 2."""
        return self.boundary.rigid_body_modes

    _smoothest = 3

    def _values(self, from_left: Floats, from_right: Floats, order: int) -> Floats:
        """Return φ = a cos βξ + b sin βξ + c e^(-βξ) + d e^(-β(1-ξ)), or a derivative by ξ."""
        shapes = _unit_shapes(self.boundary, self.wavenumber, from_left, from_right, order)
        first = first_free(self.boundary.left)
        start = _unit_shapes(self.boundary, self.wavenumber, np.zeros(1), np.ones(1), first)
        return np.asarray(np.sign(start) * self.wavenumber[:, None] ** order * shapes)


def plain_modes(beam: Beam, boundary: BoundaryLike, modes: int) -> BeamModes:
    """Return the first elastic modes, 1 to 10⁶, of a uniform beam between plain ends.

    EI φ'''' = ρA ω² φ  with two homogeneous conditions at each end; rotary inertia is left out.

    Examples
    --------
    >>> plain_modes(Beam.unit(), "clamped-free", 3).angular_frequency.round(3)
    array([ 3.516, 22.034, 61.697])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    pair = Boundary.of(boundary)
    count = whole_number("modes", modes, most=10**6)
    roots = _joined(*_split(boundary_codes(pair), np.arange(1, count + 1)))
    roots.flags.writeable = False
    return BeamModes(beam, pair, roots)


def _coefficients(pair: Boundary, mode: Integers, beta: Floats) -> tuple[Floats, ...]:
    """Return a, b, c, d of ∫ φ² dξ = 1, with a clamped or free end, if there is one, at ξ = 0.

    The conditions at ξ = 0 give a and b from c and d. The ratio d/c is a symmetry: a pair of square ends
    is carried onto itself by φ(1-ξ) or φ''(1-ξ), and a pinned or guided end is the middle of a beam twice
    as long.  For all ten pairs 4 ∫ φ² dξ = φ² + φ''²/β⁴ - 2 φ' φ'''/β⁴ at either end (Rayleigh, The
    Theory of Sound, vol. 1, chapter VIII), here (2a)²: so the unit integral is just |a| = 1.
    """
    family, none = _Family.of(pair), np.zeros_like(beta)
    if family.odd == 0:
        wave = np.full_like(beta, math.sqrt(2.0))
        return (none, wave, none, none) if pair.left.holds_deflection else (wave, none, none, none)
    sign = np.where(mode % 2, family.odd, family.even)
    across = sign * np.exp(-family.rate * beta)
    ratio = sign * np.exp(-(family.rate - 1) * beta)
    first = pair.left if _is_square(pair.left) else pair.right
    side = -1.0 if first.holds_deflection else 1.0
    return side + none, -side * (1.0 - across) / (1.0 + across), 1.0 / (1.0 + across), ratio / (1.0 + across)


def _unit_shapes(pair: Boundary, beta: Floats, from_left: Floats, from_right: Floats, order: int) -> Floats:
    """Return β^(-order) dφ/dξ... of ∫ φ² dξ = 1, shape (modes, positions), its sign not yet chosen."""
    mode = np.arange(1, len(beta) + 1)
    half_waves, correction = _split(boundary_codes(pair), mode)
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
