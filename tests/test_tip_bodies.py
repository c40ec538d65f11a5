"""Equal links with a box at the tip, the commonest layout of robots, in every way that files have it.

Truth is the numbers that a file was written of; where it is installed, also Pinocchio's matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from test_engines import elastic_frequencies, pinocchio_matrices
from turns import in_turns

from beammodes.auditing.audit import audit_chain
from beammodes.auditing.audit_model import audit_file
from beammodes.auditing.mended_files import mend_file
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End

LENGTH, STIFFNESS, DENSITY = 0.8, 2.0, 0.5
BEAM = Beam(LENGTH, STIFFNESS, DENSITY)
COUNT = 4
ELL = LENGTH / COUNT
SPRING = STIFFNESS / ELL
#: Mass, rotary inertia about the centre of mass, and how far that is beyond the beam's end.
BODIES = [(0.02, 2e-5, 0.04), (0.1, 1e-4, 0.0), (0.5, 4e-4, 0.04), (3.0, 3e-3, -0.06)]
#: How it is fixed: in the last link's own numbers, on a fixed joint, on a hinge like the others, on a motor.
FIXED = ["combined", "fixed", "hinge", "motor"]
#: What holds the first link: a hinge with a spring, one without, the wall; that by a whole or half a link.
STARTS = ["hinge", "pivot", "stub", "half"]
LAYOUT = {"hinge": "naive", "pivot": "mitiguy", "stub": "rigid_stub", "half": "half_stub"}


@dataclass(frozen=True)
class Link:
    """A body, its joint at `x` of the one before, and its matter about its own origin."""

    name: str
    parent: str
    x: float
    joint: str
    mass: float
    centre: float
    inertia: float


def links(start: str, fixed: str, body: tuple[float, float, float]) -> list[Link]:
    lengths = [ELL / 2, *[ELL] * (COUNT - 1), ELL / 2] if start == "half" else [ELL] * COUNT
    kinds = ["fixed" if start in ("stub", "half") else start, *["hinge"] * (len(lengths) - 1)]
    rows, parent, x = [], "world", 0.0
    for i, (length, kind) in enumerate(zip(lengths, kinds, strict=True)):
        mass, centre = DENSITY * length, length / 2
        inertia = mass * length**2 / 12
        if fixed == "combined" and i == len(lengths) - 1:
            whole, arm = mass + body[0], length + body[2] - centre
            inertia += body[1] + mass * body[0] / whole * arm**2
            mass, centre = whole, centre + body[0] / whole * arm
        rows.append(Link(f"s{i}", parent, x, kind, mass, centre, inertia))
        parent, x = f"s{i}", length
    if fixed != "combined":
        rows.append(Link("box", parent, x, fixed, body[0], body[2], body[1]))
    return rows


def urdf(rows: list[Link]) -> str:
    text = '<robot name="arm"><link name="world"/>'
    for row in rows:
        kind = "fixed" if row.joint == "fixed" else "revolute"
        text += (
            f'<link name="{row.name}"><inertial><origin xyz="{row.centre!r} 0 0"/>'
            f'<mass value="{row.mass!r}"/><inertia ixx="1e-6" iyy="{row.inertia!r}" izz="{row.inertia!r}" '
            f'ixy="0" ixz="0" iyz="0"/>'
            f'</inertial></link><joint name="j_{row.name}" type="{kind}">'
            f'<parent link="{row.parent}"/><child link="{row.name}"/><origin xyz="{row.x!r} 0 0"/>'
            '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        )
    return f"{text}</robot>"


def sdf(rows: list[Link]) -> str:
    text, at = '<sdf version="1.9"><model name="arm">', {"world": 0.0}
    for row in rows:
        at[row.name] = at[row.parent] + row.x
        own = f"<dynamics><spring_stiffness>{SPRING!r}</spring_stiffness></dynamics>" * (row.joint == "hinge")
        axis = "" if row.joint == "fixed" else f"<axis><xyz>0 1 0</xyz>{own}</axis>"
        text += (
            f'<link name="{row.name}"><pose>{at[row.name]!r} 0 0 0 0 0</pose><inertial>'
            f"<pose>{row.centre!r} 0 0 0 0 0</pose><mass>{row.mass!r}</mass><inertia><ixx>1e-6</ixx>"
            f"<iyy>{row.inertia!r}</iyy><izz>{row.inertia!r}</izz></inertia></inertial></link>"
            f'<joint name="j_{row.name}" type="{"fixed" if row.joint == "fixed" else "revolute"}">'
            f"<parent>{row.parent}</parent><child>{row.name}</child>{axis}</joint>"
        )
    return f"{text}</model></sdf>"


def mjcf(rows: list[Link]) -> str:
    text = ""
    for row in reversed(rows):
        spring = f' stiffness="{SPRING!r}"' * (row.joint == "hinge")
        joint = "" if row.joint == "fixed" else f'<joint name="j_{row.name}" axis="0 1 0"{spring}/>'
        moments = f"{0.1 * row.inertia!r} {row.inertia!r} {row.inertia!r}"
        text = (
            f'<body name="{row.name}" pos="{row.x!r} 0 0">{joint}<inertial pos="{row.centre!r} 0 0" '
            f'mass="{row.mass!r}" diaginertia="{moments}"/>{text}</body>'
        )
    return f'<mujoco><option gravity="0 0 0"/><worldbody>{text}</worldbody></mujoco>'


def written(folder: Path, kind: str, rows: list[Link]) -> Path:
    path = folder / f"model.{kind}"
    path.write_text({"urdf": urdf, "sdf": sdf, "xml": mjcf}[kind](rows))
    sprung = [row.name for row in rows if row.joint == "hinge"]
    if kind == "urdf":
        springs = "".join(f"- {{joint: j_{name}, stiffness: {SPRING!r}}}\n" for name in sprung)
        (folder / "model.springs.yaml").write_text(f"springs:\n{springs}")
    return path


@pytest.mark.parametrize(
    ("start", "fixed", "kind", "body"), in_turns(STARTS, FIXED, ["urdf", "sdf", "xml"], BODIES, every=7)
)
def test_the_body_is_told_from_the_links_and_the_layout_is_named(
    start: str, fixed: str, kind: str, body: tuple[float, float, float], tmp_path: Path
) -> None:
    rows = links(start, fixed, body)
    path = written(tmp_path, kind, rows)
    boundary = None
    if fixed == "motor":
        with pytest.raises(ValueError, match=r'with j_box held it is "(.*)"') as caught:
            audit_file(path, BEAM)
        boundary = str(caught.value).split('"')[-2]
    found = audit_file(path, BEAM, boundary)
    end = found.boundary.right
    assert [end.mass, end.rotary_inertia, end.offset] == pytest.approx(body, rel=1e-6, abs=1e-12)
    assert (found.length_mismatch, found.mass_mismatch) == pytest.approx((0, 0), abs=1e-6)
    exact = euler_bernoulli(BEAM, found.boundary, 3).angular_frequency
    assert found.errors == pytest.approx(found.angular_frequency / exact - 1, abs=1e-12)
    if start == "half" and fixed == "hinge":
        return  # a last half link on a hinge of its own is no layout of equal links
    # Between a pivot and a body's own hinge, the latter is at an end that bends.
    layout = "naive" if (start, fixed) == ("pivot", "hinge") else LAYOUT[start]
    assert layout in found.remark and found.segments == COUNT
    assert ("a body is part of the last segment" in found.remark) == (fixed != "hinge")
    if kind == "urdf":
        pinocchio = pytest.importorskip("pinocchio")
        model = pinocchio.buildModelFromXML(urdf([row for row in rows if row.joint != "motor"]))
        if fixed != "motor":
            numbers = {f"j_{row.name}": SPRING for row in rows if row.joint == "hinge"}
            known = elastic_frequencies(*pinocchio_matrices(pinocchio, model, numbers), len(numbers))
            assert found.angular_frequency == pytest.approx(known[:3], rel=1e-8)


@pytest.mark.parametrize(
    ("kind", "start", "fixed"),
    in_turns(["urdf", "sdf", "xml"], ["hinge", "stub"], ["combined", "hinge"], every=2),
)
def test_springs_for_the_same_hinges_are_written(kind: str, start: str, fixed: str, tmp_path: Path) -> None:
    rows = links(start, fixed, BODIES[2])
    path = written(tmp_path, kind, rows)
    suffix = "springs.yaml" if kind == "urdf" else kind
    mended = mend_file(path, tmp_path / f"mended.{suffix}", BEAM)
    assert abs(mended.audit.errors[0]) < 0.03 < 0.15 < abs(mended.before.errors[0])
    assert mended.audit.boundary.right == mended.before.boundary.right


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("on_segment", [False, True])
def test_the_springs_for_a_body_have_order_three(on_segment: bool, turned: bool) -> None:
    """A welded first segment and the body's own hinge; or a body of much inertia on the last segment."""
    body = End(mass=1.0, rotary_inertia=0.02, offset=0.05, on_segment=on_segment)
    errors = []
    for count in (20, 40):
        ell = 1 / count
        length = [0.0, *[ell] * count] if on_segment else [*[ell] * count, 0.0]
        springs = np.full(count, float(count))
        ends = (End(math.inf, math.inf), body)
        for layout in ("", "found again"):
            columns = [length[::-1], springs[::-1]] if turned else [length, springs]
            found = audit_chain(
                Beam.unit(),
                Boundary(*(ends[::-1] if turned else ends)),
                length=columns[0],
                mass=columns[0],
                rotary_inertia=[each**3 / 12 for each in columns[0]],
                joint_stiffness=columns[1],
            )
            if layout:
                break
            assert (found.layout, found.order) == ("naive" if on_segment else "rigid_stub", 1)
            better = found.suggestions[0]
            assert not better.moves_hinges
            springs = better.joint_stiffness[::-1] if turned else better.joint_stiffness
        name = "gregory with springs for the body" if on_segment else "rigid_stub_corrected"
        assert (found.layout, better.name, found.order) == (name, name, 3)
        errors.append(np.abs(found.errors))
    # The second mode's leading term is small, so that the next one shows.
    first, second, _ = np.log2(errors[0] / errors[1])
    assert first == pytest.approx(3.0, abs=0.1) and second > 2.6


@pytest.mark.parametrize("fixed", ["combined", "fixed"])
def test_a_light_body_is_no_longer_link_where_the_beams_length_says_so(fixed: str, tmp_path: Path) -> None:
    # To first order a point at its tip and a longer link have the same mass, centre and inertia.
    for mass in np.geomspace(0.0003, 3.0, 7).tolist():
        for offset in (0.0, 0.03, 0.1):
            body = (mass, 1e-4 * mass, offset)
            found = audit_file(written(tmp_path, "xml", links("stub", fixed, body)), BEAM)
            end = found.boundary.right
            assert [end.mass, end.rotary_inertia, end.offset] == pytest.approx(body, rel=1e-4, abs=1e-9)
            assert (found.layout, found.length_mismatch) == ("rigid_stub", pytest.approx(0, abs=1e-6))


def test_a_longer_last_link_is_one_where_the_beams_length_says_so(tmp_path: Path) -> None:
    path = written(tmp_path, "xml", links("hinge", "combined", (0.05, 0.05 * 0.1**2 / 12, 0.05)))
    found = audit_file(path, Beam(LENGTH + 0.1, STIFFNESS, DENSITY))
    assert found.length_mismatch == pytest.approx(0, abs=1e-6) and not found.boundary.right.mass


def test_links_by_turns_about_two_axes_end_in_half_a_segment(tmp_path: Path) -> None:
    text = ""
    for i in reversed(range(2 * COUNT)):
        text = (
            f'<body pos="{ELL / 2 * (i > 0)} 0 0"><joint name="j{i}" axis="0 {1 - i % 2} {i % 2}" '
            f'stiffness="{SPRING}"/><geom type="cylinder" fromto="0 0 0 {ELL / 2} 0 0" size=".001" '
            f'mass="{DENSITY * ELL / 2}"/>{text}</body>'
        )
    path = tmp_path / "model.xml"
    path.write_text(f"<mujoco><worldbody>{text}</worldbody></mujoco>")
    for plane, layout in (("z", "naive"), ("y", "half_stub")):
        found = audit_file(path, BEAM, plane=plane)
        assert (found.layout, found.segments) == (layout, COUNT)
        assert found.length_mismatch == pytest.approx(0, abs=1e-6)
