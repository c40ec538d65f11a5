"""The beam: three positive numbers, frozen, and the frequency unit they set."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beammodes.beam import Beam
from beammodes.checks import shown

FIELDS = ("length", "bending_stiffness", "mass_per_length")
BAD_TYPES = [None, True, "1.2", "six", 1j, [1.2], (1.2,), np.array(1.2), b"1", object()]
BAD_VALUES = [math.nan, math.inf, -math.inf, 0, 0.0, -0.0, -1, -2.5, 10**400, -(10**400), Fraction(-1, 3)]
bad = st.one_of(
    st.text(), st.none(), st.booleans(), st.complex_numbers(), st.floats(max_value=0.0),
    st.integers(max_value=0), st.lists(st.floats()), st.sampled_from(BAD_TYPES), st.sampled_from(BAD_VALUES),
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
