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
holds the deflection of its piece's outer tip.

Numbers are kept in the chain's own units (a segment's length, its mass, EI over its length), in which a
chain made by a rule is exact: its lengths, masses, inertias and springs are rational numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.beam import Beam
from beammodes.checks import shown, whole_number
from beammodes.ends import Boundary, BoundaryLike
from beammodes.pieces import MAX_PIECES, Number, check_pieces, not_idle, piece_numbers
from beammodes.rules import AnyRule, Layout, layout_of
from beammodes.units import Units

__all__ = ["MAX_PIECES", "Chain", "Number", "Units"]


@dataclass(frozen=True, init=False)
class Chain:
    """A beam of rigid segments and rotational springs, by a rule.

    Parameters
    ----------
    beam : Beam
        The beam that the chain stands for.
    boundary : str, pair or Boundary
        Its two ends, such as "clamped-free"; arrays run from the end named first.
    segments : int
        N, how many equal segments the beam is cut into (1 to 10 million).
    rule : str, Rule, or a record from `mode_tuned` or `matched`
        Where the hinges sit and how stiff they are.

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
    piece_length: tuple[Number, ...]
    piece_mass: tuple[Number, ...]
    piece_rotary_inertia: tuple[Number, ...]
    hinge_stiffness: tuple[Number, ...]
    units: Units
    beam: Beam | None
    segments: int | None
    rule: Layout | None

    def __init__(self, beam: Beam, boundary: BoundaryLike, segments: int, rule: AnyRule = "mitiguy") -> None:
        if not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(beam)}")
        boundary, record = Boundary.of(boundary), layout_of(rule)
        count = whole_number("segments", segments, most=MAX_PIECES)
        lengths = record.piece_lengths(boundary, count)
        weights = record.hinge_weights(boundary, count)
        if any(weight <= 0 for weight in set(weights)):
            raise ValueError(
                f"rule {record.name} has no positive springs for {boundary.name} with {count} segments"
            )
        units = Units.of(beam, count)
        inertia = {length: record.rotary_inertia * length**3 for length in set(lengths)}
        stiffness = {weight: 1 / weight for weight in set(weights)}
        self._fill(
            boundary=boundary,
            piece_length=tuple(lengths),
            piece_mass=tuple(lengths),
            piece_rotary_inertia=tuple(inertia[length] for length in lengths),
            hinge_stiffness=tuple(stiffness[weight] for weight in weights),
            units=units,
            beam=beam,
            segments=count,
            rule=record,
        )

    @classmethod
    def from_pieces(
        cls,
        *,
        length: Sequence[Number] | NDArray[np.float64],
        mass: Sequence[Number] | NDArray[np.float64],
        rotary_inertia: Sequence[Number] | NDArray[np.float64],
        joint_stiffness: Sequence[Number] | NDArray[np.float64],
        boundary: BoundaryLike,
    ) -> Chain:
        """Return the chain of given pieces and springs; numbers are kept as given, in consistent units.

        Parameters
        ----------
        length, mass, rotary_inertia : sequence, shape (pieces,) [m], [kg], [kg m²]
            Of each piece, left to right; the inertia about its middle, where its centre of mass lies.
            An outer piece may have length zero: that puts a hinge at the wall.
        joint_stiffness : sequence, shape (pieces - 1,) [N m/rad]
            Of each hinge, left to right.
        boundary : str, pair or Boundary
            The ends, which act on the two outer pieces.

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
        columns = {"length": length, "mass": mass, "rotary_inertia": rotary_inertia}
        pieces = {name: piece_numbers(name, values) for name, values in columns.items()}
        springs = piece_numbers("joint_stiffness", joint_stiffness)
        pair = Boundary.of(boundary)
        check_pieces(pair, pieces, springs)
        keep = not_idle(pair, *pieces.values())
        chain = cls.__new__(cls)
        chain._fill(
            boundary=pair,
            piece_length=pieces["length"][keep],
            piece_mass=pieces["mass"][keep],
            piece_rotary_inertia=pieces["rotary_inertia"][keep],
            hinge_stiffness=springs[keep.start : keep.stop - 1],
            units=Units(),
            beam=None,
            segments=None,
            rule=None,
        )
        return chain

    def _fill(self, **fields: object) -> None:
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def pieces(self) -> int:
        """How many pieces the chain has, zero-length outer ones included."""
        return len(self.piece_length)

    @property
    def held_angles(self) -> tuple[bool, ...]:
        """For each piece, whether an end holds its angle at zero."""
        held = [False] * self.pieces
        held[0] |= self.boundary.left.holds_rotation
        held[-1] |= self.boundary.right.holds_rotation
        return tuple(held)

    @property
    def elastic_modes(self) -> int:
        """How many modes bend the chain: its hinges, less the end conditions that rigid motion cannot meet.

        The ends hold up to four of two deflections and two rotations. On a straight line's two freedoms
        these conditions have rank `2 - rigid_body_modes`; each further one ties the hinges to each other.
        """
        ends = (self.boundary.left, self.boundary.right)
        held = sum(end.holds_deflection + end.holds_rotation for end in ends)
        surplus = held - (2 - self.boundary.rigid_body_modes)
        return max(0, len(self.hinge_stiffness) - surplus)

    @cached_property
    def joint_stiffness(self) -> NDArray[np.float64]:
        """Rotational stiffness of every hinge, left to right, shape (hinges,) [N m/rad]."""
        return _scaled(self.hinge_stiffness, self.units.stiffness)

    @cached_property
    def length(self) -> NDArray[np.float64]:
        """Length of every piece, shape (pieces,) [m]."""
        return _scaled(self.piece_length, self.units.length)

    @cached_property
    def mass(self) -> NDArray[np.float64]:
        """Mass of every piece, shape (pieces,) [kg]."""
        return _scaled(self.piece_mass, self.units.mass)

    @cached_property
    def rotary_inertia(self) -> NDArray[np.float64]:
        """Rotary inertia of every piece about its middle, shape (pieces,) [kg m²]."""
        return _scaled(self.piece_rotary_inertia, self.units.mass * self.units.length**2)

    @cached_property
    def hinge_position(self) -> NDArray[np.float64]:
        """Distance of every hinge from the left end, shape (hinges,) [m]."""
        position = np.cumsum(self.length)[:-1]
        position.flags.writeable = False
        return position

    @cached_property
    def node_position(self) -> NDArray[np.float64]:
        """Distance of the left tip, every hinge and the right tip from the left end, shape (nodes,) [m]."""
        position = np.concatenate([[0.0], np.cumsum(self.length)])
        if self.beam is not None:
            # Summed lengths miss the beam's end by their rounding, and the exact beam has no shape beyond it.
            position[-1] = self.beam.length
            position = np.minimum(position, self.beam.length)
        position.flags.writeable = False
        return position

    def __repr__(self) -> str:
        by = f", segments={self.segments}, rule={self.rule.name!r}" if self.rule else ""
        return f"<Chain {self.boundary.name}: {self.pieces} pieces{by}>"


def _scaled(values: Sequence[Number], unit: float) -> NDArray[np.float64]:
    floats = {value: float(value) for value in set(values)}
    array = np.array([floats[value] for value in values], dtype=np.float64) * unit
    array.flags.writeable = False
    return array
