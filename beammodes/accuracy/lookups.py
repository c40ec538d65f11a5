"""Lookups of each motion: tables and searches ask bending, twist and stretch in the same words."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.axial_errors import (
    axial_exact_frequencies,
    axial_frequency_error,
    axial_in_multiples,
    axial_numbers,
    axial_with_numbers,
    no_load,
)
from beammodes.accuracy.beam_units import BEAM_NUMBERS, NUMBERS, looked_up, with_numbers
from beammodes.accuracy.errors import errors_in_multiples, exact_frequencies
from beammodes.chains.axial_chain import AxialLayout, axial_layout_of
from beammodes.chains.rules import Layout, has_roots, is_closed, layout_of
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.problem.motions import Motion, motion_named

__all__ = ["Lookup", "lookup_of"]


class Lookup(ABC):
    """Errors and exact frequencies of one motion, and what their arguments are."""

    #: What one value of `rule` and of `boundary` may be an instance of.
    single_rule: tuple[type, ...]
    single_boundary: tuple[type, ...]
    #: Name of the exact beam, and unit of frequencies without a beam.
    judge: str
    unit: str

    @abstractmethod
    def boundary(self, value: Any) -> Any:
        """Return the record of a pair of ends."""

    @abstractmethod
    def layout(self, rule: Any) -> Any:
        """Return the record of a rule."""

    @abstractmethod
    def numbers(self) -> Mapping[str, tuple[str, str]]:
        """Return the names of numbers of ends and loads, with their units without a beam and in SI."""

    @abstractmethod
    def in_multiples(self, ends: Any, load: Load | None, beam: Beam | None) -> tuple[Any, Load]:
        """Return ends and load as closed forms take them."""

    @abstractmethod
    def with_numbers(self, ends: Any, load: Load, numbers: Mapping[str, Any]) -> tuple[Any, Load]:
        """Return ends and load with other numbers."""

    @abstractmethod
    def errors(self, ends: Any, segments: Any, mode: Any, rule: Any, load: Load) -> Any:
        """Return relative errors, of ends and a load in multiples."""

    @abstractmethod
    def exact(self, ends: Any, mode: NDArray[np.int64], load: Load) -> Floats:
        """Return exact frequencies for unit numbers."""

    @abstractmethod
    def frequency_unit(self, beam: Beam) -> float:
        """Return what frequencies for unit numbers multiply [rad/s]."""

    def cost(self, ends: Any, rule: Any, load: Load) -> str:
        """Return "looked up", "roots" (some to find for each N) or "solved" (each chain as a whole)."""
        if is_closed(rule) and load == Load() and self.is_plain(ends):
            return "looked up"
        has_hub = isinstance(ends, Boundary) and ends.has_hub
        return "roots" if has_roots(rule) and load.is_axial and not has_hub else "solved"

    @abstractmethod
    def is_plain(self, ends: Any) -> bool:
        """Return True if errors between these ends are looked up, and not found by a root for each N."""


class _Bending(Lookup):
    single_rule, single_boundary = (str, Layout), (str, Boundary, tuple)
    judge, unit = "Euler-Bernoulli beam", "sqrt(EI / (rhoA L^4))"

    def boundary(self, value: Any) -> Any:
        return Boundary.of(value)

    def layout(self, rule: Any) -> Any:
        return layout_of(rule)

    def numbers(self) -> Mapping[str, tuple[str, str]]:
        return {name: (own, BEAM_NUMBERS[name]) for name, own in NUMBERS.items()}

    def in_multiples(self, ends: Any, load: Load | None, beam: Beam | None) -> tuple[Any, Load]:
        return looked_up(ends, load, beam)

    def with_numbers(self, ends: Any, load: Load, numbers: Mapping[str, Any]) -> tuple[Any, Load]:
        return with_numbers(ends, load, numbers)

    def errors(self, ends: Any, segments: Any, mode: Any, rule: Any, load: Load) -> Any:
        return errors_in_multiples(ends, segments, mode, rule, load)

    def exact(self, ends: Any, mode: NDArray[np.int64], load: Load) -> Floats:
        return exact_frequencies(ends, mode, load)

    def frequency_unit(self, beam: Beam) -> float:
        return beam.frequency_unit

    def is_plain(self, ends: Any) -> bool:
        return bool(ends.is_plain)


class _Axial(Lookup):
    single_rule, single_boundary = (str, Layout, AxialLayout), (str, AxialBoundary, Boundary, tuple)

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.judge = f"beam in {motion.name}"
        inertia = motion.inertia_symbol.replace(" ", "")
        self.unit = f"sqrt({motion.stiffness_symbol} / ({inertia} L^2))"

    def boundary(self, value: Any) -> Any:
        return AxialBoundary.of(value, self.motion)

    def layout(self, rule: Any) -> Any:
        return axial_layout_of(rule)

    def numbers(self) -> Mapping[str, tuple[str, str]]:
        return axial_numbers(self.motion)

    def in_multiples(self, ends: Any, load: Load | None, beam: Beam | None) -> tuple[Any, Load]:
        no_load(load, self.motion)
        return axial_in_multiples(ends, beam, self.motion), Load()

    def with_numbers(self, ends: Any, load: Load, numbers: Mapping[str, Any]) -> tuple[Any, Load]:
        return axial_with_numbers(ends, numbers), load

    def errors(self, ends: Any, segments: Any, mode: Any, rule: Any, load: Load) -> Any:
        no_load(load, self.motion)
        return axial_frequency_error(ends, segments, mode, rule, self.motion)

    def exact(self, ends: Any, mode: NDArray[np.int64], load: Load) -> Floats:
        no_load(load, self.motion)
        return axial_exact_frequencies(ends, mode)

    def frequency_unit(self, beam: Beam) -> float:
        return self.motion.frequency_unit(beam)

    def is_plain(self, ends: Any) -> bool:
        return isinstance(ends, AxialBoundary)


@lru_cache(maxsize=8)
def _lookup(motion: Motion) -> Lookup:
    return _Axial(motion) if motion.along else _Bending()


def lookup_of(motion: str | Motion) -> Lookup:
    """Return the lookups of "bending", "twist" or "stretch".

    Raises
    ------
    TypeError, ValueError
        If `motion` is none of these; the message offers the nearest.

    Examples
    --------
    >>> lookup_of("twist").unit
    'sqrt(GJ / (rhoIp L^2))'
    """
    return _lookup(motion_named(motion))
