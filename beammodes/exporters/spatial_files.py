"""A chain in space as text for MuJoCo (MJCF), Gazebo and Drake (SDFormat), or URDF tools.

A node has three hinges. Each body's axes are those of its joint at rest, so that hinges stand on x, y and z
and angles at rest are zero, whatever the curvature. MuJoCo turns a body's joints in the order in which they
are written, and has balls for where they are right. In the other formats a nearly massless link stands
between two hinges of a node.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from beammodes.accuracy.chain_against_rod import rod_errors
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import choice, percent
from beammodes.equations.joint_laws import JointLaw, joint_law
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import rotation_vector
from beammodes.vibration.modes_in_space import spatial_modes

__all__ = ["SPATIAL_FORMATS", "spatial_texts"]

#: Formats that hold a chain in space.
SPATIAL_FORMATS = ("mjcf", "sdf", "urdf")

_REPORTED = 3

#: MuJoCo's reader gives up at elements nested 500 deep.
_MOST_DEEP = 490

#: Of a spring's stiffnesses, that a ball has but one of: as far as they may differ.
_ALIKE = 1e-9

#: Of a piece's inertia, that is added about every axis; and of a piece, what a link between two hinges has.
_TRACE, _CARRIER = 1e-12, 1e-10

_XML = '<?xml version="1.0" encoding="utf-8"?>'


def spatial_texts(chain: SpatialChain, format: str, name: str, joints: str | JointLaw) -> list[str]:
    """Return the text of each file of a format.

    Raises
    ------
    ValueError
        If the ends are not clamped or free at s = 0 and free at s = L, the format is another, or joints are
        balls whose stiffnesses differ.

    Examples
    --------
    >>> import beammodes as bm
    >>> arc = bm.Rod.arc(1.0, length=1.0, bending_stiffness=1.3, torsional_stiffness=1.0, mass_per_length=1.0)
    >>> chain = bm.SpatialChain(arc, "clamped-free", segments=3)
    >>> spatial_texts(chain, "mjcf", "arc", "xyz_alternating")[0].count("<joint ")
    9
    """
    choice("format of a chain in space", format, SPATIAL_FORMATS)
    law = joint_law(joints)
    clamped = np.isinf(chain.ends.left.stiffness).all()
    if (chain.ends.left.stiffness.any() and not clamped) or chain.ends.right.stiffness.any():
        raise ValueError(f"chain must be clamped or free at s = 0 and free at s = L here, got {chain.ends}")
    stiffness = np.vstack([np.full(3, np.inf), chain.joint_stiffness])
    if not law.orders:
        spread = stiffness[1:].max(axis=1) / stiffness[1:].min(axis=1)
        if not np.isfinite(stiffness[1:]).all() or (spread > 1 + _ALIKE).any():
            raise ValueError(
                "joints must be hinges, such as yzx_alternating, where stiffnesses differ (a ball of "
                f"MuJoCo's has one), got {law.name}"
            )
    modes = spatial_modes(chain, 3 * chain.tree.pieces)
    frequencies = ", ".join(f"{f:.6g}" for f in modes.frequency[:_REPORTED].tolist())
    errors = ", ".join(percent(error) for error in rod_errors(chain, _REPORTED).tolist())
    facts = (
        f"{name}: a rod in space, {chain.ends}, joints {law.name}",
        f"rule: {chain.rule.name}, {chain.segments} segments",
        f"first frequencies without gravity: {frequencies} Hz; against the exact rod: {errors}",
        "x runs along the rod at s = 0; shear and stretch are not modelled",
    )
    slowest = float(modes.angular_frequency[-1]) if len(modes.angular_frequency) else 1.0
    pieces = _pieces(chain, name, law, stiffness, bool(clamped))
    if format == "mjcf":
        if len(pieces) > _MOST_DEEP:
            raise ValueError(f"chain must have at most {_MOST_DEEP} pieces for mjcf files, got {len(pieces)}")
        return [_mjcf(pieces, name, facts, 1.0 / slowest)]
    if not law.orders:
        raise ValueError(f"joints must be hinges, such as yzx_alternating, in {format} files, got {law.name}")
    links = _links(pieces)
    notes = (*facts, f"links between two hinges of a node have {_CARRIER:g} of its piece's mass")
    if format == "sdf":
        return [_sdf(links, name, notes, 1.0 / slowest)]
    return _urdf(links, name, notes)


@dataclass(frozen=True)
class _Piece:
    """A body with the hinges to its parent, about its own axes, which are those of its joint at rest.

    Attributes
    ----------
    name, parent : str
        "world" is the parent of what is fixed to the ground, none of a free root.
    axes, place : ndarray
        At rest in space.
    before, onward : ndarray
        Its place and axes seen from its parent.
    mass, centre, inertia
        In its own axes.
    tip : ndarray
        Where the next node is, in its own axes.
    hinges : tuple of (name, letter, stiffness)
        From the parent on; the letter of a ball is empty.
    """

    name: str
    parent: str
    axes: Floats
    place: Floats
    before: Floats
    onward: Floats
    mass: float
    centre: Floats
    inertia: Floats
    tip: Floats
    hinges: tuple[tuple[str, str, float], ...]


def _pieces(chain: SpatialChain, name: str, law: JointLaw, stiffness: Floats, clamped: bool) -> list[_Piece]:
    tree = chain.tree
    frames = np.concatenate([tree.supports[0].frame[None], tree.joint_frame[1:]])
    places = np.vstack([tree.joint_place, tree.supports[-1].place])
    # A piece without mass at a clamped end is the ground.
    first = int(clamped and tree.mass[0] == 0.0)
    least = _CARRIER * float(tree.mass.sum())
    parent, axes, origin = "world" if clamped else "", np.eye(3), np.zeros(3)
    found = []
    for i in range(first, tree.pieces):
        own, place, joint = frames[i], places[i], f"{name}_joint_{i}"
        # The law's first order is that of its first coordinates: the root's.
        letters = law.orders[i % len(law.orders)] if law.orders else ""
        springs = [
            (f"{joint}_{letter}", letter, float(stiffness[i]["xyz".index(letter)])) for letter in letters
        ]
        hinges = [spring for spring in springs if math.isfinite(spring[2])]
        if i and not letters:
            hinges = [(joint, "", float(stiffness[i, 0]))]
        found.append(
            _Piece(
                name=f"{name}_piece_{i}",
                parent=parent,
                axes=own,
                place=place,
                before=axes.T @ (place - origin),
                onward=axes.T @ own,
                mass=max(float(tree.mass[i]), least),
                centre=own.T @ (tree.centre[i] - place),
                inertia=_inertia(own.T @ tree.inertia[i] @ own, least * chain.rod.length**2),
                tip=own.T @ (places[i + 1] - place),
                hinges=tuple(hinges if i else ()),
            )
        )
        parent, axes, origin = found[-1].name, own, place
    return found


def _inertia(inertia: Floats, least: float) -> Floats:
    """Return an inertia that a body can have, or raise ValueError."""
    low, middle, high = np.linalg.eigvalsh(inertia)
    if low + middle < high * (1.0 - 1e-9):
        raise ValueError(
            "chain must have pieces whose inertias a body can have: a section's inertias about y and z add "
            "up to its polar one"
        )
    # A line of mass in a plane is at the limit of what a body can be, and rounding beyond it.
    size = float(np.trace(inertia))
    more: Floats = inertia + (_TRACE * size if size else _TRACE * least) * np.eye(3)
    return more


def _links(pieces: list[_Piece]) -> list[tuple[_Piece, tuple[str, str, float] | None]]:
    """Return every hinge with a link of its own; a nearly massless one between two hinges of a node."""
    found: list[tuple[_Piece, tuple[str, str, float] | None]] = []
    for piece in pieces:
        parent, before, onward = piece.parent, piece.before, piece.onward
        small = _CARRIER * float(np.trace(piece.inertia)) * np.eye(3)
        for hinge in piece.hinges[:-1]:
            carrier = replace(
                piece,
                name=f"{hinge[0]}_carrier",
                parent=parent,
                before=before,
                onward=onward,
                mass=_CARRIER * piece.mass,
                centre=np.zeros(3),
                inertia=small,
            )
            found.append((carrier, hinge))
            parent, before, onward = carrier.name, np.zeros(3), np.eye(3)
        last = piece.hinges[-1] if piece.hinges else None
        found.append((replace(piece, parent=parent, before=before, onward=onward), last))
    return found


def _mjcf(pieces: list[_Piece], name: str, facts: tuple[str, ...], step: float) -> str:
    radius = sum(math.sqrt(piece.tip @ piece.tip) for piece in pieces) / 200
    lines = [
        *_comment(*facts, "gravity is off; timestep: half of what RK4 is stable to"),
        f'<mujoco model="{name}">',
        f' <option timestep="{math.sqrt(2.0) * step!r}" integrator="RK4" gravity="0 0 0"/>',
        " <worldbody>",
    ]
    for depth, piece in enumerate(pieces):
        pad = " " * (2 + depth)
        six = [piece.inertia[j, k] for j, k in _SIX.values()]
        lines += [
            f'{pad}<body name="{piece.name}" pos="{_n(*piece.before)}" {_quaternion(piece.onward)}>',
            f'{pad} <inertial pos="{_n(*piece.centre)}" mass="{_n(piece.mass)}" fullinertia="{_n(*six)}"/>',
        ]
        if not piece.parent:
            lines.append(f'{pad} <freejoint name="{name}_free"/>')
        for joint, letter, spring in piece.hinges:
            kind = f'type="hinge" axis="{_AXES[letter]}"' if letter else 'type="ball"'
            lines.append(f'{pad} <joint name="{joint}" {kind} stiffness="{_n(spring)}"/>')
        if piece.tip.any():
            size = f'fromto="0 0 0 {_n(*piece.tip)}" size="{_n(radius)}" mass="0"'
            lines.append(f'{pad} <geom type="capsule" {size} contype="0" conaffinity="0"/>')
    lines += [f"{' ' * (2 + depth)}</body>" for depth in reversed(range(len(pieces)))]
    return "\n".join([*lines, " </worldbody>", "</mujoco>", ""])


def _sdf(
    links: list[tuple[_Piece, tuple[str, str, float] | None]], name: str, facts: tuple[str, ...], step: float
) -> str:
    lines = [
        _XML,
        *_comment(*facts, "gravity is off; step: half of what Drake's discrete plants are stable to"),
        '<sdf version="1.7">',
        f' <world name="{name}_world">',
        "  <gravity>0 0 0</gravity>",
        f'  <physics name="fixed_step" default="true" type="ode"><max_step_size>{step!r}</max_step_size>'
        "<real_time_factor>1</real_time_factor></physics>",
        f'  <model name="{name}">',
    ]
    for piece, hinge in links:
        moments = "".join(f"<{key}>{_n(piece.inertia[j, k])}</{key}>" for key, (j, k) in _SIX.items())
        lines += [
            f'   <link name="{piece.name}">',
            f"    <pose>{_n(*piece.place, *_angles(piece.axes))}</pose>",
            f"    <inertial><pose>{_n(*piece.centre, 0, 0, 0)}</pose>",
            f"     <mass>{_n(piece.mass)}</mass><inertia>{moments}</inertia></inertial>",
            "   </link>",
        ]
        if hinge:
            lines += [
                f'   <joint name="{hinge[0]}" type="revolute">',
                f"    <parent>{piece.parent}</parent><child>{piece.name}</child>",
                f"    <axis><xyz>{_AXES[hinge[1]]}</xyz>",
                "     <limit><lower>-1e16</lower><upper>1e16</upper></limit>",
                "     <dynamics><damping>0.0</damping><spring_reference>0</spring_reference>"
                f"<spring_stiffness>{_n(hinge[2])}</spring_stiffness></dynamics></axis>",
                "   </joint>",
            ]
        elif piece.parent:
            lines += [
                f'   <joint name="{piece.name}_weld" type="fixed">',
                f"    <parent>{piece.parent}</parent><child>{piece.name}</child>",
                "   </joint>",
            ]
    return "\n".join([*lines, "  </model>", " </world>", "</sdf>", ""])


def _urdf(
    links: list[tuple[_Piece, tuple[str, str, float] | None]], name: str, facts: tuple[str, ...]
) -> list[str]:
    notes = (*facts, "URDF knows no springs: they are in the file beside this one")
    lines = [_XML, *_comment(*notes), f'<robot name="{name}">']
    lines += [' <link name="world"/>'] if links[0][0].parent else []
    springs = [f"# {fact}" for fact in facts]
    springs += [
        "# hinges in N m/rad; the moment is -stiffness * (position - rest)",
        f"model: {name}",
        "springs:",
    ]
    for piece, hinge in links:
        inertia = " ".join(f'{key}="{_n(piece.inertia[j, k])}"' for key, (j, k) in _SIX.items())
        lines += [
            f' <link name="{piece.name}"><inertial>',
            f'  <origin xyz="{_n(*piece.centre)}" rpy="0 0 0"/>',
            f'  <mass value="{_n(piece.mass)}"/><inertia {inertia}/>',
            " </inertial></link>",
        ]
        if not piece.parent:
            continue
        turning = f'name="{hinge[0]}" type="revolute"' if hinge else f'name="{piece.name}_weld" type="fixed"'
        lines += [
            f" <joint {turning}>",
            f'  <parent link="{piece.parent}"/><child link="{piece.name}"/>',
            f'  <origin xyz="{_n(*piece.before)}" rpy="{_n(*_angles(piece.onward))}"/>',
        ]
        if hinge:
            lines += [
                f'  <axis xyz="{_AXES[hinge[1]]}"/>',
                '  <limit lower="-3" upper="3" effort="1e9" velocity="1e9"/>',
            ]
            text = repr(hinge[2])
            # YAML 1.1 takes 1e-05 for a word: a number has a point.
            number = text if "." in text else text.replace("e", ".0e")
            springs.append(f"  - {{joint: {hinge[0]}, type: hinge, stiffness: {number}, rest: 0.0}}")
        lines.append(" </joint>")
    return ["\n".join([*lines, "</robot>", ""]), "\n".join([*springs, ""])]


_AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
_SIX = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}


def _comment(*facts: str) -> list[str]:
    # Two hyphens may not stand in a comment.
    return ["<!--", *(f"  {fact.replace('--', '- -')}" for fact in facts), "-->"]


def _quaternion(matrix: Floats) -> str:
    """Return a rotation as MuJoCo writes it."""
    vector = rotation_vector(matrix)
    half = 0.5 * math.sqrt(vector @ vector)
    return f'quat="{_n(math.cos(half), *(0.5 * np.sinc(half / math.pi) * vector))}"'


def _angles(matrix: Floats) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a rotation R_z R_y R_x."""
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    yaw = math.atan2(matrix[1, 0], matrix[0, 0])
    # At a pitch of a quarter turn roll and yaw are one; the rest of the rotation is then roll.
    sin, cos = math.sin(yaw), math.cos(yaw)
    roll = math.atan2(sin * matrix[0, 2] - cos * matrix[1, 2], cos * matrix[1, 1] - sin * matrix[0, 1])
    return roll, pitch, yaw


def _n(*values: float) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)
