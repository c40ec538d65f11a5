"""The command line: errors, springs, frequencies, advice, steps, model files and verdicts on them."""

from __future__ import annotations

import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; `shell.EXIT_CODES` says what each means.

    Without arguments it is those of the process, whose signals and warnings it then takes over, too.
    """
    try:
        from beammodes.command_line import shell

        try:
            if arguments is None:
                shell.as_a_process()
            return _answered(sys.argv[1:] if arguments is None else arguments)
        except BaseException as error:
            return shell.after_failure(error)
        finally:
            shell.INTERRUPTS.ignore()
    except KeyboardInterrupt:
        # It came before the line above could listen.
        if sys.stderr is not None:
            sys.stderr.write("beammodes: interrupted: nothing was begun\n")
        return 130


def _answered(arguments: Sequence[str]) -> int:
    """Answer, and return the exit code."""
    from beammodes.command_line import shell

    code = 0
    try:
        try:
            from beammodes.command_line.commands import COMMANDS
            from beammodes.command_line.options import parse

            options = parse(arguments, COMMANDS)
        except SystemExit as stop:
            # Help was asked for, or argparse has told what is wrong.
            return shell.NO_ANSWER if stop.code else 0
        answer, text = options.command(options)
        if shell.INTERRUPTS.count:
            return shell.interrupted()
        text += f"\n{options.told}" if options.told else ""
        code = 0 if (answer.get("written") or answer).get("meets", True) else shell.NOT_MET
        if options.json:
            from beammodes.command_line.json_answers import as_json

            text = as_json(answer, options.told)
        shell.put(f"{text}\n", sys.stdout)
    except shell.Unwritable as error:
        return shell.unwritable(error, code)
    return code


if __name__ == "__main__":
    sys.exit(main())
