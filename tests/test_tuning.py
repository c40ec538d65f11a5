"""Chains whose springs are solved for, judged in 50-digit arithmetic and by an independent optimizer."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray
from turns import in_turns

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_beam import wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, Boundary
from beammodes.springs.inverse_eigenvalue import Conditions, spring_state, symmetric_basis
from beammodes.springs.matched_springs import (
    Matched,
    MatchedSprings,
    NoPositiveSprings,
    match_springs,
    matched,
)
from beammodes.springs.tuning import ModeTuned, mode_tuned
from beammodes.vibration.linear import linearize, nodal_matrices
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.spectrum import flexibility_form
from beammodes.vibration.stability import highest_angular_frequency, stable_time_step

Judge = Callable[[Chain], list[mpmath.mpf]]

CHARACTERISTIC: dict[str, Callable[[Any], Any]] = {
    "clamped-clamped": lambda b: mpmath.cos(b) - mpmath.sech(b),
    "free-free": lambda b: mpmath.cos(b) - mpmath.sech(b),
    "clamped-free": lambda b: mpmath.cos(b) + mpmath.sech(b),
    "clamped-pinned": lambda b: mpmath.sin(b) - mpmath.cos(b) * mpmath.tanh(b),
    "pinned-free": lambda b: mpmath.sin(b) - mpmath.cos(b) * mpmath.tanh(b),
    "clamped-guided": lambda b: mpmath.sin(b) + mpmath.cos(b) * mpmath.tanh(b),
    "guided-free": lambda b: mpmath.sin(b) + mpmath.cos(b) * mpmath.tanh(b),
    "pinned-pinned": mpmath.sin,
    "guided-guided": mpmath.sin,
    "pinned-guided": mpmath.cos,
}


def worst_error(springs: MatchedSprings, judge: Judge) -> float:
    """Largest |ω_chain/ω_beam - 1| of the matched modes, both in 50 digits; for L = EI = ρA = 1."""
    found = judge(springs.chain)[springs.boundary.rigid_body_modes :]
    function = CHARACTERISTIC[springs.boundary.canonical.name]
    with mpmath.workdps(50):
        roots = [mpmath.findroot(function, wavenumber(springs.boundary, n + 1)) for n in range(springs.modes)]
        return float(max(abs(found[n] / root**2 - 1) for n, root in enumerate(roots)))


def elastic_modes(boundary: Boundary | str, segments: int) -> int:
    return Chain(Beam.unit(), boundary, segments, "naive").elastic_modes


def exact_tip_compliance(chain: Chain) -> Fraction:
    """Deflection of the last node under a unit force there, by exact elimination."""
    _, _, stiffness = nodal_matrices(chain, Fraction)
    rows = [[*row, Fraction(int(i == len(stiffness) - 1))] for i, row in enumerate(stiffness)]
    for i, pivot in enumerate(rows):
        for row in rows[i + 1 :]:
            factor = row[i] / pivot[i]
            for j in range(i, len(row)):
                row[j] -= factor * pivot[j]
    return rows[-1][-1] / rows[-1][-2]


# --- the promised frequencies --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("boundary", "segments"),
    [
        # Some lengths of either pair, with both criteria; the rest with the slow tests.
        pytest.param(boundary, n, marks=[] if n in (3, 4, 5, 6, 12) else [pytest.mark.slow])
        for boundary, few in (("clamped-free", 3), ("clamped-clamped", 4))
        for n in range(few, 13)
    ],
)
def test_three_modes_are_exact(boundary: str, segments: int, frequencies_in_50_digits: Judge) -> None:
    criterion = ("gregory", "uniform")[segments % 2]
    springs = match_springs(boundary, segments, 3, criterion=criterion)
    assert worst_error(springs, frequencies_in_50_digits) < 1e-12
    assert springs.stiffness_ratio.min() > 0.5
    assert np.abs(springs.frequency_errors).max() < 1e-12
    assert springs.symmetric == (boundary == "clamped-clamped")


@pytest.mark.parametrize(("boundary", "segments"), in_turns(BOUNDARIES, [1, 2, 3, 5], every=2), ids=str)
def test_every_elastic_mode_is_exact(
    boundary: Boundary, segments: int, frequencies_in_50_digits: Judge
) -> None:
    count = elastic_modes(boundary, segments)
    if count == 0:
        with pytest.raises(ValueError, match="modes must be at most 0"):
            match_springs(boundary, segments, 1)
        return
    springs = match_springs(boundary, segments, count, symmetric=False)
    assert worst_error(springs, frequencies_in_50_digits) < 1e-12
    assert 0 < springs.stiffness_ratio.min() < springs.stiffness_ratio.max() * 1.01 < 10


@pytest.mark.slow
@pytest.mark.parametrize("segments", [4, *range(6, 13)])
@pytest.mark.parametrize("boundary", BOUNDARIES, ids=str)
def test_every_elastic_mode_of_longer_chains_is_exact(
    boundary: Boundary, segments: int, frequencies_in_50_digits: Judge
) -> None:
    springs = match_springs(boundary, segments, elastic_modes(boundary, segments), symmetric=False)
    assert worst_error(springs, frequencies_in_50_digits) < 1e-12
    assert springs.stiffness_ratio.min() > 0.1


@pytest.mark.parametrize("boundary", in_turns(BOUNDARIES, every=3), ids=str)
def test_long_chains(boundary: Boundary) -> None:
    springs = match_springs(boundary, 200, 3)
    assert np.abs(springs.frequency_errors).max() < 1e-12
    assert springs.criterion_value < 1e-12


def test_units_scale_out() -> None:
    beam = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    one, real = match_springs("clamped-free", 5, 3), match_springs("clamped-free", 5, 3, beam=beam)
    np.testing.assert_allclose(real.stiffness_ratio, one.stiffness_ratio, rtol=1e-12)
    np.testing.assert_allclose(real.chain.joint_stiffness, one.stiffness_ratio * 85.0 / (1.2 / 5), rtol=1e-12)
    frequencies = solve_modes(linearize(real.chain), 3).angular_frequency
    np.testing.assert_allclose(
        frequencies, euler_bernoulli(beam, "clamped-free", 3).angular_frequency, rtol=1e-12
    )
    assert real.stable_time_step == pytest.approx(one.stable_time_step / beam.frequency_unit, rel=1e-11)
    assert real.chain.mass.sum() == pytest.approx(0.62 * 1.2)


def test_springs_run_in_the_order_of_the_ends() -> None:
    there, back = match_springs("clamped-free", 4, 2), match_springs("free-clamped", 4, 2)
    np.testing.assert_array_equal(back.stiffness_ratio, there.stiffness_ratio[::-1])
    np.testing.assert_allclose(back.mode_shape_agreement, there.mode_shape_agreement, rtol=1e-12)
    assert back.static_tip_deflection_error == pytest.approx(there.static_tip_deflection_error, rel=1e-12)
    assert np.abs(back.frequency_errors).max() < 1e-12


# --- which of the many solutions -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("chain", "criterion"),
    in_turns([("clamped-free", 6), ("pinned-guided", 5)], ["gregory", "uniform"], every=2),
)
def test_an_independent_optimizer_finds_nothing_closer(chain: tuple[str, int], criterion: str) -> None:
    from scipy.optimize import minimize

    boundary, segments = chain
    springs = match_springs(boundary, segments, 3, criterion=criterion)
    rule = {"gregory": "gregory", "uniform": "naive"}[criterion]
    wanted = np.log([float(k) for k in Chain(Beam.unit(), boundary, segments, rule).scaled.joint_stiffness])
    target = np.asarray(wavenumber(boundary, np.arange(1, 4))) ** 2

    def residual(x: NDArray[np.float64]) -> NDArray[np.float64]:
        chain = Chain.from_pieces(
            length=springs.chain.length,
            mass=springs.chain.mass,
            rotary_inertia=springs.chain.rotary_inertia,
            joint_stiffness=np.exp(x) * segments,
            boundary=boundary,
        )
        return np.asarray(np.log(solve_modes(linearize(chain), 3).angular_frequency / target))

    found = minimize(
        lambda x: float(np.sum((x - wanted) ** 2)),
        wanted,
        method="SLSQP",
        constraints={"type": "eq", "fun": residual},
        options={"ftol": 1e-14, "maxiter": 300},
    )
    assert np.abs(residual(found.x)).max() < 1e-8
    assert springs.criterion_value == pytest.approx(found.fun, rel=1e-5)
    np.testing.assert_allclose(springs.stiffness_ratio, np.exp(found.x), rtol=1e-3)
    own = float(np.sum((np.log(springs.stiffness_ratio) - wanted) ** 2))
    assert springs.criterion_value == pytest.approx(own, rel=1e-12)


def test_second_derivatives_are_those_of_the_first() -> None:
    unit = flexibility_form(Chain(Beam.unit(), "clamped-guided", 4, "naive"))
    conditions = Conditions(
        partial(spring_state, unit), symmetric_basis(5, False), (0, 1, 3), np.zeros(3), log_compliance=0.0
    )
    z, weights, step = np.array([0.9, -0.2, 0.1, 0.3, 0.6]), np.array([0.5, -1.2, 0.7, 0.9]), 1e-5
    differences = [
        weights @ (conditions.at(z + step * way)[2] - conditions.at(z - step * way)[2]) / (2 * step)
        for way in np.eye(5)
    ]
    curvature = conditions.curvature(spring_state(unit, z), weights)
    np.testing.assert_allclose(curvature, differences, atol=1e-8)


def test_long_chains_approach_gregory() -> None:
    ratio = match_springs("clamped-free", 30, 3).stiffness_ratio
    gregory = [float(k) for k in Chain(Beam.unit(), "clamped-free", 30, "gregory").scaled.joint_stiffness]
    np.testing.assert_allclose(ratio, gregory, rtol=1e-4)


def test_equal_ends_are_mirrored_while_springs_suffice() -> None:
    assert match_springs("free-free", 6, 3).symmetric
    with pytest.raises(ValueError, match=r"modes must be at most 2 for symmetric springs.*symmetric=False"):
        match_springs("pinned-pinned", 4, 3)
    springs = match_springs("pinned-pinned", 4, 3, symmetric=False)
    assert not springs.symmetric
    assert np.abs(springs.frequency_errors).max() < 1e-12


# --- what exact frequencies cost -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("segments", "percent"),
    [(3, -10.21), (4, -6.80), (5, -0.607), (6, -0.00129), (8, -0.0703), (12, -0.00899)],
)
def test_static_deflection_of_a_matched_cantilever(segments: int, percent: float) -> None:
    springs = match_springs("clamped-free", segments, 3)
    exact = exact_tip_compliance(springs.chain) * 3 - 1
    assert springs.static_tip_deflection_error == pytest.approx(float(exact), abs=1e-12)
    assert 100 * springs.static_tip_deflection_error == pytest.approx(percent, rel=5e-3)


@pytest.mark.parametrize(
    ("boundary", "segments", "inverse"),
    [
        ("clamped-free", 4, 3),
        pytest.param("clamped-free", 9, 3, marks=pytest.mark.slow),
        ("clamped-guided", 5, 12),
        pytest.param("pinned-guided", 5, 3, marks=pytest.mark.slow),
    ],
)
def test_tip_stiffness_can_be_held(
    boundary: str, segments: int, inverse: int, frequencies_in_50_digits: Judge
) -> None:
    springs = match_springs(boundary, segments, 3, hold_tip_stiffness=True)
    assert abs(float(exact_tip_compliance(springs.chain) * inverse - 1)) < 1e-12
    assert abs(springs.static_tip_deflection_error) < 1e-12
    assert worst_error(springs, frequencies_in_50_digits) < 1e-12
    assert springs.criterion_value > match_springs(boundary, segments, 3).criterion_value


def test_no_tip_no_static_error() -> None:
    for boundary in ("clamped-clamped", "pinned-pinned", "pinned-free", "guided-free", "free-free"):
        assert math.isnan(match_springs(boundary, 4, 1).static_tip_deflection_error)
    with pytest.raises(ValueError, match="hold_tip_stiffness needs a tip"):
        match_springs("clamped-clamped", 4, 1, hold_tip_stiffness=True)


def test_mode_shape_agreement_is_the_weighted_criterion() -> None:
    springs = match_springs("free-free", 4, 2)  # no wall, so every node is a coordinate
    mass = linearize(springs.chain).mass_matrix
    modes = solve_modes(linearize(springs.chain), 2)
    shapes = euler_bernoulli(Beam.unit(), "free-free", 2).shape(np.linspace(0, 1, 5))
    for n, exact in enumerate(shapes):
        found = modes.deflection[n]
        value = (exact @ mass @ found) ** 2 / (exact @ mass @ exact) / (found @ mass @ found)
        assert springs.mode_shape_agreement[n] == pytest.approx(value, rel=1e-12)
    assert match_springs("pinned-pinned", 2, 1).mode_shape_agreement[0] == pytest.approx(1, rel=1e-14)
    assert match_springs("clamped-free", 12, 3).mode_shape_agreement.min() > 0.999


def test_time_step_is_the_chains_own() -> None:
    springs = match_springs("clamped-free", 4, 4)
    assert springs.stable_time_step == stable_time_step(springs.chain)
    top = float(wavenumber("clamped-free", 4)) ** 2
    assert springs.stable_time_step == pytest.approx(2 * math.sqrt(2) / top, rel=1e-12)


@pytest.mark.parametrize(
    ("boundary", "segments", "part"),
    [
        ("clamped-free", 5, 0.92),
        ("clamped-free", 12, 0.999),
        # The next test bounds these springs, too.
        pytest.param("clamped-clamped", 6, 0.85, marks=pytest.mark.slow),
    ],
)
def test_highest_frequency_can_be_bounded(boundary: str, segments: int, part: float) -> None:
    free = match_springs(boundary, segments, 3)
    top = highest_angular_frequency(free.chain)
    loose = match_springs(boundary, segments, 3, highest_frequency=top)
    np.testing.assert_array_equal(loose.stiffness_ratio, free.stiffness_ratio)
    springs = match_springs(boundary, segments, 3, highest_frequency=part * top)
    assert highest_angular_frequency(springs.chain) <= part * top * (1 + 1e-12)
    assert np.abs(springs.frequency_errors).max() < 1e-12
    assert springs.criterion_value > free.criterion_value


def test_the_closest_springs_may_lie_below_the_bound() -> None:
    # From the bound the distance falls inwards: the highest frequency ends 15 % under it.
    top = highest_angular_frequency(match_springs("clamped-clamped", 6, 3).chain)
    loose = match_springs("clamped-clamped", 6, 3, highest_frequency=0.85 * top)
    tight = match_springs("clamped-clamped", 6, 3, highest_frequency=0.76 * top)
    assert highest_angular_frequency(loose.chain) < 0.75 * top
    assert loose.criterion_value == pytest.approx(tight.criterion_value, rel=1e-9)


def test_a_bound_that_no_springs_meet() -> None:
    top = highest_angular_frequency(match_springs("clamped-free", 4, 3).chain)
    with pytest.raises(NoPositiveSprings) as caught:
        match_springs("clamped-free", 4, 3, highest_frequency=0.7 * top)
    assert np.abs(caught.value.nearest.frequency_errors).max() > 1e-3


# --- refusals ------------------------------------------------------------------------------------------


def test_where_no_springs_are_found_the_nearest_are_given() -> None:
    with pytest.raises(ValueError, match=r"no positive springs were found.*3 modes.*3 segments") as caught:
        match_springs("clamped-free", 3, 3, hold_tip_stiffness=True)
    assert isinstance(caught.value, NoPositiveSprings)
    nearest = caught.value.nearest
    assert 1e-4 < np.abs(nearest.frequency_errors).max() < 0.01
    assert nearest.stiffness_ratio.min() > 0
    assert nearest.chain.elastic_modes == 3


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (("clamped-free", 3, 4), ValueError, "modes must be at most 3"),
        (("clamped-clamped", 1, 1), ValueError, "modes must be at most 0"),
        (("clamped-free", 3, 0), ValueError, "modes must be a whole number"),
        (("clamped-free", 3, True), TypeError, "modes must be a whole number"),
        (("clamped-free", 201, 3), ValueError, "segments must be at most 200.*dense eigenproblem"),
        (("clamped-free", 2.5, 1), TypeError, "segments must be a whole number"),
        (("clamped-fre", 3, 1), ValueError, "boundary must name"),
    ],
)
def test_bad_arguments(arguments: tuple[Any, Any, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        match_springs(*arguments)


@pytest.mark.parametrize(
    ("keyword", "value", "error", "words"),
    [
        ("criterion", "gregry", ValueError, "criterion must be one of gregory, uniform.*did you mean"),
        ("criterion", 3, TypeError, "criterion"),
        ("hold_tip_stiffness", 1, TypeError, "hold_tip_stiffness must be True or False"),
        ("highest_frequency", 10.0, ValueError, "highest_frequency must be at least that of mode 3, 61.69"),
        ("highest_frequency", -1.0, ValueError, "highest_frequency must be greater than 0"),
        ("highest_frequency", "fast", TypeError, "highest_frequency must be a real number"),
        ("symmetric", True, ValueError, "symmetric must not be True where the ends differ"),
        ("symmetric", "yes", TypeError, "symmetric must be True, False or None"),
        ("beam", 1.0, TypeError, "beam must be a Beam"),
    ],
)
def test_bad_keywords(keyword: str, value: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        match_springs("clamped-free", 4, 3, **{keyword: value})


# --- the record that others look up --------------------------------------------------------------------


def test_matched_looks_up_once() -> None:
    record = matched(3)
    assert record == Matched(3)
    assert record.name == "matched(3)"
    assert record.rotary_inertia == Fraction(1, 12)
    assert record.springs("cantilever/free", 7) is record.springs(Boundary.of("clamped-free"), 7)
    np.testing.assert_array_equal(
        record.springs("free-clamped", 7).stiffness_ratio,
        record.springs("clamped-free", 7).stiffness_ratio[::-1],
    )
    with pytest.raises(ValueError, match="segments must be at most 200"):
        record.springs("clamped-free", 201)
    with pytest.raises(ValueError, match="read-only"):
        record.springs("clamped-free", 7).stiffness_ratio[0] = 1


def test_a_matched_record_describes_its_chain() -> None:
    boundary = Boundary.of("free-clamped")
    record = matched(2)
    weights, lengths = record.hinge_weights(boundary, 5), record.piece_lengths(boundary, 5)
    assert len(weights) == len(lengths) - 1
    chain = Chain.from_pieces(
        length=lengths,
        mass=lengths,
        rotary_inertia=[record.rotary_inertia * length**3 for length in lengths],
        joint_stiffness=[1 / weight for weight in weights],
        boundary=boundary,
    )
    beta = np.asarray(wavenumber(boundary, np.arange(1, 3)))
    np.testing.assert_allclose(
        solve_modes(linearize(chain), 2).angular_frequency, (beta / 5) ** 2, rtol=1e-12
    )


@pytest.mark.parametrize("make", [matched, mode_tuned])
def test_records_check_their_number(make: Callable[[Any], object]) -> None:
    with pytest.raises(ValueError, match="must be a whole number of at least 1"):
        make(0)
    with pytest.raises(TypeError, match="must be a whole number"):
        make(1.5)


# --- one mode's 1/N² error -----------------------------------------------------------------------------


def tuned_error(boundary: str | Boundary, segments: int, tuned: int, mode: int) -> float:
    chain = Chain(Beam.unit(), boundary, segments, mode_tuned(tuned).rule_for(boundary))
    return float(
        solve_modes(linearize(chain), mode).angular_frequency[-1] / wavenumber(boundary, mode) ** 2 - 1
    )


CLAMPED = [pair for pair in BOUNDARIES if pair.left.word == "clamped"]


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_wall_spring_of_a_cantilever(mode: int) -> None:
    beta = float(wavenumber("clamped-free", mode))
    sigma = (math.sinh(beta) - math.sin(beta)) / (math.cosh(beta) + math.cos(beta))
    for boundary, hinge in (("clamped-free", 0), ("free-clamped", -1)):
        weights = ModeTuned(mode).hinge_weights(boundary, 9)
        assert float(1 / weights[hinge]) == pytest.approx(6 * 9 / (3 * 9 - sigma * beta), rel=1e-13)
        assert sum(weight == 1 for weight in weights) == 8
    assert len(mode_tuned(mode).piece_lengths("clamped-free", 9)) == 10
    assert mode_tuned(mode).name == f"mode_tuned({mode})" == mode_tuned(mode).rule_for("clamped-free").name


@pytest.mark.parametrize("mode", [1, 2, 3])
@pytest.mark.parametrize("boundary", CLAMPED, ids=str)
def test_the_tuned_mode_gains_two_orders(boundary: Boundary, mode: int) -> None:
    coarse, fine = (tuned_error(boundary, segments, mode, mode) for segments in (40, 80))
    assert math.log2(coarse / fine) == pytest.approx(4, abs=0.03)
    if boundary.name != "clamped-free":
        interior = -(wavenumber(boundary, mode) ** 4) / 1440
        assert fine * 80**4 == pytest.approx(interior, rel=0.02)


@pytest.mark.parametrize("boundary", CLAMPED, ids=str)
def test_other_modes_keep_order_two(boundary: Boundary) -> None:
    rule = mode_tuned(1).rule_for(boundary)
    coarse, fine = (tuned_error(boundary, segments, 1, 2) for segments in (40, 80))
    assert math.log2(coarse / fine) == pytest.approx(rule.declared_order(boundary), abs=0.05) == 2


def test_without_a_wall_it_is_the_trapezoidal_rule() -> None:
    for boundary in BOUNDARIES:
        if boundary not in CLAMPED:
            expected = RULES["double_wall"].hinge_weights(boundary, 5)
            assert mode_tuned(3).hinge_weights(boundary, 5) == expected


def test_short_chains_have_no_tuned_wall() -> None:
    rule = mode_tuned(3).rule_for("clamped-free")  # sigma beta / 3 = 2.62
    with pytest.raises(ValueError, match=r"mode_tuned\(3\) has no positive springs .* 2 segments"):
        Chain(Beam.unit(), "clamped-free", 2, rule)
    assert Chain(Beam.unit(), "clamped-free", 3, rule).joint_stiffness[0] > 0
