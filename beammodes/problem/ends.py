"""The two ends of a beam: pairs by name, their canonical order, and the ten plain ones."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import bounded, choice, shown
from beammodes.problem.supports import ENDS, End, end_from_text

__all__ = [
    "BOUNDARIES",
    "ENDS",
    "Boundary",
    "BoundaryLike",
    "End",
    "NotPlain",
    "boundary_codes",
    "is_pair",
    "with_pairs_read",
]


class NotPlain(ValueError):
    """A pair of ends with springs or bodies where only the ten plain pairs are known."""


@dataclass(frozen=True, slots=True)
class Boundary:
    """The two ends of a beam, in the order in which its arrays run.

    Parameters
    ----------
    left, right : End
        The end at x = 0 and the end at x = L.

    Examples
    --------
    >>> Boundary.of("free/cantilever")
    Boundary('free-clamped')
    >>> Boundary.of("free/cantilever").canonical
    Boundary('clamped-free')
    """

    left: End
    right: End

    def __post_init__(self) -> None:
        for name, end in (("left", self.left), ("right", self.right)):
            if not isinstance(end, End):
                raise TypeError(f"{name} must be an End, got {shown(end)}; Boundary.of() reads names")

    @classmethod
    def of(cls, boundary: BoundaryLike) -> Boundary:
        """Return the boundary that a name, a pair of names or ends, or a `Boundary` stands for.

        Parameters
        ----------
        boundary : str, pair of str or End, or Boundary
            Such as "clamped-free", "cantilever/free" or ("clamped", "free"); either order. Numbers of an
            `End` may follow its word: "clamped-free(mass=0.5, rotary_inertia=0.01)".

        Raises
        ------
        TypeError, ValueError
            If it is none of these; the message lists the words and offers the nearest.

        Examples
        --------
        >>> Boundary.of(("pinned", "free")).name
        'pinned-free'
        """
        if isinstance(boundary, Boundary):
            return boundary
        parts: tuple[object, ...] = _split(boundary) if isinstance(boundary, str) else _pair(boundary)
        return cls(*(_end(part, boundary) for part in parts))

    @property
    def name(self) -> str:
        """The two ends in this boundary's own order, such as "clamped-free", readable by `of`."""
        return f"{self.left}-{self.right}"

    @property
    def canonical(self) -> Boundary:
        """The same pair with the firmer end first: how datasets and tables name it."""
        return self if _firmness(self.left) <= _firmness(self.right) else self.turned

    @property
    def turned(self) -> Boundary:
        """The same pair in the other order."""
        return Boundary(self.right, self.left)

    @property
    def is_plain(self) -> bool:
        """Whether both ends are no more than clamped, pinned, guided or free."""
        return self.left.word is not None and self.right.word is not None

    @property
    def rigid_body_modes(self) -> int:
        """How many independent transverse motions leave the beam straight (0, 1 or 2).

        Two supported quantities fix a straight line, unless both are rotations: those fix its slope twice.
        """
        ends = (self.left, self.right)
        deflections = sum(end.translational_stiffness > 0 for end in ends)
        slope = any(end.rotational_stiffness > 0 for end in ends)
        return 2 - min(2, deflections + slope)

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"Boundary({self.name!r})"


BoundaryLike = str | tuple[str | End, str | End] | Boundary

#: The ten pairs under their canonical names, in the order of their integer codes.
BOUNDARIES: tuple[Boundary, ...] = tuple(
    Boundary(left, right) for i, left in enumerate(ENDS.values()) for right in list(ENDS.values())[i:]
)
_CODES = {(pair.left.word, pair.right.word): code for code, pair in enumerate(BOUNDARIES)}


def boundary_codes(value: BoundaryLike | Iterable[BoundaryLike] | NDArray[Any]) -> NDArray[np.intp]:
    """Return indices into `BOUNDARIES`, of the shape of `value`.

    Parameters
    ----------
    value : boundary, or array or list of boundaries
        A pair of ends, such as ("clamped", End(mass=0.5)), is one boundary.

    Raises
    ------
    TypeError, ValueError
        As `Boundary.of`.

    Examples
    --------
    >>> boundary_codes(["clamped-free", "free-clamped"])
    array([3, 3])
    """
    value = with_pairs_read(value)
    if isinstance(value, str | Boundary):
        return np.asarray(_code(value), dtype=np.intp)
    if isinstance(value, np.ndarray) and value.dtype.kind == "U":
        names, inverse = np.unique(value, return_inverse=True)
        return np.array([_code(str(name)) for name in names], dtype=np.intp)[inverse].reshape(value.shape)
    listed = (
        bounded("boundary", value)
        if isinstance(value, Iterable) and not isinstance(value, np.ndarray | bytes | bytearray)
        else value
    )
    items = np.asarray(listed, dtype=object)
    return np.array([_code(item) for item in items.ravel()], dtype=np.intp).reshape(items.shape)


def is_pair(value: object) -> bool:
    """Whether `value` is one pair of ends: two words of ends or `End`s, and not two boundaries.

    Examples
    --------
    >>> [is_pair(value) for value in (("clamped", "free"), ("clamped-free", "free-free"), ["pinned", End()])]
    [True, False, True]
    """
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    return all(isinstance(item, End) or (isinstance(item, str) and len(_parts(item)) == 1) for item in value)


def with_pairs_read(value: Any) -> Any:
    """Return one boundary or several with each pair of ends, at any depth of lists, as a `Boundary`.

    Examples
    --------
    >>> with_pairs_read([("clamped", "free"), "pinned-pinned"])
    [Boundary('clamped-free'), 'pinned-pinned']
    """
    if is_pair(value):
        return Boundary.of(value)
    if isinstance(value, str | Boundary | End):
        return value
    if hasattr(value, "dtype") or not isinstance(value, tuple | list):
        # Boundary.of and boundary_codes say what is wrong with all else.
        return value
    return [_read_within(item) for item in bounded("boundary", value)]


def _read_within(item: Any) -> Any:
    """Return an item of several boundaries: more of them, or one, or raise what names the boundary."""
    several = isinstance(item, tuple | list) and not is_pair(item)
    return (
        with_pairs_read(item)
        if several or hasattr(item, "dtype") or isinstance(item, str)
        else Boundary.of(item)
    )


def _code(value: BoundaryLike) -> int:
    pair = Boundary.of(value).canonical
    words = (pair.left.word, pair.right.word)
    if None in words:
        raise NotPlain(
            f"boundary must be a pair of {', '.join(ENDS)} ends here, without springs or bodies, "
            f"got {shown(pair)}"
        )
    # A body that cannot move, or a clamped word with one, may have changed the order.
    return _CODES[words] if words in _CODES else _CODES[words[::-1]]


def _firmness(end: End) -> tuple[float | Fraction, ...]:
    """Return a key that sorts the firmer end first: clamped, pinned, guided, free among the plain ones."""
    supports = (-end.translational_stiffness, -end.rotational_stiffness)
    return (*supports, end.mass, end.rotary_inertia, end.offset, end.on_segment)


def _split(value: str) -> tuple[str, ...]:
    parts = _parts(value)
    if len(parts) != 2:
        _refuse(value)
    return parts


def _parts(value: str) -> tuple[str, ...]:
    # Only outside parentheses: numbers in them have signs and commas of their own.
    return tuple(re.split(r"[-/,](?![^(]*\))", value))


def _pair(value: object) -> tuple[object, ...]:
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise TypeError(
            'boundary must be a name such as "clamped-free", a pair of ends or a Boundary, '
            f"got {shown(value)}"
        )
    return tuple(value)


def _end(part: object, whole: object) -> End:
    if isinstance(part, End):
        return part
    if not isinstance(part, str):
        return ENDS[choice("each end of boundary", part, ENDS)]
    end = end_from_text(part)
    return end if end is not None else _refuse(whole)


def _refuse(value: object) -> NoReturn:
    """Raise the error for an unreadable boundary, with the nearest readable name."""
    either_order = [f"{a}-{b}" for a in ENDS for b in ENDS]
    text = "-".join(map(str, value)) if isinstance(value, tuple | list) else str(value)
    near = difflib.get_close_matches(text[:60].strip().lower().replace("/", "-"), either_order, n=1)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    raise ValueError(
        f'boundary must name two of the ends {", ".join(ENDS)}, such as "clamped-free", '
        f"got {shown(value)}{hint}"
    )
