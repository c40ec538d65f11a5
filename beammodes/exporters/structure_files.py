"""A chain of a structure as text for MuJoCo (MJCF), Gazebo and Drake (SDFormat), or URDF tools.

MJCF holds any. SDFormat closes loops by joints, so points are held along x and y or not at all. URDF holds
trees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

from beammodes.accuracy.structure_errors import errors_of_structure
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import percent
from beammodes.exporters.export_facts import one_line
from beammodes.exporters.formats import MAX_NESTED, XML_HEAD, mjcf_firm, mjcf_ties, yaml_number
from beammodes.exporters.structure_tree import HINGE, Closure, StructureTree, TreeBody, structure_tree
from beammodes.vibration.stability import stable_time_step
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["STRUCTURE_FORMATS", "structure_texts"]

_REPORTED = 3


def structure_texts(chain: StructureChain, format: str, name: str) -> list[str]:
    """Return the text of each file of a format: one, or for URDF also that of the springs.

    Examples
    --------
    >>> import beammodes as bm
    >>> arm = bm.StructureChain(bm.Structure.of_beam(bm.Beam.unit(), "clamped-free"), 3)
    >>> structure_texts(arm, "mjcf", "arm")[0].splitlines()[-1]
    '</mujoco>'
    """
    tree, modes = structure_tree(chain, name), structure_chain_modes(chain)
    if not modes.elastic_modes:
        raise ValueError("chain must have an elastic mode for files, got one whose supports hold all of it")
    frequencies = ", ".join(f"{f:.6g}" for f in modes.frequency[:_REPORTED].tolist())
    judged = errors_of_structure(chain, min(_REPORTED, modes.elastic_modes))
    errors = ", ".join(percent(error) for error in judged.tolist())
    facts = (
        f"{name}: flexible members {', '.join(member.name for member in chain.structure.members)}",
        f"rule: {chain.rule.name}, {', '.join(map(str, chain.segments))} segments",
        f"first frequencies without gravity: {frequencies} Hz; against the exact structure: {errors}",
        "x and y of the structure are x and z here; twist, stretch and shear are not modelled",
    )
    # Names are the user's: they shall not end a comment.
    said = tuple(map(one_line, facts))
    # Half of the largest stable one, as of other files.
    step = 0.5 * stable_time_step(chain, "rk4" if format == "mjcf" else "Drake discrete")
    return [f"{text}\n" for text in STRUCTURE_FORMATS[format](name, tree, said, step)]


Writer = Callable[[str, StructureTree, tuple[str, ...], float], list[str]]


def _n(*values: float) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)


def _comment(*facts: str) -> list[str]:
    return ["<!--", *(f"  {fact}" for fact in facts), "-->"]


def _mjcf(name: str, tree: StructureTree, facts: tuple[str, ...], step: float) -> list[str]:
    bodies, children = tree.bodies, dict[str, list[TreeBody]]()
    for body in bodies:
        children.setdefault(body.parent, []).append(body)
    size = math.fsum(math.dist(*rod) for body in bodies for rod in body.rods) / 200

    def lines(body: TreeBody, depth: int) -> Iterator[str]:
        if depth > MAX_NESTED:
            raise ValueError(f"chain must be at most {MAX_NESTED} bodies long for mjcf files, got more")
        pad = " " * depth
        x, z = body.place
        yield f'{pad}<body name="{body.name}" pos="{_n(x, 0, z)}">'
        inertia = _n(*[body.inertia] * 3)
        centre = _n(body.centre[0], 0, body.centre[1])
        yield f'{pad} <inertial pos="{centre}" mass="{_n(body.mass)}" diaginertia="{inertia}"/>'
        for joint in body.joints:
            spring = f' stiffness="{_n(joint.stiffness)}"' if joint.stiffness else ""
            axis = " ".join(map(str, joint.axis))
            yield f'{pad} <joint name="{joint.name}" type="{joint.kind}" axis="{axis}"{spring}/>'
        for (a, b), (c, d) in body.rods:
            ends = f'fromto="{_n(a, 0, b)} {_n(c, 0, d)}" size="{_n(size)}" mass="0"'
            yield f'{pad} <geom type="capsule" {ends} contype="0" conaffinity="0"/>'
        for child in children.get(body.name, []):
            yield from lines(child, depth + 1)
        yield f"{pad}</body>"

    ties = [*tree.springs, *tree.ties]
    # MuJoCo's own 1e-8 leaves vibration of 1e-9 rad and less to itself.
    exact = ' tolerance="1e-14"' if ties or tree.closures else ""
    return [
        "\n".join(
            [
                *_comment(*facts, "gravity is off; timestep: half of what RK4 is stable to", *_closed(tree)),
                f'<mujoco model="{name}">',
                f' <option timestep="{step!r}" integrator="RK4" gravity="0 0 0"{exact}/>',
                " <worldbody>",
                *(line for body in children.get("world", []) for line in lines(body, 2)),
                " </worldbody>",
                *mjcf_ties(ties, step),
                *_mjcf_closures(tree.closures, step),
                "</mujoco>",
            ]
        )
    ]


def _closed(tree: StructureTree) -> Iterator[str]:
    """Yield what the head says of constraints."""
    if tree.closures:
        yield f"{len(tree.closures)} of its points are closed by connect constraints, also in large motion"
    if tree.springs or tree.ties:
        yield "tendons are springs and supports that no joint has, linear in the joints, for small motions"
    if tree.closures or any(tie.stiffness == math.inf for tie in tree.ties):
        yield "constraints are soft in MuJoCo: a solref of two timesteps keeps frequencies to 0.01 %"


def _mjcf_closures(closures: list[Closure], step: float) -> Iterator[str]:
    if not closures:
        return
    yield " <equality>"
    for closure in closures:
        one, other = closure.bodies
        second = f' body2="{other}"' if other != "world" else ""
        anchor = _n(closure.at[0], 0, closure.at[1])
        yield f'  <connect name="{closure.name}" body1="{one}"{second} anchor="{anchor}" {mjcf_firm(step)}/>'
    yield " </equality>"


def _checked(tree: StructureTree, format: str, *, closures: bool) -> list[TreeBody]:
    """Return the bodies of a tree, or raise ValueError if files of a format cannot hold what closes it."""
    if any(len(body.joints) != 1 or body.joints[0].kind != "hinge" for body in tree.bodies):
        raise ValueError(f"chain must be clamped or pinned at its root for {format} files; mjcf can slide")
    if tree.ties:
        names = ", ".join(tie.name for tie in tree.ties[:_REPORTED])
        raise ValueError(
            f"chain must have joints that are held along x and y or not at all, and no three hinges about a "
            f"joint without rotary_inertia, in {format} files, got {names}: take half_stub_corrected, whose "
            "hinges are off the joints, or mjcf, whose tendons hold any"
        )
    if tree.closures and not closures:
        names = ", ".join("-".join(closure.bodies) for closure in tree.closures[:_REPORTED])
        raise ValueError(
            f"chain must be a tree, supported at one joint, for {format} files, got one closed at {names}: "
            "mjcf and sdf files can close it"
        )
    return tree.bodies


def _moments(inertia: float) -> list[tuple[str, float]]:
    values = (inertia, inertia, inertia, 0.0, 0.0, 0.0)
    return list(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), values, strict=True))


def _sdf(name: str, tree: StructureTree, facts: tuple[str, ...], step: float) -> list[str]:
    bodies, notes = _checked(tree, "sdf", closures=True), list[str]()
    if tree.closures:
        notes.append(
            f"{len(tree.closures)} joints close loops: for physics engines that take these (ODE, Bullet)"
        )
    lines = [
        XML_HEAD,
        *_comment(*facts, "gravity is off; step: half of what Drake's discrete plants are stable to", *notes),
        '<sdf version="1.7">',
        f' <world name="{name}_world">',
        "  <gravity>0 0 0</gravity>",
        f'  <physics name="fixed_step" default="true" type="ode"><max_step_size>{step!r}</max_step_size>'
        "<real_time_factor>1</real_time_factor></physics>",
        f'  <model name="{name}">',
    ]
    for body in bodies:
        moments = "".join(f"<{key}>{_n(value)}</{key}>" for key, value in _moments(body.inertia))
        x, z = body.origin
        (joint,) = body.joints
        lines += [
            f'   <link name="{body.name}">',
            f"    <pose>{_n(x, 0, z, 0, 0, 0)}</pose>",
            f"    <inertial><pose>{_n(body.centre[0], 0, body.centre[1], 0, 0, 0)}</pose>",
            f"     <mass>{_n(body.mass)}</mass><inertia>{moments}</inertia></inertial>",
            "   </link>",
            *_sdf_joint(joint.name, body.parent, body.name, joint.stiffness),
        ]
    for closure in tree.closures:
        one, other = closure.bodies
        at = (closure.at[0], 0, closure.at[1], 0, 0, 0)
        lines += _sdf_joint(closure.name, other, one, closure.stiffness, f"    <pose>{_n(*at)}</pose>")
    return ["\n".join([*lines, "  </model>", " </world>", "</sdf>"])]


def _sdf_joint(name: str, parent: str, child: str, stiffness: float, *pose: str) -> list[str]:
    return [
        f'   <joint name="{name}" type="revolute">',
        *pose,
        f"    <parent>{parent}</parent><child>{child}</child>",
        f"    <axis><xyz>{' '.join(map(str, HINGE))}</xyz>",
        "     <limit><lower>-1e16</lower><upper>1e16</upper></limit>",
        "     <dynamics><damping>0.0</damping><spring_reference>0</spring_reference>"
        f"<spring_stiffness>{_n(stiffness)}</spring_stiffness></dynamics></axis>",
        "   </joint>",
    ]


def _urdf(name: str, tree: StructureTree, facts: tuple[str, ...], step: float) -> list[str]:
    del step  # A URDF file has none.
    bodies = _checked(tree, "urdf", closures=False)
    notes = (*facts, "URDF knows no springs: they are in the file beside this one")
    lines = [XML_HEAD, *_comment(*notes), f'<robot name="{name}">', ' <link name="world"/>']
    springs = [f"# {fact}" for fact in facts]
    springs += [
        "# hinges in N m/rad; the moment is -stiffness * (position - rest)",
        f"model: {name}",
        "springs:",
    ]
    for body in bodies:
        inertia = " ".join(f'{key}="{_n(value)}"' for key, value in _moments(body.inertia))
        (joint,) = body.joints
        lines += [
            f' <link name="{body.name}"><inertial>',
            f'  <origin xyz="{_n(body.centre[0], 0, body.centre[1])}" rpy="0 0 0"/>',
            f'  <mass value="{_n(body.mass)}"/><inertia {inertia}/>',
            " </inertial></link>",
            f' <joint name="{joint.name}" type="revolute">',
            f'  <parent link="{body.parent}"/><child link="{body.name}"/>',
            f'  <origin xyz="{_n(body.place[0], 0, body.place[1])}" rpy="0 0 0"/>',
            f'  <axis xyz="{" ".join(map(str, joint.axis))}"/>',
            '  <limit lower="-3" upper="3" effort="1e9" velocity="1e9"/>',
            " </joint>",
        ]
        stiffness = yaml_number(joint.stiffness)
        springs.append(f"  - {{joint: {joint.name}, type: hinge, stiffness: {stiffness}, rest: 0.0}}")
    return ["\n".join([*lines, "</robot>"]), "\n".join(springs)]


#: What writes each format.
STRUCTURE_FORMATS: Mapping[str, Writer] = MappingProxyType({"mjcf": _mjcf, "sdf": _sdf, "urdf": _urdf})
