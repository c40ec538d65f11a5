"""One frequency of a uniform beam with springs and bodies at its ends and an axial force.

Three steps, each checked by the next. The count of `end_waves` brackets the root, and secants close in on it
in doubles. Then the residual there, in more digits, over its rise in doubles across the root, corrects it:
that keeps every digit, however soft a spring or heavy a body is. It is believed if the counts on either side
are k - 1 and k, if doubles and digits agree on the residual to a thousandth of the rise, and if what the
correction may leave is less than half a unit in the last place. All others, near-double roots and beams that
buckle among them, are found again in long decimals.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from typing import Any, NamedTuple

from beammodes.exact.end_waves import DECIMALS, FLOATS, EndNumbers, read, residual
from beammodes.exact.uniform_beam import ABOVE_CRITICAL, UnitBeam, UnitEnd
from beammodes.numerics.counted_secants import Reading, counted_root
from beammodes.numerics.long_decimals import LONG, as_decimal

__all__ = [
    "FLOOR",
    "LAST",
    "NOISE",
    "ROOT_OF_SHAPE",
    "Rise",
    "apart",
    "cutoff",
    "in_decimals",
    "rigid_modes",
    "supported_frequency",
    "supported_root",
]

#: Below this frequency waves are too much alike for doubles, and long decimals look for roots.
FLOOR = 1e-5
#: Rounding of the residual, beside its rise, up to which it is believed.
NOISE = 1e-3
#: What a correction may leave.
LAST = 5e-17
#: What a root for a shape may leave: near-double roots need many more digits than a double has.
ROOT_OF_SHAPE = 1e-24
# The rise is taken over this part of the frequency to either side, and from some mode on over a part that
# falls as the modes draw near each other.
_APART, _APART_TO_MODE = 1e-6, 100.0
# Brackets end short of the cut-off of shear by this part of it.
_SHORT_OF_CUTOFF = 1e-4
# Digits of the residual: cancellation takes twelve where doubles still count, and 25 are wanted of the rest.
_DIGITS = 50


def supported_frequency(
    left: Sequence[float], right: Sequence[float], mode: int, tension: float = 0.0, gyration: float = 0.0
) -> float:
    """Return ω √(ρA L⁴/EI) of an elastic mode, right to the last digit; NaN if the straight beam buckles.

    Parameters
    ----------
    left, right : sequence of five floats
        Springs and moving body of the ends in multiples of EI/L³, EI/L, ρA L, ρA L³ and L.
    mode : int
        From 1: rigid-body modes do not count.
    tension : float
        T L²/EI.
    gyration : float
        ρI/(ρA L²), of the section.

    Examples
    --------
    >>> clamped, loaded = (math.inf, math.inf, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 0.0)
    >>> [round(supported_frequency(clamped, loaded, mode), 4) for mode in (1, 2)]
    [1.5573, 16.2501]
    """
    with localcontext(LONG):
        beam = _beam(left, right, tension, gyration)
        omega = supported_root(beam, mode + rigid_modes(left, right, tension))
    return math.nan if omega is None else float(omega)


def rigid_modes(left: Sequence[Any], right: Sequence[Any], tension: Any) -> Any:
    """Return how many motions leave the beam straight and feel neither supports nor force.

    The ends' numbers are floats, or arrays of them.

    Examples
    --------
    >>> free, pinned = (0.0, 0.0), (math.inf, 0.0)
    >>> [rigid_modes(free, end, force) for end in (free, pinned) for force in (0.0, 1.0)]
    [2, 1, 1, 0]
    """
    across = 1 * (left[0] > 0) + (right[0] > 0)
    turns = (across < 2) & (left[1] <= 0) & (right[1] <= 0) & (tension == 0)
    return (across == 0) + 1 * turns


def apart(number: Any) -> Any:
    """Return over which part of the frequency to either side the residual's rise is taken."""
    return _APART / (1.0 + number / _APART_TO_MODE)


class Rise(NamedTuple):
    """How the residual changes with a relative change of ω: how fast, and that rate's own relative change."""

    residual: Any
    part: Any
    rate: Any
    bend: Any

    @classmethod
    def across(cls, below: Reading, here: Reading, above: Reading, part: Any) -> Rise:
        """Return the rise between readings at (1 - part) ω, ω and (1 + part) ω."""
        down, up = here.residual - below.residual, above.residual - here.residual
        rate = (up + down) / (2.0 * part)
        return cls(here.residual, part, rate, abs((up - down) / (part**2 * rate)))

    def noise(self, exact: Any) -> Any:
        """Return the rounding of the residual beside its rise."""
        return abs((exact - self.residual) / (self.part * self.rate))

    def left(self, step: Any, noise: Any) -> Any:
        """Return what a correction by this part of ω leaves."""
        return abs(step) * (noise + self.bend * abs(step))


def supported_root(beam: UnitBeam, number: int, rest: float = LAST) -> Decimal | None:
    """Return ω of one number, rigid-body modes included, to this part of itself; None if the beam buckles.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.ends import Boundary
    >>> root = supported_root(UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned")), 1, 1e-24)
    >>> str(root)[:25], math.pi**2
    ('9.86960440108935861883449', 9.869604401089358)
    """
    if beam.tension < -ABOVE_CRITICAL:
        return None
    if beam.has_hub:
        with localcontext(LONG):
            square = beam.root(number, as_decimal(max(_pinned(beam, (number - 0.5) * math.pi), FLOOR)) ** 2)
            return None if square is None else square.sqrt()
    try:
        omega, sure = _corrected(beam, number, rest)
    except (ArithmeticError, ValueError):
        # Beyond the range of doubles.
        omega, sure = Decimal(1), False
    if sure:
        return omega
    with localcontext(LONG):
        square = beam.root(number, omega * omega)
        return None if square is None else square.sqrt()


def _corrected(beam: UnitBeam, number: int, rest: float) -> tuple[Decimal, bool]:
    """Return the root, and whether it is sure."""
    with localcontext(LONG) as context:
        context.prec = _DIGITS
        exact_left, exact_right = EndNumbers.exact(beam.left), EndNumbers.exact(beam.right)
        left, right = EndNumbers(*map(float, exact_left)), EndNumbers(*map(float, exact_right))
        tension, gyration, shear = float(beam.tension), float(beam.gyration), float(beam.shear)

        def at(place: float) -> Reading:
            return read(FLOATS, left, right, place, tension, gyration, shear)

        # The pinned beam has k - 1 roots below k π. Others have at most two less and four more below a place.
        start, low, high = (_pinned(beam, (number + more) * math.pi) for more in (-0.5, -4.1, 2.1))
        high = min(high, cutoff(beam) * (1.0 - _SHORT_OF_CUTOFF))
        near, part = counted_root(at, number, start, low, high, FLOOR), apart(number)
        below, here, above = (at(near * factor) for factor in (1.0 - part, 1.0, 1.0 + part))
        omega = Decimal(near)
        if below.below != number - 1 or above.below != number or near < 2.0 * FLOOR:
            return omega, False
        if tension < 0.0 and at(FLOOR).below > beam.translation_is_free:
            # More than a translation below the floor: the beam may buckle.
            return omega, False
        rise, noise, left_over = Rise.across(below, here, above, part), 0.0, math.inf
        for count in range(3):
            square = omega * omega
            numbers = (square, beam.tension, beam.gyration, beam.shear)
            value = float(residual(DECIMALS, exact_left, exact_right, *numbers))
            noise = noise if count else rise.noise(value)
            step = value / rise.rate
            omega -= omega * Decimal(step)
            left_over = rise.left(step, noise)
            if left_over < rest:
                break
        return omega, noise < NOISE and left_over < rest


def cutoff(beam: UnitBeam) -> float:
    """Return ω beyond which shear has a second branch of modes, infinite without shear or rotary inertia."""
    coupled = float(beam.shear) * float(beam.gyration)
    return math.sqrt((1.0 + float(beam.shear * beam.tension)) / coupled) if coupled else math.inf


def _pinned(beam: UnitBeam, wave: float) -> float:
    """Return ω of the wavenumber q on the first branch, zero where there is none."""
    tension, gyration, shear = float(beam.tension), float(beam.gyration), float(beam.shear)
    stiffness = wave * wave * (wave * wave + tension)
    if wave <= 0.0 or stiffness <= 0.0:
        return 0.0
    mass = 1.0 + shear * tension + (gyration + shear) * wave * wave
    return math.sqrt(2.0 * stiffness / (mass + math.sqrt(mass * mass - 4.0 * shear * gyration * stiffness)))


def in_decimals(
    left: Sequence[float], right: Sequence[float], number: int, tension: float, gyration: float, near: float
) -> float:
    """Return the frequency of one number, rigid-body modes included, by counts in long decimals alone."""
    with localcontext(LONG):
        start = near * near if 0.0 < near < math.inf else 1.0
        square = _beam(left, right, tension, gyration).root(number, as_decimal(start))
        return math.nan if square is None else float(square.sqrt())


def _beam(left: Sequence[float], right: Sequence[float], tension: float, gyration: float) -> UnitBeam:
    return UnitBeam(as_decimal(tension), as_decimal(gyration), _end(left), _end(right))


def _end(side: Sequence[float]) -> UnitEnd:
    holds = (side[0] == math.inf, side[1] == math.inf)
    numbers = (0.0 if number == math.inf else number for number in side)
    return UnitEnd(holds, *map(as_decimal, numbers))
