"""Natural frequencies of many uniform chains with springs and bodies at their ends, at once.

A root is found in three steps, each of which says how far it can be trusted. Counts close it in, and the
determinant in doubles gives it but for what rounding does to its terms: their sum over its slope. Where that
is too much, one or two more steps with the determinant in long doubles, whose terms round 2000 times less
(where the processor has them). What is doubtful then, two modes that nearly are one or a
buckling chain among them, is found in long decimals by `supported_chain`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Rule
from beammodes.closed_form.supported_tables import ChainColumns, OneChain, one_chain, sample, sizes
from beammodes.numerics.arrays import OF_FLOATS, Floats
from beammodes.numerics.counted_arrays import counted_root, counted_roots
from beammodes.problem.ends import Boundary

__all__ = ["found_in_floats", "one_supported_frequency", "supported_frequencies"]

# Columns that are worked on at a time: their temporary arrays then fit a cache.
_BLOCK = 1 << 13
# Fewer are quicker one by one.
_FEW = 16
#: Relative error of ω that is left as it is.
ENOUGH = 4e-15
# What three points of the determinant may leave out, beside what two of them do.
_LEFT_OUT = 1.0
# Steps in long doubles.
_STEPS = 2
# Nothing but rigid motions has a wavenumber below, or the chain may have buckled.
_FLOOR = 1e-4


def supported_frequencies(chains: ChainColumns, mode: Floats, near: Floats | None = None) -> Floats:
    """Return ω of elastic modes, NaN where a chain has no such mode or a spring would not be positive.

    In √(EI / (ρA L⁴)), right to some 1e-15 of itself, for N = 1 to 10⁹; `near` says where to look first.

    Raises
    ------
    ValueError
        If the axial force buckles a chain.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> from beammodes.closed_form.supported_tables import end_weights
    >>> from beammodes.problem.end_columns import BoundaryColumns
    >>> ends = BoundaryColumns.of([Boundary.of("clamped-free(mass=1)")] * 2)
    >>> none, same = np.zeros(2), np.zeros(2, dtype=int)
    >>> chains = ChainColumns(ends, np.array([4.0, 1e6]), same, none, none, end_weights((RULES["mitiguy"],)))
    >>> supported_frequencies(chains, np.ones(2)).round(4)
    array([1.5551, 1.5573])
    """
    if len(mode) > _FEW:
        return _in_arrays(chains, mode, near)
    found, left = np.full(len(mode), np.nan), []
    for i in range(len(mode)):
        omega = _in_single_floats(*chains.one(i), int(mode[i]), None if near is None else float(near[i]))
        found[i] = math.nan if omega is None else omega
        left += [i] if omega is None else []
    if left:
        found[left] = _in_arrays(chains.take(left), mode[left], None if near is None else near[left])
    return found


def one_supported_frequency(
    pair: Boundary,
    segments: int,
    mode: int,
    rule: Rule,
    tension: float = 0.0,
    section: float = 0.0,
    near: float | None = None,
) -> float:
    """Return one of `supported_frequencies` without the cost of arrays.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> round(one_supported_frequency(Boundary.of("clamped-free(mass=1)"), 10**6, 1, RULES["mitiguy"]), 4)
    1.5573
    """
    omega = _in_single_floats(pair, segments, rule, tension, section, mode, near)
    if omega is None:
        chains = ChainColumns.single(pair, segments, rule, tension, section)
        [omega] = _in_arrays(chains, np.array([float(mode)]), None if near is None else np.array([near]))
    return float(omega)


def _in_arrays(chains: ChainColumns, mode: Floats, near: Floats | None) -> Floats:
    found = np.full(len(mode), np.nan)
    at = np.flatnonzero((mode <= chains.modes - chains.rigid_modes) & chains.have_springs())
    found[at], doubt = found_in_floats(chains.take(at), mode[at], None if near is None else near[at])
    for i in at[~(doubt <= ENOUGH)]:
        from beammodes.closed_form.supported_chain import supported_chain_frequency

        found[i] = supported_chain_frequency(*chains.one(i), int(mode[i]), near=float(found[i]))
    return found


def _in_single_floats(
    pair: Boundary,
    segments: int,
    rule: Rule,
    tension: float,
    section: float,
    mode: int,
    near: float | None,
) -> float | None:
    """Return one ω, None where single floats are not enough."""
    chain = one_chain(pair, segments, mode, rule, tension, section)
    if chain is None:
        return None
    try:
        omega, doubt = _solved_one(chain, mode, tension, near)
    except (ArithmeticError, ValueError):
        # Beyond the range of floats.
        return None
    return omega if doubt <= ENOUGH else None


def found_in_floats(chains: ChainColumns, mode: Floats, near: Floats | None = None) -> tuple[Floats, Floats]:
    """Return ω of modes that exist, and a bound of its relative error, infinite where ω is not proved.

    `near` says where to look first.
    """
    found, doubt = np.full(len(mode), np.nan), np.full(len(mode), np.inf)
    depth = chains.depth
    depth = np.where(chains.hinges - 2 * depth + 1 >= 2, depth, 0)
    for size in np.unique(depth):
        at = np.flatnonzero(depth == size)
        for first in range(0, len(at), _BLOCK):
            block = at[first : first + _BLOCK]
            start = None if near is None else near[block]
            with np.errstate(all="ignore"):
                found[block], doubt[block] = _solved(chains.take(block), mode[block], int(size), start)
    return found, doubt


def _solved(chains: ChainColumns, mode: Floats, depth: int, near: Floats | None) -> tuple[Floats, Floats]:
    def table_of(chosen: ChainColumns, kind: type) -> NDArray[Any]:
        return chosen.long_table(depth, kind) if depth else chosen.short_table(kind)

    table, long = table_of(chains, np.float64), depth > 0
    rigid = chains.rigid_modes
    number = mode + rigid
    taken: list[Any] = [None, table]

    def evaluate(which: NDArray[np.intp], place: Floats) -> tuple[Floats, Floats]:
        if which is not taken[0]:
            taken[:] = which, (table if len(which) == len(mode) else table[:, which])
        return sample(taken[1], place, long=long)

    start, reach = np.maximum(1.5, (number - 1.0) * np.pi), np.full(len(mode), 1.5)
    if near is not None:
        wave = np.where(near > 0.0, np.sqrt(near), start)
        reach = wave * np.minimum(0.3 / number, 1e-7 + (wave / chains.segments) ** 2)
        start = wave - 0.3 * reach
    found = counted_roots(evaluate, number, start, reach)
    value, _ = sample(table, found.root, long=long)
    root, slope, bent = _closed_in(*found[:5], value)
    size = sizes(table, found.root, long=long)
    rounded = _rounded(size, root, slope)
    doubt = np.finfo(np.float64).eps * rounded + bent
    pushed = np.flatnonzero(chains.tension < 0.0)
    if len(pushed):
        lowest, proved = np.full(len(pushed), _FLOOR), found.proved
        proved[pushed] &= sample(table[:, pushed], lowest, long=long)[1] == rigid[pushed]
    doubt[~found.proved | np.isnan(doubt)] = np.inf
    omega, again = root * root, np.flatnonzero(found.proved & ~(doubt <= ENOUGH))
    if len(again):
        exact = table_of(chains.take(again), np.longdouble)
        omega[again], left = _corrected(exact, root[again], slope[again], long=long)
        doubt[again] = left + float(np.finfo(np.longdouble).eps) * rounded[again] + np.finfo(float).eps
    return omega, doubt


def _solved_one(chain: OneChain, mode: int, tension: float, near: float | None) -> tuple[float, float]:
    rows, number = chain.rows, mode + chain.rigid

    def evaluate(place: float) -> tuple[float, float]:
        return sample(rows, place, long=chain.long, of=OF_FLOATS)

    start, reach = max(1.5, (number - 1.0) * math.pi), 1.5
    if near:
        start = math.sqrt(near)
        reach = start * min(0.3 / number, 1e-7 + (start / rows[0]) ** 2)
        start -= 0.3 * reach
    found = counted_root(evaluate, number, start, reach)
    if not found.proved or (tension < 0.0 and evaluate(_FLOOR)[1] != chain.rigid):
        return math.nan, math.inf
    root, slope, bent = _closed_in(*found[:5], evaluate(found.root)[0])
    size = sizes(rows, found.root, long=chain.long, of=OF_FLOATS)
    return root * root, np.finfo(np.float64).eps * _rounded(size, root, slope) + bent


def _closed_in(
    root: Any, place: Any, value_there: Any, farther: Any, value_farther: Any, value: Any
) -> tuple[Any, Any, Any]:
    """Return the zero of a parabola through three points, the slope, and what ω's relative error still is."""
    slope = (value - value_there) / (root - place)
    slope_before = (value_farther - value_there) / (farther - place)
    step = -value / slope
    bent = (1.0 - slope_before / slope) / (root - farther) * step * (root + step - place)
    return root + step - bent, slope, 2.0 * _LEFT_OUT * abs(bent / root)


def _rounded(size: Any, root: Any, slope: Any) -> Any:
    """Return by how many roundings ω may be off: the determinant's, with those of angles that grow with q."""
    return 2.0 * size * (1.0 + 0.5 * root) / abs(slope * root)


def _corrected(table: NDArray[Any], root: Floats, slope: Floats, *, long: bool) -> tuple[Floats, Floats]:
    """Return ω after secants in a table's own digits, and their last step, which is more than they leave."""
    place, rise = root.astype(table.dtype), slope.astype(table.dtype)
    value, _ = sample(table, place, long=long)
    for _ in range(_STEPS):
        step = -value / rise
        before, place = value, place + step
        value, _ = sample(table, place, long=long)
        # Far steps tell a better slope than doubles did.
        rise = np.where(np.abs(step) > 1e-12 * place, (value - before) / step, rise)
    step = -value / rise
    place = place + step
    return (place * place).astype(np.float64), np.abs(step / place).astype(np.float64)
