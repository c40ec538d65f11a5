"""The command line's words: its commands in the order of a user's work, their options, and the help."""

from __future__ import annotations

import argparse
import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from beammodes import __version__
from beammodes.commands import (
    Answer,
    answer_buckling,
    answer_error,
    answer_frequencies,
    answer_recommend,
    answer_segments,
    answer_springs,
    answer_time_step,
)
from beammodes.file_commands import answer_audit, answer_export

__all__ = ["COMMANDS", "Command", "in_flags", "parse"]

_BEAM = (
    ("length", "L, length of the beam [m]"),
    ("ei", "EI, bending stiffness [N m²]"),
    ("rho_a", "ρA, mass per length [kg/m]"),
)
_BOUNDARY = (
    "two ends of clamped, pinned, guided, free, such as clamped-free; numbers may follow: "
    '"clamped-free(mass=0.5, rotary_inertia=0.01, offset=0.1, translational_stiffness=3)"'
)
Options = argparse.ArgumentParser


@dataclass(frozen=True)
class Command:
    """One command: its name, what computes it, the question it answers, an example, and its options."""

    name: str
    answer: Callable[[argparse.Namespace], Answer]
    question: str
    example: str
    build: Callable[[Options], None]


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


class _MainParser(_Parser):
    def format_help(self) -> str:
        return _HEAD + "\n".join(_help_lines()) + _FOOT


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Return what the user typed; leaves with exit code 2 and one line if it cannot be understood."""
    parser = _MainParser(prog="beammodes", usage="beammodes COMMAND ...")
    parser.add_argument("--version", action="version", version=f"beammodes {__version__}")
    subs = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    known = {command.name: _added(subs, command) for command in COMMANDS}
    first = arguments[0] if arguments else ""
    if first and not first.startswith("-") and first not in known:
        parser.error(f"COMMAND must be one of {', '.join(known)}, got {first[:40]!r}{_near(first, known)}")
    if first in known:
        _check_flags(known[first], arguments[1:])
    return parser.parse_args(arguments)


def _check_flags(sub: _Parser, words: Sequence[str]) -> None:
    """Leave with the nearest option if one is mistyped: argparse would only miss those it must have."""
    flags = [flag for action in sub._actions for flag in action.option_strings]
    for word in words:
        flag = word.partition("=")[0]
        if flag.startswith("--") and flag != "--" and not any(each.startswith(flag) for each in flags):
            sub.error(f"unrecognized: {word[:60]}{_near(flag, flags)}")


def _near(word: str, words: Sequence[str] | dict[str, _Parser]) -> str:
    found = difflib.get_close_matches(word[:60].lower(), list(words), n=1)
    return f' (did you mean "{found[0]}"?)' if found else ""


def _added(subs: argparse._SubParsersAction[_Parser], command: Command) -> _Parser:
    text = f"{command.question[0].upper()}{command.question[1:]}"
    sub = subs.add_parser(
        command.name,
        prog=f"beammodes {command.name}",
        description=text,
        epilog=f"example:\n  {command.example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    if command.answer is answer_audit:
        sub.add_argument("file", metavar="FILE", help="MJCF, URDF, SDFormat, or CSV as export writes it")
    else:
        sub.add_argument("boundary", help=_BOUNDARY)
    command.build(sub)
    if command.answer is answer_recommend:
        sub.add_argument("--rule", metavar="RULE,...", help="only these rules (default: all)")
    elif command.answer is not answer_audit:
        sub.add_argument("--rule", default="mitiguy", help="discretization rule (default: mitiguy)")
    sub.add_argument("--json", action="store_true", help="print one JSON object")
    sub.set_defaults(command=command.answer)
    return sub


def in_flags(message: str) -> str:
    """Return a message of the library in the words that the user typed."""
    flags = {
        "bending_stiffness must": "--ei must",
        "mass_per_length must": "--rho-a must",
        "axial_force must": "--axial-force must",
        "say by boundary": "say by --boundary",
        "force=True": "--force",
    }
    for name, flag in flags.items():
        message = message.replace(name, flag)
    return message


def _beam_options(sub: Options) -> None:
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, default=1.0, metavar="X", help=f"{text} (default: 1)")


def _segments_option(sub: Options) -> None:
    sub.add_argument("--segments", type=_integer, required=True, metavar="N", help="number of rigid segments")


def _modes_option(sub: Options, default: int) -> None:
    text = f"how many modes (default: {default})"
    sub.add_argument("--modes", type=_integer, default=default, metavar="n", help=text)


def _error_options(sub: Options) -> None:
    _segments_option(sub)
    sub.add_argument("--mode", type=_integer, default=1, metavar="n", help="elastic mode (default: 1)")
    _axial_option(sub, "EI/L²")


def _frequency_options(sub: Options) -> None:
    _segments_option(sub)
    _modes_option(sub, 3)
    _beam_options(sub)
    _axial_option(sub, "N")


def _spring_options(sub: Options) -> None:
    _segments_option(sub)
    _beam_options(sub)


def _tolerance_options(sub: Options) -> None:
    sub.add_argument("--tolerance", type=_number, required=True, metavar="e", help="0.01 is one percent")
    _modes_option(sub, 1)


def _axial_option(sub: Options, unit: str) -> None:
    text = f"axial force [{unit}], tension positive (default: 0)"
    sub.add_argument("--axial-force", type=_number, default=0.0, metavar="T", help=text)


def _step_options(sub: Options) -> None:
    _spring_options(sub)
    _axial_option(sub, "N")
    _integrator_option(sub)


def _advice_options(sub: Options) -> None:
    _tolerance_options(sub)
    _beam_options(sub)
    _integrator_option(sub)


def _integrator_option(sub: Options) -> None:
    text = "rk4, leapfrog or semi_implicit_euler (default: rk4)"
    sub.add_argument("--integrator", default="rk4", help=text)


def _export_options(sub: Options) -> None:
    _spring_options(sub)
    sub.add_argument("--output", required=True, metavar="FILE", help=".xml (MJCF), .sdf, .urdf or .csv")
    sub.add_argument("--format", help="mjcf, sdf, urdf or csv (default: by the file's ending)")
    sub.add_argument("--name", default="chain", help="prefix of all names in the file (default: chain)")
    sub.add_argument("--fragment", action="store_true", help="bodies only, to include in a model (MJCF)")
    sub.add_argument("--timestep", type=_number, metavar="h", help="time step [s] (default: safe, accurate)")
    sub.add_argument("--integrator", default="RK4", help="MuJoCo's RK4, Euler or implicitfast (default: RK4)")
    sub.add_argument("--stiffness-damping", type=_number, default=0.0, metavar="b", help="dampers b k [s]")
    sub.add_argument("--force", action="store_true", help="overwrite existing files")


def _audit_options(sub: Options) -> None:
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, required=True, metavar="X", help=text)
    sub.add_argument("--boundary", metavar="ENDS", help=f"the beam's ends (default: the file's): {_BOUNDARY}")
    text = "largest error that meets, 0.01 is one percent (default: 0.01)"
    sub.add_argument("--tolerance", type=_number, default=0.01, metavar="e", help=text)
    _modes_option(sub, 3)
    sub.add_argument("--chain", metavar="NAME", help="a body of the chain to judge (default: the longest)")
    sub.add_argument("--plane", help="x, y or z, along which it deflects (default: by the springs)")
    text = "springs of a URDF file (default: .springs.yaml beside it)"
    sub.add_argument("--springs", metavar="FILE", help=text)


def _integer(text: str) -> int | str:
    # What is no integer is passed on, so that the library's own message names the argument. Python itself
    # refuses to read integers of more than 4300 digits.
    try:
        return int(text)
    except ValueError:
        return text


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


_OF = "--length 1.2 --ei 85 --rho-a 0.62"
#: In the order of a user's work: before, while and after building a chain.
_STAGES: dict[str, tuple[Command, ...]] = {
    "before you build a chain": (
        Command(
            "recommend",
            answer_recommend,
            "which rule, how many segments and which step meet my tolerance?",
            "beammodes recommend clamped-free --tolerance 0.01 --modes 3",
            _advice_options,
        ),
        Command(
            "segments",
            answer_segments,
            "how many segments does one rule need?",
            "beammodes segments clamped-clamped --tolerance 0.01 --modes 3 --rule gregory",
            _tolerance_options,
        ),
        Command(
            "error",
            answer_error,
            "how wrong is one frequency of a chain of N segments?",
            'beammodes error "clamped-free(mass=0.5)" --segments 6 --mode 1',
            _error_options,
        ),
    ),
    "while you build it": (
        Command(
            "springs",
            answer_springs,
            "which joint stiffnesses do I type into my multibody tool?",
            f"beammodes springs clamped-free --segments 4 {_OF}",
            _spring_options,
        ),
        Command(
            "frequencies",
            answer_frequencies,
            "at which frequencies do the chain and the beam ring?",
            f"beammodes frequencies clamped-free --segments 6 --modes 3 {_OF}",
            _frequency_options,
        ),
        Command(
            "time-step",
            answer_time_step,
            "which fixed time step is stable?",
            f"beammodes time-step clamped-free --segments 10 {_OF}",
            _step_options,
        ),
        Command(
            "buckling",
            answer_buckling,
            "under which compression do the chain and the beam buckle?",
            f"beammodes buckling clamped-free --segments 10 {_OF}",
            _spring_options,
        ),
        Command(
            "export",
            answer_export,
            "can I have the chain as a file for MuJoCo, Gazebo, Drake or URDF tools?",
            f"beammodes export clamped-free --segments 10 --rule gregory {_OF} --output beam.xml",
            _export_options,
        ),
    ),
    "when you have one": (
        Command(
            "audit",
            answer_audit,
            "how wrong is the chain in my model file, and what mends it?",
            f"beammodes audit beam.xml {_OF} --tolerance 0.01",
            _audit_options,
        ),
    ),
}
COMMANDS: tuple[Command, ...] = tuple(command for stage in _STAGES.values() for command in stage)

_HEAD = """\
usage: beammodes COMMAND ... [--json]

A flexible beam can be built from rigid segments and rotational springs. Which springs, how many segments,
which step, and how wrong it is: one command for each question.
"""
_FOOT = """

Lengths, stiffnesses and masses are in SI, or in any consistent units. Errors are those of natural frequencies
against the exact Euler-Bernoulli beam, with their sign: negative is too low.
exit codes: 0 done; 1 audit: the tolerance is not met; 2 bad input, told in one line
options: --json for scripts; --version; beammodes COMMAND --help for all options of a command
"""


def _help_lines() -> list[str]:
    lines: list[str] = []
    for stage, commands in _STAGES.items():
        lines += ["", f"{stage}:"]
        for command in commands:
            lines += [f"    {command.name:13}{command.question}"]
    lines += ["", "examples:"]
    return lines + [f"  {command.example}" for command in COMMANDS]
