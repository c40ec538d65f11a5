"""Chains of structures as files: MuJoCo, Drake and Pinocchio find the chain's frequencies in them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import scipy.linalg
from random_structures import structure
from test_engines import (
    drake_matrices,
    elastic_frequencies,
    pinocchio_matrices,
    springs_of,
    tendon_arms,
)

import beammodes as bm

UNIT, INF = bm.Beam.unit(), math.inf
SIDE = bm.Beam(math.hypot(0.6, 0.3), 0.7, 2.0)
BODY = {"mass": 0.5, "rotary_inertia": 0.02, "offset": (-0.05, 0.1)}
FOOT = bm.Joint(0, 0, "clamped")
STATIONS = (bm.Station(0.4, hinge=0.0), bm.Station(0.6, 0.0, 0.0, 0.1, 0.01, 0.1))
TREES = {
    "L with a pin and a body": bm.Structure(
        {"foot": FOOT, "corner": bm.Joint(0, 1), "tip": bm.Joint(1, 1, mass=0.2)},
        [bm.Member(UNIT, "foot", "corner"), bm.Member(UNIT, "corner", "tip", stations=STATIONS)],
    ),
    "T": bm.Structure(
        {
            "foot": FOOT,
            "top": bm.Joint(0, 1, rotary_inertia=1e-3),
            "left": bm.Joint(-0.6, 1.3, **BODY),
            "right": bm.Joint(1, 1),
        },
        [bm.Member(UNIT, "foot", "top"), bm.Member(SIDE, "top", "left"), bm.Member(UNIT, "top", "right")],
    ),
    "arm with a sprung elbow": bm.Structure(
        {
            "shoulder": bm.Joint(0, 0, "pinned", rotary_inertia=0.1),
            "elbow": bm.Joint(1, 0, mass=0.1, rotary_inertia=0.01),
            "hand": bm.Joint(1, -1, mass=0.3),
        },
        [bm.Member(UNIT, "shoulder", "elbow"), bm.Member(UNIT, "elbow", "hand", start_hinge=5.0)],
    ),
}
AFLOAT = bm.Structure({"a": bm.Joint(0, 0), "b": bm.Joint(1, 0)}, [bm.Member(UNIT, "a", "b")])
ON_A_SPRING = bm.Structure.of_beam(UNIT, (bm.End(3.0, 2.0, 0.1, 0.01), "free"))


PORTAL = bm.Structure(
    {"a": FOOT, "b": bm.Joint(0, 1), "c": bm.Joint(1, 1, mass=0.3), "d": bm.Joint(1, 0, (INF, INF, 4.0))},
    [bm.Member(UNIT, "a", "b"), bm.Member(UNIT, "b", "c"), bm.Member(UNIT, "c", "d")],
)
SLIDES = {
    "a": bm.Joint(0, 0, "pinned"),
    "b": bm.Joint(0, 1),
    "c": bm.Joint(1, 1, (3.0, 20.0, INF), 0.3),
    "d": bm.Joint(1, 0, (0.0, 5.0, 2.0)),
}
#: Closed by loops, by supports in one direction, by springs to the ground; three hinges about no inertia.
CLOSED = {
    "portal": PORTAL,
    "sliding portal": bm.Structure(SLIDES, PORTAL.members),
    "on slopes": bm.Structure(
        {name: replace(joint, angle=0.4) for name, joint in SLIDES.items()}, PORTAL.members
    ),
    "star": bm.Structure({**TREES["T"].joints, "top": bm.Joint(0, 1)}, TREES["T"].members),
    **{
        pair: bm.Structure.of_beam(UNIT, pair, [bm.Station(0.4, INF), bm.Station(0.7, 30.0, 2.0)])
        for pair in ("clamped-clamped", "free-clamped", "pinned-guided", "free-free")
    },
    **{f"random {seed}": structure(seed) for seed in range(6)},
}


def mujoco_matrices(mujoco: Any, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """M and K of what the constraints leave: their Jacobian is the engine's own."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    arms = tendon_arms(model, data)
    stiffness = np.diag(np.array(model.jnt_stiffness)) + arms.T @ (model.tendon_stiffness[:, None] * arms)
    rows = np.array(data.efc_J).reshape(-1, model.nv)
    free = scipy.linalg.null_space(rows, rcond=1e-9) if len(rows) else np.eye(model.nv)
    return free.T @ mass @ free, free.T @ stiffness @ free


@pytest.mark.parametrize("rule", ["gregory", "half_stub_corrected"])
def test_mujoco_finds_the_frequencies(rule: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    trees = (*TREES.values(), AFLOAT, ON_A_SPRING)
    for given in (*trees, *CLOSED.values()):
        chain = bm.StructureChain(given, [4] * len(given.parts.stretches), rule)
        (path,) = bm.export_chain(chain, tmp_path / "tree.xml", force=True)
        known = bm.structure_chain_modes(chain)
        mass, stiffness = mujoco_matrices(mujoco, path)
        assert len(mass) == known.elastic_modes + known.rigid_body_modes
        found = elastic_frequencies(mass, stiffness, known.elastic_modes)
        np.testing.assert_allclose(found, known.angular_frequency, rtol=1e-8)
        root = ElementTree.parse(path).getroot()
        if given in trees:
            assert root.find("equality") is None and root.find("tendon") is None
        # Half of what RK4 is stable to, rounded down, or less where that keeps the first frequency.
        step = float(root.find("option").attrib["timestep"])
        assert 0.0 < step <= math.sqrt(2) / known.angular_frequency[-1]


def test_a_portal_rings_in_mujoco(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    chain = bm.StructureChain(PORTAL, [4, 4, 4])
    (path,) = bm.export_chain(chain, tmp_path / "portal.xml")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    free = scipy.linalg.null_space(np.array(data.efc_J).reshape(-1, model.nv), rcond=1e-9)
    _, shapes = scipy.linalg.eigh(*mujoco_matrices(mujoco, path)[::-1])
    shape = free @ shapes[:, 0]
    data.qpos[:] = 1e-3 * shape / np.abs(shape).max()
    start, crossings, step = data.qpos.copy(), list[float](), model.opt.timestep
    before = float(start @ start)
    for k in range(int(2.9 / bm.structure_chain_modes(chain, 1).frequency[0] / step)):
        mujoco.mj_step(model, data)
        now = float(data.qpos @ start)
        if before > 0.0 >= now:
            crossings.append(step * (k + before / (before - now)))
        before = now
    periods = np.diff(crossings)
    # The head of the file says 0.01 %.
    np.testing.assert_allclose(1 / periods, bm.structure_chain_modes(chain, 1).frequency[0], rtol=1e-4)


def test_dampers_gravity_and_steps_are_in_the_files(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    chain, damping, load = (
        bm.StructureChain(PORTAL, [4, 4, 4]),
        bm.Damping(stiffness=2e-3),
        bm.Load(gravity=9.81),
    )
    options: dict[str, Any] = {"damping": damping, "load": load}
    (path,) = bm.export_chain(
        chain, tmp_path / "portal.xml", integrator="implicitfast", timestep=1e-4, **options
    )
    model = mujoco.MjModel.from_xml_path(str(path))
    assert model.opt.timestep == 1e-4 and model.opt.gravity.tolist() == [0.0, 0.0, -9.81]
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for dampers, springs in (
        (model.dof_damping, model.jnt_stiffness),
        (model.tendon_damping, model.tendon_stiffness),
    ):
        np.testing.assert_allclose(dampers.ravel(), 2e-3 * springs, rtol=1e-12)
    assert (model.tendon_damping > 0.0).any()
    # Under the engine's own gravity the model sags as the chain's statics say, in the middle of the beam.
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rows = np.array(data.efc_J).reshape(-1, model.nv)
    free = scipy.linalg.null_space(rows, rcond=1e-9)
    _, stiffness = mujoco_matrices(mujoco, path)
    moved = free @ np.linalg.solve(stiffness, free.T @ -data.qfrc_bias)
    middle = np.array([0.5, 0.0, 1.0])
    body = int(np.argmin(np.linalg.norm(data.xpos - middle, axis=1)))
    arm = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, arm, None, middle, body)
    sag = bm.structure_chain_statics(chain, load).deflection(0.5, "b-c")
    assert (arm @ moved)[2] == pytest.approx(sag, rel=1e-8) and sag < 0.0
    (sdf,) = bm.export_chain(chain, tmp_path / "portal.sdf", **options)
    world = ElementTree.parse(sdf).getroot().find("world")
    assert [float(g) for g in world.find("physics/gravity").text.split()] == [0.0, 0.0, -9.81]
    pairs = [(one.find("damping").text, one.find("spring_stiffness").text) for one in world.iter("dynamics")]
    np.testing.assert_allclose([float(d) for d, _ in pairs], [2e-3 * float(k) for _, k in pairs], rtol=1e-12)


def sdf_matrices(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """M and K of an SDFormat file as it reads: x, z and angle of each link, and joints as constraints."""
    world = ElementTree.parse(path).getroot().find("world/model")
    links = {link.attrib["name"]: k for k, link in enumerate(world.findall("link"))}
    numbers = [[float(x) for x in one.text.split()] for one in world.findall("link/pose")]
    origin = {name: np.array([numbers[k][0], numbers[k][2]]) for name, k in links.items()}
    mass, stiffness, rows = np.zeros((3 * len(links),) * 2), np.zeros((3 * len(links),) * 2), []
    for k in links.values():
        inertial = world.findall("link")[k].find("inertial")
        x, _, z, *_ = map(float, inertial.find("pose").text.split())
        arm = np.zeros((3, 3 * len(links)))
        arm[:, 3 * k : 3 * k + 3] = [[1, 0, -z], [0, 1, x], [0, 0, 1]]
        weight, moment = float(inertial.find("mass").text), float(inertial.find("inertia/iyy").text)
        mass += arm.T @ np.diag([weight, weight, moment]) @ arm
    for joint in world.findall("joint"):
        child, parent = joint.find("child").text, joint.find("parent").text
        pose = joint.find("pose")
        at = origin[child] + ([0, 0] if pose is None else np.array(pose.text.split(), float)[[0, 2]])
        apart = np.zeros((3, 3 * len(links)))
        for sign, name in ((1, child), (-1, parent)):
            if name != "world":
                (x, z), k = at - origin[name], links[name]
                apart[:, 3 * k : 3 * k + 3] += sign * np.array([[1, 0, -z], [0, 1, x], [0, 0, 1]])
        rows += list(apart[:2])
        spring = float(joint.find("axis/dynamics/spring_stiffness").text)
        stiffness += spring * np.outer(apart[2], apart[2])
    free = scipy.linalg.null_space(np.array(rows), rcond=1e-9)
    return free.T @ mass @ free, free.T @ stiffness @ free


def test_sdf_closes_loops_by_joints(tmp_path: Path) -> None:
    for given in (PORTAL, TREES["L with a pin and a body"]):
        for rule in ("gregory", "rigid_stub"):
            chain = bm.StructureChain(given, [4] * len(given.parts.stretches), rule)
            (path,) = bm.export_chain(chain, tmp_path / "frame.sdf", force=True)
            known = bm.structure_chain_modes(chain)
            found = elastic_frequencies(*sdf_matrices(path), known.elastic_modes)
            np.testing.assert_allclose(found, known.angular_frequency, rtol=1e-8)


@pytest.mark.filterwarnings("ignore")
def test_drake_and_pinocchio_find_them_too(tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    pinocchio = pytest.importorskip("pinocchio")
    for given in TREES.values():
        chain = bm.StructureChain(given, [3] * len(given.parts.stretches))
        known = bm.structure_chain_modes(chain)
        (sdf,) = bm.export_chain(chain, tmp_path / "tree.sdf", force=True)
        urdf, yaml = bm.export_chain(chain, tmp_path / "tree.urdf", force=True)
        springs = springs_of(yaml)
        for mass, stiffness in (
            drake_matrices(sdf, {}),
            pinocchio_matrices(pinocchio, pinocchio.buildModelFromUrdf(str(urdf)), springs),
        ):
            found = elastic_frequencies(mass, stiffness, known.elastic_modes)
            np.testing.assert_allclose(found, known.angular_frequency, rtol=1e-8)


def test_what_a_format_cannot_hold_is_refused(tmp_path: Path) -> None:
    roller = bm.StructureChain(bm.Structure.of_beam(UNIT, "clamped-pinned"), 4)
    star = bm.StructureChain(CLOSED["star"], 9)
    for chain in (roller, star):
        for suffix in ("sdf", "urdf"):
            with pytest.raises(ValueError, match="held along x and y or not at all, and no three hinges"):
                bm.export_chain(chain, tmp_path / f"frame.{suffix}")
    with pytest.raises(ValueError, match="chain must be a tree, supported at one joint, for urdf files"):
        bm.export_chain(bm.StructureChain(PORTAL, 12), tmp_path / "frame.urdf")
    with pytest.raises(ValueError, match="clamped or pinned at its root for sdf files"):
        bm.export_chain(bm.StructureChain(AFLOAT, 3), tmp_path / "tree.sdf")
    for wrong, message in (
        ({"units": "SI"}, "units must be left out of files of structures"),
        ({"timestep": 1.0}, "timestep must be less than"),
        ({"load": bm.Load(axial_force=1.0)}, "load must be gravity only in a file of a structure"),
        ({"damping": bm.Damping(mass=1.0)}, "damping must have mass=0"),
        ({"damping": bm.Damping(joint=1.0)}, "damping must be without dampers of joints"),
    ):
        with pytest.raises(ValueError, match=message):
            bm.export_chain(bm.StructureChain(AFLOAT, 3), tmp_path / "tree.xml", **wrong)
    rigid = bm.StructureChain(bm.Structure.of_beam(UNIT, "clamped-clamped"), 3, "rigid_stub")
    with pytest.raises(ValueError, match="chain must have an elastic mode for files"):
        bm.export_chain(rigid, tmp_path / "tree.xml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf"])
def test_no_name_ends_a_comment(suffix: str, tmp_path: Path) -> None:
    joints = {"a---b\nmodel: other": FOOT, "-->": bm.Joint(0, 1)}
    chain = bm.StructureChain(bm.Structure(joints, [bm.Member(UNIT, *joints)]), 2, bm.Rule("x---", ["1/2"]))
    path, *beside = bm.export_chain(chain, tmp_path / f"tree{suffix}")
    ElementTree.parse(path)
    if beside:
        lines = beside[0].read_text("utf-8").splitlines()
        assert [line for line in lines if line.startswith("model:")] == ['model: "chain"']
