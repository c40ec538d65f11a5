"""Checks of arguments, whose messages name argument, value and what is allowed; values as text."""

from __future__ import annotations

import difflib
import math
import numbers
import operator
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Set, Sized
from dataclasses import MISSING, Field, fields
from importlib import import_module
from itertools import islice
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.numerics.arrays import Floats

__all__ = [
    "MAX_ITEMS",
    "Catalogue",
    "Shown",
    "bounded",
    "brief",
    "choice",
    "distinct",
    "flag",
    "is_text",
    "kind_given",
    "not_negative",
    "part_shown",
    "percent",
    "plain_array",
    "positive_real",
    "real",
    "real_numbers",
    "row_shown",
    "shown",
    "small_fraction",
    "together",
    "unwrapped",
    "whole_number",
    "whole_numbers",
]

#: Numbers that a list or range may have: each is an object of Python's. Arrays may have more.
MAX_ITEMS = 10**7

_SHOWN_CHARACTERS = 60
#: NumPy registers spans of time as whole numbers.
_NO_NUMBERS = (bool, np.timedelta64)
_SHOWN_NUMBERS = 6
_LINE = 120


def shown(value: object) -> str:
    """Return `value` as an error message may carry it: one line, never longer than a screen line."""
    if isinstance(value, int) and value.bit_length() > 200:
        sign = "-" if value < 0 else ""
        return f"an integer of about {sign}10**{int(value.bit_length() * math.log10(2))}"
    try:
        text = repr(value).replace("\n", " ")
    except ValueError:
        # Python refuses to print integers of more than 4300 digits, also inside other values.
        text = f"a {type(value).__name__} of very many digits"
    except Exception:
        # A message about a bad argument must not fail because that cannot even be printed.
        text = f"a {type(value).__name__} that cannot be printed"
    return text if len(text) <= _SHOWN_CHARACTERS else text[: _SHOWN_CHARACTERS - 3] + "..."


def instead(value: object, **takers: str) -> str:
    """Return the end of a message that says what takes a value of this class, "" for all other classes.

    Examples
    --------
    >>> instead(3, int="range takes an int"), instead("3", int="range takes an int")
    ('; range takes an int', '')
    """
    said = takers.get(type(value).__name__)
    return f"; {said}" if said else ""


def row_shown(values: Iterable[float], form: str, unit: str) -> str:
    """Return the first six of some numbers in a row with their unit, as results are printed.

    Examples
    --------
    >>> row_shown([4.5504, 28.515, 79.843], "{:.4g}", "Hz")
    '4.55, 28.52, 79.84 Hz'
    """
    listed = [float(value) for value in values]
    more = f", ... ({len(listed)} in all)" if len(listed) > _SHOWN_NUMBERS else ""
    return f"{', '.join(map(form.format, listed[:_SHOWN_NUMBERS])) or 'none'} {unit}{more}"


def percent(fraction: float, digits: int = 3, unit: str = " %", *, rounding: float = 0.0) -> str:
    """Return a fraction in percent with its sign; what is at most `rounding` is shown as zero.

    Examples
    --------
    >>> percent(0.1114, 2), percent(-0.00351753, 4, ""), percent(2e-16, rounding=1e-14)
    ('+11 %', '-0.3518', '0 %')
    """
    if math.isnan(fraction):
        return "nan"
    return ("0" if abs(fraction) <= rounding else f"{100 * fraction:+.{digits}g}") + unit


class Shown:
    """What is shown of an object: one line at a prompt, and HTML in a notebook.

    The line of a dataclass is what a user would type: its fields that are not at their defaults.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.Load(tip_force=2.0, plane="lag"), bm.Load()
    (Load(plane='lag', tip_force=(0.0, 2.0)), Load())
    >>> "<table" in bm.Load(tip_force=2.0)._repr_html_()
    True
    """

    __slots__ = ()

    def __repr__(self) -> str:
        return brief(self._line())

    def _line(self) -> str:
        """Return the line, of any length."""
        told = (f"{name}={part_shown(value)}" for name, value in told_fields(self))
        return f"{type(self).__name__}({', '.join(told)})"

    def _repr_html_(self) -> str:
        # By name: drawings and tables are not read before somebody looks at one.
        html: str = import_module("beammodes.views.html_tables").html_of(self)
        return html


def brief(text: str) -> str:
    """Return the line that a prompt shows of an object, cut at a comma where it is longer than a screen line.

    Examples
    --------
    >>> brief("Table(" + ", ".join(["1.25"] * 100) + ")")[-22:]
    '1.25, 1.25, 1.25, ...)'
    >>> brief("<Structure: a" + chr(10) + "b>") == "<Structure: a" + chr(92) + "nb>"
    True
    """
    if not text.isprintable():
        # Names of joints and members may be any text.
        text = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
    if len(text) <= _LINE:
        return text
    return f"{text[: _LINE - 6].rpartition(', ')[0] or text[: _LINE - 6]}, ...{text[-1]}"


def told_fields(record: Any) -> list[tuple[str, Any]]:
    """Return names and values of a dataclass's public fields, without those at their defaults.

    Examples
    --------
    >>> import beammodes as bm
    >>> told_fields(bm.Station(0.5, mass=2.0))
    [('x', 0.5), ('mass', 2.0)]
    """
    given = [(each, getattr(record, each.name)) for each in fields(record) if each.name[0] != "_"]
    return [(each.name, value) for each, value in given if each.repr and not _is_usual(each, value)]


def _is_usual(field: Field[Any], value: Any) -> bool:
    usual = field.default if field.default_factory is MISSING else field.default_factory()
    return usual is value or (
        type(usual) is type(value) and not isinstance(usual, np.ndarray) and usual == value
    )


def part_shown(value: Any) -> str:
    """Return a value of a field as its record's line has it: long lists are cut, functions have their name.

    Examples
    --------
    >>> part_shown((1.0,) * 9), part_shown(math.hypot)
    ('[1.0, 1.0, ... 9 in all]', 'hypot')
    """
    if isinstance(value, np.ndarray | tuple | list) and np.size(value) > _SHOWN_NUMBERS:
        listed = list(value)
        return f"[{part_shown(listed[0])}, {part_shown(listed[1])}, ... {len(listed)} in all]"
    # A function's place in memory tells nobody anything.
    own = getattr(value, "__name__", None) if callable(value) else None
    return own if isinstance(own, str) else repr(value)


_V = TypeVar("_V")


class Catalogue(Shown, Mapping[str, _V]):
    """Records by name that nobody can change; its line has the names, in a notebook it is a table.

    Examples
    --------
    >>> numbers = Catalogue("numbers", {"one": 1, "two": 2})
    >>> numbers, numbers["one"]
    (<2 numbers: one, two>, 1)
    """

    __slots__ = ("_records", "what")

    def __init__(self, what: str, records: Mapping[str, _V]) -> None:
        self.what, self._records = what, dict(records)

    def __getitem__(self, name: str) -> _V:
        return self._records[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._records)

    def __len__(self) -> int:
        return len(self._records)

    def _line(self) -> str:
        return f"<{len(self)} {self.what}: {', '.join(self)}>"


def unwrapped(name: str, value: Any, unit: str | None = None) -> Any:
    """Return quantities as numbers in SI, labelled arrays as plain ones, one without axes as its number.

    Parameters
    ----------
    name : str
        Of the argument, whose unit `beammodes.problem.dimensions` knows.
    value : object
    unit : str, optional
        Where the argument's name alone does not say it; "any" takes every kind.

    Raises
    ------
    TypeError
        If a quantity is of another kind than the argument.

    Examples
    --------
    >>> unwrapped("length", np.array(1.2)), unwrapped("length", "1.2")
    (1.2, '1.2')
    """
    if "pint" in sys.modules:
        value = _in_si(name, value, unit)
    if type(value).__name__ in ("DataArray", "Series"):
        value = value.values
    if (
        not isinstance(value, np.generic)
        and getattr(value, "shape", None) == ()
        and hasattr(value, "__array__")
    ):
        _check_unmasked(name, value)
        array = np.asarray(value)
        return array.item() if array.dtype.kind in "iuf" else value
    return value


def kind_given(value: Any) -> tuple[float, float, float] | None:
    """Return the kind of a quantity or a row of them, powers of mass, length and time; None of plain numbers.

    Examples
    --------
    >>> kind_given([1.0, 2.0]) is None
    True
    """
    if "pint" not in sys.modules:
        return None
    from beammodes.problem.dimensions import kind_of_numbers

    return kind_of_numbers(value)


def _in_si(name: str, value: Any, unit: str | None) -> Any:
    from beammodes.problem.dimensions import is_quantity, plain_number, unit_of

    if isinstance(value, list | tuple) and len(value) <= MAX_ITEMS:
        items = [_in_si(name, item, unit) for item in value]
        return value if all(map(operator.is_, items, value)) else type(value)(items)
    inside = value.data if type(value).__name__ == "DataArray" else value
    if not is_quantity(inside):
        return value
    expected = unit_of(name) if unit is None else unit
    try:
        found = plain_number(inside, expected)
    except (TypeError, ValueError, ArithmeticError, AttributeError) as error:
        raise TypeError(f"{name} must be real numbers, got {shown(value)}: {error}") from None
    if found is None:
        said = {"1": "a number without a unit", "any": "a mechanical quantity"}
        kind = said.get(expected, f"in {expected} or a unit of that kind")
        raise TypeError(f"{name} must be {kind}, got {' '.join(str(inside).split())[:_SHOWN_CHARACTERS]}")
    return found


def real(name: str, value: object, unit: str | None = None) -> float:
    """Return `value` as a finite float, a quantity with a unit in SI; `unit` as in `unwrapped`.

    Raises
    ------
    TypeError
        If `value` is not a real number (a bool or a string is not), or a quantity of another kind.
    ValueError
        If it is not finite, or too large for a float.
    """
    if not _is_real(value):
        value = unwrapped(name, value, unit)
    if isinstance(value, _NO_NUMBERS) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a real number, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return number


def positive_real(name: str, value: object, unit: str | None = None) -> float:
    """Return `value` as a finite float above zero; raises as `real` does."""
    number = real(name, value, unit)
    if number <= 0.0:
        raise ValueError(f"{name} must be greater than 0, got {shown(value)}")
    return number


def not_negative(name: str, value: object, unit: str | None = None, *, infinite: bool = False) -> float:
    """Return `value` as a float that is not below zero, and finite unless `infinite`; raises as `real` does.

    Examples
    --------
    >>> not_negative("mass", -0.0), not_negative("stiffness", math.inf, infinite=True)
    (0.0, inf)
    """
    value = unwrapped(name, value, unit)
    held = infinite and isinstance(value, float) and value == math.inf
    number = math.inf if held else real(name, value)
    if number < 0.0:
        raise ValueError(f"{name} must not be negative, got {shown(value)}")
    return number + 0.0


def small_fraction(name: str, value: object) -> float:
    """Return a tolerance as a float above zero and below one half.

    A frequency that is wrong by half says nothing, so that 1 or 5 is a percentage, typed as a fraction.

    Raises
    ------
    TypeError, ValueError
        As `positive_real`, or if it is one half or more.
    """
    if isinstance(value, str) and value.endswith("%"):
        raise TypeError(f"{name} must be a fraction, such as 0.01 for 1 %, got {shown(value)}")
    number = positive_real(name, value)
    if number >= 0.5:
        meant = f"; for {number:g} % give {number / 100:g}" if number <= 50 else ""
        raise ValueError(
            f"{name} must be a fraction less than 0.5, got {shown(value)}, {100 * number:g} %{meant}"
        )
    return number


def whole_number(name: str, value: object, *, least: int = 1, most: int | None = None) -> int:
    """Return `value` as an int in `least..most`.

    Raises
    ------
    TypeError
        If `value` is not an integer (2.5, "six" and True are not; NumPy integers are).
    ValueError
        If it lies outside the range.
    """
    allowed = f"a whole number of at least {least}" + (f" and at most {most}" if most is not None else "")
    if not isinstance(value, int):
        value = unwrapped(name, value)
    if isinstance(value, _NO_NUMBERS) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{name} must be {allowed}, got {shown(value)}")
    number = int(value)
    if number < least or (most is not None and number > most):
        raise ValueError(f"{name} must be {allowed}, got {shown(number)}")
    return number


def flag(name: str, value: object, *, or_none: bool = False) -> bool:
    """Return `value` if it is True or False; raises TypeError for "no", 0, None and all else.

    With `or_none` the message says that None is allowed too.

    Examples
    --------
    >>> flag("force", True)
    True
    """
    if not isinstance(value, bool | np.bool_):
        allowed = "True, False or None" if or_none else "True or False"
        raise TypeError(f"{name} must be {allowed}, got {shown(value)}")
    return bool(value)


def is_text(value: object) -> bool:
    """Return True for text and bytes, whose characters are whole numbers to Python and no sequence here.

    Examples
    --------
    >>> is_text(b"12"), is_text(bytearray(2)), is_text(memoryview(b"12")), is_text([1, 2])
    (True, True, True, False)
    """
    if isinstance(value, memoryview):
        return value.itemsize == 1
    return isinstance(value, str | bytes | bytearray)


def bounded(name: str, values: Iterable[Any], *, most: int | None = None) -> list[Any]:
    """Return what an iterable yields, as a list; one that never ends is found out by its length.

    Raises
    ------
    TypeError
        If it is no iterable.
    ValueError
        If it has more than `most` values, 10⁷ by default.

    Examples
    --------
    >>> bounded("rules", ("naive", "gregory"), most=100)
    ['naive', 'gregory']
    """
    most = MAX_ITEMS if most is None else most
    _check_unmasked(name, values)
    if isinstance(values, np.ndarray) and values.ndim == 0:
        return [values.item()]
    # A mapping stands for its names, not for numbers.
    named = not isinstance(values, Mapping) or all(isinstance(key, str) for key in values)
    if not isinstance(values, Iterable) or is_text(values) or not named:
        raise TypeError(f"{name} must be a sequence of values, got {shown(values)}")
    # A range of 10**9 knows its length; a generator must be asked.
    if isinstance(values, Sized) and _length(values) > most:
        raise ValueError(f"{name} must have at most {most} values, got {shown(values)}")
    items = list(islice(values, most + 1))
    if len(items) > most:
        raise ValueError(f"{name} must have at most {most} values, got more from {shown(values)}")
    return items


def distinct(
    name: str, value: Any, single: tuple[type, ...], read: Callable[[Any], Any]
) -> tuple[list[Any], NDArray[np.intp]]:
    """Return what an array of names or records stands for, each once, and places in it, of its shape.

    `read` is called once for each text, and once for each object that is none.

    Examples
    --------
    >>> distinct("end", [["free", "Free"], ["pinned", "free"]], (str,), str.lower)
    (['free', 'pinned'], array([[0, 0],
           [1, 0]]))
    """
    if isinstance(value, single) or not isinstance(value, Iterable):
        return [read(value)], np.asarray(0)
    several = not isinstance(value, np.ndarray)
    words = isinstance(value, np.ndarray) and value.dtype.kind == "U"
    array = np.asarray(bounded(name, value) if several else value, dtype=None if words else object)
    flat = array.ravel().tolist()
    keys = flat if set(map(type, flat)) <= {str} else list(map(id, flat))
    found: dict[Any, int] = {}
    items = dict(zip(keys, flat, strict=True))
    places = {key: found.setdefault(read(item), len(found)) for key, item in items.items()}
    which = np.fromiter(map(places.__getitem__, keys), dtype=np.intp, count=len(keys))
    return list(found), which.reshape(array.shape)


def together(**arrays: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """Return arrays broadcast to one shape.

    Raises
    ------
    ValueError
        If they have none in common; the message names them.

    Examples
    --------
    >>> [array.shape for array in together(segments=np.ones((2, 1)), mode=np.ones(3))]
    [(2, 3), (2, 3)]
    """
    try:
        return tuple(np.broadcast_arrays(*arrays.values()))
    except ValueError:
        *names, last = arrays
        shapes = ", ".join(str(array.shape) for array in arrays.values())
        raise ValueError(
            f"{', '.join(names)} and {last} must broadcast together, got shapes {shapes}"
        ) from None


def _check_unmasked(name: str, value: object) -> None:
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name} must have no masked values, got {shown(value)}")


def _length(values: Sized) -> float:
    try:
        return len(values)
    except OverflowError:
        return math.inf
    except TypeError:
        # An array without dimensions has no length; it is one value.
        return 1


def plain_array(name: str, value: Any, unit: str | None = None) -> NDArray[Any]:
    """Return integers, floats and complex numbers of an array as they are, all else as an array of objects.

    Raises
    ------
    TypeError
        If it is no regular array, but an iterator or a ragged list.
    ValueError
        If values of it are masked, or a list has more than `MAX_ITEMS` items.
    """
    _check_unmasked(name, value)
    if type(value) in (int, float):
        return np.asarray(value)
    if "pint" in sys.modules:
        value = _in_si(name, value, unit)
    if not hasattr(value, "__array__"):
        endless = isinstance(value, Iterable) and not isinstance(value, Sized)
        # Of str and bytes NumPy makes one object, which is refused as any other; of bytearrays whole numbers.
        characters = is_text(value) and not isinstance(value, str | bytes)
        if endless or characters or isinstance(value, Mapping | Set):
            raise TypeError(f"{name} must be an array or a list, got {shown(value)}")
        if isinstance(value, Sized) and not is_text(value) and _length(value) > MAX_ITEMS:
            raise ValueError(f"{name} must have at most {MAX_ITEMS} values, got {shown(value)}")
        if isinstance(value, list | tuple | range):
            kinds = {int} if isinstance(value, range) else set(map(type, value))
            array = np.asarray(value) if kinds in ({int}, {float}) else None
            # Integers above 2**63 would become floats among smaller ones.
            if array is not None and (array.dtype.kind in "iu" or kinds == {float}):
                return array
        try:
            # As objects, items keep their types: NumPy takes b"3" for a number, and 2**63 for a float.
            return np.asarray(value, dtype=object)
        except ValueError:
            raise TypeError(f"{name} must be one regular array, got {shown(value)}") from None
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        # What an xarray.Dataset raises, which has no one array.
        raise TypeError(f"{name} must be an array or a list, got {shown(value)}") from None
    if array.dtype.kind in "mM":
        # As objects, those in nanoseconds would be plain integers.
        raise TypeError(f"{name} must be an array of numbers, not of times, got {shown(value)}")
    return array if array.dtype.kind in "iufc" else array.astype(object)


def _is_real(item: object) -> bool:
    return isinstance(item, numbers.Real) and not isinstance(item, _NO_NUMBERS)


def _is_whole(item: object) -> bool:
    return isinstance(item, numbers.Integral) and not isinstance(item, _NO_NUMBERS)


def whole_numbers(name: str, value: ArrayLike, *, least: int = 1, most: int) -> NDArray[np.int64]:
    """Return `value` as int64, refusing what is not whole numbers in `least..most` in one regular array.

    Examples
    --------
    >>> whole_numbers("mode", [[1], [2]], most=10).shape
    (2, 1)
    """
    if isinstance(value, int | np.integer):
        return np.asarray(whole_number(name, value, least=least, most=most))
    array = plain_array(name, value)
    if array.ndim == 0:
        return np.asarray(whole_number(name, array.item(), least=least, most=most))
    if array.dtype.kind not in "iu":
        items = array.ravel().tolist()
        if not all(map(_is_whole, items)):
            allowed = f"whole numbers of at least {least} and at most {most}"
            raise TypeError(f"{name} must be {allowed}, got {shown(value)}")
        whole = [whole_number(name, item, least=least, most=most) for item in items]
        return np.array(whole, dtype=np.int64).reshape(array.shape)
    outside = (array < least) | (array > most)
    if outside.any():
        whole_number(name, int(array[outside][0]), least=least, most=most)
    return array.astype(np.int64, copy=False)


def real_numbers(name: str, value: Any, unit: str | None = None, *, finite: bool = True) -> Floats:
    """Return real numbers, finite unless said otherwise, as an array of floats, of the shape that they have.

    Quantities with units become numbers in SI, as `unwrapped` says.

    Raises
    ------
    TypeError
        If they are not real numbers in one regular array (text, bytes and bools are not).
    ValueError
        If one is not finite or masked.

    Examples
    --------
    >>> real_numbers("time", [[0, 0.5]])
    array([[0. , 0.5]])
    """
    array = plain_array(name, value, unit)
    items = array.ravel().tolist() if array.dtype.kind == "O" else []
    if any(isinstance(item, list | tuple) for item in items):
        raise TypeError(f"{name} must be one regular array of real numbers, got {shown(value)}")
    if array.dtype.kind == "c" or not all(map(_is_real, items)):
        raise TypeError(f"{name} must be an array of real numbers, got {shown(value)}")
    if array.dtype.kind == "O":
        return np.array([real(name, item) for item in array.ravel()], dtype=np.float64).reshape(array.shape)
    with np.errstate(over="ignore"):
        found = array.astype(np.float64)
    if finite and not np.isfinite(found).all():
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return found


def choice(name: str, value: object, allowed: Iterable[str]) -> str:
    """Return `value` if it is one of the words in `allowed`.

    Raises
    ------
    TypeError
        If `value` is not a string.
    ValueError
        If it is another word; the message offers the nearest allowed one.
    """
    words = list(allowed)
    if not isinstance(value, str):
        raise TypeError(f"{name} must be one of {', '.join(words)}, got {shown(value)}")
    if value in words:
        return value
    near = difflib.get_close_matches(value.strip().lower(), words, n=1)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    raise ValueError(f"{name} must be one of {', '.join(words)}, got {shown(value)}{hint}")
