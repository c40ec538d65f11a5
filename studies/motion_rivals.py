"""One right-hand side of a clamped-free chain in motion, q'' of (q, q'), by this project and by others.

Angles are absolute, the chain is that of a unit beam with the report's springs. A method takes N and returns
a function of (q, q').
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.runs import Rate, Run, runge_kutta
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from studies.rivals import duration, kane_equations, timed
from studies.tables import markdown_table

__all__ = ["METHODS", "moving", "state_of"]

Array = NDArray[np.float64]
Acceleration = Callable[[Array, Array], Array]

#: Steps of Runge-Kutta in one call, four right-hand sides each.
_STEPS = 25


def _chain(segments: int) -> bm.Chain:
    return bm.Chain(bm.Beam.unit(), "clamped-free", segments)


def _linear_cost(segments: int) -> Acceleration:
    run = Run(_chain(segments), Load(), TimeInputs(BaseMotion()), Damping(), 1.0, 1.0, 1, 1, 1e-9)
    rate = Rate(run, segments)
    return lambda q, u: rate(0.0, np.concatenate([q, u]))[segments:]


def _dense(segments: int) -> Acceleration:
    equations = bm.compile_equations(_chain(segments))

    def acceleration(q: Array, u: Array) -> Array:
        mass = equations.mass_matrix(q).full()
        forces = equations.velocity_terms(q, u).full() + equations.static_forces(q).full()
        return np.asarray(scipy.linalg.solve(mass, -forces[:, 0], assume_a="pos"))

    return acceleration


def _mujoco(segments: int) -> Acceleration:
    import mujoco

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "chain.xml"
        bm.export_chain(_chain(segments), path)
        model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)

    def acceleration(q: Array, u: Array) -> Array:
        # Its angles are those of each body relative to the one before.
        data.qpos[:], data.qvel[:] = np.diff(q, prepend=0.0), np.diff(u, prepend=0.0)
        mujoco.mj_forward(model, data)
        return np.cumsum(data.qacc)

    return acceleration


def _kane(segments: int) -> Acceleration:
    import sympy

    kane, q, u = kane_equations(segments)
    plain = [sympy.Symbol(f"z{i}") for i in range(2 * segments)]
    names = dict(zip((*q, *u), plain, strict=True))
    terms = [part.subs(names) for part in (kane.mass_matrix, kane.forcing)]
    compiled = sympy.lambdify(plain, terms, cse=True)

    def acceleration(q: Array, u: Array) -> Array:
        mass, forcing = compiled(*q, *u)
        # In units of a segment; a unit beam's time unit is N² of them.
        return np.asarray(scipy.linalg.solve(mass, forcing[:, 0], assume_a="pos"))

    # u in the chain's units of time is u/N² in a segment's, and its acceleration N⁴ times theirs.
    return lambda q, u: segments**4 * acceleration(q, u / segments**2)


#: Every method by its name in the table, the package that it needs, and the longest chain that it is given.
METHODS: dict[str, tuple[Callable[[int], Acceleration], str, int]] = {
    "beammodes, one sweep in and out": (_linear_cost, "casadi", 10**9),
    "beammodes, dense M(q) in CasADi, Cholesky": (_dense, "casadi", 200),
    "MuJoCo's `mj_forward` of the exported chain": (_mujoco, "mujoco", 490),
    "`KanesMethod`, lambdified with `cse`, Cholesky": (_kane, "sympy", 8),
}


def state_of(segments: int) -> tuple[Array, Array]:
    """Return the angles and rates at which methods are compared: a bent chain that moves."""
    along = np.arange(1, segments + 1) / segments
    return 0.8 * np.sin(2 * along), 3.0 * np.cos(3 * along)


def moving(counts: Sequence[int] = (8, 50, 200, 1000)) -> str:
    """Return the time of one right-hand side by every method at every N, and over the first method's."""
    columns: list[list[str]] = []
    worst = 0.0
    for segments in counts:
        first, reference = _timed(METHODS["beammodes, one sweep in and out"][0], segments)
        column = [duration(first), _inside_steps(segments, first)]
        for build, package, longest in list(METHODS.values())[1:]:
            if segments > longest or find_spec(package) is None:
                column.append("not tried" if segments > longest else "not installed")
                continue
            seconds, found = _timed(build, segments)
            worst = max(worst, float(np.abs(found - reference).max() / np.abs(reference).max()))
            column.append(f"{duration(seconds)}, {seconds / first:.2g}")
        columns.append(column)
    if not worst < 1e-6:
        raise ArithmeticError(f"accelerations by different methods differ by {worst:.1e} of the largest")
    own, *others = METHODS
    names = [own, "the same inside compiled Runge-Kutta steps", *others]
    rows = [[name, *(column[k] for column in columns)] for k, name in enumerate(names)]
    return (
        "**One right-hand side** of a clamped-free chain in motion, angles and rates in, accelerations out, "
        "building not included: time, and how many times as long as the first row's. All give the same "
        f"accelerations at a bent, moving state (checked in this run to {worst:.0e} of the largest; MuJoCo's "
        'chain has an added trace of inertia). "Not tried": graphs that grow as N², XML nested beyond 490 '
        "bodies, derivations of minutes.\n\n"
        + markdown_table(["method", *(f"N = {n:,}" for n in counts)], rows)
    )


def _timed(build: Callable[[int], Acceleration], segments: int) -> tuple[float, Array]:
    acceleration, state = build(segments), state_of(segments)
    acceleration(*state)
    return timed(partial(acceleration, *state), budget=0.5)


def _inside_steps(segments: int, first: float) -> str:
    stepper = runge_kutta(_chain(segments))
    state, step = np.concatenate(state_of(segments)), 0.1 * bm.stable_time_step(_chain(segments))

    def steps() -> Array:
        return stepper.steps(state, step, 0.0, _STEPS, BaseMotion())

    steps()
    seconds = timed(steps, budget=0.5)[0] / (4 * _STEPS)
    return f"{duration(seconds)}, {seconds / first:.2g}"
