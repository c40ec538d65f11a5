"""A uniform chain without the row of equal rods in its middle: what tells it from others of its length."""

from __future__ import annotations

from fractions import Fraction

from beammodes.chains.chain import Chain
from beammodes.chains.rules import Rule
from beammodes.chains.units import ExactUnits
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.supports import End

__all__ = ["shortened"]

# Unmodified hinges between the two ends' corrections: the cut is at one of them.
_BETWEEN = 6


def shortened(
    boundary: Boundary, segments: int, rule: Rule, section: Fraction = Fraction(0)
) -> tuple[Chain, int] | None:
    """Return a short chain and how many rods, an even number, belong into its middle hinge.

    None if a spring would not be positive.

    Parameters
    ----------
    boundary : Boundary
        The two ends of a unit beam.
    segments : int
        N of the whole chain, whose weights, supports and bodies the short one has, in units of a segment.
    rule : Rule
    section : Fraction
        Rotary inertia of the beam's sections, ρI/(ρA L²).

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> chain, rods = shortened(Boundary.of("clamped-free"), 1000, RULES["mitiguy"])
    >>> chain.hinge_stiffness[0], chain.pieces - 1 + rods           # 6 N/(3 N - 1) at the wall
    (Fraction(6000, 2999), 1000)
    """
    kept = 2 * max(map(len, (rule.clamped, rule.guided, rule.carried))) + _BETWEEN
    kept = min(segments, kept + (segments - kept) % 2)
    units = ExactUnits.of(Beam.unit(), segments)
    length = rule.piece_lengths(boundary, kept)
    turning = {value: (rule.rotary_inertia * value**2 + section * segments**2) * value for value in length}
    weights = rule.hinge_weights(boundary, kept, size=segments)
    if min(weights, default=1) <= 0:
        return None
    chain = Chain.from_pieces(
        length=length,
        mass=length,
        rotary_inertia=[turning[value] for value in length],
        joint_stiffness=[1 / weight for weight in weights],
        boundary=Boundary(_in_units(boundary.left, units), _in_units(boundary.right, units)),
    )
    return chain, segments - kept


def _in_units(end: End, units: ExactUnits) -> End:
    return End(
        units.support(end.translational_stiffness, 2),
        units.support(end.rotational_stiffness, 0),
        *units.body(*end.moving_body),
    )
