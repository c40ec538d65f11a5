"""Prescribed motion of the base: courses, a hub's radius, and what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import beammodes as bm
from beammodes.dynamics import runs
from beammodes.dynamics.base_motion import BaseMotion, Course, at_rest, base_vector, harmonic, spin_up


def assert_derivatives(course: Course, time: np.ndarray, scale: float) -> None:
    """Rate and acceleration are the derivatives, by central differences of fourth order."""
    step = 1e-3
    for order in (0, 1):
        far, near = ([course(time + k * step)[order] for k in (-j, j)] for j in (2, 1))
        slope = (8 * (near[1] - near[0]) - (far[1] - far[0])) / (12 * step)
        np.testing.assert_allclose(course(time)[order + 1], slope, rtol=1e-8, atol=1e-8 * scale)


def test_spin_up_gives_consistent_derivatives() -> None:
    # Both sides of T, and T itself, where the course is twice differentiable.
    assert_derivatives(spin_up(6.0, 15.0), np.array([0.1, 3.0, 7.5, 14.9, 15.1, 20.0]), 6.0)
    assert_derivatives(spin_up(-2.0, 0.7), np.array([0.01, 0.3, 0.69, 0.8]), 20.0)


def test_spin_up_is_the_published_course() -> None:
    # Simo and Vu-Quoc 1986: Ω = 6 rad/s, T = 15 s; from rest, to the constant rate, without a jump at T.
    course = spin_up(6.0, 15.0)
    time = np.array([0.0, 7.5, 15.0 - 1e-9, 15.0, 15.0 + 1e-9, 25.0])
    angle, rate, gain = course(time)
    middle = 6 / 15 * (7.5**2 / 2 - 2 * (15 / (2 * math.pi)) ** 2)
    np.testing.assert_allclose(angle, [0.0, middle, 45.0, 45.0, 45.0, 105.0], atol=1e-7)
    np.testing.assert_allclose(rate, [0.0, 3.0, 6.0, 6.0, 6.0, 6.0], atol=1e-14)
    np.testing.assert_allclose(gain, [0.0, 0.8, 0.0, 0.0, 0.0, 0.0], atol=1e-15)
    assert np.diff(course(np.linspace(0, 20, 2001))[1]).min() >= -1e-15


def test_harmonic_gives_consistent_derivatives() -> None:
    assert_derivatives(harmonic(0.3, 5.0), np.linspace(0, 3, 7), 7.5)
    position, rate, gain = harmonic(0.3, 5.0)(np.array([0.2]))
    np.testing.assert_allclose([position, rate], [[0.3 * math.sin(1)], [1.5 * math.cos(1)]], rtol=1e-15)
    np.testing.assert_allclose(gain, -25 * position, rtol=1e-15)


@pytest.mark.parametrize("radius", [0.0, 0.4, 3.0])
def test_hub_moves_the_end_as_a_complex_number(radius: float) -> None:
    # z = x + i y + R exp(i φ) and its derivatives.
    base = BaseMotion(harmonic(0.2, 3.0), harmonic(-0.5, 2.0), spin_up(6.0, 2.0), radius)
    time = np.linspace(0, 3, 13)
    (x, y, phi), found = (course(time) for course in (base.x, base.y, base.angle)), base.at(time)
    assert found.shape == (3, 3, 13)
    spoke = radius * np.exp(1j * phi[0])
    speed, gain = 1j * phi[1] * spoke, (1j * phi[2] - phi[1] ** 2) * spoke
    for k, swing in enumerate((spoke, speed, gain)):
        np.testing.assert_allclose(found[0, k] + 1j * found[1, k], x[k] + 1j * y[k] + swing, atol=1e-12)
    np.testing.assert_array_equal(found[2], phi)


def test_times_of_any_shape() -> None:
    base, time = BaseMotion(y=harmonic(1.0, 2.0), hub_radius=0.5), np.linspace(0, 1, 6)
    flat = base.at(time)
    np.testing.assert_array_equal(base.at(time.reshape(2, 3)), flat.reshape(3, 3, 2, 3))
    np.testing.assert_array_equal(base.at(0.2), flat[:, :, 1])
    # In the order in which the compiled functions take them.
    np.testing.assert_allclose(
        base_vector(base, 0.2), [0.5, 0, 0, math.sin(0.4), 2 * math.cos(0.4), -4 * math.sin(0.4), 0, 0, 0]
    )
    assert base_vector(base, time).shape == (9, 6)


@pytest.mark.parametrize("integrator", ["rk45", "dop853"])
def test_a_course_is_asked_for_once_a_step(integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Of variable steps, some of which are tried in vain; the motion is that of a course asked each time.
    asked = [0, 0]

    def course(time: np.ndarray) -> tuple[np.ndarray, ...]:
        asked[0] += 1
        asked[1] += time.size
        return harmonic(0.3, 20.0)(time)

    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=2)
    given: dict[str, Any] = {"integrator": integrator, "duration": 0.5, "output_step": 0.1}
    once = bm.simulate(chain, base=BaseMotion(y=course), **given)
    calls, times = asked
    assert times > 100 and calls < 0.25 * times
    monkeypatch.setattr(runs.Rate, "serve", lambda *_: None)
    asked[:] = 0, 0
    each = bm.simulate(chain, base=BaseMotion(y=course), **given)
    assert asked[0] > 0.9 * times
    np.testing.assert_allclose(once.q, each.q, atol=1e-12)


def test_a_base_at_rest() -> None:
    assert not BaseMotion().turns and BaseMotion(angle=harmonic(1.0, 1.0)).turns
    assert BaseMotion() == BaseMotion() != BaseMotion(hub_radius=1.0)
    np.testing.assert_array_equal(BaseMotion().at(np.arange(3.0)), np.zeros((3, 3, 3)))
    assert [part.tolist() for part in at_rest(np.arange(2.0))] == [[0.0, 0.0]] * 3


BAD_NUMBERS = st.one_of(
    st.sampled_from([math.nan, math.inf, -math.inf, None, "1", True, 1j, [1.0], 10**400, np.array([1.0])]),
    st.text(),
    st.binary(),
)


@given(BAD_NUMBERS)
def test_bad_numbers_are_refused_by_name(value: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="hub_radius"):
        BaseMotion(hub_radius=value)
    with pytest.raises((TypeError, ValueError), match="amplitude"):
        harmonic(value, 1.0)
    with pytest.raises((TypeError, ValueError), match="angular_frequency"):
        harmonic(1.0, value)
    with pytest.raises((TypeError, ValueError), match="rate"):
        spin_up(value, 1.0)
    with pytest.raises((TypeError, ValueError), match="duration"):
        spin_up(1.0, value)


@given(st.floats(max_value=0.0, allow_nan=False))
def test_what_must_be_positive(value: float) -> None:
    with pytest.raises(ValueError, match="angular_frequency"):
        harmonic(1.0, value)
    with pytest.raises(ValueError, match="duration"):
        spin_up(1.0, value)


def test_negative_radius_is_refused() -> None:
    with pytest.raises(ValueError, match="hub_radius must not be negative, got -1e-09"):
        BaseMotion(hub_radius=-1e-9)


@pytest.mark.parametrize("name", ["x", "y", "angle"])
@pytest.mark.parametrize("course", [None, 1.0, "still", (0.0, 0.0, 0.0)])
def test_a_course_that_is_no_function_is_refused(name: str, course: Any) -> None:
    with pytest.raises(TypeError, match=f"{name} must be a function of time"):
        BaseMotion(**{name: course})


@pytest.mark.parametrize("name", ["x", "y", "angle"])
@pytest.mark.parametrize(
    "course",
    [
        lambda t: (t, t),
        lambda t: (t, t, t, t),
        lambda t: (t, t, 0.0),
        lambda t: (t, t, t[:1]),
        lambda t: (t, t, t * math.nan),
        lambda t: (t + math.inf, t, t),
        lambda _: None,
        lambda _: 0.0,
        lambda t: (t, t, ["a"] * len(t)),
        lambda t: (t, t, 1j * t),
        lambda t: (t, None, t),
    ],
    ids=["two", "four", "scalar", "short", "nan", "inf", "nothing", "number", "words", "complex", "a none"],
)
def test_a_course_that_gives_something_else_is_refused(name: str, course: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{name} must give position, rate and acceleration"):
        BaseMotion(**{name: course}).at(np.arange(3.0))
