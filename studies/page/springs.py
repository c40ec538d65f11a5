"""Parts of the page on springs, statics, moduli and the section: the report's rules and worked examples."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import beammodes as bm
from studies.page import section
from studies.page.evidence import Parts, agree, note, worst_of
from studies.page.markup import Cell, figure, percent, significant, table

__all__ = ["as_printed", "parts"]

EXAMPLES = {"clamped-free": "Figure 3, cantilever/free", "clamped-clamped": "Figure 5, cantilever/cantilever"}
#: The report's worked examples, quoted: N = 4, EI/L at the hinges from the left.
QUOTED = {"clamped-free": "24/11, 1, 1, 1", "clamped-clamped": "24/11, 1, 1, 1, 24/11"}
FOUR, LENGTHS = 4, (1, 2, 4, 8, 16)
RULE = bm.RULES["mitiguy"]


def parts(folder: Path) -> Parts:
    """Return the parts of these sections; nothing of them is read from a folder."""
    del folder
    wall, inside, checked = _derived()
    formula, weight = (str(part).replace("*", "").replace("-", "−") for part in (wall, 1 / wall))
    content = {
        "wall_spring": formula,
        "wall_weight": weight,
        "table_examples": _examples(),
        "table_statics": _statics(),
        "table_moduli": _moduli(),
        "picture_section": figure(
            section.drawing(), "Figure 4, an IPE 200 less its fillets.", "section"
        ).replace("<figure", '<figure class="small"', 1),
        "table_section": section.table_section(note("section")),
        "section_stiffness": significant(
            section.SECTION.second_moment * bm.elastic_modulus("steel") / 1e6, 3
        ),
        "section_web_share": f"{100 * section.web_share():.0f} %",
    }
    assert inside == 1
    return content, {
        "springs": f"they agree exactly, as fractions, for N = 1 to {checked}",
        "statics": "the report's springs agree with the beam exactly, as fractions, at every N shown",
        "moduli": _moduli_agree(),
        "section": section.agreement(),
    }


def _derived() -> tuple[Any, Fraction, int]:
    """Return the wall's and the inner spring, and up to which N the rule has been checked against them."""
    import sympy

    from beammodes.equations.derivation import wall_spring_weight

    weight, most = wall_spring_weight(), 100
    for count in range(1, most + 1):
        derived = Fraction(str(weight.subs(sympy.Symbol("N"), count)))
        if RULE.hinge_weights(bm.Boundary.of("clamped-free"), count)[0] != derived:
            raise ArithmeticError(f"the report's wall spring is not the derived one for N = {count}")
    inside = RULE.hinge_weights(bm.Boundary.of("clamped-free"), FOUR)[1]
    return sympy.cancel(1 / weight), 1 / inside, most


def _examples() -> str:
    rows: list[list[Cell]] = []
    for pair, name in EXAMPLES.items():
        springs = [1 / weight for weight in RULE.hinge_weights(bm.Boundary.of(pair), FOUR)]
        ours = ", ".join(map(str, springs))
        if ours != QUOTED[pair]:
            raise ArithmeticError(f"the report's example for {pair} is not met: {ours}")
        solved = bm.Chain(bm.Beam.unit(), pair, FOUR).joint_stiffness / FOUR
        rows.append([name, QUOTED[pair], ours, ", ".join(f"{spring:.4f}" for spring in solved)])
    heads = ["example, N = 4", "the report", "rule, exactly", "chain, in numbers"]
    return table(
        heads, rows, f"Springs in EI/ℓ, from the left.{note('springs')}", words=(0, 1, 2, 3), quoted=(1,)
    )


def as_printed(segments: int) -> bm.Chain:
    """Return a cantilever of unit rods, EI = ρA = 1, with springs as the scan labels them."""
    inner = Fraction(6 * segments, 3 * segments - 1)
    lengths = [Fraction(0), *[Fraction(1)] * segments]
    return bm.Chain.from_pieces(
        length=lengths,
        mass=lengths,
        rotary_inertia=[length / 12 for length in lengths],
        joint_stiffness=[Fraction(1), *[inner] * (segments - 1)],
        boundary="clamped-free",
    )


def _statics() -> str:
    rows: list[list[Cell]] = []
    beam = bm.beam_statics(bm.Beam.unit(), "clamped-free", "tip_force").own.deflection
    for count in LENGTHS:
        exact = beam * count**3
        ours, printed = (
            bm.chain_statics(chain, "tip_force").own.deflection / exact - 1
            for chain in (bm.Chain(bm.Beam.unit(), "clamped-free", count), as_printed(count))
        )
        if ours != 0:
            raise ArithmeticError(f"the tip of {count} rods is off by {ours}")
        rows.append([count, "0", percent(float(printed))])
    heads = ["N", "labels exchanged: error, %", "as printed: error, %"]
    return table(
        heads, rows, f"Tip deflection of a cantilever under a force there.{note('statics')}", words=()
    )


def _moduli() -> str:
    rows: list[list[Cell]] = []
    for line in bm.MODULI.values():
        pounds, pascals = (
            " to ".join(dict.fromkeys(f"{value:.3g}" for value in ends))
            for ends in ((line.low, line.high), [value / 1e9 for value in line.pascals])
        )
        rows.append([line.material, pounds, pascals])
    heads = ["material", "the report, 10⁶ lbf/in²", "E, GPa"]
    return table(heads, rows, f"Elastic modulus of some materials.{note('moduli')}", words=(0,), quoted=(1,))


def _moduli_agree() -> str:
    from scipy.constants import psi

    found = ((line.pascals[0], line.low * 1e6 * psi) for line in bm.MODULI.values())
    return agree(worst_of(found), 1e-12)
