"""What the pages say of engines' time steps and readers, by running them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

CHAIN = Chain(Beam(1.2, 85.0, 0.62), "clamped-free", segments=10, rule="gregory")
MODES = solve_modes(linearize(CHAIN))
#: Joint angles of mode 1 at the hinges, which are the engines' coordinates.
BENT = 1e-3 * np.diff(MODES.rotation[0], prepend=0.0)[-10:]
EXPLICIT = stable_time_step(CHAIN, "semi_implicit_euler")


def mujoco_motion(folder: Path, integrator: str, step: float, steps: int) -> tuple[Any, np.ndarray]:
    """The first joint's angle over time, from a start at rest in mode 1 and a little of all others."""
    mujoco = pytest.importorskip("mujoco")
    if not hasattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"):
        pytest.skip(f"this MuJoCo has no integrator {integrator}")
    export_chain(CHAIN, folder / "beam.xml", force=True)
    model = mujoco.MjModel.from_xml_path(str(folder / "beam.xml"))
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[:] = BENT + 1e-9 * (-1.0) ** np.arange(10)
    motion = np.empty(steps)
    for k in range(steps):
        motion[k] = data.qpos[0]
        mujoco.mj_step(model, data)
    return data, motion


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast"])
def test_mujocos_springs_are_explicit(
    integrator: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # for the log file of its warnings
    data, motion = mujoco_motion(tmp_path, integrator, 0.98 * EXPLICIT, 2000)
    assert np.abs(motion).max() < 1.01 * abs(BENT[0])
    assert not any(warning.number for warning in data.warning)
    # MuJoCo's default step: it warns, and sets all back to rest.
    data, motion = mujoco_motion(tmp_path, integrator, 0.002, 2000)
    assert any(warning.number for warning in data.warning)
    assert motion[-1] == 0.0


def test_mujocos_discrete_integrator_damps_by_half_of_h_omega(tmp_path: Path) -> None:
    step, omega = 0.002, MODES.angular_frequency[0]
    data, motion = mujoco_motion(tmp_path, "discrete", step, int(3.2 * 2 * math.pi / (0.002 * omega)))
    assert not any(warning.number for warning in data.warning)
    tops = motion[1:-1][(motion[1:-1] > motion[:-2]) & (motion[1:-1] > motion[2:])]
    ratio = math.log(tops[0] / tops[-1]) / (2 * math.pi * (len(tops) - 1))
    assert ratio == pytest.approx(step * omega / 2, rel=0.08)


def drake_plant(path: Path, step: float) -> Any:
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = pytest.importorskip("pydrake.multibody.plant").MultibodyPlant(step)
    parsing.Parser(plant).AddModels(str(path))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    plant.Finalize()
    return plant


def largest_joint_angle(folder: Path, step: float) -> float:
    """Of Drake's discrete plant after 400 steps from mode 1."""
    pytest.importorskip("pydrake")
    (path,) = export_chain(CHAIN, folder / "beam.sdf")
    plant = drake_plant(path, step)
    simulator = pytest.importorskip("pydrake.systems.analysis").Simulator(plant)
    context = simulator.get_mutable_context()
    plant.SetPositions(context, BENT + 1e-9 * (-1.0) ** np.arange(10))
    simulator.AdvanceTo(400 * step)
    return float(np.abs(plant.GetPositions(context)).max())


@pytest.mark.filterwarnings("ignore")
def test_drakes_discrete_plant_is_stable_below_two_over_omega(tmp_path: Path) -> None:
    assert largest_joint_angle(tmp_path, 0.98 * EXPLICIT) < 1.01 * np.abs(BENT).max()


@pytest.mark.filterwarnings("ignore")
def test_drakes_discrete_plant_is_unstable_beyond(tmp_path: Path) -> None:
    # It grows until the contact solver meets a NaN.
    with pytest.raises(RuntimeError, match="NaN"):
        largest_joint_angle(tmp_path, 1.05 * EXPLICIT)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("suffix", "springs"), [(".sdf", 10), (".urdf", 0), (".xml", 0)])
def test_drake_has_springs_from_sdformat_only(suffix: str, springs: int, tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    path, *_ = export_chain(CHAIN, tmp_path / f"beam{suffix}")
    plant = drake_plant(path, 0.0)
    # Gravity is a force element too.
    assert (plant.num_positions(), plant.num_force_elements()) == (10, 1 + springs)


def test_pinocchios_wheel_reads_urdf_only(tmp_path: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    path, _ = export_chain(CHAIN, tmp_path / "beam.urdf")
    assert pinocchio.buildModelFromUrdf(str(path)).nv == 10
    if not pinocchio.WITH_SDFORMAT:
        assert not hasattr(pinocchio, "buildModelFromSdf")
