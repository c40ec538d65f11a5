"""Rules: what holds for every record of the registry, and the numbers of the report."""

from __future__ import annotations

import copy
import dataclasses
import itertools
import math
import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from drawn_ends import EVERY_N
from hypothesis import given
from hypothesis import strategies as st

import beammodes as bm
from beammodes.chains.rules import RULES, Rule, Weight, end_defects, hinges_at_nodes, rule_named
from beammodes.closed_form.relative_errors import relative_error
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary

PAIRS = [f"{a}-{b}" for a in ENDS for b in ENDS]
SEGMENTS = (1, 2, 3, 4, 5, 7, 12, 50)
EVERY_RULE = pytest.mark.parametrize("name", EVERY_N)

# theory.md section 4: third-order Gregory end weights.
GREGORY = tuple(Weight(Fraction(a, b)) for a, b in ((3, 8), (7, 6), (23, 24)))


def made(**changes: Any) -> Rule:
    fields: dict[str, Any] = {
        "name": "made",
        "clamped": GREGORY,
    }
    return Rule(**{**fields, **changes})


def bernoulli(k: int, x: Fraction) -> Fraction:
    """Bernoulli polynomials B_1, B_2, B_3; Abramowitz and Stegun, table 23.1."""
    return {1: x - Fraction(1, 2), 2: x**2 - x + Fraction(1, 6), 3: x**3 - 3 * x**2 / 2 + x / 2}[k]


def vanishing_end_terms(rule: Rule, weights: tuple[Weight, ...]) -> list[bool]:
    """Whether the quadrature's end errors of orders 1, 2, 3 vanish at an end whose hinges sit at stub + j.

    The weight 1 everywhere misses  -B_k(stub)/k  of the (k-1)-th moment (Hurwitz's zeta function at 1 - k,
    Abramowitz and Stegun 23.2), which the corrections must make up.
    """
    found = []
    for k in (1, 2, 3):
        at = [rule.stub + j for j in range(len(weights))]
        made_up = sum(
            ((w.constant - 1) * x ** (k - 1) for w, x in zip(weights, at, strict=True)), Fraction(0)
        )
        slipped = sum(w.per_segment * x ** (k - 2) for w, x in zip(weights, at, strict=True)) if k > 1 else 0
        found.append(made_up == bernoulli(k, rule.stub) / k and slipped == 0)
    return found


@EVERY_RULE
def test_records_are_complete(name: str) -> None:
    rule = RULES[name]
    assert rule.name == name
    assert all(isinstance(text, str) for text in (rule.summary, rule.used_by, rule.source))
    assert all(1 <= order <= 4 for order in rule.order.values())
    for number in (rule.stub, rule.rotary_inertia):
        assert isinstance(number, int | Fraction)
    for weight in rule.clamped + rule.guided:
        assert isinstance(weight.constant, int | Fraction)
        assert isinstance(weight.per_segment, int | Fraction)


@EVERY_RULE
@pytest.mark.parametrize("pair", PAIRS)
def test_pieces_make_the_whole_beam(name: str, pair: str) -> None:
    rule, boundary = RULES[name], Boundary.of(pair)
    for segments in SEGMENTS:
        lengths = rule.piece_lengths(boundary, segments)
        assert sum(lengths) == segments
        assert len(rule.hinge_weights(boundary, segments)) == len(lengths) - 1
        assert all(length > 0 for length in lengths[1:-1])
        assert min(lengths) >= 0
        # A piece of length zero is for an end that holds its rotation: anywhere else it would do nothing.
        assert lengths[0] > 0 or boundary.left.holds_rotation
        assert lengths[-1] > 0 or boundary.right.holds_rotation


@EVERY_RULE
@pytest.mark.parametrize("pair", PAIRS)
def test_exchanged_ends_mirror_the_chain(name: str, pair: str) -> None:
    rule, boundary = RULES[name], Boundary.of(pair)
    mirrored = Boundary(boundary.right, boundary.left)
    for segments in SEGMENTS:
        assert rule.hinge_weights(mirrored, segments) == rule.hinge_weights(boundary, segments)[::-1]
        assert rule.piece_lengths(mirrored, segments) == rule.piece_lengths(boundary, segments)[::-1]
    assert rule.declared_order(mirrored) == rule.declared_order(boundary)


@EVERY_RULE
def test_weights_are_one_inside_and_at_ends_without_moment(name: str) -> None:
    rule, size = RULES[name], 40
    reach = max(len(rule.clamped), len(rule.guided))
    for boundary in BOUNDARIES:
        weights = rule.hinge_weights(boundary, size)
        assert set(weights[reach : len(weights) - reach]) == {1}
        for end, weights_from_end in ((boundary.left, weights), (boundary.right, weights[::-1])):
            if not end.holds_rotation:  # pinned, free: no bending moment there, design.md seam 2
                assert weights_from_end[:reach] == [1] * reach
            else:
                prescribed = rule.clamped if end.word == "clamped" else rule.guided
                assert weights_from_end[: len(prescribed)] == [w.at(Fraction(size)) for w in prescribed]


@EVERY_RULE
def test_clamped_order_is_that_of_the_quadrature(name: str) -> None:
    # theory.md section 4: the error of a clamped end is the end error of a quadrature of M², all of whose
    # derivatives there depend on the mode; order p needs the first p - 1 terms to vanish.
    rule = RULES[name]
    vanishing = vanishing_end_terms(rule, rule.clamped)
    order = 1 + (vanishing.index(False) if False in vanishing else len(vanishing))
    assert min(rule.order["clamped"], rule.order["inside"]) == min(order, rule.order["inside"])


@EVERY_RULE
def test_guided_order_is_one_unless_constants_are_integrated(name: str) -> None:
    # theory.md section 4, "any end with its rotation held".
    rule = RULES[name]
    assert (rule.order["guided"] == 1) == (not vanishing_end_terms(rule, rule.guided)[0])


@EVERY_RULE
def test_constant_curvature_between_two_walls(name: str) -> None:
    # Rules of order 2 or more integrate a constant over N segments: sum of weights N, but for what the walls'
    # weights owe to N itself (mitiguy: -1/(6N) at each of two walls).
    rule = RULES[name]
    for segments in SEGMENTS[3:]:
        weights = rule.hinge_weights(Boundary.of("clamped-clamped"), segments)
        owed = 2 * sum(w.per_segment for w in rule.clamped) / Fraction(segments)
        exact = sum(weights) == segments + owed
        assert exact == (rule.order["clamped"] >= 2)


def test_report_sum_between_two_walls() -> None:
    # By hand from 6N/(3N-1): (N - 1) + 2 (3N - 1)/(6N) = N - 1/(3N).
    for segments in SEGMENTS:
        weights = RULES["mitiguy"].hinge_weights(Boundary.of("clamped-clamped"), segments)
        assert sum(weights) == segments - Fraction(1, 3 * segments)


@pytest.mark.parametrize("pair", PAIRS)
def test_declared_order_is_the_smallest(pair: str) -> None:
    # Constants wrong at guided ends, first moments at clamped ones: orders 1 and 2 by Euler and Maclaurin.
    rule = made(clamped=["1/2"], guided=["1"])
    orders = {"clamped": 2, "pinned": 4, "guided": 1, "free": 4}
    assert rule.declared_order(Boundary.of(pair)) == min(orders[end] for end in pair.split("-"))
    below = made(clamped=["3/4"], guided=["1/2"], rotary_inertia="1/4")
    orders = {"clamped": 1, "pinned": 2, "guided": 2, "free": 2}
    assert below.declared_order(Boundary.of(pair)) == min(orders[end] for end in pair.split("-"))


def test_report_examples() -> None:
    # report, N = 4: 24/11 EI/ell at a cantilevered interface, EI/ell elsewhere (theory.md section 1).
    springs = [1 / w for w in RULES["mitiguy"].hinge_weights(Boundary.of("cantilever/free"), 4)]
    assert springs == [Fraction(24, 11), 1, 1, 1]
    springs = [1 / w for w in RULES["mitiguy"].hinge_weights(Boundary.of("cantilever/cantilever"), 4)]
    assert springs == [Fraction(24, 11), 1, 1, 1, Fraction(24, 11)]
    # theory.md section 5.
    assert RULES["double_wall"].hinge_weights(Boundary.of("clamped-free"), 4) == [Fraction(1, 2), 1, 1, 1]
    assert RULES["naive"].hinge_weights(Boundary.of("clamped-free"), 4) == [1, 1, 1, 1]


@pytest.mark.parametrize("name", ["mitiguy", "double_wall"])
def test_guided_wall_takes_twice_the_inner_spring(name: str) -> None:
    # theory.md section 2: mirror symmetry, exact statics.
    assert RULES[name].hinge_weights(Boundary.of("guided-free"), 3) == [Fraction(1, 2), 1, 1]


def test_end_weights_by_kind_of_end() -> None:
    rule = made()
    assert rule.end_weights(ENDS["clamped"]) == GREGORY
    assert rule.end_weights(ENDS["guided"]) == (Weight(Fraction(1, 2)),)
    assert rule.end_weights(ENDS["pinned"]) == rule.end_weights(ENDS["free"]) == ()


@pytest.mark.parametrize("segments", [1, 2, 4, 10**30])
def test_report_wall_weight_in_every_algebra(segments: int) -> None:
    weight = RULES["mitiguy"].clamped[0]
    exact = Fraction(3 * segments - 1, 6 * segments)  # of 6N/(3N-1)
    assert weight.at(Fraction(segments)) == exact
    assert type(weight.at(Fraction(segments))) is Fraction
    assert weight.at(float(segments)) == pytest.approx(float(exact), rel=1e-15)
    size = sympy.Symbol("N")
    formula: sympy.Expr = weight.at(size)
    assert sympy.simplify(formula - (3 * size - 1) / (6 * size)) == 0
    assert formula.subs(size, segments) == sympy.Rational(exact.numerator, exact.denominator)


def test_weight_at_arrays() -> None:
    sizes = np.array([[1.0, 2.0], [4.0, 1e9]])
    found = np.asarray(RULES["mitiguy"].clamped[0].at(sizes), dtype=float)
    assert found.shape == sizes.shape
    # Source: 6N/(3N-1) upside down; 11/24 is the report's N = 4.
    np.testing.assert_allclose(found, (3 * sizes - 1) / (6 * sizes), rtol=1e-15)
    assert found[1, 0] == pytest.approx(11 / 24, rel=1e-15)


@pytest.mark.parametrize(
    ("segments", "thirds"),
    [
        (2, [Fraction(1, 3), Fraction(4, 3), Fraction(1, 3)]),  # Simpson's first rule
        (3, [Fraction(3, 8), Fraction(9, 8), Fraction(9, 8), Fraction(3, 8)]),  # Simpson's second rule
    ],
)
def test_overlapping_corrections_add_to_simpsons_rules(segments: int, thirds: list[Fraction]) -> None:
    # design.md seam 2.
    assert made().hinge_weights(Boundary.of("clamped-clamped"), segments) == thirds


@given(segments=st.integers(2, 60))
def test_third_order_end_weights_integrate_squares(segments: int) -> None:
    # Gregory's rule of this order integrates polynomials to degree 2 exactly, and on N = 2 and 3 to degree 3.
    weights = made().hinge_weights(Boundary.of("clamped-clamped"), segments)
    for power in range(3):
        assert sum(w * Fraction(j) ** power for j, w in enumerate(weights)) == Fraction(
            segments ** (power + 1), power + 1
        )


@pytest.mark.parametrize(
    ("stub", "pair", "lengths"),
    [
        (0, "clamped-free", [0, 1, 1, 1]),
        (0, "clamped-guided", [0, 1, 1, 1, 0]),
        (0, "pinned-free", [1, 1, 1]),
        (Fraction(1, 2), "clamped-free", [Fraction(1, 2), 1, 1, Fraction(1, 2)]),
        (Fraction(1, 2), "free-free", [Fraction(1, 2), 1, 1, Fraction(1, 2)]),
        (1, "clamped-clamped", [1, 1, 1]),
        (1, "free-guided", [1, 1, 1]),
    ],
)
def test_three_layouts_of_three_segments(stub: Any, pair: str, lengths: list[Any]) -> None:
    # design.md seam 1: an outer piece's length may be zero (hinge at the wall), half (stub) or whole;
    # theory.md section 5: half_stub ends in a half segment at the far end too.
    assert made(stub=Fraction(stub)).piece_lengths(Boundary.of(pair), 3) == lengths


@pytest.mark.parametrize("stub", [Fraction(1, 3), 2, -1, Fraction(3, 2)])
def test_other_stubs_are_refused(stub: Any) -> None:
    with pytest.raises(ValueError, match=r"^stub must be 0, 1/2 or 1 segment, got "):
        made(stub=stub)


def test_frozen_through_and_through() -> None:
    rule = made()
    with pytest.raises(TypeError):
        rule.order["clamped"] = 1  # type: ignore[index]
    with pytest.raises(TypeError):
        RULES["own"] = rule  # type: ignore[index]
    with pytest.raises(dataclasses.FrozenInstanceError):
        rule.stub = Fraction(1)  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError):
        GREGORY[0].constant = Fraction(1)  # type: ignore[misc]


# --- What a rule is made from, and what is refused --------------------------------------------------------

FORMS: list[Any] = [
    ["3/8", "7/6", "23/24"],
    ("3/8", "7/6", "23/24"),
    [0.375, 7 / 6, 23 / 24],
    np.array([3 / 8, 7 / 6, 23 / 24]),
    [Fraction(3, 8), Fraction(7, 6), Fraction(23, 24)],
    [Weight("3/8"), "7/6", Fraction(23, 24)],
    [" 0.375 ", "3.5/3", np.float64(23 / 24)],
]


@pytest.mark.parametrize("weights", FORMS, ids=range(len(FORMS)))
def test_weights_in_any_form_make_one_rule(weights: Any) -> None:
    rule = Rule("made", weights)
    assert rule == made() and hash(rule) == hash(made())
    assert rule.clamped == GREGORY
    assert rule.order == RULES["gregory"].order
    assert pickle.loads(pickle.dumps(rule)) == copy.deepcopy(rule) == rule


def test_texts_distinguish_no_rules() -> None:
    assert made(summary="one", used_by="two", source="three") == made()


@pytest.mark.parametrize("stub", ["0", "1/2", "1"])
def test_guided_weights_by_default_are_of_order_four_and_the_fewest(stub: str) -> None:
    rule = Rule("any", [], stub=stub)
    assert rule.order["guided"] == 4
    # Each d_k that counts (k = 0, 2) needs a weight, unless its bare value is zero: B_1, B_3 at the stub.
    needed = sum(bernoulli(k, Fraction(stub)) != 0 for k in (1, 3))
    assert len(rule.guided) == needed + (stub == "1")
    for fewer in range(len(rule.guided)):
        assert Rule("any", [], rule.guided[:fewer], stub=stub).order["guided"] < 4


REFUSED: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"name": 3}, TypeError, "^name must be a text, got 3"),
    ({"name": ""}, ValueError, "^name must be a word of printable characters, got ''"),
    ({"name": "a\nb"}, ValueError, "^name must be a word of printable"),
    ({"summary": None}, TypeError, "^summary must be a text, got None"),
    ({"used_by": 1}, TypeError, "^used_by must be a text"),
    ({"source": b"x"}, TypeError, "^source must be a text"),
    ({"rotary_inertia": -1}, ValueError, "^rotary_inertia must be greater than 0, .* got -1"),
    ({"rotary_inertia": 0}, ValueError, "^rotary_inertia must be greater than 0"),
    ({"rotary_inertia": "x"}, ValueError, "^rotary_inertia must be a number such as .*, got 'x'"),
    ({"rotary_inertia": None}, TypeError, "^rotary_inertia must be a number"),
    ({"rotary_inertia": math.nan}, ValueError, "^rotary_inertia must be finite"),
    ({"stub": "1/3"}, ValueError, "^stub must be 0, 1/2 or 1 segment, got '1/3'"),
    ({"stub": True}, TypeError, "^stub must be a number"),
    ({"stub": "1/0"}, ValueError, "^stub must be finite"),
    ({"clamped": "3/8"}, TypeError, "^clamped must be a sequence of weights, .* got '3/8'"),
    ({"clamped": 0.5}, TypeError, "^clamped must be a sequence of weights"),
    ({"clamped": None}, TypeError, "^clamped must be a sequence of weights"),
    ({"clamped": {"a": 1}}, TypeError, "^clamped must be a sequence of weights"),
    ({"clamped": np.eye(2)}, TypeError, "^clamped must be a sequence of weights"),
    ({"clamped": [None]}, TypeError, r"^clamped\[0\] must be a number"),
    ({"clamped": [1, "x"]}, ValueError, r"^clamped\[1\] must be a number"),
    ({"clamped": [1, True]}, TypeError, r"^clamped\[1\] must be a number"),
    ({"clamped": [1j]}, TypeError, r"^clamped\[0\] must be a number"),
    ({"guided": [0]}, ValueError, r"^guided\[0\] must be greater than 0 in long chains"),
    ({"guided": [-0.5]}, ValueError, r"^guided\[0\] must be greater than 0"),
    ({"guided": [1e300]}, ValueError, r"^guided\[0\] must be .* no more than 1e\+09"),
    ({"guided": ["1e999999999"]}, ValueError, r"^guided\[0\] must be a number"),
    ({"carried": [math.inf]}, ValueError, r"^carried\[0\] must be finite"),
    ({"carried": [1] * 9}, ValueError, "^carried must have at most 8 weights, got 9"),
    ({"guided": [10**400]}, ValueError, r"^guided\[0\] must be"),
]


@pytest.mark.parametrize(("changes", "error", "message"), REFUSED, ids=[str(row[0])[:40] for row in REFUSED])
def test_what_makes_no_rule_is_refused_by_name(
    changes: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        made(**changes)


@pytest.mark.parametrize("value", [None, True, [1], object(), 1j])
def test_what_makes_no_weight_is_refused(value: Any) -> None:
    for argument in ("constant", "per_segment"):
        with pytest.raises(TypeError, match=f"^{argument} must be a number"):
            Weight(**{"constant": 1, argument: value})


def test_an_order_cannot_be_given() -> None:
    with pytest.raises(TypeError, match="order"):
        made(order={"clamped": 4})


@EVERY_RULE
@pytest.mark.parametrize("pair", [f"{a}-{b}" for a in ENDS for b in ENDS if a <= b])
def test_the_derived_order_is_the_errors(name: str, pair: str) -> None:
    """Orders that the weights imply, against errors of chains so long that only the leading term is left."""
    rule, boundary = RULES[name], Boundary.of(pair)
    counts = np.array([2 * 10**6, 4 * 10**6])
    errors = np.abs(np.asarray(relative_error(boundary, counts, 3, rule)))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(rule.declared_order(boundary), abs=1e-3)


def test_bernoulli_polynomials_are_sympys() -> None:
    # Defects of no corrections at all are -B_{k+1}(x₀)/(k+1)!.
    for first in (Fraction(0), Fraction(1, 2), Fraction(1), Fraction(2, 7)):
        at = sympy.Rational(first.numerator, first.denominator)
        expected = [
            -sympy.bernoulli(k + 1, sympy.Symbol("x")).subs("x", at) / math.factorial(k + 1) for k in range(4)
        ]
        assert [Fraction(str(value)) for value in expected] == [c for c, _ in end_defects(first, [])]


def test_equal_rules_are_one_key() -> None:
    assert made() == made()
    assert len({made(), made()}) == 1
    assert made() != made(name="other")
    assert len({*RULES.values(), made()}) == len(RULES) + 1


@EVERY_RULE
def test_rules_by_name(name: str) -> None:
    assert rule_named(name) is RULES[name]
    assert rule_named(RULES[name]) is RULES[name]
    with pytest.raises(ValueError, match=r"^rule must be one of ") as info:
        rule_named(f"{name}x")
    assert f'did you mean "{name}"?' in str(info.value)


def test_a_rule_of_ones_own_is_passed_through() -> None:
    rule = made()
    assert rule_named(rule) is rule


@pytest.mark.parametrize("value", [None, 3, True, ["mitiguy"], Weight(Fraction(1))])
def test_what_is_no_rule(value: Any) -> None:
    with pytest.raises(TypeError, match=r"^rule must be one of mitiguy, "):
        rule_named(value)


# --- Layouts of one's own ---------------------------------------------------------------------------------


class Simpson:
    """Weights 1/3, 4/3, 2/3, 4/3, ... of a cantilever with an even number of segments."""

    name, rotary_inertia = "simpson", Fraction(1, 12)

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        return hinges_at_nodes(boundary, segments)

    def hinge_weights(self, boundary: Boundary, segments: int) -> list[Fraction]:
        count = len(self.piece_lengths(boundary, segments)) - 1
        return [Fraction(2 + 2 * (j % 2), 3 + 3 * (j == 0)) for j in range(count)]


def test_a_layout_serves_everything_that_takes_chains() -> None:
    rule, tip = Simpson(), Boundary.of("clamped-free(mass=0.5)")
    modes = np.arange(1, 4)
    for segments, pair in itertools.product((8, 10), (Boundary.of("clamped-free"), tip)):
        chain = bm.Chain(bm.Beam.unit(), pair, segments, rule)
        exact = bm.euler_bernoulli(bm.Beam.unit(), pair, 3).angular_frequency
        expected = bm.solve_modes(bm.linearize(chain), 3).angular_frequency / exact - 1
        found = bm.frequency_error(pair, segments=segments, mode=modes, rule=rule)
        np.testing.assert_allclose(found, expected, atol=1e-12)
        # Better than `gregory` in all three modes, as this repeated pattern was measured to be.
        worst = np.abs(bm.frequency_error(pair, segments=segments, mode=modes, rule="gregory")).max()
        assert np.abs(found).max() < worst / 2 or pair is tip
    assert rule.name in bm.error_dataset(boundary="clamped-free", segments=[8], modes=2, rule=rule).rule
    for load in (bm.Load(), bm.Load(axial_force=-1.0)):
        corrected = bm.axially_corrected(rule, load, bm.Beam.unit())
        chain = bm.Chain(bm.Beam.unit(), "clamped-free", 8, corrected)
        factor = 1 - load.axial_force / 64 / 12
        plain = bm.Chain(bm.Beam.unit(), "clamped-free", 8, rule)
        np.testing.assert_allclose(chain.joint_stiffness, plain.joint_stiffness * factor, rtol=1e-15)
    assert bm.recommend("clamped-free", tolerance=0.01, modes=2, rules=[rule])[0].rule == "simpson"


@pytest.mark.parametrize(
    "closed",
    [
        lambda rule: bm.error_law("clamped-free", 1, rule),
        lambda rule: bm.chain_frequency("clamped-free", segments=4, mode=1, rule=rule),
    ],
)
def test_closed_forms_say_what_they_need(closed: Any) -> None:
    with pytest.raises(TypeError, match=r"^rule must be a Rule or a name here, whose end weights have a"):
        closed(Simpson())


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"hinge_weights": lambda *_: [1, 1]},
            r"^hinge_weights of simpson must have 4 entries for 5 pieces, got 2",
        ),
        ({"hinge_weights": lambda *_: ["a"] * 4}, r"^hinge_weights of simpson\[0\] must be a real number"),
        ({"hinge_weights": lambda *_: 3}, r"hinge_weights of simpson must be a sequence of numbers, got 3"),
        (
            {"piece_lengths": lambda *_: [0, 1, 1, 1, 2]},
            r"^piece_lengths of simpson must .* add up to 4 segments",
        ),
        ({"piece_lengths": lambda *_: [0, 1, 5, 1, -3]}, r"^piece_lengths of simpson must not be negative"),
        ({"hinge_weights": lambda *_: [1, 0, 1, 1]}, r"^rule simpson has no positive springs"),
    ],
)
def test_what_a_layout_gives_is_checked(changed: dict[str, Any], message: str) -> None:
    rule = type("Own", (Simpson,), changed)()
    with pytest.raises((TypeError, ValueError), match=message):
        bm.Chain(bm.Beam.unit(), "clamped-free", 4, rule)


@pytest.mark.parametrize("value", [None, 3, 1.5, Simpson, Rule, object(), ["mitiguy"]])
def test_what_is_no_rule_is_refused(value: Any) -> None:
    with pytest.raises(
        TypeError, match=r"^rule must be one of mitiguy, .*, or a record that is a Layout, got "
    ):
        bm.Chain(bm.Beam.unit(), "clamped-free", 4, value)
