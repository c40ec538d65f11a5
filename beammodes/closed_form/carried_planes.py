"""The states that an end of a chain lets through, carried over its outer pieces, with a count of its modes.

A state is (y, θ, M, V), M the bending moment and V = y''' - t y' of the chain, so that the block to the left
of a section is held there by the force -V and the moment M. At squared frequency w, over a piece of length
l whose mass m sits at c and turns with inertia J, and over a hinge of flexibility f,

    y₁ = y₀ + l θ,   V₁ = V₀ + w m (y₀ + c θ),   M₁ = M₀ + l V₁ - w (m c (y₀ + c θ) + J θ) + t l θ,
    θ₁ = θ₀ + f M.

An end leaves a plane of states, spanned by two. Let d be the determinant of their (y, θ). Pieces, being
rigid, do not change it, and a hinge of stiffness k multiplies it by (k + S)/k, S being how stiffly the block
to its left resists turning where y is held: the pivot with which elimination takes that angle out of K - w M.
So the signs of d, hinge after hinge, are those of a Sturm sequence: as many modes of the block, held at the
section, lie below w as the sequence changes sign. At the other end the sequence goes on with the forces that
replace what is free there. All members are polynomials in w: there is nothing to divide by.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

from beammodes.chains.pieces import Pieces
from beammodes.numerics.long_decimals import as_decimal

__all__ = ["Block", "Plane", "Row", "block_of", "carried", "closed", "row_of_rods"]


State = tuple[Decimal, Decimal, Decimal, Decimal]


_ZERO, _ONE = Decimal(0), Decimal(1)


class Block(NamedTuple):
    """Pieces (l, m, c, J) from an end inward, the flexibility of the hinge after each, and (K_t, K_r)."""

    pieces: tuple[tuple[Decimal, Decimal, Decimal, Decimal], ...]
    flexibility: tuple[Decimal, ...]
    supports: tuple[Decimal, Decimal]


class Plane(NamedTuple):
    """Two states at a section, how many modes the block held there has below w, and the last sign of d."""

    first: State
    second: State
    below: int
    sign: int

    def minor(self, i: int, j: int) -> Decimal:
        """Return the determinant of entries i and j of the two states."""
        return self.first[i] * self.second[j] - self.first[j] * self.second[i]

    def stiffness(self) -> tuple[Decimal, Decimal, Decimal]:
        """Return the yy, yθ and θθ entries of the block's condensed K - w M at the section."""
        common = 1 / self.minor(0, 1)
        return self.minor(1, 3) * common, self.minor(3, 0) * common, self.minor(0, 2) * common


def block_of(pieces: Pieces, count: int, middle: Fraction = Fraction(0)) -> Block:
    """Return the first `count` pieces; the hinge after the last of them has flexibility `middle`.

    Examples
    --------
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((0.0, 0.0), (0.0, 0.0)))
    >>> len(block_of(rod, 1).pieces)
    1
    """
    columns = (pieces.length, pieces.mass, pieces.centre, pieces.rotary_inertia)
    rows = zip(*(map(as_decimal, column[:count]) for column in columns), strict=True)
    inside = tuple(1 / as_decimal(k) for k in pieces.joint_stiffness[: count - 1])
    translation, rotation = map(as_decimal, pieces.supports[0])
    return Block(tuple(rows), (*inside, as_decimal(middle)), (translation, rotation))


def carried(block: Block, square: Decimal, tension: Decimal) -> Plane:
    """Return the plane of states behind a block's last hinge at w = `square` and t = `tension`.

    Examples
    --------
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((0.0, 0.0), (0.0, 0.0)))
    >>> [float(value) for value in carried(block_of(rod, 1), Decimal(2), Decimal(0)).first]    # w m l/2, w m
    [1.0, 0.0, 1.0, 2.0]
    """
    first, second = _let_through(block.supports)
    count, sign = 0, 1
    for piece, flexibility in zip(block.pieces, block.flexibility, strict=True):
        first = _across(piece, flexibility, first, square, tension)
        second = _across(piece, flexibility, second, square, tension)
        count, sign = _counted(count, sign, first[0] * second[1] - second[0] * first[1])
    return Plane(first, second, count, sign)


def _let_through(supports: tuple[Decimal, Decimal]) -> tuple[State, State]:
    """Return a support's two states in the order of y, θ, M, V, which makes the first d > 0."""
    translation, rotation = supports
    turning = (_ZERO, _ZERO, _ONE, _ZERO) if rotation.is_infinite() else (_ZERO, _ONE, rotation, _ZERO)
    if translation.is_infinite():
        return turning, (_ZERO, _ZERO, _ZERO, _ONE)
    return (_ONE, _ZERO, _ZERO, -translation), turning


def _across(
    piece: tuple[Decimal, ...], flexibility: Decimal, state: State, square: Decimal, tension: Decimal
) -> State:
    """Carry a state over a piece and the hinge behind it."""
    length, mass, centre, inertia = piece
    y, slope, moment, shear = state
    force = square * mass * (y + centre * slope)
    shear += force
    moment += length * shear - centre * force + (tension * length - square * inertia) * slope
    return y + length * slope, slope + flexibility * moment, moment, shear


def _counted(count: int, sign: int, value: Decimal) -> tuple[int, int]:
    """Go on with a Sturm sequence; zeros, such as stand at its start where the end holds, are passed over."""
    if not value or (value > 0) == (sign > 0):
        return count, sign
    return count + 1, -sign


def closed(plane: Plane, supports: tuple[Decimal, Decimal]) -> tuple[int, Decimal]:
    """Return how many modes the whole chain has below w, and its determinant, at the far end's supports.

    Examples
    --------
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((3.0, 0.0), (0.0, 0.0)))
    >>> block = block_of(rod, 1)                               # a rod that a spring of 3 holds at its tip:
    >>> [closed(carried(block, Decimal(w), Decimal(0)), (Decimal(0), Decimal(0)))[0] for w in (11, 13)]
    [1, 2]
    """
    translation, rotation = supports
    force = _ZERO if translation.is_infinite() else translation
    couple = _ZERO if rotation.is_infinite() else rotation
    states = [
        (y, slope, moment + couple * slope, force * y - shear)
        for y, slope, moment, shear in (plane.first, plane.second)
    ]
    ended = plane._replace(first=states[0], second=states[1])
    turning = 1 if rotation.is_infinite() else 2
    count, sign = _counted(plane.below, plane.sign, ended.minor(0, turning))
    if translation.is_infinite():
        return count, ended.minor(0, turning)
    value = ended.minor(3, turning)
    return _counted(count, sign, value)[0], value


# The inside of a uniform chain, a row of equal rods between equal hinges, in closed form at any length.
#
# In units of a rod (length, mass, hinge stiffness 1; r its central rotary inertia, t the axial force) a wave
# y_j = cos qj has, with x = sin²(q/2), the squared frequency
#
#     w = (16 x² + 4 t x) / (1 - (1 - 4r) x).
#
# For w > 0 that is a quadratic equation with one root x > 0 and one -X < 0, and w = 16 x X whatever t. They
# are
# an oscillating wave (beyond the band's edge x = 1 one that alternates and decays, q = π + iσ) and an
# evanescent one, X = sinh²(χ/2). A row of n rods, cut at both ends in the middle of a hinge, moves
# symmetrically about its own middle with cos qj and cosh χj, antisymmetrically with sin qj and sinh χj.
# Either
# way its left end has the stiffness
#
#     4/(T + τ) [ -(x + X) τ T,  x T - X τ;  x T - X τ,  x + X ]       of (y, θ), with
#
#     symmetric:      τ = sin q tan(qn/2),    T = sinh χ tanh(χn/2),
#     antisymmetric:  τ = -sin q cot(qn/2),   T = sinh χ coth(χn/2).
#
# Its modes with both ends pinned are q = kπ/n, k < n; holding the two ends' rotations as well takes away as
# many below w as there are negative stiffnesses θθ, that is negative T + τ: Wittrick and Williams, Quarterly
# Journal of Mechanics and Applied Mathematics 24 (1971). Powers of cos q + i sin q and of e^χ give all of it
# without angles.

Stiffness = tuple[Decimal, Decimal, Decimal]


class Row(NamedTuple):
    """Stiffness (yy, yθ, θθ) of symmetric and antisymmetric motion, clamped modes below w, their determinant.

    The determinant lacks positive factors; with them it is a polynomial in w without the stiffnesses' poles.
    """

    symmetric: Stiffness
    antisymmetric: Stiffness
    clamped: int
    determinant: Decimal


def row_of_rods(rods: int, inertia: Decimal, tension: Decimal, square: Decimal) -> Row:
    """Return the dynamic stiffness of a row of an even number of rods at w = `square` > 0.

    Examples
    --------
    >>> row = row_of_rods(1000, 1 / Decimal(12), Decimal(0), Decimal("2e-8"))
    >>> row.clamped                       # q n = 4.73, 7.85, 11.0, 14.1, ... of a clamped beam; here 11.9
    3
    """
    x, evanescent = _waves(inertia, tension, square)
    turns, inside, below = _oscillating(rods, x)
    growths = _evanescent(rods, evanescent)
    sums = [turn + growth for turn, growth in zip(turns, growths, strict=True)]
    symmetric, antisymmetric = (
        _stiffness(x, evanescent, turn, growth) for turn, growth in zip(turns, growths, strict=True)
    )
    clamped = below - sum(value < 0 for value in sums)
    return Row(symmetric, antisymmetric, clamped, inside * sums[0] * sums[1])


def _waves(inertia: Decimal, tension: Decimal, square: Decimal) -> tuple[Decimal, Decimal]:
    """Return x and X."""
    middle = 4 * tension + (1 - 4 * inertia) * square
    root = (middle * middle + 64 * square).sqrt()
    x = 2 * square / (root + middle) if middle > 0 else (root - middle) / 32
    return x, square / (16 * x)


def _stiffness(x: Decimal, evanescent: Decimal, turn: Decimal, growth: Decimal) -> Stiffness:
    common = 4 / (growth + turn)
    total = (x + evanescent) * common
    return -total * turn * growth, (x * growth - evanescent * turn) * common, total


def _evanescent(rods: int, evanescent: Decimal) -> tuple[Decimal, Decimal]:
    """Return T of symmetric and antisymmetric motion."""
    sinh, tanh = _hyperbolic(rods, evanescent)
    return sinh * tanh, sinh / tanh


def _hyperbolic(rods: int, x: Decimal) -> tuple[Decimal, Decimal]:
    """Return sinh χ and tanh(χn/2) where x = sinh²(χ/2)."""
    sinh = 2 * (x * (1 + x)).sqrt()
    decay = (1 / (1 + 2 * x + sinh)) ** rods
    return sinh, (1 - decay) / (1 + decay)


def _oscillating(rods: int, x: Decimal) -> tuple[tuple[Decimal, Decimal], Decimal, int]:
    """Return τ of both motions, sin(qn/2) cos(qn/2) / sin q, and how many pinned modes lie below."""
    if x > 1:
        sinh, tanh = _hyperbolic(rods, x - 1)
        return (sinh * tanh, sinh / tanh), -tanh / sinh, rods - 1
    sin = 2 * (x * (1 - x)).sqrt()
    cosine, sine = _power(1 - 2 * x, sin, rods // 2)
    product = sine * cosine
    turns = sin * sine / cosine, -sin * cosine / sine
    # The sign of sin qn says whether k is even: so a rounded angle is enough to know k = ⌊qn/π⌋.
    odd = int(product < 0)
    angle = 2 * rods * math.atan2(math.sqrt(x), math.sqrt(1 - x))
    return turns, product / sin, 2 * round((angle / math.pi - 0.5 - odd) / 2) + odd


def _power(cosine: Decimal, sine: Decimal, exponent: int) -> tuple[Decimal, Decimal]:
    """Return cos and sin of `exponent` times an angle."""
    real, imaginary = Decimal(1), Decimal(0)
    for bit in f"{exponent:b}":
        real, imaginary = 1 - 2 * imaginary * imaginary, 2 * real * imaginary
        if bit == "1":
            real, imaginary = real * cosine - imaginary * sine, real * sine + imaginary * cosine
    return real, imaginary
