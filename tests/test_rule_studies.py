"""The studies of the rules say what physics says: numbers against named sources, drawings against data."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import xarray
from computed_studies import computed

import beammodes as bm
from studies import error_by_rule, segments_map
from studies.common import element_errors

pytest.importorskip("skfem")

STUDIES = ("error_by_rule", "better_figures", "segments_map", "cost_front")

#: Segments for 1 % in the first three modes. Source: eigen-solves of the chains with these N and one segment
#: less, repeated below; no study uses them.
FOR_ONE_PERCENT = {
    ("clamped-free", "mitiguy"): 16,
    ("clamped-free", "gregory"): 8,
    ("clamped-clamped", "mitiguy"): 26,
    ("clamped-clamped", "gregory"): 12,
}


@pytest.fixture(scope="module", params=STUDIES)
def study(request: pytest.FixtureRequest) -> tuple[str, xarray.Dataset]:
    return request.param, computed(request.param)


@pytest.fixture(scope="module")
def by_rule() -> xarray.Dataset:
    return computed("error_by_rule")


@pytest.fixture(scope="module")
def costs() -> xarray.Dataset:
    return computed("cost_front")


def test_no_rounding_is_published(study: tuple[str, xarray.Dataset]) -> None:
    for name, values in study[1].data_vars.items():
        if "error" in str(name):
            size = np.abs(values.values)
            assert not ((size > 0) & (size < 1e-12)).any()


@pytest.mark.parametrize(("boundary", "rule", "needed"), [(*key, n) for key, n in FOR_ONE_PERCENT.items()])
def test_segments_for_one_percent(by_rule: xarray.Dataset, boundary: str, rule: str, needed: int) -> None:
    assert by_rule.segments_needed.sel({"boundary": boundary, "marked": rule, "tolerance": 0.01}) == needed
    curve = by_rule.largest_error.sel({"boundary": boundary, "method": rule})
    assert curve.sel(segments=needed) <= 0.01 < curve.sel(segments=needed - 1)
    exact = bm.euler_bernoulli(bm.Beam.unit(), boundary, 3).angular_frequency
    for count in (needed, needed - 1):
        chain = bm.Chain(bm.Beam.unit(), boundary, count, rule)
        solved = bm.solve_modes(bm.linearize(chain), modes=3).angular_frequency / exact - 1
        assert float(curve.sel(segments=count)) == pytest.approx(np.abs(solved).max(), rel=1e-9)


def test_rods_and_elements_for_a_thousandth_of_a_percent(by_rule: xarray.Dataset) -> None:
    needed = by_rule.segments_needed.sel(boundary="clamped-free").to_series().to_dict()
    beta = 7.8547574382  # third root of cos β cosh β = -1
    sigma = (np.sinh(beta) - np.sin(beta)) / (np.cosh(beta) + np.cos(beta))
    # theory.md section 4: e ~ (1 - σβ)/(3 N²).
    assert needed["mitiguy", 1e-5] == pytest.approx(((sigma * beta - 1) / 3e-5) ** 0.5, abs=1)
    assert needed["mitiguy", 1e-5] == 478
    # The leading term of test_elements_converge_as_cubic_elements_do asks for 22.7.
    assert needed["cubic finite elements", 1e-5] == 23
    assert needed["cubic finite elements", 1e-2] == 4


def test_first_mode_at_ten_segments(costs: xarray.Dataset) -> None:
    # theory.md section 5, percent in mode 1, which bounds the largest of three modes from below.
    known = {"mitiguy": 0.126, "naive": 9.11, "double_wall": 0.457, "hencky": 0.84, "half_stub": 0.230}
    for rule, percent in (known | {"rigid_stub": 11.1, "gregory": 0.0005}).items():
        error = 100 * abs(bm.frequency_error("clamped-free", segments=10, mode=1, rule=rule))
        assert error == pytest.approx(percent, rel=0.03)
        assert 100 * costs.largest_error.sel(rule=rule, segments=10) >= error * (1 - 1e-9)
    # naive errs most in mode 1: there the curve is the table's number itself.
    assert 100 * float(costs.largest_error.sel(rule="naive", segments=10)) == pytest.approx(9.11, abs=5e-3)


def test_elements_converge_as_cubic_elements_do() -> None:
    # Cubic interpolation of a mode misses curvature by φ⁗ h² (t² - t + 1/6)/2 along an element; by Rayleigh
    # ω² is too high by the mean square of that, (β h)⁴/720.
    beta = np.array([1.8751040687, 4.6940911330, 7.8547574382])
    errors = element_errors("clamped-free", 24)
    assert errors[1:] == pytest.approx((beta[1:] / 24) ** 4 / 1440, rel=0.05)


def test_better_figures() -> None:
    error = computed("better_figures").relative_error
    report = 100 * error.sel(rule="mitiguy", segments=10)
    # theory.md section 3, the row N = 10.
    assert report.sel(boundary="clamped-free").values == pytest.approx([-0.126, -1.251, -2.264], abs=6e-4)
    assert report.sel(boundary="clamped-clamped").values == pytest.approx([-2.372, -4.371, -6.233], abs=6e-4)
    better = 100 * error.sel(rule="gregory", segments=10, boundary="clamped-free")
    assert better.values == pytest.approx([0.0005, -0.0098, -0.218], rel=0.03)
    short = error.sel(rule="gregory", boundary="clamped-clamped", mode=1, segments=[2, 3, 4, 5])
    assert 100 * short.values == pytest.approx([-34.3, -16.9, -5.78, -1.85], rel=3e-3)
    exact = error.sel(rule="matched(3)")
    assert (exact.dropna("segments", how="all") == 0).sum() == 3 * (18 + 17)


def test_map() -> None:
    table = computed("segments_map")
    for (boundary, rule), needed in FOR_ONE_PERCENT.items():
        assert table.segments_needed.sel(boundary=boundary, rule=rule) == needed
    assert (table.segments_needed.sel(rule="matched(3)") <= 6).all()
    for pair, name in ((p, r) for p in table.boundary.values for r in segments_map.ORDER):
        first = str(table.same_chain_as.sel(boundary=pair, rule=name).values)
        count = np.array([3, 7, 20])
        errors = [bm.frequency_error(pair, segments=count, mode=2, rule=rule) for rule in (name, first)]
        np.testing.assert_array_equal(*errors)
    merged = table.same_chain_as.sel(boundary="pinned-pinned").values
    # Hinge at the wall, half stub, masses at hinges, a pattern inside; and matched.
    unlike = {(rule.stub == Fraction(1, 2), rule.rotary_inertia, rule.inside) for rule in bm.RULES.values()}
    assert len(set(merged)) == len(unlike) + 1
    texts = [text.get_text() for text in segments_map.STUDY.picture(table).axes[0].texts]
    assert len(texts) == sum(len(set(row)) for row in table.same_chain_as.values)


def test_cost_is_that_of_the_advice(costs: xarray.Dataset) -> None:
    for way in bm.recommend("clamped-free", 0.01, 3, rules=["gregory", "mitiguy", "half_stub"]):
        point = costs.sel(rule=way.rule, segments=way.segments)
        assert float(point.cost) == pytest.approx(way.cost, rel=1e-9)
        assert float(point.largest_error) == pytest.approx(way.largest_error, rel=1e-9)


def test_front(costs: xarray.Dataset) -> None:
    flat = costs.isel(rule=slice(None, -1)).stack(point=("rule", "segments")).dropna("point")
    cost, error = flat.cost.values, flat.largest_error.values
    beaten = ((cost[:, None] >= cost) & (error[:, None] >= error)).sum(axis=1) > 1
    np.testing.assert_array_equal(flat.on_front.values, ~beaten)
    accurate = flat.where(flat.on_front & (flat.largest_error < 0.02), drop=True)
    clamped = bm.Boundary.of("clamped-free")
    best = {name for name, rule in bm.RULES.items() if rule.declared_order(clamped) == 4}
    assert {"gregory", "simpson"} <= set(accurate.rule.values) <= best


def test_drawings_show_the_data(by_rule: xarray.Dataset) -> None:
    left = error_by_rule.STUDY.picture(by_rule).axes[0]
    shown = left.get_lines()[0].get_ydata()
    np.testing.assert_array_equal(shown, 100 * by_rule.largest_error[0, 0].dropna("segments"))
    written = {text.get_text() for text in left.texts}
    assert {*bm.RULES, "cubic finite elements", "16", "478", "4", "23"} <= written
    assert any("3 rods" in text for text in written)
