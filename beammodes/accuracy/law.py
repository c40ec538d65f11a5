"""The law of the error: the leading term, in closed form, of a rule's frequency errors as N grows.

A beam's flexibility is the integral of f = M²/EI along it; a chain's is the sum of w_j ell f(x_j) over its
hinges. By Rayleigh's principle a small change of flexibility changes a frequency by

    e = -½ (Σ w_j ell f(x_j) - ∫ f dx) / ∫ f dx,        f = φ''²,  φ the exact mode.

The sum is a quadrature of f, and Euler and Maclaurin say what is wrong with it: nothing inside, and at each
end, with h = 1/N, the first hinge at x₀ h and the weights' corrections c_j = w_j - 1,

    Σ w_j h f(x_j) - ∫ f = Σ_k h^(k+1) d_k f⁽ᵏ⁾(0),
    d_k = Σ_j c_j x_j^k / k! - B_{k+1}(x₀) / (k+1)!        (B the Bernoulli polynomials).

::

    wall            f = M²                       naive      w₀ = 1     the whole first cell too much
     |█                                          double     w₀ = 1/2   trapezoids: f'(0)/12 remains
     |█ █                                        gregory    3/8, 7/6, 23/24: f, f', f'' all integrated
     |█ █ █ ▄ ▄ _ _ _ ▄ ▄ ▄ _ _                  stubs      no first hinge: the cell at the wall is missing
     0 1 2 3 ...   hinges
     w₀ w₁ w₂ 1 1

So a rule's order is decided by the first d_k that meets a derivative of f which is not zero at that end:
f and f' vanish where the moment does (pinned, free), odd derivatives where the shear does (guided).

Two things are not quadrature. Inside, rods and hinges err alike to fourth order, -β⁴h⁴/1440, because a
rod's rotary inertia m ell²/12 offsets the hinges' coarseness; masses at the hinges instead (rotary inertia
r m ell²) add  -½ (r - 1/12) h² ∫φ'² / ∫φ².

Weights that repeat a pattern inside have a Bernoulli term for each of them (`Rule.end_defects`), and add
-½ Σ |p_G|²/λ_G β⁴h⁴  over the pattern's harmonics: Simpson's, -β⁴h⁴/864.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.axial_errors import axial_law_terms, zigzag_coefficient
from beammodes.accuracy.lookups import lookup_of
from beammodes.accuracy.segments import first_lasting, segment_grid, solved_grid
from beammodes.chains.rules import (
    CANCELLED,
    HIGHEST_ORDER,
    RuleLike,
    RuleMaker,
    fits_of,
    is_closed,
    rule_named,
)
from beammodes.checks import Shown, positive_real, shown, whole_number, whole_numbers
from beammodes.closed_form.uniform_chains import MAX_SEGMENTS
from beammodes.exact.exact_beam import BeamModes, plain_modes
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.problem.motions import Motion, motion_named
from beammodes.problem.structure import Structure

__all__ = ["ErrorLaw", "error_law", "interior_coefficient", "law_holds_from"]


@dataclass(frozen=True, slots=True, repr=False)
class ErrorLaw(Shown):
    """The leading term of a frequency error,  e ~ coefficient / N**order.

    Attributes
    ----------
    order : int
    coefficient : float
        NaN where the leading terms cancel for this mode alone (a mode-tuned rule): then effects of second
        order in the springs decide it, which the law does not hold.
    """

    order: int
    coefficient: float

    def at(self, segments: int | NDArray[np.integer]) -> Floats:
        """Return  coefficient / N**order.

        Examples
        --------
        >>> print(error_law("clamped-free", 1, "mitiguy").at(100).round(9))
        -1.255e-05
        """
        counts = whole_numbers("segments", segments, most=MAX_SEGMENTS)
        return np.asarray(self.coefficient / counts.astype(np.float64) ** self.order)

    def _line(self) -> str:
        return f"ErrorLaw(e ~ {self.coefficient:.6g} / N**{self.order})"


def error_law(
    boundary: AxialBoundaryLike | Structure,
    mode: int,
    rule: RuleLike | RuleMaker = "mitiguy",
    *,
    motion: str | Motion = "bending",
) -> ErrorLaw:
    """Return the law  e ~ c / N^p  of a rule on a boundary, for one elastic mode.

        c = -½ Σ_ends Σ_k d_k f⁽ᵏ⁾ / ∫f  at the lowest power p = k + 1 that remains,  f = φ''²

    It holds in the limit of many segments, and for rules of order 2 soon: for `mitiguy` and the first mode of
    a cantilever within a fifth from N = 1. A rule of order 4 reaches its law late, as the next power has a
    large coefficient: `gregory` there from N = 676, and below N = 113 its error has the other sign.
    `law_holds_from` says from which N a law may be used. Below it, ask `frequency_error`, which also says
    which modes a chain has: the law knows of none that is missing.

    Parameters
    ----------
    boundary : boundary or Structure
        Of a structure, of uniform beams, N is the number of segments in all, and such N are meant with which
        all are equally long (h = all lengths over N).
    mode : int
        1-based index of an elastic mode; of a structure one whose frequency no other mode has.
    rule : str, Rule, or a record from `mode_tuned`
    motion : str
        "bending", "twist" or "stretch". In these two f = T², T the torque or axial force, and no rule gets
        beyond order 2 (`axial_law_terms`). Numbers of ends are multiples of GJ/L and ρIp L, EA/L and ρA L.

    Returns
    -------
    ErrorLaw
        c, p and the law's value at any N.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Examples
    --------
    >>> import beammodes as bm
    >>> law = bm.error_law("clamped-free", mode=1, rule="mitiguy")    # (1 - σβ)/3 per clamped end
    >>> law.order, round(law.coefficient, 6)
    (2, -0.125502)
    >>> [bm.law_holds_from("clamped-free", 1, rule) for rule in ("mitiguy", "gregory")]
    [1, 676]
    >>> bm.error_law("fixed-free", mode=1, rule="gregory", motion="twist")                  # -π²/96
    ErrorLaw(e ~ -0.102808 / N**2)
    """
    if isinstance(boundary, Structure):
        return _law_of_structure(boundary, mode, rule, motion_named(motion))
    if motion_named(motion).along:
        if isinstance(rule, RuleMaker):
            raise ValueError(f"rule must be a Rule or a name for motion {motion}, got {shown(rule)}")
        beta, powers = axial_law_terms(AxialBoundary.of(boundary, motion), mode, rule_named(rule))
        return _leading(powers, beta)
    if isinstance(boundary, AxialBoundary):
        raise ValueError(f"motion must be {boundary.motion} for {shown(boundary)}, got bending")
    pair = Boundary.of(boundary)
    record = rule.rule_for(pair) if isinstance(rule, RuleMaker) else rule_named(rule)
    index = whole_number("mode", mode, most=10**6)
    beam = plain_modes(Beam.unit(), pair, index)
    terms: list[tuple[int, float]] = []
    for end, left in ((pair.left, True), (pair.right, False)):
        derivatives = _derivatives_of_moment_squared(beam, left)
        for k, (constant, per_segment) in enumerate(record.end_defects(end.statics)):
            scale = -derivatives[k] / (2 * beam.wavenumber[-1] ** 4)
            terms += [(k + 1, float(constant) * scale), (k + 2, float(per_segment) * scale)]
    lumped = record.rotary_inertia - Fraction(1, 12)
    terms.append((2, -float(lumped) / 2 * _slope_energy(beam)))
    if not lumped:
        inside = float(interior_coefficient()) + _zigzag_coefficient(record.inside)
        terms.append((4, inside * beam.wavenumber[-1] ** 4))
    return _leading(terms, float(beam.wavenumber[-1]))


def _law_of_structure(
    structure: Structure, mode: int, rule: RuleLike | RuleMaker, motion: Motion
) -> ErrorLaw:
    from beammodes.accuracy.structure_law import structure_law_terms

    if motion.along or isinstance(rule, RuleMaker):
        raise ValueError(
            "motion must be bending, and rule a Rule or a name, for a structure, got "
            f"{motion.name} and {shown(rule)}"
        )
    record = rule_named(rule)
    zigzag = float(interior_coefficient()) + _zigzag_coefficient(record.inside)
    wavenumber, terms = structure_law_terms(structure, mode, record, zigzag)
    return _leading(terms, wavenumber)


def law_holds_from(
    boundary: AxialBoundaryLike,
    mode: int,
    rule: RuleLike | RuleMaker = "mitiguy",
    *,
    within: float = 0.2,
    motion: str | Motion = "bending",
) -> int | None:
    """Return the smallest N from which a law and the error agree, for every larger N too.

        N = min { n : |c/n'^p - e(n')| ≤ within |e(n')| for all n' ≥ n }

    Every N is looked at up to 400, or 40 times the mode; beyond, a grid in steps of one percent up to 10⁹. Of
    a rule whose springs inside repeat a pattern: each that it fits up to 30, then steps of a tenth up to
    1000.

    Parameters
    ----------
    boundary, mode, rule, motion
        As for `error_law`.
    within : float
        A fraction of the error: 0.2 is a fifth.

    Returns
    -------
    int or None
        None where the law has no coefficient (NaN), or the longest of these chains does not reach it.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.law_holds_from("clamped-free", 3, "half_stub")
    4
    """
    how, fraction = lookup_of(motion), positive_real("within", within)
    pair = how.boundary(boundary)
    record = rule.rule_for(pair) if isinstance(rule, RuleMaker) else rule_named(rule)
    law = error_law(pair, mode, record, motion=motion)

    def fails(counts: NDArray[np.int64]) -> NDArray[np.bool_]:
        error = np.asarray(how.errors(pair, counts, mode, record, Load()))
        # Written so that NaN fails: a mode that is not there.
        return np.asarray(~(np.abs(law.at(counts) - error) <= fraction * np.abs(error)))

    grid = segment_grid(mode) if is_closed(record) else solved_grid(mode, record)
    return first_lasting(fails, grid, fits=fits_of(record))


@lru_cache(maxsize=1)
def interior_coefficient() -> Fraction:
    """Derive the coefficient of q⁴ in  ω_chain/q² - 1  for rods, with q the wavenumber per segment.

        ω² = 12 (1 - cos q)² / (2 + cos q)

    Examples
    --------
    >>> interior_coefficient()
    Fraction(-1, 1440)
    """
    import sympy

    q = sympy.Symbol("q", positive=True)
    ratio = sympy.sqrt(12 / (2 + sympy.cos(q))) * (1 - sympy.cos(q)) / q**2
    series = sympy.series(ratio, q, 0, 5).removeO()
    if sympy.expand(series).coeff(q, 2) != 0:
        raise ArithmeticError(f"rods and hinges must err alike to second order, got {series}")
    return Fraction(str(sympy.expand(series).coeff(q, 4)))


def _zigzag_coefficient(inside: Sequence[Fraction]) -> float:
    """Return what springs that repeat a pattern add to the coefficient of q⁴ in  ω_chain/q² - 1.

    Rods of equal springs have zigzags of the squared frequency λ = 16 s⁴/(1 - (2/3) s²), s = sin(G/2).

    Examples
    --------
    >>> round(1 / _zigzag_coefficient([Fraction(4, 3), Fraction(2, 3)]), 6)              # p_π = ±1/3
    -864.0
    """
    return zigzag_coefficient(inside, lambda square: 16 * square**2 / (1 - 2 / 3 * square))


def _end_derivatives(beam: BeamModes, left: bool) -> list[float]:
    """Return φ, φ', φ'', φ''' of the last mode at an end, along the inward direction."""
    x = 0.0 if left else beam.beam.length
    values = [float(beam.shape(np.array([x]), derivative=k)[-1, 0]) for k in range(4)]
    return values if left else [value * (-1) ** k for k, value in enumerate(values)]


def _derivatives_of_moment_squared(beam: BeamModes, left: bool) -> list[float]:
    """Return f⁽ᵏ⁾ of f = φ''² at an end, k = 0..3, by Leibniz, with φ'''' = β⁴ φ."""
    phi, quartic = _end_derivatives(beam, left), float(beam.wavenumber[-1] ** 4)
    higher = phi + [quartic * value for value in phi]
    return [
        sum(math.comb(k, i) * higher[2 + i] * higher[2 + k - i] for i in range(k + 1))
        for k in range(HIGHEST_ORDER)
    ]


def _slope_energy(beam: BeamModes) -> float:
    """Return ∫φ'² for unit ∫φ², in closed form from the end values.

    With I = ∫φφ'', partial integration of ∫xφ'''φ'''' on both sides of φ'''' = β⁴φ gives
    4β⁴ I = [2β⁴xφφ'' - β⁴xφ'² + β⁴φφ' - xφ'''² + φ''φ'''], and ∫φ'² = [φφ'] - I.
    """
    quartic, total, boundary_term = float(beam.wavenumber[-1] ** 4), 0.0, 0.0
    for x, sign in ((0.0, -1.0), (beam.beam.length, 1.0)):
        p = [float(beam.shape(np.array([x]), derivative=k)[-1, 0]) for k in range(4)]
        total += sign * (
            quartic * (2 * x * p[0] * p[2] - x * p[1] ** 2 + p[0] * p[1]) - x * p[3] ** 2 + p[2] * p[3]
        )
        boundary_term += sign * p[0] * p[1]
    return boundary_term - total / (4 * quartic)


def _leading(terms: list[tuple[int, float]], wavenumber: float) -> ErrorLaw:
    """Return the lowest power whose terms do not cancel; a term of power p is naturally of size β^p."""
    sizes = [(power, value) for power, value in terms if abs(value) > CANCELLED * wavenumber**power]
    lowest = min(power for power, _ in sizes)
    for power in range(lowest, HIGHEST_ORDER + 1):
        total = math.fsum(value for p, value in terms if p == power)
        if abs(total) > CANCELLED * wavenumber**power:
            # Two terms of order `lowest` act on each other at twice that order.
            return ErrorLaw(power, total if power < 2 * lowest else math.nan)
    return ErrorLaw(HIGHEST_ORDER, math.nan)
