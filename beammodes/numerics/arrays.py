"""Arrays of floats: the name of their type, and elementary functions that serve single floats as well.

One formula so works on both at its own speed: NumPy takes about a microsecond for one number, whatever it
does with it, and `math` a twentieth of that.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "OF_ARRAYS",
    "OF_FLOATS",
    "Elementary",
    "Floats",
    "elementary",
    "first_factor",
    "frozen",
    "keeps_labels",
    "ratios_less_one",
    "signs_of_largest",
]

#: An array of double-precision numbers.
Floats = NDArray[np.float64]

Function = Callable[..., Any]
_F = TypeVar("_F", bound=Function)


class Elementary(NamedTuple):
    """The functions that formulas here are made of."""

    sin: Function
    cos: Function
    sqrt: Function
    exp: Function
    expm1: Function
    arcsin: Function
    arcsinh: Function
    arctan2: Function
    hypot: Function


#: Of Python's floats.
OF_FLOATS = Elementary(
    math.sin, math.cos, math.sqrt, math.exp, math.expm1, math.asin, math.asinh, math.atan2, math.hypot
)
#: Of arrays, and of all else that NumPy takes.
OF_ARRAYS = Elementary(np.sin, np.cos, np.sqrt, np.exp, np.expm1, np.arcsin, np.arcsinh, np.arctan2, np.hypot)


def elementary(number: Any) -> Elementary:
    """Return the functions for numbers of this kind: a Python float, or all else that NumPy takes.

    Examples
    --------
    >>> elementary(0.5).sqrt(2.25), elementary(np.array([0.5])).sqrt(np.array([2.25, 4.0]))
    (1.5, array([1.5, 2. ]))
    """
    return OF_FLOATS if type(number) is float else OF_ARRAYS


def first_factor(geometric: Floats) -> float:
    """Return the smallest f > 0 at which 1 + f G, G symmetric, is singular, inf if there is none.

    Examples
    --------
    >>> first_factor(np.diag([3.0, -0.5]))
    2.0
    """
    from scipy.linalg import eigh

    if not len(geometric):
        return math.inf
    lowest = float(eigh(geometric, eigvals_only=True, subset_by_index=(0, 0))[0])
    # Next to large positive values a negative one may be rounding.
    return -1.0 / lowest if lowest < -1e-13 * float(np.linalg.norm(geometric)) else math.inf


def frozen(values: Floats) -> Floats:
    """Return a read-only copy."""
    copy = values.copy()
    copy.flags.writeable = False
    return copy


def ratios_less_one(found: Floats, exact: Floats, count: int) -> Floats:
    """Return found/exact - 1 of as many as there are of both, then NaN up to `count`.

    Examples
    --------
    >>> ratios_less_one(np.array([1.0, 3.0]), np.array([1.0, 2.0, 4.0]), 3)
    array([0. , 0.5, nan])
    """
    ratios, both = np.full(count, np.nan), min(len(found), len(exact), count)
    ratios[:both] = found[:both] / exact[:both] - 1.0
    return ratios


def signs_of_largest(rows: Floats) -> Floats:
    """Return 1 or -1 for each row: the sign of its largest entry, the first of those that are alike.

    Entries alike to a millionth are taken for equal, so that symmetric rows have the same sign everywhere.

    Examples
    --------
    >>> signs_of_largest(np.array([[-2.0, 2.0 + 1e-12], [0.5, -1.0]]))
    array([-1., -1.])
    """
    size = np.abs(rows)
    first = (size >= (1.0 - 1e-6) * size.max(axis=1, keepdims=True)).argmax(axis=1)
    return np.where(rows[np.arange(len(rows)), first] < 0.0, -1.0, 1.0)


def keeps_labels(function: _F) -> _F:
    """Return a function of arrays that gives a `DataArray` where it is given one.

    DataArrays among its arguments meet by the names of their dimensions, and pass these and their coordinates
    on. What is given beside them must not add dimensions of its own: it would have no names for them.

    Examples
    --------
    >>> import xarray
    >>> product = keeps_labels(lambda a, *, b: np.multiply(a, b))
    >>> product(xarray.DataArray([1, 2], dims="x"), b=xarray.DataArray([1, 2, 3], dims="y")).dims
    ('x', 'y')
    >>> int(product(2, b=3))
    6
    """

    @wraps(function)
    def labelled(*args: Any, **options: Any) -> Any:
        xarray = sys.modules.get("xarray")
        named = () if xarray is None else getattr(xarray, "DataArray", ())
        given: dict[Any, Any] = dict(enumerate(args)) | options
        arrays = {name: each for name, each in given.items() if isinstance(each, named)}
        if not arrays or xarray is None:
            return function(*args, **options)
        try:
            met = xarray.broadcast(*xarray.align(*arrays.values(), join="exact", copy=False))
        except ValueError as error:
            raise ValueError(f"DataArrays must agree along dimensions that they share: {error}") from None
        together = dict(zip(arrays, met, strict=True))
        # Quantities of a library of units keep them.
        plain = given | {
            name: each.data if hasattr(each.data, "to_root_units") else each.values
            for name, each in together.items()
        }
        found = function(
            *(plain[place] for place in range(len(args))), **{name: plain[name] for name in options}
        )
        first = next(iter(together.values()))
        if not first.dims and np.ndim(found):
            # One number, for which the other arguments stand in a plain array.
            return found
        if np.shape(found) != first.shape:
            raise ValueError(
                "arrays beside a DataArray must be DataArrays too: the answer has shape "
                f"{np.shape(found)} and names for {first.dims}"
            )
        return xarray.DataArray(found, dims=first.dims, coords=first.coords)

    return cast(_F, labelled)
