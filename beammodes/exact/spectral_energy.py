"""Energies of a beam's motions, from strains at Gauss points, tension, supports and bodies.

Stored energy is made ½ |w|² by the choice of coordinates w, so that frequencies are the reciprocals of
singular values and no digits are lost to differences.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.exact.spectral_grid import Grid
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, check_no_hub
from beammodes.problem.loading import Load

__all__ = [
    "Motions",
    "Strains",
    "Tension",
    "in_plane",
    "kinetic_rows",
    "slope_rows",
    "square_spin",
    "straight_load",
    "supported_motions",
    "tension_of",
    "with_tension",
]

# A straight line α + βx at each end quantity: y(0), θ(0), y(1), θ(1), and in its mean slope.
_LINES = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 1.0], [0.0, 1.0]])
# Nearer to the buckling load rounding decides on which side of it a compression is.
_LEAST_MARGIN = 1e-13


@dataclass(frozen=True, slots=True, eq=False)
class Strains:
    """Linear maps from a beam's strains, y' = θ + γ and θ' = κ, to its motion.

    A motion is the coordinates of κ, those of γ, which has none without shear, y(0) and θ(0); rows are taken
    over motions.

    Parameters
    ----------
    grid : Grid
        The beam's points.
    shear : ndarray, shape (points, coordinates of γ)
        γ at the points by its coordinates.
    """

    grid: Grid
    shear: Floats

    @classmethod
    def of(cls, grid: Grid, *, sheared: bool) -> Strains:
        """Return bending alone, or with shear: as of curvature, with V/κGA for M/EI."""
        if not sheared:
            return cls(grid, np.zeros((len(grid.x), 0)))
        assert grid.shear is not None
        if grid.has_own_curvature:
            return cls(grid, grid.curvature)
        return cls(grid, grid.curvature * (grid.stiffness / grid.shear)[:, None])

    @property
    def rotation(self) -> Floats:
        """Rows of θ at the points."""
        ones = np.ones((len(self.grid.x), 1))
        return np.hstack((self.grid.slope, np.zeros_like(self.shear), np.zeros_like(ones), ones))

    @property
    def deflection(self) -> Floats:
        """Rows of y at the points."""
        grid = self.grid
        columns = [grid.deflection, grid.integrals(self.shear)] if self.shear.size else [grid.deflection]
        return np.hstack((*columns, np.ones((len(grid.x), 1)), grid.x[:, None]))

    @property
    def slope(self) -> Floats:
        """Rows of y' at the points."""
        bent = self.grid.curvature.shape[1]
        rows = self.rotation
        rows[:, bent : bent + self.shear.shape[1]] += self.shear
        return rows

    @property
    def ends(self) -> Floats:
        """Rows of y(0), θ(0), y(1), θ(1) and y(1) - y(0)."""
        grid = self.grid
        moment, turn = (grid.weight * (1.0 - grid.x)) @ grid.curvature, grid.weight @ grid.curvature
        shift, none = grid.weight @ self.shear, np.zeros_like(turn)
        bent = np.array([none, none, moment, turn, moment])
        still = np.zeros_like(shift)
        return np.hstack((bent, np.array([still, still, shift, still, shift]), _LINES))

    @property
    def of_unit_energy(self) -> Floats:
        """Coordinates, a column each, of strains that store ½ each and nothing together."""
        grid = self.grid
        bending = _of_unit_energy(grid, grid.stiffness, grid.curvature)
        if not self.shear.size:
            return bending
        assert grid.shear is not None
        rigid = np.isinf(grid.shear).all()
        shear = np.zeros_like(bending) if rigid else _of_unit_energy(grid, grid.shear, self.shear)
        none = np.zeros((len(bending), shear.shape[1]))
        both = np.block([[bending, none], [none.T, shear]])
        return np.asarray(both[:, np.abs(both).max(axis=0) > 0.0])


@dataclass(frozen=True, slots=True, eq=False)
class Tension:
    """The energy  ½ Σ pull_k (row_k · motion)²  of a beam with L = mean EI = mean ρA = 1.

    Parameters
    ----------
    pull : ndarray, shape (points + 2,)
        T times the weight at each of the grid's points, then what the two ends' bodies add; negative where
        something pushes.
    row : ndarray, shape (points + 2, coordinates + 2)
        The slopes there, as rows over a motion.
    """

    pull: Floats
    row: Floats

    @property
    def stiffness(self) -> float:
        """The sum of all pulls: the stiffness against turning the beam as one."""
        return float(np.maximum(self.pull, 0.0).sum())

    @property
    def mean_row(self) -> Floats:
        """The slope's mean, weighted by what pulls: the chord's slope under a uniform tension."""
        pulling = np.maximum(self.pull, 0.0)
        row: Floats = (pulling / pulling.sum() if pulling.any() else pulling) @ self.row
        # As it is, whatever the rounding of the weights: on a straight line slopes do not differ.
        row[-2:] = 0.0, 1.0
        return row

    @property
    def pulling_rows(self) -> Floats:
        """Rows D: what pulls stores  ½ |D · motion|²  besides that of the mean slope."""
        here = self.pull > 0.0
        return np.sqrt(self.pull[here])[:, None] * (self.row[here] - self.mean_row)

    @property
    def pushing_rows(self) -> Floats:
        """Rows D: what pushes releases  ½ |D · motion|²."""
        here = self.pull < 0.0
        return np.sqrt(-self.pull[here])[:, None] * self.row[here]


def straight_load(beam: Beam, boundary: Boundary, load: Load) -> Load:
    """Return `load`, or raise ValueError if the straight beam is not in equilibrium or not held under it."""
    if load.bends:
        raise ValueError(f"load must leave the straight beam in equilibrium, got {load}")
    if load.needs_hub and not boundary.left.is_grounded:
        raise ValueError(
            f"boundary must tie the left end to the ground or hub under {load}, got {boundary}: "
            "name the held end first"
        )
    if load.spin_rate and beam.has_rotary_inertia:
        raise ValueError("beam must have no rotary_inertia_per_length on a turning hub")
    if load.spin_rate:
        check_no_hub(boundary.left, boundary.right)
    return load


def tension_of(beam: Beam, boundary: Boundary, strains: Strains, load: Load) -> Tension:
    """Return the tension of loads along a beam.

        T(x) = axial force + tip force + m p of the right end's body + ∫ ρA p ds from x to L,   p = g_x + Ω² X

    with X the distance from the axis of rotation. An end's body whose centre of mass lies at a beyond it
    resists turning with  Ω² J + a m p  at the right end and  Ω² J - a m p  at the left; a hub of radius R
    with R times what pulls on it, besides.

    On the beam it does its work on y', on the bodies at its ends on θ.

    Raises
    ------
    ValueError
        If it leaves the range of floating-point numbers.
    """
    length, bending, square = beam.length, beam.mean_bending_stiffness, square_spin(beam, load)
    grid = strains.grid
    gravity = float(load.weight[0]) / length / beam.frequency_unit / beam.frequency_unit
    tip = (float(load.axial_force) + float(load.tip[0])) / bending * length * length
    whole, hub, turning = beam.mean_mass_per_length * length, float(load.hub_radius) / length, []
    applied, forces = tip, []
    with np.errstate(over="ignore", invalid="ignore"):
        for end, outward, at in ((boundary.left, -1.0, 0.0), (boundary.right, 1.0, 1.0)):
            mass, inertia, offset = (float(number) for number in end.moving_body)
            arm = outward * offset / length
            force = mass / whole * (gravity + square * (hub + at + arm))
            turning.append(arm * force + square * (inertia / whole / length / length))
            tip += at * force
            forces.append(force)
        spread = grid.mass * (gravity + square * (hub + grid.x))
        beyond = grid.weight @ spread - grid.integral(spread)
        left, right = _radii(beam, boundary)
        turning[0] += left * (tip + float(grid.weight @ spread) + forces[0])
        turning[1] += right * applied
        pull = np.array([*(grid.weight * (tip + beyond)), *turning])
    if not np.isfinite(pull).all():
        raise ValueError(f"load must not leave the range of floating-point numbers for this beam, got {load}")
    return Tension(pull, np.vstack((strains.slope, strains.ends[[1, 3]])))


def square_spin(beam: Beam, load: Load) -> float:
    """Return Ω² of a beam with L = mean EI = mean ρA = 1."""
    rate = float(load.spin_rate) / beam.frequency_unit
    return rate * rate


def in_plane(
    omega: Floats, rigid: int, boundary: Boundary, load: Load, square: float
) -> tuple[Floats, float]:
    """Return ω and what share of the first ω² is left where the beam moves in the plane of rotation, or 1.

    There a turning observer takes Ω² from every ω².

    Raises
    ------
    ValueError
        If nothing is left; the message names spin_rate.
    """
    if not square or load.plane == "flap":
        return omega, 1.0
    spin = math.sqrt(square)
    share = 0.0 if rigid else float((1.0 - spin / omega[0]) * (1.0 + spin / omega[0]))
    if share <= 1e-13:
        raise ValueError(
            f"spin_rate must be lower for {boundary} in the plane of rotation, where the straight shape is "
            f"unstable, got {float(load.spin_rate)}"
        )
    return np.asarray(np.sqrt((omega - spin) * (omega + spin))), share


def _buckled(load: Load) -> ValueError:
    """Return the error for loads that push too hard."""
    if load.is_axial:
        return ValueError(
            f"axial_force must not compress the beam beyond its buckling load, got {float(load.axial_force)}"
        )
    return ValueError(f"load must not buckle the straight beam, got {load}")


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """Motions of a beam with L = mean EI = mean ρA = 1, a column each.

    Parameters
    ----------
    elastic : ndarray, shape (coordinates + 2, columns)
        The motion elastic · w stores ½ |w|².
    rigid : ndarray, shape (coordinates + 2, rigid-body modes)
        Straight motions that store nothing.
    margin : float [-]
        Stored energy's least share that what pushes on the beam leaves: rounding grows as its reciprocal.
    """

    elastic: Floats
    rigid: Floats
    margin: float = 1.0

    @property
    def turns_freely(self) -> bool:
        """True where a rigid rotation stores nothing."""
        return bool(self.rigid[-1].any())


def supported_motions(
    beam: Beam, boundary: Boundary, strains: Strains, tension: Tension | None = None
) -> Motions:
    """Return the motions, stored energy being that of strains, supports and the tension on the mean slope.

    ½ ∫EI κ² + κGA γ² + ½ Σ K e²  over the end quantities e; what pulls stores ½ ∫T (mean of y')², besides
    what `with_tension` adds. Stiffnesses may span 24 decades and be infinite, so the two stiffest quantities
    that fix a straight line are coordinates, of compliance 1/√K, and the others change the identity by rank
    one each, the stiffest first: no stiffness is ever added to a smaller one.
    """
    strain, rows, lines = strains.of_unit_energy, strains.ends.copy(), _LINES.copy()
    for first, outward, radius in zip((0, 2), (-1.0, 1.0), _radii(beam, boundary), strict=True):
        # What is held is the axis of a hub.
        rows[first] += outward * radius * rows[first + 1]
        lines[first, 1] += outward * radius
    stiffness = _end_stiffness(beam, boundary)
    if tension is not None:
        stiffness[4], rows[4] = tension.stiffness, tension.mean_row
    order = sorted(range(5), key=lambda i: -stiffness[i])
    # Any second quantity will do except that two slopes leave the line free to shift.
    pair = [order[0], next(i for i in order[1:] if np.linalg.det(lines[[order[0], i]]) != 0.0)]
    line = np.linalg.inv(lines[pair])
    elastic = [np.vstack((strain, -line @ rows[pair, :-2] @ strain))]
    rigid = [np.zeros((len(strain) + 2, 0))]
    for quantity, alone in zip(pair, line.T, strict=True):
        straight = np.concatenate((np.zeros(len(strain)), alone))[:, None]
        if stiffness[quantity]:
            elastic.append(straight / math.sqrt(stiffness[quantity]))
        else:
            rigid.append(straight)
    motions = np.hstack(elastic)
    for quantity in order:
        if stiffness[quantity] and quantity not in pair:
            motions = _stiffened(motions, rows[quantity] @ motions, stiffness[quantity])
    return Motions(motions, np.hstack(rigid))


def with_tension(motions: Motions, tension: Tension, load: Load) -> Motions:
    """Return the motions with the energy ½ ∫T y'² counted; that of the mean slope is already, if T pulls.

    Raises
    ------
    ValueError
        If `load` pushes harder than the beam can bear; the message names it.
    """
    from scipy.linalg import solve_triangular

    stored, margin = motions.elastic, 1.0
    for rows, pulls in ((tension.pulling_rows, True), (tension.pushing_rows, False)):
        if not len(rows):
            continue
        slope = _compressed(rows) @ stored
        if pulls:
            factor = np.linalg.qr(np.vstack((np.eye(slope.shape[1]), slope)))[1]
        else:
            margin = 1.0 - float(np.linalg.norm(slope, 2)) ** 2
            if motions.turns_freely or margin <= _LEAST_MARGIN:
                raise _buckled(load)
            factor = np.linalg.cholesky(np.eye(slope.shape[1]) - slope.T @ slope).T
        stored = solve_triangular(factor, stored.T, trans="T").T
    return Motions(stored, motions.rigid, margin)


def slope_rows(beam: Beam, boundary: Boundary, strains: Strains) -> Floats:
    """Return rows G with |G · motion|² = ∫ y'² dx + Σ R θ² over hubs, of radius R."""
    radii = np.sqrt(_radii(beam, boundary))[:, None]
    rows = np.vstack((np.sqrt(strains.grid.weight)[:, None] * strains.slope, radii * strains.ends[[1, 3]]))
    return _compressed(rows)


def kinetic_rows(beam: Beam, boundary: Boundary, strains: Strains) -> Floats:
    """Return rows P with |P · motion|² = ∫ρA y² + ∫ρI θ² + Σ m (y ± aθ)² + Jθ² over the end bodies."""
    grid, ends, length = strains.grid, strains.ends, beam.length
    rows = [_compressed(np.sqrt(grid.weight * grid.mass)[:, None] * strains.deflection)]
    # With shear, rows of zeros too: the singular values need as many rows as columns.
    if grid.rotary.any() or strains.shear.size:
        rows.append(_compressed(np.sqrt(grid.weight * grid.rotary)[:, None] * strains.rotation))
    whole = beam.mean_mass_per_length * length
    for end, outward, first in ((boundary.left, -1.0, 0), (boundary.right, 1.0, 2)):
        mass, inertia, offset = (float(number) for number in end.moving_body)
        centre = ends[first] + outward * offset / length * ends[first + 1]
        rows.append(math.sqrt(mass / whole) * centre[None])
        rows.append(math.sqrt(inertia / whole) / length * ends[first + 1][None])
    return np.vstack(rows)


def _radii(beam: Beam, boundary: Boundary) -> list[float]:
    """Return the radius of the hub at either end over the beam's length."""
    return [float(end.hub_radius) / beam.length for end in (boundary.left, boundary.right)]


def _end_stiffness(beam: Beam, boundary: Boundary) -> list[float]:
    length, bending = beam.length, beam.mean_bending_stiffness
    stiffness = []
    for end in (boundary.left, boundary.right):
        stiffness.append(float(end.translational_stiffness) / bending * length**3)
        stiffness.append(float(end.rotational_stiffness) / bending * length)
    return [*stiffness, 0.0]


def _of_unit_energy(grid: Grid, stiffness: Floats, strain: Floats) -> Floats:
    """Return coordinates, a column each, of one kind of strain that store ½ each and nothing together."""
    if grid.has_own_curvature:
        return np.diag(1.0 / np.sqrt(grid.weight * stiffness))
    factor = np.linalg.qr(np.sqrt(grid.weight * stiffness)[:, None] * strain, mode="r")
    inverse: Floats = np.linalg.solve(factor, np.eye(len(factor)))
    return inverse


def _compressed(rows: Floats) -> Floats:
    """Return no more rows than columns of the same sums of products."""
    return rows if rows.shape[0] <= 2 * rows.shape[1] else np.asarray(np.linalg.qr(rows, mode="r"))


def _stiffened(motions: Floats, row: Floats, stiffness: float) -> Floats:
    """Return the motions with the energy ½ stiffness (row · w)² counted in ½ |w|².

    A reflection makes the row's direction a coordinate of its own: what a large stiffness leaves of it is not
    the difference of large numbers then. An infinite one leaves nothing.
    """
    size = float(np.linalg.norm(row))
    if size == 0.0:
        return motions
    unit = row / size
    one = int(np.argmax(np.abs(unit)))
    mirror = unit.copy()
    mirror[one] += math.copysign(1.0, unit[one])
    turned = motions - np.outer(motions @ mirror, mirror / abs(mirror[one]))
    if stiffness == math.inf:
        return np.delete(turned, one, axis=1)
    turned[:, one] = motions @ unit / math.hypot(1.0, math.sqrt(stiffness) * size)
    return turned
