"""A beam that a force holds aside: as a sum of its exact modes, and as the shape that all of them come to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import real, shown, whole_number
from beammodes.exact.exact_beam import BeamModes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary

if TYPE_CHECKING:
    pass

__all__ = ["pinned_shape", "plucked", "without_rigid_motion"]

Array = NDArray[np.float64]


def plucked(shapes: BeamModes, force: float, at: float) -> Array:
    """Return the modal coordinates of a beam that a force holds aside.

        q_n = F φ_n(a) / ω_n²

    Parameters
    ----------
    shapes : BeamModes
        From `euler_bernoulli`, of a uniform beam between plain ends without rigid-body motion.
    force : float [N]
        F, up.
    at : float [m]
        a, 0 to L.

    Returns
    -------
    ndarray, shape (modes,) [kg^½ m]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the beam can move rigidly.

    Examples
    --------
    A force in the middle of a pinned beam moves its middle by 1/48; one mode gives 2/π⁴ = 1/48.7 of it:

    >>> from beammodes.exact.exact_beam import plain_modes
    >>> shapes = plain_modes(Beam.unit(), "pinned-pinned", 9)
    >>> terms = plucked(shapes, 1.0, 0.5) * shapes.shape(0.5)
    >>> terms.cumsum()[[0, 2, 8]].round(6)
    array([0.020532, 0.020785, 0.02083 ])
    """
    if not isinstance(shapes, BeamModes):
        raise TypeError(f"shapes must be BeamModes of a uniform beam between plain ends, got {shown(shapes)}")
    without_rigid_motion(shapes.boundary)
    size, place = real("force", force), _place(at, shapes.beam.length)
    return np.asarray(size * shapes.shape(place) / shapes.angular_frequency**2)


def pinned_shape(beam: Beam, force: float, at: float, x: ArrayLike, derivative: int = 0) -> Array:
    """Return the shape of a pinned-pinned beam that a force holds aside: what the sum of all modes comes to.

        y = F b x (L² - b² - x²) / (6 EI L)  for x ≤ a = L - b,  and its mirror image beyond

    Parameters
    ----------
    beam : Beam
        Uniform.
    force, at : float [N, m]
        F, up, and its place a, 0 to L.
    x : float or array [m]
        Positions, 0 to L.
    derivative : int
        0 to 2: deflection, slope, or curvature, which is the bending moment over EI.

    Returns
    -------
    ndarray, of the shape of `x` [m, -, 1/m]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Source
    ------
    S. P. Timoshenko, Strength of Materials, part I (1930), chapter V.

    Examples
    --------
    >>> pinned_shape(Beam.unit(), 48.0, 0.5, [0.25, 0.5]).tolist()
    [0.6875, 1.0]
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not beam.is_uniform:
        raise ValueError(f"beam must be uniform, got {shown(beam)}")
    order, length = whole_number("derivative", derivative, least=0, most=2), beam.length
    size, place, position = real("force", force), _place(at, length), np.asarray(x, dtype=np.float64)
    if not ((position >= 0.0) & (position <= length)).all():
        raise ValueError(f"x must be inside [0, {length}], got {shown(x)}")
    beyond = position > place
    # Seen from the nearer support of the two: a mirror changes the sign of the slope.
    arm, near = np.where(beyond, place, length - place), np.where(beyond, length - position, position)
    rest = length**2 - arm**2
    values = (near * (rest - near**2), np.where(beyond, -1.0, 1.0) * (rest - 3 * near**2), -6 * near)[order]
    return np.asarray(size * arm * values / (6 * beam.mean_bending_stiffness * length))


def without_rigid_motion(pair: Boundary) -> None:
    """Raise ValueError if a beam between these ends can move and stay straight."""
    if pair.rigid_body_modes:
        raise ValueError(f"boundary must leave no rigid-body motion, got {pair.name}")


def _place(at: float, length: float) -> float:
    place = real("at", at)
    if not 0.0 <= place <= length:
        raise ValueError(f"at must be in [0, {length}], got {shown(at)}")
    return place
