"""Frequency errors of chains: the lookup, and how many segments a tolerance needs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.accuracy.grids import last_failing, looked_up, segment_grid
from beammodes.chains.rules import AnyRule, AxiallyCorrected, Layout, Rule, RuleMaker, layout_of
from beammodes.checks import bounded, shown, small_fraction, whole_number
from beammodes.closed_form.discretization import relative_error
from beammodes.closed_form.uniform import MAX_MODE, MAX_SEGMENTS
from beammodes.exact.exact_beam import wavenumber, whole_numbers
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import (
    BOUNDARIES,
    Boundary,
    BoundaryLike,
    NotPlain,
    boundary_codes,
    with_pairs_read,
)
from beammodes.problem.loading import Load

if TYPE_CHECKING:
    from beammodes.problem.beam import Beam

__all__ = [
    "MAX_MODES",
    "MAX_MODES_SOUGHT",
    "MAX_SUPPORTED_MODE",
    "ToleranceOutOfReach",
    "beam_frequencies",
    "errors_in_multiples",
    "frequency_error",
    "segments_needed",
    "solved_grid",
    "supported_errors",
    "supported_frequencies",
]


#: A table of more modes than this would be a mistake.
MAX_MODES = 100_000


# Longest chains in which `segments_needed` seeks: of some roots to find each, and solved as a whole.
_LONGEST, _LONGEST_SOLVED = 10**5, 1000


#: For more modes N is not sought: every N up to 40 times the highest is looked at, in all modes.
MAX_MODES_SOUGHT = 1000


# Errors that are held at a time while N is sought.
_BLOCK = 200_000


class ToleranceOutOfReach(ValueError):
    """No chain that the look-up serves stays within the tolerance."""


@overload
def frequency_error(
    boundary: str | Boundary,
    *,
    segments: int,
    mode: int,
    rule: AnyRule = ...,
    load: Load | None = ...,
    beam: Beam | None = ...,
) -> float: ...


@overload
def frequency_error(
    boundary: BoundaryLike | Iterable[BoundaryLike] | NDArray[Any],
    *,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: AnyRule | Iterable[AnyRule] | NDArray[Any] = ...,
    load: Load | None = ...,
    beam: Beam | None = ...,
) -> float | Floats: ...


def frequency_error(
    boundary: BoundaryLike | Iterable[BoundaryLike] | NDArray[Any],
    *,
    segments: ArrayLike,
    mode: ArrayLike,
    rule: AnyRule | Iterable[AnyRule] | NDArray[Any] = "mitiguy",
    load: Load | None = None,
    beam: Beam | None = None,
) -> float | Floats:
    """Return the signed relative frequency error of a uniform chain.

        e = ω_chain / ω_beam - 1

    It is dimensionless, and plain ends need no beam: length, stiffness and mass scale out. Springs, bodies
    and loads have units: give the `beam`, and they are in its. Arguments broadcast.

    Relative accuracy is 1e-9 or better for modes up to N/10, also where e is far below machine
    epsilon; beyond them, and next to an N where e changes sign, e is within 1e-14. With springs or bodies at
    the ends or an axial force it is within 1e-14, for modes to 1000.

    Parameters
    ----------
    boundary : str, pair of ends, Boundary, or array of them
        Such as "clamped-free"; either order of the ends. Numbers of an `End` are in the units of `beam`.
        Without one they are multiples of ρA L, ρA L³, L, EI/L³ and EI/L: "clamped-free(mass=0.5)" carries
        half the beam's mass at its tip.
    segments : int or array of int
        N, from 1 to 10⁹.
    mode : int or array of int
        1-based index of an elastic mode.
    rule : str, Rule, or array of them; or one record from `mode_tuned` or `matched`
    load : Load, optional
        Loads along the beam or of a turning hub, in the units of `beam`, which must then be given.
    beam : Beam, optional
        Uniform. `Beam.unit()` makes all numbers multiples of EI/L², ρA L and so on.

    Returns
    -------
    float or ndarray
        NaN where the chain has no such mode, or its springs would not be positive (`mode_tuned` with
        N ≤ σβ/3). Near the chain's last mode every rule is wrong by tens of percent. A rule of high order
        may be worse than a simple one there, where its end corrections do not fit into the chain (`gregory`
        with one hinge: -19.6 %, `mitiguy` -14.7 %), and under load, which leaves it order 2: `error_remarks`
        tells it, case by case.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or a load comes without a beam.

    Examples
    --------
    >>> round(frequency_error("clamped-free", segments=6, mode=1), 7)
    -0.0035175
    >>> from beammodes.problem.beam import Beam
    >>> rod = Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)         # m, N m², kg/m
    >>> round(frequency_error("clamped-free(mass=0.3)", segments=6, mode=1, beam=rod), 7)       # kg
    -0.0011994
    >>> frequency_error(["clamped-free", "pinned-pinned"], segments=[[10], [20]], mode=1).round(8)
    array([[-1.25911e-03, -6.92000e-06],
           [-3.14010e-04, -4.30000e-07]])
    """
    ends, pull = looked_up(boundary, load, beam)
    return errors_in_multiples(ends, segments, mode, rule, pull)


def errors_in_multiples(boundary: Any, segments: Any, mode: Any, rule: Any, load: Load) -> float | Floats:
    """Return what `frequency_error` does; numbers of ends and load are multiples of ρA L, EI/L² and so on.

    Examples
    --------
    >>> round(errors_in_multiples("clamped-free", 10, 1, "mitiguy", Load(axial_force=3.0)), 6)
    -0.00265
    """
    if load != Load():
        return _supported(boundary, segments, mode, rule, load)
    try:
        if isinstance(rule, Layout) and not isinstance(rule, Rule):
            return _errors_of_layout(boundary, segments, mode, rule)
        return relative_error(boundary, segments, mode, rule)
    except NotPlain:
        return _supported(boundary, segments, mode, rule, load)


def _supported(boundary: Any, segments: Any, mode: Any, rule: Any, load: Load) -> float | Floats:

    return supported_errors(boundary, segments, mode, rule, load)


def _errors_of_layout(boundary: Any, segments: Any, mode: Any, layout: Layout) -> float | Floats:
    """Return the errors of a record that is no `Rule`: of the rule that it makes for a boundary, if it
    makes one, else of each of its chains, solved.
    """
    codes, counts, modes = np.broadcast_arrays(
        boundary_codes(boundary),
        whole_numbers("segments", segments, most=MAX_SEGMENTS),
        whole_numbers("mode", mode, most=MAX_MODE),
    )
    found = np.full(codes.shape, np.nan)
    for code in np.unique(codes):
        here = codes == code
        if isinstance(layout, RuleMaker):
            found[here] = relative_error(
                BOUNDARIES[code], counts[here], modes[here], layout.rule_for(BOUNDARIES[code])
            )
            continue
        for count in np.unique(counts[here]):
            there = here & (counts == count)
            found[there] = _solved_errors(BOUNDARIES[code], int(count), modes[there], layout)
    return found if found.ndim else float(found)


def _solved_errors(boundary: Boundary, segments: int, mode: NDArray[np.int64], layout: Layout) -> Floats:
    from beammodes.chains.chain import Chain
    from beammodes.problem.beam import Beam
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    errors = np.full(mode.shape, np.nan)
    try:
        chain = Chain(Beam.unit(), boundary, segments, layout)
    except ValueError:
        # No positive springs for this boundary and N.
        return errors
    omega = solve_modes(linearize(chain), int(mode.max())).angular_frequency
    present = mode <= len(omega)
    errors[present] = omega[mode[present] - 1] / np.asarray(wavenumber(boundary, mode[present])) ** 2 - 1
    return errors


def segments_needed(
    boundary: BoundaryLike,
    tolerance: float,
    modes: int = 1,
    rule: AnyRule = "mitiguy",
    *,
    load: Load | None = None,
    beam: Beam | None = None,
) -> int:
    """Return the smallest N from which the first modes all stay within a tolerance, for every larger N too.

        N = min { n : |e_k(n')| ≤ tolerance for all n' ≥ n and k = 1..modes }

    With springs or bodies at the ends or an axial force, N is sought up to 10⁵, and every larger N stands for
    those of a grid: all up to 30, then steps of a tenth. Where each chain is solved, under spin or weight and
    with a `Layout` that is no `Rule`, N is sought up to 1000.

    Parameters
    ----------
    boundary : str, pair or Boundary
        Numbers of its ends are in the units of `beam`; without one they are multiples of ρA L, ρA L³, L,
        EI/L³ and EI/L.
    tolerance : float
        Largest |e| allowed, as a fraction less than 0.5: 0.01 is one percent.
    modes : int
        How many modes, from the first; at most 1000.
    rule : str, Rule or any Layout
    load : Load, optional
        Loads along the beam or of a turning hub, in the units of `beam`, which must then be given.
    beam : Beam, optional
        Uniform. `Beam.unit()` makes all numbers multiples of EI/L², ρA L and so on.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, a load comes without a beam, more segments would be needed than are
        sought (10⁹ at most), or the rule is of `matched` springs, which meet frequencies at every N that has
        them.

    Examples
    --------
    >>> segments_needed("clamped-clamped", tolerance=0.01, modes=3, rule="mitiguy")
    26
    """
    limit = small_fraction("tolerance", tolerance)
    ends, pull = looked_up(Boundary.of(boundary), load, beam)
    record, mode = layout_of(rule), np.arange(1, whole_number("modes", modes, most=MAX_MODES_SOUGHT) + 1)

    def fails(count: NDArray[np.int64]) -> NDArray[np.bool_]:
        error = errors_in_multiples(ends, count[:, None], mode, record, pull)
        return np.asarray(~(np.abs(error) <= limit).all(axis=1))

    def last_on(grid: NDArray[np.int64]) -> int:
        """Return the place of the largest N that fails, or -1; in blocks, from the largest N on."""
        size = max(1, _BLOCK // len(mode))
        for stop in range(len(grid), 0, -size):
            start = max(0, stop - size)
            failing = np.flatnonzero(fails(grid[start:stop]))
            if len(failing):
                return start + int(failing[-1])
        return -1

    exact = getattr(record, "exact_modes", None)
    if exact is not None:
        raise ValueError(
            f"rule must be one whose errors fall as N grows, got {record.name}: its first {exact} "
            "frequencies are the beam's at every N that has springs for them, each N a search of its own; "
            "frequency_error tells the errors of modes above them"
        )
    closed = isinstance(record, Rule | RuleMaker)
    if closed and ends.is_plain and pull == Load():
        grid = segment_grid(len(mode))
    else:
        along = isinstance(record, AxiallyCorrected) and isinstance(record.rule, Rule) and pull.is_axial
        grid = (
            _sparse_grid(len(mode), _LONGEST)
            if (closed or along) and pull.is_axial
            else solved_grid(len(mode))
        )
    failing = last_on(grid)
    if failing < 0:
        return int(grid[0])
    if failing == len(grid) - 1:
        raise ToleranceOutOfReach(
            f"tolerance must be larger: with rule {record.name}, {ends.name} and {len(mode)} modes no chain "
            f"of up to {grid[-1]} segments stays within {shown(tolerance)}"
        )
    return last_failing(fails, int(grid[failing]), int(grid[failing + 1])) + 1


def solved_grid(modes: int) -> NDArray[np.int64]:
    """Return the N that stand for all of them where each chain has to be solved, up to 1000."""
    return _sparse_grid(modes, _LONGEST_SOLVED)


def _sparse_grid(modes: int, most: int) -> NDArray[np.int64]:
    """Return every N where errors are irregular, then N in steps of a tenth: each is some roots to find."""
    dense = min(max(30, 3 * modes), most)
    steps = np.arange(1, 2 + int(np.log(most / dense) / np.log(1.1)))
    coarse = np.minimum(dense * 1.1**steps, most).astype(np.int64)
    return np.unique(np.concatenate([np.arange(1, dense + 1), coarse]))


# Frequency errors of chains whose ends have springs or bodies, or that carry an axial force.

#: Higher modes of one chain are refused: each is a root of its own to find.
MAX_SUPPORTED_MODE = 1000


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
