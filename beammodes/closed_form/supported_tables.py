"""Uniform chains with any ends as rows of numbers, and their determinants at a frequency.

A long chain is two blocks of pieces, which hold all that the ends and the rule's corrections change, and a
row of equal rods between them, cut in the middle of hinges. A short one is carried piece by piece. Units are
a segment's length and mass and EI/ell. A table has a row for each number and a column for each chain;
`sample` and `sizes` take the rows, of arrays of any kind of floats or of single floats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Rule
from beammodes.closed_form.end_planes import EndNumbers, Plane, over_hinge, over_rod, plane_at_end
from beammodes.closed_form.rod_row import joined, row
from beammodes.numerics.arrays import OF_ARRAYS, Elementary, Floats
from beammodes.problem.end_columns import BoundaryColumns, EndColumns
from beammodes.problem.ends import Boundary, End, check_no_hub

__all__ = ["ChainColumns", "EndWeights", "OneChain", "end_weights", "one_chain", "sample", "sizes"]

# Rows of a table: those of all chains, with both ends; then a long chain's own and its hinges, or of a short
# one length, inertia and next hinge of each piece.
_END = len(EndNumbers._fields)
_SEGMENTS, _TENSION, _LEFT, _RIGHT, _COMMON = 0, 1, 2, 2 + _END, 2 + 2 * _END
_RODS, _P, _INERTIA, _STUB, _STUB_INERTIA = range(_COMMON, _COMMON + 5)
_HINGES = _COMMON + 5

# Kinds of ends, as `End.statics` tells them; pinned and free ends alike have neither hinge nor weights.
_KINDS = ("free", "carried", "guided", "clamped")
_KIND = {"pinned": 0, **{kind: place for place, kind in enumerate(_KINDS)}}


class EndWeights:
    """Flexibility weights of the first hinges from an end, by rule and kind of end.

    An end that bends nothing, or bears its body on a segment, has a hinge without flexibility where others
    have their own; `bare` tells. `depth` counts hinges up to the first that is as without an end.
    """

    def __init__(self, rules: Sequence[Rule]) -> None:
        lists = [[() if kind == "free" else getattr(rule, kind) for kind in _KINDS] for rule in rules]
        self.rules = tuple(rules)
        self.stub = np.array([float(rule.stub) for rule in rules])
        self.bare = np.array([[rule.stub == 0 and kind < 2 for kind in range(len(_KINDS))] for rule in rules])
        self.depth = np.array([[len(weights) for weights in each] for each in lists]) + self.bare + 1
        self.depth = np.maximum(self.depth, 2)
        self.most = int(self.depth.max())
        constant = np.ones((*self.depth.shape, self.most), dtype=object)
        slip = np.zeros_like(constant)
        for r, each in enumerate(lists):
            for k, weights in enumerate(each):
                first = int(self.bare[r, k])
                constant[r, k, :first] = 0
                constant[r, k, first : first + len(weights)] = [weight.constant for weight in weights]
                slip[r, k, first : first + len(weights)] = [weight.per_segment for weight in weights]
        inertia = np.array([rule.rotary_inertia for rule in rules], dtype=object)
        self._exact = constant, slip, inertia
        self._converted: dict[type, list[NDArray[Any]]] = {}

    def converted(self, kind: type) -> list[NDArray[Any]]:
        """Return constants and slips, shape (rules, kinds, hinges), and inertias of rods, as floats."""
        if kind not in self._converted:
            self._converted[kind] = [_floats(values, kind) for values in self._exact]
        return self._converted[kind]


def _floats(values: NDArray[Any], kind: type) -> NDArray[Any]:
    exact = [kind(value.numerator) / kind(value.denominator) for value in values.ravel().tolist()]
    return np.array(exact, dtype=kind).reshape(values.shape)


@lru_cache(maxsize=64)
def end_weights(rules: tuple[Rule, ...]) -> EndWeights:
    """Return the weights of some rules, kept for the next call.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> end_weights((RULES["gregory"],)).depth[0].tolist()           # of free, carried, guided, clamped ends
    [2, 2, 2, 4]
    """
    return EndWeights(rules)


@dataclass(frozen=True, slots=True, eq=False)
class ChainColumns:
    """Uniform chains: ends, N, index of a rule, axial force T L²/EI and section's inertia ρI/(ρA L²)."""

    ends: BoundaryColumns
    segments: Floats
    rule: NDArray[np.intp]
    tension: Floats
    section: Floats
    weights: EndWeights

    @classmethod
    def single(
        cls, pair: Boundary, segments: int, rule: Rule, tension: float, section: float
    ) -> ChainColumns:
        """Return one chain."""
        size, force, inertia = (np.array([float(number)]) for number in (segments, tension, section))
        ends, weights = BoundaryColumns.of(pair), end_weights((rule,))
        return cls(ends, size, np.zeros(1, dtype=np.intp), force, inertia, weights)

    def one(self, index: int) -> tuple[Boundary, int, Rule, float, float]:
        """Return what `single` takes, of one of the chains."""
        rule = self.weights.rules[self.rule[index]]
        numbers = float(self.tension[index]), float(self.section[index])
        return self.ends.boundary(index), int(self.segments[index]), rule, *numbers

    def take(self, index: Any) -> ChainColumns:
        """Return the chains that an index or a mask picks."""
        return ChainColumns(
            self.ends.take(index),
            self.segments[index],
            self.rule[index],
            self.tension[index],
            self.section[index],
            self.weights,
        )

    @property
    def kinds(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Indices into the kinds of ends, by the rules of `End.statics`."""
        return _kinds(self.ends.left), _kinds(self.ends.right)

    @property
    def depth(self) -> NDArray[np.intp]:
        """Hinges in a block of a long chain; more than fit a short one."""
        left, right = self.kinds
        depth = self.weights.depth
        return np.asarray(np.maximum(depth[self.rule, left], depth[self.rule, right]))

    @property
    def hinges(self) -> Floats:
        """How many there are, with those of no flexibility at bare ends."""
        return self.segments + 1.0 - np.rint(2.0 * self.weights.stub[self.rule])

    @property
    def rigid_modes(self) -> NDArray[np.intp]:
        """Modes of zero frequency; an axial force lets a rotation store energy."""
        left, right = self.ends.left, self.ends.right
        held = 1 * (left.translational_stiffness > 0) + (right.translational_stiffness > 0)
        turned = (left.rotational_stiffness > 0) | (right.rotational_stiffness > 0)
        return np.asarray(np.where(self.tension != 0.0, held == 0, 2 - np.minimum(2, held + turned)))

    @property
    def modes(self) -> Floats:
        """All modes of finite frequency, rigid ones too."""
        stub, (first, second) = np.rint(2.0 * self.weights.stub[self.rule]), self.kinds
        held = np.zeros_like(self.segments)
        turning, free = np.zeros_like(held), self.segments + 1.0 + (stub == 1.0)
        for end, kind in ((self.ends.left, first), (self.ends.right, second)):
            held += np.isinf(end.translational_stiffness)
            turning += np.isinf(end.rotational_stiffness)
            # A body behind a hinge of its own turns by itself.
            turns = (kind == 3) & ~np.isinf(end.rotational_stiffness)
            free += (stub == 0.0) & turns & ((end.rotary_inertia > 0) | (end.offset != 0))
        turning *= stub > 0.0
        # One rod has one angle to hold.
        turning = np.where((stub == 2.0) & (self.segments == 1.0), np.minimum(turning, 1.0), turning)
        return np.asarray(np.maximum(free - held - turning, 0.0))

    def long_table(self, depth: int, kind: type = np.float64) -> NDArray[Any]:
        """Return the table of long chains with blocks of `depth` hinges."""
        size: Any = self.segments.astype(kind)
        stub = self.weights.stub[self.rule]
        constant, slip, inertias = self.weights.converted(kind)
        rows = self._common(size) + _rods(size, stub, inertias[self.rule], self.section, depth)
        for end in self.kinds:
            rows += [constant[self.rule, end, j] + slip[self.rule, end, j] / size for j in range(depth)]
            rows[-1] = rows[-1] - 0.5
        return np.array(rows, dtype=kind)

    def short_table(self, kind: type = np.float64) -> NDArray[Any]:
        """Return the table of short chains, pieces of no length at the ends of shorter ones."""
        size: Any = self.segments.astype(kind)
        stub = self.weights.stub[self.rule]
        constant, slip, inertias = self.weights.converted(kind)
        own, section = inertias[self.rule], self.section * size * size
        count = self.hinges.astype(int)
        pieces, most = np.arange(int(count.max()) + 1)[:, None], min(self.weights.most, int(count.max()))
        # Pieces and hinges in turn, the last hinge being no hinge.
        length = np.where((pieces == 0) | (pieces == count), stub, 1.0) * (pieces <= count)
        flexibility = 1.0 * np.broadcast_to(pieces < count, length.shape).astype(kind)
        at, bare = np.arange(len(size)), [self.weights.bare[self.rule, end] for end in self.kinds]
        for side, end in enumerate(self.kinds):
            for j in range(most):
                change = constant[self.rule, end, j] + slip[self.rule, end, j] / size - 1.0
                place = count - 1 - j if side else np.full_like(count, j)
                # An end's weights reach the other end's own hinge if it has one.
                inside = np.where(side, place >= bare[0], place < count - bare[1])
                flexibility[place[inside], at[inside]] += change[inside]
        rows = self._common(size)
        for each, flexible in zip(length, flexibility, strict=True):
            rows += [each, (own * each * each + section) * each, flexible]
        return np.array(rows, dtype=kind)

    def _common(self, size: Any) -> list[Any]:
        rows = [size, self.tension / (size * size)]
        for end in (self.ends.left, self.ends.right):
            for stiffness, unit in ((end.translational_stiffness, size**3), (end.rotational_stiffness, size)):
                holds = np.isinf(stiffness)
                rows += [np.where(holds, 1.0, stiffness / unit), np.where(holds, 0.0, 1.0)]
            rows += [end.mass * size, end.rotary_inertia * size**3, end.offset * size]
        return rows

    def have_springs(self) -> NDArray[np.bool_]:
        """Return which chains' springs are all positive."""
        constant, slip, _ = self.weights.converted(np.float64)
        found, short = np.ones(len(self.segments), dtype=bool), self.segments < 2 * self.weights.most + 2
        for end in self.kinds:
            for j in range(self.weights.most):
                weight = constant[self.rule, end, j] + slip[self.rule, end, j] / self.segments
                found &= (weight > 0.0) | ((j == 0) & self.weights.bare[self.rule, end])
        if short.any():
            chains = self.take(short)
            bare = [self.weights.bare[chains.rule, end] for end in chains.kinds]
            flexible, count = chains.short_table()[_COMMON + 2 :: 3], chains.hinges.astype(int)
            pieces = np.arange(len(flexible))[:, None]
            ends = ((pieces == 0) & bare[0]) | ((pieces == count - 1) & bare[1]) | (pieces >= count)
            found[short] = ((flexible > 1e-15) | ends).all(axis=0)
        return found


def _kinds(end: EndColumns) -> NDArray[np.intp]:
    held = np.isinf(end.rotational_stiffness)
    turned = (end.rotational_stiffness > 0) | (end.rotary_inertia > 0) | (end.offset != 0)
    shearless = held & (end.translational_stiffness == 0) & (end.mass == 0)
    return np.where(turned, np.where(end.on_segment, 1, np.where(shearless, 2, 3)), 0)


def _rods(size: Any, stub: Any, own: Any, section: Any, depth: int) -> list[Any]:
    """Return rows of a long chain: rods, p, a rod's inertia, the outermost rods' length and inertia."""
    more = section * size * size
    inertia = own + more
    return [
        size + (2.0 - 2 * depth) - 2.0 * stub,
        1.0 - 4.0 * inertia,
        inertia,
        stub,
        (own * stub * stub + more) * stub,
    ]


class OneChain(NamedTuple):
    """A chain's rows of single floats, its rigid modes, and whether these are the rows of a long chain."""

    rows: list[float]
    rigid: int
    long: bool


def one_chain(
    pair: Boundary, segments: int, mode: int, rule: Rule, tension: float, section: float
) -> OneChain | None:
    """Return one chain as single floats, a long one without the cost of arrays; None if it has no such mode.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> chain = one_chain(Boundary.of("clamped-free(mass=1)"), 100, 1, RULES["mitiguy"], 0.0, 0.0)
    >>> chain.rigid, chain.rows[0], len(chain.rows)
    (0, 100.0, 25)
    """
    weights, size = end_weights((rule,)), float(segments)
    constant, slip, inertia = weights.converted(np.float64)
    ends = (pair.left, pair.right)
    kinds = [_KIND[end.statics] for end in ends]
    depth = max(int(weights.depth[0, kind]) for kind in kinds)
    rods = _rods(size, float(rule.stub), float(inertia[0]), section, depth)
    long = rods[0] >= 2.0
    if not long or mode > segments - 4:
        chains = ChainColumns.single(pair, segments, rule, tension, section)
        if mode > chains.modes[0] - chains.rigid_modes[0] or not chains.have_springs()[0]:
            return None
        if not long:
            return OneChain(chains.short_table()[:, 0].tolist(), int(chains.rigid_modes[0]), long)
    rows = [size, tension / (size * size)]
    for end in ends:
        rows += _in_segments(end, size)
    rows += rods
    for kind in kinds:
        hinges = [
            c + s / size for c, s in zip(constant[0, kind].tolist(), slip[0, kind].tolist(), strict=True)
        ]
        if min(hinges[int(weights.bare[0, kind]) :]) <= 0.0:
            return None
        rows += hinges[:depth]
        rows[-1] -= 0.5
    rigid = pair.rigid_body_modes
    if tension:
        rigid = int(not any(end.translational_stiffness for end in ends))
    return OneChain(rows, rigid, long)


def _in_segments(end: End, size: float) -> list[float]:
    check_no_hub(end)
    rows = []
    for stiffness, unit in ((end.translational_stiffness, size**3), (end.rotational_stiffness, size)):
        rows += [1.0, 0.0] if stiffness == math.inf else [float(stiffness) / unit, 1.0]
    mass, inertia, offset = end.moving_body
    return [*rows, float(mass) * size, float(inertia) * size**3, float(offset) * size]


def sample(rows: Any, place: Any, *, long: bool, of: Elementary = OF_ARRAYS) -> tuple[Any, Any]:
    """Return a chain's determinant, scaled, and how many modes lie below ω = `place`² (L = EI = ρA = 1).

    Its sign changes at every mode and nowhere else.
    """
    scale = place / rows[_SEGMENTS]
    square = (scale * scale) * (scale * scale)
    value, below, size = _long(rows, square, scale, of) if long else _short(rows, square, scale)
    return value / size, below


def sizes(rows: Any, place: Any, *, long: bool, of: Elementary = OF_ARRAYS) -> Any:
    """Return the sum of the absolute values of all terms of `sample`'s determinant.

    Springs add to what bodies take away: all terms have one sign at -w.
    """
    scale = place / rows[_SEGMENTS]
    square = (scale * scale) * (scale * scale)
    every = list(rows)
    every[_TENSION] = abs(rows[_TENSION])
    for offset in (_LEFT + _END - 1, _RIGHT + _END - 1):
        every[offset] = abs(rows[offset])
    if not long:
        plane, _ = _carried(every, _LEFT, _pieces(every), -square)
        value = _closed(plane, plane_at_end(EndNumbers(*every[_RIGHT:_COMMON]), -square))
        return value / _short(rows, square, scale)[2]
    left, right = (Plane(*map(abs, plane)) for plane, _ in _blocks(every, -square))
    between = row(square, rows[_P], rows[_TENSION], rows[_RODS], of, sizes=True)
    (first, _), (second, _) = _blocks(rows, square)
    return joined(left, right, between, 1.0)[0] / (_size(first, scale) * _size(second, scale))


def _size(plane: Plane, scale: Any) -> Any:
    d, yy, yt, tt, det = plane
    return abs(det) + scale * (abs(yy) + scale * (abs(yt) + scale * (abs(tt) + scale * abs(d))))


def _long(rows: Any, square: Any, scale: Any, of: Elementary) -> tuple[Any, Any, Any]:
    (left, first), (right, second) = _blocks(rows, square)
    between = row(square, rows[_P], rows[_TENSION], rows[_RODS], of)
    value, held, turned, alone = joined(left, right, between)
    # Minors over d d' σ σ' are those of the common stiffness at both cuts: their signs count its negatives.
    sign = (between.symmetric[0] < 0.0) ^ (between.antisymmetric[0] < 0.0) ^ (left.d < 0.0)
    both = sign ^ (right.d < 0.0)
    one, two, three, four = (
        (alone < 0.0) ^ sign,
        (held < 0.0) ^ sign,
        (turned < 0.0) ^ both,
        (value < 0.0) ^ both,
    )
    below = first + second + between.clamped + (1.0 * one + (one ^ two) + (two ^ three) + (three ^ four))
    return value, below, _size(left, scale) * _size(right, scale)


def _blocks(rows: Any, square: Any) -> list[tuple[Plane, Any]]:
    hinges = rows[_HINGES:]
    depth, one = len(hinges) // 2, 1.0
    found = []
    for end, first in ((_LEFT, 0), (_RIGHT, depth)):
        pieces = [(rows[_STUB], rows[_STUB_INERTIA], hinges[first])]
        pieces += [(one, rows[_INERTIA], flexibility) for flexibility in hinges[first + 1 : first + depth]]
        found.append(_carried(rows, end, pieces, square))
    return found


def _short(rows: Any, square: Any, scale: Any) -> tuple[Any, Any, Any]:
    plane, below = _carried(rows, _LEFT, _pieces(rows), square)
    end = EndNumbers(*rows[_RIGHT:_COMMON])
    last = plane_at_end(end, square)
    value = _closed(plane, last)
    # The sequence of d goes on with the right end's rotation let go, and then its deflection.
    held, free = plane.d < 0.0, end.give * end.turn > 0.0
    turned = (free & (plane.tt + plane.d * last.tt < 0.0)) | ((free ^ True) & held)
    below = below + (1.0 * (held ^ turned) + (turned ^ (value < 0.0)))
    return value, below, _size(plane, scale) * _size(last, scale)


def _pieces(rows: Any) -> list[tuple[Any, Any, Any]]:
    flat = rows[_COMMON:]
    return list(zip(flat[::3], flat[1::3], flat[2::3], strict=True))


def _closed(plane: Plane, last: Plane) -> Any:
    """Return the determinant of what two ends admit at one section; they count θ in opposite directions."""
    value = plane.det * last.d + plane.yy * last.tt + plane.tt * last.yy + plane.d * last.det
    return value + 2.0 * plane.yt * last.yt


def _carried(rows: Any, end: int, pieces: Sequence[tuple[Any, Any, Any]], square: Any) -> tuple[Plane, Any]:
    """Return what an end admits behind pieces and hinges, and the modes of these, held there, below w."""
    tension = rows[_TENSION]
    plane = plane_at_end(EndNumbers(*rows[end : end + _END]), square)
    negative, below = plane.d < 0.0, 0.0
    for length, inertia, flexibility in pieces:
        plane = over_rod(plane, length, square * length, square * inertia - tension * length)
        plane = over_hinge(plane, flexibility)
        now = plane.d < 0.0
        below = below + (now ^ negative)
        negative = now
    return plane, below
