"""The load at which a planar structure of beams buckles, exactly: stiffness against axial force.

Under axial forces N (tension positive) that keep to each stretch the energy of a small deflection is

    ½ ∫ EI v''² dx + ½ f ∫ N v'² dx,      f the factor of all loads.

Deflections of a stretch are those that its ends' motions ask of it at rest and, beside them, polynomials of
curvature between two clamps, as in the judge of vibrations. In coordinates with the bending energy qᵀq/2 the
rest is f qᵀGq/2, and the smallest f is -1 over the lowest eigenvalue of G: all of them come at once, and none
is missed. Degrees grow until it stays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from beammodes.exact.structure_judge import POINTS, StructureModel
from beammodes.numerics.arrays import Floats, first_factor
from beammodes.problem.structure import Parts

__all__ = ["critical_load_factor"]

#: Factors must agree so well between two degrees.
_AGREEMENT = 1e-11


def critical_load_factor(
    parts: Parts, axial_force: Sequence[Callable[[Floats], Floats]], turning: Sequence[float]
) -> float:
    """Return the smallest factor of a load under which a structure buckles, inf if it never does.

    Parameters
    ----------
    parts : Parts
        Of a structure that its supports hold still.
    axial_force : sequence of function
        Of each stretch, of the distance from its start, smooth [N].
    turning : sequence of float
        Of each node, by what moment per angle the load on its body resists a rotation [N m].

    Examples
    --------
    Euler's column:

    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.structure import Structure
    >>> column = Structure.of_beam(Beam.unit(), "pinned-pinned").parts
    >>> round(critical_load_factor(column, [lambda x: -1.0 + 0.0 * x], [0.0, 0.0]) / math.pi**2, 12)
    1.0
    """
    before = math.nan
    for points in (POINTS, 32, 46, 66):
        factor = _factor(parts, axial_force, turning, points)
        if factor == before or abs(factor / before - 1.0) < _AGREEMENT:
            return factor
        before = factor
    raise ArithmeticError(
        f"results do not agree to {_AGREEMENT:g} between polynomials of growing degree: does a property vary "
        "too much between the breaks of its beam, or is a member under so much tension that it bends next to "
        "its ends only?"
    )


def _factor(
    parts: Parts, axial_force: Sequence[Callable[[Floats], Floats]], turning: Sequence[float], points: int
) -> float:
    model = StructureModel.of(parts, (1,) * len(parts.stretches), points)
    inner = [span.element.inner_slope.shape[1] for span in model.spans]
    size = len(model.mass) + sum(inner)
    geometric, first = np.zeros((size, size)), len(model.mass)
    for i, (span, force) in enumerate(zip(model.spans, axial_force, strict=True)):
        element = span.element
        rows = np.zeros((len(element.x), size))
        rows[:, : len(model.mass)] = element.static_slope @ model.ends[i]
        rows[:, first : first + inner[i]] = element.inner_slope / span.stiff
        first += inner[i]
        pull = element.weight * span.length * force(span.length * element.x)
        geometric += (rows.T * pull) @ rows
    for motion, resisted in zip(model.motions, turning, strict=True):
        if resisted:
            turn = np.append(motion[2], np.zeros(size - len(model.mass)))
            geometric += resisted * np.outer(turn, turn)
    return first_factor(geometric)
