"""Damping in modal coordinates: G and the eigenvalues of a damped chain.

In undamped modes of unit modal mass, q = Φ p, a damped chain is

    p'' + G p' + Ω² p = 0,      G = α + β Ω² + Σ_j d_j (joint rotation of the modes)ᵀ (joint rotation).

Without dampers d of its own G is diagonal: every mode keeps its shape and has the ratio ζ = α/(2ω) + βω/2.
Joint dampers in general couple the modes; the eigenvalues λ of the whole then say what remains.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.dynamics.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

if TYPE_CHECKING:
    pass

__all__ = ["check_damped", "damped_eigenvalues", "damping_of_modes"]

Array = NDArray[np.float64]


def check_damped(chain: Chain, damping: Damping) -> None:
    """Raise TypeError for what is no chain or no damping."""
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if not isinstance(damping, Damping):
        raise TypeError(f"damping must be a Damping, got {shown(damping)}")


def damping_of_modes(chain: Chain, damping: Damping) -> tuple[Array, Array]:
    """Return ω and G of the undamped modes."""
    check_damped(chain, damping)
    if len(chain.hinge_stiffness) > MAX_DENSE:
        raise ValueError(
            f"chain must have at most {MAX_DENSE} hinges here, where all its modes are needed, "
            f"got {len(chain.hinge_stiffness)}"
        )
    own = damping.joint_damping(chain) - damping.stiffness * chain.joint_stiffness
    modes = solve_modes(linearize(chain))
    bend = np.diff(modes.rotation, axis=1)
    omega = modes.angular_frequency
    return omega, (bend * own) @ bend.T + np.diag(damping.mass + damping.stiffness * omega**2)


def damped_eigenvalues(omega: Array, coupling: Array) -> NDArray[np.complex128]:
    """Return all λ, two a mode; those of modes that do not couple without loss to a dense solver."""
    if not np.any(coupling - np.diag(coupling.diagonal())):
        half = (coupling.diagonal() / 2).astype(complex)
        root = np.sqrt(half**2 - omega**2)
        return np.concatenate([-half - root, -(omega**2) / (half + root)])
    size = np.diag(omega)
    # In (p', Ω p), where both blocks off the diagonal are alike.
    return np.linalg.eigvals(np.block([[-coupling, -size], [size, np.zeros_like(size)]])).astype(complex)
