"""Chains of beams that vary along their length, beside the exact beam, and what theory itself leaves out."""

from __future__ import annotations

import itertools
import math
import warnings
from dataclasses import replace
from fractions import Fraction
from itertools import accumulate
from typing import Any

import numpy as np
import pytest
from computed_studies import computed
from drawn_ends import EVERY_N
from numpy.typing import NDArray

import beammodes as bm
from beammodes.accuracy.chain_against_beam import SlendernessWarning, chain_errors, theory_errors
from beammodes.chains.rods import profile_weights
from beammodes.chains.rules import RULES, AnyRule
from beammodes.chains.units import ExactUnits
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.spectral_grid import _BLOCKS, _Smoothed
from beammodes.exact.timoshenko_beam import SHEAR_RATIO
from beammodes.problem.loading import Load
from beammodes.problem.profiles import Table, value_at
from studies import axial_force, nonuniform

TAPERS = {
    "linear EI": bm.Beam(1.0, lambda x: 1 - x / 2, 1.0),
    "cubic EI, linear mass": bm.Beam(1.3, lambda x: 5 * (1 - x / 2.6) ** 3, lambda x: 1 - x / 2.6),
    "mass only": bm.Beam(1.0, 1.0, lambda x: 1 - x / 2),
}
STEP = bm.Beam(1.0, [1.0, 0.25], 1.0)
KINKED = Table((0.0, 0.5, 1.0), (1.0, 1.0, 0.4))
KINK = bm.Beam(1.0, KINKED, 1.0, breaks=[0.5])
QUARTERS = bm.Beam(1.0, [1.0, 1.0, 1.0, 0.1], 1.0)


def first_error(beam: bm.Beam, boundary: str, segments: int, rule: AnyRule) -> float:
    return float(chain_errors(bm.Chain(beam, boundary, segments, rule), 1)[0])


def order(beam: bm.Beam, boundary: str, rule: AnyRule, few: int, many: int) -> float:
    """p in e ~ 1/N**p of the first mode between two N; errors below 1e-11 would be rounding."""
    one, other = (abs(first_error(beam, boundary, n, rule)) for n in (few, many))
    assert min(one, other) > 1e-11
    return math.log(one / other) / math.log(many / few)


# --- Smooth tapers. Source: the trapezoidal rule has order 2, Gregory's third-order end weights leave 4. -


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "clamped-pinned", "free-clamped"])
@pytest.mark.parametrize("name", TAPERS)
def test_a_taper_costs_no_order(name: str, boundary: str) -> None:
    beam = TAPERS[name]
    for few, many in ((20, 40), (40, 80)):
        assert order(beam, boundary, "mitiguy", few, many) == pytest.approx(2, abs=0.1)
    errors = [abs(first_error(beam, boundary, n, "gregory")) for n in (20, 40, 80)]
    shown = [(n, e) for n, e in zip((20, 40, 80), errors, strict=True) if e > 1e-11]
    (few, one), (many, other) = shown[0], shown[-1]
    assert len(shown) > 1 and math.log(one / other) / math.log(many / few) >= 3.8


@pytest.mark.parametrize("name", TAPERS)
def test_ends_without_moment_need_no_end_weights(name: str) -> None:
    for rule in ("mitiguy", "gregory", "naive", "half_stub"):
        assert order(TAPERS[name], "pinned-pinned", rule, 20, 80) == pytest.approx(4, abs=0.1)


@pytest.mark.parametrize("boundary", ["clamped-guided", "pinned-guided"])
def test_a_guided_end_where_the_stiffness_slopes(boundary: str) -> None:
    # M²/EI is even about a guided end only if EI is: half weight is the trapezoidal rule, of order 2, and
    # rules of higher order take a clamped end's weights there.
    beam, rule = TAPERS["linear EI"], RULES["gregory"]
    assert order(beam, boundary, "mitiguy", 40, 80) == pytest.approx(2, abs=0.1)
    assert order(beam, boundary, "gregory", 40, 80) >= 3.8
    everywhere = replace(rule, guided=rule.clamped)
    same = [bm.Chain(beam, boundary, 9, record).joint_stiffness for record in (rule, everywhere)]
    np.testing.assert_array_equal(*same)


# --- Fine tables: the same taper, not a row of kinks -----------------------------------------------------

SHAPES = {
    "linear": lambda x: 1 - x / 2,
    "quadratic": lambda x: (1 - x / 2) ** 2,
    "cosine": lambda x: 0.6 + 0.4 * np.cos(np.pi * x),
    "exponential": lambda x: np.exp(-1.5 * x),
    "bulge": lambda x: 0.5 + 2 * x * (1 - x),
}
CORRECTED = ("gregory", "gregory2", "half_stub_corrected")


def tabulated(shape: Any, points: int) -> bm.Beam:
    x = np.linspace(0, 1, points)
    table = Table(x, shape(x))
    return bm.Beam(1.0, table, table)


def error_against(exact: float, beam: bm.Beam, boundary: str, segments: int, rule: str) -> float:
    """The first error, for an exact frequency that is known already."""
    model = bm.linearize(bm.Chain(beam, boundary, segments, rule))
    return float(bm.solve_modes(model, 1).angular_frequency[0] / exact - 1)


def first_exact(beam: bm.Beam, boundary: str) -> float:
    return float(euler_bernoulli(beam, boundary, 1).angular_frequency[0])


@pytest.mark.parametrize("name", SHAPES)
def test_a_fine_table_of_a_taper_errs_as_the_taper_does(name: str) -> None:
    # Requirement: within 5 % of the function's error. The exact beams are known to 1e-11.
    smooth = bm.Beam(1.0, SHAPES[name], SHAPES[name])
    # The coarsest is the hardest; finer tables are tried at one N.
    for points, counts in ((50, (10, 20, 40)), (200, (20,)), (1001, (20,))):
        table = tabulated(SHAPES[name], points)
        due, own = first_exact(smooth, "clamped-free"), first_exact(table, "clamped-free")
        for segments, rule in itertools.product(counts, CORRECTED):
            expected = error_against(due, smooth, "clamped-free", segments, rule)
            assert abs(expected) > 1e-8  # none passes through zero
            found = error_against(own, table, "clamped-free", segments, rule)
            assert abs(found - expected) <= 0.05 * abs(expected) + 2e-11, (segments, rule, points)


@pytest.mark.parametrize("boundary", ["clamped-clamped", "pinned-guided", "pinned-free"])
def test_a_fine_table_errs_as_the_taper_does_whatever_the_ends(boundary: str) -> None:
    for name in SHAPES:
        smooth, table = bm.Beam(1.0, SHAPES[name], SHAPES[name]), tabulated(SHAPES[name], 50)
        exact = [first_exact(beam, boundary) for beam in (table, smooth)]
        for rule in ("gregory", "half_stub_corrected", "rigid_stub_corrected"):
            found, expected = (
                error_against(due, beam, boundary, 16, rule)
                for due, beam in zip(exact, (table, smooth), strict=True)
            )
            assert found == pytest.approx(expected, rel=0.05, abs=1e-7)


def test_a_coarse_table_keeps_an_order_above_two_at_its_kinks() -> None:
    # Kinks that meet no hinge, and no breaks: the curve through the points has slopes without jumps, and
    # the lines beside it are integrated, so order 2 of the plain samples becomes 3 at least.
    beam = bm.Beam(1.0, Table((0.0, 0.23, 0.41, 0.68, 1.0), (1.0, 0.4, 0.9, 0.3, 0.5)), 1.0)
    for rule in ("gregory", "half_stub_corrected"):
        errors = [abs(first_error(beam, "clamped-free", n, rule)) for n in (20, 23, 26, 80, 92, 104)]
        assert math.log(max(errors[:3]) / max(errors[3:])) / math.log(4) > 2.8


@pytest.mark.slow
def test_a_hundred_thousand_positions() -> None:
    # Two routes: the function itself, and the table, of uneven positions and with a step in the middle;
    # chord errors are about (1e-5)²/8.
    x = np.linspace(0, 1, 100_001)
    x[1:-1] = np.sort(np.append(np.random.default_rng(3).uniform(0, 1, len(x) - 3), 0.5))
    shape, half = SHAPES["exponential"], int(np.searchsorted(x, 0.5))
    x = np.insert(x, half, 0.5)
    values = shape(x) * np.where(np.arange(len(x)) <= half, 2.0, 1.0)
    table = bm.Beam(1.0, Table(x, values), shape)
    smooth = bm.Beam(1.0, lambda z: np.where(np.asarray(z) < 0.5, 2.0, 1.0) * shape(z), shape, breaks=[0.5])
    pair = ("clamped", bm.End(mass=0.1))
    found = [euler_bernoulli(b, pair, 4).angular_frequency for b in (table, smooth)]
    np.testing.assert_allclose(found[0], found[1], rtol=2e-9)
    chains = [bm.chain_errors(bm.Chain(b, pair, 20, "gregory"), 2) for b in (table, smooth)]
    np.testing.assert_allclose(chains[0], chains[1], atol=1e-8)


@pytest.mark.parametrize("spread", [1.5, 30.0])
def test_blocks_stand_for_rough_tables(spread: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # Two routes: blocks, and cell by cell. Polynomials of degree 5 are not positive on most blocks here.
    random, x = np.random.default_rng(5), np.linspace(0, 1, 202)
    x[1:-1] = np.sort(random.uniform(0, 1, 200))
    beam, found = bm.Beam(1.0, Table(x, spread ** random.uniform(0, 1, len(x))), 1.0), []
    monkeypatch.setattr("beammodes.exact.spectral_grid._BLOCKS", 60)
    for kinks in (1500, 100):
        monkeypatch.setattr("beammodes.exact.spectral_grid._MOST_KINKS", kinks)
        found.append(euler_bernoulli(beam, "clamped-free", 2).angular_frequency)
    np.testing.assert_allclose(found[1], found[0], rtol=1e-8)


def test_blocks_of_a_crowded_table_are_narrow_where_it_has_few_points() -> None:
    # Half of the blocks' edges are evenly spaced, wherever the table's positions crowd.
    x = np.concatenate([np.linspace(0, 1e-3, 5000), np.linspace(2e-3, 2.0, 50)])
    edges = _Smoothed.of(Table(x, 1 + x), (), False).edges
    assert edges[[0, -1]].tolist() == [0.0, 2.0]
    assert np.diff(edges).max() <= 2.0 / (_BLOCKS // 2) * (1 + 1e-9)


def bent(beam: bm.Beam) -> float:
    """∫ (L - x)²/EI dx of a beam that is smooth on each of a hundred thousand equal parts."""
    node, weight = np.polynomial.legendre.leggauss(6)
    edges = np.linspace(0, beam.length, 100_001)
    half = 0.5 * np.diff(edges)[:, None]
    x = edges[:-1, None] + half * (1 + node)
    return float(((beam.length - x) ** 2 / value_at(beam.bending_stiffness, x) * half * weight).sum())


@pytest.mark.parametrize("points", [0, 5, 51, 1001])
def test_statics_and_buckling_know_the_same_beam(points: int) -> None:
    # The hundred thousand parts end on the tables' positions. The finest table's chords err by 1e-6.
    shape = lambda x: (1 - x / 2) ** 3  # noqa: E731
    x = np.linspace(0, 1, max(points, 2))
    beam = bm.Beam(1.0, Table(x, shape(x)) if points else shape, 1.0)
    found = bm.beam_statics(beam, "clamped-free", "tip_force").deflection
    assert found == pytest.approx(bent(beam), rel=1e-11)
    if points > 100 or not points:
        function = bm.buckling_load(bm.Beam(1.0, shape, 1.0), "clamped-free")
        assert bm.buckling_load(beam, "clamped-free") == pytest.approx(function, rel=3e-6)


@pytest.mark.parametrize(("width", "centre"), [(0.002, 0.1), (0.0005, 0.37), (0.001, 0.7654321)])
def test_statics_and_buckling_see_a_notch(width: float, centre: float) -> None:
    notch = bm.Beam(1.0, lambda x: 1 - 0.9 * np.exp(-(((x - centre) / width) ** 2)), 1.0)
    found = bm.beam_statics(notch, "clamped-free", "tip_force").deflection
    assert found == pytest.approx(bent(notch), rel=1e-9)
    # First order in the width: a hinge of the notch's flexibility c, P = π²/4 (1 - 2 c cos²(πx/2)).
    added = width * math.sqrt(math.pi) * sum(0.9**k / k**0.5 for k in range(1, 400))
    first = math.pi**2 / 4 * (1 - 2 * added * math.cos(math.pi * centre / 2) ** 2)
    assert bm.buckling_load(notch, "clamped-free") == pytest.approx(first, rel=5 * added**2 + 2 * width)


@pytest.mark.parametrize("segments", [10, 40])
def test_a_kink_of_a_function_that_is_no_break_costs_second_order(segments: int) -> None:
    # Euler and Maclaurin at a kink of f = M²/EI on a hinge: the sum falls short of the integral by h²/12
    # times the jump of f', half-way between two it exceeds it by half of that; and e = -½ of it over ∫f = ω².
    for boundary, place, share in (
        ("clamped-free", 0.5, 1 / 12),
        ("clamped-free", 0.5 + 0.5 / segments, -1 / 24),
    ):
        kinked = lambda x, at=place: 1 - 0.6 / (1 - at) * np.maximum(x - at, 0)  # noqa: E731
        plain, marked = bm.Beam(1.0, kinked, 1.0), bm.Beam(1.0, kinked, 1.0, breaks=[place])
        modes = euler_bernoulli(plain, boundary, 1)
        moment = float(modes.shape(np.array([place]), derivative=2)[0, 0])
        jump = moment**2 * 0.6 / (1 - place)  # of (1/EI)' = -EI'/EI², EI = 1 there
        expected = 0.5 * share / segments**2 * jump / float(modes.angular_frequency[0]) ** 2
        kinks = first_error(plain, boundary, segments, "gregory")
        if share > 0:
            kinks -= first_error(marked, boundary, segments, "gregory")
        else:
            kinks -= first_error(bm.Beam(1.0, 1.0, 1.0), boundary, segments, "gregory")
        assert kinks == pytest.approx(expected, rel=0.1 if share > 0 else 0.35)


@pytest.mark.parametrize("told", ["breaks", "twice", "breaks out of order"])
def test_three_ways_to_say_a_break_are_one(told: str) -> None:
    ways = {
        "breaks": bm.Beam(1.0, KINKED, 1.0, breaks=[0.5, 0.25]),
        "twice": bm.Beam(1.0, Table((0.0, 0.5, 0.5, 1.0), (1.0, 1.0, 1.0, 0.4)), 1.0),
        "breaks out of order": bm.Beam(1.0, KINKED, 1.0, breaks=np.array([0.5])),
    }
    for rule in CORRECTED:
        expected = bm.Chain(KINK, "clamped-free", 12, rule).joint_stiffness
        found = bm.Chain(ways[told], "clamped-free", 12, rule).joint_stiffness
        np.testing.assert_allclose(found, expected, rtol=1e-14)


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "guided-pinned"])
def test_a_function_with_a_step_is_the_list_with_it(boundary: str) -> None:
    stepped = bm.Beam(1.0, lambda x: np.where(x < 0.5, 1.0, 0.25), lambda x: 2.0 - (x < 0.5), breaks=[0.5])
    listed = bm.Beam(1.0, [1.0, 0.25], [1.0, 2.0])
    assert stepped.breaks == listed.breaks
    for rule in EVERY_N:
        chains = [bm.Chain(beam, boundary, 8, rule) for beam in (stepped, listed)]
        for name in ("joint_stiffness", "mass", "centre", "rotary_inertia"):
            np.testing.assert_allclose(*(getattr(chain, name) for chain in chains), rtol=1e-13, atol=1e-18)
    found = [euler_bernoulli(beam, boundary, 5).angular_frequency for beam in (stepped, listed)]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-12)


# --- Steps and kinks -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("beam", "boundary", "few", "many"),
    [
        (STEP, "clamped-free", 20, 80),
        (STEP, "clamped-guided", 20, 80),
        (KINK, "clamped-free", 20, 80),
        # Errors of the step and of the ends cancel in short chains of these.
        (STEP, "clamped-clamped", 80, 320),
        (KINK, "clamped-clamped", 80, 320),
    ],
)
def test_a_hinge_on_a_step_or_kink_keeps_the_order(beam: bm.Beam, boundary: str, few: int, many: int) -> None:
    # Source: the quadrature's order, on both sides of the step as at a clamped end.
    for rule in ("gregory", "half_stub_corrected"):
        assert order(beam, boundary, rule, few, many) >= 3.5
    assert order(beam, boundary, "gregory2", few, many) >= 2.8
    for rule in ("double_wall", "mitiguy", "half_stub"):
        assert order(beam, boundary, rule, few, many) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("rule", ["mitiguy", "double_wall", "gregory2", "gregory", "half_stub_corrected"])
def test_a_step_inside_a_segment_costs_the_order(rule: str) -> None:
    # Each hinge stands for half a segment on either side. A step a quarter into a segment leaves a
    # quarter of one with the wrong EI, order 1; one in the middle, where cells of two hinges meet: order 2.
    assert order(QUARTERS, "clamped-free", rule, 65, 129) == pytest.approx(1, abs=0.15)
    assert order(QUARTERS, "clamped-free", rule, 66, 130) == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize(("few", "many"), [(65, 129), (66, 130)])
def test_the_error_of_a_misplaced_step_is_that_of_the_misplaced_stiffness(few: int, many: int) -> None:
    # By Rayleigh, δω/ω = -½ ∫ M² δ(1/EI) dx / ω² with unit modal mass, δ(1/EI) where the cells misplace it:
    # between the step and the edge of cells (segment's middle) next to it.
    modes = euler_bernoulli(QUARTERS, "clamped-free", 1)
    jump = 1 / 0.1 - 1 / 1.0
    moment = float(modes.shape(np.array([0.75 - 1e-9]), derivative=2)[0, 0])
    for n in (few, many):
        edge = (math.floor(0.75 * n) + 0.5) / n
        expected = -0.5 * moment**2 * jump * (0.75 - edge) / float(modes.angular_frequency[0]) ** 2
        found = first_error(QUARTERS, "clamped-free", n, "gregory")
        assert found == pytest.approx(expected, rel=0.05, abs=3 * 0.1 / n**2)


# --- Weights near a step, in exact numbers ---------------------------------------------------------------


def weights_and_places(rule: str, boundary: str, segments: int) -> list[tuple[Fraction, Fraction]]:
    record, pair = RULES[rule], bm.Boundary.of(boundary)
    lengths = record.piece_lengths(pair, segments)
    weights = list(record.hinge_weights(pair, segments))
    added = profile_weights(STEP, pair, record, lengths, ExactUnits.of(STEP, segments))
    assert sum(added.values()) == 0
    for j, change in added.items():
        weights[j] += change
    return list(zip(weights, accumulate(lengths[:-1]), strict=True))


def test_weights_near_a_step() -> None:
    # Gregory's end weights 3/8, 7/6, 23/24 from both sides of the step, at hinge 6.
    weights = [w for w, _ in weights_and_places("gregory", "clamped-free", 12)]
    sided = ["23/24", "7/6", "3/4", "7/6", "23/24"]
    assert weights == [Fraction(w) for w in ("3/8", "7/6", "23/24", "1", *sided, "1", "1", "1")]
    # Those of the midpoint rule, 13/12, 7/8, 25/24, either side of a step between two hinges.
    weights = [w for w, _ in weights_and_places("half_stub_corrected", "clamped-free", 12)]
    sided = ["25/24", "7/8", "13/12", "13/12", "7/8", "25/24"]
    assert weights == [Fraction(w) for w in ("13/12", "7/8", "25/24", *sided, "1", "1", "1")]
    # The trapezoidal rule has its own half weight from both sides, and nothing to add.
    assert {w for w, _ in weights_and_places("double_wall", "clamped-free", 12)} == {Fraction(1, 2), 1}


@pytest.mark.parametrize(
    ("rule", "degree"), [("gregory", 2), ("half_stub_corrected", 2), ("gregory2", 1), ("double_wall", 1)]
)
@pytest.mark.parametrize("segments", [8, 12, 26])
def test_quadrature_of_a_piecewise_polynomial_is_exact(rule: str, degree: int, segments: int) -> None:
    left, right = ([Fraction(3), Fraction(-7, 5), Fraction(11, 3)], [Fraction(1), Fraction(4), Fraction(-9)])

    def value(row: list[Fraction], x: Fraction) -> Fraction:
        return sum((a * x**k for k, a in enumerate(row[: degree + 1])), Fraction(0))

    half, total = Fraction(1, 2), Fraction(0)
    for weight, place in weights_and_places(rule, "clamped-clamped", segments):
        x = place / segments
        sides = (value(left, x), value(right, x))
        # A hinge on the step bends with the mean of both sides.
        total += weight / segments * (sides[0] if x < half else sides[1] if x > half else sum(sides) / 2)
    exact = sum(
        (row[k] * (high ** (k + 1) - low ** (k + 1)) / (k + 1))
        for row, low, high in ((left, Fraction(0), half), (right, half, Fraction(1)))
        for k in range(degree + 1)
    )
    assert total == exact


# --- Lists, as a user of a catheter's model has them -----------------------------------------------------


def test_catheter() -> None:
    # Source: the exact beam by `spectral_modes`, and orders 2 and 4 of hinges on every step.
    stiffness = list(nonuniform.CATHETER_STIFFNESS)
    stiffness[4] = -1.0
    with pytest.raises(ValueError, match="part 5 of 12"):
        bm.Beam(1.1, bending_stiffness=stiffness, mass_per_length=0.0045)
    found = {
        rule: np.array(
            [chain_errors(bm.Chain(nonuniform.CATHETER, "clamped-free", n, rule)) for n in (12, 24, 36)]
        )
        for rule in ("mitiguy", "gregory")
    }
    ratio = found["mitiguy"][0] / found["mitiguy"][2]
    assert ratio == pytest.approx(9, rel=0.02)
    assert np.abs(found["mitiguy"][1]) == pytest.approx([0.000725, 0.002415, 0.003801], rel=1e-3)
    assert (np.abs(found["gregory"][2]) < 0.05 * np.abs(found["mitiguy"][2])).all()


@pytest.mark.parametrize("times", [1, 2, 3])
def test_lists_are_the_chain_given_piece_by_piece(times: int) -> None:
    stiffness, mass = np.array([9.0, 7.0, 7.0, 4.0, 2.0, 1.0]), np.array([3.0, 3.0, 2.0, 2.5, 1.0, 1.5])
    n, length = 6 * times, 1.2
    chain = bm.Chain(bm.Beam(length, list(stiffness), list(mass)), "clamped-free", n, "mitiguy")
    ell, of_rod, heavy = length / n, np.repeat(stiffness, times), np.repeat(mass, times)
    # Each half cell bends with its own EI; the wall has 6N/(3N-1) EI/ell, the report's.
    inner = 1 / (ell * (1 / of_rod[1:] + 1 / of_rod[:-1]) / 2)
    springs = np.array([6 * n / (3 * n - 1) * of_rod[0] / ell, *inner])
    given = bm.Chain.from_pieces(
        length=np.array([0.0, *[ell] * n]),
        mass=np.array([0.0, *heavy * ell]),
        rotary_inertia=np.array([0.0, *heavy * ell**3 / 12]),
        joint_stiffness=springs,
        boundary="clamped-free",
    )
    assert chain.joint_stiffness == pytest.approx(springs, rel=1e-14)
    frequencies = [bm.solve_modes(bm.linearize(one), modes=n).angular_frequency for one in (chain, given)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-12)


# --- Rotary inertia --------------------------------------------------------------------------------------


@pytest.mark.parametrize("square", [1e-4, 1e-3])
def test_rotary_inertia_of_pinned_pinned_chains_and_beams(square: float) -> None:
    # y_j = sin qj: springs store 4 (1 - cos q)² N⁴, rods move with (2 + cos q)/3 + 2 r² N² (1 - cos q).
    beam, n, mode = bm.Beam(1.0, 1.0, 1.0, square), 12, np.arange(1, 6)
    c = np.cos(mode * np.pi / n)
    inertia = (2 + c) / 3 + 2 * square * n**2 * (1 - c)
    chain = bm.solve_modes(bm.linearize(bm.Chain(beam, "pinned-pinned", n, "gregory")), modes=5)
    assert chain.angular_frequency == pytest.approx(2 * n**2 * (1 - c) / np.sqrt(inertia), rel=1e-12)
    k = mode * np.pi
    exact = euler_bernoulli(beam, "pinned-pinned", 5).angular_frequency
    assert exact == pytest.approx(k**2 / np.sqrt(1 + square * k**2), rel=1e-12)


@pytest.mark.filterwarnings("ignore::beammodes.accuracy.chain_against_beam.SlendernessWarning")
@pytest.mark.parametrize("rule", EVERY_N)
def test_rotary_inertia_leaves_order_two(rule: str) -> None:
    beam = bm.Beam(1.0, 1.0, 1.0, 1e-3)
    assert order(beam, "pinned-pinned", rule, 40, 80) == pytest.approx(2, abs=0.05)
    if rule != "hencky":  # the leading term of the two closed forms above: -q² s/(24 (1 + s)), s = r² π²
        s = 1e-3 * math.pi**2
        leading = -((math.pi / 80) ** 2) * s / (24 * (1 + s))
        assert first_error(beam, "pinned-pinned", 80, rule) == pytest.approx(leading, rel=0.01)


@pytest.mark.filterwarnings("ignore::beammodes.accuracy.chain_against_beam.SlendernessWarning")
@pytest.mark.parametrize("rule", ["gregory", "half_stub_corrected"])
def test_rotary_inertia_takes_order_four_from_clamped_ends_too(rule: str) -> None:
    assert order(bm.Beam(1.0, 1.0, 1.0, 1e-2), "clamped-free", rule, 80, 160) == pytest.approx(2, abs=0.15)


# --- What theory leaves out ------------------------------------------------------------------------------


def timoshenko(radius: float, ratio: float, mode: int) -> float:
    """Lower ω of y = sin kx, ψ = cos kx:  ½∫ ψ'² + S (y' - ψ)²  against  ½ω²∫ y² + r² ψ², S = 1/(r² E/κG)."""
    k, shear = mode * math.pi, 1 / (radius**2 * ratio)
    stored = np.array([[shear * k**2, -shear * k], [-shear * k, k**2 + shear]])
    root = np.diag([1.0, 1 / radius])
    by_matrix = float(np.linalg.eigvalsh(root @ stored @ root)[0])
    # The same from both roots' formula: r⁴ g λ² - (1 + r² k² (1 + g)) λ + k⁴ = 0.
    b = 1 + (radius * k) ** 2 * (1 + ratio)
    by_root = 2 * k**4 / (b + math.sqrt(b * b - 4 * ratio * (radius * k) ** 4))
    assert by_matrix == pytest.approx(by_root, rel=1e-6)
    return math.sqrt(by_root)


@pytest.mark.parametrize("ratio", [SHEAR_RATIO, 2.5])
@pytest.mark.parametrize("radius", [1e-3, 0.02, 0.1])
def test_theory_errors_of_pinned_pinned_beams(radius: float, ratio: float) -> None:
    stout = [timoshenko(radius, ratio, n) for n in (1, 2, 3)]
    found = theory_errors(bm.Beam.unit(), "pinned-pinned", radius_of_gyration=radius, shear_ratio=ratio)
    euler = (np.arange(1, 4) * np.pi) ** 2
    assert found == pytest.approx(stout / euler - 1, rel=1e-9)
    # First order, -½ r² n² π² (1 + E/κG), is what Timoshenko's beam begins with.
    if radius == 1e-3:
        first = -0.5 * (radius * np.arange(1, 4) * np.pi) ** 2 * (1 + ratio)
        assert found == pytest.approx(first, rel=1e-3)
    # A beam with its own rotary inertia, Rayleigh's, has that part of the loss already.
    own = theory_errors(bm.Beam(1.0, 1.0, 1.0, radius**2), "pinned-pinned", shear_ratio=ratio)
    rayleigh = euler / np.sqrt(1 + radius**2 * euler)
    assert own == pytest.approx(stout / rayleigh - 1, rel=1e-9)


def test_a_stout_beam_warns() -> None:
    chain = bm.Chain(bm.Beam(1.0, 1.0, 1.0, 0.05**2), "clamped-free", 20, "mitiguy")
    with pytest.warns(
        SlendernessWarning, match="shear and what else Euler-Bernoulli theory leaves out"
    ) as caught:
        errors = chain_errors(chain, 2)
    assert caught[0].filename == __file__
    theory = theory_errors(chain.beam, "clamped-free", 2)  # type: ignore[arg-type]
    assert (np.abs(theory) > np.abs(errors)).all()


def test_a_slender_beam_does_not_warn() -> None:
    slender = bm.Beam(1.0, 1.0, 1.0, 1e-8)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        errors = chain_errors(bm.Chain(slender, "clamped-free", 10, "mitiguy"), 3)
        chain_errors(bm.Chain(bm.Beam.unit(), "clamped-free", 50, "gregory"), 3)  # no radius is known
    assert (np.abs(theory_errors(slender, "clamped-free")) < np.abs(errors)).all()


# --- Bad arguments ---------------------------------------------------------------------------------------


def bad_calls() -> list[tuple[Any, type[Exception], str]]:
    unit = bm.Beam.unit()
    loose = bm.Chain.from_pieces(
        length=[0, 1], mass=[0, 1], rotary_inertia=[0, 1 / 12], joint_stiffness=[1.0], boundary="clamped-free"
    )
    chain = bm.Chain(unit, "clamped-free", 3)
    buckled = Load(axial_force=-10.0)
    return [
        (lambda: bm.Beam(1.0, [1.0, -2.0], 1.0), ValueError, "^bending_stiffness"),
        (lambda: bm.Beam(1.0, [1.0, "2"], 1.0), TypeError, "^bending_stiffness"),
        (lambda: bm.Beam(1.0, 1.0, lambda x: 1 - x), ValueError, "^mass_per_length"),
        (lambda: bm.Beam(1.0, 1.0, 1.0, [0.0, -1.0]), ValueError, "^rotary_inertia_per_length"),
        (lambda: bm.Beam(2.0, Table((0, 1), (1, 2)), 1.0), ValueError, "^bending_stiffness"),
        (lambda: chain_errors(unit), TypeError, "^chain"),  # type: ignore[arg-type]
        (lambda: chain_errors(loose), ValueError, "^chain"),
        (lambda: chain_errors(chain, 0), ValueError, "^modes"),
        (lambda: chain_errors(chain, load=3.0), TypeError, "^load"),  # type: ignore[arg-type]
        (lambda: chain_errors(chain, load=buckled), ValueError, "axial_force"),
        (lambda: theory_errors(chain, "clamped-free"), TypeError, "^beam"),  # type: ignore[arg-type]
        (lambda: theory_errors(unit, "clamped-free"), ValueError, "^radius_of_gyration"),
        (
            lambda: theory_errors(unit, "clamped-free", radius_of_gyration=0.0),
            ValueError,
            "^radius_of_gyration",
        ),
        (
            lambda: theory_errors(unit, "clamped-free", radius_of_gyration=0.1, shear_ratio=-1),
            ValueError,
            "^shear_ratio",
        ),
        (lambda: theory_errors(unit, "clamped-hung", radius_of_gyration=0.1), ValueError, "^boundary"),
    ]


@pytest.mark.parametrize("case", range(15))
def test_bad_arguments_are_named(case: int) -> None:
    call, kind, told = bad_calls()[case]
    with pytest.raises(kind, match=told):
        call()


# --- The two studies -------------------------------------------------------------------------------------


def slope(errors: NDArray[np.float64], segments: NDArray[np.int64]) -> float:
    shown = np.flatnonzero(np.isfinite(errors))[-4:]
    return float(-np.polyfit(np.log(segments[shown]), np.log(np.abs(errors[shown])), 1)[0])


def test_study_of_nonuniform_beams_shows_the_orders_that_it_names() -> None:
    table = computed("nonuniform")
    named = {"1/N": 1, "1/N²": 2, "1/N⁴": 4}
    for *_, places in nonuniform.PANELS:
        for case, rule, text, *_ in places:
            errors = table.relative_error.sel(case=case, rule=rule).values
            declared = named[text.split()[-1]]
            assert slope(errors, table.segments.values) == pytest.approx(declared, abs=0.35)
    # The catheter's numbers of the test above, with two segments to a part.
    report = table.catheter_error.sel(rule="mitiguy", parts=24).values
    assert report == pytest.approx([-0.000725, -0.002415, -0.003801], rel=1e-3)


def test_study_of_axial_force_shows_the_orders_that_it_names() -> None:
    table = computed("axial_force")
    named = {"1/N²": 2, "1/N³": 3, "1/N⁴": 4}
    for pair, lines in axial_force.LABELS.items():
        for case, (text, *_) in lines.items():
            if ":" in text:
                errors = table.relative_error.sel(boundary=pair, case=case).values
                found = slope(errors, table.segments.values)
                assert found == pytest.approx(named[text.split()[-1]], abs=0.15)
    # theory.md section 4: clamped-free, half the buckling load, N = 20; by Hencky 4 N² sin²(π/(4N)).
    half = {"mitiguy": -1.4e-5, "gregory": -2.6e-4}
    for case, error in half.items():
        at = table.relative_error.sel(boundary="clamped-free", case=case, segments=20)
        assert float(at) == pytest.approx(error, rel=0.03)
    n = np.array(table.buckling_segments)
    own = (4 * n * np.sin(np.pi / (4 * n)) / np.pi) ** 2 - 1
    assert table.buckling_error.sel(rule="double_wall").values == pytest.approx(own, abs=1e-12)
    # Two rods buckle at 8 EI/L² of π².
    assert table.axial_force.sel(structure="mitiguy").min() == pytest.approx(-8 / math.pi**2, rel=1e-12)
