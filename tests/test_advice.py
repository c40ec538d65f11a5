"""Advice: cheapest first, with everything shown that a choice should rest on."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

import beammodes as bm
from beammodes.accuracy.advice import MOST_SEGMENTS


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
