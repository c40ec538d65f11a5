"""Numbers of ends and loads as dimensions of the error table, and in a beam's own units."""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
import pytest

import beammodes as bm
from beammodes.accuracy.beam_units import NUMBERS, in_beam_units
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.accuracy.error_table import error_dataset
from beammodes.accuracy.errors import frequency_error
from beammodes.accuracy.segments import segments_needed
from beammodes.chains.chain import Chain
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes


def test_numbers_are_dimensions_between_boundary_and_segments() -> None:
    over = {
        "right_mass": [0.0, 0.5],
        "left_rotational_stiffness": [10.0, math.inf],
        "axial_force": [-1.0, 0.0, 2.0],
    }
    table = error_dataset(
        boundary="pinned-free", segments=[4, 9], modes=2, rule=["mitiguy", "gregory"], over=over
    )
    assert table.relative_error.dims == ("rule", "boundary", *over, "segments", "mode")
    assert [table[name].attrs["multiple_of"] for name in over] == [NUMBERS[name] for name in over]
    one = table.relative_error.sel(
        rule="gregory", right_mass=0.5, left_rotational_stiffness=10.0, axial_force=2.0, segments=9
    )
    pair = "pinned(rotational_stiffness=10)-free(mass=0.5)"
    pull = Load(axial_force=2.0)
    expected = frequency_error(pair, segments=9, mode=[1, 2], rule="gregory", load=pull, beam=Beam.unit())
    np.testing.assert_allclose(one.squeeze().values, expected, rtol=1e-12)
    # The plain corner is the plain pair's.
    plain = table.relative_error.sel(
        rule="mitiguy", right_mass=0.0, left_rotational_stiffness=math.inf, axial_force=0.0, segments=4
    )
    np.testing.assert_allclose(
        plain.squeeze().values, frequency_error("clamped-free", segments=4, mode=[1, 2]), rtol=1e-9
    )


def test_the_two_ends_stay_in_the_order_given() -> None:
    table = error_dataset(boundary="free-clamped", segments=5, modes=1, over={"left_mass": [1.0]})
    assert table.boundary.values.tolist() == ["free-clamped"]
    other = error_dataset(boundary="clamped-free", segments=5, modes=1, over={"right_mass": [1.0]})
    np.testing.assert_allclose(table.relative_error.values, other.relative_error.values, rtol=1e-12)


@pytest.mark.parametrize(
    ("over", "words"),
    [
        ({"right_mas": [1.0]}, 'did you mean "right_mass"'),
        ({"right_mass": []}, "right_mass must name at least one value"),
        ({"right_mass": [-1.0]}, "mass must not be negative"),
        ({"axial_force": [math.nan]}, "axial_force must be finite"),
        ({"left_rotational_stiffness": ["stiff"]}, "rotational_stiffness must be a real number"),
    ],
)
def test_bad_dimensions_are_named(over: Any, words: str) -> None:
    with pytest.raises((TypeError, ValueError), match=words):
        error_dataset(boundary="clamped-free", segments=4, modes=1, over=over)


def test_over_must_be_a_mapping() -> None:
    with pytest.raises(TypeError, match="over must map"):
        error_dataset(boundary="clamped-free", segments=4, modes=1, over=[1.0])  # type: ignore[arg-type]


def test_lookups_broadcast_over_ends() -> None:
    pairs = ["clamped-free", "clamped-free(mass=1)", "pinned(rotational_stiffness=3)-free"]
    found = frequency_error(np.array(pairs)[:, None], segments=[5, 20], mode=1, rule="gregory")
    for i, pair in enumerate(pairs):
        for j, count in enumerate((5, 20)):
            one = frequency_error(pair, segments=count, mode=1, rule="gregory")
            assert found[i, j] == pytest.approx(one, rel=1e-9)  # type: ignore[index]
    assert math.isnan(frequency_error("clamped-free(mass=1)", segments=2, mode=3))


def test_ends_in_a_beam_s_own_units_have_the_same_errors() -> None:
    beam = Beam(1.7, 23.0, 0.4)
    physical = Boundary.of(
        "free(translational_stiffness=90, mass=0.2, rotary_inertia=0.01, offset=0.1)-pinned"
    )
    scaled = in_beam_units(physical, beam)
    ours = solve_modes(linearize(Chain(beam, physical, 12, "gregory")), 3).angular_frequency
    exact = euler_bernoulli(beam, physical, 3).angular_frequency
    error = frequency_error(scaled, segments=12, mode=[1, 2, 3], rule="gregory")
    np.testing.assert_allclose(ours / exact - 1, error, atol=1e-12)


def test_segments_needed_with_a_body_is_where_the_error_falls_below() -> None:
    for rule in ("mitiguy", "gregory"):
        count = segments_needed("clamped-free(mass=1)", 0.01, 3, rule)
        error = np.asarray(
            frequency_error(
                "clamped-free(mass=1)", segments=[[count - 1], [count]], mode=[1, 2, 3], rule=rule
            )
        )
        assert np.abs(error[0]).max() > 0.01 >= np.abs(error[1]).max()


# A hose, a spring of steel wire and a boom, in units from micrograms and millimetres to tonnes.
BEAMS = [Beam(0.3, 2e-5, 0.004), Beam(47.0, 2.1, 3e-6), Beam(12.0, 3.4e7, 210.0)]
LOADED = [
    ("clamped-free", {"axial_force": 0.9}),
    ("clamped-free(mass={m}, rotary_inertia={j}, offset={l})", {"axial_force": -0.7}),
    ("pinned(rotational_stiffness={kr})-guided(translational_stiffness={kt})", {"axial_force": 2.0}),
    ("clamped-free", {"gravity": (0.5, 0.0)}),
    ("clamped-free(mass={m})", {"spin_rate": 1.5, "hub_radius": 0.2, "plane": "lag"}),
    ("clamped-free", {"tip_force": (3.0, 0.0)}),
]


def in_units_of(beam: Beam, pair: str, load: dict[str, Any]) -> tuple[str, Load]:
    """Ends and load in the beam's units, from multiples of its own that are written out here."""
    ei, mass, length = beam.mean_bending_stiffness, beam.mean_mass_per_length, beam.length
    scale = {
        "axial_force": ei / length**2,
        "tip_force": ei / length**2,
        "gravity": ei / (mass * length**3),
        "spin_rate": math.sqrt(ei / mass) / length**2,
        "hub_radius": length,
    }
    sizes = {
        "m": 0.4 * mass * length,
        "j": 0.03 * mass * length**3,
        "l": 0.1 * length,
        "kr": 5 * ei / length,
        "kt": 40 * ei / length**3,
    }
    given: dict[str, Any] = {
        name: value
        if isinstance(value, str)
        else (value[0] * scale[name], 0.0)
        if isinstance(value, tuple)
        else value * scale[name]
        for name, value in load.items()
    }
    return pair.format(**{name: repr(value) for name, value in sizes.items()}), Load(**given)


@pytest.mark.parametrize("beam", BEAMS, ids=repr)
@pytest.mark.parametrize(("words", "numbers"), LOADED)
def test_with_a_beam_all_numbers_are_in_its_units(words: str, numbers: dict[str, Any], beam: Beam) -> None:
    pair, load = in_units_of(beam, words, numbers)
    # The other route: a chain of that beam, solved, against the exact beam, both in its units.
    chain = Chain(beam, pair, 12, "gregory")
    expected = chain_errors(chain, 2, load=load)
    found = frequency_error(pair, segments=12, mode=[1, 2], rule="gregory", load=load, beam=beam)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=3e-13)
    several = frequency_error(
        [pair, "clamped-free"], segments=12, mode=1, rule="gregory", load=load, beam=beam
    )
    np.testing.assert_allclose(np.asarray(several)[0], expected[0], rtol=1e-7, atol=3e-13)
    table = error_dataset(boundary=pair, segments=12, modes=2, rule="gregory", load=load, beam=beam)
    np.testing.assert_allclose(table.relative_error.squeeze(), expected, rtol=1e-7, atol=3e-13)
    exact = euler_bernoulli(beam, pair, 2, load=load).angular_frequency
    np.testing.assert_allclose(table.exact_angular_frequency.squeeze(), exact, rtol=1e-11)
    assert table.angular_frequency.attrs["units"] == "rad / s"
    # Scaled by hand, the beam's own units give the same: nothing depends on which beam it is.
    own, pull = in_units_of(Beam.unit(), words, numbers)
    again = frequency_error(own, segments=12, mode=[1, 2], rule="gregory", load=pull, beam=Beam.unit())
    np.testing.assert_allclose(again, found, rtol=1e-7, atol=3e-13)
    # The beams take turns.
    if load.is_axial and LOADED.index((words, numbers)) % len(BEAMS) == BEAMS.index(beam):
        count = segments_needed(pair, 0.02, 1, load=load, beam=beam)
        assert count == segments_needed(own, 0.02, 1, load=pull, beam=Beam.unit())
        for n, within in ((count, True), (count - 1, False)):
            assert n == 0 or (abs(chain_errors(Chain(beam, pair, n), 1, load=load)[0]) <= 0.02) == within


def test_newtons_are_no_multiples() -> None:
    # A catheter pulled by 2 mN, T L²/EI = 32: the answer without its units would have been that for 0.002.
    catheter, pull = Beam(length=0.4, bending_stiffness=1e-5, mass_per_length=0.003), Load(axial_force=0.002)
    assert pull.axial_force * catheter.length**2 / catheter.mean_bending_stiffness == pytest.approx(32)
    right = segments_needed("clamped-free", 0.01, 3, load=pull, beam=catheter)
    wrong = segments_needed("clamped-free", 0.01, 3, load=pull, beam=Beam.unit())
    errors = [
        np.abs(chain_errors(Chain(catheter, "clamped-free", n), 3, load=pull)).max() for n in (right, wrong)
    ]
    assert wrong != right and errors[0] <= 0.01


@pytest.mark.parametrize(
    "call",
    [
        lambda load: frequency_error("clamped-free", segments=4, mode=1, load=load),
        lambda load: segments_needed("clamped-free", 0.01, load=load),
        lambda load: error_dataset(boundary="clamped-free", segments=4, modes=1, load=load),
        lambda load: bm.axially_corrected("gregory", load),
    ],
)
def test_a_load_without_a_beam_is_refused_with_both_ways(call: Any) -> None:
    call_it = pytest.raises(
        ValueError, match=r"^load must come with a beam.* beam=Beam\(L, EI, rhoA\).*Beam\.unit\(\)"
    )
    for load in (
        Load(axial_force=0.002),
        Load(spin_rate=1.0),
        Load(gravity=(9.81, 0.0)),
        Load(tip_moment=1.0),
    ):
        with call_it:
            call(load)
    with pytest.raises(TypeError, match=r"^load must be a Load"):
        call(0.002)


def test_every_public_function_with_a_load_has_what_says_its_units() -> None:
    found = []
    for name in bm.__all__:
        value = getattr(bm, name)
        if not callable(value) or isinstance(value, type):
            continue
        parameters = inspect.signature(value).parameters
        if "load" in parameters and "Load" in str(parameters["load"].annotation):
            found.append(name)
            assert set(parameters) & {"beam", "chain", "structure", "system"}, name
    assert {"frequency_error", "segments_needed", "error_dataset", "linearize", "axially_corrected"} <= set(
        found
    )


def test_a_beam_that_lookups_cannot_take_is_refused_with_a_way_on() -> None:
    for beam, why in (
        (Beam(1.0, [1.0, 2.0], 1.0), "uniform"),
        (Beam(1.0, 1.0, 1.0, 0.01), "without rotary inertia"),
    ):
        for call in (
            lambda beam=beam: frequency_error("clamped-free", segments=4, mode=1, beam=beam),
            lambda beam=beam: error_dataset(boundary="clamped-free", segments=4, modes=1, beam=beam),
        ):
            with pytest.raises(ValueError, match=f"^beam must be {why}.*chain_errors"):
                call()
        # What solves chains one by one takes any beam.
        assert segments_needed("clamped-free", 0.01, beam=beam) > 1
        assert bm.recommend("clamped-free", 0.01, beam=beam, rules=["gregory", "mitiguy"])
    with pytest.raises(TypeError, match=r"^beam must be a Beam"):
        frequency_error("clamped-free", segments=4, mode=1, beam="steel")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match=r"^mass must suit the beam"):
        frequency_error("clamped-free(mass=1e-300)", segments=4, mode=1, beam=Beam(1.0, 1.0, 1e200))


def test_tables_of_chains_take_a_beam() -> None:
    beam = BEAMS[0]
    stiffness = 5 * beam.mean_bending_stiffness / beam.length
    pairs = [f"pinned(rotational_stiffness={value!r})-pinned" for value in (stiffness, 5.0)]
    unit = beam.mean_bending_stiffness / beam.length**2
    loads = bm.buckling_dataset(boundary=pairs[0], segments=6, beam=beam)
    own = bm.buckling_dataset(boundary=pairs[1], segments=6)
    assert (loads.buckling_load.attrs["units"], own.buckling_load.attrs["multiple_of"]) == ("N", "EI / L^2")
    np.testing.assert_allclose(loads.buckling_load / unit, own.buckling_load.values[...], rtol=1e-12)
    shapes = [
        bm.shape_dataset(boundary=pair, segments=6, modes=2, beam=given).assurance_deficit.values
        for pair, given in zip(pairs, (beam, None), strict=True)
    ]
    np.testing.assert_allclose(shapes[0], shapes[1], rtol=1e-6)
    over = {"right_mass": [0.0, 1e-4], "axial_force": [1e-5]}
    table = error_dataset(boundary="clamped-free", segments=6, modes=1, over=over, beam=beam)
    assert [table[name].attrs["units"] for name in over] == ["kg", "N"]
    chain = Chain(beam, "clamped-free(mass=1e-4)", 6)
    expected = chain_errors(chain, 1, load=Load(axial_force=1e-5))
    np.testing.assert_allclose(table.relative_error.sel(right_mass=1e-4).squeeze(), expected[0], rtol=1e-8)


@pytest.mark.parametrize("value", [0.5, 1, 1.0, 2, 5, 100, 1e300])
def test_a_tolerance_in_percent_is_questioned_wherever_one_is_taken(value: float) -> None:
    chain = Chain(Beam.unit(), "clamped-free", 4)
    names = ("length", "mass", "rotary_inertia", "joint_stiffness")
    arrays: Any = {name: getattr(chain, name) for name in names}
    for call in (
        lambda: segments_needed("clamped-free", value),
        lambda: bm.recommend("clamped-free", value),
        lambda: bm.audit_chain(Beam.unit(), "clamped-free", **arrays, tolerance=value),
        lambda: bm.audit_file("no such file", Beam.unit(), tolerance=value),
    ):
        with pytest.raises(ValueError, match=r"^tolerance must be a fraction less than 0\.5, got") as refused:
            call()
        assert (f"give {value / 100:g}" in str(refused.value)) == (value <= 50)
