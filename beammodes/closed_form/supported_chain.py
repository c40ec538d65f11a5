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
from numpy.typing import NDArray

from beammodes.chains.rules import RuleLike, rule_named
from beammodes.checks import real, shown, whole_number
from beammodes.closed_form.carried_planes import Block, as_decimal, block_of, carried, closed
from beammodes.closed_form.counted_brackets import Counted, roots_between
from beammodes.closed_form.joined_blocks import joined
from beammodes.closed_form.rod_row import row_of_rods
from beammodes.closed_form.shortened_chain import shortened
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.linear import LinearModel, linearize

__all__ = ["supported_chain_frequencies"]

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
) -> NDArray[np.float64]:
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
        return roots_between(self.sample, low, high, count)

    def sample(self, place: Decimal) -> Counted:
        """Count the squared frequencies below `place`, or just above it where a part is singular there."""
        digits = _DIGITS + self.spread + 2 * abs(place.adjusted()) + 6 * len(str(self.segments))
        # Steps of 32 digits: the numbers are worked out in few lengths.
        with localcontext(prec=32 * (digits // 32 + 1)) as context:
            for _ in range(_NUDGES):
                try:
                    return Counted(place, *self._counted(place / self.segments**4, context.prec))
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
        pieces, half = chain.pieces_and_springs, chain.pieces // 2
        turned = pieces.turned()
        if self.rods:
            blocks = [block_of(pieces, half, _HALF), block_of(turned, chain.pieces - half, _HALF)]
        else:
            blocks = [block_of(pieces, chain.pieces), block_of(turned, 0)]
        return _Numbers(blocks, as_decimal(self.inertia), as_decimal(force))
