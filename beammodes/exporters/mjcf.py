"""A chain as an MJCF file for MuJoCo 3 and 4: a whole model, or a part for others to include."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from beammodes.exporters.export_facts import digits as _n
from beammodes.exporters.planar_tree import Body, Joint, Tie, Tree, Vector, bending_planes

__all__ = ["MAX_BODIES", "mjcf_text"]

#: MuJoCo's XML reader gives up at elements nested 500 deep, and bodies are nested.
MAX_BODIES = 490
#: MuJoCo refuses moving bodies with less mass or inertia.
_LEAST = 1e-15


def mjcf_text(
    tree: Tree,
    lines: Sequence[str],
    name: str,
    *,
    timestep: float,
    integrator: str,
    fragment: bool,
    gravity: Vector = (0.0, 0.0, 0.0),
) -> str:
    """Return the file's text.

    Parameters
    ----------
    tree : Tree
    lines : sequence of str
        For the comment at its head.
    name : str
        Of the model.
    timestep : float [s]
    integrator : str
        As MuJoCo calls it.
    gravity : triple [m/s²]
    fragment : bool
        Bodies only, for a model's `<worldbody>` or one of its bodies; where the far end is supported,
        whole sections, to include at the top of the model.

    Raises
    ------
    ValueError
        If masses or inertias are too small for MuJoCo.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> tree = planar_tree(Chain(Beam.unit(), "clamped-free", 1), "rod")
    >>> text = mjcf_text(tree, [], "rod", timestep=0.01, integrator="RK4", fragment=False)
    >>> [line for line in text.splitlines() if "option" in line or "joint" in line]
    [' <option timestep="0.01" integrator="RK4" gravity="0 0 0"/>',
     '   <joint name="rod_hinge_1" type="hinge" axis="0 -1 0" stiffness="3"/>']
    """
    _check_heavy_enough(tree)
    whole = not fragment or bool(tree.ties)
    bodies = list(_nested(tree.bodies, _thickness(tree), 2 if whole else 1))
    notes = _notes(tree, timestep, integrator, fragment, any(gravity))
    head = ["<!--", *(f"  {line}" for line in (f"{name}: a flexible beam", *lines, *notes)), "-->"]
    if not fragment:
        # MuJoCo's own 1e-8 leaves vibration of 1e-9 rad and less to itself.
        exact = ' tolerance="1e-14"' if tree.ties else ""
        pull = " ".join(map(_n, gravity))
        option = f'timestep="{timestep!r}" integrator="{integrator}" gravity="{pull}"{exact}'
        head += [f'<mujoco model="{name}">', f" <option {option}/>"]
    else:
        head.append("<mujocoinclude>")
    middle = [" <worldbody>", *bodies, " </worldbody>", *_ties(tree.ties, timestep)] if whole else bodies
    return "\n".join([*head, *middle, "</mujocoinclude>" if fragment else "</mujoco>", ""])


def _notes(tree: Tree, timestep: float, integrator: str, fragment: bool, heavy: bool) -> Iterator[str]:
    yield f"x runs along the beam; it bends in {bending_planes(tree)}"
    yield "twist, stretch and shear are not modelled; the small inertia about x stands for nothing"
    if fragment:
        where = "at the top of a model" if tree.ties else "in <worldbody> or a body"
        yield f"include {where}; it needs timestep {timestep!r} or less with integrator {integrator}"
        yield "gravity is the including model's; with it the beam sags and rings at other frequencies"
    elif heavy:
        yield "gravity is on: the beam sags and rings at other frequencies than without load"
    else:
        yield "gravity is off: with it the beam sags and rings at other frequencies"
    if tree.ties:
        yield "tendons support the far end, linear in the joints, for small deflections; it slides along x"
    if any(tie.stiffness == math.inf for tie in tree.ties):
        yield "its deflection is held by a constraint, which is soft in MuJoCo: frequencies are within 0.02 %"
        yield "for that, solref is twice the timestep and solimp 0.9999; give the solver tolerance 1e-14"


def _check_heavy_enough(tree: Tree) -> None:
    least = min((value for body in tree.bodies for value in (body.mass, *body.inertia)), default=1.0)
    if least <= _LEAST:
        raise ValueError(
            f"chain must be in units in which masses and inertias are above 1e-15, the least that MuJoCo "
            f"takes (such as mm and g), got {least:.3g}"
        )


def _nested(bodies: Sequence[Body], thickness: float, depth: int) -> Iterator[str]:
    for i, body in enumerate(bodies):
        pad = " " * (depth + i)
        yield f'{pad}<body name="{body.name}" pos="{_n(body.position)} 0 0">'
        inertia = " ".join(map(_n, body.inertia))
        mass = f'pos="{_n(body.centre)} 0 0" mass="{_n(body.mass)}" diaginertia="{inertia}"'
        yield f"{pad} <inertial {mass}/>"
        for joint in body.joints:
            yield f"{pad} {_joint(joint)}"
        if body.length > thickness / 10:
            size = f'fromto="0 0 0 {_n(body.length)} 0 0" size="{_n(thickness)}" mass="0"'
            yield f'{pad} <geom type="capsule" {size} contype="0" conaffinity="0"/>'
    for i in reversed(range(len(bodies))):
        yield f"{' ' * (depth + i)}</body>"


def _joint(joint: Joint) -> str:
    axis = " ".join(map(str, joint.axis))
    springs = "".join(
        f' {what}="{_n(value)}"'
        for what, value in (("stiffness", joint.stiffness), ("damping", joint.damping))
        if value
    )
    return f'<joint name="{joint.name}" type="{joint.kind}" axis="{axis}"{springs}/>'


def _ties(ties: Sequence[Tie], timestep: float) -> Iterator[str]:
    if not ties:
        return
    yield " <tendon>"
    for tie in ties:
        held = tie.stiffness == math.inf
        spring = "" if held else f' stiffness="{_n(tie.stiffness)}" springlength="0"'
        damping = f' damping="{_n(tie.damping)}"' if tie.damping else ""
        yield f'  <fixed name="{tie.name}"{spring}{damping}>'
        yield from (f'   <joint joint="{joint}" coef="{_n(arm)}"/>' for joint, arm in tie.terms)
        yield "  </fixed>"
    yield " </tendon>"
    if held_ties := [tie for tie in ties if tie.stiffness == math.inf]:
        soft = f'solref="{2 * timestep!r} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
        yield " <equality>"
        yield from (f'  <tendon name="{tie.name}_held" tendon1="{tie.name}" {soft}/>' for tie in held_ties)
        yield " </equality>"


def _thickness(tree: Tree) -> float:
    return math.fsum(body.length for body in tree.bodies) / 200
