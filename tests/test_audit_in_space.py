"""Audits of chains in space: bending in two planes and twist of files, told apart, beside the exact rod.

Truth of frequencies are MuJoCo's and Pinocchio's own matrices at rest; of errors the lookups of each motion,
which share nothing with the files.
"""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from test_read_mjcf import world

import beammodes as bm
from beammodes.auditing.bounded_xml import BadModel

Array = NDArray[np.float64]

#: Of one plane EI = 85, of the other 40; GJ = 60.
ROD = bm.Rod(1.2, 85.0, 60.0, 0.62, 1e-4, second_bending_stiffness=40.0)


def mujoco_frequencies(text: str) -> Array:
    """All elastic ω of a model's hinges, balls and slides about its rest."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass, stiffness = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
    mujoco.mj_fullM(model, data, mass)
    for joint in range(model.njnt):
        at, width = model.jnt_dofadr[joint], {0: 6, 1: 3}.get(int(model.jnt_type[joint]), 1)
        stiffness[at : at + width] = np.ravel(model.jnt_stiffness[joint])[0]
    squares = scipy.linalg.eigh(np.diag(stiffness), mass, eigvals_only=True)
    return np.sqrt(squares[squares > 1e-9 * squares[-1]])


AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def hinges(order: str, node: int, springs: Array, more: str = "") -> str:
    """The joints of one node, about the body's axes in this order."""
    return "".join(
        f'<joint name="j{node}{axis}" axis="{AXES[axis]}" stiffness="{spring!r}"{more}/>'
        for axis in order
        for spring in [float(springs[node, "xyz".index(axis)])]
    )


def joints_of(kind: str, node: int, springs: Array, more: str) -> str:
    if kind == "ball":
        return f'<joint name="j{node}" type="ball" stiffness="{float(springs[node, 1])!r}"{more}/>'
    orders = {
        "fixed": ("yz", "yz"),
        "reversed": ("yz", "zy"),
        "triple": ("xyz", "xyz"),
        "triple_reversed": ("xyz", "zyx"),
        "by_turns": ("y", "z"),
        "three_by_turns": ("y", "z", "x"),
    }[kind]
    return hinges(orders[node % len(orders)], node, springs, more)


def row(kind: str, count: int, springs: Array, masses: Array, moments: Array, more: str, free: str) -> str:
    """A row of rods of 0.1 m along x, each with mass and moments of its own."""
    text = ""
    for i in reversed(range(count)):
        x, y, z = moments[i].tolist()
        own = f'<inertial pos="0.05 0 0" mass="{masses[i].item()!r}" diaginertia="{x!r} {y!r} {z!r}"/>'
        place = f'pos="{0.1 if i else 0.0} 0 0"'
        if kind == "cross":
            cross = '<inertial pos="0 0 0" mass="0.004" diaginertia="2e-7 3e-7 4e-7"/>'
            inner = f'<body name="s{i}">{hinges("z", i, springs, more)}{own}{text}</body>'
            text = f'<body name="c{i}" {place}>{hinges("y", i, springs, more)}{cross}{inner}</body>'
        else:
            joints = free if i == 0 and free else joints_of(kind, i, springs, more)
            text = f'<body name="s{i}" {place}>{joints}{own}{text}</body>'
    return text


KINDS = ("ball", "fixed", "reversed", "triple", "triple_reversed", "by_turns", "three_by_turns", "cross")
#: What the order is called: which axis is the rod's y depends on the springs.
ORDERS = {
    "ball": "ball",
    "fixed": "[yz]{2}",
    "reversed": "[yz]{2}_alternating",
    "triple": "[xyz]{3}",
    "triple_reversed": "[xyz]{3}_alternating",
    "by_turns": "[yz]{2}_by_turns",
    "three_by_turns": "[xyz]{3}_by_turns",
    "cross": "[yz]{2}",
}


@pytest.mark.parametrize("kind", KINDS)
def test_all_motions_ring_as_in_mujoco(kind: str, tmp_path: Path) -> None:
    """Of random springs, masses, inertias, armatures and places; held and free."""
    rng = np.random.default_rng(KINDS.index(kind))
    for case in range(3):
        count = int(rng.integers(4, 8)) + 2 * ("turns" in kind)
        springs = rng.uniform(4.0, 40.0, (count, 3))
        masses = rng.uniform(0.02, 0.1, count)
        # Of bodies: none exceeds the sum of the other two.
        moments = (
            masses[:, None] * 0.1**2 / 12 * rng.uniform([0.1, 0.95, 0.95], [0.2, 1.05, 1.05], (count, 3))
        )
        more = ' armature="1e-4"' if case == 1 else ""
        free = "<freejoint/>" if case == 2 and kind != "cross" else ""
        turn = " ".join(repr(part) for part in rng.standard_normal(4).tolist())
        inner = row(kind, count, springs, masses, moments, more, free)
        text = world(inner if free else f'<body pos="3 -1 2" quat="{turn}">{inner}</body>')
        if case == 0:
            # On one line, joints without names have the same word in messages.
            text = re.sub(r'<joint name="\w+"', "<joint", text)
        truth = mujoco_frequencies(text)
        (tmp_path / "model.xml").write_text(text)
        found = bm.audit_file(tmp_path / "model.xml", ROD, motion="space", modes=4)
        assert re.fullmatch(ORDERS[kind], found.joints)
        has_twist = kind in ("ball", "triple", "triple_reversed", "three_by_turns")
        assert set(found.motions) == {"bending", "second_bending", *(["twist"] if has_twist else [])}
        omega = found.angular_frequency[~np.isnan(found.angular_frequency)]
        nearest = truth[np.abs(truth[:, None] - omega).argmin(axis=0)]
        np.testing.assert_allclose(omega, nearest, rtol=1e-9)
        np.testing.assert_allclose(omega[:4], truth[:4], rtol=1e-9)
        # The first and the last may be heavier, and then carry a body.
        assert bool(re.search(r"ends free.*-free", found.text)) == bool(free)


@pytest.mark.parametrize(
    ("ends", "rule"),
    [
        ("clamped-free", "naive"),
        ("clamped-free", "gregory"),
        ("clamped-free", "half_stub"),
        ("free-free", "rigid_stub"),
        ("clamped-clamped", "gregory"),
        ("pinned-free", "mitiguy"),
    ],
)
def test_each_motion_errs_as_its_lookup_says(ends: str, rule: str, tmp_path: Path) -> None:
    (path,) = bm.export_chain(bm.SpatialChain(ROD, ends, 6, rule), tmp_path / "rod.xml")
    found = bm.audit_file(path, ROD, motion="space")
    words = "-".join({"clamped": "fixed", "pinned": "free"}.get(word, word) for word in ends.split("-"))
    for name, one in found.motions.items():
        motion, pair = ("twist", words) if name == "twist" else ("bending", ends)
        due = bm.frequency_error(pair, segments=6, mode=np.arange(1, 4), rule=rule, motion=motion)
        np.testing.assert_allclose(one.errors, due, atol=1e-9)
        weights = [each.name for each in bm.RULES.values()]
        assert one.layout in weights
        assert one.boundary.name == pair
    assert found.joints.endswith("_alternating")
    assert "the order reversed at every other node: second order in 1/N" in found.text
    said = bm.audit_file(path, ROD, ends, motion="space")
    np.testing.assert_array_equal(said.errors, found.errors)
    assert not any("ends" in line for line in said.assumed)


def test_engines_of_urdf_and_sdformat_agree(tmp_path: Path) -> None:
    chain = bm.SpatialChain(ROD, "clamped-free", 5, "mitiguy")
    urdf, _ = bm.export_chain(chain, tmp_path / "rod.urdf")
    (sdf,) = bm.export_chain(chain, tmp_path / "rod.sdf")
    found = [bm.audit_file(path, ROD, motion="space") for path in (urdf, sdf)]
    np.testing.assert_allclose(found[0].angular_frequency, found[1].angular_frequency, rtol=1e-9)
    due = bm.spatial_modes(chain, 6).angular_frequency
    np.testing.assert_allclose(found[0].angular_frequency[:6], due, rtol=1e-9)
    pinocchio = pytest.importorskip("pinocchio")
    yaml = pytest.importorskip("yaml")
    model = pinocchio.buildModelFromUrdf(str(urdf))
    mass = np.triu(pinocchio.crba(model, model.createData(), pinocchio.neutral(model)))
    mass += np.triu(mass, 1).T
    springs = {
        each["joint"]: each["stiffness"]
        for each in yaml.safe_load((tmp_path / "rod.springs.yaml").read_text())["springs"]
    }
    squares = scipy.linalg.eigh(
        np.diag([springs[name] for name in list(model.names)[1:]]), mass, eigvals_only=True
    )
    np.testing.assert_allclose(found[0].angular_frequency[:6], np.sqrt(squares[:6]), rtol=1e-8)
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = pytest.importorskip("pydrake.multibody.plant").MultibodyPlant(0.0)
    forces = pytest.importorskip("pydrake.multibody.tree").MultibodyForces
    parsing.Parser(plant).AddModels(str(sdf))
    plant.Finalize()
    context, count = plant.CreateDefaultContext(), plant.num_positions()
    mass, stiffness = plant.CalcMassMatrix(context), np.zeros((count, count))
    # Of linear springs, by the forces of unit turns.
    for k in range(count):
        plant.SetPositions(context, 1e-3 * np.eye(count)[k])
        felt = forces(plant)
        plant.CalcForceElementsContribution(context, felt)
        stiffness[:, k] = -1e3 * felt.generalized_forces()
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    np.testing.assert_allclose(found[1].angular_frequency[:6], np.sqrt(squares[:6]), rtol=1e-7)


def test_planes_as_near_to_one_axis_of_the_world_have_letters_of_their_own(tmp_path: Path) -> None:
    """Hinges by turns about axes at 45 degrees: each plane rings as in MuJoCo, the others at rest."""
    springs, ones = np.full((8, 3), 10.0), np.ones(8)
    text = world(row("by_turns", 8, springs, 0.05 * ones, np.full((8, 3), 5e-5), "", ""))
    text = text.replace('axis="0 1 0"', 'axis="0 1 1"').replace('axis="0 0 1"', 'axis="0 1 -1"')
    (tmp_path / "model.xml").write_text(text)
    truth, beam, found = mujoco_frequencies(text), bm.Beam(0.8, 2.0, 0.5), {}
    for plane in ("y", "z"):
        found[plane] = bm.audit_file(tmp_path / "model.xml", beam, plane=plane).angular_frequency
    assert found["y"][0] != pytest.approx(found["z"][0], rel=1e-3)
    both = np.sort(np.concatenate([*found.values()]))
    np.testing.assert_allclose(both, truth[: len(both)], rtol=1e-9)
    with pytest.raises(ValueError, match="plane must be one of"):
        bm.audit_file(tmp_path / "model.xml", beam, plane="x")


def test_curved_rods_are_judged_as_one(tmp_path: Path) -> None:
    """Their modes are mixed; the exported chain errs as `rod_errors` finds without any file."""
    wire = {"bending_stiffness": 85.0, "torsional_stiffness": 60.0, "mass_per_length": 0.62}
    for rod in (
        bm.Rod.arc(1.5, length=1.2, polar_inertia_per_length=1e-4, **wire),
        bm.Rod.pretwisted(1.0, length=1.2, second_bending_stiffness=300.0, **wire),
    ):
        chain = bm.SpatialChain(rod, "clamped-free", 8, "gregory")
        (path,) = bm.export_chain(chain, tmp_path / "rod.xml", force=True)
        found = bm.audit_file(path, rod, motion="space")
        np.testing.assert_allclose(found.errors, bm.rod_errors(chain, 3), atol=1e-10)
        assert not found.motions and "move each other" in found.text
        assert found.layout == "gregory"
        shares = bm.spatial_modes(chain, 3).stored[:, 0]
        assert list(found.mode_motion) == ["twist" if share > 0.5 else "bending" for share in shares]
        other = bm.SpatialChain(rod, "clamped-free", 8, "naive")
        (bad,) = bm.export_chain(other, tmp_path / "naive.xml", force=True)
        worse = bm.audit_file(bad, rod, motion="space")
        assert worse.layout == "naive" and "at these nodes gregory has springs" in worse.text
        half = bm.SpatialChain(rod, "clamped-free", 8, "half_stub")
        (stub,) = bm.export_chain(half, tmp_path / "stub.xml", force=True)
        assert bm.audit_file(stub, rod, motion="space", modes=1).layout == "half_stub"
        with pytest.raises(ValueError, match="boundary must fit the file, which holds 6 of 6"):
            bm.audit_file(path, rod, "free-free", motion="space")
        with pytest.raises(BadModel, match=r"straight line|joints along its line"):
            bm.audit_file(path, bm.Beam(1.2, 85.0, 0.62, **TWISTING), motion="twist")


TWISTING = {"torsional_stiffness": 60.0, "polar_inertia_per_length": 1e-4}


def test_matter_off_the_line_couples_bending_and_twist(tmp_path: Path) -> None:
    springs, ones = np.full((4, 3), 20.0), np.ones(4)
    text = world(row("triple", 4, springs, 0.05 * ones, np.full((4, 3), 5e-5), "", ""))
    text = text.replace('pos="0.05 0 0"', 'pos="0.05 0.02 0"')
    (tmp_path / "model.xml").write_text(text)
    found = bm.audit_file(tmp_path / "model.xml", ROD, motion="space", modes=6)
    assert "centres of mass are off its line" in found.text and not found.motions
    np.testing.assert_allclose(found.angular_frequency, mujoco_frequencies(text)[:6], rtol=1e-9)
    with pytest.raises(BadModel, match="centre of mass on the line"):
        bm.audit_file(tmp_path / "model.xml", bm.Beam(0.4, 2.0, 0.5, **TWISTING), motion="twist")


def balls(count: int, spring: float, length: float = 1.0) -> str:
    """Equal rods on balls, the first at the wall: naive."""
    ell, springs = length / count, np.full((count, 3), spring)
    mass = np.full(count, 0.62 * ell)
    moments = np.column_stack([np.full(count, 1e-4 * ell), *[mass * ell**2 / 12] * 2])
    text = row("ball", count, springs, mass, moments, "", "")
    return world(
        text.replace('pos="0.1 0 0"', f'pos="{ell!r} 0 0"').replace('pos="0.05', f'pos="{ell / 2!r}')
    )


def test_balls_twist_as_they_bend(tmp_path: Path) -> None:
    """Their GJ is their EI: a round rod with ν = 0.3 rings in twist by √1.3 - 1 = 14 % less."""
    path = tmp_path / "balls.xml"
    path.write_text(balls(10, 85.0 * 10))
    rod = bm.Rod(1.0, 85.0, 85.0 / 1.3, 0.62, 1e-4)
    found = bm.audit_file(path, rod, motion="space")
    assert "twist = EI" in found.text and "+14 % off for that alone" in found.text
    due = bm.frequency_error("fixed-free", segments=10, mode=np.arange(1, 4), rule="naive", motion="twist")
    np.testing.assert_allclose(found.motions["twist"].errors, math.sqrt(1.3) * (1 + due) - 1, rtol=1e-10)
    assert "1.3 times those of naive: as of GJ = 85 N m^2" in found.motions["twist"].remark
    right = bm.audit_file(path, bm.Rod(1.0, 85.0, 85.0, 0.62, 1e-4), motion="space")
    assert "twist = EI" not in right.text and right.motions["twist"].layout == "naive"
    # A ball has one stiffness for both planes, too.
    assert "a ball bends alike in both planes" in bm.audit_file(path, ROD, motion="space").text
    # Without a word one plane is taken, and what is left out is said.
    plain = bm.audit_file(path, bm.Beam(1.0, 85.0, 0.62))
    assert "balls let the chain twist too" in plain.text and 'motion="space"' in plain.text


def test_springs_of_the_advice_do_what_they_promise(tmp_path: Path) -> None:
    """In twist beside bending, by the file with its springs changed, in MuJoCo too."""
    chain = bm.SpatialChain(ROD, "clamped-free", 6, "naive")
    (path,) = bm.export_chain(chain, tmp_path / "rod.xml")
    beam = bm.Beam(1.2, 85.0, 0.62, **TWISTING)
    found = bm.audit_file(path, beam, motion="twist")
    names = [way.name for way in found.suggestions]
    assert names == ["gregory", "first_spring_tuned"]
    text = path.read_text()
    for way in found.suggestions:
        changed = text
        for name, old, new in zip(
            found.hinge_names, found.joint_stiffness.tolist(), way.joint_stiffness.tolist(), strict=True
        ):
            start = changed.index(f'name="{name}"')
            changed = changed[:start] + changed[start:].replace(
                f'stiffness="{old!r}"', f'stiffness="{new!r}"', 1
            )
        (tmp_path / "mended.xml").write_text(changed)
        mended = bm.audit_file(tmp_path / "mended.xml", beam, motion="twist")
        np.testing.assert_allclose(mended.errors, way.errors, atol=1e-10)
        truth = mujoco_frequencies(changed)
        nearest = truth[np.abs(truth - mended.angular_frequency[0]).argmin()]
        np.testing.assert_allclose(mended.angular_frequency[0], nearest, rtol=1e-8)


def test_planes_are_mended_one_after_the_other(tmp_path: Path) -> None:
    """What is written twice, once a plane, bends in both as `gregory` in the lookup, and in MuJoCo so."""
    (path,) = bm.export_chain(bm.SpatialChain(ROD, "clamped-free", 6, "naive"), tmp_path / "rod.xml")
    bm.mend_file(path, tmp_path / "one.xml", bm.Beam(1.2, 85.0, 0.62), plane="y")
    bm.mend_file(tmp_path / "one.xml", tmp_path / "both.xml", bm.Beam(1.2, 40.0, 0.62), plane="z")
    found = bm.audit_file(tmp_path / "both.xml", ROD, motion="space")
    due = bm.frequency_error("clamped-free", segments=6, mode=np.arange(1, 4), rule="gregory")
    for name in ("bending", "second_bending"):
        np.testing.assert_allclose(found.motions[name].errors, due, atol=1e-9)
    assert found.motions["twist"].layout == "naive"
    truth = mujoco_frequencies((tmp_path / "both.xml").read_text())
    np.testing.assert_allclose(found.angular_frequency[:6], truth[:6], rtol=1e-8)


def along(kind: str, count: int, spring: float, mass: str, tip: str = "") -> str:
    text = ""
    for i in reversed(range(count)):
        joint = f'<joint name="j{i}" type="{kind}" axis="1 0 0" stiffness="{spring!r}" damping="1e-3"/>'
        own = f'<inertial pos="0.05 0 0" {mass}/>'
        text = f'<body name="s{i}" pos="{0.1 * (i > 0)} 0 0">{joint}{own}{text or tip}</body>'
    return world(text)


def test_chains_that_only_twist_or_stretch(tmp_path: Path) -> None:
    """Equal springs at the wall and between: naive, by its closed form; with a disc by MuJoCo."""
    path, due = tmp_path / "model.xml", {}
    body = 'mass="0.062" diaginertia="1e-5 6e-5 6e-5"'
    path.write_text(along("hinge", 10, 600.0, body))
    shaft = bm.Beam(1.0, 1.0, 0.62, axial_stiffness=5e3, **TWISTING)
    for motion in ("twist", "stretch"):
        due[motion] = bm.frequency_error(
            "fixed-free", segments=10, mode=np.arange(1, 4), rule="naive", motion=motion
        )
    found = bm.audit_file(path, shaft, motion="twist")
    assert (found.layout, found.order, found.segments) == ("naive", 1, 10)
    np.testing.assert_allclose(found.errors, due["twist"], atol=1e-10)
    assert (found.damping_ratio > 0).all() and found.step is not None
    with pytest.raises(ValueError, match=r"hinges|twist"):
        bm.audit_file(path, shaft)
    with pytest.raises(ValueError, match="ends in twist are fixed-free, got free-free"):
        bm.audit_file(path, shaft, "free-free", motion="twist")
    assert bm.audit_file(path, shaft, "fixed-fixed", motion="twist").boundary.name == "fixed-fixed"
    disc = '<body pos="0.1 0 0"><inertial pos="0 0 0" mass="0.3" diaginertia="2e-5 2e-5 2e-5"/></body>'
    path.write_text(along("hinge", 10, 600.0, body, disc))
    carried = bm.audit_file(path, shaft, motion="twist")
    assert carried.boundary.name == "fixed-free(inertia=2e-05)"
    assert "the body at the end rigid with its segment: naive" in carried.remark
    np.testing.assert_allclose(carried.angular_frequency, mujoco_frequencies(path.read_text())[:3], rtol=1e-9)
    same = bm.audit_file(path, shaft, "fixed-free(inertia=2e-5)", motion="twist")
    np.testing.assert_allclose(same.errors, carried.errors, rtol=1e-9)
    path.write_text(along("slide", 10, 5e4, body))
    sliding = bm.audit_file(path, shaft, motion="stretch")
    np.testing.assert_allclose(sliding.errors, due["stretch"], atol=1e-10)
    assert sliding.layout == "naive" and "10 slides" in sliding.given[0]


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    springs = np.full((5, 3), 85.0 * 10)
    path.write_text(world(row("fixed", 5, springs, np.full(5, 0.06), np.full((5, 3), 5e-5), "", "")))
    found = bm.audit_file(path, ROD, motion="space")
    assert "lacks joints about its line: what the rod does in twist" in found.text
    assert "in this fixed order at every node: first order in 1/N" in found.text
    assert "reverse it at every other node" in found.text
    # Which plane is which is told by the springs, or by the user.
    assert found.planes == {"bending": "z", "second_bending": "y"}
    turned = bm.audit_file(path, ROD, motion="space", plane="y")
    assert turned.planes == {"bending": "y", "second_bending": "z"}
    (tmp_path / "balls.xml").write_text(balls(5, 80.0))
    massless = bm.audit_file(tmp_path / "balls.xml", bm.Rod(1.0, 16.0, 12.0, 0.62), motion="space")
    assert "is not judged: give the rod's polar_inertia_per_length" in massless.text
    assert set(massless.motions) == {"bending", "second_bending"}
    with pytest.raises(ValueError, match="torsional_stiffness must be given"):
        bm.audit_file(path, bm.Beam(1.0, 85.0, 0.62), motion="space")
    with pytest.raises(TypeError, match='a Rod is judged with motion="space"'):
        bm.audit_file(path, ROD)  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="polar_inertia_per_length"):
        bm.audit_file(path, bm.Beam(1.0, 85.0, 0.62, torsional_stiffness=2.0), motion="twist")
    beam = bm.Beam(1.0, 85.0, 0.62, **TWISTING)
    with pytest.raises(ValueError, match="plane must be left out for motion twist"):
        bm.audit_file(path, beam, motion="twist", plane="y")  # type: ignore[call-overload]
    loose = path.read_text().replace(
        f'name="j2z" axis="0 0 1" stiffness="{85.0 * 10!r}"', 'name="j2z" axis="0 0 1"'
    )
    path.write_text(loose)
    with pytest.raises(BadModel, match="j2z must have a spring, as all joints of a chain in space"):
        bm.audit_file(path, ROD, motion="space")


def test_hinges_by_turns_are_of_second_order() -> None:
    """The claim of the remark: how a tip bent about y and z turns, by hinges in each order.

    Each turns by the rod's curvature over its share of the length; exact is the limit by Richardson.
    """

    def turn(axis: int, angle: float) -> Array:
        c, s = math.cos(angle), math.sin(angle)
        found = np.eye(3)
        i, j = [(1, 2), (2, 0), (0, 1)][axis]
        found[i, i] = found[j, j] = c
        found[i, j], found[j, i] = -s, s
        return found

    def tip(count: int, kind: str) -> Array:
        """A tip of 2 count parts, hinges at their ends, halves at the rod's ends."""
        bends = (lambda s: 1.0 + 0.7 * s, lambda s: 1.3 - 0.9 * s**2)
        found = np.eye(3)
        for j in range(2 * count + 1):
            s, share = j / (2 * count), (0.5 if j in (0, 2 * count) else 1.0) / count
            axes = (
                (1 + j % 2,) if kind == "by_turns" else ((1, 2), (2, 1))[(j // 2) % 2 * (kind == "reversed")]
            )
            if kind != "by_turns" and j % 2:
                continue
            for axis in axes:
                # Those of odd places have no hinge at the rod's ends, and none is halved.
                found = found @ turn(axis, share * bends[axis - 1](s))
        return found

    exact = (4 * tip(1024, "by_turns") - tip(512, "by_turns")) / 3
    off = {
        kind: [np.linalg.norm(tip(count, kind) - exact) for count in (20, 40, 80)]
        for kind in ("fixed", "reversed", "by_turns")
    }
    orders = {kind: math.log2(errors[1] / errors[2]) for kind, errors in off.items()}
    assert orders["fixed"] == pytest.approx(1.0, abs=0.05)
    assert orders["reversed"] == pytest.approx(2.0, abs=0.1)
    assert orders["by_turns"] == pytest.approx(2.0, abs=0.05)


NUMBER = re.compile(r"(?<![A-Za-z_0-9.])-?\d+\.?\d*(?:e[-+]?\d+)?(?![A-Za-z_0-9.])")
EXTREMES = ("0", "-1", "1e30", "-1e30", "1e-100", "1e-30", "1e15", "5e-324", "1e308", "nan", "1e3", "0.5")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("draws", [12, pytest.param(400, marks=pytest.mark.slow)])
def test_extreme_numbers_end_in_an_answer_or_one_line(draws: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(draws)
    texts = []
    for suffix, joints in ((".xml", "yzx"), (".sdf", "yzx_alternating"), (".xml", "ball")):
        rod = bm.Rod(1.2, 60.0, 60.0, 0.62, 1e-4) if joints == "ball" else ROD
        rule = "naive" if joints == "ball" else "gregory"
        (path,) = bm.export_chain(
            bm.SpatialChain(rod, "clamped-free", 3, rule),
            tmp_path / f"rod{suffix}",
            joints=joints,
            force=True,
        )
        texts.append((suffix, path.read_text()))
    beam = bm.Beam(1.2, 85.0, 0.62, **TWISTING)
    for draw in range(draws):
        suffix, text = texts[draw % len(texts)]
        for _ in range(int(rng.integers(1, 4))):
            spots = list(NUMBER.finditer(text))
            spot = spots[int(rng.integers(len(spots)))]
            text = text[: spot.start()] + EXTREMES[int(rng.integers(len(EXTREMES)))] + text[spot.end() :]
        (tmp_path / f"odd{suffix}").write_text(text)
        refusal = ""
        try:
            assert bm.audit_file(tmp_path / f"odd{suffix}", ROD, motion="space", modes=1).text
            assert bm.audit_file(tmp_path / f"odd{suffix}", beam, motion="twist", modes=1).text
        except ValueError as error:
            refusal = str(error)
        assert "\n" not in refusal


def test_long_chains_keep_their_digits(tmp_path: Path) -> None:
    """Of 120 equal rods on three hinges a node: naive, by its closed forms."""
    count = 120
    ell, springs = 1.2 / count, np.tile([60.0, 40.0, 85.0], (count, 1)) * count / 1.2
    mass = np.full(count, 0.62 * ell)
    moments = np.column_stack([np.full(count, 1e-4 * ell), *[mass * ell**2 / 12] * 2])
    text = world(row("triple_reversed", count, springs, mass, moments, "", ""))
    text = text.replace('pos="0.1 0 0"', f'pos="{ell!r} 0 0"').replace('pos="0.05', f'pos="{ell / 2!r}')
    (tmp_path / "model.xml").write_text(text)
    found = bm.audit_file(tmp_path / "model.xml", ROD, motion="space")
    for name, one in found.motions.items():
        motion, ends = ("twist", "fixed-free") if name == "twist" else ("bending", "clamped-free")
        due = bm.frequency_error(ends, segments=count, mode=np.arange(1, 4), rule="naive", motion=motion)
        np.testing.assert_allclose(one.errors, due, atol=1e-10)
    assert found.planes == {"bending": "y", "second_bending": "z"}


def test_the_command_line_says_what_the_library_finds(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    from beammodes.__main__ import main

    (path,) = bm.export_chain(bm.SpatialChain(ROD, "clamped-free", 6, "gregory"), tmp_path / "rod.xml")
    numbers = ["--length=1.2", "--ei=85", "--ei-across=40", "--gj=60", "--rho-a=0.62", "--rho-ip=1e-4"]

    def ran(*words: str) -> tuple[int, str]:
        code = main(["audit", str(path), *words])
        return code, "".join(capsys.readouterr())

    code, out = ran(*numbers, "--motion", "space", "--json", "--modes", "2", "--tolerance", "5%")
    answer, found = json.loads(out), bm.audit_file(path, ROD, motion="space", modes=2, tolerance=0.05)
    assert (code, answer["meets"], answer["joints"]) == (0, True, found.joints)
    assert [mode["relative_error"] for mode in answer["modes"]] == pytest.approx(found.errors.tolist())
    assert [mode["motion"] for mode in answer["modes"]] == list(found.mode_motion)
    assert answer["motions"]["twist"]["layout"] == found.motions["twist"].layout
    code, out = ran(*numbers, "--motion", "space", "--boundary", "clamped-free", "--tolerance", "1e-6")
    assert code == 1 and "second_bending: ends clamped-free" in out and "error [%]  motion" in out
    code, out = ran("--motion", "twist", "--length=1.2", "--gj=60", "--rho-ip=1e-4", "--json")
    one = bm.audit_file(path, bm.Beam(1.2, 85.0, 0.62, **TWISTING), motion="twist")
    assert json.loads(out)["modes"][0]["relative_error"] == pytest.approx(float(one.errors[0]))
    for words, message in (
        (["--motion", "twist"], "--length and --gj and --rho-ip must be given"),
        ([*numbers, "--motion", "space", "--write", "new.xml"], "--write must be left out for motion space"),
        ([*numbers, "--motion", "spice"], "--motion must be one of"),
    ):
        code, out = ran(*words)
        assert code == 2 and message in out
