"""Cross-sections: area and second moment of area, which make a beam's ρA, EI and ρI of a material's ρ and E.

The report's integral for its Figure 4, a typical I-beam, and for any other uniform section:

    I = ∫ d² dA,    d the distance from the line through the centroid about which the section turns.

Here that line is level: a `height` is measured in the plane in which the beam bends, a `width` across it. The
scan of the report prints no dimensions in Figure 4, so `ISection` is its formula and not its numbers.

`shear_coefficient(ν)` is κ of Timoshenko's beam for bending in the plane of the height, of G. R. Cowper, The
shear coefficient in Timoshenko's beam theory, Journal of Applied Mechanics 33 (1966). Only a rectangle's is
5/6, which is Cowper's at ν = 0 and what handbooks and programs take; his own is 0.85 at ν = 0.3.
"""

from __future__ import annotations

from dataclasses import dataclass

from beammodes.checks import positive_real, shown
from beammodes.problem.section_shape import Shape, below, flanged, rectangle, ring, thin_walled_coefficient

__all__ = ["Box", "Circle", "ISection", "Rectangle", "Tube"]


@dataclass(frozen=True, slots=True)
class Rectangle(Shape):
    """A solid rectangle,  A = b h,  I = b h³/12.

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

    def _numbers(self) -> tuple[float, float, float]:
        b, h = self.width, self.height
        return b * h, rectangle(b, h), rectangle(h, b)


@dataclass(frozen=True, slots=True)
class Circle(Shape):
    """A solid round bar of a `diameter` d [m],  A = π d²/4,  I = π d⁴/64; raises as `Rectangle` does.

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

    def _numbers(self) -> tuple[float, float, float]:
        return ring(self.diameter, 0.0, self.diameter / 2)


@dataclass(frozen=True, slots=True, init=False)
class Tube(Shape):
    """A round tube,  A = π (D² - d²)/4,  I = π (D⁴ - d⁴)/64.

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

    def _numbers(self) -> tuple[float, float, float]:
        return ring(self.outer, self.inner, self.wall)


@dataclass(frozen=True, slots=True)
class Box(Shape):
    """A rectangular tube,  A = b h - (b - 2t)(h - 2t),  I = (b h³ - (b - 2t)(h - 2t)³)/12.

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

    def _numbers(self) -> tuple[float, float, float]:
        b, h, t = self.width, self.height, self.wall
        area, second_moment = flanged(b, h, t, 2 * t)
        return area, second_moment, flanged(h, b, t, 2 * t)[1]


@dataclass(frozen=True, slots=True)
class ISection(Shape):
    """The report's Figure 4, an I-beam without fillets,  I = (b h³ - (b - s)(h - 2f)³)/12.

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

    width: float
    height: float
    flange: float
    web: float

    def __post_init__(self) -> None:
        below("flange", self.flange, positive_real("height", self.height) / 2, "half the height")
        below("web", self.web, positive_real("width", self.width), "the width")
        self._keep("width", "height", "flange", "web")

    def _coefficient(self, poisson_ratio: float) -> float:
        """Return κ of a thin-walled I, as a `Box` has it with 30 (m + m²) + 5ν (8 m + 9 m²)."""
        height = self.height - self.flange
        m = 2 * self.width * self.flange / (height * self.web)
        across = 30 * (m + m * m) + 5 * poisson_ratio * (8 * m + 9 * m * m)
        return thin_walled_coefficient(poisson_ratio, m, self.width / height, across)

    def _numbers(self) -> tuple[float, float, float]:
        b, h, f, s = self.width, self.height, self.flange, self.web
        return *flanged(b, h, f, s), 2 * rectangle(f, b) + rectangle(h - 2 * f, s)
