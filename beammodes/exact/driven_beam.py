"""The exact response of a uniform beam that is driven at one frequency, by its waves of complex number.

With e^(iωt) damping turns  EI y'''' - T y'' = ω² (ρA y - ρI y'')  into

    EI g y'''' - T y'' = s (ρA y - ρI y''),     g = 1 + iη + iωβ,     s = ω² - iωα,

η being a loss factor, α and β those of Rayleigh: the undamped beam at λ = s/g, with the tension T/g, under
1/g of the load. Its four waves have complex numbers, k⁴ - (T/g - λ ρI)/EI k² = λ ρA/EI. Over a part of the
beam that is short beside them the state (y, y', M, V) is carried by the power series of

    y'''' = t y'' + l y + q,

in which nothing cancels, at ω = 0 neither; from part to part by `marched_states`, in which nothing that
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

from beammodes.checks import shown
from beammodes.exact.beam_theory import check_range, euler_bernoulli
from beammodes.exact.exact_beam import BeamModes
from beammodes.exact.spectral_beam import SpectralBeamModes
from beammodes.exact.supported_beam import SupportedBeamModes
from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex, marched_states
from beammodes.problem.beam import Beam
from beammodes.problem.driving import Drive, Reading
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.problem.profiles import mean_over

__all__ = ["DrivenBeam"]

# A part is so long, over the largest wavenumber; so many terms reach a double's last place on it.
_LONGEST, _TERMS = 2.0, 36
_MOST_PARTS = 2000
# So many frequencies at a time.
_AT_A_TIME = 512
#: Modes whose products of shapes are told: of a uniform beam without and with anything at its ends.
_MOST_MODES = 4000


@dataclass(frozen=True, eq=False)
class DrivenBeam:
    """A uniform beam, what drives it and what is read of it.

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
        if not self.beam.is_uniform:
            raise ValueError(
                f"beam must be uniform for its exact response, got {shown(self.beam)}: take a Chain of it, "
                "and see how its response changes with more segments"
            )
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
        found = np.empty((len(square), len(self.reading.x), self.drive.columns), dtype=np.complex128)
        cut = self._cut(np.max(np.abs(square / stiffness), initial=0.0), np.max(np.abs(1 / stiffness)))
        for start in range(0, len(square), _AT_A_TIME):
            part = slice(start, start + _AT_A_TIME)
            found[part] = self._solved(square[part] / stiffness[part], 1.0 / stiffness[part], *cut)
        return found / stiffness[:, None, None]

    @cached_property
    def most_modes(self) -> int:
        """How many modes `products` tells at most."""
        return _MOST_MODES

    def products(self, modes: int) -> tuple[Floats, Floats]:
        """Return ω_n and what each mode reads times how it is driven, shape (modes, readings, drives)."""
        found = euler_bernoulli(self.beam, self.boundary, modes, load=self.load)
        read = found.shape(self.reading.x, int(self.reading.kind == "rotation"))
        if self.drive.is_base:
            driven = self._momentum(found)[:, None]
        else:
            driven = found.shape(self.drive.x, int(self.drive.kind == "moment"))
        return found.angular_frequency, read[:, :, None] * driven[:, None, :]

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
        tight = softness * (float(self.load.axial_force) * flexibility / unit) - square * turning
        lengths, which = np.diff(marks) / parts * count, np.repeat(np.arange(len(parts)), parts)
        carried, sources = _carried(square * heavy, tight, lengths)
        slope = unit * (kind == "turn")
        line = np.concatenate([[0.0], np.cumsum(lengths[which])]) * slope if slope else np.ones(count + 1)
        at_base = np.array(
            [heavy * line[:-1], np.full(count, heavy * slope), np.full(count, turning * slope)]
        )
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
            if self.drive.is_base:
                added[:, :, 0] = np.einsum("nij,jn->ni", sources[f, which], at_base)
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
