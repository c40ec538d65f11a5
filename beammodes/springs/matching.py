"""Springs that meet given conditions exactly: an inverse eigenvalue problem, solved by its own derivatives.

Newton's method, in the unknowns and with the derivatives of `spring_conditions`, finds springs that meet the
conditions; steps along them, Newton's again, lead to those that are closest to the springs wanted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from beammodes.springs.spring_conditions import Conditions

__all__ = ["Solution", "closest"]

Array = NDArray[np.float64]

#: Springs are looked for within a factor e^9, about ten thousand, of EI/ell: beyond, decompositions fail.
_REACH = 9.0


@dataclass(frozen=True, eq=False)
class Solution:
    """Springs as z, whether they meet the conditions, and their squared distance from those wanted."""

    z: Array
    met: bool
    distance: float


def closest(conditions: Conditions, wanted: Array, starts: list[Array]) -> Solution:
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
    >>> unit = flexibility_form(Chain(Beam.unit(), "clamped-free", 1, "naive"))
    >>> one = Conditions(unit, np.eye(1), (0,), np.log([6.0]))               # ω² = 6 = 3 k
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


def _random_starts(wanted: Array) -> Iterator[Array]:
    random = np.random.default_rng(0)
    while True:
        yield wanted + random.standard_normal(len(wanted))


def _local(conditions: Conditions, wanted: Array, start: Array) -> Solution:
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


def _tangent_step(conditions: Conditions, wanted: Array, z: Array) -> Array:
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


def _restored(conditions: Conditions, start: Array) -> tuple[Array, bool]:
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


def _least_squares(conditions: Conditions, wanted: Array, starts: Iterable[Array]) -> Solution:
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
