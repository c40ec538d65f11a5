"""Distributions of numbers, and samples that depend on seed, name and place alone.

Sample i is a function of seed, name and i alone: a counter-based generator (Philox, J. K. Salmon et al.,
Parallel random numbers: as easy as 1, 2, 3, SC 2011) is asked for its i-th block. So chunks, processes and a
longer run of the same seed see the same samples.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from beammodes.checks import Shown, positive_real, real, shown
from beammodes.numerics.arrays import Floats

__all__ = ["MAX_SEED", "Distribution", "Normal", "Uniform", "draw"]

MAX_SEED = 2**64 - 1


@dataclass(frozen=True, repr=False)
class Normal(Shown):
    """A normal distribution, cut off some standard deviations from its mean.

    Parameters
    ----------
    mean, standard_deviation : float
        Of the distribution before it is cut.
    within : float
        How many standard deviations from the mean a value may lie. Real parts have limits, and a height
        below zero has no meaning; 6 cut off 2 in 10⁹.

    Raises
    ------
    TypeError, ValueError
        If a number is not finite, or one of the last two is not greater than 0.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.Normal(200e9, 5e9).bounds
    (170000000000.0, 230000000000.0)
    """

    mean: float
    standard_deviation: float
    within: float = 6.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", real("mean", self.mean))
        for name in ("standard_deviation", "within"):
            object.__setattr__(self, name, positive_real(name, getattr(self, name)))

    @property
    def bounds(self) -> tuple[float, float]:
        """The smallest and the largest value."""
        half = self.within * self.standard_deviation
        return self.mean - half, self.mean + half

    def quantile(self, probability: Floats) -> Floats:
        """Return the values below which a sample lies with these probabilities, between 0 and 1.

        Examples
        --------
        >>> import beammodes as bm
        >>> bm.Normal(1.0, 0.5).quantile(np.array([0.5, 0.975])).round(3)      # 1.960 standard deviations
        array([1.  , 1.98])
        """
        from scipy.special import ndtr, ndtri

        low, high = ndtr(-self.within), ndtr(self.within)
        deviations = ndtri(low + probability * (high - low))
        return np.asarray(np.clip(self.mean + self.standard_deviation * deviations, *self.bounds))


@dataclass(frozen=True, repr=False)
class Uniform(Shown):
    """All values between two, equally likely.

    Parameters
    ----------
    low, high : float

    Raises
    ------
    TypeError, ValueError
        If one is not finite, or `high` is not greater than `low`.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.Uniform(1.0, 3.0).quantile(np.array([0.25]))
    array([1.5])
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            object.__setattr__(self, name, real(name, getattr(self, name)))
        if self.high <= self.low:
            raise ValueError(f"high must be greater than low, {shown(self.low)}, got {shown(self.high)}")

    @property
    def bounds(self) -> tuple[float, float]:
        """The smallest and the largest value."""
        return self.low, self.high

    def quantile(self, probability: Floats) -> Floats:
        """Return the values below which a sample lies with these probabilities, between 0 and 1."""
        return np.clip(self.low + probability * (self.high - self.low), *self.bounds)


Distribution = Normal | Uniform


def draw(distribution: Distribution, seed: int, name: str, start: int, stop: int) -> Floats:
    """Return samples `start` to `stop` of the stream that a seed and a name choose.

    Parameters
    ----------
    distribution : Normal or Uniform
    seed : int
        From 0 to `MAX_SEED`.
    name : str
        Streams of different names are independent.
    start, stop : int

    Returns
    -------
    ndarray, shape (stop - start,)

    Examples
    --------
    >>> nine, two = (draw(Uniform(0.0, 1.0), 7, "height", *part) for part in ((0, 9), (4, 6)))
    >>> bool((nine[4:6] == two).all())
    True
    """
    stream = int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "little")
    blocks = np.random.Philox(key=seed | stream << 64, counter=start)
    # A block has four numbers; the first is taken, so that sample i is block i. 53 bits make a float.
    words = blocks.random_raw(4 * (stop - start))[::4]
    probability: Floats = ((words >> np.uint64(11)) + np.float64(0.5)) * 2.0**-53
    return distribution.quantile(probability)
