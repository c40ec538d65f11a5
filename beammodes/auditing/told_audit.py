"""What all audits say in the same words: verdict, report, the line at a prompt, matter and damping."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from beammodes.auditing.judged_pieces import SOLVED
from beammodes.checks import Shown, percent, row_shown
from beammodes.numerics.arrays import Floats

__all__ = [
    "ToldAudit",
    "audit_line",
    "listed_errors",
    "listed_parts",
    "meets_or_not",
    "off_the_beam",
    "told_ratios",
]

#: A smaller relative difference of lengths, masses or inertias is not reported.
_SAME = 1e-6


class ToldAudit(Shown):
    """What an audit has beside its own numbers: whether it meets its tolerance, and how that is said."""

    __slots__ = ()

    angular_frequency: Floats
    errors: Floats
    tolerance: float
    given: tuple[str, ...]
    assumed: tuple[str, ...]

    @property
    def meets(self) -> bool:
        """True if all judged modes exist and their errors are within the tolerance."""
        return bool((np.abs(self.errors) <= self.tolerance).all())

    def _verdict(self, chain: str, errors: str) -> str:
        return f"{chain} {meets_or_not(self)}: {errors}"

    def _report(self, found: Iterable[str], better: Iterable[str]) -> str:
        lines = [f"given: {line}" for line in self.given] + [f"assumed: {line}" for line in self.assumed]
        return "\n".join([*lines, *found, *(f"  {line}" for line in better)])


def meets_or_not(audit: ToldAudit) -> str:
    """Return whether an audit meets its tolerance, as a sentence says it."""
    return f"{'meets' if audit.meets else 'does not meet'} {100 * audit.tolerance:.3g} %"


def audit_line(audit: ToldAudit, of: str, name: str = "") -> str:
    """Return the line that a prompt shows of an audit: frequencies, the verdict, of what, and errors."""
    frequency = row_shown(audit.angular_frequency / (2.0 * math.pi), "{:.4g}", "Hz")
    errors = row_shown(100 * audit.errors, "{:+.3g}", "%")
    return f"{name or type(audit).__name__}({frequency}; {meets_or_not(audit)}, {of} {errors})"


def listed_errors(errors: Floats) -> str:
    """Return errors as text, those of modes that are not there as such.

    Examples
    --------
    >>> listed_errors(np.array([0.1, np.nan]))
    'errors +10 %, no such mode'
    """
    return f"errors {listed_parts(errors)}"


def listed_parts(parts: Floats) -> str:
    """Return relative differences of modes as text.

    Examples
    --------
    >>> listed_parts(np.array([-0.02, 0.0]))
    '-2 %, 0 %'
    """
    return ", ".join("no such mode" if math.isnan(e) else percent(e, rounding=SOLVED) for e in parts.tolist())


def off_the_beam(parts: Mapping[str, float]) -> list[str]:
    """Return a sentence for each relative difference from the beam that is one.

    Examples
    --------
    >>> off_the_beam({"length": 0.0, "mass": 0.05})
    ["mass is +5 % off the beam's"]
    """
    return [
        f"{name} is {percent(part)} off the beam's{_in_other_units(part)}"
        for name, part in parts.items()
        if abs(part) > _SAME
    ]


def _in_other_units(part: float) -> str:
    """Return what is said of a thousand times what is due, or a thousandth: mm, g or t, most likely."""
    for times, words in ((1000.0, "1000 times it"), (0.001, "a thousandth of it")):
        if abs((1 + part) / times - 1) < 0.05:
            return f" ({words}: in other units?)"
    return ""


def told_ratios(ratios: Floats, joints: str) -> str:
    """Return the sentence on what dampers do to the modes.

    Examples
    --------
    >>> told_ratios(np.array([0.01, 1.2]), "hinges")
    'the dampers of its hinges give the modes damping ratios of 0.01, 1.2 (overdamped: does not swing)'
    """
    told = [
        "no such mode"
        if math.isnan(value)
        else f"{value:.4g}" + (" (overdamped: does not swing)" if value >= 1 else "")
        for value in ratios.tolist()
    ]
    return f"the dampers of its {joints} give the modes damping ratios of {', '.join(told)}"
