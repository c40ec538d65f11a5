"""A serial chain in one plane: pieces on a line, springs between them, what holds the ends.

::

      near  |  piece 0 --spring-- piece 1 --spring-- ... --spring-- last piece  |  far
             s runs along the beam, from the chain's root to its tip

Where the ground itself carries the first hinge, piece 0 is what is rigid with the ground: of no length, or a
welded segment. A file says where hinges are, not where a beam begins and ends. The matter of an outer piece
tells its length: matter like its neighbour's, or a solid as long as its neighbour. Only where neither tells,
the length is taken that comes nearest to the beam's, and that is said. These lengths do not touch the
frequencies of a chain with a free or clamped end. The world's origin tells nothing.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from beammodes.auditing.body_tree import Group, Inertial, ModelJoint, ModelTie, SpringPlace
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.serial_chains import (
    NO_SPRING,
    OFF_LINE,
    HingeLine,
    HingePath,
    RootSupport,
    hinge_line,
    lone_segment,
    root_support,
)
from beammodes.numerics.arrays import Floats

__all__ = [
    "FarEnd",
    "Piece",
    "PlanarChain",
    "Spring",
    "behind_sprung_hub",
    "far_end",
    "held_piece",
    "hub_of",
    "planar_chain",
    "with_wall_hinges",
]

#: Relative difference up to which coefficients of a tendon are the same.
_SAME = 1e-6
#: Matter is that of a neighbour's kind up to this share of its length; solids and rods of files are rounded.
_ALIKE = 2e-3
#: A piece this much heavier or lighter than its neighbour is no longer or shorter one of its kind.
_LEAST, _MOST = 0.05, 2.5
#: An axis that is off by less than this is meant to be parallel [degrees].
_TURNED = 20.0
#: Engines that want some mass of every body get less than this share of the chain's.
_TRACE = 1e-9


@dataclass(frozen=True)
class Piece:
    """Length [m], mass [kg], centre of mass from the near tip [m] and inertia about that [kg m²]."""

    length: float
    mass: float
    centre: float
    inertia: float

    @property
    def mirrored(self) -> Piece:
        """The same piece seen from its far tip."""
        return replace(self, centre=self.length - self.centre)


@dataclass(frozen=True)
class Spring:
    """One hinge: name, stiffness [N m/rad], damping [N m s/rad], armature [kg m²], place of its stiffness."""

    name: str
    stiffness: float
    damping: float = 0.0
    armature: float = 0.0
    place: SpringPlace | None = None


@dataclass(frozen=True)
class PlanarChain:
    """Pieces from root to tip, the springs between them, and stiffnesses of the supports.

    `near` and `far` hold the outer pieces across and in turning, infinite where held; `near_hinge` is the
    hinge behind `near`, for its damping and armature. `assumed` says what was assumed in reading it so;
    `segment` is what segments are like, where no piece between two hinges shows one; `hub` [m] is how much of
    the first piece, which turns on the near hinge, is a hub and no beam. `bodies` [kg] are points at its ends
    that are no part of it, where that is known; else the outer pieces tell.
    """

    pieces: tuple[Piece, ...]
    springs: tuple[Spring, ...]
    near: tuple[float, float]
    far: tuple[float, float]
    near_hinge: Spring | None = None
    assumed: tuple[str, ...] = ()
    segment: Piece | None = None
    hub: float = 0.0
    bodies: tuple[float, float] | None = None


def held_piece(length: float, others: Sequence[Piece] = ()) -> Piece:
    """Return a piece that does not turn, as heavy for its length as others; the file says nothing of it."""
    rods = [piece.mass / piece.length for piece in others[:-1] or others if piece.length]
    mass = length * float(np.median(rods)) if rods else 0.0
    return Piece(length, mass, length / 2, mass * length**2 / 12)


def with_wall_hinges(chain: PlanarChain, far: Spring, length: float) -> PlanarChain:
    """Return a chain whose springs to the ground are hinges to pieces of their own, as wall springs are.

    A body of no length at an end keeps the spring as its support: the rule's own spring follows it. `far` is
    the far spring but for its stiffness; what the beam has of its length [m] beyond that hinge is a piece
    that the ground holds.
    """
    pieces = [_without_traces(piece, chain.pieces) for piece in chain.pieces]
    springs, near, far_support, assumed = list(chain.springs), chain.near, chain.far, chain.assumed
    turning = chain.near_hinge
    if near[1] == math.inf and len(pieces) > 2 and pieces[0].length == pieces[1].length == 0:
        turning = springs[0]
        near = (near[0], turning.stiffness)
        del pieces[0], springs[0]
    if 0 < near[1] < math.inf and pieces[0].length and not chain.hub:
        pieces.insert(0, held_piece(0.0))
        springs.insert(0, replace(turning or Spring("near end", 0.0), stiffness=near[1]))
        near = (chain.near[0], math.inf)
    elif turning and near[1] < math.inf:
        # The armature of a hinge on which all turns is inertia of the first piece's own rotation.
        pieces[0] = replace(pieces[0], inertia=pieces[0].inertia + turning.armature)
        if turning.damping:
            why = f"the damping of {turning.name}, on which the chain turns as a whole, is left out"
            assumed = (*assumed, why)
    if 0 < far_support[1] < math.inf and pieces[-1].length:
        missing = length + chain.hub - sum(piece.length for piece in pieces)
        typical = max(piece.length for piece in pieces)
        pieces.append(held_piece(missing if 1e-9 * length < missing < 1.05 * typical else 0.0, pieces))
        springs.append(replace(far, stiffness=far_support[1]))
        far_support = (far_support[0], math.inf)
    own = (tuple(pieces), tuple(springs))
    return PlanarChain(*own, near, far_support, chain.near_hinge, assumed, chain.segment, chain.hub)


def _without_traces(piece: Piece, others: Sequence[Piece]) -> Piece:
    """Return a piece of no length without the mass and inertia that it has for an engine's sake only."""
    if piece.length:
        return piece
    total = sum(other.mass for other in others)
    size = sum(other.length for other in others)
    mass = piece.mass if piece.mass > _TRACE * total else 0.0
    inertia = piece.inertia if piece.inertia > _TRACE * total * size**2 else 0.0
    return Piece(0.0, mass, piece.centre if mass else 0.0, inertia)


# Fixed tendons at the tip: sums of joint coordinates that are its deflection or rotation.


@dataclass(frozen=True)
class FarEnd:
    """Stiffnesses under the tip, its place if a tie says it, and the spring that resists turning."""

    across: float = 0.0
    turning: float = 0.0
    place: float | None = None
    spring: Spring = field(default_factory=lambda: Spring("", 0.0))


def far_end(ties: Sequence[ModelTie], line: HingeLine, support: RootSupport | None) -> FarEnd:
    """Return what the ties on a chain's joints, and on those of its support, do at its tip.

    A tie is the tip's rotation if all hinges count alike, and its deflection if each counts by its distance
    from one point beyond them, as `export_chain` writes both; any other is refused.
    """
    hinge, slide = (support.hinge, support.slide) if support else (None, None)
    found = FarEnd()
    for tie in ties:
        coefficients = dict(tie.terms)
        joints = [*([hinge] if hinge else []), *line.hinges]
        names = {joint.name for joint in (*joints, *([slide] if slide else []))}
        if not (tie.stiffness or tie.refusal) or not coefficients.keys() & names:
            continue
        if tie.refusal:
            raise BadModel(tie.refusal)
        # Joints may turn or shift the other way.
        turns = [
            (line.place(j.position), math.copysign(1.0, j.axis @ line.axis) * coefficients.pop(j.name, 0.0))
            for j in joints
        ]
        shift = None
        if slide:
            shift = math.copysign(1.0, slide.axis @ line.across) * coefficients.pop(slide.name, 0.0)
        if any(coefficients.values()):
            raise BadModel(f"tendon {tie.name} must join hinges of the chain only")
        found = _with_tie(found, tie, turns, shift)
    return found


def _with_tie(end: FarEnd, tie: ModelTie, turns: list[tuple[float, float]], shift: float | None) -> FarEnd:
    def times(scale: float) -> float:
        return math.inf if tie.stiffness == math.inf else tie.stiffness * scale**2

    (first, lead), (last, rest) = turns[0], turns[-1]
    alike = not shift and all(abs(value - lead) <= _SAME * abs(lead) for _, value in turns)
    # Of one hinge alone a number cannot tell; 1 is its rotation, anything else a distance.
    several = len(turns) > 1 or shift is not None
    if alike and (several or (abs(lead) == 1 and tie.stiffness < math.inf)):
        # Of two such ties neither is the spring.
        at = replace(tie.place, scale=lead**2) if tie.place and not end.turning else None
        turning = end.turning + times(lead)
        return replace(end, turning=turning, spring=Spring(tie.name, turning, place=at))
    scale = shift or (1.0 if last == first else (lead - rest) / (last - first))
    place = first + lead / scale if scale else math.nan
    fits = all(abs(value - scale * (place - at)) <= _SAME * max(abs(lead), abs(scale)) for at, value in turns)
    if not (fits and math.isfinite(place) and place >= last * (1 - _SAME)):
        raise BadModel(f"tendon {tie.name} must be the deflection or the rotation of the chain's tip")
    return replace(end, across=end.across + times(scale), place=place)


# The pieces.


@dataclass(frozen=True)
class _Lengths:
    """Possible lengths of an outer piece [m], the likeliest first, and whether its matter tells."""

    values: tuple[float, ...]
    certain: bool = True


def planar_chain(path: HingePath, line: HingeLine, far: FarEnd, length: float, word: str = "") -> PlanarChain:
    """Return a chain's numbers in one plane; refuse one on which something else moves.

    `length` [m] is the beam's; `word` says why the body that carries the chain is held although it has
    joints, empty if it moves as they let it.
    """
    root = None if word else root_support(path, line)
    _check(path, line, root)
    reach = line.places[-1] - line.places[0]
    near, tip = _near_lengths(path, line, root), _far_lengths(path, line, far, reach, root)
    segment = _segment(path, line, 1, root)
    if segment and near.certain and abs(near.values[0] - 0.5 * segment.length) <= _ALIKE * segment.length:
        # Where half a segment begins the chain, half a segment may end it.
        tip = tip if tip.certain else replace(tip, values=(*tip.values, 0.5 * segment.length))
    if far.turning and root is not None:
        # Beyond the far hinge the beam may go on, so its length does not tell where it begins.
        near = _Lengths(near.values[:1])
    hub = _hub_radius(path, line, root, length - reach - tip.values[0])
    start, end = _nearest(near.values, tip.values, length + hub - reach)
    cuts = [line.places[0] - start, *line.places, line.places[-1] + end]
    spans = itertools.pairwise(cuts[1:])
    moving = [_piece(group, line, *span) for group, span in zip(path.groups, spans, strict=True)]
    if root is not None:
        first = _piece(path.root, line, cuts[0], cuts[1])
    else:
        # A single moving piece may carry a body, which is no measure of the beam.
        first = held_piece(start, [segment] if segment and len(moving) == 1 else moving)
    assumed = [word or (root.why if root else "")]
    assumed += [_assumed("begins", "before", line.hinges[0], near, start)]
    assumed += [_assumed("ends", "past", line.hinges[-1], tip, end)]
    if root and root.slide and root.slide.damping:
        assumed.append(f"the damping of joint {root.slide.name} is left out")
    support = root or RootSupport()
    chain = PlanarChain(
        (first, *moving),
        tuple(map(_spring, line.hinges)),
        (support.across, support.turning),
        (far.across, far.turning),
        _spring(support.hinge) if support.hinge else None,
        tuple(filter(None, assumed)),
        segment,
        hub,
    )
    return with_wall_hinges(chain, far.spring, length)


def _spring(hinge: ModelJoint) -> Spring:
    return Spring(hinge.name, hinge.stiffness, hinge.damping, hinge.armature, hinge.place)


def _assumed(does: str, where: str, hinge: ModelJoint, lengths: _Lengths, taken: float) -> str:
    others = [f"{value:.6g}" for value in lengths.values if abs(value - taken) > _ALIKE * abs(taken)]
    if lengths.certain or not others:
        return ""
    return (
        f"the beam {does} {taken:.6g} m {where} hinge {hinge.name}, which comes nearest to its length; the "
        f"file fits {' or '.join(dict.fromkeys(others))} m too"
    )


def _nearest(starts: Sequence[float], ends: Sequence[float], rest: float) -> tuple[float, float]:
    """Return the pair whose sum is nearest; of several, the one whose numbers stand first, the end's most."""
    pairs = itertools.product(enumerate(ends), enumerate(starts))
    off = [(round(abs(start + end - rest) / (abs(rest) or 1.0), 5), j, i) for (j, end), (i, start) in pairs]
    _, j, i = min(off)
    return starts[i], ends[j]


def _check(path: HingePath, line: HingeLine, support: RootSupport | None) -> None:
    for group, after in itertools.zip_longest(path.groups, path.groups[1:]):
        _check_refusals(group)
        for other in group.children:
            if other is not after:
                _check_refusals(other)
                if other.joints[0].kind == "ball":
                    raise BadModel(f"{other.joints[0].name} on body {group.name} {NO_SPRING}")
                turned = math.degrees(math.acos(min(abs(float(other.joints[0].axis @ line.axis)), 1.0)))
                by = f", got one {turned:.3g} degrees off" if 1e-4 < turned < _TURNED else ""
                raise BadModel(
                    f"{other.joints[0].name} on body {group.name} must be a hinge with a spring, parallel "
                    f"to {line.hinges[0].name}{by}: nothing else may move on the chain. "
                    f"{_what_to_do(other, by)}"
                )
    in_space = len(path.axes()) > 1 or path.in_space or (support is not None and support.in_space)
    for group in (*([path.root] if support else []), *path.groups):
        _check_matter(group, line, in_space)


def _what_to_do(other: Group, turned: str) -> str:
    """Return how a joint that moves something on the chain can be taken; `turned` if nearly parallel."""
    if turned:
        return f"If it is meant to be parallel, turn the axis of {other.joints[0].name}"
    if other.joints[0].is_sprung:
        name = other.bodies[-1].name
        return (
            f"It has a spring of its own: if what is beyond it is meant, name it by chain ('{name}'); if it "
            "is a body on the chain, weld it there (leave out its joint), so that it counts by its mass"
        )
    return (
        "If a motor holds it, say by boundary what the chain's ends are: a hinge without a spring between "
        "hinges with springs, or beyond them, is then held"
    )


def _check_refusals(group: Group) -> None:
    refusals = [body.refusal for body in group.bodies] + [joint.refusal for joint in group.joints]
    for why in filter(None, refusals):
        raise BadModel(why)


def _check_matter(group: Group, line: HingeLine, in_space: bool) -> None:
    own, spacing = group.inertial, line.spacing or abs(line.place(group.inertial.centre))
    if not own.mass:
        raise BadModel(f"body {group.name} must have a mass greater than 0")
    off = own.centre - line.origin - line.place(own.centre) * line.along
    distance = float(np.linalg.norm(off)) if in_space else line.off_line(own.centre)
    if distance > max(OFF_LINE * spacing, 1e-12):
        raise BadModel(
            f"body {group.name} must have its centre of mass on the line of the hinges, got it "
            f'{distance:.3g} m beside that line: a curved chain is judged by motion="space" beside the rod '
            "of its shape"
        )
    product = abs(float(line.axis @ own.inertia @ line.across))
    if in_space and product > OFF_LINE * float(np.trace(own.inertia)):
        raise BadModel(f"body {group.name} must have its principal axes along the hinges'")


def _piece(group: Group, line: HingeLine, start: float, end: float) -> Piece:
    own, inertia = group.inertial, line.moment(group.inertial)
    if inertia < 0:
        raise BadModel(f"body {group.name} must have an inertia of at least 0, got {inertia:.3g}")
    # A mass without rotary inertia, as files have it, gets a trace of it: its coordinate may have none else.
    trace = _TRACE * own.mass * (end - start) ** 2
    return Piece(end - start, own.mass, line.place(own.centre) - start, max(inertia, trace))


def _near_lengths(path: HingePath, line: HingeLine, root: RootSupport | None) -> _Lengths:
    """Return what the length of the first piece may be: up to the hinge that turns it, or as matter tells."""
    if root is not None and root.hinge is not None:
        return _Lengths((_pivot(root.hinge, line),))
    segment = _segment(path, line, -1, root)
    found = _by_matter(path.root, line, line.places[0], -1.0, segment, path)
    if found and segment:
        # Half a mass on the hinge is that of half a segment or of a whole one: solids tell.
        ahead = _ahead(path.root.extent, line, line.places[0], -1.0)
        drawn = any(abs(value - found[0]) <= _ALIKE * segment.length for value in ahead)
        ends = [] if drawn else _whole_or_half(ahead, segment)
        return _Lengths((ends[0] if ends else found[0],))
    slides = [j for j in path.root.joints if root is not None and j.kind == "slide"]
    for slide in slides:
        place = -line.place(slide.position)
        if place >= 0:
            # A slide has no place of its own: a carriage that is no segment may be none of the beam.
            heavy = segment is not None and path.root.inertial.mass > _MOST * segment.mass
            return _Lengths((0.0, place) if heavy else (place,), certain=not heavy)
    still = root is None or (root.across == root.turning == math.inf)
    if still and path.root.parent is not None:
        # A body of a mechanism that carries the chain, held in its plane, is no part of the beam.
        return _Lengths((0.0,))
    if root is None:
        return _welded_lengths(path.root, line, segment)
    return _by_solids(path.root, line, line.places[0], -1.0, segment)


def _hub_radius(path: HingePath, line: HingeLine, root: RootSupport | None, rest: float) -> float:
    """Return how much of the first piece is a hub and no beam [m]; 0 if it is made as segments are.

    `rest` [m] is what the beam's length leaves for the first piece.
    A hub has much more or less mass for its length than segments, or its matter elsewhere. A body or a solid
    of it that is made as a segment is a piece of the beam that is rigid with the hub.
    """
    segment = _segment(path, line, -1, None)
    if root is None or root.hinge is None or root.across < math.inf or segment is None:
        return 0.0
    length = _pivot(root.hinge, line)
    if length <= _ALIKE * segment.length:
        return 0.0
    found = hub_of(_piece(path.root, line, -length, 0.0), segment.mirrored, rest)
    beam = next(iter(_by_matter(path.root, line, 0.0, -1.0, segment, path)), 0.0)
    return min(found, length - beam) if beam < length * (1 - _ALIKE) else 0.0


def _is_rod(piece: Piece) -> bool:
    ratio = 12 * piece.inertia / (piece.mass * piece.length**2) if piece.mass else 0.0
    return 0.5 < ratio < 2 and abs(piece.centre / piece.length - 0.5) < 0.1


def behind_sprung_hub(path: HingePath, axis: Floats, length: float) -> HingePath | None:
    """Return a chain of the ground without its first hinge, if a spring holds a hub there and no segment.

    `length` [m] is the beam's.
    """
    if path.root.parent is not None or len(path.groups) < 3:
        return None
    line = hinge_line(path, axis)
    first, second = (
        _piece(group, line, *span)
        for group, span in zip(path.groups, itertools.pairwise(line.places[:3]), strict=False)
    )
    # A last segment is as long as the one before.
    rest = length - (2 * line.places[-1] - line.places[-2] - line.places[1])
    if not (first.length and second.length and second.mass and hub_of(first, second, rest)):
        return None
    return replace(path, root=path.groups[0], groups=path.groups[1:])


def hub_of(own: Piece, segment: Piece, rest: float) -> float:
    """Return how much of a first piece that turns on a hinge is a hub, by what segments are made of [m].

    A rod of another weight than segments may be either: it is beam if that comes nearer to `rest`, what the
    beam's length leaves for it [m].
    """
    length = own.length
    share = own.mass * segment.length / (length * segment.mass)
    inside = -_ALIKE * length <= own.centre <= length * (1 + _ALIKE)
    if 1 / _MOST <= share <= _MOST and inside and own.inertia <= own.mass * length**2 / 2:
        return 0.0
    beam = _of_kind(own.mass / segment.mass, length - own.centre, segment.mirrored) or 0.0
    if _is_rod(own) and abs(rest - length) < abs(rest - beam):
        return 0.0
    return length - beam if beam < length * (1 - _ALIKE) else 0.0


def _far_lengths(
    path: HingePath, line: HingeLine, far: FarEnd, reach: float, root: RootSupport | None
) -> _Lengths:
    """Return what the length of the last piece may be."""
    hinge, tip = line.places[-1], path.groups[-1]
    if far.place is not None:
        return _Lengths((far.place - hinge,))
    segment = _segment(path, line, 1, root)
    certain = None if segment is None else _certain_length(tip, line, hinge, 1.0, segment, path)
    if certain is not None:
        return _Lengths((certain,))
    found, ahead = _by_matter(tip, line, hinge, 1.0, segment, path), _ahead(tip.extent, line, hinge, 1.0)
    carries = segment is not None and _carries_body(tip, line, hinge, segment)
    if found and segment:
        # A longer link, or one with a light body near its tip: solids tell, else the length of the beam.
        either = [*found, *([segment.length] if carries else [])]
        drawn = [v for v in either if any(abs(v - a) <= _ALIKE * segment.length for a in ahead)]
        values = tuple(dict.fromkeys(drawn or either))
        return _Lengths(values, certain=len(values) == 1)
    if carries and segment and not ahead:
        # Equal links with a body, or the body alone.
        return _Lengths((segment.length, 0.0), certain=False)
    lengths = _by_solids(tip, line, hinge, 1.0, segment)
    positive = tuple(value for value in lengths.values if value > 0) if not reach else lengths.values
    return _Lengths(positive or (0.0,), lengths.certain)


def _segment(path: HingePath, line: HingeLine, way: float, root: RootSupport | None) -> Piece | None:
    """Return the piece that shows what segments are made of, seen from its hinge towards an end.

    It is the one between two hinges that is nearest to that end, else the first up to the hinge that turns
    it; of one hinge alone, the segment on it.
    """
    inner = _inner(path, line, way)
    found = None if inner is None else _piece(inner[0], line, *inner[1:])
    if found is None and root is not None and root.hinge is not None and path.root.inertial.mass:
        length = _pivot(root.hinge, line)
        found = _piece(path.root, line, -length, line.places[0]) if length > 0 else None
    if found is None:
        lone = lone_segment(path.groups[-1], line)
        if lone is None:
            return None
        length, own = lone
        found = Piece(length, own.mass, line.place(own.centre) - line.places[-1], max(line.moment(own), 0.0))
    return found if way > 0 else found.mirrored


def _inner(path: HingePath, line: HingeLine, way: float) -> tuple[Group, float, float] | None:
    """Return what is between two hinges and nearest to an end, and where it begins and ends."""
    pairs = list(zip(itertools.pairwise(line.places), path.groups, strict=False))
    for (start, end), group in pairs[::-1] if way > 0 else pairs:
        if end > start and group.inertial.mass:
            return group, start, end
    return None


def _has_twin(group: Group, line: HingeLine, hinge: float, way: float, path: HingePath) -> bool:
    """Return True if the rod of an outer piece is that of its neighbour, which has small links beside it."""
    inner = _inner(path, line, way)
    if inner is None or sum(body.inertial.mass > 0 for body in inner[0].bodies) < 2:
        return False
    beside, start, end = inner
    size = end - start
    rod = max(beside.bodies, key=lambda body: body.inertial.mass).inertial
    if beside.inertial.mass > 1.5 * rod.mass:
        # Links as heavy as the rod are segments themselves, on hinges about other axes.
        return False
    centre = line.place(rod.centre) - start if way > 0 else end - line.place(rod.centre)
    return any(
        abs(body.inertial.mass - rod.mass) <= _ALIKE * rod.mass
        and abs(way * (line.place(body.inertial.centre) - hinge) - centre) <= _ALIKE * size
        and abs(line.moment(body.inertial) - line.moment(rod)) <= _ALIKE * rod.mass * size**2
        for body in group.bodies
    )


def _certain_length(
    group: Group, line: HingeLine, hinge: float, way: float, segment: Piece, path: HingePath
) -> float | None:
    """Return the length of an outer piece that has a body made as its neighbour is, in all its matter."""
    if _has_twin(group, line, hinge, way, path):
        return segment.length
    wholes = (group.inertial, *(body.inertial for body in group.bodies))
    alike = (_length_alike(part, line, hinge, way, segment) for part in wholes)
    return next((length for length in alike if length is not None), None)


def _by_matter(
    group: Group, line: HingeLine, hinge: float, way: float, segment: Piece | None, path: HingePath
) -> list[float]:
    """Return lengths of an outer piece that is made as its neighbour is, alone or with a body on it."""
    if segment is None:
        return []
    certain = _certain_length(group, line, hinge, way, segment, path)
    if certain is not None:
        return [certain]
    solids = (solid.inertial for body in group.bodies for solid in body.solids)
    wholes = (group.inertial, *(body.inertial for body in group.bodies))
    lengths = (_length_of_kind(part, line, hinge, way, segment) for part in (*wholes, *solids))
    return [length for length in lengths if length is not None]


def _carries_body(group: Group, line: HingeLine, hinge: float, segment: Piece) -> bool:
    """Return True if a last piece can be a segment like its neighbour with a body on it, by its matter."""
    own = group.inertial
    mass = own.mass - segment.mass
    if mass <= _ALIKE * segment.mass:
        return False
    centre = line.place(own.centre) - hinge
    arm = (own.mass * centre - segment.mass * segment.centre) / mass
    swing = segment.mass * mass / own.mass * (arm - segment.centre) ** 2
    rest = line.moment(own) - segment.inertia - swing
    return rest >= -_ALIKE * segment.mass * segment.length**2


def _length_alike(part: Inertial, line: HingeLine, hinge: float, way: float, kind: Piece) -> float | None:
    """Return the length of a body whose inertia is that of its kind too, whatever solids it is made of."""
    length = _length_of_kind(part, line, hinge, way, kind)
    # What looks longer may as well be a segment with a body.
    if length is None or length > kind.length * (1 + _ALIKE):
        return None
    due = kind.inertia / kind.mass * (length / kind.length) ** 2
    return length if abs(line.moment(part) / part.mass - due) <= _ALIKE * length**2 else None


def _length_of_kind(part: Inertial, line: HingeLine, hinge: float, way: float, kind: Piece) -> float | None:
    # Other matter, or none, whose centre is nowhere.
    if line.off_line(part.centre) > _ALIKE * kind.length:
        return None
    return _of_kind(part.mass / kind.mass, way * (line.place(part.centre) - hinge), kind)


def _of_kind(share: float, centre: float, kind: Piece) -> float | None:
    slack = _ALIKE * kind.length
    if not _LEAST < share < _MOST:
        return None
    if abs(share - 1) > _ALIKE and abs(centre - kind.centre) <= slack:
        # Another mass at the same place, as lumped masses have at the last hinge or the tip.
        return kind.length
    if abs(centre - share * kind.centre) <= slack:
        return share * kind.length if abs(share - 1) > _ALIKE else kind.length
    return None


def _ahead(points: Sequence[np.ndarray], line: HingeLine, hinge: float, way: float) -> list[float]:
    """Return how far points are beyond a hinge, sorted."""
    reach = {round(way * (line.place(point) - hinge), 12) for point in points}
    return sorted(value for value in reach if value > 0)


def _whole_or_half(ahead: Sequence[float], segment: Piece) -> list[float]:
    """Return the whole and the half of a segment where a solid ends there."""
    lengths = (segment.length, 0.5 * segment.length)
    return [part for part in lengths if any(abs(v - part) <= _ALIKE * segment.length for v in ahead)]


def _welded_lengths(group: Group, line: HingeLine, segment: Piece | None) -> _Lengths:
    """Return lengths of what is rigid with the ground by how far its solids reach."""
    # A welded body that has mass, and another than a segment's, is what the beam is fixed to.
    points = [point for body in group.bodies if not body.inertial.mass for point in body.extent]
    if segment is None:
        return _Lengths((0.0,))
    ahead = _ahead(points, line, line.places[0], -1.0)
    ends = _whole_or_half(ahead, segment)
    if ends:
        return _Lengths((*ends, 0.0), certain=False)
    return _Lengths((0.0, *(v for v in ahead if v <= 1.5 * segment.length)), certain=False)


def _by_solids(group: Group, line: HingeLine, hinge: float, way: float, segment: Piece | None) -> _Lengths:
    """Return lengths by how far a piece's solids reach: a whole or half segment, if one ends there."""
    ahead = _ahead(group.extent, line, hinge, way)
    double = 2 * way * (line.place(group.inertial.centre) - hinge)
    longest = max(ahead, default=0.0)
    if segment is None:
        return _Lengths((longest or max(double, 0.0),))
    ends = _whole_or_half(ahead, segment)
    if ends and group.inertial.mass > _MOST * segment.mass:
        # A heavy body that happens to be as large as a segment may be none of the beam.
        return _Lengths((ends[0], 0.0), certain=False)
    if ends:
        return _Lengths(tuple(ends[:1]))
    found = [longest, double, segment.length, 0.0]
    return _Lengths(tuple(value for value in found if value >= 0), certain=False)


def _pivot(hinge: ModelJoint, line: HingeLine) -> float:
    """Return how far before the first spring the hinge is on which the chain turns as a whole."""
    start = -line.place(hinge.position)
    slack = OFF_LINE * (line.spacing or 1.0)
    if start < -slack or line.off_line(hinge.position) > slack:
        raise BadModel(
            f"hinge {hinge.name} must be on the line of the chain's hinges, at its beginning or before"
        )
    return max(start, 0.0)
