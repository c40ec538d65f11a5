"""Properties along a beam: limits at steps, moments of intervals, and the errors of tables."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.profiles import (
    Table,
    mean_over,
    mean_reciprocal,
    moments,
    profile_breaks,
    profile_parts,
    ripple_at_hinges,
    value_at,
)
from beammodes.problem.sections import Circle, Rectangle

STEPPED = Table((0.0, 0.5, 0.5, 1.2, 2.0), (1.0, 2.0, 4.0, 4.0, 3.0))


def test_limits_at_a_step() -> None:
    at = [0.0, 0.25, 0.5, 0.6, 1.6, 2.0]
    assert value_at(STEPPED, at, -1).tolist() == [1.0, 1.5, 2.0, 4.0, 3.5, 3.0]
    assert value_at(STEPPED, at, 1).tolist() == [1.0, 1.5, 4.0, 4.0, 3.5, 3.0]
    assert value_at(STEPPED, at).tolist() == [1.0, 1.5, 3.0, 4.0, 3.5, 3.0]
    assert mean_reciprocal(STEPPED, at)[2] == 0.5 * (1 / 2.0 + 1 / 4.0)


@given(parts=st.integers(2, 40), hinges=st.integers(2, 4000), length=st.floats(0.01, 100.0))
def test_a_hinge_at_a_step_finds_it_whatever_the_rounding(parts: int, hinges: int, length: float) -> None:
    inner = [length * i / parts for i in range(1, parts) for _ in range(2)]
    table = Table((0.0, *inner, length), tuple(float(v) for i in range(parts) for v in (i, i)))
    segments = parts * hinges
    x = np.cumsum(np.full(segments, length / segments))[hinges - 1 : -1 : hinges]
    assert value_at(table, x, -1).tolist() == list(range(parts - 1))
    assert value_at(table, x, 1).tolist() == list(range(1, parts))


@pytest.mark.parametrize("profile", [3.0, STEPPED, np.cos, math.cos, lambda _: 3.0, lambda x: max(x, -1.0)])
@pytest.mark.parametrize("x", [0.5, [0.5], [[0.1, 0.5], [0.6, 2.0]], []])
def test_values_have_the_shape_of_x(profile: Any, x: Any) -> None:
    values = value_at(profile, x)
    assert values.shape == np.shape(x) and values.dtype == np.float64
    one_by_one = [float(value_at(profile, at)) for at in np.ravel(x)]
    assert np.allclose(values.ravel(), one_by_one, rtol=1e-15, atol=0.0)
    assert np.allclose(mean_reciprocal(profile, 0.6), 1.0 / value_at(profile, 0.6), rtol=1e-15)


def exact_moments(density: Any, low: float, high: float, cuts: list[float]) -> list[float]:
    """Moments by mpmath's adaptive quadrature at 30 digits, split at the steps."""
    with mp.workdps(30):
        points = [mp.mpf(low), *(mp.mpf(x) for x in cuts if low < x < high), mp.mpf(high)]
        middle = (points[0] + points[-1]) / 2
        return [float(mp.quad(lambda x, k=k: density(x) * (x - middle) ** k, points)) for k in range(3)]


def stepped(x: Any) -> Any:
    return (
        1 + 2 * x if x < 0.5 else mp.mpf(4) if x < mp.mpf(1.2) else 4 - (x - mp.mpf(1.2)) / (2 - mp.mpf(1.2))
    )


@pytest.mark.parametrize(
    ("profile", "density", "cuts"),
    [
        (7.0, lambda _: mp.mpf(7), []),
        (STEPPED, stepped, [0.5, 1.2]),
        (lambda x: np.exp(-x), lambda x: mp.exp(-x), []),
        (lambda x: math.exp(-x), lambda x: mp.exp(-x), []),
        (lambda x: 1 / (2.2 - x), lambda x: 1 / (mp.mpf(2.2) - x), []),
    ],
)  # fmt: skip
def test_moments_against_quadrature_in_30_digits(profile: Any, density: Any, cuts: list[float]) -> None:
    edges = np.array([0.0, 0.3, 0.5, 0.9, 1.5, 2.0])
    found = np.array(moments(profile, edges)).T
    for (low, high), row in zip(pairwise(edges), found, strict=True):
        exact = exact_moments(density, low, high, cuts)
        # The first moment vanishes for an even density: its scale is the mass times the width.
        scale = np.array([exact[0], exact[0] * (high - low), exact[2]])
        assert np.abs(row - exact).max() <= 1e-14 * scale.max()
        assert abs(row[2] - exact[2]) <= 1e-14 * exact[2]


def test_moments_of_the_whole_follow_from_the_parts() -> None:
    edges = np.linspace(0.0, 2.0, 1001)
    m0, m1, m2 = moments(STEPPED, edges)
    shift = 0.5 * (edges[1:] + edges[:-1]) - 1.0
    whole = moments(STEPPED, [0.0, 2.0])
    parts = (m0.sum(), (m1 + shift * m0).sum(), (m2 + 2 * shift * m1 + shift**2 * m0).sum())
    assert np.allclose(np.ravel(whole), parts, rtol=1e-13, atol=0.0)
    assert m0.sum() / 2.0 == pytest.approx(mean_over(STEPPED, 2.0), rel=1e-14)


def test_a_hundred_thousand_intervals_at_once() -> None:
    """A function is called with arrays, not point by point: a few calls, and so many points per interval."""
    edges = np.linspace(0.0, 2.0, 100_001)
    asked: list[int] = []

    def profile(x: np.ndarray) -> np.ndarray:
        asked.append(np.size(x))
        return np.exp(-x)

    whole = np.ravel(moments(profile, edges)[0]).sum()
    assert whole == pytest.approx(1 - math.exp(-2.0), rel=1e-13)  # the integral of exp(-x) from 0 to 2
    assert len(asked) < 100 and sum(asked) < 100 * len(edges)


def test_breaks() -> None:
    assert profile_breaks(STEPPED) == (0.5,)
    assert profile_breaks(3.0) == profile_breaks(np.cos) == ()
    # A position given twice is a break if the value or the slope changes there.
    assert profile_breaks(Table((0.0, 1.0, 1.0, 2.0), (1.0, 2.0, 2.0, 3.0))) == ()
    assert profile_breaks(Table((0.0, 1.0, 1.0, 2.0), (1.0, 2.0, 2.0, 2.0))) == (1.0,)
    assert profile_breaks(Table((0.0, 1.0, 2.0), (1.0, 2.0, 2.0))) == ()


# --- The smooth curve through a table's points -------------------------------------------------------------


def test_the_curve_through_points_of_a_cubic_is_the_cubic() -> None:
    # Slopes of four points are a cubic's own; in the outer cells a parabola's serve.
    cubic = lambda x: 3.0 - x + x**2 + 0.2 * x**3  # noqa: E731
    points = np.array([0.0, 0.3, 0.5, 0.9, 1.2, 1.4, 2.0])
    table, x = Table(points, cubic(points)), np.linspace(0.9, 1.2, 31)
    np.testing.assert_allclose(1 / mean_reciprocal(table, x, smooth=True), cubic(x), rtol=1e-14)


@pytest.mark.parametrize("x", [(0.0, 1.0), (0.0, 0.2, 0.7, 1.0), (0.0, 0.4, 0.4, 1.0)])
def test_points_on_one_line_have_no_ripple(x: tuple[float, ...]) -> None:
    table, at = Table(x, tuple(2.0 - 1.5 * place for place in x)), np.linspace(0.0, 1.0, 11)
    for smooth in (False, True):
        assert np.abs(mean_reciprocal(table, at, smooth=smooth) * (2.0 - 1.5 * at) - 1).max() < 1e-14
    assert np.abs(ripple_at_hinges(table, at, 1.0, (True, True))).max() < 1e-15


@given(
    st.lists(st.tuples(st.floats(1e-3, 1.0), st.floats(0.01, 100.0)), min_size=2, max_size=12),
    st.integers(1, 30),
)
def test_curves_stay_positive_and_hinges_share_the_whole_ripple(
    cells: list[tuple[float, float]], hinges: int
) -> None:
    x = np.cumsum([0.0, *(width for width, _ in cells[:-1])])
    table = Table(x, [value for _, value in cells])
    places = np.linspace(0.0, x[-1], 4001)
    curve = 1 / mean_reciprocal(table, places, smooth=True)
    assert curve.min() > min(table.value) / 3 * (1 - 1e-12)
    # Interpolation's shares add up to one: with moments at both ends the hinges take the whole of it.
    at = np.linspace(0.0, x[-1], hinges + 2)[1:-1]
    ripple = ripple_at_hinges(table, at, float(x[-1]), (True, True))
    edges = sorted({*x.tolist(), *at.tolist()})
    node, weight = np.polynomial.legendre.leggauss(32)
    whole = 0.0
    for low, high in pairwise(edges):
        inside = low + 0.5 * (high - low) * (1 + node)
        lines, smooth = (mean_reciprocal(table, inside, smooth=smooth) for smooth in (False, True))
        whole += 0.5 * (high - low) * float(weight @ (lines - smooth))
    assert ripple.sum() == pytest.approx(whole, rel=1e-7, abs=1e-9 * float(x[-1]) / min(table.value))


def test_parts() -> None:
    assert profile_parts(STEPPED, 2.0) == (0.5, 1.2)
    assert profile_parts(3.0, 2.0) == profile_parts(np.exp, 2.0) == ()
    assert profile_parts(Table((0.0, 1.0, 2.0), (1.0, 2.0, 2.0)), 2.0) == (1.0,)


def test_a_table_is_a_value() -> None:
    table = Table(np.array([0, 1, 2]), [1, 2, 3])
    assert table == Table((0.0, 1.0, 2.0), (1.0, 2.0, 3.0)) and len({table, Table([0, 1, 2], [1, 2, 3])}) == 1
    with pytest.raises(AttributeError):
        table.x = (0.0, 1.0)  # type: ignore[misc]


@pytest.mark.parametrize(
    ("x", "value", "told"),
    [
        ((0.0, 1.0), (1.0,), "value must be at least two numbers"),
        ((0.0, 1.0), (1.0, 2.0, 3.0), "value must be as many numbers as x, 2, got 3"),
        ((0.1, 1.0), (1.0, 2.0), "x must start at 0, the left end of the beam (or the first time), got 0.1"),
        ((0.0, 1.0, 0.5), (1.0, 2.0, 3.0), "x must be ascending, got 0.5 after 1.0"),
        ((0.0, 0.0, 1.0), (1.0, 2.0, 3.0), "x must have each place once, or twice inside for a step"),
        ((0.0, 1.0, 1.0), (1.0, 2.0, 3.0), "x must have each place once, or twice inside for a step"),
        ((0.0, 0.5, 0.5, 0.5, 1.0), (1.0,) * 5, "x must have each place once, or twice inside for a step"),
        ("ab", (1.0, 2.0), "x must be a sequence of values, got 'ab'"),
        ((0.0, 1.0), 3.0, "value must be a sequence of real numbers, got 3.0"),
        ((0.0, 1.0), (1.0, math.nan), "value must be finite, got [1.0, nan]"),
        ((0.0, 1.0), (1.0, math.inf), "value must be finite, got [1.0, inf]"),
        ((0.0,), (1.0,), "x must be at least two numbers"),
    ],
)  # fmt: skip
def test_wrong_tables(x: Any, value: Any, told: str) -> None:
    with pytest.raises((TypeError, ValueError)) as info:
        Table(x, value)
    assert str(info.value).startswith(told)


bad = st.one_of(
    st.text(), st.none(), st.booleans(), st.floats(), st.binary(), st.lists(st.floats(), max_size=1),
    st.lists(st.text(), min_size=1), st.lists(st.none(), min_size=1),
    st.lists(st.floats(max_value=-1e-300), min_size=1), st.just(np.array(1.0)), st.just(np.ones((2, 2))),
)  # fmt: skip


@given(x=bad)
def test_bad_positions_are_refused_by_name(x: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^x must "):
        Table(x, (1.0, 2.0))


@given(value=bad.filter(lambda value: not isinstance(value, list) or len(value) != 2))
def test_bad_values_are_refused_by_name(value: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^value must "):
        Table((0.0, 1.0), value)


def test_measured_diameters_are_interpolated_as_what_they_are() -> None:
    """What `Table` says of a rod measured at six places: EI ~ d^4 is no straight line between them."""
    at = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.4])
    measured = np.array([12.0, 10.2, 8.1, 6.0, 4.1, 2.2]) * 1e-3

    def stiffness(d: Any) -> Any:
        return 40e9 * math.pi * d**4 / 64

    def mass(d: Any) -> Any:
        return 1800.0 * math.pi * d**2 / 4

    def diameter(x: Any) -> Any:
        return np.interp(x, at, measured)

    tables = Beam(2.4, Table(at, stiffness(measured)), Table(at, mass(measured)))
    cones = Beam(2.4, lambda x: stiffness(diameter(x)), lambda x: mass(diameter(x)), breaks=at[1:-1])
    # A table so fine that EI is straight between its positions is the second route.
    fine = np.unique(np.concatenate([np.linspace(0.0, 2.4, 401), at]))
    again = Beam(2.4, Table(fine, stiffness(diameter(fine))), Table(fine, mass(diameter(fine))))
    coarse, exact, close = (
        euler_bernoulli(each, "clamped-free", 3).frequency for each in (tables, cones, again)
    )
    assert close == pytest.approx(exact, rel=1e-4)
    circles = [Circle(d) for d in measured.tolist()]
    made = Beam.from_sections(at, circles, density=1800.0, elastic_modulus=40e9)
    assert euler_bernoulli(made, "clamped-free", 3).frequency == pytest.approx(exact, rel=2e-6)
    assert made.breaks == () and not made.has_rotary_inertia
    said = ", ".join(f"{100 * (a / b - 1):+.1f}" for a, b in zip(coarse, exact, strict=True))
    assert " and".join(said.rsplit(",", 1)) + " %" in " ".join((Table.__doc__ or "").split())


def test_sections_along_a_beam() -> None:
    material: dict[str, Any] = {"density": 7800.0, "elastic_modulus": 210e9}
    thick, thin = Rectangle(0.04, 0.02), Rectangle(0.04, 0.01)
    # A step where a place stands twice; equal sections are the beam of one section.
    rayleigh: dict[str, Any] = {**material, "rotary_inertia": True}
    stepped = Beam.from_sections([0.0, 0.5, 0.5, 1.0], [thick, thick, thin, thin], **rayleigh)
    halves = [Beam.from_section(each, length=0.5, **rayleigh) for each in (thick, thin)]
    lists = {
        name: [getattr(half, name) for half in halves]
        for name in ("bending_stiffness", "mass_per_length", "rotary_inertia_per_length")
    }
    found, expected = (
        euler_bernoulli(each, "clamped-free", 3).frequency for each in (stepped, Beam(1.0, **lists))
    )
    assert stepped.breaks == (0.5,) and found == pytest.approx(expected, rel=1e-9)
    same = Beam.from_sections([0.0, 0.3, 1.0], [thick] * 3, **material)
    whole = Beam.from_section(thick, length=1.0, **material)
    assert same.is_uniform and same.torsional_stiffness == whole.torsional_stiffness
    for x, sections, message in (
        ([0.0], [thick], "x must be two places or more"),
        ([0.0, 1.0], [thick], "one for each of 1 sections"),
        ([0.1, 1.0], [thick, thin], "x must begin at 0 and ascend"),
        ([0.0, 0.0, 1.0], [thick, thin, thin], "twice inside for a step"),
        ([0.0, 1.0], [thick, Circle(0.01)], "sections must be of one kind"),
    ):
        with pytest.raises((TypeError, ValueError), match=message):
            Beam.from_sections(x, sections, **material)
