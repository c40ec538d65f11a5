"""The options of the command line, the parser that reads them, and the help."""

from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from beammodes.command_line.shell import EXIT_CODES, put, tell_all
from beammodes.command_line.text_tables import DECLARED
from beammodes.version import SOURCE

__all__ = [
    "AXIAL_FORCE",
    "BEAM",
    "BOUNDARY",
    "DAMPING",
    "DEFAULT_RULE",
    "INTEGRATOR",
    "LOAD",
    "MODE",
    "MOTION",
    "RULE",
    "SEGMENTS",
    "TOLERANCE",
    "UNITS",
    "Answer",
    "Command",
    "Option",
    "as_fraction",
    "as_number",
    "help_text",
    "modes",
    "option",
    "parse",
]

#: A flag, or the name of an argument without one, and what `add_argument` takes for it.
Option = tuple[str, Mapping[str, Any]]
#: The answer of a command for scripts, and the same as text for people.
Answer = tuple[dict[str, Any], str]
DEFAULT_RULE = "mitiguy"


@dataclass(frozen=True)
class Command:
    """A command of the command line.

    Attributes
    ----------
    stage : str
        The part of the user's work that it belongs to, the heading of its group in the help.
    name : str
    question : str
        The one that it answers, in the user's words.
    example : str
        A call that runs.
    options : tuple of Option
    answer : function of the options that were typed
    """

    stage: str
    name: str
    question: str
    example: str
    options: tuple[Option, ...]
    answer: Callable[[argparse.Namespace], Answer]

    def parser(self) -> argparse.ArgumentParser:
        """Return the parser of the command's own options."""
        parser = _Parser(
            prog=f"beammodes {self.name}",
            description=f"{self.question[0].upper()}{self.question[1:]}",
            epilog=f"example:\n  {self.example}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        for flag, settings in self.options:
            text = settings["help"]
            parser.add_argument(flag, **{**settings, "help": text() if callable(text) else text})
        parser.add_argument("--json", action="store_true", help="print one JSON object")
        return parser


class _Parser(argparse.ArgumentParser):
    def _print_message(self, message: str, file: Any = None) -> None:
        # argparse passes over what cannot be written, and fails where the encoding lacks a character.
        if message:
            put(message, file) if file is not None and file is sys.stdout else tell_all(message)

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def parse(arguments: Sequence[str], commands: Sequence[Command]) -> argparse.Namespace:
    """Return what the user typed and the command's function, or leave with code 2 and one line."""
    known = {command.name: command for command in commands}
    first = arguments[0] if arguments else ""
    if first not in known:
        _leave_without_command(first, arguments, commands)
    parser = known[first].parser()
    flags = [flag for action in parser._actions for flag in action.option_strings]
    for word in arguments[1:]:
        flag = word.partition("=")[0]
        # argparse would only tell which required options are missing.
        if flag.startswith("--") and flag != "--" and not any(each.startswith(flag) for each in flags):
            parser.error(f"unrecognized: {word[:60]}{_near(flag, flags)}")
    options = parser.parse_args(arguments[1:])
    for name, value in vars(options).items():
        # What argparse makes of --name=-- .
        if value == []:
            parser.error(f"--{name.replace('_', '-')} must have a value, got '--'")
    return argparse.Namespace(**vars(options), command=known[first].answer)


def _leave_without_command(first: str, arguments: Sequence[str], commands: Sequence[Command]) -> NoReturn:
    """Print the help or the version, or tell which command is meant."""

    class Whole(_Parser):
        def format_help(self) -> str:
            return help_text(commands)

    parser = Whole(prog="beammodes", usage="beammodes COMMAND ...")
    parser.add_argument("--version", action="version", version=SOURCE)
    names = [command.name for command in commands]
    if first and not first.startswith("-"):
        parser.error(f"COMMAND must be one of {', '.join(names)}, got {first[:40]!r}{_near(first, names)}")
    parser.add_argument("COMMAND")
    parser.parse_args(arguments)
    parser.error("COMMAND must come first")


def _near(word: str, words: Iterable[str]) -> str:
    found = difflib.get_close_matches(word[:60].lower(), list(words), n=1)
    return f' (did you mean "{found[0]}"?)' if found else ""


_HEAD = """\
usage: beammodes COMMAND ... [--json]

Build a flexible beam from rigid segments and rotational springs: which springs, how many segments, which
step, and how wrong it is. Each command answers one question.
"""
_FOOT = """

Give --length, --ei and --rho-a in any consistent units, and all other numbers in the same; --units names
them. Without these three, answers and numbers of ends are multiples of the beam's own, such as EI/L.
Errors are those of natural frequencies against the exact Euler-Bernoulli beam; negative is too low. They
hold for small vibration about the straight beam, in vacuum and without gravity.
exit codes:
{codes}
options: --json for scripts; --version; beammodes COMMAND --help for all options of a command
"""


def help_text(commands: Sequence[Command]) -> str:
    """Return what `beammodes --help` prints."""
    lines: list[str] = []
    for stage in dict.fromkeys(command.stage for command in commands):
        lines += ["", f"{stage}:"]
        lines += [f"    {each.name:13}{each.question}" for each in commands if each.stage == stage]
    lines += ["", "examples:", *(f"  {command.example}" for command in commands)]
    codes = "\n".join(f"    {code:<4} {says}" for code, says in EXIT_CODES.items())
    return _HEAD + "\n".join(lines) + _FOOT.format(codes=codes)


# What is no number is passed on as text, so that the library's own message names the argument.


def as_number(text: str) -> float | str:
    """Return a number that was typed."""
    try:
        return float(text)
    except ValueError:
        return text


def as_fraction(text: str) -> float | str:
    """Return a fraction that was typed as 0.01 or 1%."""
    value = as_number(text.strip().removesuffix("%"))
    return value / 100 if text.strip().endswith("%") and isinstance(value, float) else value


def _integer(text: str) -> int | str:
    # Python itself refuses to read integers of more than 4300 digits.
    try:
        return int(text)
    except ValueError:
        return text


def _vector(text: str) -> float | str | tuple[float | str, ...]:
    parts = text.split(",")
    return as_number(text) if len(parts) == 1 else tuple(map(as_number, parts))


def option(flag: str, text: str | Callable[[], str], **settings: Any) -> Option:
    """Return an option with its help, or a function that returns it, and its other settings of argparse."""
    return flag, {"help": text, **settings}


def modes(default: int) -> Option:
    """Return the option --modes."""
    text = f"how many modes (default: {default})"
    return option("--modes", text, type=_integer, default=default, metavar="n")


BOUNDARY = option(
    "boundary",
    "two ends of clamped, pinned, guided, free, such as clamped-free; numbers may follow: "
    '"clamped-free(mass=0.5, rotary_inertia=0.01, offset=0.1, translational_stiffness=3)", in the units of '
    "the beam; without --length, --ei and --rho-a they are multiples of ρA L, ρA L³, L, EI/L³ and EI/L",
)
UNITS = option("--units", f"units of your numbers, for headings: {', '.join(DECLARED)}", metavar="NAME")
BEAM = (
    option("--length", "L, length of the beam, such as 1.2 m", type=as_number, metavar="X"),
    option("--ei", "EI, bending stiffness, such as 85 N m²", type=as_number, metavar="X"),
    option("--rho-a", "ρA, mass per length, such as 0.62 kg/m", type=as_number, metavar="X"),
)
MOTION = (
    option(
        "--motion",
        "bending, twist or stretch; the last two with ends such as fixed-free(inertia=0.5), "
        "fixed-free(mass=0.5) and free(stiffness=2) (default: bending)",
        default="bending",
        metavar="NAME",
    ),
    option("--gj", "GJ, torsional stiffness, such as 80 N m²: for twist", type=as_number, metavar="X"),
    option("--rho-ip", "ρIp, polar inertia per length [kg m]: for twist", type=as_number, metavar="X"),
    option("--ea", "EA, axial stiffness [N]: for stretch, with --rho-a", type=as_number, metavar="X"),
)
SEGMENTS = option("--segments", "number of rigid segments", type=_integer, required=True, metavar="N")
INTEGRATOR = option(
    "--integrator",
    "of fixed step, such as leapfrog or 'MuJoCo implicitfast'; an unknown name lists all (default: rk4)",
    default="rk4",
    metavar="NAME",
)
MODE = option("--mode", "elastic mode (default: 1)", type=_integer, default=1, metavar="n")
TOLERANCE = option("--tolerance", "1%% or 0.01", type=as_fraction, required=True, metavar="e")
RULE = option("--rule", f"discretization rule (default: {DEFAULT_RULE})", default=DEFAULT_RULE)
AXIAL_FORCE = option(
    "--axial-force",
    "axial force, tension positive; in EI/L² without a beam (default: 0)",
    type=as_number,
    default=0.0,
    metavar="T",
)
LOAD = (
    option(
        "--gravity",
        "gravity [m/s²]: one number, across the beam, or two, along,across: --gravity=9.81,0 hangs it",
        type=_vector,
        metavar="g",
    ),
    AXIAL_FORCE,
    option(
        "--tip-force",
        "force on the right tip [N], across the beam or along,across",
        type=_vector,
        metavar="F",
    ),
)
DAMPING = (
    option(
        "--damping-ratio",
        "dampers that give the first mode, without load, this ratio: 0.01 is one percent of critical",
        type=as_number,
        metavar="z",
    ),
    option("--stiffness-damping", "dampers b k [s]", type=as_number, default=0.0, metavar="b"),
)
