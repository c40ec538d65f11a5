"""Trees of structures as files: MuJoCo, Drake and Pinocchio find the chain's frequencies in them."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from test_engines import drake_matrices, elastic_frequencies, pinocchio_matrices, springs_of

import beammodes as bm

UNIT = bm.Beam.unit()
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


@pytest.mark.parametrize("rule", ["gregory", "half_stub_corrected"])
def test_mujoco_finds_the_frequencies(rule: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    for given in (*TREES.values(), AFLOAT, ON_A_SPRING):
        chain = bm.StructureChain(given, [4] * len(given.parts.stretches), rule)
        (path,) = bm.export_chain(chain, tmp_path / "tree.xml", force=True)
        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        known = bm.structure_chain_modes(chain)
        assert model.nv == known.elastic_modes + known.rigid_body_modes
        found = elastic_frequencies(mass, np.diag(np.array(model.jnt_stiffness)), known.elastic_modes)
        np.testing.assert_allclose(found, known.angular_frequency, rtol=1e-8)
        assert model.opt.timestep == pytest.approx(math.sqrt(2) / known.angular_frequency[-1])


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


def test_what_is_no_tree_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "tree.xml"
    held_twice = bm.StructureChain(bm.Structure.of_beam(UNIT, "clamped-pinned"), 4)
    with pytest.raises(ValueError, match="to be a tree, got supports at left, right"):
        bm.export_chain(held_twice, path)
    joints = {"a": FOOT, "b": bm.Joint(1, 0), "c": bm.Joint(0, 1)}
    slope = bm.Beam(math.sqrt(2), 1.0, 1.0)
    sides = [bm.Member(UNIT, "a", "b"), bm.Member(slope, "b", "c"), bm.Member(UNIT, "a", "c")]
    with pytest.raises(ValueError, match="got a closed frame"):
        bm.export_chain(bm.StructureChain(bm.Structure(joints, sides), 6), path)
    star = bm.Structure({**TREES["T"].joints, "top": bm.Joint(0, 1)}, TREES["T"].members)
    with pytest.raises(ValueError, match="take a rule whose hinges are off the joints"):
        bm.export_chain(bm.StructureChain(star, 9), path)
    with pytest.raises(ValueError, match="clamped or pinned at its root for sdf files"):
        bm.export_chain(bm.StructureChain(AFLOAT, 3), tmp_path / "tree.sdf")
    with pytest.raises(ValueError, match="timestep must be left out of files of structures"):
        bm.export_chain(bm.StructureChain(AFLOAT, 3), path, timestep=1e-3)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf"])
def test_no_name_ends_a_comment(suffix: str, tmp_path: Path) -> None:
    joints = {"a---b\nmodel: other": FOOT, "-->": bm.Joint(0, 1)}
    chain = bm.StructureChain(bm.Structure(joints, [bm.Member(UNIT, *joints)]), 2, bm.Rule("x---", ["1/2"]))
    path, *beside = bm.export_chain(chain, tmp_path / f"tree{suffix}")
    ElementTree.parse(path)
    if beside:
        lines = beside[0].read_text("utf-8").splitlines()
        assert [line for line in lines if line.startswith("model:")] == ["model: chain"]
