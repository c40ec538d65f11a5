"""The options of the command line, the parser that reads them, and the help."""

from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from beammodes.checks import positive_real, shown
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
    "JOINTS",
    "LOAD",
    "MODE",
    "RULE",
    "SECTION",
    "SEGMENTS",
    "TOLERANCE",
    "UNITS",
    "Answer",
    "Command",
    "Option",
    "as_fraction",
    "as_number",
    "as_vector",
    "damping_of",
    "elsewhere",
    "exported",
    "help_text",
    "modes",
    "motions",
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
    in_space : str
        A call of a rod in space that runs, "" if the command has none.
    """

    stage: str
    name: str
    question: str
    example: str
    options: tuple[Option, ...]
    answer: Callable[[argparse.Namespace], Answer]
    in_space: str = ""

    def parser(self) -> argparse.ArgumentParser:
        """Return the parser of the command's own options."""
        parser = _Parser(
            prog=f"beammodes {self.name}",
            description=f"{self.question[0].upper()}{self.question[1:]}",
            epilog=f"example:\n  {self.example}" + f"\n  {self.in_space}" * bool(self.in_space),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        self.fill(parser)
        return parser

    def fill(self, parser: argparse.ArgumentParser) -> None:
        """Give a parser the command's own options."""
        for flag, settings in self.options:
            text = settings["help"]
            parser.add_argument(flag, **{**settings, "help": text() if callable(text) else text})
        parser.add_argument("--json", action="store_true", help="print one JSON object")


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
    typed, told = vars(options), ""
    if any(typed.get(name) is not None for name in _OF_A_SECTION):
        from beammodes.command_line.section_options import beam_of_section

        made, told = beam_of_section(options)
        typed |= made
    return argparse.Namespace(**typed, command=known[first].answer, told=told)


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
Twist, stretch and rods in space, of any shape at rest, are asked by --motion, where a command has it.
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


def as_vector(text: str) -> float | str | tuple[float | str, ...]:
    """Return a number that was typed, or several with commas between."""
    parts = text.split(",")
    return as_number(text) if len(parts) == 1 else tuple(map(as_number, parts))


def as_fractions(text: str) -> float | str | tuple[float | str, ...]:
    """Return a fraction that was typed, or several with commas between."""
    parts = text.split(",")
    return as_fraction(text) if len(parts) == 1 else tuple(map(as_fraction, parts))


def option(flag: str, text: str | Callable[[], str], **settings: Any) -> Option:
    """Return an option with its help, or a function that returns it, and its other settings of argparse."""
    return flag, {"help": text, **settings}


def modes(default: int, *, each: bool = False) -> Option:
    """Return the option --modes; `each` lets a rod's motions have counts of their own."""
    text = f"how many modes (default: {default})"
    if each:
        text += "; in space of all together, or of each where the rod is straight: bending=3,twist=1"
    kind = _counts if each else _integer
    return option("--modes", text, type=kind, default=default, metavar="n")


def _counts(text: str) -> int | str | dict[str, int | str]:
    if "=" not in text:
        return _integer(text)
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): _integer(count) for name, _, count in parts}


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
#: Options that stand for the beam's stiffnesses and masses.
_OF_A_SECTION = ("section", "material", "elastic_modulus", "density", "poisson_ratio")
SECTION = (
    option(
        "--section",
        "in place of --ei and --rho-a: circle(diameter=0.01), tube(outer=0.02, wall=0.001), "
        "rectangle(width=0.06, height=0.02), box, i_section or channel; heights in the plane of bending",
        metavar="NAME",
    ),
    option(
        "--material",
        "of the section: steel, stainless steel, aluminum, brass, titanium or concrete: typical numbers. "
        "Yours are in SI then, unless --units says otherwise",
        metavar="NAME",
    ),
    option("--elastic-modulus", "E of the section, in place of the material's", type=as_number, metavar="X"),
    option("--density", "ρ of the section, in place of the material's", type=as_number, metavar="X"),
    option("--poisson-ratio", "of the section where it twists, likewise", type=as_number, metavar="X"),
)
#: What each motion is besides bending.
_MOTIONS: Mapping[str, str] = {
    "twist": "ends such as fixed-free(inertia=0.5)",
    "stretch": "ends such as fixed-free(mass=0.5)",
    "space": "a rod that bends in two planes and twists, of any shape at rest",
}
#: Options of these motions, by the motions that take them.
_OF_MOTIONS: tuple[tuple[tuple[str, ...], Option], ...] = (
    (
        ("twist", "space"),
        option("--gj", "GJ, torsional stiffness, such as 80 N m²", type=as_number, metavar="X"),
    ),
    (
        ("twist", "space"),
        option("--rho-ip", "ρIp, polar inertia per length [kg m]", type=as_number, metavar="X"),
    ),
    (
        ("stretch",),
        option("--ea", "EA, axial stiffness [N], with --rho-a", type=as_number, metavar="X"),
    ),
    (
        ("space",),
        option(
            "--ei-across",
            "EI of bending across the plane of --ei: about the section's y axis, --ei being about its z "
            "(default: the same)",
            type=as_number,
            metavar="X",
        ),
    ),
    (
        ("space",),
        option(
            "--shape",
            "at rest: straight, pretwisted(angle=1.57), arc(angle=1.57), helix(radius=0.1, pitch=0.05, "
            "turns=3), hook(straight=1, radius=0.1, angle=3.1), or curved(x=0, y=0, z=2) in 1/m; angles in "
            "radians; a helix and a hook have their own length (default: straight)",
            metavar="NAME",
        ),
    ),
    (
        ("space",),
        option(
            "--points",
            "file with x,y,z of four or more points, one a line, through which the centre line goes, in "
            "place of --shape and --length",
            metavar="FILE",
        ),
    ),
)
JOINTS = option(
    "--joints",
    "space: how joints turn, ball, or hinges in an order such as yzx, or yzx_alternating, whose order is "
    "reversed at every other joint",
    metavar="LAW",
)


def motions(*able: str) -> tuple[Option, ...]:
    """Return --motion of a command that answers these besides bending, and the options that they need.

    Examples
    --------
    >>> [flag for flag, _ in motions("stretch")]
    ['--motion', '--ea']
    """
    told = ", ".join(f"{name} ({_MOTIONS[name]})" for name in able)
    chosen = option("--motion", f"bending, {told} (default: bending)", default="bending", metavar="NAME")
    listed = [chosen]
    for takers, (flag, settings) in _OF_MOTIONS:
        if here := " and ".join(name for name in takers if name in able):
            listed.append((flag, {**settings, "help": f"{here}: {settings['help']}"}))
    return tuple(listed)


def elsewhere(able: Sequence[str]) -> list[tuple[str, str]]:
    """Return the flags that a command has for other motions than bending, and these motions in words."""
    return [
        (each[0], " or ".join(name for name in takers if name in able))
        for takers, each in _OF_MOTIONS
        if set(takers) & set(able)
    ]


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
        "gravity [m/s²]: one number, across the beam, or two, along,across: --gravity=9.81,0 hangs it; in "
        "space three, along the axes at s = 0",
        type=as_vector,
        metavar="g",
    ),
    AXIAL_FORCE,
    option(
        "--tip-force",
        "force on the right tip [N], across the beam or along,across; in space x,y,z at s = L",
        type=as_vector,
        metavar="F",
    ),
)
DAMPING = (
    option(
        "--damping-ratio",
        "dampers that give the first mode, without load, this ratio: 0.01 or 1%% of critical; several for as "
        "many modes: 0.8%%,1.1%%",
        type=as_fractions,
        metavar="z",
    ),
    option("--stiffness-damping", "dampers b k [s]", type=as_number, default=0.0, metavar="b"),
)


def damping_of(options: argparse.Namespace, chain: Any) -> Any:
    """Return the damping that the options of `DAMPING` describe, or None."""
    from beammodes.vibration.damping import Damping, joint_dampers

    if options.damping_ratio is not None:
        if options.stiffness_damping:
            raise ValueError("--damping-ratio must be given without --stiffness-damping, which it sets")
        ratios = options.damping_ratio
        if not isinstance(ratios, tuple):
            return joint_dampers(chain, _within("--damping-ratio", ratios))
        return joint_dampers(chain, {n: _within("--damping-ratio", z) for n, z in enumerate(ratios, 1)})
    if not options.stiffness_damping:
        return None
    return Damping(stiffness=_within("--stiffness-damping", options.stiffness_damping))


def _within(flag: str, value: Any) -> float:
    """Return a positive number whose square stays in the range of floats."""
    found = positive_real(flag, value)
    if not 1e-100 <= found <= 1e100:
        raise ValueError(f"{flag} must be from 1e-100 to 1e100, got {shown(value)}")
    return found


def exported(options: argparse.Namespace, chain: Any, load: Any, system: str, **how: Any) -> list[str]:
    """Write a chain as the options of the command export say, and return the names of the files.

    `system` is that of `--units`, of which nothing is said without that option; `how` goes to `export_chain`.
    """
    from beammodes.exporters.export import export_chain

    written = export_chain(
        chain,
        options.output,
        format=options.format,
        name=options.name,
        fragment=options.fragment,
        damping=damping_of(options, chain),
        timestep=options.timestep,
        integrator=options.integrator,
        load=load,
        units=system if options.units is not None else None,
        force=options.force,
        **how,
    )
    return [str(path) for path in written]
