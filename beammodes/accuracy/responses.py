"""Frequency responses of beams and chains as labelled datasets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.driven_systems import UNITS, Driven, Place
from beammodes.chains.chain import Chain
from beammodes.checks import real_numbers, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["frequency_response"]

_MOST_FREQUENCIES = 10**6


def frequency_response(
    system: Beam | Chain,
    boundary: BoundaryLike | None = None,
    *,
    frequency: ArrayLike,
    force_at: Place | None = None,
    moment_at: Place | None = None,
    base: str | None = None,
    deflection_at: Place | None = None,
    rotation_at: Place | None = None,
    damping_ratio: ArrayLike | None = None,
    damping: Damping | None = None,
    loss_factor: float = 0.0,
    load: Load | None = None,
) -> xarray.Dataset:
    """Return how a beam (exactly) or a chain answers to a harmonic force, moment or motion of its base.

        receptance H = (deflection or rotation) / (force or moment),  both ~ e^(iωt);  mobility iωH;
        accelerance -ω² H

    Small motion about the straight beam. With damping by modes

        H = Σ φ_n(read) φ_n(driven) / (ω_n² - ω² + 2i ζ_n ω_n ω),

    else (-ω² M + iω C + (1 + iη) K) y = f. The phase is negative where the response comes late.

    Parameters
    ----------
    system : Beam or Chain
        Any of both. A uniform beam's response is right to about 1e-13 of the largest nearby, next to a
        resonance to 1e-16 over its damping, a chain's to about as much; that of a beam that varies to 1e-10,
        and with damping by modes, of which it has 40 told one by one, to what attribute `change` says.
    boundary : str, pair of ends or Boundary
        Of a beam; a chain has its own.
    frequency : float or array [Hz]
        From 0; above it where the ends leave a motion that stores nothing.
    force_at, moment_at : float or row of positions, optional [m]
        Where a unit force across the beam or a unit moment acts: one of the two, or `base`. Of several
        positions each is a drive of its own. On a chain a moment acts on the piece that is there, at a hinge
        on both neighbours with its half.
    base : str, optional
        "shift": what holds the ends moves across the beam by one; "turn": it turns about the left end by
        one. The answer is then `transmissibility`, the absolute motion, and `relative_motion`, that less the
        base's.
    deflection_at, rotation_at : float or row of positions, optional [m]
        Where deflections or rotations are read: one of the two. The rotation of a chain is that of the piece
        there, at a hinge the mean of both: a staircase, which meets the beam's slope in the middle of pieces.
    damping_ratio : float or row of float, optional
        ζ of modes from the first, the last one of all above: 0.01 is 1 % of critical. Given alone.
    damping : Damping, optional
        Rayleigh's and dampers of single hinges. Of a beam, which has no hinges, Rayleigh's.
    loss_factor : float
        η of the springs of joints and supports, of a beam of its stiffness EI and its supports.
    load : Load, optional
        A beam's axial force; what pulls along a chain, without spin.

    Returns
    -------
    xarray.Dataset
        Complex, over frequency and the positions that were given as rows; units in attributes. Undamped, it
        is infinite at a resonance. With ratios of modes, attribute `modes` says how many were summed one by
        one (what is even in ω_n is known as a whole, see the page theory) and `change` how much, relative,
        the last half of these moved any value; 0 if these were all modes.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or a load bends or buckles the system.
    ArithmeticError
        If a beam varies too much for results on ever shorter parts to agree.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> drive = dict(frequency=[2.0, 4.5], force_at=1.2, deflection_at=1.2, damping_ratio=0.01)
    >>> exact = bm.frequency_response(beam, "clamped-free", **drive)
    >>> abs(exact.receptance).values.round(6)                                       # m/N
    array([0.008352, 0.223024])
    >>> chain = bm.Chain(beam, "clamped-free", segments=10)
    >>> abs(bm.frequency_response(chain, **drive).receptance).values.round(6)
    array([0.008356, 0.237092])
    """
    import xarray

    driven = Driven.of(
        system,
        boundary,
        force_at=force_at,
        moment_at=moment_at,
        base=base,
        deflection_at=deflection_at,
        rotation_at=rotation_at,
        damping_ratio=damping_ratio,
        damping=damping,
        loss_factor=loss_factor,
        load=load,
    )
    given = real_numbers("frequency", frequency)
    if given.ndim > 1 or given.size > _MOST_FREQUENCIES or not given.size or (given < 0.0).any():
        raise ValueError(
            f"frequency must be one or a row of at most {_MOST_FREQUENCIES}, none negative, "
            f"got {shown(frequency)}"
        )
    found = driven.at(np.atleast_1d(given))
    summed = {} if driven.ratios is None else {"modes": found.modes, "change": found.change}
    whole = xarray.Dataset(
        {
            name: driven.variable(values, text, units, ("frequency",))
            for name, (values, text, units) in _variables(driven, np.atleast_1d(given), found.value).items()
        },
        coords={
            "frequency": ("frequency", np.atleast_1d(given), {"long_name": "frequency", "units": "Hz"}),
            **driven.coordinates,
        },
        attrs={**driven.words, **summed},
    )
    return whole if given.ndim else whole.isel(frequency=0)


def _variables(driven: Driven, frequency: Floats, values: Complex) -> dict[str, tuple[Complex, str, str]]:
    """Return what is told of responses: values, long name and units."""
    reading, drive = driven.system.reading, driven.system.drive
    read, acted = UNITS[reading.kind], UNITS[drive.kind]
    unit = "1" if read == acted else f"{read} / ({acted})" if " " in acted else f"{read} / {acted}"
    omega, per = (2.0j * math.pi * frequency)[:, None, None], f"{reading.kind} over {drive.kind}"
    if not drive.is_base:
        return {
            "receptance": (values, per, unit),
            "mobility": (omega * values, f"rate of {per}", f"{unit} / s"),
            "accelerance": (omega**2 * values, f"acceleration of {per}", f"{unit} / s²"),
        }
    relative = -(omega**2) * values
    return {
        "transmissibility": (reading.of_base(drive.kind)[:, None] + relative, f"{per} of the base", unit),
        "relative_motion": (relative, f"{per} of the base, relative to it", unit),
    }
