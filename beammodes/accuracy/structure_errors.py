"""Errors of chains of structures against the structures themselves, and which numbers of segments fail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.loaded_structures import Loads, loads_listed
from beammodes.accuracy.stressed_structures import chain_modes_under, structure_modes_under
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import Layout
from beammodes.chains.structure_chain import StructureChain, shared_segments
from beammodes.checks import shown, whole_number, whole_numbers
from beammodes.exact.structure_judge import MOST_MODES, structure_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.loading import Load
from beammodes.problem.structure import Structure
from beammodes.vibration.structure_vibration import lowest_frequencies, structure_chain_modes

__all__ = ["errors_of_structure", "failing_segments"]


def errors_of_structure(chain: StructureChain, modes: int, load: Loads | None = None) -> Floats:
    """Return the relative frequency errors of a chain of a structure, under a load, NaN beyond its last mode.

    Examples
    --------
    >>> import beammodes as bm
    >>> two_spans = bm.Structure.of_beam(bm.Beam.unit(), "pinned-pinned", [bm.Station(0.4, float("inf"))])
    >>> errors_of_structure(bm.StructureChain(two_spans, 20, "gregory"), 2).round(6)
    array([-6.40e-05, -3.96e-04])
    """
    count = whole_number("modes", modes, most=MOST_MODES)
    if load is None or load == Load():
        exact = structure_modes(chain.structure, count).angular_frequency
        return ratios_less_one(structure_chain_modes(chain).angular_frequency, exact, count)
    listed = loads_listed(load)
    exact = structure_modes_under(chain.structure, listed, count).angular_frequency
    return ratios_less_one(chain_modes_under(chain, listed, None).angular_frequency, exact, count)


def lookups_of_structure(
    structure: Structure, segments: ArrayLike, mode: ArrayLike, rule: object, **none: object
) -> float | Floats:
    """Return errors of modes of chains of a structure; arguments are those of `frequency_error`.

    Examples
    --------
    >>> import beammodes as bm
    >>> two_spans = bm.Structure.of_beam(bm.Beam.unit(), "pinned-pinned", [bm.Station(0.4, float("inf"))])
    >>> (100 * bm.frequency_error(two_spans, segments=[[10], [20]], mode=[1, 2], rule="gregory")).round(3)
    array([[-0.198, -1.137],
           [-0.006, -0.04 ]])
    """
    for name, value in none.items():
        if value is not None and value != "bending":
            raise ValueError(f"{name} must be left out with a structure, got {shown(value)}")
    if not isinstance(rule, str | Layout):
        raise TypeError(f"rule must be one rule with a structure, got {shown(rule)}")
    count, number = (
        whole_numbers("segments", segments, most=MAX_PIECES),
        whole_numbers("mode", mode, most=MOST_MODES),
    )
    most = int(number.max(initial=1))
    chains = {n: StructureChain(structure, n, rule) for n in set(count.ravel().tolist())}
    errors = {n: errors_of_structure(chain, most) for n, chain in chains.items()}
    found = np.vectorize(lambda n, k: errors[n][k - 1], otypes=[np.float64])(count, number)
    return found if found.ndim else float(found)


def failing_segments(structure: Structure, limit: float, modes: int, rule: Layout) -> Callable[[int], bool]:
    """Return a function that tells whether N segments in all leave one of the first modes beyond a limit.

    Examples
    --------
    >>> import beammodes as bm
    >>> crack = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [bm.Station(0.3, hinge=5.0)])
    >>> fails = failing_segments(crack, 0.01, 3, bm.RULES["gregory"])
    >>> [n for n in range(2, 20) if fails(n)]
    [2, 3, 4, 6, 7, 8]
    """
    count = whole_number("modes", modes, most=MOST_MODES)
    exact = structure_modes(structure, count).angular_frequency
    known: dict[tuple[int, ...], bool] = {}

    def fails(segments: int) -> bool:
        shared = shared_segments(structure.parts, segments, rule)
        if shared not in known:
            found = lowest_frequencies(StructureChain(structure, shared, rule), count)
            errors = ratios_less_one(found, exact, count)
            known[shared] = not bool((np.abs(errors) <= limit).all())
        return known[shared]

    return fails
