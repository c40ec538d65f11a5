"""One end: its words, its text, what holds and what moves, and which rule applies to it."""

from __future__ import annotations

import dataclasses
import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary, End, end_from_text

INF = math.inf
NAMES = ("translational_stiffness", "rotational_stiffness", "mass", "rotary_inertia", "offset")
amount = st.one_of(st.just(0.0), st.floats(min_value=0, allow_nan=False, allow_infinity=False))
stiffness = st.one_of(amount, st.just(INF))
ends = st.builds(End, stiffness, stiffness, amount, amount, st.floats(allow_nan=False, allow_infinity=False))


def test_the_four_words_hold_what_their_names_say() -> None:
    # theory.md section 2: clamped holds both, pinned the deflection, guided the rotation, free neither.
    held = {"clamped": (INF, INF), "pinned": (INF, 0.0), "guided": (0.0, INF), "free": (0.0, 0.0)}
    for word, (deflection, rotation) in held.items():
        assert ENDS[word] == End(deflection, rotation)
        assert (str(ENDS[word]), ENDS[word].word, ENDS[word].statics) == (word, word, word)
        assert ENDS[word].is_grounded == (word != "free")


@pytest.mark.parametrize(
    ("text", "end"),
    [
        ("free(mass=0.5)", End(mass=0.5)),
        (" Free ( MASS = 0.5 , Offset = -1e-3 ) ", End(mass=0.5, offset=-1e-3)),
        ("free()", End()),
        ("cantilever", ENDS["clamped"]),
        ("hinged(rotational_stiffness=2)", End(INF, 2.0)),
        ("sliding(translational_stiffness=3, mass=4)", End(3.0, INF, 4.0)),
        ("free(translational_stiffness=inf)", ENDS["pinned"]),
        ("pinned(rotary_inertia=1e+300)", End(INF, 0.0, 0.0, 1e300)),
    ],
)
def test_ends_from_text(text: str, end: End) -> None:
    assert end_from_text(text) == end


@pytest.mark.parametrize(
    "text", ["", "fre", "free(mass=1", "free)mass=1(", "free((mass=1))", "free(mass=1)x"]
)
def test_unknown_words_are_no_ends(text: str) -> None:
    assert end_from_text(text) is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "free(mas=1)",
            r'number of an end must be .*hub_radius, on_segment, got \'mas\' \(did you mean "mass"\?\)',
        ),
        ("free(mass)", "mass must be a number, got ''"),
        ("free(mass=heavy)", "mass must be a number, got 'heavy'"),
        ("free(mass=nan)", "mass must be finite, got nan"),
        ("free(mass=inf)", "mass must be finite, got inf"),
        ("free(rotary_inertia=-2)", r"rotary_inertia must not be negative, got -2\.0"),
        ("clamped(rotational_stiffness=1)", "rotational_stiffness of a clamped end must be left out, got"),
        ("pinned(translational_stiffness=0)", "translational_stiffness of a pinned end must be left out"),
        ("free(mass=1,)", "number of an end must be one of translational_stiffness, .* got ''"),
    ],
)
def test_numbers_that_cannot_be_read(text: str, message: str) -> None:
    for read in (end_from_text, lambda name: Boundary.of(f"clamped-{name}")):
        with pytest.raises(ValueError, match=message):
            read(text)


def test_a_number_given_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="mass"):
        end_from_text("free(mass=1, mass=2)")


@given(ends, ends)
@settings(max_examples=100)
def test_names_are_read_back(left: End, right: End) -> None:
    pair = Boundary(left, right)
    for separator in ("-", "/", " , "):
        assert Boundary.of(f"{left}{separator}{right}") == pair
    assert Boundary.of(pair.name) == pair
    assert end_from_text(str(left)) == left


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [True, "1", None, 1j, [1.0], b"1"])
def test_what_is_no_number(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=rf"^{name} must be a real number, got "):
        End(**{name: value})


@pytest.mark.parametrize("name", NAMES)
def test_numbers_out_of_range(name: str) -> None:
    for value in (math.nan, -INF, 10**400, *([] if "stiffness" in name else [INF])):
        with pytest.raises(ValueError, match=rf"^{name} must be finite, got "):
            End(**{name: value})
    if name == "offset":
        assert End(offset=-2).offset == -2.0
        return
    for value in (-1, -5e-324, Fraction(-1, 3)):
        with pytest.raises(ValueError, match=rf"^{name} must not be negative, got "):
            End(**{name: value})


@pytest.mark.parametrize("value", [np.array([INF]), np.array([1.0, INF])])
def test_arrays_are_no_stiffness(value: Any) -> None:
    with pytest.raises(TypeError, match=r"^translational_stiffness must be a real number"):
        End(value)


def test_numbers_are_kept_as_floats_but_fractions_exactly() -> None:
    end = End(np.float32(0.5), 3, Fraction(1, 3), -0.0, -0.0)
    kept = [getattr(end, name) for name in NAMES]
    assert kept == [0.5, 3.0, Fraction(1, 3), 0.0, 0.0]
    assert [type(value) for value in kept] == [float, float, Fraction, float, float]
    assert str(End(offset=-0.0, mass=2)) == "free(mass=2.0)"
    with pytest.raises(dataclasses.FrozenInstanceError):
        end.mass = 1.0  # type: ignore[misc]


# By hand from the definitions. design.md seam 2: no moment (no rotational spring or inertia) pinned or free;
# rotation held and no shear (no translational spring or mass) guided; else clamped. A body moves as far as
# the supports let it: not at all when clamped, sideways when guided, about the hinge when pinned.
HAND = [
    # end, word, statics, moving body, grounded
    (End(offset=3.0), "free", "free", (0, 0, 0), False),
    (End(mass=2.0), None, "free", (2, 0, 0), False),
    (End(rotary_inertia=2.0, offset=1.0), None, "clamped", (0, 2, 0), False),
    (End(mass=2.0, offset=-1.0), None, "clamped", (2, 0, -1), False),
    (End(5.0), None, "free", (0, 0, 0), True),
    (End(5.0, mass=2.0), None, "free", (2, 0, 0), True),
    (End(0.0, 5.0), None, "clamped", (0, 0, 0), True),
    (End(INF, 0.0, mass=2.0), "pinned", "pinned", (0, 0, 0), True),
    (End(INF, 0.0, 2.0, 3.0), None, "clamped", (0, 3, 0), True),
    (End(INF, 0.0, 2.0, 0.0, 1.0), None, "clamped", (2, 0, 1), True),
    (End(INF, 5.0, mass=2.0), None, "clamped", (0, 0, 0), True),
    (End(0.0, INF, 0.0, 3.0, 1.0), "guided", "guided", (0, 0, 0), True),
    (End(0.0, INF, 2.0, 3.0, 1.0), None, "clamped", (2, 0, 0), True),
    (End(5.0, INF), None, "clamped", (0, 0, 0), True),
    (End(INF, INF, 2.0, 3.0, 1.0), "clamped", "clamped", (0, 0, 0), True),
]


@pytest.mark.parametrize(("end", "word", "statics", "body", "grounded"), HAND)
def test_what_an_end_is(end: End, word: str | None, statics: str, body: tuple, grounded: bool) -> None:
    assert (end.word, end.statics, end.moving_body, end.is_grounded) == (word, statics, body, grounded)
    assert Boundary(ENDS["free"], end).is_plain == (word is not None)


def stiffest_first(pair: Boundary) -> bool:
    """design.md seam 5: the firmer end first, clamped, pinned, guided, free: by deflection, then rotation."""
    left, right = pair.left, pair.right
    return (left.translational_stiffness, left.rotational_stiffness) >= (
        right.translational_stiffness,
        right.rotational_stiffness,
    )


@given(ends, ends)
@settings(max_examples=50)
def test_canonical_order(left: End, right: End) -> None:
    pair = Boundary(left, right)
    assert pair.canonical in (pair, pair.turned)
    assert stiffest_first(pair.canonical)
    assert pair.turned.canonical == pair.canonical
    assert pair.canonical.canonical == pair.canonical


def test_plain_pairs_keep_their_canonical_order() -> None:
    assert all(pair.canonical == pair == pair.turned.canonical for pair in BOUNDARIES)
    # A body does not make an end firmer: of two free ends the lighter stands first.
    assert Boundary.of(("free(mass=1)", "free")).canonical.name == "free-free(mass=1.0)"


@pytest.mark.parametrize("supports", list(itertools.product([0.0, 2.0, INF], repeat=4)))
def test_rigid_body_modes_are_the_null_space_of_the_supports(supports: tuple[float, ...]) -> None:
    # Straight lines a + b x with no deflection (1, x) and no rotation (0, 1) where something supports them.
    rows = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 1.0]]
    felt = np.array([row for row, k in zip(rows, supports, strict=True) if k]).reshape(-1, 2)
    pair = Boundary(End(*supports[:2]), End(*supports[2:], 1.0, 1.0))
    # NumPy before 2.1 knows no rank of nothing.
    assert pair.rigid_body_modes == 2 - (np.linalg.matrix_rank(felt) if len(felt) else 0)


def test_a_body_on_the_last_segment_is_said_and_read_and_checked() -> None:
    end = End(mass=0.5, rotary_inertia=0.01, on_segment=True)
    assert end.statics == "carried" and End(mass=0.5, rotary_inertia=0.01).statics == "clamped"
    assert str(end) == "free(mass=0.5, rotary_inertia=0.01, on_segment=true)"
    assert end_from_text(str(end)) == end
    assert end_from_text("free(mass=0.5, rotary_inertia=0.01, on_segment=false)") == End(0, 0, 0.5, 0.01)
    # A point mass and a plain end have nothing that turns: the word is theirs.
    assert End(mass=0.5, on_segment=True).statics == "free" and End(on_segment=True).word == "free"
    assert End(rotational_stiffness=3.0, on_segment=True).statics == "carried"
    with pytest.raises(ValueError, match=r"^on_segment must be False where the end holds the rotation"):
        End(math.inf, math.inf, on_segment=True)
    with pytest.raises(TypeError, match=r"^on_segment must be True or False, got 1"):
        End(mass=0.5, on_segment=1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^on_segment must be one of true, false, got \"?'?yes"):
        end_from_text("free(mass=0.5, on_segment=yes)")
