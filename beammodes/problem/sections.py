"""Cross-sections: area and second moment of area, which make a beam's ρA, EI and ρI of a material's ρ and E.

The report's integral for its Figure 4, a typical I-beam, and for any other uniform section:

    I = ∫ d² dA,    d the distance from the line through the centroid about which the section turns.

Here that line is level: a `height` is measured in the plane in which the beam bends, a `width` across it. The
scan of the report prints no dimensions in Figure 4, so `ISection` is its formula and not its numbers.

`shear_coefficient(ν)` is κ of Timoshenko's beam for bending in the plane of the height, of G. R. Cowper, The
shear coefficient in Timoshenko's beam theory, Journal of Applied Mechanics 33 (1966). Only a rectangle's is
5/6, which is Cowper's at ν = 0 and what handbooks and programs take; his own is 0.85 at ν = 0.3.

`torsion_constant` is J of Saint-Venant's torsion, which makes GJ: the polar second moment of round sections
only. Each class says where its J is from and how good it is. Warping held at an end stiffens open sections
beyond GJ, which is left out.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Protocol

from beammodes.checks import Shown, positive_real, real, shown

__all__ = [
    "SECTIONS",
    "Box",
    "Channel",
    "Circle",
    "GivenSection",
    "ISection",
    "Rectangle",
    "Section",
    "Shape",
    "Tube",
    "below",
    "flanged",
    "from_sectionproperties",
    "open_torsion",
    "poisson_ratio_of",
    "rectangle",
    "rectangle_torsion",
    "ring",
    "thin_walled_coefficient",
]


# What a cross-section is, and area and second moments of the plates and rings that sections are made of.


class Section(Protocol):
    """Cross-section as `Beam.from_section` needs it, from here or from elsewhere."""

    @property
    def area(self) -> float:
        """A [m²]."""

    @property
    def second_moment(self) -> float:
        """I = ∫ d² dA about the level line through the centroid [m⁴]."""


class Shape(Shown, ABC):
    """Base of the sections of given dimensions."""

    __slots__ = ()

    @abstractmethod
    def _numbers(self) -> tuple[float, float, float]:
        """Return A, I and the I of the section on its side."""

    @abstractmethod
    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ of the shear stiffness κGA."""

    @abstractmethod
    def _torsion(self) -> float:
        """Return J of the torsional stiffness GJ."""

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
    def polar_second_moment(self) -> float:
        """Ip = ∫ r² dA = I + I_weak about the centroid, which makes a beam's ρIp [m⁴]."""
        _, second_moment, weak = self._numbers()
        return second_moment + weak

    @property
    def torsion_constant(self) -> float:
        """J of the torsional stiffness GJ [m⁴]."""
        return self._torsion()

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


def rectangle_torsion(width: float, height: float) -> float:
    """Return J of a solid rectangle by Saint-Venant's series, to all digits.

        J = a b³ [1/3 - (64/π⁵) (b/a) Σ tanh(nπa/2b)/n⁵],    n = 1, 3, 5, ...,    a ≥ b

    Of tanh = 1 - 2/(e^(nπa/b) + 1) the ones are summed once for all; the rest vanishes as e^(-nπ).

    References
    ----------
    S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed., section 109.

    Examples
    --------
    >>> round(rectangle_torsion(1.0, 1.0), 6)
    0.140577
    """
    b, a = sorted((width, height))
    left = math.fsum(
        2.0 * fade / (1.0 + fade) / n**5
        for n in range(1, 14, 2)
        for fade in (math.exp(-n * math.pi * (a / b)),)
    )
    return a * b * b * b * (1.0 / 3.0 - 64.0 / math.pi**5 * (b / a) * (_sum_of_odd_fifths() - left))


@lru_cache(maxsize=1)
def _sum_of_odd_fifths() -> float:
    """Return Σ 1/n⁵ over odd n; beyond n = 1999 its integral, which is right to 1e-20."""
    return math.fsum([*(1.0 / n**5 for n in range(1, 2000, 2)), 1.0 / (8.0 * 2000.0**4)])


def open_torsion(plates: float, meeting: float, diameter: float, flange: float) -> float:
    """Return J of two flanges and a web that meet at sharp corners.

        J = Σ b t³/3 + 2 α D⁴ - 0.42 f⁴

    What thin plates have, more where they meet (D the diameter of the largest circle inside the corner, α of
    its thicknesses), less at their four ends: 0.105 f⁴ each.

    References
    ----------
    I. A. El Darwish, B. G. Johnston, Torsion of structural shapes, Journal of the Structural Division, ASCE
    91 (1965) 203-227. Their formulas are fits; the sections say how good.
    """
    return plates + 2 * meeting * diameter**4 - 0.42 * flange**4


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


@dataclass(frozen=True, slots=True, repr=False)
class Rectangle(Shape):
    """A solid rectangle,  A = b h,  I = b h³/12,  J by `rectangle_torsion` to all digits.

    Parameters
    ----------
    width, height : float [m]
        b across the plane of bending and h in it.

    Raises
    ------
    TypeError, ValueError
        If one is not a finite real number greater than 0.

    Examples
    --------
    >>> round(Rectangle(width=0.015, height=0.005).second_moment * 1e12, 9)            # mm⁴
    156.25
    """

    width: float
    height: float

    def __post_init__(self) -> None:
        self._keep("width", "height")

    def _coefficient(self, _poisson_ratio: float) -> float:
        """Return κ = 5/6, whatever Poisson's ratio."""
        return 5 / 6

    def _torsion(self) -> float:
        return rectangle_torsion(self.width, self.height)

    def _numbers(self) -> tuple[float, float, float]:
        b, h = self.width, self.height
        return b * h, rectangle(b, h), rectangle(h, b)


@dataclass(frozen=True, slots=True, repr=False)
class Circle(Shape):
    """A solid round bar,  A = π d²/4,  I = π d⁴/64,  J = 2I; raises as a `Rectangle`.

    Parameters
    ----------
    diameter : float [m]
        d.

    Examples
    --------
    >>> Circle(diameter=0.02).radius_of_gyration                         # d/4
    0.005
    """

    diameter: float

    def __post_init__(self) -> None:
        self._keep("diameter")

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ = 6 (1 + ν)/(7 + 6ν)."""
        return 6 * (1 + poisson_ratio) / (7 + 6 * poisson_ratio)

    def _torsion(self) -> float:
        return self.polar_second_moment

    def _numbers(self) -> tuple[float, float, float]:
        return ring(self.diameter, 0.0, self.diameter / 2)


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Tube(Shape):
    """A round tube,  A = π (D² - d²)/4,  I = π (D⁴ - d⁴)/64,  J = 2I.

    Parameters
    ----------
    outer : float [m]
        D, the outer diameter.
    inner, wall : float [m]
        d, the inner diameter, or t = (D - d)/2, the thickness of the wall: one of them. A thin wall given
        as `wall` loses no digits.

    Raises
    ------
    TypeError, ValueError
        If a number is not a finite real number greater than 0, both or neither of `inner` and `wall` are
        given, or they leave no tube.

    Examples
    --------
    >>> Tube(0.5, inner=0.25) == Tube(0.5, wall=0.125)
    True
    """

    outer: float
    inner: float
    wall: float

    def __init__(self, outer: float, *, inner: float | None = None, wall: float | None = None) -> None:
        whole = positive_real("outer", outer)
        if inner is not None and wall is None:
            hole = below("inner", inner, whole, "the outer diameter")
            thickness = (whole - hole) / 2
        elif wall is not None and inner is None:
            thickness = below("wall", wall, whole / 2, "half the outer diameter")
            hole = whole - 2 * thickness
        else:
            raise ValueError(f"one of inner and wall must be given, got {shown(inner)} and {shown(wall)}")
        for name, value in (("outer", whole), ("inner", hole), ("wall", thickness)):
            object.__setattr__(self, name, value)
        self._keep("outer", "inner", "wall")

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ = 6 (1 + ν)(1 + m²)²/((7 + 6ν)(1 + m²)² + (20 + 12ν) m²),  m = d/D."""
        square = (self.inner / self.outer) ** 2
        whole = (1 + square) ** 2
        below = (7 + 6 * poisson_ratio) * whole + (20 + 12 * poisson_ratio) * square
        return 6 * (1 + poisson_ratio) * whole / below

    def _torsion(self) -> float:
        return self.polar_second_moment

    def _numbers(self) -> tuple[float, float, float]:
        return ring(self.outer, self.inner, self.wall)


@dataclass(frozen=True, slots=True, repr=False)
class Box(Shape):
    """A rectangular tube,  A = b h - (b - 2t)(h - 2t),  I = (b h³ - (b - 2t)(h - 2t)³)/12.

    J is Bredt's, with sharp corners and the plates' own stiffness, within 0.2 % of finite elements
    for walls up to a third of the smaller side; Bredt's alone is 5.6 % low for a tenth.

    Parameters
    ----------
    width, height : float [m]
        b and h, over all.
    wall : float [m]
        t, the same on all four sides.

    Raises
    ------
    TypeError, ValueError
        If one is not a finite real number greater than 0, or the wall leaves no hole.

    Examples
    --------
    >>> round(Box(width=0.04, height=0.06, wall=0.003).second_moment * 1e12)           # mm⁴
    273852
    """

    width: float
    height: float
    wall: float

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            below("wall", self.wall, positive_real(name, getattr(self, name)) / 2, f"half the {name}")
        self._keep("width", "height", "wall")

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ of a thin-walled box: `thin_walled_coefficient` with 10 ((3 + ν) m + 3 m²)."""
        width, height = self.width - self.wall, self.height - self.wall
        m = width / height
        across = 10 * ((3 + poisson_ratio) * m + 3 * m * m)
        return thin_walled_coefficient(poisson_ratio, m, width / height, across)

    def _torsion(self) -> float:
        """Return  J = 4 A²/S + 2 (b + h - 2t) t³/3,  S the circumference over the wall's thickness.

        A sharp corner adds 1 - (2/π) ln 2 squares to S (a conductor's, bent by 90 degrees), and the stress
        function in it 0.37 t² in all less than A = (b - t)(h - t) counts: this last number is a fit to finite
        elements of walls from a 40th to a third of the smaller side.
        """
        b, h, t = self.width, self.height, self.wall
        squares = 2 * (b + h - 4 * t) / t + 4 * (1 - 2 / math.pi * math.log(2))
        area = (b - t) * (h - t) - 0.37 * t * t
        return 4 * area * area / squares + 2 * (b + h - 2 * t) * t**3 / 3

    def _numbers(self) -> tuple[float, float, float]:
        b, h, t = self.width, self.height, self.wall
        area, second_moment = flanged(b, h, t, 2 * t)
        return area, second_moment, flanged(h, b, t, 2 * t)[1]


@dataclass(frozen=True, slots=True)
class _Flanged(Shape):
    """Two level flanges and an upright web: what an I and a channel have in common."""

    width: float
    height: float
    flange: float
    web: float

    def __post_init__(self) -> None:
        below("flange", self.flange, positive_real("height", self.height) / 2, "half the height")
        below("web", self.web, positive_real("width", self.width), "the width")
        self._keep("width", "height", "flange", "web")

    def _numbers(self) -> tuple[float, float, float]:
        """Return A, I and, with the web in the middle of the flanges, the I of the section on its side."""
        b, h, f, s = self.width, self.height, self.flange, self.web
        return *flanged(b, h, f, s), 2 * rectangle(f, b) + rectangle(h - 2 * f, s)

    @property
    def _plates(self) -> float:
        """Σ b t³/3 of flanges and web."""
        f, s = self.flange, self.web
        return (2 * self.width * f**3 + (self.height - 2 * f) * s**3) / 3


@dataclass(frozen=True, slots=True, repr=False)
class ISection(_Flanged):
    """The report's Figure 4, an I-beam without fillets,  I = (b h³ - (b - s)(h - 2f)³)/12.

    J is El Darwish and Johnston's (`open_torsion`), within 1.7 % of finite elements for plates up to a tenth
    of the height, 2.1 % up to an eighth. Fillets, which a rolled section has, add 30 % to it for IPE 200.

    Parameters
    ----------
    width, height : float [m]
        b of the flanges and h over all; the web is upright, in the plane of bending.
    flange, web : float [m]
        f and s, their thicknesses;  A = 2 b f + s (h - 2f).

    Raises
    ------
    TypeError, ValueError
        If one is not a finite real number greater than 0, or flanges or web leave no I.

    Examples
    --------
    >>> beam = ISection(width=0.1, height=0.2, flange=0.0085, web=0.0056)              # IPE 200 less fillets
    >>> round(beam.second_moment * 1e8), round(beam.weak_second_moment * 1e8)          # cm⁴
    (1846, 142)
    """

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ of a thin-walled I, as a `Box` has it with 30 (m + m²) + 5ν (8 m + 9 m²)."""
        height = self.height - self.flange
        m = 2 * self.width * self.flange / (height * self.web)
        across = 30 * (m + m * m) + 5 * poisson_ratio * (8 * m + 9 * m * m)
        return thin_walled_coefficient(poisson_ratio, m, self.width / height, across)

    def _torsion(self) -> float:
        f, s = self.flange, self.web
        ratio = s / f
        meeting = -0.042 + 0.2204 * ratio - 0.0725 * ratio**2
        return open_torsion(self._plates, meeting, f + s * s / (4 * f), f)


@dataclass(frozen=True, slots=True, repr=False)
class Channel(_Flanged):
    """A channel without fillets: an `ISection` whose web stands at the flanges' left tips.

    It bends in the plane of the height without twist only if forces pass through its shear centre, which lies
    beyond the web; that plane's bending and twist vibrate together in truth, and apart here. J is El Darwish
    and Johnston's (`open_torsion`), within 1.5 % of finite elements for plates up to a tenth of the height.

    Parameters
    ----------
    width, height : float [m]
        b of the flanges, web included, and h over all; the web is upright, in the plane of bending.
    flange, web : float [m]
        f and s, their thicknesses.

    Raises
    ------
    TypeError, ValueError
        If one is not a finite real number greater than 0, or flanges or web leave no channel.

    Examples
    --------
    >>> channel = Channel(width=0.1, height=0.2, flange=0.0085, web=0.0056)
    >>> channel.second_moment == ISection(0.1, 0.2, 0.0085, 0.0056).second_moment
    True
    """

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ: two channels back to back are an I, and no shear passes between them."""
        pair = ISection(2 * self.width, self.height, self.flange, 2 * self.web)
        return pair.shear_coefficient(poisson_ratio)

    def _torsion(self) -> float:
        f, s = self.flange, self.web
        ratio = s / f
        meeting = -0.0908 + 0.2621 * ratio - 0.0945 * ratio**2
        return open_torsion(self._plates, meeting, 2 * (s + f - math.sqrt(2 * s * f)), f)

    def _numbers(self) -> tuple[float, float, float]:
        b, h, f, s = self.width, self.height, self.flange, self.web
        upright, level = s * (h - 2 * f), 2 * b * f
        # About the centroid, which the middles of web and flanges are apart from in proportion to the other.
        apart = upright * level / (upright + level) * ((b - s) / 2) * ((b - s) / 2)
        area, second_moment, weak = _Flanged._numbers(self)
        return area, second_moment, weak + apart


# Cross-sections known by their numbers: a handbook's, or another program's.


@dataclass(frozen=True, slots=True, repr=False)
class GivenSection(Shown):
    """A section known by its numbers: from a handbook, or of any shape by another program.

    Parameters
    ----------
    area : float [m²]
    second_moment, weak_second_moment : float [m⁴]
        For bending in the plane of the height, and in that of the width.
    torsion_constant : float [m⁴], optional
        J; a beam of this section has no GJ without it.

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
    torsion_constant: float | None = None

    def __post_init__(self) -> None:
        for name in ("area", "second_moment", "weak_second_moment", "torsion_constant"):
            if getattr(self, name) is not None or name != "torsion_constant":
                object.__setattr__(self, name, positive_real(name, getattr(self, name)))

    @property
    def radius_of_gyration(self) -> float:
        """r = √(I/A), for bending in the plane of the height [m]."""
        return math.sqrt(self.second_moment / self.area)


def from_sectionproperties(section: Any, *, length_unit: float = 1.0) -> GivenSection:
    """Return the numbers of a section that the package `sectionproperties` has analysed.

        A = get_area(),   (I_xx, I_yy, I_xy) = get_ic()  about the centroid; bending in the plane of its y
        J = get_j(),  if `calculate_warping_properties()` has been called too; without it there is none

    That package is not needed here: only these three methods of what is given are called. Its J is that of
    finite elements, from above: refine the mesh until it stays.

    Parameters
    ----------
    section : sectionproperties.analysis.Section
        Of one material, after `calculate_geometric_properties()`.
    length_unit : float [m]
        What one stands for in its geometry: 1e-3 for millimetres, in which its library sections are.

    Returns
    -------
    GivenSection
        A, I and, where it is known, J, in the lengths of the analysis.

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
    try:
        twisting: float | None = float(section.get_j()) * unit**4
    except (AssertionError, RuntimeError, AttributeError):
        # Not analysed for warping, or a section that knows no torsion.
        twisting = None
    return GivenSection(float(area) * unit**2, float(level) * unit**4, float(upright) * unit**4, twisting)


#: The sections of given dimensions, by the names that studies give them.
SECTIONS: Mapping[str, Callable[..., Shape]] = MappingProxyType(
    {
        "rectangle": Rectangle,
        "circle": Circle,
        "tube": Tube,
        "box": Box,
        "i_section": ISection,
        "channel": Channel,
    }
)
