"""Springs that meet given conditions exactly: an inverse eigenvalue problem, solved by its own derivatives.

Newton's method, in the unknowns and with the derivatives below, finds springs that meet the
conditions; steps along them, Newton's again, lead to those that are closest to the springs wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.vibration.spectrum import FlexibilityForm

__all__ = [
    "MAX_MATCHED",
    "Conditions",
    "ExactModes",
    "Solution",
    "State",
    "closest",
    "spring_state",
    "symmetric_basis",
]


# Conditions on a chain's springs, and the derivatives of what they do to frequencies and statics.
#
# The unknowns are x_j = ln(k_j ell/EI), so every answer is a positive spring. With u_n the unit vector in
# which
# mode n stores its energy (its square at joint j is that joint's share), the frequencies' derivatives are
#
#     ∂ ln ω_n² / ∂x_j       = u_nj²
#     ∂² ln ω_n² / ∂x_i ∂x_j = δ_ij u_nj² - u_ni² u_nj² + 2 Σ_{m≠n} ω_m²/(ω_n² - ω_m²) u_ni u_mi u_nj u_mj
#
# and, with p the tip's deflection written in those vectors, w = p/|p| and P = Σ u_m u_mᵀ, the compliance's
#
#     ∂ ln |p|² / ∂x_j       = -w_j²
#     ∂² ln |p|² / ∂x_i ∂x_j = 2 w_i w_j P_ij - δ_ij w_j² - w_i² w_j²
#
# Source: first and second-order perturbation of K u = ω² M u, derived here; the sums run over elastic modes,
# because a rigid-body mode stores nothing.


#: Longer chains are not matched: every step of the search decomposes a dense matrix, and at 200 segments
#: rule gregory already has the first three modes of bending within 1e-8.
MAX_MATCHED = 200


@dataclass(frozen=True, repr=False)
class ExactModes(Shown):
    """What rules of springs that are sought here have in common.

    Parameters
    ----------
    modes : int
        How many frequencies, from the first.
    """

    modes: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "modes", whole_number("modes", self.modes, most=MAX_MATCHED))

    @property
    def name(self) -> str:
        """Name in tables, such as "matched(3)"."""
        return f"matched({self.modes})"

    @property
    def exact_modes(self) -> int:
        """Number of frequencies, from the first, that are the beam's at every N that has them."""
        return self.modes


@dataclass(frozen=True, eq=False)
class State:
    """Response of a chain with given springs, in its own units.

    Attributes
    ----------
    log_square : ndarray, shape (modes,)
        ln ω², ascending.
    energy : ndarray, shape (modes, hinges)
        Unit rows; squared, each joint's share of a mode's strain energy.
    tip : ndarray, shape (hinges,)
        Its square is each joint's part in the deflection of the right tip under a unit force there;
        meaningless where a rigid-body mode lets the tip go.
    """

    log_square: Floats
    energy: Floats
    tip: Floats


def spring_state(unit: FlexibilityForm, log_stiffness: Floats) -> State:
    """Return the state of the chain that has the springs e^x where `unit` has springs 1.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.vibration.spectrum import flexibility_form
    >>> unit = flexibility_form(Chain(Beam.unit(), "clamped-free", 1, "naive"))
    >>> spring_state(unit, np.zeros(1)).log_square.round(9) == np.log(3).round(9)      # k / (m ell²/3)
    array([ True])
    """
    root = np.exp(-log_stiffness / 2)
    hinges, excluded = unit.forbidden.shape
    basis = np.linalg.qr(root[:, None] * unit.forbidden, mode="complete")[0] if excluded else np.eye(hinges)
    form = replace(unit, flexibility_root=root, forbidden=basis[:, :excluded])
    allowed = basis[:, excluded:]
    _, inverse, turn = np.linalg.svd(form.kinetic(allowed), full_matrices=False)
    energy = turn @ allowed.T
    reach = form.motion(energy.T)[0][-1]
    return State(-2 * np.log(inverse), energy, reach @ energy)


def symmetric_basis(hinges: int, symmetric: bool) -> Floats:
    """Return orthonormal columns that span all springs, or those that a mirror leaves alone.

    Examples
    --------
    >>> symmetric_basis(3, True).round(3)
    array([[0.707, 0.   ],
           [0.   , 1.   ],
           [0.707, 0.   ]])
    """
    if not symmetric:
        return np.eye(hinges)
    columns = np.eye(hinges)[:, : (hinges + 1) // 2]
    columns = columns + columns[::-1]
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


@dataclass(frozen=True, eq=False)
class Conditions:
    """Equations on the springs' logarithms  x = basis z.

    Attributes
    ----------
    state : callable
        The chain's state with springs e^x, in its own units: of bending `spring_state` of a unit form.
    basis : ndarray, shape (hinges, unknowns)
        Orthonormal, so that distances between springs are those between their z.
    modes : tuple of int
        Indices of the modes whose frequencies are prescribed.
    log_square : ndarray, shape (len(modes),)
        What ln ω² shall be.
    log_compliance : float, optional
        What the logarithm of the tip's deflection under a unit force shall be.
    ceiling : float
        What ln ω² of the highest mode shall not exceed.
    """

    state: Callable[[Floats], State]
    basis: Floats
    modes: tuple[int, ...]
    log_square: Floats
    log_compliance: float | None = None
    ceiling: float = np.inf

    def at(self, z: Floats) -> tuple[State, Floats, Floats]:
        """Return the state, the residuals, all logarithms, and their derivatives by z."""
        state = self.state(self.basis @ z)
        rows = list(self.modes)
        residual, slope = state.log_square[rows] - self.log_square, state.energy[rows] ** 2
        if self.log_compliance is not None:
            compliance = state.tip @ state.tip
            residual = np.append(residual, np.log(compliance) - self.log_compliance)
            slope = np.vstack([slope, -(state.tip**2) / compliance])
        return state, residual, slope @ self.basis

    def curvature(self, state: State, weights: NDArray[np.floating[Any]]) -> Floats:
        """Return the weighted sum of the residuals' second derivatives by z, at least one weight per mode."""
        total = np.zeros((len(self.basis),) * 2)
        for mode, weight in zip(self.modes, weights, strict=False):
            total += weight * _mode_curvature(state, mode)
        if self.log_compliance is not None:
            total += weights[-1] * _tip_curvature(state)
        return np.asarray(self.basis.T @ total @ self.basis)

    def met(self, state: State, residual: Floats) -> bool:
        """Say whether the ceiling and, to 1e-12 or what rounding leaves of ω_n/ω_1, all equations hold."""
        allowed = np.full(len(residual), 1e-12)
        spread = np.exp((state.log_square[list(self.modes)] - state.log_square[0]) / 2)
        allowed[: len(spread)] = np.maximum(1e-12, 4 * np.finfo(float).eps * spread)
        return bool((np.abs(residual) <= allowed).all() and state.log_square[-1] <= self.ceiling + 1e-12)


def _mode_curvature(state: State, mode: int) -> Floats:
    others = np.arange(len(state.energy)) != mode
    products = state.energy[others] * state.energy[mode]
    ratio = 2 / np.expm1(state.log_square[mode] - state.log_square[others])
    share = state.energy[mode] ** 2
    return np.asarray(np.diag(share) - np.outer(share, share) + (products.T * ratio) @ products)


def _tip_curvature(state: State) -> Floats:
    unit = state.tip / np.linalg.norm(state.tip)
    share, projector = unit**2, state.energy.T @ state.energy
    return np.asarray(2 * np.outer(unit, unit) * projector - np.diag(share) - np.outer(share, share))


#: Springs are looked for within a factor e^9, about ten thousand, of EI/ell: beyond, decompositions fail.
_REACH = 9.0


@dataclass(frozen=True, eq=False)
class Solution:
    """Springs as z, whether they meet the conditions, and their squared distance from those wanted."""

    z: Floats
    met: bool
    distance: float


def closest(conditions: Conditions, wanted: Floats, starts: list[Floats]) -> Solution:
    """Return the springs that meet the conditions, the closest to those wanted that the searches find.

        minimize |z - wanted|²   subject to   residual(z) = 0

    A local search runs from each start. With at most two springs a condition, solutions lie in several
    valleys, so 40 seeded random starts follow. Where none succeeds, up to 20 least-squares searches follow,
    which get over folds that stop Newton's method; the answer is then the first of them to succeed, else
    the one of least residuals, its `met` False.

    Parameters
    ----------
    conditions : Conditions
    wanted : ndarray, shape (unknowns,)
    starts : list of ndarray, shape (unknowns,)

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.vibration.spectrum import flexibility_form
    >>> from functools import partial
    >>> unit = flexibility_form(Chain(Beam.unit(), "clamped-free", 1, "naive"))
    >>> one = Conditions(partial(spring_state, unit), np.eye(1), (0,), np.log([6.0]))          # ω² = 6 = 3 k
    >>> np.exp(closest(one, np.zeros(1), [np.zeros(1)]).z).round(12)
    array([2.])
    """
    ratio = len(wanted) / len(conditions.at(wanted)[1])
    random = _random_starts(wanted)
    starts = [*starts, *islice(random, 40 if 1 <= ratio <= 2 else 0)]
    found = [solution for start in starts if (solution := _local(conditions, wanted, start)).met]
    if not found:
        return _least_squares(conditions, wanted, islice(random, 20 if ratio >= 1 else 4))
    return min(found, key=lambda solution: solution.distance)


def _random_starts(wanted: Floats) -> Iterator[Floats]:
    random = np.random.default_rng(0)
    while True:
        yield wanted + random.standard_normal(len(wanted))


def _local(conditions: Conditions, wanted: Floats, start: Floats) -> Solution:
    """Return the foot of the perpendicular from `wanted` on the solutions, as Newton's method reaches it."""
    z, met = _restored(conditions, start)
    for _ in range(50 if met and len(z) > len(conditions.at(z)[1]) else 0):
        step = _tangent_step(conditions, wanted, z)
        if np.linalg.norm(step) < 1e-11:
            break
        distance = np.linalg.norm(z - wanted)
        for part in 0.5 ** np.arange(12):
            trial, good = _restored(conditions, z + part * step)
            if good and np.linalg.norm(trial - wanted) <= distance * (1 + 1e-14):
                z = trial
                break
        else:
            break
    return Solution(z, met, float(np.sum((z - wanted) ** 2)))


def _tangent_step(conditions: Conditions, wanted: Floats, z: Floats) -> Floats:
    """Return the step along the solutions, Newton's where the distance curves upwards, else the steepest."""
    state, residual, slope = conditions.at(z)
    tangent = np.linalg.qr(slope.T, mode="complete")[0][:, len(residual) :]
    downhill = tangent.T @ (wanted - z)
    multiplier = np.linalg.lstsq(slope.T, wanted - z, rcond=None)[0]
    bend = np.eye(len(z)) + conditions.curvature(state, multiplier)
    values, vectors = np.linalg.eigh(tangent.T @ bend @ tangent)
    if values[0] > 1e-3:
        downhill = vectors @ (vectors.T @ downhill / values)
    return np.asarray(tangent @ downhill / max(1.0, float(np.linalg.norm(downhill))))


def _restored(conditions: Conditions, start: Floats) -> tuple[Floats, bool]:
    """Return the solution that damped Newton steps of least length reach, and whether it is one."""
    z = start
    state, residual, slope = conditions.at(z)
    for _ in range(60):
        size = np.linalg.norm(residual)
        step = np.linalg.lstsq(slope, -residual, rcond=1e-12)[0]
        step /= max(1.0, float(np.linalg.norm(step)))
        for part in 0.5 ** np.arange(1 if size < 1e-10 else 12):
            trial = np.clip(z + part * step, -_REACH, _REACH)
            new = conditions.at(trial)
            if np.linalg.norm(new[1]) < size * (1 - 0.1 * part):
                break
        else:
            break
        z, (state, residual, slope) = trial, new
    return z, conditions.met(state, residual)


def _least_squares(conditions: Conditions, wanted: Floats, starts: Iterable[Floats]) -> Solution:
    """Return the first solution that least-squares searches lead to, else the springs of least residuals."""
    from scipy.optimize import least_squares

    best, least = wanted, np.inf
    for start in (wanted, *starts):
        fit = least_squares(
            lambda z: conditions.at(z)[1], start, lambda z: conditions.at(z)[2], bounds=(-_REACH, _REACH)
        )
        solution = _local(conditions, wanted, fit.x)
        if solution.met:
            return solution
        if fit.cost < least:
            best, least = fit.x, fit.cost
    return Solution(best, False, float(np.sum((best - wanted) ** 2)))
