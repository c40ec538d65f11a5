"""The implicit midpoint rule for a chain: symplectic also where the mass matrix depends on the shape.

With the Lagrangian L = T - V, v = (q₁ - q₀)/h and all taken at the middle (q₀ + q₁)/2 of a step,

    ∂L/∂q' = p₀ + h/2 (∂L/∂q - ∂R/∂q' + (∂c/∂q)ᵀ λ),     p₁ = 2 ∂L/∂q' - p₀,     c(q₁) = 0:

the midpoint rule of Hamilton's equations in q and p = ∂L/∂q', derived from a discrete Lagrangian (J. E.
Marsden and M. West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001), 357-514). R is
Rayleigh's dissipation function. A step keeps no energy exactly, but lets it wander within bounds that shrink
with h².
"""

from __future__ import annotations

from typing import Any

import casadi

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.chain_state import ChainState, checked_system
from beammodes.dynamics.runge_kutta import Stepper, closure
from beammodes.equations.coordinates import coordinate_names, tip_names
from beammodes.equations.load_field import Algebra
from beammodes.equations.mechanics import piece_energies
from beammodes.interrupts import pause
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.damping import Damping

__all__ = ["MAX_PIECES", "implicit_midpoint", "momentum_map"]

#: Longer chains are refused: each Newton iteration of a step solves a full system. A step takes about 0.4, 14
#: and 300 ms for 50, 200 and 500 pieces, where a Runge-Kutta step takes microseconds a piece.
MAX_PIECES = 500


def implicit_midpoint(
    chain: Chain, *, load: Load | None = None, damping: Damping | None = None, base: BaseMotion | None = None
) -> Stepper:
    """Return one step of the implicit midpoint rule, of states (q, p).

    Parameters
    ----------
    chain, load, damping, base
        As `forward_dynamics.forward_dynamics` takes them; at most 500 pieces.

    Raises
    ------
    TypeError, ValueError
        As `forward_dynamics` raises, or if the chain is too long.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> import numpy as np
    >>> stepper = implicit_midpoint(Chain(Beam.unit(), "clamped-free", segments=1))
    >>> stepper.steps(np.array([1.0, 0.0]), 0.01, 0.0, 2, BaseMotion())[:, 0].round(4)
    array([0.9996, 0.9982])
    """
    checked_system(chain, load, damping, base)
    if chain.pieces > MAX_PIECES:
        raise ValueError(
            f"chain must have at most {MAX_PIECES} pieces for the midpoint rule, got {chain.pieces}"
        )
    size = len(coordinate_names(chain))
    held = int(chain.boundary.right.holds_deflection)
    v, q, p, step, middle, late, force = (
        casadi.SX.sym(name, count)
        for name, count in zip("vqphmlf", (size, size, size, 1, 9, 9, held), strict=True)
    )
    between, after = q + step / 2 * v, q + step * v
    momentum, pull = _lagrangian_terms(chain, checked_load(load), damping or Damping(), between, v, middle)
    if held:
        gap = closure(chain, between, middle)
        pull = pull + casadi.jacobian(gap, v).T / (step / 2) * force
    pause()
    units, moving = chain.units, size - len(tip_names(chain))
    # Newton's tolerance is absolute: the chain's own units make it relative.
    rate = (units.stiffness / units.mass) ** 0.5 / units.length
    scale = [1 / (units.mass * units.length * rate)] * (size - moving)
    scale += [1 / (units.mass * units.length**2 * rate)] * moving
    residual = casadi.vertcat(
        casadi.DM(scale) * (momentum - p - step / 2 * pull),
        *([closure(chain, after, late) / units.length] if held else []),
    )
    unknown, given = casadi.vertcat(v, force), casadi.vertcat(q, p, step, middle, late)
    system = casadi.Function("system", [unknown, given], [residual])
    # What is not finite is reported once, by the run, and not by CasADi at every iteration.
    options = {"abstol": 1e-13, "max_iter": 30, "error_on_fail": False, "show_eval_warnings": False}
    pause()
    solve = casadi.rootfinder("solve", "newton", system, options)
    # Where Newton's method finds nothing there is no new state.
    failed = casadi.if_else(casadi.norm_inf(residual) < 1e-9, 0, casadi.SX.nan())
    finish = casadi.Function("finish", [unknown, given], [casadi.vertcat(after, 2 * momentum - p) + failed])
    return Stepper(_step_function(size, held, solve, finish), (0.5, 1.0))


def _step_function(size: int, held: int, solve: casadi.Function, finish: casadi.Function) -> casadi.Function:
    state, step, course = (casadi.MX.sym(n, k) for n, k in (("x", 2 * size), ("h", 1), ("base", 18)))
    given = casadi.vertcat(state, step, course)
    found = solve(casadi.MX.zeros(size + held), given)
    return casadi.Function("midpoint", [state, step, course], [finish(found, given)])


def momentum_map(chain: Chain, *, load: Load | None = None) -> tuple[casadi.Function, casadi.Function]:
    """Return the functions (q, q', base) -> p and (q, p, base) -> q'."""
    size = len(coordinate_names(chain))
    q, u, base = (casadi.SX.sym(name, count) for name, count in (("q", size), ("u", size), ("base", 9)))
    momentum, _ = _lagrangian_terms(chain, checked_load(load), Damping(), q, u, base)
    pause()
    mass = casadi.jacobian(momentum, u)
    rest = casadi.substitute(momentum, u, casadi.SX.zeros(size))
    parts = casadi.Function("parts", [q, base], [mass, rest])
    place, p, course = (casadi.MX.sym(n, k) for n, k in (("q", size), ("p", size), ("base", 9)))
    inertia, still = parts(place, course)
    # In numbers: as one expression the solution would have N³ terms, and lose five digits by N = 100.
    speed = casadi.solve(inertia, p - still, "ldl") if size else p
    return (
        casadi.Function("momentum", [q, u, base], [momentum]),
        casadi.Function("speed", [place, p, course], [speed]),
    )


def _lagrangian_terms(
    chain: Chain, load: Load, damping: Damping, q: Any, u: Any, base: Any
) -> tuple[Any, Any]:
    """Return  ∂L/∂q'  and  ∂L/∂q - ∂R/∂q'  at q and q', which may be expressions."""
    size = q.rows()
    at, speed = casadi.SX.sym("at", size), casadi.SX.sym("speed", size)
    state = ChainState.of(chain, casadi.vertsplit(at), casadi.vertsplit(speed), casadi.vertsplit(base))
    units = chain.units
    algebra = Algebra(float, casadi.sin, casadi.cos, units.length, units.mass, units.stiffness)
    kinetic, potential, _ = piece_energies(
        chain, state.place, state.speed, state.angle, state.spin, algebra, load, (base[3], base[6])
    )
    lagrangian, lost = kinetic - potential, _dissipation(chain, damping, state, algebra)
    terms = casadi.Function(
        "terms",
        [at, speed, base],
        [
            casadi.gradient(lagrangian, speed),
            casadi.gradient(lagrangian, at) - casadi.gradient(lost, speed),
        ],
    )
    momentum, pull = terms(q, u, base)
    return momentum, pull


def _dissipation(chain: Chain, damping: Damping, state: ChainState, algebra: Algebra) -> Any:
    """Return Rayleigh's  ½ q'ᵀ C q'  of motion relative to the base."""
    base, spin = state.base, state.spin
    lost: Any = casadi.SX(0)
    for j, damper in enumerate(damping.joint_damping(chain).tolist()):
        lost += damper / 2 * (spin[j + 1] - spin[j]) ** 2
    relative = [rate - base[7] for rate in spin]
    # Velocities relative to a base that shifts and turns, seen along its own axes, which turns no length.
    place, turn = state.place, base[7]
    tip = (
        state.speed[0] - base[1] + turn * (place[1] - base[3]),
        state.speed[1] - base[4] - turn * (place[0] - base[0]),
    )
    kinetic, _, _ = piece_energies(chain, place, tip, state.angle, relative, algebra)
    lost += damping.mass * kinetic
    y_speed = tip[1] + casadi.dot(
        casadi.DM(chain.length.tolist()) * casadi.cos(casadi.vertcat(*state.angle)), casadi.vertcat(*relative)
    )
    for end_index, deflection, rotation in ((0, tip[1], relative[0]), (1, y_speed, relative[-1])):
        for stiffness, rate in zip(
            chain.support_stiffness[end_index].tolist(), (deflection, rotation), strict=True
        ):
            if 0 < stiffness < float("inf"):
                lost += damping.stiffness * stiffness / 2 * rate**2
    return lost
