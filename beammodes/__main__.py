"""The command line: errors, frequencies, springs, segments, advice, time steps and buckling loads."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from beammodes import __version__
from beammodes.commands import (
    Answer,
    answer_buckling,
    answer_error,
    answer_export,
    answer_frequencies,
    answer_recommend,
    answer_segments,
    answer_springs,
    answer_time_step,
)

__all__ = ["main"]

_BEAM = (
    ("length", "L, length of the beam [m]"),
    ("ei", "EI, bending stiffness [N m²]"),
    ("rho_a", "ρA, mass per length [kg/m]"),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, or 2 for bad usage or a mode that does not exist."""
    options = _parser().parse_args(arguments)
    command: Callable[[argparse.Namespace], Answer] = options.command
    try:
        answer, text = command(options)
        output = json.dumps(answer, allow_nan=False) if options.json else text
    except (TypeError, ValueError, OSError) as error:
        sys.stderr.write(f"beammodes: {_in_flags(str(error))}\n")
        return 2
    try:
        print(output, flush=True)
    except BrokenPipeError:
        # The reader, such as `head`, has seen enough; Python would complain again when it closes stdout.
        sys.stdout = None
    return 0


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="beammodes",
        description="Chains of rigid segments and rotational springs that stand for flexible beams.",
        epilog="examples:\n"
        "  beammodes error clamped-free --segments 6 --mode 1\n"
        "  beammodes springs clamped-free --segments 4 --length 1.2 --ei 85 --rho-a 0.62\n"
        "  beammodes frequencies clamped-free --segments 6 --modes 3\n"
        "  beammodes segments clamped-clamped --tolerance 0.01 --modes 3\n"
        "  beammodes recommend clamped-free --tolerance 0.01 --modes 3\n"
        '  beammodes error "clamped-free(mass=0.5)" --segments 6\n'
        "  beammodes export clamped-free --segments 10 --length 1.2 --ei 85 --rho-a 0.62 --output beam.xml\n"
        "  beammodes time-step clamped-free --segments 10 --length 1.2 --ei 85 --rho-a 0.62",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"beammodes {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, function, summary, build in _COMMANDS:
        sub = commands.add_parser(name, help=summary, description=summary.capitalize() + ".")
        sub.add_argument(
            "boundary",
            help="two ends of clamped, pinned, guided, free, such as clamped-free; numbers may follow: "
            '"clamped-free(mass=0.5, rotary_inertia=0.01, offset=0.1, translational_stiffness=3)"',
        )
        build(sub)
        if function is answer_recommend:
            sub.add_argument("--rule", metavar="RULE,...", help="only these rules (default: all)")
        else:
            sub.add_argument("--rule", default="mitiguy", help="discretization rule (default: mitiguy)")
        sub.add_argument("--json", action="store_true", help="print one JSON object")
        sub.set_defaults(command=function)
    return parser


def _beam_options(sub: argparse.ArgumentParser) -> None:
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, default=1.0, metavar="X", help=f"{text} (default: 1)")


def _segments_option(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--segments", type=_integer, required=True, metavar="N", help="number of rigid segments")


def _error_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    sub.add_argument("--mode", type=_integer, default=1, metavar="n", help="elastic mode (default: 1)")
    _axial_option(sub, "EI/L²")


def _frequency_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    sub.add_argument("--modes", type=_integer, default=3, metavar="n", help="how many modes (default: 3)")
    _beam_options(sub)
    _axial_option(sub, "N")


def _spring_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    _beam_options(sub)


def _tolerance_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--tolerance", type=_number, required=True, metavar="e", help="0.01 is one percent")
    sub.add_argument("--modes", type=_integer, default=1, metavar="n", help="how many modes (default: 1)")


def _axial_option(sub: argparse.ArgumentParser, unit: str) -> None:
    text = f"axial force [{unit}], tension positive (default: 0)"
    sub.add_argument("--axial-force", type=_number, default=0.0, metavar="T", help=text)


def _step_options(sub: argparse.ArgumentParser) -> None:
    _spring_options(sub)
    _axial_option(sub, "N")
    _integrator_option(sub)


def _advice_options(sub: argparse.ArgumentParser) -> None:
    _tolerance_options(sub)
    _beam_options(sub)
    _integrator_option(sub)


def _integrator_option(sub: argparse.ArgumentParser) -> None:
    text = "rk4, leapfrog or semi_implicit_euler (default: rk4)"
    sub.add_argument("--integrator", default="rk4", help=text)


def _export_options(sub: argparse.ArgumentParser) -> None:
    _spring_options(sub)
    sub.add_argument("--output", required=True, metavar="FILE", help=".xml (MJCF), .sdf, .urdf or .csv")
    sub.add_argument("--format", help="mjcf, sdf, urdf or csv (default: by the file's ending)")
    sub.add_argument("--name", default="chain", help="prefix of all names in the file (default: chain)")
    sub.add_argument("--fragment", action="store_true", help="bodies only, to include in a model (MJCF)")
    sub.add_argument("--timestep", type=_number, metavar="h", help="time step [s] (default: safe, accurate)")
    sub.add_argument("--integrator", default="RK4", help="MuJoCo's RK4, Euler or implicitfast (default: RK4)")
    sub.add_argument("--stiffness-damping", type=_number, default=0.0, metavar="b", help="dampers b k [s]")
    sub.add_argument("--force", action="store_true", help="overwrite existing files")


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


def _in_flags(message: str) -> str:
    """Return a message of the library in the words that the user typed."""
    flags = {
        "bending_stiffness must": "--ei must",
        "mass_per_length must": "--rho-a must",
        "axial_force must": "--axial-force must",
        "force=True": "--force",
    }
    for name, flag in flags.items():
        message = message.replace(name, flag)
    return message


_COMMANDS = (
    ("error", answer_error, "relative frequency error of a uniform chain", _error_options),
    (
        "frequencies",
        answer_frequencies,
        "natural frequencies of a chain beside the exact beam's",
        _frequency_options,
    ),
    ("springs", answer_springs, "joint stiffnesses to type into a multibody tool", _spring_options),
    ("segments", answer_segments, "how many segments a tolerance needs", _tolerance_options),
    ("recommend", answer_recommend, "rules that meet a tolerance, cheapest first", _advice_options),
    ("time-step", answer_time_step, "largest stable fixed time step of a chain", _step_options),
    ("export", answer_export, "a chain as a file for MuJoCo, Gazebo, Drake or URDF tools", _export_options),
    ("buckling", answer_buckling, "compression at which a chain buckles, beside the beam's", _spring_options),
)


if __name__ == "__main__":
    sys.exit(main())
