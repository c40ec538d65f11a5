"""A chain as an SDFormat file for Gazebo and Drake: a world, or a model for others to include.

Who reads it: Drake takes links, joints, dampers and springs, and its matrices give the chain's frequencies
to 1e-8 (tested with 1.51); it ignores the world's gravity and step. Gazebo's engines take the springs too, by
their sources, `bullet-featherstone` since the end of 2025; the tests do not run Gazebo. Pinocchio's wheel is
built without SDFormat (4.1), so the tests read the file's links and springs into it themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from beammodes.exporters.export_facts import digits as _n
from beammodes.exporters.planar_tree import Body, Joint, Link, Tree, Vector, bending_planes, links

__all__ = ["sdformat_text"]

#: What SDFormat takes for no limit.
_FAR = "1e16"


def sdformat_text(
    tree: Tree,
    lines: Sequence[str],
    name: str,
    *,
    timestep: float,
    fragment: bool,
    gravity: Vector = (0.0, 0.0, 0.0),
) -> str:
    """Return the file's text.

    Parameters
    ----------
    tree : Tree
        Without ties.
    lines : sequence of str
        For the comment at its head.
    name : str
        Of the model.
    timestep : float [s]
    gravity : triple [m/s²]
    fragment : bool
        Only the model, without a world around it.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> text = sdformat_text(
    ...     planar_tree(Chain(Beam.unit(), "clamped-free", 1)), [], "rod", timestep=0.01, fragment=True
    ... )
    >>> [line.strip() for line in text.splitlines() if "<spring_" in line]
    ['<spring_reference>0</spring_reference>', '<spring_stiffness>3</spring_stiffness>']
    """
    thickness = sum(body.length for body in tree.bodies) / 100
    model, depth = [], 1 if fragment else 2
    place = 0.0
    for link in links(tree):
        place += link.position
        model += [*_link(link.body, place, thickness), *_joint(link)]
    inner = [f'<model name="{name}">', *(f" {line}" for line in model), "</model>"]
    notes = [
        f"x runs along the beam; it bends in {bending_planes(tree)}",
        "twist, stretch and shear are not modelled",
        f"step: {timestep!r} s, for Gazebo here and for a discrete plant of Drake, which takes it from you;",
        "Drake takes springs explicitly and dampers implicitly; DART, Gazebo's usual engine, takes both",
        "implicitly: stable at any step, it adds a damping ratio of half the step times angular frequency",
        f"gravity is {'on' if any(gravity) else 'off'} in the world here, which Drake ignores; with it the",
        "beam sags and rings at other frequencies than without load",
    ]
    head = ['<?xml version="1.0" encoding="utf-8"?>', "<!--", f"  {name}: a flexible beam"]
    head += [*(f"  {line}" for line in (*notes, *lines)), "-->", '<sdf version="1.7">']
    around = ([], []) if fragment else (_world(name, timestep, gravity), [" </world>"])
    return "\n".join([*head, *around[0], *(" " * depth + line for line in inner), *around[1], "</sdf>", ""])


def _world(name: str, timestep: float, gravity: Vector) -> list[str]:
    return [
        f' <world name="{name}_world">',
        f"  <gravity>{' '.join(map(_n, gravity))}</gravity>",
        '  <physics name="fixed_step" default="true" type="ode">',
        f"   <max_step_size>{timestep!r}</max_step_size>",
        "   <real_time_factor>1</real_time_factor>",
        "  </physics>",
    ]


def _link(body: Body, place: float, thickness: float) -> Iterator[str]:
    yield f'<link name="{body.name}">'
    yield f" <pose>{_n(place)} 0 0 0 0 0</pose>"
    yield " <inertial>"
    yield f"  <pose>{_n(body.centre)} 0 0 0 0 0</pose>"
    yield f"  <mass>{_n(body.mass)}</mass>"
    moments = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*body.inertia, 0.0, 0.0, 0.0), strict=True)
    yield f"  <inertia>{''.join(f'<{key}>{_n(value)}</{key}>' for key, value in moments)}</inertia>"
    yield " </inertial>"
    if body.length > thickness / 10:
        size = f"{_n(body.length)} {_n(thickness)} {_n(thickness)}"
        yield f' <visual name="{body.name}_visual">'
        yield f"  <pose>{_n(body.length / 2)} 0 0 0 0 0</pose>"
        yield f"  <geometry><box><size>{size}</size></box></geometry>"
        yield " </visual>"
    yield "</link>"


def _joint(link: Link) -> Iterator[str]:
    joint = link.joint
    name, kind = (f"{link.body.name}_weld", "fixed") if joint is None else (joint.name, _KINDS[joint.kind])
    yield f'<joint name="{name}" type="{kind}">'
    yield f" <parent>{link.parent}</parent>"
    yield f" <child>{link.body.name}</child>"
    yield from _axis(joint) if joint else ()
    yield "</joint>"


def _axis(joint: Joint) -> Iterator[str]:
    yield " <axis>"
    yield f"  <xyz>{' '.join(map(str, joint.axis))}</xyz>"
    yield f"  <limit><lower>-{_FAR}</lower><upper>{_FAR}</upper></limit>"
    yield "  <dynamics>"
    yield f"   <damping>{_n(joint.damping)}</damping>"
    yield "   <spring_reference>0</spring_reference>"
    yield f"   <spring_stiffness>{_n(joint.stiffness)}</spring_stiffness>"
    yield "  </dynamics>"
    yield " </axis>"


_KINDS = {"hinge": "revolute", "slide": "prismatic"}
