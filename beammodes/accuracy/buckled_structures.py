"""The multiple of a load at which a structure of beams, or a chain of it, buckles.

Axial forces are those of the statics under the load, which are proportional to it; that beams are bent before
they buckle is left out. A chain's energy beside that of its springs is ½ f Σ θ_p² ∫ N dx over its pieces.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from beammodes.accuracy.loaded_structures import (
    Loads,
    axial_forces,
    loads_listed,
    statics_of,
    structure_chain_statics,
)
from beammodes.chains.structure_chain import StructureChain
from beammodes.exact.structure_buckling import critical_load_factor
from beammodes.numerics.arrays import Floats, first_factor
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.applied_loads import AppliedLoad, PointLoad
from beammodes.problem.loading import Load
from beammodes.problem.structure import Parts, Structure
from beammodes.vibration.structure_vibration import StructureCoordinates

__all__ = ["structure_buckling_load"]


def structure_buckling_load(structure: Structure | StructureChain, load: Loads | None) -> float:
    """Return the factor of a load, or the compression of a straight member [N], as `buckling_load` says.

    Examples
    --------
    A column held in the middle, and a chain of it:

    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.structure import Station
    >>> column = Structure.of_beam(Beam.unit(), "pinned-pinned", [Station(0.5, float("inf"))])
    >>> chain = StructureChain(column, 20, "gregory")
    >>> [round(structure_buckling_load(each, None) / math.pi**2, 6) for each in (column, chain)]
    [4.0, 3.965894]
    """
    whole = structure.structure if isinstance(structure, StructureChain) else structure
    given = loads_listed(_compression(whole) if load is None else load)
    if isinstance(structure, StructureChain):
        statics = structure_chain_statics(structure, given)
        return _factor_of_chain(structure, axial_forces(statics), _resisted(structure.parts, given))
    parts = whole.cut(_places(whole, given))
    statics = statics_of(whole, parts, None, given)
    forces = [_over_arrays(force) for force in axial_forces(statics)]
    return critical_load_factor(parts, forces, _resisted(parts, given))


def _compression(structure: Structure) -> list[PointLoad]:
    """Return unit forces on both ends of a structure's only member, towards each other."""
    if len(structure.members) > 1:
        raise TypeError("load must be given for a structure of several members, got None")
    (member,), (stretch, *_) = structure.members, structure.parts.stretches
    x, y = stretch.axis
    return [PointLoad(joint=member.start, force=(x, y)), PointLoad(joint=member.end, force=(-x, -y))]


def _places(structure: Structure, load: Load | list[AppliedLoad]) -> dict[str, list[float]]:
    """Return where on members forces may change the axial force."""
    places: dict[str, list[float]] = {}
    for one in [] if isinstance(load, Load) else load:
        if isinstance(one, PointLoad) and one.x is not None:
            places.setdefault(structure.member(one.member).name, []).append(float(one.x))
    return places


def _resisted(parts: Parts, load: Load | list[AppliedLoad]) -> list[float]:
    """Return by what moment per angle the weight of each node's body resists a rotation: F · r."""
    if not isinstance(load, Load):
        return [0.0] * len(parts.nodes)
    pull = [float(part) for part in load.weight]
    return [
        node.mass * sum(part * arm for part, arm in zip(pull, node.offset, strict=True))
        for node in parts.nodes
    ]


def _over_arrays(force: Piecewise) -> Callable[[Floats], Floats]:
    return lambda places: np.array([force(x) for x in places.tolist()])


def _factor_of_chain(chain: StructureChain, forces: list[Piecewise], resisted: list[float]) -> float:
    coordinates = StructureCoordinates.of(chain)
    turns = coordinates.turns(coordinates.give, coordinates.follow)
    geometric = np.zeros((turns.shape[1], turns.shape[1]))
    for pieces, bodies, force in zip(chain.chains, chain.bodies, forces, strict=True):
        pull = force.integrated()
        ends = np.append(0.0, np.cumsum(pieces.length))
        ends[-1] = force.edges[-1]
        along = np.diff([pull(x) for x in ends.tolist()])
        rows = turns[list(bodies)] * (pieces.length > 0.0)[:, None]
        geometric += (rows.T * along) @ rows
    for body, moment in zip(chain.joints, resisted, strict=True):
        if moment and body is not None:
            geometric += moment * np.outer(turns[body], turns[body])
    return first_factor(geometric)
