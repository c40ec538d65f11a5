"""The report's table of the step constant C, what stability asks for, and what a chain asks for."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.vibration.integrators import stability_limit
from beammodes.vibration.stability import (
    ROARK_CLAMPED_CLAMPED,
    exact_constants,
    highest_angular_frequency,
    published_constants,
)
from beammodes.views.plots import STYLE, label_line, plot_step_constants
from beammodes.views.tables import csv_table, markdown_table, tidy_rows
from studies import Progress

#: C as the report prints it, the one set of numbers here that is typed: it is what is to be regenerated.
REPORT = (0.357, 0.130, 0.066, 0.040, 0.027)
BOUNDARIES = ("clamped-free", "clamped-clamped")
SEGMENTS = range(1, 21)
MODE_COLUMNS = ("modes", "K", "C_published", "C_regenerated", "C_exact", "C_single_mode")
CHAIN_COLUMNS = ("boundary", "segments", "omega_max", "C_chain")


def data(progress: Progress | None = None) -> xarray.Dataset:
    """The report's constants beside exact ones, and 2√2/ω_max of chains with the report's springs."""
    modes = len(REPORT)
    omega = np.full((len(BOUNDARIES), len(SEGMENTS)), np.nan)
    for j, count in enumerate(SEGMENTS):
        for i, boundary in enumerate(BOUNDARIES):
            chain = bm.Chain(bm.Beam.unit(), boundary, segments=count)
            if chain.elastic_modes:
                omega[i, j] = highest_angular_frequency(chain)
        if progress is not None:
            progress(j + 1, len(SEGMENTS))
    limit = stability_limit("rk4")
    return xarray.Dataset(
        {
            "K": ("modes", list(ROARK_CLAMPED_CLAMPED)),
            "C_published": ("modes", list(REPORT)),
            "C_regenerated": ("modes", published_constants()),
            "C_exact": ("modes", exact_constants(modes)),
            "C_single_mode": ("modes", exact_constants(modes, limit=limit)),
            "omega_max": (("boundary", "segments"), omega),
            "C_chain": (("boundary", "segments"), limit / omega),
        },
        coords={"modes": range(1, modes + 1), "boundary": list(BOUNDARIES), "segments": list(SEGMENTS)},
    )


def _parts(table: xarray.Dataset) -> tuple[xarray.Dataset, xarray.Dataset]:
    modes = table.drop_dims(["boundary", "segments"])
    return modes, table.drop_dims("modes")


def draw(table: xarray.Dataset) -> Figure:
    """The report's C and the two corrections, on one pair of logarithmic axes."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 5.0), layout="constrained")
        ax = figure.subplots()
        plot_step_constants(*_parts(table), ax)
        ax.set_title(
            "The C-table: the published step against the stable one",
            fontsize=13,
            fontweight="bold",
            loc="left",
        )
        ax.set_xlim(0.9, 40)
        ax.set_ylim(7e-4, 3.0)
        ax.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        ax.minorticks_off()
        published, single, free, clamped = ax.get_lines()
        label_line(ax, published, "published: C = 8/K,\n2.83 times too long for that mode", offset=(9, 4))
        label_line(
            ax,
            single,
            "2√2/K: stable for that mode alone,\nnot for a chain",
            offset=(-4, -8),
            ha="right",
            va="top",
        )
        label_line(ax, free, "clamped-free chain:\nC = 2√2/ω_max", point=0, offset=(12, 6))
        label_line(ax, clamped, "clamped-clamped chain:\nalmost the same", point=-6, offset=(12, 14))
    return figure


def tables(table: xarray.Dataset) -> dict[str, str]:
    """Both tables as CSV, and as one Markdown page."""
    modes, chains = _parts(table)
    by_mode, by_chain = tidy_rows(modes, MODE_COLUMNS), tidy_rows(chains, CHAIN_COLUMNS)
    return {
        ".csv": csv_table(MODE_COLUMNS, by_mode),
        "_chains.csv": csv_table(CHAIN_COLUMNS, by_chain),
        ".md": f"{markdown_table(MODE_COLUMNS, by_mode)}\n{markdown_table(CHAIN_COLUMNS, by_chain)}",
    }
