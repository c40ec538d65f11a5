"""The chain that twists or stretches: rigid pieces, each moving as a whole, and a spring at every hinge.

It has the pieces and hinges that a rule lays out for bending. What turns or shifts is a piece as a whole,
with the inertia ρIp (or ρA) of its length, and a hinge of weight w has the spring

    k_j = GJ/(w_j ell)      in twist,        EA/(w_j ell)      in stretch,

so a rule's weights are those of a quadrature again, now of T²/GJ along the beam (`AxialEnd.statics` has which
of them apply at an end). An end with a spring, a disc or a mass has a hinge of its own as in bending; it acts
on the outer piece, which has no length where the hinge is at the wall.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

import numpy as np

from beammodes.chains.chain import cut_by_rule
from beammodes.chains.pieces import MAX_PIECES, each_once, floats
from beammodes.chains.rules import (
    AnyRule,
    AxiallyCorrected,
    Layout,
    RuleMaker,
    hinges_at_nodes,
    layout_of,
)
from beammodes.checks import Shown, real, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.motions import MOTIONS, Motion
from beammodes.problem.profiles import mean_reciprocal, moments

__all__ = ["AnyAxialRule", "AxialChain", "AxialLayout", "at_rest", "axial_layout_of", "laid_out"]


@runtime_checkable
class AxialLayout(Protocol):
    """A record whose springs suit the ends in twist and stretch, such as `mode_tuned` gives for them."""

    @property
    def name(self) -> str:
        """Name in errors and tables."""

    def axial_weights(self, boundary: AxialBoundary, segments: int) -> Sequence[Fraction | float]:
        """Return the flexibility weights of hinges at nodes and walls, left to right.

        Numbers of the ends are multiples of k/L and m L.
        """


AnyAxialRule = AnyRule | AxialLayout


def axial_layout_of(rule: AnyAxialRule) -> Layout | AxialLayout:
    """Return the layout that a rule's name or record stands for, for twist and stretch.

    Raises
    ------
    TypeError, ValueError
        As `layout_of`, or if its springs are for bending only.

    Examples
    --------
    >>> axial_layout_of("half_stub").name
    'half_stub'
    """
    if isinstance(rule, AxialLayout):
        return rule
    layout = layout_of(rule)
    if isinstance(layout, RuleMaker | AxiallyCorrected) or hasattr(layout, "exact_modes"):
        raise ValueError(
            f"rule must be one for any motion, got {layout.name}, whose springs are for bending: mode_tuned "
            'and matched take motion="twist" and "stretch"'
        )
    return layout


def laid_out(
    record: Layout | AxialLayout, boundary: AxialBoundary, segments: int
) -> tuple[list[Fraction], list[Fraction | float]]:
    """Return pieces' lengths in segments and hinges' weights; ends' numbers are multiples of k/L and m L.

    Examples
    --------
    >>> pieces, weights = laid_out(axial_layout_of("gregory"), AxialBoundary.of("fixed-free"), 3)
    >>> [str(weight) for weight in weights]
    ['1/2', '1', '1']
    """
    if isinstance(record, AxialLayout):
        return hinges_at_nodes(boundary.stand_in, segments), list(record.axial_weights(boundary, segments))
    return cut_by_rule(record, boundary.stand_in, segments)


@dataclass(frozen=True, init=False, repr=False)
class AxialChain(Shown):
    """A chain of rigid pieces and springs in twist or stretch, by a rule.

    Parameters
    ----------
    beam : Beam
        With the numbers of the motion: torsional_stiffness and polar_inertia_per_length, or axial_stiffness.
        They may vary along it.
    boundary : str, pair of words or AxialEnd, or AxialBoundary
        Such as "fixed-free(inertia=0.5)"; arrays run from the end named first.
    segments : int
        N, how many equal segments the beam is cut into.
    rule : str, Rule or any Layout
    motion : str
        "twist" or "stretch".

    Attributes
    ----------
    length, inertia : ndarray, shape (pieces,) [m], [kg m²] in twist, [kg] in stretch
        Of every piece, left to right; a piece of no length holds a hinge at the wall. Bodies of the ends are
        not counted.
    joint_stiffness : ndarray, shape (hinges,) [N m/rad] in twist, [N/m] in stretch

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam lacks a number, or a spring would not be positive.

    Examples
    --------
    >>> shaft = Beam(0.5, 1.0, 1.0, torsional_stiffness=80.0, polar_inertia_per_length=8e-6)
    >>> AxialChain(shaft, "fixed-free", 4, "half_stub").joint_stiffness
    array([640., 640., 640., 640.])
    >>> AxialChain(shaft, "fixed-free", 4, "gregory").joint_stiffness           # 2 GJ/ell at the wall
    array([1280.,  640.,  640.,  640.])
    """

    beam: Beam
    boundary: AxialBoundary
    segments: int
    rule: Layout | AxialLayout
    length: Floats = field(compare=False)
    inertia: Floats = field(compare=False)
    joint_stiffness: Floats = field(compare=False)

    def __init__(
        self,
        beam: Beam,
        boundary: AxialBoundaryLike,
        segments: int,
        rule: AnyAxialRule = "mitiguy",
        *,
        motion: str | Motion = "twist",
    ) -> None:
        pair = AxialBoundary.of(boundary, motion)
        record, count = axial_layout_of(rule), whole_number("segments", segments, most=MAX_PIECES)
        stiffness, density = MOTIONS[pair.motion].numbers(beam)
        mean = MOTIONS[pair.motion].mean_numbers(beam)
        pieces, weights = laid_out(record, pair.scaled(mean[0] / beam.length, mean[1] * beam.length), count)
        if not all(each_once(lambda weight: weight > 0, weights)):
            raise ValueError(
                f"rule {record.name} has no positive springs for {pair.name} with {count} segments"
            )
        ell, length = beam.length / count, floats(pieces)
        edges = np.concatenate([[0.0], np.cumsum(length)]) * ell
        edges = np.minimum(edges, beam.length)
        edges[-1] = beam.length
        flexibility = floats(weights) * ell
        values = {
            "beam": beam,
            "boundary": pair,
            "segments": count,
            "rule": record,
            "length": length * ell,
            "inertia": np.asarray(moments(density, edges)[0], dtype=np.float64),
            "joint_stiffness": np.asarray(1.0 / (flexibility * mean_reciprocal(stiffness, edges[1:-1]))),
        }
        for name, value in values.items():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def motion(self) -> Motion:
        """The record of twist or stretch."""
        return MOTIONS[self.boundary.motion]

    @property
    def pieces(self) -> int:
        """Number of pieces, those without length included."""
        return len(self.length)

    @cached_property
    def hinge_position(self) -> Floats:
        """Distance of every hinge from the left end, shape (hinges,) [m]."""
        return np.minimum(np.cumsum(self.length)[:-1], self.beam.length)

    @cached_property
    def moving(self) -> tuple[slice, Floats, Floats]:
        """The pieces that move, their inertia with bodies of the ends, and the springs around them.

        Springs are one more than moving pieces: from the ground to the first, between neighbours, and from
        the last to the ground; 0 where nothing holds. Outer pieces without inertia are condensed: their hinge
        and the end's spring act in series.
        """
        inertia = self.inertia.copy()
        left, right = self.boundary.left, self.boundary.right
        inertia[0] += left.inertia
        inertia[-1] += right.inertia
        springs = np.concatenate([[left.stiffness], self.joint_stiffness, [right.stiffness]])
        first, last = 0, len(inertia)
        if last == 1 and (left.is_fixed or right.is_fixed):
            return slice(0, 0), inertia[:0], np.zeros(1)
        if left.is_fixed or not inertia[0]:
            springs[1] = _in_series(springs[0], springs[1])
            first = 1
        if right.is_fixed or not inertia[-1]:
            springs[-2] = _in_series(springs[-1], springs[-2])
            last -= 1
        return slice(first, last), inertia[first:last], springs[first : last + 1]

    @property
    def elastic_modes(self) -> int:
        """Number of modes that store energy: the pieces that move, less the rigid-body mode."""
        return max(0, len(self.moving[1]) - self.boundary.rigid_body_modes)

    def displacement(self, loads: Mapping[float, float]) -> Floats:
        """Return how far each piece turns or shifts under loads, shape (pieces,) [rad] or [m].

        With 1/2 at a fixed end that is what the beam does at the pieces' middles, exactly.

        Parameters
        ----------
        loads : mapping from positions to loads [m] -> [N m] in twist, [N] in stretch
            A load on a hinge acts in halves on both pieces that meet there.

        Raises
        ------
        TypeError, ValueError
            If a number is not real and finite, a position lies outside the beam, or nothing holds the chain.

        Examples
        --------
        >>> shaft = Beam(1.2, 1.0, 1.0, torsional_stiffness=30e3, polar_inertia_per_length=1.0)
        >>> chain = AxialChain(shaft, "free-fixed", 12, motion="twist")
        >>> chain.displacement({0.0: 100.0, 0.4: -220.0, 0.7: -60.0})[[0, 4, 7]].round(6)
        array([-0.003033, -0.004   , -0.0027  ])
        """
        if not isinstance(loads, Mapping):
            raise TypeError(f"loads must map positions to loads, got {shown(loads)}")
        if self.boundary.rigid_body_modes:
            raise ValueError(f"boundary must hold the chain under loads, got {self.boundary.name}")
        force = np.zeros(self.pieces)
        edges = np.concatenate([[0.0], self.hinge_position, [self.beam.length]])
        near, unit = 1e-9 * self.beam.length, self.motion.load_unit
        for place, load in loads.items():
            x, value = real("position in loads", place, "m"), real("load in loads", load, unit)
            if not -near <= x <= self.beam.length + near:
                raise ValueError(
                    f"position in loads must be from 0 to {self.beam.length}, got {shown(place)}"
                )
            # Pieces without length stand for the ends themselves.
            on = np.flatnonzero((edges[:-1] <= x + near) & (x - near <= edges[1:]))
            ends = on[self.length[on] == 0.0]
            on = ends if len(ends) else on
            force[on] += value / len(on)
        chosen, _, springs = self.moving
        # What acts on a condensed outer piece goes to its neighbour by the hinge, the rest to the ground.
        for outer, inner, share, _ in self._condensed:
            force[inner] += share * force[outer]
        moved = at_rest(springs, force[chosen])[0] if len(springs) > 1 else np.zeros(0)
        result: Floats = self.spread(moved[None, :])[0]
        for outer, _, _, softness in self._condensed:
            result[outer] += softness * force[outer]
        return result

    def spread(self, moved: Floats) -> Floats:
        """Return displacements of all pieces from those of the moving ones, shape (..., pieces)."""
        result = np.zeros((len(moved), self.pieces))
        result[:, self.moving[0]] = moved
        for outer, inner, share, _ in self._condensed:
            result[:, outer] = share * result[:, inner]
        return result

    @property
    def _condensed(self) -> list[tuple[int, int, float, float]]:
        """Outer pieces without inertia on springs: theirs and the neighbour's index, h/(K + h), 1/(K + h)."""
        found = []
        sides = ((self.boundary.left, 0, 1, 0), (self.boundary.right, -1, -2, -1))
        for end, outer, inner, hinge in sides:
            if 0.0 < end.stiffness < math.inf and not end.inertia and not self.inertia[outer]:
                spring = float(self.joint_stiffness[hinge])
                whole = end.stiffness + spring
                found.append((outer, inner, spring / whole, 1.0 / whole))
        return found

    def _line(self) -> str:
        return (
            f"<AxialChain {self.boundary.name} in {self.boundary.motion}: {self.pieces} pieces, "
            f"segments={self.segments}, rule={self.rule.name!r}>"
        )


def at_rest(springs: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Return displacements of pieces under forces, and what the springs around them carry.

    By sums of forces and then of extensions along the chain, in which no digits are lost, however long it is.
    Forces on a chain that nothing holds must add up to nothing; its first piece stays.

    Examples
    --------
    >>> at_rest(np.array([1.0, 2.0, 0.0]), np.array([0.0, 1.0]))[0]                  # held on the left
    array([1. , 1.5])
    """
    if not springs[0] and springs[-1]:
        moved, carried = at_rest(springs[::-1], force[::-1])
        return moved[::-1], -carried[::-1]
    passed = np.concatenate([[0.0], np.cumsum(force)])
    soft = np.divide(1.0, springs, out=np.zeros_like(springs), where=springs > 0.0)
    reaction = float(passed @ soft) / float(soft.sum()) if springs[-1] else float(passed[-1])
    carried = (reaction if springs[0] else 0.0) - passed
    return np.cumsum(carried[:-1] * soft[:-1]), carried


def _in_series(outer: Any, hinge: Any) -> float:
    """Return the spring of an end's own and its hinge's, one after the other."""
    if outer == math.inf:
        return float(hinge)
    return float(hinge * (outer / (outer + hinge))) if outer else 0.0
