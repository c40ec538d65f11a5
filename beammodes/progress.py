"""Progress of long work: a line that shows it, and Ctrl-C that loses nothing of what is finished."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from beammodes.checks import shown

__all__ = ["Progress", "ProgressLine", "held", "pause", "progress_of"]

#: Called with how much is done, and of how much.
Progress = Callable[[int, int], object]

_BAR = 20  # characters
_PERIOD = 0.1  # seconds between two lines: more would slow the work down
_QUICK = 0.5  # seconds within which work is done before a notebook has a line of it


@dataclass
class ProgressLine:
    """A line with the amount done, its rate and the time that the rest will take.

    Parameters
    ----------
    label, unit : str
        What is being done, and what is counted.
    write : callable
        Takes the text.
    clock : callable
        Time in seconds.

    Examples
    --------
    >>> line = ProgressLine("study", "chunks", print, iter([0.0, 2.0]).__next__)
    >>> print(line.text(10, 40), line.text(20, 40), sep="\\n")
    study: [#####               ] 10 of 40 chunks
    study: [##########          ] 20 of 40 chunks, 5/s, 4 s left
    """

    label: str
    unit: str
    write: Callable[[str], object]
    clock: Callable[[], float] = time.monotonic
    _first: tuple[float, int] | None = field(default=None, init=False)
    _shown: float = field(default=float("-inf"), init=False)
    _width: int = field(default=0, init=False)

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` are done."""
        if done < total and time.monotonic() - self._shown < _PERIOD:
            return
        self._shown = time.monotonic()
        text = self.text(done, total)
        # Blanks cover the rest of a longer line before it.
        self.write(f"\r{text:<{self._width}}" + ("\n" if done == total else ""))
        self._width = len(text)

    def say(self, text: str) -> None:
        """Write one more line below."""
        self.write(f"{self.label}: {text}\n")

    def text(self, done: int, total: int) -> str:
        """Return the line."""
        now = self.clock()
        start, before = self._first = self._first or (now, done)
        bar = "#" * (_BAR * done // max(total, 1))
        text = f"{self.label}: [{bar:<{_BAR}}] {done} of {total} {self.unit}"
        rate = (done - before) / (now - start) if now > start else 0.0
        if not rate:
            return text
        left = f", {_duration((total - done) / rate)} left" if done < total else ""
        return f"{text}, {rate:.3g}/s{left}"


def progress_of(
    progress: object, label: str, unit: str, write: Callable[[str], object] | None = None
) -> Progress:
    """Return a callable that shows progress as asked for.

    Parameters
    ----------
    progress : callable, bool or None
        Called with (done, total); True or False for a line on standard error, in a notebook below the cell,
        or none; None for a line only where that is a terminal or a notebook.
    label, unit, write
        As of `ProgressLine`; standard error by default.

    Raises
    ------
    TypeError
        If it is something else.
    """
    notebook = None if write else _below_the_cell()
    if progress is None:
        progress = notebook is not None or sys.stderr.isatty()
    if isinstance(progress, bool):
        return ProgressLine(label, unit, write or notebook or sys.stderr.write) if progress else _quiet
    if not callable(progress):
        raise TypeError(f"progress must be a function, True, False or None, got {shown(progress)}")
    return progress


def _below_the_cell() -> Callable[[str], object] | None:
    """Return what writes in a notebook, None where this is none."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return _Below(sys.modules["IPython.display"].display) if hasattr(shell, "kernel") else None


@dataclass
class _Below:
    """Writes a line that changes where it stands; quick work leaves none."""

    display: Callable[..., Any]
    _handle: Any = field(default=None, init=False)
    _start: float = field(default_factory=time.monotonic, init=False)

    def __call__(self, text: str) -> None:
        line, changes = {"text/plain": text.strip()}, text.startswith("\r")
        if changes and self._handle is not None:
            self._handle.update(line, raw=True)
        elif changes and time.monotonic() - self._start > _QUICK:
            self._handle = self.display(line, raw=True, display_id=True)
        elif not changes:
            self.display(line, raw=True)


def _quiet(_done: int, _total: int) -> None:
    pass


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    if whole < 7200:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


# Ctrl-C is noted when it comes and obeyed where nothing can break: Python raises KeyboardInterrupt wherever
# it happens to be, which within CasADi's wrappers becomes an error of another kind, or nothing.

#: Of the work in progress: how often Ctrl-C has come. Signals reach the main thread only.
_noted: list[int] = []


@contextmanager
def held() -> Iterator[None]:
    """Note Ctrl-C from here on, however often it comes; only `pause` obeys it.

    The program's own handler, if it has one, is called once at the end. Where Ctrl-C is ignored, or off the
    main thread, nothing changes.

    Examples
    --------
    >>> with held():
    ...     signal.raise_signal(signal.SIGINT)
    ...     try:
    ...         print("goes on")
    ...         pause()
    ...     except KeyboardInterrupt:
    ...         print("and stops here")
    goes on
    and stops here
    """
    before = signal.getsignal(signal.SIGINT)
    if _noted or threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    _noted.append(0)

    def note(_number: int, _frame: FrameType | None) -> None:
        _noted[0] += 1

    signal.signal(signal.SIGINT, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        came = _noted.pop()
        if came and before is not signal.default_int_handler:
            before(signal.SIGINT, None)


def pause() -> None:
    """Raise KeyboardInterrupt if Ctrl-C has come while it was held."""
    if _noted and _noted[0] and threading.current_thread() is threading.main_thread():
        raise KeyboardInterrupt
