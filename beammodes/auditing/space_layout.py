"""The rule that a row in space follows, whose motions move each other: curved and pretwisted rods.

Nodes are compared by their distances from each other, pieces by their shares of mass and springs by their
sizes, so that it does not matter how the file stands in its world.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from beammodes.accuracy.chain_against_rod import rod_errors
from beammodes.auditing.judged_pieces import UNKNOWN
from beammodes.auditing.space_row import SpaceRow
from beammodes.auditing.told_audit import listed_errors
from beammodes.chains.rules import RULES
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.numerics.arrays import Floats
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodEnds

__all__ = ["SpaceLayout", "space_layout"]

#: Relative difference up to which nodes and springs are those of a rule: files round their numbers.
_SAME = 1e-3
#: Relative difference up to which shares of mass are a rule's.
_SHARE = 2e-2
_NO_LENGTH = 1e-12
_BETTER = "gregory"
_LISTED = 3


@dataclass(frozen=True)
class SpaceLayout:
    """The name of a rule, or "no known layout", and a sentence on it and on better springs."""

    name: str
    remark: str


def space_layout(
    row: SpaceRow, rod: Rod, ends: RodEnds, errors: Floats, only: int | None = None
) -> SpaceLayout:
    """Return the rule whose nodes and springs a row has, for a rod of any shape at rest.

    With `only`, hinges turn about that axis of the section, 1 or 2, and others have no springs.
    """
    turning = [0, 1, 2] if only is None else [only]
    places, shares, springs = _nodes(row)
    found: tuple[str, int] | None = None
    better: SpatialChain | None = None
    for chain in _alike(places, shares, rod, ends):
        if chain.rule.name == _BETTER:
            better = chain
        if found is None and _same_springs(chain.joint_stiffness[:, turning], springs):
            found = (chain.rule.name, chain.segments)
    if found is None:
        remark = f"{UNKNOWN}: nodes or springs are those of no rule with equal segments"
    else:
        remark = f"nodes and springs are those of {found[0]} at N = {found[1]}"
    if better is not None and (found is None or found[0] != _BETTER):
        own = rod_errors(better, len(errors))
        if abs(own[0]) < abs(errors[0]):
            nodes = better.joint_stiffness[:_LISTED, turning]
            told = [", ".join(f"{value:.5g}" for value in node) for node in nodes]
            axes = "x, y and z" if only is None else "xyz"[only]
            remark += (
                f"; at these nodes {_BETTER} has springs about the section's {axes} of "
                f"({'), ('.join(told)}), ...: {listed_errors(own)}"
            )
    return SpaceLayout(UNKNOWN if found is None else found[0], remark)


def _nodes(row: SpaceRow) -> tuple[Floats, Floats, list[list[float]]]:
    """Return the places of hinges, the masses after each place, and the stiffnesses at it, ascending."""
    places: list[Floats] = []
    springs: list[list[float]] = []
    masses: list[float] = []
    group = -1
    for each in row.coordinates:
        if each.group < 0 or each.kind != "hinge":
            continue
        if not places or np.linalg.norm(each.joint.position - places[-1]) > _NO_LENGTH:
            springs.append([])
            masses.append(0.0)
            places.append(each.joint.position)
        if each.group != group:
            masses[-1] += row.groups[each.group].inertial.mass
            group = each.group
        springs[-1].append(each.stiffness)
    return np.array(places).reshape(-1, 3), np.array(masses), [sorted(node) for node in springs]


def _alike(places: Floats, masses: Floats, rod: Rod, ends: RodEnds) -> Iterator[SpatialChain]:
    """Yield chains of rules that have nodes at these distances, and these shares of mass after each."""
    if not len(places):
        return
    step = np.linalg.norm(np.diff(places, axis=0), axis=1)
    reach = np.linalg.norm(places - places[0], axis=1)
    for count in range(max(1, len(places) - 1), len(places) + 2):
        for rule in RULES.values():
            try:
                chain = SpatialChain(rod, ends, count, rule)
            except ValueError:
                # No positive springs for these ends and N, or a pattern that does not fit N.
                continue
            if len(chain.hinge_position) != len(places):
                continue
            points = rod.frames(chain.hinge_position)[1]
            slack = _SAME * rod.length / count
            off = np.abs(np.linalg.norm(points - points[0], axis=1) - reach).max()
            apart = np.abs(np.linalg.norm(np.diff(points, axis=0), axis=1) - step).max(initial=0.0)
            due = chain.tree.mass[-len(places) :]
            uneven = np.abs(due / due.sum() * masses.sum() / masses - 1).max() if masses.all() else np.inf
            if max(off, apart) <= slack and uneven <= _SHARE:
                yield chain


def _same_springs(stiffness: Floats, springs: list[list[float]]) -> bool:
    """Return True if every node has the springs of a chain's, in whatever order."""
    for own, node in zip(stiffness.tolist(), springs, strict=False):
        due = sorted(value for value in own if np.isfinite(value))
        if len(due) != len(node) or not np.allclose(node, due, rtol=_SAME, atol=0.0):
            return False
    return len(springs) == len(stiffness)
