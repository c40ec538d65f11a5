"""Integrators: what each does to one mode in a step, and which step it takes without growth or with accuracy.

A mode of frequency ω and damping ratio ζ moves by  p'' + 2 ζ ω p' + ω² p = 0.  One step h multiplies it by
R instead of by e^z, z = ω h (-ζ ± i √(1 - ζ²)). It is stable while |R| ≤ 1 for all modes that the chain has,
and accurate while arg R and |R| stay near those of e^z for the modes that one wants to see. Which modes are
wanted does not enter the former. Two families cover all integrators here:

- Runge-Kutta methods, given by Butcher's A and b:  R(z) = 1 + z bᵀ (1 - z A)⁻¹ 1.
- A kick of the speed, then a drift:  v' = v - h (ω² p + 2 ζ ω v*),  p' = p + h v'.  It takes the spring
  explicitly, and the damper explicitly (v* = v) or implicitly (v* = v').

A new integrator is one record below, from which limits, `simulate`, studies, exports and the command line
take it. One that is no Runge-Kutta method, explicit or diagonally implicit of second order or more, moves
chains only with a run of its own in `beammodes.dynamics.runs`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Catalogue, Shown, choice, positive_real, real
from beammodes.numerics.arrays import Floats

__all__ = [
    "INTEGRATORS",
    "Integrator",
    "accuracy_limit",
    "accurate_step",
    "amplification",
    "find_integrator",
    "fixed_step_integrator",
    "stability_limit",
]

#: Relative error that `accurate_step` leaves, or this share of the damping ratio if that is more: what a
#: tenth of the half width of a resonance is.
_STEP_ERROR, _DAMPED_ERROR = 1e-3, 0.1

Complex = NDArray[np.complex128]


@dataclass(frozen=True, repr=False)
class Integrator(Shown):
    """An integrator, one of `INTEGRATORS`.

    Attributes
    ----------
    name : str
    order : int
        The error of a motion falls as step^order.
    source : str
    engines : tuple of str
        Names in engines, such as "MuJoCo implicitfast", or "PyBullet" of an engine that has no other.
    stages, weights : tuple
        Butcher's A, row by row, and b of a Runge-Kutta method; empty for a kick and a drift.
    damping : str
        "explicit" or "implicit": how a kick takes the forces of dampers (those of springs explicitly). Of a
        Runge-Kutta method both follow from its stages.
    tendon_damping : str
        Where it is not as `damping`: that of MuJoCo's tendons, by which an exported chain's far support is
        damped.
    run : str
        Kind of its run in `simulate`: "runge_kutta", "implicit", "variable", or empty. A Runge-Kutta method,
        explicit or diagonally implicit of second order or more, is run by its stages.
    springs : str
        "explicit" or "implicit".

    Examples
    --------
    >>> import beammodes as bm
    >>> find_integrator("MuJoCo RK4").name, find_integrator("Drake discrete").damping
    ('rk4', 'implicit')
    """

    name: str
    order: int
    source: str
    engines: tuple[str, ...] = ()
    stages: tuple[tuple[float, ...], ...] = ()
    weights: tuple[float, ...] = ()
    damping: str = "explicit"
    tendon_damping: str = ""
    run: str = ""
    springs: str = field(init=False, default="explicit")

    def _line(self) -> str:
        known = f"; {', '.join(self.engines)}" if self.engines else ""
        kind = f"{self.springs} springs, {self.damping} dampers"
        return f"<Integrator {self.name}: order {self.order}, {kind}{known}>"

    def __post_init__(self) -> None:
        if any(len(row) > i for i, row in enumerate(self.stages)):
            object.__setattr__(self, "springs", "implicit")
            object.__setattr__(self, "damping", "implicit")
            # Stage by stage, each with its own rate alone unknown. One of first order loses a motion's energy
            # at any step that is worth its cost, so `simulate` does not offer it.
            if self.order > 1 and all(len(row) == i + 1 and row[i] for i, row in enumerate(self.stages)):
                object.__setattr__(self, "run", "implicit")
        elif self.stages:
            object.__setattr__(self, "run", "runge_kutta")

    @property
    def variable_step(self) -> bool:
        """True if it chooses its steps itself, by its estimate of the error."""
        return self.run == "variable"

    @property
    def rational(self) -> tuple[Floats, Floats]:
        """Numerator and denominator of R(z), in ascending powers: det(1 - z A + z 1 bᵀ) and det(1 - z A)."""
        rows = np.zeros((len(self.stages), len(self.stages)))
        for i, row in enumerate(self.stages):
            rows[i, : len(row)] = row
        outer = np.outer(np.ones(len(rows)), self.weights)
        return _determinant(outer - rows), _determinant(-rows)


def _determinant(matrix: Floats) -> Floats:
    """Return det(1 + z X) in ascending powers of z, free of rounding where X is nilpotent."""
    # Faddeev and LeVerrier: of the traces of powers.
    size = len(matrix)
    found, power = [1.0], np.eye(size)
    for k in range(1, size + 1):
        power = matrix @ power
        coefficient = float(np.trace(power)) / k
        found.append(coefficient)
        power = coefficient * np.eye(size) - power
    return np.array(found)


# Of the two-stage method of second order that damps all that a step cannot resolve (R → 0).
_ALEXANDER = 1 - math.sqrt(0.5)

_RECORDS = (
    Integrator(
        name="rk4",
        order=4,
        engines=("MuJoCo RK4", "Exudyn RK44"),
        stages=((), (1 / 2,), (0.0, 1 / 2), (0.0, 0.0, 1.0)),
        weights=(1 / 6, 1 / 3, 1 / 3, 1 / 6),
        source="the classical method: C. W. Gear, Numerical Initial Value Problems (1971), p. 41; MuJoCo and "
        "Exudyn 1.13.6 measured by the tests",
    ),
    Integrator(
        name="midpoint",
        order=2,
        engines=("Exudyn TrapezoidalIndex2",),
        stages=((1 / 2,),),
        weights=(1.0,),
        source="E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration (2006), § II.1.1; the "
        "trapezoidal rule does the same to a mode: Exudyn 1.13.6, measured by the tests",
    ),
    Integrator(
        name="leapfrog",
        order=2,
        source="Hairer, Lubich and Wanner, § I.1.4; damping of the velocity half a step ago",
    ),
    Integrator(
        name="semi_implicit_euler",
        order=1,
        engines=(
            "MuJoCo Euler without eulerdamp",
            "Drake semi_explicit_euler",
            "PyBullet",
            "Newton Featherstone",
            "PhysX torques",
        ),
        source="Hairer, Lubich and Wanner, § I.1.2; damping of the velocity at the step's start; PyBullet "
        "3.2.7 and PhysX 5 (SAPIEN 3.0.3), with springs as torques that you set before each step, and Newton "
        "1.8.0 measured by the tests",
    ),
    Integrator(
        name="implicit_damping_euler",
        order=1,
        damping="implicit",
        engines=("MuJoCo implicit", "MuJoCo implicitfast", "Drake discrete", "Newton MuJoCo"),
        source="measured with MuJoCo 4.0.0, Drake 1.51.1 and Newton 1.8.0 by the tests; Newton's MuJoCo "
        "solver takes implicitfast where a file has no integrator",
    ),
    Integrator(
        name="implicit_joint_damping_euler",
        order=1,
        damping="implicit",
        tendon_damping="explicit",
        engines=("MuJoCo Euler",),
        source="measured with MuJoCo 4.0.0 by the tests",
    ),
    Integrator(
        name="implicit_euler",
        order=1,
        engines=("MuJoCo discrete", "DART", "Gazebo DART"),
        stages=((1.0,),),
        weights=(1.0,),
        source="MuJoCo 4.0.0 and DART 6.20.0 measured by the tests: DART's joints add h d + h² k to their "
        "inertia",
    ),
    Integrator(
        name="sdirk2",
        order=2,
        stages=((_ALEXANDER,), (1 - _ALEXANDER, _ALEXANDER)),
        weights=(1 - _ALEXANDER, _ALEXANDER),
        source="R. Alexander, SIAM Journal on Numerical Analysis 14 (1977), 1006-1021",
    ),
    Integrator(
        name="rk45",
        order=5,
        run="variable",
        source="J. R. Dormand and P. J. Prince (1980), as scipy.integrate.RK45",
    ),
    Integrator(
        name="dop853",
        order=8,
        run="variable",
        source="Dormand and Prince, as scipy.integrate.DOP853",
    ),
)

#: Every integrator by its name.
INTEGRATORS: Catalogue[Integrator] = Catalogue("integrators", {record.name: record for record in _RECORDS})


def find_integrator(name: str, among: Iterable[str] | None = None) -> Integrator:
    """Return an integrator by its name, or by an engine's such as "MuJoCo implicitfast".

    Upper and lower case are alike. `among` are the names that are allowed, with those that engines have for
    them: all by default.
    """
    known = dict(INTEGRATORS) if among is None else {each: INTEGRATORS[each] for each in among}
    known |= {alias: record for record in known.values() for alias in record.engines}
    if isinstance(name, str):
        named = {each.lower(): record for each, record in known.items()}
        if name.lower() in named:
            return named[name.lower()]
    # Of engines' names only those of the engine that was meant.
    first = name.strip().split(" ")[0].lower() if isinstance(name, str) else ""
    engine = first if any(" " in each and each.split(" ")[0].lower() == first for each in known) else ""
    alike = [each for each in known if (each.split(" ")[0].lower() == engine if engine else " " not in each)]
    if first and not engine:
        # "Euler" alone may be that of an engine.
        alike += [each for each in known if " " in each and first in each.lower().split(" ")[1:]]
    return known[choice("integrator", name, alike or known)]


def fixed_step_integrator(name: str) -> Integrator:
    """Return an integrator of fixed step, or raise ValueError for one that chooses its steps itself."""
    record = find_integrator(name)
    if record.variable_step:
        fixed = ", ".join(each.name for each in _RECORDS if not each.variable_step)
        raise ValueError(
            f'integrator must be of fixed step, one of {fixed}: "{record.name}" chooses its steps itself'
        )
    return record


def amplification(integrator: str, frequency: Floats | float, damping_ratio: float = 0.0) -> Complex:
    """Return R, what one step multiplies a mode by; the exact motion has e^z, Im z ≥ 0.

    `frequency` is ω h. From a damping ratio of 1 on, and where an explicit step makes two real factors of an
    oscillation, the answer is the larger factor.

    Examples
    --------
    >>> round(float(abs(amplification("rk4", 1.01 * np.sqrt(8)))), 3)
    1.073
    >>> round(float(abs(amplification("rk4", 8.0))))                     # at the report's step
    160
    """
    record, s = fixed_step_integrator(integrator), np.asarray(frequency, dtype=np.float64)
    ratio = _damping_ratio(damping_ratio)
    if record.stages:
        top, bottom = record.rational
        root = np.sqrt(complex(ratio**2 - 1))
        both = [
            np.polyval(top[::-1], z) / np.polyval(bottom[::-1], z)
            for z in (s * (-ratio + root), s * (-ratio - root))
        ]
        return np.asarray(both[0] if ratio < 1 else np.where(abs(both[0]) >= abs(both[1]), *both))
    # Of (1 + d_i) R² + (s² - 2 - d_i + d_e) R + (1 - d_e) = 0, d = 2 ζ ω h, explicit or implicit.
    implicit, explicit = (2 * ratio * s * (record.damping == kind) for kind in ("implicit", "explicit"))
    half = (2 + implicit - explicit - s**2) / (2 * (1 + implicit))
    inner = half**2 - (1 - explicit) / (1 + implicit)
    turning = half + 1j * np.sqrt(np.maximum(0.0, -inner))
    apart = half + np.where(half < 0, -1, 1) * np.sqrt(np.maximum(0.0, inner))
    return np.asarray(np.where(inner < 0, turning, apart))


def _first_crossing(excess: Callable[[Floats], Floats], low: float, high: float) -> float:
    """Return the first place where `excess` becomes positive, or infinity."""
    grid = np.geomspace(low, high, 4001)
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
def _growth_polynomial(integrator: str, ratio: float) -> Floats:
    """Return  (|R(r e^{iφ})|² - 1)/r,  cos φ = -ζ, of an explicit Runge-Kutta method, in powers of r.

    Free of the rounding of |R|² beside 1: cosines of multiples of the angle by recurrence.
    """
    top, _ = INTEGRATORS[integrator].rational
    size = len(top)
    cosine = [1.0, -ratio]
    for _ in range(2, size):
        cosine.append(-2.0 * ratio * cosine[-1] - cosine[-2])
    found = [
        sum(
            top[j] * top[m - j] * cosine[abs(m - 2 * j)]
            for j in range(max(0, m - size + 1), min(m, size - 1) + 1)
        )
        for m in range(1, 2 * size - 1)
    ]
    # What cancels by the method's order leaves rounding.
    return np.array([0.0 if abs(value) < 1e-15 else value for value in found])


@cache
def stability_limit(integrator: str, damping_ratio: float = 0.0) -> float:
    """Return the largest ω h at which a mode does not grow; infinite where springs are taken implicitly.

        Runge-Kutta           |R(z)| = 1
        kick and drift        ω h = 2 (√(1 + ζ²) - ζ)  explicit damping,  2 (√(1 + ζ²) + ζ)  implicit

    Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, § IV.2; the second line is
    where the step's matrix has the eigenvalue -1.

    Examples
    --------
    >>> [round(stability_limit("rk4", ratio), 3) for ratio in (0.0, 0.1, 1.0, 3.0)]
    [2.828, 2.951, 2.785, 0.478]
    >>> [round(stability_limit("MuJoCo implicit", ratio), 3) for ratio in (0.0, 0.1, 1.0, 3.0)]
    [2.0, 2.21, 4.828, 12.325]
    """
    record, ratio = fixed_step_integrator(integrator), _damping_ratio(damping_ratio)
    if record.springs == "implicit":
        return math.inf
    if not record.stages:
        reach = 2 * (math.hypot(1.0, ratio) + ratio)
        return reach if record.damping == "implicit" else 4 / reach
    if ratio > 1.0:
        # The faster one of two real eigenvalues decides.
        return stability_limit(record.name, 1.0) / (ratio + math.sqrt(ratio**2 - 1))
    growth = np.polynomial.Polynomial(np.trim_zeros(_growth_polynomial(record.name, ratio), "f"))
    if growth.coef[0] > 0:
        return 0.0
    roots = np.asarray(growth.roots(), dtype=np.complex128)
    slope, first = growth.deriv(), float(roots.real[(roots.real > 0) & (abs(roots.imag) < 1e-9)].min())
    for _ in range(2):
        first -= float(growth(first) / slope(first))
    return first


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

    `frequency` bounds the relative error of the frequency; `amplitude` that of the amplitude at any time
    within so many `periods` of the mode, as a fraction of the first one. The damping ratio is below 1.

    Examples
    --------
    The amplitude binds Runge-Kutta, which loses (ω h)⁶/144 a step; the frequency binds the others.

    >>> [round(accuracy_limit(name), 4) for name in ("rk4", "midpoint", "leapfrog")]
    [0.2975, 0.1096, 0.1547]
    """
    kind, ratio = fixed_step_integrator(integrator).name, _damping_ratio(damping_ratio)
    if ratio >= 1.0:
        raise ValueError(f"damping_ratio must be below 1 for a mode to have a frequency, got {ratio}")
    allowed = positive_real("frequency", frequency), positive_real("amplitude", amplitude)
    span, turned = 2 * math.pi * positive_real("periods", periods), math.sqrt(1 - ratio**2)

    def excess(s: Floats) -> Floats:
        found = amplification(kind, s, ratio)
        turn = abs(np.angle(found) / (turned * s) - 1)
        loss = _amplitude_error(ratio * s, -np.log(abs(found)), span / (turned * s))
        return np.asarray(np.maximum(turn / allowed[0], loss / allowed[1]) - 1)

    return min(_first_crossing(excess, 1e-6, 2.0), stability_limit(kind, ratio))


def accurate_step(engine: str, omega: float, ratio: float) -> float:
    """Return the step that keeps a mode: its frequency within 0.1 %, its amplitude within 1 % in 100 periods.

    Both within a tenth of its damping ratio where that is more.

    Examples
    --------
    >>> round(accurate_step("MuJoCo RK4", 2.0, 0.0), 4)
    0.1487
    """
    if ratio >= 1.0:
        return math.inf
    share = _DAMPED_ERROR * ratio
    frequency, amplitude = max(_STEP_ERROR, share), max(10 * _STEP_ERROR, share)
    return accuracy_limit(engine, ratio, frequency=frequency, amplitude=amplitude) / omega


def _amplitude_error(exact: Floats, found: Floats, steps: Floats) -> Floats:
    """Return the largest difference of e^{-exact k} and e^{-found k} over k from 0 to `steps`."""
    difference = found - exact
    with np.errstate(divide="ignore", invalid="ignore"):
        # It is largest where both curves have the same slope, if that comes soon enough.
        widest = np.log1p(difference / exact) / difference
    last = np.where(np.isfinite(widest) & (widest > 0), np.minimum(widest, steps), steps)
    with np.errstate(over="ignore"):
        return np.asarray(abs(np.exp(-found * last) - np.exp(-exact * last)))


def _damping_ratio(value: float) -> float:
    ratio = real("damping_ratio", value)
    if not 0.0 <= ratio < math.inf:
        raise ValueError(f"damping_ratio must be finite and not negative, got {ratio}")
    return ratio
