"""The motion of beams and chains under random forces or bases, by its root mean square."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.driven_systems import HIGHEST, UNITS, Driven, Place
from beammodes.chains.chain import Chain
from beammodes.checks import bounded, not_negative, real_numbers, shown, small_fraction, unwrapped
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.numerics.split_integrals import split_integral
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["random_response"]

_LEAST_TOLERANCE = 1e-11

Density = float | Callable[[Any], Any]


def random_response(
    system: Beam | Chain,
    boundary: BoundaryLike | None = None,
    *,
    density: Density,
    band: tuple[float, float],
    force_at: Place | None = None,
    moment_at: Place | None = None,
    base: str | None = None,
    deflection_at: Place | None = None,
    rotation_at: Place | None = None,
    damping_ratio: ArrayLike | None = None,
    damping: Damping | None = None,
    loss_factor: float = 0.0,
    load: Load | None = None,
    tolerance: float = 1e-6,
) -> xarray.Dataset:
    """Return the root mean square of a motion under a random force, moment or acceleration of the base.

        rms² = ∫ |H(f)|² S(f) df  over the band

    H is that of `frequency_response`, with whose arguments this one goes on. Cells of the integral are halved
    until it holds to the tolerance, from the natural frequencies on, so that no peak is missed.

    Parameters
    ----------
    system, boundary, force_at, moment_at, base, deflection_at, rotation_at, damping_ratio, damping, \
loss_factor, load
        As of `frequency_response`; something must damp.
    density : float or function of an array of frequencies [Hz]
        S, one-sided, per Hz: of a force [N²/Hz], a moment, or of the acceleration of a base [(m/s²)²/Hz] or
        [(rad/s²)²/Hz]. Drives at several positions act alone, one at a time.
    band : pair of float [Hz]
        Lowest and highest frequency.
    tolerance : float
        Relative, of rms².

    Returns
    -------
    xarray.Dataset
        `rms`, of the motion, on a moving base relative to it; `rms_velocity`; and `rms_acceleration`, on a
        moving base absolute. Attribute `accuracy` is the relative error of the worst of them, as estimated
        from the halving of cells and the sum over modes.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or nothing damps.
    ArithmeticError
        If the integral does not settle, as of a motion that is nothing but rounding, by symmetry, say.

    References
    ----------
    S. H. Crandall and W. D. Mark, Random Vibration in Mechanical Systems (1963), chapter 2.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> shaken = bm.random_response(beam, "clamped-free", density=0.5, band=(1.0, 500.0), base="shift",
    ...                             deflection_at=1.2, damping_ratio=0.01)
    >>> round(float(shaken.rms), 5), shaken.accuracy < 1e-6                          # m, of (m/s²)²/Hz
    (0.02559, True)
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
    if not driven.is_damped:
        raise ValueError(
            "damping_ratio, damping or loss_factor must be given, and of every mode above 0: without any a "
            "peak is infinite"
        )
    low, high = _band(band)
    driven.check_lowest(low)
    spectrum, limit = _density(density), small_fraction("tolerance", tolerance)
    if limit < _LEAST_TOLERANCE:
        raise ValueError(f"tolerance must be at least {_LEAST_TOLERANCE:g}, got {shown(tolerance)}")
    changes: list[float] = []
    read, is_base = driven.system.reading, driven.system.drive.is_base
    own = read.of_base(driven.system.drive.kind)[:, None] if is_base else 0.0

    def powers(frequency: Floats) -> Floats:
        found = driven.at(frequency, max(1e-10, 1e-3 * limit))
        changes.append(found.change)
        omega = (2.0 * math.pi * frequency)[:, None, None]
        motions = [found.value, omega * found.value, own + omega**2 * found.value]
        values = np.stack([np.abs(motion) ** 2 for motion in motions], axis=1)
        return (values * spectrum(frequency)[:, None, None, None]).reshape(len(frequency), -1)

    peaks = driven.natural_frequencies(high)
    edges = np.unique(np.concatenate([[low], peaks[peaks > low], [high]]))
    squares, errors = split_integral(powers, edges, limit)
    shape = (3, len(read.x), driven.system.drive.columns)
    with np.errstate(invalid="ignore", divide="ignore"):
        worst = float(np.nanmax(np.where(squares > 0.0, 0.5 * errors / squares, 0.0)))
    rms = np.sqrt(squares).reshape(shape)
    unit = UNITS[read.kind]
    names = {
        "rms": (unit, " relative to the base" if is_base else ""),
        "rms_velocity": (f"{unit} / s", " relative to the base" if is_base else ""),
        "rms_acceleration": (f"{unit} / s²", ", absolute" if is_base else ""),
    }
    kinds = ("", "rate of the ", "acceleration of the ")
    return xarray.Dataset(
        {
            name: driven.variable(values, f"root mean square of the {of}{read.kind}{where}", units)
            for (name, (units, where)), of, values in zip(names.items(), kinds, rms, strict=True)
        },
        coords=driven.coordinates,
        attrs={
            **driven.words,
            "band": [low, high],
            "accuracy": max(worst, max(changes)),
        },
    )


#: One-sided, per Hz: of a force, a moment, an acceleration, an angular one.
_DENSITIES = "N2/Hz or N2 m2/Hz or m2 s/s4 or s/s4"


def _band(given: Any) -> tuple[float, float]:
    ends = [not_negative("band", each) for each in bounded("band", unwrapped("band", given), most=2)]
    if len(ends) != 2 or not ends[0] < ends[1] <= HIGHEST:
        raise ValueError(
            f"band must be two frequencies up to {HIGHEST:g} Hz, the lower first, got {shown(given)}"
        )
    return ends[0], ends[1]


def _density(given: Density) -> Callable[[Floats], Floats]:
    if not callable(given):
        level = not_negative("density", given, _DENSITIES)
        return lambda frequency: np.full_like(frequency, level)
    function = given

    def values(frequency: Floats) -> Floats:
        try:
            found = real_numbers("density", function(frequency), _DENSITIES)
        except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
            raise TypeError(
                f"density must be a number or a function of an array of frequencies, got {shown(function)}, "
                f"which fails: {type(error).__name__}: {error}"
            ) from error
        if found.shape != frequency.shape or (found < 0.0).any():
            raise ValueError(
                "density must be a number, or a function of an array of frequencies that gives as many "
                f"numbers, none negative, got {shown(found)}"
            )
        return found

    return values
