"""Poses, and masses with their inertia in space: what model files say of rigid bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Inertial",
    "Pose",
    "about",
    "ends_of",
    "from_euler",
    "from_quaternion",
    "from_rpy",
    "from_z_to",
    "joined",
    "solid",
]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pose:
    """A frame in another: x_outer = rotation x_inner + position."""

    rotation: Array
    position: Array

    @classmethod
    def identity(cls) -> Pose:
        """Return the pose that changes nothing."""
        return cls(np.eye(3), np.zeros(3))

    def __matmul__(self, inner: Pose) -> Pose:
        return Pose(self.rotation @ inner.rotation, self.rotation @ inner.position + self.position)

    def point(self, inner: Array) -> Array:
        """Return where a point of the inner frame is in the outer one."""
        return self.rotation @ inner + self.position


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg], centre of mass [m], and inertia about that centre, shape (3, 3) [kg m²]."""

    mass: float
    centre: Array
    inertia: Array

    def seen_from(self, pose: Pose) -> Inertial:
        """Return the same in the outer frame of a pose."""
        turned = pose.rotation @ self.inertia @ pose.rotation.T
        return Inertial(self.mass, pose.point(self.centre), turned)


def joined(parts: Iterable[Inertial]) -> Inertial:
    """Return bodies of one frame that are rigid with each other as one (parallel axes).

    Examples
    --------
    >>> point = np.zeros((3, 3))
    >>> both = joined([Inertial(1.0, np.zeros(3), point), Inertial(1.0, np.array([2.0, 0, 0]), point)])
    >>> both.mass, both.centre[0].item(), both.inertia[1, 1].item()
    (2.0, 1.0, 2.0)
    """
    kept = [part for part in parts if part.mass]
    mass = math.fsum(part.mass for part in kept)
    if not mass:
        return Inertial(0.0, np.zeros(3), np.zeros((3, 3)))
    centre = sum((part.mass * part.centre for part in kept), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in kept:
        arm = part.centre - centre
        inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertial(mass, centre, inertia)


def about(axis: Array, angle: float) -> Array:
    """Return the rotation about a unit axis, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def from_quaternion(w: float, x: float, y: float, z: float) -> Array:
    """Return the rotation of a quaternion, which need not be of unit size but not zero.

    Examples
    --------
    >>> from_quaternion(1.0, 0.0, 0.0, 0.0).diagonal()
    array([1., 1., 1.])
    """
    size = math.sqrt(x * x + y * y + z * z)
    return np.eye(3) if not size else about(np.array([x, y, z]) / size, 2 * math.atan2(size, w))


def from_euler(angles: Sequence[float] | Array, sequence: str) -> Array:
    """Return the rotation by three angles about the axes of `sequence`, lower case about turned axes."""
    turned = np.eye(3)
    for angle, letter in zip(angles, sequence, strict=True):
        step = about(np.eye(3)["xyz".index(letter.lower())], angle)
        turned = turned @ step if letter.islower() else step @ turned
    return turned


def from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Return the rotation by angles about fixed x, y and z, as URDF and SDFormat write it."""
    return from_euler([roll, pitch, yaw], "XYZ")


def from_z_to(direction: Array) -> Array:
    """Return the smallest rotation that takes z to a unit direction."""
    z = np.array([0.0, 0.0, 1.0])
    axis, cosine = np.cross(z, direction), float(direction[2])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-15:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return about(axis / sine, math.atan2(sine, cosine))


def solid(kind: str, size: Sequence[float], mass: float | None, density: float) -> Inertial:
    """Return a homogeneous body about its middle, axis along z; `mass` where given, else by density.

    Parameters
    ----------
    kind : str
        "sphere", "capsule", "cylinder", "box" or "ellipsoid".
    size : sequence of float [m]
        Radius; radius and half the straight length; three half lengths or half axes.
    mass : float or None [kg]
    density : float [kg/m³]

    Examples
    --------
    >>> solid("box", [0.5, 0.5, 0.5], None, 2.0).inertia[0, 0].round(6).item()       # m (1² + 1²)/12
    0.333333
    """
    volume, moments = _SOLIDS[kind](*size)
    own = density * volume if mass is None else mass
    return Inertial(own, np.zeros(3), own * np.diag(moments))


def ends_of(kind: str, size: Sequence[float]) -> list[Array]:
    """Return how far a solid reaches from its middle: the ends of its axis, without round caps, or its faces.

    Of a sphere, which is all cap, it is the middle itself: as a lumped mass it has no length.

    Examples
    --------
    >>> [point.tolist() for point in ends_of("capsule", [0.1, 2.0])]
    [[0.0, 0.0, 2.0], [0.0, 0.0, -2.0]]
    """
    if kind in ("capsule", "cylinder"):
        half = [0.0, 0.0, size[1]]
    elif kind == "sphere":
        return [np.zeros(3)]
    else:
        half = list(size[:3])
    return [sign * half[i] * np.eye(3)[i] + 0.0 for i in range(3) if half[i] for sign in (1.0, -1.0)]


def _sphere(r: float) -> tuple[float, list[float]]:
    return 4 / 3 * math.pi * r**3, [0.4 * r**2] * 3


def _ellipsoid(a: float, b: float, c: float) -> tuple[float, list[float]]:
    return 4 / 3 * math.pi * a * b * c, [(b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5]


def _box(a: float, b: float, c: float) -> tuple[float, list[float]]:
    return 8 * a * b * c, [(b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3]


def _cylinder(r: float, half: float) -> tuple[float, list[float]]:
    across = r * r / 4 + half * half / 3
    return 2 * math.pi * r * r * half, [across, across, r * r / 2]


def _capsule(r: float, half: float) -> tuple[float, list[float]]:
    (tube, moments), (ball, (own, *_)) = _cylinder(r, half), _sphere(r)
    volume = tube + ball
    # Two half balls, whose centres of mass lie 3r/8 beyond the ends of the tube.
    across = own + half * half + 0.75 * r * half
    shares = (tube / volume, ball / volume) if volume else (0.0, 0.0)
    both = zip(moments, (across, across, own), strict=True)
    return volume, [shares[0] * a + shares[1] * b for a, b in both]


_SOLIDS: dict[str, Callable[..., tuple[float, list[float]]]] = {
    "sphere": _sphere,
    "ellipsoid": _ellipsoid,
    "box": _box,
    "cylinder": _cylinder,
    "capsule": _capsule,
}
