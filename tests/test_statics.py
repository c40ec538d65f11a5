"""Statics: the beam against textbooks, the chain against its own stiffness matrix, and what rules do."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from drawn_ends import EVERY_N
from scipy.integrate import quad

from beammodes.accuracy.statics import LOADS, Response, Statics, beam_statics, chain_statics, static_dataset
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary
from beammodes.springs.matched_springs import match_springs, matched
from beammodes.springs.tuning import mode_tuned
from beammodes.vibration.linear import nodal_deflections, nodal_matrices

UNIT = Beam.unit()
STEEL = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
FIRM = [pair.name for pair in BOUNDARIES if not pair.rigid_body_modes]
LOOSE = [pair.name for pair in BOUNDARIES if pair.rigid_body_modes]
EVERY_RULE = pytest.mark.parametrize("rule", EVERY_N)
AT_WALL = [name for name in EVERY_N if RULES[name].stub == 0]
# Rotation goes as L³ q, L² F or L M over EI; a deflection has one more length.
LENGTHS = {"tip_force": 2, "tip_moment": 1, "uniform_load": 3}


def error(boundary: str, segments: int, rule: str, load: str, quantity: str = "deflection") -> Fraction:
    ours = getattr(chain_statics(Chain(UNIT, boundary, segments, rule), load).own, quantity)
    theirs = getattr(beam_statics(UNIT, boundary, load).own, quantity)
    exact = ours / (theirs * Fraction(segments) ** (LENGTHS[load] + (quantity != "rotation"))) - 1
    assert isinstance(exact, Fraction)
    return exact


def same(found: Response, expected: Response) -> bool:
    return all(a == b or (a != a and b != b) for a, b in zip(found, expected, strict=True))


# Signs as here: load, deflection and shear force up, moments and rotations counter-clockwise.
ROARK = "Roark's Formulas for Stress and Strain, 7th edition, table 8.1, case "
SHIGLEY = "Shigley's Mechanical Engineering Design, table A-9, case "


@pytest.mark.parametrize(
    ("boundary", "load", "quantity", "expected", "source"),
    [
        ("clamped-free", "tip_force", "deflection", "1/3", SHIGLEY + "1: F l³/3EI"),
        ("clamped-free", "tip_force", "rotation", "1/2", ROARK + "1a: W l²/2EI"),
        ("clamped-free", "tip_force", "midspan_deflection", "5/48", SHIGLEY + "1: F x² (3l - x)/6EI"),
        ("clamped-free", "tip_moment", "deflection", "1/2", SHIGLEY + "4: M l²/2EI"),
        ("clamped-free", "tip_moment", "rotation", "1", ROARK + "3a: M l/EI"),
        ("clamped-free", "tip_moment", "midspan_deflection", "1/8", SHIGLEY + "4: M x²/2EI"),
        ("clamped-free", "uniform_load", "deflection", "1/8", SHIGLEY + "3: w l⁴/8EI"),
        ("clamped-free", "uniform_load", "rotation", "1/6", ROARK + "2a: w l³/6EI"),
        (
            "clamped-free",
            "uniform_load",
            "midspan_deflection",
            "17/384",
            SHIGLEY + "3: w x² (6l² - 4lx + x²)/24EI",
        ),
        ("clamped-guided", "tip_force", "deflection", "1/12", ROARK + "1b: W l³/12EI"),
        ("clamped-guided", "uniform_load", "deflection", "1/24", ROARK + "2b: w l⁴/24EI"),
        ("clamped-pinned", "tip_moment", "rotation", "1/4", ROARK + "3c: M l/4EI"),
        ("clamped-pinned", "uniform_load", "rotation", "-1/48", ROARK + "2c: w l³/48EI"),
        # At midspan; the largest deflection, w l⁴/185EI, is at 0.4215 l from the pinned end.
        (
            "clamped-pinned",
            "uniform_load",
            "midspan_deflection",
            "1/192",
            SHIGLEY + "12: w x² (l - x)(3l - 2x)/48EI",
        ),
        ("clamped-clamped", "uniform_load", "midspan_deflection", "1/384", SHIGLEY + "15: w l⁴/384EI"),
        ("pinned-pinned", "uniform_load", "midspan_deflection", "5/384", SHIGLEY + "7: 5 w l⁴/384EI"),
        ("pinned-pinned", "uniform_load", "rotation", "-1/24", ROARK + "2e: w l³/24EI"),
        ("pinned-pinned", "tip_moment", "rotation", "1/3", ROARK + "3e: M l/3EI"),
        ("pinned-pinned", "tip_moment", "midspan_deflection", "-1/16", SHIGLEY + "8: M x (x² - l²)/6EIl"),
        ("pinned-guided", "tip_force", "deflection", "1/3", ROARK + "1f: W l³/3EI"),
        ("pinned-guided", "uniform_load", "deflection", "5/24", ROARK + "2f: 5 w l⁴/24EI"),
    ],
)
def test_the_beam_of_the_textbooks(
    boundary: str, load: str, quantity: str, expected: str, source: str
) -> None:
    assert getattr(beam_statics(UNIT, boundary, load).own, quantity) == Fraction(expected), source


def test_clamped_pinned_sags_most_where_the_textbook_says() -> None:
    # Shigley's case 12 at its largest: w l⁴/185EI (Roark 2c: 0.0054 w l⁴/EI), above midspan's 1/192.
    x = np.linspace(0, 1, 100_001)
    curve = x**2 * (1 - x) * (3 - 2 * x) / 48
    assert 1 / curve.max() == pytest.approx(185, abs=0.5)
    assert curve.max() > float(beam_statics(UNIT, "clamped-pinned", "uniform_load").own.midspan_deflection)


def stiffness_solution(chain: Chain, load: str) -> Response:
    """K y = f in nodal deflections, half of each piece's load at each of its ends: no reactions, no arms."""
    index, length, last = nodal_deflections(chain), chain.scaled.length, chain.pieces - 1
    stiffness = nodal_matrices(chain, sympy.Rational)[2]
    force = [sympy.Integer(0)] * len(stiffness)

    def push(node: int, amount: Any) -> None:
        if index[node] is not None:
            force[index[node]] += sympy.Rational(amount)

    if load == "tip_force":
        push(chain.pieces, 1)
    elif load == "tip_moment" and not chain.held_angles[last]:
        push(chain.pieces, 1 / length[last])
        push(last, -1 / length[last])
    elif load == "uniform_load":
        for i, share in enumerate(length):
            push(i, share / 2)
            push(i + 1, share / 2)
    solved = list(sympy.Matrix(stiffness).LUsolve(sympy.Matrix(force))) if stiffness else []
    y = [Fraction(0) if i is None else Fraction(int(solved[i].p), int(solved[i].q)) for i in index]
    at = list(itertools.accumulate(length, initial=Fraction(0)))
    middle = next(i for i in range(chain.pieces) if at[i + 1] >= at[-1] / 2)
    part = (at[-1] / 2 - at[middle]) / length[middle]
    end = chain.boundary.right
    return Response(
        math.nan if end.holds_deflection else y[-1],
        math.nan if end.holds_rotation else (y[-1] - y[-2]) / length[last],
        y[middle] + part * (y[middle + 1] - y[middle]),
    )


@EVERY_RULE
@pytest.mark.parametrize("boundary", FIRM)
def test_chain_is_that_of_its_stiffness_matrix_exactly(boundary: str, rule: str) -> None:
    for segments, load in itertools.product((1, 2, 3, 4), LOADS):
        chain = Chain(UNIT, boundary, segments, rule)
        found = chain_statics(chain, load).own
        assert all(isinstance(value, Fraction) or math.isnan(value) for value in found)
        assert same(found, stiffness_solution(chain, load)), (segments, load, found)


def test_mitiguy_tip_force_is_exact_at_every_length() -> None:
    # theory.md section 1: every hinge deflects by F j² (3N - j) ell³/6EI; j = N is the tip, j = N/2 midspan.
    for segments in range(1, 41):
        found = chain_statics(Chain(UNIT, "clamped-free", segments, "mitiguy"), "tip_force").own
        assert found.deflection == Fraction(segments**3, 3)
        if segments % 2 == 0:
            assert found.midspan_deflection == Fraction((segments // 2) ** 2 * (5 * segments // 2), 6)


# Closed forms of the sum of w_j M_j (N - j) over the hinges, less the integral: sums of powers, by hand.
@pytest.mark.parametrize(
    ("rule", "load", "least", "form"),
    [
        ("mitiguy", "tip_moment", 1, lambda n: -1 / (3 * n**2)),
        ("mitiguy", "uniform_load", 1, lambda n: 1 / (3 * n**2)),
        ("double_wall", "tip_force", 1, lambda n: 1 / (2 * n**2)),
        ("double_wall", "tip_moment", 1, lambda n: 0 * n),
        ("double_wall", "uniform_load", 1, lambda n: 1 / n**2),
        ("hencky", "tip_force", 1, lambda n: 1 / (2 * n**2)),
        ("naive", "tip_force", 1, lambda n: 3 / (2 * n) + 1 / (2 * n**2)),
        ("naive", "tip_moment", 1, lambda n: 1 / n),
        ("half_stub", "tip_force", 1, lambda n: -1 / (4 * n**2)),
        ("half_stub", "tip_moment", 1, lambda n: 0 * n),
        ("rigid_stub", "tip_force", 1, lambda n: -3 / (2 * n) + 1 / (2 * n**2)),
        ("rigid_stub", "tip_moment", 1, lambda n: -1 / n),
        # The integrand (N - x)² is of degree 2 and meets the free end with zero value and slope: exact.
        ("gregory", "tip_force", 2, lambda n: 0 * n),
        ("half_stub_corrected", "tip_force", 3, lambda n: 0 * n),
        # Under a tip moment it meets the free end with a slope, where these rules correct nothing.
        ("gregory", "tip_moment", 2, lambda n: -1 / (6 * n**2)),
        ("half_stub_corrected", "tip_moment", 3, lambda n: 1 / (12 * n**2)),
        ("gregory2", "tip_force", 2, lambda n: 1 / (4 * n**3)),
    ],
)
def test_clamped_free_tip_deflection_in_closed_form(rule: str, load: str, least: int, form: Any) -> None:
    for segments in (*range(least, 8), 20, 33):
        assert error("clamped-free", segments, rule, load) == form(Fraction(segments)), segments


def test_gregory_with_one_segment_is_its_first_weight() -> None:
    # One hinge of weight 3/8 for an integral of 1/3.
    assert error("clamped-free", 1, "gregory", "tip_force") == Fraction(1, 8)


def test_the_last_rod_turns_too_little_under_a_tip_moment() -> None:
    # Constant moment: hinges of total weight N - 1/2 for a beam of length N; no hinge ends the chain.
    for segments in (1, 4, 10):
        missing = error("clamped-free", segments, "double_wall", "tip_moment", "rotation")
        assert missing == -Fraction(1, 2 * segments)
        assert error("clamped-free", segments, "half_stub", "tip_moment", "rotation") == 0


@pytest.mark.parametrize("rule", AT_WALL)
def test_pinned_pinned_statics_is_of_order_two_where_frequencies_are_of_order_four(rule: str) -> None:
    # Euler-Maclaurin: the virtual moment's kink at midspan, 2 (1/8)(1/2)/12 over 5/384; no more terms.
    for segments in (2, 4, 10):
        sag = error("pinned-pinned", segments, rule, "uniform_load", "midspan_deflection")
        assert sag == Fraction(4, 5 * segments**2)


@EVERY_RULE
def test_tip_under_uniform_load_has_the_order_of_the_clamped_end(rule: str) -> None:
    # Longer chains where lower orders may be mixed: exact fractions lose no digits.
    counts = (100, 200) if RULES[rule].order["clamped"] > 2 else (1000, 2000)
    errors = [abs(float(error("clamped-free", n, rule, "uniform_load"))) for n in counts]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(RULES[rule].order["clamped"], abs=0.02)


@EVERY_RULE
def test_reciprocity(rule: str) -> None:
    # Maxwell: the moment's deflection is the force's rotation.
    for segments in (1, 2, 5, 8):
        chain = Chain(UNIT, "clamped-free", segments, rule)
        by_moment, by_force = (chain_statics(chain, load).own for load in ("tip_moment", "tip_force"))
        assert by_moment.deflection == by_force.rotation


@pytest.mark.parametrize("boundary", FIRM)
def test_a_load_on_a_held_tip_moves_nothing(boundary: str) -> None:
    tip = ENDS[boundary.split("-")[1]]
    held = {"tip_force": tip.holds_deflection, "tip_moment": tip.holds_rotation}
    for load, (rule, segments) in itertools.product(LOADS[:2], itertools.product(EVERY_N, (3, 6))):
        found = (
            beam_statics(UNIT, boundary, load),
            chain_statics(Chain(UNIT, boundary, segments, rule), load),
        )
        for statics in found:
            moved = [value for value in statics.own if value == value]
            assert (not any(moved)) == held[load]


def test_physical_units() -> None:
    # Shigley A-9 cases 1, 4 and 3.
    length, stiffness = 1.2, 85.0
    expected = {
        "tip_force": (length**3 / 3, length**2 / 2, 5 * length**3 / 48),
        "tip_moment": (length**2 / 2, length, length**2 / 8),
        "uniform_load": (length**4 / 8, length**3 / 6, 17 * length**4 / 384),
    }
    for load, values in expected.items():
        found = beam_statics(STEEL, "clamped-free", load)
        physical = (found.deflection, found.rotation, found.midspan_deflection)
        assert physical == pytest.approx([value / stiffness for value in values], rel=1e-14)
        fine = chain_statics(Chain(STEEL, "clamped-free", 300, "double_wall"), load)
        physical = (fine.deflection, fine.rotation, fine.midspan_deflection)
        assert physical == pytest.approx([value / stiffness for value in values], rel=2e-3)


def test_leaving_the_range_of_doubles_gives_infinity() -> None:
    assert beam_statics(Beam(1e120, 1.0, 1.0), "clamped-free", "tip_force").deflection == math.inf


@pytest.mark.parametrize("boundary", FIRM)
def test_ends_in_either_order(boundary: str) -> None:
    turned = "-".join(reversed(boundary.split("-")))
    length, stiffness = [0.5, 1, 2, 0.25], [3, 1, 2]
    for load in LOADS:
        assert same(beam_statics(UNIT, turned, load).own, beam_statics(UNIT, boundary, load).own)
        one, other = (
            chain_statics(uneven(length[::step], stiffness[::step], name), load).own
            for step, name in ((1, boundary), (-1, turned))
        )
        if boundary.split("-")[0] != boundary.split("-")[1]:
            assert same(one, other)


def uneven(length: Any, stiffness: Any, boundary: str, number: Any = Fraction) -> Chain:
    pieces = [number(value) for value in length]
    return Chain.from_pieces(
        length=pieces,
        mass=pieces,
        rotary_inertia=[value**3 / 12 for value in pieces],
        joint_stiffness=[number(value) for value in stiffness],
        boundary=boundary,
    )


@pytest.mark.parametrize("boundary", FIRM)
def test_uneven_pieces_in_fractions_and_floats(boundary: str) -> None:
    arguments = [0.5, 1, 2, 0.25], [3, 1, 2], boundary
    for load in LOADS:
        exact, found = (chain_statics(uneven(*arguments, number), load) for number in (Fraction, float))
        assert isinstance(exact.own.midspan_deflection, Fraction)
        assert same(exact.own, stiffness_solution(uneven(*arguments), load))
        assert isinstance(found.midspan_deflection, float)
        assert [*map(float, found.own)] == pytest.approx(
            [*map(float, exact.own)], rel=1e-12, abs=1e-14, nan_ok=True
        )


def test_dataset_is_labelled() -> None:
    table = static_dataset(boundary=FIRM, segments=range(1, 5), rule=EVERY_N)
    assert dict(table.sizes) == {"rule": len(EVERY_N), "boundary": len(FIRM), "segments": 4, "static_load": 3}
    assert list(table.data_vars) == [
        "tip_deflection_error",
        "tip_rotation_error",
        "midspan_deflection_error",
    ]
    assert table.attrs["source"].startswith("beammodes ")
    assert all(
        array.attrs["units"] == "1" and "relative error" in array.long_name
        for array in table.data_vars.values()
    )
    assert table["static_load"].values.tolist() == list(LOADS)
    for rule, segments, load in itertools.product(EVERY_N, range(1, 5), LOADS):
        point = table.sel(rule=rule, boundary="clamped-free", segments=segments, static_load=load)
        for name, quantity in (("tip_deflection", "deflection"), ("tip_rotation", "rotation")):
            expected = float(error("clamped-free", segments, rule, load, quantity))
            assert point[f"{name}_error"].item() == expected


def test_dataset_is_missing_only_where_there_is_nothing_to_compare() -> None:
    table = static_dataset(boundary=FIRM, segments=[4, 7], rule=EVERY_N)
    for boundary, load in itertools.product(FIRM, LOADS):
        exact = beam_statics(UNIT, boundary, load).own
        for array, value in zip(table.data_vars.values(), exact, strict=True):
            defined = value == value and value != 0
            found = array.sel(boundary=boundary, static_load=load).values
            assert np.isfinite(found).all() if defined else np.isnan(found).all()


@pytest.mark.parametrize(
    ("boundary", "rule"), [("clamped-clamped", "mitiguy"), ("clamped-free", "rigid_stub")]
)
def test_a_chain_that_cannot_move_is_a_hundred_percent_wrong(boundary: str, rule: str) -> None:
    table = static_dataset(boundary=boundary, segments=1, rule=rule)
    assert table.midspan_deflection_error.sel(static_load="uniform_load").item() == -1.0


def test_dataset_takes_one_or_several_of_each() -> None:
    lone = static_dataset(boundary="free/cantilever", segments=np.int64(4), rule=RULES["naive"])
    assert lone.boundary.values.tolist() == ["clamped-free"]
    many = static_dataset(
        boundary=["clamped-free", ("pinned", "guided")], segments=np.array([2, 4]), rule=("naive", "gregory")
    )
    assert many.sizes["boundary"] == many.sizes["segments"] == many.sizes["rule"] == 2
    assert lone.squeeze().equals(many.sel(boundary="clamped-free", segments=4, rule="naive"))


def test_a_rule_without_positive_springs_gives_nothing() -> None:
    rule = Rule("made", [Weight(1, -2)], ())
    table = static_dataset(boundary="clamped-free", segments=[1, 2, 3], rule=rule)
    found = table.tip_deflection_error.sel(static_load="tip_force").values.ravel()
    assert np.isnan(found).tolist() == [True, True, False]


def test_dataset_takes_tuned_and_matched_records() -> None:
    rules = ["double_wall", mode_tuned(1), matched(2)]
    table = static_dataset(boundary=["clamped-free", "pinned-guided"], segments=[1, 4], rule=rules)
    assert table.rule.values.tolist() == ["double_wall", "mode_tuned(1)", "matched(2)"]
    tip = table.tip_deflection_error.sel(static_load="tip_force")
    assert np.isnan(tip.sel(rule="matched(2)", segments=1)).all()  # one mode only
    found = tip.sel(rule="matched(2)", boundary="clamped-free", segments=4).item()
    expected = match_springs("clamped-free", 4, 2).static_tip_deflection_error
    assert found == pytest.approx(expected, abs=1e-12)
    # Without a clamped end there is nothing to tune.
    plain, tuned = (tip.sel(rule=name, boundary="pinned-guided") for name in ("double_wall", "mode_tuned(1)"))
    assert plain.values.tolist() == tuned.values.tolist()


@pytest.mark.parametrize("boundary", LOOSE)
def test_ends_that_let_the_beam_go_are_refused(boundary: str) -> None:
    chain = Chain(UNIT, boundary, 4)
    calls: list[Any] = [
        lambda: beam_statics(UNIT, boundary, "tip_force"),
        lambda: chain_statics(chain, "tip_force"),
        lambda: static_dataset(boundary=["clamped-free", boundary], segments=4),
    ]
    for call in calls:
        with pytest.raises(
            ValueError, match=f"boundary must hold the beam still .*clamped-free.*'{boundary}'"
        ):
            call()


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: beam_statics("steel", "clamped-free", "tip_force"), TypeError, "beam must be a Beam, got"),
        (lambda: beam_statics(UNIT, "clamped-fre", "tip_force"), ValueError, 'mean "clamped-free"'),
        (lambda: beam_statics(UNIT, "clamped-free", "tip_forces"), ValueError, 'mean "tip_force"'),
        (
            lambda: beam_statics(UNIT, "clamped-free", 3),
            TypeError,
            "load must be one of tip_force, tip_moment",
        ),
        (
            lambda: chain_statics(UNIT, "tip_force"),
            TypeError,
            "chain must be a Chain or a StructureChain, got",
        ),
        (lambda: chain_statics(Chain(UNIT, "clamped-free", 2), "uniform"), ValueError, '"uniform_load"'),
        (lambda: static_dataset(boundary=[], segments=4), ValueError, "boundary must name at least one"),
        (lambda: static_dataset(boundary="clamped-free", segments=[]), ValueError, "segments must name"),
        (lambda: static_dataset(boundary="clamped-free", segments=0), ValueError, "segments must be a whole"),
        (lambda: static_dataset(boundary="clamped-free", segments="six"), TypeError, "got 'six'"),
        (
            lambda: static_dataset(boundary="clamped-free", segments=2.5),
            TypeError,
            "segments must be a whole",
        ),
        (lambda: static_dataset(boundary="clamped-free", segments=True), TypeError, "got True"),
        (
            lambda: static_dataset(boundary="clamped-free", segments=4, rule="gregry"),
            ValueError,
            'mean "gregory"',
        ),
        (lambda: static_dataset(boundary=7, segments=4), TypeError, "boundary must be a name"),
    ],
)
def test_bad_input(call: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


def test_statics_are_what_both_routes_return() -> None:
    assert isinstance(beam_statics(UNIT, "clamped-free", "tip_force"), Statics)
    assert chain_statics(Chain(STEEL, "clamped-free", 3), "tip_force").units.length == pytest.approx(0.4)


# --- Beams that vary --------------------------------------------------------------------------------------


def test_a_stepped_cantilever() -> None:
    # 20 ∫ (4 - x)²/EI dx, EI 1.5 to x = 2 and 1 beyond: 20 ((64 - 8)/3/1.5 + 8/3) = 2720/9.
    beam = Beam(4.0, [1.5, 1.0], 1.0)
    assert 20 * beam_statics(beam, "clamped-free", "tip_force").deflection == pytest.approx(
        2720 / 9, rel=1e-12
    )
    turned = Beam(4.0, [1.0, 1.5], 1.0)
    assert 20 * beam_statics(turned, "free-clamped", "tip_force").deflection == pytest.approx(
        2720 / 9, rel=1e-12
    )


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("pair", [pair for pair in BOUNDARIES if not pair.rigid_body_modes])
def test_quadrature_of_a_uniform_beam_is_the_fraction(pair: Boundary, load: str) -> None:
    exact = beam_statics(Beam(2.0, 3.0, 1.0), pair, load)
    found = beam_statics(Beam(2.0, lambda x: 3.0 + 0.0 * x, 1.0), pair, load)
    for quantity in ("deflection", "rotation", "midspan_deflection"):
        assert getattr(found, quantity) == pytest.approx(getattr(exact, quantity), abs=1e-13, nan_ok=True)


def test_a_taper_by_virtual_work() -> None:
    # y = ∫ M m/EI dx, m the moment of a unit force or couple where y or the rotation is wanted.
    length = 1.5

    def stiffness(x: float) -> float:
        return (1 - x / 2) ** 3

    def work(moment: Any, virtual: Any) -> float:
        return float(
            quad(lambda x: moment(x) * virtual(x) / stiffness(x), 0, length, epsabs=0, points=[0.75])[0]
        )

    def at(place: float) -> Any:
        return lambda x: max(place - x, 0.0)

    taper = Beam(length, lambda x: (1 - x / 2) ** 3, 1.0)
    moments = {
        "tip_force": at(length),
        "tip_moment": lambda _: 1.0,
        "uniform_load": lambda x: (length - x) ** 2 / 2,
    }
    for load, moment in moments.items():
        found = beam_statics(taper, "clamped-free", load)
        assert found.deflection == pytest.approx(work(moment, at(length)), rel=1e-10)
        assert found.rotation == pytest.approx(work(moment, lambda _: 1.0), rel=1e-10)
        assert found.midspan_deflection == pytest.approx(work(moment, at(length / 2)), rel=1e-10)
    # The reaction that keeps a propped tip down, by superposition.
    prop = -work(moments["uniform_load"], at(length)) / work(at(length), at(length))
    sag = work(moments["uniform_load"], at(length / 2)) + prop * work(at(length), at(length / 2))
    assert beam_statics(taper, "clamped-pinned", "uniform_load").midspan_deflection == pytest.approx(
        sag, rel=1e-9
    )
    assert beam_statics(taper, "clamped-pinned", "tip_force").midspan_deflection == pytest.approx(
        0.0, abs=1e-12
    )


@pytest.mark.parametrize("pair", ["clamped-free", "clamped-clamped", "pinned-pinned", "guided-clamped"])
def test_a_taper_against_a_long_chain(pair: str) -> None:
    taper = Beam(1.5, lambda x: (1 - x / 2) ** 3, 1.0)
    exact = beam_statics(taper, pair, "uniform_load")
    chain = chain_statics(Chain(taper, pair, 400, "gregory"), "uniform_load")
    assert chain.midspan_deflection == pytest.approx(exact.midspan_deflection, rel=1e-4)


def test_statics_print_what_they_answer_in_si_units() -> None:
    assert repr(
        chain_statics(Chain(Beam(2.0, 80.0, 1.0), "clamped-free", 8, "gregory"), "tip_force")
    ).startswith("Statics(tip_force of 1 N: deflection 0.0333333 m, rotation ")
    assert repr(beam_statics(Beam(2.0, 80.0, 1.0), "clamped-guided", "uniform_load")) == (
        "Statics(uniform_load of 1 N/m: deflection 0.00833333 m, midspan deflection 0.0046875 m)"
    )
