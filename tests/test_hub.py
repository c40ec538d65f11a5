"""A hub that turns freely with a beam standing out of it: its frequencies by three routes, chains, torque."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

import beammodes as bm
from beammodes.exact.spectral_beam import spectral_buckling, spectral_modes, spectral_solution
from beammodes.problem.applied_loads import PointLoad

#: A bar of 5 m, 20 x 20 mm (68.952 GPa, 2766.7 kg/m³), on a hub of radius 1 m and 5 kg m².
BAR = bm.Beam(5.0, 919.36, 1.10668)
HUB = bm.End.hub(hub_radius=1.0, rotary_inertia=5.0)


def characteristic(beam: bm.Beam, hub: bm.End, mass: float, stiffness: float) -> Callable[[Any], Any]:
    """The determinant of cos, sin, cosh and sinh between a hub and a tip with a mass and a spring, of ω."""
    length, bending, per_length = (
        mpmath.mpf(float(n))
        for n in (beam.length, beam.bending_stiffness, beam.mass_per_length)  # type: ignore[arg-type]
    )
    radius, inertia, spring = map(float, (hub.hub_radius, hub.rotary_inertia, hub.rotational_stiffness))

    def determinant(omega: Any) -> Any:
        k = mpmath.sqrt(omega) * (per_length / bending) ** 0.25
        c, s, ch, sh = (f(k * length) for f in (mpmath.cos, mpmath.sin, mpmath.cosh, mpmath.sinh))
        load = (mass * omega**2 - stiffness) / bending
        # y = R y' at the rim; moments about the axis, EI y'' - R EI y''' + (J ω² - K) y' = 0; at the tip
        # y'' = 0 and EI y''' + (m ω² - K) y = 0. Columns are the four waves.
        moment = (inertia * omega**2 - spring) / bending
        return mpmath.det(
            mpmath.matrix(
                [
                    [1, -radius * k, 1, -radius * k],
                    [-k, radius * k**2 + moment, k, -radius * k**2 + moment],
                    [-c, -s, ch, sh],
                    [
                        k**3 * s + load * c,
                        -(k**3) * c + load * s,
                        k**3 * sh + load * ch,
                        k**3 * ch + load * sh,
                    ],
                ]
            )
        )

    return determinant


def test_coupled_frequencies_are_roots_of_the_determinant() -> None:
    # The judge's two routes, waves in decimals and strains at Gauss points, and a determinant in 40 digits
    # that shares nothing with either, over hubs small and large, with and without a servo's spring.
    rng = random.Random(3)
    with mpmath.workdps(40):
        for _ in range(12):
            radius, inertia = 10 ** rng.uniform(-2, 0.7), 10 ** rng.uniform(-1.5, 2.5)
            hub = bm.End.hub(radius, inertia, rng.choice([0.0, 10 ** rng.uniform(0, 4)]))
            mass, stiffness = rng.choice([(0.0, 0.0), (10 ** rng.uniform(-1, 1), 0.0), (0.3, 40.0)])
            pair = bm.Boundary.of((hub, bm.End(stiffness, mass=mass)))
            exact = bm.euler_bernoulli(BAR, pair, 4)
            np.testing.assert_allclose(
                spectral_modes(BAR, pair, 4).angular_frequency, exact.angular_frequency, rtol=1e-11
            )
            determinant = characteristic(BAR, hub, mass, stiffness)
            for omega in exact.angular_frequency:
                signs = [mpmath.sign(determinant(mpmath.mpf(omega) * (1 + side))) for side in (-1e-12, 1e-12)]
                assert signs[0] * signs[1] == -1
    # And none is missed between them: 60 Hermite elements with the first node tied to the hub's angle give
    # 1.687631, 5.254098, 12.24282 Hz.
    frequency = bm.euler_bernoulli(BAR, (HUB, "free"), 3).frequency
    np.testing.assert_allclose(frequency, [1.687631, 5.254098, 12.24282], rtol=1e-6)


def test_no_radius_is_a_pinned_end_and_a_heavy_hub_a_clamp() -> None:
    plain = bm.End(math.inf, rotary_inertia=5.0)
    assert bm.End.hub(0.0, 5.0) == plain
    assert bm.euler_bernoulli(BAR, (plain, "free"), 1).frequency[0] == pytest.approx(1.7955, abs=5e-5)
    clamped = bm.euler_bernoulli(BAR, "clamped-free", 3).frequency
    for near in ((bm.End.hub(1.0, 1e12), "free"), ("free", bm.End.hub(1.0, 1e12))):
        np.testing.assert_allclose(bm.euler_bernoulli(BAR, near, 3).frequency, clamped, rtol=1e-9)
    # Shapes are clamped to the hub: y = R y' at its rim.
    modes = bm.euler_bernoulli(BAR, (HUB, "free"), 4)
    np.testing.assert_allclose(modes.shape([0.0]), 1.0 * modes.slope([0.0]), atol=1e-13)
    twice = spectral_modes(BAR, (HUB, "free"), 4)
    np.testing.assert_allclose(modes.shape([0.0, 2.0, 5.0]), twice.shape([0.0, 2.0, 5.0]), atol=1e-10)


@pytest.mark.parametrize(("rule", "order"), [("mitiguy", 2), ("gregory", 4), ("half_stub", 2)])
def test_chains_on_a_hub_keep_their_order(rule: str, order: int) -> None:
    for pair in ((HUB, "free"), (bm.End.hub(0.3, 40.0, 2000.0), bm.End(mass=2.0))):
        coarse, fine = (bm.chain_errors(bm.Chain(BAR, pair, n, rule), modes=2) for n in (24, 48))
        assert np.log2(np.abs(coarse / fine)).min() > order - 0.35
        assert np.abs(fine).max() < (1e-5 if order == 4 else 3e-3)


def test_lookups_know_hubs() -> None:
    # In the units of a beam and in multiples of its own, beside ends without hubs; chains solved one by one.
    clamped = "clamped-free(mass=1)"
    found = bm.frequency_error(
        [(HUB, "free"), clamped, ("free", HUB)], segments=10, mode=[[1], [2]], beam=BAR
    )
    hub, other = (bm.chain_errors(bm.Chain(BAR, pair, 10), modes=2) for pair in ((HUB, "free"), clamped))
    np.testing.assert_allclose(found.T, [hub, other, hub], atol=1e-12)
    own = bm.End.hub(1.0 / 5.0, 5.0 / (1.10668 * 5.0**3))
    assert bm.frequency_error((own, "free"), segments=10, mode=1) == pytest.approx(hub[0], abs=1e-12)
    needed = bm.segments_needed((own, "free"), tolerance=0.003, modes=1)
    few, enough = (bm.frequency_error((own, "free"), segments=needed - k, mode=1) for k in (1, 0))
    assert abs(enough) <= 0.003 < abs(few)


def test_hubs_at_either_end_under_loads_along_the_beam() -> None:
    # Pieces and both exact routes agree on what a pull does to a hub with a body off its axis; on buckling,
    # and with shear.
    odd = bm.End(math.inf, 300.0, mass=2.0, rotary_inertia=1.0, offset=0.3, hub_radius=0.8)
    for pair in ((odd, "free"), ("clamped", odd), (HUB, odd)):
        for load in (bm.Load(axial_force=50.0), bm.Load(tip_force=(50.0, 0.0)), bm.Load(gravity=(9.81, 0.0))):
            chain = bm.Chain(BAR, pair, 80, "gregory")
            found = bm.solve_modes(bm.linearize(chain, load=load), 2).angular_frequency
            modes = spectral_modes(BAR, pair, 2, load).angular_frequency
            np.testing.assert_allclose(found, modes, rtol=3e-5)
            if load.is_axial:
                exact = bm.euler_bernoulli(BAR, pair, 2, load=load).angular_frequency
                np.testing.assert_allclose(modes, exact, rtol=1e-11)
        load = bm.buckling_load(BAR, pair)
        assert spectral_buckling(BAR, pair) == pytest.approx(load, rel=1e-11)
        assert bm.buckling_load(bm.Chain(BAR, pair, 80, "gregory")) == pytest.approx(load, rel=3e-4)
    stout = bm.Beam.from_section(
        bm.Rectangle(0.2, 0.2), length=2.0, elastic_modulus=210e9, density=7800.0, poisson_ratio=0.3
    )
    pair = bm.Boundary.of((bm.End.hub(0.5, 100.0), "free"))
    thick = bm.timoshenko(stout, pair, 3)
    again = spectral_solution(thick.beam, pair, 3, bm.Load(), sheared=True).relative_frequency
    np.testing.assert_allclose(again * stout.frequency_unit, thick.angular_frequency, rtol=1e-10)


def torque(size: float, course: Any = None) -> bm.TimedLoad:
    """What a motor does to the hub: a moment at the beam's end, which is clamped to it."""
    return bm.TimedLoad(PointLoad(0.0, moment=size), course)


def test_a_small_torque_moves_hub_and_bar_as_the_exact_modes_say() -> None:
    # θ = τ (t²/2I + Σ θ_n² (1 - cos ω_n t)/ω_n²) with 20 modes of unit modal mass, I of the rigid whole.
    chain = bm.Chain(BAR, (HUB, "free"), 12, "gregory")
    inertia = 5.0 + 1.10668 * (6.0**3 - 1.0) / 3
    whole = float(
        (chain.mass * (chain.node_position[:-1] + 1.0 + chain.centre) ** 2 + chain.rotary_inertia).sum()
    )
    assert whole == pytest.approx(inertia, rel=1e-12)
    assert 250.0 / inertia == pytest.approx(2.96517, abs=5e-6)
    motion = bm.simulate(
        chain, duration=1.5, load=torque(1e-4), integrator="rk4", step=5e-4, output_step=0.05
    )
    time, modes = motion.time.values[:, None], bm.euler_bernoulli(BAR, (HUB, "free"), 20)
    omega, turn = modes.angular_frequency, modes.slope([0.0])[:, 0]
    shares = turn * (1 - np.cos(omega * time)) / omega**2
    rigid = time[:, 0] ** 2 / (2 * inertia)
    np.testing.assert_allclose(motion.angle[:, 0] / 1e-4, rigid + shares @ turn, atol=3e-4 * rigid[-1])
    bend = modes.shape([5.0])[:, 0] - 6.0 * turn
    np.testing.assert_allclose(
        motion.tip_deflection / 1e-4, shares @ bend, atol=2e-3 * abs(shares @ bend).max()
    )


@pytest.mark.parametrize("method", ["rk4", "midpoint", "sdirk2"])
@pytest.mark.parametrize("which", [0, 1])
def test_momentum_and_energy_of_a_driven_hub_balance(method: str, which: int) -> None:
    # Large turns, 250 N m on and off between steps: angular momentum about the axis is the torque's impulse,
    # and energy its work. The implicit methods keep the former to rounding.
    hub, size, course, impulse = (
        (HUB, 250.0, bm.Step(0.1003), 250.0 * (0.6 - 0.1003)),
        (bm.End.hub(0.2, 0.7), -40.0, bm.Pulse(0.3007, 0.0501, "half_sine"), -40.0 * 0.3007 * 2 / math.pi),
    )[which]
    chain = bm.Chain(BAR, (hub, "free"), 6)
    given: dict[str, Any] = {"duration": 0.6, "load": torque(size, course), "integrator": method}
    coarse, fine = (bm.simulate(chain, step=step, output_step=0.1, **given) for step in (1e-3, 5e-4))
    momenta = [abs(float(each.angular_momentum[-1]) / impulse - 1) for each in (coarse, fine)]
    assert momenta[1] < (2e-6 if which else 1e-7)
    if method != "rk4" and not which:
        assert max(momenta) < 1e-12
    gaps = [
        float(abs(each.energy - each.load_work).max() / abs(each.load_work).max()) for each in (coarse, fine)
    ]
    assert gaps[1] < {"rk4": 1e-6, "midpoint": 1e-5, "sdirk2": 1e-3}[method]
    assert abs(float(fine.angle[-1, 0])) > 0.05
    # Falls with the method's order, or faster.
    assert gaps[0] / gaps[1] > 0.8 * 2.0 ** {"rk4": 4, "midpoint": 2, "sdirk2": 2}[method]


def test_the_response_to_a_torque_is_a_sum_of_the_chains_modes() -> None:
    # A torque on the hub, read as the hub's angle; 1/(I ω²) of the whole as a rigid body.
    chain = bm.Chain(BAR, (HUB, "free"), 6)
    modes, square = bm.solve_modes(bm.linearize(chain)), (2 * math.pi * 3.0) ** 2
    centre = chain.node_position[:-1] + 1.0 + chain.centre
    whole = float((chain.mass * centre**2 + chain.rotary_inertia).sum())
    expected = np.sum(modes.rotation[:, 0] ** 2 / (modes.angular_frequency**2 - square)) - 1 / (
        whole * square
    )
    found = bm.frequency_response(chain, frequency=3.0, moment_at=0.0, rotation_at=0.0)
    assert complex(found.receptance) == pytest.approx(expected, rel=1e-10)


def test_what_a_hub_must_be_and_where_none_is_known() -> None:
    text = "pinned(rotary_inertia=5.0, hub_radius=1.0)-free"
    assert bm.Boundary.of(text) == bm.Boundary(HUB, bm.ENDS["free"]) and bm.Boundary.of(text).name == text
    chain = bm.Chain(BAR, text, 3)
    np.testing.assert_allclose(chain.node_position, [-1.0, 0.0, 5 / 3, 10 / 3, 5.0], atol=1e-14)
    np.testing.assert_allclose(chain.hinge_position, chain.node_position[1:-1])
    with pytest.raises(ValueError, match="hub_radius must be 0 unless the end holds the deflection"):
        bm.End(mass=1.0, rotary_inertia=1.0, hub_radius=0.5)
    with pytest.raises(ValueError, match="rotary_inertia must be greater than 0 of a hub"):
        bm.End.hub(0.5, 0.0)
    with pytest.raises(ValueError, match="hub_radius must not be negative"):
        bm.End.hub(-0.5, 1.0)
    for call in (
        lambda: bm.static_dataset(boundary=[(HUB, "pinned")], segments=[3]),
        lambda: bm.Structure.of_beam(BAR, (HUB, "free")),
        lambda: bm.frequency_response(BAR, (HUB, "free"), frequency=1.0, force_at=5.0, deflection_at=5.0),
        lambda: bm.linearize(bm.Chain(BAR, (HUB, "free"), 3), load=bm.Load(spin_rate=1.0)),
        lambda: bm.euler_bernoulli(BAR, (HUB, "free"), 1, load=bm.Load(spin_rate=1.0)),
    ):
        with pytest.raises(ValueError, match="no hub_radius here"):
            call()
