"""The step-size study: what theory says of a step, integrated; and the tables beside the published ones."""

from __future__ import annotations

import math
import re
from pathlib import Path

import casadi
import numpy as np
import pytest
import xarray
from computed_studies import computed

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.forward_dynamics import forward_dynamics
from beammodes.dynamics.runs import runge_kutta
from beammodes.dynamics.simulation import mode_start
from beammodes.problem.beam import Beam
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import (
    INTEGRATORS,
    accuracy_limit,
    amplification,
    find_integrator,
    stability_limit,
)
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import (
    highest_angular_frequency,
    published_time_step,
    stable_time_step,
)
from studies import step_size
from studies.c_table import SAFE_CONSTANT, step_constants
from studies.compare import RELATIVE, rows_of
from studies.step_size import ANALYSED, BOUNDARIES
from studies.step_trials import equal_start, largest_angles, modal_motion, variable_step_cost

FIGURES = Path(__file__).parent.parent / "figures"
RK4 = 2 * math.sqrt(2)


def chain(boundary: str, segments: int) -> Chain:
    return Chain(Beam.unit(), boundary, segments=segments)


@pytest.mark.parametrize(
    ("boundary", "segments", "constant"),
    # theory.md section 6.
    [
        ("clamped-free", 4, 0.0305),
        ("clamped-free", 10, 0.00424),
        ("clamped-clamped", 4, 0.0324),
        ("clamped-clamped", 10, 0.00427),
    ],
)
def test_stable_constants(boundary: str, segments: int, constant: float) -> None:
    stable, _ = step_constants(chain(boundary, segments), 1)
    assert float(f"{stable:.3g}") == constant
    assert stable == pytest.approx(RK4 / highest_angular_frequency(chain(boundary, segments)), rel=1e-12)
    assert SAFE_CONSTANT / segments**2 < stable


def test_a_longer_beam_has_the_same_constant() -> None:
    beam = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    found = step_constants(Chain(beam, "clamped-free", segments=3), 2, damping_ratio=0.01)
    expected = step_constants(chain("clamped-free", 3), 2, damping_ratio=0.01)
    assert found[0] == pytest.approx(expected[0], rel=1e-10)
    assert found[1] == pytest.approx(expected[1], rel=1e-10)


def test_amplification_of_one_step() -> None:
    assert abs(amplification("rk4", 1.01 * RK4)) == pytest.approx(1.073, abs=5e-4)
    z = np.array([-0.01 + 0.02j])
    size, ratio = abs(z), float(0.01 / abs(z[0]))
    for name, record in INTEGRATORS.items():
        if not record.variable_step:
            # The local error is of the order's next power.
            error = abs(amplification(name, size, ratio) - np.exp(z)).max()
            assert error < 2 * size[0] ** (1 if record.stages == () else record.order) * size[0], name
            assert abs(amplification(name, np.array([1e-4]), 0.0) - np.exp(1e-4j)).max() < 1e-8
    # Leapfrog turns by 2 arcsin(ωh/2) and grows beyond 2.
    turned = amplification("leapfrog", np.array([0.5, 1.99, 2.02]))
    assert np.angle(turned[:2]) == pytest.approx(2 * np.arcsin([0.25, 0.995]))
    assert abs(turned[:2]) == pytest.approx([1, 1])
    assert abs(turned[2]) > 1.2


@pytest.mark.parametrize("name", [name for name, each in INTEGRATORS.items() if not each.variable_step])
@pytest.mark.parametrize("ratio", [0.0, 0.03, 0.5, 1.0, 2.5])
def test_growth_begins_at_the_limit(name: str, ratio: float) -> None:
    """Two routes: the limit in closed form or by a polynomial, and |R| of the step on both its sides."""
    limit = stability_limit(name, ratio)
    inside = np.linspace(1e-3, 1 - 1e-9, 500) * (limit if math.isfinite(limit) else 1e4)
    assert abs(amplification(name, inside, ratio)).max() < 1 + 1e-12
    if math.isfinite(limit):
        assert abs(amplification(name, max(limit, 0.1) * np.array([1.0001, 1.5]), ratio)).min() > 1


def test_every_name_of_an_engine_is_of_one_integrator() -> None:
    names = [alias for record in INTEGRATORS.values() for alias in record.engines]
    assert len(names) == len(set(names))
    for record in INTEGRATORS.values():
        assert {record.springs, record.damping} <= {"explicit", "implicit"} and record.source
        for alias in (*record.engines, record.name):
            assert find_integrator(alias) == find_integrator(alias.upper()) == record
    # An engine alone is answered with what it has.
    for alias in (each for each in names if " " in each):
        engine = alias.split(" ")[0]
        if engine in names:
            continue
        with pytest.raises(ValueError, match=rf"must be one of .*{re.escape(alias)}.*, got '{engine}'"):
            find_integrator(engine)


def test_stability_limits() -> None:
    assert stability_limit("rk4") == pytest.approx(RK4)
    assert stability_limit("leapfrog") == 2.0
    assert stability_limit("midpoint", 0.3) == math.inf
    # The real interval of fourth-order Runge-Kutta: the real root of 1 + z/2 + z²/6 + z³/24 = 0.
    assert stability_limit("rk4", 1.0) == pytest.approx(2.785293563405282, rel=1e-9)
    assert stability_limit("rk4", 1e-9) == pytest.approx(RK4, rel=1e-6)
    assert stability_limit("rk4", 3.0) == pytest.approx(2.785293563405282 / (3 + math.sqrt(8)), rel=1e-9)


def test_accuracy_limits_meet_what_they_promise() -> None:
    # Frequency errors of small steps: -(ωh)²/12 for the midpoint rule, (ωh)²/24 for leapfrog.
    assert accuracy_limit("midpoint") == pytest.approx(math.sqrt(12e-3), rel=2e-3)
    assert accuracy_limit("leapfrog") == pytest.approx(math.sqrt(24e-3), rel=2e-3)
    y = accuracy_limit("rk4")
    size = abs(amplification("rk4", y))
    assert size ** (200 * math.pi / y) == pytest.approx(0.99, rel=1e-9)
    assert accuracy_limit("rk4", amplitude=10.0) == pytest.approx((120 * 1e-3) ** 0.25, rel=0.05)
    # With damping, by brute force over the whole time.
    ratio = 0.05
    y = accuracy_limit("rk4", ratio)
    z = y * complex(-ratio, math.sqrt(1 - ratio**2))
    k = np.arange(int(200 * math.pi / z.imag))
    error = abs(abs(amplification("rk4", y, ratio)) ** k - np.exp(z.real * k)).max()
    turn = abs(np.angle(amplification("rk4", y, ratio)) / z.imag - 1)
    assert max(error / 1e-2, turn / 1e-3) == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("call", [stability_limit, accuracy_limit])
@pytest.mark.parametrize(
    ("integrator", "ratio"), [("euler", 0.0), ("rk4", -0.1), ("rk45", 0.0), ("rk4", math.nan)]
)
def test_what_is_not_analysed_is_refused(call: object, integrator: str, ratio: float) -> None:
    with pytest.raises(ValueError, match=r"integrator|damping"):
        call(integrator, ratio)  # type: ignore[operator]


def test_an_overdamped_mode_has_no_frequency_to_keep() -> None:
    with pytest.raises(ValueError, match="below 1"):
        accuracy_limit("rk4", 1.0)


@pytest.mark.parametrize(
    ("boundary", "segments", "mode", "integrator"),
    [
        ("clamped-free", 4, 4, "rk4"),
        ("clamped-free", 2, 1, "rk4"),
        ("clamped-clamped", 3, 2, "rk4"),
        ("clamped-free", 4, 2, "midpoint"),
        ("clamped-clamped", 4, 1, "midpoint"),
    ],
)
def test_accuracy_limits_hold_in_simulation(boundary: str, segments: int, mode: int, integrator: str) -> None:
    one = chain(boundary, segments)
    omega = float(solve_modes(linearize(one), mode).angular_frequency[-1])

    def measured(y: float) -> tuple[float, float]:
        # The frequency takes fewer steps than 100 periods of them.
        count = round(200 * math.pi / y) if integrator == "rk4" else 1000
        motion = modal_motion(one, mode, y / omega, count, integrator=integrator)
        turn = np.unwrap(np.angle(motion))[-1] / (count * y) - 1
        return abs(float(turn)) / 1e-3, abs(abs(motion[-1]) - 1) / 1e-2

    limit = accuracy_limit(integrator)
    assert max(measured(limit)) == pytest.approx(1, abs=0.02)
    assert max(measured(0.9 * limit)) < 0.9
    assert max(measured(1.1 * limit)) > 1.1


@pytest.mark.parametrize(("boundary", "segments"), [("clamped-free", 8), ("clamped-clamped", 12)])
def test_damped_limits_hold_in_simulation(boundary: str, segments: int) -> None:
    one = chain(boundary, segments)
    ratio = 0.01
    first = float(solve_modes(linearize(one), 1).angular_frequency[0])
    limit, _ = step_constants(one, 1, damping_ratio=ratio)
    stepper = runge_kutta(one, damping=Damping(stiffness=2 * ratio / first))
    start = equal_start(one, 1e-6)
    assert largest_angles(stepper, start, 0.99 * limit, 2000).max() < 1e-5
    assert largest_angles(stepper, start, 1.02 * limit, 2000).max() > 1e-4
    # What is safe without damping is not with it.
    assert limit < SAFE_CONSTANT / segments**2


@pytest.mark.parametrize(("boundary", "segments"), [("clamped-free", 4), ("clamped-clamped", 5)])
def test_the_recipe_takes_steps_of_its_own(boundary: str, segments: int) -> None:
    one = chain(boundary, segments)
    asked, limit = published_time_step(one.beam, 1), stable_time_step(one)
    cost = variable_step_cost(one, asked, 2, tolerance=1e-3)
    assert cost.mean_step * cost.steps == pytest.approx(asked)
    assert 0.2 * limit < cost.mean_step < limit < asked / 10
    assert cost.evaluations > 6 * cost.steps
    assert cost.largest_angle < 0.2


def test_frequencies_about_a_folded_shape_are_higher() -> None:
    """Why a clamped-clamped chain diverges from 1 rad at a step that is stable for small motions."""
    one = chain("clamped-clamped", 4)
    acceleration, limit = forward_dynamics(one), stable_time_step(one)
    x = casadi.SX.sym("x", 8)
    rate = casadi.vertcat(x[4:], acceleration(x[:4], x[4:], casadi.DM.zeros(9)))
    slope = casadi.Function("slope", [x], [casadi.jacobian(rate, x)])
    for amplitude, low, high in ((0.01, 0.99, 1.01), (1.0, 2.5, 3.5)):
        start = np.concatenate(mode_start(one, 1, amplitude))
        states = runge_kutta(one).steps(start, limit / 20, 0.0, 4000, BaseMotion())
        highest = max(abs(np.linalg.eigvals(slope(s).full())).max() for s in states[::20])
        assert low < highest * limit / RK4 < high


def read(ending: str) -> list[dict[str, str]]:
    return rows_of(FIGURES / f"step_size{ending}")


def test_committed_growth() -> None:
    rows = read("_growth.csv")
    assert {(r["boundary"], int(r["segments"])) for r in rows} == {
        (boundary, n) for boundary in BOUNDARIES for n in range(1, 13)
    } - {("clamped-clamped", 1)}
    for row in rows:
        name, start, linear = row["fixed_step"], float(row["start"]), row["segments"] == "1"
        assert float(row["growth_at_1_01"]) == pytest.approx(1.073, abs=1e-3)
        if name in ("safe", "0.99") and start < 1:
            assert float(row["largest"]) < 10 and not row["tenfold"]
        if name == "1.01" and start == 1e-6:
            assert 20 < float(row["tenfold"]) < 100
            assert linear or 1e-3 < start * float(row["largest"]) < 0.1
        if name == "1.5" and not linear:
            assert float(row["overflow"]) < 100
        if name == "published 1" and not linear:
            assert float(row["step_over_limit"]) > 1.8 and float(row["overflow"]) < 10


def test_committed_recipe() -> None:
    rows = [r for r in read("_recipe.csv") if r["rtol"] == "0.001" and int(r["segments"]) >= 4]
    for row in rows:
        # From a fifth to all of the stable step, whatever it is told.
        assert 1 < float(row["steps"]) / float(row["step_over_limit_asked"]) < 3
    last = {r["recipe_modes"]: float(r["evaluations"]) for r in rows if r["segments"] == "12"}
    assert last["1"] > 1500 and last["3"] > 180


def test_committed_constants() -> None:
    rows = read(".csv")
    for row in rows:
        stable, accurate = float(row["C_stable"]), float(row["C_accurate"])
        assert float(row["C"]) == pytest.approx(min(stable, accurate), rel=RELATIVE)
        if row["damping_ratio"] == "0" and row["integrator"] == "rk4":
            assert float(row["C_safe"]) < stable
            # The corrected rule: never above what is stable and accurate.
            beam = next(
                float(r["C_beam"])
                for r in read("_modes.csv")
                if (r["boundary"], r["integrator"], r["modes"]) == (row["boundary"], "rk4", row["modes"])
            )
            assert min(beam, float(row["C_safe"])) <= float(row["C"])
            assert float(row["C_published"]) > float(row["C"])
    assert {row["integrator"] for row in rows} == set(ANALYSED)


@pytest.fixture(scope="module")
def table() -> xarray.Dataset:
    return computed("step_size")


@pytest.mark.slow
def test_the_drawing_shows_the_data(table: xarray.Dataset) -> None:
    constants, growth, recipe = step_size.STUDY.picture(table).axes
    stable = table.C_stable.sel(boundary="clamped-free", integrator="rk4", damping_ratio=0.0)
    assert any(np.array_equal(line.get_ydata(), stable) for line in constants.get_lines())
    assert growth.get_ylabel().startswith("largest angle")
    asked = table.evaluations.sel(boundary="clamped-free", rtol=1e-3, recipe_modes=1)
    assert any(np.array_equal(line.get_ydata(), asked) for line in recipe.get_lines())
