"""A uniform beam and its ends in the beam's own units, in long decimals, with its count of roots.

Soft springs, heavy bodies and near-double roots cost a determinant in doubles up to all its digits. In
decimals long enough for the numbers at hand the plain formulas are safe everywhere, so that no corner of the
parameters needs formulas of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import NamedTuple

from beammodes.numerics.count_roots import ROOT_DIGITS, Sample
from beammodes.numerics.long_decimals import as_decimal, cosine_and_sine, pi
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End

__all__ = ["EndStiffness", "UnitBeam", "UnitEnd", "end_stiffness", "inertia_and_determinant", "pinned_count"]


# The exact stiffness of a uniform beam at its two ends, vibrating or not, and the inertia of matrices.

Matrix = list[list[Decimal]]


EndStiffness = tuple[Matrix, Decimal]


def end_stiffness(p: Decimal, q: Decimal) -> EndStiffness:
    """Return the forces for unit end motions y(0), y'(0), y(1), y'(1), and Δ, whose zeros are their poles.

    From y = A cosh px + B sinh px + C cos qx + D sin qx; the squares of cosh and sinh, which would cancel to
    e^(-2p) of themselves, are taken out by hand.

    Parameters
    ----------
    p, q : Decimal
        p² - q² = t and p q = √w of y'''' - t y'' = w y; p may be zero.

    Returns
    -------
    matrix, Decimal
        Symmetric, 4 by 4, and Δ, bounded, positive below the clamped beam's first root.

    Examples
    --------
    >>> stiffness, _ = end_stiffness(Decimal(0), Decimal(10) ** -4)
    >>> [round(float(entry), 6) for entry in stiffness[0]]
    [12.0, 6.0, -12.0, 6.0]
    """
    cosine, sine = cosine_and_sine(q)
    grown = p.exp()
    even, odd = (grown + 1 / grown) / 2, (grown - 1 / grown) / (2 * p) if p else Decimal(1)  # cosh, sinh/p
    tension, total, mixed = p * p - q * q, p * p + q * q, even * cosine
    pole = 2 - 2 * mixed + tension * odd * sine / q
    a = total * (p * p * odd * cosine + q * sine * even) / pole
    b = (tension * (mixed - 1) + 2 * p * p * q * odd * sine) / pole
    c, d = total * (even * sine / q - cosine * odd) / pole, -total * (p * p * odd + q * sine) / pole
    e, f = total * (even - cosine) / pole, total * (odd - sine / q) / pole
    return [[a, b, d, e], [b, c, -e, f], [d, -e, a, -b], [e, f, -b, c]], pole / even


def pinned_count(q: Decimal) -> int:
    """Return how many roots n π of the pinned beam lie below `q`.

    Examples
    --------
    >>> pinned_count(Decimal("6.3"))
    2
    """
    return max(0, int((q / pi()).to_integral_value("ROUND_CEILING")) - 1)


def inertia_and_determinant(matrix: Matrix, kept: Sequence[int]) -> tuple[int, Decimal]:
    """Return how many eigenvalues of a symmetric matrix's kept rows and columns are negative, and its det.

    By Gaussian elimination without exchanges (Sylvester's law of inertia): a pivot of zero is taken for a
    tiny positive one, whose successor then counts right.

    Examples
    --------
    >>> inertia_and_determinant([[Decimal(0), Decimal(2)], [Decimal(2), Decimal(3)]], [0, 1])[0]
    1
    """
    rows = [[matrix[i][j] for j in kept] for i in kept]
    negative, determinant = 0, Decimal(1)
    for step, pivot_row in enumerate(rows):
        pivot = pivot_row[step] or Decimal("1e-1000")
        negative += pivot < 0
        determinant *= pivot
        for i in range(step + 1, len(rows)):
            factor = rows[i][step] / pivot
            for j in range(i, len(rows)):
                rows[i][j] -= factor * pivot_row[j]
                rows[j][i] = rows[i][j]
    return negative, determinant


# Roots of the free beam are poles of its stiffness: there cancellation takes twice the digits of a root.
_GUARDED = 3 * ROOT_DIGITS + 4


class UnitEnd(NamedTuple):
    """Supports and moving body of one end over EI/L³, EI/L, ρA L, ρA L³ and L; springs that hold are 0.

    Rotations are y' with x running inward from this end: the body's centre of mass deflects by y - a θ.
    """

    holds: tuple[bool, bool]
    translational: Decimal
    rotational: Decimal
    mass: Decimal
    inertia: Decimal
    offset: Decimal

    def impedance(self, square: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Return the yy, yθ and θθ entries of K - ω² M."""
        coupled = square * self.mass * self.offset
        turning = self.rotational - square * self.inertia - coupled * self.offset
        return self.translational - square * self.mass, coupled, turning

    def energy(self, deflection: Decimal, rotation: Decimal) -> Decimal:
        """Return m (y - a θ)² + J θ²."""
        return self.mass * (deflection - self.offset * rotation) ** 2 + self.inertia * rotation**2


@dataclass(frozen=True)
class UnitBeam:
    """y'''' - t y'' = w y for 0 < x < 1, t = τ - r² w, w = ω², with its ends; `of` makes it.

    Parameters
    ----------
    tension : Decimal
        τ = T L²/EI.
    gyration : Decimal
        r² = ρI/(ρA L²).
    left, right : UnitEnd
        The ends at 0 and at 1.

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

    @classmethod
    def of(
        cls, beam: Beam, boundary: Boundary, axial_force: float | Fraction = 0.0, inertia: float = 0.0
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
                _unit_end(boundary.left, units),
                _unit_end(boundary.right, units),
            )

    @property
    def spread(self) -> int:
        """The decades by which all numbers together depart from one."""
        numbers = (self.tension, self.gyration, *self.left[1:], *self.right[1:])
        return sum(abs(number.adjusted()) for number in numbers if number)

    @property
    def translation_is_free(self) -> bool:
        """Whether nothing resists a deflection that is the same everywhere."""
        return not any(end.holds[0] or end.translational for end in (self.left, self.right))

    def digits(self, place: Decimal) -> int:
        """Return how many digits keep the determinant at w or -τ = `place` safe from cancellation."""
        return _GUARDED + self.spread + 2 * abs(place.adjusted())

    def square_at(self, wave: Decimal) -> Decimal:
        """Return w = q² (q² + τ)/(1 + r² q²) of the trigonometric wavenumber q = `wave`."""
        return wave**2 * (wave**2 + self.tension) / (1 + self.gyration * wave**2)

    def wavenumbers(self, square: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Return t, and p and q of the waves e^(±px), cos qx, sin qx: p² - q² = t and p q = √w."""
        tension = self.tension - self.gyration * square
        middle = ((tension / 2) ** 2 + square).sqrt()
        return tension, (middle + tension / 2).sqrt(), (middle - tension / 2).sqrt()

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
            _, p, q = self.wavenumbers(square)
            held = (*self.left.holds, *self.right.holds)
            return self._counted(square, square, end_stiffness(p, q), q, held)

    def static_sample(self, compression: Decimal) -> Sample:
        """Count the buckling loads below -τ = `compression` > 0 and evaluate their determinant there.

        A translation that is free feels no compression and is held at x = 0.

        Examples
        --------
        >>> pinned = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
        >>> [pinned.static_sample(Decimal(load)).below for load in (9, 10)]
        [0, 1]
        """
        with localcontext() as context:
            context.prec = self.digits(compression)
            none, q = Decimal(0), compression.sqrt()
            first, *others = (*self.left.holds, *self.right.holds)
            held = (first or self.translation_is_free, *others)
            return self._counted(compression, none, end_stiffness(none, q), q, held)

    def _counted(
        self, place: Decimal, square: Decimal, stiffness: EndStiffness, q: Decimal, held: tuple[bool, ...]
    ) -> Sample:
        """Count from the pinned beam to the clamped one and on to this one.

        Releasing degrees of freedom adds as many roots below a place as their stiffness there has negative
        eigenvalues: Wittrick and Williams, Quarterly Journal of Mechanics and Applied Mathematics 24 (1971).
        """
        matrix, common = stiffness
        clamped = pinned_count(q) - sum(matrix[1][1] + matrix[1][3] * sign < 0 for sign in (1, -1))
        for i, end, side in ((0, self.left, 1), (2, self.right, -1)):
            deflection, coupled, turning = end.impedance(square)
            matrix[i][i] += deflection
            matrix[i + 1][i + 1] += turning
            matrix[i][i + 1] += side * coupled
            matrix[i + 1][i] += side * coupled
        kept = [i for i in range(4) if not held[i]]
        released, determinant = inertia_and_determinant(matrix, kept)
        return Sample(place, clamped + released, determinant * common)


def _unit_end(end: End, units: tuple[Decimal, ...]) -> UnitEnd:
    holds = (end.holds_deflection, end.holds_rotation)
    springs = (end.translational_stiffness, end.rotational_stiffness)
    moved = (0.0 if held else spring for held, spring in zip(holds, springs, strict=True))
    numbers = (*moved, *end.moving_body)
    return UnitEnd(holds, *(as_decimal(n) / unit for n, unit in zip(numbers, units, strict=True)))
