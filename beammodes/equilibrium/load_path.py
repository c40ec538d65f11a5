"""The path of a chain's stable shapes while its load is applied little by little, from straight.

So a chain never jumps to another shape. Where it buckles, a push along the shape that has lost its stiffness
leads it onto the branch that bends upwards; the push is taken away again under the whole load.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.equations.coordinates import unpack
from beammodes.equilibrium.static_newton import Statics
from beammodes.equilibrium.static_state import State
from beammodes.problem.loading import Load

__all__ = ["LONGEST_TURN", "shape_under"]

Array = NDArray[np.float64]

#: Largest turn of a piece from one share of the load to the next [rad].
LONGEST_TURN = 0.4

#: Smallest step of the share: to find where the chain buckles, and to follow it from there.
_COARSE, _FINE = 1e-4, 1e-7

#: Largest rotation that the push which decides a buckling chain causes without load [rad].
_PUSHED = 0.01


def shape_under(chain: Chain, statics: Statics, load: Load, tolerance: float) -> State | None:
    """Return the state that the chain is in when the whole load has been applied."""
    closures = statics.closures.size1_out(0)
    rest = statics.state(np.zeros(len(statics.scale)), np.zeros(closures), 0.0)

    def loaded(state: State, share: float) -> State | None:
        return statics.solve((state.coordinates, state.multipliers), share=share, tolerance=tolerance)

    reached, last = _along(statics, rest, loaded, _COARSE)
    if reached or not last.reduced.size:
        return last
    if not rest.is_stable:
        # A chain that nothing holds stays as it is, unless the load moves it.
        straight = None if load.bends else loaded(rest, 1.0)
        return straight if straight is not None and straight.is_indifferent else None
    push = rest.tangent @ _softest(chain, last)

    def pushed(state: State, share: float, amount: float = 1.0) -> State | None:
        start = state.coordinates, state.multipliers
        return statics.solve(start, share=share, push=amount * push, tolerance=tolerance)

    ready = pushed(rest, 0.0)
    reached, last = _along(statics, ready, pushed, _FINE) if ready else (False, rest)
    if reached:
        reached, last = _along(statics, last, lambda state, done: pushed(state, 1.0, 1.0 - done), _FINE)
    return last if reached else None


def _along(
    statics: Statics, state: State, solve: Callable[[State, float], State | None], least: float
) -> tuple[bool, State]:
    """Follow stable states from 0 to 1: whether 1 is reached, and the last of them."""
    done, step = 0.0, 0.125
    while done < 1.0 and step > least:
        following = solve(state, min(1.0, done + step))
        if following is None or _turned(statics, state, following) > LONGEST_TURN or not following.is_stable:
            step /= 2
            continue
        done, state, step = min(1.0, done + step), following, 2 * step
    return done == 1.0, state


def _turned(statics: Statics, state: State, following: State) -> float:
    moved = (following.coordinates - state.coordinates) / statics.scale
    return float(np.abs(moved).max(initial=0.0))


def _softest(chain: Chain, state: State) -> Array:
    """Return the motion that stores least: its largest rotation is small, its largest deflection upwards."""
    motion = state.basis @ np.linalg.eigh(state.reduced)[1][:, 0]
    (_, angles), (tip, turns) = (unpack(chain, q.tolist()) for q in (state.coordinates, motion))
    lengths = chain.length / chain.units.length
    lift = np.cumsum([tip[1], *(lengths * np.cos(np.array(angles, dtype=np.float64)) * turns)])
    upwards = np.sign(lift[np.abs(lift).argmax()]) or 1.0
    return np.asarray(motion * (upwards * _PUSHED / np.abs(turns).max()))
