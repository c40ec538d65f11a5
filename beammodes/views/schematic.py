"""Drawings of a chain in any place: rods, hinges, springs, supports and bodies, with springs as labels."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.loaded_structures import StructureStatics
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import choice, flag, instead, positive_real, real_numbers, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.equations.equilibria import Equilibrium
from beammodes.equations.equilibria_in_space import SpatialEquilibrium
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import End
from beammodes.vibration.modes import Modes
from beammodes.vibration.modes_in_space import SpatialModes
from beammodes.vibration.structure_vibration import StructureChainModes
from beammodes.views.schematic_in_space import draw_in_space
from beammodes.views.schematic_of_structures import draw_structure
from beammodes.views.symbols import (
    EDGE,
    GROUND_SPRING,
    SPRING,
    EndPlace,
    body_of,
    draw_body,
    draw_disc,
    draw_hinge,
    draw_rods,
    draw_spiral,
    draw_support,
    height_of_support,
)

if TYPE_CHECKING:
    import matplotlib.axes
    import xarray
    from matplotlib.axes import Axes
else:
    matplotlib, xarray = Deferred("matplotlib"), Deferred("xarray")

__all__ = ["LABELS", "Pose", "Shape", "draw_chain", "pose_of", "spring_texts", "support_texts"]

#: A drawing of more pieces than this shows nothing.
_MAX_DRAWN = 500
#: Largest and smallest radius of a hinge's spring, in lengths of the chain.
_RADIUS, _TINY = 0.042, 0.008
#: Units in which springs may be written.
LABELS = ("EI/ell", "N m/rad")
#: Up to so many hinges every spring has its label; of more, equal neighbours share one.
_CROWD = 12
#: More labels than this cannot be read.
_MOST = 60
#: Larger fractions are written as decimals.
_LARGEST = 99
#: Room for a label above and beside its place, in lengths of the chain.
_ABOVE, _BESIDE = 0.11, 0.09


def draw_chain(
    chain: Chain | StructureChain | SpatialChain,
    ax: matplotlib.axes.Axes | None = None,
    *,
    shape: Shape | None = None,
    mode: int = 1,
    amplitude: float = 0.15,
    labels: str | None = "EI/ell",
    ends: bool = True,
    size: float = 10.0,
) -> matplotlib.axes.Axes:
    """Draw a chain of rigid segments as the report's Figures 3 and 5 do, one of a structure, or one in space.

    Rods are blue, hinges circles, their springs orange spirals; what is welded to the ground is dark, springs
    of elastic supports are green; a wall holds deflection and rotation, a triangle the deflection, a plate on
    rollers the rotation. Bodies are blocks of the size that their mass and rotary inertia give; dots are
    point masses, at the hinges too where a rule gathers its masses there.

    A chain of a structure is drawn likewise. Where several hinges meet at a joint, each stands beside it, on
    the member that it holds; a hinge without a spring is a pin. A triangle on rollers holds one direction. A
    thin grey line is where the structure is at rest.

    A chain in space is drawn in three axes [m], those of its section at s = 0, to one scale: pieces blue,
    hinges circles, an end that something holds a dark square, a body a dark disc. A grey mark across each
    hinge shows the stiffer direction of a section that has one; a thin grey line is where the chain is at
    rest.

    Parameters
    ----------
    chain : Chain, StructureChain or SpatialChain
        Of at most 500 pieces.
    ax : matplotlib.axes.Axes, optional
        Becomes a picture: equal scales, no frame; its limits grow to hold the drawing unless they were set.
        For a chain in space it must be of projection "3d". By default it is one of a new figure, which a
        notebook shows where the answer is the last line of a cell.
    shape : Modes, Equilibrium, xarray.Dataset or pair of arrays, optional
        Where the chain is; straight by default. A mode from `solve_modes` about the straight chain; the
        bent shape from `find_equilibrium`; one moment of a motion from `simulate`, such as
        `motion.isel(time=-1)`; or deflections [m] of the nodes and rotations of the pieces, both small.
        In space: `SpatialModes` from `spatial_modes`, or a shape from `spatial_equilibrium`. Of a structure:
        `StructureChainModes` of this chain, or its statics, also drawn to the amplitude.
    mode : int
        Which one of the modes.
    amplitude : float
        Its largest deflection in lengths of the chain, or in larger sides of a structure; less where a piece
        would turn by more than 60°.
    labels : str or None
        Springs as "EI/ell" (of the mean EI), as fractions where they are exact, or in "N m/rad"; None
        writes none. Supports' springs, then, are in EI/L and EI/L³, or in N m/rad and N/m. The numbers of a
        chain from pieces are those given. Of more than 12 hinges, equal neighbours share a label. A
        structure has the mean EI of each stretch over its longest segment, of the first one where two meet;
        its supports' springs have none. A chain in space has three springs at each hinge and writes none.
    ends : bool
        Draw supports and bodies; in space, name the ends too.
    size : float [pt]
        Of the labels.

    Returns
    -------
    matplotlib.axes.Axes
        What was drawn into.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain too long, or the shape not this chain's.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> import beammodes as bm
    >>> ax = Figure().subplots()
    >>> ax = bm.draw_chain(bm.Chain(bm.Beam.unit(), "clamped-free", segments=4), ax)
    >>> [text.get_text() for text in ax.texts]
    ['24/11', '1', '1', '1']
    >>> arc = bm.Rod.arc(1.5, length=1.0, bending_stiffness=1.0, torsional_stiffness=1.0, mass_per_length=1.0)
    >>> [text.get_text() for text in bm.draw_chain(bm.SpatialChain(arc, "clamped-free", segments=4)).texts]
    ['s = 0, clamped', 's = L, free']
    """
    if not isinstance(chain, Chain | StructureChain | SpatialChain):
        raise TypeError(
            f"chain must be a Chain, a StructureChain or a SpatialChain, got {shown(chain)}"
            f"{instead(chain, Structure='StructureChain(structure, segments) makes one')}"
        )
    in_space, pieces = isinstance(chain, SpatialChain), _pieces(chain)
    if pieces > _MAX_DRAWN:
        raise ValueError(f"chain must have at most {_MAX_DRAWN} pieces to be drawn, got {pieces}")
    unit, points = None if labels is None else choice("labels", labels, LABELS), positive_real("size", size)
    ax = _axes(ax, in_space=in_space)
    if isinstance(chain, SpatialChain):
        draw_in_space(
            chain, ax, shape=shape, mode=mode, amplitude=amplitude, ends=flag("ends", ends), size=points
        )
        return ax
    if isinstance(chain, StructureChain):
        draw_structure(
            chain,
            ax,
            shape=shape,
            mode=mode,
            amplitude=amplitude,
            unit=unit,
            ends=flag("ends", ends),
            size=points,
        )
    else:
        _draw_beam(ax, chain, shape, mode, amplitude, unit, flag("ends", ends), points)
    ax.set_aspect("equal")
    ax.axis("off")
    ax.margins(0.03)
    ax.autoscale_view()
    return ax


def _pieces(chain: Chain | StructureChain | SpatialChain) -> int:
    if isinstance(chain, StructureChain):
        return sum(pieces.pieces for pieces in chain.chains)
    return chain.tree.pieces if isinstance(chain, SpatialChain) else chain.pieces


def _draw_beam(
    ax: Axes,
    chain: Chain,
    shape: Shape | None,
    mode: int,
    amplitude: float,
    unit: str | None,
    ends: bool,
    points: float,
) -> None:
    pose = pose_of(chain, shape, mode=mode, amplitude=amplitude)
    radius = _spring_radius(chain)
    _draw_rods(ax, chain, pose, radius)
    places = _places(chain, pose, radius) if ends else ()
    # Labels stand in one row, above whatever is at the ends.
    lift = max([1.1 * radius, *_draw_ends(ax, chain, places)])
    for x, y in zip(pose.x[1:-1], pose.y[1:-1], strict=True):
        draw_spiral(ax, (x, y), radius, inner=0.42 * radius)
        draw_hinge(ax, (x, y), 0.3 * radius)
    if unit is not None:
        _draw_spring_labels(ax, chain, pose, unit, lift=lift, size=points)
        _draw_support_labels(ax, chain, places, unit, size=points)


def _axes(ax: object, *, in_space: bool) -> Axes:
    from matplotlib.axes import Axes

    from beammodes.views.own_axes import own_axes

    if ax is None:
        return own_axes(in_space=in_space)
    if not isinstance(ax, Axes):
        raise TypeError(f"ax must be the Axes of a Matplotlib figure, got {shown(ax)}")
    if (ax.name == "3d") != in_space:
        kind, other = ("in space", '"3d"') if in_space else ("in the plane", '"rectilinear"')
        raise ValueError(f"ax must have the projection {other} for a chain {kind}, got {shown(ax.name)}")
    return ax


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
    rods = zip(chain.scaled.length, chain.scaled.mass, chain.scaled.rotary_inertia, strict=True)
    heavy = [
        i for i, (length, mass, inertia) in enumerate(rods) if length and 4 * inertia == mass * length**2
    ]
    return {node for i in heavy for node in (i, i + 1)}


Shape = (
    Modes
    | Equilibrium
    | SpatialModes
    | SpatialEquilibrium
    | StructureChainModes
    | StructureStatics
    | tuple[ArrayLike, ArrayLike]
    | Any
)

#: Smallest amplitude of a mode, in lengths of the chain; and the slope of its steepest piece: what is steeper
#: is hard to read.
_FLATTEST, _STEEPEST = 1e-9, 1.7


@dataclass(frozen=True, eq=False)
class Pose:
    """The place of a chain in a picture: nodes (left tip, hinges, right tip) and the pieces between them.

    Attributes
    ----------
    x, y : ndarray, shape (nodes,) [m]
    angle : ndarray, shape (pieces,) [rad]
        Counter-clockwise from the x axis.
    """

    x: Floats
    y: Floats
    angle: Floats


def pose_of(chain: Chain, shape: Shape | None, *, mode: int = 1, amplitude: float = 0.15) -> Pose:
    """Return the place of a chain; the arguments are those of `draw_chain`.

    Raises
    ------
    TypeError, ValueError
        If `shape` is of no known kind, is not finite, or is not of this chain.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> pose_of(Chain(Beam.unit(), "clamped-free", segments=2), None).x
    array([0. , 0. , 0.5, 1. ])
    """
    import xarray

    def numbers(name: str, values: ArrayLike, size: int) -> Floats:
        array = real_numbers(f"{name} of shape", values)
        if array.shape != (size,):
            raise ValueError(
                f"{name} of shape must hold {size} finite numbers for this chain, got {shown(values)}"
            )
        return array

    def bent(x: ArrayLike, y: ArrayLike, angle: ArrayLike) -> Pose:
        nodes = chain.pieces + 1
        return Pose(numbers("x", x, nodes), numbers("y", y, nodes), numbers("angle", angle, chain.pieces))

    straight = np.array(chain.node_position)
    if shape is None:
        return Pose(straight, np.zeros_like(straight), np.zeros(chain.pieces))
    if isinstance(shape, Equilibrium):
        return bent(shape.nodes[:, 0], shape.nodes[:, 1], shape.angle)
    if isinstance(shape, xarray.Dataset):
        return bent(*(_moment(shape, name) for name in ("x", "y", "angle")))
    if isinstance(shape, Modes):
        shape = _scaled(chain, shape, mode, amplitude)
    if not isinstance(shape, tuple) or len(shape) != 2:
        raise TypeError(
            "shape must be None, Modes, an Equilibrium, one moment of a motion from simulate() or a pair "
            f"(deflection, rotation), got {shown(shape)}"
        )
    # Nodes move across the beam only: rods of a mode shape are a little longer than they are.
    deflection = numbers("deflection", shape[0], chain.pieces + 1)
    return Pose(straight, deflection, np.arctan(numbers("rotation", shape[1], chain.pieces)))


def _scaled(chain: Chain, modes: Modes, mode: int, amplitude: float) -> tuple[Floats, Floats]:
    row = whole_number("mode", mode, most=len(modes.angular_frequency)) - 1
    share = positive_real("amplitude", amplitude)
    if not _FLATTEST <= share <= 1 / _FLATTEST:
        raise ValueError(
            f"amplitude must be from {_FLATTEST} to {1 / _FLATTEST:g} of the chain's length, "
            f"got {shown(amplitude)}"
        )
    largest = share * chain.node_position[-1]
    deflection, rotation = modes.deflection[row], modes.rotation[row]
    scale = max(np.abs(deflection).max() / largest, np.abs(rotation).max() / _STEEPEST)
    return deflection / scale, rotation / scale


def _moment(motion: xarray.Dataset, name: str) -> Floats:
    if name not in motion.variables:
        raise ValueError(f"shape must hold x, y and angle, got {shown(list(motion.data_vars))}")
    if "time" in motion.dims:
        raise ValueError("shape must be one moment of a motion, such as motion.isel(time=-1), got all of it")
    return np.asarray(motion[name].values)


def spring_texts(chain: Chain, unit: str = "EI/ell") -> list[str]:
    """Return the springs at a chain's hinges, left to right, as labels of a drawing.

    `unit` is "EI/ell", of the mean EI (the numbers as given for a chain from pieces), or "N m/rad".

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> spring_texts(Chain(Beam.unit(), "clamped-free", segments=4, rule="gregory"))
    ['8/3', '6/7', '24/23', '1']
    """
    own = choice("unit", unit, LABELS) == "EI/ell"
    return [_text(k) for k in (chain.scaled.joint_stiffness if own else chain.joint_stiffness.tolist())]


def support_texts(chain: Chain, unit: str = "EI/ell") -> list[tuple[str, str]]:
    """Return K_t and K_r of both ends' elastic supports as labels; "" where an end holds or leaves free.

    The `unit` "EI/ell" gives them in EI/L³ and EI/L, "N m/rad" in N/m and N m/rad.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> ends = "pinned(rotational_stiffness=8)-free(translational_stiffness=2)"
    >>> support_texts(Chain(Beam.unit(), ends, 4, "double_wall"))   # 2 EI/ell in series with 8 EI/L
    [('', '4 EI/L'), ('2 EI/L³', '')]
    """
    own = choice("unit", unit, LABELS) == "EI/ell"
    if not own:
        names: Sequence[str] = (" N/m", " N m/rad")
        pairs = chain.support_stiffness.tolist()
    else:
        size = chain.segments or 1
        names = (" EI/L³", " EI/L") if chain.segments else ("", "")
        pairs = [(k_t * size**3, k_r * size) for k_t, k_r in chain.scaled.supports]
    return [
        (_elastic(translation, names[0]), _elastic(rotation, names[1])) for translation, rotation in pairs
    ]


def _draw_spring_labels(ax: Axes, chain: Chain, pose: Pose, unit: str, *, lift: float, size: float) -> None:
    """Write each hinge's spring `lift` [m] beside it, on the upper side of the straight chain."""
    texts, whole = spring_texts(chain, unit), float(chain.node_position[-1])
    runs = _runs(texts) if len(texts) > _CROWD else [(j, text) for j, text in enumerate(texts)]
    if len(runs) > _MOST:
        return
    for hinge, text in runs:
        turned = complex(np.exp(1j * pose.angle[hinge]) + np.exp(1j * pose.angle[hinge + 1]))
        normal = 1j * turned / abs(turned) if abs(turned) > 1e-9 else 1j
        foot = complex(pose.x[hinge + 1], pose.y[hinge + 1]) + lift * normal
        away = 0.85 * size * normal
        ax.annotate(
            text,
            (foot.real, foot.imag),
            (away.real, away.imag),
            textcoords="offset points",
            ha="center",
            va="center",
            color=SPRING,
            fontsize=size,
            zorder=6,
        )
        top = foot + _ABOVE * whole * normal
        ax.update_datalim([(top.real - _BESIDE * whole, top.imag), (top.real + _BESIDE * whole, top.imag)])


def _draw_support_labels(
    ax: Axes, chain: Chain, places: Sequence[EndPlace], unit: str, *, size: float
) -> None:
    """Write the springs of elastic supports below the ends, on the side of the beam."""
    for place, (translation, rotation) in zip(places, support_texts(chain, unit), strict=False):
        lower = place.body.half / place.length
        for text, below in ((rotation, 0.075), (translation, 0.19 if rotation else 0.15)):
            if text:
                _draw_beside(ax, place, text, max(below, lower + 0.65 * below), size)


def _draw_beside(ax: Axes, place: EndPlace, text: str, below: float, size: float) -> None:
    x, y = place.at[0] - place.side * 0.11 * place.length, place.at[1] - below * place.length
    align = "left" if place.side < 0 else "right"
    ax.text(x, y, text, ha=align, va="center", color=GROUND_SPRING, fontsize=size, zorder=6)
    ax.update_datalim([(x, y - 0.04 * place.length)])


def _text(value: Number) -> str:
    if isinstance(value, Fraction) and max(value.numerator, value.denominator) <= _LARGEST:
        return str(value)
    return f"{float(value):.4g}"


def _elastic(value: Number, unit: str) -> str:
    return _text(value) + unit if 0 < value < math.inf else ""


def _runs(texts: list[str]) -> list[tuple[int, str]]:
    """Return the middle hinge and the label of each run of equal neighbours, such as '3 × 1'."""
    runs, first = [], 0
    for text, same in itertools.groupby(texts):
        count = len(list(same))
        runs.append((first + (count - 1) // 2, text if count == 1 else f"{count} × {text}"))
        first += count
    return runs
