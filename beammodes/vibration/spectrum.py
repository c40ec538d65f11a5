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

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.chains.repeated import floats
from beammodes.equations.axial_pull import axial_pull
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.end_coordinates import EndCoordinates, end_coordinates

__all__ = ["FlexibilityForm", "flexibility_form", "is_turned"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FlexibilityForm:
    """F D^{-½} on what the ends allow, as an operator on arrays x of shape (coordinates, columns).

    Coordinates are the end quantities that springs support, at most two, then the hinges' rotations.

    Attributes
    ----------
    length, centre, root_mass, root_inertia : ndarray, shape (pieces,)
        Of the pieces, the chain's firmer end first; `centre` is that of mass, from the left tip.
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

    length: Array
    centre: Array
    root_mass: Array
    root_inertia: Array
    flexibility_root: Array
    tip_deflection: Array
    tip_angle: Array
    forbidden: Array
    stiffened: Array
    softening: Array
    unstored: Array
    rigid_deflection: Array
    rigid_angle: Array
    pull: Array

    @property
    def hinges(self) -> int:
        """How many hinges the chain has."""
        return len(self.length) - 1

    def allowed(self, w: Array) -> Array:
        """Return the x of w: without what the end conditions exclude, and softened where springs resist."""
        x = w - self.forbidden @ (self.forbidden.T @ w) if self.forbidden.size else w
        if self.stiffened.size:
            x = x + self.stiffened @ (self.softening[:, None] * (self.stiffened.T @ x))
        return x

    def angles(self, x: Array) -> Array:
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

    def motion(self, x: Array) -> tuple[Array, Array]:
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

    def kinetic(self, x: Array) -> Array:
        """Return F D^{-½} x, shape (2 pieces, columns): |.|² is twice the kinetic energy of motion x."""
        return self._weighed(*self.motion(x))

    def adjoint(self, image: Array) -> Array:
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

    def geometric(self, x: Array) -> Array:
        """Return  ∂/∂x of ½ Σ P_i θ_i²."""
        moment = _sum_from_right(self.pull[:, None] * self.angles(x))
        return self._from_angles(moment, np.zeros(x.shape[1]))

    def _from_angles(self, moment: Array, lift: Array) -> Array:
        """Return what moments summed from the right, and the lift of the left tip, do to x."""
        pull = np.outer(self.tip_angle, moment[0])
        if self.tip_deflection.any():
            pull += np.outer(self.tip_deflection, lift)
        pull[len(pull) - len(self.length) + 1 :] += moment[1:]
        pull *= self.flexibility_root[:, None]
        return pull

    def _rigid_images(self) -> Array:
        return self._weighed(self.rigid_deflection, self.rigid_angle)

    def _weighed(self, deflection: Array, angle: Array) -> Array:
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
    pieces = chain.pieces_and_springs
    if is_turned(chain):
        pieces = pieces.turned()
    columns = (pieces.length, pieces.mass, pieces.centre, pieces.rotary_inertia)
    length, mass, centre, inertia = (floats(values) for values in columns)
    for end, piece in ((0, 0), (1, -1)):
        # A held piece does not turn; without this a mode's rounding would reach a massless piece's inertia.
        inertia[piece] *= pieces.supports[end][1] != math.inf
    pull = floats(axial_pull(chain, checked_load(load)))
    pull = pull[::-1] if is_turned(chain) else pull
    ends = end_coordinates(pieces, float(pull.sum()))
    root = np.concatenate([ends.root, 1 / np.sqrt(floats(pieces.joint_stiffness))])
    rows = ends.dependent_rows * root
    held = rows[np.isinf(ends.dependent_stiffness)]
    # What every motion meets anyway excludes nothing.
    forbidden = np.linalg.qr(held[held.any(axis=1)].T)[0]
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
    left, right = chain.supports
    return right > left


def _stiffening(ends: EndCoordinates, rows: Array, forbidden: Array) -> tuple[Array, Array]:
    """Return the orthonormal directions that springs of dependent end quantities stiffen, and how much."""
    finite = ~np.isinf(ends.dependent_stiffness) & (ends.dependent_stiffness > 0)
    pulls = (np.sqrt(ends.dependent_stiffness[finite])[:, None] * rows[finite]).T
    pulls -= forbidden @ (forbidden.T @ pulls)
    direction, size, _ = np.linalg.svd(pulls, full_matrices=False)
    return direction[:, size > 0], 1 / np.hypot(1, size[size > 0]) - 1


def _rigid_motions(ends: EndCoordinates, length: Array) -> tuple[Array, Array]:
    """Return the nodes' deflections and the pieces' angles of the rigid-body modes, not yet scaled."""
    node = np.concatenate([[0.0], np.cumsum(length)])
    tip = np.array(ends.rigid).reshape(-1, 2)
    return tip[:, 0] + np.outer(node, tip[:, 1]), np.outer(np.ones_like(length), tip[:, 1])


def _with_unit_rigid_modes(form: FlexibilityForm) -> FlexibilityForm:
    images = form._rigid_images()
    scale = np.linalg.inv(np.linalg.qr(images)[1]) if images.size else np.zeros((0, 0))
    rigid = (form.rigid_deflection @ scale, form.rigid_angle @ scale)
    return replace(form, rigid_deflection=rigid[0], rigid_angle=rigid[1])


def _sum_from_right(values: Array) -> Array:
    """Return, along axis 0, each entry plus all that follow it."""
    return np.cumsum(values[::-1], axis=0)[::-1]
