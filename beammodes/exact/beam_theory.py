"""Exact modes under Euler-Bernoulli theory: chooses the solution that a beam, its ends and its load need."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from beammodes.checks import instead, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.exact.exact_beam import BeamModes, plain_modes
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.profiles import mean_over

if TYPE_CHECKING:
    from beammodes.exact import spectral_beam, supported_beam
else:
    spectral_beam = Deferred("beammodes.exact.spectral_beam")
    supported_beam = Deferred("beammodes.exact.supported_beam")


__all__ = ["assumed_in_shear", "check_range", "euler_bernoulli"]

#: Largest number of an end or axial force beside the beam's own unit, such as ρA L or EI/L²: well within the
#: 10¹⁰⁰ at which long decimals overflow.
LARGEST_RATIO = 1e30


def euler_bernoulli(
    beam: Beam, boundary: BoundaryLike, modes: int, *, load: Load | None = None
) -> BeamModes | supported_beam.SupportedBeamModes | spectral_beam.SpectralBeamModes:
    """Return the first elastic modes of a beam under Euler-Bernoulli theory.

    (EI φ'')'' - (T φ')' = ω² (ρA φ - (ρI φ')')  with two homogeneous conditions at each end.

    Shear is left out; `theory_error` of the result gives that error where the section is known.

    The result is a `BeamModes` for a uniform beam between plain ends, a `SupportedBeamModes` with springs,
    bodies, an axial force or rotary inertia, and a `SpectralBeamModes`, right to 1e-10, for a beam that
    varies or that gravity, a turning hub or a tip force pulls on. All three are read alike.

    Parameters
    ----------
    beam : Beam
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 10⁶ of a uniform beam under no more than an axial force, else 1 to 100.
    load : Load, optional
        One that leaves the beam straight; frequencies are those that an observer on the hub sees.

    Returns
    -------
    BeamModes, SupportedBeamModes or SpectralBeamModes
        As many modes as were asked for, in the order of their frequencies.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a Beam, `boundary` cannot be read, `modes` is not a whole number in range, or the
        load bends the beam, buckles it, or pulls on it where nothing holds its left end.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> bm.euler_bernoulli(beam, "clamped-free", 3).frequency.round(3)
    array([ 4.55 , 28.515, 79.843])
    >>> bm.euler_bernoulli(beam, "clamped-free(mass=0.2)", 3).frequency.round(3)
    array([ 3.146, 22.957, 68.397])
    >>> bm.euler_bernoulli(beam, "clamped-free", 3, load=bm.Load(spin_rate=50.0)).frequency.round(3)
    array([ 9.705, 34.976, 86.607])
    """
    if not isinstance(beam, Beam):
        hint = instead(beam, Rod="rod_modes takes a Rod", Structure="structure_modes takes a Structure")
        raise TypeError(f"beam must be a Beam, got {shown(beam)}{hint}")
    pair, pull = Boundary.of(boundary), checked_load(load)
    count = whole_number("modes", modes, most=10**6)
    check_range(beam, pair, pull)
    found = _solved(beam, pair, count, pull)
    theory = partial(_theory_error, beam, pair, pull, found.angular_frequency)
    return replace(found, theory=(theory, assumed_in_shear(beam)))


def check_range(beam: Beam, pair: Boundary, load: Load) -> None:
    """Raise ValueError if a number of an end or a load is so large beside the beam that no digits remain.

    Examples
    --------
    >>> check_range(Beam.unit(), Boundary.of("clamped-free(mass=1e30)"), Load())
    """
    length, mass = beam.length, beam.mean_mass_per_length * beam.length
    stiffness = beam.mean_bending_stiffness / length
    units = {
        "translational_stiffness": stiffness / length**2,
        "rotational_stiffness": stiffness,
        "mass": mass,
        "rotary_inertia": mass * length**2,
        "offset": length,
    }
    given = [
        (name, float(getattr(end, name)), unit)
        for end in (pair.left, pair.right)
        for name, unit in units.items()
    ]
    given.append(("axial_force", abs(float(load.axial_force)), stiffness / length))
    for name, value, unit in given:
        if math.isfinite(value) and abs(value) > LARGEST_RATIO * unit:
            raise ValueError(
                f"{name} must be at most {LARGEST_RATIO:g} of the beam's own, {unit:.6g}, in boundary and "
                f"load, got {value:.6g}"
            )


def _solved(
    beam: Beam, pair: Boundary, count: int, pull: Load
) -> BeamModes | supported_beam.SupportedBeamModes | spectral_beam.SpectralBeamModes:
    if not (beam.is_uniform and pull.is_axial):
        from beammodes.exact.spectral_beam import spectral_modes

        return spectral_modes(beam, pair, count, pull)
    if pull.axial_force or beam.rotary_inertia_per_length or not pair.is_plain:
        from beammodes.exact.supported_beam import supported_modes

        return supported_modes(
            beam, pair, count, pull, mean_over(beam.rotary_inertia_per_length, beam.length)
        )
    return plain_modes(beam, pair, count)


def assumed_in_shear(beam: Beam) -> tuple[str, ...]:
    """Return what the theory's own error takes for granted, in words."""
    if beam.shear_stiffness is None and (beam.has_rotary_inertia or beam.radius_of_gyration):
        return (*beam.assumed, "E/(kappa G) = 3.12 as of a rectangle")
    return beam.assumed


def _theory_error(beam: Beam, pair: Boundary, load: Load, omega: Floats) -> Floats | None:
    from beammodes.exact.timoshenko_beam import theory_error_of

    return theory_error_of(beam, pair, load, omega)
