"""A serial chain of a model in one plane: pieces on a line, springs between them, what holds the ends.

::

      near  |  piece 0 --spring-- piece 1 --spring-- ... --spring-- last piece  |  far
             s runs along the beam, from the chain's root to its tip

Where the ground itself carries the first hinge, piece 0 is what is rigid with the ground: of no length, or a
welded segment. A file does not say where a beam begins and ends, only where its hinges are; geometry, centres
of mass and neighbours suggest lengths of the outer pieces, and of these the ones are taken that come nearest
to the beam's length in sum. They do not touch the frequencies of a chain with a free or clamped end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from beammodes.auditing.body_tree import Group, ModelJoint
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.far_ties import FarEnd
from beammodes.auditing.hinge_line import OFF_LINE, Frame, RootSupport, moves_alone, root_support
from beammodes.auditing.rigid_pieces import Piece, PlanarChain, held_piece
from beammodes.auditing.serial_chains import PARALLEL, HingePath

__all__ = ["planar_chain"]


def planar_chain(path: HingePath, frame: Frame, far: FarEnd, length: float) -> PlanarChain:
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

    Raises
    ------
    BadModel
        If something moves on the chain that is no part of it, or cannot be honoured.
    """
    _check(path, frame)
    root = root_support(path.root, frame)
    moves = root is not None
    span = frame.places[-1] - frame.places[0]
    starts = _stubs(path.root, frame) if root is None else _starts(path.root, frame, root)
    ends = _lengths(path.groups[-1], frame, frame.places[-1], 1.0)
    if far.place is not None:
        ends = [far.place - frame.places[-1]]
    elif far.turning and path.groups[-1].extent:
        ends = ends[:1]
    if far.turning and moves:
        # Beyond the far hinge the beam may go on, so its length does not tell where it begins.
        starts = starts[:1]
    start, end = _nearest(starts, ends, length - span)
    cuts = [frame.places[0] - start, *frame.places, frame.places[-1] + end]
    groups = [path.root if moves else None, *path.groups]
    pieces = [_piece(group, frame, *cut) for group, cut in zip(groups, itertools.pairwise(cuts), strict=True)]
    if not moves:
        pieces[0] = held_piece(start, pieces[1:])
    springs = tuple((hinge.name, hinge.stiffness) for hinge in frame.hinges)
    support = root or RootSupport()
    return PlanarChain(tuple(pieces), springs, (support.across, support.turning), (far.across, far.turning))


def _nearest(starts: Sequence[float], ends: Sequence[float], rest: float) -> tuple[float, float]:
    """Return the pair whose sum is nearest; of several, the one whose numbers stand first, the end's most."""
    pairs = itertools.product(enumerate(ends), enumerate(starts))
    off = [(round(abs(start + end - rest) / (abs(rest) or 1.0), 5), j, i) for (j, end), (i, start) in pairs]
    _, j, i = min(off)
    return starts[i], ends[j]


def _check(path: HingePath, frame: Frame) -> None:
    for group, after in itertools.zip_longest(path.groups, path.groups[1:]):
        _check_refusals(group)
        for other in group.children:
            if other is not after:
                _check_refusals(other)
                raise BadModel(
                    f"{other.joints[0].name} on body {group.name} must be a hinge with a spring, parallel "
                    f"to {frame.hinges[0].name}: nothing else may move on the chain"
                )
    root = [path.root] if moves_alone(path.root) else []
    both = len(path.planes()) > 1
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


def _starts(root: Group, frame: Frame, support: RootSupport) -> list[float]:
    """Return what the length of a first piece that moves may be: from its hinge on, or as `_lengths`."""
    if support.hinge is not None:
        return [_pivot(support.hinge, frame)]
    joints = [-frame.place(joint.position) for joint in root.joints if joint.kind == "slide"]
    return [*(value for value in joints if value >= 0), *_lengths(root, frame, 0.0, -1.0)]


def _pivot(hinge: ModelJoint, frame: Frame) -> float:
    """Return how far before the first spring the hinge is on which the chain turns as a whole."""
    start = -frame.place(hinge.position)
    spacing = frame.spacing or 1.0
    if start < -OFF_LINE * spacing or frame.off_line(hinge.position) > OFF_LINE * spacing:
        raise BadModel(
            f"hinge {hinge.name} must be on the line of the chain's hinges, at its beginning or before"
        )
    return max(start, 0.0)


def _lengths(group: Group, frame: Frame, hinge: float, way: float) -> list[float]:
    """Return what the length of an outer piece that moves may be, `way` from its hinge."""
    reach = [way * (frame.place(point) - hinge) for point in group.extent]
    double = 2 * way * (frame.place(group.inertial.centre) - hinge)
    spaces = np.diff(frame.places).tolist()
    near = spaces[:1] if way < 0 else spaces[-1:]
    found = [max(reach, default=0.0), double, *near, 0.0]
    return [value for value in found if value >= 0]


def _stubs(root: Group, frame: Frame) -> list[float]:
    """Return what the length of the piece that is rigid with the ground may be."""
    places = [body.origin for body in root.bodies if frame.off_line(body.origin) < PARALLEL + frame.spacing]
    places += [np.zeros(3), *(point for body in root.bodies for point in body.extent)]
    found = {round(-frame.place(point), 15) for point in places if frame.off_line(point) <= frame.spacing}
    longest = 1.5 * frame.spacing if frame.spacing else math.inf
    return [0.0, *sorted(value for value in found if 0 < value <= longest)]
