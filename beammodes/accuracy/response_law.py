"""The law of a chain's response at a resonance: what an error of the frequency does, at a damping ratio."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.accuracy.errors import frequency_error
from beammodes.checks import positive_real, real_numbers, shown
from beammodes.numerics.arrays import keeps_labels
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike, ManyPairs
from beammodes.problem.loading import Load

__all__ = ["LARGEST_RATIO", "frequency_error_allowed", "response_error"]

#: The law is one of light damping.
LARGEST_RATIO = 0.2


@keeps_labels
def response_error(
    boundary: BoundaryLike | ManyPairs | Iterable[BoundaryLike] | NDArray[Any],
    *,
    segments: ArrayLike,
    mode: ArrayLike,
    damping_ratio: ArrayLike,
    rule: Any = "mitiguy",
    load: Load | None = None,
    beam: Beam | None = None,
    motion: str = "bending",
) -> complex | NDArray[np.complex128]:
    """Return the error of a chain's response at the beam's own resonance, light damping.

        H_chain / H_beam - 1 = 1/(1 - i e/ζ) - 1,     e = ω_chain / ω_beam - 1

    With h = 1 + this, |h| = 1/√(1 + (e/ζ)²) is what is left of the peak and arctan(e/ζ) the error of the
    phase. |e| = ζ/5 keeps 98 % of the peak, and the phase within 11 degrees.

    It is the law of one mode whose frequency is off, of first order in e and ζ: other modes, and the error
    of the chain's shape, of the order of e, come beside it. `frequency_response` tells all of it.

    Parameters
    ----------
    boundary, segments, mode, rule, load, beam, motion
        As of `frequency_error`, whose e this is.
    damping_ratio : float or array
        ζ of the mode, greater than 0 and at most 0.2. Broadcasts with the others.

    Returns
    -------
    complex or ndarray

    Raises
    ------
    TypeError, ValueError
        As `frequency_error`, or if a damping ratio is out of range.

    References
    ----------
    The receptance of one mode, 1/(ω_c² - ω² + 2iζ ω_c ω), at ω = ω_b, against the same with ω_c = ω_b:
    D. J. Ewins, Modal Testing (2000), chapter 2.

    Examples
    --------
    >>> import beammodes as bm
    >>> off = bm.response_error("clamped-free", segments=10, mode=1, damping_ratio=[0.01, 0.001])
    >>> abs(1 + off).round(3)                                              # what is left of the peak
    array([0.992, 0.622])
    """
    ratio = real_numbers("damping_ratio", damping_ratio)
    for each in ratio.ravel().tolist():
        _light_ratio(each)
    error = frequency_error(
        boundary, segments=segments, mode=mode, rule=rule, load=load, beam=beam, motion=motion
    )
    try:
        with np.errstate(over="ignore"):
            phase = np.arctan(np.asarray(error) / ratio)
    except ValueError:
        raise ValueError(
            f"damping_ratio must broadcast with the other arguments, got shape {ratio.shape} beside "
            f"{np.shape(error)}"
        ) from None
    # h = cos φ e^(iφ), less one without a difference.
    found = np.empty(phase.shape, dtype=np.complex128)
    found.real, found.imag = -(np.sin(phase) ** 2), np.sin(phase) * np.cos(phase)
    return found if found.ndim else complex(found)


def _light_ratio(given: object) -> float:
    """Return a damping ratio for which the law of the error at a resonance holds."""
    ratio = positive_real("damping_ratio", given)
    if ratio > LARGEST_RATIO:
        raise ValueError(
            f"damping_ratio must be at most {LARGEST_RATIO} (0.01 is 1 % of critical) for the law of a "
            f"resonance, got {shown(given)}"
        )
    return ratio


def frequency_error_allowed(tolerance: float, damping_ratio: float) -> float:
    """Return the |e| at which a chain has lost the part `tolerance` of the peak: ζ √(1/(1-tolerance)² - 1).

    Examples
    --------
    >>> round(frequency_error_allowed(0.02, 0.01), 6)                        # a fifth of ζ
    0.002031
    """
    return _light_ratio(damping_ratio) * math.sqrt(1.0 / (1.0 - tolerance) ** 2 - 1.0)
