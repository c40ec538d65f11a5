"""Which end quantities of a chain are coordinates, and which follow: see `beammodes.vibration.spectrum`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.pieces import Pieces
from beammodes.chains.repeated import floats

__all__ = ["EndCoordinates", "end_coordinates"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EndCoordinates:
    """The end quantities of a chain as coordinates beside its hinges' rotations.

    Attributes
    ----------
    root : ndarray, shape (supported,)
        1/√K of the quantities that are coordinates because springs support them.
    unstored : ndarray, shape (supported,)
        1 for one that no spring supports, but an axial force.
    tip_rows : tuple of two ndarrays, shape (supported + hinges,)
        y₀ and θ₀ from the coordinates' values.
    dependent_rows, dependent_stiffness : ndarray, shape (2, supported + hinges) and (2,)
        The other two quantities, and what supports them.
    rigid : list of (y₀, θ₀)
        The rigid-body modes.
    """

    root: Array
    unstored: Array
    tip_rows: tuple[Array, Array]
    dependent_rows: Array
    dependent_stiffness: Array
    rigid: list[tuple[float, float]]


def end_coordinates(pieces: Pieces, resistance: float = 0.0) -> EndCoordinates:
    """Return the end coordinates of a chain that runs from its firmer end.

    `resistance` is what loads along the chain put up against a rigid rotation.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> end_coordinates(Chain(Beam.unit(), "pinned-free", 2).pieces_and_springs).rigid     # turns about x = 0
    [(0.0, 1.0)]
    """
    length = floats(pieces.length)
    whole, reach = float(length.sum()), np.cumsum(length[:0:-1])[::-1]
    nothing = np.zeros_like(reach)
    # Rows: left deflection, left rotation, right deflection, right rotation.
    on_tip = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, whole], [0.0, 1.0]])
    on_hinges = np.array([nothing, nothing, reach, np.ones_like(reach)])
    stiffness = np.array([float(k) for end in pieces.supports for k in end])
    chosen, others = _chosen(stiffness * [whole**2, 1.0, whole**2, 1.0], on_tip)
    to_tip = np.linalg.inv(on_tip[chosen])
    scale, motions, unstored, rigid = [], [], [], []
    for k, motion in zip(chosen, to_tip.T, strict=True):
        resisted = resistance > 0 and motion[1] != 0
        if 0 < stiffness[k] < math.inf or (not stiffness[k] and resisted):
            # The size of a coordinate that no spring scales is free; this one suits the load's energy.
            scale.append(stiffness[k] or resistance)
            motions.append(motion)
            unstored.append(float(not stiffness[k]))
        elif not stiffness[k]:
            rigid.append((float(motion[0]), float(motion[1])))
    tip_rows = np.hstack([np.array(motions).reshape(-1, 2).T, -to_tip @ on_hinges[chosen]])
    dependent = on_tip[others] @ tip_rows
    dependent[:, len(motions) :] += on_hinges[others]
    return EndCoordinates(
        1 / np.sqrt(np.array(scale)),
        np.array(unstored),
        (tip_rows[0], tip_rows[1]),
        dependent,
        stiffness[others],
        rigid,
    )


def _chosen(stiffness: Array, on_tip: Array) -> tuple[list[int], list[int]]:
    """Return the two stiffest quantities that differ on the tip, left ones first, and the other two."""
    first, *rest = sorted(range(4), key=lambda k: -stiffness[k])
    second = next(k for k in rest if np.linalg.det(on_tip[[first, k]]))
    chosen = sorted([first, second])
    return chosen, [k for k in range(4) if k not in chosen]
