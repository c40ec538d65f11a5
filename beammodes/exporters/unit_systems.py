"""Systems of units that a beam's numbers may be declared in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

__all__ = ["UNIT_SYSTEMS", "UnitSystem"]


@dataclass(frozen=True)
class UnitSystem:
    """Names of units; times are in s and angles in rad in every system.

    Attributes
    ----------
    length, force, mass, mass_per_length : str
        ASCII, as files carry them.
    metres : float [m]
        The unit of length.
    kilograms : float [kg]
        The unit of mass.

    Examples
    --------
    >>> UNIT_SYSTEMS["mm-N-t"].joint_stiffness, UNIT_SYSTEMS["in-lbf-s"].all
    ('N mm/rad', 'in, lbf s2/in, s, lbf and rad')
    """

    length: str
    force: str
    mass: str
    mass_per_length: str
    metres: float
    kilograms: float

    @property
    def joint_stiffness(self) -> str:
        """Unit of a rotational spring."""
        return f"{self.force} {self.length}/rad"

    @property
    def bending_stiffness(self) -> str:
        """Unit of EI."""
        return f"{self.force} {self.length}2"

    @property
    def all(self) -> str:
        """All units in words."""
        return f"{self.length}, {self.mass}, s, {self.force} and rad"


#: International inch and pound at standard gravity, exact by definition.
_INCH, _POUND_FORCE = 0.0254, 0.45359237 * 9.80665

#: By the names that the option --units and the argument `units` take.
UNIT_SYSTEMS: Mapping[str, UnitSystem] = MappingProxyType(
    {
        "SI": UnitSystem("m", "N", "kg", "kg/m", 1.0, 1.0),
        "mm-N-t": UnitSystem("mm", "N", "t", "t/mm", 1e-3, 1e3),
        "in-lbf-s": UnitSystem("in", "lbf", "lbf s2/in", "lbf s2/in2", _INCH, _POUND_FORCE / _INCH),
    }
)
