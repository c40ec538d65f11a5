"""Dead loads on a rod in space: forces and moments on its end, a torque on both ends, and gravity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beammodes.checks import Shown, real, shown, unwrapped

__all__ = ["SpatialLoad"]

Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True, init=False, repr=False)
class SpatialLoad(Shown):
    """Loads that keep their directions, in the axes of the section at s = 0 at rest.

    Parameters
    ----------
    force : three floats [N]
        On the rod's end at s = L.
    moment : three floats [N m]
        On that end. A moment that keeps its direction has no potential: what it does depends on the path, and
        only equilibrium tells what it can hold.
    torque : float [N m]
        About x: that much on the end at s = L and as much back on the one at s = 0, whose supports may let it
        turn.
    gravity : three floats [m/s²]
        Acceleration of free fall, on every piece and end body.

    Examples
    --------
    >>> SpatialLoad(force=(0, 0, 600)).times(0.5).force
    (0.0, 0.0, 300.0)
    """

    force: Three = (0.0, 0.0, 0.0)
    moment: Three = (0.0, 0.0, 0.0)
    torque: float = 0.0
    gravity: Three = (0.0, 0.0, 0.0)

    def __init__(
        self,
        force: Sequence[float] = (0.0, 0.0, 0.0),
        moment: Sequence[float] = (0.0, 0.0, 0.0),
        torque: float = 0.0,
        gravity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        for name, given in (("force", force), ("moment", moment), ("gravity", gravity)):
            object.__setattr__(self, name, _three(name, given))
        object.__setattr__(self, "torque", real("torque", torque) + 0.0)

    def times(self, factor: float) -> SpatialLoad:
        """Return the load multiplied by a number."""
        force, moment, gravity = (
            tuple(factor * value for value in vector) for vector in (self.force, self.moment, self.gravity)
        )
        return SpatialLoad(force, moment, factor * self.torque, gravity)


def _three(name: str, given: object) -> Three:
    plain = unwrapped(name, given)
    values = plain.tolist() if isinstance(plain, np.ndarray) else plain
    if not isinstance(values, list | tuple) or len(values) != 3:
        raise TypeError(f"{name} must be three numbers, along x, y and z, got {shown(given)}")
    x, y, z = (real(name, value) + 0.0 for value in values)
    return x, y, z
