"""A load: its numbers, and who accepts it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES, axially_corrected
from beammodes.chains.units import ExactUnits
from beammodes.equations.numeric import compile_equations
from beammodes.equations.symbolic import equations_of_motion, symbolic_energies
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.linear import linearize

CHAIN = Chain(Beam.unit(), "clamped-free", segments=2)


def test_numbers_are_kept_as_floats_but_fractions_exactly() -> None:
    for given_force, kept in (
        (3, 3.0),
        (np.float32(-0.5), -0.5),
        (-0.0, 0.0),
        (Fraction(1, 3), Fraction(1, 3)),
    ):
        force = Load(axial_force=given_force).axial_force
        assert force == kept
        assert type(force) is type(kept)
    assert math.copysign(1.0, Load(axial_force=-0.0).axial_force) == 1.0
    assert Load() == Load(axial_force=0) == checked_load(None)


@pytest.mark.parametrize("value", [True, "1", None, 1j, [1.0], np.array([1.0])])
def test_what_is_no_number(value: Any) -> None:
    with pytest.raises(TypeError, match=r"^axial_force must be a real number, got "):
        Load(axial_force=value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400, Fraction(10**400)])
def test_what_is_not_finite(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^axial_force must be finite, got "):
        Load(axial_force=value)


def test_a_load_cannot_change() -> None:
    load = Load(axial_force=2.0)
    assert checked_load(load) is load
    with pytest.raises(dataclasses.FrozenInstanceError):
        load.axial_force = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    "call",
    [
        checked_load,
        lambda load: linearize(CHAIN, load=load),
        lambda load: equations_of_motion(CHAIN, load=load),
        lambda load: symbolic_energies(CHAIN, load=load),
        lambda load: compile_equations(CHAIN, load=load),
        lambda load: axially_corrected("gregory", load),
        lambda load: RULES["mitiguy"].declared_order(CHAIN.boundary, load),
    ],
)
@pytest.mark.parametrize("value", [2.0, "tension", True, 0, ""])
def test_only_a_load_is_a_load(call: Callable[[Any], Any], value: Any) -> None:
    with pytest.raises(TypeError, match=r"^load must be a Load or None, got "):
        call(value)


def test_a_force_in_a_chains_own_units() -> None:
    # EI/ell² with EI = 5 and ell = 3/4, exact: 7 · (9/16) / 5.
    units = ExactUnits.of(Beam(3.0, 5.0, 2.0), 4)
    assert units.force(Load(axial_force=7).axial_force) == Fraction(63, 80)
    assert units.force(Fraction(1, 3)) == Fraction(9, 240)
