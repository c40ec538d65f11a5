"""The tip of an inextensible beam on a turning hub, by polynomials: no chain, no finite element.

The angle is  θ(s, t) = φ(t) + Σ q_i(t) s P_i(s),  φ the hub's and P_i Legendre's polynomials. Lagrange's
equations of

    T = ½ ρA ∫ |r'|² ds,      V = ½ EI ∫ (∂θ/∂s)² ds,      r = ∫ (cos θ, sin θ) ds

are integrated over time by DOP853, and along the beam at Gauss's points, where they converge faster than any
power of the degree. It is the judge of `spin_up_rivals` alone, and shares no equation with what it judges: so
it stands here, beside that benchmark, and not in the package.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

import beammodes as bm
from beammodes.dynamics.base_motion import Course
from beammodes.numerics.arrays import Floats

__all__ = ["tip_deflection"]


def tip_deflection(
    beam: bm.Beam, turning: Course, time: Floats, *, degree: int, tolerance: float = 1e-10
) -> Floats:
    """Return the right tip's distance from the line of the hub at ascending times from 0 [m].

    The beam is uniform, clamped at the centre of the hub, which begins at rest and at an angle of 0.
    `degree` is that of the angle along the beam.
    """
    from scipy.integrate import solve_ivp

    length = float(beam.length)
    points, weights = legendre.leggauss(2 * degree + 4)
    weights = weights * length / 2
    shape, slope = _shapes(degree, points, length)
    mass = float(beam.mass_per_length) * weights
    stiffness = float(beam.bending_stiffness) * (slope * weights) @ slope.T
    # Integrals from the hub to each point of the polynomial through the values at all of them.
    series = np.linalg.inv(legendre.legvander(points, len(points) - 1)).T
    reach = length / 2 * np.array([legendre.legval(points, legendre.legint(c, lbnd=-1)) for c in series]).T

    def rate(t: float, state: Floats) -> Floats:
        q, u = state[:degree], state[degree:]
        phi, turn, gain = (float(part[0]) for part in turning(np.array([t])))
        angle, spin = phi + q @ shape, turn + u @ shape
        normal, tangent = (
            np.array(each) for each in ((-np.sin(angle), np.cos(angle)), (np.cos(angle), np.sin(angle)))
        )
        # r'' = Σ q_i'' ∫ s P_i n + ∫ (φ'' n - θ'² t)
        moves = (shape * normal[:, None]) @ reach.T
        rest = (gain * normal - spin**2 * tangent) @ reach.T
        weighed = np.concatenate(list(moves), axis=1) * np.tile(mass, 2)
        matrix = weighed @ np.concatenate(list(moves), axis=1).T
        forces = weighed @ rest.ravel() + stiffness @ q
        return np.concatenate([u, -np.linalg.solve(matrix, forces)])

    span = 0.0, float(time[-1])
    start = np.zeros(2 * degree)
    found = solve_ivp(rate, span, start, "DOP853", t_eval=time, rtol=tolerance, atol=tolerance / 1000)
    return np.asarray(np.sin(found.y[:degree].T @ shape) @ weights)


def _shapes(degree: int, points: Floats, length: float) -> tuple[Floats, Floats]:
    """Return s P_i(s), i from 0, and its slope along the beam, at Gauss's points."""
    s, series = (points + 1) / 2, np.eye(degree)
    value = np.array([legendre.legval(points, each) for each in series])
    slope = np.array([legendre.legval(points, legendre.legder(each)) for each in series])
    return s * value, (value + 2 * s * slope) / length
