"""A beam's bending stiffness from one measurement: a natural frequency, or a static deflection."""

from __future__ import annotations

import math
from collections.abc import Callable

from beammodes.accuracy.statics import beam_statics
from beammodes.checks import choice, positive_real, real, shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.applied_loads import PointLoad
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike

__all__ = ["stiffness_from_deflection", "stiffness_from_frequency"]

# How far a stiffness is sought from that of a beam between pins with the same frequency.
_REACH = 1e16


def stiffness_from_frequency(
    frequency: float,
    boundary: BoundaryLike,
    *,
    length: float,
    mass_per_length: float,
    mode: int = 1,
    rotary_inertia_per_length: float = 0.0,
) -> float:
    """Return the bending stiffness EI with which a uniform beam has a measured natural frequency.

        EI = ρA L⁴ (2π f)² / β⁴  between plain ends

    Without springs at the ends ω² is proportional to EI, also with bodies there: one solution of the exact
    beam gives EI to its accuracy. With springs ω grows with EI, but not in proportion: the root is sought, to
    1e-13 of EI where ω follows EI, and less sharply where the springs decide ω.

    Parameters
    ----------
    frequency : float [Hz]
        f, of the elastic mode `mode`.
    boundary : str, pair of ends or Boundary
        With springs and bodies, if any.
    length : float [m]
        L.
    mass_per_length : float [kg/m]
        ρA.
    mode : int
        From 1; rigid-body modes are not counted.
    rotary_inertia_per_length : float [kg m]
        ρI of the section.

    Returns
    -------
    float [N m²]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or range, or no stiffness gives this frequency: on springs even a
        rigid beam's is finite.

    References
    ----------
    ω of `euler_bernoulli`; the method is that of ASTM E1876 for free bars, here for any ends.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> measured = bm.euler_bernoulli(beam, "clamped-free(mass=0.2)", 1).frequency[0]
    >>> given = {"length": 1.2, "mass_per_length": 0.62}
    >>> round(bm.stiffness_from_frequency(measured, "clamped-free(mass=0.2)", **given), 9)
    85.0
    """
    omega = 2.0 * math.pi * positive_real("frequency", frequency)
    pair, number = Boundary.of(boundary), whole_number("mode", mode, most=10**6)
    whole, mass = positive_real("length", length), positive_real("mass_per_length", mass_per_length)
    speed = omega * whole * whole / (number * math.pi) ** 2
    pinned = mass * speed * speed
    if not 0.0 < pinned / _REACH < pinned * _REACH < math.inf:
        raise ValueError(
            f"frequency must suit the other numbers: {shown(frequency)} with length {whole} and "
            f"mass_per_length {mass} makes a stiffness outside the range of floating-point numbers"
        )

    def found(stiffness: float) -> float:
        beam = Beam(whole, stiffness, mass, rotary_inertia_per_length)
        return float(euler_bernoulli(beam, pair, number).angular_frequency[-1])

    if not (pair.left.is_elastic or pair.right.is_elastic):
        ratio = omega / found(pinned)
        return pinned * ratio * ratio
    return _sought(found, omega, pinned)


def _sought(found: Callable[[float], float], omega: float, guess: float) -> float:
    """Return the stiffness of a frequency that grows with it; `found` gives ω of EI."""
    from scipy.optimize import brentq

    low = high = guess
    while found(low) > omega and low > guess / _REACH:
        low /= 100.0
    while found(high) < omega and high < guess * _REACH:
        high *= 100.0
    if not found(low) <= omega <= found(high):
        limits = " to ".join(f"{found(end) / (2 * math.pi):.6g}" for end in (low, high))
        raise ValueError(
            f"frequency must be one that some stiffness gives on these springs, {limits} Hz, "
            f"got {omega / (2 * math.pi):.6g}"
        )
    if low == high:
        return guess
    return math.exp(
        brentq(lambda log: found(math.exp(log)) - omega, math.log(low), math.log(high), xtol=1e-14)
    )


def stiffness_from_deflection(
    deflection: float,
    boundary: BoundaryLike,
    *,
    length: float,
    tip_force: float | None = None,
    tip_moment: float | None = None,
    uniform_load: float | None = None,
    mid_force: float | None = None,
    at: str | None = None,
) -> float:
    """Return the bending stiffness EI with which a uniform beam has a measured static deflection.

        EI = c F L³ / y   (c M L² / y for a moment, c q L⁴ / y for a load per length)

    with c of the exact beam: 1/3 at the tip of a clamped-free beam under a tip force, 5/384 at the middle of
    a pinned-pinned one under a uniform load.

    Parameters
    ----------
    deflection : float [m]
        y, positive upwards like the loads; a moment is counter-clockwise with the firmer end at the left.
    boundary : str, pair of ends or Boundary
        Without springs and without rigid-body motion; its tip is the less firm end.
    length : float [m]
        L.
    tip_force : float [N], optional
        F: one load is to be given.
    tip_moment : float [N m], optional
        M.
    uniform_load : float [N/m], optional
        q.
    mid_force : float [N], optional
        F in the middle of the beam, as of a three-point bending test.
    at : str, optional
        Where y is measured, "tip" or "midspan"; by default the tip, or midspan where the tip is held or the
        force is there.

    Returns
    -------
    float [N m²]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, not exactly one load is given, or the load does not move that
        point, or moves it the other way.

    Examples
    --------
    >>> import beammodes as bm
    >>> round(bm.stiffness_from_deflection(-0.02, "clamped-free", length=1.2, tip_force=-3.0), 9)
    86.4
    >>> round(bm.stiffness_from_deflection(-2e-4, "pinned-pinned", length=1.2, mid_force=-48.0), 6)
    8640.0
    """
    measured, whole = real("deflection", deflection), positive_real("length", length)
    loads = {
        "tip_force": tip_force,
        "tip_moment": tip_moment,
        "uniform_load": uniform_load,
        "mid_force": mid_force,
    }
    given = {name: real(name, value) for name, value in loads.items() if value is not None}
    if len(given) != 1:
        raise ValueError(f"one of {', '.join(loads)} must be given, got {', '.join(given) or 'none'}")
    ((name, load),) = given.items()
    beam = Beam(whole, 1.0, 1.0)
    held = Boundary.of(boundary).canonical.right.holds_deflection
    usual = "midspan" if held or name == "mid_force" else "tip"
    place = choice("at", usual if at is None else at, ("tip", "midspan"))
    if name == "mid_force":
        pushed = beam_statics(beam, Boundary.of(boundary).canonical, PointLoad(0.5 * whole, force=1.0))
        unit = (
            math.nan
            if place == "tip" and held
            else pushed.deflection(whole if place == "tip" else 0.5 * whole)
        )
    else:
        response = beam_statics(beam, boundary, name)
        unit = response.deflection if place == "tip" else response.midspan_deflection
    if math.isnan(unit) or unit * load == 0.0:
        raise ValueError(f"{name} must move the {place} of {Boundary.of(boundary)}, got {shown(load)}")
    stiffness = unit * load / measured if measured else math.inf
    if not 0.0 < stiffness < math.inf:
        raise ValueError(
            f"deflection must be one that {name} = {load} causes at the {place}, "
            f"{'upwards' if unit * load > 0 else 'downwards'}, got {shown(deflection)}"
        )
    return stiffness
