"""URDF and SDFormat written by hand: the chain that is read is the one that Pinocchio or a known rule has."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg

from beammodes.accuracy.errors import frequency_error
from beammodes.auditing.audit_model import audit_file
from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam

BEAM = Beam(0.5, 20.0, 0.5)
MASS, ELL = 0.05, 0.1
ROD = MASS * ELL**2 / 12


def link(name: str, turn: str = "0 0 0", along: float = ELL / 2) -> str:
    """A slender rod along its frame's x, its inertia given in a frame of its own."""
    return f"""<link name="{name}"><inertial><origin xyz="{along} 0 0" rpy="{turn}"/><mass value="{MASS}"/>
      <inertia ixx="1e-9" iyy="{ROD}" izz="{ROD}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def joint(name: str, parent: str, child: str, turn: str = "0 0 0") -> str:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return f"""<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
      <origin xyz="{ELL} 0 0" rpy="{turn}"/><axis xyz="0 1 0"/>{limit}</joint>"""


def springs(names: list[str], stiffness: float = 200.0) -> str:
    return "springs:\n" + "".join(f"  - {{joint: {name}, stiffness: {stiffness}}}\n" for name in names)


def write(folder: Path, robot: str, yaml: str | None) -> Path:
    path = folder / "arm.urdf"
    path.write_text(f'<?xml version="1.0"?><robot name="arm">{robot}</robot>', encoding="utf-8")
    if yaml is not None:
        (folder / "arm.springs.yaml").write_text(yaml, encoding="utf-8")
    return path


def flipped(count: int = 5) -> str:
    """The first link is the root, so welded; each frame is turned about the beam's line against the last."""
    text = link("l0")
    for i in range(1, count):
        text += link(f"l{i}", "1.5707963267948966 0 0")
        text += joint(f"j{i}", f"l{i - 1}", f"l{i}", turn=f"{math.pi} 0 0")
    return text


def gazebo(stiffness: float, more: str = "") -> str:
    own = f"<springStiffness>{stiffness}</springStiffness>{more}"
    return "".join(f'<gazebo reference="j{i}">{own}</gazebo>' for i in range(1, 5))


DRIVE = """<transmission><joint name="j2"/>
  <actuator name="a"><drake:rotor_inertia value="0.1"/></actuator></transmission>"""


def test_a_hand_written_arm_has_the_frequencies_that_pinocchio_finds(tmp_path: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    names = [f"j{i}" for i in range(1, 5)]
    path = write(tmp_path, flipped(), springs(names))
    model = pinocchio.buildModelFromUrdf(str(path))
    mass = np.triu(pinocchio.crba(model, model.createData(), pinocchio.neutral(model)))
    mass += np.triu(mass, 1).T
    known = np.sqrt(scipy.linalg.eigh(200.0 * np.eye(4), mass, eigvals_only=True))
    found = audit_file(path, BEAM, modes=4)
    np.testing.assert_allclose(found.angular_frequency, known, rtol=1e-9)
    assert (found.layout, found.segments) == ("rigid_stub", 5)
    assert "root link 'l0' is taken as fixed to the ground" in found.notes
    assert found.hinge_names == tuple(names)


def test_gazebos_own_springs_are_read_too(tmp_path: Path) -> None:
    with_yaml = audit_file(write(tmp_path, flipped(), springs([f"j{i}" for i in range(1, 5)])), BEAM)
    (tmp_path / "arm.springs.yaml").unlink()
    found = audit_file(write(tmp_path, flipped() + gazebo(200.0), None), BEAM)
    np.testing.assert_array_equal(found.errors, with_yaml.errors)


@pytest.mark.parametrize(
    ("robot", "message"),
    [
        (flipped() + link("x") + joint("k", "l2", "x"), "k on body l2 must be a hinge with a spring"),
        (
            flipped().replace('name="j3" type="revolute"', 'name="j3" type="planar"'),
            "must be revolute, got type 'planar'",
        ),
        (flipped().replace("<axis", '<mimic joint="j1"/><axis', 3), "must not mimic"),
        (flipped().replace(f'<mass value="{MASS}"/>', '<mass value="-1"/>'), "mass of at least 0"),
        (flipped().replace("<inertia ", "<inertias "), "must have <mass> and <inertia>"),
        (flipped().replace('axis xyz="0 1 0"', 'axis xyz="0 0 0"'), "axis that is not zero"),
        (flipped().replace('lower="-1"', 'lower="0"'), "at rest within its limits"),
        (flipped().replace("<axis", '<dynamics damping="1" friction="2"/><axis'), "dry friction holds"),
        (flipped() + link("l4"), "name of its own, got 'l4' for a second time"),
        (flipped() + link("l9") + joint("j4", "l4", "l9"), "name of its own, got 'j4' for a second time"),
        (flipped() + '<xacro:macro name="m"/>', "expanded by xacro"),
        (flipped() + gazebo(100.0), "same in both places, got 100 in <gazebo> and 200"),
        (flipped() + gazebo(200.0, "<springReference>0.3</springReference>"), "relaxed at the same place"),
        (flipped() + "<drake:linear_bushing_rpy/>", "only joints of a tree are read"),
        (
            flipped() + DRIVE,
            "j2'> must have no <drake:rotor_inertia>",
        ),
        (flipped().replace('<origin xyz="0.1 0 0"', '<origin xyz="0.1 0 0.01"', 2), "on one straight line"),
    ],
)
def test_what_cannot_be_honoured_is_named(robot: str, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, robot, springs([f"j{i}" for i in range(1, 5)]))
    with pytest.raises(ValueError, match=message):
        audit_file(path, BEAM)


def test_a_urdf_file_without_springs_says_so(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="must have a hinge with a spring"):
        audit_file(write(tmp_path, flipped(), None), BEAM)


def test_missing_springs_are_asked_for_where_they_belong(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"give a file with them by springs= .*row such as \{joint: \w+"):
        audit_file(write(tmp_path, flipped(), None), BEAM)


SDF_LINK = """<link name="l{i}"><pose>{x} 0 0.5 0 0 {turn}</pose><inertial><pose>{at} 0 0 0 0 0</pose>
  <mass>{mass}</mass><inertia><ixx>1e-9</ixx><iyy>{rod}</iyy><izz>{rod}</izz></inertia></inertial></link>"""
SDF_JOINT = """<joint name="j{i}" type="revolute"><parent>{parent}</parent><child>l{i}</child>
  <axis><xyz>0 0 {way}</xyz><dynamics><spring_stiffness>200</spring_stiffness></dynamics></axis></joint>"""


def sdf(count: int, parent: str = "world", extra: str = "") -> str:
    """Rods whose frames point forward and backward in turn, the first hinge at the wall."""
    text = extra
    for i in range(count):
        back = i % 2
        x, turn, at = (i * ELL, math.pi if back else 0.0, (-1) ** back * ELL / 2)
        text += SDF_LINK.format(i=i, x=x, turn=turn, at=at, mass=MASS, rod=ROD)
        if i or parent:
            text += SDF_JOINT.format(i=i, parent=f"l{i - 1}" if i else parent, way=1 - 2 * back)
    world = f'<world name="w"><gravity>0 0 0</gravity><model name="m">{text}</model></world>'
    return f'<sdf version="1.9">{world}</sdf>'


def test_sdformat_by_hand_is_the_naive_rule(tmp_path: Path) -> None:
    path = tmp_path / "beam.sdf"
    path.write_text(sdf(5))
    found = audit_file(path, BEAM)
    assert (found.layout, found.segments, found.boundary.name) == ("naive", 5, "clamped-free")
    due = frequency_error("clamped-free", segments=5, mode=[1, 2, 3], rule="naive")
    np.testing.assert_allclose(found.errors, due, atol=1e-9)


DOOR = """<model name="door"><link name="post"/><link name="leaf"/><joint name="hinge" type="revolute">
  <parent>post</parent><child>leaf</child><axis><xyz>0 0 1</xyz></axis></joint></model>"""
TURN = f"0 0 {math.pi}"
AXIS2 = "<axis2><xyz>0 1 0</xyz><dynamics><spring_stiffness>90</spring_stiffness></dynamics></axis2></joint>"
#: What is written otherwise for the same chain, each pair of old and new text.
ALIKE = {
    "relative to a link": [("<pose>0.1 0 0.5 0 0", '<pose relative_to="l0">0.1 0 0 0 0')],
    "relative to a joint": [
        ("<pose>0.2 0 0.5 0 0 0.0", f'<pose relative_to="j1">-0.1 0 0 {TURN.replace("0 0 ", "0 0 -")}')
    ],
    "relative to the model": [("<pose>0.1", '<pose relative_to="__model__">0.1')],
    "axes in the model": [("<xyz>0 0 -1", "<xyz>0 0 1"), ("<xyz>", '<xyz expressed_in="__model__">')],
    "axes in the first link": [("<xyz>0 0 -1", "<xyz>0 0 1"), ("<xyz>", '<xyz expressed_in="l0">')],
    "axes in the model by an old word": [
        ("<xyz>0 0 -1", "<xyz>0 0 1"),
        ("<xyz>", "<use_parent_model_frame>1</use_parent_model_frame><xyz>"),
    ],
    "an old version": [("<xyz>0 0 -1", "<xyz>0 0 1"), ("1.9", "1.4")],
    "limits of the largest double": [
        ("<dynamics>", "<limit><lower>-1.79769e+308</lower><upper>1e16</upper></limit><dynamics>")
    ],
    "a model before it": [('<model name="m">', DOOR + '<model name="m">')],
    "a comment with hyphens": [("<model name", "<!-- maker --count 5 --><model name")],
    "universal joints": [('type="revolute"', 'type="universal"'), ("</joint>", AXIS2)],
}


@pytest.mark.parametrize("case", ALIKE)
def test_sdformat_has_many_words_for_one_chain(case: str, tmp_path: Path) -> None:
    text = sdf(5)
    for old, new in ALIKE[case]:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "beam.sdf").write_text(text)
    found = audit_file(tmp_path / "beam.sdf", BEAM, plane="y")
    due = frequency_error("clamped-free", segments=5, mode=[1, 2, 3], rule="naive")
    np.testing.assert_allclose(found.errors, due, atol=1e-9)


def test_sdformat_frames_are_followed(tmp_path: Path) -> None:
    """Every link in a frame of the one before, in a row: poses are the products of all before."""
    text = sdf(5)
    for i in range(1, 5):
        frame = f'<frame name="f{i}" attached_to="l{i - 1}"><pose>0 0 0 0 0 {0.1 * i}</pose></frame>'
        old = f'<link name="l{i}"><pose>{i * ELL} 0 0.5 0 0 {math.pi if i % 2 else 0.0}</pose>'
        assert old in text
        way = 1 if i % 2 else -1
        x, y = way * ELL * math.cos(0.1 * i), -way * ELL * math.sin(0.1 * i)
        new = f'<link name="l{i}"><pose relative_to="f{i}">{x!r} {y!r} 0 0 0 {math.pi - 0.1 * i!r}</pose>'
        text = text.replace(old, frame + new)
    (tmp_path / "beam.sdf").write_text(text)
    found = audit_file(tmp_path / "beam.sdf", BEAM)
    due = frequency_error("clamped-free", segments=5, mode=[1, 2, 3], rule="naive")
    np.testing.assert_allclose(found.errors, due, atol=1e-9)


def test_sdformat_without_a_joint_to_the_world_is_free(tmp_path: Path) -> None:
    path = tmp_path / "beam.sdf"
    path.write_text(sdf(5, parent=""))
    found = audit_file(path, BEAM)
    assert found.boundary.name == "free-free"
    due = frequency_error("free-free", segments=5, mode=[1, 2, 3], rule="naive")
    np.testing.assert_allclose(found.errors, due, atol=1e-9)
    path.write_text(sdf(5, parent="", extra="<static>1</static>"))
    assert audit_file(path, BEAM).layout == "rigid_stub"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "<spring_stiffness>200",
            "<spring_reference>1</spring_reference><spring_stiffness>200",
            "on one straight line",
        ),
        ('type="revolute"', 'type="universal"', "revolute or universal with its axes, got type 'universal'"),
        ('type="revolute"', 'type="ball"', "revolute or universal with its axes, got type 'ball'"),
        (
            "<pose>0.1",
            '<pose relative_to="far">0.1',
            "relative to a link, joint or frame of the model, got 'far'",
        ),
        ("<pose>0.1", '<pose relative_to="l1">0.1', "must not have a pose in a circle"),
        ("<inertial><pose>", '<inertial><pose relative_to="l0">', "what is in a link is placed in that link"),
        ("<spring_stiffness>200", "<spring_stiffness>-200", "stiffness of at least 0, got -200"),
        ("<mass>0.05", "<mass>heavy", "finite number, got 'heavy'"),
        ("<inertial>", '<inertial auto="true">', "auto is not worked out here"),
        ("</inertial>", "<fluid_added_mass/></inertial>", "in no fluid"),
        ("<dynamics>", "<dynamics><friction>1</friction>", "dry friction holds"),
        ("<dynamics>", "<limit><lower>0</lower></limit><dynamics>", "at rest within its limits"),
        ("<dynamics>", '<mimic joint="j0"/><dynamics>', "must not mimic"),
        ("</axis>", "</axis><drake:rotor_inertia>0.1</drake:rotor_inertia>", "no <drake:rotor_inertia>"),
        ("</model>", "<drake:ball_constraint/></model>", "only joints of a tree"),
        ("</model>", '<link name="l1"/></model>', "name of its own, got 'l1'"),
        ("</world>", '<joint name="k" type="fixed"/></world>', "must join links that exist, got ''"),
    ],
)
def test_what_sdformat_cannot_have_here_is_named(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "beam.sdf"
    assert old in sdf(5)
    path.write_text(sdf(5).replace(old, new))
    with pytest.raises(ValueError, match=message):
        audit_file(path, BEAM)


def test_sdformat_as_gazebo_prints_it_beside_a_floor(tmp_path: Path) -> None:
    path = tmp_path / "beam.sdf"
    path.write_text(sdf(5))
    plain = audit_file(path, BEAM)
    floor = '<model name="floor"><static>1</static><link name="f"/></model><model'
    limits = "<limit><lower>-inf</lower><upper>inf</upper></limit><dynamics>"
    path.write_text(sdf(5).replace("<model", floor, 1).replace("<dynamics>", limits))
    found = audit_file(path, BEAM)
    np.testing.assert_array_equal(found.errors, plain.errors)
    assert "other models are left out here: 'floor'" in found.notes


@pytest.mark.parametrize("case", ["clamped-free", "clamped-clamped", "free-free"])
def test_a_fragment_and_a_chain_of_two_axes_are_known_again(case: str, tmp_path: Path) -> None:
    chain, weak = (Chain(Beam(0.5, stiffness, 0.5), case, 6, "gregory") for stiffness in (20.0, 5.0))
    part = export_chain(chain, tmp_path / "part.xml", fragment=True)[0]
    both = export_chain(chain, tmp_path / "both.xml", second=weak)[0]
    for path, plane, each in ((part, None, chain), (both, "z", chain), (both, "y", weak)):
        assert each.beam is not None
        found = audit_file(path, each.beam, plane=plane)
        assert "gregory" in found.remark
        due = frequency_error(case, segments=6, mode=[1, 2, 3], rule="gregory")
        np.testing.assert_allclose(found.errors, due, atol=2e-8)


def test_a_file_is_named_once_in_a_refusal(tmp_path: Path) -> None:
    path = tmp_path / "empty.csv"
    path.write_text("")
    with pytest.raises(ValueError, match="must have one line") as caught:
        audit_file(path, BEAM)
    assert str(caught.value).count("empty.csv") == 1
