"""Loads at places of a beam or a structure: forces and moments at points, and loads spread along members."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from beammodes.checks import Shown, bounded, is_text, shown, unwrapped
from beammodes.problem.loading import Number, kept_number
from beammodes.problem.profiles import Table, check_kinds

__all__ = ["AppliedLoad", "LineLoad", "PointLoad"]

_MOST_COEFFICIENTS = 20


@dataclass(frozen=True, repr=False)
class PointLoad(Shown):
    """A force and a moment at a place; numbers given as `Fraction` stay exact.

    Parameters
    ----------
    x : float, optional [m]
        Distance from the member's start, 0 to its length; None for a load at a joint.
    force : float or (float, float) [N]
        Across the member, to the left of one who goes along it: up on a beam that lies along x. Or components
        (F_x, F_y) along the axes of the plane, which a load at a joint needs.
    moment : float [N m]
        Counter-clockwise; inside a member not on a hinge, where it would be ambiguous.
    member : str, optional
        Name of the member, such as "foot-corner", where there are several.
    joint : str, optional
        Name of the joint, in place of x and member.

    Raises
    ------
    TypeError, ValueError
        If a number is not real or not finite, x is negative, or both or neither of x and a joint are given.

    Examples
    --------
    >>> PointLoad(0.6, force=-20.0).force
    -20.0
    """

    x: Number | None = None
    force: Number | tuple[Number, Number] = 0.0
    moment: Number = 0.0
    member: str | None = None
    joint: str | None = None

    def __post_init__(self) -> None:
        if (self.x is None) == (self.joint is None):
            raise ValueError(
                f"x or a joint must be given, and not both, got {shown(self.x)} and {shown(self.joint)}"
            )
        _check_words(member=self.member, joint=self.joint)
        if self.joint is not None and self.member is not None:
            raise ValueError(f"member must be left out of a load at a joint, got {shown(self.member)}")
        if self.x is not None:
            object.__setattr__(self, "x", _place("x", self.x))
        pair: Any = _listed("force", self.force)
        if isinstance(pair, Sequence) and not is_text(pair):
            items = bounded("force", pair, most=2)
            if len(items) != 2:
                raise ValueError(f"force must be a number or two components, got {shown(pair)}")
            pair = (kept_number("force", items[0]), kept_number("force", items[1]))
        elif self.joint is not None and kept_number("force", pair):
            raise ValueError(f"force must be two components (F_x, F_y) at a joint, got {shown(pair)}")
        else:
            pair = kept_number("force", pair)
        object.__setattr__(self, "force", pair)
        object.__setattr__(self, "moment", kept_number("moment", self.moment))


@dataclass(frozen=True, repr=False)
class LineLoad(Shown):
    """A load spread along a member, across it; numbers given as `Fraction` stay exact.

    Parameters
    ----------
    per_length : float, sequence of float, or Table [N/m]
        A number; the coefficients of a polynomial in x, the distance from the member's start, in ascending
        powers; or a table from 0 to the member's length, linear between its positions, with steps where one
        is given twice. It points to the left of one who goes along the member: up on a beam along x.
    start, stop : float, optional [m]
        Where on the member it begins and ends; the whole of it by default.
    member : str, optional
        Name of the member, where there are several.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or `stop` is not beyond `start`.

    Examples
    --------
    >>> LineLoad((0, -3), stop=2.0)          # from nothing at x = 0 to 6 N/m down at x = 2
    LineLoad(per_length=(0.0, -3.0), stop=2.0)
    """

    per_length: Number | tuple[Number, ...] | Table
    start: Number = 0.0
    stop: Number | None = None
    member: str | None = None

    def __post_init__(self) -> None:
        given: Any = _listed("per_length", self.per_length)
        if isinstance(given, Sequence) and not is_text(given):
            listed = bounded("per_length", given, most=_MOST_COEFFICIENTS)
            if not listed:
                raise ValueError(f"per_length must have one coefficient at least, got {shown(given)}")
            given = tuple(kept_number("per_length", c) for c in listed)
        elif isinstance(given, Table):
            check_kinds("per_length", given)
        else:
            given = (kept_number("per_length", given),)
        object.__setattr__(self, "per_length", given)
        object.__setattr__(self, "start", _place("start", self.start))
        if self.stop is not None:
            object.__setattr__(self, "stop", _place("stop", self.stop))
            if self.stop <= self.start:
                raise ValueError(f"stop must be beyond start, {self.start}, got {shown(self.stop)}")
        _check_words(member=self.member)


AppliedLoad = PointLoad | LineLoad


def _check_words(**words: str | None) -> None:
    for name, word in words.items():
        if word is not None and not isinstance(word, str):
            raise TypeError(f"{name} must be the name of a {name}, got {shown(word)}")


def _listed(name: str, value: object) -> Any:
    plain = unwrapped(name, value)
    return plain.tolist() if isinstance(plain, np.ndarray) and plain.ndim == 1 else plain


def _place(name: str, value: object) -> Number:
    kept = kept_number(name, value)
    if kept < 0:
        raise ValueError(f"{name} must not be negative, got {shown(value)}")
    return kept
