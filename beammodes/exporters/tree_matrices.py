"""Mass, stiffness and damping of an exported tree at rest, in its own joint coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.exporters.model_tree import Tree, placed
from beammodes.numerics.arrays import Floats

__all__ = ["TreeMatrices", "tree_matrices"]


@dataclass(frozen=True, eq=False)
class TreeMatrices:
    """M, K and D of small motion, each over the joints' coordinates in the order of the file.

    Attributes
    ----------
    inertia, stiffness : ndarray, shape (coordinates, coordinates)
    joint_damping, tie_damping : ndarray, shape (coordinates, coordinates)
    held : ndarray, shape (constraints, coordinates)
        Rows of the ties that are held at zero.
    """

    inertia: Floats
    stiffness: Floats
    joint_damping: Floats
    tie_damping: Floats
    held: Floats


def tree_matrices(
    tree: Tree,
    pull: Floats | None = None,
    *,
    plane: tuple[tuple[int, int, int], tuple[int, int, int]] | None = None,
) -> TreeMatrices:
    """Return the matrices of a tree.

    Parameters
    ----------
    tree : Tree
    pull : ndarray, shape (bodies, 3, 3), optional [N m]
        What a load adds to ∂²V/∂θ² of each body's rotation, in its own axes.
    plane : pair of axes, optional
        Only the slides along the first and the hinges about the second.

    Examples
    --------
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> from beammodes.problem.beam import Beam
    >>> tree_matrices(planar_tree(Chain(Beam.unit(), "clamped-free", 2, "naive"))).stiffness.tolist()
    [[2.0, 0.0], [0.0, 2.0]]
    """
    starts, centres = np.zeros((2, len(tree.bodies), 3))
    moments, frames = np.zeros((2, len(tree.bodies), 3, 3))
    names: list[str] = []
    carrier, slides, hinges, springs, dampers = [], [], [], [], []
    still = np.zeros(3)
    for i, (body, place, frame) in enumerate(placed(tree.bodies)):
        starts[i], centres[i] = place, place + frame @ body.centre
        moments[i] = frame @ np.array(body.inertia) @ frame.T
        frames[i] = frame
        for joint in body.joints:
            if plane is not None and joint.axis != plane[joint.kind == "hinge"]:
                continue
            kind = joint.kind
            own = np.eye(3) if kind in ("ball", "free") else np.array([joint.axis], dtype=np.float64)
            along = own if kind in ("slide", "free") else own[:0]
            about = own if kind != "slide" else own[:0]
            for slide, hinge in [*((axis, still) for axis in along), *((still, axis) for axis in about)]:
                slides.append(frame @ slide)
                hinges.append(frame @ hinge)
                carrier.append(i)
                names.append(joint.name)
                springs.append(joint.stiffness)
                dampers.append(joint.damping)
    at, slide, hinge = np.array(carrier, dtype=int), np.reshape(slides, (-1, 3)), np.reshape(hinges, (-1, 3))
    # Bodies by coordinates: what a joint moves are its own body and those beyond.
    moves = (at <= np.arange(len(starts))[:, None]).astype(np.float64)[..., None]
    turn = moves * hinge
    arm = moves * (slide + np.cross(hinge, centres[:, None] - starts[at]))
    mass = np.array([body.mass for body in tree.bodies])
    count = len(at)
    # Over bodies and the three directions at once.
    arm, turn = (np.swapaxes(each, 1, 2) for each in (arm, turn))
    heavy, turned = mass[:, None, None] * arm, moments @ turn
    inertia = _summed(arm, heavy) + _summed(turn, turned)
    stiffness, joints, ties = np.diag(springs), np.diag(dampers), np.zeros((count, count))
    if pull is not None:
        stiffness = stiffness + _summed(turn, frames @ pull @ np.swapaxes(frames, 1, 2) @ turn)
    held = []
    for tie in tree.ties:
        arms = dict(tie.terms)
        if not set(arms) <= set(names):
            continue
        row = np.array([arms.get(name, 0.0) for name in names])
        if tie.stiffness == math.inf:
            held.append(row)
        else:
            stiffness = stiffness + tie.stiffness * np.outer(row, row)
            ties += tie.damping * np.outer(row, row)
    return TreeMatrices(inertia, stiffness, joints, ties, np.reshape(held, (-1, count)))


def _summed(left: Floats, right: Floats) -> Floats:
    """Return  Σ leftᵀ right  over bodies."""
    flat, other = (each.reshape(-1, each.shape[-1]) for each in (left, right))
    product: Floats = flat.T @ other
    return product
