"""What drives a beam at one frequency, and what is read of its motion, where."""

from __future__ import annotations

from typing import NamedTuple

from beammodes.numerics.arrays import Floats

__all__ = ["BASES", "Drive", "Reading"]

#: How a base may move: across the beam, or about the beam's left end.
BASES = ("shift", "turn")


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
