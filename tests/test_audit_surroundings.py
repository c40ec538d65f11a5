"""What an audit says of a file beside its frequencies, each beside MuJoCo: weight, contacts, round caps."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from beammodes.auditing.audit_model import audit_file
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load

COUNT, ELL, SPRING = 4, 0.2, 10.0
BEAM = Beam(COUNT * ELL, SPRING * ELL, 0.5)


def rods(rod: str, ell: float = ELL, tip: str = "") -> str:
    text = ""
    for i in reversed(range(COUNT)):
        text = (
            f'<body name="s{i}" pos="{ell * (i > 0)} 0 0">'
            f'<joint name="j{i}" axis="0 1 0" stiffness="{SPRING}"/>{rod}{tip if i == COUNT - 1 else ""}'
            f"{text}</body>"
        )
    return text


def capsule(ell: float = ELL, more: str = 'density="1000"') -> str:
    return f'<geom type="capsule" fromto="0 0 0 {ell} 0 0" size="0.02" {more}/>'


def model(bodies: str, tail: str = "", gravity: str = "0 0 0", flags: str = "") -> str:
    option = f'<option gravity="{gravity}">{flags}</option>'
    return f"<mujoco>{option}<worldbody>{bodies}</worldbody>{tail}</mujoco>"


CROSS = ""
for index in reversed(range(COUNT)):
    CROSS = (
        f'<body name="c{index}" pos="{ELL * (index > 0)} 0 0"><joint axis="0 1 0" stiffness="10"/>'
        f'<geom size="0.005" mass="0.001"/><body name="s{index}"><joint axis="0 0 1" stiffness="10"/>'
        f"{capsule()}{CROSS}</body></body>"
    )
WALL = '<geom type="box" size="0.1 0.1 0.1" pos="-0.1 0 0"/>'
APART = '<contact><exclude body1="wall" body2="s0"/></contact>'
FLOOR = '<geom type="plane" size="1 1 1" pos="0 0 {}"/>'

SCENES: dict[str, str] = {
    "alone": model(rods(capsule())),
    "turned": model(f'<frame euler="10 20 30">{rods(capsule())}</frame>'),
    "short segments": model(rods(capsule(0.03), 0.03)),
    "small links between hinges": model(CROSS),
    "a wall of the ground": model(WALL + rods(capsule())),
    "a wall of the ground, contact off": model(WALL + rods(capsule()), flags='<flag contact="disable"/>'),
    "on a body of the ground": model(f'<body name="wall">{WALL}{rods(capsule())}</body>'),
    "excluded": model(f'<body name="wall">{WALL}{rods(capsule())}</body>', APART),
    "on a body that moves": model(f'<body name="arm"><joint axis="0 0 1"/>{WALL}{rods(capsule())}</body>'),
    "parents touch": model(rods(capsule()), flags='<flag filterparent="disable"/>'),
    "on the floor": model(FLOOR.format(0) + rods(capsule())),
    "above the floor": model(FLOOR.format(-0.021) + rods(capsule())),
    "of other kinds": model(FLOOR.format(0) + rods(capsule(more='contype="2" conaffinity="0"'))),
    "a post beside": model(
        rods(capsule()) + '<body name="post" pos="0.3 0 0"><geom type="cylinder" size="0.03 0.5"/></body>'
    ),
    "a ball on the tip": model(
        rods(capsule(), tip='<body pos="0.2 0 0"><geom size="0.05" mass="0.1"/></body>')
    ),
}


@pytest.mark.parametrize("scene", SCENES)
def test_contacts_that_are_left_on_are_those_of_mujoco(scene: str, tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    path = tmp_path / "model.xml"
    path.write_text(SCENES[scene])
    engine = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(engine)
    mujoco.mj_forward(engine, data)
    names = {
        frozenset(engine.body(engine.geom_bodyid[geom]).name for geom in (contact.geom1, contact.geom2))
        for contact in data.contact
        if contact.dist < -1e-9
    }
    said = [line for line in audit_file(path, BEAM).assumed if line.startswith("contact is left out")]
    assert len(said) == bool(names)
    for line in said:
        found = re.findall(r"[:,] ([\w ]+?) and ([\w ]+?)(?=,| overlap| and \d)", line)
        pairs = [frozenset("world" if name == "the ground" else name for name in pair) for pair in found]
        assert set(pairs) <= names and len(pairs) == min(3, len(names))


@pytest.mark.parametrize("said", ['density="1000"', 'mass="0.3"'])
def test_round_caps_of_capsules_are_said_with_their_mass(said: str, tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(model(rods(capsule(more=said))))
    density = 1000 * math.pi * 0.02**2 if "density" in said else 0.3 / ELL
    found = audit_file(path, Beam(COUNT * ELL, SPRING * ELL, density))
    # Two half balls beside a tube: 4r/3 beside its length.
    beside = 4 / 3 * 0.02 / ELL
    line = next(line for line in found.matter if "round caps" in line)
    assert f"hold {100 * beside / (1 + beside):.3g} % of the chain's mass" in line
    assert (f"+{100 * beside:.3g} % off the beam's" in line) == ("density" in said)
    assert found.mass_mismatch == pytest.approx(beside if "density" in said else 0, abs=1e-9)


@pytest.mark.parametrize("gravity", [(3.0, 0.0, -4.0), (-9.0, 0.0, 0.0), (0.0, 2.0, -1.0)])
def test_what_weight_does_to_chain_and_beam(gravity: tuple[float, float, float], tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    path = tmp_path / "model.xml"
    rod = '<inertial pos="0.1 0 0" mass="0.1" diaginertia="1e-6 3.3e-4 3.3e-4"/>'
    path.write_text(model(rods(rod), gravity=" ".join(map(str, gravity))))
    found = audit_file(path, BEAM)
    engine = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(engine)
    mass, stiffness = np.zeros((COUNT, COUNT)), np.diag(engine.jnt_stiffness)

    def bias(angle: np.ndarray) -> np.ndarray:
        data.qpos[:] = angle
        mujoco.mj_forward(engine, data)
        return np.array(data.qfrc_bias)

    weight = bias(np.zeros(COUNT))
    mujoco.mj_fullM(engine, data, mass)
    step = 1e-5
    slope = np.array([(bias(step * row) - bias(-step * row)) / (2 * step) for row in np.eye(COUNT)])
    due = [
        math.sqrt(scipy.linalg.eigh(matrix, mass, eigvals_only=True)[0])
        for matrix in (stiffness + slope, stiffness)
    ]
    text = "\n".join(found.weight)
    assert any("gravity is left out here" in line for line in found.assumed)
    if gravity[0]:
        load = Load(gravity=(gravity[0], 0.0))
        beam = [
            euler_bernoulli(BEAM, "clamped-free", 1, load=each).angular_frequency[0] for each in (load, None)
        ]
        read = re.search(r"mode 1 by (\S+) % in the chain and by (\S+) % in the beam", text)
        assert read is not None
        percents = [100 * (pair[0] / pair[1] - 1) for pair in (due, beam)]
        assert [float(part) for part in read.groups()] == pytest.approx(percents, rel=6e-3)
    if gravity[2]:
        # The tip's fall by the angles under the weight; of the beam q L⁴/(8 EI).
        angles = np.cumsum(np.linalg.solve(stiffness, -weight))
        sags = [ELL * angles.sum(), 0.5 * gravity[2] * BEAM.length**4 / (8 * SPRING * ELL)]
        read = re.search(r"its tip sag by (\S+) m in the chain and by (\S+) m in the beam", text)
        assert read is not None
        assert [float(part) for part in read.groups()] == pytest.approx(np.abs(sags), rel=6e-4)
