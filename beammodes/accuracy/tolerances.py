"""Tolerances of a beam's material and dimensions: how they are distributed, and of what they may be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import choice, positive_real, shown
from beammodes.problem.section_shape import Section
from beammodes.problem.sections import Tube

__all__ = ["Tolerance", "dimensions_of", "given_tolerances"]

#: Wider ones would make beams of no thickness, or of a negative one.
_WIDEST = {"uniform": 1.0, "normal": 0.1}

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far a number may be from its nominal value, as a fraction of it.

    Parameters
    ----------
    size : float
        Half the width of a uniform distribution, less than 1, or the standard deviation of a normal one, at
        most 0.1.
    distribution : str
        "uniform" or "normal".

    Raises
    ------
    TypeError, ValueError
        If `size` is no real number greater than 0 and within its limit, or the distribution is unknown.

    Examples
    --------
    >>> Tolerance(0.03).standard_deviation == 0.03 / math.sqrt(3)
    True
    """

    size: float
    distribution: str = "uniform"

    def __post_init__(self) -> None:
        choice("distribution", self.distribution, _WIDEST)
        size, widest = positive_real("size", self.size), _WIDEST[self.distribution]
        if size > widest or size == 1.0:
            raise ValueError(
                f"size must be {'less than 1' if widest == 1.0 else f'at most {widest}'} "
                f"for a {self.distribution} distribution, got {shown(self.size)}"
            )
        object.__setattr__(self, "size", size)

    @property
    def standard_deviation(self) -> float:
        """σ over the nominal value."""
        return self.size / math.sqrt(3) if self.distribution == "uniform" else self.size

    def factors(self, generator: np.random.Generator, count: int) -> Array:
        """Return random multiples of the nominal value, shape (count,)."""
        if self.distribution == "uniform":
            return generator.uniform(1 - self.size, 1 + self.size, count)
        return generator.normal(1.0, self.size, count)

    def __str__(self) -> str:
        return (
            f"{self.distribution} {'±' if self.distribution == 'uniform' else 'σ = '}{100 * self.size:.3g} %"
        )


def dimensions_of(section: Section) -> dict[str, float]:
    """Return a section's dimensions by name, as its class takes them; none of one from elsewhere.

    Raises
    ------
    TypeError
        If it lacks an area or a second moment.

    Examples
    --------
    >>> dimensions_of(Tube(0.05, wall=0.002))
    {'outer': 0.05, 'wall': 0.002}
    """
    for name in ("area", "second_moment"):
        if not hasattr(section, name):
            raise TypeError(f"section must have its {name}, got {shown(section)}")
    if not hasattr(section, "__dataclass_fields__"):
        return {}
    # A tube takes two of its three numbers; its wall keeps the digits of a thin one.
    kept: Any = section
    return {f.name: float(getattr(kept, f.name)) for f in fields(kept) if not _redundant(section, f.name)}


def _redundant(section: Section, name: str) -> bool:
    return isinstance(section, Tube) and name == "inner"


def given_tolerances(given: Any, values: Mapping[str, float]) -> dict[str, Tolerance]:
    """Return the tolerances that a mapping gives, each of one of the named values.

    Raises
    ------
    TypeError, ValueError
        If it is no mapping, empty, or names or sizes are not allowed.
    """
    if not isinstance(given, Mapping):
        raise TypeError(f"tolerances must map names to numbers, got {shown(given)}")
    if not given:
        raise ValueError(f"tolerances must name at least one of {', '.join(values)}, got none")
    found = {}
    for name, part in given.items():
        choice("name of a tolerance", name, values)
        try:
            found[name] = part if isinstance(part, Tolerance) else Tolerance(part)
        except (TypeError, ValueError) as error:
            raise type(error)(f"tolerance of {name}: {error}") from None
    return found
