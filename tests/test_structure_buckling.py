"""Buckling of structures and their chains: textbooks' equations, the straight beam, chains as N grows."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from random_structures import structure
from scipy.special import jv
from shared_cases import INF, UNIT, portal

import beammodes as bm


def column(boundary: str, *stations: bm.Station) -> bm.Structure:
    return bm.Structure.of_beam(UNIT, boundary, stations)


def frame(feet: str = "clamped", top: bm.Joint | None = None) -> bm.Structure:
    """A portal of unit bars."""
    joints = {"a": bm.Joint(0, 0, feet), "b": top or bm.Joint(0, 1), "c": bm.Joint(1, 1)}
    return bm.Structure(
        joints | {"d": bm.Joint(1, 0, feet)}, [bm.Member(UNIT, *pair) for pair in ("ab", "bc", "cd")]
    )


TOPS = [bm.PointLoad(joint=name, force=(0.0, -1.0)) for name in "bc"]


def two_bars(u: float) -> float:
    """u cot u = 1 + u²/3 without its poles."""
    return u * math.cos(u) - (1.0 + u * u / 3.0) * math.sin(u)


def stability_function(u: float) -> float:
    """Moment per rotation of an end, the other being held, over EI/L."""
    return u * (math.sin(u) - u * math.cos(u)) / (2.0 * (1.0 - math.cos(u)) - u * math.sin(u))


def two_spans(u: float, a: float = 0.4) -> float:
    """Sum over the spans l of l ψ(kl/2), ψ(v) = (3/v)(1/(2v) - cot 2v), without its poles."""
    first, second = u * a, u * (1.0 - a)
    return (1.0 / first + 1.0 / second) * math.sin(first) * math.sin(second) - math.sin(u)


#: What buckles, under what load, and of which function u = √P L/√EI is a root. TG: S. P. Timoshenko,
#: J. M. Gere, Theory of Elastic Stability, 2nd ed. (1961). HM: M. R. Horne, W. Merchant, The Stability of
#: Frames (1965), stability functions. K: W. T. Koiter, Post-buckling analysis of a simple two-bar frame
#: (1967).
CASES: list[tuple[str, bm.Structure, list[bm.PointLoad] | None, Callable[[float], float]]] = [
    ("TG 2.5: two spans", column("pinned-pinned", bm.Station(0.4, INF)), None, two_spans),
    ("TG 2.4: portal, fixed feet, sway", portal(), TOPS, lambda u: u * math.cos(u) + 6.0 * math.sin(u)),
    ("TG 2.4: hinged feet", frame("pinned"), TOPS, lambda u: u * math.sin(u) - 6.0 * math.cos(u)),
    (
        "HM: no sway, symmetric",
        frame(top=bm.Joint(0, 1, (INF, 0.0, 0.0))),
        TOPS,
        lambda u: stability_function(u) + 2.0,
    ),
    (
        "K: two bars, pinned at both far ends",
        bm.Structure(
            {"a": bm.Joint(0, 0, "pinned"), "b": bm.Joint(0, 1), "c": bm.Joint(1, 1, "pinned")},
            [bm.Member(UNIT, *pair) for pair in ("ab", "bc")],
        ),
        TOPS[:1],
        two_bars,
    ),
    (
        "TG 2.12: own weight, J_-1/3 of (2/3) √(q L³/EI)",
        bm.Structure({"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(0, 1)}, [bm.Member(UNIT, "a", "b")]),
        bm.Load(gravity=1.0),
        lambda u: float(jv(-1 / 3, 2 / 3 * u)),
    ),
]


@pytest.mark.parametrize("case", CASES, ids=[case[0] for case in CASES])
def test_textbooks(
    case: tuple[str, bm.Structure, list[bm.PointLoad] | None, Callable[[float], float]],
) -> None:
    _, given, load, equation = case
    u = math.sqrt(bm.buckling_load(given, load=load))
    assert equation(u * (1.0 - 1e-11)) * equation(u * (1.0 + 1e-11)) < 0.0
    # No smaller root.
    below = np.array([equation(x) for x in np.linspace(0.05, 0.999 * u, 400).tolist()])
    assert (np.sign(below) == np.sign(below[0])).all()
    # Chains lose the cancellation of errors inside, order 2.
    coarse, fine = (
        bm.buckling_load(bm.StructureChain(given, [n] * len(given.parts.stretches)), load=load) / u**2 - 1.0
        for n in (16, 32)
    )
    assert 3.7 < coarse / fine < 4.3 and abs(fine) < 2e-3


def test_a_column_with_a_spring_at_mid_height() -> None:
    # TG 2.6: symmetric while K L³/EI < 16 π², with u = √P L/2√EI: K (L/2)³/EI = 2 u³/(u - tan u); then in two
    # half-waves, P = 4 π² EI/L².
    for u in (1.7, 2.4, 3.1):
        spring = 8.0 * 2.0 * u**3 / (u - math.tan(u))
        found = bm.buckling_load(column("pinned-pinned", bm.Station(0.5, spring)))
        assert math.isclose(found, 4.0 * u * u, rel_tol=1e-11)
    for spring, u in ((16.0 * math.pi**2 + 1.0, math.pi), (1e5, math.pi)):
        assert math.isclose(
            bm.buckling_load(column("pinned-pinned", bm.Station(0.5, spring))), 4.0 * u * u, rel_tol=1e-11
        )


def test_single_beams_and_chains_by_their_own_routes() -> None:
    # The beam's by the roots of its two ends and by its own polynomials; the chain's by its flexibility.
    taper = bm.Beam(1.2, lambda x: 85 * (1 - 0.6 * x) ** 3, lambda x: 0.62 * (1 - 0.6 * x))
    step = bm.Beam(1.2, [85.0, 40.0], 0.62)
    sprung = (bm.End(2.0, 3.0), bm.End(40.0, 0.5, mass=0.3, offset=0.2))
    for beam in (UNIT, taper, step):
        for pair in ("clamped-free", "clamped-clamped", "guided-pinned", sprung):
            given = bm.Structure.of_beam(beam, pair, [bm.Station(0.5)])
            assert math.isclose(bm.buckling_load(given), bm.buckling_load(beam, pair), rel_tol=1e-10)
    for pair, rule in (("clamped-clamped", "mitiguy"), (sprung, "gregory"), (sprung, "half_stub")):
        ours = bm.StructureChain(bm.Structure.of_beam(UNIT, pair), 12, rule)
        chain = bm.Chain(UNIT, pair, 12, rule)
        assert math.isclose(bm.buckling_load(ours), bm.buckling_load(chain), rel_tol=1e-11)


def test_forces_between_nodes_weights_and_what_compresses_nothing() -> None:
    # A force along a bar acts as one on a node there; a body that hangs keeps its joint upright.
    mast = bm.Structure.of_beam(UNIT, "clamped-free")
    noded = bm.Structure.of_beam(UNIT, "clamped-free", [bm.Station(0.6)])
    pushes = [bm.PointLoad(0.6, force=(-2.0, 0.3)), bm.PointLoad(1.0, force=(-1.0, 0.0))]
    assert math.isclose(
        bm.buckling_load(mast, load=pushes), bm.buckling_load(noded, load=pushes), rel_tol=1e-11
    )
    chain = bm.StructureChain(mast, 40)
    assert math.isclose(
        bm.buckling_load(chain, load=pushes), bm.buckling_load(mast, load=pushes), rel_tol=3e-3
    )
    assert bm.buckling_load(mast, load=bm.PointLoad(1.0, force=(1.0, 0.0))) == INF
    assert bm.buckling_load(chain, load=bm.PointLoad(1.0, force=(1.0, 0.0))) == INF
    assert bm.buckling_load(mast, load=bm.LineLoad(-1.0)) == INF
    light = bm.Beam(1.0, 1.0, 1e-9)
    for side in (-1.0, 1.0):
        # A body at a height c above the tip of a light mast, or hanging below it: u c tan u = 1.
        c = 0.3 * side
        body = bm.Structure(
            {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(0, 1, mass=1.0, offset=(0.0, c))},
            [bm.Member(light, "a", "b")],
        )
        u = math.sqrt(bm.buckling_load(body, load=bm.Load(gravity=1.0)))
        assert math.isclose(u * c * math.sin(u), math.cos(u), abs_tol=1e-7)


def test_what_buckling_refuses() -> None:
    fixed = {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(1, 0, "pinned")}
    between = bm.Structure(fixed, [bm.Member(UNIT, "a", "b")])
    cases: list[tuple[Callable[[], object], type[Exception], str]] = [
        (lambda: bm.buckling_load(between), ValueError, "that of a-b untold.*Let one of them slide"),
        (lambda: bm.buckling_load(portal()), TypeError, "load must be given for a structure of several"),
        (lambda: bm.buckling_load(column("pinned-free")), ValueError, "moves freely"),
        (lambda: bm.buckling_load(portal(), "pinned-pinned"), TypeError, "boundary must be left out"),
        (lambda: bm.buckling_load(UNIT, "pinned-pinned", load=TOPS), TypeError, "load must be left out"),  # type: ignore[call-overload]
    ]
    for call, kind, words in cases:
        with pytest.raises(kind, match=words):
            call()
    # Across itself the same bar is loaded as ever.
    assert bm.structure_statics(between, bm.PointLoad(0.5, force=1.0)).reactions["a"].force_y == -0.6875


def test_modes_under_load() -> None:
    # Of single beams and chains by their own routes: roots of both ends, a flexibility with its pull.
    sprung = (bm.End(30.0, 3.0), bm.End(mass=0.3, rotary_inertia=0.01, offset=0.1))
    for pair, force in (("clamped-free", -2.0), ("clamped-pinned", 40.0), (sprung, -1.0), (sprung, 30.0)):
        given = bm.Structure.of_beam(UNIT, pair, [bm.Station(0.4)])
        load, axial = bm.PointLoad(joint="right", force=(force, 0.0)), bm.Load(axial_force=force)
        found = bm.structure_modes_under(given, load, 8)
        judge = bm.euler_bernoulli(UNIT, pair, 8, load=axial)
        np.testing.assert_allclose(found.angular_frequency, judge.angular_frequency, rtol=1e-10)
        x = np.linspace(0.0, 1.0, 41)
        shape, known = found.shape(x), judge.shape(x)
        np.testing.assert_allclose(shape * np.sign((shape * known).sum(axis=1))[:, None], known, atol=1e-7)
        whole = bm.Structure.of_beam(UNIT, pair)
        ours = bm.structure_modes_under(bm.StructureChain(whole, 12), load, 4)
        plain = bm.linearize(bm.Chain(UNIT, pair, 12, "gregory"), load=axial)
        np.testing.assert_allclose(
            ours.angular_frequency, bm.solve_modes(plain, 4).angular_frequency, rtol=1e-10
        )
    # ω² is about straight in the load, and none at the buckling load.
    for each in (bm.StructureChain(portal(), 24), portal()):
        first, factor = [], bm.buckling_load(each, load=TOPS)
        for share in (0.0, 0.5, 0.999):
            load = [bm.PointLoad(joint=name, force=(0.0, -share * factor)) for name in "bc"]
            first.append(float(bm.structure_modes_under(each, load, 3).angular_frequency[0]) ** 2)
        assert 0.45 < first[1] / first[0] < 0.55 and 0.0 < first[2] / first[0] < 5e-3
    load = [bm.PointLoad(joint=name, force=(0.0, -0.5 * factor)) for name in "bc"]
    coarse, fine = (
        bm.chain_errors(bm.StructureChain(portal(), n, "mitiguy"), 2, load=load) for n in (30, 60)
    )
    np.testing.assert_allclose(coarse / fine, 4.0, rtol=0.005)
    unloaded = bm.structure_modes(portal(), 20).angular_frequency
    np.testing.assert_allclose(
        bm.structure_modes_under(portal(), [], 20).angular_frequency, unloaded, rtol=1e-9
    )
    with pytest.raises(
        ValueError, match=r"load must be less than 0\.5 times the given one, under which the str"
    ):
        bm.structure_modes_under(portal(), [bm.PointLoad(joint=n, force=(0.0, -2 * factor)) for n in "bc"], 1)


def sweep(seeds: range) -> int:
    """Chains extrapolated to endless N find the judge's factor; seen 2.0e-3 in the draws of both tests."""
    found = 0
    for seed in seeds:
        given = structure(seed)
        rng = np.random.default_rng(seed)
        load = [bm.PointLoad(joint=name, force=tuple(rng.normal(size=2))) for name in given.joints]
        try:
            exact = bm.buckling_load(given, load=load)
        except ValueError as error:
            if "moves freely" not in str(error) and "axial forces" not in str(error):
                raise
            continue
        found += 1
        count = len(given.parts.stretches)
        coarse, fine = (bm.buckling_load(bm.StructureChain(given, [n] * count), load=load) for n in (10, 20))
        assert exact == fine or math.isclose((4.0 * fine - coarse) / 3.0, exact, rel_tol=4e-3), seed
        # A third of that load, or a load that compresses nothing.
        third = [
            bm.PointLoad(joint=one.joint, force=tuple(min(exact, 9.0) / 3.0 * np.array(one.force)))
            for one in load
        ]
        chain = bm.structure_modes_under(bm.StructureChain(given, [20] * count), third, 2)
        judge = bm.structure_modes_under(given, third, 2)
        np.testing.assert_allclose(
            chain.angular_frequency, judge.angular_frequency, rtol=2e-2, err_msg=f"{seed}"
        )
    return found


def test_random_structures() -> None:
    assert sweep(range(24)) > 8


@pytest.mark.slow
def test_very_many_random_structures() -> None:
    assert sweep(range(1000, 1300)) > 100
