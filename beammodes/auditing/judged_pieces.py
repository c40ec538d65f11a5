"""A chain beside the beam that it stands for: its errors, and the rules whose hinges and springs it has."""

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
from beammodes.checks import shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.profiles import mean_over
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["UNKNOWN", "Found", "JudgedPieces", "percent"]

#: What an audit calls a chain whose hinges or springs are those of no rule.
UNKNOWN = "no known layout"

Array = NDArray[np.float64]
Columns = Sequence[Number] | Array
#: A rule, and N.
Found = tuple[Rule, int]

#: Relative differences up to which hinges, springs and rods are those of a rule: files round their numbers.
_SAME_CUT, _SAME_SPRING, _SAME_ROD = 1e-3, 1e-3, 1e-3
_WHERE = {
    0.0: "first hinge is at the held end",
    0.5: "half a segment is rigid with its parent",
    1.0: "first segment is rigid with its parent",
}


def percent(error: float, digits: int = 3) -> str:
    """Return a relative error as text.

    Examples
    --------
    >>> percent(0.1114, 2), percent(-1e-12)
    ('+11 %', '+0 %')
    """
    # What is smaller is rounding.
    return f"{100 * error if abs(error) > 1e-10 else 0.0:+.{digits}g} %"


@dataclass(frozen=True, eq=False)
class JudgedPieces:
    """The chain as given, and the exact frequencies that it should have."""

    beam: Beam
    boundary: Boundary
    pieces: dict[str, Any]
    springs: Array
    exact: Array

    @classmethod
    def of(
        cls, beam: Beam, boundary: Boundary, given: dict[str, Columns], springs: Columns, modes: int
    ) -> JudgedPieces:
        """Return the chain of given arrays beside its beam; raises as `audit_chain`."""
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
        """Of each piece [m]."""
        return np.array(self.pieces["length"], dtype=np.float64)

    @cached_property
    def mass(self) -> Array:
        """Of each piece [kg]."""
        return np.array(self.pieces["mass"], dtype=np.float64)

    @property
    def hinge_position(self) -> Array:
        """Distance of each hinge from the left end [m]."""
        return np.asarray(np.cumsum(self.length)[:-1])

    @property
    def bends(self) -> tuple[bool, bool]:
        """Whether the left and the right end can bend the beam."""
        left, right = (
            end.statics in ("clamped", "guided") for end in (self.boundary.left, self.boundary.right)
        )
        return left, right

    def chain(self, springs: Array) -> Chain:
        """Return the chain with these springs."""
        return Chain.from_pieces(**self.pieces, joint_stiffness=springs, boundary=self.boundary)

    def errors(self, springs: Array, modes: int | None = None) -> Array:
        """Return the relative errors of the frequencies with these springs, NaN for missing modes."""
        found = solve_modes(linearize(self.chain(springs)), modes or len(self.exact)).angular_frequency
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
        off = [self.departure(rule, count) for rule, count in layouts]
        least = min([*off, _SAME_SPRING])
        rules = [found for found, part in zip(layouts, off, strict=True) if part <= least + 1e-12]
        return [found for found in rules if self._has_rods_of(found[0])] or rules

    def departure(self, rule: Rule, count: int) -> float:
        """Return the largest relative difference of a spring from the rule's."""
        weights = np.array(rule.hinge_weights(self.boundary, count), dtype=np.float64)
        return float(np.abs(self.springs * weights / self.unit(count) - 1).max(initial=0.0))

    def unit(self, count: int) -> float:
        """EI/ell."""
        return float(self.beam.mean_bending_stiffness * count / self.length.sum())

    def _has_rods_of(self, rule: Rule) -> bool:
        """Whether pieces that move are uniform, with the rotary inertia that the rule gives them."""
        turning = float(rule.rotary_inertia) * self._share * self.length**2
        turning += mean_over(self.beam.rotary_inertia_per_length, self.beam.length) * self.length
        return self._is_uniform and self._agree(self.pieces["rotary_inertia"], turning)

    @property
    def _share(self) -> Array:
        return np.asarray(self.mass.sum() * self.length / self.length.sum())

    @property
    def _is_uniform(self) -> bool:
        """Whether the mass is that of a uniform beam, each piece's centre of mass at its middle."""
        middle = self.length / 2
        return self._agree(self.mass, self._share) and self._agree(self.pieces.get("centre", middle), middle)

    def _agree(self, own: Any, due: Array) -> bool:
        inside = slice(self.boundary.left.holds_rotation, len(due) - self.boundary.right.holds_rotation)
        given = np.array(own, dtype=np.float64)
        return np.allclose(given[inside], due[inside], rtol=0, atol=_SAME_ROD * due.max())

    def order(self, rule: Rule) -> int:
        """Return the order of a rule's error for this beam, its ends and these pieces' rotary inertia.

        Another rotary inertia than the rule's is an error of order 2 in the kinetic energy.
        """
        declared = rule.declared_order(self.boundary)
        kept = self._has_rods_of(rule) and not self.beam.has_rotary_inertia
        return declared if kept else min(declared, 2)

    def remark(self, layouts: list[Found], rules: list[Found], error: float) -> str:
        """Return the layout in one sentence."""
        if not layouts:
            return f"{UNKNOWN}: hinges are not where a rule with equal segments puts them"
        stub = float((rules or layouts)[0][0].stub)
        between = (
            f"hinges are {'at the middles of equal segments' if stub == 0.5 else 'where equal segments meet'}"
        )
        where = _WHERE[stub] if any(self.bends) else between
        if not rules:
            return f"{where}, with springs of no rule: {UNKNOWN}, {percent(error, 2)} at N = {layouts[0][1]}"
        (rule, count), order = rules[0], self.order(rules[0][0])
        falls = "falls only as 1/N" if order == 1 else f"falls as 1/N{'⁰¹²³⁴⁵⁶⁷⁸⁹'[order]}"
        same = ", ".join(other.name for other, _ in rules[1:])
        text = f"{where}: {rule.name}{f' (here the same as {same})' if same else ''}"
        rods = "" if self._is_uniform else " with uniform pieces, which these are not"
        return f"{text}, {percent(error, 2)} at N = {count}, {falls}{rods}"
