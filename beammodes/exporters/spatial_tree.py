"""A chain in space as a row of bodies and joints, each in the section's axes at the node where it begins.

Three hinges turn about the section's x (twist), y and z. A joint's coordinates are those of `joint_laws`: the
piece farther along the rod relative to the one before it, also where the row begins at the right end. At an
end whose hinge is at the wall, the piece without length between hinge and support is left out if it has no
inertia, or does not turn: hinge and support are then springs in a row.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from beammodes.chains.spatial_chain import SpatialChain
from beammodes.equations.joint_laws import JointLaw
from beammodes.exporters.model_tree import IDENTITY, NEARLY_NOTHING, Body, Joint, Rows, Tie, Tree, Vector
from beammodes.numerics.arrays import Floats
from beammodes.vibration.damping import Damping

__all__ = ["spatial_tree"]

_AXES = "xyz"
_UNIT = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
#: Springs that differ by less, relatively, are alike; by less, moments break the triangle by rounding.
_ALIKE = 1e-9


@dataclass(frozen=True, eq=False)
class _Row:
    """Pieces from the end near the ground to the far one, n of them.

    Attributes
    ----------
    place, frame : ndarray, shape (n + 1, 3), (n + 1, 3, 3)
        Of every joint, the near support first and the far one last.
    turning : ndarray, shape (n + 1, 3)
        Stiffness of each about its axes.
    number : tuple of int
        Of each, as joint laws count.
    near, far : ndarray, shape (3,)
        Stiffness of supports along their axes.
    mass, centre, inertia : ndarray, one entry a piece
    turned : bool
        If the near end is the right one.
    """

    place: Floats
    frame: Floats
    turning: Floats
    number: tuple[int, ...]
    near: Floats
    far: Floats
    mass: Floats
    centre: Floats
    inertia: Floats
    turned: bool = False

    def backward(self) -> _Row:
        """Return the same from the other end."""
        place, frame, turning, mass, centre, inertia = (
            values[::-1]
            for values in (self.place, self.frame, self.turning, self.mass, self.centre, self.inertia)
        )
        near, far = self.far, self.near
        return _Row(
            place, frame, turning, self.number[::-1], near, far, mass, centre, inertia, not self.turned
        )

    def without_near_stub(self) -> _Row:
        """Return the same motion without a first piece of no length that has no inertia or does not turn."""
        if len(self.mass) == 1 or (self.place[0] != self.place[1]).any():
            return self
        arm = self.centre[0] - self.place[0]
        own = self.inertia[0] + self.mass[0] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        if own.any() and not np.isinf(self.turning[0]).all():
            return self
        with np.errstate(divide="ignore"):
            series = 1.0 / (1.0 / self.turning[0] + 1.0 / self.turning[1])
        mass, centre, inertia = self.mass[1:].copy(), self.centre[1:].copy(), self.inertia[1:].copy()
        if self.mass[0] and not np.isinf(self.near).all():
            # Its mass is a point at the joint, where it turns with nothing.
            apart = self.place[0] - centre[0]
            share = self.mass[0] / (mass[0] + self.mass[0])
            inertia[0] += mass[0] * share * (apart @ apart * np.eye(3) - np.outer(apart, apart))
            centre[0] += share * apart
            mass[0] += self.mass[0]
        turning = np.vstack([series, self.turning[2:]])
        return replace(
            self,
            place=self.place[1:],
            frame=self.frame[1:],
            turning=turning,
            number=self.number[1:],
            mass=mass,
            centre=centre,
            inertia=inertia,
        )


def _row(chain: SpatialChain) -> _Row:
    tree = chain.tree
    left, right = tree.supports
    with np.errstate(divide="ignore"):
        springs = 1.0 / tree.joint_flexibility[1:]
    row = _Row(
        place=np.vstack([tree.joint_place, right.place]),
        frame=np.concatenate([left.frame[None], tree.joint_frame[1:], right.frame[None]]),
        turning=np.vstack([left.stiffness[3:], springs, right.stiffness[3:]]),
        number=tuple(range(tree.pieces + 1)),
        near=left.stiffness[:3],
        far=right.stiffness[:3],
        mass=tree.mass,
        centre=tree.centre,
        inertia=tree.inertia,
    )

    def firmness(stiffness: Floats) -> tuple[int, int]:
        return int(np.isinf(stiffness).sum()), int((stiffness > 0).sum())

    row = row.without_near_stub().backward().without_near_stub()
    return row if firmness(right.stiffness) > firmness(left.stiffness) else row.backward()


def spatial_tree(
    chain: SpatialChain,
    name: str,
    law: JointLaw,
    damping: Damping | None = None,
    *,
    balls: bool = False,
) -> Tree:
    """Return a chain in space as bodies and joints named after `name`.

    Parameters
    ----------
    chain : SpatialChain
    name : str
    law : JointLaw
        Hinges in its orders; ball joints need springs that are alike and a free far end.
    damping : Damping, optional
        In proportion to stiffness.
    balls : bool
        An end that turns freely turns on a ball joint, whatever the law, if the far end is free.

    Raises
    ------
    ValueError
        If damping is of another kind, or ball joints would not be right.
    """
    given = damping or Damping()
    if given.mass or given.joint:
        raise ValueError(f"damping must be stiffness alone for a chain in space, got {given}")
    row = _row(chain)
    supported = bool(row.far.any() or row.turning[-1].any())
    if not law.orders and supported:
        raise ValueError(
            f"joints must be hinges, such as yzx_alternating, for a chain supported at both ends, "
            f"got {law.name}"
        )
    for j, springs in enumerate(chain.joint_stiffness.tolist()):
        if not law.orders and not _alike(springs):
            raise ValueError(
                "joints must be hinges, such as yzx_alternating, for a chain whose joints do not bend and "
                f"twist alike, as balls of files do, got {law.name}, and at hinge {j + 1} of the chain "
                f"springs of {', '.join(f'{value:.6g}' for value in springs)} about x, y and z"
            )
    balls = (balls and not supported) or not law.orders
    bodies, massless = [], False
    for i in range(len(row.mass)):
        joints = _joints(row, i, name, law, given.stiffness, balls=balls)
        body, lifted = _body(row, i, f"{name}_piece_{i + 1}", joints)
        bodies.append(body)
        massless = massless or lifted
    notes = _notes(row, law, massless=massless, balls=any(j.kind == "ball" for b in bodies for j in b.joints))
    return Tree(tuple(bodies), tuple(_ties(row, bodies, name, given.stiffness)), row.turned, notes)


def _joints(row: _Row, i: int, name: str, law: JointLaw, damping: float, *, balls: bool) -> tuple[Joint, ...]:
    turning, number = row.turning[i].tolist(), row.number[i]
    found = []

    def given(stiffness: float) -> tuple[float, float]:
        return stiffness, damping * stiffness

    if i == 0:
        if not row.near.any() and not any(turning):
            return (Joint(f"{name}_free", "free", (0, 0, 0)),)
        for letter, stiffness in zip(_AXES, row.near.tolist(), strict=True):
            if stiffness != math.inf:
                found.append(Joint(f"{name}_slide_{letter}", "slide", _UNIT[letter], *given(stiffness)))
    if balls and _alike(turning) and (not law.orders or not any(turning)):
        return (*found, Joint(f"{name}_ball_{number}", "ball", (0, 0, 0), *given(turning[0])))
    orders = law.orders or ("yzx",)
    order = orders[number % len(orders)]
    for letter in reversed(order) if row.turned else order:
        stiffness = turning[_AXES.index(letter)]
        if stiffness != math.inf:
            x, y, z = _UNIT[letter]
            axis = (-x, -y, -z) if row.turned else (x, y, z)
            found.append(Joint(f"{name}_hinge_{number}_{letter}", "hinge", axis, *given(stiffness)))
    return tuple(found)


def _alike(springs: list[float]) -> bool:
    return math.isfinite(sum(springs)) and max(springs) - min(springs) <= _ALIKE * max(springs)


def _body(row: _Row, i: int, name: str, joints: tuple[Joint, ...]) -> tuple[Body, bool]:
    """Return a piece as a body, and whether it has inertia only because it cannot do without."""
    size = float(np.abs(row.place - row.place[0]).max()) or 1.0
    origin, frame = row.place[i], row.frame[i]
    before, axes = (row.place[i - 1], row.frame[i - 1]) if i else (np.zeros(3), np.eye(3))
    mass = float(row.mass[i])
    inertia = frame.T @ row.inertia[i] @ frame
    mass = mass or NEARLY_NOTHING * float(row.mass.sum())
    arm = float(np.linalg.norm(row.centre[i] - origin))
    # A point of mass off its joints, or on them.
    scale = float(np.diagonal(inertia).max()) or mass * (arm or size / len(row.mass)) ** 2
    inertia = 0.5 * (inertia + inertia.T)
    inertia[np.abs(inertia) < 1e-15 * scale] = 0.0
    moments, turn = np.linalg.eigh(inertia)
    least = NEARLY_NOTHING * scale
    lifted = bool(moments[0] < least)
    small, middle, large = np.maximum(moments, least).tolist()
    missing = large - small - middle
    if lifted or 0.0 < missing <= _ALIKE * large:
        # A flat piece has the sum of two moments in the third; rounding must not make it more.
        small += max(0.0, missing) + 1e-13 * large
        inertia = (turn * [small, middle, large]) @ turn.T
        inertia[np.abs(inertia) < 1e-15 * scale] = 0.0
    body = Body(
        name,
        _vector(axes.T @ (origin - before), size),
        _rows(axes.T @ frame, 1.0),
        _vector(frame.T @ (row.place[i + 1] - origin), size),
        mass,
        _vector(frame.T @ (row.centre[i] - origin), size),
        _rows(inertia, 0.0),
        joints,
    )
    return body, lifted and len(joints) > 0


def _vector(values: Floats, scale: float) -> Vector:
    """Return three numbers, what is rounding beside a scale left out."""
    x, y, z = np.where(np.abs(values) > 1e-15 * scale, values, 0.0).tolist()
    return x, y, z


def _rows(matrix: Floats, scale: float) -> Rows:
    if scale and np.abs(matrix - np.eye(3)).max() < 1e-15:
        return IDENTITY
    one, two, three = (_vector(line, scale) for line in matrix)
    return one, two, three


def _ties(row: _Row, bodies: list[Body], name: str, damping: float) -> Iterator[Tie]:
    """Yield what supports the far end, linear in the joints."""
    tip, frame = row.place[-1], row.frame[-1]
    moved: list[tuple[str, Floats, Floats]] = []
    for i, body in enumerate(bodies):
        for joint in body.joints:
            axis = row.frame[i] @ joint.axis
            if joint.kind == "slide":
                moved.append((joint.name, axis, np.zeros(3)))
            else:
                moved.append((joint.name, np.cross(axis, tip - row.place[i]), axis))
    size = float(np.abs(row.place - row.place[0]).max())
    for what, supports, least in (
        ("deflection", row.far, 1e-14 * size),
        ("rotation", row.turning[-1], 1e-14),
    ):
        for k, stiffness in enumerate(supports.tolist()):
            coefficients = [
                (joint, float(frame[:, k] @ (shift if what == "deflection" else turn)))
                for joint, shift, turn in moved
            ]
            terms = tuple((joint, arm) for joint, arm in coefficients if abs(arm) > least)
            if stiffness and terms:
                damper = 0.0 if stiffness == math.inf else damping * stiffness
                yield Tie(f"{name}_far_{what}_{_AXES[k]}", terms, stiffness, damper)


def _notes(row: _Row, law: JointLaw, *, massless: bool, balls: bool) -> tuple[str, ...]:
    begins = "the first body is at s = L: " if row.turned else ""
    lines = [
        f"{begins}axes of the model are those of the rod's section at s = 0, x along it;",
        "those of a body are the section's where its joints are, at rest: all springs rest at zero",
    ]
    if balls and not law.orders:
        lines.append("joints are balls, whose springs resist the rotation's vector, as the rod does")
    else:
        first, second = law.orders[0], law.orders[-1]
        if len(law.orders) == 2 and first == second[::-1]:
            lines += [
                f"hinges from s = 0 on: about {', '.join(first)} at every other node and about "
                f"{', '.join(second)} between them,",
                "so that they err by second order in 1/N in large motion; in one order by first order",
            ]
        else:
            said = "; ".join(", ".join(order) for order in law.orders)
            lines.append(f"hinges from s = 0 on: about {said}: first order in 1/N in large motion")
    if massless:
        lines.append(
            f"WARNING: pieces without inertia about some axis have {NEARLY_NOTHING:g} of their largest: give "
            "the rod its polar_inertia_per_length for longer steps"
        )
    lines.append("stretch and shear are not modelled")
    return tuple(lines)
