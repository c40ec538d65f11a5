"""Exact modes of a rod in space, curved, twisted and varying as it may be: roots counted, none missed.

At angular frequency ω the displacement v, rotation θ, force n and moment m in the section's axes obey twelve
equations along the rod, with κ its curvature at rest and t = (1, 0, 0):

    v' = -κ × v + θ × t + C_n n         n' = -κ × n - ω² ρA v
    θ' = -κ × θ + C_m m                 m' = -κ × m - t × n - ω² J θ

C_m = diag(1/GJ, 1/EI_y, 1/EI_z); C_n is zero unless the rod shears and stretches; J is the section's inertia.
They are Hamilton's with (v, θ) the coordinates and (n, m) the momenta. So the solutions that meet the left
end's conditions are a Lagrangian plane of six dimensions, which s and ω turn, and ω is a natural frequency
where it meets that of the right end.

Two such planes have six angles between them (J.-M. Souriau): the arguments of the eigenvalues of a unitary
matrix, zero where they meet. With ω each only grows. Their sum is followed along the rod, in steps too short
to lose a turn, and so is known beyond multiples of 2π; below ω² = 0 nothing can vibrate. Together that counts
the frequencies below any ω, equal ones each for itself, and each is a root of one increasing angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Shown, row_shown, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.numerics.roots import increasing_root
from beammodes.numerics.rotations import cross_matrix
from beammodes.problem.profiles import value_at
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnd, RodEnds

Integers = NDArray[np.int64]

__all__ = ["MOST_ROD_MODES", "RodModes", "rod_modes"]

#: Of one rod; each is a root of its own.
MOST_ROD_MODES = 100

#: Gauss points of a step of a rod that varies: order 8.
_STAGES = 4

#: Steps at least between two breaks; refinements of them; the change that ends these.
_LEAST_STEPS, _REFINED, _SETTLED = 8, 5, 1e-11

_LOWEST = 1e-7

#: Steps at most: of a rod whose stiffnesses differ by many powers of ten, or a high mode.
_MOST_STEPS = 30_000


@dataclass(frozen=True, eq=False, repr=False)
class RodModes(Shown):
    """The first elastic modes of a rod; `rod_modes` makes it.

    Attributes
    ----------
    rod : Rod
    ends : RodEnds
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Equal ones each for itself: a straight round rod bends alike in two planes. Read-only.
    rigid_body_modes : int
        Number of motions of frequency zero before them.
    """

    rod: Rod
    ends: RodEnds
    angular_frequency: Floats
    rigid_body_modes: int

    @property
    def frequency(self) -> Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2 * math.pi)

    def _line(self) -> str:
        rigid = f"; {self.rigid_body_modes} rigid-body modes" if self.rigid_body_modes else ""
        return f"RodModes({self.ends}: {row_shown(self.frequency, '{:.4g}', 'Hz')}{rigid})"


def rod_modes(rod: Rod, boundary: RodBoundaryLike, modes: int) -> RodModes:
    """Return the first elastic modes of a rod: of bending and twist, and what curvature makes of them.

    Kirchhoff's rod, inextensible and unshearable, unless it has shear or axial stiffness; the section's
    rotary inertias count where they are given. Right to about 1e-12, and to 1e-10 where the rod varies.

    Parameters
    ----------
    rod : Rod
    boundary : str, pair or RodEnds
        Its ends; the one named first is at s = 0.
    modes : int
        How many, 1 to 100.

    Returns
    -------
    RodModes
        Frequencies and shapes, in the order of their frequencies.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.
    ArithmeticError
        If the rod varies too steeply for its frequencies to settle.

    Examples
    --------
    >>> import beammodes as bm
    >>> helix = bm.Rod(1.0, 1.0, 1 / 1.3, 1.0, curvature=(1.0, 0.0, 2 * math.pi))
    >>> bm.rod_modes(helix, "clamped-free", 2).angular_frequency.round(8)
    array([6.59038149, 7.42199989])
    """
    if not isinstance(rod, Rod):
        raise TypeError(f"rod must be a Rod, got {shown(rod)}")
    ends, count = RodEnds.of(boundary), whole_number("modes", modes, most=MOST_ROD_MODES)
    frames, places = rod.frames([rod.length])
    acting = rod.determined(ends)
    rigid = acting.rigid_body_modes(frames[0], places[0] / rod.length)
    length, stiffness, mass = rod.units
    unit = math.sqrt(stiffness / mass) / length
    problem = _Problem(rod, acting)
    omega = _roots(problem, rigid, count)
    if not rod.is_uniform:
        for _ in range(_REFINED):
            before, problem = omega, _Problem(rod, acting, 2 * problem.refined)
            omega = _polished(problem, rigid, before)
            if np.abs(omega / before - 1.0).max() < _SETTLED:
                break
        else:
            raise ArithmeticError(
                f"frequencies did not settle to {_SETTLED}: the rod varies too steeply; give its breaks"
            )
    omega = omega * unit
    omega.flags.writeable = False
    return RodModes(rod, ends, omega, rigid)


def _roots(problem: _Problem, rigid: int, count: int) -> Floats:
    """Return the first frequencies above zero, in the rod's own unit."""
    low = 0.1
    while problem.below(np.array([low]))[0] > rigid:
        low *= 0.1
        if low < _LOWEST:
            raise ArithmeticError("boundary has springs too soft to be told from none")
    grid: Floats = low * 1.5 ** np.arange(1.0, 9.0)
    known, below = [np.array([low])], [np.array([rigid])]
    while below[-1][-1] < rigid + count:
        known.append(grid)
        below.append(problem.below(grid))
        grid = grid * 1.5**8
    places, counts = np.concatenate(known), np.concatenate(below)
    wanted = rigid + 1 + np.arange(count)
    at = np.searchsorted(counts, wanted)
    # Counts fall nowhere; were rounding to make them, the bracket would only be wider.
    return _between(problem, wanted, places[at - 1], places[at])


def _polished(problem: _Problem, rigid: int, omega: Floats) -> Floats:
    wanted = rigid + 1 + np.arange(len(omega))
    wide = 1e-3
    while True:
        low, high = omega * (1 - wide), omega * (1 + wide)
        if (problem.below(low) < wanted).all() and (problem.below(high) >= wanted).all():
            return _between(problem, wanted, low, high, omega)
        wide *= 4
        if wide > 0.9:
            return _roots(problem, rigid, len(omega))


def _between(
    problem: _Problem, wanted: Integers, low: Floats, high: Floats, start: Floats | None = None
) -> Floats:
    start = np.sqrt(low * high) if start is None else start
    # The logarithm, so that the tolerance is relative.
    found = increasing_root(
        lambda place: problem.angle(np.exp(place), wanted),
        np.log(start),
        np.log(low),
        np.log(high),
        np.full(len(wanted), 2e-15),
    )
    return np.exp(found)


class _Problem:
    """The rod's equations in units of L, the larger EI and ρA, and the angles between its ends' planes."""

    def __init__(self, rod: Rod, ends: RodEnds, refined: int = 1) -> None:
        self.refined = refined
        self._rod, self._length = rod, rod.length
        length, stiffness, mass = rod.units
        self._force, self._moment = stiffness / length, stiffness
        self._ends = [_own(end, length, stiffness, mass) for end in (ends.left, ends.right)]
        self._edges = np.array([0.0, *rod.breaks, rod.length]) / rod.length
        self._steps: dict[int, tuple[Floats, Floats, tuple[Floats, Floats, Floats]]] = {}
        samples = (np.arange(33) + 0.5) / 33
        self._samples = self._coefficients(samples)
        # Nothing vibrates below ω² = 0: the count there is that of none.
        self._none = int(self._counted(np.array([-1.0]))[0][0])

    def _coefficients(self, place: Floats) -> tuple[Floats, Floats, Floats]:
        """Return P, C and M of  u' = P u + C f,  f' = -λ M u - Pᵀ f  at places 0 to 1, shape (n, 6, 6)."""
        rod, s, length = self._rod, place * self._length, self._length
        p, c, m = (np.zeros((len(place), 6, 6)) for _ in range(3))
        turning = -cross_matrix(length * rod.curvature_at(s))
        p[:, :3, :3] = p[:, 3:, 3:] = turning
        p[:, :3, 3:] = -cross_matrix(np.array([1.0, 0.0, 0.0]))
        mass = value_at(rod.mass_per_length, s) / (rod.units[2] / length)
        stiffness = (rod.torsional_stiffness, rod.second_bending_stiffness, rod.bending_stiffness)
        inertia = (
            rod.polar_inertia_per_length,
            rod.second_rotary_inertia_per_length,
            rod.rotary_inertia_per_length,
        )
        shear = (rod.axial_stiffness, rod.shear_stiffness, rod.second_shear_stiffness)
        for k in range(3):
            m[:, k, k] = mass
            m[:, 3 + k, 3 + k] = value_at(inertia[k], s) / (rod.units[2] * length)
            c[:, 3 + k, 3 + k] = self._moment * length / value_at(stiffness[k], s)
            give = shear[k]
            if give is not None:
                c[:, k, k] = self._force / length / value_at(give, s)
        return p, c, m

    def below(self, omega: Floats) -> Integers:
        """Return how many frequencies, rigid-body modes included, lie below each ω."""
        return self._counted(omega**2)[0] - self._none

    def angle(self, omega: Floats, wanted: Integers) -> Floats:
        """Return for each ω the angle that passes zero at the wanted frequency, counted from 1."""
        count, angles = self._counted(omega**2)
        behind = count - self._none - wanted
        # Angles in descending order are those that passed zero last, last ones first.
        passed = np.take_along_axis(angles, np.clip(behind, 0, 5)[:, None], axis=1)[:, 0]
        ahead = np.take_along_axis(angles, np.clip(6 + behind, 0, 5)[:, None], axis=1)[:, 0] - 2 * math.pi
        far = 2 * math.pi * np.sign(behind + 0.5)
        near: Floats = np.where(behind >= 0, passed, ahead)
        return np.where((behind > 5) | (behind < -6), far, near)

    def _counted(self, square: Floats) -> tuple[Integers, Floats]:
        """Return whole turns of all angles together, and the six angles in [0, 2π), ascending."""
        scale = self._scale(square)
        plane, phase = _end_plane(*self._ends[0], square, scale, 1)
        far, end_phase = _end_plane(*self._ends[1], square, scale, -1)
        moves = self._moves(square, scale)
        before = np.linalg.det(_unitary(plane)) ** 2
        for move in moves:
            plane = np.linalg.qr(move @ plane)[0]
            after = np.linalg.det(_unitary(plane)) ** 2
            phase = phase + np.angle(after / before)
            before = after
        ours, others = _unitary(plane), _unitary(far).conj()
        between = ours @ np.swapaxes(ours, 1, 2) @ others @ np.swapaxes(others, 1, 2)
        angles = np.sort(np.mod(np.angle(np.linalg.eigvals(between)), 2 * math.pi), axis=1)
        turns = np.rint((phase - end_phase - angles.sum(axis=1)) / (2 * math.pi)).astype(int)
        return turns, angles

    def _scale(self, square: Floats) -> Floats:
        """Return what v and θ, and inversely n and m, are measured in: their waves then turn all at one rate.

        With k the wavenumber of bending about an axis and c its flexibility these are √(c/k³) and √(c/k).
        """
        _, give, weight = (np.exp(np.log(np.abs(values) + 1e-300).mean(axis=0)) for values in self._samples)
        give, weight = np.diagonal(give)[3:], np.diagonal(weight)
        rate = np.abs(square)[:, None]
        bending = np.maximum(1.0, (rate * weight[1] * give[1:]) ** 0.25)
        twist = np.maximum(1.0, np.sqrt(rate[:, 0] * weight[3] * give[0]))
        across = np.sqrt(give[1:] / bending**3)[:, ::-1]
        turning = np.sqrt(give[1:] / bending)
        along, about = np.sqrt(across.prod(axis=1)), np.sqrt(give[0] / twist)
        return np.column_stack([along, across, about, turning])

    def _moves(self, square: Floats, scale: Floats) -> list[Floats]:
        """Return the matrices that carry states along the rod, step by step, for each ω²."""
        p, c, m = self._samples
        hamilton = np.zeros((len(square), len(p), 12, 12))
        s, back = scale[:, None, :, None], 1.0 / scale[:, None, None, :]
        hamilton[..., :6, :6] = square[:, None, None, None] * m * s * scale[:, None, None, :]
        hamilton[..., 6:, :6] = p / s * scale[:, None, None, :]
        hamilton[..., :6, 6:] = np.swapaxes(hamilton[..., 6:, :6], -1, -2)
        hamilton[..., 6:, 6:] = c / s * back
        rate = np.sort(np.abs(np.linalg.eigvalsh(hamilton)), axis=-1)[..., 6:].sum(axis=-1).max()
        # The phase turns at 2 tr(Zᵀ H Z) on an orthonormal Z; half a turn in a step would be lost.
        wanted = max(_LEAST_STEPS, math.ceil(2.0 * rate / 2.5))
        if wanted > _MOST_STEPS:
            raise ArithmeticError(
                "rod must curve less, or its stiffnesses must be less unlike: states along it would need "
                f"{wanted:.3g} steps, more than {_MOST_STEPS:,}"
            )
        if self._rod.is_uniform:
            size = np.concatenate([scale, 1.0 / scale], axis=-1)
            p, c, m = (matrix[:1] for matrix in self._samples)
            flow = _flow(p, c, m, square)[:, 0] / wanted
            return [_exponential(flow * size[:, None, :] / size[:, :, None])] * wanted
        steps = 2 ** math.ceil(math.log2(wanted))
        return list(np.moveaxis(self._collocated(square, scale, steps), 1, 0))

    def _collocated(self, square: Floats, scale: Floats, steps: int) -> Floats:
        """Return the matrices of Gauss's collocation, of order 8, shape (squares, steps, 12, 12)."""
        if steps not in self._steps:
            parts = np.diff(self._edges)
            shares = self.refined * np.maximum(1, np.ceil(parts * steps)).astype(int)
            width = np.repeat(parts / shares, shares)
            start = np.concatenate(
                [
                    low + part / n * np.arange(n)
                    for low, part, n in zip(self._edges[:-1], parts, shares, strict=True)
                ]
            )
            node, _, _ = _gauss()
            places = start[:, None] + width[:, None] * node
            self._steps[steps] = (start, width, self._coefficients(places.ravel()))
        _, width, coefficients = self._steps[steps]
        node, weight, integrals = _gauss()
        size = np.concatenate([scale, 1.0 / scale], axis=-1)
        moves = np.empty((len(square), len(width), 12, 12))
        identity = np.eye(12 * _STAGES)
        for k in range(len(square)):
            flow = _flow(*coefficients, square[k : k + 1])[0] * size[k] / size[k][:, None]
            flow = flow.reshape(len(width), _STAGES, 12, 12) * width[:, None, None, None]
            system = -integrals[:, None, :, None] * np.moveaxis(flow, 1, 2)[:, None, :, :, :]
            system = system.reshape(len(width), 12 * _STAGES, 12 * _STAGES) + identity
            right = np.tile(np.eye(12), (_STAGES, 1))
            stages = np.linalg.solve(system, np.broadcast_to(right, (len(width), *right.shape)))
            stages = stages.reshape(len(width), _STAGES, 12, 12)
            moves[k] = np.eye(12) + np.einsum("j,njab,njbc->nac", weight, flow, stages, optimize=True)
        return moves


def _flow(p: Floats, c: Floats, m: Floats, square: Floats) -> Floats:
    """Return the matrices of the twelve equations, shape (squares, places, 12, 12)."""
    flow = np.zeros((len(square), len(p), 12, 12))
    flow[..., :6, :6], flow[..., :6, 6:] = p, c
    flow[..., 6:, :6] = -square[:, None, None, None] * m
    flow[..., 6:, 6:] = -np.swapaxes(p, 1, 2)
    return flow


def _exponential(flow: Floats) -> Floats:
    """Return exp of matrices of norm up to 1.25, by its series: what it leaves out is below 1e-17."""
    total = np.broadcast_to(np.eye(12), flow.shape)
    for order in range(20, 0, -1):
        total = np.eye(12) + flow @ total / order
    return total


def _gauss() -> tuple[Floats, Floats, Floats]:
    """Return Gauss's points and weights on 0 to 1, and the integrals of their polynomials up to each."""
    node, weight = np.polynomial.legendre.leggauss(_STAGES)
    degree = np.arange(_STAGES)
    series = (degree + 0.5)[:, None] * np.polynomial.legendre.legvander(node, _STAGES - 1).T * weight
    values = np.polynomial.legendre.legvander(node, _STAGES)
    rising = np.empty((_STAGES, _STAGES))
    rising[:, 0] = node + 1.0
    rising[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2.0 * degree[1:] + 1.0)
    return 0.5 * (1.0 + node), 0.5 * weight, 0.5 * rising @ series


def _own(end: RodEnd, length: float, stiffness: float, mass: float) -> tuple[Floats, Floats]:
    """Return an end's stiffnesses and its body's mass matrix in the rod's units."""
    lengths = np.array([length] * 3 + [1.0] * 3)
    return end.stiffness * lengths**2 / stiffness, end.mass_matrix * np.outer(lengths, lengths) / (
        mass * length**2
    )


def _end_plane(
    springs: Floats, body: Floats, square: Floats, scale: Floats, side: int
) -> tuple[Floats, Floats]:
    """Return an orthonormal basis of the states that an end allows, for each ω², and its phase, followed."""
    free = np.isfinite(springs)
    pushed = np.where(free, springs, 0.0)
    resist = (np.diag(pushed) - square[:, None, None] * body) * scale[:, :, None] * scale[:, None, :]
    resist = resist[:, free][:, :, free]
    plane = np.zeros((len(square), 12, 6))
    count = int(free.sum())
    plane[:, :6, :count] = np.eye(6)[:, free]
    plane[:, 6:, :count] = side * np.eye(6)[:, free] @ resist
    plane[:, 6:, count:] = np.eye(6)[:, ~free]
    phase = -side * np.arctan(np.linalg.eigvalsh(resist)).sum(axis=1) - 0.5 * math.pi * (6 - count)
    return np.linalg.qr(plane)[0], 2.0 * phase


def _unitary(plane: Floats) -> NDArray[np.complex128]:
    return plane[:, :6] - 1j * plane[:, 6:]
