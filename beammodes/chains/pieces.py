"""A chain's pieces, springs and supports as bare numbers: read, checked, joined to end bodies, condensed."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, repeat
from operator import is_
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import bounded, is_text, real, shown, unwrapped
from beammodes.numerics.arrays import Floats

__all__ = [
    "MAX_PIECES",
    "Body",
    "Number",
    "Pieces",
    "check_pieces",
    "check_turning",
    "each_once",
    "floats",
    "piece_numbers",
]


# Columns of exact numbers, in which neighbours are mostly one and the same object: each is worked out once.
#
# Fractions are slow to hash, to subtract and to turn into floats: for chains of a million pieces slower
# than to
# solve them.

Result = TypeVar("Result")


#: Of shorter columns, arrays of identities cost more than they save.
_SHORT = 64


def each_once(function: Callable[..., Result], *columns: Sequence[Any]) -> list[Result]:
    """Return `function` of every row, called once for a run of rows of identical objects.

    Examples
    --------
    >>> calls = []
    >>> each_once(lambda a, b: calls.append(a) or a + b, [0.5] * 100, [0.25] * 100) == [0.75] * 100, calls
    (True, [0.5])
    """
    if len(columns[0]) < _SHORT:
        return _each_of_few(function, columns)
    starts, lengths = _runs(columns)
    if len(starts) > len(columns[0]) // 4:
        return list(map(function, *columns))
    results = (function(*(column[i] for column in columns)) for i in starts.tolist())
    return list(chain.from_iterable(map(repeat, results, lengths.tolist())))


def _each_of_few(function: Callable[..., Result], columns: Sequence[Sequence[Any]]) -> list[Result]:
    results: list[Result] = []
    before: tuple[Any, ...] = ()
    for row in zip(*columns, strict=True):
        same = results and all(map(is_, row, before))
        results.append(results[-1] if same else function(*row))
        before = row
    return results


def floats(values: Sequence[Any]) -> Floats:
    """Return a column of numbers as an array of floats, shape (len(values),).

    Examples
    --------
    >>> from fractions import Fraction
    >>> floats([Fraction(1, 4), 2.0]).tolist()
    [0.25, 2.0]
    """
    if len(values) < _SHORT:
        return np.array(_each_of_few(float, [values]), dtype=np.float64)
    starts, lengths = _runs([values])
    if len(starts) > len(values) // 4:
        return np.array(values, dtype=np.float64)
    return np.repeat(np.array([float(values[i]) for i in starts.tolist()]), lengths)


def _runs(columns: Sequence[Sequence[Any]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return where runs of identical rows start, and how long they are."""
    count = len(columns[0])
    new = np.zeros(count, dtype=bool)
    new[0] = True
    for column in columns:
        # The columns keep their objects alive, so different objects have different ids.
        identity = np.fromiter(map(id, column), dtype=np.uintp, count=len(column))
        new[1:] |= identity[1:] != identity[:-1]
    starts = np.flatnonzero(new)
    return starts, np.diff(starts, append=count)


Number = Fraction | float


#: Mass, rotary inertia about the centre of mass, and how far outward of the end that lies.
Body = tuple[Number, Number, Number]


#: Longer chains are refused: their arrays alone would fill memory. Lookups of errors know no such limit.
MAX_PIECES = 10_000_000


class PieceFloats(NamedTuple):
    """Columns of `Pieces` as arrays of floats."""

    length: Floats
    mass: Floats
    centre: Floats
    rotary_inertia: Floats
    joint_stiffness: Floats


@dataclass(frozen=True)
class Pieces:
    """Pieces from left to right, the springs between them, and the stiffness of the two ends' supports.

    Attributes
    ----------
    length, mass, centre, rotary_inertia : tuple, one entry a piece
        `centre` is the distance of the centre of mass from the piece's left tip, and may lie outside the
        piece where an end body is part of it; the inertia is about that centre.
    joint_stiffness : tuple, one entry fewer
    supports : ((K_t, K_r), (K_t, K_r))
        Of the left and the right end, `math.inf` where they hold.
    """

    length: tuple[Number, ...]
    mass: tuple[Number, ...]
    centre: tuple[Number, ...]
    rotary_inertia: tuple[Number, ...]
    joint_stiffness: tuple[Number, ...]
    supports: tuple[tuple[Number, Number], tuple[Number, Number]]

    @cached_property
    def in_floats(self) -> PieceFloats:
        """The columns as arrays of floats, which are not to be changed."""
        names = ("length", "mass", "centre", "rotary_inertia", "joint_stiffness")
        columns = PieceFloats(*(floats(getattr(self, name)) for name in names))
        for column in columns:
            column.flags.writeable = False
        return columns

    def turned(self) -> Pieces:
        """Return the same chain seen from the other side."""
        centre = each_once(operator.sub, self.length, self.centre)
        return Pieces(
            self.length[::-1],
            self.mass[::-1],
            tuple(centre[::-1]),
            self.rotary_inertia[::-1],
            self.joint_stiffness[::-1],
            self.supports[::-1],
        )

    def with_bodies(self, left: Body, right: Body) -> Pieces:
        """Return these pieces with bodies fixed to the outer two, as parts of them."""
        pieces = self._with_left_body(*left)
        return pieces.turned()._with_left_body(*right).turned() if right[0] or right[1] else pieces

    def with_hubs(self, left: Number, right: Number) -> Pieces:
        """Return these pieces, the outer two of which reach on outward by so much, to a hub's axis."""
        pieces = self._with_left_hub(left) if left else self
        return pieces.turned()._with_left_hub(right).turned() if right else pieces

    def _with_left_hub(self, radius: Number) -> Pieces:
        return replace(
            self,
            length=(self.length[0] + radius, *self.length[1:]),
            centre=(self.centre[0] + radius, *self.centre[1:]),
        )

    def condensed(self) -> Pieces:
        """Return these pieces without outer ones that have nothing to move.

        An outer piece of length zero whose turning meets neither inertia nor a holding end has its hinge in
        series with the end's rotational spring: one spring k K_r/(k + K_r), none where K_r = 0. A point mass
        on it stays, at the tip of the next piece.
        """
        pieces = self._left_condensed()
        return pieces.turned()._left_condensed().turned() if pieces._is_inert(-1) else pieces

    def _is_inert(self, outer: int) -> bool:
        """Say whether the first (0) or last (-1) piece has nothing to move, and may be left out."""
        moved = self.length[outer] or self.rotary_inertia[outer] or self.mass[outer] * self.centre[outer]
        return not moved and self.supports[outer][1] != math.inf and len(self.length) > 1

    def _with_left_body(self, mass: Number, inertia: Number, offset: Number) -> Pieces:
        if not mass and not inertia:
            return self
        own, centre = self.mass[0], self.centre[0]
        total = own + mass
        apart = centre + offset
        turning = self.rotary_inertia[0] + inertia
        if total:
            # The common centre of mass, and both about it.
            turning += own * mass / total * apart**2
            centre = (own * centre - mass * offset) / total
        return replace(
            self,
            mass=(total, *self.mass[1:]),
            centre=(centre, *self.centre[1:]),
            rotary_inertia=(turning, *self.rotary_inertia[1:]),
        )

    def _left_condensed(self) -> Pieces:
        if not self._is_inert(0):
            return self
        (translation, rotation), right = self.supports
        hinge = self.joint_stiffness[0]
        series = hinge / (1 + hinge / rotation) if rotation else rotation
        rest = Pieces(
            self.length[1:],
            self.mass[1:],
            self.centre[1:],
            self.rotary_inertia[1:],
            self.joint_stiffness[1:],
            ((translation, series), right),
        )
        return rest._with_left_body(self.mass[0], self.rotary_inertia[0], self.centre[0])


def piece_numbers(name: str, values: Iterable[Number] | Floats) -> tuple[Number, ...]:
    """Return numbers of pieces or hinges as given, fractions kept, arrays as floats."""
    values = unwrapped(name, values)
    if isinstance(values, np.ndarray) and not isinstance(values, np.ma.MaskedArray):
        if values.dtype.kind not in "fiu" or values.ndim != 1 or not np.isfinite(values).all():
            raise ValueError(f"{name} must be a one-dimensional array of finite numbers, got {shown(values)}")
        return tuple(values.astype(float).tolist())
    if is_text(values) or isinstance(values, Mapping | Set) or not isinstance(values, Iterable):
        raise TypeError(f"{name} must be a sequence of numbers, got {shown(values)}")
    items = bounded(name, values, most=MAX_PIECES)
    return tuple(_number(f"{name}[{i}]", value) for i, value in enumerate(items))


def _number(name: str, value: Number) -> Number:
    value = unwrapped(name, value)
    number = real(name, value)
    if value and not number:
        raise ValueError(f"{name} must be within the range of floating-point numbers, got {shown(value)}")
    return value if isinstance(value, Fraction) else number


def check_pieces(columns: dict[str, tuple[Number, ...]]) -> None:
    """Raise ValueError naming the first number that makes no chain; zero-length ends may be massless."""
    length, mass, springs = columns["length"], columns["mass"], columns["joint_stiffness"]
    count = len(length)
    if not count:
        raise ValueError("length must be of one or more pieces, got none")
    for name, values in columns.items():
        expected = count - 1 if name == "joint_stiffness" else count
        if len(values) != expected:
            raise ValueError(f"{name} must have {expected} entries for {count} pieces, got {len(values)}")
        if values and min(values) < 0 and name != "centre":
            raise ValueError(f"{name} must not be negative, got {shown(min(values))}")
    if springs and min(springs) == 0:
        raise ValueError("joint_stiffness must be greater than 0, got 0")
    for name in ("length", "mass"):
        if 0 in columns[name][1:-1]:
            raise ValueError(f"{name} must be greater than 0 for every piece but the outer two")
    if not any(length):
        raise ValueError("length must hold at least one piece that has a length, got only zeros")
    for i in {0, count - 1}:
        if length[i] and not mass[i] and not columns["rotary_inertia"][i]:
            raise ValueError(f"mass[{i}] must be greater than 0 for a piece that has a length")


def check_turning(pieces: Pieces) -> None:
    """Raise ValueError if a piece turns without inertia: a mode of infinite frequency."""
    held = [False] * len(pieces.length)
    held[0] |= pieces.supports[0][1] == math.inf
    held[-1] |= pieces.supports[1][1] == math.inf
    outer = sorted({0, len(held) - 1})
    for i in outer if all(pieces.rotary_inertia[1:-1]) else range(len(held)):
        if (
            not pieces.rotary_inertia[i]
            and not held[i]
            and (pieces.length[i] or not pieces.mass[i] * pieces.centre[i])
        ):
            raise ValueError(f"rotary_inertia[{i}] must be greater than 0 for a piece that turns, got 0")
