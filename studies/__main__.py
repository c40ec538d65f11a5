"""Regenerate figures and tables:  python -m studies [NAME ...]."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from studies import NAMES, PAGE
from studies.runner import missing, run_all

FIGURES = Path(__file__).resolve().parent.parent / "figures"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the named studies, all of them by default, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"any of {', '.join(NAMES)}; {PAGE}: the page"
    )
    parser.add_argument("--into", type=Path, default=FIGURES, help="folder to write to (default: figures/)")
    parser.add_argument(
        "--jobs",
        type=_jobs,
        default=os.cpu_count() or 1,
        help="studies at once (default: one for each processor)",
    )
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in (*NAMES, PAGE)]
    if unknown:
        parser.error(f"NAME must be any of {', '.join((*NAMES, PAGE))}, got {unknown[0]!r}")
    options.into.mkdir(parents=True, exist_ok=True)
    try:
        _run(options.names or [*NAMES, PAGE], options.into, options.jobs)
    except KeyboardInterrupt:
        _say("\rinterrupted: files of finished studies are written, the others are as they were\n")
        return 130
    return 0


def _run(asked: Sequence[str], folder: Path, jobs: int) -> None:
    """Run studies, and after them write the page; what it needs of others is made first."""
    names = [name for name in dict.fromkeys(asked) if name != PAGE]
    if PAGE not in asked:
        run_all(names, folder, jobs, _say)
        return
    run_all(list(dict.fromkeys([*names, *missing(NAMES, folder)])), folder, jobs, _say)
    start = time.perf_counter()
    from studies.page.build import write

    _say(f"{PAGE}: {write(folder)} ({time.perf_counter() - start:.1f} s)\n")


def _jobs(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1, got {text!r}")
    return int(text)


def _say(text: str) -> None:
    # A terminal's line is erased first: the next message may be of another study, and shorter.
    sys.stderr.write(text.replace("\r", "\r\x1b[K" if sys.stderr.isatty() else ""))
    sys.stderr.flush()


if __name__ == "__main__":
    sys.exit(main())
