"""Twist and stretch at rest: how far each place of a beam turns or shifts under loads, exactly.

With N the torque or axial force,  k u' = N,  and a load P at a place takes N down by P there. So

    u(x) = u(0) + N(0) F(x) - Σ P_i (F(x) - F(x_i)) over x_i < x,        F(x) = ∫ dx/k,

and the two ends give u(0) and N(0): a fixed one u = 0, a spring N = K u, -K u on the right, a free one N = 0.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import real, shown
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam, positions_on
from beammodes.problem.motions import MOTIONS, Motion
from beammodes.problem.profiles import integral_of_reciprocal

__all__ = ["axial_displacement"]


def axial_displacement(
    beam: Beam,
    boundary: AxialBoundaryLike,
    loads: Mapping[float, float],
    x: ArrayLike,
    *,
    motion: str | Motion = "twist",
) -> Floats:
    """Return how far a beam at rest turns or shifts at positions x under loads at places.

    Parameters
    ----------
    beam : Beam
        With its torsional_stiffness, or its axial_stiffness in stretch; they may vary along it.
    boundary : str, pair of words or AxialEnd, or AxialBoundary
        At least one end must hold the beam.
    loads : mapping from positions to loads [m] -> [N m] in twist, [N] in stretch
    x : float or array [m]
    motion : str
        "twist" or "stretch".

    Returns
    -------
    ndarray, of the shape of `x` [rad] or [m]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, a position lies outside the beam, or nothing holds it.

    Examples
    --------
    >>> shaft = Beam(1.2, 1.0, 1.0, torsional_stiffness=30e3)
    >>> torques = {0.0: 100.0, 0.4: -220.0, 0.7: -60.0}                                    # N m
    >>> axial_displacement(shaft, "free-fixed", torques, [0.0, 0.4, 0.7]).round(9)           # rad
    array([-0.00286667, -0.0042    , -0.003     ])
    """
    pair = AxialBoundary.of(boundary, motion)
    stiffness = MOTIONS[pair.motion].stiffness_of(beam)
    position = positions_on(beam, x)
    if not isinstance(loads, Mapping):
        raise TypeError(f"loads must map positions to loads, got {shown(loads)}")
    if pair.rigid_body_modes:
        raise ValueError(f"boundary must hold the beam under loads, got {pair.name}")
    places = np.array([real("position in loads", place, "m") for place in loads])
    force = np.array([real("load in loads", load, MOTIONS[pair.motion].load_unit) for load in loads.values()])
    if ((places < 0.0) | (places > beam.length)).any():
        raise ValueError(f"position in loads must be from 0 to {beam.length}, got {shown([*loads])}")
    edges = np.unique(np.concatenate([[0.0, beam.length], places, position.ravel()]))
    soft = np.concatenate([[0.0], np.cumsum(integral_of_reciprocal(stiffness, edges))])

    def softness(at: Floats) -> Floats:
        return np.asarray(soft[np.searchsorted(edges, at)])

    whole, of_loads = float(soft[-1]), softness(places)
    passed, turned = float(force.sum()), float(force @ (whole - of_loads))
    # Unknown: u(0) over the whole softness, and N(0). A spring's row is over 1 + K times that softness.
    rows, right = np.zeros((2, 2)), np.zeros(2)
    if pair.left.is_fixed:
        rows[0] = 1.0, 0.0
    else:
        share = pair.left.stiffness * whole
        rows[0] = np.array([share, -1.0]) / (1.0 + share)
    if pair.right.is_fixed:
        rows[1], right[1] = (1.0, 1.0), turned / whole
    else:
        share = pair.right.stiffness * whole
        rows[1] = np.array([share, 1.0 + share]) / (1.0 + share)
        right[1] = (passed + share * turned / whole) / (1.0 + share)
    start, carried = np.linalg.solve(rows, right)
    here = softness(position.ravel())
    beyond = np.maximum(here[:, None] - of_loads, 0.0) @ force if len(force) else 0.0
    return np.asarray(start * whole + carried * here - beyond).reshape(position.shape)
