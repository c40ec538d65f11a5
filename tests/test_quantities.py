"""Quantities of pint wherever a number has a unit, in all public functions; datasets' units; 0-d arrays.

The unit of an argument is the one that its docstring says, which the package itself does not read.
"""

from __future__ import annotations

import functools
import inspect
import numbers
import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
import xarray
from test_hostile_calls import CALLS

import beammodes as bm
from beammodes.batch.quantities import QUANTITIES

pint = pytest.importorskip("pint")
UNIT = pint.UnitRegistry()
Q = UNIT.Quantity

#: Units of arguments whose docstrings name none, or one of what they are a function of.
ELSEWHERE = {
    "diameter": "m",
    "radius_of_gyration": "m",
    "radius": "m",
    "pitch": "m",
    "straight": "m",
    "deflection_at": "m",
    "span": "m",
    "x": "m",
    "length": "m",
    "offset": "m",
    "torsion_constant": "m4",
    "angle": "rad",
    "curvature": "1/m",
    "bending_stiffness": "N m2",
    "second_bending_stiffness": "N m2",
    "torsional_stiffness": "N m2",
    "axial_stiffness": "N",
    "shear_stiffness": "N",
    "tip_force": "N",
    "translational_stiffness": "N/m",
    "rotational_stiffness": "N m/rad",
    "joint_stiffness": "N m/rad",
    "mass": "kg",
    "mass_per_length": "kg/m",
    "rotary_inertia_per_length": "kg m",
    "polar_inertia_per_length": "kg m",
    "rotary_inertia": "kg m2",
    "elastic_modulus": "Pa",
    "density": "kg/m3",
    "duration": "s",
    "trace": "s",
    "step": "s",
    "output_step": "s",
    "timestep": "s",
}
#: Arguments without a unit that share a name with one, or whose unit is that of what they are given for.
OWN = {
    ("random_response", "density"): "N2/Hz",
    ("Table", "value"): "N m2",
    ("modal_assurance", "mass"): "",
    ("draw_chain", "size"): "",
    ("draw_statics", "size"): "",
}


def called(name: str) -> Any:
    return functools.reduce(getattr, name.split("."), bm)


@functools.cache
def units_said(name: str) -> Mapping[str, str]:
    """The units of parameters as a docstring has them: "mass, inertia : float [kg], [kg m²]"."""
    text = inspect.cleandoc(called(name).__doc__ or "")
    part = re.search(r"Parameters\n-+\n(.*?)(\n\n[A-Z][a-z]+\n-+\n|\Z)", text, re.DOTALL)
    found: dict[str, str] = {}
    for names, rest in re.findall(r"^(\w+(?:, \w+)*) : (.*)$", part[1] if part else "", re.MULTILINE):
        units, listed = re.findall(r"\[([^\[\]]+)\](?=$|, \[)", rest), names.split(", ")
        found |= zip(listed, units * len(listed) if len(units) == 1 else units, strict=False)
    return found


def in_pint(unit: str) -> Any:
    """A unit of a docstring as one of pint's."""
    spelled = unit.split(" or ")[0].translate({ord("²"): "2", ord("³"): "3", ord("⁴"): "4"})
    return UNIT.Unit(re.sub(r"(?<=[a-zA-Z])(\d)", r"**\1", spelled).replace(" ", "*"))


def is_numeric(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return bool(value) and all(map(is_numeric, value))
    return isinstance(value, numbers.Real | np.ndarray) and not isinstance(value, bool | Fraction)


def alike(one: Any, other: Any) -> bool:
    """Whether two answers of one question are the same, as far as answers of this kind can be compared."""
    if isinstance(one, xarray.Dataset):
        return bool(one.equals(other))
    if isinstance(one, np.ndarray | float | int):
        return bool(np.allclose(one, other, rtol=1e-12, atol=1e-14, equal_nan=True))
    if isinstance(one, tuple) and one and isinstance(one[0], Path):
        return [path.read_text() for path in one] == [path.read_text() for path in other]
    return type(one) is type(other) and (" at 0x" in repr(one) or repr(one) == repr(other))


def refused(function: Callable[..., Any], given: dict[str, Any], argument: str) -> None:
    with pytest.raises(TypeError, match=argument):
        function(**given)


#: Calls of long computations, which the slow test makes.
LONG = {
    "Beam.from_sections",
    "Rod.through",
    "animate",
    "critical_factor",
    "derive_chain",
    "frequency_spread",
    "modal_response",
    "plot_response",
    "random_response",
    "simulate",
}


def check_call(name: str) -> int:
    """Give each number of a call with its unit, and with a wrong one; return how many have a unit."""
    make, function, count = CALLS[name], called(name), 0
    plain = None
    for argument, value in make().items():
        if not is_numeric(value):
            continue
        unit = OWN.get((name, argument), units_said(name).get(argument, ELSEWHERE.get(argument, "")))
        refused(function, make() | {argument: Q(value, "ampere")}, argument)
        if not unit:
            refused(function, make() | {argument: Q(value, "metre")}, argument)
            continue
        # What a table's values are is for the property that takes them to say.
        if (name, argument) != ("Table", "value"):
            refused(function, make() | {argument: Q(value, "second" if "kg" in unit else "kg")}, argument)
        plain = function(**make()) if plain is None else plain
        assert alike(function(**make() | {argument: Q(value, in_pint(unit))}), plain), (name, argument)
        count += 1
    return count


def test_every_number_of_every_public_function_is_taken_with_its_unit_and_with_no_other() -> None:
    found = sum(check_call(name) for name in CALLS if name not in LONG)
    assert found > 150


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Animation was deleted", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", sorted(LONG))
def test_long_computations_take_units_too(name: str) -> None:
    check_call(name)


def test_units_are_converted_and_cycles_told_from_radians() -> None:
    rod = bm.Rod.arc(
        Q(90, "degree"),
        length=Q(1, "foot"),
        bending_stiffness=1.0,
        torsional_stiffness=1.0,
        mass_per_length=1.0,
    )
    assert rod.length == pytest.approx(0.3048, rel=1e-15)
    assert rod.curvature[2] == pytest.approx(np.pi / 2 / 0.3048, rel=1e-15)
    load = bm.Load(spin_rate=Q(60, "rpm"), tip_force=Q([0, 3], "lbf"), gravity=Q(981, "cm/s**2"))
    assert load.spin_rate == pytest.approx(2 * np.pi, rel=1e-15)
    assert load.tip_force == (0.0, pytest.approx(3 * 0.45359237 * 9.80665, rel=1e-15))
    assert load.gravity == (0.0, pytest.approx(-9.81, rel=1e-15))
    assert bm.Sine(Q(60, "rpm")).frequency == pytest.approx(1.0, rel=1e-15)
    assert bm.Sine(Q(2, "kHz")).frequency == 2000.0
    course = bm.harmonic(Q(3, "mm"), Q(5, "Hz"))(np.array([0.05]))
    assert course[0][0] == pytest.approx(0.003, rel=1e-12)
    assert bm.End(rotational_stiffness=Q(1, "N*m/degree")).rotational_stiffness == pytest.approx(180 / np.pi)
    assert bm.segments_needed("clamped-free", Q(1, "percent")) == bm.segments_needed("clamped-free", 0.01)
    other = pint.UnitRegistry(system="cgs").Quantity(3, "N*m**2")
    assert bm.Beam(1.0, other, 1.0).bending_stiffness == pytest.approx(3.0, rel=1e-15)


@pytest.mark.parametrize("style", ["~", "~P", "L", "C"])
def test_cycles_are_told_from_radians_however_a_registry_prints_its_units(style: str) -> None:
    unit = pint.UnitRegistry()
    unit.formatter.default_format = style
    rates = ((1, "Hz"), (60, "rpm"), (0.001, "kHz"), (2 * np.pi, "rad*Hz"), (1, "turn*Hz"))
    for rate in (unit.Quantity(*each) for each in rates):
        assert bm.Load(spin_rate=rate).spin_rate == pytest.approx(2 * np.pi, rel=1e-15)
        assert bm.Sine(rate).frequency == pytest.approx(1.0, rel=1e-15)


def test_properties_along_a_beam_are_taken_in_rows_tables_and_functions_with_units() -> None:
    beam = bm.Beam(
        Q(1200, "mm"),
        lambda x: Q(85 - x, "N*m**2"),
        bm.Table(Q([0, 600, 1200], "mm"), Q([1, 2, 3], "g/mm")),
        [Q(1, "kg*m"), Q(2, "kg*m")],
    )
    plain = bm.Beam(1.2, lambda x: 85 - x, bm.Table([0, 0.6, 1.2], [1, 2, 3]), [1, 2])
    assert beam.length == plain.length and beam.mass_per_length == plain.mass_per_length
    assert beam.rotary_inertia_per_length == plain.rotary_inertia_per_length
    one, other = (bm.solve_modes(bm.linearize(bm.Chain(each, "clamped-free", 5))) for each in (beam, plain))
    assert np.array_equal(one.frequency, other.frequency)
    for wrong in (lambda _: Q(1, "N"), bm.Table([0, 1.2], Q([1, 2], "N")), Q([1, 2], "N")):
        with pytest.raises(TypeError, match="bending_stiffness must be"):
            bm.Beam(1.2, wrong, 1.0)
    bm.TimedLoad(bm.Load(tip_force=1.0), bm.Table(Q([0, 1], "ms"), [0, 1]))
    with pytest.raises(TypeError, match="course must be a table whose x is in s"):
        bm.TimedLoad(bm.Load(tip_force=1.0), bm.Table(Q([0, 1], "mm"), [0, 1]))


def test_ends_with_units_are_never_taken_for_multiples_of_a_beams_own() -> None:
    ends, asked = ("clamped", bm.End(mass=Q(500, "g"))), {"segments": 6, "mode": 1}
    beam = bm.Beam(1.2, 85.0, 0.62)
    assert bm.frequency_error(ends, **asked, beam=beam) == bm.frequency_error(
        "clamped-free(mass=0.5)", **asked, beam=beam
    )
    many = ("clamped", bm.Ends(mass=Q([1, 2], "kg")))
    study = {"segments": 3, "mode": 1, "compute": "relative_error"}
    for call in (
        lambda: bm.frequency_error(ends, **asked),
        lambda: bm.frequency_error(many, **asked),
        lambda: bm.segments_needed(ends, 0.01),
        lambda: bm.recommend(ends, 0.01),
        lambda: bm.match_springs(ends, 4, 1),
        lambda: bm.error_dataset(boundary=ends, segments=3, modes=1),
        lambda: bm.Study.grid(boundary=[ends], **study),
        lambda: bm.Study.grid(boundary="clamped-free", right_mass=Q([1, 2], "kg"), **study),
        lambda: bm.frequency_error(("fixed", bm.AxialEnd(inertia=Q(1, "kg*m**2"))), **asked, motion="twist"),
    ):
        with pytest.raises(ValueError, match=r"must (have|be a) multiple"):
            call()
    with pytest.raises(TypeError, match="right must be in units of twist"):
        bm.AxialBoundary(bm.AxialEnd(), bm.AxialEnd(inertia=Q(1, "kg")))
    given = {"length": Q(1.2, "m"), "bending_stiffness": 85.0, "mass_per_length": 0.62}
    run = bm.Study.grid(boundary="clamped-free", right_mass=Q([1, 2], "lb"), **given, **study).run()
    assert np.allclose(run.right_mass, np.array([1, 2]) * 0.45359237, rtol=1e-15)


def test_arrays_without_axes_and_dataarrays_are_numbers() -> None:
    chain = bm.Chain(
        bm.Beam(np.array(1.2), xarray.DataArray(85.0), np.float32(0.5)), "clamped-free", np.array(3)
    )
    assert (chain.beam.length, chain.beam.bending_stiffness, chain.segments) == (1.2, 85.0, 3)
    # An array inside: xarray looks for the shape of a bare quantity, which has none.
    assert bm.End(mass=xarray.DataArray(Q(np.array(500.0), "g"))).mass == 0.5
    places, stiffness = pandas.Series([0.0, 1.2]), pandas.Series([85.0, 40.0])
    assert bm.Table(places, stiffness) == bm.Table([0.0, 1.2], [85.0, 40.0])
    assert bm.Beam(1.2, stiffness, 0.5) == bm.Beam(1.2, [85.0, 40.0], 0.5)
    assert bm.Load(gravity=np.array([0.0, -9.81])) == bm.Load(gravity=xarray.DataArray([0.0, -9.81]))
    for wrong in (np.array([1.0]), np.array(True), np.array("1"), xarray.DataArray([1.0, 2.0])):
        with pytest.raises(TypeError, match="length must be a real number"):
            bm.Beam(wrong, 1.0, 1.0)
    with pytest.raises(ValueError, match="length must have no masked values"):
        bm.Beam(np.ma.masked, 1.0, 1.0)


def test_numbers_without_a_unit_and_dataarrays_that_do_not_meet() -> None:
    # One turn is 2π to pint.
    with pytest.raises(TypeError, match="turns must be a number without a unit, got 1 turn"):
        bm.Rod.helix(radius=0.1, pitch=0.05, turns=Q(1, "turn"))
    with pytest.raises(TypeError, match="tolerance must be a number without a unit, got 1 degree"):
        bm.segments_needed("clamped-free", Q(1, "degree"))
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=2)
    start = Q([1.0, 2.0], "degree"), Q([1.0, 0.5], "Hz")
    moved = bm.simulate(chain, duration=0.01, initial=start).isel(time=0)
    assert moved.q.values == pytest.approx(np.radians([1.0, 2.0]), rel=1e-15)
    assert moved.u.values == pytest.approx([2 * np.pi, np.pi], rel=1e-15)
    # Whole numbers stay such, and percent in a DataArray are no fractions.
    assert bm.Chain(bm.Beam.unit(), "clamped-free", Q(3, "")).segments == 3
    errors = functools.partial(bm.response_error, "clamped-free", segments=6, mode=1)
    percent = errors(damping_ratio=xarray.DataArray(Q([1.0, 2.0], "percent"), dims="z"))
    assert percent.values == pytest.approx(errors(damping_ratio=[0.01, 0.02]), rel=1e-12)
    few, other = (xarray.DataArray([4, 5], dims="n", coords={"n": labels}) for labels in ([1, 2], [2, 3]))
    with pytest.raises(ValueError, match="DataArrays must agree along dimensions that they share"):
        bm.frequency_error("clamped-free", segments=few, mode=other)
    with pytest.raises(TypeError, match=r"segments must be an array or a list, got <xarray\.Dataset>"):
        bm.frequency_error("clamped-free", segments=xarray.Dataset({"n": few}), mode=1)


def test_units_of_datasets_can_be_read_by_pint() -> None:
    over = {"right_mass": [0.1], "axial_force": [0.1]}
    study = {"boundary": "clamped-free", "segments": 3, "mode": 1, "right_mass": [0.1, 0.2]}
    beam = {"length": 1.2, "bending_stiffness": 85.0, "mass_per_length": [0.6, 0.7]}
    names = [name for name in QUANTITIES if "static" not in name]
    tables = [
        bm.error_dataset(boundary="clamped-free", segments=3, modes=1, over=over),
        bm.rod_error_dataset(bm.Rod(1.0, 1.0, 0.8, 1.0, 0.01), "clamped-free", segments=3),
        bm.Study.grid(**study, compute=names).run(),
        bm.Study.grid(**study, **beam, compute=names).run(),
        *(called(name)(**CALLS[name]()) for name in CALLS if name.endswith("dataset")),
        *(called(name)(**CALLS[name]()) for name in ("damped_modes", "frequency_response", "follower_modes")),
    ]
    variables = [each for table in tables for each in table.variables.values() if each.dtype.kind in "fi"]
    found = {each.attrs["units"] for each in variables}
    # "L" alone would be read as litres.
    assert {"Hz", "1", "kg", "kg / m", "rad / s"} <= found and not {"L", "EI / L"} & found
    for units in found:
        assert UNIT.parse_units(units).dimensionless or units != "1"
    own, given = tables[2:4]
    assert own.right_mass.multiple_of == "rhoA L" and "multiple_of" not in given.right_mass.attrs
