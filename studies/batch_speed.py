"""The cost of a study in one process, in several and on a Dask cluster, and of 10⁹ points."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np

import beammodes as bm
from beammodes.batch.executors import executor_of
from studies.tables import markdown_table

__all__ = ["BODIES", "PLAIN", "batch_table", "measured", "needs", "seconds_of"]

MODES = 5

#: A body on the tip and an elastic clamp: every frequency is a root of its own to find. The beam's own are
#: found once for a chunk's points that share them, so what changes the beam comes first.
BODIES: dict[str, Any] = {
    "right_mass": np.linspace(0.1, 2.0, 64),
    "left_rotational_stiffness": np.linspace(1.0, 20.0, 16),
    "boundary": "pinned-free",
    "rule": ["mitiguy", "gregory"],
    "segments": [10, 20, 50, 100, 1000],
    "mode": range(1, MODES + 1),
    "compute": "relative_error",
}
#: Plain ends: the closed form for whole arrays.
PLAIN: dict[str, Any] = {
    "boundary": list(bm.BOUNDARIES),
    "rule": [name for name, rule in bm.RULES.items() if rule.has_equal_springs],
    "segments": range(1, 1001),
    "mode": range(1, MODES + 1),
    "compute": "relative_error",
}


def seconds_of(study: bm.Study, engine: Any = "serial") -> tuple[float, bytes]:
    """Return how long a study takes from nothing to its stored end, and the bytes of its errors."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        found = study.run(store=folder, engine=engine, progress=False)
        return time.perf_counter() - start, found.relative_error.values.tobytes()


@contextmanager
def cluster(workers: int) -> Iterator[Any]:
    """Provide a client of a Dask cluster on this machine."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as local,
        Client(local) as client,
    ):
        yield client


@contextmanager
def started(workers: int) -> Iterator[dict[str, tuple[Any, float]]]:
    """Provide engines that have computed something already, and how long it took them to begin [s]."""
    # As many chunks as keep every worker busy until it has loaded what it needs.
    first = bm.Study.grid(**BODIES | {"right_mass": np.linspace(3.0, 4.0, workers), "chunk": 80})
    kinds = {
        f"{workers} processes": executor_of("processes", workers),
        f"Dask, {workers} workers": cluster(workers),
    }
    engines: dict[str, tuple[Any, float]] = {"one process": ("serial", 0.0)}
    seconds_of(first)
    with ExitStack() as stack:
        for name, kind in kinds.items():
            start = time.perf_counter()
            engine = stack.enter_context(kind)
            seconds_of(bm.Study.grid(**PLAIN | {"segments": range(1, 9), "chunk": 80}), engine)
            engines[name] = engine, time.perf_counter() - start
            seconds_of(first, engine)
        yield engines


def measured(workers: int, repeats: int) -> tuple[dict[str, list[float]], list[bm.Study]]:
    """Return the start and the shortest times [s] of three studies for every engine, and the studies.

    Raises
    ------
    ArithmeticError
        If two engines differ in a bit.
    """
    times: dict[str, list[list[float]]] = {}
    with started(workers) as engines:
        for repeat in range(repeats):
            studies = _studies(repeat)
            expected: list[bytes] = []
            for name, (engine, start) in engines.items():
                results = [seconds_of(study, engine) for study in studies]
                times.setdefault(name, []).append([start, *(seconds for seconds, _ in results)])
                expected = expected or [data for _, data in results]
                if [data for _, data in results] != expected:
                    raise ArithmeticError(f"{name} gives other bits than one process")
    return {name: [min(each) for each in zip(*rows, strict=True)] for name, rows in times.items()}, studies


def _studies(repeat: int) -> list[bm.Study]:
    # Roots found before are kept; other masses have others.
    bodies = bm.Study.grid(**BODIES | {"right_mass": BODIES["right_mass"] + 1e-3 * repeat})
    # Few points to a chunk, so that what a chunk costs beside its points is nearly all there is.
    empty = bm.Study.grid(**PLAIN | {"boundary": "pinned-pinned", "rule": "mitiguy", "chunk": 4})
    return [bodies, bm.Study.grid(**PLAIN), empty]


def batch_table(workers: int = 2, repeats: int = 2) -> str:
    """Return measured times as a Markdown table, and what they foretell of 10⁹ points."""
    times, (bodies, plain, empty) = measured(workers, repeats)
    _, *alone = times["one process"]
    rows = []
    for name, (start, *seconds) in times.items():
        cells = [f"{t:.1f} s, {a / t:.1f} times" for a, t in zip(alone[:2], seconds[:2], strict=True)]
        begun = f"{start:.1f} s" if start else "–"
        rows.append([name, begun, *cells, f"{1e3 * seconds[2] / empty.chunks:.1f} ms"])
    columns = [
        "engine",
        "start",
        f"{bodies.size * MODES:,} frequencies with a body and an elastic clamp",
        f"{plain.size * MODES:,} of plain ends",
        "a chunk of next to nothing",
    ]
    return (
        f"**Studies** with their store, by `Study.run`, on {os.cpu_count()} processors: time, and how many "
        f"times faster than one process, the best of {repeats} runs after the engine's start. All engines "
        "give the same bits (checked in this run).\n\n"
        + markdown_table(columns, rows)
        + needs(alone[0] / bodies.size, alone[1] / plain.size, list(times.values())[-1][-1] / empty.chunks)
    )


def needs(bodies: float, plain: float, handing: float) -> str:
    """Say what 10⁹ points need, given the seconds of one with bodies, of a plain one, and of a chunk."""
    lines = ["", f"What 10⁹ points of {MODES} modes need, by these times:", ""]
    for what, cost, chunk in (("with bodies", bodies, 1000), ("of plain ends", plain, 5000)):
        hours, most = cost * 1e9 / 3600, cost * chunk / handing
        lines.append(
            f"- {what}, {1e3 * cost:.2g} ms each: {hours:,.0f} core hours. In chunks of {chunk:,} one "
            f"scheduler, at {1e3 * handing:.1f} ms a chunk, keeps about {most:,.0f} cores busy; "
            "in chunks ten times as long, ten times as many."
        )
    lines.append(f"- of either, {8 * MODES} GB of files for each quantity.")
    return "\n".join(lines) + "\n"
