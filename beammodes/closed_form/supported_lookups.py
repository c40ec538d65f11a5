"""Natural frequencies of many uniform chains with springs and bodies at their ends, at once, in floats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Rule
from beammodes.closed_form.supported_tables import ChainColumns, EndWeights, sample, sizes
from beammodes.numerics.arrays import Floats
from beammodes.numerics.counted_arrays import counted_roots

# Columns that are worked on at a time: their temporary arrays then fit a cache.
_BLOCK = 1 << 13
_ENOUGH = 4e-15


def lookup(chains: ChainColumns, mode: Floats, near: Floats | None = None) -> tuple[Floats, Floats]:
    """Return ω and the bound of its relative error that rounding can have made; NaN where unproved."""
    found, doubt = np.full(len(mode), np.nan), np.full(len(mode), np.inf)
    depth = chains.depth
    depth = np.where(chains.hinges - 2 * depth + 1 >= 2, depth, 0)
    for size in np.unique(depth):
        at = np.flatnonzero(depth == size)
        for first in range(0, len(at), _BLOCK):
            block = at[first : first + _BLOCK]
            found[block], doubt[block] = _solved(chains.take(block), mode[block], int(size), None)
    return found, doubt


def _solved(chains: ChainColumns, mode: Floats, depth: int, near: Floats | None) -> tuple[Floats, Floats]:
    table = chains.long_table(depth) if depth else chains.short_table()
    long = depth > 0
    number = mode + chains.rigid_modes
    taken: list[Any] = [None, table]

    def evaluate(which: NDArray[np.intp], place: Floats) -> tuple[Floats, Floats]:
        if which is not taken[0]:
            taken[:] = which, (table if len(which) == len(mode) else table[:, which])
        return sample(taken[1], place, long=long)

    start = np.maximum(1.5, (number - 1.0) * np.pi)
    with np.errstate(all="ignore"):
        found = counted_roots(evaluate, number, start, np.full(len(mode), 1.5))
        value, _ = sample(table, found.root, long=long)
        size = sizes(table, found.root, long=long)
        slope = (value - found.value) / (found.root - found.place)
        slope_before = (found.value_farther - found.value) / (found.farther - found.place)
        bend = (1.0 - slope_before / slope) / (found.root - found.farther)
        step = -value / slope
        root = found.root + step
        bent = bend * step * (root - found.place)
        root = root - bent
        doubt = 2.0 * (2.2e-16 * size * (1.0 + 0.5 * root) / np.abs(slope * root) + 0.2*np.abs(bent)/root)
    doubt[~found.proved | np.isnan(doubt)] = np.inf
    return root * root, doubt
