"""Published values: enough of them, each held by a test, none further off than its digits allow."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from studies.validation import PUBLISHED

ROOT = Path(__file__).parent.parent
with (ROOT / "figures" / "validation.csv").open(encoding="utf-8") as file:
    ROWS = list(csv.DictReader(file))


def test_every_value_agrees_as_closely_as_it_is_printed() -> None:
    # `.ci/run` computes the file again and compares it.
    assert [row["quantity"] for row in ROWS] == [one.quantity for one in PUBLISHED]
    for row, one in zip(ROWS, PUBLISHED, strict=True):
        assert float(row["printed"]) == float(one.printed)
        assert abs(float(row["ours"]) - float(one.printed)) <= one.tolerance * (1 + 1e-9), one.quantity


def test_at_least_fifteen_sources_each_with_a_test_that_is_there() -> None:
    assert len({one.source.partition(",")[0] for one in PUBLISHED}) >= 15
    assert all((ROOT / "tests" / one.test).is_file() for one in PUBLISHED)
    # What more than rounding sets apart says why.
    assert all(bool(one.within) == bool(one.why) for one in PUBLISHED)


def test_a_value_is_computed_when_it_is_asked_for() -> None:
    greenhill = next(one for one in PUBLISHED if "mast" in one.quantity)
    assert greenhill.ours() == pytest.approx(7.837347438943484, rel=1e-9)  # root of J_{-1/3}
