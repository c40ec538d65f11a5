"""Timoshenko's beam, with shear and rotary inertia, and how far Euler and Bernoulli's theory is from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import positive_real, row_shown, shown, whole_number
from beammodes.exact.exact_beam import ExactModes
from beammodes.exact.spectral_beam import spectral_solution
from beammodes.exact.supported_root import ROOT_OF_SHAPE, cutoff, supported_root
from beammodes.exact.uniform_beam import BeamMode, UnitBeam
from beammodes.numerics.arrays import Floats
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.beam import Beam, PropertyLike, kept_property, positions_on
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.profiles import Profile, profile_parts, scaled, value_at

__all__ = [
    "SHEAR_RATIO",
    "TimoshenkoModes",
    "theory_error_of",
    "theory_facts",
    "timoshenko",
]


#: E/(κG) of a rectangular section, κ = 5/6 and Poisson's ratio 0.3: 2.6/0.8333. An I-beam's is larger.
SHEAR_RATIO = 2 * (1 + 0.3) / (5 / 6)


MOST_MODES = 100


class _Shapes(Protocol):
    def values(self, x: Floats, quantity: int) -> Floats:
        """Return deflection, rotation, curvature or shear strain (0 to 3), shape (modes, positions)."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TimoshenkoModes(ExactModes):
    """The first elastic modes of Timoshenko's beam; `timoshenko` makes it.

    Mode shapes have unit modal mass,

        ∫ ρA φₘ φₙ + ρI ψₘ ψₙ dx + Σ m (φ ± a ψ)ₘ (φ ± a ψ)ₙ + J ψₘ ψₙ = 1 if m = n, else 0,

    φ being the deflection and ψ the rotation of the section.

    Attributes
    ----------
    beam : Beam
        With the shear stiffness and the rotary inertia that were taken.
    boundary : Boundary
        Its ends, at x = 0 and at x = L.
    load : Load
        Its load.
    angular_frequency : ndarray, shape (modes,) [rad/s]
        ω of elastic modes 1, 2, ..., of both branches, in order, read-only.
    rigid_body_modes : int
        How many modes of zero frequency come before them: 0, 1 or 2.

    Examples
    --------
    >>> import beammodes as bm
    >>> modes = bm.timoshenko(bm.Beam(1.0, 1.0, 1.0, 0.01, shear_stiffness=33.0), "pinned-pinned", 2)
    >>> modes.shape([0.25, 0.5]).round(4) + 0.0, modes.rotation(0.0).round(4)
    (array([[0.9711, 1.3733],
           [1.3491, 0.    ]]), array([3.3768, 4.2405]))
    """

    beam: Beam
    boundary: Boundary
    load: Load
    angular_frequency: Floats
    rigid_body_modes: int
    _shapes: _Shapes

    @property
    def cutoff_angular_frequency(self) -> float:
        """√(κGA/ρI) [rad/s], least along the beam: beyond it modes of shear lie amid the others."""
        return _cutoff(self.beam)

    _smoothest = 1

    def _values(self, from_left: Floats, _: Floats, order: int) -> Floats:
        if order:
            return self._shapes.values(from_left, 1) + self._shapes.values(from_left, 3)
        return self._shapes.values(from_left, 0)

    def rotation(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes' rotations ψ of the section, or its curvature ψ' = M/EI with `derivative=1`.

        At `x` [m], 0 to L; at a step of EI curvature is that on its right. Shape (modes, *x.shape)
        [kg^(-1/2) m^(-1 - derivative)]; errors as of `shape`.
        """
        order = whole_number("derivative", derivative, least=0, most=1)
        position, length = positions_on(self.beam, x), self.beam.length
        unit = math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(length) * length ** (1 + order)
        values = self._shapes.values(position.ravel() / length, 1 + order) / unit
        return values.reshape(len(values), *position.shape)

    def _line(self) -> str:
        return f"TimoshenkoModes({self.boundary}: {row_shown(self.frequency, '{:.4g}', 'Hz')})"


@dataclass(frozen=True)
class _UniformShapes:
    """Shapes of a uniform beam, worked out when they are first asked for."""

    unit: UnitBeam
    squares: list[Decimal]

    @cached_property
    def modes(self) -> list[BeamMode]:
        with localcontext(LONG):
            return self.unit.modes(self.squares)

    def values(self, x: Floats, quantity: int) -> Floats:
        found = np.empty((len(self.modes), len(x)))
        with localcontext(LONG) as context:
            for number, mode in enumerate(self.modes):
                context.prec = mode.digits
                for i, at in enumerate(x.tolist()):
                    value = mode.at(Decimal(at))[quantity]
                    # The last is a force, and the strain is sought.
                    found[number, i] = float(mode.beam.shear * value if quantity == 3 else value)
        return found


def timoshenko(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int,
    *,
    load: Load | None = None,
    shear_stiffness: PropertyLike | None = None,
    rotary_inertia_per_length: PropertyLike | None = None,
) -> TimoshenkoModes:
    """Return the first elastic modes of a beam under Timoshenko's theory: bending, shear and rotary inertia.

    (κGA (φ' - ψ))' + ω² ρA φ = 0,    (EI ψ')' + κGA (φ' - ψ) + ω² ρI ψ = 0

    φ is the deflection, ψ the rotation of the section, which ends and bodies hold and follow. Modes come in
    the order of their frequencies; beyond the cut-off √(κGA/ρI) those of a second branch lie among them.

    A uniform beam is solved by its characteristic equation in long decimals: roots are counted, and each is
    right to 1e-15, for slenderness L/r from 1 to 10⁶, springs and bodies included. One that varies, or is
    loaded, is solved by polynomials, right to 1e-10.

    Parameters
    ----------
    beam : Beam
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 100.
    load : Load, optional
        One that leaves the beam straight. An axial force T does its work on the deflection's slope, ½ ∫T φ'²
        (Engesser's beam).
    shear_stiffness : float, sequence, Table or function [N], optional
        κGA in place of the beam's own; `math.inf` makes the beam rigid in shear: Rayleigh's.
    rotary_inertia_per_length : float, sequence, Table or function [kg m], optional
        ρI in place of the beam's own, which is ρA r² where only its radius of gyration is known; 0 leaves
        shear alone.

    Returns
    -------
    TimoshenkoModes
        Frequencies and shapes: deflections, and rotations of the section.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the shear stiffness or the rotary inertia is neither given nor
        known, or a load is one that `euler_bernoulli` refuses.
    ArithmeticError
        If polynomials of growing degree do not agree, as `euler_bernoulli` says.

    References
    ----------
    S. P. Timoshenko, Philosophical Magazine 41 (1921); ten pairs of ends: T. C. Huang, Journal of Applied
    Mechanics 28 (1961); count of roots: Wittrick and Williams, Quarterly Journal of Mechanics and Applied
    Mathematics 24 (1971).

    Examples
    --------
    >>> import beammodes as bm
    >>> steel = {"density": 7800.0, "elastic_modulus": 210e9, "poisson_ratio": 0.3}
    >>> stout = bm.Beam.from_section(bm.Rectangle(width=1.0, height=2.0), **steel, length=10.0)
    >>> bm.timoshenko(stout, "clamped-free", 3).frequency.round(3)
    array([ 16.257,  87.555, 208.398])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    pair, pull = Boundary.of(boundary), checked_load(load)
    count = whole_number("modes", modes, most=MOST_MODES)
    full = _completed(beam, shear_stiffness, rotary_inertia_per_length)
    if full.is_uniform and isinstance(full.shear_stiffness, float) and pull.is_axial and not pull.axial_force:
        omega, rigid, shapes = _uniform(full, pair, count)
    else:
        _, omega, rigid, _, shapes = spectral_solution(full, pair, count, pull, sheared=True)
    omega = omega * beam.frequency_unit
    omega.flags.writeable = False
    return TimoshenkoModes(full, pair, pull, omega, rigid, shapes)


def _uniform(beam: Beam, pair: Boundary, count: int) -> tuple[Floats, int, _Shapes]:
    # Numbers, as the beam is uniform.
    assert isinstance(beam.shear_stiffness, float)
    assert isinstance(beam.rotary_inertia_per_length, float)
    with localcontext(LONG):
        unit = UnitBeam.of(beam, pair, 0.0, beam.rotary_inertia_per_length, beam.shear_stiffness)
        squares = _squares(unit, pair.rigid_body_modes, count)
        omega = np.array([float(square.sqrt()) for square in squares])
        return omega, pair.rigid_body_modes, _UniformShapes(unit, squares)


def _squares(unit: UnitBeam, rigid: int, count: int) -> list[Decimal]:
    """Return ω² of elastic modes; those below the cut-off are roots of the same waves as without shear."""
    limit = cutoff(unit)
    if limit == math.inf or unit.sample(Decimal(limit) ** 2).below >= rigid + count:
        roots = [supported_root(unit, rigid + number, ROOT_OF_SHAPE) for number in range(1, count + 1)]
        return [root * root for root in roots if root is not None]
    squares = unit.lowest(rigid, count)
    # Without an axial force nothing buckles.
    assert squares is not None
    return squares


def theory_error_of(
    beam: Beam,
    pair: Boundary,
    load: Load,
    omega: Floats,
    radius_of_gyration: float | None = None,
    shear_ratio: float | None = None,
) -> Floats | None:
    """Return ω_Timoshenko/ω - 1 of a beam's modes under a theory without shear; None if no section is known.

    NaN from the cut-off frequency on, where n-th modes are not of one kind, beyond mode 100, and on a turning
    hub, where rotary inertia is not solved for.
    """
    shear, rotary = theory_facts(beam, radius_of_gyration, shear_ratio)
    if shear is None or rotary is None:
        return None
    errors, count = np.full(len(omega), np.nan), min(len(omega), MOST_MODES)
    if count and not load.spin_rate:
        stout = timoshenko(
            beam, pair, count, load=load, shear_stiffness=shear, rotary_inertia_per_length=rotary
        )
        found = stout.angular_frequency
        alike = found < stout.cutoff_angular_frequency
        errors[:count][alike] = found[alike] / omega[:count][alike] - 1.0
    return errors


def theory_facts(
    beam: Beam, radius_of_gyration: float | None = None, shear_ratio: float | None = None
) -> tuple[Profile | None, Profile | None]:
    """Return κGA and ρI as far as they are known, given or can be assumed: None if nothing tells them."""
    rotary: Profile | None = None
    radius = beam.radius_of_gyration
    if radius_of_gyration is not None:
        radius = positive_real("radius_of_gyration", radius_of_gyration)
    if beam.has_rotary_inertia:
        rotary = beam.rotary_inertia_per_length
    elif radius is not None:
        rotary = scaled(beam.mass_per_length, radius**2)
    ratio = None if shear_ratio is None else positive_real("shear_ratio", shear_ratio)
    if beam.shear_stiffness is not None and ratio is None and radius_of_gyration is None:
        return beam.shear_stiffness, rotary
    ratio = SHEAR_RATIO if ratio is None else ratio
    if radius is not None:
        return scaled(beam.bending_stiffness, 1.0 / (ratio * radius**2)), rotary
    if rotary is None:
        return None, None
    return _stiffness_of(beam, ratio), rotary


def _stiffness_of(beam: Beam, ratio: float) -> Profile:
    """Return EI / (r² E/(κG)) where r² = ρI/ρA."""
    bending, mass, rotary = beam.bending_stiffness, beam.mass_per_length, beam.rotary_inertia_per_length
    if isinstance(bending, float) and isinstance(mass, float) and isinstance(rotary, float):
        return bending * mass / (ratio * rotary)

    def stiffness(x: Any) -> Any:
        square = value_at(rotary, x) / value_at(mass, x)
        return value_at(bending, x) / (ratio * square)

    return stiffness


def _completed(beam: Beam, shear: PropertyLike | None, rotary: PropertyLike | None) -> Beam:
    """Return the beam with the shear stiffness and the rotary inertia that count."""
    known_shear, known_rotary = beam.shear_stiffness, theory_facts(beam)[1]
    if shear is None and known_shear is None:
        raise ValueError(
            "shear_stiffness must be given, kappa G A in N, for a beam that has none, got None; "
            "Beam.from_section knows it, and math.inf leaves shear out"
        )
    if rotary is None and known_rotary is None:
        raise ValueError(
            "rotary_inertia_per_length must be given, rho I in kg m, for a beam that has neither one nor a "
            "radius of gyration, got None; Beam.from_section knows it, from_sections by rotary_inertia=True, "
            "and 0 leaves it out"
        )
    given_shear = known_shear if shear is None else shear
    given_rotary = known_rotary if rotary is None else rotary
    rigid = isinstance(given_shear, float) and given_shear == math.inf
    full = Beam(
        beam.length,
        beam.bending_stiffness,
        beam.mass_per_length,
        kept_property("rotary_inertia_per_length", given_rotary, beam.length),
        shear_stiffness=None if rigid else given_shear,
        radius_of_gyration=beam.radius_of_gyration,
    )
    if rigid:
        object.__setattr__(full, "shear_stiffness", math.inf)
    return full


def _cutoff(beam: Beam) -> float:
    """Return the least √(κGA/ρI) along the beam, infinite without shear or without rotary inertia."""
    assert beam.shear_stiffness is not None
    profiles = (beam.rotary_inertia_per_length, beam.shear_stiffness)
    parts = (x for profile in profiles for x in profile_parts(profile, beam.length))
    x = np.unique([*np.linspace(0.0, beam.length, 257), *parts])
    least = math.inf
    for side in (-1, 1):
        rotary = value_at(beam.rotary_inertia_per_length, x, side)
        shear = value_at(beam.shear_stiffness, x, side)
        ratio = np.divide(shear, rotary, out=np.full_like(x, np.inf), where=rotary > 0.0)
        least = min(least, math.sqrt(float(ratio.min())))
    return least
