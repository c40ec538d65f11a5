"""Runs of the integrators: in chunks, so that they can be watched, interrupted, and stopped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.damping import Damping
from beammodes.dynamics.forward_dynamics import base_vector, forward_dynamics
from beammodes.dynamics.integrators import Stepper, projection, runge_kutta
from beammodes.dynamics.midpoint import implicit_midpoint, momentum_map
from beammodes.problem.loading import Load

__all__ = ["RUNS", "Run", "Runner"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None] | None

#: Times, coordinates, speeds, and why the run stopped early, or nothing.
Found = tuple[Array, Array, Array, str]
Runner = Callable[["Run", tuple[Array, Array], Progress], Found]

# Steps that one call of compiled code takes at most: short enough to be interrupted.
_CHUNK = 2000


@dataclass(frozen=True)
class Run:
    """What a run integrates, and how.

    Attributes
    ----------
    step, every, steps
        Step [s], steps between outputs, steps in all.
    tolerance : float
        Relative, of variable-step methods.
    """

    chain: Chain
    load: Load
    base: BaseMotion
    damping: Damping
    step: float
    every: int
    steps: int
    tolerance: float

    @property
    def parts(self) -> dict[str, object]:
        """The arguments of the compiled functions."""
        return {"load": self.load, "damping": self.damping, "base": self.base}


def _runge_kutta_run(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
    stepper = runge_kutta(run.chain, load=run.load, damping=run.damping, base=run.base)
    time, states, why = _fixed(run, stepper, np.concatenate(start), progress)
    size = len(start[0])
    return time, states[:, :size], states[:, size:], why


def _midpoint_run(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
    stepper = implicit_midpoint(run.chain, load=run.load, damping=run.damping, base=run.base)
    momentum, speed = momentum_map(run.chain, load=run.load)
    q, u = start
    p = np.array(momentum(q, u, base_vector(run.base, 0.0)))[:, 0]
    time, states, why = _fixed(run, stepper, np.concatenate([q, p]), progress)
    q_found, p_found = states[:, : len(q)], states[:, len(q) :]
    u_found = np.array(speed.map(len(time))(q_found.T, p_found.T, base_vector(run.base, time)).full().T)
    if run.chain.boundary.right.holds_deflection:
        # The rule keeps the closure, not its rate, which is left an error of second order.
        onto = projection(forward_dynamics(run.chain, load=run.load, damping=run.damping, base=run.base))
        both = onto.map(len(time))(np.hstack([q_found, u_found]).T, base_vector(run.base, time)).full().T
        u_found = np.array(both[:, len(q) :])
    return time, q_found, u_found, why


def _fixed(run: Run, stepper: Stepper, state: Array, progress: Progress) -> tuple[Array, Array, str]:
    """Return output times and states of fixed steps, and why they stopped early, or nothing."""
    kept, times, done, why = [state[None]], [0.0], 0, ""
    chunk = _CHUNK
    try:
        while done < run.steps and not why:
            count = min(chunk, run.steps - done)
            states = stepper.steps(state, run.step, done * run.step, count, run.base)
            bad = np.flatnonzero(~np.isfinite(states).all(axis=1))
            if len(bad):
                count = int(bad[0])
                number = done + count + 1
                why = f"non-finite state after step {number}, t = {number * run.step:.6g} s"
            numbers = done + np.arange(1, count + 1)
            wanted = (numbers % run.every == 0) | (numbers == run.steps)
            kept.append(states[:count][wanted])
            times.extend((numbers[wanted] * run.step).tolist())
            state, done = states[-1], done + count
            if progress is not None:
                progress(done, run.steps)
    except KeyboardInterrupt:
        why = f"interrupted after step {done}"
    return np.array(times), np.concatenate(kept), why


def _variable_run(solver_name: str) -> Runner:
    def runner(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
        import scipy.integrate

        solver_class = getattr(scipy.integrate, solver_name)
        dynamics = forward_dynamics(run.chain, load=run.load, damping=run.damping, base=run.base)
        held = run.chain.boundary.right.holds_deflection
        onto = projection(dynamics) if held else None
        size = len(start[0])
        # Buffers of its own: twenty times as fast as a call that copies and converts.
        q, u, found, base = (np.zeros(n) for n in (size, size, size, 9))
        buffer, evaluate = dynamics.acceleration.buffer()
        for k, argument in enumerate((q, u, base)):
            buffer.set_arg(k, argument.data)
        buffer.set_res(0, found.data)
        moves = run.base != BaseMotion()
        base[:] = base_vector(run.base, 0.0)

        def rate(time: float, x: Array) -> Array:
            q[:], u[:] = x[:size], x[size:]
            if moves:
                base[:] = base_vector(run.base, time)
            evaluate()
            return np.concatenate([u, found])

        counts = [*range(run.every, run.steps, run.every), run.steps]
        outputs = len(counts)
        state, kept, times, why = np.concatenate(start), [np.concatenate(start)], [0.0], ""
        first = None
        try:
            for k, number in enumerate(counts, start=1):
                bound = number * run.step
                first = None if first is None else min(first, run.step, bound - times[-1])
                solver = solver_class(
                    rate,
                    times[-1],
                    state,
                    bound,
                    max_step=run.step,
                    rtol=run.tolerance,
                    atol=run.tolerance / 1000,
                    first_step=first,
                )
                while solver.status == "running":
                    message = solver.step()
                if solver.status == "failed" or not np.isfinite(solver.y).all():
                    why = f"non-finite state before t = {bound:.6g} s ({message})"
                    break
                state, first = solver.y, solver.h_abs
                if onto is not None:
                    state = np.array(onto(state, base_vector(run.base, solver.t)))[:, 0]
                kept.append(state)
                times.append(bound)
                if progress is not None:
                    progress(k, outputs)
        except KeyboardInterrupt:
            why = f"interrupted after t = {times[-1]:.6g} s"
        states = np.array(kept)
        return np.array(times), states[:, :size], states[:, size:], why

    return runner


#: The runs by the name of their method.
RUNS: dict[str, Runner] = {
    "rk4": _runge_kutta_run,
    "midpoint": _midpoint_run,
    "rk45": _variable_run("RK45"),
    "dop853": _variable_run("DOP853"),
}
