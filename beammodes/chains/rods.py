"""A beam cut into rigid pieces: their masses and inertias, and the flexibility of what lies at each hinge.

All numbers are in the chain's own units (`beammodes.chains.units`): those of a uniform beam are exact there.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.pieces import Number
from beammodes.chains.repeated import each_once
from beammodes.chains.rules import Layout, Rule
from beammodes.chains.units import ExactUnits
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.profiles import mean_over, mean_reciprocal, moments, profile_breaks

__all__ = ["Rods", "hinge_flexibilities", "profile_weights", "rigid_rods"]

_ROD, _POINT_MASSES = Fraction(1, 12), Fraction(1, 4)


class Rods(NamedTuple):
    """Mass, centre of mass from the left tip, and rotary inertia about it, of every piece."""

    mass: tuple[Number, ...]
    centre: tuple[Number, ...]
    rotary_inertia: tuple[Number, ...]


def rigid_rods(beam: Beam, lengths: Sequence[Fraction], shape: Fraction, units: ExactUnits) -> Rods:
    """Return the pieces of a beam that is cut into `lengths`, in segments.

    `shape` is a piece's rotary inertia over mass times length²: 1/12 keeps the mass where the beam has it,
    1/4 gathers it at the piece's two ends. The section's own rotary inertia comes on top.

    Examples
    --------
    >>> rigid_rods(Beam.unit(), [Fraction(1, 2), Fraction(1)], Fraction(1, 12), ExactUnits.of(Beam.unit(), 2))
    Rods(mass=(Fraction(1, 2), Fraction(1, 1)),
         centre=(Fraction(1, 4), Fraction(1, 2)),
         rotary_inertia=(Fraction(1, 96), Fraction(1, 12)))
    """
    if not beam.is_uniform:
        return _nonuniform_rods(beam, lengths, shape, units)
    section = (
        Fraction(mean_over(beam.rotary_inertia_per_length, beam.length))
        * units.length
        / (units.mass * units.length**2)
    )
    return Rods(
        tuple(lengths),
        tuple(each_once(lambda length: length / 2, lengths)),
        tuple(each_once(lambda length: shape * length**3 + section * length, lengths)),
    )


def _nonuniform_rods(beam: Beam, lengths: Sequence[Fraction], shape: Fraction, units: ExactUnits) -> Rods:
    edges = _positions(lengths, units)
    scale, ell = float(units.mass), float(units.length)
    length = np.diff(edges) / ell
    mass, moment, second = moments(beam.mass_per_length, edges)
    mass, moment, second = mass / scale, moment / (scale * ell), second / (scale * ell**2)
    shift = np.divide(moment, mass, out=np.zeros_like(mass), where=mass > 0)
    spread = second - moment * shift
    # Two point masses at the tips that have the piece's mass and centre.
    gathered = mass * (length / 2 + shift) * (length / 2 - shift)
    part = float((shape - _ROD) / (_POINT_MASSES - _ROD))
    section = moments(beam.rotary_inertia_per_length, edges)[0] / (scale * ell**2)
    inertia = (1 - part) * spread + part * gathered + section
    return Rods(*(tuple(values.tolist()) for values in (mass, length / 2 + shift, inertia)))


def hinge_flexibilities(beam: Beam, lengths: Sequence[Fraction], units: ExactUnits) -> list[Number]:
    """Return, for each hinge, the mean of EI over the EI there, which a rule's weight multiplies.

    At a step of EI it is the mean of both sides: each half cell bends with its own. Nothing else of EI is
    seen than its values at the hinges; `Chain` warns where these miss or exaggerate a feature.

    Examples
    --------
    >>> hinge_flexibilities(Beam.unit(), [Fraction(1)] * 2, ExactUnits.of(Beam.unit(), 2))
    [Fraction(1, 1)]
    """
    if beam.is_uniform:
        return [Fraction(1)] * (len(lengths) - 1)
    position = _positions(lengths, units)[1:-1]
    give = mean_reciprocal(beam.bending_stiffness, position)
    ratio = beam.mean_bending_stiffness * give
    return [float(value) for value in ratio]


def profile_weights(
    beam: Beam, boundary: Boundary, rule: Layout, lengths: Sequence[Fraction], units: ExactUnits
) -> dict[int, Fraction]:
    """Return what a rule adds to its weights where EI varies, by hinge.

    M²/EI is not smooth at a break of EI (see `Beam`), so a rule is a quadrature of its own on
    either side. One with end weights of order above 2 applies them on both, as at a clamped end, if the break
    lies where an end could: on a hinge, or half a segment from two for a half stub. Order 2 is left to other
    rules there, and to all where a step lies half-way between; order 1 where it lies elsewhere.

    A kink of EI that is no break gets no weights. Each leaves an error of second order: the flexibility falls
    short by h²/12 times the jump of (M²/EI)' where it is on a hinge, and exceeds by half of that where it is
    half-way between two. In a fine table of a taper these add up to nothing. A table of few points with
    strong kinks takes every rule to order 2: give their positions to `Beam` as `breaks`,
    and put hinges there.

    At a guided end M²/EI is even only if EI is, so the weights of a clamped end take the place of the
    mirror's; each EI given as a table or function counts as one that varies.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> beam = Beam(1.0, [2.0, 1.0], 1.0)
    >>> ends, rods = Boundary.of("pinned-pinned"), [Fraction(1)] * 8
    >>> profile_weights(beam, ends, RULES["gregory"], rods, ExactUnits.of(beam, 8))[3]       # 2 x 3/8 - 1
    Fraction(-1, 4)
    """
    added: dict[int, Fraction] = {}
    if isinstance(beam.bending_stiffness, float) or not isinstance(rule, Rule) or rule.order["clamped"] < 3:
        return added
    count = len(lengths) - 1
    for end, hinges in ((boundary.left, range(count)), (boundary.right, range(count - 1, -1, -1))):
        if end.statics == "guided":
            mirror = itertools.chain((w.constant for w in rule.guided), itertools.repeat(Fraction(1)))
            for hinge, weight, own in zip(hinges, rule.clamped, mirror, strict=False):
                added[hinge] = added.get(hinge, Fraction(0)) + weight.constant - own
    for hinge, more in _step_weights(beam, rule, lengths, units):
        added[hinge] = added.get(hinge, Fraction(0)) + more
    return added


def _step_weights(
    beam: Beam, rule: Rule, lengths: Sequence[Fraction], units: ExactUnits
) -> Iterator[tuple[int, Fraction]]:
    positions = {position: j for j, position in enumerate(itertools.accumulate(lengths[:-1]))}
    for step in profile_breaks(beam.bending_stiffness):
        place = step / float(units.length)
        node = round(place)
        if rule.stub == 1 or abs(place - node) > 1e-9 * max(1, node):
            continue
        for side, (k, weight) in itertools.product((-1, 1), enumerate(rule.clamped)):
            hinge = positions.get(node + side * (k + rule.stub))
            if hinge is not None:
                # A hinge on the step has half its weight from either side.
                yield hinge, weight.constant - Fraction(1, 1 if k or rule.stub else 2)


def _positions(lengths: Sequence[Fraction], units: ExactUnits) -> NDArray[np.float64]:
    edges = itertools.accumulate(lengths, initial=Fraction(0))
    return np.array([float(edge * units.length) for edge in edges])
