"""A tree of rigid pieces as a factor F D^{-½}, whose largest singular values are 1/ω of its lowest modes.

A motion is given by what its springs store: x, the turns of the joints and the readings of springs at the
supports, each times the root of its stiffness. K is then the identity, and the mass is |F D^{-½} x|², by sums
along the tree. Nothing is solved, nothing is assembled, and flexibilities may be zero; so small frequencies
keep their digits, and a chain of 10⁵ pieces costs 10⁵ times a piece.

What the supports do besides: six of their readings, the stiffest independent ones, say how the root moves.
Of these, held ones are zero, sprung ones coordinates, and those that nothing stiffens rigid-body modes,
which are taken out of every motion. The readings left over are linear in x: held ones exclude directions of
x, springs stiffen some.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from beammodes.chains.rigid_tree import RigidTree
from beammodes.numerics.arrays import Floats

__all__ = ["TreeForm", "tree_form"]

#: Readings nearer to dependent than this, relatively, are dependent.
_INDEPENDENT = 1e-9


@dataclass(frozen=True)
class TreeForm:
    """F D^{-½} of a tree on what its supports allow, on arrays x of shape (coordinates, columns).

    Attributes
    ----------
    tree : RigidTree
        In units of which all numbers are of order 1.
    flexibility_root : ndarray, shape (coordinates,)
        Of sprung readings, then of three turns for each joint.
    root_twist : ndarray, shape (6, coordinates)
        The root's twist for unit readings and turns.
    forbidden : ndarray, shape (coordinates, constraints)
        Orthonormal: what held readings exclude.
    stiffened, softening : ndarray, shape (coordinates, springs), (springs,)
        Orthonormal directions that further springs stiffen, and (1 + r²)^{-½} - 1 of each.
    rigid : ndarray, shape (6, modes)
        Twists of the rigid-body modes, of unit modal mass.
    """

    tree: RigidTree
    flexibility_root: Floats
    root_twist: Floats
    forbidden: Floats
    stiffened: Floats
    softening: Floats
    rigid: Floats

    @property
    def elastic_modes(self) -> int:
        """Number of motions that store energy and have inertia, or could."""
        turning = int((self.flexibility_root > 0.0).sum())
        return max(0, turning - int(self.forbidden.shape[1]))

    def allowed(self, w: Floats) -> Floats:
        """Return the x of w: without what held readings exclude, and softened where springs resist."""
        x = w - self.forbidden @ (self.forbidden.T @ w)
        if self.stiffened.size:
            x = x + self.stiffened @ (self.softening[:, None] * (self.stiffened.T @ x))
        return x

    def twists(self, x: Floats) -> Floats:
        """Return each piece's twist, shape (pieces, 6, columns), rigid-body modes taken out."""
        turns = self.flexibility_root[:, None] * x
        joints = turns[len(turns) - 3 * (self.tree.pieces - 1) :].reshape(self.tree.pieces - 1, 3, x.shape[1])
        steps = np.empty((self.tree.pieces, 6, x.shape[1]))
        np.matmul(self.tree.joint_twists[1:], joints, out=steps[1:])
        steps[0] = self.root_twist @ turns
        moved = self.tree.from_root(steps)
        if self.rigid.size:
            amount = np.tensordot(self.rigid_images(), self.tree.mass_root @ moved, ((0, 1), (0, 1)))
            moved -= self.rigid @ amount
        return moved

    def kinetic(self, x: Floats) -> Floats:
        """Return F D^{-½} x, shape (6 pieces, columns): |.|² is twice the kinetic energy of motion x."""
        return (self.tree.mass_root @ self.twists(x)).reshape(-1, x.shape[1])

    def adjoint(self, image: Floats) -> Floats:
        """Return the transpose of `kinetic` applied to `image`, shape (coordinates, columns)."""
        loads = image.reshape(self.tree.pieces, 6, -1)
        if self.rigid.size:
            rigid = self.rigid_images()
            loads = loads - np.tensordot(rigid, np.tensordot(rigid, loads, ((0, 1), (0, 1))), (2, 0))
        carried = self.tree.to_root(np.swapaxes(self.tree.mass_root, 1, 2) @ loads)
        return self._from_twists(carried)

    def _from_twists(self, carried: Floats) -> Floats:
        """Return what loads, summed to the root, do to the coordinates."""
        pulls: Floats = self.root_twist.T @ carried[0]
        at_joints = np.swapaxes(self.tree.joint_twists[1:], 1, 2) @ carried[1:]
        turns = 3 * (self.tree.pieces - 1)
        pulls[len(pulls) - turns :] += at_joints.reshape(turns, pulls.shape[1])
        pulls *= self.flexibility_root[:, None]
        return pulls

    def rigid_images(self) -> Floats:
        """Return the rigid-body modes as `kinetic` would, shape (pieces, 6, modes)."""
        return self.tree.mass_root @ self.rigid


def tree_form(tree: RigidTree) -> TreeForm:
    """Return the form of a tree whose numbers are of order 1."""
    stiffness = np.concatenate([support.stiffness for support in tree.supports])
    on_root = np.vstack([support.reading for support in tree.supports])
    on_joints = _on_joints(tree)
    chosen, others = _chosen(stiffness, on_root)
    to_root: Floats = np.asarray(np.linalg.inv(on_root[chosen]), dtype=np.float64)
    kind = stiffness[chosen]
    sprung, loose = (kind > 0) & np.isfinite(kind), kind == 0
    turns_root = np.sqrt(tree.joint_flexibility[1:].ravel())
    flexibility_root: Floats = np.concatenate([1.0 / np.sqrt(kind[sprung]), turns_root])
    root_twist = np.hstack([to_root[:, sprung], -to_root @ on_joints[chosen]])
    rows = on_root[others] @ root_twist
    size = np.abs(on_root[others]) @ np.abs(root_twist)
    rows[:, int(sprung.sum()) :] += on_joints[others]
    size[:, int(sprung.sum()) :] += np.abs(on_joints[others])
    # What has cancelled is rounding: every motion meets it anyway.
    rows[np.abs(rows) < 1e-13 * size.max(axis=1, initial=0.0, keepdims=True)] = 0.0
    rows = rows * flexibility_root
    forbidden = _spanned(
        rows[np.isinf(stiffness[others])], size.max(initial=0.0) * flexibility_root.max(initial=0.0)
    )
    form = TreeForm(
        tree,
        flexibility_root,
        root_twist,
        forbidden,
        *_stiffening(rows, stiffness[others], forbidden),
        to_root[:, loose],
    )
    if loose.any():
        images = form.rigid_images().reshape(6 * tree.pieces, -1)
        form = replace(form, rigid=form.rigid @ np.linalg.inv(np.linalg.qr(images)[1]))
    return form


def _on_joints(tree: RigidTree) -> Floats:
    """Return what unit turns of the joints do to the supports' readings, shape (6 supports, 3 joints)."""
    rows = []
    for support in tree.supports:
        loads = np.zeros((tree.pieces, 6, 6))
        loads[support.piece] = support.reading.T
        carried = tree.to_root(loads)[1:]
        rows.append((np.swapaxes(tree.joint_twists[1:], 1, 2) @ carried).reshape(3 * (tree.pieces - 1), 6).T)
    return np.vstack(rows)


def _chosen(stiffness: Floats, on_root: Floats) -> tuple[list[int], list[int]]:
    """Return the six stiffest readings that tell the root's twist, earlier ones first, and all others."""
    chosen: list[int] = []
    basis = np.zeros((0, 6))
    for k in sorted(range(len(stiffness)), key=lambda k: -stiffness[k]):
        rest = on_root[k] - basis.T @ (basis @ on_root[k])
        rest -= basis.T @ (basis @ rest)
        length = np.sqrt(rest @ rest)
        if len(chosen) < 6 and length > _INDEPENDENT * max(1.0, np.abs(on_root[k]).max()):
            chosen.append(k)
            basis = np.vstack([basis, rest / length])
    chosen.sort()
    return chosen, [k for k in range(len(stiffness)) if k not in chosen]


def _spanned(rows: Floats, scale: float) -> Floats:
    """Return orthonormal columns that span rows, those within rounding of `scale` left out."""
    if not rows.size:
        return np.zeros((rows.shape[1], 0))
    _, size, across = np.linalg.svd(rows, full_matrices=False)
    return across[size > 1e-12 * scale].T.copy()


def _stiffening(rows: Floats, stiffness: Floats, forbidden: Floats) -> tuple[Floats, Floats]:
    """Return the orthonormal directions that springs of left-over readings stiffen, and how much."""
    finite = np.isfinite(stiffness) & (stiffness > 0)
    pulls = (np.sqrt(stiffness[finite])[:, None] * rows[finite]).T
    pulls -= forbidden @ (forbidden.T @ pulls)
    direction, size, _ = np.linalg.svd(pulls, full_matrices=False)
    softening = np.asarray(1 / np.hypot(1, size[size > 0]) - 1, dtype=np.float64)
    return direction[:, size > 0], softening
