"""Chains between two points nearer than they are long: cables, arches, buckled strips, and their vibration.

The judges share nothing with the chain: the catenary, elliptic integrals, a collocated boundary-value problem
of the elastic line with its weight, and Chebyshev collocation of its small vibration.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion, harmonic
from beammodes.dynamics.simulation import mode_start, simulate
from beammodes.equations.equilibria import Equilibrium, EquilibriumNotFound, find_equilibrium
from beammodes.equations.mechanics import Algebra, energies
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

FIGURES = Path(__file__).parents[1] / "figures"
SPRUNG = (End(math.inf, 4.0), End(math.inf, 1.5))


def cable(stiffness: float, segments: int, boundary: str = "pinned-pinned") -> Equilibrium:
    """The cable of a user's question: 1000 m, 1962 N/m, between points 800 m apart and 100 m in height."""
    chain = Chain(Beam(1000.0, stiffness, 200.0), boundary, segments)
    return find_equilibrium(chain, Load(gravity=9.81), span=(800.0, 100.0))


def catenary() -> float:
    """Its horizontal force without stiffness:  √(L² - d²) = 2 a sinh(X/2a),  H = w a."""
    return 1962.0 * brentq(lambda a: math.sqrt(1e6 - 1e4) - 2 * a * math.sinh(400 / a), 50, 1e5, xtol=1e-12)


def test_a_cable_without_stiffness_hangs_as_the_catenary_to_second_order() -> None:
    assert abs(catenary() / 671477.584249241 - 1) < 1e-12  # the question's expected value
    hung = cable(1e5, 200)
    assert abs(hung.multipliers[0] / catenary() - 1) < 1e-5
    # T = H/cos θ of a string.
    np.testing.assert_allclose(hung.tension * np.cos(hung.angle), catenary(), rtol=1e-4)
    errors = np.array([cable(1e-2, n).multipliers[0] for n in (20, 40, 80)]) / catenary() - 1
    assert abs(errors[-1]) < 1e-4
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2, atol=0.02)


@pytest.mark.parametrize(
    ("boundary", "order"),
    [pytest.param("pinned-pinned", 1.0, marks=pytest.mark.slow), ("clamped-clamped", 0.5)],
)
def test_stiffness_changes_the_pull_by_its_first_power_between_pins_and_its_root_between_clamps(
    boundary: str, order: float
) -> None:
    # A clamp bends the cable over the length √(EI/T), a pin does not.
    none, less, more = (cable(s, 120, boundary).multipliers[0] for s in (1e-2, 6.4e7, 2.56e8))
    np.testing.assert_allclose(math.log(abs((more - none) / (less - none)), 4), order, atol=0.06)


# --- The elastic line with its weight, as a boundary-value problem ----------------------------------------


def exact(found: Equilibrium, weight: float) -> Any:
    """Solve EI θ'' = F_x sin θ - F_y cos θ, x' = cos θ, y' = sin θ, F_y' = w, from near a chain's shape."""
    ends = (found.chain.boundary.left, found.chain.boundary.right)
    x, y = found.span or (math.nan, math.nan)

    def line(s: np.ndarray, state: np.ndarray) -> np.ndarray:
        angle, bend, _, _, fx, fy = state
        none = np.zeros_like(s)
        return np.stack(
            [bend, fx * np.sin(angle) - fy * np.cos(angle), np.cos(angle), np.sin(angle), none, none + weight]
        )

    def held(left: np.ndarray, right: np.ndarray) -> np.ndarray:
        turning = [
            angle if end.holds_rotation else bend - sign * float(end.rotational_stiffness) * angle
            for end, (angle, bend), sign in zip(ends, (left[:2], right[:2]), (1.0, -1.0), strict=True)
        ]
        return np.array([left[2], left[3], right[2] - x, right[3] - y, *turning])

    middle = (np.cumsum(found.chain.length) - found.chain.length / 2) / found.chain.length.sum()
    s = np.linspace(0.0, 1.0, 201)
    angle = np.interp(s, middle, found.angle)
    place = [np.interp(s, found.chain.node_position, each) for each in found.nodes.T]
    fx, fy = found.multipliers
    start = np.stack([angle, np.gradient(angle, s), *place, np.full_like(s, fx), fy - weight * (1 - s)])
    solved = solve_bvp(line, held, s, start, tol=1e-8, max_nodes=20000)
    assert solved.success
    return solved


CASES = [
    ("pinned-pinned", (0.8, 0.1), 300.0, "sag", True),
    ("clamped-clamped", (0.7, -0.3), 150.0, "sag", True),
    pytest.param("clamped-pinned", 0.95, 15.0, "arch", True, marks=pytest.mark.slow),
    (SPRUNG, (0.5, 0.4), 20.0, -1, True),
    pytest.param("pinned-pinned", 0.6, 100.0, "arch", False, marks=pytest.mark.slow),
    ("clamped-clamped", (0.8, 0.1), 10.0, -2, False),
]


@pytest.mark.parametrize(("boundary", "span", "weight", "branch", "stable"), CASES)
def test_shapes_pulls_and_modes_of_every_branch_converge_on_the_elastic_line(
    boundary: Any, span: Any, weight: float, branch: Any, stable: bool
) -> None:
    values, judged = [], np.empty(0)
    for count in (64, 32, 16):
        chain = Chain(Beam.unit(), boundary, count, "gregory")
        found = find_equilibrium(chain, Load(gravity=weight), span=span, branch=branch)
        assert found.is_stable is stable and found.residual < 1e-11
        middle = np.argmin(abs(chain.node_position - 0.5))
        modes = solve_modes(linearize(chain, at=found), 3).angular_frequency if stable else np.empty(0)
        values.append(np.concatenate([found.multipliers, found.nodes[middle], modes]))
        if count == 64:
            line = exact(found, weight)
            pull = line.y[4:, -1]
            judged = np.concatenate([pull, line.sol(0.5)[2:4], vibration(line, Boundary.of(boundary))])
    scale = np.concatenate([[np.abs(values[0][:2]).max()] * 2, [1.0, 1.0], values[0][4:]])
    fine, mid, coarse = (np.abs(each - judged[: len(each)]) / scale for each in values)
    assert fine.max() < 2e-3
    if "clamped" not in str(boundary):
        shown = fine > 1e-6
        np.testing.assert_allclose(np.log2(mid[shown] / fine[shown]), 2, atol=0.2)
    # Near clamps the heavy cable bends within a few pieces: its order shows later.
    extrapolated = (4 * values[0] - values[1]) / 3
    np.testing.assert_allclose(extrapolated / scale, judged[: len(scale)] / scale, atol=5e-4)
    assert (fine < mid / 2.2 + 1e-5).all() and mid.max() < coarse.max() / 2


def test_buckled_strips_are_the_elastica_of_elliptic_integrals() -> None:
    # c/L = 2E/K - 1 and P = 4 n² K² EI/L² between pins; 4 times that, n = 2, between clamps at n = 1.
    square = brentq(lambda k: 2 * ellipe(k) / ellipk(k) - 1 - 0.5, 1e-6, 0.9, xtol=1e-14)
    pushed = 4 * float(ellipk(square)) ** 2
    errors = []
    for boundary, span, branch, waves, count in (
        ("pinned-pinned", (0.3, 0.4), 1, 1, 20),
        ("pinned-pinned", (0.3, 0.4), 1, 1, 40),
        ("pinned-pinned", 0.5, -3, 3, 30),
        ("pinned-pinned", 0.5, -3, 3, 60),
        ("clamped-clamped", 0.5, 1, 2, 40),
        ("clamped-clamped", 0.5, 1, 2, 80),
    ):
        strip = Chain(Beam.unit(), boundary, count, "gregory")
        found = find_equilibrium(strip, None, span=span, branch=branch)
        errors.append(math.hypot(*found.multipliers) / (waves**2 * pushed) - 1)
        assert found.is_stable is (branch == 1)
    coarse, fine = np.array(errors[::2]), np.array(errors[1::2])
    np.testing.assert_allclose(np.log2(coarse / fine), 2, atol=0.06)
    assert np.abs(fine).max() < 1e-2


def test_the_shallow_string_vibrates_as_irvine_says() -> None:
    # H. M. Irvine, Cable Structures (1981): without stretch ω = 2 x √(H/m)/L with tan x = x for symmetric
    # modes, x = nπ for others. What a sag changes falls with its square, and so with the slack.
    wanted = 2 * np.array([math.pi, brentq(lambda x: math.tan(x) - x, 4.4, 4.6), 2 * math.pi])
    off = []
    for slack in (0.02, 0.005):
        found = []
        for count in (40, 80):
            string = Chain(Beam(1.0, 1e-9, 1.0), "pinned-pinned", count)
            hung = find_equilibrium(string, Load(gravity=1.0), span=1.0 - slack)
            omega = solve_modes(linearize(string, at=hung), 3).angular_frequency
            found.append(omega / math.sqrt(hung.multipliers[0]))
        off.append((4 * found[1] - found[0]) / 3 / wanted - 1)
    assert np.abs(off[1]).max() < 0.02
    np.testing.assert_allclose(off[0] / off[1], 4, rtol=0.2)


def test_the_stiffness_about_a_shape_is_the_second_difference_of_its_energy_along_the_closures() -> None:
    chain = Chain(Beam(1.3, 2.0, 0.7), ("clamped", End(math.inf, 2.0)), 5)
    load = Load(gravity=(1.0, -3.0), tip_moment=0.4)
    found = find_equilibrium(chain, load, span=(1.0, -0.2))
    algebra = Algebra.physical(chain, math.sin, math.cos)

    def lagrangian(q: np.ndarray) -> float:
        stored = energies(chain, q.tolist(), [0.0] * len(q), algebra, load)
        x, y = np.cumsum(chain.length * [np.cos([0.0, *q]), np.sin([0.0, *q])], axis=1)[:, -1]
        return float(stored.potential) - float(found.multipliers @ [x, y])

    step, size = 1e-4, len(found.coordinates)
    shift = step * np.eye(size)
    value = [[lagrangian(found.coordinates + a + b) for b in (*shift, *-shift)] for a in (*shift, *-shift)]
    table = np.array(value)
    second = (table[:size, :size] - table[:size, size:]) / (2 * step**2)
    second = (second - (table[size:, :size] - table[size:, size:]) / (2 * step**2)) / 2
    np.testing.assert_allclose(second, found.tangent, atol=1e-6 * np.abs(found.tangent).max())
    np.testing.assert_allclose(found.nodes[-1], [1.0, -0.2], atol=1e-13)


def test_an_arch_sways_when_its_push_reaches_that_of_the_second_branch() -> None:
    # A shallow arch between pins loses its stability to two half waves, at P = 4π² EI/L² and some percent.
    strip = Chain(Beam.unit(), "pinned-pinned", 16)
    light, heavy = (find_equilibrium(strip, Load(gravity=g), span=0.98, branch="arch") for g in (20.0, 23.0))
    second = find_equilibrium(strip, None, span=0.98, branch=2)
    assert light.is_stable and not heavy.is_stable and heavy.nodes[:, 1].min() > -1e-12
    assert -light.multipliers[0] < -second.multipliers[0] < -heavy.multipliers[0]
    with pytest.raises(EquilibriumNotFound, match="snap through"):
        find_equilibrium(strip, Load(gravity=600.0), span=0.7, branch="arch")
    low = find_equilibrium(strip, Load(gravity=60.0), span=0.98)
    assert low.is_stable and low.nodes[:, 1].max() < 1e-12
    # From a shape on a branch on to a neighbour.
    again = find_equilibrium(strip, Load(gravity=61.0), span=(0.98, 0.01), guess=low)
    assert again.is_stable and again.nodes[8, 1] < 0


@pytest.mark.parametrize("integrator", ["rk4", "sdirk2", pytest.param("dop853", marks=pytest.mark.slow)])
def test_every_kind_of_integrator_swings_about_the_shape_at_the_frequency_of_its_modes(
    integrator: str,
) -> None:
    chain = Chain(Beam(1.0, 0.5, 2.0), ("clamped", SPRUNG[1]), 8, "gregory")
    load = Load(gravity=9.81)
    hung = find_equilibrium(chain, load, span=(0.8, 0.1))
    omega = float(solve_modes(linearize(chain, at=hung), 1).angular_frequency[0])
    start, period = mode_start(chain, 1, 1e-4, at=hung), 2 * math.pi / omega
    motion = simulate(
        chain,
        duration=period,
        initial=start,
        span=hung.span,
        load=load,
        integrator=integrator,
        step=period / 800,
    )
    away = motion.q.values - hung.coordinates
    large = np.abs(away[0]).max()
    np.testing.assert_allclose(away[-1], away[0], atol=1e-3 * large)
    np.testing.assert_allclose(away[len(away) // 2], -away[0], atol=1e-3 * large)
    np.testing.assert_allclose(motion.x[:, -1], 0.8, atol=1e-12)
    # At rest it stays, whatever method is chosen.
    still = simulate(chain, duration=period / 4, initial=hung, load=load)
    assert np.abs(still.q.values - hung.coordinates).max() < 1e-9


def test_a_cable_that_is_thrown_and_shaken_keeps_its_ends_and_its_energy() -> None:
    chain = Chain(Beam(1.0, 0.02, 2.0), "pinned-pinned", 8)
    thrown = find_equilibrium(chain, Load(gravity=9.81), span=(0.7, -0.2))
    # Gravity turns round: it flies up to the other side.
    load, ends = Load(gravity=-9.81), {}
    for integrator, step in (("rk4", 2e-4), ("midpoint", 1e-3), ("midpoint", 5e-4)):
        motion = simulate(chain, duration=0.3, initial=thrown, load=load, integrator=integrator, step=step)
        ends[integrator, step] = motion.y.values[-1]
        limit = 1e-6 if integrator == "rk4" else 1e-2
        assert np.ptp(motion.energy.values) < limit * motion.kinetic_energy.max()
    error = [np.abs(ends["midpoint", step] - ends["rk4", 2e-4]).max() for step in (1e-3, 5e-4)]
    assert ends["rk4", 2e-4][4] > thrown.nodes[4, 1] + 0.1 and error[0] < 2e-3
    np.testing.assert_allclose(error[0] / error[1], 4, rtol=0.2)
    shaken = {"initial": thrown, "load": Load(gravity=9.81), "base": BaseMotion(y=harmonic(0.05, 20.0))}
    one, other = (
        simulate(chain, duration=0.2, integrator=name, step=step, **shaken)
        for name, step in (("rk4", 2e-4), ("midpoint", 2e-4))
    )
    for motion in (one, other):
        np.testing.assert_allclose(motion.y[:, -1] - motion.y[:, 0], -0.2, atol=1e-11)
    np.testing.assert_allclose(one.y[-1], other.y[-1], atol=1e-4)
    with pytest.raises(ValueError, match="initial must be given with span"):
        simulate(chain, duration=0.1, span=0.7)


@pytest.mark.slow
def test_whatever_the_ends_the_place_and_the_weight_a_stable_shape_is_found() -> None:
    draw = np.random.default_rng(5)
    for _ in range(100):
        ends = [
            ("pinned", "clamped", End(math.inf, 10 ** draw.uniform(-2, 3)))[draw.integers(3)] for _ in "lr"
        ]
        rule = ("mitiguy", "gregory", "naive")[draw.integers(3)]
        chain = Chain(Beam.unit(), (ends[0], ends[1]), int(draw.integers(4, 60)), rule)
        chord, slope = 1 - 10 ** draw.uniform(-4, -0.1), draw.uniform(-1.5, 1.5)
        span = chord * math.cos(slope), chord * math.sin(slope)
        size, way = 10 ** draw.uniform(-2, 7), draw.uniform(-3, 3) * draw.integers(2)
        load = Load(gravity=(size * math.sin(way), -size * math.cos(way)))
        found = find_equilibrium(chain, load, span=span)
        assert found.is_stable
        np.testing.assert_allclose(found.nodes[-1], span, atol=1e-10)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"span": 1.0}, "span must be shorter than the chain, 1 m, got 1.0"),
        ({"span": (0.5, 0.5, 0.0)}, "span must be a number or a pair"),
        ({"chain": Chain(Beam.unit(), "clamped-free", 4)}, "boundary must hold both ends"),
        ({"load": Load(axial_force=1.0)}, "axial_force must be 0 with span"),
        ({"load": Load(tip_force=1.0)}, "tip_force must be 0 with span"),
        ({"branch": "sags"}, 'branch must be one of arch, sag, got "sags"|did you mean'),
        ({"branch": 0}, "got 0"),
        ({"branch": 4}, "branch must be the number of a buckling mode"),
        ({"span": None, "branch": 1}, "branch must be left out without span"),
    ],
)
def test_what_cannot_be_held_apart_is_named(change: dict[str, Any], message: str) -> None:
    given = {"chain": Chain(Beam.unit(), "pinned-pinned", 4), "load": None, "span": 0.9} | change
    with pytest.raises(ValueError, match=message):
        find_equilibrium(given.pop("chain"), given.pop("load"), **given)


def vibration(line: Any, boundary: Boundary, size: int = 40) -> np.ndarray:
    """Return the lowest angular frequencies about the line, by Chebyshev collocation of

    φ' = m,  m' = f_x sin θ - f_y cos θ + (F_x cos θ + F_y sin θ) φ,  u' = -φ sin θ,  v' = φ cos θ,
    f_x' = -ω² u,  f_y' = -ω² v.
    """
    k = np.arange(size + 1)
    nodes = (1 - np.cos(np.pi * k / size)) / 2
    weights = np.where((k == 0) | (k == size), 0.5, 1.0) * (-1.0) ** k
    apart = nodes[:, None] - nodes + np.eye(size + 1)
    slope = weights / weights[:, None] / apart
    np.fill_diagonal(slope, 0.0)
    np.fill_diagonal(slope, -slope.sum(axis=1))
    angle, _, _, _, fx, fy = line.sol(nodes)
    sine, cosine, one, none = (
        np.diag(np.sin(angle)),
        np.diag(np.cos(angle)),
        np.eye(size + 1),
        np.zeros_like(apart),
    )
    axial = np.diag(fx * np.cos(angle) + fy * np.sin(angle))
    left = np.block(
        [
            [slope, -one, none, none, none, none],
            [-axial, slope, none, none, -sine, cosine],
            [sine, none, slope, none, none, none],
            [-cosine, none, none, slope, none, none],
            [none, none, none, none, slope, none],
            [none, none, none, none, none, slope],
        ]
    )
    right = np.zeros_like(left)
    n = size + 1
    right[4 * n : 5 * n, 2 * n : 3 * n] = right[5 * n :, 3 * n : 4 * n] = -one
    # Each equation gives up one row, at an end, for one of the six conditions.
    conditions = [(2 * n, 2 * n), (3 * n, 3 * n), (5 * n - 1, 3 * n - 1), (6 * n - 1, 4 * n - 1)]
    for end, row, entry, sign in ((boundary.left, 0, 0, -1.0), (boundary.right, 2 * n - 1, size, 1.0)):
        conditions.append((row, entry if end.holds_rotation else n + entry))
        left[row] = right[row] = 0.0
        if not end.holds_rotation:
            left[row, entry] = sign * float(end.rotational_stiffness)
    for row, entry in conditions:
        if row >= 2 * n:
            left[row] = right[row] = 0.0
        left[row, entry] = 1.0
    found = scipy.linalg.eigvals(left, right)
    found = found[np.isfinite(found)]
    real = np.sort(found[(abs(found.imag) < 1e-6 * abs(found)) & (abs(found) < 1e6)].real)
    return np.sqrt(real[real > 0][:3])


def _rows(name: str) -> list[dict[str, str]]:
    with (FIGURES / name).open() as file:
        return list(csv.DictReader(file))


def test_the_figure_of_the_cable_tells_the_catenary_and_irvines_limits() -> None:
    rows = _rows("cable_slack.csv")
    least = [row for row in rows if row["slack"] == "0.001"]
    for row in least:
        # The sag's share and that of 60 rods.
        assert abs(float(row["ratio"]) / float(row["irvine"]) - 1) < 5e-3
    rest = {row["node"]: float(row["rest"]) for row in _rows("cable.csv") if row["axis"] == "y"}
    # y of the catenary at its lowest point: a (1 - cosh(x_0/a)), with the left end at -x_0 from there.
    a, rise = catenary() / 1962.0, 100.0
    left = 400 - a * math.asinh(rise / (2 * a * math.sinh(400 / a)))
    assert abs(min(rest.values()) - a * (1 - math.cosh(left / a))) < 0.2


def test_a_mode_about_a_held_shape_starts_a_motion_whose_ends_stay_held() -> None:
    chain, load = Chain(Beam(0.9, 31.0, 1.7), "pinned-pinned", 6), Load(gravity=9.81)
    hung = find_equilibrium(chain, load, span=np.array([0.5, 0.1]))
    start = mode_start(chain, 1, 0.01, at=hung)
    motion = simulate(chain, duration=0.01, step=1e-4, initial=start, load=load)
    assert float(np.abs(motion.x[:, -1] - 0.5).max()) < 1e-12


def test_a_file_says_that_its_shape_at_rest_is_unstable(tmp_path: Path) -> None:
    strip = Chain(Beam(0.9, 31.0, 1.7), "pinned-pinned", 6)
    path = tmp_path / "strip.xml"
    export_chain(strip, path, at=find_equilibrium(strip, None, span=0.7, branch=2))
    assert "its shape at rest under Load() is unstable: the chain leaves it" in path.read_text("utf-8")


def test_spans_that_no_chain_has_are_named() -> None:
    beam, load = Beam(0.9, 31.0, 1.7), Load(gravity=9.81)
    with pytest.raises(ValueError, match=r"shorter than the chain, 0.9 m, got \(0.8, 0.6\), 1 m"):
        find_equilibrium(Chain(beam, "pinned-pinned", 6), load, span=(0.8, 0.6))
    for ends in ("pinned-pinned", "clamped-clamped"):
        with pytest.raises(ValueError, match="span must be left out of a chain that has no hinge"):
            find_equilibrium(Chain(beam, ends, 1), load, span=0.5)
