"""The report's elastic moduli, as it prints them: in millions of lbf/in², some of them as a range.

The table follows the words "The Elastic Modulus of some common materials are:". What the scan reads, letter
by letter, and what is meant:

========================= ==================================== ============
the scan's line           meant                                GPa
========================= ==================================== ============
Wood 1-2 ... Ibffin2      wood, 1 to 2 million lbf/in²         6.89 to 13.8
Concrete 3 ... Ibf/in2    concrete, 3 million lbf/in²          20.7
Marble 8 ... Ibffin2      marble, 8 million lbf/in²            55.2
Aluminum 10 ... Tbf/in2   aluminum, 10 million lbf/in²         68.9
Brass 15 ... Ibf/in?      brass, 15 million lbf/in²            103
Cast Tron 10-20 ...       cast iron, 10 to 20 million lbf/in²  68.9 to 138
Steel 30 ... 1bf/in2      steel, 30 million lbf/in²            207
========================= ==================================== ============

Only letters are misread: Ibf, Tbf and 1bf are lbf, the second f of ffin2 is the stroke of f/in², in? is in²,
Tron is Iron; no digit is in doubt. The scan prints one system of units, so pascals here are converted, never
copied, and there is no second column to check against. The numbers are rounded to whole millions: one of 3
says no more than 2.5 to 3.5. The table has no densities.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from beammodes.checks import Catalogue, Shown, choice, real, shown

__all__ = ["MODULI", "PASCALS", "Modulus", "elastic_modulus"]

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
    scan : str
        The line as the scan reads it.

    Examples
    --------
    >>> MODULI["wood"].is_range, MODULI["wood"].pascals
    (True, (6894757293.168362, 13789514586.336723))
    """

    material: str
    low: int
    high: int
    scan: str

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
            Modulus("wood", 1, 2, "Wood 1-2 million Ibffin2"),
            Modulus("concrete", 3, 3, "Concrete 3 million Ibf/in2"),
            Modulus("marble", 8, 8, "Marble 8 million Ibffin2"),
            Modulus("aluminum", 10, 10, "Aluminum 10 million Tbf/in2"),
            Modulus("brass", 15, 15, "Brass 15 million Ibf/in?"),
            Modulus("cast iron", 10, 20, "Cast Tron 10-20 million Ibf/in2"),
            Modulus("steel", 30, 30, "Steel 30 million 1bf/in2"),
        )
    },
)

_ALIASES = {"aluminium": "aluminum"}


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
    word: object = material
    if isinstance(material, str):
        name = " ".join(material.lower().replace("_", " ").split())
        word = name if name in MODULI else _ALIASES.get(name, material)
    line = MODULI[choice("material", word, MODULI)]
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
