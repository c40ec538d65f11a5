"""Audits of chains that somebody else made: their errors, the layout they follow, springs that are better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain, Number
from beammodes.chains.pieces import piece_numbers
from beammodes.chains.rules import RULES, Rule
from beammodes.checks import positive_real, shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.profiles import mean_over
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["UNKNOWN", "Audit", "Suggestion", "audit_chain"]

#: What an audit calls a chain whose hinges or springs are those of no rule.
UNKNOWN = "no known layout"

Array = NDArray[np.float64]
Numbers = Sequence[Number] | Array
Found = tuple[Rule, int]

_SAME_CUT, _SAME_SPRING, _SAME_ROD = 1e-6, 1e-4, 1e-3
_CORRECTED = {0.0: "gregory", 0.5: "half_stub_corrected", 1.0: "rigid_stub_corrected"}
_WHERE = {
    0.0: "first hinge is at the held end",
    0.5: "half a segment is rigid with its parent",
    1.0: "first segment is rigid with its parent",
}


@dataclass(frozen=True, eq=False)
class Suggestion:
    """Other springs for the same hinges.

    Attributes
    ----------
    name : str
        Of the rule, or "first_spring_tuned": only the spring nearest the held end is changed, so that
        mode 1 is exact.
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
    errors : ndarray, shape (modes,) [-]
    """

    name: str
    joint_stiffness: Array
    errors: Array

    def __str__(self) -> str:
        few = [f"{value:.5g}" for value in self.joint_stiffness[:4]] + ["..."]
        return f"{self.name}: springs {', '.join(few[: len(self.joint_stiffness)])}: {_listed(self.errors)}"


@dataclass(frozen=True, eq=False)
class Audit:
    """What `audit_chain` found.

    Attributes
    ----------
    boundary : Boundary
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of the chain; NaN beyond its last mode, as in `errors`.
    errors : ndarray, shape (modes,) [-]
        Relative, against the exact beam.
    length_mismatch, mass_mismatch : float [-]
        How much longer and heavier the chain is than the beam, relatively.
    segments : int or None
        N, where the hinges are those of a rule.
    layout : str
        Name of the rule with these hinges and springs, or "no known layout".
    order : int or None
        Of that rule, as declared for these ends: e ~ 1/N**order with the rule's own rods.
    remark : str
        The layout in one sentence.
    suggestions : tuple of Suggestion
    tolerance : float
    """

    boundary: Boundary
    angular_frequency: Array
    errors: Array
    length_mismatch: float
    mass_mismatch: float
    segments: int | None
    layout: str
    order: int | None
    remark: str
    suggestions: tuple[Suggestion, ...]
    tolerance: float

    @property
    def meets(self) -> bool:
        """Whether all modes exist and their errors are within the tolerance."""
        return bool((np.abs(self.errors) <= self.tolerance).all())

    @property
    def text(self) -> str:
        """A short report."""
        verdict = "meets" if self.meets else "does not meet"
        lines = [f"{self.boundary.name} chain {verdict} {100 * self.tolerance:.3g} %: {_listed(self.errors)}"]
        lines.append(self.remark)
        off = {"length": self.length_mismatch, "mass": self.mass_mismatch}
        for name, part in off.items():
            if abs(part) > _SAME_CUT:
                lines.append(
                    f"{name} is {100 * part:+.3g} % off the beam's: more segments do not remove that error"
                )
        return "\n".join(lines + [f"  {suggestion}" for suggestion in self.suggestions])


def audit_chain(
    beam: Beam,
    boundary: BoundaryLike,
    *,
    length: Numbers,
    mass: Numbers,
    rotary_inertia: Numbers,
    joint_stiffness: Numbers,
    centre: Numbers | None = None,
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
        which the clamped end holds; a hinge at the wall follows a first piece of length zero. Bodies and
        springs of the ends belong to `boundary`, not here.
    modes : int
        How many, 1 to 100.
    tolerance : float
        Largest |e| allowed: 0.01 is one percent.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam is not uniform, or the pieces make no chain that vibrates.

    Examples
    --------
    >>> ell = 0.1                                     # a cable whose first of ten segments is welded
    >>> found = audit_chain(Beam.unit(), "clamped-free", length=[ell] * 10, mass=[ell] * 10, modes=2,
    ...                     rotary_inertia=[ell**3 / 12] * 10, joint_stiffness=[1 / ell] * 9)
    >>> print(found.text)
    clamped-free chain does not meet 1 %: errors +11.1 %, +11.8 %
    first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N
      rigid_stub_corrected: springs 5.2174, 17.143, 10, 10, ...: errors +0.29 %, +3.42 %
      first_spring_tuned: springs 6.0949, 10, 10, 10, ...: errors +0 %, +5.23 %
    """
    given = {"length": length, "mass": mass, "rotary_inertia": rotary_inertia}
    given |= {} if centre is None else {"centre": centre}
    limit = positive_real("tolerance", tolerance)
    judged = _Judged.of(beam, Boundary.of(boundary), given, joint_stiffness, modes)
    layouts = judged.layouts()
    rules = judged.followed(layouts)
    errors = judged.errors(judged.springs)
    return Audit(
        boundary=judged.boundary,
        angular_frequency=judged.exact * (1 + errors),
        errors=errors,
        length_mismatch=float(judged.length.sum() / beam.length - 1),
        mass_mismatch=float(judged.mass.sum() / (beam.mean_mass_per_length * beam.length) - 1),
        segments=(rules or layouts)[0][1] if layouts else None,
        layout=rules[0][0].name if rules else UNKNOWN,
        order=judged.order(rules[0][0]) if rules else None,
        remark=judged.remark(layouts, rules, errors[0]),
        suggestions=(*judged.corrected(rules or layouts), *judged.tuned()),
        tolerance=limit,
    )


def _listed(errors: Array) -> str:
    return "errors " + ", ".join("no such mode" if np.isnan(e) else _percent(e) for e in errors)


def _percent(error: float, digits: int = 3) -> str:
    # Adding 0.0 takes the sign off a zero.
    return f"{round(100 * error, 4) + 0.0:+.{digits}g} %"


@dataclass(frozen=True, eq=False)
class _Judged:
    """The chain as given, and the exact frequencies that it should have."""

    beam: Beam
    boundary: Boundary
    pieces: dict[str, Any]
    springs: Array
    exact: Array

    @classmethod
    def of(
        cls, beam: Beam, boundary: Boundary, given: dict[str, Numbers], springs: Numbers, modes: int
    ) -> _Judged:
        if not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(beam)}")
        if not beam.is_uniform:
            raise ValueError(f"beam must be uniform for an audit, got {shown(beam)}")
        count = whole_number("modes", modes, most=100)
        pieces = {name: piece_numbers(name, values) for name, values in given.items()}
        stiffness = np.array(piece_numbers("joint_stiffness", springs), dtype=np.float64)
        chain = Chain.from_pieces(**pieces, joint_stiffness=stiffness, boundary=boundary)
        if not chain.elastic_modes:
            raise ValueError(
                "length must have pieces that springs or supports let vibrate, got a rigid chain"
            )
        exact = euler_bernoulli(beam, boundary, count).angular_frequency
        return cls(beam, boundary, pieces, stiffness, exact)

    @cached_property
    def length(self) -> Array:
        return np.array(self.pieces["length"], dtype=np.float64)

    @cached_property
    def mass(self) -> Array:
        return np.array(self.pieces["mass"], dtype=np.float64)

    @property
    def bends(self) -> tuple[bool, bool]:
        """Whether the left and the right end can bend the beam."""
        left, right = (
            end.statics in ("clamped", "guided") for end in (self.boundary.left, self.boundary.right)
        )
        return left, right

    def errors(self, springs: Array, modes: int | None = None) -> Array:
        chain = Chain.from_pieces(**self.pieces, joint_stiffness=springs, boundary=self.boundary)
        found = solve_modes(linearize(chain), modes or len(self.exact)).angular_frequency
        errors = np.full(len(self.exact), np.nan)
        errors[: len(found)] = found / self.exact[: len(found)] - 1
        return errors

    def layouts(self) -> list[Found]:
        """Return the rules that put hinges where this chain has them, each with its N."""
        pieces, total = len(self.length), self.length.sum()
        found = []
        for rule in RULES.values():
            for count in range(max(1, pieces - 2), pieces + 1):
                cut = np.array(rule.piece_lengths(self.boundary, count), dtype=np.float64)
                if len(cut) == pieces and np.abs(self.length * count / total - cut).max() <= _SAME_CUT:
                    found.append((rule, count))
        return found

    def followed(self, layouts: list[Found]) -> list[Found]:
        """Return those of the layouts whose springs these are; of several, those with the same rods."""
        off = [self._departure(rule, count) for rule, count in layouts]
        least = min([*off, _SAME_SPRING])
        rules = [found for found, part in zip(layouts, off, strict=True) if part <= least + 1e-12]
        return [found for found in rules if self._has_rods_of(found[0])] or rules

    def _departure(self, rule: Rule, count: int) -> float:
        weights = np.array(rule.hinge_weights(self.boundary, count), dtype=np.float64)
        return float(np.abs(self.springs * weights / self._unit(count) - 1).max(initial=0.0))

    def _unit(self, count: int) -> float:
        """EI/ell."""
        return float(self.beam.mean_bending_stiffness * count / self.length.sum())

    def _has_rods_of(self, rule: Rule) -> bool:
        """Whether pieces that move are uniform, with the rotary inertia that the rule gives them."""
        share = self.mass.sum() * self.length / self.length.sum()
        turning = float(rule.rotary_inertia) * share * self.length**2
        turning += mean_over(self.beam.rotary_inertia_per_length, self.beam.length) * self.length
        inertia = np.array(self.pieces["rotary_inertia"], dtype=np.float64)
        centre = np.array(self.pieces.get("centre", self.length / 2), dtype=np.float64)
        inside = slice(self.boundary.left.holds_rotation, len(share) - self.boundary.right.holds_rotation)
        pairs = ((self.mass, share), (inertia, turning), (centre, self.length / 2))
        return all(
            np.allclose(own[inside], due[inside], rtol=0, atol=_SAME_ROD * due.max()) for own, due in pairs
        )

    def order(self, rule: Rule) -> int:
        declared = rule.declared_order(self.boundary)
        return min(declared, 2) if self.beam.has_rotary_inertia else declared

    def remark(self, layouts: list[Found], rules: list[Found], error: float) -> str:
        if not layouts:
            return f"{UNKNOWN}: hinges are not where a rule with equal segments puts them"
        stub = float((rules or layouts)[0][0].stub)
        between = (
            f"hinges are {'at the middles of equal segments' if stub == 0.5 else 'where equal segments meet'}"
        )
        where = _WHERE[stub] if any(self.bends) else between
        if not rules:
            return f"{where}, with springs of no rule: {UNKNOWN}, {_percent(error, 2)} at N = {layouts[0][1]}"
        (rule, count), order = rules[0], self.order(rules[0][0])
        falls = "falls only as 1/N" if order == 1 else f"falls as 1/N{'⁰¹²³⁴⁵⁶⁷⁸⁹'[order]}"
        same = ", ".join(other.name for other, _ in rules[1:])
        text = f"{where}: {rule.name}{f' (here the same as {same})' if same else ''}"
        rods = "" if self._has_rods_of(rule) else " with the rule's rods, which these pieces are not"
        return f"{text}, {_percent(error, 2)} at N = {count}, {falls}{rods}"

    def corrected(self, layouts: list[Found]) -> list[Suggestion]:
        """Return springs of the corrected rule with these hinges, unless the chain has them."""
        if not layouts or not len(self.springs):
            return []
        count, rule = layouts[0][1], RULES[_CORRECTED[float(layouts[0][0].stub)]]
        weights = np.array(rule.hinge_weights(self.boundary, count), dtype=np.float64)
        if weights.min() <= 0 or self._departure(rule, count) <= _SAME_SPRING:
            return []
        springs = self._unit(count) / weights
        return [Suggestion(rule.name, springs, self.errors(springs))]

    def tuned(self) -> list[Suggestion]:
        """Return the springs with the first one from the held end changed, if mode 1 can so be exact."""
        from scipy.optimize import brentq

        at = -1 if self.bends == (False, True) else 0

        def changed(log: float) -> Array:
            springs = self.springs.copy()
            springs[at] *= np.exp(log)
            return springs

        def error(log: float) -> float:
            return float(self.errors(changed(log), 1)[0])

        start = error(0.0) if len(self.springs) else 0.0
        # A stiffer spring raises every frequency.
        ends = (-np.sign(start) * step for step in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0))
        end = next((log for log in ends if start * error(log) < 0), None) if abs(start) > 1e-9 else None
        if end is None:
            return []
        springs = changed(brentq(error, 0.0, end, xtol=1e-14))
        return [Suggestion("first_spring_tuned", springs, self.errors(springs))]
