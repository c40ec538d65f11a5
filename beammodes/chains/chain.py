"""The chain: rigid pieces cut at hinges, with a rotational spring at every hinge.

::

      wall   θ₁      θ₂      θ₃           y, up
       ||=o======o======o======           |
       ||0    1     2      3              +---- x
         left                 right

A chain is a row of straight rigid pieces, i = 0, 1, ..., p-1, from left to right. Neighbours share a hinge;
hinge j joins pieces j and j+1 and resists their relative rotation θ_{j+1} - θ_j with a spring k_j. Angles θ_i
are absolute, counter-clockwise positive, zero on the straight chain; deflections y point up.

The ends act on the two outer pieces. A clamped or guided end holds its piece's angle at zero, so a hinge *at*
the wall is an outer piece of length zero, a stub one of half or whole segment. A clamped or pinned end
holds the deflection of its piece's outer tip; springs of an elastic support act on the same two quantities.
A body fixed to an end is part of the outer piece, so the rule's wall spring sits between body and beam.

Numbers are kept in the chain's own units (a segment's length, its mass, EI over its length), in which a
chain made by a rule is exact: its lengths, masses, inertias and springs are rational numbers.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from beammodes.chains.pieces import (
    MAX_PIECES,
    Number,
    Pieces,
    check_pieces,
    check_turning,
    each_once,
    piece_numbers,
)
from beammodes.chains.rods import (
    MissedFeatureWarning,
    hinge_flexibilities,
    missed_by_samples,
    missed_feature,
    profile_weights,
    rigid_rods,
)
from beammodes.chains.rules import AnyRule, Layout, Rule, layout_of
from beammodes.chains.units import ExactUnits, Units
from beammodes.checks import Shown, instead, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike

__all__ = ["Chain", "ChainNumbers", "cut_by_rule"]


# The numbers of a chain: in its own units, where they may be exact, and in physical ones, as arrays.


@dataclass(frozen=True)
class ChainNumbers:
    """Pieces, springs and supports of a chain, and the units in which they are kept.

    Attributes
    ----------
    scaled : Pieces
        Lengths, masses, centres, inertias, springs and supports over `units`, exact where a rule made them. A
        support is inf where it holds; K_r is the end's own, or that in series with the hinge of an outer
        piece that had nothing to move.
    units : Units
        What one stands for there. All other attributes are in SI units.
    """

    scaled: Pieces
    units: Units

    @property
    def pieces(self) -> int:
        """Number of pieces, zero-length outer ones included."""
        return len(self.scaled.length)

    @cached_property
    def joint_stiffness(self) -> Floats:
        """Rotational stiffness of every hinge, left to right, shape (hinges,) [N m/rad]."""
        return _in_si(self.scaled.in_floats.joint_stiffness, self.units.stiffness)

    @cached_property
    def support_stiffness(self) -> Floats:
        """Stiffness of the ends' supports on the outer pieces, inf where held, shape (2, 2) [N/m, N m/rad].

        Rows are the left and the right end. A rotational one is the end's own, in series with the wall's
        hinge where nothing in between has inertia: that hinge is then missing among `joint_stiffness`.
        """
        unit = np.array([self.units.stiffness / self.units.length**2, self.units.stiffness])
        stiffness: Floats = np.array([[float(k) for k in end] for end in self.scaled.supports]) * unit
        stiffness.flags.writeable = False
        return stiffness

    @cached_property
    def length(self) -> Floats:
        """Length of every piece, shape (pieces,) [m]."""
        return _in_si(self.scaled.in_floats.length, self.units.length)

    @cached_property
    def mass(self) -> Floats:
        """Mass of every piece, shape (pieces,) [kg]."""
        return _in_si(self.scaled.in_floats.mass, self.units.mass)

    @cached_property
    def centre(self) -> Floats:
        """Centre of mass of every piece, from its left tip, shape (pieces,) [m]."""
        return _in_si(self.scaled.in_floats.centre, self.units.length)

    @cached_property
    def rotary_inertia(self) -> Floats:
        """Rotary inertia of every piece about its centre of mass, shape (pieces,) [kg m²]."""
        return _in_si(self.scaled.in_floats.rotary_inertia, self.units.mass * self.units.length**2)

    @cached_property
    def hinge_position(self) -> Floats:
        """Distance of every hinge from the left end, shape (hinges,) [m]."""
        position = np.cumsum(self.length)[:-1]
        position.flags.writeable = False
        return position


def _in_si(values: Floats, unit: float) -> Floats:
    array = values * unit
    array.flags.writeable = False
    return array


@dataclass(frozen=True, init=False, repr=False)
class Chain(Shown, ChainNumbers):
    """A beam of rigid segments and rotational springs, by a rule.

    Parameters
    ----------
    beam : Beam
        The beam that the chain stands for.
    boundary : str, pair or Boundary
        Its two ends, such as "clamped-free"; arrays run from the end named first.
    segments : int
        N, how many equal segments the beam is cut into (1 to 10 million).
    rule : str, Rule or any Layout, such as a record from `mode_tuned` or `matched`
        Where the hinges sit and how stiff they are.

    Warns
    -----
    MissedFeatureWarning
        If the beam has a feature of EI narrower than about a fifth of a segment, such as a notch, that no
        hinge stands on, so that no spring knows of it, or that one does stand on, whose spring then is as if
        the whole segment were so; and it is more than a thousandth of the beam's flexibility. Or if EI is
        a table too coarse and steep for the hinges (`hinge_flexibilities`), whose values at them miss, or
        make too much of, more than a thousandth of it.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the rule gives a spring that is not positive.

    Examples
    --------
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4, rule="mitiguy")
    >>> chain.joint_stiffness                       # 24/11 EI/ell at the wall, EI/ell elsewhere
    array([8.72727273, 4.        , 4.        , 4.        ])
    """

    boundary: Boundary
    exact_units: ExactUnits
    beam: Beam | None
    segments: int | None
    rule: Layout | None

    def __init__(self, beam: Beam, boundary: BoundaryLike, segments: int, rule: AnyRule = "mitiguy") -> None:
        if not isinstance(beam, Beam):
            raise TypeError(
                f"beam must be a Beam, got {shown(beam)}"
                + instead(beam, Rod="SpatialChain takes a Rod", Structure="StructureChain takes a Structure")
            )
        boundary, record = Boundary.of(boundary), layout_of(rule)
        count = whole_number("segments", segments, most=MAX_PIECES)
        units, exact = Units.of(beam, count), ExactUnits.of(beam, count)
        lengths, weights = cut_by_rule(record, boundary, count)
        for hinge, added in profile_weights(beam, boundary, record, lengths, exact).items():
            weights[hinge] += added
        if any(each_once(lambda weight: weight <= 0, weights)):
            raise ValueError(
                f"rule {record.name} has no positive springs for {boundary.name} with {count} segments"
            )
        _warn_of_missed_features(beam, boundary, lengths, weights, exact, count)
        flexibility = hinge_flexibilities(beam, boundary, lengths, weights, exact)
        springs = each_once(lambda give: 1 / give, flexibility)
        rods = rigid_rods(beam, lengths, record.rotary_inertia, exact)
        self._fill(
            boundary,
            tuple(lengths),
            *rods,
            tuple(springs),
            units=units,
            exact_units=exact,
            beam=beam,
            segments=count,
            rule=record,
        )

    @classmethod
    def from_pieces(
        cls,
        *,
        length: Sequence[Number] | Floats,
        mass: Sequence[Number] | Floats,
        rotary_inertia: Sequence[Number] | Floats,
        joint_stiffness: Sequence[Number] | Floats,
        boundary: BoundaryLike,
        centre: Sequence[Number] | Floats | None = None,
    ) -> Chain:
        """Return the chain of given pieces and springs; numbers are kept as given, in consistent units.

        Parameters
        ----------
        length, mass, rotary_inertia : sequence, shape (pieces,) [m], [kg], [kg m²]
            Of each piece, left to right; the inertia about its centre of mass. An outer piece may have
            length zero: that puts a hinge at the wall.
        joint_stiffness : sequence, shape (pieces - 1,) [N m/rad]
            Of each hinge, left to right.
        boundary : str, pair or Boundary
            The ends, which act on the two outer pieces; their bodies are fixed to these.
        centre : sequence, shape (pieces,) [m], optional
            Of mass of each piece, from its left tip; its middle by default.

        Raises
        ------
        TypeError, ValueError
            If shapes disagree, or a number is not finite, is negative, or makes a piece without mass
            or length inside the chain.

        Examples
        --------
        >>> chain = Chain.from_pieces(length=[0, 1, 1], mass=[0, 1, 1], rotary_inertia=[0, 1/12, 1/12],
        ...                           joint_stiffness=[2.0, 1.0], boundary="clamped-free")
        >>> chain.elastic_modes
        2
        """
        given = {"length": length, "mass": mass, "rotary_inertia": rotary_inertia}
        given |= {} if centre is None else {"centre": centre}
        columns = {name: piece_numbers(name, values) for name, values in given.items()}
        columns.setdefault("centre", tuple(each_once(lambda value: value / 2, columns["length"])))
        columns["joint_stiffness"] = piece_numbers("joint_stiffness", joint_stiffness)
        check_pieces(columns)
        chain = cls.__new__(cls)
        numbers = [
            columns[name] for name in ("length", "mass", "centre", "rotary_inertia", "joint_stiffness")
        ]
        unit = {"units": Units(), "exact_units": ExactUnits()}
        chain._fill(Boundary.of(boundary), *numbers, **unit, beam=None, segments=None, rule=None)
        return chain

    def _fill(self, boundary: Boundary, *columns: tuple[Number, ...], **fields: Any) -> None:
        units: ExactUnits = fields["exact_units"]
        left, right = (
            (units.support(end.translational_stiffness, 2), units.support(end.rotational_stiffness, 0))
            for end in (boundary.left, boundary.right)
        )
        bodies = (units.body(*end.moving_body) for end in (boundary.left, boundary.right))
        length, mass, centre, inertia, springs = columns
        pieces = Pieces(length, mass, centre, inertia, springs, (left, right))
        hubs = (units.body(0, 0, end.hub_radius)[2] for end in (boundary.left, boundary.right))
        pieces = pieces.with_bodies(*bodies).with_hubs(*hubs).condensed()
        check_turning(pieces)
        fields |= {"boundary": boundary, "scaled": pieces}
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def held_angles(self) -> tuple[bool, ...]:
        """For each piece, whether an end holds its angle at zero."""
        held = [False] * self.pieces
        held[0] |= self.boundary.left.holds_rotation
        held[-1] |= self.boundary.right.holds_rotation
        return tuple(held)

    @property
    def elastic_modes(self) -> int:
        """Number of modes that store energy: the chain's independent motions, less the rigid-body modes."""
        (left, _), (right, _) = self.scaled.supports
        turning = zip(self.scaled.length, self.held_angles, strict=True)
        reaches = any(length and not held for length, held in turning)
        # A right tip that nothing could move is held twice.
        tips = (left != math.inf) - (right == math.inf and (left != math.inf or reaches))
        return max(0, tips + self.held_angles.count(False) - self.boundary.rigid_body_modes)

    @cached_property
    def hinge_position(self) -> Floats:
        """Distance of every hinge from the beam's left end, shape (hinges,) [m]."""
        position = np.cumsum(self.length)[:-1] - float(self.boundary.left.hub_radius)
        position.flags.writeable = False
        return position

    @cached_property
    def node_position(self) -> Floats:
        """Distance of the left tip, every hinge and the right tip from the left end, shape (nodes,) [m].

        A tip on a hub's axis lies beyond the beam's end.
        """
        position = np.concatenate([[0.0], np.cumsum(self.length)]) - float(self.boundary.left.hub_radius)
        if self.beam is not None:
            # Summed lengths miss the beam's end by their rounding, and the exact beam has no shape beyond it.
            position[-1] = self.beam.length
            position = np.minimum(position, self.beam.length)
            position[-1] += float(self.boundary.right.hub_radius)
        position.flags.writeable = False
        return position

    def _line(self) -> str:
        by = f"segments={self.segments}, rule={self.rule.name!r}" if self.rule else f"{self.pieces} pieces"
        return f"<Chain {self.boundary.name}: {by}>"


def cut_by_rule(rule: Layout, boundary: Boundary, segments: int) -> tuple[list[Fraction], list[Number]]:
    """Return a rule's piece lengths and hinge weights; what somebody's own layout gives is checked."""
    if isinstance(rule, Rule):
        return rule.piece_lengths(boundary, segments), list(rule.hinge_weights(boundary, segments))
    given = piece_numbers(f"piece_lengths of {rule.name}", rule.piece_lengths(boundary, segments))
    lengths = [Fraction(length) for length in given]
    weights = list(piece_numbers(f"hinge_weights of {rule.name}", rule.hinge_weights(boundary, segments)))
    if len(weights) != len(lengths) - 1:
        raise ValueError(
            f"hinge_weights of {rule.name} must have {len(lengths) - 1} entries for {len(lengths)} pieces, "
            f"got {len(weights)}"
        )
    if min(lengths) < 0 or abs(float(sum(lengths)) / segments - 1) > 1e-9:
        raise ValueError(
            f"piece_lengths of {rule.name} must not be negative, and add up to {segments} segments, "
            f"got {shown(lengths)}"
        )
    return lengths, weights


def _warn_of_missed_features(
    beam: Beam,
    boundary: Boundary,
    lengths: Sequence[Fraction],
    weights: Sequence[Number],
    units: ExactUnits,
    count: int,
) -> None:
    found = missed_feature(beam, lengths, units)
    if found is None:
        whole = missed_by_samples(beam, boundary, lengths, weights, units)
        if whole is not None:
            does = "miss" if whole > 0 else "make too much of"
            warnings.warn(
                f"the hinges of {count} segments {does} {100 * abs(whole):.2g} % of the beam's flexibility: "
                "bending_stiffness, a table, varies too much from one position to the next for them. Take "
                "more segments, give positions of kinks as breaks and put hinges there, or see by "
                "chain_errors what it does to frequencies",
                MissedFeatureWarning,
                stacklevel=3,
            )
        return
    place, part = found
    does = "misses" if part > 0 else "makes too much of"
    warnings.warn(
        f"the hinge at x = {place:.6g} of {count} segments {does} {100 * abs(part):.2g} % of the beam's "
        "flexibility, a feature of bending_stiffness narrower than its segment: take more segments, or see "
        "by chain_errors what it does to frequencies",
        MissedFeatureWarning,
        stacklevel=3,
    )
