"""Advice: cheapest first, with everything shown that a choice should rest on."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

import beammodes as bm
from beammodes.accuracy.advice import MOST_SEGMENTS
from beammodes.accuracy.judged_motions import judged_rod


@pytest.mark.parametrize(
    "boundary",
    [
        "clamped-free",
        pytest.param("clamped-clamped", marks=pytest.mark.slow),
        "pinned-free",
        pytest.param("free-guided", marks=pytest.mark.slow),
    ],
)
def test_every_way_meets_the_tolerance_and_shows_its_cost(boundary: str) -> None:
    beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    ways = bm.recommend(boundary, tolerance=0.01, modes=3, beam=beam)
    assert {way.rule for way in ways} == set(bm.RULES)
    assert [way.cost for way in ways] == sorted(way.cost for way in ways)
    period = 1 / bm.euler_bernoulli(beam, boundary, 1).frequency[0]
    for way in ways:
        chain = bm.Chain(beam, boundary, way.segments, way.rule)
        assert way.segments == bm.segments_needed(boundary, 0.01, 3, way.rule)
        assert way.largest_error <= 0.01
        np.testing.assert_array_equal(way.joint_stiffness, chain.joint_stiffness)
        assert way.stable_time_step == pytest.approx(bm.stable_time_step(chain), rel=1e-12)
        assert way.stable_time_step * way.highest_angular_frequency == pytest.approx(math.sqrt(8), rel=1e-12)
        assert way.cost == pytest.approx(way.segments * period / way.stable_time_step, rel=1e-12)
        movable = chain.boundary.rigid_body_modes
        assert (way.static_error == {}) == bool(movable)


def test_static_errors_are_those_of_the_statics() -> None:
    ways = {way.rule: way for way in bm.recommend("clamped-free", tolerance=0.01, modes=3)}
    # The report's rule: tip force exact at every N; a tip moment is off by -1/(3N²), its wall's flexibility.
    report = ways["mitiguy"]
    assert report.static_error["tip_force"] == pytest.approx(0, abs=1e-14)
    assert report.static_error["tip_moment"] == pytest.approx(-1 / (3 * report.segments**2), rel=1e-10)


def test_rules_and_integrators_can_be_chosen() -> None:
    quick, slow = (
        bm.recommend("clamped-free", 0.01, rules=["gregory"], integrator=name)[0]
        for name in ("rk4", "leapfrog")
    )
    assert slow.stable_time_step == pytest.approx(quick.stable_time_step / math.sqrt(2), rel=1e-12)
    tuned = bm.recommend("clamped-free", 0.001, rules=[bm.mode_tuned(1), "mitiguy"])
    assert [way.rule for way in tuned] == ["mode_tuned(1)", "mitiguy"]


def test_what_nobody_would_simulate_is_not_recommended() -> None:
    ways = bm.recommend("clamped-free", tolerance=1e-5)
    assert "naive" not in {way.rule for way in ways}
    assert max(way.segments for way in ways) <= MOST_SEGMENTS
    with pytest.raises(ValueError, match="tolerance must be larger"):
        bm.recommend("clamped-free", tolerance=1e-6, rules=["naive"])
    with pytest.raises(ValueError, match="tolerance must be larger"):
        bm.recommend("clamped-free", tolerance=1e-13, rules=["naive"])


def test_bad_arguments() -> None:
    with pytest.raises(ValueError, match="rules must name at least one"):
        bm.recommend("clamped-free", 0.01, rules=[])
    with pytest.raises(ValueError, match=r"integrator.*leapfrog"):
        bm.recommend("clamped-free", 0.01, integrator="leapfrg")
    with pytest.raises(ValueError, match="tolerance"):
        bm.recommend("clamped-free", 0)


def test_beams_that_vary_are_advised_by_their_own_errors() -> None:
    taper = bm.Beam(1.0, lambda x: (1 - x / 2) ** 3, lambda x: 1 - x / 2)
    for beam in (taper, bm.Beam(1.0, [2.0, 1.0], 1.0), bm.Beam(1.0, 1.0, 1.0, 1e-3)):
        ways = bm.recommend("clamped-free", 0.01, 2, beam=beam, rules=["gregory", "mitiguy"])
        assert len(ways) == 2
        for way in ways:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", bm.SlendernessWarning)
                errors = [
                    np.abs(bm.chain_errors(bm.Chain(beam, "clamped-free", n, way.rule), 2)).max()
                    for n in (way.segments - 1, way.segments)
                ]
            assert errors[1] == pytest.approx(way.largest_error, rel=1e-9)
            assert errors[1] <= 0.01 < errors[0]


def test_advice_says_what_no_number_of_segments_mends() -> None:
    stout = bm.Beam.from_section(bm.Rectangle(1.0, 2.0), density=7800.0, elastic_modulus=210e9, length=10.0)
    way = bm.recommend("clamped-free", 0.01, 3, beam=stout, rules=["gregory"])[0]
    assert way.theory_error == pytest.approx(bm.theory_errors(stout, "clamped-free")[2], rel=1e-12)
    assert "theory error -29.2 %" in repr(way)
    assert math.isnan(bm.recommend("clamped-free", 0.01, rules=["gregory"])[0].theory_error)


def test_twist_and_stretch_are_advised_by_their_own_errors_and_steps() -> None:
    rod = bm.Beam(0.5, 1.0, 0.6, torsional_stiffness=80.0, polar_inertia_per_length=8e-6, axial_stiffness=2e6)
    for motion, ends in (("twist", "fixed-free(inertia=2e-6)"), ("stretch", "free(stiffness=1e7)-free")):
        ways = bm.recommend(ends, 0.01, 2, beam=rod, motion=motion, rules=["mitiguy", "half_stub", "naive"])
        period = bm.axial_modes(rod, ends, 1, motion=motion).frequency[0] ** -1
        for way in ways:
            chain = bm.AxialChain(rod, ends, way.segments, way.rule, motion=motion)
            assert way.segments == bm.segments_needed(ends, 0.01, 2, way.rule, beam=rod, motion=motion)
            assert way.stable_time_step == pytest.approx(bm.stable_time_step(chain), rel=1e-12)
            assert way.cost == pytest.approx(way.segments * period / way.stable_time_step, rel=1e-12)
            np.testing.assert_array_equal(way.joint_stiffness, chain.joint_stiffness)
            assert (way.segments_set_by, way.step_set_by, way.static_error) == (motion, motion, {})
    stepped = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=[2.0, 1.0], polar_inertia_per_length=1.0)
    way = bm.recommend("fixed-free", 0.01, beam=stepped, motion="twist", rules=["half_stub"])[0]
    assert way.largest_error <= 0.01 and way.segments_set_by == "twist"


STEEL = {"density": 7800.0, "elastic_modulus": 200e9, "poisson_ratio": 0.3}
BLADE = bm.Rod(0.4, **bm.Rod.of_section(bm.Rectangle(width=0.01, height=0.02), **STEEL))


def test_a_straight_rod_is_advised_by_its_three_motions() -> None:
    ends = (
        bm.RodEnd.of("clamped"),
        bm.RodEnd(mass=0.2, rotary_inertia=(3e-5, 2e-5, 2e-5), offset=(0.01, 0, 0)),
    )
    wanted = {"bending": 2, "second_bending": 1, "twist": 1}
    beam, weak = (
        bm.Beam(0.4, stiffness, BLADE.mass_per_length)
        for stiffness in (BLADE.bending_stiffness, BLADE.second_bending_stiffness)
    )
    shaft = bm.Beam(
        0.4,
        1.0,
        1.0,
        torsional_stiffness=BLADE.torsional_stiffness,
        polar_inertia_per_length=BLADE.polar_inertia_per_length,
    )
    tip = bm.End(mass=0.2, rotary_inertia=2e-5, offset=0.01)
    for way in bm.recommend(ends, 1e-3, wanted, beam=BLADE, rules=["gregory", "mitiguy", "half_stub"]):
        alone = {
            "bending": bm.segments_needed(("clamped", tip), 1e-3, 2, way.rule, beam=beam),
            "second_bending": bm.segments_needed(("clamped", tip), 1e-3, 1, way.rule, beam=weak),
            "twist": bm.segments_needed(
                "fixed-free(inertia=3e-5)", 1e-3, 1, way.rule, beam=shaft, motion="twist"
            ),
        }
        chain = bm.SpatialChain(BLADE, ends, way.segments, way.rule)
        assert (
            way.segments
            == max(alone.values())
            == bm.segments_needed(ends, 1e-3, wanted, way.rule, beam=BLADE)
        )
        assert alone[way.segments_set_by] == way.segments
        assert way.stable_time_step == pytest.approx(bm.stable_time_step(chain), rel=1e-9)
        steps = {
            "bending": bm.stable_time_step(bm.Chain(beam, ("clamped", tip), way.segments, way.rule)),
            "second_bending": bm.stable_time_step(bm.Chain(weak, ("clamped", tip), way.segments, way.rule)),
            "twist": bm.stable_time_step(
                bm.AxialChain(shaft, "fixed-free(inertia=3e-5)", way.segments, way.rule)
            ),
        }
        assert way.step_set_by == min(steps, key=lambda name: steps[name])
        np.testing.assert_array_equal(way.joint_stiffness, chain.joint_stiffness)
    # Of the first modes together, by frequency, those of each motion: here none twists. The same rod, bent by
    # next to nothing, is judged as a whole.
    bent = bm.Rod(
        0.4,
        BLADE.bending_stiffness,
        BLADE.torsional_stiffness,
        BLADE.mass_per_length,
        BLADE.polar_inertia_per_length,
        second_bending_stiffness=BLADE.second_bending_stiffness,
        curvature=(0.0, 0.0, 1e-9),
    )
    for modes, rule in ((3, "gregory"), (3, "mitiguy"), (1, "naive")):
        assert bm.segments_needed("clamped-free", 0.01, modes, rule, beam=BLADE) == bm.segments_needed(
            "clamped-free", 0.01, modes, rule, beam=bent
        )


HOOK = bm.Rod.hook(
    straight=1.0, radius=0.3, angle=2.0, bending_stiffness=1.0, torsional_stiffness=0.8, mass_per_length=1.0
)
HELIX = bm.Rod.helix(
    radius=0.1,
    pitch=0.05,
    turns=1,
    bending_stiffness=1.3,
    torsional_stiffness=1.0,
    mass_per_length=1.0,
    polar_inertia_per_length=1e-4,
)


@pytest.mark.parametrize(
    ("rod", "rule", "tolerance"),
    [
        pytest.param(HELIX, "gregory", 1e-3, marks=pytest.mark.slow),
        (HELIX, "simpson", 1e-3),
        pytest.param(HOOK, "half_stub_corrected", 2e-3, marks=pytest.mark.slow),
        (HOOK, "mitiguy", 0.04),
    ],
    ids=["helix", "helix by pairs", "hook", "hook, order 2"],
)
def test_segments_of_a_bent_rod_are_those_of_looking_at_every_chain(
    rod: bm.Rod, rule: str, tolerance: float
) -> None:
    needed = bm.segments_needed("clamped-free", tolerance, 3, rule, beam=rod)
    table = bm.rod_error_dataset(rod, "clamped-free", segments=range(1, 2 * needed + 1), modes=3, rule=rule)
    error = np.abs(table.relative_error.squeeze("rule")).max("mode", skipna=False)
    there = error.segments.values[np.isfinite(error.values) | (error.segments.values < 4)]
    failing = [n for n in there if not error.sel(segments=n) <= tolerance]
    assert needed == min(n for n in there if n > max(failing))
    way = bm.recommend("clamped-free", tolerance, 3, beam=rod, rules=[rule])[0]
    assert way.segments == needed and way.largest_error == pytest.approx(float(error.sel(segments=needed)))
    assert way.stable_time_step == bm.stable_time_step(bm.SpatialChain(rod, "clamped-free", needed, rule))
    assert {way.segments_set_by, way.step_set_by} <= {"bending", "second_bending", "twist"}


def test_what_a_rod_is_not_advised_for_is_named() -> None:
    for call in (bm.recommend, bm.segments_needed):
        with pytest.raises(
            ValueError, match="modes must be one number for a rod whose bending and twist are not apart"
        ):
            call("clamped-free", 0.01, {"bending": 1}, beam=HELIX)
        with pytest.raises(ValueError, match=r'motion in modes must be one of .*did you mean "twist"'):
            call("clamped-free", 0.01, {"twst": 1}, beam=BLADE)
        with pytest.raises(ValueError, match="motion must be left out with a rod"):
            call("clamped-free", 0.01, beam=BLADE, motion="twist")
        with pytest.raises(TypeError, match="modes must be a"):
            call("clamped-free", 0.01, {"bending": 1})
    with pytest.raises(
        ValueError, match="tolerance must be larger: with rule naive and 3 modes no chain of up to 1000"
    ):
        bm.segments_needed("clamped-free", 1e-4, 3, "naive", beam=HELIX)
    with pytest.raises(ValueError, match="rule must be one for any motion"):
        bm.recommend("clamped-free", 0.01, beam=BLADE, rules=[bm.mode_tuned(1)])


@pytest.mark.slow
def test_the_motions_of_straight_rods_are_those_of_their_chains_in_space() -> None:
    even = bm.Rod(1.0, 1.0, 0.7, 1.0, 0.01, second_bending_stiffness=3.0)
    vary = bm.Rod(1.0, [2.0, 1.0], 1.0, 1.0, 0.01, second_bending_stiffness=lambda s: 3 - s)
    body = bm.RodEnd(mass=0.3, rotary_inertia=(0.02, 0.015, 0.01), offset=(0.05, 0, 0))
    sprung = bm.RodEnd((0, 20.0, 5.0), (3.0, 2.0, 1.0), 0.2, 0.01)
    shaft = (bm.RodEnd(math.inf, (math.inf, 0, 0)), bm.RodEnd((0, math.inf, math.inf)))
    for rod in (even, vary):
        for given in ("clamped-free", "free-free", "guided-pinned", ("clamped", body), (body, sprung), shaft):
            ends = bm.RodEnds.of(given)
            judges = judged_rod(rod, ends, {"bending": 2, "second_bending": 1, "twist": 1})
            exact = bm.rod_modes(rod, ends, 14).angular_frequency
            for name in ("gregory", "half_stub", "rigid_stub_corrected"):
                rule, chain = bm.RULES[name], bm.SpatialChain(rod, ends, 7, name)
                every = bm.spatial_modes(chain, 1000).angular_frequency
                assert judges[0].highest(rule, 7)[0] == pytest.approx(every[-1], rel=1e-8)
                for judge in judges:
                    found = judge.frequencies(rule, 7)
                    assert np.abs(exact / judge.exact[:, None] - 1).min(axis=1).max() < 1e-8
                    assert np.abs(every / found[:, None] - 1).min(axis=1).max() < 1e-9, (
                        given,
                        name,
                        judge.name,
                    )
                    np.testing.assert_allclose(judge.errors(rule, 7), found / judge.exact - 1, atol=1e-9)


def test_any_beam_under_a_load_is_advised_as_looking_at_every_chain_does() -> None:
    # Held to hang, tapered: N by looking at every chain beside the exact beam, from the top down.
    taper = bm.Beam(1.2, lambda x: 85.0 - 40.0 * x, lambda x: 0.62 - 0.2 * x)
    hung = bm.Load(gravity=(9.81, 0.0), axial_force=-2.0)
    rule, limit = "gregory", 0.01
    errors = [
        np.abs(bm.chain_errors(bm.Chain(taper, "clamped-free", n, rule), 2, load=hung)) for n in range(2, 13)
    ]
    last = max(n for n, error in enumerate(errors, start=2) if not (error <= limit).all())
    needed = bm.segments_needed("clamped-free", limit, 2, rule, beam=taper, load=hung)
    assert needed == last + 1
    (way,) = bm.recommend("clamped-free", limit, 2, beam=taper, load=hung, rules=[rule])
    chain = bm.Chain(taper, "clamped-free", needed, rule)
    assert way.segments == needed
    assert way.largest_error == pytest.approx(errors[needed - 2].max(), rel=1e-9)
    assert way.stable_time_step == pytest.approx(bm.stable_time_step(chain, load=hung), rel=1e-9)
    # A uniform beam is looked up; a load that bends it, or that has no beam, is refused.
    beam, pull = bm.Beam(1.2, 85.0, 0.62), bm.Load(axial_force=150.0)
    shaft = bm.Beam(1.2, 85.0, 0.62, torsional_stiffness=60.0, polar_inertia_per_length=1e-4)
    (way,) = bm.recommend("clamped-free", 0.01, 3, beam=beam, load=pull, rules=["mitiguy"])
    assert way.segments == bm.segments_needed("clamped-free", 0.01, 3, beam=beam, load=pull)
    for given, message in (
        ({"load": pull}, "load must come with a beam"),
        ({"load": bm.Load(tip_force=1.0), "beam": taper}, "load must leave the straight beam"),
        ({"load": pull, "beam": shaft, "motion": "twist"}, "load must be left out for motion twist"),
    ):
        for ask in (bm.recommend, bm.segments_needed):
            with pytest.raises(ValueError, match=message):
                ask("clamped-free", 0.01, **given)
