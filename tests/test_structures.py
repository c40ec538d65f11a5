"""Beams with stations and planar structures: the exact judge, chains, and the two against each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from random_structures import frame, structure
from scipy.linalg import eigh
from shared_cases import INF, UNIT, ell, portal

import beammodes as bm
from beammodes.exact.structure_judge import modes_below
from beammodes.numerics.blas import one_thread
from beammodes.problem.profiles import value_at


@pytest.fixture(autouse=True)
def _one_thread() -> Iterator[None]:
    # Many small matrices: threads of BLAS would only wait for each other.
    with one_thread():
        yield


def tee() -> bm.Structure:
    """Three bars at one joint, one of them clamped, with a body on the end of another."""
    joints = {
        "foot": bm.Joint(0, 0, "clamped"),
        "top": bm.Joint(0, 1),
        "left": bm.Joint(-0.6, 1.3, mass=0.5, rotary_inertia=0.02, offset=(-0.05, 0.1)),
        "right": bm.Joint(1, 1),
    }
    left = bm.Beam(math.hypot(0.6, 0.3), 0.7, 2.0)
    return bm.Structure(
        joints,
        [bm.Member(UNIT, "foot", "top"), bm.Member(left, "top", "left"), bm.Member(UNIT, "top", "right")],
    )


def errors(given: bm.Structure, segments: int | list[int], modes: int, rule: str = "gregory") -> np.ndarray:
    chain = bm.structure_chain_modes(bm.StructureChain(given, segments, rule), modes)
    return chain.angular_frequency / bm.structure_modes(given, modes).angular_frequency - 1.0


# --- The judge ----------------------------------------------------------------------------------------------


def test_a_single_beam_is_the_one_of_the_closed_forms() -> None:
    # euler_bernoulli solves transcendental equations of the two ends; here polynomials and a matrix.
    body = bm.End(mass=0.4, rotary_inertia=0.01, offset=0.1)
    on_springs = (bm.End(3.0, 2.0, mass=0.1), bm.End(20.0, 0.3, 0.2, 0.03, 0.2))
    for pair in ("clamped-free", "free-free", "guided-pinned", ("clamped", body), on_springs):
        found = bm.structure_modes(bm.Structure.of_beam(UNIT, pair), 6)
        judge = bm.euler_bernoulli(UNIT, pair, 6)
        # Of two counts of roots in doubles: 1.2e-14 with NumPy 2.5.
        np.testing.assert_allclose(found.angular_frequency, judge.angular_frequency, rtol=3e-14)
        assert found.rigid_body_modes == judge.rigid_body_modes


def test_steps_tapers_and_rotary_inertia() -> None:
    taper = bm.Beam(1.2, lambda x: 85 * (1 - 0.6 * x) ** 3, lambda x: 0.62 * (1 - 0.6 * x), 1e-3)
    for beam in (bm.Beam(1.2, [85.0, 40.0, 20.0], 0.62, 2e-3), taper):
        found = bm.structure_modes(bm.Structure.of_beam(beam, "clamped-pinned", [bm.Station(0.5)]), 3)
        judge = bm.euler_bernoulli(beam, "clamped-pinned", 3)
        np.testing.assert_allclose(found.angular_frequency, judge.angular_frequency, rtol=1e-12)


def test_a_step_that_breaks_name_is_seen_from_each_side() -> None:
    """A function with `breaks` and a table with the same step are one beam, hinge for hinge."""
    table = bm.Table((0.0, 0.3, 0.3, 1.0), (1.0, 1.0, 2.0, 2.0))
    wanted = bm.StructureChain(bm.Structure.of_beam(bm.Beam(1.0, table, 1.0), "clamped-free"), 10)
    for step in (lambda x: np.where(x < 0.3, 1.0, 2.0), lambda x: 1.0 if x <= 0.3 else 2.0):
        bar = bm.Structure.of_beam(bm.Beam(1.0, step, 1.0, breaks=[0.3]), "clamped-free")
        found = bm.StructureChain(bar, 10).joint_stiffness
        assert found == pytest.approx(wanted.joint_stiffness, rel=1e-11)


def test_a_rod_that_slides_along_itself_is_a_rigid_motion_more() -> None:
    bar = bm.Structure({"a": bm.Joint(0, 0), "b": bm.Joint(1, 0)}, [bm.Member(UNIT, "a", "b")])
    assert bm.structure_modes(bar, 1).rigid_body_modes == 3


def changes(function: Callable[[float], float], roots: np.ndarray, within: float = 1e-11) -> bool:
    """Whether a characteristic function has a root next to each of these."""
    return all(function(w * (1 - within)) * function(w * (1 + within)) < 0 for w in roots.tolist())


def test_two_spans() -> None:
    # S. Timoshenko, D. H. Young, W. Weaver, Vibration Problems in Engineering, 4th ed. (1974), 5.15: beams on
    # three supports, coth - cot of both spans add up to zero; of equal ones also those of one span.
    a, b = 0.55, 0.45
    found = bm.structure_modes(bm.Structure.of_beam(UNIT, "pinned-pinned", [bm.Station(a, INF)]), 8)

    def free_of_poles(omega: float) -> float:
        k = math.sqrt(omega)
        sa, sb = math.sin(k * a), math.sin(k * b)
        return sb * (sa / math.tanh(k * a) - math.cos(k * a)) + sa * (sb / math.tanh(k * b) - math.cos(k * b))

    assert changes(free_of_poles, found.angular_frequency)
    equal = bm.structure_modes(bm.Structure.of_beam(UNIT, "pinned-pinned", [bm.Station(0.5, INF)]), 8)
    half = bm.Beam(0.5, 1.0, 1.0)
    spans = [
        bm.euler_bernoulli(half, pair, 4).angular_frequency for pair in ("pinned-pinned", "clamped-pinned")
    ]
    np.testing.assert_allclose(equal.angular_frequency, np.sort(np.concatenate(spans)), rtol=1e-14)


def test_an_overhang_and_a_mass_on_a_light_bar() -> None:
    # A 6 x 6 determinant of both pieces' solutions; deflection per force a²b²/(3 EI L) + springs.
    beam = bm.Structure.of_beam(bm.Beam(7.5, 1.0, 1.0), "pinned-free", [bm.Station(6.2, INF)])
    expected = [0.24891668215852666, 0.8681117302754399, 1.4980702903429028]
    np.testing.assert_allclose(bm.structure_modes(beam, 3).angular_frequency, expected, rtol=1e-12)
    spring = bm.End(translational_stiffness=300.0)
    light = bm.Structure.of_beam(
        bm.Beam(120.0, 30e6, 1e-12), (spring, spring), [bm.Station(84.0, mass=1000 / 386)]
    )
    give = 84**2 * 36**2 / (3 * 30e6 * 120) + (0.3**2 + 0.7**2) / 300
    period = 2 * math.pi * math.sqrt(1000 / 386 * give)
    assert math.isclose(1 / bm.structure_modes(light, 1).frequency[0], period, rel_tol=1e-10)
    assert math.isclose(period, 0.533227803, abs_tol=1e-8)
    chain = bm.structure_chain_modes(bm.StructureChain(light, 10), 1)
    assert math.isclose(1 / chain.frequency[0], period, rel_tol=1e-10)


def test_a_mass_and_a_crack_at_mid_length() -> None:
    # Symmetric modes of a pinned-pinned beam, k = βL/2: tan k - tanh k = 2/(μ k) with a mass μ ρAL there
    # (I. A. Karnovsky, O. I. Lebed, Formulas for Structural Dynamics, 2001), and = 2 K/k on a crack of K EI/L
    # (T. G. Chondros, A. D. Dimarogonas, J. Yao, Journal of Sound and Vibration 215, 1998). The antisymmetric
    # ones are those of the half beam.
    half = bm.euler_bernoulli(bm.Beam(0.5, 1.0, 1.0), "pinned-pinned", 3).angular_frequency
    for station, ratio in ((bm.Station(0.5, mass=0.7), 1 / 0.7), (bm.Station(0.5, hinge=1.3), 1.3)):
        found = bm.structure_modes(
            bm.Structure.of_beam(UNIT, "pinned-pinned", [station]), 6
        ).angular_frequency

        def free_of_poles(omega: float, ratio: float = ratio) -> float:
            k = math.sqrt(omega) / 2
            return math.sin(k) - math.cos(k) * (math.tanh(k) + 2 * ratio / k)

        assert changes(free_of_poles, found[::2])
        np.testing.assert_allclose(found[1::2], half, rtol=1e-14)


def test_a_portal_frame() -> None:
    # Frequency functions of V. Koloušek, Dynamics in Engineering Structures (1973), for bars of length 1.
    def symmetric(omega: float) -> float:
        _, _, turn, carried = kolousek(omega)
        return 2 * turn - carried

    def sway(omega: float) -> float:
        shift, mixed, turn, carried = kolousek(omega)
        return (shift - omega**2 / 2) * (2 * turn + carried) - mixed**2

    found = bm.structure_modes(portal(), 4)
    is_sway = np.abs(found.displacement["b"][:, 0]) > 1e-9
    assert is_sway.tolist() == [True, False, True, False]
    assert changes(sway, found.angular_frequency[is_sway])
    assert changes(symmetric, found.angular_frequency[~is_sway])


def kolousek(omega: float) -> tuple[float, float, float, float]:
    """Force per shift and per turn of an end, moment per its turn and per that of the other end."""
    k = math.sqrt(omega)
    s, c, S, C = math.sin(k), math.cos(k), math.sinh(k), math.cosh(k)
    below = 1 - c * C
    return (
        k**3 * (s * C + c * S) / below,
        k**2 * s * S / below,
        k * (s * C - c * S) / below,
        k * (S - s) / below,
    )


def hermite_ell(bar: bm.Beam, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Five ω² and deflections of both legs, by elements with cubic shapes, from any textbook.

    Legs start at the foot and at the corner; stiffness and mass at Gauss points of each element.
    """
    h, (place, weight) = 1.0 / n, np.polynomial.legendre.leggauss(6)
    s = 0.5 * (1.0 + place)
    shape = np.array(
        [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    )
    bent = np.array([12 * s - 6, h * (6 * s - 4), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    first, size = 2 * (n + 1), 4 * (n + 1)
    K, M = np.zeros((size, size)), np.zeros((size, size))
    for leg in (0, first):
        for e in range(n):
            x = h * (e + s)
            part = slice(leg + 2 * e, leg + 2 * e + 4)
            K[part, part] += (bent * (0.5 * h * weight * value_at(bar.bending_stiffness, x))) @ bent.T
            M[part, part] += (shape * (0.5 * h * weight * value_at(bar.mass_per_length, x))) @ shape.T
    M[first - 2, first - 2] += bar.mean_mass_per_length  # the second leg moves sideways with the corner
    kept = np.delete(np.eye(size), [0, 1, first, first + 1], axis=1)
    kept[first + 1] += kept[first - 1]
    squares, vectors = eigh(kept.T @ K @ kept, kept.T @ M @ kept, subset_by_index=[0, 4])
    moved = (kept @ vectors).T
    return squares, np.stack([moved[:, :first:2], moved[:, first::2]], axis=1)


def test_shapes_of_a_frame_of_tapers_by_hermite_elements() -> None:
    bar = bm.Beam(1.0, lambda x: (1.0 - 0.5 * x) ** 3, lambda x: 1.0 - 0.5 * x)
    joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 1), "tip": bm.Joint(1, 1)}
    given = bm.Structure(joints, [bm.Member(bar, "foot", "corner"), bm.Member(bar, "corner", "tip")])
    squares, legs = hermite_ell(bar, 60)
    found = bm.structure_modes(given, 5)
    np.testing.assert_allclose(found.angular_frequency, np.sqrt(squares), rtol=2e-6)
    x = np.linspace(0.0, 1.0, 61)
    shape = np.stack([found.shape(x, member.name) for member in given.members], axis=1)
    sign = np.sign((shape * legs).sum(axis=(1, 2)))[:, None, None]
    # Elements leave out as much as of the frequencies.
    for mode in range(5):
        np.testing.assert_allclose(
            sign[mode] * legs[mode], shape[mode], atol=1e-6 * np.abs(shape[mode]).max()
        )


def test_structures_turned_in_the_plane_and_supports_with_them() -> None:
    turn = 0.7
    c, s = math.cos(turn), math.sin(turn)
    for seed in range(12):
        given = structure(seed)
        joints = {
            name: replace(
                joint,
                x=c * joint.x - s * joint.y,
                y=s * joint.x + c * joint.y,
                offset=(c * joint.offset[0] - s * joint.offset[1], s * joint.offset[0] + c * joint.offset[1]),
                angle=turn,
            )
            for name, joint in given.joints.items()
        }
        turned = bm.Structure(joints, given.members)
        for solve in (
            lambda one: bm.structure_modes(one, 2),
            lambda one: bm.structure_chain_modes(bm.StructureChain(one, [3] * len(one.parts.stretches)), 2),
        ):
            np.testing.assert_allclose(
                solve(turned).angular_frequency, solve(given).angular_frequency, rtol=1e-9
            )


def test_counts_and_a_second_route_by_hermite_elements() -> None:
    squares, _ = hermite_ell(UNIT, 40)
    found = bm.structure_modes(ell(), 5)
    np.testing.assert_allclose(found.angular_frequency, np.sqrt(squares), rtol=2e-6)
    for number, omega in enumerate(found.angular_frequency.tolist()):
        assert modes_below(ell(), omega * (1 - 1e-9)) == number
        assert modes_below(ell(), omega * (1 + 1e-9)) == number + 1


# --- Chains -------------------------------------------------------------------------------------------------


def test_a_chain_without_stations_is_the_chain_of_the_beam() -> None:
    body = bm.End(mass=0.4, rotary_inertia=0.01, offset=0.1)
    on_springs = (bm.End(3.0, 2.0, mass=0.1), bm.End(20.0, 0.3, 0.2, 0.03, 0.2))
    for pair in (
        "clamped-free",
        "free-free",
        "guided-pinned",
        "clamped-clamped",
        ("guided", body),
        on_springs,
    ):
        for rule in ("mitiguy", "half_stub", "simpson", "gregory"):
            ours = bm.structure_chain_modes(bm.StructureChain(bm.Structure.of_beam(UNIT, pair), 8, rule), 4)
            plain = bm.linearize(bm.Chain(UNIT, pair, 8, rule))
            np.testing.assert_allclose(
                ours.angular_frequency, bm.solve_modes(plain, 4).angular_frequency, rtol=1e-11
            )
            assert (ours.elastic_modes, ours.rigid_body_modes) == (
                plain.elastic_modes,
                plain.rigid_body_modes,
            )


def test_an_end_is_guided_whichever_way_its_beam_stands() -> None:
    # What moves across the bar only: of a mast sideways, of a bar that lies up and down.
    for at, support in (((0, 1), (0.0, INF, INF)), ((1, 0), (INF, 0.0, INF)), ((-1, 0), (0.0, 0.0, INF))):
        joints = {"foot": bm.Joint(0, 0, "clamped"), "tip": bm.Joint(*at, support)}
        given = bm.Structure(joints, [bm.Member(UNIT, "foot", "tip")])
        plain = bm.solve_modes(bm.linearize(bm.Chain(UNIT, "clamped-guided", 8, "gregory")), 4)
        ours = bm.structure_chain_modes(bm.StructureChain(given, 8, "gregory"), 4)
        np.testing.assert_allclose(ours.angular_frequency, plain.angular_frequency, rtol=1e-11)
    # Beside a station it is, too: half of a beam in its symmetric modes, whose middle is no node.
    heavy = [bm.Station(x, mass=0.3) for x in (0.6, 1.4)]
    whole = bm.Structure.of_beam(bm.Beam(2.0, 1.0, 1.0), "clamped-clamped", heavy)
    half = bm.Structure.of_beam(UNIT, "clamped-guided", heavy[:1])
    for rule in ("gregory", "half_stub_corrected"):
        symmetric = bm.structure_chain_modes(bm.StructureChain(whole, [6, 8, 6], rule), 5)
        ours = bm.structure_chain_modes(bm.StructureChain(half, [6, 4], rule), 3)
        np.testing.assert_allclose(ours.angular_frequency, symmetric.angular_frequency[::2], rtol=1e-11)


def test_the_L_frame_to_every_digit() -> None:
    # "Beyond the single plane beam", section 3: exact, and percent errors of mode 2. The last stands there as
    # 0.0000121; the chain's and the judge's frequencies have 14 digits and give 0.0000120.
    found = bm.structure_modes(ell(), 3).angular_frequency
    assert found.round(8).tolist() == [1.17178064, 3.19092568, 15.75459382]
    percents = [100 * errors(ell(), [n, n], 2)[1] for n in (5, 10, 20, 40)]
    assert [f"{p:.3g}" for p in percents] == ["0.0556", "0.00356", "0.000206", "1.2e-05"]
    chain = bm.StructureChain(ell(), [5, 5])
    weights = {hinge.name: round(hinge.flexibility * 5, 9) for hinge in chain.hinges}
    assert weights["corner"] == 3 / 4
    assert weights["foot-corner at 0.8"] == weights["corner-tip at 0.2"] == round(7 / 6, 9)

    # The rule left out at the corner: weights 1 there and beside it, the trapezoid's, of order 2.
    plain = [bm.StructureChain(ell(), [n, n], corrected=False) for n in (5, 20, 40)]
    assert [round(hinge.flexibility * 5, 9) for hinge in plain[0].hinges[3:7]] == [1, 1, 1, 1]
    coarse, fine = (bm.chain_errors(chain, 2)[1] for chain in plain[1:])
    assert 3.9 < coarse / fine < 4.1

    def plain_corner(n: int) -> float:
        chain = bm.StructureChain(ell(), [n, n])
        hinges = (
            hinge._replace(flexibility=1 / n) if hinge.name == "corner" else hinge for hinge in chain.hinges
        )
        object.__setattr__(chain, "hinges", tuple(hinges))
        return 100 * float(bm.structure_chain_modes(chain, 2).angular_frequency[1] / found[1] - 1)

    assert [f"{plain_corner(n):.2g}" for n in (5, 10, 20, 40)] == ["-3.8", "-2", "-1", "-0.51"]


@pytest.mark.parametrize("rule", ["gregory", "half_stub_corrected"])
def test_order_four_through_stations_and_corners(rule: str) -> None:
    one = [bm.Station(0.4, INF)], [bm.Station(0.4, mass=0.8)], [bm.Station(0.4, hinge=1.5)]
    body = [bm.Station(0.6, 30.0, 2.0, 0.5, 0.03, 0.1)]
    beams = [bm.Structure.of_beam(UNIT, "clamped-pinned", stations) for stations in (*one, body)]
    step = bm.Structure.of_beam(bm.Beam(1.0, [3.0, 1.0], [2.0, 1.0]), "clamped-free")
    for given in (*beams, step, ell(), portal(), tee()):
        coarse, fine = (errors(given, [n] * len(given.parts.stretches), 3, rule) for n in (48, 96))
        order = np.log2(np.abs(coarse / fine))
        # Where the first term is small the next, 1/N⁵ and 1/N⁶, still shows.
        assert np.median(order) > 3.7 and (np.abs(fine) < 3e-6).all(), (given, order, fine)


def sweep(seeds: range, draw: Callable[[int], bm.Structure] = structure) -> None:
    """Chains extrapolated to endless N find every mode of the judge, in order; below 2e-3 in 1,000 draws."""
    for seed in seeds:
        given = draw(seed)
        count = len(given.parts.stretches)
        # Few stretches in their fifth mode ask for more than many do.
        few = 9 if count > 3 else 15
        coarse, fine = (
            bm.structure_chain_modes(bm.StructureChain(given, [n] * count)) for n in (few, 2 * few)
        )
        modes = max(1, min(5, coarse.elastic_modes // 5))
        limit = (16 * fine.angular_frequency[:modes] - coarse.angular_frequency[:modes]) / 15
        judge = bm.structure_modes(given, modes)
        np.testing.assert_allclose(limit, judge.angular_frequency, rtol=2e-3, err_msg=f"seed {seed}")
        assert judge.rigid_body_modes == fine.rigid_body_modes, seed


def test_random_structures() -> None:
    sweep(range(1000, 1030))
    sweep(range(1000, 1008), frame)


@pytest.mark.slow
def test_very_many_random_structures() -> None:
    sweep(range(500))


@pytest.mark.slow
def test_very_many_spans_portals_tees_and_trees() -> None:
    sweep(range(500), frame)


def test_shapes_of_the_judge_and_of_chains() -> None:
    # Of a single beam those of euler_bernoulli; of structures the chain's, whose segments are straight. A
    # free bar's have unit modal mass by the trapezoid's rule.
    x = np.linspace(0.0, 1.0, 201)
    for pair in ("clamped-free", "free-pinned", (bm.End(3.0, 2.0, mass=0.1), "free")):
        ours = bm.structure_modes(bm.Structure.of_beam(UNIT, pair, [bm.Station(0.37)]), 3).shape(x)
        known = bm.euler_bernoulli(UNIT, pair, 3).shape(x)
        np.testing.assert_allclose(ours * np.sign((ours * known).sum(axis=1))[:, None], known, atol=1e-11)
    free = bm.Structure({"a": bm.Joint(0, 0), "b": bm.Joint(0, 1)}, [bm.Member(UNIT, "a", "b")])
    for given in (ell(), portal(), tee(), free):
        exact = bm.structure_modes(given, 3)
        chain = bm.structure_chain_modes(bm.StructureChain(given, [120] * len(given.parts.stretches)), 3)
        for stretch, member in zip(given.parts.stretches, given.members, strict=True):
            along = x * member.beam.length
            shape = exact.shape(along, member.name)
            np.testing.assert_allclose(chain.shape(along, member.name), shape, atol=2e-3)
            for at, joint in ((0, member.start), (-1, member.end)):
                moved = exact.displacement[joint][:, :2] @ stretch.normal
                np.testing.assert_allclose(shape[:, at], moved, atol=1e-11)
    weight = np.full(x.size, x[1]) * np.where((x == 0.0) | (x == 1.0), 0.5, 1.0)
    ends = exact.shape(x)
    np.testing.assert_allclose((weight * ends) @ ends.T, np.eye(3), atol=1e-3)


def test_segments_that_are_enough() -> None:
    exact = bm.structure_modes(ell(), 3).angular_frequency
    for rule, tolerance in (("gregory", 1e-3), ("mitiguy", 1e-2)):
        needed = bm.segments_needed(ell(), tolerance, 3, rule)
        worst = []
        for count in range(needed - 1, 2 * needed):
            found = bm.structure_chain_modes(bm.StructureChain(ell(), count, rule), 3)
            worst.append(np.abs(found.angular_frequency / exact - 1).max())
        assert worst[0] > tolerance > max(worst[1:])


def test_bars_of_one_section_are_as_long_as_their_joints_are_apart() -> None:
    joints = {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(3, 4), "c": bm.Joint(5, 4)}
    section = {"bending_stiffness": 2.0, "mass_per_length": 3.0, "rotary_inertia_per_length": 0.1}
    bars = [bm.Beam(length, *section.values()) for length in (5.0, 2.0)]
    expected = bm.Structure(joints, [bm.Member(bars[0], "a", "b"), bm.Member(bars[1], "b", "c")])
    assert bm.Structure.of_bars(joints, [("a", "b"), ("b", "c")], **section) == expected
    for pairs, message in (
        ([("a", "d")], "pairs must be one of a, b, c, got 'd'"),
        ([("a",)], "pairs must be names of two joints each"),
        ([("a", "a")], "pairs must be of joints that are apart"),
    ):
        with pytest.raises((TypeError, ValueError), match=message):
            bm.Structure.of_bars(joints, pairs, **section)


def test_questions_of_chains_are_asked_of_structures_by_the_same_names() -> None:
    given = bm.Structure.of_beam(UNIT, "clamped-free", [bm.Station(0.6, mass=0.4)])
    chain = bm.StructureChain(given, 10, "mitiguy")
    direct = bm.structure_chain_modes(chain, 2)
    solved = bm.solve_modes(chain, 2)
    np.testing.assert_array_equal(solved.angular_frequency, direct.angular_frequency)
    np.testing.assert_array_equal(chain.joint_stiffness, [hinge.stiffness for hinge in chain.hinges])
    errors_of = bm.frequency_error(given, segments=[[5], [10]], mode=[1, 2, 3])
    np.testing.assert_array_equal(errors_of[1], bm.chain_errors(chain, 3))
    assert bm.frequency_error(given, segments=10, mode=2) == pytest.approx(errors_of[1, 1], abs=1e-13)
    assert np.isnan(bm.frequency_error(given, segments=3, mode=9))
    push = bm.PointLoad(0.5, force=1.0)
    ours, theirs = bm.chain_statics(chain, push), bm.structure_chain_statics(chain, push)
    assert ours.deflection(0.7) == theirs.deflection(0.7)
    for call, message in (
        (lambda: bm.chain_statics(chain, "tip_force"), "loads with their sizes"),
        (lambda: bm.frequency_error(given, segments=9, mode=1, beam=UNIT), "beam must be left out with a"),
        (lambda: bm.frequency_error(given, segments=9, mode=1, rule=["naive"]), "must be one rule with a"),
    ):
        with pytest.raises((TypeError, ValueError), match=message):
            call()


def test_no_stretch_gets_fewer_segments_than_its_rule_takes() -> None:
    # gregory's weights of one segment are 13/24 twice, of two those of Simpson's rule: their sums tell.
    close = bm.Structure.of_beam(UNIT, "clamped-free", [bm.Station(x, mass=0.3) for x in (0.45, 0.55)])
    shares = {
        "gregory": (4, 2, 4),
        "half_stub_corrected": (3, 3, 3),
        "gregory2": (5, 1, 4),
        "mitiguy": (5, 1, 4),
    }
    for rule, shared in shares.items():
        assert bm.StructureChain(close, 10, rule).segments == shared
    assert bm.StructureChain(close, 5, "gregory").segments == (2, 1, 2)
    few, enough = (np.abs(errors(close, count, 2)).max() for count in ([5, 1, 4], 10))
    assert few > 4 * enough


def test_what_is_recommended_for_a_structure() -> None:
    for way in bm.recommend(ell(), 1e-2, 3, rules=["mitiguy", "gregory"], integrator="leapfrog"):
        assert way.segments == sum(way.stretches) == bm.segments_needed(ell(), 1e-2, 3, way.rule)
        chain = bm.StructureChain(ell(), way.segments, way.rule)
        errors = np.abs(bm.chain_errors(chain, 3))
        assert errors[way.mode - 1] == errors.max() == pytest.approx(way.largest_error, rel=1e-9)
        assert way.stable_time_step == pytest.approx(bm.stable_time_step(chain, "leapfrog"), rel=1e-12)
        assert way.joint_stiffness.tolist() == [hinge.stiffness for hinge in chain.hinges]
    with pytest.raises(ValueError, match="must be left out with a structure"):
        bm.recommend(ell(), 1e-2, beam=UNIT)


def test_laws_of_structures_are_what_chains_tend_to() -> None:
    # A single beam's law, by its own route, wherever it is cut; and chains', less the next power of 1/N.
    for pair in ("clamped-free", "guided-pinned"):
        for rule in ("mitiguy", "gregory", "simpson", "half_stub"):
            own = bm.error_law(pair, 2, rule)
            law = bm.error_law(bm.Structure.of_beam(UNIT, pair), 2, rule)
            assert law.order == own.order and law.coefficient == pytest.approx(own.coefficient, rel=1e-7)
    body = bm.Structure.of_beam(UNIT, "clamped-free", [bm.Station(0.6, 30.0, 2.0, 0.5, 0.03, 0.1)])
    crack = bm.Structure.of_beam(
        bm.Beam(1.0, [3.0, 1.0], 2.0), "clamped-guided", [bm.Station(0.2, hinge=1.5)]
    )
    counts = np.array([20, 40, 80])
    for given in (ell(), body, crack):
        each = [[round(one.beam.length * n) for one in given.parts.stretches] for n in counts.tolist()]
        for rule, mode in (("naive", 2), ("mitiguy", 1), ("hencky", 2), ("simpson", 1)):
            law = bm.error_law(given, mode, rule)
            found = [
                bm.chain_errors(bm.StructureChain(given, shared, rule), mode)[-1] * sum(shared) ** law.order
                for shared in each
            ]
            once = 2.0 * np.array(found[1:]) - found[:-1]
            assert (4.0 * once[1] - once[0]) / 3.0 == pytest.approx(law.coefficient, rel=3e-3), (given, rule)


def test_what_a_structure_refuses() -> None:
    joints = {"a": bm.Joint(0, 0), "b": bm.Joint(2, 0)}
    twice = {name: bm.Joint(x, 0) for x, name in enumerate(("a", "b-c", "a-b", "c"))}
    bars = [("a", "b-c"), ("b-c", "a-b"), ("a-b", "c")]
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: bm.Structure({}, []), r"^joints must be one or more, got \{\}"),
        (lambda: bm.Structure(joints, [bm.Member(UNIT, "a", "b")]), "1.0 between joints 2.0 apart"),
        (lambda: bm.Structure(joints, [bm.Member(UNIT, "a", "c")]), "joint of a member must be one of a, b"),
        (lambda: bm.Structure.of_beam(UNIT, "free-free", [bm.Station(1.0, INF)]), "what is at an end"),
        (lambda: bm.Structure.of_bars(twice, bars, bending_stiffness=1, mass_per_length=1), "members a-b-c"),
        (lambda: bm.Station(0.5, rotary_inertia=1.0, hinge=2.0), "which side of the kink"),
        (lambda: bm.Joint(0, 0, "pined"), 'did you mean "pinned"'),
        (lambda: bm.StructureChain(ell(), 1), "segments must be at least 2, for 2 stretches"),
        (lambda: bm.StructureChain(ell(), [3]), "or 2, one for each stretch"),
    ]
    for call, words in cases:
        with pytest.raises(ValueError, match=words):
            call()


@pytest.mark.parametrize(
    "station", [bm.Station(0.5, translational_stiffness=1e40), bm.Station(0.5, mass=1e25)], ids=repr
)
def test_numbers_beyond_every_digit_are_refused(station: bm.Station) -> None:
    bar = bm.Structure.of_beam(UNIT, "clamped-free", [station])
    with pytest.raises(
        ArithmeticError, match=r"differ by more than about 10 decades\? What holds has stiffness"
    ):
        bm.structure_modes(bar, 2)
