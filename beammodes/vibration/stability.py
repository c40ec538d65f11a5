"""Time steps: the report's C-table, what its 8 is, and the step at which a chain is really stable.

The report gives h = C L² √(ρA/EI) with C = 8/K_n, where K_n is the n-th dimensionless frequency of a beam
clamped at both ends, in Roark's rounded figures. Where the 8 comes from: the classical Runge-Kutta method of
order four, applied to an undamped oscillator, has the amplification

    |R(i z)|² = 1 - z⁶/72 + z⁸/576,   z = h ω,    so |R| ≤ 1 for  z² ≤ 8.

The condition is  h ω ≤ √8 = 2√2,  not  h ω ≤ 8: the square root is missing. The published step is therefore
2.83 times too long for the mode that it names, which it amplifies by |R(8i)| = 160 every step. What decides
is the chain's highest mode, near 6.9 N² √(EI/(ρA L⁴)): the published step is beyond its limit too as soon as
N exceeds the number of modes by one or two (for one mode and N = 10, 84 times). At fixed step it is not
stable. The report pairs it with a variable-step integrator, which takes shorter steps of its own accord
and so hides it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import choice, shown, whole_number
from beammodes.equations.axial_pull import axial_pull
from beammodes.exact.exact_beam import wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

__all__ = [
    "INTEGRATORS",
    "ROARK_CLAMPED_CLAMPED",
    "exact_constants",
    "highest_angular_frequency",
    "published_constants",
    "published_time_step",
    "stable_time_step",
]

Array = NDArray[np.float64]

#: Largest stable  h ω  on an undamped oscillator. Source: C. W. Gear, Numerical Initial Value Problems in
#: Ordinary Differential Equations (1971), p. 41, for rk4; both others have amplification matrices of
#: determinant 1 and trace 2 - (h ω)².
INTEGRATORS: dict[str, float] = {
    "rk4": 2 * math.sqrt(2),
    "leapfrog": 2.0,
    "semi_implicit_euler": 2.0,
}

#: K_1 to K_5 as printed by Roark and Young, Formulas for Stress and Strain, p. 576, both ends fixed.
ROARK_CLAMPED_CLAMPED = (22.4, 61.7, 121.0, 200.0, 299.0)


def published_constants() -> Array:
    """Return the report's C for 1 to 5 modes, C = 8/K_n to its three printed decimals, shape (5,).

    Source: the report's table, headed "Constant K"; its step 2 calls the same number C.

    Examples
    --------
    >>> published_constants()
    array([0.357, 0.13 , 0.066, 0.04 , 0.027])
    """
    return np.round(8 / np.array(ROARK_CLAMPED_CLAMPED), 3)


def exact_constants(modes: int, *, limit: float = 8.0) -> Array:
    """Return  limit / K_n  with the exact roots K_n = β_n² of the clamped-clamped beam, shape (modes,).

    Parameters
    ----------
    modes : int
        How many, from the first.
    limit : float
        8 as in the report; 2√2 makes one such mode alone stable under fixed-step RK4.

    Examples
    --------
    >>> exact_constants(2).round(4)
    array([0.3576, 0.1297])
    """
    count = whole_number("modes", modes)
    return np.asarray(limit / wavenumber("clamped-clamped", np.arange(1, count + 1)) ** 2)


def published_time_step(beam: Beam, modes: int) -> float:
    """Return the report's largest step  h = C L² √(ρA/EI)  [s]; at fixed step it is not stable.

    Parameters
    ----------
    beam : Beam
        L, EI and ρA.
    modes : int
        How many modes are to be followed, 1 to 5.

    Raises
    ------
    TypeError, ValueError
        If `beam` is no Beam or `modes` lies outside the table.

    Examples
    --------
    >>> published_time_step(Beam.unit(), modes=3)
    0.066
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    constants = published_constants()
    return float(constants[whole_number("modes", modes, most=len(constants)) - 1] / beam.frequency_unit)


def stable_time_step(chain: Chain, integrator: str = "rk4", *, load: Load | None = None) -> float:
    """Return the largest fixed step at which the undamped linear chain is stable [s].

        h = 2√2 / ω_max  (rk4),   h = 2 / ω_max  (leapfrog, semi_implicit_euler)

    Parameters
    ----------
    chain : Chain
        Its own highest frequency decides, not the modes that one wants to see.
    integrator : str
        "rk4", "leapfrog" or "semi_implicit_euler".
    load : Load, optional
        An axial force.

    Returns
    -------
    float
        Infinite for a chain without elastic modes.

    Raises
    ------
    TypeError, ValueError
        If `chain` is no Chain or the integrator is unknown.

    Examples
    --------
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=10)
    >>> round(stable_time_step(chain), 5)
    0.00424
    """
    limit = INTEGRATORS[choice("integrator", integrator, INTEGRATORS)]
    highest = highest_angular_frequency(chain, load=load)
    return limit / highest if highest else math.inf


def highest_angular_frequency(chain: Chain, *, load: Load | None = None) -> float:
    """Return the chain's highest natural frequency, or a bound just above it for a long chain [rad/s].

    A chain of at most 500 hinges is solved. For a longer one the answer is the largest of its joints' own
    frequencies,  ω² ≤ max_j  λ_max(M_j⁻¹ K_j),  where M_j is the inertia of the two pieces at joint j and
    K_j its spring, supports and tension, each shared equally among its joints: kinetic and stored energy are
    sums over joints, so no mode can exceed the largest ratio. On uniform rods it is the band edge √48 N²,
    which the mode itself approaches.

    Examples
    --------
    >>> round(highest_angular_frequency(Chain(Beam.unit(), "guided-guided", segments=1)) ** 2, 9)
    48.0
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    model = linearize(chain, load=load)
    if model.elastic_modes == 0:
        return 0.0
    if len(chain.hinge_stiffness) <= MAX_DENSE:
        return float(solve_modes(model).angular_frequency[-1])
    return _joint_bound(chain, model.load)


def _joint_bound(chain: Chain, load: Load) -> float:
    """Return the largest joint frequency, each joint's two pieces taken as free at their far tips.

    In (deflection of the hinge, angle of the left piece, angle of the right piece) a piece with its centre of
    mass a beyond the hinge has mass m, first moment m a and inertia J + m a². A held piece keeps its angle.
    Supports and an axial force are shared among the joints as the inertia of their pieces is.
    """
    length, mass, centre = chain.length, chain.mass, chain.centre
    joints = np.full(chain.pieces, 2.0)
    joints[[0, -1]] = 1.0
    held = np.array(chain.held_angles)
    inertia, stiffness = np.zeros((2, chain.pieces - 1, 3, 3))
    unit = chain.units.stiffness
    pull = np.where(held, 0.0, np.maximum(0.0, np.array(axial_pull(chain, load), dtype=np.float64)) * unit)
    for side, pieces, arm in ((1, slice(None, -1), centre - length), (2, slice(1, None), centre)):
        share, free = 1 / joints[pieces], ~held[pieces]
        moment = (mass * arm)[pieces] * free
        turning = (chain.rotary_inertia + mass * arm**2)[pieces]
        inertia[:, 0, 0] += mass[pieces] * share
        inertia[:, 0, side] = inertia[:, side, 0] = moment * share
        inertia[:, side, side] = np.where(free, turning * share, 1.0)
        stiffness[:, side, side] = (chain.joint_stiffness + pull[pieces] * share) * free
    both = -chain.joint_stiffness * ~held[:-1] * ~held[1:]
    stiffness[:, 1, 2] = stiffness[:, 2, 1] = both
    for joint, side, reach, (translation, rotation) in (
        (0, 1, -length[0], chain.support_stiffness[0]),
        (-1, 2, length[-1], chain.support_stiffness[1]),
    ):
        tip = np.array([1.0, 0.0, 0.0])
        tip[side] = 0.0 if held[[0, -1][side - 1]] else reach
        if np.isfinite(translation):
            stiffness[joint] += translation * np.outer(tip, tip)
        if np.isfinite(rotation):
            stiffness[joint, side, side] += rotation
    lower = np.linalg.inv(np.linalg.cholesky(inertia))
    local = lower @ stiffness @ np.swapaxes(lower, 1, 2)
    return float(np.sqrt(np.linalg.eigvalsh(local)[:, -1].max()))
