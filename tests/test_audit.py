"""Audits of chains given as arrays: every rule is recognized, errors are the look-up's, springs improve."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_ends import EVERY_N

import beammodes as bm
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.accuracy.errors import frequency_error
from beammodes.auditing.audit import Audit, _by_all_modes, _by_search, audit_chain
from beammodes.auditing.judged_pieces import UNKNOWN, JudgedPieces
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam

BEAM = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)


def arrays(chain: Chain) -> dict[str, Any]:
    return {
        "length": chain.length,
        "mass": chain.mass,
        "rotary_inertia": chain.rotary_inertia,
        "joint_stiffness": chain.joint_stiffness,
    }


def cable(segments: int = 10, beam: Beam = BEAM) -> dict[str, Any]:
    """A chain as MuJoCo's cable makes it: the first segment welded to its parent, EI/ell at every hinge."""
    ell = beam.length / segments
    mass = beam.mean_mass_per_length * ell
    return {
        "length": [ell] * segments,
        "mass": [mass] * segments,
        "rotary_inertia": [mass * ell**2 / 12] * segments,
        "joint_stiffness": [beam.mean_bending_stiffness / ell] * (segments - 1),
    }


def suggested(found: Audit, name: str) -> np.ndarray:
    return next(item.errors for item in found.suggestions if item.name == name)


def test_a_cable_is_named_and_put_right() -> None:
    found = audit_chain(BEAM, "clamped-free", **cable())
    assert (found.layout, found.segments, found.order, found.meets) == ("rigid_stub", 10, 1, False)
    assert found.remark == (
        "first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N"
    )
    assert found.errors[0] == pytest.approx(0.111, abs=5e-4)
    assert abs(suggested(found, "rigid_stub_corrected")[0]) < 0.005
    assert abs(suggested(found, "first_spring_tuned")[0]) < 1e-10
    assert [round(found.length_mismatch, 12), round(found.mass_mismatch, 12)] == [0, 0]


def test_suggested_springs_give_the_errors_they_promise() -> None:
    for item in audit_chain(BEAM, "clamped-free", **cable()).suggestions:
        if item.moves_hinges:
            continue
        again = audit_chain(BEAM, "clamped-free", **cable() | {"joint_stiffness": item.joint_stiffness})
        np.testing.assert_allclose(again.errors, item.errors, rtol=0, atol=1e-12)
        assert item.name not in [other.name for other in again.suggestions]


@pytest.mark.parametrize("boundary", ["clamped-free", "free-clamped", "clamped-clamped", "guided-clamped"])
@pytest.mark.parametrize("rule", EVERY_N)
def test_every_rule_is_recognized(rule: str, boundary: str) -> None:
    chain = Chain(BEAM, boundary, 8, rule)
    found = audit_chain(BEAM, boundary, **arrays(chain))
    assert (found.layout, found.segments) == (rule, 8)
    assert found.order == RULES[rule].declared_order(chain.boundary)
    due = frequency_error(boundary, segments=8, mode=[1, 2, 3], rule=rule)
    np.testing.assert_allclose(found.errors, due, rtol=0, atol=1e-12)
    for item in found.suggestions:
        # Hencky's pieces are not the rods of the rule that is suggested for its hinges.
        if item.name in RULES and rule != "hencky":
            due = chain_errors(Chain(BEAM, boundary, 8, item.name))
            np.testing.assert_allclose(item.errors, due, rtol=0, atol=1e-12)


def test_rules_that_are_one_at_these_ends_are_all_named() -> None:
    found = audit_chain(BEAM, "pinned-pinned", **arrays(Chain(BEAM, "pinned-pinned", 6, "naive")))
    assert (
        "hinges are where equal segments meet: mitiguy (here the same as double_wall, naive" in found.remark
    )
    assert "hencky" not in found.remark and found.meets
    found = audit_chain(BEAM, "free-free", **arrays(Chain(BEAM, "free-free", 6, "half_stub")))
    assert found.remark.startswith("hinges are at the middles of equal segments: half_stub (here the same as")


def test_the_spring_at_the_held_end_is_tuned() -> None:
    given = arrays(Chain(BEAM, "free-clamped", 6, "naive"))
    found = audit_chain(BEAM, "free-clamped", **given)
    (tuned,) = (item for item in found.suggestions if item.name == "first_spring_tuned")
    assert list(np.flatnonzero(tuned.joint_stiffness != given["joint_stiffness"])) == [5]
    assert abs(tuned.errors[0]) < 1e-10


def test_no_known_layout() -> None:
    soft = cable() | {"joint_stiffness": [300.0] * 9}
    found = audit_chain(BEAM, "clamped-free", **soft)
    assert (found.layout, found.order, found.segments) == (UNKNOWN, None, 10)
    # 300 of 708.33 N m/rad, EI/ell.
    assert "with springs of no rule, 0.4235 times those of rigid_stub: as of EI = 36:" in found.remark
    assert suggested(found, "rigid_stub_corrected")[0] == pytest.approx(0.0029, abs=1e-4)
    uneven = cable() | {"length": [0.12 + 1e-3, 0.12 - 1e-3] + [0.12] * 8}
    found = audit_chain(BEAM, "clamped-free", **uneven)
    assert (found.layout, found.segments) == (UNKNOWN, None)
    assert [item.name for item in found.suggestions] == ["first_spring_tuned", "gregory"]


def test_mismatches_and_foreign_rods_are_reported() -> None:
    heavy = cable()
    heavy["mass"] = [1.03 * mass for mass in heavy["mass"]]
    found = audit_chain(BEAM, "clamped-free", **heavy)
    assert found.mass_mismatch == pytest.approx(0.03)
    assert "mass is +3 % off the beam's" in found.text and "length is" not in found.text
    assert found.remark.endswith("falls only as 1/N")
    tip = cable()
    tip["mass"][-1] *= 2
    assert audit_chain(BEAM, "clamped-free", **tip).remark.endswith("which these are not")
    middle = [length / 2 for length in cable()["length"]]
    assert audit_chain(BEAM, "clamped-free", **cable(), centre=middle).remark.endswith("only as 1/N")
    short = audit_chain(Beam(1.25, 85.0, 0.62), "clamped-free", **cable())
    assert short.length_mismatch == pytest.approx(-0.04) and "length is -4 % off" in short.text


def test_modes_that_the_chain_lacks_do_not_meet() -> None:
    found = audit_chain(BEAM, "clamped-free", **cable(3), tolerance=0.49)
    assert np.isnan(found.errors[2:]).all() and not found.meets
    assert "no such mode" in found.text
    assert audit_chain(BEAM, "clamped-free", **cable(6), modes=1, tolerance=0.49).meets


@pytest.mark.parametrize(
    ("changed", "kind", "message"),
    [
        ({"beam": 3}, TypeError, "beam must be a Beam"),
        ({"beam": Beam(1.0, [1.0, 2.0], 1.0)}, ValueError, "beam must be uniform"),
        ({"boundary": "clamped"}, ValueError, "boundary must"),
        ({"modes": 0}, ValueError, "modes must"),
        ({"modes": 2.5}, TypeError, "modes must"),
        ({"tolerance": -1}, ValueError, "tolerance must"),
        ({"tolerance": "1 %"}, TypeError, "tolerance must"),
        ({"length": "0.1"}, TypeError, "length must"),
        ({"mass": [1.0]}, ValueError, "mass must have 10 entries"),
        ({"rotary_inertia": [np.nan] * 10}, ValueError, r"rotary_inertia\[0\] must be finite"),
        ({"joint_stiffness": [0.0] * 9}, ValueError, "joint_stiffness must be greater than 0"),
        ({"joint_stiffness": None}, TypeError, "joint_stiffness must be a sequence"),
        ({"centre": [1.0]}, ValueError, "centre must have 10 entries"),
    ],
)
def test_bad_input_is_named(changed: dict[str, Any], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        audit_chain(**(cable() | {"beam": BEAM, "boundary": "clamped-free"} | changed))


def test_a_rigid_chain_is_refused() -> None:
    with pytest.raises(ValueError, match="length must have pieces"):
        audit_chain(BEAM, "clamped-free", **cable(1))


@pytest.mark.parametrize("rule", ["rigid_stub", "half_stub"])
@pytest.mark.parametrize("boundary", ["clamped-free", "clamped-clamped", "free-guided"])
def test_moving_the_hinges_is_offered_with_its_places_springs_and_errors(rule: str, boundary: str) -> None:
    found = audit_chain(BEAM, boundary, **arrays(Chain(BEAM, boundary, 8, rule)))
    moves = [item for item in found.suggestions if item.moves_hinges]
    if (rule, boundary) == ("half_stub", "free-guided"):
        # This chain's own errors are smaller: a guided end takes nothing away from midpoints.
        assert not moves
        return
    (moved,) = moves
    chain = Chain(BEAM, boundary, 8, moved.name)
    # The closed form, which shares nothing with the eigen-solve behind chain_errors.
    due = frequency_error(boundary, segments=8, mode=[1, 2, 3], rule="gregory")
    np.testing.assert_allclose(moved.errors, due, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(moved.joint_stiffness, chain.joint_stiffness)
    np.testing.assert_allclose(moved.hinge_position, chain.node_position[1:-1], atol=1e-15)
    assert "hinges moved to" in str(moved)


@pytest.mark.parametrize("rule", ["mitiguy", "naive"])
def test_hinges_that_are_in_place_are_not_moved(rule: str) -> None:
    found = audit_chain(BEAM, "clamped-free", **arrays(Chain(BEAM, "clamped-free", 8, rule)))
    assert not any(item.moves_hinges for item in found.suggestions)


@pytest.mark.parametrize("rule", ["gregory", "half_stub_corrected", "mitiguy"])
def test_a_sections_rotary_inertia_does_not_change_the_order_but_has_a_floor(rule: str) -> None:
    """One section at every N: one order, and a floor that is what the exact beam's rotary inertia costs."""
    gyration = 2e-3  # m, of a rod of 4 mm radius
    thick = Beam(BEAM.length, 85.0, 0.62, rotary_inertia_per_length=0.62 * gyration**2)
    cost = euler_bernoulli(thick, "clamped-free", 1).angular_frequency[0]
    cost /= euler_bernoulli(BEAM, "clamped-free", 1).angular_frequency[0]
    for segments in (8, 16, 32, 64):
        chain = Chain(BEAM, "clamped-free", segments, rule)
        given = arrays(chain)
        given["rotary_inertia"] = given["rotary_inertia"] + gyration**2 * given["mass"]
        found = audit_chain(BEAM, "clamped-free", **given, modes=1)
        assert (found.layout, found.order) == (rule, RULES[rule].declared_order(chain.boundary))
        assert "of the rods' own rotary inertia" in found.remark
        floor = found.errors[0] - found.errors_with_rods[0]
        assert floor == pytest.approx(cost - 1, rel=0.05)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.97])
def test_less_rotary_inertia_than_a_rods_limits_the_order_to_two(part: float) -> None:
    # Measured by doubling N: the error falls as 1/N².
    errors = []
    for segments in (40, 80):
        given = arrays(Chain(BEAM, "clamped-free", segments, "gregory"))
        given["rotary_inertia"] = part * given["rotary_inertia"]
        found = audit_chain(BEAM, "clamped-free", **given, modes=1)
        assert (found.layout, found.order) == ("gregory", 2)
        assert "which no section explains" in found.text
        errors.append(found.errors[0])
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("boundary", ["clamped-free", "free-clamped", "clamped-clamped", "guided-pinned"])
@pytest.mark.parametrize("rule", ["naive", "rigid_stub", "mitiguy"])
def test_the_tuned_spring_is_found_by_two_routes(rule: str, boundary: str) -> None:
    chain = Chain(BEAM, boundary, 7, rule)
    given = {key: value for key, value in arrays(chain).items() if key != "joint_stiffness"}
    judged = JudgedPieces.of(BEAM, chain.boundary, given, chain.joint_stiffness, 1)
    at = -1 if judged.bends == (False, True) else 0
    by_modes, by_search = _by_all_modes(judged, at), _by_search(judged, at)
    assert by_search == pytest.approx(max(by_modes, 0.0), rel=1e-9)


def test_a_spring_that_cannot_make_mode_1_exact_is_not_suggested() -> None:
    # Even a stiff first hinge leaves a chain of soft ones too low.
    soft = cable() | {"joint_stiffness": [10.0] * 9}
    found = audit_chain(BEAM, "clamped-free", **soft)
    assert [item.name for item in found.suggestions] == ["rigid_stub_corrected", "gregory"]


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf", ".csv"])
@pytest.mark.parametrize("height", [0.002, 0.2])
def test_files_and_verdicts_of_stout_beams_name_the_theory(
    suffix: str, height: float, tmp_path: Path
) -> None:
    """1 m x 0.2 m: Timoshenko's cantilever is 3.0 % lower in its first mode (Huang, 1961)."""
    section = bm.Rectangle(width=0.1, height=height)
    beam = bm.Beam.from_section(section, density=7850.0, elastic_modulus=210e9, length=1.0)
    chain = bm.Chain(beam, "clamped-free", segments=8, rule="gregory")
    place = bm.export_chain(chain, tmp_path / f"beam{suffix}")[0]
    found = bm.audit_file(place, beam)
    text = place.read_text(encoding="utf-8")
    # Of the chain's three errors, 1e-5, 5e-4 and 8e-3, those of a thin strip are all the larger ones.
    theory, softer = bm.euler_bernoulli(beam, "clamped-free", 1), bm.timoshenko(beam, "clamped-free", 1)
    percent = 100 * (1 - softer.frequency[0] / theory.frequency[0])
    said = f"leaves out lower frequency 1 of this beam by {percent:.3g} %"
    assert (said in text) == (said in " ".join(found.found)) == (height == 0.2)
    assert ("leaves out" in text) == (height == 0.2) == bool(found.theory)
