"""What the pages say of engines' time steps and readers, by running them."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.optimize
from turns import in_turns

from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike, End
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping, joint_dampers
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

CHAIN = Chain(Beam(1.2, 85.0, 0.62), "clamped-free", segments=10, rule="gregory")
MODES = solve_modes(linearize(CHAIN))
#: Joint angles of mode 1 at the hinges, which are the engines' coordinates.
BENT = 1e-3 * np.diff(MODES.rotation[0], prepend=0.0)[-10:]
EXPLICIT = stable_time_step(CHAIN, "semi_implicit_euler")
INTEGRATORS = ("RK4", "Euler", "implicit", "implicitfast")


@pytest.fixture(autouse=True)
def logs_of_mujoco(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its warnings go to a file in the working folder."""
    monkeypatch.chdir(tmp_path)


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
def test_mujocos_springs_are_explicit(integrator: str, tmp_path: Path) -> None:
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


def drake_plant(path: Path, step: float, gravity: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Any:
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = pytest.importorskip("pydrake.multibody.plant").MultibodyPlant(step)
    parsing.Parser(plant).AddModels(str(path))
    plant.mutable_gravity_field().set_gravity_vector(gravity)
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


# --- Steps of files ------------------------------------------------------------------------------------


def mujoco_file(path: Path, integrator: str = "") -> Any:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(path))
    if integrator:
        model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    return model


def at_rest(model: Any, guess: np.ndarray) -> np.ndarray | None:
    """Joint coordinates at which nothing accelerates, under the model's gravity raised in steps."""
    import mujoco

    data, gravity = mujoco.MjData(model), model.opt.gravity.copy()

    def acceleration(place: np.ndarray) -> np.ndarray:
        data.qpos[:], data.qvel[:] = place, 0.0
        data.qacc_warmstart[:] = 0.0
        mujoco.mj_forward(model, data)
        return np.array(data.qacc)

    place = guess
    if np.any(gravity):
        for share in np.linspace(0.1, 1.0, 10):
            model.opt.gravity[:] = share * gravity
            place = scipy.optimize.root(acceleration, place, tol=1e-13).x
        if np.abs(acceleration(place)).max() > 1e-6 * (1 + np.abs(gravity).max()):
            return None
    return np.asarray(place)


def is_stable(model: Any, step: float, rest: np.ndarray, steps: int = 4000) -> bool:
    """Whether MuJoCo's motion from a millionth beside rest stays there."""
    import mujoco

    model.opt.timestep = step
    model.eq_solref[:, 0] = 2 * step
    data = mujoco.MjData(model)
    data.qpos[:] = rest + 1e-6 * np.random.default_rng(0).standard_normal(model.nv)
    for _ in range(steps // 100):
        mujoco.mj_step(model, data, nstep=100)
        if any(warning.number for warning in data.warning) or not np.abs(data.qpos - rest).max() < 1e-2:
            return False
    return bool(np.abs(data.qpos - rest).max() < 1e-3)


def largest_stable(model: Any, low: float, high: float, rest: np.ndarray, halvings: int = 9) -> float:
    """By bisection of the logarithm."""
    for _ in range(halvings):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(model, middle, rest) else (low, middle)
    return low


def written_step(path: Path) -> float:
    root = ElementTree.parse(path).getroot()
    option = root.find("option")
    return float(option.attrib["timestep"] if option is not None else str(root.findtext(".//max_step_size")))


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast"])
@pytest.mark.parametrize(
    # 2 (ζ + √(1 + ζ²))/ω_max, worked outside of this library, and measured in MuJoCo 4.0.0 by others.
    ("ratio", "formula", "measured"),
    [(0.01, 1.4902748e-3, 1.494e-3), (0.02, 2.8459770e-3, 2.862e-3), (0.1, 1.4000932e-2, 1.440e-2)],
)
def test_mujoco_takes_dampers_of_joints_implicitly(
    ratio: float, formula: float, measured: float, integrator: str, tmp_path: Path
) -> None:
    damping = joint_dampers(CHAIN, ratio)
    (path,) = export_chain(CHAIN, tmp_path / "beam.xml", damping=damping, integrator=integrator)
    limit = stable_time_step(CHAIN, f"MuJoCo {integrator}", damping=damping)
    assert limit == pytest.approx(formula, rel=1e-6)
    found = largest_stable(mujoco_file(path), formula / 2, 2 * formula, np.zeros(10))
    assert found == pytest.approx(limit, rel=0.03) and found == pytest.approx(measured, rel=0.03)
    assert limit / 3 < written_step(path) < limit


def test_explicit_runge_kutta_is_shortened_by_dampers(tmp_path: Path) -> None:
    damping = joint_dampers(CHAIN, 0.01)
    (path,) = export_chain(CHAIN, tmp_path / "beam.xml", damping=damping)
    limit = stable_time_step(CHAIN, "MuJoCo RK4", damping=damping)
    # Measured in MuJoCo 4.0.0 by others.
    assert limit == pytest.approx(1.46e-4, rel=5e-3)
    model, rest = mujoco_file(path), np.zeros(10)
    assert is_stable(model, 0.98 * limit, rest, 2000) and not is_stable(model, 1.02 * limit, rest, 2000)


HANGING = Load(gravity=(9.81, 0.0))
ROPE = Chain(Beam(4.0, 1e-3, 0.026), "pinned-free(mass=0.75)", 20)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("chain", "ratio", "integrator", "measured"),
    # Measured by others: Drake lost between 1.4e-3 and 1.6e-3 s; MuJoCo, which steps alike, the others.
    [
        (CHAIN, 0.01, "discrete", 1.494e-3),
        pytest.param(CHAIN, 0.1, "discrete", 1.440e-2, marks=pytest.mark.slow),
        (CHAIN, 0.01, "semi_explicit_euler", 9.115e-5),
        (ROPE, 0.0, "discrete", 6.6286e-3),
    ],
)
def test_drakes_steps_with_dampers_and_of_a_chain_that_hangs(
    chain: Chain, ratio: float, integrator: str, measured: float, tmp_path: Path
) -> None:
    """By bisection in discrete plants and continuous ones of fixed step."""
    analysis = pytest.importorskip("pydrake.systems.analysis")
    damping, load = joint_dampers(chain, ratio) if ratio else None, HANGING if chain is ROPE else None
    (path,) = export_chain(chain, tmp_path / "beam.sdf", damping=damping, load=load)
    limit = stable_time_step(chain, f"Drake {integrator}", damping=damping, load=load)
    assert limit == pytest.approx(measured, rel=0.03)

    def stays(step: float) -> bool:
        discrete = integrator == "discrete"
        plant = drake_plant(
            path, step if discrete else 0.0, gravity=(9.81, 0.0, 0.0) if load else (0.0, 0.0, 0.0)
        )
        simulator = analysis.Simulator(plant)
        if not discrete:
            scheme = {"integration_scheme": integrator, "use_error_control": False}
            analysis.ApplySimulatorConfig(analysis.SimulatorConfig(max_step_size=step, **scheme), simulator)
        context = simulator.get_mutable_context()
        plant.SetPositions(context, 1e-6 * np.random.default_rng(0).standard_normal(plant.num_positions()))
        try:
            for k in range(1, 11):
                simulator.AdvanceTo(150 * k * step)
                if not np.abs(plant.GetPositions(context)).max() < 1e-2:
                    return False
        except RuntimeError:  # a NaN
            return False
        return bool(np.abs(plant.GetPositions(context)).max() < 1e-3)

    low, high = 0.8 * limit, 1.3 * limit
    assert stays(low) and not stays(high)
    for _ in range(4):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stays(middle) else (low, middle)
    assert low == pytest.approx(limit, rel=0.03)
    # The file's own step is for discrete plants.
    assert integrator != "discrete" or limit / 3 < written_step(path) < limit


def test_urdf_says_the_steps_of_engines_that_read_it(tmp_path: Path) -> None:
    damping = joint_dampers(CHAIN, 0.01)
    (path, _) = export_chain(CHAIN, tmp_path / "beam.urdf", damping=damping)
    said = dict(re.findall(r"largest stable timestep in ([\w ]+): (\S+) s", path.read_text(encoding="utf-8")))
    assert float(said["PyBullet"]) == pytest.approx(9.115e-5, rel=1e-3)
    assert (
        float(said["Drake discrete"]) == float(said["Newton MuJoCo"]) == pytest.approx(1.4902748e-3, rel=1e-3)
    )
    for integrator, step in said.items():
        assert float(step) == pytest.approx(stable_time_step(CHAIN, integrator, damping=damping), rel=1e-3)


@pytest.mark.parametrize("ratio", [0.01, 0.02, 0.1])
def test_without_its_flag_eulers_dampers_are_explicit(ratio: float, tmp_path: Path) -> None:
    mujoco, damping = pytest.importorskip("mujoco"), joint_dampers(CHAIN, ratio)
    (path,) = export_chain(CHAIN, tmp_path / "beam.xml", damping=damping, integrator="Euler")
    limit = stable_time_step(CHAIN, "semi_implicit_euler", damping=damping)
    assert f"taken explicitly: {limit:.4g} s" in path.read_text(encoding="utf-8")
    model = mujoco_file(path)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    assert largest_stable(model, limit / 2, 2 * limit, np.zeros(10)) == pytest.approx(limit, rel=0.03)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_rope_that_hangs_needs_a_shorter_step(integrator: str, tmp_path: Path) -> None:
    """A tether of 4 m with 0.75 kg at its end, exported without a word of gravity, then hung up."""
    rope = ROPE
    (path,) = export_chain(rope, tmp_path / "rope.xml", integrator=integrator)
    model, rest = mujoco_file(path), np.zeros(20)
    model.opt.gravity[:] = (9.81, 0.0, 0.0)
    step, limit = written_step(path), stable_time_step(rope, f"MuJoCo {integrator}", load=HANGING)
    if integrator != "RK4":
        # Measured by others in MuJoCo: stable at 0.0066286 s.
        assert limit == pytest.approx(0.0066286, rel=1e-4)
    assert largest_stable(model, limit / 2, 2 * limit, rest) == pytest.approx(limit, rel=0.03)
    assert limit / 3 < step < limit / 2 and is_stable(model, step, rest)
    # Said, it is in the file; and so is what an unsafe step of one's own is.
    (said,) = export_chain(rope, tmp_path / "said.xml", integrator=integrator, load=HANGING)
    assert mujoco_file(said).opt.gravity.tolist() == [9.81, 0.0, 0.0]
    assert step <= written_step(said) < limit
    (own,) = export_chain(rope, tmp_path / "own.xml", integrator=integrator, timestep=0.02)
    assert "stable with gravity off only" in own.read_text(encoding="utf-8")
    assert not is_stable(model, 0.02, rest)


@pytest.mark.parametrize(
    ("ratio", "on_segment", "integrator"),
    in_turns([0.0, 0.02], [True, False], ["Euler", "implicitfast", "RK4"], every=2),
)
def test_a_body_on_the_other_side_of_its_hinge_needs_no_load_of_ones_own(
    ratio: float, on_segment: bool, integrator: str, tmp_path: Path
) -> None:
    # Hung along x the body stands on a spring that does not bear it; the other way round it hangs.
    body = End(math.inf, 0.0124, mass=3.24, rotary_inertia=0.015, offset=0.249, on_segment=on_segment)
    chain = Chain(Beam(1.0, 4.0, 1.0), (body, "free"), 6)
    damping = joint_dampers(chain, ratio) if ratio else None
    (path,) = export_chain(chain, tmp_path / "body.xml", integrator=integrator, damping=damping)
    model, step = mujoco_file(path), written_step(path)
    for turn in (math.pi, 0.75 * math.pi):
        model.opt.gravity[:] = (9.81 * math.cos(turn), 0.0, 9.81 * math.sin(turn))
        rest = at_rest(model, np.zeros(model.nv))
        assert rest is not None and is_stable(model, step, rest)


@dataclass(frozen=True)
class Drawn:
    """A chain of the sweep, what damps it, and its gravity."""

    chain: Chain
    damping: Damping | None
    load: Load

    @property
    def is_open(self) -> bool:
        """Whether its far end is free."""
        return any(not end.is_grounded for end in (self.chain.boundary.left, self.chain.boundary.right))


def drawn(number: int) -> Drawn:
    """Chain of a number: ends, bodies, springs, damping of 0 to 10 %, gravity in any direction."""
    draw = np.random.default_rng(7000 + number)
    length, stiffness, mass = 10 ** draw.uniform([-0.5, -2, -2], [0.7, 2, 0.5])
    weight = mass * length

    def body() -> dict[str, float]:
        if draw.random() < 0.4:
            return {}
        heavy, long = float(weight * draw.uniform(0.1, 3)), float(length * draw.uniform(0.02, 0.2))
        return {"mass": heavy, "rotary_inertia": heavy * long**2, "offset": draw.choice([0.0, long])}

    def spring(power: int) -> float:
        return float(stiffness / length**power * 10 ** draw.uniform(0, 3))

    firm: list[End] = [
        End(math.inf, math.inf),
        End(math.inf, math.inf),
        End(math.inf, 0.0),
        End(0.0, math.inf),
        End(spring(3), spring(1)),
        End(math.inf, spring(1)),
    ]
    near = firm[int(draw.integers(len(firm)))]
    far = End(**body()) if draw.random() < 0.65 else firm[int(draw.integers(len(firm)))]
    ends: BoundaryLike = (near, far)
    rule = ("mitiguy", "naive", "half_stub", "gregory", "double_wall")[int(draw.integers(5))]
    chain = Chain(Beam(length, stiffness, mass), ends, int(draw.integers(4, 15)), rule)
    ratio = float(draw.choice([0.0, 0.01, 0.03, 0.1]) * draw.uniform(0.5, 1))
    damping = joint_dampers(chain, ratio) if ratio and chain.elastic_modes else None
    # From none to what makes a rope of it; pushed from above only as hard as it can bear.
    total = float(chain.mass.sum())
    size = float(stiffness / (total * length**2) * draw.choice([0.0, 1.0, 300.0]))
    turn = float(draw.uniform(-math.pi, math.pi))
    if size * total * length**2 > 2 * stiffness:
        turn /= 2
    if near.translational_stiffness == 0.0 or not chain.boundary.left.is_grounded:
        # A slider or a free chain would fall.
        turn = 0.0
    if near.translational_stiffness > 0 and near.rotational_stiffness == 0.0:
        turn = 0.0
    load = Load(gravity=(size * math.cos(turn), size * math.sin(turn)))
    return Drawn(chain, damping, load)


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_written_steps_are_stable_and_a_third_of_the_largest_in_mujoco(
    integrator: str, tmp_path: Path
) -> None:
    shares = []
    for number in range(40):
        each = drawn(number)
        path = tmp_path / f"{number}.xml"
        export_chain(each.chain, path, damping=each.damping, load=each.load, integrator=integrator)
        model, step = mujoco_file(path), written_step(path)
        rest = at_rest(model, np.zeros(model.nv))
        if rest is None:
            continue
        assert is_stable(model, step, rest), (number, each)
        largest = largest_stable(model, step, 8 * step, rest, 5)
        shares.append(step / largest)
        assert shares[-1] > 1 / 3, (number, each, step, largest)
    # Soft chains that gravity folds up have no rest that is found from the straight shape.
    assert len(shares) >= 36
    assert np.median(shares) > 0.42


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_written_steps_are_stable_and_a_third_of_the_largest_in_drake(tmp_path: Path) -> None:
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plants = pytest.importorskip("pydrake.multibody.plant")
    analysis = pytest.importorskip("pydrake.systems.analysis")
    mujoco = pytest.importorskip("mujoco")

    def stays(path: Path, step: float, gravity: np.ndarray, rest: dict[str, float]) -> bool:
        plant = plants.MultibodyPlant(step)
        parsing.Parser(plant).AddModels(str(path))
        plant.mutable_gravity_field().set_gravity_vector(gravity)
        plant.Finalize()
        simulator = analysis.Simulator(plant)
        context = simulator.get_mutable_context()
        names = plant.GetPositionNames(add_model_instance_prefix=False)
        still = np.array([rest[name.rsplit("_", 1)[0]] for name in names])
        plant.SetPositions(context, still + 1e-6 * np.random.default_rng(0).standard_normal(len(still)))
        try:
            for k in range(1, 11):
                simulator.AdvanceTo(100 * k * step)
                if not np.abs(plant.GetPositions(context) - still).max() < 1e-2:
                    return False
        except RuntimeError:  # a NaN
            return False
        return bool(np.abs(plant.GetPositions(context) - still).max() < 1e-3)

    seen = 0
    for number in range(40):
        each = drawn(number)
        if not each.is_open:
            continue
        options: dict[str, Any] = {"damping": each.damping, "load": each.load}
        (same,) = export_chain(each.chain, tmp_path / f"{number}.xml", **options)
        (path,) = export_chain(each.chain, tmp_path / f"{number}.sdf", **options)
        model = mujoco_file(same)
        rest, step = at_rest(model, np.zeros(model.nv)), written_step(path)
        if rest is None:
            continue
        text = str(ElementTree.parse(path).getroot().findtext(".//gravity"))
        gravity = np.array(text.split(), dtype=float)
        assert gravity.tolist() == model.opt.gravity.tolist()
        place = {
            mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, i): float(rest[i]) for i in range(model.nv)
        }
        assert stays(path, step, gravity, place), (number, each)
        assert not stays(path, 3 * step, gravity, place), (number, each)
        seen += 1
    assert seen >= 20


@pytest.mark.parametrize(
    ("ratio", "boundary", "integrator"),
    in_turns(
        [0.003, 0.1],
        ["clamped-clamped", "clamped-pinned", "pinned-pinned"],
        ["Euler", "implicit", "implicitfast"],
        every=3,
    ),
)
def test_hard_dampers_beside_a_held_far_end(
    ratio: float, boundary: str, integrator: str, tmp_path: Path
) -> None:
    """The step's matrix with the constraint, in plain matrices, against bisection in MuJoCo."""
    chain = Chain(Beam(1.2, 85.0, 0.62), boundary, 10)
    damping = joint_dampers(chain, ratio)
    options: dict[str, Any] = {"damping": damping, "load": Load(), "integrator": integrator}
    (path,) = export_chain(chain, tmp_path / "beam.xml", **options)
    (said,) = re.findall(r"largest stable timestep in MuJoCo \w+: (\S+) s", path.read_text(encoding="utf-8"))
    free = stable_time_step(chain, f"MuJoCo {integrator}", damping=damping)
    assert (float(said) < 0.7 * free) == (ratio == 0.1)
    model = mujoco_file(path)
    found = largest_stable(model, float(said) / 2, 2 * float(said), np.zeros(model.nv))
    assert found == pytest.approx(float(said), rel=0.06)
    assert float(said) / 3 < written_step(path) < float(said)


def test_a_second_plane_leaves_the_stiffer_ones_step_as_it_is(tmp_path: Path) -> None:
    """Hinges of one plane and slides of the other have the same axis: they are not each other's."""
    said = []
    for second in (None, Chain(Beam(1.2, 20.0, 0.62), "clamped-clamped", 6, "gregory")):
        chain = Chain(Beam(1.2, 85.0, 0.62), "clamped-clamped", 6, "gregory")
        (path,) = export_chain(
            chain,
            tmp_path / "beam.xml",
            second=second,
            damping=joint_dampers(chain, 0.05),
            integrator="implicitfast",
            force=True,
        )
        said += re.findall(r"largest stable timestep in .*", path.read_text(encoding="utf-8"))
    assert said[0] == said[1]
