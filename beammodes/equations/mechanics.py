"""The physics of a chain, written once for any algebra: symbols, compiled graphs or plain numbers.

A planar chain of rigid pieces has the generalized coordinates  q = (x₀, y₀, θ₁, θ₂, ...): the position
of its left tip, where the left end leaves it free, and the absolute angle of every piece that no end holds.
Its equations of motion are

    M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,        c(q) = 0,

with the mass matrix M, the velocity (centrifugal) terms h, the static forces s = ∂V/∂q, the closures c of a
chain whose right end is held too, and their multipliers λ.

`energies` gives kinetic and potential energy from the positions of the pieces; `motion_terms` what follows
from them by Lagrange's equations, built from the chain's inertia coefficients a_ij,

    M_ij = a_ij cos(θ_i - θ_j),        h_i = Σ_j a_ij sin(θ_i - θ_j) θ_j'²,

which is many times faster than differentiating a large expression. The tests differentiate the energies.

Both ends held. Between walls exactly one chain length apart rigid pieces could not move at all. The right end
therefore slides along the beam: only the transverse closure  y₀ + Σ l_i sin θ_i = 0  is kept. The axial one,
Σ l_i cos θ_i = span,  has no gradient on the straight chain; its multiplier is the axial force T, a dead load
with the potential -T Σ l_i cos θ_i, from which the geometric stiffness follows. Where no spring and no wall
ties the left end to the ground and the right one is tied, the right end holds the chain axially.

Both ends held apart, at a `span` (X, Y) from each other and nearer than the chain is long: both closures are
kept,  Σ l_i cos θ_i = X  and  Σ l_i sin θ_i = Y.  No shape that meets them is straight, so neither gradient
vanishes. The multipliers are the force of the right end's support.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number, each_once
from beammodes.checks import Shown
from beammodes.problem.ends import check_no_hub
from beammodes.problem.loading import Load, checked_load

__all__ = [
    "Algebra",
    "Energies",
    "LinearizedChain",
    "Span",
    "axial_pull",
    "coordinate_names",
    "end_closures",
    "energies",
    "held_chain_load",
    "motion_terms",
    "moving_pieces",
    "null_space",
    "piece_energies",
    "static_forces",
    "straight_chain_load",
    "tip_names",
    "unpack",
]

Pair = tuple[Any, Any]
#: From the left end of a chain to the right one, along x and y [m].
Span = tuple[float, float]


def straight_chain_load(chain: Chain, load: Load) -> Load:
    """Return `load`, or raise ValueError if the straight chain is not in equilibrium under it."""
    if load.bends:
        raise ValueError(
            f"load must leave the straight chain in equilibrium, got {load}: the bent shape has modes by "
            "linearize(chain, at=find_equilibrium(chain, load))"
        )
    return held_chain_load(chain, load)


def held_chain_load(chain: Chain, load: Load) -> Load:
    """Return `load`, or raise ValueError if nothing holds the left end against it."""
    if load.needs_hub and not chain.boundary.left.is_grounded:
        raise ValueError(
            f"boundary must tie the left end to the ground or hub under {load}, got {chain.boundary.name}: "
            "name the held end first"
        )
    beam = chain.beam
    if load.spin_rate and beam is not None and beam.has_rotary_inertia:
        raise ValueError("beam must have no rotary_inertia_per_length on a turning hub")
    if load.spin_rate:
        check_no_hub(chain.boundary.left, chain.boundary.right)
    return load


def axial_pull(chain: Chain, load: Load) -> list[Number]:
    """Return, for each piece, what loads along the chain add to  ∂²V/∂θ_i²  at rest, in its own units.

    A piece whose outer neighbours are pulled with the force P, and itself at its centre with p, resists
    turning with  l P + c p.  P sums the axial force, the tip's, and weight and centrifugal force
    m (g_x + Ω² X) of all that lies beyond; a rod's own spread along the radius adds Ω² J.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> axial_pull(Chain(Beam.unit(), "pinned-pinned", 2), Load(axial_force=Fraction(1)))   # T l in EI/ell
    [Fraction(1, 4), Fraction(1, 4)]
    """
    if not (load.axial_force or load.spin_rate or load.weight[0] or load.tip[0]):
        return [0] * chain.pieces
    units = chain.exact_units
    beyond: Number = units.force(Fraction(load.axial_force) + Fraction(load.tip[0]))
    weight, square = units.acceleration(load.weight[0]), units.square_rate(load.spin_rate)
    if not (weight or square):
        return each_once(lambda length: length * beyond if beyond else beyond, chain.scaled.length)
    radius = _radii(chain, units.body(0, 0, load.hub_radius)[2])
    pulls: list[Number] = []
    for i in range(chain.pieces - 1, -1, -1):
        own = chain.scaled.mass[i] * (weight + square * radius[i])
        turning = square * chain.scaled.rotary_inertia[i]
        pulls.append(chain.scaled.length[i] * beyond + chain.scaled.centre[i] * own + turning)
        beyond += own
    return pulls[::-1]


def _radii(chain: Chain, hub: Number) -> list[Number]:
    """Return the distance of every piece's centre of mass from the axis of rotation."""
    radii, start = [], hub
    for length, centre in zip(chain.scaled.length, chain.scaled.centre, strict=True):
        radii.append(start + centre)
        start += length
    return radii


def coordinate_names(chain: Chain) -> list[str]:
    """Return the names of the generalized coordinates, in order: x_0, y_0 (if free), theta_1, theta_2, ...

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> coordinate_names(Chain(Beam.unit(), "guided-free", segments=2))
    ['y_0', 'theta_1', 'theta_2']
    """
    moving = len(moving_pieces(chain))
    return [*tip_names(chain), *(f"theta_{i + 1}" for i in range(moving))]


@dataclass(frozen=True)
class LinearizedChain:
    """The linearized chain  M q'' + K q = 0,  matrices of numbers or of symbols.

    Attributes
    ----------
    coordinates : tuple
        Transverse coordinates: y_0 where the left end leaves it free, then the angles.
    mass_matrix, stiffness_matrix : matrix, shape (n, n)
        M and K in these coordinates, before the closure is imposed.
    basis : matrix, shape (n, independent)
        Columns span the coordinates that satisfy the closure; the identity for an open chain.
    """

    coordinates: tuple[Any, ...]
    mass_matrix: Any
    stiffness_matrix: Any
    basis: Any

    def reduced(self) -> tuple[Any, Any]:
        """Return  Tᵀ M T  and  Tᵀ K T,  the matrices of the chain's independent coordinates."""
        turn = self.basis.T
        return turn @ self.mass_matrix @ self.basis, turn @ self.stiffness_matrix @ self.basis


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


def _axially_free_left(chain: Chain) -> bool:
    """Say whether nothing ties the left end to the ground, so that its axial position is a coordinate."""
    return not chain.boundary.left.is_grounded


def tip_names(chain: Chain) -> list[str]:
    """Return the names of the left tip's coordinates, those that its end leaves free."""
    tip_free = not chain.boundary.left.holds_deflection
    return [*(["x_0"] if _axially_free_left(chain) else []), *(["y_0"] if tip_free else [])]


def moving_pieces(chain: Chain) -> list[int]:
    """Return the indices of the pieces whose angles are coordinates."""
    return [i for i, held in enumerate(chain.held_angles) if not held]


def _with_held(chain: Chain, angle: Sequence[Any]) -> list[Any]:
    values = iter(angle)
    return [0 if held else next(values) for held in chain.held_angles]


def unpack(chain: Chain, q: Sequence[Any]) -> tuple[tuple[Any, Any], list[Any]]:
    """Return the left tip (x, y) and every piece's angle, held ones included."""
    names = tip_names(chain)
    tip = dict(zip(names, q, strict=False))
    return (tip.get("x_0", 0), tip.get("y_0", 0)), _with_held(chain, q[len(names) :])


@dataclass(frozen=True)
class Algebra:
    """A number system for the physics: constants, sine and cosine, and the chain's three units."""

    number: Callable[[Number], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    length: Any
    mass: Any
    stiffness: Any

    @classmethod
    def physical(cls, chain: Chain, sin: Callable[[Any], Any], cos: Callable[[Any], Any]) -> Algebra:
        """Return an algebra of floats in which a chain's terms are in physical units."""
        units = chain.units
        return cls(float, sin, cos, units.length, units.mass, units.stiffness)


@dataclass(frozen=True)
class _LoadField:
    """A load in the units of an algebra: `square_rate` Ω², `lag` in the plane of rotation, `idle` no load."""

    axial: Any
    moment: Any
    tip: Pair
    weight: Pair
    square_rate: Any
    hub: Any
    lag: bool
    idle: bool

    @classmethod
    def of(cls, chain: Chain, load: Load | None, algebra: Algebra) -> _LoadField:
        given = checked_load(load)
        units, number = chain.exact_units, algebra.number
        force = algebra.stiffness / algebra.length
        acceleration = force / algebra.mass
        return cls(
            number(units.force(given.axial_force)) * force,
            number(units.moment(given.tip_moment)) * algebra.stiffness,
            (number(units.force(given.tip[0])) * force, number(units.force(given.tip[1])) * force),
            (
                number(units.acceleration(given.weight[0])) * acceleration,
                number(units.acceleration(given.weight[1])) * acceleration,
            ),
            number(units.square_rate(given.spin_rate)) * acceleration / algebra.length,
            number(units.body(0, 0, given.hub_radius)[2]) * algebra.length,
            given.plane == "lag",
            not (given.axial_force or given.needs_hub),
        )

    def work(self, mass: Any, inertia: Any, x: Any, y: Any, cosine: Any) -> Any:
        """Return the work of gravity and centrifugal force on a piece with its centre of mass at (x, y)."""
        if self.idle:
            return 0
        spread = mass * y**2 if self.lag else inertia * cosine**2
        turning = self.square_rate / 2 * (mass * (self.hub + x) ** 2 + spread)
        return mass * (self.weight[0] * x + self.weight[1] * y) + turning

    def forces(self, mass: Any, x: Any, y: Any) -> Pair:
        """Return the force of gravity and spin on a piece with its centre of mass at (x, y)."""
        outward = y if self.lag else 0
        return (
            mass * (self.weight[0] + self.square_rate * (self.hub + x)),
            mass * (self.weight[1] + self.square_rate * outward),
        )


def static_forces(
    chain: Chain, q: Sequence[Any], algebra: Algebra, load: Load | None
) -> tuple[Any, Any, list[Any]]:
    """Return the right tip's position, and  ∂V/∂q  of hinge springs, supports and loads.

    With F_i on the centre of mass of piece i, P_i the sum of all forces beyond it and n_i its normal, loads
    do  n_i · (c_i F_i + l_i P_i)  to its angle.
    """
    held_chain_load(chain, checked_load(load))
    number, tips, angles = algebra.number, *unpack(chain, q)
    zero, field, units = number(0), _LoadField.of(chain, load, algebra), _support_units(chain, algebra)
    moments = _spring_moments(chain, angles, algebra)
    (left, left_turning), (right, right_turning) = units
    moments[0] += left_turning * angles[0]
    moments[-1] += right_turning * angles[-1] - field.moment
    (x, y), centres = tips, []
    for length, centre, angle in zip(chain.scaled.length, chain.scaled.centre, angles, strict=True):
        cosine, sine = algebra.cos(angle), algebra.sin(angle)
        arm, reach = number(centre) * algebra.length, number(length) * algebra.length
        centres.append((x + arm * cosine, y + arm * sine, cosine, sine, arm, reach))
        x, y = x + reach * cosine, y + reach * sine
    force_x, force_y = field.axial + field.tip[0], field.tip[1] - right * y
    if not field.idle or 0 < chain.scaled.supports[1][0] < math.inf:
        for i in range(chain.pieces - 1, -1, -1):
            cx, cy, cosine, sine, arm, reach = centres[i]
            mass = number(chain.scaled.mass[i]) * algebra.mass
            fx, fy = field.forces(mass, cx, cy)
            moments[i] += sine * (arm * fx + reach * force_x) - cosine * (arm * fy + reach * force_y)
            if not field.lag:
                inertia = number(chain.scaled.rotary_inertia[i]) * algebra.mass * algebra.length**2
                moments[i] += field.square_rate * inertia * sine * cosine
            force_x, force_y = force_x + fx, force_y + fy
    forces = {"x_0": zero, "y_0": left * tips[1] - force_y}
    return x, y, [*(forces[name] for name in tip_names(chain)), *(moments[i] for i in moving_pieces(chain))]


def _spring_moments(chain: Chain, angles: Sequence[Any], algebra: Algebra) -> list[Any]:
    moments: list[Any] = [algebra.number(0)] * chain.pieces
    for j, stiffness in enumerate(chain.scaled.joint_stiffness):
        moment = algebra.number(stiffness) * algebra.stiffness * (angles[j + 1] - angles[j])
        moments[j] -= moment
        moments[j + 1] += moment
    return moments


def _support_units(chain: Chain, algebra: Algebra) -> list[tuple[Any, Any]]:
    """Return K_t and K_r of both ends, zero where an end holds and no motion feels its stiffness."""
    translation = algebra.stiffness / algebra.length**2
    return [
        (
            algebra.number(0 if end[0] == math.inf else end[0]) * translation,
            algebra.number(0 if end[1] == math.inf else end[1]) * algebra.stiffness,
        )
        for end in chain.scaled.supports
    ]


@dataclass(frozen=True, repr=False, eq=False)
class Energies(Shown):
    """Kinetic and potential energy, and the closures c(q), all zero on an admissible configuration."""

    kinetic: Any
    potential: Any
    closures: list[Any]


@dataclass(frozen=True)
class _MotionTerms:
    """The terms of  M(q) q'' + h(q, q') + s(q) = (∂c/∂q)ᵀ λ,  as nested lists of the algebra's values."""

    mass_matrix: list[list[Any]]
    velocity_terms: list[Any]
    static_forces: list[Any]
    closures: list[Any]


def _inertia_coefficients(chain: Chain) -> tuple[list[list[Number]], list[Number], Number]:
    """Return a_ij and the first moments s_j of the moving pieces, and the chain's mass, in its own units.

    With μ_j the mass to the right of piece j and c_j its centre of mass from its left tip,

        s_j = l_j μ_j + c_j m_j,   a_ij = l_i s_j (i left of j),   a_jj = J_j + m_j c_j² + l_j² μ_j.

    s_j is what turning piece j moves: the mass times distance that its turning carries along.
    """
    length, mass, inertia = chain.scaled.length, chain.scaled.mass, chain.scaled.rotary_inertia
    moving, centre = moving_pieces(chain), chain.scaled.centre
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
    chain: Chain,
    q: Sequence[Any],
    u: Sequence[Any],
    algebra: Algebra,
    load: Load | None = None,
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
    held_chain_load(chain, checked_load(load))
    (tip, angle), (tip_speed, spin) = unpack(chain, q), unpack(chain, u)
    kinetic, potential, (x, y) = piece_energies(chain, tip, tip_speed, angle, spin, algebra, load)
    return Energies(kinetic, potential, end_closures(chain, x, y, algebra))


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

    From position and velocity of the left tip, angles and rates of all pieces, held ones included, and
    deflection and angle of the base on which the elastic supports stand.
    """
    number, length_unit = algebra.number, algebra.length
    (x, y), (x_speed, y_speed) = tip, tip_speed
    twice_kinetic: Any = number(0)
    field = _LoadField.of(chain, load, algebra)
    work: Any = number(0)
    for i in range(chain.pieces):
        mass = number(chain.scaled.mass[i]) * algebra.mass
        inertia = number(chain.scaled.rotary_inertia[i]) * algebra.mass * length_unit**2
        length, centre = (number(v[i]) * length_unit for v in (chain.scaled.length, chain.scaled.centre))
        cosine, sine = algebra.cos(angle[i]), algebra.sin(angle[i])
        vx, vy = x_speed - centre * sine * spin[i], y_speed + centre * cosine * spin[i]
        twice_kinetic += mass * (vx**2 + vy**2) + inertia * spin[i] ** 2
        work += field.work(mass, inertia, x + centre * cosine, y + centre * sine, cosine)
        x_speed, y_speed = x_speed - length * sine * spin[i], y_speed + length * cosine * spin[i]
        x, y = x + length * cosine, y + length * sine
    twice_potential: Any = number(0)
    for j, stiffness in enumerate(chain.scaled.joint_stiffness):
        twice_potential += number(stiffness) * algebra.stiffness * (angle[j + 1] - angle[j]) ** 2
    for (translation, turning), deflection, rotation in zip(
        _support_units(chain, algebra), (tip[1], y), (angle[0], angle[-1]), strict=True
    ):
        twice_potential += translation * (deflection - base[0]) ** 2 + turning * (rotation - base[1]) ** 2
    work += field.axial * (x - tip[0]) + field.tip[0] * x + field.tip[1] * y + field.moment * angle[-1]
    return twice_kinetic / 2, twice_potential / 2 - work, (x, y)


def motion_terms(
    chain: Chain, q: Sequence[Any], u: Sequence[Any], algebra: Algebra, load: Load | None = None
) -> _MotionTerms:
    """Return the terms of the equations of motion in coordinates `q` and speeds `u`."""
    moving = moving_pieces(chain)
    tips = len(q) - len(moving)
    angle, spin = q[tips:], u[tips:]
    sine = [algebra.sin(value) for value in angle]
    cosine = [algebra.cos(value) for value in angle]
    mass_matrix, velocity = _angle_terms(chain, angle, spin, algebra)
    _, moments, total = _inertia_coefficients(chain)
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
    return _MotionTerms(mass_matrix, velocity, static, end_closures(chain, x, y, algebra))


def _angle_terms(
    chain: Chain, angle: Sequence[Any], spin: Sequence[Any], algebra: Algebra
) -> tuple[list[list[Any]], list[Any]]:
    """Return  a_ij cos(θ_i - θ_j)  and  Σ_j a_ij sin(θ_i - θ_j) θ_j'²."""
    coefficients, _, _ = _inertia_coefficients(chain)
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


def end_closures(chain: Chain, x: Any, y: Any, algebra: Algebra, span: Pair | None = None) -> list[Any]:
    """Return what the right end holds of its tip (x, y): see the module's notes on both ends held."""
    right = chain.boundary.right
    if span is not None:
        return [x - span[0], y - span[1]]
    whole = sum(chain.scaled.length, start=chain.scaled.length[0] * 0)
    held = right.is_grounded and _axially_free_left(chain)
    axial = [x - algebra.number(whole) * algebra.length] if held else []
    return [*axial, *([y] if right.holds_deflection else [])]
