"""Audits of given chains: their errors, the rule that they follow, and better springs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from beammodes.accuracy.chain_against_beam import stout_remark
from beammodes.auditing.body_tree import SpringPlace
from beammodes.auditing.judged_pieces import UNKNOWN, Columns, JudgedPieces
from beammodes.auditing.told_audit import (
    ToldAudit,
    audit_line,
    listed_errors,
    listed_parts,
    off_the_beam,
    told_ratios,
)
from beammodes.chains.chain import Chain
from beammodes.checks import Shown, shown, small_fraction
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

__all__ = ["Audit", "StepVerdict", "Suggestion", "audit_chain"]

#: Names of suggestions that are no rule for the chain's own hinges.
_TUNED, _MOVED, _HINGED = "first_spring_tuned", "gregory", "gregory with a hinge at the body"
#: Springs nearer to those of the corrected rule are its own already.
_SAME_SPRING = 1e-4
_LISTED = 8
#: An error of mode 1 that is none.
_EXACT = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Suggestion(Shown):
    """Other springs, for the same hinges or for hinges elsewhere.

    Attributes
    ----------
    name : str
        Of the rule, or "first_spring_tuned": only the spring nearest the held end is changed, so that
        mode 1 is exact; or, where a body is rigid with the last segment, of a rule "with springs for the
        body", which suit one of much rotary inertia, or "gregory with a hinge at the body".
    moves_hinges : bool
        Whether the hinges are others than the chain's; if so its rods are the rule's too.
    hinge_position : ndarray, shape (hinges,) [m]
        From the left end.
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
    errors : ndarray, shape (modes,) [-]
    """

    name: str
    moves_hinges: bool
    hinge_position: Floats
    joint_stiffness: Floats
    errors: Floats

    def _line(self) -> str:
        return f"Suggestion({self})"

    def __str__(self) -> str:
        few = [f"{value:.5g}" for value in self.joint_stiffness[:4]] + ["..."]
        where = ""
        if self.moves_hinges:
            places = [f"{value:.5g}" for value in self.hinge_position[:2]]
            where = f"hinges moved to {', '.join(places)}, ...: "
        springs = ", ".join(few[: len(self.joint_stiffness)])
        return f"{self.name}: {where}springs {springs}: {listed_errors(self.errors)}"


@dataclass(frozen=True, eq=False, repr=False)
class StepVerdict(Shown):
    """The file's time step beside the longest stable one.

    Attributes
    ----------
    timestep, limit : float [s]
    integrator : str
        As the file names it.
    with_weight : bool
        Whether the limit is that of the chain under its weight; across the chain, a lower bound of it.
    """

    timestep: float
    limit: float
    integrator: str
    with_weight: bool

    @property
    def is_stable(self) -> bool:
        """True if the file's step is below the limit."""
        return self.timestep < self.limit

    def _line(self) -> str:
        return f"StepVerdict({self})"

    def __str__(self) -> str:
        under = ", its damping and its weight" if self.with_weight else " and its damping"
        verdict = "is stable" if self.is_stable else "is NOT STABLE: the motion grows without bounds"
        return (
            f"the file's time step of {self.timestep:.6g} s with {self.integrator} {verdict}: "
            f"{self.timestep / self.limit:.3g} of the limit of {self.limit:.4g} s, of this chain's fastest "
            f"mode{under}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Audit(ToldAudit):
    """The result of `audit_chain` or `audit_file`: what is given, what is assumed, and what is found.

    Attributes
    ----------
    boundary : Boundary
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of the chain with the armature of its hinges, without damping; NaN beyond its last mode, as in
        `errors`.
    errors : ndarray, shape (modes,) [-]
        Relative, against the exact beam.
    errors_with_rods : ndarray, shape (modes,) [-]
        Of the same springs between rods that are pieces of the beam; what is between is due to matter.
    errors_without_armature : ndarray, shape (modes,) [-]
    damping_ratio : ndarray, shape (modes,) [-]
        Of each mode by the hinges' dampers; 1 and more does not swing.
    length_mismatch, mass_mismatch, rotary_inertia_mismatch : float [-]
        How much longer and heavier the chain is than the beam, and how much more rotary inertia its segments
        have than rods of their mass and length, relatively.
    centre_mismatch : float [-]
        How far centres of mass are off the segments' middles, at most, in a segment's length.
    segments : int or None
        N, where the hinges are those of a rule.
    layout : str
        Name of the rule with these hinges and springs, or "no known layout".
    order : int or None
        Of that rule for these ends: e ~ 1/N**order if the pieces are uniform, down to what the rods' own
        rotary inertia costs; at most 2 if that is no rod's and no section's.
    remark : str
        The layout in one sentence.
    matter : tuple of str
        Sentences on rotary inertia, centres of mass and shares of mass that are no beam's.
    suggestions : tuple of Suggestion
        Each lowers the error of the first mode and of at least half of the modes.
    tolerance : float
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
        Of the chain as it is.
    hinge_names : tuple of str
        As the file has them; "hinge 1" and so on for arrays.
    given : tuple of str
        Sentences on what was read from the file.
    assumed : tuple of str
        Sentences on what the file does not say and was taken for granted, and on what is left out.
    step : StepVerdict or None
        None where the file has no time step or the chain more than 500 hinges.
    weight : tuple of str
        Sentences on what the file's gravity does to the chain and to the beam; none without gravity.
    theory : str
        The error of Euler-Bernoulli theory itself on this beam, where its section is known and the chain errs
        less on the theory; else empty.
    other_readings : tuple of str
        Sentences on what else the file may mean, and what is found then.
    spring_places : tuple of SpringPlace or None
        Where the file has each spring, None where it has no number of its own; empty for arrays.
    """

    boundary: Boundary
    angular_frequency: Floats
    errors: Floats
    errors_with_rods: Floats
    errors_without_armature: Floats
    damping_ratio: Floats
    length_mismatch: float
    mass_mismatch: float
    rotary_inertia_mismatch: float
    centre_mismatch: float
    segments: int | None
    layout: str
    order: int | None
    remark: str
    matter: tuple[str, ...]
    suggestions: tuple[Suggestion, ...]
    tolerance: float
    joint_stiffness: Floats
    hinge_names: tuple[str, ...]
    given: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    step: StepVerdict | None = None
    weight: tuple[str, ...] = ()
    theory: str = ""
    other_readings: tuple[str, ...] = ()
    spring_places: tuple[SpringPlace | None, ...] = ()

    @property
    def swings(self) -> tuple[bool, ...]:
        """True for each mode that swings, and does not creep back."""
        return tuple((self.damping_ratio < 1).tolist())

    @property
    def mismatches(self) -> tuple[str, ...]:
        """Sentences on matter that is not the beam's, which is blamed before any spring."""
        off = off_the_beam({"length": self.length_mismatch, "mass": self.mass_mismatch})
        found = [f"{each}: more segments do not remove that error" for each in off]
        if self.matter or off_the_beam({"mass": self.mass_mismatch}):
            with_rods = listed_errors(self.errors_with_rods)
            found += self.matter
            found.append(
                f"with the beam's own rods the same springs give {with_rods}; "
                "the rest is due to mass and inertia that are not the beam's"
            )
        return tuple(found)

    @property
    def found(self) -> tuple[str, ...]:
        """Sentences on what is found: the verdict first, then what it is due to."""
        first = self._verdict(f"{self.boundary.name} chain", listed_errors(self.errors))
        theory = (self.theory,) if self.theory else ()
        sizes = self._sizes()
        return (first, *theory, *self.mismatches, self.remark, *sizes, *self._motion(), *self.other_readings)

    def _sizes(self) -> list[str]:
        """Say by which factors sizes set the springs of the first suggestion, where no stiffness does."""
        kept = [each for each in self.suggestions if not each.moves_hinges]
        sizes = {place.size for place in self.spring_places if place is not None}
        if not kept or len(sizes) != 1 or sizes == {""} or None in self.spring_places:
            return []
        name = sizes.pop()
        factors = (kept[0].joint_stiffness / self.joint_stiffness) ** 0.25
        listed = [f"{value:.5g}" for value in factors[:_LISTED].tolist()]
        more = [", ..."] if len(factors) > _LISTED else []
        return [f"{kept[0].name} is set by {name}: times {', '.join(listed)}{''.join(more)}"]

    @property
    def notes(self) -> tuple[str, ...]:
        """All that is said beside the verdict: what is given, assumed, found of damping, weight and step."""
        return (*self.given, *self.assumed, *self._motion(), *self.other_readings)

    def _motion(self) -> list[str]:
        lines = []
        costs = (1 + self.errors) / (1 + self.errors_without_armature) - 1
        if (costs < 0).any():
            lines.append(
                f"the armature of its hinges, which no beam has, changes the modes by {listed_parts(costs)}; "
                f"without it: {listed_errors(self.errors_without_armature)}"
            )
        if (self.damping_ratio > 0).any():
            lines.append(told_ratios(self.damping_ratio, "hinges"))
        return [*lines, *self.weight, *([str(self.step)] if self.step else [])]

    @property
    def text(self) -> str:
        """A short report: what is given, what is assumed, what is found."""
        return self._report(self.found, map(str, self.suggestions))

    @property
    def frequency(self) -> Floats:
        """ω/(2π) of the chain, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def _line(self) -> str:
        return audit_line(self, f"{self.boundary}, {self.layout}: chain against beam")


def audit_chain(
    beam: Beam,
    boundary: BoundaryLike,
    *,
    length: Columns,
    mass: Columns,
    rotary_inertia: Columns,
    joint_stiffness: Columns,
    centre: Columns | None = None,
    armature: Columns | None = None,
    damping: Columns | None = None,
    modes: int = 3,
    tolerance: float = 0.01,
) -> Audit:
    """Judge a chain that is given as arrays, name the rule that it follows, and suggest better springs.

        e = ω_chain / ω_beam - 1

    Parameters
    ----------
    beam : Beam
        The uniform beam that the chain stands for.
    boundary : str, pair or Boundary
    length, mass, rotary_inertia, joint_stiffness, centre : sequence
        Of pieces and hinges, as `Chain.from_pieces` takes them. A segment welded to a wall is a first piece,
        which the clamped end holds; a hinge at the wall follows a first piece of length zero. Bodies, springs
        and hubs of the ends belong to `boundary`, not here.
    armature : sequence, shape (hinges,) [kg m²], optional
        Inertia of each hinge's own rotation: it is added to that of the relative angle.
    damping : sequence, shape (hinges,) [N m s/rad], optional
    modes : int
        Number of modes, 1 to 100.
    tolerance : float
        Largest |e| allowed, less than 0.5: 0.01 is one percent.

    Returns
    -------
    Audit

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam is not uniform, or the pieces make no chain that vibrates.

    Examples
    --------
    >>> import beammodes as bm
    >>> ell = 0.1                                     # a cable whose first of ten segments is welded
    >>> found = bm.audit_chain(bm.Beam.unit(), "clamped-free", length=[ell] * 10, mass=[ell] * 10, modes=2,
    ...                        rotary_inertia=[ell**3 / 12] * 10, joint_stiffness=[1 / ell] * 9)
    >>> print(found.text)
    clamped-free chain does not meet 1 %: errors +11.1 %, +11.8 %
    first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N
      rigid_stub_corrected: springs 5.2174, 17.143, 10, 10, ...: errors +0.29 %, +3.42 %
      first_spring_tuned: springs 6.0949, 10, 10, 10, ...: errors 0 %, +5.23 %
      gregory: hinges moved to 0, 0.1, ...:
        springs 26.667, 8.5714, 10.435, 10, ...: errors +0.000515 %, -0.00976 %
    """
    columns = {"length": length, "mass": mass, "rotary_inertia": rotary_inertia}
    columns |= {} if centre is None else {"centre": centre}
    limit = small_fraction("tolerance", tolerance)
    pair = Boundary.of(boundary)
    judged = JudgedPieces.of(beam, pair, columns, joint_stiffness, modes, armature=armature, damping=damping)
    errors = judged.own_errors
    if (1 + errors < 1e-6).any() or (errors > 1e6).any():
        raise ValueError(
            f"beam must be in the units of the chain, got {shown(beam)}: its frequencies and the chain's are "
            "a million times apart"
        )
    rules = judged.rules
    return Audit(
        boundary=judged.boundary,
        angular_frequency=judged.exact * (1 + errors),
        errors=errors,
        errors_with_rods=judged.errors_with_rods,
        errors_without_armature=judged.errors_without_armature,
        damping_ratio=judged.damping_ratio,
        length_mismatch=float(judged.length.sum() / beam.length - 1),
        mass_mismatch=float(judged.beam_mass / (beam.mean_mass_per_length * beam.length) - 1),
        rotary_inertia_mismatch=judged.rotary_inertia_mismatch,
        centre_mismatch=judged.centre_mismatch,
        segments=judged.likeliest[0][1] if judged.likeliest else None,
        layout=rules[0][0].name if rules else UNKNOWN,
        order=judged.order(rules[0][0]) if rules else None,
        remark=judged.remark(),
        matter=tuple(judged.mismatches()),
        suggestions=tuple(_better(judged)),
        tolerance=limit,
        joint_stiffness=judged.springs,
        hinge_names=tuple(f"hinge {i + 1}" for i in range(len(judged.springs))),
        theory=stout_remark(beam, judged.boundary, errors),
    )


# Suggestions: other springs for the chain's hinges, or hinges elsewhere, and what each buys.


def _better(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield what lowers the error of the first mode and of at least half of the modes; same hinges first."""
    makers = (_corrected, _tuned, _moved, _hinged_bodies)
    for found in (suggestion for make in makers for suggestion in make(judged)):
        smaller = np.abs(found.errors) < np.abs(judged.own_errors)
        missing = np.isnan(found.errors) | np.isnan(judged.own_errors)
        if smaller[0] and 2 * smaller.sum() >= (~missing).sum():
            yield found


def _corrected(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield the springs of the corrected rule with these hinges, unless the chain has them."""
    found = []
    for rule, count in judged.corrected() if len(judged.springs) else ():
        weights = judged.weights(rule, count)
        if weights.min() > 0 and judged.departure(rule, count) > _SAME_SPRING:
            found.append(_for_same_hinges(judged, rule.name, judged.unit(count) / weights))
    # Which of two suits a body on the last segment better, its inertia tells.
    yield from sorted(found, key=lambda each: np.nan_to_num(np.abs(each.errors)).max())


def _tuned(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield the springs with the first one from the held end changed, if mode 1 can so be exact."""
    if not len(judged.springs) or abs(judged.own_errors[0]) <= _EXACT:
        return
    at = -1 if judged.bends == (False, True) else 0
    few = len(judged.springs) <= MAX_DENSE and not np.any(judged.armature)
    stiffness = _by_all_modes(judged, at) if few else _by_search(judged, at)
    if stiffness > 0:
        springs = judged.springs.copy()
        springs[at] = stiffness
        found = _for_same_hinges(judged, _TUNED, springs)
        if abs(found.errors[0]) < _EXACT:
            yield found


def _for_same_hinges(judged: JudgedPieces, name: str, springs: Floats) -> Suggestion:
    return Suggestion(name, False, judged.hinge_position, springs, judged.errors(springs))


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


def _moved(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield the rule with hinges at the walls, of as many rods, unless the hinges are there already."""
    stubless = any(rule.stub == 0 for rule, _ in judged.likeliest) and not judged.is_welded
    # What armature would cost at other hinges is not known.
    if not stubless and any(judged.bends) and not np.any(judged.armature):
        yield from _by_rule(judged, judged.rule_boundary, _MOVED)


def _hinged_bodies(judged: JudgedPieces) -> Iterator[Suggestion]:
    """Yield the rule with a hinge between the beam and each body that is rigid with the last segment."""
    ends = (judged.rule_boundary.left, judged.rule_boundary.right)
    if any(end.statics == "carried" for end in ends) and not np.any(judged.armature):
        boundary = Boundary(*(replace(end, on_segment=False) for end in ends))
        yield from _by_rule(judged, boundary, _HINGED)


def _by_rule(judged: JudgedPieces, boundary: Boundary, name: str) -> Iterator[Suggestion]:
    rods = int(np.count_nonzero(judged.length))
    count = judged.likeliest[0][1] if judged.likeliest else rods
    try:
        chain = Chain(judged.beam, boundary, count, _MOVED)
    except ValueError:
        # Too few rods for the rule's springs to be positive.
        return
    errors = judged.against_exact(solve_modes(linearize(chain), len(judged.exact)).angular_frequency)
    yield Suggestion(name, True, chain.hinge_position, chain.joint_stiffness, errors)
