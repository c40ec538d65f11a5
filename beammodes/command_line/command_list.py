"""The commands of the command line, in the order of a user's work, and the help that teaches them."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

from beammodes.command_line.command_options import (
    advice_options,
    audit_options,
    count_options,
    error_options,
    export_options,
    frequency_options,
    spring_options,
    step_options,
)
from beammodes.command_line.commands import (
    Answer,
    answer_buckling,
    answer_error,
    answer_frequencies,
    answer_recommend,
    answer_segments,
    answer_springs,
    answer_time_step,
)
from beammodes.command_line.file_commands import answer_audit, answer_export
from beammodes.command_line.shell import EXIT_CODES

__all__ = ["COMMANDS", "Command", "help_text"]


@dataclass(frozen=True)
class Command:
    """One command: its name, what computes it, the question it answers, an example, and its options."""

    name: str
    answer: Callable[[argparse.Namespace], Answer]
    question: str
    example: str
    build: Callable[[argparse.ArgumentParser], None]


_BEAM = "--length 1.2 --ei 85 --rho-a 0.62"
_OF = f"{_BEAM} --units SI"
#: In the order of a user's work: before, while and after building a chain.
_STAGES: dict[str, tuple[Command, ...]] = {
    "before you build a chain": (
        Command(
            "recommend",
            answer_recommend,
            "which rule, how many segments and which step meet my tolerance?",
            "beammodes recommend clamped-free --tolerance 1% --modes 3",
            advice_options,
        ),
        Command(
            "segments",
            answer_segments,
            "how many segments does one rule need?",
            "beammodes segments clamped-clamped --tolerance 1% --modes 3 --rule gregory",
            count_options,
        ),
        Command(
            "error",
            answer_error,
            "how wrong is one frequency of a chain of N segments?",
            'beammodes error "clamped-free(mass=0.5)" --segments 6 --mode 1',
            error_options,
        ),
    ),
    "while you build it": (
        Command(
            "springs",
            answer_springs,
            "which joint stiffnesses do I type into my multibody tool?",
            f"beammodes springs clamped-free --segments 4 {_OF}",
            spring_options,
        ),
        Command(
            "frequencies",
            answer_frequencies,
            "at which frequencies do the chain and the beam ring?",
            f"beammodes frequencies clamped-free --segments 6 --modes 3 {_OF}",
            frequency_options,
        ),
        Command(
            "time-step",
            answer_time_step,
            "which fixed time step is stable?",
            f"beammodes time-step clamped-free --segments 10 {_OF}",
            step_options,
        ),
        Command(
            "buckling",
            answer_buckling,
            "under which compression do the chain and the beam buckle?",
            f"beammodes buckling clamped-free --segments 10 {_OF}",
            spring_options,
        ),
        Command(
            "export",
            answer_export,
            "can I have the chain as a file for MuJoCo, Gazebo, Drake or URDF tools?",
            f"beammodes export clamped-free --segments 10 --rule gregory {_BEAM} --output beam.xml",
            export_options,
        ),
    ),
    "when you have one": (
        Command(
            "audit",
            answer_audit,
            "how wrong is the chain in my model file, and what mends it?",
            f"beammodes audit beam.xml {_OF} --tolerance 1%",
            audit_options,
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

Give --length, --ei and --rho-a in any consistent units, all other numbers in the same; --units names them.
Without the three, answers and numbers of ends are multiples of the beam's own, such as EI/L.
Errors are those of natural frequencies against the exact Euler-Bernoulli beam, with their sign: negative is
too low. They hold for small vibration about the straight beam, in vacuum and without gravity.
exit codes:
{codes}
options: --json for scripts; --version; beammodes COMMAND --help for all options of a command
"""


def help_text() -> str:
    """Return what `beammodes --help` prints."""
    lines: list[str] = []
    for stage, commands in _STAGES.items():
        lines += ["", f"{stage}:"]
        for command in commands:
            lines += [f"    {command.name:13}{command.question}"]
    lines += ["", "examples:"]
    lines += [f"  {command.example}" for command in COMMANDS]
    codes = "\n".join(f"    {code:<4} {says}" for code, says in EXIT_CODES.items())
    return _HEAD + "\n".join(lines) + _FOOT.format(codes=codes)
