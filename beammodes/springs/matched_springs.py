"""Springs that make a chain's first frequencies the beam's, and the rule that is made of them.

With few segments and a few modes that matter one can do better than a rule of the registry by giving up the
rest: every spring is solved for, in the inverse eigenvalue problem of `inverse_eigenvalue`. The springs hold
for the stated boundary only. Exactness in frequency is no exactness elsewhere, so what a matched chain does
to static deflections, mode shapes and time steps is stated beside its springs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache, partial
from typing import Any, ClassVar, overload

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, hinges_at_nodes
from beammodes.checks import Shown, choice, flag, positive_real, row_shown, shown, whole_number
from beammodes.exact.exact_beam import plain_modes, wavenumber
from beammodes.numerics.arrays import Floats, frozen
from beammodes.problem.axial_ends import AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, check_multiples
from beammodes.problem.motions import motion_named
from beammodes.springs.axial_matching import AxialMatched, AxialMatchedSprings, match_axial_springs
from beammodes.springs.inverse_eigenvalue import (
    MAX_MATCHED,
    Conditions,
    ExactModes,
    Solution,
    closest,
    spring_state,
    symmetric_basis,
)
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.spectrum import FlexibilityForm, flexibility_form
from beammodes.vibration.stability import stable_time_step

__all__ = ["Matched", "MatchedSprings", "NoPositiveSprings", "match_springs", "matched"]


@dataclass(frozen=True, eq=False, repr=False)
class MatchedSprings(Shown):
    """Springs of one chain whose first frequencies are the beam's; `match_springs` makes it.

    Attributes
    ----------
    boundary : Boundary
    segments, modes : int
    chain : Chain
        Uniform rods of the given beam, hinges at the nodes and walls.
    stiffness_ratio : ndarray, shape (hinges,) [-]
        Joint stiffness over EI/ell, left to right.
    frequency_errors : ndarray, shape (modes,) [-]
        ω_chain/ω_beam - 1, what rounding leaves.
    static_tip_deflection_error : float [-]
        Relative, under a force on the tip that can deflect; NaN where no such tip finds a finite answer.
    mode_shape_agreement : ndarray, shape (modes,) [-]
        Mass-weighted modal assurance criterion, 1 at best, with the exact shapes sampled at the nodes.
    stable_time_step : float [s]
        Of fixed-step RK4.
    criterion : str
        Which springs it is close to.
    criterion_value : float [-]
        Σ ln² of the springs over those.
    symmetric : bool
        Whether the springs are their own mirror image.

    Examples
    --------
    >>> from beammodes.springs.matched_springs import match_springs
    >>> match_springs("pinned-pinned", segments=2, modes=1).stiffness_ratio         # π⁴/96
    array([1.01467803])
    """

    boundary: Boundary
    segments: int
    modes: int
    chain: Chain
    stiffness_ratio: Floats
    frequency_errors: Floats
    static_tip_deflection_error: float
    mode_shape_agreement: Floats
    stable_time_step: float
    criterion: str
    criterion_value: float
    symmetric: bool

    def _line(self) -> str:
        springs = row_shown(self.stiffness_ratio, "{:.6g}", "EI/ell")
        met = f"{self.segments} segments, {self.modes} modes of the beam met"
        return f"MatchedSprings({self.boundary}, {met}: {springs})"


class NoPositiveSprings(ValueError):
    """No positive springs were found that meet the conditions.

    Attributes
    ----------
    nearest : MatchedSprings
        Those of least-squares deviation.

    Examples
    --------
    >>> from beammodes.springs.matched_springs import match_springs
    >>> try:
    ...     match_springs("clamped-free", segments=2, modes=2, hold_tip_stiffness=True)
    ... except NoPositiveSprings as error:
    ...     print(error.nearest.frequency_errors.round(3))
    [-0.042 -0.007]
    """

    def __init__(self, message: str, nearest: MatchedSprings) -> None:
        super().__init__(message, nearest)
        self.nearest = nearest

    def __str__(self) -> str:
        return str(self.args[0])


def uniform_rods(beam: Beam, boundary: Boundary, segments: int, ratio: Floats) -> Chain:
    """Return a chain of uniform rods with the springs `ratio` times EI/ell; lengths and masses are exact."""
    ell = Fraction(beam.length) / segments
    lengths = [piece * ell for piece in hinges_at_nodes(boundary, segments)]
    masses = [Fraction(beam.mean_mass_per_length) * length for length in lengths]
    return Chain.from_pieces(
        length=lengths,
        mass=masses,
        rotary_inertia=[mass * length**2 / 12 for mass, length in zip(masses, lengths, strict=True)],
        joint_stiffness=(ratio * (beam.mean_bending_stiffness / float(ell))).tolist(),
        boundary=boundary,
    )


def shape_agreement(chain: Chain, first: Floats, second: Floats) -> Floats:
    """Return the modal assurance criterion of shapes at the nodes, weighted with the pieces' inertia."""
    rods = chain.length > 0

    def momenta(shapes: Floats) -> Floats:
        left, right = shapes[:, :-1][:, rods], shapes[:, 1:][:, rods]
        slope = (right - left) / chain.length[rods]
        return np.hstack(
            [np.sqrt(chain.mass[rods]) * (left + right) / 2, np.sqrt(chain.rotary_inertia[rods]) * slope]
        )

    a, b = momenta(first), momenta(second)
    return np.asarray((a * b).sum(axis=1) ** 2 / (a**2).sum(axis=1) / (b**2).sum(axis=1))


#: Deflection of the right tip under a unit force there, in L³/EI, of the canonical pairs where it is finite.
_TIP_COMPLIANCE = {"clamped-free": 1 / 3, "clamped-guided": 1 / 12, "pinned-guided": 1 / 3}


# The rule whose springs each criterion wants.
_CRITERIA = {"gregory": "gregory", "uniform": "naive"}


@dataclass(frozen=True, eq=False)
class SpringTask:
    """One call of `match_springs`, read and checked; its springs run in the canonical order of the ends."""

    boundary: Boundary
    segments: int
    modes: int
    criterion: str
    symmetric: bool
    beam: Beam
    unit: FlexibilityForm

    @classmethod
    def of(
        cls,
        boundary: BoundaryLike,
        segments: int,
        modes: int,
        criterion: str,
        symmetric: bool | None,
        beam: Beam | None,
    ) -> SpringTask:
        """Return the task, or raise what `match_springs` says it raises."""
        pair = Boundary.of(boundary)
        if beam is None:
            check_multiples(pair)
        count = _matchable(segments)
        layout = Chain(Beam.unit(), pair.canonical, count, "naive")
        wanted_modes = whole_number("modes", modes)
        if wanted_modes > layout.elastic_modes:
            raise ValueError(
                f"modes must be at most {layout.elastic_modes}, all the elastic modes of a {pair.name} chain "
                f"of {count} segments, got {wanted_modes}"
            )
        if beam is not None and not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(beam)}")
        if beam is not None and not beam.is_uniform:
            raise ValueError(f"beam must be uniform for matched springs, got {shown(beam)}")
        mirrored = _mirrored(pair, wanted_modes, len(layout.scaled.joint_stiffness), symmetric)
        unit = flexibility_form(layout)
        return cls(pair, count, wanted_modes, criterion, mirrored, beam or Beam.unit(), unit)

    @property
    def pair(self) -> Boundary:
        """The ends in the order in which this task's springs run."""
        return self.boundary.canonical

    def log_springs(self, rule: str) -> Floats:
        """Return ln k of a rule's hinges."""
        weights = RULES[rule].hinge_weights(self.pair, self.segments)
        return np.asarray(-np.log(np.array([float(weight) for weight in weights])))

    @property
    def wanted(self) -> Floats:
        """ln k⁰ of the criterion."""
        return self.log_springs(_CRITERIA[self.criterion])

    def conditions(self, hold_tip_stiffness: bool) -> Conditions:
        """Return the equations to be met."""
        if hold_tip_stiffness and self.pair.name not in _TIP_COMPLIANCE:
            raise ValueError(
                f"hold_tip_stiffness needs a tip that deflects under a force and a support that answers it: "
                f"{', '.join(_TIP_COMPLIANCE)}, got {self.boundary.name}"
            )
        numbers = np.arange(1, self.modes + 1)
        # In the chain's own units the beam's frequency is β²/N², its tip's compliance N³ times that of L = 1.
        target = 4 * np.log(np.asarray(wavenumber(self.pair, numbers)) / self.segments)
        held = math.log(self._tip_compliance) if hold_tip_stiffness else None
        basis = symmetric_basis(len(self.wanted), self.symmetric)
        return Conditions(partial(spring_state, self.unit), basis, tuple(range(self.modes)), target, held)

    @property
    def _tip_compliance(self) -> float:
        return _TIP_COMPLIANCE.get(self.pair.name, math.nan) * self.segments**3

    def search(self, conditions: Conditions, *first: Floats) -> Solution:
        """Return the closest springs, from those given and from those of the rules that have a wall hinge."""
        wanted, *others = (
            conditions.basis.T @ springs
            for springs in (self.wanted, *map(self.log_springs, ("gregory", "naive", "double_wall")))
        )
        return closest(conditions, wanted, [*first, *others])

    def highest(self, given: float) -> float:
        """Return the highest frequency that is allowed, checked, in √(EI/(ρA L⁴))."""
        rate = positive_real("highest_frequency", given)
        own = rate / self.beam.frequency_unit
        least = float(wavenumber(self.pair, self.modes) ** 2)
        if own < least * (1 - 1e-12):
            raise ValueError(
                f"highest_frequency must be at least that of mode {self.modes}, "
                f"{least * self.beam.frequency_unit:.9g} rad/s, got {rate:.9g}"
            )
        return own

    def below(self, highest: float, conditions: Conditions, free: Solution) -> Solution:
        """Return `free` if its chain's highest frequency is low enough, else the closest that is."""
        ceiling = 2 * math.log(highest / self.segments**2)
        limited = replace(conditions, ceiling=ceiling)
        state, residual, _ = limited.at(free.z)
        top = len(state.log_square) - 1
        if not free.met or limited.met(state, residual) or top < self.modes:
            return free
        bound = replace(
            conditions, modes=(*conditions.modes, top), log_square=np.append(conditions.log_square, ceiling)
        )
        # Closest on the bound is not closest below it where the distance falls further inwards.
        edge = self.search(bound, free.z)
        inside = self.search(limited, edge.z)
        better = inside.met and (not edge.met or inside.distance < edge.distance)
        return inside if better else edge

    def described(self, ratio: Floats) -> MatchedSprings:
        """Return the record of springs `ratio`, in the order of the ends as they were given."""
        state = spring_state(self.unit, np.log(ratio))
        distance = float(np.sum((np.log(ratio) - self.wanted) ** 2))
        given = ratio if self.boundary == self.pair else ratio[::-1]
        chain = uniform_rods(self.beam, self.boundary, self.segments, given)
        exact = plain_modes(self.beam, self.boundary, self.modes)
        found = solve_modes(linearize(chain), self.modes)
        shapes = exact.shape(np.minimum(found.position, self.beam.length))
        return MatchedSprings(
            self.boundary,
            self.segments,
            self.modes,
            chain,
            frozen(given),
            frozen(found.angular_frequency / exact.angular_frequency - 1),
            float(state.tip @ state.tip) / self._tip_compliance - 1,
            frozen(shape_agreement(chain, found.deflection, shapes)),
            stable_time_step(chain),
            self.criterion,
            distance,
            bool(np.allclose(ratio, ratio[::-1], rtol=1e-9, atol=0)),
        )

    def refusal(self) -> str:
        """Return the message for springs that were not found."""
        return (
            f"no positive springs were found that meet all conditions on {self.modes} modes of a "
            f"{self.boundary.name} chain of {self.segments} segments; the nearest are this error's `nearest`"
        )


def _matchable(segments: int) -> int:
    count = whole_number("segments", segments)
    if count > MAX_MATCHED:
        raise ValueError(
            f"segments must be at most {MAX_MATCHED} for matched springs, whose search solves a dense "
            f'eigenproblem at every step, got {count}; rule "gregory" is within 1e-8 there for three modes'
        )
    return count


def _mirrored(pair: Boundary, modes: int, hinges: int, symmetric: bool | None) -> bool:
    """Return whether the springs shall mirror each other."""
    if symmetric is not None:
        flag("symmetric", symmetric, or_none=True)
    if pair.left != pair.right:
        if symmetric:
            raise ValueError(f"symmetric must not be True where the ends differ, got {pair.name}")
        return False
    independent = (hinges + 1) // 2
    if symmetric is not False and independent < modes:
        raise ValueError(
            f"modes must be at most {independent} for symmetric springs, as many as differ among {hinges}, "
            f"got {modes}; symmetric=False allows springs that do not mirror each other"
        )
    return symmetric is not False


@overload
def match_springs(
    boundary: BoundaryLike,
    segments: int,
    modes: int,
    *,
    criterion: str = ...,
    hold_tip_stiffness: bool = ...,
    highest_frequency: float | None = ...,
    symmetric: bool | None = ...,
    beam: Beam | None = ...,
) -> MatchedSprings: ...


@overload
def match_springs(
    boundary: AxialBoundaryLike,
    segments: int,
    modes: int,
    *,
    symmetric: bool | None = ...,
    beam: Beam | None = ...,
    motion: str,
) -> AxialMatchedSprings: ...


def match_springs(
    boundary: Any,
    segments: int,
    modes: int,
    *,
    criterion: str = "gregory",
    hold_tip_stiffness: bool = False,
    highest_frequency: float | None = None,
    symmetric: bool | None = None,
    beam: Beam | None = None,
    motion: str = "bending",
) -> MatchedSprings | AxialMatchedSprings:
    """Return positive springs that make a chain's first frequencies the beam's.

        minimize Σ ln²(k_j/k_j⁰)   subject to   ω_n(k) = β_n² √(EI/(ρA L⁴)),  n = 1 ... modes

    Frequencies are met within 1e-12, against 50-digit arithmetic. Solutions are not unique; this is the
    closest to k⁰ among those that searches from fixed starts find. Exact frequencies do not make exact
    statics: with 3 modes of a cantilever the tip deflects too little by 10 % at N = 3, 6.8 % at 4, 0.6 % at
    5, below 0.1 % from 6 and 0.009 % at 12.

    Parameters
    ----------
    boundary : str, pair of ends or Boundary
    segments : int
        N, 1 to 200.
    modes : int
        How many, from the first; at most all elastic ones.
    criterion : str
        k⁰ is the springs of rule "gregory", or "uniform": EI/ell at every hinge.
    hold_tip_stiffness : bool
        Also make the static deflection of the tip under a force there the beam's.
    highest_frequency : float, optional [rad/s]
        What the chain's highest ω shall not exceed, for the sake of the time step.
    symmetric : bool, optional
        Whether springs mirror each other; by default they do where both ends are alike.
    beam : Beam, optional
        Sets the units of the chain and of `highest_frequency`; `Beam.unit()` by default.
    motion : str
        "bending"; or "twist" or "stretch", in which all frequencies can be met at once: the answer is then
        that of `match_axial_springs`, which has no criterion, held tip or highest frequency.

    Returns
    -------
    MatchedSprings or AxialMatchedSprings
        The springs, what is left of the errors, and what they do to statics and to mode shapes.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or out of range, or a symmetric chain has too few springs.
    NoPositiveSprings
        A ValueError: if no springs were found; its `nearest` has the least-squares ones.

    References
    ----------
    An inverse eigenvalue problem, solved by Newton's method in ln k (see `inverse_eigenvalue`).

    Examples
    --------
    >>> springs = match_springs("clamped-free", segments=4, modes=3)
    >>> springs.stiffness_ratio.round(4)
    array([1.8835, 1.158 , 1.3084, 1.7892])
    >>> bool(abs(springs.frequency_errors).max() < 1e-12)
    True
    """
    word, held = choice("criterion", criterion, _CRITERIA), flag("hold_tip_stiffness", hold_tip_stiffness)
    if motion_named(motion).along:
        given = {"criterion": None if word == "gregory" else word, "hold_tip_stiffness": held or None}
        for name, value in (given | {"highest_frequency": highest_frequency}).items():
            if value is not None:
                raise ValueError(f"{name} must be left out for motion {motion}, got {shown(value)}")
        return match_axial_springs(boundary, segments, modes, symmetric=symmetric, beam=beam, motion=motion)
    task = SpringTask.of(boundary, segments, modes, word, symmetric, beam)
    conditions = task.conditions(held)
    highest = None if highest_frequency is None else task.highest(highest_frequency)
    solution = task.search(conditions)
    if highest is not None:
        solution = task.below(highest, conditions, solution)
    springs = task.described(np.exp(conditions.basis @ solution.z))
    if not solution.met:
        raise NoPositiveSprings(task.refusal(), springs)
    return springs


class Matched(ExactModes):
    """Chains whose springs make their first frequencies exact; `matched` makes it.

    Parameters
    ----------
    modes : int
        How many frequencies, from the first.

    Examples
    --------
    >>> [round(weight, 4) for weight in Matched(3).hinge_weights("free-clamped", 4)]
    [0.5589, 0.7643, 0.8635, 0.5309]
    """

    rotary_inertia: ClassVar[Fraction] = Fraction(1, 12)

    def springs(self, boundary: BoundaryLike, segments: int) -> MatchedSprings:
        """Return the springs for one pair of ends and N, of the beam with L = EI = ρA = 1; solved once.

        Raises
        ------
        TypeError, ValueError
            As `match_springs`: if N exceeds 200, the chain has fewer modes, or no springs are found.
        """
        return _matched(Boundary.of(boundary).name, whole_number("segments", segments), self.modes)

    def hinge_weights(self, boundary: BoundaryLike, segments: int) -> list[float]:
        """Return the flexibility weights of the hinges, left to right, shape (hinges,)."""
        return [float(weight) for weight in 1 / self.springs(boundary, segments).stiffness_ratio]

    def piece_lengths(self, boundary: BoundaryLike, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right: hinges at the walls."""
        return hinges_at_nodes(Boundary.of(boundary), segments)


@overload
def matched(modes: int) -> Matched: ...


@overload
def matched(modes: int, *, motion: str) -> Matched | AxialMatched: ...


def matched(modes: int, *, motion: str = "bending") -> Matched | AxialMatched:
    """Return the rule that makes the first frequencies of a chain those of the beam.

        ω_n(chain) = β_n² √(EI/(ρA L⁴)),  n = 1 ... modes

    Springs are those of `match_springs` with its defaults, for chains of at most 200 segments.

    Parameters
    ----------
    modes : int
        How many, 1 to 200.
    motion : str
        "bending", "twist" or "stretch": what the springs are for.

    Returns
    -------
    Matched or AxialMatched
        To be given as `rule=`.

    Raises
    ------
    TypeError, ValueError
        If `modes` is not a whole number in 1..200, or `motion` unknown.

    References
    ----------
    As `match_springs`.

    Examples
    --------
    >>> round(matched(3).springs("clamped-free", 12).static_tip_deflection_error, 6)
    -9e-05
    """
    return AxialMatched(modes) if motion_named(motion).along else Matched(modes)


@lru_cache(maxsize=1024)
def _matched(pair: str, segments: int, modes: int) -> MatchedSprings:
    task = SpringTask.of(pair, segments, modes, "gregory", None, None)
    if task.boundary != task.pair:
        return task.described(_matched(task.pair.name, segments, modes).stiffness_ratio)
    return match_springs(pair, segments, modes)
