"""Natural modes of a linear chain, with every digit of the lowest frequencies kept."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import shown, whole_number
from beammodes.linear import LinearModel
from beammodes.spectrum import FlexibilityForm, flexibility_form

__all__ = ["MAX_DENSE", "Modes", "solve_modes"]

Array = NDArray[np.float64]

#: Chains of at most this many hinges are solved by a dense singular value decomposition, which gives all
#: modes at once; longer ones by Lanczos iteration, which gives the lowest.
MAX_DENSE = 500


@dataclass(frozen=True)
class Modes:
    """Elastic modes of a chain, ascending, normalized to unit modal mass.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
    rigid_body_modes : int
        How many motions store nothing; they are counted here and are no rows of the arrays.
    position : ndarray, shape (nodes,) [m]
        Of the nodes on the straight chain: left tip, hinges, right tip.
    deflection : ndarray, shape (modes, nodes) [kg^-½]
        Mode shapes; the largest entry of each is positive.
    rotation : ndarray, shape (modes, pieces) [kg^-½/m]
        Angle of each piece in each mode.
    """

    angular_frequency: Array
    rigid_body_modes: int
    position: Array
    deflection: Array
    rotation: Array

    @property
    def frequency(self) -> Array:
        """Natural frequencies, shape (modes,) [Hz]."""
        return self.angular_frequency / (2 * np.pi)


def solve_modes(model: LinearModel, modes: int | None = None) -> Modes:
    """Return the lowest elastic modes of a linear chain.

        K u = ω² M u,   uᵀ M u = 1

    Relative accuracy of ω is 1e-12 or better for the lowest ten modes of any chain up to 10⁶ hinges, and
    about 1e-13 for every mode of a short one. Tested against 50-digit arithmetic.

    Parameters
    ----------
    model : LinearModel
        From `linearize`.
    modes : int, optional
        How many, from the first; all of them by default. A chain with fewer gives those it has.

    Raises
    ------
    TypeError, ValueError
        If `modes` is no whole number of at least 1, or a chain of more than 500 hinges is asked for more
        than a tenth of its modes.

    Examples
    --------
    >>> from beammodes.beam import Beam
    >>> from beammodes.chain import Chain
    >>> from beammodes.linear import linearize
    >>> solve_modes(linearize(Chain(Beam.unit(), "clamped-free", segments=6)), modes=2).angular_frequency
    array([ 3.50364768, 21.28034888])
    """
    if not isinstance(model, LinearModel):
        raise TypeError(f"model must be a LinearModel from linearize(), got {shown(model)}")
    chain = model.chain
    count = chain.elastic_modes if modes is None else whole_number("modes", modes)
    count = min(count, chain.elastic_modes)
    form = flexibility_form(chain)
    if count == 0:
        inverse, x = np.zeros(0), np.zeros((len(form.flexibility_root), 0))
    elif len(form.flexibility_root) <= MAX_DENSE:
        inverse, x = _dense(form, count)
    else:
        inverse, x = _lanczos(form, count)
    deflection, angle = form.motion(x)
    # Unit modal mass: the image of a unit singular vector has length 1/ω.
    shape, slope = deflection / inverse, angle / inverse
    if chain.boundary != chain.boundary.canonical:
        shape, slope = shape[::-1], -slope[::-1]
    return _in_physical_units(model, 1 / inverse, shape, slope)


def _dense(form: FlexibilityForm, count: int) -> tuple[Array, Array]:
    """Return 1/ω and unit x of the lowest modes, by singular values of the assembled F D^{-½}."""
    hinges, excluded = form.forbidden.shape
    # The full QR's trailing columns span what the end conditions allow.
    allowed = np.linalg.qr(form.forbidden, mode="complete")[0][:, excluded:] if excluded else np.eye(hinges)
    _, inverse, turn = np.linalg.svd(form.kinetic(allowed), full_matrices=False)
    return inverse[:count], allowed @ turn[:count].T


def _lanczos(form: FlexibilityForm, count: int) -> tuple[Array, Array]:
    """Return 1/ω and unit x of the lowest modes, by Lanczos iteration on the operator and its transpose."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    hinges = len(form.flexibility_root)
    if 10 * count > hinges:
        raise ValueError(
            f"modes must be at most {hinges // 10}, a tenth of the chain's, for a chain of more than "
            f"{MAX_DENSE} hinges, got {count}"
        )

    def compliance(x: Array) -> Array:
        inside = form.allowed(x.reshape(hinges, -1))
        return form.allowed(form.adjoint(form.kinetic(inside)))

    operator = LinearOperator((hinges, hinges), matvec=compliance, matmat=compliance, dtype=np.float64)
    # A fixed start vector makes the result reproducible; a random one has a part in every mode.
    start = form.allowed(np.random.default_rng(0).standard_normal((hinges, 1)))[:, 0]
    # 1/ω² falls as 1/n⁴, so few vectors suffice; an error of 1e-10 in them is one of 1e-20 in ω.
    few = min(2 * count + 6, hinges)
    x = eigsh(operator, k=count, which="LA", v0=start, tol=1e-10, ncv=few)[1][:, ::-1]
    # One Rayleigh-Ritz step on |F x| itself: a singular value loses only ω_n/ω_1, its square (ω_n/ω_1)².
    x = form.allowed(x)
    _, inverse, turn = np.linalg.svd(np.linalg.qr(form.kinetic(x), mode="r"))
    return inverse, x @ turn.T


def _in_physical_units(model: LinearModel, omega: Array, shape: Array, slope: Array) -> Modes:
    units = model.chain.units
    largest = np.abs(shape).argmax(axis=0)
    sign = np.sign(shape[largest, np.arange(shape.shape[1])]) / np.sqrt(units.mass)
    return Modes(
        omega * units.angular_frequency,
        model.chain.boundary.rigid_body_modes,
        model.chain.node_position,
        (shape * sign).T,
        (slope * sign / units.length).T,
    )
