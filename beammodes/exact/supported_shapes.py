"""Results of the uniform beam with general ends: frequencies and mode shapes, read as `BeamModes` are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import whole_number
from beammodes.exact.beam_waves import BeamWaves
from beammodes.exact.printed_modes import EulerBernoulliModes, Theory
from beammodes.problem.beam import Beam
from beammodes.problem.beam_positions import positions_on
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load

__all__ = ["SupportedBeamModes"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SupportedBeamModes(EulerBernoulliModes):
    """The first elastic modes of a uniform beam with general ends; `supported_beam.supported_modes` makes it.

    Mode shapes have unit modal mass,

        ∫ ρA φₘ φₙ + ρI φₘ' φₙ' dx + Σ m (φ ± a φ')ₘ (φ ± a φ')ₙ + J φₘ' φₙ' = 1 if m = n, else 0,

    the sum being over the bodies at the ends, + at the right one, and the sign that makes the first of
    φ, φ', φ'' that the left end does not hold positive at x = 0.

    Parameters
    ----------
    beam : Beam
        The beam whose length, stiffness and mass give the results their units.
    boundary : Boundary
        The ends, at x = 0 and at x = L.
    load : Load
        The axial force.
    rotary_inertia_per_length : float [kg m]
        ρI, of the cross-section.
    rigid_body_modes : int
        How many modes of zero frequency come before the elastic ones: 0, 1 or 2. Any axial force turns a
        rigid rotation that nothing holds into a mode of positive frequency, or makes it buckle.
    relative_frequency : ndarray, shape (modes,) [-]
        ω √(ρA L⁴/EI) of elastic modes 1, 2, ..., read-only.
    waves : BeamWaves
        Their shapes on a beam of unit length and mass.
    theory : Theory, optional
        What tells the theory's own error; `euler_bernoulli` gives it.

    Examples
    --------
    >>> from beammodes.exact.supported_beam import supported_modes
    >>> modes = supported_modes(Beam.unit(), "clamped-free(mass=1)", 2)
    >>> modes.shape([0.5, 1.0]).round(6)
    array([[ 0.285378,  0.898626],
           [ 1.433059, -0.299963]])
    """

    beam: Beam
    boundary: Boundary
    load: Load
    rotary_inertia_per_length: float
    rigid_body_modes: int
    relative_frequency: Floats
    waves: BeamWaves
    theory: Theory | None = None

    @property
    def angular_frequency(self) -> Floats:
        """ω of elastic modes 1, 2, ..., shape (modes,) [rad/s]."""
        return self.relative_frequency * self.beam.frequency_unit

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes φ, or a derivative dᵏφ/dxᵏ of them.

        φ = a cos qξ + b sin qξ + c e^(-pξ) + d e^(-p(1-ξ)),  ξ = x/L, p² - q² = (T - ρI ω²) L²/EI,
        p q = ω √(ρA L⁴/EI)

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L.
        derivative : int
            k, 0 to 3: deflection, slope, curvature, or the curvature's rate.

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-k)]

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not a whole number in 0..3.

        Examples
        --------
        >>> from beammodes.exact.supported_beam import supported_modes
        >>> soft = supported_modes(Beam.unit(), "free(translational_stiffness=1e-9)-guided", 1)
        >>> soft.shape([0.0, 1.0]).round(6)
        array([[1., 1.]])
        """
        order = whole_number("derivative", derivative, least=0, most=3)
        position = positions_on(self.beam, x)
        from_left = position.ravel() / self.beam.length
        from_right = (self.beam.length - position.ravel()) / self.beam.length
        left = self.boundary.left
        first = int(left.holds_deflection) * (1 + int(left.holds_rotation))
        start = self.waves.shapes(np.zeros(1), np.ones(1), first)
        scale = np.where(start < 0.0, -1.0, 1.0) / self.beam.length**order
        # Two square roots: the product of mass per length and length may leave the range of doubles.
        scale /= math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(self.beam.length)
        shapes = self.waves.shapes(from_left, from_right, order)
        return (scale * shapes).reshape(len(self.relative_frequency), *position.shape)
