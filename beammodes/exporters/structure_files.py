"""A chain of a structure as text for MuJoCo (MJCF), Gazebo and Drake (SDFormat), or URDF tools.

MJCF holds any. SDFormat closes loops by joints, so points are held along x and y or not at all. URDF holds
trees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from beammodes.accuracy.structure_errors import errors_of_structure
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import percent, shown
from beammodes.exporters.engine_step import chosen_step
from beammodes.exporters.export_facts import one_line
from beammodes.exporters.formats import MAX_NESTED, SDF_HEAD, XML_HEAD, mjcf_firm, mjcf_ties, yaml_number
from beammodes.exporters.structure_tree import HINGE, Closure, StructureTree, TreeBody, structure_tree
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.stability import stable_time_step
from beammodes.vibration.structure_vibration import StructureChainModes, structure_chain_modes

__all__ = ["STRUCTURE_FORMATS", "structure_texts"]

_REPORTED = 3


class Run(NamedTuple):
    """How a file's model is to be run.

    Attributes
    ----------
    step : float [s]
    integrator : str
        Of MuJoCo.
    gravity : (float, float) [m/s²]
        Along x and y of the structure.
    damping : float [s]
        Of each spring, over its stiffness.
    """

    step: float
    integrator: str
    gravity: tuple[float, float]
    damping: float


def structure_texts(
    chain: StructureChain,
    format: str,
    name: str,
    *,
    integrator: str = "RK4",
    timestep: float | None = None,
    load: Load | None = None,
    damping: Damping | None = None,
) -> list[str]:
    """Return the text of each file of a format: one, or for URDF also that of the springs.

    The options are those of `export_chain`.

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
    facts = [
        f"{name}: flexible members {', '.join(member.name for member in chain.structure.members)}",
        f"rule: {chain.rule.name}, {', '.join(map(str, chain.segments))} segments",
        f"first frequencies without gravity: {frequencies} Hz; against the exact structure: {errors}",
        "x and y of the structure are x and z here; twist, stretch and shear are not modelled",
    ]
    gravity, damper = _gravity(load), damping or Damping()
    if damper.mass:
        raise ValueError(f"damping must have mass=0: joints damp relative motion only, got {damper}")
    if damper.stiffness:
        facts.append(f"dampers: {damper.stiffness!r} s times each spring")
    run, lines = Run(0.0, integrator, gravity, damper.stiffness), list[str]()
    if format != "urdf":
        engine = f"MuJoCo {integrator}" if format == "mjcf" else "Drake discrete"
        step, lines = _step(chain, tree, engine, modes, damper, timestep)
        run = run._replace(step=step)
        moving = "sags and rings at other frequencies"
        lines.append(f"gravity is on: the structure {moving}" if any(gravity) else "gravity is off")
    ties = [replace(tie, damping=_damper(tie.stiffness, damper.stiffness)) for tie in tree.ties]
    springs = [replace(tie, damping=_damper(tie.stiffness, damper.stiffness)) for tie in tree.springs]
    tree = tree._replace(ties=ties, springs=springs)
    # Names are the user's: they shall not end a comment.
    said = tuple(map(one_line, (*facts, *lines)))
    return [f"{text}\n" for text in STRUCTURE_FORMATS[format](name, tree, said, run)]


def _gravity(load: Load | None) -> tuple[float, float]:
    if load is None:
        return 0.0, 0.0
    if replace(load, gravity=0.0) != Load():
        raise ValueError(f"load must be gravity only in a file of a structure, got {shown(str(load))}")
    along, up = map(float, load.weight)
    return along, up


def _damper(stiffness: float, seconds: float) -> float:
    return seconds * stiffness if stiffness < math.inf else 0.0


def _step(
    chain: StructureChain,
    tree: StructureTree,
    engine: str,
    modes: StructureChainModes,
    damping: Damping,
    timestep: float | None,
) -> tuple[float, list[str]]:
    """Return the step of a file [s], as those of beams have it, and a line on it."""
    limit = stable_time_step(chain, engine, damping=damping)
    if damping.stiffness and (tree.closures or any(tie.stiffness == math.inf for tie in tree.ties)):
        # What constraints hold makes of implicit dampers is not known.
        limit = min(limit, stable_time_step(chain, "semi_implicit_euler", damping=damping))
    omega = float(modes.angular_frequency[0])
    return chosen_step(engine, {"": limit}, [(omega, 0.5 * damping.stiffness * omega)], timestep)


Writer = Callable[[str, StructureTree, tuple[str, ...], Run], list[str]]


def _n(*values: float) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)


def _comment(*facts: str) -> list[str]:
    return ["<!--", *(f"  {fact}" for fact in facts), "-->"]


def _mjcf(name: str, tree: StructureTree, facts: tuple[str, ...], run: Run) -> list[str]:
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
            damper = joint.stiffness * run.damping
            spring += f' damping="{_n(damper)}"' if damper else ""
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
                *_comment(*facts, *_closed(tree)),
                f'<mujoco model="{name}">',
                f' <option timestep="{run.step!r}" integrator="{run.integrator}" '
                f'gravity="{_n(run.gravity[0], 0, run.gravity[1])}"{exact}/>',
                " <worldbody>",
                *(line for body in children.get("world", []) for line in lines(body, 2)),
                " </worldbody>",
                *mjcf_ties(ties, run.step),
                *_mjcf_closures(tree.closures, run.step),
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
            f"joint without rotary_inertia, in {format} files, got {names}: take mjcf, whose tendons hold "
            "any, or against three hinges half_stub_corrected, whose hinges are off the joints"
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


def _sdf(name: str, tree: StructureTree, facts: tuple[str, ...], run: Run) -> list[str]:
    bodies, notes = _checked(tree, "sdf", closures=True), list[str]()
    if tree.closures:
        notes.append(
            f"{len(tree.closures)} joints close loops: for physics engines that take these (ODE, Bullet)"
        )
    lines = [
        XML_HEAD,
        *_comment(*facts, *notes),
        SDF_HEAD,
        f' <world name="{name}_world">',
        f'  <physics name="fixed_step" default="true" type="ode"><max_step_size>{run.step!r}</max_step_size>'
        "<real_time_factor>1</real_time_factor>"
        f"<gravity>{_n(run.gravity[0], 0, run.gravity[1])}</gravity></physics>",
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
            *_sdf_joint(joint.name, body.parent, body.name, joint.stiffness, run.damping),
        ]
    for closure in tree.closures:
        one, other = closure.bodies
        at = (closure.at[0], 0, closure.at[1], 0, 0, 0)
        lines += _sdf_joint(
            closure.name, other, one, closure.stiffness, run.damping, f"    <pose>{_n(*at)}</pose>"
        )
    return ["\n".join([*lines, "  </model>", " </world>", "</sdf>"])]


def _sdf_joint(name: str, parent: str, child: str, stiffness: float, damping: float, *pose: str) -> list[str]:
    return [
        f'   <joint name="{name}" type="revolute">',
        *pose,
        f"    <parent>{parent}</parent><child>{child}</child>",
        f"    <axis><xyz>{' '.join(map(str, HINGE))}</xyz>",
        "     <limit><lower>-1e16</lower><upper>1e16</upper></limit>",
        f"     <dynamics><damping>{_n(damping * stiffness)}</damping><spring_reference>0</spring_reference>"
        f"<spring_stiffness>{_n(stiffness)}</spring_stiffness></dynamics></axis>",
        "   </joint>",
    ]


def _urdf(name: str, tree: StructureTree, facts: tuple[str, ...], run: Run) -> list[str]:
    bodies = _checked(tree, "urdf", closures=False)
    notes = (*facts, "URDF knows no springs: they are in the file beside this one")
    lines = [XML_HEAD, *_comment(*notes), f'<robot name="{name}">', ' <link name="world"/>']
    springs = [f"# {fact}" for fact in facts]
    springs += [
        "# hinges in N m/rad; the moment is -stiffness * (position - rest)",
        f'model: "{name}"',
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
            *(
                [f'  <dynamics damping="{_n(run.damping * joint.stiffness)}" friction="0"/>']
                * bool(run.damping)
            ),
            " </joint>",
        ]
        stiffness = yaml_number(joint.stiffness)
        springs.append(f"  - {{joint: {joint.name}, type: hinge, stiffness: {stiffness}, rest: 0.0}}")
    return ["\n".join([*lines, "</robot>"]), "\n".join(springs)]


#: What writes each format.
STRUCTURE_FORMATS: Mapping[str, Writer] = MappingProxyType({"mjcf": _mjcf, "sdf": _sdf, "urdf": _urdf})
