"""A chain whose forces balance, and whether it is stable, in the chain's own units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["State"]

Array = NDArray[np.float64]

#: What rounding leaves of a motion that stores nothing, in the largest stiffness.
_NOTHING = 1e-14


@dataclass(frozen=True)
class State:
    """Coordinates and multipliers at which forces balance.

    Attributes
    ----------
    coordinates, multipliers : ndarray, shape (n,) and (closures,)
        q and λ.
    tangent : ndarray, shape (n, n)
        ∂/∂q (s - (∂c/∂q)ᵀ λ).
    rows : ndarray, shape (closures, n)
        ∂c/∂q.
    residual : float
        Largest entry of s - (∂c/∂q)ᵀ λ and c.
    """

    coordinates: Array
    multipliers: Array
    tangent: Array
    rows: Array
    residual: float

    @property
    def basis(self) -> Array:
        """Orthonormal columns that span what the closures allow, shape (n, independent)."""
        if not len(self.rows):
            return np.eye(len(self.coordinates))
        return np.asarray(np.linalg.qr(self.rows.T, mode="complete")[0][:, len(self.rows) :])

    @property
    def reduced(self) -> Array:
        """The tangent on that basis."""
        if not len(self.rows):
            return self.tangent
        basis = self.basis
        return np.asarray(basis.T @ self.tangent @ basis)

    @property
    def is_stable(self) -> bool:
        """Whether every small motion that the closures allow stores energy."""
        return _is_positive(self.reduced, -_NOTHING)

    @property
    def is_indifferent(self) -> bool:
        """Whether such a motion stores nothing, and none releases energy."""
        return not self.is_stable and _is_positive(self.reduced, 100 * _NOTHING)


def _is_positive(matrix: Array, shift: float) -> bool:
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
