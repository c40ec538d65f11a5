"""Grids of chains for labelled tables: one value or several of every rule, pair of ends and segment count."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Layout, layout_of
from beammodes.checks import bounded, shown, whole_number
from beammodes.closed_form.lookup import MAX_SEGMENTS
from beammodes.problem.ends import Boundary, is_pair

if TYPE_CHECKING:
    from beammodes.chains.chain import Chain
    from beammodes.problem.beam import Beam

__all__ = ["MAX_VALUES", "ChainGrid", "last_failing", "listed", "segment_grid", "stands_alone"]

#: Values of one axis of a table: each is looked at by itself.
MAX_VALUES = 10**6


def stands_alone(value: Any, single: tuple[type, ...]) -> bool:
    """Whether `value` is one value and not several: no iterable, or an instance of `single`.

    Where `single` names tuples, for boundaries, a pair of ends is one value, as a tuple or as a list.

    Examples
    --------
    >>> from beammodes.problem.ends import BOUNDARIES
    >>> pairs = (("clamped", "free"), ["clamped", "free"], ("clamped-free", "free-free"), BOUNDARIES)
    >>> [stands_alone(pair, (str, tuple)) for pair in pairs]
    [True, True, False, False]
    """
    if tuple in single and isinstance(value, tuple | list):
        return is_pair(value)
    return isinstance(value, single) or not isinstance(value, Iterable)


def listed(name: str, value: Any, single: tuple[type, ...]) -> list[Any]:
    """Return `value` as a list; one that is an instance of `single` stands alone.

    Raises
    ------
    ValueError
        If it is empty, or has more than `MAX_VALUES`.

    Examples
    --------
    >>> listed("rule", "naive", (str,)), listed("segments", range(3), (str,))
    (['naive'], [0, 1, 2])
    """
    items = [value] if stands_alone(value, single) else bounded(name, value, most=MAX_VALUES)
    if not items:
        raise ValueError(f"{name} must name at least one value, got none")
    return items


class ChainGrid(NamedTuple):
    """Rules, pairs of ends and segment counts, the first three dimensions of a dataset, and their beam."""

    rules: list[Layout]
    boundaries: list[Boundary]
    segments: list[int]
    beam: Beam

    @classmethod
    def of(cls, boundary: Any, segments: Any, rule: Any, most: int, beam: Beam | None = None) -> ChainGrid:
        """Return the grid of one or an iterable of each; raises TypeError or ValueError naming it.

        Parameters
        ----------
        boundary, segments, rule : one of its kind, or an iterable of them
        most : int
            Largest number of segments allowed.
        beam : Beam, optional
            In whose units the numbers of ends are; by default they are multiples of ρA L, EI/L and so on.
        """
        from beammodes.problem.beam import Beam

        if beam is not None and not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam or None, got {shown(beam)}")
        return cls(
            [layout_of(name) for name in listed("rule", rule, (str, Layout))],
            [Boundary.of(pair).canonical for pair in listed("boundary", boundary, (str, Boundary, tuple))],
            [whole_number("segments", n, most=most) for n in listed("segments", segments, (str,))],
            Beam.unit() if beam is None else beam,
        )

    @property
    def shape(self) -> tuple[int, int, int]:
        """How many of each."""
        return len(self.rules), len(self.boundaries), len(self.segments)

    def coordinates(self) -> dict[str, Any]:
        """Return the three coordinates as xarray takes them."""
        return {
            "rule": [record.name for record in self.rules],
            "boundary": [pair.name for pair in self.boundaries],
            "segments": ("segments", self.segments, {"long_name": "number of rigid segments", "units": "1"}),
        }

    def chains(self) -> Iterator[tuple[tuple[int, int, int], Chain]]:
        """Yield indices and chains of the beam, leaving out those whose springs are not positive."""
        from beammodes.chains.chain import Chain

        for i, j, k in np.ndindex(self.shape):
            try:
                chain = Chain(self.beam, self.boundaries[j], self.segments[k], self.rules[i])
            except ValueError:
                # No positive springs for this boundary and N.
                continue
            yield (i, j, k), chain


def segment_grid(modes: int) -> NDArray[np.int64]:
    """Return every N where errors are irregular, then N in steps of one percent up to the largest.

    Up to 40 times the highest mode and 400 an error may rise and fall. Above, it is a sum of a few powers
    of 1/N with at most one change of sign and one extremum, each wider than a step.

    Examples
    --------
    >>> segment_grid(1)[[0, 399, 400, -1]].tolist()
    [1, 400, 404, 1000000000]
    """
    dense = min(max(400, 40 * modes), MAX_SEGMENTS)
    steps = np.arange(1, 1 + int(np.log(MAX_SEGMENTS / dense) / np.log(1.01)))
    coarse = (dense * 1.01**steps).astype(np.int64)
    return np.unique(np.concatenate([np.arange(1, dense + 1), coarse, [MAX_SEGMENTS]]))


def last_failing(fails: Callable[[NDArray[np.int64]], NDArray[np.bool_]], low: int, high: int) -> int:
    """Return the last N of low..high that fails, given that `low` does and `high` does not.

    Examples
    --------
    >>> last_failing(lambda counts: counts < 700, 400, 1000)
    699
    """
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fails(np.array([middle]))[0] else (low, middle)
    return low
