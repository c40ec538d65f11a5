"""What loads a beam while it vibrates."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from beammodes.checks import real, shown

__all__ = ["Load", "checked_load"]


@dataclass(frozen=True)
class Load:
    """Loads under which a beam or a chain vibrates.

    Parameters
    ----------
    axial_force : float [N]
        T, tension positive: a pair of dead loads of fixed direction that pull the beam's two ends apart (and
        not the bodies' centres of mass). Kept exact if given as a `Fraction`.

    Raises
    ------
    TypeError, ValueError
        If a number is not real or not finite.

    Examples
    --------
    >>> Load(axial_force=-2.0)
    Load(axial_force=-2.0)
    """

    axial_force: float | Fraction = 0.0

    def __post_init__(self) -> None:
        number = real("axial_force", self.axial_force)
        if not isinstance(self.axial_force, Fraction):
            object.__setattr__(self, "axial_force", number + 0.0)


def checked_load(load: Load | None) -> Load:
    """Return `load`, or no load for None; raise TypeError for anything else."""
    if load is not None and not isinstance(load, Load):
        raise TypeError(f"load must be a Load or None, got {shown(load)}")
    return load or Load()
