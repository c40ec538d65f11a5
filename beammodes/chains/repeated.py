"""Columns of exact numbers, in which neighbours are mostly one and the same object: each is worked out once.

Fractions are slow to hash, to subtract and to turn into floats: for chains of a million pieces slower than to
solve them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain, repeat
from operator import is_
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["each_once", "floats"]

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


def floats(values: Sequence[Any]) -> NDArray[np.float64]:
    """Return a column of numbers as an array of floats, shape (len(values),).

    Examples
    --------
    >>> from fractions import Fraction
    >>> floats([Fraction(1, 4), 2.0]).tolist()
    [0.25, 2.0]
    """
    if len(values) < _SHORT:
        return np.array(values, dtype=np.float64)
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
