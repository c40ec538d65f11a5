"""Planar structures of beams under axial forces: the load that buckles them, exactly, and their modes.

Under axial forces N (tension positive) that keep to each stretch the energy of a small deflection is

    ½ ∫ EI v''² dx + ½ f ∫ N v'² dx,      f the factor of all loads.

Deflections of a stretch are those that its ends' motions ask of it at rest and, beside them, polynomials of
curvature between two clamps, as in the judge of vibrations. In coordinates with the bending energy qᵀq/2 the
rest is f qᵀGq/2, and the smallest f is -1 over the lowest eigenvalue of G: all of them come at once, and none
is missed. Degrees grow until it stays. Modes under a load are those of 1 + f G and the mass in q.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from beammodes.exact.structure_judge import POINTS, StructureModel, StructureModes
from beammodes.numerics.arrays import Floats, first_factor, signs_of_largest
from beammodes.problem.structure import Parts, Structure

__all__ = ["critical_load_factor", "stressed_modes"]

#: Factors must agree so well between two degrees.
_AGREEMENT = 1e-11
#: So many modes have no more half-waves on a part than its polynomials take.
_MODES_OF_PART = 6


#: A force along a stretch, over distances from its start.
AxialForce = Callable[[Floats], Floats]


def critical_load_factor(parts: Parts, axial_force: Sequence[AxialForce], turning: Sequence[float]) -> float:
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
    raise _disagreement()


def stressed_modes(
    structure: Structure,
    parts: Parts,
    axial_force: Sequence[AxialForce],
    turning: Sequence[float],
    modes: int,
) -> StructureModes:
    """Return the first modes of a structure under axial forces; arguments as of `critical_load_factor`.

    Examples
    --------
    A string's tension raises ω² of a pinned bar by N π²:

    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.structure import Structure
    >>> bar = Structure.of_beam(Beam.unit(), "pinned-pinned")
    >>> pulled = stressed_modes(bar, bar.parts, [lambda x: 5.0 + 0.0 * x], [0.0, 0.0], 1)
    >>> (pulled.angular_frequency**2 - 5 * math.pi**2 - math.pi**4).round(10)
    array([0.])
    """
    before = np.full(modes, math.nan)
    for points in (POINTS, 32, 46, 66):
        model = StructureModel.of(parts, (1 + modes // _MODES_OF_PART,) * len(parts.stretches), points)
        squares, vectors = _stressed(model, parts, axial_force, turning, modes)
        if np.max(np.abs(squares / before - 1.0)) < 10.0 * _AGREEMENT:
            break
        before = squares
    else:
        raise _disagreement()
    omega, size = np.sqrt(squares), len(model.mass)
    omega.flags.writeable = False
    moved = np.concatenate([vectors[:, :size] @ motion[:2].T for motion in model.motions], axis=1)
    vectors = vectors * signs_of_largest(moved)[:, None]
    shapes = vectors[:, :size]
    inner = vectors[:, size:].reshape(modes, *model.square.shape) / np.sqrt(model.square)
    displacement = {name: shapes @ model.motions[i].T for i, name in enumerate(structure.joints)}
    return StructureModes(structure, omega, model.rigid, displacement, model.curves(shapes, inner))


def _stressed(
    model: StructureModel,
    parts: Parts,
    axial_force: Sequence[AxialForce],
    turning: Sequence[float],
    modes: int,
) -> tuple[Floats, Floats]:
    """Return squared frequencies, and motions q of unit modal mass, a row each."""
    from scipy.linalg import eigh

    free, stored = model.rigid, _geometric(model, parts, axial_force, turning)
    stored[np.diag_indices_from(stored)] += 1.0
    root = 1.0 / np.sqrt(model.square)
    shared = np.hstack(list(model.ends.transpose(0, 2, 1) @ (model.momentum * root[:, None])))
    mass = np.block([[model.mass, shared], [shared.T, np.diag(root.ravel() ** 2)]])
    # What turns freely on a pin goes with the others so that it has no momentum of its own.
    along = -np.linalg.solve(mass[:free, :free], mass[:free, free:])
    mass = mass[free:, free:] + mass[free:, :free] @ along
    try:
        ends = len(mass) - modes, len(mass) - 1
        found, vectors = eigh(mass, stored[free:, free:], subset_by_index=ends)
    except np.linalg.LinAlgError:
        factor = critical_load_factor(parts, axial_force, turning)
        raise ValueError(
            f"load must be less than {factor:.6g} times the given one, under which the structure buckles"
        ) from None
    vectors = np.vstack([along @ vectors, vectors]) / np.sqrt(found)
    return 1.0 / found[::-1], vectors.T[::-1]


def _factor(parts: Parts, axial_force: Sequence[AxialForce], turning: Sequence[float], points: int) -> float:
    model = StructureModel.of(parts, (1,) * len(parts.stretches), points)
    return first_factor(_geometric(model, parts, axial_force, turning))


def _geometric(
    model: StructureModel, parts: Parts, axial_force: Sequence[AxialForce], turning: Sequence[float]
) -> Floats:
    """Return G in z and, after it, inner modes of the energy 1/2 each."""
    if model.rigid and any(turning):
        raise ValueError(
            "structure must hold the rotation of each body that has an offset under gravity, got one with a "
            "body that turns freely on a pin"
        )
    (count, _, inner), first = model.momentum.shape, len(model.mass)
    size = first + count * inner
    geometric, cut = np.zeros((size, size)), count // len(parts.stretches)
    for i, span in enumerate(model.spans):
        element, stretch = span.element, parts.stretches[i // cut]
        rows = np.zeros((len(element.x), size))
        rows[:, :first] = element.static_slope @ model.ends[i]
        own = first + i * inner
        rows[:, own : own + element.inner_slope.shape[1]] = element.inner_slope / span.stiff
        force = axial_force[i // cut](span.start - stretch.start + span.length * element.x)
        geometric += (rows.T * (element.weight * span.length * force)) @ rows
    for motion, resisted in zip(model.motions, turning, strict=True):
        if resisted:
            turn = np.append(motion[2], np.zeros(size - first))
            geometric += resisted * np.outer(turn, turn)
    return geometric


def _disagreement() -> ArithmeticError:
    return ArithmeticError(
        f"results do not agree to {_AGREEMENT:g} between polynomials of growing degree: does a property vary "
        "too much between the breaks of its beam, is a member under so much tension that it bends next to "
        "its ends only, or is the load within a millionth of that at which the structure buckles?"
    )
