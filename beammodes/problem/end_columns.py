"""Many ends and boundaries as columns of numbers, for answers that are worked out over arrays."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Shown, kind_given, plain_array, real_numbers, shown
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import NUMBERS_OF_END, Boundary, End, ManyEnds, check_no_hub

__all__ = ["BoundaryColumns", "EndColumns", "Ends", "pairs_of_columns"]

_FIELDS = (*NUMBERS_OF_END, "on_segment")
_NUMBERS = attrgetter(*_FIELDS)


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
        given = cls.given(ends)
        return cls.moving(*(getattr(given, name) for name in _FIELDS))

    @classmethod
    def given(cls, ends: Iterable[End]) -> EndColumns:
        """Return the columns of ends as they are, with bodies that cannot move."""
        listed = list(ends)
        check_no_hub(*listed)
        rows = np.array([_NUMBERS(end) for end in listed], dtype=np.float64).reshape(-1, len(_FIELDS))
        k_t, k_r, mass, inertia, offset, on_segment = rows.T.copy()
        return cls(k_t, k_r, mass, inertia, offset, on_segment > 0)

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

    @classmethod
    def given(cls, boundaries: Iterable[Boundary]) -> BoundaryColumns:
        """Return the columns of boundaries as they are, with bodies that cannot move."""
        pairs = list(boundaries)
        return cls(EndColumns.given([p.left for p in pairs]), EndColumns.given([p.right for p in pairs]))

    @property
    def moving(self) -> BoundaryColumns:
        """The same without what supports hold still."""
        left, right = (
            EndColumns.moving(*(getattr(side, name) for name in _FIELDS)) for side in (self.left, self.right)
        )
        return BoundaryColumns(left, right)

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


class Ends(Shown, ManyEnds):
    """Many ends of a beam at once: what `End` takes, each a number or an array, broadcast together.

    Wherever a lookup over arrays takes a pair of ends, either of them can be such: a million ends cost no
    million objects.

    Parameters
    ----------
    translational_stiffness, rotational_stiffness, mass, rotary_inertia, offset : float or array of float
        As of `End`, in its units. `math.inf` holds.
    on_segment : bool or array of bool

    Raises
    ------
    TypeError, ValueError
        As `End`, or if shapes do not match.

    Examples
    --------
    >>> import beammodes as bm
    >>> tips = bm.Ends(mass=[0.0, 0.5, 1.0])                          # in ρA L
    >>> bm.frequency_error(("clamped", tips), segments=10, mode=1).round(6)
    array([-0.001259, -0.000367, -0.000213])
    """

    def __init__(
        self,
        translational_stiffness: Any = 0.0,
        rotational_stiffness: Any = 0.0,
        mass: Any = 0.0,
        rotary_inertia: Any = 0.0,
        offset: Any = 0.0,
        *,
        on_segment: Any = False,
    ) -> None:
        given = (translational_stiffness, rotational_stiffness, mass, rotary_inertia, offset)
        self.in_si = any(kind_given(each) is not None for each in given)
        numbers = [_number(name, value) for name, value in zip(NUMBERS_OF_END, given, strict=True)]
        flags = plain_array("on_segment", on_segment)
        if not all(isinstance(flag, bool) for flag in flags.ravel().tolist()):
            raise TypeError(f"on_segment must be True or False, or an array of them, got {shown(on_segment)}")
        flags = flags.astype(bool)
        try:
            *columns, flags = np.broadcast_arrays(*numbers, flags)
        except ValueError:
            shapes = zip((*NUMBERS_OF_END, "on_segment"), (*numbers, flags), strict=True)
            got = ", ".join(f"{name} {each.shape}" for name, each in shapes)
            raise ValueError(f"numbers of ends must broadcast together, got the shapes {got}") from None
        if (flags & np.isinf(columns[1])).any():
            raise ValueError("on_segment must be False where the end holds the rotation, got True")
        k_t, k_r, body, inertia, arm = columns
        self.columns = EndColumns(k_t, k_r, body, inertia, arm, flags)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of its arrays."""
        return self.columns.mass.shape

    def _line(self) -> str:
        return f"Ends(shape={self.shape})"


def _number(name: str, value: Any) -> Floats:
    array = real_numbers(name, value, finite=not name.endswith("stiffness")) + 0.0
    wrong = np.isnan(array) | ((array < 0.0) & (name != "offset"))
    if wrong.any():
        raise ValueError(f"{name} must not be negative, got {shown(float(array[wrong][0]))}")
    return array


def pairs_of_columns(boundary: Any) -> tuple[BoundaryColumns, tuple[int, ...]]:
    """Return the columns of a pair of ends of which one or both are `Ends`, flat, and their shape.

    Examples
    --------
    >>> columns, shape = pairs_of_columns(("clamped", Ends(mass=[[1.0], [2.0]])))
    >>> columns.right.mass, shape
    (array([1., 2.]), (2, 1))
    """
    # What stands beside them is read as in any pair.
    sides = [_side(side) for side in boundary]
    try:
        shape = np.broadcast_shapes(*(side.mass.shape for side in sides))
    except ValueError:
        shapes = ", ".join(str(side.mass.shape) for side in sides)
        raise ValueError(f"the two ends of boundary must broadcast together, got shapes {shapes}") from None
    flat = [
        EndColumns(*(np.broadcast_to(getattr(side, name), shape).ravel() for name in _FIELDS))
        for side in sides
    ]
    return BoundaryColumns(flat[0], flat[1]), shape


def _side(side: Any) -> EndColumns:
    if isinstance(side, Ends):
        return side.columns
    return EndColumns.given([Boundary.of((side, "free")).left]).take(0)
