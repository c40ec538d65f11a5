"""How many segments are enough for a beam whose own frequencies are known only so well.

A chain's error well inside what the beam's tolerances leave open is not worth more segments.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beammodes.accuracy.errors import frequency_error, segments_needed
from beammodes.chains.rules import AnyRule, layout_of
from beammodes.checks import positive_real, shown

if TYPE_CHECKING:
    import xarray

__all__ = ["EnoughSegments", "segments_within_spread"]


@dataclass(frozen=True)
class EnoughSegments:
    """How many segments keep a chain's error inside the spread of the beam itself; `str` says it.

    Attributes
    ----------
    rule : str
    segments : int
    modes : int
    largest_error : float
        Largest |e| of those modes with that many segments.
    half_width : float
        Of the beam's own 95 % band, in the mode in which it is narrowest.
    fraction : float
        What part of that the error may be.
    """

    rule: str
    segments: int
    modes: int
    largest_error: float
    half_width: float
    fraction: float

    def __str__(self) -> str:
        which = "mode 1" if self.modes == 1 else f"modes 1 to {self.modes}"
        return (
            f"{self.segments} segments by rule {self.rule} are enough: their error in {which}, at most "
            f"{100 * self.largest_error:.2g} %, stays below {100 * self.fraction:.0f} % of what the beam "
            f"itself leaves open, ±{100 * self.half_width:.2g} % (95 %)"
        )


def segments_within_spread(
    spread: xarray.Dataset, rule: AnyRule = "mitiguy", *, fraction: float = 1 / 3
) -> EnoughSegments:
    """Return the fewest segments whose error stays below a fraction of the beam's own spread.

        N = min { n : |e_k(n')| ≤ fraction · U for all n' ≥ n and every mode k }

    U is half the width of the 95 % band, of the narrowest mode. At a third of it the error, added as an
    independent one, widens the band by 5 %: √(1 + 1/9).

    Parameters
    ----------
    spread : xarray.Dataset
        From `frequency_spread`, whose modes and ends count.
    rule : str or Rule
    fraction : float
        Greater than 0 and at most 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no chain of up to 10⁹ segments is that good.

    Examples
    --------
    >>> from beammodes.accuracy.uncertainty import frequency_spread
    >>> from beammodes.problem.sections import Rectangle
    >>> spread = frequency_spread(Rectangle(0.06, 0.02), "clamped-free", {"height": 0.025}, samples=1000,
    ...                           elastic_modulus=207e9, density=7850.0, length=1.0)
    >>> print(segments_within_spread(spread, "gregory"))
    9 segments by rule gregory are enough: their error in modes 1 to 3, at most 0.41 %, stays below 33 % of
    what the beam itself leaves open, ±2.4 % (95 %)
    """
    import xarray

    if not isinstance(spread, xarray.Dataset) or "half_width" not in spread or "boundary" not in spread.attrs:
        raise TypeError(
            f"spread must be a Dataset from frequency_spread(), got {shown(type(spread).__name__)}"
        )
    part = positive_real("fraction", fraction)
    if not 1e-12 <= part <= 1.0:
        raise ValueError(f"fraction must be at least 1e-12 and at most 1, got {shown(fraction)}")
    width, modes = float(spread.half_width.min()), spread.sizes["mode"]
    boundary: str = spread.attrs["boundary"]
    count = segments_needed(boundary, part * width, modes, rule)
    mode = np.arange(1, modes + 1)
    error = np.abs(frequency_error(boundary, segments=count, mode=mode, rule=rule))
    return EnoughSegments(layout_of(rule).name, count, modes, float(error.max()), width, part)
