"""One step of an explicit Runge-Kutta method, compiled, from the stages that its record gives.

A state is (q, q'). `Stepper.steps` maps it over many steps at once, so that a run spends its time in compiled
code. Chains whose right end is held are projected back onto their closure after each Runge-Kutta step, with
the least change of q and of q'; the midpoint rule meets it by a multiplier.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.chain_state import ChainState
from beammodes.dynamics.forward_dynamics import forward_dynamics
from beammodes.equations.coordinates import coordinate_names
from beammodes.interrupts import pause
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS

__all__ = ["Stepper", "closure", "projection", "runge_kutta"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stepper:
    """One step as a CasADi function of (state, step, base), base at `stages` times within the step.

    Attributes
    ----------
    function : casadi.Function
        New state from state, step and the base's nine numbers at each of the times, in one column.
    times : tuple of float
        Those times, as fractions of the step.
    """

    function: casadi.Function
    times: tuple[float, ...]

    def steps(self, state: Array, step: float, start: float, count: int, base: BaseMotion) -> Array:
        """Return the states after each of `count` steps from time `start`, shape (count, size)."""
        at = start + step * (np.arange(count)[None, :] + np.array(self.times)[:, None])
        course = base.at(at)  # (3, 3, stages, count)
        columns = np.moveaxis(course, 2, 0).reshape(-1, count)
        mapped = _repeated(self.function, count)
        return np.asarray(mapped(state, np.full((1, count), step), columns).full().T)


# Runs are cut into chunks of equal length, so the last few functions are asked for again and again.
@lru_cache(maxsize=4)
def _repeated(function: casadi.Function, count: int) -> casadi.Function:
    return function.mapaccum(count)


def runge_kutta(
    chain: Chain,
    *,
    load: Load | None = None,
    damping: Damping | None = None,
    base: BaseMotion | None = None,
    integrator: str = "rk4",
) -> Stepper:
    """Return one step of an explicit Runge-Kutta method, of states (q, q').

        k_i = f(t + c_i h, x + h Σ_j a_ij k_j),   x + h Σ_i b_i k_i

    Parameters
    ----------
    chain, load, damping, base
        As `forward_dynamics` takes them.
    integrator : str
        One of `INTEGRATORS` with stages.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> stepper = runge_kutta(Chain(Beam.unit(), "clamped-free", segments=1))        # q'' = -9 q
    >>> stepper.steps(np.array([1.0, 0.0]), 0.01, 0.0, 2, BaseMotion())[:, 0].round(4)
    array([0.9996, 0.9982])
    """
    method = INTEGRATORS[integrator]
    dynamics = forward_dynamics(chain, load=load, damping=damping, base=base)
    pause()
    size = len(dynamics.coordinates)
    # The last time is that of the new state's closure.
    nodes = [sum(row) for row in method.stages]
    times = tuple(sorted({*nodes, 1.0}))
    state, step, course = (
        casadi.SX.sym(n, k) for n, k in (("x", 2 * size), ("h", 1), ("base", 9 * len(times)))
    )
    at = dict(zip(times, casadi.vertsplit(course, 9), strict=True))
    rates: list[Any] = []
    for node, row in zip(nodes, method.stages, strict=True):
        x = state
        for weight, rate in zip(row, rates, strict=False):
            x = x + (step * weight) * rate if weight else x
        rates.append(casadi.vertcat(x[size:], dynamics.acceleration(x[:size], x[size:], at[node])))
    # In multiples of the least weight, as the method is written in books: h/6 (k_1 + 2 k_2 + 2 k_3 + k_4).
    least = min(weight for weight in method.weights if weight)
    terms = [weight / least * rate for weight, rate in zip(method.weights, rates, strict=True) if weight]
    new = state + step / (1 / least) * sum(terms[1:], terms[0])
    if chain.boundary.right.holds_deflection:
        new = projection(chain)(new, at[1.0])
    return Stepper(casadi.Function("runge_kutta", [state, step, course], [new]), times)


def closure(chain: Chain, q: Any, base: Any) -> Any:
    """Return the right tip's deflection relative to the base, which a held end keeps at zero."""
    parts = casadi.vertsplit(q)
    state = ChainState.of(chain, parts, parts, casadi.vertsplit(base))
    return (
        state.place[1]
        - base[3]
        + casadi.dot(casadi.DM(chain.length.tolist()), casadi.sin(casadi.vertcat(*state.angle)))
    )


def projection(chain: Chain) -> casadi.Function:
    """Return the function (state, base) -> nearest state with the right tip's deflection the base's.

    Two Newton steps: a Runge-Kutta step leaves the closure by little.
    """
    size = len(coordinate_names(chain))
    q, u, base = (casadi.SX.sym(n, k) for n, k in (("q", size), ("u", size), ("base", 9)))
    gap = closure(chain, q, base)
    slope = casadi.jacobian(gap, q)
    # Bases under a held right end only shift, so the tip's velocity is the base's where the left tip's is.
    rate = slope @ u - (0 if chain.boundary.left.holds_deflection else base[4])
    onto = casadi.Function("onto", [q, base], [q - slope.T * gap / casadi.sumsqr(slope)])
    along = casadi.Function("along", [q, u, base], [u - slope.T * rate / casadi.sumsqr(slope)])
    state = casadi.SX.sym("x", 2 * size)
    placed = onto(onto(state[:size], base), base)
    moved = along(placed, state[size:], base)
    return casadi.Function("projection", [state, base], [casadi.vertcat(placed, moved)])
