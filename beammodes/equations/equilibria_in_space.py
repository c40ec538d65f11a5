"""Shapes at rest of chains in space under dead loads, with large rotations, and their loss of stability.

Coordinates q are three for each joint (`joint_laws`), and three for the root where its supports let it turn.
They are at rest where what the springs pull equals what loads and held ends do:

    k_i q_i = w_i · M_i,        M_i = Σ (x_p - x_i) × F_p + moments,  over all that lies beyond joint i,

w_i the axis of coordinate i in space. The tangent is exact, entry by entry: for a joint i before j it is
-w_i · (D_j w_j - w_j tr D_j), with D_j = Σ (x_p - x_j) F_pᵀ. What a held end pushes with is found with q, as
forces on the rod's end, couples on its tangent, and a moment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import Shown, instead, positive_real, real_numbers, shown
from beammodes.equations.far_end import FarEnd, Resisted
from beammodes.equations.joint_laws import JointLaw, joint_law
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import accumulated
from beammodes.problem.load_in_space import SpatialLoad

__all__ = ["NoEquilibriumInSpace", "SpatialEquilibrium", "critical_factor", "spatial_equilibrium"]

#: Joints of a chain whose shape is solved for: the tangent is a full matrix.
_MOST_JOINTS = 600

_STEPS, _NEWTON, _SMALLEST = 1000, 30, 1e-6

#: How far a piece turns from one load to the next at most [rad], unless they are so little apart.
_TURN, _APART = 1.0, 3e-5

#: Multiples of a load that are tried on the way to one that buckles.
_MOST_TRIED = 1600
#: How far from a rotation `end_frame`, and beyond the length `end_place`, may be by rounding.
_SAME_AXES = 1e-8


class NoEquilibriumInSpace(ArithmeticError):
    """No shape at rest was found on the way from the shape at rest without load to the whole load."""


@dataclass(frozen=True, eq=False, repr=False)
class SpatialEquilibrium(Shown):
    """A shape at rest of a chain in space; `spatial_equilibrium` finds it.

    Attributes
    ----------
    chain : SpatialChain
    load : SpatialLoad
    law : JointLaw
    coordinates : ndarray, shape (pieces, 3) [rad]
        Of the root, then of each joint, as the law reads them.
    rotation : ndarray, shape (pieces, 3, 3)
        Of each piece from rest, in the axes of the section at s = 0 at rest.
    nodes : ndarray, shape (pieces + 1, 3) [m]
        Where each piece starts, and where the last ends, in these axes.
    reaction : ndarray
        What holds the end at s = L pushes with: a force for each held deflection [N], then for its rotation.
    tangent : ndarray, shape (free, free) [N m]
        The stiffness of motions that supports allow.
    """

    chain: SpatialChain
    load: SpatialLoad
    law: JointLaw
    coordinates: Floats
    rotation: Floats
    nodes: Floats
    reaction: Floats
    tangent: Floats

    @property
    def tip(self) -> Floats:
        """Where the rod's end at s = L is [m]."""
        tip: Floats = self.nodes[-1]
        return tip

    @property
    def stiffnesses(self) -> Floats:
        """Real parts of the tangent's eigenvalues over EI/L, ascending: negative ones are ways to fall."""
        unit = self.chain.rod.units[1]
        values: Floats = np.sort(np.linalg.eigvals(self.tangent).real) / unit
        return values

    @property
    def is_stable(self) -> bool:
        """True if every motion that supports allow is resisted."""
        return bool((self.stiffnesses > 0.0).all())

    def _line(self) -> str:
        place = ", ".join(f"{value:.6g}" for value in self.tip)
        return f"SpatialEquilibrium(tip at ({place}) m, joints {self.law.name!r})"


def spatial_equilibrium(
    chain: SpatialChain,
    load: SpatialLoad | None = None,
    *,
    joints: str | JointLaw = "ball",
    guess: Any = None,
    end_place: Any = None,
    end_frame: Any = None,
) -> SpatialEquilibrium:
    """Return the shape at rest of a chain in space under dead loads, with large rotations.

    Parameters
    ----------
    chain : SpatialChain
        Its end at s = 0 must hold the deflections, and may let rotations go or resist them by springs; the
        other may be any. Springs there pull back to where the rod rests; those of rotations store what the
        vector of its rotation tells, up to half a turn (about a tangent that is held, any number of turns).
    load : SpatialLoad, optional
    joints : str or JointLaw
        "ball", whose springs store the energy of the rotation's vector, as the rod does; or the order of the
        hinges from the parent on, such as "yzx", or "yzx_alternating". See `joint_laws`.
    guess : SpatialEquilibrium or array, shape (pieces, 3), optional
        Coordinates to start from, at the whole load; by default the load grows from nothing.
    end_place : three floats, optional [m]
        Where an end at s = L is held, or pulled by springs; where it is at rest by default.
    end_frame : ndarray, shape (3, 3), optional
        The axes in which its rotation is held or resisted, likewise.

    Returns
    -------
    SpatialEquilibrium
        Nodes, rotations and reactions, and the stiffness of each motion about the shape.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the end at s = 0 moves.
    NoEquilibriumInSpace
        If Newton's steps do not settle.

    Examples
    --------
    A bend of 45 degrees, 100 long, under a force across its plane (Bathe and Bolourchi 1979).

    >>> import beammodes as bm
    >>> bend = bm.Rod.arc(math.pi / 4, length=25 * math.pi, bending_stiffness=1e7 / 12,
    ...                   torsional_stiffness=1e7 / 12, mass_per_length=1.0)
    >>> chain = bm.SpatialChain(bend, "clamped-free", segments=20, rule="double_wall")
    >>> bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(0, 0, 600))).tip.round(2)
    array([47.13, 15.68, 53.52])
    """
    if not isinstance(chain, SpatialChain):
        hint = instead(chain, Chain="find_equilibrium takes a Chain")
        raise TypeError(f"chain must be a SpatialChain, got {shown(chain)}{hint}")
    if load is not None and not isinstance(load, SpatialLoad):
        hint = instead(load, Load="SpatialLoad has forces and gravity along x, y and z")
        raise TypeError(f"load must be a SpatialLoad or None, got {shown(load)}{hint}")
    statics = _Statics(chain, joint_law(joints), end_place, end_frame)
    whole = load or SpatialLoad()
    if guess is None:
        return statics.answer(statics.followed(whole), whole)
    start = guess.coordinates if isinstance(guess, SpatialEquilibrium) else real_numbers("guess", guess)
    if start.shape != (statics.count, 3):
        raise ValueError(f"guess must have shape ({statics.count}, 3), got {start.shape}")
    found = statics.newton(start, np.zeros(statics.held), whole)
    if found is None:
        raise NoEquilibriumInSpace("no shape at rest was found from guess")
    return statics.answer(found, whole)


def critical_factor(
    chain: SpatialChain,
    load: SpatialLoad,
    *,
    joints: str | JointLaw = "ball",
    most: float = 100.0,
    start: float = 1.0,
) -> float:
    """Return the multiple of a load at which a chain's shape at rest first loses stability.

    The shape is followed as the load grows, and with it the stiffness of each motion: lateral buckling of a
    beam under its load, a shaft's under torque.

    Parameters
    ----------
    chain, load, joints
        As of `spatial_equilibrium`.
    most : float
        Multiple up to which it is looked for.
    start : float
        Multiple that is tried first; the load then grows by an eighth of it.

    Returns
    -------
    float
        The multiple, above zero [-].

    Raises
    ------
    TypeError, ValueError
        As `spatial_equilibrium`; or if nothing buckles up to `most`.

    Examples
    --------
    Greenhill's shaft between two bearings buckles under a torque 2π EI/L; of ten segments whose ball joints
    do not twist it is 20 tan(π/10) EI/L.

    >>> import beammodes as bm
    >>> shaft = bm.Rod(1.0, 1.0, 1e9, 1.0)
    >>> ends = (bm.RodEnd(math.inf, (math.inf, 0, 0)), bm.RodEnd((0, math.inf, math.inf)))
    >>> chain = bm.SpatialChain(shaft, ends, segments=10, rule="double_wall")
    >>> round(critical_factor(chain, bm.SpatialLoad(torque=1.0), start=6.0), 6)
    6.498394
    """
    from scipy.optimize import brentq

    if not isinstance(load, SpatialLoad):
        raise TypeError(f"load must be a SpatialLoad, got {shown(load)}")
    if not isinstance(chain, SpatialChain):
        raise TypeError(f"chain must be a SpatialChain, got {shown(chain)}")
    largest, step = positive_real("most", most), positive_real("start", start, "1") / 8.0
    if not 8.0 * step <= largest <= _MOST_TRIED * step:
        raise ValueError(
            f"most must be from start to {_MOST_TRIED // 8} times that, got {shown(most)} and {shown(start)}"
        )
    statics = _Statics(chain, joint_law(joints), None, None)
    stable = (np.zeros((statics.count, 3)), np.zeros(statics.held))

    def tried(factor: float) -> tuple[State, float]:
        now = load.times(factor)
        found = statics.newton(*stable, now) or statics.followed(now)
        return found, float(statics.answer(found, now).stiffnesses[0])

    low, factor = 0.0, step
    while (found := tried(factor))[1] > 0.0:
        stable, low, factor = found[0], factor, factor + step
        if low >= largest:
            raise ValueError(f"load must lose its stability below most = {largest}, got {shown(load)}")
    if low == 0.0:
        frame, place = chain.rod.frames([chain.rod.length])
        if chain.ends.rigid_body_modes(frame[0], place[0] / chain.rod.length):
            raise ValueError(f"chain must be held so that it cannot move rigidly, got ends {chain.ends}")
        raise ValueError(f"start must be less than eight times the load that buckles, got {shown(start)}")
    return float(brentq(lambda value: tried(value)[1], low, factor, xtol=1e-14 * factor, rtol=1e-13))


State = tuple[Floats, Floats]


class _Statics:
    """A chain's equations of rest."""

    def __init__(self, chain: SpatialChain, law: JointLaw, end_place: Any, end_frame: Any) -> None:
        tree, left, right = chain.tree, chain.ends.left, chain.ends.right
        self.chain, self.law, self.count = chain, law, tree.pieces
        if tree.pieces > _MOST_JOINTS:
            raise ValueError(f"chain must have at most {_MOST_JOINTS} pieces, got {tree.pieces}")
        if not all(map(math.isinf, left.translational_stiffness)):
            raise ValueError(f"chain must hold its end at s = 0 in place, got {left!r}")
        self._frames = np.concatenate([tree.supports[0].frame[None], tree.joint_frame[1:]])
        with np.errstate(divide="ignore"):
            springs = 1.0 / tree.joint_flexibility[1:]
        self.stiffness = np.vstack([left.rotational_stiffness, springs])
        self._active = np.isfinite(self.stiffness).ravel()
        self._places = np.vstack([tree.joint_place, tree.supports[-1].place])
        end = tree.supports[-1]
        place = end.place if end_place is None else real_numbers("end_place", end_place)
        axes = end.frame if end_frame is None else real_numbers("end_frame", end_frame)
        if place.shape != (3,) or axes.shape != (3, 3):
            raise ValueError("end_place must be three numbers and end_frame three rows of three")
        if abs(axes @ axes.T - np.eye(3)).max() > _SAME_AXES or np.linalg.det(axes) < 0.0:
            raise ValueError(
                "end_frame must be a rotation, its columns right-handed axes of length one, got "
                + shown(end_frame)
            )
        reach, apart = chain.rod.length, float(np.linalg.norm(place - tree.supports[0].place))
        if all(map(math.isinf, right.translational_stiffness)) and apart > reach * (1.0 + _SAME_AXES):
            raise ValueError(
                f"end_place must be within the rod's length {reach:g} of its start, got {shown(end_place)}, "
                f"{apart:g} from it: the chain does not stretch"
            )
        self._tangent = end.frame[:, 0]
        self._far = FarEnd(right, end.frame, place, axes)
        self.held = self._far.held
        self._unit = chain.rod.units

    def _shape(self, q: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return pieces' rotations, their starts and the end, axes of coordinates and rates, in space."""
        turned, axes, rates = self.law.turned(q)
        across = self._frames @ turned @ np.swapaxes(self._frames, 1, 2)
        apart = np.diff(self._places, axis=0)
        frames, starts = accumulated(across, (across @ apart[..., None])[..., 0])
        before = frames[:-1] @ self._frames
        axes = before @ axes
        rates = np.einsum("nij,nkjl->nkil", before, rates)
        return frames[1:], self._places[0] + starts, axes, rates

    def residual(self, q: Floats, push: Floats, load: SpatialLoad) -> tuple[Floats, Floats, Floats, Floats]:
        """Return, of free coordinates: what is unbalanced, what held ends miss, tangent and held rows."""
        frames, starts, axes, rates = self._shape(q)
        far = self._far.resisted(starts[-1], frames[-1], float(q[:, 0].sum()), push)
        dyad = self._dyads(frames, starts, far, load)
        dead = np.array(load.moment) + np.array([load.torque, 0.0, 0.0]) + far.moment
        moment = _moments(dyad) + dead
        moment[0, 0] -= load.torque
        springs = np.where(np.isfinite(self.stiffness), self.stiffness, 0.0)
        balance = springs * q - np.einsum("njk,nj->nk", axes, moment)
        turns = np.moveaxis(axes, 2, 1).reshape(-1, 3)
        lifts = np.cross(turns, starts[-1] - np.repeat(starts[:-1], 3, axis=0))
        tangent = np.diag(springs.ravel()) - _turning(axes, rates, dyad, moment, dead)
        tangent += lifts @ far.stiffening @ lifts.T + turns @ far.turning @ turns.T
        rows = far.on_tip @ lifts.T + far.on_turn @ turns.T
        free = self._active
        return balance.ravel()[free], far.missed, tangent[np.ix_(free, free)], rows[:, free]

    def _dyads(self, frames: Floats, starts: Floats, far: Resisted, load: SpatialLoad) -> Floats:
        """Return  Σ (x_p - x_i) F_pᵀ  of all forces beyond each joint i, shape (joints, 3, 3)."""
        tree, tip = self.chain.tree, starts[-1]
        force = tree.mass[:, None] * np.array(load.gravity)
        centre = starts[:-1] + (frames @ (tree.centre - self._places[:-1])[..., None])[..., 0]
        dyad = centre[:, :, None] * force[:, None, :]
        at_tip = np.array(load.force) + far.force
        force[-1] += at_tip
        dyad[-1] += np.outer(tip, at_tip) + np.outer(frames[-1] @ self._tangent, far.couple)
        force, dyad = (np.cumsum(values[::-1], axis=0)[::-1] for values in (force, dyad))
        beyond: Floats = dyad - starts[:-1, :, None] * force[:, None, :]
        return beyond

    def newton(self, q: Floats, push: Floats, load: SpatialLoad) -> State | None:
        """Return coordinates and pushes at rest from a start near them, or None."""
        length, unit, _ = self._unit
        free = int(self._active.sum())
        scale = np.where(np.arange(self.held) < self._far.deflections, length, 1.0)
        q, push = q.copy(), push.copy()
        for _ in range(_NEWTON):
            balance, missed, stiffness, held = self.residual(q, push, load)
            held = held / scale[:, None]
            matrix = np.zeros((free + self.held, free + self.held))
            matrix[:free, :free] = stiffness / unit
            matrix[:free, free:], matrix[free:, :free] = -held.T, held
            right = -np.concatenate([balance / unit, missed / scale])
            try:
                if self.held:
                    # The shortest step: a ring of a round rod may lie in any plane through its section.
                    step = np.linalg.lstsq(matrix, right, 1e-11)[0]
                else:
                    step = np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            size = np.abs(step[:free]).max(initial=0.0)
            if not math.isfinite(size):
                return None
            step *= min(1.0, 0.5 / size) if size else 1.0
            flat = q.ravel().copy()
            flat[self._active] += step[:free]
            q = flat.reshape(-1, 3)
            push = push + step[free:] * unit / scale
            if size < 1e-9:
                return q, push
        return None

    def followed(self, load: SpatialLoad) -> State:
        """Return the state under a load, followed as it grows from nothing."""
        state: State = (np.zeros((self.count, 3)), np.zeros(self.held))
        done, step = 0.0, 1.0
        for _ in range(_STEPS):
            now = load.times(min(1.0, done + step))
            found = self.newton(*state, now)
            # A jump to another branch is as bad as no answer.
            if found is None or (step > _APART and self._leaps(state, found, load.times(done), now)):
                step *= 0.5
                if step < _SMALLEST:
                    break
                continue
            state, done = found, done + step
            if done >= 1.0:
                return state
            step *= 1.5
        raise NoEquilibriumInSpace(f"no shape at rest was found beyond {done:.3g} of the load")

    def _leaps(self, before: State, after: State, less: SpatialLoad, more: SpatialLoad) -> bool:
        """Return True if pieces turn far between states, or a firm one is followed by one that falls."""
        if self._turned_between(before, after) > _TURN:
            return True
        return not self.held and self._firm(before, less) and not self._firm(after, more)

    def _firm(self, state: State, load: SpatialLoad) -> bool:
        """Return True if the tangent's symmetric part is positive: no motion falls."""
        tangent = self.residual(*state, load)[2]
        try:
            np.linalg.cholesky(tangent + tangent.T)
        except np.linalg.LinAlgError:
            return False
        return True

    def _turned_between(self, before: State, after: State) -> float:
        """Return the largest angle by which a piece, or a joint, turns from one state to another."""
        first, then = self._shape(before[0])[0], self._shape(after[0])[0]
        cosine = 0.5 * (np.einsum("nij,nij->n", first, then).min() - 1.0)
        return max(math.acos(max(-1.0, min(1.0, cosine))), float(np.abs(after[0] - before[0]).max()))

    def answer(self, state: State, load: SpatialLoad) -> SpatialEquilibrium:
        """Return what is known of a state at rest."""
        q, push = state
        frames, starts, _, _ = self._shape(q)
        _, _, stiffness, held = self.residual(q, push, load)
        if self.held:
            # What held ends allow: the rows' null space.
            _, size, basis = np.linalg.svd(held)
            rank = int((size > 1e-12 * size.max(initial=0.0)).sum())
            free = basis[rank:].T
            stiffness = free.T @ stiffness @ free
        return SpatialEquilibrium(self.chain, load, self.law, q, frames, starts, push, stiffness)


def _moments(dyad: Floats) -> Floats:
    """Return  Σ a × F  of  Σ a Fᵀ."""
    xy, yz, zx = (dyad[:, i, j] - dyad[:, j, i] for i, j in ((0, 1), (1, 2), (2, 0)))
    return np.stack([yz, zx, xy], axis=1)


def _turning(axes: Floats, rates: Floats, dyad: Floats, moment: Floats, dead: Floats) -> Floats:
    """Return how what loads do to each coordinate changes with each, shape (3 joints, 3 joints).

    Forces have a potential. A moment that stays has none: axes beyond a joint turn with it, and the moment
    does not.
    """
    count = len(axes)
    column = np.moveaxis(axes, 2, 1)
    trace = np.trace(dyad, axis1=1, axis2=2)[:, None, None]
    v = (np.einsum("nab,nkb->nka", dyad, column) - trace * column).reshape(-1, 3)
    w, joint = column.reshape(-1, 3), np.repeat(np.arange(count), 3)
    before = joint[:, None] < joint[None, :]
    upper = np.where(before, w @ v.T, 0.0)
    crossed = np.cross(w[:, None, :], w[None, :, :])
    changes = upper + upper.T + np.where(before, crossed @ dead, 0.0).T
    own = np.einsum("nkal,na->nlk", rates, moment) + column @ np.swapaxes(v.reshape(-1, 3, 3), 1, 2)
    for n in range(count):
        changes[3 * n : 3 * n + 3, 3 * n : 3 * n + 3] = own[n]
    return changes
