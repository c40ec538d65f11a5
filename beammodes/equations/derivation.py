"""The report's own route: equations of motion in symbols, exact matrices, eigenvalues; its spring rule."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy

from beammodes.chains.chain import Chain
from beammodes.checks import Shown
from beammodes.equations.symbolic import EquationsOfMotion, ExactLinearModel, equations_of_motion
from beammodes.numerics.arrays import Floats

__all__ = ["DerivedChain", "derive_chain", "wall_spring_weight"]


@dataclass(frozen=True, eq=False, repr=False)
class DerivedChain(Shown):
    """A chain's equations of motion in symbols, their exact linearization, and its frequencies.

    Attributes
    ----------
    chain : Chain
    equations : EquationsOfMotion
        Nonlinear, in the symbols m, ell and EI of a segment and the beam.
    linear : ExactLinearModel
        Their M and K about the straight chain at rest, in exact rational multiples of these symbols.
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of the elastic modes, ascending: eigenvalues of (K, M) in 30-digit arithmetic.
    """

    chain: Chain
    equations: EquationsOfMotion
    linear: ExactLinearModel
    angular_frequency: Floats

    def _line(self) -> str:
        return f"DerivedChain({self.chain!r}: {len(self.angular_frequency)} elastic modes)"


def derive_chain(chain: Chain) -> DerivedChain:
    """Derive the frequencies of a chain from its nonlinear equations of motion, as the report does.

        M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,     det(K - ω² M) = 0

    Parameters
    ----------
    chain : Chain
        Of up to about 40 segments: the derivation grows as N², the eigenvalues as N³ in 30-digit arithmetic.

    Returns
    -------
    DerivedChain
        The frequencies, with the matrices in exact rationals that they are from.

    Raises
    ------
    TypeError
        If `chain` is no Chain.

    Examples
    --------
    The report's cantilever of four segments, whose wall spring is 24/11 EI/ell:

    >>> import beammodes as bm
    >>> derived = bm.derive_chain(bm.Chain(bm.Beam.unit(), "clamped-free", segments=4, rule="mitiguy"))
    >>> derived.linear.stiffness_matrix[0, 0] - derived.linear.stiffness_matrix[3, 3]
    24*EI/(11*ell)
    >>> derived.linear.mass_matrix[0, 0]
    10*ell**2*m/3
    >>> (100 * (derived.angular_frequency[:3] / bm.wavenumber("clamped-free", [1, 2, 3]) ** 2 - 1)).round(3)
    array([ -0.8  ,  -7.446, -13.165])
    """
    equations = equations_of_motion(chain)
    linear = equations.linearize()
    found = linear.in_unit_segments().angular_frequencies()[chain.boundary.rigid_body_modes :]
    unit = chain.units.angular_frequency if chain.beam is not None else 1.0
    return DerivedChain(chain, equations, linear, np.array([float(omega) for omega in found]) * unit)


def wall_spring_weight() -> sympy.Expr:
    """Return the flexibility weight w of the report's wall spring  EI / (w ell),  derived for symbolic N.

    A cantilever with a tip force F. Hinge i, at i ell, carries the moment F (N - i) ell and turns by
    w_i ell/EI times it. Matching the deflections of the chain's hinges,

        y_j = Σ_{i<j} (j - i) ell · w_i ell F (N - i) ell / EI,

    to Euler's  F x² (3L - x) / (6 EI)  at x = j ell determines the weights one after another: the first from
    j = 1, and second differences in j give all others, w_i = 1.

    Returns
    -------
    sympy.Expr
        (3N - 1)/(6N), so that the wall's spring is 6N/(3N - 1) EI/ell. The report's scan prints this formula
        under the label of the springs between segments and EI/ell under that of the wall. Its own examples
        (24/11 at the wall for N = 4, EI/ell elsewhere) and this derivation say that the labels are exchanged.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.wall_spring_weight()
    (3*N - 1)/(6*N)
    """
    size, j, weight = sympy.symbols("N j w")
    # In units of F ell³/EI.
    beam = j**2 * (3 * size - j) / 6
    (wall,) = sympy.solve(sympy.Eq(weight * size, beam.subs(j, 1)), weight)
    bend = sympy.expand(beam.subs(j, j + 1) - 2 * beam + beam.subs(j, j - 1))
    interior = sympy.cancel(bend / (size - j))
    if interior != 1:
        raise ArithmeticError(f"interior weights must be 1 for this derivation, got {interior}")
    return sympy.factor(wall)
