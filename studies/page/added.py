"""Parts of the page on what is added: the law, better rules, matched springs, and real beams."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import beammodes as bm
from studies import axial_force, nonuniform
from studies.compare import RELATIVE
from studies.page.atlas_data import MODES, SEGMENTS, atlas
from studies.page.evidence import Parts, agree, note, read, worst_of
from studies.page.markup import Cell, percent, significant, table

__all__ = ["parts"]

PAIRS, WANTED = ("clamped-free", "clamped-clamped"), (1, 2, 3)
TEN, FAR, LONG, MATCHED = 10, 10**5, 100, 3
#: One percent in three frequencies.
TOLERANCE = 0.01


def parts(folder: Path) -> Parts:
    """Return the parts of this section, from what the studies have written into a folder."""
    springs = bm.match_springs(PAIRS[0], MATCHED, MATCHED)
    return {
        "table_law": _law(),
        "rules_segments": str(TEN),
        "order_report": str(_order("mitiguy")),
        "order_best": str(max(map(_order, bm.RULES))),
        "table_rules": _rules(),
        "matched_segments": str(MATCHED),
        "matched_modes": str(MATCHED),
        "table_matched": _matched(springs.stiffness_ratio.tolist()),
        "matched_static": percent(springs.static_tip_deflection_error, 3),
        "table_axial": _axial(folder),
        "atlas_segments": str(SEGMENTS),
        "atlas_modes": str(MODES),
    }, {
        "law": f"at N = {FAR:,} {_law_agrees()} of the error",
        "rules": _rules_agree(),
        "matched": f"against the exact beam {_matched_agrees(springs.chain)} of the frequency",
        "axial": _axial_agrees(folder),
        "nonuniform": _taper_agrees(),
        "atlas": _atlas_agrees(),
    }


def _law() -> str:
    rows: list[list[Cell]] = []
    for pair in PAIRS:
        for mode in WANTED:
            law = bm.error_law(pair, mode)
            exact, tends = bm.frequency_error(pair, segments=20, mode=mode), float(law.at(np.array(20)))
            rows.append(
                [f"{pair}, mode {mode}", significant(law.coefficient), percent(tends), percent(exact)]
            )
    heads = ["report's springs", "c", "c/N² at N = 20, %", "error there, %"]
    return table(heads, rows, f"The law of the error.{note('law')}")


def _law_agrees() -> str:
    pairs = (
        (float(bm.error_law(pair, mode).at(np.array(FAR))), bm.frequency_error(pair, segments=FAR, mode=mode))
        for pair in PAIRS
        for mode in WANTED
    )
    return agree(worst_of(pairs), 1e-3)


def _order(name: str) -> int:
    return bm.RULES[name].declared_order(bm.Boundary.of(PAIRS[0]))


def _rules() -> str:
    def error(name: str) -> float:
        return bm.frequency_error(PAIRS[0], segments=TEN, mode=1, rule=name)

    rows: list[list[Cell]] = []
    for name in sorted(bm.RULES, key=lambda name: -abs(error(name))):
        rule = bm.RULES[name]
        needed = [bm.segments_needed(pair, TOLERANCE, 3, name) for pair in PAIRS]
        springs = [1 / w for w in rule.hinge_weights(bm.Boundary.of(PAIRS[0]), TEN)]
        changed = ", ".join(str(spring) for spring in springs[:3])
        rows.append([name, rule.used_by, changed, percent(error(name), 3), _order(name), *needed])
    heads = ["rule", "used by", "first springs, EI/ℓ", "error, %", "order", *(f"N, {pair}" for pair in PAIRS)]
    return table(heads, rows, f"Every rule of the library.{note('rules')}", words=(0, 1, 2))


def _rules_agree() -> str:
    beam = bm.Beam.unit()
    found = (
        (1 + float(solved), 1 + bm.frequency_error(PAIRS[0], segments=TEN, mode=1, rule=name))
        for name in bm.RULES
        for solved in bm.chain_errors(bm.Chain(beam, PAIRS[0], TEN, name), 1)
    )
    return f"for every rule {agree(worst_of(found), RELATIVE)} of the frequency"


def _matched(ratios: list[float]) -> str:
    heads = ["hinge", "spring, EI/ℓ"]
    rows: list[list[Cell]] = [[f"{i}", f"{ratio:.4f}"] for i, ratio in enumerate(ratios, start=1)]
    return table(heads, rows, f"Matched springs, from the wall.{note('matched')}", words=())


def _matched_agrees(chain: bm.Chain) -> str:
    solved = bm.solve_modes(bm.linearize(chain), MATCHED).angular_frequency
    exact = bm.euler_bernoulli(bm.Beam.unit(), PAIRS[0], MATCHED).angular_frequency
    return agree(worst_of(zip(solved, exact, strict=True)), 1e-11)


def _axial(folder: Path) -> str:
    shown = "20"

    def error(pair: str, case: str) -> float:
        (row,) = read(folder, "axial_force", boundary=pair, case=case, segments=shown)
        return float(row["relative_error"])

    rows: list[list[Cell]] = [
        [case, *(percent(error(pair, case), 3) for pair in axial_force.BOUNDARIES)]
        for case in axial_force.CASES
    ]
    caption = f"Error of the first frequency at half the buckling load, %, N = {shown}.{note('axial')}"
    return table(["springs", *axial_force.BOUNDARIES], rows, caption)


def _axial_agrees(folder: Path) -> str:
    found = []
    for pair in axial_force.BOUNDARIES:
        load = bm.Load(axial_force=-axial_force.HALF * bm.buckling_load(bm.Beam.unit(), pair))
        (row,) = read(folder, "axial_force", boundary=pair, case="mitiguy", segments="20")
        other = float(bm.frequency_error(pair, segments=20, mode=1, load=load, beam=bm.Beam.unit()))
        found.append((1 + float(row["relative_error"]), 1 + other))
    return f"{agree(worst_of(found), RELATIVE)} of the frequency"


def _taper_agrees() -> str:
    """Hold the exact beam, whose shapes are polynomials, against a chain too long to err."""
    exact = bm.euler_bernoulli(nonuniform.TAPER, nonuniform.BOUNDARY, MATCHED).angular_frequency
    chain = bm.Chain(nonuniform.TAPER, nonuniform.BOUNDARY, LONG, "gregory")
    solved = bm.solve_modes(bm.linearize(chain), MATCHED).angular_frequency
    return f"the tapered beam and {LONG} rods: {agree(worst_of(zip(solved, exact, strict=True)), 1e-6)}"


def _atlas_agrees() -> str:
    """Hold N and C of the atlas against the library's advice for one percent in three modes."""
    data = atlas()
    bending, place = data["motions"]["bending"], data["tolerances"].index(TOLERANCE)
    found = []
    for way in bm.recommend(PAIRS[0], TOLERANCE, 3):
        rule = list(bm.RULES).index(way.rule)
        record = data["records"][bending["chains"][bending["pairs"].index(PAIRS[0])][rule]]
        if record["needed"][2][place] != way.segments:
            raise ArithmeticError(f"the atlas and the advice differ for rule {way.rule}")
        if way.segments <= SEGMENTS:
            found.append((way.highest_angular_frequency, record["omega"][way.segments - 1]))
    return (
        f"for every rule the same N; highest frequencies, kept to six digits: {agree(worst_of(found), 1e-5)}"
    )
