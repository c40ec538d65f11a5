"""The equations of motion in SymPy: exact, printable, and linearized without a single symbolic solve."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import sympy

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number
from beammodes.checks import Shown, flag, shown
from beammodes.equations.mechanics import (
    Algebra,
    Energies,
    LinearizedChain,
    coordinate_names,
    energies,
    motion_terms,
    null_space,
)
from beammodes.problem.loading import Load, checked_load

__all__ = ["EquationsOfMotion", "ExactLinearModel", "equations_of_motion", "symbolic_energies"]

_UNIT_SYMBOLS = {
    "m": sympy.Symbol("m", positive=True),
    "ell": sympy.Symbol("ell", positive=True),
    "EI": sympy.Symbol("EI", positive=True),
}


class ExactLinearModel(LinearizedChain):
    """A linearized chain in exact numbers and SymPy's symbols."""

    def angular_frequencies(self, *, digits: int = 30) -> list[sympy.Float]:
        """Return all natural frequencies ω, ascending, of exact matrices, in arithmetic of `digits` digits.

        Eigenvalues of  L⁻¹ K L⁻ᵀ  with M = L Lᵀ. Rigid-body modes come first, as zeros to half the digits.

        Examples
        --------
        >>> from beammodes.problem.beam import Beam
        >>> model = equations_of_motion(Chain(Beam.unit(), "clamped-free", segments=1)).linearize()
        >>> [float(omega) for omega in model.in_unit_segments().angular_frequencies()]
        [3.0]
        """
        mass, stiffness = self.reduced()
        if not mass.rows:
            return []
        with mpmath.workdps(digits):
            root = mpmath.inverse(mpmath.cholesky(mpmath.matrix(mass)))
            squares = mpmath.eigsy(root * mpmath.matrix(stiffness) * root.T, eigvals_only=True)
            return [sympy.Float(mpmath.sqrt(max(square, 0)), digits) for square in squares]

    def in_unit_segments(self) -> ExactLinearModel:
        """Return the model with m = ell = EI = 1, where a chain made by a rule is purely rational."""
        ones = dict.fromkeys(_UNIT_SYMBOLS.values(), sympy.Integer(1))
        matrices = (self.mass_matrix, self.stiffness_matrix, self.basis)
        return ExactLinearModel(self.coordinates, *(matrix.xreplace(ones) for matrix in matrices))


@dataclass(frozen=True, repr=False, eq=False)
class EquationsOfMotion(Shown):
    """The nonlinear equations  M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,  c(q) = 0.

    Attributes
    ----------
    coordinates, speeds, accelerations : tuple of sympy.Symbol
        q, q' and q''; see `beammodes.equations.mechanics` for their order and signs.
    mass_matrix : sympy.Matrix, shape (n, n)
        M(q).
    velocity_terms, static_forces : sympy.Matrix, shape (n, 1)
        h(q, q') and s(q) = ∂V/∂q.
    constraints : sympy.Matrix, shape (c, 1)
        c(q); empty for a chain whose right end is not held.
    multipliers : tuple of sympy.Symbol
        λ, the constraint forces.
    """

    coordinates: tuple[sympy.Symbol, ...]
    speeds: tuple[sympy.Symbol, ...]
    accelerations: tuple[sympy.Symbol, ...]
    mass_matrix: sympy.Matrix
    velocity_terms: sympy.Matrix
    static_forces: sympy.Matrix
    constraints: sympy.Matrix
    multipliers: tuple[sympy.Symbol, ...]

    @property
    def constraint_jacobian(self) -> sympy.Matrix:
        """∂c/∂q, shape (c, n)."""
        return _jacobian(self.constraints, self.coordinates)

    @property
    def residual(self) -> sympy.Matrix:
        """M q'' + h + s - (∂c/∂q)ᵀ λ, which is zero along every motion, shape (n, 1)."""
        inertia = self.mass_matrix * sympy.Matrix(self.accelerations)
        reaction = self.constraint_jacobian.T * sympy.Matrix(len(self.multipliers), 1, self.multipliers)
        return inertia + self.velocity_terms + self.static_forces - reaction

    def linearize(self) -> ExactLinearModel:
        """Return exact M and K of small transverse vibration about the straight chain at rest.

        M is evaluated there; K is the derivative of the static forces, an axial force's among them. The
        velocity terms are quadratic in the speeds and leave nothing. The multipliers of the closures that
        are kept are zero at rest, so these enter by their gradient only. The axial coordinate x_0 is
        dropped: on the straight chain it is coupled to no angle (the coupling is -s_j sin θ_j) and has no
        stiffness.
        """
        rest = dict.fromkeys((*self.coordinates, *self.speeds), sympy.Integer(0))
        keep = [i for i, name in enumerate(self.coordinates) if str(name) != "x_0"]
        static = self.static_forces + self.velocity_terms.xreplace(dict.fromkeys(self.speeds, 0))
        stiffness = _jacobian(static, self.coordinates).xreplace(rest)
        mass = self.mass_matrix.xreplace(rest)
        rows = self.constraint_jacobian.xreplace(rest).tolist()
        columns = null_space([[row[i] for i in keep] for row in rows], len(keep), _exact)
        basis = sympy.Matrix(len(columns), len(keep), [v for column in columns for v in column]).T
        coordinates = tuple(self.coordinates[i] for i in keep)
        return ExactLinearModel(coordinates, mass[keep, keep], stiffness[keep, keep], basis)

    def _line(self) -> str:
        first = ", ".join(map(str, self.coordinates[:6]))
        return f"EquationsOfMotion({len(self.coordinates)} coordinates: {first})"


def equations_of_motion(
    chain: Chain, *, load: Load | None = None, symbols: bool | None = None
) -> EquationsOfMotion:
    """Return the nonlinear equations of motion of a chain, in symbols.

        M_ij = a_ij cos(θ_i - θ_j),   h_i = Σ_j a_ij sin(θ_i - θ_j) θ_j'²,   s = ∂V/∂q

    Parameters
    ----------
    chain : Chain
        Up to about 50 segments; every entry of M is an expression of its own.
    load : Load, optional
        An axial force; its number enters in units of EI/ell² where symbols are used.
    symbols : bool, optional
        True writes m, ell and EI for a segment's mass and length and the bending stiffness, beside exact
        rational factors; False puts the beam's numbers in. Default: symbols where the chain has a beam.

    Returns
    -------
    EquationsOfMotion
        M, h and s in symbols; its `linearize` gives the matrices of small motion.

    Raises
    ------
    TypeError, ValueError
        If `chain` is no Chain, or symbols are asked for a chain that was given piece by piece.

    Examples
    --------
    >>> import beammodes as bm
    >>> equations = bm.equations_of_motion(bm.Chain(bm.Beam.unit(), "clamped-free", segments=2))
    >>> equations.mass_matrix[0, 1]
    ell**2*m*cos(theta_1 - theta_2)/2
    >>> equations.linearize().stiffness_matrix[0, 0]
    17*EI/(5*ell)
    """
    names = coordinate_names(_checked(chain))
    coordinates, speeds, accelerations = (_coordinate_symbols(names, dots) for dots in range(3))
    terms = motion_terms(chain, coordinates, speeds, _algebra(chain, symbols), checked_load(load))
    closures = len(terms.closures)
    return EquationsOfMotion(
        coordinates,
        speeds,
        accelerations,
        sympy.Matrix(len(names), len(names), [entry for row in terms.mass_matrix for entry in row]),
        sympy.Matrix(len(names), 1, terms.velocity_terms),
        sympy.Matrix(len(names), 1, terms.static_forces),
        sympy.Matrix(closures, 1, terms.closures),
        tuple(sympy.Symbol(f"lambda_{i + 1}") for i in range(closures)),
    )


def symbolic_energies(chain: Chain, *, load: Load | None = None, symbols: bool | None = None) -> Energies:
    """Return kinetic and potential energy and the closures in the symbols of `equations_of_motion`.

    Parameters
    ----------
    chain, load, symbols
        As `equations_of_motion` has them.

    Returns
    -------
    Energies
        The energies and the closures, as SymPy's expressions.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.symbolic_energies(bm.Chain(bm.Beam.unit(), "clamped-free", segments=1)).potential
    3*EI*theta_1**2/(2*ell)
    """
    names = coordinate_names(_checked(chain))
    q, u = _coordinate_symbols(names, 0), _coordinate_symbols(names, 1)
    return energies(chain, q, u, _algebra(chain, symbols), checked_load(load))


def _checked(chain: Chain) -> Chain:
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    return chain


def _coordinate_symbols(names: list[str], dots: int) -> tuple[sympy.Symbol, ...]:
    prefix = ("", "dot", "ddot")[dots]
    return tuple(sympy.Symbol(name.replace("_", f"{prefix}_"), real=True) for name in names)


def _algebra(chain: Chain, symbols: bool | None) -> Algebra:
    if symbols is not None:
        flag("symbols", symbols, or_none=True)
    if symbols and chain.beam is None:
        raise ValueError("symbols must be False for a chain given piece by piece, got True")
    if symbols or (symbols is None and chain.beam is not None):
        m, ell, stiffness = (_UNIT_SYMBOLS[name] for name in ("m", "ell", "EI"))
        return Algebra(_exact, sympy.sin, sympy.cos, ell, m, stiffness / ell)
    units = (
        sympy.Float(value) if value != 1 else sympy.Integer(1)
        for value in (chain.units.length, chain.units.mass, chain.units.stiffness)
    )
    return Algebra(_exact, sympy.sin, sympy.cos, *units)


def _exact(value: Number) -> sympy.Expr:
    if isinstance(value, Fraction):
        return sympy.Rational(value.numerator, value.denominator)
    return sympy.Integer(value) if value == int(value) else sympy.Float(value)


def _jacobian(column: sympy.Matrix, variables: tuple[sympy.Symbol, ...]) -> sympy.Matrix:
    """Return ∂column/∂variables; only variables that an entry contains are differentiated."""
    entries: list[Any] = []
    for entry in column:
        present = entry.free_symbols
        entries += [entry.diff(v) if v in present else sympy.Integer(0) for v in variables]
    return sympy.Matrix(column.rows, len(variables), entries)
