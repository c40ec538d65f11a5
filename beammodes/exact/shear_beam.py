"""The uniform beam with shear and rotary inertia, in its own units and long decimals: counted roots, shapes.

With s = EI/(κGA L²) and r² = ρI/(ρA L²), deflection y, rotation θ of the section, moment M and shear force V,

    y' = θ + s V,    θ' = M,    M' = -V - r² w θ,    V' = -w y,        w = ω².

Its waves e^(±√μ x) have  μ² + (s + r²) w μ - w (1 - s r² w) = 0.  One μ is negative at all frequencies; the
other is positive up to the cut-off, s r² w = 1, and negative beyond it, where a second branch begins.
cosh √μx and sinh √μx / √μ are smooth in μ through zero, so the cut-off is no special case.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import NamedTuple

from beammodes.exact.beam_stiffness import inertia_and_determinant, pinned_count
from beammodes.exact.count_roots import Sample, ordered_roots
from beammodes.exact.long_decimals import cosine_and_sine
from beammodes.exact.unit_beam import UnitBeam, UnitEnd

__all__ = ["ShearBeam", "ShearWaves", "shear_squares", "shear_waves"]

Row = list[Decimal]
_HALF = Decimal("0.5")
# A place where a pole is met exactly is moved by less than any digit that is kept.
_NEXT_TO_NONE = Decimal("1e-1000")
# Of w, in the difference that stands for a derivative: its square and reciprocal both leave 30 digits.
_STEP = Decimal("1e-20")


class State(NamedTuple):
    """Deflection, rotation, moment and shear force at one place."""

    deflection: Decimal
    rotation: Decimal
    moment: Decimal
    shear: Decimal


@dataclass(frozen=True)
class ShearBeam:
    """A uniform beam of unit length, stiffness and mass with shear flexibility s = `shear`, and its ends.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.ends import Boundary
    >>> unit = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"), 0.0, 0.01)
    >>> beam = ShearBeam(unit, Decimal("0.03"))
    >>> [beam.sample(Decimal(w)).below for w in (60, 80, 3400)]          # the cut-off is at 1/(s r²) = 3333
    [0, 1, 4]
    """

    unit: UnitBeam
    shear: Decimal

    def digits(self, square: Decimal) -> int:
        """Return how many digits keep the determinant at w = `square` safe from cancellation."""
        growth = max(self.exponents(square)[0], Decimal(0)).sqrt()
        spread = abs(self.shear.adjusted()) if self.shear else 0
        return self.unit.digits(square) + 2 * spread + int(growth)

    def exponents(self, square: Decimal) -> tuple[Decimal, Decimal]:
        """Return both μ, the larger one first."""
        s, r = self.shear, self.unit.gyration
        middle = ((square * (s - r) / 2) ** 2 + square).sqrt()
        low = -square * (s + r) / 2 - middle
        # Their product; the sum would cancel near the cut-off.
        return -square * (1 - s * r * square) / low, low

    def sample(self, square: Decimal) -> Sample:
        """Count the squared frequencies below w = `square` > 0 and evaluate their determinant there.

        The pinned beam's roots are known: wavenumbers n π on the first branch from n = 1, on the second from
        n = 0. Clamping, then releasing what the ends leave free, changes the count by the signs of the
        stiffness of what is held (Wittrick and Williams, Quarterly Journal of Mechanics and Applied
        Mathematics 24, 1971).
        """
        with localcontext() as context:
            context.prec = self.digits(square)
            high, low = self.exponents(square)
            second = 1 + pinned_count((-high).sqrt()) if high < 0 else 0
            even, odd, poles = self._halves(square, high, low)
            clamped = pinned_count((-low).sqrt()) + second - sum(block[2] < 0 for block in (even, odd))
            matrix = _ends_of(even, odd)
            ends = (self.unit.left, self.unit.right)
            for i, end, side in ((0, ends[0], 1), (2, ends[1], -1)):
                deflection, coupled, turning = end.impedance(square)
                matrix[i][i] += deflection
                matrix[i + 1][i + 1] += turning
                matrix[i][i + 1] += side * coupled
                matrix[i + 1][i] += side * coupled
            held = (*ends[0].holds, *ends[1].holds)
            released, determinant = inertia_and_determinant(matrix, [i for i in range(4) if not held[i]])
            return Sample(square, clamped + released, determinant * poles)

    def _halves(self, square: Decimal, high: Decimal, low: Decimal) -> tuple[Row, Row, Decimal]:
        """Return K_yy, K_yθ, K_θθ of symmetric and of antisymmetric motions, and the clamped determinant."""
        (c1, s1), (c2, s2) = _entire(high, _HALF), _entire(low, _HALF)
        turn1, turn2 = high + self.shear * square, low + self.shear * square
        apart = high - low
        even = turn2 * c1 * s2 - turn1 * c2 * s1 or _NEXT_TO_NONE
        odd = high * s1 * turn2 * c2 - low * s2 * turn1 * c1 or _NEXT_TO_NONE
        symmetric = [
            square * apart * s1 * s2 / even,
            square * (s1 * c2 - s2 * c1) / even,
            -apart * c1 * c2 / even,
        ]
        antisymmetric = [
            square * apart * c1 * c2 / odd,
            square * (c1 * low * s2 - c2 * high * s1) / odd,
            -high * low * apart * s1 * s2 / odd,
        ]
        return symmetric, antisymmetric, even * odd

    def states(self, square: Decimal, place: Decimal) -> list[State]:
        """Return the four waves' states at x = ½ + `place`: two symmetric ones, two antisymmetric ones."""
        even, odd = [], []
        for exponent in self.exponents(square):
            cosh, sinh = _entire(exponent, place)
            turn = exponent + self.shear * square
            even.append(State(cosh, turn * sinh, turn * cosh, -square * sinh))
            odd.append(State(exponent * sinh, turn * cosh, turn * exponent * sinh, -square * cosh))
        return even + odd


@dataclass(frozen=True)
class ShearWaves:
    """One mode: a beam, its w, and how much of each of the four waves makes its shape of unit modal mass."""

    beam: ShearBeam
    square: Decimal
    share: tuple[Decimal, ...]

    def state(self, x: Decimal) -> State:
        """Return deflection, rotation, moment and shear force at x in 0..1, in the context's digits."""
        return _mixed(self.share, self.beam.states(self.square, x - _HALF))

    @property
    def digits(self) -> int:
        """Digits with which `state` is right far beyond a double's last place."""
        return 40 + self.beam.digits(self.square) // 2


def shear_squares(beam: ShearBeam, rigid: int, count: int) -> list[Decimal]:
    """Return the first `count` positive w = ω², every one of them, a double one twice."""
    # Shear and rotary inertia lower all frequencies: the clamped beam without them bounds from above.
    high = beam.sample((Decimal("3.15") * (rigid + count + 3)) ** 4)
    low, decades = high, 1
    while low.below > rigid:
        low = beam.sample(high.place.scaleb(-decades))
        decades *= 2
    return ordered_roots(beam.sample, low, high, count)


def shear_waves(beam: ShearBeam, squares: list[Decimal]) -> list[ShearWaves]:
    """Return the shapes of unit modal mass at squared frequencies that are roots, double ones orthogonal."""
    shapes: list[ShearWaves] = []
    for i, square in enumerate(squares):
        with localcontext() as context:
            context.prec = beam.digits(square) + 60
            twin = i > 0 and abs(square - squares[i - 1]) < Decimal("1e-20") * square
            double = twin or (i + 1 < len(squares) and squares[i + 1] - square < Decimal("1e-20") * square)
            vectors = _null_vectors(_end_rows(beam, square), 2 if double else 1)
            vector = vectors[-1 if twin else 0]
            if twin:
                first = shapes[-1].share
                part = _modal_product(beam, square, first, vector)
                vector = [v - part * f for v, f in zip(vector, first, strict=True)]
            unit = _modal_product(beam, square, vector, vector).sqrt()
            upright = _sign(beam, square, vector) / unit
            shapes.append(ShearWaves(beam, square, tuple(v * upright for v in vector)))
    return shapes


def _entire(exponent: Decimal, x: Decimal) -> tuple[Decimal, Decimal]:
    """Return cosh √μ x and sinh √μ x / √μ, cos and sin for negative μ."""
    if not exponent:
        return Decimal(1), x
    wave = abs(exponent).sqrt()
    if exponent < 0:
        cosine, sine = cosine_and_sine(wave * x)
        return cosine, sine / wave
    grown = (wave * x).exp()
    return (grown + 1 / grown) / 2, (grown - 1 / grown) / (2 * wave)


def _ends_of(even: Row, odd: Row) -> list[Row]:
    """Return the forces for unit end motions y(0), θ(0), y(1), θ(1), of the two halves' stiffness."""
    (a, b, d), (e, f, h) = even, odd
    # Mirrored, y stays and θ changes its sign.
    near = [(a + e) / 2, (b + f) / 2, (d + h) / 2]
    far = [(a - e) / 2, (b - f) / 2, (d - h) / 2]
    return [
        [near[0], -near[1], far[0], far[1]],
        [-near[1], near[2], -far[1], -far[2]],
        [far[0], -far[1], near[0], near[1]],
        [far[1], -far[2], near[1], near[2]],
    ]


def _end_rows(beam: ShearBeam, square: Decimal) -> list[Row]:
    """Return the two conditions of both ends on the four waves."""
    rows = []
    for end, place, side in ((beam.unit.left, -_HALF, 1), (beam.unit.right, _HALF, -1)):
        states = beam.states(square, place)
        rows += [_condition(end, [_inward(state, side) for state in states], square, i) for i in (0, 1)]
    return rows


def _inward(state: State, side: int) -> State:
    return State(state.deflection, side * state.rotation, state.moment, side * state.shear)


def _condition(end: UnitEnd, states: list[State], square: Decimal, quantity: int) -> Row:
    if end.holds[quantity]:
        return [state[quantity] for state in states]
    deflection, coupled, turning = end.impedance(square)
    if quantity == 0:
        return [deflection * y + coupled * theta - shear for y, theta, _, shear in states]
    return [coupled * y + turning * theta - moment for y, theta, moment, _ in states]


def _null_vectors(rows: list[Row], many: int) -> list[Row]:
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
            for k in range(step, 4):
                row[k] -= factor * rows[step][k]
    found = []
    for free in range(rank, 4):
        solution = [Decimal(int(k == free)) for k in range(4)]
        for step in reversed(range(rank)):
            known = sum((rows[step][k] * solution[k] for k in range(step + 1, 4)), Decimal(0))
            solution[step] = -known / rows[step][step]
        found.append([solution[order.index(k)] for k in range(4)])
    return found


def _mixed(share: Row | tuple[Decimal, ...], states: list[State]) -> State:
    return State(
        *(
            sum((c * value for c, value in zip(share, part, strict=True)), Decimal(0))
            for part in zip(*states, strict=True)
        )
    )


def _modal_product(
    beam: ShearBeam, square: Decimal, first: Row | tuple[Decimal, ...], second: Row | tuple[Decimal, ...]
) -> Decimal:
    """Return ∫ y₁y₂ + r² θ₁θ₂ dx and the bodies' share.

    The integrand is the derivative of  ẏ₁ V₂ - y₂ V̇₁ + θ̇₁ M₂ - θ₂ Ṁ₁,  a dot standing for d/dw.
    """
    total = Decimal(0)
    for end, place, side in ((beam.unit.left, -_HALF, -1), (beam.unit.right, _HALF, 1)):
        one, two = (_mixed(share, beam.states(square, place)) for share in (first, second))
        step = square * _STEP
        above, below = (_mixed(first, beam.states(square + s, place)) for s in (step, -step))
        y, theta, moment, shear = ((a - b) / (2 * step) for a, b in zip(above, below, strict=True))
        total += side * (y * two.shear - two.deflection * shear + theta * two.moment - two.rotation * moment)
        arm = side * end.offset
        total += end.mass * (one.deflection + arm * one.rotation) * (two.deflection + arm * two.rotation)
        total += end.inertia * one.rotation * two.rotation
    return total


def _sign(beam: ShearBeam, square: Decimal, share: Row) -> int:
    """Return the sign that makes the first of y, θ, M and V that is not zero positive at x = 0."""
    start = _mixed(share, beam.states(square, -_HALF))
    middle = _mixed(share, beam.states(square, Decimal(0)))
    for value, elsewhere in zip(start, middle, strict=True):
        if abs(value) > Decimal("1e-15") * (abs(elsewhere) + abs(value)) and value:
            return 1 if value > 0 else -1
    return 1
