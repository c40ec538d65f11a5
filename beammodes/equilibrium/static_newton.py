"""Newton's method for a chain at rest, s(q) - (∂c/∂q)ᵀ λ = 0 and c(q) = 0, under a share of its load.

Static forces are affine in dead forces, weights and Ω² alike, so those under a share f of the load are

    s(q; f) = s(q; 0) + f (s(q; 1) - s(q; 0)),

compiled once for every f. All numbers are in the chain's own units. Under forces that a piece feels from its
neighbours and from what lies beyond alike, ∂s/∂q is tridiagonal; spin, and springs at the right end, fill it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.equations.coordinates import coordinate_names
from beammodes.equations.load_field import static_forces
from beammodes.equations.mechanics import Algebra, energies
from beammodes.equilibrium.static_state import State
from beammodes.problem.loading import Load

__all__ = ["Statics", "compile_statics"]

Array = NDArray[np.float64]

#: Up to here a full matrix is solved faster than a sparse one.
_SMALL = 30


@dataclass(frozen=True)
class Statics:
    """A chain's forces at rest, compiled.

    Attributes
    ----------
    scale : ndarray, shape (n,)
        What counts as one in each coordinate: a radian, or the chain's length.
    balance, tangent : casadi.Function
        s - (∂c/∂q)ᵀ λ and its derivative of (q, λ, f); the latter times each of n directions if not sparse.
    closures, rows : casadi.Function
        c and ∂c/∂q of q.
    """

    scale: Array
    balance: Any
    tangent: Any
    closures: Any
    rows: Any
    is_sparse: bool

    def solve(
        self,
        start: tuple[Array, Array],
        *,
        share: float,
        push: Array | float = 0.0,
        tolerance: float,
        steps: int = 12,
        longest: float = np.inf,
    ) -> State | None:
        """Return the state that Newton's method finds from q and λ, None if it finds none.

        Parameters
        ----------
        share : float
            Of the load.
        push : ndarray, shape (n,)
            Forces to hold beside the load.
        tolerance, longest : float
            The step that ends the search, and the longest one that is taken whole [rad].
        steps : int
            How many at most.
        """
        q, multipliers = start
        for _ in range(steps):
            step, multipliers = self._step(q, multipliers, share, push)
            size = float(np.abs(step / self.scale).max(initial=0.0))
            if not np.isfinite(size):
                return None
            q = q + step * min(1.0, longest / size if size else 1.0)
            if size <= tolerance:
                return self.state(q, multipliers, share, push)
        return None

    def state(self, q: Array, multipliers: Array, share: float, push: Array | float = 0.0) -> State:
        """Return all that is known of a chain at q."""
        unbalanced, gap = self._forces(q, multipliers, share, push)
        tangent = self._tangent(q, multipliers, share)
        full = np.asarray(tangent.toarray() if self.is_sparse else tangent)
        residual = float(np.abs(np.concatenate([unbalanced, gap])).max(initial=0.0))
        return State(q, multipliers, full, np.array(self.rows(q).full()), residual)

    def _forces(self, q: Array, multipliers: Array, share: float, push: Array | float) -> tuple[Array, Array]:
        unbalanced = np.array(self.balance(q, multipliers, share).full())[:, 0] - push
        return unbalanced, np.array(self.closures(q).full())[:, 0]

    def _tangent(self, q: Array, multipliers: Array, share: float) -> Any:
        if self.is_sparse:
            return self.tangent(q, multipliers, share).sparse().tocsc()
        if not len(q):
            return np.zeros((0, 0))
        still = np.zeros_like(multipliers)
        directions = np.eye(len(q))
        return np.array(self.tangent(q, multipliers, share, 0, directions, still, 0).full())

    def _step(self, q: Array, multipliers: Array, share: float, push: Array | float) -> tuple[Array, Array]:
        """Return Newton's step of q, and λ after it; NaN where the matrix is singular."""
        unbalanced, gap = self._forces(q, multipliers, share, push)
        tangent, rows = self._tangent(q, multipliers, share), np.array(self.rows(q).full())
        right = -np.concatenate([unbalanced, gap])
        # A chain balanced to the last digit may be free to move: there is nothing to solve.
        solution = _solved(tangent, rows, right) if right.any() else right
        return solution[: len(q)], multipliers + solution[len(q) :]


def compile_statics(chain: Chain, load: Load) -> Statics:
    """Return the forces of a chain at rest under any share of a load."""
    import casadi

    names = coordinate_names(chain)
    q, share = casadi.SX.sym("q", len(names)), casadi.SX.sym("share")
    algebra = Algebra(float, casadi.sin, casadi.cos, 1.0, 1.0, 1.0)
    entries = casadi.vertsplit(q) if names else []
    bare, loaded = (_column(static_forces(chain, entries, algebra, given)[2]) for given in (None, load))
    closures = _column(energies(chain, entries, [0.0] * len(names), algebra).closures)
    multipliers = casadi.SX.sym("multipliers", closures.rows())
    rows = casadi.jacobian(closures, q)
    balance = bare + share * (loaded - bare) - rows.T @ multipliers
    function = casadi.Function("balance", [q, multipliers, share], [balance])
    is_sparse = len(names) > _SMALL and casadi.jacobian_sparsity(balance, q).nnz() < 10 * len(names)
    if is_sparse:
        tangent = casadi.Function("tangent", [q, multipliers, share], [casadi.jacobian(balance, q)])
    else:
        tangent = function.forward(1)
    total = float(sum(chain.piece_length))
    return Statics(
        np.array([1.0 if name.startswith("theta") else total for name in names]),
        function,
        tangent,
        casadi.Function("closures", [q], [closures]),
        casadi.Function("rows", [q], [rows]),
        is_sparse,
    )


def _column(entries: Sequence[Any]) -> Any:
    import casadi

    return casadi.SX(casadi.vertcat(*entries)) if len(entries) else casadi.SX(0, 1)


def _solved(tangent: Any, rows: Array, right: Array) -> Array:
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
