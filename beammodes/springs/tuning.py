"""Chains whose wall springs are tuned to one mode: its leading error removed, in closed form.

A rule of the registry is right for all modes in the limit of many segments. With few segments and one mode
that matters one can do better by giving up the rest. The springs hold for the stated boundary only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import ClassVar, overload

from beammodes.chains.rules import RULES, Rule, Weight, hinges_at_nodes
from beammodes.checks import Shown, whole_number
from beammodes.exact.exact_beam import plain_modes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.motions import motion_named
from beammodes.springs.axial_tuning import AxialTuned

__all__ = ["ModeTuned", "mode_tuned"]


@dataclass(frozen=True, repr=False)
class ModeTuned(Shown):
    """Chains whose wall springs remove the 1/N² error of one mode; `mode_tuned` makes it.

    Parameters
    ----------
    mode : int
        n, the elastic mode that it is tuned to.

    Examples
    --------
    >>> ModeTuned(1).hinge_weights("pinned-clamped", 3)[:2]
    [Fraction(1, 1), Fraction(1, 1)]
    """

    mode: int
    rotary_inertia: ClassVar[Fraction] = Fraction(1, 12)

    def __post_init__(self) -> None:
        object.__setattr__(self, "mode", whole_number("mode", self.mode, most=10**4))

    @property
    def name(self) -> str:
        """Name in tables, such as "mode_tuned(2)"."""
        return f"mode_tuned({self.mode})"

    def rule_for(self, boundary: BoundaryLike) -> Rule:
        """Return the rule for one pair of ends; its wall weight is exact but for the rounding of σ_n β_n.

        Examples
        --------
        >>> rule = ModeTuned(1).rule_for("clamped-free")
        >>> round(float(1 / rule.clamped[0].at(Fraction(10))), 6)        # the report's: 60/29 = 2.068966
        2.09618
        """
        return _mode_tuned_rule(self.mode, Boundary.of(boundary).canonical.name)

    def hinge_weights(self, boundary: BoundaryLike, segments: int) -> list[Fraction]:
        """Return the flexibility weights of the hinges, left to right, shape (hinges,)."""
        return self.rule_for(boundary).hinge_weights(Boundary.of(boundary), segments)

    def piece_lengths(self, boundary: BoundaryLike, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right: hinges at the walls."""
        return hinges_at_nodes(Boundary.of(boundary), segments)


@overload
def mode_tuned(mode: int) -> ModeTuned: ...


@overload
def mode_tuned(mode: int, *, motion: str) -> ModeTuned | AxialTuned: ...


def mode_tuned(mode: int, *, motion: str = "bending") -> ModeTuned | AxialTuned:
    """Return the rule that removes the 1/N² error of mode n, whatever the ends.

        w = 1/2 - σ_n β_n / (6 N),   σ_n β_n = L |φ'''|/|φ''| at the wall,

    a wall spring 6N/(3N - σ_n β_n) EI/ell. What remains of mode n's error is of order 1/N⁴ (measured;
    -β⁴/(1440 N⁴), as inside the chain, for all pairs but clamped-free); other modes keep order 2. The
    report's rule is this with σ β = 1. Chains with N ≤ σ_n β_n / 3 would need a wall without a positive
    spring: `Chain` refuses them.

    Parameters
    ----------
    mode : int
        n, from 1.
    motion : str
        "bending"; with "twist" or "stretch" the record is for these, and mode n exact (`AxialTuned`).

    Returns
    -------
    ModeTuned or AxialTuned
        To be given as `rule=`.

    Raises
    ------
    TypeError, ValueError
        If `mode` is not a whole number in 1..10000, or `motion` unknown.

    References
    ----------
    The quadrature law: hinge flexibilities are the weights of a trapezoidal rule for ∫ M²/EI, whose end
    error at a clamped end is proportional to (M²)'; the weight's 1/N term takes it away for one mode.

    Examples
    --------
    >>> from beammodes import Chain, linearize, solve_modes
    >>> chain = Chain(Beam.unit(), "clamped-free", 10, mode_tuned(2).rule_for("clamped-free"))
    >>> exact = plain_modes(Beam.unit(), "clamped-free", 3).angular_frequency
    >>> (100 * (solve_modes(linearize(chain), 3).angular_frequency / exact - 1)).round(3)        # %
    array([ 1.154, -0.003, -1.095])
    """
    if motion_named(motion).along:
        return AxialTuned(mode)
    return ModeTuned(mode)


@lru_cache(maxsize=256)
def _mode_tuned_rule(mode: int, pair: str) -> Rule:
    boundary = Boundary.of(pair)
    wall = Weight(Fraction(1, 2))
    if boundary.left.word == "clamped":
        # One wall serves both: the ends of a clamped-clamped mode are alike.
        exact = plain_modes(Beam.unit(), boundary, mode)
        curvature, rate = (abs(float(exact.shape(0.0, order)[-1])) for order in (2, 3))
        wall = Weight(Fraction(1, 2), -Fraction(rate / curvature) / 6)
    return replace(
        RULES["mitiguy"],
        name=f"mode_tuned({mode})",
        summary=f"Hinge at the wall with 6N/(3N - s) EI/ell, EI/ell inside; s = {_text(wall)} takes the 1/N² "
        f"error off mode {mode} of a {pair} beam, not off the others.",
        used_by="nobody yet",
        source="end correction of the trapezoidal rule for one mode's bending moment",
        clamped=(wall,),
    )


def _text(wall: Weight) -> str:
    return f"{-6 * float(wall.per_segment):.6g}"
