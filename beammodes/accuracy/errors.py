"""Frequency errors of chains of uniform beams, looked up."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.accuracy.beam_units import looked_up
from beammodes.chains.rules import (
    AnyRule,
    Layout,
    NotClosed,
    Rule,
    RuleMaker,
    has_roots,
    layout_of,
)
from beammodes.checks import distinct, together, whole_number, whole_numbers
from beammodes.closed_form.relative_errors import relative_error
from beammodes.closed_form.uniform_chains import MAX_MODE, MAX_SEGMENTS
from beammodes.deferred import Deferred
from beammodes.exact.exact_beam import wavenumber
from beammodes.numerics.arrays import Floats, keeps_labels
from beammodes.problem.beam import Beam
from beammodes.problem.ends import (
    BOUNDARIES,
    Boundary,
    BoundaryLike,
    ManyPairs,
    NotPlain,
    boundary_codes,
    has_many,
    is_pair,
    with_pairs_read,
)
from beammodes.problem.loading import NO_LOAD, Load

if TYPE_CHECKING:
    from beammodes.accuracy import rooted_errors
    from beammodes.problem import axial_ends, structure
else:
    rooted_errors = Deferred("beammodes.accuracy.rooted_errors")
    axial_ends = Deferred("beammodes.problem.axial_ends")
    structure = Deferred("beammodes.problem.structure")

__all__ = ["MAX_MODES", "errors_in_multiples", "exact_frequencies", "frequency_error"]

#: A table of more modes than this would be a mistake.
MAX_MODES = 100_000

#: Higher modes of one chain are refused where each is a root of its own to find.
_MAX_MODE_FOUND = 1000

#: So many modes of a solved chain are kept.
_MODES_KEPT = 8


@overload
def frequency_error(
    boundary: str | Boundary | axial_ends.AxialBoundary | structure.Structure,
    *,
    segments: int,
    mode: int,
    rule: AnyRule = ...,
    load: Load | None = ...,
    beam: Beam | None = ...,
    motion: str = ...,
) -> float: ...


@overload
def frequency_error(
    boundary: BoundaryLike
    | axial_ends.AxialBoundary
    | ManyPairs
    | Iterable[BoundaryLike]
    | NDArray[Any]
    | structure.Structure,
    *,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: AnyRule | Iterable[AnyRule] | NDArray[Any] = ...,
    load: Load | None = ...,
    beam: Beam | None = ...,
    motion: str = ...,
) -> float | Floats: ...


@keeps_labels
def frequency_error(
    boundary: BoundaryLike
    | axial_ends.AxialBoundary
    | ManyPairs
    | Iterable[BoundaryLike]
    | NDArray[Any]
    | structure.Structure,
    *,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: AnyRule | Iterable[AnyRule] | NDArray[Any] = "mitiguy",
    load: Load | None = None,
    beam: Beam | None = None,
    motion: str = "bending",
) -> float | Floats:
    """Return the signed relative frequency error of a uniform chain.

        e = ω_chain / ω_beam - 1

    It is dimensionless, and plain ends need no beam: length, stiffness and mass scale out. Springs, bodies
    and loads have units: give the `beam`, and they are in its. Arguments broadcast.

    Relative accuracy is 1e-9 or better for modes up to N/10, also where e is far below machine
    epsilon; beyond them, and next to an N where e changes sign, e is within 1e-14. With springs or bodies at
    the ends or an axial force it is within 1e-14, for modes to 1000, and so it is of a rule whose springs
    inside repeat a pattern, of low modes.

    Parameters
    ----------
    boundary : str, pair of ends, Boundary, array of them, or Structure
        Such as "clamped-free"; either order of the ends. Numbers of an `End` are in the units of `beam`.
        Without one they are multiples of ρA L, ρA L³, L, EI/L³ and EI/L: "clamped-free(mass=0.5)" carries
        half the beam's mass at its tip. In a pair either end may be `Ends`, which hold arrays of numbers: as
        quick as arrays of names, at some times the cost of plain ends. Of a structure chains with N segments
        in all are solved, by one rule.
    segments : int or array of int
        N, from 1 to 10⁹.
    mode : int or array of int
        1-based index of an elastic mode.
    rule : str, Rule, or array of them; or one record from `mode_tuned` or `matched`
    load : Load, optional
        Loads along the beam or of a turning hub, in the units of `beam`, which must then be given.
    beam : Beam, optional
        Uniform. `Beam.unit()` makes all numbers multiples of EI/L², ρA L and so on.
    motion : str
        "bending"; or "twist" or "stretch", with ends such as "fixed-free(inertia=0.5)" and
        "fixed-free(mass=0.5)" (see `AxialBoundary`) in the units of `beam`, else multiples of ρIp L and GJ/L,
        ρA L and EA/L. They have no loads; relative accuracy is 1e-12 for modes up to N/6, else within 1e-13.

    Returns
    -------
    float or ndarray
        NaN where the chain has no such mode, its springs would not be positive (`mode_tuned` with N ≤ σβ/3),
        or the rule's pattern does not fit N (`Rule.fits`; "simpson" needs even N). Near the chain's last mode
        every rule is wrong by tens of percent. A rule of high order may be worse than a simple one there,
        where its end corrections do not fit into the chain (`gregory` with one hinge: -19.6 %, `mitiguy`
        -14.7 %), and under load, which leaves it order 2: `error_remarks`
        tells it, case by case.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or a load comes without a beam.

    Examples
    --------
    >>> import beammodes as bm
    >>> round(bm.frequency_error("clamped-free", segments=6, mode=1), 7)
    -0.0035175
    >>> rod = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)      # m, N m², kg/m
    >>> round(bm.frequency_error("clamped-free(mass=0.3)", segments=6, mode=1, beam=rod), 7)    # kg
    -0.0011994
    >>> bm.frequency_error(["clamped-free", "pinned-pinned"], segments=[[10], [20]], mode=1).round(8)
    array([[-1.25911e-03, -6.92000e-06],
           [-3.14010e-04, -4.30000e-07]])
    >>> round(bm.frequency_error("fixed-free", segments=10, mode=1, rule="half_stub", motion="twist"), 7)
    -0.0010278
    """
    if not isinstance(boundary, str | tuple | Boundary):
        # Lookups between ends need nothing of the files of structures.
        from beammodes.problem.structure import Structure

        if isinstance(boundary, Structure):
            from beammodes.accuracy.structure_errors import lookups_of_structure

            return lookups_of_structure(boundary, segments, mode, rule, load=load, beam=beam, motion=motion)
    if not isinstance(motion, str) or motion != "bending":
        # Bending needs nothing of the files of twist.
        from beammodes.accuracy.axial_errors import axial_error_with_units

        found: float | Floats = axial_error_with_units(boundary, segments, mode, rule, load, beam, motion)
        return found
    ends, pull = looked_up(boundary, load, beam)
    return errors_in_multiples(ends, segments, mode, rule, pull)


def errors_in_multiples(boundary: Any, segments: Any, mode: Any, rule: Any, load: Load) -> float | Floats:
    """Return what `frequency_error` does; numbers of ends and load are multiples of ρA L, EI/L² and so on.

    Examples
    --------
    >>> round(errors_in_multiples("clamped-free", 10, 1, "mitiguy", Load(axial_force=3.0)), 6)
    -0.00265
    """
    if is_pair(boundary):
        boundary = Boundary.of(boundary)
    rooted = has_many(boundary) or (isinstance(boundary, Boundary) and not boundary.is_plain)
    if (load is NO_LOAD or load == NO_LOAD) and not rooted:
        try:
            known = isinstance(rule, (str, Rule))
            if not known and isinstance(rule, RuleMaker):
                return _errors_of_maker(boundary, segments, mode, rule)
            if known or not isinstance(rule, Layout):
                return relative_error(boundary, segments, mode, rule)
        except NotClosed:
            if not isinstance(rule, str | Layout):
                return _errors_by_rule(boundary, segments, mode, rule)
        except NotPlain:
            pass
    if type(segments) is type(mode) is int and isinstance(boundary, str | Boundary):
        pair, record = Boundary.of(boundary), layout_of(rule)
        if isinstance(record, Rule) and has_roots(record) and load.is_axial and not pair.has_hub:
            return _error_of_roots(pair, segments, mode, record, load)
    return _errors_of_roots(boundary, segments, mode, rule, load)


def _error_of_roots(pair: Boundary, segments: int, mode: int, rule: Rule, load: Load) -> float:
    """Return one of `_errors_of_roots` without the cost of arrays."""
    from beammodes.accuracy.rooted_errors import check_ratios, rooted_error

    whole_number("segments", segments, most=MAX_SEGMENTS)
    whole_number("mode", mode, most=_MAX_MODE_FOUND)
    check_ratios([pair], load)
    return rooted_error(pair, rule, segments, mode, load)


def _errors_of_maker(boundary: Any, segments: Any, mode: Any, maker: RuleMaker) -> float | Floats:
    codes, counts, modes = together(
        boundary=boundary_codes(boundary),
        segments=whole_numbers("segments", segments, most=MAX_SEGMENTS),
        mode=whole_numbers("mode", mode, most=MAX_MODE),
    )
    found = np.full(codes.shape, np.nan)
    for code in np.unique(codes):
        here, pair = codes == code, BOUNDARIES[code]
        found[here] = relative_error(pair, counts[here], modes[here], maker.rule_for(pair))
    return found if found.ndim else float(found)


def _errors_by_rule(boundary: Any, segments: Any, mode: Any, rule: Any) -> Floats:
    """Return errors where only some of several rules have closed forms."""
    records, which = distinct("rule", rule, (str, Layout), layout_of)
    pairs, ends = distinct("boundary", with_pairs_read(boundary), (str, Boundary), Boundary.of)
    ends, counts, modes, which = together(
        boundary=ends, segments=np.asarray(segments), mode=np.asarray(mode), rule=which
    )
    found = np.full(which.shape, np.nan)
    for k, record in enumerate(records):
        here = which == k
        boundaries = [pairs[end] for end in ends[here]]
        found[here] = errors_in_multiples(boundaries, counts[here], modes[here], record, Load())
    return found


def _errors_of_roots(
    boundary: Any, segments: ArrayLike, mode: ArrayLike, rule: Any, load: Load
) -> float | Floats:
    """Return errors to 1e-14 absolute, from both frequencies, each solved for to all but its last digit.

    Chains on hubs, like those on a turning one, are solved as a whole.
    """
    from beammodes.accuracy.rooted_errors import check_ratios, rooted_errors

    pairs, which = _pairs(boundary)
    hubs = np.zeros(len(pairs), dtype=np.bool_)
    if isinstance(pairs, list):
        hubs[:] = [pair.has_hub for pair in pairs]
    records, chosen = distinct("rule", rule, (str, Layout), layout_of)
    counts = whole_numbers("segments", segments, most=MAX_SEGMENTS)
    plain = load == NO_LOAD and isinstance(pairs, list) and all(pair.is_plain for pair in pairs)
    modes = whole_numbers("mode", mode, most=MAX_MODE if plain else _MAX_MODE_FOUND)
    for few in _alike_in_hubs(pairs, hubs):
        check_ratios(few, load)
    which, counts, modes, chosen = together(boundary=which, segments=counts, mode=modes, rule=chosen)
    error, shape = np.full(which.size, np.nan), which.shape
    which, chosen, counts, modes = (each.ravel() for each in (which, chosen, counts, modes))
    rooted = np.array([load.is_axial and has_roots(record) for record in records])[chosen] & ~hubs[which]
    if rooted.any():
        w, r, n, m = (each[rooted] for each in (which, chosen, counts, modes))
        kept, *_ = _alike_in_hubs(pairs, hubs)
        error[rooted] = rooted_errors(kept, (np.cumsum(~hubs) - 1)[w], records, r, n, m, load)
    solved = np.flatnonzero(~rooted)
    for p, r, n in {*zip(*(each[solved].tolist() for each in (which, chosen, counts)), strict=True)}:
        here = (which == p) & (chosen == r) & (counts == n)
        pair = pairs[p] if isinstance(pairs, list) else pairs.boundary(p)
        omega = _chain_frequencies(pair, n, int(modes[here].max()), records[r], load)
        error[here] = omega[modes[here] - 1] / exact_frequencies(pair, modes[here], load) - 1
    return error.reshape(shape) if shape else float(error[0])


def _alike_in_hubs(pairs: rooted_errors.Pairs, hubs: NDArray[np.bool_]) -> list[rooted_errors.Pairs]:
    """Return the pairs without hubs, then each that has one alone."""
    if not isinstance(pairs, list) or not hubs.any():
        return [pairs]
    return [
        [pair for pair in pairs if not pair.has_hub],
        *([pair] for pair in pairs if pair.has_hub),
    ]


def _pairs(boundary: Any) -> tuple[rooted_errors.Pairs, NDArray[np.intp]]:
    """Return pairs of ends, and the place of each wanted among them, in its shape."""
    from beammodes.problem.end_columns import pairs_of_columns

    if not has_many(boundary):
        return distinct("boundary", with_pairs_read(boundary), (str, Boundary), Boundary.of)
    columns, shape = pairs_of_columns(boundary)
    return columns, np.arange(len(columns)).reshape(shape)


def exact_frequencies(boundary: Boundary, mode: NDArray[np.int64], load: Load) -> Floats:
    """Return the beam's angular frequencies of these modes, for L = EI = ρA = 1.

    Examples
    --------
    >>> exact_frequencies(Boundary.of("pinned-pinned"), np.array([2]), Load()) == (2 * np.pi) ** 2
    array([ True])
    """
    if boundary.is_plain and load == NO_LOAD:
        return np.asarray(wavenumber(boundary, mode)) ** 2
    if load.is_axial and not boundary.has_hub:
        from beammodes.accuracy.rooted_errors import beam_frequencies_of

        return beam_frequencies_of(boundary, mode, load)
    return _beam_frequencies(boundary, int(mode.max()), load)[mode - 1]


@lru_cache(maxsize=4096)
def _beam_frequencies(boundary: Boundary, modes: int, load: Load) -> Floats:
    from beammodes.exact.beam_theory import euler_bernoulli

    return euler_bernoulli(Beam.unit(), boundary, modes, load=load).angular_frequency


def _chain_frequencies(boundary: Boundary, segments: int, modes: int, record: Layout, load: Load) -> Floats:
    """Return a chain's first frequencies for L = EI = ρA = 1, solved as a whole, NaN where it has none."""
    if isinstance(record, RuleMaker):
        record = record.rule_for(boundary)
    if isinstance(record, Rule):
        # Look-ups of its modes, one by one, solve each chain once.
        return _solved_once(boundary, segments, max(modes, _MODES_KEPT), record, load)[:modes]
    return _solved(boundary, segments, modes, record, load)


def _solved(boundary: Boundary, segments: int, modes: int, record: Layout, load: Load) -> Floats:
    from beammodes.chains.chain import Chain
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    omega = np.full(modes, np.nan)
    try:
        chain = Chain(Beam.unit(), boundary, segments, record)
    except ValueError:
        # No positive springs for this boundary and N, or a pattern that does not fit N.
        return omega
    solved = solve_modes(linearize(chain, load=load), modes).angular_frequency
    omega[: len(solved)] = solved
    return omega


_solved_once = lru_cache(maxsize=4096)(_solved)
