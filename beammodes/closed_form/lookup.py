"""Look-ups for arrays of arguments: checked, and taken in groups of one rule and one pair of ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.rules import Rule, RuleLike, rule_named
from beammodes.checks import bounded, shown
from beammodes.closed_form.uniform import UniformChains, uniform_chains
from beammodes.exact.wavenumbers import whole_numbers
from beammodes.problem.ends import BOUNDARIES, Boundary, BoundaryLike, boundary_codes, with_pairs_read

__all__ = ["MAX_MODE", "MAX_SEGMENTS", "Boundaries", "Floats", "Rules", "looked_up"]

#: Largest number of segments: what the accuracy of frequencies and errors has been measured up to.
MAX_SEGMENTS = 10**9

#: Largest mode number, that of `wavenumbers.wavenumber`.
MAX_MODE = 10**12

# Elements that one pass of a kernel takes: its temporary arrays then fit a cache.
_BLOCK = 1 << 14
Floats = NDArray[np.float64]
Rules = RuleLike | Iterable[RuleLike] | NDArray[Any]
Boundaries = BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]


def looked_up(
    kernel: Callable[[UniformChains, Any, Any], Any],
    boundary: Boundaries,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: Rules,
) -> float | Floats:
    """Return `kernel(chains, segments, mode)` of modes that exist, group by group, and NaN for others.

    The kernel takes float arrays of one dimension or, when all arguments are single, two floats.
    """
    codes, (records, chosen) = _boundary_codes(boundary), _rule_codes(rule)
    n, m = whole_numbers("segments", segments, most=MAX_SEGMENTS), whole_numbers("mode", mode, most=MAX_MODE)
    if not (codes.ndim or chosen.ndim or n.ndim or m.ndim):
        chains, one = uniform_chains(records[0], int(codes)), (float(n), float(m))
        return float(np.squeeze(kernel(chains, *one))) if chains.exists(*one) else math.nan
    try:
        codes, n, m, chosen = np.broadcast_arrays(codes, n, m, chosen)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in (codes, n, m, chosen))
        message = f"boundary, segments, mode and rule must broadcast together, got shapes {shapes}"
        raise ValueError(message) from None
    result = np.full(codes.size, np.nan)
    for which, code, at in _groups(chosen.ravel(), codes.ravel()):
        chains = uniform_chains(records[which], code)
        size, number = n.ravel()[at].astype(np.float64), m.ravel()[at].astype(np.float64)
        found = np.flatnonzero(chains.exists(size, number))
        if len(found):
            result[at[found]] = kernel(chains, size[found], number[found])
    return result.reshape(codes.shape)


def _groups(chosen: NDArray[np.intp], codes: NDArray[np.intp]) -> Iterable[tuple[int, int, NDArray[np.intp]]]:
    """Yield rule, boundary and the indices of at most `_BLOCK` elements that share them."""
    key = chosen * len(BOUNDARIES) + codes
    order = np.argsort(key, kind="stable")
    for start, stop in pairwise([*np.flatnonzero(np.diff(key[order], prepend=-1)), key.size]):
        which, code = divmod(int(key[order[start]]), len(BOUNDARIES))
        for first in range(start, stop, _BLOCK):
            yield which, code, order[first : min(first + _BLOCK, stop)]


def _rule_codes(rule: Rules) -> tuple[list[Rule], NDArray[np.intp]]:
    """Return rules, and indices into them of the shape of `rule`."""
    if isinstance(rule, str | Rule):
        return [rule_named(rule)], np.asarray(0)
    items, which = _distinct("rule", rule)
    return [rule_named(item) for item in items], which


def _boundary_codes(boundary: Boundaries) -> NDArray[np.intp]:
    """Return `boundary_codes`, reading each object of an array once."""
    boundary = with_pairs_read(boundary)
    if isinstance(boundary, str | Boundary):
        return boundary_codes(boundary)
    items, which = _distinct("boundary", boundary)
    for item in items:
        if not isinstance(item, str | Boundary):
            raise TypeError(f"boundary must be names, pairs of ends or Boundaries, got {shown(item)}")
    return np.array([int(boundary_codes(item)) for item in items], dtype=np.intp)[which]


def _distinct(name: str, value: Any) -> tuple[list[Any], NDArray[np.intp]]:
    """Return the distinct objects of an array, told apart by identity, and indices into them."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "U":
        names, which = np.unique(value, return_inverse=True)
        return [str(name) for name in names], which.reshape(value.shape)
    several = isinstance(value, Iterable) and not isinstance(value, np.ndarray)
    items = np.asarray(bounded(name, value) if several else value, dtype=object)
    flat = items.ravel().tolist()
    identity = np.fromiter(map(id, flat), dtype=np.int64, count=len(flat))
    _, first, which = np.unique(identity, return_index=True, return_inverse=True)
    return [flat[k] for k in first], which.reshape(items.shape)
