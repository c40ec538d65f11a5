"""The law of the error of chains of structures: the quadrature of every stretch, for one mode.

As for a single beam (`law`), with f = EI φ''² on each stretch, φ the exact mode of unit modal mass, and ω²
twice the energy that all of it and the springs store:

    e = -1/(2 ω²) Σ_stretches Σ_ends Σ_k d_k h^(k+1) f⁽ᵏ⁾,

d_k of the weights that the rule has for what each end feels. Inside, what a chain of equal springs does to
order h² cancels; the zigzag between rods and curve, whose mean square is h⁴ φ''²/720, remains:

    e = -h⁴/1440 ∫ ρA φ''² dx.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from beammodes.chains.rules import HIGHEST_ORDER, Rule
from beammodes.chains.structure_chain import moments_at_ends
from beammodes.checks import shown, whole_number
from beammodes.exact.structure_judge import MOST_MODES, StructureModes, structure_modes
from beammodes.numerics.arrays import Floats
from beammodes.problem.ends import ENDS
from beammodes.problem.structure import Stretch, Structure

__all__ = ["structure_law_terms"]

#: Modes nearer than this have no shapes of their own.
_DOUBLE = 1e-7
#: Of Krylov's series, enough for parts of a stretch in which the judge solves.
_TERMS = 10


def structure_law_terms(
    structure: Structure, mode: int, rule: Rule, zigzag: float
) -> tuple[float, list[tuple[int, float]]]:
    """Return the largest wavenumber of a mode times the length of all members, and e = Σ c/N^p as (p, c).

    Parameters
    ----------
    structure : Structure
        Of uniform beams, or steps of them, without rotary inertia of their sections.
    mode : int
    rule : Rule
    zigzag : float
        What the rule's rods and springs have inside in place of the -1/1440 above.

    Examples
    --------
    A cantilever's is (1 - σβ)/3 under `mitiguy`, wherever it is cut:

    >>> from beammodes.chains.rules import RULES
    >>> from beammodes.problem.beam import Beam
    >>> bar = Structure.of_beam(Beam.unit(), "clamped-free")
    >>> terms = structure_law_terms(bar, 1, RULES["mitiguy"], -1 / 1440)[1]
    >>> round(sum(value for power, value in terms if power == 2), 6)
    -0.125502
    """
    parts = structure.parts
    if not all(one.beam.is_uniform and not one.beam.has_rotary_inertia for one in parts.stretches):
        raise ValueError(
            "boundary must be a structure of uniform beams, or steps of them, without rotary inertia for a "
            f"law, got {structure}"
        )
    number = whole_number("mode", mode, most=MOST_MODES - 1)
    exact = structure_modes(structure, number + 1)
    omega = float(exact.angular_frequency[number - 1])
    near = np.abs(np.delete(exact.angular_frequency, number - 1) / omega - 1.0)
    if near.min() < _DOUBLE:
        raise ValueError(
            f"mode must have a frequency of its own for a law, got {shown(mode)}, whose {omega:g} rad/s two "
            "modes share"
        )
    whole = sum(stretch.beam.length for stretch in parts.stretches)
    lumped = float(rule.rotary_inertia - Fraction(1, 12))
    terms: list[tuple[int, float]] = []
    longest = 0.0
    for stretch, words in zip(parts.stretches, moments_at_ends(parts), strict=True):
        waves = _Waves.of(exact, number - 1, stretch)
        longest = max(longest, waves.wavenumber * whole)
        for word, side in zip(words, (0, 1), strict=True):
            derivatives = waves.moment_squared(side)
            for k, (constant, per_segment) in enumerate(rule.end_defects(ENDS[word].statics)):
                scale = -derivatives[k] / (2.0 * omega**2)
                terms.append((k + 1, float(constant) * scale * whole ** (k + 1)))
                terms.append((k + 2, float(per_segment) * scale * whole ** (k + 2) / stretch.beam.length))
        terms.append((2, -lumped / 2.0 * waves.mean_square(1) * whole**2))
        if not lumped:
            terms.append((4, zigzag * waves.mean_square(2) * whole**4))
    return longest, terms


class _Waves(NamedTuple):
    """A mode on a uniform stretch: on each part a sum of functions whose fourth derivative is k⁴ of them.

    K_j(x) = Σ_i k^(4i) x^(4i+j)/(4i+j)!, j = 0 to 3: Krylov's functions, each the derivative of the next.
    """

    stretch: Stretch
    wavenumber: float
    parts: tuple[tuple[float, Floats], ...]

    @classmethod
    def of(cls, exact: StructureModes, index: int, stretch: Stretch) -> _Waves:
        """Return the waves of a mode: what agrees with its deflections."""
        beam = stretch.beam
        inertia = math.sqrt(beam.mean_mass_per_length / beam.mean_bending_stiffness)
        wavenumber = math.sqrt(float(exact.angular_frequency[index]) * inertia)
        parts, small = [], 1e-9 * beam.length
        for curve in exact.curves:
            inside = stretch.start - small < curve.x[0] and curve.x[-1] < stretch.start + beam.length + small
            if curve.member == stretch.member and inside:
                x = curve.x - curve.x[0]
                found = np.linalg.lstsq(_krylov(wavenumber, x, 0), curve.values[index], rcond=None)[0]
                parts.append((float(x[-1]), found))
        return cls(stretch, wavenumber, tuple(parts))

    def moment_squared(self, side: int) -> list[float]:
        """Return f and its derivatives at an end, along the inward direction."""
        length, size = self.parts[-side]
        place, sign = np.array([side * length]), (-1) ** side
        phi = [
            sign**k * float((_krylov(self.wavenumber, place, k) @ size)[0])
            for k in range(2, HIGHEST_ORDER + 2)
        ]
        stiffness = self.stretch.beam.mean_bending_stiffness
        return [
            stiffness * sum(math.comb(k, i) * phi[i] * phi[k - i] for i in range(k + 1))
            for k in range(HIGHEST_ORDER)
        ]

    def mean_square(self, order: int) -> float:
        """Return ρA ∫ (φ⁽ᵏ⁾)² dx."""
        node, weight = np.polynomial.legendre.leggauss(24)
        total = 0.0
        for length, size in self.parts:
            values = _krylov(self.wavenumber, 0.5 * length * (1.0 + node), order) @ size
            total += 0.5 * length * float(weight @ values**2)
        return self.stretch.beam.mean_mass_per_length * total


def _krylov(wavenumber: float, x: Floats, order: int) -> Floats:
    """Return derivatives of Krylov's functions, a column each; k x must not be large."""
    columns = []
    for j in range(4):
        power, factor = j - order, 1.0
        while power < 0:
            power, factor = power + 4, factor * wavenumber**4
        columns.append(np.zeros_like(x))
        for i in range(_TERMS):
            term = (wavenumber * x) ** (4 * i) * x**power / float(math.factorial(4 * i + power))
            columns[-1] += factor * term
    return np.array(columns).T
