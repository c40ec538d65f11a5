"""Shared by the tests: exact frequencies of a chain in long decimals; how Hypothesis and BLAS run."""

from __future__ import annotations

import os

# Tests fill the cores by themselves. BLAS threads that wait for a core which another test holds cost small
# solves up to thirty times their time. This counts only if said before NumPy is loaded.
for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# ruff: noqa: E402
from collections.abc import Callable
from decimal import Decimal, localcontext
from fractions import Fraction

import hypothesis
import mpmath
import numpy as np
import pytest
import scipy.linalg

from beammodes.chains.chain import Chain
from beammodes.vibration.linear import nodal_matrices

# A loaded machine is slow, not wrong; a continuous check should fail for the change it checks only.
checked = bool(os.environ.get("CI"))
hypothesis.settings.register_profile(
    "beammodes", deadline=None, derandomize=checked, max_examples=100 if checked else 40
)
hypothesis.settings.load_profile("beammodes")


Rows = list[list[Decimal]]


def solved(matrix: Rows, right: Rows, band: int) -> Rows:
    """Solve a symmetric system of some bandwidth by elimination; `right` holds rows, one an equation."""
    matrix, right = [row[:] for row in matrix], [row[:] for row in right]
    size = len(matrix)
    for i, top in enumerate(matrix):
        for r in range(i + 1, min(size, i + band + 1)):
            factor = matrix[r][i] / top[i]
            for c in range(i, min(size, i + band + 1)):
                matrix[r][c] -= factor * top[c]
            right[r] = [a - factor * b for a, b in zip(right[r], right[i], strict=True)]
    for i in range(size - 1, -1, -1):
        for c in range(i + 1, min(size, i + band + 1)):
            right[i] = [a - matrix[i][c] * b for a, b in zip(right[i], right[c], strict=True)]
        right[i] = [a / matrix[i][i] for a in right[i]]
    return right


def exact_frequencies(chain: Chain, digits: int = 50) -> list[mpmath.mpf]:
    """All natural frequencies in the chain's own units, ascending, from its exact rational nodal matrices.

    Each mode of a double-precision solve is made better by iteration of its Rayleigh quotient, which triples
    its digits at every step. That none is missed or met twice, the trace of M⁻¹ K says: the sum of all ω².
    """
    _, *matrices = nodal_matrices(chain, Fraction)
    size = len(matrices[0])
    if not size:
        return []
    band = max(
        abs(i - j) for rows in matrices for i, row in enumerate(rows) for j, entry in enumerate(row) if entry
    )
    rough = [np.array(rows, dtype=float) for rows in matrices]
    with localcontext(prec=digits + 40):
        mass, stiffness = (
            [[Decimal(v.numerator) / v.denominator for v in row] for row in m] for m in matrices
        )

        def times(rows: Rows, x: list[Decimal]) -> list[Decimal]:
            near = ((i, slice(max(0, i - band), i + band + 1)) for i in range(size))
            return [sum(map(Decimal.__mul__, rows[i][part], x[part])) for i, part in near]

        small, squares = Decimal(10) ** -(digits + 5), []
        trace = sum(row[i] for i, row in enumerate(solved(mass, stiffness, band)))
        for shape in scipy.linalg.eigh(rough[1], rough[0])[1].T.tolist():
            x, last = [Decimal(value) for value in shape], Decimal(-1)
            for _ in range(8):
                right = times(mass, x)
                square = sum(map(Decimal.__mul__, x, times(stiffness, x))) / sum(
                    map(Decimal.__mul__, x, right)
                )
                if abs(square - last) <= small * abs(square) or abs(square) <= small * trace:
                    break
                # A shift that is the root itself leaves nothing to divide by.
                last, shift = square, square * (1 + small / 1000)
                shifted = [
                    [k - shift * m for k, m in zip(*rows, strict=True)]
                    for rows in zip(stiffness, mass, strict=True)
                ]
                x = [row[0] for row in solved(shifted, [[value] for value in right], band)]
                largest = max(map(abs, x))
                x = [value / largest for value in x]
            else:
                raise AssertionError("the iteration has no end")
            squares.append(square)
        assert abs(sum(squares) - trace) <= 100 * small * trace
    with mpmath.workdps(digits):
        return [mpmath.sqrt(max(mpmath.mpf(str(square)), 0)) for square in sorted(squares)]


@pytest.fixture
def frequencies_in_50_digits() -> Callable[[Chain], list[mpmath.mpf]]:
    return exact_frequencies
