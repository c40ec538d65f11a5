"""What an exported file says about itself, and the time step that an engine needs for it."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beammodes import __version__
from beammodes.accuracy.comparison import SlendernessWarning, chain_errors
from beammodes.chains.chain import Chain
from beammodes.checks import choice, positive_real, shown
from beammodes.dynamics.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import highest_angular_frequency

__all__ = ["ENGINE_INTEGRATORS", "Facts", "digits", "engine_step", "facts_about", "one_line"]

#: For MuJoCo's integrators, which treat springs alike but for RK4: the largest stable h ω, and p and c of the
#: relative frequency error (h ω)^p / c.
ENGINE_INTEGRATORS: dict[str, tuple[float, int, float]] = {
    "RK4": (2 * math.sqrt(2), 4, 120.0),
    "Euler": (2.0, 2, 24.0),
    "implicit": (2.0, 2, 24.0),
    "implicitfast": (2.0, 2, 24.0),
}
#: Relative error that the default step may add to the first frequency.
STEP_ERROR = 2e-4
_REPORTED = 3
_STEP_WITHOUT_MODES = 0.002


@dataclass(frozen=True)
class Facts:
    """First frequencies of a chain [rad/s], their errors where it has a beam, and a bound on the highest."""

    chain: Chain
    first: tuple[float, ...]
    errors: tuple[float, ...]
    highest: float

    def lines(self, turned: bool = False) -> list[str]:
        """Return what a reader of the file should know of the chain, one fact a line."""
        chain, kept = self.chain, []
        if chain.beam is not None:
            beam = chain.beam
            means = f"EI {beam.mean_bending_stiffness:.6g} N m2, {beam.mean_mass_per_length:.6g} kg/m"
            uniform = "" if beam.is_uniform else " on average"
            kept.append(f"beam: length {beam.length:.6g} m, {means}{uniform}")
        kept.append(f"ends: {chain.boundary.name}" + (", seen from the right one" if turned else ""))
        if chain.rule is not None:
            kept.append(f"rule: {chain.rule.name}, {chain.segments} segments")
        else:
            kept.append(f"pieces: {chain.pieces}, given one by one")
        shown_first = ", ".join(f"{omega / (2 * math.pi):.8g}" for omega in self.first)
        kept.append(f"natural frequencies of the chain: {shown_first or 'none'} Hz, undamped")
        if self.errors:
            kept.append(f"their errors against the exact beam: {', '.join(map(_percent, self.errors))}")
        kept.append(
            "units: m, kg, s and rad, if the beam was given in them; else the consistent set it was in"
        )
        return [f"written by beammodes {__version__}", *map(one_line, kept)]


def facts_about(chain: Chain) -> Facts:
    """Solve for the frequencies of a chain that its file announces.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> print(facts_about(Chain(Beam.unit(), "clamped-free", 6)).lines()[-2])
    their errors against the exact beam: -0.35175 %, -3.4226 %, -6.1362 %
    """
    first = solve_modes(linearize(chain), _REPORTED).angular_frequency.tolist()
    errors: list[float] = []
    if chain.beam is not None and first:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SlendernessWarning)
            errors = chain_errors(chain, len(first)).tolist()
    return Facts(chain, tuple(first), tuple(errors), highest_angular_frequency(chain))


def engine_step(
    facts: Sequence[Facts], integrator: str, damping: Damping | None, timestep: float | None
) -> float:
    """Return `timestep`, or half the stable one, less if the first frequency would be off by over 0.02 %.

    Raises
    ------
    TypeError, ValueError
        If the integrator is unknown, or `timestep` is no number or beyond the limit of stability.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> engine_step([facts_about(Chain(Beam.unit(), "clamped-free", 10))], "RK4", None, None)
    0.00211
    """
    largest, power, constant = ENGINE_INTEGRATORS[choice("integrator", integrator, ENGINE_INTEGRATORS)]
    given = None if timestep is None else positive_real("timestep", timestep)
    rate = max(_fastest(each, damping) for each in facts)
    if not rate:
        return given or _STEP_WITHOUT_MODES
    limit = largest / rate
    if given is not None:
        if given >= limit:
            raise ValueError(
                f"timestep must be less than {limit:.3g}, where {integrator} becomes unstable, "
                f"got {shown(timestep)}"
            )
        return given
    first = max(each.first[0] for each in facts if each.first)
    return _rounded_down(min(limit / 2, (STEP_ERROR * constant) ** (1 / power) / first))


def _fastest(facts: Facts, damping: Damping | None) -> float:
    """Return a bound on the size of the chain's eigenvalues; joints damp no mode more than by their worst."""
    own = (damping or Damping()).joint_damping(facts.chain)
    worst = max(
        (damping or Damping()).stiffness, float(np.max(own / facts.chain.joint_stiffness, initial=0.0))
    )
    ratio = worst * facts.highest / 2
    return facts.highest * (ratio + math.hypot(1.0, ratio))


def _rounded_down(step: float) -> float:
    unit = math.floor(math.log10(step)) - 2
    return float(f"{math.floor(step / 10.0**unit)}e{unit}")


def _percent(error: float) -> str:
    return f"{100 * error:+.5g} %" if abs(error) > 1e-10 else "below 1e-8 %"


def digits(value: float) -> str:
    """Return a number in the 17 significant digits that keep it.

    Examples
    --------
    >>> digits(1 / 3), digits(2.0)
    ('0.33333333333333331', '2')
    """
    return f"{value:.17g}"


def one_line(text: str) -> str:
    """Return `text` as every format's comments can carry it: printable, on one line.

    Examples
    --------
    >>> one_line("a rule\\nof two --> lines")
    'a rule of two - -> lines'
    """
    plain = "".join(c if c.isprintable() else " " for c in text)
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return plain
