"""The numbers of a chain: in its own units, where they may be exact, and in physical ones, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.pieces import Number, Pieces
from beammodes.chains.repeated import floats
from beammodes.chains.units import Units

__all__ = ["ChainNumbers"]


@dataclass(frozen=True)
class ChainNumbers:
    """Pieces, springs and supports of a chain, and the units in which they are kept."""

    pieces_and_springs: Pieces
    units: Units

    @property
    def piece_length(self) -> tuple[Number, ...]:
        """Length of every piece, in own units."""
        return self.pieces_and_springs.length

    @property
    def piece_mass(self) -> tuple[Number, ...]:
        """Mass of every piece, its end body included, in own units."""
        return self.pieces_and_springs.mass

    @property
    def piece_centre(self) -> tuple[Number, ...]:
        """Centre of mass of every piece, from its left tip, in own units."""
        return self.pieces_and_springs.centre

    @property
    def piece_rotary_inertia(self) -> tuple[Number, ...]:
        """Rotary inertia of every piece about its centre of mass, in own units."""
        return self.pieces_and_springs.rotary_inertia

    @property
    def hinge_stiffness(self) -> tuple[Number, ...]:
        """Spring of every hinge, in own units."""
        return self.pieces_and_springs.joint_stiffness

    @property
    def supports(self) -> tuple[tuple[Number, Number], tuple[Number, Number]]:
        """(K_t, K_r) of the left and the right end on its outer piece, in own units; inf where it holds.

        K_r is the end's own, or that in series with the hinge of an outer piece that had nothing to move.
        """
        return self.pieces_and_springs.supports

    @property
    def pieces(self) -> int:
        """How many pieces the chain has, zero-length outer ones included."""
        return len(self.piece_length)

    @cached_property
    def joint_stiffness(self) -> NDArray[np.float64]:
        """Rotational stiffness of every hinge, left to right, shape (hinges,) [N m/rad]."""
        return _scaled(self.hinge_stiffness, self.units.stiffness)

    @cached_property
    def support_stiffness(self) -> NDArray[np.float64]:
        """Stiffness of the ends' supports on the outer pieces, inf where held, shape (2, 2) [N/m, N m/rad].

        Rows are the left and the right end. A rotational one is the end's own, in series with the wall's
        hinge where nothing in between has inertia: that hinge is then missing among `joint_stiffness`.
        """
        unit = np.array([self.units.stiffness / self.units.length**2, self.units.stiffness])
        stiffness: NDArray[np.float64] = np.array([[float(k) for k in end] for end in self.supports]) * unit
        stiffness.flags.writeable = False
        return stiffness

    @cached_property
    def length(self) -> NDArray[np.float64]:
        """Length of every piece, shape (pieces,) [m]."""
        return _scaled(self.piece_length, self.units.length)

    @cached_property
    def mass(self) -> NDArray[np.float64]:
        """Mass of every piece, shape (pieces,) [kg]."""
        return _scaled(self.piece_mass, self.units.mass)

    @cached_property
    def centre(self) -> NDArray[np.float64]:
        """Centre of mass of every piece, from its left tip, shape (pieces,) [m]."""
        return _scaled(self.piece_centre, self.units.length)

    @cached_property
    def rotary_inertia(self) -> NDArray[np.float64]:
        """Rotary inertia of every piece about its centre of mass, shape (pieces,) [kg m²]."""
        return _scaled(self.piece_rotary_inertia, self.units.mass * self.units.length**2)

    @cached_property
    def hinge_position(self) -> NDArray[np.float64]:
        """Distance of every hinge from the left end, shape (hinges,) [m]."""
        position = np.cumsum(self.length)[:-1]
        position.flags.writeable = False
        return position


def _scaled(values: Sequence[Number], unit: float) -> NDArray[np.float64]:
    array = floats(values) * unit
    array.flags.writeable = False
    return array
