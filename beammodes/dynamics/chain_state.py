"""A chain in motion with its base: which systems can move, and the state of every piece."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.equations.coordinates import tip_names
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.damping import Damping

__all__ = ["ChainState", "Vector", "base_vector", "checked_system"]

Vector = tuple[Any, Any]


def base_vector(base: BaseMotion, time: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return (x, x', x'', y, y', y'', φ, φ', φ'') of the chain's end at a time or times, shape (9, ...)."""
    course = base.at(time)
    return np.asarray(course.reshape(9, *course.shape[2:]))


def checked_system(chain: Chain, load: Load | None, damping: Damping | None, base: BaseMotion | None) -> None:
    """Raise TypeError or ValueError for what forward dynamics cannot move."""
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    for name, value, kind in (("damping", damping, Damping), ("base", base, BaseMotion)):
        if value is not None and not isinstance(value, kind):
            raise TypeError(f"{name} must be a {kind.__name__} or None, got {shown(value)}")
    given, (left, right) = checked_load(load), (chain.boundary.left, chain.boundary.right)
    if given.spin_rate:
        raise ValueError(
            f"spin_rate must be 0 in motion, where a BaseMotion that turns is the hub, got {given.spin_rate}"
        )
    if right.is_grounded and not left.is_grounded:
        raise ValueError(
            f"boundary must tie down the left end if any, got {chain.boundary.name}: name that end first"
        )
    if base is not None and base.turns and (right.is_grounded or not left.holds_deflection):
        raise ValueError(
            "base must not turn unless it holds the left end's deflection and nothing but the base holds the "
            f"beam, got {chain.boundary.name}"
        )


@dataclass(frozen=True)
class ChainState:
    """Positions, angles and rates of every piece, those included that the base prescribes.

    Attributes
    ----------
    angle, spin, gain : list
        Angle and rate of every piece, and its angular acceleration where an end holds it, else None.
    place, speed, thrust : pair
        Position and velocity of the left tip, and its acceleration where the base gives it, else None.
    """

    angle: list[Any]
    spin: list[Any]
    gain: list[Any]
    place: Vector
    speed: Vector
    thrust: tuple[Any, Any]
    base: list[Any]

    @classmethod
    def of(cls, chain: Chain, q: list[Any], u: list[Any], base: list[Any]) -> ChainState:
        """Return the state of a chain from its coordinates, speeds and the nine numbers of its base."""
        tips = tip_names(chain)
        moving, rates = iter(q[len(tips) :]), iter(u[len(tips) :])
        angle, spin, gain = [], [], []
        for held in chain.held_angles:
            angle.append(base[6] if held else next(moving))
            spin.append(base[7] if held else next(rates))
            gain.append(base[8] if held else None)
        free = {name: (q[i], u[i], None) for i, name in enumerate(tips)}
        x, y = free.get("x_0", tuple(base[:3])), free.get("y_0", tuple(base[3:6]))
        place, speed, thrust = zip(x, y, strict=True)
        return cls(angle, spin, gain, place, speed, thrust, base)
