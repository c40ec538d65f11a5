"""Regenerate figures and tables:  python -m studies [NAME ...]."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from studies import PAGE, SITE, every_study
from studies.runner import missing, run_all, write_gallery

FIGURES = Path(__file__).resolve().parent.parent / "figures"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the named studies, all of them by default, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    names = (*every_study(), PAGE)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(names)}, {SITE}")
    parser.add_argument("--list", action="store_true", help="print all names with their captions, and end")
    parser.add_argument("--into", type=Path, default=FIGURES, help="folder to write to (default: figures/)")
    parser.add_argument(
        "--jobs",
        type=_jobs,
        default=os.cpu_count() or 1,
        help="studies at once (default: one for each processor)",
    )
    options = parser.parse_args(arguments)
    if options.list:
        print("\n".join(f"{name:<16} {study.caption}" for name, study in every_study().items()))
        print(f"{PAGE:<16} The report regenerated as one page, of all the others' files.")
        print(f"{SITE:<16} The documentation as a site. Only when asked for; needs '.[site]'.")
        return 0
    unknown = [name for name in options.names if name not in (*names, SITE)]
    if unknown:
        parser.error(f"NAME must be any of {', '.join(names)}, {SITE}, got {unknown[0]!r}")
    options.into.mkdir(parents=True, exist_ok=True)
    try:
        _run(options.names or names, options.into, options.jobs)
    except KeyboardInterrupt:
        _say("\rinterrupted: files of finished studies are written, the others are as they were\n")
        return 130
    return 0


def _run(asked: Sequence[str], folder: Path, jobs: int) -> None:
    """Run studies, and after them write the page and the site; what these need of others is made first."""
    names = [name for name in dict.fromkeys(asked) if name not in (PAGE, SITE)]
    if PAGE in asked or SITE in asked:
        names += [name for name in missing(every_study(), folder) if name not in names]
    run_all(names, folder, jobs, _say)
    write_gallery(folder)
    if PAGE in asked:
        from studies.page.build import write as write_page

        _timed(PAGE, write_page, folder)
    if SITE in asked:
        from studies.site.build import write as write_site

        _timed(SITE, write_site, folder)


def _timed(name: str, write: Callable[[Path], str], folder: Path) -> None:
    start = time.perf_counter()
    _say(f"{name}: {write(folder)} ({time.perf_counter() - start:.1f} s)\n")


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
