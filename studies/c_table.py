"""The report's table of the step constant C, what stability asks for, and what a chain asks for."""

from __future__ import annotations

import math

import numpy as np
import xarray
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.numerics.arrays import Floats
from beammodes.vibration.integrators import accuracy_limit, stability_limit
from beammodes.vibration.stability import (
    ROARK_CLAMPED_CLAMPED,
    highest_angular_frequency,
    published_constants,
)
from studies.plots import label_line, plain_ticks, plot_step_constants
from studies.study import Progress, Sheet, Study
from studies.tables import markdown_table

#: C as the report prints it, the one set of numbers here that is typed: it is what is to be regenerated.
REPORT = (0.357, 0.130, 0.066, 0.040, 0.027)
#: Of rk4, times N²: no uniform undamped chain between plain ends, with the report's springs, has a mode
#: above the band edge √48 N², so h ≤ ell² √(ρA/(6 EI)) is stable for small motions without any eigen-solve.
SAFE_CONSTANT = 1 / math.sqrt(6)
BOUNDARIES = ("clamped-free", "clamped-clamped")
SEGMENTS = range(1, 21)
BY_MODE = Sheet(("modes", "K", "C_published", "C_regenerated", "C_exact", "C_single_mode"))
BY_CHAIN = Sheet(("boundary", "segments", "omega_max", "C_chain"))


def exact_constants(modes: int, *, limit: float = 8.0) -> Floats:
    """Return  limit / K_n  with the exact roots K_n of the clamped-clamped beam, shape (modes,).

    With 8 as in the report; 2√2 makes one such mode alone stable under fixed-step RK4.
    """
    return np.asarray(limit / bm.wavenumber("clamped-clamped", np.arange(1, modes + 1)) ** 2)


def step_constants(
    chain: bm.Chain, modes: int, integrator: str = "rk4", *, damping_ratio: float = 0.0
) -> tuple[float, Floats]:
    """Return C of the longest stable step, and of the longest accurate ones for 1 to `modes` modes.

    h = C L² √(ρA/EI). Accurate is: frequency within 0.1 %, amplitude within 1 % of the first one, over 100
    periods of each mode; NaN for modes that the chain does not have. The damping ratio is that of mode 1, by
    dampers in proportion to the springs: ratios of other modes go with ω.
    """
    assert chain.beam is not None
    omega = bm.solve_modes(bm.linearize(chain)).angular_frequency / chain.beam.frequency_unit
    ratios = (damping_ratio * omega / omega[0]).tolist()
    stable = min(stability_limit(integrator, r) / w for r, w in zip(ratios, omega.tolist(), strict=True))
    each = [accuracy_limit(integrator, r) / w for r, w in zip(ratios[:modes], omega.tolist(), strict=False)]
    accurate = np.full(modes, np.nan)
    accurate[: len(each)] = np.minimum.accumulate(each)
    return stable, accurate


def data(progress: Progress) -> xarray.Dataset:
    """Return the report's constants beside exact ones, and 2√2/ω_max of chains with the report's springs."""
    modes = len(REPORT)
    omega = np.full((len(BOUNDARIES), len(SEGMENTS)), np.nan)
    for j, count in enumerate(SEGMENTS):
        for i, boundary in enumerate(BOUNDARIES):
            chain = bm.Chain(bm.Beam.unit(), boundary, segments=count)
            if chain.elastic_modes:
                omega[i, j] = highest_angular_frequency(chain)
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


def _markdown(table: xarray.Dataset) -> dict[str, str]:
    parts = (markdown_table(sheet.columns, sheet.rows(table)) for sheet in (BY_MODE, BY_CHAIN))
    return {".md": "\n".join(parts)}


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the report's C and the two corrections, on one pair of logarithmic axes."""
    ax = figure.subplots()
    plot_step_constants(*_parts(table), ax)
    ax.set_xlim(0.9, 40)
    ax.set_ylim(7e-4, 3.0)
    plain_ticks(ax, [1, 2, 5, 10, 20])
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


STUDY = Study(
    name="c_table",
    title="The C-table: the published step against the stable one",
    caption="The report's table of the step constant C, beside those of stable steps.",
    data=data,
    draw=draw,
    sheets={".csv": BY_MODE, "_chains.csv": BY_CHAIN},
    size=(9.0, 5.0),
    more=_markdown,
)
