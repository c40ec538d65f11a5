"""Exact modes and buckling load of the uniform beam with springs and bodies at its ends."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import localcontext
from functools import cached_property

import numpy as np

from beammodes.checks import real, shown, whole_number
from beammodes.exact.beam_waves import BeamWaves, first_separate_wave, high_waves
from beammodes.exact.exact_beam import EulerBernoulliModes, Theory
from beammodes.exact.supported_root import ROOT_OF_SHAPE, supported_root
from beammodes.exact.supported_roots import supported_frequencies
from beammodes.exact.uniform_beam import UnitBeam, UnitEnd
from beammodes.numerics.arrays import Floats
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.beam import Beam
from beammodes.problem.end_columns import BoundaryColumns, EndColumns
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

__all__ = ["SupportedBeamModes", "critical_compression", "supported_modes"]


# The pinned beam has twelve modes below q = 40, where waves are never separate, others at most two less.
_SURELY_LOW = 10


@dataclass(frozen=True)
class UnitShapes:
    """The shapes of the first elastic modes of a beam, worked out when they are first asked for."""

    unit: UnitBeam
    rigid: int
    count: int

    @cached_property
    def waves(self) -> BeamWaves:
        """Shapes of unit modal mass, low modes first; the left end's first free motion is positive."""
        unit, rigid, count = self.unit, self.rigid, self.count
        low, parts = _low_modes(unit, rigid, count), []
        with localcontext(LONG):
            if low:
                roots = [supported_root(unit, number, ROOT_OF_SHAPE) for number in _numbers(rigid, 0, low)]
                parts.append(BeamWaves.of(unit.modes([root * root for root in roots if root is not None])))
            if low < count:
                parts.append(high_waves(unit, _high_frequencies(unit, low, count)))
        return BeamWaves.joined(parts)


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
    unit_shapes : UnitShapes
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
    unit_shapes: UnitShapes
    theory: Theory | None = None

    @property
    def angular_frequency(self) -> Floats:
        """ω of elastic modes 1, 2, ..., shape (modes,) [rad/s]."""
        return self.relative_frequency * self.beam.frequency_unit

    @property
    def waves(self) -> BeamWaves:
        """Mode shapes on a beam of unit length and mass."""
        return self.unit_shapes.waves

    _smoothest = 3

    def _values(self, from_left: Floats, from_right: Floats, order: int) -> Floats:
        """Return φ = a cos qξ + b sin qξ + c e^(-pξ) + d e^(-p(1-ξ)), or a derivative by ξ.

        p² - q² = (T - ρI ω²) L²/EI and p q = ω √(ρA L⁴/EI).
        """
        return self.waves.shapes(from_left, from_right, order)


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
    place. Each of the first dozen modes takes 0.2 ms, and 0.6 ms more when shapes are first asked for;
    higher ones are quick unless the radius of gyration exceeds 1/57 of the length.

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
        omega = _frequencies(unit, rigid, count)
    if omega is None:
        raise ValueError(
            "axial_force must be above the compression at which the straight beam buckles, "
            f"got {shown(pull.axial_force)} with {pair} ends"
        )
    omega.flags.writeable = False
    return SupportedBeamModes(beam, pair, pull, inertia, rigid, omega, UnitShapes(unit, rigid, count))


def _rotary_inertia(beam: Beam, given: float | None) -> float:
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    number = real("rotary_inertia_per_length", beam.rotary_inertia_per_length if given is None else given)
    if number < 0.0:
        raise ValueError(f"rotary_inertia_per_length must not be negative, got {shown(given)}")
    return number


def _frequencies(unit: UnitBeam, rigid: int, count: int) -> Floats | None:
    """Return relative frequencies; None if the beam buckles."""
    low = _low_modes(unit, rigid, count)
    roots = [supported_root(unit, number) for number in _numbers(rigid, 0, max(low, 1))]
    if None in roots:
        return None
    found = np.array([float(root) for root in roots[:low] if root is not None])
    if low == count:
        return found
    return np.concatenate([found, _high_frequencies(unit, low, count)])


def _high_frequencies(unit: UnitBeam, first: int, end: int) -> Floats:
    number = np.arange(first, end)
    ends = BoundaryColumns(*(_repeated(side, number.shape) for side in (unit.left, unit.right)))
    tension = np.broadcast_to(float(unit.tension), number.shape)
    return supported_frequencies(ends, tension, number + 1, float(unit.gyration))


def _repeated(side: UnitEnd, shape: tuple[int, ...]) -> EndColumns:
    """Return an end's columns of so many times itself."""
    holds, *numbers, _ = side
    springs = (math.inf if held else float(spring) for held, spring in zip(holds, numbers[:2], strict=True))
    columns = (np.broadcast_to(number, shape) for number in (*springs, *map(float, numbers[2:]), False))
    return EndColumns(*columns)


def _low_modes(unit: UnitBeam, rigid: int, count: int) -> int:
    """Return how many of the first elastic modes have ends that feel each other's fading waves."""
    if rigid + count <= _SURELY_LOW or unit.has_hub:
        return count
    wave = first_separate_wave(unit)
    if wave.is_infinite():
        return count
    return min(count, unit.sample(unit.square_at(wave)).below - rigid)


def _numbers(rigid: int, first: int, end: int) -> range:
    """Return the numbers of elastic modes, counted from the first rigid-body mode."""
    return range(rigid + first + 1, rigid + end + 1)


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
