"""A chain as a URDF file, and its springs, for which URDF has no place, as a YAML file beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from beammodes.exporters.export_facts import digits as _n
from beammodes.exporters.planar_tree import Body, Joint, Link, Tree, bending_planes, links

__all__ = ["springs_text", "urdf_text"]

#: URDF wants limits of every joint; these are not to be met.
_LIMITS = {
    "hinge": 'lower="-3" upper="3" effort="1e9" velocity="1e9"',
    "slide": 'lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"',
}
_KINDS = {"hinge": "revolute", "slide": "prismatic"}


def urdf_text(tree: Tree, lines: Sequence[str], name: str, *, springs: str) -> str:
    """Return the URDF file's text; `springs` is the name of the file that holds the springs.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> tree = planar_tree(Chain(Beam.unit(), "clamped-free", 1))
    >>> text = urdf_text(tree, [], "rod", springs="rod.springs.yaml")
    >>> [line.strip() for line in text.splitlines() if "axis" in line]
    ['<axis xyz="0 -1 0"/>']
    """
    thickness = sum(body.length for body in tree.bodies) / 100
    head = ['<?xml version="1.0" encoding="utf-8"?>', "<!--", f"  {name}: a flexible beam"]
    notes = [
        f"URDF knows no springs: without those in {springs} this is a loose chain",
        f"x runs along the beam; it bends in {bending_planes(tree)}",
        "twist, stretch and shear are not modelled",
        "gravity is not part of a URDF file: with it the beam sags and rings at other frequencies",
    ]
    head += [*(f"  {line}" for line in (*notes, *lines)), "-->", f'<robot name="{name}">']
    body = [' <link name="world"/>']
    for link in links(tree):
        body += [*_link(link.body, thickness), *_joint(link)]
    return "\n".join([*head, *body, "</robot>", ""])


def springs_text(tree: Tree, lines: Sequence[str], name: str) -> str:
    """Return the YAML file's text: for every joint with a spring its stiffness and the position at rest.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> print(springs_text(planar_tree(Chain(Beam.unit(), "clamped-free", 1)), [], "rod"))
    # springs of rod: hinges in N m/rad, slides in N/m; the force is -stiffness * (position - rest)
    model: rod
    springs:
      - {joint: chain_hinge_1, type: hinge, stiffness: 3.0, rest: 0.0}
    <BLANKLINE>
    """
    about = "hinges in N m/rad, slides in N/m; the force is -stiffness * (position - rest)"
    joints = [joint for body in tree.bodies for joint in body.joints if joint.stiffness]
    rows = [
        f"  - {{joint: {joint.name}, type: {joint.kind}, stiffness: {_yaml(joint.stiffness)}, rest: 0.0}}"
        for joint in joints
    ]
    head = [f"# springs of {name}: {about}", *(f"# {line}" for line in lines), f"model: {name}"]
    return "\n".join([*head, "springs:" if rows else "springs: []", *rows, ""])


def _yaml(value: float) -> str:
    # YAML 1.1 takes 1e-05 for a word: a number has a point.
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


def _link(body: Body, thickness: float) -> Iterator[str]:
    moments = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*body.inertia, 0.0, 0.0, 0.0), strict=True)
    inertia = " ".join(f'{key}="{_n(value)}"' for key, value in moments)
    yield f' <link name="{body.name}">'
    yield "  <inertial>"
    yield f'   <origin xyz="{_n(body.centre)} 0 0" rpy="0 0 0"/>'
    yield f'   <mass value="{_n(body.mass)}"/>'
    yield f"   <inertia {inertia}/>"
    yield "  </inertial>"
    if body.length > thickness / 10:
        size = f"{_n(body.length)} {_n(thickness)} {_n(thickness)}"
        yield "  <visual>"
        yield f'   <origin xyz="{_n(body.length / 2)} 0 0" rpy="0 0 0"/>'
        yield f'   <geometry><box size="{size}"/></geometry>'
        yield "  </visual>"
    yield " </link>"


def _joint(link: Link) -> Iterator[str]:
    joint = link.joint
    name, kind = (f"{link.body.name}_weld", "fixed") if joint is None else (joint.name, _KINDS[joint.kind])
    yield f' <joint name="{name}" type="{kind}">'
    yield f'  <parent link="{link.parent}"/>'
    yield f'  <child link="{link.body.name}"/>'
    yield f'  <origin xyz="{_n(link.position)} 0 0" rpy="0 0 0"/>'
    yield from _motion(joint) if joint else ()
    yield " </joint>"


def _motion(joint: Joint) -> Iterator[str]:
    yield f'  <axis xyz="{" ".join(map(str, joint.axis))}"/>'
    yield f'  <dynamics damping="{_n(joint.damping)}" friction="0"/>'
    yield f"  <limit {_LIMITS[joint.kind]}/>"
