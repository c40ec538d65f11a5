"""A chain that twists or stretches, as arrays, beside its beam: its errors, its rule, better springs.

A piece moves as a whole, so a chain is its pieces' inertia and the springs between them; what is exact is a
wave along the axis. Hinges and weights are those of `AxialChain`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from beammodes.auditing.audit import StepVerdict, Suggestion
from beammodes.auditing.judged_pieces import SOLVED, UNKNOWN
from beammodes.auditing.row_modes import elastic_modes
from beammodes.auditing.told_audit import ToldAudit, audit_line, listed_errors, off_the_beam, told_ratios
from beammodes.chains.axial_chain import AxialChain, laid_out
from beammodes.chains.pieces import floats
from beammodes.chains.rules import RULES, Rule
from beammodes.checks import percent, whole_number
from beammodes.exact.axial_theory import axial_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd
from beammodes.problem.beam import Beam
from beammodes.problem.motions import MOTIONS
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.damping import ModalDamping, damped_eigenvalues, damped_pairs

__all__ = ["AxialAudit", "audit_axial"]

#: Relative difference up to which hinges and springs are those of a rule: files round their numbers.
_SAME = 1e-3
#: A smaller relative difference of lengths or inertias is not reported; a smaller error of mode 1 is none.
_NONE, _EXACT = 1e-6, 1e-9
#: The corrected rule with the hinges of a stub.
_CORRECTED = {0.0: "gregory", 0.5: "half_stub_corrected", 1.0: "rigid_stub_corrected"}
_MOVED, _TUNED = "gregory", "first_spring_tuned"


@dataclass(frozen=True, eq=False, repr=False)
class AxialAudit(ToldAudit):
    """What is found of a chain in twist or stretch.

    Attributes
    ----------
    boundary : AxialBoundary
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of the chain with the armature of its hinges, without damping; NaN beyond its last mode.
    errors : ndarray, shape (modes,) [-]
        Relative, against the exact beam.
    errors_with_beam_inertia : ndarray, shape (modes,) [-]
        Of the same springs between pieces of the beam; what is between is due to matter.
    damping_ratio : ndarray, shape (modes,) [-]
        Of each mode by the hinges' dampers; 1 and more does not swing.
    length_mismatch, inertia_mismatch : float [-]
        How much longer the chain is than the beam, and how much more ρIp L (in stretch ρA L) it has.
    segments : int or None
        N, where the hinges are those of a rule.
    layout : str
        Name of the rule with these hinges and springs, or "no known layout".
    order : int or None
        e ~ 1/N**order, of that rule for these ends.
    remark : str
        The layout in one sentence.
    suggestions : tuple of Suggestion
        Springs in N m/rad, in stretch in N/m.
    tolerance : float
    joint_stiffness : ndarray, shape (hinges,) [N m/rad], [N/m]
    hinge_names : tuple of str
    given, assumed : tuple of str
        Sentences on what was read from the file, and on what it does not say.
    step : StepVerdict or None
        The file's time step beside the limit that this motion alone sets.
    """

    boundary: AxialBoundary
    angular_frequency: Floats
    errors: Floats
    errors_with_beam_inertia: Floats
    damping_ratio: Floats
    length_mismatch: float
    inertia_mismatch: float
    segments: int | None
    layout: str
    order: int | None
    remark: str
    suggestions: tuple[Suggestion, ...]
    tolerance: float
    joint_stiffness: Floats
    hinge_names: tuple[str, ...]
    given: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    step: StepVerdict | None = None

    @property
    def motion(self) -> str:
        """Either "twist" or "stretch"."""
        return self.boundary.motion

    @property
    def mismatches(self) -> tuple[str, ...]:
        """Sentences on length and inertia that are not the beam's, blamed before any spring."""
        body = "inertia about the axis" if self.motion == "twist" else "mass"
        off = off_the_beam({"length": self.length_mismatch, body: self.inertia_mismatch})
        found = [f"{each}: more segments do not remove that error" for each in off]
        if off_the_beam({body: self.inertia_mismatch}):
            errors = listed_errors(self.errors_with_beam_inertia)
            found.append(
                f"between pieces of the beam the same springs give {errors}; "
                "the rest is due to mass and inertia that are not the beam's"
            )
        return tuple(found)

    @property
    def found(self) -> tuple[str, ...]:
        """Sentences on what is found: the verdict first, then what it is due to."""
        first = self._verdict(f"{self.boundary.name} chain in {self.motion}", listed_errors(self.errors))
        return (first, *self.mismatches, self.remark, *self._damping(), *self._step())

    def _damping(self) -> list[str]:
        if not (self.damping_ratio > 0).any():
            return []
        return [told_ratios(self.damping_ratio[~np.isnan(self.damping_ratio)], "joints")]

    def _step(self) -> list[str]:
        return [str(self.step)] if self.step else []

    @property
    def notes(self) -> tuple[str, ...]:
        """All that is said beside the verdict."""
        return (*self.given, *self.assumed, *self._damping(), *self._step())

    @property
    def text(self) -> str:
        """A short report: what is given, what is assumed, what is found."""
        return self._report(self.found, map(str, self.suggestions))

    def _line(self) -> str:
        return audit_line(self, f"{self.boundary} in {self.motion}, {self.layout}: chain against beam")


def audit_axial(
    beam: Beam,
    boundary: AxialBoundary,
    *,
    length: Sequence[float],
    inertia: Sequence[float],
    joint_stiffness: Sequence[float],
    armature: Sequence[float] | None = None,
    damping: Sequence[float] | None = None,
    hinge_names: Sequence[str] = (),
    modes: int = 3,
    tolerance: float = 0.01,
) -> AxialAudit:
    """Judge a chain in twist or stretch that is given as arrays, and suggest better springs.

    Parameters
    ----------
    beam : Beam
        Uniform in this motion.
    boundary : AxialBoundary
    length, inertia : sequence, shape (hinges + 1,)
        Of pieces, without the bodies of the ends. A hinge at the wall follows a piece of no length; what a
        fixed end holds may have any inertia.
    joint_stiffness, armature, damping : sequence, shape (hinges,)

    Examples
    --------
    >>> shaft = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    >>> ends = AxialBoundary.of("fixed-free")
    >>> found = audit_axial(shaft, ends, length=[0] + [0.1] * 10, inertia=[0] + [0.1] * 10,
    ...                     joint_stiffness=[10.0] * 10, modes=2)
    >>> print(found.text)
    fixed-free chain in twist does not meet 1 %: errors -4.85 %, -5.56 %
    first hinge is at the fixed end: naive, -4.9 % at N = 10, falls only as 1/N
      gregory: springs 20, 10, 10, 10, ...: errors -0.103 %, -0.923 %
      first_spring_tuned: springs 20.42, 10, 10, 10, ...: errors 0 %, -0.821 %
    """
    motion = MOTIONS[boundary.motion]
    if not motion.is_uniform(beam):
        raise ValueError(f"beam must be uniform in {motion.name} for an audit, got {beam!r}")
    springs = np.array(joint_stiffness, dtype=np.float64)
    judged = _Judged(
        beam,
        boundary,
        np.array(length, dtype=np.float64),
        np.array(inertia, dtype=np.float64),
        springs,
        np.zeros_like(springs) if armature is None else np.array(armature, dtype=np.float64),
        axial_modes(
            beam, boundary, whole_number("modes", modes, most=100), motion=motion.name
        ).angular_frequency,
    )
    errors = judged.own_errors
    if np.isnan(errors).all():
        raise ValueError(
            f"length must have pieces that springs let vibrate in {motion.name}, got a rigid chain"
        )
    if np.nanmin(1 + errors) < 1e-6 or np.nanmax(errors) > 1e6:
        raise ValueError(
            f"beam must be in the units of the chain, got {beam!r}: its frequencies in {motion.name} and the "
            "chain's are a million times apart"
        )
    drag = np.zeros_like(springs) if damping is None else np.array(damping, dtype=np.float64)
    rules = judged.rules
    names = tuple(hinge_names) or tuple(f"hinge {i + 1}" for i in range(len(springs)))
    return AxialAudit(
        boundary=boundary,
        angular_frequency=judged.exact * (1 + errors),
        errors=errors,
        errors_with_beam_inertia=judged.errors_with_beam_inertia,
        damping_ratio=judged.damping_ratio(drag),
        length_mismatch=float(judged.length.sum() / beam.length - 1),
        inertia_mismatch=judged.inertia_mismatch,
        segments=judged.likeliest[0][1] if judged.likeliest else None,
        layout=rules[0][0].name if rules else UNKNOWN,
        order=judged.order(rules[0][0]) if rules else None,
        remark=judged.remark(),
        suggestions=tuple(judged.better()),
        tolerance=tolerance,
        joint_stiffness=springs,
        hinge_names=names,
    )


#: A rule, and N.
_Found = tuple[Rule, int]


@dataclass(frozen=True, eq=False)
class _Judged:
    """The chain as given, and the exact frequencies that it should have."""

    beam: Beam
    boundary: AxialBoundary
    length: Floats
    inertia: Floats
    springs: Floats
    armature: Floats
    exact: Floats

    @cached_property
    def _numbers(self) -> tuple[float, float]:
        return MOTIONS[self.boundary.motion].mean_numbers(self.beam)

    # Frequencies, in the coordinates of the joints, after the first piece's own where it moves.

    def modes(self, springs: Floats) -> tuple[Floats, Floats]:
        """Return ω of all elastic modes, and their turns of hinges at unit modal mass, a column each."""
        left, right = self.boundary.left, self.boundary.right
        mass = self.inertia + 0.0
        mass[0] += left.inertia
        mass[-1] += right.inertia
        beyond = np.cumsum(mass[::-1])[::-1]
        first = int(left.is_fixed)
        at = np.arange(first, len(mass))
        inertia = beyond[np.maximum(at[:, None], at)]
        own = np.concatenate([[0.0], self.armature])[first:]
        stiffness = np.diag(np.concatenate([[0.0 if left.is_fixed else left.stiffness], springs])[first:])
        held = np.ones((1, len(at)))
        if not right.is_fixed:
            stiffness, held = stiffness + right.stiffness, held[:0]
        omega, x = elastic_modes(inertia + np.diag(own), stiffness, held)
        return omega, x[1 - first :]

    def errors(self, springs: Floats) -> Floats:
        """Return the relative errors of the frequencies with these springs, NaN for missing modes."""
        return self.against_exact(self.modes(springs)[0])

    def against_exact(self, omega: Floats) -> Floats:
        """Return the relative errors of frequencies, NaN for missing modes."""
        return ratios_less_one(omega, self.exact, len(self.exact))

    @cached_property
    def own_errors(self) -> Floats:
        """Errors of the chain as it is."""
        return self.errors(self.springs)

    @cached_property
    def errors_with_beam_inertia(self) -> Floats:
        """Errors of the same springs, without armature, between pieces of the beam."""
        own = self._numbers[1] * self.length
        return replace(self, inertia=own, armature=np.zeros_like(self.armature)).own_errors

    @property
    def inertia_mismatch(self) -> float:
        """The excess of inertia of the pieces that move over the beam's of that length, relative."""
        due = self._numbers[1] * self._moving_length
        return float(self._moving.sum() / due - 1) if due else 0.0

    @property
    def _held(self) -> slice:
        """The pieces that move."""
        return slice(int(self.boundary.left.is_fixed), len(self.length) - int(self.boundary.right.is_fixed))

    @property
    def _moving(self) -> Floats:
        return self.inertia[self._held]

    @property
    def _moving_length(self) -> float:
        return float(self.beam.length - self.length.sum() + self.length[self._held].sum())

    def damping_ratio(self, damping: Floats) -> Floats:
        """Return ζ of the first pairs of eigenvalues, NaN for missing modes."""
        count = len(self.exact)
        if not np.any(damping):
            return np.where(np.isnan(self.own_errors), np.nan, 0.0)
        omega, turns = self.modes(self.springs)
        nothing = np.zeros((len(omega), len(omega)))
        modal = ModalDamping(omega, (turns.T * damping) @ turns, nothing, 0.0)
        found = damped_pairs(damped_eigenvalues(omega, modal.coupling))[1][:count]
        return np.append(found, np.full(count - len(found), np.nan))

    # The rule.

    @cached_property
    def _told(self) -> tuple[AxialBoundary, list[_Found]]:
        """The ends by which a rule is told, and the rules with this chain's hinges, each with its N."""
        found = self._layouts(self.boundary)
        if found or not self.carries:
            return self.boundary, found
        # A body without a hinge of its own is on the last piece.
        left, right = (AxialEnd(math.inf) if end.is_fixed else AxialEnd() for end in self._ends)
        plain = AxialBoundary(left, right, self.boundary.motion)
        return plain, self._layouts(plain)

    @property
    def _ends(self) -> tuple[AxialEnd, AxialEnd]:
        return self.boundary.left, self.boundary.right

    @property
    def carries(self) -> bool:
        """True if an end has a spring or a body."""
        return not all(end.is_fixed or end.is_free for end in self._ends)

    def _layouts(self, boundary: AxialBoundary) -> list[_Found]:
        pieces, total = len(self.length), self.length.sum()
        found = []
        for rule in RULES.values():
            for count in range(max(1, pieces - 2), pieces + 1):
                if not rule.fits(count):
                    continue
                cut = floats(laid_out(rule, boundary, count)[0])
                if len(cut) == pieces and np.abs(self.length * count / total - cut).max() <= _SAME:
                    found.append((rule, count))
        return found

    @property
    def layouts(self) -> list[_Found]:
        """The rules that put hinges where this chain has them."""
        return self._told[1]

    @cached_property
    def rules(self) -> list[_Found]:
        """The layouts whose springs these are."""
        off = [self.departure(rule, count) for rule, count in self.layouts]
        least = min([*off, _SAME])
        return [found for found, part in zip(self.layouts, off, strict=True) if part <= least + 1e-12]

    @property
    def likeliest(self) -> list[_Found]:
        """The rules, or the layouts if the springs are of no rule."""
        return self.rules or self.layouts

    def due(self, rule: Rule, count: int) -> Floats:
        """Return a rule's springs at these hinges; some may not be positive."""
        pair = self._told[0].scaled(self._numbers[0] / self.beam.length, self._numbers[1] * self.beam.length)
        weights = floats(laid_out(rule, pair, count)[1])
        unit = self._numbers[0] * count / self.length.sum()
        return np.asarray(unit / np.where(weights == 0.0, np.nan, weights))

    def departure(self, rule: Rule, count: int) -> float:
        """Return the largest relative difference of a spring from the rule's."""
        return float(np.abs(self.springs / self.due(rule, count) - 1).max(initial=0.0))

    def order(self, rule: Rule) -> int:
        """Return the order of a rule's error between these ends: at most 2."""
        if self._told[0] is not self.boundary:
            # What half a piece beside a body would give is missing.
            return 1
        return min(rule.declared_order(self.boundary.stand_in), 2)

    # Words.

    def remark(self) -> str:
        """Return the layout in one sentence."""
        if not self.layouts:
            return f"{UNKNOWN}: hinges are not where a rule with equal segments puts them"
        rule, count = self.likeliest[0]
        said = percent(float(self.own_errors[0]), 2, rounding=SOLVED)
        where = self._where(rule)
        if self._told[0] is not self.boundary:
            where += ", the body at the end rigid with its segment"
        if not self.rules:
            return f"{where}, with springs of no rule{self._scaled()}: {UNKNOWN}, {said} at N = {count}"
        order = self.order(rule)
        falls = "falls only as 1/N" if order == 1 else f"falls as 1/N{'⁰¹²'[order]}"
        same = ", ".join(other.name for other, _ in self.rules[1:])
        told = f"{where}: {rule.name}{f' (here the same as {same})' if same else ''}"
        return f"{told}, {said} at N = {count}, {falls}"

    def _scaled(self) -> str:
        """Return what is said of springs that are a rule's times one number."""
        record = MOTIONS[self.boundary.motion]
        for rule, count in self.layouts:
            ratio = self.springs / self.due(rule, count)
            factor = float(np.median(ratio))
            if factor > 0 and np.abs(ratio / factor - 1).max() <= _SAME:
                own = factor * self._numbers[0]
                symbol, unit = record.stiffness_symbol, record.stiffness_unit
                return f", {factor:.4g} times those of {rule.name}: as of {symbol} = {own:.6g} {unit}"
        return ""

    def _where(self, rule: Rule) -> str:
        stub, (left, right) = float(rule.stub), self._ends
        if left.is_free and right.is_free:
            where = "at the middles of equal segments" if stub == 0.5 else "where equal segments meet"
            return f"hinges are {where}"
        which = "last" if left.is_free else "first"
        held = "fixed end" if (right if left.is_free else left).is_fixed else "body at that end"
        return {
            0.0: f"{which} hinge is at the {held}",
            0.5: f"half a segment is rigid with the {held}",
            1.0: f"{which} segment is rigid with the {held}",
        }[stub]

    # Suggestions.

    def better(self) -> Iterator[Suggestion]:
        """Yield what lowers the error of the first mode and of at least half of the modes."""
        for found in (each for make in (self._corrected, self._tuned, self._moved) for each in make()):
            smaller = np.abs(found.errors) < np.abs(self.own_errors)
            missing = np.isnan(found.errors) | np.isnan(self.own_errors)
            if smaller[0] and 2 * smaller.sum() >= (~missing).sum():
                yield found

    @property
    def _position(self) -> Floats:
        return np.asarray(np.cumsum(self.length)[:-1])

    def _corrected(self) -> Iterator[Suggestion]:
        if not self.likeliest or not len(self.springs):
            return
        own, count = self.likeliest[0]
        rule = RULES[_CORRECTED[float(own.stub)]]
        springs = self.due(rule, count)
        if (springs > 0).all() and self.departure(rule, count) > 1e-4:
            yield Suggestion(rule.name, False, self._position, springs, self.errors(springs))

    def _tuned(self) -> Iterator[Suggestion]:
        """Yield the springs with the one nearest the fixed end changed, if mode 1 can so be exact.

        With k + Δ instead of k the chain rings at ω where  1 + Δ H(ω) = 0, H = Σ φ_n²/(ω_n² - ω²).
        """
        if not len(self.springs) or abs(self.own_errors[0]) <= _EXACT:
            return
        at = -1 if self.boundary.right.is_fixed and not self.boundary.left.is_fixed else 0
        omega, turns = self.modes(self.springs)
        target = self.exact[0]
        receptance = float(np.sum(turns[at] ** 2 / ((omega - target) * (omega + target))))
        springs = self.springs.copy()
        springs[at] -= 1 / receptance if receptance else 0.0
        if springs[at] > 0:
            errors = self.errors(springs)
            if abs(errors[0]) < _EXACT:
                yield Suggestion(_TUNED, False, self._position, springs, errors)

    def _moved(self) -> Iterator[Suggestion]:
        """Yield the rule with hinges at the walls, or at bodies, of as many segments."""
        fits = any(rule.stub != 1 for rule, _ in self.likeliest) and self._told[0] is self.boundary
        if fits or np.any(self.armature) or not any(not end.is_free for end in self._ends):
            return
        count = self.likeliest[0][1] if self.likeliest else int(np.count_nonzero(self.length))
        chain = AxialChain(self.beam, self.boundary, count, _MOVED, motion=self.boundary.motion)
        errors = self.against_exact(solve_axial_modes(chain, len(self.exact)).angular_frequency)
        yield Suggestion(_MOVED, True, chain.hinge_position, chain.joint_stiffness, errors)
