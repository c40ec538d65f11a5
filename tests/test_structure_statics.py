"""Statics of beams and structures under any loads: textbook formulas in fractions, and chains of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction as Fr
from typing import Any

import numpy as np
import pytest
from random_structures import structure
from shared_cases import INF, UNIT, portal

import beammodes as bm
from beammodes.exact.structure_judge import StructureModel
from beammodes.vibration.structure_vibration import StructureCoordinates

HALF = Fr(1, 2)


def of(boundary: Any, *stations: bm.Station, beam: bm.Beam = UNIT) -> bm.Structure:
    return bm.Structure.of_beam(beam, boundary, stations)


def across(found: Any, name: str) -> tuple[Fr, Fr]:
    """Force across the beam and moment of a support."""
    _, force, moment = found.exact_reactions[name]
    return force, moment


# --- Formulas -----------------------------------------------------------------------------------------------

FORCE, EVEN = bm.PointLoad(0.5, force=-1.0), bm.LineLoad(-1.0)
OFF = bm.PointLoad(0.25, force=-1.0)
GERBER = of("clamped-pinned", bm.Station(0.5, hinge=0.0))
#: What is loaded, by what, and what textbooks say; L = EI = F = q = 1, forces and loads downward.
#: T: S. Timoshenko, Strength of Materials, part I, 1930. R: W. C. Young, R. G. Budynas, Roark's Formulas for
#: Stress and Strain, 7th ed., table 8.1. K: A. Kleinlogel, Rigid Frame Formulas, 1952, frame 41.
FORMULAS: list[tuple[str, bm.Structure, Any, Callable[[Any], Any], Any]] = [
    ("R 1d", of("clamped-clamped"), FORCE, lambda f: f.deflection(HALF), Fr(-1, 192)),
    ("R 1d", of("clamped-clamped"), FORCE, lambda f: across(f, "left"), (HALF, Fr(1, 8))),
    ("R 1e", of("pinned-pinned"), FORCE, lambda f: f.deflection(HALF), Fr(-1, 48)),
    ("R 1c", of("clamped-pinned"), FORCE, lambda f: f.deflection(HALF), Fr(-7, 768)),
    ("R 1c", of("clamped-pinned"), FORCE, lambda f: across(f, "left"), (Fr(11, 16), Fr(3, 16))),
    ("R 1e: -F a²b²/(3 EI L)", of("pinned-pinned"), OFF, lambda f: f.deflection(Fr(1, 4)), Fr(-3, 256)),
    ("R 1e: M", of("pinned-pinned"), OFF, lambda f: f.moment(Fr(1, 4)), Fr(3, 16)),
    (
        "R 1e: V",
        of("pinned-pinned"),
        OFF,
        lambda f: (f.shear(Fr(1, 4)), f.shear(Fr(1, 4), side=1)),
        (Fr(3, 4), Fr(-1, 4)),
    ),
    ("R 2e", of("pinned-pinned"), EVEN, lambda f: f.deflection(HALF), Fr(-5, 384)),
    ("R 2e: slope", of("pinned-pinned"), EVEN, lambda f: f.rotation(Fr(0)), Fr(-1, 24)),
    (
        "R 2c",
        of("clamped-pinned"),
        EVEN,
        lambda f: (across(f, "left"), across(f, "right")),
        ((Fr(5, 8), Fr(1, 8)), (Fr(3, 8), Fr(0))),
    ),
    (
        "R 2d, triangle",
        of("clamped-clamped"),
        bm.LineLoad((0, -1)),
        lambda f: (across(f, "left"), across(f, "right")),
        ((Fr(3, 20), Fr(1, 30)), (Fr(7, 20), Fr(-1, 20))),
    ),
    (
        "R 2d, triangle as a table",
        of("clamped-clamped"),
        bm.LineLoad(bm.Table([0, 1], [0, -1])),
        lambda f: across(f, "left"),
        (Fr(3, 20), Fr(1, 30)),
    ),
    (
        "R 2a, half the span",
        of("clamped-free"),
        bm.LineLoad(-1.0, start=0.5),
        lambda f: f.deflection(Fr(1)),
        Fr(-41, 384),
    ),
    (
        "R 3e: couple",
        of("pinned-pinned"),
        bm.PointLoad(0.5, moment=1.0),
        lambda f: (f.rotation(HALF), f.moment(HALF), f.moment(HALF, side=1)),
        (Fr(1, 12), HALF, -HALF),
    ),
    (
        "T 48: two spans",
        of("pinned-pinned", bm.Station(0.5, INF)),
        EVEN,
        lambda f: [across(f, name)[0] for name in ("left", "left-right at 0.5", "right")],
        [Fr(3, 16), Fr(5, 8), Fr(3, 16)],
    ),
    (
        "T 48: moment there",
        of("pinned-pinned", bm.Station(0.5, INF)),
        EVEN,
        lambda f: f.moment(HALF),
        Fr(-1, 32),
    ),
    (
        "spring k in the middle: R = (5/384)/(1/48 + 1/k)",
        of("pinned-pinned", bm.Station(0.5, 48.0)),
        EVEN,
        lambda f: across(f, "left-right at 0.5")[0],
        Fr(5, 16),
    ),
    (
        "hinge: half a cantilever carries half the load",
        GERBER,
        bm.PointLoad(0.75, force=-1.0),
        lambda f: (across(f, "left"), f.moment(HALF)),
        ((HALF, Fr(1, 4)), Fr(0)),
    ),
    (
        "crack of K = 2: F L/4 more slope",
        of("pinned-pinned", bm.Station(0.5, hinge=2.0)),
        FORCE,
        lambda f: f.deflection(HALF),
        Fr(-1, 48) - Fr(1, 32),
    ),
    (
        "K 41: F h/2 (3k + 1)/(6k + 1), k = 1",
        portal(),
        bm.PointLoad(joint="b", force=(1.0, 0.0)),
        lambda f: (f.exact_reactions["a"][2], f.moment(Fr(1), "a-b")),
        (Fr(2, 7), Fr(3, 14)),
    ),
    (
        "K 41: even load on the beam, q l²/(12 (k + 2))",
        portal(),
        bm.LineLoad(-1.0, member="b-c"),
        lambda f: abs(f.moment(Fr(0), "a-b")),
        Fr(1, 36),
    ),
]


@pytest.mark.parametrize("case", FORMULAS, ids=[case[0] for case in FORMULAS])
def test_formulas_in_fractions(case: Any) -> None:
    _, given, load, asked, expected = case
    assert asked(bm.structure_statics(given, load)) == expected
    # Gregory's weights integrate cubics exactly, and so M²/EI under forces and moments on hinges.
    gathered = isinstance(load, bm.PointLoad) and load.x in (None, 0.5)
    if gathered and given is not GERBER:
        places = [] if load.x is None or len(given.parts.stretches) > 1 else [bm.Station(0.5)]
        if places:
            joints = given.joints
            given = bm.Structure(joints, [bm.Member(UNIT, "left", "right", stations=tuple(places))])
        chain = bm.StructureChain(given, [6] * len(given.parts.stretches), "gregory")
        if not any(word in case[0] for word in ("slope", "couple")):
            assert asked(bm.structure_chain_statics(chain, load)) == expected


def test_a_stepped_cantilever_and_a_table() -> None:
    # 20 ∫ (4 - x)²/EI dx = 2720/9, by the beam, by a chain, and by Gauss's rule where EI is a function.
    stepped = bm.Beam(4.0, [1.5, 1.0], 1.0)
    load = bm.Load(tip_force=20.0)
    assert bm.beam_statics(stepped, "clamped-free", load).deflection(Fr(4)) == Fr(2720, 9)
    chain = bm.chain_statics(bm.Chain(stepped, "clamped-free", 8, rule="gregory"), load)
    assert math.isclose(chain.deflection(4.0), 2720 / 9, rel_tol=1e-12)
    smooth = bm.Beam(4.0, lambda x: np.where(x < 2.0, 1.5, 1.0), 1.0, breaks=[2.0])
    assert math.isclose(
        bm.beam_statics(smooth, "clamped-free", load).deflection(4.0), 2720 / 9, rel_tol=1e-12
    )


def test_words_and_loads_agree() -> None:
    # The older route: polynomials of one beam; least work of a chain. Load turns the beam's own ends about.
    taper = bm.Beam(1.2, lambda x: 85.0 * (1.0 - 0.5 * x) ** 3, 0.62)
    loads = {
        "tip_force": bm.Load(tip_force=1.0),
        "tip_moment": bm.Load(tip_moment=1.0),
        "uniform_load": bm.LineLoad(1.0),
    }
    for word, load in loads.items():
        for beam in (taper, bm.Beam(1.2, 85.0, 0.62)):
            own = bm.beam_statics(beam, "clamped-free", word)
            found = bm.beam_statics(beam, "clamped-free", load)
            told = [found.deflection(1.2), found.rotation(1.2), found.deflection(0.6)]
            np.testing.assert_allclose(
                told, [own.deflection, own.rotation, own.midspan_deflection], rtol=1e-12
            )
            for rule in ("mitiguy", "half_stub", "rigid_stub", "gregory"):
                chain = bm.Chain(beam, "clamped-free", 8, rule)
                own = bm.chain_statics(chain, word)
                found = bm.chain_statics(chain, load)
                assert math.isclose(found.deflection(1.2), own.deflection, rel_tol=1e-12)
                assert math.isclose(found.deflection(0.6), own.midspan_deflection, rel_tol=1e-12)


def test_weight_and_equilibrium_of_a_crane() -> None:
    # Reactions hold what weighs: the sum of forces, and of moments about the foot, by hand.
    mast = bm.Beam(2.0, [3.0, 2.0], [4.0, 2.0])
    jib = bm.Beam(math.hypot(1.5, 0.5), bm.Table([0, 1.0, math.hypot(1.5, 0.5)], [1.0, 0.7, 0.4]), 1.3)
    joints = {
        "foot": bm.Joint(0, 0, "clamped"),
        "top": bm.Joint(0, 2),
        "hook": bm.Joint(1.5, 2.5, mass=2.5, offset=(0.1, -0.3)),
    }
    crane = bm.Structure(joints, [bm.Member(mast, "foot", "top"), bm.Member(jib, "top", "hook")])
    found = bm.structure_statics(crane, bm.Load(gravity=10.0))
    weights = {0.0: 6.0 * 10, 0.75: 1.3 * math.hypot(1.5, 0.5) * 10, 1.6: 25.0}
    _, up, turn = found.reactions["foot"]
    assert math.isclose(up, sum(weights.values()), rel_tol=1e-12)
    assert math.isclose(turn, sum(x * weight for x, weight in weights.items()), rel_tol=1e-12)
    chain = bm.structure_chain_statics(bm.StructureChain(crane, 40), bm.Load(gravity=10.0))
    assert math.isclose(chain.reactions["foot"].moment, turn, rel_tol=1e-12)
    for name in ("top", "hook"):
        np.testing.assert_allclose(chain.displacements[name], found.displacements[name], rtol=1e-5, atol=1e-9)


def test_the_weight_of_a_beam_whose_mass_is_a_function() -> None:
    # By hand: a mast of ρA(x) = 0.62 (1 - x/2.4)³ at an angle, ∫ ρA and ∫ x ρA; a table of it bends alike.
    def mass(x: Any) -> Any:
        return 0.62 * (1.0 - x / 2.4) ** 3

    fine = np.linspace(0.0, 1.2, 101)
    rows = []
    for given in (mass, bm.Table(fine.tolist(), mass(fine).tolist())):
        mast = bm.Structure(
            {"foot": bm.Joint(0, 0, "clamped"), "top": bm.Joint(0.72, 0.96)},
            [bm.Member(bm.Beam(1.2, 85.0, given), "foot", "top")],
        )
        found = bm.structure_statics(mast, bm.Load(gravity=10.0))
        rows.append([found.deflection(1.2), found.axial_force(0.3), *found.reactions["foot"]])
    total, first = 6.2 * 0.6 * (1 - 0.5**4), 6.2 * 1.44 * (4 * 0.5**5 / 5 - 0.5**4 + 0.2)
    np.testing.assert_allclose(rows[0][3:], [total, 0.6 * first], rtol=1e-11)
    np.testing.assert_allclose(rows[1], rows[0], rtol=1e-4, atol=1e-12)


def test_random_structures_by_their_vibration() -> None:
    # Forces at joints: the compliance of the judge's K(0), and of the chain's energy coordinates, both of
    # which know nothing of equilibrium.
    held = 0
    for seed in range(60):
        given = structure(seed)
        judge = StructureModel.of(given.parts, (1,) * len(given.parts.stretches), 22)
        if judge.rigid:
            continue
        held += 1
        chain = bm.StructureChain(given, [4] * len(given.parts.stretches))
        springs = StructureCoordinates.of(chain)
        names = list(given.joints)
        pushed = np.random.default_rng(seed).normal(size=(len(names), 2))
        load = [
            bm.PointLoad(joint=name, force=tuple(push))
            for name, push in zip(names, pushed.tolist(), strict=True)
        ]
        moved = np.array([judge.motions[i][:2] for i in range(len(names))])
        followed = springs.unit * springs.follow[: 2 * len(given.parts.nodes)].reshape(
            -1, 2, springs.give.shape[1]
        )
        for found, way in (
            (bm.structure_statics(given, load), moved),
            (bm.structure_chain_statics(chain, load), followed[: len(names)]),
        ):
            answer = np.einsum("ikz,jlz,jl->ik", way, way, pushed)
            told = np.array([found.displacements[name][:2] for name in names])
            np.testing.assert_allclose(
                told, answer, atol=1e-9 * np.abs(answer).max() + 1e-12, err_msg=f"seed {seed}"
            )
    assert held > 20


def test_between_places_the_curve_bends_as_the_moment_says() -> None:
    beam = of((bm.End(30.0, 2.0), "pinned"), bm.Station(0.3, 50.0), bm.Station(0.6, hinge=1.5))
    loads = [bm.LineLoad((0.2, -3.0, 2.0), 0.1, 0.9), bm.PointLoad(0.45, 0.4, -0.3)]
    found = bm.structure_statics(beam, loads)
    x, h = np.array([0.05, 0.2, 0.37, 0.52, 0.7, 0.95]), 1e-4
    bent = (found.deflection(x + h) - 2 * found.deflection(x) + found.deflection(x - h)) / h**2
    np.testing.assert_allclose(bent, found.moment(x), atol=1e-6)
    np.testing.assert_allclose(
        (found.moment(x + h) - found.moment(x - h)) / (2 * h), found.shear(x), atol=1e-6
    )
    np.testing.assert_allclose(
        (found.deflection(x + h) - found.deflection(x - h)) / (2 * h), found.rotation(x), atol=1e-7
    )


def test_a_roller_on_a_slope() -> None:
    # Its force stands on the slope: half the load up, and that times tan α towards the pin, along the bar.
    slope = math.pi / 6
    joints = {"a": bm.Joint(0, 0, "pinned"), "b": bm.Joint(1, 0, (0.0, INF, 0.0), angle=slope)}
    bar = bm.Structure(joints, [bm.Member(UNIT, "a", "b")])
    found = bm.structure_statics(bar, FORCE)
    assert found.reactions["b"] == pytest.approx((-0.5 * math.tan(slope), 0.5, 0.0), rel=1e-12)
    assert found.axial_force(0.3) == pytest.approx(-0.5 * math.tan(slope), rel=1e-12)
    assert found.deflection(0.5) == pytest.approx(-1 / 48, rel=1e-12)


def test_supports_that_six_digits_do_not_tell_apart() -> None:
    supports = [bm.Station(x, INF) for x in (0.5, 0.5000001, 0.5000002)]
    bar = bm.Structure.of_beam(UNIT, "pinned-pinned", supports)
    found = bm.structure_statics(bar, bm.LineLoad(-1.0)).reactions
    assert list(found)[2:] == [f"left-right at {station.x}" for station in supports]
    assert sum(force.force_y for force in found.values()) == pytest.approx(1.0, rel=1e-9)


def test_walls_do_not_tell_how_they_share_a_pull_along_a_bar() -> None:
    """On any slope; a force across tells all: F/2 and F L/8 of a beam between walls."""
    for x, y in ((1.0, 0.0), (0.8, 0.6)):
        joints = {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(x, y, "clamped")}
        bar = bm.Structure.of_bars(joints, [("a", "b")], bending_stiffness=1.0, mass_per_length=1.0)
        across, both = (bm.structure_statics(bar, bm.PointLoad(0.5, f)).reactions for f in (-1, (x, y - 1)))
        assert across["b"] == pytest.approx((-0.5 * y, 0.5 * x, -0.125), abs=1e-12)
        assert math.isnan(both["a"].force_x) and math.isnan(both["b"].force_x)
        assert math.isnan(both["b"].force_y) == bool(y)
        assert both["b"].moment == pytest.approx(-0.125 * x, rel=1e-12)


def test_what_statics_refuse() -> None:
    bar = of("clamped-pinned")
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: bm.structure_statics(of("pinned-free"), []), "moves freely"),
        (lambda: bm.structure_statics(bar, bm.PointLoad(1.5, force=1.0)), "at most its length 1.0"),
        (lambda: bm.structure_statics(bar, bm.PointLoad(joint="rihgt")), r'did you mean "right"\?'),
        (lambda: bm.structure_statics(bar, bm.Load(tip_force=1.0)), "give forces and moments as PointLoads"),
        (
            lambda: bm.structure_statics(portal(), bm.PointLoad(0.5, 1.0)),
            "member must be one of a-b, b-c, c-d",
        ),
        (lambda: bm.structure_statics(GERBER, bm.PointLoad(0.5, moment=1.0)), "which side of it bears"),
        (lambda: bm.PointLoad(force=1.0), "x or a joint"),
        (lambda: bm.PointLoad(joint="a", force=3.0), "two components"),
    ]
    for call, words in cases:
        with pytest.raises(ValueError, match=words):
            call()


def test_diagrams_are_the_statics() -> None:
    # A force F at 3/4 of a beam between pins, and a moment at 1/4: textbook values at edges and jumps.
    loads = [bm.PointLoad(3.0, force=-8.0), bm.PointLoad(1.0, moment=4.0)]
    found = bm.beam_statics(bm.Beam(4.0, 3.0, 1.0), "pinned-pinned", loads)
    assert found.edges().tolist() == [0.0, 1.0, 3.0, 4.0]
    expected = {
        "shear": {0.0: [3.0], 1.0: [3.0, 3.0], 3.0: [3.0, -5.0], 4.0: [-5.0]},
        "moment": {0.0: [0.0], 1.0: [3.0, -1.0], 3.0: [5.0, 5.0], 4.0: [0.0]},
    }
    told = {"shear": ["3", "−5"], "moment": ["5", "−1"]}
    for quantity, places in expected.items():
        ax = bm.draw_statics(found, quantity=quantity)
        x, y = ax.lines[0].get_xydata()[1:-1].T
        for place, values in places.items():
            np.testing.assert_allclose(y[x == place], values, atol=1e-12)
        assert [text.get_text() for text in ax.texts] == told[quantity]
    # Of a frame: across each member, to its left, the largest a fifth of its larger side away.
    joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 2), "tip": bm.Joint(1, 2)}
    members = [bm.Member(bm.Beam(2, 1, 1), "foot", "corner"), bm.Member(UNIT, "corner", "tip")]
    frame = bm.structure_statics(bm.Structure(joints, members), bm.PointLoad(joint="tip", force=(0.0, -3.0)))
    ax = bm.draw_statics(frame, amplitude=0.2)
    column, beam = (line.get_xydata() for line in ax.lines[0:4:2])
    np.testing.assert_allclose(column[1:-1, 0], 0.4, atol=1e-12)
    np.testing.assert_allclose(beam[1:-1, 1] - 2.0, -0.4 * (1.0 - beam[1:-1, 0]), atol=1e-12)
    assert [text.get_text() for text in ax.texts] == ["−3", "−3"] and ax.get_title() == "bending moment [N m]"
    # The force along a member jumps where it acts, inside one too.
    pulled = bm.structure_statics(of("clamped-free"), bm.PointLoad(0.4, force=(5.0, 1.0)))
    x, y = bm.draw_statics(pulled, quantity="axial_force").lines[0].get_xydata()[1:-1].T
    assert y[x < 0.4].tolist() == [5.0] * int((x < 0.4).sum()) and y[x == 0.4].tolist() == [5.0, 0.0]
    with pytest.raises(TypeError, match="which beam_statics gives of loads with their sizes"):
        bm.draw_statics(bm.beam_statics(UNIT, "clamped-free", "tip_force"))  # type: ignore[arg-type]
