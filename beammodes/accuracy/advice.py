"""Advice: the rule, segments, springs and time step that reach a wanted accuracy at the least cost."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from beammodes.accuracy.errors import frequency_error
from beammodes.accuracy.remarks import error_remarks
from beammodes.accuracy.segments import (
    MAX_MODES_SOUGHT,
    ToleranceOutOfReach,
    first_lasting_upwards,
    segments_needed,
    solved_grid,
)
from beammodes.accuracy.statics import LOADS, beam_statics, chain_statics
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, AnyRule, Layout, fits_of, layout_of
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import bounded, percent, small_fraction, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.structure_judge import MOST_MODES, structure_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.numerics.blas import one_thread
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.structure import Structure
from beammodes.vibration.integrators import INTEGRATORS, find_integrator, stability_limit
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import highest_angular_frequency
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["Recommendation", "recommend"]

#: Integrators whose step the highest mode limits, which makes the cost.
_LIMITED = tuple(
    name for name, each in INTEGRATORS.items() if each.springs == "explicit" and not each.variable_step
)
#: More rules than this are a mistake, or an iterable without an end.
_MAX_RULES = 1000

#: A rule that needs more segments than this is not recommended: nobody would simulate the chain.
MOST_SEGMENTS = 10_000


@dataclass(frozen=True, eq=False, repr=False)
class Recommendation:
    """One way to reach an accuracy, and what it costs.

    Attributes
    ----------
    rule : str
    segments : int
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
        Left to right; of a structure in the order of `StructureChain.hinges`.
    largest_error : float
        Largest |e| of the wanted modes, as a fraction.
    mode : int
        Which mode has it.
    static_error : dict from str to float
        Relative error of the tip's deflection (of the middle's where the tip is held) under each load of
        `statics.LOADS`; empty where the ends let the beam move rigidly.
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
        On the error of the least accurate mode; see `error_remarks`.
    stretches : tuple of int
        Of a structure, the segments of each stretch, as of `StructureChain.segments`.
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

    def __repr__(self) -> str:
        static = max(self.static_error.values(), key=abs, default=math.nan)
        told = [f"frequency error {100 * self.largest_error:.3g} %"]
        if self.stretches:
            told = [f"{' + '.join(map(str, self.stretches))}", f"{told[0]} in mode {self.mode}"]
        if not math.isnan(static):
            told.append(f"static error {percent(static)}")
        if not math.isnan(self.theory_error):
            told.append(f"theory error {percent(self.theory_error)}")
        told += [f"stable step {self.stable_time_step:.4g} s", f"cost {self.cost:.3g}"]
        return f"Recommendation({self.rule}, {self.segments} segments: {', '.join(told)})"


def recommend(
    boundary: BoundaryLike | Structure,
    tolerance: float,
    modes: int = 1,
    *,
    beam: Beam | None = None,
    rules: Iterable[AnyRule] | None = None,
    integrator: str = "rk4",
) -> list[Recommendation]:
    """Return, for each rule, the shortest chain within a frequency tolerance, the cheapest first.

        cost = N · T₁ / h,   T₁ = 2π/ω₁,   h = (2√2 or 2) / ω_max

    Parameters
    ----------
    boundary : boundary or Structure
        Of a structure N is the number of segments in all, shared out and sought as in `segments_needed`.
    tolerance : float
        Largest |e| of the first `modes` frequencies, as a fraction less than 0.5, from this N on.
    modes : int
    beam : Beam, optional
        For springs, steps and numbers of ends in its units; without one all are multiples of EI/L,
        √(ρA L⁴/EI), ρA L and so on. Of one that varies, or has a rotary inertia, each chain is solved beside
        the exact beam, and N is sought up to 1000, all up to 30, then in steps of a tenth; "from this N on"
        is then looked at up to 3 N.
    rules : iterable of rules, optional
        All of `RULES` by default; one that cannot meet the tolerance with 10,000 segments is left out.
    integrator : str
        One of `INTEGRATORS` of fixed step that takes springs explicitly; the chain is undamped.

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
    """
    modes = whole_number("modes", modes, most=MAX_MODES_SOUGHT)
    integrator = find_integrator(integrator, _LIMITED).name
    judge: _Judge | _StructureJudge
    if isinstance(boundary, Structure):
        if beam is not None:
            raise ValueError("beam must be left out with a structure, which has its own beams")
        judge = _StructureJudge.of(boundary, tolerance, modes)
    else:
        judge = _Judge.of(Beam.unit() if beam is None else beam, Boundary.of(boundary), tolerance, modes)
    ways: list[Recommendation] = []
    refusal = ValueError("rules must name at least one rule, got none")
    given = bounded("rules", RULES if rules is None else rules, most=_MAX_RULES)
    for record in _layouts(given):
        try:
            count = judge.segments(record)
        except ToleranceOutOfReach as error:
            refusal = error
            continue
        if count > MOST_SEGMENTS:
            refusal = ValueError(
                f"tolerance must be larger: rule {record.name} needs {count} segments for it"
            )
            continue
        ways.append(judge.way(count, record, integrator))
    if not ways:
        raise refusal
    return sorted(ways, key=lambda way: (way.cost, way.segments))


def _layouts(rules: Iterable[AnyRule]) -> list[Layout]:
    records = []
    for place, rule in enumerate(rules):
        try:
            records.append(layout_of(rule))
        except (TypeError, ValueError) as error:
            raise type(error)(f"rules must be rules, got another at place {place}: {error}") from None
    return records


class _Judge(NamedTuple):
    """Errors of chains of one beam, and the number of segments that keeps them within a tolerance."""

    beam: Beam
    boundary: Boundary
    tolerance: float
    exact: Floats
    theory_error: float

    @classmethod
    def of(cls, beam: Beam, boundary: Boundary, tolerance: float, modes: int) -> _Judge:
        """Return the judge of the first modes of a beam."""
        limit = small_fraction("tolerance", tolerance)
        exact = euler_bernoulli(beam, boundary, whole_number("modes", modes))
        theory = exact.theory_error[~np.isnan(exact.theory_error)]
        worst = float(theory[np.argmax(np.abs(theory))]) if len(theory) else math.nan
        return cls(beam, boundary, limit, exact.angular_frequency, worst)

    @property
    def _is_plain(self) -> bool:
        """True if errors have a closed form: the beam is uniform, without rotary inertia of its sections."""
        return self.beam.is_uniform and not self.beam.has_rotary_inertia

    @property
    def modes(self) -> int:
        """The number of modes wanted."""
        return len(self.exact)

    def errors(self, record: Layout, segments: int) -> Floats:
        """Return the chain's errors, NaN where it has no such mode or the rule no springs."""
        if self._is_plain:
            mode = np.arange(1, self.modes + 1)
            return np.asarray(
                frequency_error(self.boundary, segments=segments, mode=mode, rule=record, beam=self.beam)
            )
        errors = np.full(self.modes, np.nan)
        try:
            chain = Chain(self.beam, self.boundary, segments, record)
        except ValueError:
            # No positive springs for these ends and N.
            return errors
        found = solve_modes(linearize(chain), self.modes).angular_frequency
        errors[: len(found)] = found / self.exact[: len(found)] - 1
        return errors

    def remarks(self, record: Layout, segments: int) -> tuple[str, ...]:
        """Return remarks on the error of the least accurate mode; none for a beam that varies."""
        if not self._is_plain:
            return ()
        worst = int(np.argmax(np.abs(self.errors(record, segments)))) + 1
        return error_remarks(self.boundary, segments=segments, mode=worst, rule=record, beam=self.beam)

    def segments(self, record: Layout) -> int:
        """Return the N from which errors stay in bounds; raises ToleranceOutOfReach."""
        if self._is_plain:
            return segments_needed(self.boundary, self.tolerance, self.modes, record, beam=self.beam)
        grid = solved_grid(self.modes, record)
        needed = first_lasting_upwards(
            lambda count: not (np.abs(self.errors(record, count)) <= self.tolerance).all(),
            grid,
            ahead=3,
            fits=fits_of(record),
        )
        if needed is None:
            raise ToleranceOutOfReach.of(self.tolerance, record, self.modes, "this beam", grid[-1])
        return needed

    def way(self, segments: int, record: Layout, integrator: str) -> Recommendation:
        """Return what so many segments cost."""
        chain = Chain(self.beam, self.boundary, segments, record)
        highest = highest_angular_frequency(chain)
        step = stability_limit(integrator) / highest
        errors = np.abs(self.errors(record, segments))
        return Recommendation(
            rule=record.name,
            segments=segments,
            joint_stiffness=chain.joint_stiffness,
            largest_error=float(np.max(errors)),
            mode=int(np.argmax(errors)) + 1,
            static_error=_static_errors(chain),
            highest_angular_frequency=highest,
            stable_time_step=step,
            cost=segments * 2 * math.pi / float(self.exact[0]) / step,
            theory_error=self.theory_error,
            remarks=self.remarks(record, segments),
        )


class _StructureJudge(NamedTuple):
    """Errors of chains of a structure."""

    structure: Structure
    tolerance: float
    exact: Floats

    @classmethod
    def of(cls, structure: Structure, tolerance: float, modes: int) -> _StructureJudge:
        """Return the judge of the first modes of a structure."""
        limit = small_fraction("tolerance", tolerance)
        count = whole_number("modes", modes, most=MOST_MODES)
        return cls(structure, limit, structure_modes(structure, count).angular_frequency)

    def segments(self, record: Layout) -> int:
        """Return the N from which errors stay in bounds; raises ToleranceOutOfReach."""
        return segments_needed(self.structure, self.tolerance, len(self.exact), record)

    def way(self, segments: int, record: Layout, integrator: str) -> Recommendation:
        """Return what so many segments cost."""
        chain = StructureChain(self.structure, segments, record)
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


def _static_errors(chain: Chain) -> dict[str, float]:
    """Return relative errors of the tip's deflection, or of the middle's where the ends hold the tip."""
    ends = chain.boundary
    if ends.rigid_body_modes or ends.left.is_elastic or ends.right.is_elastic:
        return {}
    assert chain.beam is not None
    found = {}
    for load in LOADS:
        ours, exact = chain_statics(chain, load), beam_statics(chain.beam, chain.boundary, load)
        for quantity in ("deflection", "midspan_deflection"):
            reference = getattr(exact, quantity)
            if math.isfinite(reference) and reference:
                found[load] = getattr(ours, quantity) / reference - 1
                break
    return found
