"""Facts on a chain for the head of an exported file: frequencies, their errors, damping ratios, units."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable

import numpy as np

from beammodes.accuracy.chain_against_beam import SlendernessWarning, chain_errors, stout_remark
from beammodes.accuracy.chain_against_rod import rod_errors
from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import percent
from beammodes.equations.equilibria import Equilibrium, EquilibriumNotFound, find_equilibrium
from beammodes.exporters.unit_systems import UNIT_SYSTEMS
from beammodes.problem.loading import Load
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping, modes_with_ratios
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.modes_in_space import spatial_modes

__all__ = ["facts_about", "facts_about_rod", "one_line"]

_REPORTED = 3
#: Longer chains take more than some seconds to find their shape at rest.
_MAX_RESTING = 150


def facts_about(
    chain: Chain,
    damping: Damping | None = None,
    load: Load | None = None,
    units: str | None = None,
    *,
    turned: bool = False,
    at: Equilibrium | None = None,
) -> list[str]:
    """Return lines on a chain: its beam, ends and rule, its first frequencies and their errors.

    With a `load` also the frequencies about the shape at rest under it. Dampers keep their forces there, not
    their ratio: a chain that hangs is stiffer, and less damped. `turned` means that the file begins at the
    right end; `at` is the shape at rest if it is known.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> print(facts_about(Chain(Beam.unit(), "clamped-free", 6))[-2])
    their errors against the exact beam: -0.35175 %, -3.4226 %, -6.1362 %
    """
    beam, lines = chain.beam, []
    if beam is not None:
        system = UNIT_SYSTEMS[units or "SI"]
        lines.append(
            f"beam: length {beam.length:.6g} {system.length}, "
            f"EI {beam.mean_bending_stiffness:.6g} {system.bending_stiffness}, "
            f"{beam.mean_mass_per_length:.6g} {system.mass_per_length}"
            f"{'' if beam.is_uniform else ' on average'}{'' if units else ', if it was given in SI units'}"
        )
    lines.append(f"ends: {chain.boundary.name}" + (", seen from the right one" if turned else ""))
    if chain.rule is not None:
        lines.append(f"rule: {chain.rule.name}, {chain.segments} segments")
    else:
        lines.append(f"pieces: {chain.pieces}, given one by one")
    model = linearize(chain)
    first = solve_modes(model, _REPORTED).frequency.tolist()
    lines.append(
        f"natural frequencies of the chain: {_few(first, '.8g') or 'none'} Hz, undamped, without load"
    )
    if beam is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SlendernessWarning)
            errors = chain_errors(chain, len(first)) if first else np.empty(0)
        said = ", ".join(percent(error, 5, rounding=1e-10) for error in errors.tolist())
        lines += [f"their errors against the exact beam: {said}"] if first else []
        lines += filter(None, [stout_remark(beam, chain.boundary, errors)])
    if damping not in (None, Damping()):
        ratios = [ratio for _, ratio in modes_with_ratios(chain, damping, model, _REPORTED)]
        lines += [f"damping ratios of these modes, without load: {_few(ratios, '.4g')}"] if ratios else []
    if at is not None and at.span is not None:
        lines.append(
            "ends held apart: the right one at x = {:.6g}, y = {:.6g} from the left one".format(*at.span)
        )
    if load not in (None, Load()) or at is not None:
        lines += _under(chain, damping, load, at)
    return _headed(lines, units)


def facts_about_rod(
    chain: SpatialChain, damping: Damping | None = None, units: str | None = None
) -> list[str]:
    """Return lines on a chain in space: its rod, ends and rule, its first frequencies and their errors.

    Examples
    --------
    >>> from beammodes.problem.rod import Rod
    >>> print(facts_about_rod(SpatialChain(Rod(1.0, 1.0, 0.8, 1.0, 1e-4), "clamped-free", 6, "gregory"))[1])
    rod: length 1 m, EI 1 N m2 about z and 1 about y, GJ 0.8, 1 kg/m, if it was given in SI units
    """
    rod, system = chain.rod, UNIT_SYSTEMS[units or "SI"]
    twist, across, bend = (rod.planar(axis).mean_bending_stiffness for axis in range(3))
    varies = "" if rod.is_uniform else ", on average where they vary"
    lines = [
        f"rod: length {rod.length:.6g} {system.length}, EI {bend:.6g} {system.bending_stiffness} about z and "
        f"{across:.6g} about y, GJ {twist:.6g}, {rod.planar(0).mean_mass_per_length:.6g} "
        f"{system.mass_per_length}{varies}{'' if units else ', if it was given in SI units'}",
        f"ends: {chain.ends}",
        f"rule: {chain.rule.name}, {chain.segments} segments",
    ]
    omega = spatial_modes(chain, _REPORTED).angular_frequency
    hertz = _few((omega / (2 * math.pi)).tolist(), ".8g")
    lines.append(f"natural frequencies of the chain: {hertz or 'none'} Hz, undamped, without load")
    if len(omega):
        try:
            errors = ", ".join(
                percent(error, 5, rounding=1e-10) for error in rod_errors(chain, len(omega)).tolist()
            )
        except (ArithmeticError, ValueError) as error:
            errors = f"not known here: {error}"
        lines.append(f"their errors against the exact rod: {errors}")
    if damping not in (None, Damping()):
        ratios = (damping.stiffness * omega / 2).tolist()
        lines += [f"damping ratios of these modes, without load: {_few(ratios, '.4g')}"] if ratios else []
    return _headed(lines, units)


def _headed(lines: Iterable[str], units: str | None) -> list[str]:
    usual = "m, kg, s and rad, if the beam was given in them; else the consistent set it was in"
    units_line = f"units: {UNIT_SYSTEMS[units].all if units else usual}"
    return [f"written by {SOURCE}", *map(one_line, [*lines, units_line])]


def _under(
    chain: Chain, damping: Damping | None, load: Load | None, at: Equilibrium | None
) -> tuple[str, ...]:
    """Return lines on the first modes about the shape at rest under a load."""
    if at is not None and not at.is_stable:
        return (f"its shape at rest under {load} is unstable: the chain leaves it, and rings about another",)
    unknown = f"natural frequencies under {load}: others than these, and not known here: "
    if at is None and chain.pieces > _MAX_RESTING:
        return (f"{unknown}the chain has more than {_MAX_RESTING} pieces",)
    try:
        about = linearize(chain, at=at or find_equilibrium(chain, load))
        modes = modes_with_ratios(chain, damping, about, _REPORTED)
    except (EquilibriumNotFound, ArithmeticError, ValueError) as error:
        return (f"{unknown}{error}",)
    if not modes:
        return ()
    hertz = _few((omega / (2 * math.pi) for omega, _ in modes), ".6g")
    said = f"natural frequencies under {load}, about its shape at rest: {hertz} Hz, undamped"
    if damping in (None, Damping()):
        return (said,)
    return said, f"damping ratios there: {_few((ratio for _, ratio in modes), '.4g')}"


def _few(values: Iterable[float], form: str) -> str:
    return ", ".join(format(value, form) for value in values)


def one_line(text: str) -> str:
    """Return `text` printable and on one line, without the `--` that ends comments in XML.

    Examples
    --------
    >>> one_line("a rule\\nof two --> lines")
    'a rule of two - -> lines'
    """
    plain = "".join(c if c.isprintable() else " " for c in text)
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return plain
