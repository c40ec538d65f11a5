"""Implicit steps, solved piece by piece, against the whole chain's equations, made of its energies."""

from __future__ import annotations

import itertools
import math
from typing import Any

import casadi
import numpy as np
import pytest

import beammodes as bm
from beammodes.dynamics.base_motion import BaseMotion, harmonic, spin_up
from beammodes.dynamics.forward_dynamics import ChainState, base_vector
from beammodes.dynamics.implicit import ImplicitStepper
from beammodes.dynamics.runs import projection
from beammodes.equations.mechanics import Algebra, coordinate_names, piece_energies
from beammodes.vibration.integrators import INTEGRATORS, amplification

IMPLICIT = [name for name, record in INTEGRATORS.items() if record.run == "implicit"]
# One of each kind of left end and right end, held, sprung and carrying, and both kinds of first piece.
BOUNDARIES = (
    "clamped-free",
    "free-free",
    "pinned-pinned",
    "clamped-clamped",
    "guided-free",
    "clamped-pinned",
    "pinned-free",
    "clamped-free(mass=0.5, rotary_inertia=0.1, offset=0.2)",
    "clamped-free(translational_stiffness=30, rotational_stiffness=2)",
    "free(translational_stiffness=20, rotational_stiffness=3)-free",
    "pinned(rotational_stiffness=2)-guided",
)
SETTINGS = ("alone", "loaded", "damped", "carried")


def system(boundary: str, setting: str, rule: str) -> tuple[bm.Chain, dict[str, Any], BaseMotion]:
    chain = bm.Chain(bm.Beam.unit(), boundary, segments=5, rule=rule)
    given: dict[str, Any] = {"load": None, "damping": None}
    base = BaseMotion()
    if setting == "loaded":
        given["load"] = bm.Load(gravity=(0.2, -1.0), tip_force=(0.3, 0.2), tip_moment=0.1, axial_force=0.4)
    if setting != "alone":
        given["damping"] = bm.Damping(stiffness=0.01, mass=0.3)
    if setting == "carried":
        ends = chain.boundary
        turns = ends.left.holds_deflection and not ends.right.is_grounded
        base = BaseMotion(harmonic(0.1, 2.0), harmonic(0.2, 3.0), hub_radius=0.1)
        if turns:
            base = BaseMotion(harmonic(0.1, 2.0), harmonic(0.2, 3.0), spin_up(2.0, 3.0), 0.1)
    return chain, given, base


def whole_chain(chain: bm.Chain, load: bm.Load | None, damping: bm.Damping | None) -> casadi.Function:
    """∂L/∂q', ∂L/∂q - ∂R/∂q', and the gradient of the right tip's deflection, from energies alone."""
    size = len(coordinate_names(chain))
    q, u, base = (casadi.SX.sym(name, count) for name, count in (("q", size), ("u", size), ("base", 9)))
    parts = [casadi.vertsplit(each) for each in (q, u, base)]
    state = ChainState.of(chain, *parts)
    algebra = Algebra.physical(chain, casadi.sin, casadi.cos)
    given, taken = load or bm.Load(), damping or bm.Damping()
    kinetic, potential, tip = piece_energies(
        chain, state.place, state.speed, state.angle, state.spin, algebra, given, (base[3], base[6])
    )
    # Rayleigh's dissipation: α times the kinetic energy and β times the springs', both relative to the base.
    turn, relative = base[7], [rate - base[7] for rate in state.spin]
    start = (
        state.speed[0] - base[1] + turn * (state.place[1] - base[3]),
        state.speed[1] - base[4] - turn * (state.place[0] - base[0]),
    )
    drag, _, _ = piece_energies(chain, state.place, start, state.angle, relative, algebra)
    lost = taken.mass * drag
    for j, damper in enumerate(taken.joint_damping(chain).tolist()):
        lost += damper / 2 * (state.spin[j + 1] - state.spin[j]) ** 2
    end = start[1] + sum(
        length * casadi.cos(a) * w
        for length, a, w in zip(chain.length.tolist(), state.angle, relative, strict=True)
    )
    for (across, turning), rates in zip(
        chain.support_stiffness.tolist(), ((start[1], relative[0]), (end, relative[-1])), strict=True
    ):
        for stiffness, rate in zip((across, turning), rates, strict=True):
            lost += taken.stiffness / 2 * (stiffness if math.isfinite(stiffness) else 0.0) * rate**2
    lagrangian = kinetic - potential
    pull = casadi.gradient(lagrangian, q) - casadi.gradient(lost, u)
    return casadi.Function(
        "whole", [q, u, base], [casadi.gradient(lagrangian, u), pull, casadi.gradient(tip[1], q), tip[1]]
    )


def start_of(chain: bm.Chain, base: BaseMotion) -> tuple[np.ndarray, np.ndarray]:
    size = len(coordinate_names(chain))
    draw = np.random.default_rng(len(chain.boundary.name))
    q, u = 0.05 * draw.normal(size=size), 0.2 * draw.normal(size=size)
    if chain.boundary.right.holds_deflection:
        state, onto = np.concatenate([q, u]), projection(chain)
        for _ in range(4):
            state = np.array(onto(state, base_vector(base, 0.0)))[:, 0]
        q, u = state[:size], state[size:]
    return q, u


@pytest.mark.parametrize("rule", ["mitiguy", "rigid_stub"])
@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_the_midpoint_rule_holds_for_the_whole_chain(boundary: str, setting: str, rule: str) -> None:
    chain, given, base = system(boundary, setting, rule)
    whole, (q, u) = whole_chain(chain, **given), start_of(chain, base)
    stepper, step = ImplicitStepper(chain, **given), 0.01
    p = stepper.momenta(q, u, base_vector(base, 0.0))
    np.testing.assert_allclose(p, np.array(whole(q, u, base_vector(base, 0.0))[0])[:, 0], atol=1e-13)
    np.testing.assert_allclose(stepper.speeds(q[None], p[None], base_vector(base, [0.0]))[0], u, atol=1e-9)
    states = np.vstack([np.concatenate([q, p]), stepper.steps(np.concatenate([q, p]), step, 0.0, 5, base)])
    size, held = len(q), chain.boundary.right.holds_deflection
    for k, (before, after) in enumerate(itertools.pairwise(states)):
        middle = base_vector(base, (k + 0.5) * step)
        rate = (after - before)[:size] / step
        momentum, pull, slope, _ = (
            np.array(each)[:, 0] for each in whole((before + after)[:size] / 2, rate, middle)
        )
        np.testing.assert_allclose((before + after)[size:] / 2, momentum, atol=1e-12)
        # What the pull leaves is along the closure's gradient, and nothing where nothing is closed.
        left = (after - before)[size:] / step - pull
        if held:
            left -= slope * (slope @ left) / (slope @ slope)
            late = base_vector(base, (k + 1) * step)
            assert float(whole(after[:size], rate, late)[3]) == pytest.approx(late[3], abs=1e-12)
        np.testing.assert_allclose(left, 0.0, atol=1e-9)


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-pinned", "free-free"])
@pytest.mark.parametrize("integrator", IMPLICIT)
def test_steps_converge_at_their_methods_order(integrator: str, boundary: str) -> None:
    # The record's order, of coordinates; the other method's limit is the Runge-Kutta method's.
    chain = bm.Chain(bm.Beam.unit(), boundary, segments=3)
    span, start = 0.2, bm.mode_start(chain, 1, 0.3)
    least = math.ceil(span / bm.stable_time_step(chain))
    fine = bm.simulate(chain, duration=span, step=span / (32 * least), output_step=span, initial=start)
    errors = []
    for finer in (16, 32, 64):
        count = finer * least
        found = bm.simulate(
            chain, duration=span, step=span / count, output_step=span, initial=start, integrator=integrator
        )
        errors.append(float(np.abs(found.q[-1] - fine.q[-1]).max()))
    order = np.log2(errors[1] / errors[2])
    assert order == pytest.approx(INTEGRATORS[integrator].order, abs=0.15), errors


def test_sdirk2_stops_what_a_step_cannot_resolve() -> None:
    # The amplification of a mode by one step, from Butcher's tables, against the motion of one piece, ω = 3.
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=1)
    for step in (0.1, 1.0, 30.0):
        stepper = ImplicitStepper(chain, integrator="sdirk2")
        q, p = 1e-7, 0.0
        (new,) = stepper.steps(np.array([q, p]), step, 0.0, 1, BaseMotion())
        inertia = float(stepper.momenta(np.array([0.0]), np.array([1.0]), np.zeros(9))[0])
        share = complex(new[0] / q, -new[1] / (3.0 * inertia * q))
        assert share == pytest.approx(complex(amplification("sdirk2", 3.0 * step)), abs=1e-9)
    assert abs(amplification("sdirk2", 1e6)) < 1e-5


def test_a_chain_of_ten_thousand_pieces_takes_steps() -> None:
    # Its step is a hundredth of the first period: energy stays within (ωh)² or so.
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=10_000)
    period = 2 * math.pi / bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0]
    assert period / 100 > 1e6 * bm.stable_time_step(chain, "rk4")
    start = bm.mode_start(chain, 1, 0.1)
    motion = bm.simulate(chain, duration=period / 20, step=period / 100, initial=start, integrator="midpoint")
    assert motion.sizes["time"] == 6
    np.testing.assert_allclose(motion.energy / motion.energy[0], 1.0, atol=(2 * math.pi / 100) ** 2)
    # A mode's angle falls as its cosine.
    expected = math.cos(2 * math.pi / 20)
    assert float(motion.q[-1, -1] / motion.q[0, -1]) == pytest.approx(expected, abs=2e-3)
