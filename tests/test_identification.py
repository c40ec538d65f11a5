"""Bending stiffness from a measurement: back from the exact beam's own frequencies and deflections."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beammodes.accuracy.identification import stiffness_from_deflection, stiffness_from_frequency
from beammodes.accuracy.statics import beam_statics
from beammodes.checks import shown
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES
from beammodes.problem.sections import Rectangle

SPAN: dict[str, Any] = {"length": 1.2, "mass_per_length": 0.62}
NAMES = [pair.name for pair in BOUNDARIES]
FIRM = [pair.name for pair in BOUNDARIES if not pair.rigid_body_modes]


def measured(stiffness: float, boundary: str, mode: int, rotary: float = 0.0) -> float:
    beam = Beam(SPAN["length"], stiffness, SPAN["mass_per_length"], rotary)
    return float(euler_bernoulli(beam, boundary, mode).frequency[-1])


@pytest.mark.parametrize("boundary", NAMES)
@pytest.mark.parametrize("mode", [1, 2, 30])
def test_round_trip_between_plain_ends(boundary: str, mode: int) -> None:
    found = stiffness_from_frequency(measured(85.0, boundary, mode), boundary, mode=mode, **SPAN)
    assert found == pytest.approx(85.0, rel=1e-13)


def test_closed_form() -> None:
    # Pinned-pinned: ω = π² √(EI/ρA)/L²; at f = π/2 Hz, L = 1 and ρA = 3, EI = 3 π⁴/π⁴.
    found = stiffness_from_frequency(math.pi / 2, "pinned-pinned", length=1.0, mass_per_length=3.0)
    assert found == pytest.approx(3.0, rel=1e-14)


BODIES = [
    "clamped-free(mass=0.2)",
    "free(rotary_inertia=0.01)-free(mass=1, offset=0.1)",
    "pinned-guided(mass=2)",
]


@pytest.mark.parametrize("boundary", BODIES)
def test_round_trip_with_bodies(boundary: str) -> None:
    for mode, stiffness in ((1, 85.0), (3, 1e-4), (2, 1e9)):
        found = stiffness_from_frequency(measured(stiffness, boundary, mode), boundary, mode=mode, **SPAN)
        assert found == pytest.approx(stiffness, rel=1e-13)


def test_round_trip_with_rotary_inertia() -> None:
    found = stiffness_from_frequency(
        measured(85.0, "clamped-free", 2, 0.003),
        "clamped-free",
        mode=2,
        rotary_inertia_per_length=0.003,
        **SPAN,
    )
    assert found == pytest.approx(85.0, rel=1e-13)


SPRINGS = [
    "pinned(rotational_stiffness=50)-free",
    "clamped-free(translational_stiffness=300, mass=0.1)",
    "free(translational_stiffness=900)-free(translational_stiffness=900, rotational_stiffness=3)",
    "guided(translational_stiffness=2000)-pinned",
]


@pytest.mark.parametrize("boundary", SPRINGS)
def test_round_trip_with_springs(boundary: str) -> None:
    for mode, stiffness in ((1, 20.0), (2, 85.0), (3, 1e-3), (3, 1e5)):
        found = stiffness_from_frequency(measured(stiffness, boundary, mode), boundary, mode=mode, **SPAN)
        assert found == pytest.approx(stiffness, rel=1e-9), (mode, stiffness)


@settings(max_examples=20)
@given(stiffness=st.floats(1e-2, 1e3), spring=st.floats(1.0, 1e4))
def test_round_trip_with_any_spring(stiffness: float, spring: float) -> None:
    boundary = f"pinned-free(translational_stiffness={spring!r})"
    found = stiffness_from_frequency(measured(stiffness, boundary, 2), boundary, mode=2, **SPAN)
    assert found == pytest.approx(stiffness, rel=1e-8)


def test_a_rigid_beam_on_springs_has_a_finite_frequency() -> None:
    # A rigid bar about a pin with a rotational spring: ω² = K/(ρA L³/3).
    rigid = math.sqrt(50 / (0.62 * 1.2**3 / 3)) / (2 * math.pi)
    boundary = "pinned(rotational_stiffness=50)-free"
    assert stiffness_from_frequency(0.9 * rigid, boundary, **SPAN) > 0
    with pytest.raises(ValueError, match=r"^frequency must be one that some stiffness gives") as info:
        stiffness_from_frequency(1.1 * rigid, boundary, **SPAN)
    assert f"to {rigid:.4f}" in str(info.value) and f"got {1.1 * rigid:.6g}" in str(info.value)


@pytest.mark.parametrize("boundary", FIRM)
@pytest.mark.parametrize("load", ["tip_force", "tip_moment", "uniform_load"])
@pytest.mark.parametrize("place", ["tip", "midspan"])
def test_round_trip_of_deflections(boundary: str, load: str, place: str) -> None:
    unit = beam_statics(Beam(1.2, 85.0, 1.0), boundary, load)
    deflection = -3.0 * (unit.deflection if place == "tip" else unit.midspan_deflection)
    arguments: Any = {"length": 1.2, load: -3.0, "at": place}
    if math.isnan(deflection) or deflection == 0:
        with pytest.raises(ValueError, match=rf"^{load} must move the {place} of {boundary}, got -3\.0"):
            stiffness_from_deflection(-0.01, boundary, **arguments)
    else:
        found = stiffness_from_deflection(deflection, boundary, **arguments)
        assert found == pytest.approx(85.0, rel=1e-14)


def test_deflections_in_closed_form() -> None:
    # F L³/(3 y), 5 q L⁴/(384 y) at the middle of a beam whose tip is held, and q L⁴/(8 y) at a free tip.
    assert stiffness_from_deflection(0.5, "clamped-free", length=2.0, tip_force=3.0) == pytest.approx(16.0)
    sag = stiffness_from_deflection(-0.01, "pinned-pinned", length=2.0, uniform_load=-384.0)
    assert sag == pytest.approx(5 * 16 / 0.01, rel=1e-14)
    assert stiffness_from_deflection(0.25, "free-clamped", length=2.0, uniform_load=1.0) == pytest.approx(8.0)


def test_the_published_deflection_gives_the_published_modulus() -> None:
    # MathWorks' lumped beam: 205.93 N/m bend 0.3 m of 15 × 5 mm by 0.0191 m; 70 GPa went in.
    found = stiffness_from_deflection(0.0191, "clamped-free", length=0.3, uniform_load=205.93)
    assert found / Rectangle(0.015, 0.005).second_moment == pytest.approx(70e9, rel=0.003)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ({}, "one of tip_force, tip_moment, uniform_load, mid_force must be given, got none"),
        ({"tip_force": 1.0, "tip_moment": 2.0}, "one of .* must be given, got tip_force, tip_moment"),
        ({"tip_force": -1.0}, r"deflection must be one that tip_force = -1\.0 causes at the tip, downwards"),
        ({"tip_force": 1.0, "deflection": 0.0}, r"deflection must be .* upwards, got 0\.0"),
        ({"tip_force": 0.0}, r"tip_force must move the tip of clamped-free, got 0\.0"),
        ({"tip_force": 1.0, "boundary": "pinned-pinned"}, "tip_force must move the midspan of pinned-pinned"),
        ({"tip_force": 1.0, "boundary": "pinned-free"}, "boundary must hold the beam still"),
        ({"tip_force": 1.0, "boundary": SPRINGS[0]}, "boundary must hold its ends or leave them free"),
        ({"tip_force": 1.0, "at": "root"}, "at must be one of tip, midspan"),
        ({"tip_force": math.nan}, "tip_force must be finite"),
        ({"uniform_load": 1.0, "length": -1}, "length must be greater than 0, got -1"),
    ],
)
def test_deflections_that_give_no_stiffness(call: dict[str, Any], message: str) -> None:
    arguments: Any = {"deflection": 0.01, "boundary": "clamped-free", "length": 1.0, **call}
    with pytest.raises(ValueError, match=f"^{message}"):
        stiffness_from_deflection(**arguments)


bad = st.one_of(
    st.text(), st.none(), st.booleans(), st.complex_numbers(), st.floats(max_value=0.0),
    st.sampled_from([math.nan, math.inf, 10**400, [1.0]]),
)  # fmt: skip


@given(name=st.sampled_from(["frequency", "length", "mass_per_length"]), value=bad)
def test_bad_input_gives_one_of_two_exceptions_that_name_it(name: str, value: object) -> None:
    arguments: Any = {"frequency": 5.0, "boundary": "clamped-free", **SPAN, name: value}
    with pytest.raises((TypeError, ValueError), match=f"^{name} must be ") as info:
        stiffness_from_frequency(**arguments)
    assert shown(value) in str(info.value)


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        ({"mode": 0}, ValueError, "mode must be a whole number of at least 1"),
        ({"boundary": "clamped-fre"}, ValueError, 'boundary .*mean "clamped-free"'),
        ({"frequency": 1e200}, ValueError, "frequency must suit the other numbers: 1e.200 with length 1.2"),
        ({"rotary_inertia_per_length": -1.0}, ValueError, "rotary_inertia_per_length must not be negative"),
    ],
)
def test_frequencies_that_give_no_stiffness(
    change: dict[str, Any], kind: type[Exception], message: str
) -> None:
    arguments: Any = {"frequency": 5.0, "boundary": "clamped-free", **SPAN, **change}
    with pytest.raises(kind, match=f"^{message}"):
        stiffness_from_frequency(**arguments)
