"""What fixed tendons hold of a chain's tip: sums of joint coordinates that are its deflection or rotation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from beammodes.auditing.body_tree import ModelTie
from beammodes.auditing.bounded_xml import BadModel

__all__ = ["FarEnd", "far_end"]

_SAME = 1e-6


@dataclass(frozen=True)
class FarEnd:
    """Stiffnesses under the tip, its place if a tie says it, and the name of the tie that resists turning."""

    across: float = 0.0
    turning: float = 0.0
    place: float | None = None
    spring: str = ""


def far_end(
    ties: Sequence[ModelTie], hinges: Mapping[str, tuple[float, float]], slides: Mapping[str, float]
) -> FarEnd:
    """Return what the ties on a chain's joints do at its tip.

    A tie is the tip's rotation if all hinges count alike, and its deflection if each counts by its distance
    from one point beyond them, as `export_chain` writes both.

    Parameters
    ----------
    ties : sequence of ModelTie
    hinges : mapping
        For every hinge that turns the chain, its place along it and 1.0, or -1.0 if it turns the other way.
    slides : mapping
        For every slide across the chain 1.0, or -1.0 if it goes down.

    Raises
    ------
    BadModel
        If a tie is neither.

    Examples
    --------
    >>> tie = ModelTie("tip", (("a", 2.0), ("b", 1.0)), 30.0)
    >>> far_end([tie], {"a": (0.0, 1.0), "b": (1.0, 1.0)}, {})
    FarEnd(across=30.0, turning=0.0, place=2.0, spring='')
    """
    found = FarEnd()
    for tie in ties:
        coefficients = dict(tie.terms)
        if not (tie.stiffness or tie.refusal) or not coefficients.keys() & (hinges.keys() | slides.keys()):
            continue
        if tie.refusal:
            raise BadModel(tie.refusal)
        turns = [(place, way * coefficients.pop(name, 0.0)) for name, (place, way) in hinges.items()]
        shift = [way * coefficients.pop(name, 0.0) for name, way in slides.items()]
        if any(coefficients.values()):
            raise BadModel(f"tendon {tie.name} must join hinges of the chain only")
        found = _with(found, tie, turns, shift)
    return found


def _with(end: FarEnd, tie: ModelTie, turns: list[tuple[float, float]], shift: list[float]) -> FarEnd:
    (first, lead), (last, rest) = turns[0], turns[-1]
    alike = not any(shift) and all(abs(value - lead) <= _SAME * abs(lead) for _, value in turns)
    # Of one hinge alone a number cannot tell; 1 is its rotation, anything else a distance.
    if alike and (len(turns) > 1 or shift or (abs(lead) == 1 and tie.stiffness < math.inf)):
        return FarEnd(end.across, end.turning + _times(tie.stiffness, lead), end.place, tie.name)
    scale = shift[0] if any(shift) else 1.0 if last == first else (lead - rest) / (last - first)
    place = first + lead / scale if scale else math.nan
    fits = all(abs(value - scale * (place - at)) <= _SAME * max(abs(lead), abs(scale)) for at, value in turns)
    if not (fits and math.isfinite(place) and place >= last * (1 - _SAME)):
        raise BadModel(f"tendon {tie.name} must be the deflection or the rotation of the chain's tip")
    return FarEnd(end.across + _times(tie.stiffness, scale), end.turning, place, end.spring)


def _times(stiffness: float, scale: float) -> float:
    return math.inf if stiffness == math.inf else stiffness * scale**2
