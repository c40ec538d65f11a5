"""The chain's flexibility form: an eigenproblem whose *largest* values are its lowest modes.

An eigen-solve of (K, M) loses the lowest frequencies of a long chain: K's condition number grows as N⁴, and
rounding it is an error relative to the *highest* mode. In the hinges' rotations φ the stiffness is diagonal,

    ½ φᵀ D φ  stored,        ½ |F φ|²  kinetic,

where F gives each piece's deflection and rotation, times √mass and √inertia, by cumulative sums of φ. With
x = D^½ φ the singular values of  F D^{-½}  are 1/ω: the lowest modes come first and keep their digits.

The left tip's deflection y₀ and angle θ₀ come beside φ. With the firmer end on the left, what the ends hold
is, row by row (a row is there only if its end holds that quantity):

                 y₀  θ₀    φ_1 ... φ_h
    left          1   0         0              y₀ = 0, or a rigid-body mode
                  0   1         0              θ₀ = 0
    right         1   L      L - x_j           the first of these fixes θ₀ where the left end leaves it free;
                  0   1         1              any other constrains φ. θ₀ held by none is a rigid-body mode.

A rigid-body mode stores nothing, so an elastic mode is orthogonal to it: it is projected out of F.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beammodes.chain import Chain

__all__ = ["FlexibilityForm", "flexibility_form"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FlexibilityForm:
    """F D^{-½} on the rotations that the ends allow, as an operator on arrays of shape (hinges, columns).

    Attributes
    ----------
    length, root_mass, root_inertia : ndarray, shape (pieces,)
        Of the pieces, the chain's firmer end first.
    flexibility_root : ndarray, shape (hinges,)
        D^{-½}, so that φ = flexibility_root x.
    tip_angle : ndarray, shape (hinges,)
        θ₀ that φ entails through the end conditions.
    forbidden : ndarray, shape (hinges, constraints)
        Orthonormal columns: what the end conditions exclude of x.
    rigid_deflection, rigid_angle : ndarray, shape (nodes, modes) and (pieces, modes)
        The rigid-body modes, of unit modal mass.
    """

    length: Array
    root_mass: Array
    root_inertia: Array
    flexibility_root: Array
    tip_angle: Array
    forbidden: Array
    rigid_deflection: Array
    rigid_angle: Array

    def allowed(self, x: Array) -> Array:
        """Return x without what the end conditions exclude."""
        return x - self.forbidden @ (self.forbidden.T @ x) if self.forbidden.size else x

    def motion(self, x: Array) -> tuple[Array, Array]:
        """Return the nodes' deflections (nodes, columns) and the pieces' angles of x, both elastic only."""
        # In place throughout: on a million hinges fresh arrays cost more than the arithmetic.
        angle = np.empty((len(self.length), x.shape[1]))
        np.multiply(self.flexibility_root[:, None], x, out=angle[1:])
        angle[0] = self.tip_angle @ angle[1:]
        np.cumsum(angle, axis=0, out=angle)
        deflection = np.empty((len(angle) + 1, angle.shape[1]))
        deflection[0] = 0.0
        np.multiply(self.length[:, None], angle, out=deflection[1:])
        np.cumsum(deflection, axis=0, out=deflection)
        if self.rigid_angle.size:
            amount = self._rigid_images().T @ self._weighed(deflection, angle)
            deflection -= self.rigid_deflection @ amount
            angle -= self.rigid_angle @ amount
        return deflection, angle

    def kinetic(self, x: Array) -> Array:
        """Return F D^{-½} x, shape (2 pieces, columns): |.|² is twice the kinetic energy of motion x."""
        return self._weighed(*self.motion(x))

    def adjoint(self, image: Array) -> Array:
        """Return the transpose of `kinetic` applied to `image`, shape (hinges, columns)."""
        if self.rigid_angle.size:
            rigid = self._rigid_images()
            image = image - rigid @ (rigid.T @ image)
        pieces, length = len(self.length), self.length[:, None]
        force = self.root_mass[:, None] * image[:pieces]
        carried = _sum_from_right(force) - force / 2
        moment = _sum_from_right(self.root_inertia[:, None] * image[pieces:] + length * carried)
        return np.asarray(self.flexibility_root[:, None] * (moment[1:] + np.outer(self.tip_angle, moment[0])))

    def _rigid_images(self) -> Array:
        return self._weighed(self.rigid_deflection, self.rigid_angle)

    def _weighed(self, deflection: Array, angle: Array) -> Array:
        pieces = len(angle)
        image = np.empty((2 * pieces, angle.shape[1]))
        np.add(deflection[:-1], deflection[1:], out=image[:pieces])
        image[:pieces] *= self.root_mass[:, None] / 2
        np.multiply(self.root_inertia[:, None], angle, out=image[pieces:])
        return image


def flexibility_form(chain: Chain) -> FlexibilityForm:
    """Return the flexibility form of a chain; it runs from the chain's firmer end.

    The chain is read in its own units, so singular values are 1/ω in `chain.units.angular_frequency`.
    """
    turned = chain.boundary != chain.boundary.canonical
    columns = (chain.piece_length, chain.piece_mass, chain.piece_rotary_inertia, chain.hinge_stiffness)
    length, mass, inertia, stiffness = (
        np.array(values[::-1] if turned else values, dtype=np.float64) for values in columns
    )
    root = 1 / np.sqrt(stiffness)
    tip_angle, constraints = _end_conditions(chain, length)
    forbidden = np.linalg.qr(root[:, None] * constraints)[0]
    held = np.array(chain.held_angles[::-1] if turned else chain.held_angles)
    # A held piece does not turn; without this a mode's rounding would reach a massless piece's inertia.
    inertia[held] = 0.0
    form = FlexibilityForm(
        length, np.sqrt(mass), np.sqrt(inertia), root, tip_angle, forbidden, *_rigid_motions(chain, length)
    )
    return _with_unit_rigid_modes(form)


def _end_conditions(chain: Chain, length: Array) -> tuple[Array, Array]:
    """Return θ₀ in terms of φ, and the rows on φ that θ₀ cannot satisfy, as columns (module's table)."""
    boundary = chain.boundary.canonical
    reach = _sum_from_right(length[1:, None])[:, 0]
    rows = []
    if boundary.right.holds_deflection:
        rows.append((float(length.sum()), reach))
    if boundary.right.holds_rotation:
        rows.append((1.0, np.ones_like(reach)))
    tip_angle = np.zeros_like(reach)
    if rows and not boundary.left.holds_rotation:
        coefficient, row = rows.pop(0)
        tip_angle = -row / coefficient
    return tip_angle, np.array([row for _, row in rows]).reshape(len(rows), len(reach)).T


def _rigid_motions(chain: Chain, length: Array) -> tuple[Array, Array]:
    """Return the nodes' deflections and the pieces' angles of the rigid-body modes, not yet scaled.

    Turning is about the pinned tip, or about the middle of a beam that can also shift.
    """
    left, right = chain.boundary.canonical.left, chain.boundary.canonical.right
    node = np.concatenate([[0.0], np.cumsum(length)])
    motions = []
    if not left.holds_deflection:
        motions.append((np.ones_like(node), np.zeros_like(length)))
    if not left.holds_rotation and not (right.holds_deflection or right.holds_rotation):
        pivot = 0.0 if left.holds_deflection else node[-1] / 2
        motions.append((node - pivot, np.ones_like(length)))
    deflection = np.array([motion[0] for motion in motions]).reshape(len(motions), len(node)).T
    angle = np.array([motion[1] for motion in motions]).reshape(len(motions), len(length)).T
    return deflection, angle


def _with_unit_rigid_modes(form: FlexibilityForm) -> FlexibilityForm:
    images = form._rigid_images()
    scale = np.linalg.inv(np.linalg.qr(images)[1]) if images.size else np.zeros((0, 0))
    rigid = (form.rigid_deflection @ scale, form.rigid_angle @ scale)
    return replace(form, rigid_deflection=rigid[0], rigid_angle=rigid[1])


def _sum_from_right(values: Array) -> Array:
    """Return, along axis 0, each entry plus all that follow it."""
    return np.cumsum(values[::-1], axis=0)[::-1]
