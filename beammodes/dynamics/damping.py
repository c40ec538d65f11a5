"""Damping of a chain: in proportion to mass and stiffness (Rayleigh's), and at its joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import real, shown

__all__ = ["Damping"]


@dataclass(frozen=True)
class Damping:
    """Damping of a chain's motion relative to its base.

        C = α M + β K + Σ_j d_j (joint rotation)ᵀ (joint rotation)

    α acts on each piece's own motion, β on the springs of joints and supports (not on what loads add).

    Parameters
    ----------
    mass : float [1/s]
        α: mode n gets the damping ratio α/(2 ω_n).
    stiffness : float [s]
        β: mode n gets the damping ratio β ω_n/2.
    joint : float or sequence, one a hinge [N m s/rad]
        d_j.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, or negative.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> Damping(stiffness=0.01).joint_damping(Chain(Beam.unit(), "clamped-free", segments=1))
    array([0.03])
    """

    mass: float = 0.0
    stiffness: float = 0.0
    joint: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        for name in ("mass", "stiffness"):
            object.__setattr__(self, name, _not_negative(name, getattr(self, name)))
        given = self.joint.tolist() if isinstance(self.joint, np.ndarray) else self.joint
        if isinstance(given, Sequence) and not isinstance(given, str):
            kept: float | tuple[float, ...] = tuple(
                _not_negative(f"joint[{i}]", d) for i, d in enumerate(given)
            )
        else:
            kept = _not_negative("joint", given)
        object.__setattr__(self, "joint", kept)

    def joint_damping(self, chain: Chain) -> NDArray[np.float64]:
        """Return the damping of every hinge, β k_j + d_j, shape (hinges,) [N m s/rad].

        Raises
        ------
        ValueError
            If `joint` has another number of entries than the chain has hinges.
        """
        hinges = len(chain.joint_stiffness)
        own = np.asarray(self.joint)
        if own.ndim and len(own) != hinges:
            raise ValueError(f"joint must have {hinges} entries, one a hinge, got {len(own)}")
        return np.asarray(self.stiffness * chain.joint_stiffness + own)


def _not_negative(name: str, value: object) -> float:
    number = real(name, value)
    if number < 0.0:
        raise ValueError(f"{name} must not be negative, got {shown(value)}")
    return number
