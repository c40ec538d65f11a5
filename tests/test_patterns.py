"""Rules whose springs inside repeat a pattern: weights, order, law and errors, against solved chains."""

from __future__ import annotations

import math
from fractions import Fraction as F

import mpmath
import numpy as np
import pytest

import beammodes as bm
from beammodes.chains.rules import RULES, closed_rule, end_defects
from beammodes.closed_form.exact_states import characteristic_polynomial
from beammodes.problem.ends import BOUNDARIES, Boundary

SIMPSON = bm.RULES["simpson"]
THIRDS = bm.Rule("thirds", ["1/2"], inside=["4/5", "4/5", "7/5"])
MIDDLES = bm.Rule("middles", [], guided=[], stub="1/2", inside=["3/4", "3/2", "3/4"])
PATTERNS = {rule.name: rule for rule in (*RULES.values(), THIRDS, MIDDLES) if not rule.has_equal_springs}
EVERY = pytest.mark.parametrize("rule", PATTERNS.values(), ids=PATTERNS)
UNIT = bm.Beam.unit()


def test_simpson_is_simpsons_rule() -> None:
    # Weights of the composite rule: exact for cubics (h⁴ f''' /180 at the ends is what it leaves).
    weights = SIMPSON.hinge_weights(Boundary.of("clamped-clamped"), 6)
    assert weights == [F(1, 3), F(4, 3), F(2, 3), F(4, 3), F(2, 3), F(4, 3), F(1, 3)]
    assert [sum(w * F(j, 6) ** k for j, w in enumerate(weights)) / 6 for k in range(4)] == [
        1,
        F(1, 2),
        F(1, 3),
        F(1, 4),
    ]
    assert [constant for constant, _ in SIMPSON.end_defects("clamped")] == [0, 0, 0, F(-1, 180)]
    assert SIMPSON.order == RULES["gregory"].order
    assert SIMPSON.guided == (bm.Weight("1/3"),)


@EVERY
def test_defects_are_those_of_the_sum(rule: bm.Rule) -> None:
    # Against the sum itself, of a polynomial that vanishes with its derivatives at the far end, for which
    # Euler and Maclaurin's series ends: nothing but this end is wrong.
    count = next(n for n in range(12, 24) if rule.fits(n))
    lengths = rule.piece_lengths(Boundary.of("clamped-clamped"), count)
    places = [sum(lengths[: j + 1], F(0)) for j in range(len(lengths) - 1)]
    weights = rule.hinge_weights(Boundary.of("clamped-clamped"), count)
    first, *_ = places
    for k in range(4):
        # f = (x - N)⁴-like terms leave the far end alone up to its fourth power; x^k/k! has f⁽ᵏ⁾(0) = 1.
        both = [c for c, _ in rule.end_defects("clamped")]
        total = sum(w * x**k for w, x in zip(weights, places, strict=True)) / math.factorial(k)
        integral = F(count) ** (k + 1) / math.factorial(k + 1)
        # At the far end, from which x = N - y: f⁽ⁱ⁾ = (-1)ⁱ N^(k-i)/(k-i)!.
        far = sum(both[i] * (-1) ** i * F(count) ** (k - i) / math.factorial(k - i) for i in range(k + 1))
        assert total - integral == both[k] + far
    assert first == rule.stub


@EVERY
@pytest.mark.parametrize("boundary", BOUNDARIES, ids=str)
def test_error_follows_the_law(rule: bm.Rule, boundary: Boundary) -> None:
    count = next(n for n in range(120, 140) if rule.fits(n))
    law = bm.error_law(boundary, 2, rule)
    if law.order == rule.declared_order(boundary):
        found = bm.frequency_error(boundary, segments=[count, 2 * count], mode=2, rule=rule)
        ratio = np.asarray(found) / law.at(np.array([count, 2 * count]))
        assert abs(ratio[1] - 1) < 0.08
        assert abs(ratio[1] - 1) < abs(ratio[0] - 1) or abs(ratio[0] - 1) < 1e-3


@EVERY
@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "guided-pinned", "free-free"])
def test_frequencies_in_fifty_digits(rule: bm.Rule, boundary: str) -> None:
    # The characteristic polynomial in rational numbers: transfer over rods and hinges, no matrices.
    count = next(n for n in range(6, 16) if rule.fits(n))
    pair = Boundary.of(boundary)
    coefficients = characteristic_polynomial(rule, pair, count)
    with mpmath.workdps(60):
        roots = mpmath.polyroots(
            [mpmath.mpf(c.numerator) / c.denominator for c in coefficients[::-1]], 500, extraprec=800
        )
        exact = sorted(float(mpmath.sqrt(mpmath.re(root))) * count**2 for root in roots)[:3]
    chain = bm.Chain(UNIT, pair, count, rule)
    np.testing.assert_allclose(bm.solve_modes(bm.linearize(chain), 3).angular_frequency, exact, rtol=2e-13)
    errors = bm.frequency_error(pair, segments=count, mode=[1, 2, 3], rule=rule)
    beam = bm.euler_bernoulli(UNIT, pair, 3).angular_frequency
    np.testing.assert_allclose(errors, np.array(exact) / beam - 1, rtol=0, atol=1e-12)


@EVERY
def test_a_number_of_segments_that_does_not_fit(rule: bm.Rule) -> None:
    count = next(n for n in range(10, 20) if not rule.fits(n))
    with pytest.raises(
        ValueError, match=f"segments must be a multiple of .* with rule {rule.name}, .* got {count}"
    ):
        bm.Chain(UNIT, "clamped-free", count, rule)
    assert math.isnan(bm.frequency_error("clamped-free", segments=count, mode=1, rule=rule))
    assert (
        "segments must be a multiple of"
        in bm.error_remarks("clamped-free", segments=count, mode=1, rule=rule)[0]
    )
    enough = bm.segments_needed("clamped-free", 0.004, 3, rule)
    assert rule.fits(enough)
    errors = bm.frequency_error("clamped-free", segments=np.arange(1, 60)[:, None], mode=[1, 2, 3], rule=rule)
    worst = np.abs(errors).max(axis=1)
    there = np.array([rule.fits(n) for n in range(1, 60)])
    assert np.isnan(worst[~there]).all()
    assert (worst[enough - 1 :][there[enough - 1 :]] <= 0.004).all() or enough >= 60


def test_several_rules_at_once_keep_the_digits_of_closed_forms() -> None:
    alone = bm.frequency_error("clamped-free", segments=10**6, mode=1, rule="gregory")
    both = bm.frequency_error("clamped-free", segments=[[10**6], [8]], mode=1, rule=["gregory", "mitiguy"])
    mixed = bm.frequency_error("clamped-free", segments=[10**6, 8], mode=1, rule=["gregory", "simpson"])
    assert both[0, 0] == mixed[0] == alone
    assert mixed[1] == bm.frequency_error("clamped-free", segments=8, mode=1, rule="simpson")


def test_what_needs_equal_springs_says_so() -> None:
    for call in (closed_rule, lambda rule: bm.chain_frequency("clamped-free", 8, 1, rule)):
        with pytest.raises(ValueError, match="must have equal springs inside for a closed form, got simpson"):
            call("simpson")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"inside": []}, "inside must have one or more weights of mean 1"),
        ({"inside": ["4/3", "1/3"]}, "inside must have one or more weights of mean 1"),
        ({"inside": ["1/2", "1", "3/2"]}, "inside must read the same from both ends for some N"),
        ({"inside": [bm.Weight(1, 1)]}, "inside must be numbers that do not depend on N"),
        ({"inside": "4/3"}, "inside must be a sequence of weights"),
        ({"inside": [1] * 9}, "inside must have at most 8 weights"),
    ],
)
def test_patterns_that_are_none(changes: dict[str, object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        bm.Rule("own", ["1/2"], **changes)


def test_a_pattern_of_one_weight_is_none() -> None:
    assert bm.Rule("own", ["3/8", "7/6", "23/24"], inside=[1]) == bm.Rule("own", ["3/8", "7/6", "23/24"])
    gregory = [(F(w), F(0)) for w in ("3/8", "7/6", "23/24")]
    assert end_defects(F(0), gregory) == end_defects(F(0), gregory, [F(1), F(1)])


def test_simpson_beside_gregory_on_a_cantilever() -> None:
    # The page "theory" has this table; three modes, percent.
    largest = {
        (rule, n): 100
        * np.abs(bm.frequency_error("clamped-free", segments=n, mode=[1, 2, 3], rule=rule)).max()
        for rule in ("simpson", "gregory")
        for n in (8, 10)
    }
    assert [round(largest["simpson", n], 3) for n in (8, 10)] == [0.24, 0.029]
    assert [round(largest["gregory", n], 2) for n in (8, 10)] == [0.81, 0.22]
    ways = bm.recommend("clamped-free", tolerance=0.005, modes=3)
    assert (ways[0].rule, ways[0].segments) == ("simpson", 8)


def test_a_taper_and_a_step_cost_simpson_no_order() -> None:
    # theory.md section 4: the weights integrate M²/EI, on both sides of a step that stands on the pattern.
    taper = bm.Beam(1.0, lambda x: 1.0 + x, 1.0)
    step = bm.Beam(1.0, [2.0, 1.0], 1.0)
    for beam in (taper, step):
        errors = [
            np.abs(bm.chain_errors(bm.Chain(beam, "clamped-guided", n, "simpson"), 2)) for n in (20, 40)
        ]
        assert (np.log2(errors[0] / errors[1]) > 3.5).all()


def test_more_modes_than_can_be_solved_are_refused_by_name() -> None:
    # N is sought up to 1000 for a pattern inside, and every N up to three times the modes is looked at.
    with pytest.raises(ValueError, match=r"^modes must be at most"):
        bm.segments_needed("clamped-free", tolerance=0.01, modes=1000, rule="simpson")
