"""Pieces and springs of a chain as users give them: read, checked, and idle ones condensed away."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import real, shown, whole_number
from beammodes.ends import Boundary

__all__ = ["MAX_PIECES", "Number", "check_pieces", "not_idle", "piece_numbers"]

Number = Fraction | float

#: Longer chains are refused: their arrays alone would fill memory. Lookups of errors know no such limit.
MAX_PIECES = 10_000_000


def piece_numbers(name: str, values: Iterable[Number] | NDArray[np.float64]) -> tuple[Number, ...]:
    """Return numbers of pieces or hinges as given, fractions kept, arrays as floats."""
    if isinstance(values, np.ndarray):
        if values.dtype.kind not in "fiu" or values.ndim != 1 or not np.isfinite(values).all():
            raise ValueError(f"{name} must be a one-dimensional array of finite numbers, got {shown(values)}")
        return tuple(values.astype(float).tolist())
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise TypeError(f"{name} must be a sequence of numbers, got {shown(values)}")
    return tuple(_number(f"{name}[{i}]", value) for i, value in enumerate(values))


def _number(name: str, value: Number) -> Number:
    number = real(name, value)
    if value and not number:
        raise ValueError(f"{name} must be within the range of floating-point numbers, got {shown(value)}")
    return value if isinstance(value, Fraction) else number


def check_pieces(
    boundary: Boundary, pieces: dict[str, tuple[Number, ...]], springs: tuple[Number, ...]
) -> None:
    """Raise ValueError naming the first number that makes no chain; zero-length ends may be massless."""
    count = whole_number("number of pieces", len(pieces["length"]), most=MAX_PIECES)
    for name, values in {**pieces, "joint_stiffness": springs}.items():
        expected = count - 1 if name == "joint_stiffness" else count
        if len(values) != expected:
            raise ValueError(f"{name} must have {expected} entries for {count} pieces, got {len(values)}")
        if values and min(values) < 0:
            raise ValueError(f"{name} must not be negative, got {shown(min(values))}")
    if springs and min(springs) == 0:
        raise ValueError("joint_stiffness must be greater than 0, got 0")
    for name in ("length", "mass"):
        if any(value == 0 for value in pieces[name][1:-1]):
            raise ValueError(f"{name} must be greater than 0 for every piece but the outer two")
    for i in {0, count - 1}:
        if pieces["length"][i] and not pieces["mass"][i]:
            raise ValueError(f"mass[{i}] must be greater than 0 for a piece that has a length")
    held = {0} if boundary.left.holds_rotation else set()
    held |= {count - 1} if boundary.right.holds_rotation else set()
    for i, (mass, inertia) in enumerate(zip(pieces["mass"], pieces["rotary_inertia"], strict=True)):
        if mass and not inertia and i not in held:
            # Its angle would cost no energy: a mode of infinite frequency.
            raise ValueError(f"rotary_inertia[{i}] must be greater than 0 for a piece that turns, got 0")


def not_idle(boundary: Boundary, *columns: tuple[Number, ...]) -> slice:
    """Return the pieces that remain when idle outer ones are condensed away.

    A massless piece of length zero that nothing holds in rotation turns freely, so its spring is in series
    with no resistance: the hinge does nothing.
    """
    idle = [not any(numbers) for numbers in zip(*columns, strict=True)]
    first = int(idle[0] and not boundary.left.holds_rotation)
    last = len(idle) - int(idle[-1] and not boundary.right.holds_rotation)
    if not any(columns[0][first:last]):
        raise ValueError("length must hold at least one piece that has a length, got only zeros")
    return slice(first, last)
