"""Where the report's spring rule comes from, and its own route to Figures 6 and 7."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy

from beammodes.accuracy import error_table
from beammodes.accuracy.error_table import derived_error_dataset
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.equations.derivation import wall_spring_weight
from beammodes.problem.beam import Beam


def test_wall_spring_is_the_reports() -> None:
    size = sympy.Symbol("N")
    # report, "Assigning Spring Constants", labels exchanged: 6N/(3N - 1) EI/L at the wall.
    assert sympy.simplify(1 / wall_spring_weight() - 6 * size / (3 * size - 1)) == 0
    # Its worked example: 24/11 for N = 4.
    assert 1 / wall_spring_weight().subs(size, 4) == sympy.Rational(24, 11)
    assert sympy.simplify(RULES["mitiguy"].clamped[0].at(size) - wall_spring_weight()) == 0


def hinge_deflections(chain: Chain, moments: list[Fraction]) -> list[Fraction]:
    """Deflections, in units of F ell³/EI, of nodes 1, 2, ... of a clamped-free chain under hinge moments."""
    angle, deflection, found = Fraction(0), Fraction(0), []
    for stiffness, moment in zip(chain.scaled.joint_stiffness, moments, strict=True):
        angle += moment / Fraction(stiffness)
        deflection += angle
        found.append(deflection)
    return found


@pytest.mark.parametrize("segments", range(1, 9))
def test_every_joint_deflects_as_the_beam_under_a_tip_force(segments: int) -> None:
    chain = Chain(Beam.unit(), "clamped-free", segments, rule="mitiguy")
    moments = [Fraction(segments - i) for i in range(segments)]
    # Euler's F x² (3L - x)/(6 EI) at x = j ell, theory.md section 1; in rationals, without tolerance.
    assert hinge_deflections(chain, moments) == [
        Fraction(j**2 * (3 * segments - j), 6) for j in range(1, segments + 1)
    ]


@pytest.mark.parametrize("segments", range(1, 9))
def test_a_tip_moment_asks_for_another_wall_spring(segments: int) -> None:
    # theory.md section 1: under an end moment the wall that is exact is 2 EI/ell; Euler: M x²/(2 EI).
    moments = [Fraction(1)] * segments
    exact = [Fraction(j**2, 2) for j in range(1, segments + 1)]
    walls = {rule: Chain(Beam.unit(), "clamped-free", segments, rule) for rule in ("double_wall", "mitiguy")}
    assert hinge_deflections(walls["double_wall"], moments) == exact
    assert hinge_deflections(walls["mitiguy"], moments) != exact


#: theory.md section 3, percent, as printed there.
PRINTED = {
    "clamped-free": {
        1: ("-14.676",),
        2: ("-3.366", "-24.916"),
        4: ("-0.800", "-7.446", "-13.165"),
        6: ("-0.352", "-3.423", "-6.136"),
        10: ("-0.126", "-1.251", "-2.264"),
        20: ("-0.0314", "-0.3145", "-0.5698"),
    },
    "clamped-clamped": {
        2: ("-35.044",),
        4: ("-12.991", "-20.999", "-27.893"),
        6: ("-6.300", "-11.101", "-15.016"),
        10: ("-2.372", "-4.371", "-6.233"),
        20: ("-0.6041", "-1.1311", "-1.6422"),
    },
}


@pytest.mark.parametrize("boundary", PRINTED)
def test_derived_errors_are_the_known_ones(boundary: str) -> None:
    rows = PRINTED[boundary]
    table = derived_error_dataset(boundary, segments=list(rows), modes=3)
    for segments, printed in rows.items():
        errors = table.relative_error.sel(segments=segments).squeeze().values
        assert [f"{100 * e:.{len(p.split('.')[1])}f}" for e, p in zip(errors, printed, strict=False)] == list(
            printed
        )
        assert np.isnan(errors[len(printed) :]).all()
    assert table.attrs["disagreement"] < 1e-10


def test_progress_is_reported() -> None:
    seen: list[tuple[int, int]] = []
    derived_error_dataset("pinned-pinned", segments=[1, 2], modes=1, progress=lambda *at: seen.append(at))
    assert seen == [(1, 2), (2, 2)]


def test_routes_that_disagree_stop_the_study(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(error_table, "ROUTES_AGREE", 0.0)
    with pytest.raises(ArithmeticError, match="clamped-free"):
        derived_error_dataset("clamped-free", segments=[2], modes=1)
