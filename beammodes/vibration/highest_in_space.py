"""The highest frequency of a chain in space, about which axes it turns the joints, and damping of its modes.

A short chain is solved. A long one is bounded by its joints, as a planar one is: of the pieces on either side
of a joint each gives a share of its inertia, and kinetic and stored energy are sums over joints, so that

    ω² ≤ max_j  λ_max(M_j⁻¹ K_j)

in the joint's displacement, the turn of the piece before it and its own three turns. What has no inertia
follows at rest, and what a support holds does not move. That is 48 EI/(ρA ℓ⁴) of a straight chain in bending
and 4 GJ/(ρI_p ℓ²) in twist, which long chains reach; half stubs leave it a fifth too high, curvature a half.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from beammodes.chains.rigid_tree import RigidTree, Support
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix
from beammodes.problem.load_in_space import SpatialLoad
from beammodes.vibration.damping import Damping, ModalDamping
from beammodes.vibration.modes_in_space import scaled_tree
from beammodes.vibration.tree_form import TreeForm, tree_form

__all__ = ["MOST_SOLVED", "HighestInSpace", "damping_in_space", "highest_in_space", "resisted_across"]

#: Joint coordinates of a chain that is solved; longer ones are bounded.
MOST_SOLVED = 600

#: Inertia that counts as none beside the largest of its joint, and stiffness likewise.
_NONE = 1e-12


class HighestInSpace(NamedTuple):
    """The highest frequency [rad/s], and the parts of its energy that turns about x, y and z store."""

    angular_frequency: float
    shares: Floats


def highest_in_space(chain: SpatialChain, load: SpatialLoad | None = None) -> HighestInSpace:
    """Return the highest frequency of a chain in space, or a bound just above it of a long one.

    Under a load it is that of a chain that hangs, each piece pulled by all that lies beyond it.

    Examples
    --------
    >>> import beammodes as bm
    >>> rod = bm.Rod(1.0, 1.0, 1.0, 1.0, polar_inertia_per_length=1e-4)
    >>> chain = bm.SpatialChain(rod, "clamped-clamped", segments=4, rule="double_wall")
    >>> highest = highest_in_space(chain)
    >>> round(highest.angular_frequency, 6), highest.shares.round(9).tolist()     # 2 N √(GJ/ρIp): it twists
    (800.0, [1.0, 0.0, 0.0])
    """
    length, stiffness, mass = chain.rod.units
    tree = scaled_tree(chain.tree, length, stiffness, mass)
    pull = _pull(chain, tree, load)
    if 3 * (tree.pieces - 1) <= MOST_SOLVED:
        inverse, _, x = _all(tree_form(tree), pull)
        if not len(inverse):
            return HighestInSpace(0.0, np.zeros(3))
        turns = x[len(x) - 3 * (tree.pieces - 1) :, -1].reshape(-1, 3)
        omega, shares = 1.0 / float(inverse[-1]), (turns**2).sum(axis=0)
    else:
        omega, shares = _bounded(tree, 1.0 / chain.segments, pull)
    whole = float(shares.sum())
    return HighestInSpace(omega * math.sqrt(stiffness / mass) / length, shares / whole if whole else shares)


class _Modes(NamedTuple):
    """All modes of unit stored energy, ascending: 1/ω, what stores it, and turns and readings of springs."""

    inverse: Floats
    stored: Floats
    turned: Floats


def _all(form: TreeForm, pull: Floats | None = None) -> _Modes:
    complete = np.linalg.qr(form.forbidden, mode="complete")[0]
    stored = complete[:, form.forbidden.shape[1] :]
    if pull is not None:
        turned = form.twists(form.allowed(stored))[:, 3:]
        taut = np.eye(stored.shape[1]) + np.einsum("pik,pij,pjl->kl", turned, pull, turned, optimize=True)
        stored = np.linalg.solve(np.linalg.cholesky(taut), stored.T).T
    x = form.allowed(stored)
    if not x.shape[1]:
        return _Modes(np.zeros(0), stored, x)
    _, inverse, turn = np.linalg.svd(np.linalg.qr(form.kinetic(x), mode="r"))
    # Motions without inertia are no modes.
    count = int((inverse > 1e-13 * inverse[0]).sum())
    return _Modes(inverse[:count], stored @ turn[:count].T, x @ turn[:count].T)


def damping_in_space(chain: SpatialChain, damping: Damping, load: SpatialLoad | None = None) -> ModalDamping:
    """Return the undamped modes' frequencies and G of a chain that is short enough to be solved.

    Nothing is told apart as `far_support`.

    Examples
    --------
    >>> import beammodes as bm
    >>> rod = bm.Rod(1.0, 1.0, 1.0, 1.0, polar_inertia_per_length=0.01)
    >>> chain = bm.SpatialChain(rod, "clamped-free", segments=2)
    >>> modal = damping_in_space(chain, bm.Damping(mass=0.1, stiffness=0.01))
    >>> bool(np.allclose(modal.coupling.diagonal(), 0.1 + 0.01 * modal.angular_frequency**2))
    True
    """
    length, stiffness, mass = chain.rod.units
    rate = math.sqrt(stiffness / mass) / length
    tree = scaled_tree(chain.tree, length, stiffness, mass)
    form = tree_form(tree)
    inverse, stored, x = _all(form, _pull(chain, tree, load))
    # Of unit modal mass: what springs store, and how joints turn.
    stored, turns = stored / inverse, form.flexibility_root[:, None] * x / inverse
    own = damping.own_of_joints(chain)
    turns = turns[len(x) - own.size :]
    springs = damping.stiffness * (stored.T @ stored)
    dampers = (turns.T * (own.ravel() / stiffness)) @ turns
    coupling = rate**2 * (springs + dampers) + damping.mass * np.eye(len(inverse))
    drag = damping.mass if form.rigid.size else 0.0
    return ModalDamping(rate / inverse, coupling, np.zeros_like(coupling), drag)


def _pull(chain: SpatialChain, tree: RigidTree, load: SpatialLoad | None) -> Floats | None:
    """Return what a load adds to ∂²V/∂θ² of each piece's rotation by pulling along it, in the tree's units.

    No shape at rest pulls harder than one that hangs. Where the other end, too, is tied to the ground, or
    alone, every piece is pulled with the whole load; one that nothing holds falls freely.
    """
    if load is None or not (any(load.force) or any(load.gravity)):
        return None
    length, stiffness, mass = chain.rod.units
    left, right = (bool(end.stiffness.any()) for end in (chain.ends.left, chain.ends.right))
    weight = math.hypot(*load.gravity) * (mass * length / stiffness) * (left or right)
    force = math.hypot(*load.force) * (length / stiffness)
    beyond = np.cumsum(tree.mass[::-1])[::-1] - tree.mass
    if right or not left:
        beyond = np.full_like(beyond, tree.mass.sum())
    tip = np.diff(np.vstack([tree.joint_place, tree.supports[-1].place]), axis=0)
    return resisted_across(tip, weight * beyond + force) + resisted_across(
        tree.centre - tree.joint_place, weight * tree.mass
    )


def resisted_across(arm: Floats, force: Floats) -> Floats:
    """Return what a force that pulls along each arm resists: turns across it, not about it.

    Examples
    --------
    >>> resisted_across(np.array([[2.0, 0.0, 0.0]]), np.array([3.0]))[0].diagonal().tolist()
    [0.0, 6.0, 6.0]
    """
    square = (arm**2).sum(axis=1)[:, None, None]
    length = np.sqrt(np.where(square > 0.0, square, 1.0))
    resisted: Floats = (
        force[:, None, None] / length * (square * np.eye(3) - arm[:, :, None] * arm[:, None, :])
    )
    return resisted


def _bounded(tree: RigidTree, ell: float, pull: Floats | None) -> tuple[float, Floats]:
    """Return the largest frequency of a joint on its own, and what its three turns store in it."""
    joints = np.arange(1, tree.pieces)
    place, frame = tree.joint_place[1:], tree.joint_frame[1:]
    inertia, stiffness = np.zeros((2, len(joints), 9, 9))
    allowed = np.broadcast_to(np.eye(9), inertia.shape).copy()
    # In (displacement over ell, turn of the piece before, own turns about the joint's axes).
    turned = np.zeros((len(joints), 2, 3, 9))
    turned[:, :, :, 3:6] = np.eye(3)
    turned[:, 1, :, 6:] = frame
    moved = np.zeros((3, 9))
    moved[:, :3] = ell * np.eye(3)
    for side, pieces in enumerate((joints - 1, joints)):
        share = np.where((pieces == 0) | (pieces == tree.pieces - 1), 1.0, 0.5)
        arm = tree.centre[pieces] - place
        at_centre = moved - cross_matrix(arm) @ turned[:, side]
        weight = (share * tree.mass[pieces])[:, None, None]
        inertia += weight * (np.swapaxes(at_centre, 1, 2) @ at_centre)
        about = share[:, None, None] * tree.inertia[pieces]
        inertia += np.swapaxes(turned[:, side], 1, 2) @ about @ turned[:, side]
        if pull is not None:
            about = share[:, None, None] * pull[pieces]
            stiffness += np.swapaxes(turned[:, side], 1, 2) @ about @ turned[:, side]
    give = tree.joint_flexibility[1:]
    own = np.divide(1.0, give, out=np.zeros_like(give), where=give > 0.0)
    at = np.arange(6, 9)
    stiffness[:, at, at] += own
    allowed[:, at, at] = give > 0.0
    for support in tree.supports:
        joint, side = (0, 0) if support.piece == 0 else (-1, 1)
        _hold(support, place[joint], moved, turned[joint, side], stiffness[joint], allowed[joint])
    inertia, stiffness = (allowed @ matrix @ allowed for matrix in (inertia, stiffness))
    size, axes = np.linalg.eigh(inertia)
    moves = size > _NONE * size[:, -1:]
    held = np.swapaxes(axes, 1, 2) @ stiffness @ axes
    at_rest = np.flatnonzero(~moves.all(axis=1))
    if len(at_rest):
        some, still = held[at_rest], ~moves[at_rest]
        inner = some * still[:, :, None] * still[:, None, :]
        held[at_rest] = some - some @ _inverse(inner, some) @ some
    root = np.where(moves, 1.0 / np.sqrt(np.where(moves, size, 1.0)), 0.0)
    squares, shapes = np.linalg.eigh(root[:, :, None] * held * root[:, None, :])
    worst = int(np.argmax(squares[:, -1]))
    motion = axes[worst] @ (root[worst] * shapes[worst, :, -1])
    if (~moves[worst]).any():
        inner = axes[worst][:, ~moves[worst]]
        across = inner.T @ stiffness[worst]
        motion = motion - inner @ (_inverse(across @ inner, stiffness[worst]) @ (across @ motion))
    return math.sqrt(max(0.0, float(squares[worst, -1]))), own[worst] * motion[6:] ** 2


def _inverse(inner: Floats, whole: Floats) -> Floats:
    """Return the inverse of what of a symmetric matrix is more than rounding of a larger one."""
    size, axes = np.linalg.eigh(inner)
    largest = np.abs(whole).max(axis=(-2, -1), initial=0.0)[..., None]
    kept = size > _NONE * largest
    scaled = axes * np.where(kept, 1.0 / np.where(kept, size, 1.0), 0.0)[..., None, :]
    inverse: Floats = scaled @ np.swapaxes(axes, -1, -2)
    return inverse


def _hold(
    support: Support, place: Floats, moved: Floats, turned: Floats, stiffness: Floats, allowed: Floats
) -> None:
    """Add a support's springs to its joint, and take what it holds out of what is allowed; in place."""
    arm = cross_matrix(support.place - place)
    rows = np.vstack([support.frame.T @ (moved - arm @ turned), support.frame.T @ turned])
    sprung, held = np.isfinite(support.stiffness), np.isinf(support.stiffness)
    stiffness += rows[sprung].T @ (support.stiffness[sprung, None] * rows[sprung])
    if held.any():
        # Rows that the joint's rigid axes leave, made orthonormal.
        _, size, across = np.linalg.svd(rows[held] @ allowed, full_matrices=False)
        taken = across[size > _NONE * size.max(initial=0.0)]
        allowed -= taken.T @ taken
