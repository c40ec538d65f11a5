"""The uniform beam with bending, shear, rotary inertia, axial force and any ends: counted roots and shapes.

In the beam's own units, with w = ω², t = T L²/EI - ρI/(ρA L²) w and s = EI/(κGA L²), deflection y, rotation θ
of the section, moment M and force V across the undeformed axis obey

    y' = θ + s V,    θ' = M,    M' = t θ - V,    V' = -w y.

Waves e^(±√μ x) have  μ² + (s w - t) μ - w (1 + s t) = 0.  The low μ is negative at all frequencies; the
high one is positive up to the cut-off, 1 + s t = 0, and negative beyond it, where shear has a second branch
of modes. With  g = -(low + s w) > 0,  high = t + g  and  high + s w = w/g.

Soft springs, heavy bodies and near-double roots cost a determinant in doubles up to all its digits:
frequencies of ordinary beams err by 1e-12 at times, those of soft or heavy ends by 1e-9 and more. In decimals
long enough for the numbers at hand the plain formulas are right everywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import NamedTuple

from beammodes.numerics.counted_roots import ROOT_DIGITS, Sample, inertia_and_determinant, ordered_roots
from beammodes.numerics.long_decimals import as_decimal, cosine_and_sine, decay, pi
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End

__all__ = ["BeamMode", "BeamState", "UnitBeam", "UnitEnd"]

_HALF, _ONE, _NONE = Decimal("0.5"), Decimal(1), Decimal(0)
# Roots of a freed beam are poles of its stiffness: there cancellation takes twice the digits of a root.
_GUARDED = 3 * ROOT_DIGITS + 4
# Stands for a pole met exactly: less than any digit that is kept.
_TINY = Decimal("1e-1000")
# Of w, in the difference that stands for a derivative: it leaves 30 digits, and its reciprocal more.
_STEP = Decimal("1e-30")
# Squared frequencies closer than this, relatively, are one double root.
_SAME = Decimal("1e-20")
# Compressions beyond the clamped beam's critical load, 4 π² = 39.478..., which no supports exceed.
ABOVE_CRITICAL = Decimal("39.5")


class UnitEnd(NamedTuple):
    """Supports and moving body of one end over EI/L³, EI/L, ρA L, ρA L³ and L; springs that hold are 0.

    Rotations are θ with x running inward from this end: the body's centre of mass deflects by y - a θ, and
    what the supports hold is the deflection y - R θ of a hub's axis, where R is the `reach`.
    """

    holds: tuple[bool, bool]
    translational: Decimal
    rotational: Decimal
    mass: Decimal
    inertia: Decimal
    offset: Decimal
    reach: Decimal = _NONE

    @classmethod
    def of(cls, end: End, units: tuple[Decimal, ...]) -> UnitEnd:
        """Return an end over the five units above."""
        holds = (end.holds_deflection, end.holds_rotation)
        springs = (end.translational_stiffness, end.rotational_stiffness)
        moved = (0.0 if held else spring for held, spring in zip(holds, springs, strict=True))
        numbers, of = (*moved, *end.moving_body, end.hub_radius), (*units, units[-1])
        return cls(holds, *(as_decimal(n) / unit for n, unit in zip(numbers, of, strict=True)))

    def impedance(self, square: Decimal, tension: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Return the yy, yθ and θθ entries of K - ω² M, in the deflection of the axis and the rotation."""
        arm = self.offset - self.reach
        coupled = square * self.mass * arm
        turning = self.rotational - square * self.inertia - coupled * arm + tension * self.reach
        return self.translational - square * self.mass, coupled, turning


class BeamState(NamedTuple):
    """Deflection, rotation, moment and force at one place of the beam."""

    deflection: Decimal
    rotation: Decimal
    moment: Decimal
    force: Decimal


class _Waves(NamedTuple):
    """Both exponents μ, √|high|, √-low, g, and high/w, which stays finite where w is zero."""

    high: Decimal
    low: Decimal
    p: Decimal
    q: Decimal
    g: Decimal
    ratio: Decimal


@dataclass(frozen=True)
class UnitBeam:
    """A beam of unit length, bending stiffness and mass, with its ends; `of` makes it.

    Parameters
    ----------
    tension : Decimal
        T L²/EI.
    gyration : Decimal
        ρI/(ρA L²).
    left, right : UnitEnd
        The ends at 0 and at 1.
    shear : Decimal
        s = EI/(κGA L²); 0 leaves shear out.

    Examples
    --------
    >>> beam = UnitBeam.of(Beam.unit(), Boundary.of("clamped-free"))
    >>> [beam.sample(Decimal(w)).below for w in (12, 13, 500)]
    [0, 1, 2]
    """

    tension: Decimal
    gyration: Decimal
    left: UnitEnd
    right: UnitEnd
    shear: Decimal = _NONE

    @classmethod
    def of(
        cls,
        beam: Beam,
        boundary: Boundary,
        axial_force: float | Fraction = 0.0,
        inertia: float = 0.0,
        shear_stiffness: float = float("inf"),
    ) -> UnitBeam:
        """Return a uniform beam in its own units, every number right far beyond a double's last place."""
        with localcontext() as context:
            context.prec = 2 * _GUARDED
            length, stiffness = Decimal(beam.length), Decimal(beam.mean_bending_stiffness)
            mass = Decimal(beam.mean_mass_per_length) * length
            units = (stiffness / length**3, stiffness / length, mass, mass * length**2, length)
            return cls(
                as_decimal(axial_force) * length**2 / stiffness,
                as_decimal(inertia) / (mass * length),
                UnitEnd.of(boundary.left, units),
                UnitEnd.of(boundary.right, units),
                stiffness / length**2 / Decimal(shear_stiffness),
            )

    @property
    def spread(self) -> int:
        """The decades by which all numbers together depart from one."""
        numbers = (self.tension, self.gyration, self.shear, self.shear, *self.left[1:], *self.right[1:])
        return sum(abs(number.adjusted()) for number in numbers if number)

    @property
    def has_hub(self) -> bool:
        """True where the axis of an end lies off it."""
        return bool(self.left.reach or self.right.reach)

    @property
    def translation_is_free(self) -> bool:
        """True where nothing resists a deflection that is the same everywhere."""
        return not any(end.holds[0] or end.translational for end in (self.left, self.right))

    def digits(self, place: Decimal) -> int:
        """Return how many digits keep the determinant at w or a compression safe from cancellation."""
        return _GUARDED + self.spread + 2 * abs(place.adjusted())

    def square_at(self, wave: Decimal) -> Decimal:
        """Return w of the wavenumber √-low = `wave` without shear, which lowers it."""
        return wave**2 * (wave**2 + self.tension) / (1 + self.gyration * wave**2)

    def exponents(self, square: Decimal, tension: Decimal | None = None) -> _Waves:
        """Return both exponents at w = `square`; nothing cancels but 1 + s t next to the cut-off."""
        s, t = self.shear, (self.tension if tension is None else tension) - self.gyration * square
        half = (t + s * square) / 2
        middle = (half * half + square).sqrt()
        g = square / (middle + half) if half > 0 else middle - half
        low = -(g + s * square)
        ratio = -(1 + s * t) / low
        high = square * ratio
        return _Waves(high, low, abs(high).sqrt(), (-low).sqrt(), g, ratio)

    def sample(self, square: Decimal) -> Sample:
        """Count the squared frequencies below w = `square` > 0 and evaluate their determinant there.

        Examples
        --------
        >>> free = UnitBeam.of(Beam.unit(), Boundary.of("free-free"))
        >>> free.sample(Decimal(500)).below  # two rigid-body modes, and 22.373² = 500.56 is next
        2
        """
        with localcontext() as context:
            context.prec = self.digits(square)
            held = (*self.left.holds, *self.right.holds)
            return Sample(square, *self._counted(square, self.tension, self.exponents(square), held))

    def static_sample(self, compression: Decimal) -> Sample:
        """Count the buckling loads below `compression` > 0 and evaluate their determinant there.

        A translation that is free feels no compression and is held at x = 0.

        Examples
        --------
        >>> pinned = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
        >>> [pinned.static_sample(Decimal(load)).below for load in (9, 10)]
        [0, 1]
        """
        with localcontext() as context:
            context.prec = self.digits(compression)
            first, *others = (*self.left.holds, *self.right.holds)
            held = (first or self.translation_is_free, *others)
            waves = self.exponents(_NONE, -compression)
            return Sample(compression, *self._counted(_NONE, -compression, waves, held))

    def _counted(
        self, square: Decimal, tension: Decimal, waves: _Waves, held: tuple[bool, ...]
    ) -> tuple[int, Decimal]:
        """Count from the pinned beam to the clamped one and on to this one.

        The pinned beam's roots are known: wavenumbers n π on the first branch from n = 1, on the second from
        n = 0. Clamping, then releasing what the ends leave free, changes the count by the signs of the
        stiffness of what is held (Wittrick and Williams, Quarterly Journal of Mechanics and Applied
        Mathematics 24, 1971).
        """
        even, odd, poles = self._halves(square, waves)
        second = 1 + _pinned_count(waves.p) if waves.high < 0 else 0
        clamped = _pinned_count(waves.q) + second - (even[2] < 0) - (odd[2] < 0)
        # Mirrored, y stays and θ changes its sign.
        (a, b, c), (d, e, f) = (
            [(x + sign * y) / 2 for x, y in zip(even, odd, strict=True)] for sign in (1, -1)
        )
        matrix = [[a, -b, d, e], [-b, c, -e, -f], [d, -e, a, b], [e, -f, b, c]]
        for i, end, side in ((0, self.left, 1), (2, self.right, -1)):
            if end.reach:
                # Of the axis, y - R θ, in the place of the end's deflection.
                for row in matrix:
                    row[i + 1] += side * end.reach * row[i]
                matrix[i + 1] = [
                    b + side * end.reach * a for a, b in zip(matrix[i], matrix[i + 1], strict=True)
                ]
            deflection, coupled, turning = end.impedance(square, tension)
            matrix[i][i] += deflection
            matrix[i + 1][i + 1] += turning
            matrix[i][i + 1] += side * coupled
            matrix[i + 1][i] += side * coupled
        kept = [i for i in range(4) if not held[i]]
        released, determinant = inertia_and_determinant([[matrix[i][j] for j in kept] for i in kept])
        return clamped + released, determinant * poles

    def _halves(self, square: Decimal, waves: _Waves) -> tuple[list[Decimal], list[Decimal], Decimal]:
        """Return K_yy, K_yθ, K_θθ of symmetric and of antisymmetric motions, and the clamped determinant."""
        high, low, p, q, g, ratio = waves
        c1, s1 = _growing(p, _HALF, scaled=True) if high > 0 else _turning(p, _HALF)
        c2, s2 = _turning(q, _HALF)
        apart = high - low
        even = g * c1 * s2 + square / g * c2 * s1 or _TINY
        odd = ratio * g * s1 * c2 + low / g * s2 * c1 or _TINY
        common, other = apart / even, apart / odd
        symmetric = [-square * common * s1 * s2, square * (s2 * c1 - s1 * c2) / even, common * c1 * c2]
        turned = (c2 * high * s1 - c1 * low * s2) / odd
        return symmetric, [-other * c1 * c2, turned, ratio * low * other * s1 * s2], even * odd

    def lowest(self, rigid: int, count: int) -> list[Decimal] | None:
        """Return the first `count` positive w, a double one twice; None if the beam buckles.

        Examples
        --------
        >>> beam = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
        >>> [round(float(square), 4) for square in beam.lowest(0, 2)]
        [97.4091, 1558.5455]
        """
        if self.tension < -ABOVE_CRITICAL:
            return None
        # The clamped beam has at most two roots less below a place than the pinned one, whose roots are n π.
        high = self.sample(self.square_at(Decimal("3.15") * (rigid + count + 3)))
        low, decades = high, 1
        while low.below > rigid:
            if decades > 64 + 4 * self.spread:
                return None
            low = self.sample(high.place.scaleb(-decades))
            decades *= 2
        return ordered_roots(self.sample, low, high, count)

    def root(self, number: int, near: Decimal) -> Decimal | None:
        """Return the positive w of one number, rigid-body modes included; None if the beam buckles.

        The search starts at w = `near`.

        Examples
        --------
        >>> beam = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
        >>> round(float(beam.root(2, Decimal(1500))), 4)
        1558.5455
        """
        if self.tension < 0 and self.static_sample(-self.tension).below:
            return None
        apart = Decimal("0.001")
        low = high = self.sample(near)
        while low.below >= number:
            low = self.sample(near / (1 + apart))
            apart *= 4
        while high.below < number:
            high = self.sample(near * (1 + apart))
            apart *= 4
        return ordered_roots(self.sample, low, high, number - low.below)[-1]

    def critical_compression(self) -> Decimal:
        """Return the smallest compression at which the beam buckles, something resisting its turning."""
        high = low = self.static_sample(ABOVE_CRITICAL)
        decades = 1
        while low.below:
            low = self.static_sample(ABOVE_CRITICAL.scaleb(-decades))
            decades *= 2
        return ordered_roots(self.static_sample, low, high, 1)[0]

    def modes(self, squares: list[Decimal]) -> list[BeamMode]:
        """Return the modes of unit modal mass at squared frequencies that are roots."""
        found: list[BeamMode] = []
        for i, square in enumerate(squares):
            with localcontext() as context:
                context.prec = self.digits(square) + 20
                twin = i > 0 and square - squares[i - 1] < _SAME * square
                double = twin or (i + 1 < len(squares) and squares[i + 1] - square < _SAME * square)
                decaying = not self.shear or self.exponents(square).high > 1
                ends = [self.waves(square, place, decaying) for place in (_NONE, _ONE)]
                share = _null_vectors(self._conditions(square, ends), 2 if double else 1)[int(twin)]
                product = self._modal_product(square, ends, decaying)
                if twin:
                    part = product(found[-1].share, share)
                    share = [v - part * f for v, f in zip(share, found[-1].share, strict=True)]
                first = self.left.holds[0] * (1 + self.left.holds[1])
                start = mixed(share, ends[0])[first]
                unit = product(share, share).sqrt().copy_sign(start)
                found.append(BeamMode(self, square, decaying, [v / unit for v in share], ends))
        return found

    def waves(self, square: Decimal, x: Decimal, decaying: bool) -> list[BeamState]:
        """Return the states at x of four waves: two of the high exponent, two of the low one.

        The high ones decay from either end or, where that would make them alike, are cosh and sinh.
        """
        high, low, p, q, g, ratio = self.exponents(square)
        turn = square / g
        if decaying:
            sizes = ((-1, decay(p * x)), (1, decay(p * (1 - x))))
            waves = [BeamState(y, side * turn / p * y, turn * y, -side * square / p * y) for side, y in sizes]
        else:
            c, s = _growing(p, x) if high > 0 else _turning(p, x)
            waves = [
                BeamState(c, turn * s, turn * c, -square * s),
                BeamState(ratio * s, c / g, high * s / g, -c),
            ]
        c, s = _turning(q, x)
        return [
            *waves,
            BeamState(c, -g * s, -g * c, -square * s),
            BeamState(low * s, -g * c, -g * low * s, -square * c),
        ]

    def _conditions(self, square: Decimal, ends: list[list[BeamState]]) -> list[list[Decimal]]:
        """Return the two conditions of both ends on the four waves, whose states there are given."""
        rows = []
        for end, waves, side in ((self.left, ends[0], 1), (self.right, ends[1], -1)):
            deflection, coupled, turning = end.impedance(square, self.tension)
            about = [(y, side * theta, moment, side * force) for y, theta, moment, force in waves]
            r = end.reach
            inward = [(y - r * theta, theta, moment + r * force, force) for y, theta, moment, force in about]
            released = (
                [deflection * y + coupled * theta - force for y, theta, _, force in inward],
                [coupled * y + turning * theta - moment for y, theta, moment, _ in inward],
            )
            rows += [[state[i] for state in inward] if end.holds[i] else released[i] for i in (0, 1)]
        return rows

    def _modal_product(self, square: Decimal, ends: list[list[BeamState]], decaying: bool) -> _Product:
        """Return the modal mass of two motions, each given by its share of the waves.

        Of the beam it is ∫ y₁y₂ + r² θ₁θ₂ dx, whose integrand is the derivative of
        ẏ₁ V₂ - y₂ V̇₁ + θ̇₁ M₂ - θ₂ Ṁ₁, a dot standing for d/dw.
        """
        step = square * _STEP
        rates = [
            [
                BeamState(*((b - a) / step for a, b in zip(*pair, strict=True)))
                for pair in zip(waves, self.waves(square + step, place, decaying), strict=True)
            ]
            for place, waves in zip((_NONE, _ONE), ends, strict=True)
        ]

        def product(first: list[Decimal], second: list[Decimal]) -> Decimal:
            total = _NONE
            for end, waves, rate, side in zip((self.left, self.right), ends, rates, (-1, 1), strict=True):
                one, two, change = mixed(first, waves), mixed(second, waves), mixed(first, rate)
                total += side * (change.deflection * two.force - two.deflection * change.force)
                total += side * (change.rotation * two.moment - two.rotation * change.moment)
                arm = side * end.offset
                total += (
                    end.mass * (one.deflection + arm * one.rotation) * (two.deflection + arm * two.rotation)
                )
                total += end.inertia * one.rotation * two.rotation
            return total

        return product


_Product = Callable[[list[Decimal], list[Decimal]], Decimal]


@dataclass(frozen=True)
class BeamMode:
    """A mode of unit modal mass: its share of each of the four waves, and their states at both `ends`."""

    beam: UnitBeam
    square: Decimal
    decaying: bool
    share: list[Decimal]
    ends: list[list[BeamState]]

    @property
    def digits(self) -> int:
        """Digits with which `at` is right far beyond a double's last place."""
        return 40 + self.beam.digits(self.square) // 2

    def at(self, x: Decimal) -> BeamState:
        """Return the state at x in 0..1, in the context's digits."""
        return mixed(self.share, self.beam.waves(self.square, x, self.decaying))


def mixed(share: list[Decimal], waves: list[BeamState]) -> BeamState:
    """Return the state of a sum of waves."""
    columns = zip(*waves, strict=True)
    return BeamState(*(sum((c * v for c, v in zip(share, part, strict=True)), _NONE) for part in columns))


def _pinned_count(wave: Decimal) -> int:
    """Return how many multiples of π lie above zero and below `wave`."""
    return max(0, int((wave / pi()).to_integral_value("ROUND_CEILING")) - 1)


def _turning(wave: Decimal, x: Decimal) -> tuple[Decimal, Decimal]:
    """Return cos qx and sin qx / q."""
    if not wave or not x:
        return _ONE, x
    cosine, sine = cosine_and_sine(wave * x)
    return cosine, sine / wave


def _growing(wave: Decimal, x: Decimal, *, scaled: bool = False) -> tuple[Decimal, Decimal]:
    """Return cosh px and sinh px / p; if scaled, times e^(-px)."""
    faded = decay(2 * wave * x)
    even, odd = (1 + faded) / 2, (1 - faded) / (2 * wave)
    return (even, odd) if scaled else (even / faded.sqrt(), odd / faded.sqrt())


def _null_vectors(rows: list[list[Decimal]], many: int) -> list[list[Decimal]]:
    """Return so many vectors that four rows annihilate, by elimination with complete pivoting."""
    rows = [[value / max(map(abs, row)) for value in row] for row in rows]
    order, rank = list(range(4)), 4 - many
    for step in range(rank):
        places = ((i, j) for i in range(step, 4) for j in range(step, 4))
        i, j = max(places, key=lambda at: abs(rows[at[0]][at[1]]))
        rows[step], rows[i] = rows[i], rows[step]
        order[step], order[j] = order[j], order[step]
        for row in rows:
            row[step], row[j] = row[j], row[step]
        for row in rows[step + 1 :]:
            factor = row[step] / rows[step][step]
            row[step:] = [v - factor * top for v, top in zip(row[step:], rows[step][step:], strict=True)]
    found = []
    for free in range(rank, 4):
        solution = [Decimal(k == free) for k in range(4)]
        for step in reversed(range(rank)):
            known = sum((rows[step][k] * solution[k] for k in range(step + 1, 4)), _NONE)
            solution[step] = -known / rows[step][step]
        found.append([solution[order.index(k)] for k in range(4)])
    return found
