"""Mode shapes of the uniform beam in doubles, as four waves told from both ends."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext
from typing import NamedTuple

import numpy as np

from beammodes.exact.uniform_beam import BeamMode, UnitBeam, UnitEnd, mixed
from beammodes.numerics.arrays import Floats

__all__ = ["BeamWaves", "first_separate_wave", "high_waves"]


# Below these p and q waves come near to being dependent, and half the beam takes a short power series: its
# terms grow to e^3.5 at most, and 40 of them reach a double's last place.
_LONG = (4.0, 7.0)
_TERMS = 40
# e^(-40) is a fortieth of a double's resolution of one.
_SEPARATE = 40.0
# Beyond these decades the products of an end's numbers could leave the range of doubles.
_DECADES = 60


class BeamWaves(NamedTuple):
    """Mode shapes on a beam of unit length; z is the distance from the end that is near.

    y = a cos qz + b sin qz + c e^(-pz) + d e^(-p(1-z)), d being the other end's c. Telling phases from
    the nearer end keeps every digit of the conditions at both.

    Parameters
    ----------
    p, q : ndarray, shape (modes,)
        The wavenumbers.
    left, right : ndarray, shape (modes, 3)
        a, b, c of each end.
    left_state, right_state : ndarray, shape (modes, 4)
        y and its first three derivatives by z at each end; read for long waves only.
    """

    p: Floats
    q: Floats
    left: Floats
    right: Floats
    left_state: Floats
    right_state: Floats

    @classmethod
    def of(cls, modes: list[BeamMode]) -> BeamWaves:
        """Return modes of a beam without shear in doubles."""
        return cls(*(np.array(column) for column in zip(*map(_rounded, modes), strict=True)))

    @classmethod
    def joined(cls, parts: list[BeamWaves]) -> BeamWaves:
        """Return the modes of all parts, one after the other."""
        return cls(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    def shapes(self, from_left: Floats, from_right: Floats, order: int) -> Floats:
        """Return the derivatives of one order by x, shape (modes, positions).

        Parameters
        ----------
        from_left, from_right : ndarray, shape (positions,)
            x and 1 - x.
        order : int
            0 to 3.
        """
        result = np.empty((len(self.p), len(from_left)))
        on_left = from_left <= from_right
        if on_left.any():
            result[:, on_left] = self._near(self.left, self.right, self.left_state, from_left[on_left], order)
        if not on_left.all():
            z = from_right[~on_left]
            mirrored = self._near(self.right, self.left, self.right_state, z, order)
            result[:, ~on_left] = -mirrored if order % 2 else mirrored
        return result

    def _near(self, near: Floats, far: Floats, state: Floats, z: Floats, order: int) -> Floats:
        """Return the derivatives by z at distances up to 1/2 from one end."""
        p, q = self.p[:, None], self.q[:, None]
        long = (self.p < _LONG[0]) & (self.q < _LONG[1])
        result = np.empty((len(p), len(z)))
        if long.any():
            result[long] = _series(p[long], q[long], state[long], z, order)
        if not long.all():
            result[~long] = _waves(p[~long], q[~long], near[~long], far[~long, 2:], z, order)
        return result


def _rounded(mode: BeamMode) -> tuple[float | list[float], ...]:
    """Return the numbers of `BeamWaves` of one mode."""
    beam, square = mode.beam, mode.square
    with localcontext() as context:
        context.prec = beam.digits(square)
        _, _, p, q, *_ = beam.exponents(square)
        tension = beam.tension - beam.gyration * square
        # The low waves are cos qx and -q sin qx, and these are in terms of the distance from the right end:
        a, b, c, d = mode.share[2], -q * mode.share[3], *mode.share[:2]
        cosine, sine = mode.ends[1][2].deflection, -mode.ends[1][3].deflection / q
        rows = [[a, b, c], [a * cosine + b * sine, a * sine - b * cosine, d]]
        for waves, side in zip(mode.ends, (1, -1), strict=True):
            y, slope, moment, force = mixed(mode.share, waves)
            rows.append([y, side * slope, moment, side * (tension * slope - force)])
    return float(p), float(q), *([float(number) for number in row] for row in rows)


def _waves(p: Floats, q: Floats, near: Floats, across: Floats, z: Floats, order: int) -> Floats:
    a, b, c = near.T[:, :, None]
    for _ in range(order):
        a, b = b, -a
    waves: Floats = q**order * (a * np.cos(q * z) + b * np.sin(q * z))
    waves += (-p) ** order * c * np.exp(-p * z) + p**order * across * np.exp(p * z - p)
    return waves


def _series(p: Floats, q: Floats, state: Floats, z: Floats, order: int) -> Floats:
    """Return Taylor's series about the near end: each derivative follows from those two and four before."""
    derivatives = list(state.T[:, :, None])
    for n in range(_TERMS):
        derivatives.append((p - q) * (p + q) * derivatives[n + 2] + (p * q) ** 2 * derivatives[n])
    total: Floats = np.zeros((len(p), len(z)))
    for n in range(_TERMS, order - 1, -1):
        total = derivatives[n] + total * z / (n - order + 1)
    return total


class Reflection(NamedTuple):
    """The waves of a high mode at an end, at unit amplitude of the running ones; deflection and rotation.

    Once e^(-p) is below a double's resolution no end feels the other's fading wave, and each end alone fixes
    the a, b, c next to it.
    """

    waves: tuple[Floats, Floats, Floats]
    deflection: Floats
    rotation: Floats


def first_separate_wave(beam: UnitBeam) -> Decimal:
    """Return the trigonometric wavenumber from which neither end feels the other; infinite if there is none.

    None is where rotary inertia keeps p below 1/r, so that both ends stay in touch at all frequencies.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.ends import Boundary
    >>> float(first_separate_wave(UnitBeam.of(Beam.unit(), Boundary.of("pinned-free"))))
    40.0
    """
    tension, gyration = float(beam.tension), float(beam.gyration)
    if beam.spread > _DECADES or 2.0 * gyration * _SEPARATE**2 > 1.0:
        return Decimal("Infinity")
    wave = math.sqrt(max(0.0, _SEPARATE**2 - tension) / (1.0 - gyration * _SEPARATE**2))
    return Decimal(max(_SEPARATE, wave))


def high_waves(beam: UnitBeam, omega: Floats) -> BeamWaves:
    """Return the shapes of unit modal mass of the modes at ω, all above q = `first_separate_wave`."""
    pull = float(beam.tension) - float(beam.gyration) * omega**2
    middle = np.hypot(0.5 * pull, omega)
    large = np.sqrt(middle + 0.5 * np.abs(pull))
    p, q = np.where(pull > 0.0, large, omega / large), np.where(pull > 0.0, omega / large, large)
    left, right = _reflection(beam.left, p, q), _reflection(beam.right, p, q)
    (a, b, _), (a_right, b_right, _) = left.waves, right.waves
    cosine, sine = np.cos(q), np.sin(q)
    alike = (a * cosine + b * sine) * a_right + (a * sine - b * cosine) * b_right
    near, far = np.array(left.waves), np.where(alike < 0.0, -1.0, 1.0) * np.array(right.waves)
    mass = _mass(p, q, float(beam.gyration), near, far)
    for end, turned in ((beam.left, left), (beam.right, right)):
        body, inertia, offset = float(end.mass), float(end.inertia), float(end.offset)
        mass += body * (turned.deflection - offset * turned.rotation) ** 2 + inertia * turned.rotation**2
    unset = np.zeros((len(q), 4))  # Long waves only.
    unit = np.copysign(np.sqrt(mass), _first_motion(beam.left, left))
    return BeamWaves(p, q, (near / unit).T, (far / unit).T, unset, unset)


def _first_motion(end: UnitEnd, turned: Reflection) -> Floats:
    """Return the first that an end leaves free of deflection, rotation and curvature, but for a factor."""
    if not end.holds[0]:
        return turned.deflection
    return -turned.waves[0] if end.holds[1] else turned.rotation


def _reflection(end: UnitEnd, p: Floats, q: Floats) -> Reflection:
    """Solve an end's two conditions on u = a cos qz + b sin qz + c e^(-pz), up to a factor.

    With Z the end's impedance plus the stiffness of a beam whose waves have no cosine, the conditions are
    Z (y, θ) = -a (p² + q²) (p, 1): with a = det Z nothing is divided.
    """
    a, deflection, rotation = _released(end, p, q, p * p + q * q)
    b = (rotation + p * (deflection - a)) / q
    size = np.hypot(a, b)
    waves = (a / size, b / size, (deflection - a) / size)
    return Reflection(waves, deflection / size, rotation / size)


def _released(end: UnitEnd, p: Floats, q: Floats, scale: Floats) -> tuple[Floats, Floats, Floats]:
    """Return det Z, y and θ, over what is not held."""
    # A hub's axis lies off no end here: all its modes are found as low ones are.
    _, kt, kr, mass, inertia, offset, _ = end
    square, none = (p * q) ** 2, np.zeros_like(q)
    spring, turn = float(kt) - square * float(mass), float(kr) - square * float(inertia)
    coupled = square * float(mass) * float(offset)
    yy, yt, tt = spring - p * scale, coupled - p * p, turn - coupled * float(offset)
    if all(end.holds):
        return none + 1.0, none, none
    if end.holds[0]:
        return tt, none, -scale
    if end.holds[1]:
        return yy, -scale * p, none
    # The products of coupled terms cancel by hand: a small J beside m a² would drown in them.
    determinant = spring * turn - float(kt) * coupled * float(offset)
    determinant += p * p * (2.0 * coupled - p * p) - p * scale * tt
    return determinant, -scale * (p * tt - yt), -scale * (yy - p * yt)


def _mass(p: Floats, q: Floats, gyration: float, near: Floats, far: Floats) -> Floats:
    """Return ∫ y² + r² y'² dx of waves whose exponentials do not reach the other end.

    With u = a cos + b sin and v the exponentials: ∫ u² = (a² + b²)/2 - [u u']/(2q²), ∫ v² = [v v']/(2p²),
    ∫ u v = [u v' - u' v]/(p² + q²), by parts from u'' = -q² u and v'' = p² v.
    """
    (a, b, c), (a1, b1, d) = near, far
    of_u, of_v, circle = -q * (a1 * b1 + a * b), p * (c * c + d * d), 0.5 * (a * a + b * b)
    u_dv = p * (a1 * d + a * c)
    product = (u_dv + q * (b1 * d + b * c)) / (p * p + q * q)
    deflection = circle - of_u / (2.0 * q * q) + of_v / (2.0 * p * p) + 2.0 * product
    slopes = q * q * circle + 0.5 * (of_u + of_v) + 2.0 * (u_dv - p * p * product)
    return np.asarray(deflection + gyration * slopes)
