"""Ends and pairs of ends: names in every form, rigid-body counts, codes, near-match errors."""

from __future__ import annotations

import dataclasses
import itertools
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary, End, boundary_codes

# theory.md section 2: ten unordered pairs; design.md seam 5: the firmer end first, in the order
# clamped, pinned, guided, free.
TEN = [
    "clamped-clamped",
    "clamped-pinned",
    "clamped-guided",
    "clamped-free",
    "pinned-pinned",
    "pinned-guided",
    "pinned-free",
    "guided-guided",
    "guided-free",
    "free-free",
]
# theory.md section 2: free-free 2; free-pinned, free-guided, guided-guided 1; the others 0.
RIGID = {"free-free": 2, "pinned-free": 1, "guided-free": 1, "guided-guided": 1}
# theory.md section 2: what each word holds; the report's cantilever is clamped.
HELD = {"clamped": (True, True), "pinned": (True, False), "guided": (False, True), "free": (False, False)}
SIXTEEN = [f"{a}-{b}" for a, b in itertools.product(HELD, HELD)]
ALIASES = {"cantilever": "clamped", "fixed": "clamped", "hinged": "pinned", "sliding": "guided"}


def swapped(name: str) -> str:
    return "-".join(reversed(name.split("-")))


def test_the_four_ends() -> None:
    assert {name: (end.holds_deflection, end.holds_rotation) for name, end in ENDS.items()} == HELD
    assert [str(end) for end in ENDS.values()] == list(HELD)


def test_the_ten_pairs_in_order() -> None:
    assert [pair.name for pair in BOUNDARIES] == TEN
    assert [str(pair) for pair in BOUNDARIES] == TEN


@pytest.mark.parametrize("name", SIXTEEN)
def test_every_form_of_a_pair_is_the_same_boundary(name: str) -> None:
    left, right = name.split("-")
    expected = Boundary(ENDS[left], ENDS[right])
    forms: list[Any] = [
        name,
        f"{left}/{right}",
        f" {left.upper()} , {right.title()}\n",
        (left, right),
        [left, right],
        (ENDS[left], ENDS[right]),
        (ENDS[left], right),
        np.str_(name),
        expected,
    ]
    for form in forms:
        assert Boundary.of(form) == expected
    assert expected.name == name
    assert repr(expected) == f"Boundary('{name}')"
    assert hash(Boundary.of(name)) == hash(expected)


@pytest.mark.parametrize("name", SIXTEEN)
def test_canonical_order(name: str) -> None:
    boundary = Boundary.of(name)
    assert boundary.canonical.name == (name if name in TEN else swapped(name))
    assert boundary.canonical == Boundary.of(swapped(name)).canonical
    assert (boundary == Boundary.of(swapped(name))) == (boundary.left == boundary.right)


@pytest.mark.parametrize(("alias", "word"), ALIASES.items())
def test_aliases(alias: str, word: str) -> None:
    assert Boundary.of(f"{alias}/free").name == f"{word}-free"
    assert Boundary.of(f"free-{alias.title()}").name == f"free-{word}"
    assert Boundary.of((alias, alias)).name == f"{word}-{word}"
    assert boundary_codes(f"{alias}-free") == TEN.index(f"{word}-free")


@pytest.mark.parametrize("name", SIXTEEN)
def test_rigid_body_modes(name: str) -> None:
    boundary = Boundary.of(name)
    assert boundary.rigid_body_modes == RIGID.get(name, RIGID.get(swapped(name), 0))
    # Again from the definition: straight lines a + b x that meet every held quantity.
    conditions = []
    for end, x in ((boundary.left, 0.0), (boundary.right, 1.0)):
        conditions += [[1.0, x]] * end.holds_deflection + [[0.0, 1.0]] * end.holds_rotation
    rank = np.linalg.matrix_rank(np.array(conditions)) if conditions else 0
    assert boundary.rigid_body_modes == 2 - rank


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("clamped-freee", "clamped-free"),
        ("clampd/free", "clamped-free"),
        ("free-clampedd", "free-clamped"),
        ("pined-pinned", "pinned-pinned"),
        ("Guided-Fre", "guided-free"),
        (("pined", "free"), "pinned-free"),
        ("clampedfree", "clamped-free"),
        ("cantilever", "clamped-free"),
        ("clamped", "clamped-free"),
        ("Simply supported", "pinned-pinned"),
    ],
)
def test_near_matches_are_offered(typed: Any, meant: str) -> None:
    for read in (Boundary.of, boundary_codes) if isinstance(typed, str) else (Boundary.of,):
        with pytest.raises(ValueError, match=r"^boundary must name two of the ends clamped, ") as info:
            read(typed)
        assert repr(typed) in str(info.value)
        assert f'did you mean "{meant}"?' in str(info.value)


@pytest.mark.parametrize("typed", ["", "-", "free", "clamped-free-free", "xyzzy", "clamped--free", "qq-zz"])
def test_unreadable_names(typed: str) -> None:
    with pytest.raises(
        ValueError, match=r"^boundary must name two of the ends clamped, pinned, guided, free"
    ):
        Boundary.of(typed)


@pytest.mark.parametrize(
    "value",
    [None, 3, 2.5, True, b"clamped-free", object(), ("free",), ("free",) * 3, {"a", "b"}, ENDS["free"]],
)
def test_what_is_no_boundary(value: Any) -> None:
    with pytest.raises(TypeError, match=r'^boundary must be a name such as "clamped-free", a pair'):
        Boundary.of(value)


@pytest.mark.parametrize("part", [None, 3, b"free", ["free"]])
def test_what_is_no_end(part: Any) -> None:
    with pytest.raises(
        TypeError, match=r"^each end of boundary must be one of clamped, pinned, guided, free, got "
    ):
        Boundary.of(("clamped", part))


def test_constructor_takes_ends_only() -> None:
    with pytest.raises(TypeError, match=r"^left must be an End, got 'clamped'"):
        Boundary("clamped", ENDS["free"])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^right must be an End, got None"):
        Boundary(ENDS["free"], None)  # type: ignore[arg-type]


words = st.one_of(st.text(), st.sampled_from([*HELD, *ALIASES, "fre", "Pinned", " "]))


@given(st.one_of(words, st.none(), st.integers(), st.floats(), st.tuples(words, words), st.lists(words)))
def test_anything_is_a_boundary_or_one_of_two_exceptions(value: Any) -> None:
    known = [*HELD, *ALIASES]
    parts = re.split("[-/,]", value) if isinstance(value, str) else value
    if isinstance(parts, tuple | list) and len(parts) == 2:
        words_read = [part.strip().lower() for part in parts]
        if all(word in known for word in words_read):
            assert Boundary.of(value).name == "-".join(ALIASES.get(word, word) for word in words_read)
            return
    with pytest.raises((TypeError, ValueError), match=r"^boundary must "):
        Boundary.of(value)


@pytest.mark.parametrize("field", ["left", "right"])
def test_frozen(field: str) -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(Boundary.of("clamped-free"), field, ENDS["free"])
    with pytest.raises(dataclasses.FrozenInstanceError):
        ENDS["free"].holds_rotation = True  # type: ignore[misc]


def test_an_end_without_support_is_free() -> None:
    assert Boundary.of((End(), "free")) == Boundary.of("free-free")


@pytest.mark.parametrize("name", SIXTEEN)
def test_code_of_one_boundary(name: str) -> None:
    code = TEN.index(name if name in TEN else swapped(name))
    for value in (name, Boundary.of(name), np.array(name)):
        codes = boundary_codes(value)
        assert codes.shape == ()
        assert codes.dtype == np.intp
        assert codes == code
    assert BOUNDARIES[code] == Boundary.of(name).canonical


@pytest.mark.parametrize(
    "value",
    [
        [["clamped-free", "free/cantilever", "pinned-pinned"], ["free-free", "Hinged-Hinged", "free-pinned"]],
        np.array(
            [["clamped-free", "free-clamped", "pinned-pinned"], ["free-free", "pinned,pinned", "free-pinned"]]
        ),
        [
            [Boundary.of("clamped-free"), "free-clamped", Boundary.of("pinned-pinned")],
            ["free-free", Boundary.of(("pinned", "pinned")), "pinned-free"],
        ],
    ],
    ids=["list", "ndarray", "mixed"],
)
def test_codes_keep_the_shape(value: Any) -> None:
    expected = [[3, 3, 4], [9, 4, 6]]  # positions in TEN
    for given_value in (value, np.array(value, dtype=object), tuple(map(tuple, value))):
        codes = boundary_codes(given_value)
        assert codes.dtype == np.intp
        assert codes.tolist() == expected


def test_codes_of_all_pairs_at_once() -> None:
    assert boundary_codes(BOUNDARIES).tolist() == list(range(10))
    assert boundary_codes(np.array(TEN)).tolist() == list(range(10))
    assert boundary_codes([]).shape == (0,)


def test_a_tuple_is_one_pair_of_ends_or_several_boundaries() -> None:
    assert boundary_codes(("clamped-free", "free-free")).tolist() == [3, 9]
    # Words of single ends cannot be boundaries: two of them are one pair.
    assert boundary_codes(("clamped", "free")).tolist() == 3
    assert boundary_codes([("clamped", "free"), "free-free"]).tolist() == [3, 9]


@pytest.mark.parametrize("value", [None, 3, [1, 2], np.array([1.0]), [None], b"clamped-free", [ENDS["free"]]])
def test_codes_of_wrong_types(value: Any) -> None:
    with pytest.raises(TypeError, match=r"^boundary must be a name"):
        boundary_codes(value)


def test_codes_of_a_wrong_name_in_an_array() -> None:
    for value in (["free-free", "clamped-freee"], np.array(["free-free", "clamped-freee"])):
        with pytest.raises(ValueError, match=r"got 'clamped-freee'.*clamped-free"):
            boundary_codes(value)
