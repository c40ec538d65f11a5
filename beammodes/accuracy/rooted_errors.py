"""Errors of uniform chains with springs, bodies and an axial force, from both frequencies, over arrays.

Chain and beam are each solved for to some 1e-15, so that an error is within 1e-14, however small.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import AxiallyCorrected, Layout, Rule, RuleMaker
from beammodes.closed_form.supported_lookups import one_supported_frequency, supported_frequencies
from beammodes.closed_form.supported_tables import ChainColumns, end_weights
from beammodes.exact import supported_root, supported_roots
from beammodes.exact.beam_theory import LARGEST_RATIO, check_range, euler_bernoulli
from beammodes.exact.exact_beam import wavenumber
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.end_columns import BoundaryColumns
from beammodes.problem.ends import NUMBERS_OF_END, Boundary
from beammodes.problem.loading import NO_LOAD, Load

__all__ = [
    "Pairs",
    "beam_frequencies",
    "beam_frequencies_of",
    "check_ratios",
    "rooted_error",
    "rooted_errors",
]

Counts = NDArray[np.int64]
# Fewer are quicker one by one.
_FEW = 16
_UNIT = Beam.unit()
#: Ends as records or as columns, each of them once.
Pairs = list[Boundary] | BoundaryColumns


def check_ratios(pairs: Pairs, load: Load) -> None:
    """Raise ValueError if a number is so large beside the beam's that no digits remain.

    Examples
    --------
    >>> check_ratios([Boundary.of("clamped-free(mass=1e30)")], Load())
    """
    if isinstance(pairs, list) and len(pairs) < _FEW:
        for pair in pairs:
            check_range(_UNIT, pair, load)
        return
    columns = pairs if isinstance(pairs, BoundaryColumns) else BoundaryColumns.given(pairs)
    large = np.zeros(len(columns), dtype=bool)
    for side in (columns.left, columns.right):
        for name in NUMBERS_OF_END:
            values = np.abs(getattr(side, name))
            large |= np.isfinite(values) & (values > LARGEST_RATIO)
    first = np.flatnonzero(large)[:1]
    for i in first if len(first) else [0]:
        pair = pairs.boundary(i) if isinstance(pairs, BoundaryColumns) else pairs[i]
        check_range(_UNIT, pair, load)


def rooted_errors(
    pairs: Pairs,
    which: Counts,
    records: Sequence[Layout],
    chosen: Counts,
    counts: Counts,
    modes: Counts,
    load: Load,
) -> Floats:
    """Return errors of chains whose ends and rules are told by their places, all of one dimension.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> one, rule = np.array([0]), [RULES["mitiguy"]]
    >>> pair = [Boundary.of("clamped-free(mass=1)")]
    >>> rooted_errors(pair, one, rule, one, np.array([10]), one + 1, Load()).round(6)
    array([-0.000213])
    """
    if len(which) == 1 and isinstance(pairs, list) and isinstance(records[chosen[0]], Rule):
        rule = records[chosen[0]]
        return np.array([rooted_error(pairs[which[0]], rule, int(counts[0]), int(modes[0]), load)])
    columns = (pairs if isinstance(pairs, BoundaryColumns) else BoundaryColumns.given(pairs)).moving
    # Of a beam that many chains stand for, each frequency once.
    _, first, again = np.unique(which * (modes.max() + 1) + modes, return_index=True, return_inverse=True)
    beam = beam_frequencies(columns.take(which[first]), modes[first], load)[again]
    rules, index = _rules(pairs, which, records, chosen)
    ends, tension, stiffer = (
        columns.take(which),
        np.full(len(which), float(load.axial_force)),
        np.ones(len(which)),
    )
    for r, record in enumerate(records):
        if isinstance(record, AxiallyCorrected):
            # Springs that are all s times a rule's have √s times the frequencies of the rule's own, under 1/s
            # of the force and between 1/s of the supports.
            at = chosen == r
            stiffer[at] = 1.0 - float(record.axial_force) / (12.0 * counts[at].astype(np.float64) ** 2)
    some = np.flatnonzero(stiffer > 0.0)
    softer = BoundaryColumns(*(_softened(side.take(some), stiffer[some]) for side in (ends.left, ends.right)))
    size = counts[some].astype(np.float64)
    chains = ChainColumns(
        softer, size, index[some], tension[some] / stiffer[some], np.zeros(len(some)), end_weights(rules)
    )
    root, error = np.sqrt(stiffer[some]), np.full(len(which), np.nan)
    omega = root * supported_frequencies(chains, modes[some].astype(np.float64), beam[some] / root)
    error[some] = omega / beam[some] - 1.0
    return error


def rooted_error(pair: Boundary, rule: Rule, segments: int, mode: int, load: Load) -> float:
    """Return one of `rooted_errors` without the cost of arrays.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> round(rooted_error(Boundary.of("clamped-free(mass=1)"), RULES["gregory"], 10, 1, Load()), 10)
    7.83e-08
    """
    force = float(load.axial_force)
    if load == NO_LOAD and pair.is_plain:
        beam = float(np.asarray(wavenumber(pair, mode))) ** 2
    else:
        sides = [
            (end.translational_stiffness, end.rotational_stiffness, *end.moving_body)
            for end in (pair.left, pair.right)
        ]
        left, right = ([float(number) for number in side] for side in sides)
        beam = supported_root.supported_frequency(left, right, mode, force)
    if math.isnan(beam):
        _refuse(pair, load)
    return one_supported_frequency(pair, segments, mode, rule, force, near=beam) / beam - 1.0


def beam_frequencies(columns: BoundaryColumns, modes: Counts, load: Load) -> Floats:
    """Return the exact beam's ω for L = EI = ρA = 1, of one mode for each pair of moving ends.

    Examples
    --------
    >>> columns = BoundaryColumns.of([Boundary.of("clamped-free(mass=1)")] * 2)
    >>> beam_frequencies(columns, np.array([1, 2]), Load()).round(4)
    array([ 1.5573, 16.2501])
    """
    force = np.full(len(modes), float(load.axial_force))
    found = supported_roots.supported_frequencies(columns, force, modes)
    for i in np.flatnonzero(np.isnan(found))[:1]:
        _refuse(columns.boundary(i), load)
    return found


def beam_frequencies_of(pair: Boundary, modes: Counts, load: Load) -> Floats:
    """Return `beam_frequencies` of one pair of ends, of the shape of `modes`.

    Examples
    --------
    >>> beam_frequencies_of(Boundary.of("clamped-free(mass=1)"), np.array([[1], [2]]), Load()).round(4)
    array([[ 1.5573],
           [16.2501]])
    """
    check_range(_UNIT, pair, load)
    columns = BoundaryColumns.of(pair).take(np.zeros(modes.size, dtype=int))
    return beam_frequencies(columns, modes.ravel(), load).reshape(modes.shape)


def _refuse(pair: Boundary, load: Load) -> None:
    """Raise what the beam says to its load."""
    euler_bernoulli(_UNIT, pair, 1, load=load)


def _rules(
    pairs: Pairs, which: Counts, records: Sequence[Layout], chosen: Counts
) -> tuple[tuple[Rule, ...], NDArray[np.intp]]:
    """Return the rules whose end weights serve, and the place of each chain's among them."""
    found: dict[Any, int] = {}
    index = np.zeros(len(which), dtype=np.intp)
    for r in np.unique(chosen).tolist():
        record, at = records[r], chosen == r
        if isinstance(record, RuleMaker):
            for p in np.unique(which[at]).tolist():
                pair = pairs.boundary(p) if isinstance(pairs, BoundaryColumns) else pairs[p]
                index[at & (which == p)] = found.setdefault(record.rule_for(pair), len(found))
            continue
        rule = record.rule if isinstance(record, AxiallyCorrected) else record
        index[at] = found.setdefault(rule, len(found))
    return tuple(found), index


def _softened(side: Any, stiffer: Floats) -> Any:
    return replace(
        side,
        translational_stiffness=side.translational_stiffness / stiffer,
        rotational_stiffness=side.rotational_stiffness / stiffer,
    )
