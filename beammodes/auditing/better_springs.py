"""What to change in a chain: other springs for its hinges, or hinges elsewhere, and what each buys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.judged_pieces import Found, JudgedPieces, percent
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.problem.ends import Boundary
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

__all__ = ["MOVED", "TUNED", "Suggestion", "listed_errors", "suggestions_for"]

Array = NDArray[np.float64]

#: Names of suggestions that are no rule for the chain's own hinges.
TUNED, MOVED, HINGED = "first_spring_tuned", "gregory", "gregory with a hinge at the body"
_SAME_SPRING = 1e-4
_CORRECTED = {0.0: "gregory", 0.5: "half_stub_corrected", 1.0: "rigid_stub_corrected"}


@dataclass(frozen=True, eq=False)
class Suggestion:
    """Other springs, for the same hinges or for hinges elsewhere.

    Attributes
    ----------
    name : str
        Of the rule, or "first_spring_tuned": only the spring nearest the held end is changed, so that
        mode 1 is exact; or "gregory with a hinge at the body", which is rigid with the last segment now.
    moves_hinges : bool
        Whether the hinges are others than the chain's; if so its rods are the rule's too.
    hinge_position : ndarray, shape (hinges,) [m]
        From the left end.
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
    errors : ndarray, shape (modes,) [-]
    """

    name: str
    moves_hinges: bool
    hinge_position: Array
    joint_stiffness: Array
    errors: Array

    def __str__(self) -> str:
        few = [f"{value:.5g}" for value in self.joint_stiffness[:4]] + ["..."]
        where = ""
        if self.moves_hinges:
            places = [f"{value:.5g}" for value in self.hinge_position[:2]]
            where = f"hinges moved to {', '.join(places)}, ...: "
        springs = ", ".join(few[: len(self.joint_stiffness)])
        return f"{self.name}: {where}springs {springs}: {listed_errors(self.errors)}"


def listed_errors(errors: Array) -> str:
    """Return errors as text, those of modes that are not there as such.

    Examples
    --------
    >>> listed_errors(np.array([0.1, np.nan]))
    'errors +10 %, no such mode'
    """
    return "errors " + ", ".join("no such mode" if np.isnan(e) else percent(e) for e in errors)


def suggestions_for(judged: JudgedPieces, layouts: list[Found]) -> tuple[Suggestion, ...]:
    """Return better springs for a chain, those for the same hinges first; none that raise its first error."""
    now = judged.errors(judged.springs)
    found = (
        *_corrected(judged, layouts),
        *_tuned(judged),
        *_moved(judged, layouts),
        *_hinged_bodies(judged, layouts),
    )
    return tuple(item for item in found if _is_better(item.errors, now))


def _is_better(errors: Array, now: Array) -> bool:
    """Whether the error of the first mode is smaller, and of at least half of the modes."""
    smaller = np.abs(errors) < np.abs(now)
    missing = np.isnan(errors) | np.isnan(now)
    return bool(smaller[0] and 2 * smaller.sum() >= (~missing).sum())


def _corrected(judged: JudgedPieces, layouts: list[Found]) -> Iterator[Suggestion]:
    """Yield the springs of the corrected rule with these hinges, unless the chain has them."""
    if not layouts or not len(judged.springs):
        return
    count, rule = layouts[0][1], RULES[_CORRECTED[float(layouts[0][0].stub)]]
    weights = np.array(rule.hinge_weights(judged.rule_boundary, count), dtype=np.float64)
    if weights.min() <= 0 or judged.departure(rule, count) <= _SAME_SPRING:
        return
    springs = judged.unit(count) / weights
    yield Suggestion(rule.name, False, judged.hinge_position, springs, judged.errors(springs))


def _tuned(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield the springs with the first one from the held end changed, if mode 1 can so be exact."""
    if not len(judged.springs) or abs(judged.errors(judged.springs, 1)[0]) <= 1e-9:
        return
    at = -1 if judged.bends == (False, True) else 0
    few = len(judged.springs) <= MAX_DENSE and not np.any(judged.armature)
    stiffness = _by_all_modes(judged, at) if few else _by_search(judged, at)
    if stiffness > 0:
        springs = judged.springs.copy()
        springs[at] = stiffness
        errors = judged.errors(springs)
        if abs(errors[0]) < 1e-9:
            yield Suggestion(TUNED, False, judged.hinge_position, springs, errors)


def _by_all_modes(judged: JudgedPieces, at: int) -> float:
    """Return the stiffness of one hinge that makes mode 1 exact, by the hinge's receptance.

    A moment M across the hinge turns it by  H(ω) M,  H = Σ φ_n²/(ω_n² - ω²)  over all modes of unit mass;
    with k + Δ instead of k the chain rings at ω where  1 + Δ H(ω) = 0.
    """
    chain = judged.chain(judged.springs)
    if chain.pieces - 1 != len(judged.springs):
        # A spring in series with a support is no hinge of its own.
        return _by_search(judged, at)
    modes = solve_modes(linearize(chain))
    turns = np.diff(modes.rotation, axis=1)[:, at]
    target = judged.exact[0]
    below = modes.angular_frequency - target
    receptance = float(np.sum(turns**2 / (below * (modes.angular_frequency + target))))
    return float(judged.springs[at]) - 1 / receptance if receptance else 0.0


def _by_search(judged: JudgedPieces, at: int) -> float:
    """Return the same for long chains, whose lowest mode alone is cheap; 0 if there is none."""
    from scipy.optimize import brentq

    def error(log: float) -> float:
        springs = judged.springs.copy()
        springs[at] *= np.exp(log)
        return float(judged.errors(springs, 1)[0])

    start = error(0.0)
    # A stiffer spring raises every frequency.
    ends = (-np.sign(start) * step for step in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0))
    end = next((log for log in ends if start * error(log) < 0), None)
    return 0.0 if end is None else float(judged.springs[at] * np.exp(brentq(error, 0.0, end, xtol=1e-14)))


def _moved(judged: JudgedPieces, layouts: list[Found]) -> Iterator[Suggestion]:
    """Yield the rule with hinges at the walls, of as many rods, unless the hinges are there already."""
    stubless = any(rule.stub == 0 for rule, _ in layouts)
    # What armature would cost at other hinges is not known.
    if (layouts and stubless) or not any(judged.bends) or np.any(judged.armature):
        return
    yield from _by_rule(judged, layouts, judged.rule_boundary, MOVED)


def _hinged_bodies(judged: JudgedPieces, layouts: list[Found]) -> Iterator[Suggestion]:
    """Yield the rule with a hinge between the beam and each body that is rigid with the last segment."""
    ends = (judged.rule_boundary.left, judged.rule_boundary.right)
    if any(end.statics == "carried" for end in ends) and not np.any(judged.armature):
        boundary = Boundary(*(replace(end, on_segment=False) for end in ends))
        yield from _by_rule(judged, layouts, boundary, HINGED)


def _by_rule(
    judged: JudgedPieces, layouts: list[Found], boundary: Boundary, name: str
) -> Iterator[Suggestion]:
    rods = int(np.count_nonzero(judged.length))
    try:
        chain = Chain(judged.beam, boundary, layouts[0][1] if layouts else rods, MOVED)
    except ValueError:
        # Too few rods for the rule's springs to be positive.
        return
    errors = np.full(len(judged.exact), np.nan)
    found = solve_modes(linearize(chain), len(errors)).angular_frequency
    errors[: len(found)] = found / judged.exact[: len(found)] - 1
    yield Suggestion(name, True, chain.hinge_position, chain.joint_stiffness, errors)
