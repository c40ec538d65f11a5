"""Timoshenko's beam, with shear and rotary inertia, and how far Euler and Bernoulli's theory is from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import positive_real, row_shown, shown, whole_number
from beammodes.exact.spectral_beam import AGREEMENT, disagreement, growing_grids, modes_of
from beammodes.exact.spectral_energy import (
    Tension,
    body_rows,
    compressed,
    in_plane,
    motions_between,
    of_unit_energy,
    square_spin,
    straight_load,
    tension_of,
    with_tension,
)
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values
from beammodes.exact.unit_beam import UnitBeam, UnitEnd, inertia_and_determinant, pinned_count
from beammodes.numerics.arrays import Floats
from beammodes.numerics.count_roots import Sample, ordered_roots
from beammodes.numerics.long_decimals import LONG, cosine_and_sine
from beammodes.problem.beam import Beam, PropertyLike, kept_property, positions_on
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.profiles import Profile, profile_parts, scaled, value_at

__all__ = [
    "SHEAR_RATIO",
    "ShearBeam",
    "ShearWaves",
    "SpectralShear",
    "TimoshenkoModes",
    "shear_squares",
    "shear_waves",
    "spectral_shear",
    "theory_error_of",
    "theory_facts",
    "timoshenko",
]


# The uniform beam with shear and rotary inertia, in its own units and long decimals: counted roots, shapes.
#
# With s = EI/(κGA L²) and r² = ρI/(ρA L²), deflection y, rotation θ of the section, moment M and shear
# force V,
#
#     y' = θ + s V,    θ' = M,    M' = -V - r² w θ,    V' = -w y,        w = ω².
#
# Its waves e^(±√μ x) have  μ² + (s + r²) w μ - w (1 - s r² w) = 0.  One μ is negative at all frequencies; the
# other is positive up to the cut-off, s r² w = 1, and negative beyond it, where a second branch begins.
# cosh √μx and sinh √μx / √μ are smooth in μ through zero, so the cut-off is no special case.

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


#: E/(κG) of a rectangular section, κ = 5/6 and Poisson's ratio 0.3: 2.6/0.8333. An I-beam's is larger.
SHEAR_RATIO = 2 * (1 + 0.3) / (5 / 6)


MOST_MODES = 100


class _Shapes(Protocol):
    def values(self, x: Floats) -> tuple[Floats, Floats, Floats, Floats]: ...


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TimoshenkoModes:
    """The first elastic modes of Timoshenko's beam; `timoshenko` makes it.

    Mode shapes have unit modal mass,

        ∫ ρA φₘ φₙ + ρI ψₘ ψₙ dx + Σ m (φ ± a ψ)ₘ (φ ± a ψ)ₙ + J ψₘ ψₙ = 1 if m = n, else 0,

    φ being the deflection and ψ the rotation of the section, and the sign that makes the first of φ, ψ, ψ'
    that the left end does not hold positive at x = 0.

    Attributes
    ----------
    beam : Beam
        With the shear stiffness and the rotary inertia that were taken.
    boundary : Boundary
        Its ends, at x = 0 and at x = L.
    load : Load
        What loads it.
    angular_frequency : ndarray, shape (modes,) [rad/s]
        ω of elastic modes 1, 2, ..., of both branches, in order, read-only.
    rigid_body_modes : int
        How many modes of zero frequency come before them: 0, 1 or 2.

    Examples
    --------
    >>> modes = timoshenko(Beam(1.0, 1.0, 1.0, 0.01, shear_stiffness=33.0), "pinned-pinned", 2)
    >>> modes.shape([0.25, 0.5]).round(4) + 0.0, modes.rotation(0.0).round(4)
    (array([[0.9711, 1.3733],
           [1.3491, 0.    ]]), array([3.3768, 4.2405]))
    """

    beam: Beam
    boundary: Boundary
    load: Load
    angular_frequency: Floats
    rigid_body_modes: int
    _shapes: _Shapes

    @property
    def frequency(self) -> Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    @property
    def cutoff_angular_frequency(self) -> float:
        """√(κGA/ρI) [rad/s], least along the beam: beyond it modes of shear lie amid the others."""
        return _cutoff(self.beam)

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes' deflections φ, or their slopes φ' = ψ + γ.

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L.
        derivative : int
            0 or 1: deflection or slope, which differs from `rotation` by the shear strain.

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-derivative)]

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not 0 or 1.
        """
        order = whole_number("derivative", derivative, least=0, most=1)
        deflection, rotation, _, strain = self._values(x)
        return (rotation + strain) / self.beam.length if order else deflection

    def slope(self, x: ArrayLike) -> Floats:
        """Return dφ/dx, shape (modes, *x.shape) [kg^(-1/2) m^(-1)]: `shape(x, derivative=1)`."""
        return self.shape(x, derivative=1)

    def rotation(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes' rotations ψ of the section, or its curvature ψ' = M/EI.

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L; at a step of EI curvature is that on its right.
        derivative : int
            0 or 1.

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-1 - derivative)]

        Raises
        ------
        TypeError, ValueError
            As `shape`.
        """
        order = whole_number("derivative", derivative, least=0, most=1)
        _, rotation, curvature, _ = self._values(x)
        return (curvature if order else rotation) / self.beam.length ** (1 + order)

    def _values(self, x: ArrayLike) -> tuple[Floats, ...]:
        position = positions_on(self.beam, x)
        unit = math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(self.beam.length)
        values = self._shapes.values(position.ravel() / self.beam.length)
        return tuple((value / unit).reshape(len(value), *position.shape) for value in values)

    def __repr__(self) -> str:
        return f"TimoshenkoModes({self.boundary}: {row_shown(self.frequency, '{:.4g}', 'Hz')})"


@dataclass(frozen=True, slots=True)
class _UniformShapes:
    waves: list[ShearWaves]

    def values(self, x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        found = np.empty((4, len(self.waves), len(x)))
        with localcontext(LONG) as context:
            for mode, waves in enumerate(self.waves):
                context.prec = waves.digits
                for i, at in enumerate(x.tolist()):
                    state = waves.state(Decimal(at))
                    strain = waves.beam.shear * state.shear
                    found[:, mode, i] = [float(n) for n in (*state[:3], strain)]
        return found[0], found[1], found[2], found[3]


def timoshenko(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int,
    *,
    load: Load | None = None,
    shear_stiffness: PropertyLike | None = None,
    rotary_inertia_per_length: PropertyLike | None = None,
) -> TimoshenkoModes:
    """Return the first elastic modes of a beam under Timoshenko's theory: bending, shear and rotary inertia.

    (κGA (φ' - ψ))' + ω² ρA φ = 0,    (EI ψ')' + κGA (φ' - ψ) + ω² ρI ψ = 0

    φ is the deflection, ψ the rotation of the section, which ends and bodies hold and follow. Modes come in
    the order of their frequencies; beyond the cut-off √(κGA/ρI) those of a second branch lie among them.

    A uniform beam is solved by its characteristic equation, in decimals as long as the numbers ask for: no
    root is missed or found twice, and each is right to 1e-15, for slenderness L/r from 1 to 10⁶, springs and
    bodies included. One that varies, or is loaded, is solved by polynomials, right to 1e-10.

    Parameters
    ----------
    beam : Beam
    boundary : str, pair of ends or Boundary
        Its ends; the one named first is at x = 0.
    modes : int
        How many elastic modes, 1 to 100.
    load : Load, optional
        One that leaves the beam straight. An axial force T does its work on the deflection's slope, ½ ∫T φ'²
        (Engesser's beam).
    shear_stiffness : float, sequence, Table or function [N], optional
        κGA in place of the beam's own; `math.inf` makes the beam rigid in shear: Rayleigh's.
    rotary_inertia_per_length : float, sequence, Table or function [kg m], optional
        ρI in place of the beam's own, which is ρA r² where only its radius of gyration is known; 0 leaves
        shear alone.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the shear stiffness or the rotary inertia is neither given nor
        known, or a load is one that `euler_bernoulli` refuses.
    ArithmeticError
        If polynomials of growing degree do not agree, as `euler_bernoulli` says.

    References
    ----------
    S. P. Timoshenko, Philosophical Magazine 41 (1921); ten pairs of ends: T. C. Huang, Journal of Applied
    Mechanics 28 (1961); count of roots: Wittrick and Williams, Quarterly Journal of Mechanics and Applied
    Mathematics 24 (1971).

    Examples
    --------
    >>> from beammodes.problem.sections import Rectangle
    >>> stout = Beam.from_section(Rectangle(width=1.0, height=2.0), density=7800.0, elastic_modulus=210e9,
    ...                           poisson_ratio=0.3, length=10.0)
    >>> timoshenko(stout, "clamped-free", 3).frequency.round(3)
    array([ 16.257,  87.555, 208.398])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    pair, pull = Boundary.of(boundary), checked_load(load)
    count = whole_number("modes", modes, most=MOST_MODES)
    full = _completed(beam, shear_stiffness, rotary_inertia_per_length)
    if full.is_uniform and isinstance(full.shear_stiffness, float) and pull.is_axial and not pull.axial_force:
        omega, rigid, shapes = _uniform(full, pair, count)
    else:
        omega, rigid, shapes = spectral_shear(full, pair, count, pull)
    omega = omega * beam.frequency_unit
    omega.flags.writeable = False
    return TimoshenkoModes(full, pair, pull, omega, rigid, shapes)


def _uniform(beam: Beam, pair: Boundary, count: int) -> tuple[Floats, int, _Shapes]:
    # Numbers, as the beam is uniform.
    assert isinstance(beam.shear_stiffness, float)
    assert isinstance(beam.rotary_inertia_per_length, float)
    with localcontext(LONG):
        unit = UnitBeam.of(beam, pair, 0.0, beam.rotary_inertia_per_length)
        stiffness = Decimal(beam.mean_bending_stiffness) / Decimal(beam.length) ** 2
        stout = ShearBeam(unit, stiffness / Decimal(beam.shear_stiffness))
        squares = shear_squares(stout, pair.rigid_body_modes, count)
        omega = np.array([float(square.sqrt()) for square in squares])
        return omega, pair.rigid_body_modes, _UniformShapes(shear_waves(stout, squares))


def theory_error_of(
    beam: Beam,
    pair: Boundary,
    load: Load,
    omega: Floats,
    radius_of_gyration: float | None = None,
    shear_ratio: float | None = None,
) -> Floats | None:
    """Return ω_Timoshenko/ω - 1 of a beam's modes under a theory without shear; None if no section is known.

    NaN from the cut-off frequency on, where n-th modes are not of one kind, beyond mode 100, and on a turning
    hub, where rotary inertia is not solved for.
    """
    shear, rotary = theory_facts(beam, radius_of_gyration, shear_ratio)
    if shear is None or rotary is None:
        return None
    errors, count = np.full(len(omega), np.nan), min(len(omega), MOST_MODES)
    if count and not load.spin_rate:
        stout = timoshenko(
            beam, pair, count, load=load, shear_stiffness=shear, rotary_inertia_per_length=rotary
        )
        found = stout.angular_frequency
        alike = found < stout.cutoff_angular_frequency
        errors[:count][alike] = found[alike] / omega[:count][alike] - 1.0
    return errors


def theory_facts(
    beam: Beam, radius_of_gyration: float | None = None, shear_ratio: float | None = None
) -> tuple[Profile | None, Profile | None]:
    """Return κGA and ρI as far as they are known, given or can be assumed: None if nothing tells them."""
    rotary: Profile | None = None
    radius = beam.radius_of_gyration
    if radius_of_gyration is not None:
        radius = positive_real("radius_of_gyration", radius_of_gyration)
    if beam.has_rotary_inertia:
        rotary = beam.rotary_inertia_per_length
    elif radius is not None:
        rotary = scaled(beam.mass_per_length, radius**2)
    ratio = None if shear_ratio is None else positive_real("shear_ratio", shear_ratio)
    if beam.shear_stiffness is not None and ratio is None and radius_of_gyration is None:
        return beam.shear_stiffness, rotary
    ratio = SHEAR_RATIO if ratio is None else ratio
    if radius is not None:
        return scaled(beam.bending_stiffness, 1.0 / (ratio * radius**2)), rotary
    if rotary is None:
        return None, None
    return _stiffness_of(beam, ratio), rotary


def _stiffness_of(beam: Beam, ratio: float) -> Profile:
    """Return EI / (r² E/(κG)) where r² = ρI/ρA."""
    bending, mass, rotary = beam.bending_stiffness, beam.mass_per_length, beam.rotary_inertia_per_length
    if isinstance(bending, float) and isinstance(mass, float) and isinstance(rotary, float):
        return bending * mass / (ratio * rotary)

    def stiffness(x: Any) -> Any:
        square = value_at(rotary, x) / value_at(mass, x)
        return value_at(bending, x) / (ratio * square)

    return stiffness


def _completed(beam: Beam, shear: PropertyLike | None, rotary: PropertyLike | None) -> Beam:
    """Return the beam with the shear stiffness and the rotary inertia that count."""
    known_shear, known_rotary = beam.shear_stiffness, theory_facts(beam)[1]
    if shear is None and known_shear is None:
        raise ValueError(
            "shear_stiffness must be given, kappa G A in N, for a beam that has none, got None; "
            "Beam.from_section knows it, and math.inf leaves shear out"
        )
    if rotary is None and known_rotary is None:
        raise ValueError(
            "rotary_inertia_per_length must be given, rho I in kg m, for a beam that has neither one nor a "
            "radius of gyration, got None; Beam.from_section knows it, and 0 leaves it out"
        )
    given_shear = known_shear if shear is None else shear
    given_rotary = known_rotary if rotary is None else rotary
    rigid = isinstance(given_shear, float) and given_shear == math.inf
    full = Beam(
        beam.length,
        beam.bending_stiffness,
        beam.mass_per_length,
        kept_property("rotary_inertia_per_length", given_rotary, beam.length),
        shear_stiffness=None if rigid else given_shear,
        radius_of_gyration=beam.radius_of_gyration,
    )
    if rigid:
        object.__setattr__(full, "shear_stiffness", math.inf)
    return full


def _cutoff(beam: Beam) -> float:
    """Return the least √(κGA/ρI) along the beam, infinite without shear or without rotary inertia."""
    assert beam.shear_stiffness is not None
    profiles = (beam.rotary_inertia_per_length, beam.shear_stiffness)
    parts = (x for profile in profiles for x in profile_parts(profile, beam.length))
    x = np.unique([*np.linspace(0.0, beam.length, 257), *parts])
    least = math.inf
    for side in (-1, 1):
        rotary = value_at(beam.rotary_inertia_per_length, x, side)
        shear = value_at(beam.shear_stiffness, x, side)
        ratio = np.divide(shear, rotary, out=np.full_like(x, np.inf), where=rotary > 0.0)
        least = min(least, math.sqrt(float(ratio.min())))
    return least


# Modes with shear and rotary inertia of a beam that varies or is loaded, from strains at Gauss points.


@dataclass(frozen=True, slots=True, eq=False)
class SpectralShear:
    """Mode shapes of a beam with L = mean EI = mean ρA = 1.

    Parameters
    ----------
    grid : Grid
    curvature, strain : ndarray, shape (points, modes)
        κ and γ at the grid's points.
    start : ndarray, shape (2, modes)
        y(0) and θ(0).
    """

    grid: Grid
    curvature: Floats
    strain: Floats
    start: Floats

    @classmethod
    def of(cls, grid: Grid, motions: Floats) -> SpectralShear:
        """Return the shapes whose coordinates, of curvature and then of shear strain, and start are given."""
        bent, points = grid.curvature.shape[1], len(motions) - 2
        strain = _shear_strain(grid) @ motions[bent:points]
        return cls(grid, grid.curvature @ motions[:bent], strain, motions[-2:])

    def values(self, x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return y, θ, κ and γ at positions 0 to 1, each of shape (modes, positions)."""
        grid, width = self.grid, np.diff(self.grid.edges)
        found = np.empty((4, self.curvature.shape[1], len(x)))
        cell = np.clip(np.searchsorted(grid.edges, x, side="right") - 1, 0, len(grid.sizes) - 1)
        ends = np.concatenate(([0], np.cumsum(grid.sizes)))
        arm = (np.repeat(grid.edges[1:], grid.sizes) - grid.x)[:, None]
        bent, sheared = grid.weight[:, None] * self.curvature, grid.weight[:, None] * self.strain
        turn, rise = (np.add.reduceat(part, ends[:-1]) for part in (bent, arm * bent + sheared))
        # Rotation and deflection at every cell's beginning.
        rotation = self.start[1] + np.cumsum(turn, axis=0) - turn
        rise = rise + width[:, None] * rotation
        deflection = self.start[0] + np.cumsum(rise, axis=0) - rise
        for s in np.unique(cell).tolist():
            part, here, half = slice(ends[s], ends[s + 1]), cell == s, 0.5 * width[s]
            to_series = legendre_of_values(int(grid.sizes[s]))
            curvature, strain = to_series @ self.curvature[part], to_series @ self.strain[part]
            turning = half * legendre_integral(curvature)
            turning[0] += rotation[s]
            slope = np.vstack((strain, np.zeros((1, strain.shape[1])))) + turning
            lifting = half * legendre_integral(slope)
            lifting[0] += deflection[s]
            at = (x[here] - grid.edges[s]) / half - 1.0
            for kind, series in enumerate((lifting, turning, curvature, strain)):
                found[kind][:, here] = np.polynomial.legendre.legval(at, series)
        return found[0], found[1], found[2], found[3]


def spectral_shear(
    beam: Beam, boundary: Boundary, count: int, load: Load
) -> tuple[Floats, int, SpectralShear]:
    """Return ω/frequency_unit, the number of rigid-body modes and the shapes of Timoshenko's beam.

    As `spectral_beam.spectral_modes`, with shear strains beside curvatures: y' = θ + γ and θ' = κ store
    ½ ∫EI κ² + κGA γ² + T y'², and ½ ∫ρA y² + ρI θ² times ω² is what moves.

    Parameters
    ----------
    beam : Beam
        With the shear stiffness and the rotary inertia that count.
    boundary : Boundary
    count : int
        How many elastic modes.
    load : Load
        One that leaves the beam straight.

    Raises
    ------
    ValueError, ArithmeticError
        As `spectral_modes`.
    """
    loaded = straight_load(beam, boundary, load)
    previous, reached, square = np.full(count, np.inf), math.inf, square_spin(beam, loaded)
    for grid in growing_grids(beam, 2 * count + 8):
        tension = _tension(tension_of(beam, boundary, grid, loaded), grid)
        motions = motions_between(beam, boundary, _strains(grid), _end_rows_spectral_shear(grid), tension)
        free = with_tension(motions, tension, loaded)
        rigid = free.rigid.shape[1]
        size, found = modes_of(free, _kinetic_rows(beam, boundary, grid), count)
        omega, share = in_plane(1.0 / size, rigid, boundary, loaded, square)
        change = float(np.max(np.abs(omega / previous - 1.0)))
        if change <= max(AGREEMENT, 1e-14 / free.margin, 1e-13 / share):
            return omega, rigid, SpectralShear.of(grid, found * _signs(found, grid, boundary))
        previous, reached = omega, min(reached, change)
    raise disagreement(reached)


def _shear_strain(grid: Grid) -> Floats:
    """Return the shear strain at the points by coordinates: as of curvature, with V/κGA for M/EI."""
    assert grid.shear is not None
    if grid.has_own_curvature:
        return grid.curvature
    return grid.curvature * (grid.stiffness / grid.shear)[:, None]


def _strains(grid: Grid) -> Floats:
    """Return the curvatures and shear strains that store ½ |w|²; without shear there are no such strains."""
    assert grid.shear is not None
    bending = of_unit_energy(grid, grid.stiffness, grid.curvature)
    if np.isinf(grid.shear).all():
        return np.vstack((bending, np.zeros_like(bending)))
    shear = of_unit_energy(grid, grid.shear, _shear_strain(grid))
    strains = np.block(
        [[bending, np.zeros((len(bending), len(shear)))], [np.zeros((len(shear), len(bending))), shear]]
    )
    return np.asarray(strains[:, np.abs(strains).max(axis=0) > 0.0])


def _end_rows_spectral_shear(grid: Grid) -> Floats:
    """Return y(0), θ(0), y(1), θ(1) and y(1) - y(0) as rows over a motion, shape (5, 2 coordinates + 2)."""
    moment, turn = (grid.weight * (1.0 - grid.x)) @ grid.curvature, grid.weight @ grid.curvature
    shift, none = grid.weight @ _shear_strain(grid), np.zeros_like(turn)
    bent = np.array([none, none, moment, turn, moment])
    sheared = np.array([none, none, shift, none, shift])
    straight = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 1.0], [0.0, 1.0]])
    return np.hstack((bent, sheared, straight))


def _kinetic_rows(beam: Beam, boundary: Boundary, grid: Grid) -> Floats:
    ones = np.ones((len(grid.x), 1))
    shifted = grid.integrals(_shear_strain(grid))
    deflection = np.hstack((grid.deflection, shifted, ones, grid.x[:, None]))
    rotation = np.hstack((grid.slope, np.zeros_like(grid.slope), np.zeros_like(ones), ones))
    moved = np.sqrt(grid.weight * grid.mass)[:, None] * deflection
    # Rows of zeros too, where nothing resists a turn: the singular values need as many rows as columns.
    turned = np.sqrt(grid.weight * grid.rotary)[:, None] * rotation
    return np.vstack(
        (compressed(moved), compressed(turned), body_rows(beam, boundary, _end_rows_spectral_shear(grid)))
    )


def _tension(tension: Tension, grid: Grid) -> Tension:
    """Return a tension that does its work on y' = θ + γ along the beam, on the bodies' θ at its ends."""
    strain = _shear_strain(grid)
    sheared = np.vstack((strain, np.zeros((2, strain.shape[1]))))
    return Tension(tension.pull, np.hstack((tension.row[:, :-2], sheared, tension.row[:, -2:])))


def _signs(motions: Floats, grid: Grid, boundary: Boundary) -> Floats:
    values = SpectralShear.of(grid, motions).values(np.zeros(1))
    first = int(boundary.left.holds_deflection) * (1 + int(boundary.left.holds_rotation))
    return np.where(values[first][:, 0] < 0.0, -1.0, 1.0)
