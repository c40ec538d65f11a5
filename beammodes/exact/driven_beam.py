"""The exact response of a beam that is driven at one frequency, by its waves of complex number.

With e^(iωt) damping turns  EI y'''' - T y'' = ω² (ρA y - ρI y'')  into

    EI g y'''' - T y'' = s (ρA y - ρI y''),     g = 1 + iη + iωβ,     s = ω² - iωα,

η being a loss factor, α and β those of Rayleigh: the undamped beam at λ = s/g, with the tension T/g, under
1/g of the load. Its four waves have complex numbers, k⁴ - (T/g - λ ρI)/EI k² = λ ρA/EI. Over a part of the
beam that is short beside them the state (y, y', M, V) is carried by the power series of

    y'''' = t y'' + l y + q,

in which nothing cancels, at ω = 0 neither; where the beam varies, by Gauss's collocation, on ever more parts
until two results agree. From part to part it is carried by `marched_states`, in which nothing that
fades is lost. Signs: M = EI y'', V = -M' + (T - λ ρI) y', and an end's spring pulls with V = K y at x = 0.

Sources: R. E. D. Bishop and D. C. Johnson, The Mechanics of Vibration (1960), chapter 7, for receptances of
uniform beams; L. Cremer, M. Heckl and E. E. Ungar, Structure-Borne Sound (1973), for complex wavenumbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beammodes.exact.beam_theory import check_range, euler_bernoulli
from beammodes.exact.exact_beam import BeamModes
from beammodes.exact.spectral_beam import SpectralBeamModes
from beammodes.exact.spectral_grid import Grid, legendre_integral, legendre_of_values, section_grid
from beammodes.exact.supported_beam import SupportedBeamModes
from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex, marched_states
from beammodes.problem.beam import Beam
from beammodes.problem.driving import Drive, Reading
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.problem.profiles import mean_over, value_at

__all__ = ["DrivenBeam"]

# A part is so long, over the largest wavenumber; so many terms reach a double's last place on it.
_LONGEST, _TERMS = 2.0, 36
_MOST_PARTS = 2000
# So many frequencies at a time.
_AT_A_TIME = 512
#: Modes whose products of shapes are told: of a uniform beam and of one that varies.
_MOST_MODES, _MOST_VARYING = 4000, 40
# Of beams that vary: Gauss points on a part, parts times frequencies at a time, how often parts are halved,
# and how well two results agree, relative to the largest at a frequency.
_STAGES, _STAGES_HELD, _MOST_HALVINGS, _AGREEMENT = 8, 3000, 5, 1e-10


@dataclass(frozen=True, eq=False)
class DrivenBeam:
    """A beam, what drives it and what is read of it.

    Attributes
    ----------
    beam : Beam
    boundary : Boundary
    load : Load
        An axial force.
    drive : Drive
    reading : Reading
    """

    beam: Beam
    boundary: Boundary
    load: Load
    drive: Drive
    reading: Reading

    def __post_init__(self) -> None:
        if not self.load.is_axial:
            raise ValueError(f"load must be an axial force here, got {self.load}")
        check_range(self.beam, self.boundary, self.load)
        if self.load.axial_force:
            # Refuses a load that buckles the beam.
            euler_bernoulli(self.beam, self.boundary, 1, load=self.load)

    def receptance(self, square: Complex, stiffness: Complex) -> Complex:
        """Return responses to unit drives, shape (frequencies, readings, drives).

        Of a base: the motion relative to it, for a base acceleration of -1 at unit inertia, that is
        Σ φ_n ∫ρA y_b φ_n / (ω_n² - λ)  without damping.

        Parameters
        ----------
        square, stiffness : ndarray of complex, shape (frequencies,)
            s and g.
        """
        marks, parts = self._cut(
            np.max(np.abs(square / stiffness), initial=0.0), np.max(np.abs(1 / stiffness))
        )
        found = self._on_parts(square, stiffness, marks, parts)
        if self.beam.is_uniform:
            return found
        for _ in range(_MOST_HALVINGS):
            before, parts = found, 2 * parts
            found = self._on_parts(square, stiffness, marks, parts)
            size = np.abs(found).max(axis=(1, 2))
            if (np.abs(found - before).max(axis=(1, 2)) <= _AGREEMENT * size).all():
                return found
        raise ArithmeticError(
            f"responses do not agree to {_AGREEMENT:g} between ever shorter parts of the beam: does a "
            "property vary too much between its breaks, or is a frequency too near an undamped resonance?"
        )

    def _on_parts(
        self, square: Complex, stiffness: Complex, marks: Floats, parts: NDArray[np.int64]
    ) -> Complex:
        found = np.empty((len(square), len(self.reading.x), self.drive.columns), dtype=np.complex128)
        at_a_time = _AT_A_TIME if self.beam.is_uniform else max(1, _STAGES_HELD // int(parts.sum()))
        for start in range(0, len(square), at_a_time):
            some = slice(start, start + at_a_time)
            found[some] = self._solved(square[some] / stiffness[some], 1.0 / stiffness[some], marks, parts)
        return found / stiffness[:, None, None]

    @cached_property
    def drifts(self) -> bool:
        """Whether some motion stores nothing, so that a force at rest would carry the beam away."""
        return euler_bernoulli(self.beam, self.boundary, 1, load=self.load).rigid_body_modes > 0

    @cached_property
    def most_modes(self) -> int:
        """How many modes `products` tells at most."""
        return _MOST_MODES if self.beam.is_uniform else _MOST_VARYING

    def products(self, modes: int) -> tuple[Floats, Floats]:
        """Return ω_n and what each mode reads times how it is driven, shape (modes, readings, drives)."""
        if self.beam.is_uniform:
            found = euler_bernoulli(self.beam, self.boundary, modes, load=self.load)
        else:
            found = self._first_modes
        read = found.shape(self.reading.x, int(self.reading.kind == "rotation"))
        if self.drive.is_base:
            driven = (self._momentum if self.beam.is_uniform else self._integrated)(found)[:, None]
        else:
            driven = found.shape(self.drive.x, int(self.drive.kind == "moment"))
        return found.angular_frequency[:modes], (read[:, :, None] * driven[:, None, :])[:modes]

    @cached_property
    def _first_modes(self) -> BeamModes | SupportedBeamModes | SpectralBeamModes:
        """The modes of a beam that varies: all at once, as one of them costs as much."""
        return euler_bernoulli(self.beam, self.boundary, _MOST_VARYING, load=self.load)

    def _momentum(self, found: BeamModes | SupportedBeamModes | SpectralBeamModes) -> Floats:
        """Return  ∫ ρA y_b φ + ρI y_b' φ' dx  of all modes, bodies at the ends included, shape (modes,).

        A straight y_b stores nothing, so that ω² times it is what the supports do on it.
        """
        square, turns = found.angular_frequency**2, self.drive.kind == "turn"
        tight = float(self.load.axial_force) - square * self._rotary
        total = np.zeros(len(square))
        for end, side in ((self.boundary.left, 1), (self.boundary.right, -1)):
            place = 0.0 if side > 0 else self.beam.length
            y, slope, bent, rate = (found.shape([place], order)[:, 0] for order in range(4))
            mass, inertia, offset = map(float, end.moving_body)
            body = square * mass * (y - side * offset * slope)
            if not end.holds_deflection:
                force = float(end.translational_stiffness) * y
            else:
                force = side * (tight * slope - self.beam.mean_bending_stiffness * rate) + body
            if not end.holds_rotation:
                moment = float(end.rotational_stiffness) * slope
            else:
                moment = side * (self.beam.mean_bending_stiffness * bent - offset * body)
                moment = moment + square * inertia * slope
            total += force * (place if turns else 1.0) + moment * turns
        return total / square

    def _integrated(self, found: BeamModes | SupportedBeamModes | SpectralBeamModes) -> Floats:
        """Return the same of a beam that varies, by Gauss's rule."""
        beam, turns = self.beam, self.drive.kind == "turn"
        grid = section_grid(beam, 24 + 4 * len(found.angular_frequency), least=6)
        x, weight = grid.x * beam.length, grid.weight * beam.mean_mass_per_length * beam.length
        total = found.shape(x) @ (weight * grid.mass * (x if turns else 1.0))
        if turns and beam.has_rotary_inertia:
            total += found.shape(x, 1) @ (weight * grid.rotary * beam.length**2)
        for end, side in ((self.boundary.left, -1), (self.boundary.right, 1)):
            place = 0.0 if side < 0 else beam.length
            y, slope = (found.shape([place], order)[:, 0] for order in range(2))
            mass, inertia, offset = map(float, end.moving_body)
            at = place + side * offset if turns else 1.0
            total += mass * at * (y + side * offset * slope) + inertia * slope * turns
        return np.asarray(total)

    @cached_property
    def _sections(self) -> Grid:
        """The edges between which a beam that varies is smooth, and what it is there."""
        return section_grid(self.beam, 16, least=4)

    @property
    def _rotary(self) -> float:
        return mean_over(self.beam.rotary_inertia_per_length, self.beam.length)

    def _cut(self, square: float, softness: float) -> tuple[Floats, NDArray[np.int64]]:
        """Return where something acts or is read, over L, and into how many parts each stretch is cut."""
        beam = self.beam
        wave = abs(float(self.load.axial_force)) * softness + square * self._rotary
        half = wave * beam.length**2 / beam.mean_bending_stiffness / 2
        longest = math.sqrt(half + math.sqrt(half**2 + square / beam.frequency_unit**2))
        marks = np.concatenate([[0.0, 1.0], self.reading.x / beam.length, self.drive.x / beam.length])
        if not beam.is_uniform:
            grid = self._sections
            marks = np.concatenate([marks, grid.edges])
            longest *= float(np.max(grid.mass / grid.stiffness)) ** 0.25
        marks = np.unique(marks)
        parts = np.maximum(1.0, np.ceil(np.diff(marks) * longest / _LONGEST))
        if parts.sum() > _MOST_PARTS + len(marks):
            raise ValueError(
                "frequency, band or axial_force of load must be lower: there would be "
                f"{longest / math.pi:.3g} half-waves on the beam, which is cut into {_MOST_PARTS} parts"
            )
        return marks, parts.astype(np.int64)

    def _solved(self, square: Complex, softness: Complex, marks: Floats, parts: NDArray[np.int64]) -> Complex:
        """Return responses at λ and 1/g, for g = 1; lengths are over h, a part's mean length."""
        beam, count, kind = self.beam, int(parts.sum()), self.drive.kind
        unit = beam.length / count
        flexibility = unit**3 / beam.mean_bending_stiffness
        heavy, turning = beam.mean_mass_per_length * unit * flexibility, self._rotary * flexibility / unit
        pull = softness * (float(self.load.axial_force) * flexibility / unit)
        lengths, which = np.diff(marks) / parts * count, np.repeat(np.arange(len(parts)), parts)
        slope = unit * (kind == "turn")
        line = np.concatenate([[0.0], np.cumsum(lengths[which])]) * slope if slope else np.ones(count + 1)
        if beam.is_uniform:
            carried, sources = _carried(square * heavy, pull - square * turning, lengths)
            rest = np.ones(count)
            at_base = np.array([heavy * line[:-1], heavy * slope * rest, turning * slope * rest])
            inflow = np.einsum("fnij,jn->fni", sources[:, which], at_base) if self.drive.is_base else None
        else:
            lengths, which = lengths[which], np.arange(count)
            edges = np.concatenate([[0.0], np.cumsum(lengths)]) * unit
            along = _Properties.of(beam, edges[:-1], lengths, unit)
            carried, inflow = _collocated(square, pull, lengths, along, line, slope)
        starts = np.concatenate([[0], np.cumsum(parts)])
        reads, acts = (
            starts[np.searchsorted(marks, each.x / beam.length)] for each in (self.reading, self.drive)
        )
        # A force takes V down by itself, a moment M.
        load = np.array([0, 0, 0, -flexibility] if kind == "force" else [0, 0, -flexibility / unit, 0])
        ends = (_UnitEnd.of(self.boundary.left, 1, unit), _UnitEnd.of(self.boundary.right, -1, unit))
        found = np.empty((len(square), len(reads), self.drive.columns), dtype=np.complex128)
        for f, one in enumerate(square * flexibility):
            added = np.zeros((count, 4, self.drive.columns), dtype=np.complex128)
            given = np.zeros((2, 2, self.drive.columns), dtype=np.complex128)
            steps = carried[f, which]
            if self.drive.is_base and inflow is not None:
                added[:, :, 0] = inflow[f]
                given[:, :, 0] = [flexibility * end.driven(line[-i], slope) for i, end in enumerate(ends)]
            for column, at in enumerate(acts.tolist()):
                # In front of the part that begins there; behind the last one at the far end.
                added[min(at, count - 1), :, column] = steps[at] @ load if at < count else load
            left, right = (end.conditions(one, flexibility) for end in ends)
            states = marched_states(steps, added, left, right, given)
            found[f] = states[reads, int(self.reading.kind == "rotation")]
        return found / unit if self.reading.kind == "rotation" else found


@dataclass(frozen=True)
class _UnitEnd:
    """An end whose rotations are over 1/h, on the left side (1) or the right one (-1).

    It pulls with  V = ± (K y - λ m u),  M = ± (K θ - λ J θ) + a λ m u,  u = y ∓ a θ.
    """

    holds: tuple[bool, bool]
    springs: tuple[float, float]
    mass: float
    inertia: float
    offset: float
    side: int

    @classmethod
    def of(cls, end: End, side: int, unit: float) -> _UnitEnd:
        mass, inertia, offset = map(float, end.moving_body)
        springs = float(end.translational_stiffness), float(end.rotational_stiffness) / unit**2
        holds = end.holds_deflection, end.holds_rotation
        return cls(holds, springs, mass, inertia / unit**2, offset / unit, side)

    def conditions(self, square: complex, flexibility: float) -> Complex:
        """Return both conditions on (y, θ, M, V), shape (2, 4), at λ h³/EI."""
        side, arm, moved = self.side, self.offset, square * self.mass
        rows = np.eye(2, 4, dtype=np.complex128)
        if not self.holds[0]:
            rows[0] = [-side * (self.springs[0] * flexibility - moved), -arm * moved, 0.0, 1.0]
        if not self.holds[1]:
            turned = self.springs[1] * flexibility - square * self.inertia
            rows[1] = [-arm * moved, -side * turned + side * arm**2 * moved, 1.0, 0.0]
        return rows

    def driven(self, base: float, slope: float) -> Floats:
        """Return what the inertia of the body on a base adds to the conditions, over h³/EI."""
        pulled = self.mass * (base - self.side * self.offset * slope)
        turned = -self.side * self.inertia * slope + self.offset * pulled
        return np.where(self.holds, 0.0, [-self.side * pulled, turned])


def _carried(light: Complex, tight: Complex, lengths: Floats) -> tuple[Complex, Complex]:
    """Return how states are carried over parts, and what loads on them add.

    y'''' = t y'' + l y + q_0 + q_1 x,  l being `light` and t `tight`.

    Returns
    -------
    steps : ndarray, shape (frequencies, lengths, 4, 4)
        Of (y, y', M, V).
    sources : ndarray, shape (frequencies, lengths, 4, 3)
        States from nothing by q_0 = 1, by q_1 = 1, and by the inertia of sections on a base that turns.
    """
    # Derivatives at the part's beginning, for each of the first four, q_0 and q_1 equal to one.
    derivatives = np.zeros((_TERMS + 4, 6, len(light)), dtype=np.complex128)
    derivatives[range(4), range(4)] = 1.0
    for n in range(_TERMS):
        derivatives[n + 4] = tight * derivatives[n + 2] + light * derivatives[n]
        if n < 2:
            derivatives[n + 4, 4 + n] += 1.0
    powers = np.zeros((len(lengths), 4, _TERMS + 4))
    for i in range(4):
        for m in range(i, _TERMS + 4):
            powers[:, i, m] = lengths ** (m - i) / math.factorial(m - i)
    grown = np.einsum("uim,mjf->fuij", powers, derivatives, optimize=True)
    # V = t y' - y''' at both ends of the part.
    pull = tight[:, None, None]
    grown[..., 1] += pull * grown[..., 3]
    grown[..., 3] *= -1.0
    grown[:, :, 3] = pull * grown[:, :, 1] - grown[:, :, 3]
    turned = grown[..., 3].copy()
    turned[..., 3] -= 1.0
    return grown[..., :4], np.concatenate([grown[..., 4:], turned[..., None]], axis=3)


@dataclass(frozen=True, eq=False)
class _Properties:
    """A beam that varies, at the Gauss points of its parts, shape (parts, points).

    Attributes
    ----------
    soft : ndarray
        Mean EI over EI.
    heavy, turning : ndarray
        What ρA and ρI are of V' and M', over λ.
    place : ndarray
        Gauss points on a part of length one, shape (points,).
    """

    soft: Floats
    heavy: Floats
    turning: Floats
    place: Floats

    @classmethod
    def of(cls, beam: Beam, starts: Floats, lengths: Floats, unit: float) -> _Properties:
        place = 0.5 * (1.0 + np.polynomial.legendre.leggauss(_STAGES)[0])
        x = starts[:, None] + unit * lengths[:, None] * place
        stiffness = beam.mean_bending_stiffness
        flexibility = unit**3 / stiffness
        return cls(
            stiffness / value_at(beam.bending_stiffness, x),
            value_at(beam.mass_per_length, x) * unit * flexibility,
            value_at(beam.rotary_inertia_per_length, x) * flexibility / unit,
            place,
        )


def _collocated(
    square: Complex, pull: Complex, lengths: Floats, along: _Properties, line: Floats, slope: float
) -> tuple[Complex, Complex]:
    """Return how states are carried over parts, and what a base's motion adds, by Gauss's collocation.

    y' = θ,  θ' = M/EI,  M' = -V + (T - λ ρI) θ - ρI φ_b,  V' = -ρA (λ y + y_b),  for all parts at all λ: with
    eight points on a part the error falls as its length to the 16th power.

    Returns
    -------
    steps : ndarray, shape (frequencies, parts, 4, 4)
    inflow : ndarray, shape (frequencies, parts, 4)
    """
    size = _STAGES
    node, weight = np.polynomial.legendre.leggauss(size)
    within = 0.5 * np.polynomial.legendre.legval(node, legendre_integral(legendre_of_values(size))).T
    rates = np.zeros((len(square), *along.soft.shape, 4, 4), dtype=np.complex128)
    one = square[:, None, None]
    rates[..., 0, 1], rates[..., 1, 2], rates[..., 2, 3] = 1.0, along.soft, -1.0
    rates[..., 2, 1] = pull[:, None, None] - one * along.turning
    rates[..., 3, 0] = -one * along.heavy
    # The rates at all points of a part: K_i = A_i (y + h Σ a_ij K_j) + f_i.
    whole = -np.einsum("p,ij,fpiab->fpiajb", lengths, within, rates)
    whole = whole.reshape(len(square), len(lengths), 4 * size, 4 * size) + np.eye(4 * size)
    base = line[:-1, None] + lengths[:, None] * along.place * slope
    given = np.zeros((len(square), len(lengths), size, 4, 5), dtype=np.complex128)
    given[..., :4] = rates
    given[..., 2, 4], given[..., 3, 4] = -along.turning * slope, -along.heavy * base
    found = np.linalg.solve(whole, given.reshape(len(square), len(lengths), 4 * size, 5))
    found = found.reshape(given.shape)
    steps = np.einsum("p,i,fpiab->fpab", lengths, 0.5 * weight, found)
    return steps[..., :4] + np.eye(4), steps[..., 4]
