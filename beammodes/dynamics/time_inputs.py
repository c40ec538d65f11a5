"""What drives a chain in time, as one vector: the nine numbers of its base, then the courses of its loads.

Where a base or a load jumps, a step ends and the next one begins; the stages of each see the limits from
within it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.dynamics.base_motion import BaseMotion, base_vector
from beammodes.dynamics.timed_loads import TimedLoad
from beammodes.numerics.arrays import Floats

__all__ = ["TimeInputs"]

# Parts of a step: a jump this near to an end of it is there, and its stages stay so far inside of jumps.
_SAME, _INSIDE = 1e-9, 3e-9


@dataclass(frozen=True)
class TimeInputs:
    """A base and loads that vary in time.

    Examples
    --------
    >>> import beammodes as bm
    >>> drive = TimeInputs(bm.BaseMotion(), (bm.TimedLoad(bm.Load(tip_force=1.0), bm.Step(start=0.25)),))
    >>> drive.at(0.3)[9:], drive.size
    (array([1.]), 10)
    >>> at, lengths, kept = drive.mesh(0.1, 0, 4)
    >>> at.round(9), kept
    (array([0.  , 0.1 , 0.2 , 0.25, 0.3 ]), array([ True,  True, False,  True,  True]))
    """

    base: BaseMotion
    loads: tuple[TimedLoad, ...] = ()

    @property
    def size(self) -> int:
        """How many numbers the vector has."""
        return 9 + len(self.loads)

    @property
    def rests(self) -> bool:
        """True if nothing of it changes in time."""
        return self.base == BaseMotion() and all(load.course is None for load in self.loads)

    @cached_property
    def jumps(self) -> Floats:
        """Times at which a base or a load jumps or kinks, ascending [s]."""
        times = {time for load in self.loads for time in load.jumps} | {*self.base.jumps}
        return np.array(sorted(times), dtype=np.float64)

    def at(self, time: ArrayLike) -> Floats:
        """Return the vector at a time or times, shape (size, ...)."""
        base = base_vector(self.base, time)
        if not self.loads:
            return base
        times = np.asarray(time, dtype=np.float64)
        factors = np.array([load.at(np.atleast_1d(times)).reshape(times.shape) for load in self.loads])
        return np.concatenate([base, factors])

    def mesh(self, step: float, first: int, count: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return where steps start and how long they are, and which of them end at a multiple of `step`.

        They go from step `first` on over `count` multiples of `step`, with further ends at jumps between.
        """
        ends = (first + np.arange(count + 1, dtype=np.float64)) * step
        kept = np.ones(count + 1, dtype=bool)
        inside = self.jumps[(self.jumps > ends[0]) & (self.jumps < ends[-1])]
        if len(inside):
            nearest = np.round(inside / step) * step
            inside = inside[abs(inside - nearest) > _SAME * step]
        if not len(inside):
            return ends[:-1], np.full(count, step), kept[1:]
        ends = np.concatenate([ends, inside])
        order = np.argsort(ends, kind="stable")
        ends, kept = ends[order], order <= count
        return ends[:-1], np.diff(ends), kept[1:]

    def stages(self, at: Floats, lengths: Floats, nodes: ArrayLike) -> Floats:
        """Return the vectors at parts of steps, jumps seen from within, shape (nodes, size, steps)."""
        parts = np.atleast_1d(np.asarray(nodes, dtype=np.float64))[:, None]
        times = at + parts * lengths
        return np.moveaxis(self.at(self._within(times, at, lengths)), 0, 1)

    def _within(self, times: Floats, at: Floats, lengths: Floats) -> Floats:
        if not len(self.jumps):
            return times
        low, high = at + _INSIDE * lengths, at + (1.0 - _INSIDE) * lengths
        around = (at - _INSIDE * lengths, at + (1.0 + _INSIDE) * lengths)
        first, last = (np.searchsorted(self.jumps, edge) for edge in around)
        return np.where(last > first, np.clip(times, low, high), times)
