"""Exact modes and buckling load of the uniform beam with springs and bodies at its ends."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import localcontext

import numpy as np

from beammodes.checks import real, shown, whole_number
from beammodes.exact.beam_waves import BeamWaves, first_separate_wave, high_waves
from beammodes.exact.exact_beam import EulerBernoulliModes, Theory, first_free
from beammodes.exact.uniform_beam import UnitBeam
from beammodes.numerics.arrays import Floats
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

__all__ = ["SupportedBeamModes", "critical_compression", "supported_modes"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SupportedBeamModes(EulerBernoulliModes):
    """The first elastic modes of a uniform beam with general ends; `supported_modes` makes it.

    Mode shapes have unit modal mass,

        ∫ ρA φₘ φₙ + ρI φₘ' φₙ' dx + Σ m (φ ± a φ')ₘ (φ ± a φ')ₙ + J φₘ' φₙ' = 1 if m = n, else 0,

    the sum being over the bodies at the ends, + at the right one.

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
        The theory's own error; `euler_bernoulli` gives it.

    Examples
    --------
    >>> import beammodes as bm
    >>> modes = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free(mass=1)", 2)
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

    _smoothest = 3

    def _values(self, from_left: Floats, from_right: Floats, order: int) -> Floats:
        """Return φ = a cos qξ + b sin qξ + c e^(-pξ) + d e^(-p(1-ξ)), or a derivative by ξ.

        p² - q² = (T - ρI ω²) L²/EI and p q = ω √(ρA L⁴/EI).
        """
        start = self.waves.shapes(np.zeros(1), np.ones(1), first_free(self.boundary.left))
        return np.where(start < 0.0, -1.0, 1.0) * self.waves.shapes(from_left, from_right, order)


def supported_modes(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int,
    load: Load | None = None,
    rotary_inertia_per_length: float | None = None,
) -> SupportedBeamModes:
    """Return the first elastic modes, 1 to 10⁶, of a uniform beam with general ends and an axial force.

    EI φ'''' - (T - ρI ω²) φ'' = ρA ω² φ;  at the ends -EI φ''' + (T - ρI ω²) φ'  and  EI φ''  balance
    springs and bodies. Roots are counted, so that none is missed, and right to a few units in the last
    place. Each of the first dozen modes takes about 2 ms; higher ones are quick unless the radius of
    gyration exceeds 1/57 of the length.

    References
    ----------
    Root count: Wittrick and Williams, Quarterly Journal of Mechanics and Applied Mathematics 24 (1971).
    Equation with axial force: Bokaian, Journal of Sound and Vibration 126 (1988).

    Examples
    --------
    >>> supported_modes(Beam.unit(), "clamped-free(mass=1)", 2).angular_frequency.round(4)
    array([ 1.5573, 16.2501])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    pair, count = Boundary.of(boundary), whole_number("modes", modes, most=10**6)
    pull, inertia = checked_load(load), _rotary_inertia(beam, rotary_inertia_per_length)
    with localcontext(LONG):
        unit = UnitBeam.of(beam, pair, pull.axial_force, inertia)
        rigid = int(unit.translation_is_free) if pull.axial_force else pair.rigid_body_modes
        found = _solved(unit, rigid, count)
    if found is None:
        raise ValueError(
            "axial_force must be above the compression at which the straight beam buckles, "
            f"got {shown(pull.axial_force)} with {pair} ends"
        )
    found[0].flags.writeable = False
    return SupportedBeamModes(beam, pair, pull, inertia, rigid, *found)


def _rotary_inertia(beam: Beam, given: float | None) -> float:
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    number = real("rotary_inertia_per_length", beam.rotary_inertia_per_length if given is None else given)
    if number < 0.0:
        raise ValueError(f"rotary_inertia_per_length must not be negative, got {shown(given)}")
    return number


def _solved(unit: UnitBeam, rigid: int, count: int) -> tuple[Floats, BeamWaves] | None:
    """Return relative frequencies and shapes, low modes first; None if the beam buckles."""
    separate = first_separate_wave(unit)
    squares = unit.lowest(rigid, count, separate)
    if squares is None:
        return None
    frequencies, waves = [np.array([float(square.sqrt()) for square in squares])], []
    if squares:
        waves.append(BeamWaves.of(unit.modes(squares)))
    if len(squares) < count:
        high, shapes = high_waves(unit, separate, np.arange(len(squares), count) + rigid + 1)
        frequencies.append(high)
        waves.append(shapes)
    return np.concatenate(frequencies), BeamWaves.joined(waves)


def critical_compression(beam: Beam, boundary: BoundaryLike) -> float:
    """Return the smallest compression, by two dead loads on its ends, at which a uniform beam buckles [N].

    The smallest P of  EI y'''' + P y'' = 0  with  EI y''  and  -EI y''' - P y'  balanced by the supports.
    On soft springs it may be a turn of the whole straight beam; a boundary that resists none is refused.
    Bodies at the ends do not matter.

    References
    ----------
    Timoshenko and Gere, Theory of Elastic Stability (1961), chapter 2.

    Examples
    --------
    >>> round(critical_compression(Beam.unit(), "clamped-pinned"), 6)
    20.190729
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    pair = Boundary.of(boundary)
    ends = (pair.left, pair.right)
    turns = not any(end.rotational_stiffness > 0 for end in ends)
    if turns and not all(end.translational_stiffness > 0 for end in ends):
        raise ValueError(
            "boundary must resist a turn of the whole beam, or it turns over under any compression, "
            f"got {pair}"
        )
    with localcontext(LONG):
        relative = UnitBeam.of(beam, pair).critical_compression()
    return float(relative) * beam.mean_bending_stiffness / beam.length / beam.length
