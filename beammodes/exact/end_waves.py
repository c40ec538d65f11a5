"""The characteristic equation of a beam between two ends, told in waves, with a count of its roots.

A beam of unit length, stiffness and mass, its ends as in `uniform_beam`. Below the cut-off of shear each end
sees  a cos qz + b sin qz + c e^(-pz) + d e^(pz)  at the distance z from it. Its two conditions on a, b, c, d
have six determinants, each linear in  det Z, Z_yy, Z_θθ, Z_yθ  and  1  of the end's stiffness Z = K - ω² M;
if that holds, in what goes with the highest power of the infinite spring. From one end to the other a product
of two waves only turns by q and fades by e^(-p): the whole determinant is twenty operations on those of the
ends. It is one formula for doubles, arrays of them, pairs of doubles and decimals.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from beammodes.exact.uniform_beam import UnitEnd
from beammodes.numerics import double_double, long_decimals
from beammodes.numerics.arrays import Floats
from beammodes.numerics.counted_secants import Reading
from beammodes.numerics.double_double import DoubleDouble

__all__ = ["ARRAYS", "DECIMALS", "FLOATS", "PAIRS", "Algebra", "Counting", "EndNumbers", "read", "residual"]


@dataclass(frozen=True, slots=True)
class Algebra:
    """The functions of one kind of numbers, and a half in it."""

    half: Any
    sqrt: Callable[[Any], Any]
    cosine_and_sine: Callable[[Any], tuple[Any, Any]]
    decay: Callable[[Any], Any]
    where: Callable[[Any, Any, Any], Any]


@dataclass(frozen=True, slots=True)
class Counting(Algebra):
    """An algebra of doubles, in which roots are counted, too."""

    ceil: Callable[[Any], Any]
    angle: Callable[[Any, Any], Any]


FLOATS = Counting(
    0.5,
    math.sqrt,
    lambda x: (math.cos(x), math.sin(x)),
    lambda x: math.exp(-x),
    lambda mask, one, other: one if mask else other,
    math.ceil,
    math.atan2,
)
ARRAYS = Counting(
    0.5,
    np.sqrt,
    lambda x: (np.cos(x), np.sin(x)),
    lambda x: np.exp(-x),
    np.where,
    np.ceil,
    np.arctan2,
)
PAIRS = Algebra(
    0.5,
    DoubleDouble.sqrt,
    double_double.cosine_and_sine,
    double_double.decay,
    DoubleDouble.where,
)
DECIMALS = Algebra(
    Decimal("0.5"),
    Decimal.sqrt,
    long_decimals.cosine_and_sine,
    long_decimals.decay,
    FLOATS.where,
)


class EndNumbers(NamedTuple):
    """An end: springs, ones where they hold; whether it may move, one or zero; and the body.

    `across` is the mass that deflects, `coupled` that times the offset, `carried` the m a² of any body.
    """

    spring: Any
    may_deflect: Any
    turning: Any
    may_turn: Any
    inertia: Any
    across: Any
    coupled: Any
    carried: Any

    @classmethod
    def of(cls, spring: Floats, turning: Floats, mass: Floats, inertia: Floats, offset: Floats) -> EndNumbers:
        """Return ends from the numbers of `EndColumns`."""
        held, fixed = spring == math.inf, turning == math.inf
        may_deflect, may_turn = 1.0 - held, 1.0 - fixed
        across = mass * may_deflect
        return cls(
            np.where(held, 1.0, spring),
            may_deflect,
            np.where(fixed, 1.0, turning),
            may_turn,
            inertia,
            across,
            across * offset,
            mass * offset * offset,
        )

    def in_pairs(self, mass: Floats, offset: Floats) -> EndNumbers:
        """Return these numbers with the products of mass and offset exact, in pairs of doubles."""
        arm = DoubleDouble.of(mass) * offset
        return self._replace(coupled=arm * self.may_deflect, carried=arm * offset)

    @classmethod
    def exact(cls, end: UnitEnd) -> EndNumbers:
        """Return an end in decimals of the context's digits."""
        may_deflect, may_turn = (Decimal(not held) for held in end.holds)
        mass, one = +end.mass, Decimal(1)
        arm = mass * end.offset
        return cls(
            +end.translational if may_deflect else one,
            may_deflect,
            +end.rotational if may_turn else one,
            may_turn,
            +end.inertia,
            mass * may_deflect,
            arm * may_deflect,
            arm * end.offset,
        )


class _Waves(NamedTuple):
    """Both wavenumbers, `angle` and `fading`, and what waves of unit deflection have at an end.

    Rotations `turn` of the sine and `fall` of the fading wave, moments `bent` and `fallen` of cosine and
    fading wave: q, p, q² and p² without shear. `pull` is `fallen` less `bent`, `apart` their sum.
    """

    square: Any
    angle: Any
    fading: Any
    turn: Any
    fall: Any
    bent: Any
    fallen: Any
    pull: Any
    apart: Any


class _Side(NamedTuple):
    """Determinants of an end's conditions on pairs of waves, and its stiffness θθ.

    Those of sine or cosine with the wave that fades into the beam, or grows; both alike, of sine with cosine
    and of fading with growing.
    """

    sine: Any
    cosine: Any
    sine_grown: Any
    cosine_grown: Any
    alike: Any
    turning: Any


def _waves(algebra: Algebra, square: Any, tension: Any, gyration: Any, shear: Any) -> _Waves:
    """Return both waves; nothing cancels but the tension with the rotary inertia, and next to the cut-off."""
    pull = tension - square * gyration if gyration else tension
    if shear:
        pull = pull + square * shear
    half = pull * algebra.half
    middle = algebra.sqrt(half * half + square)
    pulled = half > 0.0
    large = middle + algebra.where(pulled, half, -half)
    small = square / large
    fallen, bent = algebra.where(pulled, large, small), algebra.where(pulled, small, large)
    if not shear:
        q, p = algebra.sqrt(bent), algebra.sqrt(fallen)
        return _Waves(square, q, p, q, p, bent, fallen, pull, 2 * middle)
    q = algebra.sqrt(bent + square * shear)
    p = algebra.sqrt(fallen - square * shear)
    return _Waves(square, q, p, bent / q, fallen / p, bent, fallen, pull, 2 * middle)


def _side(end: EndNumbers, waves: _Waves) -> _Side:
    square, turn, fall, bent, fallen = waves.square, waves.turn, waves.fall, waves.bent, waves.fallen
    deflection = end.spring - square * end.across
    turning = end.turning - square * end.inertia
    carried = square * end.carried
    # The products of coupled terms cancel by hand: a small inertia beside m a² would drown in them.
    both = deflection * turning - end.spring * carried
    turning = turning - carried
    free = end.may_deflect * end.may_turn
    coupled = square * end.coupled
    doubled = 2 * coupled
    a_even = fall * (both - bent * (doubled + bent * free))
    a_odd = waves.apart * (deflection * end.may_turn)
    b_even = both + fallen * (doubled - fallen * free)
    b_odd = fall * waves.apart * (turning * end.may_deflect)
    alike = both + waves.pull * coupled + square * free
    return _Side(
        turn * (b_odd - b_even), -a_even - a_odd, -turn * (b_odd + b_even), a_even - a_odd, alike, turning
    )


class _Row(NamedTuple):
    """The left end's determinants as the right end meets them: the factor of each of its own."""

    sine: Any
    cosine: Any
    sine_grown: Any
    cosine_grown: Any
    alike: Any

    def met(self, right: _Side) -> Any:
        """Return the determinant of all four conditions."""
        running = self.sine * right.sine + self.cosine * right.cosine
        faded = self.sine_grown * right.sine_grown + self.cosine_grown * right.cosine_grown
        return running + (faded + self.alike * right.alike)


def _carried(left: _Side, waves: _Waves, cosine: Any, sine: Any, faded: Any) -> _Row:
    twice = -(faded * faded)
    return _Row(
        cosine * left.cosine + sine * left.sine,
        cosine * left.sine - sine * left.cosine,
        twice * (cosine * left.cosine_grown + sine * left.sine_grown),
        twice * (cosine * left.sine_grown - sine * left.cosine_grown),
        -4 * faded * (waves.fall * waves.turn) * left.alike,
    )


def residual(
    algebra: Algebra,
    left: EndNumbers,
    right: EndNumbers,
    square: Any,
    tension: Any,
    gyration: Any,
    shear: Any = 0,
) -> Any:
    """Return the determinant at ω² = `square`."""
    waves = _waves(algebra, square, tension, gyration, shear)
    phases = algebra.cosine_and_sine(waves.angle)
    row = _carried(_side(left, waves), waves, *phases, algebra.decay(waves.fading))
    return row.met(_side(right, waves))


def read(
    algebra: Counting,
    left: EndNumbers,
    right: EndNumbers,
    frequency: Any,
    tension: Any,
    gyration: float,
    shear: float = 0.0,
) -> Reading:
    """Count the frequencies below one and return the determinant there, in doubles.

    The pinned beam's are q = n π. From there the left end is given its rotational stiffness and is then
    let loose across, and so is the right end. A stiffness added may take a root below away, a negative one
    may add one, and letting loose may add one: which, the sign of the determinant tells (Wittrick and
    Williams, Quarterly Journal of Mechanics and Applied Mathematics 24, 1971). Where rounding makes up the
    sign of one next to its zero the count stays, as those before and after it differ in sign there.
    """
    where = algebra.where
    waves = _waves(algebra, frequency * frequency, tension, gyration, shear)
    turn, fall, apart = waves.turn, waves.fall, waves.apart
    cosine, sine = algebra.cosine_and_sine(waves.angle)
    faded = algebra.decay(waves.fading)
    pinned = algebra.ceil(waves.angle / math.pi) - 1.0
    # Of the sign that goes with the count, next to multiples of π too.
    odd = pinned % 2.0 == 1.0
    sine = where(odd, -abs(sine), abs(sine))
    one, other = _side(left, waves), _side(right, waves)
    row = _carried(one, waves, cosine, sine, faded)
    twice = faded * faded
    stiff = one.turning * (fall * sine * (1.0 + twice) - turn * cosine * (1.0 - twice))
    turned = -apart * (stiff + left.may_turn * apart * sine * (1.0 - twice))
    loose = where(left.may_deflect == 0.0, turned, -apart * (row.cosine + row.cosine_grown))
    stiff = row.alike - turn * (row.sine + row.sine_grown) - fall * (row.cosine - row.cosine_grown)
    turned_too = other.turning * stiff + right.may_turn * loose
    whole = where(right.may_deflect == 0.0, turned_too, row.met(other))
    first, second, third, fourth = turned > 0.0, loose > 0.0, turned_too > 0.0, whole > 0.0
    below = (
        pinned
        + where(first != odd, where(one.turning < 0.0, 1.0, -1.0), 0.0)
        + where(second != first, 1.0, 0.0)
        + where(third != second, where(other.turning < 0.0, 1.0, -1.0), 0.0)
        + where(fourth != third, 1.0, 0.0)
    )
    across = row.sine * other.cosine - row.cosine * other.sine
    phase = math.pi * below + algebra.angle(abs(whole), across * (1.0 - 2.0 * (below % 2.0)))
    size = algebra.sqrt((one.sine**2 + one.cosine**2) * (other.sine**2 + other.cosine**2))
    return Reading(below, whole, size, phase, waves.fading * (1.0 + gyration * waves.bent) / apart)
