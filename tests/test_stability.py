"""The C-table as published, what its 8 is, and the chain's own limit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from drawn_ends import EVERY_N

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES
from beammodes.problem.load_in_space import SpatialLoad
from beammodes.problem.loading import Load
from beammodes.problem.motions import unit_beam
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodEnd
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import stability_limit
from beammodes.vibration.stability import (
    highest_angular_frequency,
    published_constants,
    published_time_step,
    stable_time_step,
)
from beammodes.vibration.tree_form import tree_form
from studies.c_table import exact_constants


def runge_kutta_amplification(z: complex) -> float:
    return abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)


def test_published_constants_have_the_reports_digits() -> None:
    # The report's table "Number of Modes / Constant K".
    assert published_constants().tolist() == [0.357, 0.130, 0.066, 0.040, 0.027]
    # theory.md section 1: with exact roots the first entry would print 0.358, the others as published.
    assert np.round(exact_constants(5), 3).tolist() == [0.358, 0.130, 0.066, 0.040, 0.027]


def test_the_eight_is_a_missing_square_root() -> None:
    limit = stability_limit("rk4")
    assert limit**2 == pytest.approx(8)
    assert runge_kutta_amplification(0.999 * limit * 1j) < 1 < runge_kutta_amplification(1.001 * limit * 1j)
    # theory.md section 1: |R(8i)| = 160 per step at the published step.
    assert runge_kutta_amplification(8j) == pytest.approx(160, rel=0.01)


def semi_implicit_euler_growth(z: float, steps: int) -> float:
    """Largest state of q'' = -z² q, unit step, from q = 1."""
    q, u, largest = 1.0, 0.0, 1.0
    for _ in range(steps):
        u -= z * z * q
        q += u
        largest = max(largest, abs(q))
    return largest


def test_semi_implicit_euler_is_stable_up_to_two() -> None:
    limit = stability_limit("semi_implicit_euler")
    assert semi_implicit_euler_growth(0.99 * limit, 2000) < 10
    assert semi_implicit_euler_growth(1.01 * limit, 2000) > 1e10


@pytest.mark.parametrize(("modes", "constant"), list(enumerate([0.357, 0.130, 0.066, 0.040, 0.027], start=1)))
def test_published_step_scales_as_the_report_says(modes: int, constant: float) -> None:
    beam = Beam(length=3.0, bending_stiffness=5.0, mass_per_length=0.2)
    assert published_time_step(beam, modes) == pytest.approx(constant * 9 * math.sqrt(0.2 / 5), rel=1e-14)


@pytest.mark.parametrize(
    ("boundary", "segments", "constant"),
    # theory.md section 6.
    [
        ("clamped-free", 4, 0.0305),
        ("clamped-free", 10, 0.00424),
        ("clamped-clamped", 4, 0.0324),
        ("clamped-clamped", 10, 0.00427),
    ],
)
def test_a_chains_own_constant(boundary: str, segments: int, constant: float) -> None:
    step = stable_time_step(Chain(Beam.unit(), boundary, segments), "rk4")
    assert float(f"{step:.3g}") == constant
    assert stable_time_step(Chain(Beam.unit(), boundary, segments), "leapfrog") == pytest.approx(
        step / math.sqrt(2), rel=1e-14
    )


@pytest.mark.parametrize("boundary", [pair.name for pair in BOUNDARIES])
@pytest.mark.parametrize("rule", ["mitiguy", "naive", "double_wall"])
def test_no_chain_exceeds_the_band_edge(boundary: str, rule: str) -> None:
    # theory.md section 6: ω_max ≤ √48 N², equal for guided-guided with its 2 EI/ell.
    for segments in (1, 2, 3, 8, 40):
        highest = highest_angular_frequency(Chain(Beam.unit(), boundary, segments, rule))
        assert highest <= math.sqrt(48) * segments**2 * (1 + 1e-12)
    if boundary == "guided-guided" and rule != "naive":
        assert highest == pytest.approx(math.sqrt(48) * segments**2, rel=1e-12)


@pytest.mark.parametrize("boundary", [pair.name for pair in BOUNDARIES])
def test_the_bound_of_long_chains_is_just_above_their_highest_frequency(
    boundary: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for rule in EVERY_N:
        chain = Chain(Beam(1.3, 2.0, 0.7), boundary, 120, rule)
        solved = highest_angular_frequency(chain)
        with monkeypatch.context() as patch:
            patch.setattr("beammodes.vibration.stability.MAX_DENSE", 50)
            bound = highest_angular_frequency(chain)
        assert solved * (1 - 1e-12) <= bound
        if rule in ("mitiguy", "naive", "double_wall"):
            assert bound <= 1.006 * solved


def test_the_bound_holds_for_uneven_chains(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = np.random.default_rng(4)
    for trial in range(100):
        pieces = int(generator.integers(2, 9))
        chain = Chain.from_pieces(
            length=generator.uniform(0.1, 1, pieces),
            mass=np.exp(generator.normal(0, 2, pieces)),
            rotary_inertia=generator.uniform(0.001, 0.1, pieces),
            joint_stiffness=np.exp(generator.normal(0, 2, pieces - 1)),
            boundary=BOUNDARIES[trial % 10],
        )
        solved = highest_angular_frequency(chain)
        with monkeypatch.context() as patch:
            patch.setattr("beammodes.vibration.stability.MAX_DENSE", 0)
            assert solved <= highest_angular_frequency(chain) * (1 + 1e-12)


def test_nothing_to_integrate_and_bad_arguments() -> None:
    rigid = Chain(Beam.unit(), "pinned-pinned", 1)
    assert stable_time_step(rigid) == math.inf
    with pytest.raises(ValueError, match=r"integrator.*'rk5'.*did you mean \"rk45\""):
        stable_time_step(rigid, "rk5")
    for modes in (0, 6, -1):
        with pytest.raises(ValueError, match="modes"):
            published_time_step(Beam.unit(), modes)
    with pytest.raises(TypeError, match="beam"):
        published_time_step(1.0, 1)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="chain"):
        stable_time_step("clamped-free")  # type: ignore[arg-type]


def _growth(integrator: str, mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, h: float) -> float:
    """Largest factor by which one step multiplies a motion, from the step's own matrix."""
    inverse, one, none = np.linalg.inv(mass), np.eye(len(mass)), np.zeros_like(mass)
    if integrator == "rk4":
        rate = h * np.block([[none, one], [-inverse @ stiffness, -inverse @ damping]])
        step = term = np.eye(2 * len(mass))
        for k in range(1, 5):
            term = term @ rate / k
            step = step + term
    else:
        implicit = np.linalg.inv(mass + h * damping) if integrator.startswith("implicit") else inverse
        kept = implicit @ mass if integrator.startswith("implicit") else one - h * inverse @ damping
        kick = -h * implicit @ stiffness
        step = np.block([[one + h * kick, h * kept], [kick, kept]])
    return float(np.abs(np.linalg.eigvals(step)).max())


def _in_twist(chain: AxialChain, damping: Damping) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, damping and stiffness matrices, spring by spring."""
    moving, inertia, springs = chain.moving
    own = np.concatenate([[0.0], damping.own_of_joints(chain), [0.0]])[moving.start : moving.stop + 1]
    apart = np.eye(len(springs), len(inertia)) - np.eye(len(springs), len(inertia), -1)
    stiffness = apart.T @ np.diag(springs) @ apart
    mass = np.diag(inertia)
    rates = damping.mass * mass + damping.stiffness * stiffness + apart.T @ np.diag(own) @ apart
    return mass, rates, stiffness


def _in_space(chain: SpatialChain, damping: Damping) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same in turns of the joints and readings of the supports, in the tree's own units of one."""
    form = tree_form(chain.tree)
    x = form.allowed(np.linalg.qr(form.forbidden, mode="complete")[0][:, form.forbidden.shape[1] :])
    kinetic, own = form.kinetic(x), damping.own_of_joints(chain)
    turns = (form.flexibility_root[:, None] * x)[-own.size :]
    mass, stiffness = kinetic.T @ kinetic, np.eye(x.shape[1])
    return (
        mass,
        damping.mass * mass + damping.stiffness * stiffness + turns.T @ (own.reshape(-1, 1) * turns),
        stiffness,
    )


def test_damped_twist_and_chains_in_space_grow_beyond_their_step(monkeypatch: pytest.MonkeyPatch) -> None:
    pulled = RodEnd((5.0, 0.0, 3.0), (2.0, 1.0, 0.0), mass=0.1, rotary_inertia=0.01)
    wire = {"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 1.0}
    arc = Rod.arc(1.0, length=1.0, polar_inertia_per_length=1e-3, **wire)
    chains: list[tuple[AxialChain | SpatialChain, tuple[np.ndarray, np.ndarray, np.ndarray], Damping]] = []
    for damping in (
        Damping(stiffness=1e-3),
        Damping(mass=0.5, joint=2e-3),
        Damping(0.1, 1e-4, (0.1, 0.0, 2e-3, 0, 0)),
    ):
        for ends in ("fixed-free", "free(stiffness=3)-free(inertia=0.4)"):
            rule = "half_stub" if "stiffness" in ends else "gregory"
            twist = AxialChain(unit_beam(), ends, 5 if rule == "gregory" else 4, rule)
            if isinstance(damping.joint, float) or len(twist.joint_stiffness) == 5:
                chains.append((twist, _in_twist(twist, damping), damping))
        for right in ("free", pulled):
            bent = SpatialChain(arc, ("clamped", right), 5, "half_stub")
            chains.append((bent, _in_space(bent, damping), damping))
    for chain, matrices, damping in chains:
        for name in ("rk4", "semi_implicit_euler", "implicit_damping_euler"):
            step = stable_time_step(chain, name, damping=damping)
            assert (
                _growth(name, *matrices, 0.999 * step) < 1 + 1e-7 < _growth(name, *matrices, 1.002 * step)
            ), name
            # Of long chains the answer is a bound, far below where one joint is damped alone.
            with monkeypatch.context() as patch:
                patch.setattr("beammodes.vibration.stability.MAX_DENSE", 0)
                patch.setattr("beammodes.vibration.stability.MOST_SOLVED", 0)
                patch.setattr("beammodes.vibration.highest_in_space.MOST_SOLVED", 0)
                assert 0.1 * step < stable_time_step(chain, name, damping=damping) <= step * (1 + 1e-9), (
                    name,
                    chain,
                )
        assert stable_time_step(chain, "implicit_euler", damping=damping) == math.inf
    with pytest.raises(ValueError, match=r"joint must have 5 entries"):
        stable_time_step(chains[0][0], damping=Damping(joint=(1.0, 2.0)))
    with pytest.raises(TypeError, match="load must be a SpatialLoad"):
        stable_time_step(chains[-1][0], load=Load())
    with pytest.raises(ValueError, match="load must be forces and gravity"):
        stable_time_step(chains[-1][0], load=SpatialLoad(torque=1.0))


def test_a_straight_chain_in_space_steps_as_its_stiffest_motion() -> None:
    rod = Rod(1.0, 1.0, 1.0, 1.0, 1e-4, second_bending_stiffness=4.0)
    chain = SpatialChain(rod, "clamped-free", 6, "gregory")
    alone = [
        stable_time_step(Chain(rod.planar(axis), "clamped-free", 6, "gregory"), "leapfrog") for axis in (1, 2)
    ]
    alone.append(
        stable_time_step(
            AxialChain(
                Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1e-4),
                "fixed-free",
                6,
                "gregory",
            ),
            "leapfrog",
        )
    )
    assert stable_time_step(chain, "leapfrog") == pytest.approx(min(alone), rel=1e-10)
    assert published_time_step(rod, 3) == pytest.approx(0.066 / 2)
    # Under weight as a planar chain that hangs: by the load along it.
    slow = Rod(1.0, 1e-6, 1e-6, 1.0, 1e-4)
    hanging = stable_time_step(SpatialChain(slow, "clamped-free", 6), load=SpatialLoad(gravity=(9.81, 0, 0)))
    planar = stable_time_step(Chain(slow.planar(2), "clamped-free", 6), load=Load(gravity=(9.81, 0.0)))
    assert hanging == pytest.approx(planar, rel=1e-10)
