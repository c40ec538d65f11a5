"""Flexes of MuJoCo 4 that are straight rods: point masses on massless edges, springs at points between them.

A point between edges of the lengths ℓ₀ and ℓ₁ bends by the energy k |κb|², where k = E I / (ℓ₀ + ℓ₁)
and κb is the angle between the edges, near rest. So its moment is

    M = 2 E I θ / (ℓ₀ + ℓ₁).

Points have their mass in the place where they are: the last one a whole share where a beam's end has half of
one. What is pinned is held: one point is a pinned end, two a clamped one, whose edge does not bend.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from beammodes.auditing.body_tree import ModelRod, SpringPlace
from beammodes.auditing.bounded_xml import BadModel, XmlElement
from beammodes.auditing.planar_chain import Piece, PlanarChain, Spring
from beammodes.checks import shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "MOST_POINTS",
    "flexcomp_points",
    "listed",
    "ordered",
    "rod_in_plane",
    "rod_of_points",
    "told_of_points",
]

#: Points of a chain in a file with nested bodies are as many.
MOST_POINTS = 600
#: MuJoCo takes points that are bent less, in radians, as straight.
_STRAIGHT = 1e-4
#: The first principal axis is nearest to y of the body of the first point, or to z where y is no farther from
#: the rod than by this cosine.
_ASLANT = 0.5
#: A mass at an end is a body there beyond this share of the others.
_HEAVIER = 1e-3
_SET_BY = (
    "all springs of a flex come from its one young: export hinges to set single ones, or begin the flex half "
    "an edge inside the wall"
)


def flexcomp_points(flex: XmlElement) -> tuple[Floats, list[int], tuple[bool, ...]]:
    """Return the points of a flexcomp in its own frame, its elements, and which points are pinned."""
    kind = flex.attributes.get("type", "grid")
    if kind == "grid":
        counts = flex.numbers("count", (1, 2, 3), "10 10 10")
        spacing = flex.numbers("spacing", (1, 2, 3), "0.02 0.02 0.02")[0]
        count = int(counts[0]) if counts[0] == int(counts[0]) else 0
        if not 2 <= count <= MOST_POINTS:
            flex.refuse(
                f"must have a count from 2 to {MOST_POINTS}, got {shown(flex.attributes.get('count'))}"
            )
        points = np.zeros((count, 3))
        points[:, 0] = spacing * (np.arange(count) - (count - 1) / 2)
        elements = [i for edge in range(count - 1) for i in (edge, edge + 1)]
    elif kind == "direct":
        points = listed(flex, "point", 3) * flex.numbers("scale", 3, "1 1 1")
        elements = [int(i) for i in listed(flex, "element", 2).ravel()]
    else:
        flex.refuse(f"must be of type grid or direct to be judged, got {shown(kind)}")
    pinned = np.zeros(len(points), dtype=bool)
    pins = list(flex.all("pin"))
    if len(pins) > MOST_POINTS:
        flex.refuse(f"must have at most {MOST_POINTS} <pin> elements")
    for pin in pins:
        pinned[_indices(pin, "id", len(points))] = True
        ends = _indices(pin, "range", len(points))
        for first, last in zip(ends[::2], ends[1::2], strict=False):
            pinned[first : last + 1] = True
    return points, elements, tuple(pinned.tolist())


def listed(element: XmlElement, name: str, columns: int) -> Floats:
    """Return the numbers of a long attribute in rows."""
    text = element.attributes.get(name, "")
    count = len(text.split(maxsplit=columns * MOST_POINTS + 1))
    if count % columns or not columns <= count <= columns * MOST_POINTS:
        element.refuse(f"must have rows of {columns} numbers in {name}, at most {MOST_POINTS}")
    return np.array(element.read(name, text, count)).reshape(-1, columns)


def _indices(pin: XmlElement, name: str, count: int) -> list[int]:
    if name not in pin.attributes:
        return []
    values = listed(pin, name, 1 if name == "id" else 2).ravel()
    if ((values < 0) | (values >= count) | (values % 1 != 0)).any():
        pin.refuse(f"must name points from 0 to {count - 1} in {name}, got {shown(pin.attributes[name])}")
    return [int(value) for value in values]


def ordered(flex: XmlElement, elements: Sequence[int], count: int) -> list[int]:
    """Return points in their order along the rod; refuse elements that are no single open chain."""
    if any(not 0 <= i < count for i in elements):
        flex.refuse(f"must have elements of points from 0 to {count - 1}")
    after: dict[int, list[int]] = {i: [] for i in range(count)}
    for one, other in zip(elements[::2], elements[1::2], strict=False):
        after[one].append(other)
        after[other].append(one)
    ends = [i for i, others in after.items() if len(others) == 1]
    # From the end that the elements name first.
    row = sorted(ends, key=elements.index)[:1]
    while row and len(row) <= count:
        further = [i for i in after[row[-1]] if i not in row[-2:]]
        if len(further) != 1:
            break
        row += further
    if len(elements) != 2 * count - 2 or len(row) != count:
        flex.refuse("must be one open row of points to be judged as a rod")
    return row


def rod_of_points(flex: XmlElement, rod: ModelRod, turned: Floats) -> ModelRod:
    """Return a rod with the elasticity of its flex or flexcomp; its first point is of a body turned so."""
    refusal = rod.refusal
    edges, lengths = np.diff(rod.points, axis=0), _lengths(rod.points)
    whole = rod.points[-1] - rod.points[0]
    length = float(np.linalg.norm(whole))
    elastic = flex.first("elasticity") or XmlElement("elasticity", {}, flex.line)
    young = elastic.at_least_0("young", elastic.number("young", "0"))
    if not refusal and not young:
        refusal = f"{flex.where} must have an elasticity with a young above 0: nothing resists its bending"
    if not refusal and len(rod.points) < 3:
        refusal = f"{flex.where} must have at least three points: a rod of one edge does not bend"
    if not refusal and not (lengths.all() and length):
        refusal = f"{flex.where} must have points that are apart"
    if not refusal and np.linalg.norm(edges / lengths[:, None] - whole / length, axis=1).max() > _STRAIGHT:
        refusal = f"{flex.where} must be straight to be judged"
    if not refusal and not rod.masses.all():
        refusal = f"{flex.where} must have a mass at every point"
    if refusal:
        return replace(rod, refusal=refusal)
    along = whole / length
    own = turned.T @ along
    least = turned @ np.eye(3)[1 if abs(own[1]) < _ASLANT else 2]
    first = least - (least @ along) * along
    first = first / float(np.linalg.norm(first))
    inertia, section = _section(flex, elastic)
    rigidity = (young * inertia[0], young * inertia[1])
    poisson = elastic.at_least_0("poisson", elastic.number("poisson", "0"))
    shear = elastic.number("shear", "0") or young / (2 * (1 + poisson))
    about = f"{rigidity[0]:.6g}"
    if rigidity[0] != rigidity[1]:
        about += f" and {rigidity[1]:.6g}"
    total = float(rod.masses.sum())
    given = (
        f"flex {rod.name} of {len(rod.points)} points: young {young:.6g} Pa and {section} are EI = {about} "
        f"N m² and G = {shear:.6g} Pa, {total:.6g} kg over {length:.6g} m, a share at every point; each "
        "spring between two edges is EI by their mean length",
    )
    notes = ["the flex's stretch and twist are left out: bending moves neither; they may need a shorter step"]
    edge = flex.first("edge") or XmlElement("edge", {}, flex.line)
    taut = edge.attributes.get("equality", "false") != "false" or edge.number("stiffness", "0")
    if flex.tag == "flexcomp" and not taut:
        notes.append(
            f"nothing resists the stretch of {flex.where}: its edge has no equality and no stiffness"
        )
    damping = elastic.at_least_0("damping", elastic.number("damping", "0"))
    return replace(
        rod,
        rigidity=rigidity,
        across=(first, np.cross(along, first)),
        damping=damping,
        place=SpringPlace("attribute", flex.start, flex.file, refusal=_SET_BY),
        given=given,
        notes=tuple(notes),
    )


def told_of_points(rod: ModelRod, mass_per_length: float) -> tuple[str, ...]:
    """Say what the masses of a cantilever's equal points cost, or that they are those of whole segments."""
    clamped = sorted((_leading(rod.held), _leading(rod.held[::-1]))) == [0, 2]
    if not clamped or np.ptp(rod.masses) > _HEAVIER * rod.masses[0]:
        return ()
    segment = mass_per_length * float(_lengths(rod.points).mean())
    if abs(rod.masses[0] / segment - 1) <= _HEAVIER:
        return (
            "every point has one segment's mass: read as begun half an edge inside the wall, with points in "
            "the middles of segments, the flex has the beam's mass, and errs by 1/N²",
        )
    return (
        f"the point at its free end has {rod.masses[0]:.6g} kg as any other, where a beam ends with half of "
        "that; begun half an edge inside the wall, with a segment's mass at every point, a flex errs by 1/N²",
    )


def _section(flex: XmlElement, elastic: XmlElement) -> tuple[tuple[float, float], str]:
    """Return the second moments of a rod's section, the first for deflection along its first axis."""
    if elastic.attributes.get("section", "circle") == "box":
        a, b = elastic.numbers("sectionsize", 2)
        if min(a, b) <= 0:
            elastic.refuse("must have a sectionsize of two numbers above 0")
        return (4 / 3 * a**3 * b, 4 / 3 * a * b**3), f"a section of {2 * a:g} by {2 * b:g} m"
    radius = flex.number("radius", "0.005")
    if radius <= 0:
        flex.refuse(f"must have a radius above 0, got {radius:g}")
    return (math.pi * radius**4 / 4,) * 2, f"a radius of {radius:g} m"


# From a rod to pieces and springs.


def rod_in_plane(rod: ModelRod, plane: int) -> PlanarChain:
    """Return pieces and springs in one of the two planes; refuse points that are held inside."""
    if rod.refusal:
        raise BadModel(rod.refusal)
    lengths, masses, held = _lengths(rod.points), rod.masses, rod.held
    count = len(held)
    near, far = _leading(held), _leading(held[::-1])
    if near == count or any(held[near : count - far]):
        raise BadModel(f"flex {rod.name} must have its pinned points at its ends, and others between them")
    # A clamped end is one piece, up to the last point that is held.
    cuts = [0, *range(max(near - 1, 1), count - max(far - 1, 1)), count - 1]
    middle = 2 / (lengths[:-1] + lengths[1:])
    stiffness = rod.rigidity[plane] * middle
    # The softer plane of a box is damped by the mean of both.
    drag = rod.damping * max(rod.rigidity[plane], math.sqrt(math.prod(rod.rigidity))) * middle
    springs = [
        Spring(f"{rod.name}[{i}]", float(stiffness[i - 1]), float(drag[i - 1]), place=rod.place)
        for i in cuts[1:-1]
    ]
    pieces = [_piece(rod, lengths, start, end) for start, end in itertools.pairwise(cuts)]
    typical = float(np.median(masses))
    extra = [max(float(masses[at]) - typical, 0.0) for at in (0, -1)]
    bodies = [mass if mass > _HEAVIER * typical else 0.0 for mass in extra]
    first, last = ((math.inf if n else 0.0, math.inf if n > 1 else 0.0) for n in (near, far))
    return PlanarChain(tuple(pieces), tuple(springs), first, last, bodies=(bodies[0], bodies[1]))


def _piece(rod: ModelRod, lengths: Floats, start: int, end: int) -> Piece:
    """Return points as one piece, of those at its ends half, but whole at the rod's."""
    places = np.concatenate([[0.0], np.cumsum(lengths[start:end])])
    shares = rod.masses[start : end + 1].copy()
    if start:
        shares[0] /= 2
    if end < len(rod.masses) - 1:
        shares[-1] /= 2
    mass = float(shares.sum())
    centre = float(shares @ places) / mass
    return Piece(float(places[-1]), mass, centre, float(shares @ (places - centre) ** 2))


def _lengths(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _leading(held: Sequence[bool]) -> int:
    return next((i for i, each in enumerate(held) if not each), len(held))
