"""Ends at random: every root of the exact beam found once, and chains converging to it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beammodes.accuracy.errors import frequency_error
from beammodes.chains.chain import Chain
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.spectral_beam import spectral_modes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

# Springs over twelve decades, masses over six, in EI/L³, EI/L and ρAL; each of them may be missing or hold.
SPRINGS = st.one_of(st.sampled_from([0.0, math.inf]), st.floats(-6, 6).map(lambda p: 10.0**p))
MASSES = st.one_of(st.just(0.0), st.floats(-3, 3).map(lambda p: 10.0**p))
ENDS = st.builds(
    lambda k, r, m, j, a: End(k, r, m, m * j, a if m else 0.0),
    SPRINGS,
    SPRINGS,
    MASSES,
    st.one_of(st.just(0.0), st.floats(1e-3, 0.1)),
    st.floats(-0.3, 0.3),
)
PAIRS = st.builds(Boundary, ENDS, ENDS)
TENSIONS = st.sampled_from([0.0, 1.0, 30.0])


@settings(max_examples=80)
@given(PAIRS, TENSIONS)
def test_no_root_is_missed_or_doubled(pair: Boundary, tension: float) -> None:
    # Two exact solutions that share no code: root counting on the determinant, and polynomials of curvature,
    # whose eigenvalues cannot be missed.
    load = Load(axial_force=tension)
    roots = euler_bernoulli(Beam.unit(), pair, 6, load=load).angular_frequency
    assert np.all(np.diff(roots) > 0) and roots[0] > 0
    ours = spectral_modes(Beam.unit(), pair, 6, load).angular_frequency
    np.testing.assert_allclose(roots, ours, rtol=1e-10)


@settings(max_examples=40)
@given(PAIRS)
def test_chains_of_200_segments_are_within_a_ten_thousandth(pair: Boundary) -> None:
    # The bound is the issue's own: gregory at N = 200, first three frequencies.
    error = np.asarray(frequency_error(pair, segments=200, mode=[1, 2, 3], rule="gregory"))
    assert np.abs(error).max() < 1e-4
    solved = solve_modes(linearize(Chain(Beam.unit(), pair, 200, "gregory")), 3).angular_frequency
    exact = euler_bernoulli(Beam.unit(), pair, 3).angular_frequency
    np.testing.assert_allclose(solved / exact - 1, error, atol=1e-11 + 1e-15 * exact[-1] / exact[0])


@pytest.mark.slow
@settings(max_examples=300)
@given(PAIRS, TENSIONS)
def test_many_more_of_them(pair: Boundary, tension: float) -> None:
    load = Load(axial_force=tension)
    roots = euler_bernoulli(Beam.unit(), pair, 6, load=load).angular_frequency
    np.testing.assert_allclose(
        roots, spectral_modes(Beam.unit(), pair, 6, load).angular_frequency, rtol=1e-10
    )
    found = frequency_error(pair, segments=200, mode=[1, 2, 3], rule="gregory", load=load, beam=Beam.unit())
    error = np.asarray(found)
    assert np.abs(error).max() < 1e-4


@pytest.mark.parametrize("mass", [1e-6, 0.01, 1.0, 100.0, 1e6])
def test_a_root_spring_is_a_tip_mass(mass: float) -> None:
    # theory.md section 2, the duality: a root hinged on K_r with a free tip has the roots of
    # a clamped root with tip mass
    # 1/K_r (K_r in EI/L, mass in ρAL).
    massive = euler_bernoulli(Beam.unit(), ("clamped", End(mass=mass)), 10)
    sprung = euler_bernoulli(Beam.unit(), (End(math.inf, 1 / mass), "free"), 10)
    np.testing.assert_allclose(massive.angular_frequency, sprung.angular_frequency, rtol=1e-12)
