"""Cables of MuJoCo 3, in a composite and as saved: judged as MuJoCo 3.3.7 moves them.

Frequencies in Hz come from MuJoCo 3.3.7: passive forces of its plugin differentiated centrally about rest in
all joint coordinates (steps of 1e-5 rad), its mass matrix, its constraints as null space. MuJoCo 4 has no
cables.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from beammodes.auditing.audit_model import audit_file
from beammodes.problem.beam import Beam

BEAM = Beam(1.0, 2.0, 0.5)
ROD = '<joint kind="main" damping="0"/><geom type="cylinder" size=".02" density="397.8873577297"/>'
CAPSULE = '<geom type="capsule" size=".01" mass="0.07"/>'
BOX = '<geom type="box" size=".1 .01 .03" density="500"/>'


def composite(
    attributes: str,
    inner: str = ROD,
    *,
    bend: float = 1.6e7,
    twist: float = 1e7,
    around: str = "{}",
    more: str = "",
) -> str:
    plugin = (
        f'<plugin plugin="mujoco.elasticity.cable"><config key="twist" value="{twist}"/>'
        f'<config key="bend" value="{bend}"/></plugin>'
    )
    cable = f'<composite type="cable" {attributes}>{plugin}{inner}</composite>'
    return (
        '<mujoco><option gravity="0 0 0"/><extension><plugin plugin="mujoco.elasticity.cable"/></extension>'
        f"<worldbody>{around.format(cable)}</worldbody>{more}</mujoco>"
    )


def saved(
    count: int = 5, *, tip: str = "", geoms: dict[int, str] | None = None, bend: float = 1.5915494309189535e7
) -> str:
    """As mj_saveLastXML writes a cable of 1 m, with further elements at the tip or other geoms."""
    text, step = tip, 1 / count
    for i in reversed(range(count)):
        size = (geoms or {}).get(i, f'size="0.02 {step / 2}" density="397.8873577297"')
        joint = f'<joint name="J_{i}" type="ball" group="3"/>' if i else ""
        geom = f'<geom {size} pos="{step / 2} 0 0" quat="0.707107 0 -0.707107 0" type="cylinder"/>'
        where = f'pos="{step} 0 0"' if i else ""
        text = f'<body name="B_{i}" {where}>{joint}{geom}<plugin instance="composite"/>{text}</body>'
    return (
        '<mujoco><compiler angle="radian"/><option gravity="0 0 0"/><extension>'
        '<plugin plugin="mujoco.elasticity.cable"><instance name="composite">'
        f'<config key="twist" value="1e7"/><config key="bend" value="{bend}"/></instance></plugin>'
        "</extension>"
        f"<worldbody>{text}</worldbody></mujoco>"
    )


ALONG = 'curve="s" count="8" size="1" initial="none"'
WELD = '<equality><weld body1="B_last"/></equality>'
TOOL = '<body name="tool" pos="0.2 0 0"><geom type="box" size=".02 .02 .02" mass=".3"/></body>'

#: A file, what else is asked, its ends, and MuJoCo's frequencies in that plane.
CABLES: dict[str, tuple[str, dict[str, str], str, list[float]]] = {
    "by z": (
        composite('curve="0 0 s" count="7" size="1.3 0 0" offset="1 2 3" initial="none"', CAPSULE),
        {},
        "clamped-free",
        [0.2474184, 1.57093883, 4.40248614],
    ),
    "free": (
        composite('curve="s s" count="7 1 1" size="1.3 0 0" initial="free"', CAPSULE),
        {},
        "free-free",
        [0.77679171, 2.11735873, 4.02741627],
    ),
    "ball": (
        composite('curve="s" count="7 1 1" size="1.3 0 0"', CAPSULE),
        {},
        "pinned-free",
        [0.90151848, 2.89327764, 5.89303117],
    ),
    "box across x, on edge": (
        composite('curve="0 s s" count="8" initial="none"', BOX),
        {"plane": "x"},
        "clamped-free",
        [0.33695171, 2.13959314, 6.04849065],
    ),
    "box across x, flat": (
        composite('curve="0 s s" count="8" initial="none"', BOX),
        {"plane": "y"},
        "clamped-free",
        [1.01048507, 6.40170188, 18.01996193],
    ),
    "box in a frame": (
        composite(ALONG, BOX, around='<frame pos="0 1 0" euler="30 20 10">{}</frame>'),
        {"plane": "y"},
        "clamped-free",
        [0.67387257, 4.27775833, 12.08642541],
    ),
    "without twist": (composite(ALONG, twist=0.0), {}, "clamped-free", [1.3081689, 8.29474305, 23.38587319]),
    "armature": (
        composite(ALONG, '<joint kind="main" armature=".001" stiffness="2" damping=".1"/>' + CAPSULE),
        {},
        "clamped-free",
        [0.59584622, 3.44919694, 6.63631524],
    ),
    "uneven": (
        composite('vertex="0 0 0 .1 0 0 .4 0 0 .6 0 0 .8 0 0 1 0 0" initial="none"'),
        {},
        "clamped-free",
        [1.44587828, 7.68468841, 20.78757555],
    ),
    "welded tip": (
        composite('curve="s" count="7 1 1" initial="none"', more=WELD),
        {"boundary": "clamped-clamped"},
        "clamped-clamped",
        [10.95234075, 31.29684724, 60.19662756],
    ),
    "tool": (
        saved(tip=TOOL),
        {},
        "clamped-free(mass=0.3, rotary_inertia=8e-05, on_segment=true)",
        [0.72091476, 6.70018341, 20.93159185],
    ),
    "one thicker": (
        saved(geoms={2: 'size="0.025 0.1" mass="0.1"'}),
        {},
        "clamped-free",
        [1.52474199, 9.44315124, 30.22150196],
    ),
}


def written(folder: Path, text: str) -> Path:
    (folder / "cable.xml").write_text(text)
    return folder / "cable.xml"


@pytest.mark.parametrize("name", CABLES)
def test_cables_ring_as_in_mujoco_3(name: str, tmp_path: Path) -> None:
    text, asked, ends, due = CABLES[name]
    found = audit_file(written(tmp_path, text), BEAM, **asked)  # type: ignore[arg-type]
    assert found.boundary.name == ends
    np.testing.assert_allclose(found.angular_frequency / (2 * np.pi), due, rtol=1e-6)


def test_a_cable_is_judged_from_its_parameters(tmp_path: Path) -> None:
    # bend is chosen so that E π r⁴/4 = 2; MuJoCo 3.3.7 as above.
    due = [1.39709635, 8.98343212, 25.26505559]
    text = composite('curve="s" count="6 1 1" initial="none"', bend=1.5915494309189535e7)
    for each in (text, saved()):
        found = audit_file(written(tmp_path, each), BEAM)
        np.testing.assert_allclose(found.angular_frequency / (2 * np.pi), due, rtol=1e-6)
        assert (found.layout, found.segments, found.boundary.name) == ("rigid_stub", 5, "clamped-free")
        assert "EI = 2 N m², GJ = 2.51327 N m², 0.5 kg/m over 1 m" in found.given[0]
        assert any("twist may need a shorter step" in line for line in found.assumed)
        assert found.suggestions[0].name == "rigid_stub_corrected"
    # MuJoCo lets neighbours of a composite not touch each other.
    capsules = composite('curve="s" count="6 1 1" initial="none"', CAPSULE)
    assert "contact" not in audit_file(written(tmp_path, capsules), BEAM).text


def test_the_springs_advised_are_set_by_the_sizes_of_geoms(tmp_path: Path) -> None:
    found = audit_file(written(tmp_path, saved()), BEAM)
    better = found.suggestions[0]
    said = (
        "rigid_stub_corrected is set by the sizes of its bodies' first geoms in the saved cable, their masses"
    )
    assert f"{said} said: times 0.84989, 1.1442, 1, 1" in found.text
    radius = 0.02 * (better.joint_stiffness / found.joint_stiffness) ** 0.25
    geoms = {i + 1: f'size="{float(r)!r} 0.1" mass="0.1"' for i, r in enumerate(radius)}
    mended = audit_file(written(tmp_path, saved(geoms=geoms)), BEAM)
    np.testing.assert_allclose(mended.joint_stiffness, better.joint_stiffness, rtol=1e-12)
    # What is left is due to the other radii's rotary inertia; MuJoCo 3.3.7 as above.
    assert mended.errors[0] == pytest.approx(better.errors[0], abs=2e-4)
    np.testing.assert_allclose(
        mended.angular_frequency / (2 * np.pi), [1.14560562, 8.83997669, 27.93169323], rtol=1e-6
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (composite('curve="s sin(s)" size="1 .2 1" count="8"'), "must be straight to be judged"),
        (composite('count="8"'), "points that are apart"),
        (composite('curve="s" count="8 2 1"'), "count from 2 to 600 along a line"),
        (composite('curve="s" count="100000"'), "count from 2 to 600 along a line, got '100000'"),
        (composite('vertex="0 0 0 1"'), "points of three numbers"),
        (composite(f'{ALONG} prefix="{"x" * 1000}"'), "printable prefix of at most 100"),
        (re.sub("<composite.*</composite>", lambda found: found[0] * 1000, composite(ALONG)), "at most 5000"),
        (composite('curve="s" count="8" quat="2 0 0 0"'), "quat of length 1"),
        (composite('curve="s" count="8" initial="held"'), "initial of none, ball or free, got 'held'"),
        (composite('curve="t" count="8"'), "curve of up to three of"),
        (
            composite(ALONG, '<geom type="sphere" size=".1"/>'),
            "geom of type capsule, cylinder, box, got 'sphere'",
        ),
        (composite(ALONG, bend=0.0), "bend above 0: nothing resists its bending"),
        (
            saved().replace('type="cylinder"', 'type="ellipsoid"').replace("0.02 0.1", "0.02 0.1 0.1"),
            "first geom of type",
        ),
        (
            saved().replace('name="B_3" pos="0.2 0 0"', 'name="B_3" pos="0.2 0 0" quat="1 0.1 0 0"'),
            "bent or twisted at rest",
        ),
        (saved().replace('type="ball" group="3"', 'axis="0 1 0"'), "must be on one ball joint"),
        # Bodies with an instance each have no springs, nor has one that another body is not before.
        (
            saved().replace('<plugin instance="composite"/>', '<plugin plugin="mujoco.elasticity.cable"/>'),
            "without; J_1 on body B_1 must be a hinge or a ball",
        ),
        (re.sub("<body name=.B_0.*?>", '\\g<0><body name="x"/>', saved(2)), "without branches"),
    ],
)
def test_what_no_cable_or_no_straight_one_has_is_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        audit_file(written(tmp_path, text), BEAM)


def test_a_cable_twists_as_in_mujoco_3(tmp_path: Path) -> None:
    text = composite('curve="s" count="9 1 1" initial="none"')
    rod = Beam(1.0, 2.0, 0.5, torsional_stiffness=2.51327, polar_inertia_per_length=1e-4)
    found = audit_file(written(tmp_path, text), rod, motion="twist")
    due = [42.19826642, 124.75053254, 201.85060176]
    np.testing.assert_allclose(found.angular_frequency / (2 * np.pi), due, rtol=1e-6)
