"""Tension along a straight beam from what pulls on it, and what of it bending and turning meet."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.spectral_grid import Grid
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load

__all__ = ["Tension", "buckled", "in_plane", "square_spin", "straight_load", "tension_of"]

Floats = NDArray[np.float64]


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
        """What pulls, altogether: the stiffness against turning the beam as one."""
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
    return load


def tension_of(beam: Beam, boundary: Boundary, grid: Grid, load: Load) -> Tension:
    """Return the tension of loads along a beam.

        T(x) = axial force + tip force + m p of the right end's body + ∫ ρA p ds from x to L,   p = g_x + Ω² X

    with X the distance from the axis of rotation. An end's body whose centre of mass lies at a beyond it
    resists turning with  Ω² J + a m p  at the right end and  Ω² J - a m p  at the left.

    Parameters
    ----------
    beam : Beam
    boundary : Boundary
    grid : Grid
        The beam's points.
    load : Load
        One that `straight_load` allows.

    Raises
    ------
    ValueError
        If it leaves the range of floating-point numbers.
    """
    length, bending, square = beam.length, beam.mean_bending_stiffness, square_spin(beam, load)
    gravity = float(load.weight[0]) / length / beam.frequency_unit / beam.frequency_unit
    tip = (float(load.axial_force) + float(load.tip[0])) / bending * length * length
    whole, hub, turning = beam.mean_mass_per_length * length, float(load.hub_radius) / length, []
    with np.errstate(over="ignore", invalid="ignore"):
        for end, outward, at in ((boundary.left, -1.0, 0.0), (boundary.right, 1.0, 1.0)):
            mass, inertia, offset = (float(number) for number in end.moving_body)
            arm = outward * offset / length
            force = mass / whole * (gravity + square * (hub + at + arm))
            turning.append(arm * force + square * (inertia / whole / length / length))
            tip += at * force
        spread = grid.mass * (gravity + square * (hub + grid.x))
        beyond = grid.weight @ spread - grid.integral(spread)
        pull = np.array([*(grid.weight * (tip + beyond)), *turning])
    if not np.isfinite(pull).all():
        raise ValueError(f"load must not leave the range of floating-point numbers for this beam, got {load}")
    return Tension(pull, _slopes(grid))


def _slopes(grid: Grid) -> Floats:
    """Return the slopes at the grid's points and at both ends, as rows over a motion."""
    turn = grid.weight @ grid.curvature
    bent = np.vstack((grid.slope, np.zeros_like(turn), turn))
    return np.hstack((bent, np.zeros((len(bent), 1)), np.ones((len(bent), 1))))


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


def buckled(load: Load) -> ValueError:
    """Return the error for loads that push too hard."""
    if load.is_axial:
        return ValueError(
            f"axial_force must not compress the beam beyond its buckling load, got {float(load.axial_force)}"
        )
    return ValueError(f"load must not buckle the straight beam, got {load}")
