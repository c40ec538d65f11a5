"""The two ends of a beam that twists or stretches: fixed, free, with a spring, a disc or a mass.

An end does one thing only, it turns about the axis or shifts along it, so two numbers tell all of it. Words
are "fixed" and "free", with numbers as "free(inertia=0.5)" in twist and "free(mass=0.5)" in stretch, and
"free(stiffness=2)" in both. "clamped" is "fixed" here, since a clamp holds everything; "pinned" and "guided"
say what bending may do and nothing of twist or stretch, so they are refused.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Shown, bounded, choice, distinct, kind_given, not_negative, shown
from beammodes.problem.ends import ENDS, Boundary, End, ends_in, is_pair
from beammodes.problem.motions import MOTIONS, Motion, motion_named

__all__ = ["AxialBoundary", "AxialBoundaryLike", "AxialEnd", "distinct_axial"]


@dataclass(frozen=True, slots=True, repr=False)
class AxialEnd(Shown):
    """One end of a beam that twists or stretches.

    Parameters
    ----------
    stiffness : float [N m/rad], [N/m]
        K of a spring between the end and the ground: `math.inf` fixes the end, 0 leaves it free.
    inertia : float [kg m²], [kg]
        J of a disc on the end about the beam's axis, or the mass of a body in stretch. Left out of a fixed
        end, which does not move.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, is negative, or is not finite (stiffness may be).

    Examples
    --------
    >>> print(AxialEnd(), AxialEnd(math.inf), AxialEnd(2.0, 0.5))
    free fixed free(stiffness=2.0, inertia=0.5)
    """

    stiffness: float = 0.0
    inertia: float = 0.0
    #: The motions in whose units its numbers came, "" of plain ones.
    in_si: str = field(default="", init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name, unit in (("stiffness", "N m or N/m"), ("inertia", "kg m2 or kg")):
            kind = kind_given(getattr(self, name))
            if kind is not None:
                object.__setattr__(self, "in_si", self.in_si + ("twist" if kind[1] else "stretch"))
            number = not_negative(name, getattr(self, name), unit, infinite=name == "stiffness")
            object.__setattr__(self, name, number)
        if self.is_fixed:
            object.__setattr__(self, "inertia", 0.0)

    @property
    def is_fixed(self) -> bool:
        """True if the end cannot move."""
        return self.stiffness == math.inf

    @property
    def is_free(self) -> bool:
        """True if nothing acts on the end."""
        return not self.stiffness and not self.inertia

    @property
    def statics(self) -> str:
        """The word in bending whose weights of a rule apply here: by what the beam feels at this end.

        With T the torque or axial force, f = T² is what a rule's quadrature has to integrate:

        =======  ====================================  ===============================================
        word     what the beam feels                   what a chain has there
        =======  ====================================  ===============================================
        free     T = 0 (a free end)                    no hinge at the end
        guided   T' = 0 (a fixed end: -k T' = ω² m u)  the rule's guided weights
        clamped  T and T' (a spring, a disc or mass)   a hinge at the end, the rule's clamped weights
        =======  ====================================  ===============================================
        """
        return "guided" if self.is_fixed else "free" if self.is_free else "clamped"

    @property
    def stand_in(self) -> End:
        """The end in bending at which a rule lays out hinges as it does at this one."""
        return End(rotational_stiffness=1.0) if self.statics == "clamped" else ENDS[self.statics]

    def named(self, body: str = "inertia") -> str:
        """Return the end as text, the inertia of its body under this name."""
        if self.is_fixed:
            return "fixed"
        told = [("stiffness", self.stiffness), (body, self.inertia)]
        numbers = ", ".join(f"{name}={value!r}" for name, value in told if value)
        return f"free({numbers})" if numbers else "free"

    def __str__(self) -> str:
        return self.named()


@dataclass(frozen=True, slots=True, repr=False)
class AxialBoundary(Shown):
    """The two ends of a beam that twists or stretches, in the order in which its arrays run.

    Parameters
    ----------
    left, right : AxialEnd
    motion : str
        "twist" or "stretch".

    Examples
    --------
    >>> print(AxialBoundary.of("fixed-free(inertia=0.5)", "twist"))
    fixed-free(inertia=0.5)
    >>> AxialBoundary.of("clamped-free(mass=0.5)", "stretch")
    AxialBoundary('fixed-free(mass=0.5)', motion='stretch')
    """

    left: AxialEnd
    right: AxialEnd
    motion: str = "twist"

    def __post_init__(self) -> None:
        for name, end in (("left", self.left), ("right", self.right)):
            if not isinstance(end, AxialEnd):
                raise TypeError(f"{name} must be an AxialEnd, got {shown(end)}; AxialBoundary.of reads names")
            if end.in_si.replace(axial_motion(self.motion).name, ""):
                raise TypeError(f"{name} must be in units of {self.motion}, got those of {end.in_si}: {end}")
        axial_motion(self.motion)

    @classmethod
    def of(cls, boundary: AxialBoundaryLike, motion: str | Motion = "twist") -> AxialBoundary:
        """Return the ends that a name, a pair of names or ends, or an `AxialBoundary` stands for.

        Raises
        ------
        TypeError, ValueError
            If it is none of these, or `motion` is not "twist" or "stretch"; the message offers the nearest.

        Examples
        --------
        >>> AxialBoundary.of(("free", AxialEnd(stiffness=2.0))).name
        'free-free(stiffness=2.0)'
        """
        kind = axial_motion(motion)
        if isinstance(boundary, AxialBoundary):
            if boundary.motion == kind.name:
                return boundary
            if not all(end.is_fixed or end.is_free for end in (boundary.left, boundary.right)):
                raise ValueError(
                    f"boundary must be one of {kind.name} where it has springs or bodies, with other units, "
                    f"got {shown(boundary)}"
                )
            return cls(boundary.left, boundary.right, kind.name)
        whole: object = boundary
        if isinstance(boundary, Boundary):
            whole, boundary = boundary.name, (boundary.left, boundary.right)
        if isinstance(boundary, str):
            parts: tuple[object, ...] = ends_in(boundary)
        elif isinstance(boundary, tuple | list):
            parts = tuple(boundary)
        else:
            raise TypeError(
                'boundary must be a name such as "fixed-free", a pair of ends or an AxialBoundary, '
                f"got {shown(boundary)}"
            )
        if len(parts) != 2:
            _refuse(whole, kind)
        left, right = (_end(part, whole, kind) for part in parts)
        return cls(left, right, kind.name)

    @property
    def name(self) -> str:
        """The two ends in this boundary's own order, readable by `of`."""
        body = MOTIONS[self.motion].body
        return f"{self.left.named(body)}-{self.right.named(body)}"

    @property
    def canonical(self) -> AxialBoundary:
        """The same pair with the firmer end first: how datasets and tables name it."""
        keys = [(-end.stiffness, end.inertia) for end in (self.left, self.right)]
        return self if keys[0] <= keys[1] else AxialBoundary(self.right, self.left, self.motion)

    @property
    def rigid_body_modes(self) -> int:
        """1 if nothing ties the beam to the ground, else 0."""
        return int(not self.left.stiffness and not self.right.stiffness)

    @property
    def stand_in(self) -> Boundary:
        """The boundary in bending for which a rule lays out hinges as it does for this one."""
        return Boundary(self.left.stand_in, self.right.stand_in)

    def scaled(self, stiffness: float, inertia: float) -> AxialBoundary:
        """Return the ends with both numbers in multiples of these."""
        left, right = (
            AxialEnd(end.stiffness / stiffness, end.inertia / inertia) for end in (self.left, self.right)
        )
        return AxialBoundary(left, right, self.motion)

    def __str__(self) -> str:
        return self.name

    def _line(self) -> str:
        return f"AxialBoundary({self.name!r}, motion={self.motion!r})"


AxialBoundaryLike = str | tuple[Any, Any] | AxialBoundary | Boundary


def axial_motion(motion: str | Motion) -> Motion:
    """Return the record of "twist" or "stretch".

    Examples
    --------
    >>> axial_motion("stretch").body
    'mass'
    """
    record = motion_named(motion)
    if not record.along:
        raise ValueError(f"motion must be twist or stretch here, got {shown(record.name)}")
    return record


def distinct_axial(boundary: Any, motion: str | Motion) -> tuple[list[AxialBoundary], NDArray[np.intp]]:
    """Return what one boundary or an array of them stands for, each once, and places in it, of its shape.

    Examples
    --------
    >>> distinct_axial(["fixed-free", "free-free", "clamped-free"], "twist")[1]
    array([0, 1, 0])
    """
    if isinstance(boundary, str):
        return [_named(boundary, axial_motion(motion).name)], np.asarray(0)
    if _is_one(boundary):
        return [AxialBoundary.of(boundary, motion)], np.asarray(0)
    items = boundary if isinstance(boundary, np.ndarray) else _objects(bounded("boundary", boundary))
    return distinct("boundary", items, (), lambda item: AxialBoundary.of(item, motion))


@lru_cache(maxsize=1024)
def _named(text: str, motion: str) -> AxialBoundary:
    return AxialBoundary.of(text, motion)


def _is_one(value: Any) -> bool:
    """Return True for one boundary: a name, a record, or a pair of two words of ends or ends."""
    if isinstance(value, str | Boundary | AxialBoundary) or not isinstance(value, Iterable):
        return True
    return is_pair(value, (AxialEnd, End))


def _objects(values: list[Any]) -> NDArray[Any]:
    """Return values, and nested lists of them, as an array of objects, a pair of ends as one."""

    def shape_of(value: Any) -> tuple[int, ...]:
        if _is_one(value):
            return ()
        return (len(value), *(shape_of(value[0]) if len(value) else ()))

    shape = (len(values), *(shape_of(values[0]) if values else ()))
    array, flat = np.empty(shape, dtype=object), values
    for _ in shape[1:]:
        flat = [item for part in flat for item in (part if not _is_one(part) else [part])]
    if len(flat) != array.size:
        raise TypeError(f"boundary must be one regular array, got {shown(values)}")
    for k, item in enumerate(flat):
        array.flat[k] = item
    return array


_WORDS = {"fixed": math.inf, "clamped": math.inf, "cantilever": math.inf, "free": 0.0}


def _end(part: object, whole: object, motion: Motion) -> AxialEnd:
    if isinstance(part, AxialEnd):
        return part
    if isinstance(part, End):
        word = part.word
        if word in ("pinned", "guided"):
            _refuse(whole, motion)
        if word not in _WORDS:
            raise ValueError(
                f"each end of boundary must be an AxialEnd for motion {motion.name}, got {shown(part)}: an "
                f"End is one of bending, AxialEnd(stiffness=, inertia=) has the numbers of {motion.name}"
            )
        return AxialEnd(_WORDS[str(word)])
    if not isinstance(part, str):
        raise TypeError(f"each end of boundary must be a word or an AxialEnd, got {shown(part)}")
    match = re.fullmatch(r"\s*([a-z]+)\s*(?:\(([^()]*)\))?\s*", part.lower())
    if match is None or match[1] not in _WORDS:
        _refuse(whole, motion)
    numbers = {"stiffness": _WORDS[match[1]]}
    for piece in (match[2] or "").split(",") if match[2] else []:
        name, _, value = (text.strip() for text in piece.partition("="))
        choice("number of an end", name, ("stiffness", motion.body))
        field = "inertia" if name == motion.body else name
        if numbers.get(field):
            raise ValueError(
                f"{name} of an end must be given once, and not of a fixed one, got {shown(part)}"
            )
        try:
            numbers[field] = float(value)
        except ValueError:
            raise ValueError(f"{name} must be a number, got {shown(value)}") from None
    return AxialEnd(**numbers)


def _refuse(value: object, motion: Motion) -> NoReturn:
    text = "-".join(map(str, value)) if isinstance(value, tuple | list) else str(value)
    named = [f"{a}-{b}" for a in ("fixed", "free") for b in ("fixed", "free")]
    near = difflib.get_close_matches(text[:60].strip().lower().replace("/", "-"), named, n=1, cutoff=0.4)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    bends = re.search("pinned|hinged|guided|sliding", text.lower())
    why = f"; {bends[0]} says what bending may do, not {motion.name}" if bends else ""
    raise ValueError(
        f'boundary must name two of the ends fixed, free for motion {motion.name}, such as "fixed-free" or '
        f'"fixed-free({motion.body}=0.5)", got {shown(value)}{hint}{why}'
    )
