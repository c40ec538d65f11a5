"""Chains whose first frequencies are the beam's: springs solved for, and the rule that is made of them.

With few segments and a few modes that matter one can do better than a rule of the registry by giving up the
rest: every spring is solved for, in the inverse eigenvalue problem of `matching`. The springs hold for the
stated boundary only, and exactness in frequency is no exactness elsewhere (see `matched_springs`).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import ClassVar

import numpy as np

from beammodes.chains.rules import RULES
from beammodes.checks import flag, positive_real, whole_number
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.springs.matched_springs import MatchedSprings, NoPositiveSprings
from beammodes.springs.spring_task import MAX_MATCHED, SpringTask

__all__ = ["Matched", "match_springs", "matched"]


def match_springs(
    boundary: BoundaryLike,
    segments: int,
    modes: int,
    *,
    criterion: str = "gregory",
    hold_tip_stiffness: bool = False,
    highest_frequency: float | None = None,
    symmetric: bool | None = None,
    beam: Beam | None = None,
) -> MatchedSprings:
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

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or out of range, or a symmetric chain has too few springs.
    NoPositiveSprings
        A ValueError: if no springs were found; its `nearest` has the least-squares ones.

    Source
    ------
    An inverse eigenvalue problem, solved by Newton's method in ln k (see `matching`).

    Examples
    --------
    >>> springs = match_springs("clamped-free", segments=4, modes=3)
    >>> springs.stiffness_ratio.round(4)
    array([1.8835, 1.158 , 1.3084, 1.7892])
    >>> bool(abs(springs.frequency_errors).max() < 1e-12)
    True
    """
    task = SpringTask.of(boundary, segments, modes, criterion, symmetric, beam)
    conditions = task.conditions(flag("hold_tip_stiffness", hold_tip_stiffness))
    solution = task.search(conditions)
    if highest_frequency is not None:
        solution = task.below(positive_real("highest_frequency", highest_frequency), conditions, solution)
    springs = task.described(np.exp(conditions.basis @ solution.z))
    if not solution.met:
        raise NoPositiveSprings(task.refusal(), springs)
    return springs


@dataclass(frozen=True)
class Matched:
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

    modes: int
    rotary_inertia: ClassVar[Fraction] = Fraction(1, 12)

    def __post_init__(self) -> None:
        object.__setattr__(self, "modes", whole_number("modes", self.modes, most=MAX_MATCHED))

    @property
    def name(self) -> str:
        """What tables call it, such as "matched(3)"."""
        return f"matched({self.modes})"

    @property
    def exact_modes(self) -> int:
        """How many frequencies, from the first, are the beam's at every N that has them."""
        return self.modes

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
        return RULES["gregory"].piece_lengths(Boundary.of(boundary), segments)


def matched(modes: int) -> Matched:
    """Return the rule that makes the first frequencies of a chain those of the beam.

        ω_n(chain) = β_n² √(EI/(ρA L⁴)),  n = 1 ... modes

    Springs are those of `match_springs` with its defaults, for chains of at most 200 segments.

    Parameters
    ----------
    modes : int
        How many, 1 to 200.

    Raises
    ------
    TypeError, ValueError
        If `modes` is not a whole number in 1..200.

    Source
    ------
    As `match_springs`.

    Examples
    --------
    >>> round(matched(3).springs("clamped-free", 12).static_tip_deflection_error, 6)
    -9e-05
    """
    return Matched(modes)


@lru_cache(maxsize=1024)
def _matched(pair: str, segments: int, modes: int) -> MatchedSprings:
    task = SpringTask.of(pair, segments, modes, "gregory", None, None)
    if task.boundary != task.pair:
        return task.described(_matched(task.pair.name, segments, modes).stiffness_ratio)
    return match_springs(pair, segments, modes)
