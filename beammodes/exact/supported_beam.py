"""Exact modes of the uniform beam with springs and bodies at its ends, axial force and rotary inertia."""

from __future__ import annotations

from decimal import Overflow, localcontext

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import real, shown, whole_number
from beammodes.exact.beam_reflection import first_separate_wave, high_waves
from beammodes.exact.beam_waves import BeamWaves
from beammodes.exact.long_decimals import LONG
from beammodes.exact.low_modes import low_squares, low_waves
from beammodes.exact.supported_shapes import SupportedBeamModes
from beammodes.exact.unit_beam import UnitBeam
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

__all__ = ["SupportedBeamModes", "supported_modes"]

Floats = NDArray[np.float64]


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
