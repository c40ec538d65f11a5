"""What an audit makes of files that do not say all: where the beam ends, what is held, whose matter it is.

Files are drawn over N, layouts, placements, masses and formats. Truth is the chain itself, which
shares nothing with the readers; where MuJoCo is installed, also its matrices.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from test_read_mjcf import mujoco_frequencies, world
from turns import in_turns

from beammodes.auditing.audit import Audit, audit_chain
from beammodes.auditing.audit_model import audit_file
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exporters.chain_csv import read_chain_csv
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

Array = NDArray[np.float64]

LENGTH, STIFFNESS, DENSITY = 1.0, 2.0, 0.5
LAYOUTS = ("naive", "mitiguy", "gregory", "rigid_stub", "half_stub")
ENDS = ("clamped-free", "pinned-free", "free-free")


@dataclass(frozen=True)
class Placed:
    """Where a chain stands: the first body's own pose, and the sense in which it runs along x."""

    pose: str = ""
    sense: float = 1.0


PLACES = (
    Placed('pos="0 0 0"'),
    Placed('pos="0.2 0 0"'),
    Placed('pos="-0.25 0 0"'),
    Placed('pos="7 -3 2" quat="0.3 -0.2 0.9 0.1"'),
    Placed('pos="0.2 0.1 0" quat="1 0 0 1"', -1.0),
    Placed('pos="0 0 0"', -1.0),
)


def rods(ends: str, rule: str, segments: int) -> Chain:
    """The chain that a file is written of."""
    return Chain(Beam(LENGTH, STIFFNESS, DENSITY), ends, segments, rule)


def mjcf(
    chain: Chain,
    place: Placed = PLACES[0],
    *,
    tip: str = "",
    carrier: str = "",
    inertia: float = 1.0,
    **joint: str,
) -> str:
    """A chain as nested bodies, each with its mass, as people write them; none for what has no length."""
    held = chain.boundary.left.holds_rotation
    first = "" if chain.boundary.left.holds_deflection else "<freejoint/>"
    if chain.boundary.left.statics == "pinned":
        first = '<joint name="pivot" axis="0 1 0"/>'
    more = "".join(f' {key}="{value}"' for key, value in joint.items())
    springs = [None, *chain.joint_stiffness.tolist()]
    columns = [each.tolist() for each in (chain.length, chain.mass, chain.centre, chain.rotary_inertia)]
    rows = list(zip(*columns, springs, strict=True))
    text, before = "", None
    for i, (length, mass, centre, about, spring) in reversed(list(enumerate(rows))):
        if not length:
            continue
        own = (
            f'<joint name="j{i}" axis="0 1 0" stiffness="{spring!r}"{more}/>'
            if spring
            else ("" if held else first)
        )
        start = place.sense * rows[i - 1][0] if i else 0.0
        where = f'pos="{start!r} 0 0"' if before is not None or i else ""
        solid = (
            f'<inertial pos="{place.sense * centre!r} 0 0" mass="{mass!r}" '
            f'diaginertia="{0.1 * inertia * about!r} {inertia * about!r} {inertia * about!r}"/>'
        )
        end = tip if i == len(rows) - 1 else ""
        outermost = not any(row[0] for row in rows[:i])
        text = f'<body name="s{i}" {place.pose if outermost else where}>{own}{solid}{end}{text}</body>'
        before = i
    return world(carrier.format(text) if carrier else text)


def written(folder: Path, text: str, name: str = "model.xml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def frequencies(chain: Chain, modes: int = 3) -> Array:
    return solve_modes(linearize(chain), modes).angular_frequency


@pytest.mark.parametrize(
    ("ends", "rule", "segments", "share"), in_turns(ENDS, LAYOUTS, [4, 7], [0.5, 1.0, 1.2], every=2)
)
def test_a_chain_of_another_length_is_said_to_be_so(
    ends: str, rule: str, segments: int, share: float, tmp_path: Path
) -> None:
    """The beam's length never decides which part of the file is beam."""
    chain = rods(ends, rule, segments)
    beam = Beam(share * LENGTH, STIFFNESS, DENSITY)
    found = audit_file(written(tmp_path, mjcf(chain)), beam)
    assert found.boundary.name == ends
    assert (found.segments, rule in found.remark) == (segments, True)
    assert found.length_mismatch == pytest.approx(1 / share - 1, abs=1e-9)
    # A segment that the ground holds has no mass of the file's own.
    assert found.mass_mismatch == pytest.approx(1 / share - 1, abs=1e-9)
    np.testing.assert_allclose(found.angular_frequency, frequencies(chain), rtol=1e-9)
    due = euler_bernoulli(beam, ends, 3).angular_frequency
    np.testing.assert_allclose(found.errors, frequencies(chain) / due - 1, rtol=1e-8)
    assert ("length is" in found.text) == (share != 1.0)


@pytest.mark.parametrize(("ends", "rule", "share"), in_turns(ENDS, LAYOUTS, [0.8, 1.0, 1.2], every=3))
def test_nothing_depends_on_where_a_chain_stands(ends: str, rule: str, share: float, tmp_path: Path) -> None:
    chain, beam = rods(ends, rule, 5), Beam(share * LENGTH, STIFFNESS, DENSITY)
    audits = [audit_file(written(tmp_path, mjcf(chain, place)), beam) for place in PLACES]
    first = audits[0]
    for found in audits[1:]:
        assert (found.layout, found.segments, found.order) == (first.layout, first.segments, first.order)
        assert (found.remark, found.boundary.name, found.given) == (
            first.remark,
            first.boundary.name,
            first.given,
        )
        np.testing.assert_allclose(found.errors, first.errors, rtol=1e-8)
        numbers = [
            [getattr(each, name) for name in ("length_mismatch", "mass_mismatch", "rotary_inertia_mismatch")]
            for each in (found, first)
        ]
        np.testing.assert_allclose(*numbers, atol=1e-8)


BOX = '<body pos="{at!r} 0 0"><inertial pos="{c!r} 0 0" mass="{m!r}" diaginertia="{j!r} {j!r} {j!r}"/></body>'


@pytest.mark.parametrize("rule", ["naive", "mitiguy", "gregory", "rigid_stub"])
@pytest.mark.parametrize("share", [0.75, 1.0, 1.25])
@pytest.mark.parametrize("mass", [0.05, 0.3, 2.0])
def test_a_box_on_the_tip_is_a_body_and_the_layout_is_known(
    rule: str, share: float, mass: float, tmp_path: Path
) -> None:
    chain, beam = rods("clamped-free", rule, 4), Beam(share * LENGTH, STIFFNESS, DENSITY)
    box = BOX.format(at=0.25, c=0.03, m=mass, j=1e-4 * mass)
    text = mjcf(chain, tip=box)
    found = audit_file(written(tmp_path, text), beam)
    end = found.boundary.right
    assert (found.boundary.left.word, end.on_segment) == ("clamped", True)
    assert [end.mass, end.rotary_inertia, end.offset] == pytest.approx([mass, 1e-4 * mass, 0.03], rel=1e-6)
    assert (found.layout, found.segments) == (rule, 4)
    assert found.length_mismatch == pytest.approx(1 / share - 1, abs=1e-9)
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:3], rtol=1e-9)
    exact = euler_bernoulli(beam, found.boundary, 3).angular_frequency
    np.testing.assert_allclose(found.errors, found.angular_frequency / exact - 1, atol=1e-12)
    if rule == "naive" and share == 1.0:
        same = next(item for item in found.suggestions if item.name == "gregory")
        assert not same.moves_hinges and abs(same.errors[0]) < 0.02 < abs(found.errors[0])
    # The user's word for the same body, with or without the word on the hinge, gives the same errors.
    word = f"clamped-free(mass={mass}, rotary_inertia={1e-4 * mass}, offset=0.03)"
    again = audit_file(tmp_path / "model.xml", beam, word)
    assert (again.layout, again.segments) == (rule, 4)
    np.testing.assert_allclose(again.errors, found.errors, rtol=1e-6)


ROD = {
    "cylinder": '<geom type="cylinder" fromto="0 0 0 .2 0 0" size=".004" mass=".1"/>',
    "lump": '<geom type="cylinder" fromto="0 0 0 .2 0 0" size=".004" mass="0"/>'
    '<geom size=".02" pos=".2 0 0" mass=".1"/>',
    "inertial": '<inertial pos=".1 0 0" mass=".1" diaginertia="1e-6 3.3e-4 3.3e-4"/>',
}
TIPS = {
    "none": "",
    "sphere": '<body pos=".2 0 0"><geom size=".03" mass=".3"/></body>',
    "box": '<body pos=".2 0 0"><geom type="box" size=".04 .02 .02" pos=".04 0 0" mass=".3"/></body>',
    "sphere of the last body": '<geom size=".03" pos=".2 0 0" mass=".3"/>',
}
BASES = {
    "none": "{}",
    "block": '<body><geom type="box" size=".1 .1 .1" pos="-.1 0 0" mass="5"/>{}</body>',
    "half a block": '<body><geom type="box" size=".05 .1 .1" pos="-.05 0 0" mass="5"/>{}</body>',
    "post": '<body><geom type="cylinder" size=".02 .5" pos="0 0 -.5" mass="5"/>{}</body>',
    "wall": '<geom type="box" size=".1 .1 .1" pos="-.1 0 0"/>{}',
}


@pytest.mark.parametrize(
    ("rod", "tip", "base", "start"), in_turns(ROD, TIPS, BASES, ["spring", "stub", "pivot"], every=2)
)
def test_solids_at_either_end_are_told_from_the_beam(
    rod: str, tip: str, base: str, start: str, tmp_path: Path
) -> None:
    """Four segments with what people fix to their ends, beside a beam of 0.6, 1 or 1.4 of their length."""
    if rod == "inertial" and tip.endswith("body"):
        return  # an explicit inertial hides the geometry of its body
    first = {"spring": '<joint axis="0 1 0" stiffness="10"/>', "stub": "", "pivot": '<joint axis="0 1 0"/>'}[
        start
    ]
    text = ""
    for i in (3, 2, 1, 0):
        hinge = first if i == 0 else '<joint axis="0 1 0" stiffness="10"/>'
        text = f'<body pos="{0.2 * (i > 0)} 0 0">{hinge}{ROD[rod]}{TIPS[tip] if i == 3 else ""}{text}</body>'
    path = written(tmp_path, world(BASES[base].format(text)))
    # The lengths take turns, so that each meets every rod, tip, base and start, and every two of them.
    turn = [*ROD].index(rod) + [*TIPS].index(tip) + [*BASES].index(base)
    share = (0.6, 1.0, 1.4)[turn % 3]
    found = audit_file(path, Beam(0.8 * share, STIFFNESS, DENSITY))
    assert found.length_mismatch == pytest.approx(1 / share - 1, abs=1e-6)
    assert found.segments == 4
    assert found.boundary.right.mass == pytest.approx(0.3 * (tip != "none"), abs=1e-9)
    held = {"spring": "first hinge is at the held end", "stub": "first segment is rigid with its parent"}
    assert held.get(start, "hinges are where equal segments meet") in found.remark


ARM = '<body name="arm">{motor}<geom type="cylinder" fromto="-.4 0 0 0 0 0" size=".02" mass="1"/>{{}}</body>'
MOTORS = (
    '<joint name="motor" axis="0 1 0"/>',
    '<joint name="motor" axis="0 0 1"/>',
    '<joint name="motor" type="slide" axis="1 0 0"/>',
    '<joint name="motor" type="ball"/>',
)


@pytest.mark.parametrize(
    ("motor", "rule", "segments"), in_turns(MOTORS, ["naive", "half_stub"], [2, 4, 6], every=2)
)
def test_a_hinge_without_spring_is_the_pinned_end_behind_an_arm_as_on_the_ground(
    motor: str, rule: str, segments: int, tmp_path: Path
) -> None:
    chain, beam = rods("pinned-free", rule, segments), Beam(LENGTH, STIFFNESS, DENSITY)
    ground = written(tmp_path, mjcf(chain), "ground.xml")
    behind = written(tmp_path, mjcf(chain, carrier=ARM.format(motor=motor)), "arm.xml")
    for path in (ground, behind):
        found = audit_file(path, beam)
        assert found.boundary.name == "pinned-free"
        due = frequencies(chain)
        np.testing.assert_allclose(found.angular_frequency[: len(due)], due, rtol=1e-9)
        # Both readings are shown.
        (other,) = found.other_readings
        assert "pivot held" in other and "clamped-free" in other
        said = audit_file(path, beam, "pinned-free")
        np.testing.assert_allclose(said.errors, found.errors, rtol=1e-12)
        held = audit_file(path, beam, "clamped-free")
        assert any("pivot held, because you say so" in line for line in held.assumed)
        rigid = Chain.from_pieces(
            **{
                name: getattr(chain, name) for name in ("length", "mass", "rotary_inertia", "joint_stiffness")
            },
            boundary="clamped-free",
        )
        due = frequencies(rigid)
        np.testing.assert_allclose(held.angular_frequency[: len(due)], due, rtol=1e-9)
        assert held.layout == ("half_stub" if rule == "half_stub" else "rigid_stub")
    assert any("body arm, which carries it and moves, is taken as held" in line for line in found.assumed)
    assert found.text.index("assumed: ") < found.text.index("pinned-free chain")


@pytest.mark.parametrize("segments", [3, 5])
def test_a_motor_under_a_urdf_chain_is_held_by_the_users_word(segments: int, tmp_path: Path) -> None:
    chain, beam = rods("pinned-free", "naive", segments), Beam(LENGTH, STIFFNESS, DENSITY)
    path, _ = export_chain(chain, tmp_path / "arm.urdf")
    free, held = audit_file(path, beam), audit_file(path, beam, "clamped-free")
    due = frequencies(chain)
    np.testing.assert_allclose(free.angular_frequency[: len(due)], due, rtol=1e-9)
    assert (free.boundary.name, held.boundary.name, held.layout) == (
        "pinned-free",
        "clamped-free",
        "rigid_stub",
    )


@pytest.mark.parametrize("motor", MOTORS)
@pytest.mark.parametrize("segments", [2, 5])
def test_an_arm_of_any_joint_is_held_by_the_users_word(motor: str, segments: int, tmp_path: Path) -> None:
    chain, beam = rods("clamped-free", "naive", segments), Beam(LENGTH, STIFFNESS, DENSITY)
    path = written(tmp_path, mjcf(chain, carrier=ARM.format(motor=motor)))
    found = audit_file(path, beam, "clamped-free")
    due = frequencies(chain)
    np.testing.assert_allclose(found.angular_frequency[: len(due)], due, rtol=1e-9)
    assert found.layout == "naive"
    # Turning about z or sliding along the chain does not move it across.
    across = "ball" in motor or 'axis="0 1 0"' in motor
    assert not across or any("motor held, because you say so" in line for line in found.assumed)


LINK = '<geom type="cylinder" fromto="0 0 0 .2 0 0" size=".005" mass=".1"/>'


def elbowed(count: int, elbow: int) -> str:
    """Rods of 0.2 m on springs of 10 N m/rad, but a motor at the root and an elbow without a spring."""
    text = ""
    for i in reversed(range(count)):
        spring = "" if i in (0, elbow) else 'stiffness="10"'
        name = {0: "shoulder", elbow: "elbow"}.get(i, f"bend{i}")
        text = (
            f'<body name="link{i}" pos="{0.2 * (i > 0)} 0 0"><joint name="{name}" axis="0 1 0" {spring}/>'
            f"{LINK}{text}</body>"
        )
    return world(text)


@pytest.mark.parametrize(("count", "elbow"), [(6, 3), (7, 3), (7, 4), (5, 2)])
def test_an_elbow_without_spring_is_asked_for_and_held_by_the_users_word(
    count: int, elbow: int, tmp_path: Path
) -> None:
    path, beam = written(tmp_path, elbowed(count, elbow)), Beam(0.2 * count, STIFFNESS, DENSITY)
    with pytest.raises(ValueError, match=r"elbow.*say by boundary"):
        audit_file(path, beam)
    held = audit_file(path, beam, "clamped-free")
    # Truth: the pieces at both sides of the elbow are one rod of twice the length, the first one stands.
    length = np.full(count, 0.2)
    length[elbow - 1] = 0.4
    length = np.delete(length, elbow)
    mass = DENSITY * length
    section = DENSITY * 0.005**2 / 4
    chain = Chain.from_pieces(
        length=length,
        mass=mass,
        rotary_inertia=mass * length**2 / 12 + section * length,
        joint_stiffness=np.full(count - 2, 10.0),
        boundary="clamped-free",
    )
    np.testing.assert_allclose(held.angular_frequency, frequencies(chain), rtol=1e-9)
    assert any("elbow held, because you say so" in line for line in held.assumed)
    # The outer link alone, its elbow held.
    beyond = audit_file(
        path, Beam(0.2 * (count - elbow), STIFFNESS, DENSITY), "clamped-free", chain=f"link{elbow + 1}"
    )
    assert len(beyond.joint_stiffness) == count - elbow - 1


@pytest.mark.parametrize("segments", [3, 5])
def test_behind_an_arm_on_a_spring_the_length_says_that_the_arm_is_no_part_of_the_beam(
    segments: int, tmp_path: Path
) -> None:
    chain, beam = rods("pinned-free", "naive", segments), Beam(LENGTH, STIFFNESS, DENSITY)
    arm = ARM.format(motor='<joint name="motor" axis="0 1 0" stiffness="500"/>')
    found = audit_file(written(tmp_path, mjcf(chain, carrier=arm)), beam, "pinned-free")
    due = frequencies(chain)
    np.testing.assert_allclose(found.angular_frequency[: len(due)], due, rtol=1e-9)
    assert found.length_mismatch == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("start", ["spring", "stub", "pivot"])
@pytest.mark.parametrize("mass", [0.02, 0.1, 0.15, 3.0])
@pytest.mark.parametrize("apart", [True, False])
def test_of_one_hinge_alone_the_tips_body_is_told_from_the_rod(
    start: str, mass: float, apart: bool, tmp_path: Path
) -> None:
    ball = f'<geom size=".03" pos=".2 0 0" mass="{mass}"/>'
    tip = f'{LINK}<body name="tip">{ball}</body>' if apart else f"{LINK}{ball}"
    place = 0.0 if start == "spring" else 0.2
    text = f'<body name="b" pos="{place} 0 0"><joint axis="0 1 0" stiffness="10"/>{tip}</body>'
    root = {"spring": "", "stub": "", "pivot": '<joint axis="0 1 0"/>'}[start]
    if start != "spring":
        text = f'<body name="a">{root}{LINK}{text}</body>'
    path, count = written(tmp_path, world(text)), 1 if start == "spring" else 2
    found = audit_file(path, Beam(0.2 * count, STIFFNESS, DENSITY))
    end = found.boundary.right
    assert (found.segments, found.mass_mismatch) == (count, pytest.approx(0, abs=1e-9))
    assert end.mass == pytest.approx(mass, rel=1e-8)
    # A ball has 2 m r²/5.
    assert end.rotary_inertia == pytest.approx(0.4 * mass * 0.03**2, rel=1e-6)
    assert found.layout != "no known layout"


TWO = '<body name="hub">{}<geom type="box" size=".05 .05 .05" mass=".2"/>{}{}</body>'
HUBS = {
    "<freejoint/>": "body hub.*is free in space.*say by boundary",
    '<joint name="spin" axis="0 1 0"/>': "body hub.*moves on joint spin.*say by boundary",
    '<joint name="spin" axis="0 1 0" stiffness="3"/>': "body hub.*moves on joint spin.*say by boundary",
    '<joint name="rail" type="slide" axis="0 0 1"/>': "body hub.*moves on joint rail.*say by boundary",
}


@pytest.mark.parametrize("joint", HUBS)
@pytest.mark.parametrize("segments", [3, 5])
def test_a_hub_with_two_chains_that_moves_asks_for_the_end(joint: str, segments: int, tmp_path: Path) -> None:
    chain, beam = rods("clamped-free", "naive", segments), Beam(LENGTH, STIFFNESS, DENSITY)
    arms = [
        re.sub(
            r'(name="[sj])', rf"\1{side}", re.search(r"<worldbody>(.*)</worldbody>", mjcf(chain, place))[1]
        )  # type: ignore[index]
        for side, place in (("r", Placed('pos="0.05 0 0"')), ("l", Placed('pos="-0.05 0 0"', -1.0)))
    ]
    path = written(tmp_path, world(TWO.format(joint, *arms)))
    with pytest.raises(ValueError, match=HUBS[joint]):
        audit_file(path, beam)
    for name in ("sr1", "sl1"):
        found = audit_file(path, beam, "clamped-free", chain=name)
        np.testing.assert_allclose(found.angular_frequency, frequencies(chain), rtol=1e-9)
        assert any("hub" in line and "held" in line for line in found.assumed)


@pytest.mark.parametrize("ends", ["clamped-free", "pinned-free"])
@pytest.mark.parametrize("rule", ["naive", "half_stub", "gregory"])
@pytest.mark.parametrize("factor", [0.1, 0.5, 1.5, 50.0, 200.0])
def test_another_rotary_inertia_is_blamed_before_springs(
    ends: str, rule: str, factor: float, tmp_path: Path
) -> None:
    chain, beam = rods(ends, rule, 5), Beam(LENGTH, STIFFNESS, DENSITY)
    text = mjcf(chain, inertia=factor)
    found = audit_file(written(tmp_path, text), beam)
    assert found.boundary.name == ends
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:3], rtol=1e-9)
    assert found.rotary_inertia_mismatch == pytest.approx(factor - 1, rel=1e-6)
    assert found.text.index("rotary inertia") < found.text.index(found.remark)
    # What the springs alone make of it is the rule's own error.
    due = euler_bernoulli(beam, ends, 3).angular_frequency
    np.testing.assert_allclose(found.errors_with_rods, frequencies(chain) / due - 1, rtol=1e-7)
    for item in found.suggestions:
        assert abs(item.errors[0]) < abs(found.errors[0])


@pytest.mark.parametrize("part", [0.0, 0.25, 0.8, 1.0])
def test_centres_of_mass_off_the_middle_are_blamed_before_springs(part: float, tmp_path: Path) -> None:
    ell, mass, about = 0.2, 0.1, 0.1 * 0.2**2 / 12
    body = f'<inertial pos="{part * ell!r} 0 0" mass="{mass}" diaginertia="{about!r} {about!r} {about!r}"/>'
    text = ""
    for i in range(4, -1, -1):
        hinge = f'<joint axis="0 1 0" stiffness="{10 * (1 + (i == 0))}"/>'
        text = f'<body pos="{ell * (i > 0)} 0 0">{hinge}{body}{text}</body>'
    for share in (0.8, 1.0):
        found = audit_file(written(tmp_path, world(text)), Beam(share, STIFFNESS, DENSITY))
        assert (found.boundary.name, found.segments) == ("clamped-free", 5)
        assert found.centre_mismatch == pytest.approx(abs(part - 0.5), abs=1e-9)
        assert found.text.index("centres of mass") < found.text.index(found.remark)
        np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(world(text))[:3], rtol=1e-9)


@pytest.mark.parametrize("segments", [2, 4])
@pytest.mark.parametrize("turn", ["", 'quat="0.3 -0.2 0.9 0.1"'])
def test_masses_at_their_own_hinges_are_judged_behind_a_pinned_end(
    segments: int, turn: str, tmp_path: Path
) -> None:
    """The only hinge with a spring passes through its body's centre of mass; the pinned end says the line."""
    body, text = '<inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 2e-3 2e-3"/>', ""
    for i in range(segments - 1, -1, -1):
        spring = 'stiffness="10"' if i else ""
        place = f'pos="{0.2 * (i > 0)} 0 0" {"" if i else turn}'
        text = f'<body {place}><joint axis="0 1 0" {spring}/>{body}{text}</body>'
    found = audit_file(written(tmp_path, world(text)), Beam(0.2 * segments, STIFFNESS, DENSITY))
    assert (found.boundary.name, found.segments) == ("pinned-free", segments)
    due = mujoco_frequencies(world(text))[:3]
    np.testing.assert_allclose(found.angular_frequency[: len(due)], due, rtol=1e-9)
    assert found.centre_mismatch == pytest.approx(0.5, abs=1e-9)
    assert "centres of mass" in found.text and "rotary inertia" in found.text


@pytest.mark.parametrize("radius", [1e-3, 3e-3, 8e-3, 3e-2])
@pytest.mark.parametrize("rule", ["half_stub", "mitiguy", "half_stub_corrected"])
@pytest.mark.parametrize("ends", ["pinned-free", "clamped-free"])
def test_one_family_has_one_order(radius: float, rule: str, ends: str) -> None:
    """Round rods of one radius: the section's share of a piece's inertia grows with N, the order does not."""
    orders = set()
    for segments in (3, 5, 10, 20, 40):
        chain = rods(ends, rule, segments)
        pieces = {name: getattr(chain, name) for name in ("length", "mass", "joint_stiffness")}
        thick = chain.rotary_inertia + chain.mass * radius**2 / 4
        found = audit_chain(Beam(LENGTH, STIFFNESS, DENSITY), ends, **pieces, rotary_inertia=thick)
        orders.add(found.order)
    assert orders == {RULES[rule].declared_order(rods(ends, rule, 3).boundary)}


def matrices(chain: Chain) -> tuple[Array, Array, Array]:
    model = linearize(chain)
    return model.mass_matrix, model.stiffness_matrix, model.joint_rotations


@pytest.mark.parametrize("rule", ["naive", "rigid_stub"])
@pytest.mark.parametrize("armature", [1e-6, 2e-4, 1e-2])
def test_armature_is_inertia_of_the_relative_angle(rule: str, armature: float, tmp_path: Path) -> None:
    chain, beam = rods("clamped-free", rule, 6), Beam(LENGTH, STIFFNESS, DENSITY)
    text = mjcf(chain, armature=repr(armature))
    found = audit_file(written(tmp_path, text), beam)
    mass, stiffness, turns = matrices(chain)
    square = scipy.linalg.eigh(stiffness, mass + armature * turns.T @ turns, eigvals_only=True)
    np.testing.assert_allclose(found.angular_frequency, np.sqrt(square[:3]), rtol=1e-9)
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:3], rtol=1e-9)
    due = euler_bernoulli(beam, "clamped-free", 3).angular_frequency
    np.testing.assert_allclose(found.errors_without_armature, frequencies(chain) / due - 1, rtol=1e-9)
    assert "armature of its hinges" in found.text


def test_what_armature_costs_a_thin_rod(tmp_path: Path) -> None:
    """Copied from cable examples, 0.001 kg m² lowers modes 2 and 3 of a thin rod by 57 and 83 %."""
    chain = Chain(Beam(1.0, 1.2566e-4, 0.00665), "clamped-free", 19, "rigid_stub")
    text = mjcf(chain, armature="0.001")
    found = audit_file(written(tmp_path, text), Beam(1.0, 1.2566e-4, 0.00665))
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:3], rtol=1e-9)
    costs = (1 + found.errors) / (1 + found.errors_without_armature) - 1
    np.testing.assert_allclose(costs, [-0.05, -0.565, -0.83], atol=5e-3)
    assert f"{100 * costs[1]:.3g} %" in found.text


@pytest.mark.parametrize("damping", [1e-3, 0.05, 8.0])
@pytest.mark.parametrize("armature", [0.0, 2e-4])
@pytest.mark.parametrize("option", ["", 'integrator="RK4"', 'integrator="implicitfast"'])
def test_dampers_give_ratios_and_the_files_step_a_limit(
    damping: float, armature: float, option: str, tmp_path: Path
) -> None:
    """Ratios by eigenvalues of assembled matrices; the limit by those of one step, written out here."""
    chain = rods("clamped-free", "double_wall", 5)
    text = mjcf(chain, armature=repr(armature), damping=repr(damping)).replace(
        'gravity="0 0 0"', f'gravity="0 0 0" {option}'
    )
    found = audit_file(written(tmp_path, text), Beam(LENGTH, STIFFNESS, DENSITY))
    mass, stiffness, turns = matrices(chain)
    mass, drag = mass + armature * turns.T @ turns, damping * turns.T @ turns
    size = len(mass)
    one = np.linalg.solve(mass, np.hstack([stiffness, drag]))
    flow = np.block([[np.zeros((size, size)), np.eye(size)], [-one]])
    values = np.linalg.eigvals(flow)
    swinging = np.sort_complex(values[values.imag > 1e-9 * abs(values)])
    ratios = found.damping_ratio[found.damping_ratio < 1]
    due = sorted(zip(abs(swinging), -swinging.real / abs(swinging), strict=True))
    np.testing.assert_allclose(ratios, [ratio for _, ratio in due][: len(ratios)], rtol=1e-6)
    assert found.swings == tuple((found.damping_ratio < 1).tolist())
    assert ("does not swing" in found.text) == (not all(found.swings))
    if damping == 8.0:
        # Five real pairs, the slowest with the fastest: (s + f)/(2 √(s f)) of the innermost three.
        lone = np.sort(-values.real)
        if not len(swinging):
            pairs = (lone[:size] + lone[: size - 1 : -1]) / (2 * np.sqrt(lone[:size] * lone[: size - 1 : -1]))
            np.testing.assert_allclose(found.damping_ratio, pairs[::-1][:3], rtol=1e-5)

    def grows(h: float) -> bool:
        if "RK4" in option:
            z = h * values
            return bool((abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) > 1 + 1e-9).any())
        # v' = v - h (M + h D)⁻¹ (K q + D v),  q' = q + h v'
        kick = h * np.linalg.solve(mass + h * drag, np.hstack([stiffness, drag]))
        turned = np.hstack([-kick[:, :size], np.eye(size) - kick[:, size:]])
        drift = np.hstack([np.eye(size), np.zeros((size, size))]) + h * turned
        return bool((abs(np.linalg.eigvals(np.vstack([drift, turned]))) > 1 + 1e-7).any())

    assert found.step is not None
    assert not grows(0.99 * found.step.limit)
    assert grows(1.01 * found.step.limit)
    assert found.step.timestep == 0.002
    assert ("NOT STABLE" in found.text) == (found.step.limit <= 0.002)


def test_a_hanging_chain_needs_a_shorter_step(tmp_path: Path) -> None:
    """A rope of 26 g/m under a load of 0.75 kg: the step that is stable without weight is not with it."""
    chain = Chain(Beam(4.0, 1e-3, 0.026), "clamped-free", 20, "mitiguy")
    tip = BOX.format(at=0.2, c=0.0, m=0.75, j=1e-3)
    limits = []
    for gravity in ("0 0 0", "9.81 0 0", "0 0 -9.81"):
        text = mjcf(chain, tip=tip).replace('gravity="0 0 0"', f'gravity="{gravity}"')
        found = audit_file(written(tmp_path, text), Beam(4.0, 1e-3, 0.026))
        assert found.step is not None
        limits.append(found.step.limit)
        assert found.step.with_weight == (gravity != "0 0 0")
    assert limits[1] < 0.5 * limits[0]
    # Across the chain the answer is a bound, by the pull that it could have.
    assert limits[2] <= limits[1] * (1 + 1e-9)


@pytest.mark.parametrize(("gear", "kv"), [("1", 0.01), ("3", 0.02)])
def test_a_servo_of_velocity_is_a_damper(gear: str, kv: float, tmp_path: Path) -> None:
    chain, beam = rods("clamped-free", "naive", 5), Beam(LENGTH, STIFFNESS, DENSITY)
    plain = mjcf(chain).replace(
        ' stiffness="10.0"/>', f' stiffness="10.0" damping="{kv * float(gear) ** 2!r}"/>', 1
    )
    bodies = plain.replace(f' damping="{kv * float(gear) ** 2!r}"', "")
    servos = (
        f'<velocity joint="j1" kv="{kv}" gear="{gear}"/>',
        f'<general joint="j1" gear="{gear}" biastype="affine" biasprm="0 0 {-kv}"/>',
    )
    due = audit_file(written(tmp_path, plain), beam)
    assert 0 < due.damping_ratio[0] < 1
    for servo in servos:
        text = bodies.replace("</worldbody>", f"</worldbody><actuator>{servo}</actuator>")
        found = audit_file(written(tmp_path, text), beam)
        np.testing.assert_allclose(found.damping_ratio, due.damping_ratio, rtol=1e-9)
        np.testing.assert_allclose(found.errors, due.errors, rtol=1e-12)
    position = servos[1].replace("0 0 -", "0 -1 -")
    with pytest.raises(ValueError, match="must not act on a hinge of the chain, like a spring"):
        audit_file(
            written(tmp_path, bodies.replace("</worldbody>", f"</worldbody><actuator>{position}</actuator>")),
            beam,
        )


YAW = '<body name="mast"><joint name="yaw" axis="{}" pos="{}"{}/><geom size=".03" mass=".2"/>{{}}</body>'


@pytest.mark.parametrize(
    ("axis", "place", "more", "message"),
    [
        ("0 1 1", "0 0 0", "", "oblique"),
        ("1 1 0", "0 0 0", "", "oblique"),
        ("1 0 0", "0 0.3 0", "", "beside it, it moves the whole chain across"),
        ("0 0 1", "0 0 0", ' stiffness="3"', "yaw must be parallel"),
    ],
)
def test_a_root_hinge_that_is_not_parallel_is_not_passed_over(
    axis: str, place: str, more: str, message: str, tmp_path: Path
) -> None:
    chain, beam = rods("clamped-free", "naive", 5), Beam(LENGTH, STIFFNESS, DENSITY)
    text = mjcf(chain, carrier=YAW.format(axis, place, more))
    with pytest.raises(ValueError, match=message):
        audit_file(written(tmp_path, text), beam)


def test_a_yaw_that_leaves_the_plane_alone_is_said_to_be_at_rest(tmp_path: Path) -> None:
    chain, beam = rods("clamped-free", "naive", 5), Beam(LENGTH, STIFFNESS, DENSITY)
    text = mjcf(chain, carrier=YAW.format("0 0 1", "0 0 0", ""))
    found = audit_file(written(tmp_path, text), beam)
    np.testing.assert_allclose(found.angular_frequency, frequencies(chain), rtol=1e-9)
    assert any(
        "joint yaw, which turns the chain out of its plane, is taken as at rest" in a for a in found.assumed
    )
    known = mujoco_frequencies(text)
    np.testing.assert_allclose(known[:3], found.angular_frequency, rtol=1e-9)


# --- Tables of pieces -------------------------------------------------------------------------------------


def table(tmp_path: Path) -> tuple[Path, list[str]]:
    (path,) = export_chain(rods("clamped-free", "mitiguy", 8), tmp_path / "chain.csv")
    return path, path.read_text().splitlines(keepends=True)


@pytest.mark.parametrize("lost", range(1, 8))
def test_a_table_that_is_cut_short_is_refused(lost: int, tmp_path: Path) -> None:
    path, lines = table(tmp_path)
    path.write_text("".join(lines[:-lost]))
    with pytest.raises(ValueError, match="must be empty in the last row and in no other"):
        read_chain_csv(path)
    with pytest.raises(ValueError, match=r"chain\.csv: line \d+: hinge_to_next"):
        audit_file(path, Beam(LENGTH, STIFFNESS, DENSITY))


@given(st.permutations(range(9)))
@settings(max_examples=25)
def test_a_table_in_another_order_is_refused(
    tmp_path_factory: pytest.TempPathFactory, order: list[int]
) -> None:
    path, lines = table(tmp_path_factory.mktemp("rows"))
    head, rows = lines[:-9], lines[-9:]
    path.write_text("".join([*head, *(rows[i] for i in order)]))
    if order == list(range(9)):
        assert read_chain_csv(path).pieces == 9
    else:
        with pytest.raises(ValueError, match="piece must be"):
            read_chain_csv(path)


def replaced(row: int, column: int, text: str) -> Any:
    def change(lines: list[str]) -> str:
        cells = lines[-9 + row].rstrip("\n").split(",")
        cells[column] = text
        return "".join([*lines[: -9 + row], ",".join(cells) + "\n", *lines[len(lines) - 8 + row :]])

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (replaced(3, 2, "1e280"), r"mass_kg must be 0 or from 1e-100 to 1e\+30"),
        (replaced(3, 1, "1e-200"), "length_m must be 0 or from 1e-100"),
        (replaced(3, 2, "1" * 20_000), "must have at most 10000 characters"),
        (lambda lines: "".join(lines) + "\n" * 150_000, "must have at most 100100 lines"),
        (lambda lines: "".join(lines) + " " * (2**24 + 1), "must have at most 16 MiB"),
        (replaced(3, 2, "1e30"), "beam must be in the units of the chain"),
    ],
)
def test_tables_are_bounded(change: Any, message: str, tmp_path: Path) -> None:
    path, lines = table(tmp_path)
    path.write_text(change(lines))
    with pytest.raises(ValueError, match=message):
        audit_file(path, Beam(LENGTH, STIFFNESS, DENSITY))


def test_given_assumed_and_found_stand_apart(tmp_path: Path) -> None:
    found: Audit = audit_file(
        written(tmp_path, mjcf(rods("pinned-free", "naive", 5), carrier=ARM.format(motor=MOTORS[0]))),
        Beam(LENGTH, STIFFNESS, DENSITY),
    )
    sections = (found.given, found.assumed, found.found)
    assert (
        all(sections)
        and not set(found.given) & set(found.assumed)
        and not set(found.assumed) & set(found.found)
    )
    lines = found.text.splitlines()
    kinds = [line.split(":")[0] if line.startswith(("given: ", "assumed: ")) else "found" for line in lines]
    assert kinds == sorted(kinds, key=("given", "assumed", "found").index)
    assert math.isclose(found.length_mismatch, 0.0, abs_tol=1e-12)


@pytest.mark.parametrize("more", ["", "twist", "slide", "twist slide"])
def test_twist_and_stretch_beside_bending_are_left_out(more: str, tmp_path: Path) -> None:
    count, ell = 10, 0.1
    text = ""
    for i in range(count):
        extra = f'<joint name="t{i}" type="hinge" axis="1 0 0" stiffness="1e-6"/>' * ("twist" in more)
        extra += f'<joint name="s{i}" type="slide" axis="1 0 0" stiffness="1e5"/>' * ("slide" in more)
        text += (
            f'<body name="b{i}" pos="{ell * (i > 0)} 0 0"><joint name="y{i}" type="hinge" axis="0 -1 0" '
            f'stiffness="{20 if i == 0 else 10}"/>{extra}<geom type="cylinder" '
            f'fromto="0 0 0 {ell} 0 0" size="0.0005" mass="{ell}"/>'
        )
    path, model = tmp_path / "rod.xml", world(text + "</body>" * count)
    path.write_text(model, encoding="utf-8")
    found = audit_file(path, Beam.unit(), modes=1)
    # MuJoCo's own mass and stiffness, whatever joints there are beside.
    exact, omega = 1.8751040687119611**2, mujoco_frequencies(model)
    bending = omega[np.argmin(np.abs(omega - exact))]
    assert found.errors[0] == pytest.approx(bending / exact - 1, abs=1e-6)
    assert found.errors[0] == pytest.approx(-0.0045675, abs=1e-6)
    said = " ".join(found.assumed)
    assert ("slides along the chain (s0, s1" in said) is ("slide" in more)
    assert ("t0, t1" in said) is ("twist" in more)
