"""One problem of matched springs: its arguments read and checked, its conditions, its search, its answer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.checks import choice, flag, shown, whole_number
from beammodes.exact.exact_beam import plain_modes, wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.springs.matched_springs import MatchedSprings, frozen, shape_agreement, uniform_rods
from beammodes.springs.matching import Solution, closest
from beammodes.springs.spring_conditions import Conditions, spring_state, symmetric_basis
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.spectrum import FlexibilityForm, flexibility_form
from beammodes.vibration.stability import stable_time_step

__all__ = ["MAX_MATCHED", "SpringTask"]

Array = NDArray[np.float64]

#: Longer chains are not matched: every step of the search decomposes a dense matrix, and at 200 segments
#: rule gregory already has the first three modes within 1e-8.
MAX_MATCHED = 200

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
        word = choice("criterion", criterion, _CRITERIA)
        mirrored = _mirrored(pair, wanted_modes, len(layout.hinge_stiffness), symmetric)
        unit = flexibility_form(layout)
        return cls(pair, count, wanted_modes, word, mirrored, beam or Beam.unit(), unit)

    @property
    def pair(self) -> Boundary:
        """The ends in the order in which this task's springs run."""
        return self.boundary.canonical

    def log_springs(self, rule: str) -> Array:
        """Return ln k of a rule's hinges."""
        weights = RULES[rule].hinge_weights(self.pair, self.segments)
        return np.asarray(-np.log(np.array([float(weight) for weight in weights])))

    @property
    def wanted(self) -> Array:
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
        return Conditions(self.unit, basis, tuple(range(self.modes)), target, held)

    @property
    def _tip_compliance(self) -> float:
        return _TIP_COMPLIANCE.get(self.pair.name, math.nan) * self.segments**3

    def search(self, conditions: Conditions, *first: Array) -> Solution:
        """Return the closest springs, from those given and from those of the rules that have a wall hinge."""
        wanted, *others = (
            conditions.basis.T @ springs
            for springs in (self.wanted, *map(self.log_springs, ("gregory", "naive", "double_wall")))
        )
        return closest(conditions, wanted, [*first, *others])

    def below(self, highest: float, conditions: Conditions, free: Solution) -> Solution:
        """Return `free` if its chain's highest frequency is low enough, else the closest that is."""
        own = highest / self.beam.frequency_unit
        least = float(wavenumber(self.pair, self.modes) ** 2)
        if own < least * (1 - 1e-12):
            raise ValueError(
                f"highest_frequency must be at least that of mode {self.modes}, "
                f"{least * self.beam.frequency_unit:.9g} rad/s, got {highest:.9g}"
            )
        ceiling = 2 * math.log(own / self.segments**2)
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

    def described(self, ratio: Array) -> MatchedSprings:
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
