"""Mode shapes of the uniform beam as four waves, told from both ends, and their modal mass."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["BeamWaves", "beam_mass"]

Floats = NDArray[np.float64]

# Below these p and q waves come near to being dependent, and half the beam takes a short power series: its
# terms grow to e^3.5 at most, and 40 of them reach a double's last place.
_LONG = (4.0, 7.0)
_TERMS = 40


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
        result[:, on_left] = self._near(self.left, self.right, self.left_state, from_left[on_left], order)
        mirrored = self._near(self.right, self.left, self.right_state, from_right[~on_left], order)
        result[:, ~on_left] = -mirrored if order % 2 else mirrored
        return result

    def _near(self, near: Floats, far: Floats, state: Floats, z: Floats, order: int) -> Floats:
        """Return the derivatives by z at distances up to 1/2 from one end."""
        p, q = self.p[:, None], self.q[:, None]
        long = (self.p < _LONG[0]) & (self.q < _LONG[1])
        result = np.empty((len(p), len(z)))
        result[long] = _series(p[long], q[long], state[long], z, order)
        result[~long] = _waves(p[~long], q[~long], near[~long], far[~long, 2:], z, order)
        return result


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


def beam_mass(p: Any, q: Any, gyration: Any, near: Any, far: Any, across: Any) -> Any:
    """Return ∫ y² + r² y'² dx of four waves, for decimals or arrays.

    With u = a cos + b sin and v the exponentials: ∫ u² = (a² + b²)/2 - [u u']/(2q²), ∫ v² = [v v']/(2p²)
    + 2 c d e^(-p), ∫ u v = [u v' - u' v]/(p² + q²), by parts from u'' = -q² u and v'' = p² v.

    Parameters
    ----------
    p, q, gyration : Decimal or array
        The wavenumbers and r².
    near, far : sequence of three
        a, b, c from the left end, and from the right.
    across : Decimal or array
        e^(-p), or zero where it does not matter.

    Examples
    --------
    >>> round(beam_mass(np.pi, np.pi, 0.0, (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 0.0), 12)
    0.5
    """
    (a, b, c), (a1, b1, d) = near, far
    v, v1 = c + d * across, d + c * across
    dv, dv1 = p * (d * across - c), p * (d - c * across)
    of_u, of_v = -q * (a1 * b1 + a * b), v1 * dv1 - v * dv
    u_dv, du_v = a1 * dv1 - a * dv, -q * (b1 * v1 + b * v)
    circle, standing = (a * a + b * b) / 2, 2 * c * d * across
    product = (u_dv - du_v) / (p * p + q * q)
    deflection = circle - of_u / (2 * q * q) + of_v / (2 * p * p) + standing + 2 * product
    slopes = q * q * circle + of_u / 2 + of_v / 2 - p * p * standing + 2 * (u_dv - p * p * product)
    return deflection + gyration * slopes
