"""Rods that flexes of MuJoCo 4 are: judged as MuJoCo moves them, and as springs between point masses."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from beammodes.auditing.audit_model import audit_file
from beammodes.problem.beam import Beam

BEAM = Beam(1.05, 2.0, 0.5)
ELASTIC = '<edge equality="true"/><elasticity young="2.5e8" poisson="0.3"/>'
BOX = ELASTIC.replace("/>", ' section="box" sectionsize=".01 .03" damping=".001"/>').replace(
    'true" section="box" sectionsize=".01 .03" damping=".001"', 'true"'
)
EIGHT = 'count="8 1 1" spacing=".15 1 1" mass=".6"'
UNEVEN = (0.0, 0.2, 0.3, 0.6, 0.8, 1.0)


def flex(
    attributes: str, inner: str, *, kind: str = "grid", around: str = "{}", more: str = "", option: str = ""
) -> str:
    rod = f'<flexcomp name="line" dim="1" type="{kind}" {attributes}>{inner}</flexcomp>'
    still = f'<option gravity="0 0 0" {option}/>'
    return f"<mujoco>{still}<worldbody>{around.format(rod)}</worldbody>{more}</mujoco>"


def direct(points: list[tuple[float, float, float]], elements: str, inner: str) -> str:
    text = " ".join(" ".join(map(str, point)) for point in points)
    return flex(f'point="{text}" element="{elements}" mass=".6" radius=".01"', inner, kind="direct")


ROUND = f'{EIGHT} radius=".01"'
#: A file, the plane, and what springs and point masses make of it: places, masses, EI, held at either end.
RODS: dict[str, tuple[str, dict[str, str], tuple[Any, ...]]] = {
    "clamped": (flex(ROUND, ELASTIC + '<pin id="0 1"/>'), {}, (np.arange(8) * 0.15, 0.01, 2, 0)),
    "turned": (
        flex(
            ROUND + ' euler="10 20 30"',
            ELASTIC + '<pin range="0 1"/>',
            around='<body name="b" euler="0 0 90">{}</body>',
        ),
        {},
        (np.arange(8) * 0.15, 0.01, 2, 0),
    ),
    "pinned": (flex(ROUND, ELASTIC + '<pin id="0"/>'), {}, (np.arange(8) * 0.15, 0.01, 1, 0)),
    "free": (flex(ROUND, ELASTIC), {}, (np.arange(8) * 0.15, 0.01, 0, 0)),
    "three pinned": (flex(ROUND, ELASTIC + '<pin id="0 1 2"/>'), {}, (np.arange(8) * 0.15, 0.01, 3, 0)),
    "both clamped": (flex(ROUND, ELASTIC + '<pin id="0 1 6 7"/>'), {}, (np.arange(8) * 0.15, 0.01, 2, 2)),
    "clamped and pinned": (flex(ROUND, ELASTIC + '<pin id="0 1 7"/>'), {}, (np.arange(8) * 0.15, 0.01, 2, 1)),
    "uneven": (
        direct([(0.0, x, 0.0) for x in UNEVEN], "4 5 3 4 2 3 1 2 0 1", ELASTIC + '<pin id="0 1"/>'),
        {},
        (np.array(UNEVEN), 0.01, 2, 0),
    ),
    "box, soft": (
        flex(EIGHT, BOX + '<pin id="0 1"/>'),
        {"plane": "y"},
        (np.arange(8) * 0.15, (0.01, 0.03), 2, 0),
    ),
    "box, stiff": (
        flex(EIGHT, BOX + '<pin id="0 1"/>'),
        {"plane": "z"},
        (np.arange(8) * 0.15, (0.03, 0.01), 2, 0),
    ),
    "box along y, soft": (
        flex(EIGHT + ' euler="0 0 90"', BOX + '<pin id="0 1"/>'),
        {"plane": "z"},
        (np.arange(8) * 0.15, (0.01, 0.03), 2, 0),
    ),
    "box aslant, soft": (
        flex(EIGHT + ' euler="20 30 40"', BOX + '<pin id="0 1"/>'),
        {"plane": "z"},
        (np.arange(8) * 0.15, (0.01, 0.03), 2, 0),
    ),
}


def written(folder: Path, text: str) -> Path:
    (folder / "flex.xml").write_text(text)
    return folder / "flex.xml"


def of_points(places: np.ndarray, section: Any, near: int, far: int) -> np.ndarray:
    """Frequencies [Hz] of equal point masses of 0.6 kg in all, by second differences of their deflections."""
    second = 4 / 3 * section[0] ** 3 * section[1] if isinstance(section, tuple) else np.pi * section**4 / 4
    count, edge = len(places), np.diff(places)
    angles = np.zeros((count - 2, count))
    for i in range(1, count - 1):
        left, right = edge[i - 1], edge[i]
        angles[i - 1, i - 1 : i + 2] = 1 / left, -1 / left - 1 / right, 1 / right
    stiffness = angles.T @ np.diag(2.5e8 * second * 2 / (edge[:-1] + edge[1:])) @ angles
    free = slice(near, count - far)
    squares = np.linalg.eigvalsh(stiffness[free, free] * count / 0.6)
    return np.sqrt(squares[squares > 1e-6 * squares[-1]][:3]) / (2 * np.pi)


@pytest.mark.parametrize("name", RODS)
def test_flexes_ring_as_springs_between_point_masses(name: str, tmp_path: Path) -> None:
    text, asked, given = RODS[name]
    found = audit_file(written(tmp_path, text), BEAM, **asked)  # type: ignore[arg-type]
    np.testing.assert_allclose(found.angular_frequency / (2 * np.pi), of_points(*given), rtol=1e-9)
    ends = {0: "free", 1: "pinned", 2: "clamped", 3: "clamped"}
    assert sorted(found.boundary.name.split("-")) == sorted((ends[given[2]], ends[given[3]]))


def linearized(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and damping ratios by MuJoCo: forces differentiated about rest, edges held."""
    mujoco = pytest.importorskip("mujoco")
    if int(mujoco.__version__.split(".")[0]) < 4:
        pytest.skip("rods of MuJoCo 3 do not bend like beams")
    model = mujoco.MjModel.from_xml_string(text)
    data, size = mujoco.MjData(model), model.nv

    def force(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = position, speed
        mujoco.mj_forward(model, data)
        return np.array(data.qfrc_passive)

    rest, step = np.zeros(size), 2e-6 * np.eye(size)
    stiffness = np.array([force(-e, rest) - force(e, rest) for e in step]).T / 4e-6
    drag = np.array([force(rest, -e) - force(rest, e) for e in step]).T / 4e-6
    force(rest, rest)
    mass = np.zeros((size, size))
    mujoco.mj_fullM(model, data, mass)
    held = np.zeros((data.nefc, size))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(held, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        held = data.efc_J.reshape(-1, size)
    free = scipy.linalg.null_space(held[data.efc_type == 0])
    squares, shapes = scipy.linalg.eigh(free.T @ (stiffness + stiffness.T) @ free / 2, free.T @ mass @ free)
    modes = free @ shapes[:, squares > 1.0]
    omega = np.sqrt(squares[squares > 1.0])
    return omega / (2 * np.pi), np.einsum("im,ij,jm->m", modes, drag, modes) / (2 * omega)


@pytest.mark.parametrize("name", RODS)
def test_flexes_ring_as_in_mujoco_4(name: str, tmp_path: Path) -> None:
    text, asked, _ = RODS[name]
    hertz, ratio = linearized(text)
    found = audit_file(written(tmp_path, text), BEAM, **asked)  # type: ignore[arg-type]
    for own, damping in zip(found.angular_frequency / (2 * np.pi), found.damping_ratio, strict=True):
        nearest = np.argmin(np.abs(hertz - own))
        assert own == pytest.approx(hertz[nearest], rel=1e-6)
        assert damping == pytest.approx(ratio[nearest], rel=1e-5, abs=1e-9)


def test_what_mujoco_saves_of_a_flex_is_the_same_rod(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    if int(mujoco.__version__.split(".")[0]) < 4:
        pytest.skip("rods of MuJoCo 3 do not bend like beams")
    for name in ("clamped", "free", "box aslant, soft"):
        text, asked, given = RODS[name]
        saved = mujoco.MjSpec.from_string(text).to_xml()
        found = audit_file(written(tmp_path, saved), BEAM, **asked)  # type: ignore[arg-type]
        # Six digits are saved.
        np.testing.assert_allclose(found.angular_frequency / (2 * np.pi), of_points(*given), rtol=2e-5)
    # A heavier last point is a body at the tip.
    last = mujoco.MjSpec.from_string(RODS["clamped"][0]).to_xml()
    tip = re.sub(r'(name="line_7".*?mass=")0.075', r"\g<1>0.375", last, count=1, flags=re.DOTALL)
    found = audit_file(written(tmp_path, tip), BEAM)
    assert found.boundary.name == "clamped-free(mass=0.3)"
    assert found.angular_frequency[0] / (2 * np.pi) == pytest.approx(linearized(tip)[0][0], rel=1e-6)
    held = last.replace("</equality>", '<connect body1="line_7" anchor="0 0 0"/></equality>')
    with pytest.raises(ValueError, match=r"<connect> holds the rod: say by boundary"):
        audit_file(written(tmp_path, held), BEAM)
    said = audit_file(written(tmp_path, held), BEAM, "clamped-pinned")
    due = of_points(np.arange(8) * 0.15, 0.01, 2, 1)
    np.testing.assert_allclose(said.angular_frequency / (2 * np.pi), due, rtol=2e-5)


def test_a_flex_is_judged_from_its_parameters(tmp_path: Path) -> None:
    # young is chosen so that E π r⁴/4 = 2; frequencies of mujoco 4.0.0, linearized.
    text = flex(
        'count="6 1 1" spacing=".2 1 1" pos=".5 0 0" radius=".01" mass=".6"',
        '<edge equality="true"/><elasticity young="2.5464790894703253e8" poisson="0.3"/><pin id="0 1"/>',
    )
    found = audit_file(written(tmp_path, text), Beam(1.0, 2.0, 0.5))
    hertz = found.angular_frequency / (2 * np.pi)
    np.testing.assert_allclose(hertz, [1.14313754, 7.09450015, 17.80589873], rtol=1e-6)
    assert (found.layout, found.segments, found.boundary.name) == ("rigid_stub", 5, "clamped-free")
    assert "EI = 2 N m²" in found.given[0] and "0.6 kg over 1 m" in found.given[0]
    assert any("every point has one segment's mass" in line for line in found.given)
    lighter = audit_file(written(tmp_path, text.replace('mass=".6"', 'mass=".5"')), Beam(1.0, 2.0, 0.5))
    assert any("as any other, where a beam ends with half of that" in line for line in lighter.given)
    # One share of six is too many; held points weigh as much as others.
    assert found.mass_mismatch == pytest.approx(0.2)
    assert all(place is not None and "export hinges" in place.refusal for place in found.spring_places)
    assert (
        audit_file(
            written(tmp_path, text.replace('"0 0 0" ', '"0 0 0" integrator="implicitfast"')), BEAM
        ).step
        is None
    )


@pytest.mark.parametrize(("integrator", "damping"), [("Euler", 0.0), ("Euler", 0.002), ("RK4", 0.002)])
def test_the_longest_step_of_a_flex_is_mujocos(integrator: str, damping: float, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    if int(mujoco.__version__.split(".")[0]) < 4:
        pytest.skip("rods of MuJoCo 3 do not bend like beams")
    inner = ELASTIC.replace('poisson="0.3"', f'poisson="0.3" damping="{damping}"')
    text = flex(
        ROUND, f'{inner}<contact selfcollide="none"/><pin id="0 1"/>', option=f'integrator="{integrator}"'
    )
    step = audit_file(written(tmp_path, text), BEAM).step
    assert step is not None
    grown = []
    for share in (0.97, 1.03):
        model = mujoco.MjModel.from_xml_string(text)
        model.opt.timestep = share * step.limit
        data = mujoco.MjData(model)
        up = [j for j in range(model.njnt) if model.jnt_type[j] == 2 and model.jnt_axis[j][2] == 1]
        data.qvel[model.jnt_dofadr[up]] = 1e-6 * np.random.default_rng(1).standard_normal(len(up))
        for _ in range(1500):
            mujoco.mj_step(model, data)
        grown.append(np.abs(data.qvel).max())
    assert grown[0] < 1e-5 < 1e-3 < grown[1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (flex(ROUND, '<pin id="0 1"/>'), "young above 0: nothing resists its bending"),
        (flex(ROUND, ELASTIC + '<pin id="0 1 4"/>'), "pinned points at its ends"),
        (flex(ROUND, ELASTIC + '<pin range="0 7"/>'), "pinned points at its ends"),
        (flex(ROUND, ELASTIC + '<pin id="0 8"/>'), "points from 0 to 7 in id"),
        (flex(ROUND, ELASTIC, kind="circle"), "type grid or direct to be judged, got 'circle'"),
        (flex(ROUND + ' dof="2d"', ELASTIC), "dof of full, got '2d'"),
        (flex(ROUND.replace("8 1 1", "1000000 1 1"), ELASTIC), "count from 2 to 600, got "),
        (flex(ROUND.replace("8 1 1", "2 1 1"), ELASTIC), "at least three points"),
        (
            flex(ROUND, ELASTIC, around='<body name="b"><joint axis="0 1 0"/><geom size=".1"/>{}</body>'),
            "on what does not move",
        ),
        (direct([(0, 0, 0), (1, 0, 0), (2, 0.1, 0)], "0 1 1 2", ELASTIC), "must be straight"),
        (direct([(0, 0, 0), (1, 0, 0), (2, 0, 0)], "0 1 1 2 2 0", ELASTIC), "one open row of points"),
        (direct([(0, 0, 0), (1, 0, 0), (2, 0, 0)], "0 1 1 3", ELASTIC), "elements of points from 0 to 2"),
        (direct([(0, 0, 0)] * 700, "0 1", ELASTIC), "rows of 3 numbers in point, at most 600"),
        (flex(ROUND, BOX.replace(".01 .03", "0 .03")), "sectionsize of two numbers above 0"),
        (
            '<mujoco><deformable><flex dim="1" body="a b c" element="0 1 1 2"/></deformable></mujoco>',
            "bodies of the model, got 'a'",
        ),
        (
            flex(ROUND.replace('"8 1 1"', '"8 8 1"'), ELASTIC).replace('dim="1"', 'dim="2"'),
            "<flexcomp name='line'> is left out",
        ),
    ],
)
def test_what_is_no_straight_rod_is_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        audit_file(written(tmp_path, text), BEAM)


def test_a_rod_or_cable_beside_a_chain_or_on_it(tmp_path: Path) -> None:
    rod = '<geom type="cylinder" fromto="0 0 0 .2 0 0" size=".005" mass=".1"/>'
    link = f'<joint axis="0 1 0" stiffness="10"/>{rod}'
    chain = f'<body>{link}<body name="end" pos=".2 0 0">{link}@</body></body>'
    bent = '<composite type="cable" curve="s sin(s)" size="1 .2 1" count="8"/>'
    hanging = '<flexcomp name="line" dim="1" count="8 1 1" type="circle"/>'
    world = "<mujoco><worldbody>{}</worldbody>{}</mujoco>"
    beside = audit_file(written(tmp_path, world.format(chain.replace("@", "") + bent + hanging, "")), BEAM)
    assert any(
        "line 1: <composite> must have a geom" in line or "straight" in line for line in beside.assumed
    )
    with pytest.raises(ValueError, match="what a rod does to the body that carries it is not read"):
        audit_file(written(tmp_path, world.format(chain.replace("@", hanging), "")), BEAM)
    flex = '<deformable><flex name="web" dim="2" body="world end"/></deformable>'
    with pytest.raises(ValueError, match="<flex name='web'> holds the chain: say by boundary"):
        audit_file(written(tmp_path, world.format(chain.replace("@", ""), flex)), BEAM)


def test_other_motions_of_a_flex_are_refused_by_name(tmp_path: Path) -> None:
    beam = Beam(1.05, 2.0, 0.5, torsional_stiffness=1.5, polar_inertia_per_length=1e-4)
    with pytest.raises(ValueError, match="flex line is judged in bending only"):
        audit_file(written(tmp_path, RODS["clamped"][0]), beam, motion="space")
