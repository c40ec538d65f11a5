"""A beam cut into rigid pieces: their masses and inertias, and the flexibility of what lies at each hinge.

All numbers are in the chain's own units (`beammodes.chains.units`): those of a uniform beam are exact there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from beammodes.chains.pieces import Number, each_once, floats
from beammodes.chains.rules import Layout, Rule
from beammodes.chains.units import ExactUnits
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.profiles import (
    Table,
    integral_of_reciprocal,
    mean_over,
    mean_reciprocal,
    moments,
    profile_breaks,
    ripple_at_hinges,
)

__all__ = [
    "MissedFeatureWarning",
    "Rods",
    "hinge_flexibilities",
    "missed_by_samples",
    "missed_feature",
    "profile_weights",
    "rigid_rods",
]

_ROD, _POINT_MASSES = Fraction(1, 12), Fraction(1, 4)


# Of what three hinges differ by, a mean between the halves beside one differs less where EI is smooth.
_SMOOTH_SHARE = 0.8
# Of a hinge's part of a smooth curve: a larger correction is none. Where hinges follow the curve, with two
# segments at least from each of its points to the next, it may be more than where they do not.
_MOST_RIPPLE, _MOST_WHERE_FOLLOWED, _FOLLOWED = 0.05, 2 / 3, 2.0
#: A feature whose flexibility is a smaller part of the beam's is not told.
LEAST_MISSED = 1e-3


class MissedFeatureWarning(UserWarning):
    """A beam has a feature, such as a notch or a coarse table's kinks, that hinges miss or exaggerate."""


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


def hinge_flexibilities(
    beam: Beam, boundary: Boundary, lengths: Sequence[Fraction], weights: Sequence[Number], units: ExactUnits
) -> list[Number]:
    """Return each hinge's flexibility over ell / EI, EI the beam's mean: a rule's weight times EI's there.

        w_j EI/EI(x_j)

    At a step of EI it is the mean of both sides: each half cell bends with its own. Nothing else of a
    function or a list is seen than its values at the hinges; `Chain` warns where these miss or exaggerate a
    feature.

    A table stands for a smooth property, and the beam for its lines. So EI(x_j) is that of a smooth curve
    through the points, and what the lines add to its flexibility beside that curve is integrated for each
    hinge (`ripple_at_hinges`): by cubics, or by lines if cubics would change a hinge by more than 5 % of what
    it has of the curve, or two thirds where the table's points are two segments apart or more. If lines do
    so too, as of tables coarse and steep, all hinges take the table's own values alone, and `Chain` warns if
    these do not add up to the beam's flexibility (`missed_by_samples`).

    Examples
    --------
    >>> unit, ends = Beam.unit(), Boundary.of("free-free")
    >>> hinge_flexibilities(unit, ends, [Fraction(1)] * 2, [Fraction(1)], ExactUnits.of(unit, 2))
    [Fraction(1, 1)]
    """
    if beam.is_uniform:
        return list(weights)
    position, mean = _positions(lengths, units)[1:-1], beam.mean_bending_stiffness
    ripple = _ripple(beam, boundary, lengths, weights, units)
    give = mean * mean_reciprocal(beam.bending_stiffness, position, smooth=ripple is not None)
    found = floats(weights) * give
    return list((found if ripple is None else found + ripple).tolist())


def _ripple(
    beam: Beam, boundary: Boundary, lengths: Sequence[Fraction], weights: Sequence[Number], units: ExactUnits
) -> Floats | None:
    """Return what each hinge's flexibility is corrected by, or None if that is too much of one of them."""
    position, mean = _positions(lengths, units)[1:-1], beam.mean_bending_stiffness
    if not isinstance(beam.bending_stiffness, Table):
        return np.zeros_like(position)
    bears = [end.statics not in ("pinned", "free") for end in (boundary.left, boundary.right)]
    curve = mean * mean_reciprocal(beam.bending_stiffness, position, smooth=True)
    cells = np.diff(beam.bending_stiffness.x)
    follows = cells[cells > 0.0].min() >= _FOLLOWED * (1.0 - 1e-9) * float(units.length)
    most = _MOST_WHERE_FOLLOWED if follows else _MOST_RIPPLE
    allowed = most * curve * np.array([float(weight) for weight in weights])
    for degree in (3, 1):
        ripple = ripple_at_hinges(
            beam.bending_stiffness, position, beam.length, (bears[0], bears[1]), degree=degree
        )
        ripple *= mean / float(units.length)
        if (np.abs(ripple) <= allowed).all():
            return ripple
    return None


def missed_by_samples(
    beam: Beam, boundary: Boundary, lengths: Sequence[Fraction], weights: Sequence[Number], units: ExactUnits
) -> float | None:
    """Return what part of a table's flexibility its values at the hinges miss, if hinges have those alone.

    The left side of `missed_feature`, summed over all hinges; None unless it is more than a thousandth of the
    beam's ∫ dx/EI, or if hinges keep what they would miss (`hinge_flexibilities`).

    Examples
    --------
    >>> beam, ends = Beam(1.0, Table([0, 0.25, 0.5, 1], [1, 0.03, 1, 1]), 1.0), Boundary.of("clamped-free")
    >>> units = ExactUnits.of(beam, 4)
    >>> rods = [Fraction(1, 2), *[Fraction(1)] * 3, Fraction(1, 2)]
    >>> round(missed_by_samples(beam, ends, rods, [Fraction(1)] * 4, units), 3)
    0.363
    """
    if beam.is_uniform or not isinstance(beam.bending_stiffness, Table):
        return None
    if not len(weights) or _ripple(beam, boundary, lengths, weights, units) is not None:
        return None
    edges, places = _nearest_to_hinges(beam, lengths, units)
    whole = float(integral_of_reciprocal(beam.bending_stiffness, edges).sum())
    part = 1.0 - float(np.diff(edges) @ mean_reciprocal(beam.bending_stiffness, places)) / whole
    return part if abs(part) > LEAST_MISSED else None


def _nearest_to_hinges(beam: Beam, lengths: Sequence[Fraction], units: ExactUnits) -> tuple[Floats, Floats]:
    """Return the edges of what is nearer to a hinge than to any other, and the hinges' positions."""
    places = np.clip(_positions(lengths, units)[1:-1], 0.0, beam.length)
    return np.concatenate(([0.0], 0.5 * (places[1:] + places[:-1]), [beam.length])), places


def missed_feature(beam: Beam, lengths: Sequence[Fraction], units: ExactUnits) -> tuple[float, float] | None:
    """Return where a chain's hinges miss a feature of EI most, and what part of the flexibility, or None.

    A hinge stands for what is nearer to it than to any other. There the mean of 1/EI differs from that at the
    hinge by less than 1/EI differs between this hinge and its neighbours, if hinges are close enough to see
    how EI varies. A feature narrower than about a fifth of a segment makes it differ by more:

        |∫ dx/EI - width/EI(x_j)|  >  0.8 width (largest - least 1/EI at three hinges),

    and by more than a thousandth of the beam's ∫ dx/EI to be told.

    Returns
    -------
    (float, float), or None
        x_j [m], and the left side over the whole beam's ∫ dx/EI, signed: positive is missed.

    Examples
    --------
    >>> notched = Beam(1.0, [1.0] * 33 + [0.05] + [1.0] * 66, 1.0)
    >>> x, part = missed_feature(notched, [Fraction(1)] * 10, ExactUnits.of(notched, 10))
    >>> round(x, 6), round(part, 2)
    (0.3, 0.16)
    """
    if isinstance(beam.bending_stiffness, float) or len(lengths) < 2:
        return None
    edges, places = _nearest_to_hinges(beam, lengths, units)
    give = integral_of_reciprocal(beam.bending_stiffness, edges)
    there = mean_reciprocal(beam.bending_stiffness, np.concatenate(([0.0], places, [beam.length])))
    three = np.array([there[:-2], there[1:-1], there[2:]])
    missed, width = give - np.diff(edges) * there[1:-1], np.diff(edges)
    told = np.abs(missed) > _SMOOTH_SHARE * width * (three.max(axis=0) - three.min(axis=0))
    told &= np.abs(missed) > LEAST_MISSED * give.sum()
    if not told.any():
        return None
    worst = int(np.argmax(np.where(told, np.abs(missed), 0.0)))
    return float(places[worst]), float(missed[worst] / give.sum())


def profile_weights(
    beam: Beam, boundary: Boundary, rule: Layout, lengths: Sequence[Fraction], units: ExactUnits
) -> dict[int, Fraction]:
    """Return what a rule adds to its weights where EI varies, by hinge.

    M²/EI is not smooth at a break of EI (see `Beam`), so a rule is a quadrature of its own on
    either side. One with end weights of order above 2 applies them on both, as at a clamped end, if the break
    lies where an end could: on a hinge, or half a segment from two for a half stub; of a pattern inside,
    where that fits the segments before it. Order 2 is left to other rules there, and to all where a step lies
    half-way between; order 1 where it lies elsewhere.

    A kink of EI that is no break gets no weights. A table's kinks need none where `hinge_flexibilities`
    integrates them: not if its points are so coarse and steep that hinges take its own values. Then, and of a
    function, each leaves an error of second order: the flexibility falls short by ell²/12 times the jump of
    (M²/EI)' where it is on a hinge, and exceeds by half of that where it is half-way between two. Give their
    positions to `Beam` as `breaks`, and put hinges there.

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
            plain = rule.repeated(rule.stub, len(rule.clamped))
            mirror = [*(w.constant for w in rule.guided), *plain[len(rule.guided) :]]
            for hinge, weight, own in zip(hinges, rule.clamped, mirror, strict=False):
                added[hinge] = added.get(hinge, Fraction(0)) + weight.constant - own
    for hinge, more in _step_weights(beam, rule, lengths, units):
        added[hinge] = added.get(hinge, Fraction(0)) + more
    return added


def _step_weights(
    beam: Beam, rule: Rule, lengths: Sequence[Fraction], units: ExactUnits
) -> Iterator[tuple[int, Fraction]]:
    steps = list(profile_breaks(beam.bending_stiffness))
    edges = itertools.accumulate(lengths[:-1]) if steps else ()
    positions = {position: j for j, position in enumerate(edges)}
    for step in steps:
        place = step / float(units.length)
        node = round(place)
        if rule.stub == 1 or abs(place - node) > 1e-9 * max(1, node) or not rule.fits(node):
            continue
        plain = rule.repeated(rule.stub, len(rule.clamped))
        for side, (k, weight) in itertools.product((-1, 1), enumerate(rule.clamped)):
            hinge = positions.get(node + side * (k + rule.stub))
            if hinge is not None:
                # A hinge on the step has half its weight from either side.
                yield hinge, weight.constant - plain[k] / (1 if k or rule.stub else 2)


def _positions(lengths: Sequence[Fraction], units: ExactUnits) -> Floats:
    # Sums of whole numbers of a common part: sums of fractions are slower by a hundred times.
    whole = math.lcm(*set(each_once(lambda length: length.denominator, lengths)))
    parts = each_once(lambda length: length.numerator * (whole // length.denominator), lengths)
    above, below = units.length.numerator, units.length.denominator * whole
    return np.array([edge * above / below for edge in itertools.accumulate(parts, initial=0)])
