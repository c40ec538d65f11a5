"""Drawings of chains of structures: members, joints, supports, bodies and hinges, at rest or bent."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from beammodes.accuracy.loaded_structures import StructureStatics
from beammodes.chains.structure_chain import GROUND, Hinge, StructureChain
from beammodes.checks import positive_real, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import End
from beammodes.problem.structure import Node
from beammodes.vibration.structure_vibration import StructureChainModes
from beammodes.views.symbols import (
    EDGE,
    GREY,
    GROUND_SPRING,
    SPRING,
    body_of,
    draw_block,
    draw_coil,
    draw_disc,
    draw_ground,
    draw_hinge,
    draw_pin,
    draw_rods,
    draw_slide,
    draw_spiral,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["StructurePose", "draw_structure", "hinge_texts", "pose_of_structure"]

# Sizes of symbols, in sizes of the structure: its larger side.
_RADIUS, _TINY, _WALL, _PIN, _PLATE, _DROP = 0.03, 0.006, 0.07, 0.06, 0.06, 0.17
#: How far a hinge is drawn from a joint that has several, in radii of a spring.
_ASIDE = 1.9
#: The slope of the steepest piece.
_STEEPEST = 1.7
#: Up to so many hinges every spring has its label; of more, equal neighbours share one; more are not read.
_CROWD, _MOST = 12, 60
#: Width and height of a letter in its size, and how much of the axes a structure takes.
_LETTER, _LINE, _FILLED = 0.62, 1.25, 0.8
#: Larger fractions are written as decimals; and how near a spring is to a fraction that it shall be.
_LARGEST, _SAME = 99, 1e-9

Vector = tuple[float, float]


@dataclass(frozen=True, eq=False)
class StructurePose:
    """The place of a chain of a structure in a picture.

    Attributes
    ----------
    nodes : ndarray, shape (nodes, 2) [m]
    stretches : tuple of ndarray, shape (pieces + 1, 2) [m]
        Ends of all pieces of each stretch.
    angle : ndarray, shape (bodies,) [rad]
        How far each rigid body has turned.
    """

    nodes: Floats
    stretches: tuple[Floats, ...]
    angle: Floats


class _Spot(NamedTuple):
    """A hinge in the picture: where, and how the piece that it stands on has turned; None of no spring."""

    place: Vector
    away: Vector
    hinge: Hinge | None


def pose_of_structure(
    chain: StructureChain, shape: object = None, *, mode: int = 1, amplitude: float = 0.15
) -> StructurePose:
    """Return the place of a chain of a structure; the arguments are those of `draw_chain`.

    Raises
    ------
    TypeError, ValueError
        If `shape` is of no known kind or not of this chain.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.StructureChain(bm.Structure.of_beam(bm.Beam.unit(), "clamped-free"), 2)
    >>> pose_of_structure(chain).nodes.tolist()
    [[0.0, 0.0], [1.0, 0.0]]
    """
    nodes = np.array([node.place for node in chain.parts.nodes])
    rest = []
    for stretch, pieces in zip(chain.parts.stretches, chain.chains, strict=True):
        along = np.append(0.0, np.cumsum(pieces.length))
        rest.append(nodes[stretch.nodes[0]] + along[:, None] * np.array(stretch.axis))
    if shape is None:
        return StructurePose(nodes, tuple(rest), np.zeros(chain.body_count))
    moved = _moved(chain, shape, mode)
    largest = positive_real("amplitude", amplitude) * _size(nodes)
    reach = max(np.abs(part).max() for part in (moved.nodes, *moved.stretches))
    scale = min(largest / reach if reach else 0.0, _STEEPEST / max(float(np.abs(moved.angle).max()), 1e-300))
    return StructurePose(
        nodes + scale * moved.nodes,
        tuple(at + scale * part for at, part in zip(rest, moved.stretches, strict=True)),
        np.arctan(scale * moved.angle),
    )


def _moved(chain: StructureChain, shape: object, mode: int) -> StructurePose:
    """Return small displacements of nodes and pieces, and rotations."""
    if isinstance(shape, StructureChainModes):
        if shape.chain is not chain:
            raise ValueError(f"shape must be of this chain, got modes of {shown(shape.chain)}")
        row = whole_number("mode", mode, most=len(shape.angular_frequency)) - 1
        across = [deflections[row] for deflections in shape.deflections]
        joints = {name: moved[row] for name, moved in shape.displacement.items()}
        angle = shape.rotation[row]
    elif isinstance(shape, StructureStatics):
        if shape.structure is not chain.structure:
            raise ValueError(f"shape must be of this chain, got one of {shown(shape.structure)}")
        across, joints, angle = _at_rest(chain, shape)
    else:
        raise TypeError(
            "shape must be None, StructureChainModes or StructureStatics for a chain of a structure, "
            f"got {shown(shape)}"
        )
    nodes, stretches = np.zeros((len(chain.parts.nodes), 2)), []
    for stretch, up in zip(chain.parts.stretches, across, strict=True):
        member = chain.structure.member(stretch.member)
        along = np.array(joints[member.start]) @ stretch.axis * np.array(stretch.axis)
        stretches.append(along + up[:, None] * np.array(stretch.normal))
        for i, k in zip(stretch.nodes, (0, -1), strict=True):
            nodes[i] = stretches[-1][k]
    return StructurePose(nodes, tuple(stretches), angle)


def _at_rest(
    chain: StructureChain, found: StructureStatics
) -> tuple[list[Floats], dict[str, Floats], Floats]:
    """Return deflections of pieces' ends, displacements of joints and rotations of bodies under loads."""
    angle, across = np.zeros(chain.body_count), []
    for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True):
        along = np.append(0.0, np.cumsum(pieces.length))
        x = np.clip(stretch.start + along, 0.0, chain.structure.member(stretch.member).beam.length)
        across.append(np.array(found.deflection(x, stretch.member)))
        for body, length, rise in zip(bodies, pieces.length, np.diff(across[-1]), strict=True):
            if length and body > GROUND:
                angle[body] = rise / length
    moved = found.displacements
    for node, fixed in zip(chain.parts.nodes, chain.joints, strict=True):
        if fixed:
            angle[fixed] = moved[node.name][2]
    return across, {name: np.array(moved[name][:2]) for name in chain.structure.joints}, angle


def draw_structure(
    chain: StructureChain,
    ax: Axes,
    *,
    shape: object,
    mode: int,
    amplitude: float,
    unit: str | None,
    ends: bool,
    size: float,
) -> None:
    """Draw a chain of a structure; the arguments are those of `draw_chain`."""
    pose, rest = pose_of_structure(chain, shape, mode=mode, amplitude=amplitude), pose_of_structure(chain)
    whole = _size(rest.nodes)
    shortest = min(float(pieces.length[pieces.length > 0.0].min()) for pieces in chain.chains)
    radius = min(_RADIUS * whole, max(_TINY * whole, 0.35 * shortest))
    if shape is not None:
        for line in rest.stretches:
            ax.plot(*line.T, color=GREY, linewidth=0.8, zorder=0.5)
    for pieces, bodies, line in zip(chain.chains, chain.bodies, pose.stretches, strict=True):
        for welded, run in itertools.groupby(enumerate(bodies), lambda piece: piece[1] == GROUND):
            held = [j for j, _ in run]
            if any(pieces.length[held]):
                draw_rods(ax, *line[held[0] : held[-1] + 2].T, welded=welded)
    if ends:
        for i, node in enumerate(chain.parts.nodes):
            _draw_node(ax, chain, i, node, pose, rest, radius)
    spots = _spots(chain, pose, radius)
    for spot in spots:
        if spot.hinge is not None:
            draw_spiral(ax, spot.place, radius, inner=0.42 * radius)
        draw_hinge(ax, spot.place, (0.3 if spot.hinge is not None else 0.42) * radius)
    if unit is not None:
        _draw_labels(ax, chain, spots, unit, radius, size)


def _size(nodes: Floats) -> float:
    return float(np.ptp(nodes, axis=0).max())


def _outer(chain: StructureChain, node: int) -> list[tuple[int, int, int]]:
    """Return the ends of stretches that meet at a node: stretch, 0 or -1, and the body of its outer piece."""
    found = []
    for s, (stretch, pieces, bodies) in enumerate(
        zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True)
    ):
        long = np.flatnonzero(pieces.length > 0.0)
        for side, i in zip((0, -1), stretch.nodes, strict=True):
            if i == node:
                found.append((s, side, bodies[long[side]]))
    return found


def _spots(chain: StructureChain, pose: StructurePose, radius: float) -> list[_Spot]:
    """Return where hinges are drawn: those inside stretches, then those of nodes."""
    at_nodes: dict[int, list[Hinge]] = {i: [] for i in range(len(chain.parts.nodes))}
    inner: dict[tuple[int, int], Hinge] = {}
    for hinge in chain.hinges:
        inner[hinge.bodies] = hinge
    spots = []
    for pieces, bodies, line in zip(chain.chains, chain.bodies, pose.stretches, strict=True):
        for j in range(pieces.pieces - 1):
            if pieces.length[j] and pieces.length[j + 1]:
                hinge = inner.pop((bodies[j], bodies[j + 1]))
                spots.append(_Spot(_pair(line[j + 1]), _direction(line[j + 2] - line[j]), hinge))
    for i in at_nodes:
        spots += _spots_of_node(chain, i, list(inner.values()), pose, radius)
    return spots


def _spots_of_node(
    chain: StructureChain, i: int, hinges: list[Hinge], pose: StructurePose, radius: float
) -> list[_Spot]:
    """Return the hinges of a node and its pins: one in its middle, several on the pieces that they hold."""
    node, body, arms = chain.parts.nodes[i], chain.joints[i], _outer(chain, i)
    here = {body for *_, body in arms} | ({body} if body is not None else set())
    own = [
        hinge
        for hinge in hinges
        if hinge.place == node.place and set(hinge.bodies) <= here | {GROUND} and set(hinge.bodies) & here
    ]
    # The spring of the support itself is drawn with the support.
    own = [hinge for hinge in own if not (node.rotational_stiffness and set(hinge.bodies) == {GROUND, body})]
    tied = {b for hinge in own for b in hinge.bodies} | ({body} if body is not None else set())
    loose = [arm for arm in arms if arm[2] not in tied and arm[2] != GROUND]
    held = bool(node.supports) or len(arms) > len(loose) or len(loose) > 1
    middle = _pair(pose.nodes[i])
    if len(own) == 1 and not loose and (body is None or body == GROUND or len(arms) == 1):
        s, side, _ = arms[0]
        return [_Spot(middle, _along(pose, s, side), own[0])]
    found = []
    for hinge in own:
        arm = next((a for a in arms if a[2] in hinge.bodies and a[2] not in (body, GROUND)), arms[0])
        away = _along(pose, arm[0], arm[1])
        found.append(_Spot(_shift(middle, away, _ASIDE * radius), away, hinge))
    if loose and held and not (len(arms) == 1 and node.supports):
        together = len(loose) == len(arms) and body is None
        for s, side, _ in loose[:1] if together else loose:
            away = _along(pose, s, side)
            found.append(_Spot(middle if together else _shift(middle, away, _ASIDE * radius), away, None))
    return found


def _along(pose: StructurePose, s: int, side: int) -> Vector:
    """Return the direction from a node along a stretch."""
    line = pose.stretches[s]
    steps = line[1:] - line[:-1] if side == 0 else line[-2::-1] - line[:0:-1]
    return next(_direction(step) for step in steps if step.any())


def _direction(step: Floats) -> Vector:
    x, y = step / math.hypot(*step)
    return float(x), float(y)


def _pair(point: Floats) -> Vector:
    return float(point[0]), float(point[1])


def _shift(at: Vector, way: Vector, by: float) -> Vector:
    return at[0] + by * way[0], at[1] + by * way[1]


def _draw_node(
    ax: Axes,
    chain: StructureChain,
    i: int,
    node: Node,
    pose: StructurePose,
    rest: StructurePose,
    radius: float,
) -> None:
    """Draw what a node stands on and what it carries."""
    at, arms, whole = _pair(pose.nodes[i]), _outer(chain, i), _size(rest.nodes)
    turned = chain.joints[i]
    if turned is None:
        turned = arms[0][2]
    # A single beam does not move along itself: what holds it across holds it.
    alone = len(chain.structure.members) == 1
    _draw_support(ax, node, at, [_along(rest, s, side) for s, side, _ in arms], whole, radius, alone=alone)
    if not (node.mass or node.rotary_inertia):
        return
    body, angle = body_of(End(mass=node.mass, rotary_inertia=node.rotary_inertia), whole), pose.angle[turned]
    cosine, sine = math.cos(angle), math.sin(angle)
    across, up = node.offset
    centre = at[0] + cosine * across - sine * up, at[1] + sine * across + cosine * up
    if math.hypot(across, up) > body.half:
        ax.plot(*zip(at, centre, strict=True), color=EDGE, linewidth=3.0, solid_capstyle="butt", zorder=1.9)
    half = body.half * (0.7 if body.kind != "block" else 1.0)
    if body.kind == "block":
        draw_block(ax, centre, angle, (-half, -half, 2 * half, 2 * half))
    else:
        draw_disc(ax, centre, half, **({"colour": EDGE} if body.kind == "dot" else {"spoke": angle}))


def _draw_support(
    ax: Axes, node: Node, at: Vector, arms: list[Vector], whole: float, radius: float, *, alone: bool
) -> None:
    held = [unit for unit, k in node.supports if k == math.inf]
    sprung = [unit for unit, k in node.supports if k < math.inf]
    turn, outward = node.rotational_stiffness, _outward(arms)
    firm = len(held) == 2 or (alone and any(abs(_dot(unit, arms[0])) < 0.5 for unit in held))
    if firm and turn == math.inf:
        draw_ground(ax, at, 2 * _WALL * whole, angle=_hatched(outward), depth=0.024 * whole)
    elif turn == math.inf:
        way = _facing(held[0], outward) if held else outward
        draw_slide(ax, at, _PLATE * whole, side=-1, angle=math.atan2(way[1], way[0]) + math.pi)
    elif held:
        way = _facing((0.0, 1.0) if len(held) == 2 else held[0], outward)
        draw_pin(ax, at, _PIN * whole, angle=_hatched(way), rolls=not firm)
    for unit in sprung:
        way = _facing(unit, outward)
        foot = _shift(at, way, _DROP * whole)
        draw_coil(ax, foot, at, width=0.05 * whole, colour=GROUND_SPRING)
        draw_ground(ax, foot, 0.12 * whole, angle=_hatched(way), depth=0.018 * whole)
    if 0.0 < turn < math.inf:
        start = math.atan2(*reversed(_facing((0.0, 1.0), outward) if held else outward))
        reach = 1.9 * radius
        draw_spiral(ax, at, reach, inner=1.2 * radius, start=start, colour=GROUND_SPRING)
        foot = _shift(at, (math.cos(start), math.sin(start)), (_PIN if held else 0.1) * whole)
        ax.plot(
            [at[0] + reach * math.cos(start), foot[0]],
            [at[1] + reach * math.sin(start), foot[1]],
            color=GROUND_SPRING,
            linewidth=1.0,
            zorder=4,
        )
        if not held:
            way = (math.cos(start), math.sin(start))
            draw_ground(ax, foot, 0.1 * whole, angle=_hatched(way), depth=0.018 * whole)


def _outward(arms: list[Vector]) -> Vector:
    """Return the direction away from all pieces that meet at a node, down where they leave none."""
    x, y = -sum(arm[0] for arm in arms), -sum(arm[1] for arm in arms)
    size = math.hypot(x, y)
    if size > 0.3:
        return x / size, y / size
    across = (arms[0][1], -arms[0][0])
    return across if across[1] <= 0.0 else (-across[0], -across[1])


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1]


def _facing(unit: Vector, outward: Vector) -> Vector:
    """Return a unit vector or its opposite, whichever leads out of the structure; down or left otherwise."""
    inside = _dot(unit, outward)
    if abs(inside) < 0.3:
        inside = -1.0 if (unit[1], unit[0]) > (0.0, 0.0) else 1.0
    return unit if inside > 0.0 else (-unit[0], -unit[1])


def _hatched(way: Vector) -> float:
    """Return the angle of ground whose hatched side points some way."""
    return math.atan2(way[1], way[0]) + math.pi / 2


def hinge_texts(chain: StructureChain, unit: str = "EI/ell") -> dict[Hinge, str]:
    """Return the springs at a chain's hinges as labels of a drawing.

    In "EI/ell" they are in the mean EI of the stretch, the first that meets there, over its longest segment.

    Examples
    --------
    >>> import beammodes as bm
    >>> crack = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [bm.Station(0.5, hinge=2.0)])
    >>> list(hinge_texts(bm.StructureChain(crack, 6)).values())
    ['8/3', '8/9', '8/9', '4/15', '6/7', '24/23']
    """
    first: dict[Hinge, float] = {}
    for hinge in chain.hinges:
        for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True):
            if set(hinge.bodies) & (set(bodies) - {GROUND}):
                first[hinge] = stretch.beam.mean_bending_stiffness / float(pieces.length.max())
                break
    if unit != "EI/ell":
        return {hinge: f"{hinge.stiffness:.4g}" for hinge in chain.hinges}
    return {hinge: _text(hinge.stiffness / first.get(hinge, 1.0)) for hinge in chain.hinges}


def _text(value: float) -> str:
    near = Fraction(value).limit_denominator(_LARGEST)
    if 0 < near.numerator <= _LARGEST and abs(near / Fraction(value) - 1) < _SAME:
        return str(near)
    return f"{value:.4g}"


def _draw_labels(
    ax: Axes, chain: StructureChain, spots: list[_Spot], unit: str, radius: float, size: float
) -> None:
    """Write springs beside hinges, to the left of the stretch that they are on."""
    texts = hinge_texts(chain, unit)
    listed = [(spot, texts[spot.hinge]) for spot in spots if spot.hinge is not None]
    runs: list[tuple[_Spot, str]] = []
    for (text, *_), group in itertools.groupby(
        enumerate(listed), lambda one: (one[1][1], one[1][0].away, 0 if len(listed) > _CROWD else one[0])
    ):
        run = [spot for _, (spot, _) in group]
        runs.append((run[(len(run) - 1) // 2], text if len(run) == 1 else f"{len(run)} × {text}"))
    if len(runs) > _MOST:
        return
    nodes = {node.place: node for node in chain.parts.nodes}
    places = np.array(list(nodes))
    whole, point = _size(places), _point(ax, places)
    written: list[tuple[float, float, float, float]] = []
    for spot, text in runs:
        assert spot.hinge is not None
        normal, lift = _upper(spot, list(nodes)), 1.15 * radius
        turn = nodes[spot.hinge.place].rotational_stiffness if spot.hinge.place in nodes else 0.0
        if turn:
            lift = _WALL * whole if turn == math.inf else 2.1 * radius
        foot, beside = _shift(spot.place, normal, lift), abs(normal[0]) > 0.5
        side, way = (math.copysign(1.0, part) for part in normal)
        wide, high = _LETTER * size * len(text), _LINE * size
        # In points: further out, one label or line for each that it would cover.
        for row in range(len(runs)):
            across = 0.3 * size * normal[0] + beside * row * (wide + 0.5 * size) * side
            up = 0.6 * high * normal[1] + (not beside) * row * high * way
            middle = across + beside * side * wide / 2
            box = foot[0] / point + middle, foot[1] / point + up, wide, high
            if not any(_covers(box, other) for other in written):
                break
        written.append(box)
        ax.annotate(
            text,
            foot,
            (across, up),
            textcoords="offset points",
            ha=("left" if normal[0] > 0 else "right") if beside else "center",
            va="center",
            color=SPRING,
            fontsize=size,
            zorder=6,
        )
        x, y = box[0] * point, box[1] * point
        half = 0.5 * wide * point, 0.5 * high * point
        ax.update_datalim([(x - half[0], y - half[1]), (x + half[0], y + half[1])])


def _point(ax: Axes, places: Floats) -> float:
    """Return about how long a point of 1/72 inch will be in the data."""
    box = ax.get_window_extent()
    span = np.ptp(places, axis=0) / [max(box.width, 1.0), max(box.height, 1.0)]
    return float(span.max()) / _FILLED * ax.figure.get_dpi() / 72.0


def _covers(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return abs(a[0] - b[0]) < (a[2] + b[2]) / 2 and abs(a[1] - b[1]) < 0.9 * (a[3] + b[3]) / 2


def _upper(spot: _Spot, places: list[Vector]) -> Vector:
    """Return the normal of a piece where its label stands: above it, or outside beside an upright one."""
    normal = -spot.away[1], spot.away[0]
    lower = normal[1] < -1e-9 or (abs(normal[1]) <= 1e-9 and normal[0] > 0.0)
    near = [(_dot(normal, _minus(place, spot.place)), math.dist(place, spot.place)) for place in places]
    crowd = sum(up / far**3 for up, far in near if far) * max(far for _, far in near) ** 2
    if abs(crowd) > (1e-9 if abs(normal[0]) > 0.5 else 1.0):
        lower = crowd > 0.0
    return (-normal[0], -normal[1]) if lower else normal


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]
