"""Twist and stretch: exact beams, chains and their errors, against 50-digit arithmetic and dense matrices."""

from __future__ import annotations

import csv
import itertools
import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from drawn_ends import RULES_DRAWN

from beammodes.accuracy.axial_errors import axial_frequency_error
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.accuracy.error_table import error_dataset
from beammodes.accuracy.errors import frequency_error
from beammodes.accuracy.law import error_law, law_holds_from
from beammodes.accuracy.segments import segments_needed
from beammodes.batch.study import Study
from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.closed_form.axial_chains import axial_frequencies, end_waves
from beammodes.exact.axial_beam import axial_wavenumber
from beammodes.exact.axial_statics import axial_displacement
from beammodes.exact.axial_theory import axial_modes
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd, distinct_axial
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load
from beammodes.problem.profiles import Table
from beammodes.problem.sections import Circle
from beammodes.springs.matched_springs import match_springs, matched
from beammodes.springs.tuning import mode_tuned
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

UNIT = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0, axial_stiffness=1.0)

#: Closed forms serve them; own has three changed springs at a fixed end, too.
OWN = Rule("own", ["3/8", "7/6", "23/24"], guided=["1/3", "4/5", "6/5"])
CLOSED = [*(rule for rule in RULES.values() if rule.has_equal_springs), OWN]


def random_ends(random: np.random.Generator, spread: float) -> AxialBoundary:
    def number() -> float:
        return float(10 ** random.uniform(-spread, spread))

    def end() -> AxialEnd:
        kinds = [AxialEnd(math.inf), AxialEnd(), AxialEnd(number()), AxialEnd(0.0, number())]
        return [*kinds, AxialEnd(number(), number())][random.integers(5)]

    return AxialBoundary(end(), end())


def exact_root(pair: AxialBoundary, near: float) -> Any:
    """β in many digits, by secants on  Im e^(iβ) (β - i(K - Jβ²)) (β - i(K' - J'β²)) = 0."""

    def wave(end: AxialEnd, beta: Any) -> Any:
        if end.is_fixed:
            return mpmath.mpc(0, -1)
        return mpmath.mpc(beta, -(mpmath.mpf(end.stiffness) - mpmath.mpf(end.inertia) * beta**2))

    def imaginary(beta: Any) -> Any:
        return (mpmath.expj(beta) * wave(pair.left, beta) * wave(pair.right, beta)).imag

    old, new = mpmath.mpf(near) * (1 - mpmath.mpf(10) ** -12), mpmath.mpf(near)
    before, value = imaginary(old), imaginary(new)
    for _ in range(6):
        if value == before:
            break
        old, new, before = new, new - value * (new - old) / (value - before), value
        value = imaginary(new)
    return new


def chain_root(rule: Rule, pair: AxialBoundary, segments: int, mode: int, near: float) -> Any:
    """ω of a chain in many digits, from its springs and inertias; a count proves which mode it is."""

    def number(value: Fraction) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator

    inertia = [number(x) / segments for x in rule.piece_lengths(pair.stand_in, segments)]
    springs = [segments / number(w) for w in rule.hinge_weights(pair.stand_in, segments)]
    for end, at in ((pair.left, 0), (pair.right, -1)):
        inertia[at] += mpmath.mpf(end.inertia)
    ground = [None if end.is_fixed else mpmath.mpf(end.stiffness) for end in (pair.left, pair.right)]
    springs = [ground[0], *springs, ground[1]]
    for at, beside in ((0, 1), (-1, -2)):
        if springs[at] is None or inertia[at] == 0:
            outer, hinge = springs[at], springs[beside]
            springs[beside] = hinge if outer is None else outer * hinge / (outer + hinge)
            del springs[at], inertia[at]

    def swept(square: Any) -> tuple[Any, int]:
        """The determinant of K - ω² M, and how many ω² lie below."""
        before, now, below = mpmath.mpf(1), springs[0] + springs[1] - square * inertia[0], 0
        below += now < 0
        for k in range(1, len(inertia)):
            new = (springs[k] + springs[k + 1] - square * inertia[k]) * now - springs[k] ** 2 * before
            before, now = now, new
            below += (now < 0) != (before < 0)
        return now, below

    low, high = (mpmath.mpf(near) ** 2 * (1 + sign * mpmath.mpf(10) ** -8) for sign in (-1, 1))
    (old_value, fewer), (value, more) = swept(low), swept(high)
    assert (fewer, more) == (mode - 1 + pair.rigid_body_modes, mode + pair.rigid_body_modes)
    old, new = low, high
    for _ in range(5):
        old, new, old_value = new, new - value * (new - old) / (value - old_value), value
        value = swept(new)[0]
        if value in (0, old_value):
            break
    return mpmath.sqrt(new)


def test_errors_of_random_ends_rules_and_lengths_in_fifty_digits() -> None:
    random = np.random.default_rng(20)
    # The first one's spring and disc are equal numbers.
    alike = AxialBoundary(AxialEnd(), AxialEnd(1.0, 1.0))
    cases: list[tuple[AxialBoundary, int, int, Rule]] = [(alike, 30, 2, RULES["double_wall"])]
    while len(cases) < 60:
        rule, pair = CLOSED[random.integers(len(CLOSED))], random_ends(random, 3.0)
        segments, mode = int(10 ** random.uniform(0.3, 2.3)), int(random.integers(1, 4))
        if mode <= segments - 2:
            cases.append((pair, segments, mode, rule))
    pairs, counts, modes, rules = zip(*cases, strict=True)
    errors = axial_frequency_error(list(pairs), list(counts), list(modes), list(rules), "twist")
    with mpmath.workdps(50):
        for error, (pair, segments, mode, rule) in zip(errors, cases, strict=True):
            beta = float(axial_wavenumber([pair], np.asarray(0), mode))
            root = exact_root(pair, beta)
            chain = chain_root(rule, pair, segments, mode, beta * (1 + error))
            # Measured against the larger of e and one of its parts, what rigid pieces do: β²/24N².
            size = max(abs(error), beta**2 / (24 * segments**2))
            assert abs(error - float(chain / root - 1)) <= 1e-12 * size, (rule.name, pair, segments, mode)


def test_errors_far_below_epsilon_follow_the_closed_form() -> None:
    # e = sinc(β/2N) - 1 of exact mirrors, here as a series in fractions of β²: -x/6 + x²/120, x = (β/2N)².
    counts = np.array([10**3, 10**6, 10**9])
    for pair, rule in (("fixed-free", "half_stub"), ("fixed-fixed", "gregory"), ("free-free", "naive")):
        beta = float(axial_wavenumber([AxialBoundary.of(pair)], np.asarray(0), 3))
        x = (beta / 2 / counts) ** 2
        expected = -x / 6 + x**2 / 120
        assert axial_frequency_error(pair, counts, 3, rule, "twist") == pytest.approx(expected, rel=1e-13)
    # w₀ = 1 at the wall: e ~ -1/2N, since N + δ takes the place of N with tan(qδ) = tan(q/2).
    found = axial_frequency_error("fixed-free", counts, 1, "naive", "twist")
    q = math.pi / (2 * counts + 1)
    assert found == pytest.approx(2 * np.sin(q / 2) / (math.pi / 2 / counts) - 1, rel=2e-8)
    assert found[2] == pytest.approx(-0.5e-9, rel=1e-8)


#: w₀ with a hinge at the wall, or None for half a stub.
@pytest.mark.parametrize("weight", ["1", "1/2", "2/7", None])
@pytest.mark.parametrize("ends", [(3.0, 0.0), (0.0, 0.4)], ids=["spring", "disc"])
def test_the_closed_forms_of_single_ends(weight: str | None, ends: tuple[float, float]) -> None:
    # The table: κ = qN = φ + (π/2 at the fixed end); rule weights of the fixed end are its exact mirror.
    segments, (stiffness, inertia) = 12, ends
    rule = Rule("one", [weight], guided=["1/2"]) if weight else RULES["half_stub"]
    pair = AxialBoundary(AxialEnd(math.inf), AxialEnd(stiffness, inertia))
    found = solve_axial_modes(AxialChain(UNIT, pair, segments, rule), 4).angular_frequency
    q = 2 * np.arcsin(found / 2 / segments)
    k, mu = stiffness / segments, inertia * segments
    half, w = np.tan(q / 2), float(Fraction(weight)) if weight else None
    if w is None:
        tan = k / np.sin(q) if stiffness else -2 * mu * half
    elif stiffness:
        tan = 1 / (2 * half / k - (1 - 2 * w) * half)
    else:
        tan = -mu * np.sin(q) / (1 + 2 * mu * (1 - 2 * w) * np.sin(q / 2) ** 2)
    # κ - π/2 - φ is a whole number of half turns.
    assert np.tan(q * segments - math.pi / 2) == pytest.approx(tan, rel=1e-10)
    exact = axial_wavenumber([pair], np.zeros(4, dtype=np.intp), np.arange(1, 5))
    by_delta = axial_frequency_error(pair, segments, np.arange(1, 5), rule, "twist")
    assert by_delta == pytest.approx(found / exact - 1, abs=1e-13)


def test_the_table_of_a_cantilever_of_ten_segments() -> None:
    # Independent: [K] and [M] of ten pieces by hand, numpy's dense eigenvalues; percent.
    report = Rule("report", ["1/2"], guided=[Weight("1/2", "-1/6")])
    mended = Rule("mended", [], guided=["3/2"], stub=1)
    plain, disc = "fixed-free", "fixed-free(inertia=0.5)"
    table: list[tuple[Any, str, float]] = [
        ("naive", plain, -4.851), ("double_wall", plain, -0.1028), ("half_stub", plain, -0.1028),
        (report, plain, 0.0640), ("rigid_stub", plain, 5.143), (mended, plain, -0.0419),
        ("naive", disc, -4.179), ("double_wall", disc, 0.0057), ("half_stub", disc, -0.0753),
    ]  # fmt: skip
    for rule, ends, expected in table:
        digits = 3 if abs(expected) > 1 else 4
        assert round(100 * axial_frequency_error(ends, 10, 1, rule, "twist"), digits) == expected

    def dense(wall: float, inertia: float) -> float:
        springs = np.array([10 / wall, *[10.0] * 9])
        stiffness = np.diag(springs + np.append(springs[1:], 0.0))
        stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
        mass = np.full(10, 0.1)
        if inertia:
            # The disc behind a hinge of its own, of weight 1/2 or as soft as the wall's.
            stiffness[9, 9] += 10 / wall
            stiffness = np.pad(stiffness, (0, 1))
            stiffness[10, 10] = 10 / wall
            stiffness[9, 10] = stiffness[10, 9] = -10 / wall
            mass = np.append(mass, inertia)
        root = np.sqrt(mass)
        return float(np.sqrt(np.linalg.eigvalsh(stiffness / root / root[:, None])[0]))

    # π/2, and β tan β = 2.
    for inertia, beta in (
        (0.0, math.pi / 2),
        (0.5, float(mpmath.findroot(lambda x: x * mpmath.tan(x) - 2, 1))),
    ):
        ends = disc if inertia else plain
        for wall, rule in ((1.0, "naive"), (0.5, "double_wall")):
            expected = dense(wall, inertia) / beta - 1
            assert axial_frequency_error(ends, 10, 1, rule, "twist") == pytest.approx(expected, abs=1e-12)


def test_short_chains_and_every_mode_are_solved() -> None:
    for name in ("rigid_stub", "half_stub_corrected", "gregory", "simpson"):
        for ends in ("fixed-fixed", "free-free(stiffness=2)", "free(mass=0.1)-free(mass=0.1)"):
            for segments in (2, 3, 6):
                mode = np.arange(1, segments + 3)
                errors = axial_frequency_error(ends, segments, mode, name, "stretch")
                if name == "simpson" and segments % 2:
                    assert np.isnan(errors).all()
                    continue
                chain = AxialChain(UNIT, ends, segments, name, motion="stretch")
                omega = solve_axial_modes(chain).angular_frequency
                exact = axial_modes(UNIT, ends, len(mode), motion="stretch").angular_frequency
                assert np.isnan(errors[len(omega) :]).all()
                assert errors[: len(omega)] == pytest.approx(omega / exact[: len(omega)] - 1, abs=1e-13)


def test_single_lookups_between_plain_ends_are_those_of_solved_chains() -> None:
    # Floats alone go past the machinery of arrays. Seen: 6e-15 off what all rules' whole chains have.
    for rule, ends in itertools.product(RULES, ("fixed-free", "fixed-fixed", "free-fixed", "free-free")):
        for count in (1, 2, 3, 5, 7, 12):
            mode = np.arange(1, count + 2)
            ask = {"segments": count, "rule": rule, "motion": "twist"}
            single = [frequency_error(ends, mode=int(m), **ask) for m in mode]
            exact = axial_wavenumber([AxialBoundary.of(ends)], np.zeros(len(mode), dtype=int), mode)
            solved = axial_frequencies(RULES[rule], AxialBoundary.of(ends), count, mode) / exact - 1
            np.testing.assert_allclose(single, solved, rtol=0, atol=1e-13, err_msg=f"{rule} {ends} {count}")
            np.testing.assert_allclose(frequency_error(ends, mode=mode, **ask), single, rtol=0, atol=1e-13)
        for count, m in ((300, 40), (10**4, 2), (10**9, 1)):
            if rule != "simpson":
                ask = {"segments": count, "rule": rule, "motion": "twist"}
                one = frequency_error(ends, mode=m, **ask)
                np.testing.assert_allclose(frequency_error(ends, mode=[m], **ask), [one], rtol=1e-12, atol=0)
    with pytest.raises(ValueError, match="beam must have its torsional_stiffness"):
        frequency_error("fixed-free", segments=3, mode=1, motion="twist", beam=Beam(1.0, 1.0, 1.0))


def test_high_modes_of_long_chains() -> None:
    # δ follows waves up to q = 2.5; singular values of the chain's own springs and inertias, in 400 pieces.
    random = np.random.default_rng(4)
    for rule in CLOSED[:-1]:
        pair, segments = random_ends(random, 1.0), 400
        modes = np.arange(1, segments - 2, 9)
        omega = solve_axial_modes(AxialChain(UNIT, pair, segments, rule)).angular_frequency
        exact = axial_wavenumber([pair], np.zeros(len(modes), dtype=np.intp), modes)
        errors = frequency_error(pair, segments=segments, mode=modes, rule=rule, motion="twist")
        assert errors == pytest.approx(omega[modes - 1] / exact - 1, abs=1e-12), (rule.name, pair)
    high = frequency_error("fixed-free", segments=10**9, mode=10**8, rule="naive", motion="twist")
    x = math.pi * 0.1 / 2
    assert high == pytest.approx(math.sin(x) / x - 1, abs=1e-9)  # the wall costs 1/2N more
    # The last modes, solved for one by one: q = π (2n - 1)/(2N + 1) of equal springs, ω = 2N sin(q/2).
    last = np.array([1997, 1999, 2000])
    errors = frequency_error("fixed-free", segments=2000, mode=[*last, 2001], rule="naive", motion="twist")
    omega = 4000 * np.sin(math.pi * (last - 0.5) / 4001)
    assert errors[:3] == pytest.approx(omega / (math.pi * (last - 0.5)) - 1, abs=1e-13)
    assert np.isnan(errors[3])
    # So they are followed where the wall has one weight, in chains too long to be solved.
    far = frequency_error("fixed-free", segments=10**6, mode=999_999, rule="naive", motion="twist")
    turn = math.pi * (999_999 - 0.5)
    assert far == pytest.approx(2e6 * math.sin(turn / (2 * 10**6 + 1)) / turn - 1, abs=1e-13)
    with pytest.raises(ValueError, match="segments must be at most 100000 for mode 999998"):
        frequency_error(
            "fixed-free", segments=10**6, mode=999_998, rule="rigid_stub_corrected", motion="twist"
        )


def test_long_chains_keep_their_digits() -> None:
    # κ = β of an exact mirror: ω = 2N sin(β/2N); shapes are the beam's at the pieces' middles.
    segments, beta = 20_000, np.pi / 2 * np.array([1.0, 3.0, 5.0])
    modes = solve_axial_modes(AxialChain(UNIT, "fixed-free", segments, "double_wall"), 3)
    expected = 2 * segments * np.sin(beta / 2 / segments)
    assert modes.angular_frequency == pytest.approx(expected, rel=1e-13)
    middles = (np.arange(segments) + 0.5) / segments
    shapes = math.sqrt(2) * np.sin(beta[:, None] * middles)
    assert modes.displacement[:, 1:] == pytest.approx(shapes, abs=1e-9)


def test_exact_modes_are_orthogonal_and_meet_their_ends() -> None:
    shaft = Beam(2.0, 1.0, 1.0, torsional_stiffness=5.0, polar_inertia_per_length=0.3)
    ends = AxialBoundary(AxialEnd(4.0, 0.2), AxialEnd(0.0, 0.7))
    modes = axial_modes(shaft, ends, 4)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    shape = modes.shape(nodes + 1.0)
    tips = modes.shape([0.0, 2.0])
    mass = 0.3 * (shape * weights) @ shape.T + (tips * [0.2, 0.7]) @ tips.T
    assert mass == pytest.approx(np.eye(4), abs=1e-12)
    torque, square = 5.0 * modes.slope([0.0, 2.0]), modes.angular_frequency**2
    assert torque[:, 0] == pytest.approx((4.0 - 0.2 * square) * tips[:, 0], rel=1e-10)
    assert torque[:, 1] == pytest.approx(0.7 * square * tips[:, 1], rel=1e-10)


def test_what_a_rule_has_at_a_fixed_end() -> None:
    # T' = 0 there: the guided weights, exact mirrors in all rules but those that leave out or double.
    mirrors = {name for name in RULES_DRAWN if end_waves(RULES[name], "guided").is_mirror}
    assert mirrors == {
        "mitiguy", "double_wall", "gregory", "gregory2", "hencky", "half_stub", "half_stub_corrected",
    }  # fmt: skip


def test_ends_are_read_and_refused() -> None:
    assert AxialBoundary.of("cantilever/free", "stretch").name == "fixed-free"
    assert AxialBoundary.of("free(mass=2, stiffness=3)-fixed", "stretch").canonical.name == (
        "fixed-free(stiffness=3.0, mass=2.0)"
    )
    names = np.array([["fixed-free"], ["clamped-free"]])
    assert distinct_axial(names, "twist")[1].tolist() == [[0], [0]]
    assert distinct_axial([("fixed", "free"), "free-free"], "twist")[1].tolist() == [0, 1]
    # A pair of an end's record and a word is one boundary in tables, too.
    pair = ("fixed", AxialEnd(inertia=0.5))
    table = error_dataset(boundary=pair, segments=4, modes=1, motion="twist")
    assert table.boundary.values.tolist() == ["fixed-free(inertia=0.5)"]
    assert table.relative_error.item() == frequency_error(pair, segments=4, mode=1, motion="twist")
    for ends, motion, message in (
        ("pinned-free", "twist", 'did you mean "fixed-free".*pinned says what bending may do, not twist'),
        ("fixd-free", "twist", 'did you mean "fixed-free"'),
        ("fixed-free(mass=1)", "twist", "number of an end must be one of stiffness, inertia, got 'mass'"),
        ("fixed-free(inertia=1)", "stretch", "must be one of stiffness, mass, got 'inertia'"),
        ("fixed(stiffness=1)-free", "twist", "stiffness of an end must be given once, and not of a fixed"),
        ("fixed-free", "bending", "motion must be twist or stretch here, got 'bending'"),
        ("fixed-free", "torsion", "motion must be one of bending, twist, stretch, got 'torsion'"),
    ):
        with pytest.raises(ValueError, match=message):
            AxialBoundary.of(ends, motion)


# --- the doors ------------------------------------------------------------------------------------------


def test_the_law_against_exact_errors() -> None:
    # Over random ends the leading term at N = 10⁵, where the next is smaller by 1/N or more.
    random = np.random.default_rng(7)
    for rule in [*RULES.values(), OWN]:
        segments = 10**5 if rule.has_equal_springs else 1000
        for _ in range(4):
            pair, mode = random_ends(random, 0.5), int(random.integers(1, 4))
            law = error_law(pair, mode, rule, motion="twist")
            error = frequency_error(pair, segments=segments, mode=mode, rule=rule, motion="twist")
            assert law.order <= 2
            assert float(law.at(segments)) == pytest.approx(error, rel=0.03), (rule.name, pair, mode)
    assert error_law("fixed-free", 2, "half_stub", motion="twist").coefficient == pytest.approx(
        -((1.5 * math.pi) ** 2) / 24, rel=1e-13
    )
    assert law_holds_from("fixed-free", 2, "half_stub", motion="stretch", within=0.01) == math.ceil(
        # x²/120 of x/6 is a hundredth at x = (β/2N)² = 1/5.
        1.5 * math.pi / 2 * math.sqrt(5)
    )


def test_segments_for_a_tolerance() -> None:
    # sin x/x = 1 - tolerance, N = β/2x; 2.04 β and 6.45 β.
    for tolerance, factor in ((0.01, 2.04), (0.001, 6.45)):
        x = float(mpmath.findroot(lambda y, t=tolerance: mpmath.sin(y) / y - 1 + t, math.sqrt(6 * tolerance)))
        assert 1 / (2 * x) == pytest.approx(factor, abs=0.005)
        for ends, beta in (("fixed-free", 2.5 * math.pi), ("free-free", 3 * math.pi)):
            needed = segments_needed(ends, tolerance, 3, "half_stub", motion="stretch")
            assert needed == math.ceil(beta / (2 * x))
    assert segments_needed("fixed-free", 0.01, 1, "naive", motion="twist") == 50


def test_a_table_in_twist_has_units_and_numbers_of_its_own() -> None:
    shaft = Beam(0.5, 1.0, 1.0, torsional_stiffness=80.0, polar_inertia_per_length=8e-6)
    table = error_dataset(
        boundary="free-fixed", segments=[4, 8], modes=2, rule=["naive", "half_stub"], beam=shaft,
        over={"left_inertia": [0.0, 2e-6]}, motion="twist",
    )  # fmt: skip
    assert (
        table.left_inertia.attrs["units"] == "kg m^2" and table.angular_frequency.attrs["units"] == "rad / s"
    )
    found = table.sel(rule="half_stub", left_inertia=2e-6, segments=8, mode=2).squeeze()
    exact = axial_modes(shaft, "free(inertia=2e-6)-fixed", 2).angular_frequency[1]
    chain = solve_modes(AxialChain(shaft, "free(inertia=2e-6)-fixed", 8, "half_stub")).angular_frequency[1]
    assert float(found.exact_angular_frequency) == pytest.approx(exact, rel=1e-12)
    assert float(found.angular_frequency) == pytest.approx(chain, rel=1e-12)
    bare = error_dataset(boundary="clamped-free", segments=3, modes=1, motion="stretch")
    assert bare.boundary.item() == "fixed-free"
    assert bare.angular_frequency.attrs["multiple_of"] == "sqrt(EA / (rhoA L^2))"
    with pytest.raises(ValueError, match="load must be left out for motion twist"):
        frequency_error(
            "fixed-free", segments=3, mode=1, motion="twist", load=Load(axial_force=1.0), beam=shaft
        )


def test_many_errors_at_once_are_those_of_single_ones() -> None:
    # Boundaries, rules and N of all kinds in one call, and one by one.
    ends = ["fixed-free", "free(stiffness=2)-free(inertia=0.3)", "fixed-fixed"]
    rules = ["naive", "simpson", "half_stub_corrected"]
    counts = np.array([1, 7, 40, 10**4])
    together = frequency_error(
        np.array(ends)[:, None, None], segments=counts, mode=2, rule=np.array(rules)[:, None], motion="twist"
    )
    for i, pair in enumerate(ends):
        for j, rule in enumerate(rules):
            one = [frequency_error(pair, segments=int(n), mode=2, rule=rule, motion="twist") for n in counts]
            assert together[i, j] == pytest.approx(one, rel=1e-12, nan_ok=True)


def test_the_stable_step() -> None:
    # ω_max = 2N c/L between fixed ends; 2.04 N with gregory's clamped weights at both of two stiff springs.
    steps = [
        stable_time_step(AxialChain(UNIT, ends, 20, "double_wall"), "leapfrog")
        for ends in ("fixed-fixed", "fixed-free", "free-free")
    ]
    assert steps[0] == pytest.approx(1 / 20, rel=1e-12) and min(steps) == steps[0]
    stiff = AxialChain(UNIT, AxialBoundary(AxialEnd(1e9), AxialEnd(1e9)), 4, "gregory")
    assert 2 / stable_time_step(stiff, "leapfrog") / 4 == pytest.approx(2.04, abs=0.005)
    # Round steel, r the radius: omega_twist/omega_bend = 0.358 ell/r, omega_axial/omega_bend = 0.577 ell/r.
    rod = Beam.from_section(
        Circle(0.02), length=4.0, elastic_modulus=2.1e11, density=7800.0, poisson_ratio=0.3
    )
    bend = math.sqrt(48.0) * 20**2 * rod.frequency_unit
    for motion, factor in (("twist", 0.358), ("stretch", 0.577)):
        chain = AxialChain(rod, "fixed-fixed", 20, "double_wall", motion=motion)
        highest = 2 / stable_time_step(chain, "leapfrog")
        assert highest / bend / (0.2 / 0.01) == pytest.approx(factor, abs=5e-4)


def test_questions_of_users() -> None:
    # A round steel rod of 0.5 m by 10 mm, clamped at one end: (2n - 1)/(4L) √(G/ρ).
    shear, density = 79.3e9, 7850.0
    rod = Beam.from_section(
        Circle(0.010), length=0.5, elastic_modulus=2.6 * shear, density=density, poisson_ratio=0.3
    )
    expected = (2 * np.arange(1, 4) - 1) / 2.0 * math.sqrt(shear / density)
    assert axial_modes(rod, "clamped-free", 3).frequency == pytest.approx(expected, rel=1e-13)
    two_at_the_wall, alike = (
        frequency_error("clamped-free", segments=10, mode=1, rule=rule, motion="twist")
        for rule in ("double_wall", "naive")
    )
    # A 10 x 10 eigenvalue problem in numpy gives these.
    assert two_at_the_wall == pytest.approx(-0.0010277667514637656, rel=1e-9)
    assert alike == pytest.approx(-0.04850689664005059, rel=1e-9)
    wall, inside = AxialChain(rod, "clamped-free", 10, "double_wall").joint_stiffness[:2]
    assert (wall, inside) == pytest.approx((2 * rod.torsional_stiffness / 0.05, wall / 2), rel=1e-12)
    # An aluminium rod of 1 m: √(E/ρ)/4L along it, and slide springs EA/ell.
    bar = Beam.from_section(Circle(0.02), length=1.0, elastic_modulus=70e9, density=2700.0)
    assert axial_modes(bar, "clamped-free", 1, motion="stretch").frequency[0] == pytest.approx(
        1272.9376930432888, rel=1e-12
    )
    springs = AxialChain(bar, "clamped-free", 10, "half_stub", motion="stretch").joint_stiffness
    assert springs == pytest.approx(np.full(10, 70e9 * math.pi * 0.01**2 / 0.1), rel=1e-12)
    # A shaft held at its right end, three torques: the sum of T l/GJ, at the middles of pieces as in the
    # beam.
    shaft = Beam(1.2, 1.0, 1.0, torsional_stiffness=30e3, polar_inertia_per_length=1.0)
    turns = AxialChain(shaft, "free-fixed", 12).displacement({0.0: 100.0, 0.4: -220.0, 0.7: -60.0})
    middles = (np.arange(12) + 0.5) / 10
    along = np.interp(middles, [0.0, 0.4, 0.7, 1.2], [-0.0028666666666666667, -0.0042, -0.003, 0.0])
    assert turns[:12] == pytest.approx(along, abs=1e-15)
    torques = {0.0: 100.0, 0.4: -220.0, 0.7: -60.0}
    massless = Beam(1.2, 1.0, 1.0, torsional_stiffness=30e3)  # rest asks for no inertia
    places = axial_displacement(massless, "free-fixed", torques, [0.0, 0.4, 0.7])
    assert places == pytest.approx([-0.0028666666666666667, -0.0042, -0.003], abs=1e-15)


def test_at_rest_chains_are_the_beam_at_the_middles_of_pieces() -> None:
    # Random loads on hinges and ends, ends with springs, 1/2 at the ends' own hinges: no error at all.
    random = np.random.default_rng(5)
    shaft = Beam(1.2, 1.0, 1.0, torsional_stiffness=30.0, polar_inertia_per_length=1.0)
    for ends in (
        "fixed-fixed",
        "free-free(stiffness=20)",
        "free(stiffness=7)-free(stiffness=40)",
        "fixed-free",
    ):
        loads = {float(x): float(random.normal()) for x in np.arange(13)[random.permutation(13)[:6]] / 10}
        chain = AxialChain(shaft, ends, 12, "double_wall")
        middles = np.cumsum(chain.length) - chain.length / 2
        expected = axial_displacement(shaft, ends, loads, np.minimum(middles, 1.2))
        assert chain.displacement(loads) == pytest.approx(expected, abs=1e-14)
    # GJ = 1 + x under a torque at the tip: ln(1 + x).
    tapered = Beam(1.0, 1.0, 1.0, torsional_stiffness=lambda x: 1 + x, polar_inertia_per_length=1.0)
    turns = axial_displacement(tapered, "fixed-free", {1.0: 1.0}, [0.0, 0.5, 1.0])
    assert turns == pytest.approx(np.log([1.0, 1.5, 2.0]), abs=1e-14)
    # An end on a spring that has no inertia of its own moves in a mode as the hinge and the spring share it.
    chain = AxialChain(shaft, "free(stiffness=20)-free", 6, "double_wall")
    shape = solve_axial_modes(chain, 1).displacement[0]
    hinge = chain.joint_stiffness[0]
    assert shape[0] == pytest.approx(shape[1] * hinge / (hinge + 20.0), rel=1e-12)


# --- springs tuned to one mode, and matched to all ---------------------------------------------------------


def test_a_tuned_wall_makes_its_mode_exact() -> None:
    random = np.random.default_rng(11)
    exact = 0
    for _ in range(40):
        pair, mode, segments = (
            random_ends(random, 1.0),
            int(random.integers(1, 4)),
            int(random.integers(8, 60)),
        )
        found = frequency_error(
            pair, segments=segments, mode=mode, rule=mode_tuned(mode, motion="twist"), motion="twist"
        )
        if pair.left.is_free and pair.right.is_free:
            assert found == pytest.approx(
                frequency_error("free-free", segments=segments, mode=mode, rule="naive", motion="twist")
            )
        elif not math.isnan(found):
            assert abs(found) < 1e-13
            exact += 1
    assert exact > 30
    # w = ½ [1 + tan(β - N q)/tan(q/2)].
    beta, q = math.pi / 2, 2 * math.asin(math.pi / 40)
    wall = AxialChain(UNIT, "fixed-free", 10, mode_tuned(1, motion="twist")).joint_stiffness[0] / 10
    assert 1 / wall == pytest.approx((1 + math.tan(beta - 10 * q) / math.tan(q / 2)) / 2, rel=1e-9)
    with pytest.raises(ValueError, match=r"got mode_tuned\(1\), whose springs are for bending"):
        frequency_error("fixed-free", segments=3, mode=1, rule=mode_tuned(1), motion="twist")


def check_all_met(ends: str, segments: int) -> None:
    modes = segments - (ends == "free-free")
    springs = match_springs(ends, segments, modes, motion="twist")
    assert (springs.stiffness_ratio > 0).all()
    # Against numpy's dense eigenvalues of the chain's springs and pieces.
    _, inertia, between = springs.chain.moving
    beside = np.diag(between[1:-1], 1) + np.diag(between[1:-1], -1)
    stiffness, root = np.diag(between[:-1] + between[1:]) - beside, np.sqrt(inertia)
    rigid = AxialBoundary.of(ends).rigid_body_modes
    squares = np.linalg.eigvalsh(stiffness / root / root[:, None])[rigid:]
    exact = axial_modes(UNIT, ends, modes).angular_frequency
    assert np.sqrt(squares[:modes]) == pytest.approx(exact, rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("segments", [2, 3, 4, 6, 8])
def test_all_frequencies_are_met_at_every_length(segments: int) -> None:
    for ends in ("fixed-free", "fixed-fixed", "free-free(inertia=0.3)", *(["free-free"] * (segments < 6))):
        check_all_met(ends, segments)


def test_all_frequencies_are_met_by_positive_springs() -> None:
    cases = [("fixed-free", 3), ("fixed-fixed", 4), ("free-free", 4), ("fixed-free(inertia=0.5)", 3)]
    for ends, segments in [*cases, ("free(stiffness=2)-free", 3)]:
        check_all_met(ends, segments)
    # One of the solutions of three pieces, published to three decimals: 1.059, 2.555, 1.713.
    k = np.array([1.059, 2.555, 1.713]) * 3
    matrix = 3 * np.array([[k[0] + k[1], -k[1], 0], [-k[1], k[1] + k[2], -k[2]], [0, -k[2], k[2]]])
    exact = (np.arange(3) + 0.5) * math.pi
    assert np.sqrt(np.linalg.eigvalsh(matrix)) == pytest.approx(exact, rel=2e-4)
    rule = matched(2, motion="stretch")
    errors = frequency_error("fixed-free", segments=[4, 9], mode=2, rule=rule, motion="stretch")
    assert np.abs(errors).max() < 1e-13
    with pytest.raises(ValueError, match="first 2 frequencies are the beam's at every N"):
        segments_needed("fixed-free", 0.01, 1, rule, motion="stretch")
    with pytest.raises(ValueError, match="hold_tip_stiffness must be left out for motion twist"):
        match_springs("fixed-free", 3, 2, hold_tip_stiffness=True, motion="twist")  # type: ignore[call-overload]  # on purpose
    # A chain that was found before answers True, of which 1 is the equal.
    assert match_springs("fixed-fixed", 4, 2, symmetric=True, motion="twist").symmetric
    for wrong in (1, []):
        with pytest.raises(TypeError, match="symmetric must be True, False or None"):
            match_springs("fixed-fixed", 4, 2, symmetric=wrong, motion="twist")  # type: ignore[call-overload]  # on purpose


@pytest.mark.parametrize(
    ("name", "ends"), [("figure_6_twist", "fixed-free"), ("figure_7_twist", "fixed-fixed")]
)
def test_committed_figures_in_twist(name: str, ends: str) -> None:
    with open(Path(__file__).parents[1] / "figures" / f"{name}.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["rule"] == "two_at_the_wall"]
    assert len(rows) == 57 and {row["boundary"] for row in rows} == {ends}
    for row in rows:
        # An exact mirror at the wall: sin x/x - 1, x = β/2N.
        beta = (int(row["mode"]) - (ends == "fixed-free") / 2) * math.pi
        x = beta / 2 / int(row["segments"])
        assert float(row["relative_error"]) == pytest.approx(math.sin(x) / x - 1, rel=1e-10)


def test_studies_have_motion_as_an_axis() -> None:
    study = Study.grid(
        boundary=["clamped-free", "clamped-clamped"], motion=["bending", "twist", "stretch"], mode=[1, 2],
        rule=["half_stub", "naive"], segments=[4, 10], compute=["relative_error", "stable_time_step"],
    )  # fmt: skip
    table = study.run()
    for motion in ("bending", "twist"):
        for rule in ("half_stub", "naive"):
            found = table.relative_error.sel(boundary="clamped-clamped", motion=motion, rule=rule).values
            counts = np.array([[4], [10]])
            expected = frequency_error(
                "clamped-clamped", segments=counts, mode=[1, 2], rule=rule, motion=motion
            )
            assert found == pytest.approx(expected, rel=1e-12)
    step = table.stable_time_step.sel(boundary="clamped-clamped", motion="stretch", rule="naive", segments=4)
    chain = AxialChain(UNIT, "fixed-fixed", 4, "naive", motion="stretch")
    assert float(step) == pytest.approx(stable_time_step(chain), rel=1e-12)
    # A disc on a rod of a section and a material: ω goes nearly with the rod's d².
    rods = Study.grid(
        section="circle", diameter=[0.01, 0.02], length=0.5, elastic_modulus=2e11, density=7850.0, mode=1,
        boundary="fixed-free(inertia=1e-3)", motion="twist", segments=10, compute="angular_frequency",
    )  # fmt: skip
    omega = rods.run().angular_frequency.values
    rod = Beam.from_section(Circle(0.01), length=0.5, elastic_modulus=2e11, density=7850.0)
    chain = AxialChain(rod, "fixed-free(inertia=1e-3)", 10)
    assert omega[0] == pytest.approx(solve_axial_modes(chain, 1).angular_frequency[0], rel=1e-12)
    assert omega[1] / omega[0] == pytest.approx(4.0, rel=0.02)
    mixed = {"boundary": "pinned-free", "segments": 3, "mode": 1, "compute": "relative_error"}
    none = Study.grid(motion=["bending", "twist"], **mixed).run().sel(motion="twist")
    assert math.isnan(none.relative_error) and "pinned says what bending may do" in none.reason.item()
    with pytest.raises(ValueError, match="must leave out motion with buckling_load"):
        Study.grid(boundary="clamped-free", motion="twist", segments=3, compute="buckling_load")


def test_beams_that_vary_along_them() -> None:
    # A cone, GJ and ρIp as (1 + x)²: u (1 + x) is a uniform beam's, ω = nπ between fixed ends.
    cone = Beam(
        1.0, 1.0, 1.0,
        torsional_stiffness=lambda x: (1 + x) ** 2, polar_inertia_per_length=lambda x: (1 + x) ** 2,
    )  # fmt: skip
    modes = axial_modes(cone, "fixed-fixed", 12)
    assert modes.angular_frequency == pytest.approx(math.pi * np.arange(1, 13), rel=1e-12)
    x = np.linspace(0.0, 1.0, 9)
    assert modes.shape(x)[2] == pytest.approx(math.sqrt(2) * np.sin(3 * math.pi * x) / (1 + x), abs=1e-10)
    # Two shafts in a row, GJ and ρIp of 2 and 1 over 0.4, of 1 and 3 over the rest: their waves meet,
    # 2 (ω/c₁) cot(ω l₁/c₁) = (ω/c₂) tan(ω l₂/c₂), and a disc of 0.5 at the tip.
    table = {"x": [0.0, 0.4, 0.4, 1.0]}
    stepped = Beam(
        1.0, 1.0, 1.0,
        torsional_stiffness=Table(**table, value=[2.0, 2.0, 1.0, 1.0]),
        polar_inertia_per_length=Table(**table, value=[1.0, 1.0, 3.0, 3.0]),
    )  # fmt: skip
    omega = axial_modes(stepped, "fixed-free(inertia=0.5)", 4).angular_frequency
    first, second = math.sqrt(2.0), math.sqrt(1 / 3)
    turn, torque = np.sin(omega * 0.4 / first), 2 * omega / first * np.cos(omega * 0.4 / first)
    a, b = turn, torque * second / omega
    inner = omega * 0.6 / second
    tip, held = (
        a * np.cos(inner) + b * np.sin(inner),
        omega / second * (b * np.cos(inner) - a * np.sin(inner)),
    )
    assert held == pytest.approx(0.5 * omega**2 * tip, rel=1e-9)
    # A hinge at the step keeps order 2: errors fall by four, and a hinge of both sides' mean is there.
    errors = [
        chain_errors(AxialChain(stepped, "fixed-free(inertia=0.5)", n, "gregory"), 1)[0] for n in (20, 40)
    ]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    uniform = chain_errors(AxialChain(UNIT, "fixed-free", 10, "half_stub"), 2)
    assert uniform == pytest.approx(
        frequency_error("fixed-free", segments=10, mode=[1, 2], rule="half_stub", motion="twist"), abs=1e-13
    )


def test_first_roots_near_zero_keep_their_digits() -> None:
    # A light shaft under a heavy disc is one spring, ω² = k/(J + 1/3) to order 1/J; under two free ones 2/J.
    for heavy in (1e16, 1e29):
        single = axial_modes(UNIT, ("fixed", AxialEnd(inertia=heavy)), 1).angular_frequency[0]
        double = axial_modes(UNIT, (AxialEnd(inertia=heavy),) * 2, 1).angular_frequency[0]
        soft = axial_modes(UNIT, (AxialEnd(1 / heavy), "free"), 1).angular_frequency[0]
        assert np.array([single, double / math.sqrt(2.0), soft]) * math.sqrt(heavy) == pytest.approx(
            1.0, rel=1e-14
        )
    with pytest.raises(ArithmeticError, match=r"^boundary must have springs and bodies within 30 decades"):
        axial_modes(UNIT, ("fixed", AxialEnd(inertia=1e300)), 1)


def test_numbers_of_another_motion_are_not_taken_for_this_one() -> None:
    mass = AxialBoundary.of("fixed-free(mass=0.5)", "stretch")
    with pytest.raises(ValueError, match=r"^boundary must be one of twist where it has springs or bodies"):
        axial_modes(UNIT, mass, 1)
    plain = AxialBoundary.of("fixed-free", "stretch")
    assert axial_modes(UNIT, plain, 1).angular_frequency == pytest.approx([math.pi / 2])
    with pytest.raises(
        TypeError, match=r"^chain must be a Chain, got <AxialChain .*; solve_modes takes an AxialChain itself"
    ):
        linearize(AxialChain(UNIT, "fixed-free", 3))  # type: ignore[call-overload]  # on purpose
