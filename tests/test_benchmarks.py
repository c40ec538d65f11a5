"""The benchmarks measure what they say: their reference is right, and their contestants solve the chain."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy

import beammodes as bm
from studies import accuracy, batch_speed, benchmarks, motion_rivals, rivals, spin_up_rivals

FIRST = (1, 2, 3)


def test_reference_agrees_with_exact_matrices_to_fifty_digits() -> None:
    # Exact rational M and K from the symbolic derivation; their eigenvalues in 60 digits.
    for segments in (4, 16):
        chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments)
        model = bm.equations_of_motion(chain).linearize().in_unit_segments()
        frequencies = model.angular_frequencies(digits=60)
        with mpmath.workdps(60):
            for mode in FIRST:
                expected = mpmath.mpf(frequencies[mode - 1]) * segments**2
                assert abs(accuracy.chain_frequency(segments, mode) / expected - 1) < mpmath.mpf(10) ** -50


@pytest.mark.parametrize("segments", [4, 5, 6, 7, 31, 1000, 999_999])
def test_reference_takes_no_mode_for_another(segments: int) -> None:
    frequencies = [float(accuracy.chain_frequency(segments, mode)) for mode in FIRST]
    closed = rivals.METHODS["beammodes, closed form"].frequencies(segments)
    np.testing.assert_allclose(frequencies, closed, rtol=1e-12)


def test_beam_reference_is_the_exact_beam() -> None:
    exact = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", modes=3).angular_frequency
    np.testing.assert_allclose([float(accuracy.beam_frequency(mode)) for mode in FIRST], exact, rtol=1e-14)


@pytest.mark.parametrize("name", rivals.METHODS)
def test_every_method_solves_the_same_chain(name: str) -> None:
    method = rivals.METHODS[name]
    if find_spec(method.package) is None:
        pytest.skip(f"{method.package} is not installed")
    true, tolerance = [float(accuracy.chain_frequency(8, mode)) for mode in FIRST], 1e-6
    if method.of_beam:
        # Cubic elements: the error of ω is about (β/N)⁴/1440.
        true, tolerance = [float(accuracy.beam_frequency(mode)) for mode in FIRST], 1e-3
    np.testing.assert_allclose(method.frequencies(8), true, rtol=tolerance)


def test_own_hermite_elements_are_those_of_scikit_fem() -> None:
    pytest.importorskip("skfem")
    theirs = rivals.METHODS["scikit-fem Hermite elements"].frequencies(8)[0]
    assert accuracy.hermite_frequency(8) == pytest.approx(theirs, rel=1e-11)
    assert accuracy.hermite_frequency(8) == pytest.approx(float(accuracy.beam_frequency(1)), rel=1e-5)


def test_nodal_matrices_are_the_chains() -> None:
    model = bm.linearize(bm.Chain(bm.Beam.unit(), "clamped-free", 6))
    stiffness, mass = rivals.nodal_matrices(6)
    # Unit beam: a segment has mass 1/N and EI/ell = N over its length squared, 1/N².
    np.testing.assert_allclose(stiffness.toarray() * 6**3, model.stiffness_matrix, rtol=1e-13, atol=1e-10)
    np.testing.assert_allclose(mass.toarray() / 6, model.mass_matrix, rtol=1e-13, atol=1e-15)


def test_kanes_method_is_given_the_same_problem() -> None:
    assert benchmarks.same_equations(2) < 1e-12
    kane, q, u = rivals.kane_equations(2)
    mass, state = kane.linearize(A_and_B=False, op_point=dict.fromkeys((*q, *u), 0))[:2]
    model = bm.equations_of_motion(bm.Chain(bm.Beam.unit(), "clamped-free", 2)).linearize()
    ours = model.in_unit_segments()
    # Kane's equations stand on the other side, so both blocks have the opposite sign of M and K.
    assert -mass[2:, 2:] == ours.mass_matrix
    angles = np.array(ours.stiffness_matrix.tolist(), float)
    np.testing.assert_allclose(np.array(state[2:, :2].tolist(), float), angles, rtol=1e-14)


def test_a_table_names_what_is_missing_or_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    absent = rivals.Method(rivals.METHODS["SciPy `eigh(K, M)`"].frequencies, "no_such_package")
    monkeypatch.setitem(rivals.METHODS, "absent", absent)
    table = benchmarks.solving([8, 10**6], ["SciPy `eigh(K, M)`", "absent"])
    lines = table.splitlines()
    assert lines[2] == "| method | N = 8 | N = 1,000,000 |"
    assert "e-1" in lines[4] and "not feasible: 32,000 GB" in lines[4]
    assert lines[5].count("not installed") == 2


def test_a_method_is_not_tried_when_its_law_says_it_would_take_too_long() -> None:
    refused = benchmarks._refused("SciPy `eigh(K, M)`", 8192, (1024, 1.0))
    assert refused == {"refused": "not feasible: 8.5 min by N³"}
    assert benchmarks._refused("SciPy `eigh(K, M)`", 8192, (1024, 0.05)) is None


def test_failures_are_told_and_not_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    def give_up(segments: int) -> np.ndarray:
        raise ValueError(f"no | more\nthan {segments}")

    monkeypatch.setitem(rivals.METHODS, "sad", rivals.Method(give_up))
    assert benchmarks.cell("sad", 8, rivals.measure("sad", 8)) == "fails: ValueError: no / more than 8"
    wrong = {"seconds": 0.25, "frequencies": [1.0, 22.0, 61.0]}
    assert benchmarks.cell("sad", 100, wrong) == "fails: 250 ms, ω₁ = 1 for 3.52"
    assert benchmarks.cell("sad", 100, wrong | {"frequencies": [np.nan] * 3}).endswith("not real")
    assert benchmarks.cell("sad", 100, {"memory": True}) == "not feasible: over 8 GB"


def test_lookups_and_derivation_print_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    real = benchmarks.timed
    monkeypatch.setattr(benchmarks, "timed", lambda call, **_: real(call, budget=0.0))
    assert benchmarks.lookups(100).count("\n| ") == 8
    table = benchmarks.unequal([8, 2000])
    assert table.count("\n| ") == 3
    assert table.rstrip().endswith("| not tried |")
    assert "checked in this run" in benchmarks.deriving([2, 3], [2])
    assert "one BLAS thread" in benchmarks.environment()


@pytest.mark.parametrize("name", motion_rivals.METHODS)
def test_every_right_hand_side_is_that_of_the_same_chain(name: str) -> None:
    build, package, _ = motion_rivals.METHODS[name]
    if find_spec(package) is None:
        pytest.skip(f"{package} is not installed")
    q, u = motion_rivals.state_of(3)
    # Lagrange's equations in exact symbols, at this state.
    ours = bm.equations_of_motion(bm.Chain(bm.Beam.unit(), "clamped-free", 3))
    values = dict(zip((*ours.coordinates, *ours.speeds), (*q, *u), strict=True))
    values |= dict(zip(sympy.symbols("m ell EI", positive=True), (1 / 3, 1 / 3, 1.0), strict=True))
    mass, forces = (
        np.array(term.subs(values).evalf().tolist(), float)
        for term in (ours.mass_matrix, ours.velocity_terms + ours.static_forces)
    )
    expected = -np.linalg.solve(mass, forces[:, 0])
    # MuJoCo's chain has a trace of inertia more, 1e-10 in its springs' and masses' own units.
    rtol = 1e-7 if package == "mujoco" else 1e-11
    np.testing.assert_allclose(build(3)(q, u), expected, rtol=rtol, atol=rtol * np.abs(expected).max())


def test_right_hand_sides_are_timed_and_put_beside_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    real = motion_rivals.timed
    monkeypatch.setattr(motion_rivals, "timed", lambda call, **_: real(call, budget=0.0))
    lines = motion_rivals.moving([3, 12]).splitlines()
    assert lines[2] == "| method | N = 3 | N = 12 |"
    assert len(lines) == 5 + len(motion_rivals.METHODS) and lines[-1].endswith("| not tried |")
    monkeypatch.setitem(
        motion_rivals.METHODS,
        "wrong",
        (lambda n: lambda q, u: 1.01 * motion_rivals._dense(n)(q, u), "casadi", 9),
    )
    with pytest.raises(ArithmeticError, match=r"accelerations by different methods differ by"):
        motion_rivals.moving([3])


@pytest.mark.slow
def test_spin_ups_are_timed_and_held_against_the_beam_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    few = {
        name: replace(method, tried=((4, method.tried[0][1] and 0.01),))
        for name, method in spin_up_rivals.METHODS.items()
        if method.package != "casadi" or name.endswith("`sdirk2`")
    }
    few["missing"] = replace(few["MuJoCo `implicitfast`"], package="no_such_package")
    few["coarse"] = replace(few["beammodes, `sdirk2`"], tried=((1, 0.04), (2, 0.04)))
    monkeypatch.setattr(spin_up_rivals, "METHODS", few)
    monkeypatch.setattr(spin_up_rivals, "_DEGREES", (3, 4))
    monkeypatch.setattr(spin_up_rivals, "ACCURACY", 0.02)
    text = spin_up_rivals.spinning(list(few))
    # The largest deflection of chains of growing N, extrapolated: -0.57375 m.
    largest = re.search(r"-0\.5\d+", text)
    assert largest and float(largest[0]) == pytest.approx(-0.57375, abs=1e-5)
    rows = {row.split(" | ")[0][2:]: row for row in text.splitlines()[4:]}
    assert list(rows) == list(few) and "not run: not installed" in rows["missing"]
    # Four rods or elements are within two percent, by every tool that is there; two rods are not.
    for name, row in rows.items():
        assert ("not reached" in row) is (name == "coarse"), row
    assert "| 2 | 0.04 s |" in rows["coarse"]


def test_a_period_is_timed_by_implicit_and_explicit_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    real = spin_up_rivals.timed
    monkeypatch.setattr(spin_up_rivals, "timed", lambda call, **_: real(call, budget=0.0))
    lines = spin_up_rivals.growing([2, 201]).splitlines()
    # 2π over the limits of ωh, 0.1096 and 0.1574.
    assert lines[4].count("58 steps") == 2 and lines[5].count("40 steps") == 2
    assert lines[-1].endswith("| not tried |") or lines[-1].endswith("| not run: not installed |")


def test_one_lookup_by_matrices_is_the_same_error() -> None:
    expected = bm.frequency_error("clamped-free", segments=100, mode=1)
    assert benchmarks._one_by_matrices() == pytest.approx(expected, rel=1e-2)


def test_the_page_takes_the_tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("threadpoolctl")
    page = tmp_path / "beammodes" / "pages" / "benchmarks.md"
    page.parent.mkdir(parents=True)
    page.write_text(f"above\n{benchmarks.BEGIN}\nold\n{benchmarks.END}\nbelow · ω\n", "utf-8")
    monkeypatch.setattr(benchmarks, "ROOT", tmp_path)
    parts_in_order = (
        "environment",
        "deriving",
        "solving",
        "unequal",
        "moving",
        "spinning",
        "growing",
        "lookups",
        "batches",
    )
    for part in parts_in_order:
        monkeypatch.setattr(benchmarks, part, lambda part=part: f"the {part}\n")
    assert benchmarks.main([]) == 0
    assert "old" in page.read_text("utf-8")
    for _ in range(2):
        assert benchmarks.main(["--write"]) == 0
    text = page.read_text("utf-8")
    parts = "\n\n".join(f"the {part}" for part in parts_in_order)
    assert text == f"above\n{benchmarks.BEGIN}\n{parts}\n{benchmarks.END}\nbelow · ω\n"
    with pytest.raises(ValueError, match="once"):
        benchmarks.replaced("no marks", parts)


def test_a_process_of_its_own_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("threadpoolctl")
    result = benchmarks._measured("beammodes, closed form", 16)
    assert set(result) == {"seconds", "frequencies"}
    assert json.dumps(result) and not capsys.readouterr().out


def test_the_figure_has_a_line_for_every_method(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy, "SEGMENTS", (4, 6, 100))
    table = accuracy.STUDY.compute()
    errors = table.relative_error.to_pandas()
    assert not errors.isna().any().any()
    assert (errors.loc[["closed form", "flexibility form"]] < 1e-13).all().all()
    assert errors.loc["dense", 100] > 100 * errors.loc["flexibility form", 100]
    assert accuracy.STUDY.tables(table)[".csv"].startswith("method,segments,relative_error\nclosed form,4,")
    assert len(accuracy.STUDY.picture(table).axes[0].get_lines()) == len(accuracy.LINES) + 1


def test_what_a_billion_points_need() -> None:
    text = batch_speed.needs(bodies=0.01, plain=1e-5, handing=0.005)
    # 0.01 s times 10^9 are 2778 h, 1e-5 s times 10^9 2.8 h; chunks of 10 s and of 0.05 s, one every 5 ms.
    assert "2,778 core hours" in text and "about 2,000 cores" in text
    assert "0.01 ms each: 3 core hours" in text and "about 10 cores" in text
    assert "40 GB" in text  # five modes of eight bytes each


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of Dask, not ours
def test_studies_are_timed_on_every_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    few = {"segments": [10, 20], "right_mass": np.array([0.5]), "left_rotational_stiffness": [1.0]}
    monkeypatch.setattr(batch_speed, "BODIES", batch_speed.BODIES | few)
    monkeypatch.setattr(batch_speed, "PLAIN", batch_speed.PLAIN | {"segments": range(1, 9)})
    table = benchmarks.batches()
    plain = len(bm.BOUNDARIES) * len(batch_speed.PLAIN["rule"]) * 8 * batch_speed.MODES
    assert "20 frequencies with a body" in table and f"{plain:,} of plain ends" in table
    for name in ("one process", "2 processes", "Dask, 2 workers"):
        assert f"| {name} |" in table
