"""Natural modes of a chain that twists or stretches, with every digit of the lowest frequencies kept.

With springs s between neighbours and inertias m the chain is  B = S^½ G M^-½,  G the differences of
neighbours: two diagonals, whose singular values are ω. The product BᵀB, which assembling K and M forms, has
lost half the digits of the lowest; B has them, and so have sums of forces and extensions along the chain, by
which long ones are solved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beammodes.chains.axial_chain import AxialChain, at_rest
from beammodes.checks import Shown, row_shown, whole_number
from beammodes.numerics.arrays import Floats

__all__ = ["AxialChainModes", "highest_axial_frequency", "solve_axial_modes"]

# Chains of so many pieces are solved by singular values, which give all modes at once; longer ones by Lanczos
# iteration, which gives the lowest, unless many of them are asked for.
_MAX_DENSE, _MOST_DENSE = 100, 2000


@dataclass(frozen=True, eq=False, repr=False)
class AxialChainModes(Shown):
    """Elastic modes of a chain in twist or stretch, ascending, of unit modal mass.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
    rigid_body_modes : int
        1 if nothing holds the chain; that mode is counted here and is no row of the arrays.
    displacement : ndarray, shape (modes, pieces)
        Angle or shift of each piece; the first that moves is positive.
    """

    angular_frequency: Floats
    rigid_body_modes: int
    displacement: Floats

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, shape (modes,) [Hz]."""
        return self.angular_frequency / (2 * np.pi)

    def _line(self) -> str:
        rigid = "; 1 rigid-body mode" if self.rigid_body_modes else ""
        return f"AxialChainModes(chain: {row_shown(self.frequency, '{:.4g}', 'Hz')}{rigid})"


def solve_axial_modes(chain: AxialChain, modes: int | None = None) -> AxialChainModes:
    """Return the lowest elastic modes of a chain in twist or stretch; `solve_modes` is the door to it.

    Relative accuracy of ω is 1e-12 or better for the lowest modes of chains up to 10⁶ pieces, 1e-13 for short
    ones.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> shaft = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    >>> solve_axial_modes(AxialChain(shaft, "fixed-free", 10), 2).angular_frequency.round(6)
    array([1.569182, 4.668907])
    """
    _, inertia, springs = chain.moving
    count = chain.elastic_modes if modes is None else whole_number("modes", modes)
    count = min(count, chain.elastic_modes)
    omega, shape = _solved(inertia, springs, count)
    # A mode's first piece at rest would leave the sign to rounding; pieces next to it move.
    largest = np.abs(shape).max(axis=1, initial=0.0)[:, None]
    first = (np.abs(shape) > 1e-6 * largest).argmax(axis=1) if count else np.zeros(0, dtype=np.intp)
    sign = np.sign(shape[np.arange(count), first])
    displacement = chain.spread(shape * sign[:, None])
    return AxialChainModes(omega, chain.boundary.rigid_body_modes, displacement)


def _solved(inertia: Floats, springs: Floats, count: int) -> tuple[Floats, Floats]:
    """Return ω and shapes of unit modal mass of the lowest elastic modes, a row each."""
    size = len(inertia)
    if not count:
        return np.zeros(0), np.zeros((0, size))
    if size > _MAX_DENSE and 10 * count <= size:
        return _lanczos(inertia, springs, count)
    if size > _MOST_DENSE:
        raise ValueError(
            f"modes must be at most {size // 10}, a tenth of the chain's, for a chain of more than "
            f"{_MOST_DENSE} pieces, got {count}"
        )
    root = np.sqrt(inertia)
    two, at, held = np.zeros((size + 1, size)), np.arange(size), springs > 0.0
    two[at, at], two[at + 1, at] = np.sqrt(springs[:-1]) / root, -np.sqrt(springs[1:]) / root
    # Without a rigid mode there are as many singular values as pieces; with one, a row less than pieces.
    _, omega, turn = np.linalg.svd(two[held], full_matrices=False)
    return omega[::-1][:count], turn[::-1][:count] / root


def _lanczos(inertia: Floats, springs: Floats, count: int) -> tuple[Floats, Floats]:
    """Return the same of a long chain: the largest values of M^½ K⁻¹ M^½, by sums along the chain."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    root, size = np.sqrt(inertia), len(inertia)
    rigid = root / np.linalg.norm(root) * (not springs[0] and not springs[-1])

    def allowed(x: Floats) -> Floats:
        return np.asarray(x - rigid * (rigid @ x))

    def compliance(x: Floats) -> Floats:
        return allowed(root * at_rest(springs, root * allowed(x.ravel()))[0])

    operator = LinearOperator((size, size), matvec=compliance, dtype=np.float64)
    # A fixed start vector makes the result reproducible; a random one has a part in every mode.
    start = allowed(np.random.default_rng(0).standard_normal(size))
    few = min(4 * count + 8, size)
    # 1/ω² by its Rayleigh quotient, a sum of squares: an error of 1e-10 in the vector is one of 1e-20 in it.
    vectors = eigsh(operator, k=count, which="LA", v0=start, tol=1e-10, ncv=few)[1][:, ::-1].T
    omega = np.empty(count)
    for k, x in enumerate(vectors):
        carried = at_rest(springs, root * allowed(x))[1]
        held = springs > 0.0
        omega[k] = np.linalg.norm(x) / np.linalg.norm(carried[held] / np.sqrt(springs[held]))
    return omega, vectors / root


def highest_axial_frequency(chain: AxialChain) -> float:
    """Return the chain's highest angular frequency [rad/s], which sets its stable step; 0 without one.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> shaft = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    >>> round(highest_axial_frequency(AxialChain(shaft, "fixed-fixed", 10)), 9)              # 2 N sin(π/2)
    20.0
    """
    _, inertia, springs = chain.moving
    if not chain.elastic_modes:
        return 0.0
    from scipy.linalg import eigvalsh_tridiagonal

    diagonal = (springs[:-1] + springs[1:]) / inertia
    beside = springs[1:-1] / np.sqrt(inertia[:-1]) / np.sqrt(inertia[1:])
    last = len(inertia) - 1
    top = eigvalsh_tridiagonal(diagonal, beside, select="i", select_range=(last, last))
    return float(np.sqrt(top[0]))
