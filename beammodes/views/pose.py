"""Where a chain is in a picture: straight, in a mode, bent, or at one moment of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.chain import Chain
from beammodes.checks import positive_real, real_numbers, shown, whole_number
from beammodes.equations.equilibria import Equilibrium
from beammodes.numerics.arrays import Floats
from beammodes.vibration.modes import Modes

if TYPE_CHECKING:
    import xarray

__all__ = ["Pose", "Shape", "pose_of"]


Shape = Modes | Equilibrium | tuple[ArrayLike, ArrayLike] | Any

#: Slope of a mode's steepest piece: a zigzag steeper than this is hard to read.
_FLATTEST = 1e-9
_STEEPEST = 1.7


@dataclass(frozen=True, eq=False)
class Pose:
    """Nodes (left tip, hinges, right tip) and the angles of the pieces between them.

    Attributes
    ----------
    x, y : ndarray, shape (nodes,) [m]
    angle : ndarray, shape (pieces,) [rad]
        Counter-clockwise from the x axis.
    """

    x: Floats
    y: Floats
    angle: Floats


def pose_of(chain: Chain, shape: Shape | None, *, mode: int = 1, amplitude: float = 0.15) -> Pose:
    """Return where a chain is.

    Parameters
    ----------
    chain : Chain
    shape : None, Modes, Equilibrium, xarray.Dataset or pair of arrays
        As for `draw_chain`.
    mode, amplitude
        As for `draw_chain`.

    Raises
    ------
    TypeError, ValueError
        If `shape` is none of these, is not finite, or is not of this chain.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> pose_of(Chain(Beam.unit(), "clamped-free", segments=2), None).x
    array([0. , 0. , 0.5, 1. ])
    """
    import xarray

    straight = np.array(chain.node_position)
    if shape is None:
        return Pose(straight, np.zeros_like(straight), np.zeros(chain.pieces))
    if isinstance(shape, Modes):
        return _small(chain, *_scaled(chain, shape, mode, amplitude))
    if isinstance(shape, Equilibrium):
        return _large(chain, shape.nodes[:, 0], shape.nodes[:, 1], shape.angle)
    if isinstance(shape, xarray.Dataset):
        return _large(chain, *(_moment(shape, name) for name in ("x", "y", "angle")))
    if isinstance(shape, tuple) and len(shape) == 2:
        return _small(chain, *shape)
    raise TypeError(
        "shape must be None, Modes, an Equilibrium, one moment of a motion from simulate() or a pair "
        f"(deflection, rotation), got {shown(shape)}"
    )


def _scaled(chain: Chain, modes: Modes, mode: int, amplitude: float) -> tuple[Floats, Floats]:
    row = whole_number("mode", mode, most=len(modes.angular_frequency)) - 1
    share = positive_real("amplitude", amplitude)
    if not _FLATTEST <= share <= 1 / _FLATTEST:
        raise ValueError(
            f"amplitude must be from {_FLATTEST} to {1 / _FLATTEST:g} of the chain's length, "
            f"got {shown(amplitude)}"
        )
    largest = share * chain.node_position[-1]
    deflection, rotation = modes.deflection[row], modes.rotation[row]
    scale = max(np.abs(deflection).max() / largest, np.abs(rotation).max() / _STEEPEST)
    return deflection / scale, rotation / scale


def _small(chain: Chain, deflection: ArrayLike, rotation: ArrayLike) -> Pose:
    """Nodes move across the beam only: rods of a mode shape are a little longer than they are."""
    up = _numbers("deflection", deflection, chain.pieces + 1)
    return Pose(np.array(chain.node_position), up, np.arctan(_numbers("rotation", rotation, chain.pieces)))


def _large(chain: Chain, x: ArrayLike, y: ArrayLike, angle: ArrayLike) -> Pose:
    nodes = chain.pieces + 1
    return Pose(_numbers("x", x, nodes), _numbers("y", y, nodes), _numbers("angle", angle, chain.pieces))


def _moment(motion: xarray.Dataset, name: str) -> Floats:
    if name not in motion.variables:
        raise ValueError(f"shape must hold x, y and angle, got {shown(list(motion.data_vars))}")
    if "time" in motion.dims:
        raise ValueError("shape must be one moment of a motion, such as motion.isel(time=-1), got all of it")
    return np.asarray(motion[name].values)


def _numbers(name: str, values: ArrayLike, size: int) -> Floats:
    array = real_numbers(f"{name} of shape", values)
    if array.shape != (size,):
        raise ValueError(
            f"{name} of shape must hold {size} finite numbers for this chain, got {shown(values)}"
        )
    return array
