"""A planar chain as a row of bodies and joints: x runs along the beam from the ground, z is the deflection.

A positive angle lifts the far tip. What holds or springs the far end acts on its deflection,
z₀ + Σ (distance from hinge to tip) × (joint angle),  or on its rotation,  Σ (joint angle).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.equations.equilibria import Equilibrium
from beammodes.exporters.model_tree import IDENTITY, NEARLY_NOTHING, Body, Joint, Tie, Tree
from beammodes.numerics.arrays import Floats
from beammodes.vibration.damping import Damping
from beammodes.vibration.spectrum import is_turned

__all__ = ["AXES", "planar_tree"]

#: Stiffness and damping.
Spring = tuple[float, float]

#: For each direction of deflection, the axes of a slide along it and of a hinge that lifts the far tip.
AXES = MappingProxyType({"z": ((0, 0, 1), (0, -1, 0)), "y": ((0, 1, 0), (0, 0, 1))})


@dataclass(frozen=True)
class _Plane:
    """A chain in one plane of bending, from the end near the ground to the far one.

    Attributes
    ----------
    length, mass, centre, inertia : tuple, one entry a piece
        `centre` from the piece's near tip, the inertia about it.
    springs : tuple, one entry fewer
    near, far : (across, turning)
        Springs of the supports, of infinite stiffness where they hold.
    """

    length: tuple[float, ...]
    mass: tuple[float, ...]
    centre: tuple[float, ...]
    inertia: tuple[float, ...]
    springs: tuple[Spring, ...]
    near: tuple[Spring, Spring]
    far: tuple[Spring, Spring]

    @property
    def held(self) -> tuple[bool, ...]:
        """True for each of the near deflection and angle and the far ones that a support holds."""
        return tuple(stiffness == math.inf for end in (self.near, self.far) for stiffness, _ in end)

    @property
    def reach(self) -> tuple[float, ...]:
        """From the near tip of every piece to the far tip of the last."""
        return tuple(math.fsum(self.length[i:]) for i in range(len(self.length)))

    def without_held_far_piece(self) -> _Plane:
        """Return the same motion without a last piece whose angle is held: its hinge's spring turns support.

        Mass that such a piece carries across, without turning, is a point at that hinge.
        """
        across, turning = self.far
        if turning[0] != math.inf:
            return self
        if len(self.length) == 1:
            return replace(self, near=(self.near[0], turning), far=(across, (0.0, 0.0)))
        mass, centre, inertia = self.mass[-2], self.centre[-2], self.inertia[-2]
        point = 0.0 if across[0] == math.inf else self.mass[-1]
        if point:
            arm, share = self.length[-2] - centre, point / (mass + point)
            mass, centre, inertia = mass + point, centre + arm * share, inertia + mass * share * arm**2
        return _Plane(
            self.length[:-1],
            (*self.mass[:-2], mass),
            (*self.centre[:-2], centre),
            (*self.inertia[:-2], inertia),
            self.springs[:-1],
            self.near,
            (across, self.springs[-1]),
        )


def _bending_plane(chain: Chain, damping: Damping, turned: bool) -> _Plane:
    """Return a chain's numbers from its left end, or from its right one if `turned`."""
    way = -1 if turned else 1

    def row(values: Floats) -> tuple[float, ...]:
        return tuple(values.tolist()[::way])

    def support(pair: list[float]) -> tuple[Spring, Spring]:
        across, turning = ((k, 0.0 if k == math.inf else damping.stiffness * k) for k in pair)
        return across, turning

    near, far = map(support, chain.support_stiffness.tolist()[::way])
    centre = chain.length - chain.centre if turned else chain.centre
    length, mass, middle, inertia = map(row, (chain.length, chain.mass, centre, chain.rotary_inertia))
    springs = zip(row(chain.joint_stiffness), row(damping.joint_damping(chain)), strict=True)
    return _Plane(length, mass, middle, inertia, tuple(springs), near, far)


def planar_tree(
    chain: Chain,
    name: str = "chain",
    *,
    second: Chain | None = None,
    damping: Damping | None = None,
    at: Equilibrium | None = None,
) -> Tree:
    """Return a chain as bodies and joints named after `name`, bending about both axes if `second` is given.

    The two hinges of a node come in turns: about y first at every other node, about z first between them. In
    one fixed order R = R_z R_y they would have a spurious twist of the rate  κ_y κ_z ℓ/2  and so of first
    order in ℓ; turned about at every other node the rates cancel, and the twist is of second order. From a
    shape `at` come the joints' start, and where it holds the far end.

    Raises
    ------
    ValueError
        If `second` has other pieces or is held in another way, or if pieces are damped themselves.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> tree = planar_tree(Chain(Beam.unit(), "free-clamped", 2, "naive"))
    >>> tree.turned, [joint.stiffness for body in tree.bodies for joint in body.joints]
    (True, [2.0, 2.0])
    """
    turned, damper = is_turned(chain), damping or Damping()
    if damper.mass:
        raise ValueError(
            "damping must have mass=0: joints damp relative motion only (joint_dampers meets several ratios "
            f"without it), got {damper}"
        )
    chains = [chain] if second is None else [chain, second]
    planes = [_bending_plane(each, damper, turned) for each in chains]
    _check_alike(planes)
    length = planes[0].length
    planes = [plane.without_held_far_piece() for plane in planes]
    grounded = any(end.is_grounded for each in chains for end in (each.boundary.left, each.boundary.right))
    joints = [_joints(planes, i, name, grounded) for i in range(len(planes[0].length))]
    both = "the x-z and x-y planes" if len(planes) == 2 else "the x-z plane only"
    notes = (
        f"x runs along the beam; it bends in {both}",
        "twist, stretch and shear are not modelled; the small inertia about x stands for nothing",
    )
    bodies, ties = tuple(_bodies(planes, joints, name)), tuple(_ties(planes, name))
    if at is None:
        return Tree(bodies, ties, turned, notes)
    values = _start(at, planes, turned, name)
    start = tuple(values[joint.name] for body in bodies for joint in body.joints)
    if at.span is None:
        return Tree(bodies, ties, turned, notes, start)
    x, z = at.span
    # A held last piece lies along x.
    anchor = x - math.fsum(length[len(planes[0].length) :]), 0.0, -z if turned else z
    ties = tuple(tie for tie in ties if "_far_deflection_" not in tie.name)
    return Tree(bodies, ties, turned, notes, start, anchor)


def _start(at: Equilibrium, planes: Sequence[_Plane], turned: bool, name: str) -> dict[str, float]:
    """Return the coordinates of joints in a shape, by their names."""
    way, end = (-1, -1) if turned else (1, 0)
    angle = way * at.angle[::way]
    x, z = at.nodes[end] - (at.span if turned and at.span else (0.0, 0.0))
    if turned and not at.span:
        x = float(at.chain.length.sum()) - x
    turns = np.diff(angle, prepend=0.0).tolist()
    hinges = {_hinge_name(planes, planes[0], i, name): turns[i] for i in range(len(planes[0].length))}
    return {f"{name}_slide_x": float(x), f"{name}_slide_z": float(z)} | hinges


def _check_alike(planes: Sequence[_Plane]) -> None:
    first, last = planes[0], planes[-1]
    for what in ("length", "mass", "centre", "held"):
        if getattr(first, what) != getattr(last, what):
            held = what == "held"
            raise ValueError(f"second must {'be held as chain is' if held else f'have the {what} of chain'}")


def _joints(planes: Sequence[_Plane], i: int, name: str, grounded: bool) -> tuple[Joint, ...]:
    """Return the joints between piece i and the one before; its number is that of its hinges."""
    found = [] if i or grounded else [Joint(f"{name}_slide_x", "slide", (1, 0, 0))]
    hinges = []
    for plane, (letter, (along, about)) in zip(planes, AXES.items(), strict=False):
        across, turning = plane.near if i == 0 else ((math.inf, 0.0), plane.springs[i - 1])
        if across[0] != math.inf:
            found.append(Joint(f"{name}_slide_{letter}", "slide", along, *across))
        if turning[0] != math.inf:
            hinges.append(Joint(_hinge_name(planes, plane, i, name), "hinge", about, *turning))
    return (*found, *(reversed(hinges) if i % 2 else hinges))


def _hinge_name(planes: Sequence[_Plane], plane: _Plane, i: int, name: str) -> str:
    # Piece 1 is the first that turns, so hinge 1 is the one nearest the ground.
    number = i if planes[0].held[1] else i + 1
    return f"{name}_hinge_{number}" if plane is planes[0] else f"{name}_hinge_{number}_y"


def _bodies(planes: Sequence[_Plane], joints: Sequence[tuple[Joint, ...]], name: str) -> Iterator[Body]:
    plane = planes[0]
    fixed = plane.held[1]
    root, before = joints[0], 0.0
    for i, length in enumerate(plane.length):
        own = root if i == 0 else joints[i]
        if i == 0 and fixed and not length and (not own or not plane.mass[0]) and len(joints) > 1:
            # Nothing of it is left but its joints, which pass to the next piece.
            continue
        if i == 1 and fixed and not plane.length[0] and (not root or not plane.mass[0]):
            own = (*root, *own)
        x, y, z = _inertia([each.inertia[i] for each in planes], plane, i)
        inertia = ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))
        mass = plane.mass[i] or NEARLY_NOTHING * math.fsum(plane.mass)
        number = i if fixed else i + 1
        position, tip, centre = ((along, 0.0, 0.0) for along in (before, length, plane.centre[i]))
        yield Body(f"{name}_piece_{number}", position, IDENTITY, tip, mass, centre, inertia, own)
        before = length


def _inertia(about: Sequence[float], plane: _Plane, i: int) -> tuple[float, float, float]:
    """Return the inertia about x, y, z; about the beam's axis, where nothing turns, it is small."""
    mass, centre = plane.mass[i], plane.centre[i]
    # A piece that turns has inertia or a mass off its hinge; one that does not may have any inertia.
    floor = (
        NEARLY_NOTHING * max(*about, mass * centre**2)
        or mass * (math.fsum(plane.length) / len(plane.length)) ** 2
    )
    y, z = (max(own, floor) for own in (about[0], about[-1]))
    return abs(y - z) + max(0.01 * min(y, z), floor), y, z


def _ties(planes: Sequence[_Plane], name: str) -> Iterator[Tie]:
    for plane, letter in zip(planes, AXES, strict=False):
        numbered = enumerate(plane.reach)
        turning = [
            (_hinge_name(planes, plane, i, name), arm) for i, arm in numbered if i or not plane.held[1]
        ]
        across = [] if plane.held[0] else [(f"{name}_slide_{letter}", 1.0)]
        across += [(joint, arm) for joint, arm in turning if arm]
        plain = [(joint, 1.0) for joint, _ in turning]
        for what, terms, spring in (("deflection", across, plane.far[0]), ("rotation", plain, plane.far[1])):
            if terms and spring[0]:
                yield Tie(f"{name}_far_{what}_{letter}", tuple(terms), *spring)
