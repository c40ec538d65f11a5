"""Advice: the rule, segments, springs and time step that reach a wanted accuracy at the least cost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from beammodes.accuracy.axial_errors import no_load
from beammodes.accuracy.judged_motions import JudgedMotion, judged_beam, judged_rod
from beammodes.accuracy.remarks import error_remarks
from beammodes.accuracy.segments import (
    MAX_MODES_SOUGHT,
    ToleranceOutOfReach,
    segments_needed,
    segments_of_motion,
)
from beammodes.accuracy.statics import LOADS, beam_statics, chain_statics
from beammodes.chains.axial_chain import AnyAxialRule, AxialChain, axial_layout_of
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, Layout, layout_of
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, bounded, percent, shown, small_fraction, whole_number
from beammodes.exact.structure_judge import MOST_MODES, structure_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.numerics.blas import one_thread
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, check_multiples
from beammodes.problem.loading import Load, check_unloaded, load_of
from beammodes.problem.motions import Motion, motion_named, unit_beam
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnds
from beammodes.problem.structure import Structure
from beammodes.vibration.integrators import INTEGRATORS, find_integrator, stability_limit
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["Recommendation", "Recommendations", "recommend"]

#: Integrators whose step the highest mode limits, which makes the cost.
_LIMITED = tuple(
    name for name, each in INTEGRATORS.items() if each.springs == "explicit" and not each.variable_step
)
#: More rules than this are a mistake, or an iterable without an end.
_MAX_RULES = 1000

#: A rule that needs more segments than this is not recommended: nobody would simulate the chain.
MOST_SEGMENTS = 10_000


@dataclass(frozen=True, eq=False, repr=False)
class Recommendation(Shown):
    """One way to reach an accuracy, and what it costs.

    Attributes
    ----------
    rule : str
    segments : int
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
        Left to right; in stretch [N/m], of a rod shape (hinges, 3), as of `SpatialChain`, of a structure in
        the order of `StructureChain.hinges`.
    largest_error : float
        Largest |e| of the wanted modes, as a fraction.
    mode : int
        Which mode has it; of a rod whose motions are apart, counted in its own.
    static_error : dict from str to float
        Relative error of the tip's deflection (of the middle's where the tip is held) under each load of
        `statics.LOADS`; empty where the ends let the beam move rigidly, in twist and stretch, and of rods
        and structures.
    highest_angular_frequency : float [rad/s]
    stable_time_step : float [s]
        For the integrator asked for.
    cost : float
        Segments times steps in one period of the first mode: the work of a simulation whose effort per step
        grows in proportion to the segments.
    theory_error : float
        Largest of `theory_errors` of the wanted modes, which no number of segments lowers: a chain tends to
        Euler and Bernoulli's beam, having no shear. NaN where the beam's section is not known.
    remarks : tuple of str
        On the error of the least accurate mode; see `error_remarks`. Of bending only.
    stretches : tuple of int
        Of a structure, the segments of each stretch, as of `StructureChain.segments`.
    segments_set_by, step_set_by : str
        Which motion N is for, that which a shorter chain has too wrong, and which one's highest frequency
        sets the stable step: "bending", "twist" or "stretch"; of a rod "bending" (in the plane of x and y),
        "second_bending" (of x and z) or "twist", where they are mixed the one that stores most.
    """

    rule: str
    segments: int
    joint_stiffness: Floats
    largest_error: float
    mode: int
    static_error: dict[str, float]
    highest_angular_frequency: float
    stable_time_step: float
    cost: float
    theory_error: float
    remarks: tuple[str, ...]
    stretches: tuple[int, ...] = ()
    segments_set_by: str = "bending"
    step_set_by: str = "bending"

    def _line(self) -> str:
        static = max(self.static_error.values(), key=abs, default=math.nan)
        told = [f"frequency error {100 * self.largest_error:.3g} %"]
        if self.stretches:
            told = [f"{' + '.join(map(str, self.stretches))}", f"{told[0]} in mode {self.mode}"]
        if not math.isnan(static):
            told.append(f"static error {percent(static)}")
        if not math.isnan(self.theory_error):
            told.append(f"theory error {percent(self.theory_error)}")
        told += [f"stable step {self.stable_time_step:.4g} s", f"cost {self.cost:.3g}"]
        if self.joint_stiffness.ndim > 1:
            told.append(f"N set by {self.segments_set_by}, step by {self.step_set_by}")
        return f"Recommendation({self.rule}, {self.segments} segments: {', '.join(told)})"


class Recommendations(Shown, list[Recommendation]):
    """Ways to reach an accuracy, the cheapest first: a list that a notebook shows as a table."""

    __slots__ = ()

    def _line(self) -> str:
        ways = ", ".join(f"{way.rule} with {way.segments} segments" for way in self)
        many = f"{len(self)} ways, the cheapest first" if len(self) != 1 else "1 way"
        return f"<{many}: {ways}>"


def recommend(
    boundary: AxialBoundaryLike | RodBoundaryLike | Structure,
    tolerance: float,
    modes: int | Mapping[str, int] = 1,
    *,
    load: Load | None = None,
    beam: Beam | Rod | None = None,
    rules: Iterable[AnyAxialRule] | None = None,
    integrator: str = "rk4",
    motion: str | Motion = "bending",
) -> Recommendations:
    """Return, for each rule, the shortest chain within a frequency tolerance, the cheapest first.

        cost = N · T₁ / h,   T₁ = 2π/ω₁,   h = (2√2 or 2) / ω_max

    Parameters
    ----------
    boundary : str, pair, Boundary, AxialBoundary, RodEnds or Structure
        Of a structure N is the number of segments in all, shared out and sought as in `segments_needed`.
    tolerance : float
        Largest |e| of the first `modes` frequencies, as a fraction less than 0.5, from this N on.
    modes : int, or mapping from motions to int
        How many, from the first; of a rod as `segments_needed` has it.
    load : Load, optional
        One that leaves a beam straight, in the units of `beam`, which must then be given. Frequencies and
        steps are under it, static errors without it.
    beam : Beam or Rod, optional
        For springs, steps and numbers of ends in its units; without one all are multiples of EI/L,
        √(ρA L⁴/EI), ρA L and so on. Of one that varies, or has a rotary inertia, each chain is solved beside
        the exact beam, and N is sought up to 1000, all up to 30, then in steps of a tenth; "from this N on"
        is then looked at up to 3 N. A `Rod` in space bends in two planes and twists, and N is for all of its
        wanted modes together.
    rules : iterable of rules, optional
        All of `RULES` by default; one that cannot meet the tolerance with 10,000 segments is left out.
    integrator : str
        One of `INTEGRATORS` of fixed step that takes springs explicitly; the chain is undamped.
    motion : str
        "bending"; or "twist" or "stretch" of a `Beam`, with the ends of `frequency_error`.

    Returns
    -------
    list of Recommendation
        One for each rule that meets the tolerance. Rules that no N up to their limit satisfies are left
        out.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no rule meets the tolerance.

    Examples
    --------
    >>> import beammodes as bm
    >>> for way in bm.recommend("clamped-free", tolerance=0.01, modes=3)[:3]:
    ...     print(way.rule, way.segments, f"{way.largest_error:.4f}")
    gregory 8 0.0081
    simpson 8 0.0024
    half_stub_corrected 9 0.0069

    An L of two bars:

    >>> joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 2), "tip": bm.Joint(1, 2)}
    >>> mast, jib = bm.Beam(2.0, 1.0, 1.0), bm.Beam.unit()
    >>> bars = [bm.Member(mast, "foot", "corner"), bm.Member(jib, "corner", "tip")]
    >>> way = bm.recommend(bm.Structure(joints, bars), tolerance=0.01, modes=3, rules=["gregory"])[0]
    >>> way.stretches, way.mode, f"{way.largest_error:.4f}"
    ((5, 3), 3, '0.0091')

    A shaft with a disc, in multiples of rho Ip L:

    >>> bm.recommend("fixed-free(inertia=0.5)", 0.01, 3, rules=["mitiguy"], motion="twist")[0]
    Recommendation(mitiguy, 12 segments: frequency error 0.945 %, stable step 0.1171 s, cost 598)
    """
    kind, integrator = motion_named(motion), find_integrator(integrator, _LIMITED).name
    limit = small_fraction("tolerance", tolerance)
    case: _Case | _StructureCase
    if isinstance(boundary, Structure):
        if beam is not None or kind.along:
            raise ValueError("beam and motion must be left out with a structure, which bends its own beams")
        check_unloaded(load)
        case = _StructureCase.of(boundary, modes)
    else:
        case = _Case.of(boundary, modes, beam, kind, load_of(load, beam))
    ways: list[Recommendation] = []
    refusal = ValueError("rules must name at least one rule, got none")
    given = bounded("rules", RULES if rules is None else rules, most=_MAX_RULES)
    for record in _layouts(given, case.read):
        try:
            counts = case.segments(record, limit)
        except ToleranceOutOfReach as error:
            refusal = error
            continue
        if max(counts) > MOST_SEGMENTS:
            refusal = ValueError(
                f"tolerance must be larger: rule {record.name} needs {max(counts)} segments for it"
            )
            continue
        ways.append(case.way(counts, record, integrator))
    if not ways:
        raise refusal
    return Recommendations(sorted(ways, key=lambda way: (way.cost, way.segments)))


def _layouts(rules: Iterable[AnyAxialRule], read: Callable[[Any], Any]) -> list[Any]:
    records = []
    for place, rule in enumerate(rules):
        try:
            records.append(read(rule))
        except (TypeError, ValueError) as error:
            raise type(error)(f"rules must be rules, got another at place {place}: {error}") from None
    return records


class _Case(NamedTuple):
    """The wanted modes, motion by motion, and the rod that they are of, or None for a beam's."""

    judges: list[JudgedMotion]
    rod: tuple[Rod, RodEnds] | None

    @classmethod
    def of(cls, boundary: Any, modes: Any, beam: Beam | Rod | None, motion: Motion, load: Load) -> _Case:
        """Return the case of a beam in a motion, or of a rod in all of them."""
        if isinstance(beam, Rod):
            if motion.along:
                raise ValueError(
                    f"motion must be left out with a rod, which bends and twists, got {shown(motion.name)}"
                )
            check_unloaded(load)
            ends = RodEnds.of(boundary)
            return cls(judged_rod(beam, ends, modes), (beam, ends))
        count = whole_number("modes", modes, most=MAX_MODES_SOUGHT)
        if beam is None:
            check_multiples(boundary)
        if motion.along:
            no_load(load, motion)
            pair = AxialBoundary.of(boundary, motion)
            return cls([judged_beam(unit_beam() if beam is None else beam, pair, count)], None)
        bent = Beam.unit() if beam is None else beam
        return cls([judged_beam(bent, Boundary.of(boundary), count, load)], None)

    @property
    def read(self) -> Callable[[Any], Any]:
        """What reads a rule, which may have to serve twist or stretch, too."""
        only_bends = self.rod is None and self.judges[0].name == "bending"
        return layout_of if only_bends else axial_layout_of

    def segments(self, record: Any, limit: float) -> list[int]:
        """Return the N from which on errors stay in bounds, for each motion; raises ToleranceOutOfReach."""
        return [segments_of_motion(judge, limit, record) for judge in self.judges]

    def way(self, counts: list[int], record: Any, integrator: str) -> Recommendation:
        """Return what the largest of these N costs."""
        segments = max(counts)
        errors = [np.abs(judge.errors(record, segments)) for judge in self.judges]
        largest = [float(each.max()) for each in errors]
        highest, stepped = self.judges[0].highest(record, segments)
        # Of several motions that need as many, the one that errs more.
        first = max(range(len(counts)), key=lambda k: (counts[k], largest[k]))
        judge, worst = self.judges[first], int(np.argmax(errors[first]))
        if self.rod is None:
            chain: Chain | AxialChain | SpatialChain = judge.chain(record, segments)
        else:
            chain = SpatialChain(*self.rod, segments, record)
        step = stability_limit(integrator) / highest
        theory = [each.theory_error for each in self.judges if not math.isnan(each.theory_error)]
        slowest = min(float(each.exact[0]) for each in self.judges)
        return Recommendation(
            rule=record.name,
            segments=segments,
            joint_stiffness=chain.joint_stiffness,
            largest_error=max(largest),
            mode=int(np.argmax(errors[largest.index(max(largest))])) + 1,
            static_error=_static_errors(chain) if isinstance(chain, Chain) else {},
            highest_angular_frequency=highest,
            stable_time_step=step,
            cost=segments * 2 * math.pi / slowest / step,
            theory_error=max(theory, key=abs, default=math.nan),
            remarks=_remarks(judge, record, segments, worst + 1),
            segments_set_by=_set_by(judge, record, segments),
            step_set_by=stepped,
        )


class _StructureCase(NamedTuple):
    """A structure, and the exact frequencies of its wanted modes."""

    structure: Structure
    exact: Floats

    @classmethod
    def of(cls, structure: Structure, modes: Any) -> _StructureCase:
        """Return the case of the first modes of a structure."""
        count = whole_number("modes", modes, most=MOST_MODES)
        return cls(structure, structure_modes(structure, count).angular_frequency)

    @property
    def read(self) -> Callable[[Any], Any]:
        """What reads a rule."""
        return layout_of

    def segments(self, record: Layout, limit: float) -> list[int]:
        """Return the N from which errors stay in bounds; raises ToleranceOutOfReach."""
        return [segments_needed(self.structure, limit, len(self.exact), record)]

    def way(self, counts: list[int], record: Layout, integrator: str) -> Recommendation:
        """Return what so many segments cost."""
        chain = StructureChain(self.structure, max(counts), record)
        # Of many small matrices more threads would only wait for each other.
        with one_thread():
            omega = structure_chain_modes(chain).angular_frequency
        errors = np.abs(ratios_less_one(omega, self.exact, len(self.exact)))
        step = stability_limit(integrator) / float(omega.max())
        return Recommendation(
            rule=record.name,
            segments=sum(chain.segments),
            joint_stiffness=np.array([hinge.stiffness for hinge in chain.hinges]),
            largest_error=float(errors.max()),
            mode=int(errors.argmax()) + 1,
            static_error={},
            highest_angular_frequency=float(omega.max()),
            stable_time_step=step,
            cost=sum(chain.segments) * 2 * math.pi / float(self.exact[0]) / step,
            theory_error=math.nan,
            remarks=(),
            stretches=chain.segments,
        )


def _remarks(judge: JudgedMotion, record: Any, segments: int, mode: int) -> tuple[str, ...]:
    """Return remarks on the error of the least accurate mode; of bending that is looked up only."""
    if judge.lookup is None or judge.lookup["motion"] != "bending":
        return ()
    return error_remarks(
        segments=segments,
        mode=mode,
        rule=record,
        **{name: value for name, value in judge.lookup.items() if name != "motion"},
    )


def _set_by(judge: JudgedMotion, record: Any, segments: int) -> str:
    """Return which motion the next shorter chain has too wrong, or this one if none has all modes."""
    # Patterns fit every second N, or every third.
    for count in (*range(segments - 1, max(0, segments - 4), -1), segments):
        errors = judge.errors(record, count)
        if not np.isnan(errors).any():
            return judge.name_of(record, count, int(np.argmax(np.abs(errors))))
    raise AssertionError("a recommended chain has all wanted modes")


# All rules of one answer have the same beam.
_exact_statics = lru_cache(maxsize=len(LOADS))(beam_statics)


def _static_errors(chain: Chain) -> dict[str, float]:
    """Return relative errors of the tip's deflection, or of the middle's where the ends hold the tip."""
    ends = chain.boundary
    if ends.rigid_body_modes or ends.left.is_elastic or ends.right.is_elastic:
        return {}
    assert chain.beam is not None
    found = {}
    for load in LOADS:
        ours, exact = chain_statics(chain, load), _exact_statics(chain.beam, chain.boundary, load)
        for quantity in ("deflection", "midspan_deflection"):
            reference = getattr(exact, quantity)
            if math.isfinite(reference) and reference:
                found[load] = getattr(ours, quantity) / reference - 1
                break
    return found
