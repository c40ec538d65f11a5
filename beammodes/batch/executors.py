"""Executors of chunks: this process, worker processes, a cluster, or any other that runs functions."""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from beammodes.batch.cases import Cases
from beammodes.batch.quantities import Quantity
from beammodes.batch.store import Evaluated
from beammodes.checks import choice, shown, whole_number
from beammodes.numerics.blas import one_thread
from beammodes.version import __version__

__all__ = ["ENGINES", "computed", "evaluate", "evaluate_elsewhere", "executor_of"]

#: The engines known by name; a Dask client or an executor is one itself.
ENGINES = ("serial", "processes")

# More workers are surely a mistake.
_MOST_WORKERS = 1024

# How often a worker looks whether its parent is alive [s].
_LOOK = 0.5

# Chunks handed out at a time: enough for hundreds of workers, few enough to hold in memory.
_WINDOW = 512

#: Tells this process, and forks of it, from others, also on other machines.
_THIS_PROCESS = secrets.token_hex(16)

Task = tuple[int, Cases]


@dataclass
class _Workers(Executor):
    """Worker processes that this file has started."""

    pool: Executor

    def submit(self, function: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        return self.pool.submit(function, *given, **named)


@contextmanager
def executor_of(engine: Any, workers: int | None = None) -> Iterator[Executor | None]:
    """Provide the executor that an engine is, None for "serial"; `workers` are of "processes" alone."""
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
        yield from _processes(workers)


def _named(engine: Any) -> str:
    try:
        return choice("engine", engine, ENGINES)
    except (TypeError, ValueError) as error:
        others = "a dask.distributed Client or a concurrent.futures Executor"
        raise type(error)(f"{error}; besides these names, {others} is an engine") from None


def _processes(workers: int | None) -> Iterator[Executor]:
    import warnings

    from loky import cpu_count
    from loky.process_executor import ProcessPoolExecutor

    count = cpu_count() if workers is None else whole_number("workers", workers, most=_MOST_WORKERS)
    pool = ProcessPoolExecutor(count, initializer=_start_worker, initargs=(os.getpid(),))
    try:
        with _interrupts_held():
            # The first call starts all workers, which keep what is held at that moment.
            pool.submit(os.getpid)
        yield _Workers(pool)
    except BaseException:
        with warnings.catch_warnings():
            # Of tools that would find the workers' own processes; ours have none.
            warnings.simplefilter("ignore")
            pool.shutdown(kill_workers=True)
        raise
    pool.shutdown()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Let Ctrl-C wait, here until the end of the context, and in processes started meanwhile for good."""
    import signal

    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_worker(parent: int) -> None:
    """Leave Ctrl-C to the parent, and end with it even if it is killed."""
    import multiprocessing
    import signal
    import threading
    import time

    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def follow() -> None:
        if sys.platform == "win32":
            process = multiprocessing.parent_process()
            assert process is not None
            process.join()
        while os.getppid() == parent and sys.platform != "win32":
            time.sleep(_LOOK)
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
    from concurrent.futures.process import BrokenProcessPool

    pending: dict[Future[Evaluated], int] = {}
    try:
        for number, cases in tasks:
            future = executor.submit(evaluate_elsewhere, cases, quantities, __version__, _THIS_PROCESS)
            pending[future] = number
            if len(pending) >= _WINDOW:
                yield from _finished(pending)
        while pending:
            yield from _finished(pending)
    except BrokenProcessPool as error:
        error.add_note(
            "a worker ended: killed, out of memory or crashed, or it could not load what it was sent; "
            'engine="processes" takes functions that are defined anywhere, other pools only those of a module'
        )
        raise
    except Exception as error:
        if type(error).__name__ == "PicklingError":
            error.add_note(
                "a function in compute holds what cannot be sent to other processes; "
                'engine="serial" takes any'
            )
        raise
    finally:
        # Our own workers are killed, and loky cannot do it to futures that are cancelled.
        if not isinstance(executor, _Workers):
            for future in pending:
                future.cancel()


def _finished(pending: dict[Future[Evaluated], int]) -> Iterator[tuple[int, Evaluated]]:
    done = wait(pending, return_when=FIRST_COMPLETED).done
    # Those that failed come last: what was finished beside them is not lost.
    for future in sorted(done, key=lambda one: one.cancelled() or one.exception() is not None):
        yield pending.pop(future), future.result()


def evaluate(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    """Return the quantities of a chunk, computed on one BLAS thread, so that sums have one order."""
    with one_thread():
        return _evaluated(cases, quantities)


def evaluate_elsewhere(
    cases: Cases, quantities: Iterable[Quantity], version: str, process: str = ""
) -> Evaluated:
    """Return the quantities of a chunk in a worker's process, whose BLAS keeps to one thread from now on.

    A worker that has another `version` of this package, or other code of the user's functions than `process`,
    such as a file that was edited since, raises ValueError.
    """
    if version != __version__:
        raise ValueError(f"workers must have beammodes {version}, got {__version__}")
    if process != _THIS_PROCESS:
        for quantity in quantities:
            quantity.check_code()
        for given in cases.structures:
            given.check_code()
    # Kept: a worker may run several chunks in threads, and one must not release the others.
    one_thread()
    return _evaluated(cases, quantities)


def _evaluated(cases: Cases, quantities: Iterable[Quantity]) -> Evaluated:
    values = {
        quantity.name: np.ascontiguousarray(quantity.compute(cases), dtype=np.float64)
        for quantity in quantities
    }
    return Evaluated(values, dict(sorted(cases.reasons.items())))
