"""Pieces of a beam that varies: masses, centres, inertias and hinges; and single pieces with bodies."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import scipy.integrate
from drawn_ends import EVERY_N
from hypothesis import given, settings
from hypothesis import strategies as st
from turns import in_turns

from beammodes.chains.chain import Chain
from beammodes.chains.rods import MissedFeatureWarning, missed_feature
from beammodes.chains.units import ExactUnits
from beammodes.problem.beam import Beam
from beammodes.problem.ends import End
from beammodes.problem.profiles import Table, integral_of_reciprocal, mean_reciprocal
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

LENGTH = 1.5
KINKED = Table((0.0, 0.4, 0.4, 1.1, LENGTH), (3.0, 2.0, 1.0, 1.5, 0.5))
WAVY: Callable[[Any], Any] = lambda x: 2.0 + np.sin(3 * x)  # noqa: E731
# What a user may give, as a function for the quadrature, and where that function has steps or kinks.
PROFILES: dict[str, tuple[Any, Callable[[float], float], list[float]]] = {
    "function": (WAVY, WAVY, []),
    "table": (
        KINKED,
        lambda x: (
            3.0 - x / 0.4 if x < 0.4 else 1.0 + 0.5 * (x - 0.4) / 0.7 if x < 1.1 else 1.5 - (x - 1.1) / 0.4
        ),
        [0.4, 1.1],
    ),
    "sequence": ([4.0, 1.0, 2.0], lambda x: 4.0 if x < 0.5 else 1.0 if x < 1.0 else 2.0, [0.5, 1.0]),
    "number": (1.7, lambda x: 1.7 + 0 * x, []),
}


def integral(function: Callable[[float], float], low: float, high: float, breaks: list[float]) -> float:
    inside = [x for x in breaks if low < x < high]
    edges = [low, *inside, high]
    return sum(scipy.integrate.quad(function, a, b, epsabs=0, epsrel=1e-13)[0] for a, b in pairwise(edges))


@pytest.mark.parametrize("mass", PROFILES)
@pytest.mark.parametrize("rotary", ["sequence", "table", "number"])
@pytest.mark.parametrize("rule", ["mitiguy", "half_stub"])
def test_pieces_are_the_integrals_of_the_beam(mass: str, rotary: str, rule: str) -> None:
    given_mass, density, breaks = PROFILES[mass]
    given_rotary, section, section_breaks = PROFILES[rotary]
    # The bending stiffness makes the beam nonuniform even where both others are numbers.
    beam = Beam(LENGTH, [2.0, 1.0], given_mass, given_rotary)
    for segments in (1, 4, 7):
        chain = Chain(beam, "clamped-pinned", segments, rule)
        edge = np.concatenate([[0.0], np.cumsum(chain.length)])
        assert edge[-1] == pytest.approx(LENGTH, rel=1e-15)
        for i in range(chain.pieces):
            low, high = edge[i], edge[i + 1]
            m = integral(density, low, high, breaks)
            assert chain.mass[i] == pytest.approx(m, rel=1e-12, abs=1e-15)
            if not m:
                assert (chain.centre[i], chain.rotary_inertia[i]) == (0, 0)
                continue
            middle = integral(lambda x: x * density(x), low, high, breaks) / m
            about = integral(lambda x, c=middle: (x - c) ** 2 * density(x), low, high, breaks)
            about += integral(section, low, high, section_breaks)
            assert chain.centre[i] == pytest.approx(middle - low, rel=1e-11)
            assert chain.rotary_inertia[i] == pytest.approx(about, rel=1e-10)
        assert chain.mass.sum() == pytest.approx(integral(density, 0, LENGTH, breaks), rel=1e-13)


@pytest.mark.parametrize("mass", ["function", "table", "sequence"])
def test_henckys_point_masses_keep_mass_and_centre(mass: str) -> None:
    beam = Beam(LENGTH, 2.0, PROFILES[mass][0])
    rods, points = (Chain(beam, "free-free", 6, rule) for rule in ("mitiguy", "hencky"))
    np.testing.assert_allclose(points.mass, rods.mass, rtol=1e-15)
    np.testing.assert_allclose(points.centre, rods.centre, rtol=1e-15)
    # By hand: masses m (l - c)/l and m c/l at the two tips have the inertia m c (l - c) about their centre.
    expected = points.mass * points.centre * (points.length - points.centre)
    np.testing.assert_allclose(points.rotary_inertia, expected, rtol=1e-14)


def test_a_beam_whose_ends_have_bodies_keeps_its_rods() -> None:
    beam = Beam(LENGTH, WAVY, KINKED)
    bare = Chain(beam, "clamped-free", 5)
    body = Chain(beam, ("clamped", End(mass=0.7, rotary_inertia=0.2, offset=0.1)), 5)
    for name, tip in (("length", 0.0), ("mass", 0.7), ("centre", 0.1), ("rotary_inertia", 0.2)):
        values = getattr(body, name)
        np.testing.assert_allclose(values[:-1], getattr(bare, name), rtol=1e-15)
        assert values[-1] == pytest.approx(tip, rel=1e-14)


# --- Hinges -----------------------------------------------------------------------------------------------


def test_hinges_at_a_step_have_the_mean_flexibility_of_both_sides() -> None:
    # By hand: EI = 4, 1, 2 on thirds of 1.5; 6 segments of 1/4, steps at hinges 2 and 4 (double_wall: halves
    # at the walls, flexibility ½ (1/4 + 1) and ½ (1 + 1/2) at the steps), spring = 1/(ell w f).
    chain = Chain(Beam(LENGTH, [4.0, 1.0, 2.0], 1.0), "clamped-clamped", 6, "double_wall")
    flexibility = np.array([1 / 8, 1 / 4, 5 / 8, 1, 3 / 4, 1 / 2, 1 / 4])
    np.testing.assert_allclose(chain.joint_stiffness, 1 / (0.25 * flexibility), rtol=1e-14)


@pytest.mark.parametrize("rule", EVERY_N)
def test_hinges_take_the_stiffness_where_they_stand(rule: str) -> None:
    # design: the same quadrature, w_j ell/EI(x_j).
    beam = Beam(LENGTH, WAVY, 1.0)
    chain, uniform = (Chain(b, "pinned-clamped", 5, rule) for b in (beam, Beam(LENGTH, 1.0, 1.0)))
    expected = uniform.joint_stiffness * WAVY(chain.hinge_position)
    np.testing.assert_allclose(chain.joint_stiffness, expected, rtol=1e-13)


@pytest.mark.parametrize("spread", [2.0, 5.0, 30.0])
@pytest.mark.parametrize("segments", [10, 50])
def test_hinges_keep_the_whole_of_a_table_or_take_its_own_values_and_say_so(
    spread: float, segments: int
) -> None:
    # Drawn tables of six points. Between walls and at the trapezoidal rule's weights, M² = 1 is what shares
    # know, so that a kept ripple adds what the lines have beside the curve: no hinge is left out.
    random, own = np.random.default_rng(7), 0
    for _ in range(20):
        x, values = np.linspace(0, 1, 6), spread ** random.uniform(-1, 0, 6)
        beam, hinges = Beam(1.0, Table(x, values), 1.0), np.linspace(0, 1, segments + 1)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", MissedFeatureWarning)
            chain = Chain(beam, "clamped-clamped", segments, "double_wall")
        assert (chain.joint_stiffness > 0).all()
        # Weights 1/2 at the walls, 1 between.
        width = np.array([0.5, *[1.0] * (segments - 1), 0.5]) / segments
        plain, curve = (
            width * mean_reciprocal(beam.bending_stiffness, hinges, smooth=smooth) for smooth in (False, True)
        )
        give = 1 / chain.joint_stiffness
        whole = float(integral_of_reciprocal(beam.bending_stiffness, [0.0, 1.0])[0])
        if np.abs(give / plain - 1).max() < 1e-12:
            own += 1
            assert bool(told) or abs(plain.sum() / whole - 1) <= 1e-3
        else:
            assert np.abs(give / curve - 1).max() <= 2 / 3 + 1e-12
            fine = np.linspace(0, 1, 200_001)
            smooth = mean_reciprocal(beam.bending_stiffness, fine, smooth=True)
            ripple = whole - scipy.integrate.trapezoid(smooth, fine)
            assert give.sum() - curve.sum() == pytest.approx(ripple, rel=1e-5, abs=1e-7 * whole)
    # Points are two segments apart of ten, and ten of fifty; only steep tables are left to themselves.
    assert own < 20
    if spread == 30.0:
        assert own > 0


# --- Features that hinges miss ------------------------------------------------------------------------------


def notched(centre: float, width: float) -> Callable[[Any], Any]:
    return lambda x: 1.0 - 0.9 * np.exp(-(((x - centre) / width) ** 2))


# The flexibility that a notch adds: ∫ (1/EI - 1) dx = w √π Σ 0.9^k / √k, term by term.
ADDED = np.pi**0.5 * sum(0.9**k / k**0.5 for k in range(1, 400))


@pytest.mark.parametrize(
    ("rule", "centre", "told"),
    in_turns(EVERY_N, [0.05, 0.1, 0.137, 0.37, 0.5, 0.98], ["function", "table", "parts"], every=2),
)
def test_a_notch_between_hinges_or_on_one_is_told(rule: str, centre: float, told: str) -> None:
    width = 0.002
    if told == "table":
        x = np.unique([0.0, 1.0, *np.clip(centre + width * np.linspace(-6, 6, 601), 0, 1)])
        beam = Beam(1.0, Table(x, notched(centre, width)(x)), 1.0)
    elif told == "parts":
        part = int(centre * 400)
        beam = Beam(1.0, [1.0] * part + [0.1] + [1.0] * (399 - part), 1.0)
    else:
        beam = Beam(1.0, notched(centre, width), 1.0)
    with pytest.warns(MissedFeatureWarning, match=r"^the hinge at x = .* of 10 segments (misses|makes too)"):
        Chain(beam, "clamped-free", 10, rule)


@pytest.mark.parametrize("width", [0.002, 0.0005])
def test_the_part_that_is_told_is_the_notchs(width: float) -> None:
    beam = Beam(1.0, notched(0.137, width), 1.0)
    chain = Chain(Beam.unit(), "clamped-free", 10, "gregory")
    found = missed_feature(beam, [Fraction(0), *[Fraction(1)] * 10], ExactUnits.of(beam, 10))
    assert found is not None and found[0] == pytest.approx(0.1, rel=1e-12) and chain.pieces == 11
    assert found[1] == pytest.approx(width * ADDED / (1 + width * ADDED), rel=1e-9)


@pytest.mark.parametrize("rule", EVERY_N)
@pytest.mark.parametrize("segments", [4, 5, 10, 40])
def test_what_varies_smoothly_or_in_steps_is_not_told(rule: str, segments: int) -> None:
    # Warnings are errors here.
    for stiffness in (
        WAVY,
        lambda x: (1.0 - 0.6 * x) ** 3,
        lambda x: np.exp(-3.0 * x),
        *([KINKED] if segments > 5 else []),
        [4.0, 1.0, 2.0],
        Table(np.linspace(0, LENGTH, 301), WAVY(np.linspace(0, LENGTH, 301))),
        notched(0.5, 0.5),
    ):
        Chain(Beam(LENGTH, stiffness, 1.0), "clamped-free", segments, rule)


@pytest.mark.parametrize("rule", EVERY_N)
@pytest.mark.parametrize("segments", [4, 5])
def test_hinges_too_few_for_a_coarse_table_are_told(rule: str, segments: int) -> None:
    with pytest.warns(
        MissedFeatureWarning, match=rf"^the hinges of {segments} segments (miss|make too much)"
    ):
        Chain(Beam(LENGTH, KINKED, 1.0), "clamped-free", segments, rule)


def test_enough_segments_see_the_notch() -> None:
    beam = Beam(1.0, notched(0.37, 0.02), 1.0)
    with pytest.warns(MissedFeatureWarning):
        Chain(beam, "clamped-free", 5)
    Chain(beam, "clamped-free", 200)


@pytest.mark.parametrize("segments", [1, 7, 33])
@pytest.mark.parametrize("name", PROFILES)
def test_the_integral_of_the_reciprocal(name: str, segments: int) -> None:
    profile, function, breaks = PROFILES[name]
    kept = Beam(LENGTH, profile, 1.0).bending_stiffness
    edges = np.linspace(0.0, LENGTH, segments + 1)
    expected = [integral(lambda x: 1 / function(x), a, b, breaks) for a, b in pairwise(edges.tolist())]
    np.testing.assert_allclose(integral_of_reciprocal(kept, edges), expected, rtol=1e-13)


# --- One beam, told in different ways ---------------------------------------------------------------------


@pytest.mark.parametrize("rule", ["mitiguy", "hencky", "half_stub_corrected", "rigid_stub_corrected"])
@pytest.mark.parametrize("pair", ["clamped-free", ("free", End(3.0, 1.0, 0.5, 0.1, 0.2))], ids=str)
def test_a_constant_function_gives_the_uniform_chain(rule: str, pair: Any) -> None:
    numbers = Beam(LENGTH, 2.0, 0.7, 0.01)
    told = [
        Beam(LENGTH, lambda x: 2.0 + 0 * x, lambda _: 0.7, 0.01),
        Beam(LENGTH, [2.0, 2.0], Table((0.0, LENGTH), (0.7, 0.7)), [0.01] * 3),
        Beam(LENGTH, Table((0.0, 1.0, LENGTH), (2.0, 2.0, 2.0)), 0.7, lambda _: 0.01),
    ]
    for segments in (1, 2, 9) if rule != "rigid_stub_corrected" else (4, 9):
        expected = Chain(numbers, pair, segments, rule)
        for beam in told:
            chain = Chain(beam, pair, segments, rule)
            for name in (
                "length",
                "mass",
                "centre",
                "rotary_inertia",
                "joint_stiffness",
                "support_stiffness",
            ):
                found = np.array(getattr(chain, name))
                np.testing.assert_allclose(found, getattr(expected, name), rtol=1e-14, atol=1e-16)


@given(
    st.lists(st.floats(0.1, 10), min_size=2, max_size=4),
    st.lists(st.floats(0.1, 10), min_size=2, max_size=4),
    st.sampled_from(["clamped-free", "pinned-guided", "free-free"]),
)
@settings(max_examples=15)
def test_a_turned_beam_has_the_same_frequencies(stiffness: list[float], mass: list[float], pair: str) -> None:
    left, right = pair.split("-")
    one = Chain(Beam(LENGTH, stiffness, mass), (left, right), 5, "gregory")
    other = Chain(Beam(LENGTH, stiffness[::-1], mass[::-1]), (right, left), 5, "gregory")
    found = [solve_modes(linearize(chain)).angular_frequency for chain in (one, other)]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-10)


# --- Single pieces with bodies ----------------------------------------------------------------------------


def only(chain: Chain) -> np.ndarray:
    return solve_modes(linearize(chain)).angular_frequency


def test_a_body_turning_on_a_straight_rod() -> None:
    # A pinned body of inertia J on the wall spring k = 2 EI/ell of one rod that cannot move: ω² = k/J = 20.
    chain = Chain(Beam.unit(), (End(np.inf, rotary_inertia=0.1), "pinned"), 1, "double_wall")
    np.testing.assert_allclose(only(chain), [20**0.5], rtol=1e-14)


def test_its_mode_has_unit_modal_mass() -> None:
    chain = Chain(Beam.unit(), (End(np.inf, rotary_inertia=0.1), "pinned"), 1, "double_wall")
    rotation = solve_modes(linearize(chain)).rotation
    assert (rotation**2 * chain.rotary_inertia).sum() == pytest.approx(1.0, rel=1e-14)


def test_a_welded_rod_between_two_sliding_supports() -> None:
    # One rod of mass 1 that cannot turn, on springs 5 and 3: ω² = 8.
    chain = Chain(Beam.unit(), (End(5.0, np.inf), End(3.0, np.inf)), 1, "rigid_stub")
    assert chain.elastic_modes == 1
    np.testing.assert_allclose(only(chain), [8**0.5], rtol=1e-14)


def test_a_body_turning_at_the_pinned_tip_of_a_held_rod() -> None:
    # A clamped rod, its tip pinned without effect; a body of inertia 1/10 turns on the spring 1: ω² = 10.
    chain = Chain.from_pieces(
        length=[1, 0],
        mass=[1, 0],
        rotary_inertia=[Fraction(1, 10)] * 2,
        joint_stiffness=[1],
        boundary="clamped-pinned",
    )
    assert linearize(chain).mass_matrix.shape == (1, 1)
    assert chain.elastic_modes == 1
    np.testing.assert_allclose(only(chain), [10**0.5], rtol=1e-14)
