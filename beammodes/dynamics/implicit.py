"""Implicit steps of a chain, at a cost that grows linearly with its length.

A stage of an implicit Runge-Kutta method moves the coordinates q and the momenta p = ∂L/∂q' of the Lagrangian
L = T - V from (q*, p*) by the stage's own rate v alone,

    q = q* + s v,      ∂L/∂q'(q, v) = p = p* + s (∂L/∂q - ∂R/∂q' + (∂c/∂q)ᵀ λ),      c(q) = 0,

with s = h a_ii, Rayleigh's dissipation R and the closure c of a chain whose right end is held. Newton's
method solves it piece by piece. A piece hands to the right the place, velocity V, angle and rate of its end;
to the left the momentum P and force F of all beyond its left end, and the moment M of its hinge there. With
the direction t and normal n of piece i, its rate w and the velocity C = V + c w n of its centre,

    P_i = P_{i+1} + m C,      F_i = F_{i+1} + f,      M_i = -k (θ_i - θ_{i-1}) - d (w_i - w_{i-1}),
    p_i = J w + n·(m c C + l P_{i+1}),
    ∂L/∂θ_i - ∂R/∂w_i = -w t·(m c C + l P_{i+1}) + n·(c f + l F_{i+1}) + M_i - M_{i+1} - α J (w - w_base),

where f is the weight less the drag α m of motion relative to the base, and what loads in time put on the
piece, whose moment is added to the last line. The linearized relations are
eliminated from the right end to the left, like a tridiagonal system: what is handed to the left is affine in
what comes from there.

One stage with s = h/2 is the implicit midpoint rule of Hamilton's equations. It follows from a discrete
Lagrangian and is symplectic also where the mass matrix depends on the shape: it keeps no energy exactly, but
lets it wander within bounds that shrink with h² (J. E. Marsden and M. West, Discrete mechanics and
variational integrators, Acta Numerica 10 (2001), 357-514). It meets the closure at the end of the step; a
method whose last stage is the new state meets it in every stage.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi
import numpy as np

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.forward_dynamics import applied_force, checked_system
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.dynamics.timed_loads import COLUMNS, TimedLoad, pattern
from beammodes.equations.mechanics import Span, tip_names
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS

__all__ = ["ImplicitStepper"]

#: Newton's method ends when no equation is off by more than this share of the chain's own units.
_TOLERANCE = 1e-13
_MOST_ITERATIONS = 30
# Rounding may leave a long chain's equations above the tolerance, where further iterations change nothing.
_GOOD_ENOUGH = 1e-9


def _piece(closures: int) -> tuple[casadi.Function, casadi.Function, casadi.Function]:
    """Return three functions of one piece: its right end, its part of the elimination, its Newton step."""
    right, rate = casadi.SX.sym("right", 6), casadi.SX.sym("v")
    piece, stage = casadi.SX.sym("piece", 9 + COLUMNS), casadi.SX.sym("stage", 13)
    q, p, length, centre, mass, inertia, spring, damper, held, *loads = casadi.vertsplit(piece)
    s, drag, gx, gy, bx, vx, _, by, vy, _, phi, turn, _ = casadi.vertsplit(stage)
    x, y, ux, uy, angle_before, rate_before = casadi.vertsplit(right)
    angle, w = casadi.if_else(held, phi, q + s * rate), casadi.if_else(held, turn, rate)
    cosine, sine = casadi.cos(angle), casadi.sin(angle)
    onward = casadi.vertcat(
        x + length * cosine, y + length * sine, ux - length * w * sine, uy + length * w * cosine, angle, w
    )

    beyond = casadi.SX.sym("beyond", 5)
    px, py, fx, fy, moment = casadi.vertsplit(beyond)
    cx, cy = ux - centre * w * sine, uy + centre * w * cosine
    # The base's velocity at this point: it shifts and turns like a body.
    slip_x = cx - vx + turn * (y + centre * sine - by)
    slip_y = cy - vy - turn * (x + centre * cosine - bx)
    push_x, push_y, twist = applied_force(cosine, sine, loads)
    own_x, own_y = mass * (gx - drag * slip_x) + push_x, mass * (gy - drag * slip_y) + push_y
    hinge = -spring * (angle - angle_before) - damper * (w - rate_before)
    inward = casadi.vertcat(px + mass * cx, py + mass * cy, fx + own_x, fy + own_y, hinge)
    hx, hy = mass * centre * cx + length * px, mass * centre * cy + length * py
    momentum = inertia * w + cosine * hy - sine * hx
    pull = cosine * (centre * own_y + length * fy) - sine * (centre * own_x + length * fx)
    pull += twist + hinge - moment - w * (cosine * hx + sine * hy) - drag * inertia * (w - turn)
    residual = momentum - p - s * pull

    # Of the six numbers from the left five are free: an angle differs by s times what its rate differs by.
    free = casadi.SX.zeros(6, 5)
    for row, column, value in ((0, 0, 1), (1, 1, 1), (2, 2, 1), (3, 3, 1), (4, 4, s), (5, 4, 1)):
        free[row, column] = value
    rows = [0, 1, 2, 3, 5]
    carried = casadi.jacobian(onward, right)[rows, :] @ free
    turned = casadi.jacobian(onward, rate)[rows]
    gain, rest = casadi.SX.sym("gain", 5, 5), casadi.SX.sym("rest", 5, 1 + closures)
    slope = casadi.jacobian(residual, beyond)
    pivot = casadi.jacobian(residual, rate) + slope @ gain @ turned
    pivot = casadi.if_else(held, 1, pivot)
    by_left = -(1 - held) * (casadi.jacobian(residual, right) @ free + slope @ gain @ carried) / pivot
    by_rest = -(1 - held) * (casadi.horzcat(residual, casadi.SX(1, closures)) + slope @ rest) / pivot
    through = casadi.jacobian(inward, beyond)
    effect = casadi.jacobian(inward, rate) + through @ gain @ turned
    new_gain = casadi.jacobian(inward, right) @ free + through @ gain @ carried + effect @ by_left
    new_rest = through @ rest + effect @ by_rest

    change, given, alone = (
        casadi.SX.sym("change", 5, 1 + closures),
        casadi.SX.sym("given", 1, 5),
        casadi.SX.sym("alone", 1, 1 + closures),
    )
    found = given @ change + alone
    common = [right, rate, piece, stage]
    return (
        casadi.Function("onward", common, [onward]),
        casadi.Function(
            "inward",
            [beyond, gain, rest, *common],
            [
                inward,
                new_gain,
                new_rest,
                by_left,
                by_rest,
                (1 - held) * residual,
                (1 - held) * momentum,
                push_x * cx + push_y * cy + twist * w,
            ],
        ),
        casadi.Function(
            "newton", [change, given, alone, *common], [carried @ change + turned @ found, found]
        ),
    )


class _Buffered:
    """A compiled function with arrays for its named arguments and results: a call copies nothing."""

    def __init__(self, function: casadi.Function) -> None:
        # Compiled code reads and writes the arrays; it lives no longer than the buffer does.
        self._buffer, self.evaluate = function.buffer()
        for k in range(function.n_in()):
            setattr(self, function.name_in(k), np.zeros(function.nnz_in(k)))
            self._buffer.set_arg(k, getattr(self, function.name_in(k)).data)
        for k in range(function.n_out()):
            setattr(self, function.name_out(k), np.zeros(function.nnz_out(k)))
            self._buffer.set_res(k, getattr(self, function.name_out(k)).data)

    def __getattr__(self, name: str) -> Floats:
        # For type checkers: all that there are were set above.
        raise AttributeError(name)


class ImplicitStepper:
    """Steps of a diagonally implicit Runge-Kutta method, of states (q, p) in the order of coordinate names.

    Parameters
    ----------
    chain : Chain
        Of any length.
    load, damping, loads
        As `forward_dynamics` takes them. With `loads` that vary in time a state ends with their work.
    integrator : str
        One of `INTEGRATORS` whose run is "implicit", such as "midpoint" or "sdirk2".
    span : pair of float [m], optional
        From the left end to the right one, if both are held apart.

    Examples
    --------
    >>> import beammodes as bm
    >>> stepper = ImplicitStepper(bm.Chain(bm.Beam.unit(), "clamped-free", segments=1))      # q'' = -9 q
    >>> stepper.steps(np.array([1.0, 0.0]), 0.01, 0.0, 2, BaseMotion())[:, 0].round(4)
    array([0.9996, 0.9982])
    """

    def __init__(
        self,
        chain: Chain,
        *,
        load: Load | None = None,
        damping: Damping | None = None,
        loads: Sequence[TimedLoad] = (),
        integrator: str = "midpoint",
        span: Span | None = None,
    ) -> None:
        checked_system(chain, load, damping, None)
        self.chain, self.method = chain, INTEGRATORS[integrator]
        self.load, self.damping, self.loads = checked_load(load), damping or Damping(), tuple(loads)
        self.held, self.span = np.array(chain.held_angles), span
        #: Directions in which closures hold the right tip, x or y.
        self.closed = (1,) if span is None else (0, 1)
        names = tip_names(chain)
        #: Indices of the left tip's coordinates among (x, y).
        self.free = [("x_0", "y_0").index(name) for name in names]
        self._kept = np.concatenate([[k in self.free for k in (0, 1)], ~self.held])
        units = chain.units
        rate = (units.stiffness / units.mass) ** 0.5 / units.length
        self.scale = units.mass * units.length * rate, units.mass * units.length**2 * rate, units.length
        # Momenta do not depend on loads.
        self._idle = np.zeros(len(self.loads))
        self._open = self._iteration(closed=False)
        closed = chain.boundary.right.holds_deflection
        self._stage = _Buffered(self._iteration(closed=True) if closed else self._open)

    def _iteration(self, *, closed: bool) -> casadi.Function:
        """Return one iteration of Newton's method on a stage, with or without the right end's closure."""
        chain, load, count = self.chain, self.load, self.chain.pieces
        support = np.where(np.isfinite(chain.support_stiffness), chain.support_stiffness, 0.0)
        ((left, left_turning), (right, right_turning)) = support.tolist()
        lag, axial = self.damping.stiffness, float(load.axial_force)
        spring = np.concatenate([[left_turning], chain.joint_stiffness])
        damper = np.concatenate([[lag * left_turning], self.damping.joint_damping(chain)])
        fixed = [chain.length, chain.centre, chain.mass, chain.rotary_inertia, spring, damper, self.held]

        symbols = {
            "q": count,
            "p": count,
            "v": count,
            "force": len(self.closed),
            "tip_q": 2,
            "tip_p": 2,
            "tip_v": 2,
        }
        symbols |= {"s": 1, "reach": 1, "base": 9, "late": 9, "factors": len(self.loads)}
        given = {name: casadi.MX.sym(name, size) for name, size in symbols.items()}
        q, p, v, force, tip_q, tip_p, tip_v, s, reach, base, late, factors = given.values()
        closures = len(self.closed)
        onward, inward, newton = _piece(closures)
        applied = casadi.MX(COLUMNS, count)
        for k, timed in enumerate(self.loads):
            applied += factors[k] * casadi.sparsify(casadi.DM(pattern(chain, timed).T))
        pieces = casadi.vertcat(q.T, p.T, casadi.MX(casadi.DM(np.array(fixed, dtype=np.float64))), applied)
        weight = casadi.DM([self.damping.mass, *map(float, load.weight)])
        common = [v.T, pieces, casadi.repmat(casadi.vertcat(s, weight, base), 1, count)]

        place = [tip_q[k] + s * tip_v[k] if k in self.free else base[3 * k] for k in (0, 1)]
        speed = [tip_v[k] if k in self.free else base[3 * k + 1] for k in (0, 1)]
        first = casadi.vertcat(*place, *speed, base[6], base[7])
        ends = onward.mapaccum(count)(first, *common)
        tip, lefts = ends[:, -1], casadi.horzcat(first, ends[:, :-1])
        tip_x, tip_y = map(float, load.tip)
        pushed = right * (tip[1] - base[3] + lag * (tip[3] - base[4]))
        bent = right_turning * (tip[4] - base[6] + lag * (tip[5] - base[7])) - float(load.tip_moment)
        beyond = casadi.vertcat(0, 0, axial + tip_x, tip_y - pushed, bent)
        gain = casadi.MX.zeros(5, 5)
        gain[3, 1], gain[3, 3], gain[4, 4] = -right, -right * lag, right_turning * (s + lag)
        # Columns after the first are what a unit of each closure's force does.
        rest = casadi.DM.zeros(5, 1 + closures)
        for column, k in enumerate(self.closed):
            beyond[2 + k] += force[column]
            rest[2 + k, 1 + column] = 1
        back = list(range(count - 1, -1, -1))
        found = inward.mapaccum("inward", count, 3)(
            beyond, gain, casadi.MX(rest), lefts[:, back], *(each[:, back] for each in common)
        )
        sums, gain, rest = found[0][:, -1], found[1][:, -5:], found[2][:, -1 - closures :]
        by_left, by_rest, residual, momentum, power = (
            casadi.reshape(each, each.columns() // count * each.rows(), count)[:, back] for each in found[3:]
        )

        change, off, tip_change = casadi.MX.zeros(5, 1 + closures), [], casadi.MX.zeros(2, 1 + closures)
        if self.free:
            moved = casadi.MX.zeros(5, len(self.free))
            matrix = casadi.MX.zeros(len(self.free), len(self.free))
            column = casadi.MX.zeros(len(self.free), 1 + closures)
            for row, k in enumerate(self.free):
                moved[k, row], moved[2 + k, row] = s, 1
            for row, k in enumerate(self.free):
                pulled = axial if k == 0 else left * (place[1] - base[3] + lag * (speed[1] - base[4]))
                off.append(sums[k] - tip_p[k] - s * (sums[2 + k] - pulled))
                matrix[row, :] = (gain[k, :] - s * gain[2 + k, :]) @ moved
                column[row, :] = rest[k, :] - s * rest[2 + k, :]
                column[row, 0] += off[-1]
                if k == 1:
                    matrix[row, row] += s * left * (s + lag)
            solved = -casadi.solve(matrix, column, "symbolicqr")
            change = moved @ solved
            for row, k in enumerate(self.free):
                tip_change[k, :] = solved[row, :]
        wide = [casadi.reshape(each, 1, each.rows() * count) for each in (by_left, by_rest)]
        _, rates = newton.mapaccum(count)(change, *wide, lefts, *common)
        rates = casadi.reshape(rates, 1 + closures, count)

        gap, force_change = casadi.MX.zeros(closures), casadi.MX.zeros(closures)
        if closed:
            held, length = casadi.DM(self.held.astype(float)), casadi.DM(chain.length)
            angle = held * late[6] + (1 - held) * (q + reach * v)
            cosine, sine = casadi.cos(angle), casadi.sin(angle)
            arms = {0: (cosine, -sine), 1: (sine, cosine)}
            gap = casadi.vertcat(*(casadi.dot(length, arms[k][0]) for k in self.closed))
            slope = casadi.horzcat(*((1 - held) * length * arms[k][1] * reach for k in self.closed))
            felt = slope.T @ rates.T
            if self.span is not None:
                gap -= casadi.DM(self.span)
            if 1 in self.free:
                gap += tip_q[1] + reach * tip_v[1] - late[3]
                felt += reach * tip_change[1, :]
            off_end, by = gap + felt[:, 0], felt[:, 1:]
            force_change = -off_end / by if closures == 1 else -casadi.solve(by, off_end, "symbolicqr")
        step = casadi.vertcat(1, force_change)
        force_unit, moment_unit, length_unit = self.scale
        off_by = casadi.vertcat(
            residual.T / moment_unit, *(each / force_unit for each in off), gap / length_unit
        )
        # The largest, and not a number where one of them is none.
        worst = casadi.mmax(casadi.fabs(off_by)) + 0 * casadi.sumsqr(off_by)
        results = [
            v + rates.T @ step,
            force + force_change,
            tip_v + tip_change @ step,
            worst,
            momentum.T,
            sums[:2],
            casadi.sum2(power),
        ]
        names = ["new_v", "new_force", "new_tip_v", "worst", "momentum", "tip_momentum", "power"]
        stage = casadi.Function("stage", list(given.values()), results, list(given), names)
        # Written out number by number it is five times as fast: much of each piece is zero or constant.
        return stage.expand()

    def steps(self, state: Floats, step: float, start: float, count: int, base: BaseMotion) -> Floats:
        """Return the states after each of `count` steps from time `start`, shape (count, size).

        Where Newton's method finds nothing, that state and all after it are not finite.
        """
        at = start + step * np.arange(count, dtype=np.float64)
        return self.along(state, at, np.full(count, step), TimeInputs(base))

    def along(self, state: Floats, at: Floats, lengths: Floats, drive: TimeInputs) -> Floats:
        """Return the states after each of some steps, that start at times `at`, shape (steps, size)."""
        stages, weights = self.method.stages, self.method.weights
        ends_with_stage = stages[-1] == weights
        nodes = [*(sum(row) for row in stages), 1.0]
        courses = np.moveaxis(drive.stages(at, lengths, nodes), 1, 2)
        size = len(state) - bool(self.loads)
        q, p = self._split(state[:size])
        work = state[size:]
        found = np.full((len(at), len(state)), np.nan)
        # A stage starts from its rates in the last two steps, continued in a line.
        last, before = (np.zeros((len(stages), len(q) + len(self.closed))) for _ in range(2))
        for k, step in enumerate(lengths.tolist()):
            rates: list[tuple[Floats, Floats, float]] = []
            for i, row in enumerate(stages):
                at_q, at_p = q.copy(), p.copy()
                for weight, (rate, pull, _) in zip(row[:-1], rates, strict=True):
                    at_q += step * weight * rate
                    at_p += step * weight * pull
                s = step * row[-1]
                late = i if ends_with_stage else -1
                reach = s if ends_with_stage else step * weights[i]
                given = at_q, at_p, s, reach, courses[i][k], courses[late][k][:9]
                unknown, momentum = self._solved(2 * last[i] - before[i], *given)
                if not np.isfinite(momentum).all():
                    unknown, momentum = self._solved(np.zeros(len(q) + len(self.closed)), *given)
                before[i], last[i] = (last[i], unknown) if k else (unknown, unknown)
                rates.append((unknown[: len(q)], (momentum - at_p) / s, float(self._stage.power[0])))
            for weight, (rate, pull, power) in zip(weights, rates, strict=True):
                q, p, work = q + step * weight * rate, p + step * weight * pull, work + step * weight * power
            if not (np.isfinite(q).all() and np.isfinite(p).all()):
                break
            found[k] = np.concatenate([self._joined(q, p), work])
        return found

    def _split(self, state: Floats) -> tuple[Floats, Floats]:
        """Return both halves of a state as numbers of the tip's x and y and of all pieces."""
        full = np.zeros((2, 2 + len(self.held)))
        full[:, self._kept] = state.reshape(2, -1)
        return full[0], full[1]

    def _joined(self, *halves: Floats) -> Floats:
        return np.concatenate([half[self._kept] for half in halves])

    def _solved(
        self, unknown: Floats, q: Floats, p: Floats, s: float, reach: float, base: Floats, late: Floats
    ) -> tuple[Floats, Floats]:
        """Return a stage's rates of the tip and of all pieces, with the closure's force, and its momenta."""
        stage = self._stage
        stage.q[:], stage.p[:], stage.tip_q[:], stage.tip_p[:] = q[2:], p[2:], q[:2], p[:2]
        stage.s[:], stage.reach[:], stage.base[:], stage.late[:] = s, reach, base[:9], late
        stage.factors[:] = base[9:]
        stage.tip_v[:], stage.v[:], stage.force[:] = unknown[:2], unknown[2 : len(q)], unknown[len(q) :]
        before = np.inf
        for _ in range(_MOST_ITERATIONS):
            stage.evaluate()
            off = float(stage.worst[0])
            if off <= _TOLERANCE or (off <= _GOOD_ENOUGH and off >= before / 2):
                return (
                    np.concatenate([stage.tip_v, stage.v, stage.force]),
                    np.concatenate([stage.tip_momentum, stage.momentum]),
                )
            if not np.isfinite(off):
                break
            before = off
            stage.v[:], stage.force[:], stage.tip_v[:] = stage.new_v, stage.new_force, stage.new_tip_v
        return unknown, np.full(len(q), np.nan)

    def momenta(self, q: Floats, u: Floats, base: Floats) -> Floats:
        """Return p = ∂L/∂q' at coordinates q and speeds u, shape (size,), under the base's nine numbers."""
        at, rates = self._split(np.concatenate([q, u]))
        *_, momentum, sums, _ = self._open(
            at[2:],
            0 * at[2:],
            rates[2:],
            0.0,
            at[:2],
            0 * at[:2],
            rates[:2],
            0.0,
            0.0,
            base,
            base,
            self._idle,
        )
        return self._joined(np.concatenate([np.array(sums)[:, 0], np.array(momentum)[:, 0]]))

    def speeds(self, q: Floats, p: Floats, base: Floats) -> Floats:
        """Return q' at coordinates q and momenta p, shape (times, size); base has shape (9, times)."""
        count = len(q)
        parts = [self._split(np.concatenate(pair)) for pair in zip(q, p, strict=True)]
        at, moment = (np.array([each[k] for each in parts]).reshape(count, -1).T for k in (0, 1))
        still, forces = np.zeros((1, count)), np.zeros((len(self.closed), count))
        # With s = 0 the equations are linear in the rates, so one iteration solves them.
        new, _, new_tip, *_ = self._open.map(count)(
            *(at[2:], moment[2:], 0 * at[2:], forces, at[:2], moment[:2], 0 * at[:2]),
            *(still, still, base, base, np.tile(self._idle[:, None], count)),
        )
        return np.array([self._joined(each) for each in np.vstack([np.array(new_tip), np.array(new)]).T])
