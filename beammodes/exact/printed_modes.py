"""How modes of a beam are printed, and what an answer of Euler-Bernoulli theory says of the theory itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import row_shown

__all__ = ["Theory", "theory_errors_of", "theory_words"]

Floats = NDArray[np.float64]

#: What `euler_bernoulli` hands its answers: ω_Timoshenko/ω - 1 when asked, None if the section is unknown;
#: and what it takes for granted, in words.
Theory: TypeAlias = tuple[Callable[[], Floats | None], tuple[str, ...]]


def theory_errors_of(theory: Theory | None, count: int) -> Floats:
    """Return the errors of the theory itself, NaN where nothing tells them."""
    found = theory[0]() if theory else None
    return np.full(count, np.nan) if found is None else found


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
