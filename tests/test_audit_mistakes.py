"""Mistakes of model files are told by name, and what stands beside a chain is not taken for a part of it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from beammodes.auditing.audit import Audit
from beammodes.auditing.audit_model import audit_file
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.space_audit import SpatialAudit
from beammodes.problem.beam import Beam
from beammodes.problem.rod import Rod

BEAM = Beam(1.0, 2.0, 0.5)
EQUAL = [0.2] * 5


def bodies(
    lengths: list[float] = EQUAL,
    springs: float = 10.0,
    masses: dict[int, float] | None = None,
    axes: dict[int, str] | None = None,
    first: str = "",
    tip: str = "",
) -> str:
    """Rods of 0.5 kg/m along x on hinges about y; `first` stands beside the first hinge, `tip` at the tip."""
    text, at = "", 0.0
    for i, length in enumerate(lengths):
        mass = (masses or {}).get(i, 0.5 * length)
        axis = (axes or {}).get(i, "0 1 0")
        text += (
            f'<body name="seg{i}" pos="{at} 0 0">{first if i == 0 else ""}'
            f'<joint name="joint{i}" axis="{axis}" stiffness="{springs}"/>'
            f'<geom type="cylinder" size=".005" fromto="0 0 0 {length} 0 0" mass="{mass}"/>'
        )
        at = length
    return text + tip + "</body>" * len(lengths)


def asked(
    tmp_path: Path, inside: str, after: str = "", boundary: str | None = None, gravity: str = "0 0 0"
) -> Audit:
    path = tmp_path / "model.xml"
    path.write_text(
        f'<mujoco><option gravity="{gravity}"/><worldbody>{inside}</worldbody>{after}</mujoco>', "utf-8"
    )
    found = audit_file(path, BEAM, boundary)
    assert isinstance(found, Audit)
    return found


@pytest.mark.parametrize(
    ("inside", "said"),
    [
        (bodies([0.2, 0.2, 0.3, 0.2, 0.2]), "segment 3 is 0.3 m long, most others 0.2 m"),
        (bodies(masses={2: 0.01}), "segment 3 is of 0.05 kg/m, most others of 0.5 kg/m"),
        (
            bodies([0.1] * 10, masses={0: 0.02, 9: 0.03}),
            "segment 1 is of 0.2 kg/m, segment 10 of 0.3 kg/m, most others of 0.5 kg/m",
        ),
        (bodies(masses=dict.fromkeys(range(5), 100.0)), "off the beam's (1000 times it: in other units?)"),
        (bodies(springs=10 * math.pi / 180), "springs given per degree"),
        (bodies(springs=10 * 180 / math.pi), "springs turned from degrees twice"),
    ],
)
def test_what_is_unlike_the_rest_is_named(inside: str, said: str, tmp_path: Path) -> None:
    assert said in asked(tmp_path, inside).text


def test_pieces_that_are_alike_or_all_unlike_are_not_named(tmp_path: Path) -> None:
    for lengths in (EQUAL, [0.4, 0.3, 0.2, 0.1]):
        assert "most others" not in asked(tmp_path, bodies(lengths)).text


@pytest.mark.parametrize(
    ("inside", "after", "boundary", "said"),
    [
        (
            bodies(axes={2: "0.01 1 0"}),
            "",
            None,
            r"joint2 .* 0\.573 degrees off.*turn the axis of joint2",
        ),
        (
            bodies(masses={2: 0.1}, tip='<geom size=".01" pos=".2 0 .1" mass=".1"/>'),
            "",
            None,
            "0.05 m beside",
        ),
        # Hinges that turn as one are no hinges of their own: no word about the ends changes that.
        *(
            (bodies(), f"<equality><joint {tie}/></equality>", word, "must not tie hinges of the chain")
            for tie in ('joint1="joint4" joint2="joint3"', 'joint1="joint4" polycoef=".1 0 0 0 0"')
            for word in (None, "clamped-free")
        ),
        (bodies(), '<actuator><position joint="joint2" kp="3"/></actuator>', None, "its gain as stiffness"),
    ],
)
def test_refusals_say_what_is_wrong(
    inside: str, after: str, boundary: str | None, said: str, tmp_path: Path
) -> None:
    with pytest.raises(BadModel, match=said):
        asked(tmp_path, inside, after, boundary)


def test_a_push_that_is_held_by_word_leaves_the_springs_beside_it(tmp_path: Path) -> None:
    plain = asked(tmp_path, bodies())
    pushed = bodies(first='<joint name="push" type="slide" axis="1 0 0" range="0 .1" limited="true"/>')
    with pytest.raises(BadModel, match='with push held it is "clamped-free"'):
        asked(tmp_path, pushed)
    held = asked(tmp_path, pushed, boundary="clamped-free")
    assert "push held, because you say so" in held.assumed
    assert held.hinge_names == plain.hinge_names
    np.testing.assert_allclose(held.angular_frequency, plain.angular_frequency, rtol=1e-12)


def test_the_mass_of_a_hub_on_its_pin_is_none_of_the_beam(tmp_path: Path) -> None:
    hub = '<body name="hub"><joint name="motor" axis="0 1 0"/><geom type="box" size=".05 .05 .05" mass="2"/>'
    for boundary in (None, "clamped-free"):
        assert asked(tmp_path, f"{hub}{bodies()}</body>", boundary=boundary).mass_mismatch == pytest.approx(
            0, abs=1e-9
        )


def test_a_heavy_body_as_large_as_a_segment_need_not_be_one(tmp_path: Path) -> None:
    car = '<body name="car"><freejoint/><geom type="box" size=".2 .2 .2" mass="10"/>'
    hand = '<body name="hand" pos=".2 0 0"><joint name="wrist" axis="0 1 0" stiffness="10"/>'
    hand += '<geom type="box" size=".05 .04 .03" mass="1" pos=".05 0 0"/></body>'
    for inside in (f"{car}{bodies()}</body>", bodies(tip=hand)):
        found = asked(tmp_path, inside)
        assert found.length_mismatch == pytest.approx(0, abs=1e-9)
        assert "which comes nearest to its length; the file fits" in found.text


def test_gravity_along_the_hinges_is_not_made_something_by_rounding(tmp_path: Path) -> None:
    text = asked(tmp_path, bodies(), gravity="1e-16 -9.81 1e-15").text
    assert "gravity of" not in text


def test_a_model_that_is_static_is_judged_as_if_it_moved_and_said_so(tmp_path: Path) -> None:
    path = tmp_path / "model.sdf"
    link = "<link name='a'><inertial><pose>.5 0 0 0 0 0</pose><mass>.5</mass></inertial></link>"
    joint = "<joint name='j' type='revolute'><parent>world</parent><child>a</child><axis>"
    joint += "<xyz>0 1 0</xyz><dynamics><spring_stiffness>9</spring_stiffness></dynamics></axis></joint>"
    path.write_text(f"<sdf version='1.9'><model name='rod'><static>true</static>{link}{joint}</model></sdf>")
    assert (
        "<static> keeps model 'rod' from moving: it is judged as without it" in audit_file(path, BEAM).assumed
    )


def test_a_joint_that_is_misspelt_in_the_springs_is_offered(tmp_path: Path) -> None:
    path = tmp_path / "model.urdf"
    path.write_text(
        "<robot><link name='a'/><link name='b'/><joint name='bend_1' type='revolute'><parent link='a'/>"
        "<child link='b'/></joint></robot>"
    )
    path.with_name("model.springs.yaml").write_text("springs:\n  - {joint: Bend1, stiffness: 3}\n")
    with pytest.raises(BadModel, match=r"got 'Bend1' \(did you mean 'bend_1'\?\)"):
        audit_file(path, BEAM)


def test_a_turned_axis_leaves_a_chain_beside_the_bending_that_it_has(tmp_path: Path) -> None:
    path, rod = tmp_path / "model.xml", Rod(1.0, 2.0, 1.5, 0.5, 1e-5)
    found = []
    for axes in ({}, {2: "0.01 1 0"}, {2: "0 1 .01"}):
        path.write_text(f"<mujoco><worldbody>{bodies(axes=axes)}</worldbody></mujoco>", "utf-8")
        one = audit_file(path, rod, motion="space")
        assert isinstance(one, SpatialAudit)
        assert "the file's chain lacks joints" in one.text
        assert ("joint2 is turned by 0.573 degrees" in one.text) == bool(axes)
        found.append(one.errors)
    # A cosine of 0.01 changes frequencies by its square; the rod's own section by 1/1000 of the third.
    for errors in found[1:]:
        np.testing.assert_allclose(errors, found[0], atol=2e-3)


def test_hinges_at_the_far_ends_of_their_segments_are_named(tmp_path: Path) -> None:
    one = '<body pos=".2 0 0"><joint name="j{0}" axis="0 1 0" stiffness="10"/>'
    one += '<geom type="cylinder" size=".005" fromto="-.2 0 0 0 0 0" mass=".1"/>'
    text = asked(tmp_path, "".join(one.format(i) for i in range(5)) + "</body>" * 5).text
    assert "the hinges stand at the far end of their segments" in text
    assert "far end of their" not in asked(tmp_path, bodies()).text


def test_sprung_leaves_are_told_what_to_do_with(tmp_path: Path) -> None:
    leaf = '<body name="leaf{0}" pos=".2 0 0"><joint name="stem{0}" axis="0 1 0" stiffness="1"/>'
    leaf += '<geom type="box" size=".01 .01 .01" pos=".05 0 0" mass=".01"/></body>'
    with pytest.raises(BadModel, match=r"spring of its own: .* by chain \('leaf0'\); .* counts by its mass"):
        asked(tmp_path, bodies(tip=leaf.format(0) + leaf.format(1)))


def test_a_sag_beyond_small_deflections_is_no_number(tmp_path: Path) -> None:
    text = asked(tmp_path, bodies(springs=0.05), gravity="0 0 -9.81").text
    assert "bends the chain far beyond small deflections" in text
    assert "find_equilibrium" in text
    assert "sag by" not in text


def test_a_cable_without_twist_is_told_so(tmp_path: Path) -> None:
    rod = (
        '<body name="c{0}" pos=".2 0 0">{1}<geom type="capsule" size=".01" fromto="0 0 0 .2 0 0" mass=".1"/>'
    )
    rod += '<plugin instance="own"/>'
    ball = '<joint name="b{0}" type="ball"/>'
    cable = "".join(rod.format(i, ball.format(i) if i else "") for i in range(5)) + "</body>" * 5
    plugin = '<extension><plugin plugin="mujoco.elasticity.cable"><instance name="own">'
    plugin += '<config key="bend" value="1e7"/></instance></plugin></extension>'
    path = tmp_path / "model.xml"
    path.write_text(f"<mujoco>{plugin}<worldbody>{cable}</worldbody></mujoco>", "utf-8")
    with pytest.raises(BadModel, match="a cable whose twist is 0"):
        audit_file(path, Rod(1.0, 2.0, 1.5, 0.5, 1e-5), motion="space")


def test_bodies_that_are_not_nested_are_told_so(tmp_path: Path) -> None:
    link = '<body pos="{0} 0 0"><joint axis="0 1 0" stiffness="10"/>'
    link += '<geom type="cylinder" size=".005" fromto="0 0 0 .2 0 0" mass=".1"/></body>'
    assert "not nested" in asked(tmp_path, "".join(link.format(0.2 * i) for i in range(5))).text
    assert "not nested" not in asked(tmp_path, bodies()).text
