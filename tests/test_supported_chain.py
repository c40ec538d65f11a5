"""Uniform chains with springs, bodies and axial force, against their matrices in doubles and 60 digits."""

from __future__ import annotations

import itertools
import math
from decimal import Context, Decimal, localcontext
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from drawn_ends import EVERY_N, RULES_DRAWN
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.closed_form import supported_chain
from beammodes.closed_form.chain_frequencies import chain_frequency
from beammodes.closed_form.supported_chain import (
    block_of,
    carried,
    closed,
    joined,
    row_of_rods,
    shortened,
    supported_chain_frequencies,
    supported_chain_frequency,
)
from beammodes.numerics.counted_roots import ROOT_DIGITS, Sample, ordered_roots
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import LinearModel, linearize, nodal_matrices
from beammodes.vibration.modes import solve_modes

HALF = Fraction(1, 2)


def random_end(random: np.random.Generator) -> End:
    """Springs over 12 decades, masses over 6, inertias over 7, offsets of half a length; many absent."""

    def absent(value: float, probability: float) -> float:
        return 0.0 if random.random() < probability else value

    def spring() -> float:
        return math.inf if random.random() < 0.25 else absent(10 ** random.uniform(-6, 6), 0.4)

    return End(
        spring(),
        spring(),
        absent(10 ** random.uniform(-3, 3), 0.5),
        absent(10 ** random.uniform(-5, 2), 0.6),
        absent(random.uniform(-0.5, 0.5), 0.5),
    )


def random_force(random: np.random.Generator, model: LinearModel) -> float:
    """None, tension up to 50, or half of a compression that the chain bears."""
    kind = random.random()
    if kind < 0.4:
        return 0.0
    if kind < 0.7:
        return float(10 ** random.uniform(-4, 1.7))
    return -half_of_buckling(model)


def half_of_buckling(model: LinearModel) -> float:
    """Half the least P for which K - P G is singular, from the matrices; 0 if there is none or no K⁻¹."""
    if model.chain.boundary.rigid_body_modes or not model.elastic_modes:
        return 0.0
    plain = model.stiffness_matrix
    geometric = linearize(model.chain, load=Load(1.0)).stiffness_matrix - plain
    root = np.linalg.inv(np.linalg.cholesky(plain))
    most = float(np.linalg.eigvalsh(root @ geometric @ root.T)[-1])
    return 0.5 / most if most > 0 else 0.0


def random_model(random: np.random.Generator, most: int) -> tuple[LinearModel, Boundary, int, Rule]:
    rule = RULES[str(random.choice(RULES_DRAWN))]
    size = int(np.exp(random.uniform(0, np.log(most + 0.99))))
    pair = Boundary(random_end(random), random_end(random))
    chain = Chain(Beam.unit(), pair, size, rule)
    model = linearize(chain)
    return linearize(chain, load=Load(random_force(random, model))), pair, size, rule


def exact(model: LinearModel, segments: int) -> list[float]:
    """All elastic frequencies for L = EI = ρA = 1, from the exact rational matrices in 60 digits."""
    _, mass, stiffness = nodal_matrices(model.chain, Fraction, model.load)
    if not mass:
        return []
    with mpmath.workdps(60):
        matrices = [
            mpmath.matrix([[mpmath.mpf(v.numerator) / v.denominator for v in row] for row in rows])
            for rows in (mass, stiffness)
        ]
        root = mpmath.inverse(mpmath.cholesky(matrices[0]))
        squares = sorted(mpmath.eigsy(root * matrices[1] * root.T, eigvals_only=True))
        return [float(mpmath.sqrt(square) * segments**2) for square in squares[model.rigid_body_modes :]]


def against_matrices(seed: int, cases: int, most: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(cases):
        model, pair, size, rule = random_model(random, most)
        expected = solve_modes(model).angular_frequency[:20]
        found = supported_chain_frequencies(pair, size, len(expected) + 2, rule, model.load)
        assert np.isnan(found[model.elastic_modes :]).all()
        assert not np.isnan(found[: model.elastic_modes]).any()
        # A singular value is right to some last places of the largest, in 1/ω: so to ω/ω₁ last places.
        kept = np.maximum(1e-12, 1e-14 * expected / expected[:1])
        assert np.all(np.abs(found[: len(expected)] / expected - 1) < kept), (pair, size, rule.name)


def test_random_chains_against_their_matrices() -> None:
    against_matrices(seed=0, cases=50, most=80)


@pytest.mark.slow
def test_more_and_longer_random_chains_against_their_matrices() -> None:
    against_matrices(seed=1, cases=120, most=300)


@pytest.mark.parametrize("seed", range(10))
def test_random_short_chains_in_60_digits(seed: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(3):
        model, pair, size, rule = random_model(random, 12)
        expected = exact(model, size)
        assert len(expected) == model.elastic_modes
        found = supported_chain_frequencies(pair, size, len(expected) + 1, rule, model.load)
        np.testing.assert_allclose(found[:-1], expected, rtol=3e-16)


# The row in closed form has equal rods and springs, so these are the rules with equal springs inside.
@pytest.mark.parametrize("rule", EVERY_N)
def test_every_mode_of_every_closed_rule_in_60_digits(rule: str) -> None:
    # N = 13 and 14 with either parity of what is cut out: modes in the band, at its edge and above it.
    pair = Boundary.of("clamped(mass=1)-free(mass=0.5, rotary_inertia=1e-6, offset=0.1)")
    for size, force in ((13, 0.0), (14, -0.5)):
        model = linearize(Chain(Beam.unit(), pair, size, rule), load=Load(force))
        found = supported_chain_frequencies(pair, size, model.elastic_modes, rule, model.load)
        np.testing.assert_allclose(found, exact(model, size), rtol=3e-16)


@pytest.mark.parametrize("pair", BOUNDARIES)
def test_plain_ends_against_the_closed_form(pair: Boundary) -> None:
    # Source: dispersion.chain_frequency, which shares no formula with the count by planes.
    for size, rule in itertools.product((10, 1000, 10**6), ("mitiguy", "rigid_stub_corrected")):
        modes = np.arange(1, 13 if size > 10 else size)
        expected = chain_frequency(pair, size, modes, rule)
        found = supported_chain_frequencies(pair, size, len(modes), rule)
        np.testing.assert_allclose(found, expected, rtol=2e-14)


def test_all_modes_of_a_chain_that_is_cut() -> None:
    for pair, rule, size in itertools.product(BOUNDARIES[::3], ("hencky", "gregory", "half_stub"), (25, 26)):
        expected = np.asarray(chain_frequency(pair, size, np.arange(1, size + 3), rule))
        found = supported_chain_frequencies(pair, size, size + 2, rule)
        np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_the_parts_count_and_vanish_as_the_whole_does() -> None:
    # The whole chain as one block, a Sturm sequence over all its hinges, against blocks and a row.
    random = np.random.default_rng(3)
    with localcontext(Context(prec=80)):
        for rule in map(RULES.__getitem__, EVERY_N):  # The row between the blocks has equal springs.
            pair = Boundary(random_end(random), random_end(random))
            short, rods = shortened(pair, 40, rule) or (None, 0)
            assert short is not None and rods > 20
            chain = Chain(Beam.unit(), pair, 40, rule)
            pieces, half = short.scaled, short.pieces // 2
            blocks = [block_of(pieces, half, HALF), block_of(pieces.turned(), short.pieces - half, HALF)]
            whole = block_of(chain.scaled, chain.pieces)
            far = block_of(chain.scaled.turned(), 0).supports
            ratios = []
            for square in np.geomspace(1e-12, 200.0, 40):
                w, tension = Decimal(square), Decimal("0.01")
                planes = [carried(block, w, tension) for block in blocks]
                row = row_of_rods(
                    rods, Decimal(rule.rotary_inertia.numerator) / rule.rotary_inertia.denominator, tension, w
                )
                count, value = joined(planes, row)
                expected, determinant = closed(carried(whole, w, tension), far)
                assert count == expected
                assert (value < 0) == (determinant < 0) == bool(count % 2)
                ratios.append(value / determinant)
            assert min(ratios) > 0


@pytest.mark.parametrize(
    ("rule", "coarse", "fine"),
    [("mitiguy", 10**3, 10**4), ("rigid_stub", 10**4, 10**6), ("gregory", 600, 1200)],
)
def test_long_chains_with_a_tip_mass_approach_the_beam_at_the_rules_order(
    rule: str, coarse: int, fine: int
) -> None:
    # Source: supported_beam.supported_modes, which knows no chain.
    beam = pytest.importorskip("beammodes.exact.supported_beam")
    pair = Boundary.of("clamped-free(mass=1, rotary_inertia=0.1, offset=0.2)")
    expected = beam.supported_modes(Beam.unit(), pair, 5).angular_frequency
    errors = [supported_chain_frequencies(pair, size, 5, rule) / expected - 1 for size in (coarse, fine)]
    order = np.log(errors[0] / errors[1]) / np.log(fine / coarse)
    np.testing.assert_allclose(order, RULES[rule].declared_order(pair), atol=0.1)


def test_a_chain_of_ten_million_segments_is_the_beam() -> None:
    # Source: supported_beam.supported_modes. At order 2 the error left is about 1e-13 here.
    beam = pytest.importorskip("beammodes.exact.supported_beam")
    for ends, force in (
        ("clamped-free(mass=1)", 0.0),
        ("free(translational_stiffness=1e-5)-free(mass=9)", 7.0),
    ):
        expected = beam.supported_modes(Beam.unit(), ends, 6, load=Load(force)).angular_frequency
        found = supported_chain_frequencies(ends, 10**7, 6, load=Load(force))
        np.testing.assert_allclose(found, expected, rtol=2e-13)


@pytest.mark.parametrize("segments", [1, 7, 10**7, 10**9])
def test_soft_springs_leave_a_rigid_bar(segments: int) -> None:
    # Bar of mass 1 and inertia 1/12 on two springs k: bounce ω² = 2k, pitch ω² = 2k (1/2)²/(1/12) = 6k.
    soft = End(translational_stiffness=1e-20)
    found = supported_chain_frequencies((soft, soft), segments, 2)
    np.testing.assert_allclose(found, np.sqrt([2e-20, 6e-20]), rtol=3e-16)


@pytest.mark.parametrize("segments", [1, 7, 10**7, 10**9])
def test_a_heavy_tip_mass_swings_on_the_static_stiffness(segments: int) -> None:
    # The rule's tip stiffness is the beam's, 3 EI/L³: ω² = 3/m.
    found = supported_chain_frequencies(("clamped", End(mass=1e20)), segments, 1, "mitiguy")
    np.testing.assert_allclose(found, np.sqrt([3e-20]), rtol=3e-16)


@pytest.mark.parametrize("segments", [4, 30, 1001, 10**6])
def test_near_the_chains_own_buckling_load(segments: int) -> None:
    # 16 x² + 4 t x = 0 at q = π/N: the pinned chain buckles at P = 4 N² sin²(π/2N); ω² falls as 1 - T/P.
    with mpmath.workdps(60):
        critical = mpmath.mpf(4 * segments**2) * mpmath.sin(mpmath.pi / (2 * segments)) ** 2
        load = Fraction(int(critical * 2**160), 2**160)
    below, beyond = (Load(-load * (1 + sign * Fraction(1, 10**10))) for sign in (-1, 1))
    plain = supported_chain_frequencies("pinned-pinned", segments, 1)
    found = supported_chain_frequencies("pinned-pinned", segments, 1, load=below)
    np.testing.assert_allclose(found, plain * 1e-5, rtol=1e-15)
    with pytest.raises(ValueError, match="axial_force must not compress"):
        supported_chain_frequencies("pinned-pinned", segments, 1, load=beyond)


def test_a_loose_chain_bears_no_compression() -> None:
    for ends in ("free-free", "pinned-free", "guided-free"):
        with pytest.raises(ValueError, match="axial_force"):
            supported_chain_frequencies(ends, 50, 1, load=Load(-1e3 if ends == "guided-free" else -1e-9))


def test_sections_that_turn() -> None:
    # Source: the matrix route with the beam's own rotary inertia.
    pair = Boundary.of("clamped-free(mass=0.3)")
    for size, rule in itertools.product((3, 17, 60), ("mitiguy", "half_stub")):
        chain = Chain(Beam(1.0, 1.0, 1.0, 0.02), pair, size, rule)
        expected = solve_modes(linearize(chain)).angular_frequency
        found = supported_chain_frequencies(pair, size, len(expected), rule, rotary_inertia=0.02)
        np.testing.assert_allclose(found, expected, rtol=1e-11)


def test_eight_weights_at_both_ends() -> None:
    weights = tuple(Weight(Fraction(w, 10), Fraction(1, 3)) for w in (4, 13, 8, 12, 9, 11, 10, 12))
    rule = Rule("eight", weights, weights[::-1])
    for pair, size in itertools.product(
        ("clamped-guided", "guided-free(rotary_inertia=0.01)"), (5, 19, 31, 40)
    ):
        expected = solve_modes(linearize(Chain(Beam.unit(), pair, size, rule))).angular_frequency
        found = supported_chain_frequencies(pair, size, len(expected), rule)
        np.testing.assert_allclose(found, expected, rtol=1e-11)


def test_either_order_of_the_ends() -> None:
    pair = Boundary.of("free(translational_stiffness=2, mass=3, offset=0.1)-pinned(rotational_stiffness=0.5)")
    for size in (9, 10**5):
        here, there = (
            supported_chain_frequencies(p, size, 6, "gregory", Load(3.0)) for p in (pair, pair.turned)
        )
        np.testing.assert_allclose(here, there, rtol=3e-16)


def test_nearly_equal_frequencies_are_two() -> None:
    # Two light rotors behind equal stiff hinges turn in phase or against it, far above the rest.
    end = End(math.inf, 0.0, rotary_inertia=1e-12)
    found = supported_chain_frequencies((end, end), 30, 31, "mitiguy")
    assert not np.isnan(found).any()
    np.testing.assert_allclose(found[-2], found[-1], rtol=1e-12)


def test_double_roots_are_listed_twice() -> None:
    def evaluate(x: Decimal) -> Sample:
        return Sample(x, 2 * (x > 2) + (x > 9), (x - 2) ** 2 * (x - 9))

    with localcontext(Context(prec=50)):
        found = ordered_roots(evaluate, evaluate(Decimal(1)), evaluate(Decimal(100)), 3)
        assert all(
            abs(root / place - 1) <= Decimal(10) ** -ROOT_DIGITS
            for root, place in zip(found, (2, 2, 9), strict=True)
        )
        assert ordered_roots(evaluate, evaluate(Decimal(1)), evaluate(Decimal(100)), 1) == found[:1]


@pytest.mark.parametrize("ends", [(2, "2.5"), (1, 3), (2, 3), ("1.6", 3), (2, 4), (1, 4)])
def test_roots_exactly_where_the_search_begins_or_ends(ends: tuple[int | str, int | str]) -> None:
    # A root at the lower place is the search's, one at the upper place the next one's.
    def evaluate(x: Decimal) -> Sample:
        return Sample(x, sum(x > root for root in (2, 3)), (x - 2) * (x - 3))

    low, high = (evaluate(Decimal(end)) for end in ends)
    found = ordered_roots(evaluate, low, high, 2)
    assert found == pytest.approx([root for root in (2, 3) if low.place <= root < high.place], rel=1e-23)


def test_a_root_that_is_met_exactly() -> None:
    # One rod that can only shift, ω² = K_t/m: the hint squares to the spring itself.
    pair = Boundary.of("free(rotational_stiffness=0.5)-guided(translational_stiffness=0.25)")
    found = supported_chain_frequency(pair, 1, RULES["rigid_stub"], 0.0, 0.0, mode=1, near=0.5)
    assert found == 0.5


def test_what_does_not_exist_is_not_a_number() -> None:
    assert np.isnan(supported_chain_frequencies("clamped-clamped", 1, 2)).all()
    assert np.isnan(supported_chain_frequencies("clamped-free", 2, 3)).tolist() == [False, False, True]
    negative = Rule("negative", [Weight(HALF, -10)], ())
    assert np.isnan(supported_chain_frequencies("clamped-free", 4, 2, negative)).all()
    assert not np.isnan(supported_chain_frequencies("clamped-free", 400, 2, negative)).any()


def test_more_digits_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(5)
    cases = [
        (Boundary(random_end(random), random_end(random)), int(10 ** random.uniform(0, 9))) for _ in range(20)
    ]
    few, many = [], []
    for found, digits in ((few, 30), (many, 120)):
        monkeypatch.setattr(supported_chain, "_DIGITS", digits)
        found += [supported_chain_frequencies(pair, size, 4, load=Load(1e-3)) for pair, size in cases]
    np.testing.assert_array_equal(few, many)


def test_digits_do_not_depend_on_the_callers() -> None:
    expected: NDArray[np.float64] = supported_chain_frequencies("clamped-free(mass=2)", 10**6, 3)
    with localcontext(Context(prec=3)):
        np.testing.assert_array_equal(supported_chain_frequencies("clamped-free(mass=2)", 10**6, 3), expected)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"boundary": "clamped"}, "boundary"),
        ({"segments": 0}, "segments"),
        ({"segments": 10**9 + 1}, "segments"),
        ({"modes": 0}, "modes"),
        ({"rule": "unknown"}, "rule"),
        ({"load": 3.0}, "load"),
        ({"rotary_inertia": -1.0}, "rotary_inertia"),
    ],
)
def test_bad_arguments_are_named(change: dict[str, object], message: str) -> None:
    arguments = {"boundary": "clamped-free", "segments": 10, "modes": 2} | change
    with pytest.raises((TypeError, ValueError), match=message):
        supported_chain_frequencies(**arguments)  # type: ignore[arg-type]
