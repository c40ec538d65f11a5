"""The chain: its numbers in physical units, its count of modes, its own pieces, and bad input."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from drawn_ends import EVERY_N
from hypothesis import given
from hypothesis import strategies as st

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import RULES, Rule, Weight
from beammodes.checks import shown
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS, Boundary

BEAM = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
PAIRS = [f"{a}-{b}" for a in ENDS for b in ENDS]
COLUMNS = ("length", "mass", "rotary_inertia")
EVERY_RULE = pytest.mark.parametrize("rule", EVERY_N)
EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS)
# theory.md section 2: N elastic modes, or N - 1 for these pairs, in either order.
ONE_FEWER = ("clamped-clamped", "clamped-pinned", "pinned-pinned", "pinned-free", "free-free")
AT_WALL = [name for name in EVERY_N if RULES[name].stub == 0]
BAD_SEGMENTS = [0, -3, 2.5, "six", 10**400, True, None, math.nan, math.inf]


def valid(boundary: str, segments: int, rule: str) -> Chain | None:
    """The chain, or None where the rule gives no positive springs."""
    if any(weight <= 0 for weight in RULES[rule].hinge_weights(Boundary.of(boundary), segments)):
        return None
    return Chain(BEAM, boundary, segments, rule)


def pieces(**changes: Any) -> dict[str, Any]:
    """Arguments of `from_pieces` for a cantilever of two unlike rods."""
    fields: dict[str, Any] = {
        "length": [0, 1.0, 2.0],
        "mass": [0, 3.0, 4.0],
        "rotary_inertia": [0, 0.25, 1.0],
        "joint_stiffness": [5.0, 6.0],
        "boundary": "clamped-free",
    }
    return {**fields, **changes}


def same_numbers(one: Chain, other: Chain, rtol: float = 0.0) -> None:
    for name in (*COLUMNS, "joint_stiffness", "hinge_position"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=rtol, atol=0, err_msg=name)


def test_report_springs_in_newton_metres() -> None:
    # report, N = 4: 24/11 EI/ell at the wall and EI/ell elsewhere; EI/ell = 85/0.3.
    chain = Chain(BEAM, "cantilever/free", segments=4)
    np.testing.assert_allclose(chain.joint_stiffness, 85 / 0.3 * np.array([24 / 11, 1, 1, 1]), rtol=1e-15)
    np.testing.assert_allclose(chain.hinge_position, [0, 0.3, 0.6, 0.9], rtol=1e-15)
    both = Chain(BEAM, "cantilever/cantilever", segments=4)
    np.testing.assert_allclose(
        both.joint_stiffness, 85 / 0.3 * np.array([24 / 11, 1, 1, 1, 24 / 11]), rtol=1e-15
    )
    np.testing.assert_allclose(both.hinge_position, [0, 0.3, 0.6, 0.9, 1.2], rtol=1e-15)


def test_rods_in_physical_units() -> None:
    # theory.md section 2: mass m = ρA ell, central inertia m ell²/12; ell = 0.3, ρA = 0.62.
    chain = Chain(BEAM, "clamped-free", segments=4, rule="mitiguy")
    np.testing.assert_allclose(chain.length, [0, 0.3, 0.3, 0.3, 0.3], rtol=1e-15)
    np.testing.assert_allclose(chain.mass, [0, *[0.186] * 4], rtol=1e-15)
    np.testing.assert_allclose(chain.rotary_inertia, [0, *[0.186 * 0.09 / 12] * 4], rtol=1e-14)
    # By hand: √(EI/ell / (ρA ell · ell²)) = √(EI/ρA)/ell².
    assert chain.units.angular_frequency == pytest.approx(math.sqrt(85 / 0.62) / 0.09, rel=1e-14)


def test_pieces_of_half_a_segment() -> None:
    # By hand: a rod of half the length has half the mass and (1/2)³ of the central inertia, 1/12 for a rod
    # and 1/4 for point masses at its ends (theory.md section 5: half_stub, hencky).
    for inertia in (Fraction(1, 12), Fraction(1, 4)):
        rule = Rule("made", (), stub="1/2", rotary_inertia=inertia)
        chain = Chain(BEAM, "clamped-free", 2, rule)
        assert chain.scaled.mass == chain.scaled.length == (Fraction(1, 2), 1, Fraction(1, 2))
        assert chain.scaled.rotary_inertia == (inertia / 8, inertia, inertia / 8)
        np.testing.assert_allclose(chain.hinge_position, [0.3, 0.9], rtol=1e-15)


@EVERY_RULE
@EVERY_PAIR
def test_whole_length_and_mass(rule: str, pair: str) -> None:
    for segments in (1, 2, 3, 10, 41):
        chain = valid(pair, segments, rule)
        if chain is None:
            continue
        assert sum(chain.scaled.length) == sum(chain.scaled.mass) == segments
        assert chain.length.sum() == pytest.approx(1.2, rel=1e-14)
        assert chain.mass.sum() == pytest.approx(0.62 * 1.2, rel=1e-14)
        assert (chain.joint_stiffness > 0).all()
        assert chain.pieces == len(chain.length) == len(chain.joint_stiffness) + 1
        assert (chain.beam, chain.segments, chain.rule) == (BEAM, segments, RULES[rule])


@pytest.mark.parametrize("rule", AT_WALL)
@EVERY_PAIR
def test_elastic_modes_with_hinges_at_the_walls(rule: str, pair: str) -> None:
    canonical = pair if pair in ONE_FEWER else "-".join(reversed(pair.split("-")))
    fewer = canonical in ONE_FEWER
    for segments in (1, 2, 3, 10):
        chain = valid(pair, segments, rule)
        assert chain is None or chain.elastic_modes == segments - fewer


@pytest.mark.parametrize("pair", ONE_FEWER)
def test_one_segment_without_elastic_mode_is_a_chain(pair: str) -> None:
    # theory.md section 2: N = 1 there is a valid chain without an elastic mode.
    chain = Chain(BEAM, pair, segments=1)
    assert chain.elastic_modes == 0
    assert chain.length.sum() == 1.2


@EVERY_RULE
@EVERY_PAIR
def test_elastic_modes_by_rank(rule: str, pair: str) -> None:
    """From the definition: independent hinge rotations among the motions that the ends allow."""
    for segments in (1, 2, 3, 6):
        chain = valid(pair, segments, rule)
        if chain is None:
            continue
        count = chain.pieces  # unknowns: deflection of the left tip, then the angles
        tips = [np.eye(count + 1)[0], np.array([1.0, *map(float, chain.scaled.length)])]
        angles = [np.eye(count + 1)[1], np.eye(count + 1)[count]]
        ends = (chain.boundary.left, chain.boundary.right)
        held = [row for row, end in zip(tips, ends, strict=True) if end.holds_deflection]
        held += [row for row, end in zip(angles, ends, strict=True) if end.holds_rotation]
        joints = [np.eye(count + 1)[j + 2] - np.eye(count + 1)[j + 1] for j in range(count - 1)]
        rank = np.linalg.matrix_rank(np.array(held)) if held else 0
        both = np.linalg.matrix_rank(np.array(held + joints)) if held + joints else 0
        assert chain.elastic_modes == both - rank
        assert chain.boundary.rigid_body_modes == count + 1 - both


@EVERY_RULE
@EVERY_PAIR
def test_from_pieces_makes_the_same_chain(rule: str, pair: str) -> None:
    for segments in (1, 2, 7):
        chain = valid(pair, segments, rule)
        if chain is None:
            continue
        physical = {name: getattr(chain, name) for name in (*COLUMNS, "joint_stiffness")}
        again = Chain.from_pieces(**physical, boundary=pair)
        same_numbers(again, chain)
        assert again.boundary == chain.boundary
        assert again.elastic_modes == chain.elastic_modes
        assert again.held_angles == chain.held_angles
        assert (again.beam, again.segments, again.rule) == (None, None, None)
        exact = Chain.from_pieces(
            length=chain.scaled.length,
            mass=chain.scaled.mass,
            rotary_inertia=chain.scaled.rotary_inertia,
            joint_stiffness=chain.scaled.joint_stiffness,
            boundary=pair,
        )
        assert exact.scaled.joint_stiffness == chain.scaled.joint_stiffness
        assert exact.scaled.rotary_inertia == chain.scaled.rotary_inertia
        assert {type(number) for number in exact.scaled.length} == {Fraction}


def test_from_pieces_keeps_numbers_as_given() -> None:
    chain = Chain.from_pieces(**pieces())
    assert chain.length.tolist() == [0, 1, 2]
    assert chain.mass.tolist() == [0, 3, 4]
    assert chain.rotary_inertia.tolist() == [0, 0.25, 1]
    assert chain.joint_stiffness.tolist() == [5, 6]
    assert chain.hinge_position.tolist() == [0, 1]
    assert (chain.pieces, chain.elastic_modes) == (3, 2)
    assert chain == Chain.from_pieces(**pieces(length=np.array([0.0, 1.0, 2.0]), mass=(0, 3, np.float32(4))))


@pytest.mark.parametrize("pair", PAIRS)
def test_idle_outer_pieces_are_condensed(pair: str) -> None:
    # design.md seam 1: massless zero-length pieces are condensed away; an end that holds the rotation makes
    # its piece a wall, which stays.
    chain = Chain.from_pieces(
        length=[0, 1, 2, 0],
        mass=[0, 3, 4, 0],
        rotary_inertia=[0, 0.25, 1, 0],
        joint_stiffness=[7, 8, 9],
        boundary=pair,
    )
    left, right = (ENDS[name].holds_rotation for name in pair.split("-"))
    assert chain.length.tolist() == [0] * left + [1, 2] + [0] * right
    assert chain.mass.tolist() == [0] * left + [3, 4] + [0] * right
    assert chain.joint_stiffness.tolist() == [7] * left + [8] + [9] * right
    assert chain.held_angles == (left, *[False] * (chain.pieces - 2), right)


def test_zero_length_body_with_inertia_stays() -> None:
    chain = Chain.from_pieces(
        length=[1, 0], mass=[1, 0.5], rotary_inertia=[0.1, 0.2], joint_stiffness=[3], boundary="free-free"
    )
    assert chain.mass.tolist() == [1, 0.5]
    assert chain.joint_stiffness.tolist() == [3]


@pytest.mark.parametrize(
    ("pair", "held"),
    [
        ("clamped-free", (True, False)),
        ("guided-pinned", (True, False)),
        ("free-guided", (False, True)),
        ("pinned-free", (False, False)),
        ("clamped-guided", (True, True)),
    ],
)
def test_held_angles(pair: str, held: tuple[bool, bool]) -> None:
    chain = Chain(BEAM, pair, segments=5)
    assert (chain.held_angles[0], chain.held_angles[-1]) == held
    assert not any(chain.held_angles[1:-1])


@pytest.mark.parametrize("chain", [Chain(BEAM, "clamped-free", 3), Chain.from_pieces(**pieces())], ids=repr)
def test_frozen_and_read_only(chain: Chain) -> None:
    for field in dataclasses.fields(chain):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(chain, field.name, None)
    for name in (*COLUMNS, "joint_stiffness", "hinge_position"):
        array = getattr(chain, name)
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(chain, name, array)


def test_given_arrays_are_copied() -> None:
    length = np.array([0.0, 1.0, 2.0])
    chain = Chain.from_pieces(**pieces(length=length))
    length[1] = 9.0
    assert chain.length.tolist() == [0, 1, 2]


def test_equal_chains_are_one_key() -> None:
    chain = Chain(BEAM, "clamped-free", 4)
    assert len({chain, Chain(BEAM, "cantilever/free", 4, RULES["mitiguy"])}) == 1
    assert chain != Chain(BEAM, "free-clamped", 4)
    assert chain != Chain(BEAM, "clamped-free", 5)


@EVERY_PAIR
def test_exchanged_ends_mirror_the_chain(pair: str) -> None:
    chain = Chain(BEAM, pair, 5)
    mirrored = Chain(BEAM, "-".join(reversed(pair.split("-"))), 5)
    for name in (*COLUMNS, "joint_stiffness"):
        assert getattr(mirrored, name).tolist() == getattr(chain, name)[::-1].tolist()
    np.testing.assert_allclose(mirrored.hinge_position, 1.2 - chain.hinge_position[::-1], atol=1e-15)


def test_repr_names_what_it_is() -> None:
    assert repr(Chain(BEAM, "clamped-free", 4)) == "<Chain clamped-free: segments=4, rule='mitiguy'>"
    assert repr(Chain.from_pieces(**pieces())) == "<Chain clamped-free: 3 pieces>"


def test_springs_that_are_not_positive_are_refused() -> None:
    # design.md seam 2: where a rule's springs would not be positive, for a Chain an error. w = 1 - 2/N.
    rule = Rule("soft", [Weight(1, -2)], ())
    for segments in (1, 2):
        with pytest.raises(ValueError, match=f"rule soft .* clamped-free with {segments} segments"):
            Chain(BEAM, "clamped-free", segments, rule)
    assert Chain(BEAM, "clamped-free", 3, rule).scaled.joint_stiffness == (3, 1, 1)
    assert Chain(BEAM, "pinned-free", 2, rule).scaled.joint_stiffness == (1,)


@pytest.mark.parametrize("value", BAD_SEGMENTS, ids=shown)
def test_bad_segments(value: Any) -> None:
    kind = ValueError if type(value) is int else TypeError
    with pytest.raises(kind, match=r"^segments must be a whole number of at least 1 and at most ") as info:
        Chain(BEAM, "clamped-free", value)
    assert shown(value) in str(info.value)


@given(
    st.one_of(st.sampled_from(BAD_SEGMENTS), st.integers(max_value=0), st.integers(min_value=MAX_PIECES + 1))
    | st.floats()
    | st.text()
    | st.fractions()
    | st.lists(st.integers())
)
def test_bad_segments_in_quantity(value: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^segments must be ") as info:
        Chain(BEAM, "clamped-free", value)
    assert shown(value) in str(info.value)


@pytest.mark.parametrize("value", [None, 1.2, "beam", (1.0, 1.0, 1.0), Beam])
def test_bad_beam(value: Any) -> None:
    with pytest.raises(TypeError, match=r"^beam must be a Beam, got "):
        Chain(value, "clamped-free", 4)


def test_bad_boundary_and_rule() -> None:
    with pytest.raises(ValueError, match=r'^boundary must .* got .clamped-freee.*"clamped-free"'):
        Chain(BEAM, "clamped-freee", 4)
    with pytest.raises(TypeError, match=r"^boundary must "):
        Chain(BEAM, None, 4)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^rule must be one of .* got 'mitigui'"):
        Chain(BEAM, "clamped-free", 4, "mitigui")
    with pytest.raises(TypeError, match=r"^rule must be one of "):
        Chain(BEAM, "clamped-free", 4, None)  # type: ignore[arg-type]
    for read in (("clamped", "freee"), 7):
        with pytest.raises((TypeError, ValueError), match=r"^boundary must "):
            Chain.from_pieces(**pieces(boundary=read))


@pytest.mark.parametrize("name", [*COLUMNS, "joint_stiffness"])
@pytest.mark.parametrize("container", [list, tuple, np.array], ids=["list", "tuple", "array"])
@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, -1.0])
def test_bad_numbers_in_pieces(name: str, container: Any, number: float) -> None:
    values = [float(v) for v in pieces()[name]]
    values[1] = number
    with pytest.raises(ValueError, match=rf"^{name}(\[1\])? must ") as info:
        Chain.from_pieces(**pieces(**{name: container(values)}))
    assert str(number) in str(info.value)


@pytest.mark.parametrize("name", [*COLUMNS, "joint_stiffness"])
@pytest.mark.parametrize("value", [None, 3.0, "abc", ["a", "b", "c"], [None] * 3, [[1, 2, 3]], [1j] * 3])
def test_bad_types_in_pieces(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=rf"^{name}(\[0\])? must be a (sequence of|real) number"):
        Chain.from_pieces(**pieces(**{name: value}))


@pytest.mark.parametrize("name", [*COLUMNS, "joint_stiffness"])
def test_bad_array_shapes(name: str) -> None:
    for shape in ((1, 3), (3, 1)):
        with pytest.raises(ValueError, match=f"^{name} must be a one-dimensional array of finite numbers"):
            Chain.from_pieces(**pieces(**{name: np.ones(shape)}))
    # An array without axes is a number, as NumPy gives one.
    with pytest.raises(TypeError, match=f"^{name} must be a sequence of numbers, got 1.0"):
        Chain.from_pieces(**pieces(**{name: np.array(1.0)}))


@pytest.mark.parametrize("name", ["mass", "rotary_inertia", "joint_stiffness"])
@pytest.mark.parametrize("change", [-1, 1])
def test_mismatched_lengths(name: str, change: int) -> None:
    values = [float(v) for v in pieces()[name]]
    wrong = values[:-1] if change < 0 else [*values, 1.0]
    with pytest.raises(
        ValueError, match=f"^{name} must have {len(values)} entries for 3 pieces, got {len(wrong)}$"
    ):
        Chain.from_pieces(**pieces(**{name: wrong}))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joint_stiffness": [0, 6.0]}, "^joint_stiffness must be greater than 0"),
        (
            {"length": [1.0, 0, 2.0], "mass": [1.0, 3.0, 4.0]},
            "^length must be greater than 0 for every piece but",
        ),
        (
            {"length": [1.0, 1.0, 2.0], "mass": [1.0, 0, 4.0]},
            "^mass must be greater than 0 for every piece but",
        ),
        ({"length": [1.0, 1.0, 2.0]}, r"^mass\[0\] must be greater than 0 for a piece that has a length"),
        (
            {"mass": [0, 3.0, 0], "rotary_inertia": [0, 0.25, 0]},
            r"^mass\[2\] must be greater than 0 for a piece that has a length",
        ),
    ],
)
def test_impossible_pieces(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Chain.from_pieces(**pieces(**changes))


@pytest.mark.parametrize("count", [1, 2])
def test_a_chain_of_points_is_refused(count: int) -> None:
    zeros = [0.0] * count
    with pytest.raises(ValueError, match=r"^length must "):
        Chain.from_pieces(
            length=zeros,
            mass=zeros,
            rotary_inertia=zeros,
            joint_stiffness=zeros[1:] and [1.0],
            boundary="free-free",
        )


def test_no_pieces_are_refused() -> None:
    with pytest.raises(ValueError, match="pieces"):
        Chain.from_pieces(length=[], mass=[], rotary_inertia=[], joint_stiffness=[], boundary="free-free")


numbers = st.one_of(st.floats(), st.integers(-2, 3), st.sampled_from([None, "six", True, 10**400, 1j, 0.0]))
columns = st.one_of(st.lists(numbers, max_size=4), st.none(), st.text(max_size=3), st.floats())


@given(
    length=columns, mass=columns, rotary_inertia=columns, joint_stiffness=columns, pair=st.sampled_from(PAIRS)
)
def test_any_pieces_make_a_chain_or_one_of_two_exceptions(pair: str, **given_columns: Any) -> None:
    try:
        chain = Chain.from_pieces(**given_columns, boundary=pair)
    except (TypeError, ValueError) as error:
        assert any(name in str(error) for name in (*given_columns, "pieces"))  # noqa: PT017 - others surface
    else:
        assert all(np.isfinite(getattr(chain, name)).all() for name in given_columns)
        assert (chain.joint_stiffness > 0).all()
