"""A chain in space as text for MuJoCo (MJCF): three hinges a node in turns, or balls where they are right.

Each body's axes are those of its joint at rest, so that hinges stand on x, y and z and angles at rest are
zero, whatever the curvature. MuJoCo turns a body's joints in the order in which they are written.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from beammodes.accuracy.chain_against_rod import rod_errors
from beammodes.chains.rigid_tree import RigidTree
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import choice, percent
from beammodes.equations.joint_laws import JointLaw, joint_law
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import rotation_vector
from beammodes.vibration.modes_in_space import spatial_modes

__all__ = ["SPATIAL_FORMATS", "spatial_texts"]

#: Formats that hold a chain in space.
SPATIAL_FORMATS = ("mjcf",)

_REPORTED = 3

#: MuJoCo's reader gives up at elements nested 500 deep.
_MOST_DEEP = 490

#: Of a spring's stiffnesses, that a ball has but one of: as far as they may differ.
_ALIKE = 1e-9

#: Of a piece's inertia, that is added about every axis.
_TRACE = 1e-12


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
        "gravity is off; timestep: half of what RK4 is stable to",
    )
    step = math.sqrt(2.0) / float(modes.angular_frequency[-1]) if len(modes.angular_frequency) else 1e-3
    lines = [
        "<!--",
        *(f"  {fact.replace('--', '- -')}" for fact in facts),
        "-->",
        f'<mujoco model="{name}">',
        f' <option timestep="{step!r}" integrator="RK4" gravity="0 0 0"/>',
        " <worldbody>",
        *_bodies(chain, name, law, stiffness, bool(clamped)),
        " </worldbody>",
        "</mujoco>",
    ]
    return ["\n".join(lines) + "\n"]


def _bodies(chain: SpatialChain, name: str, law: JointLaw, stiffness: Floats, clamped: bool) -> Iterator[str]:
    tree = chain.tree
    frames = np.concatenate([tree.supports[0].frame[None], tree.joint_frame[1:]])
    places = np.vstack([tree.joint_place, tree.supports[-1].place])
    # A piece without mass at a clamped end is the ground.
    first = int(clamped and tree.mass[0] == 0.0)
    if tree.pieces - first > _MOST_DEEP:
        raise ValueError(f"chain must have at most {_MOST_DEEP} pieces for mjcf files, got {tree.pieces}")
    frame, origin = np.eye(3), np.zeros(3)
    radius = chain.rod.length / 200
    for i in range(first, tree.pieces):
        pad = " " * (2 + i - first)
        own = frames[i]
        place = _n(*frame.T @ (places[i] - origin))
        yield f'{pad}<body name="{name}_piece_{i}" pos="{place}" {_turn(frame.T @ own)}>'
        if tree.mass[i] > 0.0:
            yield f"{pad} {_inertial(tree, i, own, places[i])}"
        if i == 0 and not clamped:
            yield f'{pad} <freejoint name="{name}_free"/>'
        elif i and not law.orders:
            yield f'{pad} <joint name="{name}_joint_{i}" type="ball" stiffness="{_n(stiffness[i, 0])}"/>'
        elif i:
            # The law's first order is that of its first coordinates: the root's.
            for letter in law.orders[i % len(law.orders)]:
                k = "xyz".index(letter)
                if np.isfinite(stiffness[i, k]):
                    axis = " ".join("1" if j == k else "0" for j in range(3))
                    yield (
                        f'{pad} <joint name="{name}_joint_{i}_{letter}" type="hinge" axis="{axis}" '
                        f'stiffness="{_n(stiffness[i, k])}"/>'
                    )
        tip = own.T @ (places[i + 1] - places[i])
        if tip.any():
            size = f'fromto="0 0 0 {_n(*tip)}" size="{_n(radius)}" mass="0"'
            yield f'{pad} <geom type="capsule" {size} contype="0" conaffinity="0"/>'
        frame, origin = own, places[i]
    for i in range(tree.pieces - 1, first - 1, -1):
        yield f"{' ' * (2 + i - first)}</body>"


def _inertial(tree: RigidTree, i: int, own: Floats, place: Floats) -> str:
    centre = own.T @ (tree.centre[i] - place)
    inertia = own.T @ tree.inertia[i] @ own
    least, middle, largest = np.linalg.eigvalsh(inertia)
    if least + middle < largest * (1.0 - 1e-9):
        raise ValueError(
            "chain must have pieces whose inertias a body can have: a section's inertias about y and z add "
            "up to its polar one"
        )
    # A line of mass in a plane is at the limit of what a body can be, and rounding beyond it.
    inertia = inertia + _TRACE * np.trace(inertia) * np.eye(3)
    six = [inertia[j, k] for j, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return f'<inertial pos="{_n(*centre)}" mass="{_n(tree.mass[i])}" fullinertia="{_n(*six)}"/>'


def _turn(matrix: Floats) -> str:
    """Return a rotation as a quaternion of MuJoCo's."""
    vector = rotation_vector(matrix)
    half = 0.5 * math.sqrt(vector @ vector)
    return f'quat="{_n(math.cos(half), *(0.5 * np.sinc(half / math.pi) * vector))}"'


def _n(*values: float) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)
