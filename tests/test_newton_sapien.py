"""Exported chains in Newton and in SAPIEN, whose engine is PhysX: first frequencies and stable steps."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import yaml
from numpy.typing import NDArray
from turns import in_turns

import beammodes as bm
from beammodes.exporters.planar_tree import planar_tree
from beammodes.exporters.tree_matrices import tree_matrices

Array = NDArray[np.float64]

# Newton warns of a MuJoCo newer than its own, Warp of machines without CUDA.
pytestmark = pytest.mark.filterwarnings("ignore")

BEAM = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
CHAIN = bm.Chain(BEAM, "clamped-free", segments=10, rule="gregory")
MODES = bm.solve_modes(bm.linearize(CHAIN))
FIRST = float(MODES.frequency[0])
DAMPING = bm.joint_dampers(CHAIN, 0.01)
#: Joint angles of mode 1 [rad].
BENT = 4e-3 * np.diff(MODES.rotation[0], prepend=0.0)[-10:] / np.abs(MODES.rotation[0]).max()
#: All of the engines' numbers are of single precision.
SINGLE = 2e-6


def first_frequency(motion: Array, step: float) -> float:
    """Of a motion that swings about zero [Hz], by its crossings."""
    before = np.flatnonzero(np.diff(np.sign(motion)))
    times = before + motion[before] / (motion[before] - motion[before + 1])
    return float((len(times) - 1) / (times[-1] - times[0]) / 2 / step)


def damping_ratio(motion: Array) -> float:
    """Of a motion that decays slowly, from the largest values between its crossings."""
    swings = np.split(np.abs(motion), np.flatnonzero(np.diff(np.sign(motion))) + 1)[1:-1]
    return math.log(swings[0].max() / swings[-1].max()) / (math.pi * (len(swings) - 1))


def named(stem: str) -> str:
    """Return a page."""
    return (Path(__file__).parent.parent / "beammodes" / "pages" / f"{stem}.md").read_text(encoding="utf-8")


# --- Newton ----------------------------------------------------------------------------------------------


def newton_model(path: Path, *, checked: bool = False, **options: Any) -> Any:
    """A file as Newton has it; `checked` as it is by default, with small moments of inertia made larger."""
    newton = pytest.importorskip("newton")
    pytest.importorskip("warp").config.quiet = True
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    if path.suffix == ".usda":
        pytest.importorskip("newton_usd_schemas")
        builder.add_usd(str(path), **options)
    elif path.suffix == ".xml":
        builder.add_mjcf(str(path))
    else:
        builder.add_urdf(str(path))
        beside = yaml.safe_load(path.with_suffix(".springs.yaml").read_text())["springs"]
        springs = {spring["joint"]: spring["stiffness"] for spring in beside}
        for name, start in zip(builder.joint_label, builder.joint_qd_start, strict=True):
            if name.split("/")[-1] in springs:
                builder.joint_stiffness[start] = springs[name.split("/")[-1]]
    # For the solver that takes bodies by colours.
    builder.color()
    return builder.finalize(device="cpu", skip_validation_inertia=not checked)


def newton_matrices(model: Any) -> tuple[Array, Array, Array]:
    """Mass, stiffness and dampers of its joints."""
    newton = pytest.importorskip("newton")
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    mass = newton.eval_mass_matrix(model, state).numpy()[0].astype(float)
    stiffness = (model.joint_stiffness.numpy() + model.joint_target_ke.numpy()).astype(float)
    return mass, stiffness, (model.joint_damping.numpy() + model.joint_target_kd.numpy()).astype(float)


def newton_motion(model: Any, solver: str, step: float, steps: int, start: Array, **options: Any) -> Array:
    """Joint angles in time, from rest."""
    newton, warp = pytest.importorskip("newton"), pytest.importorskip("warp")
    state, after, control = model.state(), model.state(), model.control()
    state.joint_q.assign(start.astype(np.float32))
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    moves = getattr(newton.solvers, f"Solver{solver}")(model, **options)
    found, place, speed = (
        np.empty((steps, len(start))),
        *map(warp.zeros_like, (model.joint_q, model.joint_qd)),
    )
    for k in range(steps):
        # Of the bodies' places, which all solvers have.
        newton.eval_ik(model, state, place, speed)
        found[k] = place.numpy()
        state.clear_forces()
        moves.step(state, after, control, None, step)
        state, after = after, state
    return found


@pytest.mark.parametrize("suffix", [".xml", ".usda", ".urdf"])
def test_newton_has_the_chains_matrices(suffix: str, tmp_path: Path) -> None:
    weak = bm.Chain(bm.Beam(1.2, 20.0, 0.62), "clamped-free", 10, "gregory")
    path = bm.export_chain(CHAIN, tmp_path / f"beam{suffix}", second=weak, damping=DAMPING)[0]
    mass, stiffness, dampers = newton_matrices(newton_model(path))
    known = np.sort(np.concatenate([MODES.frequency, bm.solve_modes(bm.linearize(weak)).frequency]))
    found = np.sqrt(scipy.linalg.eigh(np.diag(stiffness), mass, eigvals_only=True)) / (2 * math.pi)
    assert found == pytest.approx(known, rel=3e-4)
    assert found[:2] == pytest.approx(known[:2], rel=SINGLE)
    assert dampers == pytest.approx(DAMPING.stiffness * stiffness, rel=SINGLE)


def test_newton_makes_small_inertias_larger_unless_told_not_to(tmp_path: Path) -> None:
    # A catheter of 0.3 m, 1 mm thick, in 30 segments.
    thin = bm.Beam(0.3, 1e-4, 2e-3)
    chain = bm.Chain(thin, "clamped-free", 30, "gregory")
    known = bm.solve_modes(bm.linearize(chain), 1).frequency[0]
    found = []
    for checked in (True, False):
        (path,) = bm.export_chain(chain, tmp_path / f"thin_{checked}.usda")
        mass, stiffness, _ = newton_matrices(newton_model(path, checked=checked))
        least = scipy.linalg.eigh(np.diag(stiffness), mass, eigvals_only=True)[0]
        found.append(math.sqrt(least) / (2 * math.pi) / known)
    print(found)
    assert found == [pytest.approx(0.70, abs=0.3), pytest.approx(1.0, rel=1e-4)]


@pytest.mark.parametrize("ends", ["clamped-free", "free-free"])
def test_newton_has_a_rod_in_space(ends: str, tmp_path: Path) -> None:
    rod = bm.Rod(1.0, 3.0, 2.0, 0.5, 1e-3, curvature=(0.7, 0.5, 2.0))
    chain = bm.SpatialChain(rod, ends, 5, "gregory")
    (path,) = bm.export_chain(chain, tmp_path / "rod.usda")
    mass, stiffness, _ = newton_matrices(newton_model(path))
    rigid = 6 if ends == "free-free" else 0
    found = np.sqrt(scipy.linalg.eigh(np.diag(stiffness), mass, eigvals_only=True)[rigid:][:3])
    assert found == pytest.approx(bm.spatial_modes(chain, 3).angular_frequency, rel=1e-5)


@pytest.mark.parametrize(
    ("solver", "suffix"), in_turns(["MuJoCo", "Featherstone"], [".xml", ".usda"], every=2)
)
def test_newtons_solvers_ring_and_step_as_said(solver: str, suffix: str, tmp_path: Path) -> None:
    options = {"use_mujoco_cpu": True} if solver == "MuJoCo" else {}
    if options:
        pytest.importorskip("mujoco_warp")
    # The MuJoCo solver takes a file's integrator, and implicitfast where it has none.
    asked = {"integrator": "implicitfast"} if suffix == ".xml" else {}
    rough = BENT / 10 + 5e-5 * (-1.0) ** np.arange(10)
    for damping in (None, DAMPING):
        # OpenUSD keeps what it has read under a name.
        place = tmp_path / f"{'still' if damping is None else 'damped'}{suffix}"
        path = bm.export_chain(CHAIN, place, damping=damping, **asked)[0]
        model = newton_model(path)
        limit = bm.stable_time_step(CHAIN, f"Newton {solver}", damping=damping)
        still = newton_motion(model, solver, 0.97 * limit, 400, rough, **options)
        assert np.abs(still).max() < 4 * np.abs(rough).max()
        grown = newton_motion(model, solver, 1.03 * limit, 400, rough, **options)
        # Beyond all numbers; or MuJoCo has set all back to rest.
        assert not np.abs(grown).max() < 10 * np.abs(rough).max() or not grown[-1].any()
        if damping is None:
            motion = newton_motion(model, solver, 0.97 * limit, 2000, BENT, **options)[:, 0]
            assert first_frequency(motion, 0.97 * limit) == pytest.approx(FIRST, rel=1e-4)


@pytest.mark.slow
def test_newtons_other_solvers_are_not_for_springs(tmp_path: Path) -> None:
    (path,) = bm.export_chain(CHAIN, tmp_path / "beam.xml")
    model = newton_model(path)
    # A passive spring does nothing.
    for solver in ("XPBD", "VBD"):
        motion = newton_motion(model, solver, 1e-3, 200, BENT).sum(axis=1)
        assert (motion > 0.9 * BENT.sum()).all()
    # Joints held by springs of their own.
    motion = newton_motion(model, "SemiImplicit", 1e-4, 4000, BENT).sum(axis=1)
    assert f"| {first_frequency(motion, 1e-4):.1f} Hz | its joints are springs" in named("newton_isaac")
    model = newton_model(bm.export_chain(CHAIN, tmp_path / "beam.usda")[0])
    for solver in ("XPBD", "VBD"):
        motion = newton_motion(model, solver, 1e-3, 1000, BENT, iterations=20).sum(axis=1)
        row = rf"\| `Solver{solver}` \| \*\*ignored\*\*.* (\S+) Hz at 1 ms and 20 iterations"
        said = re.search(row, named("newton_isaac"))
        assert said is not None
        assert first_frequency(motion, 1e-3) == pytest.approx(float(said[1]), rel=0.01)


def test_newton_drops_mujocos_springs_in_usd_unless_told(tmp_path: Path) -> None:
    (path,) = bm.export_chain(CHAIN, tmp_path / "beam.usda")
    text = re.sub(r".*drive:angular:physics:(type|targetPosition).*\n", "", path.read_text())
    text = text.replace("PhysicsDriveAPI:angular", "MjcJointAPI")
    path.write_text(text.replace("float drive:angular:physics:stiffness", "double mjc:stiffness"))
    assert not newton_matrices(newton_model(path))[1].any()
    resolver = pytest.importorskip("newton").usd.SchemaResolverMjc()
    assert newton_matrices(newton_model(path, schema_resolvers=[resolver]))[1].all()


def test_newtons_rod_has_the_layout_of_mujocos_cable() -> None:
    newton = pytest.importorskip("newton")
    pytest.importorskip("warp").config.quiet = True
    count, thin = 10, 1e-3
    points = np.zeros((count + 1, 3))
    points[:, 0] = np.linspace(0.0, BEAM.length, count + 1)
    given = {f"{what}_rigidity": 85.0 for what in ("bend", "twist", "stretch", "shear")}
    builder = newton.ModelBuilder()
    solid = newton.ModelBuilder.ShapeConfig(density=0.62 / (math.pi * thin**2))
    bodies, joints = builder.add_rod(rod=newton.Rod(points, radius=thin, **given), cfg=solid)
    chain = bm.Chain(BEAM, "clamped-free", count, rule="rigid_stub")
    assert (len(bodies), len(joints)) == (count, count - 1)
    # Stretch, two of shear, two of bending, twist.
    springs = np.array(builder.joint_target_ke[-6 * (count - 1) :]).reshape(-1, 6)
    assert springs[:, 4] == pytest.approx(chain.joint_stiffness, rel=1e-5)
    middles = np.array([tuple(pose) for pose in builder.body_q])[:, 0]
    arms = np.array([tuple(pose) for pose in builder.joint_X_p[-(count - 1) :]])[:, 2]
    assert middles[:-1] + arms == pytest.approx(chain.hinge_position, rel=1e-5)
    # Caps make it heavier by 4 r/(3 ℓ).
    ell = BEAM.length / count
    mass = np.array(builder.body_mass)
    assert mass == pytest.approx(0.62 * ell * (1 + 4 * thin / (3 * ell)), rel=1e-5)


# --- SAPIEN ----------------------------------------------------------------------------------------------


def sapien_robot(folder: Path, step: float, iterations: int = 10) -> tuple[Any, Any]:
    """A scene and the chain in it, without friction, gravity and springs."""
    sapien = pytest.importorskip("sapien")
    urdf = bm.export_chain(CHAIN, folder / "beam.urdf", force=True)[0]
    # Visuals want a graphics driver.
    bare = folder / "bare.urdf"
    bare.write_text(re.sub("<visual>.*?</visual>", "", urdf.read_text(), flags=re.DOTALL))
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(step)
    robot = scene.create_urdf_loader().load(str(bare))
    assert robot.solver_position_iterations == 10
    robot.set_solver_position_iterations(iterations)
    for link in robot.links:
        link.disable_gravity = True
        assert (link.linear_damping, link.angular_damping) == pytest.approx((0.05, 0.05))
        link.linear_damping = link.angular_damping = 0.0
    for joint in robot.active_joints:
        # The file's friction is 0, the engine's own is not.
        assert joint.friction == pytest.approx(0.05)
        joint.set_friction(0.0)
    return scene, robot


def sapien_motion(folder: Path, step: float, steps: int, start: Array, damping: float = 0.0) -> Array:
    """Joint angles in time, with springs and dampers as torques that are set before each step."""
    scene, robot = sapien_robot(folder, step)
    robot.set_qpos(start.astype(np.float32))
    found = np.empty((steps, len(start)))
    for k in range(steps):
        found[k] = robot.qpos
        robot.set_qf(-CHAIN.joint_stiffness * (robot.qpos + damping * robot.qvel))
        scene.step()
    return found


def test_torques_in_sapien_ring_and_step_as_said(tmp_path: Path) -> None:
    rough = BENT / 10 + 5e-5 * (-1.0) ** np.arange(10)
    for damping in (None, DAMPING):
        seconds = damping.stiffness if damping is not None else 0.0
        limit = bm.stable_time_step(CHAIN, "PhysX torques", damping=damping)
        still = sapien_motion(tmp_path, 0.97 * limit, 400, rough, seconds)
        assert np.abs(still).max() < 4 * np.abs(rough).max()
        # Until the engine's largest speed of joints, 100 rad/s, holds it.
        grown = sapien_motion(tmp_path, 1.03 * limit, 400, rough, seconds)
        assert np.abs(grown).max() > 8 * np.abs(rough).max()
        assert np.abs(np.diff(grown, axis=0)).max() < 1.01 * 100 * 1.03 * limit
    limit = bm.stable_time_step(CHAIN, "PhysX torques")
    motion = sapien_motion(tmp_path, 0.97 * limit, 4000, BENT).sum(axis=1)
    assert first_frequency(motion, 0.97 * limit) == pytest.approx(FIRST, rel=1e-4)
    assert abs(damping_ratio(motion)) < 1e-5


def swept(chain: bm.Chain, step: float) -> tuple[float, float]:
    """First frequency [Hz] and damping ratio of drives that a step takes one joint after the other.

    Each drive's impulse is implicit in its own joint's speed and knows the impulses of those before it: one
    sweep of Gauss and Seidel through  (1/(h² k) + M⁻¹) p = -(q/h + v).
    """
    found = tree_matrices(planar_tree(chain))
    inverse, stiffness = np.linalg.inv(found.inertia), np.diag(found.stiffness)
    sweep = np.linalg.inv(np.diag(1 / (step**2 * stiffness)) + np.tril(inverse))
    same, none = np.eye(len(inverse)), np.zeros_like(inverse)
    speed = np.hstack([-inverse @ sweep / step, same - inverse @ sweep])
    place = np.hstack([same, none]) + step * speed
    factor = np.linalg.eigvals(np.vstack([place, speed]))
    turning = np.log(factor[factor.imag > 1e-9])
    slowest = turning[np.argmin(turning.imag)]
    return float(slowest.imag / step / (2 * math.pi)), float(-slowest.real / abs(slowest))


@pytest.mark.parametrize(("step", "iterations"), [(1e-3, 10), (1e-3, 50), (1 / 120, 10), (1 / 60, 4)])
def test_drives_in_sapien_soften_as_steps_grow(step: float, iterations: int, tmp_path: Path) -> None:
    scene, robot = sapien_robot(tmp_path, step, iterations)
    for joint, stiffness in zip(robot.active_joints, CHAIN.joint_stiffness, strict=True):
        joint.set_drive_properties(stiffness, 0.0)
    robot.set_qpos((10 * BENT).astype(np.float32))
    hertz, ratio = swept(CHAIN, step / iterations)
    motion = np.empty(int(6.8 / hertz / step))
    for k in range(len(motion)):
        motion[k] = robot.qpos.sum()
        scene.step()
    # Crossings are found by straight lines, and the softer the drives, the less is the start of one mode.
    assert first_frequency(motion, step) == pytest.approx(hertz, rel=2e-3 if step > 1e-3 else 1e-4)
    assert damping_ratio(motion) == pytest.approx(ratio, rel=0.1 if step > 1e-3 else 0.02)


def test_numbers_on_the_page_about_drives() -> None:
    page = named("sapien")
    rows = re.findall(r"^\| 1(/?)(\d*) ?(ms|s) \| (\d+) \| (\S+) ms \| (.*) \|$", page, flags=re.MULTILINE)
    assert len(rows) == 4
    for over, per, unit, iterations, said, rest in rows:
        step = (1 / int(per) if over else 1e-3 if unit == "ms" else 1.0) / int(iterations)
        assert said == f"{1e3 * step:.3g}"
        hertz, ratio = swept(CHAIN, step)
        error = f"{100 * (hertz / FIRST - 1):.3g}"
        assert rest == f"{hertz:.3f} Hz | {error} % | {100 * ratio:.2g} %"
    # The rule of thumb, and the softened springs that explain the fall.
    assert "let h/n be a seventeenth of the explicit limit" in page
    for rule in ("gregory", "mitiguy", "half_stub", "naive"):
        for segments in (5, 10, 20, 40):
            chain = bm.Chain(BEAM, "clamped-free", segments, rule)
            step = bm.stable_time_step(chain, "PhysX torques") / 17
            fall = swept(chain, step)[0] / bm.solve_modes(bm.linearize(chain), 1).frequency[0] - 1
            assert -1e-3 < fall < -2e-4
    found = tree_matrices(planar_tree(CHAIN))
    inverse, stiffness = np.linalg.inv(found.inertia), np.diag(found.stiffness)
    soft = stiffness / (1 + 1e-8 * stiffness * np.diag(inverse) / 2)
    softened = scipy.linalg.eigh(np.diag(soft), found.inertia, eigvals_only=True)[0] ** 0.5 / (2 * math.pi)
    assert softened == pytest.approx(swept(CHAIN, 1e-4)[0], rel=1e-4)
    assert f"4.55 Hz swings at {swept(CHAIN, 1 / 1200)[0]:.2f} Hz" in named("faq")
    # Of links' damping: a rate of 0.05 per second of momentum.
    assert f"{100 * 0.05 / (2 * 2 * math.pi * FIRST):.2f} % in mode 1" in page


def test_a_page_on_newton_names_what_is_in_the_file() -> None:
    page = named("newton_isaac")
    shown = re.findall(r'--integrator "(.*?)"( --damping-ratio 0.01)?   # (\S+) s', named("sapien") + page)
    assert len(shown) == 3
    for name, damped, step in shown:
        found = bm.stable_time_step(CHAIN, name, damping=DAMPING if damped else None)
        assert step == f"{found:.6g}"
    limit = bm.stable_time_step(CHAIN, "Newton Featherstone")
    assert f"stable to {1e3 * limit:.3f} ms here" in page
    assert page.count(f"| {FIRST:.4f} Hz |") == 2
    for name, words in (("Newton MuJoCo", "implicitly: {} ms"), ("Newton Featherstone", "shorten it: {} ms")):
        step = 1e3 * bm.stable_time_step(CHAIN, name, damping=DAMPING)
        assert words.format(f"{step:.3g}") in page
