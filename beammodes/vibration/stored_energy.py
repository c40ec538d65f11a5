"""The energy that loads along a chain add to its flexibility form, as a factor or as a metric."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.vibration.spectrum import FlexibilityForm

__all__ = ["Buckled", "check_stable", "energy_metric", "unit_energy"]

Array = NDArray[np.float64]


class Buckled(ArithmeticError):
    """The straight shape is not stable."""


def unit_energy(form: FlexibilityForm, w: Array, x: Array) -> Array:
    """Return the upper triangle C⁻¹ of combinations that store unit energy, that of loads included."""
    slope = form.angles(x)
    plain = np.sqrt(1 - form.unstored)[:, None] * w
    if (form.pull >= 0).all():
        # No products are formed: they would square the range of a strong tension on soft supports.
        factor = np.linalg.qr(np.vstack([plain, np.sqrt(form.pull)[:, None] * slope]), mode="r")
        return np.asarray(np.linalg.inv(factor))
    try:
        lower = np.linalg.cholesky(plain.T @ plain + slope.T @ (form.pull[:, None] * slope))
    except np.linalg.LinAlgError:
        raise Buckled from None
    return np.asarray(np.linalg.inv(lower).T)


def check_stable(form: FlexibilityForm, dense: int) -> None:
    """Raise Buckled if loads turn a chain over, or buckle one of more than `dense` hinges.

    Of shorter ones `unit_energy` tells, which has all their motions.
    """
    from scipy.sparse.linalg import LinearOperator, eigsh

    if (form.pull >= 0).all():
        return
    if form.rigid_angle.any():
        raise Buckled
    size = len(form.flexibility_root)
    if form.hinges <= dense:
        return

    def released(w: Array) -> Array:
        return form.allowed(form.geometric(form.allowed(w.reshape(size, -1))))

    operator = LinearOperator((size, size), matvec=released, matmat=released, dtype=np.float64)
    start = form.allowed(np.random.default_rng(0).standard_normal((size, 1)))[:, 0]
    if eigsh(operator, k=1, which="SA", v0=start, tol=1e-13, return_eigenvectors=False)[0] <= -1:
        raise Buckled


def energy_metric(form: FlexibilityForm) -> dict[str, Any]:
    """Return the stored energy as a metric, for the Lanczos iteration, where it is not simply |w|²."""
    from scipy.sparse.linalg import LinearOperator, cg

    if not form.pull.any():
        return {}
    size = len(form.flexibility_root)

    def stored(w: Array) -> Array:
        column = w.reshape(size, -1)
        bent = form.allowed(form.geometric(form.allowed(column)))
        return (1 - form.unstored)[:, None] * column + bent

    def solved(w: Array) -> Array:
        # Identity and a compact operator: a few steps. What they leave open the Rayleigh-Ritz step restores.
        return np.asarray(cg(metric, w, rtol=1e-10, atol=0.0, maxiter=2000)[0])

    metric = LinearOperator((size, size), matvec=stored, dtype=np.float64)
    return {"M": metric, "Minv": LinearOperator((size, size), matvec=solved, dtype=np.float64)}
