"""Natural frequencies of uniform chains with any ends, at a cost that does not depend on their length.

A long chain is two short blocks of pieces, which hold all that the ends, their bodies and the rule's
corrections change, and between them a row of equal rods in closed form; all three are cut in the middle
of a hinge. A short chain is one block. How many modes lie below a squared frequency w is counted, so that
none is missed or doubled, and the determinant's sign change closes each in.

**Blocks.** A state is (y, θ, M, V), M the bending moment and V = y''' - t y' of the chain under tension
t, so that the block to the left of a section is held there by the force -V and the moment M. Over a piece
of length l whose mass m sits at c and turns with inertia J, and over a hinge of flexibility f,

    y₁ = y₀ + l θ,   V₁ = V₀ + w m (y₀ + c θ),   θ₁ = θ₀ + f M,
    M₁ = M₀ + l V₁ - w (m c (y₀ + c θ) + J θ) + t l θ.

An end admits two independent states. Let d be the determinant of their (y, θ). Pieces, being rigid, do
not change it, and a hinge of stiffness k multiplies it by (k + S)/k, S being how stiffly the block to its
left resists turning where y is held: the pivot with which elimination takes that angle out of K - w M. So
the signs of d, hinge after hinge, are those of a Sturm sequence: as many modes of the block, held at the
section, lie below w as the sequence changes sign. At the other end the sequence is continued with the
forces that replace what is free there. All members are polynomials in w: there is nothing to divide by.

**RodRow of rods.** In units of a rod (length, mass, hinge stiffness 1; r its central rotary inertia) a wave
y_j = cos qj has, with x = sin²(q/2),

    w = (16 x² + 4 t x) / (1 - (1 - 4r) x),

a quadratic equation with one root x > 0 and one -X < 0, and w = 16 x X whatever t: an oscillating wave
(beyond the band's edge x = 1 one that alternates and decays) and an evanescent one, X = sinh²(χ/2). A row
of n rods, cut at both ends in the middle of a hinge, moves symmetrically about its middle with cos qj and
cosh χj, antisymmetrically with sin qj and sinh χj. Either way its left end has the stiffness

    4/(T + τ) [ -(x + X) τ T,  x T - X τ;  x T - X τ,  x + X ]       of (y, θ), with

    symmetric:      τ = sin q tan(qn/2),    T = sinh χ tanh(χn/2),
    antisymmetric:  τ = -sin q cot(qn/2),   T = sinh χ coth(χn/2).

Its modes with both ends pinned are q = kπ/n, k < n; holding the rotations as well takes away as many
below w as there are negative T + τ (Wittrick and Williams, Quarterly Journal of Mechanics and Applied
Mathematics 24, 1971). Powers of cos q + i sin q and of e^χ give all of it without angles.

**Joined.** The modes below w are as many as those of the three parts with their cuts held and the
negative eigenvalues of the parts' common stiffness at the cuts: elimination of K - w M in the parts first
and at the cuts last has these pivots (Sylvester's law of inertia).

Soft springs, heavy bodies and small wavenumbers make a determinant lose all the digits of doubles. Here
numbers are decimals long enough for the numbers at hand, so that one formula serves all cases.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, field
from decimal import Context, Decimal, DivisionByZero, InvalidOperation, localcontext
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Pieces
from beammodes.chains.rules import Rule, RuleLike, closed_rule
from beammodes.chains.units import ExactUnits
from beammodes.checks import real, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.numerics.counted_roots import Sample, inertia_and_determinant, ordered_roots
from beammodes.numerics.long_decimals import as_decimal
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, End, check_no_hub
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.linear import LinearModel, linearize

__all__ = [
    "AdmittedStates",
    "Block",
    "RodRow",
    "block_of",
    "carried",
    "closed",
    "joined",
    "row_of_rods",
    "shortened",
    "supported_chain_frequencies",
    "supported_chain_frequency",
]

_ZERO, _ONE, _HALF = Decimal(0), Decimal(1), Fraction(1, 2)
# Unmodified hinges between the two ends' corrections: the cut is at one of them.
_BETWEEN = 6
# As `chain_frequencies` has it for plain ends.
_MOST_SEGMENTS = 10**9
# Digits beyond those that small and large numbers cost.
_DIGITS = 50
# Where a part is singular at a place, one so much further is sampled: far less than roots are closed in.
_NUDGE, _NUDGES = Decimal("1e-40"), 3

_State = tuple[Decimal, Decimal, Decimal, Decimal]
_Stiffness = tuple[Decimal, Decimal, Decimal]


def supported_chain_frequencies(
    boundary: BoundaryLike,
    segments: int,
    modes: int,
    rule: RuleLike = "mitiguy",
    load: Load | None = None,
    rotary_inertia: float | Fraction = 0.0,
) -> Floats:
    """Return the lowest elastic natural frequencies of a uniform chain with any ends.

    M u'' + K u = 0  as `linear.nodal_matrices` has it for Chain(Beam.unit(), boundary, segments, rule).
    Every mode is right to the last place, for N = 1 to 10⁹ and springs and bodies of any size; each costs
    some milliseconds. Stiffnesses are in EI/L³ and EI/L, bodies in ρA L, ρA L³ and L, an axial force in
    EI/L², `rotary_inertia` ρI in ρA L².

    Returns
    -------
    ndarray, shape (modes,) [√(EI / (ρA L⁴))]
        Ascending; NaN where the chain has no such mode or a spring would not be positive.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or the axial force buckles the chain.

    Examples
    --------
    >>> supported_chain_frequencies("clamped-free(mass=1)", 10**6, 2).round(4)
    array([ 1.5573, 16.2501])
    """
    pair, record, size = Boundary.of(boundary), closed_rule(rule), whole_number("modes", modes)
    count = whole_number("segments", segments, most=_MOST_SEGMENTS)
    force, section = Fraction(checked_load(load).axial_force), _section(rotary_inertia)
    found = np.full(size, np.nan)
    if _slides(pair, count, record):
        found[0] = _sliding(pair)
        return found
    problem = _problem(pair, count, record, force, section)
    if problem is None:
        return found
    with localcontext(Context(prec=_DIGITS)):
        squares = problem.squares(size)
        found[: len(squares)] = [float(square.sqrt()) for square in squares]
    return found


def supported_chain_frequency(
    boundary: Boundary,
    segments: int,
    rule: Rule,
    tension: float,
    rotary_inertia: float,
    mode: int,
    near: float = math.nan,
) -> float:
    """Return one of `supported_chain_frequencies`, of a mode that exists, looked for from ω = `near` on.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> pair = Boundary.of("clamped-free(mass=1)")
    >>> round(supported_chain_frequency(pair, 10**6, RULES["mitiguy"], 0.0, 0.0, mode=2), 4)
    16.2501
    """
    if _slides(boundary, segments, rule):
        return _sliding(boundary) if mode == 1 else math.nan
    problem = _problem(boundary, segments, rule, Fraction(tension), Fraction(rotary_inertia))
    if problem is None:
        return math.nan
    with localcontext(Context(prec=_DIGITS)):
        return float(problem.square(mode, as_decimal(near * near if 0.0 < near < math.inf else 1.0)).sqrt())


def _slides(pair: Boundary, segments: int, rule: Rule) -> bool:
    """Say whether the chain is one rod whose rotation both ends hold: a condition more than angles."""
    return segments == 1 and rule.stub == 1 and pair.left.holds_rotation and pair.right.holds_rotation


def _sliding(pair: Boundary) -> float:
    """Return the frequency at which such a rod moves across, NaN where nothing holds it or all does."""
    ends = (pair.left, pair.right)
    spring = float(sum(end.translational_stiffness for end in ends))
    mass = 1.0 + float(sum(end.moving_body[0] for end in ends))
    return math.sqrt(spring / mass) if 0.0 < spring < math.inf else math.nan


def _section(value: float | Fraction) -> Fraction:
    if real("rotary_inertia", value) < 0:
        raise ValueError(f"rotary_inertia must not be negative, got {shown(value)}")
    return Fraction(value)


def _problem(pair: Boundary, count: int, record: Rule, force: Fraction, section: Fraction) -> _Problem | None:
    short = shortened(pair, count, record, section)
    if short is None:
        return None
    spread = _decades(force, section, *astuple(pair.left), *astuple(pair.right))
    model = linearize(short[0], load=Load(force / count**2))
    return _Problem(model, short[1], record.rotary_inertia + section * count**2, count, spread)


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
        low = high = self.sample(Decimal(1))
        low, rigid = self.lowest(low), self.short.rigid_body_modes
        while high.below < rigid + count:
            high = self.sample(high.place * 10)
        return ordered_roots(self.sample, low, high, count)

    def square(self, mode: int, near: Decimal) -> Decimal:
        """Return the squared frequency of an elastic mode that exists, looked for from a place on."""
        number, apart = self.short.rigid_body_modes + mode, Decimal("0.001")
        if self.short.load.axial_force < 0:
            self.lowest(self.sample(near))
        low = high = self.sample(near)
        while low.below >= number:
            low, apart = self.sample(near / (1 + apart)), 4 * apart
        while high.below < number:
            high, apart = self.sample(near * (1 + apart)), 4 * apart
        return ordered_roots(self.sample, low, high, number - low.below)[-1]

    def lowest(self, low: Sample) -> Sample:
        """Return a sample that only rigid motions are below, starting from another."""
        while low.below > self.short.rigid_body_modes:
            if low.place.adjusted() < -2 * (_DIGITS + self.spread):
                raise ValueError(
                    "axial_force must not compress the chain beyond its buckling load (see buckling_load)"
                )
            low = self.sample(low.place / 1000)
        return low

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


def shortened(
    boundary: Boundary, segments: int, rule: Rule, section: Fraction = Fraction(0)
) -> tuple[Chain, int] | None:
    """Return a short chain and how many rods, an even number, belong into its middle hinge.

    The weights, supports and bodies are those of the chain of N = `segments` between the ends of a unit
    beam, in units of a segment; `section` is ρI/(ρA L²). None if a spring would not be positive.

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
    check_no_hub(end)
    return End(
        units.support(end.translational_stiffness, 2),
        units.support(end.rotational_stiffness, 0),
        *units.body(*end.moving_body),
    )


class Block(NamedTuple):
    """Pieces (l, m, c, J) from an end inward, the flexibility of the hinge after each, and (K_t, K_r)."""

    pieces: tuple[tuple[Decimal, Decimal, Decimal, Decimal], ...]
    flexibility: tuple[Decimal, ...]
    supports: tuple[Decimal, Decimal]


class AdmittedStates(NamedTuple):
    """The two states at a section, how many modes the block held there has below w, and the sign of d."""

    first: _State
    second: _State
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


def carried(block: Block, square: Decimal, tension: Decimal) -> AdmittedStates:
    """Return the admitted states behind a block's last hinge at w = `square` and t = `tension`.

    Examples
    --------
    >>> rod = Pieces((1.0,), (1.0,), (0.5,), (1 / 12,), (), ((0.0, 0.0), (0.0, 0.0)))
    >>> [float(value) for value in carried(block_of(rod, 1), Decimal(2), Decimal(0)).first]    # w m l/2, w m
    [1.0, 0.0, 1.0, 2.0]
    """
    first, second = _admitted(block.supports)
    count, sign = 0, 1
    for piece, flexibility in zip(block.pieces, block.flexibility, strict=True):
        first = _across(piece, flexibility, first, square, tension)
        second = _across(piece, flexibility, second, square, tension)
        count, sign = _counted(count, sign, first[0] * second[1] - second[0] * first[1])
    return AdmittedStates(first, second, count, sign)


def _admitted(supports: tuple[Decimal, Decimal]) -> tuple[_State, _State]:
    """Return the two states that a support admits, in the order that makes the first d > 0."""
    translation, rotation = supports
    turning = (_ZERO, _ZERO, _ONE, _ZERO) if rotation.is_infinite() else (_ZERO, _ONE, rotation, _ZERO)
    if translation.is_infinite():
        return turning, (_ZERO, _ZERO, _ZERO, _ONE)
    return (_ONE, _ZERO, _ZERO, -translation), turning


def _across(
    piece: tuple[Decimal, ...], flexibility: Decimal, state: _State, square: Decimal, tension: Decimal
) -> _State:
    """Carry a state over a piece and the hinge behind it."""
    length, mass, centre, inertia = piece
    y, slope, moment, shear = state
    force = square * mass * (y + centre * slope)
    shear += force
    moment += length * shear - centre * force + (tension * length - square * inertia) * slope
    return y + length * slope, slope + flexibility * moment, moment, shear


def _counted(count: int, sign: int, value: Decimal) -> tuple[int, int]:
    """Continue a Sturm sequence, passing over zeros, which stand at its start where the end holds."""
    if not value or (value > 0) == (sign > 0):
        return count, sign
    return count + 1, -sign


def closed(plane: AdmittedStates, supports: tuple[Decimal, Decimal]) -> tuple[int, Decimal]:
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


class RodRow(NamedTuple):
    """Stiffness (yy, yθ, θθ) of symmetric and antisymmetric motion, clamped modes below w, their determinant.

    The determinant lacks positive factors; with them it is a polynomial in w without the stiffnesses' poles.
    """

    symmetric: _Stiffness
    antisymmetric: _Stiffness
    clamped: int
    determinant: Decimal


def row_of_rods(rods: int, inertia: Decimal, tension: Decimal, square: Decimal) -> RodRow:
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
    return RodRow(symmetric, antisymmetric, clamped, inside * sums[0] * sums[1])


def _waves(inertia: Decimal, tension: Decimal, square: Decimal) -> tuple[Decimal, Decimal]:
    """Return x and X."""
    middle = 4 * tension + (1 - 4 * inertia) * square
    root = (middle * middle + 64 * square).sqrt()
    x = 2 * square / (root + middle) if middle > 0 else (root - middle) / 32
    return x, square / (16 * x)


def _stiffness(x: Decimal, evanescent: Decimal, turn: Decimal, growth: Decimal) -> _Stiffness:
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


def joined(planes: list[AdmittedStates], row: RodRow) -> tuple[int, Decimal]:
    """Return the count and the determinant of two blocks with a row of rods between them.

    Coordinates are y and θ where the left block ends, y and -θ where the right one does: equal in symmetric
    motion, opposite in antisymmetric.

    Examples
    --------
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
