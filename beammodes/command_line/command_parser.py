"""What a user typed, understood or refused in one line with the nearest word that is known."""

from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from beammodes.command_line.command_list import COMMANDS, Command, help_text
from beammodes.command_line.command_options import BOUNDARY
from beammodes.command_line.commands import DEFAULT_RULE, answer_recommend
from beammodes.command_line.file_commands import answer_audit
from beammodes.command_line.shell import put, tell_all
from beammodes.version import SOURCE

__all__ = ["parse"]


class _Parser(argparse.ArgumentParser):
    def _print_message(self, message: str, file: Any = None) -> None:
        # argparse itself passes over what cannot be written, and fails where the encoding lacks a character.
        if message:
            put(message, file) if file is not None and file is sys.stdout else tell_all(message)

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


class _MainParser(_Parser):
    def format_help(self) -> str:
        return help_text()


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Return what the user typed; leaves with exit code 2 and one line if it cannot be understood."""
    parser = _MainParser(prog="beammodes", usage="beammodes COMMAND ...")
    parser.add_argument("--version", action="version", version=SOURCE)
    subs = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    known = {command.name: _added(subs, command) for command in COMMANDS}
    first = arguments[0] if arguments else ""
    if first and not first.startswith("-") and first not in known:
        parser.error(f"COMMAND must be one of {', '.join(known)}, got {first[:40]!r}{_near(first, known)}")
    if first in known:
        _check_flags(known[first], arguments[1:])
    options = parser.parse_args(arguments)
    for name, value in vars(options).items():
        # What argparse makes of --name=-- .
        if value == []:
            parser.error(f"--{name.replace('_', '-')} must have a value, got '--'")
    return options


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
        sub.add_argument("boundary", help=BOUNDARY)
    command.build(sub)
    if command.answer is answer_recommend:
        sub.add_argument("--rule", metavar="RULE,...", help="only these rules (default: all)")
    elif command.answer is not answer_audit:
        sub.add_argument(
            "--rule", default=DEFAULT_RULE, help=f"discretization rule (default: {DEFAULT_RULE})"
        )
    sub.add_argument("--json", action="store_true", help="print one JSON object")
    sub.set_defaults(command=command.answer)
    return sub
