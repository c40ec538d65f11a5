"""Forward dynamics of a chain in CasADi, at a cost that grows linearly with its length.

Held right end. Its deflection is a closure with one multiplier, the force on the right tip across the beam.
Accelerations are affine in it, so two sweeps find the force that keeps the tip with the base.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.chain_state import ChainState, checked_system
from beammodes.dynamics.sweep import Sweep
from beammodes.equations.coordinates import coordinate_names
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.damping import Damping

__all__ = ["ForwardDynamics", "forward_dynamics"]


@dataclass(frozen=True)
class ForwardDynamics:
    """Accelerations of a chain as a CasADi function, and what its states stand for.

    Attributes
    ----------
    chain : Chain
    coordinates : tuple of str
        Names of q; see `coordinates.coordinate_names`. With a base that moves they are absolute.
    acceleration : casadi.Function
        q'' of (q, q', base), base being the nine numbers of `base_vector`.
    """

    chain: Chain
    coordinates: tuple[str, ...]
    acceleration: casadi.Function


def forward_dynamics(
    chain: Chain, *, load: Load | None = None, damping: Damping | None = None, base: BaseMotion | None = None
) -> ForwardDynamics:
    """Return the compiled forward dynamics of a chain.

        q'' = M(q)⁻¹ ((∂c/∂q)ᵀ λ - h(q, q') - s(q) - C q')

    Parameters
    ----------
    chain : Chain
        Of any length; its left end must be tied to the base, or neither end held.
    load : Load, optional
        Dead loads and gravity. A turning hub is a base that turns, not a spin rate.
    damping : Damping, optional
    base : BaseMotion, optional
        What moves the left end; at rest by default. Its courses enter as the argument `base`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the base cannot move this chain.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.dynamics.chain_state import base_vector
    >>> dynamics = forward_dynamics(Chain(Beam.unit(), "clamped-free", segments=1))
    >>> round(float(dynamics.acceleration(0.1, 0.0, base_vector(BaseMotion(), 0.0))), 9)    # -k θ/(m ell²/3)
    -0.9
    """
    checked_system(chain, load, damping, base)
    if load is None and damping is None and base is None and _can_be_kept(chain):
        return _of_chain_alone(chain)
    return _compiled(chain, load, damping)


def _can_be_kept(chain: Chain) -> bool:
    """Whether a chain can be looked up: the functions that a beam is given by may be objects of any kind."""
    try:
        hash(chain)
    except TypeError:
        return False
    return True


@lru_cache(maxsize=4)
def _of_chain_alone(chain: Chain) -> ForwardDynamics:
    return _compiled(chain, None, None)


def _compiled(chain: Chain, load: Load | None, damping: Damping | None) -> ForwardDynamics:
    names = coordinate_names(chain)
    q, u, course = (
        casadi.SX.sym(name, size) for name, size in (("q", len(names)), ("u", len(names)), ("b", 9))
    )
    state = ChainState.of(chain, casadi.vertsplit(q), casadi.vertsplit(u), casadi.vertsplit(course))
    sweep = Sweep(chain, state, checked_load(load), damping or Damping())
    result = sweep.accelerations(casadi.SX(0))
    if chain.boundary.right.holds_deflection:
        # Affine in the multiplier: the force that leaves the tip with the base.
        nothing, unit = result, sweep.accelerations(casadi.SX(1))
        force = (course[5] - nothing[1]) / (unit[1] - nothing[1])
        result = ([x + force * (y - x) for x, y in zip(nothing[0], unit[0], strict=True)], None)
    return ForwardDynamics(
        chain, tuple(names), casadi.Function("acceleration", [q, u, course], [casadi.vertcat(*result[0])])
    )
