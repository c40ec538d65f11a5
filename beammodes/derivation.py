"""The report's own route, and the derivation of its spring rule.

`derived_error_dataset` goes from the nonlinear equations of motion in symbols through their exact
linearization to frequencies, as the report did, and checks every point by the two other routes.
`wall_spring_weight` derives the report's wall spring from the statics of the beam.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg
import sympy

from beammodes.accuracy.error_table import labelled_errors
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RuleLike, rule_named
from beammodes.checks import whole_number
from beammodes.equations.numeric import compile_equations
from beammodes.equations.symbolic import equations_of_motion
from beammodes.exact.exact_beam import wavenumber
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    import xarray

__all__ = ["derived_error_dataset", "wall_spring_weight"]

#: Relative disagreement of two routes that cannot be rounding.
ROUTES_AGREE = 1e-10


def derived_error_dataset(
    boundary: BoundaryLike,
    *,
    segments: Iterable[int],
    modes: int,
    rule: RuleLike = "mitiguy",
    progress: Callable[[int, int], None] | None = None,
) -> xarray.Dataset:
    """Return the errors of a rule, derived in SymPy from the nonlinear equations of motion.

    Exact M and K of the derivation, then eigenvalues in 30-digit arithmetic; the compiled equations and the
    banded nodal form check every frequency.

    Parameters
    ----------
    boundary : boundary
    segments : iterable of int
        Up to about 40: the derivation grows as N², the eigenvalues as N³ in extended precision.
    modes : int
    rule : str or Rule
    progress : callable, optional
        Called with (points done, points in all).

    Returns
    -------
    xarray.Dataset
        As `error_dataset`; the attribute `disagreement` is the largest relative difference of the routes.

    Raises
    ------
    ArithmeticError
        If the routes disagree by more than 1e-10.

    Examples
    --------
    >>> table = derived_error_dataset("clamped-free", segments=[1, 2], modes=2)
    >>> table.relative_error.sel(mode=1).squeeze().values.round(5)
    array([-0.14676, -0.03366])
    """
    pair, record, counts = Boundary.of(boundary).canonical, rule_named(rule), list(segments)
    exact = np.asarray(wavenumber(pair, np.arange(1, whole_number("modes", modes) + 1))) ** 2
    rows, worst = [], 0.0
    for done, count in enumerate(counts, start=1):
        row, disagreement = _point(Chain(Beam.unit(), pair, count, record), modes)
        worst = max(worst, disagreement)
        rows.append(row)
        if progress is not None:
            progress(done, len(counts))
    omega = np.array(rows)[None, None]
    table = labelled_errors(
        [record.name],
        [pair.name],
        counts,
        angular_frequency=omega,
        exact=exact[None],
        error=omega / exact - 1,
        route="SymPy: nonlinear equations of motion, linearized",
    )
    return table.assign_attrs(disagreement=worst)


def _point(chain: Chain, modes: int) -> tuple[Floats, float]:
    """Return the chain's first frequencies, NaN beyond its last, and the routes' largest disagreement."""
    assert chain.segments is not None
    rigid = chain.boundary.rigid_body_modes
    derived = equations_of_motion(chain).linearize().in_unit_segments().angular_frequencies()[rigid:]
    omega = np.array([float(value) for value in derived]) * chain.segments**2
    mass, stiffness = compile_equations(chain).linearize().reduced()
    compiled = np.sqrt(scipy.linalg.eigvalsh(stiffness, mass)[rigid:]) if len(mass) else np.zeros(0)
    nodal = solve_modes(linearize(chain)).angular_frequency
    disagreement = max(
        (float(np.abs(other[:modes] / omega[:modes] - 1).max(initial=0.0)) for other in (compiled, nodal)),
        default=0.0,
    )
    if not len(omega) == len(compiled) == len(nodal) or not disagreement < ROUTES_AGREE:
        raise ArithmeticError(f"routes disagree for {chain!r}: {omega}, {compiled}, {nodal}")
    row = np.full(modes, np.nan)
    row[: min(modes, len(omega))] = omega[:modes]
    return row, disagreement


def wall_spring_weight() -> sympy.Expr:
    """Derive the flexibility weight w of the report's wall spring  EI / (w ell),  for symbolic N.

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
    >>> wall_spring_weight()
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
