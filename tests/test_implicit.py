"""Implicit steps, solved piece by piece, against the whole chain's equations, made of its energies."""

from __future__ import annotations

import itertools
import math
from typing import Any

import casadi
import numpy as np
import pytest
import scipy.linalg
from turns import in_turns

import beammodes as bm
from beammodes.dynamics import step_choice
from beammodes.dynamics.base_motion import BaseMotion, base_vector, harmonic, spin_up
from beammodes.dynamics.forward_dynamics import ChainState
from beammodes.dynamics.implicit import ImplicitStepper
from beammodes.dynamics.runs import projection
from beammodes.dynamics.step_choice import Motion
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.equations.mechanics import Algebra, coordinate_names, piece_energies
from beammodes.vibration.integrators import INTEGRATORS, accuracy_limit, amplification

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


@pytest.mark.parametrize(
    ("boundary", "setting", "rule"), in_turns(BOUNDARIES, SETTINGS, ["mitiguy", "rigid_stub"], every=2)
)
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


@pytest.mark.parametrize(
    ("boundary", "pieces"),
    [
        ("clamped-clamped", 2_000),
        pytest.param("clamped-clamped", 10_000, marks=pytest.mark.slow),
        pytest.param("clamped-free", 10_000, marks=pytest.mark.slow),
    ],
)
def test_a_chain_of_thousands_of_pieces_takes_steps(boundary: str, pieces: int) -> None:
    # By the midpoint rule at the step that mode 1 allows: with 10,000 pieces a million times the stable one.
    chain = bm.Chain(bm.Beam.unit(), boundary, segments=pieces)
    omega = bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0]
    period = 2 * math.pi / omega
    start = bm.mode_start(chain, 1, 0.02)
    motion = bm.simulate(chain, duration=period / 20, output_step=period / 20, initial=start)
    assert motion.integrator == "midpoint" and motion.step > 0.005 * pieces**2 * bm.stable_time_step(
        chain, "rk4"
    )
    assert motion.step == pytest.approx(
        period / 20 / math.ceil(2 * math.pi / 20 / accuracy_limit("midpoint"))
    )
    np.testing.assert_allclose(motion.energy / motion.energy[0], 1.0, atol=1e-6)
    # A mode's angle falls as its cosine, by the rule's frequency, (ωh)²/12 of it lower.
    turned = 2 * math.pi / 20 * (1 - (omega * motion.step) ** 2 / 12)
    fall = float(motion.q[-1, pieces // 4] / motion.q[0, pieces // 4])
    assert fall == pytest.approx(math.cos(turned), abs=2e-4)


def test_a_start_is_split_into_modes() -> None:
    # By the whole chain's matrices: the n-th mode has ½ ω² a² + ½ b²; motion as a rigid body is left out.
    for boundary in BOUNDARIES:
        chain = bm.Chain(bm.Beam.unit(), boundary, segments=6)
        model, tips = bm.linearize(chain), coordinate_names(chain)
        start, moved = np.random.default_rng(6).normal(size=(2, len(tips))), []
        for values in start:
            if chain.boundary.right.holds_deflection:
                reach = chain.length[~np.array(chain.held_angles)]
                values -= reach * (reach @ values) / (reach @ reach)
            angle, given = np.zeros(chain.pieces), dict(zip(tips, values, strict=True))
            angle[~np.array(chain.held_angles)] = [given[n] for n in tips if n.startswith("theta")]
            y = given.get("y_0", 0.0) + np.concatenate([[0.0], np.cumsum(chain.length * angle)])
            named = {f"y_{k}": value for k, value in enumerate(y)}
            named |= {f"theta_{k}": value for k, value in enumerate(angle, start=0)}
            moved.append([named[name] for name in model.coordinates])
        square, shape = scipy.linalg.eigh(model.stiffness_matrix, model.mass_matrix)
        parts = (np.array(moved) @ model.mass_matrix @ shape)[:, model.rigid_body_modes :]
        each = square[model.rigid_body_modes :] * parts[0] ** 2 + parts[1] ** 2
        motion = Motion(chain, 1.0, bm.Load(), TimeInputs(BaseMotion()), None, (start[0], start[1]))
        found = step_choice._shares(motion, model.elastic_modes)
        np.testing.assert_allclose(found, np.cumsum(each) / each.sum(), rtol=1e-9, err_msg=boundary)


def test_method_and_step_are_chosen_for_what_is_wanted() -> None:
    short, chain = (bm.Chain(bm.Beam.unit(), "clamped-free", segments=n) for n in (4, 200))
    omega = bm.solve_modes(bm.linearize(chain), 4).angular_frequency
    base, damping = BaseMotion(y=harmonic(1e-3, 400.0)), bm.Damping(stiffness=1e-4)

    def took(which: bm.Chain = chain, mode: int = 1, **given: Any) -> step_choice.Chosen:
        start = bm.mode_start(which, mode, 0.1)
        if mode == 4:  # at rest in its shape, with a twentieth of mode 1: shares go by squares of ω a
            start = start[0] + bm.mode_start(which, 1, 0.005)[0], start[1]
        arguments = {"load": bm.Load(), "drive": TimeInputs(BaseMotion()), "damping": None} | given
        name = arguments.pop("integrator", None)
        return step_choice.chosen(Motion(which, 100.0, start=start, **arguments), name, 1.0)

    few = took(short)
    # As stable as before: half the limit, and a thousandth of the whole motion.
    limit = min(0.1, bm.stable_time_step(short) / 2)
    assert few.integrator == "rk4" and few.step == pytest.approx(1 / math.ceil(1 / limit))
    reached = accuracy_limit("midpoint")
    for given, rate in (
        ({}, omega[0]),
        ({"mode": 4}, omega[3]),
        ({"mode": 4, "modes": 2}, omega[1]),
        ({"drive": TimeInputs(base)}, 400.0),
        ({"integrator": "midpoint"}, omega[0]),
    ):
        found = took(**given)
        assert found.integrator == "midpoint"
        assert reached / 2 < found.step * rate <= reached * (1 + 1e-3)
    # A load excites three modes; a damped chain is run by the method that damps.
    loaded = took(load=bm.Load(tip_moment=0.1), damping=damping)
    assert loaded.integrator == "sdirk2" and "damping" in loaded.reason
    assert loaded.step * omega[2] == pytest.approx(accuracy_limit("sdirk2"), rel=0.05)
    assert "mode 3: frequency -0.1 %" in loaded.step_error


def test_a_motion_in_which_nothing_moves_says_so() -> None:
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=2)
    # Nor does what pulls or pushes along a straight chain move it, also beyond the buckling load.
    for load in (None, bm.Load(gravity=(9.81, 0.0)), bm.Load(axial_force=-50.0)):
        with pytest.warns(bm.NothingMovesWarning, match=r"^nothing moves: give a start \(mode_start makes"):
            still = bm.simulate(chain, duration=0.1, load=load)
        assert "nothing moves" in still.remark and not still.q.any()
    for given in ({"load": bm.Load(gravity=1.0)}, {"initial": bm.mode_start(chain, 1, 0.1)}):
        moved = bm.simulate(chain, duration=0.1, **given)
        assert not moved.remark and moved.q.any()


def test_half_the_step_tells_the_error() -> None:
    # Against Runge-Kutta at a step whose error is ten thousand times less.
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=3)
    start, outputs = bm.mode_start(chain, 1, 0.4), {"duration": 2.0, "output_step": 0.1}
    exact = bm.simulate(chain, step=1e-3, initial=start, **outputs)
    for integrator in IMPLICIT:
        found = bm.simulate(
            chain, step=0.01, initial=start, integrator=integrator, halve_step=True, **outputs
        )
        for name, values in (("tip_error", "tip_deflection"), ("angle_error", "angle")):
            error = float(np.abs(found[values] - exact[values]).max())
            assert found.attrs[name] == pytest.approx(error, rel=0.05)
    with pytest.raises(ValueError, match="halve_step must be False for dop853"):
        bm.simulate(chain, initial=start, integrator="dop853", halve_step=True, **outputs)
