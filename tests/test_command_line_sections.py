"""Sections and materials on the command line, and what it shows of the project: rules, pages, completion."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import beammodes as bm
from beammodes.__main__ import main
from beammodes.problem.materials import MATERIALS

INCH, POUND = 0.0254, 0.45359237 * 9.80665
#: A flat bar of 600 by 60 by 20 mm in each system: its unit of length, and what is typed.
BARS = {"SI": 1.0, "mm-N-t": 1e-3, "in-lbf-s": INCH}


def asked(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    capsys.readouterr()
    assert main([*words, "--json"]) == 0, capsys.readouterr().err
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert answer["schema_version"] == 1
    return answer


def bar(metre: float) -> list[str]:
    return [
        "--length",
        f"{0.6 / metre!r}",
        "--section",
        f"rectangle(width={0.06 / metre!r}, height={0.02 / metre!r})",
    ]


@pytest.mark.parametrize("system", BARS)
def test_a_section_and_a_material_are_a_beam_in_every_system_of_units(
    system: str, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = [*bar(BARS[system]), "--units", system]
    answer = asked(
        capsys, "frequencies", "clamped-free", "--segments", "6", "--material", "aluminium", *typed
    )
    steel = MATERIALS["aluminum"]
    beam = bm.Beam.from_section(
        bm.Rectangle(0.06, 0.02), density=steel.density, elastic_modulus=steel.elastic_modulus, length=0.6
    )
    exact = bm.euler_bernoulli(beam, "clamped-free", 3).frequency
    assert [row["exact_frequency"] for row in answer["modes"]] == pytest.approx(exact.tolist(), rel=1e-9)
    assert answer["units"]["system"] == system and "aluminum" in answer["beam"]
    # The same numbers typed: E and ρ in the units of the system.
    metre, newton = BARS[system], POUND if system == "in-lbf-s" else 1.0
    own = [repr(steel.elastic_modulus * metre**2 / newton), repr(steel.density * metre**4 / newton)]
    given = ["--elastic-modulus", own[0], "--density", own[1]]
    again = asked(capsys, "frequencies", "clamped-free", "--segments", "6", *given, *typed)
    assert [row["frequency"] for row in again["modes"]] == pytest.approx(
        [row["frequency"] for row in answer["modes"]], rel=1e-9
    )


def test_each_motion_takes_its_own_numbers_of_a_section(capsys: pytest.CaptureFixture[str]) -> None:
    steel, section = MATERIALS["steel"], bm.Rectangle(0.06, 0.02)
    numbers = bm.Rod.of_section(
        section,
        density=steel.density,
        elastic_modulus=steel.elastic_modulus,
        poisson_ratio=steel.poisson_ratio,
    )
    common = ["--segments", "4", *bar(1.0), "--material", "steel"]
    twist = asked(capsys, "springs", "fixed-free", *common, "--motion", "twist")
    assert twist["hinges"][1]["stiffness"] == pytest.approx(numbers["torsional_stiffness"] / 0.15, rel=1e-9)
    stretch = asked(capsys, "springs", "fixed-free", *common, "--motion", "stretch")
    assert stretch["hinges"][1]["stiffness"] == pytest.approx(steel.elastic_modulus * 12e-4 / 0.15, rel=1e-9)
    space = asked(capsys, "springs", "clamped-free", *common, "--motion", "space")["hinges"][1]
    found = [space[name] for name in space if name not in ("hinge", "position", "place")]
    assert found[1] / found[2] == pytest.approx(9.0 if found[1] > found[2] else 1 / 9, rel=1e-9)
    # Without a unit named, a material's numbers are in SI, and the answer says so.
    assert space and asked(capsys, "springs", "clamped-free", *common)["units"]["system"] == "SI"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--material steel", "--section must be given with --material"),
        ("--section circle(diameter=0.01) --material steel --ei 3", "--ei must be left out with --section"),
        ("--section circle(diameter=0.01) --length 1", "--elastic-modulus must be given"),
        ("--section circle(diameter=0.01) --material stele --length 1", 'did you mean "steel"'),
        (
            "--section circle(radius=0.01) --material steel --length 1",
            "number of circle must be one of diameter",
        ),
        ("--section circel(diameter=0.01) --material steel --length 1", 'did you mean "circle"'),
        ("--section circle(diameter=0.01) --material steel", "--length must be given with --section"),
        (
            "--section circle(diameter=x) --material steel --length 1",
            "diameter of --section must be a number",
        ),
        ("--section circle(diameter=-1) --material steel --length 1", "diameter must be greater than 0"),
        (
            "--section circle(diameter=1) --length 1 --density 1 --elastic-modulus 1 --motion twist",
            "poisson-ratio",
        ),
    ],
)
def test_what_is_missing_or_twofold_is_named(
    words: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["springs", "clamped-free", "--segments", "4", *words.split(" ")]) == 2
    said = capsys.readouterr()
    assert message in said.err and said.out == ""


def test_springs_name_the_rule_of_least_error_and_recommend_where_the_default_stands(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for ends, count in (("clamped-clamped", 7), ("clamped-free(mass=0.5)", 9), ("pinned-pinned", 5)):
        answer = asked(capsys, "springs", ends, "--segments", str(count))
        found = {}
        for rule in bm.RULES:
            try:
                found[rule] = abs(bm.frequency_error(ends, segments=count, mode=1, rule=rule))
            except ValueError:
                continue
        assert found[answer["best_rule"]] <= min(value for value in found.values() if value == value) * (
            1 + 1e-9
        )
        assert abs(answer["first_mode_error"]) == found["mitiguy"]
    assert answer["best_rule"] == "mitiguy"
    assert main(["recommend", "clamped-free", "--tolerance", "1%"]) == 0
    need = bm.segments_needed("clamped-free", 0.01)
    assert (
        f"mitiguy, the default of other commands, is that of Mitiguy's report: N = {need} here"
        in capsys.readouterr().out
    )


def test_rules_and_pages_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert [row["rule"] for row in asked(capsys, "rules")["rules"]] == [*bm.RULES]
    folder = Path(bm.__file__).parent / "pages"
    pages = asked(capsys, "guide")["pages"]
    assert sorted(pages) == sorted(path.stem for path in folder.glob("*.md")) and all(pages.values())
    for name in ("mujoco", "Drake-Gazebo", "changelog"):
        path = folder / f"{'CHANGELOG' if name == 'changelog' else name.lower().replace('-', '_')}.md"
        assert asked(capsys, "guide", name)["text"] == path.read_text(encoding="utf-8").rstrip()
    assert main(["guide", "mujco"]) == 2 and 'did you mean "mujoco"' in capsys.readouterr().err


def test_shells_complete_commands_and_options(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("shtab")
    for shell in ("bash", "zsh"):
        script = asked(capsys, "completion", shell)["script"]
        assert "time-step" in script and "--rho-a" in script
        path, program = tmp_path / shell, shutil.which(shell)
        path.write_text(script, encoding="utf-8")
        if program is not None and shell == "bash":
            assert subprocess.run([program, "-n", path], timeout=20, check=False).returncode == 0
    assert main(["completion", "fish"]) == 2 and "shell must be one of bash" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2 and "pip install shtab" in capsys.readouterr().err


def test_what_is_no_finite_number_is_null(capsys: pytest.CaptureFixture[str]) -> None:
    step = asked(capsys, "time-step", "clamped-free", "--segments", "4", "--integrator", "implicit_euler")
    assert step["time_step"] is None and math.isfinite(step["accurate_time_step"])
