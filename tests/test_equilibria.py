"""Chains at rest far from straight, and their small vibration there."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from turns import in_turns

from beammodes.accuracy.buckling import buckling_load
from beammodes.chains.chain import Chain
from beammodes.equations.equilibria import Equilibrium, EquilibriumNotFound, find_equilibrium
from beammodes.equations.mechanics import Algebra, coordinate_names, energies
from beammodes.equations.numeric import compile_equations
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import BentModel, linearize
from beammodes.vibration.modes import solve_modes

BEAM = Beam(1.3, 2.0, 0.7)
EVERY_LOAD = Load(
    axial_force=-1.0, spin_rate=1.2, hub_radius=0.3, gravity=(1.0, -2.0), tip_force=0.8, tip_moment=-0.3
)

# benchmarks.json, "elastica_tip_load": P L²/EI, tip angle, deflection w/L and retreat u/L of a cantilever
# under a dead transverse force P on its tip, from elliptic integrals.
ELASTICA = [
    (0.2, 0.09963616303740186, 0.0663644821448305, 0.0026465483405227687),
    (1.0, 0.461351949711879, 0.30172077379981355, 0.05643323628337688),
    (2.0, 0.781749831556543, 0.49345748039671183, 0.16064172082516723),
    (5.0, 1.215368117611681, 0.7137915236119128, 0.38762836072442985),
    (10.0, 1.4302855388038576, 0.8106090248802964, 0.5549955977537513),
]


def unit_chain(segments: int, rule: str = "mitiguy", boundary: str = "clamped-free") -> Chain:
    return Chain(Beam.unit(), boundary, segments, rule)


def tip(found: Equilibrium) -> np.ndarray:
    """Tip angle, and its retreat and deflection."""
    x, y = found.nodes[-1]
    return np.array([found.angle[-1], y, found.chain.length.sum() - x])


def reduced(found: Equilibrium, matrix: np.ndarray) -> np.ndarray:
    return found.basis.T @ matrix @ found.basis


@pytest.mark.parametrize(
    ("rule", "segments"), in_turns(["double_wall", "mitiguy", "naive", "hencky"], [3, 10, 64], every=3)
)
def test_a_tip_moment_rolls_a_cantilever_into_a_circle(rule: str, segments: int) -> None:
    # Inner hinges turn by M ell/EI = 2π/N alike, so N equal rods close whatever the wall's hinge turns by.
    chain = Chain(Beam(2.5, 3.0, 1.0), "clamped-free", segments, rule)
    found = find_equilibrium(chain, Load(tip_moment=2 * np.pi * 3.0 / 2.5))
    assert np.linalg.norm(found.nodes[-1] - found.nodes[0]) <= 1e-12 * 2.5
    np.testing.assert_allclose(np.diff(found.angle)[1:], 2 * np.pi / segments, rtol=1e-12)
    assert found.is_stable and found.residual < 1e-14
    turns = np.diff([0.0, *found.angle]) if len(found.angle) == segments else np.diff(found.angle)
    np.testing.assert_allclose(found.stored_energy, chain.joint_stiffness @ turns**2 / 2, rtol=1e-12)


def test_unequal_hinges_near_the_wall_leave_a_gap_that_falls_with_n() -> None:
    gaps = [
        np.linalg.norm(find_equilibrium(unit_chain(n, "gregory"), Load(tip_moment=2 * np.pi)).nodes[-1])
        for n in (20, 40, 80)
    ]
    assert 1e-4 < gaps[1] < 1e-2
    np.testing.assert_allclose(np.log2(np.array(gaps[:-1]) / gaps[1:]), 2, atol=0.1)


@pytest.mark.parametrize(
    ("rule", "force", "angle", "deflection", "retreat"),
    [
        # Forces with one rule, the largest with three more.
        pytest.param(
            rule,
            *row,
            marks=[]
            if row == ELASTICA[-1] or (rule, row) == ("mitiguy", ELASTICA[1])
            else [pytest.mark.slow],
        )
        for rule in ("mitiguy", "double_wall", "half_stub", "gregory")
        for row in ELASTICA
    ],
)
def test_a_tip_force_bends_a_cantilever_into_the_elastica(
    rule: str, force: float, angle: float, deflection: float, retreat: float
) -> None:
    exact = np.array([angle, deflection, retreat])
    coarse, fine = (tip(find_equilibrium(unit_chain(n, rule), Load(tip_force=force))) for n in (50, 100))
    assert np.abs(fine / exact - 1).max() < 1.1e-4
    # Order 2, in what is not zero by chance; Richardson's extrapolation is far closer.
    np.testing.assert_allclose((4 * fine - coarse) / 3, exact, rtol=2e-6)


@pytest.mark.parametrize(("rule", "force"), in_turns(["naive", "rigid_stub"], [0.2, 5.0], every=2))
def test_rules_of_order_one_bend_at_order_one(rule: str, force: float) -> None:
    exact = next(np.array(row[1:]) for row in ELASTICA if row[0] == force)
    errors = [
        tip(find_equilibrium(unit_chain(n, rule), Load(tip_force=force))) / exact - 1 for n in (50, 100)
    ]
    assert (np.abs(errors[1]) < 0.03).all()
    np.testing.assert_allclose(errors[0] / errors[1], 2, rtol=0.02)


def test_beyond_buckling_a_cantilever_stands_on_its_first_branch() -> None:
    # K(k) = L √(P/EI), k the sine of half the tip's angle: 176.806°, x/L = -0.596668, w/L = 0.402477.
    load = Load(axial_force=-10 * np.pi**2 / 4)
    square = brentq(lambda m: ellipk(m) - math.sqrt(10) * np.pi / 2, 0.5, 1 - 1e-12, xtol=1e-16)
    length, k = ellipk(square), math.sqrt(square)
    exact = np.array([2 * math.asin(k), 2 * k / length, 2 - 2 * ellipe(square) / length])
    np.testing.assert_allclose(np.degrees(exact[0]), 176.806, atol=5e-4)
    np.testing.assert_allclose([1 - exact[2], exact[1]], [-0.596668, 0.402477], atol=1e-6)
    found = [find_equilibrium(unit_chain(n), load) for n in (30, 60, 120)]
    assert all(f.is_stable for f in found)
    values = np.array([tip(f) for f in found])
    errors = values - exact
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2, atol=0.02)
    np.testing.assert_allclose((4 * values[2] - values[1]) / 3, exact, rtol=1e-6)
    straight = find_equilibrium(unit_chain(40), load, guess=np.zeros(40))
    assert not straight.is_stable and not straight.angle.any()
    with pytest.raises(ValueError, match="stable"):
        solve_modes(linearize(unit_chain(40), at=straight))


def test_beyond_buckling_a_pinned_column_bows_upwards() -> None:
    # Half of it is a cantilever: K(k) = (L/2) √(P/EI), the middle rises by k L/K.
    force = 1.5 * np.pi**2
    square = brentq(lambda m: ellipk(m) - math.sqrt(force) / 2, 1e-9, 1 - 1e-9, xtol=1e-16)
    middles = []
    for segments in (20, 40):
        found = find_equilibrium(unit_chain(segments, "mitiguy", "pinned-pinned"), Load(axial_force=-force))
        assert found.is_stable
        np.testing.assert_allclose(found.nodes[-1, 1], 0.0, atol=1e-14)
        np.testing.assert_allclose(found.multipliers, 0.0, atol=1e-10)
        assert found.position.shape == (segments - 1, 2)
        middles.append(found.nodes[segments // 2, 1])
    np.testing.assert_allclose(
        (4 * middles[1] - middles[0]) / 3, math.sqrt(square) / ellipk(square), rtol=1e-5
    )


SUPPORTED = ["clamped-free", "clamped-pinned", "clamped-clamped", "guided-pinned", "clamped-guided"]


@pytest.mark.parametrize("boundary", [*SUPPORTED, "free-clamped", "pinned-clamped"])
def test_chains_buckle_at_their_buckling_load_and_not_before(boundary: str) -> None:
    chain = Chain(BEAM, boundary, segments=9)
    critical = buckling_load(chain)
    below, just, beyond = (
        find_equilibrium(chain, Load(axial_force=-share * critical)) for share in (0.9999, 1.0001, 1.1)
    )
    assert below.is_stable and not below.angle.any()
    assert just.is_stable and 0.001 < np.abs(just.angle).max() < 0.1
    assert beyond.is_stable and 0.5 < np.abs(beyond.angle).max() < 1.5
    rise = beyond.nodes[:, 1]
    assert rise[np.abs(rise).argmax()] > 0


@pytest.mark.parametrize(
    ("boundary", "share"),
    [
        # Its two ends meet at 2.183 times the buckling load, where 2 E(k) = K(k), and then change sides.
        ("pinned-pinned", 2.3),
        ("clamped-pinned", 1.2),
        # On springs across it a column turns as a whole, and the more it has turned the less resists.
        ((End(30.0, 5.0), End(20.0, 1.0)), 1.001),
    ],
)
def test_a_column_that_jumps_is_not_followed(boundary: Any, share: float) -> None:
    chain = Chain(BEAM, boundary, segments=9)
    with pytest.raises(EquilibriumNotFound, match="without a jump"):
        find_equilibrium(chain, Load(axial_force=-share * buckling_load(chain)))


def potential(chain: Chain, q: np.ndarray, load: Load) -> float:
    units = chain.units
    algebra = Algebra(float, math.sin, math.cos, units.length, units.mass, units.stiffness)
    return float(energies(chain, q.tolist(), [0.0] * len(q), algebra, load).potential)


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "guided-pinned", "pinned-clamped"])
@pytest.mark.parametrize("plane", ["lag", "flap"])
def test_equilibria_make_the_potential_stationary(boundary: str, plane: str) -> None:
    chain = Chain(BEAM, boundary, segments=5)
    load = dataclasses.replace(EVERY_LOAD, plane=plane)
    found = find_equilibrium(chain, load)
    q, step = found.coordinates, 1e-5
    for direction in found.basis.T / 1.3:
        slope = potential(chain, q + step * direction, load) - potential(chain, q - step * direction, load)
        assert abs(slope / (2 * step)) < 1e-8
    assert found.is_stable and found.residual < 1e-13


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "guided-pinned"])
def test_matrices_about_a_bent_shape_are_those_of_the_compiled_equations(boundary: str) -> None:
    chain = Chain(BEAM, boundary, segments=6)
    found = find_equilibrium(chain, EVERY_LOAD)
    assert np.abs(found.angle).max() > 0.01
    model, compiled = linearize(chain, at=found), compile_equations(chain, load=EVERY_LOAD)
    assert isinstance(model, BentModel) and model.load == EVERY_LOAD
    assert model.coordinates == tuple(coordinate_names(chain))
    q, multipliers = found.coordinates, found.multipliers
    pull = compiled.constraint_jacobian(q).full().T @ multipliers
    np.testing.assert_allclose(compiled.static_forces(q).full()[:, 0], pull, atol=1e-12)
    mass = reduced(found, compiled.mass_matrix(q).full())
    stiffness = reduced(found, compiled.static_jacobian(q, multipliers).full())
    np.testing.assert_allclose(model.mass_matrix, mass, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(model.stiffness_matrix, stiffness, rtol=1e-12, atol=1e-11)
    modes, z = solve_modes(model), np.linalg.eigvals(np.linalg.solve(mass, stiffness))
    np.testing.assert_allclose(modes.angular_frequency, np.sqrt(np.sort(z.real)), rtol=1e-10)
    assert modes.deflection.shape == (len(z), chain.pieces + 1) and modes.rotation.shape[1] == chain.pieces


def test_the_tangent_of_a_sagging_cantilever_is_the_difference_of_its_forces() -> None:
    chain = unit_chain(8)
    load = Load(gravity=20.0)
    found, forces = find_equilibrium(chain, load), compile_equations(chain, load=load).static_forces
    differences = np.empty((8, 8))
    for i, step in enumerate(1e-5 * np.eye(8)):
        ahead, behind = (forces(found.coordinates + s * step).full()[:, 0] for s in (1, -1))
        differences[:, i] = (ahead - behind) / 2e-5
    assert found.nodes[-1, 1] < -0.5
    np.testing.assert_allclose(found.tangent, differences, atol=1e-6)


LOADS_ALONG = [
    Load(),
    Load(axial_force=0.5),
    Load(axial_force=-0.3),
    Load(spin_rate=2.0, hub_radius=0.3),
    Load(spin_rate=0.5, hub_radius=0.3, plane="lag"),
]


@pytest.mark.parametrize(
    ("boundary", "load", "segments"),
    in_turns([pair.name for pair in BOUNDARIES if not pair.rigid_body_modes], LOADS_ALONG, [6, 40], every=4),
    ids=str,
)
def test_about_the_straight_shape_modes_are_those_of_the_linear_model(
    boundary: str, load: Load, segments: int
) -> None:
    chain = Chain(BEAM, boundary, segments)
    bent = solve_modes(linearize(chain, load=load, at=find_equilibrium(chain, load)))
    straight = solve_modes(linearize(chain, load=load))
    np.testing.assert_allclose(bent.angular_frequency, straight.angular_frequency, rtol=1e-10)
    # Two entries of a mode may be equally large: its sign is then chance.
    np.testing.assert_allclose(np.abs(bent.deflection[:3]), np.abs(straight.deflection[:3]), atol=1e-7)
    np.testing.assert_allclose(np.abs(bent.rotation[:3]), np.abs(straight.rotation[:3]), atol=1e-6)


def test_a_hanging_chain_swings_alike_whichever_way_is_down() -> None:
    chain = unit_chain(12, "mitiguy", "pinned-free")
    down = find_equilibrium(chain, Load(gravity=9.81), guess=np.full(12, -1.2))
    np.testing.assert_allclose(down.angle, -np.pi / 2, atol=1e-14)
    expected = solve_modes(linearize(chain, load=Load(gravity=(9.81, 0.0)))).angular_frequency
    found = solve_modes(linearize(chain, at=down), modes=5).angular_frequency
    np.testing.assert_allclose(found, expected[:5], rtol=1e-11)
    assert found[0] == pytest.approx(math.sqrt(1.5 * 9.81), rel=1e-2)


@pytest.mark.parametrize(
    "load",
    [
        Load(gravity=10.0),
        Load(gravity=10.0, spin_rate=2.0, hub_radius=0.2),
        Load(gravity=10.0, spin_rate=2.0, hub_radius=0.2, plane="lag"),
    ],
    ids=str,
)
@pytest.mark.parametrize("rule", ["mitiguy", pytest.param("double_wall", marks=pytest.mark.slow)])
def test_heavy_and_turning_cantilevers_tend_to_the_beams_own_equation(rule: str, load: Load) -> None:
    # θ'' = F_x sin θ - F_y cos θ with F the force of all that lies beyond, by collocation.
    square, outward = load.spin_rate**2, float(load.plane == "lag")

    def rates(_: np.ndarray, state: np.ndarray) -> np.ndarray:
        theta, bend, x, y, across, along = state
        cosine, sine = np.cos(theta), np.sin(theta)
        pull = -square * (load.hub_radius + x), -load.weight[1] - square * outward * y
        return np.stack([bend, across * sine - along * cosine, cosine, sine, *pull])

    def ends(left: np.ndarray, right: np.ndarray) -> np.ndarray:
        return np.array([left[0], left[2], left[3], right[1], right[4], right[5]])

    grid = np.linspace(0, 1, 101)
    start = np.stack([-grid, 0 * grid, grid, -grid / 2, 0 * grid, 0 * grid])
    beam = solve_bvp(rates, ends, grid, start, tol=1e-9, max_nodes=20000)
    assert beam.success
    exact = np.array([beam.y[0, -1], beam.y[3, -1], 1 - beam.y[2, -1]])
    found = np.array([tip(find_equilibrium(unit_chain(n, rule), load)) for n in (25, 50)])
    assert np.abs(found[1] / exact - 1).max() < 4e-4
    np.testing.assert_allclose((4 * found[1] - found[0]) / 3, exact, rtol=2e-6)


def test_a_guess_is_an_equilibrium_or_numbers() -> None:
    chain, load = unit_chain(6), Load(tip_force=3.0)
    found = find_equilibrium(chain, load)
    for guess in (found, found.coordinates, found.coordinates.tolist()):
        np.testing.assert_allclose(find_equilibrium(chain, load, guess=guess).angle, found.angle, rtol=1e-12)
    for guess in (np.zeros(5), [[0.0] * 6]):
        with pytest.raises(ValueError, match="guess must hold 6 finite coordinates"):
            find_equilibrium(chain, load, guess=guess)
    with pytest.raises(ValueError, match="guess must be finite"):
        find_equilibrium(chain, load, guess=np.full(6, np.nan))
    with pytest.raises(TypeError, match="guess must be an array of real numbers, got 'bent'"):
        find_equilibrium(chain, load, guess="bent")


def test_what_is_refused() -> None:
    chain, load = unit_chain(4), Load(gravity=1.0)
    found = find_equilibrium(chain, load)
    with pytest.raises(TypeError, match="chain must be a Chain"):
        find_equilibrium("clamped-free", load)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="tolerance"):
        find_equilibrium(chain, load, tolerance=0.0)
    with pytest.raises(ValueError, match="at most 2000 pieces"):
        find_equilibrium(unit_chain(2001), load)
    with pytest.raises(ValueError, match="tie the left end"):
        find_equilibrium(unit_chain(4, boundary="free-clamped"), load)
    with pytest.raises(EquilibriumNotFound, match="guess"):
        find_equilibrium(unit_chain(4, boundary="pinned-free"), load)
    with pytest.raises(EquilibriumNotFound, match="guess"):
        find_equilibrium(unit_chain(4, boundary="pinned-free"), Load(axial_force=-1.0))
    with pytest.raises(TypeError, match="at must be an Equilibrium"):
        linearize(chain, at=found.coordinates)  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="same chain"):
        linearize(unit_chain(5), at=found)
    with pytest.raises(ValueError, match="load must be left out"):
        linearize(chain, load=Load(gravity=2.0), at=found)
    lag = Load(gravity=1.0, spin_rate=1.0, plane="lag")
    with pytest.raises(ValueError, match="Coriolis"):
        linearize(chain, at=find_equilibrium(chain, lag))


@pytest.mark.parametrize("boundary", ["free-free", "guided-guided", "pinned-free"])
def test_a_free_chain_at_rest_is_indifferent(boundary: str) -> None:
    found = find_equilibrium(unit_chain(4, boundary=boundary), None)
    assert not found.is_stable and not found.coordinates.any() and found.stored_energy == 0


@pytest.mark.parametrize(
    ("boundary", "rule"), [("clamped-free", "rigid_stub"), ("clamped-clamped", "mitiguy")]
)
def test_a_chain_that_cannot_move_stays(boundary: str, rule: str) -> None:
    chain = unit_chain(1, rule, boundary)
    found = find_equilibrium(chain, Load(gravity=5.0))
    assert found.is_stable and not found.angle.any()
    assert solve_modes(linearize(chain, at=found)).angular_frequency.shape == (0,)


def test_a_long_chain() -> None:
    # Errors of order two: 1e-6 at N = 1000.
    fine = find_equilibrium(unit_chain(500), Load(tip_force=10.0))
    np.testing.assert_allclose(tip(fine), ELASTICA[-1][1:], rtol=4e-6)
    assert fine.is_stable
