"""MathWorks' flexible beam from lumped parameters: 20 flexible elements of half body, joint, half body.

Source: MathWorks, flexible body library for Simscape Multibody (GitHub, release R2025b:
mathworks/Simscape-Multibody-Flex-Beam), Examples/Simple: `sm_flex_lumped_param_beam` for the parameters and
the frequencies that the page expects by theory, `..._calculate_modes.m` for the 20 elements and bending in
one plane, and the page's figure of mode shapes, sm_flex_lumped_param_beam_05.png, for the frequencies of
Simscape's own linearization. The joint stiffness E I / element length is that of Libraries/
sm_flex_body_lib_lpar_compute_flexprop.m, the half bodies those of the element's diagram.
"""

from __future__ import annotations

import numpy as np
import pytest

from beammodes.auditing.audit import audit_chain
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

# "0.3m long beam constructed of aluminum (modulus of elasticity = 70 GPa, density = 2800 kg/m^3). The beam is
# 0.015m wide and 0.005m thick"; it bends about its thin side.
LENGTH, WIDTH, THICKNESS, MODULUS, DENSITY, ELEMENTS = 0.3, 0.015, 0.005, 70e9, 2800.0, 20
AREA, SECOND_MOMENT = WIDTH * THICKNESS, WIDTH * THICKNESS**3 / 12
# What the page's formula gives, [Hz], and the coefficients that it puts in.
BY_FORMULA, COEFFICIENTS = np.array([44.92, 280.76, 787.43, 1544.23]), np.array([3.52, 22.0, 61.7, 121.0])
# What Simscape's linearization gave, [Hz].
BY_SIMSCAPE = np.array([44.8705, 281.5953, 789.1692, 1547.2657])


def beam(section_turns: bool) -> Beam:
    """The beam; solids of Simscape have the rotary inertia ρI of their section."""
    rotary = DENSITY * SECOND_MOMENT if section_turns else 0.0
    return Beam(LENGTH, MODULUS * SECOND_MOMENT, DENSITY * AREA, rotary_inertia_per_length=rotary)


def frequencies(rule: str, section_turns: bool = True) -> np.ndarray:
    chain = Chain(beam(section_turns), "clamped-free", ELEMENTS, rule)
    return solve_modes(linearize(chain), modes=4).frequency


def by_hand() -> dict[str, list[float]]:
    """The 21 bodies as the library makes them: blocks, the first and the last of half an element's length."""
    ell = LENGTH / ELEMENTS
    length = [ell / 2, *[ell] * (ELEMENTS - 1), ell / 2]
    mass = [DENSITY * AREA * each for each in length]
    inertia = [m * (each**2 + THICKNESS**2) / 12 for m, each in zip(mass, length, strict=True)]
    springs = [MODULUS * SECOND_MOMENT / ell] * ELEMENTS
    return {"length": length, "mass": mass, "rotary_inertia": inertia, "joint_stiffness": springs}


def test_the_chain_is_that_of_the_library() -> None:
    chain = Chain(beam(True), "clamped-free", ELEMENTS, "half_stub")
    for name, values in by_hand().items():
        np.testing.assert_allclose(getattr(chain, name), values, rtol=1e-13)


def test_the_audit_knows_the_layout() -> None:
    found = audit_chain(beam(True), "clamped-free", **by_hand(), modes=4)
    assert (found.layout, found.segments, found.order) == ("half_stub", 20, 2)
    # Against the beam with the same rotary inertia.
    exact = euler_bernoulli(beam(True), "clamped-free", 4).frequency
    np.testing.assert_allclose(found.errors, frequencies("half_stub") / exact - 1, rtol=1e-9)
    # README has +0.23 % of a slender beam at N = 10, so a quarter of that here.
    assert found.errors[0] == pytest.approx(0.0023 / 4, rel=0.01)


def test_the_pages_formula_differs_by_the_rounding_of_its_coefficients() -> None:
    exact = euler_bernoulli(beam(False), "clamped-free", 4).angular_frequency
    unit = np.sqrt(MODULUS * SECOND_MOMENT / (DENSITY * AREA)) / LENGTH**2
    # The page's four frequencies are these coefficients times the unit, cut off after two decimals.
    np.testing.assert_array_equal(np.floor(100 * COEFFICIENTS * unit / (2 * np.pi)) / 100, BY_FORMULA)
    # The coefficients are the beam's, of which three digits are kept (121.0 is 120.90, rounded to 121).
    np.testing.assert_array_equal([float(f"{value:.3g}") for value in exact / unit], COEFFICIENTS)


def test_simscapes_frequencies_agree_with_the_half_stub_chain() -> None:
    """Within 0.06 %, and why no closer and no looser.

    The figure's numbers have six digits, so rounding is 1e-6 and less. Simscape's solids are blocks, whose
    rotary inertia about the bending axis is the section's ρI beside the rod's; without it mode 4 is off by
    0.18 %, with it by 0.006 %. What is left, -0.056, -0.024, -0.010 and -0.006 %, falls with the mode: no
    error of the layout or of a mass does that (they grow with the mode, or stay). The page does not say how
    the model is loaded while it is linearized, nor by which perturbation; 0.06 % covers that, and is an
    eighth of the 0.45 % by which the layout itself shifts mode 4.
    """
    off = BY_SIMSCAPE / frequencies("half_stub") - 1
    assert np.abs(off).max() < 6e-4
    assert np.all(np.diff(np.abs(off)) < 0)
    without = BY_SIMSCAPE / frequencies("half_stub", section_turns=False) - 1
    assert np.abs(without).max() > 1.7e-3
    assert np.abs(off[1:]).max() < np.abs(without[1:]).min() / 2


def test_no_other_layout_explains_them() -> None:
    distance = {rule: float(np.abs(BY_SIMSCAPE / frequencies(rule) - 1).max()) for rule in RULES}
    nearest = sorted(distance, key=distance.__getitem__)
    assert nearest[0] == "half_stub"
    assert distance[nearest[1]] > 5 * distance["half_stub"]
    exact = euler_bernoulli(beam(True), "clamped-free", 4).frequency
    assert np.abs(BY_SIMSCAPE / exact - 1).max() > 4e-3


def test_three_springs_would_bring_the_library_to_the_beam() -> None:
    # The library's own hinges, bodies and N: only the first three stiffnesses change.
    found = audit_chain(beam(True), "clamped-free", **by_hand(), modes=4)
    (item,) = (each for each in found.suggestions if each.name == "half_stub_corrected")
    changed = np.flatnonzero(~np.isclose(item.joint_stiffness, found.joint_stiffness, rtol=1e-9))
    assert list(changed) == [0, 1, 2]
    assert abs(item.errors[0]) < 2e-5 < abs(found.errors[0])
