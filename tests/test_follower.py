"""Chains under a force that follows their tip: Beck's column, and what dampers do to it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from scipy.optimize import brentq, fsolve

import beammodes as bm


def characteristic(push: float, omega: float) -> float:
    """Beck's: y = A (cos ax - cosh bx) + B (sin ax/a - sinh bx/b), y'' = y''' = 0 at x = 1, ab = ω."""
    root = math.hypot(push / 2, omega)
    a, b = math.sqrt(root + push / 2), math.sqrt(root - push / 2)
    # y'' with its sign turned.
    second = (a * a * math.cos(a) + b * b * math.cosh(b), a * math.sin(a) + b * math.sinh(b))
    third = (a**3 * math.sin(a) - b**3 * math.sinh(b), -(a**2) * math.cos(a) - b**2 * math.cosh(b))
    return second[0] * third[1] - second[1] * third[0]


def becks() -> tuple[float, float]:
    """Where two roots ω of it meet."""

    def meeting(at: np.ndarray) -> list[float]:
        push, omega = map(float, at)
        step = 1e-4
        slope = characteristic(push, omega + step) - characteristic(push, omega - step)
        return [characteristic(push, omega), slope / (2 * step)]

    push, omega = fsolve(meeting, [20.0, 11.0], xtol=1e-12)
    return float(push), float(omega)


@pytest.mark.parametrize(("rule", "order"), [("mitiguy", 2), ("half_stub", 2), ("naive", 1)])
def test_becks_column_flutters_where_two_of_its_frequencies_meet(rule: str, order: int) -> None:
    push, omega = becks()
    assert abs(push - 20.0509536) < 1e-6 and abs(omega - 11.01556) < 1e-4  # Beck 1952: 20.05
    beam = bm.Beam(2.0, 3.0, 0.7)
    found = [bm.flutter_load(bm.Chain(beam, "clamped-free", n, rule)) for n in (20, 40, 80)]
    errors = np.array([each.compression / (3.0 / 4.0) for each in found]) / push - 1
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), order, atol=0.02)
    if order == 2:
        assert abs((4 * errors[2] - errors[1]) / 3) < 1e-6
        turning = found[2].angular_frequency / math.sqrt(3.0 / 0.7 / 16)
        assert found[2].is_flutter and abs(turning / omega - 1) < 1e-3


def test_eigenvalues_are_those_of_matrices_in_the_nodes_deflections() -> None:
    chain = bm.Chain(bm.Beam(1.3, 2.0, 0.7), "clamped-free(mass=0.3)", 6, "gregory")
    damping, push = bm.Damping(mass=0.2, stiffness=0.01), 9.0
    model = bm.linearize(chain, load=bm.Load(axial_force=-push))
    bare = bm.linearize(chain).stiffness_matrix
    mass, stiffness = model.mass_matrix, model.stiffness_matrix.copy()
    # The tip is pushed down by P times the last segment's slope.
    length = chain.length[-1]
    stiffness[-1, -2:] += push * np.array([-1.0, 1.0]) / length
    drag, size = damping.mass * mass + damping.stiffness * bare, len(mass)
    whole = np.block(
        [[np.zeros_like(mass), np.eye(size)], [-np.linalg.solve(mass, np.hstack([stiffness, drag]))]]
    )
    wanted = scipy.linalg.eigvals(whole)
    found = bm.follower_modes(chain, push, damping=damping)
    values = found.growth_rate.values + 1j * found.angular_frequency.values
    wanted = wanted[wanted.imag >= 0]
    np.testing.assert_allclose(values, wanted[np.argsort(abs(wanted))], rtol=1e-8)


def test_a_little_damping_of_the_joints_halves_becks_load_and_air_does_not() -> None:
    # V. V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability (1963): 10.94 EI/L² as
    # internal damping vanishes.
    column = bm.Chain(bm.Beam.unit(), "clamped-free", 60)
    inside, outside = (
        bm.flutter_load(column, damping=each) for each in (bm.Damping(stiffness=1e-6), bm.Damping(mass=1e-6))
    )
    assert abs(inside.compression - 10.94) < 0.01
    assert abs(outside.compression / bm.flutter_load(column).compression - 1) < 1e-3


def test_a_tip_that_is_held_across_makes_the_force_a_dead_one() -> None:
    chain = bm.Chain(bm.Beam.unit(), "clamped-pinned", 12, "gregory")
    found = bm.flutter_load(chain)
    assert abs(found.compression / bm.buckling_load(chain) - 1) < 1e-9
    assert not found.is_flutter
    assert bm.follower_modes(chain, 0.99 * found.compression).stable == 1
    with pytest.raises(ValueError, match="boundary must hold the chain"):
        bm.flutter_load(bm.Chain(bm.Beam.unit(), "free-free", 4))


def test_a_motion_under_the_force_grows_as_its_eigenvalue_says() -> None:
    column = bm.Chain(bm.Beam.unit(), "clamped-free", 5)
    modes = bm.follower_modes(column, 24.0)
    growth, omega = (float(modes[name][0]) for name in ("growth_rate", "angular_frequency"))
    assert growth > 1
    period = 2 * math.pi / omega
    thrust = bm.TimedLoad(bm.Load(tip_force=(-24.0, 0.0)), follower=True)
    start = bm.mode_start(column, 1, 1e-6)
    motion = bm.simulate(
        column, duration=3 * period, initial=start, load=thrust, step=period / 2000, output_step=period
    )
    last, before = motion.q.values[-1], motion.q.values[-2]
    np.testing.assert_allclose(last / before, math.exp(growth * period), rtol=1e-2)


def test_one_rod_on_a_hinge_is_never_pushed_over_and_two_flutter_where_their_roots_meet() -> None:
    # Of one rod the force passes through the hinge. Of two, in unit ω²: det of a matrix linear in P.
    with pytest.raises(ValueError, match="lose its stability"):
        bm.flutter_load(bm.Chain(bm.Beam.unit(), "clamped-free", 1))
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", 2, "double_wall")
    model, length = bm.linearize(chain), 0.5
    turn = np.array([[1.0, 0.0], [-1.0, 1.0]]) / length
    push = length * turn.T @ turn - np.outer([0.0, 1.0], turn[1])

    def meeting(force: float) -> float:
        pencil = np.linalg.solve(model.mass_matrix, model.stiffness_matrix - force * push)
        return float(np.trace(pencil) ** 2 - 4 * np.linalg.det(pencil))

    assert abs(bm.flutter_load(chain).compression / brentq(meeting, 1.0, 15.0) - 1) < 1e-9


def test_one_motion_is_followed_to_its_verge_and_the_free_end_comes_last() -> None:
    # Two links of L/2 and one spring k = 2 EI/L fall over at 4 k/L.
    two = bm.flutter_load(bm.Chain(bm.Beam.unit(), "pinned-pinned", 2))
    assert (two.compression, two.is_flutter) == (pytest.approx(8.0, rel=1e-12), False)
    with pytest.raises(ValueError, match="name the free end last"):
        bm.flutter_load(bm.Chain(bm.Beam.unit(), "free-clamped", 6))
