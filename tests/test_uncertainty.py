"""What a beam's tolerances leave open: Monte Carlo against first-order laws, and enough segments."""

from __future__ import annotations

import math
import re
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray
from computed_studies import computed
from hypothesis import given, settings
from hypothesis import strategies as st
from turns import in_turns

import beammodes as bm
from beammodes.accuracy.uncertainty import EnoughSegments
from studies import uncertainty

PAGE = Path(__file__).parent.parent / "beammodes" / "pages" / "rules.md"
BAR = bm.Rectangle(width=0.06, height=0.02)
STEEL: dict[str, Any] = {"elastic_modulus": 207e9, "density": 7850.0, "length": 1.0}


def spread_of(tolerances: Any, **arguments: Any) -> xarray.Dataset:
    section, boundary = arguments.pop("section", BAR), arguments.pop("boundary", "clamped-free")
    return bm.frequency_spread(section, boundary, tolerances, **(STEEL | arguments))


@pytest.mark.parametrize(
    ("boundary", "distribution"),
    in_turns(["clamped-free", "clamped-clamped"], ["uniform", "normal"], every=2),
)
def test_monte_carlo_is_the_first_order_law_of_a_rectangle(boundary: str, distribution: str) -> None:
    sizes = {"elastic_modulus": 0.02, "density": 0.01, "height": 0.015, "length": 0.004, "width": 0.03}
    tolerances = {name: bm.Tolerance(size, distribution) for name, size in sizes.items()}
    spread = spread_of(tolerances, boundary=boundary, samples=8_000)
    # omega ~ sqrt(E h²/rho)/L² of a rectangle, by hand; a uniform distribution of half width a has a/√3.
    e, rho, h, length = (sizes[name] for name in ("elastic_modulus", "density", "height", "length"))
    by_hand = math.sqrt(e**2 / 4 + rho**2 / 4 + h**2 + 4 * length**2)
    by_hand /= math.sqrt(3) if distribution == "uniform" else 1
    np.testing.assert_allclose(spread.first_order, by_hand, rtol=1e-6)
    # Second-order terms are some σ² = 4e-4 of it; the rest is chance, four standard errors of it.
    away = np.abs(spread.standard_deviation - by_hand)
    assert (away < 4 * spread.standard_deviation_error + 1e-3 * by_hand).all()
    assert (spread.standard_deviation_error < 0.01 * by_hand).all()
    exponents = {"elastic_modulus": 0.5, "density": -0.5, "height": 1.0, "length": -2.0, "width": 0.0}
    for name, exponent in exponents.items():
        np.testing.assert_allclose(spread.sensitivity.sel(parameter=name), exponent, atol=1e-6)
    # A plain beam's frequencies share one factor: all modes spread alike.
    np.testing.assert_allclose(spread.half_width, spread.half_width[0], rtol=1e-9)


def test_the_standard_error_is_that_of_repeated_runs() -> None:
    runs = [spread_of({"height": 0.03}, samples=100, modes=1, seed=seed) for seed in range(60)]
    found = np.std([float(run.standard_deviation[0]) for run in runs], ddof=1)
    stated = np.mean([float(run.standard_deviation_error[0]) for run in runs])
    # 60 runs know their own scatter to 1/√120 = 9 %.
    assert found == pytest.approx(stated, rel=0.3)


def test_quantiles_of_one_uniform_tolerance_are_known() -> None:
    # omega ~ h: a uniform h gives a uniform omega, its 95 % band 0.95 of the whole.
    levels = [0.025, 0.25, 0.5, 0.975]
    spread = spread_of({"height": 0.04}, samples=8_000, quantiles=levels, modes=2)
    exact = spread.frequency.values * (1 + 0.04 * (2 * np.array(levels)[:, None] - 1))
    # Standard error of a quantile p of n: width √(p(1-p)/n), at most 0.08 x 0.5/√8000 = 4.5e-4.
    np.testing.assert_allclose(spread.frequency_quantile, exact, rtol=4 * 4.6e-4)
    np.testing.assert_allclose(spread.half_width, 0.95 * 0.04, rtol=0.02)
    nominal = bm.euler_bernoulli(bm.Beam.from_section(BAR, **STEEL), "clamped-free", 2).frequency
    np.testing.assert_allclose(spread.frequency, nominal, rtol=1e-14)


def test_ends_with_bodies_and_springs() -> None:
    # A heavy body on a light beam: omega² = 3EI/(m L³) but for the beam's mass, so density hardly matters.
    heavy = (bm.ENDS["clamped"], bm.End(mass=1e3))
    sizes = {"elastic_modulus": 0.02, "density": 0.05, "height": 0.01, "width": 0.02, "length": 0.002}
    spread = spread_of(sizes, boundary=heavy, modes=1, samples=100)
    # omega ~ sqrt(E b h³/L³): exponents by hand; the beam's own 9.4 kg are 33/140 x 0.94 % of the body.
    exponents = {"elastic_modulus": 0.5, "density": 0.0, "height": 1.5, "width": 0.5, "length": -1.5}
    for name, exponent in exponents.items():
        assert float(spread.sensitivity.sel(parameter=name)[0]) == pytest.approx(exponent, abs=3e-3)
    by_hand = math.sqrt(sum((exponents[name] * size) ** 2 for name, size in sizes.items()) / 3)
    assert float(spread.first_order[0]) == pytest.approx(by_hand, rel=1e-2)
    # A hundred samples know a standard deviation to 6 %.
    assert float(spread.standard_deviation[0]) == pytest.approx(by_hand, rel=0.3)
    enough = bm.segments_within_spread(spread, "mitiguy")
    beam = bm.Beam.from_section(BAR, **STEEL)
    error = bm.chain_errors(bm.Chain(beam, heavy, enough.segments), modes=1)
    assert enough.largest_error == pytest.approx(abs(error[0]), abs=1e-10)


@pytest.mark.parametrize(
    ("section", "tolerances"),
    [
        (bm.Circle(0.02), {"diameter": 0.01}),
        (bm.Tube(0.05, wall=0.002), {"outer": 0.01, "wall": 0.1}),
        (bm.Box(0.04, 0.06, 0.003), {"width": 0.01, "height": 0.02, "wall": 0.1}),
        (bm.ISection(0.1, 0.2, 0.0085, 0.0056), {"flange": 0.05, "web": 0.1, "height": 0.01}),
        (bm.GivenSection(28.5e-4, 1943e-8, 142e-8), {"area": 0.03, "second_moment": 0.05}),
    ],
)
def test_every_section_has_its_tolerances(section: Any, tolerances: dict[str, float]) -> None:
    spread = spread_of(tolerances, section=section, samples=1500, modes=1)
    away = abs(float(spread.standard_deviation[0] - spread.first_order[0]))
    assert away < 4 * float(spread.standard_deviation_error[0]) + 0.01 * float(spread.first_order[0])
    # By hand: ln omega = ½ ln I - ½ ln A + ..., by a wider difference of the section's own numbers.
    for name in tolerances:
        sizes = {n: getattr(section, n) for n in section.__dataclass_fields__ if n != "inner"}
        low, high = (type(section)(**(sizes | {name: sizes[name] * (1 + d)})) for d in (-1e-3, 1e-3))
        steep = math.log(high.second_moment / low.second_moment / (high.area / low.area)) / 2
        found = float(spread.sensitivity.sel(parameter=name)[0])
        assert found == pytest.approx(steep / math.log(1.001 / 0.999), abs=1e-4)


def test_a_section_from_elsewhere_has_material_tolerances_only() -> None:
    foreign = SimpleNamespace(area=1e-3, second_moment=1e-8)
    assert float(spread_of({"length": 0.01}, section=foreign, samples=100).first_order[0]) == pytest.approx(
        0.02 / math.sqrt(3), rel=1e-6
    )
    with pytest.raises(
        ValueError, match="name of a tolerance must be one of elastic_modulus, density, length"
    ):
        spread_of({"height": 0.01}, section=foreign)


def test_the_same_seed_gives_the_same_numbers() -> None:
    one, again, other = (spread_of({"height": 0.02}, samples=200, seed=seed) for seed in (3, 3, 4))
    xarray.testing.assert_identical(one, again)
    assert float(other.half_width[0]) != float(one.half_width[0])
    assert one.attrs["seed"] == 3 and one.attrs["samples"] == 200
    assert one.attrs["tolerances"] == "height uniform ±2 %"
    assert bm.Boundary.of(one.attrs["boundary"]) == bm.Boundary.of("clamped-free")


def test_a_study_draws_the_same_beams() -> None:
    sizes = {"height": bm.Tolerance(0.02), "elastic_modulus": bm.Tolerance(0.03, "normal")}
    levels, seed = [0.0, 0.1, 0.5, 1.0], 11
    spread = spread_of(sizes, samples=300, seed=seed, quantiles=levels, modes=2)
    nominal = {"width": BAR.width, "height": BAR.height, **STEEL}
    drawn = nominal | {name: part.around(nominal[name]) for name, part in sizes.items()}
    study = bm.Study.sampled(
        300,
        seed=seed,
        boundary="clamped-free",
        segments=1,
        mode=[1, 2],
        section="rectangle",
        compute="exact_angular_frequency",
        **drawn,
    )
    hertz = study.run(progress=False).exact_angular_frequency.sel(mode=1) / (2 * math.pi)
    found = np.quantile(hertz, levels)
    np.testing.assert_allclose(spread.frequency_quantile.sel(mode=1), found, rtol=1e-12)


def test_progress_is_told() -> None:
    told: list[tuple[int, int]] = []
    spread_of({"height": 0.02}, samples=250, progress=lambda done, total: told.append((done, total)))
    assert told == [(100, 250), (200, 250), (250, 250)]


@pytest.mark.parametrize("rule", ["mitiguy", "gregory"])
@pytest.mark.parametrize("fraction", [1 / 3, 1.0])
def test_enough_is_enough_and_one_less_is_not(rule: str, fraction: float) -> None:
    spread = spread_of({"height": 0.025, "elastic_modulus": 0.02}, samples=500)
    enough = bm.segments_within_spread(spread, rule, fraction=fraction)
    limit = fraction * float(spread.half_width.min())
    assert enough.half_width == float(spread.half_width.min()) and enough.fraction == fraction

    def worst(count: int) -> float:
        errors = bm.chain_errors(bm.Chain(bm.Beam.unit(), "clamped-free", count, rule), 3)
        return float(np.abs(errors).max())

    # Another route than the closed form that the answer comes from: eigenvalues of the chains.
    assert worst(enough.segments) == pytest.approx(enough.largest_error, abs=1e-10)
    assert worst(enough.segments) <= limit < worst(enough.segments - 1)


def test_the_answer_says_itself() -> None:
    text = str(EnoughSegments("gregory", 9, 3, 0.0041, 0.0237, 1 / 3))
    assert text.startswith(
        "9 segments by rule gregory are enough: their error in modes 1 to 3, at most 0.41 %"
    )
    assert text.endswith("below 33 % of what the beam itself leaves open, ±2.4 % (95 %)")
    assert "in mode 1," in str(EnoughSegments("gregory", 9, 1, 0.0041, 0.0237, 1.0))


@settings(max_examples=30)
@given(st.floats() | st.integers() | st.text(max_size=3) | st.none() | st.booleans())
def test_sizes_of_tolerances_are_checked(size: Any) -> None:
    for distribution, widest in (("uniform", 1.0), ("normal", 0.1)):
        sound = isinstance(size, int | float) and not isinstance(size, bool) and 0 < size <= widest
        if sound and size != 1.0:
            assert bm.Tolerance(size, distribution).size == size
        else:
            with pytest.raises((TypeError, ValueError), match="size must be"):
                bm.Tolerance(size, distribution)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"tolerances": {}}, ValueError, "tolerances must name at least one of elastic_modulus"),
        ({"tolerances": 0.1}, TypeError, "tolerances must map names to numbers, got 0.1"),
        ({"tolerances": {"hight": 0.1}}, ValueError, r'got \'hight\' \(did you mean "height"\?\)'),
        ({"tolerances": {"height": -0.1}}, ValueError, "tolerance of height: size must be greater than 0"),
        ({"tolerances": {"height": "1 %"}}, TypeError, "tolerance of height: size must be a real number"),
        ({"tolerances": {"height": math.nan}}, ValueError, "tolerance of height: size must be finite"),
        ({"samples": 99}, ValueError, "samples must be a whole number of at least 100"),
        (
            {"samples": 10**7},
            ValueError,
            "samples must be a whole number of at least 100 and at most 1000000",
        ),
        ({"samples": 1e3}, TypeError, "samples must be a whole number"),
        ({"seed": -1}, ValueError, "seed must be a whole number of at least 0"),
        ({"quantiles": 0.5}, TypeError, "quantiles must be numbers between 0 and 1"),
        ({"quantiles": []}, ValueError, "quantiles must be numbers between 0 and 1"),
        ({"quantiles": [0.5, 97.5]}, ValueError, "quantiles must be numbers between 0 and 1"),
        ({"modes": 0}, ValueError, "modes must be"),
        ({"modes": 101}, ValueError, "modes must be a whole number of at least 1 and at most 100"),
        ({"density": 0.0}, ValueError, "density must be greater than 0"),
        ({"length": math.inf}, ValueError, "length must be finite"),
        ({"elastic_modulus": "steel"}, TypeError, "elastic_modulus must be a real number"),
        ({"boundary": "clamped-fre"}, ValueError, "boundary must name two of the ends"),
        ({"section": 3.0}, TypeError, "section must have its area, got 3.0"),
        (
            {"section": bm.Tube(0.05, wall=0.024), "tolerances": {"wall": 0.3}},
            ValueError,
            "wall must be less than half the outer diameter",
        ),
    ],
)
def test_bad_input(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    given_arguments = {"tolerances": {"length": 0.01}} | arguments
    with pytest.raises(error, match=message):
        spread_of(given_arguments.pop("tolerances"), **given_arguments)


def test_bad_input_of_the_count() -> None:
    spread = spread_of({"height": 0.02}, samples=100, modes=1)
    with pytest.raises(TypeError, match=r"spread must be a Dataset from frequency_spread\(\), got 'float'"):
        bm.segments_within_spread(0.02)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="spread must be a Dataset from frequency_spread"):
        bm.segments_within_spread(bm.error_dataset(boundary="clamped-free", segments=3, modes=1))
    for fraction in (0.0, -1.0, math.nan, 1.5):
        with pytest.raises(ValueError, match="fraction must be"):
            bm.segments_within_spread(spread, fraction=fraction)
    with pytest.raises(ValueError, match='did you mean "gregory"'):
        bm.segments_within_spread(spread, "gregori")
    with pytest.raises(ValueError, match="distribution must be one of uniform, normal"):
        bm.Tolerance(0.1, "unifrom")


@pytest.fixture(scope="module")
def table() -> xarray.Dataset:
    return computed("uncertainty")


def test_the_study_takes_the_reports_ranges() -> None:
    tolerances = {name: bar.tolerances["elastic_modulus"] for name, bar in uncertainty.BARS.items()}
    # The report: "Wood 1-2 million", so 1.5 ± 1/3 of it; "Steel 30 million", rounded to whole millions.
    assert tolerances == pytest.approx({"wooden board": 1 / 3, "rolled steel bar": 0.5 / 30})
    wood = uncertainty.BARS["wooden board"].numbers["elastic_modulus"]
    assert wood == pytest.approx(1.5 * bm.elastic_modulus("wood", at=0.0))


@pytest.mark.slow
def test_the_study_marks_where_the_error_is_hidden(table: xarray.Dataset) -> None:
    for beam in table.beam.values:
        for boundary in table.boundary.values:
            one = table.sel(beam=beam, boundary=boundary)
            hidden = float(one.narrowest[0]) / 3
            for rule in table.rule.values:
                worst = np.abs(one.relative_error.sel(rule=rule)).max("mode", skipna=False)
                inside = one.segments.values[(worst <= hidden).values]
                assert int(one.segments_enough.sel(rule=rule)) == inside.min()
                assert len(inside) == one.segments.values[-1] - inside.min() + 1
            assert "gregory are enough" in str(one.said.sel(rule="gregory").values)
    # Monte Carlo beside the first-order law of a rectangle: within chance and second order.
    away = np.abs(table.standard_deviation / table.first_order - 1)
    assert (away < 4 * table.standard_deviation_error / table.first_order + table.first_order**2).all()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = uncertainty.STUDY.picture(table)
        figure.draw_without_rendering()
    marks = [text.get_text() for ax in figure.axes for text in ax.texts if ":" in text.get_text()]
    assert marks == [
        f"{rule}: {int(count.sel(rule=rule))}"
        for count in table.segments_enough.stack(panel=("beam", "boundary")).transpose("panel", "rule")
        for rule in table.rule.values
    ]


def test_the_page_says_what_the_study_found(table: xarray.Dataset) -> None:
    (part,) = re.findall(r"## Fewer segments.*?!\[", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    cantilever = table.sel(boundary="clamped-free")
    for beam in table.beam.values:
        one = cantilever.sel(beam=beam)
        assert f"±{100 * float(one.half_width.max()):.2g} %" in part
    few = cantilever.segments_enough
    wood = {rule: int(few.sel(beam="wooden board", rule=rule)) for rule in ("mitiguy", "gregory")}
    steel = [int(few.sel(beam="rolled steel bar", rule=rule)) for rule in ("mitiguy", "gregory")]
    assert f"need {wood['mitiguy']} segments with the report's springs and {wood['gregory']} by" in part
    assert f": {steel[0]} and {steel[1]}." in part
