"""How a joint of a chain in space turns, and what its three springs then store: a ball, or hinges in a row.

A rod's springs store  ½ Σ k_i φ_i²  of a rotation whose vector is φ: the bending and the twist between two
sections. A ball joint does. Three hinges one after the other store it of their own angles, and those are not
the rotation's vector: already at second order they differ by products of two angles, such as the spurious
twist ½ φ_y φ_z. Added up along a chain that bends and twists these are of first order in 1/N. A chain whose
order of hinges is reversed at every other joint has them with alternating signs: second order again.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from beammodes.checks import Catalogue, Shown, choice, shown
from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix, rotation

__all__ = ["JOINT_LAWS", "JointLaw", "joint_law"]


@dataclass(frozen=True, slots=True, repr=False)
class JointLaw(Shown):
    """What the three coordinates of a joint mean.

    Parameters
    ----------
    name : str
    orders : tuple of str
        Of hinges, from the parent on, such as "xyz": one for all joints, or several that joints take in turn.
        Empty for a ball joint, whose coordinates are the rotation's vector.

    Examples
    --------
    >>> JOINT_LAWS["yzx"].orders, JOINT_LAWS["yzx_alternating"].orders
    (('yzx',), ('yzx', 'xzy'))
    """

    name: str
    orders: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise TypeError(f"name must be a text, got {shown(self.name)}")
        if not isinstance(self.orders, tuple):
            raise TypeError(f'orders must be a tuple such as ("xyz", "zyx"), got {shown(self.orders)}')
        for order in self.orders:
            if not isinstance(order, str) or sorted(order) != ["x", "y", "z"]:
                raise ValueError(f"orders must each have x, y and z once, got {shown(order)}")

    def turned(self, q: Floats) -> tuple[Floats, Floats, Floats]:
        """Return how joints turn, and the axes of their coordinates, with derivatives.

        Parameters
        ----------
        q : ndarray, shape (joints, 3) [rad]
            Coordinates, about x, y and z.

        Returns
        -------
        rotation : ndarray, shape (joints, 3, 3)
            In the axes of the joint on its parent.
        axes : ndarray, shape (joints, 3, 3)
            Column k: the angular velocity for unit rate of coordinate k.
        rates : ndarray, shape (joints, 3, 3, 3)
            [:, k, :, l]: the derivative of column l by coordinate k.
        """
        if not self.orders:
            return _ball(q)
        parts = [_hinges(q[k :: len(self.orders)], order) for k, order in enumerate(self.orders)]
        whole = tuple(np.empty((len(q), *part.shape[1:])) for part in parts[0])
        for k, part in enumerate(parts):
            for total, one in zip(whole, part, strict=True):
                total[k :: len(self.orders)] = one
        return whole[0], whole[1], whole[2]


def _ball(q: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the rotation of a vector; its axes are  I + b q× + c (q×)²,  b and c of the angle."""
    square = (q**2).sum(axis=1)
    b, c, b_rate, c_rate = _series(square)
    cross = cross_matrix(q)
    twice = cross @ cross
    axes = np.eye(3) + b[:, None, None] * cross + c[:, None, None] * twice
    rates = np.empty((len(q), 3, 3, 3))
    for k in range(3):
        unit = cross_matrix(np.eye(3)[k])
        own = b[:, None, None] * unit + c[:, None, None] * (unit @ cross + cross @ unit)
        along = 2.0 * q[:, k, None, None] * (b_rate[:, None, None] * cross + c_rate[:, None, None] * twice)
        rates[:, k] = own + along
    return rotation(q), axes, rates


def _series(square: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return  (1 - cos θ)/θ²  and  (θ - sin θ)/θ³,  and their derivatives by θ², of θ²."""
    small = square < 0.25
    near, far = np.where(small, square, 0.0), np.where(small, 1.0, square)
    angle = np.sqrt(far)
    sin, cos = np.sin(angle), np.cos(angle)
    found = []
    for first, value, rate in (
        (2, (1 - cos) / far, (angle * sin / 2 - (1 - cos)) / far**2),
        (3, (angle - sin) / (far * angle), ((1 - cos) * angle - 3 * (angle - sin)) / (2 * far**2 * angle)),
    ):
        term, total, slope = np.full_like(near, 1.0 / math.factorial(first)), 0.0 * near, 0.0 * near
        power = np.ones_like(near)
        for k in range(12):
            total = total + term * power
            # The next power's coefficient, times its exponent, is the slope's.
            term = -term / ((first + 2 * k + 1) * (first + 2 * k + 2))
            slope = slope + (k + 1) * term * power
            power = power * near
        found.append((np.where(small, total, value), np.where(small, slope, rate)))
    return found[0][0], found[1][0], found[0][1], found[1][1]


def _hinges(q: Floats, order: str) -> tuple[Floats, Floats, Floats]:
    """Return the rotation of hinges in a row; each axis is carried by the hinges before it."""
    whole = np.broadcast_to(np.eye(3), (len(q), 3, 3))
    axes, rates = np.zeros((len(q), 3, 3)), np.zeros((len(q), 3, 3, 3))
    done: list[int] = []
    for word in order:
        k = "xyz".index(word)
        axes[:, :, k] = whole[:, :, k]
        for before in done:
            rates[:, before, :, k] = np.cross(axes[:, :, before], axes[:, :, k])
        whole = whole @ rotation(q[:, k, None] * np.eye(3)[k])
        done.append(k)
    return whole, axes, rates


_ORDERS = ["".join(order) for order in itertools.permutations("xyz")]

_RECORDS = (
    JointLaw("ball"),
    *(JointLaw(order, (order,)) for order in _ORDERS),
    *(JointLaw(f"{order}_alternating", (order, order[::-1])) for order in _ORDERS),
)

#: Every joint law by name, read-only: a ball; hinges in each order, the same at all joints or alternating.
JOINT_LAWS: Catalogue[JointLaw] = Catalogue("joint laws", {law.name: law for law in _RECORDS})


def joint_law(law: str | JointLaw) -> JointLaw:
    """Return the joint law of that name; a `JointLaw` is returned as it is.

    Examples
    --------
    >>> joint_law("ball").orders
    ()
    """
    return law if isinstance(law, JointLaw) else JOINT_LAWS[choice("joints", law, JOINT_LAWS)]
