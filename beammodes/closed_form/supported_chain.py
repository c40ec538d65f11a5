"""Natural frequencies of uniform chains with any ends, at a cost that does not depend on their length.

A long chain is two short blocks of pieces (`carried_planes`), which hold all that the ends, their bodies and
the rule's corrections change, and between them a row of equal rods (`rod_row`); all three are cut in the
middle of a hinge. How many modes lie below a squared frequency is counted (`joined_blocks`), so that none is
missed or doubled, and the determinant's sign change closes each in. A short chain is one block.

Soft springs, heavy bodies and small wavenumbers make a determinant lose all the digits of doubles. Here
numbers are decimals long enough for the numbers at hand, so that one formula serves all corners.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, field
from decimal import Context, Decimal, DivisionByZero, InvalidOperation, localcontext
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.rules import Rule, RuleLike, rule_named
from beammodes.chains.units import ExactUnits
from beammodes.checks import real, shown, whole_number
from beammodes.closed_form.carried_planes import (
    Block,
    Plane,
    Row,
    block_of,
    carried,
    closed,
    row_of_rods,
)
from beammodes.numerics.arrays import Floats
from beammodes.numerics.counted_roots import Sample, inertia_and_determinant, ordered_roots
from beammodes.numerics.long_decimals import as_decimal
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, End
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.linear import LinearModel, linearize

__all__ = ["joined", "shortened", "supported_chain_frequencies"]


# A uniform chain without the row of equal rods in its middle: what tells it from others of its length.

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
    >>> chain.scaled.joint_stiffness[0], chain.pieces - 1 + rods           # 6 N/(3 N - 1) at the wall
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


# A long chain put together from its two ends' blocks and the row of rods between them, modes counted.
#
# The modes below a squared frequency w are as many as those of the three parts with their cuts held and the
# negative eigenvalues of the parts' common stiffness at the cuts, together: elimination of K - w M in the
# parts
# first and at the cuts last has these pivots (Sylvester's law of inertia).


def joined(planes: list[Plane], row: Row) -> tuple[int, Decimal]:
    """Return the count and the determinant of two blocks with a row of rods between them.

    Coordinates are y and θ where the left block ends, y and -θ where the right one does: equal in symmetric
    motion, opposite in antisymmetric.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from beammodes.closed_form.carried_planes import block_of, carried
    >>> from beammodes.chains.pieces import Pieces
    >>> from beammodes.closed_form.carried_planes import row_of_rods
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((0.0, 0.0), (0.0, 0.0)))
    >>> w, none = Decimal("0.01"), Decimal(0)
    >>> end = carried(block_of(rod, 1, Fraction(1, 2)), w, none)
    >>> joined([end, end], row_of_rods(8, 1 / Decimal(12), none, w))[0]  # free, √w N² = 10 < 22.4
    2
    """
    pairs = list(zip(row.symmetric, row.antisymmetric, strict=True))
    own, other = ([(a + sign * b) / 2 for a, b in pairs] for sign in (1, -1))
    (a, b, c), (d, e, f) = ([x + y for x, y in zip(plane.stiffness(), own, strict=True)] for plane in planes)
    (p, q, r) = other
    matrix = [[a, b, p, q], [b, c, q, r], [p, q, d, e], [q, r, e, f]]
    count, value = inertia_and_determinant(matrix)
    for plane in planes:
        count += plane.below
        value *= plane.minor(0, 1)
    return count + row.clamped, value * row.determinant


# As `dispersion` has it for plain ends.
_MOST_SEGMENTS = 10**9


# Digits beyond those that small and large numbers cost.
_DIGITS = 50


_HALF = Fraction(1, 2)


# Where a part is singular at a place, one so much further is sampled: far less than roots are closed in.
_NUDGE, _NUDGES = Decimal("1e-40"), 3


def supported_chain_frequencies(
    boundary: BoundaryLike,
    segments: int,
    modes: int,
    rule: RuleLike = "mitiguy",
    load: Load | None = None,
    rotary_inertia: float | Fraction = 0.0,
) -> Floats:
    """Return the lowest elastic natural frequencies of a uniform chain with any ends.

        M u'' + K u = 0     as `linear.nodal_matrices` has it for Chain(Beam.unit(), boundary, segments, rule)

    Every mode is right to the last place, for N = 1 to 10⁹ and springs and bodies of any size.

    Parameters
    ----------
    boundary : str, pair or Boundary
        The two ends; stiffnesses in EI/L³ and EI/L, bodies in ρA L, ρA L³ and L.
    segments : int
        N, 1 to 10⁹.
    modes : int
        How many, from the first elastic one. Each costs some milliseconds.
    rule : str or Rule
    load : Load, optional
        An axial force in EI/L².
    rotary_inertia : float, optional
        ρI of the beam's sections in ρA L², none if left out.

    Returns
    -------
    ndarray, shape (modes,) [√(EI / (ρA L⁴))]
        Ascending; NaN where the chain has no such mode or a spring would not be positive.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or the axial force buckles the chain.

    Source
    ------
    Derived here: the heads of this module, `carried_planes` and `rod_row`.

    Examples
    --------
    >>> supported_chain_frequencies("clamped-free(mass=1)", 10**6, 2).round(4)
    array([ 1.5573, 16.2501])
    """
    pair, record, size = Boundary.of(boundary), rule_named(rule), whole_number("modes", modes)
    count = whole_number("segments", segments, most=_MOST_SEGMENTS)
    force, section = Fraction(checked_load(load).axial_force), _section(rotary_inertia)
    found, short = np.full(size, np.nan), shortened(pair, count, record, section)
    if short is None:
        return found
    spread = _decades(force, section, *astuple(pair.left), *astuple(pair.right))
    model = linearize(short[0], load=Load(force / count**2))
    problem = _Problem(model, short[1], record.rotary_inertia + section * count**2, count, spread)
    with localcontext(Context(prec=_DIGITS)):
        squares = problem.squares(size)
        found[: len(squares)] = [float(square.sqrt()) for square in squares]
    return found


def _section(value: float | Fraction) -> Fraction:
    if real("rotary_inertia", value) < 0:
        raise ValueError(f"rotary_inertia must not be negative, got {shown(value)}")
    return Fraction(value)


def _decades(*numbers: Fraction | float) -> int:
    """Return by how many decades numbers, zeros and infinities aside, depart from one, all together."""
    sizes = [abs(float(number)) for number in numbers]
    return sum(math.ceil(abs(math.log10(size))) for size in sizes if 0 < size < math.inf)


class _Numbers(NamedTuple):
    """A chain's numbers, as many digits long as a sample needs: its two blocks, or one that is all of it."""

    blocks: list[Block]
    inertia: Decimal
    tension: Decimal


@dataclass(frozen=True, eq=False)
class _Problem:
    """A shortened chain under its load, with `rods` more in its middle, each of rotary inertia `inertia`.

    Squared frequencies are those of the unit beam, w N⁴.
    """

    short: LinearModel
    rods: int
    inertia: Fraction
    segments: int
    spread: int
    known: dict[int, _Numbers] = field(default_factory=dict)

    def squares(self, most: int) -> list[Decimal]:
        """Return at most so many squared frequencies, the elastic ones from the lowest."""
        count = min(most, self.short.elastic_modes + self.rods)
        if not count:
            return []
        rigid = self.short.rigid_body_modes
        low = high = self.sample(Decimal(1))
        while low.below > rigid:
            if low.place.adjusted() < -2 * (_DIGITS + self.spread):
                raise ValueError(
                    "axial_force must not compress the chain beyond its buckling load (see buckling_load)"
                )
            low = self.sample(low.place / 1000)
        while high.below < rigid + count:
            high = self.sample(high.place * 10)
        return ordered_roots(self.sample, low, high, count)

    def sample(self, place: Decimal) -> Sample:
        """Count the squared frequencies below `place`, or just above it where a part is singular there."""
        digits = _DIGITS + self.spread + 2 * abs(place.adjusted()) + 6 * len(str(self.segments))
        # Steps of 32 digits: the numbers are worked out in few lengths.
        with localcontext(prec=32 * (digits // 32 + 1)) as context:
            for _ in range(_NUDGES):
                try:
                    return Sample(place, *self._counted(place / self.segments**4, context.prec))
                except (DivisionByZero, InvalidOperation):
                    place *= 1 + _NUDGE
        raise ArithmeticError(f"{self.short.chain.boundary.name}: singular at {place}")

    def _counted(self, square: Decimal, digits: int) -> tuple[int, Decimal]:
        if digits not in self.known:
            self.known[digits] = self._numbers()
        blocks, inertia, tension = self.known[digits]
        if not self.rods:
            return closed(carried(blocks[0], square, tension), blocks[1].supports)
        planes = [carried(block, square, tension) for block in blocks]
        return joined(planes, row_of_rods(self.rods, inertia, tension, square))

    def _numbers(self) -> _Numbers:
        chain, force = self.short.chain, self.short.load.axial_force
        pieces, half = chain.scaled, chain.pieces // 2
        turned = pieces.turned()
        if self.rods:
            blocks = [block_of(pieces, half, _HALF), block_of(turned, chain.pieces - half, _HALF)]
        else:
            blocks = [block_of(pieces, chain.pieces), block_of(turned, 0)]
        return _Numbers(blocks, as_decimal(self.inertia), as_decimal(force))
