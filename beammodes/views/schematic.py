"""A chain as a drawing: rods, hinges with their springs, what holds its ends, and the bodies on them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

from beammodes.chains.chain import Chain
from beammodes.checks import choice, flag, positive_real, shown
from beammodes.problem.ends import End
from beammodes.views.end_symbols import EndPlace, body_of, draw_body, draw_support, height_of_support
from beammodes.views.pose import Pose, Shape, pose_of
from beammodes.views.spring_labels import LABELS, draw_spring_labels, draw_support_labels
from beammodes.views.symbols import EDGE, draw_disc, draw_hinge, draw_rods, draw_spiral

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["MAX_DRAWN", "draw_chain"]

#: A drawing of more pieces than this shows nothing.
MAX_DRAWN = 500
#: Largest and smallest radius of a hinge's spring, in lengths of the chain.
_RADIUS, _TINY = 0.042, 0.008


def draw_chain(
    chain: Chain,
    ax: Axes,
    *,
    shape: Shape | None = None,
    mode: int = 1,
    amplitude: float = 0.15,
    labels: str | None = "EI/ell",
    ends: bool = True,
    size: float = 10.0,
) -> None:
    """Draw a chain of rigid segments as the report's Figures 3 and 5 do.

    Rods are blue, hinges circles, their springs orange spirals; dark what is welded to the ground, green the
    springs of elastic supports; a wall holds deflection and rotation, a triangle the deflection, a plate on
    rollers the rotation. Bodies are blocks of the size that their mass and rotary inertia give; dots are
    point masses, at the hinges too where a rule gathers its masses there.

    Parameters
    ----------
    chain : Chain
        Of at most 500 pieces.
    ax : matplotlib.axes.Axes
        Becomes a picture: equal scales, no frame; its limits grow to hold the drawing unless they were set.
    shape : Modes, Equilibrium, xarray.Dataset or pair of arrays, optional
        Where the chain is; straight by default. A mode from `solve_modes` about the straight chain; the
        bent shape from `find_equilibrium`; one moment of a motion from `simulate`, such as
        `motion.isel(time=-1)`; or deflections [m] of the nodes and rotations of the pieces, both small.
    mode : int
        Which one of the `Modes`.
    amplitude : float
        Its largest deflection in lengths of the chain; less where a piece would turn by more than 60°.
    labels : str or None
        Springs as "EI/ell" (of the mean EI), as fractions where they are exact, or in "N m/rad"; None
        writes none. Supports' springs, then, are in EI/L and EI/L³, or in N m/rad and N/m. The numbers of a
        chain from pieces are those given. Of more than 12 hinges, equal neighbours share a label.
    ends : bool
        Whether supports and bodies are drawn.
    size : float [pt]
        Of the labels.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain too long, or the shape not this chain's.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from beammodes.problem.beam import Beam
    >>> ax = Figure().subplots()
    >>> draw_chain(Chain(Beam.unit(), "clamped-free", segments=4), ax)
    >>> [text.get_text() for text in ax.texts]
    ['24/11', '1', '1', '1']
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if chain.pieces > MAX_DRAWN:
        raise ValueError(f"chain must have at most {MAX_DRAWN} pieces to be drawn, got {chain.pieces}")
    from matplotlib.axes import Axes

    if not isinstance(ax, Axes):
        raise TypeError(f"ax must be the Axes of a Matplotlib figure, got {shown(ax)}")
    unit, points = None if labels is None else choice("labels", labels, LABELS), positive_real("size", size)
    pose = pose_of(chain, shape, mode=mode, amplitude=amplitude)
    radius = _spring_radius(chain)
    _draw_rods(ax, chain, pose, radius)
    places = _places(chain, pose, radius) if flag("ends", ends) else ()
    # Labels stand in one row, above whatever is at the ends.
    lift = max([1.1 * radius, *_draw_ends(ax, chain, places)])
    for x, y in zip(pose.x[1:-1], pose.y[1:-1], strict=True):
        draw_spiral(ax, (x, y), radius, inner=0.42 * radius)
        draw_hinge(ax, (x, y), 0.3 * radius)
    if unit is not None:
        draw_spring_labels(ax, chain, pose, unit, lift=lift, size=points)
        draw_support_labels(ax, chain, places, unit, size=points)
    ax.set_aspect("equal")
    ax.axis("off")
    ax.margins(0.03)
    ax.autoscale_view()


def _spring_radius(chain: Chain) -> float:
    """Return the radius of the springs: neighbours must not touch."""
    whole = chain.node_position[-1]
    between = chain.length[chain.length > 0]
    return float(min(_RADIUS * whole, max(_TINY * whole, 0.4 * between.min())))


def _draw_ends(ax: Axes, chain: Chain, places: Sequence[EndPlace]) -> list[float]:
    """Draw supports and bodies and return how high they reach above their ends."""
    heights = []
    for place, (translation, rotation) in zip(places, chain.support_stiffness, strict=False):
        stiffness = (float(translation), float(rotation))
        draw_body(ax, place)
        draw_support(ax, stiffness, place)
        heights.append(max(height_of_support(stiffness, place.length), place.body.half))
    return heights


def _places(chain: Chain, pose: Pose, radius: float) -> tuple[EndPlace, EndPlace]:
    whole = float(chain.node_position[-1])

    def place(i: int, side: int, end: End) -> EndPlace:
        at, hinged = (float(pose.x[i]), float(pose.y[i])), chain.pieces > 1 and not chain.length[i]
        return EndPlace(at, float(pose.angle[i]), side, whole, radius, bool(hinged), body_of(end, whole))

    return place(0, -1, chain.boundary.left), place(-1, 1, chain.boundary.right)


def _draw_rods(ax: Axes, chain: Chain, pose: Pose, radius: float) -> None:
    # Rods that an end holds are the outer ones; one of length zero is only a place.
    for welded, run in itertools.groupby(range(chain.pieces), lambda i: chain.held_angles[i]):
        pieces = list(run)
        nodes = slice(pieces[0], pieces[-1] + 2)
        if any(chain.length[pieces]):
            draw_rods(ax, pose.x[nodes], pose.y[nodes], welded=welded)
    for node in sorted(_gathered(chain)):
        draw_disc(ax, (float(pose.x[node]), float(pose.y[node])), 0.5 * radius, colour=EDGE)


def _gathered(chain: Chain) -> set[int]:
    """Return the nodes at which point masses are: both tips of every rod with J = m l²/4."""
    rods = zip(chain.piece_length, chain.piece_mass, chain.piece_rotary_inertia, strict=True)
    heavy = [
        i for i, (length, mass, inertia) in enumerate(rods) if length and 4 * inertia == mass * length**2
    ]
    return {node for i in heavy for node in (i, i + 1)}
