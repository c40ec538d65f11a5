"""Parts of the page's beginning: springs, N and step for common ends, by the report's rule and a better."""

from __future__ import annotations

import beammodes as bm
from studies.page.evidence import Parts, agree, note, worst_of
from studies.page.markup import Cell, percent, significant, table

__all__ = ["parts"]

PAIRS, TOLERANCE, MODES = ("clamped-free", "clamped-clamped", "pinned-pinned", "free-free"), 0.01, 3
RULES = ("mitiguy", "gregory")
_FEW = 4


def parts() -> Parts:
    """Return the parts of this section: nothing of them is read from a folder."""
    rows: list[list[Cell]] = []
    pairs: list[tuple[float, float]] = []
    for pair in PAIRS:
        for rule in RULES:
            count = bm.segments_needed(pair, TOLERANCE, MODES, rule)
            chain = bm.Chain(bm.Beam.unit(), pair, count, rule)
            springs = [1 / weight for weight in bm.RULES[rule].hinge_weights(bm.Boundary.of(pair), count)]
            shown = ", ".join(str(spring) for spring in springs[:_FEW]) + ", …"
            error = [bm.frequency_error(pair, segments=count, mode=n, rule=rule) for n in range(1, MODES + 1)]
            worst = max(error, key=abs)
            solved = bm.chain_errors(chain, MODES)
            pairs += [(1 + a, 1 + float(b)) for a, b in zip(error, solved, strict=True)]
            step = significant(bm.stable_time_step(chain), 3)
            row: list[Cell] = [count, shown, percent(worst, 2), step]
            if rows and [pair, *row] == [rows[-1][0], *rows[-1][2:]]:
                rows[-1][1] = f"{rows[-1][1]}, {rule}"
            else:
                rows.append([pair, rule, *row])
    heads = ["ends", "rule", "N", "springs from the left, EI/ℓ", "largest error, %", "C, stable"]
    caption = f"Springs, segments and step for {100 * TOLERANCE:g} % in {MODES} frequencies.{note('choice')}"
    return {
        "table_choice": table(heads, rows, caption, words=(0, 1, 3)),
        "choice_tolerance": f"{100 * TOLERANCE:g} %",
        "choice_modes": str(MODES),
    }, {"choice": f"errors at these N, looked up and solved: {agree(worst_of(pairs), 1e-10)}"}
