"""Every study runs, draws what it computed, writes whole files, and matches what is committed."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import studies
from studies import c_table
from studies.__main__ import main
from studies.compare import RELATIVE, rows_of, study_differs

FIGURES = Path(__file__).parent.parent / "figures"

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
def test_the_command_regenerates_what_is_committed(tmp_path: Path) -> None:
    assert main(["--into", str(tmp_path), "figure_6", "figure_7", "c_table"]) == 0
    written = [path for path in tmp_path.iterdir() if path.suffix in (".csv", ".md")]
    tables = {path.name: path.read_text(encoding="utf-8") for path in written}
    assert len(tables) == 5
    assert study_differs("", tables) == []
    assert main(["--into", str(tmp_path / "again"), "c_table"]) == 0
    for ending in (".svg", ".png"):
        assert (tmp_path / f"c_table{ending}").read_bytes() == (
            tmp_path / "again" / f"c_table{ending}"
        ).read_bytes()


@pytest.mark.parametrize("name", studies.NAMES)
def test_each_study_has_its_files_and_its_parts(name: str) -> None:
    module = import_module(f"studies.{name}")
    assert callable(module.data)
    assert callable(module.draw)
    for ending in (".csv", ".svg"):
        assert (FIGURES / f"{name}{ending}").stat().st_size > 200
    svg = (FIGURES / f"{name}.svg").read_text(encoding="utf-8")
    assert "<dc:date>" not in svg


def test_drawing_shows_the_data() -> None:
    table = c_table.data()
    axes = c_table.draw(table).axes[0]
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), table.C_published)
    assert axes.get_ylabel().startswith("C in")


def test_unknown_study_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["figure_8"])
    assert stop.value.code == 2
    assert "figure_8" in capsys.readouterr().err
