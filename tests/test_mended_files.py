"""Files with the springs of the audit's advice: byte for byte the user's, and true in the engines."""

from __future__ import annotations

import difflib
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from test_engine_steps import drake_plant
from test_engines import ALL, elastic_frequencies, matrices, pinocchio_matrices

from beammodes.__main__ import main
from beammodes.auditing import mended_files
from beammodes.auditing.audit_model import audit_file
from beammodes.auditing.mended_files import mend_file
from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam

Array = NDArray[np.float64]

BEAM = Beam(0.8, 2.0, 0.5)
#: 0.2 m of the beam: its mass, and its inertia with a section's own.
ROD = '<geom type="cylinder" fromto="0 0 0 .2 0 0" size=".005" mass=".1"/>'
# Four hinges: a number in odd quotes and blanks, two of a class, one of its own beside its class; with what a
# careless writer would spoil: a joint in a comment, other springs, CRLF, a declaration, letters beyond ASCII.
MJCF = """<?xml version='1.0' encoding='{encoding}'?>
<!-- Träger: <joint name="j0" stiffness="10"/> was 9 -->\r
<mujoco>\r
<compiler angle="degree"/>\t<option gravity="0 0 0"/>
<default><default class="flex"><joint axis="0 1 0" stiffness="10" damping="0"/></default></default>
<worldbody><body name='b0'><joint name='j0' axis="0 1 0"  stiffness =  ' {k0} '/>{rod}
<body pos=".2 0 0" childclass="flex"><joint name="j1"{k1}
   />{rod}
<body pos=".2 0 0"><joint name="j2" stiffness="{k2}" ></joint>{rod}
<body pos=".2 0 0"><joint name="j3"/>{rod}
</body></body></body></body>
<body pos="0 3 0"><joint axis="0 1 0" stiffness="10"/>{rod}</body>
</worldbody></mujoco>
<!-- end -->"""

SDF = """<?xml version="1.0"?>
<sdf version="1.9"><!-- <spring_stiffness>10</spring_stiffness> --><model name="boom">{links}{joints}
</model></sdf>
"""
LINK = """<link name="seg{i}"><pose>{x} 0 0 0 0 0</pose><inertial><pose>0.1 0 0 0 0 0</pose><mass>0.1</mass>
<inertia><ixx>1e-6</ixx><iyy>{j}</iyy><izz>{j}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
"""
JOINT = """<joint name="joint{i}" type="revolute"><parent>{parent}</parent><child>seg{i}</child>
<axis><xyz>0 1 0</xyz><dynamics><damping>0</damping><spring_stiffness>{spring}</spring_stiffness></dynamics>
</axis></joint>
"""
URDF = """<robot name="boom"><link name="world"/>{}</robot>"""
URDF_SEGMENT = """
<link name="seg{i}"><inertial><origin xyz="0.1 0 0"/><mass value="0.1"/>
<inertia ixx="1e-6" iyy="{j}" izz="{j}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint{i}" type="continuous"><parent link="{parent}"/><child link="seg{i}"/>
<origin xyz="{x} 0 0"/><axis xyz="0 1 0"/></joint>"""
YAML = """# Federn in N m/rad: {{joint: joint0, stiffness: 10}}, größer
model: boom\r
springs:
- {{"stiffness": {}, joint: "joint0"}} # 10
- joint: joint1
  type: hinge
  stiffness:   {}
- {{ joint: joint2, stiffness: {} }}
- {{joint: joint3, stiffness: 10}}
"""


def parents(count: int = 4) -> list[dict[str, Any]]:
    rod = 0.1 * 0.2**2 / 12
    return [{"i": i, "j": rod, "x": 0.2 * i, "parent": f"seg{i - 1}" if i else "world"} for i in range(count)]


def sdf(*springs: str) -> str:
    rows = parents()
    links = "".join(LINK.format(**row) for row in rows)
    joints = "".join(JOINT.format(**row, spring=spring) for row, spring in zip(rows, springs, strict=True))
    return SDF.format(links=links, joints=joints)


def urdf(folder: Path) -> Path:
    rows = parents()
    path = folder / "model.urdf"
    path.write_text(
        URDF.format("".join(URDF_SEGMENT.format(**row | {"x": 0.2 * (row["i"] > 0)}) for row in rows))
    )
    return path


def new_springs(mended: mended_files.MendedFile) -> list[str]:
    return [repr(value) for value in mended.suggestion.joint_stiffness.tolist()]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_mjcf_changes_by_its_numbers_only(encoding: str, tmp_path: Path) -> None:
    path, written = tmp_path / "model.xml", tmp_path / "mended.xml"
    words = {"encoding": encoding.removesuffix("-sig"), "rod": ROD}
    path.write_bytes(MJCF.format(**words, k0="10", k1="", k2="1e1").encode(encoding))
    mended = mend_file(path, written, BEAM)
    k0, k1, k2, k3 = new_springs(mended)
    due = MJCF.format(**words, k0=k0, k1=f' stiffness="{k1}"', k2=k2)
    assert written.read_bytes() == due.encode(encoding)
    # The fourth is EI/ell already, in its class, which the other body's joint does not have.
    assert (mended.suggestion.name, float(k3)) == ("gregory", pytest.approx(10.0, rel=1e-12))
    assert mended.hinge_names == ("j0", "j1", "j2")
    assert mended.old_number.tolist() == [10.0] * 3
    assert sorted(each.name for each in tmp_path.iterdir()) == ["mended.xml", "model.xml"]


def test_a_mended_mjcf_file_has_the_promised_frequencies_in_mujoco(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "model.xml"
    path.write_text(MJCF.format(encoding="utf-8", rod=ROD, k0="10", k1="", k2="10"), encoding="utf-8")
    mended = mend_file(path, tmp_path / "mended.xml", BEAM, modes=4)
    model = mujoco.MjModel.from_xml_path(str(mended.path))
    # No unit of angles touches a stiffness.
    assert model.jnt_stiffness[:4] == pytest.approx(mended.suggestion.joint_stiffness, rel=1e-15)
    assert model.jnt_stiffness[4] == 10.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass, stiffness = (matrix[:4, :4] for matrix in matrices(mujoco, model, data))
    found = np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True))
    assert mended.audit.angular_frequency == pytest.approx(found, rel=1e-9)


@pytest.mark.parametrize(
    ("case", "rule"),
    [
        ("clamped-clamped", "naive"),
        ("elastic", "hencky"),
        ("clamped-elastic", "rigid_stub"),
        ("tip mass", "hencky"),
    ],
)
def test_springs_of_tendons_and_of_elastic_ends_are_written_so_that_the_chain_has_them(
    case: str, rule: str, tmp_path: Path
) -> None:
    chain = Chain(Beam(1.2, 85.0, 0.62), ALL[case], segments=6, rule=rule)
    (path,) = export_chain(chain, tmp_path / "model.xml")
    mended = mend_file(path, tmp_path / "mended.xml", chain.beam, chain.boundary)
    assert np.abs(mended.audit.errors[0]) < np.abs(mended.before.errors[0])
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(mended.path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = elastic_frequencies(*matrices(mujoco, model, data), chain.elastic_modes)
    assert mended.audit.angular_frequency == pytest.approx(found[:3], rel=1e-8)


def test_sdf_changes_by_its_numbers_only(tmp_path: Path) -> None:
    path = tmp_path / "model.sdf"
    noted, cdata = "<!-- was 10 --> {}\n <!--10-->", "<![CDATA[{}]]>"
    path.write_text(sdf(noted.format(10), cdata.format("10.0"), "<?a 10?>1e1", "10"))
    mended = mend_file(path, tmp_path / "mended.sdf", BEAM)
    k0, k1, k2, _ = new_springs(mended)
    assert mended.path.read_text() == sdf(noted.format(k0), cdata.format(k1), f"<?a 10?>{k2}", "10")


@pytest.mark.filterwarnings("ignore")
def test_a_mended_sdf_file_has_the_promised_frequencies_in_drake(tmp_path: Path) -> None:
    path = tmp_path / "model.sdf"
    path.write_text(sdf(*["10"] * 4))
    mended = mend_file(path, tmp_path / "mended.sdf", BEAM, modes=4)
    plant = drake_plant(mended.path, 0.0)
    tree = pytest.importorskip("pydrake.multibody.tree")
    context = plant.CreateDefaultContext()
    mass = plant.CalcMassMatrix(context)
    columns = []
    for angle in np.eye(4):
        plant.SetPositions(context, angle)
        forces = tree.MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        columns.append(-forces.generalized_forces())
    found = np.sqrt(scipy.linalg.eigh(np.array(columns), mass, eigvals_only=True))
    assert mended.audit.angular_frequency == pytest.approx(found, rel=1e-9)


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_the_springs_of_urdf_change_by_their_numbers_only(mark: str, tmp_path: Path) -> None:
    path, springs = urdf(tmp_path), tmp_path / "model.springs.yaml"
    springs.write_bytes((mark + YAML.format("10", "10.0", "1.0e+1")).encode())
    mended = mend_file(path, tmp_path / "mended.springs.yaml", BEAM)
    k0, k1, k2, _ = new_springs(mended)
    assert mended.path.read_bytes() == (mark + YAML.format(k0, k1, k2)).encode()
    assert mended.model == path and "to take the place of model.springs.yaml beside" in mended.text
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(path))
    numbers = dict(zip(mended.before.hinge_names, mended.suggestion.joint_stiffness.tolist(), strict=True))
    # pinocchio_matrices takes joints of one angle each, as "continuous" is not in Pinocchio.
    text = path.read_text().replace("continuous", "revolute")
    limited = text.replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    )
    model = pinocchio.buildModelFromXML(limited)
    found = elastic_frequencies(*pinocchio_matrices(pinocchio, model, numbers), 4)
    assert mended.audit.angular_frequency == pytest.approx(found[:3], rel=1e-9)


def test_gazebos_springs_in_urdf_are_written_there_and_never_in_one_of_two_places(tmp_path: Path) -> None:
    path, springs = urdf(tmp_path), tmp_path / "model.springs.yaml"
    own = '<gazebo reference="joint{}"><springStiffness>{}</springStiffness></gazebo>'
    plain = path.read_text()
    text = plain.replace("</robot>", "".join(own.format(i, 10) for i in range(4)) + "</robot>")
    path.write_text(text)
    mended = mend_file(path, tmp_path / "mended.urdf", BEAM)
    changed = [
        line for line in difflib.ndiff(text.split("<"), mended.path.read_text().split("<")) if line[0] in "-+"
    ]
    assert [line for line in changed if line[0] == "+"] == [
        f"+ springStiffness>{k}" for k in new_springs(mended)[:3]
    ]
    springs.write_text(YAML.format("10", "10", "10"))
    with pytest.raises(
        ValueError, match="joint 'joint0' has its spring both in <gazebo> and in the file beside"
    ):
        mend_file(path, tmp_path / "again.urdf", BEAM)
    path.write_text(plain)
    with pytest.raises(ValueError, match=r"written must be a YAML file.*model\.springs\.yaml are written"):
        mend_file(path, tmp_path / "again.urdf", BEAM)


def test_what_is_there_is_never_overwritten_unasked(tmp_path: Path) -> None:
    path, other, link = (tmp_path / name for name in ("model.sdf", "other.sdf", "link.sdf"))
    path.write_text(sdf(*["10"] * 4))
    os.link(path, other)
    link.symlink_to(path)
    for place in (path, other, link):
        with pytest.raises(ValueError, match="written must be another file than those that are read"):
            mend_file(path, place, BEAM, force=True)
    other.unlink()
    other.write_text("mine")
    with pytest.raises(FileExistsError, match="written must be new unless force=True"):
        mend_file(path, other, BEAM)
    assert other.read_text() == "mine"
    assert mend_file(path, other, BEAM, force=True).path.read_bytes() != b"mine"
    assert path.read_text() == sdf(*["10"] * 4)


def test_the_command_writes_and_its_exit_code_is_that_of_the_written_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, written = str(tmp_path / "model.sdf"), str(tmp_path / "mended.sdf")
    export_chain(Chain(BEAM, "clamped-free", 10, "naive"), path)
    call = ["audit", path, "--length", "0.8", "--ei", "2", "--rho-a", "0.5", "--json"]
    assert main([*call, "--write", written]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["meets"], answer["written"]["meets"]) == (False, True)
    assert [row["hinge"] for row in answer["written"]["numbers"]] == [f"chain_hinge_{i}" for i in (1, 2, 3)]
    found = audit_file(written, BEAM)
    assert [row["frequency_hz"] for row in answer["written"]["modes"]] == found.frequency.tolist()
    tuned = ["--suggestion", "first_spring_tuned"]
    assert main([*call, "--write", written, "--force", *tuned]) == 1
    assert main([*call, *tuned]) == 2
    assert "--suggestion must be left out without --write" in capsys.readouterr().err


def test_a_file_that_does_not_keep_its_promise_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.sdf"
    path.write_text(sdf(*["10"] * 4))
    monkeypatch.setattr(mended_files, "with_numbers", lambda data, _: data.replace(b"10<", b"20<"))
    with pytest.raises(
        ValueError, match="springs of gregory cannot be written: read back, the file does not"
    ):
        mend_file(path, tmp_path / "mended.sdf", BEAM)
    assert [each.name for each in tmp_path.iterdir()] == ["model.sdf"]


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    rod = MJCF.format(encoding="utf-8", rod=ROD, k0="10", k1="", k2="10")
    body = rod[rod.index("<body name") : rod.index('<body pos="0 3 0">')]
    default = '<default><default class="flex"><joint axis="0 1 0" stiffness="10"/></default></default>'
    (tmp_path / "arm.xml").write_text(f"<mujocoinclude>{body}</mujocoinclude>")
    (tmp_path / "class.xml").write_text(f"<mujocoinclude>{default}</mujocoinclude>")
    whole, parts = tmp_path / "whole.xml", tmp_path / "parts.xml"
    whole.write_text(f'<mujoco>{default}<worldbody><include file="arm.xml"/></worldbody></mujoco>')
    parts.write_text(f'<mujoco><include file="class.xml"/><worldbody>{body}</worldbody></mujoco>')
    # What is written takes the place of the file that has the numbers.
    mended = mend_file(whole, tmp_path / "new_arm.xml", BEAM)
    assert (mended.model.name, mended.original.name) == ("whole.xml", "arm.xml")
    assert "to take the place of arm.xml beside whole.xml: 3 springs changed" in mended.text
    whole.write_text(whole.read_text().replace("arm.xml", "new_arm.xml"))
    again = audit_file(whole, BEAM)
    np.testing.assert_array_equal(again.errors, mended.audit.errors)
    # Of a class in another file nothing is changed there: the hinge gets a number of its own.
    assert 'name="j1" stiffness=' in mend_file(parts, tmp_path / "mended.xml", BEAM).path.read_text()
    with pytest.raises(ValueError, match="written must be another file than those that are read"):
        mend_file(parts, tmp_path / "class.xml", BEAM, force=True)
    whole.write_text(f'<mujoco>{default}<worldbody><include file="{tmp_path}/arm.xml"/></worldbody></mujoco>')
    with pytest.raises(ValueError, match="must be included by its plain name"):
        mend_file(whole, tmp_path / "again.xml", BEAM)
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    with pytest.raises(ValueError, match=r"written must be in the folder of parts\.xml.*line 1: <include>"):
        mend_file(parts, folder / "mended.xml", BEAM)
    chain = Chain(BEAM, "clamped-free", 5, "rigid_stub")
    (stub,) = export_chain(chain, tmp_path / "stub.xml")
    with pytest.raises(
        ValueError, match="suggestion must keep the hinges, got 'gregory', which moves them; of"
    ):
        mend_file(stub, tmp_path / "new.xml", BEAM, suggestion="gregory")
    with pytest.raises(ValueError, match=r"suggestion must be one of rigid_stub_corrected.*got 'naive'"):
        mend_file(stub, tmp_path / "new.xml", BEAM, suggestion="naive")
    assert mend_file(stub, tmp_path / "first.xml", BEAM).suggestion.name == "rigid_stub_corrected"
    # Of mode 1 the corrected springs leave more than the tolerance, the tuned one nothing.
    mended = mend_file(stub, tmp_path / "new.xml", BEAM, modes=1)
    assert mended.suggestion.name == "first_spring_tuned" and mended.audit.meets
    assert mended.audit.errors[0] == pytest.approx(0, abs=1e-9)
    assert "hinges stay where they are: moved as by gregory they give errors +0.00" in mended.not_mended
    good = export_chain(Chain(BEAM, "free-free", 5, "hencky"), tmp_path / "good.xml")[0]
    with pytest.raises(
        ValueError, match="there is none: no springs of a rule are better than these: hinges are where"
    ):
        mend_file(good, tmp_path / "better.xml", BEAM)
    (table,) = export_chain(chain, tmp_path / "stub.csv")
    with pytest.raises(ValueError, match="no number in the file is that spring"):
        mend_file(table, tmp_path / "new.csv", BEAM)
