"""Natural modes of a linear chain, with every digit of the lowest frequencies kept."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import overload

import numpy as np

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, instead, row_shown, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load
from beammodes.vibration.axial_spectrum import AxialChainModes, solve_axial_modes
from beammodes.vibration.linear import BentModel, LinearModel
from beammodes.vibration.spectrum import (
    Buckled,
    FlexibilityForm,
    check_stable,
    energy_metric,
    flexibility_form,
    is_turned,
    unit_energy,
)
from beammodes.vibration.structure_vibration import StructureChainModes, structure_chain_modes

__all__ = ["MAX_DENSE", "Modes", "solve_modes"]


#: Chains of at most this many hinges are solved by a dense singular value decomposition, which gives all
#: modes at once; longer ones, and of more than a few hinges for a tenth of the modes, by Lanczos iteration.
MAX_DENSE = 500

# From here on iteration is faster for a tenth of the modes.
_FEW_HINGES = 48

# An error of 1e-10 in a mode's vector is one of 1e-20 in ω.
_CONVERGED = 1e-10
# Of vectors that lose more than this to those before them what is left is made orthogonal once more.
_CANCELLED = 1e-3
# Columns whose cosines are smaller have a triangle by their products, without loss.
_NEARLY_ORTHOGONAL = 1e-2


@dataclass(frozen=True, eq=False, repr=False)
class Modes(Shown):
    """Elastic modes of a chain, ascending, normalized to unit modal mass.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
    rigid_body_modes : int
        Number of motions that store nothing; they are counted here and are no rows of the arrays.
    position : ndarray, shape (nodes,) [m]
        Of the nodes on the straight chain: left tip, hinges, right tip.
    deflection : ndarray, shape (modes, nodes) [kg^-½]
        Mode shapes; the largest entry of each is positive, and of several as large the leftmost.
    rotation : ndarray, shape (modes, pieces) [kg^-½/m]
        Angle of each piece in each mode.
    """

    angular_frequency: Floats
    rigid_body_modes: int
    position: Floats
    deflection: Floats
    rotation: Floats

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, shape (modes,) [Hz]."""
        return self.angular_frequency / (2 * np.pi)

    def _line(self) -> str:
        rigid = f"; {self.rigid_body_modes} rigid-body modes" if self.rigid_body_modes else ""
        return f"Modes(chain: {row_shown(self.frequency, '{:.4g}', 'Hz')}{rigid})"


@overload
def solve_modes(model: LinearModel | BentModel, modes: int | None = ...) -> Modes: ...


@overload
def solve_modes(model: AxialChain, modes: int | None = ...) -> AxialChainModes: ...


@overload
def solve_modes(model: StructureChain, modes: int | None = ...) -> StructureChainModes: ...


def solve_modes(
    model: LinearModel | BentModel | AxialChain | StructureChain, modes: int | None = None
) -> Modes | AxialChainModes | StructureChainModes:
    """Return the lowest elastic modes of a linear chain.

        K u = ω² M u,   uᵀ M u = 1

    Relative accuracy of ω is 1e-12 or better for the lowest ten modes of any chain up to 10⁶ hinges, and
    about 1e-13 for every mode of a short one. Tested against 50-digit arithmetic.

    Parameters
    ----------
    model : LinearModel or BentModel, AxialChain, or StructureChain
        From `linearize`; a chain in twist or stretch is linear as it is (`solve_axial_modes`), and so is one
        of a structure (`structure_chain_modes`). About a bent
        shape `position` is that along the chain, `deflection` the nodes' motion along y (along x they move by
        -Σ l_i sin θ_i  times the rotations), and the accuracy of ω is about 1e-16 N².
    modes : int, optional
        Number of modes, from the first; all of them by default. A chain with fewer gives those it has.

    Returns
    -------
    Modes, AxialChainModes or StructureChainModes
        Frequencies in increasing order, shapes of unit modal mass. Rigid-body modes are counted, not
        listed.

    Raises
    ------
    TypeError, ValueError
        If `modes` is no whole number of at least 1, or a chain of more than 500 hinges is asked for more
        than a tenth of its modes, or the shape that it vibrates about is not stable.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=6)
    >>> bm.solve_modes(bm.linearize(chain), modes=2).angular_frequency
    array([ 3.50364768, 21.28034888])
    """
    if isinstance(model, AxialChain):
        return solve_axial_modes(model, modes)
    if isinstance(model, StructureChain):
        return structure_chain_modes(model, modes)
    if not isinstance(model, LinearModel | BentModel):
        takers = {
            "Chain": "linearize(chain) makes one",
            "SpatialChain": "spatial_modes takes a SpatialChain",
        }
        raise TypeError(
            f"model must be a LinearModel or a BentModel from linearize(), got {shown(model)}"
            f"{instead(model, **takers)}"
        )
    chain = model.chain
    count = model.elastic_modes if modes is None else whole_number("modes", modes)
    count = min(count, model.elastic_modes)
    if isinstance(model, BentModel):
        omega, lift, turned = _bent_shapes(model, count)
        return Modes(omega, model.rigid_body_modes, chain.node_position, lift, turned)
    form = flexibility_form(chain, model.load)
    try:
        inverse, x = _solved(form, count)
    except Buckled:
        raise ValueError(_buckled(model.load)) from None
    deflection, angle = form.motion(x)
    # Unit modal mass: the image of a unit singular vector has length 1/ω.
    shape, slope = deflection / inverse, angle / inverse
    if is_turned(chain):
        shape, slope = shape[::-1], -slope[::-1]
    return _in_physical_units(model, _seen_from_hub(model, 1 / inverse), shape, slope)


def _bent_shapes(model: BentModel, count: int) -> tuple[Floats, Floats, Floats]:
    """Return ω, nodes' y and pieces' angles of the lowest modes, of unit modal mass, a row each.

    With K = L Lᵀ and M = Aᵀ A the singular values of  A L^{-T}  are 1/ω: the lowest keep their digits, which
    an eigen-solve of (K, M) would lose to the highest.
    """
    from scipy.linalg import solve_triangular

    if not model.equilibrium.is_stable:
        raise ValueError(
            f"model must be about a stable equilibrium, got an unstable one of {shown(model.chain)} under "
            f"{model.load}"
        )
    if not model.elastic_modes:
        none = np.zeros((0, model.chain.pieces + 1))
        return np.zeros(0), none, none[:, 1:]
    lower = np.linalg.cholesky(model.stiffness_matrix)
    root = solve_triangular(lower, model.root_mass.T, lower=True).T
    _, inverse, turn = np.linalg.svd(root, full_matrices=False)
    shapes = solve_triangular(lower, turn[:count].T, lower=True, trans="T") / inverse[:count]
    lift, turned = model.displacements[1] @ shapes, model.rotations @ shapes
    sign = np.sign(lift[np.abs(lift).argmax(axis=0), np.arange(shapes.shape[1])])
    sign[sign == 0] = 1.0
    return 1 / inverse[:count], (lift * sign).T, (turned * sign).T


def _solved(form: FlexibilityForm, count: int) -> tuple[Floats, Floats]:
    check_stable(form, MAX_DENSE)
    if count == 0:
        return np.zeros(0), np.zeros((len(form.flexibility_root), 0))
    few = 10 * count <= len(form.flexibility_root)
    if form.hinges <= (_FEW_HINGES if few and not form.pull.any() else MAX_DENSE):
        return _dense(form, count)
    if not few:
        raise ValueError(
            f"modes must be at most {len(form.flexibility_root) // 10}, a tenth of the chain's, for a chain "
            f"of more than {MAX_DENSE} hinges, got {count}"
        )
    # A fixed start vector makes the result reproducible; a random one has a part in every mode.
    start = form.allowed(np.random.default_rng(0).standard_normal((len(form.flexibility_root), 1)))[:, 0]
    return _rayleigh_ritz(form, (_under_load if form.pull.any() else _lanczos)(form, count, start))


def _buckled(load: Load) -> str:
    if load.is_axial:
        return (
            "axial_force must not compress the chain beyond its buckling load (see buckling_load), "
            f"got {float(load.axial_force):g}"
        )
    return f"load must not buckle the straight chain (see find_equilibrium), got {load}"


def _seen_from_hub(model: LinearModel, omega: Floats) -> Floats:
    """Return ω as it is, or in the plane of rotation of a turning hub, where Ω² is taken from ω² again."""
    if not model.load.spin_rate or model.load.plane == "flap":
        return omega
    rate = math.sqrt(model.chain.exact_units.square_rate(model.load.spin_rate))
    # Rounding leaves so much of a rotation that the hub follows.
    if model.rigid_body_modes or (len(omega) and omega[0] <= rate * (1 + 1e-12)):
        raise ValueError(
            f"spin_rate must be lower for {model.chain.boundary.name} in the plane of rotation, where the "
            f"straight shape is not stable, got {float(model.load.spin_rate)}"
        )
    return np.asarray(np.sqrt((omega - rate) * (omega + rate)))


def _dense(form: FlexibilityForm, count: int) -> tuple[Floats, Floats]:
    """Return 1/ω and x of unit stored energy of the lowest modes, by singular values of F D^{-½}."""
    coordinates, excluded = form.forbidden.shape
    # The full QR's trailing columns span what the end conditions allow.
    complete = np.linalg.qr(form.forbidden, mode="complete")[0] if excluded else np.eye(coordinates)
    w = complete[:, excluded:]
    x = form.allowed(w)
    if form.pull.any():
        x = x @ unit_energy(form, w, x)
    _, inverse, turn = np.linalg.svd(form.kinetic(x), full_matrices=False)
    return inverse[:count], x @ turn[:count].T


def _lanczos(form: FlexibilityForm, count: int, start: Floats) -> Floats:
    """Return the lowest modes' w, shape (coordinates, count), by Lanczos iteration from `start`.

    1/ω² falls as 1/n⁴, so that few steps suffice and all vectors are kept orthogonal.
    """
    from scipy.linalg.lapack import dstev

    size = len(start)
    basis = np.empty((min(2 * count + 10, size), size))
    basis[0] = start / np.linalg.norm(start)
    diagonal: list[float] = []
    beside: list[float] = []
    for k in range(size):
        image = _compliance(form, basis[k][:, None])[:, 0]
        diagonal.append(float(image @ basis[k]))
        whole, before = np.linalg.norm(image), basis[: k + 1]
        image -= (before @ image) @ before
        rest = np.linalg.norm(image)
        if rest < _CANCELLED * whole:
            # What is left is orthogonal to rounding over its share of the image.
            image -= (before @ image) @ before
            rest = np.linalg.norm(image)
        beside.append(float(rest))
        last = k + 1 == size or not rest
        if last or (k > count and not (k - count) % 2):
            # Of one number LAPACK wants a neighbour, too, which it leaves alone.
            value, turn, _ = dstev(diagonal, beside[: max(k, 1)])
            if last or (rest * np.abs(turn[-1, -count:]) <= _CONVERGED * value[-count:]).all():
                break
        if k + 1 == len(basis):
            basis = np.concatenate([basis, np.empty((min(len(basis), size - len(basis)), size))])
        basis[k + 1] = image / beside[-1]
    return np.asarray(basis[: len(diagonal)].T @ turn[:, : -count - 1 : -1])


def _compliance(form: FlexibilityForm, w: Floats) -> Floats:
    """Return what w of unit stored energy become under the inertia forces of their own motion."""
    return form.allowed(form.adjoint(form.kinetic(form.allowed(w))))


def _under_load(form: FlexibilityForm, count: int, start: Floats) -> Floats:
    """Return the lowest modes' w where loads store energy, too: the metric of the iteration is theirs."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    size = len(start)

    def compliance(w: Floats) -> Floats:
        return _compliance(form, w.reshape(size, -1))

    operator = LinearOperator((size, size), matvec=compliance, matmat=compliance, dtype=np.float64)
    few = min(2 * count + 6, size)
    metric = energy_metric(form)
    found = eigsh(operator, k=count, which="LA", v0=start, tol=_CONVERGED, ncv=few, **metric)[1]
    return np.asarray(found[:, ::-1])


def _rayleigh_ritz(form: FlexibilityForm, w: Floats) -> tuple[Floats, Floats]:
    """Return 1/ω and x of unit stored energy by one Rayleigh-Ritz step on |F x| itself.

    A singular value loses only ω_n/ω_1, its square (ω_n/ω_1)².
    """
    if form.forbidden.size:
        w = w - form.forbidden @ (form.forbidden.T @ w)
    w = w @ np.linalg.inv(_triangle(w))
    x = form.allowed(w)
    if form.pull.any():
        x = x @ unit_energy(form, w, x)
    _, inverse, turn = np.linalg.svd(_triangle(form.kinetic(x)))
    return inverse, x @ turn.T


def _triangle(columns: Floats) -> Floats:
    """Return R of columns = Q R, of long columns that are nearly orthogonal without Q."""
    size = np.sqrt((columns * columns).sum(axis=0))
    cosines = columns.T @ columns / size / size[:, None]
    if np.abs(cosines - np.eye(len(size))).max() < _NEARLY_ORTHOGONAL:
        return np.asarray(np.linalg.cholesky(cosines).T * size)
    return np.asarray(np.linalg.qr(columns, mode="r"))


def _in_physical_units(model: LinearModel, omega: Floats, shape: Floats, slope: Floats) -> Modes:
    units = model.chain.units
    size = np.abs(shape)
    # In an antisymmetric mode two entries are the largest, which of them rounding decides: take the left one.
    largest = (size >= (1 - 1e-6) * size.max(axis=0, initial=0.0)).argmax(axis=0)
    # A mode in which only a hinged end turns has no deflection to take a sign from.
    sign = np.where(shape[largest, np.arange(shape.shape[1])] < 0, -1.0, 1.0) / np.sqrt(units.mass)
    return Modes(
        omega * units.angular_frequency,
        model.rigid_body_modes,
        model.chain.node_position,
        (shape * sign).T,
        (slope * sign / units.length).T,
    )
