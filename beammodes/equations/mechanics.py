"""The physics of a chain, written once for any algebra: symbols, compiled graphs or plain numbers.

A planar chain of rigid pieces has the generalized coordinates  q = (x₀, y₀, θ₁, θ₂, ...): the position
of its left tip, where the left end leaves it free, and the absolute angle of every piece that no end holds.
Its equations of motion are

    M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,        c(q) = 0,

with the mass matrix M, the velocity (centrifugal) terms h, the static forces s = ∂V/∂q, the closures c of a
chain whose right end is held too, and their multipliers λ.

`energies` states kinetic and potential energy from the positions of the pieces. `motion_terms` states what
follows from them by Lagrange's equations, built directly from the chain's inertia coefficients

    M_ij = a_ij cos(θ_i - θ_j),        h_i = Σ_j a_ij sin(θ_i - θ_j) θ_j'²,

which is many times faster than differentiating a large expression. The tests differentiate the energies
and find the same.

Both ends held. With the walls exactly one chain length apart a chain of rigid pieces could not move at all.
Its right end therefore slides along the beam, as a body at either end of it would: only the transverse
closure  y₀ + Σ l_i sin θ_i = 0  is kept. The axial one,  Σ l_i cos θ_i = span,  has no gradient on the
straight chain, so without an axial force it would change nothing in the linear problem. With one it does:
the axial force T is this closure's multiplier, a dead load that does the work T on the span. Its potential
-T Σ l_i cos θ_i is all that is said of it here; the geometric stiffness follows by differentiation. Where no
spring and no wall ties the left end to the ground and the right one is tied, the right end is the one that
holds the chain axially.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from beammodes.chains.chain import Chain, Number
from beammodes.equations.axial_pull import hub_load
from beammodes.equations.coordinates import axially_free_left, moving_pieces, tip_names, unpack
from beammodes.equations.load_field import Algebra, LoadField, static_forces, support_units
from beammodes.problem.loading import Load, checked_load

__all__ = [
    "Algebra",
    "Energies",
    "MotionTerms",
    "energies",
    "inertia_coefficients",
    "motion_terms",
    "piece_energies",
]


Pair = tuple[Any, Any]


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
    static_forces: list[Any]
    closures: list[Any]


def inertia_coefficients(chain: Chain) -> tuple[list[list[Number]], list[Number], Number]:
    """Return a_ij and the first moments s_j of the moving pieces, and the chain's mass, in its own units.

    With μ_j the mass to the right of piece j and c_j its centre of mass from its left tip,

        s_j = l_j μ_j + c_j m_j,   a_ij = l_i s_j (i left of j),   a_jj = J_j + m_j c_j² + l_j² μ_j.

    s_j is what turning piece j moves: the mass times distance that its turning carries along.
    """
    length, mass, inertia = chain.piece_length, chain.piece_mass, chain.piece_rotary_inertia
    moving, centre = moving_pieces(chain), chain.piece_centre
    beyond: list[Number] = [0] * chain.pieces
    for j in range(chain.pieces - 2, -1, -1):
        beyond[j] = beyond[j + 1] + mass[j + 1]
    moment = [length[j] * beyond[j] + centre[j] * mass[j] for j in moving]
    coefficients = [
        [length[min(i, j)] * moment[max(a, b)] for b, j in enumerate(moving)] for a, i in enumerate(moving)
    ]
    for a, i in enumerate(moving):
        coefficients[a][a] = inertia[i] + mass[i] * centre[i] ** 2 + length[i] ** 2 * beyond[i]
    return coefficients, moment, beyond[0] + mass[0]


def energies(
    chain: Chain, q: Sequence[Any], u: Sequence[Any], algebra: Algebra, load: Load | None = None
) -> Energies:
    """Return the chain's energies in coordinates `q` and speeds `u` (ordered as `coordinate_names`).

    With the tips' deflections y and the outer pieces' angles θ at either end, the axial force T, and forces,
    moments and weights of `loading.Load`,

        T = ½ Σ (m_i (x_i'² + y_i'²) + J_i θ_i'²),
        V = ½ Σ k_j (θ_{j+1} - θ_j)² + ½ Σ_ends (K_t y² + K_r θ²)
            - T Σ l_i cos θ_i - F·r_tip - M_tip θ_tip - Σ m_i g·r_i
            - ½ Ω² Σ m_i ((R + x_i)² + y_i²)                       in the plane of rotation of a hub
            - ½ Ω² Σ (m_i (R + x_i)² + J_i cos² θ_i)               across it

    Under spin, coordinates are relative to the turning hub, and the kinetic energy is that of motion relative
    to it: what vibration about an equilibrium needs. (Coriolis forces are of second order in an inextensible
    beam's deflection.)
    """
    hub_load(chain, checked_load(load))
    (tip, angle), (tip_speed, spin) = unpack(chain, q), unpack(chain, u)
    kinetic, potential, (x, y) = piece_energies(chain, tip, tip_speed, angle, spin, algebra, load)
    return Energies(kinetic, potential, _closures(chain, x, y, algebra))


def piece_energies(
    chain: Chain,
    tip: Pair,
    tip_speed: Pair,
    angle: Sequence[Any],
    spin: Sequence[Any],
    algebra: Algebra,
    load: Load | None = None,
    base: Pair = (0, 0),
) -> tuple[Any, Any, Pair]:
    """Return kinetic and potential energy from all pieces' motion, and the right tip's position.

    Parameters
    ----------
    tip, tip_speed : pair
        Position and velocity of the left tip.
    angle, spin : sequence, one a piece
        Angles and rates of all pieces, held ones included.
    base : pair
        Deflection and angle of what the elastic supports stand on.
    """
    number, length_unit = algebra.number, algebra.length
    (x, y), (x_speed, y_speed) = tip, tip_speed
    twice_kinetic: Any = number(0)
    field = LoadField.of(chain, load, algebra)
    work: Any = number(0)
    for i in range(chain.pieces):
        mass = number(chain.piece_mass[i]) * algebra.mass
        inertia = number(chain.piece_rotary_inertia[i]) * algebra.mass * length_unit**2
        length, centre = (number(v[i]) * length_unit for v in (chain.piece_length, chain.piece_centre))
        cosine, sine = algebra.cos(angle[i]), algebra.sin(angle[i])
        across, along = x_speed - centre * sine * spin[i], y_speed + centre * cosine * spin[i]
        twice_kinetic += mass * (across**2 + along**2) + inertia * spin[i] ** 2
        work += field.work(mass, inertia, x + centre * cosine, y + centre * sine, cosine)
        x_speed, y_speed = x_speed - length * sine * spin[i], y_speed + length * cosine * spin[i]
        x, y = x + length * cosine, y + length * sine
    twice_potential: Any = number(0)
    for j, stiffness in enumerate(chain.hinge_stiffness):
        twice_potential += number(stiffness) * algebra.stiffness * (angle[j + 1] - angle[j]) ** 2
    for (along_y, turning), deflection, rotation in zip(
        support_units(chain, algebra), (tip[1], y), (angle[0], angle[-1]), strict=True
    ):
        twice_potential += along_y * (deflection - base[0]) ** 2 + turning * (rotation - base[1]) ** 2
    work += field.axial * (x - tip[0]) + field.tip[0] * x + field.tip[1] * y + field.moment * angle[-1]
    return twice_kinetic / 2, twice_potential / 2 - work, (x, y)


def motion_terms(
    chain: Chain, q: Sequence[Any], u: Sequence[Any], algebra: Algebra, load: Load | None = None
) -> MotionTerms:
    """Return the terms of the equations of motion in coordinates `q` and speeds `u`."""
    moving = moving_pieces(chain)
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
    for name in reversed(tip_names(chain)):
        row, pull = borders[name]
        zeros = [algebra.number(0)] * (len(mass_matrix) - len(row))
        mass_matrix = [[value, *line] for value, line in zip([*zeros, *row], mass_matrix, strict=True)]
        mass_matrix = [[algebra.number(total) * algebra.mass, *zeros, *row], *mass_matrix]
        drag = [s * value * w**2 for s, value, w in zip(moment, pull, spin, strict=True)]
        velocity = [-sum(drag, algebra.number(0)), *velocity]
    x, y, static = static_forces(chain, q, algebra, load)
    return MotionTerms(mass_matrix, velocity, static, _closures(chain, x, y, algebra))


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


def _closures(chain: Chain, x: Any, y: Any, algebra: Algebra) -> list[Any]:
    """Return what the right end holds of its tip (x, y): see the module's note on both ends held."""
    right = chain.boundary.right
    whole = sum(chain.piece_length, start=chain.piece_length[0] * 0)
    held = right.is_grounded and axially_free_left(chain)
    axial = [x - algebra.number(whole) * algebra.length] if held else []
    return [*axial, *([y] if right.holds_deflection else [])]
