"""Loads in time: what they do to a chain, against virtual work; jumps, order, energy and momentum; steps."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import trapezoid
from test_base_motion import assert_derivatives
from test_forward_dynamics import STILL, dense_accelerations, random_state

import beammodes as bm
from beammodes.dynamics.forward_dynamics import forward_dynamics
from beammodes.dynamics.step_choice import Chosen, Motion, chosen
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.dynamics.timed_loads import read_loads
from beammodes.equations.mechanics import tip_names
from beammodes.problem.applied_loads import LineLoad, PointLoad
from beammodes.vibration.integrators import accuracy_limit

Array = np.ndarray
BEAM = bm.Beam(1.2, 85.0, 0.62)
RAMP = bm.Table((0.0, 0.5, 0.5, 1.2), (1.0, 2.0, -1.0, 3.0))
#: Forces and moments at 0.37 m, at the tip and along the beam, each both ways.
LOADS = [
    bm.TimedLoad(load, follower=follower)
    for load in (
        PointLoad(0.37, force=(2.0, -3.0), moment=0.7),
        LineLoad((1.0, -2.0, 3.0), start=0.2, stop=1.1),
        LineLoad(RAMP),
        bm.Load(tip_force=(1.0, 2.0), tip_moment=0.3),
    )
    for follower in (False, True)
] + [bm.TimedLoad(bm.Load(gravity=(0.5, -9.81), axial_force=4.0))]


def virtual_work(chain: bm.Chain, q: Array, load: Any, *, follower: bool) -> Array:
    """Generalized forces of a load, from the displacements of points that complex steps of q give."""
    tips = tip_names(chain)

    def place(q: Array, x: float) -> tuple[Any, Any, Any]:
        given = dict(zip(tips, q, strict=False))
        angle = np.zeros(chain.pieces, dtype=complex)
        angle[~np.array(chain.held_angles)] = q[len(tips) :]
        at = given.get("x_0", 0.0) + 1j * 0, given.get("y_0", 0.0) + 1j * 0
        for length, turn in zip(chain.length, angle, strict=True):
            inside = x < length
            part = x if inside else length
            at = at[0] + part * np.cos(turn), at[1] + part * np.sin(turn)
            if inside:
                return *at, turn
            x -= part
        return *at, angle[-1]

    points: list[tuple[float, tuple[float, float], float]] = []
    if isinstance(load, PointLoad):
        assert isinstance(load.force, tuple) and load.x is not None
        points.append((float(load.x), load.force, float(load.moment)))
    elif isinstance(load, LineLoad):
        stop = BEAM.length if load.stop is None else float(load.stop)
        edges = np.unique(
            np.clip([0.0, 0.5, stop, *chain.node_position, float(load.start)], load.start, stop)
        )
        node, weight = np.polynomial.legendre.leggauss(6)
        for a, b in pairwise(edges):
            for x, w in zip((a + b) / 2 + (b - a) / 2 * node, (b - a) / 2 * weight, strict=True):
                if isinstance(load.per_length, tuple):
                    value = sum(c * x**k for k, c in enumerate(load.per_length))
                else:  # the two lines of RAMP
                    value = 1.0 + 2.0 * x if x < 0.5 else -1.0 + 4.0 / 0.7 * (x - 0.5)
                points.append((x, (0.0, w * value), 0.0))
    else:
        points.append((BEAM.length, load.tip, float(load.tip_moment)))
    found = np.zeros(len(q))
    for x, (fx, fy), moment in points:
        turn = place(q, x)[2].real if follower else 0.0
        force = math.cos(turn) * fx - math.sin(turn) * fy, math.sin(turn) * fx + math.cos(turn) * fy
        for j in range(len(q)):
            moved = place(q + 1e-30j * np.eye(len(q))[j], x)
            found[j] += sum(f * m.imag for f, m in zip((*force, moment), moved, strict=True)) / 1e-30
    return found


@pytest.mark.parametrize(
    "boundary", ["clamped-free", "free-free(mass=0.3)", "pinned-guided", "clamped-pinned"]
)
def test_each_load_does_its_virtual_work(boundary: str) -> None:
    chain = bm.Chain(BEAM, boundary, 5, "gregory")
    for k, timed in enumerate(LOADS[:-1]):
        q, u = random_state(chain, k)
        force = virtual_work(chain, q, timed.load, follower=timed.follower)
        expected = dense_accelerations(chain, q, u, None, 1.7 * force)
        found, power = forward_dynamics(chain, loads=[timed])(q, u, [*STILL, 1.7])
        np.testing.assert_allclose(found.full()[:, 0], expected, rtol=1e-9, atol=1e-9 * abs(expected).max())
        assert float(power) == pytest.approx(1.7 * force @ u, rel=1e-11)
    # Gravity and axial force, as a constant load gives them.
    q, u = random_state(chain, 9)
    constant = forward_dynamics(chain, load=LOADS[-1].load)(q, u, STILL).full()  # type: ignore[arg-type]
    found, _ = forward_dynamics(chain, loads=LOADS[-1:])(q, u, [*STILL, 1.0])
    np.testing.assert_allclose(found.full(), constant, rtol=1e-10, atol=1e-9)


def shaken(chain: bm.Chain, loads: Any, **given: Any) -> Any:
    return bm.simulate(chain, load=loads, output_step=0.1, **given)


def test_every_method_finds_the_same_motion_and_work() -> None:
    # Large turns under all loads at once, each with a course of its own, a pulse that jumps between steps,
    # springs at an end, a base that moves and damping. Against DOP853 at 1e-12.
    courses = [
        bm.Sine(4.0, 0.3, 0.01),
        bm.Pulse(0.0713, 0.0307),
        bm.Chirp(1.0, 9.0, 0.15),
        bm.Step(0.05, 0.02),
    ]
    courses += [lambda t: np.cos(30 * t), bm.Table((0.0, 0.1, 0.1, 0.3), (0.0, 1.0, -1.0, 0.5)), None]
    loads = [
        bm.TimedLoad(each.load, courses[k % 7], follower=each.follower)  # type: ignore[arg-type]
        for k, each in enumerate(LOADS)
    ]
    chain = bm.Chain(BEAM, "clamped-free(translational_stiffness=3, mass=0.1)", 3)
    given: dict[str, Any] = {
        "base": bm.BaseMotion(y=bm.bang_bang(0.05, 0.11, 0.013)),
        "damping": bm.Damping(stiffness=1e-4),
    }
    best = shaken(chain, loads, duration=0.12, integrator="dop853", tolerance=1e-12, **given)
    for method, order in (("rk4", 4), ("midpoint", 2), ("sdirk2", 2)):
        coarse, fine = (
            shaken(chain, loads, duration=0.12, integrator=method, step=step, **given)
            for step in (4e-4, 2e-4)
        )
        # Errors fall with the method's order: every step ends at a jump, none spans it.
        for name in ("q", "load_work"):
            off = [float(abs(each[name] - best[name]).max()) for each in (coarse, fine)]
            assert off[0] / off[1] == pytest.approx(2.0**order, rel=0.25), (method, name)
        assert off[1] < 2e-6 * abs(best.load_work).max() * (1 if order == 4 else 300)


@pytest.mark.parametrize("method", ["rk4", "midpoint", "sdirk2"])
def test_work_and_energy_impulse_and_momentum_balance(method: str) -> None:
    # In free flight: a triangle of a pulse at an inner point, and a moment that begins at another.
    push = PointLoad(0.37, force=(3.0, 8.0))
    loads = [
        bm.TimedLoad(push, bm.Pulse(0.031, 0.0103, "triangle")),
        bm.TimedLoad(PointLoad(0.9, moment=0.2), bm.Step(0.02)),
    ]
    chain = bm.Chain(BEAM, "free-free", 5)
    step = 2e-5 if method == "rk4" else 1e-4
    motion = bm.simulate(chain, duration=0.06, load=loads, integrator=method, step=step)
    for name, force in (("momentum_x", 3.0), ("momentum_y", 8.0)):
        assert float(motion[name][-1]) == pytest.approx(force * 0.031 / 2, rel=1e-8)
    slack = {"rk4": 1e-7, "midpoint": 1e-7, "sdirk2": 2e-3}[method]
    work = motion.load_work
    assert float(work[-1]) > 0.01
    assert float(abs(motion.energy - work).max()) < slack * float(work[-1])
    # Dead forces far from large turns: r x F and the moment, summed over the output times.
    at = np.interp(0.37, chain.node_position, motion.x[0]), motion.time.values
    arm = [
        (motion[name].values @ np.array([0, 1, 0, 0, 0, 0]) * (1 - share))
        + motion[name].values @ np.array([0, 0, 1, 0, 0, 0]) * share
        for name, share in (("x", (0.37 - 0.24) / 0.24), ("y", (0.37 - 0.24) / 0.24))
    ]
    torque = loads[0].at(at[1]) * (arm[0] * 8.0 - arm[1] * 3.0) + loads[1].at(at[1]) * 0.2
    summed = trapezoid(torque, at[1])
    assert float(motion.angular_momentum[-1]) == pytest.approx(summed, rel=2e-4)


def test_a_settled_answer_is_the_frequency_response() -> None:
    # A cantilever of 1.2 m, 85 N m², 0.62 kg/m under 0.5 sin(2π 3 t) N at its tip with 1 % damping in its
    # first two modes: 0.5 |H| of forty exact modes with the same damping; 5.91676 mm with 1 % in every mode.
    modes = bm.euler_bernoulli(BEAM, "clamped-free", 40)
    omega, tip, rate = modes.angular_frequency, modes.shape([1.2])[:, 0], 2 * math.pi * 3.0
    alpha, beta = 0.02 / (omega[0] + omega[1]) * np.array([omega[0] * omega[1], 1.0])
    ratio = alpha / (2 * omega) + beta * omega / 2
    exact = 0.5 * abs(np.sum(tip**2 / (omega**2 - rate**2 + 2j * ratio * omega * rate)))
    assert exact == pytest.approx(5.91676e-3, rel=1e-6)
    motion = bm.simulate(
        bm.Chain(BEAM, "clamped-free", 8, "gregory"),
        duration=8.0,
        load=bm.TimedLoad(bm.Load(tip_force=0.5), bm.Sine(frequency=3.0)),
        damping=bm.Damping(mass=alpha, stiffness=beta),
        integrator="sdirk2",
        modes=1,
    )
    late = motion.time.values > 4.0
    time = motion.time.values[late]
    # The first mode has not yet died out.
    dying = np.exp((1j - 0.01) * omega[0] * time)
    waves = np.stack([np.sin(rate * time), np.cos(rate * time), dying.real, dying.imag], axis=1)
    parts = np.linalg.lstsq(waves, motion.tip_deflection.values[late], rcond=None)[0]
    assert float(np.hypot(*parts[:2])) == pytest.approx(exact, rel=1e-3)


def test_a_thrust_that_follows_the_tip_grows_at_the_rate_of_the_flutter() -> None:
    # Beyond Beck's load, from a small start: over one period of the growing pair λ the motion becomes
    # e^(Re λ T) times itself, λ of the linear model under such a force.
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", 6, "gregory")
    start = bm.mode_start(chain, 1, 1e-9)
    for thrust in (18.0, 22.0):
        pair = bm.follower_modes(chain, thrust).isel(mode=0)
        push = bm.TimedLoad(bm.Load(tip_force=(-thrust, 0.0)), follower=True)
        motion = bm.simulate(chain, duration=3.0, load=push, initial=start, step=5e-4, output_step=5e-4)
        if pair.growth_rate < 1e-6:
            assert float(abs(motion.angle).max()) < 1e-8
            continue
        rate, period = float(pair.growth_rate), 2 * math.pi / float(pair.angular_frequency)
        angle = motion.angle.values[:, -1]
        late = np.interp(motion.time.values - period, motion.time.values, angle)
        at = motion.time.values > 2.9 - period
        factor = float(angle[at] @ late[at] / (late[at] @ late[at]))
        assert factor == pytest.approx(math.exp(rate * period), rel=2e-3) and factor > 2.0


def test_waveforms_have_their_areas_jumps_and_rates() -> None:
    time = np.linspace(0.0, 4.0, 400_001)
    for shape, area in (("rectangle", 1.0), ("triangle", 0.5), ("half_sine", 2 / math.pi)):
        pulse = bm.Pulse(1.5, 0.5, shape)
        assert trapezoid(pulse(time), time) == pytest.approx(1.5 * area, rel=1e-5)
        assert pulse(np.array([0.49, 2.01])).tolist() == [0.0, 0.0]
    # A chirp's phase grows at its frequency: zeros of sin where turns are halves.
    chirp = bm.Chirp(2.0, 6.0, 4.0)
    crossings = time[1:][np.diff(np.sign(chirp(time))) != 0]
    assert abs(len(crossings) - 2 * (2.0 + 6.0) / 2 * 4.0) <= 1 and chirp.fastest == 12 * math.pi
    assert bm.Step(1.0)(np.array([1.0 - 1e-12, 1.0])).tolist() == [0.0, 1.0]
    # Each tells all times at which it or its slope jumps: second differences are small elsewhere.
    for wave in (
        bm.Step(1.0, 0.5),
        bm.Pulse(1.0, 0.25, "triangle"),
        bm.Sine(0.5, 0.4, 1.0),
        bm.Chirp(0, 1, 2, 1),
    ):
        assert isinstance(wave, tuple(bm.WAVEFORMS.values()))
        grid = time[::100] + 0.00037
        rough = grid[1:-1][abs(np.diff(wave(grid), 2)) > 1e-4]
        assert len(rough) and max(min(abs(t - at) for at in wave.breaks) for t in rough) < 2e-3
    assert set(bm.WAVEFORMS) == {"step", "sine", "pulse", "chirp"}


def test_courses_from_rest_to_rest() -> None:
    for course in (bm.bang_bang(-2.0, 3.0, 0.5), bm.point_to_point(-2.0, 3.0, 0.5)):
        assert_derivatives(course, np.array([0.2, 0.9, 1.7, 2.2, 3.3, 3.9]), 2.0)
        ends = np.array(course(np.array([0.5, 3.5])))
        assert ends[0].tolist() == [0.0, -2.0] and not ends[1].any()
        assert bm.BaseMotion(x=course).jumps == course.breaks  # type: ignore[attr-defined]
    time = np.linspace(0.5, 3.5, 3001)[:-1]
    most = [abs(course(2.0, 3.0, 0.5)(time)[2]).max() for course in (bm.bang_bang, bm.point_to_point)]
    assert most == pytest.approx([8 / 9, 10 / math.sqrt(3) * 2 / 9], rel=1e-6)


def test_steps_know_how_fast_loads_vary() -> None:
    def took(segments: int, course: Any, kind: str | None, span: float) -> Chosen:
        chain = bm.Chain(BEAM, "clamped-free", segments)
        drive = TimeInputs(bm.BaseMotion(), (bm.TimedLoad(bm.Load(tip_force=0.1), course),))
        start = np.zeros(segments), np.zeros(segments)
        return chosen(Motion(chain, span, bm.Load(), drive, None, start), kind, span / 1000)

    omega = bm.solve_modes(bm.linearize(bm.Chain(BEAM, "clamped-free", 60)), 3).angular_frequency
    reached, fast = accuracy_limit("midpoint"), 2 * math.pi * 5000.0
    slow = took(60, bm.Sine(1.0), "midpoint", 5.0)
    assert "mode 3" in slow.reason and slow.step * omega[2] == pytest.approx(reached, rel=0.1)
    # Ready courses tell their rate, others are sampled.
    for course in (bm.Sine(5000.0), lambda t: np.sin(fast * t)):
        found = took(60, course, "midpoint", 0.02)
        assert "the variation of load 1" in found.reason
        assert found.step * fast == pytest.approx(reached, rel=0.2)
    # Runge-Kutta, whose stable steps for one slow segment are much too long for the load.
    found = took(1, bm.Sine(5000.0), None, 2.0)
    assert found.integrator == "rk4" and found.step * fast <= accuracy_limit("rk4") < 2.0 / 1000 * fast


def test_meshes_end_steps_at_jumps() -> None:
    drive = TimeInputs(
        bm.BaseMotion(),
        (
            bm.TimedLoad(bm.Load(tip_force=1.0), bm.Pulse(0.5, 0.25)),
            bm.TimedLoad(bm.Load(tip_force=1.0), lambda t: t, breaks=[0.3 + 1e-12, 0.61]),
        ),
    )
    at, lengths, whole = drive.mesh(0.1, 2, 6)
    np.testing.assert_allclose(at, [0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.61, 0.7, 0.75], atol=1e-11)
    np.testing.assert_allclose(np.cumsum(lengths) + 0.2, [*at[1:], 0.8], atol=1e-11)
    assert whole.tolist() == [False, True, True, True, True, False, True, False, True]
    # At a jump the stages of the step before see the value before it, those of the step after that after it.
    factors = drive.stages(at, lengths, [0.0, 0.5, 1.0])[:, 9]
    np.testing.assert_array_equal(factors, np.outer([1, 1, 1], [0, 1, 1, 1, 1, 1, 1, 1, 0]))


def test_what_is_not_a_load_is_refused_by_name() -> None:
    chain, tip = bm.Chain(BEAM, "clamped-free", 2), bm.Load(tip_force=1.0)
    joint = PointLoad(joint="a", force=(1.0, 0.0))
    for make, words in (
        (lambda: bm.TimedLoad(1.0), "load must be a Load, a PointLoad or a LineLoad"),  # type: ignore[arg-type]
        (lambda: bm.TimedLoad(tip, 3.0), "course must be a function"),  # type: ignore[arg-type]
        (lambda: bm.TimedLoad(bm.Load(spin_rate=1.0)), "load must have no spin_rate"),
        (lambda: bm.TimedLoad(bm.Load(gravity=1.0), follower=True), "follower must be False"),
        (lambda: bm.TimedLoad(joint), "load must be on a beam"),
        (lambda: bm.TimedLoad(tip, breaks=[-1.0]), "breaks must not be negative"),
        (lambda: bm.Load(tip_force=bm.Sine(1.0)), "tip_force must be a number.*TimedLoad"),  # type: ignore[arg-type]
        (lambda: read_loads([tip, tip]), "at most one Load"),
        (lambda: bm.simulate(chain, duration=1.0, load=PointLoad(1.3, force=1.0)), "x must be on the beam"),
        (lambda: bm.simulate(chain, duration=1.0, load=[3.0]), "load must be a Load.* got 3.0"),  # type: ignore[list-item]
        (lambda: bm.simulate(chain, duration=1.0, load=bm.TimedLoad(tip, np.sum)), "course must give"),  # type: ignore[arg-type, return-value]
    ):
        with pytest.raises((TypeError, ValueError), match=words):
            make()


def test_a_course_of_single_times_is_told_what_to_become() -> None:
    timed = bm.TimedLoad(bm.PointLoad(0.5, force=1.0), lambda t: 1.0 if t < 0.01 else 0.0)
    with pytest.raises(ValueError, match=r"course must give .* \(np.sin, not math.sin; np.where, not if"):
        timed.at(np.array([0.0, 0.1]))
    with pytest.raises(TypeError, match="course must be a function of time, a Table or None, got <class"):
        bm.TimedLoad(bm.PointLoad(0.5, force=1.0), bm.Sine)


def test_a_jump_that_is_not_told_is_remarked() -> None:
    chain, tip = bm.Chain(bm.Beam.unit(), "clamped-free", segments=1), bm.PointLoad(1.0, force=1.0)
    for breaks, words in (((), "load 1 changes by more than half its range"), ((0.5,), "")):
        load = bm.TimedLoad(tip, lambda t: np.where(t < 0.5, 0.0, 1.0), breaks=breaks)
        remark = bm.simulate(chain, duration=1.0, step=0.01, load=load).remark
        assert remark.startswith(words) and bool(remark) == bool(words)
