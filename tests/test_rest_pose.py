"""Files whose springs are relaxed away from the file's pose: judged about the shape in which all are relaxed.

Truth are MuJoCo's and Drake's own matrices in that pose, and the same chain written by its poses.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm
from beammodes.auditing.bounded_xml import BadModel

Array = NDArray[np.float64]

COUNT, STEP, MASS, SPRING = 8, 0.1, 0.062, 850.0
BEAM = bm.Beam(COUNT * STEP, SPRING * STEP, MASS / STEP)
#: The chords of the arc turn by this at every hinge but the first, where they turn by half.
ANGLE = 0.15
#: Of the arc from node to node, whose chord a segment is.
ALONG = ANGLE * STEP / (2 * math.sin(ANGLE / 2))


def arc(across: float, twisting: float) -> bm.Rod:
    """The rod through the nodes, with these stiffnesses out of its plane."""
    return bm.Rod.arc(
        ANGLE * COUNT,
        length=COUNT * ALONG,
        bending_stiffness=SPRING * ALONG,
        second_bending_stiffness=across,
        torsional_stiffness=twisting,
        mass_per_length=MASS / ALONG,
    )


ROD = arc(SPRING * STEP, 60.0)
#: Angles at which springs are relaxed, from the segment before.
BENDS = (ANGLE / 2, *(ANGLE,) * (COUNT - 1))


def chain(posed: tuple[float, ...], rest: tuple[float, ...], unit: str, ref: float, more: str = "") -> str:
    """A row of rods along x; each is turned by `posed` in the file, its spring relaxed at `rest` beyond."""
    scale = 1.0 if unit == "radian" else 180.0 / math.pi
    text = ""
    for i in reversed(range(COUNT)):
        place = f'<body name="b{i}" pos="{STEP if i else 0.0} 0 0" euler="0 0 {posed[i] * scale!r}">'
        spring = f'stiffness="{SPRING}" ref="{ref * scale!r}" springref="{(ref + rest[i]) * scale!r}"'
        inertia = f'mass="{MASS}" diaginertia="2e-5 {MASS * STEP**2 / 12!r} {MASS * STEP**2 / 12!r}"'
        text = (
            f'{place}<joint name="j{i}" axis="0 0 1" {spring}{more}/>'
            f'<inertial pos="{STEP / 2} 0 0" {inertia}/>{text}</body>'
        )
    return (
        f'<mujoco><compiler angle="{unit}"/><option gravity="0 0 0"/><worldbody>{text}</worldbody></mujoco>'
    )


def mujoco_frequencies(text: str) -> Array:
    """ω of hinges about where their springs are relaxed."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos_spring
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qfrc_passive, 0.0, atol=1e-9)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    springs = [np.ravel(model.jnt_stiffness[joint])[0] for joint in model.dof_jntid]
    return np.sqrt(scipy.linalg.eigh(np.diag(springs), mass, eigvals_only=True))


def zeros() -> tuple[float, ...]:
    return (0.0,) * COUNT


@pytest.mark.parametrize(("unit", "ref"), [("radian", 0.0), ("degree", 0.3)])
def test_curved_and_straight_chains_ring_as_in_mujoco(unit: str, ref: float, tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    back = tuple(-bend for bend in BENDS)
    by_poses = bm.audit_file(write(path, chain(BENDS, zeros(), unit, ref)), ROD, motion="space")
    for posed, rest in ((zeros(), BENDS), (BENDS, zeros()), (tuple(2 * b for b in BENDS), back)):
        text = chain(posed, rest, unit, ref)
        found = bm.audit_file(write(path, text), ROD, motion="space")
        np.testing.assert_allclose(found.angular_frequency, by_poses.angular_frequency, rtol=1e-9)
        np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:3], rtol=1e-9)
        assert any("springs are relaxed away" in line for line in found.given) == any(rest)
        with pytest.raises(BadModel, match=r'on one straight line.*motion="space".*--shape "arc'):
            bm.audit_file(path, BEAM)
    bent = chain(BENDS, back, unit, ref)
    straight = bm.audit_file(write(path, bent), BEAM)
    np.testing.assert_allclose(straight.angular_frequency, mujoco_frequencies(bent)[:3], rtol=1e-9)
    plain = bm.audit_file(write(path, chain(zeros(), zeros(), unit, ref)), BEAM)
    np.testing.assert_allclose(straight.errors, plain.errors, atol=1e-10)
    assert straight.layout == plain.layout
    assert "without gravity" in straight.text and "j1 -8.594 deg" in straight.text


def write(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_joints_of_one_node_turn_one_after_the_other(tmp_path: Path) -> None:
    """Hinges about two axes, balls and a slide, at random angles and places."""
    rng = np.random.default_rng(7)
    text = ""
    for i in reversed(range(5)):
        turn = " ".join(repr(each) for each in (np.eye(4)[0] + 0.1 * rng.standard_normal(4)).tolist())
        joints = "".join(
            f'<joint axis="{axis}" pos="0 {rng.uniform(0.0, 0.01)!r} 0" '
            f'stiffness="{rng.uniform(5.0, 40.0)!r}" '
            f'ref="{rng.uniform(-9.0, 9.0)!r}" springref="{rng.uniform(-9.0, 9.0)!r}"/>'
            for axis in ("0 0 1", "0 1 0.2")
        )
        joints = '<joint type="ball" stiffness="20" springref="4"/>' if i == 2 else joints
        if i == 3:
            joints += '<joint type="slide" axis="0 1 0" stiffness="900" springref="0.02" ref="0.005"/>'
        own = '<inertial pos="0.05 0.01 0" mass="0.06" diaginertia="2e-5 5e-5 6e-5"/>'
        text = f'<body pos="{0.1 if i else 0.0} 0 0" quat="{turn}">{joints}{own}{text}</body>'
    text = f'<mujoco><option gravity="0 0 0"/><worldbody>{text}</worldbody></mujoco>'
    found = bm.audit_file(write(tmp_path / "m.xml", text), ROD, motion="space", modes=9)
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:9], rtol=1e-9)


def test_one_plane_is_judged_beside_the_rod_in_that_plane(tmp_path: Path) -> None:
    """Out of its plane the rod rings lower, where such a chain has no hinges; EI is not that of twist.

    The truth is a chain of many segments, of hinges in that plane: the errors of N = 8 are its own.
    """
    path = write(tmp_path / "m.xml", chain(zeros(), BENDS, "radian", 0.0))
    found = bm.audit_file(path, ROD, motion="space")
    assert found.layout == "naive" and "in its own plane only" in found.text
    other = bm.audit_file(path, arc(1.0, 1.0), motion="space")
    np.testing.assert_allclose(other.errors, found.errors, atol=1e-7)
    # Planar modes of fine chains of three hinges a node, whose other springs are stiff.
    stiff = arc(1e8, 1e8)
    fine = bm.spatial_modes(bm.SpatialChain(stiff, "clamped-free", 60, "gregory"), 3).angular_frequency
    np.testing.assert_allclose(found.angular_frequency / fine - 1, found.errors, atol=1e-3)


def test_what_springs_do_not_set_stays(tmp_path: Path) -> None:
    """A joint without a spring, a ball, stops about the rest, tendons and loops."""
    text = chain(zeros(), BENDS, "radian", 0.0)
    path = tmp_path / "model.xml"
    limited = text.replace("/><inertial", ' range="0.01 0.4" limited="true"/><inertial')
    assert "springs are relaxed" in bm.audit_file(write(path, limited), ROD, motion="space").text
    stopped = text.replace("/><inertial", ' range="-0.1 0.1" limited="true"/><inertial')
    with pytest.raises(BadModel, match="at rest within its range"):
        bm.audit_file(write(path, stopped), ROD, motion="space")
    loop = text.replace("</mujoco>", '<equality><connect body1="b7" anchor="0 0 0"/></equality></mujoco>')
    with pytest.raises(BadModel, match="closes a loop"):
        bm.audit_file(write(path, loop), ROD, "clamped-free", motion="space")
    # A slide in place of a hinge: a row with fewer hinges than nodes.
    shifted = text.replace('springref="0.15"/>', 'springref="0.15" type="slide"/>', 2)
    assert bm.audit_file(write(path, shifted), ROD, motion="space").layout == "no known layout"
    tie = '<tendon><fixed stiffness="3"><joint joint="j0" coef="1"/></fixed></tendon></mujoco>'
    with pytest.raises(BadModel, match="as long in the file's pose"):
        bm.audit_file(write(path, text.replace("</mujoco>", tie)), ROD, "clamped-free", motion="space")
    loose = chain(zeros(), zeros(), "radian", 0.0).replace(
        f'stiffness="{SPRING}" ref="0.0" springref="0.0"', 'springref="0.4"', 1
    )
    assert "relaxed" not in bm.audit_file(write(path, loose), BEAM).text


def sdf(rest: float) -> str:
    """A row of links along x, all springs relaxed at `rest`, after a first at half of it."""
    inertia = MASS * STEP**2 / 12
    links = "".join(
        f'<link name="l{i}"><pose>{i * STEP} 0 0 0 0 0</pose><inertial><pose>{STEP / 2} 0 0 0 0 0</pose>'
        f"<mass>{MASS}</mass><inertia><ixx>2e-5</ixx><iyy>{inertia!r}</iyy><izz>{inertia!r}</izz></inertia>"
        "</inertial></link>"
        for i in range(COUNT)
    )
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent>{f"l{i - 1}" if i else "world"}</parent>'
        f"<child>l{i}</child><axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>{SPRING}</spring_stiffness>"
        f"<spring_reference>{rest if i else rest / 2!r}</spring_reference></dynamics></axis></joint>"
        for i in range(COUNT)
    )
    return f'<sdf version="1.9"><model name="m">{links}{joints}</model></sdf>'


def test_sdformat_rings_as_in_drake(tmp_path: Path) -> None:
    path = write(tmp_path / "model.sdf", sdf(ANGLE))
    found = bm.audit_file(path, ROD, motion="space")
    same = bm.audit_file(write(tmp_path / "m.xml", chain(zeros(), BENDS, "radian", 0.0)), ROD, motion="space")
    np.testing.assert_allclose(found.angular_frequency, same.angular_frequency, rtol=1e-9)
    plant_of = pytest.importorskip("pydrake.multibody.plant")
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = plant_of.MultibodyPlant(0.0)
    parsing.Parser(plant).AddModels(str(path))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, np.array(BENDS))
    mass = plant.CalcMassMatrix(context)
    truth = np.sqrt(scipy.linalg.eigh(SPRING * np.eye(COUNT), mass, eigvals_only=True))
    np.testing.assert_allclose(found.angular_frequency, truth[:3], rtol=1e-9)


def test_springs_beside_urdf_have_their_rest(tmp_path: Path) -> None:
    (path, beside, *_) = bm.export_chain(bm.Chain(BEAM, "clamped-free", COUNT, "naive"), tmp_path / "m.urdf")
    plain = bm.audit_file(path, BEAM)
    assert "relaxed" not in plain.text
    beside.write_text(re.sub(r"rest: 0(\.0)?", f"rest: {ANGLE}", beside.read_text()))
    found = bm.audit_file(path, ROD, motion="space")
    assert "springs are relaxed away" in found.text
    with pytest.raises(BadModel, match='motion="space"'):
        bm.audit_file(path, BEAM)
