"""What drives a beam at one frequency, and what is read of its motion, where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import Boundary

__all__ = ["BASES", "Drive", "Reading", "ends_let_move"]

#: How a base may move: across the beam, or about the beam's left end.
BASES = ("shift", "turn")

# Over the length: so near to an end that holds it, a motion is lost in rounding; to a clamp, a deflection.
_SAME, _FLAT = 1e-15, 1e-8


class Drive(NamedTuple):
    """Unit forces or moments, one at a time, or a base that carries both ends.

    Attributes
    ----------
    kind : str
        "force", "moment", or one of `BASES`.
    x : ndarray, shape (points,) [m]
        Where forces or moments act; empty of a base.
    """

    kind: str
    x: Floats

    @property
    def is_base(self) -> bool:
        """True if a base moves."""
        return self.kind in BASES

    @property
    def columns(self) -> int:
        """How many there are."""
        return 1 if self.is_base else len(self.x)


class Reading(NamedTuple):
    """Deflections or rotations at positions.

    Attributes
    ----------
    kind : str
        "deflection" or "rotation".
    x : ndarray, shape (points,) [m]
    """

    kind: str
    x: Floats

    def of_base(self, base: str) -> Floats:
        """Return these of the base itself, that moves by one, shape (points,)."""
        if self.kind == "rotation":
            return self.x * 0.0 + float(base == "turn")
        return self.x if base == "turn" else self.x * 0.0 + 1.0


def ends_let_move(boundary: Boundary, length: float, reading: Reading, drive: Drive) -> NDArray[np.bool_]:
    """Return where the ends leave any motion to be read or driven, shape (readings, drives).

    Next to a clamp, where deflections grow with the square of the distance, less than rounding is none.
    """

    def moves(kind: str, x: Floats) -> NDArray[np.bool_]:
        turns, held = kind in ("rotation", "moment"), np.zeros(len(x), dtype=np.bool_)
        for end, distance in ((boundary.left, x), (boundary.right, length - x)):
            if end.holds_rotation if turns else end.holds_deflection:
                flat = end.holds_deflection and end.holds_rotation and not turns
                held |= distance <= (_FLAT if flat else _SAME) * length
        return ~held

    driven = np.array([True]) if drive.is_base else moves(drive.kind, drive.x)
    return np.asarray(moves(reading.kind, reading.x)[:, None] & driven)
