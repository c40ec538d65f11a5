"""Bodies and joints as text of OpenUSD (.usda) in the UsdPhysics schema, which Isaac Lab and Newton read.

::

      /chain          the default prim, an articulation: what a reference to the file brings along
          base        a body that is fixed to the world; none where the first piece is fixed itself, or free
          pieces, and links between two joints of a node
          joints
      /chain_scene    gravity, for a stage that is opened by itself

Springs and dampers are drives to zero. Those of hinges are per degree in this schema, not per radian.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from types import MappingProxyType

import numpy as np

from beammodes.exporters.model_tree import (
    IDENTITY,
    Body,
    Link,
    Tree,
    Vector,
    drawn_thickness,
    links,
    placed,
    principal_moments,
)
from beammodes.exporters.unit_systems import UnitSystem
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import quaternion

__all__ = ["usd_lines"]

#: For each kind of joint: its prim's type, its drive's name, and how many of the schema's units are one here.
_KINDS = MappingProxyType(
    {
        "hinge": ("PhysicsRevoluteJoint", "angular", math.degrees(1.0)),
        "slide": ("PhysicsPrismaticJoint", "linear", 1.0),
    }
)
#: For each axis a half turn about another, as the schema has none that point backwards.
_ABOUT = MappingProxyType({"X": np.diag([-1, -1, 1]), "Y": np.diag([1, -1, -1]), "Z": np.diag([1, -1, -1])})
#: Physical quantities are of single precision.
_LEAST, _MOST = float(np.finfo(np.float32).tiny), float(np.finfo(np.float32).max)


def usd_lines(
    tree: Tree, name: str, notes: Sequence[str], gravity: Vector, units: UnitSystem
) -> Iterator[str]:
    """Yield the lines of a file of a row of bodies without ties and ball joints.

    Parameters
    ----------
    tree : Tree
    name : str
        Of the default prim.
    notes : sequence of str
        Lines for the head.
    gravity : triple [m/s²]
    units : UnitSystem

    Raises
    ------
    ValueError
        If a number does not fit into single precision.
    """
    size = math.hypot(*gravity)
    down = [value / size for value in gravity] if size else [0.0, 0.0, -1.0]
    yield "#usda 1.0"
    yield from (f"# {line}" for line in notes)
    yield "("
    yield f'    defaultPrim = "{name}"'
    yield f"    kilogramsPerUnit = {units.kilograms!r}"
    yield f"    metersPerUnit = {units.metres!r}"
    yield '    upAxis = "Z"'
    yield ")"
    yield from _prim("Xform", name, _articulation(tree, name), "PhysicsArticulationRootAPI")
    fields = [
        f"vector3f physics:gravityDirection = {_n(*down)}",
        f"float physics:gravityMagnitude = {size!r}",
    ]
    yield from _prim("PhysicsScene", f"{name}_scene", fields)


def _prim(kind: str, name: str, inner: Sequence[str] | Iterator[str], *schemas: str) -> Iterator[str]:
    applied = ", ".join(f'"{schema}"' for schema in schemas)
    yield f'def {kind} "{name}"' + (f" (prepend apiSchemas = [{applied}])" if schemas else "")
    yield "{"
    yield from (f"    {line}" for line in inner)
    yield "}"


def _articulation(tree: Tree, name: str) -> Iterator[str]:
    row = [*links(tree)]
    first = row[0]
    if first.joint is not None and first.joint.kind != "free":
        # Engines want an articulation's root free, or fixed to the world. What is fixed may have any mass.
        still, (xx, yy, zz) = (0.0, 0.0, 0.0), principal_moments(tree.bodies[0])[0]
        inertia = ((xx, 0.0, 0.0), (0.0, yy, 0.0), (0.0, 0.0, zz))
        base = Body(f"{name}_base", still, IDENTITY, still, tree.bodies[0].mass, still, inertia, ())
        first = Link(base.name, first.position, first.rotation, first.body, first.joint)
        row = [Link("world", still, IDENTITY, base, None), first, *row[1:]]
    thickness = drawn_thickness(tree)
    for link, place, frame in placed(row):
        fields = _body(link.body, place, frame, thickness)
        yield from _prim("Xform", link.body.name, fields, "PhysicsRigidBodyAPI", "PhysicsMassAPI")
    for link in row:
        if link.joint is None or link.joint.kind != "free":
            yield from _joint(name, link)


def _body(body: Body, place: Floats, frame: Floats, thickness: float) -> Iterator[str]:
    moments, axes = principal_moments(body)
    for what, value in (("mass", body.mass), *(("moment of inertia", value) for value in moments)):
        _check(f"{what} of {body.name}", value)
    yield f"float physics:mass = {body.mass!r}"
    yield f"point3f physics:centerOfMass = {_n(*body.centre)}"
    yield f"float3 physics:diagonalInertia = {_n(*moments)}"
    yield f"quatf physics:principalAxes = {_quat(np.array(axes))}"
    yield from _placed(place, frame)
    if body.length > thickness / 10:
        # From x to the tip by half of the angle twice.
        x, y, z = (value / body.length for value in body.tip)
        half = math.sqrt((1 + x) / 2)
        turned = _n(half, 0.0, -z / (2 * half) + 0.0, y / (2 * half) + 0.0)
        fields = [
            'uniform token axis = "X"',
            f"double height = {body.length!r}",
            f"double radius = {thickness / 2!r}",
            f"double3 xformOp:translate = {_n(*(value / 2 for value in body.tip))}",
            f"quatd xformOp:orient = {turned}",
            _ORDER,
        ]
        yield from _prim("Capsule", "visual", fields)


_ORDER = 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]'


def _placed(place: Floats, frame: Floats) -> Iterator[str]:
    yield f"double3 xformOp:translate = {_n(*place)}"
    yield f"quatd xformOp:orient = {_quat(frame)}"
    yield _ORDER


def _joint(name: str, link: Link) -> Iterator[str]:
    joint, schemas, drive = link.joint, list[str](), list[str]()
    about, fields = np.eye(3), list[str]()
    if joint is None:
        kind, called = "PhysicsFixedJoint", f"{link.body.name}_weld"
    else:
        kind, motion, units = _KINDS[joint.kind]
        called, letter = joint.name, "XYZ"[[*map(abs, joint.axis)].index(1)]
        about = _ABOUT[letter] if sum(joint.axis) < 0 else about
        fields.append(f'uniform token physics:axis = "{letter}"')
        if joint.stiffness or joint.damping:
            schemas = [f"PhysicsDriveAPI:{motion}"]
            at = f"drive:{motion}:physics"
            drive = [f'uniform token {at}:type = "force"', f"float {at}:targetPosition = 0"]
            for what, value in (("stiffness", joint.stiffness), ("damping", joint.damping)):
                if value:
                    _check(f"{what} of {joint.name}", value / units)
                    drive.append(f"float {at}:{what} = {value / units!r}")
    if link.parent != "world":
        fields.append(f"rel physics:body0 = </{name}/{link.parent}>")
    fields += [
        f"rel physics:body1 = </{name}/{link.body.name}>",
        f"point3f physics:localPos0 = {_n(*link.position)}",
        f"quatf physics:localRot0 = {_quat(np.array(link.rotation) @ about)}",
        "point3f physics:localPos1 = (0, 0, 0)",
        f"quatf physics:localRot1 = {_quat(about)}",
    ]
    yield from _prim(kind, called, [*fields, *drive], *schemas)


def _n(*values: float) -> str:
    return f"({', '.join(repr(float(value)) for value in values)})"


def _quat(rotation: Floats) -> str:
    return _n(*(quaternion(rotation) + 0.0))


def _check(what: str, value: float) -> None:
    if not _LEAST <= value <= _MOST:
        raise ValueError(
            "chain must be in units in which masses, inertias, springs and dampers fit into the single "
            f"precision of usd files, {_LEAST:.3g} to {_MOST:.3g}, got {value:.4g} for the {what}"
        )
