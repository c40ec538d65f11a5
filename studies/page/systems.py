"""Parts of the page on Figures 1, 2, 3 and 5: what the report draws without numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import beammodes as bm
from studies import figure_1, figures_3_and_5, truck
from studies.compare import RELATIVE
from studies.page.evidence import Parts, agree, note, read, worst_of
from studies.page.markup import Cell, significant, table

__all__ = ["parts"]

#: So many rods are the beam, as far as a page shows digits.
LONG = 100


def parts(folder: Path) -> Parts:
    """Return the parts of these sections, from what the studies have written into a folder."""
    apart, leaves, lowest = _motion(folder)
    off = abs(lowest / figure_1.LARGEST - 1)
    return {
        "figure_1_rods": str(figure_1.SEGMENTS),
        "figure_1_modes": str(figure_1.MODES),
        "figure_1_apart": f"{100 * apart:.2g} %",
        "figure_1_leaves": significant(leaves, 3),
        "figure_1_lowest": significant(lowest, 3),
        "table_truck": _truck(folder),
    }, {
        "motion": f"shifting, they agree to {100 * apart:.2g} % of the largest deflection; turning, the "
        f"chain's lowest point is the beam's within {100 * off:.2g} %",
        "truck": _truck_agrees(folder),
        "bodies": _bodies_agree(folder),
    }


def _motion(folder: Path) -> tuple[float, float, float]:
    """Return how far chain and modes are apart on the first body; when modes leave on the second, and how
    low the chain's tip comes there [m].
    """

    def line(motion: str, model: str) -> dict[float, float]:
        rows = read(folder, "figure_1", motion=motion, model=model)
        return {float(r["time"]): float(r["tip_deflection"]) for r in rows if r["tip_deflection"]}

    chain, modes = line("linear", "gregory"), line("linear", "modes")
    apart = max(abs(chain[time] - modes[time]) for time in modes) / max(map(abs, modes.values()))
    alone = line("rotational", "modes")
    return apart, max(alone), min(line("rotational", "gregory").values())


def _truck(folder: Path) -> str:
    rows: list[list[Cell]] = []
    for name in truck.MODES:
        rigid, bed = (read(folder, "truck", bed=bed, motion=name)[0] for bed in ("rigid", "flexible"))
        # A rigid bed's bending is far above what the other motions do.
        stiff = float(rigid["exact_frequency"])
        known = stiff if stiff < 10 * float(bed["exact_frequency"]) else np.nan
        rows.append([name, known, float(bed["exact_frequency"]), float(bed["frequency"])])
    heads = ["motion", "rigid bed, Hz", "flexible bed, Hz", f"its chain of {truck.SEGMENTS} rods, Hz"]
    return table(heads, rows, f"Figure 2 with chosen numbers: a light truck.{note('truck')}")


def _truck_agrees(folder: Path) -> str:
    """Hold the chain that was written against one of many rods, which must be the beam."""
    exact = [float(row["exact_frequency"]) for row in read(folder, "truck", bed="flexible")]
    chain = bm.Chain(truck.BED, (truck.FRONT, truck.REAR), LONG, "gregory")
    long = bm.solve_modes(bm.linearize(chain), len(exact))
    return f"a chain of {LONG} rods and the beam: " + agree(
        worst_of(zip(long.frequency, exact, strict=True)), 1e-5
    )


def _bodies_agree(folder: Path) -> str:
    worst = 0.0
    for name, boundary in (("figure_3", figures_3_and_5.ONE_BODY), ("figure_5", figures_3_and_5.TWO_BODIES)):
        rows = read(folder, name, held_by="free body", rule="mitiguy", segments=str(figures_3_and_5.DRAWN))
        chain = bm.Chain(bm.Beam.unit(), boundary, figures_3_and_5.DRAWN)
        solved = bm.solve_modes(bm.linearize(chain), len(rows)).angular_frequency
        found = [(float(row["angular_frequency"]), w) for row, w in zip(rows, solved.tolist(), strict=True)]
        worst = max(worst, worst_of(found))
    return agree(worst, RELATIVE)
