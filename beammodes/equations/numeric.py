"""The equations of motion in CasADi: the same physics compiled, linearized by algorithmic differentiation."""

from __future__ import annotations

from dataclasses import dataclass

import casadi
import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.chain import Chain
from beammodes.checks import Shown, shown
from beammodes.equations.mechanics import Algebra, LinearizedChain, coordinate_names, motion_terms, null_space
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load

__all__ = ["CompiledEquations", "column", "compile_equations"]


@dataclass(frozen=True, repr=False, eq=False)
class CompiledEquations(Shown):
    """The terms of  M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,  c(q) = 0  as CasADi functions of q and q'.

    Attributes
    ----------
    coordinates : tuple of str
        Names of q; see `beammodes.equations.mechanics` for their order and signs.
    mass_matrix, static_forces, constraints, constraint_jacobian : casadi.Function
        M, s, c and ∂c/∂q of q.
    velocity_terms : casadi.Function
        h of (q, q').
    static_jacobian : casadi.Function
        ∂/∂q (s - (∂c/∂q)ᵀ λ) of (q, λ).
    """

    coordinates: tuple[str, ...]
    mass_matrix: casadi.Function
    velocity_terms: casadi.Function
    static_forces: casadi.Function
    constraints: casadi.Function
    constraint_jacobian: casadi.Function
    static_jacobian: casadi.Function

    def linearize(self) -> LinearizedChain:
        """Return M and K about the straight chain at rest, where every multiplier is zero.

        The axial coordinate x_0 is dropped, as in `symbolic.EquationsOfMotion.linearize`.
        """
        size, closures = len(self.coordinates), self.constraints.size1_out(0)
        rest, multipliers = np.zeros(size), np.zeros(closures)
        keep = [i for i, name in enumerate(self.coordinates) if name != "x_0"]
        pick = np.ix_(keep, keep)
        rows = _array(self.constraint_jacobian(rest))[:, keep].tolist()
        columns = null_space(rows, len(keep), float)
        return LinearizedChain(
            tuple(self.coordinates[i] for i in keep),
            _array(self.mass_matrix(rest))[pick],
            _array(self.static_jacobian(rest, multipliers))[pick],
            np.array(columns).reshape(len(columns), len(keep)).T,
        )

    def residual(self, q: ArrayLike, speed: ArrayLike, acceleration: ArrayLike) -> Floats:
        """Return  M(q) q'' + h(q, q') + s(q),  what the constraint forces must balance, shape (n,)."""
        inertia = _array(self.mass_matrix(q)) @ np.asarray(acceleration)
        static = _array(self.static_forces(q))[:, 0]
        return np.asarray(inertia + _array(self.velocity_terms(q, speed))[:, 0] + static)

    def _line(self) -> str:
        return f"CompiledEquations({len(self.coordinates)} coordinates: {', '.join(self.coordinates[:6])})"


def compile_equations(chain: Chain, *, load: Load | None = None) -> CompiledEquations:
    """Return the nonlinear equations of motion of a chain, compiled, in the chain's physical units.

        M_ij = a_ij cos(θ_i - θ_j),   h_i = Σ_j a_ij sin(θ_i - θ_j) θ_j'²,   s = ∂V/∂q

    Parameters
    ----------
    chain : Chain
        Of a few hundred pieces at most: the graph grows with their number squared.
    load : Load, optional
        An axial force.

    Returns
    -------
    CompiledEquations
        Its functions take the segments' angles and their rates, as arrays.

    Raises
    ------
    TypeError
        If `chain` is no Chain.

    Examples
    --------
    >>> import beammodes as bm
    >>> compiled = bm.compile_equations(bm.Chain(bm.Beam.unit(), "clamped-free", segments=2))
    >>> compiled.linearize().mass_matrix
    array([[0.16666667, 0.0625    ],
           [0.0625    , 0.04166667]])
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    names = coordinate_names(chain)
    size = len(names)
    q, speed = casadi.SX.sym("q", size), casadi.SX.sym("u", size)
    algebra = Algebra.physical(chain, casadi.sin, casadi.cos)
    terms = motion_terms(chain, casadi.vertsplit(q), casadi.vertsplit(speed), algebra, checked_load(load))
    rows = [casadi.horzcat(*row) for row in terms.mass_matrix]
    mass, static, closures = casadi.vertcat(*rows), column(terms.static_forces), column(terms.closures)
    multipliers = casadi.SX.sym("multipliers", closures.rows())
    jacobian = casadi.jacobian(closures, q)
    balance = static - jacobian.T @ multipliers if closures.rows() else static
    return CompiledEquations(
        tuple(names),
        casadi.Function("mass_matrix", [q], [mass]),
        casadi.Function("velocity_terms", [q, speed], [column(terms.velocity_terms)]),
        casadi.Function("static_forces", [q], [static]),
        casadi.Function("constraints", [q], [closures]),
        casadi.Function("constraint_jacobian", [q], [jacobian]),
        casadi.Function("static_jacobian", [q, multipliers], [casadi.jacobian(balance, q)]),
    )


def column(entries: list[casadi.SX]) -> casadi.SX:
    """Return expressions as a column, which may be empty."""
    return casadi.vertcat(*entries) if entries else casadi.SX(0, 1)


def _array(value: casadi.DM) -> Floats:
    return np.array(value.full(), dtype=np.float64)
