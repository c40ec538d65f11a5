"""Loads on a structure, shared out to its nodes and its stretches."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from beammodes.checks import shown
from beammodes.numerics.piecewise import Piecewise, shifted
from beammodes.problem.applied_loads import AppliedLoad, LineLoad, PointLoad
from beammodes.problem.loading import Load
from beammodes.problem.profiles import SAME_PLACE, Table
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
            if load.joint not in names:
                raise ValueError(f"joint must be one of {', '.join(names)}, got {shown(load.joint)}")
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
                self._push(at[0], pair, load.moment)
                return
            across, along = self._resolved(stretch, pair)
            self.points[i].append((x - start, across, number(load.moment)))
            self._push(stretch.nodes[0], along, 0)
            return

    def _resolved(self, stretch: Stretch, force: tuple[Any, Any]) -> tuple[Any, tuple[Any, Any]]:
        """Return what a force has across a stretch, and the force along it, which moves all of it."""
        (c, s), (u, v) = (map(self.number, axis) for axis in (stretch.axis, stretch.normal))
        along = c * force[0] + s * force[1]
        return u * force[0] + v * force[1], (c * along, s * along)

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
        for stretch in self.parts.stretches:
            across, along = self._resolved(stretch, pull)
            profile, start = stretch.beam.mass_per_length, number(stretch.start)
            if isinstance(profile, Table):
                self._add_table(stretch.member, profile, start, across)
            elif callable(profile):
                raise ValueError(
                    "mass_per_length must be a number or a Table for its weight, got a function: give its "
                    "weight as a LineLoad of a Table"
                )
            else:
                stop = start + number(stretch.beam.length)
                self._spread(stretch.member, start, stop, start, (across * number(profile),))
            mass = number(stretch.beam.mean_mass_per_length) * number(stretch.beam.length)
            self._push(stretch.nodes[0], (mass * along[0], mass * along[1]), 0)
        for i, node in enumerate(self.parts.nodes):
            force = number(node.mass) * pull[0], number(node.mass) * pull[1]
            self._push(i, force, number(node.offset[0]) * force[1] - number(node.offset[1]) * force[0])

    def _stretches(self, member: str) -> list[tuple[int, Stretch]]:
        return [(i, one) for i, one in enumerate(self.parts.stretches) if one.member == member]

    @staticmethod
    def _check_inside(name: str, x: Any, length: Any) -> None:
        if x > length * (1 + SAME_PLACE):
            raise ValueError(
                f"{name} must be on the member, at most its length {float(length)}, got {float(x)}"
            )

    def on(self, index: int, length: Any) -> tuple[Piecewise, Piecewise]:
        """Return shear and moment of a stretch's loads, without moment at either end."""
        none = self.number(0)
        spread = Piecewise.one(none, length, none)
        for a, b, polynomial in self.spread[index]:
            edges = sorted({none, a, b, length})
            pieces = tuple(polynomial if start == a else (none,) for start in edges[:-1])
            spread = spread.plus(Piecewise(tuple(edges), pieces))
        shear, jumps = spread.integrated(), Piecewise.one(none, length, none)
        for x, force, moment in self.points[index]:
            shear = shear.plus(Piecewise((none, x, length), ((none,), (force,))))
            jumps = jumps.plus(Piecewise((none, x, length), ((none,), (-moment,))))
        moment = shear.integrated().plus(jumps)
        slope = moment(length) / length
        return (
            shear.plus(Piecewise.one(none, length, -slope)),
            moment.plus(Piecewise.one(none, length, none, -slope)),
        )
