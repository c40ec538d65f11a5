"""Frequencies and mode shapes of a beam that may vary along it, from its curvature at Gauss points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import whole_number
from beammodes.exact.printed_modes import EulerBernoulliModes, Theory
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values
from beammodes.problem.beam import Beam
from beammodes.problem.beam_positions import positions_on
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load

__all__ = ["SpectralBeamModes", "values_of_motions"]

Floats = NDArray[np.float64]


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
        What loads it.
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of elastic modes 1, 2, ..., read-only; as seen from the hub if it turns.
    rigid_body_modes : int
        How many modes of zero frequency come before them: 0, 1 or 2.
    agreement : float [-]
        Largest relative change of a frequency between the last two degrees of the polynomials.
    grid : Grid
        The points of the last degree.
    motions : ndarray, shape (coordinates + 2, modes)
        The grid's coordinates, y and y' at x = 0, of a beam with L = mean EI = mean ρA = 1.
    theory : Theory, optional
        What tells the theory's own error; `euler_bernoulli` gives it.

    Examples
    --------
    >>> from beammodes.exact.spectral_beam import spectral_modes
    >>> modes = spectral_modes(Beam(2.0, lambda x: (1.0 - 0.25 * x) ** 3, lambda x: 1.0 - 0.25 * x),
    ...                        "clamped-free", 2)
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
    grid: Grid
    motions: Floats
    theory: Theory | None = None

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes φ, or a derivative dᵏφ/dxᵏ of them.

        Parameters
        ----------
        x : float or array [m]
            Positions, 0 to L; at a step of EI curvature is that on its right.
        derivative : int
            k, 0 to 2: deflection, slope or curvature.

        Returns
        -------
        ndarray, shape (modes, *x.shape) [kg^(-1/2) m^(-k)]

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not a whole number in 0..2.

        Examples
        --------
        >>> from beammodes.exact.spectral_beam import spectral_modes
        >>> round(float(spectral_modes(Beam.unit(), "clamped-free", 1).shape(1.0)[0]), 12)
        2.0
        """
        order = whole_number("derivative", derivative, least=0, most=2)
        position = positions_on(self.beam, x)
        unit = math.sqrt(self.beam.mean_mass_per_length) * math.sqrt(self.beam.length)
        place = position.ravel() / self.beam.length
        shapes = values_of_motions(self.grid, self.motions, place, order) / unit / self.beam.length**order
        return shapes.reshape(len(shapes), *position.shape)


def values_of_motions(grid: Grid, motions: Floats, x: Floats, order: int) -> Floats:
    """Return a derivative of the motions at positions 0 to 1, shape (motions, positions)."""
    curvature = grid.curvature @ motions[:-2]
    cell = np.clip(np.searchsorted(grid.edges, x, side="right") - 1, 0, len(grid.sizes) - 1)
    ends = np.concatenate(([0], np.cumsum(grid.sizes)))
    values = np.empty((motions.shape[1], len(x)))
    width = np.diff(grid.edges)
    weighted = grid.weight[:, None] * curvature
    arm = (np.repeat(grid.edges[1:], grid.sizes) - grid.x)[:, None]
    turn, rise = (np.add.reduceat(part, ends[:-1]) for part in (weighted, arm * weighted))
    # Slope and deflection at every cell's beginning.
    slope = motions[-1] + np.cumsum(turn, axis=0) - turn
    rise = rise + width[:, None] * slope
    deflection = motions[-2] + np.cumsum(rise, axis=0) - rise
    for at in np.unique(cell).tolist():
        here, size, half = cell == at, int(grid.sizes[at]), 0.5 * width[at]
        series = legendre_of_values(size) @ curvature[ends[at] : ends[at + 1]]
        for start in (slope[at], deflection[at])[: 2 - order]:
            series = half * legendre_integral(series)
            series[0] += start
        values[:, here] = np.polynomial.legendre.legval((x[here] - grid.edges[at]) / half - 1.0, series)
    return values
