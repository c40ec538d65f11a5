"""How a chain swings in its file: with the armature and dampers of its hinges, at the file's time step.

In undamped modes of unit modal mass hinges turn by  r = R p, and with their armature a and damping d

    (1 + Rᵀ a R) p'' + Rᵀ d R p' + Ω² p = 0.

Rigid-body motions turn no hinge, so they take no part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import FileStep
from beammodes.chains.chain import Chain
from beammodes.dynamics.damping_ratio import damped_pairs
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping, ModalDamping, damped_eigenvalues
from beammodes.vibration.integrators import fixed_step_integrator
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes
from beammodes.vibration.stability import modal_time_step, stable_time_step, taut_load

__all__ = ["damping_ratios", "longest_step", "with_armature"]

Array = NDArray[np.float64]


def with_armature(
    chain: Chain, armature: Array, damping: Array | None = None, load: Load | None = None
) -> ModalDamping:
    """Return a chain's modes with the armature and the damping of its hinges.

    Parameters
    ----------
    chain : Chain
        Of at most 500 hinges.
    armature, damping : ndarray, shape (hinges,) [kg m²], [N m s/rad]
        Of hinges as given: one that is in series with a support's spring must have neither.
    load : Load, optional
        One that leaves the chain straight.

    Raises
    ------
    ValueError
        If the chain is longer, or a hinge with armature is in series with a support's spring.
    """
    if len(armature) > MAX_DENSE:
        raise ValueError(f"armature must be 0 in chains of more than {MAX_DENSE} hinges, got {len(armature)}")
    modes = solve_modes(linearize(chain, load=load))
    turns, omega = np.diff(modes.rotation, axis=1), modes.angular_frequency
    own, drag = (of_coordinates(chain, column) for column in (armature, damping))
    if np.any(own):
        # The compliance keeps the digits of the lowest modes.
        scaled = turns / omega[:, None]
        square, shapes = np.linalg.eigh(np.diag(1 / omega**2) + (scaled * own) @ scaled.T)
        new = 1 / np.sqrt(square[::-1])
        turns, omega = (shapes[:, ::-1] / omega[:, None] * new).T @ turns, new
    return ModalDamping(omega, (turns * drag) @ turns.T, np.zeros((len(omega), len(omega))), 0.0)


def of_coordinates(chain: Chain, column: Array | None) -> Array:
    """Return numbers of hinges without those of hinges that a chain has put in series with its supports."""
    count = chain.pieces - 1
    if column is None or not np.any(column):
        return np.zeros(count)
    if len(column) != count:
        raise ValueError(
            "armature and damping must be 0 at the hinges of a chain where one is in series with a "
            "support's spring"
        )
    return column


def damping_ratios(chain: Chain, armature: Array, damping: Array, count: int) -> Array:
    """Return ζ of the first pairs of eigenvalues, by size; a pair of 1 and more does not swing."""
    if len(damping) <= MAX_DENSE:
        modal = with_armature(chain, armature, damping)
        return damped_pairs(damped_eigenvalues(modal.angular_frequency, modal.coupling))[1][:count]
    # All modes of a long chain are too many: each mode by itself, as light damping leaves it.
    modes = solve_modes(linearize(chain), count)
    turns = np.diff(modes.rotation, axis=1) ** 2
    return np.asarray(turns @ of_coordinates(chain, damping) / (2 * modes.angular_frequency))


def longest_step(chain: Chain, armature: Array, damping: Array, step: FileStep, load: Load) -> float:
    """Return the longest stable step of a file's integrator for this chain under its load [s].

    It is that of `stable_time_step`, with the armature in the modes: of a load that bends or pushes the chain
    a lower bound.
    """
    if not np.any(armature):
        own = of_coordinates(chain, damping)
        return stable_time_step(
            chain, step.record, load=load, damping=Damping(joint=tuple(own.tolist())) if own.any() else None
        )
    record = fixed_step_integrator(step.record)
    if record.springs == "implicit":
        return float("inf")
    return modal_time_step(record, with_armature(chain, armature, damping, taut_load(chain, load)))
