"""The shape in which a loaded chain rests, however far that is from straight.

Newton's method (`newton_statics`) solves  s(q) - (∂c/∂q)ᵀ λ = 0,  c(q) = 0.  The load is applied little by
little along stable shapes, from straight, so a chain never jumps to another shape. Where it buckles, a push
along the shape that has lost its stiffness leads it onto the branch that bends upwards, and is taken away
again under the whole load. Chains between two ends that are held apart have branches to choose from
(`held_apart`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.chain import Chain
from beammodes.checks import Shown, choice, instead, real, real_numbers, shown, whole_number
from beammodes.equations.held_apart import BRANCHES, checked_span, shape_between
from beammodes.equations.mechanics import (
    Algebra,
    Span,
    coordinate_names,
    energies,
    held_chain_load,
    tip_names,
    unpack,
)
from beammodes.equations.newton_statics import (
    LONGEST_TURN,
    ChainStatics,
    StaticState,
    compiled_statics,
    followed,
)
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load

__all__ = ["Equilibrium", "EquilibriumNotFound", "find_equilibrium"]

#: The tangent of a longer chain, a full matrix, would fill memory.
MAX_BENT_PIECES = 2000
#: A looser tolerance would let shapes pass that are no equilibria.
MAX_TOLERANCE = 1e-3
#: Smallest step of the share: to find where the chain buckles, and to follow it from there.
_COARSE, _FINE = 1e-4, 1e-7
#: Largest rotation that the push which decides a buckling chain causes without load [rad].
_PUSHED = 0.01


class EquilibriumNotFound(ValueError):
    """Newton's method reaches no equilibrium from where it was started."""


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium(Shown):
    """A chain at rest under a load.

    Attributes
    ----------
    chain : Chain
    load : Load
    coordinates : ndarray, shape (n,) [m, rad]
        q, in the order of `compile_equations`.
    multipliers : ndarray, shape (closures,) [N]
        Forces λ by which the right end holds its tip: along the beam, where it does, then across. Of ends
        held apart both, along x and y.
    tangent : ndarray, shape (n, n)
        Tangent stiffness ∂/∂q (s - (∂c/∂q)ᵀ λ) in these coordinates.
    basis : ndarray, shape (n, independent) [m, rad]
        Columns span the small motions that the closures allow.
    residual : float
        Largest unbalanced moment or force, or gap of a closure, in the chain's own units (`chain.units`).
    is_stable : bool
        True if every such motion stores energy.
    span : pair of float [m], or None
        From the left end to the right one, where both are held apart.
    """

    chain: Chain
    load: Load
    coordinates: Floats
    multipliers: Floats
    tangent: Floats
    basis: Floats
    residual: float
    is_stable: bool
    span: Span | None = None

    @property
    def angle(self) -> Floats:
        """Angle of every piece from the x axis, counter-clockwise, shape (pieces,) [rad]."""
        return np.array(unpack(self.chain, self.coordinates.tolist())[1], dtype=np.float64)

    @property
    def nodes(self) -> Floats:
        """(x, y) of the left tip, every hinge and the right tip, shape (pieces + 1, 2) [m]."""
        rods = self.chain.length[:, None] * np.stack([np.cos(self.angle), np.sin(self.angle)], axis=1)
        return np.cumsum([unpack(self.chain, self.coordinates.tolist())[0], *rods], axis=0)

    @property
    def position(self) -> Floats:
        """(x, y) of every hinge, shape (hinges, 2) [m]."""
        return self.nodes[1:-1]

    @property
    def tension(self) -> Floats:
        """Pull along every piece at its centre of mass, compression negative, shape (pieces,) [N].

        A heavy cable's largest pull is at its upper end: that of the right end is the size of `multipliers`.
        """
        chain, load, nodes = self.chain, self.load, self.nodes
        along = np.stack([np.cos(self.angle), np.sin(self.angle)], axis=1)
        centre = nodes[:-1] + chain.centre[:, None] * along
        radius = np.stack(
            [centre[:, 0] + float(load.hub_radius), centre[:, 1] * (load.plane == "lag")], axis=1
        )
        own = np.array(load.weight, dtype=np.float64) + float(load.spin_rate) ** 2 * radius
        own *= chain.mass[:, None]
        tip = np.array(load.tip, dtype=np.float64)
        tip[0] += float(load.axial_force)
        # Multipliers are those of the closures there are, along the beam and across.
        if chain.boundary.right.holds_deflection:
            tip[1] += self.multipliers[-1]
        else:
            tip[1] -= float(chain.support_stiffness[1, 0]) * nodes[-1, 1]
        if len(self.multipliers) > chain.boundary.right.holds_deflection:
            tip[0] += self.multipliers[0]
        beyond = np.cumsum(own[::-1], axis=0)[::-1] - own / 2 + tip
        return np.asarray((along * beyond).sum(axis=1))

    @property
    def stored_energy(self) -> float:
        """Energy in the hinges' springs and the ends' supports [J]."""
        still, algebra = [0.0] * len(self.coordinates), Algebra.physical(self.chain, math.sin, math.cos)
        return float(energies(self.chain, self.coordinates.tolist(), still, algebra).potential)

    def _line(self) -> str:
        x, y = self.nodes[-1]
        stable = "stable" if self.is_stable else "unstable"
        at = f"right tip at x = {x:.6g}, y = {y:.6g} m"
        return f"Equilibrium({stable}, {at}; {self.chain!r} under {self.load})"


def find_equilibrium(
    chain: Chain,
    load: Load | None,
    *,
    span: float | tuple[float, float] | None = None,
    branch: str | int | None = None,
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

    With a `span` both ends are held, at two points nearer to each other than the chain is long: a hanging
    cable, an arch, a buckled strip. A `branch` then says which of its many shapes is meant, and `is_stable`
    of what is found whether the chain would stay there. Arches and higher branches end at some load, where
    they snap through.

    Parameters
    ----------
    chain : Chain
        Of at most 2000 pieces.
    load : Load or None
        Of a turning hub: the shape is that relative to it. With `span` gravity and a tip's moment only.
    span : float or pair [m], optional
        From the left end to the right one, along the x axis, or its components (x, y). Both ends must hold
        their deflection: clamped ones, whose rotation is held along x, pinned ones, or those on rotational
        springs.
    branch : str or int, optional
        With `span`: "sag", below the line from the left end to the right one, "arch", above it, or the number
        of half waves that the chain buckles into without load (of a clamped one the number of its buckling
        mode): 1, 2, ... with the first one upwards, -1, -2, ... downwards, so that 1 is the arch. By default
        the side to which the weight pulls, without weight the arch; or the other one, where an almost taut
        chain has no shape on that side.
    guess : Equilibrium or array, shape (n,) [m, rad], optional
        Coordinates to start from under the whole load: what is found then need not be stable. Zeros keep
        a straight chain straight; another equilibrium with as many coordinates saves time.
    tolerance : float [rad]
        Largest last step of Newton's method (of deflections: relative to the chain's length), 1e-13 to 1e-3.

    Returns
    -------
    Equilibrium
        Angles, nodes and reactions, and whether the shape is stable.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain is too long, or nothing holds it against the load.
    EquilibriumNotFound
        If no equilibrium is found: nothing resists the chain's turning, or it snaps to a shape far away.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=50)
    >>> rolled = bm.find_equilibrium(chain, bm.Load(tip_moment=2 * np.pi))        # into a full circle
    >>> bool(np.abs(rolled.nodes[-1]).max() < 1e-12)
    True
    >>> buckled = bm.find_equilibrium(chain, bm.Load(axial_force=-10 * np.pi**2 / 4))
    >>> round(float(np.degrees(buckled.angle[-1])), 2), buckled.nodes[-1].round(4), buckled.is_stable
    (176.8, array([-0.5967,  0.4026]), True)

    A cable of 1000 m between two points, of which one is 100 m higher, and the pull on the right one:

    >>> cable = bm.Chain(bm.Beam(1000.0, 1e5, 200.0), "pinned-pinned", segments=100)
    >>> hung = bm.find_equilibrium(cable, bm.Load(gravity=9.81), span=(800.0, 100.0))
    >>> hung.multipliers.round(-2), hung.is_stable
    (array([ 671500., 1100100.]), True)
    """
    if not isinstance(chain, Chain):
        hint = instead(
            chain,
            SpatialChain="spatial_equilibrium takes a SpatialChain",
            StructureChain="chain_statics takes a StructureChain, for small deflections",
        )
        raise TypeError(f"chain must be a Chain, got {shown(chain)}{hint}")
    given = held_chain_load(chain, checked_load(load))
    if chain.pieces > MAX_BENT_PIECES:
        raise ValueError(f"chain must have at most {MAX_BENT_PIECES} pieces, got {chain.pieces}")
    if not 1e-13 <= real("tolerance", tolerance, "rad") <= MAX_TOLERANCE:
        raise ValueError(f"tolerance must be 1e-13 to {MAX_TOLERANCE}, got {shown(tolerance)}")
    apart = None if span is None else _checked_span(chain, given, span)
    branches = _checked_branch(branch, given, apart, guess, chain.pieces)
    statics = compiled_statics(chain, given, span=apart)
    if guess is not None:
        q = _started(chain, guess)
        start = q, statics.best_multipliers(q) if apart else np.zeros(statics.closed)
        state = statics.solve(start, share=1.0, tolerance=tolerance, steps=100, longest=LONGEST_TURN)
    elif apart is not None:
        state = shape_between(chain, statics, given, branches, tolerance)
    else:
        state = _shape_under(chain, statics, given, tolerance)
    if state is None:
        raise _lost(chain, given, apart)
    return _in_physical_units(chain, given, state, apart)


def _checked_span(chain: Chain, load: Load, span: object) -> Span:
    """Return where the right end is held, or raise what is wrong with that or with the load."""
    found = checked_span(chain, span)
    for name in ("axial_force", "spin_rate"):
        if getattr(load, name):
            raise ValueError(f"{name} must be 0 with span, where both ends are held, got {load}")
    if any(load.tip):
        raise ValueError(f"tip_force must be 0 with span, where the right tip is held, got {load}")
    return found


def _checked_branch(
    branch: object, load: Load, span: Span | None, guess: object, most: int
) -> tuple[int, ...]:
    """Return the number of a branch, or by default both first ones, to where the weight pulls first."""
    if span is None or guess is not None:
        if branch is not None:
            raise ValueError(f"branch must be left out without span and with guess, got {shown(branch)}")
        return ()
    if branch is None:
        gx, gy = map(float, load.weight)
        return (-1, 1) if span[0] * gy - span[1] * gx < 0 else (1, -1)
    if isinstance(branch, str):
        return (BRANCHES[choice("branch", branch, BRANCHES)],)
    number = whole_number("branch", branch, least=-most, most=most)
    if not number:
        raise ValueError("branch must be a number of half waves, positive or negative, got 0")
    return (number,)


def _started(chain: Chain, guess: Equilibrium | ArrayLike) -> Floats:
    """Return the coordinates to start from, in the chain's own units."""
    size = len(coordinate_names(chain))
    values = guess.coordinates if isinstance(guess, Equilibrium) else real_numbers("guess", guess)
    if values.shape != (size,):
        raise ValueError(f"guess must hold {size} finite coordinates, got {shown(guess)}")
    return np.asarray(values / _unit(chain))


def _unit(chain: Chain) -> Floats:
    """Return what one stands for in each coordinate in the chain's own units."""
    tips = len(tip_names(chain))
    return np.where(np.arange(len(coordinate_names(chain))) < tips, chain.units.length, 1.0)


def _in_physical_units(chain: Chain, load: Load, state: StaticState, span: Span | None) -> Equilibrium:
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
        span,
    )


def _lost(chain: Chain, load: Load, span: Span | None) -> EquilibriumNotFound:
    if span is not None:
        return EquilibriumNotFound(
            f"branch must be one that reaches the whole load without a jump, with ends {span} m apart under "
            f"{load} (arches and higher branches snap through): leave it out, choose another, or give a guess"
        )
    return EquilibriumNotFound(
        f"load must leave {chain.boundary.name} a stable shape that it reaches from the straight one without "
        f"a jump, got {load}: give a guess nearer to the shape that you look for"
    )


def _shape_under(chain: Chain, statics: ChainStatics, load: Load, tolerance: float) -> StaticState | None:
    """Return the state that the chain is in when the whole load has been applied."""
    closures = statics.closed
    rest = statics.state(np.zeros(len(statics.scale)), np.zeros(closures), 0.0)

    def loaded(state: StaticState, share: float) -> StaticState | None:
        return statics.solve((state.coordinates, state.multipliers), share=share, tolerance=tolerance)

    reached, last = followed(statics, rest, loaded, _COARSE)
    if reached or not last.reduced.size:
        return last
    if not rest.is_stable:
        # A chain that nothing holds stays as it is, unless the load moves it.
        straight = None if load.bends else loaded(rest, 1.0)
        return straight if straight is not None and straight.is_indifferent else None
    push = rest.tangent @ _softest(chain, last)

    def pushed(state: StaticState, share: float, amount: float = 1.0) -> StaticState | None:
        start = state.coordinates, state.multipliers
        return statics.solve(start, share=share, push=amount * push, tolerance=tolerance)

    ready = pushed(rest, 0.0)
    reached, last = followed(statics, ready, pushed, _FINE) if ready else (False, rest)
    if reached:
        reached, last = followed(statics, last, lambda state, done: pushed(state, 1.0, 1.0 - done), _FINE)
    return last if reached else None


def _softest(chain: Chain, state: StaticState) -> Floats:
    """Return the motion that stores least: its largest rotation is small, its largest deflection upwards."""
    motion = state.basis @ np.linalg.eigh(state.reduced)[1][:, 0]
    (_, angles), (tip, turns) = (unpack(chain, q.tolist()) for q in (state.coordinates, motion))
    lengths = chain.length / chain.units.length
    lift = np.cumsum([tip[1], *(lengths * np.cos(np.array(angles, dtype=np.float64)) * turns)])
    upwards = np.sign(lift[np.abs(lift).argmax()]) or 1.0
    return np.asarray(motion * (upwards * _PUSHED / np.abs(turns).max()))
