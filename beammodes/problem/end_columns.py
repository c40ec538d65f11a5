"""Many ends and boundaries as columns of numbers, for answers that are worked out over arrays."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import NUMBERS_OF_END, Boundary, End

__all__ = ["BoundaryColumns", "EndColumns"]

_NUMBERS = attrgetter(*NUMBERS_OF_END, "on_segment")


@dataclass(frozen=True, slots=True, eq=False)
class EndColumns:
    """Ends: the numbers of `End`, an array each, all of one shape.

    Stiffnesses are infinite where they hold. Bodies are `End.moving_body`, what the supports let move: so
    an end that holds all has none.
    """

    translational_stiffness: Floats
    rotational_stiffness: Floats
    mass: Floats
    rotary_inertia: Floats
    offset: Floats
    on_segment: NDArray[np.bool_]

    @classmethod
    def of(cls, ends: Iterable[End]) -> EndColumns:
        """Return the columns of ends, of one dimension.

        Examples
        --------
        >>> ends = EndColumns.of([End(mass=2, offset=0.5), End(float("inf"), mass=1, rotary_inertia=3)])
        >>> ends.mass, ends.rotary_inertia                 # a pinned body without an offset only turns
        (array([2., 0.]), array([0., 3.]))
        """
        rows = np.array([_NUMBERS(end) for end in ends], dtype=np.float64).reshape(-1, 6)
        k_t, k_r, mass, inertia, offset, on_segment = rows.T.copy()
        return cls.moving(k_t, k_r, mass, inertia, offset, on_segment > 0)

    @classmethod
    def moving(
        cls,
        translational_stiffness: Floats,
        rotational_stiffness: Floats,
        mass: Floats,
        rotary_inertia: Floats,
        offset: Floats,
        on_segment: NDArray[np.bool_],
    ) -> EndColumns:
        """Return the columns of numbers of `End` as given, without what the supports hold still."""
        holds, held = np.isinf(translational_stiffness), np.isinf(rotational_stiffness)
        mass = np.where(holds & (held | (offset == 0)), 0.0, mass)
        inertia = np.where(held, 0.0, rotary_inertia)
        offset = np.where(held | (mass == 0), 0.0, offset)
        return cls(translational_stiffness, rotational_stiffness, mass, inertia, offset, on_segment)

    def end(self, index: Any) -> End:
        """Return one of the ends."""
        numbers = {name: float(getattr(self, name)[index]) for name in NUMBERS_OF_END}
        # Rigid is one object, which `End` looks for.
        held = {name: math.inf if number == math.inf else number for name, number in numbers.items()}
        return End(**held, on_segment=bool(self.on_segment[index]))

    def take(self, index: Any) -> EndColumns:
        """Return the ends that an index, a mask or a slice picks."""
        return EndColumns(
            self.translational_stiffness[index],
            self.rotational_stiffness[index],
            self.mass[index],
            self.rotary_inertia[index],
            self.offset[index],
            self.on_segment[index],
        )


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryColumns:
    """Pairs of ends: the left ones and the right ones."""

    left: EndColumns
    right: EndColumns

    @classmethod
    def of(cls, boundaries: Boundary | Iterable[Boundary]) -> BoundaryColumns:
        """Return the columns of one boundary or several, of one dimension.

        Examples
        --------
        >>> BoundaryColumns.of(Boundary.of("clamped-free(mass=0.5)")).right.mass
        array([0.5])
        """
        pairs = [boundaries] if isinstance(boundaries, Boundary) else list(boundaries)
        return cls(EndColumns.of([p.left for p in pairs]), EndColumns.of([p.right for p in pairs]))

    def __len__(self) -> int:
        return len(self.left.mass)

    def boundary(self, index: Any) -> Boundary:
        """Return one of the pairs.

        Examples
        --------
        >>> BoundaryColumns.of(Boundary.of("clamped-free(mass=0.5)")).boundary(0)
        Boundary('clamped-free(mass=0.5)')
        """
        return Boundary(self.left.end(index), self.right.end(index))

    def take(self, index: Any) -> BoundaryColumns:
        """Return the pairs that an index, a mask or a slice picks.

        Examples
        --------
        >>> pairs = BoundaryColumns.of(map(Boundary.of, ("clamped-free", "pinned-free(mass=2)")))
        >>> pairs.take(np.array([1, 1, 0])).right.mass
        array([2., 2., 0.])
        """
        return BoundaryColumns(self.left.take(index), self.right.take(index))
