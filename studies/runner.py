"""Running studies: one after another, or several at once in processes of their own."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from multiprocessing import active_children, get_context
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from types import FrameType
from typing import Any, BinaryIO

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from beammodes.files import write_atomically
from beammodes.numerics.blas import one_thread
from beammodes.progress import progress_of
from beammodes.views.symbols import STYLE
from studies import every_study

__all__ = ["gallery", "missing", "run_all", "run_study", "write_bytes", "write_gallery"]

Say = Callable[[str], object]
#: Of a process that runs studies for another: where its messages go, which one runs, whether to end.
_channel: list[Any] = []
_running: list[str] = []
_ending: list[int] = []


def run_all(names: Sequence[str], folder: Path, jobs: int, say: Say) -> None:
    """Write the named studies' files into a folder, at most `jobs` studies at once, the slowest first.

    Interrupted, or when a study fails, it ends the others; what is finished stays written, and no file is
    left half written.
    """
    if min(jobs, len(names)) <= 1:
        for name in names:
            run_study(name, folder, say)
        return
    order = sorted(names, key=lambda name: -every_study()[name].seconds)
    others, context = active_children(), get_context("spawn")
    messages = context.SimpleQueue()
    teller = Thread(target=_tell, args=(messages, say), daemon=True)
    teller.start()
    pool = ProcessPoolExecutor(min(jobs, len(names)), context, _begin, (messages,))
    try:
        futures: list[Future[None]] = [pool.submit(_run_here, name, folder) for name in order]
        for future in as_completed(futures):
            future.result()
    except BaseException:
        for process in active_children():
            if process not in others:
                process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        messages.put(None)
        teller.join()


def missing(names: Iterable[str], folder: Path) -> list[str]:
    """Return the studies of which a folder lacks a file."""
    endings = (".csv", ".svg")
    return [name for name in names if not all((folder / f"{name}{ending}").is_file() for ending in endings)]


def _tell(messages: SimpleQueue[str | None], say: Say) -> None:
    while (text := messages.get()) is not None:
        say(text)


def _begin(messages: Any) -> None:
    """Prepare a process: messages go to the one that started it, which alone is told of an interrupt."""
    _channel.append(messages)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)


def _end(number: int, _: FrameType | None) -> None:
    """End at once, or, in the middle of a study, by an exception: temporary files are then taken away."""
    if not _running:
        os._exit(128 + number)
    _ending.append(128 + number)
    raise SystemExit(128 + number)


def _run_here(name: str, folder: Path) -> None:
    _running.append(name)
    try:
        run_study(name, folder, _channel[0].put)
    finally:
        _running.clear()
        if _ending:
            # The pool would go on with what it has handed out in advance.
            os._exit(_ending[0])


def run_study(name: str, folder: Path, say: Say) -> None:
    """Compute, draw and write one study, and say which files were written."""
    start = time.perf_counter()
    study = every_study()[name]
    with one_thread():
        table = study.compute(progress_of(None, name, "points", say))
        if "disagreement" in table.attrs:
            say(f"\r{name}: three routes agree to {table.attrs['disagreement']:.0e}\n")
        figure = study.picture(table)
        # A table is text; a film comes as the bytes that it is.
        contents = {
            ending: part if isinstance(part, bytes) else part.encode()
            for ending, part in study.tables(table).items()
        }
        for ending, data in contents.items():
            write_bytes(folder / f"{name}{ending}", data)
        for ending in (".svg", ".png"):
            _save(figure, folder / f"{name}{ending}")
    written = ", ".join(f"{name}{ending}" for ending in (*contents, ".svg", ".png"))
    say(f"\r{name}: {written} ({time.perf_counter() - start:.1f} s)\n")


def gallery(folder: Path) -> str:
    """Return a page in Markdown of the pictures that a folder has, with links to their tables."""
    parts = ["# Figures\n\nWritten by `python -m studies`. One file in `studies/` is the source of each."]
    for name, study in every_study().items():
        endings = [ending for ending in study.sheets if (folder / f"{name}{ending}").is_file()]
        if endings and (folder / f"{name}.svg").is_file():
            tables = ", ".join(f"[{name}{ending}]({name}{ending})" for ending in endings)
            parts.append(f"![{study.caption}]({name}.svg)\n\n`{name}`: {study.caption} Numbers: {tables}.")
    return "\n\n".join(parts) + "\n"


def write_gallery(folder: Path) -> None:
    """Write the page of a folder's pictures, which code hosts show under the list of its files."""
    write_bytes(folder / "README.md", gallery(folder).encode())


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file in one step."""

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
