"""How hard loads along a straight chain pull on its pieces."""

from __future__ import annotations

from fractions import Fraction

from beammodes.chains.chain import Chain, Number
from beammodes.chains.repeated import each_once
from beammodes.problem.loading import Load

__all__ = ["axial_pull", "straight_load"]


def straight_load(chain: Chain, load: Load) -> Load:
    """Return `load`, or raise ValueError if the straight chain is not in equilibrium under it."""
    if load.bends:
        raise ValueError(
            f"load must leave the straight chain in equilibrium, got {load}: give linearize the bent shape, "
            "at=find_equilibrium(chain, load)"
        )
    return hub_load(chain, load)


def hub_load(chain: Chain, load: Load) -> Load:
    """Return `load`, or raise ValueError if nothing holds the left end against it."""
    if load.needs_hub and not chain.boundary.left.is_grounded:
        raise ValueError(
            f"boundary must tie the left end to the ground or hub under {load}, got {chain.boundary.name}: "
            "name the held end first"
        )
    beam = chain.beam
    if load.spin_rate and beam is not None and beam.has_rotary_inertia:
        raise ValueError("beam must have no rotary_inertia_per_length on a turning hub")
    return load


def axial_pull(chain: Chain, load: Load) -> list[Number]:
    """Return, for each piece, what loads along the chain add to  ∂²V/∂θ_i²  at rest, in its own units.

    A piece whose outer neighbours are pulled with the force P, and itself at its centre with p, resists
    turning with  l P + c p.  P sums the axial force, the tip's, and weight and centrifugal force
    m (g_x + Ω² X) of all that lies beyond; a rod's own spread along the radius adds Ω² J.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> axial_pull(Chain(Beam.unit(), "pinned-pinned", 2), Load(axial_force=Fraction(1)))   # T l in EI/ell
    [Fraction(1, 4), Fraction(1, 4)]
    """
    units = chain.exact_units
    beyond: Number = units.force(Fraction(load.axial_force) + Fraction(load.tip[0]))
    weight, square = units.acceleration(load.weight[0]), units.square_rate(load.spin_rate)
    if not (weight or square):
        return each_once(lambda length: length * beyond if beyond else beyond, chain.piece_length)
    radius = _radii(chain, units.body(0, 0, load.hub_radius)[2])
    pulls: list[Number] = []
    for i in range(chain.pieces - 1, -1, -1):
        own = chain.piece_mass[i] * (weight + square * radius[i])
        turning = square * chain.piece_rotary_inertia[i]
        pulls.append(chain.piece_length[i] * beyond + chain.piece_centre[i] * own + turning)
        beyond += own
    return pulls[::-1]


def _radii(chain: Chain, hub: Number) -> list[Number]:
    """Return the distance of every piece's centre of mass from the axis of rotation."""
    radii, start = [], hub
    for length, centre in zip(chain.piece_length, chain.piece_centre, strict=True):
        radii.append(start + centre)
        start += length
    return radii
