"""What a cross-section is, and area and second moments of the plates and rings that sections are made of."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Protocol

from beammodes.checks import positive_real, real, shown

__all__ = [
    "Section",
    "Shape",
    "below",
    "flanged",
    "poisson_ratio_of",
    "rectangle",
    "ring",
    "thin_walled_coefficient",
]


class Section(Protocol):
    """What `Beam.from_section` asks of a cross-section, from here or from elsewhere."""

    @property
    def area(self) -> float:
        """A [m²]."""

    @property
    def second_moment(self) -> float:
        """I = ∫ d² dA about the level line through the centroid [m⁴]."""


class Shape(ABC):
    """What sections of given dimensions have in common."""

    __slots__ = ()

    @abstractmethod
    def _numbers(self) -> tuple[float, float, float]:
        """Return A, I and the I of the section on its side."""

    @abstractmethod
    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ of the shear stiffness κGA."""

    def shear_coefficient(self, poisson_ratio: float) -> float:
        """Return κ of the shear stiffness κGA, for bending in the plane of the height.

        Parameters
        ----------
        poisson_ratio : float
            ν, above -1 and at most 0.5.

        Raises
        ------
        TypeError, ValueError
            If it is not a number in this range.
        """
        return self._coefficient(poisson_ratio_of(poisson_ratio))

    @property
    def area(self) -> float:
        """A [m²]."""
        return self._numbers()[0]

    @property
    def second_moment(self) -> float:
        """I = ∫ d² dA, for bending in the plane of the height [m⁴]."""
        return self._numbers()[1]

    @property
    def weak_second_moment(self) -> float:
        """I of the section on its side, for bending in the plane of the width [m⁴]."""
        return self._numbers()[2]

    @property
    def radius_of_gyration(self) -> float:
        """r = √(I/A), for bending in the plane of the height [m]."""
        area, second_moment, _ = self._numbers()
        return math.sqrt(second_moment / area)

    def _keep(self, *names: str) -> None:
        """Keep fields as floats above zero; refuse sizes whose moments floats cannot hold."""
        for name in names:
            object.__setattr__(self, name, positive_real(name, getattr(self, name)))
        if not all(0.0 < value < math.inf for value in self._numbers()):
            raise ValueError(
                f"{', '.join(names)} must be of another order: area and second moments of {self} leave the "
                "range of floating-point numbers"
            )


def ring(outer: float, inner: float, wall: float) -> tuple[float, float, float]:
    """Return A, I and I again of a round tube, or of a bar where nothing is inside."""
    area = math.pi * wall * (outer - wall)
    second_moment = area * (outer * outer + inner * inner) / 16.0
    return area, second_moment, second_moment


def flanged(width: float, height: float, flange: float, web: float) -> tuple[float, float]:
    """Return A and I of two level flanges and what stands between them.

    Their own second moments and Steiner's terms are all positive: a thin wall loses no digits, where the
    difference of two solid rectangles would.
    """
    arm, inside = (height - flange) / 2, height - 2 * flange
    plates = 2 * (rectangle(width, flange) + width * flange * arm * arm)
    return 2 * width * flange + web * inside, plates + rectangle(web, inside)


def rectangle(width: float, height: float) -> float:
    """Return I of a rectangle,  b h³/12."""
    return width * height * height * height / 12.0


def thin_walled_coefficient(poisson_ratio: float, flange: float, width: float, across: float) -> float:
    """Return Cowper's κ of an I or a box with thin walls, from its dimensions between the walls' middles.

    Parameters
    ----------
    poisson_ratio : float
        ν.
    flange : float
        m, the area of both flanges over that of all webs.
    width : float
        n, the flange's width over the height.
    across : float
        The last terms in the denominator, over n²: how shear runs along the flanges, which an I's free tips
        and a box's corners make different.
    """
    m = flange
    plain = 12 + 72 * m + 150 * m**2 + 90 * m**3
    strained = 11 + 66 * m + 135 * m**2 + 90 * m**3
    return (
        10 * (1 + poisson_ratio) * (1 + 3 * m) ** 2 / (plain + poisson_ratio * strained + width**2 * across)
    )


def poisson_ratio_of(value: object) -> float:
    """Return Poisson's ratio as a float, or raise TypeError or ValueError."""
    ratio = real("poisson_ratio", value)
    if not -1.0 < ratio <= 0.5:
        raise ValueError(f"poisson_ratio must be above -1 and at most 0.5, got {shown(value)}")
    return ratio


def below(name: str, value: object, limit: float, what: str) -> float:
    """Return a number above zero and below a limit, or raise TypeError or ValueError."""
    number = positive_real(name, value)
    if number >= limit:
        raise ValueError(f"{name} must be less than {what}, {limit}, got {shown(value)}")
    return number
