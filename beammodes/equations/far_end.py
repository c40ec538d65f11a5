"""What holds and resists a rod's end at s = L: forces on its tip, moments, and how these change as it turns.

Springs of deflections pull the tip back to where it rests, those of rotations store ½ Σ K_i θ_i², θ being the
vector of the end's rotation from its axes at rest. Turned further by δ in those axes it changes by

    θ' = J⁻¹ δ,      J⁻¹ = 1 - ½ θ× + c (θ×)²,      c = (1 - ½ θ cot ½ θ)/θ²,

so what acts on θ, springs f = -K θ and what holds some of its components, is the moment J⁻ᵀ f. Where the
tangent alone is held, the end may turn about it more than once, and its spring resists the whole of that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.numerics.arrays import Floats
from beammodes.numerics.rotations import cross_matrix, rotation_vector
from beammodes.problem.rod_ends import RodEnd

__all__ = ["FarEnd", "Resisted"]

#: Of 1 - ½ θ cot ½ θ over θ²: |B_2n|/(2n)! of Bernoulli's numbers.
_SERIES = (1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160, 691 / 1307674368000, 1 / 74724249600)


@dataclass(frozen=True)
class Resisted:
    """What acts on the end in a shape, in the axes of space.

    Attributes
    ----------
    force, moment : ndarray, shape (3,)
        On the tip, of springs and of what holds it; couples on the tangent left out.
    couple : ndarray, shape (3,)
        A force on the tip of the unit tangent, and as much back on its foot.
    stiffening, turning : ndarray, shape (3, 3)
        How the force falls as the tip moves, and the moment as the end turns.
    missed : ndarray, shape (held,)
        By how much the end misses what it is held at.
    on_tip, on_turn : ndarray, shape (held, 3)
        How that changes as the tip moves, and as the end turns.
    """

    force: Floats
    moment: Floats
    couple: Floats
    stiffening: Floats
    turning: Floats
    missed: Floats
    on_tip: Floats
    on_turn: Floats


class FarEnd:
    """The supports at s = L of a chain in space.

    Parameters
    ----------
    end : RodEnd
    frame : ndarray, shape (3, 3)
        The section's axes there at rest, as columns.
    place : ndarray, shape (3,)
        Where it rests, or is held.
    axes : ndarray, shape (3, 3)
        The axes of its supports, as columns; those of the section at rest, or what it is turned to.
    """

    def __init__(self, end: RodEnd, frame: Floats, place: Floats, axes: Floats) -> None:
        self._frame, self._place, self._axes = frame, place, axes
        held = np.isinf(end.stiffness)
        springs = np.where(held, 0.0, end.stiffness)
        self._pull, self._turn = springs[:3], springs[3:]
        self._along = axes[:, np.flatnonzero(held[:3])]
        turned = held[3:].tolist()
        self._tangent = turned == [False, True, True]
        if self._tangent:
            self._kept = np.zeros((3, 0))
        elif all(turned):
            # In the axes of space, as its moment is told.
            self._kept = axes.T
        else:
            self._kept = np.eye(3)[:, np.flatnonzero(held[3:])]
        self.deflections = self._along.shape[1]
        self.held = self.deflections + self._kept.shape[1] + 2 * self._tangent

    def resisted(self, tip: Floats, last: Floats, turns: float, push: Floats) -> Resisted:
        """Return what acts on the end where its tip and last piece's rotation are these.

        Parameters
        ----------
        tip, last : ndarray, shape (3,), (3, 3)
        turns : float [rad]
            About how far the end has turned about its tangent, more than once round or not.
        push : ndarray, shape (held,)
            What holds it.
        """
        axes, whole = self._axes, last @ self._frame
        count = self.deflections
        springs = axes @ (self._pull * (axes.T @ (tip - self._place)))
        force = self._along @ push[:count] - springs
        missed, on_tip, on_turn = (
            [self._along.T @ (tip - self._place)],
            [self._along.T],
            [np.zeros((count, 3))],
        )
        couple = np.zeros(3)
        if self._tangent:
            tangent, across = whole[:, 0], axes[:, 1:]
            couple = across @ push[count:]
            missed.append(across.T @ tangent)
            on_tip.append(np.zeros((2, 3)))
            on_turn.append(-across.T @ cross_matrix(tangent))
            moment, turning = self._about_tangent(axes.T @ whole, tangent, turns)
        else:
            vector = rotation_vector(axes.T @ whole)
            inverse = _inverse(vector)
            held = self._kept @ push[count:]
            acting = held - self._turn * vector
            moment = axes @ (inverse.T @ acting)
            turning = axes @ (inverse.T @ np.diag(self._turn) - _slope(vector, acting)) @ inverse @ axes.T
            missed.append(self._kept.T @ vector)
            on_tip.append(np.zeros((self._kept.shape[1], 3)))
            on_turn.append(self._kept.T @ inverse @ axes.T)
        return Resisted(
            force,
            moment,
            couple,
            axes @ np.diag(self._pull) @ axes.T,
            turning,
            np.concatenate(missed),
            np.concatenate(on_tip),
            np.concatenate(on_turn),
        )

    def _about_tangent(self, turned: Floats, tangent: Floats, turns: float) -> tuple[Floats, Floats]:
        angle = math.atan2(turned[2, 1] - turned[1, 2], turned[1, 1] + turned[2, 2])
        angle += 2.0 * math.pi * round((turns - angle) / (2.0 * math.pi))
        spring = float(self._turn[0])
        turning = spring * (np.outer(tangent, tangent) - angle * cross_matrix(tangent))
        return -spring * angle * tangent, turning


def _inverse(vector: Floats) -> Floats:
    """Return J⁻¹: how a rotation's vector changes as it is turned further.

    Examples
    --------
    >>> _inverse(np.array([0.0, 0.0, np.pi])).round(6).tolist()
    [[0.0, 1.570796, 0.0], [-1.570796, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    cross, (c, _) = cross_matrix(vector), _coefficients(float(vector @ vector))
    inverse: Floats = np.eye(3) - 0.5 * cross + c * (cross @ cross)
    return inverse


def _slope(vector: Floats, acting: Floats) -> Floats:
    """Return how J⁻ᵀ f changes with the vector, f staying."""
    c, rate = _coefficients(float(vector @ vector))
    twice = np.cross(vector, np.cross(vector, acting))
    grown = (vector @ acting) * np.eye(3) + np.outer(vector, acting) - 2.0 * np.outer(acting, vector)
    slope: Floats = -0.5 * cross_matrix(acting) + c * grown + 2.0 * rate * np.outer(twice, vector)
    return slope


def _coefficients(square: float) -> tuple[float, float]:
    """Return c, and its derivative by θ², at θ²."""
    if square < 0.25:
        powers = square ** np.arange(len(_SERIES))
        rates = np.arange(1, len(_SERIES)) * powers[:-1]
        return float(powers @ _SERIES), float(rates @ _SERIES[1:])
    angle = math.sqrt(square)
    sine = math.sin(0.5 * angle)
    cotangent = math.cos(0.5 * angle) / sine
    c = (1.0 - 0.5 * angle * cotangent) / square
    rate = (-0.25 * cotangent / angle + 0.125 / sine**2 - c) / square
    return c, rate
