"""Modes with shear and rotary inertia of a beam that varies or is loaded, from strains at Gauss points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.spectral_beam import AGREEMENT, disagreement, growing_grids, modes_of
from beammodes.exact.spectral_energy import (
    body_rows,
    compressed,
    motions_between,
    of_unit_energy,
    with_tension,
)
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values
from beammodes.exact.spectral_tension import Tension, in_plane, square_spin, straight_load, tension_of
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load

__all__ = ["SpectralShear", "spectral_shear"]

Floats = NDArray[np.float64]


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
        motions = motions_between(beam, boundary, _strains(grid), _end_rows(grid), tension)
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


def _end_rows(grid: Grid) -> Floats:
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
    return np.vstack((compressed(moved), compressed(turned), body_rows(beam, boundary, _end_rows(grid))))


def _tension(tension: Tension, grid: Grid) -> Tension:
    """Return a tension that does its work on y' = θ + γ along the beam, on the bodies' θ at its ends."""
    strain = _shear_strain(grid)
    sheared = np.vstack((strain, np.zeros((2, strain.shape[1]))))
    return Tension(tension.pull, np.hstack((tension.row[:, :-2], sheared, tension.row[:, -2:])))


def _signs(motions: Floats, grid: Grid, boundary: Boundary) -> Floats:
    values = SpectralShear.of(grid, motions).values(np.zeros(1))
    first = int(boundary.left.holds_deflection) * (1 + int(boundary.left.holds_rotation))
    return np.where(values[first][:, 0] < 0.0, -1.0, 1.0)
