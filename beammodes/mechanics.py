"""The physics of a chain, written once for any algebra: symbols, compiled graphs or plain numbers.

A planar chain of rigid pieces has the generalized coordinates  q = (x₀, y₀, θ₁, θ₂, ...): the position
of its left tip, where the left end leaves it free, and the absolute angle of every piece that no end holds.
Its equations of motion are

    M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,        c(q) = 0,

with the mass matrix M, the velocity (centrifugal) terms h, the spring moments s, the closures c of a chain
whose right end is held too, and their multipliers λ.

`energies` states kinetic and potential energy from the positions of the pieces. `motion_terms` states what
follows from them by Lagrange's equations, built directly from the chain's inertia coefficients

    M_ij = a_ij cos(θ_i - θ_j),        h_i = Σ_j a_ij sin(θ_i - θ_j) θ_j'²,

which is many times faster than differentiating a large expression. The tests differentiate the energies
and find the same.

Both ends held. With the walls exactly one chain length apart a chain of rigid pieces could not move at all.
Its right end therefore slides along the beam, as a body at either end of it would: only the transverse
closure  y₀ + Σ l_i sin θ_i = 0  is kept. The axial one has no gradient on the straight chain, where its
multiplier, the axial force, is zero, so it would change nothing in the linear problem. Where the left end
is free and the right one is not, the right end is the one that holds the chain axially.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from beammodes.chain import Chain, Number

__all__ = [
    "Algebra",
    "Energies",
    "MotionTerms",
    "coordinate_names",
    "energies",
    "inertia_coefficients",
    "motion_terms",
    "null_space",
]


@dataclass(frozen=True)
class Algebra:
    """What the physics needs of a number system: constants, sine and cosine, and the chain's three units."""

    number: Callable[[Number], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    length: Any
    mass: Any
    stiffness: Any


@dataclass(frozen=True)
class Energies:
    """Kinetic and potential energy, and the closures c(q), all zero on an admissible configuration."""

    kinetic: Any
    potential: Any
    closures: list[Any]


@dataclass(frozen=True)
class MotionTerms:
    """The terms of  M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,  as nested lists of the algebra's values."""

    mass_matrix: list[list[Any]]
    velocity_terms: list[Any]
    spring_moments: list[Any]
    closures: list[Any]


def coordinate_names(chain: Chain) -> list[str]:
    """Return the names of the generalized coordinates, in order: x_0, y_0 (if free), theta_1, theta_2, ...

    Examples
    --------
    >>> from beammodes.beam import Beam
    >>> coordinate_names(Chain(Beam.unit(), "guided-free", segments=2))
    ['y_0', 'theta_1', 'theta_2']
    """
    moving = len(_moving(chain))
    return [*_tip_names(chain), *(f"theta_{i + 1}" for i in range(moving))]


def inertia_coefficients(chain: Chain) -> tuple[list[list[Number]], list[Number], Number]:
    """Return a_ij and the first moments s_j of the moving pieces, and the chain's mass, in its own units.

    With μ_j the mass to the right of piece j,

        s_j = l_j (μ_j + m_j/2),   a_ij = l_i s_j (i left of j),   a_jj = J_j + m_j l_j²/4 + l_j² μ_j.

    s_j is what turning piece j moves: the mass times distance that its turning carries along.
    """
    length, mass, inertia = chain.piece_length, chain.piece_mass, chain.piece_rotary_inertia
    moving = _moving(chain)
    beyond: list[Number] = [0] * chain.pieces
    for j in range(chain.pieces - 2, -1, -1):
        beyond[j] = beyond[j + 1] + mass[j + 1]
    moment = [length[j] * (beyond[j] + mass[j] / 2) for j in moving]
    coefficients = [
        [length[min(i, j)] * moment[max(a, b)] for b, j in enumerate(moving)] for a, i in enumerate(moving)
    ]
    for a, i in enumerate(moving):
        coefficients[a][a] = inertia[i] + mass[i] * length[i] ** 2 / 4 + length[i] ** 2 * beyond[i]
    return coefficients, moment, beyond[0] + mass[0]


def energies(chain: Chain, q: Sequence[Any], u: Sequence[Any], algebra: Algebra) -> Energies:
    """Return the chain's energies in coordinates `q` and speeds `u` (ordered as `coordinate_names`).

    T = ½ Σ (m_i (x_i'² + y_i'²) + J_i θ_i'²),        V = ½ Σ k_j (θ_{j+1} - θ_j)²
    """
    number, length_unit = algebra.number, algebra.length
    tip, angle = _unpack(chain, q)
    tip_speed, spin = _unpack(chain, u)
    (x, y), (x_speed, y_speed) = tip, tip_speed
    twice_kinetic: Any = number(0)
    for i in range(chain.pieces):
        mass = number(chain.piece_mass[i]) * algebra.mass
        inertia = number(chain.piece_rotary_inertia[i]) * algebra.mass * length_unit**2
        half = number(chain.piece_length[i]) * length_unit / 2
        dx, dy = half * algebra.cos(angle[i]), half * algebra.sin(angle[i])
        x_middle, y_middle = x_speed - dy * spin[i], y_speed + dx * spin[i]
        twice_kinetic += mass * (x_middle**2 + y_middle**2) + inertia * spin[i] ** 2
        x_speed, y_speed = x_middle - dy * spin[i], y_middle + dx * spin[i]
        x, y = x + 2 * dx, y + 2 * dy
    twice_potential: Any = number(0)
    for j, stiffness in enumerate(chain.hinge_stiffness):
        twice_potential += number(stiffness) * algebra.stiffness * (angle[j + 1] - angle[j]) ** 2
    return Energies(twice_kinetic / 2, twice_potential / 2, _closures(chain, x, y, algebra))


def motion_terms(chain: Chain, q: Sequence[Any], u: Sequence[Any], algebra: Algebra) -> MotionTerms:
    """Return the terms of the equations of motion in coordinates `q` and speeds `u`."""
    moving = _moving(chain)
    tips = len(q) - len(moving)
    angle, spin = q[tips:], u[tips:]
    sine = [algebra.sin(value) for value in angle]
    cosine = [algebra.cos(value) for value in angle]
    mass_matrix, velocity = _angle_terms(chain, angle, spin, algebra)
    _, moments, total = inertia_coefficients(chain)
    moment_unit = algebra.mass * algebra.length
    moment = [algebra.number(value) * moment_unit for value in moments]
    borders = {
        "x_0": ([-s * value for s, value in zip(moment, sine, strict=True)], cosine),
        "y_0": ([s * value for s, value in zip(moment, cosine, strict=True)], sine),
    }
    for name in reversed(_tip_names(chain)):
        row, pull = borders[name]
        zeros = [algebra.number(0)] * (len(mass_matrix) - len(row))
        mass_matrix = [[value, *line] for value, line in zip([*zeros, *row], mass_matrix, strict=True)]
        mass_matrix = [[algebra.number(total) * algebra.mass, *zeros, *row], *mass_matrix]
        drag = [s * value * w**2 for s, value, w in zip(moment, pull, spin, strict=True)]
        velocity = [-sum(drag, algebra.number(0)), *velocity]
    springs = [algebra.number(0)] * tips + _spring_moments(chain, angle, algebra)
    (x, y), angles = _unpack(chain, q)
    for length, value in zip(chain.piece_length, angles, strict=True):
        x += algebra.number(length) * algebra.length * algebra.cos(value)
        y += algebra.number(length) * algebra.length * algebra.sin(value)
    return MotionTerms(mass_matrix, velocity, springs, _closures(chain, x, y, algebra))


def null_space(rows: Sequence[Sequence[Any]], size: int, number: Callable[[Number], Any]) -> list[list[Any]]:
    """Return a basis of the vectors that at most one non-trivial row annihilates, as a list of columns.

    The first coordinate that the row contains is expressed by the others, so exact entries stay exact.
    """
    pivots = [(row, p) for row in rows for p in [next((i for i, c in enumerate(row) if c != 0), None)]]
    basis = [[number(int(i == j)) for i in range(size)] for j in range(size)]
    for row, pivot in pivots:
        if pivot is None:
            continue
        for j, column in enumerate(basis):
            column[pivot] = -row[j] / row[pivot]
        del basis[pivot]
    return basis


def _angle_terms(
    chain: Chain, angle: Sequence[Any], spin: Sequence[Any], algebra: Algebra
) -> tuple[list[list[Any]], list[Any]]:
    """Return  a_ij cos(θ_i - θ_j)  and  Σ_j a_ij sin(θ_i - θ_j) θ_j'²."""
    coefficients, _, _ = inertia_coefficients(chain)
    unit, size = algebra.mass * algebra.length**2, len(angle)
    matrix: list[list[Any]] = [[None] * size for _ in range(size)]
    velocity: list[list[Any]] = [[] for _ in range(size)]
    square = [value**2 for value in spin]
    for i in range(size):
        matrix[i][i] = algebra.number(coefficients[i][i]) * unit
        for j in range(i):
            factor, turn = algebra.number(coefficients[i][j]) * unit, angle[i] - angle[j]
            matrix[i][j] = matrix[j][i] = factor * algebra.cos(turn)
            torque = factor * algebra.sin(turn)
            velocity[i].append(torque * square[j])
            velocity[j].append(-torque * square[i])
    zero = algebra.number(0)
    return matrix, [sum(terms, zero) for terms in velocity]


def _spring_moments(chain: Chain, angle: Sequence[Any], algebra: Algebra) -> list[Any]:
    """Return ∂V/∂θ for the moving pieces: each spring pulls on the piece at either side of it."""
    angles = _with_held(chain, angle)
    moments: list[Any] = [0] * chain.pieces
    for j, stiffness in enumerate(chain.hinge_stiffness):
        moment = algebra.number(stiffness) * algebra.stiffness * (angles[j + 1] - angles[j])
        moments[j] -= moment
        moments[j + 1] += moment
    return [moments[i] for i in _moving(chain)]


def _closures(chain: Chain, x: Any, y: Any, algebra: Algebra) -> list[Any]:
    """Return what the right end holds of its tip (x, y): see the module's note on both ends held."""
    right = chain.boundary.right
    whole = sum(chain.piece_length, start=chain.piece_length[0] * 0)
    axial = [x - algebra.number(whole) * algebra.length] if _axially_free_left(chain) else []
    return [
        *(axial if right.holds_deflection or right.holds_rotation else []),
        *([y] if right.holds_deflection else []),
    ]


def _axially_free_left(chain: Chain) -> bool:
    left = chain.boundary.left
    return not (left.holds_deflection or left.holds_rotation)


def _tip_names(chain: Chain) -> list[str]:
    tip_free = not chain.boundary.left.holds_deflection
    return [*(["x_0"] if _axially_free_left(chain) else []), *(["y_0"] if tip_free else [])]


def _moving(chain: Chain) -> list[int]:
    return [i for i, held in enumerate(chain.held_angles) if not held]


def _with_held(chain: Chain, angle: Sequence[Any]) -> list[Any]:
    values = iter(angle)
    return [0 if held else next(values) for held in chain.held_angles]


def _unpack(chain: Chain, q: Sequence[Any]) -> tuple[tuple[Any, Any], list[Any]]:
    """Return the left tip (x, y) and every piece's angle, held ones included."""
    names = _tip_names(chain)
    tip = dict(zip(names, q, strict=False))
    return (tip.get("x_0", 0), tip.get("y_0", 0)), _with_held(chain, q[len(names) :])
