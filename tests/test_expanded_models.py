"""Files that only MuJoCo can expand: judged as it makes them, by a process with limits, or refused."""

from __future__ import annotations

import importlib.util
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from beammodes.auditing import expand_with_mujoco
from beammodes.auditing.audit_model import audit_file
from beammodes.problem.beam import Beam

BEAM = Beam(1.0, 2.0, 0.5)
ROD = '<geom type="cylinder" fromto="0 0 0 0.2 0 0" size="0.005" mass="0.1"/>'
SHELL = ROD.replace("/>", ' shellinertia="true"/>')
MESH = '<geom type="mesh" mesh="link" density="1000"/>'
STILL = '<mujoco><option gravity="0 0 0"/>'

has_mujoco = pytest.mark.skipif(importlib.util.find_spec("mujoco") is None, reason="MuJoCo is not installed")


def chain(geom: str) -> str:
    text = ""
    for i in reversed(range(5)):
        text = (
            f'<body name="seg{i}" pos="{0.2 * (i > 0)} 0 0">'
            f'<joint name="joint{i}" axis="0 1 0" stiffness="10"/>{geom}{text}</body>'
        )
    return text


def box_mesh() -> bytes:
    """An STL file of 0.2 by 0.02 by 0.02 m, from its origin along x."""
    corners = [(x, y, z) for x in (0.0, 0.2) for y in (-0.01, 0.01) for z in (-0.01, 0.01)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    halves = [half for a, b, c, d in faces for half in ((a, b, c), (a, c, d))]
    rows = [struct.pack("<12fH", 0, 0, 0, *(x for i in half for x in corners[i]), 0) for half in halves]
    return b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def meshed(file: str = 'file="meshes/link.stl"', head: str = "") -> str:
    asset = f'<asset><mesh name="link" {file}/></asset>'
    return f"{STILL}{head}{asset}<worldbody>{chain(MESH)}</worldbody></mujoco>"


ATTACHED = (
    f'{STILL}<asset><model name="arm" file="arm.xml"/></asset><worldbody><body name="base" pos="0 0 1">'
    '<attach model="arm" body="seg0" prefix="a_"/></body></worldbody></mujoco>'
)
CORNERS = (
    'vertex="0 -.01 -.01 0 .01 -.01 0 -.01 .01 0 .01 .01 .2 -.01 -.01 .2 .01 -.01 .2 -.01 .01 .2 .01 .01"'
)
TIES = "".join(f'<joint joint="joint{i}" coef="1"/>' for i in range(5))
FILES = {
    "a mesh": meshed(),
    "a mesh in a folder": meshed(
        'file="link.stl"',
        '<compiler meshdir="meshes"/><asset><texture name="t" type="2d" file="none.png"/>'
        '<material name="m" texture="t"/></asset><visual><headlight ambient="1 1 1"/></visual>',
    ).replace('mesh="link" density', 'mesh="link" material="m" density'),
    "a mesh by corners": meshed(CORNERS),
    "an attached model": ATTACHED,
    "a shell": f"{STILL}<worldbody>{chain(SHELL)}</worldbody></mujoco>",
    "copies with a tendon": (
        f'{STILL}<worldbody><replicate count="2" offset="0 1 0">{chain(ROD)}</replicate></worldbody>'
        f'<tendon><fixed name="t" stiffness="3">{TIES}</fixed></tendon></mujoco>'
    ),
}


def written(folder: Path, text: str) -> Path:
    (folder / "meshes").mkdir(exist_ok=True)
    (folder / "meshes" / "link.stl").write_bytes(box_mesh())
    (folder / "arm.xml").write_text(f"<mujoco model='arm'><worldbody>{chain(ROD)}</worldbody></mujoco>")
    path = folder / "model.xml"
    path.write_text(text)
    return path


def mujoco_frequencies(path: Path) -> np.ndarray:
    """Frequencies [Hz] of MuJoCo's mass matrix with the stiffness of its joints and fixed tendons."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)

    def force(position: np.ndarray) -> Any:
        data.qpos[:] = position
        mujoco.mj_forward(model, data)
        return data.qfrc_passive.copy()

    step = 1e-6 * np.eye(model.nv)
    stiffness = np.array([force(-e) - force(e) for e in step]) / 2e-6
    return np.sqrt(scipy.linalg.eigvalsh((stiffness + stiffness.T) / 2, mass)) / (2 * np.pi)


@has_mujoco
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if "attached" in name else [pytest.mark.slow]) for name in FILES]
)
def test_what_mujoco_makes_of_a_file_is_judged(name: str, tmp_path: Path) -> None:
    try:
        path = written(tmp_path, FILES[name])
        found = audit_file(path, BEAM)
    except ValueError as error:
        if "Schema" in str(error):
            pytest.skip("this version of MuJoCo does not know it")
        raise
    if "material" not in FILES[name]:
        due = mujoco_frequencies(path)
        for own in found.angular_frequency / (2 * np.pi):
            assert np.abs(due / own - 1).min() < 1e-6
    assert found.given[0].startswith("read as MuJoCo ")
    assert all(place is None or "expanded by MuJoCo" in place.refusal for place in found.spring_places)
    assert found.boundary.name.startswith("clamped-")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (meshed('file="../outside.stl"'), "in the model's own folder, got '../outside.stl'"),
        (meshed('file="/etc/passwd"'), "in the model's own folder, got '/etc/passwd'"),
        (meshed('file="meshes/beyond.stl"'), "in the model's own folder"),
        (meshed('file="link.stl"', '<compiler meshdir="/"/>'), "in the model's own folder"),
        (meshed('file="meshes/none.stl"'), "must name a file that can be read: No such file"),
        (
            meshed('file="meshes/link.txt"'),
            r"must be a mesh of type \.stl, \.obj, \.msh, got 'meshes/link\.txt'",
        ),
        (meshed(head='<extension><plugin file="x.so"/></extension>'), "must name no file by file"),
        (ATTACHED.replace("arm.xml", "../../arm.xml"), "in the model's own folder"),
        (ATTACHED.replace("arm.xml", "model.xml"), "must not attach a model to itself"),
        pytest.param(meshed('file="meshes/bad.stl"'), "MuJoCo could not expand it: ", marks=pytest.mark.slow),
    ],
)
@has_mujoco
def test_only_files_of_the_models_folder_are_read(text: str, message: str, tmp_path: Path) -> None:
    folder = tmp_path / "own"
    folder.mkdir()
    (tmp_path / "outside.stl").write_bytes(box_mesh())
    path = written(folder, text)
    (folder / "meshes" / "beyond.stl").symlink_to(tmp_path / "outside.stl")
    (folder / "meshes" / "bad.stl").write_bytes(b"\0" * 84 + b"junk")
    with pytest.raises(ValueError, match=message) as caught:
        audit_file(path, BEAM)
    assert "\n" not in str(caught.value)


def test_without_mujoco_the_refusal_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "mujoco" else find(name))
    with pytest.raises(
        ValueError, match=r"MuJoCo, which could expand it \(pip install mujoco\), is not installed"
    ):
        audit_file(written(tmp_path, ATTACHED), BEAM)


@has_mujoco
@pytest.mark.parametrize(("name", "value"), [("_BYTES", 2**26), ("_WAIT", 0.05)])
def test_it_is_stopped_at_its_limits(
    name: str, value: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(expand_with_mujoco, name, value)
    with pytest.raises(ValueError, match=r"MuJoCo, which is given 10 s, .* MiB.*, ended without an answer"):
        audit_file(written(tmp_path, ATTACHED), BEAM)


@has_mujoco
def test_bounds_that_hold_without_mujoco_are_not_tried_with_it(tmp_path: Path) -> None:
    bombs = '<replicate count="1000" offset="1 0 0">' * 4
    text = f"{STILL}<worldbody>{bombs}{chain(ROD)}{'</replicate>' * 4}</worldbody></mujoco>"
    with pytest.raises(ValueError, match=r"at most 10000 copies, with all others of the file$"):
        audit_file(written(tmp_path, text), BEAM)


@has_mujoco
@pytest.mark.slow
def test_what_grows_within_mujoco_is_stopped_there(tmp_path: Path) -> None:
    grid = '<flexcomp name="grid" type="grid" count="900 900 900"/>'
    with pytest.raises(ValueError, match="MuJoCo"):
        audit_file(written(tmp_path, ATTACHED.replace("<worldbody>", f"<worldbody>{grid}")), BEAM)
