"""Damping from measurements: Rayleigh's coefficients, dampers of joints, ratios from decays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import nnls

import beammodes as bm
from beammodes.numerics.nonnegative import nearest_nonnegative
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.damping import damping_of_modes

BEAM = bm.Beam(1.2, 85.0, 0.62)
CHAIN = bm.Chain(BEAM, "clamped-free", 10, rule="gregory")
SPRUNG = bm.Chain(BEAM, (bm.End(2e4, 300.0), bm.End(mass=0.1, rotary_inertia=1e-4)), 8)


def test_two_measured_ratios_of_a_cantilever() -> None:
    """α and β as solved by others from 4.55011119 and 28.51506011 Hz with 0.8 and 1.1 %."""
    hertz, ratios = (4.55011119, 28.51506011), {1: 0.008, 2: 0.011}
    found = bm.rayleigh_damping(hertz, ratios)
    assert (found.mass, found.stiffness) == pytest.approx(
        (0.36639355770218635, 0.00011137751804816173), rel=1e-12
    )
    exact = bm.rayleigh_damping(bm.euler_bernoulli(BEAM, "clamped-free", 2), [0.008, 0.011])
    assert (exact.mass, exact.stiffness) == pytest.approx((found.mass, found.stiffness), rel=1e-7)
    # By elimination, for frequencies and modes as they are named.
    for chain in (CHAIN, SPRUNG):
        first, second = bm.solve_modes(bm.linearize(chain), 3).angular_frequency[[0, 2]]
        mine = bm.rayleigh_damping(chain, {3: 0.03, 1: 0.02})
        share = 2 / (second**2 - first**2)
        assert mine.mass == pytest.approx(share * first * second * (0.02 * second - 0.03 * first), rel=1e-11)
        assert mine.stiffness == pytest.approx(share * (0.03 * second - 0.02 * first), rel=1e-11)
        again = bm.rayleigh_damping({1: first / (2 * math.pi), 3: second / (2 * math.pi)}, {3: 0.03, 1: 0.02})
        assert (mine.mass, mine.stiffness) == pytest.approx((again.mass, again.stiffness), rel=1e-13)
        modes = bm.damped_modes(chain, mine)
        assert modes.damping_ratio.values[[0, 2]] == pytest.approx([0.02, 0.03], rel=1e-11)
        # Between the two less, above ever more.
        assert modes.damping_ratio.values[1] < 0.03 and np.all(np.diff(modes.damping_ratio.values[2:]) > 0)
        assert modes.overdamped_modes == (modes.damping_ratio.values >= 1).sum()
    omega = bm.solve_modes(bm.linearize(CHAIN)).angular_frequency
    assert bm.damped_modes(CHAIN, bm.joint_dampers(CHAIN, 0.05)).overdamped_modes == (
        (0.05 * omega >= omega[0]).sum()
    )


def test_ratios_of_chains_of_other_kinds() -> None:
    """A structure of one member is the planar chain; each gets the ratios by its own frequencies."""
    shaft = bm.AxialChain(bm.Beam(1.0, 20.0, 0.5, torsional_stiffness=8.0, polar_inertia_per_length=1e-4),
                          "fixed-free", 4)  # fmt: skip
    rod = bm.SpatialChain(bm.Rod(1.0, 20.0, 15.0, 0.5, 1e-3, curvature=(0.5, 0.0, 1.0)), "clamped-free", 4)
    frame = bm.StructureChain(bm.Structure.of_beam(BEAM, "clamped-free"), 10, rule="gregory")
    ratios = {1: 0.01, 2: 0.01}
    for chain, omega in (
        (shaft, solve_axial_modes(shaft, 2).angular_frequency),
        (rod, bm.spatial_modes(rod, 2).angular_frequency),
        (frame, bm.structure_chain_modes(frame, 2).angular_frequency),
    ):
        found = bm.rayleigh_damping(chain, ratios)
        assert found.mass / (2 * omega) + found.stiffness * omega / 2 == pytest.approx(
            [0.01, 0.01], rel=1e-11
        )
        with pytest.raises(ValueError, match="ratios must be of modes up to"):
            bm.rayleigh_damping(chain, {1: 0.01, 500: 0.01})
    mine = bm.rayleigh_damping(frame, ratios)
    for name in ("rk4", "leapfrog", "MuJoCo implicit"):
        expected = bm.stable_time_step(CHAIN, name, damping=mine)
        assert bm.stable_time_step(frame, name, damping=mine) == pytest.approx(expected, rel=1e-7)
    with pytest.raises(ValueError, match="without dampers of joints for a chain of a structure"):
        bm.stable_time_step(frame, damping=bm.Damping(joint=1.0))


def test_more_ratios_are_met_in_the_least_squares() -> None:
    hertz, ratios = np.array([4.0, 30.0, 70.0, 150.0]), np.array([0.01, 0.009, 0.02, 0.03])
    found = bm.rayleigh_damping(hertz, ratios)

    def left(mass: float, stiffness: float) -> float:
        omega = 2 * math.pi * hertz
        return float(((mass / (2 * omega) + stiffness * omega / 2 - ratios) ** 2).sum())

    least = left(found.mass, found.stiffness)
    for share in (1e-4, -1e-4):
        assert left(found.mass * (1 + share), found.stiffness) > least
        assert left(found.mass, found.stiffness * (1 + share)) > least


@pytest.mark.parametrize(
    ("ratios", "negative", "kept"),
    # Ratios that grow faster than frequencies, or fall faster.
    [({1: 0.001, 2: 0.02}, r"mass = -.* below [\d.]+ rad/s", "stiffness"),
     ({1: 0.02, 2: 0.001}, r"stiffness = -.* above [\d.]+ rad/s", "mass")],
)  # fmt: skip
def test_negative_coefficients_are_refused_with_a_warning(ratios: Any, negative: str, kept: str) -> None:
    with pytest.warns(bm.DampingFitWarning, match=negative) as told:
        found = bm.rayleigh_damping(CHAIN, ratios)
    assert (found.mass == 0.0) == (kept == "stiffness") and (found.stiffness == 0.0) == (kept == "mass")
    got = bm.damped_modes(CHAIN, found).damping_ratio.values[:2]
    assert f"modes 1, 2 get {got[0]:.4g}, {got[1]:.4g} for" in str(told[0].message)
    # The limit that is named: there the two coefficients that were refused cancel.
    omega = bm.solve_modes(bm.linearize(CHAIN), 2).angular_frequency
    mass, stiffness = np.linalg.solve(np.column_stack([1 / (2 * omega), omega / 2]), [*ratios.values()])
    assert f"{math.sqrt(-mass / stiffness):.4g} rad/s" in str(told[0].message)


def test_dampers_of_joints_give_several_ratios() -> None:
    """Of the modes one by one, and by the eigenvalues of the whole, where other dampers couple them by ζ²."""
    draw = np.random.default_rng(5)
    for chain in (CHAIN, SPRUNG):
        uniform = bm.damped_modes(chain, bm.joint_dampers(chain, 1e-3)).damping_ratio.values
        for _ in range(10):
            asked = {mode: float(uniform[mode - 1] * draw.uniform(0.7, 1.3)) for mode in (1, 2, 4)}
            found = bm.joint_dampers(chain, asked)
            assert found.mass == found.stiffness == 0.0 and min(found.joint) >= 0.0  # type: ignore[arg-type]
            modal, wanted = damping_of_modes(chain, found), np.array([*asked.values()])
            got = modal.coupling.diagonal() / (2 * modal.angular_frequency)
            assert got[[0, 1, 3]] == pytest.approx(wanted, rel=1e-11)
            whole = bm.damped_modes(chain, found).damping_ratio.values[[0, 1, 3]]
            assert (abs(whole - wanted) < wanted**2).all()
    # One ratio in a mapping is the one alone, also where hinges differ.
    alone = bm.joint_dampers(CHAIN, {2: 0.01})
    assert np.asarray(alone.joint) == pytest.approx(
        bm.joint_dampers(CHAIN, 0.01, mode=2).joint_damping(CHAIN)
    )
    # A first mode without loss beside a lossy second one asks for dampers where it does not bend.
    with pytest.warns(bm.DampingFitWarning, match="only negative dampers give these ratios: modes 1, 2 get"):
        bm.joint_dampers(CHAIN, {1: 1e-9, 2: 0.1})


def test_nearest_numbers_without_a_sign_by_a_second_route() -> None:
    """Against nonnegative least squares in which the equations weigh 10⁶ times as much."""
    draw, none = np.random.default_rng(1), 0
    for _ in range(300):
        size = int(draw.integers(1, 6))
        rows = draw.random((size, size + int(draw.integers(0, 20))))
        start = draw.random(rows.shape[1])
        wanted = rows @ (draw.random(rows.shape[1]) * (draw.random(rows.shape[1]) < 0.5))
        wanted = wanted if draw.random() < 0.7 else draw.random(size)
        found, (_, left) = nearest_nonnegative(rows, wanted, start), nnls(rows, wanted)
        if found is None:
            none += 1
            assert left > 1e-10
            continue
        weighted, _ = nnls(np.vstack([1e6 * rows, np.eye(len(start))]), np.concatenate([1e6 * wanted, start]))
        # Old versions of nnls end beside the nearest point.
        assert rows @ found == pytest.approx(wanted, abs=1e-9) and found.min() >= 0
        assert np.linalg.norm(found - start) <= np.linalg.norm(weighted - start) + 1e-7
    assert none > 20


def test_a_ratio_from_the_peaks_of_a_decay() -> None:
    # Logarithmic decrement of the first and last of four peaks, as worked out by others.
    assert float(bm.ratio_from_decay((10.0, 9.1, 8.3, 7.6))) == pytest.approx(0.014557783999243307, rel=1e-13)
    for ratio in (1e-4, 0.02, 0.3, 0.9):
        # Peaks of e^{-ζωt} sin(ω_d t): where its rate is zero, both signs, half a period apart.
        damped = math.sqrt(1 - ratio**2)
        times = (math.atan2(damped, ratio) + math.pi * np.arange(7)) / damped
        heights = abs(np.exp(-ratio * times) * np.sin(damped * times))
        both = bm.ratio_from_decay(3.0 * heights, periods=0.5 * np.arange(7))
        upper = bm.ratio_from_decay(heights[::2])
        for found in (both.ratio, both.fitted_ratio, upper.ratio, upper.fitted_ratio):
            assert found == pytest.approx(ratio, rel=1e-9)
        assert both.standard_error < 1e-12
    assert math.isnan(bm.ratio_from_decay([2.0, 1.0]).standard_error)


def test_the_accuracy_that_is_said_is_the_scatter() -> None:
    """Peaks read to 1 %: errors over their standard error have Student's variance, 8/6 of ten peaks."""
    draw, true = np.random.default_rng(3), 0.02
    decay = np.exp(-2 * math.pi * true / math.sqrt(1 - true**2) * np.arange(10))
    found = [bm.ratio_from_decay(decay * np.exp(0.01 * draw.standard_normal(10))) for _ in range(2000)]
    students = np.array([(each.fitted_ratio - true) / each.standard_error for each in found])
    assert students.var() == pytest.approx(8 / 6, rel=0.1)
    # By the sums of squares: 12/(n (n² - 1)) against 2/(n - 1)² of the two alone.
    spread = np.std([each.ratio for each in found]) / np.std([each.fitted_ratio for each in found])
    assert spread == pytest.approx(math.sqrt(2 / 81 / (12 / 990)), rel=0.05)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: bm.rayleigh_damping(CHAIN, {1: 0.01}),
            "ratios must be of two modes at least.*joint_dampers",
        ),
        (lambda: bm.rayleigh_damping(CHAIN, {1: 0.01, 11: 0.01}), "up to 10, got one of mode 11"),
        (lambda: bm.rayleigh_damping({1: 4.0}, {1: 0.01, 2: 0.01}), r"of modes \[1, 2\], got none of \[2\]"),
        (
            lambda: bm.rayleigh_damping([4.0], {1: 0.01, 2: 0.01}),
            "of must have positive frequencies of 2 modes",
        ),
        (lambda: bm.rayleigh_damping([4.0, 4.0], [0.1, 0.1]), "two different frequencies"),
        (lambda: bm.rayleigh_damping("beam", [0.1, 0.1]), "of must be a Chain, modes, or frequencies in Hz"),
        (lambda: bm.rayleigh_damping(CHAIN, {1: 0.01, 2: -1}), r"ratios\[2\] must be .* got -1"),
        (lambda: bm.joint_dampers(CHAIN, {}), "ratio must have one ratio at least"),
        (lambda: bm.joint_dampers(CHAIN, {11: 0.1}), "mode must be .* at most 10, got 11"),
        (lambda: bm.ratio_from_decay([1.0]), "peaks must be two at least"),
        (lambda: bm.ratio_from_decay([1.0, 1.1]), "peaks must decay"),
        (lambda: bm.ratio_from_decay([1.0, -0.9, 0.8]), "all positive"),
        (
            lambda: bm.ratio_from_decay([2.0, 1.0], periods=[1, 1]),
            "periods must ascend, one for each of 2 peaks",
        ),
    ],
)
def test_bad_input(call: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def test_ratios_in_a_row_are_those_of_the_first_modes_and_percent_is_refused() -> None:
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=5)
    row = np.array([0.01, 0.012])
    assert bm.joint_dampers(chain, row) == bm.joint_dampers(chain, {1: 0.01, 2: 0.012})
    for damp in (bm.rayleigh_damping, bm.joint_dampers):
        with pytest.raises(
            ValueError, match=r"must be less than 1 \(0.01 is 1 % of critical\), got {2: 1.1}"
        ):
            damp(chain, {1: 0.8, 2: 1.1})
    with pytest.raises(ValueError, match="mode must be left out with ratios of several modes, got 2"):
        bm.joint_dampers(chain, row, mode=2)
