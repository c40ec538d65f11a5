"""The formats that a chain is written in: for each one record, beside the function that makes its text.

A new format is one function under `@_format`: `export_chain`, the command line and the tests of every format
follow from it.

- MJCF, for MuJoCo 3 and 4. Drake reads it without springs.
- SDFormat, for Gazebo and Drake. Drake takes links, joints, dampers and springs, and ignores the world's
  gravity and step. Gazebo's engines take the springs too, by their sources, `bullet-featherstone` since the
  end of 2025; the tests do not run Gazebo.
- URDF, which has no place for springs: they stand in a YAML file beside it.
- Python scripts for PyBullet, which loads a URDF beside it and sets the springs, and for Exudyn.
- USD, for Newton and Isaac Lab, with springs as drives of joints.
- CSV, a row for every piece, which `read_chain_csv` reads back without loss.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.exporters.chain_csv import csv_lines
from beammodes.exporters.engine_scripts import exudyn_script, pybullet_script
from beammodes.exporters.export_facts import one_line
from beammodes.exporters.model_tree import (
    IDENTITY,
    NEARLY_NOTHING,
    Body,
    Joint,
    Rows,
    Tie,
    Tree,
    Vector,
    drawn_thickness,
    links,
    placed,
    principal_moments,
)
from beammodes.exporters.unit_systems import UnitSystem
from beammodes.exporters.usd_text import usd_lines
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import quaternion

__all__ = [
    "FORMATS",
    "MAX_NESTED",
    "SDF_HEAD",
    "XML_HEAD",
    "Format",
    "Model",
    "mjcf_firm",
    "mjcf_ties",
    "yaml_number",
]


@dataclass(frozen=True)
class Model:
    """The content of a file.

    Attributes
    ----------
    chain : Chain or SpatialChain
    tree : Tree
        Of no bodies for formats that take the chain itself.
    facts : tuple of str
        Lines for the head.
    name : str
    paths : tuple of Path
        The file, and the one beside it.
    fragment : bool
        A part for other models to include.
    timestep : float [s]
    integrator : str
        As MuJoCo calls it.
    gravity : triple [m/s²]
    units : UnitSystem
        What the numbers are in, or are taken to be in.
    """

    chain: Chain | SpatialChain
    tree: Tree
    facts: tuple[str, ...]
    name: str
    paths: tuple[Path, ...]
    fragment: bool
    timestep: float
    integrator: str
    gravity: Vector
    units: UnitSystem


#: Return the text of each file, in parts.
Writer = Callable[[Model], Sequence[Iterable[str]]]


@dataclass(frozen=True)
class Format:
    """A format of files.

    Attributes
    ----------
    name, suffix : str
        Such as "mjcf" and ".xml".
    takes : tuple of str
        The optional arguments of `export_chain` that it can hold.
    write : function of a Model
    engine : str
        The integrator that the file's step is for, such as "Drake discrete"; only the engine, "MuJoCo", where
        the argument `integrator` completes it; empty for a format without a step.
    said : tuple of str
        Integrators whose largest stable steps the head says, of a file that has no step.
    beside : str
        Suffix of a second file, if it has one.
    most_bodies : int or None
        A longer chain is refused; None for a format that takes the chain itself, not bodies and joints.
    because : str
        The reason for that limit.
    ties : bool
        It can support both ends.
    balls : bool
        It has ball joints with springs.
    reserved : str
        Pattern of names that its models must not have.
    """

    name: str
    suffix: str
    takes: tuple[str, ...]
    write: Writer
    engine: str = ""
    said: tuple[str, ...] = ()
    beside: str = ""
    most_bodies: int | None = None
    because: str = ""
    ties: bool = False
    balls: bool = False
    reserved: str = ""

    def paths(self, path: Path) -> tuple[Path, ...]:
        """Return the path of each file."""
        if not self.beside:
            return (path,)
        return path, path.with_name(path.name.removesuffix(self.suffix) + self.beside)


_FOUND: dict[str, Format] = {}
#: By their names.
FORMATS: Mapping[str, Format] = MappingProxyType(_FOUND)

#: MuJoCo's XML reader gives up at elements nested 500 deep, and bodies are nested.
MAX_NESTED = 490
#: A longer row of bodies is taken for a mistake.
_MAX_LINKS = 5000
#: MuJoCo refuses moving bodies with less mass or inertia.
_LEAST = 1e-15


def _format(name: str, suffix: str, takes: tuple[str, ...] = (), **facts: Any) -> Callable[[Writer], Writer]:
    """Register a function as the writer of a format."""

    def register(write: Writer) -> Writer:
        _FOUND[name] = Format(name, suffix, takes, write, **facts)
        return write

    return register


def _n(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)


def _head(model: Model, *notes: str) -> tuple[str, ...]:
    return (f"{model.name}: a flexible beam", *model.facts, *model.tree.notes, *notes)


def _comment(model: Model, *notes: str) -> list[str]:
    return ["<!--", *(f"  {line}" for line in _head(model, *notes)), "-->"]


def _carriers(tree: Tree) -> Iterator[str]:
    """Yield what the head says on links between two joints of a node."""
    if any(len(body.joints) > 1 for body in tree.bodies):
        yield f"links *_carrier are between two joints; they have {NEARLY_NOTHING:g} of the mass and of the"
        yield "least moment of inertia of the body that they carry: no frequency shifts by more than 1e-8"


def _check_bodies(model: Model) -> None:
    """Refuse bodies that MuJoCo, Drake and Gazebo refuse: no matter has such moments of inertia."""
    for body in model.tree.bodies:
        moments = principal_moments(body)[0]
        if sum(moments) < 2 * max(moments) * (1 - 1e-12):
            raise ValueError(
                "chain must have pieces whose inertias a body can have, each moment at most the sum of the "
                "two others (a section's inertias about y and z add up to its polar one: give those too), "
                f"got {body.name} with {', '.join(f'{value:.4g}' for value in moments)}"
            )


@_format(
    "mjcf",
    ".xml",
    ("fragment", "second", "damping", "timestep", "integrator", "load", "at"),
    engine="MuJoCo",
    most_bodies=MAX_NESTED,
    because=": MuJoCo's XML reader refuses elements nested 500 deep",
    ties=True,
    balls=True,
)
def _mjcf(model: Model) -> Sequence[Iterable[str]]:
    tree = model.tree
    least = min(
        (value for body in tree.bodies for value in (body.mass, *principal_moments(body)[0])), default=1.0
    )
    if least <= _LEAST:
        raise ValueError(
            f"chain must be in units in which masses and inertias are above 1e-15, the least that MuJoCo "
            f"takes (such as mm and g), got {least:.3g}"
        )
    _check_bodies(model)
    # A fragment is bodies for <worldbody> or a body; with ties it is whole sections for the top of a model.
    whole = not model.fragment or bool(tree.ties)
    lines = [*_comment(model, *_mjcf_notes(model))]
    if model.fragment:
        lines.append("<mujocoinclude>")
    else:
        # MuJoCo's own 1e-8 leaves vibration of 1e-9 rad and less to itself.
        exact = ' tolerance="1e-14"' if tree.ties or tree.anchor else ""
        option = f'timestep="{model.timestep!r}" integrator="{model.integrator}"'
        lines.append(f'<mujoco model="{model.name}">')
        lines.append(f' <option {option} gravity="{_n(*model.gravity)}"{exact}/>')
    bodies = _mjcf_bodies(tree, 2 if whole else 1, model.name)
    if tree.anchor is not None:
        bodies = [f'  <site name="{model.name}_end" pos="{_n(*tree.anchor)}"/>', *bodies]
    lines += [" <worldbody>", *bodies, " </worldbody>"] if whole else bodies
    lines += [*mjcf_ties(tree.ties, model.timestep), *_mjcf_start(model)]
    lines.append("</mujocoinclude>" if model.fragment else "</mujoco>")
    return (["\n".join([*lines, ""])],)


def _mjcf_notes(model: Model) -> Iterator[str]:
    ties = model.tree.ties
    if model.fragment:
        where = "at the top of a model" if ties else "in <worldbody> or a body"
        yield f"include {where}; it needs timestep {model.timestep!r} or less with {model.integrator}"
        yield "gravity is the including model's; with it the beam sags and rings at other frequencies"
    elif any(model.gravity):
        yield "gravity is on: the beam sags and rings at other frequencies than without load"
    else:
        yield "gravity is off: with it the beam sags and rings at other frequencies"
    if model.tree.start:
        yield 'the keyframe "rest" is the shape at rest that it was written for: start from it'
    if model.tree.anchor is not None:
        yield "a constraint between two sites holds its far end, in large motion too; straight, it is not met"
    elif ties:
        slides = "" if any(tie.name.endswith("deflection_x") for tie in ties) else "; it slides along x"
        yield f"tendons support the far end, linear in the joints, for small deflections{slides}"
    if any(tie.stiffness == math.inf for tie in ties):
        yield "its deflection is held by a constraint, which is soft in MuJoCo: frequencies are within 0.02 %"
        yield "for that, solref is twice the timestep and solimp 0.9999; give the solver tolerance 1e-14"


def _mjcf_start(model: Model) -> Iterator[str]:
    """Yield what holds the far end apart from the near one, and the shape to start from."""
    tree, name = model.tree, model.name
    if tree.anchor is not None:
        sites = f'site1="{name}_tip" site2="{name}_end"'
        yield " <equality>"
        yield f'  <connect name="{name}_held_apart" {sites} {mjcf_firm(model.timestep)}/>'
        yield " </equality>"
    if tree.start:
        yield f' <keyframe>\n  <key name="rest" qpos="{_n(*tree.start)}"/>\n </keyframe>'


def _mjcf_bodies(tree: Tree, depth: int, name: str) -> list[str]:
    radius, lines = drawn_thickness(tree) / 2, []
    for i, body in enumerate(tree.bodies):
        pad = " " * (depth + i)
        lines.append(f'{pad}<body name="{body.name}" pos="{_n(*body.position)}"{_quat(body.rotation)}>')
        moments, axes = principal_moments(body)
        mass = f'pos="{_n(*body.centre)}" mass="{_n(body.mass)}" diaginertia="{_n(*moments)}"{_quat(axes)}'
        lines.append(f"{pad} <inertial {mass}/>")
        for joint in body.joints:
            forces = {"stiffness": joint.stiffness, "damping": joint.damping}
            given = "".join(f' {what}="{_n(value)}"' for what, value in forces.items() if value)
            axis = f' axis="{" ".join(map(str, joint.axis))}"' if joint.kind in _KINDS else ""
            lines.append(f'{pad} <joint name="{joint.name}" type="{joint.kind}"{axis}{given}/>')
        if body.length > radius / 10:
            size = f'fromto="0 0 0 {_n(*body.tip)}" size="{_n(radius)}" mass="0"'
            lines.append(f'{pad} <geom type="capsule" {size} contype="0" conaffinity="0"/>')
        if tree.anchor is not None and i + 1 == len(tree.bodies):
            lines.append(f'{pad} <site name="{name}_tip" pos="{_n(*body.tip)}"/>')
    return lines + [f"{' ' * (depth + i)}</body>" for i in reversed(range(len(tree.bodies)))]


def _quat(rotation: Rows) -> str:
    if rotation == IDENTITY:
        return ""
    return f' quat="{_n(*(quaternion(np.array(rotation)) + 0.0))}"'


def _rpy(rotation: Floats) -> Vector:
    """Return roll, pitch and yaw about fixed axes, which turn as the matrix to the last digits."""
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    cos, sin = math.cos(yaw), math.sin(yaw)
    # Of what is left when the yaw is taken back: right at a pitch of a quarter turn, too.
    pitch = math.atan2(-rotation[2, 0], cos * rotation[0, 0] + sin * rotation[1, 0])
    roll = math.atan2(
        sin * rotation[0, 2] - cos * rotation[1, 2], cos * rotation[1, 1] - sin * rotation[0, 1]
    )
    return roll + 0.0, pitch + 0.0, yaw + 0.0


def _along(tip: Vector) -> tuple[Vector, Vector]:
    """Return the middle of a piece, and the angles that turn x into its direction."""
    x, y, z = tip
    return (x / 2, y / 2, z / 2), (0.0, -math.atan2(z, math.hypot(x, y)) + 0.0, math.atan2(y, x) + 0.0)


def mjcf_firm(timestep: float) -> str:
    """Return the attributes of a constraint that is as firm as a step allows."""
    return f'solref="{2 * timestep!r} 1" solimp="0.9999 0.9999 0.001 0.5 2"'


def mjcf_ties(ties: Sequence[Tie], timestep: float) -> Iterator[str]:
    """Yield the lines of tendons for ties."""
    if not ties:
        return
    yield " <tendon>"
    for tie in ties:
        spring = f' stiffness="{_n(tie.stiffness)}" springlength="0"' if tie.stiffness != math.inf else ""
        damping = f' damping="{_n(tie.damping)}"' if tie.damping else ""
        yield f'  <fixed name="{tie.name}"{spring}{damping}>'
        yield from (f'   <joint joint="{joint}" coef="{_n(arm)}"/>' for joint, arm in tie.terms)
        yield "  </fixed>"
    yield " </tendon>"
    if held := [tie.name for tie in ties if tie.stiffness == math.inf]:
        yield " <equality>"
        yield from (f'  <tendon name="{name}_held" tendon1="{name}" {mjcf_firm(timestep)}/>' for name in held)
        yield " </equality>"


XML_HEAD = '<?xml version="1.0" encoding="utf-8"?>'
#: The first version with springs of joints. DART's own reader takes none after 1.6, and finds gravity only
#: where 1.5 has it, in <physics>; Gazebo's and Drake's bring older files up to date.
SDF_HEAD = '<sdf version="1.5">'
_KINDS = {"hinge": "revolute", "slide": "prismatic"}


def _moments(body: Body) -> Iterator[tuple[str, float]]:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    return zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (xx, yy, zz, xy, xz, yz), strict=True)


def _joint_of(body: Body, joint: Joint | None) -> tuple[str, str]:
    """Return the name and the kind of the joint that carries a link."""
    return (f"{body.name}_weld", "fixed") if joint is None else (joint.name, _KINDS[joint.kind])


@_format(
    "sdf",
    ".sdf",
    ("fragment", "second", "damping", "timestep", "load"),
    engine="Drake discrete",
    most_bodies=_MAX_LINKS,
    reserved="world|__.*__",
)
def _sdf(model: Model) -> Sequence[Iterable[str]]:
    step, gravity = f"{model.timestep!r} s", model.gravity
    notes = (
        f"step: {step}, for Gazebo here and for a discrete plant of Drake, which takes it from you;",
        "Drake takes springs explicitly and dampers implicitly; DART, Gazebo's usual engine, takes both",
        "implicitly: stable at any step, it adds a damping ratio of half the step times angular frequency",
        f"gravity is {'on' if any(gravity) else 'off'} in the world here, which Drake ignores; with it the",
        "beam sags and rings at other frequencies than without load",
        *_carriers(model.tree),
    )
    _check_bodies(model)
    inner, thickness = [], drawn_thickness(model.tree)
    for link, place, frame in placed(links(model.tree)):
        inner += [*_sdf_link(link.body, place, frame, thickness)]
        if link.joint is None or link.joint.kind != "free":
            inner += [*_sdf_joint(link.parent, link.body, link.joint)]
    inner = [f'<model name="{model.name}">', *(f" {line}" for line in inner), "</model>"]
    if not model.fragment:
        inner = [
            f'<world name="{model.name}_world">',
            ' <physics name="fixed_step" default="true" type="ode">',
            f"  <max_step_size>{model.timestep!r}</max_step_size>",
            "  <real_time_factor>1</real_time_factor>",
            f"  <gravity>{_n(*gravity)}</gravity>",
            " </physics>",
            *(f" {line}" for line in inner),
            "</world>",
        ]
    head = [XML_HEAD, *_comment(model, *notes), SDF_HEAD]
    return (["\n".join([*head, *(f" {line}" for line in inner), "</sdf>", ""])],)


def _sdf_link(body: Body, place: Floats, frame: Floats, thickness: float) -> Iterator[str]:
    yield f'<link name="{body.name}">'
    yield f" <pose>{_n(*place, *_rpy(frame))}</pose>"
    yield " <inertial>"
    yield f"  <pose>{_n(*body.centre)} 0 0 0</pose>"
    yield f"  <mass>{_n(body.mass)}</mass>"
    yield f"  <inertia>{''.join(f'<{key}>{_n(value)}</{key}>' for key, value in _moments(body))}</inertia>"
    yield " </inertial>"
    if body.length > thickness / 10:
        yield f' <visual name="{body.name}_visual">'
        middle, turned = _along(body.tip)
        yield f"  <pose>{_n(*middle, *turned)}</pose>"
        yield f"  <geometry><box><size>{_n(body.length, thickness, thickness)}</size></box></geometry>"
        yield " </visual>"
    yield "</link>"


def _sdf_joint(parent: str, body: Body, joint: Joint | None) -> Iterator[str]:
    name, kind = _joint_of(body, joint)
    yield f'<joint name="{name}" type="{kind}">'
    yield f" <parent>{parent}</parent>"
    yield f" <child>{body.name}</child>"
    if joint is not None:
        yield " <axis>"
        yield f"  <xyz>{' '.join(map(str, joint.axis))}</xyz>"
        # SDFormat takes 1e16 for no limit.
        yield "  <limit><lower>-1e16</lower><upper>1e16</upper></limit>"
        yield "  <dynamics>"
        yield f"   <damping>{_n(joint.damping)}</damping>"
        yield "   <spring_reference>0</spring_reference>"
        yield f"   <spring_stiffness>{_n(joint.stiffness)}</spring_stiffness>"
        yield "  </dynamics>"
        yield " </axis>"
    yield "</joint>"


#: URDF wants limits of every joint; these are not to be met.
_URDF_LIMITS = {
    "hinge": 'lower="-3" upper="3" effort="1e9" velocity="1e9"',
    "slide": 'lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"',
}


@_format(
    "urdf",
    ".urdf",
    ("second", "damping"),
    said=("PyBullet", "Drake discrete", "Newton MuJoCo", "Newton Featherstone", "PhysX torques"),
    beside=".springs.yaml",
    most_bodies=_MAX_LINKS,
)
def _urdf(model: Model) -> Sequence[Iterable[str]]:
    notes = (
        f"URDF knows no springs: without those in {one_line(model.paths[1].name)} this is a loose chain",
        "gravity is not part of a URDF file: with it the beam sags and rings at other frequencies",
        'for PyBullet, the format "pybullet" writes a script beside it that sets them',
    )
    return [_urdf_text(model, *notes)], ["\n".join([*_springs_yaml(model), ""])]


def _urdf_text(model: Model, *notes: str) -> str:
    carriers = _carriers(model.tree)
    lines = [XML_HEAD, *_comment(model, *notes, *carriers), f'<robot name="{model.name}">']
    if not any(joint.kind == "free" for body in model.tree.bodies for joint in body.joints):
        lines.append(' <link name="world"/>')
    thickness = drawn_thickness(model.tree)
    for link in links(model.tree):
        lines += _urdf_link(link.body, thickness)
        if link.joint is not None and link.joint.kind == "free":
            continue
        name, kind = _joint_of(link.body, link.joint)
        lines += [
            f' <joint name="{name}" type="{kind}">',
            f'  <parent link="{link.parent}"/>',
            f'  <child link="{link.body.name}"/>',
            f'  <origin xyz="{_n(*link.position)}" rpy="{_n(*_rpy(np.array(link.rotation)))}"/>',
        ]
        if link.joint is not None:
            lines += [
                f'  <axis xyz="{" ".join(map(str, link.joint.axis))}"/>',
                f'  <dynamics damping="{_n(link.joint.damping)}" friction="0"/>',
                f"  <limit {_URDF_LIMITS[link.joint.kind]}/>",
            ]
        lines.append(" </joint>")
    return "\n".join([*lines, "</robot>", ""])


def _urdf_link(body: Body, thickness: float) -> Iterator[str]:
    inertia = " ".join(f'{key}="{_n(value)}"' for key, value in _moments(body))
    yield f' <link name="{body.name}">'
    yield "  <inertial>"
    yield f'   <origin xyz="{_n(*body.centre)}" rpy="0 0 0"/>'
    yield f'   <mass value="{_n(body.mass)}"/>'
    yield f"   <inertia {inertia}/>"
    yield "  </inertial>"
    if body.length > thickness / 10:
        yield "  <visual>"
        middle, turned = _along(body.tip)
        yield f'   <origin xyz="{_n(*middle)}" rpy="{_n(*turned)}"/>'
        yield f'   <geometry><box size="{_n(body.length, thickness, thickness)}"/></geometry>'
        yield "  </visual>"
    yield " </link>"


def _springs_yaml(model: Model) -> Iterator[str]:
    about = "hinges in N m/rad, slides in N/m; the force is -stiffness * (position - rest)"
    yield from (f"# {line}" for line in (f"springs of {model.name}: {about}", *model.facts))
    # Without quotes "no" and "null" are no text.
    yield f'model: "{model.name}"'
    joints = [joint for body in model.tree.bodies for joint in body.joints if joint.stiffness]
    yield "springs:" if joints else "springs: []"
    for joint in joints:
        stiffness = yaml_number(joint.stiffness)
        yield f"  - {{joint: {joint.name}, type: {joint.kind}, stiffness: {stiffness}, rest: 0.0}}"


def yaml_number(value: float) -> str:
    """Return a number as YAML 1.1 reads it, which takes 1e-05 for a word: with a point.

    Examples
    --------
    >>> yaml_number(1e-5), yaml_number(2)
    ('1.0e-05', '2.0')
    """
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


@_format(
    "pybullet",
    ".py",
    ("second", "damping", "timestep", "load"),
    engine="PyBullet",
    beside=".urdf",
    most_bodies=_MAX_LINKS,
)
def _pybullet(model: Model) -> Sequence[Iterable[str]]:
    script, urdf = (path.name for path in model.paths)
    notes = f"for {one_line(script)}, which sets its springs: URDF knows none", *_weight(model)
    facts = *model.facts, *_weight(model)
    text = pybullet_script(model.name, facts, model.tree, model.timestep, model.gravity, urdf)
    return [text], [_urdf_text(model, *notes)]


@_format(
    "exudyn",
    ".py",
    ("second", "damping", "timestep", "load"),
    engine="Exudyn RK44",
    most_bodies=_MAX_LINKS,
)
def _exudyn(model: Model) -> Sequence[Iterable[str]]:
    facts = *model.facts, *_weight(model), *_carriers(model.tree)
    return ([exudyn_script(model.name, facts, model.tree, model.timestep, model.gravity)],)


def _weight(model: Model) -> Iterator[str]:
    """Yield what the head says on gravity."""
    on = any(model.gravity)
    yield f"gravity is {'on: the' if on else 'off: with it the'} beam sags and rings at other frequencies"


@_format(
    "usd",
    ".usda",
    ("second", "damping", "load"),
    said=("Newton MuJoCo", "Newton Featherstone"),
    most_bodies=_MAX_LINKS,
)
def _usd(model: Model) -> Sequence[Iterable[str]]:
    notes = (
        "springs and dampers are drives to zero, of hinges per degree: the schema's unit",
        f"gravity is {'on' if any(model.gravity) else 'off'} in the scene, which a reference to the file",
        "leaves out; with it the beam sags and rings at other frequencies than without load",
        *_carriers(model.tree),
    )
    _check_bodies(model)
    lines = usd_lines(model.tree, model.name, _head(model, *notes), model.gravity, model.units)
    return (["\n".join([*lines, ""])],)


@_format("csv", ".csv")
def _csv(model: Model) -> Sequence[Iterable[str]]:
    assert isinstance(model.chain, Chain)
    return (csv_lines(model.chain, model.facts),)
