"""Studies: their numbers are those of the functions that they call, whatever the chunks."""

from __future__ import annotations

import decimal
import math
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import beammodes as bm
from beammodes.accuracy.errors import errors_in_multiples
from beammodes.batch.quantities import QUANTITIES
from beammodes.batch.study_axes import AXES

# A steel strip, 1 m x 20 mm x 2 mm.
STRIP = {
    "section": "rectangle",
    "width": 0.02,
    "height": 0.002,
    "length": 1.0,
    "elastic_modulus": 200e9,
    "density": 7800.0,
}


TUBE = {"section": "tube", "outer": 0.01, "length": 1.0, "elastic_modulus": 70e9, "density": 2700.0}


def strip(height: float = 0.002) -> bm.Beam:
    return bm.Beam.from_section(bm.Rectangle(0.02, height), density=7800.0, elastic_modulus=200e9, length=1.0)


def hinges(case: bm.Case) -> float:
    """How many hinges there are."""
    return len(case.chain.joint_stiffness)


def test_a_grid_of_plain_ends_is_the_error_dataset() -> None:
    grid = {"boundary": list(bm.BOUNDARIES), "segments": [1, 2, 7, 30], "rule": list(bm.RULES)}
    names = ["relative_error", "angular_frequency", "exact_angular_frequency"]
    table = bm.Study.grid(**grid, mode=[1, 2, 3], compute=names).run()
    expected = bm.error_dataset(**grid, modes=3)
    for name in names:
        found = table[name].transpose(*expected[name].dims)
        np.testing.assert_allclose(found, expected[name], rtol=1e-12, atol=1e-15, err_msg=name)
        assert found.attrs == expected[name].attrs
    for name in expected.coords:
        assert (table[name] == expected[name]).all()
        assert table[name].attrs.get("units") == expected[name].attrs.get("units")


@pytest.mark.parametrize(
    "over",
    [
        {"right_mass": [0.0, 0.5], "left_rotational_stiffness": [3.0, math.inf]},
        {"axial_force": [-1.0, 0.0, 40.0]},
        {"spin_rate": [0.0, 2.0], "hub_radius": [0.1]},
    ],
)
def test_a_grid_of_numbers_is_the_error_dataset(over: dict[str, list[float]]) -> None:
    base = "pinned-free" if "left_rotational_stiffness" in over else "clamped-free"
    table = bm.Study.grid(
        boundary=[base], segments=[3, 6], mode=[1, 2], **over, compute="relative_error"
    ).run()
    expected = bm.error_dataset(boundary=base, segments=[3, 6], modes=2, over=over).squeeze("rule")
    found = table.relative_error.transpose(*expected.relative_error.dims)
    np.testing.assert_allclose(found, expected.relative_error, rtol=0, atol=1e-13)


def test_numbers_of_ends_in_twist_and_stretch(tmp_path: Path) -> None:
    grid = {"boundary": ["fixed-free", "free-free"], "segments": [3, 8], "rule": ["mitiguy", "half_stub"]}
    for motion, body in (("twist", "right_inertia"), ("stretch", "right_mass")):
        over = {"left_stiffness": [0.5, math.inf], body: [0.0, 0.3, 2.0]}
        table = bm.error_dataset(**grid, modes=2, over=over, motion=motion)
        study = bm.Study.grid(**grid, **over, motion=motion, mode=[1, 2], compute="relative_error")
        found = study.run(store=tmp_path / motion)
        assert found.boundary.values.tolist() == ["fixed-free", "free-free"] and found.failed_cases == 0
        found = found.relative_error.transpose(*table.relative_error.dims)
        # Arrays and single pairs differ by their last bit.
        assert np.allclose(found, table.relative_error, rtol=1e-12, atol=1e-15)
        for name in over:
            assert found[name].multiple_of == table[name].multiple_of.replace("rho ", "rho")
        assert bm.open_study(tmp_path / motion).relative_error.equals(study.run().relative_error)
    # In units of the beam; a mass is one in bending and in stretch; each motion's own ends.
    steel = {"length": 2.0, "bending_stiffness": 3.0, "mass_per_length": 0.5, "axial_stiffness": 40.0}
    both = bm.Study.grid(boundary="clamped-free(mass=0.2)", segments=6, mode=1, motion=["bending", "stretch"],
                         left_stiffness=[7.0, 90.0], compute="angular_frequency", **steel).run()  # fmt: skip
    assert both.failed_cases == 2 and "left_stiffness must be left out for motion bending" in both.reasons
    beam, ends = bm.Beam(2.0, 3.0, 0.5, axial_stiffness=40.0), bm.AxialEnd(inertia=0.2)
    for k, stiffness in enumerate((7.0, 90.0)):
        chain = bm.AxialChain(beam, (bm.AxialEnd(stiffness), ends), 6, motion="stretch")
        solved = bm.solve_modes(chain, 1).angular_frequency[0]
        assert both.angular_frequency.values[1, k] == pytest.approx(solved, rel=1e-11)


def test_frequencies_of_a_section_are_those_of_the_solved_chain() -> None:
    # The second route: mass and stiffness in SI units, solved.
    heights, masses = [0.001, 0.003], [0.0, 0.25]
    table = bm.Study.grid(
        boundary="clamped-free", segments=8, mode=[1, 2, 3], right_mass=masses,
        **STRIP | {"height": heights}, compute=["angular_frequency", "exact_angular_frequency"],
    ).run()  # fmt: skip
    assert table.angular_frequency.units == "rad / s" and table.right_mass.units == "kg"
    for height in heights:
        for mass in masses:
            at = table.sel(height=height, right_mass=mass)
            ends = f"clamped-free(mass={mass})"
            solved = bm.solve_modes(bm.linearize(bm.Chain(strip(height), ends, 8)), 3)
            np.testing.assert_allclose(at.angular_frequency, solved.angular_frequency, rtol=1e-10)
            exact = bm.euler_bernoulli(strip(height), ends, 3)
            np.testing.assert_allclose(at.exact_angular_frequency, exact.angular_frequency, rtol=1e-10)


def test_loads_and_supports_are_in_the_units_of_the_beam() -> None:
    load = bm.Load(axial_force=20.0, spin_rate=5.0, hub_radius=0.2, plane="lag")
    table = bm.Study.grid(
        boundary="clamped-free(rotary_inertia=0.001)", segments=5, mode=[1, 2], axial_force=20.0,
        spin_rate=5.0, hub_radius=0.2, plane="lag", **STRIP, compute=["angular_frequency", "relative_error"],
    ).run()  # fmt: skip
    ends = "clamped-free(rotary_inertia=0.001)"
    solved = bm.solve_modes(bm.linearize(bm.Chain(strip(), ends, 5), load=load), 2).angular_frequency
    np.testing.assert_allclose(table.angular_frequency, solved, rtol=1e-9)
    errors = bm.chain_errors(bm.Chain(strip(), ends, 5), 2, load=load)
    np.testing.assert_allclose(table.relative_error, errors, atol=1e-9)


def test_numbers_of_a_whole_chain() -> None:
    names = [name for name, quantity in QUANTITIES.items() if not quantity.per_mode]
    grid = {"boundary": ["clamped-free", "clamped-pinned"], "segments": [2, 5], "rule": ["mitiguy", "naive"]}
    table = bm.Study.grid(**grid, **STRIP, compute=[*names, hinges]).run()
    buckling, statics = bm.buckling_dataset(**grid), bm.static_dataset(**grid).sel(static_load="tip_force")
    np.testing.assert_allclose(
        table.buckling_error.transpose("rule", "boundary", "segments"), buckling.relative_error, rtol=1e-11
    )
    for name in statics:
        found = table[name].transpose("rule", "boundary", "segments")
        np.testing.assert_allclose(found, statics[name], rtol=1e-12, atol=1e-15)
    chain = bm.Chain(strip(), "clamped-free", 5, "naive")
    at = table.sel(boundary="clamped-free", segments=5, rule="naive")
    assert float(at.buckling_load) == bm.buckling_load(chain)
    assert float(at.exact_buckling_load) == bm.buckling_load(strip(), "clamped-free")
    assert float(at.stable_time_step) == bm.stable_time_step(chain) and at.stable_time_step.units == "s"
    # Their product is the integrator's limit, 2 sqrt 2.
    product = table.stable_time_step * table.highest_angular_frequency
    np.testing.assert_allclose(product, math.sqrt(8), rtol=1e-14)
    assert float(at.hinges) == 5


@pytest.mark.parametrize(
    ("compute", "axis"),
    [
        ("buckling_load", "spin_rate"),
        ("exact_buckling_load", "spin_rate"),
        ("buckling_error", "spin_rate"),
        ("tip_deflection_error", "axial_force"),
        ("midspan_deflection_error", "spin_rate"),
    ],
)
def test_loads_that_a_quantity_does_not_count_are_refused(compute: str, axis: str) -> None:
    # A spun beam buckles later and bends less than one at rest: the number would be that of another beam.
    axes = {"boundary": "clamped-free", "segments": [4], "mode": 1, axis: [0.0, 5.0]}
    with pytest.raises(ValueError, match=f"axes must leave out {axis} with {compute}, which does not count"):
        bm.Study.grid(**axes, compute=["relative_error", compute])


def test_words_of_integrators_and_loads_are_axes() -> None:
    table = bm.Study.grid(
        boundary="clamped-free", segments=4, rule="naive", integrator=["rk4", "leapfrog"],
        static_load=["tip_force", "tip_moment"], compute=["stable_time_step", "tip_deflection_error"],
    ).run()  # fmt: skip
    ratio = table.stable_time_step.sel(integrator="rk4") / table.stable_time_step.sel(integrator="leapfrog")
    np.testing.assert_allclose(ratio, math.sqrt(2), rtol=1e-14)  # limits 2 sqrt 2 and 2
    # static_dataset's own example: 0.40625 under a tip force; a chain of equal springs under a moment turns
    # 1/N more than the beam and so deflects (N + 1)/N as much.
    np.testing.assert_allclose(table.tip_deflection_error.isel(integrator=0), [0.40625, 0.25], rtol=1e-14)


def test_points_run_together() -> None:
    points = {"boundary": ["clamped-free", "free-pinned"], "segments": [4, 9], "rule": ["naive", "gregory"]}
    table = bm.Study.points(points, mode=[1, 2], compute="relative_error").run()
    assert list(table.boundary.values) == ["clamped-free", "pinned-free"]  # the firmer end first
    assert dict(table.sizes) == {"point": 2, "mode": 2} and list(table.segments.values) == [4, 9]
    for i in range(2):
        ends, segments, rule = (points[name][i] for name in points)
        expected = [bm.frequency_error(ends, segments=segments, mode=m, rule=rule) for m in (1, 2)]  # type: ignore[arg-type, call-overload]
        np.testing.assert_allclose(table.relative_error[i], expected, rtol=1e-12)
    each = bm.Study.points(points | {"mode": [2, 1]}, compute="relative_error").run()
    np.testing.assert_allclose(each.relative_error, np.diag(table.relative_error[:, ::-1]), rtol=1e-12)


def sampled(count: int, chunk: int, seed: int = 5) -> bm.Study:
    return bm.Study.sampled(
        count, seed=seed, boundary="clamped-free", segments=[3, 4], mode=[1, 2], chunk=chunk,
        **STRIP | {"height": bm.Normal(0.002, 1e-4), "right_mass": bm.Uniform(0.0, 0.1)},
        compute=["angular_frequency", "relative_error"],
    )  # fmt: skip


def test_samples_do_not_depend_on_chunks_or_count() -> None:
    whole = sampled(12, 100).run()
    for other in (sampled(12, 5).run(), sampled(20, 7).run().isel(sample=slice(12))):
        assert (other.height == whole.height).all() and (other.right_mass == whole.right_mass).all()
        np.testing.assert_allclose(other.angular_frequency, whole.angular_frequency, rtol=1e-13)
    assert not (sampled(12, 100, seed=6).run().height == whole.height).any()
    # What is computed belongs to the values that the coordinates show.
    mass, height = float(whole.right_mass[7]), float(whole.height[7])
    solved = bm.solve_modes(bm.linearize(bm.Chain(strip(height), f"clamped-free(mass={mass!r})", 4)), 2)
    found = whole.angular_frequency.isel(sample=7).sel(segments=4)
    np.testing.assert_allclose(found, solved.angular_frequency, rtol=1e-10)


def test_ends_keep_their_sides_where_numbers_tell_them_apart() -> None:
    for name in ("free-clamped", "free-clamped(mass=0.1)"):
        turned = bm.Study.grid(
            boundary=name, segments=4, mode=1, left_mass=[0.5], compute="relative_error"
        ).run()
        assert turned.boundary == name
        expected = bm.frequency_error("clamped-free(mass=0.5)", segments=4, mode=1)
        np.testing.assert_allclose(turned.relative_error, expected, atol=1e-13)


def test_default_chunks_are_of_a_size() -> None:
    # 25,000 numbers of the closed form, 5000 roots, 500 solved ones; at most 5000, 1000 or 100 points.
    for changes, expected in (
        ({}, 5000),
        ({"mode": range(1, 6)}, 5000),
        ({"mode": range(1, 11)}, 2500),
        ({"mode": range(1, 10**5)}, 1),
        ({"right_mass": 0.5}, 1000),
        ({"right_mass": 0.5, "mode": range(1, 11)}, 500),
        ({"right_mass": 0.5, "rule": "simpson"}, 100),
        ({"right_mass": 0.5, "spin_rate": 0.5, "mode": range(1, 11)}, 50),
        ({"compute": "stable_time_step"}, 100),
    ):
        assert bm.Study.grid(**{**GOOD, **changes}).chunk == expected


@pytest.mark.parametrize("chunk", [1, 3, 10**6])
def test_chunks_change_nothing(chunk: int) -> None:
    grid = {"boundary": ["clamped-free", "guided-free"], "segments": [1, 5, 9], "mode": [1, 2, 3]}
    study = bm.Study.grid(**grid, compute="relative_error", chunk=chunk)
    assert study.chunks == -(-6 // chunk)
    whole = bm.Study.grid(**grid, compute="relative_error").run().relative_error
    np.testing.assert_allclose(study.run().relative_error, whole, rtol=1e-12)


def test_records_of_the_users_own_rules() -> None:
    own = bm.Rule(**{**vars(bm.RULES["mitiguy"]), "name": "own", "clamped": bm.RULES["gregory"].clamped})
    table = bm.Study.grid(
        boundary="clamped-free", segments=6, mode=1, rule=[own, "gregory", bm.mode_tuned(1)],
        compute="relative_error",
    ).run()  # fmt: skip
    assert list(table.rule.values) == ["own", "gregory", "mode_tuned(1)"]
    assert table.relative_error[0] == table.relative_error[1]
    expected = bm.frequency_error("clamped-free", segments=6, mode=1, rule=bm.mode_tuned(1))
    np.testing.assert_allclose(table.relative_error[2], expected, rtol=1e-12)
    changed = bm.Rule(**{**vars(own), "clamped": bm.RULES["naive"].clamped})
    studies = [
        bm.Study.grid(boundary="clamped-free", segments=6, mode=1, rule=rule, compute="relative_error")
        for rule in (own, changed)
    ]
    assert studies[0].digest != studies[1].digest


def test_cases_without_an_answer_are_nan_and_say_why() -> None:
    # Beyond Euler's load, pi^2/4 for L = EI = 1, there is no vibration about the straight beam.
    table = bm.Study.grid(
        boundary="clamped-free", segments=[3, 4], mode=1, axial_force=[-2.0, -3.0], compute="relative_error"
    ).run()
    assert np.isnan(table.relative_error).values.tolist() == [[False, True], [False, True]]
    assert "buckl" in table.reasons and table.failed_cases == 2
    said = table.reason.values
    assert said[:, 0].tolist() == ["", ""] and all("buckl" in text for text in said[:, 1])
    plain = bm.Study.grid(boundary="clamped-free", segments=3, mode=1, compute="relative_error").run()
    assert (plain.reasons, plain.failed_cases) == ("", 0) and "reason" not in plain


def test_one_bad_point_takes_no_answer_from_those_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    # One call of the closed form serves all points that differ in N alone.
    def fails_at_seven(*given: Any) -> Any:
        if 7 in np.asarray(given[1]):
            raise ZeroDivisionError("by seven")
        return errors_in_multiples(*given)

    grid = {"boundary": "clamped-free", "segments": range(5, 10), "mode": [1, 2], "compute": "relative_error"}
    whole = bm.Study.grid(**grid).run()
    monkeypatch.setattr("beammodes.accuracy.lookups.errors_in_multiples", fails_at_seven)
    table = bm.Study.grid(**grid).run()
    assert table.reason.values.tolist() == ["", "", "ZeroDivisionError: by seven", "", ""]
    others = [0, 1, 3, 4]
    assert np.isnan(table.relative_error[2]).all()
    np.testing.assert_allclose(table.relative_error[others], whole.relative_error[others], rtol=1e-12)


def test_a_section_that_cannot_exist_has_no_errors_either() -> None:
    table = bm.Study.grid(
        **TUBE, wall=[0.001, 0.006], boundary="clamped-free", segments=3, mode=1, compute="relative_error"
    ).run()
    assert np.isnan(table.relative_error).values.tolist() == [False, True]
    assert "wall" in table.reasons


def test_rules_that_differ_in_late_digits_or_numbers_are_told_apart() -> None:
    @dataclass(frozen=True, eq=False)
    class Sampled:
        springs: np.ndarray
        name: str = "sampled"
        rotary_inertia: Fraction = Fraction(1, 12)

        def piece_lengths(self, _boundary: bm.Boundary, segments: int) -> list[Fraction]:
            return [Fraction(1)] * segments

        def hinge_weights(self, _boundary: bm.Boundary, segments: int) -> list[float]:
            return list(self.springs[:segments])

    springs = np.ones(3000)
    late, middle = springs.copy(), springs.copy()
    late[0] += 1e-12
    middle[1500] = 2.0  # NumPy shows the ends of a long array alone
    digests = {
        bm.Study.grid(boundary="clamped-free", segments=4, rule=Sampled(s), compute="stable_time_step").digest
        for s in (springs, late, middle)
    }
    assert len(digests) == 3


def forgetful(_case: bm.Case) -> float:
    return None  # type: ignore[return-value]


def test_a_function_must_return_a_number() -> None:
    study = bm.Study.grid(boundary="clamped-free", segments=[3], right_mass=[0.5], compute=forgetful)
    with pytest.raises(TypeError, match="forgetful must return a real number, got None") as caught:
        study.run()
    assert caught.value.__notes__ == [
        "met in a study, at boundary clamped-free, segments 3, right_mass 0.5, rule mitiguy"
    ]


FAILURES: list[Exception] = [
    ValueError("no such beam"),
    ZeroDivisionError("float division by zero"),
    OverflowError("too large"),
    FloatingPointError("underflow"),
    decimal.InvalidOperation("NaN"),
    IndexError("mode 9"),
    RuntimeError("no convergence\nafter 50 steps"),
    np.linalg.LinAlgError("singular"),
]


@pytest.mark.parametrize("store", [False, True])
@pytest.mark.parametrize("error", FAILURES, ids=lambda error: type(error).__name__)
def test_one_bad_point_does_not_stop_a_study(tmp_path: Path, error: Exception, store: bool) -> None:
    def fails_once(case: bm.Case) -> float:
        if case.segments == 4:
            raise error
        return float(case.segments)

    study = bm.Study.grid(boundary="clamped-free", segments=range(2, 8), compute=fails_once, chunk=2)
    table = study.run(store=tmp_path if store else None)
    np.testing.assert_array_equal(table.fails_once, [2, 3, np.nan, 5, 6, 7])
    assert table.failed_cases == 1 and table.complete == 1
    # What an error says of itself, behind its name unless it is a plain ValueError.
    name = "" if type(error) is ValueError else f"{type(error).__name__}: "
    expected = name + str(error).replace("\n", " ")
    assert table.reason.values.tolist() == ["", "", expected, "", "", ""]
    if store:
        assert bm.open_study(tmp_path).identical(table)


def test_the_closing_line_says_how_many_points_failed(capsys: pytest.CaptureFixture[str]) -> None:
    def fails(case: bm.Case) -> float:
        return 1.0 / (case.segments - 3)

    study = bm.Study.grid(boundary="clamped-free", segments=[2, 3, 4], compute=fails)
    study.run(progress=True)
    said = capsys.readouterr().err.splitlines()
    assert said[-1] == "study: 1 of 3 cases have no answer: ZeroDivisionError: float division by zero"
    bm.Study.grid(boundary="clamped-free", segments=[2, 4], compute=fails).run(progress=True)
    assert "no answer" not in capsys.readouterr().err


@pytest.mark.parametrize("error", [NameError, TypeError, AttributeError, ImportError, MemoryError])
def test_a_faulty_function_stops_the_study_and_names_the_case(error: type[Exception]) -> None:
    def broken(case: bm.Case) -> float:
        raise error(str(case.segments))

    study = bm.Study.grid(boundary="clamped-free", segments=[7], compute=broken)
    with pytest.raises(error, match="7") as caught:
        study.run()
    assert any("segments" in note for note in caught.value.__notes__)


@pytest.mark.parametrize("name", [*AXES, *QUANTITIES, "point", "sample", "case", "reason"])
def test_a_function_under_a_taken_name_is_refused_at_once(name: str) -> None:
    def own(case: bm.Case) -> float:
        return float(case.segments)

    own.__name__ = own.__qualname__ = name
    with pytest.raises(ValueError, match=f"compute must be .* names of their own, got {name}, which is"):
        bm.Study.grid(boundary="clamped-free", segments=[2, 3], compute=own)


GOOD = {"boundary": "clamped-free", "segments": 5, "mode": 1, "compute": "relative_error"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"segment": 3}, 'did you mean "segments"'),
        ({"segments": []}, "segments must name at least one"),
        ({"segments": [1, 2.5]}, "segments must be a whole number"),
        ({"segments": 0}, "segments must be .* at least 1 .*, got 0"),
        ({"mode": [1, -1]}, "mode must be"),
        ({"boundary": "clampd-free"}, 'did you mean "clamped-free"'),
        ({"rule": "mitigy"}, 'did you mean "mitiguy"'),
        ({"compute": "relative_eror"}, 'did you mean "relative_error"'),
        ({"compute": []}, "compute must name at least one"),
        ({"compute": ["relative_error"] * 2}, "each quantity once"),
        ({"compute": lambda _: 1.0}, "functions that def makes"),
        ({"compute": math.sqrt}, "functions that def makes"),
        ({"compute": 3}, "compute must be one of"),
        ({"right_mass": [0.1, math.nan]}, "right_mass: mass must be finite"),
        ({"right_mass": -0.1}, "right_mass: mass must not be negative"),
        ({"spin_rate": "fast"}, "spin_rate: .* real number"),
        ({"height": 0.1}, "leave out height"),
        ({"section": "rectangle"}, "include length"),
        ({**STRIP, "section": ["rectangle", "box"]}, "include wall"),
        ({"section": "rectangel"}, 'did you mean "rectangle"'),
        ({**STRIP, "diameter": 0.1}, "leave out diameter"),
        ({**STRIP, "density": 0.0}, "density must be greater than 0"),
        ({**TUBE, "inner": 0.008, "wall": 0.001}, "one of inner and wall for a tube, got inner, wall"),
        (TUBE, "one of inner and wall for a tube, got none"),
        ({"length": 2.0}, "include bending_stiffness"),
        ({"height": bm.Normal(1.0, 0.1)}, "height must not be a distribution"),
        ({"chunk": 0}, "chunk must be"),
        (
            {"segments": range(1, 10**5), **dict.fromkeys(("right_mass", "axial_force"), range(10**4))},
            "1e.12",
        ),
        ({"segments": range(1, 10**12)}, "segments must have at most 1000000 values"),
        ({"mode": iter(int, 1)}, "mode must have at most 1000000 values"),
        ({"plane": "flat"}, 'did you mean "flap"'),
        ({"right_inertia": 1.0}, "leave out right_inertia for motion bending"),
        ({"motion": "twist", "right_mass": 1.0}, "leave out right_mass for motion twist"),
        ({"motion": "twist", "right_stiffness": -1.0}, "right_stiffness: stiffness must not be negative"),
        ({"motion": "twist", "boundary": "pinned-free"}, "pinned says what bending may do, not twist"),
    ],
)
def test_bad_studies_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        bm.Study.grid(**{**GOOD, **change})


@pytest.mark.parametrize("missing", ["boundary", "segments", "mode"])
def test_what_a_study_needs(missing: str) -> None:
    rest = {name: value for name, value in GOOD.items() if name != missing}
    with pytest.raises(ValueError, match=f"axes must include {missing} here"):
        bm.Study.grid(**rest)


def test_bad_points_and_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="one length"):
        bm.Study.points({"segments": [1, 2], "mode": [1]}, boundary="free-free", compute="relative_error")
    with pytest.raises(TypeError, match="points must map"):
        bm.Study.points([1, 2], boundary="free-free", compute="relative_error")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="each axis must be given once, got segments"):
        bm.Study.points({"segments": [1, 2]}, segments=3, boundary="free-free", compute="stable_time_step")
    with pytest.raises(ValueError, match="must have an axis with a distribution"):
        bm.Study.sampled(3, seed=1, **GOOD)
    with pytest.raises(TypeError, match="segments must be values"):
        bm.Study.sampled(3, seed=1, **GOOD | {"segments": bm.Uniform(1, 9)})
    with pytest.raises(ValueError, match="height must be greater than 0"):
        bm.Study.sampled(3, seed=1, **GOOD, **STRIP | {"height": bm.Normal(0.002, 0.001)})
    with pytest.raises(ValueError, match="seed must be"):
        bm.Study.sampled(3, seed=-1, **GOOD, right_mass=bm.Uniform(0.0, 1.0))


@given(
    name=st.sampled_from(sorted(AXES)),
    value=st.one_of(
        st.none(),
        st.booleans(),
        st.floats(),
        st.integers(),
        st.text(max_size=5),
        st.lists(st.floats(), max_size=3),
    ),
)
@settings(deadline=None, max_examples=200)
def test_whatever_comes_is_taken_or_refused_by_name(name: str, value: object) -> None:
    try:
        study, message = bm.Study.grid(**{**GOOD, name: value}), ""
    except (TypeError, ValueError) as error:
        study, message = None, str(error)
    if study is None:
        # A section or a length alone lacks others; a boundary is named by its ends, too.
        words = (name, "axes must", *(("end must",) if name == "boundary" else ()))
        assert any(word in message for word in words), message
    else:
        assert study.size >= 1


def test_results_are_written_and_read_back(tmp_path: Path) -> None:
    import xarray

    table = sampled(3, 100).run()
    table.to_netcdf(tmp_path / "table.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "table.nc", engine="h5netcdf") as found:
        assert found.identical(table)
