"""Modes with shear and rotary inertia of a beam that varies or is loaded, from strains at Gauss points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.spectral_beam import AGREEMENT, disagreement, growing_grids, modes_of
from beammodes.exact.spectral_energy import body_rows, motions_between, with_tension
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values
from beammodes.exact.spectral_tension import Tension, in_plane, square_spin, straight_load, tension_of
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.problem.profiles import value_at

__all__ = ["SpectralShear", "spectral_shear"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SpectralShear:
    """Mode shapes of a beam with L = mean EI = mean ρA = 1: κ and γ at the grid's points, y(0) and θ(0)."""

    grid: Grid
    motions: Floats

    def values(self, x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return y, θ, κ and γ at positions 0 to 1, each of shape (modes, positions)."""
        grid, points = self.grid, len(self.grid.x)
        bending, shear = self.motions[:points], self.motions[points : 2 * points]
        found = np.empty((4, self.motions.shape[1], len(x)))
        section = np.clip(np.searchsorted(grid.edges, x, side="right") - 1, 0, len(grid.sizes) - 1)
        first, (deflection, rotation) = 0, self.motions[-2:]
        for s, size in enumerate(grid.sizes):
            low, half = grid.edges[s], 0.5 * (grid.edges[s + 1] - grid.edges[s])
            part, here = slice(first, first + size), section == s
            to_series = legendre_of_values(size)
            curvature, strain = to_series @ bending[part], to_series @ shear[part]
            turning = half * legendre_integral(curvature)
            turning[0] += rotation
            slope = np.vstack((strain, np.zeros((1, strain.shape[1])))) + turning
            lifting = half * legendre_integral(slope)
            lifting[0] += deflection
            at = (x[here] - low) / half - 1.0
            for kind, series in enumerate((lifting, turning, curvature, strain)):
                found[kind][:, here] = np.polynomial.legendre.legval(at, series)
            arm = grid.weight[part] * (grid.edges[s + 1] - grid.x[part])
            deflection = deflection + 2.0 * half * rotation + arm @ bending[part]
            deflection = deflection + grid.weight[part] @ shear[part]
            rotation, first = rotation + grid.weight[part] @ bending[part], first + size
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
        motions = motions_between(beam, boundary, _strains(beam, grid), _end_rows(grid), tension)
        free = with_tension(motions, tension, loaded)
        rigid = free.rigid.shape[1]
        size, found = modes_of(free, _kinetic_rows(beam, boundary, grid), count)
        omega, share = in_plane(1.0 / size, rigid, boundary, loaded, square)
        change = float(np.max(np.abs(omega / previous - 1.0)))
        if change <= max(AGREEMENT, 1e-14 / free.margin, 1e-13 / share):
            return omega, rigid, SpectralShear(grid, found * _signs(found, grid, boundary))
        previous, reached = omega, min(reached, change)
    raise disagreement(reached)


def _strains(beam: Beam, grid: Grid) -> Floats:
    """Return the curvatures and shear strains that store ½ |w|²; without shear there are no such strains."""
    assert beam.shear_stiffness is not None
    shear = value_at(beam.shear_stiffness, grid.x * beam.length)
    relative = shear / beam.mean_bending_stiffness * beam.length**2
    compliance = 1.0 / np.sqrt(np.concatenate((grid.weight * grid.stiffness, grid.weight * relative)))
    return np.asarray(np.diag(compliance)[:, compliance > 0.0])


def _end_rows(grid: Grid) -> Floats:
    """Return y(0), θ(0), y(1), θ(1) and y(1) - y(0) as rows over a motion, shape (5, 2 points + 2)."""
    none, moment = np.zeros_like(grid.x), grid.weight * (1.0 - grid.x)
    bent = np.array([none, none, moment, grid.weight, moment])
    sheared = np.array([none, none, grid.weight, none, grid.weight])
    straight = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 1.0], [0.0, 1.0]])
    return np.hstack((bent, sheared, straight))


def _kinetic_rows(beam: Beam, boundary: Boundary, grid: Grid) -> Floats:
    points = len(grid.x)
    ones = np.ones((points, 1))
    deflection = np.hstack((grid.deflection, grid.slope, ones, grid.x[:, None]))
    rotation = np.hstack((grid.slope, np.zeros((points, points + 1)), ones))
    moved = np.sqrt(grid.weight * grid.mass)[:, None] * deflection
    # Rows of zeros too, where nothing resists a turn: the singular values need as many rows as columns.
    turned = np.sqrt(grid.weight * grid.rotary)[:, None] * rotation
    return np.vstack((moved, turned, body_rows(beam, boundary, _end_rows(grid))))


def _tension(tension: Tension, grid: Grid) -> Tension:
    """Return a tension that does its work on y' = θ + γ along the beam, on the bodies' θ at its ends."""
    sheared = np.vstack((np.eye(len(grid.x)), np.zeros((2, len(grid.x)))))
    return Tension(tension.pull, np.hstack((tension.row[:, :-2], sheared, tension.row[:, -2:])))


def _signs(motions: Floats, grid: Grid, boundary: Boundary) -> Floats:
    values = SpectralShear(grid, motions).values(np.zeros(1))
    first = int(boundary.left.holds_deflection) * (1 + int(boundary.left.holds_rotation))
    return np.where(values[first][:, 0] < 0.0, -1.0, 1.0)
