"""The stable step of a tree whose far end a constraint holds, in engines that take dampers implicitly.

MuJoCo finds the force of a constraint with the plain inertia M, and then divides all forces by M + h D: hard
dampers weaken what the constraint does. With the row J of the held deflection,

    M a = -K q - D_all v + Jᵀ λ,   J a = -J v/h - J q/(4 h²),   v' = v + h (M + h D)⁻¹ M a,   q' = q + h v'.

The chain's own matrices, in which the end is held by construction, do not know that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from beammodes.exporters.planar_tree import Tree

__all__ = ["MAX_HELD", "held_step"]

Array = NDArray[np.float64]

#: Trees of more joints are not solved: each of some forty trial steps takes the eigenvalues of 2 N rows.
MAX_HELD = 40
# Of the step that is stable as a chain, the least that is tried; and how many.
_SHORTEST, _TRIALS = 1e-3, 24


def held_step(tree: Tree, letter: str, longest: float, pull: Sequence[float], *, tendons: bool) -> float:
    """Return the largest step up to `longest` below which a tree's motion in one plane does not grow [s].

    Parameters
    ----------
    tree : Tree
        With a tie of infinite stiffness.
    letter : str
        "z" or "y", the direction of deflection.
    longest : float [s]
        Where it is unstable as a chain.
    pull : sequence of float, one a body [N m]
        What a load adds to ∂²V/∂θ² of the bodies' angles.
    tendons : bool
        Whether dampers of ties are taken implicitly, as those of joints are.
    """
    inertia, stiffness, joints, ties, held = _matrices(tree, letter, pull)
    if held is None or not math.isfinite(longest):
        return longest
    implicit = joints + ties if tendons else joints
    lift, size = np.linalg.solve(inertia, held), len(inertia)
    # Accelerations of (q, v) without the constraint.
    free = -np.linalg.solve(inertia, np.hstack([stiffness, joints + ties]))

    def grows(step: float) -> bool:
        wanted = -np.concatenate([held / (4 * step**2), held / step])
        bound = free + np.outer(lift, (wanted - held @ free)) / (held @ lift)
        kick = step * np.linalg.solve(inertia + step * implicit, inertia @ bound)
        speed = kick + np.hstack([np.zeros((size, size)), np.eye(size)])
        place = step * speed + np.hstack([np.eye(size), np.zeros((size, size))])
        return bool(np.abs(np.linalg.eigvals(np.vstack([place, speed]))).max() > 1 + 1e-7)

    steps = (longest * np.geomspace(_SHORTEST, 1 - 1e-9, _TRIALS)).tolist()
    first = next((k for k, step in enumerate(steps) if grows(step)), None)
    if first is None:
        return longest
    below, above = (steps[first - 1] if first else 0.0), steps[first]
    for _ in range(6):
        middle = (below + above) / 2
        below, above = (below, middle) if grows(middle) else (middle, above)
    return below


def _matrices(
    tree: Tree, letter: str, pull: Sequence[float]
) -> tuple[Array, Array, Array, Array, Array | None]:
    """Return M, K, D of the joints, D of the ties, and the row of what is held, in one plane's joints."""
    slide, hinge = {"z": ((0, 0, 1), (0, -1, 0)), "y": ((0, 1, 0), (0, 0, 1))}[letter]
    names: list[str] = []
    # Of every body so far: where the joints are, and what turns it and shifts it.
    places: list[float] = []
    kinds: list[bool] = []
    rows: list[tuple[Array, Array, float, float, float]] = []
    springs: list[tuple[float, float]] = []
    start = 0.0
    about = 1 if letter == "z" else 2
    for body, own in zip(tree.bodies, pull, strict=True):
        start += body.position
        for joint in body.joints:
            if joint.axis in (slide, hinge):
                names.append(joint.name)
                places.append(start)
                kinds.append(joint.axis == hinge)
                springs.append((joint.stiffness, joint.damping))
        turn = np.array(kinds, dtype=float)
        arm = np.where(kinds, start + body.centre - np.array(places), 1.0)
        rows.append((arm, turn, body.mass, body.inertia[about], own))
    size = len(names)
    inertia, stiffness = np.zeros((size, size)), np.diag([k for k, _ in springs])
    for arm, turn, mass, moment, own in rows:
        across, turned = (np.pad(row, (0, size - len(row))) for row in (arm, turn))
        inertia += mass * np.outer(across, across) + moment * np.outer(turned, turned)
        stiffness += own * np.outer(turned, turned)
    joints, ties, held = np.diag([d for _, d in springs]), np.zeros((size, size)), None
    for tie in tree.ties:
        arms = dict(tie.terms)
        if not set(arms) <= set(names):
            continue
        row = np.array([arms.get(name, 0.0) for name in names])
        if tie.stiffness == math.inf:
            held = row
        else:
            stiffness += tie.stiffness * np.outer(row, row)
            ties += tie.damping * np.outer(row, row)
    return inertia, stiffness, joints, ties, held
