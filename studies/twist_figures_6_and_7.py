"""Figures 6 and 7 of the report in twist: errors of the first three natural frequencies, one wall and two."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import GREY
from studies.common import MODES
from studies.figures_6_and_7 import COLUMNS
from studies.plots import label_line, plain_ticks, plot_errors
from studies.study import Progress, Sheet, Study

#: At the walls: what suits twist, what the report has for bending, and the spring of all other hinges.
WALLS = (
    bm.Rule("two_at_the_wall", ["1/2"], guided=["1/2"]),
    bm.Rule("bending_at_the_wall", ["1/2"], guided=[bm.Weight("1/2", "-1/6")]),
    bm.Rule("one_at_the_wall", ["1"], guided=["1"]),
)

# Relative disagreement of two routes that cannot be rounding.
_AGREE = 1e-11


def data(progress: Progress, boundary: str = "fixed-free") -> xarray.Dataset:
    """Return errors for N = 1..20 in closed form, which the chains' own modes against the beam's check."""
    table = bm.error_dataset(
        boundary=boundary, segments=range(1, 21), modes=MODES, rule=WALLS, motion="twist"
    )
    shaft = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    exact, worst = bm.axial_modes(shaft, boundary, MODES).angular_frequency, 0.0
    for i, rule in enumerate(WALLS):
        for count in table.segments.values.tolist():
            omega = bm.solve_modes(bm.AxialChain(shaft, boundary, count, rule), MODES).angular_frequency
            found = table.relative_error.sel(rule=rule.name, segments=count).values.ravel()[: len(omega)]
            worst = max(worst, float(np.abs(found - (omega / exact[: len(omega)] - 1)).max()))
        progress(i + 1, len(WALLS))
    if not worst < _AGREE:
        raise ArithmeticError(f"routes must agree within {_AGREE}, got {worst}")
    return table


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw signed errors as the report does, and sizes on logarithmic axes beside those of other walls."""
    best = table.sel(rule=[WALLS[0].name])
    linear, logarithmic = figure.subplots(1, 2)
    plot_errors(best, linear)
    linear.set_xlim(0, 20.5)
    linear.set_xticks(range(0, 21, 5))
    linear.margins(y=0.1)
    linear.set_title("signed, 2 GJ/ℓ at the wall; colours as on the right")
    plot_errors(best, logarithmic, magnitude=True)
    solid = logarithmic.get_lines()[:3]
    others = []
    for rule, dashes in ((WALLS[2], (0, (5, 2))), (WALLS[1], (0, (1, 1)))):
        line = 100 * abs(table.relative_error.sel(rule=rule.name, mode=1).squeeze()).dropna("segments")
        others += logarithmic.plot(line.segments, line, color=GREY, linestyle=dashes, linewidth=1.4)
    label_line(logarithmic, others[0], "mode 1,\nGJ/ℓ at the wall")
    label_line(
        logarithmic,
        others[1],
        "mode 1, wall\nas for bending",
        point=5,
        offset=(-8, -6),
        ha="right",
        va="top",
    )
    logarithmic.set_xlim(0.9, 90)
    plain_ticks(logarithmic, [1, 2, 5, 10, 20], [0.01, 0.1, 1, 10])
    logarithmic.plot([0.9, 20], [1.0, 1.0], color="#555555", linewidth=0.9, linestyle=(0, (4, 3)))
    logarithmic.text(0.95, 1.06, "1 %", color="#555555", va="bottom")
    logarithmic.set_title("size, on logarithmic axes")
    for mode, line in enumerate(solid, start=1):
        label_line(logarithmic, line, f"mode {mode}")


def _study(number: int, boundary: str, who: str) -> Study:
    return Study(
        name=f"figure_{number}_twist",
        title=f"Figure {number} in twist · {who} beam, springs GJ/ℓ",
        caption=f"Figure {number} of the report in twist: {who} beam, errors of the first three natural "
        "frequencies.",
        data=partial(data, boundary=boundary),
        draw=draw,
        sheets={".csv": Sheet(COLUMNS)},
        size=(9.0, 4.2),
    )


FIGURE_6_TWIST = _study(6, "fixed-free", "fixed/free")
FIGURE_7_TWIST = _study(7, "fixed-fixed", "fixed/fixed")
