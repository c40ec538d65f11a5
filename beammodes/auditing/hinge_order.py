"""In which order the hinges of a node turn, and what that costs where rotations are large.

Small vibration does not know the order. In large rotations hinges one after the other store what they turn
themselves, not the bending and twist of the rod (see `joint_laws`): in one order at every node an error of
first order in 1/N, whatever the springs; with the order reversed at every other node, or with one hinge a
node about two axes by turns, of second order.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from beammodes.auditing.space_row import SpaceRow

__all__ = ["HingeOrder", "hinge_order"]

_NO_LENGTH = 1e-9
_FIRST = "first order in 1/N for large rotations"
_SECOND = "second order in 1/N for large rotations"


@dataclass(frozen=True)
class HingeOrder:
    """The order by name, as of `JOINT_LAWS` where it is one of these, and what it means in a sentence."""

    name: str
    remark: str


def hinge_order(row: SpaceRow, letters: Mapping[int, str], names: Mapping[int, str]) -> HingeOrder:
    """Return the order of a row's hinges.

    `letters` are the axes about which motions turn, x along the line, `names` those of the motions. Empty
    where all hinges turn about the same axis.
    """
    nodes: list[tuple[int, ...]] = []
    place = None
    hinges = [each for each in row.coordinates if each.group >= 0 and each.kind == "hinge"]
    if not hinges or any(each.motion is None for each in hinges):
        return HingeOrder("", "")
    if all(each.joint.kind == "ball" for each in hinges):
        return HingeOrder("ball", f"joints are balls, which turn in no order: {_SECOND}")
    for each in hinges:
        if place is None or np.linalg.norm(each.joint.position - place) > _NO_LENGTH:
            nodes.append(())
            place = each.joint.position
        nodes[-1] += (-1 if each.motion is None else each.motion,)
    most = max(map(len, nodes))
    # A node at an end may have fewer hinges.
    whole = [node for node in nodes if len(node) == most]
    name = "".join(letters[motion] for motion in whole[0])
    told = ", then ".join(names[motion] for motion in whole[0])
    if most == 1 and len(set(nodes)) > 1 and all(one != other for one, other in itertools.pairwise(nodes)):
        turns = list(dict.fromkeys(motion for (motion,) in nodes))
        return HingeOrder(
            f"{''.join(letters[motion] for motion in turns)}_by_turns",
            f"hinges stand by turns, of {' and '.join(names[motion] for motion in turns)}: {_SECOND}",
        )
    if len(whole) == 1 or (most == 1 and len(set(nodes)) == 1):
        return HingeOrder("", "")
    if len(set(whole)) == 1 and most > 1:
        return HingeOrder(
            name,
            f"hinges of {told}, in this fixed order at every node: {_FIRST}, whatever the springs; "
            "reverse it at every other node",
        )
    both = {whole[0], whole[0][::-1]}
    if most > 1 and set(whole) == both and all(one != other for one, other in itertools.pairwise(whole)):
        return HingeOrder(
            f"{name}_alternating", f"hinges of {told}, the order reversed at every other node: {_SECOND}"
        )
    return HingeOrder(
        "uneven", f"hinges in orders that do not alternate: {_FIRST}; reverse one order at every other node"
    )
