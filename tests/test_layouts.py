"""A layout of one's own in every public function with a `rule`: taken, or refused with what it needs."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from shared_cases import WIRE, ell

import beammodes as bm

LOAD = bm.Load(axial_force=0.5)


class Copy:
    """The layout of gregory2 as a stranger writes it: the four parts and nothing else."""

    name, rotary_inertia = "of_my_own", Fraction(1, 12)

    def piece_lengths(self, boundary: bm.Boundary, segments: int) -> list[Fraction]:
        return bm.RULES["gregory2"].piece_lengths(boundary, segments)

    def hinge_weights(self, boundary: bm.Boundary, segments: int) -> list[Fraction]:
        return list(bm.RULES["gregory2"].hinge_weights(boundary, segments))


ENDS = "clamped-free"


def spread() -> Any:
    bar, given = bm.Rectangle(0.06, 0.02), {"elastic_modulus": 207e9, "density": 7850.0, "length": 1.0}
    return bm.frequency_spread(bar, ENDS, {"height": 0.025}, modes=1, samples=100, seed=1, **given)


ROD = bm.Rod(1.0, **WIRE)


# Every public function that takes a rule, called with one; the answers are numbers.
TAKEN: dict[str, Callable[[Any], Any]] = {
    "Chain": lambda rule: bm.Chain(bm.Beam.unit(), ENDS, 6, rule).joint_stiffness,
    "AxialChain": lambda rule: (
        bm.AxialChain(
            bm.Beam(1.0, 1.0, 1.0, axial_stiffness=2.0), "fixed-free", 6, rule, motion="stretch"
        ).joint_stiffness
    ),
    "SpatialChain": lambda rule: bm.spatial_modes(bm.SpatialChain(ROD, ENDS, 6, rule), 2).angular_frequency,
    "StructureChain": lambda rule: (
        bm.structure_chain_modes(bm.StructureChain(ell(), 6, rule), 2).angular_frequency
    ),
    "rod_error_dataset": lambda rule: (
        bm.rod_error_dataset(ROD, ENDS, segments=6, modes=2, rule=rule).relative_error.values
    ),
    "axially_corrected": lambda rule: (
        bm.Chain(bm.Beam.unit(), ENDS, 6, bm.axially_corrected(rule, LOAD, bm.Beam.unit())).joint_stiffness
    ),
    "buckling_dataset": lambda rule: (
        bm.buckling_dataset(boundary=[ENDS], segments=6, rule=rule).relative_error.values
    ),
    "derived_error_dataset": lambda rule: (
        bm.derived_error_dataset(ENDS, segments=[2], modes=1, rule=rule).relative_error.values
    ),
    "error_dataset": lambda rule: (
        bm.error_dataset(boundary=[ENDS], segments=6, modes=2, rule=rule).relative_error.values
    ),
    # Its remarks name the rule; that it answers is all that is asked here.
    "error_remarks": lambda rule: isinstance(bm.error_remarks(ENDS, segments=6, mode=1, rule=rule), tuple),
    "frequency_error": lambda rule: bm.frequency_error(ENDS, segments=6, mode=2, rule=rule),
    "response_error": lambda rule: abs(
        bm.response_error(ENDS, segments=6, mode=2, damping_ratio=0.01, rule=rule)
    ),
    "segments_needed": lambda rule: bm.segments_needed(ENDS, tolerance=0.01, modes=2, rule=rule),
    "segments_within_spread": lambda rule: bm.segments_within_spread(spread(), rule).segments,
    "shape_dataset": lambda rule: (
        bm.shape_dataset(boundary=[ENDS], segments=6, modes=1, rule=rule).to_array().values
    ),
    "static_dataset": lambda rule: (
        bm.static_dataset(boundary=[ENDS], segments=6, rule=rule).to_array().values
    ),
}
# Those with a closed form, which needs the weights of a `Rule`, and the way on that they name.
REFUSED: dict[str, Callable[[Any], Any]] = {
    "chain_frequency": lambda rule: bm.chain_frequency(ENDS, 6, 1, rule),
    "error_law": lambda rule: bm.error_law(ENDS, 1, rule),
    "law_holds_from": lambda rule: bm.law_holds_from(ENDS, 1, rule),
}


def _is_an_answer(value: object) -> bool:
    """Errors, and values that functions return with the rule that they were asked about."""
    return inspect.isclass(value) and (
        issubclass(value, BaseException)
        or value in (bm.EnoughSegments, bm.Recommendation, bm.AxiallyCorrected)
    )


def with_a_rule() -> set[str]:
    found = set()
    for name in bm.__all__:
        value = getattr(bm, name)
        if callable(value) and not _is_an_answer(value):
            try:
                parameters = inspect.signature(value).parameters
            except (TypeError, ValueError):
                continue
            if "rule" in parameters:
                found.add(name)
    return found


def test_every_public_function_with_a_rule_is_here() -> None:
    assert with_a_rule() <= {*TAKEN, *REFUSED}


@pytest.mark.parametrize("name", TAKEN)
def test_a_layout_of_ones_own_is_as_good_as_the_rule(name: str) -> None:
    own, known = (np.asarray(TAKEN[name](rule), dtype=np.float64) for rule in (Copy(), "gregory2"))
    # Frequencies of a layout are solved, those of the rule in closed form: to the solver's last digits.
    np.testing.assert_allclose(own, known, rtol=1e-9, atol=1e-13)
    assert own.size and not math.isnan(float(own.flat[0]))


@pytest.mark.parametrize("name", REFUSED)
def test_where_weights_are_needed_the_refusal_says_so(name: str) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^rule must .*Rule"):
        REFUSED[name](Copy())
