"""The step size, settled: the report's step, its recipe, and the steps that are stable and accurate."""

from __future__ import annotations

import math

import xarray

from studies.step_size_data import data
from studies.step_size_figure import draw
from studies.step_size_page import page
from studies.tables import csv_table, tidy_rows

__all__ = ["data", "draw", "tables"]

CONSTANTS = (
    "boundary",
    "segments",
    "integrator",
    "damping_ratio",
    "modes",
    "C_published",
    "C_safe",
    "C_stable",
    "C_accurate",
    "C",
)

BY_MODE = ("boundary", "integrator", "modes", "K", "C_published", "C_beam")

GROWTH = (
    "boundary",
    "segments",
    "start",
    "fixed_step",
    "step_over_limit",
    "growth_at_1_01",
    "largest",
    "tenfold",
    "overflow",
)

RECIPE = ("boundary", "segments", "recipe_modes", "rtol", "step_over_limit_asked", "steps", "evaluations")

COURSES = ("start", "fixed_step", "number", "angle")


def tables(table: xarray.Dataset) -> dict[str, str]:
    """Constants, constants of the beam, growth, cost of the recipe and courses as CSV; a page for people."""
    parts = {
        ".csv": (CONSTANTS, [n for n in CONSTANTS if n in table.data_vars]),
        "_modes.csv": (BY_MODE, ["K", "C_published", "C_beam"]),
        "_growth.csv": (GROWTH, ["step_over_limit", "growth_at_1_01", "largest", "tenfold", "overflow"]),
        "_recipe.csv": (RECIPE, ["step_over_limit_asked", "steps", "evaluations"]),
        "_courses.csv": (COURSES, ["angle"]),
    }
    found = {}
    for ending, (columns, names) in parts.items():
        rows = tidy_rows(table[names], columns)
        # A row stands for a chain that has the mode and a method that was measured.
        measured = columns.index(_MEASURED[ending])
        found[ending] = csv_table(columns, [row for row in rows if not math.isnan(row[measured])])
    return {**found, ".md": page(table)}


_MEASURED = {
    ".csv": "C",
    "_modes.csv": "C_beam",
    "_growth.csv": "largest",
    "_recipe.csv": "steps",
    "_courses.csv": "angle",
}
