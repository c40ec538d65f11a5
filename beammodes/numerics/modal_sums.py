"""Sums over modes of which each has a damping ratio of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex

__all__ = ["ModalSum", "damped_sum"]


class ModalSum(NamedTuple):
    """A sum over modes, how many of them were told one by one, and how much the last half of these did."""

    value: Complex
    modes: int
    change: float


def damped_sum(
    omega: Floats,
    ratios: Floats,
    undamped: Callable[[Complex], Complex],
    products: Callable[[int], tuple[Floats, Floats]],
    most: int,
    tolerance: float = 1e-10,
) -> ModalSum:
    """Return  Σ c_n / (ω_n² - ω² + 2i ζ_n ω_n ω)  at each ω, where  Σ c_n / (ω_n² - λ)  is known as a whole.

    With one ζ for all modes the part of a term that is even in ω_n is known as a whole, too:

        2 Re a/(ω_n² - λ),     λ = ω² (√(1-ζ²) + iζ)²,     a = ½ + iζ/(2√(1-ζ²)).

    Only the odd part, -2i ζ ω_n ω / |...|², is summed mode by mode. It falls with ω_n³, so that few modes
    suffice, and as many are taken until the last half of them changes nothing beyond the tolerance.

    Parameters
    ----------
    omega : ndarray, shape (frequencies,)
    ratios : ndarray
        ζ_n, less than 1; the last one is that of all higher modes.
    undamped : function of complex λ, shape (frequencies,)
        Gives Σ c_n / (ω_n² - λ), shape (frequencies, ...).
    products : function of a number of modes
        Gives ω_n and real c_n, shapes (modes,) and (modes, ...), of so many modes or all there are.
    most : int
        More modes are not told.
    tolerance : float
        Relative to each value.

    Examples
    --------
    >>> def of_one(square):
    ...     return 3.0 / (4.0 - square)
    >>> one = np.array([2.0]), np.array([3.0])
    >>> found = damped_sum(np.array([2.0]), np.array([0.1]), of_one, lambda count: one, most=2)
    >>> found.value.round(12)                                   # 3 / (2i 0.1 2 2)
    array([0.-3.75j])
    """
    last = float(ratios[-1])
    root = np.sqrt(1.0 - last**2)
    share = 0.5 + 0.5j * last / root
    whole = undamped(((root + 1j * last) * omega) ** 2)
    even = 2.0 * np.real(share * whole) + 0j
    # So many that both the driven modes and those with a ratio of their own are among them.
    count, told = min(most, max(16, 2 * len(ratios))), 0
    value, change = even, np.inf
    while True:
        natural, shares = products(count)
        found = even + _by_modes(omega, natural, shares, ratios)
        size = np.abs(found)
        with np.errstate(invalid="ignore"):
            moved = np.abs(found - value) / np.where(size > 0.0, size, 1.0)
        value, before = found, told
        told, change = len(natural), float(np.max(moved[np.isfinite(moved)], initial=0.0))
        enough = told and natural[-1] > 2.0 * omega.max() and told > len(ratios)
        if told < count or told == before:
            return ModalSum(value, told, 0.0)
        if (enough and before and change <= tolerance) or count == most:
            return ModalSum(value, told, change)
        count = min(most, 2 * count)


def _by_modes(omega: Floats, natural: Floats, shares: Floats, ratios: Floats) -> Complex:
    """Return the odd parts, and what modes with a ratio of their own have beyond the common one."""
    last = ratios[-1]
    # Beyond these a mode answers with nothing, and squares are beyond all floats.
    natural = np.minimum(natural, 1e150)
    gap = natural**2 - omega[:, None] ** 2
    width = 2.0 * last * natural * omega[:, None]
    size = np.hypot(gap, width)
    part = np.divide(width, size, out=np.zeros_like(size), where=width > 0.0)
    terms = -1j * np.divide(part, size, out=np.zeros_like(size), where=width > 0.0)
    own = min(len(ratios) - 1, len(natural))
    if own:
        known = ratios[:own] * 2.0 * natural[:own] * omega[:, None]
        terms[:, :own] += 1 / (gap[:, :own] + 1j * known) - 1 / (gap[:, :own] + 1j * width[:, :own]) - 0j
    return np.asarray(np.tensordot(terms, shares, axes=1))
