"""How a chain swings in its file: with the armature and the dampers of its hinges, and at the file's time step.

In undamped modes of unit modal mass, u = Φ p, hinges that turn by  r = R p  make of  p'' + Ω² p = 0

    (1 + Rᵀ a R) p'' + Rᵀ d R p' + (Ω² + Θᵀ P Θ) p = 0,

a the armature and d the damping of every hinge, P the pull of the weight on every piece, Θ its turning.
Rigid-body motions turn no hinge, so they take no part.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import FileStep
from beammodes.chains.chain import Chain
from beammodes.dynamics.damping_ratio import damped_pairs
from beammodes.dynamics.modal_damping import damped_eigenvalues
from beammodes.dynamics.step_limits import amplification
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

__all__ = ["Swing", "pull_of_weight", "swing_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Swing:
    """All elastic modes with armature: ω, G and K in coordinates of unit modal mass.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Without damping and weight.
    damping : ndarray, shape (modes, modes) [1/s]
    stiffness : ndarray, shape (modes, modes) [1/s²]
        With the pull of the weight.
    """

    angular_frequency: Array
    damping: Array
    stiffness: Array

    @property
    def damping_ratio(self) -> Array:
        """ζ of each pair of eigenvalues, by size, shape (modes,); a pair of 1 and more does not swing."""
        if not np.any(self.damping):
            return np.zeros_like(self.angular_frequency)
        return damped_pairs(damped_eigenvalues(self.angular_frequency, self.damping))[1]

    def longest_step(self, step: FileStep) -> float:
        """Return the largest stable time step of the file's integrator [s].

        A step of semi-implicit Euler, of which MuJoCo's Euler, implicit and implicitfast are kinds, is stable up
        to where a mode turns its sign with every step,  det(4 ± 2 h G - h² K) = 0 : + where damping is implicit,
        h = 2 (ζ + √(1 + ζ²))/ω of one mode; - where it is not. RK4 is stable while |R(h λ)| ≤ 1.
        """
        fastest = math.sqrt(float(np.linalg.eigvalsh(self.stiffness)[-1]))
        if step.integrator == "RK4":
            return self._by_rk4()
        sign = 1.0 if step.implicit_damping else -1.0
        size = 4 * np.eye(len(self.stiffness))

        def stable(h: float) -> bool:
            return _is_positive(size + 2 * sign * h * self.damping - h**2 * self.stiffness)

        return _last(stable, 2 / fastest)

    def _by_rk4(self) -> float:
        root = np.linalg.cholesky(self.stiffness)
        if not np.any(self.damping):
            values = 1j * np.linalg.svd(root, compute_uv=False)
        elif np.any(self.stiffness - np.diag(self.stiffness.diagonal())):
            size = len(root)
            values = np.linalg.eigvals(
                np.block([[np.zeros((size, size)), np.eye(size)], [-self.stiffness, -self.damping]])
            )
        else:
            values = damped_eigenvalues(np.sqrt(self.stiffness.diagonal()), self.damping)

        def stable(h: float) -> bool:
            return bool((np.abs(amplification("rk4", h * values)) <= 1 + 1e-12).all())

        return _last(stable, 2.5 / float(np.abs(values).max()))


def _is_positive(matrix: Array) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True


def _last(stable: Callable[[float], bool], near: float) -> float:
    """Return up to where a step is stable, by bisection from a first guess."""
    low, high = near, near
    for _ in range(200):
        if stable(low):
            break
        low /= 2
    for _ in range(200):
        if not stable(high):
            break
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def pull_of_weight(chain: Chain, along: float) -> Array:
    """Return what weight along a chain that hangs at its left end does to each piece, shape (pieces,) [N m].

    A piece that turns by θ lifts what is beyond it:  V = ½ P θ²,  P_i = g (l_i Σ_{k>i} m_k + m_i c_i).

    Parameters
    ----------
    chain : Chain
    along : float [m/s²]
        Acceleration of gravity towards its right end; negative if it stands.
    """
    beyond = np.cumsum(chain.mass[::-1])[::-1] - chain.mass
    return np.asarray(along * (chain.length * beyond + chain.mass * chain.centre))


def swing_of(chain: Chain, armature: Array, damping: Array, pull: Array | None = None) -> Swing:
    """Return a chain's modes with the armature and damping of its hinges.

    Raises
    ------
    ValueError
        If the chain has more than 500 hinges, or hinges that are no coordinates of their own.
    """
    if len(armature) > MAX_DENSE:
        raise ValueError(
            f"armature must be 0 in chains of more than {MAX_DENSE} hinges, got one of {len(armature)}"
        )
    modes = solve_modes(linearize(chain))
    if modes.rotation.shape[1] != len(armature) + 1:
        raise ValueError("armature must be 0 where a hinge is in series with a support's spring")
    turns = np.diff(modes.rotation, axis=1)
    omega = modes.angular_frequency
    stiffness = np.diag(omega**2)
    if np.any(armature):
        # The compliance keeps the digits of the lowest modes.
        scaled = turns / omega[:, None]
        compliance = np.diag(1 / omega**2) + (scaled * armature) @ scaled.T
        square, shapes = np.linalg.eigh(compliance)
        new = 1 / np.sqrt(square[::-1])
        basis = shapes[:, ::-1] / omega[:, None] * new
        stiffness, omega = np.diag(new**2), new
        turns = basis.T @ turns
        slopes = basis.T @ modes.rotation
    else:
        slopes = modes.rotation
    if pull is not None:
        stiffness = stiffness + (slopes * pull) @ slopes.T
    return Swing(omega, (turns * damping) @ turns.T, stiffness)
