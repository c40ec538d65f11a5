"""Cross-sections known by their numbers: a handbook's, or another program's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from beammodes.checks import positive_real, shown

__all__ = ["GivenSection", "from_sectionproperties"]


@dataclass(frozen=True, slots=True)
class GivenSection:
    """A section known by its numbers: from a handbook, or of any shape by another program.

    Parameters
    ----------
    area : float [m²]
    second_moment, weak_second_moment : float [m⁴]
        For bending in the plane of the height, and in that of the width.

    Raises
    ------
    TypeError, ValueError
        If one is not a finite real number greater than 0.

    Examples
    --------
    >>> round(GivenSection(28.5e-4, 1943e-8, 142e-8).radius_of_gyration, 4)            # IPE 200
    0.0826
    """

    area: float
    second_moment: float
    weak_second_moment: float

    def __post_init__(self) -> None:
        for name in ("area", "second_moment", "weak_second_moment"):
            object.__setattr__(self, name, positive_real(name, getattr(self, name)))

    @property
    def radius_of_gyration(self) -> float:
        """r = √(I/A), for bending in the plane of the height [m]."""
        return math.sqrt(self.second_moment / self.area)


def from_sectionproperties(section: Any, *, length_unit: float = 1.0) -> GivenSection:
    """Return the numbers of a section that the package `sectionproperties` has analysed.

        A = get_area(),   (I_xx, I_yy, I_xy) = get_ic()  about the centroid; bending in the plane of its y

    That package is not needed here: only these two methods of what is given are called.

    Parameters
    ----------
    section : sectionproperties.analysis.Section
        Of one material, after `calculate_geometric_properties()`.
    length_unit : float [m]
        What one stands for in its geometry: 1e-3 for millimetres, in which its library sections are.

    Raises
    ------
    TypeError
        If it has no such methods, or they do not return numbers.
    ValueError
        If it is not analysed yet or is of several materials, or its principal axes are turned from x and y:
        such a beam leaves the plane in which it is bent.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> flat = SimpleNamespace(get_area=lambda: 75.0, get_ic=lambda: (156.25, 1406.25, 0.0))
    >>> round(from_sectionproperties(flat, length_unit=1e-3).radius_of_gyration, 9)    # 5 mm/√12
    0.001443376
    """
    unit = positive_real("length_unit", length_unit)
    if not 1e-12 <= unit <= 1e12:
        raise ValueError(
            f"length_unit must be what one stands for in m, 1e-12 to 1e12, got {shown(length_unit)}"
        )
    for name in ("get_area", "get_ic"):
        if not callable(getattr(section, name, None)):
            raise TypeError(
                f"section must be a sectionproperties Section, with a method {name}(), got {shown(section)}"
            )
    try:
        area, (level, upright, mixed) = section.get_area(), section.get_ic()
    except (AssertionError, RuntimeError, AttributeError) as error:
        raise ValueError(
            "section must be of one material and analysed by calculate_geometric_properties() first, "
            f"got the error {shown(str(error))}"
        ) from error
    except (TypeError, ValueError):
        raise TypeError(f"section must give three second moments by get_ic(), got {shown(section)}") from None
    # A mesh leaves rounding; a turned section leaves a sizeable part of the second moments.
    if not abs(mixed) <= 1e-6 * max(abs(level), abs(upright)):
        raise ValueError(
            f"section must have its principal axes along x and y, got a product of inertia {shown(mixed)} "
            f"beside {shown(level)} and {shown(upright)}: turn it until that vanishes"
        )
    return GivenSection(float(area) * unit**2, float(level) * unit**4, float(upright) * unit**4)
