"""Modal superposition: a beam's small deflection as a sum of its exact modes, driven by a base that moves.

In the frame of the base, whose origin is the beam's left end, with φ_n of unit modal mass,

    y(x, t) = Σ φ_n(x) q_n(t),

    q_n'' + 2 ζ_n ω_n q_n' + ω_n² q_n + Σ_m (Ω² (S_nm - T_nm) - a S'_nm) q_m = -b B_n - α C_n,

    B_n = ∫ φ_n dm,   C_n = ∫ x φ_n dm + ∫ φ_n' dJ,   T_nm = ∫ φ_n φ_m dm,
    S_nm = ∫ (∫_x s dm) φ_n' φ_m' dx,   S'_nm = ∫ (∫_x dm) φ_n' φ_m' dx,

where the left end's acceleration is a along the beam and b across it, and the base turns at the rate Ω with
the angular acceleration α. dm is the mass of the beam and of the bodies at its ends, whose centres are a
little beyond the beam, and dJ the rotary inertia of both; springs of the ends are carried by the base, and
are in φ and ω. The inner integrals are over all that lies beyond x: S and S' are the work of the axial force
that carries it along. Conventional linear analysis leaves it out, and then the term -Ω² T, which turning axes
bring, makes the beam soften, and beyond Ω = ω_1 move away for good. Without rotary inertia T is 1.

Sources: L. Meirovitch, Analytical Methods in Vibrations (1967), chapter 7, for the sum; T. R. Kane,
R. R. Ryan and A. K. Banerjee, Dynamics of a cantilever beam attached to a moving base, Journal of Guidance,
Control, and Dynamics 10 (1987), 139-151, for what is left out and what it does.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import flag, positive_real, real_numbers, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_beam import BeamModes
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, check_no_hub
from beammodes.problem.profiles import mean_over
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping, checked_damping, damping_ratios

if TYPE_CHECKING:
    import xarray

    from beammodes.exact.spectral_beam import SpectralBeamModes
    from beammodes.exact.supported_beam import SupportedBeamModes

    ExactModes = BeamModes | SupportedBeamModes | SpectralBeamModes
else:
    xarray = Deferred("xarray")

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
    damping_ratio: ArrayLike | None = None,
    damping: Damping | None = None,
    stiffening: bool = False,
    tolerance: float = 1e-10,
) -> xarray.Dataset:
    """Return the motion of a beam on a moving base as a sum of its modes, small deflections only.

    It starts straight and at rest with the base, unless `initial` says otherwise.

    Parameters
    ----------
    beam : Beam
        Uniform or not.
    boundary : str, pair of ends or Boundary
        With springs and bodies, if any; without rigid-body motion. The base carries both supports and what
        springs rest on; along the beam the left one only. Not of hubs with a radius.
    modes : int
        Number of modes, 1 to 200, of a beam that varies at most 100.
    time : array of shape (times,) [s]
        Ascending, from 0 or later. The motion starts at 0.
    base : BaseMotion, optional
        At rest by default.
    initial : array of shape (modes,), optional
        Modal coordinates to start from at rest.
    damping_ratio : float or row of float, optional
        ζ of modes from the first, the last one of all above: 0.01 is 1 % of critical. Given alone.
    damping : Damping, optional
        Rayleigh's, such as `rayleigh_damping` finds; of motion relative to the base.
    stiffening : bool
        True to let the axial force that carries the beam along stiffen it (or soften it, if it pushes).
    tolerance : float
        Relative, of the variable-step integration. Without a base the answer is that of free decay, in closed
        form, and nothing is integrated.

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
    >>> ends = ("clamped", bm.End(mass=0.5, offset=0.1))
    >>> swing = bm.modal_response(bm.Beam.unit(), ends, 1, time=[0.0, 2.0], initial=[1.0], damping_ratio=0.02)
    >>> swing.q.values[:, 0].round(6)
    array([ 1.     , -0.81874])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if base is not None and not isinstance(base, BaseMotion):
        raise TypeError(f"base must be a BaseMotion or None, got {shown(base)}")
    flag("stiffening", stiffening)
    pair, count = Boundary.of(boundary), whole_number("modes", modes, most=MAX_MODES)
    check_no_hub(pair.left, pair.right)
    if pair.rigid_body_modes:
        raise ValueError(f"boundary must leave no rigid-body motion, got {pair.name}")
    if not pair.left.is_grounded:
        raise ValueError(f"boundary must tie down the left end, got {pair.name}: name that end first")
    check_no_hub(pair.left, pair.right)
    times, shapes = _ascending(time), euler_bernoulli(beam, pair, count)
    start, omega = _start(initial, count), shapes.angular_frequency
    ratio = _ratios(damping_ratio, damping, omega)
    if base is None:
        q = _decaying(omega, ratio, start, times)
    else:
        q = _integrated(shapes, ratio, base, start, times, stiffening, _tolerance(tolerance))
    return _dataset(shapes, times, q)


def _ratios(damping_ratio: ArrayLike | None, damping: Damping | None, omega: Floats) -> Floats:
    """Return ζ of each mode."""
    checked_damping(damping)
    given = damping or Damping()
    if np.any(np.asarray(given.joint)):
        raise ValueError(f"damping of a beam must be without joint dampers, as it has no hinges, got {given}")
    if damping_ratio is None:
        return given.mass / (2 * omega) + given.stiffness * omega / 2
    if given != Damping():
        raise ValueError(f"damping_ratio must be given alone, without damping, got {given}")
    row = damping_ratios(damping_ratio)
    return row[np.minimum(np.arange(len(omega)), len(row) - 1)]


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


def _decaying(omega: Floats, ratio: Floats, start: Floats, times: Floats) -> Floats:
    """Return modal coordinates of free motion from rest, shape (times, modes)."""
    # With λ the slower root and 2 s the roots' distance:  q = q(0) e^{λt} (1 - λ (1 - e^{-2st})/2s).
    apart = omega * np.sqrt(ratio**2 - 1 + 0j)
    slower, t = -(omega**2) / (ratio * omega + apart), times[:, None]
    gap = 2 * apart * t
    # Roots that meet, at a ratio of 1.
    share = np.where(gap == 0, 1.0, -np.expm1(-gap) / np.where(gap == 0, 1.0, gap))
    decayed: Floats = (start * np.exp(slower * t) * (1 - slower * t * share)).real
    return decayed


def _integrated(
    shapes: ExactModes,
    ratio: Floats,
    base: BaseMotion,
    start: Floats,
    times: Floats,
    stiffening: bool,
    tolerance: float,
) -> Floats:
    """Return modal coordinates at the times, shape (times, modes)."""
    from scipy.integrate import solve_ivp

    found, omega, size = _integrals(shapes), shapes.angular_frequency, len(start)
    square, drag = omega**2, 2 * ratio * omega

    def rate(moment: float, state: Floats) -> Floats:
        course = base.at(moment)
        angle, spin, gain = course[2]
        ax, ay = course[:2, 2]
        along, across = ax * np.cos(angle) + ay * np.sin(angle), ay * np.cos(angle) - ax * np.sin(angle)
        q, speed = state[:size], state[size:]
        force = -across * found.push - gain * found.swing - drag * speed - square * q
        force += spin**2 * (found.mass @ q)
        if stiffening:
            force -= (spin**2 * found.spun - along * found.pulled) @ q
        return np.concatenate([speed, force])

    beam = shapes.beam
    # A longer step could pass over what the base does for a short time only.
    solved = solve_ivp(
        rate,
        (0.0, max(times[-1], np.finfo(float).tiny)),
        np.concatenate([start, np.zeros(size)]),
        method="DOP853",
        t_eval=times,
        rtol=tolerance,
        atol=tolerance / 1000 * np.sqrt(beam.mean_mass_per_length * beam.length**3),
        max_step=max(times[-1] / 100, np.finfo(float).tiny),
    )
    if not solved.success or not np.isfinite(solved.y).all():
        raise ArithmeticError(f"integration stopped before t = {times[-1]:.6g} s: {solved.message}")
    return np.asarray(solved.y[:size].T)


class _Integrals(NamedTuple):
    """B, C, T, S and S' of the module's equations."""

    push: Floats
    swing: Floats
    mass: Floats
    spun: Floats
    pulled: Floats


class _Point(NamedTuple):
    """Bodies of the ends, or the beam at Gauss points."""

    #: Where the centre of mass is, and its deflection and rotation in the modes.
    x: Floats
    deflection: Floats
    rotation: Floats
    mass: Floats
    rotary: Floats
    #: ∫ s dm and ∫ dm of all beyond it, times the length that they bear on.
    spun: Floats
    pulled: Floats


def _integrals(shapes: ExactModes) -> _Integrals:
    parts = [_along(shapes), *_bodies(shapes)]
    x, mass, rotary, spun, pulled = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("x", "mass", "rotary", "spun", "pulled")
    )
    value = np.hstack([part.deflection for part in parts])
    slope = np.hstack([part.rotation for part in parts])
    return _Integrals(
        push=value @ mass,
        swing=value @ (mass * x) + slope @ rotary,
        mass=(value * mass) @ value.T,
        spun=(slope * spun) @ slope.T,
        pulled=(slope * pulled) @ slope.T,
    )


def _along(shapes: ExactModes) -> _Point:
    """Return the beam at Gauss points."""
    beam, pair = shapes.beam, shapes.boundary
    length, whole = beam.length, beam.mean_mass_per_length * beam.length
    if isinstance(shapes, BeamModes) or beam.is_uniform:
        # Twelve points a half-wave.
        node, weight = np.polynomial.legendre.leggauss(24 + 12 * len(shapes.angular_frequency))
        x, weight = length * (node + 1) / 2, weight / 2
        mass, inertia = whole * weight, mean_over(beam.rotary_inertia_per_length, length) * length * weight
        moment, beyond = whole / length * (length**2 - x**2) / 2, whole / length * (length - x)
    else:
        # Only SpectralBeamModes are of beams that vary; their class is not imported here, it loads SciPy.
        grid = shapes.shapes.grid  # type: ignore[union-attr]
        x, weight = length * grid.x, grid.weight
        mass, inertia = whole * weight * grid.mass, whole * length**2 * weight * grid.rotary
        moment = float(mass @ x) - whole * grid.integral(grid.mass * x)
        beyond = float(mass.sum()) - whole * grid.integral(grid.mass)
    heavy, _, offset = map(float, pair.right.moving_body)
    moment, beyond = moment + heavy * (length + offset), beyond + heavy
    bears = length * weight
    return _Point(x, shapes.shape(x), shapes.slope(x), mass, inertia, moment * bears, beyond * bears)


def _bodies(shapes: ExactModes) -> Iterator[_Point]:
    """Yield the bodies at the ends, on arms as long as they are offset."""
    length = shapes.beam.length
    for end, place, outward in ((shapes.boundary.left, 0.0, -1.0), (shapes.boundary.right, length, 1.0)):
        heavy, inertia, offset = map(float, end.moving_body)
        if not heavy and not inertia:
            continue
        at, arm = np.array([place]), outward * offset
        turn, mass = shapes.slope(at), np.array([heavy])
        centre = at + arm
        deflection = shapes.shape(at) + arm * turn
        yield _Point(centre, deflection, turn, mass, np.array([inertia]), mass * centre * arm, mass * arm)


def _dataset(shapes: ExactModes, times: Floats, q: Floats) -> xarray.Dataset:
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
