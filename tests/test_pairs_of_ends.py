"""A pair of ends is a boundary wherever a boundary is asked for, alone or among several."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from turns import in_turns

import beammodes as bm

BODY = bm.End(mass=0.5)
HEAVY, PLAIN = "clamped-free(mass=0.5)", "clamped-free"

# Every public function of one boundary or several, plain ones only or any.
ANY_ENDS: dict[str, Callable[[Any], Any]] = {
    "frequency_error": lambda b: bm.frequency_error(b, segments=10, mode=1),
    "segments_needed": lambda b: bm.segments_needed(b, 0.05, modes=1),
    "recommend": lambda b: bm.recommend(b, 0.05, 1, rules=["gregory"])[0].largest_error,
    "euler_bernoulli": lambda b: bm.euler_bernoulli(bm.Beam.unit(), b, 2).frequency,
    "Chain": lambda b: bm.Chain(bm.Beam.unit(), b, 4).joint_stiffness,
    "buckling_load": lambda b: bm.buckling_load(bm.Beam.unit(), b),
    "error_dataset": lambda b: (
        bm.error_dataset(boundary=b, segments=[4], rule="mitiguy", modes=1).relative_error.values
    ),
    "Study": lambda b: (
        bm.Study.grid(boundary=b, segments=4, mode=1, compute="relative_error").run().relative_error.values
    ),
}
PLAIN_ENDS: dict[str, Callable[[Any], Any]] = {
    "error_law": lambda b: bm.error_law(b, 1).coefficient,
    "wavenumber": lambda b: bm.wavenumber(b, 1),
    "chain_frequency": lambda b: bm.chain_frequency(b, segments=10, mode=1),
    "static_dataset": lambda b: (
        bm.static_dataset(boundary=b, segments=[4], rule="mitiguy").midspan_deflection_error.values
    ),
    "shape_dataset": lambda b: bm.shape_dataset(boundary=b, segments=[4], rule="mitiguy", modes=1).sizes[
        "boundary"
    ],
    "buckling_dataset": lambda b: (
        bm.buckling_dataset(boundary=b, segments=[4], rule="mitiguy").relative_error.values
    ),
}
SEVERAL = {"frequency_error", "wavenumber", "chain_frequency", "static_dataset"}


@pytest.mark.parametrize(("name", "form"), in_turns([*ANY_ENDS, *PLAIN_ENDS], [tuple, list], every=2))
def test_a_pair_is_one_boundary(name: str, form: type) -> None:
    call = {**ANY_ENDS, **PLAIN_ENDS}[name]
    assert np.array_equal(call(form(("clamped", "free"))), call(PLAIN), equal_nan=True)
    if name in ANY_ENDS:
        heavy = call(HEAVY)
        assert np.array_equal(call(form(("clamped", BODY))), heavy, equal_nan=True)
        assert np.array_equal(call(form(("clamped", "free(mass=0.5)"))), heavy, equal_nan=True)


@pytest.mark.parametrize("name", sorted(SEVERAL))
@pytest.mark.parametrize("form", [tuple, list])
def test_pairs_stand_among_names(name: str, form: type) -> None:
    call = {**ANY_ENDS, **PLAIN_ENDS}[name]
    several = call(form([("clamped", "free"), "pinned-pinned", ["pinned", "guided"]]))
    assert np.array_equal(several, call(["clamped-free", "pinned-pinned", "pinned-guided"]), equal_nan=True)
    both = call(form(["clamped-free", "pinned-pinned"]))
    assert np.array_equal(both, call(np.array(["clamped-free", "pinned-pinned"])), equal_nan=True)


def test_what_is_no_pair_says_so() -> None:
    with pytest.raises(
        ValueError, match=r"boundary must name two of the ends .*did you mean \"clamped-free\""
    ):
        bm.frequency_error(("clamped", "fre"), segments=10, mode=1)
    with pytest.raises(ValueError, match=r"^number of an end must be one of"):
        bm.frequency_error(("clamped", "free(maß=1)"), segments=10, mode=1)
