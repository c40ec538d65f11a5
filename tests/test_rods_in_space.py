"""Rods in space: their chains and the exact rod, each against the other and against what others derived."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numpy.typing import NDArray
from shared_cases import ROUND, WIRE

import beammodes as bm
from beammodes.chains.rigid_tree import RigidTree, Support
from beammodes.numerics.rotations import rotation
from beammodes.vibration.tree_form import tree_form

Floats = NDArray[np.float64]

BLADE = bm.Rod.pretwisted(
    math.pi / 2,
    length=1.0,
    bending_stiffness=1.0,
    second_bending_stiffness=16.0,
    torsional_stiffness=1.0,
    mass_per_length=1.0,
)
ARC = bm.Rod.arc(math.pi / 2, length=math.pi / 2, **ROUND)
HELIX = bm.Rod(1.0, **ROUND, curvature=(1.0, 0.0, 2 * math.pi))
RODS = {"blade": BLADE, "arc": ARC, "helix": HELIX}
THEORY = (Path(bm.__file__).parent / "pages" / "theory.md").read_text(encoding="utf-8")


def omega(rod: bm.Rod, boundary: Any, modes: int = 3) -> Floats:
    return bm.rod_modes(rod, boundary, modes).angular_frequency


# --- The exact rod ----------------------------------------------------------------------------------------


def test_the_free_ring_of_love() -> None:
    # Love, Mathematical Theory of Elasticity, 4th ed., 293: ω² = n²(n²-1)²/(n²+1) in its plane and
    # n²(n²-1)²/(n²+EI/GJ) out of it. A quarter ring between two antinodes has every even n.
    mirror = bm.RodEnd((math.inf, 0.0, 0.0), (0.0, math.inf, math.inf))
    found = bm.rod_modes(ARC, (mirror, mirror), 6)
    n = np.array([2, 4, 6])
    square = n**2 * (n**2 - 1) ** 2 / np.array([n**2 + 1.3, n**2 + 1.0])
    np.testing.assert_allclose(found.angular_frequency**2, np.sort(square.ravel()), rtol=1e-11)
    assert found.rigid_body_modes == 1


def test_stiffnesses_of_very_different_size() -> None:
    # A blade ten thousand times as stiff one way as the other, and one that hardly resists twist: the planar
    # frequencies of both planes, and the shaft's.
    rod = bm.Rod(1.0, 1e8, 1e-4, 1.0, 1e-7, second_bending_stiffness=1.0)
    weak = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", 3).angular_frequency
    shaft = math.pi * math.sqrt(1e-4 / 1e-7) * np.array([0.5, 1.5])
    expected = np.sort(np.concatenate([weak, shaft]))[:4]
    np.testing.assert_allclose(omega(rod, "clamped-free", 4), expected, rtol=1e-11)
    chain = bm.SpatialChain(rod, "clamped-free", 60, "gregory")
    np.testing.assert_allclose(bm.spatial_modes(chain, 4).angular_frequency, expected, rtol=1e-3)


def by_determinant(rod: bm.Rod, low: float, high: float) -> float:
    """The root of the 6 by 6 determinant of a uniform clamped-free rod, with 22 digits; its own equations."""

    curvature = rod.curvature
    assert isinstance(curvature, tuple)

    def cross(v: Any) -> Any:
        return mp.matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    def determinant(w: Any) -> Any:
        flow = mp.zeros(12)
        turning, tangent = cross([mp.mpf(k) for k in curvature]), cross([1, 0, 0])
        give = (rod.torsional_stiffness, rod.second_bending_stiffness, rod.bending_stiffness)
        for i in range(3):
            for j in range(3):
                for block in range(4):
                    flow[3 * block + i, 3 * block + j] = -turning[i, j]
                flow[i, 3 + j] = flow[9 + i, 6 + j] = -tangent[i, j]
            flow[6 + i, i] = -(w**2) * rod.mass_per_length
            flow[9 + i, 3 + i] = -(w**2) * rod.polar_inertia_per_length if i == 0 else 0
            flow[3 + i, 9 + i] = 1 / mp.mpf(give[i])
        return mp.det(mp.expm(rod.length * flow)[6:12, 6:12])

    with mp.workdps(22):
        return float(mp.findroot(determinant, (low, high)))


def test_trusted_numbers_and_a_determinant_of_22_digits() -> None:
    # Pretwisted, curved and helical cantilevers, computed elsewhere by expm and by finite elements.
    weak = bm.Rod.pretwisted(math.pi / 4, length=1.0, second_bending_stiffness=4.0, **ROUND)
    np.testing.assert_allclose(omega(weak, "clamped-free", 2), [3.5350525, 6.8720420], rtol=1e-8)
    np.testing.assert_allclose(omega(BLADE, "clamped-free", 2), [3.6087715, 9.961236], rtol=1e-8)
    np.testing.assert_allclose(omega(ARC, "clamped-free", 2), [1.45175369, 1.49816288], rtol=5e-9)
    np.testing.assert_allclose(omega(HELIX, "clamped-free", 2), [6.59038148, 7.42199987], rtol=5e-9)
    heavy = bm.Rod(1.3, 2.0, 1.5, 0.7, 0.03, second_bending_stiffness=5.0, curvature=(0.7, -1.1, 2.0))
    for rod, mode in ((HELIX, 0), (HELIX, 1), (heavy, 2)):
        found = omega(rod, "clamped-free", 3)[mode]
        exact = by_determinant(rod, found * (1 - 1e-6), found * (1 + 1e-6))
        assert found == pytest.approx(exact, rel=1e-12)


def test_a_straight_rod_is_two_beams_and_a_shaft() -> None:
    # Bending by `euler_bernoulli` in both planes; twist between the same ends from GJ θ'' = ρI_p θ̈.
    rod = bm.Rod(1.2, 85.0, 60.0, 0.62, 0.004, second_bending_stiffness=500.0)
    speed = math.sqrt(60.0 / 0.004) / 1.2
    twist = {
        "clamped-free": 0.5,
        "clamped-clamped": 1.0,
        "pinned-pinned": 1.0,
        "free-free": 1.0,
        "pinned-free": 1.0,
    }
    for boundary, first in twist.items():
        shaft = math.pi * speed * (first + np.arange(3))
        beams = [
            bm.euler_bernoulli(bm.Beam(1.2, stiffness, 0.62), boundary, 8).angular_frequency
            for stiffness in (85.0, 500.0)
        ]
        expected = np.sort(np.concatenate([shaft, *beams]))[:8]
        np.testing.assert_allclose(omega(rod, boundary, 8), expected, rtol=1e-12, err_msg=boundary)


def test_stretch_shear_and_rotary_inertia() -> None:
    # Timoshenko's beam judges bending with shear; a bar's stretch is EA u'' = ρA ü.
    rod = bm.Rod(1.0, 1.0, 0.8, 1.0, rotary_inertia_per_length=0.01, second_rotary_inertia_per_length=0.01,
                 shear_stiffness=30.0, second_shear_stiffness=30.0, axial_stiffness=90.0)  # fmt: skip
    beam = bm.timoshenko(
        bm.Beam(1.0, 1.0, 1.0, 0.01, shear_stiffness=30.0), "clamped-free", 3
    ).angular_frequency
    bar = math.pi * math.sqrt(90.0) * np.array([0.5])
    expected = np.sort(np.concatenate([np.repeat(beam, 2), bar]))[:5]
    np.testing.assert_allclose(omega(rod, "clamped-free", 5), expected, rtol=1e-11)


# --- Chains -----------------------------------------------------------------------------------------------


def test_one_plane_of_a_straight_rod_is_the_planar_chain() -> None:
    # To what a sum over one more route rounds differently: 3e-14 relative at most, seen 2e-14.
    beam, rod = bm.Beam(1.2, 85.0, 0.62), bm.Rod(1.2, 85.0, 60.0, 0.62, second_bending_stiffness=500.0)
    for boundary in ("clamped-free", "pinned-pinned", "clamped-guided", "free-free", "free-clamped"):
        for rule in ("gregory", "half_stub", "hencky", "rigid_stub", "simpson"):
            planar = bm.solve_modes(bm.linearize(bm.Chain(beam, boundary, 8, rule)), 3).angular_frequency
            spatial = bm.spatial_modes(bm.SpatialChain(rod, boundary, 8, rule), 12).angular_frequency
            nearest = np.abs(spatial[:, None] / planar - 1).min(axis=0)
            assert nearest.max() < 3e-14, (boundary, rule)


def test_bodies_on_a_straight_rods_end_are_the_planar_ones() -> None:
    # Behind a hinge of their own and on the segment, whose rule weights are others.
    beam, rod = bm.Beam(1.2, 85.0, 0.62), bm.Rod(1.2, 85.0, 60.0, 0.62, 1e-5, second_bending_stiffness=500.0)
    for on_segment in (False, True):
        tip = bm.End(3.0, 2.0, 0.3, 0.01, 0.05, on_segment=on_segment)
        for rule in ("rigid_stub_corrected", "gregory"):
            planar = bm.solve_modes(
                bm.linearize(bm.Chain(beam, ("clamped", tip), 8, rule)), 3
            ).angular_frequency
            chain = bm.SpatialChain(rod, ("clamped", bm.RodEnd.of(tip)), 8, rule)
            nearest = np.abs(bm.spatial_modes(chain, 14).angular_frequency[:, None] / planar - 1).min(axis=0)
            assert nearest.max() < 1e-12, (on_segment, rule)


def test_the_page_has_the_orders_and_every_digit() -> None:
    rows = re.findall(
        r"(?m)^\| (\w*) *\| `(\w+)` \| ([-+.e\d]+) \| ([-+.e\d]+) \| ([-+.e\d]+) \| ([-+.e\d]+) \|$", THEORY
    )
    assert len(rows) == 9
    order = {"naive": 1, "half_stub": 2, "double_wall": 2, "gregory": 4}
    name = ""
    for given, rule, *printed in rows:
        name = given or name
        table = bm.rod_error_dataset(RODS[name], "clamped-free", segments=[5, 10, 20, 40], modes=1, rule=rule)
        errors = table.relative_error.values.ravel()
        assert [f"{100 * error:.3g}" for error in errors] == printed, (name, rule)
        slope = np.log2(np.abs(errors[:-1] / errors[1:]))
        assert abs(slope[-1] - order[rule]) < 0.1, (name, rule)
        # Of the sixth of a turn that a helix bends in each of five pieces the first halving tells less.
        assert abs(slope.mean() - order[rule]) < 0.45, (name, rule)


def drawn_end(draw: np.random.Generator) -> Any:
    """A word, or six springs of which each may hold or be none, with a body and its tensor."""
    if draw.random() < 0.4:
        return str(draw.choice(["clamped", "free", "pinned", "guided"]))
    six = [float(draw.choice([0.0, math.inf, draw.uniform(0.1, 100.0)])) for _ in range(6)]
    root = draw.normal(size=(3, 3))
    # Of masses spread as `spread`: that is what makes an inertia one of a body.
    spread = 0.005 * (root @ root.T + (root @ root.T).T)
    body = (draw.uniform(0.01, 1.0), np.trace(spread) * np.eye(3) - spread, 0.1 * draw.normal(size=3))
    return bm.RodEnd(six[:3], six[3:], *(body if draw.random() < 0.7 else ()))


def test_random_rods_between_random_ends_converge_at_fourth_order() -> None:
    # Seen: from 24 to 48 segments 3.4 (terms of two signs; 12, then 14 from there on) to 24 times closer.
    draw = np.random.default_rng(11)
    gains = []
    for trial in range(16):
        stiffness, second, torsional = draw.uniform(0.4, 3.0, 3)
        bent = 2.0 * draw.normal(size=3) * (trial % 4 > 0)
        rod = bm.Rod(1.0, stiffness, torsional, 1.0, second_bending_stiffness=second, curvature=bent)
        ends = (drawn_end(draw), drawn_end(draw))
        exact = bm.rod_modes(rod, ends, 3)
        errors = []
        for segments in (24, 48):
            found = bm.spatial_modes(bm.SpatialChain(rod, ends, segments, "gregory"), 3)
            assert found.rigid_body_modes == exact.rigid_body_modes, ends
            errors.append(np.abs(found.angular_frequency / exact.angular_frequency - 1).max())
        assert errors[1] < 2e-5, (ends, errors)
        gains.append(errors[0] / errors[1])
        # Of one piece or two there is a chain too.
        for rule in ("rigid_stub", "gregory"):
            bm.spatial_modes(bm.SpatialChain(rod, ends, 1, rule), 3)
    assert min(gains) > 3 and 12 < np.median(gains) < 20, gains


def gained(rod: bm.Rod, segments: list[int]) -> float:
    """By how much more segments lessen the larger error of two modes."""
    table = bm.rod_error_dataset(rod, "clamped-free", segments=segments, modes=2, rule="gregory")
    few, many = np.abs(table.relative_error).max(("mode", "rule")).values
    return float(few / many)


def test_rods_that_vary_hooks_and_lines_through_points() -> None:
    # A hook's kink is an end of two stretches: order 4 with a hinge on it. The line through points of a
    # circle and the arc itself agree, and so do a curvature as a function and as three numbers.
    hook = bm.Rod.hook(straight=0.5, radius=0.25, angle=2.0, **ROUND)
    assert gained(hook, [16, 32]) > 10
    angle = np.linspace(0.0, math.pi / 2, 25)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    line = bm.Rod.through(circle, **ROUND)
    assert line.length == pytest.approx(math.pi / 2, rel=1e-9)  # seen 5e-11, below 2e-10
    np.testing.assert_allclose(omega(line, "clamped-free", 2), omega(ARC, "clamped-free", 2), rtol=1e-9)
    bent = bm.Rod(1.0, **ROUND, curvature=lambda s: (1.0, 0.0 * s, 2 * math.pi))
    np.testing.assert_allclose(omega(bent, "clamped-free", 2), omega(HELIX, "clamped-free", 2), rtol=1e-11)
    pieces = [bm.SpatialChain(rod, "clamped-free", 7).tree for rod in (bent, HELIX)]
    np.testing.assert_allclose(pieces[0].inertia, pieces[1].inertia, atol=1e-15)
    taper = bm.Rod(
        1.0,
        lambda s: (1 - s / 2) ** 3,
        lambda s: 0.8 * (1 - s / 2) ** 3,
        lambda s: 1 - s / 2,
        curvature=lambda s: (0.5 * s, 0.0, 1 + s),
    )
    assert gained(taper, [12, 24]) > 10


def test_a_turned_rod_has_the_same_frequencies_and_modes_are_orthonormal() -> None:
    chain = bm.SpatialChain(HELIX, "clamped-free", 60, "gregory")
    turned = bm.SpatialChain(HELIX, "free-clamped", 60, "gregory")
    ours = bm.spatial_modes(chain, 6)
    # A helix is its own image under half a turn about an axis across it.
    np.testing.assert_allclose(
        ours.angular_frequency, bm.spatial_modes(turned, 6).angular_frequency, rtol=1e-12
    )
    every = bm.spatial_modes(chain, 180)
    np.testing.assert_allclose(ours.angular_frequency, every.angular_frequency[:6], rtol=1e-12)
    tree = chain.tree
    centre = ours.displacement[:, chain.tree.parent.clip(0)[1:]] + np.cross(
        ours.rotation[:, 1:], (tree.centre - tree.joint_place)[1:]
    )
    product = np.einsum("p,mpi,npi->mn", tree.mass[1:], centre, centre)
    product += np.einsum("mpi,pij,npj->mn", ours.rotation, tree.inertia, ours.rotation)
    np.testing.assert_allclose(product, np.eye(6), atol=1e-10)


def test_a_long_chain_keeps_its_digits() -> None:
    # Order 4 leaves 1e-13 at N = 2,000: what differs from the exact rod is rounding. Seen 5e-13, below 2e-13.
    errors = bm.rod_errors(bm.SpatialChain(HELIX, "clamped-free", 2000, "gregory"), 4)
    assert np.abs(errors).max() < 1e-11
    # Of a round straight rod the frequencies of two planes are equal; none is missed.
    straight = bm.spatial_modes(bm.SpatialChain(bm.Rod(1.0, **ROUND), "clamped-free", 2000, "gregory"), 6)
    planar = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", 3).angular_frequency
    np.testing.assert_allclose(straight.angular_frequency, np.repeat(planar, 2), rtol=1e-11)


def test_pieces_of_many_coils_have_the_mass_of_their_coils() -> None:
    # A circle of radius R followed through the angle a has its centre at R ((1 - cos a)/a, 1 - sin a/a),
    # d from the circle's centre, and about its axis the inertia m (R² - d²). Given as a function, too.
    for a, curvature in ((50.0, (0, 0, 50.0)), (200.0, (0, 0, 200.0)), (60.0, lambda _: (0, 0, 60.0))):
        tree = bm.SpatialChain(bm.Rod(1.0, **ROUND, curvature=curvature), "free-free", 1, "naive").tree
        place = np.array([(1 - math.cos(a)) / a, 1 - math.sin(a) / a, 0.0]) / a
        np.testing.assert_allclose(tree.centre[0], place, atol=1e-11 / a)
        assert tree.inertia[0][2, 2] == pytest.approx(
            (1 - (a * place[0]) ** 2 - (1 - a * place[1]) ** 2) / a**2
        )
    with pytest.raises(ValueError, match=r"rod must turn by at most 200,000 radians .* got 1,000,000"):
        bm.SpatialChain(bm.Rod(1.0, **ROUND, curvature=(0, 0, 1e6)), "clamped-free", 5)
    with pytest.raises(TypeError, match=r"curvature must be three numbers .* or a function of s .* got 5"):
        bm.Rod(1.0, **ROUND, curvature=5)


def test_a_tree_with_a_fork_against_its_assembled_matrices() -> None:
    # Two branches on a trunk, sprung to the ground at three points: M and K summed piece by piece, dense.
    draw = np.random.default_rng(2)
    parent = np.array([-1, 0, 1, 2, 1, 4, 0])
    count = len(parent)
    place, frame = draw.normal(size=(count, 3)), rotation(draw.normal(size=(count, 3)))
    root = draw.normal(size=(count, 3, 3))
    supports = tuple(
        Support(piece, draw.normal(size=3), rotation(draw.normal(size=3)), stiffness)
        for piece, stiffness in (
            (0, np.array([math.inf, 2.0, 0.0, 1.0, 0.0, 3.0])),
            (3, np.array([0.5, 0.0, math.inf, 0.0, 0.0, 0.0])),
            (6, np.array([1.0, 1.0, 0.0, 0.0, 2.0, 0.0])),
        )
    )
    tree = RigidTree(
        parent,
        place,
        frame,
        draw.uniform(0.1, 1.0, (count, 3)),
        draw.uniform(0.5, 1.0, count),
        draw.normal(size=(count, 3)),
        root @ np.swapaxes(root, 1, 2),
        supports,
    )
    form = tree_form(tree)
    x = form.allowed(np.linalg.qr(form.forbidden, mode="complete")[0][:, form.forbidden.shape[1] :])
    inverse = np.linalg.svd(form.kinetic(x), compute_uv=False)
    adjoint = form.adjoint(form.kinetic(x))
    np.testing.assert_allclose(x.T @ adjoint, form.kinetic(x).T @ form.kinetic(x), atol=1e-12)
    # Twists of all pieces from six root coordinates and three turns a joint.
    twists = np.zeros((count, 6, 6 + 3 * (count - 1)))
    twists[0, :, :6] = np.eye(6)
    for i in range(1, count):
        twists[i] = twists[parent[i]]
        own = slice(6 + 3 * (i - 1), 9 + 3 * (i - 1))
        twists[i, 3:, own] += frame[i]
        twists[i, :3, own] += np.cross(place[i][:, None], frame[i], axis=0)
    images = tree.mass_root @ twists
    mass = np.einsum("pik,pil->kl", images, images)
    stiffness = np.diag(np.concatenate([np.zeros(6), 1 / tree.joint_flexibility[1:].ravel()]))
    held = []
    for support in supports:
        reading = support.reading @ twists[support.piece]
        finite = np.isfinite(support.stiffness)
        stiffness += reading[finite].T @ (support.stiffness[finite][:, None] * reading[finite])
        held.append(reading[~finite])
    free = np.linalg.svd(np.vstack(held))[2][len(np.vstack(held)) :].T
    square = np.linalg.eigvals(np.linalg.solve(free.T @ mass @ free, free.T @ stiffness @ free)).real
    square = np.sort(square)
    rigid = form.rigid.shape[1]
    assert rigid == int((square < 1e-9).sum())
    np.testing.assert_allclose(np.sort(1 / inverse**2)[: len(square) - rigid], square[rigid:], rtol=1e-8)


def test_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match=r"curvature must be three numbers"):
        bm.Rod(1.0, **ROUND, curvature=(1.0, 2.0))
    with pytest.raises(TypeError, match="curvature must be a function of s that returns three numbers"):
        bm.Rod(1.0, **ROUND, curvature=lambda s: s)
    with pytest.raises(ValueError, match="rotary_inertia must be symmetric"):
        bm.RodEnd(rotary_inertia=((1, 0.5, 0), (0, 1, 0), (0, 0, 1)))
    with pytest.raises(ValueError, match="points must each lie away"):
        bm.Rod.through([(0, 0, 0), (0, 0, 0), (1, 0, 0), (2, 0, 0)], **ROUND)
    with pytest.raises(ValueError, match='did you mean "clamped-free"'):
        bm.SpatialChain(HELIX, "clamped-fre", 3)


def test_bodies_that_no_masses_make_are_refused() -> None:
    # I1 <= I2 + I3: each sums the squares of two distances; a thin disc has equality.
    tilt = rotation(np.array([0.3, -0.5, 0.8]))
    for inertia, allowed in (((2.0, 1.0, 1.0), True), ((0.0, 1.0, 1.0), True), ((2.1, 1.0, 1.0), False)):
        tensor = tilt @ np.diag(inertia) @ tilt.T
        for given in (inertia, ((tensor + tensor.T) / 2).tolist()):
            if allowed:
                bm.RodEnd(rotary_inertia=given)
            else:
                with pytest.raises(
                    ValueError, match=r"rotary_inertia must be that of a body, .* 1, 1, 2\.1$"
                ):
                    bm.RodEnd(rotary_inertia=given)
    with pytest.raises(ValueError, match="rotary_inertia must be symmetric and positive"):
        bm.RodEnd(rotary_inertia=((1, 2, 0), (2, 1, 0), (0, 0, 1)))


@pytest.mark.slow
def test_lines_through_few_points_are_judged() -> None:
    # Five points make cubics with a kink of the curvature at the middle one, where the judge steps over none.
    wild = np.array([(0, 0, 0), (1.6, 0.4, 0.6), (3.7, -0.1, 1.3), (3.9, 1.1, 0.4), (5.6, 0.7, 0.5)])
    rod = bm.Rod.through(wild, **ROUND)
    exact = omega(rod, "clamped-free", 2)
    chain = bm.SpatialChain(rod, "clamped-free", 40, "gregory")
    found = bm.spatial_modes(chain, 2).angular_frequency
    np.testing.assert_allclose(found, exact, rtol=1e-3)
    np.testing.assert_allclose(bm.rod_errors(chain, 2), found / exact - 1, atol=1e-12)


def test_a_line_with_all_but_a_corner_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"^points must be closer together .* from point 0 to point 1, counted"
    ):
        bm.Rod.through([(0, 0, 0), (1, 0, 0), (0.02, 0.001, 0), (1, 0.2, 0)], **ROUND)


def test_ends_and_rest_shapes_are_checked_where_they_are_given() -> None:
    with pytest.raises(TypeError, match=r"^left must be a RodEnd, got 'clamped': RodEnds\.of takes words"):
        bm.RodEnds("clamped", bm.RodEnd())  # type: ignore[arg-type]  # on purpose
    with pytest.raises(ValueError, match=r"got \(RodEnd\(\), 'fre'\)"):
        bm.RodEnds.of((bm.RodEnd(), "fre"))
    with pytest.raises(TypeError, match=r"^rotary_inertia must be three numbers, along x, y and z, got 0$"):
        bm.RodEnd(rotary_inertia=((1, 0, 0), 0, 0))
    with pytest.raises(ValueError, match=r"^straight must not vanish .* got 1 with radius 2 and angle 0$"):
        bm.Rod.hook(straight=1, radius=2, angle=0, **WIRE)
    with pytest.raises(ArithmeticError, match=r"^rod must curve less, or .* .*e\+06 steps, more than"):
        bm.rod_modes(bm.Rod.arc(1e6, length=1.0, **WIRE), "clamped-free", 1)
    tips = bm.Ends(mass=[1.0, 2.0])
    with pytest.raises(
        TypeError, match=r"^each end of boundary must be one end here, got Ends\(shape=\(2,\)\)"
    ):
        bm.segments_needed(("clamped", tips), 0.01)


def test_messages_say_what_takes_the_other_kind() -> None:
    wire = {"bending_stiffness": 1.0, "torsional_stiffness": 1.0, "mass_per_length": 1.0}
    rod: Any = bm.Rod(1.0, **wire)
    chain: Any = bm.SpatialChain(rod, "clamped-free", 3)
    load: Any = bm.Load(gravity=9.81)
    planar: Any = bm.Chain(bm.Beam.unit(), "clamped-free", 3)
    asked: dict[str, Any] = {
        "spatial_modes takes": lambda: bm.solve_modes(chain),
        "linearize.chain. makes": lambda: bm.solve_modes(planar),
        "rod_modes takes": lambda: bm.euler_bernoulli(rod, "clamped-free", 1),
        "SpatialChain takes": lambda: bm.Chain(rod, "clamped-free", 3),
        "Rod.from_beam makes": lambda: bm.SpatialChain(planar.beam, "clamped-free", 3),
        "rod_errors takes": lambda: bm.frequency_error("clamped-free", segments=3, mode=1, beam=rod),
        "chain_errors takes": lambda: bm.rod_errors(planar),
        "spatial_equilibrium takes": lambda: bm.find_equilibrium(chain, bm.Load()),
        "find_equilibrium takes": lambda: bm.spatial_equilibrium(planar),
        "SpatialLoad has": lambda: bm.spatial_equilibrium(chain, load),
        "critical_factor takes": lambda: bm.buckling_load(chain),
        "export_chain writes": lambda: bm.simulate(chain, duration=1.0),
        "the ratio b ω/2": lambda: bm.damped_modes(chain, bm.Damping(stiffness=0.1)),
    }
    for words, call in asked.items():
        with pytest.raises(TypeError, match=words):
            call()


def test_modes_say_what_their_joints_store() -> None:
    # A straight rod's bendings and twist are apart; on a curved one they are not, and add up to all or,
    # with a sprung end, to what its spring leaves.
    wire = {"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 1.0}
    flat = bm.Rod(1.0, **wire, second_bending_stiffness=9.0, polar_inertia_per_length=0.01)
    found = bm.spatial_modes(bm.SpatialChain(flat, "clamped-free", 8, "gregory"), 5)
    assert np.allclose(np.sort(found.stored, axis=1), [0.0, 0.0, 1.0], atol=1e-12)
    # √1.3 3.5, √9 3.5, √1.3 22.0, π/2 √(1/0.01) = 15.7, √1.3 61.7: about z, y, x, z.
    assert found.stored.argmax(axis=1).tolist()[:4] == [2, 1, 0, 2]
    ends = (bm.RodEnd((math.inf,) * 3, (3.0, 2.0, 4.0)), "free")
    for boundary, least in (("clamped-free", 1.0), (ends, 0.2)):
        arc = bm.SpatialChain(bm.Rod.arc(1.5, length=1.0, **wire), boundary, 8, "gregory")
        modes = bm.spatial_modes(arc, 3)
        assert (modes.stored > 1e-9).sum() > 3 and (modes.stored.sum(axis=1) <= 1 + 1e-12).all()
        assert modes.stored.sum(axis=1).min() >= least - 1e-12
        # By the springs' energies, ½ k φ² of relative rotations over ½ ω².
        frames = arc.rod.frames(arc.hinge_position)[0]
        turns = np.einsum("jki,mjk->mji", frames, np.diff(modes.rotation, axis=1))
        energy = (arc.joint_stiffness * turns**2).sum(axis=1) / modes.angular_frequency[:, None] ** 2
        assert np.allclose(energy, modes.stored, atol=1e-10)
