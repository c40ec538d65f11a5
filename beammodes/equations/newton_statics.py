"""A chain's forces at rest under any share of its load, compiled, and Newton's method for their balance.

    s(q; f) - (∂c/∂q)ᵀ λ = 0,     c(q) = 0,     s(q; f) = s(q; 0) + f (s(q; 1) - s(q; 0))

in the chain's own units. A step costs in proportion to the chain's length: ∂s/∂q is tridiagonal, bordered by
one or two closures.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.equations.mechanics import Algebra, coordinate_names, end_closures, static_forces
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load

__all__ = ["LONGEST_TURN", "ChainStatics", "StaticState", "compiled_statics", "followed"]

#: Largest turn of a piece from one share of the load to the next [rad].
LONGEST_TURN = 0.4
#: What rounding leaves of a motion that stores nothing, in the largest stiffness.
_NOTHING = 1e-14
#: Up to so many coordinates a full matrix is solved faster than a sparse one.
_SMALL = 30


@dataclass(frozen=True)
class StaticState:
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
class ChainStatics:
    """A chain's forces at rest under any share of its load, compiled.

    `balance` is  s - (∂c/∂q)ᵀ λ  of (q, λ, f, span) and `tangent` its derivative, times given directions if
    not sparse; `closures` and `rows` are c and ∂c/∂q of (q, span). `scale` is what counts as one in each
    coordinate: a radian, or the chain's length. `span` is where the right end is held, apart from the left
    one, in the chain's own units; else it means nothing.
    """

    scale: Floats
    balance: Any
    tangent: Any
    closures: Any
    rows: Any
    is_sparse: bool
    span: tuple[float, float] = (0.0, 0.0)

    @property
    def closed(self) -> int:
        """Number of closures."""
        return int(self.closures.size1_out(0))

    def spanning(self, span: tuple[float, float]) -> ChainStatics:
        """Return the same chain with its right end held at another place."""
        return replace(self, span=span)

    def solve(
        self,
        start: tuple[Floats, Floats],
        *,
        share: float,
        push: Floats | float = 0.0,
        tolerance: float,
        steps: int = 12,
        longest: float = np.inf,
    ) -> StaticState | None:
        """Return the state that Newton's method finds from q and λ under a share of the load and a push.

        `tolerance` is the step that ends the search, `longest` the longest one that is taken whole [rad].
        """
        q, multipliers = start
        for _ in range(steps):
            unbalanced, gap = self._forces(q, multipliers, share, push)
            right = -np.concatenate([unbalanced, gap])
            # A chain balanced to the last digit may be free to move: there is nothing to solve.
            if right.any():
                right = _solved(self._tangent(q, multipliers, share), self._rows(q), right)
            step, multipliers = right[: len(q)], multipliers + right[len(q) :]
            size = float(np.abs(step / self.scale).max(initial=0.0))
            if not np.isfinite(size):
                return None
            q = q + step * min(1.0, longest / size if size else 1.0)
            if size <= tolerance:
                return self.state(q, multipliers, share, push)
        return None

    def best_multipliers(self, q: Floats) -> Floats:
        """Return the multipliers that leave least unbalanced at q under the whole load."""
        unbalanced, _ = self._forces(q, np.zeros(self.closed), 1.0, 0.0)
        return np.asarray(np.linalg.lstsq(self._rows(q).T, unbalanced)[0])

    def _rows(self, q: Floats) -> Floats:
        return np.array(self.rows(q, self.span).full())

    def state(self, q: Floats, multipliers: Floats, share: float, push: Floats | float = 0.0) -> StaticState:
        """Return all that is known of a chain at q."""
        tangent = self._tangent(q, multipliers, share)
        full = np.asarray(tangent.toarray() if self.is_sparse else tangent)
        unbalanced = np.concatenate(self._forces(q, multipliers, share, push))
        residual = float(np.abs(unbalanced).max(initial=0.0))
        return StaticState(q, multipliers, full, self._rows(q), residual)

    def _forces(
        self, q: Floats, multipliers: Floats, share: float, push: Floats | float
    ) -> tuple[Floats, Floats]:
        unbalanced = np.array(self.balance(q, multipliers, share, self.span).full())[:, 0] - push
        return unbalanced, np.array(self.closures(q, self.span).full())[:, 0]

    def _tangent(self, q: Floats, multipliers: Floats, share: float) -> Any:
        if self.is_sparse:
            return self.tangent(q, multipliers, share, self.span).sparse().tocsc()
        if not len(q):
            return np.zeros((0, 0))
        still, directions = np.zeros_like(multipliers), np.eye(len(q))
        given = q, multipliers, share, self.span
        return np.array(self.tangent(*given, 0, directions, still, 0, np.zeros(2)).full())


def compiled_statics(chain: Chain, load: Load, *, span: tuple[float, float] | None = None) -> ChainStatics:
    """Return the forces of a chain at rest; with a `span` [m] both its ends are held apart."""
    import casadi

    from beammodes.equations.numeric import column

    names = coordinate_names(chain)
    q, share, place = (casadi.SX.sym(*each) for each in (("q", len(names)), ("share",), ("span", 2)))
    algebra = Algebra(float, casadi.sin, casadi.cos, 1.0, 1.0, 1.0)
    entries, ends = casadi.vertsplit(q) if names else [], None if span is None else (place[0], place[1])
    (x, y, alone), (_, _, under) = (static_forces(chain, entries, algebra, each) for each in (None, load))
    bare, loaded, closures = map(column, (alone, under, end_closures(chain, x, y, algebra, ends)))
    multipliers = casadi.SX.sym("multipliers", closures.rows())
    rows = casadi.jacobian(closures, q)
    balance = bare + share * (loaded - bare) - rows.T @ multipliers
    given = [q, multipliers, share, place]
    function = casadi.Function("balance", given, [balance])
    # Forces that a piece feels from its neighbours and from what lies beyond make ∂s/∂q tridiagonal; spin,
    # and springs at the right end, fill it.
    is_sparse = len(names) > _SMALL and casadi.jacobian_sparsity(balance, q).nnz() < 10 * len(names)
    if is_sparse:
        tangent = casadi.Function("tangent", given, [casadi.jacobian(balance, q)])
    else:
        tangent = function.forward(1)
    total = float(sum(chain.scaled.length))
    return ChainStatics(
        np.array([1.0 if name.startswith("theta") else total for name in names]),
        function,
        tangent,
        casadi.Function("closures", [q, place], [closures]),
        casadi.Function("rows", [q, place], [rows]),
        is_sparse,
        (0.0, 0.0) if span is None else (span[0] / chain.units.length, span[1] / chain.units.length),
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
        # Borders are eliminated last, so that the fill stays in proportion to the chain's length.
        order: dict[str, Any] = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.1}
        factors = splu(blocks, options={"SymmetricMode": True}, **order) if len(rows) else splu(blocks)
        return np.asarray(factors.solve(right))
    except (np.linalg.LinAlgError, RuntimeError):
        return np.full(len(right), np.nan)


def followed(
    statics: ChainStatics,
    state: StaticState,
    solve: Callable[[StaticState, float], StaticState | None],
    least: float,
    *,
    stable: bool = True,
) -> tuple[bool, StaticState]:
    """Follow states, stable ones if asked for, from 0 to 1: whether 1 is reached, and the last of them."""
    done, step = 0.0, 0.125
    while done < 1.0 and step > least:
        following = solve(state, min(1.0, done + step))
        if (
            following is None
            or _turned(statics, state, following) > LONGEST_TURN
            or (stable and not following.is_stable)
        ):
            step /= 2
            continue
        done, state, step = min(1.0, done + step), following, 2 * step
    return done == 1.0, state


def _turned(statics: ChainStatics, state: StaticState, following: StaticState) -> float:
    moved = (following.coordinates - state.coordinates) / statics.scale
    return float(np.abs(moved).max(initial=0.0))
