"""Regenerate figures and tables:  python -m studies [NAME ...]."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from studies import NAMES
from studies.runner import run_all

FIGURES = Path(__file__).resolve().parent.parent / "figures"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the named studies, all of them by default, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(NAMES)}")
    parser.add_argument("--into", type=Path, default=FIGURES, help="folder to write to (default: figures/)")
    parser.add_argument(
        "--jobs",
        type=_jobs,
        default=os.cpu_count() or 1,
        help="studies at once (default: one for each processor)",
    )
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in NAMES]
    if unknown:
        parser.error(f"NAME must be any of {', '.join(NAMES)}, got {unknown[0]!r}")
    options.into.mkdir(parents=True, exist_ok=True)
    try:
        run_all(list(dict.fromkeys(options.names)) or list(NAMES), options.into, options.jobs, _say)
    except KeyboardInterrupt:
        _say("\rinterrupted: files of finished studies are written, the others are as they were\n")
        return 130
    return 0


def _jobs(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1, got {text!r}")
    return int(text)


def _say(text: str) -> None:
    sys.stderr.write(text if sys.stderr.isatty() else text.replace("\r", ""))
    sys.stderr.flush()


if __name__ == "__main__":
    sys.exit(main())
