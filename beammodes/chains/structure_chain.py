"""Chains for planar structures of beams: a chain for each stretch, joined at joints and stations.

A rule's springs are weights of a quadrature of M²/EI. A support, a body, a corner breaks the smoothness
of M² as a clamp does, so a node of a structure is an end of every stretch that meets there, and each puts its
end weights there. Where two stretches meet and nothing else turns, their two hinges are springs in series,
one hinge: of `gregory` 3/8 + 3/8 = 3/4 on a uniform beam, be it straight or bent at a corner there, and a
crack of stiffness K adds EI/(K ell). Three stretches that meet keep a hinge each.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import AnyRule, Layout, Rule, fits_of, layout_of
from beammodes.checks import Shown, bounded, flag, is_text, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import ENDS, Boundary
from beammodes.problem.structure import Node, Parts, Structure, checked_structure

__all__ = ["Hinge", "StructureChain", "moments_at_ends", "shared_segments"]

#: Body 0 is the ground.
GROUND = 0
#: A rule that takes so many segments to be right for the simplest moments is never.
_FEW = 7


class Hinge(NamedTuple):
    """A rotational spring between two rigid bodies of a chain.

    Attributes
    ----------
    name : str
        Where it is: a joint, or a member and the distance from its start.
    bodies : (int, int)
        Which it joins; 0 is the ground.
    flexibility : float [rad/(N m)]
    place : (float, float) [m]
    """

    name: str
    bodies: tuple[int, int]
    flexibility: float
    place: tuple[float, float]

    @property
    def stiffness(self) -> float:
        """Of the spring [N m/rad]."""
        return 1.0 / self.flexibility


@dataclass(frozen=True, init=False, eq=False, repr=False)
class StructureChain(Shown):
    """A planar structure as rigid segments and rotational springs, by a rule.

    Parameters
    ----------
    structure : Structure
    segments : int or sequence of int
        N in all, shared out so that the longest segment is as short as N segments allow: every stretch
        between two nodes gets ⌈its length/h⌉ with the smallest h for which these are no more than N, equal
        stretches equally many (so that a few of N may be left over), and an even number if the rule needs
        that; where N is enough, no fewer than its weights take to be right on so short a stretch (2 of
        `gregory`, 3 of `half_stub_corrected`). Or the number of each stretch, in the order of
        `structure.parts.stretches`.
    rule : str, Rule or any Layout
        Its weights of clamped ends are those of every end of a stretch that bears a moment.
    corrected : bool
        False is a chain that knows nothing of points inside a beam and of corners: where stretches meet,
        hinges have the weight 1 as everywhere inside, a half from either side. It shows what correction is
        worth. Only at a hinge that carries nothing, with equally long segments on both sides, is it better.

    Attributes
    ----------
    segments : tuple of int
        Of each stretch.
    chains : tuple of Chain
        Of each stretch, by itself: its pieces are those of the structure, its hinges those between them.
    bodies : tuple of tuple of int
        Of each stretch, the rigid body that each of its pieces belongs to: outer pieces are parts of the body
        of a joint where that can bend the stretch, 0 is the ground, and -1 a piece of no length in a hinge.
    joints : tuple of (int or None)
        The body of each node; None where nothing is fixed to it rigidly.
    hinges : tuple of Hinge
        All of them, those of rotational supports included.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, N is less than the number of stretches, or the rule gives no
        positive springs.

    Examples
    --------
    >>> import beammodes as bm
    >>> crack = bm.Station(0.5, hinge=2.0)
    >>> beam = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [crack])
    >>> chain = bm.StructureChain(beam, segments=6, rule="gregory")
    >>> [f"{hinge.name}: {hinge.stiffness:.4g}" for hinge in chain.hinges]       # 1/(1/2 + 3/4 1/6) = 1.6
    ['left: 16', 'left-right at 0.166667: 5.333', 'left-right at 0.333333: 5.333', 'left-right at 0.5: 1.6',
     'left-right at 0.666667: 5.143', 'left-right at 0.833333: 6.261']
    """

    structure: Structure
    segments: tuple[int, ...]
    rule: Layout
    chains: tuple[Chain, ...]
    bodies: tuple[tuple[int, ...], ...]
    joints: tuple[int | None, ...]
    hinges: tuple[Hinge, ...]

    def __init__(
        self,
        structure: Structure,
        segments: int | Sequence[int],
        rule: AnyRule = "gregory",
        *,
        corrected: bool = True,
    ) -> None:
        parts, record = checked_structure(structure).parts, layout_of(rule)
        counts = shared_segments(parts, segments, record)
        bends = moments_at_ends(parts)
        layouts = [record] * len(counts)
        if not flag("corrected", corrected):
            if not isinstance(record, Rule) or record.stub == 1:
                raise ValueError(
                    "rule must be a Rule with hinges at joints or half a segment from them where corrected "
                    f"is False, got {record.name}"
                )
            layouts = [_PlainInside(record, inner) for inner in _inner_ends(parts, bends)]
        chains = tuple(
            Chain(stretch.beam, (ENDS[words[0]], ENDS[words[1]]), count, layout)
            for stretch, words, count, layout in zip(parts.stretches, bends, counts, layouts, strict=True)
        )
        joining = _Joining.of(parts, bends, chains)
        values = (structure, counts, record, chains, *joining.joined())
        for each, value in zip(fields(self), values, strict=True):
            object.__setattr__(self, each.name, value)

    @property
    def parts(self) -> Parts:
        """Nodes and stretches of the structure."""
        return self.structure.parts

    @property
    def joint_stiffness(self) -> Floats:
        """Of the springs at `hinges`, in their order [N m/rad]."""
        return np.array([hinge.stiffness for hinge in self.hinges])

    @property
    def body_count(self) -> int:
        """How many rigid bodies there are, the ground among them."""
        used = {body for of in self.bodies for body in of} | {body for body in self.joints if body}
        used |= {body for hinge in self.hinges for body in hinge.bodies}
        return max(used, default=0) + 1

    def _line(self) -> str:
        return (
            f"<StructureChain of {self.structure!r}: {', '.join(map(str, self.segments))} segments, "
            f"rule={self.rule.name!r}>"
        )


def shared_segments(parts: Parts, segments: int | Sequence[int], rule: Layout) -> tuple[int, ...]:
    """Return how many segments each stretch gets, as `StructureChain` says.

    Examples
    --------
    >>> import beammodes as bm
    >>> overhang = bm.Structure.of_beam(bm.Beam(7.5, 1, 1), "pinned-free", [bm.Station(6.2, math.inf)])
    >>> shared_segments(overhang.parts, 10, bm.RULES["gregory"])
    (8, 2)
    """
    lengths, fits = [stretch.beam.length for stretch in parts.stretches], fits_of(rule) or (lambda _: True)
    if isinstance(segments, Sequence | np.ndarray) and not is_text(segments):
        listed = bounded("segments", segments)
        if len(listed) != len(lengths):
            raise ValueError(
                f"segments must be one number, or {len(lengths)}, one for each stretch, got {shown(segments)}"
            )
        return tuple(whole_number("segments", n, most=MAX_PIECES) for n in listed)
    total = whole_number("segments", segments, most=MAX_PIECES)
    least = len(lengths) * next(n for n in range(1, 1000) if fits(n))
    if total < least:
        raise ValueError(
            f"segments must be at least {least}, for {len(lengths)} stretches and rule {rule.name}, "
            f"got {total}"
        )

    words = moments_at_ends(parts)
    fewest = {pair: next(n for n in range(_fewest(rule, pair), 1000) if fits(n)) for pair in set(words)}
    wanted = [fewest[pair] for pair in words]
    bound = wanted if sum(wanted) <= total else [1] * len(lengths)

    def counts(h: float) -> list[int]:
        found = []
        for length, at_least in zip(lengths, bound, strict=True):
            n = max(at_least, math.ceil(length / h * (1.0 - 1e-9)))
            while not fits(n):
                n += 1
            found.append(n)
        return found

    low, high = sum(lengths) / total * 0.5, max(lengths)
    # The sum only falls where h is a length over a whole number; half-way it is the same for both sides.
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if sum(counts(middle)) <= total else (middle, high)
    return tuple(counts(high))


def _fewest(rule: Layout, words: tuple[str, str]) -> int:
    """Return how many segments a rule's weights take to be right on a stretch with such ends; 1 if none are.

    Right is Σ w M² = ∫ M² of a moment that is constant, or falls to nothing at an end that bears none.
    """
    if "clamped" not in words:
        return 1
    pair, both = Boundary(ENDS[words[0]], ENDS[words[1]]), words[0] != "free" != words[1]
    for n in range(1, _FEW):
        try:
            weights, lengths = rule.hinge_weights(pair, n), rule.piece_lengths(pair, n)
        except ValueError:
            continue
        places = [sum(lengths[: j + 1]) for j in range(len(weights))]
        arms = [1 if both else x if words[0] == "free" else n - x for x in places]
        found = float(sum(w * arm * arm for w, arm in zip(weights, arms, strict=True)))
        if abs(found - (n if both else n**3 / 3)) < 1e-9:
            return n
    return 1


def moments_at_ends(parts: Parts) -> list[tuple[str, str]]:
    """Return for each stretch what its two ends feel, as the word of the rule's weights there.

    "clamped" where there can be a bending moment, "guided" where the rotation is held and nothing else,
    "free" where there is none.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> moments_at_ends(Structure.of_beam(Beam.unit(), "clamped-pinned").parts)
    [('clamped', 'free')]
    """
    ends = [pair for stretch in parts.stretches for pair in zip(stretch.nodes, stretch.hinges, strict=True)]
    bearing = [sum(1 for at, hinge in ends if at == i and hinge) for i in range(len(parts.nodes))]
    alone = [sum(1 for at, _ in ends if at == i) == 1 for i in range(len(parts.nodes))]
    words = []
    for stretch in parts.stretches:
        pair = []
        for i, hinge in zip(stretch.nodes, stretch.hinges, strict=True):
            node = parts.nodes[i]
            turned = node.rotational_stiffness or node.has_turning_body or bearing[i] > 1
            if not hinge or not turned:
                pair.append("free")
            elif alone[i] and hinge == math.inf and _is_guided(node, stretch.normal):
                pair.append("guided")
            else:
                pair.append("clamped")
        words.append((pair[0], pair[1]))
    return words


def _inner_ends(parts: Parts, bends: list[tuple[str, str]]) -> list[tuple[bool, bool]]:
    """Return for each stretch which of its ends bear a moment and meet another stretch."""
    ends = [i for stretch in parts.stretches for i in stretch.nodes]
    return [
        (
            pair[0] != "free" and ends.count(stretch.nodes[0]) > 1,
            pair[1] != "free" and ends.count(stretch.nodes[1]) > 1,
        )
        for stretch, pair in zip(parts.stretches, bends, strict=True)
    ]


@dataclass(frozen=True)
class _PlainInside:
    """A rule that is not applied where a stretch meets another one."""

    rule: Rule
    plain: tuple[bool, bool]

    @property
    def name(self) -> str:
        return self.rule.name

    @property
    def rotary_inertia(self) -> Fraction:
        return self.rule.rotary_inertia

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        return self.rule.piece_lengths(boundary, segments)

    def hinge_weights(self, boundary: Boundary, segments: int) -> list[Fraction]:
        weights = self.rule.hinge_weights(boundary, segments)
        bare = self.rule.repeated(self.piece_lengths(boundary, segments)[0], len(weights))
        inward = (range(len(weights)), range(len(weights) - 1, -1, -1))
        for end, plain, hinges in zip((boundary.left, boundary.right), self.plain, inward, strict=True):
            if not plain:
                continue
            # What the rule has added from this end is taken away; a hinge at the node has half its weight.
            for j, weight in zip(hinges, self.rule.end_weights(end), strict=False):
                weights[j] -= weight.at(Fraction(segments)) - bare[j]
            if not self.rule.stub:
                weights[hinges[0]] -= bare[hinges[0]] / 2
        return weights


def _is_guided(node: Node, normal: tuple[float, float]) -> bool:
    """Return whether a node holds its rotation and feels no force along the normal of its only stretch."""
    across = [abs(unit[0] * normal[0] + unit[1] * normal[1]) for unit, _ in node.supports]
    return node.rotational_stiffness == math.inf and not node.mass and max(across, default=0.0) < 1e-12


@dataclass
class _Joining:
    """Bodies and hinges while they are put together."""

    bodies: list[list[int]]
    joints: list[int | None]
    hinges: list[Hinge]
    heavy: set[int]
    count: int

    @classmethod
    def of(cls, parts: Parts, bends: list[tuple[str, str]], chains: tuple[Chain, ...]) -> _Joining:
        joining = cls([], [], [], set(), 1)
        bearing = {
            i
            for stretch, pair in zip(parts.stretches, bends, strict=True)
            for i, word in zip(stretch.nodes, pair, strict=True)
            if word != "free"
        }
        for i, node in enumerate(parts.nodes):
            joining._add_node(node, i in bearing)
        for stretch, pair, chain in zip(parts.stretches, bends, chains, strict=True):
            of = [joining._new() for _ in range(chain.pieces)]
            for outer, i, word, hinge in zip((0, -1), stretch.nodes, pair, stretch.hinges, strict=True):
                body = joining.joints[i]
                if hinge == math.inf and body is not None and word != "free":
                    of[outer] = body
                elif 0.0 < hinge < math.inf and word != "free" and body is not None:
                    node = parts.nodes[i]
                    joining.hinges.append(Hinge(node.name, (body, of[outer]), 1.0 / hinge, node.place))
            joining.bodies.append(of)
            joining.heavy |= {body for body, length in zip(of, chain.length, strict=True) if length}
            along = chain.hinge_position.tolist()
            names = [f"{stretch.member} at {stretch.start + x:g}" for x in along]
            (x0, y0), (across, up) = parts.nodes[stretch.nodes[0]].place, stretch.axis
            places = [(x0 + x * across, y0 + x * up) for x in along]
            for outer, i in zip((0, -1), stretch.nodes, strict=True):
                if not chain.length[outer]:
                    names[outer], places[outer] = parts.nodes[i].name, parts.nodes[i].place
            for j, stiffness in enumerate(chain.joint_stiffness.tolist()):
                joining.hinges.append(Hinge(names[j], (of[j], of[j + 1]), 1.0 / stiffness, places[j]))
        return joining

    def _new(self) -> int:
        self.count += 1
        return self.count - 1

    def _add_node(self, node: Node, bearing: bool) -> None:
        if node.rotational_stiffness == math.inf:
            self.joints.append(GROUND)
        elif bearing or node.has_turning_body:
            self.joints.append(self._new())
            if node.has_turning_body:
                self.heavy.add(self.count - 1)
            if node.rotational_stiffness:
                pair = (GROUND, self.count - 1)
                self.hinges.append(Hinge(node.name, pair, 1.0 / node.rotational_stiffness, node.place))
        else:
            self.joints.append(None)

    def joined(self) -> tuple[tuple[tuple[int, ...], ...], tuple[int | None, ...], tuple[Hinge, ...]]:
        """Return bodies, joints and hinges, those about a body without inertia in series."""
        light = [body for body in range(1, self.count) if body not in self.heavy]
        gone = set()
        for body in light:
            about = [i for i, hinge in enumerate(self.hinges) if body in hinge.bodies]
            if len(about) > 2:
                continue
            if len(about) == 2:
                one, other = (self.hinges[i] for i in about)
                pair = sorted(b for hinge in (one, other) for b in hinge.bodies if b != body)
                together = one.flexibility + other.flexibility
                self.hinges[about.pop(0)] = Hinge(one.name, (pair[0], pair[1]), together, one.place)
            for i in about:
                del self.hinges[i]
            gone.add(body)
        kept = {body: i for i, body in enumerate(b for b in range(self.count) if b not in gone)}
        bodies = tuple(tuple(kept.get(body, -1) for body in of) for of in self.bodies)
        joints = tuple(None if body is None else kept.get(body) for body in self.joints)
        hinges = tuple(
            hinge._replace(bodies=(kept[hinge.bodies[0]], kept[hinge.bodies[1]])) for hinge in self.hinges
        )
        return bodies, joints, hinges
