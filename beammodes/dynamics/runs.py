"""Runs of the integrators: in chunks, so that they can be watched, interrupted, and stopped."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.chain_state import base_vector
from beammodes.dynamics.forward_dynamics import forward_dynamics
from beammodes.dynamics.midpoint import implicit_midpoint, momentum_map
from beammodes.dynamics.runge_kutta import Stepper, projection, runge_kutta
from beammodes.interrupts import pause
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS

__all__ = ["Rate", "Run", "Runner", "midpoint_run", "runge_kutta_run", "runner", "variable_run"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None] | None

#: Times, coordinates, speeds, and why the run stopped early, or nothing.
Found = tuple[Array, Array, Array, str]
Runner = Callable[["Run", tuple[Array, Array], Progress], Found]

# Steps, and steps times numbers of a state, that one call of compiled code takes at most: short enough to be
# watched and interrupted.
_CHUNK, _NUMBERS = 2000, 50_000


@dataclass(frozen=True)
class Run:
    """What a run integrates, and how.

    Attributes
    ----------
    duration, step, every, steps
        Time in all and step [s], steps between outputs, steps in all.
    tolerance : float
        Relative, of variable-step methods.
    integrator : str
    """

    chain: Chain
    load: Load
    base: BaseMotion
    damping: Damping
    duration: float
    step: float
    every: int
    steps: int
    tolerance: float
    integrator: str = "rk4"

    @property
    def parts(self) -> dict[str, object]:
        """The arguments of the compiled functions."""
        return {"load": self.load, "damping": self.damping, "base": self.base}


def runner(integrator: str) -> Runner:
    """Return the function that runs an integrator of `simulate`, by its record.

    Examples
    --------
    >>> runner("dop853").__name__
    'variable_run'
    """
    found: Runner = globals()[INTEGRATORS[integrator].run]
    return found


def runge_kutta_run(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
    """Integrate by an explicit Runge-Kutta method of fixed step."""
    stepper = runge_kutta(
        run.chain, load=run.load, damping=run.damping, base=run.base, integrator=run.integrator
    )
    time, states, why = _fixed(run, stepper, np.concatenate(start), progress)
    size = len(start[0])
    return time, states[:, :size], states[:, size:], why


def midpoint_run(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
    """Integrate by the implicit midpoint rule."""
    stepper = implicit_midpoint(run.chain, load=run.load, damping=run.damping, base=run.base)
    momentum, speed = momentum_map(run.chain, load=run.load)
    q, u = start
    p = np.array(momentum(q, u, base_vector(run.base, 0.0)))[:, 0]
    time, states, why = _fixed(run, stepper, np.concatenate([q, p]), progress)
    q_found, p_found = states[:, : len(q)], states[:, len(q) :]
    u_found = np.array(speed.map(len(time))(q_found.T, p_found.T, base_vector(run.base, time)).full().T)
    if run.chain.boundary.right.holds_deflection:
        # The rule keeps the closure, not its rate, which is left an error of second order.
        onto = projection(run.chain)
        both = onto.map(len(time))(np.hstack([q_found, u_found]).T, base_vector(run.base, time)).full().T
        u_found = np.array(both[:, len(q) :])
    lost = np.flatnonzero(~np.isfinite(u_found).all(axis=1))
    if len(lost):
        # A momentum may be a finite number where the speed that it stands for is none.
        why = f"non-finite state at t = {time[lost[0]]:.6g} s"
        time, q_found, u_found = (values[: lost[0]] for values in (time, q_found, u_found))
    return time, q_found, u_found, why


def _fixed(run: Run, stepper: Stepper, state: Array, progress: Progress) -> tuple[Array, Array, str]:
    """Return output times and states of fixed steps, and why they stopped early, or nothing."""
    kept, times, done, why = [state[None]], [0.0], 0, ""
    chunk = min(_CHUNK, 1 + _NUMBERS // max(1, len(state)))
    pause()
    try:
        while done < run.steps and not why:
            pause()
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


class Rate:
    """The function (t, state) -> state', twenty times as fast as a call that copies and converts."""

    def __init__(self, run: Run, size: int) -> None:
        self.run, self.moves = run, run.base != BaseMotion()
        dynamics = forward_dynamics(run.chain, load=run.load, damping=run.damping, base=run.base)
        self.q, self.u, self.found, self.base = (np.zeros(n) for n in (size, size, size, 9))
        # Compiled code reads and writes these arrays; it lives no longer than the buffer does.
        self.buffer, self.evaluate = dynamics.acceleration.buffer()
        for k, argument in enumerate((self.q, self.u, self.base)):
            self.buffer.set_arg(k, argument.data)
        self.buffer.set_res(0, self.found.data)
        self.base[:] = base_vector(run.base, 0.0)

    def __call__(self, time: float, x: Array) -> Array:
        """Return q' and q'' at a time and a state (q, q')."""
        size = len(self.q)
        self.q[:], self.u[:] = x[:size], x[size:]
        if self.moves:
            self.base[:] = base_vector(self.run.base, time)
        self.evaluate()
        return np.concatenate([self.u, self.found])


def variable_run(run: Run, start: tuple[Array, Array], progress: Progress) -> Found:
    """Integrate by a Runge-Kutta pair of SciPy, which chooses its steps."""
    size, why = len(start[0]), ""
    kept, times = [np.concatenate(start)], [0.0]
    rate = Rate(run, size)
    onto = projection(run.chain) if run.chain.boundary.right.holds_deflection else None
    pause()
    pieces = _variable_pieces(run, rate, onto, kept[0])
    outputs = math.ceil(run.steps / run.every)
    try:
        # A motion that diverges passes through numbers whose squares are too large.
        with np.errstate(over="ignore", invalid="ignore"):
            for k, (time, state, why) in enumerate(pieces, start=1):
                if why:
                    break
                kept.append(state)
                times.append(time)
                if progress is not None:
                    progress(k, outputs)
    except KeyboardInterrupt:
        why = f"interrupted after t = {times[-1]:.6g} s"
    states = np.array(kept)
    return np.array(times), states[:, :size], states[:, size:], why


def _variable_pieces(run: Run, rate: Rate, onto: Any, state: Array) -> Iterator[tuple[float, Array, str]]:
    """Yield each output time, the state there, and why the motion cannot go on, or nothing."""
    import scipy.integrate

    solver_class = getattr(scipy.integrate, run.integrator.upper())
    time, first, message = 0.0, None, ""
    if not np.isfinite(rate(0.0, state)).all():
        # SciPy would look for a first step for ever.
        yield 0.0, state, "non-finite rate at t = 0 s"
        return
    for number in (*range(run.every, run.steps, run.every), run.steps):
        bound = min(number * run.step, run.duration)
        first = None if first is None else min(first, run.step, bound - time)
        solver = solver_class(
            rate,
            time,
            state,
            bound,
            max_step=run.step,
            rtol=run.tolerance,
            atol=run.tolerance / 1000,
            first_step=first,
        )
        while solver.status == "running":
            pause()
            message = solver.step()
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            yield bound, state, f"non-finite state before t = {bound:.6g} s ({message})"
            return
        time, state, first = bound, solver.y, solver.h_abs
        if onto is not None:
            state = np.array(onto(state, base_vector(run.base, time)))[:, 0]
        yield time, state, ""
