"""Exported chains in PyBullet, Exudyn and DART, and rods of PyElastica: what they find, and how they step."""

from __future__ import annotations

import math
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm
from beammodes.vibration.integrators import amplification

Array = NDArray[np.float64]

pytestmark = pytest.mark.filterwarnings("ignore:.*SWIG|.*swig|.*deprecated:DeprecationWarning")

BEAM = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
BODY = bm.End(mass=0.3, rotary_inertia=0.002, offset=0.05)
WIRE = {"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 1.0}
HELIX = bm.Rod.helix(radius=0.1, pitch=0.05, turns=0.4, polar_inertia_per_length=1e-4, **WIRE)


def planar(ends: Any, rule: str = "mitiguy", stiffness: float = 85.0) -> bm.Chain:
    return bm.Chain(bm.Beam(1.2, stiffness, 0.62), ends, segments=5, rule=rule)


#: Chains, with what bends across.
CHAINS: dict[str, tuple[Any, Any]] = {
    "gregory": (planar("clamped-free", "gregory"), None),
    "a first piece that is welded": (planar("clamped-free", "half_stub"), None),
    "turned": (planar("free-clamped"), None),
    "hinged, with a body": (planar((bm.End(math.inf, 40.0), BODY), "hencky"), None),
    "sliding": (planar((bm.End(900.0, math.inf), "free")), None),
    "free": (planar("free-free"), None),
    "both planes": (planar("clamped-free", "gregory"), planar("clamped-free", "gregory", 20.0)),
    "helix": (bm.SpatialChain(HELIX, "clamped-free", segments=5, rule="gregory"), None),
    "free helix": (bm.SpatialChain(HELIX, "free-free", segments=4, rule="mitiguy"), None),
}


def known_frequencies(case: str) -> Array:
    """Elastic ones of a chain [rad/s]."""
    chain, second = CHAINS[case]
    if isinstance(chain, bm.SpatialChain):
        omega = np.asarray(bm.spatial_modes(chain, 3 * chain.segments).angular_frequency)
        return omega[omega > 1e-6 * omega.max()]
    planes = [chain] if second is None else [chain, second]
    each = [bm.solve_modes(bm.linearize(plane)).angular_frequency for plane in planes]
    return np.sort(np.concatenate(each))


def written(case: str, folder: Path, format: str, **options: Any) -> Path:
    chain, second = CHAINS[case]
    suffix = {"sdf": ".sdf"}.get(format, ".py")
    place = folder / f"{format}_chain{suffix}"
    return bm.export_chain(chain, place, format=format, second=second, force=True, **options)[0]


def elastic(mass: Array, stiffness: Array, count: int) -> Array:
    """The `count` highest ω: rigid-body motions come with rounding."""
    root = np.linalg.cholesky(mass)
    half = np.linalg.solve(root, np.sqrt(stiffness))
    return np.linalg.svd(half)[1][:count][::-1]


@pytest.fixture
def bullet() -> Any:
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    yield pybullet
    pybullet.disconnect(client)


def bullet_matrices(bullet: Any, script: dict[str, Any]) -> tuple[int, dict[int, float], Array, Array]:
    body, springs = script["load"]()
    mass = np.array(bullet.calculateMassMatrix(body, [0.0] * len(springs)))
    stiffness = np.zeros_like(mass)
    # The six motions of a base that is not fixed come first.
    np.fill_diagonal(stiffness, [0.0] * (len(mass) - len(springs)) + list(springs.values()))
    return body, springs, mass, stiffness


@pytest.mark.parametrize("case", CHAINS)
def test_pybullet_finds_the_chains_frequencies(case: str, bullet: Any, tmp_path: Path) -> None:
    script = runpy.run_path(str(written(case, tmp_path, "pybullet")))
    *_, mass, stiffness = bullet_matrices(bullet, script)
    known = known_frequencies(case)
    assert elastic(mass, stiffness, len(known)) == pytest.approx(known, rel=1e-8)


@pytest.mark.parametrize("case", CHAINS)
def test_exudyn_finds_the_chains_frequencies(case: str, tmp_path: Path) -> None:
    exudyn = pytest.importorskip("exudyn")
    script = runpy.run_path(str(written(case, tmp_path, "exudyn")))
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    script["add_chain"](system)
    system.Assemble()
    squares = np.asarray(system.ComputeODE2Eigenvalues()[0])
    known = known_frequencies(case)
    assert np.sqrt(squares[-len(known) :]) == pytest.approx(known, rel=1e-8)


@pytest.mark.parametrize("case", CHAINS)
def test_dart_finds_the_chains_frequencies(case: str, tmp_path: Path) -> None:
    dart = pytest.importorskip("dartpy")
    world = dart.utils.SdfParser.readWorld(str(written(case, tmp_path, "sdf")))
    skeleton = world.getSkeleton(0)
    mass = skeleton.getMassMatrix()
    springs = [skeleton.getDof(k).getSpringStiffness() for k in range(skeleton.getNumDofs())]
    known = known_frequencies(case)
    # DART raises masses below 1e-9 kg, of links between two hinges, to that.
    closeness = 1e-8 if isinstance(CHAINS[case][0], bm.Chain) else 1e-7
    assert elastic(mass, np.diag(springs), len(known)) == pytest.approx(known, rel=closeness)


def test_scripts_run_as_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known = known_frequencies("gregory")[:3] / (2 * math.pi)
    for engine in ("pybullet", "exudyn"):
        pytest.importorskip(engine)
        # A name that ends strings, where a file may have it.
        odd = tmp_path / f"it's {engine}.py"
        bm.export_chain(CHAINS["gregory"][0], odd, format=engine)
        runpy.run_path(str(odd), run_name="__main__")
        answer = capsys.readouterr().out.partition("natural frequencies [Hz]: ")[2]
        assert [float(word) for word in answer.split()] == pytest.approx(known, rel=1e-7)


def test_files_carry_gravity_where_engines_look_for_it(tmp_path: Path) -> None:
    load, down = bm.Load(gravity=(0.0, -9.81)), [0.0, 0.0, -9.81]
    dart = pytest.importorskip("dartpy")
    for engine in ("pybullet", "exudyn"):
        pytest.importorskip(engine)
        script = runpy.run_path(str(written("gregory", tmp_path, engine, load=load)))
        assert [*script["GRAVITY"]] == down
    for given, said in ((load, down), (None, [0.0, 0.0, 0.0])):
        path = written("gregory", tmp_path, "sdf", load=given)
        assert dart.utils.SdfParser.readWorld(str(path)).getGravity().tolist() == said
        notes = bm.audit_file(path, BEAM).notes
        assert any("gravity is left out here" in note for note in notes) == (given is not None)


# --- Steps ------------------------------------------------------------------------------------------------


class Bullet:
    """A script's chain in PyBullet; `step` and places as of the other engines here."""

    def __init__(self, path: Path, pybullet: Any, step: float) -> None:
        self.script, self.bullet = runpy.run_path(str(path)), pybullet
        pybullet.resetSimulation()
        self.body, self.springs, self.mass, self.stiffness = bullet_matrices(pybullet, self.script)
        pybullet.setTimeStep(step)

    def start(self, place: Array) -> None:
        for joint, angle in zip(self.springs, place, strict=True):
            self.bullet.resetJointState(self.body, joint, angle)

    def step(self) -> None:
        self.script["pull"](self.body, self.springs)
        self.bullet.stepSimulation()

    @property
    def place(self) -> Array:
        return np.array([state[0] for state in self.bullet.getJointStates(self.body, list(self.springs))])


class Dart:
    """The same in DART."""

    def __init__(self, path: Path, dart: Any, step: float) -> None:
        self.world = dart.utils.SdfParser.readWorld(str(path))
        self.skeleton = self.world.getSkeleton(0)
        self.mass = self.skeleton.getMassMatrix()
        dofs = range(self.skeleton.getNumDofs())
        self.stiffness = np.diag([self.skeleton.getDof(k).getSpringStiffness() for k in dofs])
        self.world.setTimeStep(step)

    def start(self, place: Array) -> None:
        self.skeleton.setPositions(place)

    def step(self) -> None:
        self.world.step()

    @property
    def place(self) -> Array:
        return np.array(self.skeleton.getPositions())


def factor(engine: Any, mode: int, steps: int = 40) -> complex:
    """What one step multiplies a mode by, from its motion  p_{k+1} = a p_k + b p_{k-1}."""
    shape = scipy.linalg.eigh(engine.stiffness, engine.mass)[1][:, mode]
    row = engine.mass @ shape
    engine.start(1e-6 * shape)
    motion = [row @ engine.place]
    for _ in range(steps):
        engine.step()
        motion.append(row @ engine.place)
    each = np.array(motion) / motion[0]
    pair = np.linalg.lstsq(np.stack([each[1:-1], each[:-2]], 1), each[2:], rcond=None)[0]
    roots = np.roots([1.0, *-pair])
    return complex(roots[np.argmax(roots.imag + abs(roots))])


@pytest.mark.parametrize("ratio", [0.0, 0.02])
@pytest.mark.parametrize("mode", [0, 2])
def test_steps_of_pybullet_and_dart_multiply_modes_as_their_integrators_do(
    mode: int, ratio: float, bullet: Any, tmp_path: Path
) -> None:
    dart = pytest.importorskip("dartpy")
    chain = CHAINS["gregory"][0]
    damping = bm.joint_dampers(chain, ratio) if ratio else None
    omega = known_frequencies("gregory")
    step = 0.3 / omega[2]
    for name, format, make, module in (
        ("PyBullet", "pybullet", Bullet, bullet),
        ("DART", "sdf", Dart, dart),
    ):
        engine = make(written("gregory", tmp_path, format, damping=damping), module, step)
        own = ratio * omega[mode] / omega[0]
        predicted = complex(amplification(name, omega[mode] * step, own))
        assert factor(engine, mode) == pytest.approx(predicted, abs=1e-6), name


@pytest.mark.parametrize("case", CHAINS)
def test_pybullet_keeps_still_at_the_step_of_the_file(case: str, bullet: Any, tmp_path: Path) -> None:
    path = written(case, tmp_path, "pybullet")
    engine = Bullet(path, bullet, runpy.run_path(str(path))["STEP"])
    start = 1e-6 * np.random.default_rng(7).standard_normal(len(engine.springs))
    sprung = np.array(list(engine.springs.values())) > 0
    engine.start(start)
    for _ in range(500):
        engine.step()
    assert abs(engine.place[sprung]).max() < 1e-4


@pytest.mark.parametrize("ratio", [0.0, 0.01])
def test_pybullet_becomes_unstable_where_it_is_said(ratio: float, bullet: Any, tmp_path: Path) -> None:
    chain = CHAINS["gregory"][0]
    damping = bm.joint_dampers(chain, ratio) if ratio else None
    limit = bm.stable_time_step(chain, "PyBullet", damping=damping)
    # Implicit dampers would allow a longer one, not a shorter one.
    assert (limit < bm.stable_time_step(chain, "Drake discrete", damping=damping)) == (ratio > 0)
    path, grown = written("gregory", tmp_path, "pybullet", damping=damping), []
    for share in (0.98, 1.02):
        engine = Bullet(path, bullet, share * limit)
        engine.start(1e-9 * (-1.0) ** np.arange(len(engine.springs)))
        for _ in range(400):
            engine.step()
        grown.append(abs(engine.place).max() > 1e-7)
    assert grown == [False, True]


def test_exudyns_rk44_becomes_unstable_where_it_is_said(tmp_path: Path) -> None:
    exudyn = pytest.importorskip("exudyn")
    limit, grown = bm.stable_time_step(CHAINS["gregory"][0], "Exudyn RK44"), []
    script = runpy.run_path(str(written("gregory", tmp_path, "exudyn")))
    for share in (0.98, 1.02):
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        script["add_chain"](system)
        system.Assemble()
        start = 1e-9 * (-1.0) ** np.arange(5)
        system.systemData.SetODE2Coordinates(start, configuration=exudyn.ConfigurationType.Initial)
        script["settings"].__globals__["STEP"] = share * limit
        run = script["settings"](600 * share * limit)
        run.solution.file.write = False
        system.SolveDynamic(run, solverType=exudyn.DynamicSolverType.RK44)
        grown.append(abs(system.systemData.GetODE2Coordinates()).max() > 1e-7)
    assert grown == [False, True]
