"""Parts of the page on time steps: the report's table of C, and those that are stable and accurate."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import beammodes as bm
from beammodes.closed_form.chain_frequencies import chain_frequency
from beammodes.vibration.integrators import accuracy_limit, amplification, stability_limit
from beammodes.vibration.stability import ROARK_CLAMPED_CLAMPED, published_constants
from studies import c_table, figure_1, step_size
from studies.c_table import SAFE_CONSTANT, exact_constants, step_constants
from studies.page.evidence import Parts, agree, note, read, worst_of
from studies.page.markup import Cell, significant, table

__all__ = ["parts"]

LENGTHS, PAIRS = (1, 2, 3, 4, 6, 10, 20, 50), ("clamped-free", "clamped-clamped")
TEN = 10


def parts(folder: Path) -> Parts:
    """Return the parts of this section, from what the studies have written into a folder."""
    shown, (modes, tolerance) = step_size.SEGMENTS[-1], (1, step_size.TOLERANCES[0])
    (recipe,) = read(
        folder,
        "step_size_recipe",
        boundary=PAIRS[0],
        segments=str(shown),
        recipe_modes=str(modes),
        rtol=f"{tolerance:g}",
    )
    eight = stability_limit("rk4") ** 2
    return {
        "c_exact_first": f"{exact_constants(1)[0]:.3f}",
        "table_c": _c_table(),
        "table_worked_step": _worked_step(),
        "too_long": f"{eight / stability_limit('rk4'):.2f}",
        "growth": f"{float(abs(amplification('rk4', eight))):.0f}",
        "c_chain_free": significant(_constant(PAIRS[0], TEN), 3),
        "c_chain_clamped": significant(_constant(PAIRS[1], TEN), 3),
        "recipe_steps": f"{float(recipe['steps']):.0f}",
        "recipe_segments": str(shown),
        "recipe_tolerance": f"{tolerance:g}",
        "c_safe": significant(SAFE_CONSTANT, 3),
        "accurate_rk4": significant(accuracy_limit("rk4")),
        "accurate_midpoint": significant(accuracy_limit("midpoint")),
        "table_steps": _steps(),
    }, {
        "c_table": _published_agree(),
        "steps": _steps_agree(),
        "recipe": _recipe_agrees(folder, shown),
        "accurate": _accurate_agree(),
    }


def _constant(pair: str, segments: int) -> float:
    """Return C of the longest stable step; a beam of units makes C and step the same number."""
    return bm.stable_time_step(bm.Chain(bm.Beam.unit(), pair, segments))


def _c_table() -> str:
    count = len(c_table.REPORT)
    columns = (
        ROARK_CLAMPED_CLAMPED,
        c_table.REPORT,
        published_constants().tolist(),
        exact_constants(count).tolist(),
        exact_constants(count, limit=stability_limit("rk4")).tolist(),
    )
    rows: list[list[Cell]] = [
        [n, f"{k:g}", f"{report:.3f}", f"{again:.3f}", exact, single]
        for n, (k, report, again, exact, single) in enumerate(zip(*columns, strict=True), start=1)
    ]
    heads = [
        "modes",
        "K, Roark",
        "C, the report",
        "8/K, rounded",
        "8/K, exact roots",
        "2√2/K: that mode stable",
    ]
    return table(heads, rows, f"The constant C of the report's step.{note('c_table')}", words=(), quoted=(2,))


def _worked_step() -> str:
    beam = figure_1.BEAM
    stable = bm.stable_time_step(bm.Chain(beam, figure_1.BOUNDARY, figure_1.SEGMENTS))
    rows: list[list[Cell]] = [
        [modes, published, stable, f"{published / stable:.0f}"]
        for modes in range(1, len(c_table.REPORT) + 1)
        for published in [bm.published_time_step(beam, modes)]
    ]
    caption = (
        f"The formula worked for the beam of Figure 1, L = {beam.length:g} m, EI = "
        f"{beam.mean_bending_stiffness:g} N m², ρA = {beam.mean_mass_per_length:g} kg/m; {figure_1.SEGMENTS} "
        f"segments.{note('steps')}"
    )
    heads = ["modes", "h, published, s", "h, stable, s", "published / stable"]
    return table(heads, rows, caption, words=())


def _published_agree() -> str:
    if published_constants().tolist() != list(c_table.REPORT):
        raise ArithmeticError("the report's table of C is not 8/K in three decimals")
    ratio = worst_of(zip(published_constants(), exact_constants(len(c_table.REPORT)), strict=True))
    return f"the report's five digits come back exactly; exact roots are within {100 * ratio:.1g} % of them"


def _steps() -> str:
    names = [f"{pair}: {kind}" for pair in PAIRS for kind in ("stable", "3 modes accurate")]
    rows: list[list[Cell]] = []
    for n in LENGTHS:
        row: list[Cell] = [n]
        for pair in PAIRS:
            chain = bm.Chain(bm.Beam.unit(), pair, n)
            if chain.elastic_modes == 0:
                row += [np.nan, np.nan]
                continue
            stable, accurate = step_constants(chain, 3)
            row += [significant(stable, 3), significant(min(stable, float(accurate[-1])), 3)]
        rows.append([*row, significant(SAFE_CONSTANT / n**2, 3)])
    caption = f"C for Runge-Kutta at fixed step, the report's springs.{note('accurate')}"
    return table(["N", *names, "always stable"], rows, caption, words=())


def _steps_agree() -> str:
    found = [
        (
            _constant(pair, n),
            stability_limit("rk4") / float(chain_frequency(pair, n, n if pair == PAIRS[0] else n - 1)),
        )
        for pair in PAIRS
        for n in LENGTHS
        if pair == PAIRS[0] or n > 1
    ]
    return agree(worst_of(found), 1e-11)


def _recipe_agrees(folder: Path, segments: int) -> str:
    """Say what the published step does as a fixed one, which the recipe's many steps prevent."""
    (row,) = read(
        folder,
        "step_size_growth",
        boundary=PAIRS[0],
        segments=str(segments),
        start=f"{step_size.SMALL:g}",
        fixed_step="published 1",
    )
    if not row["overflow"]:
        raise ArithmeticError("the published step as a fixed one must overflow")
    return (
        "as a fixed step the published one overflows from a millionth of a radian: many must take its place"
    )


def _accurate_agree() -> str:
    """Hold C of a long chain against that of the beam's own frequencies."""
    modes = 3
    exact = bm.euler_bernoulli(bm.Beam.unit(), PAIRS[0], modes).angular_frequency
    _, chain = step_constants(bm.Chain(bm.Beam.unit(), PAIRS[0], 60, "gregory"), modes)
    return "C of 60 rods and of the beam: " + agree(
        worst_of(zip(chain, accuracy_limit("rk4") / exact, strict=True)), 1e-3
    )
