"""Conditions on a chain's springs, and the derivatives of what they do to frequencies and statics.

The unknowns are x_j = ln(k_j ell/EI), so every answer is a positive spring. With u_n the unit vector in which
mode n stores its energy (its square at joint j is that joint's share), the frequencies' derivatives are

    ∂ ln ω_n² / ∂x_j       = u_nj²
    ∂² ln ω_n² / ∂x_i ∂x_j = δ_ij u_nj² - u_ni² u_nj² + 2 Σ_{m≠n} ω_m²/(ω_n² - ω_m²) u_ni u_mi u_nj u_mj

and, with p the tip's deflection written in those vectors, w = p/|p| and P = Σ u_m u_mᵀ, the compliance's

    ∂ ln |p|² / ∂x_j       = -w_j²
    ∂² ln |p|² / ∂x_i ∂x_j = 2 w_i w_j P_ij - δ_ij w_j² - w_i² w_j²

Source: first and second-order perturbation of K u = ω² M u, derived here; the sums run over elastic modes,
because a rigid-body mode stores nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.vibration.spectrum import FlexibilityForm

__all__ = ["Conditions", "State", "spring_state", "symmetric_basis"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class State:
    """What a chain with given springs does, in its own units.

    Attributes
    ----------
    log_square : ndarray, shape (modes,)
        ln ω², ascending.
    energy : ndarray, shape (modes, hinges)
        Unit rows; squared, each joint's share of a mode's strain energy.
    tip : ndarray, shape (hinges,)
        Its square is each joint's part in the deflection of the right tip under a unit force there;
        meaningless where a rigid-body mode lets the tip go.
    """

    log_square: Array
    energy: Array
    tip: Array


def spring_state(unit: FlexibilityForm, log_stiffness: Array) -> State:
    """Return the state of the chain that has the springs e^x where `unit` has springs 1.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.vibration.spectrum import flexibility_form
    >>> unit = flexibility_form(Chain(Beam.unit(), "clamped-free", 1, "naive"))
    >>> spring_state(unit, np.zeros(1)).log_square.round(9) == np.log(3).round(9)      # k / (m ell²/3)
    array([ True])
    """
    root = np.exp(-log_stiffness / 2)
    hinges, excluded = unit.forbidden.shape
    basis = np.linalg.qr(root[:, None] * unit.forbidden, mode="complete")[0] if excluded else np.eye(hinges)
    form = replace(unit, flexibility_root=root, forbidden=basis[:, :excluded])
    allowed = basis[:, excluded:]
    _, inverse, turn = np.linalg.svd(form.kinetic(allowed), full_matrices=False)
    energy = turn @ allowed.T
    reach = form.motion(energy.T)[0][-1]
    return State(-2 * np.log(inverse), energy, reach @ energy)


def symmetric_basis(hinges: int, symmetric: bool) -> Array:
    """Return orthonormal columns that span all springs, or those that a mirror leaves alone.

    Examples
    --------
    >>> symmetric_basis(3, True).round(3)
    array([[0.707, 0.   ],
           [0.   , 1.   ],
           [0.707, 0.   ]])
    """
    if not symmetric:
        return np.eye(hinges)
    columns = np.eye(hinges)[:, : (hinges + 1) // 2]
    columns = columns + columns[::-1]
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


@dataclass(frozen=True, eq=False)
class Conditions:
    """Equations on the springs' logarithms  x = basis z.

    Attributes
    ----------
    unit : FlexibilityForm
        Of the chain with all springs 1, in its own units.
    basis : ndarray, shape (hinges, unknowns)
        Orthonormal, so that distances between springs are those between their z.
    modes : tuple of int
        Indices of the modes whose frequencies are prescribed.
    log_square : ndarray, shape (len(modes),)
        What ln ω² shall be.
    log_compliance : float, optional
        What the logarithm of the tip's deflection under a unit force shall be.
    ceiling : float
        What ln ω² of the highest mode shall not exceed.
    """

    unit: FlexibilityForm
    basis: Array
    modes: tuple[int, ...]
    log_square: Array
    log_compliance: float | None = None
    ceiling: float = np.inf

    def at(self, z: Array) -> tuple[State, Array, Array]:
        """Return the state, the residuals, all logarithms, and their derivatives by z."""
        state = spring_state(self.unit, self.basis @ z)
        rows = list(self.modes)
        residual, slope = state.log_square[rows] - self.log_square, state.energy[rows] ** 2
        if self.log_compliance is not None:
            compliance = state.tip @ state.tip
            residual = np.append(residual, np.log(compliance) - self.log_compliance)
            slope = np.vstack([slope, -(state.tip**2) / compliance])
        return state, residual, slope @ self.basis

    def curvature(self, state: State, weights: NDArray[np.floating[Any]]) -> Array:
        """Return the weighted sum of the residuals' second derivatives by z, at least one weight per mode."""
        total = np.zeros((len(self.basis),) * 2)
        for mode, weight in zip(self.modes, weights, strict=False):
            total += weight * _mode_curvature(state, mode)
        if self.log_compliance is not None:
            total += weights[-1] * _tip_curvature(state)
        return np.asarray(self.basis.T @ total @ self.basis)

    def met(self, state: State, residual: Array) -> bool:
        """Say whether the ceiling and, to 1e-12 or what rounding leaves of ω_n/ω_1, all equations hold."""
        allowed = np.full(len(residual), 1e-12)
        spread = np.exp((state.log_square[list(self.modes)] - state.log_square[0]) / 2)
        allowed[: len(spread)] = np.maximum(1e-12, 4 * np.finfo(float).eps * spread)
        return bool((np.abs(residual) <= allowed).all() and state.log_square[-1] <= self.ceiling + 1e-12)


def _mode_curvature(state: State, mode: int) -> Array:
    others = np.arange(len(state.energy)) != mode
    products = state.energy[others] * state.energy[mode]
    ratio = 2 / np.expm1(state.log_square[mode] - state.log_square[others])
    share = state.energy[mode] ** 2
    return np.asarray(np.diag(share) - np.outer(share, share) + (products.T * ratio) @ products)


def _tip_curvature(state: State) -> Array:
    unit = state.tip / np.linalg.norm(state.tip)
    share, projector = unit**2, state.energy.T @ state.energy
    return np.asarray(2 * np.outer(unit, unit) * projector - np.diag(share) - np.outer(share, share))
