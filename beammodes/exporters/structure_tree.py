"""A chain of a structure as multibody tools take it: a tree of rigid bodies and hinges from the ground.

x and y of the structure are x and z there. A positive angle is counter-clockwise in that plane.

Bodies meet at points. A spanning tree of these is the tree's joints; what is left closes it:

    a point of two bodies that the tree does not join      `Closure`
    a spring between bodies that no joint is between,
    a support of a point in one direction, held or sprung  `Tie`, linear in the joints, for small motions

A body without mass or inertia, where three hinges meet, is left out: its springs k_i to other bodies are
springs k_i k_j / Σ k between each two of these.
"""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from beammodes.chains.structure_chain import GROUND, StructureChain
from beammodes.exporters.model_tree import Tie
from beammodes.numerics.arrays import Floats
from beammodes.problem.structure import Node

__all__ = ["HINGE", "Closure", "StructureTree", "TreeBody", "TreeJoint", "structure_tree"]

#: Mass of a body that has inertia and no mass, over that of all beams.
_TRACE = 1e-12
#: Axes of joints in the model: slides along x and z, and a hinge.
_SLIDES, HINGE = ((1, 0, 0), (0, 0, 1)), (0, -1, 0)
#: Arms below this part of the longest, and angles between directions below this, are rounding.
_NOTHING = 1e-12

Vector = tuple[float, float]
Pair = tuple[int, int]


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
    place: Vector
    origin: Vector
    joints: tuple[TreeJoint, ...]
    mass: float = 0.0
    inertia: float = 0.0
    centre: Vector = (0.0, 0.0)
    rods: list[tuple[Vector, Vector]] = field(default_factory=list)


class Closure(NamedTuple):
    """A pin that the tree has not: two bodies that share a point, the second of which may be the "world".

    Attributes
    ----------
    name : str
    bodies : (str, str)
    place : (float, float) [m]
        In the structure.
    at : (float, float) [m]
        From the joint of the first body.
    stiffness : float [N m/rad]
        Of a spring between the two, which is among the ties, too.
    """

    name: str
    bodies: tuple[str, str]
    place: Vector
    at: Vector
    stiffness: float


class StructureTree(NamedTuple):
    """Bodies, each after its parent; what closes the tree; and ties that no closure has a spring for.

    Attributes
    ----------
    bodies : list of TreeBody
    closures : list of Closure
    springs : list of Tie
        Those of closures.
    ties : list of Tie
    """

    bodies: list[TreeBody]
    closures: list[Closure]
    springs: list[Tie]
    ties: list[Tie]


def structure_tree(chain: StructureChain, name: str) -> StructureTree:
    """Return a chain as a tree of bodies, with what closes it.

    Raises
    ------
    ValueError
        If a body has no inertia.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Structure.of_beam(bm.Beam.unit(), "clamped-pinned", [bm.Station(0.5, mass=1.0)])
    >>> tree = structure_tree(bm.StructureChain(beam, 4), "arm")
    >>> [body.name for body in tree.bodies], [tie.name for tie in tree.ties]
    (['arm_1', 'arm_2', 'arm_3', 'arm_4'], ['arm_right_y'])
    """
    return _Growing(chain, name, _Parts.of(chain), set(), {}, {}).grown()


@dataclass
class _Parts:
    """Bodies of a chain, the points that they share, and springs between their angles.

    Attributes
    ----------
    bodies : list of list of int
        As of the chain; pieces that a support keeps from turning and lets slide are bodies of their own.
    at_nodes : list of list of int
        Bodies that end at each node, `GROUND` first where a support holds it.
    upright : set of int
        Bodies that do not turn.
    pins : dict from places to pairs of bodies
        That share a point there, as many as it takes.
    springs : dict from pairs of bodies to stiffness
    """

    bodies: list[list[int]]
    at_nodes: list[list[int]]
    upright: set[int]
    pins: dict[Vector, list[Pair]]
    springs: dict[Pair, float]

    @classmethod
    def of(cls, chain: StructureChain) -> _Parts:
        nodes, sliders = chain.parts.nodes, _sliders(chain)
        bodies, at_nodes, ends = [list(of) for of in chain.bodies], [], _ends(chain)
        hinges = [(hinge.place, hinge.bodies, hinge.stiffness) for hinge in chain.hinges]
        for i, slider in sliders.items():
            beside = {nodes[i].place}
            for s, j, inwards in ends[i]:
                if bodies[s][j] == GROUND:
                    bodies[s][j] = slider
                    beside.add(_first_hinge(chain, s, inwards))
            hinges = [
                (place, (slider, max(pair)) if place in beside and GROUND in pair else pair, stiffness)
                for place, pair, stiffness in hinges
            ]
        heavy = set(sliders.values())
        for of, pieces in zip(bodies, chain.chains, strict=True):
            heavy |= {body for body, length in zip(of, pieces.length, strict=True) if length}
        for i, (node, body) in enumerate(zip(nodes, chain.joints, strict=True)):
            meeting = [GROUND] if _is_firm(node) else []
            meeting += [sliders[i]] if i in sliders else []
            if body and (body in heavy or node.has_turning_body):
                heavy.add(body)
                meeting.append(body)
            meeting += [bodies[s][j] for s, j, _ in ends[i]]
            at_nodes.append(list(dict.fromkeys(meeting)))
        made = cls(bodies, at_nodes, set(sliders.values()), {}, {})
        # A hinge to the ground is a point of it unless the node there may move.
        moving = {node.place for node in nodes if not _is_firm(node)}
        for place, pair, stiffness in _without_light(hinges, heavy):
            ordered = min(pair), max(pair)
            made.springs[ordered] = made.springs.get(ordered, 0.0) + stiffness
            if GROUND not in pair or place not in moving:
                made._pin(place, ordered)
        for node, meeting in zip(nodes, at_nodes, strict=True):
            for body in meeting[1:]:
                made._pin(node.place, (min(meeting[0], body), max(meeting[0], body)))
        return made

    def _pin(self, place: Vector, pair: Pair) -> None:
        """Add a pin, unless others in the same place do its work."""
        pins, together, before = self.pins.setdefault(place, []), {pair[0]}, 0
        while len(together) > before:
            before = len(together)
            for other in pins:
                if together.intersection(other):
                    together |= set(other)
        if pair[1] not in together:
            pins.append(pair)


def _sliders(chain: StructureChain) -> dict[int, int]:
    """Return new numbers for bodies that supports keep from turning and let slide, by their nodes."""
    found: dict[int, int] = {}
    for i, (node, ends) in enumerate(zip(chain.parts.nodes, _ends(chain), strict=True)):
        slides = node.rotational_stiffness == math.inf and not _is_firm(node)
        if slides and (node.mass or any(chain.bodies[s][j] == GROUND for s, j, _ in ends)):
            found[i] = chain.body_count + len(found)
    return found


def _ends(chain: StructureChain) -> list[list[tuple[int, int, int]]]:
    """Return what ends at each node: a stretch, its outer piece that has a length, and the way inwards."""
    found: list[list[tuple[int, int, int]]] = [[] for _ in chain.parts.nodes]
    for s, (stretch, pieces) in enumerate(zip(chain.parts.stretches, chain.chains, strict=True)):
        long = np.flatnonzero(pieces.length > 0.0)
        for i, j, way in zip(stretch.nodes, (int(long[0]), int(long[-1])), (1, -1), strict=True):
            found[i].append((s, j, way))
    return found


def _first_hinge(chain: StructureChain, s: int, way: int) -> Vector:
    """Return the place of the hinge next to one end of a stretch."""
    stretch, along = chain.parts.stretches[s], chain.chains[s].hinge_position.tolist()
    if not along:
        return chain.parts.nodes[stretch.nodes[0]].place
    x, (x0, y0) = along[0 if way > 0 else -1], chain.parts.nodes[stretch.nodes[0]].place
    return x0 + x * stretch.axis[0], y0 + x * stretch.axis[1]


_Hinges = list[tuple[Vector, Pair, float]]


def _without_light(hinges: _Hinges, heavy: set[int]) -> _Hinges:
    """Return hinges between bodies that have inertia, and the ground."""
    found = list(hinges)
    for light in sorted({body for _, pair, _ in hinges for body in pair} - heavy - {GROUND}):
        about = [hinge for hinge in found if light in hinge[1]]
        found = [hinge for hinge in found if light not in hinge[1]]
        total = math.fsum(stiffness for *_, stiffness in about)
        far = [(place, next(b for b in pair if b != light), stiffness) for place, pair, stiffness in about]
        for (place, a, first), (_, b, second) in itertools.combinations(far, 2):
            if a != b:
                found.append((place, (min(a, b), max(a, b)), first * second / total))
    return found


def _freedom(node: Node) -> int:
    """Return how many motions supports leave a node: the least free is the best place to begin."""
    return 3 - sum(k == math.inf for _, k in node.supports) - (node.rotational_stiffness == math.inf)


def _is_firm(node: Node) -> bool:
    """Return whether supports hold a node in every direction."""
    held = [unit for unit, k in node.supports if k == math.inf]
    return any(abs(a[0] * b[1] - a[1] * b[0]) > _NOTHING for a, b in itertools.combinations(held, 2))


@dataclass
class _Growing:
    """A tree while it grows from the ground."""

    chain: StructureChain
    name: str
    parts: _Parts
    #: Pins that are joints of the tree.
    used: set[tuple[Vector, Pair]]
    found: dict[int, TreeBody]
    #: Of each body, its joints and those of all before it: name, direction or None of a hinge, place.
    ways: dict[int, list[tuple[str, Vector | None, Vector]]]

    def grown(self) -> StructureTree:
        nodes = self.chain.parts.nodes
        self.ways[GROUND] = []
        self._grow(GROUND)
        carried: set[Pair] = set()
        for i in sorted(range(len(nodes)), key=lambda i: _freedom(nodes[i])):
            body = self.parts.at_nodes[i][0]
            if body not in self.ways:
                carried |= self._float(i, body)
                self._grow(body)
        self._fill()
        light = [body.name for body in self.found.values() if not body.inertia]
        if light:
            raise ValueError(
                f"chain must have no body without inertia, got {len(light)}: take a rule whose segments have "
                "rotary inertia"
            )
        closures, springs = self._closures()
        ties = [*self._turns(), *self._supports(carried)]
        return self._without_held_slides(StructureTree(list(self.found.values()), closures, springs, ties))

    def _open(self) -> list[tuple[Vector, Pair]]:
        """Return the pins that the tree has not."""
        pins = [(place, pair) for place, pairs in self.parts.pins.items() for pair in pairs]
        return [pin for pin in pins if pin not in self.used]

    def _grow(self, root: int) -> None:
        """Add what hangs on a body, the nearest first."""
        about: dict[int, list[tuple[Vector, Pair]]] = {}
        for place, pairs in self.parts.pins.items():
            for pair in pairs:
                for body in pair:
                    about.setdefault(body, []).append((place, pair))
        pending = deque([root])
        while pending:
            parent = pending.popleft()
            for place, pair in about.get(parent, []):
                body = pair[1] if pair[0] == parent else pair[0]
                if body not in self.ways:
                    self.used.add((place, pair))
                    self._add(body, parent, place, [])
                    pending.append(body)

    def _add(self, body: int, parent: int, place: Vector, slides: list[tuple[int, float]]) -> None:
        own = f"{self.name}_{len(self.found) + 1}"
        joints = [TreeJoint(f"{own}_{'xz'[k]}", "slide", _SLIDES[k], stiffness) for k, stiffness in slides]
        way = [(joint.name, (1.0 - k, 0.0 + k), place) for joint, (k, _) in zip(joints, slides, strict=True)]
        ahead: list[tuple[str, Vector | None, Vector]] = self.ways[parent]
        if body not in self.parts.upright or any(axis is None for _, axis, _ in ahead):
            stiffness = self.parts.springs.get((min(body, parent), max(body, parent)), 0.0)
            joints.append(TreeJoint(f"{own}_hinge", "hinge", HINGE, stiffness))
            ahead = [*ahead, (joints[-1].name, None, place)]
        self.ways[body] = [*ahead, *way]
        start = self.found[parent].origin if parent else (0.0, 0.0)
        shift = place[0] - start[0], place[1] - start[1]
        before = self.found[parent].name if parent else "world"
        self.found[body] = TreeBody(own, before, shift, place, tuple(joints))

    def _float(self, i: int, body: int) -> set[Pair]:
        """Add a body that nothing holds in place; return the supports that its slides stand for."""
        node, springs = self.chain.parts.nodes[i], [0.0, 0.0]
        carried = set()
        for k, (unit, stiffness) in enumerate(node.supports):
            along = [d for d in (0, 1) if abs(abs(unit[d]) - 1.0) < _NOTHING]
            if along:
                springs[along[0]] += stiffness
                carried.add((i, k))
        slides = [(d, stiffness) for d, stiffness in enumerate(springs) if stiffness < math.inf]
        self._add(body, GROUND, node.place, slides)
        return carried

    def _closures(self) -> tuple[list[Closure], list[Tie]]:
        closures, springs = list[Closure](), list[Tie]()
        for n, (place, (b, a)) in enumerate(self._open(), start=1):
            stiffness = self.parts.springs.get((b, a), 0.0)
            name, origin = f"{self.name}_closure_{n}", self.found[a].origin
            names = self.found[a].name, self.found[b].name if b else "world"
            at = place[0] - origin[0], place[1] - origin[1]
            closures.append(Closure(name, names, place, at, stiffness))
            if stiffness:
                springs += self._angle_tie(f"{name}_spring", b, a, stiffness)
        return closures, springs

    def _turns(self) -> Iterable[Tie]:
        """Yield springs between bodies that no joint or closure is between, and what keeps bodies upright."""
        done = {pair for _, pair in self._open()}
        for (b, a), stiffness in self.parts.springs.items():
            if (b, a) in done or self._hangs(a, b) or self._hangs(b, a):
                continue
            words = (
                self.found[body].name.removeprefix(f"{self.name}_") if body else "world" for body in (b, a)
            )
            yield from self._angle_tie(f"{self.name}_turn_{'_'.join(words)}", b, a, stiffness)
        for body in sorted(self.parts.upright):
            yield from self._angle_tie(f"{self.found[body].name}_upright", GROUND, body, math.inf)

    def _hangs(self, body: int, parent: int) -> bool:
        return body != GROUND and self.found[body].parent == (self.found[parent].name if parent else "world")

    def _angle_tie(self, name: str, a: int, b: int, stiffness: float) -> Iterable[Tie]:
        """Return the angle of one body less that of another."""
        terms: dict[str, float] = {}
        for body, sign in ((a, -1.0), (b, 1.0)):
            for joint, axis, _ in self.ways[body]:
                if axis is None:
                    terms[joint] = terms.get(joint, 0.0) + sign
        left = tuple((joint, arm) for joint, arm in terms.items() if arm)
        return [Tie(name, left, stiffness, 0.0)] if left else []

    def _supports(self, carried: set[Pair]) -> Iterable[Tie]:
        """Return the supports of nodes in a direction, other than those that the tree has."""
        for i, node in enumerate(self.chain.parts.nodes):
            if _is_firm(node):
                continue
            for k, (unit, stiffness) in enumerate(node.supports):
                if (i, k) in carried:
                    continue
                terms = []
                for joint, axis, (x, y) in self.ways[self.parts.at_nodes[i][0]]:
                    across = axis if axis is not None else (-(node.place[1] - y), node.place[0] - x)
                    terms.append((joint, unit[0] * across[0] + unit[1] * across[1]))
                most = max((abs(arm) for _, arm in terms), default=0.0)
                kept = tuple((joint, arm) for joint, arm in terms if abs(arm) > _NOTHING * most)
                if kept:
                    word = "".join(c if c.isalnum() else "_" for c in node.name)
                    direction = "xy"[abs(unit[1]) > abs(unit[0])]
                    yield Tie(f"{self.name}_{word}_{direction}", kept, stiffness, 0.0)

    def _without_held_slides(self, tree: StructureTree) -> StructureTree:
        """Return a tree without slides that a support elsewhere holds still."""
        slides = {joint.name for body in tree.bodies for joint in body.joints if joint.kind == "slide"}
        still = {
            tie.terms[0][0]
            for tie in tree.ties
            if tie.stiffness == math.inf and len(tie.terms) == 1 and tie.terms[0][0] in slides
        }
        for body in tree.bodies:
            body.joints = tuple(joint for joint in body.joints if joint.name not in still)
        ties = [
            replace(tie, terms=tuple((joint, arm) for joint, arm in tie.terms if joint not in still))
            for tie in tree.ties
        ]
        return tree._replace(ties=[tie for tie in ties if tie.terms])

    def _fill(self) -> None:
        """Add up masses, centres and inertias."""
        chain, found = self.chain, self.found
        parts: dict[int, list[tuple[float, Floats, float]]] = {body: [] for body in found}
        for stretch, pieces, bodies in zip(
            chain.parts.stretches, chain.chains, self.parts.bodies, strict=True
        ):
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
        for node, meeting in zip(chain.parts.nodes, self.parts.at_nodes, strict=True):
            if not (node.mass or node.rotary_inertia) or (
                _is_firm(node) and node.rotational_stiffness == math.inf
            ):
                continue
            # The body on a joint comes first; a point mass moves with any body that ends there.
            body = next(body for body in meeting if body != GROUND)
            place = np.array(node.place) + node.offset - found[body].origin
            parts[body].append((node.mass, place, node.rotary_inertia))
        beams = math.fsum(one.mass.sum() for one in chain.chains)
        for body, given in parts.items():
            # Tools take no body without mass; so little of it is not felt.
            mass = math.fsum(m for m, _, _ in given) or _TRACE * beams
            centre = sum((m * place for m, place, _ in given), np.zeros(2)) / mass
            inertia = math.fsum(j + m * float(np.sum((place - centre) ** 2)) for m, place, j in given)
            one = found[body]
            if body in self.parts.upright and not inertia:
                # It does not turn, and tools want some.
                inertia = mass * max(float(pieces.length.max()) for pieces in chain.chains) ** 2
            one.mass, one.inertia, one.centre = mass, inertia, (float(centre[0]), float(centre[1]))
