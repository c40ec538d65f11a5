"""Modal superposition: a beam's small deflection as a sum of its exact modes, driven by a base that moves.

In the frame of the base, whose origin is the beam's left end, with φ_n of unit modal mass,

    y(x, t) = Σ φ_n(x) q_n(t),      q_n'' + (ω_n² - Ω²) q_n + Σ_m (Ω² S_nm - a S'_nm) q_m = -b B_n - α C_n,

    B_n = ∫ ρA φ_n dx,   C_n = ∫ ρA x φ_n dx,   S_nm = ∫ ρA/2 (L² - x²) φ_n' φ_m' dx,
    S'_nm = ∫ ρA (L - x) φ_n' φ_m' dx,

where the left end's acceleration is a along the beam and b across it, and the base turns at the rate Ω with
the angular acceleration α. The sum over m is the work of the axial force T = ∫ ρA (Ω² s - a) ds, from x to L,
that carries the beam along. Conventional linear analysis leaves it out, and then the term -Ω², which turning
axes bring, makes the beam soften, and beyond Ω = ω_1 move away for good.

Sources: L. Meirovitch, Analytical Methods in Vibrations (1967), chapter 7, for the sum; T. R. Kane,
R. R. Ryan and A. K. Banerjee, Dynamics of a cantilever beam attached to a moving base, Journal of Guidance,
Control, and Dynamics 10 (1987), 139-151, for what is left out and what it does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import flag, positive_real, real_numbers, shown, whole_number
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.exact.exact_beam import BeamModes, plain_modes
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.version import SOURCE

if TYPE_CHECKING:
    import xarray

__all__ = ["modal_response"]


#: Dense products of modes; far more than any sum of modes that a time integration can follow.
MAX_MODES = 200


def modal_response(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int,
    *,
    time: ArrayLike,
    base: BaseMotion | None = None,
    initial: ArrayLike | None = None,
    stiffening: bool = False,
    tolerance: float = 1e-10,
) -> xarray.Dataset:
    """Return the motion of a beam on a moving base as a sum of its modes, small deflections only.

    It starts straight and at rest with the base, unless `initial` says otherwise.

    Parameters
    ----------
    beam : Beam
        Uniform; its rotary inertia, if it has any, is left out.
    boundary : str, pair of ends or Boundary
        Plain ends without rigid-body motion. The base carries both; along the beam the left one only.
    modes : int
        Number of modes, 1 to 200.
    time : array of shape (times,) [s]
        Ascending, from 0 or later. The motion starts at 0.
    base : BaseMotion, optional
        At rest by default.
    initial : array of shape (modes,), optional
        Modal coordinates to start from at rest.
    stiffening : bool
        True to let the axial force that carries the beam along stiffen it (or soften it, if it pushes).
    tolerance : float
        Relative, of the variable-step integration. Without a base the answer is  q cos ωt  and nothing is
        integrated.

    Returns
    -------
    xarray.Dataset
        `q`, over time and mode, and the right tip's deflection from the line of the base.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.
    ArithmeticError
        If the integration fails, as where an unstable motion leaves the finite numbers.

    Examples
    --------
    >>> import beammodes as bm
    >>> base = bm.BaseMotion(y=bm.harmonic(0.01, 2.0))
    >>> motion = bm.modal_response(bm.Beam.unit(), "clamped-free", 3, time=[0.0, 0.5, 1.0], base=base)
    >>> motion.tip_deflection.values.round(6) + 0.0
    array([0.      , 0.002054, 0.008309])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if base is not None and not isinstance(base, BaseMotion):
        raise TypeError(f"base must be a BaseMotion or None, got {shown(base)}")
    flag("stiffening", stiffening)
    pair, count = Boundary.of(boundary), whole_number("modes", modes, most=MAX_MODES)
    if pair.rigid_body_modes:
        raise ValueError(f"boundary must leave no rigid-body motion, got {pair.name}")
    if not beam.is_uniform:
        raise ValueError(
            f"beam must be uniform for a sum of its modes, got {shown(beam)}: simulate() takes a Chain of it"
        )
    if not pair.is_plain:
        raise ValueError(
            f"boundary must be without springs or bodies for a sum of modes, got {shown(pair.name)}: "
            "simulate() takes a Chain with such ends"
        )
    if not pair.left.is_grounded:
        raise ValueError(f"boundary must tie down the left end, got {pair.name}: name that end first")
    times, shapes = _ascending(time), plain_modes(beam, pair, count)
    start = _start(initial, count)
    if base is None:
        q = start * np.cos(np.outer(times, shapes.angular_frequency))
    else:
        q = _integrated(shapes, base, start, times, stiffening, _tolerance(tolerance))
    return _dataset(shapes, times, q)


def _tolerance(tolerance: float) -> float:
    number = positive_real("tolerance", tolerance)
    if not 1e-13 <= number <= 0.1:
        raise ValueError(f"tolerance must be from 1e-13 to 0.1, got {shown(tolerance)}")
    return number


def _ascending(time: ArrayLike) -> Floats:
    times = real_numbers("time", time)
    if times.ndim != 1 or not times.size:
        raise TypeError(f"time must be real numbers in a row, got {shown(time)}")
    if times[0] < 0.0 or (np.diff(times) <= 0.0).any():
        raise ValueError(f"time must ascend, be finite and not negative, got {shown(time)}")
    return times


def _start(initial: ArrayLike | None, count: int) -> Floats:
    start = np.zeros(count) if initial is None else real_numbers("initial", initial)
    if start.shape != (count,):
        raise ValueError(f"initial must be {count} finite numbers, one a mode, got {shown(initial)}")
    return start


def _integrated(
    shapes: BeamModes, base: BaseMotion, start: Floats, times: Floats, stiffening: bool, tolerance: float
) -> Floats:
    """Return modal coordinates at the times, shape (times, modes)."""
    from scipy.integrate import solve_ivp

    push, swing, spun, pulled = _integrals(shapes)
    square, size = shapes.angular_frequency**2, len(start)

    def rate(moment: float, state: Floats) -> Floats:
        course = base.at(moment)
        angle, spin, gain = course[2]
        ax, ay = course[:2, 2]
        along, across = ax * np.cos(angle) + ay * np.sin(angle), ay * np.cos(angle) - ax * np.sin(angle)
        q = state[:size]
        force = -across * push - gain * swing - (square - spin**2) * q
        if stiffening:
            force -= (spin**2 * spun - along * pulled) @ q
        return np.concatenate([state[size:], force])

    # A longer step could pass over what the base does for a short time only.
    found = solve_ivp(
        rate,
        (0.0, max(times[-1], np.finfo(float).tiny)),
        np.concatenate([start, np.zeros(size)]),
        method="DOP853",
        t_eval=times,
        rtol=tolerance,
        atol=tolerance / 1000 * np.sqrt(shapes.beam.mean_mass_per_length * shapes.beam.length**3),
        max_step=max(times[-1] / 100, np.finfo(float).tiny),
    )
    if not found.success or not np.isfinite(found.y).all():
        raise ArithmeticError(f"integration stopped before t = {times[-1]:.6g} s: {found.message}")
    return np.asarray(found.y[:size].T)


def _integrals(shapes: BeamModes) -> tuple[Floats, Floats, Floats, Floats]:
    """Return B, C, S and S' (module's equations), by Gauss' rule, of twelve points a half-wave."""
    length, mass = shapes.beam.length, shapes.beam.mean_mass_per_length
    node, weight = np.polynomial.legendre.leggauss(24 + 12 * len(shapes.wavenumber))
    x, weight = length * (node + 1) / 2, mass * length * weight / 2
    value, slope = shapes.shape(x), shapes.slope(x)
    stretch = [(slope * weight * carried) @ slope.T for carried in ((length**2 - x**2) / 2, length - x)]
    return value @ weight, value @ (weight * x), stretch[0], stretch[1]


def _dataset(shapes: BeamModes, times: Floats, q: Floats) -> xarray.Dataset:
    import xarray

    labels: dict[str, tuple[tuple[str, ...], Any, str, str]] = {
        "q": (("time", "mode"), q, "modal coordinate", "kg^(1/2) m"),
        "tip_deflection": (
            ("time",),
            q @ shapes.shape(shapes.beam.length),
            "right tip's distance from the line of the base",
            "m",
        ),
        "angular_frequency": (("mode",), shapes.angular_frequency, "angular frequency", "rad/s"),
    }
    return xarray.Dataset(
        {
            name: (dims, array, {"long_name": text, "units": unit})
            for name, (dims, array, text, unit) in labels.items()
        },
        coords={
            "time": ("time", times, {"long_name": "time", "units": "s"}),
            "mode": ("mode", np.arange(1, q.shape[1] + 1), {"long_name": "elastic mode", "units": "1"}),
        },
        attrs={"source": SOURCE, "boundary": shapes.boundary.name},
    )
