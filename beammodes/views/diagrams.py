"""Diagrams of a beam or a structure under loads: moment, shear and axial force, deflection or rotation."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from beammodes.accuracy.loaded_structures import StructureStatics
from beammodes.checks import choice, positive_real, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.structure import Member
from beammodes.views.symbols import COLOURS, EDGE

if TYPE_CHECKING:
    import matplotlib.axes
    from matplotlib.axes import Axes
else:
    matplotlib = Deferred("matplotlib")

__all__ = ["DIAGRAMS", "draw_statics"]


class _Diagram(NamedTuple):
    """What is drawn: its name, its unit, its colour, and the values before and behind a place."""

    label: str
    unit: str
    colour: str
    along: Callable[[StructureStatics, Floats, str, int], Floats]


#: What may be drawn.
DIAGRAMS = MappingProxyType(
    {
        "moment": _Diagram("bending moment", "N m", COLOURS[0], lambda s, x, m, side: s.moment(x, m, side)),
        "shear": _Diagram("shear force", "N", COLOURS[1], lambda s, x, m, side: s.shear(x, m, side)),
        "axial_force": _Diagram(
            "axial force", "N", COLOURS[4], lambda s, x, m, side: s.axial_force(x, m, side)
        ),
        "deflection": _Diagram("deflection", "m", COLOURS[2], lambda s, x, m, _: s.deflection(x, m)),
        "rotation": _Diagram("rotation", "rad", COLOURS[3], lambda s, x, m, side: s.rotation(x, m, side)),
    }
)
#: Points between two edges.
_POINTS = 41
#: What is below this part of the largest value is zero, and two values nearer than this are one.
_NOTHING, _SAME = 1e-9, 0.02


def draw_statics(
    statics: StructureStatics,
    ax: matplotlib.axes.Axes | None = None,
    *,
    quantity: str = "moment",
    amplitude: float = 0.2,
    size: float = 10.0,
) -> matplotlib.axes.Axes:
    """Draw a diagram of a beam, a chain or a structure under loads.

    Of one member over its length, positive values up. Of several across each member, positive values to the
    left of one who goes along it, to one scale. Numbers stand at the largest and the smallest value, in
    frames of each member. A moment is positive where it bends the member to the left (up), so that its right
    (lower) side is in tension; signs of shear, deflection and rotation are those of `StructureStatics`.

    Parameters
    ----------
    statics : StructureStatics
        From `beam_statics`, `chain_statics`, `structure_statics` or `structure_chain_statics`.
    ax : matplotlib.axes.Axes, optional
        Of a frame it becomes a picture: equal scales, no frame. By default it is one of a new figure, which
        a notebook shows where the answer is the last line of a cell.
    quantity : str
        "moment" [N m], "shear" [N], "axial_force" [N] (tension positive), "deflection" [m] or
        "rotation" [rad].
    amplitude : float
        Of a frame: how far the largest value reaches, in larger sides of the structure.
    size : float [pt]
        Of the numbers.

    Returns
    -------
    matplotlib.axes.Axes
        What was drawn into.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Examples
    --------
    >>> import beammodes as bm
    >>> pushed = bm.beam_statics(bm.Beam(4.0, 3.0, 1.0), "pinned-pinned", bm.PointLoad(1.0, force=-8.0))
    >>> ax = bm.draw_statics(pushed, quantity="shear")
    >>> ax.get_ylabel(), [text.get_text() for text in ax.texts]
    ('shear force [N]', ['6', '−2'])
    """
    if not isinstance(statics, StructureStatics):
        raise TypeError(
            "statics must be StructureStatics, which beam_statics gives of loads with their sizes "
            f"(PointLoad, LineLoad, Load), got {shown(statics)}"
        )
    kind = DIAGRAMS[choice("quantity", quantity, DIAGRAMS)]
    reach, points = positive_real("amplitude", amplitude), positive_real("size", size)
    ax = _axes(ax)
    members = statics.structure.members
    courses = [_course(statics, kind, member) for member in members]
    if len(members) == 1:
        _draw_over_length(ax, statics, kind, *courses[0], points)
    else:
        _draw_frame(ax, statics, kind, courses, reach, points)
    return ax


def _axes(ax: object) -> Axes:
    from matplotlib.axes import Axes

    from beammodes.views.own_axes import own_axes

    if ax is None:
        return own_axes()
    if not isinstance(ax, Axes) or ax.name == "3d":
        raise TypeError(f"ax must be the Axes of a Matplotlib figure, in the plane, got {shown(ax)}")
    return ax


def _course(statics: StructureStatics, kind: _Diagram, member: Member) -> tuple[Floats, Floats]:
    """Return positions along a member and values there, both values at a jump."""
    edges = statics.edges(member.name)
    x, values = [], []
    for start, stop in itertools.pairwise(edges.tolist()):
        between = np.linspace(start, stop, _POINTS)
        x.append(between)
        values.append(
            np.concatenate(
                [
                    kind.along(statics, between[:1], member.name, 1),
                    kind.along(statics, between[1:], member.name, -1),
                ]
            )
        )
    return np.concatenate(x), np.concatenate(values)


def _extremes(values: Floats, largest: float) -> list[int]:
    """Return where the largest and the smallest value are; one, where the other is zero or nearer to it."""
    high, low = int(np.argmax(values)), int(np.argmin(values))
    told = [i for i in (high, low) if abs(values[i]) > _NOTHING * largest]
    if len(told) == 2 and abs(values[high] - values[low]) <= _SAME * largest:
        return told[:1]
    # Of two of one sign the one further from zero is told.
    if len(told) == 2 and values[high] * values[low] > 0.0:
        return [max(told, key=lambda i: abs(values[i]))]
    return told


def _number(value: float) -> str:
    return f"{value:.4g}".replace("-", "−")


def _draw_over_length(
    ax: Axes, statics: StructureStatics, kind: _Diagram, x: Floats, values: Floats, size: float
) -> None:
    ax.fill_between(x, values, color=kind.colour, alpha=0.2, linewidth=0)
    ax.plot(np.concatenate([x[:1], x, x[-1:]]), [0.0, *values, 0.0], color=kind.colour, linewidth=1.6)
    ax.axhline(0.0, color=EDGE, linewidth=2.0, zorder=2.5)
    for node in statics.structure.parts.nodes:
        if node.supports or node.rotational_stiffness:
            ax.plot(node.place[0] - statics.structure.parts.nodes[0].place[0], 0.0, "^", color=EDGE, zorder=3)
    ax.set_xlabel("x [m]")
    ax.set_ylabel(f"{kind.label} [{kind.unit}]")
    ax.margins(x=0.02, y=0.15)
    length = statics.structure.members[0].beam.length
    for i in _extremes(values, float(np.abs(values).max())):
        # Inside the axes at either end.
        align = "left" if x[i] < 0.1 * length else "right" if x[i] > 0.9 * length else "center"
        ax.annotate(
            _number(values[i]),
            (x[i], values[i]),
            (0, 0.4 * size * np.sign(values[i])),
            textcoords="offset points",
            ha=align,
            va="bottom" if values[i] > 0.0 else "top",
            fontsize=size,
        )


def _draw_frame(
    ax: Axes,
    statics: StructureStatics,
    kind: _Diagram,
    courses: list[tuple[Floats, Floats]],
    reach: float,
    size: float,
) -> None:
    from matplotlib.patheffects import withStroke

    joints = statics.structure.joints
    places = np.array([(joint.x, joint.y) for joint in joints.values()])
    largest = max(float(np.abs(values).max()) for _, values in courses)
    whole = float(np.ptp(places, axis=0).max())
    scale = reach * whole / largest if largest else 0.0
    for member, (x, values) in zip(statics.structure.members, courses, strict=True):
        start, end = (np.array((joints[name].x, joints[name].y)) for name in (member.start, member.end))
        axis = (end - start) / member.beam.length
        normal = np.array((-axis[1], axis[0]))
        line = start + x[:, None] * axis
        curve = line + scale * values[:, None] * normal
        ax.fill(*np.concatenate([curve, line[::-1]]).T, color=kind.colour, alpha=0.2, linewidth=0)
        ax.plot(*np.concatenate([line[:1], curve, line[-1:]]).T, color=kind.colour, linewidth=1.6)
        ax.plot(*np.array([start, end]).T, color=EDGE, linewidth=2.0, zorder=2.5)
        for i in _extremes(values, largest):
            way = np.sign(values[i]) * normal
            ax.annotate(
                _number(values[i]),
                tuple(curve[i]),
                tuple(0.7 * size * way),
                textcoords="offset points",
                ha="center" if abs(way[0]) < 0.5 else "left" if way[0] > 0 else "right",
                va="center",
                fontsize=size,
                path_effects=[withStroke(linewidth=2.5, foreground="white")],
            )
    held = np.array([(joint.x, joint.y) for joint in joints.values() if joint.support != (0.0, 0.0, 0.0)])
    ax.plot(*held.T, "^", color=EDGE, zorder=3, markersize=8)
    ax.set_title(f"{kind.label} [{kind.unit}]")
    ax.set_aspect("equal")
    ax.axis("off")
    ax.margins(0.12)
    ax.autoscale_view()
