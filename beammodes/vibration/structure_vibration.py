"""Small vibration of a chain of a planar structure, in coordinates that make the stiffness diagonal.

Coordinates are the relative rotations φ of all hinges and the lengthenings of the supports' springs, each
divided by the root of its flexibility, so that the stored energy is half the sum of their squares. Angles of
bodies are sums of φ along a tree of hinges from the ground outward; displacements of nodes, and angles of
parts that no hinge ties to the ground, follow by constraints:

    every stretch      d_end - d_start = normal Σ ℓ_p θ_p          (and so keeps its length)
    a loop of hinges   the φ around it add up to zero
    a support          d · u = 0, or the lengthening of its spring

Of a tree that is supported at its root all that is left is φ itself. Speeds of all bodies times the roots of
their masses are G y' for the coordinates y that obey the constraints; singular values of G are 1/ω. No matrix
has lost the digits of the lowest modes, as an assembled stiffness matrix of a long chain has.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, row_shown, shown, whole_number
from beammodes.numerics.arrays import Floats, first_factor, signs_of_largest
from beammodes.numerics.piecewise import Piecewise
from beammodes.problem.beam import positions_on

__all__ = [
    "StructureChainModes",
    "StructureCoordinates",
    "lowest_frequencies",
    "stressed_chain_modes",
    "structure_chain_modes",
]

#: Constraints weaker than this say nothing that others do not say.
_SAME = 1e-9
#: Singular values below this part of the largest belong to motions without inertia.
_MASSLESS = 1e-11
_MOST_PIECES = 3000
#: Chains of fewer coordinates are quickly solved as a whole.
_SHORT = 60


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StructureChainModes(Shown):
    """The first elastic modes of a chain of a structure; `structure_chain_modes` makes it.

    Attributes
    ----------
    chain : StructureChain
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of elastic modes 1, 2, ..., ascending; read-only.
    rigid_body_modes : int
    elastic_modes : int
        How many the chain has.
    displacement : dict of str to ndarray, shape (modes, 2) [m]
        Of each joint along x and y. Modes have unit modal mass, and the sign that makes the largest
        displacement of a node positive.
    hinges : tuple of ndarray
        Positions of the ends of all pieces of each stretch on its member, shape (pieces + 1,) [m].
    deflections : tuple of ndarray
        There, across the member, shape (modes, pieces + 1) [m].
    rotation : ndarray, shape (modes, bodies) [rad]
        Of each rigid body of the chain, the first of which is the ground.
    """

    chain: StructureChain
    angular_frequency: Floats
    rigid_body_modes: int
    elastic_modes: int
    displacement: dict[str, Floats]
    hinges: tuple[Floats, ...]
    deflections: tuple[Floats, ...]
    rotation: Floats

    @property
    def frequency(self) -> Floats:
        """ω/(2π) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def shape(self, x: ArrayLike, member: str | None = None) -> Floats:
        """Return deflections across a member, to the left of one who goes along it, shape (modes, x.shape).

        Parameters
        ----------
        x : float or array [m]
            Distances from the member's start.
        member : str, optional
            Its name, where there are several.
        """
        beam = self.chain.structure.member(member)
        places = positions_on(beam.beam, x)
        own = [i for i, stretch in enumerate(self.chain.parts.stretches) if stretch.member == beam.name]
        nodes = np.concatenate([self.hinges[i] for i in own])
        rows = np.concatenate([self.deflections[i] for i in own], axis=1)
        found = np.array([np.interp(places.ravel(), nodes, row) for row in rows])
        return found.reshape(len(found), *places.shape)

    def _line(self) -> str:
        return f"StructureChainModes({row_shown(self.frequency, '{:.4g}', 'Hz')} of {self.chain!r})"


def structure_chain_modes(chain: StructureChain, modes: int | None = None) -> StructureChainModes:
    """Return the first elastic modes of a chain of a structure, or all that it has.

    Parameters
    ----------
    chain : StructureChain
    modes : int, optional
        From the first; all of them by default. A chain with fewer gives those it has.

    Returns
    -------
    StructureChainModes
        Frequencies in increasing order, with the shapes' deflections and rotations.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the chain has more than 3,000 pieces.

    Examples
    --------
    >>> import beammodes as bm
    >>> joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 1), "tip": bm.Joint(1, 1)}
    >>> bar = bm.Beam.unit()
    >>> ell = bm.Structure(joints, [bm.Member(bar, "foot", "corner"), bm.Member(bar, "corner", "tip")])
    >>> found = bm.structure_chain_modes(bm.StructureChain(ell, segments=20), modes=2)
    >>> (found.angular_frequency / bm.structure_modes(ell, 2).angular_frequency - 1).round(7)
    array([3.60e-06, 3.56e-05])
    """
    if not isinstance(chain, StructureChain):
        raise TypeError(f"chain must be a StructureChain, got {shown(chain)}")
    return _modes_of(StructureCoordinates.of(chain), modes)


def stressed_chain_modes(
    chain: StructureChain, axial_force: Sequence[Piecewise], turning: Sequence[float], modes: int | None
) -> StructureChainModes:
    """Return the first modes of a chain under axial forces.

    Parameters
    ----------
    chain, modes
        As of `structure_chain_modes`.
    axial_force : sequence of Piecewise
        Of each stretch, over the distance from its start, tension positive [N].
    turning : sequence of float
        Of each node, by what moment per angle the load on its body resists a rotation [N m].

    Examples
    --------
    >>> import beammodes as bm
    >>> bar = bm.Structure.of_beam(bm.Beam.unit(), "pinned-pinned")
    >>> pull = Piecewise.one(0.0, 1.0, 5.0)
    >>> squares = stressed_chain_modes(bm.StructureChain(bar, 40), [pull], [0, 0], 1).angular_frequency ** 2
    >>> (squares / (5 * math.pi**2 + math.pi**4) - 1).round(6)
    array([0.000173])
    """
    coordinates = StructureCoordinates.of(chain)
    stored = np.eye(coordinates.give.shape[1]) + coordinates.geometric(axial_force, turning)
    try:
        root = np.linalg.cholesky(stored)
    except np.linalg.LinAlgError:
        factor = first_factor(coordinates.geometric(axial_force, turning))
        raise ValueError(
            f"load must be less than {factor:.6g} times the given one, under which the chain buckles"
        ) from None
    change = np.linalg.inv(root).T
    return _modes_of(
        coordinates._replace(give=coordinates.give @ change, follow=coordinates.follow @ change), modes
    )


def _modes_of(coordinates: StructureCoordinates, modes: int | None) -> StructureChainModes:
    chain, moved = coordinates.chain, coordinates.momentum()
    _, size, shape = np.linalg.svd(moved, full_matrices=False)
    has = int(np.sum(size > _MASSLESS * size.max(initial=0.0)))
    count = has if modes is None else min(has, whole_number("modes", modes))
    omega = 1.0 / size[:count]
    omega.flags.writeable = False
    motions = shape[:count].T * omega
    places, turns = coordinates.seen(motions)
    sign = signs_of_largest(places.reshape(count, 2 * len(chain.parts.nodes)))
    places, turns = places * sign[:, None, None], turns * sign
    displacement = {name: places[:, i] for i, name in enumerate(chain.structure.joints)}
    return StructureChainModes(
        chain,
        omega,
        coordinates.rigid.shape[1],
        has,
        displacement,
        tuple(
            stretch.start + np.append(0.0, np.cumsum(pieces.length))
            for stretch, pieces in zip(chain.parts.stretches, chain.chains, strict=True)
        ),
        tuple(
            np.cumsum(
                np.hstack(
                    [
                        places[:, stretch.nodes[0]] @ np.array(stretch.normal)[:, None],
                        pieces.length * turns[list(bodies)].T,
                    ]
                ),
                axis=1,
            )
            for stretch, pieces, bodies in zip(chain.parts.stretches, chain.chains, chain.bodies, strict=True)
        ),
        turns.T,
    )


def lowest_frequencies(chain: StructureChain, modes: int) -> Floats:
    """Return ω of the first elastic modes, or of as many as there are; of a long chain soon.

    Of a long chain from GᵀG, so that ω_n has (ω_n/ω_1)² times the rounding of `structure_chain_modes`.

    Examples
    --------
    >>> import beammodes as bm
    >>> bar = bm.Structure.of_beam(bm.Beam.unit(), "clamped-free")
    >>> lowest_frequencies(bm.StructureChain(bar, 100), 2).round(6)
    array([ 3.516015, 22.034492])
    """
    from scipy.linalg import eigh

    moved = StructureCoordinates.of(chain).momentum()
    count = moved.shape[1]
    if count < max(_SHORT, 10 * modes):
        return structure_chain_modes(chain).angular_frequency[:modes]
    found = eigh(moved.T @ moved, eigvals_only=True, subset_by_index=(count - modes, count - 1))
    return np.asarray(1.0 / np.sqrt(found[::-1]))


class StructureCoordinates(NamedTuple):
    """Coordinates y of a chain that obey all constraints, with the energy yᵀy/2.

    With all φ and lengthenings s = give · y, angles and displacements of what follows r = follow · y.

    Attributes
    ----------
    chain : StructureChain
    give : ndarray, shape (hinges + springs, y)
    follow : ndarray, shape (r, y)
        Displacements of nodes over the longest stretch, x and y of each, then angles of free parts.
    rigid : ndarray, shape (r, rigid motions)
        What r may do besides, without energy.
    angles : ndarray, shape (bodies, hinges)
        Angle of each body for unit φ.
    free_angles : ndarray, shape (bodies, free parts)
        Which free part it belongs to.
    unit : float [m]
        The longest stretch.
    """

    chain: StructureChain
    give: Floats
    follow: Floats
    rigid: Floats
    angles: Floats
    free_angles: Floats
    unit: float

    @classmethod
    def of(cls, chain: StructureChain) -> StructureCoordinates:
        """Return the coordinates of a chain."""
        if sum(chain.segments) > _MOST_PIECES:
            raise ValueError(f"chain must have at most {_MOST_PIECES} segments, got {sum(chain.segments)}")
        unit = max(stretch.beam.length for stretch in chain.parts.stretches)
        angles, free, loops = _tree(chain)
        rows, flexibility = _constraints(chain, angles, free, loops, unit)
        given, following = rows[:, : len(flexibility)], rows[:, len(flexibility) :]
        # What follows is r = known φ + rigid ρ; what it cannot fulfil is left for φ.
        left, size, right = np.linalg.svd(following)
        rank = int(np.sum(size > _SAME * size.max(initial=0.0)))
        known = -(right[:rank].T / size[:rank]) @ (left[:, :rank].T @ given)
        rest = left[:, rank:].T @ given
        _, size, strict = np.linalg.svd(rest, full_matrices=False)
        strict = strict[: int(np.sum(size > _SAME * np.abs(given).max(initial=0.0)))]
        root = np.sqrt(flexibility)
        closed = (strict * root).T
        basis = np.linalg.qr(closed, mode="complete")[0][:, closed.shape[1] :]
        give = root[:, None] * basis
        return cls(chain, give, known @ give, right[rank:].T, angles, free, unit)

    def turns(self, given: Floats, following: Floats) -> Floats:
        """Return the angles of all bodies, from φ and r."""
        nodes = 2 * len(self.chain.parts.nodes)
        turned: Floats = self.angles @ given[: self.angles.shape[1]] + self.free_angles @ following[nodes:]
        return turned

    def seen(self, y: Floats) -> tuple[Floats, Floats]:
        """Return displacements of nodes, shape (columns of y, nodes, 2) [m], and angles of bodies [rad].

        Less what of rigid motions they have, so that they are orthogonal to these.
        """
        count, following = len(self.chain.parts.nodes), self.follow @ y
        given = self.give @ y
        if self.rigid.shape[1]:
            none = np.zeros((len(self.give), self.rigid.shape[1]))
            share = np.linalg.lstsq(
                self._speeds(none, self.rigid), self._speeds(given, following), rcond=None
            )
            following = following - self.rigid @ share[0]
        places = (self.unit * following[: 2 * count]).T.reshape(-1, count, 2)
        return places, self.turns(given, following)

    def geometric(self, axial_force: Sequence[Piecewise], turning: Sequence[float]) -> Floats:
        """Return G of the energy yᵀGy/2 of axial forces and weights of bodies, Σ θ² ∫ N dx of pieces."""
        if self.rigid.shape[1] and any(turning):
            raise ValueError(
                "chain must hold the rotation of each body that has an offset under gravity, got one with a "
                "body that turns freely on a pin"
            )
        turns, chain = self.turns(self.give, self.follow), self.chain
        geometric = np.zeros((turns.shape[1], turns.shape[1]))
        for pieces, bodies, force in zip(chain.chains, chain.bodies, axial_force, strict=True):
            pull, ends = force.integrated(), np.append(0.0, np.cumsum(pieces.length))
            ends[-1] = force.edges[-1]
            along = np.diff([pull(x) for x in ends.tolist()])
            rows = turns[list(bodies)] * (pieces.length > 0.0)[:, None]
            geometric += (rows.T * along) @ rows
        for body, moment in zip(chain.joints, turning, strict=True):
            if moment and body is not None:
                geometric += moment * np.outer(turns[body], turns[body])
        return geometric

    def momentum(self) -> Floats:
        """Return G: speeds of masses times the roots of these for unit y', rigid motions taken out."""
        moved = self._speeds(self.give, self.follow)
        if self.rigid.shape[1]:
            none = np.zeros((len(self.give), self.rigid.shape[1]))
            basis = np.linalg.qr(self._speeds(none, self.rigid))[0]
            # Twice, because once leaves a rounding of what is taken away.
            for _ in range(2):
                moved = moved - basis @ (basis.T @ moved)
        return moved

    def _speeds(self, given: Floats, following: Floats) -> Floats:
        turns, rows, parts = self.turns(given, following), list[Floats](), self.chain.parts
        places = self.unit * following[: 2 * len(parts.nodes)].reshape(len(parts.nodes), 2, -1)
        for stretch, chain, bodies in zip(parts.stretches, self.chain.chains, self.chain.bodies, strict=True):
            start = places[stretch.nodes[0]]
            angle = turns[list(bodies)] * (chain.length > 0.0)[:, None]
            mass, length = chain.mass[:, None], chain.length[:, None]
            before = np.cumsum(length * angle, axis=0) - length * angle
            across = np.array(stretch.normal) @ start + before + chain.centre[:, None] * angle
            rows.append(np.sqrt(mass) * across)
            rows.append(np.sqrt(chain.rotary_inertia)[:, None] * angle)
            rows.append(math.sqrt(chain.mass.sum()) * np.array(stretch.axis)[None] @ start)
        for node, place, body in zip(parts.nodes, places, self.chain.joints, strict=True):
            turn = np.zeros(given.shape[1]) if body is None else turns[body]
            across, up = node.offset
            rows.append(math.sqrt(node.mass) * (place + np.outer((-up, across), turn)))
            rows.append(math.sqrt(node.rotary_inertia) * turn[None])
        return np.vstack(rows)


def _tree(chain: StructureChain) -> tuple[Floats, Floats, list[int]]:
    """Return angles of bodies for unit φ, the free parts they belong to, and hinges that close loops."""
    about: list[list[tuple[int, int, float]]] = [[] for _ in range(chain.body_count)]
    for e, hinge in enumerate(chain.hinges):
        a, b = hinge.bodies
        about[a].append((b, e, 1.0))
        about[b].append((a, e, -1.0))
    angles = np.zeros((chain.body_count, len(chain.hinges)))
    part, used = np.full(chain.body_count, -1), set[int]()
    parts = 0
    for root in range(chain.body_count):
        if part[root] >= 0:
            continue
        part[root], pending = parts, [root]
        parts += 1
        while pending:
            body = pending.pop()
            for other, e, sign in about[body]:
                if part[other] < 0:
                    part[other] = part[body]
                    angles[other] = angles[body]
                    angles[other, e] += sign
                    used.add(e)
                    pending.append(other)
    # The ground's own part, the first, does not turn.
    free = (part[:, None] == np.arange(1, parts)).astype(float)
    return angles, free, [e for e in range(len(chain.hinges)) if e not in used]


def _constraints(
    chain: StructureChain, angles: Floats, free: Floats, loops: list[int], unit: float
) -> tuple[Floats, Floats]:
    """Return rows over (φ, lengthenings / unit, displacements / unit, free angles), and the flexibilities."""
    parts = chain.parts
    springs = [
        (i, direction, stiffness)
        for i, node in enumerate(parts.nodes)
        for direction, stiffness in node.supports
        if stiffness < math.inf
    ]
    hinges, first = len(chain.hinges), len(chain.hinges) + len(springs)
    turned = first + 2 * len(parts.nodes)
    rows = []

    def new() -> Floats:
        rows.append(np.zeros(turned + free.shape[1]))
        return rows[-1]

    def displace(row: Floats, node: int, direction: tuple[float, float], factor: float) -> None:
        row[first + 2 * node : first + 2 * node + 2] += factor * np.array(direction)

    for stretch, pieces, bodies in zip(parts.stretches, chain.chains, chain.bodies, strict=True):
        start, end = stretch.nodes
        for direction in (stretch.axis, stretch.normal):
            row = new()
            displace(row, end, direction, 1.0)
            displace(row, start, direction, -1.0)
        arms = pieces.length / unit
        row[:hinges] -= arms @ (angles[list(bodies)] * (arms > 0.0)[:, None])
        row[turned:] -= arms @ (free[list(bodies)] * (arms > 0.0)[:, None])
    for i, node in enumerate(parts.nodes):
        for direction, stiffness in node.supports:
            if stiffness == math.inf:
                displace(new(), i, direction, 1.0)
    for k, (i, direction, _) in enumerate(springs):
        row = new()
        displace(row, i, direction, 1.0)
        row[hinges + k] = -1.0
    for e in loops:
        row = new()
        a, b = chain.hinges[e].bodies
        row[:hinges] = angles[a] - angles[b]
        row[e] += 1.0
    flexibility = [hinge.flexibility for hinge in chain.hinges]
    flexibility += [1.0 / (stiffness * unit**2) for _, _, stiffness in springs]
    return np.array(rows), np.array(flexibility)
