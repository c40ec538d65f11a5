"""Symbols of a schematic drawing in data coordinates: rods, hinges, springs, ground, supports, blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import End

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "BLOCK",
    "COLOURS",
    "EDGE",
    "GREY",
    "GROUND_SPRING",
    "ROD",
    "SPRING",
    "STYLE",
    "Body",
    "EndPlace",
    "Point",
    "body_of",
    "draw_block",
    "draw_body",
    "draw_coil",
    "draw_disc",
    "draw_ground",
    "draw_hinge",
    "draw_pin",
    "draw_rods",
    "draw_slide",
    "draw_spiral",
    "draw_support",
    "height_of_support",
    "placed",
]

Point = tuple[float, float]

#: Okabe and Ito's colours, which the colour-blind can tell apart; source: Color Universal Design (2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#767676"

#: Settings for `matplotlib.rc_context` under which the project's figures are drawn.
STYLE: Mapping[str, object] = MappingProxyType(
    {
        "font.size": 11,
        "font.family": "DejaVu Sans",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#DDDDDD",
        "grid.linewidth": 0.6,
        "axes.axisbelow": True,
        "lines.linewidth": 1.6,
        "lines.markersize": 4.5,
        "svg.hashsalt": "beammodes",
        "svg.fonttype": "path",
    }
)

#: Rods and hinges, springs between rods, springs to the ground, what is rigid, and its edges.
ROD, SPRING, GROUND_SPRING, BLOCK, EDGE = COLOURS[0], COLOURS[1], COLOURS[2], "#C9D8E6", "#44515C"


def placed(points: ArrayLike, at: Point, angle: float = 0.0) -> Floats:
    """Return points, shape (n, 2), turned counter-clockwise by an angle [rad] and then shifted.

    Examples
    --------
    >>> placed([[1.0, 0.0]], (2.0, 3.0), np.pi / 2).round(12)
    array([[2., 4.]])
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.asarray(np.asarray(points, dtype=np.float64) @ [[cosine, sine], [-sine, cosine]] + at)


def draw_rods(ax: Axes, x: ArrayLike, y: ArrayLike, *, welded: bool = False, width: float = 2.6) -> None:
    """Draw rods through nodes as straight lines; dark and thicker what is `welded` to the ground."""
    colour, thickness = (EDGE, 1.6 * width) if welded else (ROD, width)
    (line,) = ax.plot(np.asarray(x), np.asarray(y), color=colour, linewidth=thickness, zorder=3)
    line.set_solid_capstyle("butt" if welded else "round")


def draw_hinge(ax: Axes, at: Point, radius: float) -> None:
    """Draw a hinge as a circle; its gid is "hinge"."""
    from matplotlib.patches import Circle

    style = {"facecolor": "white", "edgecolor": ROD, "linewidth": 1.3, "zorder": 5}
    ax.add_patch(Circle(at, radius, gid="hinge", **style))


def draw_spiral(
    ax: Axes, at: Point, radius: float, *, inner: float, start: float = 0.0, colour: str = SPRING
) -> None:
    """Draw a rotational spring about a hinge, from an inner radius outwards, to end at angle `start`."""
    turn = np.linspace(0.0, 4.5 * np.pi, 180)
    away, angle = inner + (radius - inner) * turn / turn[-1], turn - turn[-1] + start
    x, y = at[0] + away * np.cos(angle), at[1] + away * np.sin(angle)
    ax.plot(x, y, color=colour, linewidth=1.0, zorder=4)


def draw_coil(ax: Axes, bottom: Point, top: Point, *, width: float, colour: str = SPRING) -> None:
    """Draw a spring that pushes two points apart, of half a `width` to either side."""
    along = np.subtract(top, bottom)
    swing = np.concatenate([[0.0, 0.0], np.resize([-width / 2, width / 2], 8), [0.0, 0.0]])
    points = np.column_stack([np.linspace(0.0, float(np.hypot(*along)), len(swing)), swing])
    x, y = placed(points, bottom, float(np.arctan2(along[1], along[0]))).T
    ax.plot(x, y, color=colour, linewidth=1.4, zorder=1.7)


def draw_ground(ax: Axes, at: Point, width: float, *, angle: float = 0.0, depth: float) -> None:
    """Draw fixed ground: a line of some width about a point, hatched on its lower side.

    An angle of -90° makes a wall on the left of what it holds, 90° one on the right.
    """
    from matplotlib.collections import LineCollection

    count = max(3, round(width / depth))
    start = (np.arange(count) + 0.75) / count * width - width / 2
    ends = (
        np.column_stack([start, 0 * start]),
        np.column_stack([start - 0.75 * width / count, 0 * start - depth]),
    )
    strokes = np.stack([placed(end, at, angle) for end in ends], axis=1)
    ax.add_collection(LineCollection(list(strokes), colors=EDGE, linewidths=0.8, zorder=1))
    x, y = placed([[-width / 2, 0.0], [width / 2, 0.0]], at, angle).T
    ax.plot(x, y, color=EDGE, linewidth=1.5, solid_capstyle="butt", zorder=1.5)


def draw_pin(ax: Axes, at: Point, size: float, *, angle: float = 0.0, rolls: bool = False) -> None:
    """Draw a support that holds a point: a triangle of height `size` on the ground, or on rollers.

    Upright at the angle 0 [rad], and turned counter-clockwise about the point.
    """
    from matplotlib.patches import Circle, Polygon

    triangle = placed([[0.0, 0.0], [-0.58 * size, -size], [0.58 * size, -size]], at, angle)
    ax.add_patch(Polygon(triangle, facecolor="white", edgecolor=EDGE, linewidth=1.2, zorder=2.3))
    ax.add_patch(Circle(at, 0.17 * size, facecolor="white", edgecolor=EDGE, linewidth=1.2, zorder=4.5))
    roller = 0.16 * size if rolls else 0.0
    for across in (-0.35 * size, 0.35 * size) if rolls else ():
        x, y = placed([[across, -size - roller]], at, angle)[0]
        ax.add_patch(Circle((x, y), roller, facecolor="white", edgecolor=EDGE, linewidth=1.1, zorder=2.3))
    x, y = placed([[0.0, -size - 2 * roller]], at, angle)[0]
    draw_ground(ax, (float(x), float(y)), 1.9 * size, angle=angle, depth=0.28 * size)


def draw_slide(ax: Axes, at: Point, size: float, *, side: int, angle: float = 0.0, rest: float = 0.0) -> None:
    """Draw a support that holds a direction: a plate on two rollers that run along a wall.

    The middle of the plate's inner face is `at`, half its height `size`; the wall is left of it where `side`
    is -1, and right of it where that is 1. It reaches to `rest`, where along it the plate is at rest.
    """
    from matplotlib.patches import Circle

    plate, roller = 0.22 * size, 0.2 * size
    draw_block(ax, at, angle, (min(0.0, side * plate), -size, plate, 2 * size), zorder=1.9)
    for height in (-0.75 * size, 0.75 * size):
        centre = placed([[side * (plate + roller), height]], at, angle)[0]
        circle = {"facecolor": "white", "edgecolor": EDGE, "linewidth": 1.1, "zorder": 1.9}
        ax.add_patch(Circle((float(centre[0]), float(centre[1])), roller, **circle))
    low, high = min(rest, 0.0) - 1.5 * size, max(rest, 0.0) + 1.5 * size
    foot = placed([[side * (plate + 2 * roller), (low + high) / 2]], at, angle)[0]
    wall = angle + side * np.pi / 2
    draw_ground(ax, (float(foot[0]), float(foot[1])), high - low, angle=wall, depth=0.35 * size)


def draw_block(
    ax: Axes,
    at: Point,
    angle: float,
    box: tuple[float, float, float, float],
    *,
    colour: str = BLOCK,
    edge: str = EDGE,
    zorder: float = 2,
) -> None:
    """Draw a rigid rectangle (left, bottom, width, height; seen from a point) that turns about that point."""
    from matplotlib.patches import Polygon

    left, bottom, width, height = box
    right, top = left + width, bottom + height
    corners = placed([[left, bottom], [right, bottom], [right, top], [left, top]], at, angle)
    ax.add_patch(Polygon(corners, facecolor=colour, edgecolor=edge, linewidth=1.0, zorder=zorder))


def draw_disc(ax: Axes, at: Point, radius: float, *, colour: str = BLOCK, spoke: float | None = None) -> None:
    """Draw a point mass, or, with a `spoke` at an angle [rad] to show how it turns, a wheel."""
    from matplotlib.patches import Circle

    ax.add_patch(Circle(at, radius, facecolor=colour, edgecolor=EDGE, linewidth=1.2, zorder=2))
    if spoke is not None:
        x, y = placed([[0.0, -radius], [0.0, radius]], at, spoke).T
        ax.plot(x, y, color=EDGE, linewidth=1.2, zorder=2.1)


# Sizes of symbols at the ends, in lengths of the chain.
_WALL, _PIN, _PLATE, _DOT, _WHEEL = 0.1, 0.085, 0.085, 0.038, 0.08
#: Smallest and largest side of a block, and furthest place of a body.
_SMALLEST, _LARGEST, _FURTHEST = 0.06, 0.35, 0.5
#: How far below the beam a spring stands on the ground, and the least that is seen of it.
_DROP, _SHORTEST = 0.24, 0.1


@dataclass(frozen=True)
class Body:
    """The symbol of a body on an end: "none", "block", "dot" or "wheel".

    `half` is half its size [m], `offset` [m] the distance of its middle beyond the end.
    """

    kind: str
    half: float
    offset: float


@dataclass(frozen=True)
class EndPlace:
    """An end of the chain in the picture.

    Attributes
    ----------
    at : tuple of float [m]
        The tip.
    angle : float [rad]
        Of the outer piece.
    side : int
        -1 for the left end, 1 for the right one.
    length, radius : float [m]
        Of the whole chain, and of the springs at its hinges.
    hinged : bool
        A hinge is at the tip itself.
    body : Body
    """

    at: Point
    angle: float
    side: int
    length: float
    radius: float
    hinged: bool
    body: Body

    @property
    def reach(self) -> float:
        """Radius of the end's own rotational spring, which lies around that of a hinge in the same place."""
        return self.radius * (1.9 if self.hinged else 1.25)


def body_of(end: End, length: float) -> Body:
    """Return the symbol of the body on an end, as far as its supports let it move.

    A block has the side √(6 J/m) of a square of that mass and rotary inertia; a point mass is a dot, and a
    body without mass a wheel. What would be too small or too large to draw has the size of a symbol.

    Examples
    --------
    >>> body_of(End(mass=3.0, rotary_inertia=0.02, offset=0.1), length=1.0)
    Body(kind='block', half=0.1, offset=0.1)
    """
    mass, inertia, offset = (float(number) for number in end.moving_body)
    beyond = length * min(_FURTHEST, max(-_FURTHEST, offset / length))
    if mass and inertia:
        side = min(_LARGEST, max(_SMALLEST, math.sqrt(6 * inertia / mass) / length))
        return Body("block", side / 2 * length, beyond)
    if mass:
        return Body("dot", _DOT * length, beyond)
    return Body("wheel", _WHEEL * length, 0.0) if inertia else Body("none", 0.0, 0.0)


def height_of_support(stiffness: Point, length: float) -> float:
    """Return how high above the end the symbol of K_t and K_r reaches [m]."""
    translation, rotation = stiffness
    if translation == math.inf:
        return _WALL * length if rotation == math.inf else 0.0
    return 1.5 * _PLATE * length if rotation else 0.0


def draw_body(ax: Axes, place: EndPlace) -> None:
    """Draw the body on an end, and the arm that carries one further out."""
    body = place.body
    x, y = placed([[0.0, 0.0], [place.side * body.offset, 0.0]], place.at, place.angle).T
    centre, half = (float(x[1]), float(y[1])), body.half
    if abs(body.offset) > half:
        ax.plot(x, y, color=EDGE, linewidth=3.0, solid_capstyle="butt", zorder=1.9)
    if body.kind == "block":
        draw_block(ax, centre, place.angle, (-half, -half, 2 * half, 2 * half))
    elif body.kind == "dot":
        draw_disc(ax, centre, half, colour=EDGE)
    elif body.kind == "wheel":
        draw_disc(ax, centre, half, spoke=place.angle)


def draw_support(ax: Axes, stiffness: Point, place: EndPlace) -> None:
    """Draw an end's support: a wall, a pin or a slide, and springs where it gives.

    `stiffness` holds K_t and K_r, inf where the end is held.
    """
    translation, rotation = stiffness
    length, at, held = place.length, place.at, rotation == math.inf
    if translation == math.inf and held:
        wall = place.angle + place.side * math.pi / 2
        draw_ground(ax, at, 2 * _WALL * length, angle=wall, depth=0.032 * length)
    elif translation == math.inf:
        draw_pin(ax, at, _PIN * length)
    elif rotation:
        apart = 0.0 if held else place.side * max(place.reach, place.body.half + place.body.offset)
        rest = -at[1] if abs(at[1]) < length / 2 else 0.0
        angle = place.angle if held else 0.0
        draw_slide(ax, (at[0] + apart, at[1]), _PLATE * length, side=place.side, angle=angle, rest=rest)
    if 0.0 < rotation < math.inf:
        _draw_turning_spring(ax, place, grounded=translation == math.inf)
    if 0.0 < translation < math.inf:
        lowest = at[1] - _SHORTEST * length
        foot = (at[0], min(-_DROP * length, lowest, lowest - place.body.half))
        draw_coil(ax, foot, at, width=0.07 * length, colour=GROUND_SPRING)
        draw_ground(ax, foot, 0.16 * length, depth=0.024 * length)


def _draw_turning_spring(ax: Axes, place: EndPlace, *, grounded: bool) -> None:
    """Draw a spiral about the tip, and a line from it to the ground under a pin or to a slide's plate."""
    inner = place.radius * (1.2 if place.hinged else 0.3)
    outward = 0.0 if place.side > 0 else math.pi
    start = -math.pi / 2 if grounded else outward
    draw_spiral(ax, place.at, place.reach, inner=inner, start=start, colour=GROUND_SPRING)
    far = _PIN * place.length if grounded else place.body.half + place.body.offset
    away = np.array([place.reach, max(place.reach, far)])
    x, y = place.at[0] + away * math.cos(start), place.at[1] + away * math.sin(start)
    ax.plot(x, y, color=GROUND_SPRING, linewidth=1.0, zorder=4)
