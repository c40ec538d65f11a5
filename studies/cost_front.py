"""The cost of accuracy: largest error of three modes against the work of simulating the chain."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import xarray
from matplotlib.figure import Figure
from numpy.typing import NDArray

import beammodes as bm
from beammodes.chains.rules import AnyRule
from beammodes.views.symbols import GREY
from studies.common import LARGEST_ERROR, MATCHED, largest_error
from studies.plots import label_along, mark_exact, mark_point, method_style, places_along, plain_ticks
from studies.study import Progress, Sheet, Study

BOUNDARY = "clamped-free"
SEGMENTS = np.array([*range(3, 27), 30, 40, 50, 64, 80, 100])
TOLERANCE = 0.01
FRONT = "#F0E442"  # the yellow of Okabe and Ito's colours
NUMBERED = ("gregory", "mitiguy", "naive")
# Where each line is named, and on which side.
LABELS: dict[str, tuple[float, Literal["above", "below"]]] = {
    "naive": (4e5, "below"),
    "rigid_stub": (4e5, "above"),
    "hencky": (6e5, "above"),
    "double_wall": (1.5e6, "above"),
    "mitiguy": (5e3, "above"),
    "half_stub": (4e4, "below"),
    "rigid_stub_corrected": (2.5e6, "below"),
    "gregory2": (1.2e5, "below"),
    "half_stub_corrected": (9e3, "above"),
    "gregory": (6e3, "below"),
}


def cost(rule: AnyRule, segments: int) -> float:
    """Return segments times Runge-Kutta steps in one period of mode 1, as `bm.recommend` counts it."""
    beam = bm.Beam.unit()
    step = bm.stable_time_step(bm.Chain(beam, BOUNDARY, segments, rule), "rk4")
    return segments * 2 * math.pi / float(bm.euler_bernoulli(beam, BOUNDARY, 1).angular_frequency[0]) / step


def front(price: NDArray[np.float64], error: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which points no other one beats in price and error at once."""
    known = np.isfinite(error)
    order = np.lexsort((error[known], price[known]))
    best = np.minimum.accumulate(error[known][order])
    found = np.zeros(known.sum(), dtype=bool)
    found[order] = np.diff(best, prepend=np.inf) < 0
    everywhere = np.zeros(error.shape, dtype=bool)
    everywhere[known] = found
    return everywhere


def data(progress: Progress) -> xarray.Dataset:
    """Return cost and largest error by rule and N, and which points are on the front of all rules."""
    rules = (*bm.RULES, MATCHED)
    price, error = (np.full((len(rules), len(SEGMENTS)), np.nan) for _ in range(2))
    for i, rule in enumerate(rules):
        # Matched springs have no error to lower: their shortest chain is the one to take.
        counts = SEGMENTS[:1] if rule is MATCHED else SEGMENTS
        error[i, : len(counts)] = largest_error(BOUNDARY, rule, counts)
        price[i, : len(counts)] = [
            cost(rule, int(n)) if np.isfinite(e) else np.nan for n, e in zip(counts, error[i], strict=False)
        ]
        progress(i + 1, len(rules))
    price[np.isnan(error)] = np.nan
    best = np.zeros(error.shape, dtype=bool)
    best[:-1] = front(price[:-1], error[:-1])
    dims = ("rule", "segments")
    return xarray.Dataset(
        {"cost": (dims, price), "largest_error": (dims, error), "on_front": (dims, best)},
        coords={"rule": [*bm.RULES, MATCHED.name], "segments": SEGMENTS},
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw a line for each rule over the front of all of them."""
    ax = figure.subplots()
    ax.set(xscale="log", yscale="log", xlim=(45, 2e7), ylim=(1e-3, 100))
    plain_ticks(ax, y=[10.0**k for k in range(-3, 3)], unit=" %")
    ax.set_ylabel("largest |frequency error| of modes 1 to 3")
    ax.set_xlabel("cost = segments × Runge-Kutta steps at the stability limit in one period of mode 1")
    ax.axhline(100 * TOLERANCE, color=GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
    best = table.where(table.on_front)
    ax.plot(best.cost.values.ravel(), 100 * best.largest_error.values.ravel(), "o", color=FRONT, ms=13)
    lines = {}
    for rule in table.rule.values[:-1]:
        line = table.sel(rule=rule).dropna("segments")
        (lines[rule],) = ax.plot(line.cost, 100 * line.largest_error, marker="o", markersize=3)
        lines[rule].set(**method_style(rule))
        if rule in NUMBERED:
            first = line.where(line.largest_error <= TOLERANCE, drop=True).isel(segments=0)
            mark_point(ax, lines[rule], float(first.cost), f"{int(first.segments)} rods")
    exact = float(table.cost.sel(rule=MATCHED.name)[0])
    note = f"{MATCHED.name}:\n{SEGMENTS[0]} rods, cost {exact:.0f},\ngive all three exactly"
    mark_exact(ax, exact, 10, note)
    legend = "yellow: of the other springs,\nnone is cheaper and\nmore accurate"
    ax.text(1.15 * exact, 1.2e-2, legend, va="bottom", fontsize=10, color=GREY)
    label_along(ax, places_along(ax, lines, LABELS))


STUDY = Study(
    name="cost_front",
    title="What accuracy costs: clamped-free beam, first three frequencies",
    caption="Largest error of three modes against the work of simulating the chain.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("rule", "segments", "cost", "largest_error", "on_front"),
            {"largest_error": LARGEST_ERROR},
            needs="cost",
        )
    },
    size=(9.0, 5.8),
)
