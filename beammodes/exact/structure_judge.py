"""Exact modes of planar structures of beams: dynamic stiffness of each stretch, and every root counted.

A stretch between two nodes, moved harmonically at its ends by x = (v₁, θ₁, v₂, θ₂) with λ = ω², answers with

    D(λ) = K₀ - λ M₀ - λ² Σ_k c_k c_kᵀ / (λ_k - λ),

K₀ its static stiffness, M₀ the mass that moves as the static shapes do, λ_k the squared frequencies that it
has between two clamps, c_k the momentum that these modes share with the static shapes. Curvatures are
polynomials, of a degree at which they leave out nothing that a double shows. Along itself a stretch moves as
a rigid body: that, and what supports hold, is constraints, whose null space is worked out once.

With no λ_k below λ, the matrix K(λ) of the structure has as many negative eigenvalues as there are modes
below (Wittrick and Williams, Quarterly Journal of Mechanics and Applied Mathematics 24, 1971): stretches are
divided until that is so. K(λ) is concave, so that each step of

    λ  ->  λ + ν_n,     K(λ) x = ν M(λ) x,     M = -dK/dλ,     ν_1 ≤ ν_2 ≤ ...

leads to an upper bound of the n-th root and the steps converge quadratically, each n to its own. That no root
is missed or doubled is told by the count on either side of each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beammodes.checks import Shown, positive_real, row_shown, whole_number
from beammodes.exact.spectral_grid import section_grid
from beammodes.numerics.arrays import Floats, signs_of_largest
from beammodes.numerics.blas import one_thread
from beammodes.problem.beam import Beam, positions_on
from beammodes.problem.structure import Parts, Stretch, Structure, checked_structure, part_of_beam

__all__ = [
    "MOST_MODES",
    "POINTS",
    "Curve",
    "StructureModel",
    "StructureModes",
    "modes_below",
    "structure_modes",
]

#: Points of a stretch's curvature beyond those that its beam needs.
POINTS = 22
#: A part of a stretch that is longer, over its wavenumber, is divided.
_LONGEST = 2.5
_MOST_PARTS, MOST_MODES = 2000, 100
#: Singular values of the stiffness' root below this part of the largest are rigid motions.
_RIGID = 1e-12
#: Between these two there is one root: far above rounding, far below what roots differ by.
_NEAR = 1e-8
#: Roots of beams that vary must agree so well between two degrees.
_AGREEMENT = 1e-10


class Curve(NamedTuple):
    """Deflections along a part of a member: positions, and a row of values for each mode [m]."""

    member: str
    x: Floats
    values: Floats
    smooth: bool

    def __call__(self, x: Floats) -> Floats:
        """Return the deflections at positions, shape (modes, positions)."""
        from scipy.interpolate import BarycentricInterpolator, make_interp_spline

        if self.smooth:
            # Next to the first node a distance to it has no reciprocal; nothing changes over so little.
            x = np.where(x < 1e-30 * self.x[-1], self.x[0], x)
            return np.asarray(BarycentricInterpolator(self.x, self.values, axis=1)(x))
        return np.asarray(make_interp_spline(self.x, self.values, k=5, axis=1)(x))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StructureModes(Shown):
    """The first elastic modes of a structure, exact; `structure_modes` makes it.

    Attributes
    ----------
    structure : Structure
    angular_frequency : ndarray, shape (modes,) [rad/s]
        ω of elastic modes 1, 2, ..., ascending, a double one twice; read-only.
    rigid_body_modes : int
        How many motions store no energy, mechanisms of pinned joints among them.
    displacement : mapping of str to ndarray, shape (modes, 3) [m, m, rad]
        Of each joint: along x, along y, and its rotation, NaN where nothing is rigidly fixed to the joint.
        Modes have unit modal mass, and the sign that makes the largest displacement of a node positive.
    curves : tuple of Curve
        Deflections along parts of members; `shape` reads them.
    """

    structure: Structure
    angular_frequency: Floats
    rigid_body_modes: int
    displacement: dict[str, Floats]
    curves: tuple[Curve, ...]

    @property
    def frequency(self) -> Floats:
        """ω/(2π) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def shape(self, x: ArrayLike, member: str | None = None) -> Floats:
        """Return deflections across a member, to the left of one who goes along it, shape (modes, x.shape).

        Those of uniform beams to 1e-12 of the largest, of others to 1e-6.

        Parameters
        ----------
        x : float or array [m]
            Distances from the member's start.
        member : str, optional
            Its name, where there are several.
        """
        beam = self.structure.member(member)
        places = positions_on(beam.beam, x)
        curves = [curve for curve in self.curves if curve.member == beam.name]
        own = np.searchsorted([curve.x[0] for curve in curves[1:]], places.ravel(), side="left")
        found = np.empty((len(self.angular_frequency), places.size))
        for k in np.unique(own).tolist():
            found[:, own == k] = curves[k](places.ravel()[own == k])
        return found.reshape(len(found), *places.shape)

    def _line(self) -> str:
        return f"StructureModes({row_shown(self.frequency, '{:.4g}', 'Hz')} of {self.structure!r})"


def structure_modes(structure: Structure, modes: int) -> StructureModes:
    """Return the first elastic modes, 1 to 100, of a planar structure of Euler-Bernoulli beams.

    (EI v'')'' = ω² (ρA v - (ρI v')') on every stretch, which keeps its length; supports, bodies and hinges at
    joints and stations. Right to about 1e-13 where all beams are uniform, else to 1e-10, while masses and
    springs lie within eight decades of the beams' own; beyond, digits are lost or a count fails.

    Parameters
    ----------
    structure : Structure
    modes : int
        Elastic modes: those of zero frequency are not counted.

    Returns
    -------
    StructureModes
        Frequencies in increasing order, with the shapes on every member.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or range.
    ArithmeticError
        If a beam varies too much from place to place, or a root cannot be told from its neighbours.

    Examples
    --------
    A bar on two knife edges, with an overhang:

    >>> import beammodes as bm
    >>> overhang = bm.Structure.of_beam(bm.Beam(7.5, 1.0, 1.0), "pinned-free", [bm.Station(6.2, math.inf)])
    >>> bm.structure_modes(overhang, 3).angular_frequency.round(6)
    array([0.248917, 0.868112, 1.49807 ])
    """
    count = whole_number("modes", modes, most=MOST_MODES)
    parts = checked_structure(structure).parts
    # Of many small matrices more threads would only wait for each other.
    with one_thread():
        model, squares, shapes = _converged(parts, count)
    omega = np.sqrt(squares)
    omega.flags.writeable = False
    inner = model.inner(squares, shapes)
    displacement = {name: shapes @ model.motions[i].T for i, name in enumerate(structure.joints)}
    return StructureModes(structure, omega, model.rigid, displacement, model.curves(shapes, inner))


def modes_below(structure: Structure, angular_frequency: float) -> int:
    """Return how many modes a structure has below a frequency [rad/s], those without energy among them.

    J = J₀ + negative eigenvalues of K(λ), with J₀ the modes below of stretches between clamps.

    Examples
    --------
    >>> import beammodes as bm
    >>> modes_below(bm.Structure.of_beam(bm.Beam.unit(), "free-free"), 23.0)      # 2 rigid, and 22.4
    3
    """
    omega = positive_real("angular_frequency", angular_frequency)
    parts = checked_structure(structure).parts
    whole = (1,) * len(parts.stretches)
    return StructureModel.of(parts, _divided(_own_squares(parts), omega**2, whole), POINTS).count(omega**2)


class _Element(NamedTuple):
    """A part of a stretch with length, EI over length and mass 1: e = (θ₂ - θ₁, v₂ - v₁ - θ₁).

    Attributes
    ----------
    stiffness : ndarray, shape (2, 2)
        R of the static energy |R e|² / 2.
    inertia : ndarray, shape (points, 4)
        A of the static shapes' kinetic energy |A x'|² / 2.
    square : ndarray, shape (modes,)
        λ_k.
    momentum : ndarray, shape (4, modes)
        c_k.
    x, weight : ndarray, shape (points,)
        Gauss-Legendre positions and weights.
    static, inner : ndarray, shape (points, 4), (points, modes)
        Deflections at x by the motions of the ends, and in the modes between clamps.
    static_slope, inner_slope : ndarray, shape (points, 4), (points, modes)
        Slopes by the motions of the ends, and in the modes between clamps if each has the energy 1/2.
    smooth : bool
        They are one polynomial.
    """

    stiffness: Floats
    inertia: Floats
    square: Floats
    momentum: Floats
    x: Floats
    weight: Floats
    static: Floats
    inner: Floats
    static_slope: Floats
    inner_slope: Floats
    smooth: bool


_DEFORMATION = np.array([[0.0, -1.0, 0.0, 1.0], [-1.0, -1.0, 1.0, 0.0]])


def _element_of(beam: Beam, points: int) -> _Element:
    plain = beam.is_uniform and not beam.has_rotary_inertia
    return _element(Beam.unit() if plain else beam, points)


@lru_cache(maxsize=256)
def _element(beam: Beam, points: int) -> _Element:
    """Return the element of a beam; its unit of length, stiffness and mass are the beam's own."""
    grid = section_grid(beam, points, least=4)
    root = np.sqrt(grid.weight * grid.stiffness)[:, None] * grid.curvature
    # In coordinates y with the energy yᵀy/2.
    from_energy = np.linalg.inv(np.linalg.qr(root)[1])
    curvature, slope, deflection = (of @ from_energy for of in (grid.curvature, grid.slope, grid.deflection))
    ends = np.array([grid.weight @ curvature, (grid.weight * (1.0 - grid.x)) @ curvature])
    stiffness = np.linalg.inv(np.linalg.cholesky(ends @ ends.T))
    static = ends.T @ (stiffness.T @ stiffness) @ _DEFORMATION
    bubbles = np.linalg.qr(ends.T, mode="complete")[0][:, 2:]
    heavy = np.sqrt(grid.weight * grid.mass)[:, None] * deflection
    turning = np.sqrt(grid.weight * grid.rotary)[:, None] * slope
    one, none = np.ones_like(grid.x), np.zeros_like(grid.x)
    carried = np.sqrt(grid.weight * grid.mass) * np.array([one, grid.x, none, none])
    turned = np.sqrt(grid.weight * grid.rotary) * np.array([none, one, none, none])
    inertia = np.vstack([carried.T + heavy @ static, turned.T + turning @ static])
    if not grid.rotary.any():
        inertia, turning = inertia[: len(grid.x)], turning[:0]
    shape, size, modes = np.linalg.svd(np.vstack([heavy, turning]) @ bubbles, full_matrices=False)
    known = size > 1e-13 * size[0]
    return _Element(
        stiffness,
        inertia,
        size[known] ** -2.0,
        inertia.T @ shape[:, known],
        grid.x,
        grid.weight,
        np.array([one, grid.x, none, none]).T + deflection @ static,
        deflection @ bubbles @ modes[known].T / size[known],
        np.array([none, one, none, none]).T + slope @ static,
        slope @ bubbles @ modes[known].T,
        len(grid.sizes) == 1,
    )


class _Span(NamedTuple):
    """A part of a stretch: where it is, its element, and what one is there."""

    member: str
    start: float
    length: float
    element: _Element
    stiff: float
    heavy: float


class StructureModel(NamedTuple):
    """K(λ) = K₀ - λ M₀ - λ² Σ_p Eᵀ C (Λ - λ)⁻¹ Cᵀ E  in coordinates z that obey all constraints, p the parts.

    Attributes
    ----------
    energy : ndarray, shape (rows, z)
        F of K₀ = Fᵀ F: one on the diagonal but for the rigid motions, which come first.
    mass : ndarray, shape (z, z)
        M₀.
    square : ndarray, shape (parts, inner)
        Λ: squared frequencies of each part between clamps.
    momentum : ndarray, shape (parts, 4, inner)
        C. Of parts with fewer inner modes the last are none.
    ends : ndarray, shape (parts, 4, z)
        E: motions of each part's ends.
    motions : tuple of ndarray, shape (3, z)
        Of each node: its displacement and rotation.
    rigid : int
        Motions without energy.
    spans : tuple of _Span
        The parts, in the order of their inner modes.
    """

    energy: Floats
    mass: Floats
    square: Floats
    momentum: Floats
    ends: Floats
    motions: tuple[Floats, ...]
    rigid: int
    spans: tuple[_Span, ...]

    @classmethod
    def of(cls, parts: Parts, divided: tuple[int, ...], points: int) -> StructureModel:
        """Return the model of stretches, each divided into so many equal parts."""
        builder = _Builder(parts, divided)
        for i, stretch in enumerate(parts.stretches):
            builder.add_stretch(i, stretch, points)
        for i in range(len(parts.nodes)):
            builder.add_node(i)
        return builder.model()

    def matrices(self, square: float) -> tuple[Floats, Floats]:
        """Return K(λ) and M(λ) = -dK/dλ."""
        near = self.square - square
        stiffness = self.energy.T @ self.energy - square * self.mass - self._coupled(square**2 / near)
        return stiffness, self.mass + self._coupled(square * (2.0 * self.square - square) / near**2)

    def _coupled(self, shares: Floats) -> Floats:
        """Return Σ Eᵀ C diag(shares) Cᵀ E."""
        momentum, ends = self.momentum, self.ends
        answers = (momentum * shares[:, None]) @ momentum.transpose(0, 2, 1) @ ends
        size = len(self.mass)
        return np.asarray(ends.reshape(-1, size).T @ answers.reshape(-1, size))

    def inner(self, square: Floats, vectors: Floats) -> Floats:
        """Return what shapes z at λ have of inner modes, shape (vectors, parts, inner)."""
        moved = vectors @ self.ends.transpose(0, 2, 1) @ self.momentum
        one = square[:, None, None]
        return np.asarray(one * moved.swapaxes(0, 1) / (self.square - one))

    def count(self, square: float) -> int:
        """Return how many modes lie below λ, rigid ones among them."""
        # K and M are diagonal together, and M is positive: as many ν are negative as eigenvalues of K.
        return int(np.sum(self.square < square)) + int(np.sum(self._pencil(square, shapes=False)[0] < 0.0))

    def quotients(self, square: Floats, vectors: Floats) -> tuple[Floats, Floats]:
        """Return Rayleigh's quotients of shapes at λ, from sums of squares, and the shapes' masses."""
        inner = self.inner(square, vectors)
        stored = np.sum((vectors @ self.energy.T) ** 2, axis=1) + np.sum(inner**2 * self.square, axis=(1, 2))
        moved = np.einsum("ni,ij,nj->n", vectors, self.mass, vectors)
        # Cᵀ E z is inner (Λ - λ)/λ.
        shared = 2.0 * (self.square / square[:, None, None] - 1.0) + 1.0
        moved = moved + np.sum(shared * inner**2, axis=(1, 2))
        return stored / moved, moved

    def scaled(self, square: Floats, vectors: Floats) -> Floats:
        """Return shapes z at their λ, a row each, of unit modal mass and with their sign."""
        moved = np.concatenate([vectors @ motion[:2].T for motion in self.motions], axis=1)
        size = signs_of_largest(moved) * np.sqrt(self.quotients(square, vectors)[1])
        return np.asarray(vectors / size[:, None])

    def curves(self, shapes: Floats, inner: Floats) -> tuple[Curve, ...]:
        """Return the deflections along all parts in modes z that have so much of inner modes."""
        curves = []
        for i, span in enumerate(self.spans):
            element, ends = span.element, shapes @ self.ends[i].T
            own = inner[:, i, : len(element.square)] / span.heavy
            along = ends @ element.static.T + own @ element.inner.T
            values = span.length * np.hstack([ends[:, :1], along, ends[:, 2:3]])
            x = span.start + span.length * np.concatenate(([0.0], element.x, [1.0]))
            curves.append(Curve(span.member, x, values, element.smooth))
        return tuple(curves)

    def _pencil(self, square: float, *, shapes: bool = True) -> tuple[Floats, Floats]:
        """Return ν and x of K(λ) x = ν M(λ) x, ascending; no x, at half the cost, without shapes.

        As M x = (K + s M) x / (ν + s), in which ν about zero have all digits however large others are:
        K(λ) + λ M(λ) is no less than K₀, since K is concave.
        """
        from scipy.linalg import eigh

        stiffness, mass = self.matrices(square)
        shift = 2.0 * square or 1.0 / np.trace(mass[self.rigid :, self.rigid :])
        try:
            found = eigh(mass, stiffness + shift * mass, eigvals_only=not shapes)
        except np.linalg.LinAlgError:
            raise ArithmeticError(_too_unlike("stiffness and mass matrices are not positive")) from None
        share, vectors = found if shapes else (found, np.zeros((len(mass), 0)))
        return np.asarray(1.0 / share[::-1] - shift), np.asarray(vectors[:, ::-1])

    def bounds(self, count: int) -> Floats:
        """Return upper bounds of the first λ above zero."""
        return self._pencil(0.0, shapes=False)[0][self.rigid : self.rigid + count]

    def roots(self, bounds: Floats) -> tuple[Floats, Floats]:
        """Return the first λ above zero, from upper bounds of them, and their shapes z, a row each.

        At any λ, λ + ν bounds all roots, those near it closely: each root begins where those before it ended.
        """
        bounds, found, shapes = bounds.copy(), [], []
        for n in range(len(bounds)):
            square = float(bounds[n])
            for _ in range(30):
                nu, vectors = self._pencil(square)
                bounds = np.minimum(bounds, square + nu[self.rigid : self.rigid + len(bounds)])
                shape = vectors[:, self.rigid + n]
                new = float(self.quotients(np.array([square]), shape[None])[0][0])
                step, square = abs(new / square - 1.0), new
                if step < 1e-14 or (step < 1e-7 and abs(nu[self.rigid + n]) < 1e-7 * square):
                    break
            found.append(square)
            shapes.append(shape)
        return np.array(found), np.array(shapes)


def _converged(parts: Parts, count: int) -> tuple[StructureModel, Floats, Floats]:
    """Return a model, its first squared frequencies and shapes, at a degree that is high enough."""
    model, squares, shapes = _solved(parts, count, POINTS)
    if not all(stretch.beam.is_uniform for stretch in parts.stretches):
        for points in (30, 42, 60):
            before = squares
            model, squares, shapes = _solved(parts, count, points)
            if np.max(np.abs(squares / before - 1.0)) < 2.0 * _AGREEMENT:
                break
        else:
            raise ArithmeticError(
                f"results do not agree to {_AGREEMENT:g} between polynomials of growing degree: does a "
                "property vary too much between the breaks of its beam?"
            )
    return model, squares, shapes


def _solved(parts: Parts, count: int, points: int) -> tuple[StructureModel, Floats, Floats]:
    """Return the model of a structure, its first squared frequencies, and their shapes z."""
    own, divided = _own_squares(parts), (1,) * len(parts.stretches)
    model = StructureModel.of(parts, divided, points)
    # A node inside a stretch has two coordinates.
    missing, square = model.rigid + 2 * count + 2 - len(model.mass), 1e-3 * float(model.square.min())
    while 2 * (sum(divided) - len(divided)) < missing:
        square *= 1.5
        divided = _divided(own, square, divided)
    if missing > 0:
        model = StructureModel.of(parts, divided, points)
    bounds = model.bounds(count)
    while (finer := _divided(own, 1.02 * float(bounds.max()), divided)) != divided:
        divided = finer
        model = StructureModel.of(parts, divided, points)
        bounds = model.bounds(count)
    squares, shapes = model.roots(bounds)
    _check_counts(model, squares)
    return model, squares, model.scaled(squares, shapes)


def _check_counts(model: StructureModel, squares: Floats) -> None:
    """Raise ArithmeticError unless as many modes are counted below each root as there are."""
    for n, square in enumerate(squares.tolist()):
        below, above = (model.count(square * (1.0 + near)) for near in (-_NEAR, _NEAR))
        if not below <= model.rigid + n < above:
            raise ArithmeticError(
                _too_unlike(
                    f"mode {n + 1} at {math.sqrt(square):.9g} rad/s must be the one of its number, but "
                    f"{below} and {above} modes are counted below and above it, {model.rigid} of them rigid "
                    "motions"
                )
            )


def _too_unlike(found: str) -> str:
    return (
        f"{found}: do the stiffnesses (EI/l³ of a short stretch is one) or masses of the structure differ by "
        "more than about 10 decades? What holds has stiffness math.inf, and what is all but at one place, or "
        "at an end, may be given there"
    )


def _own_squares(parts: Parts) -> list[float]:
    """Return the first squared frequency that each stretch has between two clamps."""
    return [
        float(_element_of(stretch.beam, POINTS).square[0]) * _unit_square(stretch.beam)
        for stretch in parts.stretches
    ]


def _divided(own: list[float], square: float, least: tuple[int, ...]) -> tuple[int, ...]:
    """Return into how many parts stretches must be divided so that none has an own mode below λ."""
    # 4.73 is the wavenumber of the first mode between clamps.
    many = tuple(
        max(fewest, math.ceil((square / first) ** 0.25 * 4.730 / _LONGEST))
        for first, fewest in zip(own, least, strict=True)
    )
    if sum(many) > _MOST_PARTS:
        raise ValueError(
            f"modes must be so few, and stations so far apart, that {_MOST_PARTS} parts of stretches do, got "
            f"{sum(many)} for a mode at {math.sqrt(square):g} rad/s"
        )
    return many


def _unit_square(beam: Beam) -> float:
    return beam.mean_bending_stiffness / beam.mean_mass_per_length / beam.length**4


class _Builder:
    """Rows of energy and mass in all coordinates: displacements of nodes, rotations, inner nodes."""

    def __init__(self, parts: Parts, divided: tuple[int, ...]) -> None:
        self.parts, self.divided = parts, divided
        self.unit = max(stretch.beam.length for stretch in parts.stretches)
        self.displacements = 2 * len(parts.nodes)
        self.size = self.displacements
        rigid = [False] * len(parts.nodes)
        sprung = list(rigid)
        for stretch in parts.stretches:
            for i, hinge in zip(stretch.nodes, stretch.hinges, strict=True):
                rigid[i] |= hinge == math.inf
                sprung[i] |= 0.0 < hinge < math.inf
        # Rotations of nodes: an index, or None where it is held or means nothing.
        self.light: list[int] = []
        self.rotation: list[int | None] = []
        for i, node in enumerate(parts.nodes):
            heavy = rigid[i] or node.has_turning_body
            held = node.rotational_stiffness == math.inf
            if held or not (heavy or sprung[i]):
                self.rotation.append(None)
                continue
            self.rotation.append(self._new())
            if not heavy:
                self.light.append(self.size - 1)
        self.energy: list[dict[int, float]] = []
        self.kinetic: list[dict[int, float]] = []
        self.ends: list[list[dict[int, float]]] = []
        self.spans: list[_Span] = []

    def _new(self, count: int = 1) -> int:
        self.size += count
        return self.size - count

    def _along(self, node: int, unit: tuple[float, float]) -> dict[int, float]:
        return {2 * node: unit[0] * self.unit, 2 * node + 1: unit[1] * self.unit}

    def _turn(self, node: int) -> dict[int, float]:
        index = self.rotation[node]
        return {} if index is None else {index: 1.0}

    def _end(self, stretch: Stretch, side: int) -> dict[int, float]:
        """Return the rotation of a stretch's end: its node's, or one of its own."""
        node, hinge = stretch.nodes[side], stretch.hinges[side]
        if hinge == math.inf:
            return self._turn(node)
        own = {self._new(): 1.0}
        if hinge:
            self.energy.append(_sum((math.sqrt(hinge), own), (-math.sqrt(hinge), self._turn(node))))
        return own

    def add_stretch(self, index: int, stretch: Stretch, points: int) -> None:
        """Add the parts of a stretch, and its mass along itself."""
        beam, count = stretch.beam, self.divided[index]
        start, end = stretch.nodes
        size = math.sqrt(beam.mean_mass_per_length * beam.length)
        self.kinetic.append(_sum((size, self._along(start, stretch.axis))))
        places = [self._along(start, stretch.normal)]
        turns = [self._end(stretch, 0)]
        for _ in range(count - 1):
            first = self._new(2)
            places.append({first: self.unit})
            turns.append({first + 1: 1.0})
        places.append(self._along(end, stretch.normal))
        turns.append(self._end(stretch, 1))
        for k in range(count):
            cut = beam.length * k / count, beam.length * (k + 1) / count
            part = part_of_beam(beam, *cut) if count > 1 else beam
            over = 1.0 / part.length
            x = [
                _sum((over, places[k])),
                turns[k],
                _sum((over, places[k + 1])),
                turns[k + 1],
            ]
            self._add_part(stretch.member, stretch.start + cut[0], part, x, points)

    def _add_part(
        self, member: str, start: float, part: Beam, x: list[dict[int, float]], points: int
    ) -> None:
        element = _element_of(part, points)
        stiff = math.sqrt(part.mean_bending_stiffness / part.length)
        heavy = math.sqrt(part.mean_mass_per_length * part.length) * part.length
        for row in (stiff * element.stiffness @ _DEFORMATION).tolist():
            self.energy.append(_sum(*zip(row, x, strict=True)))
        for row in (heavy * element.inertia).tolist():
            self.kinetic.append(_sum(*zip(row, x, strict=True)))
        self.ends.append(x)
        self.spans.append(_Span(member, start, part.length, element, stiff, heavy))

    def add_node(self, index: int) -> None:
        """Add the springs and the body of a node."""
        node, turn = self.parts.nodes[index], self._turn(index)
        for unit, stiffness in node.supports:
            if stiffness < math.inf:
                self.energy.append(_sum((math.sqrt(stiffness), self._along(index, unit))))
        if 0.0 < node.rotational_stiffness < math.inf and turn:
            self.energy.append(_sum((math.sqrt(node.rotational_stiffness), turn)))
        across, up = node.offset
        for unit, arm in (((1.0, 0.0), -up), ((0.0, 1.0), across)):
            row = _sum((1.0, self._along(index, unit)), (arm, turn))
            self.kinetic.append(_sum((math.sqrt(node.mass), row)))
        self.kinetic.append(_sum((math.sqrt(node.rotary_inertia), turn)))

    def model(self) -> StructureModel:
        """Return the model in coordinates that obey all constraints."""
        free = self._allowed()
        energy, kinetic = (self._matrix(rows) for rows in (self.energy, self.kinetic))
        energy, kinetic = energy @ free, kinetic @ free
        answers: Floats = np.zeros((len(self.light), free.shape[1]))
        if self.light:
            # Rotations without inertia follow the others at least energy.
            light = self._matrix(self.energy)[:, self.light]
            answers = np.negative(np.linalg.lstsq(light, energy, rcond=None)[0])
            energy = energy + light @ answers
        # Coordinates in which K₀ is one, but for the rigid motions, which come first.
        _, size, shapes = np.linalg.svd(energy)
        elastic = int(np.sum(size > _RIGID * size.max(initial=0.0)))
        rigid = energy.shape[1] - elastic
        # No stretch has more than three, and no node but one of its own, to turn: beyond that stiff springs
        # have hidden the bending of beams.
        if rigid > 3 * len(self.parts.stretches) + len(self.parts.nodes):
            raise ArithmeticError(_too_unlike(f"{rigid} motions seem to store no energy"))
        scale = np.concatenate([np.ones(rigid), 1.0 / size[:elastic]])
        change = np.vstack([shapes[elastic:], shapes[:elastic]]).T * scale
        energy = energy @ change
        energy[:, :rigid] = 0.0
        kinetic, free, answers = kinetic @ change, free @ change, answers @ change
        motions = tuple(self._motion(i, free, answers) for i in range(len(self.parts.nodes)))
        ends = np.array([self._matrix(x) @ free for x in self.ends])
        return StructureModel(
            energy, kinetic.T @ kinetic, *self._inner_modes(), ends, motions, rigid, tuple(self.spans)
        )

    def _inner_modes(self) -> tuple[Floats, Floats]:
        """Return Λ and C of all parts."""
        most = max(len(span.element.square) for span in self.spans)
        square, momentum = [], []
        for span in self.spans:
            more = most - len(span.element.square)
            square.append(np.pad(span.element.square * (span.stiff / span.heavy) ** 2, (0, more), "edge"))
            momentum.append(np.pad(span.heavy * span.element.momentum, ((0, 0), (0, more))))
        return np.array(square), np.array(momentum)

    def _motion(self, index: int, free: Floats, answers: Floats) -> Floats:
        rotation = self.rotation[index]
        moved = np.full((3, free.shape[1]), np.nan)
        moved[:2] = self.unit * free[2 * index : 2 * index + 2]
        if rotation is None:
            held = self.parts.nodes[index].rotational_stiffness == math.inf
            moved[2] = 0.0 if held else np.nan
        else:
            moved[2] = answers[self.light.index(rotation)] if rotation in self.light else free[rotation]
        return moved

    def _allowed(self) -> Floats:
        """Return a basis of the motions that stretches' lengths and supports allow, of no light rotation."""
        rows = [
            _sum((1.0, self._along(b, stretch.axis)), (-1.0, self._along(a, stretch.axis)))
            for stretch in self.parts.stretches
            for a, b in [stretch.nodes]
        ]
        for i, node in enumerate(self.parts.nodes):
            rows += [self._along(i, unit) for unit, stiffness in node.supports if stiffness == math.inf]
        constraints = self._matrix(rows)[:, : self.displacements] / self.unit
        _, size, right = np.linalg.svd(constraints)
        null = right[int(np.sum(size > 1e-9)) :].T
        others = [i for i in range(self.displacements, self.size) if i not in self.light]
        free = np.zeros((self.size, null.shape[1] + len(others)))
        free[: self.displacements, : null.shape[1]] = null
        free[others, null.shape[1] + np.arange(len(others))] = 1.0
        return free

    def _matrix(self, rows: list[dict[int, float]]) -> Floats:
        matrix = np.zeros((len(rows), self.size))
        for i, row in enumerate(rows):
            for j, value in row.items():
                matrix[i, j] += value
        return matrix


def _sum(*terms: tuple[float, dict[int, float]]) -> dict[int, float]:
    """Return a weighted sum of rows."""
    total: dict[int, float] = {}
    for factor, row in terms:
        for i, value in row.items():
            total[i] = total.get(i, 0.0) + factor * value
    return total
