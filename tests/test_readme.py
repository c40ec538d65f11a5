"""README's promises: its Python runs, its commands exist, its pictures are there."""

from __future__ import annotations

import doctest
import re
import shlex
import tomllib
from pathlib import Path

import pytest

import beammodes as bm
from beammodes.__main__ import main
from beammodes.vibration.integrators import accuracy_limit
from studies.c_table import SAFE_CONSTANT
from studies.step_size import OUTPUTS
from studies.step_trials import variable_step_cost

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def page(stem: str) -> str:
    return (ROOT / "beammodes" / "pages" / f"{stem}.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_it_is_short() -> None:
    assert len(README.split()) <= 1200
    assert README.count("![") <= 4


def test_python_blocks_run_and_print_what_they_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    found = blocks("python")
    assert found
    for block in found:
        # Each block may be pasted by itself.
        test = doctest.DocTestParser().get_doctest(block, {"bm": bm}, "README.md", "README.md", 0)
        assert test.examples
        assert doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


COMMANDS = [block for block in blocks("sh") if "beammodes " in block]


@pytest.mark.parametrize("block", COMMANDS, ids=range(len(COMMANDS)))
def test_shell_lines_run(
    block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in block.splitlines():
        assert line.startswith("beammodes ")
        assert main(shlex.split(line, comments=True)[1:]) == 0
        assert capsys.readouterr().out.strip()


def test_pictures_and_links_exist() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", README)
    assert targets
    for target in targets:
        assert (ROOT / target).is_file(), target


def test_set_up_commands_are_one_line_each_and_the_continuous_check_calls_the_test_one() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("python3 ")]
    assert [("studies" in line, "pytest" in line) for line in commands] == [(True, False), (False, True)]
    assert 'grep -m 1 -E "^python3 -m venv .*pytest" README.md' in (ROOT / ".ci" / "run").read_text()


def test_the_table_of_layouts_says_what_the_code_computes() -> None:
    rows = re.findall(r"^\| `(\w+)` \|.*\| (\S+) % \| (\d) \|", page("rules"), flags=re.MULTILINE)
    # Of the registry; a rule that is added there need not be described here.
    assert {"mitiguy", "gregory"} < {name for name, _, _ in rows} <= set(bm.RULES)
    for name, error, order in rows:
        assert error == f"{100 * bm.frequency_error('clamped-free', segments=10, mode=1, rule=name):+.3g}"
        assert int(order) == bm.error_law("clamped-free", 1, name).order


def test_numbers_in_the_text_are_computed_ones() -> None:
    counted = re.findall(r"(\d+) \(`(\w+)`\)", README)
    assert len(counted) >= 2
    for segments, rule in counted:
        assert int(segments) == bm.segments_needed("clamped-free", 0.01, 3, rule)
    exact = bm.frequency_error("clamped-free", segments=10**9, mode=1)
    assert f"{exact:.5e}" in page("accuracy")


def test_the_steps_in_the_text_are_computed_ones() -> None:
    motion = page("motion")
    accurate = [f"{accuracy_limit(integrator):.4f}" for integrator in ("rk4", "midpoint")]
    assert re.findall(r"(0\.\d+)/K_n", motion) == accurate
    safe = re.findall(r"(0\.\d+)/N²", motion)
    assert safe and set(safe) == {f"{SAFE_CONSTANT:.3f}"}
    step = bm.published_time_step(bm.Beam.unit(), modes=1)
    chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=12)
    cost = variable_step_cost(chain, step, OUTPUTS, tolerance=0.001)
    assert f"{cost.steps:.0f} for twelve segments and one mode at a tolerance of 0.001" in motion


def test_links_become_absolute_at_the_one_address_of_the_project() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    address = settings["project"]["urls"]["Repository"]
    text = README
    for rule in settings["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]["substitutions"]:
        text = re.sub(rule["pattern"], rule["replacement"], text)
    targets = re.findall(r"\]\(([^)]+)\)", text)
    raw = address.replace("github.com", "raw.githubusercontent.com")
    assert len(targets) == len(re.findall(r"\]\(([^)]+)\)", README)) > 20
    for target in targets:
        picture = target.endswith(".svg")
        assert target.startswith(f"{raw}/main/" if picture else f"{address}/blob/main/"), target


def test_the_citation_has_the_version() -> None:
    assert f"\nversion: {bm.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"## {bm.__version__}" in page("CHANGELOG")
