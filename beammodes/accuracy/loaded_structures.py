"""Statics of beams, planar structures and chains of them under any loads: deflections, moments, reactions.

On a stretch of length l the bending moment is known but for its values m₀ and m₁ at the two ends,

    M(x) = m₀ (1 - x/l) + m₁ x/l + M_load(x),      M' = V,   V' = q,

positive where it bends the stretch to the left of one who goes along it (up, on a beam along x). By virtual
work the two ends turn against the line between them by -∫ (1 - x/l) κ dx and ∫ x/l κ dx with the curvature
κ = M/EI of the beam. A chain has Σ f_j M(x_j) over its hinges in place of ∫ M/EI dx: the quadrature that its
springs are. Rigid pieces in equilibrium have the beam's own M at the hinges, so nothing else differs.

Rotations of nodes, the lengths of stretches and equilibrium at nodes make one linear system, solved in
fractions where all numbers are such: of uniform beams along the axes, and of their chains.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.bent_stretches import (
    BentStretch,
    Flexibility,
    HingedBending,
    UniformBending,
    VaryingBending,
)
from beammodes.accuracy.shared_loads import SharedLoads
from beammodes.accuracy.static_system import StaticSystem
from beammodes.chains.chain import Chain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, bounded, is_text, real, real_numbers, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.applied_loads import AppliedLoad, LineLoad, PointLoad
from beammodes.problem.beam import Beam, each_place_once
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load
from beammodes.problem.profiles import SAME_PLACE, Table
from beammodes.problem.structure import Parts, Stretch, Structure, checked_structure

__all__ = [
    "Loads",
    "Reaction",
    "StructureStatics",
    "axial_forces",
    "beam_under",
    "chain_under",
    "loads_listed",
    "statics_of",
    "structure_chain_statics",
    "structure_statics",
]

#: What a user may give as loads.
Loads = Load | AppliedLoad | Iterable[AppliedLoad]
_MOST_LOADS = 10_000


class Reaction(NamedTuple):
    """What a support does to a structure: forces along x and y [N], and a moment, counter-clockwise [N m]."""

    force_x: float
    force_y: float
    moment: float


@dataclass(frozen=True, eq=False, repr=False)
class StructureStatics(Shown):
    """Small static deflection under loads; `structure_statics` and `structure_chain_statics` make it.

    Where x is a `Fraction`, so are the answers, if all numbers of the problem are exact: those of uniform
    beams along the axes of the plane.

    Attributes
    ----------
    structure : Structure
    exact : bool
        Whether all numbers are fractions.
    """

    structure: Structure
    exact: bool
    _stretches: tuple[BentStretch, ...]
    _ends: tuple[tuple[Any, ...], ...]
    _reactions: Mapping[str, tuple[Any, Any, Any]]
    _joints: Mapping[str, tuple[Any, Any, Any]]

    def deflection(self, x: ArrayLike | Fraction, member: str | None = None) -> Any:
        """Return the deflection across a member, to the left of one who goes along it [m].

        Up, on a beam along x.

        Parameters
        ----------
        x : float, Fraction or array [m]
            Distance from the member's start.
        member : str, optional
            Its name, where there are several.
        """
        return self._along(x, member, BentStretch.deflection)

    def rotation(self, x: ArrayLike | Fraction, member: str | None = None, side: int = -1) -> Any:
        """Return the rotation, counter-clockwise [rad]; at a hinge that before it (side -1) or behind (1)."""
        return self._along(x, member, BentStretch.rotation, side)

    def moment(self, x: ArrayLike | Fraction, member: str | None = None, side: int = -1) -> Any:
        """Return the bending moment M = EI v'' [N m], before (side -1) or behind (1) a jump of it."""
        return self._along(x, member, BentStretch.moment, side)

    def shear(self, x: ArrayLike | Fraction, member: str | None = None, side: int = -1) -> Any:
        """Return the shear force V = dM/dx [N], before (side -1) or behind (1) a jump of it.

        A part of the beam from x on is pushed up, to the left, by V from the part before.
        """
        return self._along(x, member, BentStretch.shear, side)

    def edges(self, member: str | None = None) -> Floats:
        """Return the places on a member between which its forces are smooth, its two ends included [m].

        Joints, stations, breaks of the beam, points under forces and moments, and ends and steps of spread
        loads.
        """
        beam, places = self.structure.member(member), [0.0]
        for one in self._stretches:
            if one.stretch.member == beam.name:
                own = {
                    edge
                    for load in (one.moment_of_load, one.shear_of_load, one.pull_of_load)
                    for edge in load.edges
                }
                places += [float(one.start + x) for x in sorted(own)]
        return np.array(each_place_once(sorted(places), beam.beam.length))

    def axial_force(self, x: ArrayLike | Fraction, member: str | None = None, side: int = -1) -> Any:
        """Return the axial force [N], tension positive, before (side -1) or behind (1) a jump of it.

        A ValueError tells where members that do not stretch leave it open, as between two fixed supports.

        Examples
        --------
        >>> import beammodes as bm
        >>> mast = bm.Structure({"foot": bm.Joint(0, 0, "clamped"), "top": bm.Joint(0, 2)},
        ...     [bm.Member(bm.Beam(2.0, 1.0, 3.0), "foot", "top")])
        >>> bm.structure_statics(mast, bm.Load(gravity=10.0)).axial_force([0.0, 1.0, 2.0])
        array([-60., -30.,   0.])
        """
        return self._along(x, member, BentStretch.axial_force, side)

    @cached_property
    def reactions(self) -> Mapping[str, Reaction]:
        """Of each support, by the name of its joint or station ("left-right at 0.5").

        Where several supports hold one straight line of members along itself, members that do not stretch do
        not tell how these share a force along it: nan.
        """
        return {name: Reaction(*map(float, given)) for name, given in self._reactions.items()}

    @property
    def exact_reactions(self) -> Mapping[str, tuple[Any, Any, Any]]:
        """`reactions` in the numbers in which they were found, fractions if `exact`."""
        return dict(self._reactions)

    @property
    def displacements(self) -> Mapping[str, tuple[float, float, float]]:
        """Of each joint and station along x and y [m], and its rotation [rad]."""
        return {name: (float(x), float(y), float(turn)) for name, (x, y, turn) in self._joints.items()}

    def _along(self, x: Any, member: str | None, function: Any, side: int = -1) -> Any:
        if not whole_number("side", side, least=-1, most=1):
            raise ValueError("side must be -1 or 1, got 0")
        beam = self.structure.member(member)
        if isinstance(x, Fraction):
            real("x", x)
            return self._at(x, beam.name, beam.beam.length, function, side)
        places = real_numbers("x", x)
        number = Fraction if self.exact else float
        found = [
            float(self._at(number(at), beam.name, beam.beam.length, function, side))
            for at in places.ravel().tolist()
        ]
        return np.array(found).reshape(places.shape) if places.ndim else found[0]

    def _at(self, x: Any, member: str, length: float, function: Any, side: int) -> Any:
        if not 0 <= x <= length:
            raise ValueError(f"x must be inside [0, {length}], got {float(x)}")
        own = [i for i, one in enumerate(self._stretches) if one.stretch.member == member]
        starts = [self._stretches[i].start for i in own]
        small = SAME_PLACE * length
        later = [
            k for k, start in enumerate(starts) if (start < x - small or (side > 0 and start <= x + small))
        ]
        k = max(later, default=0)
        one, ends = self._stretches[own[k]], self._ends[own[k]]
        place = min(max(x - starts[k], 0 * x), one.length)
        return function(one, place if self.exact else float(place), ends, side)

    def _line(self) -> str:
        told = ", ".join(
            f"{name}: ({', '.join(f'{value:.6g}' for value in given)})"
            for name, given in self.reactions.items()
        )
        return f"StructureStatics(reactions (F_x N, F_y N, M N m) {told}; {self.structure!r})"


def structure_statics(structure: Structure, load: Loads) -> StructureStatics:
    """Return the small static deflection of a structure of Euler-Bernoulli beams, with its reactions.

    (EI v'')'' = q on every stretch

    Parameters
    ----------
    structure : Structure
        One that its supports hold still.
    load : PointLoad, LineLoad, a sequence of these, or Load
        Of a `Load` the gravity only.

    Returns
    -------
    StructureStatics
        Deflection, rotation, moment and shear at any place, and reactions at the supports.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, a load is where no beam is, or something moves freely.

    References
    ----------
    S. P. Timoshenko, Strength of Materials, part I (1930).

    Examples
    --------
    A force in the middle of a bar between two walls, F L³/(192 EI):

    >>> import beammodes as bm
    >>> bar = bm.Structure.of_beam(bm.Beam.unit(), "clamped-clamped")
    >>> pushed = bm.structure_statics(bar, bm.PointLoad(0.5, force=1.0))
    >>> pushed.deflection(Fraction(1, 2)), pushed.reactions["left"]
    (Fraction(1, 192), Reaction(force_x=0.0, force_y=-0.5, moment=-0.125))
    """
    return statics_of(checked_structure(structure), structure.parts, None, load)


def structure_chain_statics(chain: StructureChain, load: Loads) -> StructureStatics:
    """Return the small static deflection of a chain of a structure, with its reactions.

    As `structure_statics`, with the chain's hinges in place of bending. Between hinges the deflection is
    straight.

    Parameters
    ----------
    chain : StructureChain
    load : PointLoad, LineLoad, a sequence of these, or Load
        Anywhere, at hinges or not.

    Returns
    -------
    StructureStatics
        Deflection, rotation, moment and shear at any place, and reactions at the supports.

    Examples
    --------
    >>> import beammodes as bm
    >>> bar = bm.Structure.of_beam(bm.Beam.unit(), "clamped-clamped", [bm.Station(0.5)])
    >>> chain = bm.StructureChain(bar, segments=6, rule="gregory")
    >>> bm.structure_chain_statics(chain, bm.PointLoad(0.5, force=1.0)).deflection(Fraction(1, 2))
    Fraction(1, 192)
    """
    if not isinstance(chain, StructureChain):
        raise TypeError(f"chain must be a StructureChain, got {shown(chain)}")
    return statics_of(chain.structure, chain.parts, chain.chains, load)


def beam_under(beam: Beam, boundary: BoundaryLike, load: Loads) -> StructureStatics:
    """Return the statics of one beam; the tip of a `Load` is its right end.

    Examples
    --------
    >>> beam_under(Beam.unit(), "clamped-free", Load(tip_force=3.0)).deflection(Fraction(1))
    Fraction(1, 1)
    """
    structure = _alone(beam, Boundary.of(boundary))
    return statics_of(structure, structure.parts, None, load, tip="right")


def chain_under(chain: Chain, load: Loads) -> StructureStatics:
    """Return the statics of a chain that a rule made; the tip of a `Load` is its right end.

    Examples
    --------
    >>> chain = Chain(Beam.unit(), "clamped-free", 4, "mitiguy")
    >>> chain_under(chain, Load(tip_force=3.0)).deflection(Fraction(1))
    Fraction(1, 1)
    """
    if chain.beam is None or chain.segments is None or chain.rule is None:
        raise ValueError("chain must be one that a rule made for a beam under such a load, got one of pieces")
    structure = _alone(chain.beam, chain.boundary)
    # The whole chain is one stretch. A wall's hinge may be in series with the support, and part of it then.
    nodes = [
        node._replace(rotational_stiffness=k if k == math.inf else Fraction(k) * chain.exact_units.stiffness)
        for node, (_, k) in zip(structure.parts.nodes, chain.scaled.supports, strict=False)
    ]
    whole = Stretch("left-right", 0.0, chain.beam, (0, 1), (1.0, 0.0), (math.inf, math.inf))
    return statics_of(structure, Parts(tuple(nodes), (whole,)), (chain,), load, tip="right")


def axial_forces(statics: StructureStatics) -> list[Piecewise]:
    """Return the axial force of each stretch over the distance from its start, tension positive [N].

    Examples
    --------
    >>> structure = Structure.of_beam(Beam.unit(), "clamped-free")
    >>> pulled = structure_statics(structure, PointLoad(0.5, force=(3.0, 0.0)))
    >>> [axial_forces(pulled)[0](x) for x in (0.4, 0.6)]
    [3.0, 0.0]
    """
    found = []
    for one, ends in zip(statics._stretches, statics._ends, strict=True):
        at_end = one.axial_force(one.length, ends, -1)
        pull = one.pull_of_load
        pieces = [(float(piece[0] + at_end), *map(float, piece[1:])) for piece in pull.pieces]
        found.append(Piecewise(tuple(map(float, pull.edges)), tuple(pieces)))
    return found


def _alone(beam: Beam, boundary: Boundary) -> Structure:
    """Return a beam as a structure; where a body at its end has its hinge, statics do not tell."""
    ends = (replace(end, on_segment=False) for end in (boundary.left, boundary.right))
    return Structure.of_beam(beam, Boundary(*ends))


def loads_listed(load: Loads) -> Load | list[AppliedLoad]:
    """Return a `Load` as it is, and all else as a list.

    Examples
    --------
    >>> loads_listed(PointLoad(0.5))
    [PointLoad(x=0.5)]
    """
    if isinstance(load, Load):
        return load
    if isinstance(load, PointLoad | LineLoad):
        return [load]
    if is_text(load) or not isinstance(load, Iterable):
        raise TypeError(
            f"load must be a PointLoad, a LineLoad, a sequence of these or a Load, got {shown(load)}"
        )
    return bounded("load", load, most=_MOST_LOADS)


def statics_of(
    structure: Structure,
    parts: Parts,
    chains: tuple[Chain, ...] | None,
    load: Loads,
    tip: str | None = None,
) -> StructureStatics:
    """Return the statics of the parts of a structure, or of the chains in their place."""
    listed = loads_listed(load)
    exact = _is_exact(parts, weighed=isinstance(listed, Load))
    number = Fraction if exact else float
    shares = SharedLoads(structure, parts, number)
    if isinstance(listed, Load):
        shares.add_load(listed, tip)
    else:
        for one in listed:
            shares.add(one)
    stretches = []
    for i, stretch in enumerate(parts.stretches):
        length = number(stretch.beam.length)
        if chains is not None:
            bends: Flexibility = HingedBending.of(chains[i], number)
        elif isinstance(stretch.beam.bending_stiffness, float):
            bends = UniformBending(number(stretch.beam.bending_stiffness))
        else:
            bends = VaryingBending(stretch.beam)
        stretches.append(BentStretch(stretch, number(stretch.start), length, bends, *shares.on(i, length)))
    system = StaticSystem(parts, tuple(stretches), shares.nodes, number)
    values = system.exact_solution() if exact else system.solution()
    return StructureStatics(structure, exact, tuple(stretches), *system.read(values))


def _is_exact(parts: Parts, *, weighed: bool) -> bool:
    """Return whether beams bend uniformly, all lies along the axes, and no weight is of a function."""
    axes = [unit for node in parts.nodes for unit, _ in node.supports]
    axes += [one.axis for one in parts.stretches]
    return all({abs(part) for part in axis} == {0.0, 1.0} for axis in axes) and all(
        isinstance(one.beam.bending_stiffness, float)
        and (isinstance(one.beam.mass_per_length, float | Table) or not weighed)
        for one in parts.stretches
    )
