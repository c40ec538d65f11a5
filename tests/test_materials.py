"""The report's elastic moduli: its lines as scanned, their units, ranges that must be resolved."""

from __future__ import annotations

import dataclasses
import math
import re
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beammodes.checks import shown
from beammodes.problem.materials import MODULI, PASCALS, Modulus, elastic_modulus

# The seven lines of the scanned report, letter by letter.
SCAN = """\
Wood 1-2 million Ibffin2
Concrete 3 million Ibf/in2
Marble 8 million Ibffin2
Aluminum 10 million Tbf/in2
Brass 15 million Ibf/in?
Cast Tron 10-20 million Ibf/in2
Steel 30 million 1bf/in2
"""
RANGES = ["wood", "cast iron"]
SINGLE = [name for name in MODULI if name not in RANGES]


@pytest.mark.parametrize(("scan", "line"), [*zip(SCAN.splitlines(), MODULI.values(), strict=True)], ids=str)
def test_names_and_numbers_are_those_of_the_scan(scan: str, line: Modulus) -> None:
    name, low, high, unit = re.fullmatch(r"(.*?) (\d+)(?:-(\d+))? million (\S+)", scan).groups()  # type: ignore[union-attr]
    assert (line.low, line.high) == (int(low), int(high or low))
    assert name.replace("Tron", "Iron").lower() == line.material
    # One unit throughout, whatever the scanner made of its letters.
    assert re.fullmatch(r"[I1T]bf[/f]in[2?]", unit)


def test_ranges_stay_ranges() -> None:
    assert [name for name, line in MODULI.items() if line.is_range] == RANGES
    assert [field.name for field in dataclasses.fields(Modulus)] == ["material", "low", "high"]


def test_a_pound_force_per_square_inch() -> None:
    assert float(PASCALS) == pytest.approx(6894.757293168, rel=1e-13)
    # The other way round: an inch is 25.4 mm, a pound-force 4.4482216152605 N.
    assert Fraction("4.4482216152605") / Fraction("0.00064516") == PASCALS


@pytest.mark.parametrize("name", SINGLE)
def test_both_units_are_one_number(name: str) -> None:
    psi = elastic_modulus(name, unit="lbf/in2")
    assert psi == MODULI[name].low * 1e6
    assert elastic_modulus(name) == pytest.approx(psi * 6894.757293168, rel=1e-13)
    assert MODULI[name].pascals == (elastic_modulus(name),) * 2


# Ordinary values of handbooks [GPa]; the report's, rounded to millions of lbf/in², lie within their spread.
@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("concrete", 17, 30), ("marble", 50, 70), ("aluminum", 68, 73), ("brass", 97, 110), ("steel", 190, 210)],
)
def test_orders_of_magnitude(name: str, least: float, most: float) -> None:
    assert least <= elastic_modulus(name) / 1e9 <= most


def test_a_range_is_resolved_by_saying_where() -> None:
    wood = MODULI["wood"]
    assert (elastic_modulus("wood", at=0), elastic_modulus("wood", at=1)) == wood.pascals
    assert elastic_modulus("cast iron", unit="lbf/in2", at=0.25) == 12.5e6


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("wood", "wood, 1 to 2 million lbf/in2 (6.89 to 13.8 GPa)"),
        ("Cast Iron", "cast iron, 10 to 20 million lbf/in2 (68.9 to 138 GPa)"),
    ],
)
def test_a_range_where_a_number_is_needed_is_named(name: str, told: str) -> None:
    with pytest.raises(
        ValueError, match=re.escape(f"at must be given, from 0 to 1, for the range of {told}")
    ):
        elastic_modulus(name)
    with pytest.raises(ValueError, match=re.escape(f"within the range of {told}, got 1.5")):
        elastic_modulus(name, at=1.5)
    with pytest.raises(TypeError):
        float(MODULI[name.lower()])  # type: ignore[arg-type]


def test_a_number_takes_no_place_in_a_range() -> None:
    with pytest.raises(ValueError, match=re.escape("left out for the one number of steel, 30 million")):
        elastic_modulus("steel", at=0.5)


@pytest.mark.parametrize("name", ["Steel", " STEEL ", "cast_iron", "Cast  Iron", "aluminium", "Aluminum"])
def test_spellings(name: str) -> None:
    line = MODULI["cast iron" if "iron" in name.lower() else "steel" if "ee" in name.lower() else "aluminum"]
    assert elastic_modulus(name, at=0.0 if line.is_range else None) == line.pascals[0]


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (
            lambda: elastic_modulus("stele"),
            ValueError,
            r"material must be .*steel, got 'stele' \(did .*\"steel",
        ),
        (lambda: elastic_modulus("Bras"), ValueError, 'mean "brass"'),
        (lambda: elastic_modulus("alluminium"), ValueError, 'mean "aluminum"'),
        (lambda: elastic_modulus("unobtainium"), ValueError, "material must be one of wood, concrete"),
        (lambda: elastic_modulus("steel", unit="psi"), ValueError, "unit must be one of Pa, lbf/in2"),
        (lambda: elastic_modulus("wood", at=math.nan), ValueError, "at must be finite"),
        (lambda: elastic_modulus("wood", at=True), TypeError, "at must be a real number"),
    ],
)
def test_bad_input(call: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


@given(name=st.one_of(st.none(), st.integers(), st.lists(st.text()), st.text().filter(lambda t: len(t) < 3)))
def test_what_is_no_material_is_named(name: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^material must be one of wood, ") as info:
        elastic_modulus(name)
    assert shown(name) in str(info.value)
