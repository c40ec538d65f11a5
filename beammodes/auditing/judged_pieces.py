"""A chain beside the beam that it stands for: its frequencies and damping, and the rule that it follows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import FileStep
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Number, piece_numbers
from beammodes.chains.rules import RULES, Rule
from beammodes.checks import percent, shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.problem.profiles import mean_over
from beammodes.vibration.damping import Damping, ModalDamping, damped_eigenvalues, damped_pairs
from beammodes.vibration.integrators import fixed_step_integrator
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes
from beammodes.vibration.stability import modal_time_step, stable_time_step, taut_load

__all__ = ["SOLVED", "UNKNOWN", "Columns", "JudgedPieces", "longest_step"]

#: The name of a layout whose hinges or springs are those of no rule.
UNKNOWN = "no known layout"

Columns = Sequence[Number] | Floats
#: A rule, and N.
Found = tuple[Rule, int]

#: Relative difference up to which hinges, springs and rods are those of a rule: files round their numbers.
_SAME = 1e-3
#: Largest difference of J/(m l²) from that of masses at two tips where these are meant.
_KIND = 0.01
#: Of pieces unlike most as many are named.
_NAMED = 3
#: Less is the rounding of numbers in files, and of frequencies that are solved for.
_ROUNDING, SOLVED = 1e-5, 1e-10


#: The corrected rule with the hinges of a stub.
_CORRECTED = {0.0: "gregory", 0.5: "half_stub_corrected", 1.0: "rigid_stub_corrected"}
#: Springs where the wall holds the first segment, while the body at the other end has a hinge of its own. Of
#: such a wall the beam feels what it feels of a heavy body on its segment.
_CLAMP = End(mass=1.0, rotary_inertia=1.0, on_segment=True)
_WELDED = (
    Rule("rigid_stub", ["1"], guided=["1"]),
    Rule("rigid_stub_corrected", RULES["gregory"].clamped, carried=RULES["rigid_stub_corrected"].clamped),
)
#: The corrected rules with other springs where a body is part of the last segment, which suit a body whose
#: rotary inertia counts, and the rule whose springs these are.
_AT_BODIES = {
    name: Rule(
        f"{name} with springs for the body",
        RULES[name].clamped,
        guided=RULES[name].guided,
        carried=RULES[springs].clamped,
        stub=RULES[name].stub,
    )
    for name, springs in {
        "gregory": "rigid_stub_corrected",
        "rigid_stub_corrected": "rigid_stub_corrected",
        "half_stub_corrected": "half_stub_corrected",
    }.items()
}


# A chain with the armature a and the dampers d of its hinges. In undamped modes of unit modal mass hinges
# turn by  r = R p, so
#
#     (1 + Rᵀ a R) p'' + Rᵀ d R p' + Ω² p = 0.
#
# Rigid-body motions turn no hinge, so they take no part.


def _with_armature(
    chain: Chain, armature: Floats, damping: Floats | None = None, load: Load | None = None
) -> ModalDamping:
    """Return a chain's modes with the armature and the damping of its hinges.

    Of hinges as given: one that is in series with a support's spring must have neither. A load must leave the
    chain straight.
    """
    if len(armature) > MAX_DENSE:
        raise ValueError(f"armature must be 0 in chains of more than {MAX_DENSE} hinges, got {len(armature)}")
    modes = solve_modes(linearize(chain, load=load))
    turns, omega = np.diff(modes.rotation, axis=1), modes.angular_frequency
    own, drag = (_of_coordinates(chain, column) for column in (armature, damping))
    if np.any(own):
        # The compliance keeps the digits of the lowest modes.
        scaled = turns / omega[:, None]
        square, shapes = np.linalg.eigh(np.diag(1 / omega**2) + (scaled * own) @ scaled.T)
        new = 1 / np.sqrt(square[::-1])
        turns, omega = (shapes[:, ::-1] / omega[:, None] * new).T @ turns, new
    return ModalDamping(omega, (turns * drag) @ turns.T, np.zeros((len(omega), len(omega))), 0.0)


def _of_coordinates(chain: Chain, column: Floats | None) -> Floats:
    """Return a chain's numbers of its hinges; refuse any if a hinge is in series with a support's spring."""
    count = chain.pieces - 1
    if column is None or not np.any(column):
        return np.zeros(count)
    if len(column) != count:
        raise ValueError(
            "armature and damping must be 0 at the hinges of a chain where one is in series with a "
            "support's spring"
        )
    return column


def longest_step(chain: Chain, armature: Floats, damping: Floats, step: FileStep, load: Load) -> float:
    """Return the longest stable step of a file's integrator for this chain under its load [s].

    It is that of `stable_time_step`, with the armature in the modes: of a load that bends or pushes the chain
    a lower bound.
    """
    if not np.any(armature):
        own = _of_coordinates(chain, damping)
        dampers = Damping(joint=tuple(own.tolist())) if own.any() else None
        return stable_time_step(chain, step.record, load=load, damping=dampers)
    record = fixed_step_integrator(step.record)
    if record.springs == "implicit":
        return math.inf
    return modal_time_step(record, _with_armature(chain, armature, damping, taut_load(chain, load)))


@dataclass(frozen=True, eq=False)
class JudgedPieces:
    """The chain as given, and the exact frequencies that it should have."""

    beam: Beam
    boundary: Boundary
    pieces: dict[str, Any]
    springs: Floats
    exact: Floats
    armature: Floats
    damping: Floats

    @classmethod
    def of(
        cls,
        beam: Beam,
        boundary: Boundary,
        given: dict[str, Columns],
        springs: Columns,
        modes: int,
        armature: Columns | None = None,
        damping: Columns | None = None,
    ) -> JudgedPieces:
        """Return the chain of given arrays beside its beam; raise as `audit_chain`."""
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
        own = [_of_hinges(*column, stiffness) for column in (("armature", armature), ("damping", damping))]
        return cls(beam, boundary, pieces, stiffness, exact, *own)

    @cached_property
    def length(self) -> Floats:
        """Length of each piece [m]."""
        return np.array(self.pieces["length"], dtype=np.float64)

    @cached_property
    def mass(self) -> Floats:
        """Mass of each piece [kg]."""
        return np.array(self.pieces["mass"], dtype=np.float64)

    @cached_property
    def _inertia(self) -> Floats:
        return np.array(self.pieces["rotary_inertia"], dtype=np.float64)

    @property
    def hinge_position(self) -> Floats:
        """Distance of each hinge from the left end [m]."""
        return np.asarray(np.cumsum(self.length)[:-1])

    @property
    def bends(self) -> tuple[bool, bool]:
        """True for the left and for the right end if it can bend the beam."""
        left, right = (
            end.statics in ("clamped", "guided")
            for end in (self.rule_boundary.left, self.rule_boundary.right)
        )
        return left, right

    # Frequencies.

    def chain(self, springs: Floats) -> Chain:
        """Return the chain with these springs."""
        return Chain.from_pieces(**self.pieces, joint_stiffness=springs, boundary=self.boundary)

    def errors(self, springs: Floats, modes: int | None = None) -> Floats:
        """Return the relative errors of the frequencies with these springs, NaN for missing modes."""
        chain = self.chain(springs)
        if np.any(self.armature):
            return self.against_exact(_with_armature(chain, self.armature).angular_frequency)
        return self.against_exact(solve_modes(linearize(chain), modes or len(self.exact)).angular_frequency)

    def against_exact(self, omega: Floats) -> Floats:
        """Return the relative errors of frequencies, NaN for missing modes."""
        return ratios_less_one(omega, self.exact, len(self.exact))

    @cached_property
    def own_errors(self) -> Floats:
        """Errors of the chain as it is."""
        return self.errors(self.springs)

    @cached_property
    def errors_without_armature(self) -> Floats:
        """Errors of the chain with its springs, if its hinges had no inertia of their own."""
        if not np.any(self.armature):
            return self.own_errors
        return replace(self, armature=np.zeros_like(self.armature)).errors(self.springs)

    @cached_property
    def errors_with_rods(self) -> Floats:
        """Errors of the same springs, without armature, between rods that are pieces of the beam."""
        mass = self.beam.mean_mass_per_length * self.length
        inertia = self._rod_ratio * mass * self.length**2 + self._section * self.length
        # Only an outer piece may be massless: a rule's hinge at a wall, or a body of no length.
        rods = {"length": self.length, "mass": mass, "rotary_inertia": inertia}
        return replace(self, pieces=rods, armature=np.zeros_like(self.armature)).errors(self.springs)

    @cached_property
    def damping_ratio(self) -> Floats:
        """ζ of the first pairs of eigenvalues, by size; 1 and more does not swing; NaN for missing modes."""
        if not np.any(self.damping):
            return np.where(np.isnan(self.own_errors), np.nan, 0.0)
        chain, count = self.chain(self.springs), len(self.exact)
        if len(self.damping) <= MAX_DENSE:
            modal = _with_armature(chain, self.armature, self.damping)
            found = damped_pairs(damped_eigenvalues(modal.angular_frequency, modal.coupling))[1][:count]
        else:
            # All modes of a long chain are too many: each mode by itself, as light damping leaves it.
            modes = solve_modes(linearize(chain), count)
            turns = np.diff(modes.rotation, axis=1) ** 2
            found = turns @ _of_coordinates(chain, self.damping) / (2 * modes.angular_frequency)
        return np.append(found, np.full(count - len(found), np.nan))

    # The rule.

    @cached_property
    def _told(self) -> tuple[Boundary, list[Found]]:
        """The ends by which a rule is told, and the rules with this chain's hinges, each with its N."""
        ends = (self.boundary.left, self.boundary.right)
        # A body without a hinge of its own is on the last segment.
        carried = Boundary(*(end if end.holds_rotation else replace(end, on_segment=True) for end in ends))
        for boundary in (self.boundary, carried):
            bodies = any(end.statics == "carried" for end in (boundary.left, boundary.right))
            found = self._layouts(boundary, [*RULES.values(), *(_AT_BODIES.values() if bodies else ())])
            if found:
                return boundary, found
        clamps = [end.statics == "clamped" and end.holds_rotation for end in ends]
        welded = Boundary(*(_CLAMP if clamp else end for end, clamp in zip(ends, clamps, strict=True)))
        found = self._layouts(welded, _WELDED) if any(clamps) and not all(clamps) else []
        return (welded, found) if found else (carried, [])

    @property
    def is_welded(self) -> bool:
        """True if a wall holds a whole segment, and the body at the other end has a hinge of its own."""
        return any(found is rule for found, _ in self.layouts for rule in _WELDED)

    @property
    def rule_boundary(self) -> Boundary:
        """The ends of a chain of these rods by a rule."""
        return self.boundary if self.is_welded else self._told[0]

    @property
    def layouts(self) -> list[Found]:
        """The rules that put hinges where this chain has them, each with its N."""
        return self._told[1]

    def corrected(self) -> list[Found]:
        """Return the corrected rules with this chain's hinges, and N."""
        if not self.likeliest:
            return []
        own, count = self.likeliest[0]
        name = _CORRECTED[float(own.stub)]
        rules = [_WELDED[1] if self.is_welded else RULES[name]]
        return [(rule, count) for rule in [*rules, *([_AT_BODIES[name]] if self._carries else [])]]

    @property
    def _carries(self) -> bool:
        """True if a body is part of an outer segment."""
        ends = (self.rule_boundary.left, self.rule_boundary.right)
        return any(end.statics == "carried" for end in ends)

    def weights(self, rule: Rule, count: int) -> Floats:
        """Return a rule's flexibility weights of this chain's hinges."""
        return np.array(rule.hinge_weights(self._told[0], count), dtype=np.float64)

    def _layouts(self, boundary: Boundary, rules: Iterable[Rule]) -> list[Found]:
        pieces, total = len(self.length), self.length.sum()
        found = []
        for rule in rules:
            for count in range(max(1, pieces - 2), pieces + 1):
                cut = np.array(rule.piece_lengths(boundary, count), dtype=np.float64)
                if (
                    len(cut) == pieces
                    and rule.fits(count)
                    and np.abs(self.length * count / total - cut).max() <= _SAME
                ):
                    found.append((rule, count))
        return found

    @cached_property
    def rules(self) -> list[Found]:
        """The layouts whose springs these are; of several, those with the same rods."""
        off = [self.departure(rule, count) for rule, count in self.layouts]
        least = min([*off, _SAME])
        rules = [found for found, part in zip(self.layouts, off, strict=True) if part <= least + 1e-12]
        # Rules that differ in the rods' rotary inertia only: the one whose rods are nearer.
        nearer = [found for found in rules if float(found[0].rotary_inertia) == self._rod_ratio]
        return (nearer if self._is_uniform else []) or rules

    @property
    def likeliest(self) -> list[Found]:
        """The rules, or the layouts if the springs are of no rule."""
        return self.rules or self.layouts

    def departure(self, rule: Rule, count: int) -> float:
        """Return the largest relative difference of a spring from the rule's."""
        off = self.springs * self.weights(rule, count) / self.unit(count) - 1
        return float(np.abs(off).max(initial=0.0))

    def unit(self, count: int) -> float:
        """Return EI/ell."""
        return float(self.beam.mean_bending_stiffness * count / self.length.sum())

    def order(self, rule: Rule) -> int:
        """Return the order of a rule's error for this beam, its ends and these pieces' rotary inertia.

        What a section has of rotary inertia beyond the beam's does not change with N: the error falls with
        the rule's order down to what that costs. Other rotary inertia than a rod's is an error of order 2.
        """
        declared = rule.declared_order(self._told[0])
        kept = self._is_uniform and self._has_section and not self.beam.has_rotary_inertia
        return declared if kept else min(declared, 2)

    # Matter of the pieces that turn: held pieces do not move, so their mass does not count.

    @cached_property
    def _moving(self) -> NDArray[np.bool_]:
        moves = self.length > 0
        moves[0] &= not self.boundary.left.holds_rotation
        moves[-1] &= not self.boundary.right.holds_rotation
        return np.asarray(moves)

    @property
    def beam_mass(self) -> float:
        """Mass of the pieces, but for what is held and has no length: that is none of the beam [kg]."""
        counts = self.length > 0
        counts[0] |= not self.boundary.left.holds_deflection
        counts[-1] |= not self.boundary.right.holds_deflection
        return float(self.mass[counts].sum())

    @cached_property
    def _section(self) -> float:
        """The beam's own rotary inertia per length [kg m]."""
        return mean_over(self.beam.rotary_inertia_per_length, self.beam.length)

    @cached_property
    def _scale(self) -> Floats:
        """m l²."""
        return self.mass[self._moving] * self.length[self._moving] ** 2

    @cached_property
    def _gyration(self) -> Floats:
        """J/(m l²), without what the beam's section has."""
        own = self._inertia[self._moving] - self._section * self.length[self._moving]
        return np.asarray(own / self._scale)

    @cached_property
    def _rod_ratio(self) -> float:
        """J/(m l²) of the kind of rods that is meant: 1/12 of slender rods, 1/4 of masses at two tips."""
        kinds = {float(rule.rotary_inertia) for rule in RULES.values()}
        middle = float(np.median(self._gyration)) if len(self._gyration) else 1 / 12
        # Anything else is a slender rod with a section, which comes by any number where segments are short.
        return next((kind for kind in kinds if abs(kind - middle) < _KIND), min(kinds))

    @cached_property
    def rotary_inertia_mismatch(self) -> float:
        """The excess of rotary inertia over that of rods of the same mass, relative."""
        due = self._rod_ratio * self._scale.sum() + self._section * self.length[self._moving].sum()
        return float(self._inertia[self._moving].sum() / due - 1) if due else 0.0

    @cached_property
    def centre_mismatch(self) -> float:
        """The largest distance of a centre of mass from its piece's middle, in the piece's length."""
        on, centre = self._moving, np.array(self.pieces.get("centre", self.length / 2), dtype=np.float64)
        return float(np.abs(centre[on] / self.length[on] - 0.5).max(initial=0.0))

    @cached_property
    def share_mismatch(self) -> float:
        """The largest relative difference of a piece's mass from its share by length."""
        mass, length = self.mass[self._moving], self.length[self._moving]
        share = mass.sum() / length.sum() * length if len(length) else length
        return float(np.abs(mass / share - 1).max(initial=0.0))

    @property
    def _is_uniform(self) -> bool:
        """True if the mass is that of a uniform beam, each piece's centre of mass at its middle."""
        return self.share_mismatch <= _SAME and self.centre_mismatch <= _SAME

    @cached_property
    def _rest(self) -> Floats:
        """Square of the radius of gyration that is left beyond a rod's [m²]."""
        return np.asarray((self._gyration - self._rod_ratio) * self.length[self._moving] ** 2)

    @cached_property
    def _has_section(self) -> bool:
        """True if all pieces have the rotary inertia of rods, with the same positive rest per mass if any."""
        rest, rounding = self._rest, _SAME * self._rod_ratio * self.length[self._moving] ** 2
        even = (
            np.abs(rest - np.median(rest)) <= rounding + _SAME * abs(np.median(rest)) if len(rest) else rest
        )
        return bool((rest >= -rounding).all() and even.all())

    # Words.

    def remark(self) -> str:
        """Return the layout in one sentence."""
        if not self.layouts:
            odd = self._odd_ones(self.length[self.length > 0], "{:.6g} m long, most others {:.6g} m")
            return f"{UNKNOWN}: hinges are not where a rule with equal segments puts them{odd}"
        rules, error = self.rules, float(self.own_errors[0])
        rule, count = self.likeliest[0]
        where, said = self._where(rule), percent(error, 2, rounding=SOLVED)
        if not rules:
            return f"{where}, with springs of no rule{self._scaled()}: {UNKNOWN}, {said} at N = {count}"
        order = self.order(rule)
        falls = "falls only as 1/N" if order == 1 else f"falls as 1/N{'⁰¹²³⁴⁵⁶⁷⁸⁹'[order]}"
        same = ", ".join(other.name for other, _ in rules[1:])
        text = f"{where}: {rule.name}{f' (here the same as {same})' if same else ''}"
        return f"{text}, {said} at N = {count}, {falls}{self._down_to(rule, error)}"

    def _scaled(self) -> str:
        """Return what is said of springs that are a rule's times one number."""
        for rule, count in self.layouts if len(self.springs) > 1 else ():
            ratio = self.springs * self.weights(rule, count) / self.unit(count)
            factor = float(np.median(ratio))
            if factor > 0 and np.abs(ratio / factor - 1).max() <= _SAME:
                own = factor * self.beam.mean_bending_stiffness
                degrees = ""
                if abs(math.degrees(factor) - 1) <= _KIND:
                    degrees = " (π/180 times: as of springs given per degree, not per radian)"
                if abs(math.radians(factor) - 1) <= _KIND:
                    degrees = " (180/π times: as of springs turned from degrees twice)"
                return f", {factor:.4g} times those of {rule.name}{degrees}: as of EI = {own:.6g}"
        return ""

    def _down_to(self, rule: Rule, error: float) -> str:
        if not self._is_uniform:
            return " with uniform pieces, which these are not"
        if self.order(rule) == 1:
            return ""
        if np.any(self.armature):
            return " without the armature"
        if not self._has_section:
            return " with rods of a rod's rotary inertia, which these are not"
        if self.rotary_inertia_mismatch > _ROUNDING:
            cost = percent(error - float(self.errors_with_rods[0]), 2, rounding=SOLVED)
            return f" down to the {cost} of the rods' own rotary inertia"
        return ""

    def _where(self, rule: Rule) -> str:
        ends = {"first": self.rule_boundary.left, "last": self.rule_boundary.right}
        bodies = [
            f", a body is part of the {which} segment"
            for which, end in ends.items()
            if end.statics == "carried"
        ]
        return "".join([self._where_hinges_are(rule), *bodies])

    def _where_hinges_are(self, rule: Rule) -> str:
        stub = float(rule.stub)
        left, right = self.bends
        if self.is_welded:
            first, last = ("first", "last") if self.boundary.left.holds_rotation else ("last", "first")
            return f"{first} segment is rigid with its parent, {last} hinge is at the body at that end"
        if not (left or right):
            middle = "at the middles of equal segments" if stub == 0.5 else "where equal segments meet"
            return f"hinges are {middle}"
        end = self.rule_boundary.left if left else self.rule_boundary.right
        which = "first" if left or end.holds_rotation else "last"
        carrier = "its parent" if end.holds_rotation else "the body at that end"
        return {
            0.0: f"{which} hinge is at the {'held end' if end.holds_rotation else 'body at that end'}",
            0.5: f"half a segment is rigid with {carrier}",
            1.0: f"{which} segment is rigid with {carrier}",
        }[stub]

    def mismatches(self) -> list[str]:
        """Return what is said of matter that is not the beam's, and what it costs."""
        found = []
        meant = {float(rule.rotary_inertia) for rule, _ in self.rules}
        if self._rod_ratio > 1 / 6 and self._rod_ratio not in meant:
            times = 12 * self._rod_ratio
            found.append(
                f"rotary inertia of the segments is that of masses at their tips, {times:.3g} times a rod's"
            )
        if abs(self.rotary_inertia_mismatch) > _SAME or not self._has_section:
            rods = "slender rods" if self._rod_ratio < 1 / 6 else "masses at their tips"
            explained = self._has_section and self.rotary_inertia_mismatch >= 0
            why = "which no section explains"
            if explained:
                radius = math.sqrt(np.median(self._rest))
                why = f"as of a section with a radius of gyration of {radius:.3g} m"
            off = f"{percent(self.rotary_inertia_mismatch)} off that of {rods}"
            found.append(f"rotary inertia of the segments is {off}, {why}")
        if self.centre_mismatch > _SAME:
            part = f"{100 * self.centre_mismatch:.3g} % of a segment's length"
            off = f"centres of mass are up to {part} off the segments' middles"
            found.append(f"{off}{self._centres_beyond()}")
        if self.share_mismatch > _SAME:
            part = f"{100 * self.share_mismatch:.3g} %"
            spread = self.mass[self.length > 0] / self.length[self.length > 0]
            odd = self._odd_ones(spread, "of {:.6g} kg/m, most others of {:.6g} kg/m")
            found.append(f"masses of segments are up to {part} off their shares by length{odd}")
        return found

    def _centres_beyond(self) -> str:
        """Return what is said of pieces that are one segment before or past where their hinges have them."""
        if "centre" not in self.pieces:
            return ""
        on, centre = self._moving, np.array(self.pieces["centre"], dtype=np.float64)
        place = centre[on] / self.length[on] - 0.5
        if np.abs(np.abs(place) - 1).max(initial=0.0) > _KIND or np.ptp(np.sign(place)):
            return ""
        return (
            ": each body lies on the other side of its hinge, so the hinges stand at the far end of their "
            "segments (a body's hinge belongs at the end towards its parent)"
        )

    def _odd_ones(self, values: Floats, said: str) -> str:
        """Return which pieces have another number than most, if few have."""
        usual = float(np.median(values))
        odd = np.flatnonzero(np.abs(values / usual - 1) > _SAME) if usual > 0 else np.arange(0)
        if not 0 < len(odd) <= len(values) / 4:
            return ""
        one, rest = said.split(", ")
        named = [
            f"segment {i + 1} {'is ' if i == odd[0] else ''}{one.format(values[i])}" for i in odd[:_NAMED]
        ]
        return f": {', '.join([*named, rest.format(usual)])}"


def _of_hinges(name: str, values: Columns | None, springs: Floats) -> Floats:
    if values is None:
        return np.zeros_like(springs)
    found = np.array(piece_numbers(name, values), dtype=np.float64)
    if found.shape != springs.shape or (found < 0).any():
        raise ValueError(
            f"{name} must have {len(springs)} numbers of at least 0, one for each hinge, got {shown(values)}"
        )
    return found
