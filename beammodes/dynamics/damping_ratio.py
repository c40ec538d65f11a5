"""Damping ratios of a chain: dampers that give a mode the one wanted, and what they do to all else.

In undamped modes of unit modal mass, q = Φ p, a damped chain is

    p'' + G p' + Ω² p = 0,      G = α + β Ω² + Σ_j d_j (joint rotation of the modes)ᵀ (joint rotation).

Without dampers d of its own G is diagonal: every mode keeps its shape and has the ratio ζ = α/(2ω) + βω/2.
Joint dampers in general couple the modes; the eigenvalues λ of the whole then say what remains.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import choice, positive_real, real, shown, whole_number
from beammodes.dynamics.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes
from beammodes.vibration.stability import INTEGRATORS

if TYPE_CHECKING:
    import xarray

__all__ = ["damped_modes", "damped_time_step", "joint_dampers", "runge_kutta_limit"]

Array = NDArray[np.float64]

# R(z) of the classical Runge-Kutta method.
_RUNGE_KUTTA = tuple(1 / math.factorial(k) for k in range(5))


def joint_dampers(chain: Chain, ratio: float, *, mode: int = 1) -> Damping:
    """Return the joint dampers, proportional to the springs, that give a mode a damping ratio.

        d_j = β k_j,   β = 2 ζ/ω_mode

    Every other mode gets ζ ω/ω_mode: the higher, the more. Springs of elastic supports are damped likewise.

    Parameters
    ----------
    chain : Chain
    ratio : float
        ζ, 1 for critical damping.
    mode : int
        From 1; rigid-body modes are not counted.

    Raises
    ------
    TypeError, ValueError
        If `chain` is no Chain or has no such mode, or `ratio` is not a finite real number greater than 0.

    Source
    ------
    Rayleigh, The Theory of Sound, vol. 1 (1877), on dissipation functions.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> damping = joint_dampers(chain, 0.01)
    >>> damped_modes(chain, damping).damping_ratio.values.round(4)
    array([0.01  , 0.0585, 0.1536, 0.2662])
    """
    _check(chain, Damping())
    wanted, model = positive_real("ratio", ratio), linearize(chain)
    if not model.elastic_modes:
        raise ValueError(f"chain must have an elastic mode to damp, got {shown(chain)}")
    number = whole_number("mode", mode, most=model.elastic_modes)
    omega = float(solve_modes(model, number).angular_frequency[-1])
    return Damping(stiffness=2.0 * wanted / omega)


def damped_modes(chain: Chain, damping: Damping) -> xarray.Dataset:
    """Return what damping does to every elastic mode of the linear chain.

        λ = -ζ ω ± i ω √(1 - ζ²),   det(λ² + λ G + Ω²) = 0

    Parameters
    ----------
    chain : Chain
        Of at most 500 hinges.
    damping : Damping

    Returns
    -------
    xarray.Dataset
        Over `mode`: undamped_angular_frequency; natural_angular_frequency |λ| and damping_ratio -Re λ/|λ| of
        the damped pair; damped_angular_frequency |Im λ|; and decay_rate, that of its slower part. Without
        dampers d a row is one mode throughout; with them the last four are in order of |λ|. A pair of real λ
        has a ratio of at least 1 and its geometric mean as |λ|; where dampers d make several such pairs, the
        fastest λ is paired with the slowest, which is a convention. Rigid-body modes are left out.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, `joint` does not suit the chain, or the chain is too long.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> tip = damped_modes(chain, Damping(joint=(0.0, 0.0, 0.0, 0.1)))             # one damper, at one hinge
    >>> tip.damping_ratio.values.round(4)
    array([4.000e-04, 3.000e-02, 1.039e-01, 7.022e-01])
    """
    omega, coupling = _modal_damping(chain, damping)
    if np.any(np.asarray(damping.joint)):
        natural, ratio = _pairs(_eigenvalues(omega, coupling))
    else:
        natural, ratio = omega, coupling.diagonal() / (2 * omega)
    under, over = (np.sqrt(np.maximum(sign * (1 - ratio**2), 0.0)) for sign in (1, -1))
    # ω/(ζ + √(ζ² - 1)) is the slower one of two real λ without the difference of two near numbers.
    slow = np.where(ratio > 1, natural / (ratio + over), ratio * natural)
    columns = {
        "undamped_angular_frequency": (omega, "angular frequency without damping", "rad/s"),
        "natural_angular_frequency": (natural, "modulus of the pair of eigenvalues", "rad/s"),
        "damping_ratio": (ratio, "damping ratio", "1"),
        "damped_angular_frequency": (natural * under, "angular frequency of the damped motion", "rad/s"),
        "decay_rate": (slow, "rate at which the envelope decays", "1/s"),
    }
    return _labelled(columns, chain.boundary.rigid_body_modes)


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
    >>> from beammodes.vibration.stability import stable_time_step
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=10)
    >>> damped = damped_time_step(chain, joint_dampers(chain, 0.02))
    >>> round(damped / stable_time_step(chain), 3)                   # its top mode has a ratio of 3.8
    0.132
    """
    kind = choice("integrator", integrator, INTEGRATORS)
    omega, coupling = _modal_damping(chain, damping)
    # A rigid motion feels α alone.
    drag = damping.mass if chain.boundary.rigid_body_modes else 0.0
    if kind == "rk4":
        values = map(complex, [*_eigenvalues(omega, coupling), -drag])
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


def _check(chain: Chain, damping: Damping) -> None:
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if not isinstance(damping, Damping):
        raise TypeError(f"damping must be a Damping, got {shown(damping)}")


def _modal_damping(chain: Chain, damping: Damping) -> tuple[Array, Array]:
    """Return ω and G of the undamped modes."""
    _check(chain, damping)
    if len(chain.hinge_stiffness) > MAX_DENSE:
        raise ValueError(
            f"chain must have at most {MAX_DENSE} hinges here, where all its modes are needed, "
            f"got {len(chain.hinge_stiffness)}"
        )
    own = damping.joint_damping(chain) - damping.stiffness * chain.joint_stiffness
    modes = solve_modes(linearize(chain))
    bend = np.diff(modes.rotation, axis=1)
    omega = modes.angular_frequency
    return omega, (bend * own) @ bend.T + np.diag(damping.mass + damping.stiffness * omega**2)


def _eigenvalues(omega: Array, coupling: Array) -> NDArray[np.complex128]:
    """Return all λ, two a mode; those of modes that do not couple without loss to a dense solver."""
    if not np.any(coupling - np.diag(coupling.diagonal())):
        half = (coupling.diagonal() / 2).astype(complex)
        root = np.sqrt(half**2 - omega**2)
        return np.concatenate([-half - root, -(omega**2) / (half + root)])
    size = np.diag(omega)
    # In (p', Ω p), where both blocks off the diagonal are alike.
    return np.linalg.eigvals(np.block([[-coupling, -size], [size, np.zeros_like(size)]])).astype(complex)


def _pairs(values: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Return |λ| and ζ of each pair, ascending by |λ|."""
    # A tiny imaginary part is a double root's rounding.
    upper = values[values.imag > 0]
    lone = np.sort(-values[values.imag == 0].real)
    slow, fast = lone[: len(lone) // 2], lone[::-1][: len(lone) // 2]
    means = np.sqrt(slow * fast)
    natural = np.concatenate([np.abs(upper), means])
    ratio = np.concatenate([-upper.real / np.abs(upper), (slow + fast) / (2 * means)])
    order = np.argsort(natural)
    return natural[order], ratio[order]


def _labelled(columns: dict[str, tuple[Array, str, str]], rigid_body_modes: int) -> xarray.Dataset:
    """Return columns of (values, description, unit) over the modes."""
    import xarray

    from beammodes import __version__

    mode = np.arange(1, len(columns["damping_ratio"][0]) + 1)
    return xarray.Dataset(
        {
            name: ("mode", values, {"long_name": text, "units": unit})
            for name, (values, text, unit) in columns.items()
        },
        coords={"mode": ("mode", mode, {"long_name": "elastic mode", "units": "1"})},
        attrs={"source": f"beammodes {__version__}", "rigid_body_modes": rigid_body_modes},
    )
