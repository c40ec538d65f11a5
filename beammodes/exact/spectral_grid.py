"""Gauss points along the smooth sections of a beam, and deflection and slope there from curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beammodes.problem.beam import Beam
from beammodes.problem.profiles import Profile, value_at

__all__ = ["Grid", "legendre_integral", "legendre_of_values", "section_grid"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Gauss points of a beam with L = mean EI = mean ρA = 1, and what its curvature there makes.

    Curvature is a polynomial on each section. With z'' = κ and z(0) = z'(0) = 0, κ_i the curvature at point
    i, the integrals of that polynomial are

        z'(x_i) = Σ slope_ij κ_j,      z(x_i) = Σ deflection_ij κ_j.

    Parameters
    ----------
    edges : ndarray, shape (sections + 1,)
        0, the beam's breaks and 1.
    sizes : tuple of int
        Points in each section.
    x, weight : ndarray, shape (points,)
        Gauss-Legendre positions and weights.
    stiffness, mass, rotary : ndarray, shape (points,)
        EI, ρA and ρI there.
    slope, deflection : ndarray, shape (points, points)
        The two integrals.
    """

    edges: Floats
    sizes: tuple[int, ...]
    x: Floats
    weight: Floats
    stiffness: Floats
    mass: Floats
    rotary: Floats
    slope: Floats
    deflection: Floats


def section_grid(beam: Beam, points: int, least: int) -> Grid:
    """Return the grid of a beam: so many points shared out by length, and at least so many in each section.

    Raises
    ------
    ValueError
        If a function among the beam's properties is not greater than 0 at a point.

    Examples
    --------
    >>> grid = section_grid(Beam(2.0, [3.0, 1.0], 1.0), points=8, least=6)
    >>> grid.sizes, round(float(grid.weight.sum()), 12), grid.stiffness[0].item()
    ((10, 10), 1.0, 1.5)
    """
    edges = np.array([0.0, *beam.breaks, beam.length]) / beam.length
    sizes = tuple(least + math.ceil(points * width) for width in np.diff(edges).tolist())
    x, weight, slope, deflection = _integrals(edges, sizes)
    length, stiffness, mass = beam.length, beam.mean_bending_stiffness, beam.mean_mass_per_length
    at = x * length
    return Grid(
        edges=edges,
        sizes=sizes,
        x=x,
        weight=weight,
        stiffness=_positive("bending_stiffness", beam.bending_stiffness, at) / stiffness,
        mass=_positive("mass_per_length", beam.mass_per_length, at) / mass,
        rotary=_positive("rotary_inertia_per_length", beam.rotary_inertia_per_length, at) / mass / length**2,
        slope=slope,
        deflection=deflection,
    )


def _integrals(edges: Floats, sizes: tuple[int, ...]) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the grid's x, weight, slope and deflection."""
    x, weight = np.empty(sum(sizes)), np.empty(sum(sizes))
    slope, deflection = np.zeros((len(x), len(x))), np.zeros((len(x), len(x)))
    starts = np.cumsum((0, *sizes)).tolist()
    parts = [slice(*ends) for ends in pairwise(starts)]
    for part, size, low, high in zip(parts, sizes, edges[:-1], edges[1:], strict=True):
        half = 0.5 * float(high - low)
        node, plain = np.polynomial.legendre.leggauss(size)
        x[part], weight[part] = low + half * (1.0 + node), half * plain
        once = legendre_integral(legendre_of_values(size))
        slope[part, part] = half * np.polynomial.legendre.legval(node, once).T
        twice = legendre_integral(once)
        deflection[part, part] = half**2 * np.polynomial.legendre.legval(node, twice).T
    for part in parts:
        # Points of later sections see all of this one: its integral, and its moment about them.
        later = slice(part.stop, None)
        slope[later, part] = weight[part]
        deflection[later, part] = weight[part] * (x[later, None] - x[part])
    return x, weight, slope, deflection


def legendre_of_values(size: int) -> Floats:
    """Return the matrix that takes values at Gauss points to Legendre coefficients, shape (size, size)."""
    node, weight = np.polynomial.legendre.leggauss(size)
    values = np.polynomial.legendre.legvander(node, size - 1)
    matrix: Floats = (np.arange(size) + 0.5)[:, None] * values.T * weight
    return matrix


def legendre_integral(series: Floats) -> Floats:
    """Return the Legendre coefficients, along the first axis, of the integral that is zero at -1."""
    return np.asarray(np.polynomial.legendre.legint(series, lbnd=-1, axis=0), dtype=np.float64)


def _positive(name: str, profile: Profile, x: Floats) -> Floats:
    values: Floats = value_at(profile, x)
    may_vanish = name == "rotary_inertia_per_length"
    wrong = ~((values > 0.0) | ((values == 0.0) & may_vanish)) | ~np.isfinite(values)
    if wrong.any():
        at, bound = int(np.argmax(wrong)), "not negative" if may_vanish else "greater than 0"
        raise ValueError(f"{name} must be finite and {bound}, got {values[at]} at x = {x[at]}")
    return values
