"""Natural modes of a chain in space, with every digit of the lowest frequencies kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from beammodes.chains.rigid_tree import RigidTree, Support
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import Shown, instead, row_shown, shown, whole_number
from beammodes.numerics.arrays import Floats, signs_of_largest
from beammodes.vibration.tree_form import TreeForm, tree_form

__all__ = ["SpatialModes", "scaled_tree", "spatial_modes"]

#: Trees of so many coordinates are solved by a dense singular value decomposition, and longer ones of which
#: all modes are wanted; else by block iteration, which gives the lowest.
_DENSE, _MOST_DENSE = 150, 3000

#: That can be asked for, of whatever chain.
_MOST_MODES = 100_000

#: Blocks of one cycle of the iteration, spare vectors, and cycles at most.
_BLOCKS, _SPARE, _CYCLES = 4, 6, 60


@dataclass(frozen=True, eq=False, repr=False)
class SpatialModes(Shown):
    """Elastic modes of a chain in space, ascending, normalized to unit modal mass.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
    rigid_body_modes : int
        Number of motions that store nothing; they are no rows of the arrays.
    position : ndarray, shape (nodes, 3) [m]
        Of the nodes at rest, in the axes of the section at s = 0.
    displacement : ndarray, shape (modes, nodes, 3) [kg^-½]
        Of the nodes, in the same axes; the largest entry of each mode is positive.
    rotation : ndarray, shape (modes, pieces, 3) [kg^-½/m]
        Of the pieces, as rotation vectors in the same axes.
    stored : ndarray, shape (modes, 3)
        Parts of a mode's energy that its joints store in turning about the section's x (twist), y and z; what
        is missing to 1 is in springs of the ends.
    """

    angular_frequency: Floats
    rigid_body_modes: int
    position: Floats
    displacement: Floats
    rotation: Floats
    stored: Floats

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, shape (modes,) [Hz]."""
        return self.angular_frequency / (2 * math.pi)

    def _line(self) -> str:
        rigid = f"; {self.rigid_body_modes} rigid-body modes" if self.rigid_body_modes else ""
        return f"SpatialModes(chain: {row_shown(self.frequency, '{:.4g}', 'Hz')}{rigid})"


def spatial_modes(chain: SpatialChain, modes: int = 6) -> SpatialModes:
    """Return the lowest elastic modes of a chain in space.

    Parameters
    ----------
    chain : SpatialChain
    modes : int
        How many, from the first; a chain with fewer gives those it has.

    Returns
    -------
    SpatialModes
        Frequencies in increasing order, shapes of unit modal mass.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or a chain of more than 3,000 joint coordinates is asked for more
        than a tenth of its modes.

    Examples
    --------
    >>> import beammodes as bm
    >>> wire = {"bending_stiffness": 1.0, "torsional_stiffness": 1 / 1.3, "mass_per_length": 1.0}
    >>> bend = bm.Rod.arc(math.pi / 2, length=math.pi / 2, **wire)
    >>> bm.spatial_modes(bm.SpatialChain(bend, "clamped-free", 20, "gregory"), 2).angular_frequency.round(4)
    array([1.4518, 1.4982])
    """
    if not isinstance(chain, SpatialChain):
        hint = instead(chain, Chain="solve_modes(linearize(chain)) is of a Chain")
        raise TypeError(f"chain must be a SpatialChain, got {shown(chain)}{hint}")
    count = whole_number("modes", modes, most=_MOST_MODES)
    length, stiffness, mass = chain.rod.units
    form = tree_form(scaled_tree(chain.tree, length, stiffness, mass))
    inverse, x = _lowest(form, count)
    twists = form.twists(x) / inverse
    joints, points = form.tree.pieces - 1, form.tree.joint_place
    last = form.tree.supports[-1].place[None]
    places = np.concatenate([points, last])
    moving = np.concatenate([np.arange(len(points)), [form.tree.pieces - 1]])
    moved = twists[moving, :3] + np.cross(twists[moving, 3:], places[:, :, None], axis=1)
    _, first = np.unique(np.concatenate([[0.0], chain.hinge_position, [chain.rod.length]]), return_index=True)
    moved = moved[first]
    sign = signs_of_largest(moved.reshape(3 * len(moved), -1).T) / math.sqrt(mass)
    return SpatialModes(
        angular_frequency=math.sqrt(stiffness / mass) / length / inverse,
        rigid_body_modes=form.rigid.shape[1],
        position=length * places[first],
        displacement=np.moveaxis(moved * sign, 2, 0),
        rotation=np.moveaxis(twists[:, 3:] * sign / length, 2, 0),
        stored=(x[len(x) - 3 * joints :].reshape(joints, 3, x.shape[1]) ** 2).sum(axis=0).T,
    )


def scaled_tree(tree: RigidTree, length: float, stiffness: float, mass: float) -> RigidTree:
    """Return a tree in units of a length, a joint stiffness and a mass."""
    unit = np.array([stiffness / length**2] * 3 + [stiffness] * 3)
    return replace(
        tree,
        joint_place=tree.joint_place / length,
        joint_flexibility=tree.joint_flexibility * stiffness,
        mass=tree.mass / mass,
        centre=tree.centre / length,
        inertia=tree.inertia / (mass * length**2),
        supports=tuple(
            Support(one.piece, one.place / length, one.frame, one.stiffness / unit) for one in tree.supports
        ),
    )


def _lowest(form: TreeForm, count: int) -> tuple[Floats, Floats]:
    """Return 1/ω and x of unit stored energy of the lowest modes."""
    coordinates = len(form.flexibility_root)
    count = min(count, form.elastic_modes)
    if count == 0:
        return np.zeros(0), np.zeros((coordinates, 0))
    if coordinates <= _DENSE or (10 * count > coordinates and coordinates <= _MOST_DENSE):
        complete = np.linalg.qr(form.forbidden, mode="complete")[0]
        x = form.allowed(complete[:, form.forbidden.shape[1] :])
    else:
        if 10 * count > coordinates:
            raise ValueError(
                f"modes must be at most {coordinates // 10}, a tenth of the chain's, for a chain of more "
                f"than {_MOST_DENSE} coordinates, got {count}"
            )
        x = _iterated(form, count)
    # Singular values of the factor itself: one loses only ω_n/ω_1, its square (ω_n/ω_1)².
    _, inverse, turn = np.linalg.svd(np.linalg.qr(form.kinetic(x), mode="r"))
    # Motions without inertia, as of twist without a polar one, are no modes.
    count = min(count, int((inverse > 1e-13 * inverse[0]).sum()))
    return inverse[:count], x @ turn[:count].T


def _iterated(form: TreeForm, count: int) -> Floats:
    """Return x that span the lowest modes, by block iteration on the flexibility.

    A block finds modes of equal frequency, of which round rods have many; single vectors would miss some.
    """
    size = count + _SPARE
    block = np.random.default_rng(0).standard_normal((len(form.flexibility_root), size))
    block *= form.flexibility_root[:, None] > 0.0
    known = np.zeros(size)
    for _ in range(_CYCLES):
        basis: list[Floats] = []
        images: list[Floats] = []
        for _ in range(_BLOCKS):
            block = _orthonormal(block - form.forbidden @ (form.forbidden.T @ block), basis)
            basis.append(block)
            block = form.allowed(form.adjoint(form.kinetic(form.allowed(block))))
            images.append(block)
        projected = np.block([[one.T @ image for image in images] for one in basis])
        square, turn = np.linalg.eigh(0.5 * (projected + projected.T))
        best = turn[:, ::-1][:, :size]
        rows = np.split(best, np.cumsum([one.shape[1] for one in basis])[:-1])
        block = sum((one @ part for one, part in zip(basis, rows, strict=True)), np.zeros(()))
        square = square[::-1][:size]
        # A cycle gains six digits or more, so what is left is far below the change; rounding is not.
        if np.abs(square[:count] - known[:count]).max() <= 1e-12 * square[0]:
            break
        known = square
    return form.allowed(block)


def _orthonormal(block: Floats, basis: list[Floats]) -> Floats:
    """Return orthonormal columns that span a block beyond a basis, fewer where that has little."""
    for _ in range(2):
        for other in basis:
            block = block - other @ (other.T @ block)
        block = block / np.sqrt((block**2).sum(axis=0))
        # By the Gram matrix: a factorization of long columns costs ten times as much.
        square, turn = np.linalg.eigh(block.T @ block)
        kept = square > 1e-10
        block = block @ (turn[:, kept] / np.sqrt(square[kept]))
    return block
