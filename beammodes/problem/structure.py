"""Planar structures of beams: members between joints, and stations along a member.

A station is anything at a place inside a beam: a support, a body, a hinge. What lies between two stations, or
a station and a joint, is a *stretch*: smooth, and loaded at its ends only. Solutions and chains are made of
stretches; breaks of a beam (its steps) end them, too.

Members are straight and do not stretch. Small motions: every stretch moves along itself as a whole.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from beammodes.checks import (
    Shown,
    bounded,
    choice,
    is_text,
    not_negative,
    real,
    shown,
    told_fields,
    unwrapped,
)
from beammodes.problem.beam import Beam
from beammodes.problem.ends import NUMBERS_OF_END, Boundary, BoundaryLike, End, check_no_hub
from beammodes.problem.profiles import SAME_PLACE, BrokenFunction, Profile, Table, table_limit, value_at

__all__ = [
    "Joint",
    "Member",
    "Node",
    "Parts",
    "Station",
    "Stretch",
    "Structure",
    "Support",
    "checked_structure",
    "part_of_beam",
]

#: Stiffness of a support: along x, along y [N/m], and of the rotation [N m/rad].
Support = tuple[float, float, float]

_SUPPORTS: Mapping[str, Support] = MappingProxyType(
    {
        "free": (0.0, 0.0, 0.0),
        "pinned": (math.inf, math.inf, 0.0),
        "clamped": (math.inf, math.inf, math.inf),
        "roller": (0.0, math.inf, 0.0),
    }
)
#: Members and joints do not meet if they miss each other by more than this part of the member's length.
_MEET = 1e-9
_MOST = 1000


@dataclass(frozen=True, repr=False)
class Station(Shown):
    """What is at a place inside a beam: a support, an attached rigid body, or a hinge.

    A station with nothing but x is a node of chains, such as one under a force.

    Parameters
    ----------
    x : float [m]
        Distance from the beam's start.
    translational_stiffness : float [N/m]
        Of a spring to the ground, across the beam: `math.inf` holds the deflection there.
    rotational_stiffness : float [N m/rad]
        Likewise of the rotation.
    mass : float [kg]
        Of a rigid body fixed to the beam there.
    rotary_inertia : float [kg m²]
        Of that body, about its centre of mass.
    offset : float [m]
        How far its centre of mass lies beyond x, along the beam.
    hinge : float [N m/rad]
        Stiffness against a kink: `math.inf` is a beam that goes on, 0 a hinge, a number between a crack or a
        splice. What turns with a beam that has a kink here would be ambiguous, and is refused.

    Raises
    ------
    TypeError, ValueError
        If a number is not real or is negative, or a hinge comes with a rotational stiffness, a rotary inertia
        or an offset.

    Examples
    --------
    >>> knife_edge, crack = Station(6.2, translational_stiffness=math.inf), Station(0.3, hinge=120.0)
    """

    x: float
    translational_stiffness: float = 0.0
    rotational_stiffness: float = 0.0
    mass: float = 0.0
    rotary_inertia: float = 0.0
    offset: float = 0.0
    hinge: float = field(default=math.inf, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "x", real("x", self.x))
        # An end has the same numbers, and says what is wrong with them.
        end = End(*(getattr(self, name) for name in NUMBERS_OF_END))
        for name in NUMBERS_OF_END:
            object.__setattr__(self, name, float(getattr(end, name)))
        object.__setattr__(self, "hinge", not_negative("hinge", self.hinge, infinite=True))
        if self.hinge < math.inf and (
            self.rotational_stiffness or self.rotary_inertia or (self.mass and self.offset)
        ):
            raise ValueError(
                "hinge must be left out where a station has a rotational_stiffness, a rotary_inertia or a "
                f"mass with an offset, got {shown(self.hinge)}: which side of the kink turns with them? Put "
                "them on one side, at a Joint between two members with start_hinge or end_hinge"
            )


@dataclass(frozen=True, repr=False)
class Joint(Shown):
    """A place where members meet or end, with a support and a rigid body.

    Parameters
    ----------
    x, y : float [m]
        Where it is.
    support : str or (k_x, k_y, k_rotation) [N/m, N/m, N m/rad]
        "free", "pinned" (held along x and y), "clamped" (also against rotation) or "roller" (held along y);
        or three stiffnesses, 0 to `math.inf`: `(math.inf, 0, 0)` is a roller that moves along y.
    mass : float [kg]
        Of a rigid body fixed to the joint.
    rotary_inertia : float [kg m²]
        Of that body, about its centre of mass.
    offset : (float, float) [m]
        From the joint to its centre of mass.
    angle : float [rad]
        By which the support's x and y are turned, counter-clockwise: `(0, math.inf, 0)` at 0.5 rolls on a
        slope of 0.5 rad.

    Raises
    ------
    TypeError, ValueError
        If a number is not real and finite (stiffnesses may be infinite), or a stiffness, the mass or the
        inertia is negative.

    Examples
    --------
    >>> Joint(0, 3, support="roller").support
    (0.0, inf, 0.0)
    """

    x: float
    y: float
    support: str | Support = "free"
    mass: float = 0.0
    rotary_inertia: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0

    def __post_init__(self) -> None:
        for name in ("x", "y", "angle"):
            object.__setattr__(self, name, real(name, getattr(self, name)) + 0.0)
        body = End(mass=self.mass, rotary_inertia=self.rotary_inertia)
        object.__setattr__(self, "mass", float(body.mass))
        object.__setattr__(self, "rotary_inertia", float(body.rotary_inertia))
        given = self.support
        if isinstance(given, str):
            support = _SUPPORTS[choice("support", given, _SUPPORTS)]
        else:
            along, up, turn = (not_negative("support", k, infinite=True) for k in _row("support", given, 3))
            support = (along, up, turn)
        object.__setattr__(self, "support", support)
        offset = tuple(real("offset", value) + 0.0 for value in _row("offset", self.offset, 2))
        object.__setattr__(self, "offset", offset)


@dataclass(frozen=True, repr=False)
class Member(Shown):
    """A beam between two joints, with stations along it.

    Parameters
    ----------
    beam : Beam
        As long as the two joints are apart.
    start, end : str
        Names of the joints where x along the beam is 0 and L.
    start_hinge, end_hinge : float [N m/rad]
        Stiffness of its connections to them against rotation: `math.inf` is rigid, 0 a pin.
    stations : sequence of Station

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or a station is not inside the beam, or where another one is.
    """

    beam: Beam
    start: str
    end: str
    start_hinge: float = math.inf
    end_hinge: float = math.inf
    stations: tuple[Station, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(self.beam)}")
        for name in ("start", "end"):
            if not isinstance(getattr(self, name), str):
                raise TypeError(f"{name} must be the name of a joint, got {shown(getattr(self, name))}")
        if self.start == self.end:
            raise ValueError(f"end must be another joint than start, got {shown(self.end)}")
        for name in ("start_hinge", "end_hinge"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name), infinite=True))
        stations = bounded("stations", self.stations, most=_MOST)
        for station in stations:
            if not isinstance(station, Station):
                raise TypeError(f"stations must be Stations, got {shown(station)}")
        length, small = self.beam.length, SAME_PLACE * self.beam.length
        places = sorted(stations, key=lambda station: station.x)
        for station in places:
            if not small < station.x < length - small:
                raise ValueError(
                    f"stations must be inside the beam, between 0 and its length {length}, got one at "
                    f"x = {station.x}; what is at an end is said of that end"
                )
        for before, after in itertools.pairwise(places):
            if after.x - before.x <= small:
                raise ValueError(f"stations must be at different places, got two at x = {after.x}")
        object.__setattr__(self, "stations", tuple(places))

    def _line(self) -> str:
        given = told_fields(self)
        told = [f"{name}={value!r}" for name, value in given if name not in ("beam", "stations")]
        places = ", ".join(f"{station.x:g}" for station in self.stations)
        told += [f"stations at {places}"] if places else []
        return f"Member({', '.join([*told, f'beam={self.beam!r}'])})"

    @property
    def name(self) -> str:
        """Its two joints, such as "foot-corner"."""
        return f"{self.start}-{self.end}"


class Node(NamedTuple):
    """Where stretches meet or end: a joint, a station, or a break of a beam.

    Attributes
    ----------
    name : str
        Of the joint; or of the member and its x.
    place : (float, float) [m]
    supports : tuple of (direction, stiffness)
        Of springs to the ground along unit vectors, `math.inf` where they hold [N/m].
    rotational_stiffness : float or Fraction [N m/rad]
    mass, rotary_inertia : float [kg], [kg m²]
    offset : (float, float) [m]
        From the node to the body's centre of mass.
    """

    name: str
    place: tuple[float, float]
    supports: tuple[tuple[tuple[float, float], float], ...] = ()
    rotational_stiffness: float | Fraction = 0.0
    mass: float = 0.0
    rotary_inertia: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)

    @property
    def has_turning_body(self) -> bool:
        """True if a rotation of the node moves mass."""
        return bool(self.rotary_inertia or (self.mass and any(self.offset)))


class Stretch(NamedTuple):
    """A part of a member between two nodes.

    Attributes
    ----------
    member : str
    start : float [m]
        Where on the member it starts.
    beam : Beam
        Smooth, as long as the stretch.
    nodes : (int, int)
        Indices of its first and its last node.
    axis : (float, float)
        Unit vector along it.
    hinges : (float, float) [N m/rad]
        Stiffness of its connection to either node.
    """

    member: str
    start: float
    beam: Beam
    nodes: tuple[int, int]
    axis: tuple[float, float]
    hinges: tuple[float, float]

    @property
    def normal(self) -> tuple[float, float]:
        """The axis, turned by a quarter counter-clockwise: where deflections point."""
        return (-self.axis[1], self.axis[0])


class Parts(NamedTuple):
    """A structure cut at its stations, at breaks of its beams, and where else one asks for."""

    nodes: tuple[Node, ...]
    stretches: tuple[Stretch, ...]


@dataclass(frozen=True, repr=False)
class Structure(Shown):
    """A planar structure of beams: straight members that do not stretch, joined at joints.

    Bending in the plane only. Members are rigidly joined, pinned, or joined by rotational springs; a joint
    may be supported and carry a body. Trees and closed frames alike. `Structure.of_beam` makes the one of a
    single beam with stations.

    Parameters
    ----------
    joints : mapping of str to Joint
    members : sequence of Member

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind; if a member names a joint that does not exist, is not as long as
        its joints are apart, or joins the same two as another; or if a joint has no member.

    Examples
    --------
    An L of two equal bars, clamped at its foot:

    >>> bar = Beam.unit()
    >>> ell = Structure(
    ...     {"foot": Joint(0, 0, "clamped"), "corner": Joint(0, 1), "tip": Joint(1, 1)},
    ...     [Member(bar, "foot", "corner"), Member(bar, "corner", "tip")],
    ... )
    >>> [stretch.axis for stretch in ell.parts.stretches]
    [(0.0, 1.0), (1.0, 0.0)]
    """

    joints: Mapping[str, Joint]
    members: tuple[Member, ...]

    def __init__(self, joints: Mapping[str, Joint], members: Iterable[Member]) -> None:
        if not isinstance(joints, Mapping):
            raise TypeError(f"joints must be a mapping of names to Joints, got {shown(joints)}")
        if not joints:
            raise ValueError(f"joints must be one or more, got {shown(joints)}")
        for name, joint in joints.items():
            if not isinstance(name, str) or not isinstance(joint, Joint):
                raise TypeError(f"joints must be names with Joints, got {shown(name)}: {shown(joint)}")
        kept = tuple(bounded("members", members, most=_MOST))
        for member in kept:
            if not isinstance(member, Member):
                raise TypeError(f"members must be Members, got {shown(member)}")
            for end in (member.start, member.end):
                choice("joint of a member", end, joints)
            _check_length(member, joints[member.start], joints[member.end])
        pairs = [frozenset((member.start, member.end)) for member in kept]
        for i, pair in enumerate(pairs):
            if pair in pairs[:i]:
                raise ValueError(f"members must join different pairs of joints, got {kept[i].name} twice")
        names = [member.name for member in kept]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise ValueError(f"joints must have names that name members apart, got two members {name}")
        alone = set(joints).difference(*pairs)
        if alone or not kept:
            raise ValueError(f"joints must each be an end of a member, got {shown(sorted(alone))} alone")
        object.__setattr__(self, "joints", MappingProxyType(dict(joints)))
        object.__setattr__(self, "members", kept)

    def __hash__(self) -> int:
        return hash((frozenset(self.joints.items()), self.members))

    def __reduce__(self) -> tuple[type[Structure], tuple[dict[str, Joint], tuple[Member, ...]]]:
        # A read-only mapping cannot be pickled itself.
        return Structure, (dict(self.joints), self.members)

    @classmethod
    def of_beam(cls, beam: Beam, boundary: BoundaryLike, stations: Iterable[Station] = ()) -> Structure:
        """Return the structure of one beam between two ends, with stations along it.

        The beam lies along x, its joints are "left" and "right", and it moves across itself only.

        Parameters
        ----------
        beam : Beam
        boundary : str, pair of ends or Boundary
        stations : sequence of Station

        Examples
        --------
        >>> overhang = Structure.of_beam(Beam(7.5, 1.0, 1.0), "pinned-free", [Station(6.2, math.inf)])
        >>> [stretch.beam.length for stretch in overhang.parts.stretches]
        [6.2, 1.2999999999999998]
        """
        pair = Boundary.of(boundary)
        check_no_hub(pair.left, pair.right)
        for end in (pair.left, pair.right):
            if end.on_segment:
                raise ValueError(f"boundary must have on_segment False in a structure, got {pair}")
        member = Member(beam, "left", "right", stations=tuple(bounded("stations", stations, most=_MOST)))
        joints = {
            name: Joint(
                x,
                0.0,
                (along, float(end.translational_stiffness), float(end.rotational_stiffness)),
                float(end.mass),
                float(end.rotary_inertia),
                (side * float(end.offset), 0.0),
            )
            for name, end, x, along, side in (
                ("left", pair.left, 0.0, math.inf, -1.0),
                ("right", pair.right, beam.length, 0.0, 1.0),
            )
        }
        return cls(joints, [member])

    @classmethod
    def of_bars(
        cls,
        joints: Mapping[str, Joint],
        pairs: Iterable[tuple[str, str]],
        *,
        bending_stiffness: float,
        mass_per_length: float,
        rotary_inertia_per_length: float = 0.0,
    ) -> Structure:
        """Return the structure of bars of one section, rigidly joined, each as long as its joints are apart.

        Parameters
        ----------
        joints : mapping of str to Joint
        pairs : sequence of (str, str)
            Names of the joints where each bar starts and ends.
        bending_stiffness : float [N m²]
        mass_per_length : float [kg/m]
        rotary_inertia_per_length : float [kg m]

        Examples
        --------
        >>> joints = {"foot": Joint(0, 0, "clamped"), "corner": Joint(3, 4), "tip": Joint(5, 4)}
        >>> bars = [("foot", "corner"), ("corner", "tip")]
        >>> crane = Structure.of_bars(joints, bars, bending_stiffness=2.0, mass_per_length=1.0)
        >>> [member.beam.length for member in crane.members]
        [5.0, 2.0]
        """
        if not isinstance(joints, Mapping) or not all(isinstance(j, Joint) for j in joints.values()):
            raise TypeError(f"joints must be a mapping of names to Joints, got {shown(joints)}")
        members = []
        for pair in bounded("pairs", pairs, most=_MOST):
            if is_text(pair) or not isinstance(pair, Sequence) or len(pair) != 2:
                raise TypeError(f"pairs must be names of two joints each, got {shown(pair)}")
            start, end = (choice("pairs", name, joints) for name in pair)
            length = _distance(joints[start], joints[end])
            if not length:
                raise ValueError(f"pairs must be of joints that are apart, got {shown(pair)}")
            beam = Beam(length, bending_stiffness, mass_per_length, rotary_inertia_per_length)
            members.append(Member(beam, start, end))
        return cls(joints, members)

    @cached_property
    def parts(self) -> Parts:
        """Its nodes and the stretches between them."""
        return self.cut({})

    def cut(self, places: Mapping[str, Sequence[float]]) -> Parts:
        """Return nodes and stretches, cut at more places: positions along members, by their names [m]."""
        nodes = [_joint_node(name, joint) for name, joint in self.joints.items()]
        index = {name: i for i, name in enumerate(self.joints)}
        stretches: list[Stretch] = []
        for member in self.members:
            ends = index[member.start], index[member.end]
            axis = _axis(self.joints[member.start], self.joints[member.end])
            _cut_member(member, axis, ends, places.get(member.name, ()), nodes, stretches)
        return Parts(tuple(nodes), tuple(stretches))

    def member(self, name: str | None) -> Member:
        """Return the member of a name such as "foot-corner"; None is the only one there is."""
        names = [member.name for member in self.members]
        if name is None:
            if len(names) > 1:
                raise ValueError(f"member must be one of {', '.join(names)}, got None")
            return self.members[0]
        return self.members[names.index(choice("member", name, names))]

    def _line(self) -> str:
        return f"<Structure: {', '.join(member.name for member in self.members)}>"


def checked_structure(value: object) -> Structure:
    """Return `value`, or raise TypeError if it is no Structure."""
    if not isinstance(value, Structure):
        raise TypeError(f"structure must be a Structure, got {shown(value)}")
    return value


def part_of_beam(beam: Beam, start: float, stop: float) -> Beam:
    """Return the beam between two positions, without shear [m].

    Examples
    --------
    >>> part_of_beam(Beam(4.0, [1.5, 1.0], 1.0), 2.0, 4.0)
    Beam(length=2.0, bending_stiffness=1.0, mass_per_length=1.0)
    """
    if (start, stop) == (0.0, beam.length):
        return beam
    names = ("bending_stiffness", "mass_per_length", "rotary_inertia_per_length")
    given = [_part(getattr(beam, name), start, stop, beam.length) for name in names]
    small = SAME_PLACE * beam.length
    inside = [x - start for x in beam.breaks if start + small < x < stop - small]
    return Beam(stop - start, *given, breaks=inside)


def _part(profile: Profile, start: float, stop: float, length: float) -> Any:
    if isinstance(profile, Table):
        x, value = np.array(profile.x), np.array(profile.value)
        inside = (x > start + SAME_PLACE * length) & (x < stop - SAME_PLACE * length)
        first, last = (
            table_limit(profile, np.array([at]), side).item() for at, side in ((start, 1), (stop, -1))
        )
        values = [first, *value[inside].tolist(), last]
        if min(values) == max(values):
            return first
        return Table([0.0, *(x[inside] - start).tolist(), stop - start], values)
    if callable(profile):
        # Where the part ends at a break, what lies beyond it is not seen, in a mean of both sides either.
        low, high = start + 4.0 * SAME_PLACE * length, stop - 4.0 * SAME_PLACE * length
        own = profile.function if isinstance(profile, BrokenFunction) else profile
        return lambda x: value_at(own, np.clip(np.asarray(x) + start, low, high))
    return profile


def _cut_member(
    member: Member,
    axis: tuple[float, float],
    ends: tuple[int, int],
    places: Sequence[float],
    nodes: list[Node],
    stretches: list[Stretch],
) -> None:
    """Append a member's inner nodes and its stretches."""
    length, at = member.beam.length, {station.x: station for station in member.stations}
    small, cuts = SAME_PLACE * length, sorted(at)
    for x in (*member.beam.breaks, *places):
        if small < x < length - small and all(abs(x - cut) > small for cut in cuts):
            cuts.append(x)
    cuts.sort()
    first, origin = ends[0], nodes[ends[0]].place
    edges, hinge = [0.0, *cuts, length], member.start_hinge
    for start, stop in itertools.pairwise(edges):
        if stop == length:
            last, after = ends[1], (hinge, member.end_hinge)
            following = math.inf
        else:
            last, station = len(nodes), at.get(stop)
            place = (origin[0] + axis[0] * stop, origin[1] + axis[1] * stop)
            short = f"{stop:g}"
            at_stop = short if short != f"{start:g}" else repr(float(stop))
            nodes.append(_station_node(f"{member.name} at {at_stop}", place, axis, station))
            following = math.inf if station is None else station.hinge
            after = (hinge, math.inf)
        beam = part_of_beam(member.beam, start, stop)
        stretches.append(Stretch(member.name, start, beam, (first, last), axis, after))
        first, hinge = last, following


def _joint_node(name: str, joint: Joint) -> Node:
    assert not isinstance(joint.support, str)
    k_x, k_y, k_rotation = joint.support
    c, s = math.cos(joint.angle), math.sin(joint.angle)
    supports = tuple((unit, k) for unit, k in (((c, s), k_x), ((0.0 - s, c), k_y)) if k)
    return Node(
        name, (joint.x, joint.y), supports, k_rotation, joint.mass, joint.rotary_inertia, joint.offset
    )


def _station_node(
    name: str, place: tuple[float, float], axis: tuple[float, float], station: Station | None
) -> Node:
    if station is None:
        return Node(name, place)
    k = station.translational_stiffness
    return Node(
        name,
        place,
        (((-axis[1], axis[0]), k),) if k else (),
        station.rotational_stiffness,
        station.mass,
        station.rotary_inertia,
        (axis[0] * station.offset, axis[1] * station.offset),
    )


def _axis(start: Joint, end: Joint) -> tuple[float, float]:
    across, up = end.x - start.x, end.y - start.y
    length = math.hypot(across, up)
    return across / length + 0.0, up / length + 0.0


def _distance(start: Joint, end: Joint) -> float:
    return math.hypot(end.x - start.x, end.y - start.y)


def _check_length(member: Member, start: Joint, end: Joint) -> None:
    distance = _distance(start, end)
    if not abs(distance - member.beam.length) <= _MEET * member.beam.length:
        raise ValueError(
            f"members must be as long as their joints are apart, got {member.name} of length "
            f"{member.beam.length} between joints {distance} apart"
        )


def _row(name: str, value: object, count: int) -> list[Any]:
    value = unwrapped(name, value)
    items = bounded(name, value, most=count) if isinstance(value, Iterable) else []
    if len(items) != count:
        raise TypeError(f"{name} must be {count} numbers, got {shown(value)}")
    return items
