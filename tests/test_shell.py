"""What the shell is owed by every command: any encoding, one line for a failure, clear exit codes."""

from __future__ import annotations

import argparse
import ast
import contextlib
import io
import json
import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from turns import in_turns

import beammodes
from beammodes.__main__ import main
from beammodes.command_line import shell
from beammodes.command_line.commands import COMMANDS
from beammodes.command_line.options import help_text

POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and pipes of POSIX")
ENCODINGS = {
    "utf-8": {"PYTHONIOENCODING": "utf-8"},
    "cp1252": {"PYTHONIOENCODING": "cp1252"},
    "latin-1": {"PYTHONIOENCODING": "latin-1"},
    "cp437": {"PYTHONIOENCODING": "cp437"},
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "utf-16": {"PYTHONIOENCODING": "utf-16"},
    "C": {"PYTHONUTF8": "0", "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0"},
}
#: Runs a command line as `python -m beammodes` does, after lines of the test's own.
AS_MAIN = "import runpy; runpy.run_module('beammodes', run_name='__main__', alter_sys=True)"


def process(
    arguments: list[str],
    folder: Path,
    before: str = "",
    settings: dict[str, str] | None = None,
    **options: Any,
) -> subprocess.CompletedProcess[bytes]:
    """Run `python -m beammodes` in a process of its own, `before` first."""
    start = ["-m", "beammodes"] if not before else ["-c", f"{before}\n{AS_MAIN}"]
    plain = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "LC_", "LANG"))}
    return subprocess.run(
        [sys.executable, *start, *arguments],
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
        cwd=folder,
        env=plain | (settings or {}),
        timeout=600,
        check=False,
    )


def in_folder(folder: Path) -> Path:
    """A folder with the file that the examples read."""
    from beammodes.chains.chain import Chain
    from beammodes.exporters.export import export_chain
    from beammodes.problem.beam import Beam

    export_chain(Chain(Beam(1.2, 85.0, 0.62), "clamped-free", 10, "rigid_stub"), folder / "beam.xml")
    return folder


def one_line(text: bytes) -> str:
    said = text.decode()
    assert said.startswith("beammodes") and said.count("\n") == 1 and said.endswith("\n"), said
    return said


@pytest.mark.parametrize("name", in_turns(ENCODINGS, every=2))
def test_help_and_errors_in_every_encoding(name: str, tmp_path: Path) -> None:
    for arguments in (["--help"], ["springs", "--help"]):
        ran = process(arguments, tmp_path, settings=ENCODINGS[name])
        assert (ran.returncode, ran.stderr) == (0, b"")
        text = ran.stdout.decode(name if name != "C" else "ascii")
        assert "\\x" not in text and "\\u" not in text and "?" * 2 not in text
        if arguments == ["springs", "--help"]:
            assert "N m²" in text or "N m^2" in text
    ran = process(["springs", "clamped-frée", "--segments", "3"], tmp_path, settings=ENCODINGS[name])
    assert ran.returncode == 2 and ran.stdout == b"" and b"Traceback" not in ran.stderr


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_in_every_encoding(
    command: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [*shlex.split(command.example)[1:], *(["--force"] if command.name == "export" else [])]
    monkeypatch.chdir(in_folder(tmp_path))
    for call in (arguments, [*arguments, "--json"], [command.name, "--help"]):
        assert main(call) == int(command.name == "audit" and "--help" not in call), call
        said = capsys.readouterr()
        assert said.out and said.err == "", call
        for encoding in ("utf-8", "cp1252", "latin-1", "cp437", "ascii", "utf-16", "koi8-r"):
            stream = io.TextIOWrapper(io.BytesIO(), encoding, errors="strict")
            if "--help" in call:
                with contextlib.redirect_stdout(stream):
                    assert main(call) == 0
            else:
                # What `main` writes its answer with.
                shell.put(said.out, stream)
            text = stream.buffer.getvalue().decode(encoding)
            assert text and "\\x" not in text and ("--json" in call or "\\u" not in text), (call, encoding)
    assert capsys.readouterr().err == ""


def said_in(tree: ast.Module) -> set[str]:
    """All characters beyond ASCII in strings that are not docstrings."""
    documented = (ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented) and node.body and isinstance(node.body[0], ast.Expr)
    }
    strings = (
        node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in docstrings
    )
    return {c for node in strings if isinstance(node.value, str) for c in node.value if ord(c) > 126}


def test_all_that_the_package_may_say_is_readable_in_every_encoding() -> None:
    paths = Path(beammodes.__file__).parent.rglob("*.py")
    said = set().union(*(said_in(ast.parse(path.read_text(encoding="utf-8"))) for path in paths))
    assert {"²", "ρ", "√"} <= said
    for encoding in ("ascii", "cp1252", "latin-1", "cp437", "koi8-r", "cp037", "shift_jis", "utf-16"):
        for character in sorted(said):
            plain = shell.readable(character, encoding)
            readable = plain.isascii() and "\\" not in plain and "?" not in plain
            assert plain == character or readable, (encoding, character, plain)


def test_what_no_encoding_holds_is_spelled_out() -> None:
    assert shell.readable("a\udc80b", "utf-8") == "a\\udc80b"  # a file's name that is no UTF-8
    assert shell.readable("\N{SNOWMAN}", "cp1252") == "\\u2603"
    assert shell.readable("√(EI/ρA L⁴)", "ascii") == "sqrt(EI/rhoA L^4)"
    assert shell.readable("ρ", None) == "ρ" and shell.readable("ρ", "no such encoding") == "ρ"


FAULTS = {
    "AttributeError('none')": shell.FAULT,
    "ZeroDivisionError('division by zero')": shell.FAULT,
    "RecursionError('too deep')": shell.FAULT,
    "AssertionError": shell.FAULT,
    "KeyError('x')": shell.FAULT,
    "UnicodeEncodeError('ascii', 'x', 0, 1, 'none')": shell.FAULT,
    "np.linalg.LinAlgError('singular')": shell.FAULT,
    "RuntimeWarning('overflow')": shell.FAULT,
    "MemoryError": shell.NO_ANSWER,
    "ValueError('x must be 1,\\ngot 2')": shell.NO_ANSWER,
    "TypeError('x must be 1')": shell.NO_ANSWER,
    "FileNotFoundError(2, 'No such file', 'a')": shell.NO_ANSWER,
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_no_failure_has_the_exit_code_of_a_tolerance_not_met(
    command: Any, fault: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import numpy as np

    def fails(_: object) -> Any:
        raise eval(fault, {"np": np})  # one of the table above

    parsed = argparse.Namespace(command=fails, json=False)
    monkeypatch.setattr("beammodes.command_line.options.parse", lambda *_: parsed)
    assert main([command.name]) == FAULTS[fault]
    said = one_line(capsys.readouterr().err.encode())
    assert ("please report what it prints with BEAMMODES_DEBUG=1" in said) == (FAULTS[fault] == shell.FAULT)
    monkeypatch.setenv("BEAMMODES_DEBUG", "1")
    assert main([command.name]) == FAULTS[fault]
    err = capsys.readouterr().err
    assert "Traceback" in err and "in fails" in err


def test_the_exit_codes_are_in_the_help() -> None:
    for code, says in shell.EXIT_CODES.items():
        assert re.search(rf"^    {code} +{re.escape(says)}$", help_text(COMMANDS), re.MULTILINE)


INTERRUPT = "import os, signal; stop = lambda: os.kill(os.getpid(), signal.SIGINT)\n"
#: Sends the process SIGINT when it imports a module, as often as is said.
AT_IMPORT = (
    INTERRUPT
    + """
import sys
class At:
    left = {times}
    def find_spec(self, name, path=None, target=None):
        while At.left and name == {module!r}:
            At.left -= 1
            stop()
sys.meta_path.insert(0, At())
"""
)
#: Sends SIGINT from inside a function, once or more, and may make another error of it, as CasADi does.
INSIDE = (
    INTERRUPT
    + """
import importlib
home, name = {place!r}.rsplit(".", 1)
home = importlib.import_module(home)
whole = getattr(home, name)
def called(*args, **kwargs):
    for _ in range({times}):
        try:
            stop()
        except KeyboardInterrupt:
            if {swallowed!r} == "error":
                raise NotImplementedError("wrong number or type of arguments") from None
            if {swallowed!r} == "no":
                raise
    return whole(*args, **kwargs)
setattr(home, name, called)
"""
)


def interrupted(ran: subprocess.CompletedProcess[bytes]) -> None:
    assert (ran.returncode, ran.stdout) == (130, b""), ran.stderr
    assert "interrupted" in one_line(ran.stderr)


@POSIX
@pytest.mark.parametrize(
    ("module", "times"),
    in_turns(
        [
            "beammodes.command_line.shell",
            "beammodes.command_line.options",
            "beammodes.command_line.commands",
            "argparse",
            "numpy",
            "numpy.linalg",
            "beammodes.closed_form.uniform_chains",
            "beammodes.problem.ends",
        ],
        [1, 2],
        every=2,
    ),
)
def test_an_interrupt_during_imports(module: str, times: int, tmp_path: Path) -> None:
    call = ["error", "clamped-free", "--segments", "6"]
    if module.endswith("shell") and times == 2:
        pytest.skip("nothing listens yet: Python itself takes both")
    interrupted(process(call, tmp_path, AT_IMPORT.format(module=module, times=times)))


@POSIX
@pytest.mark.parametrize(("swallowed", "times"), in_turns(["no", "error", "yes"], [1, 2, 3], every=2))
def test_an_interrupt_however_a_library_takes_it(swallowed: str, times: int, tmp_path: Path) -> None:
    place = "beammodes.chains.chain.Chain"
    before = INSIDE.format(place=place, times=times, swallowed=swallowed)
    interrupted(process(["springs", "clamped-free", "--segments", "6"], tmp_path, before))


#: Those that read ends, in which the interrupt comes.
WITH_ENDS = [each for each in COMMANDS if any(flag.endswith("boundary") for flag, _ in each.options)]


@POSIX
@pytest.mark.parametrize("command", WITH_ENDS, ids=lambda command: command.name)
def test_every_command_can_be_interrupted(command: Any, tmp_path: Path) -> None:
    before = INSIDE.format(place="beammodes.problem.ends.Boundary.of", times=2, swallowed="no")
    before = before.replace(
        "importlib.import_module(home)", "importlib.import_module('beammodes.problem.ends').Boundary"
    )
    folder = in_folder(tmp_path)
    kept = (folder / "beam.xml").read_bytes()
    interrupted(process(shlex.split(command.example)[1:], folder, before))
    assert [path.name for path in folder.iterdir()] == ["beam.xml"]
    assert (folder / "beam.xml").read_bytes() == kept


@POSIX
def test_a_process_that_ignores_interrupts_is_not_interrupted(tmp_path: Path) -> None:
    # nohup and shells start background commands so.
    before = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n" + INSIDE.format(
        place="beammodes.chains.chain.Chain", times=3, swallowed="no"
    )
    ran = process(["springs", "clamped-free", "--segments", "3"], tmp_path, before)
    assert (ran.returncode, ran.stderr) == (0, b"") and ran.stdout.startswith(b"hinge")


FLAGS: list[list[str]] = [[], ["--json"], ["--help"]]


@POSIX
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_without_a_reader_is_quiet(
    command: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(in_folder(tmp_path))
    for flags in FLAGS:
        reading, writing = os.pipe()
        os.close(reading)
        call = [*shlex.split(command.example)[1:], *flags, *(["--force"] if command.name == "export" else [])]
        with os.fdopen(writing, "w", encoding="utf-8") as stream:
            monkeypatch.setattr(sys, "stdout", stream)
            assert main(call) == int(command.name == "audit" and flags != ["--help"]), call
    assert capsys.readouterr().err == ""


@POSIX
@pytest.mark.parametrize("name", ["springs", "audit"])
def test_processes_without_a_reader_are_quiet(name: str, tmp_path: Path) -> None:
    (command,) = (each for each in COMMANDS if each.name == name)
    folder = in_folder(tmp_path)
    for flags in FLAGS:
        reading, writing = os.pipe()
        os.close(reading)
        ran = process([*shlex.split(command.example)[1:], *flags], folder, stdout=writing)
        os.close(writing)
        assert (ran.returncode, ran.stderr) == (int(name == "audit" and flags != ["--help"]), b"")


FULL = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")


@FULL
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_on_a_full_disk(
    command: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(in_folder(tmp_path))
    call = [*shlex.split(command.example)[1:], *(["--force"] if command.name == "export" else [])]
    for arguments in (call, [command.name, "--help"]):
        with open("/dev/full", "w", encoding="utf-8") as full:
            monkeypatch.setattr(sys, "stdout", full)
            assert main(arguments) == 2, arguments
        assert "No space left" in one_line(capsys.readouterr().err.encode())


@FULL
@pytest.mark.parametrize("name", ["error", pytest.param("export", marks=pytest.mark.slow)])
def test_processes_on_a_full_disk_and_a_closed_stdout(name: str, tmp_path: Path) -> None:
    (command,) = (each for each in COMMANDS if each.name == name)
    call = shlex.split(command.example)[1:]
    more = ["--force"] if command.name == "export" else []
    folder = in_folder(tmp_path)
    with open("/dev/full", "wb") as full:
        for arguments in ([*call, *more], [command.name, "--help"]):
            ran = process(arguments, folder, stdout=full)
            assert ran.returncode == 2 and "No space left" in one_line(ran.stderr)
        nothing = process([*call, *more], folder, stdout=full, stderr=full)
        assert nothing.returncode == 2
    words = shlex.join([sys.executable, "-m", "beammodes", *call, *more])
    closed = subprocess.run(["sh", "-c", f"{words} >&-"], cwd=folder, stderr=subprocess.PIPE, check=False)
    assert closed.returncode == 2 and "standard output is closed" in one_line(closed.stderr)
    assert subprocess.run(["sh", "-c", f"{words} >&- 2>&-"], cwd=folder, check=False).returncode == 2


def test_warnings_are_one_line_each(tmp_path: Path) -> None:
    before = "import warnings, beammodes.chains.chain as c\nwhole = c.Chain\n"
    before += "c.Chain = lambda *a, **k: (warnings.warn('first\\nsecond'), whole(*a, **k))[1]"
    ran = process(["springs", "clamped-free", "--segments", "3"], tmp_path, before)
    assert ran.returncode == 0 and one_line(ran.stderr) == "beammodes: UserWarning: first second\n"


def test_in_another_program_the_signals_and_warnings_are_left_alone(
    capsys: pytest.CaptureFixture[str],
) -> None:
    import warnings

    before = signal.getsignal(signal.SIGINT), warnings.showwarning
    assert main(["error", "clamped-free", "--segments", "6", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["segments"] == 6
    assert (signal.getsignal(signal.SIGINT), warnings.showwarning) == before


HOSTILE = [
    *(
        "",
        " ",
        "0",
        "-0",
        "+0",
        "1",
        "-1",
        "2",
        "3",
        "7.5",
        "0.5",
        "1e-3",
        "1e-9",
        "1e-300",
        "5e-324",
        "1e-400",
    ),
    *("1e9", "1000000000", "1e18", "1e300", "1.8e308", "1e309", "1e999", "-1e300", "9" * 40, "9" * 400),
    *("9" * 5000, "-" + "9" * 40, "nan", "-nan", "NaN", "inf", "-inf", "Infinity", "None", "True", "null"),
    *(
        "one",
        "six",
        "1,2",
        "1,2,3",
        ",",
        "1,",
        "1/2",
        "1%",
        "%",
        "50%",
        "1%%",
        "0x10",
        "1_000",
        "1__0",
        "1e",
        "e1",
    ),
    *(
        "١٢",
        "½",
        "²",
        "\u200b1",
        "1\n2",
        "\t",
        "'",
        '"',
        "--",
        "-",
        "*",
        "$(true)",
        "../..",
        "\udc80",
        "\x1b[31m",
    ),
]


def numeric_options(command: Any) -> list[str]:
    """The options of a command that read a number."""
    options = command.parser()._actions
    return [action.option_strings[0] for action in options if callable(action.type) and action.option_strings]


def one_call(command: Any, folder: Path) -> list[str]:
    call = shlex.split(command.example)[1:]
    if "--output" in call:
        call[call.index("--output") + 1] = str(folder / "out.xml")
        call.append("--force")
    return [str(folder / "beam.xml") if word == "beam.xml" else word for word in call]


#: One of each kind: nothing, zero, signs, extremes, no number, several, other digits, what no terminal shows.
SOME = ["", "0", "-1", "7.5", "1e-300", "1e300", "1000000000", "9" * 400, "nan", "inf", "None", "1,2"]
SOME += ["½", "\udc80", "\x1b[31m"]


@pytest.mark.filterwarnings("ignore::beammodes.DampingFitWarning")
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_numeric_option_over_hostile_values(
    command: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set(SOME) <= set(HOSTILE)
    # In turns: an option takes every other value, of the slowest command every fourth.
    over_values(SOME, command, tmp_path, capsys, monkeypatch, every=4 if command.name == "segments" else 2)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::beammodes.DampingFitWarning")
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_numeric_option_over_all_hostile_values(
    command: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(HOSTILE) >= 62 and len(set(HOSTILE)) == len(HOSTILE)
    over_values(HOSTILE, command, tmp_path, capsys, monkeypatch)


def over_values(
    values: list[str],
    command: Any,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    every: int = 1,
) -> None:
    monkeypatch.chdir(in_folder(folder))
    call, options = one_call(command, folder), numeric_options(command)
    assert options or command.name not in {"recommend", "springs", "audit"}
    for place, option in enumerate(options):
        kept = list(call)
        if option in kept:
            del kept[kept.index(option) : kept.index(option) + 2]
        for value in values[place % every :: every]:
            capsys.readouterr()
            code = main([*kept, f"{option}={value}"])
            out, err = capsys.readouterr()
            shown = (option, value[:40], err)
            assert code in (0, shell.NO_ANSWER) or (code == shell.NOT_MET and command.name == "audit"), shown
            assert (code == shell.NO_ANSWER) == (out == ""), shown
            if code == shell.NO_ANSWER:
                assert one_line(err.encode("utf-8", "backslashreplace")) and len(err) < 500, shown
                assert re.search(NAMED.get(option, option[2:]), err), shown
                assert "nan" not in out


#: How the library names what an option gives, where it is not the option's own word.
NAMED = {
    "--length": "length|beam must|segments|frequenc|load|mass|timestep|lengths|plane|radius",
    "--ei": "--ei|beam must|segments|length must suit|frequenc|load|stiffness|timestep|buckle",
    "--rho-a": "rho-a|beam must|segments|length must suit|frequenc|load|mass|timestep",
    "--mode": "mode",
    "--modes": "modes|mode |segments",
    "--axial-force": "axial-force|load|axial",
    "--gravity": "gravity|load|timestep|step",
    "--tip-force": "tip-force|load|timestep|step",
    "--tolerance": "tolerance",
    "--timestep": "timestep|time step|step",
    "--ei-across": "ei-across|second|beam must suit|stiffness|length must suit|segments",
    "--damping-ratio": "damping-ratio|damping|ratio|step",
    "--stiffness-damping": "stiffness-damping|damping|stiffness|step",
    "--segments": "segments|pieces|hinges|mode must be",  # of which few segments have few
    "--force-at": "force.at|deflection.at",
    "--deflection-at": "deflection.at",
}
