"""Regenerate figures and tables:  python -m studies [NAME ...]."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import BinaryIO

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from beammodes.files import write_atomically
from beammodes.progress import progress_of
from beammodes.views.plots import STYLE
from studies import NAMES

FIGURES = Path(__file__).resolve().parent.parent / "figures"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the named studies, all of them by default, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(NAMES)}")
    parser.add_argument("--into", type=Path, default=FIGURES, help="folder to write to (default: figures/)")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in NAMES]
    if unknown:
        parser.error(f"NAME must be any of {', '.join(NAMES)}, got {unknown[0]!r}")
    options.into.mkdir(parents=True, exist_ok=True)
    for name in options.names or NAMES:
        start = time.perf_counter()
        written = run(import_module(f"studies.{name}"), name, options.into)
        _say(f"\r{name}: {', '.join(written)} ({time.perf_counter() - start:.1f} s)\n")
    return 0


def run(study: ModuleType, name: str, folder: Path) -> list[str]:
    """Compute, draw and write one study; return the names of the files written."""
    table = study.data(progress=progress_of(None, name, "points"))
    if "disagreement" in table.attrs:
        _say(f"\r{name}: three routes agree to {table.attrs['disagreement']:.0e}\n")
    figure = study.draw(table)
    # A table is text; a film comes as the bytes that it is.
    contents = {
        ending: part if isinstance(part, bytes) else part.encode()
        for ending, part in study.tables(table).items()
    }
    for ending, data in contents.items():
        _write(folder / f"{name}{ending}", data)
    for ending in (".svg", ".png"):
        _save(figure, folder / f"{name}{ending}")
    return [f"{name}{ending}" for ending in (*contents, ".svg", ".png")]


def _write(path: Path, data: bytes) -> None:
    def fill(file: BinaryIO) -> None:
        file.write(data)

    write_atomically(path, fill)


def _save(figure: Figure, path: Path) -> None:
    """Write a picture that is the same, byte for byte, whenever its data are."""
    kind = path.suffix[1:]
    # Neither file says when, SVG not even by which version, it was made.
    metadata = {"Date": None, "Creator": None} if kind == "svg" else {"Software": None}
    FigureCanvasAgg(figure)
    with matplotlib.rc_context(STYLE):
        write_atomically(path, lambda file: figure.savefig(file, format=kind, dpi=150, metadata=metadata))


def _say(text: str) -> None:
    sys.stderr.write(text if sys.stderr.isatty() else text.replace("\r", ""))
    sys.stderr.flush()


if __name__ == "__main__":
    sys.exit(main())
