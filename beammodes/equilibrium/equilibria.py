"""Where a loaded chain comes to rest, however far that is from straight."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import real, real_numbers, shown
from beammodes.equations.axial_pull import hub_load
from beammodes.equations.coordinates import coordinate_names, tip_names, unpack
from beammodes.equations.mechanics import Algebra, energies
from beammodes.equilibrium.load_path import LONGEST_TURN, shape_under
from beammodes.equilibrium.static_newton import compile_statics
from beammodes.equilibrium.static_state import State
from beammodes.problem.loading import Load, checked_load

__all__ = ["MAX_BENT_PIECES", "Equilibrium", "EquilibriumNotFound", "find_equilibrium"]

Array = NDArray[np.float64]

#: The tangent of a longer chain, a full matrix, would fill memory.
MAX_BENT_PIECES = 2000


class EquilibriumNotFound(ValueError):
    """Newton's method reaches no equilibrium from where it was started."""


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium:
    """A chain at rest under a load.

    Attributes
    ----------
    chain : Chain
    load : Load
    coordinates : ndarray, shape (n,) [m, rad]
        q, in the order of `compile_equations`.
    multipliers : ndarray, shape (closures,) [N]
        Forces λ by which the right end holds its tip: along the beam, where it does, then across.
    tangent : ndarray, shape (n, n)
        Tangent stiffness ∂/∂q (s - (∂c/∂q)ᵀ λ) in these coordinates.
    basis : ndarray, shape (n, independent) [m, rad]
        Columns span the small motions that the closures allow.
    residual : float
        Largest unbalanced moment or force, or gap of a closure, in the chain's own units (`chain.units`).
    is_stable : bool
        Whether every such motion stores energy.
    """

    chain: Chain
    load: Load
    coordinates: Array
    multipliers: Array
    tangent: Array
    basis: Array
    residual: float
    is_stable: bool

    @property
    def angle(self) -> Array:
        """Angle of every piece from the x axis, counter-clockwise, shape (pieces,) [rad]."""
        return np.array(unpack(self.chain, self.coordinates.tolist())[1], dtype=np.float64)

    @property
    def nodes(self) -> Array:
        """(x, y) of the left tip, every hinge and the right tip, shape (pieces + 1, 2) [m]."""
        rods = self.chain.length[:, None] * np.stack([np.cos(self.angle), np.sin(self.angle)], axis=1)
        return np.cumsum([unpack(self.chain, self.coordinates.tolist())[0], *rods], axis=0)

    @property
    def position(self) -> Array:
        """(x, y) of every hinge, shape (hinges, 2) [m]."""
        return self.nodes[1:-1]

    @property
    def stored_energy(self) -> float:
        """Energy in the hinges' springs and the ends' supports [J]."""
        units, still = self.chain.units, [0.0] * len(self.coordinates)
        algebra = Algebra(float, math.sin, math.cos, units.length, units.mass, units.stiffness)
        return float(energies(self.chain, self.coordinates.tolist(), still, algebra).potential)

    def __repr__(self) -> str:
        x, y = self.nodes[-1]
        stable = "stable" if self.is_stable else "unstable"
        at = f"right tip at x = {x:.6g}, y = {y:.6g} m"
        return f"Equilibrium({stable}, {at}; {self.chain!r} under {self.load})"


#: A looser tolerance would let shapes pass that are no equilibria.
MAX_TOLERANCE = 1e-3


def find_equilibrium(
    chain: Chain,
    load: Load | None,
    *,
    guess: Equilibrium | ArrayLike | None = None,
    tolerance: float = 1e-12,
) -> Equilibrium:
    """Return a chain's shape at rest under a load, however large the deflection.

        s(q) - (∂c/∂q)ᵀ λ = 0,    c(q) = 0

    Newton's method, with the load applied in steps no longer than the chain can be followed. A straight chain
    compressed beyond its buckling load is led onto its first branch, the one that bends upwards. Some such
    branches end: dead compression turns pinned-pinned chains inside out at about 2.18 times their buckling
    load, where the ends meet, clamped-pinned ones at 1.13, and those that turn on springs across their ends
    at once.

    Parameters
    ----------
    chain : Chain
        Of at most 2000 pieces.
    load : Load or None
        Of a turning hub: the shape is that relative to it.
    guess : Equilibrium or array, shape (n,) [m, rad], optional
        Coordinates to start from under the whole load: what is found then need not be stable. Zeros keep
        a straight chain straight; another equilibrium with as many coordinates saves time.
    tolerance : float [rad]
        Largest last step of Newton's method (of deflections: relative to the chain's length), 1e-13 to 1e-3.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain is too long, or nothing holds it against the load.
    EquilibriumNotFound
        If no equilibrium is found: nothing resists the chain's turning, or it snaps to a shape far away.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=50)
    >>> rolled = find_equilibrium(chain, Load(tip_moment=2 * np.pi))        # into a full circle
    >>> bool(np.abs(rolled.nodes[-1]).max() < 1e-12)
    True
    >>> buckled = find_equilibrium(chain, Load(axial_force=-10 * np.pi**2 / 4))
    >>> round(float(np.degrees(buckled.angle[-1])), 2), buckled.nodes[-1].round(4), buckled.is_stable
    (176.8, array([-0.5967,  0.4026]), True)
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    given = hub_load(chain, checked_load(load))
    if chain.pieces > MAX_BENT_PIECES:
        raise ValueError(f"chain must have at most {MAX_BENT_PIECES} pieces, got {chain.pieces}")
    if not 1e-13 <= real("tolerance", tolerance) <= MAX_TOLERANCE:
        raise ValueError(f"tolerance must be 1e-13 to {MAX_TOLERANCE}, got {shown(tolerance)}")
    statics = compile_statics(chain, given)
    if guess is not None:
        start = _started(chain, guess), np.zeros(statics.closures.size1_out(0))
        state = statics.solve(start, share=1.0, tolerance=tolerance, steps=100, longest=LONGEST_TURN)
    else:
        state = shape_under(chain, statics, given, tolerance)
    if state is None:
        raise _lost(chain, given)
    return _in_physical_units(chain, given, state)


def _started(chain: Chain, guess: Equilibrium | ArrayLike) -> Array:
    """Return the coordinates to start from, in the chain's own units."""
    size = len(coordinate_names(chain))
    values = guess.coordinates if isinstance(guess, Equilibrium) else real_numbers("guess", guess)
    if values.shape != (size,):
        raise ValueError(f"guess must hold {size} finite coordinates, got {shown(guess)}")
    return np.asarray(values / _unit(chain))


def _unit(chain: Chain) -> Array:
    """Return what one stands for in each coordinate in the chain's own units."""
    tips = len(tip_names(chain))
    return np.where(np.arange(len(coordinate_names(chain))) < tips, chain.units.length, 1.0)


def _in_physical_units(chain: Chain, load: Load, state: State) -> Equilibrium:
    unit, units = _unit(chain), chain.units
    return Equilibrium(
        chain,
        load,
        state.coordinates * unit,
        state.multipliers * (units.stiffness / units.length),
        state.tangent * units.stiffness / np.outer(unit, unit),
        state.basis * unit[:, None],
        state.residual,
        state.is_stable,
    )


def _lost(chain: Chain, load: Load) -> EquilibriumNotFound:
    return EquilibriumNotFound(
        f"load must leave {chain.boundary.name} a stable shape that it reaches from the straight one without "
        f"a jump, got {load}: give a guess nearer to the shape that you look for"
    )
