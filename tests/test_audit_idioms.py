"""One chain in the words of many files: what changes nothing changes nothing, what cannot be read is named.

Every file here is the same five rods, so that the truth is one chain, made without any reader.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from beammodes.auditing.audit_model import audit_file
from beammodes.chains.chain import Chain
from beammodes.problem.beam import Beam
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

COUNT, ELL, MASS, SPRING = 5, 0.2, 0.1, 10.0
ABOUT = MASS * ELL**2 / 12
BEAM = Beam(COUNT * ELL, SPRING * ELL, MASS / ELL)


def truth(ends: str, *, inertia: float = ABOUT, springs: int = COUNT) -> list[float]:
    """Frequencies of the five rods [Hz], on a spring at the held end or on none."""
    chain = Chain.from_pieces(
        length=[0.0] * (springs == COUNT) + [ELL] * COUNT,
        mass=[0.0] * (springs == COUNT) + [MASS] * COUNT,
        rotary_inertia=[0.0] * (springs == COUNT) + [inertia] * COUNT,
        joint_stiffness=[SPRING] * springs,
        boundary=ends,
    )
    return (solve_modes(linearize(chain), 3).angular_frequency / (2 * math.pi)).tolist()


INERTIAL = f'<inertial pos="{ELL / 2} 0 0" mass="{MASS}" diaginertia="1e-6 {ABOUT!r} {ABOUT!r}"/>'


def mjcf(first: str = f'stiffness="{SPRING}"', tail: str = "", head: str = "", root: str = "{}") -> str:
    """The rods as nested bodies, the first on a hinge with these attributes."""
    text = ""
    for i in reversed(range(COUNT)):
        own = first if i == 0 else f'stiffness="{SPRING}"'
        text = (
            f'<body name="s{i}" pos="{ELL * (i > 0)} 0 0"><joint name="j{i}" axis="0 1 0" {own}/>'
            f"{INERTIAL}{text}</body>"
        )
    world = f"<worldbody>{root.format(text)}</worldbody>"
    return f'<mujoco>{head}<option gravity="0 0 0"/>{world}{tail}</mujoco>'


def urdf(more: str = "", kind: str = "revolute", about: float = ABOUT) -> str:
    """The rods as URDF; `more` is said of every joint."""
    text = '<link name="world"/>'
    for i in range(COUNT):
        text += (
            f'<link name="s{i}"><inertial><origin xyz="{ELL / 2} 0 0"/><mass value="{MASS}"/>'
            f'<inertia ixx="0" iyy="{about!r}" izz="{about!r}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{i}" type="{kind}"><parent link="{f"s{i - 1}" if i else "world"}"/>'
            f'<child link="s{i}"/><origin xyz="{ELL * (i > 0)} 0 0"/><axis xyz="0 1 0"/>{more}</joint>'
            f'<gazebo reference="j{i}"><springStiffness>{SPRING}</springStiffness></gazebo>'
        )
    return f'<robot name="arm">{text}</robot>'


SDF_INERTIAL = (
    f"<inertial><pose>{ELL / 2} 0 0 0 0 0</pose><mass>{MASS}</mass><inertia><ixx>1e-6</ixx>"
    f"<iyy>{ABOUT!r}</iyy><izz>{ABOUT!r}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
)


def rods(link: str, parent: str = "s{j}", pose: str = "", axis: str = "0 1 0", first: int = 0) -> str:
    """The rods as links of SDFormat; of link `i` the one before is `j`, and `x` is its place."""
    text = ""
    for i in range(first, COUNT):
        names = {"i": i, "j": i - 1, "x": ELL * i}
        ground = "world" if i == 0 else parent.format(**names)
        text += (
            f'<link name="s{i}">{link.format(**names) if i else ""}{SDF_INERTIAL}</link>'
            f'<joint name="j{i}" type="revolute">{pose.format(**names) if i else ""}<parent>{ground}</parent>'
            f"<child>s{i}</child><axis><xyz>{axis}</xyz><dynamics><spring_stiffness>{SPRING}"
            "</spring_stiffness></dynamics></axis></joint>"
        )
    return text


def sdf(models: str, version: str = "1.9") -> str:
    return f'<sdf version="{version}"><world name="w"><gravity>0 0 0</gravity>{models}</world></sdf>'


PLAIN = rods("<pose>{x} 0 0 0 0 0</pose>")
BOOM = f'<model name="boom">{PLAIN}</model>'
SOFT = '<model name="soft">' + rods("<pose>{x} 0 0 0 0 0</pose>").split('<link name="s3">')[0] + "</model>"
ENDS = "".join(
    f'<frame name="end{i}" attached_to="s{i}"><pose>{ELL} 0 0 0 0 0</pose></frame>' for i in range(COUNT)
)
AT_ENDS = rods('<pose relative_to="end{j}"/>', parent="end{j}")
#: The first two rods in the outer model, the others in one that stands in it, joined across.
NESTED = (
    '<model name="outer"><pose>1 2 3 0.1 0.2 0.3</pose>'
    + rods("<pose>{x} 0 0 0 0 0</pose>").split('<link name="s2">')[0]
    + '<model name="inner" placement_frame="s3"><pose relative_to="s1">0.4 0 0 0 0 0</pose>'
    + re.sub(r"(.*?)<joint.*?</joint>", r"\1", rods("<pose>{x} 0 0 0 0 0</pose>", first=2), count=1)
    + '</model><joint name="j2" type="revolute"><parent>s1</parent><child>inner::s2</child><axis>'
    + f"<xyz>0 1 0</xyz><dynamics><spring_stiffness>{SPRING}</spring_stiffness></dynamics></axis>"
    + "</joint></model>"
)

LIMIT = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'
TIE = '<tendon><fixed name="t" {}><joint joint="j1" coef="1"/><joint joint="j2" coef="1"/></fixed></tendon>'

#: Name: content, ending, and what the audit must say.
ALIKE: dict[str, tuple[str, str, str]] = {
    "a mark of UTF-8 and blanks": ("\ufeff\n<?xml version='1.0'?>" + mjcf(), ".xml", ""),
    "a motor that an equality holds": (
        mjcf(tail='<equality><joint joint1="elbow"/></equality>').replace(
            '<joint name="j2"', '<joint name="elbow" axis="0 0 1"/><joint name="j2"'
        ),
        ".xml",
        "joint elbow is held by line 1: <joint>",
    ),
    "a damper on a tendon": (
        mjcf(tail=TIE.format("") + '<actuator><velocity tendon="t" kv="0.1"/></actuator>'),
        ".xml",
        "damping of tendon t is left out",
    ),
    "a tendon at rest within its range": (mjcf(tail=TIE.format('range="-1 1"')), ".xml", ""),
    "limits of the largest double": (urdf(LIMIT.format("-1.79769e+308", "1e308")), ".urdf", ""),
    "poses by quaternions": (
        sdf(
            '<model name="m">'
            + rods('<pose relative_to="s{j}" rotation_format="quat_xyzw">0.2 0 0 0 0.6 0 0.8</pose>').replace(
                "0 0.6 0 0.8", "0 0 0 2"
            )
            + "</model>"
        ),
        ".sdf",
        "",
    ),
    "frames as parents": (
        sdf(f'<model name="m">{ENDS}{AT_ENDS}</model>'),
        ".sdf",
        "",
    ),
    "a model in a model, joined across": (sdf(NESTED), ".sdf", ""),
    "a model that another holds": (
        sdf(f'<model name="table"><pose>0 0 1 0 0 2</pose><link name="top"/>{BOOM}</model>'),
        ".sdf",
        "",
    ),
    "after a model with fewer springs": (sdf(SOFT + BOOM), ".sdf", "other chains in the file: soft::s0"),
    "limits without end": (urdf(LIMIT.format("-inf", "inf")), ".urdf", ""),
}


def noded(joints: str, link: str = "") -> str:
    """The rods with these joints at every node, each on a body that has what `link` says."""
    text = ""
    for i in reversed(range(COUNT)):
        rod = f'<body name="s{i}">{joints.format(i=i)}{INERTIAL}{text}</body>'
        text = f'<body name="c{i}" pos="{ELL * (i > 0)} 0 0">{link.format(i=i)}{rod}</body>'
    return f'<mujoco><option gravity="0 0 0"/><worldbody>{text}</worldbody></mujoco>'


BEND = f'<joint name="j{{i}}" axis="0 1 0" stiffness="{SPRING}"/>'
TRACE = '<inertial pos="0 0 0" mass="1e-10" diaginertia="1e-13 1e-13 1e-13"/>'
STRETCH = f'<joint name="p{{i}}" type="slide" axis="1 0 0" stiffness="1e5"/>{TRACE}'
ALIKE |= {
    "slides on links of their own": (
        noded(BEND, STRETCH),
        ".xml",
        "slides along the chain (p1, p2, p3, p4) ",
    ),
    "twist that nothing holds": (
        noded(BEND + '<joint name="t{i}" axis="1 0 0"/>'),
        ".xml",
        "hinges without a spring about other axes (t0, t1, t2, t3, t4) are taken as at rest",
    ),
    "hinges by turns about two axes": (
        noded(f'<joint name="z{{i}}" axis="0 0 1" stiffness="{2 * SPRING}"/>', BEND + TRACE),
        ".xml",
        "there are hinges for z, y",
    ),
}


@pytest.mark.parametrize("case", ALIKE)
def test_the_same_chain_in_other_words(case: str, tmp_path: Path) -> None:
    text, ending, says = ALIKE[case]
    path = tmp_path / f"model{ending}"
    path.write_text(text)
    found = audit_file(path, BEAM)
    assert (found.boundary.name, found.layout, found.segments) == ("clamped-free", "naive", COUNT)
    np.testing.assert_allclose(found.angular_frequency / (2 * math.pi), truth("clamped-free"), rtol=1e-9)
    np.testing.assert_allclose([found.length_mismatch, found.mass_mismatch], 0, atol=1e-9)
    assert says in found.text


SPATIAL = '<tendon><spatial name="t" {}><site site="a"/><site site="b"/></spatial></tendon>'
SITES = mjcf(tail=SPATIAL.format('limited="true" range="0 0.2"')).replace(
    INERTIAL, f'{INERTIAL}<site name="@"/>'
)

REFUSED: dict[str, tuple[str, str]] = {
    "a tendon at its stop": (mjcf(tail=TIE.format('range="0 1"')), "fixed name='t'.*within its range"),
    "a spatial tendon with a limit": (
        SITES.replace("@", "a", 1).replace("@", "b", 1).replace("@", ""),
        "spatial name='t'.*a limit of its length",
    ),
    "an include that is not there": (
        mjcf(head='<include file="missing.xml"/>'),
        "<include>.*'missing.xml': No such file",
    ),
    "no stiffness": (
        mjcf("").replace(f' stiffness="{SPRING}"', ""),
        "no joint has a stiffness: .* such as j0",
    ),
    "a root that a weld holds, without word": (
        mjcf('type="free"', tail='<equality><weld body1="s0"/></equality>').replace(
            ' axis="0 1 0" type', " type"
        ),
        "<weld> holds the chain: say by boundary",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_in_the_way_is_named(case: str, tmp_path: Path) -> None:
    text, says = REFUSED[case]
    (tmp_path / "model.xml").write_text(text)
    with pytest.raises(ValueError, match=says):
        audit_file(tmp_path / "model.xml", BEAM)


@pytest.mark.parametrize("joint", ["<freejoint/>", '<joint type="ball"/>', '<joint axis="0 1 0"/>'])
def test_the_word_clamped_holds_the_root_before_it_holds_a_free_tip(joint: str, tmp_path: Path) -> None:
    """A hub of 2 kg that moves, with one chain on it: "clamped-free" is not "free-clamped"."""
    hub = f'<body name="hub">{joint}<geom type="box" size=".05 .05 .05" mass="2"/>{{}}</body>'
    path = tmp_path / "model.xml"
    path.write_text(mjcf(root=hub))
    for word in ("clamped-free", "free-clamped"):
        found = audit_file(path, BEAM, word)
        assert {str(found.boundary.left.word), str(found.boundary.right.word)} == {"clamped", "free"}
        np.testing.assert_allclose(found.angular_frequency / (2 * math.pi), truth("clamped-free"), rtol=1e-9)
        assert any("held, because you say so" in line for line in found.assumed)


def test_models_in_a_circle_or_too_deep_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.sdf"
    circle = PLAIN.replace("<pose>0.4 0 0 0 0 0</pose>", '<pose relative_to="in::t"/>')
    inner = '<model name="in"><pose relative_to="s2"/><link name="t"/></model>'
    deep = '<model name="a">' * 22 + "</model>" * 22
    for text, says in (
        (f'<model name="m">{circle}{inner}</model>', "must not have a pose in a circle"),
        (f'<model name="m">{PLAIN}{deep}</model>', "nested in at most 20 models"),
    ):
        path.write_text(sdf(text))
        with pytest.raises(ValueError, match=says):
            audit_file(path, BEAM)


def test_links_without_rotary_inertia_are_judged_and_blamed(tmp_path: Path) -> None:
    """A mass at its link's middle has none about itself: what MuJoCo refuses URDF and SDFormat may say."""
    path = tmp_path / "model.urdf"
    path.write_text(urdf(about=0.0, kind="continuous"))
    found = audit_file(path, BEAM)
    due = truth("clamped-free", inertia=1e-12)
    np.testing.assert_allclose(found.angular_frequency / (2 * math.pi), due, rtol=1e-7)
    assert found.rotary_inertia_mismatch == pytest.approx(-1, abs=1e-6)
    assert re.search(r"rotary inertia of the segments is -100 % off", found.text)


@pytest.mark.parametrize("plane", ["y", "z"])
@pytest.mark.parametrize("welded", [False, True])
def test_small_links_between_hinges_leave_the_rods_their_length(
    plane: str, welded: bool, tmp_path: Path
) -> None:
    """Cross-pieces of 4 g at every node: an outer rod without one, or welded to the ground, is a segment."""
    cross = BEND + '<geom size="0.01" mass="0.004"/>'
    text = noded(f'<joint name="z{{i}}" axis="0 0 1" stiffness="{SPRING}"/>', cross)
    if welded:
        text = re.sub(r'<joint name="[jz]0".*?/>', "", text)
    path = tmp_path / "model.xml"
    path.write_text(text)
    found = audit_file(path, BEAM, plane=plane)
    assert (found.segments, found.layout) == (COUNT, "rigid_stub" if welded else "naive")
    assert found.length_mismatch == pytest.approx(0, abs=1e-9)
    # The moving crosses are no mass of the beam; each is 4 % of a rod.
    assert found.mass_mismatch > 0.02


@pytest.mark.parametrize("mass", [1.0, 4.0])
def test_a_heavy_cart_on_a_rail_is_a_body_and_no_length_of_the_beam(mass: float, tmp_path: Path) -> None:
    cart = f'<joint type="slide" axis="0 0 1"/><inertial pos="0.1 0 0" mass="{mass}" diaginertia="1 1 1"/>'
    path = tmp_path / "model.xml"
    path.write_text(
        mjcf(root=f'<body name="cart" pos="-0.1 0 0">{cart}<frame pos="0.1 0 0">{{}}</frame></body>')
    )
    found = audit_file(path, BEAM)
    assert found.boundary.left.holds_rotation and found.boundary.left.mass == pytest.approx(mass)
    assert (found.segments, found.layout, found.length_mismatch) == (COUNT, "naive", pytest.approx(0))


@pytest.mark.parametrize("springs", [1.0, 1.3])
def test_three_times_a_rods_inertia_is_said_where_no_rule_of_masses_at_tips_is_meant(
    springs: float, tmp_path: Path
) -> None:
    text = mjcf().replace(f"{ABOUT!r}", f"{3 * ABOUT!r}")
    path = tmp_path / "model.xml"
    path.write_text(text.replace(f'"{SPRING}"', f'"{springs * SPRING}"'))
    found = audit_file(path, BEAM)
    # Masses at both tips have m l²/4.
    assert "rotary inertia of the segments is that of masses at their tips, 3 times" in found.text


def test_of_hinges_by_turns_about_two_axes_both_planes_are_offered(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(re.sub(r'(name="j[13]") axis="0 1 0"', r'\1 axis="0 0 1"', mjcf()))
    found = audit_file(path, BEAM)
    assert "there are hinges for y, z: say by plane which is meant" in found.text
    for plane, hinges in (("z", 3), ("y", 2)):
        assert len(audit_file(path, BEAM, plane=plane).joint_stiffness) == hinges


@pytest.mark.parametrize("first", ["", f'stiffness="{SPRING}"'])
def test_a_heavy_first_rod_is_a_hub_only_if_the_beams_length_leaves_it_out(
    first: str, tmp_path: Path
) -> None:
    heavy = (
        f'<inertial pos="{ELL / 2} 0 0" mass="{5 * MASS}" diaginertia="1e-6 {5 * ABOUT!r} {5 * ABOUT!r}"/>'
    )
    path = tmp_path / "model.xml"
    path.write_text(mjcf(first).replace(INERTIAL, heavy, 1))
    whole, outer = audit_file(path, BEAM), audit_file(path, Beam((COUNT - 1) * ELL, SPRING * ELL, MASS / ELL))
    np.testing.assert_allclose(whole.angular_frequency, outer.angular_frequency, rtol=1e-9)
    hub = outer.boundary.left
    assert (whole.segments, outer.segments, float(hub.hub_radius)) == (COUNT, COUNT - 1, pytest.approx(ELL))
    # A rod about its end: m l²/3.
    assert hub.rotary_inertia == pytest.approx(5 * MASS * ELL**2 / 3)
    assert whole.length_mismatch == pytest.approx(0, abs=1e-9) == outer.length_mismatch
    assert "is a hub, and the beam begins 0.2 m beside that hinge" in outer.text


HALVES = "".join(
    f'<geom type="cylinder" fromto="{start} 0 0 {start + ELL / 2} 0 0" size="0.004" mass="{MASS / 2}"/>'
    for start in (0.0, ELL / 2)
)
ARM = (
    '<body name="arm"><joint name="motor" axis="0 0 1"/>'
    '<geom type="cylinder" fromto="-0.4 0 0 0 0 0" size="0.02" mass="2"/>{}</body>'
)


@pytest.mark.parametrize("share", [0.8, 1.0, 1.2])
@pytest.mark.parametrize("root", ["{}", ARM])
@pytest.mark.parametrize("rod", [INERTIAL, HALVES])
def test_neither_solids_nor_carriers_nor_the_beams_length_change_the_rods(
    share: float, root: str, rod: str, tmp_path: Path
) -> None:
    """A rod of two solids is one segment, and an arm that a motor turns out of the plane is none."""
    path = tmp_path / "model.xml"
    path.write_text(mjcf(root=root).replace(INERTIAL, rod))
    found = audit_file(path, Beam(share * COUNT * ELL, SPRING * ELL, MASS / ELL))
    assert (found.boundary.name, found.layout, found.segments) == ("clamped-free", "naive", COUNT)
    assert found.length_mismatch == pytest.approx(1 / share - 1)


@pytest.mark.parametrize("share", [0.8, 1.0, 1.2])
@pytest.mark.parametrize(
    "tip",
    ["", '<body pos="0.1 0 0"><inertial mass="0.3" pos="0.02 0 0" diaginertia="1e-3 1e-3 1e-3"/></body>'],
)
@pytest.mark.parametrize("lumps", [False, True])
def test_half_segments_at_both_ends_are_halves(share: float, tip: str, lumps: bool, tmp_path: Path) -> None:
    """Welded half a rod before the first hinge, half a rod after the last, with a body or lumped masses."""
    lengths, text = [ELL / 2, *[ELL] * (COUNT - 1), ELL / 2], ""
    for i in reversed(range(COUNT + 1)):
        own, mass = lengths[i], MASS * lengths[i] / ELL
        rod = f'<geom type="cylinder" fromto="0 0 0 {own} 0 0" size="0.004" mass="{0.0 if lumps else mass}"/>'
        rod += f'<geom size="0.01" pos="{own} 0 0" mass="{mass}"/>' if lumps else ""
        hinge = f'<joint axis="0 1 0" stiffness="{SPRING}"/>' if i else ""
        place = f'pos="{lengths[i - 1]} 0 0"' if i else ""
        text = f"<body {place}>{hinge}{rod}{tip if i == COUNT else ''}{text}</body>"
    path = tmp_path / "model.xml"
    path.write_text(f'<mujoco><option gravity="0 0 0"/><worldbody>{text}</worldbody></mujoco>')
    found = audit_file(path, Beam(share * COUNT * ELL, SPRING * ELL, MASS / ELL))
    assert (found.layout, found.segments) == ("half_stub", COUNT)
    assert found.length_mismatch == pytest.approx(1 / share - 1)
    assert found.boundary.right.mass == pytest.approx(0.3 if tip else 0.0)
