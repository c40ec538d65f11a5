"""A chain's two ends as symbols: what holds them, and the rigid bodies fixed to them.

Sizes are in lengths of the chain. A body is drawn as the square block of its mass and rotary inertia, of side

    s = √(6 J/m),

its middle as far beyond the end as its centre of mass; as a dot where it is a point mass, as a wheel where it
has no mass. Where that would be too small or too large to draw, its size is a symbol's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beammodes.problem.ends import End
from beammodes.views.symbols import (
    EDGE,
    GROUND_SPRING,
    Point,
    draw_block,
    draw_coil,
    draw_disc,
    draw_ground,
    draw_pin,
    draw_slide,
    draw_spiral,
    placed,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Body", "EndPlace", "body_of", "draw_body", "draw_support", "height_of_support"]

_WALL, _PIN, _PLATE, _DOT, _WHEEL = 0.1, 0.085, 0.085, 0.038, 0.08
#: Smallest and largest side of a block, and furthest place of a body.
_SMALLEST, _LARGEST, _FURTHEST = 0.06, 0.35, 0.5
#: How far below the beam a spring stands on the ground, and the least that is seen of it.
_DROP, _SHORTEST = 0.24, 0.1


@dataclass(frozen=True)
class Body:
    """The symbol of the body on an end.

    Attributes
    ----------
    kind : str
        "none", "block", "dot" or "wheel".
    half : float [m]
        Half its size.
    offset : float [m]
        How far beyond the end its middle is.
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
    length : float [m]
        Of the whole chain.
    radius : float [m]
        Of the springs at hinges.
    hinged : bool
        Whether a hinge is at the tip itself.
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
    """Return the symbol of what an end carries, as far as its supports let it move.

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
    """Draw what ties an end to the ground: a wall, a pin or a slide, and springs where they give.

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
    """Draw a spiral about the tip, and what ties it to the ground under a pin or to a slide's plate."""
    inner = place.radius * (1.2 if place.hinged else 0.3)
    outward = 0.0 if place.side > 0 else math.pi
    start = -math.pi / 2 if grounded else outward
    draw_spiral(ax, place.at, place.reach, inner=inner, start=start, colour=GROUND_SPRING)
    far = _PIN * place.length if grounded else place.body.half + place.body.offset
    away = np.array([place.reach, max(place.reach, far)])
    x, y = place.at[0] + away * math.cos(start), place.at[1] + away * math.sin(start)
    ax.plot(x, y, color=GROUND_SPRING, linewidth=1.0, zorder=4)
