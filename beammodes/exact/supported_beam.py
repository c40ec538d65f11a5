"""Exact modes of the uniform beam with springs and bodies at its ends, axial force and rotary inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, Overflow, localcontext

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import real, shown, whole_number
from beammodes.exact.beam_waves import BeamWaves, beam_mass, first_separate_wave, high_waves
from beammodes.exact.exact_beam import EulerBernoulliModes, Theory
from beammodes.exact.unit_beam import UnitBeam, UnitEnd
from beammodes.numerics.arrays import Floats
from beammodes.numerics.count_roots import ordered_roots
from beammodes.numerics.long_decimals import LONG, cosine_and_sine
from beammodes.problem.beam import Beam, positions_on
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

__all__ = ["SupportedBeamModes", "low_squares", "low_waves", "supported_modes"]


# Results of the uniform beam with general ends: frequencies and mode shapes, read as `BeamModes` are.


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


# Modes of the supported beam in long decimals: every root, however far the numbers are spread.

Row = list[Decimal]


# Beyond the clamped beam's buckling load, 4 π² = 39.478...
_NO_BEAM_BEARS = Decimal("-39.5")


def low_squares(beam: UnitBeam, rigid: int, count: int, wave: Decimal) -> list[Decimal] | None:
    """Return the first `count` positive w = ω², fewer if q = `wave` comes first; None if the beam buckles.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.ends import Boundary
    >>> beam = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
    >>> [round(float(square), 4) for square in low_squares(beam, 0, 2, Decimal(10))]
    [97.4091, 1558.5455]
    """
    if beam.tension < _NO_BEAM_BEARS:
        return None
    # The clamped beam has at most two roots less below a place than the pinned one, whose roots are n π.
    high = beam.sample(beam.square_at(min(wave, Decimal("3.15") * (rigid + count + 3))))
    low, decades = high, 1
    while low.below > rigid:
        if decades > 64 + 4 * beam.spread:
            return None
        low = beam.sample(high.place.scaleb(-decades))
        decades *= 2
    return ordered_roots(beam.sample, low, high, count)


def low_waves(beam: UnitBeam, squares: list[Decimal]) -> BeamWaves:
    """Return the shapes of unit modal mass at squared frequencies that are roots."""
    columns = zip(*(_mode(beam, square) for square in squares), strict=True)
    return BeamWaves(*(np.array(column) for column in columns))


def _mode(beam: UnitBeam, square: Decimal) -> tuple[object, ...]:
    """Return p, q, the waves at both ends and the states at both ends, as doubles."""
    with localcontext() as context:
        context.prec = beam.digits(square)
        tension, p, q = beam.wavenumbers(square)
        across, (cosine, sine) = (-p).exp(), cosine_and_sine(q)
        states = _states(p, q, across)
        # cos qx and sin qx in terms of the distance from the right end.
        turned = [[*_turned(row[0], row[1], cosine, sine), row[3], row[2]] for row in states]
        rows = _conditions(beam.left, states, tension, square)
        rows += _conditions(beam.right, turned, tension, square)
        vector = _null_vector(rows)
        left, right = vector[:3], [*_turned(vector[0], vector[1], cosine, sine), vector[3]]
        ends = [[_dot(row, vector) for row in table] for table in (states, turned)]
        mass = beam_mass(p, q, beam.gyration, left, right, across)
        mass += sum(end.energy(*state[:2]) for end, state in zip((beam.left, beam.right), ends, strict=True))
        unit = mass.sqrt()
        return float(p), float(q), *([float(n / unit) for n in part] for part in (left, right, *ends))


def _turned(a: Decimal, b: Decimal, cosine: Decimal, sine: Decimal) -> tuple[Decimal, Decimal]:
    """Return what a cos qx + b sin qx is in z = 1 - x, and, the map being its own inverse, back."""
    return a * cosine + b * sine, a * sine - b * cosine


def _states(p: Decimal, q: Decimal, across: Decimal) -> list[Row]:
    """Return y, y', y'', y''' at z = 0 of cos qz, sin qz, e^(-pz), e^(-p(1-z))."""
    one, none = Decimal(1), Decimal(0)
    return [
        [one, none, one, across],
        [none, q, -p, p * across],
        [-q * q, none, p * p, p * p * across],
        [none, -(q**3), -(p**3), p**3 * across],
    ]


def _conditions(end: UnitEnd, states: list[Row], tension: Decimal, square: Decimal) -> list[Row]:
    """Return the rows of both conditions of an end on the four waves."""
    deflection, coupled, turning = end.impedance(square)
    waves = [list(column) for column in zip(*states, strict=True)]
    force = [d3 - tension * d1 + deflection * d0 + coupled * d1 for d0, d1, _, d3 in waves]
    moment = [coupled * d0 + turning * d1 - d2 for d0, d1, d2, _ in waves]
    return [
        states[0] if end.holds[0] else force,
        states[1] if end.holds[1] else moment,
    ]


def _null_vector(rows: list[Row]) -> Row:
    """Return the vector that four rows of rank three annihilate, by elimination with complete pivoting."""
    rows = [[value / max(map(abs, row)) for value in row] for row in rows]
    order = list(range(4))
    for step in range(3):
        i, j = max(
            ((i, j) for i in range(step, 4) for j in range(step, 4)), key=lambda at: abs(rows[at[0]][at[1]])
        )
        rows[step], rows[i] = rows[i], rows[step]
        order[step], order[j] = order[j], order[step]
        for row in rows:
            row[step], row[j] = row[j], row[step]
        for row in rows[step + 1 :]:
            factor = row[step] / rows[step][step]
            row[step:] = [
                value - factor * top for value, top in zip(row[step:], rows[step][step:], strict=True)
            ]
    solution = [Decimal(1)]
    for step in (2, 1, 0):
        known = _dot(rows[step][step + 1 :], solution)
        solution.insert(0, -known / rows[step][step])
    return [solution[order.index(column)] for column in range(4)]


def _dot(row: Row, vector: Row) -> Decimal:
    return sum((a * b for a, b in zip(row, vector, strict=True)), Decimal(0))


def supported_modes(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int,
    load: Load | None = None,
    rotary_inertia_per_length: float | None = None,
) -> SupportedBeamModes:
    """Return the first elastic modes of a uniform beam with general ends, axial force and rotary inertia.

    EI φ'''' - (T - ρI ω²) φ'' = ρA ω² φ;  at the ends -EI φ''' + (T - ρI ω²) φ' and EI φ'' balance springs
    and bodies.  Every root is found, in order, and right to a few units in the last place.

    Parameters
    ----------
    beam : Beam
        The uniform beam.
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 10⁶. Each of the first dozen takes about 2 ms; higher ones are quick
        unless the section's radius of gyration exceeds 1/57 of the length.
    load : Load, optional
        The axial force T; none if left out.
    rotary_inertia_per_length : float, optional [kg m]
        ρI, in place of the beam's own.

    Raises
    ------
    TypeError, ValueError
        If an argument is of the wrong kind or out of range, the beam is not uniform, or the axial force
        buckles it.

    Source
    ------
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
        try:
            found = _solved(unit, rigid, count)
        except Overflow:
            raise ValueError(
                f"axial_force must be smaller for this beam, got {shown(pull.axial_force)}: the exact beam's "
                "equation grows as exp(L √(T/EI)) and leaves the range of decimals"
            ) from None
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
    squares = low_squares(unit, rigid, count, separate)
    if squares is None:
        return None
    frequencies, waves = [np.array([float(square.sqrt()) for square in squares])], []
    if squares:
        waves.append(low_waves(unit, squares))
    if len(squares) < count:
        high, shapes = high_waves(unit, separate, np.arange(len(squares), count) + rigid + 1)
        frequencies.append(high)
        waves.append(shapes)
    return np.concatenate(frequencies), BeamWaves.joined(waves)
