"""README's promises: its Python runs, its commands exist, its pictures are there."""

from __future__ import annotations

import doctest
import re
import shlex
from pathlib import Path

import pytest

from beammodes.__main__ import main

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_python_blocks_run_and_print_what_they_say() -> None:
    found = blocks("python")
    assert found
    for block in found:
        test = doctest.DocTestParser().get_doctest(block, {}, "README.md", "README.md", 0)
        assert test.examples
        assert doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


@pytest.mark.parametrize(
    "line", [line for block in blocks("sh") for line in block.splitlines() if line.startswith("beammodes ")]
)
def test_shell_lines_run(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(line, comments=True)[1:]) == 0
    assert capsys.readouterr().out.strip()


def test_pictures_and_links_exist() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", README)
    assert targets
    for target in targets:
        assert (ROOT / target).is_file(), target


def test_the_map_names_every_module() -> None:
    modules = {path.name for path in (ROOT / "beammodes").glob("*.py")} - {"__init__.py", "checks.py"}
    assert modules <= set(re.findall(r"`(\w+\.py)`", README))


def test_set_up_commands_are_one_line_each_and_the_continuous_check_calls_the_test_one() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("python3 ")]
    assert [("studies" in line, "pytest" in line) for line in commands] == [(True, False), (False, True)]
    assert 'grep -m 1 -E "^python3 -m venv .*pytest" README.md' in (ROOT / ".ci" / "run").read_text()
