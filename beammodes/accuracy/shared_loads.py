"""Loads on a structure, shared out to its nodes and its stretches."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from beammodes.checks import choice, shown
from beammodes.numerics.piecewise import Piecewise, followed, shifted
from beammodes.problem.applied_loads import AppliedLoad, LineLoad, PointLoad
from beammodes.problem.loading import Load
from beammodes.problem.profiles import SAME_PLACE, Table, profile_parts, value_at
from beammodes.problem.structure import Parts, Stretch, Structure

__all__ = ["SharedLoads"]


class SharedLoads:
    """Loads at nodes (F_x, F_y, moment), and those on each stretch."""

    def __init__(self, structure: Structure, parts: Parts, number: Any) -> None:
        self.structure, self.parts, self.number = structure, parts, number
        count = len(self.parts.stretches)
        self.nodes = [[number(0)] * 3 for _ in self.parts.nodes]
        self.spread: list[list[tuple[Any, Any, tuple[Any, ...]]]] = [[] for _ in range(count)]
        self.points: list[list[tuple[Any, Any, Any]]] = [[] for _ in range(count)]
        #: Along each stretch, as a whole pushed at its first node: forces, and those spread.
        self.pulls: list[list[tuple[Any, Any]]] = [[] for _ in range(count)]
        self.spread_pulls: list[list[tuple[Any, Any, tuple[Any, ...]]]] = [[] for _ in range(count)]

    def add(self, load: AppliedLoad) -> None:
        """Add a load."""
        if isinstance(load, PointLoad):
            self._add_point(load)
        elif isinstance(load, LineLoad):
            self._add_line(load)
        else:
            raise TypeError(f"load must be of PointLoads and LineLoads, or a Load, got {shown(load)}")

    def _push(self, node: int, pair: tuple[Any, Any], moment: Any) -> None:
        for k, value in enumerate((*pair, moment)):
            self.nodes[node][k] += self.number(value)

    def _add_point(self, load: PointLoad) -> None:
        number = self.number
        if load.joint is not None:
            names = list(self.structure.joints)
            choice("joint", load.joint, names)
            pair = load.force if isinstance(load.force, tuple) else (0, 0)
            self._push(names.index(load.joint), pair, load.moment)
            return
        assert load.x is not None
        member, x = self.structure.member(load.member), number(load.x)
        self._check_inside("x", x, member.beam.length)
        small = SAME_PLACE * member.beam.length
        for i, stretch in self._stretches(member.name):
            start, stop = number(stretch.start), number(stretch.start) + number(stretch.beam.length)
            if not start - small <= x <= stop + small:
                continue
            if isinstance(load.force, tuple):
                pair = (number(load.force[0]), number(load.force[1]))
            else:
                u, v = stretch.normal
                pair = (number(u) * number(load.force), number(v) * number(load.force))
            at = [
                node for node, end in zip(stretch.nodes, (start, stop), strict=True) if abs(x - end) <= small
            ]
            if at:
                self._check_turns_as_one(load, member.name, at[0])
                self._push(at[0], pair, load.moment)
                return
            across, along = self._resolved(stretch, pair)
            self.points[i].append((x - start, across, number(load.moment)))
            self.pulls[i].append((x - start, along))
            self._push_along(stretch, along)
            return

    def _check_turns_as_one(self, load: PointLoad, member: str, node: int) -> None:
        """Refuse a moment where a member has a kink: which side of it bears it?"""
        for _, stretch in self._stretches(member):
            for end, hinge in zip(stretch.nodes, stretch.hinges, strict=True):
                if load.moment and end == node and hinge < math.inf:
                    raise ValueError(
                        f"moment must be where a member has no hinge, got one at x = {load.x} of {member} on "
                        f"a hinge of stiffness {hinge:g}: which side of it bears the moment? Put it on the "
                        "joint, or a little beside"
                    )

    def _resolved(self, stretch: Stretch, force: tuple[Any, Any]) -> tuple[Any, Any]:
        """Return what a force has across a stretch, and along it."""
        (c, s), (u, v) = (map(self.number, axis) for axis in (stretch.axis, stretch.normal))
        return u * force[0] + v * force[1], c * force[0] + s * force[1]

    def _push_along(self, stretch: Stretch, force: Any) -> None:
        """Push a stretch along itself, wherever that is: all of it moves."""
        c, s = map(self.number, stretch.axis)
        self._push(stretch.nodes[0], (c * force, s * force), 0)

    def _add_line(self, load: LineLoad) -> None:
        number, member = self.number, self.structure.member(load.member)
        length = number(member.beam.length)
        start, stop = number(load.start), length if load.stop is None else number(load.stop)
        self._check_inside("start", start, length)
        self._check_inside("stop", stop, length)
        if isinstance(load.per_length, Table):
            if abs(load.per_length.x[-1] - member.beam.length) > SAME_PLACE * member.beam.length:
                raise ValueError(
                    f"per_length must be a table from 0 to the member's length {member.beam.length}, got one "
                    f"to {load.per_length.x[-1]}"
                )
            self._add_table(member.name, load.per_length, number(0), number(1), start, stop)
        else:
            assert isinstance(load.per_length, tuple)
            self._spread(member.name, start, stop, number(0), tuple(map(number, load.per_length)))

    def _add_table(
        self, member: str, table: Table, origin: Any, factor: Any, start: Any = None, stop: Any = None
    ) -> None:
        """Spread a factor times a table that starts at the origin, between two places."""
        number = self.number
        columns = [
            (origin + number(x), factor * number(q)) for x, q in zip(table.x, table.value, strict=True)
        ]
        for (a, low), (b, high) in pairwise(columns):
            first, last = (a if start is None else max(a, start)), (b if stop is None else min(b, stop))
            if last > first:
                self._spread(member, first, last, a, (low, (high - low) / (b - a)))

    def _spread(self, member: str, start: Any, stop: Any, origin: Any, polynomial: tuple[Any, ...]) -> None:
        """Spread a polynomial in x - origin from start to stop."""
        for i, stretch in self._stretches(member):
            first, length = self.number(stretch.start), self.number(stretch.beam.length)
            a, b = max(start - first, self.number(0)), min(stop - first, length)
            if b > a:
                self.spread[i].append((a, b, shifted(polynomial, a + first - origin)))

    def add_load(self, load: Load, tip: str | None) -> None:
        """Add the gravity of a `Load`, and what it has on a tip, if there is one."""
        known = Load(gravity=load.gravity)
        if tip is not None:
            known = Load(gravity=load.gravity, tip_force=load.tip_force, tip_moment=load.tip_moment)
            self._push(list(self.structure.joints).index(tip), load.tip, load.tip_moment)
        if load != known:
            words = "gravity" if tip is None else "gravity, tip_force and tip_moment"
            raise ValueError(
                f"load must have no more than {words} here where it is a Load, got {shown(str(load))}: give "
                "forces and moments as PointLoads"
            )
        if any(load.weight):
            self._add_weight(load.weight)

    def _add_weight(self, gravity: tuple[Any, Any]) -> None:
        """Add the weight of beams and bodies."""
        number = self.number
        pull = number(gravity[0]), number(gravity[1])
        for i, stretch in enumerate(self.parts.stretches):
            across, along = self._resolved(stretch, pull)
            for a, b, mass in self._mass(stretch):
                total = sum(c * (b - a) ** (k + 1) / (k + 1) for k, c in enumerate(mass))
                self.spread[i].append((a, b, tuple(across * c for c in mass)))
                self.spread_pulls[i].append((a, b, tuple(along * c for c in mass)))
                self._push_along(stretch, along * total)
        for i, node in enumerate(self.parts.nodes):
            force = number(node.mass) * pull[0], number(node.mass) * pull[1]
            self._push(i, force, number(node.offset[0]) * force[1] - number(node.offset[1]) * force[0])

    def _mass(self, stretch: Stretch) -> list[tuple[Any, Any, tuple[Any, ...]]]:
        """Return the mass per length of a stretch: polynomials between two places, from the first on."""
        number, profile = self.number, stretch.beam.mass_per_length
        if isinstance(profile, Table):
            places = list(map(number, profile.x))
            values = list(map(number, profile.value))
            return [
                (a, b, (low, (high - low) / (b - a)))
                for (a, b), (low, high) in zip(pairwise(places), pairwise(values), strict=True)
                if b > a
            ]
        if not callable(profile):
            return [(number(0), number(stretch.beam.length), (number(profile),))]
        length = stretch.beam.length
        edges = (0.0, *profile_parts(profile, length), length)
        fitted = followed(lambda x: value_at(profile, x), edges, "mass_per_length")
        return [
            (number(a), number(b), tuple(map(number, piece)))
            for (a, b), piece in zip(pairwise(fitted.edges), fitted.pieces, strict=True)
        ]

    def _along(self, index: int, length: Any) -> Piecewise:
        """Return the pull of what is on a stretch beyond a place."""
        none = self.number(0)
        beyond = self._sum(self.spread_pulls[index], length).integrated()
        for x, force in self.pulls[index]:
            beyond = beyond.plus(Piecewise((none, x, length), ((none,), (force,))))
        whole = beyond(length)
        return Piecewise(beyond.edges, tuple(tuple(-c for c in piece) for piece in beyond.pieces)).plus(
            Piecewise.one(none, length, whole)
        )

    def _stretches(self, member: str) -> list[tuple[int, Stretch]]:
        return [(i, one) for i, one in enumerate(self.parts.stretches) if one.member == member]

    @staticmethod
    def _check_inside(name: str, x: Any, length: Any) -> None:
        if x > length * (1 + SAME_PLACE):
            raise ValueError(
                f"{name} must be on the member, at most its length {float(length)}, got {float(x)}"
            )

    def on(self, index: int, length: Any) -> tuple[Piecewise, Piecewise, Piecewise]:
        """Return shear and moment of a stretch's loads, without moment at either end, and their pull."""
        none = self.number(0)
        spread = self._sum(self.spread[index], length)
        shear, jumps = spread.integrated(), Piecewise.one(none, length, none)
        for x, force, moment in self.points[index]:
            shear = shear.plus(Piecewise((none, x, length), ((none,), (force,))))
            jumps = jumps.plus(Piecewise((none, x, length), ((none,), (-moment,))))
        moment = shear.integrated().plus(jumps)
        slope = moment(length) / length
        return (
            shear.plus(Piecewise.one(none, length, -slope)),
            moment.plus(Piecewise.one(none, length, none, -slope)),
            self._along(index, length),
        )

    def _sum(self, spread: list[tuple[Any, Any, tuple[Any, ...]]], length: Any) -> Piecewise:
        """Return what is spread on a stretch as one function."""
        none = self.number(0)
        total = Piecewise.one(none, length, none)
        for a, b, polynomial in spread:
            edges = sorted({none, a, b, length})
            pieces = tuple(polynomial if start == a else (none,) for start in edges[:-1])
            total = total.plus(Piecewise(tuple(edges), pieces))
        return total
