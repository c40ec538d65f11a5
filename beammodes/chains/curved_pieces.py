"""Mass, centre and inertia of the pieces that a rod is cut into: of the real ones, bent and twisted.

Masses on chords would cost order 2, axes along chords order 1; these keep a rule's order (the page "theory").
"""

from __future__ import annotations

import numpy as np

from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import carried, screw
from beammodes.problem.profiles import value_at
from beammodes.problem.rod import Rod

__all__ = ["curved_pieces"]

#: Gauss points of each piece: for pieces that bend by radians, and of more than so many pieces.
_POINTS, _FEW, _MANY = 12, 4, 1000
#: What so many points integrate to rounding turns by so much at most [rad]; a piece that turns more is cut.
_TURNING = {_POINTS: 4.0, _FEW: 0.5}
#: Such cuts in a whole rod.
_MOST_CUTS = 50_000


def curved_pieces(rod: Rod, edges: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return each piece's mass, centre, inertia of its line and of its section, in the axes at s = 0.

    Parameters
    ----------
    rod : Rod
    edges : ndarray, shape (pieces + 1,) [m]
        Where it is cut, ascending, from 0 to L.

    Returns
    -------
    ndarray, shapes (pieces,), (pieces, 3), (pieces, 3, 3) and (pieces, 3, 3) [kg], [m], [kg m²]
        The inertias are about the centre of mass; what is about the section's own centre line stands apart.

    Raises
    ------
    ValueError
        If the rod turns by so many radians that its coils cannot be integrated.

    Examples
    --------
    >>> half = Rod.arc(np.pi, length=np.pi, bending_stiffness=1, torsional_stiffness=1, mass_per_length=1)
    >>> curved_pieces(half, np.array([0.0, np.pi]))[1].round(12).tolist()      # 2/π from the circle's centre
    [[0.636619772368, 1.0, 0.0]]
    """
    breaks = np.array([s for s in rod.breaks if edges[0] < s < edges[-1]])
    stations = np.unique(np.concatenate([edges, breaks]))
    points = _POINTS if len(stations) <= _MANY else _FEW
    node, weight = np.polynomial.legendre.leggauss(points)
    stations = _cut_where_coiled(rod, stations, node)
    width = np.diff(stations)
    ahead = 0.5 * width[:, None] * (1.0 + node)
    place = stations[:-1, None] + ahead
    axes, origin = rod.frames(stations[:-1])
    turned, moved = _onward(rod, stations[:-1], ahead)
    position = origin[:, None] + (axes[:, None] @ moved[..., None])[..., 0]
    section = axes[:, None] @ turned
    owner = np.clip(np.searchsorted(edges, 0.5 * (stations[1:] + stations[:-1])) - 1, 0, len(edges) - 2)

    def summed(values: Floats) -> Floats:
        total = np.zeros((len(edges) - 1, *values.shape[2:]))
        np.add.at(total, owner, values.sum(axis=1))
        return total

    share = 0.5 * width[:, None] * weight
    dm = share * value_at(rod.mass_per_length, place.ravel()).reshape(place.shape)
    mass = summed(dm)
    centre = summed(dm[..., None] * position) / mass[:, None]
    arm = position - centre[owner][:, None]
    square = (arm**2).sum(axis=-1)[..., None, None] * np.eye(3)
    spread = summed(dm[..., None, None] * (square - arm[..., :, None] * arm[..., None, :]))
    section_inertia = np.zeros_like(spread)
    own = [rod.polar_inertia_per_length, rod.second_rotary_inertia_per_length, rod.rotary_inertia_per_length]
    if any(profile != 0.0 for profile in own):
        density = np.stack([value_at(profile, place.ravel()) for profile in own], axis=-1)
        about = share[..., None] * density.reshape(*place.shape, 3)
        section_inertia = summed((section * about[..., None, :]) @ np.swapaxes(section, -1, -2))
    return mass, centre, spread, section_inertia


def _cut_where_coiled(rod: Rod, stations: Floats, node: Floats) -> Floats:
    """Return the stations and those between them where a stretch turns by more than its points integrate."""
    width = np.diff(stations)
    if isinstance(rod.curvature, tuple):
        rate = np.full(len(width), np.linalg.norm(rod.curvature))
    elif len(stations) <= _MANY:
        place = stations[:-1, None] + 0.5 * width[:, None] * (1.0 + node)
        rate = np.linalg.norm(rod.curvature_at(place.ravel()), axis=1).reshape(place.shape).max(axis=1)
    else:
        return stations
    parts = np.maximum(np.ceil(width * rate / _TURNING[len(node)] - 1e-9), 1.0)
    if parts.sum() - len(parts) > _MOST_CUTS:
        raise ValueError(
            f"rod must turn by at most {_MOST_CUTS * _TURNING[len(node)]:,.0f} radians in a chain of so many "
            f"segments, got {float(width @ rate):,.0f}"
        )
    count = parts.astype(int)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    inner = np.repeat(stations[:-1], count) + within * np.repeat(width / parts, count)
    return np.append(inner, stations[-1])


def _onward(rod: Rod, start: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Return axes and positions ahead of stations, in the axes there, shape (n, points, 3, 3) and 3."""
    if isinstance(rod.curvature, tuple):
        along = np.zeros((*ahead.shape, 3))
        along[..., 0] = ahead
        return screw(ahead[..., None] * np.array(rod.curvature), along)
    axes, places = [np.broadcast_to(np.eye(3), (len(start), 3, 3))], [np.zeros((len(start), 3))]
    gone = np.zeros(len(start))
    for k in range(ahead.shape[1]):
        turned, moved = carried(rod.curvature_at, start + gone, start + ahead[:, k])
        places.append(places[-1] + (axes[-1] @ moved[..., None])[..., 0])
        axes.append(axes[-1] @ turned)
        gone = ahead[:, k]
    return np.stack(axes[1:], axis=1), np.stack(places[1:], axis=1)
