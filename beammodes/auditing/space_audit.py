"""A row of joints in space beside its rod: bending in two planes, twist and stretch, told apart and named.

What an engine linearizes is solved in all coordinates at once. If each motion alone has these frequencies,
no motion moves another, and each is judged as a beam's: with its layout, and springs for the same joints. If
not, all modes together are judged beside the exact rod's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from beammodes.accuracy.judged_motions import StraightRod
from beammodes.auditing.audit import Audit, StepVerdict
from beammodes.auditing.axial_audit import AxialAudit
from beammodes.auditing.axial_file import axial_audit_of
from beammodes.auditing.body_tree import Model
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.hinge_order import HingeOrder, hinge_order
from beammodes.auditing.row_modes import RowModes, row_modes
from beammodes.auditing.serial_chains import are_parallel, letters_of
from beammodes.auditing.space_layout import space_layout
from beammodes.auditing.space_row import (
    FIRST_BENDING,
    SECOND_BENDING,
    STRETCH,
    TWIST,
    SpaceRow,
    chosen_row,
)
from beammodes.auditing.told_audit import ToldAudit, audit_line, listed_errors
from beammodes.checks import choice, percent, whole_number
from beammodes.exact.exact_rod import rod_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.profiles import mean_over
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodEnds
from beammodes.vibration.integrators import fixed_step_integrator
from beammodes.vibration.stability import modal_time_step

__all__ = ["InPlane", "SpatialAudit", "audit_along", "audit_in_space"]

#: Relative difference of frequencies up to which one motion does not move another.
_APART = 1e-7
#: Of 1/ω², beside the lowest mode's.
_ROUNDING = 1e-12
#: Stiffnesses that are the same.
_SAME = 1e-3
#: Places at which a rod's curvature is looked at; a turn that is none [rad].
_SAMPLES, _FLAT = 65, 1e-9
#: Fourth root of a stiffness ratio, by modes: frequencies of a rod grow as their number squared.
_STIFFER = 6
_LISTED = 5
#: Axes that are off by less than this are meant to be parallel; by less than the other, they are [degrees].
_TURNED, _NOT_TURNED = 10.0, 1e-4
#: Of a chain's reach, up to which its nodes are on a line.
_STRAIGHT = 1e-6
#: The section's axes of second bending and of bending.
_ABOUT_Y, _ABOUT_Z = 1, 2
_MOTIONS = ("bending", "second_bending", "twist", "stretch")


class InPlane(Protocol):
    """How a model is judged that bends in one plane."""

    def __call__(self, model: Model, beam: Beam, boundary: Boundary | None, chain: str) -> Audit:
        """Return the audit."""


@dataclass(frozen=True, eq=False, repr=False)
class SpatialAudit(ToldAudit):
    """What is found of a chain in space.

    Attributes
    ----------
    motions : mapping from names to audits
        "bending", "second_bending", "twist", "stretch": those that the file has and the rod tells of, each
        with its ends, layout and better springs. Empty where one motion moves another.
    angular_frequency, errors : ndarray, shape (modes,) [rad/s], [-]
        Of the judged modes together, by frequency; of `motions` of each so many as asked for.
    mode_motion : tuple of str
        Which motion each of these is, or mostly is.
    planes : mapping from "bending" and "second_bending" to "x", "y" or "z"
        Along which the file deflects in them.
    joints : str
        The order of hinges, as of `JOINT_LAWS` where it is one: "ball", "yzx", "yzx_alternating"; also
        "yz_by_turns", "uneven", and "" where hinges turn about one axis only.
    remarks : tuple of str
        Sentences on the order of hinges, on balls, and on motions that the file or the rod lacks.
    tolerance : float
    layout : str
        Where one motion moves another, the name of the rule with these nodes and springs, or "no known
        layout"; else empty, and each of `motions` has its own.
    given, assumed : tuple of str
        Sentences on what was read from the file, and on what it does not say.
    step : StepVerdict or None
        The file's time step beside that of all motions together, without its weight.
    step_set_by : str
        The motion of the chain's fastest mode.
    """

    motions: Mapping[str, Audit | AxialAudit]
    angular_frequency: Floats
    errors: Floats
    mode_motion: tuple[str, ...]
    planes: Mapping[str, str]
    joints: str
    remarks: tuple[str, ...]
    tolerance: float
    layout: str = ""
    given: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    step: StepVerdict | None = None
    step_set_by: str = ""

    @property
    def found(self) -> tuple[str, ...]:
        """Sentences on what is found: the verdict first, then each motion, then what concerns all."""
        if self.motions:
            each = "; ".join(f"{name} {listed_errors(one.errors)}" for name, one in self.motions.items())
        else:
            each = f"{listed_errors(self.errors)}, mostly {', '.join(self.mode_motion)}"
        lines = [self._verdict("chain in space", each), *self.remarks]
        lines += _of_each({name: one.found[1:] for name, one in self.motions.items()})
        return (*lines, *self._step())

    def _step(self) -> list[str]:
        return [f"{self.step}, which is {self.step_set_by}"] if self.step else []

    @property
    def notes(self) -> tuple[str, ...]:
        """All that is said beside the verdict."""
        return (*self.given, *self.assumed, *self.remarks, *self._step())

    @property
    def text(self) -> str:
        """A short report: what is given, what is assumed, what is found, and better springs."""
        better = {name: [str(item) for item in one.suggestions] for name, one in self.motions.items()}
        return self._report(self.found, _of_each(better))

    def _line(self) -> str:
        return audit_line(self, f"{', '.join(self.motions) or 'motions coupled'}: chain against rod")


def _of_each(lines: Mapping[str, Sequence[str]]) -> list[str]:
    """Return sentences on motions, each once, after the motions that it is said of."""
    said: dict[str, list[str]] = {}
    for name, each in lines.items():
        for line in each:
            said.setdefault(line, []).append(name)
    return [f"{' and '.join(names)}: {line}" for line, names in said.items()]


def audit_along(
    model: Model,
    beam: Beam,
    boundary: AxialBoundary | None,
    motion: str,
    *,
    chain: str | None,
    modes: int,
    tolerance: float,
) -> AxialAudit:
    """Judge a model's twist or stretch alone, its other joints at rest; errors as of `audit_file`."""
    row = chosen_row(model, chain)
    _check_twist(row)
    _check_held(model, row, boundary is None)
    which = TWIST if motion == "twist" else STRETCH
    whole = row_modes(row, model.ties)
    found = axial_audit_of(model, row, which, beam, boundary, modes, tolerance)
    assumed = [*found.assumed, *model.left_out]
    own = {id(each.joint) for each in row.coordinates if each.motion == which}
    resting = [joint.name for joint in row.joints if id(joint) not in own]
    if resting or len(row.coordinates) > len(own):
        more = ", ..." if len(resting) > _LISTED else ""
        what = f"other joints ({', '.join(resting[:_LISTED])}{more})" if resting else "bending of its joints"
        assumed.append(f"{what} {'are' if resting else 'is'} taken as at rest, as {motion} leaves them")
        if not are_apart(whole, [whole.of(which), whole.but(which)]):
            raise BadModel(
                f"chain at body {row.name} must not bend where it moves in {motion}: one moves the other, as "
                "matter is off its line or axes are oblique to it; motion space judges both together"
            )
    return replace(
        found,
        given=(*model.given, *found.given, *_others(row)),
        assumed=tuple(assumed),
        step=_step(model, whole.of(which)),
    )


def audit_in_space(
    model: Model,
    rod: Rod,
    ends: RodEnds | None,
    *,
    chain: str | None,
    plane: str | None,
    modes: int,
    tolerance: float,
    in_plane: InPlane,
) -> SpatialAudit:
    """Judge a model's chain in all its motions; `in_plane` judges bending. Errors as of `audit_file`."""
    row = chosen_row(model, chain)
    _check_twist(row)
    _check_held(model, row, ends is None)
    # Who says that an end is clamped means the carrier, where it moves.
    held = ends is not None and any(np.isinf(end.stiffness).all() for end in (ends.left, ends.right))
    whole = row_modes(replace(row, held=held), model.ties)
    if not len(whole.angular_frequency):
        raise BadModel(f"chain at body {row.name} must have springs that let it vibrate")
    count = whole_number("modes", modes, most=100)
    judged = _InSpace(model, row, whole, rod, ends, plane, count, tolerance)
    return judged.each_alone(in_plane) if judged.is_apart else judged.together()


@dataclass(frozen=True, eq=False)
class _InSpace:
    """A row, its modes in all coordinates, and the rod that it stands for."""

    model: Model
    row: SpaceRow
    whole: RowModes
    rod: Rod
    ends: RodEnds | None
    plane: str | None
    modes: int
    tolerance: float

    @cached_property
    def _able(self) -> StraightRod:
        return StraightRod(self.rod, RodEnds.of("free-free") if self.ends is None else self.ends)

    @property
    def is_apart(self) -> bool:
        """True if no motion moves another, in the file and in the rod."""
        parts = [self.whole.of(motion) for motion in range(4)]
        return self.row.line is not None and self._able.is_apart and are_apart(self.whole, parts)

    @cached_property
    def present(self) -> set[int]:
        """The motions of which the row has joints."""
        return {each.motion for each in self.row.coordinates if each.group >= 0 and each.motion is not None}

    @cached_property
    def labels(self) -> dict[int, str]:
        """Along which axis of the world each bending deflects."""
        line = self.row.line
        if line is None:
            return {}
        both = (FIRST_BENDING, SECOND_BENDING)
        return dict(zip(both, letters_of([line.across(motion) for motion in both]), strict=True))

    @cached_property
    def names(self) -> dict[int, str]:
        """The name of every motion; which bending is which is told by `plane`, else by the springs."""
        both = {FIRST_BENDING: "bending", SECOND_BENDING: "second_bending"}
        turned = {FIRST_BENDING: "second_bending", SECOND_BENDING: "bending"}
        if self.plane is not None:
            able = {self.labels[motion]: motion for motion in self.labels}
            first = able[choice("plane", self.plane, able)] if able else FIRST_BENDING
            found = both if first == FIRST_BENDING else turned
        else:
            found = both if self._distance(both) <= self._distance(turned) else turned
        return {**found, TWIST: "twist", STRETCH: "stretch"}

    def _distance(self, names: Mapping[int, str]) -> float:
        """Return how far springs are from EI/ell, as logarithms."""
        total = 0.0
        for motion in {FIRST_BENDING, SECOND_BENDING} & self.present:
            own = [each for each in self.row.coordinates if each.motion == motion and each.group >= 0]
            reach = float(np.linalg.norm(own[-1].joint.position - own[0].joint.position))
            ell = reach / (len(own) - 1) if reach else self.rod.length
            stiffness = self._able.beam(names[motion]).mean_bending_stiffness
            total += abs(math.log(float(np.median([each.stiffness for each in own])) * ell / stiffness))
        return round(total, 9)

    @cached_property
    def order(self) -> HingeOrder:
        """In which order the hinges of a node turn."""
        letters = {TWIST: "x"}
        letters |= {k: "z" if self.names[k] == "bending" else "y" for k in (FIRST_BENDING, SECOND_BENDING)}
        return hinge_order(self.row, letters, self.names)

    # Each motion as a beam's.

    def each_alone(self, in_plane: InPlane) -> SpatialAudit:
        """Judge each motion as a beam's of its own."""
        motions: dict[str, Audit | AxialAudit] = {}
        remarks = [self.order.remark] if self.order.remark else []
        for motion, name in sorted(self.names.items(), key=lambda pair: _MOTIONS.index(pair[1])):
            refused = self._left_out(motion, name)
            if refused is not None:
                remarks += [refused] if refused else []
            else:
                motions[name] = self._alone(motion, name, in_plane)
        if not motions:
            raise BadModel(f"chain at body {self.row.name} must move as the rod can: {'; '.join(remarks)}")
        remarks += self._of_balls()
        modes = [
            (omega, name, error)
            for name, one in motions.items()
            for omega, error in zip(one.angular_frequency.tolist(), one.errors.tolist(), strict=True)
        ]
        # Stable, and modes that are not there last.
        modes.sort(key=lambda mode: math.inf if math.isnan(mode[0]) else mode[0])
        given, assumed = self._said()
        if self.ends is not None:
            given += _of_each({name: [f"ends {one.boundary.name}"] for name, one in motions.items()})
        assumed += _of_each({name: self._own(one.assumed) for name, one in motions.items()})
        return SpatialAudit(
            motions={name: replace(one, step=None) for name, one in motions.items()},
            angular_frequency=np.array([mode[0] for mode in modes]),
            errors=np.array([mode[2] for mode in modes]),
            mode_motion=tuple(mode[1] for mode in modes),
            planes=self._planes,
            joints=self.order.name,
            remarks=tuple(remarks),
            tolerance=self.tolerance,
            given=tuple(given),
            assumed=tuple(assumed),
            step=_step(self.model, self.whole),
            step_set_by=self._mostly[-1],
        )

    def _alone(self, motion: int, name: str, in_plane: InPlane) -> Audit | AxialAudit:
        beam, pair = self._beam(name), self._boundary(name)
        if motion in (TWIST, STRETCH):
            along = pair if isinstance(pair, AxialBoundary) else None
            return axial_audit_of(self.model, self.row, motion, beam, along, self.modes, self.tolerance)
        across = pair if isinstance(pair, Boundary) else None
        body = self.row.groups[-1].bodies[-1].name
        return in_plane(self.row.alone(self.model, motion), beam, across, body)

    def _beam(self, name: str) -> Beam:
        rod = self.rod
        if name == "stretch":
            return Beam(rod.length, 1.0, rod.mass_per_length, axial_stiffness=rod.axial_stiffness)
        return self._able.beam(name)

    def _boundary(self, name: str) -> Boundary | AxialBoundary | None:
        if self.ends is None:
            return None
        if name == "stretch":
            left, right = (
                AxialEnd(end.translational_stiffness[0], end.mass)
                for end in (self.ends.left, self.ends.right)
            )
            return AxialBoundary(left, right, name)
        return self._able.boundaries[name]

    def _left_out(self, motion: int, name: str) -> str | None:
        """Return why a motion is not judged, empty if neither file nor rod has it; None if it is judged."""
        rod, here = self.rod, motion in self.present
        has_not = {
            "twist": "polar_inertia_per_length" if rod.polar_inertia_per_length == 0.0 else "",
            "stretch": "axial_stiffness" if rod.axial_stiffness is None else "",
        }.get(name, "")
        if here and has_not:
            first = self.whole.of(motion).angular_frequency[0] / (2 * math.pi)
            return f"{name} of the chain, from {first:.5g} Hz on, is not judged: give the rod's {has_not}"
        if here:
            return None
        if has_not or name == "stretch":
            return ""
        what = (
            "joints about its line" if name == "twist" else f"joints that bend it along {self.labels[motion]}"
        )
        return f"the file's chain lacks {what}: what the rod does in {name}, it does not"

    def _of_balls(self) -> list[str]:
        """Return what is said of balls, which twist as stiffly as they bend."""
        rod = self.rod
        if self.order.name != "ball" or any(joint.springs is not None for joint in self.row.joints):
            return []
        given = (rod.bending_stiffness, rod.second_bending_stiffness, rod.torsional_stiffness)
        bending, second, twisting = (mean_over(value, rod.length) for value in given)
        lines = []
        if abs(twisting / bending - 1) > _SAME:
            off = percent(math.sqrt(bending / twisting) - 1, 2)
            lines.append(
                "twist = EI: a ball has one stiffness, so the file's GJ is its EI, where the rod's GJ is "
                f"{twisting / bending:.4g} EI: twist rings {off} off for that alone"
            )
        if abs(second / bending - 1) > _SAME:
            lines.append(
                f"a ball bends alike in both planes, where the rod has EI = {bending:.6g} and {second:.6g}"
            )
        if lines:
            lines.append(
                "three hinges a node, their order reversed at every other node, take springs for each motion"
            )
        return lines

    def _own(self, lines: Sequence[str]) -> list[str]:
        return [line for line in lines if line not in self.model.left_out]

    @property
    def _planes(self) -> dict[str, str]:
        return {
            self.names[motion]: self.labels[motion]
            for motion in sorted(self.present & {FIRST_BENDING, SECOND_BENDING}, key=lambda k: self.names[k])
        }

    @cached_property
    def _mostly(self) -> list[str]:
        """Which motion stores most of each mode of the whole."""
        stored, motion = self.whole.stored, self.whole.motion
        if self.row.line is None:
            turning = self.row.twisting[-stored.shape[1] :]
            return ["twist" if mode[turning].sum() > 0.5 * mode.sum() else "bending" for mode in stored]
        shares = np.stack([stored[:, motion == k].sum(axis=1) for k in range(4)], axis=1)
        return [self.names[k] for k in np.argmax(shares, axis=1).tolist()]

    def _said(self) -> tuple[list[str], list[str]]:
        """Return what the file says, and what is assumed of the whole chain."""
        kinds = [f"{name} along {label}" for name, label in self._planes.items()]
        kinds += [self.names[k] for k in (TWIST, STRETCH) if k in self.present]
        nodes = len(self.row.nodes)
        told = ", ".join(kinds) or "on no straight line, or oblique to it"
        springs = f"joints with springs at {nodes} node{'s' * (nodes > 1)}"
        given = [*self.model.given, f"chain at body {self.row.name}: {springs}: {told}"]
        assumed = [*self.model.left_out]
        unlike = self.rod.second_bending_stiffness != self.rod.bending_stiffness
        if self.plane is None and unlike and self._planes:
            told = ", ".join(f"{name} along {label}" for name, label in self._planes.items())
            assumed.append(f"{told}, whose springs are nearer to its EI")
        return given + _others(self.row), assumed

    # All motions as one.

    def together(self) -> SpatialAudit:
        """Judge all modes together beside the exact rod's."""
        rod, row = self.rod, self.row
        ends = self._inferred() if self.ends is None else self._fitting(self.ends)
        found = self.whole.angular_frequency[: self.modes]
        only = _own_plane(rod, row)
        lone = self._lone_plane() if only is None else None
        only = lone if only is None else only
        judge = rod.unstretched if only is None else _bending_only(rod, only, self.modes)
        exact = rod_modes(judge, ends, max(len(found), 1)).angular_frequency
        errors = ratios_less_one(found, exact, self.modes)
        mostly = self._mostly[: self.modes]
        mostly += [""] * (self.modes - len(mostly))
        why = "the rod's ends or its shape at rest couple them"
        if self._able.is_apart:
            why = "axes are oblique to the line of the nodes, or nodes are on no line"
            if row.line is not None:
                why = "centres of mass are off its line, or principal axes oblique to it"
        remarks = [f"bending and twist of the chain move each other: {why}; all modes are judged together"]
        if lone is not None:
            remarks = [
                f"all hinges bend the chain in one plane, but {_turned(row)}: it is judged beside the rod's "
                f"{'bending' if lone == _ABOUT_Z else 'second_bending'} alone; the file's chain lacks joints "
                "for the other plane and for twist"
            ]
        elif only is not None:
            remarks = ["hinges bend a curved chain in its own plane only: it is judged there"]
        layout = space_layout(row, rod if only is None else judge, ends, errors, only)
        remarks += [layout.remark, *([self.order.remark] if self.order.remark else [])]
        given, assumed = self._said()
        told = "clamped-free" if row.root.parent is None else "free-free"
        ends_said = [f"ends {told}, as far as the file tells"] if self.ends is None else []
        missing = np.full(self.modes - len(found), np.nan)
        return SpatialAudit(
            motions={},
            angular_frequency=np.concatenate([found, missing]),
            errors=errors,
            mode_motion=tuple(mostly),
            planes=self._planes,
            joints=self.order.name,
            remarks=tuple(remarks),
            tolerance=self.tolerance,
            layout=layout.name,
            given=tuple(given),
            assumed=(*assumed, "the rod's s = 0 is where the file's chain begins", *ends_said),
            step=_step(self.model, self.whole),
            step_set_by=self._mostly[-1],
        )

    def _lone_plane(self) -> int | None:
        """Return the section's axis, 1 or 2, about which a straight chain bends whose hinges are alike.

        None if there are hinges for more than one plane, or on no straight line; of two stiffnesses the one
        is meant that the springs are nearer to.
        """
        row, rod = self.row, self.rod
        if not self._able.is_apart or any(each.kind != "hinge" for each in row.coordinates):
            return None
        common = row.coordinates[0].axis
        reach = row.nodes[-1] - row.nodes[0]
        across = np.linalg.norm(np.cross(np.asarray(row.nodes) - row.nodes[0], reach), axis=1)
        size = float(np.linalg.norm(reach))
        if len(row.nodes) < 2 or across.max() > _STRAIGHT * size**2:
            return None
        least = math.cos(math.radians(_TURNED))
        if min(abs(float(each.axis @ common)) for each in row.coordinates) < least:
            return None
        if abs(float(reach @ common)) > _FLAT + size * math.sin(math.radians(_TURNED)):
            return None
        spring = float(np.median([each.stiffness for each in row.coordinates]))
        meant = spring * size / (len(row.nodes) - 1)
        own = {_ABOUT_Z: rod.bending_stiffness, _ABOUT_Y: rod.second_bending_stiffness}
        return min(own, key=lambda at: abs(math.log(meant / mean_over(own[at], rod.length))))

    @property
    def _is_tied(self) -> bool:
        names = {joint.name for joint in self.row.joints}
        return any(names & dict(tie.terms).keys() for tie in self.model.ties)

    def _fitting(self, ends: RodEnds) -> RodEnds:
        """Return ends that hold the chain where the file does; refuse others."""
        free = len(self.whole.motion) - sum(each.group >= 0 for each in self.row.coordinates)
        held = int(np.isinf(ends.left.stiffness).sum())
        if free != 6 - held or self._is_tied != bool(ends.right.stiffness.any()):
            near, far = f"{6 - free} of 6 motions", "ties" if self._is_tied else "nothing"
            raise ValueError(
                f"boundary must fit the file, which holds {near} of the end where its chain begins, and "
                f"{far} at the other, got {ends}"
            )
        return ends

    def _inferred(self) -> RodEnds:
        """Return the ends that a file has whose motions are judged together: held or free, and a free tip."""
        carried = self.row.is_carried
        if self._is_tied or (carried and any(joint.kind != "free" for joint in self.row.root.joints)):
            raise BadModel(
                f"chain at body {self.row.name} is held in its own way: say by boundary what its ends are"
            )
        return RodEnds.of("free-free" if carried else "clamped-free")


def are_apart(whole: RowModes, parts: Sequence[RowModes]) -> bool:
    """Return True if parts, each with the others at rest, have together the frequencies of the whole.

    Where what one part moves were felt by another, frequencies would repel each other.
    """
    # Compliances: of high modes of long rows frequencies have fewer digits.
    own = whole.angular_frequency**-2
    both = np.sort(np.concatenate([part.angular_frequency**-2 for part in parts]))[::-1]
    count, rounding = min(len(own), len(both)), _ROUNDING * own.max(initial=0.0)
    off = np.abs(both[:count] - own[:count]) > 2 * _APART * own[:count] + rounding
    return not off.any() and bool((own[count:] <= rounding).all() and (both[count:] <= rounding).all())


def _own_plane(rod: Rod, row: SpaceRow) -> int | None:
    """Return the section's axis, 1 or 2, about which a curved rod bends as a row of parallel hinges does.

    None if hinges turn about more axes, or the rod does not stay in one plane.
    """
    axis = row.coordinates[0].axis
    if any(each.kind != "hinge" or not are_parallel(each.axis, axis) for each in row.coordinates):
        return None
    turns = np.abs(rod.curvature_at(np.linspace(0.0, rod.length, _SAMPLES))).max(axis=0) * rod.length
    able = [at for at in (1, 2) if not (np.delete(turns, at) > _FLAT).any() and turns[at] > _FLAT]
    return able[0] if able else None


def _turned(row: SpaceRow) -> str:
    """Return which hinges are turned against most of the others, and by how much."""
    axes = np.array([each.axis for each in row.coordinates])
    axes *= np.sign(axes @ axes[0])[:, None]
    usual = np.median(axes, axis=0)
    usual /= np.linalg.norm(usual)
    angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(axes, usual), axis=1), axes @ usual))
    odd = [
        f"{each.joint.name} is turned by {angle:.3g} degrees"
        for each, angle in zip(row.coordinates, angles.tolist(), strict=True)
        if angle > _NOT_TURNED
    ]
    return ", ".join(odd[:_LISTED]) or "their axes are oblique to its line"


def _bending_only(rod: Rod, axis: int, modes: int) -> Rod:
    """Return the rod that bends about one axis only: what leaves its plane does not move what stays in it.

    Twist and the other bending are made so stiff that their modes are beyond those of the plane.
    """
    own = (rod.torsional_stiffness, rod.second_bending_stiffness, rod.bending_stiffness)
    stiff = mean_over(own[axis], rod.length) * (_STIFFER * modes) ** 4
    twisting, second, first = (each if at == axis else stiff for at, each in enumerate(own))
    return replace(
        rod.unstretched,
        torsional_stiffness=twisting,
        second_bending_stiffness=second,
        bending_stiffness=first,
    )


def _others(row: SpaceRow) -> list[str]:
    more = ", ..." if len(row.others) > _LISTED else ""
    return [f"other chains in the file: {', '.join(row.others[:_LISTED])}{more}"] if row.others else []


def _check_twist(row: SpaceRow) -> None:
    """Refuse balls that nothing resists in turning about the chain's line, as of a cable with twist 0."""
    own = [each for each in row.coordinates if each.motion == TWIST and each.joint.springs is not None]
    if own and not any(each.stiffness for each in own):
        raise BadModel(
            f"chain at body {row.name} must resist twist, got a cable whose twist is 0: give "
            "it a twist [Pa] above 0, or judge its bending alone (motion bending)"
        )


def _check_held(model: Model, row: SpaceRow, alone: bool) -> None:
    """Refuse a chain that other constraints act on, unless the user says what its ends are."""
    names = {joint.name for joint in row.joints}
    held = [why for body, why in model.held if row.has_body(body) or body in names]
    if held and alone:
        raise BadModel(f"{held[0]} holds the chain: say by boundary what its ends are")


def _step(model: Model, modes: RowModes) -> StepVerdict | None:
    """Return the file's step beside the longest stable one of these modes, damped, without weight."""
    if model.step is None:
        return None
    record = fixed_step_integrator(model.step.record)
    limit = math.inf if record.springs == "implicit" else modal_time_step(record, modes.damped)
    return StepVerdict(model.step.timestep, limit, model.step.integrator, False)
