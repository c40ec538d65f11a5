"""What a motion starts from: a chain at rest with its base, in the shape of a mode, or as given."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import bounded, real, real_numbers, shown, whole_number
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.chain_state import base_vector
from beammodes.dynamics.runge_kutta import projection
from beammodes.equations.coordinates import coordinate_names, tip_names
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["initial_state", "mode_start"]

Array = NDArray[np.float64]
State = tuple[Array, Array]


def mode_start(chain: Chain, mode: int, amplitude: float, *, load: Load | None = None) -> State:
    """Return coordinates and speeds of a chain at rest in the shape of a mode.

    Parameters
    ----------
    chain : Chain
    mode : int
        1-based index of an elastic mode.
    amplitude : float [rad]
        Largest angle of a segment.
    load : Load, optional
        Under which the modes are taken.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the chain has no such mode.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> mode_start(Chain(Beam.unit(), "clamped-free", segments=2), 1, 0.1)[0].round(4)
    array([0.0558, 0.1   ])
    """
    model = linearize(chain, load=load)
    number = whole_number("mode", mode, most=model.elastic_modes)
    real("amplitude", amplitude)
    modes = solve_modes(model, number)
    rotation, deflection = modes.rotation[number - 1], modes.deflection[number - 1]
    scale = amplitude / np.abs(rotation).max()
    tips = {"x_0": 0.0, "y_0": deflection[0]}
    q = [*(tips[name] for name in tip_names(chain)), *rotation[~np.array(chain.held_angles)]]
    start = scale * np.array(q), np.zeros(len(q))
    return _onto(chain, start, BaseMotion()) if chain.boundary.right.holds_deflection else start


def initial_state(chain: Chain, initial: Any, base: BaseMotion) -> State:
    """Return the first state, on the closure of a chain whose right end is held."""
    course, names = base.at(0.0), coordinate_names(chain)
    rest = [{"x_0": course[0, k], "y_0": course[1, k]} for k in (0, 1)]
    q, u = (np.array([rest[k].get(n, course[2, k]) for n in names]) for k in (0, 1))
    if initial is not None and hasattr(initial, "coordinates"):
        q = np.asarray(initial.coordinates, dtype=np.float64)
    elif initial is not None:
        try:
            q, u = bounded("initial", initial, most=2)
        except (TypeError, ValueError):
            raise TypeError(f"initial must be coordinates and speeds, got {shown(initial)}") from None
        q, u = real_numbers("initial", q), real_numbers("initial", u)
    for part in (q, u):
        if part.shape != (len(names),) or not np.isfinite(part).all():
            raise ValueError(f"initial must be finite numbers for {', '.join(names)}, got {shown(part)}")
    if not chain.boundary.right.holds_deflection:
        return q, u
    state = _onto(chain, (q, u), base)
    if np.abs(state[0] - q).max() > 1e-3:
        raise ValueError("initial must leave the right end where its support holds it")
    return state


def _onto(chain: Chain, start: State, base: BaseMotion) -> State:
    """Return the nearest state on the closure."""
    onto = projection(chain)
    state = np.concatenate(start)
    for _ in range(4):
        state = np.array(onto(state, base_vector(base, 0.0)))[:, 0]
    return state[: len(start[0])], state[len(start[0]) :]
