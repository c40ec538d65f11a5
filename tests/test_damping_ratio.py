"""Damping ratios: the one asked for, those of all other modes, and the steps that stay stable with them."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import beammodes as bm
from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.dynamics.simulation import DivergedWarning, UnstableStepWarning, mode_start, simulate
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping, damped_modes, damping_of_modes, joint_dampers
from beammodes.vibration.integrators import INTEGRATORS, stability_limit
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

UNIT = Beam.unit()
SPRUNG = "pinned(rotational_stiffness=3)-free(translational_stiffness=5, mass=0.2, rotary_inertia=0.01)"
#: Of fixed step, with a limit.
LIMITED = [
    name for name, each in INTEGRATORS.items() if each.springs == "explicit" and not each.variable_step
]
EVERY_INTEGRATOR = pytest.mark.parametrize("integrator", LIMITED)


def oscillator(**damping: Any) -> tuple[Chain, Damping, float]:
    """One rod on one hinge: θ'' + 2 ζ ω θ' + ω² θ = 0 with ω = 3."""
    chain = Chain(UNIT, "clamped-free", segments=1)
    return chain, Damping(**damping), 3.0


def matrices(chain: Chain, damping: Damping) -> tuple[Any, Any, Any]:
    """M, C and K in nodal coordinates, the damping matrix as `Damping` defines it."""
    model = linearize(chain)
    bend = model.joint_rotations
    own = np.broadcast_to(np.asarray(damping.joint, dtype=float), len(bend))
    mass, stiffness = model.mass_matrix, model.stiffness_matrix
    return mass, damping.mass * mass + damping.stiffness * stiffness + (bend.T * own) @ bend, stiffness


def first_order(chain: Chain, damping: Damping) -> Any:
    mass, drag, stiffness = matrices(chain, damping)
    zero = np.zeros_like(mass)
    inverse = np.linalg.inv(mass)
    return np.block([[zero, np.eye(len(mass))], [-inverse @ stiffness, -inverse @ drag]])


CASES = [
    (Chain(UNIT, "clamped-free", 5), Damping(joint=(0.3, 0.0, 0.02, 0.0, 0.05))),
    (Chain(UNIT, "clamped-clamped", 5, "gregory"), Damping(mass=2.0, joint=0.004)),
    (Chain(UNIT, SPRUNG, 4), Damping(mass=0.5, stiffness=0.003, joint=0.01)),
    (Chain(UNIT, "free-free", 4), Damping(mass=3.0, stiffness=1e-3, joint=(0.0, 0.02, 0.0))),
    (Chain(UNIT, "pinned-pinned", 6, "half_stub"), Damping(mass=1.0, stiffness=0.001)),
]
EVERY_CASE = pytest.mark.parametrize(("chain", "damping"), CASES, ids=lambda value: shown(value)[:40])


# --- Ratios --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "free-free", SPRUNG])
@pytest.mark.parametrize("mode", [1, 3])
def test_the_mode_gets_the_ratio_and_others_in_proportion(boundary: str, mode: int) -> None:
    chain = Chain(UNIT, boundary, segments=6, rule="gregory")
    found = damped_modes(chain, joint_dampers(chain, 0.02, mode=mode))
    omega = solve_modes(linearize(chain)).angular_frequency
    assert found.damping_ratio.sel(mode=mode).item() == pytest.approx(0.02, rel=1e-13)
    assert found.damping_ratio.values == pytest.approx(0.02 * omega / omega[mode - 1], rel=1e-12)


def test_the_dampers_are_in_proportion_to_the_springs() -> None:
    chain = Chain(Beam(1.2, 85.0, 0.62), "clamped-free", segments=4)
    damping = joint_dampers(chain, 0.03)
    omega = solve_modes(linearize(chain), 1).angular_frequency[0]
    assert damping.joint_damping(chain) == pytest.approx(0.06 / omega * chain.joint_stiffness, rel=1e-14)
    assert damping == Damping(stiffness=0.06 / omega)


@pytest.mark.parametrize("ratio", [0.1, 1.0, 4.0])
def test_single_oscillator(ratio: float) -> None:
    # 2 ζ ω = β ω²; overdamped, the rates are ω (ζ ± √(ζ² - 1)).
    chain, damping, omega = oscillator(stiffness=2 * ratio / 3.0)
    row = damped_modes(chain, damping).isel(mode=0)
    assert row.damping_ratio.item() == pytest.approx(ratio, rel=1e-13)
    under = omega * math.sqrt(max(0.0, 1 - ratio**2))
    assert row.damped_angular_frequency.item() == pytest.approx(under, rel=1e-12, abs=1e-6)
    slow = omega * (ratio - math.sqrt(max(0.0, ratio**2 - 1)))
    assert row.decay_rate.item() == pytest.approx(slow, rel=1e-7)


@EVERY_CASE
def test_pairs_are_eigenvalues_of_the_damped_chain(chain: Chain, damping: Damping) -> None:
    found = damped_modes(chain, damping)
    natural, ratio = found.natural_angular_frequency.values, found.damping_ratio.values
    root = np.sqrt((ratio**2 - 1).astype(complex))
    pairs = np.concatenate([-natural * (ratio + root), -natural * (ratio - root)])
    expected = np.linalg.eigvals(first_order(chain, damping))
    for value in pairs:
        assert np.abs(expected - value).min() < 1e-7 * abs(value)
    assert len(pairs) == len(expected) - 2 * chain.boundary.rigid_body_modes


def test_dampers_of_a_loaded_chain_are_those_of_its_springs() -> None:
    # An axial force adds to K and not to C; the springs at both ends have their dampers.
    chain, damping, load = (
        Chain(UNIT, SPRUNG, 4),
        Damping(stiffness=0.003, joint=0.01),
        Load(axial_force=20.0),
    )
    mass, drag, _ = matrices(chain, damping)
    pulled = linearize(chain, load=load).stiffness_matrix
    inverse = np.linalg.inv(mass)
    modal = damping_of_modes(chain, damping, load)
    found, expected = (
        np.sort_complex(np.linalg.eigvals(np.block([[0 * c, np.eye(len(c))], [-k, -c]])))
        for k, c in (
            (np.diag(modal.angular_frequency**2), modal.coupling),
            (inverse @ pulled, inverse @ drag),
        )
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_nested_pairs_of_real_eigenvalues_are_those_of_proportional_dampers() -> None:
    # The same dampers once as β and once joint by joint: pairs must agree, real ones too.
    chain = Chain(UNIT, "clamped-free", 8)
    by_beta = joint_dampers(chain, 0.1)
    by_joint = Damping(joint=tuple(by_beta.joint_damping(chain)))
    one, other = damped_modes(chain, by_beta), damped_modes(chain, by_joint)
    assert int((one.damping_ratio > 1).sum()) >= 4
    for name in one.data_vars:
        assert other[name].values == pytest.approx(one[name].values, rel=1e-6)


def test_table_is_labelled() -> None:
    found = damped_modes(Chain(UNIT, "free-free", 4), Damping(mass=1.0))
    assert dict(found.sizes) == {"mode": 3} and found.mode.values.tolist() == [1, 2, 3]
    assert found.attrs["rigid_body_modes"] == 2 and found.attrs["source"].startswith("beammodes ")
    assert all({"long_name", "units"} <= set(column.attrs) for column in found.data_vars.values())


def test_logarithmic_decrement_of_a_simulated_mode() -> None:
    chain, ratio = Chain(UNIT, "clamped-free", segments=4), 0.02
    damping = joint_dampers(chain, ratio)
    omega = damped_modes(chain, damping).damped_angular_frequency.values[0]
    period = 2 * math.pi / omega
    motion = simulate(
        chain,
        duration=6 * period,
        step=period / 400,
        output_step=period / 400,
        initial=mode_start(chain, 1, 1e-3),
        damping=damping,
    )
    tip = motion.tip_deflection.values
    peaks = [i for i in range(1, len(tip) - 1) if tip[i - 1] < tip[i] >= tip[i + 1]]
    assert len(peaks) == 5
    decrement = math.log(tip[peaks[0]] / tip[peaks[-1]]) / (len(peaks) - 1)
    assert decrement == pytest.approx(2 * math.pi * ratio / math.sqrt(1 - ratio**2), rel=0.005)


# --- Steps ---------------------------------------------------------------------------------------------


def test_runge_kutta_limits_of_the_axes() -> None:
    assert stability_limit("rk4", 0.0) == pytest.approx(2 * math.sqrt(2), rel=1e-14)
    assert stability_limit("rk4", 1.0) == pytest.approx(2.785293563405282, rel=1e-14)
    # The real root of z³ + 4 z² + 12 z + 24 = 0, which is R(z) = 1 without z = 0.
    assert np.polyval([1, 4, 12, 24], -stability_limit("rk4", 1.0)) == pytest.approx(0.0, abs=1e-12)


def test_rays_leave_the_region_of_stability_once_and_there() -> None:
    ratio = np.linspace(0.0, 1.0, 201)
    limit = np.array([stability_limit("rk4", value) for value in ratio])
    assert (limit > 2.61).all() and (limit < 2.97).all()
    scale = np.concatenate([np.linspace(0.05, 1 - 1e-9, 300), np.linspace(1 + 1e-9, 3.0, 300)])
    z = scale * (limit * (-ratio + 1j * np.sqrt(1 - ratio**2)))[:, None]
    growth = np.abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) - 1
    assert (growth[:, :300] < 1e-12).all() and (growth[:, 300:] > 0).all()


@pytest.mark.parametrize("ratio", [0.001, 0.1, 0.7, 1.0, 3.0])
def test_limits_of_one_oscillator(ratio: float) -> None:
    chain, damping, omega = oscillator(stiffness=2 * ratio / 3.0)
    fastest = ratio + math.sqrt(max(ratio**2 - 1, 0))
    expected = stability_limit("rk4", ratio) if ratio < 1 else 2.785293563405282 / fastest
    assert stable_time_step(chain, damping=damping) == pytest.approx(expected / omega, rel=1e-6)
    # 2 (√(1 + ζ²) ∓ ζ): R² + (s² - 2 ± ...) R + ... has the root -1 there.
    for integrator in (name for name in LIMITED if not INTEGRATORS[name].stages):
        sign = 1 if INTEGRATORS[integrator].damping == "implicit" else -1
        expected = 2 * (math.sqrt(1 + ratio**2) + sign * ratio) / omega
        assert stable_time_step(chain, integrator, damping=damping) == pytest.approx(expected, rel=1e-12)
        assert stability_limit(integrator, ratio) == pytest.approx(expected * omega, rel=1e-12)


@EVERY_INTEGRATOR
@pytest.mark.parametrize("boundary", ["clamped-free", "free-free", SPRUNG])
def test_without_damping_it_is_the_undamped_limit(boundary: str, integrator: str) -> None:
    chain = Chain(UNIT, boundary, segments=5)
    expected = stable_time_step(chain, integrator)
    assert stable_time_step(chain, integrator, damping=Damping(joint=1e-300)) == pytest.approx(
        expected, rel=1e-12
    )


def one_step(chain: Chain, damping: Damping, step: float, integrator: str) -> Any:
    """The matrix of one step of the linear chain."""
    record = INTEGRATORS[integrator]
    if record.stages:
        rates: list[Any] = []
        z = step * first_order(chain, damping)
        for row in record.stages:
            rates.append(z @ (np.eye(len(z)) + sum(a * k for a, k in zip(row, rates, strict=False))))
        return np.eye(len(z)) + sum(b * k for b, k in zip(record.weights, rates, strict=True))
    mass, drag, stiffness = matrices(chain, damping)
    eye, inverse = np.eye(len(mass)), np.linalg.inv(mass)
    k, c = inverse @ stiffness, inverse @ drag
    if integrator == "leapfrog":
        # (x, previous x): the drag is that of the velocity half a step ago.
        return np.block([[2 * eye - step**2 * k - step * c, step * c - eye], [eye, 0 * eye]])
    far = 0 * c
    if INTEGRATORS[integrator].damping == "implicit":
        # All dampers, or all but those of the far support, which MuJoCo has as tendons.
        far = inverse @ far_drag(chain, damping) if INTEGRATORS[integrator].tendon_damping else 0 * c
        slowed = np.linalg.inv(eye + step * (c - far))
        kick = np.block([[eye, 0 * eye], [-step * slowed @ k, slowed @ (eye - step * far)]])
    else:
        kick = np.block([[eye, 0 * eye], [-step * k, eye - step * c]])
    return np.block([[eye, step * eye], [0 * eye, eye]]) @ kick


def far_drag(chain: Chain, damping: Damping) -> Any:
    """Dampers between the right end and the ground, in nodal coordinates."""
    coordinates = linearize(chain).coordinates
    found = np.zeros((len(coordinates), len(coordinates)))
    translation, rotation = chain.support_stiffness[1]
    last = [k for k, name in enumerate(coordinates) if name.startswith("y")][-1]
    found[last, last] = damping.stiffness * translation if np.isfinite(translation) else 0.0
    if rotation == math.inf:
        bend = linearize(chain).joint_rotations[-1]
        found += damping.joint_damping(chain)[-1] * np.outer(bend, bend)
    else:
        assert rotation == 0
    return found


@EVERY_INTEGRATOR
@EVERY_CASE
def test_limits_are_those_of_the_matrix_of_a_step(chain: Chain, damping: Damping, integrator: str) -> None:
    limit = stable_time_step(chain, integrator, damping=damping)
    # Rigid-body motion is a double eigenvalue 1 at any step, in double precision up to 1e-7.
    radius = [
        np.abs(np.linalg.eigvals(one_step(chain, damping, factor * limit, integrator))).max()
        for factor in (0.3, 0.9, 0.999, 1.001, 1.01)
    ]
    assert max(radius[:3]) < 1 + 1e-6 < min(radius[3:])


@EVERY_INTEGRATOR
@pytest.mark.parametrize("boundary", ["clamped-free", "free-clamped", "clamped-clamped", SPRUNG])
@pytest.mark.parametrize("load", [Load(), Load(axial_force=30.0)])
@pytest.mark.parametrize("ratio", [0.001, 0.1])
def test_bounds_of_long_chains_are_below_the_limit(
    ratio: float, load: Load, boundary: str, integrator: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = Chain(UNIT, boundary, 30)
    damping = joint_dampers(chain, ratio)
    limit = stable_time_step(chain, integrator, load=load, damping=damping)
    monkeypatch.setattr("beammodes.vibration.stability.MAX_DENSE", 10)
    bound = stable_time_step(chain, integrator, load=load, damping=damping)
    assert bound <= limit * (1 + 1e-9)
    # It is close where dampers and springs have one shape, and Runge-Kutta's takes the least of all rays.
    record = INTEGRATORS[integrator]
    if load == Load() and not record.stages and "free" in boundary and boundary != SPRUNG:
        assert bound > 0.9 * limit


@pytest.mark.parametrize("ratio", [0.001, 0.05])
def test_the_limit_decides_in_a_simulation(ratio: float) -> None:
    chain = Chain(UNIT, "clamped-free", segments=4)
    damping = joint_dampers(chain, ratio)
    limit = stable_time_step(chain, damping=damping)
    assert (limit > stable_time_step(chain)) == (ratio < 0.01)
    top: Any = {"initial": mode_start(chain, 4, 1e-6), "damping": damping, "output_step": 1e-9}
    steady = simulate(chain, duration=1500 * limit, step=0.99 * limit, **top)
    assert abs(steady.tip_deflection.values).max() < 2e-6 and steady.attrs["complete"] == 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DivergedWarning)
        warnings.simplefilter("ignore", UnstableStepWarning)
        wild = simulate(chain, duration=1500 * limit, step=1.02 * limit, **top)
    grown = abs(wild.tip_deflection.values[np.isfinite(wild.tip_deflection.values)]).max()
    assert wild.attrs["complete"] == 0 or grown > 1e3 * abs(steady.tip_deflection.values).max()


def test_a_free_chain_dragged_through_a_fluid_limits_the_step() -> None:
    # A rigid motion decays at rate α: a damping so strong decides alone.
    chain, damping = Chain(UNIT, "free-free", 2), Damping(mass=1e6)
    assert stable_time_step(chain, damping=damping) == pytest.approx(2.785293563405282e-6, rel=1e-6)
    assert stable_time_step(chain, "leapfrog", damping=damping) == pytest.approx(2e-6, rel=1e-6)


def test_a_chain_that_cannot_move_takes_any_step() -> None:
    chain = Chain(UNIT, "clamped-clamped", 1)
    assert all(stable_time_step(chain, name, damping=Damping(joint=1.0)) == math.inf for name in LIMITED)
    assert damped_modes(chain, Damping(joint=1.0)).sizes["mode"] == 0
    with pytest.raises(ValueError, match=r"^chain must have an elastic mode to damp"):
        joint_dampers(chain, 0.01)


# --- Bad input -----------------------------------------------------------------------------------------

CHAIN = Chain(UNIT, "clamped-free", 2)
bad = st.one_of(
    st.text(), st.none(), st.booleans(), st.complex_numbers(), st.floats(max_value=0.0),
    st.sampled_from([math.nan, math.inf, 0, -1, 10**400, {0.1}, b"1"]),
)  # fmt: skip


@given(ratio=bad)
def test_what_is_no_ratio(ratio: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^ratio must be ") as info:
        joint_dampers(CHAIN, ratio)
    assert shown(ratio) in str(info.value)


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: joint_dampers(UNIT, 0.1), TypeError, "chain must be a Chain"),  # type: ignore[arg-type]
        (lambda: joint_dampers(CHAIN, 0.1, mode=3), ValueError, "mode must be .* at most 2, got 3"),
        (lambda: joint_dampers(CHAIN, 0.1, mode=0), ValueError, "mode must be .* at least 1"),
        (lambda: damped_modes(CHAIN, 0.1), TypeError, "damping must be a Damping, got 0.1"),  # type: ignore[arg-type]
        (lambda: damped_modes(CHAIN, Damping(joint=(1, 2, 3))), ValueError, "joint must have 2 entries"),
        (lambda: stable_time_step(UNIT, damping=Damping()), TypeError, "chain must be"),  # type: ignore[arg-type]
        (
            lambda: stable_time_step(CHAIN, "rk", damping=Damping()),
            ValueError,
            "integrator must be one of rk4",
        ),
        (lambda: damped_modes(Chain(UNIT, "clamped-free", 501), Damping()), ValueError, "at most 500 hinges"),
        (lambda: stability_limit("rk4", -0.1), ValueError, "damping_ratio must be finite and not negative"),
        (lambda: stability_limit("rk45"), ValueError, '"rk45" chooses its steps itself'),
        (lambda: stable_time_step(CHAIN, damping=0.1), TypeError, "damping must be a Damping or None"),  # type: ignore[arg-type]
    ],
)
def test_bad_input(call: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


def test_dampers_in_twist_and_in_space_give_a_mode_its_ratio() -> None:
    shaft = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=2.0, polar_inertia_per_length=0.3)
    twisting = bm.AxialChain(shaft, "fixed-free", 5, motion="twist")
    rod = bm.SpatialChain(bm.Rod.arc(1.0, length=1.0, bending_stiffness=1.3, torsional_stiffness=1.0,
                                     mass_per_length=1.0), "clamped-free", 5)  # fmt: skip
    for chain, omega in (
        (twisting, bm.solve_modes(twisting, 3).angular_frequency),
        (rod, bm.spatial_modes(rod, 3).angular_frequency),
    ):
        # β ω/2, by what `Damping` says of its stiffness.
        beta = bm.joint_dampers(chain, 0.02, mode=3).stiffness
        assert beta * omega[2] / 2 == pytest.approx(0.02, rel=1e-12)
        with pytest.raises(ValueError, match="mode must be"):
            bm.joint_dampers(chain, 0.02, mode=40)
        with pytest.raises(TypeError, match="ratio must be"):
            bm.joint_dampers(chain, {1: 0.1, 2: 0.2})
