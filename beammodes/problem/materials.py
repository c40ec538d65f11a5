"""Materials: the report's elastic moduli as it prints them, and the numbers that a command line needs.

The report's table follows the words "The Elastic Modulus of some common materials are:", in millions of
lbf/in², two of them as a range: wood and cast iron. Letters of the scan are misread (Ibf for lbf, Tron for
Iron), no digit is in doubt. It prints one system of units, so pascals here are converted, never copied, and
there is no second column to check against. The numbers are rounded to whole millions: one of 3 says no more
than 2.5 to 3.5. The table has no densities; those of `MATERIALS` are from handbooks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from beammodes.checks import Catalogue, Shown, choice, real, shown

__all__ = ["MATERIALS", "MODULI", "PASCALS", "Material", "Modulus", "elastic_modulus", "plain_name"]

#: Pascals in a pound-force per square inch, exactly: 0.45359237 kg times 9.80665 m/s² over (0.0254 m)².
PASCALS = Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254") ** 2

_UNITS = {"Pa": PASCALS, "lbf/in2": Fraction(1)}


@dataclass(frozen=True, slots=True, repr=False)
class Modulus(Shown):
    """One line of the table: an elastic modulus, or the range in which the material's lie.

    Parameters
    ----------
    material : str
        Its name, in lower case.
    low, high : int [10⁶ lbf/in²]
        As printed; the same number twice where one is printed.

    Examples
    --------
    >>> MODULI["wood"].is_range, MODULI["wood"].pascals
    (True, (6894757293.168362, 13789514586.336723))
    """

    material: str
    low: int
    high: int

    @property
    def is_range(self) -> bool:
        """True if two numbers are printed."""
        return self.low != self.high

    @property
    def pascals(self) -> tuple[float, float]:
        """Both ends of the range [Pa]."""
        return float(self.low * 10**6 * PASCALS), float(self.high * 10**6 * PASCALS)

    def _line(self) -> str:
        return f"Modulus({self})"

    def __str__(self) -> str:
        low, high = (f"{value / 1e9:.3g}" for value in self.pascals)
        if not self.is_range:
            return f"{self.material}, {self.low} million lbf/in2 ({low} GPa)"
        return f"{self.material}, {self.low} to {self.high} million lbf/in2 ({low} to {high} GPa)"


#: The table, by material, in its own order.
MODULI: Catalogue[Modulus] = Catalogue(
    "elastic moduli",
    {
        line.material: line
        for line in (
            Modulus("wood", 1, 2),
            Modulus("concrete", 3, 3),
            Modulus("marble", 8, 8),
            Modulus("aluminum", 10, 10),
            Modulus("brass", 15, 15),
            Modulus("cast iron", 10, 20),
            Modulus("steel", 30, 30),
        )
    },
)


@dataclass(frozen=True, slots=True, repr=False)
class Material(Shown):
    """Typical numbers of a material; measure yours where a per cent matters.

    Parameters
    ----------
    name : str
    elastic_modulus : float [Pa]
    density : float [kg/m³]
    poisson_ratio : float
    """

    name: str
    elastic_modulus: float
    density: float
    poisson_ratio: float


def _reported(name: str, density: float, poisson_ratio: float) -> Material:
    return Material(name, MODULI[name].pascals[0], density, poisson_ratio)


#: Materials of the command line: the report's moduli where it has one number; the rest is typical, rounded.
MATERIALS: Catalogue[Material] = Catalogue(
    "materials",
    {
        line.name: line
        for line in (
            _reported("aluminum", 2700.0, 0.33),
            _reported("brass", 8500.0, 0.34),
            _reported("concrete", 2400.0, 0.2),
            _reported("steel", 7850.0, 0.29),
            # AISI 304 and Ti-6Al-4V, annealed: data sheets of ASM Aerospace Specification Metals.
            Material("stainless steel", 193e9, 8000.0, 0.29),
            Material("titanium", 113.8e9, 4430.0, 0.342),
        )
    },
)

_ALIASES = {"aluminium": "aluminum"}


def plain_name(material: object, table: Mapping[str, object]) -> object:
    """Return a material's name as a table has it, or what was given where it has none.

    Examples
    --------
    >>> plain_name("Stainless_Steel", MATERIALS), plain_name("aluminium", MODULI)
    ('stainless steel', 'aluminum')
    """
    if not isinstance(material, str):
        return material
    name = " ".join(material.lower().replace("_", " ").split())
    return name if name in table else _ALIASES.get(name, material)


def elastic_modulus(material: str, *, unit: str = "Pa", at: float | None = None) -> float:
    """Return the report's elastic modulus of a material.

        E = low + at (high - low)

    Parameters
    ----------
    material : str
        One of `MODULI`, in any case of letters; "aluminium" is aluminum.
    unit : str
        "Pa" or "lbf/in2".
    at : float, optional
        Where in a range, from 0 at its low end to 1 at its high one. A range has no modulus without it, and
        a material with one number takes none.

    Returns
    -------
    float
        E in the unit that is asked for.

    Raises
    ------
    TypeError, ValueError
        If the material or the unit is unknown, or `at` is missing for a range, given for a single number,
        or not within 0..1.

    References
    ----------
    P. Mitiguy, Flexible beams in Working Model, "Elastic Modulus Examples".

    Examples
    --------
    >>> elastic_modulus("steel")
    206842718795.05084
    >>> elastic_modulus("wood", unit="lbf/in2", at=0.5)
    1500000.0
    """
    line = MODULI[choice("material", plain_name(material, MODULI), MODULI)]
    factor = _UNITS[choice("unit", unit, _UNITS)] * 10**6
    if at is None:
        if line.is_range:
            raise ValueError(f"at must be given, from 0 to 1, for the range of {line}")
        return float(line.low * factor)
    if not line.is_range:
        raise ValueError(f"at must be left out for the one number of {line}, got {shown(at)}")
    part = real("at", at)
    if not 0.0 <= part <= 1.0:
        raise ValueError(f"at must be from 0 to 1, within the range of {line}, got {shown(at)}")
    return float((line.low + Fraction(part) * (line.high - line.low)) * factor)
