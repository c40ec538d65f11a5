"""Exact Euler-Bernoulli modes for the ten pairs of ends, frequencies and shapes: the judge of all else."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import shown, whole_number
from beammodes.exact.printed_modes import EulerBernoulliModes, Theory
from beammodes.exact.wavenumbers import (
    family_of,
    is_square,
    joined,
    split_wavenumber,
    wavenumber,
    wavenumber_of_code,
)
from beammodes.problem.beam import Beam
from beammodes.problem.beam_positions import positions_on
from beammodes.problem.ends import Boundary, BoundaryLike, boundary_codes

__all__ = ["BeamModes", "plain_modes", "wavenumber", "wavenumber_of_code"]

Floats = NDArray[np.float64]
Integers = NDArray[np.integer[Any]]


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
        What tells the theory's own error; `euler_bernoulli` gives it.

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
        """How many modes of zero frequency come before the elastic ones: 0, 1 or 2."""
        return self.boundary.rigid_body_modes

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
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
        >>> tip = plain_modes(Beam.unit(), "clamped-free", 3).shape([1.0])
        >>> tip.round(12).tolist()
        [[2.0], [-2.0], [2.0]]
        """
        order = whole_number("derivative", derivative, least=0, most=3)
        position = positions_on(self.beam, x)
        from_left = position.ravel() / self.beam.length
        from_right = (self.beam.length - position.ravel()) / self.beam.length
        shapes = _unit_shapes(self.boundary, self.wavenumber, from_left, from_right, order)
        first = int(self.boundary.left.holds_deflection) * (1 + int(self.boundary.left.holds_rotation))
        start = _unit_shapes(self.boundary, self.wavenumber, np.zeros(1), np.ones(1), first)
        scale = np.sign(start) * (self.wavenumber[:, None] / self.beam.length) ** order
        # Two square roots: the product of mass per length and length may leave the range of doubles.
        scale /= math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(self.beam.length)
        return (scale * shapes).reshape(len(self.wavenumber), *position.shape)


def plain_modes(beam: Beam, boundary: BoundaryLike, modes: int) -> BeamModes:
    """Return the first elastic modes of a uniform Euler-Bernoulli beam between plain ends.

    EI φ'''' = ρA ω² φ  with two homogeneous conditions at each end.

    Parameters
    ----------
    beam : Beam
        Its rotary inertia, if it has any, is left out.
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 10⁶.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam, `boundary` is not a plain pair or `modes` is not a whole number in
        range.

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
    roots = joined(*split_wavenumber(boundary_codes(pair), np.arange(1, count + 1)))
    roots.flags.writeable = False
    return BeamModes(beam, pair, roots)


def _coefficients(pair: Boundary, mode: Integers, beta: Floats) -> tuple[Floats, ...]:
    """Return a, b, c, d of ∫ φ² dξ = 1, with a clamped or free end, if there is one, at ξ = 0.

    The conditions at ξ = 0 give a and b from c and d.  The ratio d/c is a symmetry: a pair of square ends
    is carried onto itself by φ(1-ξ) or φ''(1-ξ), and a pinned or guided end is the middle of a beam twice
    as long.  For all ten pairs 4 ∫ φ² dξ = φ² + φ''²/β⁴ - 2 φ' φ'''/β⁴ at either end (Rayleigh, The
    Theory of Sound, vol. 1, chapter VIII), here (2a)²: so the unit integral is just |a| = 1.
    """
    family, none = family_of(pair), np.zeros_like(beta)
    if family.odd == 0:
        wave = np.full_like(beta, math.sqrt(2.0))
        return (none, wave, none, none) if pair.left.holds_deflection else (wave, none, none, none)
    sign = np.where(mode % 2, family.odd, family.even)
    across = sign * np.exp(-family.rate * beta)
    ratio = sign * np.exp(-(family.rate - 1) * beta)
    first = pair.left if is_square(pair.left) else pair.right
    side = -1.0 if first.holds_deflection else 1.0
    return side + none, -side * (1.0 - across) / (1.0 + across), 1.0 / (1.0 + across), ratio / (1.0 + across)


def _unit_shapes(pair: Boundary, beta: Floats, from_left: Floats, from_right: Floats, order: int) -> Floats:
    """Return β^(-order) dφ/dξ... of ∫ φ² dξ = 1, shape (modes, positions), its sign not yet chosen."""
    mode = np.arange(1, len(beta) + 1)
    half_waves, correction = split_wavenumber(boundary_codes(pair), mode)
    mirrored = is_square(pair.right) and not is_square(pair.left)
    near, far = (from_right, from_left) if mirrored else (from_left, from_right)
    a, b, c, d = (column[:, None] for column in _coefficients(pair, mode, beta))
    for _ in range(order):
        a, b, c = b, -a, -c
    # Whole waves go first: cos β itself would cost the far end's conditions β times the rounding.
    phase = math.pi * np.remainder(half_waves[:, None] * near, 2.0) + correction[:, None] * near
    waves = a * np.cos(phase) + b * np.sin(phase)
    shapes = waves + c * np.exp(-beta[:, None] * near) + d * np.exp(-beta[:, None] * far)
    return -shapes if mirrored and order % 2 else shapes
