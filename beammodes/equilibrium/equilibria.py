"""Where a loaded chain comes to rest, however far that is from straight.

The load is applied little by little, so that the chain is followed from its straight shape and never jumps to
another. Where it buckles, a push along the shape that has lost its stiffness leads it onto the branch that
bends upwards; the push is taken away again under the whole load.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import real, shown
from beammodes.equations.axial_pull import hub_load
from beammodes.equations.coordinates import coordinate_names, tip_names, unpack
from beammodes.equations.mechanics import Algebra, energies
from beammodes.equilibrium.static_newton import State, Statics, compile_statics
from beammodes.problem.loading import Load, checked_load

__all__ = ["MAX_BENT_PIECES", "Equilibrium", "EquilibriumNotFound", "find_equilibrium"]

Array = NDArray[np.float64]

#: The tangent of a longer chain, a full matrix, would fill memory.
MAX_BENT_PIECES = 2000

#: Largest turn of a piece from one share of the load to the next [rad].
_TURN = 0.4

#: Smallest step of the share: to find where the chain buckles, and to follow it from there.
_COARSE, _FINE = 1e-4, 1e-7

#: Largest rotation that the push which decides a buckling chain causes without load [rad].
_PUSHED = 0.01


class EquilibriumNotFound(ValueError):
    """Newton's method reaches no equilibrium from where it was started."""


@dataclass(frozen=True, eq=False)
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
        Largest last step of Newton's method (of deflections: relative to the chain's length), 1e-13 or more.

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
    >>> np.degrees(buckled.angle[-1]).round(2), buckled.nodes[-1].round(4), buckled.is_stable
    (np.float64(176.8), array([-0.5967,  0.4026]), True)
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    given = hub_load(chain, checked_load(load))
    if chain.pieces > MAX_BENT_PIECES:
        raise ValueError(f"chain must have at most {MAX_BENT_PIECES} pieces, got {chain.pieces}")
    if real("tolerance", tolerance) < 1e-13:
        raise ValueError(f"tolerance must be at least 1e-13, got {shown(tolerance)}")
    statics = compile_statics(chain, given)
    if guess is not None:
        start = _started(chain, guess), np.zeros(statics.closures.size1_out(0))
        state = statics.solve(start, share=1.0, tolerance=tolerance, steps=100, longest=_TURN)
    else:
        state = _followed(chain, statics, given, tolerance)
    if state is None:
        raise _lost(chain, given)
    return _in_physical_units(chain, given, state)


def _started(chain: Chain, guess: Equilibrium | ArrayLike) -> Array:
    """Return the coordinates to start from, in the chain's own units."""
    values = guess.coordinates if isinstance(guess, Equilibrium) else np.asarray(guess, dtype=np.float64)
    size = len(coordinate_names(chain))
    if values.shape != (size,) or not np.isfinite(values).all():
        raise ValueError(f"guess must hold {size} finite coordinates, got {shown(guess)}")
    return np.asarray(values / _unit(chain))


def _followed(chain: Chain, statics: Statics, load: Load, tolerance: float) -> State | None:
    """Return the state that the chain is in when the whole load has been applied."""
    closures = statics.closures.size1_out(0)
    rest = statics.state(np.zeros(len(statics.scale)), np.zeros(closures), 0.0)

    def loaded(state: State, share: float) -> State | None:
        return statics.solve((state.coordinates, state.multipliers), share=share, tolerance=tolerance)

    reached, last = _along(statics, rest, loaded, _COARSE)
    if reached or not last.reduced.size:
        return last
    if not rest.is_stable:
        # A chain that nothing holds stays as it is, unless the load moves it.
        straight = None if load.bends else loaded(rest, 1.0)
        return straight if straight is not None and straight.is_indifferent else None
    push = rest.tangent @ _softest(chain, last)

    def pushed(state: State, share: float, amount: float = 1.0) -> State | None:
        start = state.coordinates, state.multipliers
        return statics.solve(start, share=share, push=amount * push, tolerance=tolerance)

    ready = pushed(rest, 0.0)
    reached, last = _along(statics, ready, pushed, _FINE) if ready else (False, rest)
    if reached:
        reached, last = _along(statics, last, lambda state, done: pushed(state, 1.0, 1.0 - done), _FINE)
    return last if reached else None


def _along(
    statics: Statics, state: State, solve: Callable[[State, float], State | None], least: float
) -> tuple[bool, State]:
    """Follow stable states from 0 to 1: whether 1 is reached, and the last of them."""
    done, step = 0.0, 0.125
    while done < 1.0 and step > least:
        following = solve(state, min(1.0, done + step))
        if following is None or _turned(statics, state, following) > _TURN or not following.is_stable:
            step /= 2
            continue
        done, state, step = min(1.0, done + step), following, 2 * step
    return done == 1.0, state


def _turned(statics: Statics, state: State, following: State) -> float:
    moved = (following.coordinates - state.coordinates) / statics.scale
    return float(np.abs(moved).max(initial=0.0))


def _softest(chain: Chain, state: State) -> Array:
    """Return the motion that stores least: its largest rotation is small, its largest deflection upwards."""
    motion = state.basis @ np.linalg.eigh(state.reduced)[1][:, 0]
    (_, angles), (tip, turns) = (unpack(chain, q.tolist()) for q in (state.coordinates, motion))
    lengths = chain.length / chain.units.length
    lift = np.cumsum([tip[1], *(lengths * np.cos(np.array(angles, dtype=np.float64)) * turns)])
    upwards = np.sign(lift[np.abs(lift).argmax()]) or 1.0
    return np.asarray(motion * (upwards * _PUSHED / np.abs(turns).max()))


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
