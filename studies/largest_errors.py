"""The largest error of the first three modes: of chains, and of finite elements for comparison."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm
from beammodes.chains.rules import AnyRule

__all__ = ["MATCHED", "MODES", "ROUNDING", "element_errors", "largest_error"]

MODES = 3
MATCHED = bm.matched(MODES)
#: Below this an error is rounding: matched springs have none, and its digits differ between machines.
ROUNDING = 1e-12


def largest_error(boundary: str, rule: AnyRule, segments: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the largest |e| of the first three modes at each N, NaN where a chain has fewer."""
    mode = np.arange(1, MODES + 1)
    error = np.abs(bm.frequency_error(boundary, segments=segments[:, None], mode=mode, rule=rule)).max(axis=1)
    return np.where(error < ROUNDING, 0.0, error)


def element_errors(boundary: str, elements: int) -> NDArray[np.float64]:
    """Return the errors of the first three frequencies of equal Hermite elements, by scikit-fem.

    Rounded to the digits that a dense solve leaves, so that they are the same on every machine.
    """
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd, ddot

    basis = Basis(MeshLine(np.arange(elements + 1.0)), ElementLineHermite())
    stiffness = BilinearForm(lambda u, v, _: ddot(dd(u), dd(v))).assemble(basis).toarray()
    mass = BilinearForm(lambda u, v, _: u * v).assemble(basis).toarray()
    ends = bm.Boundary.of(boundary)
    clamped = [x for x, end in ((0, ends.left), (elements, ends.right)) if end.holds_rotation]
    free = basis.complement_dofs(basis.get_dofs(lambda x: np.isin(x[0], clamped)))
    # The lowest modes as the largest eigenvalues: the other way round N⁴ more digits are lost.
    inverse = scipy.linalg.eigh(mass[np.ix_(free, free)], stiffness[np.ix_(free, free)], eigvals_only=True)
    exact = bm.euler_bernoulli(bm.Beam.unit(), boundary, MODES).angular_frequency
    return np.round(elements**2 / np.sqrt(inverse[::-1][:MODES]) / exact - 1, 9)
