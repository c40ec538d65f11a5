"""Large deflection and stability in space: against the planar chain, other programs and closed forms."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc
from shared_cases import BEND, INF, ROUND

import beammodes as bm
from beammodes.equations.equilibria_in_space import _Statics
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import rotation, rotation_vector

THEORY = (Path(bm.__file__).parent / "pages" / "theory.md").read_text(encoding="utf-8")

# The exact rod, BEND, that neither shears nor stretches under 600 across its plane, by boundary values, 1e-7.
BEND_TIP = np.array([47.1512944, 15.6850782, 53.4685984])
# A beam ten thousand times as stiff in the plane of its load as across it.
NARROW = bm.Rod(1.0, 1e8, 1.0, 1.0, second_bending_stiffness=1.0)
# Timoshenko and Gere, Theory of Elastic Stability, 6.3: the root of J_{-1/4}(F/2) is 2 x 2.0063.
LATERAL = 4.012599344


def test_the_tangent_is_the_rate_of_the_residual() -> None:
    draw = np.random.default_rng(0)
    held: Any = (
        bm.RodEnd(INF, (INF, 0, 3e5)),
        bm.RodEnd((INF, 0, INF), (0, INF, INF)),
    )
    load = bm.SpatialLoad((100, 200, 300), (1e4, 2e4, 3e4), 1e4, (1, 2, 3))
    sprung: Any = ("clamped", bm.RodEnd((1e3, 2e3, 3e3), (1e6, 2e6, 3e6)))
    partly: Any = ("clamped", bm.RodEnd((INF, 0, 1e3), (INF, 1e6, INF)))
    cases = [("clamped-free", "ball"), (held, "ball"), (held, "yzx_alternating"), (sprung, "ball")]
    for boundary, joints in (*cases, (sprung, "xyz"), (partly, "ball"), ("clamped-clamped", "zxy")):
        chain = bm.SpatialChain(BEND, boundary, 4, "double_wall")
        statics = _Statics(chain, bm.JOINT_LAWS[joints], None, None)
        q = np.where(np.isfinite(statics.stiffness), 0.3 * draw.normal(size=(statics.count, 3)), 0.0)
        push = 300 * draw.normal(size=statics.held)
        _, _, tangent, rows = statics.residual(q, push, load)
        free = np.flatnonzero(statics._active)
        for column, entry in enumerate(free):
            step = np.zeros(q.size)
            step[entry] = 1e-6
            ahead, behind = (statics.residual(q + s * step.reshape(-1, 3), push, load) for s in (1, -1))
            rate = (ahead[0] - behind[0]) / 2e-6
            np.testing.assert_allclose(tangent[:, column], rate, atol=1e-8 * np.abs(tangent).max())
            rate = (ahead[1] - behind[1]) / 2e-6
            np.testing.assert_allclose(rows[:, column], rate, atol=1e-6)


@pytest.mark.parametrize("joints", ["ball", "zyx"])
def test_in_one_plane_it_is_the_planar_chain(joints: str) -> None:
    # Tip force, moment and weight in the plane of x and y, far beyond small deflections.
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", 8, "gregory")
    planar = bm.find_equilibrium(chain, bm.Load(tip_force=(-2.0, 3.0), tip_moment=1.0, gravity=4.0))
    load = bm.SpatialLoad((-2.0, 3.0, 0.0), (0.0, 0.0, 1.0), gravity=(0.0, -4.0, 0.0))
    spatial = bm.spatial_equilibrium(
        bm.SpatialChain(bm.Rod(1.0, 1.0, 0.8, 1.0), "clamped-free", 8, "gregory"), load, joints=joints
    )
    np.testing.assert_allclose(spatial.tip[:2], planar.nodes[-1], atol=1e-10)
    assert abs(spatial.tip[2]) < 1e-12 and spatial.is_stable


def test_the_bend_of_45_degrees() -> None:
    load = bm.SpatialLoad(force=(0, 0, 600))
    rest = BEND.frames([BEND.length])[1][0]
    errors, tips = {}, []
    for rule in ("naive", "double_wall"):
        for segments in (10, 20, 40):
            found = bm.spatial_equilibrium(bm.SpatialChain(BEND, "clamped-free", segments, rule), load)
            tips.append(found.tip)
            errors[rule, segments] = np.linalg.norm(found.tip - BEND_TIP) / np.linalg.norm(BEND_TIP - rest)
    # Errors of another program's chains of the same springs and ball joints, in percent.
    printed = {
        ("naive", 10): 8.63,
        ("naive", 40): 2.21,
        ("double_wall", 10): 0.408,
        ("double_wall", 40): 0.0254,
    }
    for case, percent in printed.items():
        assert 100 * errors[case] == pytest.approx(percent, rel=5e-3)
    richardson = tips[-1] + (tips[-1] - tips[-2]) / 3
    assert np.abs(richardson - BEND_TIP).max() < 1e-4


def test_a_tip_force_grows_to_a_hundred_on_the_branch_of_the_elastica() -> None:
    # Bisshopp and Drucker 1945: √α = K(m) - F(φ, m), m = (1 + sin θ)/2 of the tip's slope θ, sin²φ = 1/2m.
    # A chain of many joints may jump to a looped branch though each joint turns little.
    chain = bm.SpatialChain(bm.Rod(1.0, **ROUND), "clamped-free", 40, "double_wall")
    for alpha in (15.0, 30.0, 100.0):

        def missed(m: float, root: float = math.sqrt(alpha)) -> float:
            return float(ellipk(m) - ellipkinc(math.asin(1.0 / math.sqrt(2.0 * m)), m) - root)

        m = brentq(missed, 0.5 + 1e-9, 1.0 - 1e-13, xtol=1e-15)
        phi, root = math.asin(1.0 / math.sqrt(2.0 * m)), math.sqrt(alpha)
        down = 1.0 - 2.0 / root * (ellipe(m) - ellipeinc(phi, m))
        found = bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(0.0, 0.6 * alpha, 0.8 * alpha)))
        assert found.is_stable
        assert found.tip == pytest.approx(
            [math.sqrt((4 * m - 2) / alpha), 0.6 * down, 0.8 * down], abs=1.5e-3
        )


def test_a_slanting_push_beyond_eulers_load_bends_the_way_it_slants() -> None:
    # EI θ'' = -(P sin θ + Q cos θ), θ(0) = 0 and θ'(1) = 0, shot from the clamp; Newton alone finds the
    # pushed branch that hardly bends, the wrong way, and falls.
    def shot(start: float) -> Floats:
        def rate(_: float, y: Floats) -> list[float]:
            return [y[1], -10.0 * math.sin(y[0]) - 0.1 * math.cos(y[0]), math.cos(y[0]), math.sin(y[0])]

        return np.asarray(solve_ivp(rate, (0.0, 1.0), [0.0, start, 0.0, 0.0], rtol=1e-9, atol=1e-11).y[:, -1])

    start = brentq(lambda value: float(shot(value)[1]), 2.0, 7.0)
    chain = bm.SpatialChain(bm.Rod(1.0, **ROUND), "clamped-free", 20, "double_wall")
    found = bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(-10.0, 0.1, 0.0)))
    assert found.is_stable
    assert found.tip == pytest.approx([*shot(start)[2:], 0.0], abs=4e-3)


def test_what_the_order_of_hinges_costs_stands_on_the_page() -> None:
    rows = re.findall(r"(?m)^\| `(\w+)` \| ([-+.\d]+) \| ([-+.\d]+) \| ([-+.\d]+) \| (\d) \|$", THEORY)
    assert [row[0] for row in rows] == ["ball", "yzx", "xyz", "yzx_alternating"]
    load = bm.SpatialLoad(force=(0, -1, 0))
    for joints, *printed, order in rows:
        errors = []
        for segments in (5, 10, 20):
            chain = bm.SpatialChain(NARROW, "clamped-free", segments, "gregory")
            errors.append(bm.critical_factor(chain, load, joints=joints, start=4.0) / LATERAL - 1)
        assert [f"{100 * error:+.3g}" for error in errors] == printed
        if order == "1":
            # The spurious twist: +1/N or -1/N.
            assert abs(errors[-1]) * 20 == pytest.approx(1.0, abs=0.05)
        else:
            assert abs(errors[-1]) < 0.3e-2


def test_a_round_rod_does_not_twist_under_a_slanting_force_unless_its_hinges_do() -> None:
    # F L²/EI = 4 midway between the axes: spurious tip twist in degrees, of MuJoCo's chains by gregory.
    rod, force = bm.Rod(1.0, 1.0, 1e6, 1.0), 4 / math.sqrt(2)
    normal = np.array([0.0, -1.0, 1.0]) / math.sqrt(2)
    for joints, degrees in (("ball", 0.0), ("yzx", -2.52)):
        chain = bm.SpatialChain(rod, "clamped-free", 10, "gregory")
        last = bm.spatial_equilibrium(chain, bm.SpatialLoad((0, force, force)), joints=joints).rotation[-1]
        across = np.cross(last[:, 0], normal)
        twist = math.degrees(math.asin((last @ normal) @ across / np.linalg.norm(across)))
        assert twist == pytest.approx(degrees, abs=0.01)


def test_lateral_buckling_by_every_rule() -> None:
    # Percent at N = 5 and 10; of `gregory` a straight rod's twist takes the guided weight, 1/2.
    printed = {
        "naive": ("-16.0", "-8.9"),
        "rigid_stub": ("26.3", "11.4"),
        "double_wall": ("1.26", "0.40"),
        "gregory": ("0.14", "0.30"),
    }
    for rule, percents in printed.items():
        for segments, percent in zip((5, 10), percents, strict=True):
            chain = bm.SpatialChain(NARROW, "clamped-free", segments, rule)
            found = bm.critical_factor(chain, bm.SpatialLoad(force=(0, -1, 0)), start=4.0)
            assert f"{100 * (found / LATERAL - 1):.{len(percent.partition('.')[2])}f}" == percent


def test_the_shaft_of_greenhill() -> None:
    # Between bearings, twist rigid: 2N tan(π/N) of ball joints, 2N sin(π/N) of two hinges; clamped, the exact
    # 8.986818916 EI/L (tan(x/2) = x/2), by Richardson's extrapolation of chains that twist: seen 8e-5 off.
    bearings = (bm.RodEnd(INF, (INF, 0, 0)), bm.RodEnd((0, INF, INF)))
    stiff = bm.SpatialChain(bm.Rod(1.0, 1.0, 1e7, 1.0), bearings, 10, "double_wall")
    for joints, shape in (("ball", math.tan), ("yzx", math.sin)):
        found = bm.critical_factor(stiff, bm.SpatialLoad(torque=1.0), joints=joints, start=5.0)
        assert found == pytest.approx(20 * shape(math.pi / 10), rel=1e-6)
    walls: Any = ("clamped", bm.RodEnd((0, INF, INF), (0, INF, INF)))
    rod = bm.Rod(1.0, 1.0, 1e3, 1.0)
    found = [
        bm.critical_factor(
            bm.SpatialChain(rod, walls, n, "double_wall"), bm.SpatialLoad(torque=1.0), start=8.0
        )
        for n in (16, 32)
    ]
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(8.986818916, rel=2e-4)


def test_the_ring_of_michell_and_zajac() -> None:
    # A straight round rod, bent into a ring and closed after a twist, leaves its plane at M R/EI = √3
    # (Michell 1889). Followed up to 0.96 of that; the stiffness that vanishes is extrapolated, and then N.
    rod = bm.Rod(2 * math.pi, 1.0, 10.0, 1.0)
    twist = 2 * math.pi * math.sqrt(3) / 10.0
    limits = []
    for segments in (12, 24):
        chain = bm.SpatialChain(rod, "clamped-clamped", segments, "double_wall")
        give = np.vstack(
            [np.zeros(3), np.where(np.isfinite(chain.joint_stiffness), 1 / chain.joint_stiffness, 0)]
        )
        guess, before, points = give * [0, 0, 1], 0.0, []
        for share in (0.2, 0.4, 0.6, 0.75, 0.84, 0.91, 0.96):
            guess = guess + give * [(share - before) * math.sqrt(3), 0, 0]
            ring = bm.spatial_equilibrium(
                chain,
                guess=guess,
                end_place=(0, 0, 0),
                end_frame=rotation(np.array([share * twist, 0, 0])),
            )
            guess, before = ring.coordinates, share
            # Its plane may turn about the held tangent: one motion is free.
            assert abs(ring.stiffnesses[0]) < 1e-9
            points.append((ring.stiffnesses[1], share))
        stiffness, shares = np.array(points[-3:]).T
        limits.append(np.polyfit(stiffness, shares, 2)[-1])
    assert (4 * limits[1] - limits[0]) / 3 == pytest.approx(1.0, abs=5e-3)


def test_rotation_vectors_invert_rotations_up_to_half_a_turn() -> None:
    draw = np.random.default_rng(1)
    vector = draw.normal(size=(300, 3))
    vector *= (np.geomspace(1e-12, math.pi - 1e-9, 300) / np.linalg.norm(vector, axis=1))[:, None]
    # Relative to the turn, however small; seen 3.4e-16.
    away = np.linalg.norm(rotation_vector(rotation(vector)) - vector, axis=1)
    assert (away / np.linalg.norm(vector, axis=1)).max() < 2e-15


def test_bad_input_is_named() -> None:
    chain = bm.SpatialChain(BEND, "clamped-free", 3)
    with pytest.raises(ValueError, match='did you mean "yzx"'):
        bm.spatial_equilibrium(chain, joints="yyzx")
    with pytest.raises(ValueError, match="chain must hold its end at s = 0 in place"):
        bm.spatial_equilibrium(bm.SpatialChain(BEND, "free-clamped", 3))
    held = bm.SpatialChain(BEND, "clamped-clamped", 4)
    for axes in (np.ones((3, 3)), 2 * np.eye(3), np.diag([1.0, 1.0, -1.0])):
        with pytest.raises(ValueError, match="end_frame must be a rotation"):
            bm.spatial_equilibrium(held, end_frame=axes)
    with pytest.raises(ValueError, match=r"end_place must be within the rod's length .* got \(900, 0, 0\)"):
        bm.spatial_equilibrium(held, end_place=(900, 0, 0))
    with pytest.raises(ValueError, match=r"guess must have shape \(4, 3\)"):
        bm.spatial_equilibrium(chain, guess=[1.0, 2.0])
    with pytest.raises(ValueError, match="load must lose its stability below most"):
        bm.critical_factor(chain, bm.SpatialLoad(force=(0, 0, 1)), most=1.0)


SPRUNG = bm.RodEnd((3.0, 1.0, 2.0), (0.5, 0.2, 0.7))


@pytest.mark.parametrize("joints", ["ball", "yzx_alternating"])
def test_springs_of_the_far_end_store_what_its_place_and_rotation_tell(joints: str) -> None:
    # The balance is the slope of the energy, which is told from the tip's place and rotation alone.
    rod = bm.Rod.arc(0.8, length=1.0, bending_stiffness=1.0, torsional_stiffness=0.7, mass_per_length=1.0)
    chain = bm.SpatialChain(rod, ("clamped", SPRUNG), 3, "gregory")
    load, end = bm.SpatialLoad(force=(0.3, -0.2, 0.4)), chain.tree.supports[-1]
    statics = _Statics(chain, bm.JOINT_LAWS[joints], None, None)
    free = np.flatnonzero(statics._active)
    start = np.zeros(3 * statics.count)
    start[free] = 0.4 * np.random.default_rng(5).standard_normal(len(free))

    def energy(x: Any) -> float:
        frames, starts, _, _ = statics._shape(x.reshape(-1, 3))
        turned = rotation_vector(end.frame.T @ frames[-1] @ end.frame)
        moved = np.concatenate([end.frame.T @ (starts[-1] - end.place), turned])
        springs = np.where(np.isfinite(statics.stiffness), statics.stiffness, 0.0).ravel()
        return float(0.5 * (springs @ x**2 + SPRUNG.stiffness @ moved**2) - np.array(load.force) @ starts[-1])

    balance = statics.residual(start.reshape(-1, 3), np.zeros(0), load)[0]
    steps = 1e-5 * np.eye(len(start))[free]
    slopes = [(energy(start + step) - energy(start - step)) / 2e-5 for step in steps]
    np.testing.assert_allclose(balance, slopes, atol=1e-8)
    # At rest all of it is least, nearby and as the tangent says.
    found = bm.spatial_equilibrium(chain, load, joints=joints)
    rest = found.coordinates.ravel()
    assert all(energy(rest + 300 * sign * step) > energy(rest) for step in steps for sign in (1, -1))
    np.testing.assert_allclose(found.tangent, found.tangent.T, atol=1e-12)


def test_springs_of_the_far_end_by_closed_forms() -> None:
    rod = bm.Rod(1.0, 1.0, 0.8, 1.0, second_bending_stiffness=4.0)
    # Small loads: F/(K + 3 EI/L^3) in either plane, exact with the report's springs; M/(K + GJ/L) in twist.
    far = bm.RodEnd((0.0, 2.0, 5.0), (3.0, 0.0, 0.0))
    chain = bm.SpatialChain(rod, ("clamped", far), 8, "mitiguy")
    load = bm.SpatialLoad(force=(0.0, 1e-9, 1e-9), moment=(1e-9, 0.0, 0.0))
    shape = bm.spatial_equilibrium(chain, load)
    np.testing.assert_allclose(shape.tip[1:], [1e-9 / (2 + 3), 1e-9 / (5 + 12)], rtol=1e-9)
    assert rotation_vector(shape.rotation[-1])[0] == pytest.approx(1e-9 / (3 + 0.8), rel=1e-9)
    # About a tangent that is held a spring resists turns beyond one: 12 N m turn it by 12/(K + GJ/L) = 9 rad.
    held = bm.RodEnd((0.0, math.inf, math.inf), (12 / 9 - 0.8, math.inf, math.inf))
    stiff = bm.Rod(1.0, 1e3, 0.8, 1.0)
    wound = bm.spatial_equilibrium(
        bm.SpatialChain(stiff, ("clamped", held), 6, "half_stub"), bm.SpatialLoad(moment=(12.0, 0.0, 0.0))
    )
    assert wound.coordinates[:, 0].sum() == pytest.approx(9.0, rel=1e-12)
    # A column whose tip a spring holds across buckles as the planar chain does, in its weaker plane.
    strong = bm.Rod(1.0, 1.0, 1e6, 1.0, second_bending_stiffness=1e6)
    column = bm.SpatialChain(strong, ("clamped", bm.RodEnd((0.0, 6.0, 0.0))), 8, "gregory")
    planar = bm.Chain(bm.Beam.unit(), ("clamped", bm.End(translational_stiffness=6.0)), 8, "gregory")
    factor = bm.critical_factor(column, bm.SpatialLoad(force=(-1.0, 0.0, 0.0)), start=3.0)
    assert factor == pytest.approx(bm.buckling_load(planar), rel=1e-9)
