"""The plan of the house: which file may import which, what no file may contain, what is public."""

from __future__ import annotations

import ast
import graphlib
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import typing
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import beammodes

PACKAGE = Path(beammodes.__file__).parent
ROOT = Path(__file__).parents[1]
FOLDERS = sorted(path.parent for path in PACKAGE.glob("*/__init__.py"))
FILES = {
    path.stem: path
    for path in sorted(PACKAGE.rglob("*.py"))
    if path.parent == PACKAGE or path.stem != "__init__"
}
# Each folder uses only those before it; the files beside them come first or last.
ORDER = [
    "numerics",
    "problem",
    "exact",
    "chains",
    "equations",
    "vibration",
    "closed_form",
    "accuracy",
    "springs",
    "dynamics",
    "exporters",
    "auditing",
    "batch",
    "views",
    "command_line",
]
HEAVY = {"matplotlib", "xarray", "sympy", "casadi", "scipy"}
# Modules that exist for the sake of these libraries; all others load them when they are first needed.
MAY_IMPORT = {
    "symbolic": {"sympy"},
    "numeric": {"casadi"},
    "forward_dynamics": {"casadi"},
    "implicit": {"casadi"},
    "runs": {"casadi"},
    "derivation": {"sympy"},
    "film": {"matplotlib"},
    "own_axes": {"matplotlib"},
}


@cache
def tree(stem: str) -> ast.Module:
    return ast.parse(FILES[stem].read_text(encoding="utf-8"))


def nodes(node: ast.AST, *, inside_functions: bool) -> Iterator[ast.AST]:
    """Everything that can run, so without the bodies of `if TYPE_CHECKING`."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and not inside_functions:
            continue
        yield child
        yield from nodes(child, inside_functions=inside_functions)


def imports(stem: str, *, inside_functions: bool = True) -> set[str]:
    """Dotted names of all that a file imports; `from folder import file` counts as folder.file."""
    found = set()
    for node in nodes(tree(stem), inside_functions=inside_functions):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{stem}.py line {node.lineno}: a relative import"
            file = str(node.module).rpartition(".")[2] in FILES
            found |= {str(node.module)} if file else {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def rooms(stem: str) -> set[str]:
    """The files of the package that a file imports; a name of the package itself comes from __init__."""
    names = [name.split(".") for name in imports(stem) if name.startswith("beammodes.")]
    return {next((part for part in reversed(parts) if part in FILES), "__init__") for parts in names}


def module(stem: str) -> str:
    """A file's dotted name."""
    return ".".join(["beammodes", *FILES[stem].relative_to(PACKAGE).with_suffix("").parts])


def test_the_reader_of_imports_reads_imports() -> None:
    assert {"beam", "chain", "ends", "exact_beam", "rules", "__init__", "__main__"} <= set(FILES)
    assert rooms("beam") == {"arrays", "checks", "deferred", "profiles", "sections"}
    assert {"chain", "beam", "advice_table"} <= rooms("commands")  # inside functions
    assert "numpy" in imports("chain", inside_functions=False)


def test_no_import_cycle() -> None:
    graph = {stem: rooms(stem) for stem in FILES}
    order = list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError and names the cycle
    assert order.index("beam") < order.index("chain") < order.index("linear") < order.index("__main__")


def test_folders_use_only_those_above_them() -> None:
    assert {folder.name for folder in FOLDERS} == set(ORDER)
    for stem in FILES:
        folder = FILES[stem].parent.name
        if folder in ORDER:
            used = {FILES[other].parent.name for other in rooms(stem)} - {PACKAGE.name}
            assert used <= set(ORDER[: ORDER.index(folder) + 1]), stem


def test_no_two_files_share_a_name() -> None:
    stems = [path.stem for path in PACKAGE.rglob("*.py") if path.stem != "__init__"]
    assert len(stems) == len(set(stems))


@pytest.mark.parametrize("folder", ORDER)
def test_a_folder_says_what_it_owns_and_holds_nothing_of_its_own(folder: str) -> None:
    code = ast.parse((PACKAGE / folder / "__init__.py").read_text(encoding="utf-8"))
    assert ast.get_docstring(code) and len(code.body) == 1


# What a beam is: its sections, its ends, its load; and what knows no physics.
GIVEN = {"problem", "numerics"}
CHECKS = {"checks", "deferred"}
EXACT = sorted(stem for stem, path in FILES.items() if path.parent.name == "exact")
PROBLEM = sorted(stem for stem, path in FILES.items() if path.parent.name in GIVEN)


@pytest.mark.parametrize("stem", EXACT)
def test_the_exact_beam_shares_no_code_with_the_chain(stem: str) -> None:
    # The page "design": the judge imports what a beam is, the checks, plain numerics, and itself.
    assert all(FILES[used].parent.name in {*GIVEN, "exact"} for used in rooms(stem) - CHECKS)


@pytest.mark.parametrize("stem", PROBLEM)
def test_what_is_given_knows_nothing_of_chains_or_solutions(stem: str) -> None:
    assert all(FILES[used].parent.name in GIVEN for used in rooms(stem) - CHECKS)


def test_nothing_imports_the_command_line_or_the_package_itself() -> None:
    assert [stem for stem in FILES if {"__main__", "__init__"} & rooms(stem)] == []


def defined(stem: str) -> set[str]:
    """Names that a file binds at its top level, other than by an import."""
    found = set()
    for node in tree(stem).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {
                part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)
            }
    return found


def test_a_name_is_imported_from_the_file_that_defines_it() -> None:
    homes = {module(stem): defined(stem) for stem in FILES if not stem.startswith("__")}
    elsewhere = [
        f"{path.relative_to(ROOT)} line {node.lineno}: {alias.name}"
        for folder in (PACKAGE, ROOT / "tests", ROOT / "studies")
        for path in sorted(folder.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and node.module in homes
        for alias in node.names
        if alias.name not in homes[node.module]
    ]
    assert elsewhere == []
    for stem in set(FILES) - {"__init__", "__main__"}:
        assert set(import_module(module(stem)).__all__) <= defined(stem), stem


def test_the_version_stands_in_one_place() -> None:
    written = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "version" in written["project"]["dynamic"]
    assert ROOT / written["tool"]["hatch"]["version"]["path"] == PACKAGE / "version.py"
    changes = (PACKAGE / "pages" / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"(?m)^## (\S+)", changes)[0] == beammodes.__version__
    for path in [*ROOT.glob("CITATION.cff"), *(ROOT / ".github").glob("CITATION.cff")]:
        citation = path.read_text(encoding="utf-8")
        assert re.findall(r"(?m)^version: *\"?([^\s\"]+)", citation) == [beammodes.__version__]


def test_the_docstring_lists_the_folders_in_their_order() -> None:
    plan = re.findall(r"(?m)^([a-z_]+)/ +\S", beammodes.__doc__ or "")
    assert plan == ORDER


def test_heavy_libraries_stay_in_their_rooms() -> None:
    for stem in FILES:
        loaded = {name.split(".")[0] for name in imports(stem, inside_functions=False)}
        assert loaded & HEAVY <= MAY_IMPORT.get(stem, set()), stem


#: What no file may contain, and the rule by which ruff refuses it, as pyproject.toml sets it.
FORBIDDEN = {
    "eval(text)": "S307",
    "exec(text)": "S102",
    "import pickle": "TID251",
    "from pickle import loads": "TID251",
    "import pickle as p; p.loads(text)": "S301",
    "import cloudpickle": "TID251",
    "import subprocess; subprocess.run(text, shell=True)": "S602",
    "from subprocess import Popen; Popen(text, shell=True)": "S602",
    "import os; os.system(text)": "S605",
    "import yaml; yaml.load(text, yaml.Loader)": "S506",
    "import sympy; sympy.sympify(text)": "TID251",
    "import sympy as sp; sp.parse_expr(text)": "TID251",
    "from sympy import sympify": "TID251",
    "from sympy.core.sympify import sympify": "TID251",
    "from sympy.parsing.sympy_parser import parse_expr": "TID251",
    "import matplotlib; matplotlib.rcParams['font.size'] = 3": "TID251",
    "from matplotlib import rcParams": "TID251",
    "import matplotlib.pyplot as plt; plt.rcParams.update({})": "TID251",
    "import matplotlib.pyplot as plt; plt.show()": "TID251",
}


def test_the_linter_refuses_what_no_file_may_contain() -> None:
    ruff = shutil.which("ruff", path=Path(sys.executable).parent) or shutil.which("ruff")
    if ruff is None:
        pytest.skip("ruff is not installed")
    program = "".join(f"def f{k}(text):\n    {code}\n" for k, code in enumerate(FORBIDDEN))
    for folder in ("beammodes", "beammodes/problem", "studies"):
        command = [ruff, "check", "--output-format=json", f"--stdin-filename={folder}/new.py", "-"]
        ran = subprocess.run(command, input=program, cwd=ROOT, capture_output=True, text=True, check=False)
        found = {(fault["location"]["row"] // 2 - 1, fault["code"]) for fault in json.loads(ran.stdout)}
        assert set(enumerate(FORBIDDEN.values())) <= found, folder


def test_the_continuous_checks_name_every_test_of_an_engine() -> None:
    """The plain set-up has no engines, where such tests are skipped."""
    run = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    for path in (ROOT / "tests").glob("test_*.py"):
        if re.search(
            r'importorskip\("(mujoco|pinocchio|pydrake|nbclient)"', path.read_text(encoding="utf-8")
        ):
            assert f"tests/{path.name}" in run


def test_no_file_switches_those_rules_off() -> None:
    for path in [*PACKAGE.rglob("*.py"), *(ROOT / "studies").rglob("*.py")]:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"ruff: noqa|noqa(?!: [A-Z])|noqa:.*\b(S\d|TID)", text), path


def test_every_file_says_what_it_owns_and_what_is_public() -> None:
    for stem in FILES:
        loaded = beammodes if stem == "__init__" else import_module(module(stem))
        assert ast.get_docstring(tree(stem)), stem
        assert loaded.__all__, stem
        assert all(hasattr(loaded, name) for name in loaded.__all__), stem


def test_no_public_name_is_a_files_name() -> None:
    # design.md seam 7: with lazy imports the second access would return the module.
    assert set(beammodes.__all__) & {*FILES, *ORDER} == set()


def test_public_names_read_twice() -> None:
    for name in beammodes.__all__:
        first = getattr(beammodes, name)
        assert getattr(beammodes, name) is first, name
        assert not isinstance(first, ModuleType), name


def test_public_names_are_listed() -> None:
    assert dir(beammodes) == sorted(beammodes.__all__)
    assert len(set(beammodes.__all__)) == len(beammodes.__all__)
    assert {"Beam", "Chain", "frequency_error", "__version__"} <= set(beammodes.__all__)


def test_type_hints_of_public_names_can_be_resolved() -> None:
    for name in beammodes.__all__:
        if callable(getattr(beammodes, name)):
            typing.get_type_hints(getattr(beammodes, name))


def test_unknown_names_are_an_error() -> None:
    with pytest.raises(AttributeError, match="'beammodes' has no attribute 'absent'"):
        beammodes.absent  # noqa: B018


def test_lazy_names_are_those_that_type_checkers_see() -> None:
    (block,) = (node for node in tree("__init__").body if isinstance(node, ast.If))
    assert ast.unparse(block.test) == "TYPE_CHECKING"
    seen = {}
    for node in block.body:
        assert isinstance(node, ast.ImportFrom)
        for alias in node.names:
            assert alias.asname == alias.name  # only so is it re-exported
            seen[alias.name] = str(node.module).removeprefix("beammodes.")
    assert seen == beammodes._HOME


def test_lazy_names_are_public_at_home() -> None:
    for name, stem in beammodes._HOME.items():
        home = import_module(f"beammodes.{stem}")
        assert name in home.__all__, name
        assert getattr(beammodes, name) is getattr(home, name), name


def test_importing_changes_no_matplotlib_settings(tmp_path: Path) -> None:
    modules = [module(stem) for stem in FILES if not stem.startswith("__")]
    program = (
        "import importlib, matplotlib\n"
        "before = dict(matplotlib.rcParams.copy())\n"
        "import beammodes\n"
        f"for name in {modules!r}: importlib.import_module(name)\n"
        "for name in beammodes.__all__: getattr(beammodes, name)\n"
        "after = dict(matplotlib.rcParams)\n"
        "print([name for name in before.keys() | after.keys() if before[name] != after[name]])\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        timeout=600,
        check=False,
    )
    assert ran.stderr == ""
    assert ran.stdout == "[]\n"


def tracked_files() -> list[str]:
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        return []
    listed = subprocess.run(
        [git, "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=False
    )
    return [name for name in listed.stdout.split("\0") if name]


def test_top_level_of_the_repository() -> None:
    # design.md, "What holds the house together".
    allowed = {"pyproject.toml", "beammodes", "studies", "tests", "figures", "README.md"}
    allowed |= {"LICENSE", "CITATION.cff", ".ci", ".github", ".gitignore"}  # what tools require
    tracked = tracked_files()
    if not tracked:
        pytest.skip("not a git checkout with tracked files")
    assert {name.split("/")[0] for name in tracked} - allowed == set()
