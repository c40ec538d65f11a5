"""Critical loads against printed ones and against the static determinant solved in 50 digits."""

from __future__ import annotations

import math
import random
from typing import Any

import mpmath as mp
import pytest

from beammodes.exact.supported_beam import critical_compression
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS, Boundary, End

UNIT = Beam.unit()

# In units of EI/L². Source: Timoshenko and Gere, Theory of Elastic Stability (1961), chapter 2: multiples of
# π², and z² of tan z = z for clamped-pinned.
PLAIN = {
    "pinned-pinned": math.pi**2,
    "clamped-clamped": 4.0 * math.pi**2,
    "clamped-free": math.pi**2 / 4.0,
    "clamped-pinned": 20.19072855642663,
    "clamped-guided": math.pi**2,
    "pinned-guided": math.pi**2 / 4.0,
    "guided-guided": math.pi**2,
    "guided-free": math.pi**2 / 4.0,
}


@pytest.mark.parametrize(("boundary", "expected"), PLAIN.items())
def test_plain_pairs(boundary: str, expected: float) -> None:
    pair = Boundary.of(boundary)
    for either in (pair, pair.turned):
        assert critical_compression(UNIT, either) == pytest.approx(expected, rel=3e-16)


@pytest.mark.parametrize("stiffness", [1e-12, 1e-3, 1.0, 9.0])
def test_soft_springs_let_the_straight_beam_turn(stiffness: float) -> None:
    """Source: moments about the middle, P θ = 2 k (θ/2)(1/2), and about the hinge, P θ = k θ."""
    spring = End(stiffness)
    assert critical_compression(UNIT, (spring, spring)) == pytest.approx(stiffness / 2.0, rel=3e-16)
    assert critical_compression(UNIT, ("pinned", spring)) == pytest.approx(stiffness, rel=3e-16)


@pytest.mark.parametrize("stiffness", [20.0, 1e4])
def test_firm_springs_let_it_bend_first(stiffness: float) -> None:
    """Source: the half sine wave needs no force at its ends."""
    assert critical_compression(UNIT, (End(stiffness), End(stiffness))) == pytest.approx(
        math.pi**2, rel=3e-16
    )


@pytest.mark.parametrize("stiffness", [1e-9, 1e-3, 1.0, 1e3, 1e9])
def test_a_hinge_with_a_spring(stiffness: float) -> None:
    """Source: z tan z = K_r L/EI of a column free at the top, Timoshenko and Gere, chapter 2."""
    z = math.sqrt(critical_compression(UNIT, (End(math.inf, stiffness), "free")))
    with mp.workdps(30):
        left = mp.mpf(stiffness) * mp.cos(z) - z * mp.sin(z)
        slope = -mp.mpf(stiffness) * mp.sin(z) - mp.sin(z) - z * mp.cos(z)
        assert abs(left / slope) < 2e-16 * z


def static_determinant(boundary: Boundary, load: Any) -> Any:
    """Return the determinant of 1, x, cos zx, sin zx in the four end conditions, z² being the load."""
    z, rows = mp.sqrt(load), []
    for end, side, x in ((boundary.left, -1, mp.mpf(0)), (boundary.right, 1, mp.mpf(1))):
        c, s = mp.cos(z * x), mp.sin(z * x)
        y, slope, curvature = [1, x, c, s], [0, 1, -z * s, z * c], [0, 0, -z * z * c, -z * z * s]
        force = [0, -load * side, 0, 0]  # -y''' - P y'
        for held, spring, motion, inner in (
            (end.holds_deflection, end.translational_stiffness, y, force),
            (end.holds_rotation, end.rotational_stiffness, slope, [side * value for value in curvature]),
        ):
            pairs = zip(inner, motion, strict=True)
            rows.append(motion if held else [a + mp.mpf(float(spring)) * b for a, b in pairs])
    if loose(boundary):  # The translation feels nothing: without it and one of the two equal force balances.
        rows = [row[1:] for row in rows[1:]]
    return mp.det(mp.matrix(rows))


def loose(boundary: Boundary) -> bool:
    return not any(end.translational_stiffness for end in (boundary.left, boundary.right))


@pytest.mark.parametrize("seed", range(30))
def test_random_supports_against_the_static_determinant(seed: int) -> None:
    """No smaller root by a scan of signs, and this one where the determinant changes sign."""
    chance = random.Random(seed)
    number = lambda: chance.choice([0.0, math.inf, *[10.0 ** chance.uniform(-5.0, 5.0)] * 3])  # noqa: E731
    boundary = Boundary(End(number(), number()), End(number(), number()))
    if boundary.rigid_body_modes > loose(boundary):
        return
    critical = mp.mpf(critical_compression(UNIT, boundary))
    with mp.workdps(60):
        at = [static_determinant(boundary, critical * (1 + sign * mp.mpf("4e-16"))) for sign in (-1, 1)]
        assert at[0] * at[1] < 0
        scan = [static_determinant(boundary, critical * (n - mp.mpf("0.01")) / 40) for n in range(1, 41)]
    assert len({mp.sign(value) for value in scan}) == 1


def test_bodies_do_not_matter_and_units_do() -> None:
    beam = Beam(length=1.7, bending_stiffness=83.0, mass_per_length=0.45)
    body = End(mass=3.0, rotary_inertia=0.2, offset=0.4)
    found = critical_compression(beam, ("clamped", body))
    assert found == pytest.approx(math.pi**2 / 4.0 * 83.0 / 1.7**2, rel=5e-16)


@pytest.mark.parametrize("boundary", ["pinned-free", "free-free", (ENDS["free"], End(5.0))])
def test_what_turns_over_at_once_has_no_critical_load(boundary: Any) -> None:
    with pytest.raises(
        ValueError, match=r"^boundary must resist a turn.*turns over under any compression, got"
    ):
        critical_compression(UNIT, boundary)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(TypeError, match=r"^beam must be a Beam"):
        critical_compression(None, "pinned-pinned")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^beam must be uniform"):
        critical_compression(Beam(1.0, [1.0, 2.0], 1.0), "pinned-pinned")
    with pytest.raises(ValueError, match=r"^boundary must"):
        critical_compression(UNIT, "pinned-pined")
