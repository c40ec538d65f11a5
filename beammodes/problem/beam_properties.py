"""What a user gives for a property along a beam, checked, and as the beam keeps it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import bounded, positive_real, real, shown
from beammodes.problem.profiles import Profile, value_at
from beammodes.problem.smooth_parts import SAMPLES, BrokenFunction
from beammodes.problem.tabulated import SAME_PLACE, Table, table_with_breaks

__all__ = ["PropertyLike", "each_place_once", "kept_breaks", "kept_property"]

#: What a user may give for a property along the beam.
PropertyLike: TypeAlias = Profile | Sequence[float] | NDArray[Any]

_GRID, _MAY_VANISH, _MOST_PARTS = 65, "rotary_inertia_per_length", 100_000


def kept_property(name: str, given: object, length: float, breaks: tuple[float, ...] = ()) -> Profile:
    """Return a property of a beam of this length as it is kept: a number, a table or a function.

    A table and a function take the `breaks` with them.

    Raises
    ------
    TypeError, ValueError
        If it is none of what `Beam` takes; the message names the property, and position and value.

    Examples
    --------
    >>> kept_property("bending_stiffness", [2, 1], 1.0)
    Table(x=(0.0, 0.5, 0.5, 1.0), value=(2.0, 2.0, 1.0, 1.0))
    """
    if isinstance(given, Table) or _is_row(given):
        kept = _spanning(name, given, length) if isinstance(given, Table) else _steps(name, given, length)
        return table_with_breaks(kept, breaks) if isinstance(kept, Table) else kept
    if callable(given):
        _try(name, given, length)
        own = given.breaks if isinstance(given, BrokenFunction) else ()
        places = each_place_once(sorted((*own, *breaks)), length)
        function = given.function if isinstance(given, BrokenFunction) else given
        return BrokenFunction(function, places) if places else function
    if name != _MAY_VANISH:
        return positive_real(name, given)
    number = real(name, given)
    if number < 0.0:
        raise ValueError(f"{name} must not be negative, got {shown(given)}")
    return number + 0.0


def kept_breaks(given: object, length: float) -> tuple[float, ...]:
    """Return positions that a user marks inside a beam of this length, ascending, each once [m].

    Raises
    ------
    TypeError, ValueError
        If it is no sequence of real numbers, or one lies outside the beam or at its end.

    Examples
    --------
    >>> kept_breaks([0.7, 0.2], 1.0)
    (0.2, 0.7)
    """
    if not isinstance(given, Sequence | np.ndarray) or (isinstance(given, np.ndarray) and given.ndim != 1):
        raise TypeError(f"breaks must be a sequence of positions, got {shown(given)}")
    places = sorted(real("breaks", place) for place in bounded("breaks", given))
    for place in places:
        if not SAME_PLACE * length < place < (1.0 - SAME_PLACE) * length:
            raise ValueError(
                f"breaks must be positions inside the beam, between 0 and its length {length}, got {place}"
            )
    return each_place_once(places, length)


def each_place_once(places: Sequence[float], length: float) -> tuple[float, ...]:
    """Return ascending positions without those that are the one before but for rounding [m]."""
    kept: list[float] = []
    for x in places:
        # Thirds and sixths of a length meet but for rounding.
        if not kept or x - kept[-1] > SAME_PLACE * length:
            kept.append(x)
    return tuple(kept)


def _is_row(given: object) -> bool:
    if isinstance(given, np.ndarray):
        return given.ndim == 1 and given.size > 1
    return isinstance(given, Sequence) and not isinstance(given, str | bytes) and len(given) > 1


def _steps(name: str, given: Any, length: float) -> Profile:
    if len(given) > _MOST_PARTS:
        raise ValueError(f"{name} must have at most {_MOST_PARTS} parts, got {len(given)}")
    for part, item in enumerate(given, start=1):
        try:
            _allowed(name, real(name, item), f" on part {part} of {len(given)}")
        except (TypeError, ValueError) as error:
            raise type(error)(f"{error}; the whole is {shown(given)}") from None
    values = [float(item) + 0.0 for item in given]
    if min(values) == max(values):
        return values[0]
    inner = [length * part / len(values) for part in range(1, len(values)) for _ in range(2)]
    return Table((0.0, *inner, length), tuple(value for value in values for _ in range(2)))


def _spanning(name: str, table: Table, length: float) -> Profile:
    if abs(table.x[-1] - length) > SAME_PLACE * length:
        raise ValueError(
            f"{name} must be tabulated from 0 to the beam's length {length}, got a table up to {table.x[-1]}"
        )
    for x, value in zip(table.x, table.value, strict=True):
        _allowed(name, value, f" at x = {x}")
    if min(table.value) == max(table.value):
        return table.value[0]
    return table if table.x[-1] == length else Table((*table.x[:-1], length), table.value)


def _try(name: str, function: Callable[[Any], Any], length: float) -> None:
    """Evaluate a function along the beam, for an array and for single numbers."""
    grid = 0.5 * length * (1.0 - np.cos(np.pi * np.arange(_GRID) / (_GRID - 1)))
    grid[-1] = length
    one_by_one = []
    for x in grid.tolist():
        try:
            value = function(x)
        except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
            told = f"{type(error).__name__}: {error}"
            raise TypeError(
                f"{name} must be a function of one position, got {shown(function)}, "
                f"which fails at x = {x}: {told}"
            ) from error
        number = value.item() if isinstance(value, np.ndarray | np.generic) and value.size == 1 else value
        one_by_one.append(_allowed(name, real(f"{name} at x = {x}", number), f" at x = {x}"))
    together = value_at(function, grid)
    differing = ~(np.abs(together - one_by_one) <= 1e-9 * np.abs(one_by_one))
    if differing.any():
        at = int(np.argmax(differing))
        raise ValueError(
            f"{name} must be a function with one value at each position, got {together[at]} for an array "
            f"and {one_by_one[at]} for the number at x = {grid[at]}"
        )
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES * length
    values = value_at(function, places)
    wrong = ~(np.isfinite(values) & ((values > 0.0) | ((values == 0.0) & (name == _MAY_VANISH))))
    if wrong.any():
        at = int(np.argmax(wrong))
        _allowed(name, real(f"{name} at x = {places[at]}", values[at].item()), f" at x = {places[at]}")


def _allowed(name: str, value: float, where: str) -> float:
    """Return a value that the property may have, or raise an error that says where it is not."""
    if name == _MAY_VANISH:
        if value < 0.0:
            raise ValueError(f"{name} must not be negative, got {value}{where}")
    elif value < 0.0:
        raise ValueError(f"{name} must be greater than 0, got {value}{where}")
    elif value == 0.0:
        raise ValueError(
            f"{name} must be greater than 0, got {value}{where}: a beam may not taper to nothing, "
            "let it end where the section is still finite"
        )
    return value
