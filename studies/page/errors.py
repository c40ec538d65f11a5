"""Parts of the page on errors: Figures 6 and 7 in numbers, segments needed, and sums of modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import beammodes as bm
from beammodes.exact.exact_beam import plain_modes
from studies import appendix
from studies.compare import RELATIVE
from studies.page.atlas_data import MODES, TOLERANCES, segments_for
from studies.page.evidence import Parts, agree, note, read, worst_of
from studies.page.markup import Cell, percent, significant, table

__all__ = ["parts"]

FIGURES = {"figure_6": "clamped-free", "figure_7": "clamped-clamped"}
LENGTHS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20)
WANTED = (0.05, 0.01, 0.001)
EXAMPLE = ("clamped-clamped", 0.01, 3)


def parts(folder: Path) -> Parts:
    """Return the parts of these sections, from what the studies have written into a folder."""
    errors = {name: _errors(folder, name) for name in FIGURES}
    rows = read(folder, "appendix", quantity="moment", modes=str(appendix.DRAWN))
    return {
        "table_errors": _error_table(errors),
        "table_needed": _needed(),
        "needed_example": str(bm.segments_needed(*EXAMPLE)),
        "modal_drawn": str(appendix.DRAWN),
        "pluck_place": f"{appendix.AT:g}",
        "table_modal": _modal(folder),
        "moment_missed": f"{100 * float(rows[0]['relative_error']):.0f} %",
    }, {
        "errors": _errors_agree(errors),
        "needed": _needed_agrees(),
        "modal": f"the first {appendix.DRAWN} shapes and sin(nπx/L): {_sines()}",
    }


def _errors(folder: Path, name: str) -> dict[tuple[int, int], float]:
    return {
        (int(row["segments"]), int(row["mode"])): float(row["relative_error"]) for row in read(folder, name)
    }


def _error_table(errors: dict[str, dict[tuple[int, int], float]]) -> str:
    rows: list[list[Cell]] = [
        [n, *(percent(table.get((n, mode), np.nan)) for table in errors.values() for mode in (1, 2, 3))]
        for n in LENGTHS
    ]
    heads = ["N", *(f"Fig. {name[-1]}, {order}" for name in errors for order in ("1st", "2nd", "3rd"))]
    caption = f"Error in the first three natural frequencies, %, the report's springs.{note('errors')}"
    return table(heads, rows, caption, words=())


def _errors_agree(errors: dict[str, dict[tuple[int, int], float]]) -> str:
    found = (
        (1 + error, 1 + bm.frequency_error(FIGURES[name], segments=n, mode=mode))
        for name, points in errors.items()
        for (n, mode), error in points.items()
    )
    return f"at all points of both figures {agree(worst_of(found), RELATIVE)} of the frequency"


def _needed() -> str:
    rows: list[list[Cell]] = [
        [f"{100 * tolerance:g} %"]
        + [bm.segments_needed(pair, tolerance, modes) for pair in FIGURES.values() for modes in (1, 2, 3)]
        for tolerance in WANTED
    ]
    names = [
        f"Fig. {name[-1]}, {modes} mode{'s' if modes > 1 else ''}" for name in FIGURES for modes in (1, 2, 3)
    ]
    caption = f"Segments from which the error stays within a tolerance, the report's springs.{note('needed')}"
    return table(["tolerance", *names], rows, caption)


def _needed_agrees() -> str:
    """Hold the one-by-one answers against those of the atlas, found from all errors at once."""
    for pair in FIGURES.values():
        found = segments_for(bm.Boundary.of(pair), bm.RULES["mitiguy"])
        for tolerance in set(WANTED) & set(TOLERANCES):
            for modes in range(1, MODES + 1):
                other = int(found[modes - 1, TOLERANCES.index(tolerance)])
                if other and other != bm.segments_needed(pair, tolerance, modes):
                    raise ArithmeticError(f"two answers for {pair}, {modes} modes within {tolerance}")
    return "they agree at every point"


def _modal(folder: Path) -> str:
    def error(quantity: str, modes: int) -> str:
        (row,) = read(folder, "appendix", quantity=quantity, modes=str(modes))
        return significant(100 * float(row["relative_error"]), 2)

    rows: list[list[Cell]] = [
        [f"{n} mode{'s' if n > 1 else ''}", *(error(quantity, n) for quantity in appendix.QUANTITIES)]
        for n in (1, 2, 3, 5, 10, 20, 50)
    ]
    heads = ["terms", "deflection, %", "bending moment, %"]
    return table(heads, rows, f"Largest error of the sum, over the largest value.{note('modal')}")


def _sines() -> str:
    x = np.linspace(0.0, 1.0, 101)
    shapes = plain_modes(appendix.BEAM, appendix.BOUNDARY, appendix.DRAWN).shape(x)
    sines = np.sin(np.pi * np.outer(np.arange(1, appendix.DRAWN + 1), x))
    return agree(float(np.abs(shapes / np.abs(shapes).max(axis=1, keepdims=True) - sines).max()), 1e-3)
