"""Exact modes and buckling load of beams that vary or are loaded, from strains at Gauss points."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from beammodes.checks import shown, whole_number
from beammodes.exact.exact_beam import EulerBernoulliModes, Theory, first_free
from beammodes.exact.spectral_energy import (
    Motions,
    Strains,
    in_plane,
    kinetic_rows,
    slope_rows,
    square_spin,
    straight_load,
    supported_motions,
    tension_of,
    with_tension,
)
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values, section_grid
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

__all__ = [
    "AGREEMENT",
    "SpectralBeamModes",
    "SpectralShapes",
    "spectral_buckling",
    "spectral_modes",
    "spectral_solution",
]

#: Largest relative change of a frequency between the last two degrees of the polynomials.
AGREEMENT = 1e-11


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SpectralBeamModes(EulerBernoulliModes):
    """The first elastic modes of a beam, uniform or not; `spectral_modes` makes it.

    Mode shapes have unit modal mass, ∫ρA φₘφₙ + ∫ρI φₘ'φₙ' + the end bodies' share = 1 if m = n, else 0, and
    the sign that makes the first of φ, φ', φ'' that is not held positive at x = 0.

    Parameters
    ----------
    beam : Beam
        The beam.
    boundary : Boundary
        Its ends, at x = 0 and at x = L.
    load : Load
        Its load.
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of elastic modes 1, 2, ..., read-only; as seen from the hub if it turns.
    rigid_body_modes : int
        How many modes of zero frequency come before them: 0, 1 or 2.
    agreement : float [-]
        Largest relative change of a frequency between the last two degrees of the polynomials.
    shapes : SpectralShapes
        Of a beam with L = mean EI = mean ρA = 1.
    theory : Theory, optional
        The theory's own error; `euler_bernoulli` gives it.

    Examples
    --------
    >>> import beammodes as bm
    >>> cone = bm.Beam(2.0, lambda x: (1.0 - 0.25 * x) ** 3, lambda x: 1.0 - 0.25 * x)
    >>> modes = bm.euler_bernoulli(cone, "clamped-free", 2)
    >>> modes.shape([0.0, 2.0]).round(4) + 0.0
    array([[ 0.    ,  1.9355],
           [ 0.    , -2.108 ]])
    """

    beam: Beam
    boundary: Boundary
    load: Load
    angular_frequency: Floats
    rigid_body_modes: int
    agreement: float
    shapes: SpectralShapes
    theory: Theory | None = None

    _smoothest = 2

    def _values(self, from_left: Floats, _: Floats, order: int) -> Floats:
        return self.shapes.values(from_left, order)


@dataclass(frozen=True, slots=True, eq=False)
class SpectralShapes:
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
    def of(cls, strains: Strains, motions: Floats) -> SpectralShapes:
        """Return the shapes of motions, a column each."""
        grid, bent = strains.grid, strains.grid.curvature.shape[1]
        return cls(grid, grid.curvature @ motions[:bent], strains.shear @ motions[bent:-2], motions[-2:])

    def values(self, x: Floats, quantity: int) -> Floats:
        """Return y, θ, κ or γ (0 to 3) at positions 0 to 1, shape (modes, positions)."""
        grid, width = self.grid, np.diff(self.grid.edges)
        cell = np.clip(np.searchsorted(grid.edges, x, side="right") - 1, 0, len(grid.sizes) - 1)
        ends = np.concatenate(([0], np.cumsum(grid.sizes)))
        arm = (np.repeat(grid.edges[1:], grid.sizes) - grid.x)[:, None]
        bent, sheared = grid.weight[:, None] * self.curvature, grid.weight[:, None] * self.strain
        turn, rise = (np.add.reduceat(part, ends[:-1]) for part in (bent, arm * bent + sheared))
        # Rotation and deflection at every cell's beginning.
        rotation = self.start[1] + np.cumsum(turn, axis=0) - turn
        rise = rise + width[:, None] * rotation
        deflection = self.start[0] + np.cumsum(rise, axis=0) - rise
        found = np.empty((self.curvature.shape[1], len(x)))
        for at in np.unique(cell).tolist():
            part, here, half = slice(ends[at], ends[at + 1]), cell == at, 0.5 * width[at]
            to_series = legendre_of_values(int(grid.sizes[at]))
            series = to_series @ (self.strain if quantity == 3 else self.curvature)[part]
            if quantity < 2:
                series = half * legendre_integral(series)
                series[0] += rotation[at]
            if quantity == 0:
                series[:-1] += to_series @ self.strain[part]
                series = half * legendre_integral(series)
                series[0] += deflection[at]
            place = (x[here] - grid.edges[at]) / half - 1.0
            found[:, here] = np.polynomial.legendre.legval(place, series)
        return found


def spectral_modes(
    beam: Beam, boundary: BoundaryLike, modes: int, load: Load | None = None
) -> SpectralBeamModes:
    """Return the first elastic modes, 1 to 100, of a beam whose properties may vary along it.

    (EI φ'')'' - (T φ')' = ω² (ρA φ - (ρI φ')')  with springs and rigid bodies at the ends; in the plane
    of rotation of a turning hub ω² + Ω² stands for ω². T is the tension that an axial force, gravity or a
    tip force along the beam, or a turning hub makes. In tension a rotation that nothing else resists is
    an elastic mode.

    Errors are about 1e-13; agreement to 1e-11 with polynomials of a second degree is required, with
    springs from 1e-12 to 1e12 EI/L³ and bodies from 1e-3 to 1e3 ρAL. Close to the buckling load 1e-14 /
    (1 - P / buckling load) is required instead, and in the plane of rotation 1e-13 (ω² + Ω²) / ω² of the
    first ω. Tables count as they are, kink by kink; functions are followed into features as wide as
    L/4096 (`problem.smooth_parts`), narrower ones with `breaks` beside them.

    Raises
    ------
    TypeError, ValueError
        If an argument is not as above, or the load bends the beam, buckles it, leaves its straight shape
        unstable in the plane of rotation, or pulls on it where nothing holds its left end.
    ArithmeticError
        If polynomials of growing degree do not agree, or a function has more steps, kinks and narrow
        features than can be followed.

    Examples
    --------
    >>> beam = Beam(1.2, bending_stiffness=[85.0, 40.0, 20.0], mass_per_length=0.62)
    >>> spectral_modes(beam, "clamped-free", 3).frequency.round(3)
    array([ 4.109, 20.497, 52.686])
    """
    pair, count = _checked(beam, boundary, modes)
    found = spectral_solution(beam, pair, count, checked_load(load))
    omega = found.relative_frequency * beam.frequency_unit
    omega.flags.writeable = False
    return SpectralBeamModes(
        beam, pair, found.load, omega, found.rigid_body_modes, found.agreement, found.shapes
    )


class Solution(NamedTuple):
    """Modes of a beam with L = mean EI = mean ρA = 1, told as `SpectralBeamModes` tells them."""

    load: Load
    relative_frequency: Floats
    rigid_body_modes: int
    agreement: float
    shapes: SpectralShapes


def spectral_solution(
    beam: Beam, pair: Boundary, count: int, load: Load, *, sheared: bool = False
) -> Solution:
    """Return the first elastic modes, as `spectral_modes` says; with shear, of Timoshenko's beam."""
    loaded, square = straight_load(beam, pair, load), square_spin(beam, load)
    previous, reached = np.full(count, np.inf), math.inf
    for grid in _growing_grids(beam, 2 * count + 8):
        strains = Strains.of(grid, sheared=sheared)
        tension = tension_of(beam, pair, strains, loaded)
        free = with_tension(supported_motions(beam, pair, strains, tension), tension, loaded)
        rigid = free.rigid.shape[1]
        size, motions = _modes_of(free, kinetic_rows(beam, pair, strains), count)
        omega, share = in_plane(1.0 / size, rigid, pair, loaded, square)
        change = float(np.max(np.abs(omega / previous - 1.0)))
        if change <= max(AGREEMENT, 1e-14 / free.margin, 1e-13 / share):
            start = SpectralShapes.of(strains, motions).values(np.zeros(1), first_free(pair.left))[:, 0]
            upright = motions * np.where(start < 0.0, -1.0, 1.0)
            return Solution(loaded, omega, rigid, change, SpectralShapes.of(strains, upright))
        previous, reached = omega, min(reached, change)
    raise _disagreement(reached)


def spectral_buckling(beam: Beam, boundary: BoundaryLike) -> float:
    """Return the smallest compression under which a straight beam buckles, the loads being dead [N].

    (EI y'')'' + P y'' = 0  with the springs of the ends, which must resist a rigid rotation.

    Examples
    --------
    >>> round(spectral_buckling(Beam.unit(), "pinned-pinned") / math.pi**2, 12)
    1.0
    """
    pair, _ = _checked(beam, boundary, 1)
    previous, reached = math.inf, math.inf
    for grid in _growing_grids(beam, 10):
        strains = Strains.of(grid, sheared=False)
        free = supported_motions(beam, pair, strains)
        if free.turns_freely:
            raise ValueError(f"boundary must resist a rigid rotation to have a buckling load, got {pair}")
        load = float(np.linalg.norm(slope_rows(beam, pair, strains) @ free.elastic, 2)) ** -2
        reached = min(reached, abs(load / previous - 1.0))
        if reached <= AGREEMENT:
            return load * beam.mean_bending_stiffness / beam.length**2
        previous = load
    raise _disagreement(reached)


def _checked(beam: Beam, boundary: BoundaryLike, modes: int) -> tuple[Boundary, int]:
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    return Boundary.of(boundary), whole_number("modes", modes, most=100)


def _growing_grids(beam: Beam, points: int) -> Iterator[Grid]:
    """Yield grids of ever more points, in every section."""
    for step in range(12):
        grid = section_grid(beam, math.ceil(points * 1.35**step), least=4 + 2 * step)
        if step > 1 and grid.curvature.shape[1] > 600 + 10 * min(len(grid.sizes), 100):
            return
        yield grid


def _disagreement(reached: float) -> ArithmeticError:
    """Return the error for polynomials of growing degree that came no closer than this."""
    return ArithmeticError(
        f"results agree to {reached:.1g} between polynomials of growing degree, not to {AGREEMENT:.0g}: "
        "does a property vary too much between the beam's breaks, or is a load so large that the beam bends "
        "next to its ends only?"
    )


def _modes_of(motions: Motions, kinetic: Floats, count: int) -> tuple[Floats, Floats]:
    """Return 1/ω, descending, and the motions of unit modal mass, of stored energy's largest kinetic ones."""
    momentum, elastic = kinetic @ motions.elastic, motions.elastic
    if motions.rigid.shape[1]:
        basis, factor = np.linalg.qr(kinetic @ motions.rigid)
        # Twice, because once leaves a rounding of what is taken away.
        for _ in range(2):
            share = basis.T @ momentum
            momentum = momentum - basis @ share
            elastic = elastic - motions.rigid @ np.linalg.solve(factor, share)
    size, direction = _singular(momentum)
    return size[:count], elastic @ direction[:, :count] / size[:count]


def _singular(matrix: Floats) -> tuple[Floats, Floats]:
    """Return singular values, descending, and right singular vectors as columns, by Jacobi's rotations.

    A soft support makes one long column. The usual algorithms leave errors of that column's size times 1e-16
    in all singular values, Jacobi's only of each one's own (Drmač and Veselić 2008, LAPACK's xGEJSV).
    """
    from scipy.linalg.lapack import dgejsv

    # Wanted: accuracy for rows and columns of any size, no left vectors, right ones, no shortcuts.
    size, _, direction, scale, _, info = dgejsv(matrix, joba=2, jobu=3, jobv=0, jobr=0, jobt=1, jobp=1)
    if info:
        raise ArithmeticError(f"singular values of {matrix.shape} numbers did not converge")
    return size * (scale[0] / scale[1]), direction
