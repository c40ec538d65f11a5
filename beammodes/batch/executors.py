"""Who computes the chunks: this process, others on this machine, or whatever else runs functions."""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from typing import Any

from beammodes.batch.cases import Cases
from beammodes.batch.evaluated import Evaluated, evaluate, evaluate_elsewhere
from beammodes.batch.quantities import Quantity
from beammodes.checks import choice, shown, whole_number

__all__ = ["ENGINES", "computed", "executor_of"]

#: The engines known by name; a Dask client or an executor is one itself.
ENGINES = ("serial", "processes")

# Chunks handed out at a time: enough for hundreds of workers, few enough to hold in memory.
_WINDOW = 512

Task = tuple[int, Cases]


@contextmanager
def executor_of(engine: Any, workers: int | None = None) -> Iterator[Executor | None]:
    """Provide the executor that an engine is, None for "serial".

    Raises
    ------
    TypeError, ValueError
        If it is none, or `workers` is given for another engine than "processes".
    """
    if workers is not None and engine != "processes":
        raise ValueError(f'workers must be left out unless engine is "processes", got {shown(workers)}')
    client = getattr(sys.modules.get("distributed"), "Client", ())
    if isinstance(engine, client):
        if engine.asynchronous:
            # Waiting for it would stop the very loop that it runs in.
            raise ValueError(f"engine must be a Client without asynchronous=True, got {shown(engine)}")
        # Dask's own face as an executor: its scheduler spreads, retries and moves what a lost worker had.
        yield engine.get_executor(pure=False)
    elif isinstance(engine, Executor):
        yield engine
    elif _named(engine) == "serial":
        yield None
    else:
        count = (os.cpu_count() or 1) if workers is None else workers
        yield from _processes(whole_number("workers", count, most=1024))


def _named(engine: Any) -> str:
    try:
        return choice("engine", engine, ENGINES)
    except (TypeError, ValueError) as error:
        others = "a dask.distributed Client or a concurrent.futures Executor"
        raise type(error)(f"{error}; besides these names, {others} is an engine") from None


def _processes(workers: int) -> Iterator[Executor]:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    # Fresh processes: forks of one that has threads may hang.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_start_worker)
    try:
        yield pool
    except BrokenProcessPool as error:
        error.add_note(
            "a worker ended: killed, or out of memory, or the script that started it calls run() without its "
            'if __name__ == "__main__":'
        )
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _start_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it even if it is killed."""
    import multiprocessing
    import signal
    import threading

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def follow() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


def computed(
    tasks: Iterable[Task], quantities: tuple[Quantity, ...], executor: Executor | None
) -> Generator[tuple[int, Evaluated], None, None]:
    """Yield numbers and results of chunks, in the order in which they are finished."""
    if executor is None:
        for number, cases in tasks:
            yield number, evaluate(cases, quantities)
        return
    from beammodes import __version__

    pending: dict[Future[Evaluated], int] = {}
    try:
        for number, cases in tasks:
            pending[executor.submit(evaluate_elsewhere, cases, quantities, __version__)] = number
            if len(pending) >= _WINDOW:
                yield from _finished(pending)
        while pending:
            yield from _finished(pending)
    finally:
        for future in pending:
            future.cancel()


def _finished(pending: dict[Future[Evaluated], int]) -> Iterator[tuple[int, Evaluated]]:
    done = wait(pending, return_when=FIRST_COMPLETED).done
    # Those that failed come last: what was finished beside them is not lost.
    for future in sorted(done, key=lambda one: one.cancelled() or one.exception() is not None):
        yield pending.pop(future), future.result()
