"""Advice: which rule, how many segments, which springs and which step a wanted accuracy costs least with."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.end_numbers import in_beam_units
from beammodes.accuracy.errors import ToleranceOutOfReach, frequency_error, segments_needed
from beammodes.accuracy.statics import LOADS, beam_statics, chain_statics
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, AnyRule, Layout, layout_of
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.vibration.integrators import INTEGRATORS, find_integrator, stability_limit
from beammodes.vibration.stability import highest_angular_frequency

__all__ = ["Recommendation", "recommend"]

#: Integrators whose step the highest mode limits, which makes the cost.
_LIMITED = tuple(
    name for name, each in INTEGRATORS.items() if each.springs == "explicit" and not each.variable_step
)
#: A rule that needs more segments than this is not recommended: nobody would simulate the chain.
MOST_SEGMENTS = 10_000


@dataclass(frozen=True, eq=False)
class Recommendation:
    """One way to reach an accuracy, and what it costs.

    Attributes
    ----------
    rule : str
    segments : int
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
        Left to right.
    largest_error : float
        Largest |e| of the wanted modes, as a fraction.
    static_error : dict from str to float
        Relative error of the tip's deflection (of the middle's where the tip is held) under each load of
        `statics.LOADS`; empty where the ends let the beam move rigidly.
    highest_angular_frequency : float [rad/s]
    stable_time_step : float [s]
        For the integrator asked for.
    cost : float
        Segments times steps in one period of the first mode: the work of a simulation whose effort per step
        grows in proportion to the segments.
    """

    rule: str
    segments: int
    joint_stiffness: NDArray[np.float64]
    largest_error: float
    static_error: dict[str, float]
    highest_angular_frequency: float
    stable_time_step: float
    cost: float


def recommend(
    boundary: BoundaryLike,
    tolerance: float,
    modes: int = 1,
    *,
    beam: Beam | None = None,
    rules: Iterable[AnyRule] | None = None,
    integrator: str = "rk4",
) -> list[Recommendation]:
    """Return, for each rule, the shortest chain within a frequency tolerance, the cheapest first.

        cost = N · T₁ / h,   T₁ = 2π/ω₁,   h = (2√2 or 2) / ω_max

    Parameters
    ----------
    boundary : boundary
    tolerance : float
        Largest |e| of the first `modes` frequencies, as a fraction less than 0.5, from this N on.
    modes : int
    beam : Beam, optional
        Uniform, for springs, steps and numbers of ends in its units. Without one all are multiples of EI/L,
        √(ρA L⁴/EI), ρA L and so on.
    rules : iterable of rules, optional
        All of `RULES` by default; one that cannot meet the tolerance with 10,000 segments is left out.
    integrator : str
        One of `INTEGRATORS` of fixed step that takes springs explicitly; the chain is undamped.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no rule meets the tolerance.

    Examples
    --------
    >>> for way in recommend("clamped-free", tolerance=0.01, modes=3)[:3]:
    ...     print(way.rule, way.segments, f"{way.static_error['tip_moment']:+.4f}")
    gregory 8 -0.0026
    half_stub_corrected 9 +0.0010
    gregory2 11 -0.0014
    """
    pair, unit = Boundary.of(boundary), Beam.unit() if beam is None else beam
    integrator = find_integrator(integrator, _LIMITED).name
    in_beam_units(pair, unit)
    ways: list[Recommendation] = []
    refusal = ValueError("rules must name at least one rule, got none")
    for record in [layout_of(rule) for rule in (RULES if rules is None else rules)]:
        try:
            count = segments_needed(pair, tolerance, modes, record, beam=unit)
        except ToleranceOutOfReach as error:
            refusal = error
            continue
        if count > MOST_SEGMENTS:
            refusal = ValueError(
                f"tolerance must be larger: rule {record.name} needs {count} segments for it"
            )
            continue
        ways.append(_way(unit, pair, count, modes, record, integrator))
    if not ways:
        raise refusal
    return sorted(ways, key=lambda way: (way.cost, way.segments))


def _way(
    beam: Beam, boundary: Boundary, segments: int, modes: int, record: Layout, integrator: str
) -> Recommendation:
    chain = Chain(beam, boundary, segments, record)
    highest = highest_angular_frequency(chain)
    step = stability_limit(integrator) / highest
    first = float(euler_bernoulli(beam, boundary, 1).angular_frequency[0])
    errors = frequency_error(
        boundary, segments=segments, mode=np.arange(1, modes + 1), rule=record, beam=beam
    )
    return Recommendation(
        rule=record.name,
        segments=segments,
        joint_stiffness=chain.joint_stiffness,
        largest_error=float(np.max(np.abs(errors))),
        static_error=_static_errors(chain),
        highest_angular_frequency=highest,
        stable_time_step=step,
        cost=segments * 2 * math.pi / first / step,
    )


def _static_errors(chain: Chain) -> dict[str, float]:
    """Return relative errors of the tip's deflection, or of the middle's where the ends hold the tip."""
    ends = chain.boundary
    if ends.rigid_body_modes or ends.left.is_elastic or ends.right.is_elastic:
        return {}
    assert chain.beam is not None
    found = {}
    for load in LOADS:
        ours, exact = chain_statics(chain, load), beam_statics(chain.beam, chain.boundary, load)
        for quantity in ("deflection", "midspan_deflection"):
            reference = getattr(exact, quantity)
            if math.isfinite(reference) and reference:
                found[load] = getattr(ours, quantity) / reference - 1
                break
    return found
