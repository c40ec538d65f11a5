"""Exact twist and stretch of a beam that varies along it: polynomials on each smooth part, to convergence.

By Rayleigh and Ritz with continuous polynomials of degree p on parts between which the beam is smooth,

    ½ ∫ k u'² dx + ½ Σ K u_s² = |A u|²/2,        ½ ∫ m u² dx + ½ Σ J u_s² = |B u|²/2,

where Gauss's rule makes rows of A and B. With B = QR the singular values of A R⁻¹ are ω: no matrix is
squared. Two degrees must agree; else parts are halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from beammodes.checks import whole_number
from beammodes.exact.axial_beam import AxialModes
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.beam import Beam, each_place_once, positions_on
from beammodes.problem.motions import MOTIONS
from beammodes.problem.profiles import profile_parts, value_at

__all__ = ["VaryingAxialModes", "varying_axial_modes"]

#: Relative agreement of two degrees that counts as convergence.
_AGREE = 1e-11
_DEGREES, _MOST_MODES, _HALVINGS = (18, 24), 100, 4


@dataclass(frozen=True, eq=False, repr=False)
class VaryingAxialModes(AxialModes):
    """Exact elastic modes of a beam that varies along it, in twist or stretch, of unit modal mass.

    Attributes
    ----------
    edges : ndarray [m]
        Between which shapes are polynomials.
    values : ndarray, shape (modes, nodes)
        At the Legendre-Lobatto points of all parts, ends of parts once.
    """

    edges: Floats
    values: Floats

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes u, angle or shift, or du/dx, at positions from 0 to L.

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not 0 or 1.
        """
        order = whole_number("derivative", derivative, least=0, most=1)
        position = positions_on(self.beam, x)
        flat = position.ravel()
        part = np.clip(np.searchsorted(self.edges, flat, side="right") - 1, 0, len(self.edges) - 2)
        degree = (self.values.shape[1] - 1) // (len(self.edges) - 1)
        width = np.diff(self.edges)[part]
        local = 2.0 * (flat - self.edges[part]) / width - 1.0
        rows = _basis(degree, local)[order] * (2.0 / width[:, None]) ** order
        nodes = part[:, None] * degree + np.arange(degree + 1)
        found: Floats = np.einsum("xn,mxn->mx", rows, self.values[:, nodes])
        return found.reshape(len(self.values), *position.shape)


def _lobatto(degree: int) -> Floats:
    inner = legendre.Legendre.basis(degree).deriv().roots()
    return np.concatenate([[-1.0], np.sort(np.real(inner)), [1.0]])


def _basis(degree: int, x: Floats) -> tuple[Floats, Floats]:
    """Return values and derivatives at x of the polynomials that are 1 at one Lobatto point, 0 at others."""
    to_nodal = np.linalg.inv(legendre.legvander(_lobatto(degree), degree))
    slopes = np.zeros((len(x), degree + 1))
    for k in range(1, degree + 1):
        slopes[:, k] = legendre.legval(x, legendre.legder(np.eye(degree + 1)[k]))
    return legendre.legvander(x, degree) @ to_nodal, slopes @ to_nodal


def varying_axial_modes(beam: Beam, boundary: AxialBoundary, modes: int) -> VaryingAxialModes:
    """Return the exact first elastic modes; `axial_modes` is the door to it.

    Right to 1e-10 or better: two degrees agree within 1e-11.

    Raises
    ------
    ValueError
        For more than 100 modes.
    ArithmeticError
        If polynomials do not settle.

    Examples
    --------
    A cone, GJ and ρIp both as (1 + x)²: u = sin(πx)/(1 + x) between fixed ends, and ω = π, 2π.

    >>> cone = Beam(1.0, 1.0, 1.0, torsional_stiffness=lambda x: (1 + x)**2,
    ...             polar_inertia_per_length=lambda x: (1 + x)**2)
    >>> varying_axial_modes(cone, AxialBoundary.of("fixed-fixed"), 2).angular_frequency / np.pi
    array([1., 2.])
    """
    count = whole_number("modes", modes, most=_MOST_MODES)
    stiffness, inertia = MOTIONS[boundary.motion].numbers(beam)
    inside = sorted((*profile_parts(stiffness, beam.length), *profile_parts(inertia, beam.length)))
    edges = np.array([0.0, *each_place_once(inside, beam.length), beam.length])
    # So many halves that a part has a few waves at most.
    for _ in range(max(0, int(np.ceil(np.log2(max(1.0, count / 4 / (len(edges) - 1))))))):
        edges = _halved(edges)
    for _ in range(_HALVINGS):
        coarse, fine = (_solved(beam, boundary, edges, degree, count) for degree in _DEGREES)
        if np.all(np.abs(coarse[0] - fine[0]) <= _AGREE * fine[0]):
            omega, values = fine
            unit = MOTIONS[boundary.motion].frequency_unit(beam)
            return VaryingAxialModes(beam, boundary, omega / unit, omega, edges, values)
        edges = _halved(edges)
    raise ArithmeticError(
        f"modes of {boundary.name} in {boundary.motion} did not settle within {_AGREE}: mark the beam's "
        "kinks and steps by breaks="
    )


def _halved(edges: Floats) -> Floats:
    return np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])]))


def _solved(
    beam: Beam, boundary: AxialBoundary, edges: Floats, degree: int, count: int
) -> tuple[Floats, Floats]:
    """Return ω and values at the nodes, of unit modal mass."""
    stiffness, inertia = MOTIONS[boundary.motion].numbers(beam)
    points, weights = legendre.leggauss(degree + 8)
    value, slope = _basis(degree, points)
    parts, nodes = len(edges) - 1, (len(edges) - 1) * degree + 1
    stored, carried = np.zeros((2, parts * len(points) + 2, nodes))
    for i, (low, high) in enumerate(pairwise(edges.tolist())):
        half = 0.5 * (high - low)
        x = low + half * (1.0 + points)
        rows = slice(i * len(points), (i + 1) * len(points))
        columns = slice(i * degree, (i + 1) * degree + 1)
        stored[rows, columns] = np.sqrt(weights / half * value_at(stiffness, x))[:, None] * slope
        carried[rows, columns] = np.sqrt(weights * half * value_at(inertia, x))[:, None] * value
    kept = np.ones(nodes, dtype=bool)
    for end, row, node in ((boundary.left, -2, 0), (boundary.right, -1, -1)):
        kept[node] = not end.is_fixed
        if not end.is_fixed:
            stored[row, node], carried[row, node] = np.sqrt(end.stiffness), np.sqrt(end.inertia)
    root: Floats = np.asarray(np.linalg.qr(carried[:, kept])[1])
    _, omega, turn = np.linalg.svd(np.linalg.solve(root.T, stored[:, kept].T).T, full_matrices=False)
    order = np.argsort(omega)[boundary.rigid_body_modes :][:count]
    values = np.zeros((len(order), nodes))
    values[:, kept] = np.linalg.solve(root, turn[order].T).T
    first = values[:, 1] if boundary.left.is_fixed else values[:, 0]
    return omega[order], values * np.where(first < 0.0, -1.0, 1.0)[:, None]
