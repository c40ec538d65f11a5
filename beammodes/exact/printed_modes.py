"""What every answer of Euler-Bernoulli theory has: frequencies, one line to print, the theory's own error."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.checks import row_shown
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary

__all__ = ["EulerBernoulliModes", "Theory", "theory_words"]

Floats = NDArray[np.float64]

#: What `euler_bernoulli` hands its answers: ω_Timoshenko/ω - 1 when asked, None if the section is unknown;
#: and what it takes for granted, in words.
Theory: TypeAlias = tuple[Callable[[], Floats | None], tuple[str, ...]]


class _Answer(Protocol):
    """What `EulerBernoulliModes` needs of the class that it serves."""

    @property
    def beam(self) -> Beam: ...

    @property
    def boundary(self) -> Boundary: ...

    @property
    def theory(self) -> Theory | None: ...

    @property
    def angular_frequency(self) -> Floats: ...

    @property
    def frequency(self) -> Floats: ...

    def shape(self, x: ArrayLike, derivative: int = 0) -> Floats: ...


class EulerBernoulliModes:
    """What the three kinds of answers have in common, whichever way their beam was solved."""

    __slots__ = ()

    @property
    def frequency(self: _Answer) -> Floats:
        """ω / 2π, shape (modes,) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    @property
    def theory_error(self: _Answer) -> Floats:
        """ω_Timoshenko/ω - 1, shape (modes,) [-]: how far this theory itself is off, found when asked.

        NaN where the beam's section is not known (`Beam.from_section` knows it, or give `radius_of_gyration`
        or ρI), from Timoshenko's cut-off frequency on, beyond mode 100, and on a turning hub.
        `theory_assumed` says what is assumed.
        """
        found = self.theory[0]() if self.theory else None
        return np.full(len(self.angular_frequency), np.nan) if found is None else found

    @property
    def theory_assumed(self: _Answer) -> tuple[str, ...]:
        """What `theory_error` takes for granted, in words; empty if nothing."""
        return self.theory[1] if self.theory else ()

    def __repr__(self: _Answer) -> str:
        relative = self.angular_frequency / self.beam.frequency_unit
        return (
            f"{type(self).__name__}({self.boundary}: {row_shown(self.frequency, '{:.4g}', 'Hz')}; "
            f"{theory_words(self.theory, relative)})"
        )

    def slope(self: _Answer, x: ArrayLike) -> Floats:
        """Return dφ/dx, shape (modes, *x.shape) [kg^(-1/2) m^(-1)]: `shape(x, derivative=1)`."""
        return self.shape(x, derivative=1)


def theory_words(theory: Theory | None, relative: Floats) -> str:
    """Return what an answer says of the theory's own error.

    Parameters
    ----------
    theory : Theory, optional
    relative : ndarray
        ω √(ρA L⁴/EI) of the modes.

    Examples
    --------
    >>> theory_words(None, np.array([3.516]))
    'theory error not known without a section: 1 % or less if it is a solid one, assumed, no higher than L/11'
    """
    try:
        errors = theory[0]() if theory else None
    except (ValueError, ArithmeticError):
        return "theory error not found"
    if errors is None:
        slenderness = 6.0 * np.sqrt(float(relative[-1])) if len(relative) else 0.0
        return (
            "theory error not known without a section: 1 % or less if it is a solid one, assumed, "
            f"no higher than L/{slenderness:.2g}"
        )
    told = row_shown(100.0 * errors, "{:+.3g}", "%")
    assumed = f", assumed: {', '.join(theory[1])}" if theory and theory[1] else ""
    return f"theory error {told} (Timoshenko's beam{assumed})"
