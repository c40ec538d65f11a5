"""Datasets as text: tidy rows, CSV to twelve digits, Markdown."""

from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

from studies.tables import csv_table, markdown_table, tidy_rows

NAN = math.nan


@pytest.fixture
def dataset() -> xarray.Dataset:
    return xarray.Dataset(
        {
            "error": (("rule", "segments"), [[0.1, 0.2, NAN], [NAN, 0.5, 0.6]]),
            "order": ("rule", [2, 4]),
            "cost": ("segments", [1.5, 2.5, NAN]),
        },
        coords={"rule": ["naive", "gregory"], "segments": [1, 2, 4]},
    )


def test_one_row_a_point_without_missing_ones(dataset: xarray.Dataset) -> None:
    assert tidy_rows(dataset, ["rule", "segments", "error"]) == [
        ["naive", 1, 0.1],
        ["naive", 2, 0.2],
        ["gregory", 2, 0.5],
        ["gregory", 4, 0.6],
    ]


def test_columns_come_in_the_order_asked_for(dataset: xarray.Dataset) -> None:
    rows = tidy_rows(dataset, ["error", "segments", "rule"])
    assert rows[0] == [0.1, 1, "naive"]
    assert rows[-1] == [0.6, 4, "gregory"]


def test_variables_of_fewer_dimensions_are_repeated(dataset: xarray.Dataset) -> None:
    rows = tidy_rows(dataset, ["rule", "segments", "order", "error"])
    # `order` is never missing, so that no row is missing throughout.
    assert [row[2] for row in rows] == [2, 2, 2, 4, 4, 4]
    assert [type(value) for value in rows[0]] == [str, int, int, float]
    by_segments = tidy_rows(dataset, ["rule", "segments", "cost"])
    assert by_segments == [
        ["naive", 1, 1.5],
        ["naive", 2, 2.5],
        ["gregory", 1, 1.5],
        ["gregory", 2, 2.5],
    ]


def test_rows_missing_in_part_stay(dataset: xarray.Dataset) -> None:
    rows = tidy_rows(dataset, ["rule", "segments", "error", "cost"])
    assert len(rows) == 5  # of 6 points only (naive, 4) lacks both
    assert rows[2][:2] == ["gregory", 1]
    assert math.isnan(rows[2][2])
    assert rows[2][3] == 1.5


def test_order_of_dimensions_in_a_variable_does_not_matter(dataset: xarray.Dataset) -> None:
    turned = dataset.assign(error=dataset.error.transpose("segments", "rule"))
    columns = ["rule", "segments", "error"]
    expected = {tuple(row) for row in tidy_rows(dataset, columns)}
    assert {tuple(row) for row in tidy_rows(turned, columns)} == expected


def test_one_coordinate_without_dimension(dataset: xarray.Dataset) -> None:
    chosen = dataset.sel(rule="naive")
    assert tidy_rows(chosen, ["rule", "segments", "error"]) == [["naive", 1, 0.1], ["naive", 2, 0.2]]


def test_unknown_columns_are_an_error(dataset: xarray.Dataset) -> None:
    with pytest.raises(KeyError, match="absent"):
        tidy_rows(dataset, ["rule", "absent"])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1 / 3, "0.333333333333"),
        (-2e-15 / 3, "-6.66666666667e-16"),
        (np.float64(math.pi), "3.14159265359"),
        (123456789012345.0, "1.23456789012e+14"),
        (0.5, "0.5"),
        (10**15 + 1, "1000000000000001"),  # integers are exact
        ("clamped-free", "clamped-free"),
        ('a,"b"', '"a,""b"""'),  # RFC 4180
    ],
)
def test_csv_cells(value: object, text: str) -> None:
    assert csv_table(["x", "y"], [[1, value]]) == f"x,y\n1,{text}\n"


@given(st.lists(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3)))
def test_csv_keeps_twelve_digits(rows: list[list[float]]) -> None:
    head, *body = csv.reader(io.StringIO(csv_table(["a", "b", "c"], rows)))
    assert head == ["a", "b", "c"]
    assert len(body) == len(rows)
    for line, row in zip(body, rows, strict=True):
        for text, value in zip(line, row, strict=True):
            # Half a unit in the twelfth digit; the last term is for subnormal numbers.
            assert abs(float(text) - value) <= 5e-12 * abs(value) + 5e-324
            assert len(text.lstrip("-").split("e")[0].replace(".", "").strip("0")) <= 12


def test_csv_does_not_change_when_written_again() -> None:
    values = [[1 / 3, math.pi * 1e9], [2 / 3 * 1e-30, -1e22 / 7]]
    once = csv_table(["a", "b"], values)
    read = [[float(text) for text in line] for line in list(csv.reader(io.StringIO(once)))[1:]]
    assert csv_table(["a", "b"], read) == once


def test_markdown() -> None:
    rows = [["naive", 1, -0.0012345678], ["gregory", 20, NAN]]
    assert markdown_table(["rule", "N", "e"], rows) == (
        "| rule | N | e |\n"
        "|--|--:|--:|\n"  # numbers to the right
        "| naive | 1 | -0.001235 |\n"
        "| gregory | 20 | – |\n"
    )


@pytest.mark.parametrize(("digits", "text"), [(1, "0.7"), (3, "0.667"), (12, "0.666666666667")])
def test_markdown_digits(digits: int, text: str) -> None:
    assert markdown_table(["x"], [[2 / 3]], digits=digits).splitlines()[-1] == f"| {text} |"


def test_tables_without_rows() -> None:
    assert csv_table(["a", "b"], []) == "a,b\n"
    assert markdown_table(["a", "b"], []).splitlines() == ["| a | b |", "|--:|--:|"]
