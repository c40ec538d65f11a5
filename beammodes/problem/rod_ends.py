"""The ends of a rod in space: what holds each of six motions, and the rigid body fixed to it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from beammodes.checks import Shown, flag, not_negative, real, shown, unwrapped
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix
from beammodes.problem.ends import ENDS, Boundary, End, check_no_hub, end_of, pair_of

__all__ = ["RodBoundaryLike", "RodEnd", "RodEnds"]

Three = tuple[float, float, float]
Tensor = tuple[Three, Three, Three]


@dataclass(frozen=True, slots=True, init=False, repr=False)
class RodEnd(Shown):
    """One end of a rod: supports of its deflection and rotation in three directions, and a rigid body.

    All directions are those of the section's axes at that end, at rest: x along the centre line, y and z
    across it. A number stands for all three.

    Parameters
    ----------
    translational_stiffness : float or three [N/m]
        Of springs between the end and the ground, along x, y and z: `math.inf` holds, 0 leaves free.
    rotational_stiffness : float or three [N m/rad]
        Likewise about x (twist), y and z (bending).
    mass : float [kg]
        Of a rigid body fixed to the end.
    rotary_inertia : float, three, or three rows of three [kg m²]
        Of that body about its centre of mass: about every axis, about x, y and z, or the whole tensor.
    offset : three floats [m]
        From the end to the body's centre of mass.
    on_segment : bool
        Whether a chain has the body and the rotational springs on its outermost segment, as `End.on_segment`,
        and not behind a hinge of the end's own.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, is negative (of an offset it may be) or not finite (stiffnesses may be), or
        the tensor is not symmetric and positive, or of no body: about one axis more than about the two across
        it together.

    Examples
    --------
    >>> RodEnd.of("pinned").rotational_stiffness                           # a ball joint
    (0.0, 0.0, 0.0)
    >>> RodEnd(mass=0.5, offset=(0.1, 0, 0)).offset
    (0.1, 0.0, 0.0)
    """

    translational_stiffness: Three = (0.0, 0.0, 0.0)
    rotational_stiffness: Three = (0.0, 0.0, 0.0)
    mass: float = 0.0
    rotary_inertia: Tensor = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    offset: Three = (0.0, 0.0, 0.0)
    on_segment: bool = False

    def __init__(
        self,
        translational_stiffness: float | Sequence[float] = 0.0,
        rotational_stiffness: float | Sequence[float] = 0.0,
        mass: float = 0.0,
        rotary_inertia: float | Sequence[Any] = 0.0,
        offset: Sequence[float] = (0.0, 0.0, 0.0),
        *,
        on_segment: bool = False,
    ) -> None:
        for name, given in (
            ("translational_stiffness", translational_stiffness),
            ("rotational_stiffness", rotational_stiffness),
        ):
            object.__setattr__(self, name, _each(name, given, infinite=True))
        object.__setattr__(self, "mass", not_negative("mass", mass))
        object.__setattr__(self, "rotary_inertia", _tensor(rotary_inertia))
        object.__setattr__(self, "offset", _triple("offset", offset))
        object.__setattr__(self, "on_segment", flag("on_segment", on_segment))

    @classmethod
    def of(cls, end: object, *, side: int = 1) -> RodEnd:
        """Return the end that a word, an `End` of a planar beam, or a `RodEnd` stands for.

        ========  ==========================================================
        clamped   all six held
        pinned    a ball joint: the deflections held
        guided    the rotations and what is along the rod held
        free      none held
        ========  ==========================================================

        The numbers of an `End` count in both planes, its rotational ones in twist too; its offset is outward,
        which `side` tells: 1 at the right end, -1 at the left one.

        Examples
        --------
        >>> RodEnd.of("free(mass=0.5, offset=0.1)", side=-1).offset
        (-0.1, 0.0, 0.0)
        """
        return cls._read(end, end, side)

    @classmethod
    def _read(cls, end: object, whole: object, side: int) -> RodEnd:
        """Return what an end stands for; `whole` is shown if it is unreadable."""
        if isinstance(end, RodEnd):
            return end
        plain = end_of(end, whole)
        check_no_hub(plain)
        across, turning = float(plain.translational_stiffness), float(plain.rotational_stiffness)
        along = math.inf if plain.is_grounded and (plain.holds_deflection or plain.holds_rotation) else across
        inertia = float(plain.rotary_inertia)
        offset = (side * float(plain.offset), 0.0, 0.0)
        supports = ((along, across, across), turning)
        return cls(*supports, float(plain.mass), inertia, offset, on_segment=plain.on_segment)

    def with_supports(self, translational: Sequence[float], rotational: Sequence[float]) -> RodEnd:
        """Return the end with other supports and the same body."""
        body = (self.mass, self.rotary_inertia, self.offset)
        return RodEnd(translational, rotational, *body, on_segment=self.on_segment)

    @property
    def stiffness(self) -> Floats:
        """The six stiffnesses, of the deflections first."""
        return np.array([*self.translational_stiffness, *self.rotational_stiffness])

    @property
    def mass_matrix(self) -> Floats:
        """Of the body, for deflection and rotation of the end, shape (6, 6)."""
        arm = cross_matrix(np.array(self.offset))
        matrix = np.zeros((6, 6))
        matrix[:3, :3] = self.mass * np.eye(3)
        matrix[3:, :3] = self.mass * arm
        matrix[:3, 3:] = -self.mass * arm
        matrix[3:, 3:] = np.array(self.rotary_inertia) - self.mass * arm @ arm
        return matrix

    @property
    def has_body(self) -> bool:
        """True if a body is fixed to the end."""
        return bool(self.mass_matrix.any())

    def word(self, axis: int, *, alone: bool) -> str:
        """Return whose rule weights apply to turning about an axis (0 to 2) here, as `End.statics` does.

        `alone` says that nothing couples this turning with others along the rod (straight, no pretwist in
        bending): only then does a held rotation without a shear force have a mirror.
        """
        held = self.rotational_stiffness[axis]
        felt = self.mass_matrix[3 + axis, 3:].any()
        if not held and not felt:
            # Which of the two makes no difference to a rule: no moment, no hinge at the end.
            return "free"
        if self.on_segment and not math.isinf(held):
            return "carried"
        # The deflection that bends about this axis go along with; twist has none.
        across = self.translational_stiffness[3 - axis] if axis else 0.0
        shearless = math.isinf(held) and not across and not (axis and self.mass)
        return "guided" if alone and shearless else "clamped"

    def _line(self) -> str:
        given = {
            "translational_stiffness": _short(self.translational_stiffness, 0.0),
            "rotational_stiffness": _short(self.rotational_stiffness, 0.0),
            "mass": self.mass or None,
            "rotary_inertia": self._inertia_shown(),
            "offset": self.offset if any(self.offset) else None,
            "on_segment": self.on_segment or None,
        }
        return f"RodEnd({', '.join(f'{k}={v!r}' for k, v in given.items() if v is not None)})"

    def _inertia_shown(self) -> Any:
        tensor = np.array(self.rotary_inertia)
        if (tensor == np.diag(np.diagonal(tensor))).all():
            x, y, z = np.diagonal(tensor).tolist()
            return _short((x, y, z), 0.0)
        return self.rotary_inertia


def _short(three: Three, usual: float) -> float | Three | None:
    if three[0] == three[1] == three[2]:
        return None if three[0] == usual else three[0]
    return three


def _triple(name: str, given: object) -> Three:
    """Return three numbers along x, y and z, of either sign."""
    x, y, z = (real(name, value) + 0.0 for value in _three_of(name, given))
    return x, y, z


def _each(name: str, given: object, *, infinite: bool = False) -> Three:
    """Return three numbers that are not negative; one stands for all three."""
    values = _listed(name, given)
    three = _three_of(name, values) if isinstance(values, list | tuple) else [values] * 3
    x, y, z = (not_negative(name, value, infinite=infinite) for value in three)
    return x, y, z


def _listed(name: str, given: object) -> Any:
    plain = unwrapped(name, given)
    return plain.tolist() if isinstance(plain, np.ndarray) else plain


def _three_of(name: str, given: object) -> Sequence[object]:
    values = _listed(name, given)
    if not isinstance(values, list | tuple):
        raise TypeError(f"{name} must be three numbers, along x, y and z, got {shown(given)}")
    if len(values) != 3:
        raise ValueError(f"{name} must be three numbers, along x, y and z, got {shown(given)}")
    return values


def _tensor(given: object) -> Tensor:
    rows = _listed("rotary_inertia", given)
    if isinstance(rows, list | tuple) and len(rows) == 3 and isinstance(rows[0], list | tuple):
        x, y, z = (_triple("rotary_inertia", row) for row in rows)
        matrix = np.array([x, y, z])
        if not (matrix == matrix.T).all() or np.linalg.eigvalsh(matrix)[0] < -1e-12 * np.abs(matrix).max():
            raise ValueError(f"rotary_inertia must be symmetric and positive, got {shown(given)}")
        _check_possible(np.linalg.eigvalsh(matrix), given)
        return x, y, z
    a, b, c = _each("rotary_inertia", given)
    _check_possible(np.sort([a, b, c]), given)
    return (a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)


def _check_possible(principal: Floats, given: object) -> None:
    """Refuse inertias, ascending, of which one exceeds the other two together: no masses have them."""
    if principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-9):
        raise ValueError(
            "rotary_inertia must be that of a body, about no axis more than about the others together, "
            f"got {shown(given)}, about its principal axes {', '.join(f'{value:.6g}' for value in principal)}"
        )


@dataclass(frozen=True, slots=True, repr=False)
class RodEnds(Shown):
    """The two ends of a rod, at s = 0 and at s = L.

    Examples
    --------
    >>> straight = (np.eye(3), np.array([1.0, 0.0, 0.0]))
    >>> [RodEnds.of(name).rigid_body_modes(*straight) for name in ("clamped-free", "pinned-pinned")]
    [0, 1]
    """

    left: RodEnd
    right: RodEnd

    def __post_init__(self) -> None:
        for name, end in (("left", self.left), ("right", self.right)):
            if not isinstance(end, RodEnd):
                raise TypeError(
                    f"{name} must be a RodEnd, got {shown(end)}: RodEnds.of takes words and planar ends"
                )

    @classmethod
    def of(cls, boundary: RodBoundaryLike) -> RodEnds:
        """Return the ends that a name such as "clamped-free", a pair of ends or `RodEnds` stands for.

        Raises
        ------
        TypeError, ValueError
            As `Boundary.of`.
        """
        if isinstance(boundary, RodEnds):
            return boundary
        if isinstance(boundary, str | Boundary):
            pair = Boundary.of(boundary)
            boundary = (pair.left, pair.right)
        left, right = pair_of(boundary)
        return cls(RodEnd._read(left, boundary, -1), RodEnd._read(right, boundary, 1))

    def rigid_body_modes(self, frame: Floats, place: Floats) -> int:
        """Return how many motions of a rigid rod the ends let go without storing energy.

        Parameters
        ----------
        frame : ndarray, shape (3, 3)
            The right end's axes, seen from the left end.
        place : ndarray, shape (3,)
            Where it lies, over the rod's length.
        """
        left, right = np.eye(6), np.zeros((6, 6))
        right[:3, :3] = right[3:, 3:] = frame.T
        right[:3, 3:] = -frame.T @ cross_matrix(place)
        rows = np.vstack([left[self.left.stiffness > 0], right[self.right.stiffness > 0]])
        return 6 - int(np.linalg.matrix_rank(rows, tol=1e-9)) if len(rows) else 6

    def __str__(self) -> str:
        return f"{_told(self.left)}-{_told(self.right)}"


def _told(end: RodEnd) -> str:
    words = [word for word in ENDS if end == RodEnd.of(word)]
    return words[0] if words else repr(end)


#: What stands for the two ends of a rod.
RodBoundaryLike: TypeAlias = str | tuple[str | End | RodEnd, str | End | RodEnd] | Boundary | RodEnds
