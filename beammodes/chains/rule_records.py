"""Discretization rules: where a chain's hinges sit and how stiff they are, in exact numbers.

A rule cuts a beam of N equal segments of length ell at hinges and gives each hinge a rotational spring
`EI / (w ell)`. The *flexibility weight* w is 1 inside; near an end whose rotation is held a rule corrects
it. The weights are the weights of a quadrature: the beam's flexibility is the integral of M²/EI along it,
the chain's is the sum of w ell M²/EI over its hinges, so a rule is as good as its quadrature at the ends.

Corrections to the weight 1 are *added* from both ends, so a short chain, on which they overlap, needs no
special case: the third-order end weights of Gregory become Simpson's rules on two and three segments.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

from beammodes.checks import shown
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load, checked_load

__all__ = ["MAX_END_WEIGHTS", "Layout", "Rule", "RuleMaker", "Weight"]


#: Errors of rules that change more springs at an end would lose digits: their series run out of terms.
MAX_END_WEIGHTS = 8


@dataclass(frozen=True, slots=True)
class Weight:
    """A flexibility weight  w = constant + per_segment / N  (dimensionless, exact).

    Examples
    --------
    >>> Weight(Fraction(1, 2), Fraction(-1, 6)).at(Fraction(4))      # the report's wall, N = 4
    Fraction(11, 24)
    """

    constant: Fraction
    per_segment: Fraction = Fraction(0)

    def at(self, segments: Any) -> Any:
        """Return the weight for N segments, in whatever algebra N belongs to; floats for an array."""
        if hasattr(segments, "dtype"):
            return float(self.constant) + float(self.per_segment) / segments
        return self.constant + self.per_segment / segments


@dataclass(frozen=True)
class Rule:
    """A way to turn a beam into a chain of rigid segments and springs.

    Parameters
    ----------
    name : str
        The word that users type.
    summary, used_by, source : str
        What it does in one sentence; who uses it; where it comes from.
    clamped, guided : tuple of Weight
        Weights of the hinges nearest an end of that kind, the end's own hinge first.
        Ends free of bending moment (pinned, free) have no hinge and correct nothing. `End.statics` says
        which of the four applies to an end with springs or a body.
    order : mapping from str to int
        Declared order of the frequency error for the kinds of end, and for "inside": e ~ 1/N**order.
    stub : Fraction
        Length, in segments, of the rigid piece fixed to an end whose rotation is held: 0 puts a hinge
        at the wall, 1/2 puts every hinge at a segment's middle, 1 welds the whole first segment.
    rotary_inertia : Fraction
        Central rotary inertia of a piece over its mass times length²: 1/12 for a rod, 1/4 for point
        masses at its two ends.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> RULES["mitiguy"].hinge_weights(Boundary.of("clamped-clamped"), 4)
    [Fraction(11, 24), Fraction(1, 1), Fraction(1, 1), Fraction(1, 1), Fraction(11, 24)]
    """

    name: str
    summary: str
    used_by: str
    source: str
    clamped: tuple[Weight, ...]
    guided: tuple[Weight, ...]
    order: Mapping[str, int]
    stub: Fraction = Fraction(0)
    rotary_inertia: Fraction = Fraction(1, 12)

    def __post_init__(self) -> None:
        if self.stub not in (0, Fraction(1, 2), 1):
            raise ValueError(f"stub must be 0, 1/2 or 1 segment, got {shown(self.stub)}")
        if set(self.order) != {"inside", "clamped", "pinned", "guided", "free"}:
            raise ValueError(f"order must declare inside and the four ends, got {shown(dict(self.order))}")
        for name in ("clamped", "guided"):
            if len(getattr(self, name)) > MAX_END_WEIGHTS:
                raise ValueError(
                    f"{name} must have at most {MAX_END_WEIGHTS} weights, got {len(getattr(self, name))}"
                )
        object.__setattr__(self, "order", MappingProxyType(dict(self.order)))

    def __reduce__(self) -> tuple[type[Rule], tuple[object, ...]]:
        # Copies are made from the dict: its read-only view cannot be copied.
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return Rule, tuple((values | {"order": dict(self.order)}).values())

    def __hash__(self) -> int:
        return hash((self.name, self.clamped, self.guided, self.stub, self.rotary_inertia))

    def declared_order(self, boundary: Boundary, load: Load | None = None) -> int:
        """Return p in e ~ 1/N**p: the smallest of inside and both ends, and at best 2 under load.

        Elastic supports and end bodies are included. Loads along the beam, spin, buckling loads and large
        deflections have order 2, and so has a section's rotary inertia.
        """
        # Without a hinge for its last half segment an end that feels a moment has the error M²/(4N).
        orders = {**self.order, "carried": 2 if self.stub == Fraction(1, 2) else 1}
        ends = (boundary.left.statics, boundary.right.statics)
        order = min(self.order["inside"], *(orders[end] for end in ends))
        return order if checked_load(load) == Load() else min(order, 2)

    def end_weights(self, end: End) -> tuple[Weight, ...]:
        """Return the weights that this rule prescribes at `end`, the end's own hinge first."""
        return {"clamped": self.clamped, "guided": self.guided}.get(end.statics, ())

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right.

        An end that can bend the beam acts on a piece of its own: of length zero where the hinge is at
        the wall. An end without moment (pinned, free, a point mass) acts on the outermost rod.
        """
        one, half = Fraction(1), Fraction(1, 2)
        if self.stub == half:
            return [half, *[one] * (segments - 1), half]
        at_wall = [] if self.stub else [Fraction(0)]
        left = at_wall if boundary.left.statics in ("clamped", "guided") else []
        right = at_wall if boundary.right.statics in ("clamped", "guided") else []
        return [*left, *[one] * segments, *right]

    def hinge_weights(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the flexibility weights of the chain's hinges, left to right."""
        count = len(self.piece_lengths(boundary, segments)) - 1
        weights = [Fraction(1)] * count
        size = Fraction(segments)
        for end, indices in ((boundary.left, range(count)), (boundary.right, range(count - 1, -1, -1))):
            for j, weight in zip(indices, self.end_weights(end), strict=False):
                weights[j] += weight.at(size) - 1
        return weights


@runtime_checkable
class Layout(Protocol):
    """What a chain needs of a rule; records that need spectra to be made (tuned, matched) offer it too."""

    @property
    def name(self) -> str:
        """How errors and tables name it."""

    @property
    def rotary_inertia(self) -> Fraction:
        """Central rotary inertia of a piece over its mass times length²."""

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right."""

    def hinge_weights(self, boundary: Boundary, segments: int) -> Sequence[Fraction | float]:
        """Return the flexibility weights of the chain's hinges, left to right."""


@runtime_checkable
class RuleMaker(Protocol):
    """A record that makes a different rule for each boundary, such as `mode_tuned` gives."""

    def rule_for(self, boundary: Boundary) -> Rule:
        """Return the rule for a boundary."""
