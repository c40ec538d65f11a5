"""A computed motion as a labelled table: angles, positions, energies and momenta over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.equations.coordinates import coordinate_names, tip_names
from beammodes.equations.load_field import Algebra
from beammodes.equations.mechanics import piece_energies
from beammodes.problem.loading import Load

if TYPE_CHECKING:
    import xarray

__all__ = ["motion_dataset"]

Array = NDArray[np.float64]

_NAMES = {
    "angle": ("angle of each rigid segment", "rad"),
    "angular_velocity": ("rate of each segment's angle", "rad/s"),
    "x": ("position of each node along the beam at rest", "m"),
    "y": ("position of each node across it", "m"),
    "tip_deflection": ("right tip's distance from the line of the base", "m"),
    "kinetic_energy": ("kinetic energy", "J"),
    "potential_energy": ("energy of springs, supports and loads", "J"),
    "energy": ("kinetic and potential energy", "J"),
    "momentum_x": ("momentum along x", "N s"),
    "momentum_y": ("momentum along y", "N s"),
    "angular_momentum": ("angular momentum about the origin", "N m s"),
    "q": ("generalized coordinates", "m, rad"),
    "u": ("generalized speeds", "m/s, rad/s"),
}


def motion_dataset(
    chain: Chain, time: Array, q: Array, u: Array, *, load: Load, base: BaseMotion, attributes: dict[str, Any]
) -> xarray.Dataset:
    """Return the motion of a chain as a Dataset, see `simulation.simulate`.

    Parameters
    ----------
    time : ndarray, shape (times,) [s]
    q, u : ndarray, shape (times, coordinates)
        Coordinates and speeds.
    attributes : dict
        What else to say of the run.
    """
    import xarray

    from beammodes import __version__

    course = base.at(time)
    angle, spin = (_of_pieces(chain, values, course[2, k]) for k, values in enumerate((q, u)))
    tip, tip_speed = (_of_tip(chain, values, course[:2, k]) for k, values in enumerate((q, u)))
    length = chain.length
    x, y = (
        np.concatenate([start[:, None], start[:, None] + np.cumsum(length * part, axis=1)], axis=1)
        for start, part in zip(tip, (np.cos(angle), np.sin(angle)), strict=True)
    )
    values: dict[str, tuple[tuple[str, ...], Array]] = {
        "angle": (("time", "segment"), angle),
        "angular_velocity": (("time", "segment"), spin),
        "x": (("time", "node"), x),
        "y": (("time", "node"), y),
        "q": (("time", "coordinate"), q),
        "u": (("time", "coordinate"), u),
    }
    phi = course[2, 0]
    across = (y[:, -1] - course[1, 0]) * np.cos(phi) - (x[:, -1] - course[0, 0]) * np.sin(phi)
    series = {"tip_deflection": across}
    # A diverging run may end in numbers whose squares are too large.
    with np.errstate(over="ignore", invalid="ignore"):
        series |= _energies(chain, tip, tip_speed, angle, spin, load, course)
        series |= _momenta(chain, tip_speed, angle, spin, x, y)
    values |= {name: (("time",), array) for name, array in series.items()}
    return xarray.Dataset(
        {
            name: (dims, array, {"long_name": _NAMES[name][0], "units": _NAMES[name][1]})
            for name, (dims, array) in values.items()
        },
        coords={
            "time": ("time", time, {"long_name": "time", "units": "s"}),
            "segment": (
                "segment",
                np.arange(1, chain.pieces + 1),
                {"long_name": "rigid segment", "units": "1"},
            ),
            "node": ("node", np.arange(chain.pieces + 1), {"long_name": "tip or hinge", "units": "1"}),
            "coordinate": coordinate_names(chain),
        },
        attrs={"source": f"beammodes {__version__}", **attributes},
    )


def _of_pieces(chain: Chain, values: Array, held: Array) -> Array:
    """Return angles or rates of all pieces, those included that the base prescribes."""
    full = np.repeat(held[:, None], chain.pieces, axis=1)
    full[:, ~np.array(chain.held_angles)] = values[:, len(tip_names(chain)) :]
    return full


def _of_tip(chain: Chain, values: Array, given: Array) -> tuple[Array, Array]:
    """Return position or velocity of the left tip."""
    names = tip_names(chain)
    x, y = (values[:, names.index(n)] if n in names else given[k] for k, n in enumerate(("x_0", "y_0")))
    return x, y


def _energies(
    chain: Chain,
    tip: tuple[Array, Array],
    tip_speed: tuple[Array, Array],
    angle: Array,
    spin: Array,
    load: Load,
    course: Array,
) -> dict[str, Array]:
    units = chain.units
    algebra = Algebra(float, np.sin, np.cos, units.length, units.mass, units.stiffness)
    kinetic, potential, _ = piece_energies(
        chain, tip, tip_speed, list(angle.T), list(spin.T), algebra, load, (course[1, 0], course[2, 0])
    )
    return {"kinetic_energy": kinetic, "potential_energy": potential, "energy": kinetic + potential}


def _momenta(
    chain: Chain, tip_speed: tuple[Array, Array], angle: Array, spin: Array, x: Array, y: Array
) -> dict[str, Array]:
    length, centre, mass = chain.length, chain.centre, chain.mass
    cosine, sine = np.cos(angle), np.sin(angle)
    carried = [np.cumsum(length * part * spin, axis=1) - length * part * spin for part in (-sine, cosine)]
    vx = tip_speed[0][:, None] + carried[0] - centre * sine * spin
    vy = tip_speed[1][:, None] + carried[1] + centre * cosine * spin
    px, py = mass * vx, mass * vy
    about = (x[:, :-1] + centre * cosine) * py - (y[:, :-1] + centre * sine) * px
    turning = about + chain.rotary_inertia * spin
    return {
        "momentum_x": px.sum(axis=1),
        "momentum_y": py.sum(axis=1),
        "angular_momentum": turning.sum(axis=1),
    }
