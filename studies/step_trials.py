"""Measurements on the nonlinear chain at a given step: growth, modes, cost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import choice, whole_number
from beammodes.dynamics.base_motion import BaseMotion, base_vector
from beammodes.dynamics.implicit import ImplicitStepper
from beammodes.dynamics.runs import (
    Rate,
    Run,
    Stepper,
    projection,
    runge_kutta,
)
from beammodes.dynamics.simulation import mode_start
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["VariableCost", "equal_start", "largest_angles", "modal_motion", "variable_step_cost"]


Complex = NDArray[np.complex128]

_STILL = BaseMotion()


def equal_start(chain: Chain, amplitude: float) -> Floats:
    """Return a state at rest with the same amount of every mode, its largest angle being `amplitude` [rad].

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> (1e6 * equal_start(Chain(Beam.unit(), "clamped-free", segments=2), 1e-6)).round(3)
    array([0.033, 1.   , 0.   , 0.   ])
    """
    count = linearize(chain).elastic_modes
    q = np.sum([mode_start(chain, mode, 1.0)[0] for mode in range(1, count + 1)], axis=0)
    return np.concatenate([amplitude / np.abs(q).max() * q, np.zeros(len(q))])


def largest_angles(stepper: Stepper, state: Floats, step: float, count: int) -> Floats:
    """Return the largest angle after each step [rad]; infinite from where the state is not finite.

    For a chain whose left end is held, whose coordinates are angles.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> stepper = runge_kutta(Chain(Beam.unit(), "clamped-free", segments=1))          # ω = 3
    >>> largest_angles(stepper, np.array([1e-6, 0.0]), 8 / 3, 2).round(6)
    array([0.00014 , 0.013526])
    """
    states = stepper.steps(state, step, 0.0, count, _STILL)
    finite = np.logical_and.accumulate(np.isfinite(states).all(axis=1))
    largest = np.abs(np.where(finite[:, None], states, np.inf)[:, : len(state) // 2]).max(axis=1)
    return np.asarray(largest)


def modal_motion(
    chain: Chain, mode: int, step: float, count: int, *, integrator: str = "rk4", amplitude: float = 1e-6
) -> Complex:
    """Return a mode's share of the simulated motion, position - i velocity/ω, relative to its start.

    The nonlinear chain starts at rest in the mode, so small that it stays there; the exact linear motion is
    e^{iωt}.

    Parameters
    ----------
    chain : Chain
        Its left end held.
    mode : int
        1-based.
    step : float [s]
    count : int
        Steps.
    integrator : str
        "rk4" or "midpoint".
    amplitude : float [rad]
        Largest angle at the start.

    Returns
    -------
    array of complex, shape (count + 1,)

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=1)                       # ω = 3
    >>> modal_motion(chain, 1, 0.1, 1).round(3)
    array([1.   +0.j   , 0.955+0.296j])
    """
    q, _ = mode_start(chain, mode, amplitude)
    size, frequency = len(q), float(solve_modes(linearize(chain), mode).angular_frequency[-1])
    weight = q
    stepper: Stepper | ImplicitStepper
    if choice("integrator", integrator, ("rk4", "midpoint")) == "rk4":
        stepper = runge_kutta(chain)
    else:
        stepper = ImplicitStepper(chain)
        # The midpoint rule's second half of a state is momentum: M q' for small motions.
        weight = stepper.momenta(np.zeros(size), q, base_vector(_STILL, 0.0))
    start = np.concatenate([q, np.zeros(size)])
    states = np.vstack([start, stepper.steps(start, step, 0.0, count, _STILL)])
    position, speed = states[:, :size] @ q / (q @ q), states[:, size:] @ q / (weight @ q)
    return np.asarray(position - 1j * speed / frequency)


@dataclass(frozen=True)
class VariableCost:
    """The work of a variable-step integrator for some output steps.

    Attributes
    ----------
    steps, evaluations : float
        Accepted steps, and evaluations of the accelerations, for one output step.
    mean_step : float [s]
        Output step / steps.
    largest_angle : float [rad]
        At the output times.
    """

    steps: float
    evaluations: float
    mean_step: float
    largest_angle: float


def variable_step_cost(
    chain: Chain,
    output_step: float,
    outputs: int,
    *,
    tolerance: float = 1e-6,
    amplitude: float = 0.1,
    integrator: str = "rk45",
) -> VariableCost:
    """Return what the report's recipe costs: a variable step, at most its step, which is that of output.

    Parameters
    ----------
    chain : Chain
        Its left end held; it starts at rest in its first mode.
    output_step : float [s]
    outputs : int
    tolerance : float
        Relative; absolute is a thousandth of it.
    amplitude : float [rad]
        Largest angle at the start.
    integrator : str
        A Runge-Kutta pair of `scipy.integrate`.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> cost = variable_step_cost(Chain(Beam.unit(), "clamped-free", segments=4), 0.357, 2, tolerance=1e-3)
    >>> 10 < cost.steps < 40
    True
    """
    import scipy.integrate

    span = output_step * outputs
    run = Run(
        chain, Load(), TimeInputs(_STILL), Damping(), span, output_step, 1, outputs, tolerance, integrator
    )
    q, u = mode_start(chain, 1, amplitude)
    size, state, still = len(q), np.concatenate([q, u]), base_vector(_STILL, 0.0)
    rate, onto = Rate(run, size), projection(chain) if chain.boundary.right.holds_deflection else None

    steps = evaluations = 0
    largest, first = 0.0, None
    for _ in range(whole_number("outputs", outputs)):
        solver = getattr(scipy.integrate, integrator.upper())(
            rate,
            0.0,
            state,
            output_step,
            max_step=output_step,
            rtol=tolerance,
            atol=tolerance / 1000,
            first_step=first,
        )
        while solver.status == "running":
            solver.step()
            steps += 1
        evaluations += solver.nfev
        state, first = solver.y, min(solver.h_abs, output_step)
        if onto is not None:
            state = np.array(onto(state, still))[:, 0]
        largest = max(largest, float(np.abs(state[:size]).max()))
    return VariableCost(steps / outputs, evaluations / outputs, output_step * outputs / steps, largest)
