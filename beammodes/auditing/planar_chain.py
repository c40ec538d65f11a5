"""A serial chain of a model in one plane: pieces on a line, springs between them, what holds the ends.

::

      near  |  piece 0 --spring-- piece 1 --spring-- ... --spring-- last piece  |  far
             s runs along the beam, from the chain's root to its tip

Where the ground itself carries the first hinge, piece 0 is what is rigid with the ground: of no length, or a
welded segment. A file says where hinges are, not where a beam begins and ends. What an outer piece is made of
tells its length: matter like its neighbour's, or a solid as long as its neighbour. Only where neither tells,
the length is taken that comes nearest to the beam's, and that is said. These lengths do not touch the
frequencies of a chain with a free or clamped end. The world's origin tells nothing.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beammodes.auditing.body_tree import Group, Inertial, ModelJoint, ModelTie
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.model_ends import Piece, PlanarChain, Spring, held_piece
from beammodes.auditing.serial_chains import (
    OFF_LINE,
    Frame,
    HingePath,
    RootSupport,
    lone_segment,
    root_support,
)

__all__ = ["FarEnd", "far_end", "planar_chain"]


# What fixed tendons hold of a chain's tip: sums of joint coordinates that are its deflection or rotation.

_SAME = 1e-6


@dataclass(frozen=True)
class FarEnd:
    """Stiffnesses under the tip, its place if a tie says it, and the name of the tie that resists turning."""

    across: float = 0.0
    turning: float = 0.0
    place: float | None = None
    spring: str = ""


def far_end(
    ties: Sequence[ModelTie], hinges: Mapping[str, tuple[float, float]], slides: Mapping[str, float]
) -> FarEnd:
    """Return what the ties on a chain's joints do at its tip.

    A tie is the tip's rotation if all hinges count alike, and its deflection if each counts by its distance
    from one point beyond them, as `export_chain` writes both.

    Parameters
    ----------
    ties : sequence of ModelTie
    hinges : mapping
        For every hinge that turns the chain, its place along it and 1.0, or -1.0 if it turns the other way.
    slides : mapping
        For every slide across the chain 1.0, or -1.0 if it goes down.

    Raises
    ------
    BadModel
        If a tie is neither.

    Examples
    --------
    >>> tie = ModelTie("tip", (("a", 2.0), ("b", 1.0)), 30.0)
    >>> far_end([tie], {"a": (0.0, 1.0), "b": (1.0, 1.0)}, {})
    FarEnd(across=30.0, turning=0.0, place=2.0, spring='')
    """
    found = FarEnd()
    for tie in ties:
        coefficients = dict(tie.terms)
        if not (tie.stiffness or tie.refusal) or not coefficients.keys() & (hinges.keys() | slides.keys()):
            continue
        if tie.refusal:
            raise BadModel(tie.refusal)
        turns = [(place, way * coefficients.pop(name, 0.0)) for name, (place, way) in hinges.items()]
        shift = [way * coefficients.pop(name, 0.0) for name, way in slides.items()]
        if any(coefficients.values()):
            raise BadModel(f"tendon {tie.name} must join hinges of the chain only")
        found = _with(found, tie, turns, shift)
    return found


def _with(end: FarEnd, tie: ModelTie, turns: list[tuple[float, float]], shift: list[float]) -> FarEnd:
    (first, lead), (last, rest) = turns[0], turns[-1]
    alike = not any(shift) and all(abs(value - lead) <= _SAME * abs(lead) for _, value in turns)
    # Of one hinge alone a number cannot tell; 1 is its rotation, anything else a distance.
    if alike and (len(turns) > 1 or shift or (abs(lead) == 1 and tie.stiffness < math.inf)):
        return FarEnd(end.across, end.turning + _times(tie.stiffness, lead), end.place, tie.name)
    scale = shift[0] if any(shift) else 1.0 if last == first else (lead - rest) / (last - first)
    place = first + lead / scale if scale else math.nan
    fits = all(abs(value - scale * (place - at)) <= _SAME * max(abs(lead), abs(scale)) for at, value in turns)
    if not (fits and math.isfinite(place) and place >= last * (1 - _SAME)):
        raise BadModel(f"tendon {tie.name} must be the deflection or the rotation of the chain's tip")
    return FarEnd(end.across + _times(tie.stiffness, scale), end.turning, place, end.spring)


def _times(stiffness: float, scale: float) -> float:
    return math.inf if stiffness == math.inf else stiffness * scale**2


#: Matter is that of a neighbour's kind up to this share of its length; solids and rods of files are rounded.
_ALIKE = 2e-3


#: A piece this much heavier or lighter than its neighbour is no longer or shorter one of its kind.
_LEAST, _MOST = 0.05, 2.5


@dataclass(frozen=True)
class _Outer:
    """What the length of an outer piece may be [m], the likeliest first, and whether its matter tells."""

    lengths: tuple[float, ...]
    certain: bool = True


def planar_chain(path: HingePath, frame: Frame, far: FarEnd, length: float, word: str = "") -> PlanarChain:
    """Return a chain's numbers in one plane.

    Parameters
    ----------
    path : HingePath
    frame : Frame
        From `frame_of`.
    far : FarEnd
        What ties hold of its tip.
    length : float [m]
        Of the beam.
    word : str
        Why the body that carries the chain is held although it has joints, empty if it moves as they let it.

    Raises
    ------
    BadModel
        If something moves on the chain that is no part of it, or cannot be honoured.
    """
    root = None if word else root_support(path, frame)
    _check(path, frame, root)
    span = frame.places[-1] - frame.places[0]
    near = _begin(path, frame, root)
    tip = _end(path, frame, far, span, root)
    if far.turning and root is not None:
        # Beyond the far hinge the beam may go on, so its length does not tell where it begins.
        near = _Outer(near.lengths[:1])
    start, end = _nearest(near.lengths, tip.lengths, length - span)
    cuts = [frame.places[0] - start, *frame.places, frame.places[-1] + end]
    groups = [path.root if root else None, *path.groups]
    pieces = [_piece(group, frame, *cut) for group, cut in zip(groups, itertools.pairwise(cuts), strict=True)]
    segment = _inside(path, frame, 1, root)
    if root is None:
        # A single moving piece may carry a body, which is no measure of the beam.
        pieces[0] = held_piece(start, [segment] if segment and len(pieces) == 2 else pieces[1:])
    support = root or RootSupport()
    return PlanarChain(
        tuple(pieces),
        tuple(map(_spring, frame.hinges)),
        (support.across, support.turning),
        (far.across, far.turning),
        near_hinge=_spring(support.hinge) if support.hinge else None,
        assumed=(*_assumed(frame, (near, start), (tip, end), word or support.why), *_undamped(root)),
        segment=segment,
    )


def _spring(hinge: ModelJoint) -> Spring:
    return Spring(hinge.name, hinge.stiffness, hinge.damping, hinge.armature)


def _undamped(root: RootSupport | None) -> Iterable[str]:
    if root and root.slide and root.slide.damping:
        yield f"the damping of joint {root.slide.name} is left out"


def _assumed(frame: Frame, near: tuple[_Outer, float], tip: tuple[_Outer, float], why: str) -> Iterable[str]:
    if why:
        yield why
    ends = (("begins", "before", frame.hinges[0], near), ("ends", "past", frame.hinges[-1], tip))
    for does, where, hinge, (outer, taken) in ends:
        others = [f"{value:.6g}" for value in outer.lengths if abs(value - taken) > _ALIKE * abs(taken)]
        if not outer.certain and others:
            yield (
                f"the beam {does} {taken:.6g} m {where} hinge {hinge.name}, which comes nearest to its "
                "length; "
                f"the file fits {' or '.join(dict.fromkeys(others))} m too"
            )


def _nearest(starts: Sequence[float], ends: Sequence[float], rest: float) -> tuple[float, float]:
    """Return the pair whose sum is nearest; of several, the one whose numbers stand first, the end's most."""
    pairs = itertools.product(enumerate(ends), enumerate(starts))
    off = [(round(abs(start + end - rest) / (abs(rest) or 1.0), 5), j, i) for (j, end), (i, start) in pairs]
    _, j, i = min(off)
    return starts[i], ends[j]


def _check(path: HingePath, frame: Frame, support: RootSupport | None) -> None:
    for group, after in itertools.zip_longest(path.groups, path.groups[1:]):
        _check_refusals(group)
        for other in group.children:
            if other is not after:
                _check_refusals(other)
                raise BadModel(
                    f"{other.joints[0].name} on body {group.name} must be a hinge with a spring, parallel "
                    f"to {frame.hinges[0].name}: nothing else may move on the chain. If a motor holds it, "
                    "say by boundary what the chain's ends are: a hinge without a spring between hinges with "
                    "springs is then held"
                )
    root = [path.root] if support else []
    both = len(path.planes()) > 1 or path.in_space or (support is not None and support.in_space)
    for group in (*root, *path.groups):
        _check_matter(group, frame, both)


def _check_refusals(group: Group) -> None:
    refusals = [body.refusal for body in group.bodies] + [joint.refusal for joint in group.joints]
    for why in filter(None, refusals):
        raise BadModel(why)


def _check_matter(group: Group, frame: Frame, both: bool) -> None:
    inertial, spacing = group.inertial, frame.spacing or abs(frame.place(group.inertial.centre))
    if not inertial.mass:
        raise BadModel(f"body {group.name} must have a mass greater than 0")
    off = inertial.centre - frame.origin - frame.place(inertial.centre) * frame.along
    distance = float(np.linalg.norm(off)) if both else frame.off_line(inertial.centre)
    if distance > max(OFF_LINE * spacing, 1e-12):
        raise BadModel(f"body {group.name} must have its centre of mass on the line of the hinges")
    product = abs(float(frame.axis @ inertial.inertia @ frame.across))
    if both and product > OFF_LINE * float(np.trace(inertial.inertia)):
        raise BadModel(f"body {group.name} must have its principal axes along the hinges'")


def _piece(group: Group | None, frame: Frame, start: float, end: float) -> Piece:
    if group is None:
        return Piece(end - start, 0.0, 0.0, 0.0)
    inertial = group.inertial
    about = float(frame.axis @ inertial.inertia @ frame.axis)
    if about < 0:
        raise BadModel(f"body {group.name} must have an inertia of at least 0, got {about:.3g}")
    return Piece(end - start, inertial.mass, frame.place(inertial.centre) - start, about)


def _begin(path: HingePath, frame: Frame, root: RootSupport | None) -> _Outer:
    """Return what the length of the first piece may be: up to the hinge that turns it, or as matter tells."""
    if root is not None and root.hinge is not None:
        return _Outer((_pivot(root.hinge, frame),))
    slides = [] if root is None else [-frame.place(j.position) for j in path.root.joints if j.kind == "slide"]
    known = [value for value in slides if value >= 0]
    inside = _inside(path, frame, -1, root)
    found = _by_matter(path.root, frame, frame.places[0], -1.0, inside)
    if found is not None:
        return _Outer((found,))
    if known:
        return _Outer(tuple(known[:1]))
    if root is None and path.root.parent is not None:
        # A body of a mechanism that carries the chain is no part of the beam.
        return _Outer((0.0,))
    return _by_solids(path.root, frame, frame.places[0], -1.0, inside, held=root is None)


def _end(path: HingePath, frame: Frame, far: FarEnd, span: float, root: RootSupport | None) -> _Outer:
    """Return what the length of the last piece may be."""
    hinge, tip = frame.places[-1], path.groups[-1]
    if far.place is not None:
        return _Outer((far.place - hinge,))
    inside = _inside(path, frame, 1, root)
    found = _by_matter(tip, frame, hinge, 1.0, inside)
    if found is not None:
        return _Outer((found,))
    outer = _by_solids(tip, frame, hinge, 1.0, inside, held=False)
    positive = tuple(value for value in outer.lengths if value > 0) if not span else outer.lengths
    return _Outer(positive or (0.0,), outer.certain)


def _inside(path: HingePath, frame: Frame, way: float, root: RootSupport | None) -> Piece | None:
    """Return the piece that shows what segments are made of, seen from its hinge towards an end.

    It is the one between two hinges that is nearest to that end, else the first up to the hinge that turns
    it; of one hinge alone, the segment on it.
    """
    pairs = list(zip(itertools.pairwise(frame.places), path.groups, strict=False))
    for (start, end), group in pairs[::-1] if way > 0 else pairs:
        if end > start and group.inertial.mass:
            piece = _piece(group, frame, start, end)
            return _seen(piece, way)
    if root is not None and root.hinge is not None and path.root.inertial.mass:
        length = _pivot(root.hinge, frame)
        if length > 0:
            return _seen(_piece(path.root, frame, -length, frame.places[0]), way)
    lone = lone_segment(path.groups[-1], frame)
    if lone is None:
        return None
    length, own = lone
    hinge, about = frame.places[-1], float(frame.axis @ own.inertia @ frame.axis)
    return _seen(Piece(length, own.mass, frame.place(own.centre) - hinge, max(about, 0.0)), way)


def _seen(piece: Piece, way: float) -> Piece:
    return piece if way > 0 else replace(piece, centre=piece.length - piece.centre)


def _by_matter(group: Group, frame: Frame, hinge: float, way: float, inside: Piece | None) -> float | None:
    """Return the length of an outer piece that is made as its neighbour is, alone or with a body on it."""
    if inside is None:
        return None
    solids = (solid.inertial for body in group.bodies for solid in body.solids)
    for part in (group.inertial, *(body.inertial for body in group.bodies), *solids):
        found = _alike(part, frame, hinge, way, inside)
        if found is not None:
            return found
    return None


def _alike(part: Inertial, frame: Frame, hinge: float, way: float, inside: Piece) -> float | None:
    share = part.mass / inside.mass
    if not _LEAST < share < _MOST:
        # Other matter, or none, whose centre is nowhere.
        return None
    if frame.off_line(part.centre) > _ALIKE * inside.length:
        return None
    centre = way * (frame.place(part.centre) - hinge)
    if abs(share - 1) > _ALIKE and abs(centre - inside.centre) <= _ALIKE * inside.length:
        # Another mass at the same place, as lumped masses have at the last hinge or the tip.
        return inside.length
    if abs(centre - share * inside.centre) <= _ALIKE * inside.length:
        return share * inside.length if abs(share - 1) > _ALIKE else inside.length
    return None


def _by_solids(
    group: Group, frame: Frame, hinge: float, way: float, inside: Piece | None, held: bool
) -> _Outer:
    """Return lengths by how far a piece's solids reach: a whole or half segment, if one ends there."""
    # A welded body that has mass, and another than a segment's, is what the beam is fixed to.
    points = group.extent
    if held:
        points = [point for body in group.bodies if not body.inertial.mass for point in body.extent]
    reach = {round(way * (frame.place(point) - hinge), 12) for point in points}
    ahead = sorted(value for value in reach if value > 0)
    if inside is not None:
        ends = [
            part * inside.length
            for part in (1.0, 0.5)
            if any(abs(value - part * inside.length) <= _ALIKE * inside.length for value in ahead)
        ]
        if ends:
            return _Outer((*ends, 0.0), certain=False) if held else _Outer(tuple(ends[:1]))
        if held:
            return _Outer((0.0, *(v for v in ahead if v <= 1.5 * inside.length)), certain=False)
    elif held:
        return _Outer((0.0,))
    double = 2 * way * (frame.place(group.inertial.centre) - hinge)
    longest = max(ahead, default=0.0)
    if inside is None:
        return _Outer((longest or max(double, 0.0),))
    found = [longest, double, inside.length, 0.0]
    return _Outer(tuple(value for value in found if value >= 0), certain=False)


def _pivot(hinge: ModelJoint, frame: Frame) -> float:
    """Return how far before the first spring the hinge is on which the chain turns as a whole."""
    start = -frame.place(hinge.position)
    spacing = frame.spacing or 1.0
    if start < -OFF_LINE * spacing or frame.off_line(hinge.position) > OFF_LINE * spacing:
        raise BadModel(
            f"hinge {hinge.name} must be on the line of the chain's hinges, at its beginning or before"
        )
    return max(start, 0.0)
