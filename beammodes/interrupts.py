"""Ctrl-C during work that keeps what it has finished: noted when it comes, obeyed where nothing can break.

Python raises KeyboardInterrupt wherever it happens to be. Within CasADi's wrappers that becomes an error of
another kind, or nothing; while a result is put together it loses the result.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["held", "pause"]

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
