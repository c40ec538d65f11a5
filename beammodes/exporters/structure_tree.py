"""A chain of a structure as multibody tools take it: a tree of rigid bodies and hinges from the ground.

x and y of the structure are x and z there. A positive angle is counter-clockwise in that plane.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from beammodes.chains.structure_chain import GROUND, Hinge, StructureChain
from beammodes.numerics.arrays import Floats
from beammodes.problem.structure import Node

__all__ = ["TreeBody", "TreeJoint", "structure_tree"]

#: Mass of a body that has inertia and no mass, over that of all beams.
_TRACE = 1e-12
#: Axes of joints in the model: slides along x and z, and a hinge.
_SLIDES, _HINGE = ((1, 0, 0), (0, 0, 1)), (0, -1, 0)


class TreeJoint(NamedTuple):
    """A coordinate of a body relative to its parent."""

    name: str
    kind: str
    axis: tuple[int, int, int]
    stiffness: float


@dataclass
class TreeBody:
    """A rigid body of the tree.

    Attributes
    ----------
    name : str
    parent : str
        "world", or the body that comes before.
    place : (float, float) [m]
        Of its joint, from that of its parent.
    origin : (float, float) [m]
        The same, in the structure.
    joints : tuple of TreeJoint
    mass, inertia : float [kg], [kg m²]
        The inertia about its centre of mass.
    centre : (float, float) [m]
        Of mass, from its joint.
    rods : list of ((float, float), (float, float)) [m]
        Ends of its pieces, from its joint.
    """

    name: str
    parent: str
    place: tuple[float, float]
    origin: tuple[float, float]
    joints: tuple[TreeJoint, ...]
    mass: float = 0.0
    inertia: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)
    rods: list[tuple[tuple[float, float], tuple[float, float]]] = field(default_factory=list)


class _Point(NamedTuple):
    """A place where bodies meet."""

    place: tuple[float, float]
    bodies: list[int]
    node: int | None


def structure_tree(chain: StructureChain, name: str) -> list[TreeBody]:
    """Return the bodies of a chain, each after its parent.

    Raises
    ------
    ValueError
        If the chain is no tree: a closed frame, or one with more than one supported joint; if a body has no
        inertia; or a support can turn none of what it lets slide.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [bm.Station(0.5, mass=1.0)])
    >>> [body.name for body in structure_tree(bm.StructureChain(beam, 4), "arm")]
    ['arm_1', 'arm_2', 'arm_3', 'arm_4']
    """
    points = _points(chain)
    edges = [(_place(hinge, points), hinge.bodies, hinge.stiffness) for hinge in chain.hinges]
    root, slides = _root(chain, points)
    for point in points:
        edges += _pins(point, [pair for place, pair, _ in edges if place == point.place], point is root)
    return _bodies(chain, name, edges, root, slides)


def _points(chain: StructureChain) -> list[_Point]:
    """Return where bodies meet: nodes first, then hinges inside stretches."""
    nodes = chain.parts.nodes
    meeting: list[list[int]] = [[] if body is None else [body] for body in chain.joints]
    inner = []
    for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True):
        long = [j for j, length in enumerate(pieces.length.tolist()) if length]
        for i, j in zip(stretch.nodes, (long[0], long[-1]), strict=True):
            meeting[i].append(bodies[j])
        x0, y0 = nodes[stretch.nodes[0]].place
        for x, a, b in zip(pieces.hinge_position.tolist(), bodies, bodies[1:], strict=False):
            if 0.0 < x < stretch.beam.length * (1 - 1e-12):
                place = (x0 + x * stretch.axis[0], y0 + x * stretch.axis[1])
                inner.append(_Point(place, [a, b], None))
    at_nodes = [
        _Point(node.place, list(dict.fromkeys(bodies)), i)
        for i, (node, bodies) in enumerate(zip(nodes, meeting, strict=True))
    ]
    return at_nodes + inner


def _place(hinge: Hinge, points: list[_Point]) -> tuple[float, float]:
    """Return where a hinge is."""
    bodies = set(hinge.bodies)
    for point in points:
        own = set(point.bodies) | ({GROUND} if point.node is not None else set())
        if bodies <= own and bodies & set(point.bodies):
            return point.place
    raise AssertionError(hinge)


def _root(chain: StructureChain, points: list[_Point]) -> tuple[_Point, list[tuple[int, float]]]:
    """Return where the ground holds the tree, and the directions in which it does not, with their springs."""
    held = [i for i, node in enumerate(chain.parts.nodes) if node.supports or node.rotational_stiffness]
    if len(held) > 1:
        names = ", ".join(chain.parts.nodes[i].name for i in held)
        raise ValueError(f"chain must be supported at one joint only to be a tree, got supports at {names}")
    root = held[0] if held else 0
    return points[root], _slides(chain.parts.nodes[root])


def _slides(node: Node) -> list[tuple[int, float]]:
    springs = [0.0, 0.0]
    for unit, stiffness in node.supports:
        along = [k for k in (0, 1) if abs(abs(unit[k]) - 1.0) < 1e-12]
        if not along:
            raise ValueError(f"supports must be along x or y to be joints of a tree, got one at {node.name}")
        springs[along[0]] += stiffness
    slides = [(k, stiffness) for k, stiffness in enumerate(springs) if stiffness < math.inf]
    if slides and node.rotational_stiffness == math.inf:
        raise ValueError(
            f"supports must leave free to turn what they let slide to be joints of a tree, got {node.name}"
        )
    return slides


#: The place of a hinge, the bodies that it joins, and its stiffness.
_Edge = tuple[tuple[float, float], tuple[int, int], float]


def _pins(point: _Point, joined: list[tuple[int, int]], is_root: bool) -> list[_Edge]:
    """Return the pins of bodies that meet at a node and are not joined by a hinge there."""
    if point.node is None:
        return []
    bodies = [*([GROUND] if is_root else []), *point.bodies]
    together = {body: {body} for body in bodies}
    for a, b in joined:
        whole = together.setdefault(a, {a}) | together.setdefault(b, {b})
        for body in whole:
            together[body] = whole
    pins: list[_Edge] = []
    for body in bodies[1:]:
        if body not in together[bodies[0]]:
            pins.append((point.place, (bodies[0], body), 0.0))
            whole = together[bodies[0]] | together[body]
            for one in whole:
                together[one] = whole
    return pins


def _bodies(
    chain: StructureChain, name: str, edges: list[_Edge], root: _Point, slides: list[tuple[int, float]]
) -> list[TreeBody]:
    if len(edges) != chain.body_count - 1:
        raise ValueError(
            f"chain must be a tree for files, got a closed frame of {chain.body_count - 1} bodies and "
            f"{len(edges)} hinges"
        )
    found: dict[int, TreeBody] = {}
    pending, names = [GROUND], {GROUND: "world"}
    origins = {GROUND: (0.0, 0.0)}
    while pending:
        parent = pending.pop(0)
        for place, pair, stiffness in edges:
            body = pair[1] if pair[0] == parent else pair[0]
            if parent not in pair or body in names:
                continue
            names[body], origins[body] = f"{name}_{len(names)}", place
            joint = TreeJoint(f"{names[body]}_hinge", "hinge", _HINGE, stiffness)
            own = [joint]
            if parent == GROUND and place == root.place:
                own = [
                    *(TreeJoint(f"{names[body]}_{'xz'[k]}", "slide", _SLIDES[k], k_t) for k, k_t in slides),
                    joint,
                ]
            start = origins[parent]
            shift = place[0] - start[0], place[1] - start[1]
            found[body] = TreeBody(names[body], names[parent], shift, place, tuple(own))
            pending.append(body)
    if slides and len([one for one in found.values() if one.parent == "world"]) > 1:
        raise ValueError("supports must carry one body to be joints of a tree, got several that slide")
    _fill(chain, found)
    light = [body.name for body in found.values() if not body.inertia]
    if light:
        raise ValueError(
            f"chain must have no body without inertia, got {len(light)}, where three members meet or on a "
            "rotational spring: take a rule whose hinges are off the joints (half_stub_corrected), or give "
            "the joint a rotary_inertia"
        )
    return list(found.values())


def _fill(chain: StructureChain, found: dict[int, TreeBody]) -> None:
    """Add up masses, centres and inertias."""
    parts: dict[int, list[tuple[float, Floats, float]]] = {body: [] for body in found}
    for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True):
        axis, start = np.array(stretch.axis), np.array(chain.parts.nodes[stretch.nodes[0]].place)
        begin = np.concatenate(([0.0], np.cumsum(pieces.length)))
        for j, body in enumerate(bodies):
            if body not in found or not pieces.length[j]:
                continue
            own = start - np.array(found[body].origin)
            first, last = own + begin[j] * axis, own + begin[j + 1] * axis
            found[body].rods.append(((first[0], first[1]), (last[0], last[1])))
            centre = own + (begin[j] + pieces.centre[j]) * axis
            parts[body].append((float(pieces.mass[j]), centre, float(pieces.rotary_inertia[j])))
    for i, (node, fixed) in enumerate(zip(chain.parts.nodes, chain.joints, strict=True)):
        if not node.mass and not node.rotary_inertia:
            continue
        # A point mass moves with any body that ends at the node.
        body = _at_node(chain, i) if fixed is None else fixed
        if body in found:
            place = np.array(node.place) + node.offset - found[body].origin
            parts[body].append((node.mass, place, node.rotary_inertia))
    for body, given in parts.items():
        # Tools take no body without mass; so little of it is not felt.
        mass = math.fsum(m for m, _, _ in given) or _TRACE * math.fsum(one.mass.sum() for one in chain.chains)
        centre = sum((m * place for m, place, _ in given), np.zeros(2)) / mass
        inertia = math.fsum(j + m * float(np.sum((place - centre) ** 2)) for m, place, j in given)
        one = found[body]
        one.mass, one.inertia, one.centre = mass, inertia, (float(centre[0]), float(centre[1]))


def _at_node(chain: StructureChain, node: int) -> int:
    """Return a body that ends at a node."""
    return next(
        bodies[j]
        for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True)
        for at, j in zip(stretch.nodes, _outer(pieces.length), strict=True)
        if at == node
    )


def _outer(length: Floats) -> tuple[int, int]:
    long = np.flatnonzero(length > 0.0)
    return int(long[0]), int(long[-1])
