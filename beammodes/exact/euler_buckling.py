"""Euler's critical loads: the compression at which a uniform beam on any supports buckles."""

from __future__ import annotations

from decimal import Decimal, localcontext

from beammodes.checks import shown
from beammodes.exact.unit_beam import UnitBeam
from beammodes.numerics.count_roots import ordered_roots
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike

__all__ = ["critical_compression"]

# The clamped beam's 4 π² = 39.478..., which no support exceeds.
_ABOVE_ALL = Decimal("39.5")


def critical_compression(beam: Beam, boundary: BoundaryLike) -> float:
    """Return the smallest compression, by two dead loads on its ends, at which the straight beam buckles [N].

    The smallest P of  EI y'''' + P y'' = 0  with EI y'' and -EI y''' - P y' balanced by the supports.  On
    soft springs it may be a turn of the whole beam, straight as it is.  Bodies at the ends do not matter.

    Parameters
    ----------
    beam : Beam
        The uniform beam.
    boundary : str, pair of ends or Boundary
        Its ends, in either order.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam, `boundary` cannot be read, or it holds no rotation at all, such as
        "pinned-free": then the beam turns over under any compression.

    Source
    ------
    Timoshenko and Gere, Theory of Elastic Stability (1961), chapter 2.

    Examples
    --------
    >>> round(critical_compression(Beam.unit(), "clamped-pinned"), 6)
    20.190729
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    pair = Boundary.of(boundary)
    ends = (pair.left, pair.right)
    turns = not any(end.rotational_stiffness > 0 for end in ends)
    if turns and not all(end.translational_stiffness > 0 for end in ends):
        raise ValueError(
            "boundary must resist a turn of the whole beam, or it turns over under any compression, "
            f"got {pair}"
        )
    with localcontext(LONG):
        unit = UnitBeam.of(beam, pair)
        high = low = unit.static_sample(_ABOVE_ALL)
        decades = 1
        while low.below:
            low = unit.static_sample(_ABOVE_ALL.scaleb(-decades))
            decades *= 2
        relative = ordered_roots(unit.static_sample, low, high, 1)[0]
    return float(relative) * beam.mean_bending_stiffness / beam.length / beam.length
