"""Errors of chains of structures against the structures themselves, and how many segments are enough."""

from __future__ import annotations

import numpy as np

from beammodes.accuracy.segments import ToleranceOutOfReach, first_lasting_upwards, solved_grid
from beammodes.chains.rules import AnyRule, fits_of, layout_of
from beammodes.chains.structure_chain import StructureChain, shared_segments
from beammodes.checks import shown, small_fraction, whole_number
from beammodes.exact.structure_judge import MOST_MODES, structure_modes
from beammodes.numerics.arrays import Floats
from beammodes.problem.structure import Structure
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["errors_of_structure", "segments_of_structure"]

#: N is enough if no longer chain up to so many times N fails.
_AHEAD = 3


def errors_of_structure(chain: StructureChain, modes: int) -> Floats:
    """Return the relative frequency errors of a chain of a structure, NaN beyond its last mode.

    Examples
    --------
    >>> import beammodes as bm
    >>> two_spans = bm.Structure.of_beam(bm.Beam.unit(), "pinned-pinned", [bm.Station(0.4, float("inf"))])
    >>> errors_of_structure(bm.StructureChain(two_spans, 20, "gregory"), 2).round(6)
    array([-6.40e-05, -3.96e-04])
    """
    count = whole_number("modes", modes, most=MOST_MODES)
    return _errors(chain, structure_modes(chain.structure, count).angular_frequency)


def segments_of_structure(structure: Structure, tolerance: float, modes: int, rule: AnyRule) -> int:
    """Return the smallest N, shared out as `StructureChain` does, that keeps the first modes in a tolerance.

    All N up to 30 are looked at, then steps of a tenth, up to three times the answer.

    Examples
    --------
    >>> import beammodes as bm
    >>> crack = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [bm.Station(0.3, hinge=5.0)])
    >>> [segments_of_structure(crack, 0.01, 3, rule) for rule in ("gregory", "mitiguy")]
    [9, 8]
    >>> [segments_of_structure(crack, 0.001, 3, rule) for rule in ("gregory", "mitiguy")]
    [16, 33]
    """
    limit, count = small_fraction("tolerance", tolerance), whole_number("modes", modes, most=MOST_MODES)
    record = layout_of(rule)
    exact = structure_modes(structure, count).angular_frequency
    fits = fits_of(record) or (lambda _: True)
    one = next(n for n in range(1, 1000) if fits(n))
    grid = solved_grid(count, record)
    grid = grid[grid >= one * len(structure.parts.stretches)]
    known: dict[tuple[int, ...], bool] = {}

    def fails(segments: int) -> bool:
        shared = shared_segments(structure.parts, segments, record)
        if shared not in known:
            errors = _errors(StructureChain(structure, shared, record), exact)
            known[shared] = not bool((np.abs(errors) <= limit).all())
        return known[shared]

    needed = first_lasting_upwards(fails, grid, _AHEAD)
    if needed is None:
        raise ToleranceOutOfReach(
            f"tolerance must be larger: with rule {record.name} and {count} modes no chain of {structure!r} "
            f"of up to {grid[-1]} segments stays within {shown(tolerance)}"
        )
    return needed


def _errors(chain: StructureChain, exact: Floats) -> Floats:
    found = structure_chain_modes(chain).angular_frequency[: len(exact)]
    errors = np.full(len(exact), np.nan)
    errors[: len(found)] = found / exact[: len(found)] - 1.0
    return errors
