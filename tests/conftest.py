"""Shared by the tests: exact frequencies of a chain by mpmath; how Hypothesis and BLAS run."""

from __future__ import annotations

import os

# Tests fill the cores by themselves. BLAS threads that wait for a core which another test holds cost small
# solves up to thirty times their time. This counts only if said before NumPy is loaded.
for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# ruff: noqa: E402
from collections.abc import Callable
from fractions import Fraction

import hypothesis
import mpmath
import pytest

from beammodes.chains.chain import Chain
from beammodes.vibration.linear import nodal_matrices

# A loaded machine is slow, not wrong; a continuous check should fail for the change it checks only.
hypothesis.settings.register_profile("beammodes", deadline=None, derandomize=bool(os.environ.get("CI")))
hypothesis.settings.load_profile("beammodes")


def exact_frequencies(chain: Chain, digits: int = 50) -> list[mpmath.mpf]:
    """All natural frequencies in the chain's own units, ascending, from its exact rational nodal matrices."""
    _, mass, stiffness = nodal_matrices(chain, Fraction)
    if not mass:
        return []
    with mpmath.workdps(digits):
        matrices = [
            mpmath.matrix([[mpmath.mpf(v.numerator) / v.denominator for v in row] for row in rows])
            for rows in (mass, stiffness)
        ]
        root = mpmath.inverse(mpmath.cholesky(matrices[0]))
        squares = mpmath.eigsy(root * matrices[1] * root.T, eigvals_only=True)
        return [mpmath.sqrt(max(square, 0)) for square in squares]


@pytest.fixture
def frequencies_in_50_digits() -> Callable[[Chain], list[mpmath.mpf]]:
    return exact_frequencies
