"""Chains in space as files, read back by MuJoCo, Pinocchio and Drake: matrices, and shapes under load."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shared_cases import BEND, ROUND

import beammodes as bm

POLAR = {**ROUND, "polar_inertia_per_length": 1e-4}
RODS = {
    "straight": bm.Rod(1.0, **POLAR),
    "blade": bm.Rod.pretwisted(1.5, length=1.0, second_bending_stiffness=9.0, **POLAR),
    "arc": bm.Rod.arc(1.5, length=1.0, **POLAR),
    "helix": bm.Rod(1.0, curvature=(1.0, 0.5, 2 * math.pi), **POLAR),
}


def read(chain: bm.SpatialChain, folder: Path, **options: Any) -> tuple[Any, Any, Any]:
    mujoco = pytest.importorskip("mujoco")
    (path,) = bm.export_chain(chain, folder / "chain.xml", force=True, **options)
    model = mujoco.MjModel.from_xml_path(str(path))
    return mujoco, model, mujoco.MjData(model)


def joint_mass(chain: bm.SpatialChain) -> NDArray[np.float64]:
    """The mass matrix of turns about the joints' axes at rest, summed piece by piece."""
    tree = chain.tree
    twists = np.zeros((tree.pieces, 6, 3 * (tree.pieces - 1)))
    for i in range(1, tree.pieces):
        twists[i] = twists[i - 1]
        twists[i, :, 3 * i - 3 : 3 * i] += tree.joint_twists[i]
    images = tree.mass_root @ twists
    return np.einsum("pik,pil->kl", images, images)


@pytest.mark.parametrize("name", RODS)
def test_mass_and_stiffness_of_a_rod_in_mujoco(name: str, tmp_path: Path) -> None:
    for rule in ("gregory", "half_stub"):
        chain = bm.SpatialChain(RODS[name], "clamped-free", 8, rule)
        mujoco, model, data = read(chain, tmp_path, joints="xyz")
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        ours = joint_mass(chain)
        np.testing.assert_allclose(mass, ours, atol=1e-11 * np.abs(ours).max())
        np.testing.assert_allclose(model.jnt_stiffness, chain.joint_stiffness.ravel(), rtol=1e-14)
        root = model.jnt_stiffness**-0.5
        omega = np.linalg.eigvalsh(root[:, None] * mass * root)[::-1][:3] ** -0.5
        np.testing.assert_allclose(omega, bm.spatial_modes(chain, 3).angular_frequency, rtol=1e-11)


def in_our_order(names: list[str]) -> list[int]:
    """Where our coordinates, about x, y and z of each joint, are among joints of these names."""
    words = [name.split("_")[-2:] for name in names]
    return sorted(range(len(names)), key=lambda k: (int(words[k][0]), words[k][1]))


@pytest.mark.parametrize("name", RODS)
def test_mass_and_stiffness_of_a_rod_in_pinocchio(name: str, tmp_path: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    yaml = pytest.importorskip("yaml")
    # Hinges in alternating orders have the same axes at rest.
    for rule in ("gregory", "half_stub"):
        chain = bm.SpatialChain(RODS[name], "clamped-free", 8, rule)
        urdf, beside = bm.export_chain(chain, tmp_path / "chain.urdf", force=True)
        model = pinocchio.buildModelFromUrdf(str(urdf))
        mass = np.triu(pinocchio.crba(model, model.createData(), pinocchio.neutral(model)))
        mass += np.triu(mass, 1).T
        order = in_our_order(list(model.names)[1:])
        ours = joint_mass(chain)
        np.testing.assert_allclose(mass[np.ix_(order, order)], ours, atol=1e-8 * np.abs(ours).max())
        springs = yaml.safe_load(beside.read_text())["springs"]
        read = [springs[k]["stiffness"] for k in in_our_order([spring["joint"] for spring in springs])]
        np.testing.assert_allclose(read, chain.joint_stiffness.ravel(), rtol=1e-14)


@pytest.mark.parametrize("suffix", [".sdf", ".urdf"])
def test_drake_reads_a_helix(suffix: str, tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = pytest.importorskip("pydrake.multibody.plant").MultibodyPlant(0.0)
    chain = bm.SpatialChain(RODS["helix"], "clamped-free", 6, "gregory")
    (path, *_) = bm.export_chain(chain, tmp_path / f"chain{suffix}")
    parsing.Parser(plant).AddModels(str(path))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    mass = plant.CalcMassMatrix(context)
    indices = plant.GetJointIndices()
    joints = [plant.get_joint(index) for index in indices if plant.get_joint(index).num_velocities()]
    order = [joints[k].velocity_start() for k in in_our_order([joint.name() for joint in joints])]
    ours = joint_mass(chain)
    np.testing.assert_allclose(mass[np.ix_(order, order)], ours, atol=1e-8 * np.abs(ours).max())
    if suffix == ".sdf":
        forces = pytest.importorskip("pydrake.multibody.tree").MultibodyForces(plant)
        plant.SetPositions(context, np.full(plant.num_positions(), 1e-3))
        plant.CalcForceElementsContribution(context, forces)
        read = -forces.generalized_forces()[order] / 1e-3
        np.testing.assert_allclose(read, chain.joint_stiffness.ravel(), rtol=1e-12)


@pytest.mark.parametrize("joints", ["ball", "xyz", "yzx_alternating"])
def test_a_bent_shape_is_at_rest_in_mujoco(joints: str, tmp_path: Path) -> None:
    # Springs against 600 N on the tip, at our angles: what is left is rounding.
    chain = bm.SpatialChain(BEND, "clamped-free", 8, "double_wall")
    mujoco, model, data = read(chain, tmp_path, joints=joints)
    found = bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(0, 0, 600)), joints=joints)
    for k in range(model.njnt):
        words = model.joint(k).name.split("_")
        at = model.jnt_qposadr[k]
        if joints == "ball":
            vector = found.coordinates[int(words[-1])]
            half = np.linalg.norm(vector) / 2
            data.qpos[at : at + 4] = math.cos(half), *(np.sinc(half / math.pi) / 2 * vector)
        else:
            data.qpos[at] = found.coordinates[int(words[-2]), "xyz".index(words[-1])]
    mujoco.mj_forward(model, data)
    # A capsule's middle is half-way from its body's joint to the tip.
    tip = 2 * data.geom_xpos[-1] - data.xpos[-1]
    np.testing.assert_allclose(tip, found.tip, atol=1e-9)
    arms = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, arms, None, tip, model.nbody - 1)
    left = data.qfrc_passive + arms.T @ [0.0, 0.0, 600.0]
    assert np.abs(left).max() < 1e-10 * 600 * BEND.length


def test_a_free_chain_with_bodies_and_what_a_file_cannot_hold(tmp_path: Path) -> None:
    body = bm.RodEnd(mass=0.5, rotary_inertia=(0.02, 0.03, 0.04), offset=(0.1, 0.05, 0.0))
    chain = bm.SpatialChain(RODS["helix"], ("free", body), 5, "gregory")
    mujoco, model, data = read(chain, tmp_path)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    stiffness = np.concatenate([np.zeros(6), model.jnt_stiffness[1:]])
    square = np.sort(np.linalg.eigvals(np.linalg.solve(mass, np.diag(stiffness))).real)[6:]
    known = bm.spatial_modes(chain, 3).angular_frequency
    np.testing.assert_allclose(np.sqrt(square[:3]), known, rtol=1e-9)
    with pytest.raises(ValueError, match="mjcf files can support both"):
        bm.export_chain(bm.SpatialChain(BEND, "pinned-pinned", 4), tmp_path / "a.urdf")
    with pytest.raises(ValueError, match="joints must be hinges"):
        bm.export_chain(bm.SpatialChain(RODS["helix"], "clamped-free", 4), tmp_path / "a.xml", joints="ball")
    wide = bm.Rod(1.0, **ROUND, polar_inertia_per_length=0.1)
    with pytest.raises(ValueError, match="pieces whose inertias a body can have"):
        bm.export_chain(bm.SpatialChain(wide, "clamped-free", 4), tmp_path / "a.xml")
    with pytest.raises(ValueError, match="format of a chain in space must be one of mjcf, sdf, urdf"):
        bm.export_chain(bm.SpatialChain(BEND, "clamped-free", 4), tmp_path / "a.csv")
    with pytest.raises(ValueError, match="joints must be hinges"):
        bm.export_chain(bm.SpatialChain(BEND, "clamped-free", 4), tmp_path / "a.sdf", joints="ball")
