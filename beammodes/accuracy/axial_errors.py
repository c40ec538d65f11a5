"""Frequency errors of chains of uniform beams in twist and stretch, looked up; and their law.

Both motions obey one equation, so that in multiples of k/L and m L one error serves both. The doors are
`frequency_error`, `error_dataset`, `segments_needed` and `error_law` with `motion="twist"` or `"stretch"`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.axial_chain import AxialLayout, axial_layout_of
from beammodes.chains.rules import Layout, Rule
from beammodes.checks import distinct, shown, together, whole_number, whole_numbers
from beammodes.closed_form.axial_chains import axial_errors, axial_frequencies
from beammodes.closed_form.plain_axial_chains import PlainAxialChains, plain_axial_chains
from beammodes.closed_form.uniform_chains import MAX_MODE, MAX_SEGMENTS
from beammodes.exact.axial_beam import axial_wavenumber, uniform_numbers
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd, distinct_axial
from beammodes.problem.beam import Beam
from beammodes.problem.ends import check_multiples
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.motions import Motion, motion_named

__all__ = [
    "axial_error_with_units",
    "axial_exact_frequencies",
    "axial_frequency_error",
    "axial_in_multiples",
    "axial_law_terms",
    "axial_numbers",
    "axial_with_numbers",
    "no_load",
    "zigzag_coefficient",
]


def no_load(load: Load | None, motion: Motion) -> None:
    """Refuse a load, of which twist and stretch of a straight beam know nothing.

    Raises
    ------
    ValueError
        If there is one.
    """
    if checked_load(load) != Load():
        raise ValueError(f"load must be left out for motion {motion.name}, got {shown(load)}")


def axial_in_multiples(boundary: Any, beam: Beam | None, motion: str | Motion) -> Any:
    """Return one boundary or an array of them in multiples of k/L and m L, as closed forms take them.

    With a `beam` their numbers are in its units; without one they are multiples already.

    Examples
    --------
    >>> shaft = Beam(2.0, 1.0, 1.0, torsional_stiffness=6.0, polar_inertia_per_length=0.5)
    >>> print(axial_in_multiples("fixed-free(inertia=3)", shaft, "twist"))
    fixed-free(inertia=3.0)
    """
    if beam is None:
        check_multiples(boundary)
    pairs, which = distinct_axial(boundary, motion)
    if beam is not None:
        stiffness, inertia = uniform_numbers(beam, motion_named(motion))
        pairs = [pair.scaled(stiffness / beam.length, inertia * beam.length) for pair in pairs]
    if not which.ndim:
        return pairs[0]
    found = np.empty(len(pairs), dtype=object)
    found[:] = pairs
    return found[which]


def axial_frequency_error(boundary: Any, segments: Any, mode: Any, rule: Any, motion: str | Motion) -> Any:
    """Return what `frequency_error` does in twist and stretch; ends' numbers are multiples of k/L and m L.

    Examples
    --------
    >>> round(axial_frequency_error("fixed-free", 10, 1, "half_stub", "twist"), 9)
    -0.001027767
    """
    pairs, which = distinct_axial(boundary, motion)
    records, chosen = distinct("rule", rule, (str, Layout, AxialLayout), axial_layout_of)
    counts = whole_numbers("segments", segments, most=MAX_SEGMENTS)
    modes = whole_numbers("mode", mode, most=MAX_MODE)
    which, counts, modes, chosen = together(boundary=which, segments=counts, mode=modes, rule=chosen)
    flat = [array.ravel() for array in (which, chosen, counts, modes)]
    error = np.full(which.size, np.nan)
    for r, record in enumerate(records):
        at = np.flatnonzero(flat[1] == r) if len(records) > 1 else np.arange(which.size)
        ends, count, number = flat[0][at], flat[2][at], flat[3][at]
        if isinstance(record, Rule) and record.has_equal_springs:
            error[at] = axial_errors(record, pairs, ends, count, number)
            continue
        for k, n in sorted({*zip(ends.tolist(), count.tolist(), strict=True)}):
            here = (ends == k) & (count == n)
            beta = axial_wavenumber(pairs, ends[here], number[here])
            error[at[here]] = axial_frequencies(record, pairs[k], n, number[here]) / beta - 1.0
    return error.reshape(which.shape) if which.ndim else float(error[0])


def axial_error_with_units(
    boundary: Any,
    segments: Any,
    mode: Any,
    rule: Any,
    load: Load | None,
    beam: Beam | None,
    motion: str | Motion,
) -> Any:
    """Return what `frequency_error` does in twist and stretch.

    Examples
    --------
    >>> rod = Beam(0.5, 1.0, 1.0, torsional_stiffness=80.0, polar_inertia_per_length=8e-6)
    >>> args = ("fixed-free(inertia=2e-6)", 10, 1, "half_stub", None, rod, "twist")             # kg m²
    >>> round(axial_error_with_units(*args), 7)
    -0.0007527
    """
    kind = motion_named(motion)
    no_load(load, kind)
    one = isinstance(segments, int | np.integer) and isinstance(mode, int | np.integer)
    if one and isinstance(boundary, str | AxialBoundary) and isinstance(rule, str | Rule):
        chains = _plain(boundary, rule, kind.name)
        if chains is not None:
            if beam is not None:
                uniform_numbers(beam, kind)
            count = whole_number("segments", segments, most=MAX_SEGMENTS)
            return chains.error(count, whole_number("mode", mode, most=MAX_MODE))
    return axial_frequency_error(axial_in_multiples(boundary, beam, kind), segments, mode, rule, kind)


@lru_cache(maxsize=1024)
def _plain(boundary: str | AxialBoundary, rule: str | Rule, motion: str) -> PlainAxialChains | None:
    """Return the chains of a rule with equal springs inside between plain ends; None of others."""
    pair, record = AxialBoundary.of(boundary, motion), axial_layout_of(rule)
    plain = all(end.is_fixed or end.is_free for end in (pair.left, pair.right))
    if not plain or not isinstance(record, Rule) or not record.has_equal_springs:
        return None
    return plain_axial_chains(record, pair)


def axial_exact_frequencies(boundary: AxialBoundary, mode: NDArray[np.int64]) -> Floats:
    """Return the beam's angular frequencies of these modes, for L = k = m = 1.

    Examples
    --------
    >>> axial_exact_frequencies(AxialBoundary.of("fixed-fixed"), np.array([2])) == 2 * np.pi
    array([ True])
    """
    return axial_wavenumber([boundary], np.zeros(np.shape(mode), dtype=np.intp), mode)


def axial_numbers(motion: Motion) -> Mapping[str, tuple[str, str]]:
    """Return the names of the ends' numbers, each with its unit without a beam and in SI.

    Examples
    --------
    >>> from beammodes.problem.motions import MOTIONS
    >>> axial_numbers(MOTIONS["stretch"])["right_mass"]
    ('rho A L', 'kg')
    """
    units = {
        "stiffness": (f"{motion.stiffness_symbol} / L", motion.spring_unit),
        motion.body: (f"{motion.inertia_symbol} L", motion.body_unit),
    }
    return {f"{side}_{name}": unit for side in ("left", "right") for name, unit in units.items()}


def axial_with_numbers(boundary: AxialBoundary, numbers: Mapping[str, float]) -> AxialBoundary:
    """Return a boundary with numbers, named as in `axial_numbers`, in the place of its own.

    Examples
    --------
    >>> print(axial_with_numbers(AxialBoundary.of("fixed-free"), {"right_inertia": 0.5}))
    fixed-free(inertia=0.5)
    """
    ends: dict[str, AxialEnd] = {"left": boundary.left, "right": boundary.right}
    for name, value in numbers.items():
        side, _, number = name.partition("_")
        field = "stiffness" if number == "stiffness" else "inertia"
        numbers_of_end = {"stiffness": ends[side].stiffness, "inertia": ends[side].inertia}
        ends[side] = AxialEnd(**numbers_of_end | {field: math.inf if value == math.inf else value})
    return AxialBoundary(ends["left"], ends["right"], boundary.motion)


# The law: e ~ -(β²/24N²) U_beam/U - ½ Σ d_k f⁽ᵏ⁾/(N^(k+1) F),  f = T²,  F = ∫f + Σ T_s²/K.
#
# By Rayleigh's principle, as in bending: springs at hinges are a quadrature of the flexibility ∫T²/k, of
# which a rule's d_k say what is wrong at an end. Inside, pieces that move as a whole have too little kinetic
# energy where u turns within a piece and, at order 2, nothing offsets it as a rod's own inertia does in
# bending: -β²/24 of what share of the energy the beam has beside the springs at its ends.


def axial_law_terms(pair: AxialBoundary, mode: int, rule: Rule) -> tuple[float, list[tuple[int, float]]]:
    """Return β and the terms (p, c) of the law  e ~ Σ c/N^p,  of the lowest two powers.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> beta, terms = axial_law_terms(AxialBoundary.of("fixed-free"), 1, RULES["half_stub"])
    >>> [round(24 * sum(c for p, c in terms if p == power) / beta**2, 12) for power in (1, 2)]
    [0.0, -1.0]
    """
    index = whole_number("mode", mode, most=10**6)
    beta = float(axial_wavenumber([pair], np.asarray(0), index))
    # u = cos(βx - φ) from either end: T² = β² sin²(βx - φ), in units in which the wave's amplitude is 1.
    phases = [_phase(end, beta) for end in (pair.left, pair.right)]
    inside = 0.5 * beta**2 * (1.0 - (math.sin(2 * phases[0]) + math.sin(2 * (beta - phases[0]))) / (2 * beta))
    springs = sum(
        end.stiffness * math.cos(phase) ** 2
        for end, phase in zip((pair.left, pair.right), phases, strict=True)
        if 0.0 < end.stiffness < math.inf
    )
    whole = inside + springs
    zigzag = zigzag_coefficient(rule.inside, lambda square: 4.0 * square)
    terms = [(2, (-1.0 / 24.0 + zigzag) * beta**2 * inside / whole)]
    for end, phase in zip((pair.left, pair.right), phases, strict=True):
        square = [beta**2 * math.sin(phase) ** 2, -(beta**3) * math.sin(2 * phase)]
        for k, (constant, per_segment) in enumerate(rule.end_defects(end.statics)[:2]):
            scale = -square[k] / (2.0 * whole)
            terms += [(k + 1, float(constant) * scale), (k + 2, float(per_segment) * scale)]
    return beta, [(power, value) for power, value in terms if power <= 2]


def zigzag_coefficient(inside: Sequence[Fraction], squared_frequency: Callable[[Floats], Floats]) -> float:
    """Return  -½ Σ_G |p_G|²/λ_G  over the harmonics G = 2πl/m, l = 1..m-1, of m weights that repeat.

    They, p_G = Σ_j p_j e^(-iGj)/m, scatter the torque, force or moment of a wave into zigzags, which chains
    of equal springs would have at the squared frequency λ, told as a function of sin²(G/2).

    Examples
    --------
    >>> round(zigzag_coefficient([Fraction(4, 3), Fraction(2, 3)], lambda square: 4.0 * square), 9)    # -1/72
    -0.013888889
    """
    period = len(inside)
    harmonics = np.fft.fft([float(weight) for weight in inside]) / period
    square = np.sin(np.pi * np.arange(1, period) / period) ** 2
    return float(-0.5 * (np.abs(harmonics[1:]) ** 2 / squared_frequency(square)).sum())


def _phase(end: AxialEnd, beta: float) -> float:
    if end.is_fixed:
        return math.pi / 2
    return math.atan2(end.stiffness - end.inertia * beta * beta, beta)
