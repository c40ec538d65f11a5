"""The two ends of a beam: pairs by name, their canonical order, and the ten plain ones."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Catalogue, Shown, bounded, choice, distinct, kind_given, real, shown, unwrapped

__all__ = [
    "BOUNDARIES",
    "ENDS",
    "NUMBERS_OF_END",
    "Boundary",
    "BoundaryLike",
    "End",
    "ManyEnds",
    "ManyPairs",
    "NotPlain",
    "boundary_code",
    "boundary_codes",
    "check_no_hub",
    "end_from_text",
    "end_of",
    "ends_in",
    "has_many",
    "is_pair",
    "pair_of",
    "with_pairs_read",
]


# One end of a beam: what holds it, and the rigid body fixed to it.

#: The numbers of an `End`, in its order.
NUMBERS_OF_END = ("translational_stiffness", "rotational_stiffness", "mass", "rotary_inertia", "offset")


_SUPPORTS = NUMBERS_OF_END[:2]


@dataclass(frozen=True, repr=False)
class End(Shown):
    """One end of a beam: supports of its deflection and rotation, and a rigid body fixed to it.

    With y and θ the end's deflection and rotation and a the offset, it stores and carries

        ½ K_t y² + ½ K_r θ²,        ½ m (y' ± a θ')² + ½ J θ'²    (+ at the right end).

    A hub that turns freely is a pinned end whose axis lies `hub_radius` beyond it; `End.hub` makes one.
    `ENDS` holds the four special ones: clamped, pinned, guided and free. Numbers given as `Fraction`
    stay exact in the chain.

    Parameters
    ----------
    translational_stiffness : float [N/m]
        K_t of a spring between the end and the ground, across the beam: `math.inf` holds the deflection,
        0 leaves it free.
    rotational_stiffness : float [N m/rad]
        K_r likewise, of the rotation.
    mass : float [kg]
        m of a rigid body fixed to the end. Where the end holds the beam across and the body has no offset,
        its mass is left out, along the beam too: spin and weight do not pull on it, nor does a motion.
    rotary_inertia : float [kg m²]
        J of that body about its centre of mass.
    offset : float [m]
        a, how far beyond the end, along the beam and outward, the body's centre of mass lies.
    on_segment : bool
        Where a chain puts the body and the rotational spring of an end that may turn; the beam is the same.
        False: behind a hinge of the end's own, with the springs of a clamped end. True: on the outermost
        segment itself, without a hinge, as a gripper is welded to a robot's last link. See `statics`.
    hub_radius : float [m]
        R, how far beyond the end, along the beam and outward, lies the axis about which the end turns: what
        is held is  y ± R θ. Only where the end holds the deflection and not the rotation, with a rotary
        inertia.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, is negative (`offset` may be), or is not finite (stiffnesses may be), if
        `on_segment` is not a bool, or is True where the end holds the rotation; if there is a hub's radius
        without an axis, or without inertia.

    Examples
    --------
    >>> End(translational_stiffness=math.inf) == ENDS["pinned"]
    True
    >>> print(End(mass=0.5, offset=0.1))
    free(mass=0.5, offset=0.1)
    >>> End(mass=0.5, offset=0.1).statics, End(mass=0.5, offset=0.1, on_segment=True).statics
    ('clamped', 'carried')
    """

    translational_stiffness: float | Fraction = 0.0
    rotational_stiffness: float | Fraction = 0.0
    mass: float | Fraction = 0.0
    rotary_inertia: float | Fraction = 0.0
    offset: float | Fraction = 0.0
    on_segment: bool = field(default=False, kw_only=True)
    hub_radius: float | Fraction = field(default=0.0, kw_only=True)
    #: Whether a number came with a unit, so that it is no multiple of a beam's own.
    in_si: bool = field(default=False, init=False, repr=False, compare=False)

    @classmethod
    def hub(
        cls,
        hub_radius: float | Fraction,
        rotary_inertia: float | Fraction,
        rotational_stiffness: float | Fraction = 0.0,
    ) -> End:
        """Return a hub that turns about its axis, with the beam standing out from its rim, clamped to it.

        Parameters
        ----------
        hub_radius : float [m]
            From the axis to the beam's end.
        rotary_inertia : float [kg m²]
            Of the hub, about its axis.
        rotational_stiffness : float [N m/rad]
            Of a spring that holds the hub to the ground, such as a servo's; the hub turns freely without.

        Raises
        ------
        TypeError, ValueError
            As `End`.

        Examples
        --------
        >>> print(End.hub(hub_radius=1.0, rotary_inertia=5.0))
        pinned(rotary_inertia=5.0, hub_radius=1.0)
        """
        return cls(math.inf, rotational_stiffness, rotary_inertia=rotary_inertia, hub_radius=hub_radius)

    def __post_init__(self) -> None:
        for name in (*NUMBERS_OF_END, "hub_radius"):
            given = getattr(self, name)
            value = unwrapped(name, given)
            if kind_given(given) is not None:
                object.__setattr__(self, "in_si", True)
            held = name.endswith("stiffness") and isinstance(value, float) and value == math.inf
            number = math.inf if held else real(name, value)
            if value and not number:
                raise ValueError(f"{name} must be within the range of floats, got {shown(value)}")
            if number < 0.0 and name != "offset":
                raise ValueError(f"{name} must not be negative, got {shown(value)}")
            # A minus sign on zero would make two names of one end.
            kept = value if isinstance(value, Fraction) else number + 0.0
            object.__setattr__(self, name, kept)
        if not isinstance(self.on_segment, bool):
            raise TypeError(f"on_segment must be True or False, got {shown(self.on_segment)}")
        if self.on_segment and self.holds_rotation:
            raise ValueError(
                "on_segment must be False where the end holds the rotation, got True: the rule rigid_stub "
                "holds the outermost segment itself"
            )
        if self.hub_radius and not (self.holds_deflection and not self.holds_rotation):
            raise ValueError(
                "hub_radius must be 0 unless the end holds the deflection and not the rotation (pinned), got "
                f"{shown(self.hub_radius)}"
            )
        if self.hub_radius and not self.rotary_inertia:
            raise ValueError("rotary_inertia must be greater than 0 of a hub with a radius, got 0")

    @property
    def holds_deflection(self) -> bool:
        """True if the end's deflection is zero, or that of the axis of its hub."""
        return self.translational_stiffness == math.inf

    @property
    def holds_rotation(self) -> bool:
        """True if the end's rotation is zero."""
        return self.rotational_stiffness == math.inf

    @property
    def is_elastic(self) -> bool:
        """True if a spring neither holds the end nor leaves it free."""
        return any(0 < k < math.inf for k in (self.translational_stiffness, self.rotational_stiffness))

    @property
    def is_grounded(self) -> bool:
        """True if anything ties the end to the ground, so that it also holds the beam along its axis."""
        return self.translational_stiffness > 0 or self.rotational_stiffness > 0

    @property
    def moving_body(self) -> tuple[float | Fraction, float | Fraction, float | Fraction]:
        """Mass, rotary inertia and offset as far as the supports let them move, else zeros."""
        mass, inertia, offset = self.mass, self.rotary_inertia, self.offset
        if self.holds_rotation:
            return (0.0, 0.0, 0.0) if self.holds_deflection else (mass, 0.0, 0.0)
        if self.holds_deflection and offset == self.hub_radius:
            return 0.0, inertia, 0.0
        return mass, inertia, offset if mass else 0.0

    @property
    def word(self) -> str | None:
        """Clamped, pinned, guided or free if the end is no more than that, else None."""
        return None if self.is_elastic or any(self.moving_body) else self._held

    @property
    def statics(self) -> str:
        """The word whose rule applies here: by what the beam can feel at this end.

        ========  =======================================  ==========================================
        word      what the beam feels                      what a chain has there
        ========  =======================================  ==========================================
        pinned    no moment, the deflection held           no hinge at the end
        free      no moment, the deflection not held       no hinge at the end
        guided    the rotation held, no shear force        the rule's guided weights
        clamped   everything else                          a hinge at the end, the rule's clamped weights
        carried   as clamped, but `on_segment`             no hinge at the end, the rule's carried weights
        ========  =======================================  ==========================================

        So a rotational stiffness or a rotary inertia that goes to zero, behind a hinge of its own, leaves a
        jump. The wall's spring, in series with what vanishes, follows continuously; the other
        springs that a rule changes near an end do not, so `gregory` jumps by about its own error (2.5e-5 in
        the first frequency of ten segments) and other corrected rules by theirs. And as an inertia vanishes
        on its wall spring, the chain's highest frequency grows beyond bounds and its stable time step falls
        to zero.
        With `on_segment` there is no jump, no additional hinge and no additional frequency: as the inertia
        and the offset vanish, the chain becomes that of a point mass. Its price is the moment that the body
        puts on the end: no hinge stands for the last half segment there. A body whose moment acts like its
        inertia force at less than about one segment beyond the end (a box that is smaller than a segment)
        is served well; for a flywheel the error is of order 1, and a hinge of its own is better. At N = 12,
        over clamped, pinned and free other ends and masses of 0.001 to 10 ρA L, the largest error of
        `gregory` in three modes is 0.07 % on the segment and 0.5 % behind a hinge for an inertia of 1e-6
        ρA L³, but 13 and 0.2 % for 1e-2: so a hinge of its own is the default.
        As the translational spring of a guided end vanishes the wall's spring jumps to the guided one: up
        to there the error has the rule's order at clamped ends.
        """
        mass, inertia, offset = self.moving_body
        if not self.rotational_stiffness and not inertia and not (mass and offset):
            return "pinned" if self.holds_deflection else "free"
        if self.on_segment:
            return "carried"
        shearless = self.holds_rotation and not self.translational_stiffness and not mass
        return "guided" if shearless else "clamped"

    @property
    def _held(self) -> str:
        return _WORDS[self.holds_deflection, self.holds_rotation]

    def __str__(self) -> str:
        named = (*NUMBERS_OF_END, "hub_radius")
        numbers = [f"{name}={float(getattr(self, name))!r}" for name in named if self._tells(name)]
        numbers += ["on_segment=true"] if self.on_segment else []
        return f"{self._held}({', '.join(numbers)})" if numbers else self._held

    def _tells(self, name: str) -> bool:
        value: float | Fraction = getattr(self, name)
        return value != 0 and value != math.inf


_WORDS = {(True, True): "clamped", (True, False): "pinned", (False, True): "guided", (False, False): "free"}


#: The four ends, the firmer first: this order makes the canonical names of pairs.
ENDS: Catalogue[End] = Catalogue(
    "ends",
    {
        word: End(math.inf if deflection else 0.0, math.inf if rotation else 0.0)
        for (deflection, rotation), word in _WORDS.items()
    },
)


_ALIASES = {"cantilever": "clamped", "fixed": "clamped", "hinged": "pinned", "sliding": "guided"}


def end_from_text(text: str) -> End | None:
    """Return the end that a word stands for, with numbers in parentheses; None if the word is unknown.

    Raises
    ------
    ValueError
        If what stands in the parentheses is no number of an `End`.

    Examples
    --------
    >>> end_from_text("free(mass=0.5)") == End(mass=0.5)
    True
    """
    match = re.fullmatch(r"\s*([a-z]+)\s*(?:\(([^()]*)\))?\s*", text.lower())
    word = _ALIASES.get(match[1], match[1]) if match else ""
    if match is None or word not in ENDS:
        return None
    held = ENDS[word]
    numbers: dict[str, Any] = {name: getattr(held, name) for name in _SUPPORTS}
    seen: set[str] = set()
    for part in (match[2] or "").split(",") if match[2] else []:
        name, _, value = (piece.strip() for piece in part.partition("="))
        choice("number of an end", name, (*NUMBERS_OF_END, "hub_radius", "on_segment"))
        if name in seen:
            raise ValueError(f"{name} of an end must be given once, got {shown(text)}")
        seen.add(name)
        if name in _SUPPORTS and numbers[name]:
            raise ValueError(f"{name} of a {word} end must be left out, got {shown(part.strip())}")
        if name == "on_segment":
            numbers[name] = choice("on_segment", value, ("true", "false")) == "true"
            continue
        try:
            numbers[name] = float(value)
        except ValueError:
            raise ValueError(f"{name} must be a number, got {shown(value)}") from None
    return End(**numbers)


class ManyEnds:
    """What stands for many ends of a beam at once; `end_columns.Ends` is one."""


def check_no_hub(*ends: End) -> None:
    """Raise ValueError if one of the ends is a hub whose axis lies off it, for what knows none.

    Examples
    --------
    >>> check_no_hub(ENDS["pinned"])
    """
    for end in ends:
        if end.hub_radius:
            raise ValueError(
                f"boundary must have no hub_radius here, got {shown(str(end))}: chains, linearize, simulate, "
                "euler_bernoulli and frequency_error take hubs"
            )


def check_multiples(boundary: object) -> None:
    """Raise ValueError if a number of an end came with a unit, where it is to be a multiple of a beam's own.

    Examples
    --------
    >>> check_multiples(("clamped", End(mass=0.5)))
    """
    if _in_si(boundary):
        raise ValueError(
            "boundary must have multiples of a beam's own numbers, such as ρA L and EI/L³, got "
            f"{shown(boundary)} in SI: give the beam with it"
        )


def _in_si(boundary: object) -> bool:
    if isinstance(boundary, np.ndarray):
        return boundary.dtype.kind == "O" and any(map(_in_si, boundary.ravel()))
    if isinstance(boundary, tuple | list):
        return any(map(_in_si, boundary))
    ends = (getattr(boundary, side, None) for side in ("left", "right"))
    return any(getattr(end, "in_si", False) for end in (boundary, *ends))


#: A pair of ends of which either may stand for many.
ManyPairs = tuple[str | End | ManyEnds, str | End | ManyEnds]


def has_many(boundary: object) -> bool:
    """Return True if `boundary` is one pair of ends of which either stands for many.

    Examples
    --------
    >>> has_many(("clamped", "free")), has_many(("clamped", ManyEnds()))
    (False, True)
    """
    if not isinstance(boundary, tuple | list) or len(boundary) != 2:
        return False
    return isinstance(boundary[0], ManyEnds) or isinstance(boundary[1], ManyEnds)


class NotPlain(ValueError):
    """A pair of ends with springs or bodies where only the ten plain pairs are known."""


@dataclass(frozen=True, slots=True, repr=False)
class Boundary(Shown):
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
        if isinstance(boundary, str):
            return _from_text(boundary)
        return cls(*(end_of(part, boundary) for part in pair_of(boundary)))

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
        """True if both ends are no more than clamped, pinned, guided or free."""
        return self.left.word is not None and self.right.word is not None

    @property
    def has_hub(self) -> bool:
        """True if an end is a hub whose axis lies off it."""
        return bool(self.left.hub_radius or self.right.hub_radius)

    @property
    def rigid_body_modes(self) -> int:
        """Number of independent transverse motions that leave the beam straight (0, 1 or 2).

        Two supported quantities fix a straight line, unless both are rotations: those fix its slope twice.
        """
        ends = (self.left, self.right)
        deflections = sum(end.translational_stiffness > 0 for end in ends)
        slope = any(end.rotational_stiffness > 0 for end in ends)
        return 2 - min(2, deflections + slope)

    def __str__(self) -> str:
        return self.name

    def _line(self) -> str:
        return f"Boundary({self.name!r})"


@lru_cache(maxsize=1024)
def _from_text(text: str) -> Boundary:
    return Boundary(*(end_of(part, text) for part in _split(text)))


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
    if isinstance(value, (str, Boundary)):
        return np.asarray(boundary_code(value), dtype=np.intp)
    value = with_pairs_read(value)
    pairs, which = distinct("boundary", value, (str, bytes, bytearray, Boundary), Boundary.of)
    return np.asarray(np.array([boundary_code(pair) for pair in pairs], dtype=np.intp)[which])


def is_pair(value: object, kinds: type | tuple[type, ...] = End) -> bool:
    """Return True if `value` is one pair of ends: two words of ends or `End`s, and not two boundaries.

    `kinds` are those of the records of ends.

    Examples
    --------
    >>> [is_pair(value) for value in (("clamped", "free"), ("clamped-free", "free-free"), ["pinned", End()])]
    [True, False, True]
    """
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    return all(
        isinstance(item, kinds) or (isinstance(item, str) and len(ends_in(item)) == 1) for item in value
    )


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
    items = bounded("boundary", value)
    return [item if type(item) in (str, Boundary) else _read_within(item) for item in items]


def _read_within(item: Any) -> Any:
    """Return an item of several boundaries: more of them, or one, or raise what names the boundary."""
    several = isinstance(item, tuple | list) and not is_pair(item)
    return (
        with_pairs_read(item)
        if several or hasattr(item, "dtype") or isinstance(item, str)
        else Boundary.of(item)
    )


@lru_cache(maxsize=4096)
def boundary_code(value: str | Boundary) -> int:
    """Return the index into `BOUNDARIES` of one boundary, read once.

    Examples
    --------
    >>> boundary_code("free-clamped")
    3
    """
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
    return (*supports, end.mass, end.rotary_inertia, end.offset, end.hub_radius, end.on_segment)


def _split(value: str) -> tuple[str, ...]:
    parts = ends_in(value)
    if len(parts) != 2:
        _refuse(value)
    return parts


def ends_in(value: str) -> tuple[str, ...]:
    """Return the texts of single ends in that of a boundary.

    Examples
    --------
    >>> ends_in("clamped-free(mass=1e-3)")
    ('clamped', 'free(mass=1e-3)')
    """
    # Only outside parentheses: numbers in them have signs and commas of their own.
    return tuple(re.split(r"[-/,](?![^(]*\))", value))


def pair_of(value: object) -> tuple[object, ...]:
    """Return the two items of a tuple or list; raise TypeError for all else."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise TypeError(
            'boundary must be a name such as "clamped-free", a pair of ends or a Boundary, '
            f"got {shown(value)}"
        )
    return tuple(value)


def end_of(part: object, whole: object) -> End:
    """Return the end that a word, a text or an `End` stands for; `whole` is shown if it is unreadable."""
    if isinstance(part, End):
        return part
    if not isinstance(part, str):
        if hasattr(part, "shape"):
            raise TypeError(
                f"each end of boundary must be one end here, got {shown(part)}: arrays and Ends are for "
                "frequency_error and its like, which look up many at once"
            )
        return ENDS[choice("each end of boundary", part, ENDS)]
    end = _end_of_text(part)
    return end if end is not None else _refuse(whole)


# Ends are values: what a text stands for is read once.
_end_of_text = lru_cache(maxsize=1024)(end_from_text)


#: What people call a pair of ends that is no pair of words.
_SPOKEN = {"cantilever": "clamped-free", "clamped": "clamped-free", "fixed": "clamped-free"} | dict.fromkeys(
    ("simply-supported", "simple", "pinned", "hinged"), "pinned-pinned"
)


def _refuse(value: object) -> NoReturn:
    """Raise the error for an unreadable boundary, with the nearest readable name."""
    either_order = [f"{a}-{b}" for a in ENDS for b in ENDS]
    text = "-".join(map(str, value)) if isinstance(value, tuple | list) else str(value)
    said = re.sub(r"[\s_/,-]+", "-", text[:60].strip().lower())
    near = [_SPOKEN[said]] if said in _SPOKEN else difflib.get_close_matches(said, either_order, n=1)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    raise ValueError(
        f'boundary must name two of the ends {", ".join(ENDS)}, such as "clamped-free", '
        f"got {shown(value)}{hint}"
    )
