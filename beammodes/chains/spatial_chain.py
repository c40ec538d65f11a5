"""The chain in space: a rod's rigid pieces, cut at nodes on its line, joined by springs in three directions.

The rules are those of planar chains: a hinge of weight w has the springs EI_y/(w ℓ), EI_z/(w ℓ) and GJ/(w ℓ)
about the section's axes *at the node*. That keeps a rule's order for rods that are curved and twisted at
rest, if the pieces are the real, curved ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.curved_pieces import curved_pieces
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rigid_tree import RigidTree, Support
from beammodes.chains.rules import AnyRule, Layout, layout_of
from beammodes.checks import Shown, instead, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import End
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnd, RodEnds

__all__ = ["SpatialChain"]

#: Central inertia over mass times length² of a rod, and of two point masses at its tips.
_ROD, _TIPS = 1 / 12, 1 / 4

#: A planar end that takes a rule's carried weights: any body on the segment does.
_CARRIED = {"carried": End(rotary_inertia=1.0, on_segment=True)}


@dataclass(frozen=True, init=False, eq=False, repr=False)
class SpatialChain(Shown):
    """A rod as a chain of rigid segments, joined at nodes by springs about three axes, by a rule.

    Nodes lie on the rod's centre line. Each piece has the mass, centre of mass and inertia of the real piece
    between two nodes, each joint the section's axes at its node.

    Parameters
    ----------
    rod : Rod
        The rod that the chain stands for. Its shear and axial stiffness are left out.
    boundary : str, pair or RodEnds
        Its two ends, such as "clamped-free"; the one named first is at s = 0.
    segments : int
        N, how many equal lengths the rod is cut into (1 to 10 million).
    rule : str, Rule or any Layout
        Where the hinges sit and how stiff they are, in all three directions. Where an end holds a rotation
        without a force that bends it (twist of a straight rod) the rule's guided weights apply, which need
        the mirror; else its clamped ones.

    Attributes
    ----------
    ends : RodEnds
    tree : RigidTree
        The pieces and joints.
    hinge_position : ndarray, shape (hinges,) [m]
        Of each joint along the centre line.
    joint_stiffness : ndarray, shape (hinges, 3) [N m/rad]
        About the section's x (twist), y and z axes there; inf where it is rigid.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the rule gives a spring that is not positive.

    Examples
    --------
    >>> rod = Rod(1.0, bending_stiffness=1.0, torsional_stiffness=0.8, mass_per_length=1.0)
    >>> SpatialChain(rod, "clamped-free", segments=4, rule="mitiguy").joint_stiffness[:2].round(3)
    array([[6.4  , 8.727, 8.727],
           [3.2  , 4.   , 4.   ]])
    """

    rod: Rod
    ends: RodEnds
    segments: int
    rule: Layout
    tree: RigidTree
    hinge_position: Floats
    joint_stiffness: Floats

    def __init__(self, rod: Rod, boundary: RodBoundaryLike, segments: int, rule: AnyRule = "mitiguy") -> None:
        if not isinstance(rod, Rod):
            hint = instead(rod, Beam="Rod.from_beam makes one of a Beam")
            raise TypeError(f"rod must be a Rod, got {shown(rod)}{hint}")
        ends, record = RodEnds.of(boundary), layout_of(rule)
        count = whole_number("segments", segments, most=MAX_PIECES)
        places, flexibility = _hinges(rod, ends, count, record)
        with np.errstate(divide="ignore"):
            stiffness = 1.0 / flexibility
        fields = {
            "rod": rod,
            "ends": ends,
            "segments": count,
            "rule": record,
            "tree": _tree(rod, ends, places, flexibility, float(record.rotary_inertia)),
            "hinge_position": places,
            "joint_stiffness": stiffness,
        }
        for array in (places, stiffness):
            array.flags.writeable = False
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def node_position(self) -> Floats:
        """Distance along the rod of its start, every hinge and its end, each once, shape (nodes,) [m]."""
        return np.unique(np.concatenate([[0.0], self.hinge_position, [self.rod.length]]))

    @property
    def nodes(self) -> Floats:
        """Points of the centre line at `node_position`, in the axes at s = 0, shape (nodes, 3) [m]."""
        return self.rod.frames(self.node_position)[1]

    def _line(self) -> str:
        return f"<SpatialChain {self.ends}: segments={self.segments}, rule={self.rule.name!r}>"


def _hinges(rod: Rod, ends: RodEnds, count: int, rule: Layout) -> tuple[Floats, Floats]:
    """Return where the hinges are along a rod, and their flexibility about x, y and z."""
    untwisted = rod.curvature == (0.0, 0.0, 0.0)
    known: dict[tuple[Beam, tuple[str, str]], Chain] = {}
    columns = []
    for axis in range(3):
        beam, alone = rod.planar(axis), untwisted or (axis == 0 and rod.is_straight)
        words = (ends.left.word(axis, alone=alone), ends.right.word(axis, alone=alone))
        planar = (_CARRIED.get(words[0], words[0]), _CARRIED.get(words[1], words[1]))
        scale = 1.0
        if beam.is_uniform:
            # Weights are all that differs: one chain serves all directions.
            scale, beam = beam.mean_bending_stiffness, Beam(rod.length, 1.0, 1.0)
        key = (beam, words)
        if key not in known:
            known[key] = Chain(beam, planar, count, rule)
        chain = known[key]
        columns.append((chain.hinge_position, 1.0 / (scale * chain.joint_stiffness)))
    near = 0.25 * rod.length / count
    at_left, at_right = (any(_at(place, end, near) for place, _ in columns) for end in (0.0, rod.length))
    inner = max(columns, key=lambda column: len(column[0]))[0]
    inner = inner[(inner > near) & (inner < rod.length - near)]
    places = np.concatenate([[0.0] * at_left, inner, [rod.length] * at_right])
    flexibility = np.zeros((len(places), 3))
    for axis, (own, give) in enumerate(columns):
        first = int(at_left and not _at(own, 0.0, near))
        if len(give) > len(places) - first or not np.allclose(
            own, places[first : first + len(own)], atol=near
        ):
            raise ValueError(f"rule {rule.name} must have its hinges at the same places in every direction")
        flexibility[first : first + len(give), axis] = give
    return places, flexibility


def _at(places: Floats, end: float, near: float) -> bool:
    return bool(len(places) and np.abs(places - end).min() < near)


def _tree(rod: Rod, ends: RodEnds, places: Floats, flexibility: Floats, shape: float) -> RigidTree:
    at_left = bool(len(places)) and places[0] == 0.0
    at_right = bool(len(places)) and places[-1] == rod.length
    inner = places[int(at_left) : len(places) - int(at_right)]
    edges = np.concatenate([[0.0], inner, [rod.length]])
    mass, centre, spread, section = curved_pieces(rod, edges)
    axes, points = rod.frames(edges)
    if shape != _ROD:
        spread = spread + (shape - _ROD) / (_TIPS - _ROD) * (_gathered(mass, centre, points) - spread)
    inertia = spread + section
    # A hinge at an end is between the rod and a piece without length, which has the end's body.
    if at_left:
        mass, centre, inertia = _with_stub(mass, centre, inertia, points[0], 0)
    if at_right:
        mass, centre, inertia = _with_stub(mass, centre, inertia, points[-1], len(mass))
    for end, piece, frame, point in (
        (ends.left, 0, axes[0], points[0]),
        (ends.right, -1, axes[-1], points[-1]),
    ):
        _add_body(end, frame, point, mass, centre, inertia, piece)
    hinged = slice(0 if at_left else 1, len(edges) - (0 if at_right else 1))
    acting = rod.determined(ends)
    return RigidTree(
        parent=np.arange(len(mass)) - 1,
        joint_place=np.concatenate([points[:1], points[hinged]]),
        joint_frame=np.concatenate([axes[:1], axes[hinged]]),
        joint_flexibility=np.concatenate([np.zeros((1, 3)), flexibility]),
        mass=mass,
        centre=centre,
        inertia=inertia,
        supports=(
            Support(0, points[0], axes[0], acting.left.stiffness),
            Support(len(mass) - 1, points[-1], axes[-1], acting.right.stiffness),
        ),
    )


def _gathered(mass: Floats, centre: Floats, points: Floats) -> Floats:
    """Return the inertia of pieces whose masses are at their nodes, with their centres as they are."""
    chord = points[1:] - points[:-1]
    square = (chord**2).sum(axis=1)
    share = np.clip(((centre - points[:-1]) * chord).sum(axis=1) / square, 0.0, 1.0)
    spread = (mass * share * (1.0 - share))[:, None, None]
    gathered: Floats = spread * (square[:, None, None] * np.eye(3) - chord[:, :, None] * chord[:, None, :])
    return gathered


def _with_stub(
    mass: Floats, centre: Floats, inertia: Floats, point: Floats, at: int
) -> tuple[Floats, Floats, Floats]:
    return (
        np.insert(mass, at, 0.0),
        np.insert(centre, at, point, axis=0),
        np.insert(inertia, at, np.zeros((3, 3)), axis=0),
    )


def _add_body(
    end: RodEnd, frame: Floats, point: Floats, mass: Floats, centre: Floats, inertia: Floats, piece: int
) -> None:
    """Fix an end's body to a piece."""
    if not end.has_body:
        return
    place = point + frame @ np.array(end.offset)
    total = mass[piece] + end.mass
    share = end.mass / total if total else 0.0
    apart = place - centre[piece]
    pair = (apart @ apart) * np.eye(3) - np.outer(apart, apart)
    inertia[piece] += frame @ np.array(end.rotary_inertia) @ frame.T + mass[piece] * share * pair
    centre[piece] += share * apart
    mass[piece] = total
    if not math.isfinite(total):
        raise ValueError(f"mass must be within the range of floats beside the rod's, got {end.mass}")
