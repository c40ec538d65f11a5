"""Frequency errors of uniform chains against two independent routes in high-precision arithmetic."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from drawn_ends import EVERY_N, RULES_DRAWN

from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.closed_form.chain_frequencies import chain_frequency
from beammodes.closed_form.relative_errors import relative_error
from beammodes.closed_form.uniform_chains import MAX_SEGMENTS
from beammodes.problem.ends import BOUNDARIES, Boundary, End

HALF = Fraction(1, 2)


def rule_of(name: str, clamped: list[str], guided: list[str], stub: str = "0", inertia: str = "1/12") -> Rule:
    return Rule(name, clamped, guided, stub=stub, rotary_inertia=inertia)


def tuned(name: str, sigma_beta: float, inertia: str = "1/12") -> Rule:
    plain = rule_of(name, [], ["1/2"], inertia=inertia)
    wall = (Weight(HALF, -Fraction(sigma_beta) / 6),)
    return Rule(name, wall, plain.guided, stub=plain.stub, rotary_inertia=plain.rotary_inertia)


# After those of the registry, some that are there to be hard: springs that reverse the usual order,
# stubs with four corrected hinges, walls so stiff that a mode leaves the band.
RECORDS = [
    *(RULES[name] for name in EVERY_N),
    tuned("tuned 1", 1.376),
    tuned("tuned 6", 17.279),
    tuned("tuned points", 10.996, "1/4"),
    rule_of("stiff", ["1/100"], ["1/20"]),
    rule_of("soft", ["3"], ["20"]),
    rule_of("rough", ["3/10", "2", "1/5", "7/5"], ["7/10", "1/10"], "1/2"),
    rule_of("rough stub", ["3/10", "2", "1/5", "7/5"], ["7/10", "1/10"], "1"),
]
BY_NAME = {rule.name: rule for rule in RECORDS}
#: Draws are from a frozen list: a rule more must not change them.
DRAWN = [*(RULES[name] for name in RULES_DRAWN), *RECORDS[len(EVERY_N) :]]


def real(value: Fraction | int) -> Any:
    return mp.mpf(value.numerator) / value.denominator


def beam_root(pair: Boundary, mode: int) -> Any:
    """β from the characteristic equations, at working precision."""
    square = [end.holds_deflection == end.holds_rotation for end in (pair.left, pair.right)]
    n = mp.mpf(mode)
    if all(square):
        sign, shift = (-1, HALF) if pair.left == pair.right else (1, -HALF)
        start = (n + real(shift)) * mp.pi if (mode, sign) != (1, 1) else mp.mpf("1.875")
        return mp.findroot(lambda x: mp.cos(x) + sign * mp.sech(x), start)
    if any(square):
        other = pair.right if square[0] else pair.left
        sign = -1 if other.holds_deflection else 1
        start = (n - sign * mp.mpf("0.25")) * mp.pi
        return mp.findroot(lambda x: mp.sin(x) + sign * mp.tanh(x) * mp.cos(x), start)
    return n * mp.pi if pair.left == pair.right else (n - mp.mpf("0.5")) * mp.pi


# Route (a): exact rational mass and stiffness in the pieces' angles, eigenvalues with 60 digits.


def rational_matrices(rule: Rule, pair: Boundary, segments: int) -> tuple[list[list[Fraction]], ...]:
    """K and M of T = ½ Σ (l y_c'² + r l³ θ'²), V = ½ Σ φ²/w over y(0) and all angles, conditions imposed."""
    lengths, weights = rule.piece_lengths(pair, segments), rule.hinge_weights(pair, segments)
    size = len(lengths) + 1
    unit = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    start, angle = unit[0], unit[1:]
    ends = [start]
    for length, theta in zip(lengths, angle, strict=True):
        ends.append([y + length * t for y, t in zip(ends[-1], theta, strict=True)])
    mass, spring = [], []
    for k, length in enumerate(lengths):
        mass.append((length, [(a + b) / 2 for a, b in zip(ends[k], ends[k + 1], strict=True)]))
        mass.append((rule.rotary_inertia * length**3, angle[k]))
    for k, weight in enumerate(weights):
        spring.append((1 / weight, [b - a for a, b in zip(angle[k], angle[k + 1], strict=True)]))
    held = []
    for end, deflection, rotation in ((pair.left, start, angle[0]), (pair.right, ends[-1], angle[-1])):
        held += [deflection] * end.holds_deflection + [rotation] * end.holds_rotation
    basis = null_space(held, size)
    return tuple(gram(terms, basis) for terms in (spring, mass))


def null_space(rows: list[list[Fraction]], size: int) -> list[list[Fraction]]:
    basis = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    for row in rows:
        value = [sum(a * b for a, b in zip(row, vector, strict=True)) for vector in basis]
        pivot = next((k for k, v in enumerate(value) if v), None)
        if pivot is None:
            continue
        lead = basis[pivot]
        basis = [
            [b - value[k] / value[pivot] * p for b, p in zip(vector, lead, strict=True)]
            for k, vector in enumerate(basis)
            if k != pivot
        ]
    return basis


def gram(terms: list[tuple[Fraction, list[Fraction]]], basis: list[list[Fraction]]) -> list[list[Fraction]]:
    values = [[sum(a * b for a, b in zip(row, v, strict=True)) for v in basis] for _, row in terms]
    factors = [factor for factor, _ in terms]
    size = len(basis)
    return [
        [sum(f * row[i] * row[j] for f, row in zip(factors, values, strict=True)) for j in range(size)]
        for i in range(size)
    ]


def matrix_frequencies(rule: Rule, pair: Boundary, segments: int) -> list[Any]:
    """Elastic ω of the chain for L = EI = ρA = 1."""
    exact = rational_matrices(rule, pair, segments)
    if not exact[0]:
        return []
    stiffness, mass = (mp.matrix([[real(x) for x in row] for row in rows]) for rows in exact)
    inverse = mp.inverse(mp.cholesky(mass))
    values = sorted(mp.eigsy(inverse * stiffness * inverse.T, eigvals_only=True))
    return [mp.sqrt(value) * segments**2 for value in values[pair.rigid_body_modes :]]


# Route (b): the boundary determinant by powers of the transfer matrix of one segment, at any N.


def rod(length: Fraction, rule: Rule, squared: Any) -> Any:
    """Transfer of (y, θ, M, V) over a rigid rod of mass `length`."""
    size, inertia = real(length), real(rule.rotary_inertia * length**3)
    lift, tilt = squared * size, squared * size**2 / 2
    return mp.matrix(
        [
            [1, size, 0, 0],
            [0, 1, 0, 0],
            [size * lift / 2, size * tilt / 2 - squared * inertia, 1, size],
            [lift, tilt, 0, 1],
        ]
    )


def hinge(weight: Fraction) -> Any:
    matrix = mp.eye(4)
    matrix[1, 2] = real(weight)
    return matrix


def determinant(rule: Rule, pair: Boundary, segments: int, squared: Any) -> Any:
    """Vanishes at the ω² (segment units) of the chain's modes."""
    near = 2 + max(len(rule.end_weights(end)) for end in (pair.left, pair.right))
    # A chain just long enough to show both ends; the segments it lacks are inserted in its middle.
    short = min(segments, 4 * near)
    lengths = rule.piece_lengths(pair, short)

    def weight(end: End, index: int) -> Fraction:
        weights = rule.end_weights(end)
        return weights[index].at(Fraction(segments)) - 1 if index < len(weights) else Fraction(0)

    total = mp.eye(4)
    middle = len(lengths) // 2
    for k, length in enumerate(lengths):
        total = rod(length, rule, squared) * total
        if k == middle:
            total = (rod(Fraction(1), rule, squared) * hinge(Fraction(1))) ** (segments - short) * total
        if k < len(lengths) - 1:
            back = len(lengths) - 2 - k
            total = hinge(1 + weight(pair.left, k) + weight(pair.right, back)) * total
    free = [3 if pair.left.holds_deflection else 0, 2 if pair.left.holds_rotation else 1]
    held = [0 if pair.right.holds_deflection else 3, 1 if pair.right.holds_rotation else 2]
    a, b = (total[held[0], column] for column in free)
    c, d = (total[held[1], column] for column in free)
    return a * d - b * c


def exact_error(rule: Rule, pair: Boundary, segments: int, mode: int, near: float) -> Any:
    """The root e next to `near`, by secants on the determinant, which must change sign around it."""
    beta = beam_root(pair, mode)

    def function(error: Any) -> Any:
        return determinant(rule, pair, segments, ((beta / segments) ** 2 * (1 + error)) ** 2)

    step = abs(mp.mpf(near)) * mp.mpf("1e-6") + mp.mpf("1e-60")
    x, new = mp.mpf(near) - step, mp.mpf(near) + step
    y, value = function(x), function(new)
    assert y * value < 0 or abs(near) < 1e-60, "no root next to the value under test"
    for _ in range(12):
        if value == y or abs(new - x) < abs(new) * mp.mpf("1e-22"):
            break
        x, y, new = new, value, new - value * (new - x) / (value - y)
        value = function(new)
    return new


def digits(segments: int, mode: int) -> int:
    """Digits that route (b) needs: it loses e^(2β), and N⁴ in each of two rows."""
    return 110 + int(5 * mode + 6 * math.log10(segments))


def check_against_determinant(rule: Rule, pair: Boundary, segments: int, mode: int) -> None:
    error, omega = relative_error(pair, segments, mode, rule), chain_frequency(pair, segments, mode, rule)
    if math.isnan(error):
        assert math.isnan(omega)
        return
    # A bound on the distance to the root is a change of sign within it, which costs a fifth of a solution.
    with mp.workdps(digits(segments, mode)):
        bound = 1e-14
        if mode <= segments / 10:
            bound = min(bound, 1e-12 * abs(error) + allowance(rule, segments, mode))
        beta, case = beam_root(pair, mode), (rule.name, pair.name, segments, mode, error)
        below, above = (
            determinant(rule, pair, segments, ((beta / segments) ** 2 * (1 + mp.mpf(error) + d)) ** 2)
            for d in (-mp.mpf(bound), mp.mpf(bound))
        )
        assert below * above < 0, case
        assert abs(omega / (beta**2 * (1 + error)) - 1) <= 2e-14, case


def allowance(rule: Rule, segments: int, mode: int) -> float:
    """A tuned wall cancels its 1/N² term to the rounding of its own weight: that much is not relative."""
    return 1e-16 * (mode * math.pi / segments) ** 2 if rule.name.startswith("tuned") else 0.0


def sweep(count: int, seed: int) -> None:
    draw = random.Random(seed)
    for _ in range(count):
        rule, pair = draw.choice(DRAWN), draw.choice(BOUNDARIES)
        segments = int(10 ** draw.uniform(0.9, 9))
        mode = draw.randint(1, 10) if draw.random() < 0.85 else int(10 ** draw.uniform(0, 2))
        check_against_determinant(rule, pair, segments, mode)


def test_errors_to_twelve_digits_at_any_length() -> None:
    sweep(60, seed=20)


@pytest.mark.slow
def test_errors_to_twelve_digits_more_of_them() -> None:
    sweep(1500, seed=21)


def check_up_to_the_last_mode(count: int, seed: int) -> None:
    """The determinant changes sign within 2e-14 of the frequency, for any mode of chains of 8 to 80."""
    draw = random.Random(seed)
    for _ in range(count):
        rule, pair, segments = draw.choice(DRAWN), draw.choice(BOUNDARIES), draw.randint(8, 80)
        omega = chain_frequency(pair, segments, np.arange(1, segments + 1), rule)
        omega = omega[~np.isnan(omega)]
        if not len(omega):
            continue
        mode = draw.choice([len(omega), len(omega) - 1, draw.randint(1, len(omega))])
        if np.sort(np.abs(omega / omega[mode - 1] - 1))[1] < 1e-12:
            continue  # A mode at either end, above the band: alike to all digits.
        with mp.workdps(100 + 4 * segments):
            squared = [(mp.mpf(omega[mode - 1]) / segments**2 * (1 + d)) ** 2 for d in (-2e-14, 2e-14)]
            below, above = (determinant(rule, pair, segments, value) for value in squared)
        assert below * above < 0, (rule.name, pair.name, segments, mode)


def test_frequencies_up_to_the_last_mode() -> None:
    check_up_to_the_last_mode(100, seed=22)


@pytest.mark.slow
def test_frequencies_up_to_the_last_mode_more_of_them() -> None:
    check_up_to_the_last_mode(4000, seed=23)


@pytest.mark.parametrize("name", ["mitiguy", "gregory", "half_stub_corrected", "rigid_stub", "tuned 6"])
@pytest.mark.parametrize("pair", ["clamped-free", "clamped-clamped", "guided-free", "pinned-guided"])
def test_short_chains_against_exact_matrices(name: str, pair: str) -> None:
    rule, ends = BY_NAME[name], Boundary.of(pair)
    for segments in (1, 2, 4, 7, 10):
        if min(rule.hinge_weights(ends, segments), default=Fraction(1)) <= 0:
            assert math.isnan(relative_error(ends, segments, 1, rule))
            continue
        with mp.workdps(60):
            exact = matrix_frequencies(rule, ends, segments)
            for mode, omega in enumerate(exact, start=1):
                error = omega / beam_root(ends, mode) ** 2 - 1
                assert abs(relative_error(ends, segments, mode, rule) - error) <= 1e-14
                assert abs(chain_frequency(ends, segments, mode, rule) / omega - 1) <= 1e-14
        assert math.isnan(relative_error(ends, segments, len(exact) + 1, rule))


@pytest.mark.parametrize("name", ["gregory", "half_stub", "hencky"])
def test_the_two_routes_agree(name: str) -> None:
    rule = BY_NAME[name]
    for ends, segments, mode in (("clamped-free", 9, 1), ("clamped-clamped", 10, 2), ("guided-free", 8, 3)):
        pair = Boundary.of(ends)
        with mp.workdps(90):
            matrix = matrix_frequencies(rule, pair, segments)[mode - 1] / beam_root(pair, mode) ** 2 - 1
            powers = exact_error(rule, pair, segments, mode, relative_error(pair, segments, mode, rule))
            assert abs(matrix / powers - 1) < mp.mpf("1e-35")


def test_figures_6_and_7() -> None:
    """Percent, from the coordinator's table of the report's rule (two independent engines)."""
    table = {
        1: (-14.676, None, None, None, None, None),
        2: (-3.366, -24.916, None, -35.044, None, None),
        4: (-0.800, -7.446, -13.165, -12.991, -20.999, -27.893),
        6: (-0.352, -3.423, -6.136, -6.300, -11.101, -15.016),
        10: (-0.126, -1.251, -2.264, -2.372, -4.371, -6.233),
    }
    for segments, row in table.items():
        error = relative_error([["clamped-free"], ["clamped-clamped"]], segments, [1, 2, 3]).ravel() * 100
        for value, printed in zip(error, row, strict=True):
            assert math.isnan(value) if printed is None else round(value, 3) == printed
    twenty = relative_error([["clamped-free"], ["clamped-clamped"]], 20, [1, 2, 3]).ravel() * 100
    assert twenty.round(4).tolist() == [-0.0314, -0.3145, -0.5698, -0.6041, -1.1311, -1.6422]


@pytest.mark.parametrize(
    ("name", "percent", "places"),
    [
        ("mitiguy", -0.126, 3),
        ("naive", -9.11, 2),
        ("double_wall", -0.457, 3),
        ("hencky", -0.84, 2),
        ("half_stub", 0.230, 3),
        ("half_stub_corrected", -0.0012, 4),
        ("rigid_stub", 11.1, 1),
        ("rigid_stub_corrected", 0.290, 3),
        ("gregory", 0.0005, 4),
    ],
)
def test_clamped_free_with_ten_segments(name: str, percent: float, places: int) -> None:
    assert round(100 * relative_error("clamped-free", 10, 1, BY_NAME[name]), places) == percent


def test_gregory_on_very_short_chains() -> None:
    """Overlapping corrections: N = 2 and 3 are Simpson's rules."""
    error = 100 * relative_error("clamped-clamped", [2, 3, 4, 5], 1, BY_NAME["gregory"])
    assert [round(e, d) for e, d in zip(error, (1, 1, 2, 2), strict=True)] == [-34.3, -16.9, -5.78, -1.85]


# Published with this project's benchmarks, 18 digits: chain frequency over Euler-Bernoulli frequency, less 1.
BENCHMARKS = {
    ("clamped-free", "mitiguy", 13): ("-0.000744047863918419559", "-0.00742451286565477009"),
    ("clamped-free", "gregory", 4): ("0.0000855009074231761945", "-0.0333402247986395852"),
    ("clamped-free", "gregory", 13): ("1.53931441044718847e-6", "-5.77935986952456786e-6"),
    ("clamped-clamped", "mitiguy", 9): ("-0.029112266346842272", "-0.0533578379199086031"),
    ("clamped-clamped", "gregory", 13): ("6.69736078033945862e-6", "-0.000701164602299018628"),
    ("clamped-pinned", "double_wall", 9): ("-0.0158675831809260308", "-0.0281875103476005396"),
    ("clamped-guided", "gregory", 13): ("2.63351790840197242e-6", "-0.0000321875265934091116"),
}


@pytest.mark.parametrize("key", BENCHMARKS, ids=str)
def test_benchmarks(key: tuple[str, str, int]) -> None:
    pair, name, segments = key
    for mode, printed in enumerate(BENCHMARKS[key], start=1):
        assert abs(relative_error(pair, segments, mode, BY_NAME[name]) - float(printed)) <= 1e-15


def test_errors_far_below_machine_epsilon() -> None:
    """-(σβ - 1)/(3 N²) for the report's rule, -β⁴/1440 (1 - 113/N) / N⁴ for gregory."""
    sigma_beta, beta = 1.3764994, 1.8751040687
    assert relative_error("clamped-free", 10**9, 1) == pytest.approx((1 - sigma_beta) / 3e18, rel=1e-3)
    assert relative_error("clamped-free", 10**9, 1, BY_NAME["gregory"]) == pytest.approx(
        -(beta**4) / 1440e36, rel=1e-6
    )


def test_pinned_ends_are_exact_sines() -> None:
    """q = nπ/N, so 1 + e = √(12 (1 - cos q)²/(2 + cos q)) / q², to the last digits at any mode."""
    for segments, mode in ((2, 1), (7, 6), (10**4, 3), (10**9, 1), (10**9, 10**7), (10**9, 10**9 - 1)):
        with mp.workdps(80):
            q = mode * mp.pi / segments
            exact = mp.sqrt(12 * (1 - mp.cos(q)) ** 2 / (2 + mp.cos(q))) / q**2 - 1
            error = relative_error("pinned-pinned", segments, mode)
            assert abs(error - exact) <= (1e-15 if q > 0.5 else 1e-14 * abs(exact))


def test_ten_millionth_mode() -> None:
    """Clamped-free `mitiguy`, exponentials of one end extinct at the other: κ is the sum of two phases."""
    segments, mode = 10**9, 10**7
    error = relative_error("clamped-free", segments, mode)
    with mp.workdps(60):
        beta = beam_root(Boundary.of("clamped-free"), mode)
        excess = -mp.mpf(1) / (6 * segments)  # wall weight less 1/2

        def phases(q: Any) -> Any:
            """y = a cos qj + b sin qj + e^(-χj) at either end: y = 0 and θ = excess M; M = 0 and V = 0."""
            c = mp.cos(q)
            chi = mp.acosh((5 - 2 * c) / (2 + c))
            low, high = 2 * (1 - c), 2 * (mp.cosh(chi) - 1)  # 4s², 4S²
            wall = mp.atan2((mp.sinh(chi) + excess * (low + high)) / mp.sin(q), -1)
            return wall + mp.atan2(-low * mp.sinh(chi) / (high * mp.sin(q)), high / low)

        turns = mp.nint((beta - phases(beta / segments)) / mp.pi)
        q = mp.findroot(lambda q: q * segments - phases(q) - turns * mp.pi, beta / segments)
        exact = mp.sqrt(12 * (1 - mp.cos(q)) ** 2 / (2 + mp.cos(q))) * (segments / beta) ** 2 - 1
    assert error == pytest.approx(float(exact), rel=1e-12)


def test_broadcasting_and_single_values() -> None:
    rules = np.array([[BY_NAME["gregory"]], ["mitiguy"]], dtype=object)
    grid = relative_error(["clamped-free", "free-clamped", "pinned-guided"], [3, 300, 30000], 2, rules)
    assert grid.shape == (2, 3)
    single = relative_error(Boundary.of("free-clamped"), np.int64(300), 2, "mitiguy")
    assert isinstance(single, float)
    assert single == pytest.approx(grid[1, 1], rel=1e-14)
    assert relative_error([], [], 1).shape == (0,)
    names = np.array(["clamped-free", "free-free"])
    assert relative_error(names, 5, 1, np.array(["naive", "mitiguy"])).shape == (2,)
    mixed = relative_error("clamped-free", np.arange(1, 400), 5)
    one_by_one = [relative_error("clamped-free", n, 5) for n in range(1, 400)]
    np.testing.assert_allclose(mixed, one_by_one, rtol=1e-11)


def test_modes_that_do_not_exist() -> None:
    assert math.isnan(relative_error("clamped-clamped", 1, 1))
    assert math.isnan(relative_error("clamped-free", 4, 5))
    assert math.isnan(relative_error("clamped-free", 10**9, 10**9 + 1))
    assert np.isnan(relative_error("clamped-free", [2, 3], 1, BY_NAME["tuned 6"])).all()
    # The wall weight 1/2 - 17.279/(6 N) is positive from N = 6.
    found = ~np.isnan(relative_error("clamped-free", [5, 6, 60], 1, BY_NAME["tuned 6"]))
    assert found.tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        (("clamped-free", 2.0, 1), TypeError, "segments must be a whole number .* got 2.0"),
        (("clamped-free", True, 1), TypeError, "segments must be a whole number .* got True"),
        (("clamped-free", 0, 1), ValueError, "segments must be .* at least 1 and at most 1000000000, got 0"),
        (("clamped-free", MAX_SEGMENTS + 1, 1), ValueError, "segments must be .* got 1000000001"),
        (("clamped-free", 5, 0), ValueError, "mode must be .* got 0"),
        (("clamped-free", 5, "1"), TypeError, "mode must be .* got '1'"),
        (("clamped-free", [5, -6], 1), ValueError, "segments must be .* got -6"),
        (("clamped-free", 5, [1.0, 2.0]), TypeError, "mode must be whole numbers"),
        (("clamped-free", 5, [True]), TypeError, "mode must be whole numbers"),
        (("clamped-free", [[1], [2, 3]], 1), TypeError, "segments must be whole numbers"),
        (("clamped-free", [1, 2, 3], [1, 2]), ValueError, "broadcast"),
        (("clamped-fre", 5, 1), ValueError, "clamped-free"),
        (("clamped-free", 5, 1, "mitigy"), ValueError, 'did you mean "mitiguy"'),
        (("clamped-free", 5, 1, ["mitiguy", 3]), TypeError, "rule must be"),
    ],
)
def test_wrong_arguments(arguments: tuple[Any, ...], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        relative_error(*arguments)
