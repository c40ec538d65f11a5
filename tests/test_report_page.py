"""The page: its numbers are the library's, its sources exist, and it is one file that needs no other."""

from __future__ import annotations

import ast
import doctest
import itertools
import json
import re
import shutil
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from drawn_ends import RULES_DRAWN
from page_reading import Tables, rows, same, stiffnesses

import beammodes as bm
import studies.__main__
from beammodes.problem.motions import unit_beam
from beammodes.vibration.stability import highest_angular_frequency
from studies import PAGE, c_table, every_study
from studies.page import atlas_data, build, choice, errors, markup, rods_data
from studies.page.evidence import EVIDENCE, Evidence, agree
from studies.page.section import SECTION, integral_over_strips
from studies.runner import missing

TESTS = Path(__file__).parent
FIGURES = TESTS.parent / "figures"


@pytest.fixture(scope="module")
def page() -> str:
    return build.page(FIGURES)


@pytest.fixture(scope="module")
def tables(page: str) -> dict[str, list[list[str]]]:
    return Tables(page).found


# --- Numbers ---------------------------------------------------------------------------------------------


def test_figures_6_and_7_in_numbers(tables: dict[str, list[list[str]]]) -> None:
    found = rows(tables, "Error in the first three natural frequencies")
    assert len(found) == 10
    for count, *cells in found:
        pairs = [(pair, mode) for pair in ("clamped-free", "clamped-clamped") for mode in (1, 2, 3)]
        for (pair, mode), cell in zip(pairs, cells, strict=True):
            same(cell, 100 * bm.frequency_error(pair, segments=int(count), mode=mode))
    # theory.md section 3, printed there to three decimals: N = 4.
    four = next(cells for cells in found if cells[0] == "4")
    known = ["-0.800", "-7.446", "-13.165", "-12.991", "-20.999", "-27.893"]
    for cell, value in zip(four[1:], known, strict=True):
        assert float(cell.replace("−", "-")) == pytest.approx(float(value), abs=0.006)


def test_segments_needed_are_the_librarys(tables: dict[str, list[list[str]]]) -> None:
    found = rows(tables, "Segments from which the error stays")
    assert [row[0] for row in found] == ["5 %", "1 %", "0.1 %"]
    for tolerance, *cells in found:
        limit = float(tolerance.removesuffix(" %")) / 100
        pairs = [(pair, modes) for pair in ("clamped-free", "clamped-clamped") for modes in (1, 2, 3)]
        assert cells == [str(bm.segments_needed(pair, limit, modes)) for pair, modes in pairs]


def test_the_c_table(tables: dict[str, list[list[str]]]) -> None:
    found = rows(tables, "The constant C")
    roots = np.asarray(bm.wavenumber("clamped-clamped", np.arange(1, 6))) ** 2
    for (n, k, report, again, exact, single), root in zip(found, roots, strict=True):
        assert report == again == f"{c_table.REPORT[int(n) - 1]:.3f}" == f"{8 / float(k):.3f}"
        same(exact, 8 / root)
        same(single, np.sqrt(8) / root)


def test_moduli(tables: dict[str, list[list[str]]]) -> None:
    for material, pounds, pascals in rows(tables, "Elastic modulus"):
        line = bm.MODULI[material]
        assert [int(part) for part in pounds.split(" to ")] == sorted({line.low, line.high})
        for shown, value in zip(pascals.split(" to "), sorted(set(line.pascals)), strict=True):
            same(shown, value / 1e9)


def test_the_worked_examples(tables: dict[str, list[list[str]]]) -> None:
    # The report: 24/11 at each wall for N = 4, EI/L elsewhere.
    for _, report, ours, decimals in rows(tables, "Springs in EI/ℓ"):
        assert report == ours
        assert {Fraction(text) for text in ours.split(", ")} == {Fraction(24, 11), Fraction(1)}
        for text, fraction in zip(decimals.split(", "), ours.split(", "), strict=True):
            same(text, float(Fraction(fraction)))


def test_springs_with_the_scans_labels_are_wrong_in_statics(tables: dict[str, list[list[str]]]) -> None:
    for count, exchanged, printed in rows(tables, "Tip deflection of a cantilever"):
        n = int(count)
        # Σ ((N-i) ell)² times flexibilities, over L³/3: wall 1, others (3N-1)/(6N), i = 0 at the wall.
        total = n**2 + Fraction(3 * n - 1, 6 * n) * sum((n - i) ** 2 for i in range(1, n))
        same(printed, float(100 * (total / Fraction(n**3, 3) - 1)))
        assert exchanged == "0"


def test_the_integral_of_figure_4(tables: dict[str, list[list[str]]]) -> None:
    found = {row[0]: row[1:] for row in rows(tables, "The integral")}
    area, second = integral_over_strips(SECTION)
    for name in ("the whole, by formula", "the whole, ∫ d² dA over strips"):
        same(found[name][0], area * 1e4)
        same(found[name][1], second * 1e8)
    # By hand, cm: web 0.56 × 18.3, flanges 10 × 0.85 at 9.575.
    same(found["web"][1], 0.56 * 18.3**3 / 12)
    same(found["both flanges"][1], 2 * (10 * 0.85**3 / 12 + 8.5 * 9.575**2))


def test_every_rule(tables: dict[str, list[list[str]]]) -> None:
    found = rows(tables, "Every rule of the library")
    assert {row[0] for row in found} == set(bm.RULES)
    for name, _, first, error, order, free, clamped in found:
        same(error, 100 * bm.frequency_error("clamped-free", segments=10, mode=1, rule=name))
        springs_of = bm.Chain(bm.Beam.unit(), "clamped-free", 10, name).joint_stiffness / 10
        assert [float(Fraction(text)) for text in first.split(", ")] == pytest.approx(springs_of[:3])
        assert int(order) == bm.error_law("clamped-free", 1, name).order
        assert int(free) == bm.segments_needed("clamped-free", 0.01, 3, name)
        assert int(clamped) == bm.segments_needed("clamped-clamped", 0.01, 3, name)


def test_the_law_and_matched_springs(tables: dict[str, list[list[str]]]) -> None:
    for words, coefficient, *_, error in rows(tables, "The law of the error"):
        pair, mode = words.split(", mode ")
        same(coefficient, bm.error_law(pair, int(mode)).coefficient)
        same(error, 100 * bm.frequency_error(pair, segments=20, mode=int(mode)))
    found = [float(cell) for _, cell in rows(tables, "Matched springs")]
    assert found == pytest.approx(bm.match_springs("clamped-free", 3, 3).stiffness_ratio, abs=5.1e-5)


def test_the_formula_of_the_step_worked(tables: dict[str, list[list[str]]]) -> None:
    # The report: h = C L² √(ρA/EI) with its C; the beam is Simo and Vu-Quoc's.
    unit = 10.0**2 * np.sqrt(1.2 / 14000.0)
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", 10)
    for modes, published, stable, ratio in rows(tables, "The formula worked"):
        h = c_table.REPORT[int(modes) - 1] * unit
        same(published, h)
        same(stable, np.sqrt(8) / highest_angular_frequency(chain) * unit)
        same(ratio, h / (np.sqrt(8) / highest_angular_frequency(chain) * unit))


def test_stable_steps(tables: dict[str, list[list[str]]]) -> None:
    for count, *cells, always in rows(tables, "C for Runge-Kutta"):
        n = int(count)
        same(always, n**-2.0 / np.sqrt(6))  # theory.md section 6
        for pair, cell in zip(("clamped-free", "clamped-clamped"), cells[::2], strict=True):
            chain = bm.Chain(bm.Beam.unit(), pair, n)
            same(cell, bm.stable_time_step(chain) if chain.elastic_modes else np.nan)


def test_the_first_table_is_the_librarys_advice(tables: dict[str, list[list[str]]]) -> None:
    found = rows(tables, "Springs, segments and step")
    assert {row[0] for row in found} == set(choice.PAIRS) and len(found) == 6
    for pair, names, count, springs, error, step in found:
        for rule in names.split(", "):
            assert int(count) == bm.segments_needed(pair, choice.TOLERANCE, choice.MODES, rule)
            chain = bm.Chain(bm.Beam.unit(), pair, int(count), rule)
            values = [float(Fraction(text)) for text in springs.removesuffix(", …").split(", ")]
            assert values == pytest.approx(chain.joint_stiffness[: len(values)] / int(count))
            worst = max(bm.chain_errors(chain, choice.MODES), key=abs)
            same(error, 100 * worst)
            same(step, np.sqrt(8) / highest_angular_frequency(chain))


# --- The atlas' data -------------------------------------------------------------------------------------


def record(pair: str, rule: str, motion: str = "bending") -> dict[str, list[list[float]]]:
    data = atlas_data.atlas()
    kind = data["motions"][motion]
    return data["records"][kind["chains"][kind["pairs"].index(pair)][list(bm.RULES).index(rule)]]


PAIRS_LISTED = [pair.name for pair in bm.BOUNDARIES]


def test_the_data_of_the_atlas_are_the_librarys() -> None:
    data, random = atlas_data.atlas(), np.random.default_rng(8)
    for _ in range(150):
        pair, rule = str(random.choice(PAIRS_LISTED)), str(random.choice(RULES_DRAWN))
        n, mode = int(random.integers(2, data["segments"] + 1)), int(random.integers(1, data["modes"] + 1))
        known, chain = record(pair, rule), bm.Chain(bm.Beam.unit(), pair, n, rule)
        error = known["error"][n - 1][mode - 1]
        exact = bm.frequency_error(pair, segments=n, mode=mode, rule=rule)
        assert (error is None and np.isnan(exact)) or error == pytest.approx(exact, rel=1e-5)
        assert known["omega"][n - 1] == pytest.approx(highest_angular_frequency(chain), rel=1e-5)
        springs_of = stiffnesses(data["springs"][known["springs"][n - 1]])
        assert springs_of == pytest.approx((chain.joint_stiffness / n).tolist(), rel=1e-12)


def test_segments_needed_of_the_atlas_are_the_librarys() -> None:
    data, random = atlas_data.atlas(), np.random.default_rng(9)
    for _ in range(60):
        pair, rule = str(random.choice(PAIRS_LISTED)), str(random.choice(RULES_DRAWN))
        modes, place = (
            int(random.integers(1, data["modes"] + 1)),
            int(random.integers(len(data["tolerances"]))),
        )
        exact = bm.segments_needed(pair, data["tolerances"][place], modes, rule)
        assert record(pair, rule)["needed"][modes - 1][place] == (exact if exact <= data["longest"] else 0)


def test_the_atlas_in_twist_is_the_librarys() -> None:
    data, random = atlas_data.atlas(), np.random.default_rng(15)
    assert data["motions"]["bending"]["pairs"] == PAIRS_LISTED
    for _ in range(20):
        pair = str(random.choice(data["motions"]["twist"]["pairs"]))
        rule = str(random.choice(list(bm.RULES)))
        n, mode = 2 * int(random.integers(1, data["segments"] // 2 + 1)), int(random.integers(1, 6))
        known = record(pair, rule, "twist")
        chain = bm.AxialChain(unit_beam(), pair, n, rule, motion="twist")
        exact = bm.axial_modes(unit_beam(), pair, 5, motion="twist").angular_frequency
        found = bm.solve_modes(chain, 5).angular_frequency
        error = known["error"][n - 1][mode - 1]
        assert error == (pytest.approx(found[mode - 1] / exact[mode - 1] - 1, rel=1e-5, abs=1e-11)
                         if mode <= len(found) else None)  # fmt: skip
        assert known["omega"][n - 1] * bm.stable_time_step(chain) == pytest.approx(data["limit"], rel=1e-5)
        springs_of = stiffnesses(data["springs"][known["springs"][n - 1]])
        assert springs_of == pytest.approx((chain.joint_stiffness / n).tolist(), rel=1e-12)
        place = int(random.integers(len(data["tolerances"])))
        needed = bm.segments_needed(pair, data["tolerances"][place], mode, rule, motion="twist")
        assert known["needed"][mode - 1][place] == (needed if needed <= data["longest"] else 0)


def test_the_data_of_rods_are_the_librarys() -> None:
    # Trusted, by exponentials of the twelve equations; without polar inertia, which twist alone has.
    known = {"pretwisted by 90°, EI ratio 16": (3.6087715, 9.961236), "helix of one turn, round": (6.590381,)}
    for rod in rods_data.rods()["rods"]:
        assert rod["omega"][: len(known.get(rod["name"], ()))] == pytest.approx(
            known.get(rod["name"], ()), rel=1e-6
        )
        chain = bm.SpatialChain(rods_data.RODS[rod["name"]], "clamped-free", 5, "gregory")
        kept = rod["chains"][rods_data.RULES.index("gregory")][0]
        assert kept["errors"] == pytest.approx(
            bm.rod_errors(chain, rods_data.MODES).tolist(), rel=1e-5, abs=1e-11
        )
        assert np.allclose(kept["nodes"], chain.nodes, atol=5.1e-4)
        shapes = np.linalg.norm(kept["shapes"], axis=2)
        # The clamped end does not move; the fastest node by 1, and none in twist alone.
        largest = shapes.max(axis=1)
        assert not shapes[:, 0].any() and np.isclose(largest[largest > 0], 1.0, atol=2e-3).all()
        assert (largest == 0).sum() == chain.rod.is_straight


def test_the_atlas_knows_from_where_a_law_holds() -> None:
    # gregory, N = 12, mode 1: the law's sign is not the error's (a rule of order 4 reaches its law late).
    known = record("clamped-free", "gregory")
    assert known["error"][11][0] > 0 > known["law"][0]
    assert known["lawFrom"][0] > atlas_data.SEGMENTS
    for pair, rule in itertools.product(("clamped-free", "clamped-clamped"), RULES_DRAWN):
        known = record(pair, rule)
        for mode, first in enumerate(known["lawFrom"], start=1):
            assert first == bm.law_holds_from(pair, mode, rule, within=atlas_data.LAW_WITHIN)
            for n in range(first or atlas_data.SEGMENTS, atlas_data.SEGMENTS + 1) if first else ():
                law = known["law"][mode - 1] / n ** known["lawOrder"][mode - 1]
                assert abs(law / known["error"][n - 1][mode - 1] - 1) <= atlas_data.LAW_WITHIN * 1.001


# --- Sources ---------------------------------------------------------------------------------------------


def resolved(name: str) -> object:
    """What a dotted name stands for: a module as far as modules go, attributes from there."""
    parts = name.split(".")
    for cut in range(len(parts) - 1, 0, -1):
        try:
            found: object = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[cut:]:
            found = getattr(found, attribute)
        return found
    raise AssertionError(f"{name} is not there")


@pytest.mark.parametrize("evidence", EVIDENCE, ids=lambda evidence: evidence.key)
def test_functions_and_tests_that_sources_name_exist(evidence: Evidence) -> None:
    resolved(evidence.function)
    resolved(evidence.second)
    assert evidence.function != evidence.second
    assert evidence.tests
    for test in evidence.tests:
        file, _, function = test.partition("::")
        code = ast.parse((TESTS / f"{file}.py").read_text(encoding="utf-8"))
        assert function in {node.name for node in code.body if isinstance(node, ast.FunctionDef)}, test


def test_a_name_that_is_not_there_is_noticed() -> None:
    with pytest.raises(AttributeError):
        resolved("beammodes.accuracy.law.no_law")


def test_every_source_is_referred_to(page: str) -> None:
    for evidence in EVIDENCE:
        assert f'href="#source-{evidence.key}"' in page and f'id="source-{evidence.key}"' in page


# --- One file, whole, the same every time ----------------------------------------------------------------


def test_nothing_is_fetched_and_everything_is_there(page: str) -> None:
    assert (
        len(page.encode()) < 9_000_000
    )  # small enough to send by mail; 6.9 million today, figures are added
    targets = re.findall(r'(?:src|href|action)="([^"]{0,60})', page)
    assert targets and all(target.startswith(("data:", "#")) for target in targets)
    assert not re.search(
        r"@import|url\((?!#)|fetch\(|XMLHttpRequest|<link[^>]*stylesheet|\$\{", page.split("data:")[0]
    )
    for target in {target[1:] for target in targets if target.startswith("#")}:
        assert f'id="{target}"' in page, target
    ids = re.findall(r'\bid="([\w-]+)"', re.sub(r'src="[^"]*"', "", page))
    assert len(ids) == len(set(ids))


def test_every_figure_of_the_report_is_there_and_so_is_every_other_study(page: str) -> None:
    for name, study in every_study().items():
        assert (f'id="picture-{name}"' in page) is study.reproducible, name
    assert 'id="picture-section"' in page  # Figure 4
    assert page.count("<img ") == sum(study.reproducible for study in every_study().values())


def test_the_same_page_twice(page: str) -> None:
    assert build.page(FIGURES) == page


def test_a_table_that_disagrees_stops_the_page(tmp_path: Path) -> None:
    for path in FIGURES.glob("*.csv"):
        shutil.copy(path, tmp_path)
    changed = tmp_path / "figure_6.csv"
    text = changed.read_text(encoding="utf-8")
    assert "-0.14676138" in text
    changed.write_text(text.replace("-0.14676138", "-0.14676158"), encoding="utf-8")
    with pytest.raises(ArithmeticError, match="two routes"):
        errors.parts(tmp_path)
    with pytest.raises(ArithmeticError, match="nan"):
        agree(float("nan"), 1.0)


def test_pictures_lose_only_what_is_not_seen() -> None:
    path = '<path d="M 1.23456 -7.001 \nL 2 3.14159"/>'
    drawn = f"<?xml?>\n<svg>\n <!-- it's --><metadata>x</metadata>\n {path}\n</svg>"
    kept = "data:image/svg+xml,%3Csvg%3E %3Cpath d='M 1.23 -7.00 L 2 3.14'/%3E %3C/svg%3E"
    assert markup._vector(drawn) == kept


def test_data_cannot_end_their_script_nor_text_its_attribute() -> None:
    text = build._json({"a": "</script><b>"})
    assert "<" not in text and json.loads(text) == {"a": "</script><b>"}
    assert markup.table(["n"], [["<b>&"]], "").count("<b>") == 0
    assert markup.escaped("\"'<") == "&quot;&#x27;&lt;"


@pytest.mark.parametrize(
    "module", [build, markup, import_module("studies.page.evidence"), import_module("studies.page.section")]
)
def test_examples_of_the_pages_functions(module: ModuleType) -> None:
    found = doctest.testmod(module)
    assert found.attempted and not found.failed


def test_the_page_comes_last_and_makes_what_it_lacks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[list[str]] = []
    first, *others = every_study()
    monkeypatch.setattr(studies.__main__, "run_all", lambda names, *_: asked.append(list(names)))
    monkeypatch.setattr(studies.__main__, "write_gallery", lambda _: None)
    monkeypatch.setattr(build, "write", lambda folder: asked.append([folder.name]) or "report.html")
    for name in others:
        for ending in (".csv", ".svg"):
            (tmp_path / f"{name}{ending}").touch()
    assert missing(every_study(), tmp_path) == [first]
    assert studies.__main__.main([PAGE, "--into", str(tmp_path)]) == 0
    assert studies.__main__.main([PAGE, "truck", "--into", str(tmp_path)]) == 0
    assert asked == [[first], [tmp_path.name], ["truck", first], [tmp_path.name]]
    asked.clear()
    assert studies.__main__.main(["--into", str(tmp_path)]) == 0
    assert asked == [[first, *others], [tmp_path.name]]
