"""Frequency errors of chains whose ends have springs or bodies, or that carry an axial force."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.axial_rule import AxiallyCorrected
from beammodes.chains.rules import AnyRule, Layout, Rule, RuleMaker, layout_of
from beammodes.checks import bounded, whole_number
from beammodes.closed_form.lookup import MAX_SEGMENTS
from beammodes.exact.wavenumbers import whole_numbers
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, with_pairs_read
from beammodes.problem.loading import Load

__all__ = ["MAX_SUPPORTED_MODE", "beam_frequencies", "supported_errors", "supported_frequencies"]

#: Higher modes of one chain are refused: each is a root of its own to find.
MAX_SUPPORTED_MODE = 1000

Floats = NDArray[np.float64]


def supported_errors(
    boundary: Any, segments: ArrayLike, mode: ArrayLike, rule: Any, load: Load
) -> float | Floats:
    """Return the relative frequency errors of uniform chains with any ends, broadcast.

        e = ω_chain / ω_beam - 1,  to 1e-14 absolute: both frequencies keep all but their last digit

    Arguments are those of `errors.frequency_error`. The numbers of ends and load count for L = EI = ρA = 1.

    Examples
    --------
    >>> round(supported_errors("clamped-free(mass=1)", 10, 1, "mitiguy", Load()), 6)
    -0.000213
    """
    from beammodes.exact.beam_theory import check_range

    pairs, which = _objects("boundary", with_pairs_read(boundary), (str, Boundary), Boundary.of)
    records, chosen = _objects("rule", rule, (str, Layout), layout_of)
    counts = whole_numbers("segments", segments, most=MAX_SEGMENTS)
    modes = whole_numbers("mode", mode, most=MAX_SUPPORTED_MODE)
    for pair in pairs:
        check_range(Beam.unit(), pair, load)
    which, chosen, counts, modes = np.broadcast_arrays(which, chosen, counts, modes)
    error = np.full(which.shape, np.nan)
    for p, r, n in {*zip(which.flat, chosen.flat, counts.flat, strict=True)}:
        here = (which == p) & (chosen == r) & (counts == n)
        most = int(modes[here].max())
        ratio = supported_frequencies(pairs[p], int(n), most, records[r], load)
        error[here] = (ratio / beam_frequencies(pairs[p], most, load) - 1)[modes[here] - 1]
    return error if error.ndim else float(error)


def supported_frequencies(boundary: Boundary, segments: int, modes: int, rule: AnyRule, load: Load) -> Floats:
    """Return a uniform chain's first frequencies for L = EI = ρA = 1, NaN where it has none.

    Those of a `Rule` come at a cost that does not depend on N, except under spin or weight, where they are
    the chain's own, as those of other records always are.

    Examples
    --------
    >>> supported_frequencies(Boundary.of("clamped-free"), 1, 2, "mitiguy", Load())
    array([ 3., nan])
    """
    record = layout_of(rule)
    if isinstance(record, RuleMaker):
        record = record.rule_for(boundary)
    if isinstance(record, Rule) and load.is_axial:
        return _closed_form(boundary, segments, modes, record, load)
    if isinstance(record, AxiallyCorrected) and isinstance(record.rule, Rule) and load.is_axial:
        return _of_corrected(boundary, segments, modes, record, load)
    from beammodes.chains.chain import Chain
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    omega = np.full(modes, np.nan)
    try:
        chain = Chain(Beam.unit(), boundary, segments, record)
    except ValueError:
        # No positive springs for this boundary and N.
        return omega
    solved = solve_modes(linearize(chain, load=load), modes).angular_frequency
    omega[: len(solved)] = solved
    return omega


def _closed_form(boundary: Boundary, segments: int, modes: int, rule: Rule, load: Load) -> Floats:
    from beammodes.closed_form.supported_chain import supported_chain_frequencies

    found: Floats = supported_chain_frequencies(boundary, segments, modes, rule, load)
    return found


def _of_corrected(
    boundary: Boundary, segments: int, modes: int, record: AxiallyCorrected, load: Load
) -> Floats:
    """Return the frequencies of springs that are all s times a rule's: √s times those of the rule's own,
    under 1/s of the force and between 1/s of the supports.
    """
    stiffer = record.spring_factor(segments)
    if stiffer <= 0:
        return np.full(modes, np.nan)
    ends = [
        replace(
            end,
            translational_stiffness=_softened(end.translational_stiffness, stiffer),
            rotational_stiffness=_softened(end.rotational_stiffness, stiffer),
        )
        for end in (boundary.left, boundary.right)
    ]
    force = Load(axial_force=_softened(load.axial_force, stiffer))
    assert isinstance(record.rule, Rule)
    return math.sqrt(stiffer) * _closed_form(Boundary(*ends), segments, modes, record.rule, force)


def _softened(value: float | Fraction, factor: Fraction) -> float | Fraction:
    return value if value == math.inf else Fraction(value) / factor


@lru_cache(maxsize=4096)
def beam_frequencies(boundary: Boundary, modes: int, load: Load) -> Floats:
    """Return the beam's first angular frequencies for L = EI = ρA = 1, read-only."""
    from beammodes.exact.beam_theory import euler_bernoulli

    return euler_bernoulli(Beam.unit(), boundary, whole_number("modes", modes), load=load).angular_frequency


def _objects(
    name: str, value: Any, single: tuple[type, ...], read: Any
) -> tuple[list[Any], NDArray[np.intp]]:
    """Return what an array of names or records stands for, and indices into it of the array's shape."""
    if isinstance(value, single) or not isinstance(value, Iterable):
        return [read(value)], np.asarray(0)
    items = np.asarray(value if isinstance(value, np.ndarray) else bounded(name, value), dtype=object)
    found: dict[Any, int] = {}
    index = [found.setdefault(read(item), len(found)) for item in items.ravel()]
    return list(found), np.array(index, dtype=np.intp).reshape(items.shape)
