"""The number of segments from which on errors stay within a tolerance."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.axial_errors import no_load
from beammodes.accuracy.lookups import lookup_of
from beammodes.accuracy.response_law import frequency_error_allowed
from beammodes.chains.axial_chain import AnyAxialRule
from beammodes.chains.rules import Layout, fits_of
from beammodes.checks import shown, small_fraction, whole_number
from beammodes.closed_form.uniform_chains import MAX_SEGMENTS
from beammodes.deferred import Deferred
from beammodes.numerics.blas import one_thread
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load, check_unloaded, checked_load
from beammodes.problem.motions import Motion, motion_named
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnds
from beammodes.problem.structure import Structure

if TYPE_CHECKING:
    from beammodes.accuracy import judged_motions
else:
    judged_motions = Deferred("beammodes.accuracy.judged_motions")

__all__ = [
    "MAX_MODES_SOUGHT",
    "ToleranceOutOfReach",
    "first_lasting",
    "first_lasting_upwards",
    "segment_grid",
    "segments_needed",
    "segments_of_motion",
    "solved_grid",
]

#: For more modes N is not sought: every N up to 40 times the highest is looked at, in all modes.
MAX_MODES_SOUGHT = 1000

# Longest chains in which N is sought where each is solved as a whole.
_LONGEST_SOLVED = 1000

# Errors that are looked up at a time; roots that are; chains, where each costs some milliseconds.
_BLOCK, _ROOTS, _SOLVED_AT_A_TIME = 200_000, 4096, 8

# Where chains are solved one by one N is enough if no longer chain up to so many times N fails; of a rod with
# steps, of which every chain is looked at, up to twice N. Longer chains cost more to solve.
_AHEAD, _AHEAD_OF_STEPS, _LONG = 3, 2, 100

Counts = NDArray[np.int64]
Fails = Callable[[Counts], NDArray[np.bool_]]


class ToleranceOutOfReach(ValueError):
    """Error: no chain that is looked at stays within the tolerance."""

    @classmethod
    def of(cls, tolerance: float, rule: Layout, modes: int, beam: str, longest: int) -> ToleranceOutOfReach:
        """Return the error, which tells what was looked at."""
        return cls(
            f"tolerance must be larger: with rule {rule.name} and {modes} modes no chain of up to {longest} "
            f"segments of {beam} stays within {shown(tolerance)}"
        )


def segments_needed(
    boundary: AxialBoundaryLike | RodBoundaryLike | Structure,
    tolerance: float,
    modes: int | Mapping[str, int] = 1,
    rule: AnyAxialRule = "mitiguy",
    *,
    load: Load | None = None,
    beam: Beam | Rod | None = None,
    motion: str | Motion = "bending",
    damping_ratio: float | None = None,
) -> int:
    """Return the smallest N from which the first modes all stay within a tolerance, for every larger N too.

        N = min { n : |e_k(n')| ≤ tolerance for all n' ≥ n and k = 1..modes }

    Every N is looked at up to 400 (up to 40 times the highest mode), then N in steps of a hundredth. Where
    each chain is solved (under spin or weight, with a `Layout` that is no `Rule`, or a pattern inside),
    N is sought up to 1000, where the pattern fits: all up to 30, then in steps of a tenth.

    Parameters
    ----------
    boundary : str, pair, Boundary, RodEnds or Structure
        Numbers of its ends are in the units of `beam`; without one they are multiples of ρA L, ρA L³, L,
        EI/L³ and EI/L. Of a `Structure` N is the number in all, shared out as `StructureChain` says; it is
        sought up to 1000, and longer chains are looked at up to three times N.
    tolerance : float
        Largest |e| allowed, as a fraction less than 0.5: 0.01 is one percent.
    modes : int, or mapping from motions to int
        How many modes, from the first; at most 1000, of a `Rod` 100. A rod's bending and twist are numbered
        together; where it is straight, of even GJ, and nothing couples them, {"bending": 3, "twist": 1,
        "second_bending": 3} asks for so many of each (the last with its `second_bending_stiffness`).
    rule : str, Rule or any Layout
    load : Load, optional
        Loads along the beam or of a turning hub, in the units of `beam`, which must then be given.
    beam : Beam or Rod, optional
        `Beam.unit()` makes all numbers multiples of EI/L², ρA L and so on. A `Rod` bends in two planes and
        twists; N is the smallest for all of its modes together. Where a beam or a rod varies, has a rotary
        inertia of its sections, or a rod's motions are coupled, chains are solved beside the exact one: N is
        sought up to 1000, and longer chains are looked at up to three times N (each up to twice N where a
        rod has steps).
    motion : str
        "bending", "twist" or "stretch"; see `frequency_error`.
    damping_ratio : float, optional
        ζ of every mode, at most 0.2. The tolerance is then on the response: no mode loses more than this
        part of its peak at the beam's resonance, |e_k| ≤ ζ √(1/(1 - tolerance)² - 1) by the law of
        `response_error`.

    Returns
    -------
    int
        N; of a `Structure`, all segments together.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, a load comes without a beam, more segments would be needed than are
        sought (10⁹ at most), or the rule is of `matched` springs, which meet frequencies at every N that has
        them.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.segments_needed("clamped-clamped", tolerance=0.01, modes=3, rule="mitiguy")
    26

    A quarter of a circle, bending in its plane and out of it, and twisting:

    >>> wire = {"bending_stiffness": 1.0, "torsional_stiffness": 0.8, "mass_per_length": 1.0}
    >>> quarter = bm.Rod.arc(1.5708, length=1.0, **wire)
    >>> bm.segments_needed("clamped-free", tolerance=0.01, modes=4, rule="gregory", beam=quarter)
    6

    For 98 % of the peaks at a damping of 0.1 %:

    >>> bm.segments_needed("clamped-free", 0.02, modes=3, damping_ratio=0.001)
    107
    >>> bm.segments_needed("clamped-free", 0.02, modes=3, rule="gregory", damping_ratio=0.001)
    15
    """
    if damping_ratio is not None:
        tolerance = frequency_error_allowed(small_fraction("tolerance", tolerance), damping_ratio)
    if isinstance(beam, Rod):
        if motion_named(motion).along:
            raise ValueError(
                f"motion must be left out with a rod, which bends and twists, got {shown(motion)}"
            )
        check_unloaded(load)
        return _segments_of_rod(boundary, tolerance, modes, lookup_of("twist").layout(rule), beam)
    if isinstance(modes, Mapping):
        raise TypeError(
            f"modes must be a number, or beam a Rod, got modes {shown(modes)} and beam {shown(beam)}"
        )
    if isinstance(boundary, Structure):
        if beam is not None or motion_named(motion).along:
            raise ValueError("beam and motion must be left out with a structure, which bends its own beams")
        check_unloaded(load)
        return _segments_of_structure(boundary, tolerance, modes, lookup_of("bending").layout(rule))
    limit, how = small_fraction("tolerance", tolerance), lookup_of(motion)
    if isinstance(beam, Beam) and not _has_lookup(beam, motion_named(motion)):
        return _segments_of_beam(how.boundary(boundary), limit, modes, how.layout(rule), beam, load)
    ends, pull = how.in_multiples(how.boundary(boundary), load, beam)
    record, mode = how.layout(rule), np.arange(1, whole_number("modes", modes, most=MAX_MODES_SOUGHT) + 1)
    exact = getattr(record, "exact_modes", None)
    if exact is not None:
        raise ValueError(
            f"rule must be one whose errors fall as N grows, got {record.name}: its first {exact} "
            "frequencies are the beam's at every N that has springs for them, each N a search of its own; "
            "frequency_error tells the errors of modes above them"
        )

    def fails(count: Counts, most: float = limit) -> NDArray[np.bool_]:
        error = how.errors(ends, count[:, None], mode, record, pull)
        return np.asarray(~(np.abs(error) <= most).all(axis=1))

    def half(count: Counts) -> NDArray[np.bool_]:
        return fails(count, 0.5 * limit)

    cost, at_a_time = how.cost(ends, record, pull), _SOLVED_AT_A_TIME
    if cost == "looked up":
        grid, at_a_time = segment_grid(len(mode)), max(1, _BLOCK // len(mode))
    elif cost == "roots":
        grid, at_a_time = segment_grid(len(mode)), max(1, _ROOTS // len(mode))
        grid = _doubtful(half, grid, _regular(len(mode)), stride=10)
    else:
        grid = _doubtful(half, solved_grid(len(mode), record), max(30, 3 * len(mode)), stride=3)
    needed = first_lasting(fails, grid, at_a_time, fits_of(record))
    if needed is None:
        raise ToleranceOutOfReach.of(tolerance, record, len(mode), ends.name, grid[-1])
    return needed


def _has_lookup(beam: Beam, motion: Motion) -> bool:
    """Return False if each chain of a beam has to be solved, as it varies or its sections have inertia."""
    if motion.along:
        return motion.is_uniform(beam)
    return beam.is_uniform and not beam.has_rotary_inertia


def _segments_of_beam(ends: Any, limit: float, modes: int, rule: Any, beam: Beam, load: Load | None) -> int:
    from beammodes.accuracy.judged_motions import judged_beam

    count = whole_number("modes", modes, most=MAX_MODES_SOUGHT)
    if isinstance(ends, AxialBoundary):
        no_load(load, motion_named(ends.motion))
    return segments_of_motion(judged_beam(beam, ends, count, checked_load(load)), limit, rule)


def _segments_of_rod(
    boundary: Any, tolerance: float, modes: int | Mapping[str, int], rule: Layout, rod: Rod
) -> int:
    from beammodes.accuracy.judged_motions import judged_rod

    if isinstance(boundary, Structure):
        raise ValueError("beam must be left out with a structure, which bends its own beams")
    ends, limit = RodEnds.of(boundary), small_fraction("tolerance", tolerance)
    return max(segments_of_motion(judge, limit, rule) for judge in judged_rod(rod, ends, modes))


def segments_of_motion(judge: judged_motions.JudgedMotion, tolerance: float, rule: Layout) -> int:
    """Return the N from which on chains of a judged motion stay within a tolerance.

    Raises
    ------
    ToleranceOutOfReach
        If none that is looked at does.
    """
    if judge.lookup is not None:
        return segments_needed(tolerance=tolerance, modes=judge.modes, rule=rule, **judge.lookup)
    known: dict[int, bool] = {}

    def fails(count: int) -> bool:
        if count not in known:
            known[count] = not bool((np.abs(judge.errors(rule, count)) <= tolerance).all())
        return known[count]

    grid, ahead, fits = solved_grid(judge.modes, rule), _AHEAD, fits_of(rule)
    if not judge.is_smooth:
        # Where a step lies between two hinges changes from N to N.
        every = range(1, _LONGEST_SOLVED + 1)
        grid, ahead = np.array([n for n in every if fits is None or fits(n)]), _AHEAD_OF_STEPS
    needed = _sought(fails, grid, ahead, fits)
    if needed is None:
        raise ToleranceOutOfReach.of(tolerance, rule, judge.modes, judge.name, grid[-1])
    return needed


def _sought(
    fails: Callable[[int], bool], grid: Counts, ahead: int, fits: Callable[[int], bool] | None
) -> int | None:
    """Return N by chains that are solved one by one, None if none is enough."""
    longer = grid[grid > _LONG][0]
    # Of many small matrices more threads would only wait for each other.
    with one_thread():
        # Where neither a long chain nor the longest will do, none between is looked at.
        hopeless = fails(int(longer)) and fails(int(grid[-1]))
        return None if hopeless else first_lasting_upwards(fails, grid, ahead, fits)


def _segments_of_structure(structure: Structure, tolerance: float, modes: int, rule: Layout) -> int:
    from beammodes.accuracy.structure_errors import failing_segments

    limit, fits = small_fraction("tolerance", tolerance), fits_of(rule) or (lambda _: True)
    fails = failing_segments(structure, limit, modes, rule)
    least = next(n for n in itertools.count(1) if fits(n)) * len(structure.parts.stretches)
    grid = solved_grid(modes, rule)
    # Of long chains, of which one costs as much as many short ones, every third down from the longest.
    long = grid > max(_LONG, 10 * modes)
    grid = np.concatenate((grid[(grid >= least) & ~long], grid[long][::-3][::-1]))
    needed = _sought(fails, grid, _AHEAD, fits_of(rule))
    if needed is None:
        raise ToleranceOutOfReach.of(tolerance, rule, modes, repr(structure), grid[-1])
    return needed


def _doubtful(fails: Fails, grid: Counts, regular: int, stride: int) -> Counts:
    """Return the part of a grid up to where errors keep half the tolerance, and its largest N.

    Looked for from `regular` on, every so many steps: between two N that keep half of it, none fails.
    """
    thin = grid[np.searchsorted(grid, regular) :: stride]
    if not len(thin):
        return grid
    failing = np.flatnonzero(fails(thin))
    last = min(int(failing[-1]) + 1, len(thin) - 1) if len(failing) else 0
    return np.asarray(grid[(grid <= thin[last]) | (grid == grid[-1])])


def first_lasting(
    fails: Fails, grid: Counts, at_a_time: int = _BLOCK, fits: Callable[[int], bool] | None = None
) -> int | None:
    """Return the smallest N from which on nothing of a grid fails; None if its largest N does.

    The grid is looked at from its largest N on, so many at a time; between the last that fails and
    the next, N is found by bisection, among those that `fits` admits.

    Examples
    --------
    >>> first_lasting(lambda counts: counts < 700, np.array([1, 400, 1000, 2000]))
    700
    """
    for stop in range(len(grid), 0, -at_a_time):
        start = max(0, stop - at_a_time)
        failing = np.flatnonzero(fails(grid[start:stop]))
        if not len(failing):
            continue
        last = start + int(failing[-1])
        if last == len(grid) - 1:
            return None
        ends = int(grid[last]), int(grid[last + 1])
        return _first_between(lambda count: bool(fails(np.array([count]))[0]), *ends, fits)
    return int(grid[0])


def _first_between(
    fails: Callable[[int], bool], low: int, high: int, fits: Callable[[int], bool] | None
) -> int:
    """Return the first N that does not fail, between one that does and one that does not."""
    between: Sequence[int] = range(low, high + 1)
    between = between if fits is None else [count for count in between if fits(count)]
    first, last = 0, len(between) - 1
    while last - first > 1:
        middle = (first + last) // 2
        first, last = (middle, last) if fails(between[middle]) else (first, middle)
    return between[last]


def first_lasting_upwards(
    fails: Callable[[int], bool], grid: Counts, ahead: int, fits: Callable[[int], bool] | None = None
) -> int | None:
    """Return the smallest N from which on nothing of a grid fails up to `ahead` times N, None if none does.

    For chains that are solved one by one, of which long ones cost most: the grid is looked at upwards, and N
    then found by bisection, among those that `fits` admits.

    Examples
    --------
    >>> first_lasting_upwards(lambda n: n < 7 or n == 9, np.arange(1, 100), ahead=3)
    10
    """
    needed, failing = None, None
    for count in grid.tolist():
        if fails(count):
            needed, failing = None, count
        elif needed is None:
            needed = count
        elif count > ahead * needed:
            break
    return needed if needed is None or failing is None else _first_between(fails, failing, needed, fits)


def segment_grid(modes: int) -> Counts:
    """Return every N where errors are irregular, then N in steps of one percent up to the largest.

    Up to 40 times the highest mode and 400 an error may rise and fall. Above, it is a sum of a few powers
    of 1/N with at most one change of sign and one extremum, each wider than a step.

    Examples
    --------
    >>> segment_grid(1)[[0, 399, 400, -1]].tolist()
    [1, 400, 404, 1000000000]
    """
    return _grid(_regular(modes), 1.01, MAX_SEGMENTS)


def _regular(modes: int) -> int:
    """Return the N from which on errors change as a few powers of 1/N."""
    return min(max(400, 40 * modes), MAX_SEGMENTS)


def solved_grid(modes: int, record: Layout) -> Counts:
    """Return the N that stand for all of them where each chain has to be solved, up to 1000.

    A rule whose pattern does not fit one of them stands there for the next that it fits.
    """
    grid, fits = _grid(min(max(30, 3 * modes), _LONGEST_SOLVED), 1.1, _LONGEST_SOLVED), fits_of(record)
    if fits is None:
        return grid
    return np.unique([next(n for n in itertools.count(count) if fits(n)) for count in grid.tolist()])


def _grid(dense: int, ratio: float, most: int) -> Counts:
    """Return every N up to `dense`, then N that grow by a ratio, and the largest."""
    steps = np.arange(1, 1 + int(np.log(most / dense) / np.log(ratio)))
    coarse = (dense * ratio**steps).astype(np.int64)
    return np.unique(np.concatenate([np.arange(1, dense + 1), coarse, [most]]))
