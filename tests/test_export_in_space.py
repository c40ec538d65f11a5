"""Exported chains in space: ends of all kinds, rows from the right, steps, heads, and what is refused."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from shared_cases import BEND, INF
from test_engines import drake_matrices, springs_of, spurious_twist

import beammodes as bm
from beammodes.auditing.body_tree import Inertial, joined
from beammodes.auditing.bounded_xml import read_xml
from beammodes.auditing.read_mjcf import read_mjcf
from beammodes.auditing.read_sdf import read_sdf
from beammodes.auditing.read_urdf import read_urdf
from beammodes.exporters import export_facts
from beammodes.exporters.engine_step_in_space import bounded_frequency, highest_frequency
from beammodes.exporters.spatial_tree import spatial_tree
from beammodes.exporters.tree_matrices import tree_matrices
from beammodes.numerics.rotations import quaternion, rotation

#: Of a flat bar, in SI units.
BAR: dict[str, Any] = {
    "bending_stiffness": 40.0,
    "second_bending_stiffness": 85.0,
    "torsional_stiffness": 30.0,
    "mass_per_length": 0.62,
    "polar_inertia_per_length": 3e-5,
    "rotary_inertia_per_length": 1e-5,
    "second_rotary_inertia_per_length": 2e-5,
}
RODS = {
    "straight": bm.Rod(1.2, **BAR),
    "pretwisted": bm.Rod.pretwisted(math.pi / 2, length=1.2, **BAR),
    "arc": bm.Rod.arc(math.pi / 2, length=1.2, **BAR),
    "helix": bm.Rod.helix(radius=0.15, pitch=0.1, turns=1.3, **BAR),
}
BODY = bm.RodEnd(mass=0.3, rotary_inertia=(0.002, 0.003, 0.004), offset=(0.02, 0.01, -0.03))
SPRINGS = bm.RodEnd((900.0, 800.0, 700.0), (40.0, 30.0, 20.0))
OPEN: dict[str, Any] = {
    "clamped-free": "clamped-free",
    "free-clamped": "free-clamped",
    "pinned-free": "pinned-free",
    "guided-free": "guided-free",
    "free-free": (BODY, BODY),
    "tip body": ("clamped", BODY),
    "mass off the tip": ("clamped", bm.RodEnd(mass=0.3, offset=(0.05, 0.0, 0.0))),
    "on springs": (SPRINGS, "free"),
    "springs at the right": (BODY, bm.RodEnd((900.0, INF, 700.0), (40.0, INF, 20.0), 0.1, 0.002)),
}
CLOSED: dict[str, Any] = {
    "clamped-clamped": "clamped-clamped",
    "clamped-pinned": "clamped-pinned",
    "pinned-pinned": "pinned-pinned",
    "guided-clamped": "guided-clamped",
    "body on springs": ("clamped", bm.RodEnd((900.0, 800.0, 700.0), (40.0, INF, 20.0), 0.3, 0.002)),
}


@pytest.fixture(autouse=True)
def _without_judge(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The exact rod takes most of the time of writing a file; one test reads what the head says of it."""
    if request.function.__name__ != "test_the_head_says_what_it_is":
        monkeypatch.setattr(export_facts, "rod_errors", lambda _, modes: np.zeros(modes))


def elastic(mass: Any, stiffness: Any, held: Any, count: int) -> Any:
    """The `count` highest ω."""
    free = scipy.linalg.null_space(held) if len(held) else np.eye(len(mass))
    squares = scipy.linalg.eigh(free.T @ stiffness @ free, free.T @ mass @ free, eigvals_only=True)
    assert np.all(np.abs(squares[: len(squares) - count]) < 1e-6 * squares[-1])
    return np.sqrt(squares[len(squares) - count :])


def mujoco_matrices(path: Path) -> tuple[Any, Any, Any]:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass, stiffness = np.zeros((model.nv, model.nv)), np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    for j in range(model.njnt):
        first, wide = model.jnt_dofadr[j], {0: 6, 1: 3}.get(int(model.jnt_type[j]), 1)
        for k in range(first, first + wide):
            stiffness[k, k] = model.jnt_stiffness[j]
    arms = np.zeros((model.ntendon, model.nv))
    for k in range(model.ntendon):
        for w in range(model.tendon_adr[k], model.tendon_adr[k] + model.tendon_num[k]):
            arms[k, model.jnt_dofadr[model.wrap_objid[w]]] = model.wrap_prm[w]
    stiffness += arms.T @ (model.tendon_stiffness[:, None] * arms)
    return mass, stiffness, arms[[int(model.eq_obj1id[i]) for i in range(model.neq)]]


@pytest.mark.parametrize("case", OPEN | CLOSED)
def test_mujoco_has_the_frequencies_for_all_ends(case: str, tmp_path: Path) -> None:
    for kind, rule in (("straight", "gregory"), ("helix", "half_stub")):
        chain = bm.SpatialChain(RODS[kind], (OPEN | CLOSED)[case], 4, rule)
        known = bm.spatial_modes(chain, 1000).angular_frequency
        (path,) = bm.export_chain(chain, tmp_path / "chain.xml", force=True)
        assert elastic(*mujoco_matrices(path), len(known)) == pytest.approx(known, rel=1e-8)


@pytest.mark.parametrize("case", OPEN)
@pytest.mark.filterwarnings("ignore")
def test_drake_has_them_by_sdformat_and_pinocchio_by_urdf(case: str, tmp_path: Path) -> None:
    chain = bm.SpatialChain(RODS["helix"], OPEN[case], 3, "gregory")
    known = bm.spatial_modes(chain, 1000).angular_frequency
    urdf, yaml = bm.export_chain(chain, tmp_path / "chain.urdf")
    (sdf,) = bm.export_chain(chain, tmp_path / "chain.sdf", fragment=True)
    pinocchio = pytest.importorskip("pinocchio")
    floats = (pinocchio.JointModelFreeFlyer(),) if case == "free-free" else ()
    model = pinocchio.buildModelFromUrdf(str(urdf), *floats)
    upper = np.triu(pinocchio.crba(model, model.createData(), pinocchio.neutral(model)))
    stiffness = np.zeros((model.nv, model.nv))
    for name, value in springs_of(yaml).items():
        index = model.joints[model.getJointId(name)].idx_v
        stiffness[index, index] = value
    found = elastic(upper + np.triu(upper, 1).T, stiffness, (), len(known))
    assert found == pytest.approx(known, rel=1e-8)
    if case != "free-free":  # whose positions are more than its speeds
        pytest.importorskip("pydrake")
        mass, stiffness = drake_matrices(sdf, {})
        assert elastic(mass, stiffness, (), len(known)) == pytest.approx(known, rel=1e-8)


def placed(mujoco: Any, path: Path, q: Any) -> tuple[Any, Any]:
    """A model with its joints where coordinates of the house put them, shape (joints, 3)."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for j in range(model.njnt):
        kind, number, *letter = model.joint(j).name.removeprefix("chain_").split("_")
        start = model.jnt_qposadr[j]
        if kind == "ball":
            data.qpos[start : start + 4] = quaternion(rotation(q[int(number)]))
        else:
            data.qpos[start] = q[int(number)]["xyz".index(letter[0])]
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize("joints", ["ball", "yzx", "xyz_alternating"])
def test_a_row_from_the_right_turns_as_the_rod_does(joints: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    chain = bm.SpatialChain(BEND, "free-clamped", 5, "double_wall")
    (path,) = bm.export_chain(chain, tmp_path / "bend.xml", joints=joints)
    q = 0.4 * np.random.default_rng(3).normal(size=(chain.tree.pieces, 3))
    if joints == "ball":
        q = -q
    _, data = placed(mujoco, path, q)
    turned = bm.JOINT_LAWS[joints].turned(-q if joints == "ball" else q)[0]
    frames = np.concatenate([chain.tree.joint_frame[1:], chain.tree.supports[-1].frame[None]])
    # Bodies run from the last piece that moves to the first, each with the axes of the node at its right.
    moved = data.xmat[1:].reshape(-1, 3, 3)[::-1]
    pieces = [*(moved @ np.swapaxes(frames[: len(moved)], 1, 2)), np.eye(3)]
    for joint in range(1, chain.tree.pieces):
        own = chain.tree.joint_frame[joint]
        across = pieces[joint - 1].T @ pieces[joint]
        assert own.T @ across @ own == pytest.approx(turned[joint], abs=1e-12)


def test_what_the_order_of_hinges_costs_stands_on_the_page(tmp_path: Path) -> None:
    """By shapes at rest here; the exported files say the same to MuJoCo, which turns them by itself."""
    page = (Path(bm.__file__).parent / "pages" / "mujoco.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| `(\w+)`[^|]* \| ([-+.\d]+) \| ([-+.\d]+) \| ([-+.\d]+) \| (\d) \|$", page)
    assert [row[0] for row in rows] == ["yzx", "yzx_alternating"]
    rod = bm.Rod(1.0, 1.0, 1 / 1.3, 1.0, 2e-4, rotary_inertia_per_length=1e-4)
    across = np.array([0.0, 1.0, 1.0]) / math.sqrt(2)
    for joints, *printed, order in rows:
        twists = []
        for segments in (5, 10, 20):
            chain = bm.SpatialChain(rod, "clamped-free", segments, "gregory")
            last = bm.spatial_equilibrium(chain, bm.SpatialLoad(4 * across), joints=joints).rotation[-1]
            # What is left when the shortest turn of x into the tip's direction is taken back.
            turn = np.cross([1.0, 0.0, 0.0], last[:, 0])
            size = float(np.linalg.norm(turn))
            left = rotation(-turn / size * math.atan2(size, last[0, 0])) @ last
            twists.append(math.degrees(math.atan2(left[2, 1], left[1, 1])))
        assert [f"{twist:+.2f}" for twist in twists] == printed
        assert round(math.log2(twists[1] / twists[2])) == int(order)
        pytest.importorskip("mujoco")
        chain = bm.SpatialChain(rod, "clamped-free", 10, "gregory")
        (path,) = bm.export_chain(chain, tmp_path / f"{joints}.xml", joints=joints)
        tip = float(rod.length - chain.node_position[-2])
        assert spurious_twist(path.read_text(encoding="utf-8"), tip) == pytest.approx(twists[1], abs=1e-4)


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf"])
def test_what_is_read_back_has_the_chains_mass_and_shape(suffix: str, tmp_path: Path) -> None:
    chain = bm.SpatialChain(RODS["helix"], ("free", SPRINGS), 6, "gregory")
    (path, *_) = bm.export_chain(chain, tmp_path / f"chain{suffix}")
    root = read_xml(path)
    if suffix == ".xml":
        model = read_mjcf(root, tmp_path)
    else:
        model = read_sdf(root) if suffix == ".sdf" else read_urdf(root, {})
    whole = joined(body.inertial for body in model.bodies)
    tree = chain.tree
    known = joined(map(Inertial, tree.mass.tolist(), tree.centre, tree.inertia))
    assert whole.mass == pytest.approx(known.mass, rel=1e-9)
    assert whole.centre == pytest.approx(known.centre, abs=1e-9)
    assert whole.inertia == pytest.approx(known.inertia, abs=1e-9)


def test_the_head_says_what_it_is(tmp_path: Path) -> None:
    chain = bm.SpatialChain(RODS["helix"], "clamped-free", 5, "gregory")
    text = bm.export_chain(chain, tmp_path / "chain.urdf")[0].read_text(encoding="utf-8")
    hertz, errors = bm.spatial_modes(chain, 3).frequency, 100 * bm.rod_errors(chain, 3)
    for words in (
        f"natural frequencies of the chain: {', '.join(f'{value:.8g}' for value in hertz)} Hz",
        f"their errors against the exact rod: {', '.join(f'{value:+.5g} %' for value in errors)}",
        "EI 40 N m2 about z and 85 about y, GJ 30, 0.62 kg/m",
        "rule: gregory, 5 segments",
        "hinges from s = 0 on: about y, z, x at every other node and about x, z, y between them",
        "1e-10 of the mass",
    ):
        assert words in text


def test_the_step_is_that_of_the_highest_mode(tmp_path: Path) -> None:
    for kind, ends, damping in (
        ("straight", "clamped-free", None),
        ("helix", ("clamped", BODY), bm.Damping(stiffness=1e-4)),
        ("arc", "clamped-clamped", None),
    ):
        chain = bm.SpatialChain(RODS[kind], ends, 6, "gregory")
        omega = bm.spatial_modes(chain, 1000).angular_frequency
        (path,) = bm.export_chain(
            chain, tmp_path / "chain.xml", force=True, damping=damping, integrator="implicitfast"
        )
        ratio = 0.5e-4 * omega[-1] if damping else 0.0
        known = 2 * (math.hypot(1, ratio) + ratio) / omega[-1]
        said = re.search(
            r"largest stable timestep in MuJoCo implicitfast: (\S+) s with gravity off", path.read_text()
        )
        assert said is not None and float(said[1]) == pytest.approx(known, rel=1e-3)
    # A rope that hangs is the planar one, whose limits come from modes under load.
    rope = bm.Rod(4.0, 1e-3, 1e-3, 0.026, 2e-6, rotary_inertia_per_length=1e-6)
    own, plane = (bm.RodEnd(mass=0.75), bm.Beam(4.0, 1e-3, 0.026, rotary_inertia_per_length=1e-6))
    chain = bm.SpatialChain(rope, ("clamped", own), 8, "gregory")
    (path,) = bm.export_chain(chain, tmp_path / "rope.xml", load=bm.SpatialLoad(gravity=(9.81, 0, 0)))
    text = path.read_text(encoding="utf-8")
    said = re.search(r"largest stable timestep in MuJoCo RK4: (\S+) s under", text)
    hung = bm.stable_time_step(
        bm.Chain(plane, ("clamped", bm.End(mass=0.75)), 8, "gregory"), load=bm.Load(gravity=(9.81, 0))
    )
    assert said is not None and float(said[1]) == pytest.approx(hung, rel=1e-3)
    assert 'gravity="9.81 0.0 0.0"' in text
    # The bound that long chains have: within some percent of what is solved for.
    for rod in RODS.values():
        tree = spatial_tree(
            bm.SpatialChain(rod, "clamped-free", 40, "gregory"), "chain", bm.JOINT_LAWS["yzx"]
        )
        solved = highest_frequency(tree_matrices(tree))
        assert solved <= bounded_frequency(tree) <= 1.1 * solved


@pytest.mark.parametrize("kind", ["helix", "arc"])
def test_it_rings_at_the_predicted_frequency(kind: str, tmp_path: Path) -> None:
    """By the step that the file has, started in its first mode; a held end is held by a constraint."""
    mujoco = pytest.importorskip("mujoco")
    ends = "clamped-free" if kind == "helix" else "clamped-clamped"
    chain = bm.SpatialChain(RODS[kind], ends, 6, "gregory")
    omega = float(bm.spatial_modes(chain, 1).angular_frequency[0])
    (path,) = bm.export_chain(chain, tmp_path / "chain.xml")
    mass, stiffness, held = mujoco_matrices(path)
    free = scipy.linalg.null_space(held) if len(held) else np.eye(len(mass))
    shapes = scipy.linalg.eigh(free.T @ stiffness @ free, free.T @ mass @ free)[1]
    shape = free @ shapes[:, 0]
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[:] = 1e-3 * shape / np.abs(shape).max()
    motion = []
    for _ in range(int(10 * 2 * math.pi / omega / model.opt.timestep)):
        motion.append(float(shape @ mass @ data.qpos))
        mujoco.mj_step(model, data)
    path_of = np.array(motion) / motion[0]
    falls = np.flatnonzero((path_of[:-1] > 0) & (path_of[1:] <= 0))
    times = falls + path_of[falls] / (path_of[falls] - path_of[falls + 1])
    ringing = 2 * math.pi * (len(times) - 1) / (times[-1] - times[0]) / model.opt.timestep
    assert ringing == pytest.approx(omega, rel=5e-4)
    assert 0.99 < np.abs(path_of[-len(path_of) // 10 :]).max() < 1.001


def test_what_a_file_cannot_hold_is_refused_with_a_pointer(tmp_path: Path) -> None:
    chain = bm.SpatialChain(RODS["arc"], "clamped-free", 4, "gregory")
    both = bm.SpatialChain(RODS["arc"], "clamped-clamped", 4, "gregory")
    stout = bm.SpatialChain(bm.Rod(1.0, 1.0, 1.0, 1.0, 0.1), "clamped-free", 4)
    planar = bm.Chain(bm.Beam.unit(), "clamped-free", 4)
    for given, suffix, options, words in (
        (both, ".sdf", {}, "mjcf files can support both"),
        (both, ".xml", {"joints": "ball"}, "hinges, such as yzx_alternating, for a chain supported at both"),
        (chain, ".xml", {"joints": "ball"}, "do not bend and twist alike"),
        (chain, ".urdf", {"joints": "ball"}, "which is for mjcf"),
        (chain, ".csv", {}, "format of a chain in space must be one of mjcf, sdf, urdf"),
        (chain, ".xml", {"damping": bm.Damping(mass=1.0)}, "damping must be stiffness alone"),
        (chain, ".xml", {"second": planar}, "second must be left out for a chain in space"),
        (chain, ".xml", {"joints": "zyy"}, "joints must be one of"),
        (stout, ".xml", {}, "pieces whose inertias a body can have"),
        (chain, ".xml", {"timestep": 1.0}, "timestep must be less than"),
    ):
        with pytest.raises(ValueError, match=words):
            bm.export_chain(given, tmp_path / f"chain{suffix}", **options)
    with pytest.raises(TypeError, match="load must be a SpatialLoad or None"):
        bm.export_chain(chain, tmp_path / "chain.xml", load=bm.Load())
    assert list(tmp_path.iterdir()) == []
    # Twist without inertia of its own has some in a file, which the head says.
    thin = bm.SpatialChain(bm.Rod(1.0, 1.0, 1.0, 1.0), "clamped-free", 4)
    (path,) = bm.export_chain(thin, tmp_path / "thin.xml")
    assert "WARNING: pieces without inertia" in path.read_text(encoding="utf-8")
