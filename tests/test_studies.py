"""Every study runs, draws what it computed, writes whole files, and matches what is committed."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from computed_studies import computed

from studies import c_table, every_study
from studies.__main__ import main
from studies.compare import RELATIVE, rows_of, study_differs
from studies.runner import gallery

FIGURES = Path(__file__).parent.parent / "figures"
#: Seconds from which on a study is a slow test.
SLOW = 5.0

#: Errors to 18 digits, chain frequency / Euler-Bernoulli frequency - 1, rule mitiguy. Source: recomputed
#: from the chain's characteristic polynomial and the beam's characteristic equation with 40 to 60 digits.
EXACT = {
    ("clamped-free", 1): ("-0.146761384435133887",),
    ("clamped-free", 2): ("-0.0336613785001899576", "-0.24916465165657336"),
    ("clamped-free", 4): ("-0.00800036931311286663", "-0.0744553726829416928", "-0.131648733865869216"),
    ("clamped-free", 9): ("-0.00155563112754332952", "-0.0154127623445123718", "-0.0278760122478643545"),
    ("clamped-free", 13): ("-0.000744047863918419559", "-0.00742451286565477009", "-0.0134506142972449087"),
    ("clamped-clamped", 2): ("-0.350443110672990569",),
    ("clamped-clamped", 4): ("-0.129906931681696586", "-0.209994893197791477", "-0.278932663264851526"),
    ("clamped-clamped", 9): ("-0.029112266346842272", "-0.0533578379199086031", "-0.0755558094064414978"),
    ("clamped-clamped", 13): ("-0.0141789026168473994", "-0.0263659166450434217", "-0.0380058390383112422"),
}


def read(name: str) -> list[dict[str, str]]:
    return rows_of(FIGURES / name)


@pytest.mark.parametrize(
    ("name", "boundary"), [("figure_6", "clamped-free"), ("figure_7", "clamped-clamped")]
)
def test_committed_figures_agree_with_published_errors(name: str, boundary: str) -> None:
    found = {(int(r["segments"]), int(r["mode"])): float(r["relative_error"]) for r in read(f"{name}.csv")}
    assert {r["boundary"] for r in read(f"{name}.csv")} == {boundary}
    assert {n for n, _ in found} == set(range(1 if boundary == "clamped-free" else 2, 21))
    checked = 0
    for (pair, segments), errors in EXACT.items():
        for mode, error in enumerate(errors, start=1):
            if pair == boundary:
                assert found[segments, mode] == pytest.approx(float(error), rel=RELATIVE)
                checked += 1
    assert checked >= 10


def test_committed_c_table() -> None:
    rows = read("c_table.csv")
    assert [row["C_published"] for row in rows] == [row["C_regenerated"] for row in rows]
    for row in rows:
        assert float(row["C_single_mode"]) * np.sqrt(8) == pytest.approx(float(row["C_exact"]), rel=RELATIVE)
    chains = {(row["boundary"], row["segments"]): float(row["C_chain"]) for row in read("c_table_chains.csv")}
    # theory.md section 6.
    assert float(f"{chains['clamped-free', '10']:.3g}") == 0.00424


@pytest.mark.slow
def test_the_command_writes_the_same_bytes_again(tmp_path: Path) -> None:
    for folder in ("once", "again"):
        assert main(["--into", str(tmp_path / folder), "c_table", "simulators"]) == 0
    files = sorted(path.name for path in (tmp_path / "once").iterdir())
    assert {"c_table.csv", "c_table.md", "c_table.svg", "c_table.png", "README.md"} <= set(files)
    for file in files:
        assert (tmp_path / "once" / file).read_bytes() == (tmp_path / "again" / file).read_bytes()


#: Those whose code another study runs too: figure_7 is figure_6, and figure_5 is figure_3, of other ends.
TWINS = {"figure_7", "figure_5"}
#: Those whose own tests compute and draw them: test_rule_studies, test_uncertainty, test_schematic.
ELSEWHERE = {"segments_map", "uncertainty", "schematics"}
#: Those of some seconds whose numbers other tests hold: test_rule_studies, test_rods_in_space.
SECONDS = {"better_figures", "hinge_orders", "rods_in_space"}

EVERY_STUDY = pytest.mark.parametrize(
    "name",
    [
        pytest.param(
            name,
            marks=pytest.mark.slow if study.seconds > SLOW or name in TWINS | ELSEWHERE | SECONDS else (),
        )
        for name, study in every_study().items()
    ],
)


@EVERY_STUDY
def test_its_tables_are_those_committed_and_its_picture_is_drawn_without_warnings(name: str) -> None:
    assert study_differs(name, every_study()[name].tables(computed(name))) == []
    figure = every_study()[name].picture(computed(name))
    figure.draw_without_rendering()
    assert figure.get_suptitle() == every_study()[name].title
    # Panels and bars: of the system and its chains.
    panels = {"figure_3": 7, "figure_5": 7, "truck": 8}
    assert figure.axes and len(figure.axes) == panels.get(name, len(figure.axes))


@pytest.mark.parametrize("name", every_study())
def test_each_study_is_told_and_has_its_files(name: str) -> None:
    study = every_study()[name]
    assert study.title and study.caption.endswith(".") and ".csv" in study.sheets
    # A heading and one row at least; the shortest today has 302 bytes, and new ones may be shorter.
    for ending in (".svg", *study.sheets):
        assert (FIGURES / f"{name}{ending}").stat().st_size > 50, f"run python -m studies {name}"
    svg = (FIGURES / f"{name}.svg").read_text(encoding="utf-8")
    assert "<dc:date>" not in svg


def test_the_list_names_every_study(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--list"]) == 0
    told = capsys.readouterr().out
    assert all(f"{name} " in told and study.caption in told for name, study in every_study().items())


def test_the_gallery_shows_every_study_and_is_the_one_committed() -> None:
    text = (FIGURES / "README.md").read_text(encoding="utf-8")
    assert text == gallery(FIGURES)
    assert re.findall(r"\]\((\w+)\.svg\)", text) == list(every_study())
    assert all((FIGURES / target).is_file() for target in re.findall(r"\]\(([^)]+)\)", text))


def test_two_studies_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    twin = replace(c_table.STUDY, caption="Another.")
    monkeypatch.setattr("studies.truck.STUDY", twin)
    with pytest.raises(ValueError, match="'c_table' twice"):
        every_study.__wrapped__()


def test_drawing_shows_the_data() -> None:
    table = computed("c_table")
    axes = c_table.STUDY.picture(table).axes[0]
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), table.C_published)
    assert axes.get_ylabel().startswith("C in")


def test_unknown_study_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["figure_8"])
    assert stop.value.code == 2
    assert "figure_8" in capsys.readouterr().err
