"""The beam: its length and properties, frozen, and the frequency unit they set."""

from __future__ import annotations

import dataclasses
import math
import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beammodes.checks import shown
from beammodes.problem.beam import Beam
from beammodes.problem.profiles import Table

FIELDS = ("length", "bending_stiffness", "mass_per_length")
BAD_TYPES = [None, True, "1.2", "six", 1j, [1.2], (1.2,), np.array("1.2"), b"1", object()]
BAD_VALUES = [math.nan, math.inf, -math.inf, 0, 0.0, -0.0, -1, -2.5, 10**400, -(10**400), Fraction(-1, 3)]
bad = st.one_of(
    st.text(), st.none(), st.booleans(), st.complex_numbers(), st.floats(max_value=0.0),
    st.integers(max_value=0), st.lists(st.floats(max_value=0.0)),
    st.sampled_from(BAD_TYPES), st.sampled_from(BAD_VALUES),
)  # fmt: skip


def made_with(field: str, value: Any) -> Beam:
    return Beam(**{name: value if name == field else 1.0 for name in FIELDS})


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("value", BAD_TYPES, ids=lambda value: type(value).__name__)
def test_wrong_types(field: str, value: object) -> None:
    with pytest.raises(TypeError, match=f"^{field} must be a real number, got "):
        made_with(field, value)


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("value", BAD_VALUES, ids=shown)
def test_wrong_values(field: str, value: object) -> None:
    with pytest.raises(ValueError, match=f"^{field} must be (finite|greater than 0), got ") as info:
        made_with(field, value)
    assert str(info.value).endswith(shown(value))


@given(field=st.sampled_from(FIELDS), value=bad)
@example(field="length", value=10**5000)
def test_bad_input_gives_one_of_two_exceptions_that_name_it(field: str, value: object) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{field} must be ") as info:
        made_with(field, value)
    assert shown(value) in str(info.value)


@pytest.mark.parametrize("value", [2, 2.0, Fraction(2), np.float32(2.0), np.int64(2)])
def test_fields_are_floats(value: Any) -> None:
    beam = Beam(value, value, value)
    assert [type(getattr(beam, name)) for name in FIELDS] == [float] * 3
    assert beam == Beam(2.0, 2.0, 2.0)
    assert hash(beam) == hash(Beam(2.0, 2.0, 2.0))


@pytest.mark.parametrize("field", FIELDS)
def test_frozen(field: str) -> None:
    beam = Beam.unit()
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(beam, field, 2.0)
    assert beam == Beam(1.0, 1.0, 1.0)


def test_unit_beam() -> None:
    beam = Beam.unit()
    assert (beam.length, beam.bending_stiffness, beam.mass_per_length) == (1.0, 1.0, 1.0)
    assert beam.frequency_unit == 1.0


def test_frequency_unit() -> None:
    # By hand: √(EI/(ρA L⁴)) with EI = 32, ρA = 2, L = 0.5 is √(16 · 16) = 16.
    assert Beam(0.5, 32.0, 2.0).frequency_unit == 16.0


def test_frequency_unit_gives_the_textbook_cantilever() -> None:
    # Steel strip 1 m long and 2 mm thick, E = 200 GPa, ρ = 7800 kg/m³. The first root of
    # cos x cosh x = -1 is 1.87510, its square 3.51602; √(EI/ρA) = thickness √(E/(12 ρ)) = 2.92353: 1.6360 Hz.
    width, thickness, modulus, density = 0.02, 0.002, 200e9, 7800.0
    beam = Beam(1.0, modulus * width * thickness**3 / 12, density * width * thickness)
    assert 3.51602 * beam.frequency_unit / (2 * math.pi) == pytest.approx(1.6360, abs=5e-5)


positive = st.floats(1e-6, 1e6)


@given(length=positive, stiffness=positive, mass=positive, factor=st.sampled_from([2.0, 4.0, 0.5]))
def test_frequency_unit_scales(length: float, stiffness: float, mass: float, factor: float) -> None:
    unit = Beam(length, stiffness, mass).frequency_unit
    assert Beam(factor * length, stiffness, mass).frequency_unit == pytest.approx(unit / factor**2, rel=1e-14)
    assert Beam(length, factor * stiffness, mass).frequency_unit == pytest.approx(
        unit * factor**0.5, rel=1e-14
    )
    assert Beam(length, stiffness, factor * mass).frequency_unit == pytest.approx(
        unit / factor**0.5, rel=1e-14
    )


# --- Properties that vary --------------------------------------------------------------------------------

PROPERTIES = ("bending_stiffness", "mass_per_length", "rotary_inertia_per_length")


def varied(field: str, value: Any, length: float = 2.0) -> Beam:
    return Beam(length, **{"bending_stiffness": 1.0, "mass_per_length": 1.0, field: value})


@pytest.mark.parametrize("field", PROPERTIES)
@pytest.mark.parametrize("row", [[3, 2, 1], (3.0, 2.0, 1.0), np.array([3, 2, 1]), [Fraction(3), 2, 1.0]])
def test_sequences_are_kept_as_tables(field: str, row: Any) -> None:
    beam = varied(field, row, length=1.5)
    steps = Table((0.0, 0.5, 0.5, 1.0, 1.0, 1.5), (3.0, 3.0, 2.0, 2.0, 1.0, 1.0))
    assert getattr(beam, field) == steps
    assert beam == varied(field, steps, length=1.5) and hash(beam) == hash(varied(field, steps, length=1.5))
    assert not beam.is_uniform and beam.breaks == (0.5, 1.0)


@pytest.mark.parametrize("field", PROPERTIES)
def test_what_is_constant_is_kept_as_a_number(field: str) -> None:
    number = varied(field, 4.0)
    assert varied(field, [4, 4, 4]) == varied(field, Table((0.0, 2.0), (4.0, 4.0))) == number
    assert number.is_uniform and number.breaks == ()


def test_means_are_the_number_itself_or_the_integral() -> None:
    third = Beam(0.3, 0.1, 0.7)
    assert (third.mean_bending_stiffness, third.mean_mass_per_length) == (0.1, 0.7)
    # By hand: the mean of [3, 2, 1] is 2; that of e^(-x) over 0..2 is (1 - e^-2)/2.
    beam = Beam(2.0, [3.0, 2.0, 1.0], lambda x: math.exp(-x))
    assert beam.mean_bending_stiffness == pytest.approx(2.0, rel=1e-15)
    assert beam.mean_mass_per_length == pytest.approx((1.0 - math.exp(-2.0)) / 2.0, rel=1e-15)
    assert beam.frequency_unit == pytest.approx(math.sqrt(2.0 / beam.mean_mass_per_length) / 4.0, rel=1e-15)


def test_breaks_are_where_any_property_has_a_step_or_a_marked_kink() -> None:
    # Thirds and sixths meet but for rounding; equal neighbours make no break, nor does a kink at 0.2.
    kink = Table((0.0, 0.2, 0.4, 0.4, 1.1), (1.0, 2.0, 3.0, 3.0, 3.0))
    beam = Beam(1.1, [3, 2, 1], [6, 6, 5, 4, 4, 4], kink)
    assert np.allclose(beam.breaks, (1.1 / 3, 0.4, 1.1 / 2, 2.2 / 3), rtol=1e-15, atol=0.0)


def test_given_breaks_are_kept_with_what_varies() -> None:
    table = Table((0.0, 0.2, 0.4, 1.1), (1.0, 2.0, 3.0, 3.0))
    beam = Beam(1.1, table, lambda x: 2.0 - x, 0.1, breaks=[0.9, 0.4, 0.4])
    assert beam.breaks == (0.4, 0.9)
    assert beam.bending_stiffness.x.count(0.4) == 2
    changed = dataclasses.replace(beam, rotary_inertia_per_length=0.2)
    assert changed.breaks == beam.breaks and changed != beam
    assert dataclasses.replace(changed, rotary_inertia_per_length=0.1) == beam
    assert Beam(1.1, 1.0, 1.0, breaks=[0.4]) == Beam(1.1, 1.0, 1.0)  # nothing varies


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (0.5, r"must be a sequence of positions, got 0\.5"),
        ("0.5", r"must be a sequence of values, got '0\.5'"),
        (None, r"must be a sequence of positions, got None"),
        ([0.5, "0.7"], r"must be a real number, got '0\.7'"),
        ([0.5, math.nan], r"must be finite, got nan"),
        ([0.0], r"must be positions inside the beam, between 0 and its length 1\.1, got 0\.0"),
        ([0.2, 1.1], r"must be positions inside the beam, between 0 and its length 1\.1, got 1\.1"),
        ([-0.2], r"must be positions inside the beam, .* got -0\.2"),
        (np.ones((2, 2)), r"must be a sequence of positions, got array"),
    ],
)  # fmt: skip
def test_wrong_breaks(given: Any, told: str) -> None:
    with pytest.raises((TypeError, ValueError), match=rf"^breaks {told}"):
        Beam(1.1, lambda x: 1.0 + x, 1.0, breaks=given)


def test_a_table_that_ends_a_rounding_off_the_beam_is_moved_to_its_end() -> None:
    table = Beam(1.2, Table((0.0, 3 * 0.4), (1.0, 2.0)), 1.0).bending_stiffness
    assert table == Table((0.0, 1.2), (1.0, 2.0)) and 3 * 0.4 != 1.2


@pytest.mark.parametrize("field", PROPERTIES)
@pytest.mark.parametrize(
    ("given", "told"),
    [
        ([1.0, -2.0, 3.0], r"got -2\.0 on part 2 of 3"),
        ([1.0, math.nan], r"must be finite, got nan"),
        ([1.0, "2"], r"must be a real number, got '2'"),
        (np.ones((2, 2)), r"must be a real number, got array"),
        (Table((0.0, 1.0), (1.0, 2.0)), r"tabulated from 0 to the beam's length 2\.0, got .* 1\.0"),
        (Table((0.0, 2.0), (1.0, -1.0)), r"got -1\.0 at x = 2\.0"),
        (lambda x: 1.0 - x, r"got -0\.[0-9]+ at x = 1\.[0-9]+$"),
        (lambda x: x * math.nan, r"at x = 0\.0 must be finite, got nan"),
        (lambda _: "stiff", r"at x = 0\.0 must be a real number, got 'stiff'"),
        (lambda x: 2.0 + float(np.size(x) > 1), r"one value at each position, got 3\.0 for an array"),
    ],
)  # fmt: skip
def test_wrong_properties_are_refused_with_place_and_value(field: str, given: Any, told: str) -> None:
    with pytest.raises((TypeError, ValueError), match=rf"^{field} .*{told}"):
        varied(field, given)


@pytest.mark.parametrize("given", [[2.0, 0.0], Table((0.0, 2.0), (1.0, 0.0)), lambda x: 1.0 - 0.5 * x])
def test_a_taper_to_nothing_is_refused_except_of_rotary_inertia(given: Any) -> None:
    for field in PROPERTIES[:2]:
        with pytest.raises(
            ValueError, match=rf"^{field} must be greater than 0, got 0\.0 .* taper to nothing"
        ):
            varied(field, given)
    assert not varied(PROPERTIES[2], given).is_uniform


@given(
    field=st.sampled_from(PROPERTIES),
    good=st.lists(st.floats(0.1, 10.0), min_size=1, max_size=4),
    spoilt=st.one_of(st.floats(max_value=-1e-300), st.just(math.nan), st.text(), st.none(), st.booleans()),
    place=st.integers(0, 4),
)
def test_one_bad_number_spoils_a_sequence(field: str, good: list[Any], spoilt: object, place: int) -> None:
    row = [*good[:place], spoilt, *good[place:]]
    with pytest.raises((TypeError, ValueError), match=f"^{field} must ") as info:
        varied(field, row)
    assert shown(row) in str(info.value)


def test_a_beam_that_varies_is_a_value() -> None:
    beam = Beam(1.0, [2, 1], 1.0, 0.1)
    assert dataclasses.replace(beam, length=1.0) == pickle.loads(pickle.dumps(beam)) == beam
    assert dataclasses.replace(beam, mass_per_length=lambda x: 1.0 + x) != beam


def test_rotary_inertia_may_be_zero_and_not_negative() -> None:
    assert Beam(1.0, 1.0, 1.0, -0.0) == Beam.unit() and Beam.unit().rotary_inertia_per_length == 0.0
    with pytest.raises(ValueError, match=r"^rotary_inertia_per_length must not be negative, got -1"):
        Beam(1.0, 1.0, 1.0, -1)
