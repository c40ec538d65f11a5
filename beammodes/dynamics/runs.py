"""Steps of integrators, compiled, and runs of them, in chunks that can be watched, interrupted and stopped.

A state is (q, q'), of implicit methods (q, p); see `beammodes.dynamics.implicit`. Where loads vary in time
their work is one more number of it, integrated like the rest. Chains whose right end is
held are projected back onto their closure after each explicit step, with the least change of q and of q';
implicit methods meet it by a multiplier. A stepper of another kind needs `steps` as `Stepper` has it, and a
run in `runner`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi
import numpy as np

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion, base_vector
from beammodes.dynamics.forward_dynamics import ChainState, forward_dynamics
from beammodes.dynamics.implicit import ImplicitStepper
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.dynamics.timed_loads import TimedLoad
from beammodes.equations.mechanics import Span, coordinate_names
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load
from beammodes.progress import Progress, pause
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS

__all__ = [
    "Rate",
    "Run",
    "Stepper",
    "projection",
    "runge_kutta",
    "runner",
]

# Steps, and steps times numbers of a state, that one call of compiled code takes at most: short enough to be
# watched and interrupted.
_CHUNK, _NUMBERS = 2000, 50_000


@dataclass(frozen=True)
class Stepper:
    """One step as a CasADi function of (state, step, drive), drive at `times`, parts of it, in a column."""

    function: casadi.Function
    times: tuple[float, ...]

    def steps(self, state: Floats, step: float, start: float, count: int, base: BaseMotion) -> Floats:
        """Return the states after each of `count` steps from time `start`, shape (count, size)."""
        at = start + step * np.arange(count, dtype=np.float64)
        return self.along(state, at, np.full(count, step), TimeInputs(base))

    def along(self, state: Floats, at: Floats, lengths: Floats, drive: TimeInputs) -> Floats:
        """Return the states after each of some steps, that start at times `at`, shape (steps, size)."""
        count = len(at)
        columns = drive.stages(at, lengths, self.times).reshape(-1, count)
        mapped = _repeated(self.function, count)
        return np.asarray(mapped(state, lengths[None], columns).full().T)


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
    loads: Sequence[TimedLoad] = (),
    integrator: str = "rk4",
    span: Span | None = None,
) -> Stepper:
    """Return one step of an explicit Runge-Kutta method, of states (q, q'), with `loads` (q, q', work).

        k_i = f(t + c_i h, x + h Σ_j a_ij k_j),   x + h Σ_i b_i k_i

    The integrator is one of `INTEGRATORS` with explicit stages.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> stepper = runge_kutta(Chain(Beam.unit(), "clamped-free", segments=1))        # q'' = -9 q
    >>> stepper.steps(np.array([1.0, 0.0]), 0.01, 0.0, 2, BaseMotion())[:, 0].round(4)
    array([0.9996, 0.9982])
    """
    method = INTEGRATORS[integrator]
    acceleration = forward_dynamics(
        chain, load=load, damping=damping, base=base, loads=loads, apart=span is not None
    )
    pause()
    size, numbers = acceleration.size1_in(0), acceleration.size1_in(2)
    # The last time is that of the new state's closure.
    nodes = [sum(row) for row in method.stages]
    times = tuple(sorted({*nodes, 1.0}))
    state, step, course = (
        casadi.SX.sym(n, k)
        for n, k in (("x", 2 * size + bool(loads)), ("h", 1), ("drive", numbers * len(times)))
    )
    at = dict(zip(times, casadi.vertsplit(course, numbers), strict=True))
    rates: list[Any] = []
    for node, row in zip(nodes, method.stages, strict=True):
        x = state
        for weight, rate in zip(row, rates, strict=False):
            x = x + (step * weight) * rate if weight else x
        speeds = x[size : 2 * size]
        found = acceleration.call([x[:size], speeds, at[node]])
        rates.append(casadi.vertcat(speeds, *found))
    # In multiples of the least weight, as the method is written in books: h/6 (k_1 + 2 k_2 + 2 k_3 + k_4).
    least = min(weight for weight in method.weights if weight)
    terms = [weight / least * rate for weight, rate in zip(method.weights, rates, strict=True) if weight]
    new = state + step / (1 / least) * sum(terms[1:], terms[0])
    if chain.boundary.right.holds_deflection:
        new = casadi.vertcat(projection(chain, span)(new[: 2 * size], at[1.0][:9]), new[2 * size :])
    return Stepper(casadi.Function("runge_kutta", [state, step, course], [new]), times)


def _closure(chain: Chain, q: Any, base: Any, span: Span | None) -> Any:
    """Return how far the right tip is from where it is held: across the beam, or along x and y."""
    parts = casadi.vertsplit(q)
    state = ChainState.of(chain, parts, parts, casadi.vertsplit(base))
    length, angle = casadi.DM(chain.length.tolist()), casadi.vertcat(*state.angle)
    across = state.place[1] - base[3] + casadi.dot(length, casadi.sin(angle))
    if span is None:
        return across
    along = state.place[0] - base[0] + casadi.dot(length, casadi.cos(angle))
    return casadi.vertcat(along - span[0], across - span[1])


def projection(chain: Chain, span: Span | None = None) -> casadi.Function:
    """Return the function (state, base) -> nearest state with the right tip where its end holds it.

    Two Newton steps: a Runge-Kutta step leaves the closure by little.
    """
    size = len(coordinate_names(chain))
    q, u, base = (casadi.SX.sym(n, k) for n, k in (("q", size), ("u", size), ("base", 9)))
    gap = _closure(chain, q, base, span)
    slope = casadi.jacobian(gap, q)
    # Bases under a held right end only shift, so the tip's velocity is the base's where the left tip's is.
    rate = slope @ u - (0 if chain.boundary.left.holds_deflection else base[4])
    back, turn = (
        slope.T * each / casadi.sumsqr(slope)
        if span is None
        else slope.T @ casadi.solve(slope @ slope.T, each)
        for each in (gap, rate)
    )
    onto = casadi.Function("onto", [q, base], [q - back])
    along = casadi.Function("along", [q, u, base], [u - turn])
    state = casadi.SX.sym("x", 2 * size)
    placed = onto(onto(state[:size], base), base)
    moved = along(placed, state[size:], base)
    return casadi.Function("projection", [state, base], [casadi.vertcat(placed, moved)])


#: Times, coordinates, speeds, work of the timed loads, and why the run stopped early, or nothing.
Found = tuple[Floats, Floats, Floats, Floats, str]
Runner = Callable[["Run", tuple[Floats, Floats], Progress], Found]


@dataclass(frozen=True)
class Run:
    """A motion to integrate: duration and step [s], steps between outputs and in all, relative tolerance."""

    chain: Chain
    load: Load
    drive: TimeInputs
    damping: Damping
    duration: float
    step: float
    every: int
    steps: int
    tolerance: float
    integrator: str = "rk4"
    span: Span | None = None


def runner(integrator: str) -> Runner:
    """Return the function that runs an integrator of `simulate`, by its record."""
    runs = {"runge_kutta": _runge_kutta_run, "implicit": _implicit_run, "variable": _variable_run}
    return runs[INTEGRATORS[integrator].run]


def _start(run: Run, *halves: Floats) -> Floats:
    """Return the first state: with loads that vary in time, their work so far stands last."""
    return np.concatenate([*halves, np.zeros(int(bool(run.drive.loads)))])


def _work(states: Floats, size: int) -> Floats:
    """Return the work in states of `size` coordinates, none where there is no such load."""
    return states[:, 2 * size] if states.shape[1] > 2 * size else np.zeros(len(states))


def _runge_kutta_run(run: Run, start: tuple[Floats, Floats], progress: Progress) -> Found:
    """Integrate by an explicit Runge-Kutta method of fixed step."""
    stepper = runge_kutta(
        run.chain,
        load=run.load,
        damping=run.damping,
        base=run.drive.base,
        loads=run.drive.loads,
        integrator=run.integrator,
        span=run.span,
    )
    time, states, why = _fixed(run, stepper, _start(run, *start), progress)
    size = len(start[0])
    return time, states[:, :size], states[:, size : 2 * size], _work(states, size), why


def _implicit_run(run: Run, start: tuple[Floats, Floats], progress: Progress) -> Found:
    """Integrate by an implicit Runge-Kutta method, in coordinates and momenta."""
    stepper = ImplicitStepper(
        run.chain,
        load=run.load,
        damping=run.damping,
        loads=run.drive.loads,
        integrator=run.integrator,
        span=run.span,
    )
    (q, u), base = start, run.drive.base
    p = stepper.momenta(q, u, base_vector(base, 0.0))
    time, states, why = _fixed(run, stepper, _start(run, q, p), progress)
    q_found, p_found, work = states[:, : len(q)], states[:, len(q) : 2 * len(q)], _work(states, len(q))
    u_found = stepper.speeds(q_found, p_found, base_vector(base, time))
    if run.chain.boundary.right.holds_deflection:
        # The method keeps the closure, not its rate, which is left an error of second order.
        onto = projection(run.chain, run.span)
        both = onto.map(len(time))(np.hstack([q_found, u_found]).T, base_vector(base, time)).full().T
        u_found = np.array(both[:, len(q) :])
    lost = np.flatnonzero(~np.isfinite(u_found).all(axis=1))
    if len(lost):
        # A momentum may be a finite number where the speed that it stands for is none.
        why = f"non-finite state at t = {time[lost[0]]:.6g} s"
        time, q_found, u_found, work = (values[: lost[0]] for values in (time, q_found, u_found, work))
    return time, q_found, u_found, work, why


def _fixed(
    run: Run, stepper: Stepper | ImplicitStepper, state: Floats, progress: Progress
) -> tuple[Floats, Floats, str]:
    """Return output times and states of fixed steps, and why they stopped early, or nothing."""
    kept, times, done, why = [state[None]], [0.0], 0, ""
    chunk = min(_CHUNK, 1 + _NUMBERS // max(1, len(state)))
    pause()
    try:
        while done < run.steps and not why:
            pause()
            count = min(chunk, run.steps - done)
            at, lengths, whole = run.drive.mesh(run.step, done, count)
            states = stepper.along(state, at, lengths, run.drive)
            bad = np.flatnonzero(~np.isfinite(states).all(axis=1))
            # Between whole steps, where a load or the base jumps, nothing is kept.
            last, states = states[-1], states[whole]
            if len(bad):
                count = int(whole[: bad[0]].sum())
                number = done + count + 1
                why = f"non-finite state after step {number}, t = {number * run.step:.6g} s"
            numbers = done + np.arange(1, count + 1)
            wanted = (numbers % run.every == 0) | (numbers == run.steps)
            kept.append(states[:count][wanted])
            times.extend((numbers[wanted] * run.step).tolist())
            state, done = last, done + count
            progress(done, run.steps)
    except KeyboardInterrupt:
        why = f"interrupted after step {done}"
    return np.array(times), np.concatenate(kept), why


class Rate:
    """The function (t, state) -> state', twenty times as fast as a call that copies and converts.

    A base that moves, or a load that varies, is asked once for a whole step of a Runge-Kutta pair of SciPy:
    its first stage tells by its time when the others will come. Other times are asked for one by one. Jumps
    are ends of spans, and are seen from within the one that is integrated.
    """

    def __init__(self, run: Run, size: int) -> None:
        drive = run.drive
        self.run, self.moves = run, not drive.rests
        acceleration = forward_dynamics(
            run.chain,
            load=run.load,
            damping=run.damping,
            base=drive.base,
            loads=drive.loads,
            apart=run.span is not None,
        )
        self.q, self.u, self.found, self.power, self.base = (
            np.zeros(n) for n in (size, size, size, int(bool(drive.loads)), drive.size)
        )
        # Compiled code reads and writes these arrays; it lives no longer than the buffer does.
        self.buffer, self.evaluate = acceleration.buffer()
        for k, argument in enumerate((self.q, self.u, self.base)):
            self.buffer.set_arg(k, argument.data)
        self.buffer.set_res(0, self.found.data)
        if drive.loads:
            self.buffer.set_res(1, self.power.data)
        self.base[:] = drive.at(0.0)
        # The solver whose stages are evaluated, their places in a step, their times (the next one's index is
        # kept) with the base at them, and how near a time must come to one.
        self.solver: Any = None
        self.span = 0.0, run.duration
        self._nodes = np.ones(1)
        self._times: list[float] = []
        self._course = np.zeros((0, drive.size))
        self._next, self._near = 0, 0.0

    def enter(self, start: float, stop: float) -> None:
        """Take note of the span that is integrated from now on."""
        self.solver, self.span, self._times = None, (start, stop), []
        self._next = 0

    def serve(self, solver: Any) -> None:
        """Take note of the Runge-Kutta pair of SciPy that asks from now on."""
        self.solver, self._nodes = solver, np.append(solver.C[1:], 1.0)

    def __call__(self, time: float, x: Floats) -> Floats:
        """Return q' and q'' at a time and a state (q, q')."""
        size = len(self.q)
        self.q[:], self.u[:] = x[:size], x[size : 2 * size]
        if self.moves:
            k = self._next
            if k == len(self._times) or abs(self._times[k] - time) > self._near:
                self._foresee(time)
                k = 0
            self.base[:] = self._course[k]
            self._next = k + 1
        self.evaluate()
        return np.concatenate([self.u, self.found, self.power])

    def _foresee(self, time: float) -> None:
        """Ask the base where it is at a time, and at those that follow if it is a step's first stage."""
        at, self._near = np.array([time]), 0.0
        if self.solver is not None and time > self.solver.t:
            step = (time - self.solver.t) / self._nodes[0]
            at, self._near = self.solver.t + self._nodes * step, 1e-9 * step
            at[0] = time
        start, stop = self.span
        share = (at - start) / (stop - start)
        self._times = at.tolist()
        self._course = self.run.drive.stages(np.array([start]), np.array([stop - start]), share)[..., 0]


def _variable_run(run: Run, start: tuple[Floats, Floats], progress: Progress) -> Found:
    """Integrate by a Runge-Kutta pair of SciPy, which chooses its steps."""
    size, why = len(start[0]), ""
    kept, times = [_start(run, *start)], [0.0]
    rate = Rate(run, size)
    onto = projection(run.chain, run.span) if run.chain.boundary.right.holds_deflection else None
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
                progress(k, outputs)
    except KeyboardInterrupt:
        why = f"interrupted after t = {times[-1]:.6g} s"
    states = np.array(kept)
    return np.array(times), states[:, :size], states[:, size : 2 * size], _work(states, size), why


def _variable_pieces(run: Run, rate: Rate, onto: Any, state: Floats) -> Iterator[tuple[float, Floats, str]]:
    """Yield each output time, the state there, and why the motion cannot go on, or nothing."""
    import scipy.integrate

    solver_class = getattr(scipy.integrate, run.integrator.upper())
    time, first, message = 0.0, None, ""
    if not np.isfinite(rate(0.0, state)).all():
        # SciPy would look for a first step for ever.
        yield 0.0, state, "non-finite rate at t = 0 s"
        return
    for bound, wanted in _bounds(run):
        rate.enter(time, bound)
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
        rate.serve(solver)
        while solver.status == "running":
            pause()
            message = solver.step()
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            yield bound, state, f"non-finite state before t = {bound:.6g} s ({message})"
            return
        time, state, first = bound, solver.y, solver.h_abs
        if onto is not None:
            size = 2 * len(rate.q)
            placed = np.array(onto(state[:size], base_vector(run.drive.base, time)))[:, 0]
            state = np.concatenate([placed, state[size:]])
        if wanted:
            yield time, state, ""


def _bounds(run: Run) -> Iterator[tuple[float, bool]]:
    """Yield the ends of spans: output times, which are kept, and jumps of loads and base between them."""
    before = 0.0
    for number in (*range(run.every, run.steps, run.every), run.steps):
        bound = min(number * run.step, run.duration)
        within = 1e-9 * (bound - before)
        for jump in run.drive.jumps:
            if before + within < jump < bound - within:
                yield float(jump), False
        yield bound, True
        before = bound
