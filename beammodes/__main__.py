"""The command line: errors, springs, frequencies, advice, steps, model files and verdicts on them."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence

from beammodes.command_line.command_options import in_flags
from beammodes.command_line.command_parser import parse

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    0; 1 if an audit's tolerance is not met; 2 for bad usage or a mode that does not exist.
    """
    options = parse(sys.argv[1:] if arguments is None else arguments)
    try:
        answer, text = options.command(options)
        output = json.dumps(answer, allow_nan=False) if options.json else text
    except (TypeError, ValueError, OSError) as error:
        sys.stderr.write(f"beammodes: {in_flags(_said(error))}\n")
        return 2
    try:
        print(output, flush=True)
    except BrokenPipeError:
        # The reader, such as `head`, has seen enough; Python would complain again when it closes stdout.
        sys.stdout = None
    except OSError as error:
        sys.stdout = None
        sys.stderr.write(f"beammodes: the answer cannot be written: {error.strerror or error}\n")
        return 2
    return 0 if answer.get("meets", True) else 1


def _said(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.strerror[0].lower()}{error.strerror[1:]}: {error.filename}"
    return str(error)


if __name__ == "__main__":
    sys.exit(main())
