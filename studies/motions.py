"""What studies of motions share: output at times that divide evenly, and digits that repeat."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

import beammodes as bm
from beammodes.dynamics.simulation import simulate

__all__ = ["moved", "repeatable"]

#: Of a time integration in units of the beam; more would differ between processors.
DECIMALS = 8


def moved(
    chain: bm.Chain, duration: float, every: float, *, steps: float = 4.0, **arguments: Any
) -> xarray.Dataset:
    """Return a chain's motion by Runge-Kutta, at 0, every, 2 every, ... to the duration.

    Its steps are the longest ones that divide `every` and that `steps` of fit in the longest stable one.
    """
    longest = bm.stable_time_step(chain, "rk4") / steps
    step = every / math.ceil(every / longest)
    motion = simulate(chain, duration=duration, step=step, output_step=every, **arguments)
    # The same times for every chain, to the last digit.
    return motion.assign_coords(time=np.arange(motion.sizes["time"]) * every)


def repeatable(values: ArrayLike, decimals: int = DECIMALS) -> NDArray[np.float64]:
    """Return rounded numbers, none of them -0; `studies.compare` knows to how many decimals."""
    return np.asarray(values, dtype=np.float64).round(decimals) + 0.0
