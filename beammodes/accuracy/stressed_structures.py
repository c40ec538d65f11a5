"""Structures of beams, and chains of them, under a load: the multiple of it that buckles them, their modes.

Axial forces are those of the statics under the load, which are proportional to it; that beams are bent before
they buckle is left out. A chain's energy beside that of its springs is ½ f Σ θ_p² ∫ N dx over its pieces.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import overload

import numpy as np

from beammodes.accuracy.loaded_structures import (
    Loads,
    axial_forces,
    loads_listed,
    statics_of,
    structure_chain_statics,
)
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import whole_number
from beammodes.exact.stressed_structure import critical_load_factor, stressed_modes
from beammodes.exact.structure_judge import MOST_MODES, StructureModes
from beammodes.numerics.arrays import Floats, first_factor
from beammodes.numerics.blas import one_thread
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.applied_loads import AppliedLoad, PointLoad
from beammodes.problem.loading import Load
from beammodes.problem.structure import Parts, Structure, checked_structure
from beammodes.vibration.structure_vibration import (
    StructureChainModes,
    StructureCoordinates,
    stressed_chain_modes,
)

__all__ = ["chain_modes_under", "structure_buckling_load", "structure_modes_under"]


def structure_buckling_load(structure: Structure | StructureChain, load: Loads | None) -> float:
    """Return the factor of a load, or the compression of a straight member [N], as `buckling_load` says.

    Examples
    --------
    A column held in the middle, and a chain of it:

    >>> from beammodes.problem.beam import Beam
    >>> import math
    >>> from beammodes.problem.structure import Station
    >>> column = Structure.of_beam(Beam.unit(), "pinned-pinned", [Station(0.5, float("inf"))])
    >>> chain = StructureChain(column, 20, "gregory")
    >>> [round(structure_buckling_load(each, None) / math.pi**2, 6) for each in (column, chain)]
    [4.0, 3.965894]
    """
    whole = structure.structure if isinstance(structure, StructureChain) else structure
    given = loads_listed(_compression(whole) if load is None else load)
    if isinstance(structure, StructureChain):
        coordinates = StructureCoordinates.of(structure)
        forces = axial_forces(structure_chain_statics(structure, given))
        return first_factor(coordinates.geometric(forces, _resisted(structure.parts, given)))
    # Of many small matrices more threads would only wait for each other.
    with one_thread():
        return critical_load_factor(*_stressed(whole, given))


@overload
def structure_modes_under(structure: Structure, load: Loads, modes: int) -> StructureModes: ...
@overload
def structure_modes_under(structure: StructureChain, load: Loads, modes: int) -> StructureChainModes: ...
def structure_modes_under(
    structure: Structure | StructureChain, load: Loads, modes: int
) -> StructureModes | StructureChainModes:
    """Return the first modes of a structure, or of a chain of it, about its straight shape under a load.

        ½ ∫ EI v''² + ½ ∫ N v'²  beside the kinetic energy,   N of `structure_statics`

    Loads are dead; that they bend members is left out. The structure's are right to 1e-9.

    Parameters
    ----------
    structure : Structure or StructureChain
    load : PointLoad, LineLoad, a sequence of these, or Load
        Of a `Load` the gravity only.
    modes : int
        1 to 100, and at most as many as a chain has.

    Returns
    -------
    StructureModes or StructureChainModes
        Of the kind that is given, frequencies in increasing order.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind; if the structure is not held still or buckles under the load; or if
        members that do not stretch leave axial forces open.

    Examples
    --------
    A mast that holds a tenth of its own buckling load on its top, and a chain of it:

    >>> import beammodes as bm
    >>> mast = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free")
    >>> top = bm.PointLoad(joint="right", force=(-0.1 * bm.buckling_load(mast), 0))
    >>> for each in (mast, bm.StructureChain(mast, 20)):
    ...     print(bm.structure_modes_under(each, top, 2).angular_frequency.round(5))
    [ 3.34782 21.85214]
    [ 3.34773 21.85165]
    """
    count = whole_number("modes", modes, most=MOST_MODES)
    if isinstance(structure, StructureChain):
        return chain_modes_under(structure, loads_listed(load), count)
    with one_thread():
        return stressed_modes(checked_structure(structure), *_stressed(structure, loads_listed(load)), count)


def chain_modes_under(
    chain: StructureChain, load: Load | list[AppliedLoad], modes: int | None
) -> StructureChainModes:
    """Return the first modes of a chain under a load, or all that it has.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = StructureChain(Structure.of_beam(Beam.unit(), "clamped-free"), 6)
    >>> chain_modes_under(chain, [PointLoad(1.0, force=(1.0, 0.0))], None).elastic_modes
    6
    """
    forces = axial_forces(structure_chain_statics(chain, load))
    return stressed_chain_modes(chain, forces, _resisted(chain.parts, load), modes)


def _stressed(
    structure: Structure, load: Load | list[AppliedLoad]
) -> tuple[Parts, list[Callable[[Floats], Floats]], list[float]]:
    """Return parts between which axial forces are smooth, these, and what resists rotations of nodes."""
    parts = structure.cut(_places(structure, load))
    forces = [_over_arrays(force) for force in axial_forces(statics_of(structure, parts, None, load))]
    return parts, forces, _resisted(parts, load)


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
