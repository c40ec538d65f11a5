"""The linear system of a structure in equilibrium: displacements, end moments, tensions and reactions."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

from beammodes.accuracy.bent_stretches import BentStretch
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.structure import Node, Parts

__all__ = ["StaticSystem"]

Row = dict[str, Any]


class StaticSystem:
    """Unknowns by name, equations as rows of them, displacements first."""

    def __init__(
        self, parts: Parts, stretches: tuple[BentStretch, ...], loads: list[list[Any]], number: Any
    ) -> None:
        self.parts, self.stretches, self.number = parts, stretches, number
        none = number(0)
        self.turning = [
            bool(node.rotational_stiffness)
            or any(
                hinge and at == i
                for one in parts.stretches
                for at, hinge in zip(one.nodes, one.hinges, strict=True)
            )
            for i, node in enumerate(parts.nodes)
        ]
        self.moved = [f"d{k}{i}" for i in range(len(parts.nodes)) for k in "xy"]
        self.moved += [f"t{i}" for i, turns in enumerate(self.turning) if turns]
        self.forces = [f"{word}{s}" for s in range(len(stretches)) for word in ("m", "n", "N")]
        self.rows: list[tuple[Row, Any]] = []
        self.balance = [[Row(), Row(), Row()] for _ in parts.nodes]
        for s, one in enumerate(stretches):
            self._add_stretch(s, one)
        for i, node in enumerate(parts.nodes):
            self._add_support(i, node)
            for k, row in enumerate(self.balance[i]):
                if k == 2 and not self.turning[i]:
                    if loads[i][2]:
                        raise ValueError(
                            f"moment must be on what can bear it, got one on the pin {node.name}"
                        )
                    continue
                # What stretches' ends take, given as `balance`, less reactions is the load.
                given = self.offsets.get((i, k), none)
                self.rows.append((row, loads[i][k] - given))

    @cached_property
    def offsets(self) -> dict[tuple[int, int], Any]:
        """Forces that the loads on stretches ask of their ends: by node and component."""
        found: dict[tuple[int, int], Any] = {}
        for one in self.stretches:
            ends = (
                (one.stretch.nodes[0], one.shear_of_load(0 * one.length, 1)),
                (one.stretch.nodes[1], -one.shear_of_load(one.length, -1)),
            )
            for node, force in ends:
                for k, part in enumerate(one.stretch.normal):
                    found[node, k] = found.get((node, k), self.number(0)) + self.number(part) * force
        return found

    def _add_stretch(self, s: int, one: BentStretch) -> None:
        number, stretch = self.number, one.stretch
        i, j = stretch.nodes
        first, second = one.weights()
        moment = one.moment_of_load
        none, length = 0 * one.length, one.length
        over = 1 / length

        def bend(weight: Piecewise, of: Piecewise) -> Any:
            return one.bends.integral(weight, of, none, length)

        chord = {
            f"d{k}{node}": sign * number(part) * over
            for node, sign in ((j, 1), (i, -1))
            for k, part in zip("xy", stretch.normal, strict=True)
        }
        for side, (node, hinge, sign, name) in enumerate(
            zip(stretch.nodes, stretch.hinges, (1, -1), (f"m{s}", f"n{s}"), strict=True)
        ):
            own = (first, second)[side]
            if not hinge:
                self.rows.append(({name: number(1)}, none))
                continue
            row: Row = {key: sign * value for key, value in chord.items()}
            row[f"m{s}"] = -bend(own, first)
            row[f"n{s}"] = -bend(own, second)
            row[name] -= 0 if hinge == math.inf else 1 / number(hinge)
            row[f"t{node}"] = number(-sign)
            self.rows.append((row, bend(own, moment)))
            self._balance(node, 2, name, number(-sign))
        straight = {
            f"d{k}{node}": sign * number(part)
            for node, sign in ((j, 1), (i, -1))
            for k, part in zip("xy", stretch.axis, strict=True)
        }
        self.rows.append((straight, none))
        for node, sign in ((i, 1), (j, -1)):
            for k in (0, 1):
                across, along = number(stretch.normal[k]), number(stretch.axis[k])
                # V = (n - m)/l pushes the start, -V the end; tension pulls the start back.
                self._balance(node, k, f"m{s}", -sign * across * over)
                self._balance(node, k, f"n{s}", sign * across * over)
                self._balance(node, k, f"N{s}", -sign * along)

    def _balance(self, node: int, component: int, name: str, value: Any) -> None:
        row = self.balance[node][component]
        row[name] = row.get(name, self.number(0)) + value

    def _add_support(self, i: int, node: Node) -> None:
        number = self.number
        held = [(f"R{i}.{r}", direction, k) for r, (direction, k) in enumerate(node.supports)]
        for name, direction, stiffness in held:
            self.forces.append(name)
            row = {f"d{k}{i}": number(part) for k, part in zip("xy", direction, strict=True)}
            if stiffness < math.inf:
                row[name] = 1 / number(stiffness)
            self.rows.append((row, number(0)))
            for k in (0, 1):
                self._balance(i, k, name, -number(direction[k]))
        if node.rotational_stiffness:
            name = f"C{i}"
            self.forces.append(name)
            row = {f"t{i}": number(1)}
            if node.rotational_stiffness < math.inf:
                row[name] = 1 / number(node.rotational_stiffness)
            self.rows.append((row, number(0)))
            self._balance(i, 2, name, number(-1))

    def exact_solution(self) -> dict[str, Any]:
        """Return the solution in fractions; forces that nothing tells are zero."""
        pending = [({key: value for key, value in row.items() if value}, rest) for row, rest in self.rows]
        done: list[tuple[str, Row, Any]] = []
        for name in [*self.moved, *self.forces]:
            found = min(
                (k for k, (row, _) in enumerate(pending) if name in row),
                key=lambda k: len(pending[k][0]),
                default=None,
            )
            if found is None:
                if name in self.moved:
                    raise self._mechanism(name)
                continue
            row, rest = pending.pop(found)
            pivot = row.pop(name)
            row = {key: value / pivot for key, value in row.items()}
            rest = rest / pivot
            done.append((name, row, rest))
            for k, (other, value) in enumerate(pending):
                factor = other.pop(name, 0)
                if factor:
                    for key, one in row.items():
                        changed = other.get(key, 0) - factor * one
                        if changed:
                            other[key] = changed
                        else:
                            other.pop(key, None)
                    pending[k] = (other, value - factor * rest)
        values: dict[str, Any] = dict.fromkeys([*self.moved, *self.forces], self.number(0))
        for name, row, rest in reversed(done):
            values[name] = rest - sum((value * values[key] for key, value in row.items()), self.number(0))
        return values

    def solution(self) -> dict[str, Any]:
        """Return the solution in floats; of forces that nothing tells the smallest."""
        length = max(one.length for one in self.stretches)
        force = max(one.stretch.beam.mean_bending_stiffness for one in self.stretches) / length**2
        units = {"d": length, "t": 1.0, "m": force * length, "n": force * length, "C": force * length}
        names = [*self.moved, *self.forces]
        index = {name: k for k, name in enumerate(names)}
        unit = np.array([units.get(name[0], force) for name in names])
        matrix, rest = np.zeros((len(self.rows), len(names))), np.zeros(len(self.rows))
        for k, (row, value) in enumerate(self.rows):
            for name, entry in row.items():
                matrix[k, index[name]] += entry
            rest[k] = value
        matrix *= unit
        size = np.abs(matrix).max(axis=1)
        matrix, rest = matrix / size[:, None], rest / size
        moving = matrix[:, : len(self.moved)]
        free = np.linalg.svd(moving)[2][np.linalg.matrix_rank(moving, tol=1e-9) :]
        if len(free):
            raise self._mechanism(self.moved[int(np.argmax(np.abs(free[0])))])
        found = np.linalg.lstsq(matrix, rest, rcond=1e-13)[0]
        # Once more, for what rounding has left.
        found = (found + np.linalg.lstsq(matrix, rest - matrix @ found, rcond=1e-13)[0]) * unit
        return dict(zip(names, found.tolist(), strict=True))

    def _mechanism(self, name: str) -> ValueError:
        node = self.parts.nodes[int(name[2:] if name[0] == "d" else name[1:])].name
        return ValueError(
            f"structure must be held still by its supports, got one that moves freely, at {node} among others"
        )

    def read(self, values: dict[str, Any]) -> tuple[Any, Any, Any]:
        """Return m₀, m₁, v₀, v₁, N of every stretch; reactions; displacements of nodes.

        What nothing tells is None as N, and nan as a reaction.
        """
        number, ends = self.number, list[tuple[Any, ...]]()
        untold, unshared = self._untold(values)
        for s, one in enumerate(self.stretches):
            across = tuple(
                sum(
                    number(part) * values[f"d{k}{node}"]
                    for k, part in zip("xy", one.stretch.normal, strict=True)
                )
                for node in one.stretch.nodes
            )
            ends.append((values[f"m{s}"], values[f"n{s}"], *across, None if untold[s] else values[f"N{s}"]))
        reactions, moved = {}, {}
        for i, node in enumerate(self.parts.nodes):
            turn = values[f"t{i}"] if self.turning[i] else number(0)
            moved[node.name] = (values[f"dx{i}"], values[f"dy{i}"], turn)
            if not node.supports and not node.rotational_stiffness:
                continue
            names = [f"R{i}.{r}" for r in range(len(node.supports))]
            push = [math.nan if name in unshared else values[name] for name in names]
            force = tuple(
                sum(
                    (p * number(d[k]) for p, (d, _) in zip(push, node.supports, strict=True) if d[k]),
                    number(0),
                )
                for k in (0, 1)
            )
            reactions[node.name] = (*force, values[f"C{i}"] if node.rotational_stiffness else number(0))
        return tuple(ends), reactions, moved

    def _untold(self, values: dict[str, Any]) -> tuple[list[bool], set[str]]:
        """Return whether each stretch may have an axial force without any load, and reactions that may.

        Of the reactions only those to a pull along what holds itself so: without one they are zero there.
        """
        pulls, names = [], [f"N{s}" for s in range(len(self.stretches))]
        owner = [-1 - s for s in range(len(self.stretches))]
        for one in self.parts.stretches:
            pull = np.zeros((len(self.parts.nodes), 2))
            for node, sign in zip(one.nodes, (1.0, -1.0), strict=True):
                pull[node] += sign * np.array(one.axis)
            pulls.append(pull.ravel())
        for i, supported in enumerate(self.parts.nodes):
            for r, (unit, stiffness) in enumerate(supported.supports):
                if stiffness == math.inf:
                    push = np.zeros((len(self.parts.nodes), 2))
                    push[i] = unit
                    pulls.append(push.ravel())
                    names.append(f"R{i}.{r}")
                    owner.append(i)
        _, size, right = np.linalg.svd(np.array(pulls).T)
        free = right[int(np.sum(size > 1e-9)) :]
        shared = free.T @ free
        together = np.abs(shared) > 1e-9
        force = np.array([float(values[name]) for name in names])
        own = np.equal.outer(owner, owner)
        pulled = np.abs((shared * own) @ force) > 1e-9 * max(abs(float(values[name])) for name in self.forces)
        told = ~(together & pulled).any(axis=1)
        count = len(self.stretches)
        unshared = {name for name, is_told in zip(names[count:], told[count:], strict=True) if not is_told}
        return together.diagonal()[:count].tolist(), unshared
