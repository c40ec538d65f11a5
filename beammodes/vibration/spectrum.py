"""The chain's flexibility form: an eigenproblem whose *largest* values are its lowest modes.

An eigen-solve of (K, M) loses the lowest frequencies of a long chain: K's condition number grows as N⁴, and
rounding it is an error relative to the *highest* mode. In the hinges' rotations φ the stiffness is diagonal,

    ½ φᵀ D φ  stored,        ½ |F φ|²  kinetic,

where F gives each piece's deflection and rotation, times √mass and √inertia, by cumulative sums of φ. With
x = D^½ φ the singular values of  F D^{-½}  are 1/ω: the lowest modes come first and keep their digits.

Beside φ stand the left tip's deflection y₀ and angle θ₀. With the firmer end on the left the four quantities
that ends hold or support are

                     y₀  θ₀    φ_1 ... φ_h
    left   K_t        1   0         0
           K_r        0   1         0
    right  K_t        1   L      L - x_j
           K_r        0   1         1

The two stiffest of them that differ on (y₀, θ₀) take the place of y₀ and θ₀. Supported by a spring one is a
hinge like any other, of rotation or deflection x/√K; held it is zero; unsupported it is a rigid-body mode.
The other two follow from φ. Where one of these is held, it excludes a direction of x; where a spring supports
it, the stored energy ½ |x|² gains ½ (r·x)², and x = (I + r rᵀ)^{-½} w takes it up: so from the softest spring
to a wall nothing is ever large, and w that excludes a direction is the limit of w that stiffens it.

A rigid-body mode stores nothing, so an elastic mode is orthogonal to it: it is projected out of F. Loads
along the chain add  ½ Σ P_i θ_i²  to the stored energy and make a rigid rotation elastic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.pieces import Pieces, floats
from beammodes.equations.mechanics import axial_pull
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load, checked_load

__all__ = [
    "Buckled",
    "FlexibilityForm",
    "check_stable",
    "energy_metric",
    "flexibility_form",
    "is_turned",
    "unit_energy",
]


@dataclass(frozen=True)
class _EndCoordinates:
    """The end quantities of a chain as coordinates beside its hinges' rotations.

    Attributes
    ----------
    root : ndarray, shape (supported,)
        1/√K of the quantities that are coordinates because springs support them.
    unstored : ndarray, shape (supported,)
        1 for one that no spring supports, but an axial force.
    tip_rows : tuple of two ndarrays, shape (supported + hinges,)
        y₀ and θ₀ from the coordinates' values.
    dependent_rows, dependent_stiffness : ndarray, shape (2, supported + hinges) and (2,)
        The other two quantities, and what supports them.
    rigid : list of (y₀, θ₀)
        The rigid-body modes.
    """

    root: Floats
    unstored: Floats
    tip_rows: tuple[Floats, Floats]
    dependent_rows: Floats
    dependent_stiffness: Floats
    rigid: list[tuple[float, float]]


def _end_coordinates(pieces: Pieces, resistance: float = 0.0) -> _EndCoordinates:
    """Return the end coordinates of a chain that runs from its firmer end.

    `resistance` is what loads along the chain put up against a rigid rotation.
    """
    length = pieces.in_floats.length
    whole, reach = float(length.sum()), np.cumsum(length[:0:-1])[::-1]
    nothing = np.zeros_like(reach)
    # Rows: left deflection, left rotation, right deflection, right rotation.
    on_tip = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, whole], [0.0, 1.0]])
    on_hinges = np.array([nothing, nothing, reach, np.ones_like(reach)])
    stiffness = np.array([float(k) for end in pieces.supports for k in end])
    chosen, others = _chosen(stiffness * [whole**2, 1.0, whole**2, 1.0], on_tip)
    to_tip = np.linalg.inv(on_tip[chosen])
    scale, motions, unstored, rigid = [], [], [], []
    for k, motion in zip(chosen, to_tip.T, strict=True):
        resisted = resistance > 0 and motion[1] != 0
        if 0 < stiffness[k] < math.inf or (not stiffness[k] and resisted):
            # The size of a coordinate that no spring scales is free; this one suits the load's energy.
            scale.append(stiffness[k] or resistance)
            motions.append(motion)
            unstored.append(float(not stiffness[k]))
        elif not stiffness[k]:
            rigid.append((float(motion[0]), float(motion[1])))
    tip_rows = np.hstack([np.array(motions).reshape(-1, 2).T, -to_tip @ on_hinges[chosen]])
    dependent = on_tip[others] @ tip_rows
    dependent[:, len(motions) :] += on_hinges[others]
    return _EndCoordinates(
        1 / np.sqrt(np.array(scale)),
        np.array(unstored),
        (tip_rows[0], tip_rows[1]),
        dependent,
        stiffness[others],
        rigid,
    )


def _chosen(stiffness: Floats, on_tip: Floats) -> tuple[list[int], list[int]]:
    """Return the two stiffest quantities that differ on the tip, left ones first, and the other two."""
    first, *rest = sorted(range(4), key=lambda k: -stiffness[k])
    (a, b), rows = on_tip[first].tolist(), on_tip.tolist()
    second = next(k for k in rest if a * rows[k][1] != b * rows[k][0])
    chosen = sorted([first, second])
    return chosen, [k for k in range(4) if k not in chosen]


@dataclass(frozen=True)
class FlexibilityForm:
    """F D^{-½} on what the ends allow, as an operator on arrays x of shape (coordinates, columns).

    Coordinates are the end quantities that springs support, at most two, then the hinges' rotations. Pieces
    run from the chain's firmer end.

    Attributes
    ----------
    length, centre, root_mass, root_inertia : ndarray, shape (pieces,)
    flexibility_root : ndarray, shape (coordinates,)
        D^{-½}, so that end quantities and φ are flexibility_root x.
    tip_deflection, tip_angle : ndarray, shape (coordinates,)
        y₀ and θ₀ that these entail.
    forbidden : ndarray, shape (coordinates, constraints)
        Orthonormal columns: what the end conditions exclude of x.
    stiffened, softening : ndarray, shape (coordinates, springs) and (springs,)
        Orthonormal directions that further springs stiffen, and (1 + r²)^{-½} - 1 of each.
    unstored : ndarray, shape (coordinates,)
        1 for a rigid rotation that is a coordinate because such loads resist it, else 0.
    rigid_deflection, rigid_angle : ndarray, shape (nodes, modes) and (pieces, modes)
        The rigid-body modes, of unit modal mass.
    pull : ndarray, shape (pieces,)
        P_i of the energy  ½ Σ P_i θ_i²  that loads along the chain store.
    """

    length: Floats
    centre: Floats
    root_mass: Floats
    root_inertia: Floats
    flexibility_root: Floats
    tip_deflection: Floats
    tip_angle: Floats
    forbidden: Floats
    stiffened: Floats
    softening: Floats
    unstored: Floats
    rigid_deflection: Floats
    rigid_angle: Floats
    pull: Floats

    @property
    def hinges(self) -> int:
        """Number of the chain's hinges."""
        return len(self.length) - 1

    def allowed(self, w: Floats) -> Floats:
        """Return the x of w: without what the end conditions exclude, and softened where springs resist."""
        x = w - self.forbidden @ (self.forbidden.T @ w) if self.forbidden.size else w
        if self.stiffened.size:
            x = x + self.stiffened @ (self.softening[:, None] * (self.stiffened.T @ x))
        return x

    def angles(self, x: Floats) -> Floats:
        """Return the pieces' angles, shape (pieces, columns), rigid-body modes not yet taken out."""
        # In place throughout: on a million hinges fresh arrays cost more than the arithmetic.
        hinges = len(self.length) - 1
        ends = len(x) - hinges
        angle = np.empty((hinges + 1, x.shape[1]))
        np.multiply(self.flexibility_root[ends:, None], x[ends:], out=angle[1:])
        angle[0] = self.tip_angle[ends:] @ angle[1:]
        angle[0] += (self.tip_angle * self.flexibility_root)[:ends] @ x[:ends]
        np.cumsum(angle, axis=0, out=angle)
        return angle

    def motion(self, x: Floats) -> tuple[Floats, Floats]:
        """Return the nodes' deflections (nodes, columns) and the pieces' angles of x, both elastic only."""
        angle = self.angles(x)
        deflection = np.empty((len(angle) + 1, angle.shape[1]))
        deflection[0] = 0.0
        if self.tip_deflection.any():
            deflection[0] = (self.tip_deflection * self.flexibility_root) @ x
        np.multiply(self.length[:, None], angle, out=deflection[1:])
        np.cumsum(deflection, axis=0, out=deflection)
        if self.rigid_deflection.size:
            amount = self._rigid_images().T @ self._weighed(deflection, angle)
            deflection -= self.rigid_deflection @ amount
            angle -= self.rigid_angle @ amount
        return deflection, angle

    def kinetic(self, x: Floats) -> Floats:
        """Return F D^{-½} x, shape (2 pieces, columns): |.|² is twice the kinetic energy of motion x."""
        return self._weighed(*self.motion(x))

    def adjoint(self, image: Floats) -> Floats:
        """Return the transpose of `kinetic` applied to `image`, shape (coordinates, columns)."""
        if self.rigid_deflection.size:
            rigid = self._rigid_images()
            image = image - rigid @ (rigid.T @ image)
        pieces = len(self.length)
        force = self.root_mass[:, None] * image[:pieces]
        beyond = _sum_from_right(force)
        lift = beyond[0].copy()
        beyond -= force
        beyond *= self.length[:, None]
        beyond += self.root_inertia[:, None] * image[pieces:]
        beyond += self.centre[:, None] * force
        return self._from_angles(_sum_from_right(beyond), lift)

    def geometric(self, x: Floats) -> Floats:
        """Return  ∂/∂x of ½ Σ P_i θ_i²."""
        moment = _sum_from_right(self.pull[:, None] * self.angles(x))
        return self._from_angles(moment, np.zeros(x.shape[1]))

    def _from_angles(self, moment: Floats, lift: Floats) -> Floats:
        """Return what moments summed from the right, and the lift of the left tip, do to x."""
        pull = np.outer(self.tip_angle, moment[0])
        if self.tip_deflection.any():
            pull += np.outer(self.tip_deflection, lift)
        pull[len(pull) - len(self.length) + 1 :] += moment[1:]
        pull *= self.flexibility_root[:, None]
        return pull

    def _rigid_images(self) -> Floats:
        return self._weighed(self.rigid_deflection, self.rigid_angle)

    def _weighed(self, deflection: Floats, angle: Floats) -> Floats:
        pieces = len(angle)
        image = np.empty((2 * pieces, angle.shape[1]))
        np.multiply(self.centre[:, None], angle, out=image[:pieces])
        image[:pieces] += deflection[:-1]
        image[:pieces] *= self.root_mass[:, None]
        np.multiply(self.root_inertia[:, None], angle, out=image[pieces:])
        return image


def flexibility_form(chain: Chain, load: Load | None = None) -> FlexibilityForm:
    """Return the flexibility form of a chain; it runs from the chain's firmer end.

    The chain is read in its own units, so singular values are 1/ω in `chain.units.angular_frequency`.
    """
    pieces = chain.scaled
    if is_turned(chain):
        pieces = pieces.turned()
    length, mass, centre, inertia, stiffness = pieces.in_floats
    inertia = inertia.copy()
    for end, piece in ((0, 0), (1, -1)):
        # A held piece does not turn; without this a mode's rounding would reach a massless piece's inertia.
        inertia[piece] *= pieces.supports[end][1] != math.inf
    pull = floats(axial_pull(chain, checked_load(load)))
    pull = pull[::-1] if is_turned(chain) else pull
    ends = _end_coordinates(pieces, float(pull.sum()))
    root = np.concatenate([ends.root, 1 / np.sqrt(stiffness)])
    rows = ends.dependent_rows * root
    held = rows[np.isinf(ends.dependent_stiffness)]
    # What every motion meets anyway excludes nothing.
    held = held[held.any(axis=1)].T
    forbidden = np.linalg.qr(held)[0] if held.size else held
    form = FlexibilityForm(
        length,
        centre,
        np.sqrt(mass),
        np.sqrt(inertia),
        root,
        *ends.tip_rows,
        forbidden,
        *_stiffening(ends, rows, forbidden),
        np.concatenate([ends.unstored, np.zeros(len(length) - 1)]),
        *_rigid_motions(ends, length),
        pull,
    )
    return _with_unit_rigid_modes(form)


def is_turned(chain: Chain) -> bool:
    """Say whether the chain's firmer end is its right one, so that its flexibility form runs backwards."""
    left, right = chain.scaled.supports
    return right > left


def _stiffening(ends: _EndCoordinates, rows: Floats, forbidden: Floats) -> tuple[Floats, Floats]:
    """Return the orthonormal directions that springs of dependent end quantities stiffen, and how much."""
    finite = ~np.isinf(ends.dependent_stiffness) & (ends.dependent_stiffness > 0)
    if not finite.any():
        return np.zeros((rows.shape[1], 0)), np.zeros(0)
    pulls = (np.sqrt(ends.dependent_stiffness[finite])[:, None] * rows[finite]).T
    pulls -= forbidden @ (forbidden.T @ pulls)
    direction, size, _ = np.linalg.svd(pulls, full_matrices=False)
    return direction[:, size > 0], 1 / np.hypot(1, size[size > 0]) - 1


def _rigid_motions(ends: _EndCoordinates, length: Floats) -> tuple[Floats, Floats]:
    """Return the nodes' deflections and the pieces' angles of the rigid-body modes, not yet scaled."""
    if not ends.rigid:
        return np.zeros((len(length) + 1, 0)), np.zeros((len(length), 0))
    node = np.concatenate([[0.0], np.cumsum(length)])
    tip = np.array(ends.rigid).reshape(-1, 2)
    return tip[:, 0] + np.outer(node, tip[:, 1]), np.outer(np.ones_like(length), tip[:, 1])


def _with_unit_rigid_modes(form: FlexibilityForm) -> FlexibilityForm:
    if not form.rigid_deflection.size:
        return form
    scale = np.linalg.inv(np.linalg.qr(form._rigid_images())[1])
    rigid = (form.rigid_deflection @ scale, form.rigid_angle @ scale)
    return replace(form, rigid_deflection=rigid[0], rigid_angle=rigid[1])


def _sum_from_right(values: Floats) -> Floats:
    """Return, along axis 0, each entry plus all that follow it."""
    return np.cumsum(values[::-1], axis=0)[::-1]


class Buckled(ArithmeticError):
    """The straight shape is not stable."""


def unit_energy(form: FlexibilityForm, w: Floats, x: Floats) -> Floats:
    """Return the upper triangle C⁻¹ of combinations that store unit energy, that of loads included."""
    slope = form.angles(x)
    plain = np.sqrt(1 - form.unstored)[:, None] * w
    if (form.pull >= 0).all():
        # No products are formed: they would square the range of a strong tension on soft supports.
        factor = np.linalg.qr(np.vstack([plain, np.sqrt(form.pull)[:, None] * slope]), mode="r")
        return np.asarray(np.linalg.inv(factor))
    try:
        lower = np.linalg.cholesky(plain.T @ plain + slope.T @ (form.pull[:, None] * slope))
    except np.linalg.LinAlgError:
        raise Buckled from None
    return np.asarray(np.linalg.inv(lower).T)


def check_stable(form: FlexibilityForm, dense: int) -> None:
    """Raise Buckled if loads turn a chain over, or buckle one of more than `dense` hinges.

    Of shorter ones `unit_energy` tells, which has all their motions.
    """
    from scipy.sparse.linalg import LinearOperator, eigsh

    if (form.pull >= 0).all():
        return
    if form.rigid_angle.any():
        raise Buckled
    size = len(form.flexibility_root)
    if form.hinges <= dense:
        return

    def released(w: Floats) -> Floats:
        return form.allowed(form.geometric(form.allowed(w.reshape(size, -1))))

    operator = LinearOperator((size, size), matvec=released, matmat=released, dtype=np.float64)
    start = form.allowed(np.random.default_rng(0).standard_normal((size, 1)))[:, 0]
    if eigsh(operator, k=1, which="SA", v0=start, tol=1e-13, return_eigenvectors=False)[0] <= -1:
        raise Buckled


def energy_metric(form: FlexibilityForm) -> dict[str, Any]:
    """Return the stored energy as a metric, for the Lanczos iteration, where it is not simply |w|²."""
    from scipy.sparse.linalg import LinearOperator, cg

    if not form.pull.any():
        return {}
    size = len(form.flexibility_root)

    def stored(w: Floats) -> Floats:
        column = w.reshape(size, -1)
        bent = form.allowed(form.geometric(form.allowed(column)))
        return (1 - form.unstored)[:, None] * column + bent

    def solved(w: Floats) -> Floats:
        # Identity and a compact operator: a few steps. What they leave open the Rayleigh-Ritz step restores.
        return np.asarray(cg(metric, w, rtol=1e-10, atol=0.0, maxiter=2000)[0])

    metric = LinearOperator((size, size), matvec=stored, dtype=np.float64)
    return {"M": metric, "Minv": LinearOperator((size, size), matvec=solved, dtype=np.float64)}
