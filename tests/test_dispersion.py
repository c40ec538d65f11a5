"""Frequencies of uniform chains: every mode up to the last, in the band and above it."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from drawn_ends import EVERY_N, RULES_DRAWN
from numpy.typing import NDArray
from turns import in_turns

from beammodes.accuracy.law import error_law
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.closed_form.chain_frequencies import chain_frequency
from beammodes.closed_form.relative_errors import relative_error
from beammodes.exact.exact_beam import wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, Boundary


def rule_of(name: str, clamped: list[str], guided: list[str], stub: str = "0", inertia: str = "1/12") -> Rule:
    return Rule(name, clamped, guided, stub=stub, rotary_inertia=inertia)


def tuned(name: str, sigma_beta: str) -> Rule:
    plain = rule_of(name, [], ["1/2"])
    wall = (Weight(Fraction(1, 2), -Fraction(sigma_beta) / 6),)
    return Rule(name, wall, plain.guided)


RECORDS = [
    *(RULES[name] for name in EVERY_N),
    tuned("tuned low", "1.376"),
    tuned("tuned high", "31.4"),
    tuned("tuned higher", "95.9"),
    # Walls near the weight 0.067 at which a mode leaves the band, and beyond.
    *(rule_of(f"wall {w}", [w], [w]) for w in ("0.01", "0.066", "0.067", "0.0672", "0.08", "20")),
    rule_of("rough", ["0.3", "2", "0.2", "1.4"], ["0.7", "0.1"], "1/2"),
    rule_of("rough stub", ["0.3", "2", "0.2", "1.4"], ["0.7", "0.1"], "1"),
    rule_of("rough points", ["0.1", "0.1", "0.1", "3"], ["0.1", "0.1"], inertia="1/5"),
]
BY_NAME = {rule.name: rule for rule in RECORDS}


def dense_frequencies(rule: Rule, pair: Boundary, segments: int) -> NDArray[np.float64]:
    """All elastic ω for L = EI = ρA = 1 from dense matrices in y(0), θ(0) and the joint rotations."""
    lengths = [float(length) for length in rule.piece_lengths(pair, segments)]
    weights = np.array([float(weight) for weight in rule.hinge_weights(pair, segments)])
    count = len(lengths)
    angle = np.column_stack([np.zeros(count), np.ones(count), np.tri(count, count - 1, -1)])
    node = np.zeros((count + 1, count + 1))
    node[0, 0] = 1.0
    for k, length in enumerate(lengths):
        node[k + 1] = node[k] + length * angle[k]
    rows = []
    for k, length in enumerate(lengths):
        rows.append(math.sqrt(length) * (node[k] + node[k + 1]) / 2)
        rows.append(math.sqrt(float(rule.rotary_inertia) * length**3) * angle[k])
    held = []
    for end, deflection, rotation in ((pair.left, node[0], angle[0]), (pair.right, node[-1], angle[-1])):
        held += [deflection] * end.holds_deflection + [rotation] * end.holds_rotation
    basis = scipy.linalg.null_space(np.array(held)) if held else np.eye(count + 1)
    factor = np.array(rows) @ basis
    spring = basis[2:].T / weights @ basis[2:]
    values = scipy.linalg.eigh(spring, factor.T @ factor, eigvals_only=True)
    return np.sqrt(values[pair.rigid_body_modes :]) * segments**2


@pytest.mark.parametrize("rule", RECORDS, ids=lambda rule: rule.name)
@pytest.mark.parametrize(
    "segments", [5, 40, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2, 3, 8, 9, 12, 21))]
)
def test_every_mode_up_to_the_last(rule: Rule, segments: int) -> None:
    for pair in BOUNDARIES:
        weights = rule.hinge_weights(pair, segments)
        asked = np.arange(1, segments + 2)
        omega = chain_frequency(pair, segments, asked, rule)
        if not weights or min(weights) <= 0:
            assert np.isnan(omega).all()
            continue
        exact = dense_frequencies(rule, pair, segments)
        assert np.isnan(omega[len(exact) :]).all()
        np.testing.assert_allclose(omega[: len(exact)], exact, rtol=5e-9, err_msg=pair.name)


def test_both_routes_to_the_frequency_agree() -> None:
    """The error's power series and the direct root share nothing but the ends' polynomials."""
    rules = np.array([RULES[name] for name in EVERY_N], dtype=object)[:, None, None, None]
    pairs = np.array(BOUNDARIES, dtype=object)[:, None, None]
    segments, mode = np.array([[24], [57], [400], [10**5], [10**9]]), np.array([1, 2, 3, 7, 12])
    omega = chain_frequency(pairs, segments, mode, rules)
    error = relative_error(pairs, segments, mode, rules)
    beta = wavenumber(pairs, mode)
    np.testing.assert_allclose(omega, beta**2 * (1 + error), rtol=3e-15)


def test_closed_forms() -> None:
    """Pinned-pinned: q = nπ/N; guided-guided with mirror ends too, up to the top of the band, √48 N²."""
    segments = np.array([[8], [50], [1000]])
    mode = np.arange(1, 8)
    q = mode * np.pi / segments
    exact = np.sqrt(12 * (1 - np.cos(q)) ** 2 / (2 + np.cos(q))) * segments**2
    for pair in ("pinned-pinned", "guided-guided"):
        np.testing.assert_allclose(chain_frequency(pair, segments, mode), exact, rtol=1e-11)
    assert chain_frequency("guided-guided", 1000, 1000) == pytest.approx(math.sqrt(48) * 1e6, rel=1e-15)
    points = rule_of("points", ["1/2"], ["1/2"], inertia="1/4")
    assert chain_frequency("guided-guided", 9, 9, points) == pytest.approx(4 * 81, rel=1e-15)


def test_modes_above_the_band() -> None:
    """A free half-length end vibrates by itself: ω → 8.868 N², once per free end, and 13.9 N² for N = 1."""
    half = BY_NAME["half_stub"]
    for segments in (50, 10**4, 10**9):
        one = chain_frequency("clamped-free", segments, segments, half) / segments**2
        two = chain_frequency("free-free", segments, [segments - 1, segments], half) / segments**2
        assert round(one, 3) == 8.868
        np.testing.assert_allclose(two, one, rtol=1e-12)
        below = chain_frequency("free-free", segments, segments - 2, half) / segments**2
        assert below < math.sqrt(48)
    assert round(chain_frequency("free-free", 1, 1, half), 1) == 13.9


def test_last_modes_of_a_long_chain_stay_in_order() -> None:
    """The last ten of N = 10⁶ follow the long-wave pattern of the band's edge: π - q grows by about π/N."""
    segments = 10**6
    mode = np.arange(segments - 10, segments + 1)
    for name in ("mitiguy", "gregory", "rigid_stub_corrected", "half_stub", "tuned high"):
        for pair in BOUNDARIES:
            omega = chain_frequency(pair, segments, mode, BY_NAME[name])
            inside = omega[~np.isnan(omega)] / segments**2
            inside = inside[inside < math.sqrt(48) * (1 - 1e-15)]
            assert np.all(np.diff(inside) > 0)
            # ω²/48 = s⁴/(3 - 2 s²), so 1 - ω²/48 → 4 (1 - s²) = (π - q)².
            distance = np.sqrt(1 - inside**2 / 48) * segments / math.pi
            np.testing.assert_allclose(np.diff(distance[:6]), -1.0, atol=5e-3)


def test_many_lookups_at_once_are_those_one_by_one() -> None:
    draw = np.random.default_rng(5)
    count = 200_000
    pairs = np.array(BOUNDARIES, dtype=object)[draw.integers(0, 10, count)]
    rules = np.array([RULES[name] for name in RULES_DRAWN], dtype=object)[draw.integers(0, 10, count)]
    segments, mode = draw.integers(1, 10**6, count), draw.integers(1, 6, count)
    error = relative_error(pairs, segments, mode, rules)
    assert np.isfinite(error[segments > 20]).all()
    for k in draw.integers(0, count, 200):
        one = relative_error(pairs[k], segments[k], mode[k], rules[k])
        np.testing.assert_allclose(one, error[k], rtol=1e-12)


# --- Against 50 digits -------------------------------------------------------------------------------------

# Ends whose corrections reach over most of the chain, ends that turn waves by a whole turn, walls that let
# modes leave the band: rules as wild as `Rule` allows. Fixed, so that no other rule's existence moves them.
WILD = [
    rule_of("both ends meet", ["3/10", "2", "1/5", "7/5"], ["7/10", "1/10"], "1"),
    rule_of("turns far", ["12/5", "19/5", "23/10", "27/10"], ["1/10", "6/5", "1/5"], "1/2", "1/5"),
    rule_of("turns back", ["19/10", "1/20", "6/5", "1/20"], ["7/5", "4"], "1", "1/4"),
    rule_of("soft then stiff", ["3/10", "21/10", "3/20", "1/10"], ["3/10", "8/5", "19/5"], "1/2", "1/4"),
]


def assert_right_to_13_digits(rule: Rule, pair: Boundary, segments: int, exact: Any) -> None:
    chain = Chain(Beam.unit(), pair, segments, rule)
    expected = [float(value) * segments**2 for value in exact(chain)][pair.rigid_body_modes :]
    found = chain_frequency(pair, segments, np.arange(1, len(expected) + 1), rule)
    np.testing.assert_allclose(found, expected, rtol=1e-13, err_msg=f"{rule}, {pair}, {segments}")


@pytest.mark.parametrize(
    ("rule", "segments"),
    in_turns(WILD, [4, 7, 8, 9, 10, 13], every=2),
    ids=lambda value: getattr(value, "name", None),
)
def test_wild_rules_to_13_digits(rule: Rule, segments: int, frequencies_in_50_digits: Any) -> None:
    for pair in BOUNDARIES:
        if min(rule.hinge_weights(pair, segments), default=1) > 0:
            assert_right_to_13_digits(rule, pair, segments, frequencies_in_50_digits)


def test_neighbouring_modes_of_a_short_chain() -> None:
    # 50-digit eigenvalues of the rational matrices: this mode was 1.3e-9 off when the two ends' growing
    # exponentials, three segments apart, were left out of the edge's determinant.
    found = chain_frequency("clamped-guided", 9, 6, WILD[0])
    assert found == pytest.approx(735.4348331568, rel=1e-13)


@pytest.mark.slow
def test_random_rules_to_13_digits(frequencies_in_50_digits: Any) -> None:
    random = np.random.default_rng(2024)
    for _ in range(300):
        ends = [
            [str(Fraction(int(k), 20)) for k in random.integers(1, 81, size=random.integers(0, 5))]
            for _ in "cg"
        ]
        stub, inertia = str(random.choice(["0", "1/2", "1"])), str(random.choice(["1/12", "1/5", "1/4"]))
        rule, segments = rule_of("random", *ends, stub, inertia), int(random.integers(1, 15))
        pair = BOUNDARIES[int(random.integers(len(BOUNDARIES)))]
        if min(rule.hinge_weights(pair, segments), default=1) > 0:
            assert_right_to_13_digits(rule, pair, segments, frequencies_in_50_digits)


def test_a_rule_that_turns_waves_too_far_in_a_long_chain() -> None:
    # Two routes: counted roots, and the matrices.
    rule, modes = WILD[1], np.arange(1, 6)
    found = chain_frequency("clamped-guided", 60, modes, rule)
    np.testing.assert_allclose(
        found, dense_frequencies(rule, Boundary.of("clamped-guided"), 60)[:5], rtol=1e-9
    )
    assert relative_error("clamped-guided", 10**6, 1, rule) * 10**6 == pytest.approx(
        error_law("clamped-guided", 1, rule).coefficient, rel=1e-3
    )
    with pytest.raises(ValueError, match=r"^mode must be at most 1000 with rule turns far"):
        chain_frequency("clamped-guided", 10**6, 1001, rule)
