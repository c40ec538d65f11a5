"""Drawings of a chain in space, to one scale in three axes: pieces, hinges and ends, at rest or moved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import positive_real, shown, whole_number
from beammodes.equations.equilibria_in_space import SpatialEquilibrium
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import rotation
from beammodes.problem.ends import ENDS
from beammodes.problem.rod_ends import RodEnd
from beammodes.vibration.modes_in_space import SpatialModes
from beammodes.views.symbols import EDGE, GREY, ROD

__all__ = ["SEEN", "PoseInSpace", "draw_in_space", "pose_in_space"]

#: Half the width of a flat section's mark, in sizes of the drawing.
_FLAT = 0.045
#: How far an end's label stands off on the picture, across and up, likewise.
_BESIDE, _OVER = 0.2, 0.085
#: An axis is at least so long beside the longest, so that its numbers can be read.
_THINNEST = 0.3
#: Looking down a little and from aside, so that no axis of the section at s = 0 is seen along itself.
_ABOVE, _ASIDE = 22.0, -58.0
#: How much of the axes the box fills, less than Matplotlib's cube does, for the names beside it.
_FILLED = 1.3
#: Part of each axis that has numbers.
_NUMBERED = 0.85


#: Unit vectors to the right and up on the picture.
_UP, _ROUND = np.radians([_ABOVE, _ASIDE])
SEEN: Floats = np.array(
    [
        [-np.sin(_ROUND), np.cos(_ROUND), 0.0],
        [-np.sin(_UP) * np.cos(_ROUND), -np.sin(_UP) * np.sin(_ROUND), np.cos(_UP)],
    ]
)


@dataclass(frozen=True, eq=False)
class PoseInSpace:
    """The place of a chain in space.

    Attributes
    ----------
    nodes : ndarray, shape (nodes, 3) [m]
        From the start over every hinge to the end, each once.
    turned : ndarray, shape (hinges, 3, 3)
        How the piece after each hinge has turned from rest.
    """

    nodes: Floats
    turned: Floats


def pose_in_space(
    chain: SpatialChain, shape: object = None, *, mode: int = 1, amplitude: float = 0.15
) -> PoseInSpace:
    """Return the place of a chain in space; the arguments are those of `draw_chain`.

    Raises
    ------
    TypeError, ValueError
        If `shape` is of no known kind or not of this chain.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.SpatialChain(bm.Rod(1.0, 1.0, 1.0, 1.0), "clamped-free", segments=2)
    >>> pose_in_space(chain).nodes.tolist()
    [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    rest, hinges = chain.nodes, len(chain.hinge_position)
    if shape is None:
        return PoseInSpace(rest, np.broadcast_to(np.eye(3), (hinges, 3, 3)))
    if isinstance(shape, SpatialEquilibrium):
        if shape.chain is not chain:
            raise ValueError(f"shape must be of this chain, got one of {shown(shape.chain)}")
        # A hinge at an end is between the rod and a piece without length.
        places = np.concatenate([[0.0], chain.hinge_position, [chain.rod.length]])
        return PoseInSpace(shape.nodes[np.unique(places, return_index=True)[1]], shape.rotation[1:])
    if not isinstance(shape, SpatialModes):
        raise TypeError(
            f"shape must be None, SpatialModes or a SpatialEquilibrium in space, got {shown(shape)}"
        )
    if shape.position.shape != rest.shape or not np.allclose(shape.position, rest, atol=1e-9 * np.ptp(rest)):
        raise ValueError("shape must be of this chain, got modes of another")
    row = whole_number("mode", mode, most=len(shape.angular_frequency)) - 1
    scale = positive_real("amplitude", amplitude) * chain.rod.length
    moved, turned = shape.displacement[row], shape.rotation[row, 1:]
    largest = np.sqrt((moved**2).sum(axis=1).max())
    # A mode of twist alone moves no node: its pieces turn by the amplitude.
    scale /= largest if largest > 0 else chain.rod.length * np.abs(turned).max()
    return PoseInSpace(rest + scale * moved, rotation(scale * turned))


def draw_in_space(
    chain: SpatialChain,
    ax: Any,
    *,
    shape: object,
    mode: int,
    amplitude: float,
    ends: bool,
    size: float,
) -> None:
    """Draw a chain in space; the arguments are those of `draw_chain`."""
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import MaxNLocator

    pose, rest = pose_in_space(chain, shape, mode=mode, amplitude=amplitude), pose_in_space(chain)
    ax.computed_zorder = False
    if shape is not None:
        ax.plot(*rest.nodes.T, color=GREY, linewidth=1.0, zorder=1)
    wide = _FLAT * np.ptp(np.concatenate([rest.nodes, pose.nodes]), axis=0).max()
    for flat in _flats(chain, pose, wide):
        ax.plot(*flat.T, color=GREY, linewidth=1.4, solid_capstyle="butt", zorder=2)
    ax.plot(*pose.nodes.T, color=ROD, linewidth=2.4, solid_joinstyle="round", zorder=3)
    at = np.isin(chain.node_position, chain.hinge_position)
    ax.plot(
        *pose.nodes[at].T,
        linestyle="",
        marker="o",
        markersize=4.5,
        markerfacecolor="white",
        markeredgecolor=ROD,
        markeredgewidth=1.2,
        zorder=6,
        gid="hinge",
    )
    if ends:
        for at_end, end, text in ((0, chain.ends.left, "s = 0"), (-1, chain.ends.right, "s = L")):
            _draw_end(ax, pose.nodes[at_end], end)
            place = _free_place(pose.nodes[at_end], np.concatenate([pose.nodes, rest.nodes]))
            words = {"fontsize": size, "color": EDGE, "ha": "center", "va": "center", "zorder": 7}
            edge = [withStroke(linewidth=2.5, foreground="white")]
            ax.text(*place, f"{text}, {_word(end)}", path_effects=edge, **words)
    # One scale for all axes: the box has the proportions of what is drawn.
    low = np.array([*ax.xy_dataLim.min, ax.zz_dataLim.min[0]])
    high = np.array([*ax.xy_dataLim.max, ax.zz_dataLim.max[0]])
    half = 0.55 * np.maximum(high - low, _THINNEST * (high - low).max())
    # Matplotlib gives every box the same diagonal, so that a long one would leave the picture.
    ax.set_box_aspect(tuple(half), zoom=_FILLED / (1.9 * np.abs(SEEN) @ half / np.linalg.norm(half)).max())
    for axis, middle, reach in zip((ax.xaxis, ax.yaxis, ax.zaxis), (low + high) / 2, half, strict=True):
        name = axis.axis_name
        getattr(ax, f"set_{name}lim")(middle - reach, middle + reach)
        # Numbers near a corner of the box would meet those of the next axis.
        ticks = MaxNLocator(max(2, round(4 * reach / half.max()))).tick_values(middle - reach, middle + reach)
        axis.set_ticks(ticks[np.abs(ticks - middle) < _NUMBERED * reach])
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.line.set_color(EDGE)
        axis.set_tick_params(labelsize=0.85 * size, pad=7 if name == "z" else -1)
        axis.set_label_text(f"{name}  [m]", fontsize=size)
        axis.labelpad = 7.0 if name == "y" else 14.0
    ax.set_proj_type("ortho")
    ax.view_init(_ABOVE, _ASIDE)


def _flats(chain: SpatialChain, pose: PoseInSpace, half: float) -> list[Floats]:
    """Return a mark at each hinge along its section's stiffer direction; none where both are the same."""
    about_y, about_z = chain.joint_stiffness[:, 1], chain.joint_stiffness[:, 2]
    frames, places = chain.rod.frames(chain.hinge_position)
    nodes = pose.nodes[np.searchsorted(chain.node_position, chain.hinge_position)]
    found = []
    for j in range(len(places)):
        if not np.isclose(about_y[j], about_z[j], rtol=1e-9):
            # Stiff about z is wide along y.
            way = pose.turned[j] @ frames[j, :, 1 if about_z[j] > about_y[j] else 2]
            found.append(np.array([nodes[j] - half * way, nodes[j] + half * way]))
    return found


def _word(end: RodEnd) -> str:
    """Return what an end is in a word or two."""
    named = [name for name in ENDS if RodEnd.of(name).stiffness.tolist() == end.stiffness.tolist()]
    return (named[0] if named else "springs") + (" + body" if end.has_body else "")


def _draw_end(ax: Any, place: Floats, end: RodEnd) -> None:
    """Mark an end by a square if something holds it, and by a disc if it has a body."""
    looks = {"linestyle": "", "color": EDGE, "zorder": 5}
    if end.stiffness.any():
        ax.plot(*place[:, None], marker="s", markersize=8, gid="held", **looks)
    if end.has_body:
        ax.plot(*place[:, None], marker="o", markersize=10, gid="body", **looks)


def _free_place(end: Floats, nodes: Floats) -> Floats:
    """Return a place for an end's label where the picture has no nodes near, above the end if possible."""
    angle = np.radians([90, 270, 60, 120, 240, 300, 0, 180])
    stands_off = np.ptp(nodes, axis=0).max() * np.array([_BESIDE, _OVER])
    tried = end + stands_off * np.column_stack([np.cos(angle), np.sin(angle)]) @ SEEN
    apart = (tried[:, None] - nodes) @ SEEN.T / stands_off
    free = np.minimum(np.linalg.norm(apart, axis=2).min(axis=1), 0.95)
    place: Floats = tried[free.argmax()]
    return place
