"""The law of the error: derived orders and coefficients against the exact error at large N."""

from __future__ import annotations

import dataclasses
import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
import sympy
from drawn_ends import EVERY_N

from beammodes.accuracy.law import _slope_energy, error_law, interior_coefficient, law_holds_from
from beammodes.chains.chain import Chain
from beammodes.chains.rules import MAX_END_WEIGHTS, RULES, Weight
from beammodes.closed_form.relative_errors import relative_error
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_beam import wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES
from beammodes.springs.tuning import mode_tuned
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

PAIRS = [pair.name for pair in BOUNDARIES]


@pytest.mark.parametrize("boundary", PAIRS)
@pytest.mark.parametrize("rule", EVERY_N)
def test_exact_error_tends_to_the_law(boundary: str, rule: str) -> None:
    segments = np.array([10**4, 10**5, 10**6, 10**7])
    for mode in (1, 2, 3):
        law = error_law(boundary, mode, rule)
        gap = np.abs(relative_error(boundary, segments, mode, rule) / law.at(segments) - 1)
        # The next term is at most a moderate multiple of 1/N; the lookup itself keeps nine digits.
        assert gap[0] < 0.2
        falls = gap[1:] < 0.15 * gap[:-1] + 3e-9
        assert falls.all(), (mode, gap)


@pytest.mark.parametrize("boundary", PAIRS)
@pytest.mark.parametrize("rule", EVERY_N)
def test_declared_order_is_derived_and_measured(boundary: str, rule: str) -> None:
    declared = RULES[rule].declared_order(next(pair for pair in BOUNDARIES if pair.name == boundary))
    errors = relative_error(boundary, np.array([10**6, 10**7]), 1, rule)
    assert error_law(boundary, 1, rule).order == declared
    assert np.log10(errors[0] / errors[1]) == pytest.approx(declared, abs=1e-3)


def test_the_reports_rule() -> None:
    # theory.md section 4: C/F  (1 - σβ)/(3 N²),  C/C twice that; σβ = |φ'''|/|φ''| at the wall.
    for boundary, walls in (("clamped-free", 1), ("clamped-clamped", 2)):
        for mode in (1, 2, 3):
            beam = euler_bernoulli(Beam.unit(), boundary, mode)
            moment, shear = (abs(beam.shape(np.array([0.0]), derivative=k)[-1, 0]) for k in (2, 3))
            law = error_law(boundary, mode, "mitiguy")
            assert law.coefficient == pytest.approx(walls * (1 - shear / moment) / 3, rel=1e-12)


def test_known_coefficients() -> None:
    # theory.md section 4: gregory -β⁴/1440; gregory2 -(σβ)²/6 a wall; naive -2 (w₀ - 1/2) = -1 a wall.
    assert error_law("clamped-free", 1, "gregory").coefficient == pytest.approx(
        -(wavenumber("clamped-free", 1) ** 4) / 1440, rel=1e-10
    )
    assert error_law("clamped-free", 1, "naive").coefficient == pytest.approx(-1, rel=1e-12)
    assert interior_coefficient() == Fraction(-1, 1440)


def test_end_corrections_are_exact_fractions() -> None:
    cancelled = {
        "gregory": 3,
        "half_stub_corrected": 3,
        "gregory2": 2,
        "rigid_stub_corrected": 2,
        "double_wall": 1,
    }
    for name, count in cancelled.items():
        defects = RULES[name].end_defects("clamped")
        assert defects[:count] == [(0, 0)] * count
        assert defects[count] != (0, 0)


@pytest.mark.parametrize("boundary", PAIRS)
def test_slope_energy_by_quadrature(boundary: str) -> None:
    x, weight = np.polynomial.legendre.leggauss(60)
    beam = euler_bernoulli(Beam.unit(), boundary, 3)
    slope = beam.shape((x + 1) / 2, derivative=1)[-1]
    assert _slope_energy(beam) == pytest.approx((slope**2 * weight / 2).sum(), rel=1e-10)


def least_change(hinges: int) -> list[Fraction]:
    """Weights of a welded first segment's hinges that integrate 1, x, x², least-squares closest to 1."""
    powers = sympy.Matrix([[sympy.Integer(j) ** k for j in range(1, hinges + 1)] for k in range(3)])
    # Euler and Maclaurin: f(0)/2 + f'(0)/12 + 0 f''(0) is what the sum from the first hinge on lacks.
    lacking = sympy.Matrix([sympy.Rational(1, 2), sympy.Rational(1, 12), 0])
    return [Fraction(str(1 + c)) for c in powers.T * (powers * powers.T).inv() * lacking]


def test_a_welded_first_segment_can_have_order_four_with_four_changed_springs() -> None:
    # Three changed springs would do but for a negative one: 24/55, -6, 8/11.
    assert least_change(3) == [Fraction(55, 24), Fraction(-1, 6), Fraction(11, 8)]
    weights = least_change(4)
    assert weights == [Fraction(479, 240), Fraction(173, 240), Fraction(39, 80), Fraction(311, 240)]
    rule = dataclasses.replace(
        RULES["rigid_stub_corrected"], name="four", clamped=tuple(map(Weight, weights))
    )
    assert rule.order["clamped"] == 4
    assert error_law("clamped-free", 1, rule).order == 4
    errors = relative_error("clamped-free", np.array([10, 10**6, 10**7]), 1, rule)
    assert np.log10(errors[1] / errors[2]) == pytest.approx(4, abs=1e-2)
    # Twenty times better than two changed springs at N = 10, same layout.
    assert abs(errors[0]) < abs(relative_error("clamped-free", 10, 1, "rigid_stub_corrected")) / 15


def test_rules_of_many_changed_springs_keep_their_digits() -> None:
    many = [tuple(map(Weight, least_change(hinges))) for hinges in (MAX_END_WEIGHTS, MAX_END_WEIGHTS + 1)]
    with pytest.raises(ValueError, match="clamped must have at most 8 weights, got 9"):
        dataclasses.replace(RULES["rigid_stub_corrected"], clamped=many[1])
    rule = dataclasses.replace(RULES["rigid_stub_corrected"], name="many", clamped=many[0])
    chain = Chain(Beam.unit(), "clamped-free", 60, rule)
    omega = solve_modes(linearize(chain), 5).angular_frequency
    exact = np.asarray(wavenumber("clamped-free", np.arange(1, 6))) ** 2
    found = relative_error("clamped-free", 60, np.arange(1, 6), rule)
    np.testing.assert_allclose(found, omega / exact - 1, rtol=1e-9, atol=3e-14)


def test_bad_arguments() -> None:
    with pytest.raises(ValueError, match=r"mode.*got 0"):
        error_law("clamped-free", 0)
    with pytest.raises(ValueError, match="gregory"):
        error_law("clamped-free", 1, "gregry")
    assert not math.isnan(error_law("free-clamped", 1).coefficient)
    assert error_law("free-clamped", 1).coefficient == pytest.approx(
        error_law("clamped-free", 1).coefficient, rel=1e-13
    )


@pytest.mark.parametrize("rule", EVERY_N)
def test_from_where_a_law_holds(rule: str) -> None:
    for pair, mode in itertools.product(("clamped-free", "pinned-pinned", "clamped-guided"), (1, 4)):
        law, first = error_law(pair, mode, rule), law_holds_from(pair, mode, rule)
        if first is None:
            assert math.isnan(law.coefficient)
            continue
        # Every N to ten times as many, one by one, and then some: within a fifth from there on, not before.
        far = np.geomspace(first, 10**9, 50).astype(int)
        counts = np.unique(np.concatenate([first + np.arange(10 * first), far]))
        error = np.asarray(relative_error(pair, counts, mode, rule))
        assert np.all(np.abs(law.at(counts) / error - 1) <= 0.2 * (1 + 1e-9))
        before = relative_error(pair, first - 1, mode, rule) if first > 1 else math.nan
        assert not abs(law.at(first - 1) - before) <= 0.2 * abs(before) if first > 1 else True


def test_a_law_of_the_other_sign_does_not_hold() -> None:
    # gregory, N = 12: the error is positive, the law negative (it changes sign at N ~ 113).
    assert (
        relative_error("clamped-free", 12, 1, "gregory") > 0 > error_law("clamped-free", 1, "gregory").at(12)
    )
    assert law_holds_from("clamped-free", 1, "gregory") > 113
    with pytest.raises(ValueError, match=r"^within must be greater than 0"):
        law_holds_from("clamped-free", 1, within=0.0)
    assert law_holds_from("clamped-free", 1, mode_tuned(1)) is None
