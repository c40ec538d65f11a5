"""The method and the step that a motion takes when none is given, and what a step does to the modes.

An explicit method must resolve the chain's highest mode, whose frequency grows as N², or be unstable. An
implicit one is stable at any step, so that its step is bounded by what one wants to see: the modes that
the start or the caller asks for, and how fast the base moves and turns and loads vary. Such a mode then keeps
its frequency to 0.1 % and its amplitude to 1 % over 100 periods (`accuracy_limit`). The midpoint rule keeps
the amplitude of every mode; sdirk2 damps those that a step does not resolve (`amplification` says by how
much).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.dynamics.timed_loads import TimedLoad, pattern
from beammodes.equations.held_apart import string_tension
from beammodes.equations.mechanics import Span, tip_names
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS, accuracy_limit, amplification
from beammodes.vibration.linear import LinearModel, linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

__all__ = ["OUTPUTS", "Chosen", "Motion", "chosen", "untold_jumps"]

#: How many output times a run has unless told otherwise.
OUTPUTS = 1000
# Steps times pieces that Runge-Kutta takes in a few seconds: 0.5 to 1 µs each were measured.
_CHEAP = 5_000_000
# What a step costs in steps of Runge-Kutta, measured at N = 10 to 1,000.
_COST = {"midpoint": 3, "sdirk2": 6}
# Modes that a load or a base is taken to excite; most that a start is searched for, and the share of what it
# stores that they must hold.
_EXCITED, _MOST, _SHARE = 3, 20, 0.999


@dataclass(frozen=True)
class Motion:
    """A motion whose step is to be chosen: `span` [s], `start` as (q, q'), `modes` those asked for.

    `apart` is where the right end is held, if apart from the left one [m].
    """

    chain: Chain
    span: float
    load: Load
    drive: TimeInputs
    damping: Damping | None
    start: tuple[Floats, Floats]
    modes: int | None = None
    apart: Span | None = None

    @property
    def rests(self) -> bool:
        """True if neither a load nor the base moves a straight chain, which a load along it does not."""
        return not self.load.bends and self.drive.base == BaseMotion() and not self.drive.loads


@dataclass(frozen=True)
class Chosen:
    """An integrator, its step [s], why, and what the step does to the modes that bound it, or nothing."""

    integrator: str
    step: float
    reason: str
    step_error: str = ""


def chosen(motion: Motion, integrator: str | None, longest: float) -> Chosen:
    """Return an integrator of fixed step, the given one if any, and a step that divides `longest`."""
    explicit = "rk4" if integrator is None else integrator
    if INTEGRATORS[explicit].springs == "implicit":
        return _by_accuracy(motion, explicit, longest, _stable_step(motion, "rk4"), "method as given")
    limit = _stable_step(motion, explicit)
    loaded = max(_load_rates(motion, 1 / limit).values(), default=0.0)
    step = _divided(longest, min(limit, accuracy_limit(explicit) / loaded) if loaded else limit)
    half = "half its longest stable step or less"
    if integrator is not None:
        return Chosen(explicit, step, f"method as given; {half}")
    count = math.ceil(motion.span / step)
    if count * motion.chain.pieces <= _CHEAP:
        return Chosen(explicit, step, f"{count:,} steps of rk4 are cheap; {half}")
    damped = motion.damping is not None and motion.damping != Damping()
    kind = "sdirk2" if damped else "midpoint"
    why = (
        "damping makes the highest modes die out, as sdirk2 does"
        if damped
        else "nothing damps the motion, and midpoint keeps its energy"
    )
    found = _by_accuracy(motion, kind, longest, limit, f"rk4 would take {count:,} steps; {why}")
    if math.ceil(motion.span / found.step) * _COST[kind] < count:
        return found
    return Chosen(explicit, step, f"{kind} would cost as much as {count:,} steps of rk4; {half}")


def _divided(longest: float, limit: float) -> float:
    return longest / max(1, math.ceil(longest / limit))


def _stable_step(motion: Motion, integrator: str) -> float:
    """Return a fixed step at which every mode is stable, and short beside the whole motion."""
    pull = Load(axial_force=_largest_pull(motion))
    # Dampers may stop the highest modes: their limit is then far below the undamped one.
    step = min(
        stable_time_step(motion.chain, integrator, load=pull, damping=each) for each in {None, motion.damping}
    )
    if not step:
        raise ValueError(
            f"step must be given for {integrator}, at no step of which an undamped motion is stable"
        )
    return min(motion.span / OUTPUTS, step / 2)


def _largest_pull(motion: Motion) -> float:
    """Return how hard a motion may pull on a piece [N]: what pulls makes its vibration faster.

    What pushes a chain from the side pulls on it once it has turned, and pulls thrice as hard on a pendulum
    that has fallen from level, as its weight does. A taut cable is pulled more than it weighs.
    """
    chain, load = motion.chain, motion.load
    push = math.hypot(*map(float, load.tip)) + float(chain.mass.sum()) * math.hypot(*map(float, load.weight))
    for timed in motion.drive.loads:
        numbers = pattern(chain, timed)
        push += float(np.hypot(numbers[:, [0, 4]], numbers[:, [1, 5]]).sum() * _size(timed, motion.span))
    if motion.drive.base != BaseMotion():
        (_, _, ax), (_, _, ay), (_, spin, gain) = _sampled(motion)
        carried = np.hypot(ax, ay) + chain.length.sum() * np.hypot(spin**2, gain)
        push += float(chain.mass.sum() * carried.max())
    hung = 0.0 if motion.apart is None else string_tension(chain, load, motion.apart)
    return max(0.0, float(load.axial_force)) + hung + 3 * push


def _sampled(motion: Motion) -> Floats:
    return motion.drive.base.at(np.linspace(0.0, motion.span, OUTPUTS + 1))


def _size(timed: TimedLoad, span: float) -> float:
    """Return the largest number that a load is multiplied by."""
    times = np.concatenate([np.linspace(0.0, span, 4 * OUTPUTS + 1), timed.jumps])
    return float(np.abs(timed.at(times[times <= span])).max())


def _load_rates(motion: Motion, most: float) -> dict[str, float]:
    """Return how fast each load varies between its jumps; what is only sampled, `most` at most [rad/s]."""
    rates = {}
    for number, timed in enumerate(motion.drive.loads, start=1):
        rate = timed.fastest
        if rate is None:
            # Of a harmonic course its frequency.
            change, apart = _largest_change(timed, motion.span)
            rate = min(change / apart, most)
        rates[f"the variation of load {number}"] = float(rate)
    return rates


def _largest_change(timed: TimedLoad, span: float) -> tuple[float, float]:
    """Return how much a course changes from sample to sample, over half its range, and how long that is."""
    times = np.linspace(0.0, span, 4 * OUTPUTS + 1)
    values, cell = timed.at(times), np.searchsorted(times, timed.jumps)
    slopes = np.abs(np.diff(values))
    slopes[cell[(cell > 0) & (cell < len(times))] - 1] = 0.0
    swing = float(np.ptp(values)) / 2.0
    return (float(slopes.max()) / swing if swing else 0.0), float(times[1])


def untold_jumps(motion: Motion) -> str:
    """Say which loads seem to jump where they do not tell it."""
    for number, timed in enumerate(motion.drive.loads, start=1):
        change, apart = _largest_change(timed, motion.span) if timed.fastest is None else (0.0, 0.0)
        if change > 1.0:
            return (
                f"load {number} changes by more than half its range within {apart:.3g} s: if it jumps, "
                "give the TimedLoad its breaks="
            )
    return ""


def _by_accuracy(motion: Motion, integrator: str, longest: float, stable: float, why: str) -> Chosen:
    """Return the longest step of an implicit method that resolves the modes asked for or excited.

    `stable` is one of an explicit method: none need be shorter.
    """
    pulled = linearize(motion.chain, load=Load(axial_force=_largest_pull(motion)))
    number, reason = _modes_wanted(motion, pulled)
    omega = solve_modes(pulled, number).angular_frequency if number else np.zeros(0)
    rates = {f"mode {number}": float(omega[-1]) if len(omega) else 0.0} | _rates(motion, 1 / stable)
    fastest = max(rates, key=lambda name: rates[name])
    if not rates[fastest]:
        return Chosen(integrator, longest, f"{why}; nothing vibrates or turns")
    step = _divided(longest, accuracy_limit(integrator) / rates[fastest])
    text = f"{why}; the step resolves {fastest}, {rates[fastest]:.4g} rad/s; {reason}"
    return Chosen(integrator, step, text, _step_error(integrator, step, omega))


def _step_error(integrator: str, step: float, omega: Floats) -> str:
    """Say what a step does to the first and the last of some modes."""
    parts = []
    for k in sorted({0, len(omega) - 1}) if len(omega) else ():
        turned = omega[k] * step
        factor = complex(amplification(integrator, turned))
        shift, kept = np.angle(factor) / turned - 1, abs(factor) ** (2 * math.pi / turned)
        parts.append(f"mode {k + 1}: frequency {100 * shift:+.2g} %, amplitude times {kept:.8g} a period")
    return "; ".join(parts)


def _rates(motion: Motion, most: float) -> dict[str, float]:
    """Return how fast base, loads and start move and turn, of what is sampled `most` at most [rad/s]."""
    speeds = motion.start[1][len(tip_names(motion.chain)) :]
    rates = {"the start's rate of turning": min(float(np.abs(speeds).max(initial=0.0)), most)}
    rates |= _load_rates(motion, most)
    if motion.drive.base != BaseMotion():
        course = np.abs(_sampled(motion)).max(axis=2)
        rates["the base's rate of turning"] = float(course[2, 1])
        # Of a harmonic course its frequency.
        moving = course[:, 1] > 0
        rates["the base's motion"] = float((course[moving, 2] / course[moving, 1]).max(initial=0.0))
    return rates


def _modes_wanted(motion: Motion, pulled: LinearModel) -> tuple[int, str]:
    """Return the number of the pulled chain's modes that a step must resolve, and why that many."""
    if motion.modes is not None:
        return min(motion.modes, pulled.elastic_modes), f"modes to {motion.modes} are asked for"
    if motion.apart is not None:
        # A shape between two points is no motion of the straight chain.
        number = min(_EXCITED, pulled.elastic_modes)
        return number, f"modes to {number} are what a chain held apart is taken to move in"
    there = linearize(motion.chain).elastic_modes
    # Squares of absurd speeds are too large.
    with np.errstate(over="ignore", invalid="ignore"):
        shares = np.nan_to_num(_shares(motion, min(_MOST, there)), posinf=0.0)
    number = min(int(np.searchsorted(shares, _SHARE)) + 1, len(shares)) if shares.any() else 0
    if not motion.rests or motion.load != Load():
        # A pull makes modes of what was rigid-body motion.
        number = min(max(number + pulled.elastic_modes - there, _EXCITED), pulled.elastic_modes)
        return number, f"modes to {number} are what loads, the base and the start are taken to excite"
    if not number:
        return min(1, there), "the start bends nothing"
    return number, f"modes to {number} hold {shares[number - 1]:.2%} of what the start stores"


def _shares(motion: Motion, count: int) -> Floats:
    """Return the share of the start's energy, as of a small motion, that the first 1, 2, ... modes hold.

    Energy is a sum of squares: of springs' moments by √k, of masses' speeds by √m. A motion of the whole as a
    rigid body is no part of it.
    """
    if not count:
        return np.zeros(0)
    chain, (q, u) = motion.chain, motion.start
    modes = solve_modes(linearize(chain), count)
    tips, free = tip_names(chain), ~np.array(chain.held_angles)
    course = motion.drive.base.at(0.0)
    across, turned = [], []
    for k, values in enumerate((q, u)):
        angle = np.zeros(chain.pieces)
        angle[free] = values[len(tips) :] - course[2, k]
        y = values[tips.index("y_0")] - course[1, k] if "y_0" in tips else 0.0
        across.append(np.concatenate([[y], y + np.cumsum(chain.length * angle)]))
        turned.append(angle)
    support = np.sqrt(np.where(np.isfinite(chain.support_stiffness), chain.support_stiffness, 0.0))

    def strain(node: Floats, angle: Floats) -> Floats:
        bent = np.sqrt(chain.joint_stiffness) * np.diff(angle, axis=-1)
        return np.concatenate(
            [bent, node[..., [0, -1]] * support[:, 0], angle[..., [0, -1]] * support[:, 1]], -1
        )

    def speed(node: Floats, angle: Floats) -> Floats:
        middle = np.sqrt(chain.mass) * (node[..., :-1] + chain.centre * angle)
        return np.concatenate([middle, np.sqrt(chain.rotary_inertia) * angle], -1)

    stored, moving = strain(across[0], turned[0]), speed(across[1], turned[1])
    everything = float(stored @ stored + moving @ moving)
    if modes.rigid_body_modes:
        shifts = [(np.ones(chain.pieces + 1), np.zeros(chain.pieces))] if "y_0" in tips else []
        turns = [(chain.node_position - chain.node_position[0], np.ones(chain.pieces))] if free.all() else []
        strains, speeds = (np.array([each(*shape) for shape in shifts + turns]) for each in (strain, speed))
        # Those mixtures of a shift and a turn that store nothing.
        _, mixed = np.linalg.eigh(strains @ strains.T)
        rigid, _ = np.linalg.qr(speeds.T @ mixed[:, : modes.rigid_body_modes])
        moving = moving - rigid @ (rigid.T @ moving)
    shapes = modes.deflection, modes.rotation
    held = (strain(*shapes) @ stored / modes.angular_frequency) ** 2 + (speed(*shapes) @ moving) ** 2
    whole = float(stored @ stored + moving @ moving)
    # A motion as a rigid body leaves rounding.
    return np.cumsum(held) / whole if whole > 1e-12 * everything else np.zeros(count)
