"""Exact twist and stretch of a uniform beam: standing waves between two ends, every root counted.

Between the ends u = cos(βx/L - φ), and an end with spring K [k/L] and inertia J [m L] holds

    tan φ = K/β - J β,        φ = π/2 at a fixed end, 0 at a free one,

with the same at the right end, seen from there. So the n-th mode is the one root of

    β - φ_left(β) - φ_right(β) = (n - 1 + r) π,        r the rigid-body modes, 0 or 1,

whose left side rises with β at a slope of at least 1: none is missed, none found twice. ω = (β/L) √(k/m).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import Shown, row_shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.numerics.roots import increasing_root
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.beam import Beam, positions_on
from beammodes.problem.motions import MOTIONS, Motion

__all__ = ["AxialModes", "axial_wavenumber", "uniform_axial_modes", "uniform_numbers"]


@dataclass(frozen=True, eq=False)
class _End:
    """Waves' ends of many beams: (X, Y) ~ (cos φ, sin φ) = (a β, K - J β²), scaled to stay in range."""

    free: Floats
    spring: Floats
    body: Floats

    @classmethod
    def of(cls, spring: Floats, body: Floats) -> _End:
        held = np.isinf(spring)
        size = 1.0 + np.where(held, 0.0, spring) + body
        return cls(
            np.where(held, 0.0, 1.0 / size),
            np.where(held, 1.0, np.where(held, 0.0, spring) / size),
            np.where(held, 0.0, body / size),
        )

    def at(self, beta: Floats) -> tuple[Floats, Floats]:
        return self.free * beta, self.spring - self.body * beta * beta


def axial_wavenumber(pairs: list[AxialBoundary], which: NDArray[np.intp], mode: ArrayLike) -> Floats:
    """Return β of many cases: each an index into `pairs`, in multiples of k/L and m L, and a mode.

    Right to about two units in the last place, for any mode.

    Examples
    --------
    >>> pairs = [AxialBoundary.of(name) for name in ("fixed-free", "free-free(inertia=1)")]
    >>> axial_wavenumber(pairs, np.array([0, 1]), [1, 1]).round(9)                    # π/2; tan β = -β
    array([1.57079633, 2.02875784])
    """
    numbers = np.array(
        [[p.left.stiffness, p.left.inertia, p.right.stiffness, p.right.inertia] for p in pairs]
    )
    rigid = np.array([p.rigid_body_modes for p in pairs])
    which, number = np.broadcast_arrays(which, np.asarray(mode, dtype=np.int64))
    flat, count = which.ravel(), number.ravel() - 1 + rigid[which.ravel()]
    ends = [_End.of(*numbers[flat][:, 2 * side : 2 * side + 2].T) for side in (0, 1)]
    half_turns = count * math.pi
    # φ of a fixed end is π/2 and of a free one 0 at every β: then nothing is left to solve.
    plain = ~np.isfinite(numbers) | (numbers == 0.0)
    known = (plain[:, [0, 2]] & (np.isinf(numbers[:, [0, 2]]) | plain[:, [1, 3]])).all(axis=1)[flat]
    beta = half_turns + np.isinf(numbers[:, [0, 2]]).sum(axis=1)[flat] * (math.pi / 2)
    if not known.all():
        rest = ~known
        some = [_End(end.free[rest], end.spring[rest], end.body[rest]) for end in ends]
        beta[rest] = _roots(some, half_turns[rest], count[rest])
    return np.asarray(beta).reshape(which.shape)


def _roots(ends: list[_End], half_turns: Floats, count: NDArray[np.int64]) -> Floats:
    def excess(beta: Floats) -> Floats:
        total = beta - half_turns
        for end in ends:
            x, y = end.at(beta)
            total = total - np.arctan2(y, x)
        return np.asarray(total)

    low = np.maximum(half_turns - math.pi, 0.0)
    high = half_turns + math.pi
    start = np.maximum(0.5 * (low + high), 0.1)
    # About the root of the beam as one spring between its ends' bodies: heavy ones bring it near zero.
    (k, j), (k_right, j_right) = (np.array([e.spring, e.body]) / np.maximum(e.free, 1e-300) for e in ends)
    held = np.where(count == 0, np.minimum(k, 1.0) + np.minimum(k_right, 1.0), 1.0)
    rough = np.sqrt(held / (1.0 + j + j_right))
    if np.any(rough < 1e-15):
        raise ArithmeticError(
            "boundary must have springs and bodies within 30 decades of the beam's stiffness and inertia: "
            f"its first root, near {rough.min():.3g}, is too close to zero"
        )
    beta = increasing_root(excess, start, low, high, 1e-9 * np.minimum(high, rough))
    sign = 1.0 - 2.0 * (count % 2)
    for _ in range(4):
        # Newton's steps on the sine of the same angle, in which nothing cancels where φ nears ±π/2.
        (a, b), (c, d) = (end.at(beta) for end in ends)
        real, imaginary = a * c - b * d, a * d + b * c
        sine, cosine = np.sin(beta), np.cos(beta)
        angle = np.arctan2(
            sign * (sine * real - cosine * imaginary), sign * (cosine * real + sine * imaginary)
        )
        slope = np.ones_like(beta)
        for end, (x, y) in zip(ends, ((a, b), (c, d)), strict=True):
            slope = slope + end.free * (end.spring + end.body * beta * beta) / (x * x + y * y)
        beta = beta - angle / slope
    return beta


def uniform_numbers(beam: Beam, motion: Motion) -> tuple[float, float]:
    """Return a uniform beam's stiffness and inertia per length in a motion.

    Raises
    ------
    TypeError, ValueError
        As `Motion.numbers`, or if one of them varies along the beam.
    """
    stiffness, inertia = motion.numbers(beam)
    if not isinstance(stiffness, float) or not isinstance(inertia, float):
        raise ValueError(
            f"beam must have the same {motion.stiffness} and {motion.inertia} all along here, got {beam!r}"
        )
    return stiffness, inertia


@dataclass(frozen=True, eq=False, repr=False)
class AxialModes(Shown):
    """Exact elastic modes of a uniform beam in twist or stretch, of unit modal mass.

    Attributes
    ----------
    beam : Beam
    boundary : AxialBoundary
    wavenumber : ndarray, shape (modes,) [-]
        β.
    angular_frequency : ndarray, shape (modes,) [rad/s]
    """

    beam: Beam
    boundary: AxialBoundary
    wavenumber: Floats
    angular_frequency: Floats

    @property
    def frequency(self) -> Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats:
        """Return the mode shapes u, angle or shift, or a derivative of them, at positions from 0 to L.

        The first of u and du/dx that the left end does not hold is positive there.

        Raises
        ------
        TypeError, ValueError
            If `x` is not finite real numbers in [0, L], or `derivative` not a whole number from 0 to 3.

        Examples
        --------
        >>> import beammodes as bm
        >>> shaft = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
        >>> bm.axial_modes(shaft, "fixed-free", 2).shape([0.0, 1.0]).round(9).tolist()         # √2 sin βx
        [[0.0, 1.414213562], [0.0, -1.414213562]]
        """
        order = whole_number("derivative", derivative, least=0, most=3)
        position, beta = positions_on(self.beam, x), self.wavenumber[:, None]
        amplitude, phase = self._waves()
        along = position.ravel()[None, :] / self.beam.length * beta - phase[:, None] + order * (math.pi / 2)
        values = amplitude[:, None] * np.cos(along) * (beta / self.beam.length) ** order
        if self.boundary.left.is_fixed and order % 2 == 0:
            # cos(-π/2) is rounding, and such an end does not move.
            values[:, position.ravel() == 0.0] = 0.0
        return values.reshape(len(beta), *position.shape)

    def slope(self, x: ArrayLike) -> Floats:
        """Return du/dx: `shape(x, derivative=1)`."""
        return self.shape(x, derivative=1)

    def _waves(self) -> tuple[Floats, Floats]:
        """Return amplitude and phase of u = A cos(βx/L - φ)."""
        pair, beta = _in_multiples(self.beam, self.boundary), self.wavenumber
        left = _End.of(np.array(pair.left.stiffness), np.array(pair.left.inertia))
        phase = np.arctan2(*left.at(beta)[::-1])
        # ∫cos²(βx - φ) dx over the beam, and the bodies at its ends.
        square = 0.5 + (np.sin(2.0 * (beta - phase)) + np.sin(2.0 * phase)) / (4.0 * beta)
        for end, angle in ((pair.left, phase), (pair.right, beta - phase)):
            square = square + end.inertia * np.cos(angle) ** 2
        _, inertia = uniform_numbers(self.beam, MOTIONS[self.boundary.motion])
        return 1.0 / np.sqrt(square * inertia * self.beam.length), phase

    def _line(self) -> str:
        told = row_shown(self.frequency, "{:.4g}", "Hz")
        return f"AxialModes({self.boundary.name} in {self.boundary.motion}: {told})"


def _in_multiples(beam: Beam, boundary: AxialBoundary) -> AxialBoundary:
    """Return the boundary in multiples of k/L and m L."""
    stiffness, inertia = uniform_numbers(beam, MOTIONS[boundary.motion])
    return boundary.scaled(stiffness / beam.length, inertia * beam.length)


def uniform_axial_modes(beam: Beam, boundary: AxialBoundary, modes: int) -> AxialModes:
    """Return the exact first elastic modes of a uniform beam; `axial_modes` is the door to it.

    Examples
    --------
    >>> shaft = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    >>> uniform_axial_modes(shaft, AxialBoundary.of("free-free"), 2).wavenumber / math.pi
    array([1., 2.])
    """
    beta = axial_wavenumber([_in_multiples(beam, boundary)], np.asarray(0), np.arange(1, modes + 1))
    return AxialModes(beam, boundary, beta, beta * MOTIONS[boundary.motion].frequency_unit(beam))
