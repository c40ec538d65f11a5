"""Records that need spectra to be made stand wherever a rule's name does."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

import beammodes as bm


def test_a_tuned_rule_gains_two_orders_in_its_mode() -> None:
    # theory.md section 4: one wall spring 6N/(3N - σβ) removes the 1/N² error of mode n.
    segments = np.array([1000, 10_000])
    for mode in (1, 2, 3):
        tuned = bm.frequency_error("clamped-free", segments=segments, mode=mode, rule=bm.mode_tuned(mode))
        plain = bm.frequency_error("clamped-free", segments=segments, mode=mode, rule="mitiguy")
        assert (np.abs(tuned) < 1e-3 * np.abs(plain)).all()
        other = bm.frequency_error("clamped-free", segments=segments, mode=mode + 1, rule=bm.mode_tuned(mode))
        assert math.log10(other[0] / other[1]) == pytest.approx(2, abs=0.01)


def test_a_tuned_rule_that_has_no_positive_spring_is_nan_or_an_error() -> None:
    # σβ of mode 3 is about 7.85: 6N/(3N - σβ) is negative for N = 2.
    assert math.isnan(bm.frequency_error("clamped-free", segments=2, mode=1, rule=bm.mode_tuned(3)))
    with pytest.raises(ValueError, match="no positive springs"):
        bm.Chain(bm.Beam.unit(), "clamped-free", 2, bm.mode_tuned(3))


def test_the_law_of_a_tuned_rule() -> None:
    tuned = bm.error_law("clamped-free", 1, bm.mode_tuned(1))
    assert tuned.order == 4
    assert math.isnan(tuned.coefficient)
    other = bm.error_law("clamped-free", 2, bm.mode_tuned(1))
    exact = bm.frequency_error("clamped-free", segments=10**6, mode=2, rule=bm.mode_tuned(1))
    assert other.order == 2
    assert float(exact / other.at(10**6)) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(
    ("boundary", "counts"),
    [
        ("clamped-free", [3, 4, 8, 12]),
        ("clamped-clamped", [4, 5, 9]),
        pytest.param("clamped-free", range(3, 13), marks=pytest.mark.slow),
        pytest.param("clamped-clamped", range(4, 13), marks=pytest.mark.slow),
    ],
)
def test_matched_springs_by_the_lookup(boundary: str, counts: Sequence[int]) -> None:
    rule = bm.matched(3)
    errors = bm.frequency_error(boundary, segments=np.array(counts)[:, None], mode=[1, 2, 3], rule=rule)
    assert np.abs(errors).max() < 1e-12
    for count in counts:
        assert (bm.Chain(bm.Beam.unit(), boundary, count, rule).joint_stiffness > 0).all()


def test_records_and_names_share_one_table() -> None:
    rules = ["mitiguy", bm.mode_tuned(1), bm.matched(2)]
    table = bm.error_dataset(
        boundary=["clamped-free", "pinned-free"], segments=[1, 4, 5], modes=2, rule=rules
    )
    assert table["rule"].values.tolist() == ["mitiguy", "mode_tuned(1)", "matched(2)"]
    assert np.abs(table.relative_error.sel(rule="matched(2)", segments=5)).max() < 1e-12
    assert np.isnan(table.relative_error.sel(rule="matched(2)", segments=1)).all()


def test_what_has_no_closed_form_is_refused_where_one_is_needed() -> None:
    with pytest.raises(ValueError, match=r"rule must .*matched\(3\)"):
        bm.segments_needed("clamped-free", 0.01, 3, bm.matched(3))
    assert bm.segments_needed("clamped-free", 0.01, 1, bm.mode_tuned(1)) < bm.segments_needed(
        "clamped-free", 0.01
    )
    with pytest.raises(TypeError, match="rule"):
        bm.error_law("clamped-free", 1, bm.matched(2))  # type: ignore[arg-type]
