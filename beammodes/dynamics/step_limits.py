"""Which step an integrator needs: stability, accuracy and damping of one mode, and of a whole chain.

In one step h a linear mode of frequency ω and damping ratio ζ is multiplied by R(z),

    z = ω h (-ζ ± i √(1 - ζ²)),
    rk4:       R = 1 + z + z²/2 + z³/6 + z⁴/24,
    midpoint:  R = (1 + z/2)/(1 - z/2),
    leapfrog:  R = e^{iφ},  sin(φ/2) = ω h/2  (no damping; also semi-implicit Euler),

instead of e^z. It is stable while |R| ≤ 1 for all modes that the chain has, and accurate while arg R and |R|
stay near those of e^z for the modes that one wants to see. Which modes are wanted does not enter the former.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import choice, positive_real, real, whole_number
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import INTEGRATORS

__all__ = [
    "ANALYSED",
    "SAFE_CONSTANT",
    "accuracy_limit",
    "amplification",
    "stability_limit",
    "step_constants",
]

Array = NDArray[np.float64]

Complex = NDArray[np.complex128]

#: Integrators whose R(z) is known here.
ANALYSED = ("rk4", "midpoint", "leapfrog")

#: Of rk4, times N²: no uniform undamped chain between plain ends, with the report's springs, has a mode
#: above the band edge √48 N², so h ≤ ell² √(ρA/(6 EI)) is stable for small motions without any eigen-solve.
SAFE_CONSTANT = 1 / math.sqrt(6)


def amplification(integrator: str, z: Complex) -> Complex:
    """Return R(z), what one step multiplies a mode by; the exact motion has e^z.

    Parameters
    ----------
    integrator : str
        One of `ANALYSED`.
    z : array of complex
        Eigenvalue of the mode times the step; imaginary for leapfrog.

    Examples
    --------
    >>> round(float(abs(amplification("rk4", np.array(1.01 * 2j * np.sqrt(2))))), 3)
    1.073
    >>> round(float(abs(amplification("rk4", np.array(8j)))))           # at the report's step
    160
    """
    kind, z = choice("integrator", integrator, ANALYSED), np.asarray(z, dtype=np.complex128)
    if kind == "rk4":
        return np.asarray(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))))
    if kind == "midpoint":
        return np.asarray((1 + z / 2) / (1 - z / 2))
    if np.any(z.real != 0.0):
        raise ValueError("leapfrog is analysed without damping: z must be imaginary")
    # The root of R² - (2 + z²) R + 1 with the larger |R|: it turns while |z| ≤ 2 and grows beyond.
    half = 1 + z**2 / 2
    turning = half + 1j * z.imag * np.sqrt(np.maximum(0.0, 1 - z.imag**2 / 4))
    return np.asarray(np.where(abs(z) <= 2, turning, half - np.sqrt(half**2 - 1)))


def _eigenvalues(damping_ratio: float) -> Complex:
    """Return both eigenvalues of a mode of frequency 1, the faster one first."""
    ratio = complex(damping_ratio)
    root = np.sqrt(ratio**2 - 1)
    return np.array([-ratio - root, -ratio + root])


def _first_crossing(excess: Callable[[Array], Array], low: float, high: float) -> float:
    """Return the first place where `excess` becomes positive, or infinity."""
    grid = np.linspace(low, high, 2001)
    above = np.flatnonzero(excess(grid) > 0)
    if len(above) == 0:
        return math.inf
    if above[0] == 0:
        raise ValueError(f"the limit must lie above {low}")
    a, b = grid[above[0] - 1], grid[above[0]]
    while (middle := (a + b) / 2) not in (a, b):
        a, b = (a, middle) if excess(np.array([middle]))[0] > 0 else (middle, b)
    return float(a)


@cache
def stability_limit(integrator: str, damping_ratio: float = 0.0) -> float:
    """Return the largest ω h at which a mode does not grow, infinite for the midpoint rule.

    Parameters
    ----------
    integrator : str
        One of `ANALYSED`; leapfrog without damping only.
    damping_ratio : float
        ζ, from 0; above 1 the mode's faster eigenvalue ω (ζ + √(ζ² - 1)) decides.

    Examples
    --------
    >>> [round(stability_limit("rk4", ratio), 3) for ratio in (0.0, 0.1, 1.0, 3.0)]
    [2.828, 2.951, 2.785, 0.478]
    """
    kind, ratio = choice("integrator", integrator, ANALYSED), _damping_ratio(damping_ratio)
    if kind == "midpoint":
        return math.inf
    if ratio == 0.0:
        return INTEGRATORS[kind]
    eigenvalues = _eigenvalues(ratio)
    fast = float(abs(eigenvalues[0]))
    return (
        _first_crossing(
            lambda s: abs(amplification(kind, eigenvalues[:, None] * s / fast)).max(axis=0) - 1, 0.1, 4.0
        )
        / fast
    )


@cache
def accuracy_limit(
    integrator: str,
    damping_ratio: float = 0.0,
    *,
    frequency: float = 1e-3,
    amplitude: float = 1e-2,
    periods: float = 100.0,
) -> float:
    """Return the largest ω h at which a mode keeps its frequency and its amplitude.

    Parameters
    ----------
    integrator : str
        One of `ANALYSED`; leapfrog without damping only.
    damping_ratio : float
        ζ, below 1.
    frequency : float
        Largest relative error of the frequency.
    amplitude : float
        Largest error of the amplitude at any time, as a fraction of the first one.
    periods : float
        Time over which the amplitude is to be kept, in periods of the mode.

    Examples
    --------
    The amplitude binds Runge-Kutta, which loses (ω h)⁶/144 a step; the frequency binds the others.

    >>> [round(accuracy_limit(name), 4) for name in ANALYSED]
    [0.2975, 0.1096, 0.1547]
    """
    kind, ratio = choice("integrator", integrator, ANALYSED), _damping_ratio(damping_ratio)
    if ratio >= 1.0:
        raise ValueError(f"damping_ratio must be below 1 for a mode to have a frequency, got {ratio}")
    eigenvalue = _eigenvalues(ratio)[1]
    allowed = positive_real("frequency", frequency), positive_real("amplitude", amplitude)
    span = 2 * math.pi * positive_real("periods", periods)

    def excess(s: Array) -> Array:
        z = eigenvalue * s
        found = amplification(kind, z)
        turn = abs(np.angle(found) / z.imag - 1)
        loss = _amplitude_error(-z.real, -np.log(abs(found)), span / z.imag)
        return np.asarray(np.maximum(turn / allowed[0], loss / allowed[1]) - 1)

    return min(_first_crossing(excess, 1e-3, 2.0), stability_limit(kind, ratio))


def _amplitude_error(exact: Array, found: Array, steps: Array) -> Array:
    """Return the largest difference of e^{-exact k} and e^{-found k} over k from 0 to `steps`."""
    difference = found - exact
    with np.errstate(divide="ignore", invalid="ignore"):
        # It is largest where both curves have the same slope, if that comes soon enough.
        widest = np.log1p(difference / exact) / difference
    last = np.where(np.isfinite(widest) & (widest > 0), np.minimum(widest, steps), steps)
    return np.asarray(abs(np.exp(-found * last) - np.exp(-exact * last)))


def _damping_ratio(value: float) -> float:
    ratio = real("damping_ratio", value)
    if not 0.0 <= ratio < math.inf:
        raise ValueError(f"damping_ratio must be finite and not negative, got {ratio}")
    return ratio


def step_constants(
    chain: Chain, modes: int, integrator: str = "rk4", *, damping_ratio: float = 0.0
) -> tuple[float, Array]:
    """Return C of the longest stable step, and of the longest accurate ones for 1 to `modes` modes.

        h = C L² √(ρA/EI)

    Accurate is: frequency within 0.1 %, amplitude within 1 % of the first one, over 100 periods of each mode.
    A step to use is the smaller of both.

    Parameters
    ----------
    chain : Chain
    modes : int
        How many, from the first; NaN for those that the chain does not have.
    integrator : str
        One of `ANALYSED`.
    damping_ratio : float
        Of the first mode, by dampers in proportion to the springs: ratios of other modes go with ω.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> stable, accurate = step_constants(Chain(Beam.unit(), "clamped-free", segments=4), 3)
    >>> round(stable, 4), accurate.round(4)
    (0.0305, array([0.0853, 0.0146, 0.0056]))
    """
    count = whole_number("modes", modes)
    solved = solve_modes(linearize(chain)).angular_frequency
    if chain.beam is None:
        raise ValueError("chain must be cut from a beam, in whose units C is")
    omega = np.asarray(solved, dtype=np.float64) / chain.beam.frequency_unit
    ratios = (_damping_ratio(damping_ratio) * omega / omega[0]).tolist()
    stable = min(stability_limit(integrator, r) / w for r, w in zip(ratios, omega.tolist(), strict=True))
    each = [accuracy_limit(integrator, r) / w for r, w in zip(ratios[:count], omega.tolist(), strict=False)]
    accurate = np.full(count, np.nan)
    accurate[: len(each)] = np.minimum.accumulate(each)
    return stable, accurate
