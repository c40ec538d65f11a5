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
from beammodes.exporters.planar_tree import planar_tree
from beammodes.exporters.tree_matrices import tree_matrices
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


def test_scripts_of_long_chains_print_the_first_frequency(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Its square is 5e-11 of the highest one's, as little as rounding leaves of a rigid body's motion.
    pytest.importorskip("exudyn")
    chain = bm.Chain(BEAM, "clamped-free", segments=300)
    path = bm.export_chain(chain, tmp_path / "long.py", format="exudyn")[0]
    runpy.run_path(str(path), run_name="__main__")
    answer = capsys.readouterr().out.partition("natural frequencies [Hz]: ")[2]
    first = bm.euler_bernoulli(BEAM, "clamped-free", 1).frequency[0]
    assert float(answer.split()[0]) == pytest.approx(first, rel=1e-5)


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


# --- What the pages say -----------------------------------------------------------------------------------

TEN = bm.Chain(BEAM, "clamped-free", segments=10, rule="gregory")


def page(stem: str) -> str:
    path = Path(bm.__file__).parent / "pages" / f"{stem}.md"
    return " ".join(path.read_text(encoding="utf-8").split())


def ten_frequencies() -> Array:
    return np.asarray(bm.solve_modes(bm.linearize(TEN)).angular_frequency)


def test_what_pybullet_does_by_default(bullet: Any, tmp_path: Path) -> None:
    text, omega = page("pybullet"), ten_frequencies()
    path, urdf = bm.export_chain(TEN, tmp_path / "ten.py", format="pybullet")
    plain = runpy.run_path(str(path))
    # Without the flag.
    body = bullet.loadURDF(str(urdf), useFixedBase=True)
    mass = np.array(bullet.calculateMassMatrix(body, [0.0] * 10))
    off = 100 * (elastic(mass, np.diag(TEN.joint_stiffness), 10)[:3] / omega[:3] - 1)
    assert "modes 1 to 3 at +{:.2f}, +{:.1f} and +{:.1f} %".format(*off) in text
    # The air's damping, and the motor that is there by default, from the first mode's shape.
    turns = {}
    for default in ("nothing", "air", "motor"):
        engine = Bullet(path, bullet, 2e-4)
        bodies = range(-1, 10) if default == "air" else ()
        for link in bodies:
            bullet.changeDynamics(engine.body, link, linearDamping=0.04, angularDamping=0.04)
        if default == "motor":
            engine.body = bullet.loadURDF(
                str(urdf), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE
            )
        shape = scipy.linalg.eigh(engine.stiffness, engine.mass)[1][:, 0]
        row = engine.mass @ shape
        engine.start(1e-2 * shape / abs(shape).max())
        motion = [row @ engine.place]
        for _ in range(round(3.2 * 2 * math.pi / omega[0] / 2e-4)):
            engine.step()
            motion.append(row @ engine.place)
        turns[default] = np.array(motion) / motion[0]
    peaks = {
        name: [k for k in range(1, len(p) - 1) if p[k] > p[k - 1] and p[k] >= p[k + 1] and p[k] > 0]
        for name, p in turns.items()
    }
    assert abs(turns["nothing"]).max() < 1.0001 and turns["motor"].min() > 0.2
    assert turns["nothing"][peaks["nothing"]] == pytest.approx(1.0, abs=1e-5)
    first, *_, last = turns["air"][peaks["air"]]
    ratio = math.log(first / last) / (2 * math.pi * (len(peaks["air"]) - 1))
    assert f"{100 * ratio:.2f} % of damping in mode 1" in text
    # Speeds, and files that are kept.
    body = bullet.loadURDF(str(urdf), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE)
    bullet.resetJointState(body, 9, 0.0, 500.0)
    bullet.setJointMotorControl2(body, 9, bullet.VELOCITY_CONTROL, force=0)
    bullet.stepSimulation()
    assert bullet.getJointState(body, 9)[1] == 100.0 and "faster than 100 rad/s" in text
    bullet.setPhysicsEngineParameter(enableFileCaching=1)
    bullet.loadURDF(str(urdf), useFixedBase=True)
    bm.export_chain(TEN, path, format="pybullet", damping=bm.joint_dampers(TEN, 0.01), force=True)
    kept = bullet.loadURDF(str(urdf), useFixedBase=True)
    fresh, _ = plain["load"]()
    assert [bullet.getJointInfo(each, 0)[6] > 0.0 for each in (kept, fresh)] == [False, True]


def test_pybullets_position_motor_is_no_spring(bullet: Any, tmp_path: Path) -> None:
    _, urdf = bm.export_chain(TEN, tmp_path / "ten.py", format="pybullet")
    motion = []
    for step in (1 / 240, 1e-3):
        bullet.resetSimulation()
        bullet.setTimeStep(step)
        body = bullet.loadURDF(str(urdf), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE)
        for joint in range(10):
            bullet.resetJointState(body, joint, 0.01)
            mode = bullet.POSITION_CONTROL
            bullet.setJointMotorControl2(body, joint, mode, targetPosition=0, positionGain=0.1, force=1e9)
        angles = []
        for _ in range(5):
            bullet.stepSimulation()
            angles.append(bullet.getJointState(body, 0)[0])
        motion.append(angles)
    assert motion[0] == pytest.approx(motion[1], rel=1e-4) and motion[0][-1] < 0.0099


def test_steps_on_the_pages_about_pybullet_exudyn_and_dart() -> None:
    omega, text = ten_frequencies(), page("pybullet")
    limit = bm.stable_time_step(TEN, "PyBullet")
    damped = bm.stable_time_step(TEN, "PyBullet", damping=bm.joint_dampers(TEN, 0.01))
    assert f"{1e3 * limit:.3g} ms here, {1e3 * damped:.3g} ms with 1 % in mode 1" in text
    assert f"1/240 s is {1 / 240 / limit:.1f} times beyond" in text
    hertz = omega[0] / (2 * math.pi)
    assert f"PyBullet's own mass matrix: {hertz:.8g} Hz here" in text
    text = page("exudyn")
    assert f"highest mode, {1e3 * bm.stable_time_step(TEN, 'Exudyn RK44'):.3g} ms here" in text
    assert f"(hω)²/12: {100 * (5e-3 * omega[0]) ** 2 / 12:.2f} % for mode 1 at 5 ms" in text
    one, two = 100 * 1e-3 * omega[:2] / 2
    text = page("dart")
    assert f"at 1 ms {one:.1f} % in mode 1 here, and {two:.1f} % in mode 2" in text
    assert f"0.1 % in mode 1 take 2 × 0.001/ω = {1e3 * 2e-3 / omega[0]:.2f} ms" in text


def test_exudyns_implicit_solvers_lower_the_frequency_and_damp_next_to_nothing(tmp_path: Path) -> None:
    exudyn = pytest.importorskip("exudyn")
    (path,) = bm.export_chain(TEN, tmp_path / "ten.py", format="exudyn")
    script, step, steps = runpy.run_path(str(path)), 5e-3, 200
    omega = ten_frequencies()[0]
    tree = tree_matrices(planar_tree(TEN))
    shape = scipy.linalg.eigh(tree.stiffness, tree.inertia)[1][:, 0]
    row = tree.inertia @ shape
    for solver in ("TrapezoidalIndex2", "GeneralizedAlpha"):
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        script["add_chain"](system)
        system.Assemble()
        initial = exudyn.ConfigurationType.Initial
        system.systemData.SetODE2Coordinates(1e-6 * shape, configuration=initial)
        script["settings"].__globals__["STEP"] = step
        run = script["settings"](steps * step)
        run.solution.file.write = False
        system.SolveDynamic(run, solverType=getattr(exudyn.DynamicSolverType, solver))
        place = row @ system.systemData.GetODE2Coordinates() * 1e6
        speed = row @ system.systemData.GetODE2Coordinates_t() * 1e6 / omega
        turned = omega * step * steps
        lost = -math.log(math.hypot(place, speed)) / turned
        assert abs(lost) < 1e-6
        if solver == "TrapezoidalIndex2":
            predicted = complex(amplification(f"Exudyn {solver}", omega * step)) ** steps
            assert complex(place, -speed) == pytest.approx(predicted, abs=1e-3)
        behind = (turned + math.atan2(speed, place) + math.pi) % (2 * math.pi) - math.pi
        assert behind / turned == pytest.approx((omega * step) ** 2 / 12, rel=0.03)


def test_what_darts_readers_take(tmp_path: Path) -> None:
    dart = pytest.importorskip("dartpy")
    sdf, mjcf = (str(bm.export_chain(TEN, tmp_path / f"ten.{kind}")[0]) for kind in ("sdf", "xml"))
    (part,) = bm.export_chain(TEN, tmp_path / "part.sdf", fragment=True)
    read = dart.utils.SdfParser
    assert read.readSkeleton(sdf) is None and read.readWorld(str(part)) is None
    assert read.readSkeleton(str(part)).getNumDofs() == 10
    newer = tmp_path / "newer.sdf"
    newer.write_text(Path(sdf).read_text(encoding="utf-8").replace('"1.5"', '"1.7"'))
    assert read.readWorld(str(newer)) is None
    skeleton = dart.utils.MjcfParser.readWorld(mjcf).getSkeleton(0)
    assert [skeleton.getDof(k).getSpringStiffness() for k in range(10)] == [0.0] * 10
    ours = tree_matrices(planar_tree(TEN)).inertia[0, 0]
    assert skeleton.getMassMatrix()[0, 0] != pytest.approx(ours, rel=0.5)


# --- PyElastica -------------------------------------------------------------------------------------------

ROD_LENGTH, RADIUS, DENSITY, YOUNG, SHEAR = 1.2, 0.012, 2700.0, 70e9, 27e9


def elastica_rod(elastica: Any, count: int, inside: float = 0.0, first: tuple[float, ...] = ()) -> Any:
    ell = ROD_LENGTH / (count - inside)
    rod = elastica.CosseratRod.straight_rod(
        count,
        np.array([-inside * ell, 0.0, 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        count * ell,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=SHEAR,
    )
    rod.bend_matrix[:2, :2, : len(first)] *= np.array(first)
    return rod


def elastica_frequencies(rod: Any) -> Array:
    """From the rod's own forces, torques and masses: nodes across, directors about z, the first ones held."""
    count = rod.n_elems
    place, frames = rod.position_collection.copy(), rod.director_collection.copy()

    def force(nodes: Array, turns: Array) -> Array:
        rod.position_collection[:] = place
        rod.position_collection[1, 1:] += nodes
        for k, turn in enumerate(turns, start=1):
            cos, sin = math.cos(turn), math.sin(turn)
            about = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            rod.director_collection[..., k] = frames[..., k] @ about.T
        rod.compute_internal_forces_and_torques(0.0)
        torque = np.einsum("ijk,ik->jk", rod.director_collection, rod.internal_torques)[2]
        return np.concatenate([rod.internal_forces[1, 1:], torque[1:]])

    size, small = 2 * count - 1, 1e-7
    moved = small * np.eye(size)
    columns = [force(-x[:count], -x[count:]) - force(x[:count], x[count:]) for x in moved]
    stiffness = np.array(columns) / (2 * small)
    turned = [
        frames[..., k].T @ rod.mass_second_moment_of_inertia[..., k] @ frames[..., k] for k in range(1, count)
    ]
    mass = np.concatenate([rod.mass[1:], [inertia[2, 2] for inertia in turned]])
    rod.position_collection[:], rod.director_collection[:] = place, frames
    squares = scipy.linalg.eigh((stiffness + stiffness.T) / 2, np.diag(mass), eigvals_only=True)
    return np.asarray(np.sqrt(squares))


def elastica_simulator(elastica: Any) -> Any:
    return type("Simulator", (elastica.BaseSystemCollection, elastica.Constraints), {})()


def hold(elastica: Any, simulator: Any, rod: Any) -> None:
    """Clamp a rod's first node and element, and begin."""
    simulator.append(rod)
    held = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
    simulator.constrain(rod).using(elastica.OneEndFixedBC, **held)
    simulator.finalize()


@pytest.mark.slow
def test_pyelasticas_clamp_and_what_mends_it() -> None:
    elastica = pytest.importorskip("elastica")
    pytest.importorskip("skfem")
    from studies.tool_layouts import held_element_errors

    second_moment, area = math.pi * RADIUS**4 / 4, math.pi * RADIUS**2
    beam = bm.Beam(ROD_LENGTH, YOUNG * second_moment, DENSITY * area)
    exact = bm.euler_bernoulli(beam, "clamped-free", 1).angular_frequency[0]
    for inside, first in ((0.0, ()), (0.5, ()), (0.0, (12 / 23, 12 / 7))):
        found = elastica_frequencies(elastica_rod(elastica, 10, inside, first))
        layout = held_element_errors([10], points=True, inside=inside, first=first)[0]
        # Shear and the sections' inertia, which the layout has not, are 0.02 %.
        assert found[0] / exact - 1 == pytest.approx(layout, abs=3e-4)
    section = bm.Circle(diameter=2 * RADIUS)
    real = bm.Beam.from_section(section, density=DENSITY, elastic_modulus=YOUNG, length=ROD_LENGTH)
    text = page("pyelastica")
    assert f"lower the frequency by {-100 * bm.theory_errors(real, 'clamped-free', 1)[0]:.2f} %" in text
    assert f"{1e6 * RADIUS * math.sqrt(28 * DENSITY / (27 * SHEAR)):.2f} µs here" in text


@pytest.mark.slow
def test_a_released_rod_rings_at_the_frequency_of_its_matrices() -> None:
    elastica = pytest.importorskip("elastica")
    rod, simulator = elastica_rod(elastica, 10), elastica_simulator(elastica)
    omega = elastica_frequencies(rod)
    hold(elastica, simulator, rod)
    x = rod.position_collection[0] / ROD_LENGTH
    # As a cantilever sags under its weight: nearly mode 1 alone.
    rod.velocity_collection[1] = 1e-3 * x**2 * (6 - 4 * x + x**2)
    verlet, time, step, tip = elastica.PositionVerlet(), 0.0, 1.6 / omega[-1], []
    for _ in range(round(1.7 * 2 * math.pi / omega[0] / step)):
        time = verlet.step(simulator, time, step)
        tip.append(rod.position_collection[1, -1])
    motion = np.array(tip)
    falls = np.flatnonzero((motion[:-1] > 0) & (motion[1:] <= 0))
    times = step * (falls + motion[falls] / (motion[falls] - motion[falls + 1]))
    assert 2 * math.pi / (times[1] - times[0]) == pytest.approx(omega[0], rel=1e-3)


@pytest.mark.slow
def test_the_step_at_which_pyelastica_becomes_unstable() -> None:
    elastica = pytest.importorskip("elastica")
    limit = 2 / elastica_frequencies(elastica_rod(elastica, 10, 0.5))[-1]
    assert f"is {1e6 * limit:.1f} µs here" in page("pyelastica")
    grown = []
    for share in (0.99, 1.01):
        rod, simulator = elastica_rod(elastica, 10, 0.5), elastica_simulator(elastica)
        verlet, time = elastica.PositionVerlet(), 0.0
        hold(elastica, simulator, rod)
        rod.velocity_collection[1, 2:] = 1e-3 * (-1.0) ** np.arange(9)
        for _ in range(4000):
            time = verlet.step(simulator, time, share * limit)
        grown.append(not abs(rod.position_collection[1]).max() < 1e-4)
    assert grown == [False, True]
