"""Chains in twist and stretch whose end springs make one mode exact, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beammodes.checks import Shown, whole_number
from beammodes.exact.axial_beam import axial_wavenumber
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd

__all__ = ["AxialTuned"]


@dataclass(frozen=True, repr=False)
class AxialTuned(Shown):
    """Chains in twist or stretch with one mode exact; `mode_tuned(mode, motion="twist")` makes it.

        cot φ = 2 tan(q/2) (1/g + w - 1/2),        q = 2 arcsin(β/2N),

    is a hinge of weight w at an end with g = K/N - 4 J N sin²(q/2), ∞ at a fixed one; the mode asks for the
    φ that  Nq - φ_left - φ_right = kπ  leaves to it. Between a fixed and a free end, and with half of it
    between two fixed ones,

        w = ½ [1 + tan(β - N q)/tan(q/2)].

    The weights of all fixed ends are tuned alike. Without one: those of both ends where they are alike, else
    the first that is not free; between free ends there is none, and nothing is tuned. Other modes keep
    order 2.

    Parameters
    ----------
    mode : int
        n, the elastic mode that it is tuned to.

    Examples
    --------
    >>> weights = AxialTuned(1).axial_weights(AxialBoundary.of("fixed-free"), 10)
    >>> [round(float(weight), 6) for weight in weights[:3]]
    [0.489722, 1.0, 1.0]
    """

    mode: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "mode", whole_number("mode", self.mode, most=10**4))

    @property
    def name(self) -> str:
        """Name in tables, such as "mode_tuned(2)"."""
        return f"mode_tuned({self.mode})"

    def axial_weights(self, boundary: AxialBoundary, segments: int) -> list[float]:
        """Return the flexibility weights of the hinges, left to right, shape (hinges,).

        NaN, which no chain takes, where the chain is too short to have the mode's frequency inside its band.
        """
        ends = (boundary.left, boundary.right)
        weights = [1.0] * (segments - 1)
        beta = float(axial_wavenumber([boundary], np.asarray(0), self.mode))
        tuned = _tuned(ends)
        if beta >= 2.0 * segments:
            at_ends = [math.nan, math.nan]
        else:
            q = 2.0 * math.asin(beta / 2.0 / segments)
            # N q - kπ, of which the beam's φ⁰ take β - kπ: no turns of β are subtracted from those of q.
            turn = segments * q - (self.mode - 1 + boundary.rigid_body_modes) * math.pi
            slope = 2.0 * math.tan(q / 2.0)
            softness = [_softness(end, q, segments) for end in ends]
            others = sum(
                math.atan2(1.0, slope * softness[k]) if softness[k] < math.inf else 0.0
                for k in (0, 1)
                if k not in tuned
            )
            share = (turn - others) / max(1, len(tuned))
            at_ends = [
                0.5 + 1.0 / math.tan(share) / slope - softness[k] if k in tuned else 0.5 for k in (0, 1)
            ]
        left, right = ([] if end.is_free else [at_ends[k]] for k, end in enumerate(ends))
        return [*left, *weights, *right]


def _softness(end: AxialEnd, q: float, segments: int) -> float:
    """Return 1/g: 0 at a fixed end, infinite at a free one."""
    if end.is_fixed:
        return 0.0
    stiffness = end.stiffness / segments - 4.0 * end.inertia * segments * math.sin(q / 2.0) ** 2
    return 1.0 / stiffness if stiffness else math.inf


def _tuned(ends: tuple[AxialEnd, AxialEnd]) -> list[int]:
    fixed = [k for k in (0, 1) if ends[k].is_fixed]
    held = [k for k in (0, 1) if not ends[k].is_free]
    return fixed or (held if ends[0] == ends[1] else held[:1])
