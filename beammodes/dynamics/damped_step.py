"""The largest stable step of a damped chain: dampers of its high modes ask for a shorter one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import choice, real, shown
from beammodes.dynamics.damping import Damping
from beammodes.vibration.stability import INTEGRATORS

if TYPE_CHECKING:
    pass
from beammodes.dynamics.modal_damping import damped_eigenvalues, damping_of_modes

__all__ = ["damped_time_step", "runge_kutta_limit"]


# R(z) of the classical Runge-Kutta method.
_RUNGE_KUTTA = tuple(1 / math.factorial(k) for k in range(5))


def damped_time_step(chain: Chain, damping: Damping, integrator: str = "rk4") -> float:
    """Return the largest fixed step at which the damped linear chain is stable [s].

        max over λ of |R(h λ)| = 1,   R(z) = 1 + z + z²/2 + z³/6 + z⁴/24          (rk4)
        largest eigenvalue of  h² Ω² + 2 h G  = 4                                 (both others)

    The others take the damping force explicitly, of the velocity half a step ago (leapfrog) or at the step's
    start (semi-implicit Euler), which makes the same limit,  h ω ≤ 2 (√(1 + ζ²) - ζ)  for one mode: damping
    shortens their step, where it may lengthen that of Runge-Kutta a little before it shortens it. A velocity
    Verlet scheme that takes damping otherwise has other limits.

    Parameters
    ----------
    chain : Chain
        Of at most 500 hinges; its highest and its most damped modes decide.
    damping : Damping
    integrator : str
        "rk4", "leapfrog" or "semi_implicit_euler".

    Returns
    -------
    float
        Infinite for a chain without elastic modes and damping of its rigid motion.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, `joint` does not suit the chain, or the chain is too long.

    Source
    ------
    E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, § IV.2; the second condition is that
    where an eigenvalue of the step's matrix reaches -1.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.dynamics.damping_ratio import joint_dampers
    >>> from beammodes.vibration.stability import stable_time_step
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=10)
    >>> damped = damped_time_step(chain, joint_dampers(chain, 0.02))
    >>> round(damped / stable_time_step(chain), 3)                   # its top mode has a ratio of 3.8
    0.132
    """
    kind = choice("integrator", integrator, INTEGRATORS)
    omega, coupling = damping_of_modes(chain, damping)
    # A rigid motion feels α alone.
    drag = damping.mass if chain.boundary.rigid_body_modes else 0.0
    if kind == "rk4":
        values = map(complex, [*damped_eigenvalues(omega, coupling), -drag])
        # Rounding may put a mode that no damper reaches beyond the imaginary axis.
        steps = [runge_kutta_limit(min(max(0.0, -z.real / abs(z)), 1.0)) / abs(z) for z in values if z]
        return min(steps, default=math.inf)
    size = np.diag(omega)
    # λ² - λ G - Ω² has real roots, and h = 2/λ of the largest one.
    roots = np.linalg.eigvalsh(np.block([[coupling, size], [size, np.zeros_like(size)]]))
    highest = float(max([drag, *roots]))
    return 2.0 / highest if highest else math.inf


def runge_kutta_limit(ratio: float) -> float:
    """Return the largest stable  h |λ|  of classical Runge-Kutta for an eigenvalue of a damping ratio.

        |R(-r (ζ ± i √(1 - ζ²)))| = 1,  the smallest r > 0 beyond which it exceeds 1

    Parameters
    ----------
    ratio : float
        ζ = -Re λ/|λ|, from 0, where it is 2√2, to 1, the negative real axis.

    Raises
    ------
    TypeError, ValueError
        If `ratio` is not a real number within 0..1.

    Examples
    --------
    >>> round(runge_kutta_limit(0.0), 9), round(runge_kutta_limit(1.0), 9)
    (2.828427125, 2.785293563)
    """
    from scipy.optimize import brentq

    zeta = real("ratio", ratio)
    if not 0.0 <= zeta <= 1.0:
        raise ValueError(f"ratio must be from 0 to 1, got {shown(ratio)}")
    # (|R|² - 1)/r in powers of r, free of the rounding of |R|² beside 1: cosines of multiples by recurrence.
    cosine = [1.0, -zeta]
    for _ in range(3):
        cosine.append(-2.0 * zeta * cosine[-1] - cosine[-2])
    growth = np.polynomial.Polynomial(
        [
            sum(
                _RUNGE_KUTTA[j] * _RUNGE_KUTTA[m - j] * cosine[abs(m - 2 * j)]
                for j in range(max(0, m - 4), min(m, 4) + 1)
            )
            for m in range(1, 9)
        ]
    )
    # In the left half plane the region of stability holds every r to 2 and none beyond 4.
    radius = np.linspace(2.0, 4.0, 401)
    beyond = int(np.argmax(growth(radius) > 0.0))
    return float(brentq(growth, radius[beyond - 1], radius[beyond], xtol=1e-15))
