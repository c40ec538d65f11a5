"""Quantities that a study computes: one record each in `QUANTITIES`, or a user's own function."""

from __future__ import annotations

import inspect
import math
import types
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from beammodes.accuracy.buckling import buckling_load
from beammodes.accuracy.statics import STATIC_QUANTITIES, chain_static_errors
from beammodes.batch.cases import Case, Cases
from beammodes.batch.running_code import check_running_code, running_code
from beammodes.batch.study_axes import AXES
from beammodes.checks import bounded, choice, shown
from beammodes.numerics.arrays import Floats
from beammodes.vibration.axial_spectrum import highest_axial_frequency
from beammodes.vibration.stability import highest_angular_frequency, stable_time_step
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["DIMENSIONS", "QUANTITIES", "REASON", "Quantity", "quantities_of"]

#: More quantities of one study are a mistake.
_MAX_QUANTITIES = 1000

#: Dimensions of a study's dataset and of a chunk's file that are no axes.
DIMENSIONS = ("point", "sample", "case")

#: The variable that says, case by case, why numbers are NaN.
REASON = "reason"


@dataclass(frozen=True)
class Quantity:
    """One number of every point of a study.

    Attributes
    ----------
    name, long_name : str
    compute : callable
        From `Cases` to an array of shape (cases, modes), or (cases,).
    units : tuple of str
        With a beam of given dimensions, in any consistent units, here named as SI; for L = EI = ρA = 1.
    per_mode : bool
        Whether every mode has its own.
    closed_form : bool
        Whether plain ends take microseconds a value, not milliseconds.
    source : mapping from str to str
        As `running_code`, what tells one function of this name from another: nothing for those of this
        package, whose version does.
    uncounted : tuple of str
        Axes that would change it in truth, and that it does not count.
    """

    name: str
    long_name: str
    compute: Callable[[Cases], Floats]
    units: tuple[str, str]
    per_mode: bool = False
    closed_form: bool = False
    source: Mapping[str, str] = field(default_factory=dict, hash=False)
    uncounted: tuple[str, ...] = ()

    def check_code(self) -> None:
        """Raise ValueError if a user's function is not, in this process, the one of the study."""
        if self.source and isinstance(self.compute, _OfEach):
            check_running_code(self.compute.function, self.source)

    def definition(self) -> dict[str, Any]:
        """Return what defines the quantity, in plain values for a file."""
        return {"per_mode": self.per_mode, **({"source": dict(self.source)} if self.source else {})}


@dataclass(frozen=True)
class _OfEach:
    """A function of one case as a function of many."""

    function: Any

    def __call__(self, cases: Cases) -> Floats:
        return cases.each(self.function)


def _frequency(cases: Cases) -> Floats:
    return cases.exact * (1 + cases.relative_error) * cases.frequency_unit


def _exact_frequency(cases: Cases) -> Floats:
    return np.where(np.isnan(cases.relative_error), np.nan, cases.exact * cases.frequency_unit)


def _relative_error(cases: Cases) -> Floats:
    return cases.relative_error


def _highest(case: Case) -> float:
    if case.is_structure:
        return float(structure_chain_modes(case.chain).angular_frequency.max(initial=0.0))
    if case.motion != "bending":
        return highest_axial_frequency(case.chain)
    return highest_angular_frequency(case.chain, load=case.load)


def _time_step(case: Case) -> float:
    load = case.load if case.motion == "bending" and not case.is_structure else None
    return stable_time_step(case.chain, str(case.values.get("integrator", "rk4")), load=load)


def _chain_buckling(case: Case) -> float:
    chain = case.chain
    if case.is_structure:
        return buckling_load(chain)
    return buckling_load(chain) if chain.elastic_modes else math.nan


def _beam_buckling(case: Case) -> float:
    if case.is_structure:
        return buckling_load(case.structure)
    return buckling_load(case.beam, case.boundary)


def _buckling_error(case: Case) -> float:
    return _chain_buckling(case) / _beam_buckling(case) - 1


def _static_error(case: Case, *, place: int) -> float:
    return chain_static_errors(case.chain, str(case.values.get("static_load", "tip_force")))[place]


_FREQUENCY, _FORCE = ("rad / s", "sqrt(EI / (rhoA L^4))"), ("N", "EI / L^2")
_RELATIVE, _STEP = ("1", "1"), ("s", "sqrt(rhoA L^4 / EI)")
_TABLE = (
    Quantity(
        "relative_error", "relative frequency error of the chain", _relative_error, _RELATIVE, True, True
    ),
    Quantity("angular_frequency", "angular frequency of the chain", _frequency, _FREQUENCY, True, True),
    Quantity(
        "exact_angular_frequency",
        "angular frequency of the Euler-Bernoulli beam",
        _exact_frequency,
        _FREQUENCY,
        per_mode=True,
        closed_form=True,
    ),
    Quantity(
        "highest_angular_frequency", "highest angular frequency of the chain", _OfEach(_highest), _FREQUENCY
    ),
    Quantity("stable_time_step", "largest stable fixed step of the chain", _OfEach(_time_step), _STEP),
    *(
        Quantity(name, long_name, _OfEach(function), units, uncounted=("spin_rate", "motion"))
        for name, long_name, function, units in (
            ("buckling_load", "buckling load of the chain", _chain_buckling, _FORCE),
            ("exact_buckling_load", "buckling load of the beam", _beam_buckling, _FORCE),
            ("buckling_error", "relative error of the buckling load", _buckling_error, _RELATIVE),
        )
    ),
    *(
        Quantity(
            f"{name}_error",
            f"relative error of the chain's static {name.replace('_', ' ')}",
            _OfEach(partial(_static_error, place=place)),
            _RELATIVE,
            uncounted=("axial_force", "spin_rate", "motion", "structure"),
        )
        for place, name in enumerate(STATIC_QUANTITIES)
    ),
)

#: The quantities of this package, by name.
QUANTITIES: Mapping[str, Quantity] = MappingProxyType({quantity.name: quantity for quantity in _TABLE})


def quantities_of(compute: object) -> tuple[Quantity, ...]:
    """Return the quantities that names of `QUANTITIES` and functions of one `Case` stand for.

    Examples
    --------
    >>> [quantity.name for quantity in quantities_of(["relative_error", "stable_time_step"])]
    ['relative_error', 'stable_time_step']
    """
    if isinstance(compute, str) or not isinstance(compute, Iterable):
        return quantities_of([compute])
    found = [_quantity(item) for item in bounded("compute", compute, most=_MAX_QUANTITIES)]
    if not found:
        raise ValueError("compute must name at least one quantity, got none")
    names = [quantity.name for quantity in found]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ValueError(f"compute must name each quantity once, got {twice[0]} twice")
    return tuple(found)


def _quantity(item: object) -> Quantity:
    if not callable(item):
        return QUANTITIES[choice("compute", item, QUANTITIES)]
    name = getattr(item, "__name__", "")
    if not isinstance(item, types.FunctionType) or not name.isidentifier():
        raise ValueError(
            "compute must name quantities, or be functions that def makes (no lambda or method), "
            f"got {shown(item)}"
        )
    taken = {
        **dict.fromkeys((*DIMENSIONS, REASON), "part of the dataset"),
        **dict.fromkeys(AXES, "an axis"),
        **dict.fromkeys(QUANTITIES, "a quantity"),
    }
    if name in taken:
        raise ValueError(
            f"compute must be functions under names of their own, got {name}, which is {taken[name]}'s name"
        )
    label = (inspect.getdoc(item) or name.replace("_", " ")).splitlines()[0]
    return Quantity(name, label, _OfEach(item), ("", ""), source=running_code(item))
