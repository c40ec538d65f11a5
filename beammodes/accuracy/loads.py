"""Static loads and the response to one of them: what the beam's and the chain's statics have in common.

Both are seen with the firmer end at x = 0 and the *tip*, the less firm end, at x = L; deflections, forces and
distributed load point up, rotations and moments are counter-clockwise. Loads are of unit size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import NamedTuple

from beammodes.chains.pieces import Number
from beammodes.chains.units import Units
from beammodes.checks import shown
from beammodes.problem.ends import BOUNDARIES, Boundary

__all__ = ["LENGTHS", "LOADS", "Loads", "Response", "Statics", "at_tip", "unit_loads", "without_rigid_motion"]

Loads = tuple[Fraction, Fraction, Fraction]

# The power of a length in the rotation that a load causes; deflections have one more.
LENGTHS = MappingProxyType({"tip_force": 1, "tip_moment": 0, "uniform_load": 2})

#: The loads: a force or a moment at the tip, or a load spread evenly over the whole length.
LOADS: tuple[str, ...] = tuple(LENGTHS)


class Response(NamedTuple):
    """Deflection and rotation at the tip, NaN where the tip is held, and deflection at midspan."""

    deflection: Number
    rotation: Number
    midspan_deflection: Number


@dataclass(frozen=True, slots=True, repr=False)
class Statics:
    """Response to a load of unit size, 1 N, 1 N m or 1 N/m; `beam_statics` and `chain_statics` make it.

    Parameters
    ----------
    load : str
        One of `LOADS`.
    units : Units
        What one stands for in `own`: L and EI/L of a beam, the chain's own units of a chain.
    own : Response
        The response in these units, in which a beam and a chain made by a rule are exact fractions.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.accuracy.statics import beam_statics
    >>> beam = Beam(length=2.0, bending_stiffness=80.0, mass_per_length=1.0)
    >>> sag = beam_statics(beam, "clamped-free", "tip_force")
    >>> sag.own.deflection, sag.deflection                          # F L³ / (3 EI)
    (Fraction(1, 3), 0.03333333333333333)
    >>> print(sag)
    Statics(tip_force of 1 N: deflection 0.0333333 m, rotation 0.025 rad, midspan deflection 0.0104167 m)
    """

    load: str
    units: Units
    own: Response

    @property
    def deflection(self) -> float:
        """Deflection of the tip [m]; NaN where the tip's deflection is held."""
        return self._physical(self.own.deflection, 1)

    @property
    def rotation(self) -> float:
        """Rotation of the tip [rad]; NaN where the tip's rotation is held."""
        return self._physical(self.own.rotation, 0)

    @property
    def midspan_deflection(self) -> float:
        """Deflection half way between the ends [m]."""
        return self._physical(self.own.midspan_deflection, 1)

    def __repr__(self) -> str:
        one = {"tip_force": "1 N", "tip_moment": "1 N m", "uniform_load": "1 N/m"}[self.load]
        values = (
            ("deflection", self.deflection, "m"),
            ("rotation", self.rotation, "rad"),
            ("midspan deflection", self.midspan_deflection, "m"),
        )
        told = (f"{name} {value:.6g} {unit}" for name, value, unit in values if not math.isnan(value))
        return f"Statics({self.load} of {one}: {', '.join(told)})"

    def _physical(self, value: Number, lengths: int) -> float:
        # A product leaves the range of doubles as inf, where a power would raise an unhelpful error.
        scale = math.prod([self.units.length] * (LENGTHS[self.load] + lengths))
        return float(value) * scale / self.units.stiffness


def without_rigid_motion(boundary: Boundary) -> Boundary:
    """Return `boundary`, or raise ValueError if it has elastic supports or lets the beam move."""
    if boundary.left.is_elastic or boundary.right.is_elastic:
        raise ValueError(f"boundary must hold its ends or leave them free, not on springs, got {boundary}")
    if boundary.rigid_body_modes:
        firm = ", ".join(pair.name for pair in BOUNDARIES if not pair.rigid_body_modes)
        raise ValueError(f"boundary must hold the beam still ({firm}), got {shown(boundary.name)}")
    return boundary


def unit_loads(load: str) -> Loads:
    """Return tip force, tip moment and load per length."""
    force, moment, spread = (Fraction(name == load) for name in LOADS)
    return force, moment, spread


def at_tip(boundary: Boundary, deflection: Number, rotation: Number, midspan: Number) -> Response:
    """Return the response of a beam or chain, leaving out what its tip holds."""
    tip = boundary.right
    return Response(
        math.nan if tip.holds_deflection else deflection,
        math.nan if tip.holds_rotation else rotation,
        midspan,
    )
