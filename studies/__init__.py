"""One file per figure or table: `data()` computes a Dataset, `draw(data)` returns a Figure.

`python -m studies [NAME ...]` writes each one's SVG, PNG and CSV into `figures/`, and from all of them the
page `figures/report.html`.
"""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], None]

#: Every study, in the order in which they run.
NAMES = (
    "figure_6",
    "figure_7",
    "c_table",
    "error_by_rule",
    "better_figures",
    "simulators",
    "uncertainty",
    "segments_map",
    "cost_front",
    "quadrature",
    "figure_3",
    "figure_5",
    "truck",
    "schematics",
    "axial_force",
    "nonuniform",
    "step_size",
    "figure_1",
    "appendix",
    "campbell",
    "motion_spectrum",
    "spin_up",
    "accuracy",
)

#: The page that is made of their files, last.
PAGE = "report"
#: Those that take longest, longest first: where several run at once, these start first.
SLOWEST = ("step_size", "spin_up", "accuracy", "figure_1", "motion_spectrum", "figure_6", "segments_map")
