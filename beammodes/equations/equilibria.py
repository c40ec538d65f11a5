"""The shape in which a loaded chain rests, however far that is from straight.

Newton's method for  s(q) - (∂c/∂q)ᵀ λ = 0,  c(q) = 0,  in the chain's own units. Static forces are affine in
dead forces, weights and Ω² alike, so those under a share f of the load,

    s(q; f) = s(q; 0) + f (s(q; 1) - s(q; 0)),

are compiled once for every f. The load is applied little by little along stable shapes, from straight, so a
chain never jumps to another shape. Where it buckles, a push along the shape that has lost its stiffness leads
it onto the branch that bends upwards, and is taken away again under the whole load.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.chain import Chain
from beammodes.checks import real, real_numbers, shown
from beammodes.equations.mechanics import (
    Algebra,
    coordinate_names,
    energies,
    held_chain_load,
    static_forces,
    tip_names,
    unpack,
)
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load

__all__ = ["Equilibrium", "EquilibriumNotFound", "find_equilibrium"]

#: The tangent of a longer chain, a full matrix, would fill memory.
MAX_BENT_PIECES = 2000
#: A looser tolerance would let shapes pass that are no equilibria.
MAX_TOLERANCE = 1e-3
#: Largest turn of a piece from one share of the load to the next [rad].
LONGEST_TURN = 0.4
#: Smallest step of the share: to find where the chain buckles, and to follow it from there.
_COARSE, _FINE = 1e-4, 1e-7
#: Largest rotation that the push which decides a buckling chain causes without load [rad].
_PUSHED = 0.01
#: What rounding leaves of a motion that stores nothing, in the largest stiffness.
_NOTHING = 1e-14
#: Up to so many coordinates a full matrix is solved faster than a sparse one.
_SMALL = 30


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
        True if every such motion stores energy.
    """

    chain: Chain
    load: Load
    coordinates: Floats
    multipliers: Floats
    tangent: Floats
    basis: Floats
    residual: float
    is_stable: bool

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
    def stored_energy(self) -> float:
        """Energy in the hinges' springs and the ends' supports [J]."""
        still, algebra = [0.0] * len(self.coordinates), Algebra.physical(self.chain, math.sin, math.cos)
        return float(energies(self.chain, self.coordinates.tolist(), still, algebra).potential)

    def __repr__(self) -> str:
        x, y = self.nodes[-1]
        stable = "stable" if self.is_stable else "unstable"
        at = f"right tip at x = {x:.6g}, y = {y:.6g} m"
        return f"Equilibrium({stable}, {at}; {self.chain!r} under {self.load})"


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
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=50)
    >>> rolled = bm.find_equilibrium(chain, bm.Load(tip_moment=2 * np.pi))        # into a full circle
    >>> bool(np.abs(rolled.nodes[-1]).max() < 1e-12)
    True
    >>> buckled = bm.find_equilibrium(chain, bm.Load(axial_force=-10 * np.pi**2 / 4))
    >>> round(float(np.degrees(buckled.angle[-1])), 2), buckled.nodes[-1].round(4), buckled.is_stable
    (176.8, array([-0.5967,  0.4026]), True)
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    given = held_chain_load(chain, checked_load(load))
    if chain.pieces > MAX_BENT_PIECES:
        raise ValueError(f"chain must have at most {MAX_BENT_PIECES} pieces, got {chain.pieces}")
    if not 1e-13 <= real("tolerance", tolerance) <= MAX_TOLERANCE:
        raise ValueError(f"tolerance must be 1e-13 to {MAX_TOLERANCE}, got {shown(tolerance)}")
    statics = _compiled(chain, given)
    if guess is not None:
        start = _started(chain, guess), np.zeros(statics.closures.size1_out(0))
        state = statics.solve(start, share=1.0, tolerance=tolerance, steps=100, longest=LONGEST_TURN)
    else:
        state = _shape_under(chain, statics, given, tolerance)
    if state is None:
        raise _lost(chain, given)
    return _in_physical_units(chain, given, state)


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


def _in_physical_units(chain: Chain, load: Load, state: _State) -> Equilibrium:
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


@dataclass(frozen=True)
class _State:
    """Balanced q and λ, with ∂/∂q (s - (∂c/∂q)ᵀ λ), ∂c/∂q and the largest entry of what is unbalanced."""

    coordinates: Floats
    multipliers: Floats
    tangent: Floats
    rows: Floats
    residual: float

    @property
    def basis(self) -> Floats:
        """Orthonormal columns that span what the closures allow, shape (n, independent)."""
        if not len(self.rows):
            return np.eye(len(self.coordinates))
        return np.asarray(np.linalg.qr(self.rows.T, mode="complete")[0][:, len(self.rows) :])

    @property
    def reduced(self) -> Floats:
        """The tangent on that basis."""
        return np.asarray(self.basis.T @ self.tangent @ self.basis) if len(self.rows) else self.tangent

    @property
    def is_stable(self) -> bool:
        """True if every small motion that the closures allow stores energy."""
        return _is_positive(self.reduced, -_NOTHING)

    @property
    def is_indifferent(self) -> bool:
        """True if such a motion stores nothing, and none releases energy."""
        return not self.is_stable and _is_positive(self.reduced, 100 * _NOTHING)


def _is_positive(matrix: Floats, shift: float) -> bool:
    """Say whether a matrix is positive definite, with a share of its largest entry added to its diagonal."""
    if not matrix.size:
        return True
    shifted = matrix + shift * float(np.abs(matrix.diagonal()).max()) * np.eye(len(matrix))
    try:
        if np.triu(shifted, 2).any():
            np.linalg.cholesky(shifted)
        else:
            from scipy.linalg import cholesky_banded

            above = np.concatenate([[0.0], shifted.diagonal(1)])
            cholesky_banded(np.stack([above, shifted.diagonal()]))
    except np.linalg.LinAlgError:
        return False
    return True


@dataclass(frozen=True)
class _Statics:
    """A chain's forces at rest under any share of its load, compiled.

    `balance` is  s - (∂c/∂q)ᵀ λ  of (q, λ, f) and `tangent` its derivative, times given directions if not
    sparse; `closures` and `rows` are c and ∂c/∂q of q. `scale` is what counts as one in each coordinate: a
    radian, or the chain's length.
    """

    scale: Floats
    balance: Any
    tangent: Any
    closures: Any
    rows: Any
    is_sparse: bool

    def solve(
        self,
        start: tuple[Floats, Floats],
        *,
        share: float,
        push: Floats | float = 0.0,
        tolerance: float,
        steps: int = 12,
        longest: float = np.inf,
    ) -> _State | None:
        """Return the state that Newton's method finds from q and λ under a share of the load and a push.

        `tolerance` is the step that ends the search, `longest` the longest one that is taken whole [rad].
        """
        q, multipliers = start
        for _ in range(steps):
            unbalanced, gap = self._forces(q, multipliers, share, push)
            right = -np.concatenate([unbalanced, gap])
            # A chain balanced to the last digit may be free to move: there is nothing to solve.
            if right.any():
                right = _solved(self._tangent(q, multipliers, share), np.array(self.rows(q).full()), right)
            step, multipliers = right[: len(q)], multipliers + right[len(q) :]
            size = float(np.abs(step / self.scale).max(initial=0.0))
            if not np.isfinite(size):
                return None
            q = q + step * min(1.0, longest / size if size else 1.0)
            if size <= tolerance:
                return self.state(q, multipliers, share, push)
        return None

    def state(self, q: Floats, multipliers: Floats, share: float, push: Floats | float = 0.0) -> _State:
        """Return all that is known of a chain at q."""
        tangent = self._tangent(q, multipliers, share)
        full = np.asarray(tangent.toarray() if self.is_sparse else tangent)
        unbalanced = np.concatenate(self._forces(q, multipliers, share, push))
        residual = float(np.abs(unbalanced).max(initial=0.0))
        return _State(q, multipliers, full, np.array(self.rows(q).full()), residual)

    def _forces(
        self, q: Floats, multipliers: Floats, share: float, push: Floats | float
    ) -> tuple[Floats, Floats]:
        unbalanced = np.array(self.balance(q, multipliers, share).full())[:, 0] - push
        return unbalanced, np.array(self.closures(q).full())[:, 0]

    def _tangent(self, q: Floats, multipliers: Floats, share: float) -> Any:
        if self.is_sparse:
            return self.tangent(q, multipliers, share).sparse().tocsc()
        if not len(q):
            return np.zeros((0, 0))
        still, directions = np.zeros_like(multipliers), np.eye(len(q))
        return np.array(self.tangent(q, multipliers, share, 0, directions, still, 0).full())


def _compiled(chain: Chain, load: Load) -> _Statics:
    import casadi

    from beammodes.equations.numeric import column

    names = coordinate_names(chain)
    q, share = casadi.SX.sym("q", len(names)), casadi.SX.sym("share")
    algebra = Algebra(float, casadi.sin, casadi.cos, 1.0, 1.0, 1.0)
    entries = casadi.vertsplit(q) if names else []
    bare, loaded = (column(static_forces(chain, entries, algebra, given)[2]) for given in (None, load))
    closures = column(energies(chain, entries, [0.0] * len(names), algebra).closures)
    multipliers = casadi.SX.sym("multipliers", closures.rows())
    rows = casadi.jacobian(closures, q)
    balance = bare + share * (loaded - bare) - rows.T @ multipliers
    function = casadi.Function("balance", [q, multipliers, share], [balance])
    # Forces that a piece feels from its neighbours and from what lies beyond make ∂s/∂q tridiagonal; spin,
    # and springs at the right end, fill it.
    is_sparse = len(names) > _SMALL and casadi.jacobian_sparsity(balance, q).nnz() < 10 * len(names)
    if is_sparse:
        tangent = casadi.Function("tangent", [q, multipliers, share], [casadi.jacobian(balance, q)])
    else:
        tangent = function.forward(1)
    total = float(sum(chain.scaled.length))
    return _Statics(
        np.array([1.0 if name.startswith("theta") else total for name in names]),
        function,
        tangent,
        casadi.Function("closures", [q], [closures]),
        casadi.Function("rows", [q], [rows]),
        is_sparse,
    )


def _solved(tangent: Any, rows: Floats, right: Floats) -> Floats:
    """Return (δ, μ) of  K δ - Rᵀ μ = right,  R δ = right;  NaN where that is singular."""
    try:
        if isinstance(tangent, np.ndarray):
            whole = np.block([[tangent, -rows.T], [rows, np.zeros((len(rows), len(rows)))]])
            return np.asarray(np.linalg.solve(whole, right))
        from scipy.sparse import bmat, csc_matrix
        from scipy.sparse.linalg import splu

        border = csc_matrix(rows)
        blocks = bmat([[tangent, -border.T], [border, None]], format="csc") if len(rows) else tangent
        return np.asarray(splu(blocks).solve(right))
    except (np.linalg.LinAlgError, RuntimeError):
        return np.full(len(right), np.nan)


def _shape_under(chain: Chain, statics: _Statics, load: Load, tolerance: float) -> _State | None:
    """Return the state that the chain is in when the whole load has been applied."""
    closures = statics.closures.size1_out(0)
    rest = statics.state(np.zeros(len(statics.scale)), np.zeros(closures), 0.0)

    def loaded(state: _State, share: float) -> _State | None:
        return statics.solve((state.coordinates, state.multipliers), share=share, tolerance=tolerance)

    reached, last = _along(statics, rest, loaded, _COARSE)
    if reached or not last.reduced.size:
        return last
    if not rest.is_stable:
        # A chain that nothing holds stays as it is, unless the load moves it.
        straight = None if load.bends else loaded(rest, 1.0)
        return straight if straight is not None and straight.is_indifferent else None
    push = rest.tangent @ _softest(chain, last)

    def pushed(state: _State, share: float, amount: float = 1.0) -> _State | None:
        start = state.coordinates, state.multipliers
        return statics.solve(start, share=share, push=amount * push, tolerance=tolerance)

    ready = pushed(rest, 0.0)
    reached, last = _along(statics, ready, pushed, _FINE) if ready else (False, rest)
    if reached:
        reached, last = _along(statics, last, lambda state, done: pushed(state, 1.0, 1.0 - done), _FINE)
    return last if reached else None


def _along(
    statics: _Statics,
    state: _State,
    solve: Callable[[_State, float], _State | None],
    least: float,
) -> tuple[bool, _State]:
    """Follow stable states from 0 to 1: whether 1 is reached, and the last of them."""
    done, step = 0.0, 0.125
    while done < 1.0 and step > least:
        following = solve(state, min(1.0, done + step))
        if following is None or _turned(statics, state, following) > LONGEST_TURN or not following.is_stable:
            step /= 2
            continue
        done, state, step = min(1.0, done + step), following, 2 * step
    return done == 1.0, state


def _turned(statics: _Statics, state: _State, following: _State) -> float:
    moved = (following.coordinates - state.coordinates) / statics.scale
    return float(np.abs(moved).max(initial=0.0))


def _softest(chain: Chain, state: _State) -> Floats:
    """Return the motion that stores least: its largest rotation is small, its largest deflection upwards."""
    motion = state.basis @ np.linalg.eigh(state.reduced)[1][:, 0]
    (_, angles), (tip, turns) = (unpack(chain, q.tolist()) for q in (state.coordinates, motion))
    lengths = chain.length / chain.units.length
    lift = np.cumsum([tip[1], *(lengths * np.cos(np.array(angles, dtype=np.float64)) * turns)])
    upwards = np.sign(lift[np.abs(lift).argmax()]) or 1.0
    return np.asarray(motion * (upwards * _PUSHED / np.abs(turns).max()))
