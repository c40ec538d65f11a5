"""Accelerations of a chain in CasADi at a cost that grows linearly with its length: one sweep in, one out.

Piece i, with its left tip at acceleration a_i, has its centre of mass c_i along it and its right tip l_i; t
and n are its direction and normal. From the right tip inwards, the force that piece i takes from its left
neighbour is

    f_i = A_i a_i + b_i,      A_i = m I + A - h hᵀ/D,      b_i = h k/D - ω² (m c t + l A t) - F + b

with A = A_{i+1}, b = b_{i+1} of all beyond it and

    h = m c n + l A n,   D = J + m c² + l² n·A n,   k = τ + c n·F - l n·b + l² ω² n·A t,

for the moment τ of its springs and loads and the force F on its centre of mass; its angular acceleration is
(k - h·a_i)/D. A piece that an end holds has the base's instead. At the left tip the base gives a_0, or the
forces do where the end leaves a direction free. No mass matrix is formed.

The deflection of a held right end is a closure with one multiplier, the force on the right tip across the
beam. Accelerations are affine in it, so two sweeps find the force that keeps the tip with the base; where
both ends are held apart there are two components, and three sweeps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi
import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import instead, shown
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.timed_loads import COLUMNS, TimedLoad, pattern
from beammodes.equations.mechanics import coordinate_names, tip_names
from beammodes.problem.loading import Load, checked_load
from beammodes.progress import pause
from beammodes.vibration.damping import Damping, checked_damping

__all__ = ["ChainState", "checked_system", "forward_dynamics"]

Vector = tuple[Any, Any]
# xx, xy, yy.
Symmetric = tuple[Any, Any, Any]


def checked_system(chain: Chain, load: Load | None, damping: Damping | None, base: BaseMotion | None) -> None:
    """Raise TypeError or ValueError for what forward dynamics cannot move."""
    if not isinstance(chain, Chain):
        writes = "export_chain writes it for engines that move it"
        hint = instead(chain, SpatialChain=writes, StructureChain=writes)
        raise TypeError(f"chain must be a Chain, got {shown(chain)}{hint}")
    checked_damping(damping)
    if base is not None and not isinstance(base, BaseMotion):
        course = "; BaseMotion(angle=course) turns by a course" if callable(base) else ""
        raise TypeError(f"base must be a BaseMotion or None, got {shown(base)}{course}")
    given, (left, right) = checked_load(load), (chain.boundary.left, chain.boundary.right)
    if given.spin_rate:
        raise ValueError(
            f"spin_rate must be 0 in motion, where a BaseMotion that turns is the hub, got {given.spin_rate}"
        )
    if right.is_grounded and not left.is_grounded:
        raise ValueError(
            f"boundary must tie down the left end if any, got {chain.boundary.name}: name that end first"
        )
    if base is not None and base.turns and (right.is_grounded or not left.holds_deflection):
        raise ValueError(
            "base must not turn unless it holds the left end's deflection and nothing but the base holds the "
            f"beam, got {chain.boundary.name}"
        )


@dataclass(frozen=True)
class ChainState:
    """Angles, rates and left tip of a chain from coordinates and base.

    `gain` is the angular acceleration of pieces that an end holds, else None; `place`, `speed` and
    `acceleration` are those of the left tip, the last None where it is free; `base` is that of `base_vector`,
    and may be followed by more.
    """

    angle: list[Any]
    spin: list[Any]
    gain: list[Any]
    place: Vector
    speed: Vector
    acceleration: tuple[Any, Any]
    base: list[Any]

    @classmethod
    def of(cls, chain: Chain, q: list[Any], u: list[Any], base: list[Any]) -> ChainState:
        """Return the state of a chain from its coordinates, speeds and the nine numbers of its base."""
        tips = tip_names(chain)
        moving, rates = iter(q[len(tips) :]), iter(u[len(tips) :])
        angle, spin, gain = [], [], []
        for held in chain.held_angles:
            angle.append(base[6] if held else next(moving))
            spin.append(base[7] if held else next(rates))
            gain.append(base[8] if held else None)
        free = {name: (q[i], u[i], None) for i, name in enumerate(tips)}
        x, y = free.get("x_0", tuple(base[:3])), free.get("y_0", tuple(base[3:6]))
        place, speed, acceleration = zip(x, y, strict=True)
        return cls(angle, spin, gain, place, speed, acceleration, base)


def applied_force(cosine: Any, sine: Any, numbers: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Return the force on a piece's centre of mass and the moment about it of a pattern's seven numbers."""
    fx, fy, sx, sy, along, across, moment = numbers
    return (
        fx + cosine * along - sine * across,
        fy + sine * along + cosine * across,
        moment - sx * sine + sy * cosine,
    )


class _Sweep:
    """One sweep in and one out along a chain in a given state (module's equations)."""

    def __init__(
        self, chain: Chain, state: ChainState, load: Load, damping: Damping, loads: Sequence[TimedLoad]
    ) -> None:
        self.chain, self.state, self.load, self.damping = chain, state, load, damping
        self.tangent = [(casadi.cos(angle), casadi.sin(angle)) for angle in state.angle]
        self.place, self.speed = [state.place], [state.speed]
        for (cosine, sine), spin, length in zip(self.tangent, state.spin, chain.length.tolist(), strict=True):
            (x, y), (vx, vy) = self.place[-1], self.speed[-1]
            self.place.append((x + length * cosine, y + length * sine))
            self.speed.append((vx - length * sine * spin, vy + length * cosine * spin))
        self.applied = [
            applied_force(*tangent, numbers)
            for tangent, numbers in zip(self.tangent, self._patterns(loads), strict=True)
        ]
        self.moment = self._moments()

    def _patterns(self, loads: Sequence[TimedLoad]) -> list[list[Any]]:
        """Return the seven numbers of every piece's timed loads (module timed_loads), at this moment."""
        rows: list[list[Any]] = [[0.0] * COLUMNS for _ in range(self.chain.pieces)]
        for timed, factor in zip(loads, self.state.base[9:], strict=True):
            for i, numbers in enumerate(pattern(self.chain, timed).tolist()):
                rows[i] = [sum_ + factor * n if n else sum_ for sum_, n in zip(rows[i], numbers, strict=True)]
        return rows

    def _moments(self) -> list[Any]:
        """Return the moment of springs, dampers, supports and the tip's load on every piece."""
        chain, state = self.chain, self.state
        moments: list[Any] = [casadi.SX(0)] * chain.pieces
        dampers = self.damping.joint_damping(chain).tolist()
        for j, (stiffness, damper) in enumerate(zip(chain.joint_stiffness.tolist(), dampers, strict=True)):
            bend, rate = state.angle[j + 1] - state.angle[j], state.spin[j + 1] - state.spin[j]
            moment = stiffness * bend + damper * rate
            moments[j] += moment
            moments[j + 1] -= moment
        drag = self.damping.mass
        for i, inertia in enumerate(chain.rotary_inertia.tolist()):
            moments[i] -= drag * inertia * (state.spin[i] - state.base[7])
        for i, rotation in ((0, chain.support_stiffness[0, 1]), (-1, chain.support_stiffness[1, 1])):
            if np.isfinite(rotation) and rotation:
                turn, rate = state.angle[i] - state.base[6], state.spin[i] - state.base[7]
                moments[i] -= float(rotation) * (turn + self.damping.stiffness * rate)
        moments[-1] += float(self.load.tip_moment)
        return [moment + more for moment, (_, _, more) in zip(moments, self.applied, strict=True)]

    def _force(self, i: int) -> Vector:
        """Return the force on the centre of mass of piece i: weight, and drag relative to the base."""
        mass, centre = float(self.chain.mass[i]), float(self.chain.centre[i])
        (cosine, sine), spin = self.tangent[i], self.state.spin[i]
        vx, vy = self.speed[i][0] - centre * sine * spin, self.speed[i][1] + centre * cosine * spin
        x, y = self.place[i][0] + centre * cosine, self.place[i][1] + centre * sine
        base, turn = self.state.base, self.state.base[7]
        # Velocity of the base at this point: it shifts and turns like a body.
        bx, by = base[1] - turn * (y - base[3]), base[4] + turn * (x - base[0])
        drag, (gx, gy) = self.damping.mass, self.load.weight
        fx, fy, _ = self.applied[i]
        return mass * (float(gx) - drag * (vx - bx)) + fx, mass * (float(gy) - drag * (vy - by)) + fy

    def power(self) -> Any:
        """Return the power of the timed loads."""
        total = casadi.SX(0)
        for i, (fx, fy, moment) in enumerate(self.applied):
            (cosine, sine), spin, centre = self.tangent[i], self.state.spin[i], float(self.chain.centre[i])
            vx, vy = self.speed[i][0] - centre * sine * spin, self.speed[i][1] + centre * cosine * spin
            total += fx * vx + fy * vy + moment * spin
        return total

    def _support(self, end: int, node: int) -> Any:
        """Return the force of an end's translational spring, relative to the base, across the beam."""
        stiffness = float(self.chain.support_stiffness[end, 0])
        if not np.isfinite(stiffness) or not stiffness:
            return 0
        base = self.state.base
        shift, rate = self.place[node][1] - base[3], self.speed[node][1] - base[4]
        return -stiffness * (shift + self.damping.stiffness * rate)

    def accelerations(self, closing: Vector) -> tuple[list[Any], Vector]:
        """Return q'' and the right tip's acceleration, under the force `closing` on it."""
        pull, (fx, fy) = float(self.load.axial_force), self.load.tip
        a: Symmetric = (casadi.SX(0), casadi.SX(0), casadi.SX(0))
        b: Vector = (-(pull + float(fx) + closing[0]), -(float(fy) + self._support(1, -1) + closing[1]))
        inward = []
        for i in range(self.chain.pieces - 1, -1, -1):
            pause()
            a, b, turning = self._carried(i, a, b)
            inward.append(turning)
        node = self._left_tip(a, b, -pull)
        found = [value for value, given in zip(node, self.state.acceleration, strict=True) if given is None]
        for i, (h, d, k) in enumerate(reversed(inward)):
            gain = self.state.gain[i]
            if gain is None:
                gain = (k - h[0] * node[0] - h[1] * node[1]) / d
                found.append(gain)
            (cosine, sine), spin, length = self.tangent[i], self.state.spin[i], float(self.chain.length[i])
            node = (
                node[0] - length * (sine * gain + cosine * spin**2),
                node[1] + length * (cosine * gain - sine * spin**2),
            )
        return found, node

    def _carried(self, i: int, a: Symmetric, b: Vector) -> tuple[Symmetric, Vector, Any]:
        """Return A_i, b_i (A as xx, xy, yy) and h, D, k of piece i, from those of all beyond it."""
        chain, (cosine, sine) = self.chain, self.tangent[i]
        mass, length, centre, inertia = (
            float(values[i]) for values in (chain.mass, chain.length, chain.centre, chain.rotary_inertia)
        )
        square, (fx, fy) = self.state.spin[i] ** 2, self._force(i)
        across = (-a[0] * sine + a[1] * cosine, -a[1] * sine + a[2] * cosine)
        along = (a[0] * cosine + a[1] * sine, a[1] * cosine + a[2] * sine)
        h = (-mass * centre * sine + length * across[0], mass * centre * cosine + length * across[1])
        d = inertia + mass * centre**2 + length**2 * (-sine * across[0] + cosine * across[1])
        k = self.moment[i] + centre * (cosine * fy - sine * fx) - length * (cosine * b[1] - sine * b[0])
        k += length**2 * square * (-sine * along[0] + cosine * along[1])
        swing = (mass * centre * cosine + length * along[0], mass * centre * sine + length * along[1])
        rest = (b[0] - square * swing[0] - fx, b[1] - square * swing[1] - fy)
        gain = self.state.gain[i]
        if gain is not None:
            return (mass + a[0], a[1], mass + a[2]), (rest[0] + gain * h[0], rest[1] + gain * h[1]), (h, d, k)
        matrix = (mass + a[0] - h[0] * h[0] / d, a[1] - h[0] * h[1] / d, mass + a[2] - h[1] * h[1] / d)
        return matrix, (rest[0] + h[0] * k / d, rest[1] + h[1] * k / d), (h, d, k)

    def _left_tip(self, a: Symmetric, b: Vector, pull: float) -> Vector:
        """Return the acceleration of the left tip: the base's, or what the forces on it make of it."""
        (ax, ay), force = self.state.acceleration, self._support(0, 0)
        if ax is None:
            determinant = a[0] * a[2] - a[1] ** 2
            fx, fy = pull - b[0], force - b[1]
            return (a[2] * fx - a[1] * fy) / determinant, (a[0] * fy - a[1] * fx) / determinant
        if ay is None:
            ay = (force - b[1] - a[1] * ax) / a[2]
        return ax, ay


def forward_dynamics(
    chain: Chain,
    *,
    load: Load | None = None,
    damping: Damping | None = None,
    base: BaseMotion | None = None,
    loads: Sequence[TimedLoad] = (),
    apart: bool = False,
) -> casadi.Function:
    """Return the accelerations q'' of a chain as a function of (q, q', base), base as `base_vector` gives it.

        q'' = M(q)⁻¹ ((∂c/∂q)ᵀ λ - h(q, q') - s(q) - C q' + f(q, t))

    The chain may be of any length; its left end must be tied to the base, or neither end held. A turning hub
    is a base that turns, not a spin rate of the load. `base` is checked only: its courses are an argument of
    the function. With `loads` that vary in time their factors follow the base's numbers in that argument, and
    the function also returns their power [W]. `apart` says that the right end is held along the beam, too.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the base cannot move this chain.

    Examples
    --------
    >>> from beammodes.dynamics.base_motion import base_vector
    >>> from beammodes.problem.beam import Beam
    >>> acceleration = forward_dynamics(Chain(Beam.unit(), "clamped-free", segments=1))
    >>> round(float(acceleration(0.1, 0.0, base_vector(BaseMotion(), 0.0))), 9)    # -k θ/(m ell²/3)
    -0.9
    """
    checked_system(chain, load, damping, base)
    bare = load is None and damping is None and base is None and not loads and not apart
    if bare and _can_be_kept(chain):
        return _of_chain_alone(chain)
    return _compiled(chain, load, damping, loads, apart)


def _can_be_kept(chain: Chain) -> bool:
    """Return True if a chain can be looked up: functions that give a beam may be objects of any kind."""
    try:
        hash(chain)
    except TypeError:
        return False
    return True


@lru_cache(maxsize=4)
def _of_chain_alone(chain: Chain) -> casadi.Function:
    return _compiled(chain, None, None, (), False)


def _compiled(
    chain: Chain, load: Load | None, damping: Damping | None, loads: Sequence[TimedLoad], apart: bool
) -> casadi.Function:
    size, numbers = len(coordinate_names(chain)), 9 + len(loads)
    q, u, course = (casadi.SX.sym(name, count) for name, count in (("q", size), ("u", size), ("b", numbers)))
    state = ChainState.of(chain, casadi.vertsplit(q), casadi.vertsplit(u), casadi.vertsplit(course))
    sweep = _Sweep(chain, state, checked_load(load), damping or Damping(), loads)
    zero, one = casadi.SX(0), casadi.SX(1)
    result, tip = sweep.accelerations((zero, zero))
    if apart:
        # Affine in the two multipliers, too.
        (by_x, tip_x), (by_y, tip_y) = (sweep.accelerations(unit) for unit in ((one, zero), (zero, one)))
        xx, yx, xy, yy = (each[k] - tip[k] for each in (tip_x, tip_y) for k in (0, 1))
        gap_x, gap_y = course[2] - tip[0], course[5] - tip[1]
        whole = xx * yy - xy * yx
        fx, fy = (yy * gap_x - xy * gap_y) / whole, (xx * gap_y - yx * gap_x) / whole
        result = [a + fx * (b - a) + fy * (c - a) for a, b, c in zip(result, by_x, by_y, strict=True)]
    elif chain.boundary.right.holds_deflection:
        # Affine in the multiplier: the force that leaves the tip with the base.
        unit, moved = sweep.accelerations((zero, one))
        force = (course[5] - tip[1]) / (moved[1] - tip[1])
        result = [x + force * (y - x) for x, y in zip(result, unit, strict=True)]
    found = [casadi.vertcat(*result), *([sweep.power()] if loads else [])]
    return casadi.Function("acceleration", [q, u, course], found)
