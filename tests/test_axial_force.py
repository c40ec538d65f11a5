"""Chains under an axial force: published beams, geometric stiffness, buckling, springs corrected for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from beammodes.accuracy.buckling import buckling_dataset, buckling_load
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, axially_corrected
from beammodes.equations.symbolic import equations_of_motion, symbolic_energies
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS, Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize, nodal_matrices
from beammodes.vibration.modes import solve_modes

INF, F = math.inf, Fraction
UNIT = Beam.unit()
BEYOND = r"^axial_force must not compress the chain beyond its buckling load"

# L = EI = ρA = 1: buckling load, then first frequencies by P over it (compression positive).
# Source: characteristic equation of the beam under axial force, recomputed with 40 digits.
PUBLISHED: dict[str, tuple[float, dict[float, list[float]]]] = {
    "pinned-pinned": (
        9.869604401089358,
        {-1.0: [13.957728399277759, 44.138212703733814], 0.5: [6.978864199638879, 36.9286782118726]},
    ),
    "clamped-clamped": (
        39.47841760435743,
        {-1.0: [31.248581700577226, 74.8826146946405], 0.5: [15.951287605328371, 53.76264290743951]},
    ),
    "clamped-free": (
        2.4674011002723395,
        {-1.0: [4.8147715702463065, 23.770134422971577], 0.5: [2.534560216070987, 21.105172354558672]},
    ),
    "clamped-pinned": (
        20.19072855642663,
        {-1.0: [21.60557587893725, 57.976666087798584], 0.5: [10.970422211028536, 45.422902823697456]},
    ),
}
CASES = [(pair, p) for pair, (_, by_load) in PUBLISHED.items() for p in by_load]


def frequencies(pair: Any, segments: int, rule: Any, load: Load, count: int = 2) -> np.ndarray:
    return solve_modes(linearize(Chain(UNIT, pair, segments, rule), load=load), count).angular_frequency


def published(pair: str, p: float) -> tuple[Load, np.ndarray]:
    critical, by_load = PUBLISHED[pair]
    return Load(axial_force=-p * critical), np.array(by_load[p])


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("pair", "p"), CASES)
def test_every_rule_keeps_order_two_at_best(pair: str, p: float, rule: str) -> None:
    load, exact = published(pair, p)
    declared = RULES[rule].declared_order(Boundary.of(pair), load)
    assert declared == min(2, RULES[rule].declared_order(Boundary.of(pair)))
    sizes = np.array([[40], [80], [160]])
    errors = np.abs([frequencies(pair, int(n), rule, load) / exact - 1 for n in sizes[:, 0]])
    # Terms in 1/N² and 1/N³ of either sign: where they cancel on the way, an error falls faster first.
    scaled = (errors * sizes**declared).max(axis=1)
    assert scaled[2] < 2**0.5 * scaled[:2].max()
    assert errors[2].max() > 1e-6
    assert errors[2].max() < (2e-3 if declared == 2 else 4e-2)


# --- The geometric stiffness ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "pair", ["clamped-free", (End(2, 3), End(1, 0, 1, 1, F(1, 2))), "free-guided"], ids=str
)
def test_geometric_stiffness_is_the_second_derivative_of_the_loads_potential(pair: Any) -> None:
    chain = Chain(UNIT, pair, 3)
    force = F(5, 7)
    equations = equations_of_motion(chain, load=Load(force))
    q = [x for x in equations.coordinates if str(x) != "x_0"]
    rest = dict.fromkeys(equations.coordinates, 0)
    whole, bare = (symbolic_energies(chain, load=load).potential for load in (Load(force), None))
    hessian = [sympy.hessian(part, q).subs(rest) for part in (whole, bare)]
    assert equations.linearize().stiffness_matrix == hessian[0]
    # The tips approach by Σ l (1 - cos θ) = ½ Σ l θ²: T l on every angle's diagonal.
    ell, stiffness = (sympy.Symbol(name, positive=True) for name in ("ell", "EI"))
    own = sympy.Rational(5, 7) / 9 * stiffness / ell  # T ell, with T in EI/ell² and ell = 1/3
    lengths = [part for part, held in zip(chain.scaled.length, chain.held_angles, strict=True) if not held]
    on_tip = [0] * (len(q) - len(lengths))
    expected = sympy.diag(*on_tip, *(own * sympy.Rational(v.numerator, v.denominator) for v in lengths))
    assert sympy.simplify(hessian[0] - hessian[1] - expected) == sympy.zeros(len(q))


def test_free_under_tension_has_one_rigid_mode_and_none_turns_freely() -> None:
    for pair, rigid in (("free-free", 1), ("pinned-free", 0), ("guided-free", 1), ("guided-guided", 1)):
        chain = Chain(UNIT, pair, 5)
        model = linearize(chain, load=Load(2.0))
        found = solve_modes(model)
        squares = np.linalg.eigvals(np.linalg.solve(model.mass_matrix, model.stiffness_matrix)).real
        assert model.rigid_body_modes == found.rigid_body_modes == rigid
        assert (np.abs(squares) < 1e-8).sum() == rigid
        assert model.elastic_modes == len(found.angular_frequency) == len(model.coordinates) - rigid
        assert found.angular_frequency[0] > 1.0
    # N segments between free ends have N + 1 deflections, one of them rigid.
    assert linearize(Chain(UNIT, "free-free", 5), load=Load(2.0)).elastic_modes == 5


def test_a_string_of_rods_in_strong_tension() -> None:
    # Rods with hinges without springs (T ≫ EI): ω² m (2 + cos q)/3 = 2 (T/ell)(1 - cos q), q = n π/N; the EI
    # left is 1e-10 of T.
    for segments in (20, 600):
        q = np.arange(1, 4) * np.pi / segments
        string = segments * np.sqrt(1e12 * 4 * np.sin(q / 2) ** 2 / (1 - 2 / 3 * np.sin(q / 2) ** 2))
        found = frequencies("pinned-pinned", segments, "mitiguy", Load(1e12), 3)
        np.testing.assert_allclose(found, string, rtol=1e-10)


@pytest.mark.parametrize("tension", [1e6, 1e8])
def test_a_tight_chain_on_soft_springs_bounces_as_one(tension: float) -> None:
    # The first mode does not feel T: its ω² is 5, nearly. Exact matrices in 40 digits.
    chain = Chain(UNIT, (End(2.0), End(3.0)), 8)
    load = Load(tension)
    _, *rows = nodal_matrices(chain, F, load)
    with mpmath.workdps(40):
        mass, stiffness = (
            mpmath.matrix([[mpmath.mpf(v.numerator) / v.denominator for v in row] for row in part])
            for part in rows
        )
        root = mpmath.inverse(mpmath.cholesky(mass))
        exact = mpmath.sqrt(min(mpmath.eigsy(root * stiffness * root.T, eigvals_only=True)))
    found = solve_modes(linearize(chain, load=load), 1).angular_frequency[0]
    assert found == pytest.approx(float(exact) * chain.units.angular_frequency, rel=1e-12)
    assert found == pytest.approx(5**0.5, rel=1e-5)


@pytest.mark.parametrize("pair", ["clamped-free", "pinned-free", "free-free"])
def test_long_chains_in_strong_tension(pair: str) -> None:
    # A string in uniform tension T ≫ EI, its free ends sliding: ω = β √T, β = π n, or π (n - 1/2) where one
    # end alone is held; 1/600² for the rods, 1/√T = 1e-4 for the bending at the ends.
    held = 0 if pair == "free-free" else 0.5
    found = frequencies(pair, 600, "mitiguy", Load(1e8), 3)
    np.testing.assert_allclose(found, (np.arange(1, 4) - held) * np.pi * 1e4, rtol=3e-4)


# --- Buckling ---------------------------------------------------------------------------------------------

CLOSED: dict[str, Callable[[int], float]] = {
    # Hencky's bar-chain with 2 EI/ell at walls: published closed forms.
    "pinned-pinned": lambda n: 4 * n**2 * math.sin(math.pi / (2 * n)) ** 2,
    "clamped-free": lambda n: 4 * n**2 * math.sin(math.pi / (4 * n)) ** 2,
    "clamped-clamped": lambda n: 4 * n**2 * math.sin(math.pi / n) ** 2,
}


@pytest.mark.parametrize("rule", ["hencky", "double_wall"])
@pytest.mark.parametrize("pair", CLOSED)
def test_henckys_closed_forms(pair: str, rule: str) -> None:
    for segments in (2, 3, 7, 100, 501, 3000):
        exact = CLOSED[pair](segments)
        assert buckling_load(Chain(UNIT, pair, segments, rule)) == pytest.approx(exact, rel=1e-14)


def critical_exactly(chain: Chain) -> float:
    """The smallest P with K - P G singular, of exact rational matrices, in 40 digits and own units."""
    bare, unit = (nodal_matrices(chain, F, load)[2] for load in (None, Load(chain_force(chain))))
    with mpmath.workdps(40):
        k, pulled = (
            mpmath.matrix([[mpmath.mpf(v.numerator) / v.denominator for v in row] for row in rows])
            for rows in (bare, unit)
        )
        root = mpmath.inverse(mpmath.cholesky(k))
        steepest = max(mpmath.eigsy(root * (pulled - k) * root.T, eigvals_only=True))
        return float(1 / steepest)


def chain_force(chain: Chain) -> Fraction:
    """The force that is 1 in the chain's own units."""
    return chain.exact_units.stiffness / chain.exact_units.length


stiffness = st.sampled_from([0.0, 0.3, 7.0, 1e4, INF])
supports = st.builds(End, stiffness, stiffness, st.just(0.5), st.sampled_from([0.0, 0.1]))


@given(supports, supports, st.integers(2, 6), st.sampled_from(["gregory", "half_stub", "double_wall"]))
@example(ENDS["clamped"], ENDS["clamped"], 2, "half_stub")
@settings(max_examples=40)
def test_buckling_by_three_routes(left: End, right: End, segments: int, rule: str) -> None:
    chain = Chain(Beam(1.3, 2.0, 0.7), (left, right), segments, rule)
    assume(chain.elastic_modes > 0)  # one rod between two stubs in walls cannot move, nor buckle
    ends = (left, right)
    if sum(end.translational_stiffness > 0 for end in ends) < 2 and not any(
        end.rotational_stiffness > 0 for end in ends
    ):
        with pytest.raises(ValueError, match="boundary must resist a rigid rotation"):
            buckling_load(chain)
        return
    if not chain.elastic_modes:
        # Nothing moves between two walls from which half of either segment sticks out.
        assert buckling_load(chain) == INF
        return
    if chain.boundary.rigid_body_modes == 0:
        exact = critical_exactly(chain) * float(chain_force(chain))
        assert buckling_load(chain) == pytest.approx(exact, rel=1e-13)
    critical = buckling_load(chain)
    bare, near = (
        solve_modes(linearize(chain, load=Load(-critical * part)), 1).angular_frequency[0] ** 2
        for part in (0.0, 1 - 1e-6)
    )
    # ω² is a concave function of P, zero at the buckling load.
    assert near < bare
    slope = solve_modes(linearize(chain, load=Load(-critical * (1 - 2e-6))), 1).angular_frequency[0] ** 2
    # A second buckling load close by bends the line a little.
    assert slope / near == pytest.approx(2.0, rel=1e-2)
    with pytest.raises(ValueError, match=BEYOND):
        solve_modes(linearize(chain, load=Load(-critical * (1 + 1e-9))))


# Beyond each of the first buckling loads in turn: (2 n - 1)² times the first.
TOO_MUCH = [(n, beyond) for n in (20, 600) for beyond in (1.0001, 2.0, 8.9, 9.1, 26.0, 400.0)]


@pytest.mark.parametrize(
    ("segments", "beyond"),
    TOO_MUCH,
)
def test_beyond_buckling_is_refused_at_any_length(segments: int, beyond: float) -> None:
    chain = Chain(UNIT, "clamped-free", segments)
    critical = buckling_load(chain)
    assert solve_modes(linearize(chain, load=Load(-0.9999 * critical)), 1).angular_frequency[0] > 0
    with pytest.raises(ValueError, match=BEYOND):
        solve_modes(linearize(chain, load=Load(-beyond * critical)), 1)


@pytest.mark.parametrize("pair", ["pinned-free", "free-free", (End(5.0), "free")], ids=str)
@pytest.mark.parametrize("segments", [6, 600])
def test_any_compression_turns_a_chain_over_that_rotates_freely(pair: Any, segments: int) -> None:
    model = linearize(Chain(UNIT, pair, segments), load=Load(-1.0))
    if segments == 6:
        # The definition: a motion whose stored energy is negative.
        assert np.linalg.eigvalsh(model.stiffness_matrix)[0] < -0.1
    with pytest.raises(ValueError, match="axial_force"):
        solve_modes(model, 2)


@pytest.mark.parametrize("pair", ["pinned-free", "free-free", (End(5.0), End(mass=1.0))], ids=str)
def test_what_rotates_freely_has_no_buckling_load(pair: Any) -> None:
    for structure in ((UNIT, pair), (Chain(UNIT, pair, 5),)):
        with pytest.raises(ValueError, match="boundary"):
            buckling_load(*structure)


@pytest.mark.parametrize(
    ("pair", "rule"),
    [((End(INF, rotary_inertia=0.1), "pinned"), "double_wall"), ((End(5.0, INF), "guided"), "rigid_stub")],
)
def test_a_chain_whose_modes_leave_it_straight_never_buckles(pair: Any, rule: str) -> None:
    chain = Chain(UNIT, pair, 1, rule)
    assert chain.elastic_modes == 1
    assert buckling_load(chain) == INF


def test_wrong_arguments_of_buckling_load() -> None:
    chain = Chain(UNIT, "clamped-free", 3)
    with pytest.raises(TypeError, match="boundary must be left out for a chain"):
        buckling_load(chain, "clamped-free")  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="boundary must be given for a beam"):
        buckling_load(UNIT)  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="structure must be a Beam, Chain, Structure or StructureChain"):
        buckling_load("beam", "clamped-free")  # type: ignore[call-overload]
    assert buckling_load(Chain(UNIT, "pinned-pinned", 1)) == INF


def test_buckling_dataset_has_the_order_under_axial_force() -> None:
    pairs = list(CLOSED)
    table = buckling_dataset(boundary=pairs, segments=[1, 40, 80], rule=["double_wall", "gregory"])
    for pair in pairs:
        row = table.sel(rule="double_wall", boundary=pair)
        np.testing.assert_allclose(row.buckling_load[1:], [CLOSED[pair](n) for n in (40, 80)], rtol=1e-13)
        np.testing.assert_allclose(row.exact_buckling_load[1:], PUBLISHED[pair][0], rtol=1e-14)
        assert np.isnan(row.buckling_load[0]) == (pair != "clamped-free")
        for rule in ("double_wall", "gregory"):
            coarse, fine = table.relative_error.sel(rule=rule, boundary=pair).values[1:]
            assert math.log2(coarse / fine) > RULES[rule].declared_order(Boundary.of(pair), Load(1.0)) - 0.3


# --- Springs corrected for the force ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pair", "shift"), [("pinned-pinned", 0), ("guided-guided", 0), ("guided-pinned", 0.5)]
)
@pytest.mark.parametrize("p", [-3.0, 0.6])
def test_corrected_springs_have_order_four_between_ends_without_moment_or_shear(
    pair: str, shift: float, p: float
) -> None:
    # The beam's shapes are sines or cosines: ω² = β⁴ + T β², β = (n - shift) π, and P_cr = β₁².
    beta = (np.arange(1, 4) - shift) * np.pi
    tension = -p * beta[0] ** 2
    load, exact = Load(tension), np.sqrt(beta**4 + tension * beta**2)
    rule = axially_corrected("mitiguy", load, UNIT)
    assert rule.declared_order(Boundary.of(pair)) == 4
    coarse, fine = (np.abs(frequencies(pair, n, rule, load, 3) / exact - 1) for n in (30, 60))
    assert (np.log2(coarse / fine) > 3.9).all()
    assert (fine < beta**4 / 60**4 / 50).all()


@pytest.mark.parametrize(("pair", "p"), [case for case in CASES if case[0] != "pinned-pinned"])
def test_corrected_springs_have_order_three_at_walls(pair: str, p: float) -> None:
    load, exact = published(pair, p)
    rule = axially_corrected("gregory", load, UNIT)
    assert rule.declared_order(Boundary.of(pair)) == 3
    sizes = np.array([[20], [40], [80], [160]])
    errors = np.abs([frequencies(pair, int(n), rule, load) / exact - 1 for n in sizes[:, 0]])
    scaled = (errors * sizes**3).max(axis=1)
    # Terms of order 3 and 4 of either sign: an error may pass through zero on the way.
    assert scaled[3] < 2**0.2 * scaled[:3].max()
    plain = np.abs(frequencies(pair, 160, "gregory", load) / exact - 1)
    assert (errors[3] < plain / 15).all()


def test_a_cantilever_at_half_its_buckling_load_is_eighty_times_closer() -> None:
    # theory.md section 4: "cut that about 80-fold", and -2.6e-4 for plain gregory.
    load, exact = published("clamped-free", 0.5)
    plain, corrected = (
        abs(frequencies("clamped-free", 20, rule, load)[0] / exact[0] - 1)
        for rule in ("gregory", axially_corrected("gregory", load, UNIT))
    )
    assert plain == pytest.approx(2.6e-4, rel=0.03)
    assert 60 < plain / corrected < 100


def test_corrected_springs_in_numbers() -> None:
    # By hand: k = EI/ell - T ell/12 with EI = 5, L = 3, N = 4, T = -8, and 2 (EI/ell + P ell/12) at the wall.
    beam, load = Beam(3.0, 5.0, 2.0), Load(-8.0)
    chain = Chain(beam, "clamped-free", 4, axially_corrected("double_wall", load, beam))
    inside = 5 / 0.75 + 8 * 0.75 / 12
    np.testing.assert_allclose(chain.joint_stiffness, inside * np.array([2, 1, 1, 1]), rtol=1e-15)
    assert "double_wall corrected for T = -14.4 EI/L²" in repr(chain)


def test_springs_lost_in_strong_tension_are_refused() -> None:
    # 1 - T ell²/(12 EI) is positive for T < 12 N² only.
    for tension, positive in ((191.0, True), (192.0, False), (500.0, False)):
        rule = axially_corrected("gregory", Load(tension), UNIT)
        if positive:
            assert Chain(UNIT, "clamped-free", 4, rule).joint_stiffness.min() > 0
            continue
        with pytest.raises(ValueError, match=r"^rule gregory corrected for T = .* has no positive springs"):
            Chain(UNIT, "clamped-free", 4, rule)


def test_wrong_arguments_of_axially_corrected() -> None:
    with pytest.raises(ValueError, match=r'rule.*did you mean "gregory"'):
        axially_corrected("gregry", Load(1.0), UNIT)
    with pytest.raises(TypeError, match=r"^beam must be a Beam, got 1\.0"):
        axially_corrected("gregory", Load(1.0), 1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^beam must be uniform"):
        axially_corrected("gregory", Load(1.0), Beam(1.0, [1.0, 2.0], 1.0))
