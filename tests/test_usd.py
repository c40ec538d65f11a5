"""USD files read by OpenUSD: the matrices that their bodies, joints and drives make, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from test_engines import OPEN, RULES
from turns import in_turns

import beammodes as bm

Array = NDArray[np.float64]

BEAM = bm.Beam(1.2, 85.0, 0.62)
#: Physical quantities are of single precision in USD.
SINGLE = 1e-6


class Stage:
    """A file's bodies and joints, of which OpenUSD knows the schema."""

    def __init__(self, path: Path) -> None:
        self.usd = pytest.importorskip("pxr.Usd")
        self.geometry = pytest.importorskip("pxr.UsdGeom")
        self.physics = pytest.importorskip("pxr.UsdPhysics")
        self.stage = self.usd.Stage.Open(str(path))
        cache = self.geometry.XformCache()
        prims = [*self.stage.Traverse()]
        self.bodies = {p.GetPath(): p for p in prims if p.HasAPI(self.physics.RigidBodyAPI)}
        self.joints = [self.physics.Joint(p) for p in prims if p.IsA(self.physics.Joint)]
        self.place = {path: np.array(cache.GetLocalToWorldTransform(p)).T for path, p in self.bodies.items()}

    def parent_and_frame(self, joint: Any) -> tuple[Any, Any, Array]:
        """Return the paths of the two bodies and a joint's frame in the world: the same from both."""
        found, frames = [], []
        for side in "01":
            path = next(iter(getattr(joint, f"GetBody{side}Rel")().GetTargets()), None)
            local = turned(getattr(joint, f"GetLocalRot{side}Attr")().Get())
            local[:3, 3] = getattr(joint, f"GetLocalPos{side}Attr")().Get()
            found.append(path)
            frames.append((np.eye(4) if path is None else self.place[path]) @ local)
        np.testing.assert_allclose(*frames, rtol=0, atol=SINGLE)
        return found[0], found[1], frames[1]

    def matrices(self) -> tuple[Array, Array, Array]:
        """Return M, K and the matrix of dampers of the coordinates that the joints leave."""
        rows: dict[Any, list[int]] = {}
        motion: list[tuple[str, Array, Array]] = []
        springs: list[tuple[float, float]] = []
        waiting = [*self.joints]
        carried = {self.parent_and_frame(joint)[1] for joint in waiting}
        for path in set(self.bodies) - carried:
            # Free: six ways to move.
            for axis in np.eye(3):
                motion += [("slide", axis, np.zeros(3)), ("hinge", axis, self.place[path][:3, 3])]
            springs += [(0.0, 0.0)] * 6
            rows[path] = list(range(6))
        while waiting:
            joint = waiting.pop(0)
            parent, child, frame = self.parent_and_frame(joint)
            if parent is not None and parent not in rows:
                waiting.append(joint)
                continue
            rows[child] = list(rows.get(parent, []))
            kind = {"PhysicsRevoluteJoint": "hinge", "PhysicsPrismaticJoint": "slide"}
            if (type_name := str(joint.GetPrim().GetTypeName())) == "PhysicsFixedJoint":
                continue
            rows[child].append(len(motion))
            letter = joint.GetPrim().GetAttribute("physics:axis").Get()
            motion.append((kind[type_name], frame[:3, "XYZ".index(letter)], frame[:3, 3]))
            springs.append(self.spring(joint, kind[type_name]))
        mass = np.zeros((len(motion), len(motion)))
        for path, prim in self.bodies.items():
            own = self.physics.MassAPI(prim)
            at, turn = self.place[path], self.place[path][:3, :3]
            centre = (at @ [*own.GetCenterOfMassAttr().Get(), 1.0])[:3]
            axes = turn @ turned(own.GetPrincipalAxesAttr().Get())[:3, :3]
            inertia = axes @ np.diag(own.GetDiagonalInertiaAttr().Get()) @ axes.T
            moved, spun = np.zeros((3, len(motion))), np.zeros((3, len(motion)))
            for k in rows[path]:
                what, axis, point = motion[k]
                moved[:, k] = axis if what == "slide" else np.cross(axis, centre - point)
                spun[:, k] = axis if what == "hinge" else 0.0
            mass += own.GetMassAttr().Get() * moved.T @ moved + spun.T @ inertia @ spun
        stiffness, damping = np.array(springs).reshape(-1, 2).T
        return mass, np.diag(stiffness), np.diag(damping)

    def spring(self, joint: Any, kind: str) -> tuple[float, float]:
        """Return stiffness and damping of a drive, per radian."""
        name, units = ("angular", 180 / math.pi) if kind == "hinge" else ("linear", 1.0)
        if not joint.GetPrim().HasAPI(self.physics.DriveAPI, name):
            return 0.0, 0.0
        drive = self.physics.DriveAPI(joint.GetPrim(), name)
        assert drive.GetTypeAttr().Get() == "force" and drive.GetTargetPositionAttr().Get() == 0.0
        return units * (drive.GetStiffnessAttr().Get() or 0.0), units * (drive.GetDampingAttr().Get() or 0.0)


def turned(quaternion: Any) -> Array:
    """A rotation as a matrix of four rows."""
    found = np.eye(4)
    w, (x, y, z) = quaternion.GetReal(), quaternion.GetImaginary()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    found[:3, :3] += 2 * w * cross + 2 * cross @ cross
    return found


def elastic(mass: Array, stiffness: Array, count: int) -> Array:
    """The highest angular frequencies: motions of a rigid body are the lowest, and come with rounding."""
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    return np.sqrt(squares[len(squares) - count :])


def frequencies(chain: bm.Chain) -> Array:
    return bm.solve_modes(bm.linearize(chain)).angular_frequency


@pytest.mark.parametrize(("case", "rule"), in_turns(OPEN, RULES, every=5))
def test_bodies_and_drives_make_the_chain(case: str, rule: str, tmp_path: Path) -> None:
    chain = bm.Chain(BEAM, OPEN[case], segments=5, rule=rule)
    damping = bm.Damping(stiffness=1e-4)
    (path,) = bm.export_chain(chain, tmp_path / "chain.usda", damping=damping)
    mass, stiffness, dampers = Stage(path).matrices()
    known = frequencies(chain)
    assert elastic(mass, stiffness, len(known)) == pytest.approx(known, rel=SINGLE)
    np.testing.assert_allclose(dampers, 1e-4 * stiffness, rtol=SINGLE)


@pytest.mark.parametrize("case", ["clamped-free", "free-clamped", "elastic"])
def test_hinges_about_both_axes(case: str, tmp_path: Path) -> None:
    chain, weak = (bm.Chain(bm.Beam(1.2, own, 0.62), OPEN[case], 5) for own in (85.0, 20.0))
    (path,) = bm.export_chain(chain, tmp_path / "chain.usda", second=weak)
    known = np.sort(np.concatenate([frequencies(chain), frequencies(weak)]))
    assert elastic(*Stage(path).matrices()[:2], len(known)) == pytest.approx(known, rel=SINGLE)


@pytest.mark.parametrize("ends", ["clamped-free", "free-clamped", "free-free"])
def test_a_rod_in_space_that_is_bent_and_twisted(ends: str, tmp_path: Path) -> None:
    chain = bm.SpatialChain(bm.Rod(1.0, 3.0, 2.0, 0.5, 1e-3, curvature=(0.7, 0.5, 2.0)), ends, 4)
    (path,) = bm.export_chain(chain, tmp_path / "chain.usda")
    known = bm.spatial_modes(chain).angular_frequency
    mass, stiffness, _ = Stage(path).matrices()
    rigid = 6 if ends == "free-free" else 0
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)[rigid:]
    assert np.sqrt(squares[: len(known)]) == pytest.approx(known, rel=1e-5)


def test_a_stage_is_valid_and_says_units_and_gravity(tmp_path: Path) -> None:
    inches = bm.Beam(47.0, 29000.0, 9e-5)
    chain = bm.Chain(inches, "free-clamped", 3)
    load = bm.Load(gravity=(100.0, -373.0), tip_force=1.0)
    (path,) = bm.export_chain(chain, tmp_path / "a.usda", name="rod", load=load, units="in-lbf-s")
    text = path.read_text(encoding="utf-8")
    assert text.count("this file holds gravity only") == 1
    assert all(f"largest stable timestep in Newton {word}" in text for word in ("MuJoCo", "Featherstone"))
    read = Stage(path)
    # NIST SP 811: 1 lbf = 4.4482216152605 N, 1 in = 0.0254 m.
    assert read.geometry.GetStageMetersPerUnit(read.stage) == 0.0254
    mass = read.physics.GetStageKilogramsPerUnit(read.stage)
    assert mass == pytest.approx(4.4482216152605 / 0.0254, rel=1e-14)
    assert str(read.stage.GetDefaultPrim().GetPath()) == "/rod"
    scene = read.physics.Scene(read.stage.GetPrimAtPath("/rod_scene"))
    pull = scene.GetGravityMagnitudeAttr().Get() * np.array(scene.GetGravityDirectionAttr().Get())
    # The file's x runs from the clamp at the right end.
    assert pull == pytest.approx([-load.weight[0], 0.0, load.weight[1]], rel=SINGLE)
    validation = pytest.importorskip("pxr.UsdValidation")
    every = validation.ValidationRegistry().GetOrLoadAllValidators()
    assert not validation.ValidationContext(every).Validate(read.stage)


def test_what_usd_does_not_hold_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    with pytest.raises(ValueError, match="one end only for usd files"):
        bm.export_chain(bm.Chain(BEAM, "clamped-pinned", 4), path)
    with pytest.raises(ValueError, match="integrator must be left out for usd files"):
        bm.export_chain(bm.Chain(BEAM, "clamped-free", 4), path, integrator="Euler")
    small = bm.Chain(bm.Beam(1e-9, 1e-40, 1e-20), "clamped-free", 4)
    with pytest.raises(ValueError, match=r"single precision .*moment of inertia of chain_base"):
        bm.export_chain(small, path)
    assert not path.exists()
